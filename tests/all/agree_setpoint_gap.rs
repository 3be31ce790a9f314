//! Gaps and forces at set-points where the residual is flat, turns or has a kink. Truth: finer runs, the audit, and forces at
//! given gaps.

use crate::agree_setpoint::{parse, run};
use afmsweep::control::{self, MemoryJournal, RunResult};
use afmsweep::engine::Progress;
use afmsweep::observe::{Observable, Status};

/// A run of a lever (stiffness, quality factor), tip, drive (frequency, free amplitude) and contact, with the rest of the scene.
fn lever(lever: [&str; 2], tip: &str, drive: [&str; 2], contact: &str, rest: &str) -> RunResult {
    let ([stiffness, quality], [frequency, amplitude]) = (lever, drive);
    run(&parse(&format!(
        r#"
instrument.cantilever = {{ stiffness = "{stiffness}", frequency = "300 kHz", quality_factor = {quality} }}
instrument.tip = {{ {tip}, youngs_modulus = "130 GPa", poisson_ratio = 0.28 }}
drive = {{ on = "tip", frequency = "{frequency}", free_amplitude = "{amplitude}" }}
contact = {{ {contact} }}
output.observables = ["amplitude", "force_max", "gap"]
{rest}
"#
    )))
}

/// Where the amplitude turns, or hardly depends on the gap, a small residual says little of the gap: it was off by the whole
/// amplitude where it nearly touches the set-point, and by 3e-3 of it elsewhere. Truth: a run at a hundredth of the accuracy. The
/// audit, whose reference holds the set-point itself, shows how far the gap is from it.
#[test]
fn gaps_are_met_where_the_amplitude_hardly_depends_on_them() {
    let soft =
        "[sample]\nyoungs_modulus = \"16 MPa\"\npoisson_ratio = 0.34\nsurface_energy = \"52 mJ/m^2\"\n";
    let turning = format!("{soft}[approach]\nsetpoint = 0.9956");
    let memory = "instantaneous_modulus = \"48 MPa\"\nrelaxation_time = \"46 ns\"\n";
    let swept = "[sweep]\n\"approach.setpoint\" = { from = 0.99, to = 0.9956, points = 8 }";
    for sample in [turning, format!("{soft}{memory}{swept}")] {
        let at = |accuracy| {
            let rest = format!("run.accuracy = {accuracy}\n{sample}");
            lever(["10 N/m", "9.5"], "radius = \"10 nm\"", ["301.5 kHz", "26 nm"], "law = \"dmt\"", &rest)
        };
        let (rough, fine) = (at("1e-3"), at("1e-5"));
        let place = rough.plan.observables.iter().position(|one| *one == Observable::Gap).unwrap();
        let count = rough.plan.len();
        let audited = control::audit(&rough, count, &MemoryJournal::default(), &Progress::default()).unwrap();
        for (i, (rough, fine)) in rough.results.iter().zip(fine.results.iter()).enumerate() {
            assert!(rough.status == Status::Ok && fine.status == Status::Ok, "{i}");
            let apart = (rough.measured.gap - fine.measured.gap).abs() / 26e-9;
            let shown = audited[i].errors[place];
            assert!(apart < 1e-3 && (shown - apart).abs() < 3e-5, "{i}: {shown} {apart}");
        }
    }
}

/// The force has a kink where the tip first touches, and no guess of its slope serves on both sides. Truth: the forces at given
/// gaps are held at these gaps.
#[test]
fn forces_next_to_first_touch_are_held() {
    let at = |swept: &str| {
        let rest = format!("[sample]\nyoungs_modulus = \"1.48 GPa\"\npoisson_ratio = 0.34\n[sweep]\n{swept}");
        let cone = "shape = \"cone\", half_angle = \"20 deg\"";
        lever(["10 N/m", "134"], cone, ["301.5 kHz", "4.66 nm"], "law = \"hertz\"", &rest)
    };
    let gaps = [4.32, 4.3, 4.28, 4.25, 4.2];
    let given = at(&format!("\"approach.gap\" = {{ values = {:?} }}", gaps.map(|gap| format!("{gap} nm"))));
    let forces: Vec<String> =
        given.results.iter().map(|one| format!("{} N", one.measured.force_max)).collect();
    let held = at(&format!("\"approach.force_setpoint\" = {{ values = {forces:?} }}"));
    for (one, gap) in held.results.iter().zip(gaps) {
        assert_eq!(one.status, Status::Ok, "{gap} nm");
        assert!((one.measured.gap * 1e9 - gap).abs() < 1e-3 * 4.66, "{gap} nm: {}", one.measured.gap);
    }
}

/// Truth: from first touch on the force of a soft lever on a stiff sample rises to 1 nN as the gap falls, and a step of the
/// approach passes from none to many times what is held.
#[test]
fn forces_are_held_where_a_step_of_the_gap_passes_many_of_them() {
    let hertz = "[sample]\nyoungs_modulus = \"30.39 GPa\"\npoisson_ratio = 0.35\n[sweep]\n";
    let swept =
        "\"approach.force_setpoint\" = { from = \"0.01 nN\", to = \"1 nN\", points = 16, scale = \"log\" }";
    let (tip, drive) = ("radius = \"11.73 nm\"", ["resonance", "48.2501 nm"]);
    let held =
        lever(["0.5206 N/m", "7.9944"], tip, drive, "law = \"hertz\"", &format!("{hertz}{swept}")).results;
    for (n, one) in held.iter().enumerate() {
        let force = 0.01e-9 * 100f64.powf(n as f64 / 15.0);
        assert_eq!(one.status, Status::Ok, "{force}");
        assert!((one.measured.force_max / force - 1.0).abs() < 1e-3 * 0.06, "{force}");
    }
}
