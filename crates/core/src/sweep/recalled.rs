//! What journals know of the questions that are asked once all portions have ended.

use crate::control::{
    Allowance, Answer, Question, What, allowance_from_bytes, answers_from_bytes, numbers_from_bytes,
    numbers_question, questions,
};
use crate::store::{Journal, Kind};
use std::collections::HashMap;

/// Where a record is: its journal and its number there.
type Place = (usize, usize);

/// Where the answers are.
#[derive(Debug, Default)]
pub(super) struct Recalled {
    /// The record, and which of its answers.
    answers: HashMap<Question, (Place, usize)>,
    numbers: HashMap<Question, Place>,
    pub allowance: Option<Allowance>,
}

impl Recalled {
    /// Takes up a record that is no portion.
    pub fn take(&mut self, place: Place, kind: Kind, bytes: &[u8]) {
        match kind {
            Kind::Answers => {
                let all = questions(bytes).unwrap_or_default();
                self.answers.extend(all.into_iter().enumerate().map(|(n, asked)| (asked, (place, n))));
            }
            Kind::Numbers => self.numbers.extend(numbers_question(bytes).map(|asked| (asked, place))),
            Kind::Allowance => self.allowance = allowance_from_bytes(bytes).or(self.allowance),
            Kind::Header | Kind::Portion | Kind::Unfinished => {}
        }
    }

    /// How many answers there are.
    pub fn len(&self) -> usize {
        self.answers.len() + self.numbers.len()
    }

    /// The answers to these questions.
    pub fn answers(&self, journals: &[Journal], asked: &[Question]) -> Vec<Option<Answer>> {
        let mut found: Vec<Option<Answer>> = vec![None; asked.len()];
        let of = |(n, question): (usize, &Question)| Some((*self.answers.get(question)?, n));
        let mut places: Vec<((Place, usize), usize)> = asked.iter().enumerate().filter_map(of).collect();
        places.sort_unstable();
        for of_one in places.chunk_by(|a, b| a.0.0 == b.0.0) {
            let (journal, record) = of_one[0].0.0;
            let record = journals.get(journal).and_then(|journal| journal.record(record).ok());
            let Some(all) = record.and_then(|(_, bytes)| answers_from_bytes(&bytes)) else { continue };
            for ((_, which), n) in of_one {
                found[*n] = all.get(*which).cloned();
            }
        }
        found
    }

    /// The numbers that answer a question.
    pub fn numbers(&self, journals: &[Journal], asked: &Question) -> Option<Vec<f64>> {
        let (journal, record) = *self.numbers.get(asked)?;
        let (_, bytes) = journals.get(journal)?.record(record).ok()?;
        numbers_from_bytes(&bytes)
    }

    /// The instances that an audit has redone.
    pub fn redone(&self) -> Vec<u32> {
        let truths = self.answers.keys().filter(|asked| asked.what == What::Truth);
        let mut all: Vec<u32> = truths.map(|asked| asked.instance).collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}
