//! `afmsweep export`: the rows of a results file for other programs, and a journal as a results file.

use super::cells::{head, number};
use super::{Verbosity, peek, write};
use afmsweep::report::defused;
use afmsweep::stats::{Study, outputs, sorted_out, status_word};
use afmsweep::store::{Coordinate, Results};
use afmsweep::{Status, store};
use anyhow::{Context, bail};
use std::fmt::Write;
use std::path::{Path, PathBuf};

/// Path of the axis of samples.
const SAMPLES: &str = "samples";

#[derive(clap::Args)]
#[command(after_help = "Examples: afmsweep export results/lever.h5 --format csv -o rows.csv\n          \
                        afmsweep export results/sensitivity.h5 --format salib -o salib\n          \
                        afmsweep export results/lever.h5.partial -o soon.h5")]
pub struct ExportArgs {
    /// Results file (HDF5), for salib of a scene with [uncertain] and [design], or [samples]; without --format the journal
    /// of a run that is not whole (FILE.partial), or the file of a share
    file: PathBuf,
    /// csv: one table of axes, parameters and observables; salib: a folder with problem.json, X.txt and Y.txt
    #[arg(long, value_enum)]
    format: Option<Format>,
    /// With --format csv, a group of the file in place of its rows
    #[arg(long, value_enum, requires = "format")]
    group: Option<Group>,
    /// File for csv [default: standard output], folder for salib [default: the file's name without .h5], results file of a
    /// journal
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// What becomes of rows that are not ok
    #[arg(long, value_enum, default_value_t = Failed::Refuse)]
    failed: Failed,
    /// Replace whatever results file stands at the output of a journal
    #[arg(long)]
    overwrite: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    Csv,
    Salib,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Group {
    /// Motion and force of the instances that the scene names, over time
    Waveforms,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Failed {
    /// Nothing is written
    Refuse,
    /// They are left out, and with them the rows of their base sample
    Drop,
    /// They are written; csv has a column `status`
    Keep,
}

pub fn main(args: &ExportArgs, voice: Verbosity) -> anyhow::Result<()> {
    match (args.format, &args.output) {
        (Some(format), _) => of_results(args, format, voice),
        (None, Some(output)) => peek::main(&args.file, output, args.overwrite, voice),
        (None, None) => bail!(
            "nothing says what to export: --format csv for the rows of a results file, --format salib for its samples, -o FILE.h5 \
             for what a journal has"
        ),
    }
}

fn of_results(args: &ExportArgs, format: Format, voice: Verbosity) -> anyhow::Result<()> {
    let results = store::read(&args.file)?;
    if args.group == Some(Group::Waveforms) {
        return write(args.output.as_deref(), &waveforms(&results, &args.file)?);
    }
    let failed = results.status.iter().filter(|code| **code != Status::Ok as u8).count();
    if failed > 0 && args.failed == Failed::Refuse {
        bail!(
            "{failed} of {} instances of {} are not ok; --failed drop leaves them out, --failed keep writes them all the same",
            results.status.len(),
            args.file.display()
        );
    }
    match format {
        Format::Csv => write(args.output.as_deref(), &csv(&results, args.failed)?)?,
        Format::Salib => {
            let folder = args.output.clone().unwrap_or_else(|| args.file.with_extension(""));
            salib(&Study::of(&results)?, args.failed, &folder)?;
            voice.say(format_args!("problem.json, X.txt and Y.txt in {}", folder.display()));
        }
    }
    if failed > 0 {
        let done = if args.failed == Failed::Drop { "left out" } else { "written all the same" };
        let what = if failed == 1 { "instance that is not ok was" } else { "instances that are not ok were" };
        voice.say(format_args!("{failed} {what} {done}"));
    }
    Ok(())
}

/// The rows that are written at a point.
fn rows(study: &Study, failed: Failed, point: usize) -> Vec<usize> {
    match failed {
        Failed::Drop => sorted_out(study, point),
        _ => (0..study.rows()).collect(),
    }
}

/// A column of the table: its head, and what stands in it at a place of an axis.
struct Column<'a> {
    head: String,
    axis: usize,
    of: &'a Coordinate,
}

/// What an axis tells of a row: its values or labels, then what varies along it, by the paths.
fn columns(number: usize, axis: &Coordinate, list: bool) -> Vec<Column<'_>> {
    let column = |head: String, of| Column { head, axis: number, of };
    let samples = axis.scene_path == SAMPLES;
    let own = match (list, samples) {
        (true, _) => Some(column(head(&axis.scene_path, &axis.units), axis)),
        (false, true) => (!axis.words.is_empty()).then(|| column("id".into(), axis)),
        (false, false) => Some(column(head(&axis.name, &axis.units), axis)),
    };
    let along = axis.columns.iter().map(|one| column(head(&one.scene_path, &one.units), one));
    own.into_iter().chain(along).collect()
}

/// One table: where a row stands along each axis, its samples last; its observables.
fn csv(results: &Results, failed: Failed) -> anyhow::Result<String> {
    let study = Study::of(results).ok();
    let instances: Vec<usize> = match (&study, failed) {
        (Some(study), _) => (0..study.points())
            .flat_map(|point| {
                rows(study, failed, point).into_iter().map(move |row| study.instance(point, row))
            })
            .collect(),
        (None, Failed::Drop) => {
            (0..results.status.len()).filter(|one| results.status[*one] == Status::Ok as u8).collect()
        }
        (None, _) => (0..results.status.len()).collect(),
    };
    let mut order: Vec<usize> = (0..results.axes.len()).collect();
    order.sort_by_key(|axis| results.axes[*axis].scene_path == SAMPLES);
    let columns: Vec<Column> =
        order.iter().flat_map(|axis| columns(*axis, &results.axes[*axis], results.list)).collect();
    let outputs = outputs(results);
    let with_status = (failed == Failed::Keep).then(|| "status".to_owned());
    let mut writer = csv::Writer::from_writer(Vec::new());
    let heads = columns.iter().map(|one| one.head.clone());
    let named = outputs.iter().map(|one| head(&one.name, &one.units));
    writer.write_record(heads.chain(named).chain(with_status))?;
    for instance in instances {
        let place = place(results, instance);
        let along = columns.iter().map(|one| match one.of.words.get(place[one.axis]) {
            Some(word) => defused(word.clone()),
            None => number(one.of.values[place[one.axis]]),
        });
        let values = outputs.iter().map(|one| number(one.values[instance]));
        let status = (failed == Failed::Keep).then(|| status_word(results.status[instance]).to_owned());
        writer.write_record(along.chain(values).chain(status))?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// Where an instance stands along each axis.
fn place(results: &Results, instance: usize) -> Vec<usize> {
    if results.list {
        return vec![instance; results.axes.len()];
    }
    let mut rest = instance;
    let mut place = vec![0; results.axes.len()];
    for (at, axis) in place.iter_mut().zip(&results.axes).rev() {
        *at = rest % axis.values.len();
        rest /= axis.values.len();
    }
    place
}

/// The waveforms below each other.
fn waveforms(results: &Results, file: &Path) -> anyhow::Result<String> {
    let waves = results.waveforms.as_ref().with_context(|| {
        format!(
            "{} has no waveforms; ask for them: waveforms = {{ instances = [0] }} in [output]",
            file.display()
        )
    })?;
    let columns = [
        ("tip_travel", "m", &waves.tip_travel),
        ("actuator_top", "m", &waves.actuator_top),
        ("indentation", "m", &waves.indentation),
        ("force", "N", &waves.force),
    ];
    let mut writer = csv::Writer::from_writer(Vec::new());
    let heads = columns.iter().map(|(name, units, _)| head(name, units));
    writer.write_record(["instance".to_owned(), head("time", "s")].into_iter().chain(heads))?;
    for (row, instance) in waves.instances.iter().enumerate() {
        let time = waves.time.get(row).or(waves.time.first()).map_or(&[][..], Vec::as_slice);
        for (n, time) in time.iter().enumerate() {
            let value = |all: &[Vec<f64>]| {
                number(all.get(row).and_then(|row| row.get(n)).copied().unwrap_or(f64::NAN))
            };
            let values = columns.iter().map(|(_, _, all)| value(all));
            writer.write_record([instance.to_string(), number(*time)].into_iter().chain(values))?;
        }
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

/// The problem as JSON, parameters and observables as columns of numbers that `numpy.loadtxt` reads.
fn salib(study: &Study, failed: Failed, folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let points = study.points();
    for point in 0..points {
        // With a sweep each of its points has files of its own.
        let number = if points == 1 { String::new() } else { format!("_{point:04}") };
        let kept = rows(study, failed, point);
        let columns: Vec<&[f64]> = study.parameters.iter().map(|one| &one.values[..]).collect();
        let names: Vec<String> = study.parameters.iter().map(|one| head(&one.name, &one.units)).collect();
        let file = |letter: &str| folder.join(format!("{letter}{number}.txt"));
        write(Some(&file("X")), &table(&names, &kept, |row, n| columns[n][row]))?;
        let names: Vec<String> = study.outputs.iter().map(|one| head(&one.name, &one.units)).collect();
        let value = |row: usize, n: usize| study.outputs[n].values[study.instance(point, row)];
        write(Some(&file("Y")), &table(&names, &kept, value))?;
    }
    let problem = serde_json::to_string_pretty(&study.design.problem)? + "\n";
    write(Some(&folder.join("problem.json")), &problem)
}

fn table(names: &[String], rows: &[usize], value: impl Fn(usize, usize) -> f64) -> String {
    let mut text = format!("# {}\n", names.join(" "));
    for row in rows {
        for n in 0..names.len() {
            let between = if n == 0 { "" } else { " " };
            // Writing into a String cannot fail.
            let _ = write!(text, "{between}{:?}", value(*row, n));
        }
        text.push('\n');
    }
    text
}
