//! Sweeps over samples: three grids that are smooth, two that are not, a list, and designs of one lever and of many.

#[path = "../common/random.rs"]
mod random;

use random::Random;

/// Name and text of each, of about so many instances.
pub fn all(points: usize) -> Vec<(&'static str, String)> {
    let soft = r#"from = "0.1 GPa", to = "10 GPa""#;
    let hard = r#"from = "1 GPa", to = "100 GPa""#;
    vec![
        ("DMT, 0.1 to 10 GPa", tapping("dmt", 150, &cube(points, soft))),
        ("JKR, 0.1 to 10 GPa", tapping("jkr", 150, &cube(points, soft))),
        ("DMT, 1 to 100 GPa", tapping("dmt", 150, &cube(points, hard))),
        ("DMT, quality factor 2000", tapping("dmt", 2000, &cube(points, soft))),
        ("bistable", bistable(points)),
        ("list of 6 quantities", tapping("dmt", 150, &scattered(points))),
        ("design, one lever, DMT", design(points, "dmt", "")),
        ("design, one lever, JKR", design(points, "jkr", "")),
        ("design, levers vary, DMT", design(points, "dmt", LEVERS)),
        ("design, levers vary, JKR", design(points, "jkr", LEVERS)),
    ]
}

/// Quality factors of the first scene's lever, and its text with each.
pub fn qualities(points: usize) -> Vec<(u32, String)> {
    let soft = r#"from = "0.1 GPa", to = "10 GPa""#;
    [100, 1000, 10_000, 100_000].map(|quality| (quality, tapping("dmt", quality, &cube(points, soft)))).into()
}

/// Work of adhesion, modulus, radius.
fn cube(points: usize, modulus: &str) -> String {
    let counts = match points {
        1_000_000 => [100, 100, 100],
        100_000 => [40, 50, 50],
        10_000 => [20, 20, 25],
        _ => [(points as f64).cbrt().ceil() as usize; 3],
    };
    let axis = |path: &str, range: &str, count: usize| {
        format!("\"{path}\" = {{ {range}, points = {count}, scale = \"log\" }}\n")
    };
    format!(
        "[sweep]\n{}{}{}",
        axis("sample.surface_energy", r#"from = "1 mJ/m^2", to = "100 mJ/m^2""#, counts[0]),
        axis("sample.youngs_modulus", modulus, counts[1]),
        axis("instrument.tip.radius", r#"from = "5 nm", to = "40 nm""#, counts[2])
    )
}

/// Six quantities at random, levers among them.
fn scattered(points: usize) -> String {
    let mut random = Random(18);
    let mut list = |path: &str, low: f64, high: f64, unit: &str| {
        let value = |number: f64| match unit {
            "" => format!("{number:.9}"),
            unit => format!("\"{number:.9} {unit}\""),
        };
        let values: Vec<String> = (0..points).map(|_| value(random.log(low, high))).collect();
        format!("\"{path}\" = [{}]\n", values.join(", "))
    };
    [
        "[samples]\n".to_owned(),
        list("sample.surface_energy", 1.0, 100.0, "mJ/m^2"),
        list("sample.youngs_modulus", 0.1, 10.0, "GPa"),
        list("instrument.tip.radius", 5.0, 40.0, "nm"),
        list("sample.poisson_ratio", 0.2, 0.45, ""),
        list("approach.gap", 15.0, 18.0, "nm"),
        list("drive.free_amplitude", 19.0, 23.0, "nm"),
    ]
    .concat()
}

/// Stiffness, frequency and quality factor of a calibrated lever.
const LEVERS: &str = r#"
"instrument.cantilever.stiffness" = { distribution = "uniform", from = "20 N/m", to = "60 N/m" }
"instrument.cantilever.frequency" = { distribution = "uniform", from = "200 kHz", to = "400 kHz" }
"instrument.cantilever.quality_factor" = { distribution = "loguniform", from = 100, to = 400 }
"#;

/// A Sobol' design in six quantities of sample, tip and drive, or in these and those of the `levers`.
fn design(points: usize, law: &str, levers: &str) -> String {
    let decay = if law == "dmt" { "decay_length = \"0.3 nm\"" } else { "" };
    format!(
        r#"
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
stiffness = "40 N/m"
frequency = "300 kHz"
quality_factor = 150
[instrument.tip]
radius = "10 nm"
youngs_modulus = "130 GPa"
poisson_ratio = 0.28
[sample]
poisson_ratio = 0.3
[contact]
law = "{law}"
{decay}
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "17 nm"
[uncertain]
"sample.surface_energy" = {{ distribution = "loguniform", from = "1 mJ/m^2", to = "100 mJ/m^2" }}
"sample.youngs_modulus" = {{ distribution = "loguniform", from = "0.1 GPa", to = "10 GPa" }}
"instrument.tip.radius" = {{ distribution = "loguniform", from = "5 nm", to = "40 nm" }}
"sample.poisson_ratio" = {{ distribution = "uniform", from = 0.2, to = 0.45 }}
"approach.gap" = {{ distribution = "uniform", from = "15 nm", to = "18 nm" }}
"drive.free_amplitude" = {{ distribution = "uniform", from = "19 nm", to = "23 nm" }}
{levers}
[design]
kind = "sobol"
samples = {points}
[run]
periods = 800
measure = 20
accuracy = 1e-3
steady = "search"
[output]
observables = ["amplitude", "phase", "force_max"]
"#
    )
}

fn tapping(law: &str, quality: u32, sweep: &str) -> String {
    let decay = if law == "dmt" { "decay_length = \"0.3 nm\"" } else { "" };
    let periods = 480.max(2 * quality);
    format!(
        r#"
[instrument]
preset = "ha-fung-chen-2005"
[instrument.actuator]
quality_factor = 100
[instrument.cantilever]
quality_factor = {quality}
[instrument.tip]
radius = "20 nm"
youngs_modulus = "130 GPa"
poisson_ratio = 0.28
[sample]
youngs_modulus = "2 GPa"
poisson_ratio = 0.3
surface_energy = "20 mJ/m^2"
[contact]
law = "{law}"
{decay}
[drive]
frequency = "resonance"
free_amplitude = "20 nm"
[approach]
gap = "17 nm"
{sweep}
[run]
periods = {periods}
measure = 20
accuracy = 1e-3
steady = "search"
[output]
observables = ["amplitude", "phase", "force_max"]
"#
    )
}

/// Gap, modulus and work of adhesion where many instances have two states.
fn bistable(points: usize) -> String {
    let [gaps, moduli] = [points / 1600, 40];
    format!(
        r#"
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
stiffness = "40 N/m"
frequency = "300 kHz"
quality_factor = 400
[instrument.tip]
radius = "20 nm"
youngs_modulus = "130 GPa"
poisson_ratio = 0.28
[sample]
youngs_modulus = "1 GPa"
poisson_ratio = 0.3
surface_energy = "30 mJ/m^2"
[contact]
law = "dmt"
decay_length = "0.3 nm"
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "8 nm"
[approach]
gap = "5 nm"
[sweep]
"sample.youngs_modulus" = {{ from = "0.3 GPa", to = "30 GPa", points = {moduli}, scale = "log" }}
"sample.surface_energy" = {{ from = "5 mJ/m^2", to = "60 mJ/m^2", points = 40 }}
"approach.gap" = {{ from = "3 nm", to = "8.5 nm", points = {gaps} }}
[run]
periods = 3000
measure = 10
accuracy = 1e-3
steady = "search"
[output]
observables = ["amplitude", "phase", "force_max"]
"#
    )
}
