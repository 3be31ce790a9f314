//! Converts predictions of periodic states to the shader's tables.

use super::Failure;
use super::pack::{Driven, Numbers, PieceTables, transposed, write};
use crate::engine::checkpoint::InstanceCheckpoint;
use crate::engine::section_state::{half_step, rest_indentation};
use crate::engine::{Prediction, Predictions};
use crate::kernel::broyden::Phase;
use crate::kernel::{Entry, LENGTH, MODES_MAX, RunSums};
use crate::plan::{Class, Plan};
use crate::scene::Start;
use rayon::prelude::*;

/// Input of a piece of a class on the device, for a search.
pub(super) struct StrideTables {
    pub piece: PieceTables,
    /// Numbers of a state.
    pub numbers: u32,
    /// States, then steps.
    pub places: Numbers,
    pub undoes: Numbers,
}

/// The phase and the periods of an instance after a search that did `done` steps. `steps` is their number in a period,
/// `rounds` the most rounds.
pub(super) fn end((steps, rounds): (u32, u32), done: u32, phase: u32) -> Result<(Phase, u32), Failure> {
    let phase = [Phase::On, Phase::Found, Phase::Lost].into_iter().find(|one| *one as u32 == phase);
    let periods = done / steps;
    // A search in progress to the end has done all its periods.
    let least = if phase == Some(Phase::On) { rounds } else { 1 };
    match phase {
        Some(phase) if done.is_multiple_of(steps) && (least..=rounds).contains(&periods) => {
            Ok((phase, periods))
        }
        _ => Err(Failure::Steps { done, expected: least * steps }),
    }
}

/// The tables of a class whose instances are indices of predictions.
pub(super) fn stride_tables(plan: &Plan, class: &Class, guesses: &Predictions) -> StrideTables {
    let driven = Driven::new(plan, &class.instances);
    let spec = driven.shader(plan.shader(class, Entry::Stride));
    let numbers = guesses.numbers;
    let of = |i: usize, instance: u32| {
        let (member, n) = (&driven.members[i], instance as usize);
        let guessed = guesses.all[n];
        let place: Vec<f64> = guesses.place(n).iter().map(|number| number / LENGTH).collect();
        let still = rest_indentation(&member.0, (member.1, Start::Steady), half_step(member.0.steps));
        let memory = f64::from(u8::from(class.law.has_hysteresis()));
        let swinging = member.1.kept.modes.len();
        let state = begun(&guessed, &place, (spec.modes, swinging, still));
        let goal = guesses.goal(&guessed);
        let own = [goal.scale, goal.near, goal.sure, still, memory, state.touching];
        let case = driven.gap_and_law(member).into_iter().chain(own).collect();
        let strides = std::iter::repeat_n(0.0, numbers);
        let place = place.iter().copied().chain(strides).collect();
        [case, write(&spec, &state), place, guesses.undoes(n).to_vec()]
    };
    let columns: Vec<[Vec<f64>; 4]> =
        class.instances.par_iter().enumerate().map(|(i, instance)| of(i, *instance)).collect();
    let table = |which: usize| Numbers::new(spec.double, transposed(&columns, |column| &column[which]));
    let (places, undoes) = (table(2), table(3));
    let rows = (plan.wants.harmonics, Start::Steady);
    let piece = driven.piece(spec, class.steps, rows, [table(0), table(1)]);
    StrideTables { piece, numbers: numbers as u32, places, undoes }
}

/// An instance at its prediction, kernel units, not measured. Of its modes, so many are the lever's. `still`: distance of free
/// motion from the sample there.
fn begun(
    guessed: &Prediction,
    place: &[f64],
    (modes, swinging, still): (usize, usize, f64),
) -> InstanceCheckpoint {
    let (mut x, mut u) = ([0.0; MODES_MAX], [0.0; MODES_MAX]);
    x[..modes].copy_from_slice(&place[..modes]);
    u[..modes].copy_from_slice(&place[place.len() / 2..][..modes]);
    let touching = f64::from(u8::from(guessed.touching));
    let last = -(still + x[..swinging].iter().sum::<f64>());
    InstanceCheckpoint {
        x,
        u,
        touching,
        last: [last; 2],
        touched: touching,
        run_sums: RunSums::new(),
        finite: true,
    }
}
