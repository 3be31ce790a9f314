//! The first two runs of every instance, and what their difference tells.

use super::decide::Refinement;
use super::difference::{differences, is_fast, left_of_bases};
use super::{Members, modes, precision};
use crate::engine::{Engine, EngineError, Progress};
use crate::observe::Status;
use crate::plan::{BasisRule, CasePlan, Plan, STEPS_MAX};
use crate::steady::{self, Settled};

/// What is known before the steps are.
pub(super) struct First<'a> {
    /// By instance, what the basis of the first run is made by; none where it is the plan's own.
    pub poorer: Option<Vec<BasisRule>>,
    /// What the modes left out cost each instance, by the sample.
    pub left_out: Vec<f64>,
    pub chosen: &'a precision::Choice,
}

/// What the first two runs gave.
pub(super) struct Begun {
    /// The plan of the second.
    pub plan: Plan,
    pub settled: Settled,
    /// By instance.
    pub known: Vec<Refinement>,
}

/// The plan for these instances with half of its steps, which are on the safe side.
pub(super) fn halved(plan: &Plan, instances: &[u32]) -> Plan {
    let fewest = 2 * plan.policy.fewest_steps;
    plan.stepped(instances, |case| (case.steps / 2).max(fewest))
}

/// The plan for these instances with a quarter of its steps, for the first estimate.
pub(super) fn quartered(plan: &Plan, instances: &[u32]) -> Plan {
    halved(plan, instances).stepped(instances, |case| case.steps / 2)
}

/// Runs the members that need steps with a quarter of the plan's, then all members with half of them. Where the first run
/// had poorer bases, the difference is of both; of fast contacts a third run tells what of it the bases make.
pub(super) fn run(
    plan: &Plan,
    Members { all, stepped }: Members,
    First { poorer, left_out, .. }: First,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Begun, EngineError> {
    let fine = halved(plan, all);
    let coarse = match &poorer {
        None => quartered(plan, stepped),
        Some(bases) => poorer_and_coarser(plan, stepped, bases),
    };
    let rough = steady::run(&coarse, &[], engine, progress)?;
    let mut settled = steady::run(&fine, &rough.found, engine, progress)?;
    settled.outcome.notes.splice(0..0, rough.outcome.notes);
    let begin = |(case, of_modes): (&CasePlan, f64)| Refinement {
        of_steps: 0.0,
        of_modes,
        untold: None,
        most_steps: (case.steps << plan.policy.doublings).min(STEPS_MAX),
        finer_before: false,
        in_vain: false,
    };
    let known = fine.cases.iter().zip(left_out).map(begin).collect();
    let mut begun = Begun { plan: fine, settled, known };
    let same_basis = |i: u32| coarse.driven(i).kept.modes == begun.plan.driven(i).kept.modes;
    for (i, apart) in
        differences(&begun.plan, stepped, &rough.outcome.results, &begun.settled.outcome.results)
    {
        let of_both = rough.outcome.results[i as usize].status == Status::Ok && !same_basis(i);
        let left = if of_both { left_of_bases(&begun.plan, i) } else { plan.policy.left_of_steps };
        let known = &mut begun.known[i as usize];
        known.of_steps = left * apart;
        known.untold = of_both.then_some(apart);
    }
    begun.add_unbent(stepped);
    if let Some(bases) = &poorer {
        begun.tell_fast_bases(plan, stepped, bases, engine, progress)?;
    }
    Ok(begun)
}

/// The plan of the first run: a quarter of the steps, and poorer bases but for fast contacts. How many oscillators those
/// have decides what their steps cost, so their bases are told apart by a run of its own.
fn poorer_and_coarser(plan: &Plan, stepped: &[u32], bases: &[BasisRule]) -> Plan {
    let first = |i: &u32| if is_fast(plan, *i) { plan.basis_rule(*i) } else { bases[*i as usize] };
    let wanted: Vec<(u32, BasisRule)> = stepped.iter().map(|i| (*i, first(i))).collect();
    quartered(&with_steps_of(plan.with_bases(&wanted), plan), stepped)
}

/// The first plan with the second's steps.
fn with_steps_of(mut plan: Plan, other: &Plan) -> Plan {
    plan.cases.iter_mut().zip(&other.cases).for_each(|(case, other)| case.steps = other.steps);
    plan
}

impl Begun {
    /// Adds what the flexibility that no oscillator carries costs the virial.
    fn add_unbent(&mut self, stepped: &[u32]) {
        let costs = modes::unbent_of(&self.plan, stepped, &self.settled.outcome.results);
        stepped.iter().zip(costs).for_each(|(i, cost)| self.known[*i as usize].of_modes += cost);
    }

    /// Runs the fast contacts once more, with poorer bases and the same steps: that difference is of bases alone.
    fn tell_fast_bases(
        &mut self,
        plan: &Plan,
        stepped: &[u32],
        bases: &[BasisRule],
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        let results = &self.settled.outcome.results;
        let poorer = |i: &u32| {
            let ok = results[*i as usize].status == Status::Ok;
            ok && is_fast(plan, *i) && bases[*i as usize] != plan.basis_rule(*i)
        };
        let fast: Vec<u32> = stepped.iter().copied().filter(poorer).collect();
        if fast.is_empty() {
            return Ok(());
        }
        let wanted: Vec<(u32, BasisRule)> = fast.iter().map(|i| (*i, bases[*i as usize])).collect();
        let few = with_steps_of(self.plan.with_bases(&wanted), &self.plan).only(&fast);
        let poor = steady::run(&few, &self.settled.found, engine, progress)?;
        for (i, apart) in differences(&self.plan, &fast, &poor.outcome.results, results) {
            // A run that is cut short has not told.
            self.known[i as usize].of_modes =
                if progress.stopped() { f64::INFINITY } else { left_of_bases(&self.plan, i) * apart };
        }
        Ok(())
    }
}
