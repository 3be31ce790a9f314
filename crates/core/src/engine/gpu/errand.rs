//! What devices are asked for: the run of a plan, or its slopes. Who does what of it when, and what becomes of what
//! fails, is the deal's business.

use super::piece::Piece;
use super::session::Session;
use super::{Drill, Failure};
use crate::engine::{EngineError, Progress};
use crate::kernel::Rounding;
use crate::plan::{Class, Plan};

/// Something that is wanted of all instances of a plan.
pub(super) trait Errand: Sync {
    /// What a device is given for a piece.
    type Tables: Send + Sync;
    /// What it gives back.
    type Done: Send;
    /// Where that goes.
    type Out;

    fn plan(&self) -> &Plan;

    /// On the thread that called the engine, with its pool.
    fn tables(&self, piece: &Piece) -> Self::Tables;

    /// On a device; none where the run was stopped.
    fn on(
        &self,
        session: &Session,
        drill: &Drill,
        piece: (&mut Piece, &Self::Tables),
        progress: &Progress,
    ) -> Result<Option<Self::Done>, Failure>;

    /// Takes in what a device has done, on the thread that called the engine.
    fn finish(&self, class: &Class, done: Self::Done, out: &mut Self::Out);

    /// What no device can do.
    fn on_the_cpu(
        &self,
        piece: &Piece,
        rounding: Rounding,
        progress: &Progress,
        out: &mut Self::Out,
    ) -> Result<(), EngineError>;
}
