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

/// A contact by its word, its law, lines of `[instrument.tip]`, and its own random quantities: path, unit, ends, and of what
/// they are parts (1 over the drive's angular frequency, the tip's radius, the sample's modulus).
type Contact =
    (&'static str, &'static str, &'static str, &'static [(&'static str, &'static str, [f64; 2], Of)]);

#[derive(Clone, Copy, Debug)]
enum Of {
    Itself,
    Turn,
    Radius,
    Modulus,
}

const TIME: [f64; 2] = [0.01, 5.0];
const THICKNESS: (&str, &str, [f64; 2], Of) = ("sample.thickness", "m", [0.5, 50.0], Of::Radius);
const ANGLE: (&str, &str, [f64; 2], Of) = ("instrument.tip.half_angle", "deg", [10.0, 70.0], Of::Itself);

/// Contacts beside those that are a law alone.
const CONTACTS: [Contact; 10] = [
    ("hertz-viscous", "hertz", "", &[("sample.retardation_time", "s", TIME, Of::Turn)]),
    ("dmt-viscous", "dmt", "", &[("sample.retardation_time", "s", TIME, Of::Turn)]),
    (
        "hertz-relaxing",
        "hertz",
        "",
        &[
            ("sample.relaxation_time", "s", TIME, Of::Turn),
            ("sample.instantaneous_modulus", "Pa", [1.1, 10.0], Of::Modulus),
        ],
    ),
    ("sphere", "hertz", "shape = \"sphere\"", &[]),
    ("sphere-dmt", "dmt", "shape = \"sphere\"", &[]),
    ("cone", "hertz", "shape = \"cone\"", &[ANGLE]),
    ("pyramid", "hertz", "shape = \"pyramid\"", &[ANGLE]),
    ("punch", "hertz", "shape = \"punch\"", &[]),
    ("hyperboloid", "hertz", "shape = \"hyperboloid\"", &[ANGLE]),
    ("layer", "hertz", "", &[THICKNESS]),
];

/// What a random scene has.
#[derive(Clone, Copy, Debug)]
pub struct Wide<'a> {
    /// A law, or a word of [`CONTACTS`].
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
    let alone: Contact = ("", "", "", &[]);
    let contact = CONTACTS.into_iter().find(|contact| contact.0 == law).unwrap_or(alone);
    let (_, known, tip, own) = contact;
    let law = if known.is_empty() { law } else { known };
    let from = match own.iter().any(|(.., of)| matches!(of, Of::Turn)) {
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
        let own = own.iter().map(|(.., ends, of)| {
            let part = one(*ends, &mut random);
            part * match of {
                Of::Itself => 1.0,
                Of::Turn => 1.0 / (std::f64::consts::TAU * drive),
                Of::Radius => radius,
                Of::Modulus => modulus,
            }
        });
        let values: Vec<f64> = values.into_iter().chain(own).collect();
        for ((.., list), value) in lists.iter_mut().zip(values) {
            list.push(value);
        }
    }
    // What does not vary is in the scene.
    let varies = |list: &[f64]| list.windows(2).any(|pair| pair[0] != pair[1]);
    // A tip that ends in a point has no radius.
    let pointed = tip.contains("cone") || tip.contains("pyramid");
    lists.retain(|(path, ..)| !(pointed && *path == "instrument.tip.radius"));
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
