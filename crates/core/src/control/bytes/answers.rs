//! What was asked of single instances after the run, and its answers, as bytes and back.

use super::columns::{self, Column, Rest, Row};
use super::portion::{ALONE, STATE, finish, of_finished, place, stand};
use crate::control::{Allowance, Answer, Question, What};

/// Numbers of a question, and of it with its answer.
const ASKED: usize = 3;
const WIDTH: usize = ASKED + STATE;

/// Bytes that tell how many there are.
const COUNT: usize = 4;

/// Answers as bytes.
pub fn to_bytes(all: &[(Question, Answer)]) -> Vec<u8> {
    let mut bytes = (all.len() as u32).to_le_bytes().to_vec();
    let mut first = [0; WIDTH];
    all.iter().take(1).for_each(|one| fill(one, Row(&mut first)));
    columns::write(&mut bytes, (first, WIDTH), all.len(), |n, row| fill(&all[n], row));
    bytes
}

fn fill((question, answer): &(Question, Answer), mut row: Row) {
    row.put([question.what as u64, u64::from(question.instance), question.from]);
    finish(&answer.finished, &mut row);
    stand((answer.place.as_deref(), ALONE), &mut row);
}

/// The questions whose answers the bytes hold.
pub fn questions(bytes: &[u8]) -> Option<Vec<Question>> {
    let (columns, count) = columns(bytes)?;
    (0..count).map(|n| asked(columns[0].get(n), columns[1].get(n), columns[2].get(n))).collect()
}

/// The columns of answers, and how many answers there are; none where the bytes are no answers.
fn columns(mut bytes: &[u8]) -> Option<(Vec<Column<'_>>, usize)> {
    let count = Rest(bytes).whole(COUNT)? as usize;
    let columns = columns::read((&mut bytes, COUNT), WIDTH, count)?;
    // Where all numbers are the same, the bytes do not tell how many there could be.
    let same = columns.iter().all(|column| matches!(column, Column::All(_)));
    (bytes.is_empty() && !(same && count > 1)).then_some((columns, count))
}

fn asked(what: u64, instance: u64, from: u64) -> Option<Question> {
    let what = What::ALL.into_iter().find(|one| *one as u64 == what)?;
    Some(Question { what, instance: u32::try_from(instance).ok()?, from })
}

/// The answers that the bytes hold, in the order of their questions.
pub fn from_bytes(bytes: &[u8]) -> Option<Vec<Answer>> {
    let (columns, count) = columns(bytes)?;
    let one = |n: usize| {
        let mut numbers = columns[ASKED..].iter().map(|column| column.get(n));
        let finished = of_finished(&mut numbers)?;
        Some(Answer { finished, place: place(&mut numbers, ALONE)?.map(Box::new) })
    };
    (0..count).map(one).collect()
}

/// Numbers that answer a question, as bytes.
pub fn numbers_to_bytes(question: &Question, numbers: &[f64]) -> Vec<u8> {
    let mut bytes = vec![question.what as u8];
    bytes.extend(question.instance.to_le_bytes());
    bytes.extend(question.from.to_le_bytes());
    numbers.iter().for_each(|number| bytes.extend(number.to_le_bytes()));
    bytes
}

/// A question, and the bytes of the numbers that answer it.
fn parted(bytes: &[u8]) -> Option<(Question, &[u8])> {
    let mut rest = Rest(bytes);
    let question = asked(rest.whole(1)?, rest.whole(4)?, rest.whole(8)?)?;
    Some((question, rest.0))
}

/// The question that the bytes of numbers answer.
pub fn numbers_question(bytes: &[u8]) -> Option<Question> {
    parted(bytes).map(|(question, _)| question)
}

/// The numbers.
pub fn numbers_from_bytes(bytes: &[u8]) -> Option<Vec<f64>> {
    let (whole, rest) = parted(bytes)?.1.as_chunks::<8>();
    rest.is_empty().then(|| whole.iter().map(|number| f64::from_le_bytes(*number)).collect())
}

/// An audit's time as bytes.
pub fn allowance_to_bytes(Allowance { limit, spent }: Allowance) -> Vec<u8> {
    [limit, spent].iter().flat_map(|seconds| seconds.to_le_bytes()).collect()
}

/// An audit's time from its bytes; none where it is no time.
pub fn allowance_from_bytes(bytes: &[u8]) -> Option<Allowance> {
    let (limit, spent) = bytes.split_first_chunk::<8>()?;
    let (limit, spent) = (f64::from_le_bytes(*limit), f64::from_le_bytes(spent.try_into().ok()?));
    let is_time = |seconds: f64| (0.0..1e12).contains(&seconds);
    (is_time(limit) && is_time(spent)).then_some(Allowance { limit, spent })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::control::Place;
    use crate::engine::Finished;
    use crate::observe::{Measured, Status};
    use crate::periodic::Spectrum;
    use crate::plan::{BasisRule, Station};

    fn some() -> Vec<(Question, Answer)> {
        let mut station = Station::FREE;
        (station.x[1], station.u[2]) = (-1e-9, f64::MIN_POSITIVE);
        let spectrum = Spectrum { multiplier: 0.5, least_change: f64::NAN };
        let place = Place::new(&station, spectrum, 128, BasisRule::Contact { rate: 1e6, count: 4 });
        let one = |n: u32| {
            let question = Question {
                what: What::ALL[n as usize % 3],
                instance: n * n,
                from: u64::MAX / u64::from(n + 1),
            };
            let measured = Measured { phase: -0.0, gap: f64::from(n), ..Measured::NONE };
            let place = n.is_multiple_of(2).then(|| Box::new(place.clone()));
            (question, Answer { finished: Finished { measured, status: Status::Sensitive }, place })
        };
        (0..5).map(one).collect()
    }

    #[test]
    fn answers_come_back_by_their_bits() {
        for count in 0..=5 {
            let all = &some()[..count];
            let bytes = to_bytes(all);
            let asked: Vec<Question> = all.iter().map(|(question, _)| *question).collect();
            assert_eq!(questions(&bytes), Some(asked.clone()));
            let back: Vec<_> = asked.into_iter().zip(from_bytes(&bytes).expect("they are whole")).collect();
            let row = |one: &(Question, Answer)| {
                let mut row = [0; WIDTH];
                fill(one, Row(&mut row));
                row
            };
            assert_eq!(all.iter().map(row).collect::<Vec<_>>(), back.iter().map(row).collect::<Vec<_>>());
            assert!((0..bytes.len()).all(|end| from_bytes(&bytes[..end]).is_none()));
        }
        // More of them than there are bytes, for which no memory is asked.
        assert!(questions(&[255; 40]).is_none() && from_bytes(&[255; 40]).is_none());
    }

    #[test]
    fn numbers_and_times_come_back() {
        let question = Question { what: What::Waveforms, instance: 7, from: 1 << 63 };
        let bytes = numbers_to_bytes(&question, &[1.5, -0.0, f64::INFINITY]);
        assert_eq!(numbers_question(&bytes), Some(question));
        assert_eq!(numbers_from_bytes(&bytes), Some(vec![1.5, -0.0, f64::INFINITY]));
        assert!(numbers_from_bytes(&bytes[..20]).is_none() && numbers_question(&bytes[..12]).is_none());
        let time = Allowance { limit: 4.0, spent: 0.25 };
        assert_eq!(allowance_from_bytes(&allowance_to_bytes(time)), Some(time));
        assert!(allowance_from_bytes(&[255; 16]).is_none() && allowance_from_bytes(&[0; 15]).is_none());
    }
}
