//! Points between the points of a curve.

use super::ensemble::{Contacts, Gaps};
use super::resolution::{Ids, InstanceResolution, InstanceResolutions};
use super::{Drive, Driven, Ensemble, Plan};
use crate::scene::DriveLevel;
use std::collections::HashMap;
use std::f64::consts::TAU;
use std::sync::Arc;

impl Plan {
    /// A plan of one instance per pair of curve points, at a share of the distance from the first to the second. Gap and drive
    /// are interpolated; contact, steps and basis are the second's.
    #[must_use]
    pub fn between(&self, pairs: &[(u32, u32, f64)]) -> Self {
        let mut known = HashMap::new();
        let mut drives: Vec<Driven> = Vec::new();
        let mut add = |driven: Driven| {
            drives.push(driven);
            drives.len() as u32 - 1
        };
        let mut gaps = Vec::with_capacity(pairs.len());
        let mut contacts = Vec::with_capacity(pairs.len());
        let mut resolution = Vec::with_capacity(pairs.len());
        for &(first, second, share) in pairs {
            let (one, other) = (self.driven(first), self.driven(second));
            let drive = if share >= 1.0 || Arc::ptr_eq(&one.drive, &other.drive) {
                let same = (Arc::as_ptr(&other.drive), Arc::as_ptr(&other.kept));
                *known.entry(same).or_insert_with(|| add(other.clone()))
            } else {
                let drive = drive_between(&one.drive, &other.drive, share);
                add(Driven { drive: drive.unwrap_or_else(|| Arc::clone(&other.drive)), ..other.clone() })
            };
            let (from, to) = (self.case(first), self.case(second));
            let gap = from.gap * (1.0 - share) + to.gap * share;
            gaps.push(gap);
            contacts.push(*to.contact);
            resolution.push(InstanceResolution { gap, drive, steps: to.steps });
        }
        let ensemble = Ensemble {
            drives: drives.iter().map(|driven| Arc::clone(&driven.drive)).collect(),
            drive_of: resolution.iter().map(|one: &InstanceResolution| one.drive).collect(),
            contacts: Contacts::Shared { of: (0..pairs.len() as u32).collect(), all: contacts },
            gaps: Gaps::Each(gaps),
            columns: 0,
            setpoints: Vec::new(),
            curves: None,
            grid: None,
        };
        Self {
            ids: Ids::All(pairs.len() as u32),
            ensemble: Arc::new(ensemble),
            resolution: InstanceResolutions::of(resolution),
            contacts: None,
            drives,
            ..self.part(&[])
        }
    }
}

/// A drive of the same instrument between two; `None` if the tip does not move under it.
fn drive_between(one: &Arc<Drive>, other: &Arc<Drive>, share: f64) -> Option<Arc<Drive>> {
    let mix = |one: f64, other: f64| one * (1.0 - share) + other * share;
    let frequency = mix(one.free.omega, other.free.omega) / TAU;
    let level = mix(one.free.level, other.free.level);
    // An amplitude sets the level of any kind of drive.
    let amplitude = other.free.tip.norm();
    let free = |amplitude| other.instrument.free_motion(DriveLevel::FreeAmplitude(amplitude), frequency).ok();
    let free = free(amplitude * level / free(amplitude)?.level)?;
    Some(Arc::new(Drive { instrument: Arc::clone(&other.instrument), free }))
}
