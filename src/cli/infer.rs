//! `afmsweep infer`: what observed values tell of the uncertain parameters.

use super::{Voice, print, print_json};
use afmsweep::report::{self, shown};
use afmsweep::stats::{Observed, Posterior, Study, json, posterior};
use afmsweep::store;
use afmsweep::units::{self, Dimension};
use anyhow::{Context, bail};
use serde_json::{Map, Value, json as object};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(
    after_help = "Example: afmsweep infer results/infer_modulus.h5 --observed amplitude=\"14.2 nm +- 0.2 nm\" --observed phase=\"55 deg +- 1 deg\""
)]
pub struct InferArgs {
    /// Results file (HDF5) of a scene with [uncertain] and [design], or [samples]
    file: PathBuf,
    /// What was observed: NAME="VALUE +- SD", units with both; may be given for several observables
    #[arg(long, value_name = "NAME=VALUE", required = true)]
    observed: Vec<String>,
    /// Largest share of rows, in percent, that may be left out because they failed
    #[arg(long, value_name = "PERCENT", default_value_t = 5.0, value_parser = clap::value_parser!(f64))]
    left_out: f64,
    /// Folder for a picture of all parameters and a page; not for a sweep
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Machine-readable answer on standard output, SI units
    #[arg(long)]
    json: bool,
}

/// Standard deviations in all that the best of many rows does not miss by where the model is right.
const FAR: f64 = 2.0;

/// Shares of which quantiles are told.
const SHARES: [f64; 5] = [0.025, 0.25, 0.5, 0.75, 0.975];

pub fn main(args: &InferArgs, voice: Voice) -> anyhow::Result<()> {
    let study = Study::of(&store::read(&args.file)?)?;
    let observed: Vec<Observed> =
        args.observed.iter().map(|text| read(text, &study)).collect::<anyhow::Result<_>>()?;
    if !(0.0..=100.0).contains(&args.left_out) {
        bail!("--left-out {}: expected a share from 0 to 100", args.left_out);
    }
    let points: Vec<Posterior> = (0..study.points())
        .map(|point| {
            let found = posterior(&study, point, &observed, args.left_out / 100.0);
            found.with_context(|| match study.beside.is_empty() {
                true => args.file.display().to_string(),
                false => format!("{} at {}", args.file.display(), Value::Object(json::place(&study, point))),
            })
        })
        .collect::<anyhow::Result<_>>()?;
    for found in &points {
        if found.left_out > 0 {
            voice.say(format_args!("{} rows that are not ok were left out", found.left_out));
        }
        let best = found.best_chi_squared.sqrt();
        if best > FAR {
            voice.say(format_args!(
                "warning: even the best row misses by {best:.1} standard deviations: the observed values, their errors or the model are wrong"
            ));
        }
    }
    if let Some(folder) = &args.output {
        let [found] = &points[..] else {
            bail!(
                "-o {}: the file has {} points of a sweep, a page is of one",
                folder.display(),
                points.len()
            );
        };
        let page = report::uncertainty::inference(&study, found, &observed, folder)?;
        voice.say(format_args!("picture in {}", page.display()));
    }
    if args.json {
        let mut told: Vec<Value> =
            points.iter().enumerate().map(|(point, one)| as_json(&study, point, one, &observed)).collect();
        return match told.len() {
            1 => print_json(&told.remove(0)),
            _ => print_json(&object!({ "version": 1, "points": told })),
        };
    }
    let text: Vec<String> =
        points.iter().enumerate().map(|(point, one)| as_text(&study, point, one, &observed)).collect();
    print(&text.join("\n"))
}

/// `amplitude=14.2 nm +- 0.2 nm`.
fn read(text: &str, study: &Study) -> anyhow::Result<Observed> {
    const FORM: &str = "write it as amplitude=\"14.2 nm +- 0.2 nm\"";
    let (name, value) = text.split_once('=').with_context(|| format!("--observed {text}: no `=`; {FORM}"))?;
    let name = name.trim();
    let output = study.output(name)?;
    let value = value.replace('±', "+-");
    let (value, sd) = value
        .split_once("+-")
        .with_context(|| format!("--observed {text}: no standard deviation behind `+-`; {FORM}"))?;
    let read = |part: &str| si(part, &output.units).with_context(|| format!("--observed {text}: {FORM}"));
    let (value, sd) = (read(value)?, read(sd)?);
    if !(sd > 0.0 && sd.is_finite()) {
        bail!("--observed {text}: the standard deviation is not above zero; {FORM}");
    }
    Ok(Observed { name: name.to_owned(), value, sd })
}

/// A quantity of an observable, in the unit of the results file.
fn si(text: &str, units: &str) -> anyhow::Result<f64> {
    let text = text.trim();
    let dimension = match units {
        "m" => Dimension::Length,
        "N" => Dimension::Force,
        "J" => Dimension::Energy,
        "Hz" => Dimension::Frequency,
        "degree" => {
            let number = text
                .strip_suffix("degrees")
                .or_else(|| text.strip_suffix("degree"))
                .or_else(|| text.strip_suffix("deg"))
                .or_else(|| text.strip_suffix('°'))
                .with_context(|| format!("\"{text}\" is no angle in degrees; write \"55 deg\""))?;
            return number
                .trim()
                .parse()
                .with_context(|| format!("\"{text}\" is no angle in degrees; write \"55 deg\""));
        }
        _ => Dimension::Dimensionless,
    };
    units::parse(text, dimension).map_err(|error| anyhow::anyhow!("{error}"))
}

/// A parameter's or an observable's name, unit and values by row.
struct Column<'a> {
    name: &'a str,
    units: &'a str,
    values: Vec<f64>,
}

fn parameters(study: &Study) -> Vec<Column<'_>> {
    study
        .parameters
        .iter()
        .map(|one| Column { name: &one.name, units: &one.units, values: one.values.to_vec() })
        .collect()
}

/// Observables that were not observed: what the model then says of them.
fn predicted<'a>(study: &'a Study, point: usize, observed: &[Observed]) -> Vec<Column<'a>> {
    let free = study.outputs.iter().filter(|one| !observed.iter().any(|known| known.name == one.name));
    free.map(|one| Column { name: &one.name, units: &one.units, values: study.at(&one.values, point) })
        .collect()
}

fn as_json(study: &Study, point: usize, found: &Posterior, observed: &[Observed]) -> Value {
    let of = |column: &Column| -> Value {
        let quantiles: Map<String, Value> = SHARES
            .iter()
            .map(|share| (share.to_string(), object!(found.quantile(&column.values, *share))))
            .collect();
        object!({
            "units": column.units,
            "mean": found.mean(&column.values),
            "sd": found.sd(&column.values),
            "quantiles": quantiles,
        })
    };
    let all = |columns: &[Column]| -> Map<String, Value> {
        columns.iter().map(|column| (column.name.to_owned(), of(column))).collect()
    };
    let parameters = parameters(study);
    let correlation: Vec<Vec<f64>> = parameters
        .iter()
        .map(|a| parameters.iter().map(|b| found.correlation(&a.values, &b.values)).collect())
        .collect();
    let told: Map<String, Value> = observed
        .iter()
        .map(|one| (one.name.clone(), object!({ "value": one.value, "sd": one.sd })))
        .collect();
    object!({
        "version": 1,
        "at": json::place(study, point),
        "observed": told,
        "rows": found.rows.len(),
        "left_out": found.left_out,
        "effective_samples": found.effective,
        "best_chi_squared": found.best_chi_squared,
        "names": parameters.iter().map(|one| one.name).collect::<Vec<_>>(),
        "parameters": all(&parameters),
        "correlation": correlation,
        "predicted": all(&predicted(study, point, observed)),
    })
}

fn as_text(study: &Study, point: usize, found: &Posterior, observed: &[Observed]) -> String {
    let mut text = String::new();
    if !study.beside.is_empty() {
        text += &format!("== {}\n", Value::Object(json::place(study, point)));
    }
    text += &format!(
        "{} rows, {:.0} effective; the best misses {} observed by {:.2} standard deviations in all\n",
        found.rows.len(),
        found.effective,
        observed.iter().map(|one| one.name.as_str()).collect::<Vec<_>>().join(", "),
        found.best_chi_squared.sqrt()
    );
    let line = |column: &Column| {
        let at = |share: f64| shown(found.quantile(&column.values, share), column.units, 4);
        format!("  {}: {}, 95 % from {} to {}\n", column.name, at(0.5), at(0.025), at(0.975))
    };
    let parameters = parameters(study);
    parameters.iter().for_each(|column| text += &line(column));
    for (n, a) in parameters.iter().enumerate() {
        for b in &parameters[n + 1..] {
            let together = found.correlation(&a.values, &b.values);
            if together.abs() >= 0.3 {
                text += &format!("  {} and {} hang together: correlation {together:.2}\n", a.name, b.name);
            }
        }
    }
    let predicted = predicted(study, point, observed);
    if !predicted.is_empty() {
        text += "what was not observed is then:\n";
        predicted.iter().for_each(|column| text += &line(column));
    }
    text
}
