//! Below what a value is nothing: its error.

use crate::observe::{Observable, Scale};
use crate::store::{Results, Variable};

/// Variables that only serve others: they stand in the tables and have no picture.
pub(super) const SCALES: [&str; 1] = ["drive_work"];

/// Of each instance the error of this variable, in its unit: its scale times the estimate, or the accuracy asked for
/// where nothing was estimated. None where the file does not tell the scale.
pub(super) fn errors(results: &Results, variable: &Variable) -> Option<Vec<f64>> {
    let data = |name: &str| data(results, name);
    let count = results.status.len();
    let observable = Observable::from_name(&variable.name).filter(|_| variable.harmonics.is_none())?;
    let scales: Vec<f64> = match observable.scale() {
        Scale::Work | Scale::WorkOrItself => data("drive_work")?.to_vec(),
        Scale::Force => {
            let sides = [data("force_max")?, data("force_min")?];
            // A side without a value is left aside by max.
            (0..count).map(|i| sides.iter().fold(0.0, |most: f64, side| most.max(side[i].abs()))).collect()
        }
        Scale::One if observable == Observable::ContactTime => vec![1.0; count],
        _ => return None,
    };
    let accuracy = accuracy(results);
    let estimates = data("error_estimate");
    let share = |i: usize| estimates.map(|all| all[i]).filter(|one| one.is_finite()).or(accuracy);
    Some(scales.iter().enumerate().map(|(i, scale)| scale * share(i).unwrap_or(0.0)).collect())
}

/// The values of the variable of this name, where each instance has one.
pub(super) fn data<'a>(results: &'a Results, name: &str) -> Option<&'a [f64]> {
    let found = results.variables.iter().find(|one| one.name == name && one.harmonics.is_none());
    found.map(|one| one.data.as_slice())
}

/// The accuracy that the scene asks for, as far as the file tells.
pub(super) fn accuracy(results: &Results) -> Option<f64> {
    let scene: toml::Table = results.text("scene_resolved")?.parse().ok()?;
    scene.get("run")?.get("accuracy")?.as_float()
}
