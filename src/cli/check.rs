//! `afmsweep check`: every engine on a few instances, side by side with the reference.

mod check_table;

use super::{Verbosity, load, print, print_json};
use afmsweep::compare::{Scales, choose, numbers};
use afmsweep::control;
use afmsweep::engine::gpu::Gpu;
use afmsweep::engine::{Cpu, Engine, Progress, Reference};
use afmsweep::observe::{Measured, Observable, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use afmsweep::store;
use anyhow::Context;
use check_table::{CheckColumn, CheckTable};
use std::collections::BTreeSet;
use std::io::Read;
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "Examples: afmsweep check lever.toml\n          afmsweep check results/lever.h5 -i 4")]
pub struct CheckArgs {
    /// Scene file (TOML), or results file (HDF5): then what it holds stands beside the engines
    input: PathBuf,
    /// Instances to check: half of them the most extreme ones, the others at random
    #[arg(short, long, value_name = "N", default_value_t = 6, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    instances: u32,
    /// GPU adapter, by its index or a part of its name as `afmsweep devices` lists them
    #[arg(long, value_name = "ADAPTER")]
    device: Option<String>,
    /// Another choice of random instances
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Machine-readable answer on standard output, SI units
    #[arg(long)]
    json: bool,
}

pub fn main(args: &CheckArgs, voice: Verbosity) -> anyhow::Result<()> {
    let (scene, stored) = match holds_results(&args.input) {
        true => from_file(&args.input)?,
        false => (load(&args.input)?, None),
    };
    let plan = Plan::new(&scene, Precision::F64).with_context(|| format!("{}", args.input.display()))?;
    if let Some(results) = &stored {
        sound(results, &plan, &args.input)?;
    }
    let instances = choose(&plan, args.instances as usize, args.seed);
    let free = plan.stepped().is_empty();
    voice.say(format_args!(
        "{}: {} of {} instances{}, run to the accuracy asked for as `run` does",
        args.input.display(),
        instances.len(),
        plan.len(),
        if free { ", none of which feels the sample: the free motion is the answer" } else { "" }
    ));
    let checked = Checked::new(&plan, &instances, voice);
    let progress = Progress::default();
    let ours = control::run(&checked.part, &Cpu::default(), &progress)?;
    let truths = control::beside(&ours, &checked.places, &Reference::default(), &progress)?;
    let mut columns: Vec<CheckColumn> =
        stored.map(|results| file_column(&results, &plan, &instances)).into_iter().collect();
    columns.push(of_run("cpu f64".into(), &ours, &checked.places));
    columns.push(checked.column("cpu", &Cpu::default(), Precision::F32)?);
    columns.extend(checked.on_gpu(args.device.as_deref(), voice)?);
    let plan = ours.plan.part(&checked.places);
    let scales = (0..instances.len()).map(|i| Scales::of(&plan, i, &truths[i].0.measured)).collect();
    let table = CheckTable { scales, instances, plan, truths, columns };
    if args.json {
        print_json(&table.json())?;
    } else {
        print(&table.text(&scene))?;
    }
    judge(&table)
}

/// Whether the check stands: something was compared, and nothing of it is above the accuracy asked for.
fn judge(table: &CheckTable) -> anyhow::Result<()> {
    let known = table.known();
    if table.truths.iter().all(|(one, _)| one.status == Status::NoSetpoint) {
        anyhow::bail!(
            "nothing could be compared: no gap was found that holds the set-points; check more of them with -i"
        );
    }
    if known == 0 {
        anyhow::bail!(
            "nothing could be compared: the reference calls none of the {} instances ok; check more of them with -i, or give \
             the scene more [run] periods",
            table.instances.len()
        );
    }
    // What comes first is what the check is of: the file, or the run.
    let first = table.columns.iter().filter(|column| ["file", "cpu f64"].contains(&column.name.as_str()));
    for column in first {
        if table.counted(column).is_empty() {
            let who = if column.name == "file" { "the file" } else { "the run" };
            let status = column.status.first().map_or("", |status| status.meaning());
            anyhow::bail!(
                "nothing could be compared: {who} calls none of the {known} instances ok that the reference calls so (the first is \
                 {status}); check more of them with -i"
            );
        }
    }
    let accuracy = table.plan.run.accuracy;
    let above: Vec<&str> = table
        .columns
        .iter()
        .filter(|column| table.largest(column).is_some_and(|largest| largest > accuracy))
        .map(|column| column.name.as_str())
        .collect();
    if !above.is_empty() {
        anyhow::bail!("above the accuracy asked for, {accuracy:e}: {}", above.join(", "));
    }
    Ok(())
}

/// Whether a file is one of results: by how it begins, or, where that is spoilt, by its name.
fn holds_results(path: &Path) -> bool {
    let mut start = Vec::new();
    let begun = std::fs::File::open(path).and_then(|file| file.take(8).read_to_end(&mut start));
    let named = path.extension().is_some_and(|end| {
        ["h5", "hdf5", "nc", "partial"].iter().any(|known| end.eq_ignore_ascii_case(known))
    });
    (begun.is_ok() && start == b"\x89HDF\r\n\x1a\n") || named
}

/// The scene that a results file was made from, and the file's content.
fn from_file(path: &Path) -> anyhow::Result<(Scene, Option<store::Results>)> {
    let results = store::read(path)?;
    Ok((super::scene_in(path, &results)?, Some(results)))
}

/// Every instance that the file calls ok has a number for every observable.
fn sound(results: &store::Results, plan: &Plan, path: &Path) -> anyhow::Result<()> {
    let at = path.display();
    if results.status.len() != plan.len() {
        anyhow::bail!(
            "{at} has {} instances where its scene has {}: it is damaged or was changed; run the scene again",
            results.status.len(),
            plan.len()
        );
    }
    for observable in &plan.observables {
        let (name, width) = (observable.name(), observable.width());
        let variable = results.variables.iter().find(|variable| variable.name == name);
        let data =
            variable.map(|one| one.data.as_slice()).filter(|data| data.len() == width * results.status.len());
        let Some(data) = data else {
            anyhow::bail!(
                "{at} lacks `{name}`, which its scene asks for: it is damaged or was changed; run the scene again"
            );
        };
        let spoilt = |(row, status): (&[f64], &u8)| {
            // Without a contact there is no indentation.
            let none = *observable == Observable::IndentationMax && row.iter().all(|value| value.is_nan());
            *status == Status::Ok as u8 && !none && !row.iter().all(|value| value.is_finite())
        };
        let spoilt: Vec<usize> = (data.chunks_exact(width).zip(&results.status).enumerate())
            .filter(|(_, one)| spoilt(*one))
            .map(|(n, _)| n)
            .collect();
        if let Some(first) = spoilt.first() {
            anyhow::bail!(
                "{at}: `{name}` of instance {first} is no number though its status is ok ({} such instances): the file is \
                 damaged or was changed; run the scene again",
                spoilt.len()
            );
        }
    }
    Ok(())
}

fn all_numbers(plan: &Plan, measured: &Measured) -> Vec<Vec<f64>> {
    plan.observables.iter().map(|observable| numbers(*observable, measured)).collect()
}

/// What the engines run, and which of it is looked at.
struct Checked {
    /// The chosen instances in rising order, and all points of the curves that they lie on: a point alone would be reached
    /// from the free oscillation, perhaps on another branch.
    part: Plan,
    /// Where the chosen instances stand in it.
    places: Vec<u32>,
}

impl Checked {
    fn new(plan: &Plan, instances: &[u32], voice: Verbosity) -> Self {
        let curve = |i: u32| plan.ensemble.curves.map(|curves| curves.place(plan.id(i)).0);
        let wanted: BTreeSet<u32> = instances.iter().filter_map(|i| curve(*i)).collect();
        let mut members: BTreeSet<u32> = instances.iter().copied().collect();
        members.extend(plan.instances().filter(|i| curve(*i).is_some_and(|one| wanted.contains(&one))));
        let members: Vec<u32> = members.into_iter().collect();
        if members.len() > instances.len() {
            voice.say(format_args!(
                "points of curves are followed along all {} points of theirs by each engine",
                members.len()
            ));
        }
        let places = instances.iter().filter_map(|i| Some(members.binary_search(i).ok()? as u32)).collect();
        Self { part: plan.part(&members), places }
    }

    /// What an engine makes of the chosen instances.
    fn column(&self, name: &str, engine: &dyn Engine, precision: Precision) -> anyhow::Result<CheckColumn> {
        let run = control::run(&self.part.clone().in_precision(precision), engine, &Progress::default())?;
        Ok(of_run(format!("{name} {}", precision.name()), &run, &self.places))
    }

    /// The same of a GPU in each precision that it has, with the CPU that rounds alike beside it; nothing where there is no
    /// GPU and none was asked for.
    fn on_gpu(&self, device: Option<&str>, voice: Verbosity) -> anyhow::Result<Vec<CheckColumn>> {
        let gpu = match Gpu::new(device) {
            Ok(gpu) => gpu,
            Err(error) if device.is_some() => return Err(error.into()),
            Err(error) => {
                voice.say(format_args!("gpu: not checked; {error}"));
                return Ok(Vec::new());
            }
        };
        voice.say(format_args!("gpu: {}", gpu.device()));
        let has = |precision: &Precision| *precision == Precision::F32 || gpu.report().double;
        let columns = [Precision::F64, Precision::F32].into_iter().filter(has).map(|precision| {
            let twin = self.column("cpu", &Cpu { strict: true }, precision)?;
            let ours = self.column("gpu", &gpu, precision)?;
            Ok(CheckColumn { strict: Some(twin.numbers), ..ours })
        });
        columns.collect()
    }
}

/// What a run has of the instances of these places in it.
fn of_run(name: String, run: &control::RunResult, places: &[u32]) -> CheckColumn {
    let finished: Vec<_> = places.iter().map(|place| run.results.get(*place as usize)).collect();
    CheckColumn {
        name,
        status: finished.iter().map(|one| one.status).collect(),
        numbers: finished.iter().map(|one| all_numbers(&run.plan, &one.measured)).collect(),
        strict: None,
    }
}

fn file_column(results: &store::Results, plan: &Plan, instances: &[u32]) -> CheckColumn {
    let row = |observable: &Observable, instance: usize| {
        let width = observable.width();
        let variable = results.variables.iter().find(|variable| variable.name == observable.name());
        let held = variable.and_then(|one| one.data.get(instance * width..(instance + 1) * width));
        held.map_or_else(|| vec![f64::NAN; width], <[f64]>::to_vec)
    };
    let status = |instance: &u32| {
        let code = results.status.get(*instance as usize).copied();
        code.and_then(Status::from_code).unwrap_or(Status::NotRun)
    };
    let rows = |instance: &u32| plan.observables.iter().map(|one| row(one, *instance as usize)).collect();
    CheckColumn {
        name: "file".into(),
        status: instances.iter().map(status).collect(),
        numbers: instances.iter().map(rows).collect(),
        strict: None,
    }
}
