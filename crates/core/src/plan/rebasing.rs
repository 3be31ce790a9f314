//! A plan's instances with other bases.

use super::assignment::shares;
use super::contact_rate::RateOctave;
use super::{BasisRule, Case, Driven, Plan, ReducedBasis, steps};
use crate::scene::Run;
use std::collections::HashMap;
use std::sync::Arc;

impl Plan {
    /// Uses these bases for these instances; see [`Rebasing::give`].
    #[must_use]
    pub fn with_bases(&self, wanted: &[(u32, BasisRule)]) -> Self {
        let mut rebasing = Rebasing::new(self);
        wanted.iter().for_each(|(i, basis)| rebasing.give(*i, *basis));
        rebasing.plan
    }

    /// The same, with unchanged steps.
    #[must_use]
    pub fn with_bases_alone(&self, wanted: &[(u32, BasisRule)]) -> Self {
        let mut rebasing = Rebasing::new(self);
        wanted.iter().for_each(|(i, basis)| {
            rebasing.give_alone(*i, *basis);
        });
        rebasing.plan
    }

    /// Gives every instance the resonant modes that wait: a run that nothing refines does not ask for them later.
    #[must_use]
    pub fn resonant(self) -> Self {
        let with = |i| Some((i, resonant_rule(self.driven(i))?));
        let wanted: Vec<_> = self.instances().filter_map(with).collect();
        if wanted.is_empty() { self } else { self.with_bases(&wanted) }
    }
}

/// A plan whose instances get other bases one by one.
pub struct Rebasing {
    pub plan: Plan,
    bases: Bases,
    /// The last request, drive and basis, and the drive with both: neighbours mostly want the same.
    last: ((u32, BasisRule), u32),
}

impl Rebasing {
    /// Starts from a plan as it is.
    pub fn new(plan: &Plan) -> Self {
        let none = (u32::MAX, BasisRule::shares(f64::NAN));
        Self { plan: plan.clone(), bases: Bases::default(), last: (none, 0) }
    }

    /// Gives another basis to an instance that still has its original one. Returns the new drive.
    fn give_alone(&mut self, i: u32, basis: BasisRule) -> u32 {
        let Self { plan, bases, last } = self;
        let drive = plan.resolution.drive(i as usize);
        if last.0 != (drive, basis) {
            *last = ((drive, basis), bases.number(&mut plan.drives, drive, basis, &plan.run));
        }
        plan.resolution.set(i as usize, (last.1, plan.steps(i)));
        last.1
    }

    /// The same, with as many more steps as a larger basis needs, or as few as the rule gives for the modes of a coarser
    /// accuracy.
    pub fn give(&mut self, i: u32, basis: BasisRule) {
        let drive = self.give_alone(i, basis);
        let plan = &mut self.plan;
        let (driven, run, own) = (&plan.drives[drive as usize], &plan.run, plan.steps(i));
        if run.steps_per_period.is_some() || own == 0 {
            return;
        }
        let steps = match basis {
            BasisRule::Shares { accuracy, .. } if accuracy > run.accuracy => {
                own.min(steps_of(&plan.case(i), driven, run))
            }
            _ => own.max(fewest_steps(|| plan.case(i), driven, run)),
        };
        plan.resolution.set(i as usize, (drive, steps));
    }
}

/// Bases that a plan's drives were given, so that each is made once.
#[derive(Default)]
struct Bases {
    made: HashMap<(u32, [u64; 2]), u32>,
    /// The same by the drive's present basis, which drives of one instrument and frequency share.
    reduced: HashMap<(usize, [u64; 2]), Arc<ReducedBasis>>,
    /// By drive: those with its instrument.
    variants: HashMap<u32, Vec<u32>>,
}

impl Bases {
    /// The number of this drive with the basis of a rule. Adds the drive if none is like it.
    fn number(&mut self, drives: &mut Vec<Driven>, drive: u32, basis: BasisRule, run: &Run) -> u32 {
        *self.made.entry((drive, basis.key())).or_insert_with(|| {
            let own = &drives[drive as usize];
            let shared = (Arc::as_ptr(&own.kept) as usize, basis.key());
            let kept = self.reduced.entry(shared).or_insert_with(|| reduced_by(own, basis, run));
            let driven = Driven { kept: Arc::clone(kept), ..own.clone() };
            // Another accuracy may give the same basis.
            let known = self.variants.entry(drive).or_insert_with(|| vec![drive]);
            let same = |n: &&u32| drives[**n as usize].kept.modes == driven.kept.modes;
            if let Some(found) = known.iter().find(same) {
                return *found;
            }
            drives.push(driven);
            known.push(drives.len() as u32 - 1);
            drives.len() as u32 - 1
        })
    }
}

/// Richer bases are looked for at accuracies finer by this factor, one after the other.
const RICHER_ACCURACY_RATIO: f64 = 0.25;
const MAX_RICHER_TRIES: usize = 8;

/// The next richer basis for contacts of this octave; `None` if no richer one can be stepped, or the basis is prescribed.
pub(super) fn next_richer(driven: &Driven, octave: RateOctave, run: &Run) -> Option<Arc<ReducedBasis>> {
    if run.modes.is_some() {
        return None;
    }
    match driven.kept.rule {
        BasisRule::Contact { .. } => {
            let richer = reduced_by(driven, driven.kept.rule.richer()?, run);
            (richer.modes != driven.kept.modes).then_some(richer)
        }
        rule => {
            let finer = |n| rule.with_accuracy(|accuracy| accuracy * RICHER_ACCURACY_RATIO.powi(n));
            let mut bases = (1..=MAX_RICHER_TRIES as i32).map(|n| reduced_by(driven, finer(n), run));
            let found = bases.find(|basis| basis.modes != driven.kept.modes);
            found.or_else(|| richer_than(driven, octave, run))
        }
    }
}

/// The rule that adds the modes that wait to a drive's basis; `None` if none does.
fn resonant_rule(driven: &Driven) -> Option<BasisRule> {
    let ReducedBasis { rule, waiting, .. } = &*driven.kept;
    (!rule.is_resonant() && !waiting.is_empty()).then(|| rule.with_resonant_modes())
}

/// A drive's basis with the modes that wait; `None` if none does.
pub(super) fn with_waiting(driven: &Driven, run: &Run) -> Option<Arc<ReducedBasis>> {
    Some(reduced_by(driven, resonant_rule(driven)?, run))
}

/// The smallest basis for contacts of this octave with more oscillators than the drive's own.
pub(super) fn richer_than(driven: &Driven, octave: RateOctave, run: &Run) -> Option<Arc<ReducedBasis>> {
    let richer = |kept: &ReducedBasis| kept.modes.len() > driven.kept.modes.len();
    driven.for_contacts(octave, run.accuracy, richer).filter(|kept| richer(kept))
}

/// The basis that a rule asks for.
pub(super) fn reduced_by(driven: &Driven, rule: BasisRule, run: &Run) -> Arc<ReducedBasis> {
    driven.reduced_by(rule, run.accuracy, |wanted| shares(driven, wanted, run))
}

/// Fewest steps with which a case may step its basis: as many as the fastest oscillator needs, or as the rule gives for
/// oscillators made for an elastic contact.
pub(super) fn fewest_steps(case: impl FnOnce() -> Case, driven: &Driven, run: &Run) -> u32 {
    match driven.kept.rule {
        BasisRule::Contact { elastic: true, .. } => steps_of(&case(), driven, run),
        _ => steps::fewest(driven),
    }
}

/// The number of steps that the rule gives for a case with its basis.
fn steps_of(case: &Case, driven: &Driven, run: &Run) -> u32 {
    let (omega, amplitude) = (driven.free.omega, driven.free_amplitude());
    steps::steps(&case.contact, &driven.kept, omega, amplitude, case.gap, run.accuracy)
}
