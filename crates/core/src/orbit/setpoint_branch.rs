//! The continuation of one instance to its set-point.

use super::continuation::extrapolated;
use super::harmonic_balance::conservative_orbit;
use super::period_map::distance;
use super::{PeriodicState, period_map};
use crate::plan::{Plan, SectionState, SetPoint};
use crate::scene::{ForceBranch, Held};

/// The approach begins where attraction moves the free oscillation by at most this, in free amplitudes.
const FREE_MOTION_TOL: f64 = 0.01;
/// The share of the free amplitude that light forces are likely to leave.
const LIGHT_FORCE_SHARE: f64 = 0.95;
/// Largest distance of a state from its prediction, and from the last state, in free amplitudes.
const MAX_PREDICTION_ERROR: f64 = 0.08;
const MAX_STATE_CHANGE: f64 = 0.25;
/// A step that is to pass the set-point is this much longer than the secant says.
pub(super) const SETPOINT_OVERSHOOT: f64 = 1.1;

/// A state at a gap, with its residual.
#[derive(Clone)]
pub(super) struct BranchPoint {
    pub gap: f64,
    pub state: PeriodicState,
    /// See [`setpoint_residual`](super::setpoint_residual::setpoint_residual).
    pub miss: f64,
    pub branch: Option<ForceBranch>,
}

/// An instance during its approach.
pub(super) struct SetPointBranch {
    pub instance: u32,
    pub setpoint: SetPoint,
    /// The last point, and the one before it on the same branch.
    pub last: BranchPoint,
    pub before: Option<BranchPoint>,
    /// Length of the next step, m.
    pub step: f64,
    pub steps: u32,
    pub jumps: u32,
    /// A point at which a branch that was not requested holds the set-point.
    pub other: Option<(f64, PeriodicState)>,
    /// Whether the approach was restarted on the requested branch.
    pub set: bool,
    /// Whether the next state's stability is checked closely: after a step that failed.
    pub careful: bool,
    /// Whether the last step met a state that may be unstable.
    pub unsure: bool,
}

impl SetPointBranch {
    /// The next gap: smaller if the residual is positive, else larger.
    pub(super) fn next_gap(&self) -> f64 {
        self.last.gap + if self.last.miss > 0.0 { -self.step } else { self.step }
    }

    /// A gap and a state near the requested branch at this share of the free amplitude (`None`: the set-point's own). The tip
    /// is `away` free amplitudes nearer on the repulsive branch, and farther on the other.
    pub(super) fn seed(&self, plan: &Plan, share: Option<f64>, away: f64) -> (f64, SectionState) {
        let share = match (share, self.setpoint.held) {
            (None, Held::Amplitude(share) | Held::Deflection(share)) => share,
            (None, Held::Phase(degrees)) => degrees.to_radians().sin().abs(),
            (share, _) => share.unwrap_or(LIGHT_FORCE_SHARE),
        };
        let repulsive = self.setpoint.branch == Some(ForceBranch::Repulsive);
        let driven = plan.driven(self.instance);
        let gap = (share + if repulsive { -away } else { away }) * driven.free_amplitude();
        (gap, conservative_orbit(plan, self.instance, share, repulsive))
    }

    /// Whether the state `found` of instance `i` of `part` continues the branch, given the predicted section state.
    pub(super) fn is_followed_by(
        &self,
        part: &Plan,
        i: u32,
        found: &PeriodicState,
        expected: &SectionState,
    ) -> bool {
        let amplitude = part.driven(i).free_amplitude();
        let (here, last) = (
            period_map::transfer_section(part, i, found),
            period_map::transfer_section(part, i, &self.last.state),
        );
        distance(&here, expected) <= MAX_PREDICTION_ERROR * amplitude
            && distance(&here, &last) <= MAX_STATE_CHANGE * amplitude
    }

    /// Whether a state is close enough to the last one to be on its branch.
    pub(super) fn is_near(&self, plan: &Plan, state: &PeriodicState) -> bool {
        let place = |state| period_map::transfer_section(plan, self.instance, state);
        let amplitude = plan.driven(self.instance).free_amplitude();
        distance(&place(state), &place(&self.last.state)) <= MAX_PREDICTION_ERROR * amplitude
    }

    /// The predictor of instance `i` of `part`: the secant through the last two points.
    pub(super) fn predicted(&self, part: &Plan, i: u32) -> SectionState {
        let here = period_map::transfer_section(part, i, &self.last.state);
        let Some(before) = &self.before else { return here };
        let there = period_map::transfer_section(part, i, &before.state);
        let strides = (part.case(i).gap - self.last.gap) / (self.last.gap - before.gap);
        if strides.is_nan() || strides <= 0.0 {
            return here;
        }
        extrapolated(here, &there, strides.min(2.0 * SETPOINT_OVERSHOOT))
    }
}

/// Starts of the search for a branch: shares of the free amplitude (`None`: the set-point's own), and shifts of the tip. From
/// another share the continuation leads to the set-point's own.
pub(super) fn seeds() -> impl Iterator<Item = (Option<f64>, f64)> {
    let own = [0.01, 0.03, 0.08, 0.2].map(|away| (None, away));
    let others = [0.9, 0.75, 0.5, 0.97].map(|share| (Some(share), 0.03));
    own.into_iter().chain(others)
}

/// The gap at which the secant through two points holds the set-point, and the state of the nearer one with the secant's slope.
pub(super) fn interpolated_point(one: &BranchPoint, other: &BranchPoint) -> (f64, PeriodicState) {
    let share = match one.miss == other.miss {
        true => 1.0,
        false => one.miss / (one.miss - other.miss),
    };
    let nearer = if share < 0.5 { one } else { other };
    let gap_slope = Some((one.miss - other.miss) / (one.gap - other.gap));
    (one.gap + share * (other.gap - one.gap), PeriodicState { gap_slope, ..nearer.state.clone() })
}

/// A gap at which the sample is hardly felt.
pub(super) fn free_gap(plan: &Plan, instance: u32) -> f64 {
    let (contact, driven) = (plan.contact(instance), plan.driven(instance));
    let amplitude = driven.free_amplitude();
    let mut away = 0.05 * amplitude;
    let felt = |away: f64| contact.law().force(-away, false).abs() * driven.free.compliance.norm();
    while felt(away) > FREE_MOTION_TOL * amplitude && away < 100.0 * amplitude {
        away *= 1.5;
    }
    amplitude + away
}
