//! Compact values of very many instances: each distinct value is stored once, and each instance stores its number in as few
//! bytes as possible.

use std::collections::HashMap;
use std::hash::Hash;

/// An integer per instance, in zero, one, two or four bytes.
#[derive(Clone, Debug)]
pub(super) enum Codes {
    /// So many zeros.
    Zeros(usize),
    Bytes(Vec<u8>),
    Words(Vec<u16>),
    Whole(Vec<u32>),
}

impl Codes {
    /// `count` instances, all zero.
    pub fn zeros(count: usize) -> Self {
        Self::Zeros(count)
    }

    /// Number of instances.
    pub fn len(&self) -> usize {
        match self {
            Self::Zeros(count) => *count,
            Self::Bytes(all) => all.len(),
            Self::Words(all) => all.len(),
            Self::Whole(all) => all.len(),
        }
    }

    /// The integer of an instance.
    #[inline]
    pub fn get(&self, at: usize) -> u32 {
        match self {
            Self::Zeros(_) => 0,
            Self::Bytes(all) => u32::from(all[at]),
            Self::Words(all) => u32::from(all[at]),
            Self::Whole(all) => all[at],
        }
    }

    /// Replaces the integer of an instance.
    pub fn set(&mut self, at: usize, code: u32) {
        self.widen(code);
        match self {
            Self::Zeros(_) => {}
            Self::Bytes(all) => all[at] = code as u8,
            Self::Words(all) => all[at] = code as u16,
            Self::Whole(all) => all[at] = code,
        }
    }

    /// Adds an instance.
    pub fn push(&mut self, code: u32) {
        self.widen(code);
        match self {
            Self::Zeros(count) => *count += 1,
            Self::Bytes(all) => all.push(code as u8),
            Self::Words(all) => all.push(code as u16),
            Self::Whole(all) => all.push(code),
        }
    }

    /// Widens the storage for a number this large.
    fn widen(&mut self, code: u32) {
        loop {
            *self = match self {
                Self::Zeros(count) if code > 0 => Self::Bytes(vec![0; *count]),
                Self::Bytes(all) if code > u32::from(u8::MAX) => {
                    Self::Words(all.iter().map(|code| u16::from(*code)).collect())
                }
                Self::Words(all) if code > u32::from(u16::MAX) => {
                    Self::Whole(all.iter().map(|code| u32::from(*code)).collect())
                }
                _ => return,
            };
        }
    }
}

impl FromIterator<u32> for Codes {
    fn from_iter<I: IntoIterator<Item = u32>>(all: I) -> Self {
        let mut codes = Self::zeros(0);
        all.into_iter().for_each(|code| codes.push(code));
        codes
    }
}

/// A value per instance.
#[derive(Clone, Debug)]
pub(crate) struct Interned<T> {
    known: Vec<T>,
    numbers: HashMap<T, u32>,
    /// The number of the value that was put in last: neighbours mostly have the same.
    last: u32,
    codes: Codes,
}

impl<T: Copy + Eq + Hash> Interned<T> {
    /// Without instances.
    pub fn new() -> Self {
        Self { known: Vec::new(), numbers: HashMap::new(), last: 0, codes: Codes::zeros(0) }
    }

    /// The same value for `count` instances.
    pub fn of(count: usize, value: T) -> Self {
        let codes = Codes::zeros(count);
        Self { known: vec![value], numbers: HashMap::from([(value, 0)]), last: 0, codes }
    }

    fn number(&mut self, value: T) -> u32 {
        let Self { known, numbers, last, .. } = self;
        if known.get(*last as usize) != Some(&value) {
            *last = *numbers.entry(value).or_insert_with(|| {
                known.push(value);
                known.len() as u32 - 1
            });
        }
        *last
    }

    /// Adds an instance.
    pub fn push(&mut self, value: T) {
        let number = self.number(value);
        self.codes.push(number);
    }

    /// Replaces the value of an instance.
    pub fn set(&mut self, at: usize, value: T) {
        let number = self.number(value);
        self.codes.set(at, number);
    }

    /// The distinct values.
    pub fn known(&self) -> &[T] {
        &self.known
    }

    /// The value of an instance.
    #[inline]
    pub fn get(&self, at: usize) -> T {
        self.known[self.codes.get(at) as usize]
    }

    /// Number of instances.
    pub fn len(&self) -> usize {
        self.codes.len()
    }

    /// Number of distinct values.
    pub fn values(&self) -> usize {
        self.known.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn codes_are_what_was_put_in() {
        let all = [0, 0, 7, 255, 256, 65_535, 3, 65_536, u32::MAX, 0];
        for count in 0..=all.len() {
            let mut codes: Codes = all[..count].iter().copied().collect();
            assert!((0..count).map(|at| codes.get(at)).eq(all[..count].iter().copied()));
            if count > 2 {
                codes.set(2, 70_000);
                assert_eq!((codes.get(2), codes.get(0), codes.len()), (70_000, 0, count));
            }
        }
    }

    #[test]
    fn a_value_is_held_once() {
        let mut all = Interned::new();
        [5u64, 9, 5, 5, 9].into_iter().for_each(|value| all.push(value));
        all.set(0, 11);
        assert_eq!((all.values(), all.len()), (3, 5));
        assert!((0..5).map(|at| all.get(at)).eq([11, 9, 5, 5, 9]));
    }
}
