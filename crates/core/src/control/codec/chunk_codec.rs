//! A chunk of a run as bytes: every number by its bits, column by column.

use super::column_codec::{self, ByteReader, CodecRow};
use crate::control::{ChunkMeta, CompactOrbit, InstanceRecord};
use crate::engine::Finished;
use crate::observe::{Measured, Status};
use crate::periodic::Floquet;
use crate::plan::{BasisRule, Precision, Resolution, SectionState};

/// Number of modes in a section state.
const MODES: usize = SectionState::FREE.x.len();
/// Columns of a result with its state; of an instance; and of an instance with its search from rest.
pub(super) const STATE_COLUMNS: usize = (Measured::WIDTH + 1) + (1 + 8 + 2 * MODES);
const OWN_COLUMNS: usize = STATE_COLUMNS + 8 + 3;
pub(super) const RECORD_COLUMNS: usize = OWN_COLUMNS + STATE_COLUMNS;

// Columns of an instance. Measured quantities come first.
pub(super) const STATUS: usize = Measured::WIDTH;
pub(super) const ESTIMATE: usize = STATUS + 1;
pub(super) const PERIODS: usize = ESTIMATE + 2;
pub(super) const JUMP: usize = PERIODS + 1;
pub(super) const NEIGHBOUR_STARTED: usize = JUMP + 1;
pub(super) const PRECISION: usize = NEIGHBOUR_STARTED + 1;
pub(super) const STEPS: usize = PRECISION + 1;
pub(super) const FOUND: usize = STEPS + 5;
pub(super) const MULTIPLIER: usize = FOUND + 3;

/// Bytes before the entries of the columns.
pub(super) const HEADER_BYTES: usize = 8 + 4 + 4 + 4;

/// A chunk and its number as bytes: properties of the whole, then its instances, then its notes.
pub fn to_bytes(
    number: usize,
    about: &ChunkMeta,
    count: usize,
    instance: impl Fn(usize) -> InstanceRecord,
) -> Vec<u8> {
    let ChunkMeta { whole, searched, curves, from_rest, notes } = about;
    let mut bytes = Vec::new();
    bytes.extend((number as u64).to_le_bytes());
    bytes.extend([*whole, *searched, *curves, *from_rest].map(u8::from));
    bytes.extend((count as u32).to_le_bytes());
    let notes = lines(notes.iter().map(String::as_str)).join("\n");
    bytes.extend((notes.len() as u32).to_le_bytes());
    let mut first = [0; RECORD_COLUMNS];
    if count > 0 {
        fill(&instance(0), CodecRow(&mut first));
    }
    // Without searches from rest their columns are constant.
    let width = if *from_rest { RECORD_COLUMNS } else { OWN_COLUMNS };
    column_codec::write(&mut bytes, (first, width), count, |n, row| fill(&instance(n), row));
    bytes.extend(notes.as_bytes());
    bytes
}

/// Notes as one line each, without empty ones. A driver's message may have many lines.
pub(super) fn lines<'a>(notes: impl Iterator<Item = &'a str>) -> Vec<String> {
    let line = |note: &str| -> Vec<String> {
        note.split(['\n', '\r']).filter(|part| !part.is_empty()).map(str::to_owned).collect()
    };
    notes.map(|note| line(note).join(" ")).filter(|note| !note.is_empty()).collect()
}

/// The header of a chunk.
pub(super) struct ChunkHeader {
    pub number: usize,
    /// Whether it is whole, was searched for, has curves, and was searched for from rest.
    pub flags: [bool; 4],
    pub count: usize,
    /// Length of its notes in bytes.
    pub notes: usize,
}

/// Reads the header. None if these bytes are not that of a chunk.
pub(super) fn chunk_header(bytes: &[u8]) -> Option<ChunkHeader> {
    let mut rest = ByteReader(bytes);
    let number = usize::try_from(rest.whole(8)?).ok()?;
    let mut flag = || match rest.whole(1)? {
        value @ 0..=1 => Some(value == 1),
        _ => None,
    };
    let flags = [flag()?, flag()?, flag()?, flag()?];
    Some(ChunkHeader { number, flags, count: rest.whole(4)? as usize, notes: rest.whole(4)? as usize })
}

/// Number of the chunk in these bytes, and its number of instances.
pub fn number(bytes: &[u8]) -> Option<(usize, usize)> {
    let mut rest = ByteReader(bytes);
    let number = rest.whole(8)?;
    rest.take(4)?;
    Some((usize::try_from(number).ok()?, rest.whole(4)? as usize))
}

pub(super) fn fineness(numbers: &mut impl Iterator<Item = u64>) -> Option<Resolution> {
    let steps = u32::try_from(numbers.next()?).ok()?;
    let gap = f64::from_bits(numbers.next()?);
    Some(Resolution { steps, gap, rule: of_rule(numbers)? })
}

fn rule(one: BasisRule) -> [u64; 3] {
    match one {
        BasisRule::Shares { accuracy, resonant } => [3 * u64::from(resonant), accuracy.to_bits(), 0],
        BasisRule::Contact { rate, count, elastic, resonant } => {
            [1 + u64::from(elastic) + 3 * u64::from(resonant), rate.to_bits(), count as u64]
        }
    }
}

/// Fills a row with an instance's bits. The search from rest is left out if there is no room.
fn fill(one: &InstanceRecord, mut row: CodecRow) {
    let InstanceRecord { finished, estimate, left_out, periods, jump, .. } = one;
    let InstanceRecord { neighbour_started, precision, fineness, state, from_rest, .. } = one;
    finish(finished, &mut row);
    row.floats([*estimate, *left_out]);
    row.put([u64::from(*periods), u64::from(*jump), u64::from(*neighbour_started)]);
    row.put([u64::from(*precision == Precision::F64)]);
    row.put([u64::from(fineness.steps), fineness.gap.to_bits()]);
    row.put(rule(fineness.rule));
    let like = lever(fineness.steps, fineness.rule);
    put_orbit((state.as_ref(), like), &mut row);
    if row.0.is_empty() {
        return;
    }
    finish(from_rest.as_ref().map_or(&Finished::NOT_RUN, |rest| &rest.0), &mut row);
    put_orbit((from_rest.as_ref().map(|rest| &rest.1), like), &mut row);
}

/// Steps and basis rule as numbers.
type BasisKey = [u64; 4];

/// Key for a state that is stored on its own.
pub(super) const NO_BASIS_KEY: BasisKey = [0; 4];

fn lever(steps: u32, of: BasisRule) -> BasisKey {
    let [kind, size, count] = rule(of);
    [u64::from(steps), kind, size, count]
}

/// Exclusive or. Applied to the result and one of the two, it gives the other.
fn apart(one: BasisKey, other: BasisKey) -> BasisKey {
    std::array::from_fn(|n| one[n] ^ other[n])
}

pub(super) fn finish(one: &Finished, row: &mut CodecRow) {
    row.floats(one.measured.numbers());
    row.put([one.status as u64]);
}

/// Writes a state, or zeros if there is none. Steps and basis are stored relative to `like`, those of the instance, because
/// most states have the same.
pub(super) fn put_orbit((state, like): (Option<&CompactOrbit>, BasisKey), row: &mut CodecRow) {
    let Some(place) = state else { return row.put([0; 1 + 8 + 2 * MODES]) };
    let CompactOrbit { floquet: spectrum, steps, rule: of, .. } = place;
    let [touching, finite] = place.marks();
    row.put([true, touching, finite].map(u64::from));
    row.floats([spectrum.multiplier, spectrum.sigma_min]);
    row.put(apart(lever(*steps, *of), like));
    let (x, u) = place.numbers();
    row.part::<MODES>(x);
    row.part::<MODES>(u);
}

/// The instance with these numbers. None if they are invalid.
pub(super) fn record(numbers: &mut impl Iterator<Item = u64>) -> Option<InstanceRecord> {
    let finished = of_finished(numbers)?;
    let (estimate, left_out) = (f64::from_bits(numbers.next()?), f64::from_bits(numbers.next()?));
    let periods = u32::try_from(numbers.next()?).ok()?;
    let (jump, neighbour_started) = (numbers.next()? == 1, numbers.next()? == 1);
    let precision = if numbers.next()? == 1 { Precision::F64 } else { Precision::F32 };
    let fineness = fineness(numbers)?;
    let like = lever(fineness.steps, fineness.rule);
    let state = compact_orbit(numbers, like)?;
    let rest = of_finished(numbers)?;
    let from_rest = compact_orbit(numbers, like)?.map(|place| Box::new((rest, place)));
    Some(InstanceRecord {
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
    let resonant = kind >= 3;
    match kind {
        0 | 3 => Some(BasisRule::Shares { accuracy: size, resonant }),
        1 | 2 | 4 | 5 if count <= MODES as u64 => {
            Some(BasisRule::Contact { rate: size, count: count as usize, elastic: kind % 3 == 2, resonant })
        }
        _ => None,
    }
}

/// Reads a state, if there is one; see [`put_orbit`].
pub(super) fn compact_orbit(
    numbers: &mut impl Iterator<Item = u64>,
    like: BasisKey,
) -> Option<Option<CompactOrbit>> {
    let is_any = numbers.next()? == 1;
    let (touching, finite) = (numbers.next()? == 1, numbers.next()? == 1);
    let multiplier = f64::from_bits(numbers.next()?);
    let least_change = f64::from_bits(numbers.next()?);
    let told = [numbers.next()?, numbers.next()?, numbers.next()?, numbers.next()?];
    let [steps, rule @ ..] = apart(told, like);
    let (steps, rule) = (u32::try_from(steps).ok()?, of_rule(&mut rule.into_iter())?);
    let mut station = SectionState { touching, finite, ..SectionState::FREE };
    for place in station.x.iter_mut().chain(&mut station.u) {
        *place = f64::from_bits(numbers.next()?);
    }
    let spectrum = Floquet { multiplier, sigma_min: least_change };
    Some(is_any.then(|| CompactOrbit::new(&station, spectrum, steps, rule)))
}

#[cfg(test)]
mod tests {
    use super::super::chunk_reader::ChunkReader;
    use super::*;
    use std::ops::Range;

    /// SplitMix64 (Steele, Lea & Flood 2014).
    fn draw(state: &mut u64) -> u64 {
        *state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut mixed = *state;
        mixed = (mixed ^ (mixed >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        mixed = (mixed ^ (mixed >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        mixed ^ (mixed >> 31)
    }

    /// Any bits that the numbers of an instance can have, every kind of NaN included.
    fn any(state: &mut u64) -> InstanceRecord {
        let mut number = || f64::from_bits(draw(state));
        let mut measured = Measured { phase: number(), gap: number(), contacts: number(), ..Measured::NONE };
        measured.harmonics[3] = number();
        let mut station = SectionState::FREE;
        (station.x[1], station.u[23]) = (number(), number());
        let spectrum = Floquet { multiplier: number(), sigma_min: number() };
        let rate = number();
        let (kind, resonant) = (draw(state) % 3, draw(state).is_multiple_of(2));
        let rule = match kind {
            0 => BasisRule::Shares { accuracy: rate, resonant },
            kind => BasisRule::Contact { rate, count: 7, elastic: kind == 2, resonant },
        };
        let place = CompactOrbit::new(&station, spectrum, 64, rule);
        let finished = Finished { measured, status: Status::ALL[draw(state) as usize % 8] };
        InstanceRecord {
            finished,
            estimate: f64::NAN,
            left_out: -f64::NAN,
            periods: draw(state) as u32,
            jump: draw(state).is_multiple_of(2),
            neighbour_started: draw(state).is_multiple_of(2),
            precision: [Precision::F32, Precision::F64][draw(state) as usize % 2],
            fineness: Resolution { steps: draw(state) as u32, gap: 0.0, rule },
            state: draw(state).is_multiple_of(2).then(|| place.clone()),
            from_rest: draw(state).is_multiple_of(3).then(|| Box::new((finished, place))),
        }
    }

    fn portion(count: usize, seed: u64) -> (ChunkMeta, Vec<InstanceRecord>) {
        let mut state = seed;
        let instances = (0..count).map(|_| any(&mut state)).collect();
        let notes = vec!["a".into(), "b".into()];
        (ChunkMeta { whole: true, searched: true, curves: false, from_rest: true, notes }, instances)
    }

    fn written(number: usize, (about, instances): &(ChunkMeta, Vec<InstanceRecord>)) -> Vec<u8> {
        to_bytes(number, about, instances.len(), |n| instances[n].clone())
    }

    /// Reads a chunk from all of its bytes.
    fn read(bytes: &[u8], number: usize, count: usize) -> Option<(ChunkMeta, Vec<InstanceRecord>)> {
        let source =
            |range: Range<usize>| bytes.get(range).map(<[u8]>::to_vec).ok_or_else(|| "cut off".to_owned());
        let view = ChunkReader::of(&source, number, count).ok()?;
        let about = view.meta().filter(|_| view.length() == bytes.len())?;
        let instances = (0..count).map(|n| view.ended(n)).collect::<Option<Vec<_>>>()?;
        view.failure().is_none().then_some((about, instances))
    }

    #[test]
    fn a_portion_comes_back_by_its_bits() {
        for count in [0, 1, 2, 100] {
            let one = portion(count, count as u64);
            let bytes = written(12, &one);
            assert_eq!(number(&bytes), Some((12, count)));
            let back = read(&bytes, 12, count).expect("it is whole");
            let row = |one: &InstanceRecord| {
                let mut row = [0; RECORD_COLUMNS];
                fill(one, CodecRow(&mut row));
                row
            };
            let rows = |one: &(ChunkMeta, Vec<InstanceRecord>)| one.1.iter().map(row).collect::<Vec<_>>();
            assert_eq!((rows(&one), &one.0.notes), (rows(&back), &back.0.notes));
            assert_eq!((back.0.whole, back.0.searched, back.0.curves), (true, true, false));
            assert!(read(&bytes, 12, count + 1).is_none() && read(&bytes, 13, count).is_none());
            assert!((0..bytes.len()).all(|end| read(&bytes[..end], 12, count).is_none()));
        }
    }

    /// Flags and counts are those of the instances, and a column is read without the others.
    #[test]
    fn columns_are_read_alone() {
        let one = portion(70, 5);
        let bytes = written(3, &one);
        let read = std::sync::atomic::AtomicUsize::new(0);
        let source = |range: Range<usize>| {
            read.fetch_add(range.len(), std::sync::atomic::Ordering::Relaxed);
            bytes.get(range).map(<[u8]>::to_vec).ok_or_else(|| "cut off".to_owned())
        };
        let view = ChunkReader::of(&source, 3, 70).expect("it is whole");
        let head = read.load(std::sync::atomic::Ordering::Relaxed);
        let periods: Vec<u32> = (0..70).map(|n| view.periods(n)).collect();
        assert_eq!(periods, one.1.iter().map(|one| one.periods).collect::<Vec<_>>());
        assert_eq!(read.load(std::sync::atomic::Ordering::Relaxed), head + 4 * 70);
        let bits = |all: Vec<f64>| all.into_iter().map(f64::to_bits).collect::<Vec<_>>();
        let multiplier =
            |one: &InstanceRecord| one.state.as_ref().map_or(f64::NAN, |state| state.floquet.multiplier);
        assert_eq!(bits(view.multipliers()), bits(one.1.iter().map(multiplier).collect()));
        let (marks, started) = view.flags(0.0).expect("they are instances");
        assert_eq!(started, one.1.iter().filter(|one| one.neighbour_started).count());
        assert!(marks.iter().zip(&one.1).all(|(mark, one)| mark.precision() == one.precision));
    }

    /// A flipped bit is noticed in any column or header that is read.
    #[test]
    fn every_bit_counts() {
        let bytes = written(0, &portion(3, 2));
        let notes = 3;
        for bit in 0..8 * (bytes.len() - notes) {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            assert!(read(&damaged, 0, 3).is_none(), "bit {bit}");
        }
    }

    /// Many lines of a driver, empty ones, none: each note is one line, and stays so after any number of round trips.
    #[test]
    fn notes_come_back_one_line_each() {
        let notes = ["refused:\n\n  two\r\nthree\n", "", "\n\n", "a", "b\r"].map(str::to_owned).to_vec();
        let (about, instances) = portion(1, 3);
        let one = (ChunkMeta { notes, ..about.clone() }, instances);
        let back = read(&written(0, &one), 0, 1).expect("it is whole");
        assert_eq!(back.0.notes, ["refused:   two three", "a", "b"]);
        let again = read(&written(0, &back), 0, 1).expect("it is whole");
        assert_eq!(again.0.notes, back.0.notes);
        // Empty lines in bytes from elsewhere are no notes.
        let mut bytes = written(0, &(ChunkMeta { notes: vec!["abcd".into()], ..about }, one.1));
        let place = bytes.windows(4).position(|four| four == b"abcd").expect("it is there");
        bytes[place + 1..place + 4].fill(b'\n');
        assert_eq!(read(&bytes, 0, 1).expect("it is whole").0.notes, ["a"]);
    }

    /// Whatever the bytes are, nothing panics and nothing allocates much memory.
    #[test]
    fn damaged_bytes_are_no_portion_or_another_one() {
        let bytes = written(0, &portion(30, 1));
        let mut state = 7;
        for _ in 0..2000 {
            let mut damaged = bytes.clone();
            for _ in 0..1 + draw(&mut state) % 4 {
                let at = draw(&mut state) as usize % damaged.len();
                damaged[at] ^= 1 << (draw(&mut state) % 8);
            }
            if let Some((_, instances)) = read(&damaged, 0, 30) {
                assert_eq!(instances.len(), 30);
            }
        }
    }
}
