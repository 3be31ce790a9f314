//! `--at`: a sweep or a curve at one of its values.

use super::value::si;
use afmsweep::report::shown;
use afmsweep::stats::Study;
use afmsweep::store::Coordinate;
use afmsweep_data::suggestion;
use anyhow::{Context, bail};
use serde_json::{Map, Value};
use std::path::Path;

/// `approach.gap=16nm`.
pub(super) fn pair(text: &str) -> Result<(String, String), String> {
    let (path, value) = text.split_once('=').ok_or("expected PATH=VALUE, such as approach.gap=16nm")?;
    Ok((path.trim().to_owned(), value.trim().to_owned()))
}

/// Which axis beside the samples bears that path or name, or ends in it.
pub(super) fn axis(study: &Study, name: &str) -> Option<usize> {
    let name = name.to_lowercase();
    let named = |axis: &Coordinate| axis.scene_path == name || axis.name == name;
    let ends = |axis: &Coordinate| axis.scene_path.rsplit('.').next() == Some(name.as_str());
    let axes = &study.beside;
    let alone = axes.iter().filter(|axis| ends(axis)).count() == 1;
    axes.iter().position(named).or_else(|| axes.iter().position(ends).filter(|_| alone))
}

/// The least and the largest of some values.
pub(super) fn ends<'a>(values: impl Iterator<Item = &'a f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(*value), high.max(*value)))
}

/// The ends of an axis, in words.
pub(super) fn span(axis: &Coordinate) -> String {
    let (low, high) = ends(axis.values.iter());
    format!("which runs from {} to {}", shown(low, &axis.units, 4), shown(high, &axis.units, 4))
}

/// What an axis is called in a scene, or else in the file.
pub(super) fn path(axis: &Coordinate) -> &str {
    if axis.scene_path.is_empty() { &axis.name } else { &axis.scene_path }
}

/// Of each axis beside the samples the number of its value that is asked for; of values the nearest.
pub(super) fn fixed(study: &Study, at: &[(String, String)]) -> anyhow::Result<Vec<Option<usize>>> {
    let mut fixed = vec![None; study.beside.len()];
    for (name, value) in at {
        let number = axis(study, name).with_context(|| {
            let known: Vec<&str> = study.beside.iter().map(path).collect();
            let near = suggestion::nearest(name, known.iter().copied());
            let meant = near.map_or_else(String::new, |near| format!("; did you mean {near}?"));
            match known.as_slice() {
                [] => format!("--at {name}: the file has samples alone"),
                _ => format!("--at {name}: expected one of {}{meant}", known.join(", ")),
            }
        })?;
        fixed[number] =
            Some(nearest(&study.beside[number], value).with_context(|| format!("--at {name}={value}"))?);
    }
    Ok(fixed)
}

fn nearest(axis: &Coordinate, value: &str) -> anyhow::Result<usize> {
    if !axis.words.is_empty() {
        let found = axis.words.iter().position(|word| word == value);
        return found.with_context(|| format!("expected one of {}", axis.words.join(", ")));
    }
    let wanted = si(value, &axis.units)?;
    let off = |n: &usize| (axis.values[*n] - wanted).abs();
    let near = (0..axis.values.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
    let step = axis.values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    if off(&near) > step.max(1e-6 * wanted.abs()) {
        let at = |value: Option<&f64>| shown(value.copied().unwrap_or(f64::NAN), &axis.units, 4);
        bail!("expected a value from {} to {}", at(axis.values.first()), at(axis.values.last()));
    }
    Ok(near)
}

/// The points beside the samples that `--at` leaves.
pub(super) fn points(study: &Study, fixed: &[Option<usize>]) -> Vec<usize> {
    let kept = |point: &usize| {
        study.place(*point).iter().zip(fixed).all(|(at, fixed)| fixed.is_none_or(|fixed| fixed == *at))
    };
    (0..study.points()).filter(kept).collect()
}

/// Where a message is about: the file, and the point of its sweep.
pub(super) fn named(file: &Path, at: &Map<String, Value>) -> String {
    match at.is_empty() {
        true => file.display().to_string(),
        false => format!("{} at {}", file.display(), Value::Object(at.clone())),
    }
}
