//! Running a built-in scene: each instance once as planned, in f64.

use super::StudyError;
use crate::control::Arithmetic;
use crate::engine::{Cpu, Engine, Finished, Outcome, Progress};
use crate::orbit::OrbitTable;
use crate::plan::{Plan, Precision};
use crate::record::{self, Facts};
use crate::scene::{Scene, SceneError};
use crate::store::{Results, Writer};
use std::path::Path;
use std::time::Instant;

/// A scene that was run.
pub(super) struct SceneRun {
    pub scene: Scene,
    pub plan: Plan,
    pub outcome: Outcome,
    wall_time: f64,
}

/// A built-in scene with changes. What it says in text is then every value it uses, changes included.
pub(super) fn scene(name: &str, text: &str, change: impl FnOnce(&mut Scene)) -> Result<Scene, SceneError> {
    let mut scene = Scene::parse(Path::new(name), text)?;
    change(&mut scene);
    scene.source = scene.resolved_toml();
    Ok(scene)
}

/// Plans and steps a scene in f64 on all cores.
pub(super) fn run(scene: Scene) -> Result<SceneRun, StudyError> {
    let start = Instant::now();
    let plan = Plan::new(&scene, Precision::F64)?;
    let outcome = Cpu::default().run(&plan, &Progress::default())?;
    Ok(SceneRun { scene, plan, outcome, wall_time: start.elapsed().as_secs_f64() })
}

impl SceneRun {
    /// The first instance.
    pub fn first(&self) -> &Finished {
        &self.outcome.results[0]
    }

    /// Writes the results file, waveforms included where the scene asks for them.
    pub fn save(&self, path: &Path) -> Result<(), StudyError> {
        let mut writer = Writer::create(path, &self.scene.source, true)?;
        writer.write(&self.results()?)?;
        Ok(writer.finish()?)
    }

    fn results(&self) -> Result<Results, StudyError> {
        let facts = Facts {
            device: Cpu::default().device(),
            wall_time: self.wall_time,
            steps_taken: self.plan.instance_steps(),
            neighbour_started: 0.0,
            rate: self.plan.instance_steps() as f64 / self.wall_time,
            plan: self.plan.summary(None).json().to_string(),
            command_line: "afmsweep study paper".into(),
            arithmetic: Arithmetic::of(&self.plan, "nothing is estimated"),
        };
        let mut results = record::results(&self.scene, &self.plan, &self.outcome.results[..].into(), &facts)?;
        if let Some(request) = &self.scene.output.waveforms {
            results.waveforms = Some(record::waveforms(&self.plan, &OrbitTable::default(), request)?);
        }
        if let Some(instances) = &self.scene.output.spectra {
            results.spectra = Some(record::spectra(&self.plan, &OrbitTable::default(), instances)?);
        }
        Ok(results)
    }
}
