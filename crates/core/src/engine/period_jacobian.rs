//! Jacobians of periods: one period of each instance of a plan, on the CPU.

use super::kernel_constants::{LeverTable, Member, member, motion};
use super::kernel_dispatch::TangentReal;
use super::section_state::put;
use super::{EngineError, Noted, ProfileSection, Progress, section_state, start};
use crate::kernel::{LENGTH, Room, Rounding, Tangent, Wave};
use crate::plan::{Class, Plan, Precision, SectionState};
use crate::scene::Start;
use rayon::prelude::*;

/// The end of a period, and its Jacobian.
#[derive(Clone, Debug)]
pub struct PeriodJacobian {
    pub end: SectionState,
    /// Column by column: travels, then rates, of the state's pairs, with respect to each travel, then to each rate.
    pub slope: Box<[f64]>,
}

/// Periods of a plan's instances with their Jacobians; `None` if the run was stopped.
pub type PeriodJacobians = Noted<Option<PeriodJacobian>>;

/// The end state of an instance that started at `start`, from the kernel's numbers: see [`put`].
pub(super) fn ended(start: &SectionState, modes: usize, number: impl Fn(usize) -> f64) -> SectionState {
    let mut end = *start;
    let (touching, finite) = put((modes, modes), number, (&mut end.x, &mut end.u), LENGTH);
    (end.touching, end.finite) = (touching, start.finite && finite);
    end
}

/// The Jacobian of an instance's `own` modes, out of `all` that are stepped.
pub(super) fn kept((own, all): (usize, usize), at: impl Fn(usize, usize) -> f64) -> Box<[f64]> {
    let numbers = || (0..own).chain(all..all + own);
    numbers().flat_map(|column| numbers().map(|row| at(row, column)).collect::<Vec<_>>()).collect()
}

/// Periods of a class, in its order, from the plan's starts. `least` is by instance of the plan.
///
/// # Errors
/// No modes, or more than the kernel can step.
pub(super) fn of_class(
    plan: &Plan,
    class: &Class,
    least: &[f64],
    rounding: Rounding,
    progress: &Progress,
) -> Result<Vec<Option<PeriodJacobian>>, EngineError> {
    match plan.precision {
        Precision::F32 => of::<f32>(plan, class, least, rounding, progress),
        Precision::F64 => of::<f64>(plan, class, least, rounding, progress),
    }
}

fn of<E: TangentReal + Default>(
    plan: &Plan,
    class: &Class,
    least: &[f64],
    rounding: Rounding,
    progress: &Progress,
) -> Result<Vec<Option<PeriodJacobian>>, EngineError> {
    let tangent = E::tangent(rounding, class)?;
    let members: Vec<Member> = class.instances.iter().map(|instance| member(plan, *instance)).collect();
    let levers = LeverTable::of(&members, tangent.modes);
    let waves = start::waves(class.steps, 1).into_iter().flatten().collect();
    let periods = Periods { plan, least, tangent, levers, waves };
    let told = class.instances.par_chunks(tangent.width).map_init(Room::default, |room, some| {
        if progress.stopped() {
            return vec![None; some.len()];
        }
        progress.add(some.len() as u64 * u64::from(class.steps));
        progress.timed(ProfileSection::Steps, || periods.side_by_side(some, room))
    });
    Ok(told.flatten().collect())
}

/// What periods of a class share.
struct Periods<'a, E> {
    plan: &'a Plan,
    /// By instance of the plan.
    least: &'a [f64],
    tangent: Tangent<E>,
    levers: LeverTable,
    waves: Vec<Wave<E>>,
}

impl<E: TangentReal> Periods<'_, E> {
    /// Periods of up to a batch of instances; the last one fills the lanes left over.
    fn side_by_side(&self, some: &[u32], room: &mut Room<E>) -> Vec<Option<PeriodJacobian>> {
        let Self { plan, tangent, .. } = self;
        let (width, modes) = (tangent.width, tangent.modes);
        let places: Vec<SectionState> = some.iter().map(|instance| begun(plan, *instance)).collect();
        let numbers: Vec<[Vec<f64>; 2]> =
            some.iter().zip(&places).map(|(instance, place)| self.numbers(*instance, place)).collect();
        let (constants, mut state) = (rows(&numbers, 0, width), rows(&numbers, 1, width));
        let least: Vec<f64> = some.iter().map(|instance| self.least[*instance as usize]).collect();
        let mut slopes = Vec::with_capacity(some.len());
        tangent.period(&constants, &mut state, &self.waves, &least, room, |lane, slope| {
            let own = plan.pairs(some[lane]);
            slopes.push(kept((own, modes), |row, column| slope.at(row, column).lane(0)));
        });
        let told = places.iter().zip(slopes).enumerate();
        told.map(|(lane, (place, slope))| {
            let end = ended(place, modes, |row| state[row * width + lane].lane(0));
            Some(PeriodJacobian { end, slope })
        })
        .collect()
    }

    /// An instance's constants and its state, in the order of [`crate::kernel::Stepper`].
    fn numbers(&self, instance: u32, place: &SectionState) -> [Vec<f64>; 2] {
        let (one, modes) = (member(self.plan, instance), self.tangent.modes);
        let saved = section_state::checkpoint(self.plan, instance, place);
        let constants = motion(&one, self.levers.get(&one), Start::Steady).collect();
        [constants, [&saved.x[..modes], &saved.u[..modes], &[saved.touching]].concat()]
    }
}

/// The constants (`which` = 0) or the states (1) of instances, in rows of `width` numbers.
fn rows<E: TangentReal>(numbers: &[[Vec<f64>; 2]], which: usize, width: usize) -> Vec<E> {
    let count = numbers.first().map_or(0, |one| one[which].len());
    let mut rows = Vec::with_capacity(count * width);
    for row in 0..count {
        let lanes = (0..width).map(|lane| lane.min(numbers.len() - 1));
        rows.extend(lanes.map(|lane| E::element(numbers[lane][which][row])));
    }
    rows
}

/// The start that the plan gives an instance.
pub(super) fn begun(plan: &Plan, instance: u32) -> SectionState {
    let starts = plan.starts.as_ref();
    starts.and_then(|starts| starts.get(instance as usize)).map_or(SectionState::FREE, |start| start.section)
}
