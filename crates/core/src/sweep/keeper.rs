//! The journal of a run: what of its portions is known, and what it writes down.

use super::recalled::Recalled;
use super::{Error, Prepared};
use crate::control::{Allowance, Answer, Division, Keep, Portion, Question};
use crate::record::{
    allowance_to_bytes, answers_to_bytes, numbers_to_bytes, portion_from_bytes, portion_number,
    portion_to_bytes,
};
use crate::store::{Journal, Kind, RunFile};
use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::sync::{Mutex, PoisonError};

/// A share of a run: the portions whose numbers leave this rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// From 1.
    pub number: usize,
    pub of: usize,
}

impl Share {
    /// All of it.
    pub const ALL: Self = Self { number: 1, of: 1 };

    /// Whether a portion is in it.
    pub fn has(self, portion: usize) -> bool {
        portion % self.of == self.number - 1
    }
}

impl std::fmt::Display for Share {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// What a run knows of portions before it begins, and where it writes down those that end.
#[derive(Debug)]
pub struct Keeper {
    share: Share,
    /// In how many shares the portions that are known were run.
    divided: usize,
    anyway: bool,
    /// Whether what is not known is to be run.
    runs: bool,
    journals: Vec<Journal>,
    /// Of each portion that is known the journal and its record there; the last one counts.
    known: BTreeMap<usize, (usize, usize)>,
    recalled: Recalled,
    given: Option<Prepared>,
    file: Mutex<Option<RunFile>>,
    failed: Mutex<Option<Error>>,
}

impl Keeper {
    /// Of a run into `file`; what `earlier` has is gone on with, on another kind of engine only `anyway`.
    ///
    /// # Errors
    /// The journal is of another share, or spoilt.
    pub fn of_run(
        file: RunFile,
        earlier: Option<Journal>,
        share: Share,
        anyway: bool,
    ) -> Result<Self, Error> {
        if let Some(journal) = &earlier {
            let (_, of) = read_header(journal.header())?;
            if of != share {
                let what = format!("the journal is of share {of} of its run, and this is {share}");
                return Err(Error::Prepared { what });
            }
        }
        let mut keeper = Self::of_journals(earlier.into_iter().collect(), share)?;
        (keeper.runs, keeper.anyway) = (true, anyway);
        keeper.file = Mutex::new(Some(file));
        Ok(keeper)
    }

    /// Of portions that were run before, in so many shares, and are only to be put together.
    ///
    /// # Errors
    /// Journals of different runs, or spoilt ones.
    pub fn of_journals(journals: Vec<Journal>, share: Share) -> Result<Self, Error> {
        let (mut known, mut recalled, mut given) = (BTreeMap::new(), Recalled::default(), None);
        for (n, journal) in journals.iter().enumerate() {
            let (prepared, of) = read_header(journal.header())?;
            if of.of != share.of {
                let what = format!("one journal is of {} shares, another of {}", of.of, share.of);
                return Err(Error::Prepared { what });
            }
            for (r, (kind, bytes)) in journal.records().enumerate() {
                if !matches!(kind, Kind::Portion | Kind::Unfinished) {
                    recalled.take((n, r), kind, bytes);
                    continue;
                }
                let Some((number, _)) = portion_number(bytes) else { continue };
                let whole = |at: &(usize, usize)| {
                    journals[at.0].record(at.1).is_some_and(|(kind, _)| kind == Kind::Portion)
                };
                // What was not whole does not stand for what is.
                if kind == Kind::Portion || !known.get(&number).is_some_and(whole) {
                    known.insert(number, (n, r));
                }
            }
            given = given.or(Some(prepared));
        }
        Ok(Self {
            share,
            divided: share.of,
            anyway: false,
            runs: false,
            journals,
            known,
            recalled,
            given,
            file: Mutex::new(None),
            failed: Mutex::new(None),
        })
    }

    /// With what was run on another kind of engine, if `anyway` says so.
    #[must_use]
    pub fn on_any_engine(self, anyway: bool) -> Self {
        Self { anyway, ..self }
    }

    /// What the journal says that was chosen.
    pub fn prepared(&self) -> Option<&Prepared> {
        self.given.as_ref()
    }

    /// How many portions are known.
    pub fn known_portions(&self) -> usize {
        self.known
            .values()
            .filter(|at| self.record(**at).is_some_and(|(kind, _)| kind == Kind::Portion))
            .count()
    }

    /// How many answers are known to what is asked once all portions have ended: second states, audit, waveforms.
    pub fn known_answers(&self) -> usize {
        self.recalled.len()
    }

    pub(super) fn anyway(&self) -> bool {
        self.anyway
    }

    /// The share of the run.
    pub fn share(&self) -> Share {
        self.share
    }

    fn record(&self, (journal, record): (usize, usize)) -> Option<(Kind, &[u8])> {
        self.journals.get(journal)?.record(record)
    }

    /// The shares of whose portions some are neither known nor to be run.
    pub(super) fn missing_shares(&self, division: &Division) -> Vec<usize> {
        if self.runs {
            return Vec::new();
        }
        let whole = |number: &usize| {
            let (kind, bytes) = self.known.get(number).and_then(|at| self.record(*at))?;
            let fits =
                portion_number(bytes).is_some_and(|(_, count)| count == division.portion(*number).len());
            (kind == Kind::Portion && fits).then_some(())
        };
        let missing = (0..division.len()).filter(|number| whole(number).is_none());
        let mut shares: Vec<usize> = missing.map(|number| number % self.share.of + 1).collect();
        shares.sort_unstable();
        shares.dedup();
        shares
    }

    /// Begins the journal, where there is none yet.
    pub(super) fn begin(&self, prepared: &Prepared, command_line: &str) -> Result<(), Error> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        match file.as_mut() {
            Some(file) if self.journals.is_empty() => {
                Ok(file.begin(&header(prepared, self.share, command_line)?)?)
            }
            _ => Ok(()),
        }
    }

    /// Writes a record down, if there is a file for it.
    fn append(&self, kind: Kind, bytes: &[u8]) -> ControlFlow<()> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        match file.as_mut().map(|file| file.append(kind, bytes)) {
            Some(Err(error)) => {
                *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(error.into());
                ControlFlow::Break(())
            }
            _ => ControlFlow::Continue(()),
        }
    }

    /// What went wrong with the journal, if something did.
    pub(super) fn failure(&self) -> Option<Error> {
        self.failed.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// The file that it writes to, which is to be finished.
    pub fn into_file(self) -> Option<RunFile> {
        self.file.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Keep for Keeper {
    fn shares(&self) -> usize {
        self.divided
    }

    fn partly(&self) -> bool {
        self.runs && self.share.of > 1
    }

    fn wanted(&self, number: usize) -> bool {
        self.runs && self.share.has(number)
    }

    /// Bytes that tell of another number of instances are none of this portion: no memory is asked for by their word.
    fn known(&self, number: usize, instances: usize) -> Option<Portion> {
        let (_, bytes) = self.record(*self.known.get(&number)?)?;
        portion_from_bytes(bytes, instances)
    }

    fn ended(&self, number: usize, portion: &dyn Fn() -> Portion) -> ControlFlow<()> {
        let portion = portion();
        let any = |one: &crate::control::Ended| one.finished.measured.is_any();
        if !portion.whole && !portion.instances.iter().any(any) {
            return ControlFlow::Continue(());
        }
        let kind = if portion.whole { Kind::Portion } else { Kind::Unfinished };
        self.append(kind, &portion_to_bytes(number, &portion))
    }

    fn lasts(&self) -> bool {
        self.runs
    }

    fn recalled(&self, asked: &[Question]) -> Vec<Option<Answer>> {
        self.recalled.answers(&self.journals, asked)
    }

    fn answered(&self, all: &[(Question, Answer)]) -> ControlFlow<()> {
        self.append(Kind::Answers, &answers_to_bytes(all))
    }

    fn redone(&self) -> Vec<u32> {
        self.recalled.redone()
    }

    fn numbers(&self, asked: &Question) -> Option<Vec<f64>> {
        self.recalled.numbers(&self.journals, asked)
    }

    fn numbered(&self, asked: &Question, numbers: &[f64]) -> ControlFlow<()> {
        self.append(Kind::Numbers, &numbers_to_bytes(asked, numbers))
    }

    fn allowance(&self) -> Option<Allowance> {
        self.recalled.allowance
    }

    fn spent(&self, so_far: Allowance) -> ControlFlow<()> {
        self.append(Kind::Allowance, &allowance_to_bytes(so_far))
    }
}

/// The header of the journal of a share, which this command runs.
fn header(prepared: &Prepared, share: Share, command_line: &str) -> Result<String, Error> {
    let command = command_line.replace(char::is_control, " ");
    Ok(format!("# share {share}\n# by {command}\n{}", prepared.to_toml()?))
}

/// The command that a header names.
pub fn command_of(header: &str) -> &str {
    header.lines().find_map(|line| line.strip_prefix("# by ")).unwrap_or_default()
}

/// What a header says.
///
/// # Errors
/// It is of another version of the program.
pub fn read_header(text: &str) -> Result<(Prepared, Share), Error> {
    let share = || {
        let (number, of) = text.lines().next()?.strip_prefix("# share ")?.split_once('/')?;
        let (number, of) = (number.parse().ok()?, of.parse().ok()?);
        (number >= 1 && number <= of).then_some(Share { number, of })
    };
    let wrong = || Error::Prepared { what: "the header of the journal names no share".into() };
    Ok((Prepared::from_toml(text)?, share().ok_or_else(wrong)?))
}
