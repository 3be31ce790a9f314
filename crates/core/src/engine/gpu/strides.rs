//! Searches by Broyden's method on devices. Each round is a measured period and a solver step for all searches in progress.
//! The host reads how many are left, and at the end all states.

use super::errand::Errand;
use super::pace::Pace;
use super::pack::{self, Numbers};
use super::piece::Piece;
use super::piece_buffers::PieceBuffers;
use super::rounds::{Dispatches, Search};
use super::session::Session;
use super::stride_tables::{StrideTables, end, stride_tables};
use super::{Drill, Failure};
use crate::engine::checkpoint::InstanceCheckpoint;
use crate::engine::kernel_constants::member;
use crate::engine::measurement::{Sums, finish};
use crate::engine::{Correction, EngineError, Finished, Predictions, Progress, broyden_search};
use crate::kernel::broyden::{Phase, ROUNDS};
use crate::kernel::{Entry, LENGTH, Rounding, ShaderSpec};
use crate::plan::{Case, Class, Plan};
use rayon::prelude::*;
use wgpu::{Buffer, BufferUsages, SubmissionIndex};

/// Predictions for a plan's instances, one for each, in order.
pub(super) struct Strides<'a> {
    /// In f64, of one measured period.
    pub plan: &'a Plan,
    pub guesses: &'a Predictions,
}

/// The results of predictions, in order.
pub(super) struct Ways {
    pub arrived: Vec<Correction>,
    pub places: Vec<f64>,
    pub undoes: Vec<f64>,
}

/// Output of a piece.
pub(super) struct Left {
    /// By field.
    places: Numbers,
    undoes: Numbers,
    saved: Vec<InstanceCheckpoint>,
    /// By instance: its phase and its periods.
    ends: Vec<(Phase, u32)>,
}

impl Errand for Strides<'_> {
    type Tables = StrideTables;
    type Done = Left;
    type Out = Ways;

    fn plan(&self) -> &Plan {
        self.plan
    }

    fn tables(&self, piece: &Piece) -> StrideTables {
        stride_tables(self.plan, &piece.class, self.guesses)
    }

    fn on(
        &self,
        session: &Session,
        drill: &Drill,
        (piece, tables): (&mut Piece, &StrideTables),
        progress: &Progress,
    ) -> Result<Option<Left>, Failure> {
        StrideChunk::new(session, drill, tables)?.run(&mut piece.pace, progress)
    }

    fn finish(&self, class: &Class, left: Left, out: &mut Ways) {
        let (count, numbers) = (class.instances.len(), self.guesses.numbers);
        let size = numbers * numbers;
        let one = |(i, instance): (usize, &u32)| {
            let (phase, periods) = left.ends[i];
            let finished = match phase {
                Phase::Found => self.finished(class, *instance, &left.saved[i]),
                Phase::On | Phase::Lost => Finished::NOT_RUN,
            };
            let of = |table: &Numbers, fields: usize| -> Vec<f64> {
                (0..fields).map(|field| table.get(field * count + i)).collect()
            };
            let place = of(&left.places, numbers).iter().map(|number| number * LENGTH).collect::<Vec<f64>>();
            let touching = phase == Phase::Found && left.saved[i].touching > 0.0;
            (Correction { phase, periods, finished, touching }, place, of(&left.undoes, size))
        };
        let told: Vec<_> = class.instances.par_iter().enumerate().map(one).collect();
        for (instance, (arrived, place, undoes)) in class.instances.iter().zip(told) {
            let n = *instance as usize;
            out.arrived[n] = arrived;
            out.places[n * numbers..][..numbers].copy_from_slice(&place);
            out.undoes[n * size..][..size].copy_from_slice(&undoes);
        }
    }

    fn on_the_cpu(
        &self,
        piece: &Piece,
        rounding: Rounding,
        progress: &Progress,
        out: &mut Ways,
    ) -> Result<(), EngineError> {
        let instances = &piece.class.instances;
        let mut some = self.guesses.some(instances);
        some.all.iter_mut().zip(instances).for_each(|(one, instance)| one.instance = *instance);
        let arrived = broyden_search::all(self.plan, &mut some, rounding, progress)?;
        let (numbers, size) = (some.numbers, some.numbers * some.numbers);
        for (k, (instance, arrived)) in instances.iter().zip(arrived).enumerate() {
            let n = *instance as usize;
            out.arrived[n] = arrived;
            out.places[n * numbers..][..numbers].copy_from_slice(some.place(k));
            out.undoes[n * size..][..size].copy_from_slice(some.undoes(k));
        }
        Ok(())
    }
}

impl Strides<'_> {
    /// The measurement of the last period.
    fn finished(&self, class: &Class, instance: u32, saved: &InstanceCheckpoint) -> Finished {
        let plan = self.plan;
        let (case, driven) = member(plan, instance);
        // With an infinite `least_change` no change counts against the state: one period alone cannot tell.
        let case = Case { least_change: Some(f64::INFINITY), ..case };
        let sums = Sums::new(saved.run_sums, saved.finite, 1, class.steps);
        finish(&sums, &case, driven, &plan.run, plan.wants)
    }
}

/// A piece on a device.
struct StrideChunk<'a> {
    session: &'a Session,
    drill: &'a Drill,
    tables: &'a StrideTables,
    /// Parameters of the two dispatches: period and solver step.
    jobs: [Buffer; 2],
    on: PieceBuffers,
    marks: Buffer,
    places: Buffer,
    undoes: Buffer,
}

impl<'a> StrideChunk<'a> {
    fn new(session: &'a Session, drill: &'a Drill, tables: &'a StrideTables) -> Result<Self, Failure> {
        let write = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        Ok(Self {
            jobs: [PieceBuffers::job(session)?, PieceBuffers::job(session)?],
            on: PieceBuffers::new(session, drill, &tables.piece)?,
            // New buffers are zero.
            marks: session.empty("marks", 12 * u64::from(tables.piece.count()), write)?,
            places: session.buffer("places", tables.places.bytes(), write)?,
            undoes: session.buffer("undoes", tables.undoes.bytes(), write)?,
            session,
            drill,
            tables,
        })
    }

    fn run(&self, pace: &mut Pace, progress: &Progress) -> Result<Option<Left>, Failure> {
        let (steps, session) = (self.tables.piece.steps, self.session);
        if !(Dispatches { session, pace, progress, steps, longest: u32::MAX }.rounds(ROUNDS, self)?) {
            return Ok(None);
        }
        let left = self.left()?;
        let periods: u64 = left.ends.iter().map(|(_, periods)| u64::from(*periods)).sum();
        progress.add(u64::from(steps) * periods);
        Ok(Some(left))
    }

    /// Waits, reads the results, and checks that each instance did its steps.
    fn left(&self) -> Result<Left, Failure> {
        let (tables, double) = (self.tables, self.tables.piece.spec.double);
        let (count, size) = (tables.piece.count() as usize, |numbers: &Numbers| numbers.bytes().len() as u64);
        let wanted = [
            (&self.on.states, size(&tables.piece.states)),
            (&self.marks, 12 * count as u64),
            (&self.places, size(&tables.places) / 2),
            (&self.undoes, size(&tables.undoes)),
        ];
        let bytes = self.session.read(&wanted)?;
        let marks: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes[1]);
        let ends = (0..count).map(|i| end((tables.piece.steps, ROUNDS), marks[i], marks[2 * count + i]));
        Ok(Left {
            ends: ends.collect::<Result<_, _>>()?,
            saved: pack::saved(&tables.piece.spec, &Numbers::read(double, &bytes[0]), &marks[..2 * count]),
            places: Numbers::read(double, &bytes[2]),
            undoes: Numbers::read(double, &bytes[3]),
        })
    }
}

impl Search for StrideChunk<'_> {
    fn period(&self, round: u32, (first, count): (u32, u32)) -> Result<SubmissionIndex, Failure> {
        self.drill.strike(self.session);
        let buffers = [
            &self.jobs[0],
            &self.on.waves,
            &self.on.drives,
            &self.on.cases,
            &self.on.drive_of,
            &self.on.states,
            &self.marks,
            &self.on.going,
        ];
        let spec = ShaderSpec { entry: Entry::Sweep, ..self.tables.piece.spec };
        self.session.dispatch(
            spec,
            self.tables.piece.job(round, first, count),
            self.tables.piece.count(),
            &buffers,
        )
    }

    fn stride(&self, round: u32) -> Result<SubmissionIndex, Failure> {
        self.drill.strike(self.session);
        let buffers = [
            &self.jobs[1],
            &self.on.cases,
            &self.on.going,
            &self.on.states,
            &self.marks,
            &self.places,
            &self.undoes,
        ];
        let job = self.tables.piece.job(round, 0, self.tables.numbers);
        self.session.dispatch(self.tables.piece.spec, job, self.tables.piece.count(), &buffers)
    }

    fn going(&self) -> &Buffer {
        &self.on.going
    }
}
