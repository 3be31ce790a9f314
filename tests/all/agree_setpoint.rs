//! Set-points: what is held, where, and on which branch. Truth: closed forms of tapping that loses nothing, static
//! equilibrium for slow motion, and an independent integrator (tests/support/sweeper.rs) that brings the sample slowly
//! nearer.

use crate::support::laws::Law;
use crate::support::sweeper::{Mode, Place, Sweeper};
use afmsweep::control::{self, RunResult};
use afmsweep::engine::{Cpu, Finished, Progress, on_threads};
use afmsweep::observe::Status;
use afmsweep::orbit;
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::{Held, Scene};
use std::path::Path;

const TAPPING: &str = r#"
[instrument.cantilever]
modes = [{ stiffness = "26 N/m", frequency = "300 kHz", quality_factor = 450 }]
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
[drive]
on = "tip"
frequency = "300 kHz"
[approach]
WHERE
[sweep]
SWEPT
[output]
observables = ["amplitude", "phase", "force_max", "force_mean", "indentation_max"]
"#;

pub(crate) fn parse(text: &str) -> Scene {
    Scene::parse(Path::new("held.toml"), text).expect("the scene is whole")
}

fn tapping(wanted: &str, swept: &str) -> Scene {
    parse(&TAPPING.replace("WHERE", wanted).replace("SWEPT", swept))
}

pub(crate) fn run(scene: &Scene) -> RunResult {
    let plan = Plan::new(scene, Precision::F64).expect("the scene can be planned");
    control::run(&plan, &Cpu::default(), &Progress::default()).expect("it runs")
}

const GRID: &str = r#"
"drive.free_amplitude" = { values = ["5 nm", "20 nm", "40 nm"] }
"approach.setpoint" = { values = [0.3, 0.6, 0.8, 0.95] }
"#;

/// Nothing is lost under DMT, so the drive's work is the lever's: at its frequency the sine of the phase is the share of
/// the amplitude that is left (Cleveland et al., Appl. Phys. Lett. 72 (1998) 2613, eq. 3), on either branch.
#[test]
fn held_amplitudes_have_the_phases_of_the_power_balance() {
    for branch in ["", "setpoint_branch = \"attractive\"", "setpoint_branch = \"repulsive\""] {
        let scene = tapping(branch, GRID);
        let ran = run(&scene);
        let mut branches = [0, 0];
        for (i, one) in ran.results.iter().enumerate() {
            let case = scene.instance(i);
            let Some(Held::Amplitude(share)) = case.approach.held else { panic!("{:?}", case.approach) };
            let free = ran.plan.driven(i as u32).free_amplitude();
            let measured = &one.measured;
            assert_eq!(one.status, Status::Ok, "instance {i}");
            assert!((measured.harmonics[0] / free - share).abs() < 1e-3 * 0.06, "instance {i}");
            assert_eq!(measured.gap, ran.plan.case(i as u32).gap);
            let repulsive = measured.force_mean > 0.0;
            branches[usize::from(repulsive)] += 1;
            let lag = share.asin();
            let expected = if repulsive { lag } else { std::f64::consts::PI - lag };
            let off = share * (measured.phase.to_radians() - expected).abs();
            assert!(off < 1e-3, "instance {i}: {} for {}", measured.phase, expected.to_degrees());
        }
        // 5 nm never leave the attractive branch by themselves; asked for, the other is there for some.
        println!("{branch:?}: attractive {}, repulsive {}", branches[0], branches[1]);
        assert!(branches[0] > 0 && branches[1] >= 6, "{branches:?}");
        if branch.ends_with("\"repulsive\"") {
            assert!(branches[1] >= 9, "{branches:?}");
        }
    }
}

/// The integrator brings the sample from far away over the gaps found, in 40 steps to the nearest, and is at each where the run
/// says.
#[test]
fn held_states_are_those_that_a_slow_approach_meets() {
    let soft = (1.0 - 0.34f64.powi(2)) / 2.0e9 + (1.0 - 0.28f64.powi(2)) / 130e9;
    let (k, r, w) = (4.0 / 3.0 / soft, 10e-9, 66e-3);
    let mode = Mode { stiffness: 26.0, frequency: 300e3, quality: 450.0 };
    for (name, law) in [("dmt", Law::Dmt { k, r, w, d0: 0.3e-9 }), ("jkr", Law::Jkr { k, r, w })] {
        let swept = r#"
            "drive.free_amplitude" = { values = ["20 nm"] }
            "approach.setpoint" = { values = [0.96, 0.9, 0.7] }
        "#;
        let scene = parse(
            &TAPPING.replace("WHERE", "").replace("SWEPT", swept).replace("\"dmt\"", &format!("\"{name}\"")),
        );
        let ran = run(&scene);
        let force = 20e-9 * 26.0 / 450.0;
        let at = |gap: f64| Place { gap, frequency: 300e3, force };
        let far = 23e-9;
        let mut held: Vec<(usize, Finished)> = ran.results.iter().enumerate().collect();
        held.sort_by(|(_, one), (_, other)| other.measured.gap.total_cmp(&one.measured.gap));
        let stride = (far - held[2].1.measured.gap) / 40.0;
        let (mut sweeper, mut here) = (Sweeper::free(&[mode], law, at(far)), far);
        for (i, one) in held {
            assert_eq!(one.status, Status::Ok, "{name}, instance {i}");
            let gap = one.measured.gap;
            let steps = ((here - gap) / stride).ceil() as u32;
            for step in 1..steps {
                sweeper.go(at(here + (gap - here) * f64::from(step) / f64::from(steps)));
            }
            here = gap;
            let motion = sweeper.go(at(gap)).expect("it settles");
            let off = (motion.amplitude - one.measured.harmonics[0]).abs() / 20e-9;
            println!("{name} {i}: gap {:.4} nm, off {off:.1e}", 1e9 * gap);
            assert!(off < 1e-3, "{name}, instance {i}: {} {}", motion.amplitude, one.measured.harmonics[0]);
        }
    }
}

/// At a hundredth of the lever's frequency it rests on the sample: the base comes nearer by what the sample gives way,
/// the lever bends and the gap leaves.
#[test]
fn held_forces_of_slow_motion_are_in_static_equilibrium() {
    let text = r#"
        [instrument.cantilever]
        modes = [{ stiffness = "2 N/m", frequency = "200 kHz", quality_factor = 10 }]
        [instrument.tip]
        radius = "20 nm"
        [sample]
        youngs_modulus = "300 MPa"
        poisson_ratio = 0.4
        [contact]
        law = "hertz"
        [drive]
        frequency = "2 kHz"
        free_amplitude = "50 nm"
        [sweep]
        "approach.force_setpoint" = { values = ["2 nN", "10 nN", "40 nN"] }
        [output]
        observables = ["force_max", "indentation_max"]
    "#;
    let ran = run(&parse(text));
    let modulus = 300e6 / (1.0 - 0.4f64.powi(2));
    for (one, force) in ran.results.iter().zip([2e-9, 10e-9, 40e-9]) {
        assert_eq!(one.status, Status::Ok);
        assert!((one.measured.force_max / force - 1.0).abs() < 1e-3 * 0.06, "{}", one.measured.force_max);
        let depth = (0.75 * force / modulus / 20e-9f64.sqrt()).powf(2.0 / 3.0);
        let gap = 50e-9 - depth - force / 2.0;
        assert!((one.measured.indentation_max / depth - 1.0).abs() < 1e-3);
        assert!((one.measured.gap - gap).abs() < 2e-3 * 50e-9, "{} {gap}", one.measured.gap);
    }
}

/// A lever that feels nothing holds nothing.
#[test]
fn no_sample_holds_no_set_point() {
    let scene = parse(
        &TAPPING
            .replace("\"dmt\"", "\"none\"")
            .replace("WHERE", "setpoint = 0.8")
            .replace("SWEPT", "\"drive.free_amplitude\" = { values = [\"5 nm\", \"20 nm\"] }"),
    );
    let plan = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
    let ran = control::run(&plan, &Cpu::default(), &Progress::default()).expect("it runs");
    for one in ran.results.iter() {
        assert_eq!(one.status, Status::NoSetpoint);
        assert!(one.measured.harmonics[0].is_nan());
    }
}

/// The same bits on one thread and on three, and for one instance alone.
#[test]
fn held_states_do_not_depend_on_threads_or_neighbours() {
    let scene = tapping("", GRID);
    let plan = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
    let begin = |plan: &Plan| {
        let mut plan = plan.clone();
        let settled = orbit::solve_first(&mut plan, &Cpu::default(), &Progress::default()).expect("it runs");
        let all = settled.outcome.results.into_iter().map(|one| format!("{one:?}"));
        all.collect::<Vec<_>>()
    };
    let whole = begin(&plan);
    let few = on_threads(Some(1), || begin(&plan)).expect("a thread");
    let many = on_threads(Some(3), || begin(&plan)).expect("threads");
    assert!(whole == few && whole == many);
    for i in [0, 5, 7, 11] {
        assert_eq!(begin(&plan.part(&[i]))[0], whole[i as usize], "instance {i}");
    }
}

/// JKR lets go so abruptly that no search meets some gaps of a branch, where waiting does: strides there went back and forth
/// over the set-point for ever. Truth: the amplitude that is asked for.
#[test]
fn set_points_that_only_waiting_passes_are_held() {
    let text = TAPPING
        .replace(
            "modes = [{ stiffness = \"26 N/m\", frequency = \"300 kHz\", quality_factor = 450 }]",
            "stiffness = \"26 N/m\"\nfrequency = \"300 kHz\"\nquality_factor = 450",
        )
        .replace(
            "frequency = \"300 kHz\"\n[approach]",
            "frequency = \"resonance\"\nfree_amplitude = \"10 nm\"\n[approach]",
        )
        .replace("dmt", "jkr")
        .replace("WHERE", "setpoint_branch = \"repulsive\"")
        .replace("SWEPT", "\"approach.setpoint\" = { values = [0.3, 0.85, 0.9] }");
    let run = run(&parse(&text));
    for (one, share) in run.results.iter().zip([0.3, 0.85, 0.9]) {
        let found = one.measured.harmonics[0] / 10e-9;
        assert_eq!(one.status, Status::Ok, "{share}");
        assert!((found - share).abs() < 1e-3, "{share}: {found}");
        assert!(one.measured.force_mean > 0.0, "{share}");
    }
}

/// Truth: the power balance, as above, at phases that are asked for; the photodiode's share of its free amplitude, which on a driven
/// base in a liquid is another than the tip's.
#[test]
fn phases_and_deflections_are_held() {
    let scene = tapping(
        "setpoint_of = \"phase\"",
        "\"drive.free_amplitude\" = { values = [\"20 nm\"] }\n\"approach.setpoint\" = { values = [60, 50, 105, 110] }",
    );
    for (one, degrees) in run(&scene).results.iter().zip([60.0, 50.0, 105.0, 110.0f64]) {
        assert_eq!(one.status, Status::Ok, "{degrees}");
        assert!(
            (one.measured.phase - degrees).abs().to_radians() < 0.06e-3,
            "{degrees}: {}",
            one.measured.phase
        );
        let share = one.measured.harmonics[0] / 20e-9;
        assert!((share - degrees.to_radians().sin()).abs() < 1e-3, "{degrees}: {share}");
        assert_eq!(one.measured.force_mean > 0.0, degrees < 90.0, "{degrees}");
    }
    let liquid = r#"
[instrument.cantilever]
modes = [{ stiffness = "0.1 N/m", frequency = "30 kHz", quality_factor = 2 }]
[instrument.actuator]
model = "rigid"
[instrument.tip]
radius = "20 nm"
[sample]
youngs_modulus = "100 MPa"
surface_energy = "0 J/m^2"
[contact]
law = "hertz"
[drive]
frequency = "30 kHz"
free_amplitude = "20 nm"
[approach]
setpoint_of = "deflection"
[sweep]
"approach.setpoint" = { values = [0.6, 0.7, 0.8, 0.9] }
[output]
observables = ["amplitude", "deflection_amplitude", "force_max"]
"#;
    let ran = run(&parse(liquid));
    for (i, (one, share)) in ran.results.iter().zip([0.6, 0.7, 0.8, 0.9]).enumerate() {
        let free = &ran.plan.driven(i as u32).free;
        let held = one.measured.deflection_amplitude / free.deflection(free.tip).norm();
        let tip = one.measured.harmonics[0] / 20e-9;
        assert_eq!(one.status, Status::Ok, "{share}");
        assert!(
            (held - share).abs() < 1e-3 * 0.06 && (tip - share).abs() > 0.01,
            "{share}: {held}, tip {tip}"
        );
    }
}

/// A sharp tip sinks into a gel by many free amplitudes before its amplitude falls. Truth: the curve over the gap.
#[test]
fn soft_samples_hold_set_points_far_below_their_surface() {
    let soft = |approach: &str| {
        parse(&format!(
            r#"
[instrument.cantilever]
modes = [{{ stiffness = "0.1 N/m", frequency = "30 kHz", quality_factor = 2 }}]
[instrument.tip]
radius = "20 nm"
[sample]
youngs_modulus = "100 kPa"
surface_energy = "0 J/m^2"
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "30 kHz"
free_amplitude = "20 nm"
{approach}
[output]
observables = ["amplitude"]
"#
        ))
    };
    let held = run(&soft("[approach]\nsetpoint = 0.9"));
    let one = held.results.get(0);
    let gap = one.measured.gap;
    assert!(one.status == Status::Ok && gap < -400e-9, "{gap}");
    let curve = "[curve]\nquantity = \"approach.gap\"\nfrom = \"25 nm\"\npoints = 26\nto = \"";
    let along = run(&soft(&format!("{curve}{} nm\"", 1e9 * gap)));
    let last = along.results.get(25).measured.harmonics[0] / 20e-9;
    assert!((last - 0.9).abs() < 1e-3, "{last}");
    let shallow = run(&soft("[approach]\nsetpoint = 0.9\ndeepest = \"100 nm\""));
    assert_eq!(shallow.results.get(0).status, Status::NoSetpoint);
    let told =
        |note: &String| note.contains("1 set-points are not met") && note.contains("[approach] deepest");
    assert!(shallow.notes.iter().any(told), "{:?}", shallow.notes);
}
