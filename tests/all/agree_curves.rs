//! Curves there and back: amplitude and phase at every point, and jumps between the same neighbours.
//! Truth: an independent integrator (tests/support/sweeper.rs) that steps slowly through the same points.

use crate::support::follow::Motion;
use crate::support::laws::Law;
use crate::support::sweeper::{Mode, Place, Sweeper};
use afmsweep::control::{self, RunResult};
use afmsweep::engine::{Cpu, Engine, EngineError, Outcome, Progress, on_threads};
use afmsweep::observe::Status;
use afmsweep::orbit;
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};

const SCENE: &str = r#"
title = "there and back"
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
modes = [MODES]
[instrument.tip]
radius = "10 nm"
youngs_modulus = "130 GPa"
poisson_ratio = 0.28
[sample]
youngs_modulus = "2.0 GPa"
poisson_ratio = 0.34
surface_energy = "ENERGY mJ/m^2"
[contact]
law = "LAW"
[drive]
on = "tip"
frequency = "300 kHz"
force = "FORCE nN"
[approach]
gap = "GAP nm"
[curve]
CURVE
direction = "both"
[run]
accuracy = ACCURACY
periods = 3000
[output]
observables = ["amplitude", "phase", "force_max", "force_mean"]
"#;

/// What differs from system to system.
#[derive(Clone, Copy)]
pub struct System {
    pub modes: &'static [Mode],
    pub law: &'static str,
    /// Work of adhesion, mJ/m^2.
    pub energy: f64,
    /// Amplitude of the driving force, nN.
    pub force: f64,
    /// Where the curve is of another quantity, nm.
    pub gap: f64,
    /// The quantity, its unit with its size, and the values from, to and in how many points.
    pub curve: (&'static str, (&'static str, f64), (f64, f64, usize)),
    /// Jumps on both ways together.
    pub jumps: usize,
}

const STIFF: Mode = Mode { stiffness: 26.0, frequency: 300e3, quality: 450.0 };
const SECOND: Mode = Mode { stiffness: 1021.0, frequency: 1.88e6, quality: 600.0 };
pub const DAMPED: Mode = Mode { stiffness: 40.0, frequency: 300e3, quality: 100.0 };
const HARD: Mode = Mode { stiffness: 40.0, frequency: 300e3, quality: 400.0 };
pub const GAP: &str = "approach.gap";
pub const NM: (&str, f64) = ("nm", 1e-9);
pub const KHZ: (&str, f64) = ("kHz", 1e3);

/// 20 nm over a sticky polymer: at first on the attractive branch.
const BISTABLE: System = System {
    modes: &[STIFF],
    law: "dmt",
    energy: 66.0,
    force: 1.156,
    gap: 5.0,
    curve: (GAP, NM, (20.5, 15.5, 21)),
    jumps: 2,
};
/// 30 nm without adhesion, more damping: one branch.
const SMOOTH: System = System {
    modes: &[DAMPED],
    law: "hertz",
    energy: 0.0,
    force: 12.0,
    gap: 5.0,
    curve: (GAP, NM, (31.0, 15.0, 17)),
    jumps: 0,
};
/// Contact that begins and ends at other distances.
const STICKY: System = System {
    modes: &[DAMPED],
    law: "jkr",
    energy: 30.0,
    force: 12.0,
    gap: 5.0,
    curve: (GAP, NM, (31.2, 15.2, 17)),
    jumps: 0,
};
/// The bistable one with the lever's second mode.
const TWO_MODES: System = System { modes: &[STIFF, SECOND], ..BISTABLE };
/// A frequency sweep up and down at a fixed gap: the resonance bends over.
const FREQUENCY: System = System {
    modes: &[HARD],
    law: "dmt",
    energy: 30.0,
    force: 0.8,
    gap: 5.0,
    curve: ("drive.frequency", KHZ, (298.0, 300.0, 41)),
    jumps: 2,
};
impl System {
    pub fn law(&self) -> Law {
        let soft = (1.0 - 0.34f64.powi(2)) / 2.0e9 + (1.0 - 0.28f64.powi(2)) / 130e9;
        let (k, r, w) = (4.0 / 3.0 / soft, 10e-9, 1e-3 * self.energy);
        match self.law {
            "dmt" => Law::Dmt { k, r, w, d0: 0.3e-9 },
            "jkr" => Law::Jkr { k, r, w },
            _ => Law::Hertz { k, r },
        }
    }

    pub fn scene(&self, accuracy: f64) -> Scene {
        let mode = |Mode { stiffness, frequency, quality }: &Mode| {
            format!(
                "{{ stiffness = \"{stiffness} N/m\", frequency = \"{frequency} Hz\", quality_factor = {quality} }}"
            )
        };
        let (path, (unit, _), (from, to, points)) = self.curve;
        let curve = format!(
            "quantity = \"{path}\"\nfrom = \"{from} {unit}\"\nto = \"{to} {unit}\"\npoints = {points}"
        );
        let text = [
            ("MODES", self.modes.iter().map(mode).collect::<Vec<_>>().join(", ")),
            ("GAP", self.gap.to_string()),
            ("ENERGY", self.energy.to_string()),
            ("LAW", self.law.to_owned()),
            ("FORCE", self.force.to_string()),
            ("CURVE", curve),
            ("ACCURACY", accuracy.to_string()),
        ]
        .iter()
        .fold(SCENE.to_owned(), |text, (name, value)| text.replace(name, value));
        Scene::parse(Path::new("curve.toml"), &text).expect("the scene is whole")
    }

    pub fn place(&self, value: f64) -> Place {
        let at = Place { gap: 1e-9 * self.gap, frequency: 300e3, force: 1e-9 * self.force };
        if self.curve.0 == GAP { Place { gap: value, ..at } } else { Place { frequency: value, ..at } }
    }

    /// The integrator's motions in the order of the file: there, then back from the first point on. Beside each the free
    /// amplitude there.
    pub fn truth(&self, values: &[f64]) -> Vec<(Motion, f64)> {
        let free = |value: f64| Sweeper::free(self.modes, self.law(), self.place(value));
        let mut one = free(values[0]);
        one.scale = values.iter().map(|value| free(*value).scale).fold(0.0, f64::max);
        let mut go = |value: &f64| (one.go(self.place(*value)).expect("it settles"), free(*value).scale);
        let mut there: Vec<(Motion, f64)> = values.iter().map(&mut go).collect();
        let back: Vec<(Motion, f64)> = values.iter().rev().map(&mut go).collect();
        there.extend(back.into_iter().rev());
        there
    }
}

pub fn run(scene: &Scene) -> RunResult {
    let plan = Plan::new(scene, Precision::F64).expect("the scene can be planned");
    control::run(&plan, &Cpu::default(), &Progress::default()).expect("it runs")
}

/// Motions farther apart than this share of the free amplitude are of two branches.
pub const BRANCHES: f64 = 0.05;

pub fn agrees(system: System) {
    let mut truth = Vec::new();
    for accuracy in [1e-3, 1e-4] {
        let scene = system.scene(accuracy);
        let values = &scene.sweep.axes[1].values;
        let points = values.len();
        if truth.is_empty() {
            truth = system.truth(values);
        }
        let run = run(&scene);
        let ours = run.results.iter().map(|one| one.measured);
        let ours = ours.map(|one| Motion { amplitude: one.harmonics[0], phase: one.phase });
        let apart: Vec<f64> =
            ours.zip(&truth).map(|(ours, (theirs, free))| ours.apart(theirs) / free).collect();
        let largest = apart.iter().copied().fold(0.0, f64::max);
        let flagged: Vec<(usize, usize)> =
            (0..2 * points).filter(|i| run.jumps[*i]).map(|i| (i / points, i % points)).collect();
        println!("{} points to {accuracy:e}: jumps {flagged:?}, off by {largest:.1e} at most", 2 * points);
        assert!(run.results.iter().all(|one| one.status == Status::Ok));
        assert!(largest < accuracy, "{apart:?}");
        // Where the points agree so do jumps; that the flag tells them is seen by the integrator's large moves.
        let before = |(way, n): (usize, usize)| if way == 0 { n - 1 } else { points + n + 1 };
        let moved = |jump: &(usize, usize)| {
            let (motion, free) = truth[jump.0 * points + jump.1];
            motion.apart(&truth[before(*jump)].0) > BRANCHES * free
        };
        assert!(flagged.iter().all(moved), "{flagged:?}");
        assert_eq!(flagged.len(), system.jumps, "{flagged:?}");
        let differs = |n: &usize| truth[*n].0.apart(&truth[points + n].0) > BRANCHES * truth[*n].1;
        assert_eq!((0..points).any(|n| differs(&n)), system.jumps > 0);
    }
}

#[test]
fn a_bistable_lever_jumps_where_slow_stepping_does() {
    agrees(BISTABLE);
}

#[test]
fn a_smooth_curve_is_that_of_slow_stepping_both_ways() {
    agrees(SMOOTH);
}

#[test]
fn contact_with_a_memory_is_followed_as_slow_stepping_does() {
    agrees(STICKY);
}

#[test]
fn two_modes_jump_where_slow_stepping_does() {
    agrees(TWO_MODES);
}

#[test]
fn a_frequency_sweep_jumps_where_slow_stepping_does() {
    agrees(FREQUENCY);
}

/// A curve's states do not depend on how many threads there are and on what is followed beside it, to the bit.
#[test]
fn a_curve_alone_is_the_same_among_others_and_on_any_number_of_threads() {
    let text = BISTABLE.scene(1e-3).source;
    let swept =
        "[sweep]\n\"sample.youngs_modulus\" = { values = [\"1 GPa\", \"2 GPa\", \"5 GPa\"] }\n[curve]";
    let scene = Scene::parse(Path::new("curves.toml"), &text.replace("[curve]", swept)).expect("it is whole");
    let plan = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
    let begin = |plan: &Plan, threads| {
        let run =
            || orbit::solve_first(&mut plan.clone(), &Cpu::default(), &Progress::default()).expect("it runs");
        on_threads(Some(threads), run).expect("there are threads")
    };
    let (one, three) = (begin(&plan, 1), begin(&plan, 3));
    assert_eq!((&one.found, &one.jumps), (&three.found, &three.jumps));
    assert!(one.jumps.iter().any(|jump| *jump));
    let long = plan.len() as u32 / 3;
    for curve in 0..3 {
        let own: Vec<u32> = (curve * long..(curve + 1) * long).collect();
        let alone = begin(&plan.part(&own), 2);
        let among: Vec<_> = own.iter().map(|i| one.found[*i as usize].clone()).collect();
        assert_eq!(alone.found, among, "curve {curve}");
    }
}

/// The CPU engine, which stops everything after so many runs.
struct Stops<'a> {
    left: AtomicUsize,
    progress: &'a Progress,
}

impl Engine for Stops<'_> {
    fn device(&self) -> String {
        "stops".into()
    }

    fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
        let last = self.left.fetch_sub(1, Ordering::Relaxed) == 1;
        let done = Cpu::default().run(plan, progress)?;
        if last {
            self.progress.stop();
        }
        Ok(done)
    }
}

/// Truth: the run that nobody stops. The points that a stopped one had reached are near those, and called not run.
#[test]
fn points_reached_before_a_stop_are_kept() {
    let plan = Plan::new(&SMOOTH.scene(1e-3), Precision::F64).expect("the scene can be planned");
    let whole = control::run(&plan, &Cpu::default(), &Progress::default()).expect("it runs");
    let mut before = 0;
    for runs in [60, 150] {
        let progress = Progress::default();
        let engine = Stops { left: AtomicUsize::new(runs), progress: &progress };
        let part = control::run(&plan, &engine, &progress).expect("it runs");
        assert!(progress.stopped());
        let mut kept = 0;
        for (one, other) in part.results.iter().zip(whole.results.iter()) {
            assert_eq!(one.status, Status::NotRun);
            if one.measured.is_any() {
                kept += 1;
                let off = (one.measured.harmonics[0] - other.measured.harmonics[0]).abs() / 30e-9;
                assert!(off < 1e-2, "{off:e}");
            }
        }
        println!("{kept} of {} points after {runs} runs", plan.len());
        assert!(kept > before && kept < plan.len(), "{kept} after {runs} runs");
        before = kept;
    }
}

/// A retraction in steps of a picometre with few steps a period: with more of them the branch ends elsewhere.
/// Truth: the same curve at a hundredth of the accuracy, which jumps at another point.
#[test]
fn jumps_that_move_with_the_steps_are_told() {
    let curve = (GAP, NM, (19.0, 19.3, 301));
    let run = |accuracy: f64| {
        let scene = System { curve: (curve.0, curve.1, curve.2), jumps: 1, ..BISTABLE }.scene(accuracy);
        // One way, from the branch on which a tip taps.
        let text =
            scene.source.replace("\"both\"", "\"forward\"").replace("from = \"19 nm\"", "from = \"17.2 nm\"");
        let text = text.replace("points = 301", "points = 2101");
        let scene = Scene::parse(Path::new("moved.toml"), &text).expect("the scene is whole");
        let plan = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
        control::run(&plan, &Cpu::default(), &Progress::default()).expect("it runs")
    };
    let place = |run: &RunResult| run.jumps.iter().position(|jump| *jump).expect("it jumps");
    let (rough, fine) = (run(0.05), run(5e-4));
    println!("jumps at points {} and {}", place(&rough), place(&fine));
    assert_ne!(place(&fine), place(&rough));
    let told = |run: &RunResult| run.notes.iter().any(|note| note.contains("jumps stand at another point"));
    assert!(told(&rough), "{:?}", rough.notes);
}
