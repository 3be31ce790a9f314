//! The first conclusion: what the coupling of rod and lever does, and when it matters.

use super::super::scene_run::{SceneRun, run, scene};
use super::super::{Numbers, StudyError};
use super::figure4::deepest;
use super::table1::{VOLTS, lever_mass, reduce, rod_mass, with};
use super::{COUPLING, Picture};
use crate::report::{Chart, ChartField, Heatmap, Look, Panel, Plot, State, shown};
use crate::scene::{ActuatorModel, Params};
use crate::store::Coordinate;
use nalgebra::Complex;
use std::path::Path;
use std::sync::Arc;

const MODELS: [(&str, &str, ActuatorModel); 3] = [
    ("coupled", "coupled", ActuatorModel::Coupled),
    ("prescribed", "not coupled", ActuatorModel::Prescribed),
    ("printed", "as printed", ActuatorModel::AsPrinted),
];
/// From here on a difference is worth a word.
const ONE_PERCENT: f64 = 0.01;
/// Frequencies of the sweep that become one cell of the map.
const BLOCK: usize = 8;

pub(super) fn find(numbers: &mut Numbers, folder: &Path) -> Result<Vec<Picture>, StudyError> {
    let params = super::params()?;
    responses(numbers, &params)?;
    let mut maps = Vec::new();
    for (key, _, model) in MODELS {
        let ran = run(scene("scenes/paper/coupling.toml", COUPLING, |scene| {
            scene.base.instrument.actuator.model = model;
        })?)?;
        ran.save(&folder.join(format!("coupling_{key}.h5")))?;
        maps.push(Map::of(&ran));
    }
    let [coupled, prescribed, printed] = [&maps[0], &maps[1], &maps[2]];
    let apart = Apart::of(coupled, prescribed);
    apart.note(numbers, coupled);
    Ok(vec![
        ("coupling_response.svg".to_owned(), response([coupled, prescribed, printed])),
        ("coupling_map.svg".to_owned(), apart.draw(coupled)),
    ])
}

/// Top and tip in the three models at the paper's drive, free and in contact.
fn responses(numbers: &mut Numbers, params: &Params) -> Result<(), StudyError> {
    for (key, name, model) in MODELS {
        let free = reduce(&with(&params.instrument, model))?.free_motion(VOLTS, 30e3)?;
        let (top, tip) = (free.top.norm(), free.tip.norm());
        let acceleration = free.omega * free.omega * top;
        numbers.add(format!("coupling.{key}.top"), format!("amplitude of the rod's top, {name}"), top, "m");
        let meaning = format!("acceleration of the rod's top, {name}");
        numbers.add(format!("coupling.{key}.acceleration"), meaning, acceleration, "m/s^2");
        numbers.add(format!("coupling.{key}.tip"), format!("amplitude of the free tip, {name}"), tip, "m");
        let depth = deepest(model)?;
        let meaning = format!("largest deformation in the run of figure 4, Hertz, {name}");
        numbers.add(format!("coupling.{key}.depth"), meaning, depth, "m");
    }
    for what in ["top", "tip", "depth"] {
        for key in ["coupled", "printed"] {
            let ratio = numbers.get(&format!("coupling.{key}.{what}"))
                / numbers.get(&format!("coupling.prescribed.{what}"));
            let meaning = format!("{what}, {key} over not coupled");
            numbers.add(format!("coupling.{key}.{what}_ratio"), meaning, ratio, "1");
        }
    }
    Ok(())
}

/// The free tip over rod mass and drive frequency.
struct Map {
    /// Rod masses, kg, falling, and in beam masses.
    masses: Vec<f64>,
    lever: f64,
    /// Hz, rising.
    frequencies: Vec<f64>,
    /// By mass, then frequency.
    tips: Vec<Complex<f64>>,
}

impl Map {
    fn of(ran: &SceneRun) -> Self {
        let (widths, frequencies) = (&ran.scene.sweep.axes[0].values, &ran.scene.sweep.axes[1].values);
        let mut instrument = ran.scene.base.instrument.clone();
        let masses = widths.iter().map(|&width| {
            instrument.actuator.width = width;
            rod_mass(&instrument)
        });
        Self {
            masses: masses.collect(),
            lever: lever_mass(&ran.scene.base.instrument),
            frequencies: frequencies.to_vec(),
            tips: ran.plan.instances().map(|i| ran.plan.driven(i).free.tip).collect(),
        }
    }

    fn row(&self, mass: usize) -> &[Complex<f64>] {
        &self.tips[mass * self.frequencies.len()..][..self.frequencies.len()]
    }

    /// Amplitudes over frequency.
    fn line(&self, mass: usize) -> Vec<(f64, f64)> {
        self.frequencies.iter().zip(self.row(mass)).map(|(&hz, tip)| (hz, tip.norm())).collect()
    }

    /// The mass nearest to so many beam masses.
    fn nearest(&self, beams: f64) -> usize {
        let off = |mass: f64| (mass / self.lever / beams).ln().abs();
        (0..self.masses.len())
            .min_by(|&a, &b| off(self.masses[a]).total_cmp(&off(self.masses[b])))
            .unwrap_or(0)
    }
}

/// How far the coupled tip's motion is from the other's, relative to the latter, phase included.
struct Apart {
    /// By mass, then frequency.
    values: Vec<f64>,
    columns: usize,
}

impl Apart {
    fn of(coupled: &Map, prescribed: &Map) -> Self {
        let pairs = coupled.tips.iter().zip(&prescribed.tips);
        Self {
            values: pairs.map(|(a, b)| (a - b).norm() / b.norm()).collect(),
            columns: coupled.frequencies.len(),
        }
    }

    fn row(&self, mass: usize) -> &[f64] {
        &self.values[mass * self.columns..][..self.columns]
    }

    fn note(&self, numbers: &mut Numbers, map: &Map) {
        let larger = |most: (usize, f64), one: (usize, f64)| if one.1 > most.1 { one } else { most };
        let largest = |row: &[f64]| row.iter().copied().enumerate().fold((0, 0.0), larger);
        let (at, worst) = largest(self.row(0));
        let meaning = "largest difference over 10 to 400 kHz, the paper's rod, Q = 100";
        numbers.add("apart.table1.largest", meaning, worst, "1");
        numbers.add("apart.table1.frequency", "where", map.frequencies[at], "Hz");
        let drive = map.frequencies.iter().position(|&hz| hz >= 30e3).unwrap_or(0);
        numbers.add("apart.table1.drive", "difference at 30 kHz, the paper's rod", self.row(0)[drive], "1");
        let count = map.masses.len();
        let any: Vec<f64> = (0..count).map(|mass| largest(self.row(mass)).1).collect();
        let there: Vec<f64> = (0..count).map(|mass| self.row(mass)[drive]).collect();
        for (key, meaning, line) in [
            ("apart.mass_anywhere", "rod mass below which the difference passes 1 % at some frequency", any),
            ("apart.mass_drive", "rod mass below which the difference passes 1 % at 30 kHz", there),
        ] {
            let mass = crossing(&map.masses, &line);
            numbers.add(key, meaning, mass, "kg");
            numbers.add(format!("{key}_beams"), format!("{meaning}, in beam masses"), mass / map.lever, "1");
        }
    }

    fn draw(&self, map: &Map) -> String {
        let count = self.columns / BLOCK;
        let middles = (0..count).map(|i| {
            let block = &map.frequencies[i * BLOCK..][..BLOCK];
            (block[0] * block[BLOCK - 1]).sqrt()
        });
        let axis = |name: &str, units: &str, long_name: &str, values: Vec<f64>| Coordinate {
            name: name.into(),
            units: units.into(),
            long_name: long_name.into(),
            values: Arc::new(values),
            ..Coordinate::default()
        };
        let x = axis("drive_frequency", "Hz", "drive frequency", middles.collect());
        let masses = map.masses.iter().map(|mass| mass / map.lever);
        let y = axis("rod_mass", "1", "rod mass in beam masses", masses.collect());
        let cell = |mass: usize, i: usize| {
            let block = &self.row(mass)[i * BLOCK..][..BLOCK];
            (block.iter().fold(0.0, |most: f64, &value| most.max(value)), State::Good)
        };
        let values = (0..map.masses.len()).flat_map(|mass| (0..count).map(move |i| (mass, i)));
        let line = (0..count).filter_map(|i| {
            let column: Vec<f64> = (0..map.masses.len()).map(|mass| cell(mass, i).0).collect();
            let mass = crossing(&map.masses, &column);
            mass.is_finite().then(|| (x.values[i], mass / map.lever))
        });
        let panel = Panel {
            caption: String::new(),
            values: values.map(|(mass, i)| cell(mass, i)).collect(),
            lines: vec![line.collect()],
            ..Panel::default()
        };
        let heatmap = Heatmap {
            title: "When does the coupling matter?".into(),
            units: "1",
            long_name: "difference of the tip's motion, coupled from not coupled",
            x: &x,
            y: &y,
            columns: 1,
            panels: vec![panel],
            lines: vec!["1 %; more below the line".into()],
        };
        heatmap.draw()
    }
}

/// Largest mass at which a difference, rising as masses fall, is [`ONE_PERCENT`]: between two masses of the
/// list by their logarithms; the first mass if it is above already, NaN if none is.
fn crossing(masses: &[f64], values: &[f64]) -> f64 {
    match values.iter().position(|&value| value >= ONE_PERCENT) {
        None => f64::NAN,
        Some(0) => masses[0],
        Some(i) => {
            let share = (ONE_PERCENT / values[i - 1]).ln() / (values[i] / values[i - 1]).ln();
            masses[i - 1] * (masses[i] / masses[i - 1]).powf(share)
        }
    }
}

/// Amplitude over frequency, three models, for the paper's rod and a light one.
fn response(maps: [&Map; 3]) -> String {
    let light = maps[0].nearest(100.0);
    let panel = |mass: usize| {
        let beams = shown(maps[0].masses[mass] / maps[0].lever, "1", 2);
        let lines = maps.iter().map(|map| map.line(mass)).collect();
        Plot::new(&format!("rod of {beams} beam masses"), "m", 210.0, lines)
    };
    let widths = [4.2, 1.4, 1.6];
    let chart = Chart {
        title: "Free tip's amplitude at 15 V, Q = 100".into(),
        x: ChartField { label: "drive frequency".into(), units: "Hz".into(), log: true },
        series: MODELS.iter().zip(widths).map(|(model, width)| Look::line(model.1, width, false)).collect(),
        panels: vec![panel(0), panel(light)],
    };
    chart.draw()
}
