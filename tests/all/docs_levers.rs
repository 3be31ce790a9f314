//! Makers' levers: the table of docs/scene.md says what the presets have, and a scene can replace it.
//! Truth: the program's own table against the document's, and the scene's own words.

use afmsweep::Scene;
use afmsweep::scene::{LEVERS, LeverSpec};
use afmsweep::units::{Dimension, parse};

fn lever(scene: &Scene) -> (f64, f64) {
    match scene.base.instrument.cantilever.lever {
        LeverSpec::Calibrated { stiffness, frequency } => (stiffness, frequency),
        ref other => panic!("not a calibrated lever: {other:?}"),
    }
}

fn scene(text: &str) -> Scene {
    Scene::parse("lever.toml".as_ref(), text).unwrap()
}

#[test]
fn every_makers_lever_has_its_row_and_its_values() {
    let document = include_str!("../../docs/scene.md");
    let table = document.split_once("### Makers' levers").unwrap().1.split("\n## ").next().unwrap();
    let rows: Vec<&str> = table.lines().filter(|line| line.starts_with("| `")).collect();
    assert_eq!(rows.len(), LEVERS.len());
    for (row, lever_of) in rows.iter().zip(&LEVERS) {
        let cells: Vec<&str> = row.trim_matches('|').split(" | ").map(str::trim).collect();
        let length = |text: &str| parse(text, Dimension::Length).unwrap();
        assert_eq!(cells[0], format!("`{}`", lever_of.preset));
        assert_eq!(cells[1], lever_of.source);
        assert_eq!(parse(cells[2], Dimension::Stiffness), Ok(lever_of.stiffness));
        assert_eq!(parse(cells[3], Dimension::Frequency), Ok(lever_of.frequency));
        assert_eq!(length(cells[4]), lever_of.tip_radius);
        let (size, triangular) = cells[5].split_once(", ").unwrap_or((cells[5], ""));
        let sizes: Vec<f64> =
            size.trim_end_matches(" um").split(" x ").map(|one| length(&format!("{one} um"))).collect();
        assert_eq!(sizes, lever_of.size);
        assert_eq!(triangular == "triangular", lever_of.triangular);
        let text = format!(
            "[instrument]\npreset = \"{}\"\n[instrument.cantilever]\nquality_factor = 100\n[drive]\n\
             free_amplitude = \"5 nm\"",
            lever_of.preset
        );
        let scene = scene(&text);
        assert_eq!(lever(&scene), (lever_of.stiffness, lever_of.frequency));
        assert_eq!(scene.base.instrument.tip.radius, lever_of.tip_radius);
    }
}

#[test]
fn what_was_measured_replaces_what_the_sheet_says() {
    let text = "[instrument]\npreset = \"ac240ts\"\n[instrument.cantilever]\nstiffness = \"1.4 N/m\"\n\
                quality_factor = 170\n[drive]\nfree_amplitude = \"5 nm\"";
    let measured = scene(text);
    assert_eq!(lever(&measured), (1.4, 70e3));
    let line = measured.preset_line().unwrap();
    let begin = "from the preset ac240ts, nominal values (calibrate your lever): instrument.cantilever.frequency 70 kHz, \
                 instrument.tip.radius 7 nm; from the preset ha-fung-chen-2005: ";
    assert!(line.starts_with(begin), "{line}");
    // The scene with every value names the preset and has what replaced it.
    let again = scene(&measured.resolved_toml());
    assert_eq!((again.base, again.lever), (measured.base, measured.lever));
}
