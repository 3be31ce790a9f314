//! A piece's tables on a device.

use super::pack::PieceTables;
use super::session::{Job, Session};
use super::{Drill, Failure};
use wgpu::{Buffer, BufferUsages};

/// Buffers of a piece's tables.
pub(super) struct PieceBuffers {
    pub waves: Buffer,
    pub drives: Buffer,
    pub cases: Buffer,
    pub drive_of: Buffer,
    pub states: Buffer,
    pub going: Buffer,
}

impl PieceBuffers {
    pub fn new(session: &Session, drill: &Drill, tables: &PieceTables) -> Result<Self, Failure> {
        if drill.memory_for.is_some_and(|most| tables.count() as usize > most) {
            return Err(Failure::Memory);
        }
        let (read, write) = (BufferUsages::STORAGE, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        Ok(Self {
            waves: session.buffer("waves", tables.waves.bytes(), read)?,
            drives: session.buffer("drives", tables.drive_table.bytes(), read)?,
            cases: session.buffer("cases", tables.cases.bytes(), read)?,
            drive_of: session.buffer("drive_of", bytemuck::cast_slice(&tables.drive_of), read)?,
            states: session.buffer("states", tables.states.bytes(), write)?,
            going: session.buffer("going", bytemuck::cast_slice(&tables.going), write)?,
        })
    }

    /// A buffer for the parameters of dispatches.
    pub fn job(session: &Session) -> Result<Buffer, Failure> {
        session.empty("job", size_of::<Job>() as u64, BufferUsages::UNIFORM | BufferUsages::COPY_DST)
    }
}
