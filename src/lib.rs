//! afmsweep: ensemble sweeps of atomic force microscope dynamics.

pub mod contact;
pub mod engine;
pub mod instrument;
pub mod kernel;
pub mod observe;
pub mod plan;
pub mod record;
pub mod report;
pub mod scene;
pub mod store;
mod suggest;
pub mod units;
