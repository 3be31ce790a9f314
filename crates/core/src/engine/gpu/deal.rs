//! Distributes pieces to devices: each free device takes the next piece, and a failed piece continues elsewhere.

use super::dealer::{Did, TRIES};
use super::device::Fate;
use super::errand::Errand;
use super::piece::Piece;
use super::{Failure, Gpu};
use crate::engine::{EngineError, Progress};
use crate::kernel::Rounding;
use std::collections::{HashMap, VecDeque};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// An errand in progress.
pub(super) struct Deal<'a, E: Errand> {
    gpu: &'a Gpu,
    errand: &'a E,
    progress: &'a Progress,
    /// By class: speed data of whole pieces.
    did: HashMap<usize, Vec<Did>>,
    /// Messages for the user.
    notes: Vec<String>,
}

/// The fate of a piece: its device, the time it took, and whether a failure means that the device is lost.
struct Told<T> {
    piece: Piece,
    place: usize,
    fate: Fate<T>,
    time: Duration,
    lost: bool,
}

impl<'a, E: Errand> Deal<'a, E> {
    pub fn new(gpu: &'a Gpu, errand: &'a E, progress: &'a Progress) -> Self {
        Self { gpu, errand, progress, did: HashMap::new(), notes: Vec::new() }
    }

    /// Runs all pieces to their ends. Returns messages for the user.
    ///
    /// The caller's thread alone, with its pool, makes tables and finishes results. Threads that wait for devices wait for
    /// nothing else, so that many runs may go on side by side on any number of threads.
    pub fn all(mut self, mut pieces: VecDeque<Piece>, out: &mut E::Out) -> Result<Vec<String>, EngineError> {
        let (gpu, errand, progress) = (self.gpu, self.errand, self.progress);
        let (to, from) = mpsc::channel();
        std::thread::scope(|scope| {
            let mut under_way = 0;
            loop {
                if progress.stopped() {
                    pieces.clear();
                }
                // One piece waits with its tables for the first free device.
                while under_way <= gpu.dealer.holding()
                    && let Some(piece) = pieces.pop_front()
                {
                    let tables = errand.tables(&piece);
                    let to = to.clone();
                    scope.spawn(move || {
                        // The receiver is gone if the run has ended with an error.
                        let _ = to.send(carry(gpu, errand, (piece, &tables), progress));
                    });
                    under_way += 1;
                }
                if under_way == 0 {
                    break;
                }
                let Ok(told) = from.recv() else { break };
                under_way -= 1;
                match told {
                    Ok(told) => self.take(told, &mut pieces, out),
                    Err(piece) => self.on_the_cpu(piece, out)?,
                }
            }
            self.did.values().for_each(|did| gpu.dealer.learn(did));
            Ok(self.notes)
        })
    }

    /// Handles the fate of a piece; its remainder goes to the front of the queue.
    fn take(&mut self, told: Told<E::Done>, pieces: &mut VecDeque<Piece>, out: &mut E::Out) {
        let Told { mut piece, place, fate, time, lost } = told;
        let failure = match fate {
            Fate::Stopped => return,
            Fate::Done(done) => {
                if piece.done() == 0 && piece.refused == 0 {
                    let work = piece.work(self.errand.plan());
                    self.did.entry(piece.group).or_default().push((place, work, time));
                }
                return self.errand.finish(&piece.class, done, out);
            }
            Fate::Closed(error) => {
                self.notes.push(self.gpu.without(place, &error));
                return pieces.push_front(piece);
            }
            Fate::Failed(failure) => failure,
        };
        let (who, from) = (self.gpu.who(place), piece.done());
        let count = piece.class.instances.len();
        if matches!(failure, Failure::Memory) && count > 1 {
            let note = format!("{who}{failure} with {count} instances: going on with half of them");
            self.notes.push(note);
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
        self.notes.push(format!("{who}{failure}: going on from period {from} {how}"));
        pieces.push_front(piece);
    }

    /// Runs a piece that no device can do.
    fn on_the_cpu(&mut self, piece: Piece, out: &mut E::Out) -> Result<(), EngineError> {
        if self.gpu.dealer.is_news() {
            self.notes.push(format!("going on from period {} on the CPU", piece.done()));
        }
        self.errand.on_the_cpu(&piece, Rounding::new(self.gpu.strict), self.progress, out)
    }
}

/// Leases a device for a piece and runs it there. Returns the piece if no device is left for it.
fn carry<E: Errand>(
    gpu: &Gpu,
    errand: &E,
    (mut piece, tables): (Piece, &E::Tables),
    progress: &Progress,
) -> Result<Told<E::Done>, Piece> {
    if piece.refused >= TRIES {
        return Err(piece);
    }
    let Some(place) = gpu.dealer.lease(piece.meant) else { return Err(piece) };
    let Some(device) = gpu.devices.get(place) else { return Err(piece) };
    let (begun, work) = (Instant::now(), piece.work(errand.plan()));
    // A driver's panic is a failure like others; the piece still holds its progress.
    let step = || device.step(errand, (&mut piece, tables), (gpu.strict, &gpu.drill), progress);
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
