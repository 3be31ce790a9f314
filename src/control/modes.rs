//! Modes: by a sample of instances with poorer and richer levers.

use super::steps::difference;
use crate::compare::{Scales, error};
use crate::contact::Law;
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::observe::{Measured, Observable, Status};
use crate::plan::{Basis, Plan, Precision, RICHEST};
use crate::steady;
use rayon::prelude::*;
use std::f64::consts::PI;
use std::iter::successors;

/// Most instances of the sample.
const SAMPLE: usize = 64;
/// Levers from the poorest to the richest, by the accuracy whose modes they carry relative to the one asked for, and
/// the one that they are held against. The poorer ones pay where there are many more instances than the sample has.
const POORER: [f64; 3] = [1000.0, 100.0, 10.0];
const RICHER: [f64; 3] = [1.0, 0.5, 0.25];
const MANY: usize = 4 * SAMPLE;
/// No lever is made for an accuracy worse than this: it would have no mode.
const POOREST: f64 = 0.3;
/// Share of the accuracy asked for that modes left out may cost the sample: the rarest instance costs several times its
/// neighbours in it, where a contact lasts as long as a mode left out takes to swing.
const SHARE: f64 = 0.2;
/// The same for the poorer levers, which leave out more.
const SHARE_POORER: f64 = 0.1;
/// The same for the lever of the first run, the next poorer one: the difference to the second run then is an estimate of
/// every instance's own, which its neighbours in the sample cannot give, and little of it is left in the second.
const SHARE_FIRST: f64 = 1.5;

/// Neighbours in the sample, on either side, whose largest difference stands for an instance's.
const NEAR: usize = 2;

/// What a lever for `accuracy` may cost where `asked` is asked for.
fn bound(accuracy: f64, asked: f64) -> f64 {
    asked * if accuracy > asked { SHARE_POORER } else { SHARE }
}

/// The plan with the modes that each instance needs.
pub(super) struct Choice {
    pub plan: Plan,
    /// By instance, what the next poorer lever is made by; none where all are in the sample themselves.
    pub poorer: Option<Vec<Basis>>,
    /// What the modes left out cost each instance, by the sample.
    pub left_out: Vec<f64>,
    /// What the engine had to say of the sample's runs.
    pub notes: Vec<String>,
}

/// One lever on trial: the accuracy whose modes it carries, and what it costs each member of the sample.
struct Trial {
    accuracy: f64,
    differences: Vec<f64>,
}

/// Chooses the lever of each of `stepped`, the plan's instances that need steps.
///
/// Contacts that are too fast for the modes with the largest shares have a lever of their own from the plan: their first
/// run has fewer oscillators, and the difference is each instance's own estimate. For the others levers are tried on a sample.
///
/// The harder a contact presses the lever, the more modes it moves: within a law the instances are put in the order
/// of their contact's stiffness at the deepest indentation to expect. A lever is good for all instances below the
/// first member of the sample that it fails.
pub(super) fn choose(
    plan: &Plan,
    stepped: &[u32],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Choice, EngineError> {
    let (mut left_out, mut notes) = (vec![0.0; plan.cases.len()], Vec::new());
    let accuracy = plan.run.accuracy;
    let modes =
        |plan: &Plan| -> Vec<_> { plan.drives.iter().map(|driven| driven.kept.modes.clone()).collect() };
    let own = |i: &u32| plan.drives[plan.cases[*i as usize].drive as usize].kept.basis;
    let (usual, fast): (Vec<u32>, Vec<u32>) =
        stepped.iter().copied().partition(|i| matches!(own(i), Basis::Shares { .. }));
    let as_it_is = |left_out| {
        let first = |i: u32| own(&i).poorer().unwrap_or(own(&i));
        let poorer = (!fast.is_empty()).then(|| (0..plan.cases.len() as u32).map(first).collect());
        Choice { plan: plan.clone(), poorer, left_out, notes: Vec::new() }
    };
    if plan.run.modes.is_some() || usual.is_empty() {
        return Ok(as_it_is(left_out));
    }
    let order = by_stiffness(plan, &usual);
    let sample = spread(plan, &order);
    // A plan of its own: trials cost what the sample is, not what it is of.
    let part = plan.part(&sample);
    let members: Vec<u32> = (0..sample.len() as u32).collect();
    let most = modes(&part.richer(&[], RICHEST * accuracy));
    if modes(&part) == most {
        return Ok(as_it_is(left_out));
    }
    // What the levers cost is not to be mistaken for rounding.
    let open = plan.precision_settled().is_none() && engine.double();
    let precision = if open { Precision::F64 } else { plan.precision };
    let mut run = |accuracy: f64| {
        let trial = Plan { precision, ..part.richer(&members, accuracy) };
        let settled = steady::run(&trial, &[], engine, progress)?;
        notes.extend(settled.outcome.notes);
        Ok::<_, EngineError>(settled.outcome.results)
    };
    let truths = run(RICHEST * accuracy)?;
    let poorer: &[f64] = if order.len() > MANY { &POORER } else { &[] };
    let mut tried: Vec<Vec<_>> = vec![most];
    let mut trials = Vec::new();
    for factor in poorer.iter().chain(&RICHER) {
        let accuracy = (factor * accuracy).min(POOREST);
        let lever = modes(&part.richer(&[], accuracy));
        if tried.contains(&lever) {
            continue;
        }
        tried.push(lever);
        let results = run(accuracy)?;
        let of = |i: &u32| apart(&part, *i, &results, &truths);
        let differences: Vec<f64> = members.iter().map(of).collect();
        let bound = bound(accuracy, plan.run.accuracy);
        let below = |trial: &Trial, bound: f64| trial.differences.iter().all(|one| *one <= bound);
        let first = SHARE_FIRST * plan.run.accuracy;
        let before = trials.last().is_none_or(|before| below(before, first));
        let trial = Trial { accuracy, differences };
        let enough = before && below(&trial, bound);
        trials.push(trial);
        if enough {
            break;
        }
    }
    let mut wanted = Vec::with_capacity(order.len());
    let mut poorer = vec![Basis::Shares { accuracy }; plan.cases.len()];
    for i in fast.iter().copied() {
        wanted.push((i, own(&i)));
        poorer[i as usize] = own(&i).poorer().unwrap_or(own(&i));
    }
    for (law, members) in laws(plan, &order) {
        let known: Vec<usize> = (0..sample.len()).filter(|n| law_of(plan, sample[*n]) == law).collect();
        let places: Vec<f64> = known.iter().map(|n| stiffness(plan, sample[*n])).collect();
        let levers: Vec<Lever> = trials.iter().map(|trial| Lever::new(trial, &known, accuracy)).collect();
        for &i in members {
            let here = stiffness(plan, i);
            let place = places.partition_point(|other| *other < here);
            let serves = |n: &usize| *n == 0 || levers[n - 1].begins(place);
            let found =
                (0..levers.len()).filter(serves).find_map(|n| levers[n].cost(place).map(|cost| (n, cost)));
            let shares = |n: usize| Basis::Shares { accuracy: levers[n].accuracy };
            let Some((n, cost)) = found else {
                // No lever of the trial serves: one for the contact itself, which the next poorer one vouches for.
                let own = plan.contact_basis(i).unwrap_or(Basis::Shares { accuracy: RICHEST * accuracy });
                let (before, cost) = own.poorer().map_or((own, RICHEST * accuracy), |before| (before, 0.0));
                wanted.push((i, own));
                (poorer[i as usize], left_out[i as usize]) = (before, cost);
                continue;
            };
            let before = n.checked_sub(1).filter(|n| levers[*n].begins(place));
            wanted.push((i, shares(n)));
            poorer[i as usize] = before.map_or(shares(n), shares);
            left_out[i as usize] = cost;
        }
    }
    // Of the sample itself all is known, but for those whose own difference has to tell.
    let own = wanted.iter().any(|(_, basis)| basis.poorer().is_some());
    let poorer = (order.len() > sample.len() || own).then_some(poorer);
    Ok(Choice { plan: plan.levers(&wanted), poorer, left_out, notes })
}

/// What the flexibility that no oscillator carries costs an instance's virial, on its scale: the mean force bends the lever
/// by it, and works on that. 0 where the virial is not asked for.
pub(super) fn unbent(plan: &Plan, instance: u32, measured: &Measured) -> f64 {
    let kept = &plan.drives[plan.cases[instance as usize].drive as usize].kept;
    if !plan.observables.contains(&Observable::Virial) {
        return 0.0;
    }
    let work = kept.residual_share * kept.flexibility * measured.force_mean.powi(2);
    let off = Measured { virial: measured.virial + work, ..*measured };
    let cost = error(Observable::Virial, &off, measured, &Scales::of(plan, instance as usize, measured));
    if cost.is_finite() { cost } else { 0.0 }
}

/// A sample of `stepped`, from the softest to the stiffest contact of each law.
pub(super) fn sample(plan: &Plan, stepped: &[u32]) -> Vec<u32> {
    spread(plan, &by_stiffness(plan, stepped))
}

/// Evenly spread over instances in their order, and ever closer towards the stiffest of each law: those are what a lever
/// fails, and all that stand beyond the last member that it serves pay for a richer one.
pub(super) fn spread(plan: &Plan, order: &[u32]) -> Vec<u32> {
    let every = order.len().div_ceil(SAMPLE).max(1);
    let mut places: Vec<usize> = (0..order.len()).step_by(every).collect();
    let mut end = 0;
    for (_, members) in laws(plan, order) {
        end += members.len();
        let from_end = successors(Some(1), |distance| Some(2 * distance));
        let closer = from_end.take_while(|distance| *distance < every && *distance <= members.len());
        places.extend(closer.map(|distance| end - distance));
    }
    places.sort_unstable();
    places.dedup();
    places.into_iter().map(|place| order[place]).collect()
}

/// What a lever costs the members of the sample under one law, softest contact first.
struct Lever {
    accuracy: f64,
    differences: Vec<f64>,
    /// So many of the first ones it does not fail, and so many not in the first run.
    good: usize,
    first: usize,
}

impl Lever {
    fn new(trial: &Trial, known: &[usize], asked: f64) -> Self {
        let differences: Vec<f64> = known.iter().map(|n| trial.differences[*n]).collect();
        let within =
            |bound: f64| differences.iter().position(|one| *one > bound).unwrap_or(differences.len());
        let (good, first) = (within(bound(trial.accuracy, asked)), within(SHARE_FIRST * asked));
        Self { accuracy: trial.accuracy, differences, good, first }
    }

    /// Whether it will do for the first run of an instance with `place` softer members.
    fn begins(&self, place: usize) -> bool {
        (place + NEAR).min(self.differences.len()) <= self.first
    }

    /// The largest difference that it makes near an instance with `place` softer members; none where it fails one of
    /// those or of the next.
    fn cost(&self, place: usize) -> Option<f64> {
        let (from, to) = (place.saturating_sub(NEAR), (place + NEAR).min(self.differences.len()));
        let near = self.differences.get(from.min(to.saturating_sub(1))..to)?;
        let good = to <= self.good && !near.is_empty();
        good.then(|| near.iter().copied().fold(0.0, f64::max))
    }
}

/// The contact's stiffness at the deepest indentation to expect, over the lever's; under DMT at least the slope of the
/// attraction just outside, which a tip feels that never touches.
fn stiffness(plan: &Plan, instance: u32) -> f64 {
    let case = &plan.cases[instance as usize];
    let (contact, flexibility) = (&case.contact, plan.drives[case.drive as usize].kept.flexibility);
    let pressed = contact.stiffness(plan.expected_depth(instance as usize), true).abs();
    let felt = match contact.law {
        Law::Dmt => pressed.max(4.0 * PI * contact.radius * contact.work / contact.decay_length),
        _ => pressed,
    };
    felt * flexibility
}

pub(super) fn law_of(plan: &Plan, instance: u32) -> Law {
    plan.cases[instance as usize].contact.law
}

/// By law, then stiffness.
pub(super) fn by_stiffness(plan: &Plan, stepped: &[u32]) -> Vec<u32> {
    let mut keyed: Vec<(usize, f64, u32)> = stepped
        .par_iter()
        .map(|&i| {
            let law = Law::ALL.iter().position(|law| *law == law_of(plan, i)).unwrap_or(0);
            (law, stiffness(plan, i), i)
        })
        .collect();
    keyed.par_sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)).then(a.2.cmp(&b.2)));
    keyed.into_iter().map(|(.., i)| i).collect()
}

/// The instances of each law, which stand together.
fn laws<'a>(plan: &'a Plan, order: &'a [u32]) -> impl Iterator<Item = (Law, &'a [u32])> {
    order.chunk_by(|a, b| law_of(plan, *a) == law_of(plan, *b)).map(|group| (law_of(plan, group[0]), group))
}

fn apart(plan: &Plan, i: u32, results: &[Finished], truths: &[Finished]) -> f64 {
    let (a, b) = (&results[i as usize], &truths[i as usize]);
    // What does not repeat has no difference to speak of.
    let ok = a.status == Status::Ok && b.status == Status::Ok;
    if ok { difference(plan, i as usize, a, b) } else { 0.0 }
}
