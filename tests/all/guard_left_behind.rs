//! An engine that leaves an instance behind, and whether the run says so. Truth: the engine that leaves none.

use afmsweep::control::{self, ChunkJournal, Course, ErrorSummary, JournaledRun, MemoryJournal};
use afmsweep::engine::{Cpu, Engine, EngineError, Finished, Outcome, Progress};
use afmsweep::observe::Status;
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use std::ops::{ControlFlow, Range};
use std::path::Path;
use std::sync::Mutex;

const SCENE: &str = r#"
[instrument.cantilever]
modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 30 }]
[contact]
law = "hertz"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[sweep]
"approach.gap" = { from = "12 nm", to = "18 nm", points = 20 }
[output]
observables = ["amplitude"]
"#;

/// The CPU engine, which forgets the instance at this place of the scene.
struct Forgets(u32);

impl Engine for Forgets {
    fn device(&self) -> String {
        "forgets".into()
    }

    fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
        let mut done = Cpu::default().run(plan, progress)?;
        for i in plan.instances().filter(|i| plan.id(*i).0 == self.0) {
            done.results[i as usize] = Finished::NOT_RUN;
        }
        Ok(done)
    }
}

/// Portions as a journal keeps them.
#[derive(Default)]
struct Journal {
    memory: MemoryJournal,
    /// Of each that has ended its number, whether it was whole, and its bytes.
    ended: Mutex<Vec<(usize, bool, Vec<u8>)>>,
    /// What an earlier run has ended, taken to be whole.
    known: Vec<(usize, Vec<u8>)>,
}

impl ChunkJournal for Journal {
    fn known(&self, number: usize, _instances: usize) -> Option<Vec<u8>> {
        self.known.iter().find(|(known, _)| *known == number).map(|(_, bytes)| bytes.clone())
    }

    fn ended(&self, number: usize, whole: bool, bytes: Vec<u8>) -> ControlFlow<()> {
        self.ended.lock().expect("nobody panicked").push((number, whole, bytes.clone()));
        self.memory.ended(number, whole, bytes)
    }

    fn bytes(&self, number: usize, range: Range<usize>) -> Result<Vec<u8>, String> {
        self.memory.bytes(number, range)
    }
}

#[test]
fn an_instance_left_behind_is_told_and_run_again() {
    let scene = Scene::parse(Path::new("left.toml"), SCENE).expect("the scene is whole");
    let plan = Plan::new(&scene, Precision::F64).expect("it can be planned");
    let progress = Progress::default();
    let choices = control::choose(&plan, Course::Controlled, &Cpu::default(), &progress)
        .expect("trials run")
        .expect("nobody stops it");
    let first = Journal::default();
    let run = |keep, engine: &dyn Engine| -> JournaledRun {
        control::run_chunks(plan.clone(), &choices, keep, engine, &progress).expect("it runs")
    };
    let lost = run(&first, &Forgets(7));
    assert_eq!((lost.count(Status::NotRun), lost.status(7)), (1, Status::NotRun));
    assert!(!lost.is_run(|_| true));
    let verdict = ErrorSummary::of(&lost, &[], false).expect("it lies in memory");
    assert!(
        !verdict.met() && verdict.words().contains("1 of 20 instances were not run"),
        "{}",
        verdict.words()
    );
    let ended = first.ended.lock().expect("nobody panicked").clone();
    assert!(ended.len() == 1 && !ended[0].1, "a portion that lacks an instance is not whole");
    let second = Journal { known: vec![(ended[0].0, ended[0].2.clone())], ..Journal::default() };
    let whole = run(&second, &Cpu::default());
    assert!(whole.is_run(|_| true) && whole.status(7) == Status::Ok);
    assert!(second.ended.lock().expect("nobody panicked")[0].1);
    assert!(ErrorSummary::of(&whole, &[], false).expect("it lies in memory").met());
}
