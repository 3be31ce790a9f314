//! Forces that an instance's curve tells, to stand beside its law: the largest ones met, the orbit's own, and what can be
//! reconstructed from amplitudes and shifts.

use super::error_floor::data;
use super::frame::State;
use super::picture::places;
use super::view_request::DIRECTION;
use crate::observe::Status;
use crate::reconstruction::{Orbit, force};
use crate::store::{ForceCurve, Results};
use crate::units::{self, Dimension};

/// The quantity of approach and retraction.
pub(super) const GAP: &str = "approach.gap";

/// What the largest forces over the largest indentations are called, and those at the instants of a waveform.
pub(super) const LARGEST: &str = "largest of each point";
pub(super) const ORBIT: &str = "along the orbit";

/// The points of the curve over the gap that an instance is one of.
struct Points {
    /// Instances, from the widest gap to the narrowest.
    order: Vec<usize>,
    gaps: Vec<f64>,
    /// Whether they were gone through the other way.
    backward: bool,
    word: String,
}

/// Force over indentation, each named after where it is from.
pub(super) fn forces(results: &Results, instance: u64) -> Vec<ForceCurve> {
    let named = |law: &str, branch: &str, (indentation, force): (Vec<f64>, Vec<f64>)| {
        let contact_radius = vec![f64::NAN; force.len()];
        ForceCurve { instance, law: law.into(), branch: branch.into(), indentation, force, contact_radius }
    };
    let mut found = Vec::new();
    if let Some(points) = usize::try_from(instance).ok().and_then(|one| Points::through(results, one)) {
        if let Some(largest) = points.largest(results) {
            found.push(named(LARGEST, &points.word, largest));
        }
        if let Some(reconstructed) = points.reconstructed(results) {
            found.push(named("reconstructed from the curve", &points.word, reconstructed));
        }
    }
    if let Some(waveforms) = &results.waveforms
        && let Some(row) = waveforms.instances.iter().position(|one| *one == instance)
        && let (Some(depth), Some(force)) = (waveforms.indentation.get(row), waveforms.force.get(row))
    {
        found.push(named(ORBIT, "waveform", (depth.clone(), force.clone())));
    }
    found.retain(|curve| curve.force.len() > 1);
    found
}

impl Points {
    fn through(results: &Results, instance: usize) -> Option<Self> {
        jumps(results)?;
        let axis = results.axes.last().filter(|axis| axis.scene_path == GAP && !results.list)?;
        let length = axis.values.len();
        let first = instance - instance % length;
        let way = results.axes.iter().rev().nth(1).filter(|axis| axis.name == "direction");
        let backward = way.is_some() && (first / length) % 2 == 1;
        let alone = if axis.values.first() >= axis.values.last() { "approach" } else { "retraction" };
        let word = way.map_or(alone, |way| way.words.get(usize::from(backward)).map_or("", String::as_str));
        let mut places: Vec<usize> = (0..length).collect();
        places.sort_by(|a, b| axis.values[*b].total_cmp(&axis.values[*a]));
        let falling = axis.values.first() >= axis.values.last();
        Some(Self {
            order: places.iter().map(|place| first + place).collect(),
            gaps: places.iter().map(|place| axis.values[*place]).collect(),
            backward: backward == falling,
            word: word.to_owned(),
        })
    }

    /// The largest force over the largest indentation of each point.
    fn largest(&self, results: &Results) -> Option<(Vec<f64>, Vec<f64>)> {
        let (depths, forces) = (data(results, "indentation_max")?, data(results, "force_max")?);
        let both = |i: &usize| (depths[*i], forces[*i]);
        Some(self.order.iter().map(both).filter(|(depth, force)| (depth + force).is_finite()).unzip())
    }

    /// By the amplitudes and shifts of the continuous piece that begins at the widest gap, of a lever given by its first
    /// mode. Errors count so much beside it that only instances that are ok are taken.
    fn reconstructed(&self, results: &Results) -> Option<(Vec<f64>, Vec<f64>)> {
        let (amplitudes, shifts) = (data(results, "amplitude")?, data(results, "frequency_shift")?);
        let (stiffness, frequency) = first_mode(results)?;
        let means = data(results, "deflection_mean");
        let jumps = jumps(results)?;
        let ok = |i: usize| State::of(results.status[i], amplitudes[i]) == State::Good;
        let until = (0..self.order.len()).take_while(|&place| {
            let here = self.order[place];
            // A jump is told at the point that comes after it on the way.
            let torn = match self.backward {
                true => place > 0 && jumps[self.order[place - 1]] != 0,
                false => jumps[here] != 0,
            };
            ok(here) && !(torn && place > 0)
        });
        let orbit = |place: usize| {
            let i = self.order[place];
            let mean = means.map_or(0.0, |means| means[i]);
            Orbit::of_shift(self.gaps[place] + mean - amplitudes[i], amplitudes[i], shifts[i], frequency)
        };
        let orbits: Vec<Orbit> = until.map(orbit).collect();
        Some(force(&orbits, stiffness).into_iter().map(|(distance, force)| (-distance, force)).unzip())
    }
}

/// Of a run along curves, where states were not reached continuously.
pub(super) fn jumps(results: &Results) -> Option<&[u8]> {
    results.flags.iter().find(|flags| flags.name == "jump").map(|flags| flags.data.as_slice())
}

/// Of instances along curves, from which no line leads to the next one: a jump is told at the point after it on the way.
pub(super) fn torn(results: &Results) -> Vec<bool> {
    let (Some(jumps), Some(axis)) = (jumps(results), results.axes.last()) else { return Vec::new() };
    let length = axis.values.len().max(1);
    let ways = results.axes.iter().any(|axis| axis.name == DIRECTION && axis.values.len() == 2);
    let one = |i: usize| match ways && (i / length) % 2 == 1 {
        true => jumps[i] != 0,
        false => jumps.get(i + 1).is_some_and(|flag| *flag != 0),
    };
    (0..jumps.len()).map(one).collect()
}

/// Stiffness and frequency of the lever's first mode, where the scene gives them for all instances.
fn first_mode(results: &Results) -> Option<(f64, f64)> {
    let swept = |path: &str| path.starts_with("instrument.cantilever");
    let columns = results.axes.iter().flat_map(|axis| axis.columns.iter().chain([axis]));
    if columns.map(|axis| axis.scene_path.as_str()).any(swept) {
        return None;
    }
    let scene: toml::Table = results.text("scene_resolved")?.parse().ok()?;
    let lever = scene.get("instrument")?.get("cantilever")?;
    let mode = lever.get("modes").and_then(|modes| modes.get(0)).unwrap_or(lever);
    let value = |key: &str, dimension| units::parse(mode.get(key)?.as_str()?, dimension).ok();
    Some((value("stiffness", Dimension::Stiffness)?, value("frequency", Dimension::Frequency)?))
}

/// The decay length of the attraction at an instance, where the file tells it.
pub(super) fn decay_length(results: &Results, instance: u64) -> Option<f64> {
    let instance = usize::try_from(instance).ok()?;
    for (axis, at) in places(results, instance) {
        let columns = axis.columns.iter().chain([axis]);
        if let Some(swept) = columns.into_iter().find(|one| one.scene_path == "contact.decay_length") {
            return swept.values.get(at).copied();
        }
    }
    let scene: toml::Table = results.text("scene_resolved")?.parse().ok()?;
    units::parse(scene.get("contact")?.get("decay_length")?.as_str()?, Dimension::Length).ok()
}

/// Whether the instance's law holds the tip outside the sample once it has touched it.
pub(super) fn sticks(results: &Results, instance: u64) -> bool {
    let law = results.flags.iter().find(|flags| flags.name == "contact_law");
    let word = law.and_then(|law| law.meanings.get(usize::from(*law.data.get(instance as usize)?)));
    word.is_some_and(|word| word == "jkr")
}

/// Whether the instance is ok.
pub(super) fn is_ok(results: &Results, instance: usize) -> bool {
    results.status.get(instance).is_some_and(|code| Status::from_code(*code) == Some(Status::Ok))
}
