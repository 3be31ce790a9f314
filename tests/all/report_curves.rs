//! What a report makes of curves: bands over many, forces beside the law.
//! Truth: the contact law's own formula; quantiles of the values in the file.

use crate::program::{Desk, variable};

const SCENE: &str = r#"
[instrument.cantilever]
stiffness = "40 N/m"
frequency = "300 kHz"
quality_factor = 400
[instrument.tip]
radius = "10 nm"
[sample]
youngs_modulus = "50 MPa"
poisson_ratio = 0.3
surface_energy = "0 J/m^2"
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[sweep]
"sample.youngs_modulus" = { from = "50 MPa", to = "100 MPa", points = 11 }
[curve]
quantity = "approach.gap"
from = "22 nm"
to = "6 nm"
points = 241
direction = "both"
[run]
modes = 1
accuracy = 1e-4
[output]
observables = ["amplitude", "force_max", "indentation_max", "frequency_shift", "deflection_mean"]
waveforms = { instances = [200], samples_per_period = 64, periods = 1 }
"#;

#[test]
fn curves_become_bands_and_forces_beside_their_law() {
    let desk = Desk::new();
    let scene = desk.write("many.toml", SCENE);
    let results = desk.run(&scene, &[]);
    let file = desk.results(&scene);
    let answer = desk.json(&["report", file.to_str().unwrap(), "--json", "-q"]);
    let files: Vec<&str> =
        answer["pictures"].as_array().unwrap().iter().map(|one| one["file"].as_str().unwrap()).collect();
    for name in ["amplitude_band.svg", "frequency_shift_band.svg", "force_curve_200.svg"] {
        assert!(files.contains(&name), "{files:?}");
    }
    let folder = desk.path("results/many");
    let band = std::fs::read_to_string(folder.join("amplitude_band.svg")).unwrap();
    for words in ["approach", "retraction", "median", "25 to 75 %", "5 to 95 %"] {
        assert!(band.contains(words), "no {words:?}");
    }
    // At a gap in the middle, of eleven curves the sixth in order is the middle one.
    let table = std::fs::read_to_string(folder.join("amplitude_band.csv")).unwrap();
    let amplitudes = variable(&results, "amplitude");
    let mut first: Vec<f64> = (0..11).map(|curve| amplitudes[curve * 2 * 241 + 120]).collect();
    first.sort_by(f64::total_cmp);
    let row: Vec<&str> = table.lines().nth(1 + 120).unwrap().split(',').collect();
    assert_eq!((row[0], row[4].parse()), ("approach", Ok(first[5])));
    assert_eq!(table.lines().count(), 1 + 2 * 241);
    // Forces over the indentation: of the largest of each point, of the orbit and of the reconstruction.
    let table = std::fs::read_to_string(folder.join("force_curve_200.csv")).unwrap();
    let law = |depth: f64| 4.0 / 3.0 * 50e6 / (1.0 - 0.09) * 10e-9_f64.sqrt() * depth.max(0.0).powf(1.5);
    for (name, least, share) in [
        ("reconstructed from the curve,approach", 200, 0.01),
        ("largest of each point,approach", 200, 1e-3),
        ("along the orbit,waveform", 60, 1e-6),
    ] {
        let rows: Vec<(f64, f64)> = table
            .lines()
            .filter_map(|line| line.strip_prefix(name)?.strip_prefix(','))
            .map(|line| {
                let cells: Vec<f64> = line.split(',').take(2).map(|cell| cell.parse().unwrap()).collect();
                (cells[0], cells[1])
            })
            .collect();
        assert!(rows.len() >= least, "{name}: {} rows", rows.len());
        let largest = rows.iter().map(|row| law(row.0)).fold(0.0, f64::max);
        let worst = rows.iter().map(|row| (row.1 - law(row.0)).abs() / largest).fold(0.0, f64::max);
        println!("{name}: off by {worst:.1e} of {largest:.2e} N");
        assert!(largest > 1e-9 && worst < share, "{name}: off by {worst:e}");
    }
    assert_eq!(variable(&results, "amplitude").len(), 11 * 2 * 241);
}

/// Truth: the file's own flags.
#[test]
fn points_reached_by_a_jump_are_marked() {
    let desk = Desk::new();
    let text = SCENE
        .replace(
            "[sweep]\n\"sample.youngs_modulus\" = { from = \"50 MPa\", to = \"100 MPa\", points = 11 }",
            "",
        )
        .replace("youngs_modulus = \"50 MPa\"", "youngs_modulus = \"2 GPa\"")
        .replace("surface_energy = \"0 J/m^2\"", "surface_energy = \"66 mJ/m^2\"")
        .replace("hertz", "dmt");
    let scene = desk.write("jumps.toml", &text);
    let results = desk.run(&scene, &[]);
    let jumps = results.flags.iter().find(|flags| flags.name == "jump").unwrap();
    let count = jumps.data.iter().filter(|flag| **flag == 1).count();
    assert_eq!(count, 2);
    desk.works(&["report", desk.results(&scene).to_str().unwrap(), "-q"]);
    let picture = std::fs::read_to_string(desk.path("results/jumps/amplitude.svg")).unwrap();
    assert!(picture.contains("reached by a jump"));
    // One word per thing: ways along the gap are approach and retraction, and a law without memory has one curve.
    let page = std::fs::read_to_string(desk.path("results/jumps/report.md")).unwrap();
    assert!(page.contains("| way along the curve | direction | 2 | approach | retraction |"), "{page}");
    let law = std::fs::read_to_string(desk.path("results/jumps/force_curve_200.svg")).unwrap();
    for (text, there) in [
        ("dmt", true),
        ("largest of each point, approach", true),
        ("dmt, approach", false),
        ("retract", false),
    ] {
        assert_eq!(law.contains(text), there, "{text}");
    }
    assert!(picture.contains(">\nretraction\n<") && !picture.contains("way along"));
    // Dots of 4.2 pixels in tenths.
    assert_eq!(picture.matches("r=\"42\"").count(), count, "{picture}");
}
