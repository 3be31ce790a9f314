//! Scenes, runs, and the independent integrator set up as the same instrument.

// Each test file uses its own part of this.

pub mod bounds;
pub mod driven_lever;
pub mod energy;
pub mod kernel_case;
pub mod twin_forces;

pub use twin_forces::{force_law, law_word, outside_forces};

use crate::support::oscillator::{Mode, Options, Outcome, State, System};
use afmsweep::engine::{Cpu, Engine, Finished, Progress};
use afmsweep::observe::{Measured, Observable, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{
    ActuatorModel, Adhesion, DriveFrequency, DriveLevel, DriveOn, LawChoice, LeverMode, LeverSpec,
    QualityFactor, Scene, Start,
};
use nalgebra::Complex;
use std::f64::consts::FRAC_PI_2;
use std::path::Path;

/// The preset's scene with every observable, then changed as told.
pub fn scene(change: impl FnOnce(&mut Scene)) -> Scene {
    let mut scene =
        Scene::parse(Path::new("test.toml"), "title = \"test\"\n").expect("the preset is a scene");
    scene.output.observables = Observable::all().collect();
    change(&mut scene);
    scene
}

/// One mode on a base at rest, pushed at the tip at its own frequency to a free amplitude of `a0`.
pub fn one_mode(k: f64, frequency: f64, q: f64, a0: f64, gap: f64, change: impl FnOnce(&mut Scene)) -> Scene {
    scene(|scene| {
        let base = &mut scene.base;
        base.instrument.actuator.model = ActuatorModel::Rigid;
        let mode = LeverMode { stiffness: k, frequency, quality_factor: q, drive: 1.0 };
        base.instrument.cantilever.lever = LeverSpec::Modes(vec![mode]);
        base.drive.on = DriveOn::Tip;
        base.drive.frequency = DriveFrequency::Hertz(frequency);
        base.drive.level = DriveLevel::FreeAmplitude(a0);
        base.approach.gap = gap;
        settle(scene, q);
        change(scene);
    })
}

/// A calibrated lever with beam theory's higher modes, pushed at its tip at resonance.
pub fn calibrated(
    k: f64,
    frequency: f64,
    q: f64,
    a0: f64,
    gap: f64,
    change: impl FnOnce(&mut Scene),
) -> Scene {
    one_mode(k, frequency, q, a0, gap, |scene| {
        let cantilever = &mut scene.base.instrument.cantilever;
        cantilever.lever = LeverSpec::Calibrated { stiffness: k, frequency };
        cantilever.quality_factor = QualityFactor::All(q);
        scene.base.drive.frequency = DriveFrequency::Resonance;
        change(scene);
    })
}

/// Long enough for a change to decay to 1e-10 of itself, and two periods to measure.
pub fn settle(scene: &mut Scene, q: f64) {
    scene.run.start = Start::Steady;
    scene.run.periods = (23.0 * q / std::f64::consts::PI).ceil().max(40.0) as u32;
    scene.run.measure = 2;
}

/// Sample and law; `w` is the work of adhesion, 0.5 the sample's Poisson ratio, the tip rigid.
pub fn sample(scene: &mut Scene, law: LawChoice, modulus: f64, w: f64, radius: f64) {
    let base = &mut scene.base;
    base.contact.law = law;
    base.sample.youngs_modulus = modulus;
    base.sample.poisson_ratio = 0.5;
    base.sample.adhesion = Adhesion::Work(w);
    base.instrument.tip.radius = radius;
}

pub fn plan(scene: &Scene, steps: Option<u32>) -> Plan {
    plan_in(scene, steps, Precision::F64)
}

pub fn plan_in(scene: &Scene, steps: Option<u32>, precision: Precision) -> Plan {
    let mut scene = scene.clone();
    scene.run.steps_per_period = steps.or(scene.run.steps_per_period);
    Plan::new(&scene, precision).expect("the scene can be planned")
}

pub fn run(plan: &Plan) -> Vec<Finished> {
    Cpu::default().run(plan, &Progress::default()).expect("the plan can be run").results
}

/// The first instance at the plan's own steps, or at that many.
pub fn one(scene: &Scene, steps: Option<u32>) -> Finished {
    run(&plan(scene, steps))[0]
}

/// What the independent integrator carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Twin {
    /// The plan's oscillators beside the exact free motion: shows the error of the steps.
    Kept,
    /// The instrument's own modes, driven, up to the highest frequency that the tip shows
    /// (see [`bounds::UNSEEN`]): shows the error of the reduction too.
    Whole,
}

/// The instance as the independent integrator takes it, its start, and by how many degrees its
/// phases lag behind the drive's.
pub fn twin(plan: &Plan, instance: usize, what: Twin) -> (System, State, f64) {
    let case = plan.case(instance as u32);
    let driven = &plan.drives[case.drive as usize];
    let (free, instrument) = (&driven.free, &driven.instrument);
    let law = force_law(plan, instance);
    let system = |modes: Vec<Mode>, base: f64| System { modes, drive: free.omega, base, gap: case.gap, law };
    if what == Twin::Kept {
        assert_eq!(plan.run.start, Start::Steady);
        let modes = driven.kept.modes.iter().map(|mode| Mode {
            omega: mode.omega,
            quality: 0.5 / mode.damping,
            c: 1.0,
            b: mode.inverse_mass,
            g: 0.0,
        });
        let system = system(modes.collect(), free.tip.norm());
        let start = system.state(FRAC_PI_2, vec![0.0; 2 * system.modes.len()]);
        return (system, start, -free.tip.arg().to_degrees());
    }
    let (base, per_level) =
        if instrument.moving_base { (free.level, -free.omega * free.omega) } else { (0.0, 1.0) };
    let rest = plan.run.start == Start::Rest;
    let shares: Vec<f64> = instrument.tip_shares();
    let free_shares: Vec<f64> = instrument
        .modes
        .iter()
        .enumerate()
        .map(|(k, m)| (free.mode(k) * m.tip).norm() / free.tip.norm())
        .collect();
    let seen = |k: usize| shares[k] > bounds::UNSEEN || free_shares[k] > bounds::UNSEEN;
    let kept: Vec<usize> = (0..instrument.modes.len()).filter(|&k| seen(k)).collect();
    let modes = kept.iter().map(|&k| {
        let mode = &instrument.modes[k];
        Mode {
            omega: mode.omega,
            quality: mode.quality_factor,
            c: mode.tip,
            b: mode.force,
            g: mode.drive * free.level * per_level,
        }
    });
    let system = system(modes.collect(), base);
    let start = if rest {
        // A base that moves at once carries its lever, still at rest, backwards relative to itself.
        let kick =
            |k: usize| if instrument.moving_base { instrument.modes[k].drive * free.level } else { 0.0 };
        system.state(0.0, kept.iter().flat_map(|&k| [0.0, kick(k)]).collect())
    } else {
        system.free_at_top()
    };
    (system, start, 0.0)
}

/// The same run by the independent integrator.
pub fn reference(plan: &Plan, instance: usize, what: Twin) -> Outcome {
    let (system, mut state, lag) = twin(plan, instance, what);
    let (periods, measure) = (plan.run.periods as usize, plan.run.measure as usize);
    let options = Options { settle: periods - measure, measure, harmonics: 10, tolerance: 1e-13 };
    let mut out = system.run(&mut state, &options);
    out.phase = (out.phase + lag).rem_euclid(360.0);
    out
}

/// What errors count on: the scale on which `accuracy` counts.
#[derive(Clone, Copy, Debug)]
pub struct Scales {
    /// Free amplitude, m.
    pub length: f64,
    /// Largest force, N.
    pub force: f64,
    /// Work of the drive in a period, with or without the sample, or the loss: the largest, J.
    pub work: f64,
    /// The same or the virial itself, J.
    pub virial: f64,
}

/// An observable's name and its error on its scale.
pub type Errors = Vec<(&'static str, f64)>;

/// Fundamental of the tip's travel, m.
pub fn tip(truth: &Outcome) -> Complex<f64> {
    Complex::from_polar(truth.amplitude, -truth.phase.to_radians())
}

/// The scales of an instance whose true measurements are `truth`.
pub fn scales(plan: &Plan, instance: usize, truth: &Outcome) -> Scales {
    let case = plan.case(instance as u32);
    let driven = &plan.drives[case.drive as usize];
    let length = driven.free_amplitude();
    // A graze shallower than lengths are accurate to has no force to speak of.
    let graze = case.contact.modulus * case.contact.radius.sqrt() * (plan.run.accuracy * length).powf(1.5);
    let force = truth.force_max.abs().max(truth.force_min.abs()).max(graze);
    let work = match plan.run.start {
        // A tip held fast takes next to nothing from its drive (1e-25 J in a case met): there the
        // scale is what the drive does without the sample.
        Start::Steady => energy::drive_work(driven, tip(truth)).abs().max(energy::free_work(driven).abs()),
        // No period is like the next: what the largest force could do over the free swing.
        Start::Rest => force * length,
    };
    let work = work.max(truth.loss.abs());
    Scales { length, force, work, virial: work.max(truth.virial.abs()) }
}

/// Each observable against the independent integrator's.
pub fn errors(measured: &Measured, truth: &Outcome, scales: &Scales) -> Errors {
    let turn = (measured.phase - truth.phase + 180.0).rem_euclid(360.0) - 180.0;
    let force = scales.force;
    let harmonics = measured.harmonics.iter().zip(&truth.harmonics).skip(1);
    let deepest = match (measured.indentation_max.is_nan(), truth.indentation_max.is_nan()) {
        (true, true) => 0.0,
        (false, false) => measured.indentation_max - truth.indentation_max,
        // One of them just misses the sample.
        (true, false) => truth.indentation_max,
        (false, true) => measured.indentation_max,
    };
    let list = [
        ("amplitude", (measured.harmonics[0] - truth.amplitude) / scales.length),
        ("phase", turn.to_radians() * (truth.amplitude / scales.length).min(1.0)),
        ("harmonics", harmonics.map(|(a, b)| (a - b.0).abs()).fold(0.0, f64::max) / scales.length),
        ("force_max", (measured.force_max - truth.force_max) / force),
        ("force_min", (measured.force_min - truth.force_min) / force),
        ("force_mean", (measured.force_mean - truth.force_mean) / force),
        ("indentation_max", deepest / scales.length),
        ("contact_time", measured.contact_time - truth.contact_share),
        ("dissipation", (measured.dissipation - truth.loss) / scales.work),
        ("virial", (measured.virial - truth.virial) / scales.virial),
        ("contacts", measured.contacts - truth.contacts),
    ];
    list.into_iter().map(|(name, error)| (name, error.abs())).collect()
}

/// The largest error, and whose it is; what is no number counts as infinite.
pub fn worst(errors: &Errors) -> (&'static str, f64) {
    let number = |e: f64| if e.is_nan() { f64::INFINITY } else { e };
    errors.iter().fold(("", 0.0), |w, &(name, e)| if number(e) > w.1 { (name, number(e)) } else { w })
}

pub fn show(errors: &Errors) -> String {
    errors.iter().map(|(name, error)| format!("{name} {error:.1e}")).collect::<Vec<_>>().join(", ")
}

/// The engine at the plan's own steps (or as many) against the independent integrator.
pub fn compare(scene: &Scene, steps: Option<u32>, what: Twin) -> (Status, u32, Errors) {
    let plan = plan(scene, steps);
    let truth = reference(&plan, 0, what);
    let finished = run(&plan)[0];
    let scales = scales(&plan, 0, &truth);
    (finished.status, plan.steps(0), errors(&finished.measured, &truth, &scales))
}

/// The engine's own measurements as a truth for coarser ones.
pub fn outcome(m: &Measured) -> Outcome {
    Outcome {
        amplitude: m.harmonics[0],
        phase: m.phase,
        harmonics: m.harmonics.iter().map(|amplitude| (*amplitude, f64::NAN)).collect(),
        force_max: m.force_max,
        force_min: m.force_min,
        force_mean: m.force_mean,
        indentation_max: m.indentation_max,
        contact_share: m.contact_time,
        contacts: m.contacts,
        loss: m.dissipation,
        virial: m.virial,
        ..Outcome::default()
    }
}
