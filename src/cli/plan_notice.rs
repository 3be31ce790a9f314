//! What is said before a plan that takes seconds: how much there is to plan.

use super::{Verbosity, instances};
use afmsweep::Scene;
use afmsweep::scene::{Layout, LeverSpec, SweptAxes};

/// Instances, and instruments that are reduced one by one, of which planning takes a second or so on one core.
const MANY_INSTANCES: usize = 100_000;
const MANY_INSTRUMENTS: usize = 10_000;

/// Says what is planned where that takes seconds. Printed before it begins.
pub fn announce(scene: &Scene, voice: Verbosity) {
    let instruments = distinct(
        &scene.sweep,
        matches!(scene.base.instrument.cantilever.lever, LeverSpec::Dimensions { .. }),
    );
    if instruments >= MANY_INSTRUMENTS {
        voice.say(format_args!("planning {} with {instruments} rods or levers ...", instances(scene.len())));
    } else if scene.len() >= MANY_INSTANCES {
        voice.say(format_args!("planning {} ...", instances(scene.len())));
    }
}

/// Instruments that are not scaled from one: rods, and levers by their dimensions.
fn distinct(sweep: &SweptAxes, by_dimensions: bool) -> usize {
    const SCALED: [&str; 3] = ["stiffness", "frequency", "quality_factor"];
    let reduced = |path: &str| match path.strip_prefix("instrument.").and_then(|rest| rest.split_once('.')) {
        Some(("actuator", _)) => true,
        Some(("cantilever", key)) => by_dimensions || !SCALED.contains(&key),
        Some(("tip", key)) => by_dimensions && !["radius", "youngs_modulus", "poisson_ratio"].contains(&key),
        _ => false,
    };
    let axes = sweep
        .axes
        .iter()
        .filter(|axis| std::iter::once(*axis).chain(&axis.columns).any(|one| reduced(&one.path)));
    match sweep.layout {
        Layout::Grid => axes.map(|axis| axis.values.len()).product(),
        Layout::List => axes.map(|axis| axis.values.len()).max().unwrap_or(1),
    }
}
