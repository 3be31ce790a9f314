//! Bytes that are read where they lie: in memory, in a file, in a dataset of one.

use hdf5::Dataset;
use std::fs::File;
use std::io::{Error, ErrorKind, Read, Result, Seek, SeekFrom};
use std::ops::Range;
use std::sync::{Mutex, PoisonError};

/// Where they lie.
#[derive(Debug)]
pub(super) enum Bytes {
    Memory(Vec<u8>),
    File(Mutex<File>),
    Dataset(Dataset),
}

impl Bytes {
    /// Of a file that nobody else moves about in.
    pub fn of_file(file: File) -> Self {
        Self::File(Mutex::new(file))
    }

    /// How many there are.
    pub fn length(&self) -> Result<u64> {
        match self {
            Self::Memory(bytes) => Ok(bytes.len() as u64),
            Self::File(file) => Ok(file.lock().unwrap_or_else(PoisonError::into_inner).metadata()?.len()),
            Self::Dataset(dataset) => Ok(dataset.size() as u64),
        }
    }

    /// These of them, which have to be there.
    pub fn read(&self, range: Range<u64>) -> Result<Vec<u8>> {
        let gone = || Error::from(ErrorKind::UnexpectedEof);
        let (from, to) = (range.start, range.end);
        // Before memory is asked for them.
        if to > self.length()? || from > to {
            return Err(gone());
        }
        match self {
            Self::Memory(bytes) => Ok(bytes[from as usize..to as usize].to_vec()),
            Self::File(file) => {
                let mut file = file.lock().unwrap_or_else(PoisonError::into_inner);
                let mut bytes = Vec::with_capacity((to - from) as usize);
                file.seek(SeekFrom::Start(from))?;
                file.by_ref().take(to - from).read_to_end(&mut bytes)?;
                if (bytes.len() as u64) < to - from { Err(gone()) } else { Ok(bytes) }
            }
            Self::Dataset(dataset) => {
                let read = dataset.read_slice_1d::<u8, _>(from as usize..to as usize);
                read.map(|array| array.to_vec()).map_err(|error| Error::other(error.to_string()))
            }
        }
    }
}
