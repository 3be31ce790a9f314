//! The CPU engine: packs of instances stepped side by side, packs in parallel, f64 or f32.

use super::lanes::{self, Family, Rounding, Stepping};
use super::measure::{finish, finish_free};
use super::saved::Saved;
use super::start;
use super::track::{Member, member, step_length};
use super::walk::{Packs, Walk};
use super::{Ended, Engine, EngineError, Outcome, Progress, ReturnMap, return_map};
use crate::instrument::Place;
use crate::kernel::{Decay, LENGTH, Lane, Wave};
use crate::plan::{Class, Driven, Plan, Station};
use crate::scene::Start;
use rayon::prelude::*;

/// All cores, or as many threads as asked for.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cpu {
    pub threads: Option<usize>,
    /// Rounds every product and every sum, as the shader does on a driver that is told to: the same bits on
    /// any processor, at a third of the speed or less. Otherwise sums of products round once where the
    /// processor can; the bits are then the same for all its instruction sets that fuse.
    pub strict: bool,
}

/// Steps between two looks at the progress; samples of decaying free motion tabulated at a time.
const BLOCK: usize = 1 << 18;

/// The processor's name, where the system tells it, or its architecture, and the vector instructions used of it: they
/// make a difference of two to four times in speed.
pub fn processor() -> String {
    let name = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    let name = name.unwrap_or_else(|| format!("{} processor", std::env::consts::ARCH));
    match lanes::instructions() {
        Some(instructions) => format!("{name} ({instructions})"),
        None => name,
    }
}

impl Engine for Cpu {
    fn device(&self) -> String {
        let threads = self.threads.unwrap_or_else(rayon::current_num_threads);
        format!("{}, {threads} thread{}", processor(), if threads == 1 { "" } else { "s" })
    }

    fn run(&self, plan: &Plan, progress: &Progress) -> Result<Outcome, EngineError> {
        let rounding = Rounding::new(self.strict);
        match self.pool()? {
            None => run(plan, rounding, progress),
            Some(pool) => pool.install(|| run(plan, rounding, progress)),
        }
    }

    /// What a portion does on one thread is hidden behind the others; threads of its own do one run at a time.
    fn portions(&self) -> (usize, usize) {
        (1 << 14, if self.threads.is_none() { 4 * rayon::current_num_threads() } else { 1 })
    }

    fn return_map(&self, plan: &Plan, instances: &[u32]) -> Result<Option<Box<dyn ReturnMap>>, EngineError> {
        let map = return_map::Map::new(plan, instances, Rounding::new(self.strict), self.pool()?)?;
        Ok(Some(Box::new(map)))
    }
}

impl Cpu {
    /// Threads of its own, where it is told how many.
    fn pool(&self) -> Result<Option<rayon::ThreadPool>, EngineError> {
        let pool = |threads| rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        self.threads.map(pool).transpose().map_err(|error| EngineError::Threads(error.to_string()))
    }
}

fn run(plan: &Plan, rounding: Rounding, progress: &Progress) -> Result<Outcome, EngineError> {
    let mut outcome = Outcome::of(plan);
    for class in &plan.classes {
        let from = plan.stations.as_ref().map(|stations| Resume::Stations(stations, &class.instances));
        outcome.put(&class.instances, resume(plan, class, from, rounding, progress)?);
    }
    Ok(outcome)
}

/// Where the instances of a class begin, if not at the run's start; in their order there.
#[derive(Clone, Copy, Debug)]
pub(super) enum Resume<'a> {
    /// As they stood after so many periods.
    Saved(&'a [Saved], u32),
    /// At these stations of theirs: by instance of the plan, and which instances they are.
    Stations(&'a [Station], &'a [u32]),
}

/// Runs a class from its start, or from where it was left. Results in the order of the class' instances.
pub(super) fn resume(
    plan: &Plan,
    class: &Class,
    from: Option<Resume>,
    rounding: Rounding,
    progress: &Progress,
) -> Result<Vec<Ended>, EngineError> {
    lanes::with(plan.precision, rounding, ClassRun { plan, class, from, progress })
}

/// Results of instances that never reach the sample.
pub(super) fn free_class(plan: &Plan, class: &Class) -> Vec<Ended> {
    class.instances.iter().map(|instance| finish_free(member(plan, *instance).1, plan.wants).into()).collect()
}

struct ClassRun<'a> {
    plan: &'a Plan,
    class: &'a Class,
    from: Option<Resume<'a>>,
    progress: &'a Progress,
}

impl Stepping for ClassRun<'_> {
    type Output = Result<Vec<Ended>, EngineError>;

    fn with<F: Family>(self) -> Self::Output {
        let Self { plan, class, from, progress } = self;
        if class.steps == 0 {
            return Ok(free_class(plan, class));
        }
        let packs = Packs::of::<F>(class.law, class.modes)?;
        Ok(instances(plan, class, from, &packs, progress))
    }
}

fn instances<E: Lane<Element = E>>(
    plan: &Plan,
    class: &Class,
    from: Option<Resume>,
    packs: &Packs<E>,
    progress: &Progress,
) -> Vec<Ended> {
    let waves = start::waves::<E>(class.steps, plan.wants.harmonics);
    let members: Vec<Member> = class.instances.iter().map(|instance| member(plan, *instance)).collect();
    if plan.run.start == Start::Steady {
        return members
            .par_chunks(packs.width)
            .enumerate()
            .flat_map_iter(|(number, pack)| {
                let track = packs.make(plan, pack, from, number * packs.width);
                steady(plan, pack, track, &waves, progress)
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
            let all = group.chunks(packs.width).enumerate();
            let tracks = all.map(|(n, pack)| packs.make(plan, pack, from, first + n * packs.width)).collect();
            from_rest(plan, group, packs.width, tracks, &waves, progress)
        })
        .collect()
}

fn steady<E>(
    plan: &Plan,
    pack: &[Member],
    mut track: Box<dyn Walk<E>>,
    waves: &[Vec<Wave<E>>],
    progress: &Progress,
) -> Vec<Ended> {
    let steps = waves[0].len();
    // In blocks, so that a long run tells how far it is and can be stopped.
    let block = (BLOCK / steps).max(1) as u32;
    let mut done = track.done();
    while done < plan.run.periods {
        if progress.stopped() {
            return vec![Ended::NOT_RUN; pack.len()];
        }
        let periods = block.min(plan.run.periods - done);
        track.advance(&plan.run, periods, waves, None, plan.wants);
        progress.add(pack.len() as u64 * u64::from(periods) * steps as u64);
        done += periods;
    }
    finish_pack(plan, pack, track.as_ref())
}

fn finish_pack<E>(plan: &Plan, pack: &[Member], track: &dyn Walk<E>) -> Vec<Ended> {
    let tell = plan.stations.is_some();
    pack.iter()
        .zip(track.sums(&plan.run, pack[0].0.steps))
        .enumerate()
        .map(|(lane, ((case, driven), sums))| Ended {
            finished: finish(&sums, case, driven, &plan.run, plan.wants),
            end: tell.then(|| Box::new(track.station(lane))),
        })
        .collect()
}

/// All instances of a group go through a block of periods before the next block is tabulated.
fn from_rest<E: Lane<Element = E>>(
    plan: &Plan,
    group: &[Member],
    width: usize,
    mut tracks: Vec<Box<dyn Walk<E>>>,
    waves: &[Vec<Wave<E>>],
    progress: &Progress,
) -> Vec<Ended> {
    let run = &plan.run;
    let driven = group[0].1;
    let steps = waves[0].len();
    let packs: Vec<&[Member]> = group.chunks(width).collect();
    let block = (BLOCK / steps).max(1) as u32;
    let mut done = tracks[0].done();
    while done < run.periods {
        if progress.stopped() {
            return vec![Ended::NOT_RUN; group.len()];
        }
        let periods = block.min(run.periods - done);
        let first = u64::from(done) * steps as u64;
        let decay = decays::<E>(driven, steps as u32, first, periods as usize * steps);
        tracks.par_iter_mut().for_each(|track| {
            track.advance(run, periods, waves, Some(&decay), plan.wants);
            progress.add(track.members() as u64 * u64::from(periods) * steps as u64);
        });
        done += periods;
    }
    tracks.iter().zip(packs).flat_map(|(track, pack)| finish_pack(plan, pack, track.as_ref())).collect()
}

/// The decaying free motion of the modes that are not stepped, at the middle of each step.
pub(super) fn decays<L: Lane>(
    driven: &Driven,
    steps: u32,
    first: u64,
    count: usize,
) -> Vec<Decay<L::Element>> {
    let step = step_length(driven, steps);
    let mut skip = vec![false; driven.instrument.modes.len()];
    for mode in &driven.kept.modes {
        if let Some(index) = mode.index {
            skip[index] = true;
        }
    }
    // One sample more on either side: the acceleration is a difference of speeds.
    let begin = first as f64 - 0.5;
    let rows = driven.free.transient_table(&driven.instrument, Place::Tip, &skip, begin, step, count + 2);
    rows.windows(3)
        .map(|row| Decay {
            travel: L::element(row[1][0] / LENGTH),
            speed: L::element(row[1][1] * step / LENGTH),
            acceleration: L::element(0.5 * (row[2][1] - row[0][1]) * step / LENGTH),
        })
        .collect()
}
