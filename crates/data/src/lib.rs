//! What [afmsweep](https://docs.rs/afmsweep) knows without a lever: [`units`], observables ([`observe`]), points of
//! uncertain quantities ([`design`]), forces from curves ([`reconstruction`]), results files ([`store`]) and what a study's
//! file tells ([`stats`]); and a [`clock`].

pub mod clock;
pub mod design;
pub mod observe;
pub mod reconstruction;
pub mod stats;
pub mod store;
pub mod suggestion;
pub mod units;

use afmsweep_kernel as kernel;
