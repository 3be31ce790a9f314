//! The CPU engine: packs of instances stepped side by side, packs in parallel, f64 or f32.

use super::batch::Batch;
#[cfg(feature = "gpu")]
use super::checkpoint::InstanceCheckpoint;
use super::kernel_constants::{LeverTable, Member, begin, member, step_length};
use super::kernel_dispatch::stepper;
use super::measurement::{finish, finish_free};
use super::{
    Corrections, Ended, Engine, EngineError, NewtonResults, NewtonStarts, Outcome, PeriodJacobians,
    Predictions, ProfileSection, Progress, ReturnMap, broyden_search, newton_search, period_jacobian,
    return_map, section_state, start, threads,
};
use crate::instrument::MotionPlace;
use crate::kernel::{Decay, LENGTH, Real, Rounding, Stepper, Wave, instructions};
use crate::plan::{Class, Driven, Plan, Precision, StartState};
use crate::scene::Start;
use rayon::prelude::*;

/// Uses all threads of the pool that calls it, see [`super::on_threads`].
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpu {
    /// Rounds every product and every sum, as the shader does on a strict driver, and searches as it does: the same bits on
    /// any processor, at a third of the speed or less. Otherwise sums of products round once where the processor can; the bits
    /// are then the same for all its instruction sets that fuse.
    pub strict: bool,
}

/// Steps between two checks of the progress; samples of decaying free motion tabulated at a time.
const BLOCK: usize = 1 << 18;

/// The processor's name, or its architecture if the system does not give it, and its vector instructions in use, which change
/// the speed by two to four times.
pub fn processor() -> String {
    let name = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    let name = name.unwrap_or_else(|| format!("{} processor", std::env::consts::ARCH));
    match instructions() {
        Some(instructions) => format!("{name} ({instructions})"),
        None => name,
    }
}

impl Engine for Cpu {
    fn device(&self) -> String {
        format!("{}, {}", processor(), threads::described())
    }

    fn kind(&self) -> String {
        let times = if Rounding::new(self.strict) == Rounding::STRICT { "twice" } else { "once" };
        let searches = if self.strict { ", searches as on devices" } else { "" };
        format!("cpu, products and sums round {times}{searches}")
    }

    fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
        let mut outcome = Outcome::of(plan);
        for class in &plan.classes() {
            let from = plan.starts.as_ref().map(|starts| Resume::Starts(starts, &class.instances));
            let ended = resume(plan, class, from, Rounding::new(self.strict), progress)?;
            outcome.put(&class.instances, ended);
        }
        Ok(outcome)
    }

    /// The other chunks hide what a chunk does on one thread.
    fn portions(&self) -> (usize, usize) {
        (1 << 14, 4 * rayon::current_num_threads())
    }

    fn by_threads(&self) -> bool {
        true
    }

    fn tells_slopes(&self) -> bool {
        true
    }

    fn slopes(
        &self,
        plan: &Plan,
        least: &[f64],
        progress: &Progress,
    ) -> Result<PeriodJacobians, EngineError> {
        let mut slopes = PeriodJacobians::none(plan, None);
        for class in plan.classes().iter().filter(|class| class.steps > 0) {
            let told = period_jacobian::of_class(plan, class, least, Rounding::new(self.strict), progress)?;
            slopes.put(&class.instances, told);
        }
        Ok(slopes)
    }

    fn broyden(
        &self,
        plan: &Plan,
        guesses: &mut Predictions,
        progress: &Progress,
    ) -> Result<Corrections, EngineError> {
        let all = broyden_search::all(plan, guesses, Rounding::new(self.strict), progress)?;
        Ok(Corrections { all, notes: Vec::new() })
    }

    /// As on devices. Otherwise rounds on the host need fewer Jacobians, and use differences where these cost less.
    fn searches(&self) -> bool {
        self.strict
    }

    fn newton(
        &self,
        plan: &Plan,
        seeks: &NewtonStarts,
        progress: &Progress,
    ) -> Result<NewtonResults, EngineError> {
        let all: Vec<u32> = plan.instances().collect();
        let all = newton_search::all(plan, &all, seeks, Rounding::new(self.strict), progress)?;
        Ok(NewtonResults { all, notes: Vec::new() })
    }

    fn return_map(&self, plan: &Plan, instances: &[u32]) -> Result<Option<Box<dyn ReturnMap>>, EngineError> {
        let map = return_map::CpuReturnMap::new(plan, instances, Rounding::new(self.strict))?;
        Ok(Some(Box::new(map)))
    }
}

/// The initial states of a class's instances, in order, if not the run's start.
#[derive(Clone, Copy, Debug)]
pub(super) enum Resume<'a> {
    /// Checkpoints of a device after so many periods.
    #[cfg(feature = "gpu")]
    Saved(&'a [InstanceCheckpoint], u32),
    /// The plan's starts, by its instances, and the numbers of these instances.
    Starts(&'a [StartState], &'a [u32]),
}

impl Resume<'_> {
    /// Periods done.
    fn done(&self) -> u32 {
        match self {
            #[cfg(feature = "gpu")]
            Self::Saved(_, done) => *done,
            Self::Starts(..) => 0,
        }
    }
}

/// Runs a class from its start, or from `from`. Results are in the order of the class's instances.
pub(super) fn resume(
    plan: &Plan,
    class: &Class,
    from: Option<Resume>,
    rounding: Rounding,
    progress: &Progress,
) -> Result<Vec<Ended>, EngineError> {
    if class.steps == 0 {
        return Ok(free_class(plan, class));
    }
    match plan.precision {
        Precision::F32 => Ok(instances::<f32>(plan, class, from, &stepper(rounding, class)?, progress)),
        Precision::F64 => Ok(instances::<f64>(plan, class, from, &stepper(rounding, class)?, progress)),
    }
}

/// Results of instances that never reach the sample.
pub(super) fn free_class(plan: &Plan, class: &Class) -> Vec<Ended> {
    let free = |(case, driven, ..): Member| finish_free(case.gap, driven, plan.wants).into();
    class.instances.iter().map(|instance| free(member(plan, *instance))).collect()
}

fn instances<E: Real>(
    plan: &Plan,
    class: &Class,
    from: Option<Resume>,
    stepper: &Stepper<E>,
    progress: &Progress,
) -> Vec<Ended> {
    let waves = start::waves::<E>(class.steps, plan.wants.harmonics);
    let members: Vec<Member> = class.instances.iter().map(|instance| member(plan, *instance)).collect();
    let levers = LeverTable::of(&members, stepper.modes);
    let done = from.map_or(0, |from| from.done());
    let batch = |first: usize, some: &[Member]| {
        let saved = |i: usize| match from {
            None => begin(&some[i], plan.run.start),
            #[cfg(feature = "gpu")]
            Some(Resume::Saved(saved, _)) => saved[first + i],
            Some(Resume::Starts(starts, instances)) => {
                let instance = instances[first + i];
                section_state::checkpoint(plan, instance, &starts[instance as usize].section)
            }
        };
        let made = || Batch::new(stepper, some, &levers, plan.run.start, saved, done);
        progress.timed(ProfileSection::Constants, made)
    };
    if plan.run.start == Start::Steady {
        return members
            .par_chunks(stepper.width)
            .enumerate()
            .flat_map_iter(|(number, some)| {
                step_batches(plan, some, vec![batch(number * stepper.width, some)], done, &waves, progress)
            })
            .collect();
    }
    // Instances of one drive stand together: each group shares its decaying free motion.
    let same_drive = |a: &Member, b: &Member| a.0.drive == b.0.drive;
    let mut before = 0;
    let groups: Vec<(usize, &[Member])> = members
        .chunk_by(same_drive)
        .map(|group| {
            before += group.len();
            (before - group.len(), group)
        })
        .collect();
    groups
        .par_iter()
        .flat_map_iter(|(first, group)| {
            let all = group.chunks(stepper.width).enumerate();
            let batches = all.map(|(n, some)| batch(first + n * stepper.width, some)).collect();
            step_batches(plan, group, batches, done, &waves, progress)
        })
        .collect()
}

fn finish_batch<E: Real>(plan: &Plan, members: &[Member], batch: &Batch<E>) -> Vec<Ended> {
    let tell = plan.starts.is_some();
    members
        .iter()
        .zip(batch.sums(&plan.run, members[0].0.steps))
        .enumerate()
        .map(|(lane, ((case, driven), sums))| Ended {
            finished: finish(&sums, case, driven, &plan.run, plan.wants),
            end: tell.then(|| Box::new(batch.station(lane))),
        })
        .collect()
}

/// All instances of a group go through a block of periods before the next block, so that a long run reports its progress and
/// can be stopped, and from rest the decaying free motion is tabulated block by block.
fn step_batches<E: Real>(
    plan: &Plan,
    group: &[Member],
    mut batches: Vec<Batch<E>>,
    mut done: u32,
    waves: &[Vec<Wave<E>>],
    progress: &Progress,
) -> Vec<Ended> {
    let run = &plan.run;
    let driven = group[0].1;
    let steps = waves[0].len();
    let block = (BLOCK / steps).max(1) as u32;
    while done < run.periods {
        if progress.stopped() {
            return vec![Ended::NOT_RUN; group.len()];
        }
        let periods = block.min(run.periods - done);
        let first = u64::from(done) * steps as u64;
        let decay = (run.start == Start::Rest)
            .then(|| decays::<E>(driven, steps as u32, first, periods as usize * steps));
        batches.par_iter_mut().for_each(|batch| {
            progress.timed(ProfileSection::Steps, || {
                batch.advance(run, periods, waves, decay.as_deref(), plan.wants)
            });
            progress.add(batch.members() as u64 * u64::from(periods) * steps as u64);
        });
        done += periods;
    }
    let members = group.chunks(batches[0].members());
    batches.iter().zip(members).flat_map(|(batch, members)| finish_batch(plan, members, batch)).collect()
}

/// The decaying free motion of the modes that are not stepped, at the middle of each step.
pub(super) fn decays<E: Real>(driven: &Driven, steps: u32, first: u64, count: usize) -> Vec<Decay<E>> {
    let step = step_length(driven, steps);
    let mut skip = vec![false; driven.instrument.modes.len()];
    for mode in &driven.kept.modes {
        if let Some(index) = mode.index {
            skip[index] = true;
        }
    }
    // One more sample on either side: the acceleration is a difference of speeds.
    let begin = first as f64 - 0.5;
    let rows =
        driven.free.transient_table(&driven.instrument, MotionPlace::Tip, &skip, begin, step, count + 2);
    rows.windows(3)
        .map(|row| Decay {
            travel: E::element(row[1][0] / LENGTH),
            speed: E::element(row[1][1] * step / LENGTH),
            acceleration: E::element(0.5 * (row[2][1] - row[0][1]) * step / LENGTH),
        })
        .collect()
}
