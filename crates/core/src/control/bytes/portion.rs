//! A portion of a run as bytes and back: every number by its bits, column by column.

use super::columns::{self, Column, Rest, Row};
use crate::control::{Ended, Place, Portion};
use crate::engine::Finished;
use crate::observe::{Measured, Status};
use crate::periodic::Spectrum;
use crate::plan::{BasisRule, Fineness, Precision, Station};
use rayon::prelude::*;

/// Modes that a station has room for.
const MODES: usize = Station::FREE.x.len();
/// Numbers of a result and its state; of an instance's own, and with what a search from rest found.
pub(super) const STATE: usize = (Measured::WIDTH + 1) + (1 + 8 + 2 * MODES);
const OWN: usize = STATE + 8 + 3;
const WIDTH: usize = OWN + STATE;

/// A portion and its number as bytes.
pub fn to_bytes(number: usize, portion: &Portion) -> Vec<u8> {
    let Portion { whole, searched, curves, from_rest, instances, notes } = portion;
    let mut bytes = Vec::new();
    bytes.extend((number as u64).to_le_bytes());
    bytes.extend([*whole, *searched, *curves, *from_rest].map(u8::from));
    bytes.extend((instances.len() as u32).to_le_bytes());
    let notes = lines(notes.iter().map(String::as_str)).join("\n");
    bytes.extend((notes.len() as u32).to_le_bytes());
    bytes.extend(notes.as_bytes());
    let mut first = [0; WIDTH];
    instances.iter().take(1).for_each(|one| fill(one, Row(&mut first)));
    // Without searches from rest their columns are the same for all.
    let rests = instances.iter().any(|one| one.from_rest.is_some());
    let width = if rests { WIDTH } else { OWN };
    columns::write(&mut bytes, (first, width), instances.len(), |n, row| fill(&instances[n], row));
    bytes
}

/// Notes as one line each, without empty ones: a driver's words may be many lines.
fn lines<'a>(notes: impl Iterator<Item = &'a str>) -> Vec<String> {
    let line = |note: &str| -> Vec<String> {
        note.split(['\n', '\r']).filter(|part| !part.is_empty()).map(str::to_owned).collect()
    };
    notes.map(|note| line(note).join(" ")).filter(|note| !note.is_empty()).collect()
}

/// The number of the portion that the bytes hold, and how many instances it has.
pub fn number(bytes: &[u8]) -> Option<(usize, usize)> {
    let mut rest = Rest(bytes);
    let number = rest.whole(8)?;
    rest.take(4)?;
    Some((usize::try_from(number).ok()?, rest.whole(4)? as usize))
}

/// A portion of so many instances from its bytes; none where they are no such portion. How many there are is the caller's to
/// know: bytes may tell of more than there is memory for.
pub fn from_bytes(bytes: &[u8], count: usize) -> Option<Portion> {
    let view = View::of(bytes, count)?;
    let instances = (0..count).into_par_iter().map(|n| view.ended(n)).collect::<Option<_>>()?;
    let View { flags: [whole, searched, curves, from_rest], notes, .. } = view;
    Some(Portion { whole, searched, curves, from_rest, instances, notes: lines(notes.split('\n')) })
}

/// A portion in its bytes: numbers are read where they are asked for.
#[derive(Debug)]
pub(in crate::control) struct View<'a> {
    /// Whether it is whole, was searched for, is of curves, was searched for from rest.
    pub flags: [bool; 4],
    notes: &'a str,
    columns: Vec<Column<'a>>,
}

/// Where numbers of an instance stand among its own.
const STATUS: usize = Measured::WIDTH;
const ESTIMATE: usize = STATUS + 1;
const LEFT_OUT: usize = ESTIMATE + 1;
const PERIODS: usize = LEFT_OUT + 1;
const JUMP: usize = PERIODS + 1;
const STEPS: usize = JUMP + 3;
const FOUND: usize = STEPS + 5;
const MULTIPLIER: usize = FOUND + 3;

impl<'a> View<'a> {
    /// Of the bytes of a portion of so many instances; none where they are no such portion.
    pub fn of(bytes: &'a [u8], count: usize) -> Option<Self> {
        let mut rest = Rest(bytes);
        rest.take(8)?;
        let mut flag = || match rest.whole(1)? {
            value @ 0..=1 => Some(value == 1),
            _ => None,
        };
        let flags = [flag()?, flag()?, flag()?, flag()?];
        // Before anything is asked for.
        if rest.whole(4)? as usize != count {
            return None;
        }
        let length = rest.whole(4)? as usize;
        let notes = std::str::from_utf8(rest.take(length)?).ok()?;
        let columns = columns::read(&mut rest, WIDTH, count)?;
        rest.0.is_empty().then_some(Self { flags, notes, columns })
    }

    /// All that is known of an instance; none where its numbers can be no instance's.
    pub fn ended(&self, n: usize) -> Option<Ended> {
        ended(&mut self.columns.iter().map(|column| column.get(n)))
    }

    /// What was measured of an instance.
    pub fn measured(&self, n: usize) -> Measured {
        Measured::of_numbers(&std::array::from_fn(|column| self.number(column, n)))
    }

    fn number(&self, column: usize, n: usize) -> f64 {
        f64::from_bits(self.columns[column].get(n))
    }

    /// Its estimated error, on the scale of the worst observable.
    pub fn estimate(&self, n: usize) -> f64 {
        self.number(ESTIMATE, n)
    }

    /// The periods of its last run.
    pub fn periods(&self, n: usize) -> u32 {
        self.columns[PERIODS].get(n) as u32
    }

    /// Whether its curve's state was not reached continuously.
    pub fn jump(&self, n: usize) -> bool {
        self.columns[JUMP].get(n) == 1
    }

    /// Its steps per period.
    pub fn steps(&self, n: usize) -> u32 {
        self.columns[STEPS].get(n) as u32
    }

    /// Its steps, gap and the rule of its basis; none where they can be no instance's.
    pub fn fineness(&self, n: usize) -> Option<Fineness> {
        fineness(&mut self.columns[STEPS..].iter().map(|column| column.get(n)))
    }

    /// The modulus of its map's largest multiplier; NaN where no state was found, or waiting found it.
    pub fn multiplier(&self, n: usize) -> f64 {
        match self.columns[FOUND].get(n) {
            1 => self.number(MULTIPLIER, n),
            _ => f64::NAN,
        }
    }
}

fn fineness(numbers: &mut impl Iterator<Item = u64>) -> Option<Fineness> {
    let steps = u32::try_from(numbers.next()?).ok()?;
    let gap = f64::from_bits(numbers.next()?);
    Some(Fineness { steps, gap, rule: of_rule(numbers)? })
}

fn rule(one: BasisRule) -> [u64; 3] {
    match one {
        BasisRule::Shares { accuracy } => [0, accuracy.to_bits(), 0],
        BasisRule::Contact { rate, count } => [1, rate.to_bits(), count as u64],
    }
}

/// An instance's numbers, by their bits: all, or its own where there is no room for more.
fn fill(one: &Ended, mut row: Row) {
    let Ended { finished, estimate, left_out, periods, jump, .. } = one;
    let Ended { neighbour_started, precision, fineness, state, from_rest, .. } = one;
    finish(finished, &mut row);
    row.floats([*estimate, *left_out]);
    row.put([u64::from(*periods), u64::from(*jump), u64::from(*neighbour_started)]);
    row.put([u64::from(*precision == Precision::F64)]);
    row.put([u64::from(fineness.steps), fineness.gap.to_bits()]);
    row.put(rule(fineness.rule));
    stand(state.as_ref(), &mut row);
    if row.0.is_empty() {
        return;
    }
    finish(from_rest.as_ref().map_or(&Finished::NOT_RUN, |rest| &rest.0), &mut row);
    stand(from_rest.as_ref().map(|rest| &rest.1), &mut row);
}

pub(super) fn finish(one: &Finished, row: &mut Row) {
    row.floats(one.measured.numbers());
    row.put([one.status as u64]);
}

/// Zeros where there is no state.
pub(super) fn stand(state: Option<&Place>, row: &mut Row) {
    let Some(place) = state else { return row.put([0; 1 + 8 + 2 * MODES]) };
    let Place { spectrum, steps, rule: of, .. } = place;
    let [touching, finite] = place.marks();
    row.put([true, touching, finite].map(u64::from));
    row.floats([spectrum.multiplier, spectrum.least_change]);
    row.put([u64::from(*steps)]);
    row.put(rule(*of));
    let (x, u) = place.numbers();
    row.part::<MODES>(x);
    row.part::<MODES>(u);
}

/// The instance that these are the numbers of; none where they can be no instance's.
fn ended(numbers: &mut impl Iterator<Item = u64>) -> Option<Ended> {
    let finished = of_finished(numbers)?;
    let (estimate, left_out) = (f64::from_bits(numbers.next()?), f64::from_bits(numbers.next()?));
    let periods = u32::try_from(numbers.next()?).ok()?;
    let (jump, neighbour_started) = (numbers.next()? == 1, numbers.next()? == 1);
    let precision = if numbers.next()? == 1 { Precision::F64 } else { Precision::F32 };
    let fineness = fineness(numbers)?;
    let state = place(numbers)?;
    let rest = of_finished(numbers)?;
    let from_rest = place(numbers)?.map(|place| Box::new((rest, place)));
    Some(Ended {
        finished,
        estimate,
        left_out,
        periods,
        jump,
        neighbour_started,
        precision,
        fineness,
        state,
        from_rest,
    })
}

pub(super) fn of_finished(numbers: &mut impl Iterator<Item = u64>) -> Option<Finished> {
    let mut all = [f64::NAN; Measured::WIDTH];
    for place in &mut all {
        *place = f64::from_bits(numbers.next()?);
    }
    let measured = Measured::of_numbers(&all);
    let code = numbers.next()?;
    let status = Status::ALL.into_iter().find(|status| *status as u64 == code)?;
    Some(Finished { measured, status })
}

fn of_rule(numbers: &mut impl Iterator<Item = u64>) -> Option<BasisRule> {
    let (kind, size, count) = (numbers.next()?, f64::from_bits(numbers.next()?), numbers.next()?);
    match kind {
        0 => Some(BasisRule::Shares { accuracy: size }),
        1 if count <= MODES as u64 => Some(BasisRule::Contact { rate: size, count: count as usize }),
        _ => None,
    }
}

/// A state, if there is one.
pub(super) fn place(numbers: &mut impl Iterator<Item = u64>) -> Option<Option<Place>> {
    let is_any = numbers.next()? == 1;
    let (touching, finite) = (numbers.next()? == 1, numbers.next()? == 1);
    let multiplier = f64::from_bits(numbers.next()?);
    let least_change = f64::from_bits(numbers.next()?);
    let steps = u32::try_from(numbers.next()?).ok()?;
    let rule = of_rule(numbers)?;
    let mut station = Station { touching, finite, ..Station::FREE };
    for place in station.x.iter_mut().chain(&mut station.u) {
        *place = f64::from_bits(numbers.next()?);
    }
    let spectrum = Spectrum { multiplier, least_change };
    Some(is_any.then(|| Place::new(&station, spectrum, steps, rule)))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// SplitMix64 (Steele, Lea & Flood 2014).
    fn draw(state: &mut u64) -> u64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = *state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Any bits that the numbers of an instance can have, NaN of every kind among them.
    fn any(state: &mut u64) -> Ended {
        let mut number = || f64::from_bits(draw(state));
        let mut measured = Measured { phase: number(), gap: number(), contacts: number(), ..Measured::NONE };
        measured.harmonics[3] = number();
        let mut station = Station::FREE;
        (station.x[1], station.u[23]) = (number(), number());
        let spectrum = Spectrum { multiplier: number(), least_change: number() };
        let rule = BasisRule::Contact { rate: number(), count: 7 };
        let place = Place::new(&station, spectrum, 64, rule);
        let finished = Finished { measured, status: Status::ALL[draw(state) as usize % 8] };
        Ended {
            finished,
            estimate: f64::NAN,
            left_out: -f64::NAN,
            periods: draw(state) as u32,
            jump: draw(state).is_multiple_of(2),
            neighbour_started: draw(state).is_multiple_of(2),
            precision: [Precision::F32, Precision::F64][draw(state) as usize % 2],
            fineness: Fineness { steps: draw(state) as u32, gap: 0.0, rule },
            state: draw(state).is_multiple_of(2).then(|| place.clone()),
            from_rest: draw(state).is_multiple_of(3).then(|| Box::new((finished, place))),
        }
    }

    fn portion(count: usize, seed: u64) -> Portion {
        let mut state = seed;
        let instances = (0..count).map(|_| any(&mut state)).collect();
        let notes = vec!["a".into(), "b".into()];
        Portion { whole: true, searched: true, curves: false, from_rest: true, instances, notes }
    }

    #[test]
    fn a_portion_comes_back_by_its_bits() {
        for count in [0, 1, 2, 100] {
            let one = portion(count, count as u64);
            let bytes = to_bytes(12, &one);
            assert_eq!(number(&bytes), Some((12, count)));
            let back = from_bytes(&bytes, count).expect("it is whole");
            let row = |one: &Ended| {
                let mut row = [0; WIDTH];
                fill(one, Row(&mut row));
                row
            };
            let rows = |one: &Portion| one.instances.iter().map(row).collect::<Vec<_>>();
            assert_eq!((rows(&one), &one.notes), (rows(&back), &back.notes));
            assert_eq!((back.whole, back.searched, back.curves), (true, true, false));
            assert!(from_bytes(&bytes, count + 1).is_none());
            assert!((0..bytes.len()).all(|end| from_bytes(&bytes[..end], count).is_none()));
        }
    }

    /// Many lines of a driver, empty ones, none: each note is one line, and the same after any number of journeys.
    #[test]
    fn notes_come_back_one_line_each() {
        let notes = ["refused:\n\n  two\r\nthree\n", "", "\n\n", "a", "b\r"].map(str::to_owned).to_vec();
        let one = Portion { notes, ..portion(1, 3) };
        let back = from_bytes(&to_bytes(0, &one), 1).expect("it is whole");
        assert_eq!(back.notes, ["refused:   two three", "a", "b"]);
        let again = from_bytes(&to_bytes(0, &back), 1).expect("it is whole");
        assert_eq!(again.notes, back.notes);
        // Empty lines in bytes that somebody else has written are no notes.
        let mut bytes = to_bytes(0, &Portion { notes: vec!["abcd".into()], ..one });
        let place = bytes.windows(4).position(|four| four == b"abcd").expect("it is there");
        bytes[place + 1..place + 4].fill(b'\n');
        assert_eq!(from_bytes(&bytes, 1).expect("it is whole").notes, ["a"]);
    }

    /// Whatever the bytes are, nothing panics and nothing large is asked for.
    #[test]
    fn damaged_bytes_are_no_portion_or_another_one() {
        let bytes = to_bytes(0, &portion(30, 1));
        let mut state = 7;
        for _ in 0..2000 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + draw(&mut state) % 4 {
                let at = draw(&mut state) as usize % damaged.len();
                damaged[at] ^= 1 << (draw(&mut state) % 8);
            }
            if let Some(read) = from_bytes(&damaged, 30) {
                assert_eq!(read.instances.len(), 30);
            }
        }
    }
}
