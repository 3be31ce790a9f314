//! Random scenes from wide ranges, for the benches.

// Each bench compiles this file for itself and uses a part of it.
#![allow(dead_code)]

use afmsweep::observe::Observable;
use afmsweep::scene::Scene;
use std::path::Path;

/// Numbers between 0 and 1 (SplitMix64; Steele, Lea & Flood 2014).
pub struct Random(pub u64);

impl Random {
    pub fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = self.0;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((mixed ^ (mixed >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        low * (high / low).powf(self.next())
    }
}

/// What a random scene has.
#[derive(Clone, Copy, Debug)]
pub struct Wide<'a> {
    pub law: &'a str,
    pub count: usize,
    pub seed: u64,
    pub accuracy: f64,
    /// Ends of the quality factors.
    pub quality: [f64; 2],
    /// More lines of `[run]`.
    pub run: &'a str,
}

/// A calibrated lever, and `count` samples, tips, quality factors, amplitudes and gaps under one law.
pub fn scene(wide: &Wide) -> Scene {
    let Wide { law, count, seed, accuracy, quality, run } = *wide;
    let mut random = Random(seed);
    let mut lists: [(&str, &str, Vec<f64>); 6] = [
        ("sample.youngs_modulus", "Pa", vec![]),
        ("sample.surface_energy", "J/m^2", vec![]),
        ("instrument.tip.radius", "m", vec![]),
        ("instrument.cantilever.quality_factor", "", vec![]),
        ("drive.free_amplitude", "m", vec![]),
        ("approach.gap", "m", vec![]),
    ];
    for _ in 0..count {
        let amplitude = random.log(5e-9, 100e-9);
        let values = [
            random.log(10e6, 100e9),
            random.log(1e-3, 0.2),
            random.log(5e-9, 100e-9),
            random.log(quality[0], quality[1]),
            amplitude,
            amplitude * (0.3 + 0.75 * random.next()),
        ];
        for ((.., list), value) in lists.iter_mut().zip(values) {
            list.push(value);
        }
    }
    let samples: String = lists
        .iter()
        .map(|(path, unit, list)| {
            let words: Vec<String> = list
                .iter()
                .map(
                    |value| {
                        if unit.is_empty() { format!("{value:e}") } else { format!("\"{value:e} {unit}\"") }
                    },
                )
                .collect();
            format!("\"{path}\" = [{}]\n", words.join(", "))
        })
        .collect();
    let text = format!(
        r#"
[instrument.cantilever]
stiffness = "40 N/m"
frequency = "300 kHz"
quality_factor = 100
[instrument.actuator]
model = "rigid"
[contact]
law = "{law}"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[approach]
gap = "15 nm"
[samples]
{samples}
[run]
accuracy = {accuracy:e}
{run}
"#
    );
    let mut scene = Scene::parse(Path::new("random.toml"), &text).unwrap_or_else(|error| panic!("{error}"));
    scene.output.observables = Observable::all().filter(|one| *one != Observable::Contacts).collect();
    scene
}

/// The value that so large a share of the sorted ones is below.
pub fn quantile(sorted: &[f64], share: f64) -> f64 {
    let last = sorted.len().saturating_sub(1) as f64;
    sorted.get((share * last).round() as usize).copied().unwrap_or(f64::NAN)
}
