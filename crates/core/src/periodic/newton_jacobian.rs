//! Searches on maps that compute their Jacobians, and the end of any search.

use super::floquet::{Floquet, factors};
use super::newton_options::NewtonOptions;
use super::pseudo_transient::{FixedPoint, JacobianSource, PtcNewton, PtcOutcome, Stage};
use super::search_failure::SearchFailure;
use super::size::{Memory, Size};
use nalgebra::{DefaultAllocator, LU, OMatrix, OVector};

/// The map's value at a state, and its Jacobian there.
type ValueAndJacobian<D> = (OVector<f64, D>, OMatrix<f64, D, D>);

impl<D: Size> FixedPoint<D>
where
    DefaultAllocator: Memory<D>,
{
    /// A fixed point with the map's Jacobian there; `None` if it is unstable.
    pub fn stable_fixed_point(state: OVector<f64, D>, slope: OMatrix<f64, D, D>) -> Option<Self> {
        let spectrum = Floquet::new(&slope, &factors(&slope, 1.0));
        (spectrum.multiplier < 1.0).then_some(Self { state, slope, spectrum })
    }
}

impl<D: Size> PtcNewton<D>
where
    DefaultAllocator: Memory<D>,
{
    /// Pseudo-time of the next step, in periods; infinite for a full Newton step.
    pub fn pseudo_time(&self) -> f64 {
        self.pseudo_time
    }

    /// Lets the map compute its Jacobian, at the cost of `columns` finite-difference columns.
    pub fn use_tangents(&mut self, columns: usize) {
        self.options.jacobian_columns = Some(columns);
    }

    /// Whether the map is to compute the Jacobian: the `whole` one, or columns of it on the way.
    pub(super) fn tells_jacobian(&self, whole: bool) -> bool {
        self.options.jacobian_columns.is_some_and(|worth| self.difference_evaluations(whole) > worth)
    }

    /// Whether the map is to compute the last Jacobian.
    pub(super) fn tells_last_jacobian(&self) -> bool {
        self.options.jacobian_columns.is_some_and(|worth| 2 * self.size() > worth)
    }

    /// Evaluations that differences take for the `whole` Jacobian, or for the columns needed on the way.
    fn difference_evaluations(&self, whole: bool) -> usize {
        match (whole, self.options.central_fd_step) {
            (false, _) => self.columns.len(),
            (true, None) => self.size(),
            (true, Some(_)) => 2 * self.size(),
        }
    }

    /// Whether it needs the Jacobian at the state that it asks for, too; [`PtcNewton::tell_with_jacobian`] takes both.
    pub fn wants_jacobian(&self) -> bool {
        match &self.stage {
            Stage::Begin => {
                self.known_floquet.is_none() && !self.options.reuse_jacobian && self.tells_jacobian(false)
            }
            Stage::Slope { whole } => self.tells_jacobian(*whole),
            Stage::Last => self.tells_last_jacobian(),
            Stage::Stride { .. } | Stage::Done(_) => false,
        }
    }

    /// Takes the map's value with its Jacobian; `None` if the map is undefined there.
    pub fn tell_with_jacobian(&mut self, answer: Option<ValueAndJacobian<D>>) {
        self.evaluations += 1;
        self.evaluations_by_differences += match self.stage {
            Stage::Slope { whole } => self.difference_evaluations(whole) as u32,
            Stage::Last => 2 * self.size() as u32,
            _ => 1 + self.difference_evaluations(false) as u32,
        };
        let next = match answer {
            Some((_, slope)) if matches!(self.stage, Stage::Last) => {
                self.jacobian = slope;
                self.found(Floquet::new(&self.jacobian, &factors(&self.jacobian, 1.0)))
            }
            Some((value, slope)) => {
                (self.change, self.jacobian) = (value - &self.state, slope);
                // The Jacobian known before led astray.
                (self.jacobian_source, self.known_floquet) = (JacobianSource::Full, None);
                self.next_step()
            }
            None => Stage::Done(PtcOutcome::Failed(SearchFailure::Undefined)),
        };
        self.go_on(next);
    }

    /// The stage after Newton's last step; `newton` holds the factors that gave it.
    pub(super) fn after_last_step(&mut self, step: OVector<f64, D>, newton: &LU<f64, D, D>) -> Stage<D> {
        let NewtonOptions {
            require_stable: stable,
            start_is_close: near,
            stable_below_fd: clearly,
            stable_below: certainly,
            ..
        } = self.options;
        let tells = self.tells_jacobian(true);
        let central = self.options.central_fd_step.is_some() && !tells;
        if !central && self.known_floquet.is_none() && stable && self.jacobian_source != JacobianSource::Full
        {
            return Stage::Slope { whole: true };
        }
        let below = if self.known_floquet.is_some() { certainly } else { clearly };
        let sure = |at: &Floquet| !stable || at.multiplier < below;
        if tells {
            if self.known_floquet.is_some_and(|at| !sure(&at)) {
                return Stage::Slope { whole: true };
            }
            self.state += step;
            return self.found(self.known_floquet.unwrap_or_else(|| Floquet::new(&self.jacobian, newton)));
        }
        self.state += step;
        // The present Jacobian is enough if stability does not matter or all of it was computed here.
        let enough = near && (!stable || self.jacobian_source == JacobianSource::Full);
        let at = match self.known_floquet {
            None if enough || !central => Some(Floquet::new(&self.jacobian, newton)),
            known => known,
        };
        at.filter(sure).map_or(Stage::Last, |at| self.found(at))
    }
}
