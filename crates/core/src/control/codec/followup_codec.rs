//! Follow-up questions and their answers as bytes.

use super::chunk_codec::{NO_BASIS_KEY, STATE_COLUMNS, compact_orbit, finish, of_finished, put_orbit};
use super::column_codec::{self, ByteColumn, ByteReader, CodecRow};
use crate::control::{AuditBudget, FollowupKey, FollowupKind, FollowupResult};

/// Columns of a question, and of a question with its answer.
const KEY_COLUMNS: usize = 3;
const RESULT_COLUMNS: usize = KEY_COLUMNS + STATE_COLUMNS;

/// Bytes of the number of answers.
const COUNT_BYTES: usize = 4;

/// Writes answers.
pub fn to_bytes(all: &[(FollowupKey, FollowupResult)]) -> Vec<u8> {
    let mut bytes = (all.len() as u32).to_le_bytes().to_vec();
    let mut first = [0; RESULT_COLUMNS];
    all.iter().take(1).for_each(|one| fill(one, CodecRow(&mut first)));
    column_codec::write(&mut bytes, (first, RESULT_COLUMNS), all.len(), |n, row| fill(&all[n], row));
    bytes
}

fn fill((question, answer): &(FollowupKey, FollowupResult), mut row: CodecRow) {
    row.put([question.kind as u64, u64::from(question.instance), question.from]);
    finish(&answer.finished, &mut row);
    put_orbit((answer.orbit.as_deref(), NO_BASIS_KEY), &mut row);
}

/// The questions whose answers the bytes hold.
pub fn keys(bytes: &[u8]) -> Option<Vec<FollowupKey>> {
    let (columns, count) = columns(bytes)?;
    (0..count).map(|n| asked(columns[0].get(n), columns[1].get(n), columns[2].get(n))).collect()
}

/// The columns of answers, and the number of answers. None if the bytes are invalid.
fn columns(mut bytes: &[u8]) -> Option<(Vec<ByteColumn<'_>>, usize)> {
    let count = ByteReader(bytes).whole(COUNT_BYTES)? as usize;
    let columns = column_codec::read((&mut bytes, COUNT_BYTES), RESULT_COLUMNS, count)?;
    // If all columns are constant, the bytes do not bound the count.
    let same = columns.iter().all(|column| matches!(column, ByteColumn::All(_)));
    (bytes.is_empty() && !(same && count > 1)).then_some((columns, count))
}

fn asked(what: u64, instance: u64, from: u64) -> Option<FollowupKey> {
    let what = FollowupKind::ALL.into_iter().find(|one| *one as u64 == what)?;
    Some(FollowupKey { kind: what, instance: u32::try_from(instance).ok()?, from })
}

/// The answers that the bytes hold, in the order of their questions.
pub fn from_bytes(bytes: &[u8]) -> Option<Vec<FollowupResult>> {
    let (columns, count) = columns(bytes)?;
    let one = |n: usize| {
        let mut numbers = columns[KEY_COLUMNS..].iter().map(|column| column.get(n));
        let finished = of_finished(&mut numbers)?;
        Some(FollowupResult { finished, orbit: compact_orbit(&mut numbers, NO_BASIS_KEY)?.map(Box::new) })
    };
    (0..count).map(one).collect()
}

/// Writes numbers that answer a question.
pub fn numbers_to_bytes(question: &FollowupKey, numbers: &[f64]) -> Vec<u8> {
    let mut bytes = vec![question.kind as u8];
    bytes.extend(question.instance.to_le_bytes());
    bytes.extend(question.from.to_le_bytes());
    numbers.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes
}

/// Splits the bytes into the question and the numbers that answer it.
fn parted(bytes: &[u8]) -> Option<(FollowupKey, &[u8])> {
    let mut rest = ByteReader(bytes);
    let question = asked(rest.whole(1)?, rest.whole(4)?, rest.whole(8)?)?;
    Some((question, rest.0))
}

/// The question that numbers answer.
pub fn numbers_key(bytes: &[u8]) -> Option<FollowupKey> {
    parted(bytes).map(|(question, _)| question)
}

/// The numbers.
pub fn numbers_from_bytes(bytes: &[u8]) -> Option<Vec<f64>> {
    let (whole, rest) = parted(bytes)?.1.as_chunks::<8>();
    rest.is_empty().then(|| whole.iter().map(|number| f64::from_le_bytes(*number)).collect())
}

/// Writes an audit's time.
pub fn budget_to_bytes(AuditBudget { limit, spent }: AuditBudget) -> Vec<u8> {
    [limit, spent].iter().flat_map(|seconds| seconds.to_le_bytes()).collect()
}

/// Reads an audit's time. None if it is invalid.
pub fn budget_from_bytes(bytes: &[u8]) -> Option<AuditBudget> {
    let (limit, spent) = bytes.split_first_chunk::<8>()?;
    let (limit, spent) = (f64::from_le_bytes(*limit), f64::from_le_bytes(spent.try_into().ok()?));
    let is_time = |seconds: f64| (0.0..1e12).contains(&seconds);
    (is_time(limit) && is_time(spent)).then_some(AuditBudget { limit, spent })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::CompactOrbit;
    use crate::engine::Finished;
    use crate::observe::{Measured, Status};
    use crate::periodic::Floquet;
    use crate::plan::{BasisRule, SectionState};

    fn some() -> Vec<(FollowupKey, FollowupResult)> {
        let mut station = SectionState::FREE;
        (station.x[1], station.u[2]) = (-1e-9, f64::MIN_POSITIVE);
        let spectrum = Floquet { multiplier: 0.5, sigma_min: f64::NAN };
        let place = CompactOrbit::new(
            &station,
            spectrum,
            128,
            BasisRule::Contact { rate: 1e6, count: 4, elastic: true, resonant: false },
        );
        let one = |n: u32| {
            let question = FollowupKey {
                kind: FollowupKind::ALL[n as usize % 3],
                instance: n * n,
                from: u64::MAX / u64::from(n + 1),
            };
            let measured = Measured { phase: -0.0, gap: f64::from(n), ..Measured::NONE };
            let place = n.is_multiple_of(2).then(|| Box::new(place.clone()));
            (
                question,
                FollowupResult { finished: Finished { measured, status: Status::Sensitive }, orbit: place },
            )
        };
        (0..5).map(one).collect()
    }

    #[test]
    fn answers_come_back_by_their_bits() {
        for count in 0..=5 {
            let all = &some()[..count];
            let bytes = to_bytes(all);
            let asked: Vec<FollowupKey> = all.iter().map(|(question, _)| *question).collect();
            assert_eq!(keys(&bytes), Some(asked.clone()));
            let back: Vec<_> = asked.into_iter().zip(from_bytes(&bytes).expect("they are whole")).collect();
            let row = |one: &(FollowupKey, FollowupResult)| {
                let mut row = [0; RESULT_COLUMNS];
                fill(one, CodecRow(&mut row));
                row
            };
            assert_eq!(all.iter().map(row).collect::<Vec<_>>(), back.iter().map(row).collect::<Vec<_>>());
            assert!((0..bytes.len()).all(|end| from_bytes(&bytes[..end]).is_none()));
        }
        // The count exceeds the bytes, so no memory is allocated for it.
        assert!(keys(&[255; 40]).is_none() && from_bytes(&[255; 40]).is_none());
    }

    #[test]
    fn numbers_and_times_come_back() {
        let question = FollowupKey { kind: FollowupKind::Waveforms, instance: 7, from: 1 << 63 };
        let bytes = numbers_to_bytes(&question, &[1.5, -0.0, f64::INFINITY]);
        assert_eq!(numbers_key(&bytes), Some(question));
        assert_eq!(numbers_from_bytes(&bytes), Some(vec![1.5, -0.0, f64::INFINITY]));
        assert!(numbers_from_bytes(&bytes[..20]).is_none() && numbers_key(&bytes[..12]).is_none());
        let time = AuditBudget { limit: 4.0, spent: 0.25 };
        assert_eq!(budget_from_bytes(&budget_to_bytes(time)), Some(time));
        assert!(budget_from_bytes(&[255; 16]).is_none() && budget_from_bytes(&[0; 15]).is_none());
    }
}
