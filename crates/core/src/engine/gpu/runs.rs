//! Runs of plans on devices.

use super::chunk::Chunk;
use super::errand::Errand;
use super::pack::{self, Tables};
use super::piece::Piece;
use super::session::Session;
use super::{Drill, Failure};
use crate::engine::checkpoint::InstanceCheckpoint;
use crate::engine::cpu::{self, Resume};
use crate::engine::kernel_constants::member;
use crate::engine::measurement::{Sums, finish};
use crate::engine::{Ended, EngineError, Outcome, Progress, section_state};
use crate::kernel::Rounding;
use crate::plan::{Class, Plan};
use rayon::prelude::*;

/// The run of a plan.
pub(super) struct Runs<'a>(pub &'a Plan);

impl Errand for Runs<'_> {
    type Tables = Tables;
    type Done = Vec<InstanceCheckpoint>;
    type Out = Outcome;

    fn plan(&self) -> &Plan {
        self.0
    }

    fn tables(&self, piece: &Piece) -> Tables {
        let saved = piece.at.as_ref().map(|at| at.saved.as_slice());
        pack::tables(self.0, &piece.class, &piece.class.instances, saved)
    }

    fn on(
        &self,
        session: &Session,
        drill: &Drill,
        (piece, tables): (&mut Piece, &Tables),
        progress: &Progress,
    ) -> Result<Option<Vec<InstanceCheckpoint>>, Failure> {
        let done = piece.done();
        let Piece { class, at, pace, .. } = piece;
        Chunk::new(self.0, class, session, drill, tables)?.run(done, pace, at, progress)
    }

    fn finish(&self, class: &Class, saved: Vec<InstanceCheckpoint>, out: &mut Outcome) {
        let plan = self.0;
        let tell = plan.starts.is_some();
        let one = |(instance, saved): (&u32, &InstanceCheckpoint)| {
            let (case, driven) = member(plan, *instance);
            let sums = Sums::new(saved.run_sums, saved.finite, plan.run.measure, class.steps);
            Ended {
                finished: finish(&sums, &case, driven, &plan.run, plan.wants),
                end: tell.then(|| Box::new(section_state::section_state(saved))),
            }
        };
        let ended = class.instances.par_iter().zip(&saved).map(one).collect();
        out.put(&class.instances, ended);
    }

    fn on_the_cpu(
        &self,
        piece: &Piece,
        rounding: Rounding,
        progress: &Progress,
        out: &mut Outcome,
    ) -> Result<(), EngineError> {
        let resume = piece.at.as_ref().map(|at| Resume::Saved(&at.saved, at.done));
        let ended = cpu::resume(self.0, &piece.class, resume, rounding, progress)?;
        out.put(&piece.class.instances, ended);
        Ok(())
    }
}
