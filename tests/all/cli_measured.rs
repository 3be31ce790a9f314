//! `infer` with a measured curve, as a user types it. Truth: the values that the curve was made with, the same curve written
//! in another way, the program's own points.

use crate::program::{Desk, numbers, scene, variable};
use afmsweep::design::{Mix, normal_quantile};
use afmsweep::store::read;
use serde_json::Value;
use std::sync::OnceLock;

const SCENE: &str = r#"
[instrument.cantilever]
stiffness = "10 N/m"
frequency = "75 kHz"
quality_factor = 30
[instrument.tip]
radius = "10 nm"
[sample]
youngs_modulus = "2 GPa"
poisson_ratio = 0.3
surface_energy = "20 mJ/m^2"
[contact]
law = "dmt"
[drive]
frequency = "75 kHz"
on = "tip"
free_amplitude = "20 nm"
[curve]
quantity = "approach.gap"
from = "17 nm"
to = "12 nm"
points = 11
[output]
observables = ["amplitude", "phase", "force_max"]
[uncertain]
"instrument.cantilever.stiffness" = { distribution = "normal", mean = "10 N/m", sd = "5 %" }
"sample.youngs_modulus" = { distribution = "loguniform", from = "1 GPa", to = "4 GPa" }
[design]
kind = "sobol"
samples = 512
"#;

const FILE: &str = "results/curve.h5";

/// A desk with the results of the scene as it is; several tests begin with them.
fn desk() -> (Desk, afmsweep::store::Results) {
    static RESULTS: OnceLock<Vec<u8>> = OnceLock::new();
    let desk = Desk::new();
    let path = desk.write("curve.toml", SCENE);
    let run = || {
        desk.run(&path, &[]);
        std::fs::read(desk.path(FILE)).expect("the run leaves its file")
    };
    let bytes = RESULTS.get_or_init(run);
    std::fs::create_dir_all(desk.path("results")).expect("the desk is a folder");
    std::fs::write(desk.path(FILE), bytes).expect("there is room");
    let results = read(&desk.path(FILE)).expect("it is a results file");
    (desk, results)
}

/// A desk with the results of the scene, changed by `change`.
fn changed_desk(change: impl Fn(&str) -> String) -> (Desk, afmsweep::store::Results) {
    let desk = Desk::new();
    let path = desk.write("curve.toml", &change(SCENE));
    let results = desk.run(&path, &[]);
    (desk, results)
}

/// The points 1 to 9 of a row as a measured curve, at gaps less `offset`; its sample's modulus.
fn measured(results: &afmsweep::store::Results, row: usize, offset: f64) -> (Vec<[f64; 3]>, f64) {
    let gap = |n: usize| 17.0 - 0.5 * n as f64;
    let value = |name: &str, n: usize| variable(results, name)[11 * row + n];
    let rows = (1..10).map(|n| [gap(n) - offset, 1e9 * value("amplitude", n), value("phase", n)]).collect();
    let modulus = results.axes[0].columns.iter().find(|one| one.name == "sample_youngs_modulus").unwrap();
    (rows, modulus.values[row])
}

fn csv(head: &str, rows: &[[f64; 3]], between: &str) -> String {
    let line = |row: &[f64; 3]| row.map(|value| format!("{value:.4}")).join(between) + "\n";
    format!("{head}\n{}", rows.iter().map(line).collect::<String>())
}

const HEAD: &str = "gap [nm],amplitude [nm],phase [deg]";
const SDS: [&str; 4] = ["--sd", "amplitude=0.1 nm", "--sd", "phase=2 deg"];

fn infer<'a>(more: &[&'a str]) -> Vec<&'a str> {
    [&["infer", FILE], more].concat()
}

fn within(told: &Value, name: &str, truth: f64) {
    let at = |share: &str| told["parameters"][name]["quantiles"][share].as_f64().unwrap();
    assert!((at("0.025")..=at("0.975")).contains(&truth), "{name}, {truth:e}: {told}");
}

#[test]
fn a_curve_is_one_however_its_file_is_written() {
    let (desk, results) = desk();
    let (rows, modulus) = measured(&results, 100, 0.0);
    desk.write("a.csv", &csv(HEAD, &rows, ","));
    let told = desk.json(&infer(&[&["--observed", "a.csv", "--json"][..], &SDS].concat()));
    within(&told, "sample_youngs_modulus", modulus);
    assert_eq!(told["observed"]["values"], 18);
    assert_eq!(told["names"].as_array().unwrap().len(), 2);
    let force = &told["predicted"]["force_max"]["curves"][0];
    assert_eq!(numbers(&force["approach_gap"]).len(), numbers(&force["quantiles"]["0.5"]).len());
    // Semicolons, decimal commas, a mark of byte order, Windows' ends of lines, comments, blank lines, other units and order;
    // standard deviations as columns; a row without a phase beyond the curve.
    let mut other = "\u{feff}# instrument 5\r\n\r\nPhase (deg);phase_sd [deg];gap [um];direction;amplitude [pm];amplitude_sd [nm]\r\n".to_owned();
    for [gap, amplitude, phase] in &rows {
        let line = format!("{phase:.4};2;{:.7};approach;{:.1};0.1\r\n", gap / 1e3, amplitude * 1e3);
        other += &line.replace('.', ",");
    }
    other += "; ;0,025;approach;20000;0,1\r\n#end\r\n;;0,0155;retraction;20000;0,1\r\n";
    desk.write("b.csv", &other);
    let said = desk.works(&infer(&["--observed", "b.csv", "--json"]));
    let same: Value = serde_json::from_str(&said.out).unwrap();
    assert_eq!(same["parameters"], told["parameters"]);
    for words in [
        "1 of 11 rows of b.csv was left out: beyond the curve, which runs from 12 nm to 17 nm",
        "1 of 11 rows of b.csv was left out: of a way",
    ] {
        assert!(said.err.contains(words), "{}", said.err);
    }
}

/// A page of an answer that nothing fits says so before it says what was found.
#[test]
fn the_page_of_a_curve_that_nothing_fits_warns_first() {
    let (desk, results) = desk();
    let (mut rows, _) = measured(&results, 100, 0.0);
    let options = ["--observed", "a.csv", "-o", "page", "--sd", "amplitude=0.15 nm", "--sd", "phase=4 deg"];
    let page = |rows: &[[f64; 3]]| {
        desk.write("a.csv", &csv(HEAD, rows, ","));
        let said = desk.works(&infer(&options));
        (said.err, std::fs::read_to_string(desk.path("page/index.html")).unwrap())
    };
    let (said, good) = page(&rows);
    assert!(!said.contains("even the best row") && !good.contains("Not to be trusted"), "{said}");
    // Up and down by three standard deviations, as no sample makes a curve.
    rows.iter_mut().enumerate().for_each(|(n, row)| row[1] += if n % 2 == 0 { 0.45 } else { -0.45 });
    let (said, bad) = page(&rows);
    assert!(said.contains("warning: even the best row misses by"), "{said}");
    let at = |words: &str| bad.find(words).unwrap_or_else(|| panic!("no {words}"));
    assert!(at("Not to be trusted") < at("even the best row misses by"));
    assert!(at("even the best row misses by") < at("Found:"));
}

#[test]
fn an_offset_a_travel_and_a_factor_are_found() {
    let (desk, results) = desk();
    let (rows, modulus) = measured(&results, 100, 1.25);
    desk.write("a.csv", &csv(HEAD, &rows, ","));
    let sds = [&SDS[..], &["--json", "--offset"]].concat();
    let told = desk.json(&infer(&[&["--observed", "a.csv"], &sds[..], &["approach.gap"]].concat()));
    within(&told, "sample_youngs_modulus", modulus);
    within(&told, "approach_gap_offset", 1.25e-9);
    let prior = &told["free"]["approach_gap_offset"];
    // As far as the curve, from 17 to 12 nm, holds all rows, from 15.25 to 11.25.
    assert_eq!(prior["distribution"], "uniform");
    assert!((prior["from"].as_f64().unwrap() - 0.75e-9).abs() < 1e-15, "{prior}");
    assert!((prior["to"].as_f64().unwrap() - 1.75e-9).abs() < 1e-15, "{prior}");
    // The same as a travel of the base, at whose beginning the gap is 20 nm.
    let travels: Vec<[f64; 3]> = rows.iter().map(|[gap, a, p]| [18.75 - gap, *a, *p]).collect();
    desk.write("t.csv", &csv("base_travel [nm]\tamplitude [nm]\tphase [deg]", &travels, "\t"));
    let range = "approach.gap=19.5 nm to 20.5 nm";
    let travel = desk.json(&infer(&[&["--observed", "t.csv"], &sds[..], &[range]].concat()));
    within(&travel, "approach_gap_offset", 20e-9);
    let median = |told: &Value, name: &str| told["parameters"][name]["quantiles"]["0.5"].as_f64().unwrap();
    let name = "sample_youngs_modulus";
    assert!((median(&travel, name) / median(&told, name) - 1.0).abs() < 0.02);
    desk.refuses(
        &infer(&[&["--observed", "t.csv"], &SDS[..]].concat()),
        &["travel of the base says nothing of the gap by itself; add --offset approach.gap"],
    );
    // The amplitude is told too large by a twentieth.
    let scaled: Vec<[f64; 3]> = rows.iter().map(|[gap, a, p]| [*gap, 1.05 * a, *p]).collect();
    desk.write("s.csv", &csv(HEAD, &scaled, ","));
    let all = [&["--observed", "s.csv", "--scale", "amplitude"], &sds[..], &["approach.gap"]].concat();
    let told = desk.json(&infer(&all));
    within(&told, "amplitude_scale", 1.05);
    within(&told, "approach_gap_offset", 1.25e-9);
    // A page of it all.
    let page = [&all[..], &["-o", "page", "-q"]].concat();
    desk.works(&infer(&page));
    let html = std::fs::read_to_string(desk.path("page/index.html")).unwrap();
    for words in [
        "<b>Found:</b>",
        "amplitude_predicted.svg",
        "force_max_predicted.svg",
        "offset of the gap",
        "factor of the measured amplitude",
    ] {
        assert!(html.contains(words), "{words}");
    }
    let corner = std::fs::read_to_string(desk.path("page/corner.svg")).unwrap();
    assert!(roxmltree::Document::parse(&corner).is_ok());
    let together = told["correlation"][1][2].as_f64().unwrap();
    let number = format!("{together:.2}").replace('-', "−");
    assert!(corner.contains(&number), "{number} is not in the corner");
}

#[test]
fn a_single_value_of_a_curve_needs_its_place() {
    let (desk, results) = desk();
    let seen = format!("amplitude={:e} m +- 50 pm", variable(&results, "amplitude")[11 * 100 + 4]);
    desk.refuses(
        &infer(&["--observed", &seen]),
        &["this is a curve: --at approach.gap=14.5nm picks a point, --observed curve.csv takes a measured one"],
    );
    let told = desk.json(&infer(&["--observed", &seen, "--at", "approach.gap=15nm", "--json"]));
    within(&told, "sample_youngs_modulus", measured(&results, 100, 0.0).1);
    assert!((told["at"]["approach_gap"].as_f64().unwrap() - 15e-9).abs() < 1e-15);
    for (at, words) in [
        ("approach.gab=15nm", "expected one of approach.gap; did you mean approach.gap?"),
        ("approach.gap=30nm", "expected a value from 17 nm to 12 nm"),
    ] {
        desk.refuses(&infer(&["--observed", &seen, "--at", at]), &[words]);
    }
    desk.refuses(
        &infer(&["--observed", &seen, "--offset", "approach.gap"]),
        &["--offset goes with the file"],
    );
}

/// A curve there and back has two ways, and a row needs to be on one.
#[test]
fn ways_are_told_apart() {
    let (desk, results) = changed_desk(|text| {
        text.replace("points = 11", "points = 11\ndirection = \"both\"").replace("512", "1024")
    });
    let line = |way: usize, n: usize| {
        let at = 22 * 100 + 11 * way + n;
        let (amplitude, phase) = (variable(&results, "amplitude")[at], variable(&results, "phase")[at]);
        format!("{},{:.4},{phase:.4}", 17.0 - 0.5 * n as f64, 1e9 * amplitude)
    };
    let both: String = (0..2)
        .flat_map(|way| (1..10).map(move |n| (way, n)))
        .map(|(way, n)| format!("{},{}\n", line(way, n), ["approach", "retraction"][way]))
        .collect();
    desk.write("both.csv", &format!("{HEAD},direction\n{both}"));
    let told = desk.json(&infer(&[&["--observed", "both.csv", "--json"][..], &SDS].concat()));
    assert_eq!(told["observed"]["values"], 36);
    assert_eq!(told["predicted"]["phase"]["curves"][1]["direction"], "backward");
    let one: String = (1..10).map(|n| line(1, n) + "\n").collect();
    desk.write("one.csv", &format!("{HEAD}\n{one}"));
    let call = infer(&[&["--observed", "one.csv", "--json"][..], &SDS].concat());
    desk.refuses(&call, &["both ways of its curve", "column `direction`", "--direction approach"]);
    let told = desk.json(&[&call[..], &["--direction", "retraction"]].concat());
    assert_eq!(told["predicted"]["phase"]["curves"][0]["direction"], "backward");
    desk.refuses(
        &[&call[..], &["--direction", "up"]].concat(),
        &["found `up`, expected one of approach, retraction"],
    );
}

#[test]
fn what_is_wrong_in_a_file_is_told_with_its_place() {
    let (desk, results) = changed_desk(|text| text.replace("512", "64"));
    let (rows, _) = measured(&results, 10, 0.0);
    let refused = |text: String, more: &[&str], words: &[&str]| {
        desk.write("w.csv", &text);
        desk.refuses(&infer(&[&["--observed", "w.csv"], more].concat()), words);
    };
    let good = csv(HEAD, &rows, ",");
    for (from, to, words) in [
        (
            "amplitude [nm]",
            "amplitud [nm]",
            "column `amplitud` is neither a place nor an observable of the results file; expected gap, base_travel, amplitude, phase, force_max, NAME_sd or direction; did you mean `amplitude`?",
        ),
        (
            "amplitude [nm]",
            "amplitude [nN]",
            "column `amplitude [nN]`: found the unit nN, expected a length, such as [nm]",
        ),
        ("phase [deg]", "phase", "column `phase`: found no unit, expected an angle, such as [deg]"),
        (
            "gap [nm]",
            "force_max [nN]",
            "no column that the curve runs along: expected one of approach.gap, or base_travel (a z piezo's, with --offset approach.gap); its first line that is no comment has \"force_max\", \"amplitude\", \"phase\"",
        ),
        ("16.5000", "hello", "w.csv line 2, column `gap [nm]`: found `hello`, expected a number"),
        (
            "16.5000",
            "16,5",
            "w.csv line 2: found 4 cells, expected 3; decimal commas need `;` or tabs between cells",
        ),
        ("gap [nm],amplitude", "gap [nm],gap", "column `gap` stands twice"),
    ] {
        assert!(good.contains(from), "{from}: {good}");
        refused(good.replacen(from, to, 1), &SDS, &[words]);
    }
    refused(
        good.clone(),
        &SDS[..2],
        &["no standard deviation of phase: add a column `phase_sd [deg]`, or --sd phase=\"0.5 deg\""],
    );
    refused(good.clone(), &["--sd", "amplitude=1 nN"], &["--sd amplitude=1 nN"]);
    refused(
        good.clone(),
        &["--sd", "amplitude=1 %"],
        &["no share is meant: give a length with its unit, such as"],
    );
    refused(
        good.replace("phase [deg]", "amplitude_sd [nm]").replace(&format!("{:.4}\n", rows[2][2]), "0\n"),
        &[],
        &["w.csv line 4, column `amplitude_sd [nm]`: found `0`, expected a standard deviation above zero"],
    );
    let far: Vec<[f64; 3]> = rows.iter().map(|[gap, a, p]| [gap + 20.0, *a, *p]).collect();
    refused(
        csv(HEAD, &far, ","),
        &SDS,
        &["none of its 9 rows lies within the curve, which runs from 12 nm to 17 nm"],
    );
    let wide: Vec<[f64; 3]> = rows.iter().map(|[gap, a, p]| [3.0 * gap, *a, *p]).collect();
    let offset = ["--offset", "approach.gap"];
    refused(
        csv(HEAD, &wide, ","),
        &[&SDS[..], &offset].concat(),
        &["leaves no room for an offset", "-5 nm to 5 nm"],
    );
    for (option, words) in [
        (["--offset", "approach.gab"], "expected approach.gap, which the curve runs along"),
        (["--offset", "approach.gap=5 nm"], "write it as approach.gap=\"-5 nm to 5 nm\""),
        (["--scale", "phase"], "--scale phase: expected one of what was measured: amplitude"),
        (
            ["--scale", "amplitude=ten"],
            "write it as amplitude, amplitude=\"10 %\" or amplitude=\"0.8 to 1.25\"",
        ),
    ] {
        refused(good.clone(), &[&SDS[..], &option].concat(), &[words]);
    }
    // So few samples tell nothing.
    refused(
        good,
        &["--sd", "amplitude=1 pm", "--sd", "phase=0.01 deg"],
        &[
            "effective samples of 64",
            "at each value. What agrees best has cantilever_stiffness from 1",
            "Take more samples",
        ],
    );
    desk.refuses(&infer(&["--observed", "nowhere.csv"]), &["no `=`, and no file of that name"]);
}

/// The curve that the scene is shipped with: what its file says that it is.
const SEED: u64 = 8;
const NOISE: [f64; 2] = [0.15, 1.0];
const MODULUS: f64 = 2.2e9;

/// The truth lies inside the 95 % ranges, with the gap known and with an offset of it unknown. The file beside the scene is
/// the program's own curve at these values, with noise from this seed.
#[test]
fn the_truth_behind_the_shipped_curve_is_found() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(scene("infer_curve.toml")).unwrap();
    let made = text.split("[uncertain]").next().unwrap().replace("\"40 N/m\"", "\"38 N/m\"");
    let made = made.replace("youngs_modulus = \"2 GPa\"", "youngs_modulus = \"2.2 GPa\"");
    let made =
        made.replace("\"22 nm\"\nto = \"8 nm\"\npoints = 57", "\"21 nm\"\nto = \"9.75 nm\"\npoints = 26");
    let truth = desk.run(&desk.write("truth.toml", &made), &[]);
    let value = |name: &str, row: usize| variable(&truth, name)[row];
    let noise = |row: usize, column: usize| {
        NOISE[column] * normal_quantile(Mix::new(SEED).of(row as u64).of(column as u64).share())
    };
    let mut rows = String::new();
    for row in 0..26 {
        let amplitude = 1e9 * value("amplitude", row) + noise(row, 0);
        let phase = value("phase", row) + noise(row, 1);
        let gap = 1e9 * truth.axes[0].values[row];
        rows += &format!("{gap:.2},{amplitude:.3},{},{phase:.2},{}\n", NOISE[0], NOISE[1]);
    }
    let file = scene("infer_curve.csv");
    let shipped = std::fs::read_to_string(&file).unwrap();
    let shown: String = shipped
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
        .map(|line| line.to_owned() + "\n")
        .collect();
    assert_eq!(shown, rows, "the file is not what it says");
    // Half of the points, which half the time goes for.
    let lighter = desk.write("lighter.toml", &text.replace("points = 57", "points = 29"));
    desk.run(&lighter, &[]);
    for offset in [&[][..], &["--offset", "approach.gap"]] {
        let told =
            desk.json(&[&["infer", "results/lighter.h5", "--json", "--observed", &file], offset].concat());
        within(&told, "cantilever_stiffness", 38.0);
        within(&told, "tip_radius", 8e-9);
        within(&told, "sample_youngs_modulus", MODULUS);
        within(&told, "sample_surface_energy", 50e-3);
        if !offset.is_empty() {
            within(&told, "approach_gap_offset", 0.0);
        }
        // It is told more sharply than before: the prior's own range is a factor of 14.
        let modulus = &told["parameters"]["sample_youngs_modulus"]["quantiles"];
        assert!(modulus["0.975"].as_f64().unwrap() / modulus["0.025"].as_f64().unwrap() < 4.0, "{modulus}");
    }
}
