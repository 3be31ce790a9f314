//! The modes as JSON and as a table, as `afmsweep modes` shows them.

use serde_json::{Value, json};

use super::{Fluid, FluidMode, Instrument};
use crate::units::{Dimension, format as written};

/// `{"modes": [{"frequency_hz", "quality_factor", "tip_share", "drive_share"}, ...]}`: the resolved
/// modes in rising frequency. `tip_share` is c_k^2/omega_k^2 over its sum over all modes;
/// `drive_share` is g_k c_k/omega_k^2 over the sum of absolute values. JSON has no infinity: the
/// quality factor of an undamped mode is `null`.
pub fn modes_json(instrument: &Instrument) -> Value {
    let (tips, drives) = (instrument.tip_shares(), instrument.drive_shares());
    let modes: Vec<Value> = instrument.modes[..instrument.resolved]
        .iter()
        .enumerate()
        .map(|(k, mode)| {
            let q = mode.quality_factor;
            json!({
                "frequency_hz": mode.omega / std::f64::consts::TAU,
                "quality_factor": if q.is_finite() { json!(q) } else { Value::Null },
                "tip_share": tips[k],
                "drive_share": drives[k],
            })
        })
        .collect();
    json!({ "modes": modes })
}

/// The same for reading: one line a mode under a line of headings, and what the rest adds up to.
pub fn modes_table(instrument: &Instrument) -> String {
    let (tips, drives) = (instrument.tip_shares(), instrument.drive_shares());
    let mut text = format!(
        "{:>4}  {:>16}  {:>11}  {:>10}  {:>11}\n",
        "mode", "frequency", "Q", "tip share", "drive share"
    );
    let resolved = instrument.resolved;
    for (k, mode) in instrument.modes[..resolved].iter().enumerate() {
        let q = if mode.quality_factor.is_finite() {
            format!("{:.1}", mode.quality_factor)
        } else {
            "undamped".to_owned()
        };
        text += &format!(
            "{:>4}  {:>12.4} kHz  {:>11}  {:>10.2e}  {:>11.2e}\n",
            k + 1,
            mode.omega / std::f64::consts::TAU / 1e3,
            q,
            tips[k],
            drives[k]
        );
    }
    let rest = instrument.modes.len() - resolved;
    if rest > 0 {
        let tip: f64 = tips[resolved..].iter().sum();
        let drive: f64 = drives[resolved..].iter().sum();
        text += &format!(
            "{:>4}  {:>16}  {:>11}  {tip:>10.2e}  {drive:>11.2e}\n",
            "rest",
            format!("{rest} more"),
            ""
        );
    }
    text
}

/// `{"fluid": {"density_kg_per_m3", "viscosity_pa_s"}, "modes": [...]}`: each mode of the lever in the fluid, with its doubts.
pub fn fluid_json(fluid: Fluid, modes: &[FluidMode]) -> Value {
    let mode = |mode: &FluidMode| {
        json!({
            "vacuum_frequency_hz": mode.vacuum_frequency,
            "frequency_hz": mode.frequency,
            "quality_factor": mode.quality_factor,
            "stiffness_n_per_m": mode.stiffness,
            "drive": mode.drive,
            "reynolds_number": mode.reynolds,
            "hydrodynamic_function": [mode.hydrodynamic.re, mode.hydrodynamic.im],
            "doubts": mode.doubts(),
        })
    };
    json!({
        "fluid": { "density_kg_per_m3": fluid.density, "viscosity_pa_s": fluid.viscosity },
        "modes": modes.iter().map(mode).collect::<Vec<_>>(),
    })
}

/// The same for reading, and below it what a scene says of such a lever, to be pasted.
pub fn fluid_table(fluid: Fluid, modes: &[FluidMode]) -> String {
    let mut text = format!(
        "the lever alone in a fluid of {}, {}\n{:>4}  {:>16}  {:>16}  {:>9}  {:>10}  {:>12}\n",
        written(fluid.density, Dimension::Density),
        written(fluid.viscosity, Dimension::Viscosity),
        "mode",
        "vacuum",
        "fluid",
        "Q",
        "Reynolds",
        "stiffness"
    );
    for (k, mode) in modes.iter().enumerate() {
        text += &format!(
            "{:>4}  {:>12.4} kHz  {:>12.4} kHz  {:>9.3}  {:>10.3e}  {:>8.4} N/m\n",
            k + 1,
            mode.vacuum_frequency / 1e3,
            mode.frequency / 1e3,
            mode.quality_factor,
            mode.reynolds,
            mode.stiffness
        );
    }
    let mut doubts: Vec<(String, Vec<String>)> = Vec::new();
    for (k, mode) in modes.iter().enumerate() {
        for doubt in mode.doubts() {
            match doubts.iter_mut().find(|(told, _)| *told == doubt) {
                Some((_, of)) => of.push((k + 1).to_string()),
                None => doubts.push((doubt, vec![(k + 1).to_string()])),
            }
        }
    }
    for (doubt, of) in doubts {
        let modes = if of.len() > 1 { "modes" } else { "mode" };
        text += &format!("doubt: {modes} {}: {doubt}\n", of.join(", "));
    }
    text + &fluid_toml(modes)
}

/// Lines for `[instrument.cantilever]`: as a calibrated lever, and mode by mode as a comment.
fn fluid_toml(modes: &[FluidMode]) -> String {
    // A scene takes no quality factor of 1/2 or less, and of modes that are no blade's nothing is known.
    let told: Vec<&FluidMode> =
        modes.iter().take_while(|mode| mode.slender() && rounded(mode.quality_factor) > 0.5).collect();
    let Some(first) = told.first() else {
        return "nothing to paste: the first mode is no oscillator in this fluid\n".to_owned();
    };
    let stiffness = |mode: &FluidMode| written(rounded(mode.stiffness), Dimension::Stiffness);
    let frequency = |mode: &FluidMode| written(rounded(mode.frequency), Dimension::Frequency);
    let qualities: Vec<String> =
        told.iter().map(|mode| format!("{:?}", rounded(mode.quality_factor))).collect();
    let mut text = format!(
        "\n# In place of the lever's dimensions and the tip's shape; higher modes are a beam's in vacuum:\n\
         [instrument.cantilever]\nstiffness = \"{}\"\nfrequency = \"{}\"\nquality_factor = [{}]\n",
        stiffness(first),
        frequency(first),
        qualities.join(", ")
    );
    text += "# or, with each mode's own frequency in the fluid (drive: for a base that shakes the lever; 1 for a drive on the tip):\n# modes = [\n";
    for (mode, quality) in told.iter().zip(qualities) {
        text += &format!(
            "#     {{ stiffness = \"{}\", frequency = \"{}\", quality_factor = {quality}, drive = {:?} }},\n",
            stiffness(mode),
            frequency(mode),
            rounded(mode.drive)
        );
    }
    text + "# ]\n"
}

/// To six digits, which is more than dimensions are known to.
fn rounded(value: f64) -> f64 {
    format!("{value:.5e}").parse().unwrap_or(value)
}
