//! One of an engine's devices: its adapter and its open session.

use super::adapter::AdapterReport;
use super::errand::Errand;
use super::piece::Piece;
use super::session::{Opening, Session};
use super::{Drill, Failure, GpuError};
use crate::engine::Progress;
use std::sync::{Mutex, PoisonError};

/// The fate of a piece on a device.
pub(super) enum Fate<T> {
    /// The result of its errand.
    Done(T),
    /// The run was stopped.
    Stopped,
    Failed(Failure),
    /// The device cannot be opened.
    Closed(GpuError),
}

/// An adapter, and the session on it.
pub(super) struct Device {
    adapter: wgpu::Adapter,
    pub report: AdapterReport,
    /// Index among the engine's devices.
    place: usize,
    /// The open session, and whether it rounds strictly.
    open: Mutex<Option<(bool, Session)>>,
}

impl Device {
    pub fn new(place: usize, (adapter, report): (wgpu::Adapter, AdapterReport)) -> Self {
        Self { adapter, report, place, open: Mutex::default() }
    }

    /// Opens the device unless it is open.
    pub fn open(&self, strict: bool, drill: &Drill) -> Result<(), GpuError> {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        self.session(&mut open, strict, drill).map(|_| ())
    }

    /// Drops the session.
    pub fn close(&self) {
        *self.open.lock().unwrap_or_else(PoisonError::into_inner) = None;
    }

    fn session<'a>(
        &self,
        open: &'a mut Option<(bool, Session)>,
        strict: bool,
        drill: &Drill,
    ) -> Result<&'a Session, GpuError> {
        let (_, session) = match open.take().filter(|held| held.0 == strict) {
            Some(held) => open.insert(held),
            None if drill.keeps_shut(self.place) => {
                let (adapter, why) = (self.report.name.clone(), "as drilled".into());
                return Err(GpuError::Device { adapter, why });
            }
            None => {
                let (adapter, report) = (&self.adapter, &self.report);
                let opening = Opening { adapter, report, place: self.place, strict, edit: drill.edit };
                open.insert((strict, Session::open(&opening)?))
            }
        };
        Ok(session)
    }

    /// Runs an errand for a piece. It must not wait for the threads of the caller's pool, which may all be waiting for
    /// devices.
    pub fn step<E: Errand>(
        &self,
        errand: &E,
        (piece, tables): (&mut Piece, &E::Tables),
        (strict, drill): (bool, &Drill),
        progress: &Progress,
    ) -> Fate<E::Done> {
        let mut open = self.open.lock().unwrap_or_else(PoisonError::into_inner);
        let session = match self.session(&mut open, strict, drill) {
            Ok(session) => session,
            Err(error) => return Fate::Closed(error),
        };
        match errand.on(session, drill, (&mut *piece, tables), progress) {
            Ok(Some(done)) => Fate::Done(done),
            Ok(None) => Fate::Stopped,
            Err(failure) => {
                let failure = session.cause(failure);
                *open = None;
                piece.pace.slow_down();
                Fate::Failed(failure)
            }
        }
    }
}
