//! Turns a finished run into the plain data of its results file.

mod audit_variables;
mod file_frame;
mod instance_rows;
mod instance_variables;
mod orbit_variables;
mod record_variables;
mod spectra;
mod warnings;
mod waveforms;

use crate::contact::Contact;
use crate::control::{Arithmetic, JournaledRun};
use crate::design::DesignDescription;
use crate::engine::{EngineError, Finished, ResultColumns};
use crate::observe::Observable;
use crate::plan::Plan;
use crate::scene::Scene;
use crate::store::{Attribute, Coordinate, ForceCurve, Results, Variable};
use instance_rows::InstanceRows;
use instance_variables::InstanceVariable;
use std::sync::Arc;

pub use audit_variables::audit;
pub use file_frame::FileFrame;
pub use instance_variables::{BRANCHES, JUMPS};
pub use record_variables::RecordVariables;
pub use spectra::{spectra, spectra_of_run};
pub use warnings::{LawWarnings, WARNINGS};
pub use waveforms::{waveforms, waveforms_kept};

/// The revision of the sources that the program was built from: `git describe`, or `unknown` outside a repository.
pub const SOURCE_REVISION: &str = env!("AFMSWEEP_REVISION");

/// Facts about a run beside its numbers.
#[derive(Clone, Debug)]
pub struct Facts {
    pub device: String,
    /// Time of planning and stepping, s.
    pub wall_time: f64,
    /// Instance-steps taken, with trials, searches and estimates but without audits.
    pub steps_taken: u64,
    /// Instance-steps per second of stepping.
    pub rate: f64,
    /// Share of the instances whose results come from searches started at their neighbours' states.
    pub neighbour_started: f64,
    /// The plan as JSON.
    pub plan: String,
    /// How the program was called, or that a library ran it.
    pub command_line: String,
    pub arithmetic: Arithmetic,
}

/// Warnings and steps of all instances, from one pass over the run.
///
/// # Errors
/// A stored chunk cannot be read.
pub fn warned(scene: &Scene, run: &JournaledRun) -> Result<LawWarnings, EngineError> {
    LawWarnings::of(scene, &InstanceRows::Run(run))
}

/// The results file of a run of the plan, without the numbers over all instances.
pub fn frame(scene: &Scene, (plan, warned): (&Plan, &LawWarnings), facts: &Facts) -> FileFrame {
    FileFrame::new(scene, (plan, warned.instance_steps), facts)
}

/// The contents of the results file of a plan that ran once, without waveforms and spectra.
///
/// # Errors
/// None is known.
pub fn results(
    scene: &Scene,
    plan: &Plan,
    finished: &ResultColumns,
    facts: &Facts,
) -> Result<Results, EngineError> {
    let rows = InstanceRows::Plain { plan, finished, arithmetic: &facts.arithmetic };
    let warned = LawWarnings::of(scene, &rows)?;
    let frame = FileFrame::new(scene, (plan, warned.instance_steps), facts);
    let numbers = RecordVariables::new(&frame, (rows, &warned), None);
    frame.results.clone().with_numbers(&numbers).map_err(|unread| EngineError::Unread { why: unread.0 })
}

/// Paths of the quantities that the scene does not set, separated by spaces. `none` if it sets all.
fn from_preset(scene: &Scene) -> String {
    let paths: Vec<String> = scene.from_preset().into_iter().map(|(path, _)| path).collect();
    if paths.is_empty() { "none".to_owned() } else { paths.join(" ") }
}

/// Attribute `design`: what determines the samples, as JSON.
fn design(scene: &Scene) -> Option<String> {
    let design = scene.drawn.design.as_deref()?;
    let ends = |values: &[f64]| {
        let of = |fold: fn(f64, f64) -> f64, start: f64| values.iter().copied().fold(start, fold);
        (of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY))
    };
    let column = |path: &str| scene.sweep.quantities().find(|axis| axis.path == path);
    let ends: Vec<(f64, f64)> = design
        .parameters
        .iter()
        .map(|one| column(&one.path).map_or((f64::NAN, f64::NAN), |axis| ends(&axis.values)))
        .collect();
    serde_json::to_string(&DesignDescription::new(design, &ends)).ok()
}

fn coordinate(axis: &crate::scene::Axis) -> Coordinate {
    Coordinate {
        name: axis.name.clone(),
        units: axis.units.clone(),
        long_name: axis.long_name.clone(),
        scene_path: axis.path.clone(),
        words: axis.words.clone(),
        columns: axis.columns.iter().map(coordinate).collect(),
        values: Arc::clone(&axis.values),
    }
}

/// The plan's observables of these instances.
fn observables(plan: &Plan, results: impl Iterator<Item = Finished> + Clone) -> Vec<Variable> {
    let count = results.clone().count();
    let one = |observable: &Observable| {
        let width = observable.width();
        let mut data = vec![0.0; width * count];
        for (row, one) in data.chunks_exact_mut(width).zip(results.clone()) {
            observable.write(&one.measured, row);
        }
        Variable { data, ..InstanceVariable::Observable(*observable).variable() }
    };
    plan.observables.iter().map(one).collect()
}

/// Attributes on what a run has done: `complete`, and if something is missing `incomplete_phase`, where the run was stopped,
/// and `missing`, that phase and all after it.
pub fn complete(missing: &[&str]) -> Vec<(String, Attribute)> {
    let number = |value| ("complete".to_owned(), Attribute::Number(value));
    match missing {
        [] => vec![number(1.0)],
        [first, ..] => vec![
            number(0.0),
            ("incomplete_phase".into(), Attribute::Text((*first).into())),
            ("missing".into(), Attribute::Text(missing.join(" "))),
        ],
    }
}

/// Static curves of the first eight instances with waveforms. Equal contacts appear once.
fn force_curves(scene: &Scene, plan: &Plan) -> Vec<ForceCurve> {
    let Some(request) = &scene.output.waveforms else { return Vec::new() };
    let mut seen: Vec<Contact> = Vec::new();
    let mut curves = Vec::new();
    for &instance in request.instances.iter().take(8) {
        let contact = plan.contact(instance as u32);
        if !contact.law.acts() || seen.contains(&contact) {
            continue;
        }
        seen.push(contact);
        for curve in contact.curves().curves {
            let values = |list: Vec<Option<f64>>| list.into_iter().map(|v| v.unwrap_or(f64::NAN)).collect();
            curves.push(ForceCurve {
                instance: instance as u64,
                law: curve.law.name().into(),
                branch: curve.branch.name().into(),
                indentation: curve.indentation_m,
                force: values(curve.force_n),
                contact_radius: values(curve.contact_radius_m),
            });
        }
    }
    curves
}
