//! Searches by Newton's method on devices. Each round is a period with its Jacobian and a Newton step for all searches in
//! progress. The host reads how many are left, and at the end all states.

use super::errand::Errand;
use super::pace::Pace;
use super::pack::{self, Numbers, SlopeTables};
use super::piece::Piece;
use super::piece_buffers::PieceBuffers;
use super::rounds::{Dispatches, Search};
use super::session::Session;
use super::slopes::{SlopeChunk, longest};
use super::stride_tables::end;
use super::{Drill, Failure};
use crate::engine::newton_search::{all, state};
use crate::engine::period_jacobian::{begun, kept};
use crate::engine::{EngineError, NewtonResult, NewtonStarts, PeriodJacobian, Progress};
use crate::kernel::broyden::Phase;
use crate::kernel::newton::{ROUNDS, Walk};
use crate::kernel::{Entry, LENGTH, Rounding, ShaderSpec};
use crate::plan::{Class, Plan};
use rayon::prelude::*;
use wgpu::{Buffer, BufferUsages, SubmissionIndex};

/// Numbers of a search's progress (`Walk`) besides state and step.
pub(super) const WALK: usize = 3;

/// Searches of a plan's instances.
pub(super) struct Walks<'a> {
    /// A plan of one period, with the starts of the searches.
    pub plan: &'a Plan,
    pub seeks: &'a NewtonStarts,
    /// By instance: approximate size of terms that Jacobians may drop.
    pub least: Vec<f64>,
    /// Most bytes of a binding.
    pub binding: u64,
}

/// Input of a piece of a class on the device.
pub(super) struct WalkTables {
    slopes: SlopeTables,
    /// States, steps, and the progress of each.
    walks: Numbers,
}

/// Output of a piece: states and Jacobian columns by field.
pub(super) struct Left {
    walks: Numbers,
    columns: Numbers,
    /// By instance: its phase and its periods.
    ends: Vec<(Phase, u32)>,
}

impl Errand for Walks<'_> {
    type Tables = WalkTables;
    type Done = Left;
    type Out = Vec<NewtonResult>;

    fn plan(&self) -> &Plan {
        self.plan
    }

    fn tables(&self, piece: &Piece) -> WalkTables {
        let told = |instance: u32| {
            let (aim, start) = (self.seeks.aim::<f64>(instance), begun(self.plan, instance));
            let memory = self.plan.law(instance).has_hysteresis();
            let [memory, touching] = [memory, start.touching].map(|is| f64::from(u8::from(is)));
            vec![aim.scale, aim.near, aim.enough, memory, touching]
        };
        let slopes = pack::slope_tables(self.plan, &piece.class, (&self.least, told));
        let (modes, double) = (slopes.piece.spec.modes, slopes.piece.spec.double);
        let walk = |instance: &u32| {
            let start = begun(self.plan, *instance);
            let place = start.x[..modes].iter().chain(&start.u[..modes]).map(|number| number / LENGTH);
            let Walk { change, time, tries } = Walk::new(self.seeks.all[*instance as usize].time);
            place.chain(std::iter::repeat_n(0.0, 2 * modes)).chain([change, time, tries]).collect()
        };
        let walks: Vec<Vec<f64>> = piece.class.instances.iter().map(walk).collect();
        WalkTables { walks: Numbers::new(double, pack::transposed(&walks, |walk| walk)), slopes }
    }

    fn on(
        &self,
        session: &Session,
        drill: &Drill,
        (piece, tables): (&mut Piece, &WalkTables),
        progress: &Progress,
    ) -> Result<Option<Left>, Failure> {
        let longest = longest(self.plan, &piece.class, self.binding);
        let chunk = SlopeChunk::new(session, drill, &tables.slopes, longest)?;
        WalkChunk::new(chunk, tables)?.run(&mut piece.pace, progress)
    }

    fn finish(&self, class: &Class, left: Left, out: &mut Vec<NewtonResult>) {
        let (count, numbers) = (class.instances.len(), 2 * class.modes);
        let one = |(i, instance): (usize, &u32)| {
            let (phase, periods) = left.ends[i];
            let found = (phase == Phase::Found).then(|| PeriodJacobian {
                end: state(&begun(self.plan, *instance), numbers, |row| left.walks.get(row * count + i)),
                slope: kept((class.modes, class.modes), |row, column| {
                    left.columns.get((row * numbers + column) * count + i)
                }),
            });
            NewtonResult { phase, periods, found }
        };
        let told: Vec<NewtonResult> = class.instances.par_iter().enumerate().map(one).collect();
        class.instances.iter().zip(told).for_each(|(instance, one)| out[*instance as usize] = one);
    }

    fn on_the_cpu(
        &self,
        piece: &Piece,
        rounding: Rounding,
        progress: &Progress,
        out: &mut Vec<NewtonResult>,
    ) -> Result<(), EngineError> {
        let instances = &piece.class.instances;
        let told = all(self.plan, instances, self.seeks, rounding, progress)?;
        instances.iter().zip(told).for_each(|(instance, one)| out[*instance as usize] = one);
        Ok(())
    }
}

/// A piece on a device.
struct WalkChunk<'a> {
    periods: SlopeChunk<'a>,
    tables: &'a WalkTables,
    job: Buffer,
    walks: Buffer,
    factors: Buffer,
}

impl<'a> WalkChunk<'a> {
    fn new(periods: SlopeChunk<'a>, tables: &'a WalkTables) -> Result<Self, Failure> {
        let session = periods.session;
        let write = BufferUsages::STORAGE | BufferUsages::COPY_SRC;
        Ok(Self {
            job: PieceBuffers::job(session)?,
            walks: session.buffer("walks", tables.walks.bytes(), write)?,
            factors: session.empty("factors", tables.slopes.column_bytes(), BufferUsages::STORAGE)?,
            periods,
            tables,
        })
    }

    fn run(&self, pace: &mut Pace, progress: &Progress) -> Result<Option<Left>, Failure> {
        let (steps, session, longest) =
            (self.tables.slopes.piece.steps, self.periods.session, self.periods.longest);
        if !(Dispatches { session, pace, progress, steps, longest }.rounds(ROUNDS, self)?) {
            return Ok(None);
        }
        let left = self.left()?;
        let periods: u64 = left.ends.iter().map(|(_, periods)| u64::from(*periods)).sum();
        // One period of each is already expected with the plan.
        progress.foresee(u64::from(steps) * (periods - left.ends.len() as u64));
        progress.add(u64::from(steps) * periods);
        Ok(Some(left))
    }

    /// Waits, reads the results, and checks that each instance did its steps.
    fn left(&self) -> Result<Left, Failure> {
        let slopes = &self.tables.slopes;
        let count = slopes.piece.count() as usize;
        let walks = self.tables.walks.bytes().len() as u64;
        let wanted = [
            (&self.periods.marks, 12 * count as u64),
            (&self.walks, walks),
            (&self.periods.columns, slopes.column_bytes()),
        ];
        let bytes = self.periods.session.read(&wanted)?;
        let marks: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes[0]);
        let ends = (0..count).map(|i| end((slopes.piece.steps, ROUNDS), marks[i], marks[2 * count + i]));
        Ok(Left {
            ends: ends.collect::<Result<_, _>>()?,
            walks: Numbers::read(slopes.piece.spec.double, &bytes[1]),
            columns: Numbers::read(slopes.piece.spec.double, &bytes[2]),
        })
    }
}

impl Search for WalkChunk<'_> {
    fn period(&self, round: u32, (first, count): (u32, u32)) -> Result<SubmissionIndex, Failure> {
        self.periods.dispatch(round, first, count)
    }

    fn stride(&self, round: u32) -> Result<SubmissionIndex, Failure> {
        let Self { periods, tables, .. } = self;
        periods.drill.strike(periods.session);
        let buffers = [
            &self.job,
            &periods.on.cases,
            &periods.on.going,
            &periods.on.states,
            &periods.marks,
            &periods.columns,
            &self.walks,
            &self.factors,
        ];
        let spec = ShaderSpec { entry: Entry::Walk, ..tables.slopes.piece.spec };
        let job = tables.slopes.piece.job(round, 0, 2 * spec.modes as u32);
        periods.session.dispatch(spec, job, tables.slopes.piece.count(), &buffers)
    }

    fn going(&self) -> &Buffer {
        &self.periods.on.going
    }
}
