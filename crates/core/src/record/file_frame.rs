//! A results file without the numbers over all its instances.

use super::instance_variables::{InstanceFlag, InstanceVariable};
use super::orbit_variables::second_states;
use super::{Facts, SOURCE_REVISION, coordinate, design, force_curves, from_preset};
use crate::observe::Observable;
use crate::plan::{Plan, Precision};
use crate::scene::{Layout, Scene, Steady};
use crate::store::{Attribute, Flags, Results};

/// The contents of a results file except the numbers over all instances, and a list of these numbers.
#[derive(Clone, Debug)]
pub struct FileFrame {
    /// Its variables, flags, status and steps are empty.
    pub results: Results,
    /// What each variable and each flag holds.
    pub(super) variables: Vec<InstanceVariable>,
    pub(super) flags: Vec<InstanceFlag>,
}

impl FileFrame {
    /// The frame of a run of the plan with this many instance-steps.
    pub(super) fn new(scene: &Scene, (plan, instance_steps): (&Plan, u64), facts: &Facts) -> Self {
        let list = scene.sweep.layout == Layout::List;
        let results = Results {
            title: scene.title.clone(),
            axes: scene.sweep.axes.iter().map(coordinate).collect(),
            list,
            force_curves: force_curves(scene, plan),
            attributes: vec![
                ("program".into(), Attribute::Text("afmsweep".into())),
                ("version".into(), Attribute::Text(env!("CARGO_PKG_VERSION").into())),
                ("source_revision".into(), Attribute::Text(SOURCE_REVISION.into())),
                ("command_line".into(), Attribute::Text(facts.command_line.clone())),
                ("device".into(), Attribute::Text(facts.device.clone())),
                ("precision".into(), Attribute::Text(facts.arithmetic.name().into())),
                ("precision_reason".into(), Attribute::Text(facts.arithmetic.reason.clone())),
                ("wall_time_seconds".into(), Attribute::Number(facts.wall_time)),
                ("instance_steps".into(), Attribute::Number(instance_steps as f64)),
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
            ..Results::default()
        };
        let mut frame = Self { results, variables: Vec::new(), flags: Vec::new() };
        plan.observables.iter().for_each(|one| frame.push(InstanceVariable::Observable(*one)));
        frame.push(InstanceVariable::Tabor);
        let scaled = [Observable::Dissipation, Observable::Virial];
        if plan.observables.iter().any(|one| scaled.contains(one)) {
            frame.push(InstanceVariable::DriveWork);
        }
        const BOTH: [Precision; 2] = [Precision::F32, Precision::F64];
        let both = BOTH.iter().all(|one| facts.arithmetic.of.contains(one));
        frame.flag(InstanceFlag::Law);
        frame.flag(InstanceFlag::Warnings);
        both.then(|| frame.flag(InstanceFlag::Precision));
        frame
    }

    /// Adds variable `error_estimate`, with a comment on how the estimates were made.
    pub(crate) fn estimated(&mut self, basis: String) {
        self.push(InstanceVariable::Estimate);
        self.results.comments.push((InstanceVariable::Estimate.variable().name, basis));
    }

    /// Adds `branch`, `multiplier` and `periods_stepped` for a run that searched, the flag `jump` for curves, and the group
    /// `other_branch` if second states were requested.
    pub(crate) fn searched(&mut self, plan: &Plan, curves: bool, others: bool) {
        if plan.run.steady != Steady::Search {
            return;
        }
        self.push(InstanceVariable::Multiplier);
        self.push(InstanceVariable::Periods);
        self.flag(InstanceFlag::Branch);
        self.results.other_branch = others.then(|| second_states(plan));
        if curves {
            self.flag(InstanceFlag::Jump);
        }
    }

    fn push(&mut self, number: InstanceVariable) {
        self.results.variables.push(number.variable());
        self.variables.push(number);
    }

    fn flag(&mut self, code: InstanceFlag) {
        self.results.flags.push(code.flags());
        self.flags.push(code);
    }

    /// Place and flags of this name.
    pub fn flag_named(&self, name: &str) -> Option<(usize, &Flags)> {
        self.results.flags.iter().enumerate().find(|(_, flags)| flags.name == name)
    }
}
