//! The checkpoint of an instance between two periods, from which a run can continue elsewhere.

use crate::kernel::{MODES_MAX, RunSums};

/// One instance after a whole number of periods, kernel units.
#[derive(Clone, Copy, Debug)]
pub(super) struct InstanceCheckpoint {
    pub x: [f64; MODES_MAX],
    pub u: [f64; MODES_MAX],
    pub touching: f64,
    /// Indentation at the last two samples, and contact at the last one, as the tally keeps them.
    pub last: [f64; 2],
    pub touched: f64,
    pub run_sums: RunSums<f64>,
    /// False if the state was not finite at the end of a period.
    pub finite: bool,
}
