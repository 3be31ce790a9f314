//! `afmsweep infer`: what observed values, or a measured curve, tell of the uncertain parameters.

mod curve_comparison;
mod curve_rows;
mod inference_messages;
mod nuisance;
mod observed_curve;
mod sheet;
mod sweep_point;
mod value;

use super::stats::RowArgs;
use super::{Verbosity, print, print_json};
use afmsweep::report;
use afmsweep::stats::{Observed, Study, posterior};
use afmsweep::store;
use anyhow::{Context, bail};
use clap::Parser;
use inference_messages::{InferenceAnswer, ObservedValues};
use serde_json::{Value, json as object};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(
    after_help = "Examples: afmsweep infer results/infer_modulus.h5 --observed amplitude=\"14.2 nm +- 0.2 nm\" --observed phase=\"55 deg +- 1 deg\"\n          \
                  afmsweep infer results/infer_curve.h5 --observed scenes/infer_curve.csv --offset approach.gap"
)]
pub struct InferArgs {
    /// Results file (HDF5) of a scene with [uncertain] and [design], or [samples]
    file: PathBuf,
    /// What was observed: NAME="VALUE +- SD", units with both, which may be given for several observables; or the file of a
    /// measured curve (CSV: `gap [nm], amplitude [nm], phase [deg], amplitude_sd [nm]`)
    #[arg(long, value_name = "NAME=VALUE|FILE", required = true)]
    observed: Vec<String>,
    /// A sweep or a curve at one value, the nearest there is: approach.gap=14nm; may be given for several axes
    #[arg(long, value_name = "PATH=VALUE", value_parser = sweep_point::pair)]
    at: Vec<(String, String)>,
    #[command(flatten)]
    curve: observed_curve::CurveArgs,
    #[command(flatten)]
    rows: RowArgs,
    /// Folder for a page: the prediction over what was measured, all parameters against each other; of one point of a sweep
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Machine-readable answer on standard output, SI units
    #[arg(long)]
    json: bool,
}

/// The arguments alone.
#[derive(clap::Parser)]
#[command(no_binary_name = true)]
struct InferWords {
    #[command(flatten)]
    args: InferArgs,
}

/// What a study tells, one object for each point, and what is doubtful about it; by the words of the command line behind the
/// file.
///
/// # Errors
/// Words that mean nothing; what was observed does not fit the study.
pub fn answer(study: &Study, words: &[String]) -> anyhow::Result<(Vec<Value>, Vec<String>)> {
    let all = std::iter::once("the samples").chain(words.iter().map(String::as_str));
    let args = InferWords::try_parse_from(all)?.args;
    let answers = answers(study, &args, Verbosity { quiet: true, verbose: false })?;
    let doubts = answers.iter().filter_map(InferenceAnswer::misfit).collect();
    Ok((answers.iter().map(|answer| answer.json(study)).collect(), doubts))
}

fn answers(study: &Study, args: &InferArgs, voice: Verbosity) -> anyhow::Result<Vec<InferenceAnswer>> {
    match file(&args.observed)? {
        Some(file) => curve_comparison::answers(study, file, args, voice),
        None => of_values(study, args),
    }
}

pub fn main(args: &InferArgs, voice: Verbosity) -> anyhow::Result<()> {
    let study = Study::of(&store::read(&args.file)?)?;
    let answers = answers(&study, args, voice)?;
    for answer in &answers {
        warn(answer, voice);
    }
    if let Some(folder) = &args.output {
        let [answer] = &answers[..] else {
            bail!(
                "-o {}: the file has {} points of a sweep, a page is of one; --at PATH=VALUE picks it",
                folder.display(),
                answers.len()
            );
        };
        let page = report::uncertainty::inference(&answer.page(&study), folder)?;
        voice.say(format_args!("page in {}", page.display()));
    }
    if args.json {
        let mut told: Vec<_> = answers.iter().map(|answer| answer.json(&study)).collect();
        return match told.len() {
            1 => print_json(&told.remove(0)),
            _ => print_json(&object!({ "version": 1, "points": told })),
        };
    }
    let text: Vec<String> = answers.iter().map(|answer| answer.text(&study)).collect();
    print(&text.join("\n"))
}

/// The file of a measured curve, if what was observed is one.
fn file(observed: &[String]) -> anyhow::Result<Option<&Path>> {
    let is_file = |text: &&String| !text.contains('=') || Path::new(text).is_file();
    match (observed.iter().find(is_file), observed.len()) {
        (None, _) => Ok(None),
        (Some(text), _) if !Path::new(text).is_file() => {
            bail!(
                "--observed {text}: no `=`, and no file of that name; {FORM}, or name the file of a measured curve"
            )
        }
        (Some(text), 1) => Ok(Some(Path::new(text))),
        (Some(text), _) => {
            bail!("--observed {text}: a measured curve is observed by itself; put its columns in one file")
        }
    }
}

/// What single values tell, at each point of the sweep that is asked for.
fn of_values(study: &Study, args: &InferArgs) -> anyhow::Result<Vec<InferenceAnswer>> {
    if let Some(option) = args.curve.given() {
        bail!("{option} goes with the file of a measured curve: --observed curve.csv");
    }
    let observed: Vec<Observed> =
        args.observed.iter().map(|text| read(text, study)).collect::<anyhow::Result<_>>()?;
    for (n, one) in observed.iter().enumerate() {
        if observed[..n].iter().any(|other| other.name == one.name) {
            bail!(
                "--observed gives {} twice: combine the two values into one with its standard deviation",
                one.name
            );
        }
    }
    let fixed = sweep_point::fixed(study, &args.at)?;
    if let Some(number) = study.curve().filter(|number| fixed[*number].is_none()) {
        let axis = &study.beside[number];
        let middle = axis.values[axis.values.len() / 2];
        bail!(
            "this is a curve: --at {}={} picks a point, --observed curve.csv takes a measured one",
            sweep_point::path(axis),
            report::shown(middle, &axis.units, 4).replace(' ', "")
        );
    }
    let points = sweep_point::points(study, &fixed);
    let one = |point: usize| {
        let found = posterior(study, point, &observed, &args.rows.options());
        let at = afmsweep::stats::stats_json::place(study, point);
        let found = found.with_context(|| sweep_point::named(&args.file, &at))?;
        Ok(InferenceAnswer {
            at,
            point,
            found,
            free: Vec::new(),
            seen: ObservedValues::Values(observed.clone()),
        })
    };
    points.into_iter().map(one).collect()
}

/// How a single value is written.
const FORM: &str = "write it as amplitude=\"14.2 nm +- 0.2 nm\"";

/// `amplitude=14.2 nm +- 0.2 nm`.
fn read(text: &str, study: &Study) -> anyhow::Result<Observed> {
    let (name, value) = text.split_once('=').with_context(|| format!("--observed {text}: no `=`; {FORM}"))?;
    let name = name.trim();
    let output = study.output(name)?;
    let value = value.replace('±', "+-");
    let (value, sd) = value
        .split_once("+-")
        .with_context(|| format!("--observed {text}: no standard deviation behind `+-`; {FORM}"))?;
    let read =
        |part: &str| value::si(part, &output.units).with_context(|| format!("--observed {text}: {FORM}"));
    let (value, sd) = (read(value)?, read(sd)?);
    if !(sd > 0.0 && sd.is_finite()) {
        bail!("--observed {text}: the standard deviation is not above zero; {FORM}");
    }
    Ok(Observed { name: name.to_owned(), value, sd })
}

/// Says what is doubtful about an answer.
fn warn(answer: &InferenceAnswer, voice: Verbosity) {
    let found = &answer.found;
    if found.left_out > 0 {
        voice.say(format_args!("{} rows that are not ok were left out", found.left_out));
    }
    if let Some(words) = answer.misfit() {
        voice.say(format_args!("warning: {words}"));
    }
}
