//! `modes`, `force`, `plan` and `devices` as a user calls them.
//! Truth: frequencies of the paper's instrument (an independent calculation), closed forms of the laws.

use crate::program::{Desk, numbers, said, scene, scenes};
use afmsweep::contact::Law;
use afmsweep::scene::Scene;
use serde_json::Value;
use std::f64::consts::PI;
use std::process::Stdio;

/// K = 4/3 E/(1 - nu^2) for the rigid tip of the paper's scenes on 100 kPa, nu 0.5.
const K: f64 = 4.0 / 3.0 * 1e5 / 0.75;
const RADIUS: f64 = 30e-9;
const WORK: f64 = 2e-3;

fn column(value: &Value, name: &str) -> Vec<f64> {
    let rows = value.as_array().unwrap();
    rows.iter().map(|row| row[name].as_f64().unwrap_or_else(|| panic!("{name} of {row}"))).collect()
}

#[test]
fn modes_are_the_papers() {
    let desk = Desk::new();
    let answer = desk.json(&["modes", &scene("paper_fig4_hertz.toml"), "--json"]);
    let modes = &answer["modes"];
    let frequencies = column(modes, "frequency_hz");
    let published = [96230.28875, 192287.4162, 309631.3175, 518649.5031, 727104.7409];
    for (ours, theirs) in frequencies.iter().zip(published) {
        assert!((ours / theirs - 1.0).abs() < 1e-9, "{ours} {theirs}");
    }
    assert!(frequencies.windows(2).all(|pair| pair[0] < pair[1]));
    let shares = column(modes, "tip_share");
    assert!(shares.iter().all(|share| *share >= 0.0));
    // Listed are the modes whose frequencies are sure; the others stand together in `rest`.
    let rest = answer["rest"]["tip_share"].as_f64().unwrap();
    assert!((shares.iter().sum::<f64>() + rest - 1.0).abs() < 1e-12, "{shares:?} {rest}");
    assert!((0.0..5e-3).contains(&rest), "{rest}");
    let drive: f64 = column(modes, "drive_share").iter().map(|share| share.abs()).sum();
    assert!(drive > 0.9 && drive < 1.0 + 1e-12, "{drive}");
    // The preset is undamped, and JSON has no infinity.
    for mode in modes.as_array().unwrap() {
        assert_eq!(mode.as_object().unwrap().len(), 4, "{mode}");
        assert_eq!(mode["quality_factor"], Value::Null);
    }
}

#[test]
fn modes_are_damped_as_the_scene_says() {
    let desk = Desk::new();
    let answer = desk.json(&["modes", &scene("approach_stiff.toml"), "--json"]);
    let first = &answer["modes"][0];
    assert!((first["frequency_hz"].as_f64().unwrap() / 300e3 - 1.0).abs() < 1e-12, "{first}");
    assert_eq!(first["quality_factor"].as_f64(), Some(150.0));
    let table = desk.works(&["modes", &scene("approach_stiff.toml")]);
    assert!(table.out.contains("300.0000 kHz") && table.out.contains("150.0"), "{}", table.out);
    assert_eq!(table.err, "");
}

#[test]
fn hertz_forces_are_the_closed_form() {
    let desk = Desk::new();
    let path = scene("paper_fig4_hertz.toml");
    let points = ["75 nm", "-1 nm", "0 m", "1 Å", "-0.3 nm"];
    let mut arguments = vec!["force", &path, "--json"];
    points.iter().for_each(|point| arguments.extend(["--indentation", point]));
    let answer = desk.json(&arguments);
    let curves = answer["curves"].as_array().unwrap();
    assert_eq!(curves.len(), 2);
    for (curve, branch) in curves.iter().zip(["approach", "retract"]) {
        assert_eq!((curve["law"].as_str(), curve["branch"].as_str()), (Some("hertz"), Some(branch)));
        let asked = [75e-9, -1e-9, 0.0, 1e-10, -0.3e-9];
        assert_eq!(numbers(&curve["indentation_m"]), asked, "read exactly, in their order");
        let force = numbers(&curve["force_n"]);
        let radius = numbers(&curve["contact_radius_m"]);
        for (i, delta) in asked.into_iter().enumerate() {
            let delta: f64 = f64::max(delta, 0.0);
            let expected = K * RADIUS.sqrt() * delta.powf(1.5);
            assert!((force[i] - expected).abs() <= 1e-14 * expected, "{} {expected}", force[i]);
            let expected = (RADIUS * delta).sqrt();
            assert!((radius[i] - expected).abs() <= 1e-14 * expected, "{} {expected}", radius[i]);
        }
    }
}

#[test]
fn dmt_forces_are_the_closed_form() {
    let desk = Desk::new();
    let path = scene("paper_fig4_dmt.toml");
    let answer = desk.json(&["force", &path, "--json", "--indentation", "75 nm", "--indentation", "-0.6 nm"]);
    let pull = 2.0 * PI * WORK * RADIUS;
    let expected = [K * RADIUS.sqrt() * 75e-9f64.powf(1.5) - pull, -pull / 9.0];
    for curve in answer["curves"].as_array().unwrap() {
        for (ours, expected) in numbers(&curve["force_n"]).iter().zip(expected) {
            assert!((ours / expected - 1.0).abs() < 1e-13, "{ours} {expected}");
        }
    }
}

/// JKR by its parametric form: from a radius follow indentation and force; and what has no state is null.
#[test]
fn jkr_forces_obey_the_parametric_form() {
    let desk = Desk::new();
    let path = scene("paper_fig4_jkr.toml");
    let answer = desk.json(&[
        "force",
        &path,
        "--json",
        "--indentation",
        "75 nm",
        "--indentation=-20 nm",
        "--indentation",
        "-40 nm",
    ]);
    let (approach, retract) = (&answer["curves"][0], &answer["curves"][1]);
    assert_eq!(numbers(&approach["force_n"])[1..], [0.0, 0.0], "no contact before the surface");
    for (curve, points) in [(approach, 1), (retract, 2)] {
        for i in 0..points {
            let a = curve["contact_radius_m"][i].as_f64().unwrap();
            let delta = a * a / RADIUS - (8.0 * PI * WORK * a / (3.0 * K)).sqrt();
            let force = K * a.powi(3) / RADIUS - (6.0 * PI * WORK * K * a.powi(3)).sqrt();
            let (d, f) = (curve["indentation_m"][i].as_f64().unwrap(), curve["force_n"][i].as_f64().unwrap());
            assert!((d / delta - 1.0).abs() < 1e-12, "{d} {delta}");
            assert!((f / force - 1.0).abs() < 1e-12, "{f} {force}");
        }
    }
    assert_eq!(retract["force_n"][2], Value::Null, "beyond the fold at -30 nm there is no contact");
    assert_eq!(retract["contact_radius_m"][2], Value::Null);
}

#[test]
fn whole_curves_run_the_way_the_tip_does() {
    let desk = Desk::new();
    for path in scenes() {
        let answer = desk.json(&["force", path.to_str().unwrap(), "--json"]);
        let curves = answer["curves"].as_array().unwrap();
        assert_eq!(curves.len(), 2, "{}", path.display());
        for curve in curves {
            let delta = numbers(&curve["indentation_m"]);
            assert!(delta.len() > 100);
            assert_eq!(delta.len(), curve["force_n"].as_array().unwrap().len());
            assert_eq!(delta.len(), curve["contact_radius_m"].as_array().unwrap().len());
            let rising = curve["branch"] == "approach";
            assert!(delta.windows(2).all(|pair| if rising {
                pair[0] <= pair[1]
            } else {
                pair[0] >= pair[1]
            }));
        }
        let text = desk.works(&["force", path.to_str().unwrap()]);
        assert!(text.out.starts_with("law ") && text.out.contains("\nretract\n"), "{}", text.out);
        assert_eq!(text.err, "");
    }
}

#[test]
fn every_scene_loads_and_plans() {
    let desk = Desk::new();
    for path in scenes() {
        let name = path.to_str().unwrap();
        let plan = desk.json(&["plan", name, "--json", "-q"]);
        let scene = Scene::load(&path).unwrap();
        assert_eq!(plan["instances"].as_u64(), Some(scene.len() as u64), "{name}");
        let classes = plan["classes"].as_array().unwrap();
        let mut instances = 0;
        for class in classes {
            let law = Law::from_name(class["law"].as_str().unwrap()).unwrap_or_else(|| panic!("{class}"));
            // A viscous contact moves many.
            let most = if law.is_viscous() { 24 } else { 8 };
            assert!((1..=most).contains(&class["modes"].as_u64().unwrap()), "{class}");
            let steps = class["steps_per_period"].as_u64().unwrap();
            assert!(steps == 0 || (64..=65_536).contains(&steps), "{class}");
            instances += class["instances"].as_u64().unwrap();
        }
        assert_eq!(instances, scene.len() as u64, "{name}: the classes hold every instance once");
        let kept = numbers(&Value::Array(
            plan["drives"][0]["modes"]
                .as_array()
                .unwrap()
                .iter()
                .map(|mode| mode["tip_share"].clone())
                .collect(),
        ));
        assert!(kept[0] > 0.5, "{name}: the first mode kept carries most: {kept:?}");
        assert!(plan["estimated_time_s"].as_f64().unwrap() > 0.0);
        // Trials that take too long tell no time.
        let expected = plan.get("expected_time_s").expect("it is told, or null");
        assert!(expected.is_null() || expected.as_f64().is_some_and(|seconds| seconds > 0.0), "{expected}");
        assert!(plan["file_bytes"].as_u64().unwrap() > 0 && plan["memory_bytes"].as_u64().unwrap() > 0);
        let text = desk.works(&["plan", name, "-q"]);
        assert!(
            text.out.contains("steps/period")
                && (text.out.starts_with("expected time ") || text.out.starts_with("no expected time")),
            "{}",
            text.out
        );
        assert_eq!(text.err, "");
        assert!(!desk.path("results").exists(), "a plan writes nothing");
    }
}

#[test]
fn plans_take_the_arguments_of_a_run() {
    let desk = Desk::new();
    let path = scene("paper_fig4_hertz.toml");
    let plan = desk.json(&["plan", &path, "--json", "--steps-per-period", "4096", "--precision", "f32"]);
    assert_eq!(plan["classes"][0]["steps_per_period"], 4096);
    assert_eq!(plan["classes"][0]["law"], "hertz");
    assert_eq!(plan["precision"], "f32");
    assert_eq!(plan["instance_steps"], 4096 * 12);
}

#[test]
fn devices_name_the_processor() {
    let desk = Desk::new();
    let answer = desk.json(&["devices", "--json"]);
    let cpu = &answer["devices"][0];
    assert_eq!(cpu["backend"], "cpu");
    assert!(cpu["threads"].as_u64().unwrap() >= 1);
    let name = cpu["name"].as_str().unwrap();
    assert!(!name.is_empty());
    // Of vector instructions a test can ask for itself, those used are told.
    #[cfg(target_arch = "x86_64")]
    assert_eq!(
        is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma"),
        name.contains("(AVX"),
        "{name}"
    );
    assert!(desk.works(&["devices"]).out.starts_with("cpu "));
}

/// A reader that goes away early (`| head -1`) is no error, for answers and for messages.
#[test]
fn closed_pipes_are_no_panic() {
    let desk = Desk::new();
    let path = scene("paper_fig4_jkr.toml");
    let mut force = desk.command(&["force", &path]);
    let mut child = force.stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stdout.take());
    let answer = said(child.wait_with_output().unwrap());
    assert_eq!((answer.code, answer.err.as_str()), (Some(0), ""));

    let mut run = desk.command(&["run", &path, "-v"]);
    let mut child = run.stderr(Stdio::piped()).spawn().unwrap();
    drop(child.stderr.take());
    assert_eq!(child.wait().unwrap().code(), Some(0), "messages nobody reads do not stop a run");
    assert!(desk.path("results/paper_fig4_jkr.h5").is_file());
}

#[test]
fn help_and_version_go_to_standard_output() {
    let desk = Desk::new();
    let help = desk.works(&["--help"]);
    let list =
        help.out.split("Commands:\n").nth(1).expect("a list of commands").split("\n\n").next().unwrap();
    let commands: Vec<&str> = list.lines().filter_map(|line| line.split_whitespace().next()).collect();
    assert!(commands.len() >= 9 && commands.contains(&"run"), "{list}");
    let readme = include_str!("../../README.md");
    for command in commands.into_iter().filter(|command| *command != "help") {
        let named = [" ", "`"].map(|end| format!("`afmsweep {command}{end}"));
        assert!(named.iter().any(|name| readme.contains(name)), "README has no {command}");
        assert!(desk.works(&[command, "--help"]).out.contains("Usage: afmsweep"));
    }
    assert_eq!(desk.works(&["--version"]).out, format!("afmsweep {}\n", env!("CARGO_PKG_VERSION")));
}
