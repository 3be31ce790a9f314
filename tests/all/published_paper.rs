//! The study of the seed paper: its numbers against the published ones, closed forms and the continuum;
//! the page in the repository against what the command writes.

use crate::continuum::Continuum;
use crate::pages::{both, kept, lines, same, same_picture};
use crate::program::Desk;
use afmsweep::scene::{ActuatorModel, InstrumentParams, TipMass};
use afmsweep::study::Numbers;
use afmsweep::study::paper::{self, Extent, MACHINE_LINE};
use std::f64::consts::{PI, TAU};
use std::fs;
use std::path::Path;
use std::sync::OnceLock;

/// The paper's contact: K, R, w.
const K: f64 = 4.0 / 3.0 * 1e5 / 0.75;
const R: f64 = 30e-9;
const W: f64 = 2e-3;

/// The study made once for all tests here, the ensemble at the radii that its maps show.
struct Made {
    folder: tempfile::TempDir,
    numbers: Numbers,
}

fn made() -> &'static Made {
    static MADE: OnceLock<Made> = OnceLock::new();
    MADE.get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let numbers = paper::write(folder.path(), Extent::Shown, &|_| {}).unwrap();
        Made { folder, numbers }
    })
}

fn get(key: &str) -> f64 {
    made().numbers.find(key).unwrap_or_else(|| panic!("no number {key}")).value
}

#[track_caller]
fn close(key: &str, exact: f64, tolerance: f64) {
    let error = (get(key) / exact - 1.0).abs();
    assert!(error <= tolerance, "{key}: {:e} is not {exact:e}, off by {error:.1e}", get(key));
}

/// Equal to every digit that was printed: half a unit of the last.
#[track_caller]
fn printed(key: &str, digits: &str) {
    let (mantissa, power) = digits.split_once('e').unwrap_or((digits, "0"));
    let places = mantissa.split_once('.').map_or(0, |(_, after)| after.len()) as i32;
    let half = 0.5 * 10f64.powi(power.parse::<i32>().unwrap() - places);
    let exact: f64 = digits.parse().unwrap();
    assert!((get(key) - exact).abs() <= 1.001 * half, "{key}: {:e} is not {digits}", get(key));
}

/// Table 1's reference values, to the digits known.
#[test]
fn published_numbers_of_table_1() {
    for (key, digits) in [
        ("mass.rod", "8.0e-6"),
        ("mass.lever", "1.170585e-10"),
        ("mass.tip", "8.333e-13"),
        ("mass.lever_over_rod", "1.5e-5"),
        ("lever.stiffness", "42.74245549"),
        ("lever.frequency_1", "195226.385"),
        ("lever.frequency_2", "1223462.87"),
        ("lever.frequency_3", "3425731.47"),
        ("lever.frequency_4", "6713066.43"),
        ("coupled.frequency_1", "96230.28875"),
        ("coupled.frequency_2", "192287.4162"),
        ("coupled.frequency_3", "309631.3175"),
        ("coupled.frequency_4", "518649.5031"),
        ("coupled.frequency_5", "727104.7409"),
        ("rod.static_top", "5.70415785e-9"),
        ("rod.top_alone", "6.225510e-9"),
        ("contact.modulus", "1.7778e5"),
        ("contact.modulus", "1.8e5"),
        ("choice.field.frequency", "94.67e3"),
        ("coupled.frequency_1", "96.23e3"),
        ("law.hertz.force_150", "1.79e-9"),
        ("law.dmt.force_150", "1.41e-9"),
        ("law.jkr.force_75", "0.42e-9"),
        ("law.jkr.radius_75", "68e-9"),
        ("jkr.fold_depth", "-30.4e-9"),
    ] {
        printed(key, digits);
    }
    let (h33, beta33, modulus) = (5.45136e8f64, 7.81e7, 2.216e10);
    close("rod.coupling_factor", (h33 * h33 / (beta33 * modulus)).sqrt(), 1e-14);
    close("contact.tabor", (R * W * W / ((0.75 * K).powi(2) * 0.3e-9f64.powi(3))).cbrt(), 1e-13);
}

/// JKR's dimensionless points times the paper's units.
#[test]
fn exact_points_of_jkr() {
    let force = PI * W * R;
    let depth = (PI * PI * W * W * R / (K * K)).cbrt();
    let radius = (PI * W * R * R / K).cbrt();
    close("jkr.fold_radius", 0.550321208149 * radius, 1e-11);
    close("jkr.fold_force", -5.0 / 6.0 * force, 1e-12);
    close("jkr.fold_depth", -0.908560296416 * depth, 1e-11);
    close("jkr.pull_off", 1.5 * force, 1e-12);
    close("jkr.jump_radius", 1.3867225487 * radius, 1e-10);
    close("jkr.jump_force", -4.0 / 3.0 * force, 1e-12);
    close("jkr.rest_depth", 1.1006424163 * depth, 1e-10);
    close("jkr.loss", 1.2749410291014 * force * depth, 1e-12);
    close("dmt.pull_off", 2.0 * force, 1e-12);
}

/// The choices against the continuum and against the formulas written down afresh.
#[test]
fn exact_sizes_of_the_choices() {
    let mut p = InstrumentParams::default();
    let tip = |p: &InstrumentParams, hz: f64| {
        let mut continuum = Continuum::new(p);
        continuum.kappa = if p.actuator.model == ActuatorModel::AsPrinted { 2.0 } else { 1.0 };
        continuum.forced(hz, 15.0 * continuum.force_per_volt, 0.0).0.abs()
    };
    close("tip.amplitude", tip(&p, 30e3), 1e-8);
    close("choice.radians.tip", tip(&p, 30e3 / TAU), 1e-8);
    p.actuator.model = ActuatorModel::AsPrinted;
    close("choice.printed.tip", tip(&p, 30e3), 1e-8);
    // A uniform field: the softer bar, no spring on its top.
    let mut field = Continuum::new(&InstrumentParams::default());
    let softer = 2.216e10 - 5.45136e8f64.powi(2) / 7.81e7;
    (field.rod_ea, field.rod_speed, field.spring) = (softer * 2.5e-7, (softer / 8000.0).sqrt(), 0.0);
    close("choice.field.frequency", field.frequencies(1)[0], 1e-8);
    close("choice.field.tip", field.forced(30e3, 15.0 * field.force_per_volt, 0.0).0.abs(), 1e-8);
    // A lever on a rod so heavy and fast that its base stands still.
    for (key, mass, arm) in [("none", 0.0, 0.0), ("at_end", 1.0, 0.0), ("on_arm", 1.0, 5e-6)] {
        let mut alone = InstrumentParams::default();
        alone.tip.mass = TipMass::Given(mass * 2500.0 * 1e-5 * 1e-5 * 1e-5 / 3.0);
        alone.tip.half_length = arm;
        alone.actuator.youngs_modulus *= 1e8;
        alone.actuator.width *= 1e6;
        close(&format!("choice.tip.{key}"), Continuum::new(&alone).frequencies(1)[0], 1e-8);
    }
    // (17b): the radius whose JKR deformation is 150 nm, by bisection; the force by (17a).
    let depth = |a: f64| a * a / R - 2.0 / 3.0 * (6.0 * PI * W * a / K).sqrt();
    let (mut low, mut high) = (50e-9, 200e-9);
    for _ in 0..100 {
        let middle = 0.5 * (low + high);
        if depth(middle) < 150e-9 { low = middle } else { high = middle }
    }
    close("choice.profile.printed", K * low.powi(3) / R - 2.0 * PI * R * W, 1e-12);
    close("choice.profile.depth", depth((R * 150e-9f64).sqrt()), 1e-12);
    close("choice.profile.hertz", K * R.sqrt() * 150e-9f64.powf(1.5) - 2.0 * PI * R * W, 1e-12);
    close("choice.attraction.ours", -2.0 * PI * R * W / 2.25, 1e-12);
    close("choice.attraction.printed", -2.0 * PI * R * W / 0.25, 1e-12);
    close("choice.tip.modulus", 4.0 / (3.0 * ((1.0 - 0.0784) / 130e9 + 0.75 / 1e5)), 1e-14);
}

/// Figure 4: what is known of the levels, and forces that follow from deformations.
#[test]
fn published_figure_4() {
    // "about 9 nm", "near 25 pN"
    assert!((8.5e-9..9.5e-9).contains(&get("fig4.hertz.tip")));
    assert!((24e-12..26e-12).contains(&get("fig4.hertz.force_max")));
    assert_eq!(get("fig4.jkr.touches"), 1.0);
    assert_eq!(get("fig4.jkr.force_max"), 0.0);
    let hertz = |depth: f64| K * R.sqrt() * depth.powf(1.5);
    for key in ["fig4", "scaled"] {
        let depth = |law: &str| get(&format!("{key}.{law}.depth"));
        close(&format!("{key}.hertz.force_max"), hertz(depth("hertz")), 1e-12);
        close(&format!("{key}.dmt.force_min"), -2.0 * PI * R * W, 1e-12);
        for law in ["dmt", "jkr"] {
            assert!((depth(law) / depth("hertz") - 1.0).abs() < 2e-3, "{key} {law}");
            assert!(get(&format!("{key}.{law}.tip_apart")) < 0.01 * get(&format!("{key}.hertz.tip")));
        }
    }
    close("scaled.hertz.depth", 150e-9, 1e-9);
    close("scaled.dmt.force_max", hertz(get("scaled.dmt.depth")) - 2.0 * PI * R * W, 1e-12);
    // The paper's reading: the radius of a²/R, then (16).
    let a = (R * get("scaled.jkr.depth")).sqrt();
    close("reading.jkr.depth", a * a / R - 2.0 / 3.0 * (6.0 * PI * W * a / K).sqrt(), 1e-12);
    close("reading.jkr.force_max", K * a.powi(3) / R - (6.0 * PI * W * K * a.powi(3)).sqrt(), 1e-12);
}

/// Consistent kinematics: equal but for the beam's share of the rod; as printed: twice.
#[test]
fn published_conclusions() {
    let p = InstrumentParams::default();
    let continuum = Continuum::new(&p);
    let on_top = 15.0 * continuum.force_per_volt;
    let alone = continuum.rod_alone(30e3, on_top);
    close("coupling.prescribed.top", alone.abs(), 1e-8);
    close("coupling.prescribed.tip", (alone * continuum.follows(30e3)).abs(), 1e-8);
    let (tip, top) = continuum.forced(30e3, on_top, 0.0);
    close("coupling.coupled.top", top.abs(), 1e-8);
    close("coupling.coupled.tip", tip.abs(), 1e-8);
    close("coupling.coupled.acceleration", (TAU * 30e3).powi(2) * top.abs(), 1e-8);
    assert!((get("coupling.coupled.tip_ratio") - 1.0).abs() < 1.5e-5);
    assert!((get("coupling.printed.tip_ratio") - 2.0).abs() < 1e-3);
    // The sweep: damping hardly changes what undamped closed forms say away from resonances.
    let apart = tip / (alone * continuum.follows(30e3)) - 1.0;
    close("apart.table1.drive", apart.abs(), 0.02);
    assert!((get("apart.table1.frequency") / get("coupled.frequency_1") - 1.0).abs() < 0.01);
    // A rod's mass scales the difference while that is small.
    close("apart.mass_drive", get("apart.table1.drive") / 0.01 * get("mass.rod"), 0.05);
}

/// The ensemble against its closed forms.
#[test]
fn exact_letting_go() {
    assert!(get("jkr.foretold") > 0.995, "{}", get("jkr.foretold"));
    assert!(get("jkr.loss_error") < 1e-3 && get("jkr.loss_close") > 0.9);
    assert!(get("jkr.loss_error_stored") < 2e-3, "{}", get("jkr.loss_error_stored"));
    close("jkr.fold_over_reach", -get("jkr.fold_depth") / (get("tip.amplitude") + 0.3e-9), 1e-12);
    for law in ["hertz", "dmt", "jkr"] {
        assert_eq!(get(&format!("ensemble.{law}.failed")), 0.0);
        assert!(get(&format!("ensemble.{law}.not_steady")) < 0.1);
    }
    for law in ["hertz", "dmt"] {
        let most = get(&format!("ensemble.{law}.loss.most")).max(-get(&format!("ensemble.{law}.loss.least")));
        assert!(most < 0.05 * get("ensemble.jkr.loss.median"), "{law} loses {most:e} J");
    }
    assert!((get("regime.dmt") + get("regime.between") + get("regime.jkr") - 1.0).abs() < 1e-12);
}

/// Everything kept in the repository is what the command writes; sums over the whole ensemble are left to
/// `agree_whole_ensemble`.
#[test]
fn agree_kept_page() {
    let folder = made().folder.path();
    for name in ["README.md", "index.html"] {
        let (kept, now) = both(name, folder);
        same(&lines(&kept, false), &lines(&now, false), 1.0, name);
        for text in [&kept, &now] {
            assert_eq!(text.matches(MACHINE_LINE).count(), 1, "{name}");
            assert!(!text.contains("no value") || text.contains("grey is no value"), "{name}");
            assert!(!text.contains("NaN"), "{name}");
        }
    }
    let (kept_csv, csv) = both("numbers.csv", folder);
    let rows = |text: &str| -> Vec<(String, f64)> {
        let rows = text.lines().skip(1).map(|line| line.split(',').collect::<Vec<_>>());
        rows.map(|cells| (cells[0].to_owned(), cells[1].parse().unwrap())).collect()
    };
    let (kept_rows, now) = (rows(&kept_csv), rows(&csv));
    assert_eq!(kept_rows.len(), now.len());
    let find = |key: &str| kept_rows.iter().find(|row| row.0 == key).unwrap().1;
    for (key, value) in &now {
        let old = find(key);
        assert!(value.is_finite(), "{key}");
        // Laws without memory lose nothing: what the page has for them is rounding.
        if ["ensemble.hertz.loss", "ensemble.dmt.loss"].iter().any(|start| key.starts_with(start)) {
            continue;
        }
        if key.ends_with(".least") && key.starts_with("ensemble") {
            assert!(old <= *value, "{key}: the whole ensemble holds the radii shown");
        } else if key.ends_with(".most") && key.starts_with("ensemble") {
            assert!(old >= *value, "{key}: the whole ensemble holds the radii shown");
        } else if !["ensemble.", "regime.", "jkr.never", "jkr.foretold", "jkr.single", "jkr.loss_"]
            .iter()
            .any(|start| key.starts_with(start))
        {
            // The distance of two runs' tips is a small difference.
            let tolerance = if key.ends_with("_apart") { 1e-3 } else { 1e-7 };
            assert!((old - value).abs() <= tolerance * value.abs(), "{key}: {old:e} kept, {value:e} written");
        }
    }
    assert!(find("ensemble.jkr.instances") >= 50_000.0);
    let pictures = |folder: &Path| -> Vec<String> {
        let names = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<String> = names.map(|name| name.into_string().unwrap()).collect();
        names.retain(|name| name.ends_with(".svg"));
        names.sort();
        names
    };
    assert_eq!(pictures(&kept()), pictures(folder));
    for name in pictures(folder) {
        same_picture(&name, folder);
        assert!(
            both("index.html", folder).1.contains(&format!("src=\"{name}\"")),
            "{name} is not on the page"
        );
        assert!(both("README.md", folder).1.contains(&format!("]({name})")), "{name} is not on the page");
    }
}

/// Pictures say what they show, with units.
#[test]
fn agree_pictures_have_axes_and_units() {
    for (name, words) in [
        (
            "figure_3.svg",
            &["deformation, negative for a gap (nm)", "force on the tip (nN)", "fold: lets go at"][..],
        ),
        (
            "figure_4.svg",
            &["time (µs)", "(a) rod's top (nm)", "(b) tip (nm)", "(c) deformation (nm)", "(d) force (pN)"],
        ),
        ("figure_4_scaled.svg", &["time (µs)", "(d) force (nN)", "Hertz", "DMT", "JKR"]),
        (
            "coupling_map.svg",
            &["drive frequency (kHz)", "rod mass in beam masses", "1 %; more below the line"],
        ),
        (
            "ensemble_force.svg",
            &["sample Young's modulus (GPa)", "work of adhesion (mJ/m²)", "largest force (nN)"],
        ),
        ("ensemble_loss.svg", &["JKR, R = 10 nm", "JKR, R = 100 nm", "loss (aJ)"]),
    ] {
        let text = fs::read_to_string(made().folder.path().join(name)).unwrap();
        for word in words {
            assert!(text.replace("&apos;", "'").contains(word), "{name} does not say {word:?}");
        }
    }
}

/// Minutes long: `cargo test --release --test all published_paper -- --ignored`.
#[test]
#[ignore = "the whole ensemble takes minutes where cores are few"]
fn agree_whole_ensemble() {
    let folder = tempfile::tempdir().unwrap();
    paper::write(folder.path(), Extent::Full, &|_| {}).unwrap();
    for name in ["README.md", "index.html"] {
        let (kept, now) = both(name, folder.path());
        same(&lines(&kept, true), &lines(&now, true), 1.0, name);
    }
}

#[test]
fn cli_study_leaves_other_folders_alone() {
    let desk = Desk::new();
    fs::create_dir(desk.path("mine")).unwrap();
    desk.write("mine/thesis.txt", "mine");
    desk.refuses(&["study", "paper", "-o", "mine"], &["mine", "holds other things", "-o"]);
    assert_eq!(fs::read_dir(desk.path("mine")).unwrap().count(), 1);
    let said = desk.call(&["study", "papers"]);
    assert_eq!(said.code, Some(2));
    assert!(said.err.contains("paper"), "{}", said.err);
}
