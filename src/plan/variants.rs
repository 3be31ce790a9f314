//! Other plans for the same scene: some instances, other steps, other bases.

use super::build::{classify, shares};
use super::{BasisRule, CasePlan, Driven, Plan, ReducedBasis, steps};
use crate::observe::wants;
use crate::scene::Run;
use std::collections::HashMap;
use std::sync::Arc;

/// Other ways to run the same scene, to learn what a choice of the plan costs in accuracy.
impl Plan {
    /// The same plan for these instances alone; the others are not run.
    pub fn only(&self, instances: &[u32]) -> Self {
        self.stepped(instances, |case| case.steps)
    }

    /// Likewise, with another number of steps per period for each. Instances that are free of the sample
    /// stay so.
    pub fn stepped(&self, instances: &[u32], steps: impl Fn(&CasePlan) -> u32) -> Self {
        let mut plan = self.clone();
        for &index in instances {
            let case = &mut plan.cases[index as usize];
            if case.steps > 0 {
                case.steps = steps(case);
            }
        }
        plan.classes = classify(&plan.cases, &plan.drives, instances.iter().copied());
        plan
    }

    /// A plan of some of this one's instances alone, numbered in their order here, each as often as it is named.
    pub fn part(&self, instances: &[u32]) -> Self {
        let mut place = HashMap::new();
        let mut drives = Vec::new();
        let mut cases = Vec::with_capacity(instances.len());
        for &index in instances {
            let mut case = self.cases[index as usize];
            case.drive = *place.entry(case.drive).or_insert_with(|| {
                drives.push(self.drives[case.drive as usize].clone());
                drives.len() as u32 - 1
            });
            cases.push(case);
        }
        let classes = classify(&cases, &drives, 0..cases.len() as u32);
        Self {
            drives,
            cases,
            classes,
            observables: self.observables.clone(),
            wants: self.wants,
            run: self.run.clone(),
            precision: self.precision,
            precision_open: self.precision_open,
            policy: self.policy,
            waveforms: None,
            stations: None,
        }
    }

    /// Likewise, over `periods` of which the last `measure` are measured: the same stepping, nothing but the
    /// fundamental summed.
    pub fn trial(&self, instances: &[u32], periods: u32, measure: u32) -> Self {
        let observables = Vec::new();
        Self {
            wants: wants(&observables),
            observables,
            run: Run { periods, measure, ..self.run.clone() },
            precision_open: false,
            ..self.part(instances)
        }
    }

    /// The same plan for these instances alone, with the modes that `accuracy` would ask for by their shares, and as
    /// many more steps as they need. Bases that are made for their contacts stay.
    pub fn richer(&self, instances: &[u32], accuracy: f64) -> Self {
        let mut plan = self.clone();
        let run = &self.run;
        for driven in &mut plan.drives {
            if let BasisRule::Shares { .. } = driven.kept.rule {
                driven.kept = reduced_by(driven, BasisRule::Shares { accuracy }, run);
            }
        }
        let fewest = |case: &CasePlan| steps::fewest(&plan.drives[case.drive as usize]);
        plan.stepped(instances, |case| match run.steps_per_period {
            Some(_) => case.steps,
            None => case.steps.max(fewest(case)),
        })
    }

    /// The same plan for these instances alone, each with the basis that its own rule asks for: as many more steps as richer modes
    /// need, as many fewer as the rule gives for the modes of a poorer accuracy.
    pub fn with_bases(&self, wanted: &[(u32, BasisRule)]) -> Self {
        let run = &self.run;
        let mut made: HashMap<(u32, [u64; 2]), u32> = HashMap::new();
        // By drive of this plan, those of the new one.
        let mut variants: HashMap<u32, Vec<u32>> = HashMap::new();
        let mut plan = Self { drives: Vec::new(), ..self.clone() };
        let mut drive_of = |drive: u32, basis: Option<BasisRule>, drives: &mut Vec<Driven>| {
            *made.entry((drive, basis.map_or([u64::MAX; 2], |basis| basis.key()))).or_insert_with(|| {
                let mut driven = self.drives[drive as usize].clone();
                if let Some(basis) = basis {
                    driven.kept = reduced_by(&driven, basis, run);
                }
                // The same basis by another accuracy.
                let known = variants.entry(drive).or_default();
                let same = |n: &&u32| drives[**n as usize].kept.modes == driven.kept.modes;
                if let Some(found) = known.iter().find(same) {
                    return *found;
                }
                drives.push(driven);
                known.push(drives.len() as u32 - 1);
                drives.len() as u32 - 1
            })
        };
        // Neighbours mostly want the same.
        let mut last = ((u32::MAX, BasisRule::Shares { accuracy: f64::NAN }), 0);
        for &(i, basis) in wanted {
            let case = &mut plan.cases[i as usize];
            if last.0 != (case.drive, basis) {
                last = ((case.drive, basis), drive_of(case.drive, Some(basis), &mut plan.drives));
            }
            case.drive = last.1;
            let driven = &plan.drives[case.drive as usize];
            if run.steps_per_period.is_none() && case.steps > 0 {
                case.steps = match basis {
                    BasisRule::Shares { accuracy } if accuracy > run.accuracy => {
                        case.steps.min(steps_of(case, driven, run))
                    }
                    _ => case.steps.max(steps::fewest(driven)),
                };
            }
        }
        let mut chosen = vec![false; plan.cases.len()];
        wanted.iter().for_each(|(i, _)| chosen[*i as usize] = true);
        for (case, _) in plan.cases.iter_mut().zip(chosen).filter(|(_, chosen)| !chosen) {
            case.drive = drive_of(case.drive, None, &mut plan.drives);
        }
        plan.classes = classify(&plan.cases, &plan.drives, wanted.iter().map(|(i, _)| *i));
        plan
    }

    /// These instances, first those that can have a richer basis, then the others.
    pub fn can_be_richer(&self, instances: Vec<u32>) -> (Vec<u32>, Vec<u32>) {
        let mut known: HashMap<(u32, u32), bool> = HashMap::new();
        instances.into_iter().partition(|i| {
            let (case, driven) = (&self.cases[*i as usize], self.driven(*i));
            let rung = driven.rung(&case.contact, case.gap);
            *known.entry((case.drive, rung)).or_insert_with(|| notch(driven, rung, &self.run).is_some())
        })
    }

    /// The same plan for these instances alone, with the least of the bases that are richer than their own and as many
    /// more steps as half of what that needs on the safe side. This plan's drives keep their places.
    pub fn with_richer_bases(&self, instances: &[u32]) -> Self {
        let mut plan = self.clone();
        let mut made: HashMap<(u32, u32), u32> = HashMap::new();
        for &i in instances {
            let driven = self.driven(i);
            let case = &mut plan.cases[i as usize];
            let rung = driven.rung(&case.contact, case.gap);
            case.drive = *made.entry((case.drive, rung)).or_insert_with(|| {
                let Some(kept) = notch(driven, rung, &self.run) else { return case.drive };
                plan.drives.push(Driven { kept, ..driven.clone() });
                plan.drives.len() as u32 - 1
            });
            if self.run.steps_per_period.is_none() && case.steps > 0 {
                case.steps = case.steps.max(steps::fewest(&plan.drives[case.drive as usize]) / 2);
            }
        }
        plan.classes = classify(&plan.cases, &plan.drives, instances.iter().copied());
        plan
    }

    /// The rule by which an instance's basis was chosen.
    pub fn basis_rule(&self, instance: u32) -> BasisRule {
        self.driven(instance).kept.rule
    }

    /// The basis for the contacts of an instance that the modes with the largest shares do not serve, and the next
    /// poorer one; none where there is none.
    pub fn contact_basis_rule(&self, instance: u32) -> Option<BasisRule> {
        let (case, driven) = (&self.cases[instance as usize], self.driven(instance));
        let rung = driven.rung(&case.contact, case.gap);
        Some(richer_than(driven, rung, driven.kept.modes.len())?.rule)
    }

    /// Takes an instance's basis from another plan of the same scene, where it is number `there`; `taken` knows by that
    /// plan's drives those of this one.
    pub fn take_basis(&mut self, i: u32, other: &Self, there: u32, taken: &mut HashMap<u32, u32>) {
        let drive = other.cases[there as usize].drive;
        let driven = &other.drives[drive as usize];
        let mine = &self.drives[self.cases[i as usize].drive as usize];
        if Arc::ptr_eq(&mine.kept, &driven.kept) {
            return;
        }
        self.cases[i as usize].drive = *taken.entry(drive).or_insert_with(|| {
            self.drives.push(driven.clone());
            self.drives.len() as u32 - 1
        });
    }
}

/// Richer bases are looked for at so many times finer accuracies, one after the other.
const FINER: f64 = 0.25;
const NOTCHES: usize = 8;

/// The least of the bases that are richer than this one, for contacts of this rung; none where it is the richest that
/// can be stepped, or is prescribed.
fn notch(driven: &Driven, rung: u32, run: &Run) -> Option<Arc<ReducedBasis>> {
    if run.modes.is_some() {
        return None;
    }
    match driven.kept.rule {
        BasisRule::Contact { .. } => {
            let richer = reduced_by(driven, driven.kept.rule.richer()?, run);
            (richer.modes != driven.kept.modes).then_some(richer)
        }
        BasisRule::Shares { accuracy } => {
            let accuracies = (1..=NOTCHES as i32).map(|n| accuracy * FINER.powi(n));
            let mut bases =
                accuracies.map(|accuracy| reduced_by(driven, BasisRule::Shares { accuracy }, run));
            let found = bases.find(|basis| basis.modes != driven.kept.modes);
            found.or_else(|| richer_than(driven, rung, driven.kept.modes.len()))
        }
    }
}

/// The least of the bases for contacts of this rung that has more than so many oscillators.
fn richer_than(driven: &Driven, rung: u32, modes: usize) -> Option<Arc<ReducedBasis>> {
    driven.for_contacts(rung, |kept| kept.modes.len() > modes).filter(|kept| kept.modes.len() > modes)
}

/// The basis that the rule asks for.
fn reduced_by(driven: &Driven, rule: BasisRule, run: &Run) -> Arc<ReducedBasis> {
    driven.reduced_by(rule, |accuracy| shares(driven, accuracy, run))
}

/// The rule's steps for a case and its basis.
fn steps_of(case: &CasePlan, driven: &Driven, run: &Run) -> u32 {
    let (omega, amplitude) = (driven.free.omega, driven.free.tip.norm());
    steps::steps(&case.contact, &driven.kept, omega, amplitude, case.gap, run.accuracy)
}
