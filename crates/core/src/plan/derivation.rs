//! Plans derived from others of the same ensemble: some instances, other steps, other bases.

use super::contact_rate::RateOctave;
use super::rebasing::{fewest_steps, next_richer, reduced_by, richer_than, with_waiting};
use super::resolution::{Ids, InstanceResolution, InstanceResolutions};
use super::{BasisRule, Driven, InstanceId, Plan, Precision, ReducedBasis, StartState, steps};
use crate::observe::wants;
use crate::scene::Run;
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;

impl Plan {
    /// A plan of some of this one's instances, in this order and with repetitions. It begins where the scene says, and traces
    /// no waveforms.
    pub fn part(&self, instances: &[u32]) -> Self {
        let mut place = HashMap::new();
        let mut drives = Vec::new();
        // Most instances have the drive of the one before.
        let mut last = None;
        let mut resolution = |i: &u32| {
            let own = self.resolution(*i);
            let drive = match last {
                Some((same, drive)) if same == own.drive => drive,
                _ => *place.entry(own.drive).or_insert_with(|| {
                    drives.push(self.drives[own.drive as usize].clone());
                    drives.len() as u32 - 1
                }),
            };
            last = Some((own.drive, drive));
            InstanceResolution { drive, ..own }
        };
        let resolution = instances.iter().map(&mut resolution).collect();
        let ids: Vec<InstanceId> = instances.iter().map(|i| self.id(*i)).collect();
        let contacts = match &self.contacts {
            Some(all) => instances.iter().map(|i| all[*i as usize]).collect(),
            None if self.at_hand() => Vec::new(),
            None => self.ensemble.contacts_of(ids.iter().copied()),
        };
        Self {
            ensemble: Arc::clone(&self.ensemble),
            ids: Ids::Some(ids),
            resolution: InstanceResolutions::of(resolution),
            contacts: (!self.at_hand() || self.contacts.is_some()).then(|| Arc::new(contacts)),
            drives,
            observables: self.observables.clone(),
            wants: self.wants,
            run: self.run.clone(),
            precision: self.precision,
            precision_open: self.precision_open,
            policy: self.policy,
            cold: self.cold,
            waveforms: None,
            starts: None,
        }
    }

    /// Copies its drives and bases, bit by bit. Threads that clone one `Arc` contend for its counter, so each chunk has its
    /// own.
    #[must_use]
    pub fn with_own_drives(mut self) -> Self {
        let (mut drives, mut bases) = (HashMap::new(), HashMap::new());
        for driven in &mut self.drives {
            driven.drive = Arc::clone(
                drives.entry(Arc::as_ptr(&driven.drive)).or_insert_with(|| Arc::new((*driven.drive).clone())),
            );
            driven.kept = Arc::clone(
                bases.entry(Arc::as_ptr(&driven.kept)).or_insert_with(|| Arc::new((*driven.kept).clone())),
            );
        }
        self
    }

    /// Replaces the steps per period of each instance by a function of them. Instances free of the sample stay without steps.
    #[must_use]
    pub fn with_steps(mut self, steps: impl Fn(u32) -> u32) -> Self {
        let stepped = self.each().iter_mut().filter(|own| own.steps > 0);
        stepped.for_each(|own| own.steps = steps(own.steps));
        self
    }

    /// The same steps for all instances, also those free of the sample: to measure the cost of a step.
    #[must_use]
    pub fn stepping_all(mut self, steps: u32) -> Self {
        self.each().iter_mut().for_each(|own| own.steps = steps);
        self
    }

    /// Uses this precision.
    #[must_use]
    pub fn in_precision(self, precision: Precision) -> Self {
        Self { precision, ..self }
    }

    /// Starts at these states, one for each instance.
    #[must_use]
    pub fn starting_at(self, starts: Vec<StartState>) -> Self {
        Self { starts: Some(Arc::new(starts)), ..self }
    }

    /// [`Plan::part`] over `periods`, the last `measure` of them measured: the same stepping, but only the fundamental is
    /// summed.
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

    /// Uses the modes that `accuracy` asks for by their shares, and as many more steps as they need. Bases made for contacts
    /// stay.
    #[must_use]
    pub fn with_shares(mut self, accuracy: f64) -> Self {
        for driven in &mut self.drives {
            driven.kept = reduced_by(driven, driven.kept.rule.with_accuracy(|_| accuracy), &self.run);
        }
        if self.run.steps_per_period.is_none() {
            for i in self.stepped() {
                let fewest = steps::fewest(self.driven(i));
                let own = &mut self.each()[i as usize];
                own.steps = own.steps.max(fewest);
            }
        }
        self
    }

    /// These instances: first those for which a larger basis exists, then the others.
    pub fn can_be_richer(&self, instances: Vec<u32>) -> (Vec<u32>, Vec<u32>) {
        let mut known: HashMap<(u32, RateOctave), bool> = HashMap::new();
        instances.into_iter().partition(|i| {
            let (case, driven) = (self.case(*i), self.driven(*i));
            let octave = driven.octave(&case.contact, case.gap);
            *known
                .entry((case.drive, octave))
                .or_insert_with(|| next_richer(driven, octave, &self.run).is_some())
        })
    }

    /// Uses the next larger basis of each instance, and at least half the steps that this basis safely needs.
    #[must_use]
    pub fn with_richer_bases(self) -> Self {
        self.with_richer(next_richer)
    }

    /// Adds the modes that a harmonic of the drive meets to the bases that lack them, likewise.
    #[must_use]
    pub fn with_waiting_modes(self) -> Self {
        self.with_richer(|driven, _, run| with_waiting(driven, run))
    }

    /// Uses the `richer` basis of each instance, if there is one.
    fn with_richer(
        mut self,
        richer: impl Fn(&Driven, RateOctave, &Run) -> Option<Arc<ReducedBasis>>,
    ) -> Self {
        let mut made: HashMap<(u32, RateOctave), u32> = HashMap::new();
        for i in self.instances() {
            let case = self.case(i);
            let driven = self.driven(i).clone();
            let octave = driven.octave(&case.contact, case.gap);
            let drive = *made.entry((case.drive, octave)).or_insert_with(|| {
                let Some(kept) = richer(&driven, octave, &self.run) else { return case.drive };
                self.drives.push(Driven { kept, ..driven });
                self.drives.len() as u32 - 1
            });
            let mut steps = self.steps(i);
            if self.run.steps_per_period.is_none() && steps > 0 {
                steps = steps.max(fewest_steps(|| case, &self.drives[drive as usize], &self.run) / 2);
            }
            self.resolution.set(i as usize, (drive, steps));
        }
        self
    }

    /// The rule that chose an instance's basis.
    pub fn basis_rule(&self, instance: u32) -> BasisRule {
        self.driven(instance).kept.rule
    }

    /// The rule of the smallest basis for an instance's contacts with more oscillators than its own; `None` if there is none.
    pub fn contact_basis_rule(&self, instance: u32) -> Option<BasisRule> {
        let (case, driven) = (self.case(instance), self.driven(instance));
        let octave = driven.octave(&case.contact, case.gap);
        Some(richer_than(driven, octave, &self.run)?.rule)
    }

    /// Uses these gaps, one for each instance (m).
    #[must_use]
    pub fn with_gaps(mut self, gaps: &[f64]) -> Self {
        self.each().iter_mut().zip(gaps).for_each(|(own, gap)| own.gap = *gap);
        self
    }

    /// Takes these instances' gaps from a plan of them alone.
    pub fn take_gaps(&mut self, instances: &[u32], other: &Self) {
        for (i, there) in instances.iter().zip(other.instances()) {
            self.each()[*i as usize].gap = other.resolution(there).gap;
        }
    }

    /// An instance's steps, gap and basis rule.
    pub fn resolution_of(&self, instance: u32) -> Resolution {
        let InstanceResolution { gap, steps, .. } = self.resolution(instance);
        Resolution { steps, gap, rule: self.basis_rule(instance) }
    }

    /// Uses the resolutions of another plan of the same instances, one for each.
    #[must_use]
    pub fn with_resolutions(mut self, all: &[Resolution]) -> Self {
        let mut made: HashMap<(u32, [u64; 2]), u32> = HashMap::new();
        for (i, one) in all.iter().enumerate().take(self.len()) {
            let drive = self.resolution.drive(i);
            let of = *made.entry((drive, one.rule.key())).or_insert_with(|| {
                let own = &self.drives[drive as usize];
                if own.kept.rule == one.rule {
                    return drive;
                }
                let driven = Driven { kept: reduced_by(own, one.rule, &self.run), ..own.clone() };
                self.drives.push(driven);
                self.drives.len() as u32 - 1
            });
            self.each()[i] = InstanceResolution { gap: one.gap, drive: of, steps: one.steps };
        }
        self
    }

    /// The basis that a rule makes for an instance.
    pub fn basis_by(&self, instance: u32, rule: BasisRule) -> Arc<ReducedBasis> {
        reduced_by(self.driven(instance), rule, &self.run)
    }

    /// Takes steps, basis and gap from instance `there` of another plan of the same ensemble. `taken` maps that plan's drives
    /// to this one's.
    pub fn take_resolution(&mut self, i: u32, other: &Self, there: u32, taken: &mut HashMap<u32, u32>) {
        let theirs = other.resolution(there);
        let driven = &other.drives[theirs.drive as usize];
        let same = Arc::ptr_eq(&self.driven(i).kept, &driven.kept);
        let own = &mut self.each()[i as usize];
        (own.steps, own.gap) = (theirs.steps, theirs.gap);
        if !same {
            let drive = *taken.entry(theirs.drive).or_insert_with(|| {
                self.drives.push(driven.clone());
                self.drives.len() as u32 - 1
            });
            self.each()[i as usize].drive = drive;
        }
    }

    /// The resolutions of its instances, for changes.
    fn each(&mut self) -> &mut Vec<InstanceResolution> {
        let Self { ensemble, ids, resolution, .. } = self;
        resolution.each(|at| ensemble.gap(ids.get(at as u32)))
    }

    /// Maps `of` over these instances, in order. Its arguments: a plan with the instance, its number there, its number here.
    pub fn of_each<T: Send>(&self, instances: &[u32], of: impl Fn(&Self, u32, u32) -> T + Sync) -> Vec<T> {
        let mut all = Vec::with_capacity(instances.len());
        self.for_each(instances, of, |one| all.push(one));
        all
    }

    /// Like [`Plan::of_each`], but passes each value to `take` instead of holding all.
    pub fn for_each<T: Send>(
        &self,
        instances: &[u32],
        of: impl Fn(&Self, u32, u32) -> T + Sync,
        mut take: impl FnMut(T),
    ) {
        for some in instances.chunks(STRETCH_INSTANCES as usize) {
            let all: Vec<T> = if self.at_hand() {
                some.par_iter().map(|i| of(self, *i, *i)).collect()
            } else {
                let of_part = |some: &[u32]| {
                    let part = self.part(some);
                    some.iter().enumerate().map(|(n, i)| of(&part, n as u32, *i)).collect::<Vec<T>>()
                };
                some.par_chunks(PIECE_INSTANCES).flat_map_iter(of_part).collect()
            };
            all.into_iter().for_each(&mut take);
        }
    }

    /// The plan in parts of limited size, each with the number of its first instance.
    pub(super) fn stretches(&self) -> impl Iterator<Item = (u32, Self)> {
        let count = self.len() as u32;
        (0..count).step_by(STRETCH_INSTANCES as usize).map(move |from| {
            let some: Vec<u32> = (from..count.min(from.saturating_add(STRETCH_INSTANCES))).collect();
            (from, self.part(&some))
        })
    }
}

/// Instances of a large plan that are processed at once, and those of them that one thread processes.
const STRETCH_INSTANCES: u32 = 1 << 16;
const PIECE_INSTANCES: usize = 1 << 12;

/// Resolution of an instance of a plan, as plain numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Per period of the drive; 0 if nothing needs stepping.
    pub steps: u32,
    /// m; NaN if no gap holds its set-point.
    pub gap: f64,
    pub rule: BasisRule,
}
