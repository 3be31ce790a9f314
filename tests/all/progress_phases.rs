//! What a run says of itself on the way. Truth: a watcher beside it.

use afmsweep::control::{self, MemoryJournal};
use afmsweep::engine::{Cpu, Progress, ProgressPhase};
use afmsweep::plan::{Plan, Precision};
use afmsweep::scene::Scene;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// A scene that goes through all phases: searched, with second branches.
fn scene(steady: &str) -> Scene {
    let text = include_str!("../../scenes/bistable.toml");
    assert!(text.contains("steady = \"search\"") && text.contains("branches = \"both\""), "{text}");
    let text = text.replace("branches = \"both\"", "").replace("\"search\"", &format!("\"{steady}\""));
    Scene::parse(Path::new("bistable.toml"), &text).unwrap()
}

/// Every phase seen during a run, and the shares seen in it.
fn watched(steady: &str) -> Vec<(ProgressPhase, Vec<f64>)> {
    let plan = Plan::new(&scene(steady), Precision::F64).unwrap();
    let some: Vec<u32> = (0..plan.len() as u32).step_by(plan.len().div_ceil(40)).collect();
    let plan = plan.part(&some);
    let (engine, progress, over) = (Cpu::default(), Progress::default(), AtomicBool::new(false));
    let mut seen: Vec<(ProgressPhase, Vec<f64>)> = Vec::new();
    std::thread::scope(|scope| {
        let watcher = scope.spawn(|| {
            let mut seen: Vec<(ProgressPhase, Vec<f64>)> = Vec::new();
            while !over.load(Ordering::Relaxed) {
                let phase = progress.phase();
                if seen.last().is_none_or(|(last, _)| last.number != phase.number) {
                    seen.push((phase.clone(), Vec::new()));
                }
                if let (Some((_, shares)), Some(share)) = (seen.last_mut(), phase.share) {
                    shares.push(share);
                }
                std::thread::sleep(Duration::from_micros(20));
            }
            seen
        });
        let run = control::run(&plan, &engine, &progress).unwrap();
        control::second_orbits(&run, &[plan.len()], &MemoryJournal::default(), &engine, &progress).unwrap();
        control::audit(&run, 2, &MemoryJournal::default(), &progress).unwrap();
        over.store(true, Ordering::Relaxed);
        seen = watcher.join().unwrap();
    });
    seen
}

#[test]
fn every_phase_has_its_name_and_no_search_goes_back() {
    for steady in ["search", "wait"] {
        // On a busy machine the watcher can sleep through a short phase, so it may watch up to ten runs.
        let mut missing = vec!["estimate", "run", "branches", "audit"];
        for _ in 0..10 {
            let seen = watched(steady);
            for (phase, shares) in &seen {
                assert!(shares.iter().all(|share| (0.0..=1.0).contains(share)), "{phase:?} {shares:?}");
                if phase.name.ends_with("search") {
                    assert!(shares.is_sorted(), "{phase:?} {shares:?}");
                }
            }
            assert!(seen.windows(2).all(|pair| pair[0].0.number < pair[1].0.number), "{seen:?}");
            missing.retain(|stage| !seen.iter().any(|(phase, _)| phase.name.starts_with(stage)));
            if missing.is_empty() {
                break;
            }
        }
        assert!(missing.is_empty(), "{steady}: never seen in ten runs: {missing:?}");
    }
}
