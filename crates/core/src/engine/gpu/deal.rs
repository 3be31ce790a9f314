//! A run dealt out: whatever device is free takes the next piece, and what one of them fails at is gone on with.

use super::dealer::{Did, TRIES};
use super::device::Fate;
use super::pack::{self, Tables};
use super::piece::Piece;
use super::{Failure, Gpu};
use crate::engine::cpu::{self, Resume};
use crate::engine::measure::{Sums, finish};
use crate::engine::member::member;
use crate::engine::saved::Saved;
use crate::engine::{Ended, EngineError, Outcome, Progress, station};
use crate::kernel::Rounding;
use crate::plan::{Class, Plan};
use rayon::prelude::*;
use std::collections::{HashMap, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// A run on its way.
pub(super) struct Deal<'a> {
    gpu: &'a Gpu,
    plan: &'a Plan,
    progress: &'a Progress,
    /// What whole pieces of each class took.
    did: HashMap<usize, Vec<Did>>,
}

/// What became of a piece: on which device, how long that took, and if it failed there whether the device is lost.
struct Told {
    piece: Piece,
    place: usize,
    fate: Fate,
    time: Duration,
    lost: bool,
}

impl<'a> Deal<'a> {
    pub fn new(gpu: &'a Gpu, plan: &'a Plan, progress: &'a Progress) -> Self {
        Self { gpu, plan, progress, did: HashMap::new() }
    }

    /// Takes all pieces to their ends.
    ///
    /// Tables are made and results are finished on the caller's thread alone, with its pool: threads that wait for devices
    /// wait for nothing else, so that many runs may go on side by side on any number of threads.
    pub fn all(mut self, mut pieces: VecDeque<Piece>, outcome: &mut Outcome) -> Result<(), EngineError> {
        let (gpu, plan, progress) = (self.gpu, self.plan, self.progress);
        let (to, from) = mpsc::channel();
        std::thread::scope(|scope| {
            let mut under_way = 0;
            loop {
                if progress.stopped() {
                    pieces.clear();
                }
                // One waits with its tables for the first device that is free.
                while under_way <= gpu.dealer.holding()
                    && let Some(piece) = pieces.pop_front()
                {
                    let saved = piece.at.as_ref().map(|at| at.saved.as_slice());
                    let tables = pack::tables(plan, &piece.class, &piece.class.instances, saved);
                    let to = to.clone();
                    scope.spawn(move || {
                        // Nobody hears it where the run has ended with an error.
                        let _ = to.send(carry(gpu, plan, (piece, &tables), progress));
                    });
                    under_way += 1;
                }
                if under_way == 0 {
                    break;
                }
                let Ok(told) = from.recv() else { break };
                under_way -= 1;
                match told {
                    Ok(told) => self.take(told, &mut pieces, outcome),
                    Err(piece) => self.on_the_cpu(piece, outcome)?,
                }
            }
            self.did.values().for_each(|did| gpu.dealer.learn(did));
            Ok(())
        })
    }

    /// Takes in what became of a piece; what is left of it goes to the head of the queue.
    fn take(&mut self, told: Told, pieces: &mut VecDeque<Piece>, outcome: &mut Outcome) {
        let Told { mut piece, place, fate, time, lost } = told;
        let failure = match fate {
            Fate::Stopped => return,
            Fate::Done(saved) => {
                if piece.done() == 0 && piece.refused == 0 {
                    self.did.entry(piece.group).or_default().push((place, piece.work(self.plan), time));
                }
                let ended = finish_all(self.plan, &piece.class, &saved);
                return outcome.put(&piece.class.instances, ended);
            }
            Fate::Closed(error) => {
                outcome.notes.push(self.gpu.without(place, &error));
                return pieces.push_front(piece);
            }
            Fate::Failed(failure) => failure,
        };
        let (who, from) = (self.gpu.who(place), piece.done());
        let count = piece.class.instances.len();
        if matches!(failure, Failure::Memory) && count > 1 {
            let note = format!("{who}{failure} with {count} instances: going on with half of them");
            outcome.notes.push(note);
            return piece.halves().into_iter().rev().for_each(|half| pieces.push_front(half));
        }
        if !matches!(failure, Failure::Lost(_)) {
            piece.refused += 1;
        }
        let how = match lost {
            true => "without it",
            false if self.gpu.devices.len() > 1 => "with whichever device is free",
            false => "with a new device",
        };
        outcome.notes.push(format!("{who}{failure}: going on from period {from} {how}"));
        pieces.push_front(piece);
    }

    /// What no device can do.
    fn on_the_cpu(&self, piece: Piece, outcome: &mut Outcome) -> Result<(), EngineError> {
        let Piece { class, at, .. } = &piece;
        if self.gpu.dealer.is_news() {
            outcome.notes.push(format!("going on from period {} on the CPU", piece.done()));
        }
        let resume = at.as_ref().map(|at| Resume::Saved(&at.saved, at.done));
        let rounding = Rounding::new(self.gpu.strict);
        let ended = cpu::resume(self.plan, class, resume, rounding, self.progress)?;
        outcome.put(&class.instances, ended);
        Ok(())
    }
}

/// Takes a piece to a device, as soon as one is free; hands it back where there is none for it.
fn carry(
    gpu: &Gpu,
    plan: &Plan,
    (mut piece, tables): (Piece, &Tables),
    progress: &Progress,
) -> Result<Told, Piece> {
    if piece.refused >= TRIES {
        return Err(piece);
    }
    let Some(place) = gpu.dealer.lease(piece.meant) else { return Err(piece) };
    let Some(device) = gpu.devices.get(place) else { return Err(piece) };
    let (begun, work) = (Instant::now(), piece.work(plan));
    // A driver's panic is a failure like others: what it was at is in the piece.
    let step = || device.step(plan, (&mut piece, tables), (gpu.strict, &gpu.drill), progress);
    let fate = catch_unwind(AssertUnwindSafe(step)).unwrap_or_else(|_| {
        device.close();
        Fate::Failed(Failure::Refused("the driver broke off".into()))
    });
    let time = begun.elapsed();
    let mut lost = false;
    match &fate {
        Fate::Done(_) => gpu.dealer.did(place, work),
        Fate::Failed(Failure::Lost(_)) => lost = gpu.dealer.failed(place),
        Fate::Stopped | Fate::Failed(_) => gpu.dealer.give_back(place),
        Fate::Closed(_) => gpu.dealer.lost(place),
    }
    Ok(Told { piece, place, fate, time, lost })
}

fn finish_all(plan: &Plan, class: &Class, saved: &[Saved]) -> Vec<Ended> {
    let tell = plan.starts.is_some();
    class
        .instances
        .par_iter()
        .zip(saved)
        .map(|(instance, saved)| {
            let (case, driven) = member(plan, *instance);
            let sums = Sums::new(saved.run_sums, saved.finite, plan.run.measure, class.steps);
            Ended {
                finished: finish(&sums, &case, driven, &plan.run, plan.wants),
                end: tell.then(|| Box::new(station::station(saved))),
            }
        })
        .collect()
}
