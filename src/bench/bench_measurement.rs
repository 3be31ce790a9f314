//! The measurements: whole runs by the clock, and a few instances against the reference.

use super::BenchError;
use crate::compare::{Scales, choose, worst};
use crate::engine::{Engine, Finished, Progress, Reference};
use crate::observe::Status;
use crate::plan::{Plan, Precision};
use crate::scene::Scene;
use std::time::Instant;

/// An engine and the precision to run it in.
pub struct Machine {
    /// `cpu` or `gpu`.
    pub backend: &'static str,
    pub precision: Precision,
    pub engine: Box<dyn Engine>,
}

/// What to measure.
#[derive(Clone, Debug)]
pub struct BenchOptions {
    /// Sizes of the ensemble: the scene's sweep with about so many points.
    pub sizes: Vec<usize>,
    /// Seconds that a measured run should take; it is shortened to fewer periods or has all of them.
    pub seconds: f64,
    /// Runs, of which the fastest counts.
    pub repeats: u32,
    /// Instances held against the reference.
    pub compared: usize,
}

/// One timed run.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Point {
    pub instances: usize,
    pub periods: u32,
    /// s, of the engine's whole run: packing, transfers and observables included.
    pub seconds: f64,
    /// Instance-steps per second.
    #[serde(rename = "instance_steps_per_second")]
    pub rate: f64,
}

/// Errors against the reference: of each instance the worst of the scene's observables, on its scale.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct ErrorSample {
    pub median: f64,
    pub largest: f64,
    /// Instances that engine and reference call ok, and instances tried.
    pub counted: usize,
    pub tried: usize,
}

/// One engine in one precision.
#[derive(Clone, Debug, serde::Serialize)]
pub struct BenchSeries {
    pub backend: &'static str,
    pub device: String,
    pub precision: Precision,
    pub points: Vec<Point>,
    pub error: ErrorSample,
}

/// Measures every machine on the scene; `say` is told what is being done.
///
/// # Errors
/// A scene that cannot be planned, run or made larger, or has nothing to step.
pub fn measure(
    scene: &Scene,
    machines: &[Machine],
    options: &BenchOptions,
    say: &dyn Fn(String),
) -> Result<Vec<BenchSeries>, BenchError> {
    let plan = Plan::new(scene, Precision::F64)?;
    if plan.instance_steps() == 0 {
        return Err(BenchError::NothingToStep);
    }
    let sized: Vec<Scene> =
        options.sizes.iter().map(|size| resized(scene, *size)).collect::<Result<_, _>>()?;
    let chosen = choose(&plan, options.compared, 1);
    say(format!("reference: {} instances", chosen.len()));
    let part = plan.part(&chosen);
    let truths = Reference::default().run(&part, &Progress::default())?.results;
    let mut all = Vec::new();
    for machine in machines {
        say(format!("{} {}: error", machine.backend, machine.precision.name()));
        let part = part.clone().in_precision(machine.precision);
        let ours = machine.engine.run(&part, &Progress::default())?.results;
        all.push(BenchSeries {
            backend: machine.backend,
            device: machine.engine.device(),
            precision: machine.precision,
            points: Vec::new(),
            error: error(&part, &ours, &truths),
        });
    }
    for scene in sized {
        let plan = Plan::new(&scene, Precision::F64)?;
        for (machine, series) in machines.iter().zip(&mut all) {
            let plan = plan.clone().in_precision(machine.precision);
            let point = time(&plan, machine.engine.as_ref(), options)?;
            say(format!(
                "{} {}: {} instances, {} periods, {:.2} s, {:.2e} instance-steps/s",
                machine.backend,
                machine.precision.name(),
                point.instances,
                point.periods,
                point.seconds,
                point.rate
            ));
            series.points.push(point);
        }
    }
    Ok(all)
}

/// The scene with about `size` instances: every axis of more than one value takes more or fewer points
/// between its ends, by the same factor.
fn resized(scene: &Scene, size: usize) -> Result<Scene, BenchError> {
    let mut sized = scene.clone();
    let instances = scene.len();
    let axes = scene.sweep.axes.iter().filter(|axis| axis.values.len() > 1).count();
    if axes == 0 {
        return if size == instances { Ok(sized) } else { Err(BenchError::NoAxis { instances }) };
    }
    // Whole numbers of points miss the size by a little: each axis makes up for what the last ones lost.
    let mut factor = size as f64 / instances as f64;
    let mut left = axes;
    for axis in sized.sweep.axes.iter_mut().filter(|axis| axis.values.len() > 1) {
        let list = matches!(sized.sweep.layout, crate::scene::Layout::List);
        let share = if list { size as f64 / instances as f64 } else { factor.powf(1.0 / left as f64) };
        let before = axis.values.len();
        let count = ((before as f64 * share).round() as usize).max(2);
        axis.values = spread(&axis.values, count, axis.log).into();
        factor /= count as f64 / before as f64;
        left -= 1;
    }
    Ok(sized)
}

/// `count` values over the same range, between neighbours in the same way.
fn spread(values: &[f64], count: usize, log: bool) -> Vec<f64> {
    let last = values.len() - 1;
    (0..count)
        .map(|i| {
            let at = (i * last) as f64 / (count - 1) as f64;
            let low = (at.floor() as usize).min(last - 1);
            let (a, b, t) = (values[low], values[low + 1], at - low as f64);
            if log { a * (b / a).powf(t) } else { a + (b - a) * t }
        })
        .collect()
}

/// A plan cut to `periods`.
fn cut(plan: &Plan, periods: u32) -> Plan {
    let mut plan = plan.clone();
    let measure = u64::from(plan.run.measure) * u64::from(periods) / u64::from(plan.run.periods);
    plan.run.periods = periods;
    plan.run.measure = (measure as u32).clamp(1, periods);
    plan
}

fn time(plan: &Plan, engine: &dyn Engine, options: &BenchOptions) -> Result<Point, BenchError> {
    let run = |periods: u32| -> Result<f64, BenchError> {
        let cut = cut(plan, periods);
        let start = Instant::now();
        engine.run(&cut, &Progress::default())?;
        Ok(start.elapsed().as_secs_f64())
    };
    // The first run compiles and warms up; later ones grow until they tell what a period takes.
    let most = plan.run.periods;
    run(most.min(2))?;
    let mut periods = most.min(2);
    let mut seconds = run(periods)?;
    // What is done once for an instance does not shorten the run: on a fast device it takes longer than many periods.
    let set_up = seconds;
    while seconds - set_up < 0.3 * options.seconds && periods < most {
        let stepping = (seconds - set_up).max(1e-3 * options.seconds);
        let factor = (options.seconds / stepping).clamp(1.5, 10.0);
        periods = ((f64::from(periods) * factor) as u32).min(most);
        seconds = run(periods)?;
    }
    for _ in 1..options.repeats {
        seconds = seconds.min(run(periods)?);
    }
    let steps = cut(plan, periods).instance_steps() as f64;
    Ok(Point { instances: plan.len(), periods, seconds, rate: steps / seconds })
}

fn error(plan: &Plan, ours: &[Finished], truths: &[Finished]) -> ErrorSample {
    let mut errors: Vec<f64> = ours
        .iter()
        .zip(truths)
        .enumerate()
        .map(|(i, (ours, truth))| (i, ours, truth))
        .filter(|(_, ours, truth)| ours.status == Status::Ok && truth.status == Status::Ok)
        .map(|(i, ours, truth)| {
            let scales = Scales::of(plan, i, &truth.measured);
            worst(&plan.observables, &ours.measured, &truth.measured, &scales)
        })
        .collect();
    errors.sort_by(f64::total_cmp);
    let none = f64::NAN;
    ErrorSample {
        median: errors.get(errors.len() / 2).copied().unwrap_or(none),
        largest: errors.last().copied().unwrap_or(none),
        counted: errors.len(),
        tried: plan.len(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_nearly_met_between_the_same_ends() {
        let path = std::path::Path::new("quickstart.toml");
        let scene = Scene::parse(path, include_str!("../../scenes/quickstart.toml")).unwrap();
        for size in [1_000, 10_000, 100_000] {
            let sized = resized(&scene, size).unwrap();
            let off = sized.len() as f64 / size as f64 - 1.0;
            assert!(off.abs() < 0.05, "{} for {size}", sized.len());
            for (a, b) in sized.sweep.axes.iter().zip(&scene.sweep.axes) {
                assert_eq!(a.values.first(), b.values.first());
                let (end, was) = (a.values[a.values.len() - 1], b.values[b.values.len() - 1]);
                assert!((end / was - 1.0).abs() < 1e-12, "{end} {was}");
                assert!(a.values.is_sorted());
            }
        }
        assert_eq!(resized(&scene, 4096).unwrap().len(), 4096);
    }
}
