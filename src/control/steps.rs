//! Steps: by doubling.

use super::{Controlled, modes, precision, prescribed, sensitive};
use crate::compare::{Scales, worst};
use crate::contact::Law;
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::observe::Status;
use crate::plan::{Basis, Plan, Precision, STEPS_MAX};
use crate::steady::{self, SETTLED, Settled};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

/// How often an instance runs again with twice as many steps.
const DOUBLINGS: usize = 4;

/// What is left of the difference between two runs in the finer one's error. Errors fall by 6 to 16 times with
/// twice the steps (orders 2.6 to 4), which leaves a fifth to a fifteenth; single cases do worse.
pub(super) const LEFT: f64 = 0.25;

/// The same of the difference between two numbers of oscillators for a fast contact: an error falls by 2 to 8 times from
/// one to the next, not always evenly.
const LEFT_OF_FAST: f64 = 0.5;
/// The same, and of two levers for slow contacts, where errors fall by less and a small difference may stand between two
/// larger ones: under JKR, whose jumps move all modes, and below the accuracy `COARSE`, where all laws' corners do. Of
/// 4,050 random levers (`cargo bench --bench accuracy -- --part levers`).
const LEFT_OF_FAST_CORNERS: f64 = 1.5;
const LEFT_OF_CORNERS: f64 = 0.75;
const COARSE: f64 = 1e-3;

/// Share of the accuracy that an estimate may have before more steps are taken: the rest is left to what no estimate
/// sees (undamped modes of small share, rounding).
pub(super) const AIM: f64 = 0.6;

/// What leaving modes out costs is what of a first difference is more than so many times the second, which is of steps
/// alone: errors fall by no more with twice the steps.
const STEEPEST: f64 = 16.0;

/// A finer run of a fast contact, from the second on, that brings the estimate down by less is the last.
const GAINED: f64 = 1.25;

/// Runs of an instance beyond the doublings, which may all have gone into steps, to try richer levers.
const LEVERS: usize = 2;

/// Fewest steps per period.
pub(super) const FEWEST: u32 = 16;

/// What is known before the steps are.
pub(super) struct First<'a> {
    /// By instance, what the lever of the first run is made by; none where it is the plan's own.
    pub poorer: Option<Vec<Basis>>,
    /// What the modes left out cost each instance, by the sample.
    pub left_out: Vec<f64>,
    pub chosen: &'a precision::Choice,
}

/// The plan for these instances with half of its steps, which are on the safe side.
pub(super) fn halved(plan: &Plan, instances: &[u32]) -> Plan {
    plan.stepped(instances, |case| (case.steps / 2).max(2 * FEWEST))
}

/// The plan for these instances with a quarter of its steps, for the first estimate.
pub(super) fn quartered(plan: &Plan, instances: &[u32]) -> Plan {
    halved(plan, instances).stepped(instances, |case| case.steps / 2)
}

/// Runs `all` the plan's instances, and `stepped`, those that need steps, with a quarter and with half of the plan's
/// steps, and then as the estimates ask for. Where the choice of precision says so, what f32 does not bring to the
/// accuracy goes on in f64: rounding does not fall with the steps.
pub(super) fn run(
    plan: Plan,
    (all, stepped): (&[u32], &[u32]),
    First { poorer, mut left_out, chosen }: First,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Controlled, EngineError> {
    if plan.run.steps_per_period.is_some() {
        return prescribed::run(plan, stepped, (left_out, chosen), engine, progress);
    }
    let fine = halved(&plan, all);
    let coarse = match &poorer {
        None => quartered(&plan, stepped),
        Some(bases) => {
            // How many oscillators there are for a fast contact decides what the steps cost, so these are told apart:
            // the first difference is of steps alone.
            let first = |i: &u32| if is_fast(&plan, *i) { plan.basis(*i) } else { bases[*i as usize] };
            let wanted: Vec<(u32, Basis)> = stepped.iter().map(|i| (*i, first(i))).collect();
            let mut poorer = plan.levers(&wanted);
            poorer.cases.iter_mut().zip(&plan.cases).for_each(|(poor, case)| poor.steps = case.steps);
            quartered(&poorer, stepped)
        }
    };
    let rough = steady::run(&coarse, &[], engine, progress)?;
    let mut settled = steady::run(&fine, &rough.found, engine, progress)?;
    settled.outcome.notes.splice(0..0, rough.outcome.notes);
    let count = plan.cases.len();
    let mut parts = Parts {
        of_steps: vec![0.0; count],
        both: vec![f64::NAN; count],
        in_vain: vec![false; count],
        finer: vec![false; count],
    };
    let lever = |plan: &Plan, i: usize| Arc::clone(&plan.drives[plan.cases[i].drive as usize].kept);
    for (i, apart) in differences(&fine, stepped, &rough.outcome.results, &settled.outcome.results) {
        let i = i as usize;
        let known = rough.outcome.results[i].status == Status::Ok;
        let both = known && lever(&coarse, i).modes != lever(&fine, i).modes;
        parts.of_steps[i] = apart * if both { left_of_modes(&fine, i as u32) } else { LEFT };
        if both {
            parts.both[i] = apart;
        }
    }
    let unbent = |i: &u32| modes::unbent(&fine, *i, &settled.outcome.results[*i as usize].measured);
    let unbent: Vec<f64> = stepped.par_iter().map(unbent).collect();
    stepped.iter().zip(unbent).for_each(|(i, cost)| left_out[*i as usize] += cost);
    if let Some(bases) = &poorer {
        // And the second one is of oscillators alone.
        let fast = |i: &u32| {
            let ok = settled.outcome.results[*i as usize].status == Status::Ok;
            ok && is_fast(&plan, *i) && bases[*i as usize] != plan.basis(*i)
        };
        let fast: Vec<u32> = stepped.iter().copied().filter(fast).collect();
        if !fast.is_empty() {
            let wanted: Vec<(u32, Basis)> = fast.iter().map(|i| (*i, bases[*i as usize])).collect();
            let mut few = fine.levers(&wanted);
            few.cases.iter_mut().zip(&fine.cases).for_each(|(few, case)| few.steps = case.steps);
            let few = few.only(&fast);
            let poor = steady::run(&few, &settled.found, engine, progress)?;
            for (i, apart) in differences(&fine, &fast, &poor.outcome.results, &settled.outcome.results) {
                // A run that is cut short has not told.
                left_out[i as usize] =
                    if progress.stopped() { f64::INFINITY } else { left_of_modes(&fine, i) * apart };
            }
        }
    }
    let most: Vec<u32> = fine.cases.iter().map(|case| (case.steps << DOUBLINGS).min(STEPS_MAX)).collect();
    let estimates = left_out.iter().zip(&parts.of_steps).map(|(a, b)| a + b).collect();
    let mut now = Controlled::new(fine, settled, (estimates, left_out), chosen);
    let mut doubted = Vec::new();
    for round in 0..DOUBLINGS + LEVERS {
        let again: Vec<u32> = stepped
            .iter()
            .copied()
            .filter(|i| !parts.in_vain[*i as usize] && now.doubtful(*i as usize, chosen.mixed))
            .collect();
        if round == 0 {
            doubted.clone_from(&again);
        }
        // Rounding may be what does not repeat: that is for f64 to say, with the same steps.
        let (unsteady, rough): (Vec<u32>, Vec<u32>) =
            again.into_iter().partition(|i| now.outcome.results[*i as usize].status == Status::NotSteady);
        let (poor, mut rough): (Vec<u32>, Vec<u32>) =
            rough.into_iter().partition(|i| parts.modes_lead(*i as usize, &now.left_out));
        let (poor, richest) = now.plan.can_be_richer(poor);
        rough.extend(richest);
        rough.retain(|i| now.plan.cases[*i as usize].steps <= most[*i as usize] / 2);
        if unsteady.is_empty() && poor.is_empty() && rough.is_empty() || progress.stopped() {
            break;
        }
        let single = |i: &u32| now.arithmetic.of[*i as usize] == Precision::F32;
        let (poor_single, poor_double): (Vec<u32>, Vec<u32>) = poor.into_iter().partition(single);
        let (single, double): (Vec<u32>, Vec<u32>) =
            rough.into_iter().partition(|i| single(i) && (round == 0 || !chosen.mixed));
        let mut again = |instances: &[u32], what, precision| {
            now.again(&mut parts, instances, (what, precision), engine, progress)
        };
        again(&unsteady, Again::Alike, Precision::F64)?;
        again(&single, Again::Finer, Precision::F32)?;
        again(&double, Again::Finer, Precision::F64)?;
        again(&poor_single, Again::Richer, Precision::F32)?;
        again(&poor_double, Again::Richer, Precision::F64)?;
    }
    now.plan = now.plan.only(all);
    for &i in stepped {
        let i = i as usize;
        let found = now.found.get(i).is_some_and(Option::is_some);
        if !found && now.periods[i] < now.plan.run.periods {
            // It was left before it had settled for good.
            now.estimates[i] += SETTLED * now.plan.run.accuracy;
        }
        if chosen.mixed && now.arithmetic.of[i] == Precision::F32 {
            now.estimates[i] += chosen.rounding;
        }
    }
    doubted.retain(|i| now.found.get(*i as usize).is_none_or(Option::is_none));
    for precision in [Precision::F32, Precision::F64] {
        let alike: Vec<u32> =
            doubted.iter().copied().filter(|i| now.arithmetic.of[*i as usize] == precision).collect();
        let plan = Plan { precision, ..now.plan.clone() };
        sensitive::mark(&plan, &alike, &mut now.outcome.results, engine, progress)?;
    }
    Ok(now)
}

/// What estimates are made of, by instance, beside [`Controlled::left_out`].
struct Parts {
    of_steps: Vec<f64>,
    /// The first difference, of steps and modes, where the second is still to come.
    both: Vec<f64>,
    /// Whether a finer run of a fast contact, each of which is dear, did not bring its estimate down.
    in_vain: Vec<bool>,
    /// Whether a fast contact had a finer run before: the first one is held against a difference that may have been
    /// small by chance, and does not count as in vain.
    finer: Vec<bool>,
}

impl Parts {
    /// Whether more steps will not help: known once two runs had the same lever.
    fn modes_lead(&self, i: usize, left_out: &[f64]) -> bool {
        self.both[i].is_nan() && left_out[i] > self.of_steps[i]
    }
}

/// What is new in another run.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Again {
    /// Nothing but the precision.
    Alike,
    /// Twice the steps.
    Finer,
    /// A richer lever.
    Richer,
}

impl Controlled {
    pub(super) fn new(
        plan: Plan,
        Settled { outcome, found, periods }: Settled,
        (estimates, left_out): (Vec<f64>, Vec<f64>),
        chosen: &precision::Choice,
    ) -> Self {
        let arithmetic = chosen.arithmetic(plan.cases.len());
        Self { plan, outcome, estimates, left_out, found, periods, arithmetic }
    }

    /// Runs these instances again.
    fn again(
        &mut self,
        parts: &mut Parts,
        again: &[u32],
        (what, precision): (Again, Precision),
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        if again.is_empty() || progress.stopped() {
            return Ok(());
        }
        let mut finer = match what {
            Again::Alike => self.plan.only(again),
            Again::Finer => self.plan.stepped(again, |case| 2 * case.steps),
            Again::Richer => self.plan.enriched(again),
        };
        finer.precision = precision;
        let Settled { outcome, mut found, periods } = steady::run(&finer, &self.found, engine, progress)?;
        if progress.stopped() {
            return Ok(());
        }
        let mut taken = HashMap::new();
        for (i, apart) in differences(&finer, again, &self.outcome.results, &outcome.results) {
            let (n, error) = (i as usize, LEFT * apart);
            let before = self.estimates[n];
            match what {
                Again::Finer => {
                    let of_modes = left_of_modes(&finer, i) * (parts.both[n] - STEEPEST * apart);
                    self.left_out[n] = self.left_out[n].max(of_modes);
                    (parts.of_steps[n], parts.both[n]) = (error, f64::NAN);
                    self.estimates[n] = self.left_out[n] + error;
                }
                Again::Richer => {
                    let measured = &outcome.results[n].measured;
                    self.left_out[n] = left_of_modes(&finer, i) * apart + modes::unbent(&finer, i, measured);
                    self.estimates[n] = self.left_out[n] + parts.of_steps[n];
                }
                // The same steps in another precision teach nothing of the steps: that is still to come.
                Again::Alike if outcome.results[n].status == Status::Ok => {
                    parts.both[n] = f64::NAN;
                    self.estimates[n] = f64::INFINITY;
                }
                Again::Alike => {}
            }
            let fast = is_fast(&finer, i);
            parts.in_vain[n] = fast && parts.finer[n] && self.estimates[n] > before / GAINED;
            parts.finer[n] |= fast;
            self.outcome.results[n] = outcome.results[n];
            self.plan.cases[n].steps = finer.cases[n].steps;
            self.plan.take_lever(i, &finer, i, &mut taken);
            self.periods[n] = periods[n];
            self.arithmetic.of[n] = precision;
            if let (Some(place), Some(new)) = (self.found.get_mut(n), found.get_mut(n)) {
                *place = new.take();
            }
        }
        self.outcome.notes.extend(outcome.notes);
        Ok(())
    }

    /// Whether more steps are called for: not where the motion itself does not repeat. Of that f32 may be wrong.
    fn doubtful(&self, i: usize, mixed: bool) -> bool {
        let status = self.outcome.results[i].status;
        let rounded = mixed && self.arithmetic.of[i] == Precision::F32 && status == Status::NotSteady;
        let helps = rounded || matches!(status, Status::Ok | Status::OutOfRange | Status::NonFinite);
        let room = self.plan.cases[i].steps <= STEPS_MAX / 2;
        helps && room && (status != Status::Ok || self.estimates[i] > AIM * self.plan.run.accuracy)
    }
}

/// What is left of the difference between two levers for the instance's contacts.
fn left_of_modes(plan: &Plan, i: u32) -> f64 {
    let corners = plan.cases[i as usize].contact.law == Law::Jkr || plan.run.accuracy < COARSE;
    match (corners, is_fast(plan, i)) {
        (true, true) => LEFT_OF_FAST_CORNERS,
        (false, true) => LEFT_OF_FAST,
        (true, false) => LEFT_OF_CORNERS,
        (false, false) => LEFT,
    }
}

/// Whether the instance's oscillators are chosen by the rate of its contact.
fn is_fast(plan: &Plan, i: u32) -> bool {
    matches!(plan.basis(i), Basis::Contact { .. })
}

/// How far two results of each instance are apart.
pub(super) fn differences(
    plan: &Plan,
    instances: &[u32],
    coarse: &[Finished],
    fine: &[Finished],
) -> Vec<(u32, f64)> {
    let apart = |&i: &u32| (i, difference(plan, i as usize, &coarse[i as usize], &fine[i as usize]));
    instances.par_iter().map(apart).collect()
}

/// How far two results of an instance are apart: the worst observable on its scale.
pub(super) fn difference(plan: &Plan, i: usize, a: &Finished, b: &Finished) -> f64 {
    let scales = Scales::of(plan, i, &b.measured);
    worst(&plan.observables, &a.measured, &b.measured, &scales)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::Cpu;
    use crate::scene::Scene;
    use std::path::Path;

    /// Levers that a sample vouches for and that leave out what a stiff sample moves: one mode, then two oscillators.
    /// Truth is a far richer lever with far more steps.
    #[test]
    fn a_lever_that_is_too_poor_for_one_instance_is_seen_by_its_own_difference() {
        let text = include_str!("../../tests/hard/sample_1_tpa.toml");
        let scene = Scene::parse(Path::new("sample_1_tpa.toml"), text).expect("the scene is whole");
        let whole = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
        let (engine, progress) = (Cpu::default(), Progress::default());
        let chosen = precision::choose(&whole, &[0], &engine, &progress).expect("nothing is open");
        let rich = whole.richer(&[0], 1e-2 * scene.run.accuracy).stepped(&[0], |case| 4 * case.steps);
        let truth = steady::run(&rich, &[], &engine, &progress).expect("it runs").outcome.results[0];
        let with = |accuracy| whole.levers(&[(0, Basis::Shares { accuracy })]);
        let run = |poorer| {
            let first = First { poorer, left_out: vec![0.0], chosen: &chosen };
            run(with(0.1), (&[0], &[0]), first, &engine, &progress).expect("it runs")
        };
        let error = |of: &Controlled| difference(&whole, 0, &of.outcome.results[0], &truth);
        let modes = |of: &Controlled| of.plan.drives[of.plan.cases[0].drive as usize].kept.modes.len();
        let (alike, apart) = (run(None), run(Some(vec![Basis::Shares { accuracy: 0.3 }])));
        let asked = scene.run.accuracy;
        // By steps alone nothing is seen of it.
        assert!(error(&alike) > asked && alike.estimates[0] < asked, "{:e}", error(&alike));
        assert!(error(&apart) < asked && apart.estimates[0] < asked, "{:e}", error(&apart));
        assert!(error(&apart) < 3.0 * apart.estimates[0], "{:e} {:e}", error(&apart), apart.estimates[0]);
        assert!(modes(&apart) > modes(&alike), "{} {}", modes(&apart), modes(&alike));
    }
}
