//! Measures the states that searches find: by one period that confirms the state, or by some that continue from it.

use super::initial_guess::{InitialGuess, Unconverged};
use super::quasi_newton::correct_own_states;
use super::{OrbitSolution, PeriodicState, gather, residual, search_batch};
use crate::engine::{Engine, EngineError, Finished, Outcome, Progress, in_double};
use crate::plan::{Plan, Precision, SectionState, StartState};

/// Periods that continue from a state that one period does not confirm; all but the first are measured. A few are as good as
/// many in a periodic state. Steadiness needs the changes of four periods, and that of the first is unknown.
const CONFIRM_PERIODS: u32 = 5;

/// A force is vague if the error bound of the state leaves it uncertain by this many accuracies. The bound is some fifteen
/// times the distance.
const VAGUE_FORCE_ACCURACIES: f64 = 5.0;
/// Only tips that move or indent by less than this, in free amplitudes, may have vague forces.
pub(super) const SHALLOW_AMPLITUDES: f64 = 0.02;
/// States with vague forces are searched for to this share of the accuracy.
const FORCE_TOL_SHARE: f64 = 1e-3;

/// Searches for states and confirms them, with forces as accurate as travel. Also returns instances without a state.
pub(super) fn search_and_verify(
    plan: &Plan,
    instances: &[u32],
    begin: InitialGuess,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(OrbitSolution, Vec<Unconverged>), EngineError> {
    let (mut settled, mut left) = search_by_travel(plan, instances, begin, engine, progress)?;
    settled.tighten_vague_forces(plan, instances, engine, progress)?;
    let dropped = settled.drop_unconfirmed(instances);
    left.extend(dropped.into_iter().map(|i| Unconverged::anew(plan, i)));
    Ok((settled, left))
}

/// The same, with states confirmed by their travel alone. The results of those that nothing confirms are not steady.
fn search_by_travel(
    plan: &Plan,
    instances: &[u32],
    begin: InitialGuess,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<(OrbitSolution, Vec<Unconverged>), EngineError> {
    let double = in_double(engine);
    progress.task("search", instances.len() as u64);
    let by_class = plan.part(instances).by_class();
    let alike: Vec<u32> = by_class.into_iter().map(|place| instances[place as usize]).collect();
    let searched = search_batch::solve_batches(plan, &alike, begin, double, progress)?;
    let is_found = |i: &u32| searched.found[*i as usize].is_some();
    let chosen: Vec<u32> = instances.iter().copied().filter(is_found).collect();
    let mut settled = OrbitSolution {
        outcome: Outcome { notes: searched.notes, ..Outcome::of(plan) },
        found: searched.found,
        periods: searched.periods,
        jumps: Vec::new(),
    };
    let unsure = settled.confirm_by_residual(plan, &chosen, engine, progress)?;
    settled.run_on(&plan.part(&unsure), &unsure, engine, progress)?;
    let is_rough = |i: &u32| !settled.outcome.results[*i as usize].status.is_steady();
    let rough: Vec<u32> = chosen.iter().copied().filter(is_rough).collect();
    if plan.precision == Precision::F32 && !rough.is_empty() && !progress.stopped() {
        // Rounding in f32 lets a weakly damped state drift too far.
        settled.run_on(&plan.part(&rough).in_precision(Precision::F64), &rough, double, progress)?;
    }
    Ok((settled, searched.left))
}

impl OrbitSolution {
    /// Forgets a state that a run does not confirm. The instance counts as not run, so that other starts follow.
    pub(super) fn drop_state(&mut self, i: u32) {
        (self.found[i as usize], self.outcome.results[i as usize]) = (None, Finished::NOT_RUN);
    }

    /// Forgets the states of `instances` that no run confirms, and returns these instances.
    pub(super) fn drop_unconfirmed(&mut self, instances: &[u32]) -> Vec<u32> {
        let unconfirmed = |i: &u32| {
            self.state(*i as usize).is_some() && !self.outcome.results[*i as usize].status.is_steady()
        };
        let dropped: Vec<u32> = instances.iter().copied().filter(unconfirmed).collect();
        dropped.iter().for_each(|i| self.drop_state(*i));
        dropped
    }

    /// Measures one period of each of the states found of `chosen`, and takes it as the result where its residual confirms the
    /// state. Returns the others.
    pub(super) fn confirm_by_residual(
        &mut self,
        plan: &Plan,
        chosen: &[u32],
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<Vec<u32>, EngineError> {
        if chosen.is_empty() {
            return Ok(Vec::new());
        }
        let place = |i: &u32| self.state(*i as usize).map_or(SectionState::FREE, |state| state.section);
        progress.task("measuring", 0);
        let once = residual::measure_period(plan.part(chosen), chosen.iter().map(place), engine, progress)?;
        self.outcome.notes.extend(once.notes);
        let (mut unsure, mut anew) = (Vec::new(), Vec::new());
        for ((i, finished), end) in chosen.iter().zip(once.results).zip(once.ends) {
            self.periods[*i as usize] += 1;
            if end.as_ref().is_some_and(|end| self.recount_contacts(plan, *i, end.touching)) {
                anew.push(*i);
                continue;
            }
            let state = self.state(*i as usize);
            let sure =
                state.is_some_and(|state| residual::residual_confirms(plan, *i, state, end.as_deref()));
            match sure && finished.status.is_steady() {
                true => self.outcome.results[*i as usize] = finished,
                false => unsure.push(*i),
            }
        }
        unsure.extend(self.confirm_by_residual(plan, &anew, engine, progress)?);
        Ok(unsure)
    }

    /// Contact follows from the tip's position under a law without memory, so a periodic state begins in the contact in which
    /// its period ends. Corrects the state, and returns whether its contacts need a new count.
    pub(super) fn recount_contacts(&mut self, plan: &Plan, i: u32, touching: bool) -> bool {
        let state = self.found[i as usize].as_mut().filter(|state| state.section.touching != touching);
        let Some(state) = state.filter(|_| !plan.law(i).has_hysteresis()) else { return false };
        state.section.touching = touching;
        plan.wants.contact
    }

    /// Searches more closely for states whose forces depend on more digits of the travel than were found. Forces on a resting
    /// tip are small differences of large numbers. States that no run has confirmed are corrected, too.
    pub(super) fn tighten_vague_forces(
        &mut self,
        plan: &Plan,
        instances: &[u32],
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        if plan.precision == Precision::F32 || progress.stopped() {
            return Ok(());
        }
        let vague: Vec<u32> = instances.iter().copied().filter(|i| self.is_vague(plan, *i)).collect();
        if vague.is_empty() {
            return Ok(());
        }
        let mut part = plan.part(&vague);
        part.run.accuracy *= FORCE_TOL_SHARE;
        let near = gather(&self.found, &vague);
        let mut sharp = correct_own_states(&part, &near, engine, progress)?;
        let confirmed = |i: u32| self.outcome.results[vague[i as usize] as usize].status.is_steady();
        let is_open = |i: &u32| sharp.found[*i as usize].is_none() && confirmed(*i);
        let open: Vec<u32> = part.instances().filter(is_open).collect();
        let place = |i: &u32| near[*i as usize].map_or(SectionState::FREE, |state| state.section);
        let places: Vec<SectionState> = open.iter().map(place).collect();
        let rest = part.part(&open);
        let all: Vec<u32> = rest.instances().collect();
        let (searched, _) =
            search_by_travel(&rest, &all, InitialGuess::PointsOnly(&places), engine, progress)?;
        sharp.take(&open, searched);
        sharp.drop_unconfirmed(&open);
        self.outcome.notes.append(&mut sharp.outcome.notes);
        for (n, i) in vague.into_iter().map(|i| i as usize).enumerate() {
            self.periods[i] += sharp.periods[n];
            if let Some(state) = sharp.found[n].take() {
                (self.found[i], self.outcome.results[i]) = (Some(state), sharp.outcome.results[n]);
            }
        }
        Ok(())
    }

    /// Whether no run has confirmed the state, or its error bound leaves much of its forces uncertain.
    fn is_vague(&self, plan: &Plan, i: u32) -> bool {
        let result = &self.outcome.results[i as usize];
        if self.state(i as usize).is_none() || !result.status.is_steady() {
            return self.state(i as usize).is_some();
        }
        let (one, amplitude) = (&result.measured, plan.driven(i).free_amplitude());
        let shallow = one.indentation_max.min(one.harmonics[0]) < SHALLOW_AMPLITUDES * amplitude;
        plan.wants.extremes
            && shallow
            && residual::force_share(plan, i, one, residual::RESIDUAL_TOL * amplitude)
                > VAGUE_FORCE_ACCURACIES
    }

    /// Continues from the states found of `instances`, which make up `plan`, and measures them.
    pub(super) fn run_on(
        &mut self,
        plan: &Plan,
        instances: &[u32],
        engine: &dyn Engine,
        progress: &Progress,
    ) -> Result<(), EngineError> {
        if instances.is_empty() {
            return Ok(());
        }
        let on = run_on(plan.clone(), &gather(&self.found, instances), engine, progress)?;
        self.outcome.notes.extend(on.notes);
        for (i, finished) in instances.iter().zip(on.results) {
            self.outcome.results[*i as usize] = finished;
            self.periods[*i as usize] += CONFIRM_PERIODS;
        }
        Ok(())
    }
}

/// Measures the plan's instances from the states found of them.
pub(super) fn run_on(
    plan: Plan,
    found: &[Option<&PeriodicState>],
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Outcome, EngineError> {
    let start = |state: &Option<&PeriodicState>| match state {
        Some(state) => StartState { section: state.section, least_change: Some(state.floquet.sigma_min) },
        None => SectionState::FREE.into(),
    };
    let mut from = plan.starting_at(found.iter().map(start).collect());
    (from.run.periods, from.run.measure) = (CONFIRM_PERIODS, from.run.measure.min(CONFIRM_PERIODS - 1));
    progress.task("confirming", 0);
    progress.foresee(from.instance_steps());
    let mut outcome = engine.run(&from, progress)?;
    outcome.ends = Vec::new();
    Ok(outcome)
}

#[cfg(test)]
mod tests {
    use super::super::period_map::distance;
    use super::*;
    use crate::engine::Cpu;
    use crate::observe::Status;
    use crate::test_plans::plan_of;

    /// A weakly damped tip that dips by half a percent of its swing into a stiff sample: its force needs more digits than its
    /// travel. Truth: the state searched for a thousand times as closely.
    #[test]
    fn a_state_that_no_run_confirms_is_corrected_before_its_motion_begins_anew() {
        let text = r#"
            [instrument.cantilever]
            modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 2000 }]
            [instrument.tip]
            radius = "40 nm"
            [sample]
            youngs_modulus = "100 GPa"
            [contact]
            law = "hertz"
            [drive]
            on = "tip"
            frequency = "300 kHz"
            free_amplitude = "40 nm"
            [approach]
            gap = "20 nm"
            [run]
            steady = "search"
            accuracy = 1e-3
            [output]
            observables = ["amplitude"]
        "#;
        let plan = plan_of(text);
        let (engine, progress) = (Cpu::default(), Progress::default());
        let mut close = plan.clone();
        close.run.accuracy *= FORCE_TOL_SHARE;
        let truth = super::super::solve(&close, &[], &engine, &progress).expect("it runs");
        let truth = truth.state(0).expect("a search finds it").section;
        let mut settled = super::super::solve(&plan, &[], &engine, &progress).expect("it runs");
        let amplitude = plan.driven(0).free_amplitude();
        let off = |settled: &OrbitSolution| {
            distance(&settled.state(0).expect("a state").section, &truth) / amplitude
        };
        settled.found[0].as_mut().expect("a search finds it").section.x[0] += 1e-6 * amplitude;
        settled.outcome.results[0].status = Status::NotSteady;
        assert!(off(&settled) > 5e-7, "{:e}", off(&settled));
        settled.tighten_vague_forces(&plan, &[0], &engine, &progress).expect("it runs");
        assert!(off(&settled) < 1e-9, "{:e}", off(&settled));
        assert!(settled.drop_unconfirmed(&[0]).is_empty());
        settled.outcome.results[0].status = Status::NotSteady;
        assert_eq!(settled.drop_unconfirmed(&[0]), [0]);
        let anew = Unconverged::anew(&plan, 0);
        assert_eq!((anew.instance, anew.integrated), (0, 0));
        assert!(settled.state(0).is_none());
    }
}
