//! Reads a chunk from its bytes, one column at a time.

use super::chunk_codec::{self, ESTIMATE, FOUND, JUMP, MULTIPLIER, PERIODS, RECORD_COLUMNS, STEPS};
use super::column_codec::{ByteColumn, CHECKSUM_BYTES, ColumnEntry, ENTRY_BYTES, entries};
use crate::control::{ChunkMeta, InstanceFacts, InstanceFlags, InstanceRecord};
use crate::observe::{Measured, Status};
use crate::plan::{Precision, Resolution};
use std::ops::Range;
use std::sync::OnceLock;

/// Reads a range of a chunk's bytes.
pub(in crate::control) type ByteSource<'a> = dyn Fn(Range<usize>) -> Result<Vec<u8>, String> + Sync + 'a;

/// Bytes before the columns.
const HEADER_AND_ENTRIES: usize = chunk_codec::HEADER_BYTES + RECORD_COLUMNS * ENTRY_BYTES + CHECKSUM_BYTES;

/// A chunk whose header was read. A column is read at first use.
pub(in crate::control) struct ChunkReader<'a> {
    source: &'a ByteSource<'a>,
    number: usize,
    count: usize,
    flags: [bool; 4],
    notes: Range<usize>,
    entries: Vec<ColumnEntry>,
    columns: Vec<OnceLock<Vec<u8>>>,
    failed: OnceLock<String>,
}

impl<'a> ChunkReader<'a> {
    /// Opens the chunk of this number and this many instances.
    ///
    /// # Errors
    /// Says why it cannot be read, or that the bytes are another chunk.
    pub fn of(source: &'a ByteSource<'a>, number: usize, count: usize) -> Result<Self, String> {
        let head = source(0..HEADER_AND_ENTRIES)?;
        let of_head = || {
            let beginning = chunk_codec::chunk_header(&head)?;
            let is_it = (beginning.number, beginning.count) == (number, count);
            let entries = is_it.then(|| entries(&head, RECORD_COLUMNS, count)).flatten()?;
            let end = HEADER_AND_ENTRIES.checked_add(entries.last()?.range.end)?;
            Some((beginning.flags, end..end.checked_add(beginning.notes)?, entries))
        };
        let (flags, notes, entries) = of_head().ok_or_else(|| damaged(number))?;
        let columns = entries.iter().map(|_| OnceLock::new()).collect();
        Ok(Self { source, number, count, flags, notes, entries, columns, failed: OnceLock::new() })
    }

    /// Length in bytes.
    pub fn length(&self) -> usize {
        self.notes.end
    }

    /// Properties of the chunk as a whole.
    pub fn meta(&self) -> Option<ChunkMeta> {
        let [whole, searched, curves, from_rest] = self.flags;
        let notes = (self.source)(self.notes.clone()).ok()?;
        let notes = chunk_codec::lines(std::str::from_utf8(&notes).ok()?.split('\n'));
        Some(ChunkMeta { whole, searched, curves, from_rest, notes })
    }

    /// Why a column could not be read.
    pub fn failure(&self) -> Option<&str> {
        self.failed.get().map(String::as_str)
    }

    /// A column, or zeros if it cannot be read; see [`ChunkReader::failure`].
    pub fn column(&self, number: usize) -> ByteColumn<'_> {
        let entry = &self.entries[number];
        if entry.is_one() {
            return entry.column(&[]);
        }
        let bytes = self.columns[number].get_or_init(|| {
            self.numbers(entry).unwrap_or_else(|why| {
                self.failed.get_or_init(|| why);
                Vec::new()
            })
        });
        if bytes.is_empty() { ByteColumn::All(0) } else { entry.column(bytes) }
    }

    /// The bytes of a column.
    fn numbers(&self, entry: &ColumnEntry) -> Result<Vec<u8>, String> {
        let bytes =
            (self.source)(HEADER_AND_ENTRIES + entry.range.start..HEADER_AND_ENTRIES + entry.range.end)?;
        if entry.is_of(&bytes) { Ok(bytes) } else { Err(damaged(self.number)) }
    }

    /// The record of an instance. None if its numbers are invalid.
    pub fn ended(&self, n: usize) -> Option<InstanceRecord> {
        chunk_codec::record(&mut (0..RECORD_COLUMNS).map(|column| self.column(column).get(n)))
    }

    /// Measurements of an instance.
    pub fn measured(&self, n: usize) -> Measured {
        Measured::of_numbers(&std::array::from_fn(|column| self.float(column, n)))
    }

    /// A number of an instance, by its column.
    pub fn float(&self, column: usize, n: usize) -> f64 {
        f64::from_bits(self.column(column).get(n))
    }

    /// All numbers of a column.
    pub fn floats(&self, column: usize) -> Vec<f64> {
        let mut all = Vec::with_capacity(self.count);
        self.column(column).each(self.count, |_, bits| all.push(f64::from_bits(bits)));
        all
    }

    /// Estimated errors, on the scale of the worst observable.
    pub fn estimates(&self) -> Vec<f64> {
        self.floats(ESTIMATE)
    }

    /// Estimated error of one instance.
    pub fn estimate(&self, n: usize) -> f64 {
        self.float(ESTIMATE, n)
    }

    /// Periods of an instance's last run.
    pub fn periods(&self, n: usize) -> u32 {
        self.column(PERIODS).get(n) as u32
    }

    /// Whether the curve jumped to this instance's state.
    pub fn jump(&self, n: usize) -> bool {
        self.column(JUMP).get(n) == 1
    }

    /// Steps per period of an instance.
    pub fn steps(&self, n: usize) -> u32 {
        self.column(STEPS).get(n) as u32
    }

    /// Steps, gaps and basis rules of all instances. None if they are invalid.
    pub fn fineness(&self) -> Option<Vec<Resolution>> {
        let columns: [ByteColumn; 5] = std::array::from_fn(|n| self.column(STEPS + n));
        (0..self.count)
            .map(|n| chunk_codec::fineness(&mut columns.iter().map(|column| column.get(n))))
            .collect()
    }

    /// Moduli of the largest multipliers of the period maps. NaN if no state was found, or time integration found it.
    pub fn multipliers(&self) -> Vec<f64> {
        let (found, mut all) = (self.column(FOUND), self.floats(MULTIPLIER));
        found.each(self.count, |n, found| {
            if found != 1 {
                all[n] = f64::NAN;
            }
        });
        all
    }

    /// Flags of each instance, and how many started from their neighbours' states. None if they are invalid.
    pub fn flags(&self, accuracy: f64) -> Option<(Vec<InstanceFlags>, usize)> {
        let mut measured = vec![false; self.count];
        for number in 0..Measured::WIDTH {
            self.column(number).each(self.count, |n, bits| measured[n] |= !f64::from_bits(bits).is_nan());
        }
        let of =
            [chunk_codec::STATUS, STEPS, ESTIMATE, chunk_codec::PRECISION, chunk_codec::NEIGHBOUR_STARTED];
        let columns = of.map(|number| self.column(number));
        let mut started = 0;
        let mark = |(n, measured): (usize, &bool)| {
            let [status, steps, estimate, double, begun] = columns.map(|column| column.get(n));
            started += usize::from(begun == 1);
            let seen = InstanceFacts {
                status: Status::ALL.into_iter().find(|one| *one as u64 == status)?,
                stepped: steps > 0,
                measured: *measured,
                estimate: f64::from_bits(estimate),
                precision: if double == 1 { Precision::F64 } else { Precision::F32 },
            };
            Some(InstanceFlags::of(seen, accuracy))
        };
        let marks = measured.iter().enumerate().map(mark).collect::<Option<_>>()?;
        Some((marks, started))
    }
}

fn damaged(number: usize) -> String {
    format!("portion {number} is not what was written any more")
}
