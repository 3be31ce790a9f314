//! The values of one axis.

use super::Axis;
use super::address::Address;
use super::draft::keys_of;
use super::paths;
use super::quantities::QUANTITIES;
use super::scene_error::{Checked, Fault};
use super::values::{self, Key, Value};
use crate::suggestion::nearest;
use crate::units::shortened;
use std::ops::Range;
use std::sync::Arc;
use toml::de::DeTable;

/// Most instances one scene may stand for.
pub(super) const MOST_INSTANCES: usize = 1 << 24;

/// Keys of an axis.
pub(super) const AXIS_KEYS: [&str; 5] = ["from", "to", "points", "scale", "values"];

const AXIS_FORM: &str =
    "{ from = ..., to = ..., points = ..., scale = \"lin\" or \"log\" } or { values = [...] }";

/// Refuses more instances than a scene may have.
pub(super) fn in_all(instances: usize, place: &Range<usize>) -> Checked<()> {
    if instances <= MOST_INSTANCES {
        return Ok(());
    }
    Err(Fault::at(place.clone(), "the sweep is too large")
        .label(format!("with this axis it has {instances} instances"))
        .expected(format!("at most {MOST_INSTANCES}"))
        .help("take fewer points, or split the scene into several"))
}

pub(super) fn axis(address: Address, values: Vec<f64>, log: bool) -> Axis {
    Axis {
        path: address.path(),
        name: axis_name(&address.path()),
        long_name: address.long_name(),
        units: address.quantity.dimension.si_unit().to_string(),
        log,
        values: Arc::new(values),
        ..Axis::default()
    }
}

/// The last two words of the path, joined; a word that is an index takes the list's name with it.
pub(super) fn axis_name(path: &str) -> String {
    let words: Vec<&str> = path.split('.').collect();
    let mut first = words.len().saturating_sub(2);
    if words[first..].iter().take(1).any(|word| word.bytes().all(|byte| byte.is_ascii_digit())) {
        first = first.saturating_sub(1);
    }
    words[first..].join("_")
}

/// The quantity an axis names, or why that is none.
pub(super) fn swept_quantity(key: &Key, value: &Value, section: &str) -> Checked<Address> {
    let path = key.get_ref().as_ref();
    if let Some(address) = Address::find(path) {
        return Ok(address);
    }
    const CHOICES: [&str; 5] =
        ["instrument.preset", "instrument.actuator.model", paths::LAW, "drive.on", "title"];
    let fault = |title: String| Fault::at(key.span(), title).expected("the path of a quantity, in quotes");
    if CHOICES.contains(&path) {
        return Err(fault(format!("`{path}` is a choice, not a quantity"))
            .label("cannot be swept")
            .help("write one scene for each choice")
            .maybe_help((path == paths::LAW).then(|| "make it an axis of [sweep]".to_string())));
    }
    if path.starts_with("run.") || path.starts_with("output.") {
        return Err(fault(format!("`{path}` says how to run, not what is simulated"))
            .label("cannot be swept")
            .help("write one scene for each setting"));
    }
    let known = || QUANTITIES.iter().map(|quantity| quantity.path);
    // [samples] for [sample].
    if section == "samples" && !value.get_ref().is_array() && keys_of("sample").contains(&path) {
        return Err(fault(format!("`{path}` is not the path of a quantity"))
            .label("a key of [sample]")
            .help("did you mean the section [sample]? [samples] holds lists of cases"));
    }
    // sample.youngs_modulus = ... without quotes is a table in a table.
    if value.get_ref().is_table() && known().any(|quantity| quantity.split('.').next() == Some(path)) {
        return Err(fault(format!("`{path}` in [{section}] is a section, not a quantity"))
            .label("not the path of a quantity")
            .help(format!(
                "put the whole path in quotes: \"{}\" = ...",
                shortened(&unquoted_path(path, value))
            )));
    }
    let by_ending =
        || known().find(|quantity| quantity.strip_suffix(path).is_some_and(|head| head.ends_with('.')));
    let meant = by_ending().or_else(|| nearest(path, known()));
    let example = meant.map(|meant| format!("did you mean \"{}\"?", meant.replace('#', "0")));
    Err(fault(format!("`{}` is not a quantity of a scene", shortened(path)))
        .label("unknown path")
        .help(
            match path.split_once('.').map(|(section, _)| keys_of(section)).filter(|keys| !keys.is_empty()) {
                Some(keys) => format!("this section has {}", keys.join(", ")),
                None => "write the sections and the key joined by points, as \"instrument.tip.radius\""
                    .to_string(),
            },
        )
        .maybe_help(example))
}

/// The path that dotted keys without quotes were meant to be.
fn unquoted_path(start: &str, value: &Value) -> String {
    let (mut path, mut inner) = (start.to_string(), value.get_ref());
    while let Some((key, value)) = inner.as_table().and_then(|table| table.iter().next()) {
        path = format!("{path}.{}", key.get_ref());
        inner = value.get_ref();
        if Address::find(&path).is_some() {
            break;
        }
    }
    path
}

/// The values of an axis, which may stand `beside` other keys, and whether they are spaced in the logarithm.
pub(super) fn axis_values(value: &Value, address: Address, beside: &[&str]) -> Checked<(Vec<f64>, bool)> {
    let path = address.path();
    let table = values::table(value, &path, AXIS_FORM).map_err(|fault| {
        fault.maybe_help(value.get_ref().is_array().then(|| "write { values = [...] }".to_string()))
    })?;
    let own = |key: &&Key| !beside.contains(&key.get_ref().as_ref());
    if let Some(key) = table.keys().filter(own).find(|key| !AXIS_KEYS.contains(&key.get_ref().as_ref())) {
        return Err(values::unknown_key(key, &format!("sweep.{path}"), &AXIS_KEYS));
    }
    match table.get_key_value("values") {
        Some((key, list)) => {
            if let Some(other) = table.keys().filter(own).find(|key| key.get_ref() != "values") {
                return Err(Fault::at(other.span(), format!("the axis `{path}` is given in two ways"))
                    .label(format!("`{}` belongs to an axis with from and to", other.get_ref()))
                    .related(key.span(), "the values are listed")
                    .expected(AXIS_FORM)
                    .help(format!("remove `values` or `{}`", other.get_ref())));
            }
            Ok((listed_once(list, address)?, false))
        }
        None => between_ends(value, table, address),
    }
}

/// A list of values that differ.
fn listed_once(list: &Value, address: Address) -> Checked<Vec<f64>> {
    let values = listed(list, address)?;
    let Some((first, second)) = repeated(&values) else {
        return Ok(values);
    };
    let place = list.get_ref().as_array().and_then(|array| array.get(second)).map_or(0..0, |v| v.span());
    Err(Fault::at(place, format!("the axis `{}` repeats a value", address.path()))
        .label(format!("value {} is the same as value {}", second + 1, first + 1))
        .expected("values that differ")
        .help("remove one of the two"))
}

/// The values of an axis from one end to the other, and whether they are spaced in the logarithm.
fn between_ends(value: &Value, table: &DeTable, address: Address) -> Checked<(Vec<f64>, bool)> {
    let path = address.path();
    let get = |name: &str| {
        table.get(name).ok_or_else(|| {
            let found: Vec<&str> = table.keys().map(|key| key.get_ref().as_ref()).collect();
            let found =
                if found.is_empty() { "nothing".to_string() } else { format!("only {}", found.join(", ")) };
            Fault::at(value.span(), format!("the axis `{path}` lacks `{name}`"))
                .label(format!("found {found}"))
                .expected(AXIS_FORM)
                .help(format!("add `{name}`"))
        })
    };
    let (from_value, to_value, points_value) = (get("from")?, get("to")?, get("points")?);
    let from = values::quantity(from_value, address, &path)?;
    let to = values::quantity(to_value, address, &path)?;
    let points = values::count(points_value, "points", 2..=MOST_INSTANCES as u64)? as usize;
    let log = match table.get("scale") {
        Some(scale) => values::keyword(scale, "scale", &[("lin", false), ("log", true)])?,
        None => false,
    };
    check_end(from, from_value, log, &path)?;
    check_end(to, to_value, log, &path)?;
    let values = spaced(from, to, points, log);
    if repeated(&values).is_some() {
        return Err(Fault::at(points_value.span(), format!("the points of the axis `{path}` do not differ"))
            .label(format!("{points} points"))
            .related(from_value.span(), "from here")
            .related(to_value.span(), "to here")
            .expected("ends far enough apart for the points to be distinct numbers")
            .help("move the ends apart, or leave the axis out and give the one value in its section"));
    }
    if let Some(number) = values.iter().find(|number| !address.quantity.domain.holds(**number)) {
        values::in_domain(*number, value.span(), || address.shown(*number), address, &path)?;
    }
    Ok((values, log))
}

/// Refuses an end that no points can be spaced from.
fn check_end(number: f64, place: &Value, log: bool, path: &str) -> Checked<()> {
    let trouble = if number.is_infinite() {
        "infinite"
    } else if log && number <= 0.0 {
        "not above zero, as a logarithmic axis needs"
    } else {
        return Ok(());
    };
    Err(values::unfit(place, format!("an end of the axis `{path}` is {trouble}"))
        .expected(if log { "finite ends above zero" } else { "finite ends" })
        .help("list the values instead: { values = [...] }"))
}

/// A list of values, each checked in its place.
pub(super) fn listed(value: &Value, address: Address) -> Checked<Vec<f64>> {
    let path = address.path();
    let form = format!("a list such as [{}, ...]", address.quantity.dimension.example());
    let list = values::list(value, &path, &form)?;
    if list.len() > MOST_INSTANCES {
        return Err(Fault::at(value.span(), "the list is too long")
            .label(found_values(list.len()))
            .expected(format!("at most {MOST_INSTANCES}"))
            .help("split the scene into several"));
    }
    list.iter().map(|entry| values::quantity(entry, address, &path)).collect()
}

pub(super) fn found_values(count: usize) -> String {
    format!("found {count} value{}", if count == 1 { "" } else { "s" })
}

/// Positions of two equal values, the earlier first.
fn repeated(values: &[f64]) -> Option<(usize, usize)> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]).then(a.cmp(&b)));
    let same = order.windows(2).filter(|pair| values[pair[0]] == values[pair[1]]);
    same.map(|pair| (pair[0].min(pair[1]), pair[0].max(pair[1]))).min_by_key(|pair| pair.1)
}

/// `points` values from one end to the other, both ends exact.
///
/// A point that means a short decimal (1 GPa between 100 MPa and 10 GPa) is that decimal's double.
pub(super) fn spaced(from: f64, to: f64, points: usize, log: bool) -> Vec<f64> {
    let last = points.saturating_sub(1).max(1);
    let scale = from.abs().max(to.abs());
    let between = |i: usize| {
        let share = i as f64 / last as f64;
        let value = if log {
            // Each end with its own power: neither the ratio nor the product can overflow.
            from.powf(1.0 - share) * to.powf(share)
        } else {
            from * (1.0 - share) + to * share
        };
        rounded(value, if log { value } else { scale })
    };
    let point = |i: usize| match i {
        0 => from,
        i if i == last => to,
        i => between(i),
    };
    (0..points).map(point).collect()
}

/// The nearest number of 12 digits where it is within rounding errors of `scale`; else the value itself.
fn rounded(value: f64, scale: f64) -> f64 {
    let short = format!("{value:.11e}").parse().unwrap_or(value);
    if (short - value).abs() <= 16.0 * f64::EPSILON * scale.abs() { short } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_and_round_steps_are_exact() {
        assert_eq!(spaced(1e8, 1e11, 4, true), [1e8, 1e9, 1e10, 1e11]);
        assert_eq!(spaced(1e11, 1e8, 4, true), [1e11, 1e10, 1e9, 1e8]);
        assert_eq!(spaced(5e-9, 4e-8, 8, false), [5e-9, 1e-8, 1.5e-8, 2e-8, 2.5e-8, 3e-8, 3.5e-8, 4e-8]);
        assert_eq!(spaced(-5e-9, 5e-9, 5, false), [-5e-9, -2.5e-9, 0.0, 2.5e-9, 5e-9]);
    }

    #[test]
    fn log_points_have_one_ratio() {
        for (from, to, points) in [(1e8, 1e11, 32), (3e-10, 7e-3, 1000), (1e-300, 1e300, 77), (2.0, 3.0, 5)] {
            let values = spaced(from, to, points, true);
            assert_eq!((values[0], values[points - 1]), (from, to));
            let ratio = (f64::ln(to) - f64::ln(from)) / (points - 1) as f64;
            for (i, pair) in values.windows(2).enumerate() {
                assert!(
                    ((pair[1] / pair[0]).ln() - ratio).abs() < 4e-13 * (1.0 + ratio),
                    "{from:e}..{to:e} at {i}"
                );
            }
        }
    }

    #[test]
    fn names_take_the_last_two_words() {
        assert_eq!(axis_name("sample.youngs_modulus"), "sample_youngs_modulus");
        assert_eq!(axis_name("instrument.tip.radius"), "tip_radius");
        assert_eq!(axis_name("instrument.cantilever.modes.0.stiffness"), "modes_0_stiffness");
        assert_eq!(axis_name("instrument.cantilever.quality_factor.1"), "quality_factor_1");
        let mut names: Vec<String> =
            QUANTITIES.iter().map(|q| axis_name(&q.path.replace('#', "0"))).collect();
        names.sort();
        names.dedup();
        assert_eq!(names.len(), QUANTITIES.len(), "two quantities share a name in the results file");
    }
}
