//! From a finished run to the plain data of its results file.

mod answers;
mod audit;
mod columns;
mod portion;
mod search;
mod waveforms;

use crate::compare::Scales;
use crate::contact::{Contact, Law, Warning};
use crate::control::Arithmetic;
use crate::design::Described;
use crate::engine::{Columns, Finished};
use crate::observe::Observable;
use crate::plan::{Plan, Precision};
use crate::scene::{Layout, Params, Scene};
use crate::store::{Attribute, Coordinate, Flags, ForceCurve, Results, Variable};
use rayon::prelude::*;

pub use answers::{
    allowance_from_bytes, allowance_to_bytes, from_bytes as answers_from_bytes, numbers_from_bytes,
    numbers_question, numbers_to_bytes, questions, to_bytes as answers_to_bytes,
};
pub use audit::{audit, error_estimate};
pub use portion::{from_bytes as portion_from_bytes, number as portion_number, to_bytes as portion_to_bytes};
pub use search::{BRANCHES, JUMPS, jumps, search};
pub use waveforms::{waveforms, waveforms_kept};

/// The revision of the sources that the program was built from: `git describe`, or `unknown` outside a repository.
pub const SOURCE_REVISION: &str = env!("AFMSWEEP_REVISION");

/// What is known of a run beside its numbers.
#[derive(Clone, Debug)]
pub struct Facts {
    pub device: String,
    /// Planning and stepping, s.
    pub wall_time: f64,
    /// Instance-steps taken: trials, searches and estimates among them, audits not.
    pub steps_taken: u64,
    /// Instance-steps per second of the stepping.
    pub rate: f64,
    /// Share of the instances whose results began at their neighbours' states.
    pub neighbour_started: f64,
    /// The plan as JSON.
    pub plan: String,
    /// How the program was called; of a library, that it is one.
    pub command_line: String,
    pub arithmetic: Arithmetic,
}

/// Everything the results file holds, waveforms apart.
pub fn results(scene: &Scene, plan: &Plan, finished: &Columns, facts: &Facts) -> Results {
    let warnings = warnings(scene, plan, finished);
    Results {
        title: scene.title.clone(),
        axes: scene.sweep.axes.iter().map(coordinate).collect(),
        list: scene.sweep.layout == Layout::List,
        variables: variables(plan, finished),
        status: finished.statuses().iter().map(|one| *one as u8).collect(),
        steps_per_period: plan.cases().map(|case| case.steps).collect(),
        flags: vec![
            Flags {
                name: "contact_law".into(),
                long_name: "contact law used".into(),
                meanings: Law::ALL.iter().map(|law| law.name().to_owned()).collect(),
                bits: false,
                data: plan.cases().map(|case| case.contact.law.code()).collect(),
            },
            Flags {
                name: "contact_warnings".into(),
                long_name: "where the contact law is used outside its assumptions".into(),
                meanings: WARNINGS.iter().map(|word| (*word).to_owned()).collect(),
                bits: true,
                data: warnings,
            },
        ]
        .into_iter()
        .chain(precisions(&facts.arithmetic))
        .collect(),
        waveforms: None,
        force_curves: force_curves(scene, plan),
        audit: None,
        other_branch: None,
        comments: Vec::new(),
        attributes: vec![
            ("program".into(), Attribute::Text("afmsweep".into())),
            ("version".into(), Attribute::Text(env!("CARGO_PKG_VERSION").into())),
            ("source_revision".into(), Attribute::Text(SOURCE_REVISION.into())),
            ("command_line".into(), Attribute::Text(facts.command_line.clone())),
            ("device".into(), Attribute::Text(facts.device.clone())),
            ("precision".into(), Attribute::Text(facts.arithmetic.name().into())),
            ("precision_reason".into(), Attribute::Text(facts.arithmetic.reason.clone())),
            ("wall_time_seconds".into(), Attribute::Number(facts.wall_time)),
            ("instance_steps".into(), Attribute::Number(plan.instance_steps() as f64)),
            ("instance_steps_taken".into(), Attribute::Number(facts.steps_taken as f64)),
            ("instance_steps_per_second".into(), Attribute::Number(facts.rate)),
            ("neighbour_started".into(), Attribute::Number(facts.neighbour_started)),
        ]
        .into_iter()
        .chain(design(scene).map(|text| ("design".into(), Attribute::Text(text))))
        .collect(),
        provenance: vec![
            ("scene".into(), scene.source.clone()),
            ("scene_resolved".into(), scene.resolved_toml()),
            ("from_preset".into(), from_preset(scene)),
            ("plan".into(), facts.plan.clone()),
            ("policy".into(), plan.policy.lines().join("\n")),
        ],
    }
}

/// Paths of the quantities that the scene does not give, single words; `none` where it gives all.
fn from_preset(scene: &Scene) -> String {
    let paths: Vec<String> = scene.from_preset().into_iter().map(|(path, _)| path).collect();
    if paths.is_empty() { "none".to_owned() } else { paths.join(" ") }
}

/// Attribute `design`: what the samples follow from, as JSON.
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
    serde_json::to_string(&Described::new(design, &ends)).ok()
}

/// Flag `precision`, where a run has both.
fn precisions(arithmetic: &Arithmetic) -> Option<Flags> {
    const BOTH: [Precision; 2] = [Precision::F32, Precision::F64];
    BOTH.iter().all(|one| arithmetic.of.contains(one)).then(|| Flags {
        name: "precision".into(),
        long_name: "arithmetic of the instance's last run".into(),
        meanings: BOTH.iter().map(|one| one.name().into()).collect(),
        bits: false,
        data: arithmetic.of.iter().map(|one| u8::from(*one == Precision::F64)).collect(),
    })
}

fn coordinate(axis: &crate::scene::Axis) -> Coordinate {
    Coordinate {
        name: axis.name.clone(),
        units: axis.units.clone(),
        long_name: axis.long_name.clone(),
        scene_path: axis.path.clone(),
        words: axis.words.clone(),
        columns: axis.columns.iter().map(coordinate).collect(),
        values: axis.values.clone(),
    }
}

fn variables(plan: &Plan, results: &Columns) -> Vec<Variable> {
    let mut variables = observables(plan, results.iter());
    variables.push(Variable {
        name: "tabor_parameter".into(),
        units: "1".into(),
        long_name: "Tabor's parameter of the contact".into(),
        harmonics: None,
        error_scale: String::new(),
        data: plan.cases().map(|case| case.contact.tabor).collect(),
    });
    variables.extend(drive_work(plan, results));
    variables
}

/// Variable `drive_work`, the scale of what is lost and of the virial, where one of them was asked for.
fn drive_work(plan: &Plan, results: &Columns) -> Option<Variable> {
    let scaled = [Observable::Dissipation, Observable::Virial];
    let of = |i: usize| match results.get(i).measured {
        measured if measured.phase.is_nan() => f64::NAN,
        measured => Scales::of(plan, i, &measured).work,
    };
    plan.observables.iter().any(|one| scaled.contains(one)).then(|| Variable {
        name: "drive_work".into(),
        units: "J".into(),
        long_name: "work of the drive per period, or the loss if larger: the scale of errors of both".into(),
        harmonics: None,
        error_scale: String::new(),
        data: (0..results.len()).into_par_iter().map(of).collect(),
    })
}

fn observables(plan: &Plan, results: impl Iterator<Item = Finished> + Clone) -> Vec<Variable> {
    let count = results.clone().count();
    plan.observables
        .iter()
        .map(|&observable| {
            let width = observable.width();
            let mut data = vec![0.0; width * count];
            for (row, one) in data.chunks_exact_mut(width).zip(results.clone()) {
                observable.write(&one.measured, row);
            }
            Variable {
                name: observable.name().into(),
                units: observable.units().into(),
                long_name: observable.long_name().into(),
                harmonics: (observable == Observable::HarmonicAmplitude).then_some(width),
                error_scale: observable.scale().words().into(),
                data,
            }
        })
        .collect()
}

/// Whether a run has done all it was asked for: attribute `complete`, and in a file that lacks something
/// `incomplete_phase`, in which the run was stopped, and `missing`, that and all phases after it.
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

/// Words for the bits of `contact_warnings`.
pub const WARNINGS: [&str; 5] =
    ["law_does_not_fit", "between_laws", "adhesion_left_out", "large_strain", "rigid_tip"];

fn bit(warning: &Warning) -> u8 {
    match warning {
        Warning::LawDoesNotFit { .. } => 1,
        Warning::BetweenLaws { .. } => 1 << 1,
        Warning::AdhesionLeftOut { .. } => 1 << 2,
        Warning::LargeStrain { .. } => 1 << 3,
        Warning::RigidTip { .. } => 1 << 4,
    }
}

/// Warnings of each instance as bits, at the largest indentation measured or else expected.
fn warnings(scene: &Scene, plan: &Plan, finished: &Columns) -> Vec<u8> {
    (0..plan.len())
        .into_par_iter()
        .map(|index| {
            let depth = depth(plan, index, finished.get(index).measured.indentation_max);
            let params = scene.instance(index);
            let contact = plan.contact(index as u32);
            contact.warnings(&params, depth).iter().map(bit).fold(0, |all, one| all | one)
        })
        .collect()
}

/// How many instances have each warning of [`WARNINGS`], and the first one's own words.
pub fn warning_lines(scene: &Scene, plan: &Plan, finished: &Columns, results: &Results) -> Vec<String> {
    let Some(flags) = results.flags.iter().find(|flags| flags.bits) else { return Vec::new() };
    (0..WARNINGS.len())
        .filter_map(|number| {
            let mask = 1u8 << number;
            let count = flags.data.iter().filter(|bits| **bits & mask != 0).count();
            let first = flags.data.iter().position(|bits| bits & mask != 0)?;
            let params: Params = scene.instance(first);
            let contact: Contact = plan.contact(first as u32);
            let depth = depth(plan, first, finished.get(first).measured.indentation_max);
            let words = contact
                .warnings(&params, depth)
                .into_iter()
                .find(|warning| bit(warning) == mask)
                .map_or_else(|| WARNINGS[number].replace('_', " "), |warning| warning.to_string());
            Some(match flags.data.len() {
                1 => words,
                all => format!("{count} of {all} instances, instance {first} first: {words}"),
            })
        })
        .collect()
}

/// Largest indentation of an instance, m: measured; none where it was measured and there was no contact;
/// else what the plan expects.
fn depth(plan: &Plan, instance: usize, measured: f64) -> Option<f64> {
    match measured.is_nan() {
        false => Some(measured),
        true if plan.wants.extremes || plan.steps(instance as u32) == 0 => None,
        true => Some(plan.expected_depth(instance as u32)),
    }
}

/// Static curves of the first eight instances with waveforms; one contact once.
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
