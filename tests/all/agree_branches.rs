//! Second states of a sweep have no holes beside found neighbours.
//! Truth: an independent one-mode integrator (tests/support/follow.rs) whose state is carried from gap to gap, down and
//! up, as an experiment's is.

use crate::support::follow::{Follower, Motion};
use crate::support::laws::Law;
use afmsweep::control::{self, MemoryJournal, RunResult, SecondOrbits};
use afmsweep::engine::{Cpu, Progress, on_threads};
use afmsweep::observe::{Measured, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use std::f64::consts::PI;
use std::path::Path;
use std::time::Instant;

/// A lever in air on polystyrene; `LEVER`, `AMPLITUDES` and `GAPS` stand for what differs.
const SCENE: &str = r#"
title = "amplitude over distance"
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
LEVER
[instrument.tip]
radius = "10 nm"
youngs_modulus = "130 GPa"
poisson_ratio = 0.28
[sample]
youngs_modulus = "2.0 GPa"
poisson_ratio = 0.34
surface_energy = "66 mJ/m^2"
[contact]
law = "dmt"
decay_length = "0.3 nm"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[sweep]
"drive.free_amplitude" = { values = [AMPLITUDES] }
"approach.gap" = { GAPS }
[run]
steady = "search"
branches = "both"
periods = 3000
[output]
observables = ["amplitude", "phase", "force_max", "force_mean"]
"#;

const ONE_MODE: &str = "modes = [{ stiffness = \"26 N/m\", frequency = \"300 kHz\", quality_factor = 450 }]";
const BEAM: &str = "stiffness = \"26 N/m\"\nfrequency = \"300 kHz\"\nquality_factor = 450";

/// The contact's force in the independent program's words, from the scene's numbers.
fn law() -> Law {
    let soft = (1.0 - 0.34f64.powi(2)) / 2.0e9 + (1.0 - 0.28f64.powi(2)) / 130e9;
    Law::Dmt { k: 4.0 / 3.0 / soft, r: 10e-9, w: 66e-3, d0: 0.3e-9 }
}

fn scene(lever: &str, amplitudes: &[f64], gaps: &str) -> Scene {
    let amplitudes: Vec<String> = amplitudes.iter().map(|a| format!("\"{a} nm\"")).collect();
    let text = SCENE.replace("LEVER", lever).replace("AMPLITUDES", &amplitudes.join(", "));
    Scene::parse(Path::new("branches.toml"), &text.replace("GAPS", gaps)).unwrap()
}

fn run(scene: &Scene, threads: usize) -> (RunResult, SecondOrbits) {
    let plan = Plan::new(scene, Precision::F64).unwrap();
    let (engine, progress) = (Cpu::default(), Progress::default());
    let both = || {
        let run = control::run(&plan, &engine, &progress).unwrap();
        let others =
            control::second_orbits(&run, &scene.sweep.shape(), &MemoryJournal::default(), &engine, &progress)
                .unwrap();
        (run, others)
    };
    on_threads(Some(threads), both).unwrap()
}

/// The motions that the independent integrator has at each gap.
struct Followed {
    free: f64,
    gaps: Vec<f64>,
    found: Vec<Vec<Motion>>,
}

impl Followed {
    /// On the way down from the free motion and up again.
    fn there_and_back(free: f64, gaps: &[f64]) -> Self {
        let far = gaps.last().unwrap() + 2e-9;
        let one = Follower::free(26.0, 450.0, free, law(), far);
        let mut all = Self { free, gaps: gaps.to_vec(), found: vec![Vec::new(); gaps.len()] };
        let down = (0..gaps.len()).rev();
        all.go(one, down.chain(0..gaps.len()), false);
        all
    }

    fn knows(&self, n: usize, motion: &Motion) -> bool {
        self.found[n].iter().any(|other| other.apart(motion) < APART * self.free)
    }

    /// Goes through these gaps, until it meets a motion that is known if it is told so.
    fn go(&mut self, mut one: Follower, gaps: impl Iterator<Item = usize>, until_known: bool) {
        for n in gaps {
            let Some(motion) = one.go(self.gaps[n]) else { continue };
            match self.knows(n, &motion) {
                true if until_known => return,
                true => {}
                false => self.found[n].push(motion),
            }
        }
    }

    /// Puts it where a state of the program is; if it stays there, follows it both ways. Gives whether it stays.
    fn goes_on_from(&mut self, n: usize, state: &Motion) -> bool {
        let mut one = Follower::free(26.0, 450.0, self.free, law(), self.gaps[n]);
        one.start(state);
        let stays = one.settle().is_some_and(|end| end.apart(state) < APART * self.free);
        if stays {
            self.found[n].push(*state);
            self.go(one, n + 1..self.gaps.len(), true);
            self.go(one, (0..n).rev(), true);
        }
        stays
    }
}

/// Motions that are nearer, in units of the free amplitude, are one.
const APART: f64 = 0.02;

/// What became of a comparison.
#[derive(Debug, Default)]
struct Tally {
    points: usize,
    /// Points at which the integrator met two motions on its way down and up, at which it has two (those that it did not
    /// meet it was put into, and followed from there), and at which the program has two.
    met: usize,
    theirs: usize,
    ours: usize,
    /// Motions of the integrator that the program does not have.
    holes: Vec<String>,
    /// States of the program in which the integrator does not stay when it is put there.
    doubtful: Vec<String>,
    /// Largest difference of the fundamentals, in units of the free amplitude.
    largest: f64,
    /// Second states whose status is not ok.
    not_ok: usize,
}

fn compare(scene: &Scene, run: &RunResult, others: &SecondOrbits) -> Tally {
    let (amplitudes, gaps) = (&scene.sweep.axes[0].values, &scene.sweep.axes[1].values);
    let motion = |measured: &Measured| Motion { amplitude: measured.harmonics[0], phase: measured.phase };
    let mut tally = Tally::default();
    for (a, &free) in amplitudes.iter().enumerate() {
        let mut followed = Followed::there_and_back(free, gaps);
        let ours = |n: usize| {
            let i = a * gaps.len() + n;
            let first = run.results.get(i);
            let other = others.orbits.iter().find(|other| other.instance as usize == i);
            let second = other.map(|other| motion(&other.finished.measured));
            first.status.is_steady().then(|| motion(&first.measured)).into_iter().chain(second).collect()
        };
        let ours: Vec<Vec<Motion>> = (0..gaps.len()).map(ours).collect();
        let what = |n: usize| format!("{:.0} nm, gap {:.2} nm", 1e9 * free, 1e9 * gaps[n]);
        tally.points += gaps.len();
        tally.met += followed.found.iter().filter(|found| found.len() > 1).count();
        for (n, states) in ours.iter().enumerate() {
            for state in states {
                if !followed.knows(n, state) && !followed.goes_on_from(n, state) {
                    tally.doubtful.push(format!("{}: {state:?}, {:?}", what(n), followed.found[n]));
                }
            }
        }
        for (n, theirs) in followed.found.iter().enumerate() {
            tally.theirs += usize::from(theirs.len() > 1);
            tally.ours += usize::from(ours[n].len() > 1);
            for one in theirs {
                let apart = ours[n].iter().map(|our| our.apart(one)).fold(f64::INFINITY, f64::min) / free;
                match apart < APART {
                    true => tally.largest = tally.largest.max(apart),
                    false => tally.holes.push(format!("{}: {one:?} of {theirs:?}, {:?}", what(n), ours[n])),
                }
            }
        }
    }
    tally.not_ok = others.orbits.iter().filter(|other| other.finished.status != Status::Ok).count();
    tally
}

/// The bistable range of a 20 nm swing: both motions at every gap, and nothing that is not there. With searches from
/// rest alone there were holes.
#[test]
fn a_followed_branch_has_no_holes() {
    let start = Instant::now();
    let scene = scene(ONE_MODE, &[20.0], "from = \"14 nm\", to = \"21 nm\", points = 29");
    let (run, others) = run(&scene, 1);
    let tally = compare(&scene, &run, &others);
    println!("{tally:#?}\n{} tried, {} followed, {:?}", others.tried, others.followed, start.elapsed());
    assert!(tally.theirs >= 5, "the integrator has {} bistable points", tally.theirs);
    assert!(tally.holes.is_empty() && tally.doubtful.is_empty(), "{tally:#?}");
    assert!(tally.largest < 2e-3, "{}", tally.largest);
    assert!(others.followed > 0 && others.followed <= others.tried);
    // As lossless contacts have it: the power of the drive is the lever's own loss.
    for other in &others.orbits {
        let measured = &other.finished.measured;
        let loss = measured.phase.to_radians().sin() / (measured.harmonics[0] / 20e-9);
        assert!((loss - 1.0).abs() < 2e-3, "{loss}");
        assert!((other.multiplier - (-PI / 450.0).exp()).abs() < 1e-3, "{}", other.multiplier);
        assert!(other.estimate < 1e-3 && other.finished.status == Status::Ok, "{other:?}");
    }
}

/// Truth: the grid of the same gaps, in which second states are followed from neighbours. Alone a gap has no neighbour, and in
/// most of this range the search from rest ends in the first state again.
#[test]
fn a_gap_alone_has_the_states_that_it_has_in_a_grid() {
    let (_, all) = run(&scene(ONE_MODE, &[20.0], "from = \"14 nm\", to = \"21 nm\", points = 29"), 1);
    let (mut seconds, mut along_gap) = (0, 0);
    for n in (0..29).step_by(4) {
        let gap = 14.0 + 0.25 * f64::from(n);
        let (_, alone) = run(&scene(ONE_MODE, &[20.0], &format!("values = [\"{gap} nm\"]")), 1);
        let truth = all.orbits.iter().find(|one| one.instance == n);
        assert_eq!(alone.orbits.len(), usize::from(truth.is_some()), "{gap} nm");
        if let (Some(truth), [alone]) = (truth, &alone.orbits[..]) {
            let [ours, theirs] = [alone, truth].map(|one| one.finished.measured.harmonics[0]);
            assert!((ours - theirs).abs() < 1e-3 * 20e-9, "{gap} nm: {ours:e} {theirs:e}");
            seconds += 1;
        }
        along_gap += alone.along_gap;
    }
    println!("{seconds} second states, {along_gap} of them along the gap");
    assert!(seconds >= 2 && along_gap > 0, "{seconds} {along_gap}");
}

/// Waves go by instance numbers: threads change no bit.
#[test]
fn following_does_not_depend_on_threads() {
    let scene = scene(ONE_MODE, &[18.0, 20.0], "from = \"16 nm\", to = \"20 nm\", points = 9");
    let [one, two] = [1, 2].map(|threads| run(&scene, threads).1);
    assert!(one.followed > 0, "{one:?}");
    assert_eq!(format!("{one:?}"), format!("{two:?}"));
}

/// Truth: the same states with a hundredth of the accuracy.
#[test]
fn estimates_of_second_states_are_not_too_low() {
    let scene = scene(BEAM, &[20.0], "from = \"16 nm\", to = \"20 nm\", points = 17");
    let (_, others) = run(&scene, 1);
    let mut fine = scene.clone();
    fine.run.accuracy = 1e-5;
    let (_, truth) = run(&fine, 1);
    assert!(others.orbits.len() >= 5, "{}", others.orbits.len());
    for other in &others.orbits {
        let exact = truth.orbits.iter().find(|one| one.instance == other.instance);
        let exact = exact.unwrap_or_else(|| panic!("no exact second state of {}", other.instance));
        let (ours, theirs) = (&other.finished.measured, &exact.finished.measured);
        let of_length = (ours.harmonics[0] - theirs.harmonics[0]).abs() / 20e-9;
        let of_force =
            (ours.force_max - theirs.force_max).abs() / theirs.force_max.abs().max(-theirs.force_min);
        let error = of_length.max(of_force);
        println!("{}: estimate {:.1e}, error {error:.1e}", other.instance, other.estimate);
        assert!(error < 3.0 * other.estimate.max(1e-5), "{other:?}: {error:e}");
    }
}

/// All of a map: 4 free amplitudes by 167 gaps, as a user swept it.
#[test]
#[ignore = "minutes: 1,336 points of the independent integrator"]
fn a_whole_map_has_no_holes() {
    for lever in [ONE_MODE, BEAM] {
        let scene = scene(lever, &[5.0, 10.0, 20.0, 40.0], "from = \"0.5 nm\", to = \"42 nm\", points = 167");
        let (run, others) = run(&scene, 2);
        let tally = compare(&scene, &run, &others);
        println!("{lever}\n{tally:#?}");
        println!("{} from rest, {} of {} from neighbours", others.from_rest, others.followed, others.tried);
        assert!(tally.holes.is_empty() && tally.doubtful.is_empty(), "{tally:#?}");
    }
}
