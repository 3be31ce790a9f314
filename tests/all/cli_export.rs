//! Tables for other programs: `export --format csv` of any results file, `force --csv`. Truth: the results file itself, and
//! what a spreadsheet takes for a formula.

use crate::program::{Desk, numbers, variable};

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
[run]
steady = "search"
[output]
observables = ["amplitude", "harmonic_amplitude"]
"#;

fn export(desk: &Desk, name: &str) -> Vec<Vec<String>> {
    let text = desk.works(&["export", &format!("results/{name}.h5"), "--format", "csv"]).out;
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
    reader.records().map(|row| row.unwrap().iter().map(str::to_owned).collect()).collect()
}

/// A grid with an axis of things, whose labels are formulas to a spreadsheet; a case; a curve there and back.
#[test]
fn rows_of_any_file_have_their_axes() {
    let desk = Desk::new();
    let labels = ["=cmd|' /C calc'!A0", "-2.5", "@x", "PS"];
    let grid = format!(
        "{SCENE}[sweep]\n\"approach.gap\" = {{ values = [\"14 nm\", \"16 nm\"] }}\n[sweep.material]\nlabel = [\"{}\"]\n\
         \"sample.youngs_modulus\" = [\"1 GPa\", \"2 GPa\", \"3 GPa\", \"4 GPa\"]\n",
        labels.join("\", \"")
    );
    let results = desk.run(&desk.write("grid.toml", &grid), &[]);
    let rows = export(&desk, "grid");
    assert_eq!(rows[0][..4], ["approach_gap [m]", "material", "sample.youngs_modulus [Pa]", "amplitude [m]"]);
    assert!(rows[0][4].starts_with("harmonic_amplitude_1 ["), "{:?}", rows[0]);
    assert_eq!(rows.len(), 9);
    for (n, row) in rows[1..].iter().enumerate() {
        assert_eq!(row[0], ["1.4e-8", "1.6e-8"][n / 4]);
        assert_eq!(row[1], ["'=cmd|' /C calc'!A0", "-2.5", "'@x", "PS"][n % 4], "a number stays one");
        assert_eq!(row[2].parse::<f64>().unwrap(), (n % 4 + 1) as f64 * 1e9);
        assert_eq!(row[3].parse::<f64>().unwrap(), variable(&results, "amplitude")[n]);
    }
    let case = format!("{SCENE}[approach]\ngap = \"15 nm\"\n");
    let results = desk.run(&desk.write("case.toml", &case), &[]);
    let rows = export(&desk, "case");
    assert_eq!((rows.len(), rows[0][0].as_str()), (2, "amplitude [m]"));
    assert_eq!(rows[1][0].parse::<f64>().unwrap(), variable(&results, "amplitude")[0]);
    let curve = "[curve]\nquantity = \"approach.gap\"\nfrom = \"16 nm\"\nto = \"15 nm\"\npoints = 3\ndirection = \"both\"\n";
    let results = desk.run(&desk.write("curve.toml", &(SCENE.to_owned() + curve)), &[]);
    let rows = export(&desk, "curve");
    assert_eq!(rows[0][..2], ["direction", "approach_gap [m]"]);
    for (n, row) in rows[1..].iter().enumerate() {
        assert_eq!(row[0], ["forward", "backward"][n / 3]);
        assert_eq!(row[2].parse::<f64>().unwrap(), variable(&results, "amplitude")[n]);
    }
}

/// Names of samples are labels, too.
#[test]
fn names_of_samples_are_no_formulas() {
    let desk = Desk::new();
    desk.write("points.csv", "id,sample.youngs_modulus [GPa]\n=1+1,2\n+3,3\n");
    let scene =
        format!("{SCENE}[approach]\ngap = \"15 nm\"\n[design]\nkind = \"table\"\nfile = \"points.csv\"\n");
    desk.run(&desk.write("named.toml", &scene), &[]);
    let ids: Vec<String> = export(&desk, "named").into_iter().map(|row| row[0].clone()).collect();
    assert_eq!(ids, ["id", "'=1+1", "+3"]);
    assert!(desk.works(&["sample", "named.toml"]).out.contains("\n'=1+1,"));
}

#[test]
fn waveforms_are_a_table_as_well() {
    let desk = Desk::new();
    let scene = SCENE.replace(
        "[output]",
        "[output]\nwaveforms = { instances = [1, 0], samples_per_period = 32, periods = 1 }",
    );
    let sweep = "[sweep]\n\"approach.gap\" = { values = [\"14 nm\", \"16 nm\"] }\n";
    let results = desk.run(&desk.write("waves.toml", &(scene + sweep)), &[]);
    let waves = results.waveforms.unwrap();
    let call = ["export", "results/waves.h5", "--format", "csv", "--group", "waveforms"];
    let text = desk.works(&call).out;
    let mut lines = text.lines();
    assert_eq!(
        lines.next().unwrap(),
        "instance,time [s],tip_travel [m],actuator_top [m],indentation [m],force [N]"
    );
    for (row, instance) in waves.instances.iter().enumerate() {
        for n in 0..waves.tip_travel[row].len() {
            let cells: Vec<f64> =
                lines.next().unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
            assert_eq!(cells[0], *instance as f64);
            assert_eq!((cells[2], cells[5]), (waves.tip_travel[row][n], waves.force[row][n]));
        }
    }
    assert_eq!(lines.next(), None);
    desk.run(&desk.write("case.toml", &format!("{SCENE}[approach]\ngap = \"15 nm\"\n")), &[]);
    desk.refuses(
        &["export", "results/case.h5", "--format", "csv", "--group", "waveforms"],
        &["has no waveforms"],
    );
}

#[test]
fn static_curves_are_a_table_as_well() {
    let desk = Desk::new();
    desk.write("case.toml", &format!("{SCENE}[approach]\ngap = \"15 nm\"\n"));
    for (more, head, columns) in [
        (&[][..], "law,branch,indentation [m],force [N],contact_radius [m]", ["indentation_m", "force_n"]),
        (
            &["--lever"],
            "law,branch,base_position [m],indentation [m],force [N]",
            ["base_position_m", "indentation_m"],
        ),
    ] {
        let told = desk.json(&[&["force", "case.toml", "--json"], more].concat());
        let text = desk.works(&[&["force", "case.toml", "--csv"], more].concat()).out;
        let mut lines = text.lines();
        assert_eq!(lines.next().unwrap(), head);
        for curve in told["curves"].as_array().unwrap() {
            let (a, b) = (numbers(&curve[columns[0]]), numbers(&curve[columns[1]]));
            for (a, b) in a.iter().zip(&b) {
                let cells: Vec<&str> = lines.next().unwrap().split(',').collect();
                assert_eq!(cells[..2], ["dmt", curve["branch"].as_str().unwrap()]);
                assert_eq!((cells[2].parse::<f64>().unwrap(), cells[3].parse::<f64>().unwrap()), (*a, *b));
            }
        }
        assert_eq!(lines.next(), None);
    }
}

/// First-order shares of correlated quantities overlap: said in words, in numbers, on the page; never of independent ones.
#[test]
fn shares_of_correlated_quantities_are_said_to_overlap() {
    let desk = Desk::new();
    let scene = format!(
        "{SCENE}[approach]\ngap = \"15 nm\"\n[uncertain]\n\
         \"sample.youngs_modulus\" = {{ distribution = \"lognormal\", median = \"2 GPa\", sigma = 0.4 }}\n\
         \"sample.surface_energy\" = {{ distribution = \"lognormal\", median = \"20 mJ/m^2\", sigma = 0.3 }}\n\
         [design]\nkind = \"sobol\"\nsamples = 256\n"
    );
    let pair = "correlation = [[\"sample.youngs_modulus\", \"sample.surface_energy\", 0.9]]\n";
    for (name, more) in [("apart", ""), ("together", pair)] {
        desk.run(&desk.write(&format!("{name}.toml"), &(scene.clone() + more)), &[]);
        let file = format!("results/{name}.h5");
        let call = ["stats", &file, "--observable", "amplitude"];
        let told = desk.json(&[&call[..], &["--json"]].concat());
        let text = desk.works(&[&call[..], &["-o", name, "-q"]].concat()).out;
        let page = std::fs::read_to_string(desk.path(name).join("index.html")).unwrap();
        let one = &told["observables"]["amplitude"];
        let sum: f64 = numbers(&one["S1"]).iter().sum();
        let words = format!("correlated: shares overlap and add to {sum:.2}");
        assert_eq!(text.contains(&words), !more.is_empty(), "{text}");
        assert_eq!(page.contains("orrelated: shares overlap"), !more.is_empty());
        match more {
            "" => assert!(one["S1_sum"].is_null()),
            _ => {
                assert!((one["S1_sum"].as_f64().unwrap() - sum).abs() < 1e-12 && sum > 1.3, "{sum}");
                assert_eq!(one["S1_note"], words.as_str());
            }
        }
    }
}
