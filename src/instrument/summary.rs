//! The modes as JSON and as a table, as `afmsweep modes` shows them.

use serde_json::{Value, json};

use super::Instrument;

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
