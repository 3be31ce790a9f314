//! The parts of an instance's error estimate.

use super::difference_scale::remaining_error_factor;
use super::energy_balance::{missed_resonances, work_of_steps};
use super::missed_compliance::{FoundMotion, truncation_error};
use crate::plan::{Plan, STEPS_MAX};

/// A change beyond this many times the bound on the resonant modes' error is not due to these modes.
const WAITING_MARGIN: f64 = 4.0;

/// The parts of an instance's error estimate, and the history of its refinement.
#[derive(Clone, Copy, Debug)]
pub(super) struct ErrorParts {
    /// Error of the steps, and truncation error of the basis.
    pub of_steps: f64,
    pub of_modes: f64,
    /// Error of the resonant modes that the basis leaves out until the measured force asks for them.
    pub of_resonances: f64,
    /// The first difference, as long as it is not split into steps and basis.
    pub unsplit: Option<f64>,
    /// Most steps that the instance may have.
    pub most_steps: u32,
    /// Whether a fast contact already had a finer run. The first finer run cannot stall it, because the difference before may
    /// have been small by chance.
    pub finer_before: bool,
    /// Whether a finer run of a fast contact hardly reduced its estimate. Such runs are expensive.
    pub stalled: bool,
}

impl ErrorParts {
    /// Those of an instance of which only the truncation error of its basis is known.
    pub fn of_modes(of_modes: f64) -> Self {
        Self {
            of_steps: 0.0,
            of_modes,
            of_resonances: 0.0,
            unsplit: None,
            most_steps: STEPS_MAX,
            finer_before: false,
            stalled: false,
        }
    }

    /// The whole estimate.
    pub fn error(&self) -> f64 {
        self.of_modes + self.of_steps + self.of_resonances
    }

    /// Tells from the change of the estimate whether a finer run of a `fast` contact was in vain: it did not reduce the estimate by
    /// `least_gain`. A larger estimate is no such sign, because it shows that the one before was small by chance.
    pub fn tell_stall(&mut self, (before, now): (f64, f64), fast: bool, least_gain: f64) {
        let in_vain = now <= before && now > before / least_gain;
        self.stalled = fast && self.finer_before && in_vain;
        self.finer_before |= fast;
    }

    /// Whether the waiting modes are the largest part.
    pub fn resonances_lead(&self) -> bool {
        self.of_resonances > self.of_steps.max(self.of_modes)
    }

    /// Updates the parts after a run with more steps: instance `i` of `plan`, which differs by `apart` from the run before.
    pub fn after_more_steps(&mut self, (plan, i): (&Plan, u32), apart: f64, found: FoundMotion) {
        if let Some(first) = self.unsplit.take() {
            let of_bases = remaining_error_factor(plan, i) * (first - plan.policy.steepest * apart);
            self.of_modes = self.of_modes.max(of_bases);
        }
        self.of_steps = (plan.policy.left_of_steps * apart).max(work_of_steps(plan, i, found.measured));
    }

    /// Updates the parts after a run with a richer basis.
    pub fn after_richer_basis(&mut self, (plan, i): (&Plan, u32), apart: f64, found: FoundMotion) {
        self.of_modes = truncation_error(plan, i, apart, found);
        self.of_resonances = missed_resonances(plan, i, found);
    }

    /// Updates the parts after a run with the resonant modes that waited. Another state may be nearest with these modes: what
    /// they cannot explain is an error that more steps must tell.
    pub fn after_waiting_modes(&mut self, (plan, i): (&Plan, u32), apart: f64, found: FoundMotion) {
        let unexplained = apart - WAITING_MARGIN * self.of_resonances;
        self.of_steps = self.of_steps.max(plan.policy.left_of_steps * unexplained);
        self.of_resonances = missed_resonances(plan, i, found);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 10,000 levers of quality factor 2,000 on samples of up to 100 GPa seven were refined no further, and marked, because
    /// their third basis had raised an estimate of 7.2e-4 to 1.1e-3.
    #[test]
    fn only_a_run_that_hardly_reduces_the_estimate_is_the_last() {
        let stalls = |changes: &[(f64, f64)], fast| {
            let mut parts = ErrorParts::of_modes(0.0);
            changes.iter().for_each(|change| parts.tell_stall(*change, fast, 1.25));
            parts.stalled
        };
        assert!(!stalls(&[(1e-3, 9e-4)], true), "the first finer run");
        assert!(stalls(&[(2e-3, 1e-3), (1e-3, 9e-4)], true));
        assert!(stalls(&[(2e-3, 1e-3), (1e-3, 1e-3)], true));
        assert!(!stalls(&[(2e-3, 1e-3), (1e-3, 7e-4)], true));
        assert!(!stalls(&[(9e-3, 7.2e-4), (7.2e-4, 1.1e-3)], true));
        assert!(stalls(&[(7.2e-4, 1.1e-3), (1.1e-3, 1e-3)], true));
        assert!(!stalls(&[(2e-3, 1e-3), (1e-3, 9e-4)], false));
    }
}
