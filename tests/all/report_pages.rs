//! The report: every variable has a picture, pictures and page are well-formed and say what they show.
//! Truth: an XML parser, and the data put in.

use crate::common::{SCENE, coordinate, grid, list, ramp, results, scalar, variable};
use afmsweep::report::{self, ReportError, ViewRequest};
use afmsweep::store::{Attribute, Results, Writer};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A folder with the results file and its report.
pub struct Report {
    pub home: tempfile::TempDir,
    pub folder: PathBuf,
}

impl Report {
    pub fn of(results: &Results) -> Self {
        let home = tempfile::tempdir().unwrap();
        let file = save(home.path(), results);
        let folder = report::write(&file, None, &ViewRequest::default()).unwrap().folder;
        assert_eq!(folder, home.path().join("a"));
        Self { home, folder }
    }

    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.folder.join(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    fn pictures(&self) -> Vec<String> {
        let names = fs::read_dir(&self.folder).unwrap().map(|entry| entry.unwrap().file_name());
        let mut names: Vec<String> = names.map(|name| name.into_string().unwrap()).collect();
        names.retain(|name| name.ends_with(".svg"));
        names.sort();
        names
    }

    /// Checks all files, and that the page shows each picture.
    pub fn check(&self) {
        let page = self.text("index.html");
        let markdown = self.text("report.md");
        well_formed(&page, "index.html");
        for name in self.pictures() {
            let svg = self.text(&name);
            well_formed(&svg, &name);
            inside(&svg, &name);
            assert!(page.contains(&svg), "{name} is not in the page");
            assert!(markdown.contains(&format!("]({name})")), "{name} is not in report.md");
        }
    }

    /// All words of a picture.
    pub fn words(&self, name: &str) -> String {
        let svg = self.text(name);
        let document = roxmltree::Document::parse(&svg).unwrap();
        let texts = document
            .descendants()
            .filter(|node| node.is_text())
            .filter_map(|node| node.text())
            .map(str::trim);
        texts.filter(|text| !text.is_empty()).collect::<Vec<_>>().join("\n")
    }
}

pub fn save(folder: &Path, results: &Results) -> PathBuf {
    let path = folder.join("a.h5");
    let mut writer = Writer::create(&path, SCENE, true).unwrap();
    writer.write(results).unwrap();
    writer.finish().unwrap();
    path
}

#[track_caller]
fn well_formed(text: &str, name: &str) {
    let options = roxmltree::ParsingOptions { allow_dtd: true, ..Default::default() };
    if let Err(error) = roxmltree::Document::parse_with_options(text, options) {
        panic!("{name}: {error}");
    }
    for word in ["NaN", "inf"] {
        assert!(!text.contains(&format!("\"{word}\"")), "{name} has a coordinate {word}");
    }
}

/// No text begins outside the picture, and no box or dot stands there.
#[track_caller]
fn inside(svg: &str, name: &str) {
    let document = roxmltree::Document::parse(svg).unwrap();
    let view: Vec<f64> =
        document.root_element().attribute("viewBox").unwrap().split(' ').map(number).collect();
    for node in document.descendants() {
        for (attributes, limit) in [(["x", "cx"], view[2]), (["y", "cy"], view[3])] {
            for value in attributes.into_iter().filter_map(|attribute| node.attribute(attribute)).map(number)
            {
                assert!((-1.0..=limit + 1.0).contains(&value), "{name}: {node:?} is outside {view:?}");
            }
        }
    }
}

pub fn number(text: &str) -> f64 {
    text.parse().unwrap_or_else(|_| panic!("{text} is no number"))
}

/// A cube whose fastest axes are those of [`grid`].
pub fn cube(slow: &[usize]) -> Results {
    let mut axes: Vec<_> = slow
        .iter()
        .enumerate()
        .map(|(i, &n)| coordinate(&format!("approach_gap_{i}"), "m", ramp(n, 1e-9)))
        .collect();
    axes.extend(grid().axes);
    results(axes, false)
}

#[test]
fn every_variable_of_every_layout_has_a_picture() {
    let one = results(vec![coordinate("tip_radius", "m", ramp(9, 1e-9))], false);
    for results in [one, grid(), cube(&[9]), cube(&[3, 5]), cube(&[2, 2, 3]), list()] {
        let report = Report::of(&results);
        report.check();
        for variable in &results.variables {
            let words = report.words(&format!("{}.svg", variable.name));
            assert!(words.contains(&variable.long_name), "{}: {words}", variable.name);
        }
        assert_eq!(report.pictures().len(), results.variables.len() + 2, "{:?}", report.pictures());
    }
}

#[test]
fn a_single_case_has_its_values_in_the_table() {
    let report = Report::of(&scalar());
    report.check();
    assert_eq!(report.pictures(), ["force_curve_0.svg", "harmonic_amplitude.svg", "waveform_0.svg"]);
    let page = report.text("index.html");
    assert!(page.contains("<td>500 pm</td>") && page.contains("<td>0.125°</td>"), "{page}");
}

#[test]
fn axes_carry_readable_units() {
    let report = Report::of(&grid());
    let words = report.words("amplitude.svg");
    for expected in ["10 GPa", "the tip_radius (nm)", "the amplitude (nm)"] {
        assert!(words.lines().any(|line| line == expected), "{expected}: {words}");
    }
    let words = report.words("waveform_11.svg");
    for expected in ["time (ns)", "travel (nm)", "indentation (pm)", "force on the tip (pN)", "in contact"] {
        assert!(words.lines().any(|line| line == expected), "{expected}: {words}");
    }
    let words = report.words("force_curve_11.svg");
    for expected in ["jkr, approach", "jkr, retract", "force on the tip (pN)"] {
        assert!(words.lines().any(|line| line == expected), "{expected}: {words}");
    }
    assert!(
        words.contains("the sample_youngs_modulus 10 GPa, the tip_radius 40 nm"),
        "the swept values of instance 11: {words}"
    );
}

#[test]
fn failed_and_doubtful_instances_are_marked_and_counted() {
    let mut results = grid();
    results.status = vec![0, 0, 0, 1, 2, 3, 4, 5, 0, 0, 0, 0];
    results.variables[0].data[8] = f64::NAN;
    let report = Report::of(&results);
    let words = report.words("amplitude.svg");
    for expected in [
        "non finite (1), out of range (1), not run (1)",
        "not steady (1), sensitive (1)",
        "no value, nothing failed (1)",
    ] {
        assert!(words.lines().any(|line| line == expected), "{expected}: {words}");
    }
    let words = report.words("phase.svg");
    assert!(!words.contains("no value"), "{words}");
    let page = report.text("index.html");
    assert!(page.contains(
        "7 of 12 instances are ok (1 not steady, 1 sensitive, 1 non finite, 1 out of range, 1 not run)"
    ));
    // Eight of twelve amplitudes remain.
    assert!(page.contains("<td>8</td><td>4</td>"), "{page}");
    let words = Report::of(&Results { status: vec![0; 12], ..grid() }).words("amplitude.svg");
    assert!(!words.contains("not run") && !words.contains("steady"), "{words}");
}

#[test]
fn smallest_median_and_largest_are_those_of_the_data() {
    let mut results = grid();
    results.status = vec![0; 12];
    results.variables[0].data = vec![9.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 0.5, 10.0, f64::NAN]
        .into_iter()
        .map(|v| v * 1e-9)
        .collect();
    let page = Report::of(&results).text("index.html");
    assert!(page.contains("<td>500 pm</td><td>5 nm</td><td>10 nm</td><td>11</td><td>1</td>"), "{page}");
}

#[test]
fn text_of_the_file_is_escaped_everywhere() {
    let nasty = "<script>alert(\"&'\")</script>";
    let mut results = grid();
    results.title = nasty.into();
    results.axes[0].long_name = nasty.into();
    results.variables[0].long_name = nasty.into();
    results.variables[1].units = "<b>&".into();
    results.force_curves[0].law = "<i>&\"".into();
    results.attributes.extend(
        ["device", "scene_resolved", "<b>"]
            .map(|name| (format!("{name}_2"), Attribute::Text(format!("{nasty}\n{nasty}")))),
    );
    let report = Report::of(&results);
    report.check();
    let page = report.text("index.html");
    assert!(!page.contains("<script>alert") && !page.contains("<b>"), "unescaped text in the page");
    assert!(page.contains("&lt;script&gt;"));
    assert!(!report.text("report.md").lines().any(|line| line.starts_with("<script")));
}

#[test]
fn data_that_cannot_be_shown_still_makes_a_report() {
    for mut results in
        [grid(), list(), cube(&[3]), scalar(), results(vec![coordinate("a", "m", ramp(5, 1.0))], false)]
    {
        for fill in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e308, 5e-324] {
            for variable in &mut results.variables {
                variable.data.fill(fill);
            }
            if let Some(waveforms) = &mut results.waveforms {
                waveforms.force[0].fill(fill);
                waveforms.tip_travel[0].fill(fill);
            }
            results.force_curves[0].force.fill(fill);
            Report::of(&results).check();
        }
    }
}

#[test]
fn axes_of_one_value_equal_values_and_no_finite_value_are_drawn() {
    for values in
        [vec![1e-9], vec![0.0], vec![2.0, 2.0], vec![f64::NAN, 1.0], vec![3.0, 1.0, 2.0], vec![-1e308, 1e308]]
    {
        let one = coordinate("a_x", "m", values);
        let other = coordinate("a_y", "Pa", ramp(2, 1.0));
        Report::of(&results(vec![one.clone()], false)).check();
        Report::of(&results(vec![one.clone(), other.clone()], false)).check();
        Report::of(&results(vec![other, one.clone()], false)).check();
        Report::of(&results(vec![one], true)).check();
    }
}

#[test]
fn a_large_grid_makes_pictures_of_bounded_size() {
    let axes = vec![coordinate("a_x", "m", ramp(700, 1e-9)), coordinate("a_y", "m", ramp(900, 1e-9))];
    let mut results = results(axes, false);
    results.variables.truncate(1);
    let report = Report::of(&results);
    report.check();
    let svg = report.text("amplitude.svg");
    assert!(svg.len() < 2_500_000, "{} bytes", svg.len());
    assert!(svg.contains("each cell is the mean"));
}

#[test]
fn names_that_are_no_file_names_stay_inside_the_folder() {
    let mut results = grid();
    results.variables = vec![variable("..\\x:y", "m", None, ramp(12, 1e-9))];
    let report = Report::of(&results);
    report.check();
    assert!(report.pictures().contains(&"___x_y.svg".to_owned()), "{:?}", report.pictures());
}

#[test]
fn only_an_empty_folder_or_a_report_is_written_to() {
    let home = tempfile::tempdir().unwrap();
    let file = save(home.path(), &grid());
    let taken = home.path().join("taken");
    fs::create_dir(&taken).unwrap();
    report::write(&file, Some(&taken), &ViewRequest::default()).unwrap();
    report::write(&file, Some(&taken), &ViewRequest::default()).unwrap();
    for page in [None, Some("<html>mine</html>")] {
        let other = tempfile::tempdir().unwrap();
        fs::write(other.path().join(page.map_or("notes.txt", |_| "index.html")), page.unwrap_or("mine"))
            .unwrap();
        let error = report::write(&file, Some(other.path()), &ViewRequest::default()).unwrap_err();
        assert!(matches!(error, ReportError::Occupied { .. }), "{error}");
        assert_eq!(fs::read_dir(other.path()).unwrap().count(), 1);
    }
    assert!(matches!(
        report::write(&file, Some(&file), &ViewRequest::default()),
        Err(ReportError::NotAFolder { .. })
    ));
    let bare = home.path().join("bare");
    fs::copy(&file, &bare).unwrap();
    assert_eq!(
        report::write(&bare, None, &ViewRequest::default()).unwrap().folder,
        home.path().join("bare.report")
    );
}

#[test]
fn the_command_says_where_the_report_is_and_what_is_wrong_with_a_file() {
    let home = tempfile::tempdir().unwrap();
    let file = save(home.path(), &grid());
    let run = |arguments: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_afmsweep"));
        command.arg("report").args(arguments).current_dir(home.path()).output().unwrap()
    };
    let output = run(&["a.h5", "-o", "pages"]);
    assert!(output.status.success() && output.stdout.is_empty(), "{output:?}");
    assert!(String::from_utf8_lossy(&output.stderr).contains("index.html"), "{output:?}");
    assert!(home.path().join("pages/index.html").exists());

    let whole = fs::read(&file).unwrap();
    fs::write(&file, &whole[..whole.len() / 2]).unwrap();
    let output = run(&["a.h5"]);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(!output.status.success() && message.contains("damaged"), "{message}");
    // The HDF5 library would print its own pages of errors.
    assert!(!message.contains("HDF5-DIAG") && message.lines().count() == 1, "{message}");
    assert!(!home.path().join("a").exists(), "no folder is left behind");
    let output = run(&["missing.h5"]);
    assert!(String::from_utf8_lossy(&output.stderr).contains("missing.h5: no such file"), "{output:?}");
}

/// Truth: the scale and the estimate put in. What is below their product is nothing, and is not drawn as a result.
#[test]
fn what_is_below_its_error_is_drawn_as_nothing() {
    let mut results = grid();
    results.status = vec![0; 12];
    results.variables.retain(|one| one.name != "error_estimate");
    let (scale, estimate) = (7e-17, 1e-4);
    let rounding = |i: usize| if i.is_multiple_of(2) { 6e-22 } else { -4e-22 };
    results.variables.push(variable("dissipation", "J", None, (0..12).map(rounding).collect()));
    results.variables.push(variable("drive_work", "J", None, vec![scale; 12]));
    results.variables.push(variable("error_estimate", "1", None, vec![estimate; 12]));
    results.variables.push(variable("tabor_parameter", "1", None, vec![2.25; 12]));
    let report = Report::of(&results);
    report.check();
    let pictures = report.pictures();
    for name in ["dissipation.svg", "tabor_parameter.svg", "drive_work.svg"] {
        assert!(!pictures.contains(&name.to_owned()), "{name}: {pictures:?}");
    }
    for page in ["index.html", "report.md"] {
        let text = report.text(page).replace('\\', "");
        for line in [
            "Not drawn: The dissipation: 0 within its error in all 12 instances",
            "Not drawn: The tabor_parameter: the same in all 12 instances that have a value, 2.25.",
            "0 within error",
        ] {
            assert!(text.contains(line), "{page}, {line}: {text}");
        }
    }

    // A third of them is a loss that counts.
    let place = results.variables.iter().position(|one| one.name == "dissipation").unwrap();
    results.variables[place].data[8..].copy_from_slice(&[1e-18, 2e-18, 3e-18, 4e-18]);
    let report = Report::of(&results);
    report.check();
    let words = report.words("dissipation.svg");
    assert!(words.lines().any(|line| line == "0 within error (8)"), "{words}");
    assert!(!words.contains('−'), "no tick below zero: {words}");
    assert!(report.text("index.html").contains("<td>0 within error</td>"));

    // Without an estimate the accuracy asked for counts.
    results.variables.retain(|one| one.name != "error_estimate");
    let scene = "[run]\naccuracy = 1e-4\n".to_owned();
    results.provenance.push(("scene_resolved".into(), scene));
    let words = Report::of(&results).words("dissipation.svg");
    assert!(words.lines().any(|line| line == "0 within error (8)"), "{words}");
}

#[test]
fn panels_share_one_short_label_of_their_axis() {
    let mut results = cube(&[4]);
    let gap = &mut results.axes[2];
    gap.name = "approach_gap".into();
    gap.long_name = "gap between the tip at rest and the surface".into();
    let report = Report::of(&results);
    report.check();
    let words = report.words("amplitude.svg");
    assert_eq!(words.lines().filter(|line| *line == "gap (nm)").count(), 1, "{words}");
    assert!(!words.contains("at rest"), "{words}");
    assert!(report.text("index.html").contains("gap between the tip at rest and the surface"));
}

/// Looked at in Chromium at 400 pixels: labels and keys of pictures were cut, and nothing said that there was more beside.
#[test]
fn narrow_pages_shrink_pictures_a_little_and_show_that_they_scroll() {
    let page = Report::of(&grid()).text("index.html");
    let style =
        page.split_once("<style>").and_then(|(_, rest)| rest.split_once("</style>")).expect("a style").0;
    for rule in [
        "@media(max-width:640px){figure svg,figure img{max-width:max(100%,29rem)}",
        ".wide{overflow-x:auto}",
        ".wide::-webkit-scrollbar{height:",
    ] {
        assert!(style.contains(rule), "{rule}");
    }
    assert_eq!(page.matches("<div class=\"wide\"><svg").count(), page.matches("<svg").count());
}
