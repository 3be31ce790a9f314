//! afmsweep: ensemble sweeps of atomic force microscope dynamics.

pub mod contact;
pub mod instrument;
pub mod observe;
pub mod report;
pub mod scene;
pub mod store;
mod suggest;
pub mod units;
