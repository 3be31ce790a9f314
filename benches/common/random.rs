//! Random scenes from wide ranges, for the benches.

// Each bench compiles this file for itself and uses a part of it.
#![allow(dead_code)]

#[path = "contact.rs"]
pub mod contact;

use afmsweep::observe::Observable;
use afmsweep::scene::Scene;
use contact::{Contact, Of};
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

/// Ends of what is random, each spread evenly over its logarithm, gaps evenly.
#[derive(Clone, Copy, Debug)]
pub struct Ranges {
    /// What the drive acts on: "tip", or "actuator" (a rigid base).
    pub on: &'static str,
    /// The drive's frequency over the lever's.
    pub detuning: [f64; 2],
    /// Of the lever's own effective mass (stiffness over the square of its angular frequency).
    pub tip_mass: [f64; 2],
    /// N/m and Hz
    pub stiffness: [f64; 2],
    pub frequency: [f64; 2],
    pub quality: [f64; 2],
    /// Pa, J/m^2, m, m
    pub modulus: [f64; 2],
    pub work: [f64; 2],
    pub radius: [f64; 2],
    pub amplitude: [f64; 2],
    /// Of the free amplitude.
    pub gap: [f64; 2],
}

impl Ranges {
    /// One lever of tapping in air.
    pub const USUAL: Self = Self {
        on: "tip",
        detuning: [1.0; 2],
        tip_mass: [0.0; 2],
        stiffness: [40.0; 2],
        frequency: [300e3; 2],
        quality: [10.0, 60.0],
        modulus: [10e6, 100e9],
        work: [1e-3, 0.2],
        radius: [5e-9, 100e-9],
        amplitude: [5e-9, 100e-9],
        gap: [0.3, 1.05],
    };
    /// From soft levers in liquids to stiff ones in air, each instance another.
    pub const LEVERS: Self = Self {
        on: "tip",
        detuning: [1.0; 2],
        tip_mass: [0.0; 2],
        stiffness: [0.03, 100.0],
        frequency: [10e3, 1e6],
        quality: [1.5, 1000.0],
        modulus: [1e6, 200e9],
        work: [1e-3, 0.2],
        radius: [2e-9, 200e-9],
        amplitude: [1e-9, 200e-9],
        gap: [0.2, 1.05],
    };
    /// Wider ranges yet, shaken at the base, off resonance, with a mass at the tip.
    pub const SHAKEN: Self = Self {
        on: "actuator",
        detuning: [0.85, 1.15],
        tip_mass: [1e-3, 0.3],
        stiffness: [0.02, 300.0],
        frequency: [3e3, 3e6],
        quality: [1.2, 3000.0],
        modulus: [0.2e6, 400e9],
        work: [1e-5, 0.2],
        radius: [1e-9, 500e-9],
        amplitude: [0.5e-9, 300e-9],
        gap: [0.2, 1.05],
    };
}

/// Largest modulus (Pa) of a sample with losses: polymers, gels and cells.
const LOSSY: f64 = 5e9;

/// What a random scene has.
#[derive(Clone, Copy, Debug)]
pub struct Wide<'a> {
    /// A law, or a word of [`contact::CONTACTS`].
    pub law: &'a str,
    pub count: usize,
    pub seed: u64,
    pub accuracy: f64,
    /// Where the levers, samples and tips come from.
    pub from: Ranges,
    /// More lines of `[run]`.
    pub run: &'a str,
}

/// A calibrated lever, and `count` samples, tips, quality factors, amplitudes and gaps under one law.
pub fn scene(wide: &Wide) -> Scene {
    let Wide { law, count, seed, accuracy, from, run } = *wide;
    let mut random = Random(seed);
    let contact = Contact::named(law);
    let Contact { law, tip, beside, own, .. } = contact;
    let from = match contact.loses() {
        true => Ranges { modulus: [from.modulus[0], LOSSY], ..from },
        false => from,
    };
    let mut lists: Vec<(&str, &str, Vec<f64>)> = vec![
        ("sample.youngs_modulus", "Pa", vec![]),
        ("sample.surface_energy", "J/m^2", vec![]),
        ("instrument.tip.radius", "m", vec![]),
        ("instrument.cantilever.quality_factor", "", vec![]),
        ("drive.free_amplitude", "m", vec![]),
        ("approach.gap", "m", vec![]),
        ("instrument.cantilever.stiffness", "N/m", vec![]),
        ("instrument.cantilever.frequency", "Hz", vec![]),
        ("drive.frequency", "Hz", vec![]),
        ("instrument.tip.mass", "kg", vec![]),
    ];
    lists.extend(own.iter().map(|(path, unit, ..)| (*path, *unit, vec![])));
    for _ in 0..count {
        let mut any = |[low, high]: [f64; 2]| random.log(low, high);
        let (amplitude, modulus, work, radius) =
            (any(from.amplitude), any(from.modulus), any(from.work), any(from.radius));
        let quality = any(from.quality);
        let gap = amplitude * (from.gap[0] + (from.gap[1] - from.gap[0]) * random.next());
        let one = |ends: [f64; 2], random: &mut Random| match ends[0] == ends[1] {
            true => ends[0],
            false => random.log(ends[0], ends[1]),
        };
        let stiffness = one(from.stiffness, &mut random);
        let frequency = one(from.frequency, &mut random);
        let drive = frequency * one(from.detuning, &mut random);
        let lever = stiffness / (std::f64::consts::TAU * frequency).powi(2);
        let mass = lever * one(from.tip_mass, &mut random);
        let values = [modulus, work, radius, quality, amplitude, gap, stiffness, frequency, drive, mass];
        let mut before = 1.0;
        let own = own.iter().map(|(.., ends, of)| {
            before = one(*ends, &mut random)
                * match of {
                    Of::Itself => 1.0,
                    Of::Turn => 1.0 / (std::f64::consts::TAU * drive),
                    Of::Radius => radius,
                    Of::Modulus => modulus,
                    Of::Before => before,
                };
            before
        });
        let values: Vec<f64> = values.into_iter().chain(own).collect();
        for ((.., list), value) in lists.iter_mut().zip(values) {
            list.push(value);
        }
    }
    // What does not vary is in the scene.
    let varies = |list: &[f64]| list.windows(2).any(|pair| pair[0] != pair[1]);
    // A tip that ends in a point has no radius, and a force by numbers knows neither tip nor sample.
    let without = |path: &str| {
        (contact.pointed() && path == "instrument.tip.radius")
            || (law == "table" && (path.starts_with("sample.") || path == "instrument.tip.radius"))
    };
    lists.retain(|(path, ..)| !without(path));
    let on = from.on;
    let samples: String = lists
        .iter()
        .filter(|(.., list)| varies(list) || (list.len() < 2 && list.iter().all(|value| *value > 0.0)))
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
[instrument.tip]
{tip}
[contact]
law = "{law}"
{beside}
[drive]
on = "{on}"
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
