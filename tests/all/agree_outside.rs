//! Forces beside a contact, and forces by numbers. Truth: an independent integrator with their formulas, the laws that a table
//! is made of, and the reference engine.

use crate::checks::{self, Twin, bounds, calibrated, one_mode, sample, worst};
use afmsweep::Scene;
use afmsweep::contact::Contact;
use afmsweep::engine::{Engine, Model, Progress, Reference};
use afmsweep::observe::Status;
use afmsweep::scene::{DriveFrequency, HydrationStrength, LawChoice, OutsideForce, TipShape};

const BIAS: OutsideForce =
    OutsideForce::Electrostatic { bias: 4.0, contact_potential: -0.3, cut_off: 0.4e-9 };
const LAYER: OutsideForce = OutsideForce::DoubleLayer {
    tip_charge: -0.02,
    sample_charge: -0.015,
    screening_length: 1.5e-9,
    permittivity: 78.4,
};
const WALLS: OutsideForce = OutsideForce::Hydration {
    strength: HydrationStrength::Pressure(50e6),
    decay_length: 0.35e-9,
    period: None,
    phase: 0.0,
};
const WAVES: OutsideForce = OutsideForce::Hydration {
    strength: HydrationStrength::Force(checks::WAVE[0]),
    decay_length: checks::WAVE[1],
    period: Some(checks::WAVE[2]),
    phase: checks::WAVE[3],
};

/// Each force with a law and a shape.
fn contacts() -> Vec<(LawChoice, TipShape, Vec<OutsideForce>)> {
    use LawChoice::{Dmt, Hertz};
    use TipShape::{Paraboloid, Sphere};
    vec![
        (Hertz, Paraboloid, vec![BIAS]),
        (Dmt, Paraboloid, vec![BIAS]),
        (Hertz, Paraboloid, vec![LAYER]),
        (Dmt, Sphere, vec![LAYER, WALLS]),
        (Hertz, Paraboloid, vec![WALLS]),
        (Hertz, Paraboloid, vec![WAVES]),
        (Dmt, Paraboloid, vec![BIAS, LAYER, WALLS, WAVES]),
    ]
}

fn cases((law, shape, outside): &(LawChoice, TipShape, Vec<OutsideForce>)) -> Vec<Scene> {
    let mut cases = Vec::new();
    let put = |scene: &mut Scene, modulus: f64| {
        sample(scene, *law, modulus, 0.01, 15e-9);
        scene.base.instrument.tip.shape = *shape;
        scene.base.contact.outside.clone_from(outside);
    };
    for modulus in [30e6, 1e9] {
        for detuning in [1.0, 0.98] {
            cases.push(one_mode(5.0, 60e3, 20.0, 50e-9, 35e-9, |scene| {
                put(scene, modulus);
                scene.base.drive.frequency = DriveFrequency::Hertz(detuning * 60e3);
            }));
        }
        cases.push(calibrated(10.0, 75e3, 30.0, 30e-9, 20e-9, |scene| put(scene, modulus)));
        // A gentle swing in reach of the forces that hardly touches.
        cases.push(one_mode(2.0, 20e3, 3.0, 2e-9, 1.9e-9, |scene| put(scene, modulus)));
    }
    cases
}

#[test]
fn agree_with_an_independent_integrator_at_the_plans_own_steps() {
    for contact in contacts() {
        let mut largest = ("", 0.0);
        for scene in cases(&contact) {
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
    for contact in contacts() {
        let mut largest = ("", 0.0);
        // Each step costs more than without these forces; the four of one mode show it.
        for scene in cases(&contact).into_iter().skip(4) {
            let (status, _, errors) = checks::compare(&scene, Some(2048), Twin::Kept);
            assert_eq!(status, Status::Ok, "{contact:?}");
            let one = worst(&errors);
            assert!(one.1 < bounds::SHAPES_FINE, "{contact:?}: {}", checks::show(&errors));
            largest = if one.1 > largest.1 { one } else { largest };
        }
        println!("{contact:?}: at most {:.1e} ({}) with 2,048 steps", largest.1, largest.0);
    }
}

/// A table of that law: `count` places, graded towards touch on both sides, from 60 nm away to 12 nm deep.
fn tabulated(scene: &Scene, law: LawChoice, count: i32) -> Scene {
    let mut params = scene.base.clone();
    params.contact.law = law;
    let contact = Contact::new(&params);
    let (mut places, mut forces) = (Vec::new(), Vec::new());
    for n in -count..=count {
        let share = f64::from(n) / f64::from(count);
        let place = share.abs().powi(3) * if n < 0 { -60e-9 } else { 12e-9 };
        // At touch the slope jumps: a corner.
        for _ in 0..if n == 0 && law == LawChoice::Dmt { 2 } else { 1 } {
            places.push(format!("\"{place:e} m\""));
            forces.push(format!("\"{:e} N\"", contact.force(place, place > 0.0)));
        }
    }
    let (places, forces) = (places.join(", "), forces.join(", "));
    let text =
        format!("[contact]\nlaw = \"table\"\ntable = {{ indentation = [{places}], force = [{forces}] }}\n");
    let table =
        Scene::parse(std::path::Path::new("table.toml"), &text).unwrap_or_else(|error| panic!("{error}"));
    let mut scene = scene.clone();
    scene.base.contact = table.base.contact;
    scene
}

/// Truth: the law itself. Monotone cubics are of third order, less next to an end of a monotone piece.
#[test]
fn a_table_of_a_law_converges_to_the_law() {
    for law in [LawChoice::Hertz, LawChoice::Dmt] {
        let scene = one_mode(5.0, 60e3, 20.0, 50e-9, 35e-9, |scene| sample(scene, law, 100e6, 0.01, 15e-9));
        let truth = checks::one(&scene, Some(1024)).measured;
        let mut errors = Vec::new();
        for count in [10, 20, 40, 80] {
            let one = checks::one(&tabulated(&scene, law, count), Some(1024));
            assert_eq!(one.status, Status::Ok);
            let ours = one.measured;
            let swing = (ours.harmonics[0] - truth.harmonics[0]) / truth.harmonics[0];
            let turn = (ours.phase - truth.phase).to_radians();
            let force = (ours.force_max - truth.force_max) / truth.force_max;
            errors.push([swing.abs().max(turn.abs()), force.abs()]);
        }
        let order = (errors[0][1] / errors[3][1]).log2() / 3.0;
        println!("{law:?}: swing and largest force off by {errors:?}, order of the force {order:.2}");
        assert!(order > bounds::ORDER_TABLE, "{law:?}");
        assert!(errors[3].iter().all(|error| *error < bounds::TABLE_FINE), "{law:?}: {errors:?}");
    }
}

/// Truth: the reference engine, on the same table.
#[test]
fn a_table_is_stepped_as_well_as_a_law() {
    for (modulus, detuning, gap) in [(30e6, 1.0, 35e-9), (1e9, 0.98, 35e-9), (1e9, 1.0, 49e-9)] {
        let scene = one_mode(5.0, 60e3, 20.0, 50e-9, gap, |scene| {
            sample(scene, LawChoice::Dmt, modulus, 0.03, 15e-9);
            scene.base.drive.frequency = DriveFrequency::Hertz(detuning * 60e3);
        });
        let scene = tabulated(&scene, LawChoice::Dmt, 60);
        let plan = checks::plan(&scene, None);
        let reference = Reference { tolerance: 1e-12, model: Model::Kept };
        let truth = reference.run(&plan, &Progress::default()).unwrap().results[0];
        let ours = checks::run(&plan)[0];
        assert_eq!((ours.status, truth.status), (Status::Ok, Status::Ok));
        let truth = checks::outcome(&truth.measured);
        let errors = checks::errors(&ours.measured, &truth, &checks::scales(&plan, 0, &truth));
        println!("{} steps: {}", plan.steps(0), checks::show(&errors));
        assert!(worst(&errors).1 < bounds::STEPS_PLAN, "{}", checks::show(&errors));
    }
}
