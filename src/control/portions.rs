//! Many instances, portion by portion.

use super::around::{Around, Solved};
use super::first::First;
use super::levels::Level;
use super::{Arithmetic, Controlled, unfinished};
use crate::engine::{Engine, EngineError, Finished, Outcome, Progress};
use crate::plan::Plan;
use crate::steady::PeriodicState;
use rayon::prelude::*;
use std::collections::HashMap;

/// Instances that may be taken to their ends in any order, once those of the batches before them are.
pub(super) struct Batch<'a> {
    pub instances: Vec<u32>,
    /// Where they stand among those before.
    pub level: Option<&'a Level<'a>>,
    /// Whether later ones begin at their states.
    pub leads_on: bool,
}

/// [`refine::run`](super::refine::run) for batch after batch, each in portions of the engine's size, some of them at once.
/// Whoever stops a run keeps the portions that are done.
pub(super) fn run(
    plan: Plan,
    batches: &[Batch],
    first: First,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Controlled, EngineError> {
    let (size, at_once) = engine.portions();
    let size = whole_curves(&plan, size);
    let mut whole = begun(plan, &first);
    if batches.iter().any(|batch| batch.level.is_some()) {
        whole.solved = vec![Solved::Unknown; whole.plan.len()];
        whole.neighbour_started = vec![false; whole.plan.len()];
    }
    let count = batches.iter().map(|batch| batch.instances.len()).sum::<usize>();
    let held = progress.hold(&["run in portions"], count as u64);
    for batch in batches {
        let portions: Vec<&[u32]> = batch.instances.chunks(size).collect();
        for some in portions.chunks(at_once) {
            if progress.stopped() {
                return Ok(whole);
            }
            let one = |portion: &[u32]| {
                let ran = portion_of(&whole, batch, portion, &first, (engine, progress));
                held.done(portion.len() as u64);
                ran
            };
            let done: Vec<_> = match some {
                [portion] => vec![one(portion)],
                _ => some.par_iter().map(|portion| one(portion)).collect(),
            };
            for (portion, part) in some.iter().zip(done) {
                whole.take(portion, part?);
            }
        }
    }
    Ok(whole)
}

/// Before any portion.
fn begun(plan: Plan, First { left_out, chosen, .. }: &First) -> Controlled {
    let count = plan.len();
    Controlled {
        outcome: Outcome { results: vec![Finished::NOT_RUN; count], ends: Vec::new(), notes: Vec::new() },
        estimates: vec![f64::NAN; count],
        left_out: left_out.clone(),
        found: Vec::new(),
        periods: vec![0; count],
        jumps: Vec::new(),
        neighbour_started: Vec::new(),
        arithmetic: chosen.arithmetic(count),
        solved: Vec::new(),
        plan,
    }
}

/// Takes a portion of a batch to its end.
fn portion_of(
    whole: &Controlled,
    batch: &Batch,
    portion: &[u32],
    First { poorer, left_out, chosen, .. }: &First,
    (engine, progress): (&dyn Engine, &Progress),
) -> Result<Controlled, EngineError> {
    let part = whole.plan.part(portion);
    let stepped = part.stepped();
    let left_out = portion.iter().map(|i| left_out[*i as usize]).collect();
    let poorer = poorer.as_ref().map(|all| portion.iter().map(|i| all[*i as usize]).collect());
    let around = batch.level.map(|level| Around::new(level, portion, &whole.solved));
    let first = First { around, leads_on: batch.leads_on, ..First::alone(poorer, left_out, chosen) };
    unfinished::marked(part, &stepped, first, engine, progress)
}

/// Curves that are followed side by side, at least: enough to fill an engine's lanes.
const CURVES: usize = 128;

/// The size of a portion, so that no curve is in two.
fn whole_curves(plan: &Plan, size: usize) -> usize {
    match plan.ensemble.curves {
        Some(curves) => {
            let long = (curves.points * curves.ways) as usize;
            long * (size / long).max(CURVES)
        }
        None => size,
    }
}

impl Controlled {
    /// Takes in what became of a portion.
    fn take(&mut self, portion: &[u32], part: Self) {
        let Arithmetic { of, .. } = part.arithmetic;
        if !part.found.is_empty() && self.found.is_empty() {
            self.found = vec![None; self.plan.len()];
        }
        for (place, found) in portion.iter().zip(part.found) {
            // Nobody goes on from it with other steps.
            let kept =
                |state: Box<PeriodicState>| Box::new(PeriodicState { slope: Box::default(), ..*state });
            self.found[*place as usize] = found.map(kept);
        }
        if !part.jumps.is_empty() && self.jumps.is_empty() {
            self.jumps = vec![false; self.plan.len()];
        }
        portion.iter().zip(part.jumps).for_each(|(place, jump)| self.jumps[*place as usize] = jump);
        let begun = portion.iter().zip(part.neighbour_started);
        begun.for_each(|(place, begun)| self.neighbour_started[*place as usize] = begun);
        portion.iter().zip(part.solved).for_each(|(place, solved)| self.solved[*place as usize] = solved);
        let mut taken = HashMap::new();
        for (n, place) in portion.iter().enumerate() {
            let i = *place as usize;
            self.plan.take_resolution(*place, &part.plan, n as u32, &mut taken);
            self.left_out[i] = part.left_out[n];
            self.outcome.results[i] = part.outcome.results[n];
            self.estimates[i] = part.estimates[n];
            self.periods[i] = part.periods[n];
            self.arithmetic.of[i] = of[n];
        }
        self.outcome.notes.extend(part.outcome.notes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::{precision, refine};
    use crate::engine::{Cpu, ReturnMap};
    use crate::plan::Precision;
    use crate::scene::Scene;
    use std::path::Path;

    /// The CPU engine with small portions.
    struct Small(Cpu);

    impl Engine for Small {
        fn device(&self) -> String {
            "small".into()
        }

        fn portions(&self) -> (usize, usize) {
            (20, 3)
        }

        fn return_map(&self, plan: &Plan, of: &[u32]) -> Result<Option<Box<dyn ReturnMap>>, EngineError> {
            self.0.return_map(plan, of)
        }

        fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
            self.0.run(plan, progress)
        }
    }

    fn in_order(all: &[u32]) -> [Batch<'static>; 1] {
        [Batch { instances: all.to_vec(), level: None, leads_on: false }]
    }

    /// The whole is what portions of it are, to the bit: waited for and searched for.
    #[test]
    fn portions_give_what_the_whole_gives() {
        let text = include_str!("../../scenes/quickstart.toml");
        for steady in ["wait", "search"] {
            let text = text.replace("[run]", &format!("[run]\nsteady = \"{steady}\""));
            let scene = Scene::parse(Path::new("quickstart.toml"), &text).expect("the scene is whole");
            let plan = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
            let some: Vec<u32> = (0..plan.len() as u32).step_by(83).collect();
            let plan = plan.part(&some);
            let all: Vec<u32> = (0..plan.len() as u32).collect();
            let (engine, progress) = (Cpu::default(), Progress::default());
            let chosen = precision::choose(&plan, &all, &engine, &progress).expect("nothing is open");
            let none = vec![0.0; all.len()];
            let first = || First::alone(None, none.clone(), &chosen);
            let whole = refine::run(plan.clone(), &all, first(), &engine, &progress).expect("it runs");
            let parts =
                super::run(plan, &in_order(&all), first(), &Small(engine), &progress).expect("it runs");
            for &i in &all {
                let i = i as usize;
                let (a, b) = (&whole.outcome.results[i], &parts.outcome.results[i]);
                assert_eq!(format!("{a:?}"), format!("{b:?}"), "{steady}, instance {i}");
                assert_eq!(whole.estimates[i].to_bits(), parts.estimates[i].to_bits());
                assert_eq!(
                    (whole.periods[i], whole.plan.steps(i as u32)),
                    (parts.periods[i], parts.plan.steps(i as u32))
                );
                let place = |all: &Controlled| Some(all.found.get(i)?.as_ref()?.station);
                assert_eq!(place(&whole), place(&parts));
            }
        }
    }

    /// More curves than a portion has: none is cut, and each is what it is in one piece.
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
        let scene = Scene::parse(Path::new("curves.toml"), text).expect("the scene is whole");
        let plan = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
        assert_eq!((plan.len(), whole_curves(&plan, 20)), (600, 512));
        let all: Vec<u32> = plan.instances().collect();
        let (engine, progress) = (Cpu::default(), Progress::default());
        let chosen = precision::choose(&plan, &all, &engine, &progress).expect("nothing is open");
        let first = || First::alone(None, vec![0.0; all.len()], &chosen);
        let whole = refine::run(plan.clone(), &all, first(), &engine, &progress).expect("it runs");
        let parts = super::run(plan, &in_order(&all), first(), &Small(engine), &progress).expect("it runs");
        let bits = |all: &Controlled| format!("{:?} {:?}", all.outcome.results, all.estimates);
        assert_eq!((bits(&whole), &whole.jumps), (bits(&parts), &parts.jumps));
        assert_eq!(parts.jumps.len(), 600);
    }

    /// The CPU engine as one that takes all instances at once and has no map of its own, as a GPU has none.
    struct Plain;

    impl Engine for Plain {
        fn device(&self) -> String {
            "plain".into()
        }

        fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
            Cpu::default().run(plan, progress)
        }
    }

    /// A grid whose instances begin at their neighbours': the same in small portions, in one piece, and on an engine that
    /// only runs plans.
    #[test]
    fn neighbours_lead_to_the_same_in_any_portions() {
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
            "sample.youngs_modulus" = { from = "0.5 GPa", to = "5 GPa", points = 40 }
            "approach.gap" = { from = "12 nm", to = "14 nm", points = 25 }
            [run]
            steady = "search"
        "#;
        let scene = Scene::parse(Path::new("grid.toml"), text).expect("the scene is whole");
        let plan = Plan::new(&scene, Precision::F64).expect("the scene can be planned");
        let run =
            |engine: &dyn Engine| crate::control::run(&plan, engine, &Progress::default()).expect("it runs");
        let [whole, small, plain] = [run(&Cpu::default()), run(&Small(Cpu::default())), run(&Plain)];
        assert!(whole.neighbour_started() > 0.9, "{}", whole.neighbour_started());
        let bits = |all: &Controlled| {
            format!("{:?} {:?} {:?}", all.outcome.results, all.estimates, all.neighbour_started)
        };
        assert_eq!(bits(&whole), bits(&small));
        assert_eq!(bits(&whole), bits(&plain));
    }
}
