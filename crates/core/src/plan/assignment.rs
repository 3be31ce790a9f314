//! Assigns each instance its drive, with the basis, and its steps.

use super::basis::ModeDemand;
use super::contact_rate::{OctaveCache, RateOctave};
use super::interning::Interned;
use super::{Driven, Ensemble, InstanceId, ReducedBasis, steps};
use crate::contact::Contact;
use crate::instrument::Instrument;
use crate::scene::{Run, Start, Steady};
use rayon::prelude::*;
use std::collections::{BTreeSet, HashMap};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Instances whose contacts one thread makes together.
const TOGETHER: usize = 1 << 10;

/// Instances processed at once: intermediate results of each are larger than what is kept.
pub(super) const INSTANCES_AT_ONCE: usize = 1 << 16;

/// Most steps that keeping a fast oscillator may cost, per period of the lever's first mode or of the drive, whichever is
/// shorter.
const MAX_STEPS_FOR_MODES: f64 = 2048.0;

/// Maps `of` over all instances and their contacts, a stretch at a time.
fn in_stretches<'a, T: Send>(
    ensemble: &'a Ensemble,
    of: impl Fn(&mut OctaveCache<'a>, InstanceId, &Contact) -> T + Sync + 'a,
) -> impl Iterator<Item = Vec<T>> + 'a {
    (0..ensemble.len()).step_by(INSTANCES_AT_ONCE).map(move |from| {
        let to = ensemble.len().min(from + INSTANCES_AT_ONCE);
        let pieces: Vec<Vec<T>> = (from..to)
            .into_par_iter()
            .step_by(TOGETHER)
            .map(|from| {
                let ids = (from..to.min(from + TOGETHER)).map(|i| InstanceId(i as u32));
                let contacts = ensemble.contacts_of(ids.clone());
                let mut last = OctaveCache::default();
                ids.zip(contacts).map(|(id, contact)| of(&mut last, id, &contact.contact())).collect()
            })
            .collect();
        pieces.into_iter().flatten().collect()
    })
}

/// The drive, with the basis, and the steps of each instance. An instance whose contact is too fast for the modes with the
/// largest shares gets a drive of its own, which is added to `drives`.
pub(super) fn resolutions(ensemble: &Ensemble, run: &Run, drives: &mut Vec<Driven>) -> Interned<(u32, u32)> {
    let led = is_led(ensemble, run);
    // Prescribed modes stay; prescribed steps are for the modes that they can step.
    let told = run.modes.is_some() || run.steps_per_period.is_some();
    let known = &*drives;
    let mut usual = Interned::new();
    in_stretches(ensemble, |tip, id, contact| {
        let (own, gap) = (ensemble.drive_of.get(id.0 as usize), ensemble.gap(id));
        let driven = &known[own as usize];
        let octave = if told { RateOctave::default() } else { tip.octave((own, driven), contact, gap) };
        ((own, octave), steps_of((run, led), (contact, gap), driven))
    })
    .for_each(|some| some.into_iter().for_each(|one| usual.push(one)));
    let made = if told { HashMap::new() } else { fast_contacts(usual.known(), run, drives) };
    let mut resolution = Interned::new();
    for i in 0..ensemble.len() {
        let (key, steps) = usual.get(i);
        resolution.push(match made.get(&key) {
            None => (key.0, steps),
            Some(drive) => {
                let id = InstanceId(i as u32);
                let (contact, driven) = (ensemble.contact(id), &drives[*drive as usize]);
                (*drive, steps_of((run, led), (&contact, ensemble.gap(id)), driven))
            }
        });
    }
    resolution
}

/// A drive and the octave of a contact.
type Key = (u32, RateOctave);

/// Makes bases for contacts that are too fast for the modes with the largest shares, one per drive and octave. Adds them to
/// `drives` and returns their numbers.
fn fast_contacts(all: &[(Key, u32)], run: &Run, drives: &mut Vec<Driven>) -> HashMap<Key, u32> {
    let distinct: BTreeSet<Key> = all.iter().map(|(key, _)| *key).collect();
    let distinct: Vec<Key> = distinct.into_iter().collect();
    let bases: Vec<Option<Arc<ReducedBasis>>> = distinct
        .par_iter()
        .map(|(drive, octave)| {
            let driven = &drives[*drive as usize];
            driven.for_octave(*octave, run.accuracy, |rule| shares(driven, rule, run))
        })
        .collect();
    let mut made: HashMap<Key, u32> = HashMap::new();
    for (key, kept) in distinct.into_iter().zip(bases) {
        if let Some(kept) = kept {
            made.insert(key, drives.len() as u32);
            drives.push(Driven { kept, ..drives[key.0 as usize].clone() });
        }
    }
    made
}

/// Whether instances may reach states that the free oscillation does not lead to: contact may then continue beyond its reach.
fn is_led(ensemble: &Ensemble, run: &Run) -> bool {
    let follows = ensemble.curves.is_some() || !ensemble.setpoints.is_empty() || run.both_branches;
    follows && run.steady == Steady::Search
}

/// Steps per period of an instance; 0 if it never feels the sample.
fn steps_of((run, led): (&Run, bool), (contact, gap): (&Contact, f64), driven: &Driven) -> u32 {
    let mut amplitude = driven.free_amplitude();
    if run.start == Start::Steady && contact.is_out_of_reach(amplitude, gap) {
        if !led || !contact.law.acts() {
            return 0;
        }
        amplitude = driven.swing(gap);
    }
    run.steps_per_period.unwrap_or_else(|| {
        steps::steps(contact, &driven.kept, driven.free.omega, amplitude, gap, run.accuracy)
    })
}

/// The modes with the largest shares that an accuracy needs, with or without faint resonant ones.
pub(super) fn shares(driven: &Driven, (accuracy, resonant): (f64, bool), run: &Run) -> ReducedBasis {
    by_shares(&driven.instrument, driven.free.omega, (accuracy, resonant), run)
}

/// The same of an instrument under a drive of angular frequency `omega`. Only periodic states whose accuracy is refined can
/// begin without faint resonant modes.
pub(super) fn by_shares(
    instrument: &Instrument,
    omega: f64,
    (accuracy, resonant): (f64, bool),
    run: &Run,
) -> ReducedBasis {
    let most = steps_for_modes(instrument, omega / TAU, run.steps_per_period);
    let refined =
        run.steps_per_period.is_none() && run.start == Start::Steady && run.steady == Steady::Search;
    let demand = ModeDemand { accuracy, asked: run.accuracy, resonant: resonant || !refined, refined };
    ReducedBasis::choose(instrument, omega, demand, run.modes, most)
}

/// Most steps per period that a kept mode may need.
fn steps_for_modes(instrument: &Instrument, frequency: f64, asked: Option<u32>) -> f64 {
    match asked {
        Some(steps) => f64::from(steps),
        None => MAX_STEPS_FOR_MODES * (instrument.lever_frequency / frequency).max(1.0),
    }
}
