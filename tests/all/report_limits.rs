//! The report: what is left within a reader's limits, lines at round values, curves that are asked for.
//! Truth: the data put in.

use crate::common::{coordinate, results, variable};
use crate::report_pages::{Report, save};
use afmsweep::report::{self, ReportError, ViewRequest};
use afmsweep::store::{Coordinate, Flags, Results};

/// Amplitude and largest force over these axes: instance i has i nm and 2 i nN.
fn tapping(axes: Vec<Coordinate>) -> Results {
    let mut results = results(axes, false);
    let count = results.status.len();
    let data = |step: f64| (0..count).map(|i| i as f64 * step).collect::<Vec<f64>>();
    results.variables =
        vec![variable("amplitude", "m", None, data(1e-9)), variable("force_max", "N", None, data(2e-9))];
    results.variables.iter_mut().for_each(|one| one.long_name.clone_from(&one.name));
    results.status.fill(0);
    (results.other_branch, results.waveforms) = (None, None);
    results.force_curves.clear();
    results
}

fn axis(name: &str, count: usize) -> Coordinate {
    let values = (0..count).map(|i| (i + 1) as f64 * 1e-9).collect();
    Coordinate { long_name: name.into(), ..coordinate(name, "m", values) }
}

fn named(words: &[&str]) -> Coordinate {
    let values = (0..words.len()).map(|i| i as f64).collect();
    let columns = vec![coordinate("youngs_modulus", "Pa", vec![1e9; words.len()])];
    let words = words.iter().map(|word| (*word).to_owned()).collect();
    Coordinate { long_name: "material".into(), words, columns, ..coordinate("material", "", values) }
}

fn pairs(limits: &[(&str, &str)]) -> Vec<(String, String)> {
    limits.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect()
}

fn drawn(results: &Results, wish: &ViewRequest) -> (Report, Result<report::Report, ReportError>) {
    let report = Report::of(results);
    let written = report::write(&save(report.home.path(), results), Some(&report.folder), wish);
    (report, written)
}

/// Truth: by hand: of 12 instances those with at most 8 nN are the first five; the best of them has 4 nm.
#[test]
fn what_is_outside_the_limits_stands_back_and_what_is_left_is_told() {
    let results = tapping(vec![named(&["PS", "PMMA"]), axis("gap", 6)]);
    let wish = ViewRequest { below: pairs(&[("force_max", "9 nN")]), ..ViewRequest::default() };
    let (report, written) = drawn(&results, &wish);
    let written = written.unwrap();
    report.check();
    assert_eq!(
        written.findings[0],
        "Largest amplitude with force_max below 9 nN: 4 nm at gap 5 nm (material PS); 5 of 12 instances are left, \
         at PS, gap 1 nm to 5 nm."
    );
    let kept = written.kept.unwrap();
    let best = kept.best.unwrap();
    assert_eq!((kept.instances, kept.of, best.observable.as_str(), best.instance), (5, 12, "amplitude", 4));
    for name in ["amplitude.svg", "force_max.svg"] {
        let words = report.words(name);
        assert!(words.lines().any(|line| line == "outside the limits asked for (7)"), "{words}");
        assert!(report.text(name).contains("#CACACA"), "{name} greys nothing");
    }
    let csv = report.text("amplitude.csv");
    assert_eq!(csv.matches(",outside_limits\n").count(), 7);

    // Limits join; above alone asks for the smallest of the others.
    let wish = ViewRequest { above: pairs(&[("amplitude", "3.5 nm")]), ..wish };
    assert_eq!(drawn(&results, &wish).1.unwrap().kept.unwrap().instances, 1);
    let wish = ViewRequest { above: pairs(&[("amplitude", "3.5 nm")]), ..ViewRequest::default() };
    let told = drawn(&results, &wish).1.unwrap();
    assert!(told.findings[0].starts_with("Smallest force_max with amplitude above 3.5 nm: 8 nN at gap 5 nm"));
    let wish = ViewRequest { below: pairs(&[("amplitude", "-1 nm")]), ..ViewRequest::default() };
    let told = drawn(&results, &wish).1.unwrap();
    assert_eq!(told.findings[0], "None of 12 instances has amplitude below −1 nm.");
    assert!(told.left_out[0].contains("outside the limits asked for (12)"), "{:?}", told.left_out);
}

#[test]
fn limits_of_unknown_names_and_without_units_are_refused() {
    let results = tapping(vec![axis("gap", 6)]);
    for (limit, words) in [
        (
            ("forcemax", "5nN"),
            "--below forcemax: expected one of amplitude, force_max; did you mean force_max?",
        ),
        (("force_max", "5"), "--below force_max=5: expected a value with its unit, such as force_max=3nN"),
        (("force_max", "5 nm"), "expected a value with its unit"),
    ] {
        let wish = ViewRequest { below: pairs(&[limit]), ..ViewRequest::default() };
        let error = drawn(&results, &wish).1.unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

/// Truth: the plane put in: round values between its ends stand on lines, in shapes and in images.
#[test]
fn maps_have_lines_at_round_values() {
    for count in [15, 60] {
        let mut results = tapping(vec![axis("gap", count), axis("radius", count)]);
        let most = (2 * count - 2) as f64;
        let plane = |i: usize| (i / count + i % count) as f64 * 100e-9 / most + 1e-12;
        results.variables[0].data = (0..count * count).map(plane).collect();
        results.variables.truncate(1);
        let report = Report::of(&results);
        report.check();
        let words = report.words("amplitude.svg");
        for label in ["20 nm", "40 nm", "60 nm", "80 nm"] {
            assert!(words.lines().any(|line| line == label), "{count}, {label}: {words}");
        }
        assert_eq!(report.text("amplitude.svg").contains("<image"), count == 60);
        // Whole numbers have nothing between them.
        results.variables =
            vec![variable("contacts", "1", None, (0..count * count).map(|i| i as f64).collect())];
        let words = Report::of(&results).words("contacts.svg");
        let round = if count == 15 { "100" } else { "1000" };
        assert_eq!(words.lines().filter(|line| *line == round).count(), 1, "{words}");
    }
}

/// Truth: the cells without a value lie as a shape behind the image, so that they follow a page's colours.
#[test]
fn cells_without_a_value_are_clear_in_images() {
    let mut results = tapping(vec![axis("gap", 60), axis("radius", 60)]);
    results.variables[0].data[100..1000].fill(f64::NAN);
    let svg = Report::of(&results).text("amplitude.svg");
    let before = svg.split_once("<image").unwrap().0;
    assert!(before.trim_end().lines().last().unwrap().contains("#E4E4E4"), "{before}");
}

/// Truth: nine values are curves, ten are refused.
#[test]
fn the_axis_of_the_curves_can_be_chosen() {
    let names: Vec<String> = (0..10).map(|i| format!("m{i}")).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let wish = |curves: &str| ViewRequest { curves: Some(curves.into()), ..ViewRequest::default() };
    let results = tapping(vec![axis("gap", 9), axis("radius", 20), axis("force", 3)]);
    let (report, written) = drawn(&results, &wish("gap"));
    written.unwrap();
    let words = report.words("amplitude.svg");
    for line in ["gap 1 nm", "9 nm", "force 2 nm", "radius (nm)"] {
        assert!(words.lines().any(|word| word == line), "{line}: {words}");
    }
    let results = tapping(vec![named(&names[..9]), axis("gap", 12)]);
    let (report, _) = drawn(&results, &wish("material"));
    assert!(report.words("amplitude.svg").lines().any(|word| word == "m8"));
    let results = tapping(vec![named(&names), axis("gap", 12)]);
    for (curves, words) in [
        ("material", "--curves material: expected an axis of at most 9 values; this one has 10"),
        ("materiel", "--curves materiel: expected one of scene.material, scene.gap"),
    ] {
        let error = drawn(&results, &wish(curves)).1.unwrap_err().to_string();
        assert!(error.starts_with(words), "{error}");
    }
    let both = ViewRequest { y: Some("gap".into()), ..wish("gap") };
    assert!(drawn(&tapping(vec![axis("gap", 5), axis("radius", 6)]), &both).1.is_err());
}

/// The lines of curves as places in tenths of pixels, with their colours.
fn lines(svg: &str) -> Vec<(String, Vec<f64>)> {
    let document = roxmltree::Document::parse(svg).unwrap();
    let curves = document
        .descendants()
        .filter(|node| node.has_tag_name("polyline") && node.attribute("stroke-width") == Some("18"));
    let places = |points: &str| {
        points.split_whitespace().map(|at| at.split_once(',').unwrap().0.parse().unwrap()).collect()
    };
    curves
        .map(|node| (node.attribute("stroke").unwrap().into(), places(node.attribute("points").unwrap())))
        .collect()
}

/// Truth: the branches and the jump put in: ten points on the first branch, then ten of which the sixth was jumped to.
#[test]
fn no_line_leads_across_a_change_of_branch_or_a_jump() {
    let mut results = tapping(vec![axis("gap", 20)]);
    let flag = |name: &str, meanings: [&str; 3], data: Vec<u8>| Flags {
        name: name.into(),
        long_name: name.into(),
        meanings: meanings.map(str::to_owned).to_vec(),
        bits: false,
        data,
    };
    let branch = (0..20).map(|i| if i < 10 { 1 } else { 2 }).collect();
    let jump = (0..20).map(|i| u8::from(i == 15)).collect();
    results.flags = vec![
        flag("branch", ["none", "attractive", "repulsive"], branch),
        flag("jump", ["no", "yes", "never"], jump),
    ];
    let report = Report::of(&results);
    report.check();
    let found = lines(&report.text("amplitude.svg"));
    let lengths: Vec<usize> = found.iter().map(|one| one.1.len()).collect();
    assert_eq!(lengths, [10, 5, 5], "{found:?}");
    assert!(found[0].0 != found[1].0 && found[1].0 == found[2].0, "{found:?}");
    let words = report.words("amplitude.svg");
    assert!(words.contains("attractive") && words.contains("repulsive"), "{words}");
}

/// Truth: the names put in.
#[test]
fn names_are_ticks_without_lines_and_not_to_the_right_of_numbers() {
    let results = tapping(vec![named(&["LDPE", "PS", "PMMA", "Mica", "Gold"])]);
    let report = Report::of(&results);
    report.check();
    let words = report.words("amplitude.svg");
    for name in ["LDPE", "Gold", "material"] {
        assert!(words.lines().any(|line| line == name), "{name}: {words}");
    }
    assert_eq!(lines(&report.text("amplitude.svg")), []);
    // Fewer numbers than names.
    let results = tapping(vec![axis("gap", 2), named(&["a", "b", "c", "d"])]);
    let words = Report::of(&results).words("amplitude.svg");
    assert!(words.lines().any(|line| line == "gap (nm)") && words.contains("material a"), "{words}");
}
