//! The picture of one variable, over as many axes as the results have.

use super::ReportError;
use super::curve::{self, Series};
use super::frame::State;
use super::heatmap::{Heatmap, Panel, brief, label};
use super::pictures::{Picture, capital, shown, states};
use crate::store::{Coordinate, Results, Variable};

/// Harmonics shown at most: curves or maps side by side, and rows of slices.
const MOST_HARMONICS: usize = 6;
const MOST_ROWS: usize = 3;

/// A variable as its picture names and shows it.
struct Subject<'a> {
    units: &'a str,
    heading: String,
    axis_name: String,
    /// Values that each instance has, 1 where they are no harmonics.
    harmonics: usize,
    /// Values with what became of each, an instance's side by side.
    states: Vec<(f64, State)>,
}

/// The picture of a variable; none of a single number.
pub(super) fn draw(results: &Results, variable: &Variable) -> Result<Option<Picture>, ReportError> {
    let name = if variable.long_name.is_empty() { &variable.name } else { &variable.long_name };
    let subject = Subject {
        units: &variable.units,
        heading: capital(name),
        axis_name: brief(name, &variable.name),
        harmonics: variable.harmonics.unwrap_or(1).max(1),
        states: states(results, variable),
    };
    let (svg, note) = match (results.list, results.axes.as_slice()) {
        (_, []) if subject.harmonics > 1 => (subject.over_harmonics()?, String::new()),
        (_, []) if results.status.len() == 1 => return Ok(None),
        (true, []) => {
            subject.over_list(&[numbers("instance", "instance number", 0..results.status.len())])?
        }
        (true, parameters) => subject.over_list(parameters)?,
        (false, []) => return Ok(None),
        (false, [x]) => subject.over_line(x)?,
        (false, [y, x]) => subject.over_plane(y, x)?,
        (false, [slow @ .., y, x]) => subject.over_slices(slow, y, x)?,
    };
    let file = format!("{}.svg", file_name(&variable.name));
    Ok(Some(Picture { file, title: subject.heading, note, svg }))
}

/// Whole numbers as an axis.
fn numbers(name: &str, long_name: &str, numbers: std::ops::Range<usize>) -> Coordinate {
    Coordinate {
        name: name.into(),
        units: "1".into(),
        long_name: long_name.into(),
        values: numbers.map(|number| number as f64).collect(),
    }
}

impl Subject<'_> {
    /// The values of one harmonic, counted from 0.
    fn harmonic(&self, number: usize) -> Vec<(f64, State)> {
        self.states.iter().skip(number).step_by(self.harmonics).copied().collect()
    }

    /// The first harmonics, each as a curve, and what is left out.
    fn first_harmonics(&self) -> (Vec<Series>, String) {
        let one = |number| Series { name: format!("harmonic {}", number + 1), values: self.harmonic(number) };
        let series = (0..self.harmonics.min(MOST_HARMONICS)).map(one).collect();
        (series, self.first_of(MOST_HARMONICS).unwrap_or_default())
    }

    /// A note where there are more harmonics than are shown.
    fn first_of(&self, most: usize) -> Option<String> {
        (self.harmonics > most).then(|| format!("The first {most} of {} harmonics.", self.harmonics))
    }

    /// The harmonics of the one instance as a curve.
    fn over_harmonics(&self) -> Result<String, ReportError> {
        let orders = numbers("harmonic", "harmonic of the drive frequency", 1..self.harmonics + 1);
        let values = self.states.iter().take(self.harmonics).copied().collect();
        let series = [Series { name: String::new(), values }];
        curve::curves(&self.heading, self.units, &self.axis_name, &orders, &series)
    }

    /// Clouds of points, one for each parameter, and a note on what is left out.
    fn over_list(&self, parameters: &[Coordinate]) -> Result<(String, String), ReportError> {
        let note = match self.harmonics {
            1 => String::new(),
            harmonics => format!("The first of {harmonics} harmonics."),
        };
        let series = Series { name: String::new(), values: self.harmonic(0) };
        let svg = curve::scatter(&self.heading, self.units, &self.axis_name, parameters, &series)?;
        Ok((svg, note))
    }

    /// Curves, and a note.
    fn over_line(&self, x: &Coordinate) -> Result<(String, String), ReportError> {
        let (series, note) = self.first_harmonics();
        Ok((curve::curves(&self.heading, self.units, &self.axis_name, x, &series)?, note))
    }

    /// Maps, and a note.
    fn over_plane(&self, y: &Coordinate, x: &Coordinate) -> Result<(String, String), ReportError> {
        let (series, note) = self.first_harmonics();
        let panel = |one: Series| Panel {
            caption: if self.harmonics > 1 { one.name } else { String::new() },
            values: one.values,
            lines: Vec::new(),
        };
        let panels: Vec<Panel> = series.into_iter().map(panel).collect();
        let columns = if panels.len() > 2 { 3 } else { panels.len() };
        Ok((self.maps(self.heading.clone(), y, x, columns, panels)?, note))
    }

    /// Maps, and a note: slices of the slowest axis stand in columns, those of the next one or the harmonics in rows.
    fn over_slices(
        &self,
        slow: &[Coordinate],
        y: &Coordinate,
        x: &Coordinate,
    ) -> Result<(String, String), ReportError> {
        let chosen = self.chosen(slow);
        let mut notes: Vec<String> =
            slow.iter().zip(&chosen).filter_map(|(axis, picked)| some_of(axis, picked)).collect();
        notes.extend(self.first_of(MOST_ROWS));
        if notes.is_empty() {
            let names: Vec<&str> = slow.iter().map(label).collect();
            notes.push(format!("One picture for each value of: {}.", names.join(", ")));
        }
        let named: Vec<&str> = slow.iter().take(2).map(label).collect();
        let title = format!("{}, by {}", self.heading, named.join(" and "));
        let panels = self.slices(slow, &chosen, x.values.len() * y.values.len());
        Ok((self.maps(title, y, x, chosen[0].len(), panels)?, notes.join(" ")))
    }

    /// Which values of each slow axis are shown.
    fn chosen(&self, slow: &[Coordinate]) -> Vec<Vec<usize>> {
        let most = |depth| match depth {
            0 => 4,
            1 if self.harmonics == 1 => 3,
            _ => 1,
        };
        slow.iter().enumerate().map(|(depth, axis)| spread(axis.values.len(), most(depth))).collect()
    }

    /// A panel of `plane` values for each harmonic and each pair of what is chosen of the first two axes.
    fn slices(&self, slow: &[Coordinate], chosen: &[Vec<usize>], plane: usize) -> Vec<Panel> {
        let mut panels = Vec::new();
        for harmonic in 0..self.harmonics.min(MOST_ROWS) {
            let values = self.harmonic(harmonic);
            for row in 0..chosen.get(1).map_or(1, Vec::len) {
                for column in 0..chosen[0].len() {
                    let picked = chosen.iter().zip([column, row].into_iter().chain(std::iter::repeat(0)));
                    let picks: Vec<usize> = picked.map(|(chosen, place)| chosen[place]).collect();
                    let mut captions: Vec<String> = slow
                        .iter()
                        .zip(&picks)
                        .take(2)
                        .map(|(axis, &pick)| shown(axis, axis.values[pick]))
                        .collect();
                    if self.harmonics > 1 {
                        captions.push(format!("harmonic {}", harmonic + 1));
                    }
                    let slice =
                        slow.iter().zip(&picks).fold(0, |all, (axis, pick)| all * axis.values.len() + pick);
                    let values = values.iter().skip(slice * plane).take(plane).copied().collect();
                    panels.push(Panel { caption: captions.join(", "), values, lines: Vec::new() });
                }
            }
        }
        panels
    }

    fn maps(
        &self,
        title: String,
        y: &Coordinate,
        x: &Coordinate,
        columns: usize,
        panels: Vec<Panel>,
    ) -> Result<String, ReportError> {
        let (units, long_name) = (self.units, self.axis_name.as_str());
        Heatmap { title, units, long_name, x, y, columns, panels, lines: Vec::new() }.draw()
    }
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
