//! Forecast of a run's time on this machine, from runs of some instances.

use super::{Error, Recipe, Silent, Sweep};
use crate::clock::Instant;
use crate::control::{self, MemoryJournal};
use crate::engine::{Progress, while_watched};
use crate::scene::{Axis, Layout, Scene, Steady};
use std::time::Duration;

/// Instances, spread over all, that run without neighbours.
const SAMPLE_INSTANCES: usize = 48;
/// Instances of a part that is as dense as the whole, for a sweep whose instances start from one another's states.
const DENSE_INSTANCES: usize = 2048;
/// A smaller sweep gives no such part.
const MIN_INSTANCES: usize = 4096;
/// Time after which the forecast stops.
const MAX_FORECAST_TIME: Duration = Duration::from_secs(10);
/// Whole time relative to stepping: the audit adds a tenth.
const AUDIT_FACTOR: f64 = 1.1;

/// Forecast from some instances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forecast {
    /// Number of instances that ran, and their time, s.
    pub tried: usize,
    pub seconds: f64,
    /// Expected time of the whole run, s. None if the forecast was stopped because it took too long.
    pub expected: Option<f64>,
}

/// Seconds of the choices, which do not grow with a sweep, and of each instance.
#[derive(Clone, Copy)]
struct CostSample {
    choices: f64,
    each: f64,
}

impl Sweep {
    /// Runs some instances and forecasts the time of a whole run. One sample is spread over all instances, without
    /// neighbours. If instances start from one another's states, a dense part of the sweep runs, too. Its time is scaled by
    /// the ratio of the spread sample to a sample of the part.
    ///
    /// # Errors
    /// Those of [`Sweep::run`].
    pub fn forecast(&self) -> Result<Forecast, Error> {
        let progress = Progress::default();
        let start = Instant::now();
        let tried = self.watched(&Silent, || {
            while_watched(MAX_FORECAST_TIME, || progress.stop(), || self.time_sample(&progress))
        })?;
        let seconds = start.elapsed().as_secs_f64();
        let (tried, expected) = tried;
        Ok(Forecast { tried, seconds, expected: expected.filter(|_| !progress.stopped()) })
    }

    /// Number of instances that ran, and the expected time.
    fn time_sample(&self, progress: &Progress) -> Result<(usize, Option<f64>), Error> {
        let whole = |price: CostSample| AUDIT_FACTOR * (price.choices + price.each * self.scene.len() as f64);
        let cold = self.clone().cold(true);
        let (spread, count) = cold.time_scene(thin(&self.scene, SAMPLE_INSTANCES), progress)?;
        let dense = match self.options.cold {
            true => None,
            false => part(&self.scene, DENSE_INSTANCES),
        };
        let Some(part) = dense.filter(|_| !progress.stopped()) else {
            return Ok((count, Some(whole(spread))));
        };
        let (dense, of_part) = self.time_scene(part.clone(), progress)?;
        let (alone, of_few) = cold.time_scene(thin(&part, SAMPLE_INSTANCES), progress)?;
        let dearer = (spread.each / alone.each).max(0.1);
        let price = CostSample { each: dense.each * if dearer.is_finite() { dearer } else { 1.0 }, ..dense };
        Ok((count + of_part + of_few, Some(whole(price))))
    }

    /// Time of a scene's instances with this sweep's options, and their number.
    fn time_scene(&self, scene: Scene, progress: &Progress) -> Result<(CostSample, usize), Error> {
        let count = scene.len();
        let course = Recipe::course(&self.options, &scene);
        let small = Self { scene, ..self.clone() };
        let (plan, engine) = small.plan(&Silent)?;
        let start = Instant::now();
        let chosen = control::choose(&plan, course, engine.as_ref(), progress)?;
        let choices = start.elapsed().as_secs_f64();
        let start = Instant::now();
        if let Some(chosen) = chosen {
            control::run_chunks(plan, &chosen, &MemoryJournal::default(), engine.as_ref(), progress)?;
        }
        Ok((CostSample { choices, each: start.elapsed().as_secs_f64() / count.max(1) as f64 }, count))
    }
}

/// Thins out the scene's values until at most `most` instances are left. Curves stay whole.
fn thin(scene: &Scene, most: usize) -> Scene {
    let mut small = scene.clone();
    let curve = match small.sweep.curve {
        Some(curve) => 1 + usize::from(curve.both),
        None => 0,
    };
    while small.len() > most {
        let axes = small.sweep.axes.len() - curve.min(small.sweep.axes.len());
        let list = small.sweep.layout == Layout::List;
        let Some(longest) = (0..axes)
            .filter(|n| length(&small.sweep.axes[*n]) > 1)
            .max_by_key(|n| length(&small.sweep.axes[*n]))
        else {
            break;
        };
        let every = small.len().div_ceil(most).clamp(2, length(&small.sweep.axes[longest]));
        for (n, axis) in small.sweep.axes.iter_mut().enumerate() {
            if n == longest || list {
                choose(axis, |at| at % every == every / 2);
            }
        }
    }
    small.output.waveforms = None;
    small
}

/// A part from the middle of the sweep, as dense as the whole. None if instances do not start from one another's states.
fn part(scene: &Scene, most: usize) -> Option<Scene> {
    let alone =
        scene.run.steady == Steady::Wait || scene.sweep.curve.is_some() || scene.base.approach.held.is_some();
    if alone || scene.len() < MIN_INSTANCES {
        return None;
    }
    let mut small = scene.clone();
    while small.len() > most {
        let list = small.sweep.layout == Layout::List;
        let longest = (0..small.sweep.axes.len()).max_by_key(|n| length(&small.sweep.axes[*n]))?;
        let all = length(&small.sweep.axes[longest]);
        let (from, to) = (all / 4, all / 4 + all.div_ceil(2));
        for (n, axis) in small.sweep.axes.iter_mut().enumerate() {
            if n == longest || list {
                choose(axis, |at| (from..to).contains(&at));
            }
        }
    }
    small.output.waveforms = None;
    Some(small)
}

fn length(axis: &Axis) -> usize {
    axis.values.len()
}

/// Keeps some places of an axis.
fn choose(axis: &mut Axis, keeps: impl Fn(usize) -> bool + Copy) {
    let places = || (0..axis.values.len()).filter(|at| keeps(*at));
    let words = places().filter_map(|at| axis.words.get(at).cloned()).collect();
    let values = places().map(|at| axis.values[at]).collect::<Vec<f64>>();
    (axis.words, axis.values) = (words, values.into());
    axis.columns.iter_mut().for_each(|column| choose(column, keeps));
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    /// A million instances, with a dense part and a few spread evenly; a design; curves, which stay whole.
    #[test]
    fn parts_are_dense_and_samples_spread() {
        let scene = |swept: &str| {
            let text = format!(
                "[instrument.cantilever]\nstiffness = \"40 N/m\"\nfrequency = \"300 kHz\"\nquality_factor = 100\n[drive]\non = \"tip\"\n\
                 frequency = \"resonance\"\nfree_amplitude = \"20 nm\"\n{swept}\n[run]\nsteady = \"search\""
            );
            Scene::parse(Path::new("forecast.toml"), &text).unwrap_or_else(|error| panic!("{error}"))
        };
        let axes = "[sweep]\n\"sample.youngs_modulus\" = { from = \"1 GPa\", to = \"5 GPa\", points = 500 }\n\
                    \"approach.gap\" = { from = \"10 nm\", to = \"18 nm\", points = 400 }";
        let grid = scene(axes);
        let dense = part(&grid, DENSE_INSTANCES).expect("its instances begin at one another's states");
        let step = |scene: &Scene| scene.sweep.axes[1].values[1] - scene.sweep.axes[1].values[0];
        assert!((DENSE_INSTANCES / 2..=DENSE_INSTANCES).contains(&dense.len()), "{}", dense.len());
        assert!((step(&dense) - step(&grid)).abs() < 1e-12 * step(&grid));
        let few = thin(&grid, SAMPLE_INSTANCES);
        let ends = |scene: &Scene| {
            (scene.sweep.axes[1].values[0], *scene.sweep.axes[1].values.last().expect("it has values"))
        };
        assert!((SAMPLE_INSTANCES / 4..=SAMPLE_INSTANCES).contains(&few.len()), "{}", few.len());
        assert!(ends(&few).0 < 12e-9 && ends(&few).1 > 16e-9, "{:?}", ends(&few));
        let curves = scene(
            "[sweep]\n\"sample.youngs_modulus\" = { from = \"1 GPa\", to = \"5 GPa\", points = 100 }\n[curve]\nquantity = \
             \"approach.gap\"\nfrom = \"25 nm\"\nto = \"10 nm\"\npoints = 30\ndirection = \"both\"",
        );
        let few = thin(&curves, SAMPLE_INSTANCES);
        assert!(few.len() == 60 && part(&curves, DENSE_INSTANCES).is_none());
    }
}
