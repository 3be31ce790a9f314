//! Uncertainty studies as a user makes them: `sample`, `run`, `stats`, `export`, `infer`, and what they refuse.
//! Truth: the same points run as a grid, as a list and with other threads; the results file itself.

use crate::program::{Desk, numbers, variable};

const LEVER: &str = r#"
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
[approach]
gap = "15 nm"
[run]
steady = "search"
[output]
observables = ["amplitude", "phase", "force_max"]
"#;

const UNCERTAIN: &str = r#"
[uncertain]
"instrument.cantilever.stiffness" = { distribution = "normal", mean = "10 N/m", sd = "5 %" }
"sample.youngs_modulus" = { distribution = "loguniform", from = "1 GPa", to = "4 GPa" }
"#;

fn design(kind: &str, samples: usize, more: &str) -> String {
    format!("{LEVER}{UNCERTAIN}[design]\nkind = \"{kind}\"\nsamples = {samples}\n{more}\n")
}

#[test]
fn a_table_of_points_gives_the_bits_of_their_grid() {
    let desk = Desk::new();
    let grid = format!(
        "{LEVER}[sweep]\n\"instrument.cantilever.stiffness\" = {{ values = [\"9.7 N/m\", \"10.3 N/m\"] }}\n\
         \"sample.youngs_modulus\" = {{ values = [\"1.3 GPa\", \"2 GPa\", \"3.7 GPa\"] }}\n"
    );
    let grid = desk.run(&desk.write("grid.toml", &grid), &[]);
    let mut rows = "id,sample.youngs_modulus [GPa],instrument.cantilever.stiffness [N/m]\n".to_owned();
    for stiffness in ["9.7", "10.3"] {
        for modulus in ["1.3", "2", "3.7"] {
            rows += &format!("{stiffness}/{modulus},{modulus},{stiffness}\n");
        }
    }
    desk.write("points.csv", &rows);
    let scene = format!("{LEVER}[design]\nkind = \"table\"\nfile = \"points.csv\"\n");
    let table = desk.run(&desk.write("table.toml", &scene), &[]);
    assert_eq!(table.axes[0].words[4], "10.3/2");
    for name in ["amplitude", "phase", "force_max", "error_estimate"] {
        let bits = |all: &[f64]| all.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(variable(&table, name)), bits(variable(&grid, name)), "{name}");
    }
    assert_eq!(table.status, grid.status);
    // The same as a list, and in plain columns of SI numbers.
    desk.write(
        "rows.csv",
        &rows.lines().map(|row| row.split_once(',').unwrap().1.to_owned() + "\n").collect::<String>(),
    );
    let list = desk.run(&desk.write("list.toml", &format!("{LEVER}[samples]\nfile = \"rows.csv\"\n")), &[]);
    assert!(list.list && variable(&list, "phase") == variable(&grid, "phase"));
    assert!(!list.text("scene_resolved").unwrap().contains("9.7"), "rows are repeated in the scene");
    let plain: String = ["9.7", "10.3"]
        .iter()
        .flat_map(|k| ["1.3e9", "2e9", "3.7e9"].map(|e| format!("{e} {k}\n")))
        .collect();
    desk.write("plain.txt", &plain);
    let names = "names = [\"sample.youngs_modulus\", \"instrument.cantilever.stiffness\"]";
    let scene = format!("{LEVER}[design]\nkind = \"table\"\nfile = \"plain.txt\"\n{names}\n");
    let plain = desk.run(&desk.write("plain.toml", &scene), &[]);
    assert_eq!(variable(&plain, "phase"), variable(&grid, "phase"));
    // And told on the command line.
    let names = "sample.youngs_modulus, instrument.cantilever.stiffness";
    let told = desk.run(&desk.write("told.toml", LEVER), &["--table", "plain.txt", "--names", names]);
    assert_eq!(variable(&told, "phase"), variable(&grid, "phase"));
    assert!(told.text("scene").unwrap().contains("plain.txt\"\nnames = ["));
    let said = desk.call(&["plan", "table.toml", "--table", "plain.txt"]);
    assert!(said.code == Some(1) && said.err.contains("duplicate"), "{}", said.err);
}

#[test]
fn points_do_not_depend_on_threads_and_survive_their_csv() {
    let desk = Desk::new();
    let scene = desk.write("study.toml", &design("sobol", 32, "replicates = 2"));
    let one = desk.run(&scene, &["--threads", "1"]);
    let two = desk.run(&scene, &["--threads", "2", "--overwrite"]);
    assert_eq!(one.axes, two.axes);
    assert_eq!(variable(&one, "amplitude"), variable(&two, "amplitude"));
    // Its report is that of a list: scatter over both quantities.
    desk.works(&["report", "results/study.h5", "-o", "report", "-q"]);
    let page = std::fs::read_to_string(desk.path("report/index.html")).unwrap();
    assert!(page.contains("lever stiffness, first mode") && page.len() < 200_000, "{} bytes", page.len());
    desk.works(&["sample", "study.toml", "-o", "points.csv", "-q"]);
    assert_eq!(
        desk.works(&["sample", "study.toml"]).out,
        std::fs::read_to_string(desk.path("points.csv")).unwrap()
    );
    let scene = format!("{LEVER}[design]\nkind = \"table\"\nfile = \"points.csv\"\n");
    let table = desk.run(&desk.write("table.toml", &scene), &[]);
    assert_eq!(table.axes[0].columns, one.axes[0].columns);
    assert_eq!(variable(&table, "amplitude"), variable(&one, "amplitude"));
}

#[test]
fn a_design_over_a_sweep_has_statistics_at_every_point() {
    let desk = Desk::new();
    let sweep = "[sweep]\n\"approach.gap\" = { values = [\"14 nm\", \"16 nm\"] }\n";
    let text = design("latin-hypercube", 64, sweep).replace("[approach]\ngap = \"15 nm\"\n", "");
    let results = desk.run(&desk.write("bands.toml", &text), &[]);
    assert_eq!(results.shape(), [2, 64]);
    let told = desk.json(&["stats", "results/bands.h5", "--json"]);
    let points = told["points"].as_array().unwrap();
    assert_eq!(points.len(), 2);
    for (n, point) in points.iter().enumerate() {
        let values = &variable(&results, "amplitude")[64 * n..64 * (n + 1)];
        let mean = values.iter().sum::<f64>() / 64.0;
        let amplitude = &point["observables"]["amplitude"];
        assert!((amplitude["mean"].as_f64().unwrap() / mean - 1.0).abs() < 1e-14);
        assert_eq!(point["at"]["approach_gap"].as_f64().unwrap(), [1.4e-8, 1.6e-8][n]);
        assert_eq!(numbers(&amplitude["S1"]).len(), 2);
        assert_eq!(amplitude["count"], 64);
    }
    // Pictures: bands over the gap, and each point's distributions, indices and scatter.
    desk.works(&["stats", "results/bands.h5", "-o", "page", "-q"]);
    let page = std::fs::read_to_string(desk.path("page/index.html")).unwrap();
    for file in [
        "phase_bands_0.svg",
        "force_max_0_distribution.svg",
        "amplitude_1_indices.svg",
        "phase_1_sample_youngs_modulus.svg",
    ] {
        assert!(page.contains(file), "{file}");
        roxmltree::Document::parse(&std::fs::read_to_string(desk.path("page").join(file)).unwrap()).unwrap();
    }
    desk.works(&["stats", "results/bands.h5", "-o", "page", "-q"]);
    desk.write("other.txt", "mine");
    let said = desk.call(&["stats", "results/bands.h5", "-o", "."]);
    assert!(said.code == Some(1) && said.err.contains("holds other things"), "{}", said.err);
    // Two rows of a table, and where they stand.
    let csv = desk.works(&["export", "results/bands.h5", "--format", "csv"]).out;
    assert!(csv.starts_with("approach_gap [m],instrument.cantilever.stiffness [N/m],"), "{csv}");
    assert_eq!(csv.lines().count(), 1 + 128);
    let resolved = results.text("scene_resolved").unwrap();
    assert!(
        resolved.contains("[uncertain]") && resolved.contains("kind = \"latin-hypercube\""),
        "{resolved}"
    );
    assert!(resolved.len() < 3000, "{resolved}");
}

#[test]
fn a_design_of_curves_has_statistics_at_every_point_of_them() {
    let desk = Desk::new();
    let curve = "[curve]\nquantity = \"approach.gap\"\nfrom = \"16 nm\"\nto = \"15 nm\"\npoints = 3\ndirection = \"both\"\n";
    let text = design("latin-hypercube", 8, curve).replace("[approach]\ngap = \"15 nm\"\n", "");
    let results = desk.run(&desk.write("curves.toml", &text), &[]);
    assert_eq!(results.shape(), [8, 2, 3]);
    let told = desk.json(&["stats", "results/curves.h5", "--json", "--observable", "phase"]);
    let points = told["points"].as_array().unwrap();
    assert_eq!(points.len(), 6);
    let phase = variable(&results, "phase");
    for (n, point) in points.iter().enumerate() {
        let mean = (0..8).map(|row| phase[6 * row + n]).sum::<f64>() / 8.0;
        assert!(
            (point["observables"]["phase"]["mean"].as_f64().unwrap() / mean - 1.0).abs() < 1e-14,
            "{point}"
        );
        assert_eq!(point["at"]["direction"], ["forward", "backward"][n / 3]);
    }
}

#[test]
fn every_distribution_has_its_word_in_the_document() {
    let desk = Desk::new();
    desk.write("odd.toml", &design("sobol", 8, "").replace("\"normal\"", "\"gauss\""));
    let said = desk.call(&["plan", "odd.toml"]).err;
    let text = include_str!("../../docs/scene.md");
    for word in afmsweep::design::Distribution::WORDS {
        assert!(said.contains(&format!("\"{word}\"")), "{said}");
        assert!(text.contains(&format!("`\"{word}\"`")), "{word} is not told");
    }
}

#[test]
fn what_is_odd_about_a_design_is_said() {
    let desk = Desk::new();
    let text = design("sobol", 24, "").replace("sd = \"5 %\"", "sd = \"30 %\"");
    desk.write("odd.toml", &text);
    let said = desk.works(&["sample", "odd.toml"]).err;
    // The normal distribution function at -1/0.3.
    for words in [
        "odd.toml:",
        "instrument.cantilever.stiffness may have impossible values (probability 4.3e-4; possible is more than zero)",
        "design.samples = 24 in 1 replicate is no power of two each",
        "32 would be",
    ] {
        assert!(said.contains(words), "no {words:?} in {said}");
    }
}

#[test]
fn inference_tells_modulus_and_prediction() {
    let desk = Desk::new();
    let scene = desk.write("prior.toml", &design("sobol", 1024, ""));
    let results = desk.run(&scene, &[]);
    // A row that is known is what is observed.
    let (row, name) = (100, "amplitude");
    let seen = format!("amplitude={:e} m +- 20 pm", variable(&results, name)[row]);
    let told = desk.json(&["infer", "results/prior.h5", "--observed", &seen, "--json"]);
    let modulus = &told["parameters"]["sample_youngs_modulus"];
    let truth =
        results.axes[0].columns.iter().find(|one| one.name == "sample_youngs_modulus").unwrap().values[row];
    let at = |share: &str| modulus["quantiles"][share].as_f64().unwrap();
    assert!((at("0.025")..=at("0.975")).contains(&truth), "{truth:e}: {told}");
    assert!(at("0.975") - at("0.025") < 1.5e9, "{told}");
    assert!(told["effective_samples"].as_f64().unwrap() > 50.0);
    desk.works(&["infer", "results/prior.h5", "--observed", &seen, "-o", "corner", "-q"]);
    let corner = std::fs::read_to_string(desk.path("corner/corner.svg")).unwrap();
    assert!(corner.contains("sample Young") && roxmltree::Document::parse(&corner).is_ok());
    let page = std::fs::read_to_string(desk.path("corner/index.html")).unwrap();
    assert!(page.contains("<td>observed: amplitude") && page.contains("<td>sample Young"), "{page}");
    let force = variable(&results, "force_max")[row];
    let predicted = &told["predicted"]["force_max"]["quantiles"];
    assert!(predicted["0.025"].as_f64().unwrap() < force && force < predicted["0.975"].as_f64().unwrap());
    desk.refuses(
        &["infer", "results/prior.h5", "--observed", "amplitude=1 um +- 1 pm"],
        &["effective samples", "Take more samples"],
    );
    for (seen, words) in [
        ("amplitude", "no `=`"),
        ("amplitude=17 nm", "no standard deviation behind `+-`"),
        ("amplitude=17 nN +- 1 nN", "amplitude=\"14.2 nm +- 0.2 nm\""),
        ("amplitude=17 nm +- 0 nm", "not above zero"),
        ("phase=55 +- 1", "is no angle"),
        ("hight=1 nm +- 1 nm", "the file has no observable hight; it has amplitude, phase, force_max"),
    ] {
        desk.refuses(&["infer", "results/prior.h5", "--observed", seen], &[words]);
    }
    let twice = ["--observed", "amplitude=17 nm +- 1 nm", "--observed", "amplitude=16 nm +- 1 nm"];
    desk.refuses(&[&["infer", "results/prior.h5"], &twice[..]].concat(), &["gives amplitude twice"]);
}

/// Truth: the numbers of `--json`.
#[test]
fn indices_that_may_be_chance_are_said_and_no_title_is_cut() {
    let desk = Desk::new();
    let scene = desk.write("decides.toml", &design("saltelli", 64, ""));
    desk.run(&scene, &[]);
    let told = desk.json(&["stats", "results/decides.h5", "--json"]);
    let text = desk.works(&["stats", "results/decides.h5", "-o", "page", "-q"]).out;
    let page = std::fs::read_to_string(desk.path("page/index.html")).unwrap();
    let names = told["names"].as_array().unwrap();
    let (mut chance, mut sure) = (0, 0);
    for (observable, one) in told["observables"].as_object().unwrap() {
        let part = text.split("\n\n").find(|part| part.starts_with(&format!("{observable} ("))).unwrap();
        for (n, name) in names.iter().enumerate() {
            let line =
                part.lines().find(|line| line.trim_start().starts_with(name.as_str().unwrap())).unwrap();
            let number = |key: &str| one[key][n].as_f64().unwrap();
            let lost = |key: &str, conf: &str| number(key).abs() <= number(conf);
            let words: Vec<&str> = [("S1", "S1_conf"), ("ST", "ST_conf")]
                .iter()
                .filter(|(a, b)| lost(a, b))
                .map(|one| one.0)
                .collect();
            match words.is_empty() {
                true => assert!(!line.contains("zero"), "{line}"),
                false => assert!(
                    line.ends_with(&format!("{} not told apart from zero", words.join(", "))),
                    "{line}"
                ),
            }
            *(if words.is_empty() { &mut sure } else { &mut chance }) += 1;
        }
        let svg = std::fs::read_to_string(
            desk.path(&format!("page/{observable}_{}.svg", names[0].as_str().unwrap())),
        );
        assert!(!svg.unwrap().contains('…'), "{observable}");
    }
    assert!(chance > 0 && sure > 0, "{text}");
    assert!(page.contains("Not told apart from zero: ") && !page.contains('…'));
    // A heading for each observable, and the pictures in the page itself: their colours follow its own.
    assert_eq!(page.matches("<h2>").count(), told["observables"].as_object().unwrap().len());
    assert!(page.matches("<svg").count() > names.len() && !page.contains("<img"));
}

#[test]
fn files_and_words_that_do_not_serve_are_refused() {
    let desk = Desk::new();
    let scene = desk.write("single.toml", LEVER);
    desk.run(&scene, &[]);
    desk.refuses(&["stats", "results/single.h5"], &["no samples", "[uncertain]"]);
    desk.refuses(&["export", "results/single.h5", "--format", "salib"], &["no samples"]);
    desk.refuses(&["sample", "single.toml"], &["has no samples", "init --samples"]);
    desk.refuses(&["stats", "nowhere.h5"], &["no such file"]);
    // Too short a wait: nothing is steady.
    let text = design("monte-carlo", 8, "")
        .replace("steady = \"search\"", "periods = 6\nmeasure = 2\naccuracy = 1e-6");
    desk.run(&desk.write("short.toml", &text), &["--no-estimate"]);
    let said = desk.call(&["stats", "results/short.h5", "--observable", "phase"]);
    assert_eq!(said.code, Some(1));
    for words in [
        "8 of 8 rows cannot count for phase",
        "8 not_steady (the response still changes",
        "more than 5 %",
        "--keep STATUS",
    ] {
        assert!(said.err.contains(words), "{}", said.err);
    }
    desk.refuses(
        &["infer", "results/short.h5", "--observed", "phase=55 deg +- 1 deg"],
        &["8 of 8 rows cannot count for what was observed", "8 not_steady (the response still changes"],
    );
    let kept = desk.json(&["stats", "results/short.h5", "--json", "--keep", "not_steady"]);
    assert_eq!(kept["observables"]["phase"]["count"], 8);
    desk.refuses(&["export", "results/short.h5", "--format", "csv"], &["8 of 8 instances", "--failed drop"]);
    let csv = desk.works(&["export", "results/short.h5", "--format", "csv", "--failed", "keep", "-q"]).out;
    assert!(csv.lines().nth(1).unwrap().ends_with(",not_steady"), "{csv}");
    desk.refuses(&["stats", "results/short.h5", "--observable", "phse"], &["no observable phse"]);
    // What the command line itself refuses has code 2.
    for (arguments, words) in [
        (vec!["stats", "results/short.h5", "--keep", "good"], "expected one of ok, not_steady"),
        (vec!["stats", "results/short.h5", "--left-out", "200"], "a share from 0 to 100"),
        (vec!["export", "results/short.h5", "--format", "xls"], "csv, salib"),
        (vec!["infer", "results/short.h5"], "--observed"),
    ] {
        let said = desk.call(&arguments);
        assert!(said.code == Some(2) && said.err.contains(words), "{arguments:?}: {}", said.err);
    }
}
