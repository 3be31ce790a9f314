//! The rows of a measured curve: numbers with their standard deviations, each on its way.

use super::observed_curve::{CurvePart, DIRECTION, GAP, Reading, SD};
use super::value::si;
use afmsweep::stats::{CurveColumn, CurveMeasurement};
use anyhow::{Context, bail};

/// A line of the file and its cells.
type Row<'a> = (u64, &'a [String]);

impl Reading<'_> {
    /// The number in a cell, SI; none where there is none.
    fn number(&self, (line, cells): Row, column: usize, units: &str) -> anyhow::Result<Option<f64>> {
        let Some(text) = self.sheet.number(&cells[column]) else { return Ok(None) };
        let value =
            si(&format!("{text} {}", self.units[column]), units).ok().filter(|value| value.is_finite());
        let found = || self.wrong(line, column, &format!("`{}`", cells[column]), "a number");
        Ok(Some(value.with_context(found)?))
    }

    /// What is wrong with a cell.
    fn wrong(&self, line: u64, column: usize, found: &str, expected: &str) -> String {
        let (at, head) = (self.sheet.at(line), &self.sheet.head[column]);
        format!("{at}, column `{head}`: found {found}, expected {expected}")
    }

    /// The rows of ways that the file has, and how many are of another.
    pub fn rows(&self) -> anyhow::Result<(CurveMeasurement, usize)> {
        let study = self.study;
        let value = |(column, part): (usize, &CurvePart)| match part {
            CurvePart::Value(output) => Some((column, *output)),
            _ => None,
        };
        let values: Vec<(usize, usize)> = self.parts.iter().enumerate().filter_map(value).collect();
        if values.is_empty() {
            bail!("{} has no observable: expected one of {}", self.sheet.name, {
                let names: Vec<&str> = study.outputs.iter().map(|one| one.name.as_str()).collect();
                names.join(", ")
            });
        }
        let known: Vec<Option<f64>> =
            values.iter().map(|(_, output)| self.sd_of(*output)).collect::<anyhow::Result<_>>()?;
        let named = |output: &usize| CurveColumn {
            name: study.outputs[*output].name.clone(),
            ..CurveColumn::default()
        };
        let mut measured = CurveMeasurement {
            columns: values.iter().map(|(_, output)| named(output)).collect(),
            ..CurveMeasurement::default()
        };
        let mut other_way = 0;
        for (line, cells) in &self.sheet.rows {
            let row = (*line, &cells[..]);
            let Some(way) = self.way(row)? else {
                other_way += 1;
                continue;
            };
            measured.places.push(self.place(row)?);
            measured.ways.push(way);
            for ((column, output), (into, known)) in
                values.iter().zip(measured.columns.iter_mut().zip(&known))
            {
                let units = &study.outputs[*output].units;
                let value = self.number(row, *column, units)?;
                let sd = match (known, value) {
                    (Some(sd), _) => *sd,
                    (None, None) => f64::NAN,
                    (None, Some(_)) => self.sd(row, *output)?,
                };
                into.values.push(value.unwrap_or(f64::NAN));
                into.sds.push(sd);
            }
        }
        Ok((measured, other_way))
    }

    /// The column that is this.
    fn column(&self, part: CurvePart) -> Option<usize> {
        self.parts.iter().position(|one| *one == part)
    }

    fn place(&self, row: Row) -> anyhow::Result<f64> {
        let travel = self.column(CurvePart::Place { travels: true });
        let column = travel.or(self.column(CurvePart::Place { travels: false })).unwrap_or_default();
        let value = self.number(row, column, &self.coordinate().units)?;
        let value = value.with_context(|| self.wrong(row.0, column, "nothing", "a number"))?;
        Ok(if travel.is_some() { -value } else { value })
    }

    /// The standard deviation of an observable that `--sd` gives for all rows; none where a column does.
    fn sd_of(&self, output: usize) -> anyhow::Result<Option<f64>> {
        let output_of = |name: &str| self.output(name) == Some(output);
        let one = &self.study.outputs[output];
        let column = self.column(CurvePart::Sd(output)).is_some();
        let told = self.args.sds.iter().find(|(name, _)| output_of(name));
        match (told, column) {
            (Some(_), true) => bail!(
                "{0} has a column `{1}{SD}`, and --sd {1} is given: expected one of them",
                self.sheet.name,
                one.name
            ),
            (None, false) => bail!(
                "{0} says no standard deviation of {1}: add a column `{1}{SD} [{2}]`, or --sd {1}=\"{3}\" for all rows",
                self.sheet.name,
                one.name,
                if one.units == "degree" { "deg" } else { &one.units },
                if one.units == "degree" { "0.5 deg".to_owned() } else { format!("0.1 n{}", one.units) },
            ),
            (None, true) => Ok(None),
            (Some((name, text)), false) => {
                let sd = si(text, &one.units).with_context(|| format!("--sd {name}={text}"))?;
                if !(sd > 0.0 && sd.is_finite()) {
                    bail!("--sd {name}={text}: the standard deviation is not above zero");
                }
                Ok(Some(sd))
            }
        }
    }

    /// The standard deviation of an observable in a row.
    fn sd(&self, row: Row, output: usize) -> anyhow::Result<f64> {
        let column = self.column(CurvePart::Sd(output)).unwrap_or_default();
        let sd = self.number(row, column, &self.study.outputs[output].units)?;
        sd.filter(|sd| *sd > 0.0).with_context(|| {
            let found = format!("`{}`", row.1[column]);
            self.wrong(row.0, column, &found, "a standard deviation above zero")
        })
    }

    /// The way of a row; none where the file has not got it.
    fn way(&self, (line, cells): Row) -> anyhow::Result<Option<usize>> {
        let column = self.column(CurvePart::Direction);
        let both = self.study.ways().is_some();
        let (word, place) = match (column, &self.args.direction) {
            (Some(column), _) => {
                (cells[column].as_str(), format!("{}, column `{DIRECTION}`", self.sheet.at(line)))
            }
            (None, Some(word)) => (word.as_str(), "--direction".to_owned()),
            (None, None) if both => bail!(
                "the results file has both ways of its curve: {} needs a column `{DIRECTION}` (approach or retraction), or --direction approach for all rows",
                self.sheet.name
            ),
            (None, None) => return Ok(Some(0)),
        };
        let axis = self.coordinate();
        let falls = axis.values.first() >= axis.values.last();
        let backward = match word.to_lowercase().as_str() {
            "forward" => false,
            "backward" => true,
            "approach" if axis.scene_path == GAP => !falls,
            "retraction" | "retract" if axis.scene_path == GAP => falls,
            _ => {
                let words = if axis.scene_path == GAP { "approach, retraction, " } else { "" };
                bail!("{place}: found `{word}`, expected one of {words}forward, backward")
            }
        };
        Ok(match (both, backward) {
            (true, _) => Some(usize::from(backward)),
            (false, false) => Some(0),
            (false, true) => None,
        })
    }
}
