//! The pictures of one variable, over as many axes as the results have.

use super::canvas::text_width;
use super::curve_forces::{jumps, torn};
use super::curve_picture::{Curve, CurvePlot, Style};
use super::frame::{SMALL, State};
use super::heatmap::{Heatmap, Panel};
use super::hover::Hover;
use super::labels::{capital, caption, label, names, short, shown};
use super::picture::{Picture, PictureKind, case, numbers, second_states, states};
use super::view_request::{DIRECTION, View, ViewRequest};
use super::{ReportError, SAMPLES, branch_states, scatter};
use crate::store::{Coordinate, Results, Variable};

/// Harmonics shown at most: curves or maps side by side, and rows of slices.
const MOST_HARMONICS: usize = 6;
const MOST_ROWS: usize = 3;
/// What curves that are ways there and back differ by.
const WAYS: &str = "ways";
/// Instances whose harmonics stand side by side in one picture.
const MOST_STICKS: usize = 6;
/// Values of the first and of the second axis that are shown side by side and below each other.
const MOST_ACROSS: usize = 4;
const MOST_DOWN: usize = 3;

/// A variable as its pictures name and show it.
struct Subject<'a> {
    units: &'a str,
    heading: String,
    axis_name: String,
    /// Values that each instance has, 1 where they are no harmonics.
    harmonics: usize,
    /// Values with what became of each, an instance's side by side.
    states: Vec<(f64, State)>,
    /// Likewise of the second states, where there are any.
    second: Option<Vec<(f64, State)>>,
    /// Whether an instance was not reached continuously along its curve; empty without curves.
    jumps: Vec<bool>,
    /// Whether no line leads from an instance to the next one; likewise.
    torn: Vec<bool>,
    /// The words for branches, and the branch of each instance and of its second state; empty where the file does not tell.
    branches: Vec<String>,
    branch: [Vec<u8>; 2],
}

/// A drawn picture and a note on it.
type Shown = (String, Hover, String);

/// The pictures of a variable: none of a single number, two where a map has second states.
pub(super) fn draw(
    results: &Results,
    variable: &Variable,
    wish: &ViewRequest,
) -> Result<Vec<Picture>, ReportError> {
    let (name, axis_name) = names(variable);
    let (branches, branch) = branch_states::of_states(results);
    let mut subject = Subject {
        units: &variable.units,
        heading: capital(name),
        axis_name,
        harmonics: variable.harmonics.unwrap_or(1).max(1),
        states: states(results, variable),
        second: second_states(results, variable),
        jumps: jumps(results).unwrap_or_default().iter().map(|flag| *flag != 0).collect(),
        torn: torn(results),
        branches,
        branch,
    };
    let kind = PictureKind::of(variable);
    let picture = |subject: &Subject, end: &str, (svg, hover, note): Shown| Picture {
        kind,
        name: format!("{}{end}", file_name(&variable.name)),
        title: subject.heading.clone(),
        note,
        svg,
        hover,
        csv: super::csv::of_variable(results, variable),
    };
    if results.list || results.axes.is_empty() {
        return Ok(match subject.unordered(results, wish)? {
            Some(shown) => vec![picture(&subject, "", shown)],
            None => Vec::new(),
        });
    }
    let instances = results.status.len();
    if subject.harmonics > 1 && instances <= MOST_STICKS && wish.x.is_none() && wish.y.is_none() {
        let names = (0..instances).map(|i| case(results, i).join(", ")).collect();
        return Ok(vec![picture(&subject, "", subject.over_harmonics(names))]);
    }
    let Some(view) = View::of(results, wish)? else { return Ok(Vec::new()) };
    // The number of a sample says nothing: the band over all of them does.
    let wished = |axis: &Coordinate| [&wish.x, &wish.y].into_iter().flatten().any(|name| *name == axis.name);
    let numbered = |axis: usize| results.axes[axis].scene_path == SAMPLES && !wished(&results.axes[axis]);
    if view.panels.iter().chain(&view.curves).chain(&view.y).chain([&view.x]).any(|axis| numbered(*axis)) {
        return Ok(Vec::new());
    }
    let mut pictures = vec![picture(&subject, "", subject.over(&results.axes, &view))];
    // Curves show both states in one picture, maps cannot.
    if let Some(second) = subject.second.take().filter(|_| view.y.is_some()) {
        subject.states = second;
        subject.branch.swap(0, 1);
        subject.heading += ", second state";
        pictures.push(picture(&subject, "_second", subject.over(&results.axes, &view)));
    }
    Ok(pictures)
}

impl Subject<'_> {
    /// The values of one harmonic, counted from 0.
    fn harmonic(&self, number: usize) -> Vec<(f64, State)> {
        self.states.iter().skip(number).step_by(self.harmonics).copied().collect()
    }

    /// A note where there are more harmonics than are shown.
    fn first_of(&self, most: usize) -> Option<String> {
        (self.harmonics > most).then(|| format!("The first {most} of {} harmonics.", self.harmonics))
    }

    /// Of a list clouds of points, of a single case its harmonics; nothing of a single number.
    fn unordered(&self, results: &Results, wish: &ViewRequest) -> Result<Option<Shown>, ReportError> {
        match (results.list, results.axes.as_slice()) {
            (true, []) => {
                let instances = numbers("instance", "instance number", 0..results.status.len());
                Ok(Some(self.over_list(&[instances])))
            }
            (true, parameters) => {
                let chosen = super::view_request::parameter(results, wish)?;
                Ok(Some(self.over_list(chosen.map_or(parameters, std::slice::from_ref))))
            }
            _ if self.harmonics > 1 => Ok(Some(self.over_harmonics(vec![String::new()]))),
            _ => Ok(None),
        }
    }

    /// The harmonics of a few instances of these names, as sticks.
    fn over_harmonics(&self, names: Vec<String>) -> Shown {
        let orders = numbers("harmonic", "harmonic of the drive frequency", 1..self.harmonics + 1);
        let series = names.into_iter().zip(self.states.chunks(self.harmonics));
        let series = series.map(|(name, values)| Curve { name, values: values.to_vec(), ..Curve::default() });
        let panels = vec![(String::new(), series.collect())];
        self.curves((&orders, "", Style::Sticks), 1, panels, String::new())
    }

    /// Clouds of points, one for each parameter, and a note on what is left out.
    fn over_list(&self, parameters: &[Coordinate]) -> Shown {
        let note = match self.harmonics {
            1 => String::new(),
            harmonics => format!("The first of {harmonics} harmonics."),
        };
        let series = Curve { values: self.harmonic(0), ..Curve::default() };
        let (svg, hover) = scatter::draw(&self.heading, (self.units, &self.axis_name), parameters, &series);
        (svg, hover, note)
    }

    /// A grid: maps or curves, in panels over slices of further axes. Slices of the first of these stand in columns,
    /// those of the next one, or the harmonics, in rows.
    fn over(&self, axes: &[Coordinate], view: &View) -> Shown {
        let slow: Vec<&Coordinate> = view.panels.iter().map(|axis| &axes[*axis]).collect();
        let most = |depth| match depth {
            0 => MOST_ACROSS,
            1 if self.harmonics == 1 => MOST_DOWN,
            _ => 1,
        };
        let chosen: Vec<Vec<usize>> =
            (0..slow.len()).map(|depth| self.spread(axes, view.panels[depth], most(depth))).collect();
        let mut notes: Vec<String> =
            slow.iter().zip(&chosen).filter_map(|(axis, picked)| some_of(axis, picked)).collect();
        notes.extend(view.note(axes));
        let most_harmonics = if slow.is_empty() { MOST_HARMONICS } else { MOST_ROWS };
        notes.extend(self.first_of(most_harmonics));
        let panels = self.panels(axes, view, &chosen, most_harmonics);
        let columns = match chosen.first() {
            Some(first) => first.len(),
            None if panels.len() > 2 => 3,
            None => panels.len(),
        };
        let x = &axes[view.x];
        let note = notes.join(" ");
        match view.y {
            Some(y) => self.maps(&axes[y], x, columns, panels, note),
            None => {
                let names = self.names(axes, view);
                let followed = view.x + 1 == axes.len();
                let panels = panels.into_iter().map(|panel| self.lines(panel, &names, followed)).collect();
                let by = view.curves.map(|axis| &axes[axis]);
                let by = by.map_or(String::new(), |axis| match axis.name.as_str() {
                    DIRECTION => WAYS.to_owned(),
                    _ => short(axis),
                });
                let style = if x.words.is_empty() { Style::Lines } else { Style::Symbols };
                self.curves((x, &by, style), columns, panels, note)
            }
        }
    }

    /// The curves of a panel, a second state's after each; jumps count where they are `followed` along the axis.
    fn lines(&self, slice: Slice, names: &[String], followed: bool) -> (String, Vec<Curve>) {
        let Slice { caption, instances, values, second } = slice;
        let length = instances.len() / names.len().max(1);
        let of = |table: &[bool], rows: &[usize]| -> Vec<bool> {
            let here = rows.iter().filter(|_| followed);
            here.filter_map(|i| table.get(*i).copied()).collect()
        };
        let mut series = Vec::new();
        for (number, name) in names.iter().enumerate() {
            let range = number * length..(number + 1) * length;
            let rows = &instances[range.clone()];
            let states = [Some(&values), second.as_ref()];
            for (order, states) in states.into_iter().enumerate().filter_map(|(n, one)| Some((n, one?))) {
                let branch = &self.branch[order];
                let (jumps, torn) = if order == 0 {
                    (of(&self.jumps, rows), of(&self.torn, rows))
                } else {
                    (Vec::new(), Vec::new())
                };
                series.push(Curve {
                    name: name.clone(),
                    values: states[range.clone()].to_vec(),
                    second: order == 1,
                    jumps,
                    torn,
                    branch: rows.iter().filter_map(|i| branch.get(*i).copied()).collect(),
                });
            }
        }
        (caption, series)
    }

    /// Some values of an axis, evenly spread over those that have any result.
    fn spread(&self, axes: &[Coordinate], axis: usize, most: usize) -> Vec<usize> {
        let length = axes[axis].values.len();
        let stride: usize = axes[axis + 1..].iter().map(|one| one.values.len()).product();
        let mut there = vec![false; length];
        for (number, (_, state)) in self.states.iter().enumerate() {
            if state.has_value() || matches!(state, State::Zero | State::Excluded) {
                there[number / self.harmonics / stride % length] = true;
            }
        }
        let told: Vec<usize> = (0..length).filter(|at| there[*at]).collect();
        match told.is_empty() {
            true => spread(length, most),
            false => spread(told.len(), most).into_iter().map(|at| told[at]).collect(),
        }
    }

    /// What the curves of a panel are called.
    fn names(&self, axes: &[Coordinate], view: &View) -> Vec<String> {
        match view.curves {
            Some(axis) => axes[axis].values.iter().map(|value| shown(&axes[axis], *value)).collect(),
            None => vec![String::new()],
        }
    }

    /// A panel for each harmonic and each pair of what is chosen of the first two slow axes.
    fn panels(
        &self,
        axes: &[Coordinate],
        view: &View,
        chosen: &[Vec<usize>],
        most_harmonics: usize,
    ) -> Vec<Slice> {
        let mut panels = Vec::new();
        let single = [0];
        let of = |depth: usize| chosen.get(depth).map_or(&single[..], Vec::as_slice);
        for harmonic in 0..self.harmonics.min(most_harmonics) {
            for row in of(1) {
                for column in of(0) {
                    let picks = [*column, *row].into_iter().chain(chosen.iter().skip(2).map(|one| one[0]));
                    let picks: Vec<usize> = picks.take(chosen.len()).collect();
                    let slow = view.panels.iter().map(|axis| &axes[*axis]).zip(&picks).take(2);
                    let slow: Vec<(&Coordinate, f64)> =
                        slow.map(|(axis, &pick)| (axis, axis.values[pick])).collect();
                    let order = (self.harmonics > 1).then(|| format!("harmonic {}", harmonic + 1));
                    let instances = view.instances(axes, &picks);
                    let take = |states: &Vec<(f64, State)>| -> Vec<(f64, State)> {
                        instances.iter().map(|i| states[i * self.harmonics + harmonic]).collect()
                    };
                    panels.push(Slice {
                        caption: above(&slow, order),
                        values: take(&self.states),
                        second: self.second.as_ref().map(take),
                        instances,
                    });
                }
            }
        }
        panels
    }

    fn curves(
        &self,
        (x, by, style): (&Coordinate, &str, Style),
        columns: usize,
        panels: Vec<(String, Vec<Curve>)>,
        note: String,
    ) -> Shown {
        let (heading, units, long_name) = (self.heading.as_str(), self.units, self.axis_name.as_str());
        let branches = self.branches.clone();
        // Ways along a curve say themselves what they are.
        let ways = by == WAYS;
        let by = if ways { String::new() } else { by.to_owned() };
        let curves = CurvePlot { heading, units, long_name, x, columns, by, ways, branches, style, panels };
        let (svg, hover) = curves.draw();
        (svg, hover, note)
    }

    fn maps(
        &self,
        y: &Coordinate,
        x: &Coordinate,
        columns: usize,
        panels: Vec<Slice>,
        note: String,
    ) -> Shown {
        let (units, long_name, title) = (self.units, self.axis_name.as_str(), self.heading.clone());
        let [branch, _] = &self.branch;
        let panel = |Slice { caption, values, instances, .. }: Slice| Panel {
            caption,
            values,
            branches: instances.iter().filter_map(|i| branch.get(*i).copied()).collect(),
            lines: Vec::new(),
        };
        let panels = panels.into_iter().map(panel).collect();
        let (svg, hover) =
            Heatmap { title, units, long_name, x, y, columns, panels, lines: Vec::new() }.draw_told();
        (svg, hover, note)
    }
}

/// A panel's caption, its instances, their values, and the values of their second states.
struct Slice {
    caption: String,
    instances: Vec<usize>,
    values: Vec<(f64, State)>,
    /// Of the second states, where there are any.
    second: Option<Vec<(f64, State)>>,
}

/// What stands above a panel: of what the values are as far as there is room.
fn above(slow: &[(&Coordinate, f64)], order: Option<String>) -> String {
    const ROOM: f64 = 256.0;
    let words = |named: usize| {
        let one = |(n, (axis, value)): (usize, &(&Coordinate, f64))| match n < named {
            true => caption(axis, *value),
            false => shown(axis, *value),
        };
        slow.iter().enumerate().map(one).chain(order.clone()).collect::<Vec<_>>().join(", ")
    };
    let fits = |named: &usize| text_width(&words(*named), SMALL) <= ROOM;
    words((0..=slow.len()).rev().find(fits).unwrap_or(0))
}

/// A note where not all values of an axis are shown.
fn some_of(axis: &Coordinate, picked: &[usize]) -> Option<String> {
    let values: Vec<String> = picked.iter().map(|&i| shown(axis, axis.values[i])).collect();
    (picked.len() < axis.values.len()).then(|| {
        format!(
            "{}: {} of {} values ({}).",
            capital(label(axis)),
            picked.len(),
            axis.values.len(),
            values.join(", ")
        )
    })
}

/// At most so many of `count` numbers, evenly spread, the first and the last among them; the middle one if
/// only one may be chosen.
fn spread(count: usize, most: usize) -> Vec<usize> {
    match (count, most) {
        (0, _) => Vec::new(),
        (_, 0 | 1) => vec![count / 2],
        _ if count <= most => (0..count).collect(),
        _ => (0..most).map(|i| (i * (count - 1) + (most - 1) / 2) / (most - 1)).collect(),
    }
}

/// A name safe as that of a file anywhere.
fn file_name(name: &str) -> String {
    let safe = |c: char| if c.is_ascii_alphanumeric() || matches!(c, '_' | '-') { c } else { '_' };
    name.chars().map(safe).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_are_spread_from_first_to_last() {
        assert_eq!(spread(32, 4), [0, 10, 21, 31]);
        assert_eq!(spread(3, 4), [0, 1, 2]);
        assert_eq!(spread(5, 1), [2]);
        assert_eq!(spread(1, 1), [0]);
    }
}
