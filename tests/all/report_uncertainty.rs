//! Pages and tables of uncertainty studies: bands, what is folded, labels that are no formulas.
//! Truth: the points of the scene; the files that the commands write.

use crate::program::Desk;

const SCENE: &str = r#"
[instrument.cantilever]
stiffness = "10 N/m"
frequency = "75 kHz"
quality_factor = 30
[instrument.tip]
radius = "10 nm"
[sample]
youngs_modulus = "2 GPa"
surface_energy = "20 mJ/m^2"
[contact]
law = "dmt"
[drive]
frequency = "75 kHz"
on = "tip"
free_amplitude = "20 nm"
[sweep]
"approach.gap" = { from = "14 nm", to = "18 nm", points = 9 }
[sweep.material]
label = ["=1+1", "PS"]
"sample.poisson_ratio" = [0.3, 0.34]
[uncertain]
"sample.youngs_modulus" = { distribution = "loguniform", from = "1 GPa", to = "4 GPa" }
[design]
kind = "monte-carlo"
samples = 32
[run]
steady = "search"
[output]
observables = ["amplitude"]
"#;

#[test]
fn statistics_of_many_points_are_bands_and_folded_points() {
    let desk = Desk::new();
    let scene = desk.write("many.toml", SCENE);
    desk.run(&scene, &[]);
    let file = desk.results(&scene);
    let file = file.to_str().unwrap();
    desk.works(&["stats", file, "-o", "pages", "-q"]);
    let page = std::fs::read_to_string(desk.path("pages/index.html")).unwrap();
    // Eighteen points: every third is told, and only bands stand open.
    assert_eq!(page.matches("<details>").count(), 6, "{page}");
    assert!(page.contains("12 points of the sweep have no pictures of their own."), "{page}");
    assert!(page.contains("First-order indices by bins of 32 rows come out low"), "{page}");
    let open = page.split("<details>").next().unwrap();
    assert!(open.contains("Amplitude") && open.contains("25 to 75 %") && !open.contains("<table>"), "{open}");
    let band = std::fs::read_to_string(desk.path("pages/amplitude_bands_0.svg")).unwrap();
    assert!(band.matches("<polygon").count() >= 4 && band.contains("5 to 95 %"), "{band}");
    let names: Vec<bool> = ["=1+1", "PS"].iter().map(|name| band.contains(name)).collect();
    assert_eq!(names, [true, true], "{band}");

    // The report has bands over the gap, one for each material, and no map over the samples' numbers.
    desk.works(&["report", file, "-o", "report", "-q"]);
    let drawn = |name: &str| desk.path("report").join(name).exists();
    assert!(drawn("amplitude_band.svg") && !drawn("amplitude.svg"));

    desk.works(&["export", file, "--format", "csv", "-o", "rows.csv", "-q"]);
    let rows = std::fs::read_to_string(desk.path("rows.csv")).unwrap();
    assert_eq!(rows.lines().filter(|row| row.contains(",'=1+1,")).count(), 9 * 32, "{rows}");
    assert!(!rows.contains(",=1+1"), "{rows}");
}
