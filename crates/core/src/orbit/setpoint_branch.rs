//! One instance on its way to its set-point.

use super::conservative_orbit::conservative_orbit;
use super::continuation::{extrapolated, section_distance};
use super::{PeriodicState, period_map};
use crate::plan::{Plan, SectionState, SetPoint};
use crate::scene::{ForceBranch, Held};

/// The approach begins where the attraction moves the free oscillation by no more than this, in free amplitudes.
const FREE_MOTION_TOL: f64 = 0.01;
/// The share of the free amplitude that light forces are likely to leave.
const LIGHT_FORCE_SHARE: f64 = 0.95;
/// How far a state may be from where the last two lead, and how far from the last one, in free amplitudes.
const MAX_PREDICTION_ERROR: f64 = 0.08;
const MAX_STATE_CHANGE: f64 = 0.25;
/// A step that is to pass the set-point goes so much farther than the last two places say.
pub(super) const SETPOINT_OVERSHOOT: f64 = 1.1;

/// A state at a gap, and what it holds.
#[derive(Clone)]
pub(super) struct BranchPoint {
    pub gap: f64,
    pub state: PeriodicState,
    /// See [`setpoint_residual`](super::setpoint_residual::setpoint_residual).
    pub miss: f64,
    pub branch: Option<ForceBranch>,
}

/// An instance on its way.
pub(super) struct SetPointBranch {
    pub instance: u32,
    pub setpoint: SetPoint,
    /// The last place, and the one before on the same branch.
    pub last: BranchPoint,
    pub before: Option<BranchPoint>,
    /// Length of the next step, m.
    pub step: f64,
    pub steps: u32,
    pub jumps: u32,
    /// Where a branch that was not asked for holds the set-point.
    pub other: Option<(f64, PeriodicState)>,
    /// Whether it was set on the branch that is asked for.
    pub set: bool,
    /// Whether the next state's stability is looked at closely: after a step that failed.
    pub careful: bool,
    /// Whether the last step came to a state that may not be stable.
    pub unsure: bool,
}

impl SetPointBranch {
    /// Nearer where the motion is too large or too gentle.
    pub(super) fn next_gap(&self) -> f64 {
        self.last.gap + if self.last.miss > 0.0 { -self.step } else { self.step }
    }

    /// A gap and a place about where the branch asked for has this share of the free amplitude (the set-point's own, if it
    /// is one), and the tip comes so much nearer than it, in free amplitudes, or stays so much farther away.
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

    /// Whether a state, instance `i` of its plan, is the next one of the branch, if it was expected at that place.
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
        section_distance(&here, expected) <= MAX_PREDICTION_ERROR * amplitude
            && section_distance(&here, &last) <= MAX_STATE_CHANGE * amplitude
    }

    /// Whether a state is so near to the last one that it is the same branch's.
    pub(super) fn is_near(&self, plan: &Plan, state: &PeriodicState) -> bool {
        let place = |state| period_map::transfer_section(plan, self.instance, state);
        let amplitude = plan.driven(self.instance).free_amplitude();
        section_distance(&place(state), &place(&self.last.state)) <= MAX_PREDICTION_ERROR * amplitude
    }

    /// Where the next state is expected, instance `i` of its plan: where the last two lead.
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

/// Where a branch is looked for: shares of the free amplitude, none where that is the set-point's own, and how much nearer
/// or farther the tip comes. From another share the feedback leads to its own.
pub(super) fn seeds() -> impl Iterator<Item = (Option<f64>, f64)> {
    let own = [0.01, 0.03, 0.08, 0.2].map(|away| (None, away));
    let others = [0.9, 0.75, 0.5, 0.97].map(|share| (Some(share), 0.03));
    own.into_iter().chain(others)
}

/// Where the straight line between two places holds the set-point, and the nearer one's state.
pub(super) fn interpolated_point(one: &BranchPoint, other: &BranchPoint) -> (f64, PeriodicState) {
    let share = match one.miss == other.miss {
        true => 1.0,
        false => one.miss / (one.miss - other.miss),
    };
    let nearer = if share < 0.5 { one } else { other };
    (one.gap + share * (other.gap - one.gap), nearer.state.clone())
}

/// A gap from which the sample is hardly felt.
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
