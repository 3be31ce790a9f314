//! Rows of numbers as bytes and back, column by column: a column of one number as that, others in as few bytes as serve.

/// A row of numbers, filled from its beginning.
pub(super) struct Row<'a>(pub &'a mut [u64]);

impl Row<'_> {
    /// Puts the next ones in; what has no room is left out.
    pub fn put<const N: usize>(&mut self, numbers: [u64; N]) {
        if let Some((places, rest)) = std::mem::take(&mut self.0).split_first_chunk_mut() {
            (*places, self.0) = (numbers, rest);
        }
    }

    /// The bits of these, at most `N` of them, and as many zeros as there are fewer.
    pub fn part<const N: usize>(&mut self, numbers: &[f64]) {
        if let Some((places, rest)) = std::mem::take(&mut self.0).split_first_chunk_mut::<N>() {
            *places = [0; N];
            places.iter_mut().zip(numbers).for_each(|(place, number)| *place = number.to_bits());
            self.0 = rest;
        }
    }

    /// The same by their bits.
    pub fn floats<const N: usize>(&mut self, numbers: [f64; N]) {
        self.put(numbers.map(f64::to_bits));
    }
}

/// Writes so many rows, which `fill` fills in. `first` is the first one, from whose `varying` first columns alone the others may
/// differ.
pub(super) fn write<const W: usize>(
    bytes: &mut Vec<u8>,
    (first, varying): ([u64; W], usize),
    count: usize,
    fill: impl Fn(usize, Row),
) {
    // Most columns are of one number.
    let (mut differ, mut any, mut row) = ([0; W], [0; W], first);
    for n in 0..count {
        fill(n, Row(&mut row[..varying]));
        for column in 0..W {
            differ[column] |= row[column] ^ first[column];
            any[column] |= row[column];
        }
    }
    let width = |column: usize| match differ[column] {
        0 => 0,
        _ => (8 - any[column].leading_zeros() / 8) as usize,
    };
    let room = |column: usize| if differ[column] == 0 { 8 } else { width(column) * count };
    bytes.reserve_exact((0..W).map(|column| 1 + room(column)).sum());
    let mut places = Vec::new();
    for (column, first) in first.iter().enumerate() {
        let width = width(column);
        bytes.push(width as u8);
        if width == 0 {
            bytes.extend(first.to_le_bytes());
            continue;
        }
        places.push((column, width, bytes.len()));
        bytes.resize(bytes.len() + width * count, 0);
    }
    for n in 0..count {
        fill(n, Row(&mut row[..varying]));
        for (column, width, at) in &mut places {
            put(&mut bytes[*at..][..*width], row[*column]);
            *at += *width;
        }
    }
}

/// As many of a number's bytes as there is room for, the lowest first.
fn put(room: &mut [u8], number: u64) {
    match <&mut [u8; 8]>::try_from(&mut *room) {
        Ok(room) => *room = number.to_le_bytes(),
        Err(_) => room.copy_from_slice(&number.to_le_bytes()[..room.len()]),
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
    if let Ok(all) = bytes.try_into() {
        return u64::from_le_bytes(all);
    }
    let mut all = [0; 8];
    all[..bytes.len()].copy_from_slice(bytes);
    u64::from_le_bytes(all)
}
