//! The report: which axes its pictures have, and the numbers beside them.
//! Truth: the data put in.

use crate::common::{coordinate, grid, list, ramp, results, scalar, variable};
use crate::report_pages::{Report, cube, number, save};
use afmsweep::report::{self, ViewRequest};
use afmsweep::store::{BranchTable, Flags, Results};
use std::fs;
use std::process::Command;

/// A grid of these lengths with one variable.
fn plain(lengths: &[usize]) -> Results {
    let axis = |(i, n): (usize, &usize)| coordinate(&format!("a_{i}"), "m", ramp(*n, 1e-9));
    let mut results = results(lengths.iter().enumerate().map(axis).collect(), false);
    results.variables.truncate(1);
    results.status.fill(0);
    results.other_branch = None;
    results
}

/// Truth: the places of the data put in: a short axis has a curve for each value, second states are dashed.
#[test]
fn a_short_axis_becomes_curves_and_second_states_are_dashed() {
    let mut results = plain(&[3, 40]);
    let words = Report::of(&results).words("amplitude.svg");
    for line in ["the a_0 500 pm", "1.5 nm", "2.5 nm", "the a_1 (nm)"] {
        assert!(words.lines().any(|word| word == line), "{line}: {words}");
    }
    assert!(!words.contains("second state"));
    results.other_branch = grid().other_branch.map(|mut branch| {
        branch.variables = vec![variable("amplitude", "m", None, ramp(120, 2e-9))];
        (branch.status, branch.steps_per_period, branch.flags) = (vec![255; 120], vec![0; 120], Vec::new());
        branch.status[40..60].fill(0);
        branch
    });
    let report = Report::of(&results);
    report.check();
    assert!(report.words("amplitude.svg").lines().any(|word| word == "second state"));
    let csv = report.text("amplitude.csv");
    let rows: Vec<&str> = csv.lines().collect();
    assert_eq!(rows[0], "instance,a_0 [m],a_1 [m],amplitude [m],status,second_amplitude [m],second_status");
    assert!(rows[1].ends_with(",ok,1e-9,") && rows[41].ends_with(",ok"), "{} {}", rows[1], rows[41]);
    // A map has no room for both: a second picture.
    let wish = ViewRequest { y: Some("a_0".into()), ..ViewRequest::default() };
    report::write(&save(report.home.path(), &results), Some(&report.folder), &wish).unwrap();
    assert!(report.words("amplitude_second.svg").contains("second state"));
}

/// Truth: the data put in: of four instances two are on the branch, one has its second state there, one has none.
#[test]
fn one_branch_is_drawn_of_first_and_second_states() {
    let flag = |data: Vec<u8>| Flags {
        name: "branch".into(),
        long_name: "branch".into(),
        meanings: ["none", "attractive", "repulsive"].map(str::to_owned).to_vec(),
        bits: false,
        data,
    };
    let mut results = plain(&[4]);
    results.variables = vec![variable("amplitude", "m", None, vec![1e-9, 2e-9, 3e-9, 4e-9])];
    results.variables[0].error_scale = "free tip amplitude".into();
    results.flags = vec![flag(vec![2, 2, 1, 1])];
    results.other_branch = Some(BranchTable {
        variables: vec![variable("amplitude", "m", None, vec![5e-9, f64::NAN, 7e-9, f64::NAN])],
        status: vec![0, 255, 0, 255],
        steps_per_period: vec![0; 4],
        flags: vec![flag(vec![1, 0, 2, 0])],
    });
    let report = Report::of(&results);
    let file = save(report.home.path(), &results);
    let drawn = |branch: &str| {
        let wish = ViewRequest { branch: Some(branch.into()), ..ViewRequest::default() };
        report::write(&file, Some(&report.folder), &wish)
    };
    let ends = |cells: [&str; 4]| {
        let csv = report.text("amplitude.csv");
        let found: Vec<String> =
            csv.lines().skip(1).map(|row| row.split(',').skip(2).collect::<Vec<_>>().join(" ")).collect();
        assert_eq!(found, cells);
    };
    let found = drawn("repulsive").unwrap();
    assert!(
        found.findings.iter().any(|line| line.starts_with("All 3 instances are ok")),
        "{:?}",
        found.findings
    );
    ends(["1e-9 ok", "2e-9 ok", "7e-9 ok", " "]);
    drawn("attractive").unwrap();
    ends(["5e-9 ok", " ", "3e-9 ok", "4e-9 ok"]);
    let refused = drawn("upper").unwrap_err().to_string();
    assert_eq!(refused, "--branch upper: expected attractive or repulsive");
    let all = report::write(&file, Some(&report.folder), &ViewRequest::default()).unwrap();
    let line = "The states are on different branches: 2 attractive, 2 repulsive; --branch repulsive shows one of them.";
    assert!(all.findings.iter().any(|one| one == line), "{:?}", all.findings);
}

/// Truth: the data put in, read back from the text to the bit.
#[test]
fn the_numbers_beside_a_picture_are_those_of_the_file() {
    for results in [grid(), list(), scalar()] {
        let report = Report::of(&results);
        for name in ["amplitude", "harmonic_amplitude"] {
            let one = results.variables.iter().find(|one| one.name == name).unwrap();
            if results.axes.is_empty() && one.harmonics.is_none() {
                continue;
            }
            let csv = report.text(&format!("{name}.csv"));
            let width = one.harmonics.unwrap_or(1);
            let first = 1 + results.axes.len();
            let rows = csv.lines().skip(1).map(|row| row.split(',').collect::<Vec<_>>());
            let found: Vec<f64> = rows
                .flat_map(|row| row[first..first + width].iter().map(|cell| number(cell)).collect::<Vec<_>>())
                .collect();
            assert_eq!(found, one.data, "{name}");
        }
    }
    let waveform = Report::of(&grid()).text("waveform_11.csv");
    let last: Vec<f64> = waveform.lines().last().unwrap().split(',').map(number).collect();
    let waves = grid().waveforms.unwrap();
    assert_eq!(
        last,
        [
            7.5e-7,
            waves.tip_travel[0][7],
            waves.actuator_top[0][7],
            waves.indentation[0][7],
            waves.force[0][7]
        ]
    );
}

/// Truth: the data put in.
#[test]
fn what_the_pointer_is_told_is_the_value_at_that_place() {
    let report = Report::of(&plain(&[9, 11]));
    let page = report.text("index.html");
    let (_, rest) = page.split_once("<script type=\"application/json\">").unwrap();
    let told: serde_json::Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
    let field = &told[0];
    assert_eq!(field["x"].as_array().unwrap().len(), 11);
    assert_eq!(field["y"][2], "2.5 nm");
    // Instance 2 * 11 + 5 of values 0.5 nm, 1.5 nm, ...
    assert_eq!(field["values"][27], "27.5 nm");
}

/// Truth: the sizes asked for: what browsers open at once.
#[test]
fn a_hundred_thousand_rows_make_a_small_page() {
    let mut many = list();
    many.axes =
        vec![coordinate("a_0", "m", ramp(100_000, 1e-9)), coordinate("a_1", "m", ramp(100_000, 1e-9))];
    let mut many = results(many.axes, true);
    many.variables.truncate(2);
    many.provenance[0].1 = "x = 1 # a row\n".repeat(200_000);
    for (results, images) in [(plain(&[320, 320]), 1), (many, 2)] {
        let report = Report::of(&results);
        report.check();
        let page = report.text("index.html");
        assert!(page.len() < 2_000_000, "{} bytes", page.len());
        let svg = report.text("amplitude.svg");
        assert_eq!(svg.matches("<image").count(), images);
        assert!(svg.matches("<rect").count() + svg.matches("<circle").count() < 400);
    }
}

#[test]
fn instances_that_are_not_ok_are_listed_with_what_varies_and_why() {
    let mut results = grid();
    results.status = vec![0; 12];
    results.status[7] = 1;
    let page = Report::of(&results).text("index.html");
    let row = "<tr><td>7</td><td>1 GPa</td><td>40 nm</td><td>not steady</td><td>the response still changes";
    assert!(page.contains(row), "{page}");
    let many = Results { status: vec![1; 32], ..plain(&[4, 8]) };
    let page = Report::of(&many).text("index.html");
    assert!(page.contains("Instances that are not ok: the first 20 of 32"), "{page}");
}

/// Truth: none of these instances is ok, so there is no value to tell, not even one that is nothing within its error.
#[test]
fn what_is_not_ok_is_no_finding() {
    let mut results = Results { status: vec![1; 32], ..plain(&[4, 8]) };
    results.variables = vec![variable("contact_time", "1", None, vec![0.0; 32])];
    let report = Report::of(&results);
    let file = save(report.home.path(), &results);
    let told = report::write(&file, Some(&report.folder), &ViewRequest::default()).unwrap().findings;
    assert!(told.iter().all(|line| !line.starts_with("Over")), "{told:?}");
    assert!(told.iter().any(|line| line.starts_with("0 of 32 instances are ok (32 not steady)")), "{told:?}");
}

#[test]
fn the_command_draws_over_the_axes_asked_for() {
    let home = tempfile::tempdir().unwrap();
    let mut results = cube(&[9]);
    results.axes[0].scene_path = "approach.gap".into();
    save(home.path(), &results);
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_afmsweep"));
        let output =
            command.args(["report", "a.h5"]).args(arguments).current_dir(home.path()).output().unwrap();
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        (output.status.code(), text(&output.stdout), text(&output.stderr))
    };
    let (code, out, _) = run(&["--x", "approach.gap", "--at", "tip_radius=10nm", "--json", "-q"]);
    assert_eq!(code, Some(0));
    let object: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!((&object["version"], &object["page"]), (&1.into(), &"a/index.html".into()));
    assert_eq!(object["pictures"][0]["file"], "amplitude.svg");
    let svg = fs::read_to_string(home.path().join("a/amplitude.svg")).unwrap();
    assert!(svg.contains("the approach_gap_0 (nm)") && svg.contains("10 GPa"), "{svg}");
    assert!(
        fs::read_to_string(home.path().join("a/index.html")).unwrap().contains("At the tip_radius 10 nm.")
    );
    assert_eq!(object["kept"], serde_json::Value::Null);
    let (_, out, _) = run(&["--below", "amplitude=50nm", "--json", "-q"]);
    let object: serde_json::Value = serde_json::from_str(&out).unwrap();
    assert_eq!(
        (&object["kept"]["of"], &object["kept"]["best"]["observable"]),
        (&108.into(), &"phase".into())
    );
    for (arguments, words) in [
        (["--below", "amplitud=5nm"], "did you mean amplitude?"),
        (
            ["--x", "aproach.gap"],
            "--x aproach.gap: expected one of approach.gap, scene.sample_youngs_modulus, scene.tip_radius; did you mean \
             approach.gap?",
        ),
        (["--at", "approach.gap=3 s"], "a value with its unit"),
        (["--at", "approach.gap=90nm"], "a value from 500 pm to 8.5 nm"),
    ] {
        let (code, _, err) = run(&arguments);
        assert!(code == Some(1) && err.contains(words), "{err}");
    }
    assert_eq!(run(&["--x", "gap", "-q"]).0, Some(0));
    assert_eq!(run(&["--at", "approach.gap"]).0, Some(2));
}
