//! A run whose chunks are finished: memory holds one byte for each instance, the journal holds the rest.

use super::choices::Choices;
use super::chunk::{Chunk, ChunkJournal};
use super::chunk_view::{ChunkView, RunContext};
use super::chunking::Chunking;
use super::codec::ChunkReader;
use super::compact_orbit::CompactOrbit;
use super::instance_flags::InstanceFlags;
use super::instance_record::ChunkMeta;
use super::second_orbit_table::SecondOrbitTable;
use super::{Arithmetic, RunResult};
use crate::engine::{EngineError, Finished, ResultColumns};
use crate::observe::Status;
use crate::orbit::OrbitTable;
use crate::plan::{Plan, Precision, Resolution};
use std::ops::ControlFlow;

/// A run of all instances to the requested accuracy. There may be very many, so memory holds one byte for each.
pub struct JournaledRun<'k> {
    /// The plan with the chosen bases, before refinement.
    pub plan: Plan,
    /// Messages for the user, one line each.
    pub notes: Vec<String>,
    /// The reason for the arithmetic.
    pub reason: String,
    /// Largest effect of rounding in the sample that ran in both, on the scale of accuracy. NaN without a sample.
    pub rounding: f64,
    /// Whether states were searched for.
    pub searched: bool,
    /// Whether the instances are points of curves.
    pub curves: bool,
    /// Whether searches from rest ran.
    from_rest: bool,
    /// Rounding error to add to each estimate. Empty if it is included, or zero.
    pub(super) added: Vec<f64>,
    flags: Vec<InstanceFlags>,
    neighbour_started: usize,
    chunking: Chunking,
    /// For each chunk, whether the journal holds it.
    kept: Vec<bool>,
    keep: &'k dyn ChunkJournal,
}

impl<'k> JournaledRun<'k> {
    /// A run before its first step.
    pub(super) fn not_begun(
        plan: Plan,
        choices: &Choices,
        division: Chunking,
        keep: &'k dyn ChunkJournal,
    ) -> Self {
        Self {
            notes: Vec::new(),
            reason: choices.precision.reason.clone(),
            rounding: choices.precision.rounding,
            searched: false,
            curves: false,
            from_rest: false,
            added: Vec::new(),
            flags: vec![InstanceFlags::not_run(choices.precision.precision); plan.len()],
            neighbour_started: 0,
            kept: vec![false; division.len()],
            chunking: division,
            keep,
            plan,
        }
    }

    /// The instances of a chunk.
    pub(super) fn chunk(&self, number: usize) -> &[u32] {
        self.chunking.chunk(number)
    }

    /// How its instances are divided into chunks.
    pub(super) fn division(&self) -> &Chunking {
        &self.chunking
    }

    /// Takes a chunk that the journal holds.
    pub(super) fn take(&mut self, number: usize, portion: &Chunk) {
        for (i, mark) in self.chunking.chunk(number).iter().zip(&portion.flags) {
            self.flags[*i as usize] = *mark;
        }
        self.neighbour_started += portion.neighbour_started;
        let ChunkMeta { whole: _, searched, curves, from_rest, notes } = &portion.meta;
        self.searched |= searched;
        self.curves |= curves;
        self.from_rest |= from_rest;
        self.notes.extend(notes.iter().cloned());
        self.kept[number] = true;
    }

    /// Flags of each instance, in the order of their numbers.
    pub fn marks(&self) -> &[InstanceFlags] {
        &self.flags
    }

    /// How many instances it has.
    pub fn len(&self) -> usize {
        self.flags.len()
    }

    /// Whether it has none.
    pub fn is_empty(&self) -> bool {
        self.flags.is_empty()
    }

    /// Status of an instance.
    pub fn status(&self, instance: u32) -> Status {
        self.flags[instance as usize].status()
    }

    /// Whether every instance of the chunks that `portions` accepts was run.
    pub fn is_run(&self, portions: impl Fn(usize) -> bool) -> bool {
        let mut wanted = (0..self.chunking.len()).filter(|number| portions(*number));
        wanted.all(|number| self.chunk(number).iter().all(|i| self.status(*i) != Status::NotRun))
    }

    /// Number of instances with this status.
    pub fn count(&self, status: Status) -> usize {
        self.flags.iter().filter(|mark| mark.status() == status).count()
    }

    /// Marks an instance whose error turned out to be above the requested accuracy.
    pub fn miss(&mut self, instance: u32) {
        let mark = &mut self.flags[instance as usize];
        if mark.status() == Status::Ok {
            *mark = mark.called(Status::AccuracyNotMet);
        }
    }

    /// The share of the instances whose results come from searches started at their neighbours' states.
    pub fn neighbour_started(&self) -> f64 {
        self.neighbour_started as f64 / self.len().max(1) as f64
    }

    /// Number of instances whose last run was not in the plan's arithmetic.
    pub fn in_other_precision(&self) -> usize {
        self.flags.iter().filter(|mark| mark.precision() != self.plan.precision).count()
    }

    /// `f32`, `f64` or `mixed`.
    pub fn precision(&self) -> &'static str {
        let first = self.flags.first().map_or(Precision::default(), |mark| mark.precision());
        if self.flags.iter().any(|mark| mark.precision() != first) { "mixed" } else { first.name() }
    }

    /// Shows all chunks in order until `show` breaks.
    ///
    /// # Errors
    /// A stored chunk cannot be read.
    pub fn each(&self, show: &mut dyn FnMut(&ChunkView) -> ControlFlow<()>) -> Result<(), EngineError> {
        for number in 0..self.chunking.len() {
            if self.shown(number, show)?.is_break() {
                break;
            }
        }
        Ok(())
    }

    /// Shows all chunks with their plans and flags only; stored bytes are not read.
    pub fn each_unread(&self, show: &mut dyn FnMut(&ChunkView)) {
        for number in 0..self.chunking.len() {
            show(&ChunkView::new(self.context(), self.chunking.chunk(number), None));
        }
    }

    /// The context of each chunk.
    fn context(&self) -> RunContext<'_> {
        RunContext { plan: &self.plan, marks: &self.flags, added: &self.added }
    }

    fn shown<T>(&self, number: usize, show: &mut dyn FnMut(&ChunkView) -> T) -> Result<T, EngineError> {
        let instances = self.chunking.chunk(number);
        if !self.kept[number] {
            return Ok(show(&ChunkView::new(self.context(), instances, None)));
        }
        let source = |range| self.keep.bytes(number, range);
        let unread = |why: &str| EngineError::Unread { why: why.to_owned() };
        let view = ChunkReader::of(&source, number, instances.len()).map_err(|why| unread(&why))?;
        let piece = ChunkView::new(self.context(), instances, Some(view));
        let shown = show(&piece);
        match piece.view.as_ref().and_then(ChunkReader::failure) {
            Some(why) => Err(unread(why)),
            None => Ok(shown),
        }
    }

    /// Finite estimates of the instances with status ok, in ascending order.
    ///
    /// # Errors
    /// Those of [`JournaledRun::each`].
    pub fn estimates_of_ok(&self) -> Result<Vec<f64>, EngineError> {
        let mut known = Vec::new();
        self.each(&mut |piece| {
            let all = piece.instances.iter().zip(piece.estimates());
            let ok = all.filter(|(i, estimate)| self.status(**i) == Status::Ok && estimate.is_finite());
            known.extend(ok.map(|(_, estimate)| estimate));
            ControlFlow::Continue(())
        })?;
        known.sort_unstable_by(f64::total_cmp);
        Ok(known)
    }

    /// Loads these instances as a run of their own, in this order.
    ///
    /// # Errors
    /// Those of [`JournaledRun::each`].
    pub fn some(&self, instances: &[u32]) -> Result<RunResult, EngineError> {
        /// Marks instances that are not among them.
        const NONE: u32 = u32::MAX;
        let mut places = vec![NONE; self.len()];
        instances.iter().enumerate().for_each(|(n, i)| places[*i as usize] = n as u32);
        let here = |number: usize| -> Vec<(usize, usize)> {
            let all = self.chunk(number).iter().map(|i| places[*i as usize]).enumerate();
            all.filter(|(_, place)| *place != NONE).map(|(n, place)| (n, place as usize)).collect()
        };
        let show = |take: &mut dyn FnMut(&ChunkReader, usize, usize, &ChunkView)| -> Result<(), EngineError> {
            for number in 0..self.chunking.len() {
                let here = here(number);
                if here.is_empty() {
                    continue;
                }
                self.shown(number, &mut |piece| {
                    let Some(view) = &piece.view else { return };
                    here.iter().for_each(|(there, n)| take(view, *there, *n, piece));
                })?;
            }
            Ok(())
        };
        let mut whole = GatheredRun::of(self, instances);
        show(&mut |view, there, n, piece| whole.take((view, piece), there, n))?;
        whole.run.plan = whole.run.plan.with_resolutions(&std::mem::take(&mut whole.fineness));
        show(&mut |view, there, n, _| whole.take_places(view, there, n))?;
        Ok(whole.run)
    }

    /// Loads all instances.
    ///
    /// # Errors
    /// Those of [`JournaledRun::each`].
    pub fn gathered(&self) -> Result<RunResult, EngineError> {
        self.some(&self.plan.instances().collect::<Vec<u32>>())
    }
}

/// A run in memory, filled instance by instance.
struct GatheredRun {
    run: RunResult,
    fineness: Vec<Resolution>,
}

impl GatheredRun {
    fn of(run: &JournaledRun, instances: &[u32]) -> Self {
        let (plan, count) = (run.plan.part(instances), instances.len());
        let fineness = plan.instances().map(|i| plan.resolution_of(i)).collect();
        let of = instances.iter().map(|i| run.flags[*i as usize].precision()).collect();
        let run = RunResult {
            results: ResultColumns::of_observables(count, &plan.observables),
            notes: run.notes.clone(),
            estimates: vec![f64::NAN; count],
            truncation: vec![f64::NAN; count],
            found: if run.searched { OrbitTable::none_of(count) } else { OrbitTable::default() },
            periods: vec![0; count],
            jumps: vec![false; if run.curves { count } else { 0 }],
            neighbour_started: vec![false; if run.chunking.blocks.is_some() { count } else { 0 }],
            arithmetic: Arithmetic { of, rounding: run.rounding, reason: run.reason.clone() },
            from_rest: if run.from_rest {
                SecondOrbitTable::none_of(&plan)
            } else {
                SecondOrbitTable::default()
            },
            plan,
        };
        Self { run, fineness }
    }

    /// Takes an instance: number `there` of its chunk, number `n` here.
    fn take(&mut self, (view, piece): (&ChunkReader, &ChunkView), there: usize, n: usize) {
        let Some(one) = view.ended(there) else { return };
        let RunResult { results, estimates, truncation: left_out, periods, jumps, neighbour_started, .. } =
            &mut self.run;
        self.fineness[n] = one.fineness;
        results.set(n, &Finished { status: piece.status(there), ..one.finished });
        estimates[n] = piece.estimate(there);
        left_out[n] = one.left_out;
        periods[n] = one.periods;
        jumps.get_mut(n).into_iter().for_each(|jump| *jump = one.jump);
        neighbour_started.get_mut(n).into_iter().for_each(|begun| *begun = one.neighbour_started);
    }

    /// Takes the instance's states. The plan must have its resolutions by then.
    fn take_places(&mut self, view: &ChunkReader, there: usize, n: usize) {
        let Some(one) = view.ended(there) else { return };
        let RunResult { plan, found, from_rest, .. } = &mut self.run;
        let of = |place: &CompactOrbit| place.state(plan, n as u32);
        found.put(n, one.state.as_ref().map(of).as_deref());
        if let Some((finished, place)) = one.from_rest.as_deref() {
            from_rest.put(n, finished, &of(place));
        }
    }
}
