//! Runs all instances of a plan, chunk by chunk.

use super::basis_choice::{self, BasisChoice};
use super::block_solver::{self, BlockSolver};
use super::choices::{Choices, Course};
use super::chunk::{Chunk, ChunkJournal};
use super::chunking::Chunking;
use super::first_estimate::{EstimateInputs, PoorerBasis};
use super::journaled_run::JournaledRun;
use super::{ChunkRun, branch_switching, by_reference, interruption, once};
use crate::engine::{Engine, EngineError, Progress, Reference};
use crate::observe::Status;
use crate::orbit::{self, OrbitSolution};
use crate::plan::{BasisRule, Interned, Plan};
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};

/// How the instances of a chunk get their results.
struct ChunkWork<'a> {
    choices: &'a Choices,
    /// Truncation error of each instance of the plan; see [`basis_choice::BasisChoice`].
    truncation: Vec<f64>,
    /// Poorer basis of each instance of the plan; see [`EstimateInputs`].
    poorer_basis: Option<Interned<BasisRule>>,
    /// Whether any instance of the plan needs steps.
    stepped: bool,
    engine: &'a dyn Engine,
    progress: &'a Progress,
}

impl ChunkWork<'_> {
    /// Runs a chunk, with its searches from rest if second states are requested.
    fn run(&self, number: usize, whole: &JournaledRun) -> Result<ChunkRun, EngineError> {
        let (engine, progress) = (self.engine, self.progress);
        let mut ran = self.first_states(number, whole)?;
        if ran.plan.run.both_branches && !progress.stopped() {
            let mut notes = Vec::new();
            let statuses: Vec<_> = ran.outcome.results.iter().map(|one| one.status).collect();
            ran.from_rest =
                branch_switching::from_rest((&ran.plan, &statuses), engine, progress, &mut notes)?;
            ran.outcome.notes.append(&mut notes);
        }
        Ok(ran)
    }

    /// Runs the chunk of this number to its first states.
    fn first_states(&self, number: usize, whole: &JournaledRun) -> Result<ChunkRun, EngineError> {
        let (engine, progress) = (self.engine, self.progress);
        let portion = whole.chunk(number);
        let part = whole.plan.part(portion).with_own_drives();
        match self.choices.course {
            Course::Reference => by_reference(&part, &Reference::default(), progress),
            Course::Once => once(part, &self.choices.precision.reason, engine, progress),
            Course::Controlled if !self.stepped => free(part, self.choices, engine, progress),
            Course::Controlled => {
                let stepped = part.stepped();
                let left_out = portion
                    .iter()
                    .map(|i| self.truncation.get(*i as usize).copied().unwrap_or(0.0))
                    .collect();
                let of = |all: &Interned<BasisRule>| {
                    portion.iter().map(|i| all.get(*i as usize)).collect::<Vec<BasisRule>>()
                };
                let poorer = self.poorer_basis.as_ref().map(|all| PoorerBasis::of(&part, of(all)));
                if let Some(blocks) = &whole.division().blocks {
                    let order = blocks.within(number, &part);
                    let block = BlockSolver {
                        plan: part,
                        poorer_basis: poorer,
                        truncation: left_out,
                        choices: self.choices,
                    };
                    return block_solver::run(block, &order, engine, progress);
                }
                let first = EstimateInputs::alone(poorer, left_out, &self.choices.precision);
                interruption::marked(part, &stepped, first, engine, progress)
            }
        }
    }
}

/// Instances that feel no sample move freely, except that set-points must still be met.
fn free(
    mut plan: Plan,
    choices: &Choices,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<ChunkRun, EngineError> {
    let outcome = match plan.has_setpoints() {
        true => orbit::solve_first(&mut plan, engine, progress)?.outcome,
        false => engine.run(&plan, progress)?,
    };
    let (zeros, arithmetic) = (vec![0.0; plan.len()], choices.precision.arithmetic(plan.len()));
    let settled = OrbitSolution::without_states(outcome);
    Ok(ChunkRun::new(plan, settled, (zeros.clone(), zeros), arithmetic))
}

/// Runs all instances of the scene's plan with the given choices, several chunks at once. A stopped run keeps its finished
/// chunks. Chunks that `keep` does not want stay not run.
pub(super) fn run<'k>(
    planned: Plan,
    choices: &Choices,
    keep: &'k dyn ChunkJournal,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<JournaledRun<'k>, EngineError> {
    let stepped = planned.stepped();
    let BasisChoice { mut plan, poorer, truncation } = match choices.course {
        Course::Controlled => basis_choice::choose_bases(&planned, &stepped, choices.bases.as_ref()),
        _ => BasisChoice { plan: planned.clone(), poorer: None, truncation: Vec::new() },
    };
    (plan.precision, plan.precision_open) = (choices.precision.precision, false);
    // Release the list: there may be very many instances.
    let some_stepped = !stepped.is_empty();
    drop(stepped);
    let division = Chunking::of(&planned, choices, keep.shares());
    drop(planned);
    let mut whole = JournaledRun::not_begun(plan, choices, division, keep);
    let work =
        ChunkWork { choices, truncation, poorer_basis: poorer, stepped: some_stepped, engine, progress };
    let wanted = take_known(&mut whole, keep);
    let all: u64 = wanted.iter().map(|number| whole.chunk(*number).len() as u64).sum();
    let held = (wanted.len() > 1).then(|| progress.hold(&["run in portions"], all));
    if held.is_none() {
        progress.stage(&["estimate", "run", "refinement"]);
    }
    let ended = AtomicBool::new(false);
    let one = |whole: &JournaledRun, number: usize| {
        let part = work.run(number, whole)?;
        let is_run = part.outcome.results.iter().all(|one| one.status != Status::NotRun);
        let mut portion = Chunk::of(&part, number, is_run && !progress.stopped());
        if let Some(held) = &held {
            held.done(portion.flags.len() as u64);
        }
        let bytes = std::mem::take(&mut portion.bytes);
        if portion.is_any() && keep.ended(number, portion.meta.whole, bytes).is_break() {
            ended.store(true, Ordering::Relaxed);
            progress.stop();
        }
        Ok::<_, EngineError>(portion)
    };
    for some in wanted.chunks(engine.portions().1.max(1)) {
        if progress.stopped() || ended.load(Ordering::Relaxed) {
            break;
        }
        let done: Vec<_> = match some {
            [number] => vec![one(&whole, *number)],
            _ => some.par_iter().map(|number| one(&whole, *number)).collect(),
        };
        for (number, portion) in some.iter().zip(done) {
            let portion = portion?;
            if portion.is_any() {
                whole.take(*number, &portion);
            }
        }
    }
    Ok(whole)
}

/// Takes the chunks that earlier runs finished and returns the numbers of the chunks still to run.
fn take_known(whole: &mut JournaledRun, keep: &dyn ChunkJournal) -> Vec<usize> {
    let mut wanted = Vec::new();
    for number in 0..whole.division().len() {
        let runs = keep.wanted(number);
        let (count, accuracy) = (whole.chunk(number).len(), whole.plan.run.accuracy);
        let known = keep.known(number, count);
        let known = known.and_then(|bytes| Chunk::of_bytes(bytes, (number, count), accuracy));
        // A chunk that was cut short or skipped runs anew with the same choices.
        let is_run = |known: &Chunk| known.flags.iter().all(|mark| mark.status() != Status::NotRun);
        let known = known.filter(|known| known.meta.whole && is_run(known) || !runs);
        if let Some(known) = &known {
            whole.take(number, known);
        }
        if runs && known.is_none() {
            wanted.push(number);
        }
    }
    wanted
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::chunking::whole_curves;
    use crate::control::{MemoryJournal, RunResult, choose};
    use crate::engine::{Cpu, Outcome, ReturnMap};
    use crate::test_plans::plan_of;

    /// The CPU engine with small chunks.
    struct Small(Cpu);

    impl Engine for Small {
        fn device(&self) -> String {
            "small".into()
        }

        fn portions(&self) -> (usize, usize) {
            (20, 3)
        }

        fn by_threads(&self) -> bool {
            true
        }

        fn return_map(&self, plan: &Plan, of: &[u32]) -> Result<Option<Box<dyn ReturnMap>>, EngineError> {
            self.0.return_map(plan, of)
        }

        fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
            self.0.run(plan, progress)
        }
    }

    /// Runs a plan in one piece and in chunks with the same choices.
    fn both(plan: &Plan) -> (RunResult, RunResult) {
        let (engine, progress) = (Cpu::default(), Progress::default());
        let chosen = choose(plan, Course::Controlled, &engine, &progress).expect("trials run");
        let chosen = chosen.expect("nobody stops it");
        let run = |portion, engine: &dyn Engine| {
            let choices = Choices { portion, ..chosen.clone() };
            let keep = MemoryJournal::default();
            let ran = super::run(plan.clone(), &choices, &keep, engine, &progress).expect("it runs");
            ran.gathered().expect("it lies in memory")
        };
        (run(usize::MAX, &engine), run(20, &Small(engine)))
    }

    /// A whole run equals its chunks to the bit, both integrated and searched for.
    #[test]
    fn portions_give_what_the_whole_gives() {
        let text = include_str!("../../../../scenes/quickstart.toml");
        for steady in ["wait", "search"] {
            let text = text.replace("[run]", &format!("[run]\nsteady = \"{steady}\""));
            let plan = plan_of(&text);
            let some: Vec<u32> = (0..plan.len() as u32).step_by(83).collect();
            let plan = plan.part(&some);
            let (whole, parts) = both(&plan);
            for i in 0..plan.len() {
                let (a, b) = (whole.results.get(i), parts.results.get(i));
                assert_eq!(format!("{a:?}"), format!("{b:?}"), "{steady}, instance {i}");
                assert_eq!(whole.estimates[i].to_bits(), parts.estimates[i].to_bits());
                assert_eq!(
                    (whole.periods[i], whole.plan.steps(i as u32)),
                    (parts.periods[i], parts.plan.steps(i as u32))
                );
                let place = |all: &RunResult| Some(all.found.get(i)?.section);
                assert_eq!(place(&whole), place(&parts));
            }
        }
    }

    /// There are more curves than a chunk holds. No curve is cut, and each is the same as in one piece.
    #[test]
    fn curves_stay_whole_in_portions() {
        let text = r#"
            [instrument.cantilever]
            modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 30 }]
            [contact]
            law = "hertz"
            [drive]
            on = "tip"
            frequency = "300 kHz"
            force = "20 nN"
            [sweep]
            "sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 150 }
            [curve]
            quantity = "approach.gap"
            values = ["14 nm", "12 nm"]
            direction = "both"
        "#;
        let plan = plan_of(text);
        assert_eq!((plan.len(), whole_curves(&plan, 20)), (600, 128));
        let (whole, parts) = both(&plan);
        let bits = |all: &RunResult| format!("{:?} {:?}", all.results, all.estimates);
        assert_eq!((bits(&whole), &whole.jumps), (bits(&parts), &parts.jumps));
        assert_eq!(parts.jumps.len(), 600);
    }

    /// The CPU engine, but it takes all instances at once and has no period map of its own, like a GPU.
    struct Plain;

    impl Engine for Plain {
        fn device(&self) -> String {
            "plain".into()
        }

        fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
            Cpu::default().run(plan, progress)
        }
    }

    /// A grid and a design whose instances start from neighbours. Results are the same in small chunks, in one piece, and on
    /// an engine that only runs plans.
    #[test]
    fn neighbours_lead_to_the_same_in_any_portions() {
        let grid = r#"
            [sweep]
            "sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 40 }
            "approach.gap" = { from = "12 nm", to = "14 nm", points = 25 }
        "#;
        let design = r#"
            [uncertain]
            "sample.youngs_modulus" = { distribution = "uniform", from = "0.5 GPa", to = "5 GPa" }
            "approach.gap" = { distribution = "uniform", from = "12 nm", to = "14 nm" }
            [design]
            kind = "monte-carlo"
            samples = 1000
        "#;
        [grid, design].into_iter().for_each(same_in_any_portions);
    }

    fn same_in_any_portions(swept: &str) {
        let text = r#"
            [instrument.cantilever]
            modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 30 }]
            [contact]
            law = "hertz"
            [drive]
            on = "tip"
            frequency = "300 kHz"
            force = "20 nN"
            [run]
            steady = "search"
        "#;
        let plan = plan_of(&format!("{text}{swept}"));
        let run =
            |engine: &dyn Engine| crate::control::run(&plan, engine, &Progress::default()).expect("it runs");
        let [whole, small, plain] = [run(&Cpu::default()), run(&Small(Cpu::default())), run(&Plain)];
        assert!(whole.neighbour_started() > 0.9, "{}", whole.neighbour_started());
        let bits =
            |all: &RunResult| format!("{:?} {:?} {:?}", all.results, all.estimates, all.neighbour_started);
        assert_eq!(bits(&whole), bits(&small));
        assert_eq!(bits(&whole), bits(&plain));
    }
}
