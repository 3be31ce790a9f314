//! Order of convergence: how fast the swing's error falls with the steps per period.

use crate::checks;
use crate::checks::{Twin, bounds, one_mode, sample};
use afmsweep::scene::{LawChoice, Scene, TipShape};
use std::f64::consts::PI;

/// Error of the fundamental's phasor in units of the free amplitude, for each count of steps.
fn swing_errors(scene: &Scene, counts: &[u32]) -> Vec<f64> {
    let plan = checks::plan(scene, None);
    let truth = checks::reference(&plan, 0, Twin::Whole);
    let free = plan.drives[0].free_amplitude();
    let point = |amplitude: f64, degree: f64| {
        let (sine, cosine) = degree.to_radians().sin_cos();
        [amplitude * cosine, amplitude * sine]
    };
    let [x, y] = point(truth.amplitude, truth.phase);
    counts
        .iter()
        .map(|&count| {
            let m = checks::one(scene, Some(count)).measured;
            let [a, b] = point(m.harmonics[0], m.phase);
            (a - x).hypot(b - y) / free
        })
        .collect()
}

/// Slope of the straight line through log(error) over log(steps), sign changed.
fn order(counts: &[u32], errors: &[f64]) -> f64 {
    let points: Vec<(f64, f64)> =
        counts.iter().zip(errors).map(|(n, e)| (f64::from(*n).ln(), e.ln())).collect();
    let n = points.len() as f64;
    let (x, y) = points.iter().fold((0.0, 0.0), |(x, y), p| (x + p.0 / n, y + p.1 / n));
    let up: f64 = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum();
    let across: f64 = points.iter().map(|p| (p.0 - x).powi(2)).sum();
    -up / across
}

/// Soft enough that a contact takes a good part of the period; several gaps, because where a step
/// falls on the touch makes a single case's error jump by its sign.
fn scenes(law: LawChoice, shape: TipShape) -> Vec<Scene> {
    (0..12)
        .map(|i| {
            one_mode(5.0, 60e3, 20.0, 50e-9, (0.6 + 0.02 * f64::from(i)) * 50e-9, |scene| {
                sample(scene, law, 60e6, 0.01, 15e-9);
                scene.base.instrument.tip.shape = shape;
                scene.base.instrument.tip.half_angle = shape.has_angle().then_some(60.0);
                // Both run the same periods.
                scene.run.periods = (100.0 / PI) as u32;
            })
        })
        .collect()
}

/// Root of the mean square error over the scenes, by steps, and its order.
fn study(law: LawChoice, shape: TipShape, counts: &[u32]) -> f64 {
    let scenes = scenes(law, shape);
    let mut squares = vec![0.0; counts.len()];
    for scene in &scenes {
        for (sum, error) in squares.iter_mut().zip(swing_errors(scene, counts)) {
            *sum += error * error / scenes.len() as f64;
        }
    }
    let errors: Vec<f64> = squares.iter().map(|s| s.sqrt()).collect();
    let order = order(counts, &errors);
    let shown: Vec<String> = errors.iter().map(|e| format!("{e:.1e}")).collect();
    println!("{law:?}, {shape:?}: steps {counts:?}, errors {shown:?}, order {order:.2}");
    order
}

#[test]
fn hertz_converges_above_third_order() {
    assert!(
        study(LawChoice::Hertz, TipShape::Paraboloid, &[32, 48, 64, 96, 128, 192, 256])
            >= bounds::ORDER_HERTZ
    );
}

#[test]
fn other_shapes_converge() {
    for shape in [TipShape::Cone, TipShape::Pyramid] {
        assert!(study(LawChoice::Hertz, shape, &[64, 96, 128, 192, 256]) >= bounds::ORDER_HERTZ);
    }
    // Its slope jumps at touch.
    let punch = study(LawChoice::Hertz, TipShape::Punch, &[64, 128, 256, 512, 1024, 2048]);
    assert!(punch >= bounds::ORDER_PUNCH);
    // With more steps what is left is the sphere's sum, some 3e-9 of the amplitude.
    for (law, bound) in [(LawChoice::Hertz, bounds::ORDER_HERTZ), (LawChoice::Dmt, bounds::ORDER_DMT)] {
        assert!(study(law, TipShape::Sphere, &[64, 96, 128, 192, 256]) >= bound);
    }
}

#[test]
fn dmt_converges() {
    assert!(
        study(LawChoice::Dmt, TipShape::Paraboloid, &[64, 128, 256, 512, 1024, 2048, 4096])
            >= bounds::ORDER_DMT
    );
}

#[test]
fn jkr_converges() {
    assert!(
        study(LawChoice::Jkr, TipShape::Paraboloid, &[64, 128, 256, 512, 1024, 2048, 4096])
            >= bounds::ORDER_JKR
    );
}
