//! A long run that is watched and stopped: what is complete is kept, and says what it lacks.
//!
//! `cargo run --release --example cancel`

use afmsweep::engine::ProgressPhase;
use afmsweep::{Backend, Error, Observer, Scene, Status, Sweep};
use std::ops::ControlFlow;
use std::path::Path;
use std::time::{Duration, Instant};

/// Prints how far the run is, and ends it after a third of a second.
struct Patience(Instant);

impl Observer for Patience {
    fn progress(&self, phase: &ProgressPhase) -> ControlFlow<()> {
        println!("{}: {:.0} %", phase.name, 100.0 * phase.share.unwrap_or(0.0));
        match self.0.elapsed() > Duration::from_millis(300) {
            true => ControlFlow::Break(()),
            false => ControlFlow::Continue(()),
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let text = include_str!("../scenes/quickstart.toml");
    let mut scene = Scene::parse(Path::new("quickstart.toml"), text)?;
    scene.run.periods *= 20;
    let sweep = Sweep::new(scene).backend(Backend::Cpu).estimate(false);
    match sweep.run_with(&Patience(Instant::now())) {
        Err(Error::Stopped(phase)) => println!("nothing was done: stopped in the {}", phase.word()),
        Err(error) => return Err(error.into()),
        Ok(swept) => {
            let results = &swept.run.results;
            let done = results.iter().filter(|one| one.status != Status::NotRun).count();
            let missing: Vec<&str> = swept.missing.iter().map(|phase| phase.word()).collect();
            println!("{done} of {} instances are done; missing: {missing:?}", results.len());
        }
    }
    Ok(())
}
