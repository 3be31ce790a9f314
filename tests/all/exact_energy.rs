//! Energy: the loss of a JKR contact cycle in closed form, no loss in laws without memory, and the
//! drive's work against the losses of lever and sample.

use crate::checks;
use crate::checks::energy::{balance, drive_work, free_work};
use crate::checks::{bounds, calibrated, one_mode, sample};
use afmsweep::observe::{Measured, Status};
use afmsweep::plan::Plan;
use afmsweep::scene::{
    ActuatorModel, DriveFrequency, DriveLevel, LawChoice, QualityFactor, Scene, Start, SweptAxes,
};
use rayon::prelude::*;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

#[test]
fn jkr_loss_per_tap() {
    let mut scenes = Vec::new();
    for modulus in [30e6, 300e6, 3e9] {
        for radius in [10e-9, 30e-9] {
            for gap in [0.5, 0.7, 0.85, 0.95] {
                scenes.push(one_mode(5.0, 75e3, 150.0, 60e-9, gap * 60e-9, |scene| {
                    sample(scene, LawChoice::Jkr, modulus, 0.05, radius);
                    scene.run.periods = 900;
                    scene.run.measure = 20;
                }));
            }
        }
    }
    let rows: Vec<_> = scenes
        .par_iter()
        .map(|scene| {
            let plan = checks::plan(scene, None);
            (checks::run(&plan)[0], plan)
        })
        .collect();
    let mut taps = 0;
    for (result, plan) in &rows {
        let contact = plan.contact(0);
        let (k, r, w) = (contact.modulus, contact.radius, contact.work);
        let area = 1.2749410291014 * PI * w * r * ((PI * w / k).powi(2) * r).cbrt();
        let m = result.measured;
        let error = (m.dissipation / area - 1.0).abs();
        println!(
            "K {k:.2e}, R {r:.0e}, gap {:.1e}, {} steps, {:?}, {} contacts a period: loss off by {error:.1e}",
            plan.case(0).gap,
            plan.steps(0),
            result.status,
            m.contacts
        );
        if result.status == Status::Ok && m.contacts == 1.0 {
            taps += 1;
            assert!(error <= bounds::JKR_LOSS, "loss off by {error:e}");
        }
    }
    assert!(taps >= 20, "only {taps} of {} cases tap once a period", rows.len());
}

/// Measured loss, and what the drive gives less what the modes take, in units of the drive's work.
struct Account {
    loss: f64,
    /// Drive less modes less loss; none where rod and lever do not answer each other.
    whole: Option<f64>,
    /// The same from the motion beside the free one, for any instrument.
    beside: f64,
    /// The drive's work by the tip's fundamental less that by the force.
    drive: f64,
}

fn account(plan: &Plan, measured: &Measured) -> Account {
    let loss = measured.dissipation;
    let driven = &plan.drives[0];
    let books = balance(plan, 0);
    let unit = books.drive.abs().max(free_work(driven).abs()).max(loss.abs());
    // One-way coupling: what pushes a mode and what it moves differ.
    let modes = &driven.instrument.modes;
    let mutual = modes.iter().all(|mode| (mode.tip - mode.force).abs() <= 1e-9 * mode.tip.abs());
    Account {
        loss: loss / unit,
        whole: mutual.then_some((books.drive - books.modes - loss) / unit),
        beside: (books.taken - books.excited - loss) / unit,
        drive: (drive_work(driven, checks::tip(&checks::outcome(measured))) - books.drive) / unit,
    }
}

/// Checks a steady scene of one instance; false if its status is not ok.
fn books_balance(name: &str, scene: &Scene) -> bool {
    let plan = checks::plan(scene, None);
    let result = checks::run(&plan)[0];
    if result.status != Status::Ok {
        println!("{name}: {:?}", result.status);
        return false;
    }
    let Account { loss, whole, beside, drive } = account(&plan, &result.measured);
    println!(
        "{name}, {} steps, {:.2} contacts a period: loss {loss:.3e} of the drive's work, books off by {whole:?}, {beside:.1e} and {drive:.1e}",
        plan.steps(0),
        result.measured.contacts
    );
    assert!(whole.unwrap_or(0.0).abs() <= bounds::BOOKS, "{name}: drive less modes less sample {whole:?}");
    assert!(beside.abs() <= bounds::BOOKS, "{name}: beside the free motion {beside:e}");
    assert!(drive.abs() <= bounds::BOOKS, "{name}: the drive's work by the fundamental {drive:e}");
    match plan.contact(0).law.has_hysteresis() {
        true => assert!(loss >= -bounds::NO_LOSS, "{name}: a law that remembers gains {loss:e}"),
        false => assert!(loss.abs() <= bounds::NO_LOSS, "{name}: a law without memory loses {loss:e}"),
    }
    true
}

/// Changes left after the run: 1e-9 of the first.
fn long_enough(scene: &mut Scene) {
    let plan = checks::plan(scene, None);
    let driven = &plan.drives[0];
    let slowest =
        driven.kept.modes.iter().map(|mode| mode.damping * mode.omega).fold(f64::INFINITY, f64::min);
    let periods = 20.0 * driven.free.omega / (2.0 * PI * slowest);
    if periods < 1e4 {
        scene.run.periods = scene.run.periods.max(periods as u32);
    }
    scene.run.measure = scene.run.measure.min(10);
}

#[test]
fn books_balance_for_every_kind_of_instrument() {
    for law in [LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr] {
        let put = |scene: &mut Scene| {
            sample(scene, law, 1e9, 0.03, 10e-9);
            scene.base.contact.decay_length = 0.3e-9;
        };
        let rod = |model: ActuatorModel, frequency: DriveFrequency, level: DriveLevel| {
            checks::scene(|scene| {
                scene.base.instrument.actuator.model = model;
                scene.base.instrument.actuator.quality_factor = 100.0;
                scene.base.instrument.cantilever.quality_factor = QualityFactor::All(100.0);
                scene.base.drive.frequency = frequency;
                scene.base.drive.level = level;
                scene.base.approach.gap = 12e-9;
                put(scene);
            })
        };
        let free = DriveLevel::FreeAmplitude(20e-9);
        let resonance = DriveFrequency::Resonance;
        let scenes = [
            ("one mode", one_mode(10.0, 75e3, 100.0, 30e-9, 22e-9, put)),
            ("one mode below resonance", {
                let mut scene = one_mode(10.0, 75e3, 30.0, 30e-9, 22e-9, put);
                scene.base.drive.frequency = DriveFrequency::Hertz(73e3);
                scene
            }),
            ("calibrated lever", calibrated(10.0, 75e3, 100.0, 30e-9, 22e-9, put)),
            ("coupled, by voltage", rod(ActuatorModel::Coupled, resonance, DriveLevel::Voltage(5.0))),
            ("prescribed", rod(ActuatorModel::Prescribed, resonance, free)),
            ("moving base", rod(ActuatorModel::Rigid, resonance, free)),
        ];
        for (name, mut scene) in scenes {
            long_enough(&mut scene);
            assert!(books_balance(&format!("{name}, {law:?}"), &scene), "{name}, {law:?} is not ok");
        }
    }
}

/// A drive far below the resonance hardly works: what a plan leaves out is the larger a share of its work. Such a scene is
/// planned finer, which must lessen it.
fn far_from_resonance(scene: &mut Scene) {
    let plan = checks::plan(scene, None);
    let driven = &plan.drives[0];
    if driven.free.omega < PI * driven.instrument.lever_frequency {
        scene.run.accuracy /= 10.0;
    }
}

/// Every steady scene there is, a handful of instances of each.
#[test]
fn books_balance_for_every_steady_scene_file() {
    let mut files: Vec<PathBuf> = ["scenes", "tests/scenes/steady"]
        .iter()
        .filter_map(|folder| std::fs::read_dir(Path::new(folder)).ok())
        .flat_map(|entries| entries.filter_map(|entry| Some(entry.ok()?.path())))
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    files.sort();
    assert!(files.len() >= 2, "the scenes have gone");
    for file in files {
        let name = file.display();
        let scene = Scene::load(&file).unwrap_or_else(|error| panic!("{name}: {error}"));
        // A set-point is held by a search, whose gap is not known here (tests/all/agree_setpoint.rs).
        if scene.run.start != Start::Steady || scene.base.approach.held.is_some() {
            println!("{name}: not steady, or its gap is a result");
            continue;
        }
        let count = scene.len();
        // Three, spread over the sweep by the golden ratio.
        let some: Vec<usize> = if count <= 3 {
            (0..count).collect()
        } else {
            (1..=3).map(|i| ((f64::from(i) * 0.618_034).fract() * count as f64) as usize).collect()
        };
        let ok = some
            .iter()
            .filter(|&&instance| {
                let mut one = scene.clone();
                one.base = scene.instance(instance);
                one.sweep = SweptAxes::default();
                one.output.observables = afmsweep::observe::Observable::all().collect();
                far_from_resonance(&mut one);
                long_enough(&mut one);
                books_balance(&format!("{name} [{instance}]"), &one)
            })
            .count();
        assert!(ok > 0, "{name}: no instance of {some:?} is ok");
    }
}
