//! Periodic states searched for against periodic states waited for, and against the reference's own.

use crate::checks;
use afmsweep::compare::{Scales, worst};
use afmsweep::control::{self, MemoryJournal};
use afmsweep::engine::{Cpu, Finished, Progress, Reference, solve_near};
use afmsweep::observe::Status;
use afmsweep::orbit::{self, OrbitSolution};
use afmsweep::plan::{BasisRule, Plan};
use afmsweep::scene::{LawChoice, LeverMode, LeverSpec, Scene, Steady};
use std::f64::consts::PI;
use std::path::Path;

fn run(scene: &Scene, way: Steady) -> (Plan, OrbitSolution) {
    let mut scene = scene.clone();
    scene.run.steady = way;
    let plan = checks::plan(&scene, None);
    let settled = orbit::solve(&plan, &[], &Cpu::default(), &Progress::default()).unwrap();
    (plan, settled)
}

fn apart(plan: &Plan, a: &Finished, b: &Finished) -> f64 {
    worst(&plan.observables, &a.measured, &b.measured, &Scales::of(plan, 0, &b.measured))
}

/// Three modes of one lever on soft and stiff samples.
fn tapping(law: LawChoice, quality: f64, modulus: f64, gap: f64) -> Scene {
    checks::one_mode(40.0, 300e3, quality, 20e-9, gap, |scene| {
        let mode =
            |stiffness, frequency| LeverMode { stiffness, frequency, quality_factor: quality, drive: 1.0 };
        scene.base.instrument.cantilever.lever =
            LeverSpec::Modes(vec![mode(40.0, 300e3), mode(1571.0, 1880.1e3), mode(12317.0, 5264.4e3)]);
        checks::sample(scene, law, modulus, 0.03, 10e-9);
        scene.run.measure = 4;
    })
}

/// From a poorer lever's state to a richer one's, and back.
#[test]
fn a_state_found_with_another_lever_leads_to_the_one_found_without() {
    let (engine, progress) = (Cpu::default(), Progress::default());
    for law in [LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr] {
        let scene = checks::calibrated(40.0, 300e3, 80.0, 20e-9, 15e-9, |scene| {
            checks::sample(scene, law, 3e9, 0.03, 10e-9);
            scene.run.steady = Steady::Search;
        });
        let plan = checks::plan(&scene, None);
        let with = |accuracy: f64| plan.with_bases(&[(0, BasisRule::shares(accuracy))]).with_steps(|_| 512);
        let run = |plan: &Plan, near: &OrbitSolution| {
            orbit::solve(plan, &orbit::gather(&near.found, &[0]), &engine, &progress).unwrap()
        };
        let alone = |plan: &Plan| orbit::solve(plan, &[], &engine, &progress).unwrap();
        for (from, to) in [(0.1, 1e-4), (1e-4, 0.1)] {
            let (first, second) = (with(from), with(to));
            let count = |plan: &Plan| plan.driven(0).kept.modes.len();
            assert_ne!(count(&first), count(&second));
            let (near, far) = (run(&second, &alone(&first)), alone(&second));
            let what = format!("{law:?}, {} to {} oscillators", count(&first), count(&second));
            let error = apart(&second, &near.outcome.results[0], &far.outcome.results[0]);
            println!("{what}: {error:.1e} apart, {} periods for {}", near.periods[0], far.periods[0]);
            assert!(near.found[0].is_some() && far.found[0].is_some(), "{what}");
            assert!(error < 0.01 * plan.run.accuracy, "{what}: {error:e}");
            assert!(near.periods[0] < far.periods[0], "{what}: {} {}", near.periods[0], far.periods[0]);
        }
    }
}

/// How far the state that a search finds is from the one that integration ends in, and the periods the search took.
fn search_and_wait(law: LawChoice, quality: f64, modulus: f64, gap: f64) -> (f64, u32) {
    let scene = tapping(law, quality, modulus, gap);
    let (plan, waited) = run(&scene, Steady::Wait);
    let (_, searched) = run(&scene, Steady::Search);
    let what = format!("{law:?}, Q {quality}, {modulus:e} Pa, {gap:e} m");
    let (ours, theirs) = (&searched.outcome.results[0], &waited.outcome.results[0]);
    assert_eq!((ours.status, theirs.status), (Status::Ok, Status::Ok), "{what}");
    assert!(searched.found[0].is_some(), "{what}");
    let error = apart(&plan, ours, theirs);
    assert!(error < 0.3 * plan.run.accuracy, "{what}: {error:e}");
    (error, searched.periods[0])
}

#[test]
fn searching_ends_where_waiting_ends() {
    let mut largest: f64 = 0.0;
    for law in [LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr] {
        for quality in [30.0, 300.0] {
            for modulus in [1e8, 1e9, 1e10] {
                for gap in [10e-9, 16e-9] {
                    let (error, periods) = search_and_wait(law, quality, modulus, gap);
                    largest = largest.max(error);
                    assert!(periods < 800, "{law:?} {quality} {modulus:e} {gap:e}: {periods} periods");
                }
            }
        }
    }
    println!("largest difference {largest:.1e}");
}

/// Levers that ring long are searched for from harmonic balance: the search is short, and ends where integration does.
#[test]
fn harmonic_balance_leads_to_where_waiting_ends() {
    let (mut largest, mut most) = (0.0f64, 0);
    for law in [LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr] {
        for quality in [1000.0, 3000.0] {
            for (modulus, gap) in [(1e9, 10e-9), (1e9, 16e-9), (1e10, 16e-9)] {
                let (error, periods) = search_and_wait(law, quality, modulus, gap);
                (largest, most) = (largest.max(error), most.max(periods));
                assert!(periods < 100, "{law:?} {quality} {modulus:e} {gap:e}: {periods} periods");
            }
        }
    }
    println!("largest difference {largest:.1e}, at most {most} periods");
}

/// The contact force of Hertz and DMT gives and takes no energy, so the period map of one mode shrinks areas by the
/// damping alone: two complex multipliers have the modulus exp(-pi/Q) (Liouville).
#[test]
fn multipliers_of_one_mode_are_liouvilles() {
    for law in [LawChoice::Hertz, LawChoice::Dmt] {
        for quality in [30.0, 300.0, 3000.0] {
            let scene = checks::one_mode(40.0, 300e3, quality, 20e-9, 16e-9, |scene| {
                checks::sample(scene, law, 1e9, 0.03, 10e-9);
                scene.run.measure = 4;
            });
            let (_, settled) = run(&scene, Steady::Search);
            let found = settled.found[0].as_ref().unwrap_or_else(|| panic!("{law:?} {quality}: none"));
            let exact = (-PI / quality).exp();
            let off = (found.floquet.multiplier - exact).abs();
            println!("{law:?}, Q {quality}: {:.7}, exact {exact:.7}", found.floquet.multiplier);
            assert!(off < 2e-5, "{law:?} {quality}: {} {exact}", found.floquet.multiplier);
        }
    }
}

/// Waiting takes a hundred thousand times the quality factor's share; searching does not care.
#[test]
fn the_cost_does_not_grow_with_the_quality_factor() {
    let mut costs = Vec::new();
    for quality in [1e2, 1e3, 1e4, 1e5] {
        let (_, settled) = run(&tapping(LawChoice::Dmt, quality, 1e9, 14e-9), Steady::Search);
        assert_eq!(settled.outcome.results[0].status, Status::Ok, "{quality}");
        assert!(settled.found[0].is_some(), "{quality}");
        costs.push(settled.periods[0]);
    }
    println!("{costs:?} periods");
    assert!(costs.iter().all(|count| *count < 800), "{costs:?}");
}

/// A contact that rings on without a steady state (tests/hard/jkr_edge_between.toml) is waited for, and says so.
#[test]
fn what_has_no_periodic_state_is_waited_for() {
    let scene = Scene::load(Path::new("tests/hard/jkr_edge_between.toml")).unwrap();
    let (plan, settled) = run(&scene, Steady::Search);
    assert!(settled.found[0].is_none());
    assert_eq!(settled.outcome.results[0].status, Status::NotSteady);
    assert!(settled.periods[0] >= plan.run.periods);
}

/// The waits before searches are 3, 32 and 128 periods, one after the other; none may pass the periods of the run, which would
/// then have a negative number of periods left.
#[test]
fn waits_before_searches_end_with_the_run() {
    let mut scene = Scene::load(Path::new("tests/hard/jkr_edge_between.toml")).unwrap();
    for periods in [33, 140, 163] {
        scene.run.periods = periods;
        let (_, settled) = run(&scene, Steady::Search);
        assert_eq!(settled.outcome.results[0].status, Status::NotSteady, "{periods}");
        assert!(settled.periods[0] < 1000, "{periods}: {}", settled.periods[0]);
    }
}

/// Bounds on the distance of two engines' states: see tests/all/agree_reference.rs for the steps' part.
#[test]
fn the_references_own_state_is_next_to_the_one_found() {
    for law in [LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr] {
        let mut scene = tapping(law, 300.0, 1e9, 14e-9);
        scene.run.steady = Steady::Search;
        let plan = checks::plan(&scene, Some(1024));
        let settled = orbit::solve(&plan, &[], &Cpu::default(), &Progress::default()).unwrap();
        let found = settled.found[0].as_ref().expect("a state");
        let (reference, progress) = (Reference::default(), Progress::default());
        let near = solve_near(&plan, 0, &found.section, &reference, &progress).unwrap().expect("a state");
        let error = apart(&plan, &settled.outcome.results[0], &near);
        println!("{law:?}: {error:.1e}");
        assert!(error < 1e-4, "{law:?}: {error:e}");
        // And it is where the reference's own waiting ends.
        if law == LawChoice::Dmt {
            let waited =
                afmsweep::engine::solve(&checks::plan(&tapping(law, 300.0, 1e9, 14e-9), None), 0, &reference);
            let error = apart(&plan, &near, &waited.unwrap().0);
            assert!(error < 1e-6, "{error:e}");
        }
    }
}

/// One tapping point, two states: tests/hard/branch_repulsive.toml waits from the free swing, branch_attractive.toml
/// from rest.
#[test]
fn both_branches_are_those_that_two_starts_end_on() {
    let load = |name: &str| Scene::load(Path::new("tests/hard").join(name).as_path()).unwrap();
    let mut scene = load("branch_repulsive.toml");
    (scene.run.steady, scene.run.both_branches) = (Steady::Search, true);
    let plan = checks::plan(&scene, None);
    let (engine, progress) = (Cpu::default(), Progress::default());
    let run = control::run(&plan, &engine, &progress).unwrap();
    let others =
        control::second_orbits(&run, &[], &MemoryJournal::default(), &engine, &progress).unwrap().orbits;
    assert_eq!(others.len(), 1);
    let wait = |name: &str| {
        let plan = checks::plan(&load(name), None);
        control::run(&plan, &engine, &progress).unwrap().results.get(0)
    };
    for (ours, theirs) in [
        (run.results.get(0), wait("branch_repulsive.toml")),
        (others[0].finished, wait("branch_attractive.toml")),
    ] {
        let error = apart(&plan, &ours, &theirs);
        println!(
            "phase {:.2}, mean force {:.2e} N: {error:.1e}",
            ours.measured.phase, ours.measured.force_mean
        );
        assert!(error < 2.0 * plan.run.accuracy, "{error:e}");
    }
    assert!(others[0].finished.measured.force_mean < 0.0 && run.results.get(0).measured.force_mean > 0.0);
    assert!(others[0].multiplier < 1.0);
}

/// A run that is asked to wait far longer than it takes stops when it has settled, within the accuracy.
#[test]
fn waiting_ends_when_an_instance_has_settled() {
    let mut scene = tapping(LawChoice::Hertz, 30.0, 1e9, 14e-9);
    let (plan, short) = run(&scene, Steady::Wait);
    scene.run.periods = 100_000;
    let (_, long) = run(&scene, Steady::Wait);
    assert_eq!(long.outcome.results[0].status, Status::Ok);
    assert!(long.periods[0] < 400, "{} periods", long.periods[0]);
    let error = apart(&plan, &long.outcome.results[0], &short.outcome.results[0]);
    assert!(error < 0.3 * plan.run.accuracy, "{error:e}");
}

/// Tapping with the paper's lever on this sample, waited for over so many periods or searched for.
fn soft_tapping(quality: u32, periods: u32, [work, modulus, radius]: [f64; 3]) -> Scene {
    let text = format!(
        r#"
        [instrument]
        preset = "ha-fung-chen-2005"
        [instrument.actuator]
        quality_factor = 100
        [instrument.cantilever]
        quality_factor = {quality}
        [instrument.tip]
        radius = "{radius:e} m"
        youngs_modulus = "130 GPa"
        poisson_ratio = 0.28
        [sample]
        youngs_modulus = "{modulus:e} Pa"
        poisson_ratio = 0.3
        surface_energy = "{work:e} J/m^2"
        [contact]
        law = "dmt"
        decay_length = "0.3 nm"
        [drive]
        frequency = "resonance"
        free_amplitude = "20 nm"
        [approach]
        gap = "17 nm"
        [run]
        periods = {periods}
        steady = "search"
        accuracy = 1e-3
        [output]
        observables = ["amplitude", "phase"]
    "#
    );
    Scene::parse(Path::new("late.toml"), &text).unwrap()
}

/// Three searches from the free oscillation find nothing: the lever leaves the repulsive branch, whose end is near, in a swing
/// of some thousand periods. Waiting for many more has the truth. What such a swing takes by strides does not grow with the
/// quality factor.
#[test]
fn what_settles_late_is_found_where_waiting_ends() {
    let near = [0.011_937_766_417_144_36, 1e8, 35.218_330_738_213_1e-9];
    for (quality, periods, sample) in [
        (1000, 20_000, [0.014_384_498_882_876_6, 1e8, 30.844_216_508_158_8e-9]),
        (10_000, 200_000, near),
        (100_000, 1_000_000, near),
    ] {
        let scene = soft_tapping(quality, periods, sample);
        let (plan, searched) = run(&scene, Steady::Search);
        let (_, waited) = run(&scene, Steady::Wait);
        let (ours, truth) = (&searched.outcome.results[0], &waited.outcome.results[0]);
        assert_eq!((ours.status, truth.status), (Status::Ok, Status::Ok));
        assert!(searched.state(0).is_some() && searched.periods[0] < 1500, "{}", searched.periods[0]);
        let error = apart(&plan, ours, truth);
        println!("Q {quality}: {error:.1e} apart after {} periods", searched.periods[0]);
        assert!(error < 0.1 * plan.run.accuracy, "{error:e}");
    }
}
