//! Python's solvers on a problem: it goes to them and their answers come back as JSON.

use crate::answer::Answer;
use crate::measure::{Point, translated};
use crate::problem::Problem;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::process::Command;

#[derive(Deserialize)]
struct Report {
    versions: BTreeMap<String, String>,
    points: Vec<Run>,
}

#[derive(Deserialize)]
struct Run {
    solver: String,
    setting: String,
    seconds: f64,
    steps: f64,
    instances: Vec<usize>,
    answers: Vec<Option<Answer>>,
}

/// All of `peers.py` by this interpreter; and the versions of its libraries.
pub fn measure(problem: &Problem, interpreter: &str) -> (Vec<Point>, BTreeMap<String, String>) {
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/precision/peers.py");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let file = |what: &str| folder.join(format!("precision_{}_{what}.json", problem.name));
    let (question, reply) = (file("problem"), file("answers"));
    let text = serde_json::to_string(&problem.reduced).expect("plain data");
    std::fs::write(&question, text).unwrap_or_else(|error| panic!("{}: {error}", question.display()));
    let status = Command::new(interpreter).args([&here, &question, &reply]).status();
    match status {
        Ok(status) if status.success() => {}
        Ok(status) => panic!("{interpreter} {}: {status}", here.display()),
        Err(error) => panic!("{interpreter}: {error}"),
    }
    let text = std::fs::read_to_string(&reply).unwrap_or_else(|error| panic!("{}: {error}", reply.display()));
    let report: Report = serde_json::from_str(&text).expect("what peers.py writes");
    let points = report.points.into_iter().map(|run| {
        let instances = run.instances.len();
        let results = translated(problem, run.instances, run.answers);
        Point {
            law: problem.name.to_owned(),
            solver: run.solver,
            setting: run.setting,
            steps: Some(run.steps),
            seconds: run.seconds,
            clock: "cpu",
            instances,
            failed: instances - results.len(),
            errors: problem.errors(results.into_iter()),
        }
    });
    (points.collect(), report.versions)
}
