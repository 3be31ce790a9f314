//! An instance's constants and initial state, in the kernel's units.

use super::checkpoint::InstanceCheckpoint;
use super::start;
use crate::contact::KernelUnits;
use crate::kernel::{Flight, LENGTH, Lever, MODES_MAX, RunSums, flown};
use crate::plan::{Case, Driven, Plan};
use crate::scene::Start;
use rayon::prelude::*;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::Arc;

/// Length of a step, s.
pub(super) fn step_length(driven: &Driven, steps: u32) -> f64 {
    TAU / (driven.free.omega * f64::from(steps))
}

/// Impulse per N: h^2 times the tip's inverse mass as a step meets it, in units of length.
pub(super) fn force_scale(driven: &Driven, steps: u32) -> f64 {
    let step = step_length(driven, steps);
    step.powi(2) * driven.kept.stepped_inverse_mass(step) / LENGTH
}

/// An instance and its driven instrument.
pub(super) type Member<'a> = (Case, &'a Driven);

/// Instance `instance` of the plan.
pub(super) fn member(plan: &Plan, instance: u32) -> Member<'_> {
    (plan.case(instance), plan.driven(instance))
}

/// The lever of an instance for its step, padded to `modes`; the last is the law's memory, if it has one.
pub(super) fn lever((case, driven): &Member, modes: usize) -> Lever {
    let step = step_length(driven, case.steps);
    let lever = Lever::new(&driven.kept.flow(), step, modes);
    match case.contact.law.has_memory() {
        true => lever.remembering(case.contact.law().recovery() * step),
        false => lever,
    }
}

/// Free flight of an instance's lever over a block of steps, with sums of so many harmonics; padded likewise.
pub(super) fn flight((case, driven): &Member, block: (usize, usize), modes: usize) -> Flight {
    Flight::new(&driven.kept.flow(), (step_length(driven, case.steps), case.steps), block, modes)
}

/// The levers of instances with equally many steps.
pub(super) struct LeverTable(HashMap<LeverKey, Lever>);

impl LeverTable {
    pub fn of(members: &[Member], modes: usize) -> Self {
        let mut first: Vec<Member> = members.to_vec();
        first.dedup_by_key(|one| lever_key(one));
        first.sort_by_key(lever_key);
        first.dedup_by_key(|one| lever_key(one));
        Self(first.par_iter().map(|one| (lever_key(one), lever(one, modes))).collect())
    }

    pub fn get(&self, member: &Member) -> &Lever {
        &self.0[&lever_key(member)]
    }
}

/// Basis, angular frequency of the drive, and how a memory recovers.
pub(super) type LeverKey = (usize, u64, u64);

/// The key of a lever among instances with equally many steps: drives that differ only in level share their basis.
pub(super) fn lever_key((case, driven): &Member) -> LeverKey {
    let recovery = case.contact.law().recovery();
    (Arc::as_ptr(&driven.kept) as usize, driven.free.omega.to_bits(), recovery.to_bits())
}

/// Cosine and sine of the free motion, and the drive's phase per step.
pub(super) fn free((case, driven): &Member, start: Start) -> [f64; 3] {
    let (cosine, sine) = start::amplitudes(driven, start);
    [cosine / LENGTH, sine / LENGTH, TAU / f64::from(case.steps)]
}

/// Gap, and the contact's constants.
pub(super) fn gap_and_law((case, driven): &Member) -> impl Iterator<Item = f64> + use<> {
    let (impulse, step) = (force_scale(driven, case.steps), step_length(driven, case.steps));
    let law = case.contact.law().constants(KernelUnits { impulse, step });
    std::iter::once(case.gap / LENGTH).chain(law)
}

/// Constants of the motion, in the order of [`crate::kernel::Stepper`].
pub(super) fn motion(member: &Member, lever: &Lever, start: Start) -> impl Iterator<Item = f64> {
    lever.motion.iter().copied().chain(free(member, start)).chain(gap_and_law(member))
}

/// All constants; those for the work come last.
pub(super) fn constants(member: &Member, lever: &Lever, start: Start) -> impl Iterator<Item = f64> {
    motion(member, lever, start).chain(lever.energy.iter().copied())
}

/// Indentation at the run's first instant, kernel units.
fn first_indentation((case, driven): &Member, start: Start) -> f64 {
    let travel = match start {
        Start::Rest => 0.0,
        Start::Steady => start::amplitudes(driven, start).0,
    };
    -(case.gap + travel) / LENGTH
}

/// Half a step into the run: no deviation in steady free motion; from rest, the decaying part of each kept mode.
pub(super) fn begin(member: &Member, start: Start) -> InstanceCheckpoint {
    let (mut x, mut u) = ([0.0; MODES_MAX], [0.0; MODES_MAX]);
    if start == Start::Rest {
        for k in 0..MODES_MAX {
            [x[k], u[k]] = decayed(member, k);
        }
    }
    let first = first_indentation(member, start);
    let contact = &member.0.contact;
    let touching = f64::from(u8::from(contact.law.acts() && contact.next_contact(first * LENGTH, false)));
    InstanceCheckpoint {
        x,
        u,
        touching,
        last: [first; 2],
        touched: touching,
        run_sums: RunSums::new(),
        finite: true,
    }
}

/// Decaying part of a kept mode half a step after a start from rest: travel and rate over omega.
fn decayed((case, driven): &Member, k: usize) -> [f64; 2] {
    let Some(mode) = driven.kept.modes.get(k) else { return [0.0; 2] };
    let Some(index) = mode.index else { return [0.0; 2] };
    let [q, rate] = driven.free.transient(&driven.instrument, index);
    let tip = driven.instrument.modes[index].tip / LENGTH;
    let (x, u) = (tip * q, tip * rate / mode.omega);
    let step = step_length(driven, case.steps);
    let stored = driven.kept.stored_share(mode, step);
    flown(0.5 * mode.omega * step, mode.damping, [x, u]).map(|number| number * stored)
}
