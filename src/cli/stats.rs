//! `afmsweep stats`: how the observables of a study are distributed, and which parameters decide them.

use super::{Verbosity, print, print_json};
use afmsweep::Status;
use afmsweep::report::{self, shown};
use afmsweep::stats::{
    self, Estimate, SHARES, SensitivityIndices, StatsError, Study, StudyOutput, Summary, SummaryOptions,
    stats_json,
};
use afmsweep::store;
use anyhow::bail;
use serde_json::{Map, Value, json};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "Examples: afmsweep stats results/uncertain_lever.h5\n          \
                        afmsweep stats results/sensitivity.h5 --json --observable amplitude")]
pub struct StatsArgs {
    /// Results file (HDF5) of a scene with [uncertain] and [design], or [samples]
    file: PathBuf,
    /// Only this observable; may be given several times
    #[arg(long = "observable", value_name = "NAME")]
    observables: Vec<String>,
    #[command(flatten)]
    rows: RowArgs,
    /// Folder for pictures and a page
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Machine-readable answer on standard output, SI units
    #[arg(long)]
    json: bool,
}

/// Which rows count.
#[derive(clap::Args)]
pub struct RowArgs {
    /// Largest share of rows, in percent, that may be left out because they failed
    #[arg(long, value_name = "PERCENT", default_value_t = 5.0, value_parser = percent)]
    left_out: f64,
    /// A status beside ok whose values count, such as accuracy_not_met; may be given several times
    #[arg(long = "keep", value_name = "STATUS", value_parser = status)]
    kept: Vec<Status>,
}

fn percent(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..=100.0).contains(&share) => Ok(share),
        _ => Err("expected a share from 0 to 100".into()),
    }
}

fn status(text: &str) -> Result<Status, String> {
    let found = Status::ALL.into_iter().find(|status| status.meaning() == text);
    found.ok_or_else(|| {
        let words: Vec<&str> = Status::ALL.iter().map(|status| status.meaning()).collect();
        format!("expected one of {}", words.join(", "))
    })
}

impl RowArgs {
    pub fn options(&self) -> SummaryOptions {
        SummaryOptions { most_left_out: self.left_out / 100.0, kept: self.kept.clone() }
    }
}

/// What is told of each observable at a point.
type Told<'a> = Vec<(&'a StudyOutput, Result<Summary, StatsError>)>;

pub fn main(args: &StatsArgs, voice: Verbosity) -> anyhow::Result<()> {
    let study = Study::of(&store::read(&args.file)?)?;
    let points = told(&study, &args.observables, &args.rows.options())?;
    match args.json {
        true => print_json(&as_json(&args.file.to_string_lossy(), &study, &points))?,
        false => print(&as_text(&study, &points))?,
    }
    if let Some(folder) = &args.output {
        let told: Vec<Vec<(&StudyOutput, Option<Summary>)>> = points
            .iter()
            .map(|told| told.iter().map(|(output, told)| (*output, told.as_ref().ok().cloned())).collect())
            .collect();
        let page = report::uncertainty::statistics(&study, &told, folder)?;
        voice.say(format_args!("pictures in {}", page.display()));
    }
    let failed: Vec<&StatsError> =
        points.iter().flatten().filter_map(|(_, told)| told.as_ref().err()).collect();
    if let Some(first) = failed.first() {
        if failed.len() > 1 {
            voice.say(format_args!("{} observables could not be told; the first:", failed.len()));
        }
        bail!("{first}");
    }
    Ok(())
}

/// What is told of these observables, or of all, at each point.
fn told<'a>(
    study: &'a Study,
    names: &[String],
    options: &SummaryOptions,
) -> Result<Vec<Told<'a>>, StatsError> {
    let outputs: Vec<&StudyOutput> = match names {
        [] => study.outputs.iter().collect(),
        names => names.iter().map(|name| study.output(name)).collect::<Result<_, _>>()?,
    };
    let one = |output: &'a StudyOutput, point| (output, stats::summary(study, output, point, options));
    let point = |point| outputs.iter().map(|output| one(output, point)).collect();
    Ok((0..study.points()).map(point).collect())
}

/// The statistics of these observables.
///
/// # Errors
/// There is none of a name, or one cannot be told.
pub fn answer(study: &Study, names: &[String], options: &SummaryOptions) -> Result<Value, StatsError> {
    let points = told(study, names, options)?;
    let answer = as_json("", study, &points);
    let failed = points.into_iter().flatten().find_map(|(_, told)| told.err());
    failed.map_or(Ok(answer), Err)
}

fn as_json(file: &str, study: &Study, points: &[Told]) -> Value {
    let design = &study.design;
    let mut answer = json!({
        "version": 1,
        "file": file,
        "kind": design.kind.word(),
        "samples": design.samples,
        "replicates": design.replicates,
        "rows": design.rows,
        "names": design.group_names(),
    });
    let of = |told: &Told| -> Map<String, Value> {
        let one = |(output, told): &(&StudyOutput, Result<Summary, StatsError>)| {
            let value = match told {
                Ok(summary) => stats_json::summary(summary, output),
                Err(error) => json!({ "error": error.to_string() }),
            };
            (output.name.clone(), value)
        };
        told.iter().map(one).collect()
    };
    match (study.beside.is_empty(), points) {
        (true, [only]) => answer["observables"] = of(only).into(),
        _ => {
            let one = |(point, told): (usize, &Told)| -> Value {
                json!({ "at": stats_json::place(study, point), "observables": of(told) })
            };
            answer["points"] = points.iter().enumerate().map(one).collect();
        }
    }
    answer
}

fn as_text(study: &Study, points: &[Told]) -> String {
    let design = &study.design;
    let mut text = format!(
        "{}: {} of {} samples, {} rows{}\n",
        study.title,
        design.kind.word(),
        design.samples,
        design.rows,
        if design.replicates > 1 { format!(", {} replicates", design.replicates) } else { String::new() }
    );
    for (point, told) in points.iter().enumerate() {
        if !study.beside.is_empty() {
            let at = study.beside.iter().zip(study.place(point)).map(|(axis, at)| match axis.words.get(at) {
                Some(word) => format!("{} {word}", axis.long_name),
                None => format!("{} {}", axis.long_name, shown(axis.values[at], &axis.units, 4)),
            });
            text += &format!("\n== {}\n", at.collect::<Vec<_>>().join(", "));
        }
        for (output, told) in told {
            text += &match told {
                Ok(summary) => observable(study, output, summary),
                Err(error) => format!("\n{}\n  nothing: {error}\n", output.name),
            };
        }
    }
    text
}

fn observable(study: &Study, output: &StudyOutput, summary: &Summary) -> String {
    let mut text = format!("\n{} ({})\n  {} rows count", output.name, output.long_name, summary.count);
    let left_out: Vec<String> =
        summary.left_out.iter().map(|(word, count)| format!("{count} {word}")).collect();
    if !left_out.is_empty() {
        text += &format!(", left out by status: {}", left_out.join(", "));
    }
    text += &format!("; intervals of 95 % by {}\n", summary.intervals.name());
    let value = |one: &Estimate| {
        format!("{} +- {}", shown(one.value, &output.units, 5), shown(one.half_width, &output.units, 2))
    };
    if let Some(spread) = &summary.spread {
        text += &format!("  mean {}\n  sd   {}\n", value(&spread.mean), value(&spread.sd));
        for (share, one) in SHARES.iter().zip(&spread.quantiles) {
            text += &format!("  {:>5.1} % below {}\n", 100.0 * share, value(one));
        }
    }
    text += &indices(study, output, summary);
    let (median, largest) = summary.simulation_error;
    text += &format!(
        "  error of the simulation, on the scale of accuracy ({}): median {median:.1e}, largest {largest:.1e}\n",
        output.error_scale
    );
    let (half, all) = (summary.convergence.first(), summary.convergence.last());
    if let (Some(half), Some(all)) = (half, all)
        && half.samples < all.samples
        && let (Some(before), Some(after)) = (half.mean, all.mean)
    {
        text += &format!(
            "  converged? mean from {} samples {}, from {} {}\n",
            half.samples,
            value(&before),
            all.samples,
            value(&after)
        );
    }
    text
}

/// Said of an index whose interval holds zero.
const LOST: &str = "not told apart from zero";

/// Which of some indices are not told apart from zero, in words; nothing where all are.
fn lost(indices: &[(&str, &Estimate)]) -> String {
    let names: Vec<&str> =
        indices.iter().filter(|(_, one)| one.holds_zero()).map(|(name, _)| *name).collect();
    if names.is_empty() { String::new() } else { format!("{} {LOST}", names.join(", ")).trim().to_owned() }
}

/// A table of indices or effects.
fn indices(study: &Study, output: &StudyOutput, summary: &Summary) -> String {
    let names = study.design.group_names();
    let wide = names.iter().map(|name| name.chars().count()).max().unwrap_or(0);
    let share = |one: &Estimate| match one.half_width {
        small if small < 1e-3 => format!("{:>7.4} +- {small:<7.0e}", one.value),
        half_width => format!("{:>7.4} +- {half_width:<7.4}", one.value),
    };
    let mut text = String::new();
    match &summary.indices {
        SensitivityIndices::Saltelli(indices) => {
            text += &format!("  {:wide$}  {:<18}  ST\n", "", "S1");
            for (n, name) in names.iter().enumerate() {
                let (first, total) = (&indices.first[n], &indices.total[n]);
                let lost = lost(&[("S1", first), ("ST", total)]);
                text += format!("  {name:wide$}  {}  {}  {lost}", share(first), share(total)).trim_end();
                text.push('\n');
            }
            let pairs = (0..names.len()).flat_map(|j| (j + 1..names.len()).map(move |k| (j, k)));
            for ((j, k), one) in pairs.zip(&indices.second) {
                let lost = lost(&[("", one)]);
                text += format!("  S2 of {} and {}: {}  {lost}", names[j], names[k], share(one).trim())
                    .trim_end();
                text.push('\n');
            }
        }
        SensitivityIndices::Morris(effects) => {
            for (n, name) in names.iter().enumerate() {
                let star = &effects.mu_star[n];
                text += &format!(
                    "  {name:wide$}  mu* {} +- {}, mu {}, sigma {}{}\n",
                    shown(star.value, &output.units, 4),
                    shown(star.half_width, &output.units, 2),
                    shown(effects.mu[n], &output.units, 4),
                    shown(effects.sigma[n], &output.units, 4),
                    if star.holds_zero() { format!("; mu* {LOST}") } else { String::new() }
                );
            }
        }
        SensitivityIndices::Bins(first) => {
            for (name, one) in names.iter().zip(first) {
                let lost = lost(&[("", one)]);
                text += format!("  {name:wide$}  S1 (bins) {}  {lost}", share(one)).trim_end();
                text.push('\n');
            }
            for told in summary.doubts() {
                text += &format!("  {told}\n");
            }
        }
    }
    text
}
