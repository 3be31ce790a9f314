//! Marks what a stopped run has left unfinished.

use super::choices::Choices;
use super::first_estimate::EstimateInputs;
use super::step_reduction::half_steps;
use super::{ChunkRun, precision_trial, refinement};
use crate::engine::{Engine, EngineError, Progress};
use crate::observe::Status;
use crate::orbit::OrbitSolution;
use crate::plan::{Plan, Precision};
use crate::scene::Steady;

/// Calls [`refinement::run`] and, if that was stopped, marks the instances that it would have continued.
pub(super) fn marked(
    plan: Plan,
    stepped: &[u32],
    first: EstimateInputs,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<ChunkRun, EngineError> {
    let (before, chosen) = (plan.clone(), first.chosen);
    let mut done = refinement::run(plan, stepped, first, engine, progress)?;
    if progress.stopped() {
        done.mark_unfinished(&before, stepped, chosen);
    }
    Ok(done)
}

impl ChunkRun {
    /// A run before its first step.
    pub(super) fn not_begun(plan: Plan, choices: &Choices) -> Self {
        let settled = OrbitSolution { found: Vec::new(), ..OrbitSolution::not_run(&plan) };
        let arithmetic = choices.precision.arithmetic(plan.len());
        Self::unestimated(plan, settled, arithmetic)
    }

    /// Sets the status not_run for those of `stepped` that a run after the first ones of `before` could still have changed.
    /// Their values stay. An instance is done if its first estimate is small enough, or if no further run could have made it
    /// ok.
    fn mark_unfinished(&mut self, before: &Plan, stepped: &[u32], chosen: &precision_trial::PrecisionChoice) {
        let Self { plan, outcome, estimates, arithmetic, .. } = self;
        let told = before.run.steps_per_period.is_some();
        let search = before.run.steady == Steady::Search;
        let first = half_steps(before.clone());
        let modes = |plan: &Plan, i: usize| plan.driven(i as u32).kept.modes.clone();
        for i in stepped.iter().map(|i| *i as usize) {
            let once = plan.steps(i as u32) == first.steps(i as u32)
                && modes(plan, i) == modes(&first, i)
                && arithmetic.of[i] == chosen.precision;
            let waited = !search && (arithmetic.of[i] == Precision::F64 || !chosen.mixed);
            let done = match outcome.results[i].status {
                Status::Ok => told || once && estimates[i] <= plan.policy.certain * before.run.accuracy,
                // Later runs could have settled it: by time integration after the search, or by f64 after f32.
                Status::NotSteady => waited,
                Status::OutOfRange | Status::NonFinite => told,
                Status::Sensitive | Status::AccuracyNotMet | Status::NoSetpoint => true,
                Status::NotRun => false,
            };
            if !done {
                outcome.results[i].status = Status::NotRun;
            }
        }
        for (one, estimate) in outcome.results.iter().zip(estimates) {
            if one.status == Status::NotRun && !one.measured.is_any() {
                *estimate = f64::NAN;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control;
    use crate::engine::{Cpu, Outcome};
    use crate::test_plans::plan_of;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// The CPU engine, stopped in the middle of its run of this number.
    struct Stops<'a> {
        left: AtomicUsize,
        progress: &'a Progress,
    }

    impl Engine for Stops<'_> {
        fn device(&self) -> String {
            "stops".into()
        }

        fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
            let last = self.left.fetch_sub(1, Ordering::Relaxed) == 1;
            let done = Cpu::default().run(plan, progress)?;
            if last {
                self.progress.stop();
            }
            Ok(done)
        }
    }

    /// Stops the plan's run after each of these numbers of engine runs. Returns how many instances were cut short and how
    /// many kept. Truth: the same run without a stop. An instance that is ok in the stopped run has its values to the bit;
    /// any other has the same status as there, or not_run.
    fn stopped(plan: &Plan, after: impl Iterator<Item = usize>) -> [usize; 2] {
        let run = |runs: usize| {
            let progress = Progress::default();
            let engine = Stops { left: AtomicUsize::new(runs), progress: &progress };
            (control::run(plan, &engine, &progress).expect("it runs"), progress.stopped())
        };
        let (whole, _) = run(0);
        let (mut cut, mut kept) = (0, 0);
        for runs in after {
            let (part, stopped) = run(runs);
            if !stopped {
                break;
            }
            for (i, (one, other)) in part.results.iter().zip(whole.results.iter()).enumerate() {
                if one.status == Status::NotRun {
                    cut += 1;
                    continue;
                }
                kept += 1;
                let (one, other) = (format!("{one:?}"), format!("{other:?}"));
                assert_eq!(one, other, "stopped after run {runs}: instance {i}");
            }
        }
        [cut, kept]
    }

    #[test]
    fn what_a_stopped_run_calls_done_is_what_the_whole_run_gives() {
        let text = include_str!("../../../../scenes/quickstart.toml");
        let mut counts = [0, 0];
        for steady in ["wait", "search"] {
            let text = text.replace("[run]", &format!("[run]\nsteady = \"{steady}\""));
            let plan = plan_of(&text);
            let some: Vec<u32> = (0..plan.len() as u32).step_by(251).collect();
            let mut plan = plan.part(&some);
            // This accuracy makes refinement necessary for many of them.
            plan.run.accuracy = 2e-4;
            let [cut, kept] = stopped(&plan, 1..);
            counts = [counts[0] + cut, counts[1] + kept];
        }
        assert!(counts[0] > 0 && counts[1] > 0, "{} were cut short and {} kept", counts[0], counts[1]);
    }

    #[test]
    fn a_grid_is_stopped_between_neighbours() {
        let text = r#"
            [instrument.cantilever]
            modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 100 }]
            [contact]
            law = "hertz"
            [drive]
            on = "tip"
            frequency = "300 kHz"
            free_amplitude = "20 nm"
            [sweep]
            "sample.youngs_modulus" = { from = "1 GPa", to = "10 GPa", points = 32, scale = "log" }
            "approach.gap" = { from = "14 nm", to = "16 nm", points = 32 }
            [run]
            steady = "search"
            [output]
            observables = ["amplitude"]
        "#;
        let plan = plan_of(text);
        let [cut, kept] = stopped(&plan, 1..);
        assert!(cut > 0 && kept > 0, "{cut} were cut short and {kept} kept");
    }
}
