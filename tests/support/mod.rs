//! A second program to hold the library against: other formulas, another method, f64, slow and exact.
//!
//! Nothing here comes from the library. Use it with `mod support;` and see [`oscillator::System`].

// Every test file compiles this module for itself and uses a part of it.

pub mod extrapolation;
pub mod follow;
pub mod laws;
pub mod measure;
pub mod oscillator;
pub mod sweeper;
