//! The precision of the inner loop, and whether it is still open.

use super::Plan;
use crate::scene::{Start, Steady};
use serde::{Deserialize, Serialize};

/// Floating-point precision of the engine's inner loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Precision {
    F32,
    #[default]
    F64,
}

impl Precision {
    /// `f32` or `f64`.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "f32",
            Self::F64 => "f64",
        }
    }
}

/// Number of stepped instances above which a trial of both precisions is a small part of what f32 may save.
const MANY: usize = 1024;

impl Plan {
    /// Why the precision is fixed before any run; `None` if error control decides it on a sample.
    pub fn precision_settled(&self) -> Option<&'static str> {
        if !self.precision_open {
            Some("as told")
        } else if self.run.steps_per_period.is_some() {
            Some("steps are prescribed, so f32 has no trial")
        } else if self.run.start == Start::Rest {
            // No two such runs settle on the same motion, so a sample says little about the others.
            Some("a run from rest does not forget what it rounds")
        } else if self.run.steady == Steady::Search {
            // The period maps are in f64; running on from the states found costs little.
            Some("periodic states are searched for in f64")
        } else if self.stepped().len() <= MANY {
            Some("too few instances for a trial of f32 to pay")
        } else {
            None
        }
    }
}
