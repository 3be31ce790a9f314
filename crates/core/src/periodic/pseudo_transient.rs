//! Newton's method with pseudo-transient continuation: one search.

use super::floquet::{Floquet, factors};
use super::newton_options::NewtonOptions;
use super::search_failure::SearchFailure;
use super::size::{Memory, Size};
use crate::kernel::newton::{FARTHEST, GAINS, LONGER, LONGEST, NEWTON};
use nalgebra::{DefaultAllocator, LU, OMatrix, OVector, U1};

/// A fixed point.
#[derive(Clone, Debug)]
pub struct FixedPoint<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    pub state: OVector<f64, D>,
    /// The map's Jacobian there.
    pub slope: OMatrix<f64, D, D>,
    pub spectrum: Floquet,
}

#[derive(Clone, Debug)]
pub enum PtcOutcome<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    Converged(Box<FixedPoint<D>>),
    Failed(SearchFailure),
}

/// Pseudo-time of the first step, periods.
const FIRST_PSEUDO_TIME: f64 = 20.0;

/// The Jacobian is computed again if a step reduces the residual by less than this factor.
const REUSE_REDUCTION: f64 = 3.0;
#[derive(Clone, Debug)]
pub(super) enum Stage<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    /// The map at the start.
    Begin,
    /// The Jacobian by one-sided differences: the columns without a guess, or the whole.
    Slope {
        whole: bool,
    },
    /// A step, and how often it was shortened.
    Stride {
        step: OVector<f64, D>,
        shorter: u32,
    },
    /// The last Jacobian, by central differences or from the map.
    Last,
    Done(PtcOutcome<D>),
}

/// Where the Jacobian comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JacobianSource {
    /// From another state, or updated since.
    Transferred,
    /// Computed here, apart from the guessed columns.
    Partial,
    /// Computed here as a whole.
    Full,
}

/// A search that is running.
#[derive(Clone, Debug)]
pub struct PtcNewton<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    pub(super) options: NewtonOptions,
    /// The present state, and its residual: value of the map minus the state.
    pub(super) state: OVector<f64, D>,
    pub(super) change: OVector<f64, D>,
    pub(super) jacobian: OMatrix<f64, D, D>,
    /// Indices of the numbers that the map moves, if these are not all.
    moving: Option<Vec<usize>>,
    /// Columns of the Jacobian without a guess.
    pub(super) columns: Vec<usize>,
    /// Stability of the fixed point of a map that differs little from this one.
    pub(super) known_floquet: Option<Floquet>,
    pub(super) jacobian_source: JacobianSource,
    /// Pseudo-time of the next step, periods.
    pub(super) pseudo_time: f64,
    pub(super) stage: Stage<D>,
    pub(super) evaluations: u32,
    /// The same, but a Jacobian from the map counts as by differences, so that a search gives up equally early with either.
    pub(super) evaluations_by_differences: u32,
}

impl<D: Size> PtcNewton<D>
where
    DefaultAllocator: Memory<D>,
{
    /// Starts at `state`.
    pub fn new(state: OVector<f64, D>, options: NewtonOptions) -> Self {
        let size = state.shape_generic().0;
        Self {
            options,
            change: OVector::zeros_generic(size, U1),
            jacobian: OMatrix::zeros_generic(size, size),
            moving: None,
            columns: (0..size.value()).collect(),
            known_floquet: None,
            jacobian_source: JacobianSource::Transferred,
            pseudo_time: if options.start_is_close { f64::INFINITY } else { FIRST_PSEUDO_TIME },
            stage: Stage::Begin,
            evaluations: 0,
            evaluations_by_differences: 0,
            state,
        }
    }

    /// Starts at `state` with the approximate Jacobian `slope`, apart from `columns`: only these are taken by differences on
    /// the way.
    pub fn with_partial_jacobian(
        state: OVector<f64, D>,
        slope: OMatrix<f64, D, D>,
        columns: Vec<usize>,
        options: NewtonOptions,
    ) -> Self {
        Self { jacobian: slope, columns, ..Self::new(state, options) }
    }

    /// Starts at the fixed point of a map that differs little from this one, with that map's Jacobian there.
    pub fn near_fixed_point(
        state: OVector<f64, D>,
        slope: OMatrix<f64, D, D>,
        known: Floquet,
        options: NewtonOptions,
    ) -> Self {
        let options = NewtonOptions { start_is_close: true, ..options };
        Self { jacobian: slope, known_floquet: Some(known), ..Self::new(state, options) }
    }

    /// Restricts the search to the numbers `moving`, if given. The map leaves the others at rest, and they cost no
    /// evaluations.
    pub fn restricted_to(mut self, moving: Option<Vec<usize>>) -> Self {
        self.columns.retain(|column| moving.as_ref().is_none_or(|moving| moving.contains(column)));
        Self { moving, ..self }
    }

    /// Index in the state of the n-th moving number.
    fn moved(&self, n: usize) -> usize {
        self.moving.as_ref().map_or(n, |moving| moving[n])
    }

    /// Number of moving numbers.
    pub fn size(&self) -> usize {
        self.moving.as_ref().map_or(self.state.len(), Vec::len)
    }

    /// Evaluations so far. Each takes one period.
    pub fn evaluations(&self) -> u32 {
        self.evaluations
    }

    /// The outcome; `None` while the search runs.
    pub fn verdict(&self) -> Option<&PtcOutcome<D>> {
        match &self.stage {
            Stage::Done(verdict) => Some(verdict),
            _ => None,
        }
    }

    /// States at which the map is needed next; none once the search has ended.
    pub fn ask(&self) -> impl ExactSizeIterator<Item = OVector<f64, D>> {
        (0..self.ask_count()).map(|n| self.point(n))
    }

    /// Number of states in [`PtcNewton::ask`].
    pub fn ask_count(&self) -> usize {
        match &self.stage {
            Stage::Begin | Stage::Stride { .. } => 1,
            Stage::Slope { whole } if self.tells_jacobian(*whole) => 1,
            Stage::Slope { whole: true } => self.size(),
            Stage::Slope { whole: false } => self.columns.len(),
            Stage::Last if self.tells_last_jacobian() => 1,
            Stage::Last => 2 * self.size(),
            Stage::Done(_) => 0,
        }
    }

    fn point(&self, n: usize) -> OVector<f64, D> {
        let mut state = self.state.clone();
        match &self.stage {
            Stage::Begin | Stage::Done(_) => {}
            Stage::Slope { whole } if self.tells_jacobian(*whole) => {}
            Stage::Last if self.tells_last_jacobian() => {}
            Stage::Stride { step, .. } => state += step,
            Stage::Slope { whole } => {
                let k = if *whole { self.moved(n) } else { self.columns[n] };
                state[k] += self.options.fd_step * self.options.scale;
            }
            Stage::Last => {
                let step = self.last_step() * self.options.scale;
                state[self.moved(n / 2)] += if n.is_multiple_of(2) { -step } else { step };
            }
        }
        state
    }

    /// Takes the map's values, in the order of [`PtcNewton::ask`]; `None` where the map is undefined.
    pub fn tell(&mut self, values: &[Option<OVector<f64, D>>]) {
        self.evaluations += values.len() as u32;
        self.evaluations_by_differences += values.len() as u32;
        let stage =
            std::mem::replace(&mut self.stage, Stage::Done(PtcOutcome::Failed(SearchFailure::NoDescent)));
        let next = match stage {
            Stage::Begin => self.begun(values),
            Stage::Slope { whole } => match self.one_sided(whole, values) {
                true => self.next_step(),
                false => Stage::Done(PtcOutcome::Failed(SearchFailure::Undefined)),
            },
            Stage::Stride { step, shorter } => self.after_step(step, shorter, values),
            Stage::Last => self.last(values),
            done @ Stage::Done(_) => done,
        };
        self.go_on(next);
    }

    pub(super) fn go_on(&mut self, next: Stage<D>) {
        self.stage = next;
        if self.evaluations_by_differences >= self.options.max_evaluations && self.verdict().is_none() {
            self.stage = Stage::Done(PtcOutcome::Failed(SearchFailure::OutOfEvaluations));
        }
    }

    /// Step of central differences.
    fn last_step(&self) -> f64 {
        self.options.central_fd_step.unwrap_or(self.options.fd_step)
    }

    fn begun(&mut self, values: &[Option<OVector<f64, D>>]) -> Stage<D> {
        match values {
            [Some(value)] => {
                self.change = value - &self.state;
                if self.known_floquet.is_some() || self.options.reuse_jacobian {
                    self.next_step()
                } else {
                    Stage::Slope { whole: false }
                }
            }
            _ => Stage::Done(PtcOutcome::Failed(SearchFailure::Undefined)),
        }
    }

    /// Takes columns of the Jacobian by differences from the value at the state.
    fn one_sided(&mut self, whole: bool, values: &[Option<OVector<f64, D>>]) -> bool {
        let here = &self.state + &self.change;
        for (n, value) in values.iter().enumerate() {
            let Some(value) = value else { return false };
            let k = if whole { self.moved(n) } else { self.columns[n] };
            self.jacobian.set_column(k, &((value - &here) / (self.options.fd_step * self.options.scale)));
        }
        // The Jacobian known before led astray.
        (self.jacobian_source, self.known_floquet) = (
            if whole || values.len() == self.size() { JacobianSource::Full } else { JacobianSource::Partial },
            None,
        );
        true
    }

    /// The step of the linear flow over `time` periods; Newton's step for infinite time.
    fn step(&self, time: f64) -> Option<OVector<f64, D>> {
        self.solve_step(&factors(&self.jacobian, 1.0 + 1.0 / time))
    }

    fn solve_step(&self, factors: &LU<f64, D, D>) -> Option<OVector<f64, D>> {
        let step = factors.solve(&self.change)?;
        step.iter().all(|value| value.is_finite()).then_some(step)
    }

    /// The next step, or the end if Newton's step is short enough.
    pub(super) fn next_step(&mut self) -> Stage<D> {
        let stuck = Stage::Done(PtcOutcome::Failed(SearchFailure::NoDescent));
        let near = self.options.tolerance * self.options.scale;
        // Newton's step is no shorter than the residual over the norm of 1 - Jacobian.
        let far = self.change.norm() > near * (1.0 + self.jacobian.norm());
        let time = if far && self.pseudo_time < NEWTON { self.pseudo_time } else { f64::INFINITY };
        let newton = factors(&self.jacobian, 1.0 + 1.0 / time);
        let Some(mut step) = self.solve_step(&newton) else { return stuck };
        if !far && step.norm() <= near {
            return self.after_last_step(step, &newton);
        }
        if !far && self.pseudo_time < NEWTON {
            match self.step(self.pseudo_time) {
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

    /// Accepts or shortens a step.
    fn after_step(
        &mut self,
        step: OVector<f64, D>,
        shorter: u32,
        values: &[Option<OVector<f64, D>>],
    ) -> Stage<D> {
        if let [Some(value)] = values {
            let state = &self.state + &step;
            let change = value - &state;
            let gain = self.change.norm() / change.norm().max(f64::MIN_POSITIVE);
            // Early steps may raise the residual a little, as the flow does.
            let least = if self.pseudo_time < NEWTON { 0.5 } else { GAINS };
            if gain >= least {
                // Broyden's update of the Jacobian minus one.
                let predicted = &self.jacobian * &step - &step;
                let miss = &change - &self.change - predicted;
                self.jacobian.ger(1.0 / step.norm_squared(), &miss, &step, 1.0);
                (self.state, self.change, self.jacobian_source) =
                    (state, change, JacobianSource::Transferred);
                self.pseudo_time *= (LONGER * gain).clamp(0.5, LONGEST);
                return if gain < REUSE_REDUCTION { Stage::Slope { whole: false } } else { self.next_step() };
            }
        }
        if self.jacobian_source == JacobianSource::Transferred {
            return Stage::Slope { whole: false };
        }
        if self.jacobian_source == JacobianSource::Partial && shorter == 1 {
            // The guessed columns may be the reason.
            return Stage::Slope { whole: true };
        }
        if shorter == 4 {
            if self
                .step(f64::INFINITY)
                .is_some_and(|newton| newton.norm() <= self.options.fallback_tolerance * self.options.scale)
            {
                if self.tells_jacobian(true) && self.jacobian_source == JacobianSource::Full {
                    return self.found(Floquet::new(&self.jacobian, &factors(&self.jacobian, 1.0)));
                }
                return Stage::Last;
            }
            return Stage::Done(PtcOutcome::Failed(if values == [None] {
                SearchFailure::Undefined
            } else {
                SearchFailure::NoDescent
            }));
        }
        self.pseudo_time = (0.25 * self.pseudo_time).min(NEWTON);
        Stage::Stride { step: 0.25 * step, shorter: shorter + 1 }
    }

    fn last(&mut self, values: &[Option<OVector<f64, D>>]) -> Stage<D> {
        for n in 0..self.size() {
            let (Some(Some(low)), Some(Some(high))) = (values.get(2 * n), values.get(2 * n + 1)) else {
                return Stage::Done(PtcOutcome::Failed(SearchFailure::Undefined));
            };
            self.jacobian
                .set_column(self.moved(n), &((high - low) / (2.0 * self.last_step() * self.options.scale)));
        }
        self.found(Floquet::new(&self.jacobian, &factors(&self.jacobian, 1.0)))
    }

    pub(super) fn found(&self, spectrum: Floquet) -> Stage<D> {
        let multiplier = spectrum.multiplier;
        if multiplier.is_nan() || (self.options.require_stable && multiplier >= 1.0) {
            return Stage::Done(PtcOutcome::Failed(SearchFailure::Unstable));
        }
        Stage::Done(PtcOutcome::Converged(Box::new(FixedPoint {
            state: self.state.clone(),
            slope: self.jacobian.clone(),
            spectrum,
        })))
    }
}
