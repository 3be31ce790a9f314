//! A table as instruments and spreadsheets write it: commas, semicolons or tabs between cells, decimal commas beside the
//! latter two, comments, blank lines, a mark of byte order.

use anyhow::{Context, bail};
use std::path::Path;

/// Cells of a text file, with the line that each row stands on.
pub(super) struct Sheet {
    pub name: String,
    pub head: Vec<String>,
    pub rows: Vec<(u64, Vec<String>)>,
    /// What stands between cells.
    separator: u8,
}

impl Sheet {
    pub fn read(path: &Path) -> anyhow::Result<Self> {
        let name = path.display().to_string();
        let bytes = std::fs::read(path).with_context(|| format!("cannot read {name}"))?;
        let text = String::from_utf8(bytes)
            .ok()
            .with_context(|| format!("{name} is not UTF-8 text; save it as CSV in UTF-8"))?;
        Self::of(name, text.strip_prefix('\u{FEFF}').unwrap_or(&text))
    }

    fn of(name: String, text: &str) -> anyhow::Result<Self> {
        let first = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
        let first = first.with_context(|| format!("{name} is empty"))?;
        let separator = [b'\t', b';'].into_iter().find(|one| first.as_bytes().contains(one)).unwrap_or(b',');
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(separator)
            .flexible(true)
            .has_headers(false)
            .trim(csv::Trim::All)
            .comment(Some(b'#'))
            .from_reader(text.as_bytes());
        let mut rows = Vec::new();
        for record in reader.records() {
            let record = record.with_context(|| format!("{name} is no table"))?;
            // A quotation mark behind a blank is no beginning of a cell to the reader.
            let plain = |cell: &str| cell.trim_matches('"').trim().to_owned();
            let cells: Vec<String> = record.iter().map(plain).collect();
            if cells.iter().any(|cell| !cell.is_empty()) {
                rows.push((record.position().map_or(0, csv::Position::line), cells));
            }
        }
        if rows.len() < 2 {
            bail!("{name} has no rows below its header");
        }
        let (_, head) = rows.remove(0);
        if head.iter().all(|cell| cell.parse::<f64>().is_ok()) {
            bail!(
                "{name} has no header: expected names with units, such as `gap [nm], amplitude [nm], phase [deg]`"
            );
        }
        let sheet = Self { name, head, rows, separator };
        sheet.rows.iter().try_for_each(|(line, cells)| sheet.length(*line, cells))?;
        Ok(sheet)
    }

    fn length(&self, line: u64, cells: &[String]) -> anyhow::Result<()> {
        let rest = cells.get(self.head.len()..).unwrap_or_default();
        if cells.len() >= self.head.len() && rest.iter().all(String::is_empty) {
            return Ok(());
        }
        let decimal = match self.separator {
            b',' => "; decimal commas need `;` or tabs between cells",
            _ => "",
        };
        bail!("{}: found {} cells, expected {}{decimal}", self.at(line), cells.len(), self.head.len())
    }

    /// Where a line is, for messages.
    pub fn at(&self, line: u64) -> String {
        format!("{} line {line}", self.name)
    }

    /// A number as text with a decimal point; nothing where the cell is empty or says that there is none.
    pub fn number<'a>(&self, cell: &'a str) -> Option<std::borrow::Cow<'a, str>> {
        let none = cell.is_empty() || matches!(cell.to_lowercase().as_str(), "nan" | "na" | "-" | "--");
        // A thousands' separator beside a decimal one is not guessed at.
        let comma = self.separator != b',' && cell.matches(',').count() == 1 && !cell.contains('.');
        (!none).then(|| if comma { cell.replace(',', ".").into() } else { cell.into() })
    }
}

#[cfg(test)]
mod tests {
    use super::Sheet;

    /// Truth: the same two rows, by hand.
    #[test]
    fn tables_of_all_kinds_are_the_same() {
        for text in [
            "gap [nm],amplitude [nm]\n25,19.5\n24.5,19.25\n",
            "# taken today\r\n\r\ngap [nm] ; amplitude [nm]\r\n25;19,5\r\n\r\n# a pause\r\n24,5;19,25\r\n",
            "gap [nm]\tamplitude [nm]\t\n25\t19,5\t\n24.5\t19.25\t",
            "\n\"gap [nm]\", \"amplitude [nm]\"\n25, 19.5\n24.5, 19.25",
        ] {
            let sheet = Sheet::of("a.csv".into(), text).unwrap();
            let numbers: Vec<Vec<f64>> = sheet
                .rows
                .iter()
                .map(|(_, cells)| {
                    cells.iter().take(2).map(|cell| sheet.number(cell).unwrap().parse().unwrap()).collect()
                })
                .collect();
            assert_eq!(numbers, [[25.0, 19.5], [24.5, 19.25]], "{text}");
            assert_eq!(sheet.head[..2], ["gap [nm]", "amplitude [nm]"], "{text}");
        }
        let of = |text: &str| Sheet::of("a.csv".into(), text).err().unwrap().to_string();
        assert!(
            of("gap [nm],amplitude [nm]\n25,0,19,5\n")
                .contains("a.csv line 2: found 4 cells, expected 2; decimal")
        );
        assert!(of("gap [nm]\n").contains("no rows") && of("").contains("empty"));
        assert!(of("1,2\n3,4\n").contains("no header: expected names with units"));
        let sheet = Sheet::of("a.csv".into(), "a;b\n1.234,5;nan\n").unwrap();
        assert_eq!((sheet.number("1.234,5").as_deref(), sheet.number("NaN")), (Some("1.234,5"), None));
    }
}
