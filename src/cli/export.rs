//! `afmsweep export`: the samples of a results file for other programs, and a journal as a results file.

use super::{Voice, look_in, print};
use afmsweep::report::defused;
use afmsweep::stats::{Study, sorted_out};
use afmsweep::{Status, store};
use anyhow::{Context, bail};
use std::fmt::Write;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(
    after_help = "Examples: afmsweep export results/uncertain_lever.h5 --format csv -o rows.csv\n          \
                        afmsweep export results/sensitivity.h5 --format salib -o salib\n          \
                        afmsweep export results/lever.h5.partial -o soon.h5"
)]
pub struct ExportArgs {
    /// Results file (HDF5) of a scene with [uncertain] and [design], or [samples]; without --format the journal of a run
    /// that is not whole (FILE.partial), or the file of a share
    file: PathBuf,
    /// csv: one table of parameters and observables; salib: a folder with problem.json, X.txt and Y.txt
    #[arg(long, value_enum)]
    format: Option<Format>,
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
enum Failed {
    /// Nothing is written
    Refuse,
    /// They are left out, and with them the rows of their base sample
    Drop,
    /// They are written; csv has a column `status`
    Keep,
}

pub fn main(args: &ExportArgs, voice: Voice) -> anyhow::Result<()> {
    match (args.format, &args.output) {
        (Some(format), _) => samples(args, format, voice),
        (None, Some(output)) => look_in::main(&args.file, output, args.overwrite, voice),
        (None, None) => bail!(
            "nothing says what to export: --format csv or --format salib for the samples of a results file, -o FILE.h5 for what \
             a journal has"
        ),
    }
}

fn samples(args: &ExportArgs, format: Format, voice: Voice) -> anyhow::Result<()> {
    let study = Study::of(&store::read(&args.file)?)?;
    let failed = study.status.iter().filter(|code| **code != Status::Ok as u8).count();
    if failed > 0 && args.failed == Failed::Refuse {
        bail!(
            "{failed} of {} instances of {} are not ok; --failed drop leaves them out, --failed keep writes them all the same",
            study.status.len(),
            args.file.display()
        );
    }
    match format {
        Format::Csv => {
            let text = csv(&study, args.failed)?;
            match &args.output {
                None => print(&text)?,
                Some(path) => write(path, &text)?,
            }
        }
        Format::Salib => {
            let folder = args.output.clone().unwrap_or_else(|| args.file.with_extension(""));
            salib(&study, args.failed, &folder)?;
            voice.say(format_args!("problem.json, X.txt and Y.txt in {}", folder.display()));
        }
    }
    if failed > 0 {
        let done = if args.failed == Failed::Drop { "left out" } else { "written all the same" };
        voice.say(format_args!("{failed} instances that are not ok were {done}"));
    }
    Ok(())
}

fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))
}

/// The rows that are written at a point.
fn rows(study: &Study, failed: Failed, point: usize) -> Vec<usize> {
    match failed {
        Failed::Drop => sorted_out(study, point),
        _ => (0..study.rows()).collect(),
    }
}

fn header(name: &str, units: &str) -> String {
    defused(if matches!(units, "" | "1") { name.to_owned() } else { format!("{name} [{units}]") })
}

/// One table: where a row stands beside the samples, its parameters by their paths, its observables.
fn csv(study: &Study, failed: Failed) -> anyhow::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let mut head: Vec<String> = study.beside.iter().map(|axis| header(&axis.name, &axis.units)).collect();
    head.extend((!study.ids.is_empty()).then(|| "id".to_owned()));
    head.extend(study.parameters.iter().map(|one| header(&one.scene_path, &one.units)));
    head.extend(study.outputs.iter().map(|one| header(&one.name, &one.units)));
    let with_status = failed == Failed::Keep;
    head.extend(with_status.then(|| "status".to_owned()));
    writer.write_record(&head)?;
    for point in 0..study.points() {
        let place = study.place(point);
        for row in rows(study, failed, point) {
            let instance = study.instance(point, row);
            let mut cells: Vec<String> = study
                .beside
                .iter()
                .zip(&place)
                .map(|(axis, at)| {
                    let word = axis.words.get(*at).cloned().map(defused);
                    word.unwrap_or_else(|| format!("{:?}", axis.values[*at]))
                })
                .collect();
            cells.extend(study.ids.get(row).cloned().map(defused));
            cells.extend(study.parameters.iter().map(|one| format!("{:?}", one.values[row])));
            cells.extend(study.outputs.iter().map(|one| format!("{:?}", one.values[instance])));
            cells.extend(with_status.then(|| study.status_word(instance).to_owned()));
            writer.write_record(&cells)?;
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
        let names: Vec<String> = study.parameters.iter().map(|one| header(&one.name, &one.units)).collect();
        write(&folder.join(format!("X{number}.txt")), &table(&names, &kept, |row, n| columns[n][row]))?;
        let names: Vec<String> = study.outputs.iter().map(|one| header(&one.name, &one.units)).collect();
        let value = |row: usize, n: usize| study.outputs[n].values[study.instance(point, row)];
        write(&folder.join(format!("Y{number}.txt")), &table(&names, &kept, value))?;
    }
    let problem = serde_json::to_string_pretty(&study.design.problem)? + "\n";
    write(&folder.join("problem.json"), &problem)
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
