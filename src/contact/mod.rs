//! Contact laws: static force-indentation curves in f64, closed forms.
//!
//! `f > 0` pushes the tip away; `delta > 0` is indentation, `-delta` the gap.

/// The law one instance uses (after `auto` has been decided).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Law {
    None,
    Hertz,
    Dmt,
    Jkr,
}
