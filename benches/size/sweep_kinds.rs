//! Sweeps of many kinds: soft and stiff levers under three laws, quality factors, lists of designs, set-points, curves.

/// What is told of a lever and its sample, and how they are swept.
#[derive(Clone, Copy)]
struct Kind<'a> {
    stiffness: f64,
    quality_factor: f64,
    law: &'a str,
    /// Lines of `[approach]`.
    approach: &'a str,
    /// The tables that make the instances.
    sweep: &'a str,
}

/// 100,000 instances on samples up to 100 GPa, and a tenth of them for what takes minutes.
const GRID: Kind = Kind {
    stiffness: 40.0,
    quality_factor: 200.0,
    law: "dmt",
    approach: "gap = \"30 nm\"",
    sweep: r#"[sweep]
"sample.youngs_modulus" = { from = "1 GPa", to = "100 GPa", points = 40, scale = "log" }
"instrument.tip.radius" = { from = "10 nm", to = "60 nm", points = 50 }
"approach.gap" = { from = "16 nm", to = "38 nm", points = 50 }"#,
};
const SMALL_GRID: Kind = Kind {
    sweep: r#"[sweep]
"sample.youngs_modulus" = { from = "1 GPa", to = "100 GPa", points = 20, scale = "log" }
"instrument.tip.radius" = { from = "10 nm", to = "60 nm", points = 20 }
"approach.gap" = { from = "16 nm", to = "38 nm", points = 25 }"#,
    ..GRID
};

const DESIGN: &str = r#"[uncertain]
"sample.youngs_modulus" = { distribution = "loguniform", from = "1 GPa", to = "100 GPa" }
"instrument.tip.radius" = { distribution = "uniform", from = "10 nm", to = "60 nm" }
"approach.gap" = { distribution = "uniform", from = "16 nm", to = "38 nm" }
"drive.free_amplitude" = { distribution = "uniform", from = "38 nm", to = "42 nm" }
LEVERS
[design]
kind = "sobol"
samples = 100000"#;
const LEVERS: &str = r#""instrument.cantilever.stiffness" = { distribution = "uniform", from = "30 N/m", to = "50 N/m" }
"instrument.cantilever.quality_factor" = { distribution = "uniform", from = 150, to = 250 }"#;
const SETPOINTS: &str = r#"[sweep]
"sample.youngs_modulus" = { from = "1 GPa", to = "100 GPa", points = 40, scale = "log" }
"approach.setpoint" = { from = 0.4, to = 0.95, points = 50 }"#;
const CURVES: &str = r#"[sweep]
"sample.youngs_modulus" = { from = "1 GPa", to = "100 GPa", points = 100, scale = "log" }
[curve]
quantity = "approach.gap"
from = "42 nm"
to = "16 nm"
points = 100
direction = "both""#;

impl Kind<'_> {
    fn text(&self) -> String {
        let Self { stiffness, quality_factor, law, approach, sweep } = self;
        let decay = if *law == "dmt" { "decay_length = \"0.3 nm\"" } else { "" };
        // What waiting would take, for those that no search finds.
        let periods = 1000.0_f64.max(10.0 * quality_factor);
        format!(
            r#"
[instrument.actuator]
model = "rigid"
[instrument.cantilever]
stiffness = "{stiffness} N/m"
frequency = "300 kHz"
quality_factor = {quality_factor}
[instrument.tip]
radius = "30 nm"
youngs_modulus = "130 GPa"
poisson_ratio = 0.28
[sample]
youngs_modulus = "5 GPa"
poisson_ratio = 0.3
surface_energy = "30 mJ/m^2"
[contact]
law = "{law}"
{decay}
[drive]
on = "tip"
frequency = "resonance"
free_amplitude = "40 nm"
[approach]
{approach}
{sweep}
[run]
periods = {periods}
accuracy = 1e-3
steady = "search"
[output]
observables = ["amplitude", "phase", "force_max"]
"#
        )
    }
}

/// What each is, and its scene.
pub fn all() -> Vec<(String, String)> {
    let mut kinds: Vec<(String, Kind)> = Vec::new();
    for stiffness in [1.0, 4.0, 8.0, 15.0, 40.0] {
        for law in ["hertz", "dmt", "jkr"] {
            let grid = if stiffness < 8.0 { SMALL_GRID } else { GRID };
            kinds.push((format!("grid, {stiffness} N/m, {law}"), Kind { stiffness, law, ..grid }));
        }
    }
    for quality_factor in [2.0, 20.0, 2e3, 2e4, 1e5] {
        let what = format!("grid, 40 N/m, dmt, quality factor {quality_factor}");
        let grid = if quality_factor > 1e3 { SMALL_GRID } else { GRID };
        kinds.push((what, Kind { quality_factor, ..grid }));
    }
    let [one, many] = ["", LEVERS].map(|levers| DESIGN.replace("LEVERS", levers));
    for law in ["hertz", "dmt", "jkr"] {
        let of = |sweep| Kind { law, sweep, ..GRID };
        kinds.push((format!("design, one lever, {law}"), of(&one)));
        kinds.push((format!("design, levers vary, {law}"), of(&many)));
        let held = Kind { approach: "setpoint = 0.8\nsetpoint_branch = \"repulsive\"", ..of(SETPOINTS) };
        kinds.push((format!("set-points of the amplitude, {law}"), held));
        kinds.push((format!("curves there and back, {law}"), Kind { approach: "", ..of(CURVES) }));
    }
    kinds.into_iter().map(|(what, kind)| (what, kind.text())).collect()
}
