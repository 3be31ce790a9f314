//! The contact laws by name.

use crate::contact::{Dmt, Hertz, Interaction, Jkr, LawShader, Nothing};

/// The law one instance uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Law {
    None,
    Hertz,
    Dmt,
    Jkr,
}

impl Law {
    pub const ALL: [Law; 4] = [Law::None, Law::Hertz, Law::Dmt, Law::Jkr];

    /// The word the scene file and the results file use.
    pub fn name(self) -> &'static str {
        match self {
            Law::None => "none",
            Law::Hertz => "hertz",
            Law::Dmt => "dmt",
            Law::Jkr => "jkr",
        }
    }

    /// True where the force depends on the past: two answers for one indentation.
    pub fn has_memory(self) -> bool {
        matches!(self, Law::Jkr)
    }

    /// Whether a tip that rests at that indentation (any unit) is in contact.
    pub fn touches_at(self, indentation: f64) -> bool {
        self != Law::None && indentation > 0.0
    }

    /// Its part of the shader.
    pub fn shader(self) -> &'static LawShader {
        match self {
            Law::None => <Nothing as Interaction<f64>>::SHADER,
            Law::Hertz => <Hertz<f64> as Interaction<f64>>::SHADER,
            Law::Dmt => <Dmt<f64> as Interaction<f64>>::SHADER,
            Law::Jkr => <Jkr<f64> as Interaction<f64>>::SHADER,
        }
    }
}

impl std::fmt::Display for Law {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}
