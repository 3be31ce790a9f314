//! The table that `check` prints: engines and file beside the reference, instance by instance.

use crate::cli::values;
use afmsweep::compare::{Scales, error_of, numbers};
use afmsweep::control::{ReferenceStart, touches};
use afmsweep::engine::Finished;
use afmsweep::observe::Status;
use afmsweep::plan::Plan;
use afmsweep::report::shown;
use afmsweep::scene::Scene;
use serde_json::{Value, json};

/// What one engine, or the file, has for the instances checked.
pub struct CheckColumn {
    pub name: String,
    pub status: Vec<Status>,
    /// [instance][observable]
    pub numbers: Vec<Vec<Vec<f64>>>,
    /// The same by the CPU, rounded after each operation as the shader's text has it; beside a GPU only.
    pub strict: Option<Vec<Vec<Vec<f64>>>>,
}

/// The instances checked, and their truth.
pub struct CheckTable {
    pub instances: Vec<u32>,
    /// Of these instances, in their order: what an own run of them chose.
    pub plan: Plan,
    pub truths: Vec<(Finished, ReferenceStart)>,
    pub scales: Vec<Scales>,
    pub columns: Vec<CheckColumn>,
}

impl CheckTable {
    /// Error of an observable (by its place in the plan) of the `i`-th instance.
    fn error(&self, column: &CheckColumn, i: usize, place: usize) -> f64 {
        let truth = &self.truths[i].0.measured;
        error_of(self.plan.observables[place], &column.numbers[i][place], truth, &self.scales[i])
    }

    /// The largest error of an instance.
    fn worst(&self, column: &CheckColumn, i: usize) -> f64 {
        let errors = (0..self.plan.observables.len()).map(|place| self.error(column, i, place));
        errors.fold(0.0, |most, error| if error.is_nan() { f64::INFINITY } else { most.max(error) })
    }

    /// The instances that count: those that both this column and the reference call ok.
    pub fn counted(&self, column: &CheckColumn) -> Vec<usize> {
        let ok = |i: &usize| column.status[*i] == Status::Ok && self.truths[*i].0.status == Status::Ok;
        (0..self.instances.len()).filter(ok).collect()
    }

    /// The largest of all errors that count; none where none does.
    pub fn largest(&self, column: &CheckColumn) -> Option<f64> {
        self.counted(column).into_iter().map(|i| self.worst(column, i)).reduce(f64::max)
    }

    /// How many of these touch the sample, by the reference.
    pub fn touching(&self, counted: &[usize]) -> usize {
        counted.iter().filter(|i| touches(&self.truths[**i].0)).count()
    }

    /// Instances that the reference calls ok.
    pub fn known(&self) -> usize {
        self.truths.iter().filter(|(truth, _)| truth.status == Status::Ok).count()
    }

    pub fn text(&self, scene: &Scene) -> String {
        let mut text = String::new();
        let line = |text: &mut String, first: &str, second: &str, rest: Vec<String>| {
            let rest: String = rest.iter().map(|cell| format!("  {cell:>12}")).collect();
            *text += &format!("  {first:<18}{second:>14}{rest}\n");
        };
        for (i, &instance) in self.instances.iter().enumerate() {
            let case = self.plan.case(i as u32);
            let place = values(scene, instance as usize);
            let (truth, way) = &self.truths[i];
            text += &format!(
                "instance {instance}: {place}{}{}, {} modes, {} steps per period; reference: {}{}\n",
                if place.is_empty() { "" } else { "; " },
                case.contact.law.name(),
                self.plan.driven(i as u32).kept.modes.len(),
                case.steps,
                if case.steps == 0 { "free motion" } else { way.words() },
                if touches(truth) { "" } else { ", no contact" },
            );
            let names = self.columns.iter().map(|column| column.name.clone()).collect();
            line(&mut text, "", "reference", names);
            let status = self.columns.iter().map(|column| column.status[i].meaning().to_owned()).collect();
            line(&mut text, "status", truth.status.meaning(), status);
            for (place, observable) in self.plan.observables.iter().enumerate() {
                let value = numbers(*observable, &truth.measured)[0];
                let errors =
                    self.columns.iter().map(|column| format!("{:.1e}", self.error(column, i, place)));
                line(&mut text, observable.name(), &shown(value, observable.units(), 4), errors.collect());
            }
            text.push('\n');
        }
        let all: Vec<usize> =
            (0..self.instances.len()).filter(|i| self.truths[*i].0.status == Status::Ok).collect();
        text += &format!(
            "the reference calls {} of {} instances ok; {} of these touch the sample\n\
             largest error of the instances that both call ok, accuracy asked for {:e}:\n",
            all.len(),
            self.instances.len(),
            self.touching(&all),
            self.plan.run.accuracy
        );
        for column in &self.columns {
            let counted = self.counted(column).len();
            let largest = match self.largest(column) {
                Some(largest) => format!("{largest:.1e} of {counted}"),
                None => "nothing compared".into(),
            };
            text += &format!("  {:<10}{largest}{}\n", column.name, self.twin(column));
        }
        text
    }

    /// How a GPU's numbers are beside the CPU's in the same precision.
    fn twin(&self, column: &CheckColumn) -> String {
        let Some(strict) = &column.strict else { return String::new() };
        let bits = |numbers: &[Vec<f64>]| -> Vec<u64> {
            numbers.iter().flatten().map(|value| value.to_bits()).collect()
        };
        let same = column.numbers.iter().zip(strict).filter(|(ours, cpu)| bits(ours) == bits(cpu)).count();
        format!("   {same} of {} to the bit as the cpu's rounded alike", self.instances.len())
    }

    pub fn json(&self) -> Value {
        let plan = &self.plan;
        let column = |column: &CheckColumn, i: usize| {
            let errors = (plan.observables.iter().enumerate()).map(|(place, observable)| {
                (observable.name().to_owned(), json!(self.error(column, i, place)))
            });
            json!({
                "engine": column.name,
                "status": column.status[i].meaning(),
                "errors": Value::Object(errors.collect()),
            })
        };
        let instances: Vec<Value> = (self.instances.iter().enumerate())
            .map(|(i, instance)| {
                let (truth, way) = &self.truths[i];
                let values = (plan.observables.iter()).map(|observable| {
                    (observable.name().to_owned(), json!(numbers(*observable, &truth.measured)))
                });
                json!({
                    "instance": instance,
                    "steps_per_period": plan.steps(i as u32),
                    "reference": {
                        "status": truth.status.meaning(),
                        "by": way.words(),
                        "touches": touches(truth),
                        "values": Value::Object(values.collect()),
                    },
                    "engines": self.columns.iter().map(|one| column(one, i)).collect::<Vec<_>>(),
                })
            })
            .collect();
        let largest: Vec<Value> = self
            .columns
            .iter()
            .map(|column| {
                let counted = self.counted(column);
                json!({
                    "engine": column.name,
                    "largest_error": self.largest(column),
                    "compared": counted.len(),
                    "touching": self.touching(&counted),
                })
            })
            .collect();
        json!({ "accuracy": plan.run.accuracy, "largest": largest, "instances": instances })
    }
}
