//! An index of the follow-up answers in journals.

use crate::control::{
    AuditBudget, FollowupKey, FollowupKind, FollowupResult, answers_from_bytes, budget_from_bytes, keys,
    numbers_from_bytes, numbers_key,
};
use crate::store::{Journal, RecordKind};
use std::collections::HashMap;

/// Number of a journal, and of a record in it.
type RecordNumber = (usize, usize);

/// Where the answers are stored.
#[derive(Debug, Default)]
pub(super) struct FollowupIndex {
    /// Record of each answer, and its place there.
    answers: HashMap<FollowupKey, (RecordNumber, usize)>,
    numbers: HashMap<FollowupKey, RecordNumber>,
    pub allowance: Option<AuditBudget>,
}

impl FollowupIndex {
    /// Adds a record that is not a chunk.
    pub fn take(&mut self, place: RecordNumber, kind: RecordKind, bytes: &[u8]) {
        match kind {
            RecordKind::Answers => {
                let all = keys(bytes).unwrap_or_default();
                self.answers.extend(all.into_iter().enumerate().map(|(n, asked)| (asked, (place, n))));
            }
            RecordKind::Numbers => self.numbers.extend(numbers_key(bytes).map(|asked| (asked, place))),
            RecordKind::Allowance => self.allowance = budget_from_bytes(bytes).or(self.allowance),
            RecordKind::Header | RecordKind::Portion | RecordKind::Unfinished => {}
        }
    }

    /// Number of answers.
    pub fn len(&self) -> usize {
        self.answers.len() + self.numbers.len()
    }

    /// The answers to these questions.
    pub fn answers(&self, journals: &[Journal], asked: &[FollowupKey]) -> Vec<Option<FollowupResult>> {
        let mut found: Vec<Option<FollowupResult>> = vec![None; asked.len()];
        let of = |(n, question): (usize, &FollowupKey)| Some((*self.answers.get(question)?, n));
        let mut places: Vec<((RecordNumber, usize), usize)> =
            asked.iter().enumerate().filter_map(of).collect();
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
    pub fn numbers(&self, journals: &[Journal], asked: &FollowupKey) -> Option<Vec<f64>> {
        let (journal, record) = *self.numbers.get(asked)?;
        let (_, bytes) = journals.get(journal)?.record(record).ok()?;
        numbers_from_bytes(&bytes)
    }

    /// The instances that an audit has redone.
    pub fn redone(&self) -> Vec<u32> {
        let truths = self.answers.keys().filter(|asked| asked.kind == FollowupKind::Truth);
        let mut all: Vec<u32> = truths.map(|asked| asked.instance).collect();
        all.sort_unstable();
        all.dedup();
        all
    }
}
