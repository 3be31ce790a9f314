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

/// The columns of so many rows; none where the bytes are not theirs.
pub(super) fn read(rest: &mut Rest, width: usize, count: usize) -> Option<Vec<Vec<u64>>> {
    (0..width).map(|_| column(rest, count)).collect()
}

fn column(rest: &mut Rest, count: usize) -> Option<Vec<u64>> {
    match rest.whole(1)? as usize {
        0 => Some(vec![rest.whole(8)?; count]),
        width @ 1..=8 => {
            let bytes = rest.take(width.checked_mul(count)?)?;
            Some(bytes.chunks_exact(width).map(little).collect())
        }
        _ => None,
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

fn little(bytes: &[u8]) -> u64 {
    bytes.iter().rev().fold(0, |value, byte| value << 8 | u64::from(*byte))
}
