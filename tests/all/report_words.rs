//! The report: what its pages say of cases that are not plain, of samples, of single cases.
//! Truth: the data put in.

use crate::common::{coordinate, grid, ramp, results, scalar, variable};
use crate::report_pages::{Report, save};
use afmsweep::report::{self, ViewRequest};
use afmsweep::store::{Attribute, Coordinate, Flags, Results};

fn findings(results: &Results, wish: &ViewRequest) -> Vec<String> {
    let report = Report::of(results);
    report::write(&save(report.home.path(), results), Some(&report.folder), wish).unwrap().findings
}

/// Truth: 25 Hz apart in 299 kHz are told apart; degrees that differ in the fourth digit as well.
#[test]
fn digits_tell_neighbours_apart() {
    let frequencies: Vec<f64> = (0..161).map(|i| 298e3 + 25.0 * f64::from(i)).collect();
    let mut one = results(vec![coordinate("drive_frequency", "Hz", frequencies)], false);
    one.status.fill(0);
    one.variables =
        vec![variable("phase", "degree", None, (0..161).map(|i| 44.41 + 1e-4 * f64::from(i)).collect())];
    one.flags = vec![Flags {
        name: "jump".into(),
        long_name: "jump".into(),
        meanings: vec!["no".into(), "yes".into()],
        bits: false,
        data: (0..161).map(|i| u8::from(i == 54 || i == 37)).collect(),
    }];
    let told = findings(&one, &ViewRequest::default());
    assert!(told.iter().any(|line| line.ends_with("298.925 kHz to 299.35 kHz.")), "{told:?}");
    assert!(told[0].ends_with("phase 44.41° to 44.426°."), "{told:?}");
}

/// Truth: by hand: of the rows at 10 nm alone.
#[test]
fn findings_are_of_what_is_shown() {
    let mut results = grid();
    results.status.fill(0);
    let wish = ViewRequest { at: vec![("tip_radius".into(), "10 nm".into())], ..ViewRequest::default() };
    let told = findings(&results, &wish);
    // Instances 1, 5 and 9 of values 0.5 nm, 1.5 nm, ...
    assert!(
        told[0].starts_with("At the tip_radius 10 nm, over the sample_youngs_modulus 100 MPa to 10 GPa: the amplitude 1.5 nm to 9.5 nm"),
        "{told:?}"
    );
    assert!(told.iter().any(|line| line.starts_with("All 3 instances are ok")), "{told:?}");
}

#[test]
fn a_page_begins_with_what_is_not_there_and_shows_what_is() {
    let axes = ["a_0", "a_1", "a_2"].map(|name| coordinate(name, "m", ramp(12, 1e-9)));
    let mut results = results(axes.to_vec(), false);
    (results.other_branch, results.waveforms) = (None, None);
    results.variables.truncate(1);
    results.status.fill(5);
    results.variables[0].data.fill(f64::NAN);
    results.attributes.push(("complete".into(), Attribute::Number(0.0)));
    let told = findings(&results, &ViewRequest::default());
    assert_eq!(told[0], "Incomplete: 0 of 1,728 instances are done.");
    let report = Report::of(&results);
    report.check();
    let page = report.text("index.html");
    assert!(page.contains("Not drawn: The amplitude: no instance has a value: not run (1728)."), "{page}");
    assert!(!page.contains("amplitude.svg"), "{page}");
    // One slice is done: the panel is of that one, and the key says what became of the rest.
    for i in 7 * 144..8 * 144 {
        results.status[i] = if i % 2 == 0 { 0 } else { 7 };
        results.variables[0].data[i] = if i % 2 == 0 { i as f64 * 1e-12 } else { f64::NAN };
    }
    let words = Report::of(&results).words("amplitude.svg");
    assert!(words.lines().any(|line| line == "the a_0 7.5 nm"), "{words}");
    assert!(words.lines().any(|line| line == "no set-point (72)"), "{words}");
}

/// Truth: the texts put in; a spreadsheet runs what begins with one of these signs.
#[test]
fn spreadsheets_find_no_formulas() {
    let labels = ["=cmd|' /C calc'!A0", "+1+1", "-1e-9", "@sum", "PS"];
    let material = Coordinate {
        words: labels.map(str::to_owned).to_vec(),
        columns: vec![coordinate("youngs_modulus", "Pa", vec![1e9; 5])],
        ..coordinate("material", "", (0..5).map(f64::from).collect())
    };
    let mut results = results(vec![material], false);
    results.status.fill(0);
    let csv = Report::of(&results).text("amplitude.csv");
    let cells: Vec<&str> = csv.lines().skip(1).map(|row| row.split(',').nth(1).unwrap()).collect();
    assert_eq!(cells, ["'=cmd|' /C calc'!A0", "'+1+1", "-1e-9", "'@sum", "PS"]);
}

/// Truth: 40 samples at each of nine gaps, whose values are those of the gap times 1 to 40.
#[test]
fn samples_become_bands_and_no_map_over_their_numbers() {
    let samples = Coordinate {
        scene_path: "samples".into(),
        ..coordinate("sample", "1", (0..40).map(f64::from).collect())
    };
    let gap = coordinate("approach_gap", "m", ramp(9, 1e-9));
    let mut results = results(vec![samples, gap], false);
    (results.other_branch, results.waveforms) = (None, None);
    results.status.fill(0);
    results.variables =
        vec![variable("amplitude", "m", None, (0..360).map(|i| (i / 9 + 1) as f64 * 1e-9).collect())];
    let report = Report::of(&results);
    report.check();
    let page = report.text("index.html");
    assert!(page.contains("amplitude_band.svg") && !page.contains("amplitude.svg"), "{page}");
    let words = report.words("amplitude_band.svg");
    for line in ["median", "25 to 75 %", "5 to 95 %"] {
        assert!(words.lines().any(|word| word == line), "{line}: {words}");
    }
    assert!(report.text("amplitude_band.svg").matches("<polygon").count() >= 2);
    let csv = report.text("amplitude_band.csv");
    let row: Vec<f64> =
        csv.lines().nth(1).unwrap().split(',').skip(2).map(|cell| cell.parse().unwrap()).collect();
    let expected = [2.95e-9, 10.75e-9, 20.5e-9, 30.25e-9, 38.05e-9];
    assert!(row.iter().zip(expected).all(|(a, b)| (a / b - 1.0).abs() < 1e-12), "{row:?}");
}

#[test]
fn a_single_case_is_a_list_with_sticks_for_its_harmonics() {
    let report = Report::of(&scalar());
    let page = report.text("index.html");
    assert!(page.contains("<th>observable</th><th>name</th><th>value</th></tr>"), "{page}");
    assert!(!page.contains("median"), "{page}");
    // Three upright lines.
    let svg = report.text("harmonic_amplitude.svg");
    assert_eq!(svg.matches("stroke-width=\"24\"").count(), 3, "{svg}");
}

#[test]
fn warnings_on_the_page_carry_their_cure() {
    let mut results = grid();
    results.flags[1].meanings[0] = "between_laws".into();
    let page = Report::of(&results).text("index.html");
    assert!(page.contains("run the other law as well"), "{page}");
}

#[test]
fn the_page_says_that_instances_carry_warnings() {
    let results = Results { status: vec![0; 12], ..grid() };
    let page = Report::of(&results).text("index.html");
    // Bits are set in three of four instances.
    assert!(page.contains("All 12 instances are ok") && page.contains("9 of 12 carry a warning"), "{page}");
}
