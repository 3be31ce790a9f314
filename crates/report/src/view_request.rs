//! Which axes of a sweep stand where in a picture: along it, upwards, as curves, as panels, or fixed at one value.

use super::ReportError;
use super::labels::label;
use super::labels::shown;
use crate::store::{Coordinate, Results};
use crate::suggestion;
use crate::units::{self, Dimension};

/// An axis with at most so many values becomes curves, one for each.
const SHORT: usize = 6;
/// Likewise one that the scene gives as a list of `values`.
const SHORT_LIST: usize = 12;

/// Curves in one picture that were asked for, at most.
const MOST_CURVES: usize = 9;
/// The axis of the ways along a curve, and their words in the file.
pub(super) const DIRECTION: &str = "direction";
const WAYS: [&str; 2] = ["forward", "backward"];

/// What a page needs to compute cases by itself.
#[derive(Clone, Debug, PartialEq)]
pub struct PageEngine {
    /// The scene that the cases are made of, as an object with `title` and `base`.
    pub start: serde_json::Value,
    /// The library for WebAssembly, packed by zstd.
    pub library: Vec<u8>,
}

/// What a reader wants to see; without words the report chooses.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewRequest {
    /// The axis to the right, by its path in the scene or its name in the results file.
    pub x: Option<String>,
    /// The axis upwards: maps in place of curves.
    pub y: Option<String>,
    /// The axis whose values are curves in one picture.
    pub curves: Option<String>,
    /// Axes that stand at one value each: path or name, and the value with its unit.
    pub at: Vec<(String, String)>,
    /// Observables by name and the values, with their units, below or above which they have to be; the rest is greyed.
    pub below: Vec<(String, String)>,
    pub above: Vec<(String, String)>,
    /// The states of this branch alone, by the flag's word: `attractive` or `repulsive`.
    pub branch: Option<String>,
    /// Lets `explore.html` compute cases between the rows.
    pub engine: Option<PageEngine>,
}

/// A place for each axis of a grid, by the axes' numbers.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct View {
    pub x: usize,
    /// Upwards: a map.
    pub y: Option<usize>,
    /// One curve for each of its values.
    pub curves: Option<usize>,
    /// One panel for each of some of their values.
    pub panels: Vec<usize>,
    /// Axes that stand at one value, and which.
    pub fixed: Vec<(usize, usize)>,
}

impl View {
    /// The places that the wish leaves open are filled: long axes right and up, short ones as curves, the rest as panels.
    /// None where no axis is left to draw along.
    ///
    /// # Errors
    /// An axis or a value that the results do not have.
    pub fn of(results: &Results, wish: &ViewRequest) -> Result<Option<Self>, ReportError> {
        let axes = &results.axes;
        let mut fixed = fixed(results, wish)?;
        let find = |option, name: &Option<String>| {
            name.as_deref().map(|name| find(results, option, name)).transpose()
        };
        let (x, y) = (find("--x", &wish.x)?, find("--y", &wish.y)?);
        let laid_over = find("--curves", &wish.curves)?;
        if let Some(axis) = laid_over.map(|axis| &axes[axis]) {
            check_curves(axis, wish)?;
        }
        let wished = [x, y, laid_over];
        let single = |axis: &usize| axes[*axis].values.len() < 2 && !wished.contains(&Some(*axis));
        let is_fixed = |fixed: &[(usize, usize)], axis: usize| fixed.iter().any(|(one, _)| *one == axis);
        for axis in (0..axes.len()).filter(single) {
            if axes.len() > 1 && !is_fixed(&fixed, axis) {
                fixed.push((axis, 0));
            }
        }
        let mut free: Vec<usize> = (0..axes.len()).filter(|axis| !is_fixed(&fixed, *axis)).collect();
        let mut take = |wanted: Option<usize>| -> Option<usize> {
            let place = free.iter().position(|axis| Some(*axis) == wanted)?;
            Some(free.remove(place))
        };
        let short = |axis: usize| axes[axis].values.len() <= most_curves(results, &axes[axis]);
        if let Some(axis) = wished.into_iter().flatten().find(|axis| is_fixed(&fixed, *axis)) {
            return Err(ReportError::wish("--at", &axes[axis].name, "an axis that is not drawn along"));
        }
        let (x_wanted, y_wanted, curves_wanted) = (take(x), take(y), take(laid_over));
        // Names have no order: they stand to the right, or upwards, only where nothing else does.
        let is_named = |axis: usize| !axes[axis].words.is_empty();
        let last_long =
            |free: &[usize]| free.iter().rev().copied().find(|axis| !short(*axis) && !is_named(*axis));
        let longest = |free: &[usize]| {
            free.iter().copied().max_by_key(|axis| (!is_named(*axis), axes[*axis].values.len()))
        };
        let x = match x_wanted.or_else(|| last_long(&free)).or_else(|| longest(&free)).or(curves_wanted) {
            Some(x) => x,
            None => return Ok(None),
        };
        free.retain(|axis| *axis != x);
        let some_short = free.iter().rev().copied().find(|axis| short(*axis));
        let no_map = x_wanted.is_some() && y_wanted.is_none() && some_short.is_some();
        let no_map = no_map || curves_wanted.is_some();
        let y = y_wanted.or_else(|| last_long(&free).filter(|_| !no_map));
        free.retain(|axis| Some(*axis) != y);
        let curves = curves_wanted.filter(|axis| *axis != x);
        let curves = curves.or(some_short.filter(|_| y.is_none() && curves_wanted.is_none()));
        free.retain(|axis| Some(*axis) != curves);
        Ok(Some(Self { x, y, curves, panels: free, fixed }))
    }

    /// Numbers of the instances of one panel, whose axes of `panels` stand at `picks`; the x axis runs fastest, below it
    /// `y` or the curves.
    pub fn instances(&self, axes: &[Coordinate], picks: &[usize]) -> Vec<usize> {
        let stride = |axis: usize| axes[axis + 1..].iter().map(|one| one.values.len()).product::<usize>();
        let chosen = self.panels.iter().zip(picks).map(|(axis, pick)| stride(*axis) * pick);
        let base: usize = chosen.chain(self.fixed.iter().map(|(axis, pick)| stride(*axis) * pick)).sum();
        let slow = self.y.or(self.curves);
        let rows = slow.map_or(1, |axis| axes[axis].values.len());
        let row = |row: usize| base + slow.map_or(0, |axis| row * stride(axis));
        let x = stride(self.x);
        (0..rows).flat_map(|r| (0..axes[self.x].values.len()).map(move |i| row(r) + i * x)).collect()
    }

    /// A sentence on the axes that stand at one value of several.
    pub fn note(&self, axes: &[Coordinate]) -> Option<String> {
        let one = |(axis, pick): &(usize, usize)| {
            let axis = &axes[*axis];
            format!("{} {}", label(axis), shown(axis, axis.values[*pick]))
        };
        let several = |(axis, _): &&(usize, usize)| axes[*axis].values.len() > 1;
        let fixed: Vec<String> = self.fixed.iter().filter(several).map(one).collect();
        (!fixed.is_empty()).then(|| format!("At {}.", fixed.join(", ")))
    }
}

/// The axes that a reader wants to see at one value, and the number of the value.
///
/// # Errors
/// An axis or a value that the results do not have.
pub(super) fn fixed(results: &Results, wish: &ViewRequest) -> Result<Vec<(usize, usize)>, ReportError> {
    let place = |(name, value): &(String, String)| {
        let axis = find(results, "--at", name)?;
        Ok((axis, nearest(&results.axes[axis], name, value)?))
    };
    wish.at.iter().map(place).collect()
}

/// The parameter of a list that a reader wants to see alone.
///
/// # Errors
/// A parameter that the list does not have, or a wish for more than points over one parameter.
pub(super) fn parameter<'a>(
    results: &'a Results,
    wish: &ViewRequest,
) -> Result<Option<&'a Coordinate>, ReportError> {
    let only = |option, name: &str| {
        Err(ReportError::wish(
            option,
            name,
            "--x alone: a list of samples is drawn as points over one parameter",
        ))
    };
    match (&wish.y, wish.at.first()) {
        (Some(y), _) => only("--y", y),
        (_, Some((name, _))) => only("--at", name),
        _ => Ok(wish.x.as_ref().map(|x| find(results, "--x", x)).transpose()?.map(|i| &results.axes[i])),
    }
}

/// Whether an axis can be laid over as curves.
fn check_curves(axis: &Coordinate, wish: &ViewRequest) -> Result<(), ReportError> {
    let expected = match axis.values.len() {
        count if count > MOST_CURVES => {
            format!("an axis of at most {MOST_CURVES} values; this one has {count}, of which --at shows one")
        }
        _ if wish.y.is_some() => "no --y beside it: maps have no curves".to_owned(),
        _ => return Ok(()),
    };
    Err(ReportError::wish("--curves", &axis.name, &expected))
}

/// How many values of an axis still make curves.
fn most_curves(results: &Results, axis: &Coordinate) -> usize {
    let listed = || {
        let scene: toml::Table = results.text("scene")?.parse().ok()?;
        scene.get("sweep")?.get(&axis.scene_path)?.get("values").map(|_| ())
    };
    if !axis.words.is_empty() || listed().is_some() { SHORT_LIST } else { SHORT }
}

/// The number of the axis of this path or name.
fn find(results: &Results, option: &'static str, name: &str) -> Result<usize, ReportError> {
    let axes = &results.axes;
    let named = |axis: &Coordinate| axis.scene_path == name || axis.name == name;
    // `gap` is as good as `approach.gap` where one axis alone is called so.
    let ends = |axis: &Coordinate| axis.scene_path.rsplit('.').next() == Some(name);
    let alone = || axes.iter().position(ends).filter(|_| axes.iter().filter(|axis| ends(axis)).count() == 1);
    let path = |axis: &'_ Coordinate| {
        if axis.scene_path.is_empty() { axis.name.clone() } else { axis.scene_path.clone() }
    };
    axes.iter().position(named).or_else(alone).ok_or_else(|| {
        let names: Vec<String> = axes.iter().map(path).collect();
        match names.as_slice() {
            [] => ReportError::wish(option, name, "nothing: the scene has no sweep"),
            names => unknown(option, name, names),
        }
    })
}

/// That there is nothing of this name, and what was perhaps meant.
pub(super) fn unknown(option: &'static str, name: &str, names: &[String]) -> ReportError {
    let near = suggestion::nearest(name, names.iter().map(String::as_str));
    let meant = near.map_or_else(String::new, |near| format!("; did you mean {near}?"));
    ReportError::wish(option, name, &format!("one of {}{meant}", names.join(", ")))
}

/// A value as it was typed, in the SI unit that the file has for it.
pub(super) fn typed(value: &str, units: &str) -> Option<f64> {
    let value = value.trim();
    match Dimension::ALL.into_iter().find(|one| one.si_unit() == units) {
        Some(Dimension::Dimensionless) => value.parse().ok(),
        Some(dimension) => units::parse(value, dimension).ok(),
        None => {
            let bare = ["°", "degree", "deg"].iter().find_map(|unit| value.strip_suffix(unit));
            bare.unwrap_or(value).trim().parse().ok()
        }
    }
}

/// The number of the value of an axis that is nearest to this one.
fn nearest(axis: &Coordinate, name: &str, value: &str) -> Result<usize, ReportError> {
    let wrong = |expected: String| ReportError::wish("--at", &format!("{name}={value}"), &expected);
    if !axis.words.is_empty() {
        let is_way = |n: usize| axis.name == DIRECTION && WAYS[n.min(1)] == value.trim();
        let place = (0..axis.words.len()).find(|n| axis.words[*n] == value.trim() || is_way(*n));
        return place.ok_or_else(|| wrong(format!("one of {}", axis.words.join(", "))));
    }
    let number = typed(value, &axis.units);
    let ends = axis.values.first().zip(axis.values.last());
    let (first, last) = ends.map_or((f64::NAN, f64::NAN), |(first, last)| (*first, *last));
    let number = number.ok_or_else(|| {
        wrong(format!("a value with its unit, such as {name}={}", shown(axis, first).replace(' ', "")))
    })?;
    let off = |i: &usize| (axis.values[*i] - number).abs();
    let near = (0..axis.values.len()).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(0);
    let step = axis.values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).fold(0.0, f64::max);
    match off(&near) <= step.max(1e-6 * number.abs()) {
        true => Ok(near),
        false => Err(wrong(format!("a value from {} to {}", shown(axis, first), shown(axis, last)))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    fn grid(lengths: &[usize]) -> Results {
        let axis = |(i, n): (usize, &usize)| Coordinate {
            name: format!("a_{i}"),
            units: "m".into(),
            scene_path: format!("path.a.{i}"),
            values: Arc::new((1..=*n).map(|k| k as f64 * 1e-9).collect()),
            ..Coordinate::default()
        };
        let axes: Vec<Coordinate> = lengths.iter().enumerate().map(axis).collect();
        let count = lengths.iter().product();
        Results { axes, status: vec![0; count], steps_per_period: vec![1; count], ..Results::default() }
    }

    fn view(lengths: &[usize], wish: &ViewRequest) -> View {
        View::of(&grid(lengths), wish).unwrap().unwrap()
    }

    /// Truth: the rule, by hand: short axes are curves, two long ones a map, what is left over panels.
    #[test]
    fn short_axes_become_curves_and_long_ones_maps() {
        let none = ViewRequest::default();
        let expect = |lengths: &[usize], x, y, curves, panels: &[usize]| {
            let view = view(lengths, &none);
            assert_eq!((view.x, view.y, view.curves), (x, y, curves), "{lengths:?}");
            assert_eq!(view.panels, panels, "{lengths:?}");
        };
        expect(&[167], 0, None, None, &[]);
        expect(&[4, 167], 1, None, Some(0), &[]);
        expect(&[167, 4], 0, None, Some(1), &[]);
        expect(&[39, 33], 1, Some(0), None, &[]);
        expect(&[4, 32, 32], 2, Some(1), None, &[0]);
        expect(&[2, 4, 60], 2, None, Some(1), &[0]);
        expect(&[3, 4], 1, None, Some(0), &[]);
        assert_eq!(view(&[1, 9], &none).fixed, [(0, 0)]);
        assert_eq!(View::of(&grid(&[]), &none).unwrap(), None);
    }

    #[test]
    fn a_wish_is_followed_and_a_wrong_one_told() {
        let wish = |x: &str, y: &str, at: &[(&str, &str)]| {
            let word = |text: &str| (!text.is_empty()).then(|| text.to_owned());
            let at = at.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect();
            ViewRequest { x: word(x), y: word(y), at, ..ViewRequest::default() }
        };
        let one = view(&[20, 19, 9], &wish("path.a.0", "a_1", &[("path.a.2", "3 nm")]));
        assert_eq!((one.x, one.y, one.fixed), (0, Some(1), vec![(2, 2)]));
        // The last part of a path is enough where one axis alone has it.
        assert_eq!(view(&[20, 19, 9], &wish("1", "0", &[])).x, 1);
        let curves = view(&[4, 32, 32], &wish("a_1", "", &[]));
        assert_eq!((curves.x, curves.y, curves.curves, curves.panels), (1, None, Some(0), vec![2]));
        for (lengths, wish, words) in [
            (&[4, 5], wish("gap", "", &[]), "--x gap: expected one of path.a.0, path.a.1"),
            (&[4, 5], wish("pat.a.1", "", &[]), "path.a.1; did you mean path.a.1?"),
            (&[4, 5], wish("", "", &[("a_0", "30 nm")]), "a value from 1 nm to 4 nm"),
            (&[4, 5], wish("", "", &[("a_0", "3")]), "a value with its unit"),
            (&[4, 5], wish("a_0", "", &[("a_0", "3 nm")]), "not drawn along"),
        ] {
            let error = View::of(&grid(lengths), &wish).unwrap_err().to_string();
            assert!(error.contains(words), "{error}");
        }
    }

    /// Truth: the numbers of a grid in C order, by hand.
    #[test]
    fn instances_are_those_of_the_panel() {
        let results = grid(&[2, 3, 4]);
        let view = View { x: 1, y: None, curves: Some(0), panels: vec![2], fixed: Vec::new() };
        assert_eq!(view.instances(&results.axes, &[1]), [1, 5, 9, 13, 17, 21]);
        let view = View { x: 2, y: None, curves: None, panels: Vec::new(), fixed: vec![(0, 1), (1, 2)] };
        assert_eq!(view.instances(&results.axes, &[]), [20, 21, 22, 23]);
    }
}
