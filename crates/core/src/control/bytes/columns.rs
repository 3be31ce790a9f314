//! Rows of numbers as bytes and back, column by column: a column of one number as that, others in as few bytes as serve.

/// Writes so many rows. `first` is the first one, from whose `varying` first columns alone the others may differ.
pub(super) fn write<const W: usize>(
    bytes: &mut Vec<u8>,
    (first, varying): ([u64; W], usize),
    count: usize,
    row: impl Fn(usize) -> [u64; W],
) {
    // Most columns are of one number.
    let (mut differ, mut any) = ([0; W], [0; W]);
    for row in (0..count).map(&row) {
        for column in 0..varying {
            differ[column] |= row[column] ^ first[column];
            any[column] |= row[column];
        }
    }
    let columns: Vec<usize> = (0..W).filter(|column| differ[*column] != 0).collect();
    let mut varying = vec![Vec::with_capacity(count); columns.len()];
    for row in (0..count).map(&row) {
        varying.iter_mut().zip(&columns).for_each(|(values, column)| values.push(row[*column]));
    }
    let mut varying = varying.into_iter();
    for column in 0..W {
        match differ[column] {
            0 => {
                bytes.push(0);
                bytes.extend(first[column].to_le_bytes());
            }
            _ => {
                let width = (8 - any[column].leading_zeros() / 8) as usize;
                bytes.push(width as u8);
                let values = varying.next().unwrap_or_default();
                values.iter().for_each(|value| bytes.extend(&value.to_le_bytes()[..width]));
            }
        }
    }
}

/// The columns of so many rows, where they lie; none where the bytes are not theirs.
pub(super) fn read<'a>(rest: &mut Rest<'a>, width: usize, count: usize) -> Option<Vec<Column<'a>>> {
    (0..width).map(|_| Column::next(rest, count)).collect()
}

/// A column of numbers: one that all rows have, or each in so many bytes.
#[derive(Clone, Copy, Debug)]
pub(super) enum Column<'a> {
    All(u64),
    Each(usize, &'a [u8]),
}

impl<'a> Column<'a> {
    fn next(rest: &mut Rest<'a>, count: usize) -> Option<Self> {
        match rest.whole(1)? as usize {
            0 => Some(Self::All(rest.whole(8)?)),
            width @ 1..=8 => Some(Self::Each(width, rest.take(width.checked_mul(count)?)?)),
            _ => None,
        }
    }

    /// The number of a row.
    pub fn get(&self, row: usize) -> u64 {
        match *self {
            Self::All(value) => value,
            Self::Each(width, bytes) => little(&bytes[row * width..][..width]),
        }
    }
}

/// Bytes that are still to be read.
pub(super) struct Rest<'a>(pub &'a [u8]);

impl<'a> Rest<'a> {
    pub fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(taken)
    }

    /// A whole number of so many bytes.
    pub fn whole(&mut self, width: usize) -> Option<u64> {
        self.take(width).map(little)
    }
}

/// A number of at most eight bytes, the lowest first.
fn little(bytes: &[u8]) -> u64 {
    let mut all = [0; 8];
    all[..bytes.len()].copy_from_slice(bytes);
    u64::from_le_bytes(all)
}
