//! Between a plan's stations and the kernel's units.

use super::member::member;
use super::saved::Saved;
use super::start;
use crate::kernel::{LENGTH, RunSums};
use crate::plan::{Plan, Station};
use std::f64::consts::PI;

/// Where these instances start, if the plan says so.
#[cfg(feature = "gpu")]
pub(super) fn begin(plan: &Plan, instances: &[u32]) -> Option<Vec<Saved>> {
    let starts = plan.starts.as_ref()?;
    let at = |&instance: &u32| saved(plan, instance, &starts[instance as usize].station);
    Some(instances.iter().map(at).collect())
}

pub(super) fn saved(plan: &Plan, instance: u32, station: &Station) -> Saved {
    let (case, driven) = member(plan, instance);
    let (cosine, sine) = start::amplitudes(driven, plan.run.start);
    let half = PI / f64::from(case.steps);
    let travel = cosine * half.cos() + sine * half.sin() + station.x.iter().sum::<f64>();
    let touching = f64::from(u8::from(station.touching));
    Saved {
        x: station.x.map(|x| x / LENGTH),
        u: station.u.map(|u| u / LENGTH),
        touching,
        last: [-(case.gap + travel) / LENGTH; 2],
        touched: touching,
        run_sums: RunSums::new(),
        finite: station.finite,
    }
}

/// Where an instance was left.
#[cfg(feature = "gpu")]
pub(super) fn station(saved: &Saved) -> Station {
    Station {
        x: saved.x.map(|x| x * LENGTH),
        u: saved.u.map(|u| u * LENGTH),
        touching: saved.touching > 0.0,
        finite: saved.finite,
    }
}
