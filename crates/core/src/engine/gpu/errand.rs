//! Work for devices: runs, Jacobians or searches of a plan. `deal` assigns it and handles failures.

use super::piece::Piece;
use super::session::Session;
use super::{Drill, Failure};
use crate::engine::{EngineError, Progress};
use crate::kernel::Rounding;
use crate::plan::{Class, Plan};

/// A computation for all instances of a plan.
pub(super) trait Errand: Sync {
    /// Input of a piece on a device.
    type Tables: Send + Sync;
    /// Its result there.
    type Done: Send;
    /// Where the results go.
    type Out;

    fn plan(&self) -> &Plan;

    /// Makes a piece's input, on the thread that called the engine, with its pool.
    fn tables(&self, piece: &Piece) -> Self::Tables;

    /// Runs a piece on a device; `None` if the run was stopped.
    fn on(
        &self,
        session: &Session,
        drill: &Drill,
        piece: (&mut Piece, &Self::Tables),
        progress: &Progress,
    ) -> Result<Option<Self::Done>, Failure>;

    /// Stores a device's result, on the thread that called the engine.
    fn finish(&self, class: &Class, done: Self::Done, out: &mut Self::Out);

    /// Runs a piece that no device can do.
    fn on_the_cpu(
        &self,
        piece: &Piece,
        rounding: Rounding,
        progress: &Progress,
        out: &mut Self::Out,
    ) -> Result<(), EngineError>;
}
