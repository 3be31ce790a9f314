//! The choices that all instances of a plan share, as plain data. A run or a share of a run that is given them repeats the
//! original run to the bit.

use super::basis_choice::BasisTrialSet;
use super::hierarchy::SweepBlocks;
use super::{basis_choice, precision_trial};
use crate::engine::{Engine, EngineError, Progress};
use crate::plan::Plan;
use crate::scene::Steady;
use serde::{Deserialize, Serialize};

/// How each instance gets its result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Course {
    /// With error control.
    Controlled,
    /// One run as planned, without error estimates.
    Once,
    /// By the reference engine.
    Reference,
}

/// The choices of a run, a few kilobytes of TOML. Together with the plan they determine how each instance runs.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Choices {
    pub course: Course,
    /// Largest number of instances in a chunk: about ten seconds of work of one core or one GPU.
    pub portion: usize,
    /// Whether instances of a large sweep start from one another's states. The sweep determines the order.
    #[serde(default)]
    pub neighbours: bool,
    /// Messages of the engine from the trials.
    #[serde(default)]
    pub notes: Vec<String>,
    pub(super) precision: precision_trial::PrecisionChoice,
    /// The bases that were tried. None if the plan's own bases are used.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) bases: Option<BasisTrialSet>,
}

/// Planned instance-steps per instance above which a chunk is smaller than the engine's size. A core does about 2e8 a second,
/// and a chunk of the CPU has 16,384 instances.
const MANY_STEPS_PER_INSTANCE: f64 = 1.2e5;
/// Most periods that a search steps instead of integrating to steady state.
const MAX_SEARCH_PERIODS: u32 = 600;
/// Smallest chunk: it fills the lanes of a processor.
const MIN_CHUNK_INSTANCES: usize = 64;

/// Number of instances that take about ten seconds. It depends on the plan and the kind of engine alone.
pub(super) fn chunk_size(plan: &Plan, engine: &dyn Engine) -> usize {
    let most = engine.portions().0;
    let periods = match plan.run.steady {
        Steady::Search => plan.run.periods.min(MAX_SEARCH_PERIODS),
        Steady::Wait => plan.run.periods,
    };
    let of_all = plan.instance_steps() as f64 / f64::from(plan.run.periods.max(1)) * f64::from(periods);
    let stepped = plan.instances().filter(|i| plan.steps(*i) > 0).count();
    let each = of_all / stepped.max(1) as f64;
    let size = most as f64 * (MANY_STEPS_PER_INSTANCE / each.max(1.0)).min(1.0);
    (size as usize).max(MIN_CHUNK_INSTANCES.min(most))
}

impl Choices {
    /// Choices of a run that was stopped during its trials.
    pub(super) fn stopped(planned: &Plan, engine: &dyn Engine) -> Self {
        Self::untried(planned, Course::Controlled, engine, "stopped before its trial")
    }

    /// Choices without trials, for this `reason`.
    pub fn untried(planned: &Plan, course: Course, engine: &dyn Engine, reason: &str) -> Self {
        let precision = precision_trial::PrecisionChoice::settled(planned, reason);
        let portion = chunk_size(planned, engine);
        Self { course, portion, neighbours: false, notes: Vec::new(), precision, bases: None }
    }
}

/// Makes the choices for a run of the plan. For a run with error control, trials of a sample of its instances choose modes
/// and precision (see [`run`](super::run)). None if the run was stopped on the way.
///
/// # Errors
/// Those of the engine.
pub fn choose(
    planned: &Plan,
    course: Course,
    engine: &dyn Engine,
    progress: &Progress,
) -> Result<Option<Choices>, EngineError> {
    let stepped = planned.stepped();
    let settled = |reason: &str| Some(Choices::untried(planned, course, engine, reason));
    match course {
        Course::Reference => return Ok(settled("the reference engine has no other")),
        Course::Once => return Ok(settled("as told")),
        Course::Controlled if stepped.is_empty() => return Ok(settled("nothing was stepped")),
        Course::Controlled => {}
    }
    progress.stage(&["trial"]);
    let (bases, mut notes) = basis_choice::try_bases(planned, &stepped, engine, progress)?;
    let neighbours = !planned.cold && SweepBlocks::of(planned).is_some();
    let mut precision = match neighbours && engine.double() && planned.precision_open {
        true => precision_trial::for_neighbours(planned),
        false => {
            let plan = basis_choice::choose_bases(planned, &stepped, bases.as_ref()).plan;
            precision_trial::choose(&plan, &stepped, engine, progress)?
        }
    };
    notes.append(&mut precision.notes);
    // A stopped run may have cut trials short; no result comes from these.
    let portion = chunk_size(planned, engine);
    let chosen = Choices { course, portion, neighbours, notes, precision, bases };
    Ok((!progress.stopped()).then_some(chosen))
}
