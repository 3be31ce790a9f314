//! Tips of other shapes, and layers. Truth: an independent integrator, whose forces on a thick sample come by dimensionality
//! reduction; and the paraboloid.

use crate::checks::{self, Twin, bounds, calibrated, one_mode, sample, worst};
use afmsweep::Scene;
use afmsweep::observe::Status;
use afmsweep::scene::{DriveFrequency, LawChoice, TipShape};

/// A shape with a law that knows it, and the thickness (m) of a layer.
type Contact = (TipShape, LawChoice, Option<f64>);

const CONTACTS: [Contact; 10] = [
    (TipShape::Sphere, LawChoice::Hertz, None),
    (TipShape::Sphere, LawChoice::Dmt, None),
    (TipShape::Cone, LawChoice::Hertz, None),
    (TipShape::Pyramid, LawChoice::Hertz, None),
    (TipShape::Punch, LawChoice::Hertz, None),
    (TipShape::Hyperboloid, LawChoice::Hertz, None),
    (TipShape::SpheroCone, LawChoice::Hertz, None),
    (TipShape::Paraboloid, LawChoice::Hertz, Some(20e-9)),
    (TipShape::Paraboloid, LawChoice::Dmt, Some(20e-9)),
    (TipShape::Cone, LawChoice::Hertz, Some(20e-9)),
];

fn shaped(scene: &mut Scene, (shape, _, thickness): Contact) {
    scene.base.instrument.tip.shape = shape;
    scene.base.instrument.tip.half_angle = shape.has_angle().then_some(35.0);
    scene.base.sample.thickness = thickness;
}

/// One mode and a whole lever, soft and stiff, at resonance and off it.
fn cases(contact: Contact) -> Vec<Scene> {
    let mut cases = Vec::new();
    for modulus in [30e6, 1e9] {
        for detuning in [1.0, 0.98] {
            cases.push(one_mode(5.0, 60e3, 20.0, 50e-9, 35e-9, |scene| {
                sample(scene, contact.1, modulus, 0.01, 15e-9);
                shaped(scene, contact);
                scene.base.drive.frequency = DriveFrequency::Hertz(detuning * 60e3);
            }));
        }
        cases.push(calibrated(10.0, 75e3, 30.0, 30e-9, 20e-9, |scene| {
            sample(scene, contact.1, modulus, 0.01, 15e-9);
            shaped(scene, contact);
        }));
    }
    cases
}

#[test]
fn agree_with_an_independent_integrator_at_the_plans_own_steps() {
    for contact in CONTACTS {
        let mut largest = ("", 0.0);
        for scene in cases(contact) {
            let (status, steps, errors) = checks::compare(&scene, None, Twin::Kept);
            assert_eq!(status, Status::Ok, "{contact:?}");
            let one = worst(&errors);
            assert!(one.1 < bounds::STEPS_PLAN, "{contact:?}, {steps} steps: {}", checks::show(&errors));
            largest = if one.1 > largest.1 { one } else { largest };
        }
        println!("{contact:?}: at most {:.1e} ({})", largest.1, largest.0);
    }
}

#[test]
fn agree_with_it_to_more_digits_with_more_steps() {
    for contact in CONTACTS {
        let mut largest = ("", 0.0);
        for scene in cases(contact) {
            let (status, _, errors) = checks::compare(&scene, Some(4096), Twin::Kept);
            assert_eq!(status, Status::Ok, "{contact:?}");
            let one = worst(&errors);
            let bound = match contact.0 {
                TipShape::Hyperboloid => bounds::HYPERBOLOID_FINE,
                _ => bounds::SHAPES_FINE,
            };
            assert!(one.1 < bound, "{contact:?}: {}", checks::show(&errors));
            largest = if one.1 > largest.1 { one } else { largest };
        }
        println!("{contact:?}: at most {:.1e} ({}) with 4,096 steps", largest.1, largest.0);
    }
}

/// Truth: a sphere that hardly sinks in is a paraboloid.
#[test]
fn a_shallow_sphere_is_a_paraboloid() {
    for law in [LawChoice::Hertz, LawChoice::Dmt] {
        let scene = |shape| {
            one_mode(5.0, 60e3, 20.0, 50e-9, 35e-9, |scene| {
                sample(scene, law, 1e9, 0.01, 1e-5);
                shaped(scene, (shape, law, None));
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
