//! What is chosen once for all of a plan's instances, as plain data that can be written down: a run that is given it does
//! what the run did that chose it, to the bit, and so does one of a share of the instances.

use super::basis_choice::BasisTrialSet;
use super::hierarchy::SweepBlocks;
use super::{basis_choice, precision_trial};
use crate::engine::{Engine, EngineError, Progress};
use crate::plan::Plan;
use crate::scene::Steady;
use serde::{Deserialize, Serialize};

/// How each instance is taken to its result.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Course {
    /// With error control.
    Controlled,
    /// Once as it is planned: nothing is estimated.
    Once,
    /// By the reference engine.
    Reference,
}

/// The choices of a run. As TOML they are a few kilobytes: what each instance gets follows from the plan and these numbers.
#[derive(Clone, Debug, PartialEq, Deserialize, Serialize)]
pub struct Choices {
    pub course: Course,
    /// Most instances that are taken to their ends together: some ten seconds of work of one core or one GPU.
    pub portion: usize,
    /// Whether the instances of a large sweep begin at one another's states; the sweep decides in which order.
    #[serde(default)]
    pub neighbours: bool,
    /// What the engine had to say of the trials.
    #[serde(default)]
    pub notes: Vec<String>,
    pub(super) precision: precision_trial::PrecisionChoice,
    /// What bases were tried; none where the plan's own are taken.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) bases: Option<BasisTrialSet>,
}

/// Instance-steps per instance, of the whole run as planned, from which on a chunk is smaller than the engine's: a
/// core does some 2e8 a second, and the CPU's chunks are of 16,384.
const MANY_STEPS_PER_INSTANCE: f64 = 1.2e5;
/// Periods that a search steps at most, in place of those that would be integrated.
const MAX_SEARCH_PERIODS: u32 = 600;
/// Fewest instances of a chunk: enough to fill a processor's lanes.
const MIN_CHUNK_INSTANCES: usize = 64;

/// How many instances of the plan are some ten seconds of work. It hangs on the plan and the kind of engine alone.
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
    /// Of a run that was stopped in its trials.
    pub(super) fn stopped(planned: &Plan, engine: &dyn Engine) -> Self {
        Self::untried(planned, Course::Controlled, engine, "stopped before its trial")
    }

    /// Where nothing is tried, for this `reason`.
    pub fn untried(planned: &Plan, course: Course, engine: &dyn Engine, reason: &str) -> Self {
        let precision = precision_trial::PrecisionChoice::settled(planned, reason);
        let portion = chunk_size(planned, engine);
        Self { course, portion, neighbours: false, notes: Vec::new(), precision, bases: None }
    }
}

/// Chooses what a run of the plan this way needs: where errors are controlled modes and precision, by trials of a sample of
/// its instances (see [`run`](super::run)). None where it was stopped on the way.
///
/// # Errors
/// What the engine says.
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
    // Trials that were cut short, which no instance's result comes from.
    let portion = chunk_size(planned, engine);
    let chosen = Choices { course, portion, neighbours, notes, precision, bases };
    Ok((!progress.stopped()).then_some(chosen))
}
