//! Tips of other shapes. Truth: an independent integrator whose forces come by dimensionality reduction, and the paraboloid.

use crate::checks::{self, Twin, bounds, calibrated, one_mode, sample, worst};
use afmsweep::Scene;
use afmsweep::observe::Status;
use afmsweep::scene::{DriveFrequency, LawChoice, TipShape};

/// Shapes, each with a law that knows it.
const SHAPES: [(TipShape, LawChoice); 5] = [
    (TipShape::Sphere, LawChoice::Hertz),
    (TipShape::Sphere, LawChoice::Dmt),
    (TipShape::Cone, LawChoice::Hertz),
    (TipShape::Pyramid, LawChoice::Hertz),
    (TipShape::Punch, LawChoice::Hertz),
];

fn shaped(scene: &mut Scene, shape: TipShape) {
    scene.base.instrument.tip.shape = shape;
    scene.base.instrument.tip.half_angle = shape.has_angle().then_some(35.0);
}

/// One mode and a whole lever, soft and stiff, at resonance and off it.
fn cases(shape: TipShape, law: LawChoice) -> Vec<Scene> {
    let mut cases = Vec::new();
    for modulus in [30e6, 1e9] {
        for detuning in [1.0, 0.98] {
            cases.push(one_mode(5.0, 60e3, 20.0, 50e-9, 35e-9, |scene| {
                sample(scene, law, modulus, 0.01, 15e-9);
                shaped(scene, shape);
                scene.base.drive.frequency = DriveFrequency::Hertz(detuning * 60e3);
            }));
        }
        cases.push(calibrated(10.0, 75e3, 30.0, 30e-9, 20e-9, |scene| {
            sample(scene, law, modulus, 0.01, 15e-9);
            shaped(scene, shape);
        }));
    }
    cases
}

#[test]
fn agree_with_an_independent_integrator_at_the_plans_own_steps() {
    for (shape, law) in SHAPES {
        let mut largest = ("", 0.0);
        for scene in cases(shape, law) {
            let (status, steps, errors) = checks::compare(&scene, None, Twin::Kept);
            assert_eq!(status, Status::Ok, "{shape:?} {law:?}");
            let one = worst(&errors);
            assert!(
                one.1 < bounds::STEPS_PLAN,
                "{shape:?} {law:?}, {steps} steps: {}",
                checks::show(&errors)
            );
            largest = if one.1 > largest.1 { one } else { largest };
        }
        println!("{shape:?}, {law:?}: at most {:.1e} ({})", largest.1, largest.0);
    }
}

#[test]
fn agree_with_it_to_more_digits_with_more_steps() {
    for (shape, law) in SHAPES {
        let mut largest = ("", 0.0);
        for scene in cases(shape, law) {
            let (status, _, errors) = checks::compare(&scene, Some(4096), Twin::Kept);
            assert_eq!(status, Status::Ok, "{shape:?} {law:?}");
            let one = worst(&errors);
            assert!(one.1 < bounds::SHAPES_FINE, "{shape:?} {law:?}: {}", checks::show(&errors));
            largest = if one.1 > largest.1 { one } else { largest };
        }
        println!("{shape:?}, {law:?}: at most {:.1e} ({}) with 4,096 steps", largest.1, largest.0);
    }
}

/// Truth: a sphere that hardly sinks in is a paraboloid.
#[test]
fn a_shallow_sphere_is_a_paraboloid() {
    for law in [LawChoice::Hertz, LawChoice::Dmt] {
        let scene = |shape| {
            one_mode(5.0, 60e3, 20.0, 50e-9, 35e-9, |scene| {
                sample(scene, law, 1e9, 0.01, 1e-5);
                shaped(scene, shape);
            })
        };
        let [round, parabola] = [TipShape::Sphere, TipShape::Paraboloid].map(|shape| {
            let one = checks::one(&scene(shape), Some(512));
            assert_eq!(one.status, Status::Ok);
            one.measured
        });
        let off = [
            (round.harmonics[0] - parabola.harmonics[0]) / parabola.harmonics[0],
            (round.force_max - parabola.force_max) / parabola.force_max,
        ];
        println!("{law:?}: {off:?} of the paraboloid's");
        let depth = parabola.indentation_max / 1e-5;
        assert!(off.iter().all(|off| off.abs() < depth), "{off:?}, {depth:e}");
        assert!(off[1] != 0.0, "the same law");
    }
}
