//! The choice of each instance's basis, by a sample of instances with poorer and richer ones.

use super::basis_trials::{self, BasisTrial, StiffnessRank, TrialCosts};
use super::contact_sample::{ContactKind, by_stiffness, kind_and_stiffness, spread};
use super::difference_scale::is_fast;
use crate::engine::{Engine, EngineError, Progress};
use crate::plan::{BasisRule, Interned, Plan, RICHEST_ACCURACY_SHARE, Rebasing};
use serde::{Deserialize, Serialize};
use std::collections::HashMap;

/// Results of the trials of bases: plain numbers that determine every instance's basis.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub(super) struct BasisTrialSet {
    /// Instances of the sample.
    pub sample: Vec<u32>,
    /// From the smallest basis to the first that serves the whole sample.
    pub trials: Vec<BasisTrial>,
}

/// The plan with the basis that each instance needs.
pub(super) struct BasisChoice {
    pub plan: Plan,
    /// Rule of each instance's next poorer basis. None if the sample has all instances.
    pub poorer: Option<Interned<BasisRule>>,
    /// Truncation error of each instance, from the sample. Empty if it is zero.
    pub truncation: Vec<f64>,
}

/// Splits `stepped`, the instances that need steps, into those whose fast contacts have a basis of their own, and those whose
/// bases need a trial.
fn split_by_rate(plan: &Plan, stepped: &[u32]) -> (Vec<u32>, Vec<u32>) {
    stepped.iter().copied().partition(|i| is_fast(plan, *i))
}

/// Tries bases on a sample of `stepped`. None if there is nothing to choose.
///
/// The plan gives a basis to each contact that is too fast for the modes with the largest shares. Its first run has fewer
/// oscillators, and the difference is the instance's own estimate. All others need trials.
pub(super) fn try_bases(
    plan: &Plan,
    stepped: &[u32],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(Option<BasisTrialSet>, Vec<String>), EngineError> {
    let (_, usual) = split_by_rate(plan, stepped);
    if plan.run.modes.is_some() || usual.is_empty() {
        return Ok((None, Vec::new()));
    }
    let order = by_stiffness(plan, &usual);
    let sample = spread(plan, &order);
    // Trials run on a plan of the sample, so their cost does not depend on the whole.
    let part = plan.part(&sample);
    if basis_trials::is_richest(&part) {
        return Ok((None, Vec::new()));
    }
    let trials = basis_trials::run(&part, order.len(), engine, progress)?;
    Ok((Some(BasisTrialSet { sample, trials: trials.all }), trials.notes))
}

/// Gives each of `stepped` the basis that the trials choose for it.
///
/// A harder contact excites more modes. Within a kind, the stiffness of an instance's contact at the deepest expected
/// indentation gives its place in the sample. A basis serves instances below the first sample member that it fails.
pub(super) fn choose_bases(plan: &Plan, stepped: &[u32], tried: Option<&BasisTrialSet>) -> BasisChoice {
    let (fast, usual) = split_by_rate(plan, stepped);
    let Some(BasisTrialSet { sample, trials }) = tried else { return as_planned(plan, !fast.is_empty()) };
    let mut bases = BasisAssignment::new(plan);
    fast.iter().for_each(|i| bases.keep(*i));
    let mut kinds: HashMap<ContactKind, KindTrials> = HashMap::new();
    let of = |part: &Plan, n: u32, i: u32| (i, kind_and_stiffness(part, n));
    plan.for_each(&usual, of, |(i, (kind, stiffness))| {
        let of_kind = kinds.entry(kind).or_insert_with(|| KindTrials::new(plan, kind, sample, trials));
        bases.choose(i, stiffness, of_kind);
    });
    // The trials cover a sample of all instances, unless a basis must be checked by the instance's own difference.
    let poorer = (usual.len() > sample.len() || bases.any_poorer).then_some(bases.poorer);
    BasisChoice { plan: bases.rebasing.plan, poorer, truncation: bases.truncation }
}

/// Keeps the plan's bases. If there are fast contacts, first runs have the next poorer ones.
fn as_planned(plan: &Plan, some_fast: bool) -> BasisChoice {
    let count = plan.len();
    let poorer = some_fast.then(|| {
        let mut poorer = Interned::of(count, BasisRule::shares(plan.run.accuracy));
        (0..count as u32).for_each(|i| poorer.set(i as usize, next_poorer(plan.basis_rule(i))));
        poorer
    });
    BasisChoice { plan: plan.clone(), poorer, truncation: Vec::new() }
}

fn next_poorer(basis: BasisRule) -> BasisRule {
    basis.poorer().unwrap_or(basis)
}

/// The trials of one kind of contact.
struct KindTrials {
    /// Stiffness of each member of the sample, softest first.
    stiffnesses: Vec<f64>,
    /// Costs of each basis on trial, smallest basis first.
    costs: Vec<TrialCosts>,
}

impl KindTrials {
    fn new(plan: &Plan, kind: ContactKind, sample: &[u32], trials: &[BasisTrial]) -> Self {
        let standings = sample.iter().map(|i| kind_and_stiffness(plan, *i)).enumerate();
        let (known, places): (Vec<usize>, Vec<f64>) =
            standings.filter(|(_, (own, _))| *own == kind).map(|(n, (_, stiffness))| (n, stiffness)).unzip();
        Self {
            stiffnesses: places,
            costs: trials.iter().map(|trial| TrialCosts::new(trial, &known, plan)).collect(),
        }
    }

    /// The smallest basis that serves an instance at this place, and its error there.
    fn basis(&self, place: &StiffnessRank) -> Option<(usize, f64)> {
        let serves = |n: &usize| *n == 0 || self.costs[n - 1].begins(place);
        let cost = |n: usize| self.costs[n].cost(place).map(|cost| (n, cost));
        (0..self.costs.len()).filter(serves).find_map(cost)
    }

    /// The last basis on trial, and its difference to the richest one near this place.
    fn almost(&self, place: &StiffnessRank) -> Option<(usize, f64)> {
        let last = self.costs.len().checked_sub(1)?;
        Some((last, self.costs[last].near(place)))
    }
}

/// The bases while they are being chosen.
struct BasisAssignment<'a> {
    plan: &'a Plan,
    rebasing: Rebasing,
    /// Poorer basis of each instance.
    poorer: Interned<BasisRule>,
    truncation: Vec<f64>,
    /// Whether any chosen basis has a poorer one.
    any_poorer: bool,
}

impl<'a> BasisAssignment<'a> {
    fn new(plan: &'a Plan) -> Self {
        let poorer = Interned::of(plan.len(), BasisRule::shares(plan.run.accuracy));
        let left_out = vec![0.0; plan.len()];
        Self { plan, rebasing: Rebasing::new(plan), poorer, truncation: left_out, any_poorer: false }
    }

    /// Keeps the plan's basis of a fast contact.
    fn keep(&mut self, i: u32) {
        let own = self.plan.basis_rule(i);
        self.put(i, (own, next_poorer(own)), 0.0);
    }

    /// Chooses the basis of an instance by the stiffness of its contact.
    fn choose(&mut self, i: u32, stiffness: f64, of_kind: &KindTrials) {
        let asked = self.plan.run.accuracy;
        let least = RICHEST_ACCURACY_SHARE * asked;
        let place = &StiffnessRank::among(&of_kind.stiffnesses, stiffness);
        let shares = |n: usize| BasisRule::shares(of_kind.costs[n].accuracy);
        if let Some((n, cost)) = of_kind.basis(place) {
            let before = n.checked_sub(1).filter(|n| of_kind.costs[*n].begins(place));
            self.put(i, (shares(n), before.map_or(shares(n), shares)), cost);
        } else if let Some((n, left)) = of_kind.almost(place).filter(|(_, left)| *left <= asked) {
            // The last basis on trial missed its bound, but it is accurate enough to verify the richest one.
            let richest = BasisRule::shares(least);
            self.put(i, (richest, shares(n)), self.plan.policy.left_of_steps * left);
        } else {
            // No basis of the trial serves. The contact gets its own basis, which the next poorer one verifies.
            let own = self.plan.contact_basis_rule(i).unwrap_or(BasisRule::shares(least));
            let cost = if own.poorer().is_some() { 0.0 } else { least };
            self.put(i, (own, next_poorer(own)), cost);
        }
    }

    fn put(&mut self, i: u32, (own, poorer): (BasisRule, BasisRule), cost: f64) {
        self.rebasing.give(i, own);
        self.any_poorer |= own.poorer().is_some();
        self.poorer.set(i as usize, poorer);
        self.truncation[i as usize] = cost;
    }
}
