//! Forces beside a contact, and forces by numbers. Truth: an independent integrator with their formulas, the laws that a table
//! is made of, and the reference engine.

use crate::checks::{self, Twin, bounds, calibrated, one_mode, sample, worst};
use crate::support::laws::CHARGED_CONE;
use afmsweep::Scene;
use afmsweep::contact::Contact;
use afmsweep::engine::{Engine, Model, Progress, Reference};
use afmsweep::observe::Status;
use afmsweep::scene::{
    DriveFrequency, HydrationStrength, LawChoice, NeckModel, OutsideForce, TipCone, TipShape,
};

const BIAS: OutsideForce =
    OutsideForce::Electrostatic { bias: 4.0, contact_potential: -0.3, cut_off: 0.4e-9, cone: None };
const CONE: OutsideForce = OutsideForce::Electrostatic {
    bias: CHARGED_CONE[0],
    contact_potential: 0.0,
    cut_off: CHARGED_CONE[1],
    cone: Some(TipCone { half_angle: CHARGED_CONE[3], height: CHARGED_CONE[4] }),
};
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
    strength: HydrationStrength::Force(checks::twin_forces::WAVE[0]),
    decay_length: checks::twin_forces::WAVE[1],
    period: Some(checks::twin_forces::WAVE[2]),
    phase: checks::twin_forces::WAVE[3],
};

const NECK: OutsideForce = OutsideForce::Capillary {
    strength: 8e-9,
    forms_at: 1.2e-9,
    breaks_at: 4e-9,
    decay_length: None,
    model: NeckModel::InverseSquare,
};
const BRIDGE: OutsideForce = OutsideForce::Capillary {
    strength: 3e-9,
    forms_at: 0.0,
    breaks_at: 6e-9,
    decay_length: None,
    model: NeckModel::Linear,
};

/// Each force with a law and a shape.
fn contacts() -> Vec<(LawChoice, TipShape, Vec<OutsideForce>)> {
    use LawChoice::{Dmt, Hertz, Jkr};
    use TipShape::{Paraboloid, Sphere, SpheroCone};
    vec![
        (Hertz, Paraboloid, vec![BIAS]),
        (Dmt, Paraboloid, vec![BIAS]),
        (Dmt, Paraboloid, vec![CONE]),
        (Hertz, Paraboloid, vec![LAYER]),
        (Dmt, Sphere, vec![LAYER, WALLS]),
        (Hertz, Paraboloid, vec![WALLS]),
        (Hertz, Paraboloid, vec![WAVES]),
        (Dmt, Paraboloid, vec![BIAS, LAYER, WALLS, WAVES]),
        (Hertz, Paraboloid, vec![NECK]),
        (Dmt, Paraboloid, vec![NECK, LAYER]),
        (Hertz, Sphere, vec![BRIDGE]),
        (Hertz, SpheroCone, vec![NECK]),
        (Jkr, Paraboloid, vec![BIAS]),
        (Jkr, Paraboloid, vec![LAYER, WALLS]),
        (Jkr, Paraboloid, vec![CONE]),
    ]
}

fn cases((law, shape, outside): &(LawChoice, TipShape, Vec<OutsideForce>)) -> Vec<Scene> {
    let mut cases = Vec::new();
    let put = |scene: &mut Scene, modulus: f64| {
        sample(scene, *law, modulus, 0.01, 15e-9);
        scene.base.instrument.tip.shape = *shape;
        scene.base.instrument.tip.half_angle = (*shape == TipShape::SpheroCone).then_some(25.0);
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
            let jumps = contact.0 == LawChoice::Jkr || contact.2.iter().any(OutsideForce::remembers);
            let bound = if jumps { bounds::NECK_FINE } else { bounds::SHAPES_FINE };
            assert!(one.1 < bound, "{contact:?}: {}", checks::show(&errors));
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

/// Energy (J) that one neck takes: the integral of its force from where it forms to where it breaks.
fn taken(force: &OutsideForce) -> f64 {
    let OutsideForce::Capillary { strength, forms_at, breaks_at, model, .. } = *force else {
        return f64::NAN;
    };
    match model {
        NeckModel::InverseSquare => strength * forms_at * (0.5 - 1.0 / (1.0 + breaks_at / forms_at)),
        NeckModel::Linear => strength * (breaks_at - forms_at) * (0.5 - 0.5 * forms_at / breaks_at),
    }
}

/// Truth: the closed forms of a neck's work, however the tip swings.
#[test]
fn each_neck_takes_the_work_of_its_closed_form() {
    for neck in [NECK, BRIDGE] {
        let (mut largest, mut count): (f64, f64) = (0.0, 0.0);
        for scene in cases(&(LawChoice::Hertz, TipShape::Paraboloid, vec![neck])) {
            let ours = checks::one(&scene, None);
            assert_eq!(ours.status, Status::Ok);
            // A gentle swing stays within the neck.
            let truth = ours.measured.contacts * taken(&neck);
            count += ours.measured.contacts;
            largest = largest.max((ours.measured.dissipation - truth).abs() / taken(&neck));
        }
        assert!(count >= 6.0, "{count} necks");
        println!("{neck:?}: off by at most {largest:.1e} of its work at the plan's own steps");
        assert!(largest < bounds::NECK_LOSS, "{largest:e}");
    }
}

/// Truth: the closed form. A neck forms and breaks without contact, and stays where the tip swings within it.
#[test]
fn a_neck_forms_without_contact_and_holds_what_stays_near() {
    let put = |scene: &mut Scene| {
        sample(scene, LawChoice::Hertz, 1e9, 0.01, 15e-9);
        scene.base.contact.outside = vec![NECK];
    };
    let above = checks::one(&one_mode(5.0, 60e3, 20.0, 10e-9, 9.4e-9, put), None);
    let seen = above.measured;
    assert_eq!((above.status, seen.contacts, seen.contact_time), (Status::Ok, 1.0, 0.0), "{seen:?}");
    assert!(seen.indentation_max.is_nan() && seen.force_max <= 0.0, "{seen:?}");
    assert!((seen.dissipation / taken(&NECK) - 1.0).abs() < bounds::NECK_LOSS);
    // Half as wide a swing as the neck is long, from a start within the distance where it forms.
    let within = checks::one(&one_mode(40.0, 60e3, 20.0, 1e-9, 1.5e-9, put), None);
    let seen = within.measured;
    assert_eq!((within.status, seen.contacts), (Status::Ok, 0.0), "{seen:?}");
    assert!(seen.force_mean < -1e-9 && seen.dissipation.abs() < 1e-6 * taken(&NECK), "{seen:?}");
}

/// A table of Hertz's law, with an attraction on the way out that has the shape of a hat from 5 nm away to 0.5 nm deep.
fn loop_table(scene: &Scene) -> (Scene, f64) {
    let contact = Contact::new(&scene.base);
    let (depth, height) = (0.5e-9, 4e-9);
    let hat = |x: f64| {
        let share = (x + 5e-9) / (5e-9 + depth);
        if (0.0..1.0).contains(&share) { -height * (share * (1.0 - share)).powi(2) * 16.0 } else { 0.0 }
    };
    let places: Vec<f64> = (0..=280).map(|n| -10e-9 + 0.05e-9 * f64::from(n)).collect();
    let list = |value: &dyn Fn(f64) -> f64| {
        places.iter().map(|x| format!("\"{:e} N\"", value(*x))).collect::<Vec<_>>().join(", ")
    };
    let there = |x: f64| contact.force(x, x > 0.0);
    let text = format!(
        "[contact]\nlaw = \"table\"\ntable = {{ indentation = [{}], force = [{}], force_retract = [{}] }}\n",
        places.iter().map(|x| format!("\"{x:e} m\"")).collect::<Vec<_>>().join(", "),
        list(&there),
        list(&|x| there(x) + hat(x)),
    );
    let table =
        Scene::parse(std::path::Path::new("loop.toml"), &text).unwrap_or_else(|error| panic!("{error}"));
    let mut scene = scene.clone();
    scene.base.contact = table.base.contact;
    // The integral of (s - s^2)^2 from 0 to 1 is 1/30.
    (scene, height * 16.0 / 30.0 * (5e-9 + depth))
}

/// Truth: the area between the two ways of the table, and the reference engine on the same table.
#[test]
fn a_table_with_a_way_out_loses_the_area_between_its_ways() {
    for (modulus, detuning) in [(300e6, 1.0), (1e9, 0.98)] {
        let scene = one_mode(5.0, 60e3, 20.0, 50e-9, 35e-9, |scene| {
            sample(scene, LawChoice::Hertz, modulus, 0.0, 15e-9);
            scene.base.drive.frequency = DriveFrequency::Hertz(detuning * 60e3);
        });
        let (scene, area) = loop_table(&scene);
        let plan = checks::plan(&scene, None);
        let ours = checks::run(&plan)[0];
        let reference = Reference { tolerance: 1e-12, model: Model::Kept };
        let truth = reference.run(&plan, &Progress::default()).unwrap().results[0];
        assert_eq!((ours.status, truth.status, ours.measured.contacts), (Status::Ok, Status::Ok, 1.0));
        let lost = [ours, truth].map(|one| one.measured.dissipation / area - 1.0);
        let truth = checks::outcome(&truth.measured);
        let errors = checks::errors(&ours.measured, &truth, &checks::scales(&plan, 0, &truth));
        let [own, other] = lost;
        println!(
            "{} steps: loss off by {own:.1e} of the area, the reference's by {other:.1e}; {}",
            plan.steps(0),
            checks::show(&errors)
        );
        assert!(worst(&errors).1 < bounds::STEPS_PLAN, "{}", checks::show(&errors));
        // Between the rows the table's cubics are not the hat.
        assert!(lost.iter().all(|lost| lost.abs() < bounds::LOOP_LOSS), "{lost:?}");
    }
}
