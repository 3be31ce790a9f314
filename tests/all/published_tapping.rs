//! Tapping points that two independent programs and an event-located integrator agree on
//! (the integrator's own check stands in `exact_reference.rs`).

use crate::checks;
use crate::checks::bounds;
use afmsweep::observe::{Measured, Status};
use afmsweep::scene::Scene;
use std::f64::consts::PI;
use std::path::Path;

/// What is confirmed, to the digits given; nm, degree, nN, 1, J.
struct Point {
    scene: &'static str,
    amplitude: f64,
    phase: f64,
    force_max: f64,
    force_mean: Option<f64>,
    contact_time: f64,
    loss: f64,
    /// pi k A0/Q, J per m of amplitude at resonance.
    drive: f64,
}

const DMT: Point = Point {
    scene: "tests/scenes/steady/published_dmt.toml",
    amplitude: 57.41833265,
    phase: 73.14449451,
    force_max: 28.4392116,
    force_mean: Some(3.589291697),
    contact_time: 0.2527763,
    loss: 0.0,
    drive: PI * 10.0 * 60e-9 / 25.0,
};

const JKR: Point = Point {
    scene: "tests/scenes/steady/published_jkr.toml",
    amplitude: 51.03504654,
    phase: 61.86202736,
    force_max: 8.427959969,
    force_mean: None,
    contact_time: 0.1692147,
    loss: 1.00110179e-17,
    drive: PI * 5.0 * 60e-9 / 150.0,
};

/// Largest errors allowed: amplitude and forces relative, phase in degrees, loss relative to the
/// closed form, or, where there is none, to the drive's work.
struct Bounds {
    amplitude: f64,
    phase: f64,
    force: f64,
    contact_time: f64,
    loss: f64,
}

fn check(point: &Point, steps: Option<u32>, bounds: &Bounds) {
    let scene = Scene::load(Path::new(point.scene)).expect("the scene is good");
    let plan = checks::plan(&scene, steps);
    let result = checks::run(&plan)[0];
    assert_eq!(result.status, Status::Ok);
    let m: Measured = result.measured;
    println!("{} at {} steps a period", scene.title, plan.steps(0));
    let hold = |name: &str, value: f64, expected: f64, scale: f64, bound: f64| {
        let error = (value - expected).abs() / scale;
        println!("  {name}: {value:.9} (confirmed {expected}), off by {error:.1e}, bound {bound:.0e}");
        assert!(error <= bound, "{name}: {value}, confirmed {expected}, off by {error:e}, bound {bound:e}");
    };
    let amplitude = m.harmonics[0];
    hold("amplitude, nm", amplitude * 1e9, point.amplitude, point.amplitude, bounds.amplitude);
    hold("phase, degree", m.phase, point.phase, 1.0, bounds.phase);
    hold("largest force, nN", m.force_max * 1e9, point.force_max, point.force_max, bounds.force);
    if let Some(mean) = point.force_mean {
        hold("mean force, nN", m.force_mean * 1e9, mean, mean, bounds.force);
    }
    hold("contact time", m.contact_time, point.contact_time, 1.0, bounds.contact_time);
    let work = point.drive * amplitude * m.phase.to_radians().sin();
    let scale = if point.loss > 0.0 { point.loss } else { work };
    hold("loss, 1e-17 J", m.dissipation * 1e17, point.loss * 1e17, scale * 1e17, bounds.loss);
    assert_eq!(m.contacts, 1.0);
}

#[test]
fn both_points_given_enough_steps() {
    for (point, steps) in [(&DMT, 8192), (&JKR, 8192)] {
        check(point, Some(steps), &bounds_of(bounds::PUBLISHED_FINE));
    }
}

#[test]
fn both_points_at_the_plans_own_steps() {
    for point in [&DMT, &JKR] {
        check(point, None, &bounds_of(bounds::PUBLISHED_PLAN));
    }
}

fn bounds_of([amplitude, phase, force, contact_time, loss]: [f64; 5]) -> Bounds {
    Bounds { amplitude, phase, force, contact_time, loss }
}
