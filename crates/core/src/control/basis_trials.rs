//! Trials of bases: the error of each on a sample of the instances.

use super::difference_scale::scaled_difference;
use super::step_reduction::quarter_steps;
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::observe::Status;
use crate::orbit::{self, OrbitSolution};
use crate::plan::{KeptMode, Plan, Precision, RICHEST_ACCURACY_SHARE};
use crate::scene::{Start, Steady};
use serde::{Deserialize, Serialize};

/// If the search fails for more than one in `UNFOUND_ONE_IN` of the sample, these start from the states of other members, up
/// to `MAX_NEIGHBOUR_STARTS` of them, the next in stiffness first. If that does not help, the sample is integrated.
const UNFOUND_ONE_IN: usize = 4;
const MAX_NEIGHBOUR_STARTS: usize = 6;

/// A basis on trial: the accuracy that selects its modes, and the error of each member of the sample.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(super) struct BasisTrial {
    pub accuracy: f64,
    pub differences: Vec<f64>,
}

/// Trials of a sample, from the smallest basis to the first that serves the whole sample.
#[derive(Default)]
pub(super) struct TrialResults {
    pub all: Vec<BasisTrial>,
    /// Messages of the engine.
    pub notes: Vec<String>,
}

/// The modes of each basis of the plan.
fn modes(plan: &Plan) -> Vec<Vec<KeptMode>> {
    plan.drives.iter().map(|driven| driven.kept.modes.clone()).collect()
}

/// Whether the sample already has the richest basis.
pub(super) fn is_richest(sample: &Plan) -> bool {
    modes(sample) == modes(&sample.clone().with_shares(RICHEST_ACCURACY_SHARE * sample.run.accuracy))
}

/// Largest allowed error of a basis for `accuracy`.
fn bound(accuracy: f64, plan: &Plan) -> f64 {
    let (asked, policy) = (plan.run.accuracy, &plan.policy);
    asked * if accuracy > asked { policy.poorer_basis_share } else { policy.basis_share }
}

/// Tries bases on the plan `sample`, which stands for `count` instances, from small to rich, each against the richest one.
/// The smallest are worth a trial only if there are many more instances than the sample has.
pub(super) fn run(
    sample: &Plan,
    count: usize,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<TrialResults, EngineError> {
    let policy = &sample.policy;
    // Rounding must not look like truncation error.
    let open = sample.precision_settled().is_none() && engine.double();
    let precision = if open { Precision::F64 } else { sample.precision };
    let mut trials = TrialResults::default();
    let richest = RICHEST_ACCURACY_SHARE * sample.run.accuracy;
    let with = |accuracy: f64| sample.clone().with_shares(accuracy).in_precision(precision);
    let mut truths = reference_runs(&with(richest), engine, progress)?;
    trials.notes.append(&mut truths.outcome.notes);
    let mut tried = vec![modes(&sample.clone().with_shares(richest))];
    // A point of a curve alone may end on another branch than its curve, so it cannot approve a basis for less than the
    // requested accuracy.
    let many = count > policy.many && sample.ensemble.curves.is_none();
    let poorer: &[f64] = if many { &policy.poorer } else { &[] };
    for factor in poorer.iter().chain(&policy.richer) {
        let accuracy = (factor * sample.run.accuracy).min(policy.poorest);
        let basis = modes(&sample.clone().with_shares(accuracy));
        if tried.contains(&basis) {
            continue;
        }
        tried.push(basis);
        let mut run = with_basis(&with(accuracy), &truths, engine, progress)?;
        trials.notes.append(&mut run.outcome.notes);
        let apart = |i: u32| scaled_error(sample, i, &run.outcome.results, &truths.outcome.results);
        let trial = BasisTrial { accuracy, differences: sample.instances().map(apart).collect() };
        let below = |trial: &BasisTrial, bound: f64| trial.differences.iter().all(|one| *one <= bound);
        let first = policy.first_basis_share * sample.run.accuracy;
        let before = trials.all.last().is_none_or(|before| below(before, first));
        let enough = before && below(&trial, bound(accuracy, sample));
        trials.all.push(trial);
        if enough {
            break;
        }
    }
    Ok(trials)
}

/// Whether the sample's states are searched for one by one.
fn searches(sample: &Plan) -> bool {
    sample.run.steady == Steady::Search && sample.run.start == Start::Steady
}

/// Runs the sample with the richest basis. Searches start with a quarter of the steps, if necessary from other members'
/// states, then continue from these results. Members that no search finds are left out unless there are many.
fn reference_runs(
    rich: &Plan,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    if !searches(rich) {
        return orbit::solve(rich, &[], engine, progress);
    }
    let coarse = quarter_steps(rich.clone());
    let mut rough = orbit::solve_without_integration(&coarse, &[], engine, progress)?;
    let all: Vec<u32> = rich.instances().collect();
    let much = |rough: &OrbitSolution| unconverged(&coarse, rough).len() > all.len() / UNFOUND_ONE_IN;
    for turn in 0..MAX_NEIGHBOUR_STARTS {
        if !much(&rough) || progress.stopped() {
            break;
        }
        from_others(&coarse, turn, &mut rough, engine, progress)?;
    }
    if much(&rough) {
        return orbit::solve(rich, &orbit::gather(&rough.found, &all), engine, progress);
    }
    let mut settled = next_to(rich, (&rough, None), engine, progress)?;
    settled.outcome.notes.splice(0..0, rough.outcome.notes);
    Ok(settled)
}

/// Members without a state.
fn unconverged(plan: &Plan, run: &OrbitSolution) -> Vec<u32> {
    plan.instances().filter(|i| run.state(*i as usize).is_none()).collect()
}

/// Starts members without a state from the state of another member: at the first turn the nearest in the order of the sample,
/// then the next.
fn from_others(
    plan: &Plan,
    turn: usize,
    run: &mut OrbitSolution,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(), EngineError> {
    let found: Vec<u32> = plan.instances().filter(|i| run.state(*i as usize).is_some()).collect();
    let place = |i: u32| {
        let mut nearest = found.clone();
        nearest.sort_by_key(|other| other.abs_diff(i));
        Some((i, run.state(*nearest.get(turn)? as usize)?))
    };
    let (some, others): (Vec<u32>, Vec<_>) = unconverged(plan, run).into_iter().filter_map(place).unzip();
    let new = orbit::solve_near(&plan.part(&some), &others, engine, progress)?;
    run.take(&some, new);
    Ok(())
}

/// Runs the sample with another basis than the richest. Each member is searched for from scratch with a quarter of the steps,
/// so a basis that leads to another state shows.
fn with_basis(
    plan: &Plan,
    truths: &OrbitSolution,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let waited =
        |i: u32| truths.outcome.results[i as usize].status.is_steady() && truths.state(i as usize).is_none();
    if !searches(plan) || plan.instances().any(waited) {
        return orbit::solve(plan, &[], engine, progress);
    }
    let known: Vec<u32> = plan.instances().filter(|i| truths.state(*i as usize).is_some()).collect();
    let mut rough = OrbitSolution::not_run(plan);
    rough.take(
        &known,
        orbit::solve_without_integration(&quarter_steps(plan.part(&known)), &[], engine, progress)?,
    );
    let mut settled = next_to(plan, (&rough, Some(truths)), engine, progress)?;
    settled.outcome.notes.splice(0..0, rough.outcome.notes);
    Ok(settled)
}

/// Runs the members near their states in the first run, or else in the second. Members without either are left out.
fn next_to(
    plan: &Plan,
    (first, second): (&OrbitSolution, Option<&OrbitSolution>),
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<OrbitSolution, EngineError> {
    let state = |i: &u32| first.state(*i as usize).or_else(|| second?.state(*i as usize));
    let members: Vec<u32> = plan.instances().filter(|i| state(i).is_some()).collect();
    let near: Vec<_> = members.iter().map(state).collect();
    let mut all = OrbitSolution::not_run(plan);
    all.take(&members, orbit::solve_without_integration(&plan.part(&members), &near, engine, progress)?);
    Ok(all)
}

fn scaled_error(plan: &Plan, i: u32, results: &[Finished], truths: &[Finished]) -> f64 {
    let (a, b) = (&results[i as usize], &truths[i as usize]);
    // The basis lacks this state.
    if b.status == Status::Ok && a.status == Status::NotRun {
        return f64::INFINITY;
    }
    // A motion that does not repeat has no meaningful difference.
    let ok = a.status == Status::Ok && b.status == Status::Ok;
    if ok { scaled_difference(plan, i, a, b) } else { 0.0 }
}

/// Place of an instance among the members of the sample, softest contact first. In a sweep of the gap alone all contacts are
/// equally stiff, and each member stands for each instance.
pub(super) struct StiffnessRank {
    /// Number of members with softer contacts.
    pub softer: usize,
    /// Number of members with contacts that are no stiffer.
    pub no_stiffer: usize,
}

impl StiffnessRank {
    /// Place of a contact of stiffness `here` among members with these stiffnesses.
    pub fn among(members: &[f64], here: f64) -> Self {
        let softer = members.partition_point(|other| *other < here);
        Self { softer, no_stiffer: softer + members[softer..].partition_point(|other| *other <= here) }
    }
}

/// Errors of a basis for the sample members of one kind, softest contact first.
pub(super) struct TrialCosts {
    pub accuracy: f64,
    differences: Vec<f64>,
    /// Number of members before the first that the basis fails, and the same for the first run.
    good: usize,
    good_first: usize,
    /// Number of members on either side that stand for an instance.
    neighbours: usize,
}

impl TrialCosts {
    /// Costs for the members with these numbers.
    pub fn new(trial: &BasisTrial, members: &[usize], plan: &Plan) -> Self {
        let differences: Vec<f64> = members.iter().map(|n| trial.differences[*n]).collect();
        let within =
            |bound: f64| differences.iter().position(|one| *one > bound).unwrap_or(differences.len());
        let good = within(bound(trial.accuracy, plan));
        let good_first = within(plan.policy.first_basis_share * plan.run.accuracy);
        let neighbours = plan.policy.neighbours;
        Self { accuracy: trial.accuracy, differences, good, good_first, neighbours }
    }

    /// Whether the basis is good enough for the first run of an instance at this place.
    pub fn begins(&self, place: &StiffnessRank) -> bool {
        self.end(place) <= self.good_first
    }

    /// Largest error near an instance at this place. None if the basis fails a member up to `neighbours` places stiffer.
    pub fn cost(&self, place: &StiffnessRank) -> Option<f64> {
        let from = place.softer.saturating_sub(self.neighbours);
        let to = self.end(place);
        let near = self.differences.get(from.min(to.saturating_sub(1))..to)?;
        let good = to <= self.good && !near.is_empty();
        good.then(|| near.iter().copied().fold(0.0, f64::max))
    }

    /// Largest error near an instance at this place, whether or not the basis serves.
    pub fn near(&self, place: &StiffnessRank) -> f64 {
        let from = place.softer.saturating_sub(self.neighbours);
        self.differences[from.min(self.end(place))..self.end(place)].iter().copied().fold(0.0, f64::max)
    }

    /// End of the members that stand for an instance at this place.
    fn end(&self, place: &StiffnessRank) -> usize {
        (place.no_stiffer + self.neighbours).min(self.differences.len())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Cpu;
    use crate::test_plans::plan_of;

    /// With hovering tips in its trial, a basis too small for the taps of the curve passed: three of 128 audits of 1.6
    /// million points were above the accuracy.
    #[test]
    fn points_of_curves_speak_for_no_poorer_basis() {
        let text = |how: &str| {
            format!(
                r#"
                [instrument.cantilever]
                stiffness = "26 N/m"
                frequency = "300 kHz"
                quality_factor = 400
                [contact]
                law = "dmt"
                [drive]
                on = "tip"
                frequency = "resonance"
                free_amplitude = "20 nm"
                {how}
                [run]
                accuracy = 1e-3
                steady = "search"
                "#
            )
        };
        let gaps = r#"from = "22 nm", to = "10 nm", points = 300"#;
        let swept = format!("[sweep]\n\"approach.gap\" = {{ {gaps} }}");
        let curve = format!("[curve]\nquantity = \"approach.gap\"\n{}", gaps.replace(", ", "\n"));
        let poorest = |how: &str| {
            let plan = plan_of(&text(how));
            let sample = plan.part(&[0, 150, 299]);
            let trials = run(&sample, plan.len(), &Cpu::default(), &Progress::default()).expect("trials run");
            trials.all[0].accuracy
        };
        assert!(poorest(&swept) > 1e-3);
        assert!(poorest(&curve) <= 1e-3);
    }

    #[test]
    fn members_that_are_as_stiff_stand_for_an_instance_as_a_whole() {
        let place = |here: f64| {
            let StiffnessRank { softer, no_stiffer } = StiffnessRank::among(&[1.0, 2.0, 2.0, 2.0, 3.0], here);
            (softer, no_stiffer)
        };
        assert_eq!([place(0.5), place(2.0), place(2.5), place(4.0)], [(0, 0), (1, 4), (4, 4), (5, 5)]);
    }

    #[test]
    fn a_basis_that_fails_one_of_them_serves_none() {
        let costs = |good| TrialCosts {
            accuracy: 1e-3,
            differences: vec![1e-5, 2e-5, 9e-4, 3e-5, 4e-5],
            good,
            good_first: good,
            neighbours: 1,
        };
        let alike = StiffnessRank { softer: 0, no_stiffer: 5 };
        assert_eq!(costs(2).cost(&alike), None);
        assert!(!costs(2).begins(&alike));
        assert_eq!(costs(5).cost(&alike), Some(9e-4));
        assert_eq!(costs(2).cost(&StiffnessRank { softer: 0, no_stiffer: 1 }), Some(2e-5));
    }
}
