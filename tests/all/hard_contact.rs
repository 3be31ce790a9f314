//! Input at the ends of what makes sense: an answer that can be trusted, or a status that says not.

use crate::checks::{self, Twin, bounds, calibrated, one_mode, sample, show, worst};
use afmsweep::observe::{Measured, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{
    ActuatorModel, Adhesion, DriveFrequency, DriveLevel, LawChoice, LeverMode, LeverSpec, Scene, Start,
};
use afmsweep::{Audit, Sweep};
use rayon::prelude::*;
use std::path::Path;

const LAWS: [LawChoice; 3] = [LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr];

type Change = (&'static str, fn(&mut Scene));

fn lever(scene: &mut Scene, change: impl Fn(&mut LeverMode)) {
    if let LeverSpec::Modes(modes) = &mut scene.base.instrument.cantilever.lever {
        modes.iter_mut().for_each(change);
    }
}

fn amplitude(scene: &mut Scene, a0: f64) {
    scene.base.approach.gap *= a0 / 30e-9;
    scene.base.drive.level = DriveLevel::FreeAmplitude(a0);
}

const CHANGES: [Change; 27] = [
    ("nothing special", |_| {}),
    ("gap zero", |s| s.base.approach.gap = 0.0),
    ("gap -5 nm", |s| s.base.approach.gap = -5e-9),
    ("gap -100 nm", |s| s.base.approach.gap = -100e-9),
    ("a graze", |s| s.base.approach.gap = 30e-9 * (1.0 - 1e-6)),
    ("just out of reach", |s| s.base.approach.gap = 30e-9 * (1.0 + 1e-6)),
    ("Q 1e5", |s| lever(s, |m| m.quality_factor = 1e5)),
    ("Q 1e5, run for 1000 periods", |s| {
        lever(s, |m| m.quality_factor = 1e5);
        s.run.periods = 1000;
    }),
    ("Q infinite off resonance", |s| {
        lever(s, |m| m.quality_factor = f64::INFINITY);
        s.base.drive.frequency = DriveFrequency::Hertz(70e3);
    }),
    ("Q 0.4", |s| lever(s, |m| m.quality_factor = 0.4)),
    ("w 1e-9", |s| s.base.sample.adhesion = Adhesion::Work(1e-9)),
    ("w 0", |s| s.base.sample.adhesion = Adhesion::Work(0.0)),
    ("w 1", |s| s.base.sample.adhesion = Adhesion::Work(1.0)),
    ("sample 1 kPa", |s| s.base.sample.youngs_modulus = 1e3),
    ("sample 1 TPa", |s| s.base.sample.youngs_modulus = 1e12),
    ("radius 1 nm", |s| s.base.instrument.tip.radius = 1e-9),
    ("radius 10 um", |s| s.base.instrument.tip.radius = 10e-6),
    ("lever 0.01 N/m", |s| lever(s, |m| m.stiffness = 0.01)),
    ("lever 2000 N/m", |s| lever(s, |m| m.stiffness = 2000.0)),
    ("amplitude 1 pm", |s| amplitude(s, 1e-12)),
    ("amplitude 10 um", |s| amplitude(s, 10e-6)),
    ("drive at a twentieth of resonance", |s| s.base.drive.frequency = DriveFrequency::Hertz(3.75e3)),
    ("drive at twenty times resonance", |s| s.base.drive.frequency = DriveFrequency::Hertz(1.5e6)),
    ("decay length 1 pm", |s| s.base.contact.decay_length = 1e-12),
    ("decay length 1 um", |s| s.base.contact.decay_length = 1e-6),
    ("16 steps a period", |s| s.run.steps_per_period = Some(16)),
    ("accuracy 1e-6", |s| s.run.accuracy = 1e-6),
];

fn finite(m: &Measured) -> bool {
    let values = [
        m.phase,
        m.force_max,
        m.force_min,
        m.force_mean,
        m.contact_time,
        m.dissipation,
        m.virial,
        m.contacts,
    ];
    // No depth where nothing is touched.
    let depth = m.indentation_max.is_finite() || (m.indentation_max.is_nan() && m.contact_time == 0.0);
    depth && values.iter().chain(&m.harmonics).all(|value| value.is_finite())
}

#[test]
fn ok_means_as_accurate_as_asked() {
    let mut scenes = Vec::new();
    for law in LAWS {
        for (name, change) in CHANGES {
            let scene = one_mode(5.0, 75e3, 30.0, 30e-9, 22e-9, |scene| {
                sample(scene, law, 1e9, 0.03, 10e-9);
                scene.run.periods = 400;
                change(scene);
            });
            scenes.push((format!("{law:?}, {name}"), scene));
        }
    }
    // An answer, and where it is ok, the independent integrator's.
    let rows: Vec<_> = scenes
        .par_iter()
        .map(|(name, scene)| {
            let plan = checks::plan(scene, None);
            let result = checks::run(&plan)[0];
            let errors = (result.status == Status::Ok).then(|| {
                let truth = checks::reference(&plan, 0, Twin::Kept);
                checks::errors(&result.measured, &truth, &checks::scales(&plan, 0, &truth))
            });
            (name, plan, result, errors)
        })
        .collect();
    let mut wrong = Vec::new();
    let mut compared = 0;
    for (name, plan, result, errors) in &rows {
        let steps = plan.steps(0);
        let Some(errors) = errors else {
            println!("{name}: {:?}, {steps} steps", result.status);
            continue;
        };
        compared += 1;
        let (which, error) = worst(errors);
        println!("{name}: ok, {steps} steps, off by {error:.1e} ({which})");
        // Who sets the steps himself has asked for those.
        let bound = match plan.run.steps_per_period {
            Some(_) => bounds::SIXTEEN,
            None if name.ends_with("a graze") => bounds::GRAZE,
            None => plan.run.accuracy,
        };
        if error > bound || !finite(&result.measured) {
            wrong.push(format!("{name}, {steps} steps: {}", show(errors)));
        }
    }
    assert!(wrong.is_empty(), "ok and wrong:\n{}", wrong.join("\n"));
    assert!(compared >= 60, "only {compared} of {} are ok", rows.len());
}

/// The same changes to other instruments, from rest and in f32: a status, and numbers if it is ok.
#[test]
fn every_hard_case_has_a_status() {
    let mut scenes: Vec<(String, Scene)> = Vec::new();
    for law in LAWS {
        for (name, change) in CHANGES {
            let put = |scene: &mut Scene| {
                sample(scene, law, 1e9, 0.03, 10e-9);
                scene.run.periods = 120;
                change(scene);
            };
            let one = one_mode(5.0, 75e3, 30.0, 30e-9, 22e-9, |scene| {
                put(scene);
                scene.run.start = Start::Rest;
            });
            let lever = calibrated(5.0, 75e3, 30.0, 30e-9, 22e-9, put);
            // The paper's own, which JKR never lets go, and the same without its rod.
            let paper = |rigid: bool| {
                checks::scene(|scene| {
                    scene.base.contact.law = law;
                    scene.run.start = Start::Rest;
                    (scene.run.periods, scene.run.measure) = (20, 5);
                    if rigid {
                        scene.base.instrument.actuator.model = ActuatorModel::Rigid;
                        scene.base.drive.level = DriveLevel::BaseAmplitude(5e-9);
                    }
                    change(scene);
                })
            };
            for (kind, scene) in
                [("one mode", one), ("lever", lever), ("paper", paper(false)), ("base", paper(true))]
            {
                scenes.push((format!("{kind}, {law:?}, {name}"), scene));
            }
        }
    }
    let rows: Vec<_> = scenes
        .par_iter()
        .map(|(name, scene)| {
            // A drive that this instrument cannot have is refused by the plan, in words.
            let plan = Plan::new(scene, Precision::F32).map_err(|error| error.to_string());
            (name, plan.map(|plan| checks::run(&plan)[0]))
        })
        .collect();
    let mut counts = std::collections::BTreeMap::new();
    for (name, row) in &rows {
        let word = match row {
            Err(error) => {
                assert!(error.contains(": "), "{name}: {error}");
                println!("{name}: {error}");
                "refused"
            }
            Ok(result) => {
                assert!(result.status != Status::NotRun, "{name} was not run");
                assert!(result.status != Status::Ok || finite(&result.measured), "{name}: {result:?}");
                result.status.meaning()
            }
        };
        *counts.entry(word).or_insert(0) += 1;
    }
    println!("{counts:?}");
    assert!(counts["ok"] >= 100, "{counts:?}");
    assert!(counts.get("refused").copied().unwrap_or(0) <= 30, "{counts:?}");
}

/// Truth: a swing that ends at the surface does not press it. Sweeps of the gap often end at the free amplitude.
#[test]
fn a_swing_that_ends_at_the_surface_is_free_of_it() {
    let mut text = include_str!("../../scenes/liquid.toml").to_owned();
    for (from, to) in
        [("to = \"9.5 nm\", points = 12", "to = \"10 nm\", points = 2"), ("[0, 5, 149]", "[0, 5]")]
    {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    let scene = Scene::parse(Path::new("liquid.toml"), &text).unwrap();
    let swept = Sweep::new(scene).audit(Audit::None).run().unwrap();
    let values = |name: &str| swept.results.observable(name).unwrap().values.to_vec();
    let (time, force, depth) = (values("contact_time"), values("force_max"), values("indentation_max"));
    // The gap is the faster axis, the free amplitude its last value.
    let last: Vec<usize> = (0..time.len()).skip(1).step_by(2).collect();
    assert_eq!(last.len(), 13);
    for i in last {
        assert_eq!((time[i], force[i]), (0.0, 0.0), "instance {i}");
        assert!(depth[i].is_nan(), "instance {i}: {:e}", depth[i]);
    }
}
