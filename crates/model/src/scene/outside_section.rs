//! `[[contact.outside]]` and `contact.table`: forces beside a contact.

use super::address::Address;
use super::draft::Draft;
use super::params::*;
use super::scene_error::{Checked, Fault};
use super::tabulated_force::RetractionFault;
use super::values::{self, Key, Value};
use crate::kernel::LENGTH;
use crate::kernel::contact::TERMS;
use crate::kernel::contact::force_table::KNOTS;
use crate::units::{self, Dimension, shortened};
use std::ops::Range;
use std::sync::Arc;

pub(super) const OUTSIDE: &str = "contact.outside";
pub(super) const TABLE: &str = "contact.table";
const FORM: &str = "sections [[contact.outside]], each with force = \"electrostatic\", \"double-layer\", \"hydration\" or \"capillary\"";
const COLUMNS: &str = "columns `distance [nm]` or `indentation [nm]`, `force [nN]`, and `force_retract [nN]` if it differs on the way out";
/// A table that ends far away with more than this share of its largest force lacks a part.
const FAR_SHARE: f64 = 1e-3;

/// Keys of a force that are quantities, the needed ones first, and how many are needed.
pub(super) fn keys(force: &OutsideForce) -> (&'static [&'static str], usize) {
    match force {
        OutsideForce::Electrostatic { .. } => {
            (&["bias", "cut_off", "contact_potential", "cone_half_angle", "cone_height"], 2)
        }
        OutsideForce::DoubleLayer { .. } => {
            (&["tip_charge", "sample_charge", "screening_length", "permittivity"], 3)
        }
        OutsideForce::Hydration { .. } => (&["decay_length", "pressure", "strength", "period", "phase"], 1),
        OutsideForce::Capillary { .. } => (&["strength", "breaks_at", "forms_at", "decay_length"], 2),
    }
}

impl Draft {
    /// Reads the list of forces.
    pub(super) fn outside(&mut self, key: &Key, value: &Value) -> Checked<()> {
        let list = values::list(value, OUTSIDE, FORM)?;
        if list.len() > TERMS {
            return Err(Fault::at(value.span(), "`contact.outside` lists too many forces")
                .label(format!("found {}", list.len()))
                .expected(format!("at most {TERMS}, or {} beside a table", TERMS - 1))
                .help("leave out the weakest"));
        }
        self.say(OUTSIDE.to_owned(), key.span());
        for (index, entry) in list.iter().enumerate() {
            let path = format!("{OUTSIDE}.{index}");
            let table = values::table(entry, &path, FORM)?;
            let Some(word) = table.get("force") else {
                return Err(Fault::at(entry.span(), format!("`{path}` does not say which force it is"))
                    .label("`force` is missing")
                    .expected(FORM)
                    .help("add a line such as force = \"electrostatic\""));
            };
            let force = values::keyword(word, &format!("{path}.force"), &OutsideForce::WORDS)?;
            self.params.contact.outside.push(force);
            let (known, _) = keys(&force);
            let words: &[&str] = if force.remembers() { &["force", "model"] } else { &["force"] };
            let all: Vec<&str> = words.iter().chain(known).copied().collect();
            for (key, value) in table.iter().filter(|(key, _)| key.get_ref() != "force") {
                let own = format!("{path}.{}", key.get_ref());
                if words.contains(&key.get_ref().as_ref()) {
                    let read = values::keyword(value, &own, &NeckModel::WORDS);
                    if let (Some(word), Some(OutsideForce::Capillary { model, .. })) =
                        (self.faults.take(read), self.params.contact.outside.last_mut())
                    {
                        *model = word;
                    }
                    continue;
                }
                let read = match Address::find(&own).filter(|_| known.contains(&key.get_ref().as_ref())) {
                    None => Err(values::unknown_key(key, &path, &all)),
                    Some(address) => values::quantity(value, address, &own).map(|number| (address, number)),
                };
                if let Some((address, number)) = self.faults.take(read) {
                    address.set(&mut self.params, number);
                    self.say(own, key.span());
                }
            }
        }
        Ok(())
    }

    /// Reads the table, from a file or from lists.
    pub(super) fn table(&mut self, key: &Key, value: &Value) -> Checked<()> {
        let rows = match value.get_ref().as_str() {
            Some(name) => self.file(name, value)?,
            None => lists(value)?,
        };
        let ForceRows { places, forces, back } = ordered(rows, value.span())?;
        let fault = |title: &str, label: &str| Fault::at(value.span(), title).label(label);
        let full = || {
            fault(
                "there is no room for one more table of forces",
                "this process has used very many different ones",
            )
            .expected("at most some 4,000 in a process")
            .help("start anew")
        };
        let table = TabulatedForce::new(places, forces).ok_or_else(full)?;
        let table = match back {
            None => table,
            Some(back) => table.with_retraction(back).map_err(|reason| match reason {
                RetractionFault::NoRoom => full(),
                RetractionFault::Gains => {
                    fault("the way out gives back more work than the way in takes", "`force_retract` lies above `force`")
                        .expected("a force on the way out that pulls more, or pushes less, than on the way in")
                        .help("exchange the two columns, if `force` is the retraction")
                }
                RetractionFault::ApartInside | RetractionFault::ApartFar => {
                    let place = if reason == RetractionFault::ApartFar { "farthest" } else { "innermost" };
                    fault("the two ways of the table of forces do not meet", &format!("they differ at the {place} place"))
                        .expected("forces that are the same, to a thousandth of the largest, at both ends")
                        .help("add rows up to where they meet: the way out begins there, once the tip has been so deep")
                }
            })?,
        };
        self.params.contact.table = Some(Arc::new(table));
        self.say(TABLE.to_owned(), key.span());
        Ok(())
    }

    fn file(&self, name: &str, value: &Value) -> Checked<ForceRows> {
        let fault = |title: String, label: String| {
            Fault::at(value.span(), title).label(label).expected(format!("a CSV file with {COLUMNS}"))
        };
        // A results file may lie elsewhere than its scene did: whoever reads that again stands where it was run.
        let beside = self.folder.join(name);
        let path = if beside.exists() { beside } else { name.into() };
        let text = std::fs::read_to_string(&path).map_err(|error| {
            fault(format!("cannot read the table of forces {}", path.display()), error.to_string())
                .help("give its path from the scene's folder")
        })?;
        let mut reader = csv::ReaderBuilder::new()
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.trim_start_matches('\u{FEFF}').as_bytes());
        let unreadable = |error: csv::Error| {
            fault(format!("the table {name} is no CSV"), error.to_string())
                .help("check quotes and commas there")
        };
        let header = reader.headers().map_err(unreadable)?.clone();
        let (place, force, back) = columns(name, &header, &fault)?;
        let mut all = ForceRows { back: back.is_some().then(Vec::new), ..ForceRows::default() };
        for record in reader.records() {
            let record = record.map_err(unreadable)?;
            let line = record.position().map_or(0, csv::Position::line);
            let number = |(column, unit, sign): &ForceColumn, dimension| {
                let cell = record.get(*column).unwrap_or_default();
                match units::parse(&format!("{cell} {unit}"), dimension) {
                    Ok(number) if number.is_finite() => Ok(sign * number),
                    _ => Err(fault(
                        format!("line {line} of the table {name} has no number in column {}", column + 1),
                        format!("found `{}`", shortened(cell)),
                    )
                    .help("write a finite number there, or remove the line")),
                }
            };
            all.places.push(number(&place, Dimension::Length)?);
            all.forces.push(number(&force, Dimension::Force)?);
            if let (Some(forces), Some(back)) = (&mut all.back, &back) {
                forces.push(number(back, Dimension::Force)?);
            }
        }
        Ok(all)
    }
}

/// The rows of a table: indentations, m, forces on the way in, N, and on the way out, if they differ.
#[derive(Default)]
struct ForceRows {
    places: Vec<f64>,
    forces: Vec<f64>,
    back: Option<Vec<f64>>,
}

/// A column of the file: its number, the unit of its numbers, and their sign.
type ForceColumn = (usize, String, f64);

/// Which columns the file has: those of places, of forces, and of forces on the way out.
fn columns(
    name: &str,
    header: &csv::StringRecord,
    fault: &dyn Fn(String, String) -> Box<Fault>,
) -> Checked<(ForceColumn, ForceColumn, Option<ForceColumn>)> {
    let mut columns: [Option<ForceColumn>; 3] = [None, None, None];
    for (number, cell) in header.iter().enumerate() {
        let (word, unit) =
            cell.strip_suffix(']').and_then(|head| head.rsplit_once('[')).unwrap_or((cell, ""));
        let (place, dimension, sign) = match word.trim() {
            "indentation" => (0, Dimension::Length, 1.0),
            "distance" => (0, Dimension::Length, -1.0),
            "force" => (1, Dimension::Force, 1.0),
            "force_retract" => (2, Dimension::Force, 1.0),
            _ => {
                return Err(fault(
                    format!("column {} of the table {name} is not known", number + 1),
                    format!("found `{}`", shortened(cell)),
                )
                .help("name the columns by these words, with their units in brackets"));
            }
        };
        if columns[place].is_some() || units::parse(&format!("1 {unit}"), dimension).is_err() {
            return Err(fault(
                format!(
                    "column {} of the table {name} is not {} with its unit",
                    number + 1,
                    dimension.described()
                ),
                format!("found `{}`", shortened(cell)),
            )
            .help("give each column once, with its unit in brackets"));
        }
        columns[place] = Some((number, unit.to_owned(), sign));
    }
    let [Some(place), Some(force), back] = columns else {
        return Err(fault(
            format!("the table {name} lacks a column"),
            format!("found {} columns", header.len()),
        )
        .help("name the columns in its first line"));
    };
    Ok((place, force, back))
}

/// `{ indentation = [...], force = [...] }`, or with `distance`.
fn lists(value: &Value) -> Checked<ForceRows> {
    const LISTS: &str = "the name of a file, or lists such as { distance = [\"5 nm\", \"1 nm\"], force = [\"0 nN\", \"-1 nN\"] }";
    let table = values::table(value, TABLE, LISTS)?;
    const KEYS: [&str; 4] = ["indentation", "distance", "force", "force_retract"];
    if let Some(key) = table.keys().find(|key| !KEYS.contains(&key.get_ref().as_ref())) {
        return Err(values::unknown_key(key, TABLE, &KEYS));
    }
    let list = |key: &str, dimension| {
        let path = format!("{TABLE}.{key}");
        let Some(value) = table.get(key) else { return Ok(None) };
        let entries = values::list(value, &path, LISTS)?;
        let number = |entry: &Value| match values::raw_quantity(entry, dimension, &path)? {
            number if number.is_finite() => Ok(number),
            _ => Err(Fault::at(entry.span(), format!("`{path}` has a value that is not finite"))
                .label("found here")
                .expected("finite values")
                .help("leave the row out")),
        };
        entries.iter().map(number).collect::<Checked<Vec<f64>>>().map(Some)
    };
    let (indentation, distance) =
        (list("indentation", Dimension::Length)?, list("distance", Dimension::Length)?);
    let places = match (indentation, distance) {
        (Some(places), None) => Some(places),
        (None, Some(places)) => Some(places.into_iter().map(|place| -place).collect()),
        _ => None,
    };
    let back = list("force_retract", Dimension::Force)?;
    match (places, list("force", Dimension::Force)?) {
        (Some(places), Some(forces))
            if places.len() == forces.len()
                && back.as_ref().is_none_or(|back| back.len() == forces.len()) =>
        {
            Ok(ForceRows { places, forces, back })
        }
        _ => Err(Fault::at(value.span(), "the table of forces is not complete")
            .label("it has one list of places and one or two of forces, all as long")
            .expected(LISTS)
            .help("give `distance` or `indentation`, and `force`")),
    }
}

/// Places that rise, with their forces.
fn ordered(mut all: ForceRows, at: Range<usize>) -> Checked<ForceRows> {
    let fault = |title: &str, label: String| Fault::at(at.clone(), title).label(label);
    let rows = all.places.len();
    if !(4..KNOTS).contains(&rows) {
        return Err(fault("the table of forces has too few or too many rows", format!("found {rows}"))
            .expected(format!("4 to {} rows", KNOTS - 1))
            .help("thin it out, most where the force is straight"));
    }
    if all.places[0] > all.places[rows - 1] {
        all.places.reverse();
        all.forces.reverse();
        all.back.iter_mut().for_each(|back| back.reverse());
    }
    let (places, forces) = (&all.places, &all.forces);
    for n in 1..rows {
        let back = all.back.as_ref().is_none_or(|back| back[n] == back[n - 1]);
        let corner = places[n] == places[n - 1] && forces[n] == forces[n - 1] && back;
        let third = n > 1 && places[n] == places[n - 2];
        // In the kernel's units they must differ too.
        if !(places[n] - places[n - 1] > 1e-9 * LENGTH || (corner && !third && n + 1 < rows && n > 1)) {
            return Err(fault(
                "the places of the table of forces do not rise or fall evenly",
                format!("found {:e} m after {:e} m, row {}", places[n], places[n - 1], n + 1),
            )
            .expected(
                "places that all rise or all fall; one that stands twice with the same force is a corner",
            )
            .help("sort the rows, and keep one of those at the same place; average a noisy curve first"));
        }
    }
    let peak = forces.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
    if forces[0].abs() > FAR_SHARE * peak {
        return Err(fault(
            "the table of forces ends too early far from the surface",
            format!("found {:e} N there, {:.1e} of its largest force", forces[0], forces[0].abs() / peak),
        )
        .expected(format!("a force of at most {FAR_SHARE:e} of the largest"))
        .help("let it begin farther away; subtract the baseline of a measured curve"));
    }
    Ok(all)
}

/// How the table stands in the resolved scene.
pub(super) fn written(table: &Arc<TabulatedForce>) -> String {
    let list = |values: &[f64], dimension| {
        let all: Vec<String> =
            values.iter().map(|value| format!("\"{}\"", units::format(*value, dimension))).collect();
        all.join(", ")
    };
    let back = table.retraction.as_ref().map_or_else(String::new, |retraction| {
        format!(", force_retract = [{}]", list(&retraction.forces, Dimension::Force))
    });
    format!(
        "table = {{ indentation = [{}], force = [{}]{back} }}",
        list(&table.indentations, Dimension::Length),
        list(&table.forces, Dimension::Force)
    )
}
