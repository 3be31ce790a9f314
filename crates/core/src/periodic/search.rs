//! One search.

use super::options::Options;
use super::size::{Memory, Size};
use super::spectrum::{Spectrum, factors};
use crate::kernel::newton::{FARTHEST, GAINS, LONGER, LONGEST, NEWTON};
use nalgebra::{DefaultAllocator, LU, OMatrix, OVector, U1};

/// A fixed point.
#[derive(Clone, Debug)]
pub struct Found<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    pub state: OVector<f64, D>,
    /// The map's slope there.
    pub slope: OMatrix<f64, D, D>,
    pub spectrum: Spectrum,
}

/// Why there is none.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Lost {
    /// Too many evaluations, or no step leads nearer.
    Stuck,
    /// A fixed point that a small push leaves for good.
    Unstable,
    /// The map ends at no number, or in another contact than it began.
    Undefined,
}

#[derive(Clone, Debug)]
pub enum Verdict<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    Found(Box<Found<D>>),
    Lost(Lost),
}

/// Time that the first stride stands for, periods.
const FIRST: f64 = 20.0;

/// Where the change has fallen by less, the slope is taken anew.
const CARRIED: f64 = 3.0;
#[derive(Clone, Debug)]
pub(super) enum Stage<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    /// The map at the start.
    Begin,
    /// The slope by one-sided differences, of the columns that are not guessed or of all.
    Slope {
        whole: bool,
    },
    /// A stride, and how often it was shortened.
    Stride {
        step: OVector<f64, D>,
        shorter: u32,
    },
    /// The slope by central differences, or as the map tells it: the end.
    Last,
    Done(Verdict<D>),
}

/// Where the slope is from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Taken {
    /// Carried along from another state.
    Elsewhere,
    /// Taken here, but for the columns that are guessed.
    Partly,
    /// All of it taken here.
    Whole,
}

/// A search on its way.
#[derive(Clone, Debug)]
pub struct Search<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    pub(super) options: Options,
    /// Where it stands, and by how much the map moves that.
    pub(super) state: OVector<f64, D>,
    pub(super) change: OVector<f64, D>,
    pub(super) slope: OMatrix<f64, D, D>,
    /// Numbers of the state that the map moves, where these are not all.
    moving: Option<Vec<usize>>,
    /// Columns of the slope that no guess stands for.
    pub(super) columns: Vec<usize>,
    /// What is known of the slope at the fixed point of a map that differs little from this one.
    pub(super) known: Option<Spectrum>,
    pub(super) taken: Taken,
    /// Time, in periods, that the next stride stands for.
    pub(super) time: f64,
    pub(super) stage: Stage<D>,
    pub(super) evaluations: u32,
    /// The same, but that a slope that the map has told counts as by differences: a search gives up as early with either.
    pub(super) spent: u32,
}

impl<D: Size> Search<D>
where
    DefaultAllocator: Memory<D>,
{
    /// From `state` on.
    pub fn new(state: OVector<f64, D>, options: Options) -> Self {
        let size = state.shape_generic().0;
        Self {
            options,
            change: OVector::zeros_generic(size, U1),
            slope: OMatrix::zeros_generic(size, size),
            moving: None,
            columns: (0..size.value()).collect(),
            known: None,
            taken: Taken::Elsewhere,
            time: if options.near { f64::INFINITY } else { FIRST },
            stage: Stage::Begin,
            evaluations: 0,
            spent: 0,
            state,
        }
    }

    /// From `state` on, where the slope's columns are `slope`'s but for `columns`, more or less: only these are taken
    /// by differences on the way.
    pub fn guided(
        state: OVector<f64, D>,
        slope: OMatrix<f64, D, D>,
        columns: Vec<usize>,
        options: Options,
    ) -> Self {
        Self { slope, columns, ..Self::new(state, options) }
    }

    /// From the fixed point of a map that differs little from this one, and that map's slope there.
    pub fn beside(
        state: OVector<f64, D>,
        slope: OMatrix<f64, D, D>,
        known: Spectrum,
        options: Options,
    ) -> Self {
        let options = Options { near: true, ..options };
        Self { slope, known: Some(known), ..Self::new(state, options) }
    }

    /// The same search where the map leaves all numbers but these, if any are given, at rest: no evaluation is spent on the
    /// others.
    pub fn among(mut self, moving: Option<Vec<usize>>) -> Self {
        self.columns.retain(|column| moving.as_ref().is_none_or(|moving| moving.contains(column)));
        Self { moving, ..self }
    }

    /// Place in the state of the n-th number that moves.
    fn moved(&self, n: usize) -> usize {
        self.moving.as_ref().map_or(n, |moving| moving[n])
    }

    /// Numbers that move.
    pub fn size(&self) -> usize {
        self.moving.as_ref().map_or(self.state.len(), Vec::len)
    }

    /// Evaluations so far: each takes one period.
    pub fn evaluations(&self) -> u32 {
        self.evaluations
    }

    /// How it ended, once it has.
    pub fn verdict(&self) -> Option<&Verdict<D>> {
        match &self.stage {
            Stage::Done(verdict) => Some(verdict),
            _ => None,
        }
    }

    /// States at which it wants to know the map next; none once it has ended.
    pub fn asks(&self) -> impl ExactSizeIterator<Item = OVector<f64, D>> {
        (0..self.wants()).map(|n| self.place(n))
    }

    /// How many [`Search::asks`] for.
    pub fn wants(&self) -> usize {
        match &self.stage {
            Stage::Begin | Stage::Stride { .. } => 1,
            Stage::Slope { whole } if self.tells(*whole) => 1,
            Stage::Slope { whole: true } => self.size(),
            Stage::Slope { whole: false } => self.columns.len(),
            Stage::Last if self.tells_last() => 1,
            Stage::Last => 2 * self.size(),
            Stage::Done(_) => 0,
        }
    }

    fn place(&self, n: usize) -> OVector<f64, D> {
        let mut state = self.state.clone();
        match &self.stage {
            Stage::Begin | Stage::Done(_) => {}
            Stage::Slope { whole } if self.tells(*whole) => {}
            Stage::Last if self.tells_last() => {}
            Stage::Stride { step, .. } => state += step,
            Stage::Slope { whole } => {
                let k = if *whole { self.moved(n) } else { self.columns[n] };
                state[k] += self.options.step * self.options.scale;
            }
            Stage::Last => {
                let step = self.last_step() * self.options.scale;
                state[self.moved(n / 2)] += if n.is_multiple_of(2) { -step } else { step };
            }
        }
        state
    }

    /// Takes the answers, in the order of [`Search::asks`]; none where the map has no answer of use.
    pub fn answer(&mut self, values: &[Option<OVector<f64, D>>]) {
        self.evaluations += values.len() as u32;
        self.spent += values.len() as u32;
        let stage = std::mem::replace(&mut self.stage, Stage::Done(Verdict::Lost(Lost::Stuck)));
        let next = match stage {
            Stage::Begin => self.begun(values),
            Stage::Slope { whole } => match self.one_sided(whole, values) {
                true => self.stride(),
                false => Stage::Done(Verdict::Lost(Lost::Undefined)),
            },
            Stage::Stride { step, shorter } => self.arrived(step, shorter, values),
            Stage::Last => self.last(values),
            done @ Stage::Done(_) => done,
        };
        self.go_on(next);
    }

    pub(super) fn go_on(&mut self, next: Stage<D>) {
        self.stage = next;
        if self.spent >= self.options.most && self.verdict().is_none() {
            self.stage = Stage::Done(Verdict::Lost(Lost::Stuck));
        }
    }

    /// Step of central differences.
    fn last_step(&self) -> f64 {
        self.options.last_step.unwrap_or(self.options.step)
    }

    fn begun(&mut self, values: &[Option<OVector<f64, D>>]) -> Stage<D> {
        match values {
            [Some(value)] => {
                self.change = value - &self.state;
                if self.known.is_some() || self.options.carried {
                    self.stride()
                } else {
                    Stage::Slope { whole: false }
                }
            }
            _ => Stage::Done(Verdict::Lost(Lost::Undefined)),
        }
    }

    /// Differences against the map here.
    fn one_sided(&mut self, whole: bool, values: &[Option<OVector<f64, D>>]) -> bool {
        let here = &self.state + &self.change;
        for (n, value) in values.iter().enumerate() {
            let Some(value) = value else { return false };
            let k = if whole { self.moved(n) } else { self.columns[n] };
            self.slope.set_column(k, &((value - &here) / (self.options.step * self.options.scale)));
        }
        // What was known led astray.
        (self.taken, self.known) =
            (if whole || values.len() == self.size() { Taken::Whole } else { Taken::Partly }, None);
        true
    }

    /// The step that `time` periods of the linear flow would make; Newton's for all time.
    fn step(&self, time: f64) -> Option<OVector<f64, D>> {
        self.step_by(&factors(&self.slope, 1.0 + 1.0 / time))
    }

    fn step_by(&self, factors: &LU<f64, D, D>) -> Option<OVector<f64, D>> {
        let step = factors.solve(&self.change)?;
        step.iter().all(|value| value.is_finite()).then_some(step)
    }

    /// The next stride, or the end where Newton's step is short enough.
    pub(super) fn stride(&mut self) -> Stage<D> {
        let stuck = Stage::Done(Verdict::Lost(Lost::Stuck));
        let near = self.options.tolerance * self.options.scale;
        // Newton's step is no shorter than the change it undoes over the norm of 1 - slope.
        let far = self.change.norm() > near * (1.0 + self.slope.norm());
        let time = if far && self.time < NEWTON { self.time } else { f64::INFINITY };
        let newton = factors(&self.slope, 1.0 + 1.0 / time);
        let Some(mut step) = self.step_by(&newton) else { return stuck };
        if !far && step.norm() <= near {
            return self.ended(step, &newton);
        }
        if !far && self.time < NEWTON {
            match self.step(self.time) {
                Some(shorter) => step = shorter,
                None => return stuck,
            }
        }
        let (length, longest) = (step.norm(), FARTHEST * self.options.scale);
        if length > longest {
            step *= longest / length;
        }
        Stage::Stride { step, shorter: 0 }
    }

    /// After a stride.
    fn arrived(
        &mut self,
        step: OVector<f64, D>,
        shorter: u32,
        values: &[Option<OVector<f64, D>>],
    ) -> Stage<D> {
        if let [Some(value)] = values {
            let state = &self.state + &step;
            let change = value - &state;
            let gain = self.change.norm() / change.norm().max(f64::MIN_POSITIVE);
            // Early strides may climb a little, as the flow does.
            let least = if self.time < NEWTON { 0.5 } else { GAINS };
            if gain >= least {
                // Broyden's update of the slope minus one.
                let predicted = &self.slope * &step - &step;
                let miss = &change - &self.change - predicted;
                self.slope.ger(1.0 / step.norm_squared(), &miss, &step, 1.0);
                (self.state, self.change, self.taken) = (state, change, Taken::Elsewhere);
                self.time *= (LONGER * gain).clamp(0.5, LONGEST);
                return if gain < CARRIED { Stage::Slope { whole: false } } else { self.stride() };
            }
        }
        if self.taken == Taken::Elsewhere {
            return Stage::Slope { whole: false };
        }
        if self.taken == Taken::Partly && shorter == 1 {
            // The guess may be why.
            return Stage::Slope { whole: true };
        }
        if shorter == 4 {
            if self
                .step(f64::INFINITY)
                .is_some_and(|newton| newton.norm() <= self.options.enough * self.options.scale)
            {
                if self.tells(true) && self.taken == Taken::Whole {
                    return self.found(Spectrum::new(&self.slope, &factors(&self.slope, 1.0)));
                }
                return Stage::Last;
            }
            return Stage::Done(Verdict::Lost(if values == [None] { Lost::Undefined } else { Lost::Stuck }));
        }
        self.time = (0.25 * self.time).min(NEWTON);
        Stage::Stride { step: 0.25 * step, shorter: shorter + 1 }
    }

    fn last(&mut self, values: &[Option<OVector<f64, D>>]) -> Stage<D> {
        for n in 0..self.size() {
            let (Some(Some(low)), Some(Some(high))) = (values.get(2 * n), values.get(2 * n + 1)) else {
                return Stage::Done(Verdict::Lost(Lost::Undefined));
            };
            self.slope
                .set_column(self.moved(n), &((high - low) / (2.0 * self.last_step() * self.options.scale)));
        }
        self.found(Spectrum::new(&self.slope, &factors(&self.slope, 1.0)))
    }

    pub(super) fn found(&self, spectrum: Spectrum) -> Stage<D> {
        let multiplier = spectrum.multiplier;
        if multiplier.is_nan() || (self.options.stable && multiplier >= 1.0) {
            return Stage::Done(Verdict::Lost(Lost::Unstable));
        }
        Stage::Done(Verdict::Found(Box::new(Found {
            state: self.state.clone(),
            slope: self.slope.clone(),
            spectrum,
        })))
    }
}
