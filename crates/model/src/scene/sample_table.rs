//! Tables of samples in files: CSV with a header of paths and units, or plain numbers in columns of given names.

use super::address::Address;
use super::axes::MOST_INSTANCES;
use super::plausibility::{self, CHECK_SIZE};
use super::quantities::QUANTITIES;
use super::scene_error::{Checked, Fault};
use crate::suggestion::nearest;
use crate::units::{self, Dimension, shortened};
use std::collections::HashSet;
use std::ops::Range;
use std::path::Path;

/// The column of names of samples.
const ID: &str = "id";
const HEADER: &str = "a header such as `instrument.tip.radius [nm]`, `sample.youngs_modulus [GPa]`";

/// What a file of samples holds.
#[derive(Debug, Default)]
pub(super) struct SampleTable {
    pub columns: Vec<(Address, Vec<f64>)>,
    /// Names of the samples, where the file has them.
    pub ids: Vec<String>,
}

/// What a column of the file holds.
enum Column {
    Id,
    /// A quantity, and the unit of its numbers.
    Quantity(Address, String),
}

/// A file being read, and where the scene names it.
struct Reading<'a> {
    name: &'a str,
    place: Range<usize>,
}

/// Reads the file `name` of `folder`, which the scene names at `place`; with `names` it has no header, and its numbers are
/// in SI units.
pub(super) fn read(
    folder: &Path,
    name: &str,
    names: Option<&[Address]>,
    place: Range<usize>,
) -> Checked<SampleTable> {
    let reading = Reading { name, place };
    let text = reading.text(&folder.join(name))?;
    let table = match names {
        Some(names) => reading.plain(&text, names)?,
        None => reading.csv(&text)?,
    };
    let rows = table.columns.first().map_or(0, |(_, values)| values.len());
    if rows == 0 {
        return Err(reading
            .fault("the table has no rows".into(), "nothing below the header")
            .expected("one row for each sample")
            .help("was the file saved?"));
    }
    Ok(table)
}

impl Reading<'_> {
    fn fault(&self, title: String, label: impl Into<String>) -> Box<Fault> {
        Fault::at(self.place.clone(), title).label(label)
    }

    fn text(&self, path: &Path) -> Checked<String> {
        let bytes = std::fs::read(path).map_err(|error| {
            let label = match error.kind() {
                std::io::ErrorKind::NotFound => "there is no such file".to_owned(),
                _ => error.to_string(),
            };
            self.fault(format!("cannot read the table {}", path.display()), label)
                .expected("a file, by its path from the scene's folder")
                .help("check the name and the folder")
        })?;
        let text = String::from_utf8(bytes).map_err(|error| {
            let offset = error.utf8_error().valid_up_to();
            self.fault(
                format!("the table {} is not UTF-8 text", self.name),
                format!("found another byte at offset {offset}"),
            )
            .expected("a CSV file")
            .help("save it as CSV in UTF-8")
        })?;
        Ok(text.strip_prefix('\u{FEFF}').unwrap_or(&text).to_owned())
    }

    fn csv(&self, text: &str) -> Checked<SampleTable> {
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let unreadable = |error: csv::Error| {
            self.fault(format!("the table {} is no CSV", self.name), error.to_string())
                .expected("rows of cells between commas")
                .help("check quotes and commas there")
        };
        let header = reader.headers().map_err(unreadable)?.clone();
        let columns = self.header(&header)?;
        let mut table = SampleTable::default();
        for column in &columns {
            if let Column::Quantity(address, _) = column {
                table.columns.push((*address, Vec::new()));
            }
        }
        let mut seen = HashSet::new();
        for record in reader.records() {
            let record = record.map_err(unreadable)?;
            let line = record.position().map_or(0, csv::Position::line);
            self.length(record.len(), columns.len(), line)?;
            let mut at = 0;
            for (number, (cell, column)) in record.iter().zip(&columns).enumerate() {
                match column {
                    Column::Id => table.ids.push(self.id(cell, line, &mut seen)?),
                    Column::Quantity(address, unit) => {
                        table.columns[at].1.push(self.number(cell, (*address, unit), (line, number + 1))?);
                        at += 1;
                    }
                }
            }
            self.not_too_many(line as usize)?;
        }
        Ok(table)
    }

    /// What the columns are.
    fn header(&self, header: &csv::StringRecord) -> Checked<Vec<Column>> {
        if header.is_empty() {
            return Err(self
                .fault(format!("the table {} is empty", self.name), "it has no line")
                .expected(HEADER)
                .help("write a header and a row for each sample"));
        }
        if header.iter().all(|cell| cell.parse::<f64>().is_ok()) {
            return Err(self
                .fault(format!("the table {} has no header", self.name), "its first line has numbers alone")
                .expected(HEADER)
                .help(
                    "write one, or name the columns: names = [\"instrument.tip.radius\", ...] (SI units)",
                ));
        }
        let mut columns = Vec::new();
        let mut seen = HashSet::new();
        for (number, cell) in header.iter().enumerate() {
            if !seen.insert(cell) {
                return Err(self
                    .fault(format!("column {} repeats another", number + 1), format!("found `{cell}`"))
                    .expected("each quantity once")
                    .help("remove one of the two"));
            }
            columns.push(match cell == ID {
                true => Column::Id,
                false => self.quantity(cell, number + 1)?,
            });
        }
        if !columns.iter().any(|column| matches!(column, Column::Quantity(..))) {
            return Err(self
                .fault(format!("the table {} has no quantity", self.name), "no column of numbers")
                .expected(HEADER)
                .help("add a column"));
        }
        Ok(columns)
    }

    /// `instrument.tip.radius [nm]`.
    fn quantity(&self, cell: &str, number: usize) -> Checked<Column> {
        let (path, unit) = match cell.strip_suffix(']').and_then(|head| head.rsplit_once('[')) {
            Some((path, unit)) => (path.trim(), unit.trim()),
            None => (cell, ""),
        };
        let Some(address) = Address::find(path) else {
            let known = QUANTITIES.iter().map(|quantity| quantity.path);
            let meant = match cell.contains([';', '\t']) {
                true => Some("write commas between the columns".to_owned()),
                false => nearest(path, known).map(|meant| format!("did you mean `{meant}`?")),
            };
            return Err(self
                .fault(
                    format!("column {number} is no quantity of a scene"),
                    format!("found `{}`", shortened(cell)),
                )
                .expected(HEADER)
                .help("write the quantity's path, with its unit in brackets; a column `id` may name the rows")
                .maybe_help(meant));
        };
        let dimension = address.quantity.dimension;
        let plain = matches!(unit, "" | "1") && dimension == Dimension::Dimensionless;
        match plain || units::parse(&format!("1 {unit}"), dimension).is_ok() {
            true => Ok(Column::Quantity(address, if plain { String::new() } else { unit.to_owned() })),
            false => {
                let found = match unit {
                    "" => "found no unit".to_owned(),
                    unit => format!("found the unit {}", shortened(unit)),
                };
                let form = match dimension {
                    Dimension::Dimensionless => path.to_owned(),
                    other => format!("{path} [{}]", other.si_unit()),
                };
                Err(self
                    .fault(
                        format!("column {number}, `{path}`, needs the unit of {}", dimension.described()),
                        found,
                    )
                    .expected(format!("a header such as `{form}`"))
                    .help("write the unit in brackets behind the path"))
            }
        }
    }

    fn plain(&self, text: &str, names: &[Address]) -> Checked<SampleTable> {
        let mut table =
            SampleTable { columns: names.iter().map(|name| (*name, Vec::new())).collect(), ids: Vec::new() };
        let lines = text.lines().enumerate().map(|(number, line)| (number as u64 + 1, line.trim()));
        for (line, row) in lines.filter(|(_, row)| !row.is_empty() && !row.starts_with('#')) {
            let cells: Vec<&str> =
                row.split(|c: char| c == ',' || c.is_whitespace()).filter(|cell| !cell.is_empty()).collect();
            self.length(cells.len(), names.len(), line)?;
            for (number, (cell, (address, values))) in cells.iter().zip(&mut table.columns).enumerate() {
                let unit = match address.quantity.dimension {
                    Dimension::Dimensionless => String::new(),
                    dimension => dimension.si_unit().to_string(),
                };
                values.push(self.number(cell, (*address, &unit), (line, number + 1))?);
            }
            self.not_too_many(line as usize)?;
        }
        Ok(table)
    }

    fn length(&self, found: usize, wanted: usize, line: u64) -> Checked<()> {
        if found == wanted {
            return Ok(());
        }
        let cells = |count: usize| format!("{count} cell{}", if count == 1 { "" } else { "s" });
        Err(self
            .fault(
                format!("line {line} of the table is of another length"),
                format!("found {}", cells(found)),
            )
            .expected(format!("{}, one for each column", cells(wanted)))
            .help("every row has a cell for every column"))
    }

    fn not_too_many(&self, rows: usize) -> Checked<()> {
        if rows <= MOST_INSTANCES + 1 {
            return Ok(());
        }
        Err(self
            .fault("the table is too long".into(), format!("more than {MOST_INSTANCES} rows"))
            .expected(format!("at most {MOST_INSTANCES} rows"))
            .help("split the table into several"))
    }

    fn id(&self, cell: &str, line: u64, seen: &mut HashSet<String>) -> Checked<String> {
        let trouble = match cell {
            "" => "is empty",
            _ if !seen.insert(cell.to_owned()) => "is there twice",
            _ => return Ok(cell.to_owned()),
        };
        Err(self
            .fault(
                format!("the id in line {line} of the table {trouble}"),
                format!("found \"{}\"", shortened(cell)),
            )
            .expected("a name of its own for each row")
            .help("name it, or leave the column out"))
    }

    /// A cell's value, read as the scene reads it: 30 and nm are the double nearest to 30e-9.
    fn number(
        &self,
        cell: &str,
        (address, unit): (Address, &str),
        (line, column): (u64, usize),
    ) -> Checked<f64> {
        let fault = |what: &str| {
            self.fault(
                format!("line {line}, column {column} of the table (`{}`) {what}", address.path()),
                format!("found \"{}\"", shortened(cell)),
            )
        };
        let number = cell.parse::<f64>().ok().filter(|number| !number.is_nan());
        let number = number
            .and_then(|_| units::parse(format!("{cell} {unit}").trim(), address.quantity.dimension).ok());
        let Some(number) = number else {
            return Err(fault("is no number").expected("a plain number").help(match cell {
                "" => "fill the cell, or leave the row out",
                _ => "write the number alone: its unit stands in the header",
            }));
        };
        let domain = address.quantity.domain;
        if !domain.holds(number) {
            return Err(fault("has an impossible value")
                .expected(domain.described())
                .help(domain.advice(number)));
        }
        match plausibility::sizes_missed(number, address) {
            None => Ok(number),
            Some(sizes) => Err(fault("has an impossible size").expected(sizes).help(CHECK_SIZE)),
        }
    }
}
