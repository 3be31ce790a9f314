//! Refinement: each instance runs again as long as its estimate demands it.

use super::decision::{InstanceSummary, Next, next};
use super::difference_scale::{is_fast, scaled_difference};
use super::error_parts::ErrorParts;
use super::first_estimate::{self, EstimateInputs, FirstEstimate};
use super::missed_compliance::FoundMotion;
use super::{ChunkRun, fixed_steps, precision_trial, sensitivity};
use crate::engine::{Engine, EngineError, Finished, Progress};
use crate::observe::Status;
use crate::orbit::{self, OrbitSolution, SETTLED_SHARE};
use crate::plan::{Plan, Precision};
use rayon::prelude::*;
use std::collections::{HashMap, HashSet};

/// Runs the plan with a quarter and with half of its steps, then repeats those of `stepped` whose estimates are too large. If
/// the precision is mixed, instances that miss the accuracy in f32 continue in f64, because more steps do not reduce
/// rounding.
pub(super) fn run(
    plan: Plan,
    stepped: &[u32],
    first: EstimateInputs,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<ChunkRun, EngineError> {
    if plan.run.steps_per_period.is_some() {
        return fixed_steps::run(plan, stepped, first, engine, progress);
    }
    let chosen = first.chosen;
    let begun = first_estimate::run(&plan, stepped, first, engine, progress)?;
    let mut refining = RefinementRun::new(begun, chosen, engine, progress);
    let mut doubted = Vec::new();
    for round in 0..plan.policy.doublings + plan.policy.richer_bases {
        let open = refining.open(stepped);
        if round == 0 {
            doubted = open.iter().map(|(i, _)| *i).collect();
        }
        if open.is_empty() || progress.stopped() {
            break;
        }
        refining.carry_out(&open, round == 0)?;
    }
    refining.end(stepped, doubted)
}

/// A run under refinement.
struct RefinementRun<'a> {
    now: ChunkRun,
    /// Estimate of each instance.
    known: Vec<ErrorParts>,
    /// Whether instances that f32 does not serve continue in f64, and the rounding error of those that stay in f32.
    mixed: bool,
    rounding: f64,
    engine: &'a dyn Engine,
    progress: &'a Progress,
}

/// The open instances with this need.
fn with(open: &[(u32, Next)], need: Next) -> impl Iterator<Item = u32> {
    open.iter().filter(move |(_, what)| *what == need).map(|(i, _)| *i)
}

impl<'a> RefinementRun<'a> {
    fn new(
        FirstEstimate { plan, settled, known, neighbour_started, solved }: FirstEstimate,
        chosen: &precision_trial::PrecisionChoice,
        engine: &'a dyn Engine,
        progress: &'a Progress,
    ) -> Self {
        let estimates = known.iter().map(ErrorParts::error).collect();
        let left_out = known.iter().map(|known| known.of_modes).collect();
        let arithmetic = chosen.arithmetic(plan.len());
        let now = ChunkRun::new(plan, settled, (estimates, left_out), arithmetic);
        let now = ChunkRun { neighbour_started, solved, ..now };
        Self { now, known, mixed: chosen.mixed, rounding: chosen.rounding, engine, progress }
    }

    /// Those of these instances that need another run, and what they need.
    fn open(&self, stepped: &[u32]) -> Vec<(u32, Next)> {
        let mut open: Vec<(u32, Next)> = stepped.iter().map(|i| (*i, self.next(*i, true))).collect();
        let (_, richest) = self.now.plan.can_be_richer(with(&open, Next::RicherBasis).collect());
        let richest: HashSet<u32> = richest.into_iter().collect();
        for (i, what) in open.iter_mut().filter(|(i, _)| richest.contains(i)) {
            *what = self.next(*i, false);
        }
        open.retain(|(_, what)| *what != Next::Accept);
        open
    }

    fn next(&self, i: u32, can_be_richer: bool) -> Next {
        let n = i as usize;
        let known = InstanceSummary {
            status: self.now.outcome.results[n].status,
            estimate: self.now.estimates[n],
            accuracy: self.now.plan.run.accuracy,
            steps: self.now.plan.steps(i),
            single: self.mixed && self.is_single(i),
            can_be_richer,
            parts: &self.known[n],
        };
        next(&known, &self.now.plan.policy)
    }

    fn is_single(&self, i: u32) -> bool {
        self.now.arithmetic.of[i as usize] == Precision::F32
    }

    /// Runs the open instances. In a mixed run, more steps stay in f32 in the first round only.
    fn carry_out(&mut self, open: &[(u32, Next)], first_round: bool) -> Result<(), EngineError> {
        let kinds = [
            (Next::InF64, false),
            (Next::MoreSteps, first_round || !self.mixed),
            (Next::RicherBasis, true),
            (Next::WaitingModes, true),
        ];
        for (what, stays) in kinds {
            let (single, double): (Vec<u32>, Vec<u32>) =
                with(open, what).partition(|i| stays && self.is_single(*i));
            self.again(&single, what, Precision::F32)?;
            self.again(&double, what, Precision::F64)?;
        }
        Ok(())
    }

    /// Runs these instances again and takes their results.
    fn again(&mut self, instances: &[u32], what: Next, precision: Precision) -> Result<(), EngineError> {
        if instances.is_empty() || self.progress.stopped() {
            return Ok(());
        }
        let part = self.now.plan.part(instances).in_precision(precision);
        let mut other = match what {
            Next::MoreSteps => part.with_steps(|steps| 2 * steps),
            Next::RicherBasis => part.with_richer_bases(),
            Next::WaitingModes => part.with_waiting_modes(),
            Next::InF64 | Next::Accept => part,
        };
        let near = orbit::gather(&self.now.found, instances);
        let settled = orbit::solve_again(&mut other, &near, self.engine, self.progress)?;
        // A run that was cut short is dropped: the earlier results stay.
        if !self.progress.stopped() {
            self.take(instances, what, &other, settled);
        }
        Ok(())
    }

    /// Takes another run of these instances. Its difference to the last run gives the estimate; then it replaces the last
    /// run.
    fn take(&mut self, instances: &[u32], what: Next, other: &Plan, mut settled: OrbitSolution) {
        let mut taken = HashMap::new();
        let results = &self.now.outcome.results;
        let moved =
            |(i, new): (&u32, &Finished)| scaled_difference(&self.now.plan, *i, &results[*i as usize], new);
        let apart: Vec<f64> = instances.par_iter().zip(&settled.outcome.results).map(moved).collect();
        for ((there, &i), apart) in other.instances().zip(instances).zip(apart) {
            let (n, place) = (i as usize, there as usize);
            let before = self.now.estimates[n];
            self.estimate((other, there), i, what, apart, &settled);
            let (change, fast) = ((before, self.now.estimates[n]), is_fast(other, there));
            self.known[n].tell_stall(change, fast, other.policy.least_gain);
            let now = &mut self.now;
            now.outcome.results[n] = settled.outcome.results[place];
            now.plan.take_resolution(i, other, there, &mut taken);
            now.periods[n] = settled.periods[place];
            now.arithmetic.of[n] = other.precision;
            if let (Some(known), Some(new)) = (now.found.get_mut(n), settled.found.get_mut(place)) {
                *known = new.take();
            }
        }
        self.now.outcome.notes.extend(settled.outcome.notes);
    }

    /// Updates the estimate of instance `i`. Its other run, number `there` of that plan, differs by `apart`.
    fn estimate(&mut self, at: (&Plan, u32), i: u32, what: Next, apart: f64, run: &OrbitSolution) {
        let n = i as usize;
        let known = &mut self.known[n];
        let found = FoundMotion::of_run(run, at.1);
        match what {
            Next::MoreSteps => known.after_more_steps(at, apart, found),
            Next::RicherBasis => known.after_richer_basis(at, apart, found),
            Next::WaitingModes => known.after_waiting_modes(at, apart, found),
            Next::InF64 => {
                // The same steps in another precision say nothing about the step error: the next round estimates it.
                if run.outcome.results[at.1 as usize].status == Status::Ok {
                    known.unsplit = None;
                    self.now.estimates[n] = f64::INFINITY;
                }
                return;
            }
            Next::Accept => return,
        }
        (self.now.truncation[n], self.now.estimates[n]) = (known.of_modes, known.error());
    }

    /// Ends the run. Instances that were in doubt after the first two runs are tested with a slightly shifted start.
    fn end(self, stepped: &[u32], mut doubted: Vec<u32>) -> Result<ChunkRun, EngineError> {
        let Self { mut now, mixed, rounding, engine, progress, .. } = self;
        for &i in stepped {
            now.add_unsettled(i);
            let n = i as usize;
            if mixed && now.arithmetic.of[n] == Precision::F32 {
                now.estimates[n] += rounding;
            }
        }
        doubted.retain(|i| now.found.get(*i as usize).is_none_or(Option::is_none));
        for precision in [Precision::F32, Precision::F64] {
            let of = |i: &u32| now.arithmetic.of[*i as usize] == precision;
            let alike: Vec<u32> = doubted.iter().copied().filter(of).collect();
            let plan = now.plan.clone().in_precision(precision);
            sensitivity::mark(&plan, &alike, &mut now.outcome.results, engine, progress)?;
        }
        Ok(now)
    }
}

impl ChunkRun {
    /// Adds the change that further integration may bring to an instance that left before it settled completely.
    pub(super) fn add_unsettled(&mut self, i: u32) {
        let n = i as usize;
        let found = self.found.get(n).and_then(Option::as_ref).is_some_and(|state| state.is_solved());
        if !found && self.periods[n] < self.plan.run.periods {
            self.estimates[n] += SETTLED_SHARE * self.plan.run.accuracy;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::first_estimate::PoorerBasis;
    use crate::engine::Cpu;
    use crate::plan::BasisRule;
    use crate::scene::Scene;
    use std::path::Path;

    /// The sample accepts these bases, but they lack what a stiff sample excites: one mode, then two oscillators. Truth: a
    /// far richer basis with far more steps.
    #[test]
    fn a_lever_that_is_too_poor_for_one_instance_is_seen_by_its_own_difference() {
        let text = include_str!("../../../../tests/hard/sample_1_tpa.toml");
        let scene = Scene::parse(Path::new("sample_1_tpa.toml"), text).expect("the scene is whole");
        let whole = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
        let (engine, progress) = (Cpu::default(), Progress::default());
        let chosen = precision_trial::choose(&whole, &[0], &engine, &progress).expect("nothing is open");
        let rich = whole.clone().with_shares(1e-2 * scene.run.accuracy).with_steps(|steps| 4 * steps);
        let truth = orbit::solve(&rich, &[], &engine, &progress).expect("it runs").outcome.results[0];
        let with = |accuracy| whole.with_bases(&[(0, BasisRule::shares(accuracy))]);
        let run = |poorer| {
            let first = EstimateInputs::alone(poorer, vec![0.0], &chosen);
            run(with(0.1), &[0], first, &engine, &progress).expect("it runs")
        };
        let error = |of: &ChunkRun| scaled_difference(&whole, 0, &of.outcome.results[0], &truth);
        let modes = |of: &ChunkRun| of.plan.driven(0).kept.modes.len();
        let poorer = PoorerBasis::of(&with(0.1), vec![BasisRule::shares(0.3)]);
        let (alike, apart) = (run(None), run(Some(poorer)));
        let asked = scene.run.accuracy;
        // Steps alone do not show the error; what the basis misses of the compliance does.
        assert!(error(&alike) < asked && alike.estimates[0] < asked, "{:e}", error(&alike));
        assert!(error(&apart) < asked && apart.estimates[0] < asked, "{:e}", error(&apart));
        assert!(error(&apart) < 3.0 * apart.estimates[0], "{:e} {:e}", error(&apart), apart.estimates[0]);
        let few = with(0.1).driven(0).kept.modes.len();
        assert!(modes(&apart).min(modes(&alike)) > few, "{} {}", modes(&apart), modes(&alike));
    }

    /// The tip dips for a fiftieth of the period, much shorter than a collision would last. Neither a sample of other contacts
    /// nor more steps show that its basis is too small. Truth: a far richer basis with far more steps.
    #[test]
    fn a_graze_gets_the_modes_that_its_short_contact_moves() {
        let text = r#"
            [instrument.cantilever]
            stiffness = "45.7 N/m"
            frequency = "191 kHz"
            quality_factor = 519
            [instrument.actuator]
            model = "rigid"
            [instrument.tip]
            radius = "2.26 nm"
            mass = "3.55e-12 kg"
            [sample]
            youngs_modulus = "290 GPa"
            [contact]
            law = "hertz"
            [drive]
            on = "actuator"
            frequency = "164 kHz"
            free_amplitude = "2.46 nm"
            [approach]
            gap = "2.45 nm"
            [run]
            steady = "search"
            accuracy = 1e-3
            [output]
            observables = ["amplitude", "phase", "force_max", "contact_time"]
        "#;
        let scene = Scene::parse(Path::new("graze.toml"), text).expect("the scene is whole");
        let whole = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
        let (engine, progress) = (Cpu::default(), Progress::default());
        let chosen = precision_trial::choose(&whole, &[0], &engine, &progress).expect("nothing is open");
        let rich = whole.clone().with_shares(1e-2 * scene.run.accuracy).with_steps(|steps| 16 * steps);
        let truth = orbit::solve(&rich, &[], &engine, &progress).expect("it runs").outcome.results[0];
        let few = whole.with_bases(&[(0, BasisRule::shares(0.01))]);
        let first = EstimateInputs::alone(None, vec![0.0], &chosen);
        let run = run(few.clone(), &[0], first, &engine, &progress).expect("it runs");
        let error = scaled_difference(&whole, 0, &run.outcome.results[0], &truth);
        let modes = |plan: &Plan| plan.driven(0).kept.modes.len();
        assert!(modes(&run.plan) > modes(&few), "{} {}", modes(&run.plan), modes(&few));
        assert!(
            error < 3.0 * run.estimates[0] && run.estimates[0] < 1e-3,
            "{error:e} {:e}",
            run.estimates[0]
        );
    }
}
