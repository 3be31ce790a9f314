//! How [afmsweep](https://docs.rs/afmsweep) runs a scene: a [`plan`] of what it needs, an [`engine`] that steps it, the
//! [`periodic`] states it ends in ([`orbit`]), [`control`] of errors, the [`record`] for a file; [`sweep`] is all of it.

pub mod compare;
pub mod control;
pub mod engine;
pub mod orbit;
pub mod periodic;
pub mod plan;
pub mod record;
pub mod sweep;

use afmsweep_data::{clock, design, observe, store, units};
use afmsweep_kernel as kernel;
use afmsweep_model::{contact, instrument, matrix_product, scene};

#[cfg(test)]
mod test_plans {
    use crate::plan::{Plan, Precision};
    use crate::scene::Scene;
    use std::path::Path;

    /// The plan of a scene in f64.
    pub(crate) fn plan_of(text: &str) -> Plan {
        let scene = Scene::parse(Path::new("test.toml"), text).unwrap_or_else(|error| panic!("{error}"));
        Plan::new(&scene, Precision::F64).expect("the scene can be planned")
    }
}
