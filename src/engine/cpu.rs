//! The CPU engine: instances in parallel, each stepped on its own, f64 or f32.

use super::law::KernelLaw;
use super::measure::{finish, finish_free};
use super::start;
use super::track::{Scalar, Track, step_length};
use super::{Engine, EngineError, Finished, Outcome, Progress};
use crate::contact::Law;
use crate::instrument::Place;
use crate::kernel::contact::{Dmt, Hertz, Jkr, Nothing};
use crate::kernel::{Decay, LENGTH, MODES_MAX, Wave};
use crate::plan::{Class, Driven, Plan, Precision};
use crate::scene::Start;
use rayon::prelude::*;

/// All cores, or as many threads as asked for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpu {
    pub threads: Option<usize>,
}

/// Samples of decaying free motion tabulated at a time, for a start from rest.
const BLOCK: usize = 1 << 18;

impl Engine for Cpu {
    fn device(&self) -> String {
        format!("CPU, {} threads", self.threads.unwrap_or_else(rayon::current_num_threads))
    }

    fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
        match self.threads {
            None => run(plan, progress),
            Some(threads) => rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .map_err(|error| EngineError::Threads(error.to_string()))?
                .install(|| run(plan, progress)),
        }
    }
}

fn run(plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
    let mut results = vec![Finished::NOT_RUN; plan.cases.len()];
    for class in &plan.classes {
        let finished = match plan.precision {
            Precision::F32 => class_in::<f32>(plan, class, progress)?,
            Precision::F64 => class_in::<f64>(plan, class, progress)?,
        };
        for (instance, result) in class.instances.iter().zip(finished) {
            results[*instance as usize] = result;
        }
    }
    Ok(Outcome { results })
}

/// Results in the order of the class' instances.
fn class_in<L: Scalar>(
    plan: &Plan,
    class: &Class,
    progress: &Progress,
) -> Result<Vec<Finished>, EngineError> {
    if class.steps == 0 {
        let driven = |instance: &u32| &plan.drives[plan.cases[*instance as usize].drive as usize];
        return Ok(class.instances.iter().map(|i| finish_free(driven(i), plan.wants)).collect());
    }
    macro_rules! modes {
        ($law:ty, $($count:literal)+) => {
            match class.modes {
                0 => Err(EngineError::NoModes),
                $($count => Ok(instances::<L, $law, $count>(plan, class, progress)),)+
                modes => Err(EngineError::TooManyModes { modes, most: MODES_MAX }),
            }
        };
    }
    match class.law {
        Law::None => modes!(Nothing, 1 2 3 4 5 6 7 8),
        Law::Hertz => modes!(Hertz<L>, 1 2 3 4 5 6 7 8),
        Law::Dmt => modes!(Dmt<L>, 1 2 3 4 5 6 7 8),
        Law::Jkr => modes!(Jkr<L>, 1 2 3 4 5 6 7 8),
    }
}

fn instances<L: Scalar, I: KernelLaw<L> + Send + Sync, const M: usize>(
    plan: &Plan,
    class: &Class,
    progress: &Progress,
) -> Vec<Finished> {
    let waves = start::waves::<L>(class.steps, plan.wants.harmonics);
    // Instances of one drive stand together: each group shares its decaying free motion.
    let same_drive = |a: &u32, b: &u32| plan.cases[*a as usize].drive == plan.cases[*b as usize].drive;
    let groups: Vec<&[u32]> = class.instances.chunk_by(same_drive).collect();
    groups
        .par_iter()
        .map(|group| match plan.run.start {
            Start::Steady => steady::<L, I, M>(plan, group, &waves, progress),
            Start::Rest => from_rest::<L, I, M>(plan, group, class.steps, &waves, progress),
        })
        .flatten_iter()
        .collect()
}

fn steady<L: Scalar, I: KernelLaw<L> + Send + Sync, const M: usize>(
    plan: &Plan,
    group: &[u32],
    waves: &[Vec<Wave<L>>],
    progress: &Progress,
) -> Vec<Finished> {
    group
        .par_iter()
        .map(|instance| {
            if progress.stopped() {
                return Finished::NOT_RUN;
            }
            let case = &plan.cases[*instance as usize];
            let driven = &plan.drives[case.drive as usize];
            let mut track = Track::<L, I, M>::new(case, driven, plan.run.start);
            track.advance(&plan.run, plan.run.periods, waves, None, plan.wants);
            progress.add(u64::from(plan.run.periods) * u64::from(case.steps));
            finish(track.sums(), track.finite, case, driven, &plan.run, plan.wants)
        })
        .collect()
}

/// All instances of a group go through a block of periods before the next block is tabulated.
fn from_rest<L: Scalar, I: KernelLaw<L> + Send + Sync, const M: usize>(
    plan: &Plan,
    group: &[u32],
    steps: u32,
    waves: &[Vec<Wave<L>>],
    progress: &Progress,
) -> Vec<Finished> {
    let run = &plan.run;
    let case = |instance: &u32| &plan.cases[*instance as usize];
    let driven = &plan.drives[case(&group[0]).drive as usize];
    let mut tracks: Vec<Track<L, I, M>> =
        group.iter().map(|instance| Track::new(case(instance), driven, run.start)).collect();
    let block = (BLOCK / steps as usize).max(1) as u32;
    let mut done = 0;
    while done < run.periods {
        if progress.stopped() {
            return vec![Finished::NOT_RUN; group.len()];
        }
        let periods = block.min(run.periods - done);
        let first = u64::from(done) * u64::from(steps);
        let decay = decays::<L>(driven, steps, first, periods as usize * steps as usize);
        tracks.par_iter_mut().for_each(|track| {
            track.advance(run, periods, waves, Some(&decay), plan.wants);
            progress.add(u64::from(periods) * u64::from(steps));
        });
        done += periods;
    }
    tracks
        .iter()
        .zip(group)
        .map(|(track, instance)| finish(track.sums(), track.finite, case(instance), driven, run, plan.wants))
        .collect()
}

/// The decaying free motion of the modes that are not stepped, at the middle of each step.
pub(super) fn decays<L: Scalar>(driven: &Driven, steps: u32, first: u64, count: usize) -> Vec<Decay<L>> {
    let step = step_length(driven, steps);
    let mut skip = vec![false; driven.instrument.modes.len()];
    for mode in &driven.kept.modes {
        if let Some(index) = mode.index {
            skip[index] = true;
        }
    }
    // One sample more on either side: the acceleration is a difference of speeds.
    let begin = (first as f64 - 0.5) * step;
    let rows = driven.free.transient_table(&driven.instrument, Place::Tip, &skip, begin, step, count + 2);
    rows.windows(3)
        .map(|row| Decay {
            travel: L::splat(row[1][0] / LENGTH),
            speed: L::splat(row[1][1] * step / LENGTH),
            acceleration: L::splat(0.5 * (row[2][1] - row[0][1]) * step / LENGTH),
        })
        .collect()
}
