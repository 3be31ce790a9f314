//! Periods with their Jacobians on devices.

use super::errand::Errand;
use super::pace::Pace;
use super::pack::{self, Numbers, SlopeTables};
use super::piece::Piece;
use super::piece_buffers::PieceBuffers;
use super::rounds::Dispatches;
use super::session::Session;
use super::{Drill, Failure};
use crate::engine::period_jacobian::{begun, ended, kept, of_class};
use crate::engine::{EngineError, PeriodJacobian, PeriodJacobians, Progress};
use crate::kernel::{Entry, Rounding, ShaderSpec};
use crate::plan::{Class, Plan};
use rayon::prelude::*;
use wgpu::{Buffer, BufferUsages, SubmissionIndex};

/// Most bytes of the kicks' derivatives that one dispatch leaves for the next.
const PARTIAL_BYTES: u64 = 64 << 20;

/// One period of each of a plan's instances, with its Jacobian.
pub(super) struct Periods<'a> {
    pub plan: &'a Plan,
    /// By instance: approximate size of terms that the Jacobian may drop.
    pub least: &'a [f64],
    /// Most bytes of a binding.
    pub binding: u64,
}

/// Output of a piece: states and Jacobian columns by field.
pub(super) struct Left {
    states: Numbers,
    columns: Numbers,
}

impl Errand for Periods<'_> {
    type Tables = SlopeTables;
    type Done = Left;
    type Out = PeriodJacobians;

    fn plan(&self) -> &Plan {
        self.plan
    }

    fn tables(&self, piece: &Piece) -> SlopeTables {
        pack::slope_tables(self.plan, &piece.class, (self.least, |_| Vec::new()))
    }

    fn on(
        &self,
        session: &Session,
        drill: &Drill,
        (piece, tables): (&mut Piece, &SlopeTables),
        progress: &Progress,
    ) -> Result<Option<Left>, Failure> {
        let longest = longest(self.plan, &piece.class, self.binding);
        SlopeChunk::new(session, drill, tables, longest)?.run(&mut piece.pace, progress)
    }

    fn finish(&self, class: &Class, left: Left, out: &mut PeriodJacobians) {
        let (count, modes) = (class.instances.len(), class.modes);
        let one = |(i, instance): (usize, &u32)| {
            let field = |field: usize| left.states.get(field * count + i);
            // The shader stores each mode's travel and rate side by side.
            let number = |row: usize| match row {
                row if row < modes => field(2 * row),
                row if row < 2 * modes => field(2 * (row - modes) + 1),
                row => field(row),
            };
            let end = ended(&begun(self.plan, *instance), modes, number);
            let own = self.plan.pairs(*instance);
            let at = |row: usize, column: usize| left.columns.get((row * 2 * modes + column) * count + i);
            Some(PeriodJacobian { end, slope: kept((own, modes), at) })
        };
        let told = class.instances.par_iter().enumerate().map(one).collect();
        out.put(&class.instances, told);
    }

    fn on_the_cpu(
        &self,
        piece: &Piece,
        rounding: Rounding,
        progress: &Progress,
        out: &mut PeriodJacobians,
    ) -> Result<(), EngineError> {
        let told = of_class(self.plan, &piece.class, self.least, rounding, progress)?;
        out.put(&piece.class.instances, told);
        Ok(())
    }
}

/// Most steps of a dispatch whose kicks fit into memory, for bindings of at most `binding` bytes.
pub(super) fn longest(plan: &Plan, class: &Class, binding: u64) -> u32 {
    let spec = plan.shader(class, Entry::Kicks);
    let kick = spec.bytes() * spec.partials() as u64 * class.instances.len() as u64;
    // One kick more than steps: the first step decides on the last kick of the dispatch before.
    let kicks = PARTIAL_BYTES.min(binding) / kick;
    (kicks.saturating_sub(1).max(1)).min(u64::from(class.steps)) as u32
}

/// A piece on a device.
pub(super) struct SlopeChunk<'a> {
    pub session: &'a Session,
    pub drill: &'a Drill,
    tables: &'a SlopeTables,
    /// Most steps of a dispatch.
    pub longest: u32,
    /// Parameters of the two dispatches: kicks and carry.
    jobs: [Buffer; 2],
    pub on: PieceBuffers,
    pub marks: Buffer,
    partials: Buffer,
    flows: Buffer,
    pub columns: Buffer,
}

impl<'a> SlopeChunk<'a> {
    pub fn new(
        session: &'a Session,
        drill: &'a Drill,
        tables: &'a SlopeTables,
        longest: u32,
    ) -> Result<Self, Failure> {
        let spec = &tables.piece.spec;
        let (read, write) = (BufferUsages::STORAGE, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let (count, kicks) = (u64::from(tables.piece.count()), u64::from(longest) + 1);
        Ok(Self {
            jobs: [PieceBuffers::job(session)?, PieceBuffers::job(session)?],
            on: PieceBuffers::new(session, drill, &tables.piece)?,
            // New buffers are zero.
            marks: session.empty("marks", 4 * (3 + kicks) * count, write)?,
            partials: session.empty(
                "partials",
                kicks * spec.partials() as u64 * count * spec.bytes(),
                read,
            )?,
            flows: session.buffer("flows", tables.flows.bytes(), read)?,
            columns: session.empty("columns", tables.column_bytes(), write)?,
            session,
            drill,
            tables,
            longest,
        })
    }

    fn run(&self, pace: &mut Pace, progress: &Progress) -> Result<Option<Left>, Failure> {
        let (steps, session, longest) = (self.tables.piece.steps, self.session, self.longest);
        let mut dispatches = Dispatches { session, pace, progress, steps, longest };
        if !dispatches.once(|(first, count)| self.dispatch(0, first, count))? {
            return Ok(None);
        }
        let left = self.left()?;
        progress.add(u64::from(steps) * u64::from(self.tables.piece.count()));
        Ok(Some(left))
    }

    /// Dispatches some steps of all instances in progress, then the update of the Jacobian columns.
    pub fn dispatch(&self, round: u32, first: u32, count: u32) -> Result<SubmissionIndex, Failure> {
        self.drill.strike(self.session);
        let Self { jobs: [kicks, carry], tables: SlopeTables { piece, .. }, session, on, .. } = self;
        let (job, instances) = (piece.job(round, first, count), piece.count());
        let buffers = [
            kicks,
            &on.waves,
            &on.drives,
            &on.cases,
            &on.drive_of,
            &on.states,
            &self.marks,
            &self.partials,
            &on.going,
        ];
        session.dispatch(piece.spec, job, instances, &buffers)?;
        let buffers = [
            carry,
            &on.drives,
            &on.drive_of,
            &self.flows,
            &self.marks,
            &self.partials,
            &self.columns,
            &on.going,
        ];
        let spec = ShaderSpec { entry: Entry::Carry, ..piece.spec };
        session.dispatch(spec, job, 2 * spec.modes as u32 * instances, &buffers)
    }

    /// Waits, reads the results, and checks that each instance did its steps.
    fn left(&self) -> Result<Left, Failure> {
        let (tables, double) = (self.tables, self.tables.piece.spec.double);
        let states = tables.piece.states.bytes().len() as u64;
        let marks = 4 * u64::from(tables.piece.count());
        let wanted =
            [(&self.on.states, states), (&self.marks, marks), (&self.columns, tables.column_bytes())];
        let bytes = self.session.read(&wanted)?;
        let marks: Vec<u32> = bytemuck::pod_collect_to_vec(&bytes[1]);
        let expected = tables.piece.steps;
        match marks.iter().find(|done| **done != expected) {
            Some(done) => Err(Failure::Steps { done: *done, expected }),
            None => Ok(Left {
                states: Numbers::read(double, &bytes[0]),
                columns: Numbers::read(double, &bytes[2]),
            }),
        }
    }
}
