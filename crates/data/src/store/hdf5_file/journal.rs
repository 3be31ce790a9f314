//! The journal of a run that goes on: records one after the other, each with its length and its sums.
//!
//! A file of `MAGIC` and records. A record is its length (4 bytes, the lowest first), its kind (1), the CRC-32 of these
//! five (4), its bytes, and the CRC-32 of the five and these (4). So a record that is spoilt is passed over, and what was cut off while it was
//! written is known as such. The first record is the header.

use super::StoreError;
use super::bytes::Bytes;
use std::io::Read;
use std::ops::Range;
use std::path::Path;

/// What a journal begins with; the number is the format's.
pub(super) const MAGIC: [u8; 13] = *b"afmjournal 2\n";

/// Bytes of it before the number: what journals of all formats begin with.
const NAME: usize = 11;

/// Bytes of a record before and after its own.
pub(super) const HEAD: usize = 9;
pub(super) const TAIL: usize = 4;

/// What a record holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum RecordKind {
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

impl RecordKind {
    fn of(code: u8) -> Option<Self> {
        use RecordKind::{Allowance, Answers, Header, Numbers, Portion, Unfinished};
        let all = [Header, Portion, Unfinished, Answers, Numbers, Allowance];
        all.into_iter().find(|kind| *kind as u8 == code)
    }
}

/// A journal that was looked through; what its records hold is read where it is asked for.
#[derive(Debug)]
pub struct Journal {
    bytes: Bytes,
    header: String,
    /// Of each record its kind and where its bytes are.
    records: Vec<(RecordKind, Range<u64>)>,
    /// Bytes up to the end of its last record, and all of them.
    sound: u64,
    length: u64,
    /// Records that are spoilt.
    pub spoilt: usize,
}

impl Journal {
    /// Looks through the bytes of a file.
    ///
    /// # Errors
    /// No journal, or one whose header is spoilt: in words that follow its name.
    pub fn read(bytes: Vec<u8>) -> Result<Self, String> {
        Self::of(Bytes::Memory(bytes))
    }

    /// Looks through bytes, record after record.
    pub(super) fn of(bytes: Bytes) -> Result<Self, String> {
        let unread = |error: std::io::Error| format!("it cannot be read: {error}");
        let length = bytes.length().map_err(unread)?;
        let start = bytes.read(0..length.min(MAGIC.len() as u64)).map_err(unread)?;
        if start != MAGIC {
            return Err(match start.starts_with(&MAGIC[..NAME]) {
                true => "it is a journal of another version of the program".into(),
                false => "it is no journal of a run".into(),
            });
        }
        let (mut sound, mut spoilt) = (MAGIC.len() as u64, 0);
        let (mut records, mut header) = (Vec::new(), None);
        while let Some(Record { kind, range, own, good }) = record(&bytes, sound).map_err(unread)? {
            sound = range.end + TAIL as u64;
            match (kind, good) {
                (RecordKind::Header, true) if range.start == (MAGIC.len() + HEAD) as u64 => {
                    header = Some(own)
                }
                (RecordKind::Header, true) => {}
                (_, true) => records.push((kind, range)),
                (_, false) => spoilt += 1,
            }
        }
        let header = header.ok_or("the beginning of its journal is spoilt")?;
        let header = String::from_utf8(header).map_err(|_| "the beginning of its journal is no text")?;
        Ok(Self { bytes, header, records, sound, length, spoilt })
    }

    /// The text of its header.
    pub fn header(&self) -> &str {
        &self.header
    }

    /// The kinds of all other records in their order.
    pub fn kinds(&self) -> impl Iterator<Item = RecordKind> {
        self.records.iter().map(|(kind, _)| *kind)
    }

    /// All other records in their order, as far as they can still be read.
    pub fn records(&self) -> impl Iterator<Item = (RecordKind, Vec<u8>)> {
        (0..self.records.len()).map_while(|number| self.record(number).ok())
    }

    /// The record of this number.
    ///
    /// # Errors
    /// There is none, or it cannot be read any more, or is not what it was: in words that follow the journal's name.
    pub fn record(&self, number: usize) -> Result<(RecordKind, Vec<u8>), String> {
        let (kind, range) = self.records.get(number).ok_or("has no such record")?;
        Ok((*kind, read_again(&self.bytes, range)?))
    }

    /// At most so many of the first bytes of a record, and its kind.
    ///
    /// # Errors
    /// As [`Journal::record`].
    pub fn beginning(&self, number: usize, most: u64) -> Result<(RecordKind, Vec<u8>), String> {
        let (kind, range) = self.records.get(number).ok_or("has no such record")?;
        let bytes = self.bytes.read(range.start..range.end.min(range.start + most));
        Ok((*kind, bytes.map_err(|error| error.to_string())?))
    }

    /// Some of a record's own bytes, as they are now.
    ///
    /// # Errors
    /// There is no such record, or it has no such bytes, or they cannot be read any more.
    pub fn part(&self, number: usize, part: &Range<usize>) -> Result<Vec<u8>, String> {
        let (_, range) = self.records.get(number).ok_or("has no such record")?;
        read_part(&self.bytes, range, part)
    }

    /// Bytes at its end that are no record: what was being written when its run ended.
    pub fn torn(&self) -> u64 {
        self.length - self.sound
    }

    /// Bytes up to the end of its last record.
    pub(super) fn sound(&self) -> u64 {
        self.sound
    }
}

/// The bytes of a record that lies there, which have to be what was written.
pub(super) fn read_again(bytes: &Bytes, range: &Range<u64>) -> Result<Vec<u8>, String> {
    let at = range.start - HEAD as u64;
    match record(bytes, at).map_err(|error| error.to_string())? {
        Some(record) if record.good && record.range == *range => Ok(record.own),
        _ => Err("a record is not what was written any more".into()),
    }
}

/// Some of the bytes of a record that lies there, whatever they are.
pub(super) fn read_part(bytes: &Bytes, range: &Range<u64>, part: &Range<usize>) -> Result<Vec<u8>, String> {
    let at = |place: usize| range.start + place as u64;
    if part.start > part.end || at(part.end) > range.end {
        return Err("a record is shorter than what is asked for".into());
    }
    bytes.read(at(part.start)..at(part.end)).map_err(|error| error.to_string())
}

/// What the store needs to know of a header.
#[derive(serde::Deserialize)]
struct Beginning {
    scene: String,
}

impl Journal {
    /// The text of its scene, as the header has it.
    pub fn scene(&self) -> Option<String> {
        toml::from_str(&self.header).ok().map(|Beginning { scene }| scene)
    }
}

/// Whether a file begins as a journal does, of whatever format.
pub(super) fn is_at(path: &Path) -> bool {
    let mut start = [0; NAME];
    let read = std::fs::File::open(path).and_then(|mut file| file.read_exact(&mut start));
    read.is_ok() && start == MAGIC[..NAME]
}

/// The journal in a file.
pub(super) fn open(path: &Path) -> Result<Journal, StoreError> {
    let file = std::fs::File::open(path).map_err(|e| StoreError::io(path, "read", e))?;
    let read = Journal::of(Bytes::of_file(file));
    read.map_err(|why| StoreError::Journal { path: path.to_path_buf(), why })
}

/// A record, where its bytes are, and whether they are as they were written.
struct Record {
    kind: RecordKind,
    range: Range<u64>,
    own: Vec<u8>,
    good: bool,
}

/// The record that begins there. None where its first bytes are spoilt or its end is missing.
fn record(bytes: &Bytes, at: u64) -> std::io::Result<Option<Record>> {
    let read = |from: u64, count: u64| match bytes.read(from..from.saturating_add(count)) {
        Err(error) if error.kind() == std::io::ErrorKind::UnexpectedEof => Ok(None),
        other => other.map(Some),
    };
    let Some(head) = read(at, HEAD as u64)? else { return Ok(None) };
    let (told, sum) = head.split_at(HEAD - 4);
    if crc32fast::hash(told).to_le_bytes() != *sum {
        return Ok(None);
    }
    let length = told[..4].iter().rev().fold(0, |all, byte| all << 8 | u64::from(*byte));
    let start = at + HEAD as u64;
    let Some(mut own) = read(start, length + TAIL as u64)? else { return Ok(None) };
    let sum = own.split_off(length as usize);
    let kind = RecordKind::of(told[4]);
    let good = kind.is_some() && sum_of(told, &own) == *sum;
    Ok(Some(Record { kind: kind.unwrap_or(RecordKind::Portion), range: start..start + length, own, good }))
}

/// Where so many bytes of a record are that begins there.
pub(super) fn own(at: u64, count: usize) -> Range<u64> {
    let start = at + HEAD as u64;
    start..start + count as u64
}

/// What is written before and after the bytes of a record; none where they are too many for one.
pub(super) fn around(kind: RecordKind, own: &[u8]) -> Option<([u8; HEAD], [u8; TAIL])> {
    let mut head = [0; HEAD];
    let (told, sum) = head.split_at_mut(HEAD - 4);
    told[..4].copy_from_slice(&u32::try_from(own.len()).ok()?.to_le_bytes());
    told[4] = kind as u8;
    sum.copy_from_slice(&crc32fast::hash(told).to_le_bytes());
    let tail = sum_of(told, own);
    Some((head, tail))
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
        let records: [(RecordKind, &[u8]); 5] = [
            (RecordKind::Header, b"scene"),
            (RecordKind::Portion, b"first"),
            (RecordKind::Unfinished, b""),
            (RecordKind::Portion, b"second"),
            (RecordKind::Answers, b"third"),
        ];
        for (kind, own) in records {
            let (head, tail) = around(kind, own).expect("it is short");
            bytes.extend([&head, own, &tail].concat());
        }
        bytes
    }

    fn records(journal: &Journal) -> Vec<(RecordKind, Vec<u8>)> {
        journal.records().collect()
    }

    #[test]
    fn what_was_written_is_read() {
        let read = Journal::read(journal()).expect("it is whole");
        assert_eq!((read.header(), read.torn(), read.spoilt), ("scene", 0, 0));
        let own = |kind, text: &str| (kind, text.as_bytes().to_vec());
        let all = [
            own(RecordKind::Portion, "first"),
            own(RecordKind::Unfinished, ""),
            own(RecordKind::Portion, "second"),
        ];
        assert_eq!(records(&read)[..3], all);
        assert_eq!(records(&read)[3..], [own(RecordKind::Answers, "third")]);
    }

    /// Wherever it is cut off, the records before stay, and the rest is told.
    #[test]
    fn a_torn_end_is_dropped() {
        let (bytes, whole) = (journal(), Journal::read(journal()).expect("it is whole"));
        for end in 0..bytes.len() {
            match Journal::read(bytes[..end].to_vec()) {
                Ok(cut) => {
                    assert_eq!(cut.sound + cut.torn(), end as u64);
                    assert_eq!(records(&cut), records(&whole)[..cut.records.len()]);
                    assert_eq!(cut.spoilt, 0);
                }
                Err(_) => assert!(end < MAGIC.len() + HEAD + 5 + TAIL, "cut at {end}"),
            }
        }
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
