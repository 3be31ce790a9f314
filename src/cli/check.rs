//! `afmsweep check`: every engine on a few instances, side by side with the reference.

use super::{Voice, load, print, print_json};
use afmsweep::compare::{Scales, choose, error_of, numbers};
use afmsweep::engine::gpu::Gpu;
use afmsweep::engine::{Cpu, Engine, Finished, Progress, Reference};
use afmsweep::observe::{Measured, Observable, Status};
use afmsweep::plan::{Plan, Precision};
use afmsweep::report::shown;
use afmsweep::scene::Scene;
use afmsweep::store;
use anyhow::Context;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
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

/// What one engine, or the file, has for the instances checked.
struct Column {
    name: String,
    status: Vec<Status>,
    /// [instance][observable]
    numbers: Vec<Vec<Vec<f64>>>,
    /// The same by the CPU, rounded after each operation as the shader's text has it; beside a GPU only.
    strict: Option<Vec<Vec<Vec<f64>>>>,
}

/// The instances checked, and their truth.
struct Table {
    instances: Vec<u32>,
    truths: Vec<Finished>,
    scales: Vec<Scales>,
    columns: Vec<Column>,
}

pub fn main(args: &CheckArgs, voice: Voice) -> anyhow::Result<()> {
    let file = args.input.extension().is_some_and(|end| end == "h5" || end == "partial");
    let (scene, stored) = if file { from_file(&args.input)? } else { (load(&args.input)?, None) };
    let plan = Plan::new(&scene, Precision::F64).with_context(|| format!("{}", args.input.display()))?;
    let instances = choose(&plan, args.instances as usize, args.seed);
    if instances.is_empty() {
        voice.say("nothing to check: no instance is stepped, the free motion is the answer");
        return Ok(());
    }
    voice.say(format_args!(
        "{}: {} of {} instances",
        args.input.display(),
        instances.len(),
        plan.cases.len()
    ));
    let part = plan.only(&instances);
    let truths = pick(&Reference::default().run(&part, &Progress::default())?.results, &instances);
    let mut columns: Vec<Column> =
        stored.map(|results| file_column(&results, &plan, &instances)).into_iter().collect();
    for precision in [Precision::F64, Precision::F32] {
        columns.push(column("cpu", &Cpu::default(), &part, precision, &instances)?);
    }
    match Gpu::new(args.device.as_deref()) {
        Ok(gpu) => {
            voice.say(format_args!("gpu: {}", gpu.report().title()));
            let strict = Cpu { strict: true, ..Cpu::default() };
            for precision in [Precision::F64, Precision::F32] {
                if precision == Precision::F64 && !gpu.report().double {
                    continue;
                }
                let twin = column("cpu", &strict, &part, precision, &instances)?;
                let ours = column("gpu", &gpu, &part, precision, &instances)?;
                columns.push(Column { strict: Some(twin.numbers), ..ours });
            }
        }
        Err(error) if args.device.is_some() => return Err(error.into()),
        Err(error) => voice.say(format_args!("gpu: not checked; {error}")),
    }
    let scales =
        instances.iter().zip(&truths).map(|(i, truth)| Scales::of(&plan, *i as usize, &truth.measured));
    let table = Table { scales: scales.collect(), instances, truths, columns };
    if args.json {
        print_json(&table.json(&plan))?;
    } else {
        print(&table.text(&scene, &plan))?;
    }
    let above: Vec<String> = table
        .columns
        .iter()
        .filter(|column| table.largest(column, &plan) > plan.run.accuracy)
        .map(|column| column.name.clone())
        .collect();
    if !above.is_empty() {
        anyhow::bail!("above the accuracy asked for, {:e}: {}", plan.run.accuracy, above.join(", "));
    }
    Ok(())
}

/// The scene that a results file was made from, and the file's content.
fn from_file(path: &Path) -> anyhow::Result<(Scene, Option<store::Results>)> {
    let results = store::read(path)?;
    let text = results.text("scene").unwrap_or_default();
    let scene = Scene::parse(path, text).with_context(|| format!("the scene in {}", path.display()))?;
    Ok((scene, Some(results)))
}

fn pick(results: &[Finished], instances: &[u32]) -> Vec<Finished> {
    instances.iter().map(|instance| results[*instance as usize]).collect()
}

fn all_numbers(plan: &Plan, measured: &Measured) -> Vec<Vec<f64>> {
    plan.observables.iter().map(|observable| numbers(*observable, measured)).collect()
}

fn column(
    name: &str,
    engine: &dyn Engine,
    plan: &Plan,
    precision: Precision,
    instances: &[u32],
) -> anyhow::Result<Column> {
    let plan = Plan { precision, ..plan.clone() };
    let finished = pick(&engine.run(&plan, &Progress::default())?.results, instances);
    Ok(Column {
        name: format!("{name} {}", precision.name()),
        status: finished.iter().map(|one| one.status).collect(),
        numbers: finished.iter().map(|one| all_numbers(&plan, &one.measured)).collect(),
        strict: None,
    })
}

fn file_column(results: &store::Results, plan: &Plan, instances: &[u32]) -> Column {
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
    Column {
        name: "file".into(),
        status: instances.iter().map(status).collect(),
        numbers: instances.iter().map(rows).collect(),
        strict: None,
    }
}

impl Table {
    /// Error of an observable (by its place in the plan) of the `i`-th instance.
    fn error(&self, column: &Column, plan: &Plan, i: usize, place: usize) -> f64 {
        let truth = &self.truths[i].measured;
        error_of(plan.observables[place], &column.numbers[i][place], truth, &self.scales[i])
    }

    /// The largest error of an instance.
    fn worst(&self, column: &Column, plan: &Plan, i: usize) -> f64 {
        let errors = (0..plan.observables.len()).map(|place| self.error(column, plan, i, place));
        errors.fold(0.0, |most, error| if error.is_nan() { f64::INFINITY } else { most.max(error) })
    }

    /// The largest of all errors that count: those of instances which engine and reference call ok.
    fn largest(&self, column: &Column, plan: &Plan) -> f64 {
        let counts = |i: &usize| column.status[*i] == Status::Ok && self.truths[*i].status == Status::Ok;
        let count = self.instances.len();
        (0..count).filter(counts).map(|i| self.worst(column, plan, i)).fold(0.0, f64::max)
    }

    fn text(&self, scene: &Scene, plan: &Plan) -> String {
        let mut text = String::new();
        let line = |text: &mut String, first: &str, second: &str, rest: Vec<String>| {
            let rest: String = rest.iter().map(|cell| format!("  {cell:>12}")).collect();
            *text += &format!("  {first:<18}{second:>14}{rest}\n");
        };
        for (i, &instance) in self.instances.iter().enumerate() {
            let case = &plan.cases[instance as usize];
            let modes = plan.classes.iter().find(|class| class.instances.contains(&instance));
            text += &format!(
                "instance {instance}: {}{}, {} modes, {} steps per period\n",
                values(scene, instance as usize),
                case.contact.law.name(),
                modes.map_or(0, |class| class.modes),
                case.steps
            );
            let names = self.columns.iter().map(|column| column.name.clone()).collect();
            line(&mut text, "", "reference", names);
            let status = self.columns.iter().map(|column| column.status[i].meaning().to_owned()).collect();
            line(&mut text, "status", self.truths[i].status.meaning(), status);
            for (place, observable) in plan.observables.iter().enumerate() {
                let value = numbers(*observable, &self.truths[i].measured)[0];
                let errors =
                    self.columns.iter().map(|column| format!("{:.1e}", self.error(column, plan, i, place)));
                line(&mut text, observable.name(), &shown(value, observable.units(), 4), errors.collect());
            }
            text.push('\n');
        }
        let counted = self.truths.iter().filter(|truth| truth.status == Status::Ok).count();
        text += &format!(
            "largest error, of {counted} instances that the reference calls ok, accuracy asked for {:e}:\n",
            plan.run.accuracy
        );
        for column in &self.columns {
            text +=
                &format!("  {:<10}{:.1e}{}\n", column.name, self.largest(column, plan), self.twin(column));
        }
        text
    }

    /// How a GPU's numbers are beside the CPU's in the same precision.
    fn twin(&self, column: &Column) -> String {
        let Some(strict) = &column.strict else { return String::new() };
        let bits = |numbers: &[Vec<f64>]| -> Vec<u64> {
            numbers.iter().flatten().map(|value| value.to_bits()).collect()
        };
        let same = column.numbers.iter().zip(strict).filter(|(ours, cpu)| bits(ours) == bits(cpu)).count();
        format!("   {same} of {} to the bit as the cpu's rounded alike", self.instances.len())
    }

    fn json(&self, plan: &Plan) -> Value {
        let column = |column: &Column, i: usize| {
            let errors = (plan.observables.iter().enumerate()).map(|(place, observable)| {
                (observable.name().to_owned(), json!(self.error(column, plan, i, place)))
            });
            json!({
                "engine": column.name,
                "status": column.status[i].meaning(),
                "errors": Value::Object(errors.collect()),
            })
        };
        let instances: Vec<Value> = (self.instances.iter().enumerate())
            .map(|(i, instance)| {
                let truth = &self.truths[i];
                let values = (plan.observables.iter())
                    .map(|observable| (observable.name().to_owned(), json!(numbers(*observable, &truth.measured))));
                json!({
                    "instance": instance,
                    "steps_per_period": plan.cases[*instance as usize].steps,
                    "reference": { "status": truth.status.meaning(), "values": Value::Object(values.collect()) },
                    "engines": self.columns.iter().map(|one| column(one, i)).collect::<Vec<_>>(),
                })
            })
            .collect();
        let largest: Vec<Value> = self
            .columns
            .iter()
            .map(|column| json!({ "engine": column.name, "largest_error": self.largest(column, plan) }))
            .collect();
        json!({ "accuracy": plan.run.accuracy, "largest": largest, "instances": instances })
    }
}

/// `sample Young's modulus 1 GPa, ...; ` of an instance; nothing without a sweep.
fn values(scene: &Scene, instance: usize) -> String {
    let axes = scene.sweep.axes.iter().zip(scene.sweep.indices(instance));
    let words: Vec<String> = axes
        .map(|(axis, at)| format!("{} {}", axis.long_name, shown(axis.values[at], &axis.units, 4)))
        .collect();
    if words.is_empty() { String::new() } else { words.join(", ") + "; " }
}
