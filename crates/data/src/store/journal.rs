//! The journal of a run that goes on: records one after the other, each with its length and its sums.
//!
//! A file of `MAGIC` and records. A record is its length (4 bytes, the lowest first), its kind (1), the CRC-32 of these
//! five (4), its bytes, and the CRC-32 of the five and these (4). So a record that is spoilt is passed over, and what was cut off while it was
//! written is known as such. The first record is the header.

use super::StoreError;
use std::io::Read;
use std::ops::Range;
use std::path::Path;

/// What a journal begins with; the number is the format's.
pub(super) const MAGIC: [u8; 13] = *b"afmjournal 1\n";

/// Bytes of a record before and after its own.
const HEAD: usize = 9;
const TAIL: usize = 4;

/// What a record holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// Of which run the journal is: text.
    Header = 0,
    /// A portion that has ended.
    Portion = 1,
    /// A portion of a run that was stopped: what is known of its instances.
    Unfinished = 2,
    /// Answers to questions about single instances, asked once all portions have ended: second states, truths of an audit.
    Answers = 3,
    /// The numbers that answer one such question: waveforms.
    Numbers = 4,
    /// The time that an audit may take and has taken; the last one counts.
    Allowance = 5,
}

impl Kind {
    fn of(code: u8) -> Option<Self> {
        const ALL: [Kind; 6] =
            [Kind::Header, Kind::Portion, Kind::Unfinished, Kind::Answers, Kind::Numbers, Kind::Allowance];
        ALL.into_iter().find(|kind| *kind as u8 == code)
    }
}

/// A journal as it was read.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Journal {
    /// All of its bytes.
    bytes: Vec<u8>,
    header: Range<usize>,
    records: Vec<(Kind, Range<usize>)>,
    /// Bytes up to the end of its last record.
    sound: usize,
    /// Records that are spoilt.
    pub spoilt: usize,
}

impl Journal {
    /// Looks through the bytes of a file.
    ///
    /// # Errors
    /// No journal, or one whose header is spoilt: in words that follow its name.
    pub fn read(bytes: Vec<u8>) -> Result<Self, String> {
        if !bytes.starts_with(&MAGIC) {
            return Err(match bytes.starts_with(b"afmjournal ") {
                true => "it is a journal of another version of the program".into(),
                false => "it is no journal of a run".into(),
            });
        }
        let mut journal = Self { sound: MAGIC.len(), ..Self::default() };
        let mut headers = Vec::new();
        while let Some((kind, range, good)) = record(&bytes, journal.sound) {
            journal.sound = range.end + TAIL;
            match (kind, good) {
                (Kind::Header, true) => headers.push(range),
                (_, true) => journal.records.push((kind, range)),
                (_, false) => journal.spoilt += 1,
            }
        }
        let header = headers.into_iter().next().filter(|range| range.start == MAGIC.len() + HEAD);
        journal.header = header.ok_or("the beginning of its journal is spoilt")?;
        let text = std::str::from_utf8(&bytes[journal.header.clone()]);
        text.map_err(|_| "the beginning of its journal is no text")?;
        journal.bytes = bytes;
        Ok(journal)
    }

    /// The text of its header.
    pub fn header(&self) -> &str {
        std::str::from_utf8(&self.bytes[self.header.clone()]).unwrap_or_default()
    }

    /// All other records in their order.
    pub fn records(&self) -> impl Iterator<Item = (Kind, &[u8])> {
        self.records.iter().map(|(kind, range)| (*kind, &self.bytes[range.clone()]))
    }

    /// The record of this number.
    pub fn record(&self, number: usize) -> Option<(Kind, &[u8])> {
        self.records.get(number).map(|(kind, range)| (*kind, &self.bytes[range.clone()]))
    }

    /// Bytes at its end that are no record: what was being written when its run ended.
    pub fn torn(&self) -> usize {
        self.bytes.len() - self.sound
    }

    /// Bytes up to the end of its last record.
    pub(super) fn sound(&self) -> u64 {
        self.sound as u64
    }

    /// All of its bytes.
    pub fn bytes(&self) -> &[u8] {
        &self.bytes
    }
}

/// What the store needs to know of a header.
#[derive(serde::Deserialize)]
struct Beginning {
    scene: String,
}

impl Journal {
    /// The text of its scene, as the header has it.
    pub fn scene(&self) -> Option<String> {
        toml::from_str(self.header()).ok().map(|Beginning { scene }| scene)
    }
}

/// Whether a file begins as a journal does.
pub(super) fn is_at(path: &Path) -> bool {
    let mut start = [0; MAGIC.len()];
    std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && start == MAGIC
}

/// The journal in a file.
pub(super) fn open(path: &Path) -> Result<Journal, StoreError> {
    let bytes = std::fs::read(path).map_err(|e| StoreError::io(path, "read", e))?;
    Journal::read(bytes).map_err(|why| StoreError::Journal { path: path.to_path_buf(), why })
}

/// The record that begins there: its kind, where its bytes are, and whether they are as they were written. None where its
/// first bytes are spoilt or its end is missing.
fn record(bytes: &[u8], at: usize) -> Option<(Kind, Range<usize>, bool)> {
    let head = bytes.get(at..at.checked_add(HEAD)?)?;
    let (told, sum) = head.split_at(HEAD - 4);
    if crc32fast::hash(told).to_le_bytes() != *sum {
        return None;
    }
    let length = u32::from_le_bytes(told[..4].try_into().ok()?) as usize;
    let start = at + HEAD;
    let end = start.checked_add(length)?;
    let (own, sum) = (bytes.get(start..end)?, bytes.get(end..end.checked_add(TAIL)?)?);
    let kind = Kind::of(told[4]);
    let good = kind.is_some() && sum_of(told, own) == *sum;
    Some((kind.unwrap_or(Kind::Portion), start..end, good))
}

/// A record as it is written; none where it is too long for one.
pub(super) fn written(kind: Kind, own: &[u8]) -> Option<Vec<u8>> {
    let length = u32::try_from(own.len()).ok()?;
    let mut bytes = Vec::with_capacity(own.len() + HEAD + TAIL);
    bytes.extend(length.to_le_bytes());
    bytes.push(kind as u8);
    let sum = sum_of(&bytes, own);
    bytes.extend(crc32fast::hash(&bytes).to_le_bytes());
    bytes.extend(own);
    bytes.extend(sum);
    Some(bytes)
}

/// Of a record's bytes and of what its beginning tells of them: those of another kind do not pass for them.
fn sum_of(told: &[u8], own: &[u8]) -> [u8; 4] {
    let mut sum = crc32fast::Hasher::new();
    sum.update(told);
    sum.update(own);
    sum.finalize().to_le_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn journal() -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        let records: [(Kind, &[u8]); 5] = [
            (Kind::Header, b"scene"),
            (Kind::Portion, b"first"),
            (Kind::Unfinished, b""),
            (Kind::Portion, b"second"),
            (Kind::Answers, b"third"),
        ];
        for (kind, own) in records {
            bytes.extend(written(kind, own).expect("it is short"));
        }
        bytes
    }

    fn records(journal: &Journal) -> Vec<(Kind, Vec<u8>)> {
        journal.records().map(|(kind, bytes)| (kind, bytes.to_vec())).collect()
    }

    #[test]
    fn what_was_written_is_read() {
        let read = Journal::read(journal()).expect("it is whole");
        assert_eq!((read.header(), read.torn(), read.spoilt), ("scene", 0, 0));
        let own = |kind, text: &str| (kind, text.as_bytes().to_vec());
        let all = [own(Kind::Portion, "first"), own(Kind::Unfinished, ""), own(Kind::Portion, "second")];
        assert_eq!(records(&read)[..3], all);
        assert_eq!(records(&read)[3..], [own(Kind::Answers, "third")]);
    }

    /// Wherever it is cut off, the records before stay, and the rest is told.
    #[test]
    fn a_torn_end_is_dropped() {
        let (bytes, whole) = (journal(), Journal::read(journal()).expect("it is whole"));
        for end in 0..bytes.len() {
            match Journal::read(bytes[..end].to_vec()) {
                Ok(cut) => {
                    assert_eq!(cut.sound + cut.torn(), end);
                    assert_eq!(records(&cut), records(&whole)[..cut.records.len()]);
                    assert_eq!(cut.spoilt, 0);
                }
                Err(_) => assert!(end < MAGIC.len() + HEAD + 5 + TAIL, "cut at {end}"),
            }
        }
    }

    /// Whatever is done to its bytes, nothing but records that were written comes out, and nothing panics. FUZZ_SECONDS says
    /// for how long it is tried.
    #[test]
    fn fuzzed_bytes_are_records_that_were_written_or_none() {
        let (bytes, whole) = (journal(), Journal::read(journal()).expect("it is whole"));
        let seconds = std::env::var("FUZZ_SECONDS").ok().and_then(|text| text.parse().ok()).unwrap_or(0.2);
        let (start, mut state, mut read) = (std::time::Instant::now(), 1u64, 0u64);
        let mut draw = |below: usize| {
            // xorshift64 (Marsaglia 2003).
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state % below.max(1) as u64) as usize
        };
        while start.elapsed().as_secs_f64() < seconds {
            let mut fuzzed = bytes.clone();
            for _ in 0..=draw(6) {
                let (from, length) = (draw(fuzzed.len()), draw(24));
                let to = (from + length).min(fuzzed.len());
                match draw(5) {
                    0 => fuzzed.truncate(from),
                    1 => drop(fuzzed.drain(from..to)),
                    2 => fuzzed[from..to].fill(draw(256) as u8),
                    3 => {
                        let piece = fuzzed[from..to].to_vec();
                        let at = draw(fuzzed.len());
                        fuzzed.splice(at..at, piece);
                    }
                    _ => fuzzed.iter_mut().skip(from).take(1).for_each(|byte| *byte ^= 1 << (length % 8)),
                }
            }
            let Ok(journal) = Journal::read(fuzzed) else { continue };
            read += 1;
            assert_eq!(journal.header(), "scene");
            let all = records(&whole);
            assert!(records(&journal).iter().all(|one| all.contains(one)));
        }
        assert!(read > 0);
    }

    /// No bit that turns over goes unnoticed: it spoils a record, tears the end off, or makes it no journal.
    #[test]
    fn every_bit_counts() {
        let (bytes, whole) = (journal(), Journal::read(journal()).expect("it is whole"));
        for bit in 0..8 * bytes.len() {
            let mut damaged = bytes.clone();
            damaged[bit / 8] ^= 1 << (bit % 8);
            let Ok(read) = Journal::read(damaged) else { continue };
            assert!(read.torn() > 0 || read.spoilt > 0, "bit {bit}");
            let (ours, all) = (records(&read), records(&whole));
            assert!(ours.iter().all(|one| all.contains(one)) && ours.len() < all.len(), "bit {bit}");
        }
    }
}
