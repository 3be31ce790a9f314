//! The problem that every solver gets: one calibrated lever of three modes and an ensemble of random samples
//! under one law, with its truth; and the same without units, for those who know nothing of this crate.

use crate::answer::Answer;
use crate::random::Random;
use afmsweep::contact::Law;
use afmsweep::engine::{Engine, Finished, Model, Progress, Reference};
use afmsweep::observe::{Observable, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{LawChoice, Scene, Steady};
use serde::{Deserialize, Serialize};
use std::f64::consts::{FRAC_PI_2, PI};
use std::path::Path;

/// Modes kept.
pub const MODES: usize = 3;
/// Drive periods of a run.
pub const PERIODS: u32 = 200;
/// Laws measured.
pub const LAWS: [Law; 3] = [Law::Hertz, Law::Dmt, Law::Jkr];
/// Tolerance of the reference.
const TOLERANCE: f64 = 1e-13;

/// An ensemble under one law.
pub struct Problem {
    pub name: &'static str,
    pub plan: Plan,
    /// The same, for the periodic states.
    pub searched: Plan,
    pub truth: Vec<Finished>,
    pub reduced: Reduced,
}

/// The equations without units: lengths in free amplitudes, theta the drive's angle, counted from a moment of
/// largest free travel. Tip travel is z = cos(theta) + sum x_k, indentation d = -(gap + z), and
///
/// x_k'' = share_k F(d) - loss_k x_k' - stiffness_k x_k, x_k = x_k' = 0 at first,
///
/// with F = `hertz` d^1.5 in contact; DMT: less `adhesion` there, and -`adhesion`/(1 - d/`decay`)^2 outside; JKR:
/// `pull` (y^6/6 - y^3) with d/`unit` = y^4 - 4y, y >= 1, from d = 0 on approach to d = -3 `unit` on retraction.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Reduced {
    pub law: String,
    pub periods: u32,
    pub measure: u32,
    pub stiffness: [f64; MODES],
    pub loss: [f64; MODES],
    pub share: [f64; MODES],
    pub samples: Vec<Sample>,
    /// Instances that slow solvers take, spread over the ensemble.
    pub few: Vec<usize>,
}

/// One instance of it.
#[derive(Clone, Copy, Debug, Serialize, Deserialize)]
pub struct Sample {
    pub gap: f64,
    pub hertz: f64,
    pub adhesion: f64,
    pub decay: f64,
    pub pull: f64,
    pub unit: f64,
}

/// Random samples from 10 MPa to 10 GPa, tips from 5 to 40 nm, adhesion from 5 to 50 mJ/m^2, a gap from half of the
/// free amplitude to nearly all of it.
fn scene(law: Law, count: usize, seed: u64) -> Scene {
    let mut random = Random(seed);
    let mut lists: [(&str, &str, Vec<f64>); 4] = [
        ("sample.youngs_modulus", "Pa", vec![]),
        ("sample.surface_energy", "J/m^2", vec![]),
        ("instrument.tip.radius", "m", vec![]),
        ("approach.gap", "m", vec![]),
    ];
    for _ in 0..count {
        let values = [
            random.log(10e6, 10e9),
            random.log(5e-3, 50e-3),
            random.log(5e-9, 40e-9),
            20e-9 * (0.5 + 0.45 * random.next()),
        ];
        for ((.., list), value) in lists.iter_mut().zip(values) {
            list.push(value);
        }
    }
    let samples: String = lists
        .iter()
        .map(|(path, unit, list)| {
            let words: Vec<String> = list.iter().map(|value| format!("\"{value:e} {unit}\"")).collect();
            format!("\"{path}\" = [{}]\n", words.join(", "))
        })
        .collect();
    let text = format!(
        r#"
[instrument.cantilever]
stiffness = "40 N/m"
frequency = "300 kHz"
quality_factor = 100
[instrument.actuator]
model = "rigid"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[samples]
{samples}
[run]
periods = {PERIODS}
measure = 10
accuracy = 1e-2
modes = {MODES}
steps_per_period = 256
"#
    );
    let mut scene =
        Scene::parse(Path::new("precision.toml"), &text).unwrap_or_else(|error| panic!("{error}"));
    scene.base.contact.law = match law {
        Law::Hertz => LawChoice::Hertz,
        Law::Dmt => LawChoice::Dmt,
        Law::Jkr => LawChoice::Jkr,
        // Of all laws the other solvers have these.
        _ => LawChoice::None,
    };
    scene.output.observables = vec![Observable::Amplitude, Observable::Phase, Observable::ForceMax];
    if law == Law::Jkr {
        scene.output.observables.push(Observable::Dissipation);
    }
    scene
}

impl Problem {
    /// `count` instances, of which slow solvers take `few`, with their truth by the reference engine.
    pub fn new(law: Law, count: usize, few: usize, seed: u64) -> Self {
        let mut scene = scene(law, count, seed);
        let planned =
            |scene: &Scene| Plan::new(scene, Precision::F64).unwrap_or_else(|error| panic!("{error}"));
        let plan = planned(&scene);
        scene.run.steady = Steady::Search;
        let searched = planned(&scene);
        let reference = Reference { tolerance: TOLERANCE, model: Model::Kept };
        let truth = reference.run(&plan, &Progress::default()).expect("the plan can be run").results;
        let reduced = reduce(law, &plan, few);
        Self { name: name(law), plan, searched, truth, reduced }
    }

    /// Instances whose truth can be used.
    pub fn counted(&self) -> usize {
        self.truth.iter().filter(|one| one.status == Status::Ok).count()
    }

    /// How this problem's answers translate, by instance.
    pub fn measured(&self, instance: usize, answer: &Answer) -> afmsweep::observe::Measured {
        let case = self.plan.case(instance as u32);
        let driven = &self.plan.drives[case.drive as usize];
        let (length, omega) = (driven.free_amplitude(), driven.free.omega);
        let force = length * omega * omega / driven.kept.inverse_mass();
        let phase = FRAC_PI_2 - driven.free.tip.arg();
        // Travel C cos(theta) + S sin(theta), of which the drive's own angle is `phase` ahead.
        let ahead = answer.cosine.atan2(answer.sine) - phase;
        let mut measured = afmsweep::observe::Measured::NONE;
        measured.harmonics[0] = length * answer.cosine.hypot(answer.sine);
        measured.phase = (-ahead.to_degrees()).rem_euclid(360.0);
        measured.force_max = force * answer.force_max;
        measured.dissipation = force * length * answer.loss;
        measured
    }
}

/// `hertz`, `dmt` or `jkr`.
pub fn name(law: Law) -> &'static str {
    law.name()
}

fn reduce(law: Law, plan: &Plan, few: usize) -> Reduced {
    assert_eq!(plan.drives.len(), 1, "one lever and one drive");
    let driven = &plan.drives[0];
    let (length, omega) = (driven.free_amplitude(), driven.free.omega);
    let kept = &driven.kept.modes;
    let inverse_mass = driven.kept.inverse_mass();
    // Acceleration per force, without units.
    let push = inverse_mass / (omega * omega * length);
    let samples: Vec<Sample> = plan
        .cases()
        .map(|case| {
            let contact = &case.contact;
            let jkr = contact.jkr();
            Sample {
                gap: case.gap / length,
                hertz: contact.modulus * contact.radius.sqrt() * length.powf(1.5) * push,
                adhesion: 2.0 * PI * contact.radius * contact.work * push,
                decay: contact.decay_length / length,
                pull: jkr.map_or(0.0, |jkr| jkr.force_scale() * push),
                unit: jkr.map_or(0.0, |jkr| jkr.indentation_scale() / length),
            }
        })
        .collect();
    let every = (samples.len() / few.max(1)).max(1);
    Reduced {
        law: name(law).to_owned(),
        periods: plan.run.periods,
        measure: plan.run.measure,
        stiffness: std::array::from_fn(|k| (kept[k].omega / omega).powi(2)),
        loss: std::array::from_fn(|k| 2.0 * kept[k].damping * kept[k].omega / omega),
        share: std::array::from_fn(|k| kept[k].inverse_mass / inverse_mass),
        few: (0..samples.len()).step_by(every).take(few).collect(),
        samples,
    }
}
