//! Rows of numbers as bytes, column by column, so that a column can be read alone.
//!
//! Each column has an entry: the bytes of each of its numbers (1), and the CRC-32 of all of them (8, the lowest first); or 0
//! and the number that all rows share. The CRC-32 of all bytes so far (4) follows, then the columns.

use std::ops::Range;

/// A row of numbers, filled from the start.
pub(super) struct CodecRow<'a>(pub &'a mut [u64]);

impl CodecRow<'_> {
    /// Appends these numbers if all of them fit.
    pub fn put<const N: usize>(&mut self, numbers: [u64; N]) {
        if let Some((places, rest)) = std::mem::take(&mut self.0).split_first_chunk_mut() {
            (*places, self.0) = (numbers, rest);
        }
    }

    /// Appends the bits of at most `N` numbers, then zeros up to `N`.
    pub fn part<const N: usize>(&mut self, numbers: &[f64]) {
        if let Some((places, rest)) = std::mem::take(&mut self.0).split_first_chunk_mut::<N>() {
            *places = [0; N];
            places.iter_mut().zip(numbers).for_each(|(place, number)| *place = number.to_bits());
            self.0 = rest;
        }
    }

    /// Appends numbers by their bits.
    pub fn floats<const N: usize>(&mut self, numbers: [f64; N]) {
        self.put(numbers.map(f64::to_bits));
    }
}

/// Bytes of a column's entry, and of the checksum after all entries.
pub(super) const ENTRY_BYTES: usize = 9;
pub(super) const CHECKSUM_BYTES: usize = 4;

/// Rows that are filled before their columns are read.
const TILE_ROWS: usize = 32;

/// Writes `count` rows, which `fill` provides. `first` is the first row. The others may differ from it only in the first
/// `varying` columns.
pub(super) fn write<const W: usize>(
    bytes: &mut Vec<u8>,
    (first, varying): ([u64; W], usize),
    count: usize,
    fill: impl Fn(usize, CodecRow),
) {
    let columns = columns((first, varying), count, fill);
    let at = bytes.len();
    bytes.resize(at + W * ENTRY_BYTES + CHECKSUM_BYTES, 0);
    // The last number is written whole, whatever its width.
    bytes.reserve_exact(8 + columns.iter().map(|column| 8 * column.len()).sum::<usize>());
    for (n, (column, first)) in columns.iter().zip(first).enumerate() {
        let (width, word) = match column[..] {
            [] => (0, first),
            _ => append(column, bytes),
        };
        let entry = &mut bytes[at + n * ENTRY_BYTES..][..ENTRY_BYTES];
        entry[0] = width;
        entry[1..].copy_from_slice(&word.to_le_bytes());
    }
    let end = at + W * ENTRY_BYTES;
    let sum = crc32fast::hash(&bytes[..end]).to_le_bytes();
    bytes[end..][..CHECKSUM_BYTES].copy_from_slice(&sum);
}

/// The columns of these rows. A column of one number is empty.
fn columns<const W: usize>(
    (first, varying): ([u64; W], usize),
    count: usize,
    fill: impl Fn(usize, CodecRow),
) -> Vec<Vec<u64>> {
    let mut columns = vec![Vec::new(); W];
    let mut tile = vec![first; TILE_ROWS.min(count)];
    for from in (0..count).step_by(TILE_ROWS) {
        let rows = &mut tile[..TILE_ROWS.min(count - from)];
        // Most columns have one number only.
        let mut differ = [0; W];
        for (n, row) in rows.iter_mut().enumerate() {
            fill(from + n, CodecRow(&mut row[..varying]));
            for ((differ, number), first) in differ.iter_mut().zip(&row[..varying]).zip(&first) {
                *differ |= number ^ first;
            }
        }
        for (n, column) in columns[..varying].iter_mut().enumerate() {
            match (column.is_empty(), differ[n]) {
                (true, 0) => continue,
                (true, _) => {
                    column.reserve_exact(count);
                    column.resize(from, first[n]);
                }
                (false, _) => {}
            }
            column.extend(rows.iter().map(|row| row[n]));
        }
    }
    columns
}

/// Appends numbers, each in as few bytes as suffice for all. Returns that width and their checksum.
fn append(column: &[u64], bytes: &mut Vec<u8>) -> (u8, u64) {
    let (at, any) = (bytes.len(), column.iter().fold(0, |any, number| any | number));
    let width = (8 - any.leading_zeros() / 8).max(1) as usize;
    let end = at + width * column.len();
    // Each number is written as eight bytes; the next one covers those beyond the width.
    bytes.resize(end + 8, 0);
    for (n, number) in column.iter().enumerate() {
        bytes[at + n * width..][..8].copy_from_slice(&number.to_le_bytes());
    }
    bytes.truncate(end);
    (width as u8, u64::from(crc32fast::hash(&bytes[at..])))
}

/// The entry of a column.
#[derive(Clone, Debug)]
pub(super) struct ColumnEntry {
    width: usize,
    word: u64,
    /// Range of its numbers after the entries.
    pub range: Range<usize>,
}

/// Reads the entries of columns with `count` rows. Entries and checksum end the bytes. None if the bytes are damaged.
pub(super) fn entries(bytes: &[u8], columns: usize, count: usize) -> Option<Vec<ColumnEntry>> {
    let (told, sum) = bytes.split_last_chunk::<CHECKSUM_BYTES>()?;
    if crc32fast::hash(told).to_le_bytes() != *sum {
        return None;
    }
    let mut end = 0usize;
    let entry = |bytes: &[u8]| {
        let (width, word) = (usize::from(bytes[0]), little(&bytes[1..]));
        let start = end;
        end = start.checked_add(width.checked_mul(count)?)?;
        (width <= 8).then_some(ColumnEntry { width, word, range: start..end })
    };
    told[told.len().checked_sub(columns * ENTRY_BYTES)?..].chunks_exact(ENTRY_BYTES).map(entry).collect()
}

impl ColumnEntry {
    /// Whether all rows share the number in the entry.
    pub fn is_one(&self) -> bool {
        self.width == 0
    }

    /// Whether these are the bytes that were written.
    pub fn is_of(&self, bytes: &[u8]) -> bool {
        bytes.len() == self.range.len() && (self.is_one() || u64::from(crc32fast::hash(bytes)) == self.word)
    }

    /// The column with these bytes.
    pub fn column<'a>(&self, bytes: &'a [u8]) -> ByteColumn<'a> {
        if self.is_one() { ByteColumn::All(self.word) } else { ByteColumn::Each(self.width, bytes) }
    }
}

/// Reads columns of `count` rows. `head` bytes precede the entries. Advances `bytes` past the columns. None if the bytes are
/// damaged.
pub(super) fn read<'a>(
    (bytes, head): (&mut &'a [u8], usize),
    columns: usize,
    count: usize,
) -> Option<Vec<ByteColumn<'a>>> {
    let (told, rest) = bytes.split_at_checked(head + columns * ENTRY_BYTES + CHECKSUM_BYTES)?;
    let entries = entries(told, columns, count)?;
    let end = entries.last().map_or(0, |last| last.range.end);
    let (numbers, rest) = rest.split_at_checked(end)?;
    *bytes = rest;
    let column = |entry: &ColumnEntry| {
        let own = &numbers[entry.range.clone()];
        entry.is_of(own).then(|| entry.column(own))
    };
    entries.iter().map(column).collect()
}

/// A column: one number for all rows, or numbers of a fixed width in bytes.
#[derive(Clone, Copy, Debug)]
pub(in crate::control) enum ByteColumn<'a> {
    All(u64),
    Each(usize, &'a [u8]),
}

impl ByteColumn<'_> {
    /// The number in a row.
    pub fn get(&self, row: usize) -> u64 {
        match *self {
            Self::All(value) => value,
            Self::Each(width, bytes) => little(&bytes[row * width..][..width]),
        }
    }

    /// Shows the numbers of the first `count` rows in order.
    pub fn each(&self, count: usize, mut show: impl FnMut(usize, u64)) {
        match *self {
            Self::All(value) => (0..count).for_each(|n| show(n, value)),
            Self::Each(8, bytes) => {
                let all = bytes.as_chunks::<8>().0.iter();
                all.enumerate().for_each(|(n, number)| show(n, u64::from_le_bytes(*number)));
            }
            Self::Each(width, bytes) => {
                bytes.chunks_exact(width).enumerate().for_each(|(n, number)| show(n, little(number)));
            }
        }
    }
}

/// Bytes still to be read.
pub(super) struct ByteReader<'a>(pub &'a [u8]);

impl<'a> ByteReader<'a> {
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    /// An unsigned integer of `width` bytes.
    pub fn whole(&mut self, width: usize) -> Option<u64> {
        self.take(width).map(little)
    }
}

/// Reads at most eight bytes as an integer, the lowest first.
fn little(bytes: &[u8]) -> u64 {
    if let Ok(all) = bytes.try_into() {
        return u64::from_le_bytes(all);
    }
    let mut all = [0; 8];
    all[..bytes.len()].copy_from_slice(bytes);
    u64::from_le_bytes(all)
}
