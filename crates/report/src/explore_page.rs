//! `explore.html`, a page to explore results: sliders for the dimensions, maps, curves, parallel axes, stored motions, and,
//! where the page has the engine for WebAssembly, cases between the rows.

use super::PageEngine;
use super::frame::{EXCLUDED, status_word};
use super::labels::{capital, label, names, short};
use super::live_page::{WORKER, assembled, page_file};
use super::picture::PictureKind;
use crate::observe::Status;
use crate::store::{Coordinate, Flags, NO_STATE, Results, Variable, Waveforms};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use flate2::Compression;
use flate2::write::GzEncoder;
use serde_json::{Map, Value, json};
use std::io::{self, Write};

macro_rules! own_file {
    ($name:literal) => {
        include_str!(concat!("../../web/explore/", $name))
    };
}

/// The page's scripts: those that it shares with the live page, then its own.
const SCRIPTS: &[&str] = &[
    page_file!("units.js"),
    page_file!("toml.js"),
    page_file!("engine.js"),
    page_file!("plots.js"),
    page_file!("surface.js"),
    own_file!("columns.js"),
    own_file!("choice.js"),
    own_file!("slicemap.js"),
    own_file!("cloud.js"),
    own_file!("parallel.js"),
    own_file!("lines.js"),
    own_file!("waves.js"),
    own_file!("between.js"),
    own_file!("explore.js"),
];

/// Numbers of a page at most, of its columns and, apart from them, of its motions.
const MOST_NUMBERS: usize = 4_000_000;
const MOST_SAMPLES: usize = 1_000_000;
/// Harmonics of an observable that are columns.
const MOST_HARMONICS: usize = 6;
/// From so many axes on, fixed pictures leave some of them out.
const LEAST_AXES: usize = 3;

/// A column of the page, and the numbers of it, one for each row.
struct ExploreColumn<'a> {
    key: String,
    words: String,
    /// For where there is little room.
    short: String,
    unit: &'a str,
    role: &'static str,
    at: Box<dyn Fn(usize) -> f64 + 'a>,
}

/// Whether the fixed pictures of these results leave something to explore: a list, or a grid of three axes or more.
pub(super) fn is_wanted(results: &Results) -> bool {
    results.status.len() > 1 && (results.list || results.axes.len() >= LEAST_AXES)
}

/// The page, or a sentence about why there is none. `file` is the name of the results file.
pub(super) fn explore_page(
    results: &Results,
    (title, file): (&str, &str),
    engine: Option<&PageEngine>,
) -> Result<String, String> {
    let columns = columns(results);
    let count = results.status.len();
    if count * columns.len() > MOST_NUMBERS {
        return Err(format!(
            "explore.html: its {count} rows of {} numbers are more than the {MOST_NUMBERS} numbers of such a page; \
             fewer observables, or a sweep of fewer instances, make it",
            columns.len()
        ));
    }
    let waves = results.waveforms.as_ref().filter(|all| !all.instances.is_empty());
    let kept = waves.map(kept_rows);
    let start = json!({
        "title": title,
        "file": file,
        "count": count,
        "list": results.list,
        "axes": results.axes.iter().map(|one| axis(one, results.list)).collect::<Vec<_>>(),
        "columns": columns.iter().map(head).collect::<Vec<_>>(),
        "words": words(),
        "flags": results.flags.iter().map(flag).collect::<Vec<_>>(),
        "waves": waves.zip(kept.as_ref()).map(|(waves, kept)| wave_head(waves, kept)),
        "live": engine.map(|engine| engine.start.clone()),
    });
    let packed = pack(results, &columns, waves.zip(kept.as_deref()))
        .map_err(|error| format!("explore.html: its numbers cannot be packed: {error}"))?;
    let frame =
        own_file!("explore.html").replace("/*STYLE*/", concat!("/*STYLE*/\n", own_file!("explore.css")));
    let parts = [
        ("/*PACK*/", STANDARD.encode(packed)),
        ("/*ENGINE*/", engine.map(|engine| STANDARD.encode(&engine.library)).unwrap_or_default()),
        ("/*WORKER*/", engine.map(|_| WORKER.to_owned()).unwrap_or_default()),
    ];
    Ok(assembled(&frame, SCRIPTS, &start, &parts))
}

/// A list's own quantities, then the observables, their harmonics, second states, and what else there is of each row.
fn columns(results: &Results) -> Vec<ExploreColumn<'_>> {
    let axes = results.axes.iter().enumerate().filter(|_| results.list).map(|(n, axis)| ExploreColumn {
        key: format!("axis-{n}"),
        words: capital(label(axis)),
        short: capital(&short(axis)),
        unit: &axis.units,
        role: "swept",
        at: Box::new(|row| axis.values.get(row).copied().unwrap_or(f64::NAN)),
    });
    let first = results.variables.iter().flat_map(|one| of_variable(one, "", ""));
    let second = results.other_branch.iter().flat_map(|table| {
        let states = move |row: usize| table.status.get(row).is_some_and(|code| *code != NO_STATE);
        let variables = table.variables.iter().filter(|one| PictureKind::of(one) == PictureKind::Asked);
        variables.flat_map(|one| of_variable(one, "-second", ", second state")).map(move |mut column| {
            let at = column.at;
            column.at = Box::new(move |row| if states(row) { at(row) } else { f64::NAN });
            column
        })
    });
    let steps = ExploreColumn {
        key: "steps_per_period".to_owned(),
        words: "Steps per period".to_owned(),
        short: "Steps per period".to_owned(),
        unit: "1",
        role: "quality",
        at: Box::new(|row| results.steps_per_period.get(row).copied().map_or(f64::NAN, f64::from)),
    };
    axes.chain(first).chain(second).chain([steps]).collect()
}

/// A column of a variable, or one for each of its first harmonics.
fn of_variable<'a>(
    variable: &'a Variable,
    key: &'static str,
    words: &'static str,
) -> impl Iterator<Item = ExploreColumn<'a>> {
    let each = variable.harmonics.unwrap_or(1).max(1);
    let role = if PictureKind::of(variable) == PictureKind::Asked { "observable" } else { "quality" };
    (0..each.min(MOST_HARMONICS)).map(move |n| {
        let number = if each > 1 { format!(", harmonic {}", n + 1) } else { String::new() };
        let at = move |row: usize| variable.data.get(row * each + n).copied().unwrap_or(f64::NAN);
        ExploreColumn {
            key: format!("{}{key}{}", variable.name, number.replace(", harmonic ", "-harmonic-")),
            words: format!("{}{words}{number}", capital(names(variable).0)),
            short: format!("{}{words}{number}", capital(&names(variable).1)),
            unit: &variable.units,
            role,
            at: Box::new(at),
        }
    })
}

/// What each status code means, those among them that a report gives itself.
fn words() -> Map<String, Value> {
    let word = |word: &str, reason: &str| json!({ "word": word, "reason": reason });
    let file = Status::ALL.iter().map(|one| (*one as u8, word(one.meaning(), one.reason())));
    let own = [EXCLUDED, NO_STATE]
        .map(|code| (code, word(&status_word(code), "by the options that the report was made with")));
    file.chain(own).map(|(code, words)| (code.to_string(), words)).collect()
}

fn head(column: &ExploreColumn) -> Value {
    json!({ "key": column.key, "words": column.words, "short": column.short, "unit": column.unit, "role": column.role })
}

fn axis(axis: &Coordinate, list: bool) -> Value {
    json!({
        "words": capital(label(axis)),
        "short": capital(&short(axis)),
        "unit": axis.units,
        "path": axis.scene_path,
        "labels": axis.words,
        "values": (!list).then_some(&*axis.values),
        "together": axis.columns.iter().filter(|_| !list).map(together).collect::<Vec<_>>(),
    })
}

/// A quantity that varies with others along an axis.
fn together(column: &Coordinate) -> Value {
    json!({ "unit": column.units, "path": column.scene_path, "values": &*column.values })
}

fn flag(flag: &Flags) -> Value {
    let words = if flag.long_name.is_empty() { &flag.name } else { &flag.long_name };
    json!({ "words": capital(words), "meanings": flag.meanings, "bits": flag.bits })
}

/// The places among the stored motions of those that a page has room for, evenly chosen.
fn kept_rows(waves: &Waveforms) -> Vec<usize> {
    let numbers = 4 * waves.tip_travel.first().map_or(1, Vec::len).max(1);
    let stored = waves.instances.len();
    let room = (MOST_SAMPLES / numbers).clamp(1, stored);
    (0..room).map(|n| n * stored / room).collect()
}

fn wave_head(waves: &Waveforms, kept: &[usize]) -> Value {
    json!({
        "rows": kept.iter().map(|n| waves.instances[*n]).collect::<Vec<_>>(),
        "samples": waves.tip_travel.first().map_or(0, Vec::len),
        "stored": waves.instances.len(),
        "shared": waves.time.len() == 1,
    })
}

/// What columns.js reads: the columns and the motions as numbers of four bytes, little end first, then the statuses and flags.
fn pack(
    results: &Results,
    columns: &[ExploreColumn],
    waves: Option<(&Waveforms, &[usize])>,
) -> io::Result<Vec<u8>> {
    let mut packer = GzEncoder::new(Vec::new(), Compression::default());
    let number =
        |value: f64, packer: &mut GzEncoder<Vec<u8>>| packer.write_all(&(value as f32).to_le_bytes());
    for column in columns {
        for row in 0..results.status.len() {
            number((column.at)(row), &mut packer)?;
        }
    }
    if let Some((waves, kept)) = waves {
        let times: Vec<usize> = if waves.time.len() == 1 { vec![0] } else { kept.to_vec() };
        let parts = [
            (&waves.time, &times[..]),
            (&waves.tip_travel, kept),
            (&waves.force, kept),
            (&waves.indentation, kept),
        ];
        for value in parts.iter().flat_map(|(rows, kept)| kept.iter().flat_map(|n| rows[*n].iter())) {
            number(*value, &mut packer)?;
        }
    }
    packer.write_all(&results.status)?;
    for flag in &results.flags {
        packer.write_all(&flag.data)?;
    }
    packer.finish()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::BranchTable;
    use flate2::read::GzDecoder;
    use std::io::Read;
    use std::sync::Arc;

    /// Eight rows over three axes, one of them without a second state.
    fn cube() -> Results {
        let axis = |name: &str, values: [f64; 2]| Coordinate {
            name: name.to_owned(),
            units: "m".to_owned(),
            values: Arc::new(values.to_vec()),
            ..Coordinate::default()
        };
        let variable = |scale: &str, data: Vec<f64>| Variable {
            name: "amplitude".to_owned(),
            units: "m".to_owned(),
            error_scale: scale.to_owned(),
            data,
            ..Variable::default()
        };
        let rows = |times: f64| (0..8).map(|n| times * f64::from(n)).collect::<Vec<_>>();
        Results {
            axes: vec![axis("a", [1.0, 2.0]), axis("b", [3.0, 4.0]), axis("c", [5.0, 6.0])],
            variables: vec![variable("amplitude", rows(1e-9))],
            status: vec![0, 0, 0, 4, 0, 0, 0, 0],
            steps_per_period: vec![64; 8],
            waveforms: Some(Waveforms {
                instances: vec![2, 5],
                time: vec![vec![0.0, 1.0]],
                tip_travel: vec![vec![2.0, 3.0], vec![4.0, 5.0]],
                force: vec![vec![6.0, 7.0], vec![8.0, 9.0]],
                indentation: vec![vec![10.0, 11.0], vec![12.0, 13.0]],
                ..Waveforms::default()
            }),
            other_branch: Some(BranchTable {
                variables: vec![variable("amplitude", rows(1e-6))],
                status: vec![0, 0, 0, 0, 0, 0, 0, NO_STATE],
                ..BranchTable::default()
            }),
            ..Results::default()
        }
    }

    fn part<'a>(page: &'a str, id: &str) -> &'a str {
        let (_, rest) = page.split_once(&format!("id=\"{id}\">")).unwrap();
        rest.split_once("</script>").unwrap().0.trim()
    }

    /// Truth: the results themselves, read in the order in which columns.js reads them.
    #[test]
    fn the_page_holds_the_results_numbers() {
        let results = cube();
        let page = explore_page(&results, ("</script>", "a.h5"), None).unwrap();
        let start: Value = serde_json::from_str(part(&page, "start")).unwrap();
        assert_eq!(start["title"], "</script>");
        assert_eq!(start["axes"][2]["values"], json!([5.0, 6.0]));
        let keys: Vec<&Value> = start["columns"].as_array().unwrap().iter().map(|one| &one["key"]).collect();
        assert_eq!(keys, ["amplitude", "amplitude-second", "steps_per_period"]);
        assert_eq!(start["waves"], json!({ "rows": [2, 5], "samples": 2, "stored": 2, "shared": true }));
        let mut pack = Vec::new();
        GzDecoder::new(&STANDARD.decode(part(&page, "pack")).unwrap()[..]).read_to_end(&mut pack).unwrap();
        let (numbers, bytes) = pack.split_at(4 * (3 * 8 + 2 + 3 * 4));
        let numbers: Vec<f32> =
            numbers.chunks(4).map(|four| f32::from_le_bytes(four.try_into().unwrap())).collect();
        let first: Vec<f32> = results.variables[0].data.iter().map(|value| *value as f32).collect();
        assert_eq!(numbers[..8], first);
        assert_eq!(numbers[14], 6e-6);
        assert!(numbers[15].is_nan(), "there is no second state");
        assert_eq!(numbers[16..24], [64.0; 8]);
        let waves: Vec<f32> = (0..14).map(|n| n as f32).collect();
        assert_eq!(numbers[24..], waves);
        assert_eq!(bytes, results.status);
    }

    #[test]
    fn pages_of_too_many_numbers_are_left_out_and_told() {
        let mut results = cube();
        let many = MOST_NUMBERS / 3 + 1;
        results.status = vec![0; many];
        let why = explore_page(&results, ("", ""), None).unwrap_err();
        assert!(why.starts_with(&format!("explore.html: its {many} rows of 3 numbers")), "{why}");
        results.axes.pop();
        assert!(!is_wanted(&results));
        results.list = true;
        assert!(is_wanted(&results));
    }
}
