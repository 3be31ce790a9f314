//! The journal of a run: its known chunks, and the file for new ones.

use super::followup_index::FollowupIndex;
use super::{Error, Recipe};
use crate::control::{
    AuditBudget, ChunkJournal, Chunking, FollowupKey, FollowupResult, answers_to_bytes, budget_to_bytes,
    numbers_to_bytes, portion_number,
};
use crate::store::{Journal, RecordKind, RunFile};
use std::collections::{BTreeMap, HashMap};
use std::ops::{ControlFlow, Range};
use std::sync::{Mutex, PoisonError};

/// A share of a run: the chunks whose numbers leave the remainder `number - 1` on division by `of`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Share {
    /// Counts from 1.
    pub number: usize,
    pub of: usize,
}

impl Share {
    /// The whole run.
    pub const ALL: Self = Self { number: 1, of: 1 };

    /// Whether the share has a chunk.
    pub fn has(self, portion: usize) -> bool {
        portion % self.of == self.number - 1
    }
}

impl std::fmt::Display for Share {
    fn fmt(&self, f: &mut std::fmt::Formatter) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

/// The chunks that a run knows before it starts, and the file to which it writes new ones.
#[derive(Debug)]
pub struct RunJournal {
    share: Share,
    /// Number of shares in which the known chunks were run.
    divided: usize,
    anyway: bool,
    /// Whether unknown chunks are to be run.
    runs: bool,
    /// First line for the header of its own journal. None if the journal exists.
    begins: Option<String>,
    journals: Vec<Journal>,
    /// Journal and record of each known chunk. Of several records the last one counts.
    chunks: BTreeMap<usize, ChunkRecord>,
    followups: FollowupIndex,
    recipe: Option<Recipe>,
    file: Mutex<Option<RunFile>>,
    /// Where the file has the chunks of this run.
    fresh: Mutex<HashMap<usize, Range<u64>>>,
    failed: Mutex<Option<Error>>,
}

/// A chunk in a journal.
#[derive(Clone, Copy, Debug)]
struct ChunkRecord {
    journal: usize,
    record: usize,
    whole: bool,
    instances: usize,
}

/// Bytes of a chunk that hold its number and its number of instances.
const CHUNK_HEADER_BYTES: u64 = 16;

impl RunJournal {
    /// Opens the journal of a run into `file`, which continues `earlier`. `anyway` allows another kind of engine.
    ///
    /// # Errors
    /// The journal belongs to another share or is damaged.
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
        let begins = earlier.is_none().then(|| format!("# share {share}"));
        let mut keeper = Self::of_journals(earlier.into_iter().collect(), share)?;
        (keeper.runs, keeper.anyway, keeper.begins) = (true, anyway, begins);
        keeper.file = Mutex::new(Some(file));
        Ok(keeper)
    }

    /// Opens journals of this many shares to join their chunks.
    ///
    /// # Errors
    /// The journals belong to different runs, or one is damaged.
    pub fn of_journals(journals: Vec<Journal>, share: Share) -> Result<Self, Error> {
        let (mut known, mut recalled, mut given) = (BTreeMap::new(), FollowupIndex::default(), None);
        for (n, journal) in journals.iter().enumerate() {
            let (prepared, of) = read_header(journal.header())?;
            if of.of != share.of {
                let what = format!("one journal is of {} shares, another of {}", of.of, share.of);
                return Err(Error::Prepared { what });
            }
            for (r, kind) in journal.kinds().enumerate() {
                if !matches!(kind, RecordKind::Portion | RecordKind::Unfinished) {
                    recalled.take((n, r), kind, &journal.record(r).map_err(unread)?.1);
                    continue;
                }
                let (_, bytes) = journal.beginning(r, CHUNK_HEADER_BYTES).map_err(unread)?;
                let Some((number, instances)) = portion_number(&bytes) else { continue };
                let whole = kind == RecordKind::Portion;
                // A partial chunk never replaces a whole one.
                if whole || !known.get(&number).is_some_and(|known: &ChunkRecord| known.whole) {
                    known.insert(number, ChunkRecord { journal: n, record: r, whole, instances });
                }
            }
            given = given.or(Some(prepared));
        }
        Ok(Self {
            share,
            divided: share.of,
            anyway: false,
            runs: false,
            begins: None,
            journals,
            chunks: known,
            followups: recalled,
            recipe: given,
            file: Mutex::new(None),
            fresh: Mutex::default(),
            failed: Mutex::new(None),
        })
    }

    /// Opens shares to join them into `file`. Its journal stores what follows: second states, audit, waveforms. An `earlier`
    /// merge of the same shares is continued.
    ///
    /// # Errors
    /// Those of [`RunJournal::of_journals`].
    pub fn of_merge(
        shares: Vec<Journal>,
        share: Share,
        (file, earlier): (RunFile, Option<Journal>),
    ) -> Result<Self, Error> {
        let mut keeper = Self::of_journals(shares, share)?;
        keeper.file = Mutex::new(Some(file));
        let first = merge_line(share.of);
        let of_them = |journal: &Journal| {
            let theirs = Recipe::from_toml(journal.header()).ok();
            let same = theirs.zip(keeper.recipe.as_ref()).is_some_and(|(a, b)| a.is_of_one_run_with(b));
            same && journal.header().lines().next() == Some(&first)
        };
        match earlier.filter(of_them) {
            None => keeper.begins = Some(first),
            Some(journal) => {
                let place = keeper.journals.len();
                for (r, kind) in journal.kinds().enumerate() {
                    let bytes = journal.record(r).map_err(unread)?.1;
                    keeper.followups.take((place, r), kind, &bytes);
                }
                keeper.journals.push(journal);
            }
        }
        Ok(keeper)
    }

    /// Sets whether results of another kind of engine are accepted.
    #[must_use]
    pub fn on_any_engine(self, anyway: bool) -> Self {
        Self { anyway, ..self }
    }

    /// The choices in the journal.
    pub fn prepared(&self) -> Option<&Recipe> {
        self.recipe.as_ref()
    }

    /// Number of whole chunks that are known.
    pub fn known_portions(&self) -> usize {
        self.chunks.values().filter(|known| known.whole).count()
    }

    /// Number of known answers to questions after the chunks: second states, audit, waveforms.
    pub fn known_answers(&self) -> usize {
        self.followups.len()
    }

    /// Number of records in the journal of a merge; 0 without one.
    pub fn known_later(&self) -> usize {
        self.journals.last().filter(|last| is_of_merge(last.header())).map_or(0, |last| last.kinds().count())
    }

    pub(super) fn anyway(&self) -> bool {
        self.anyway
    }

    /// The share of the run.
    pub fn share(&self) -> Share {
        self.share
    }

    /// The shares with chunks that are neither known nor to be run.
    pub(super) fn missing_shares(&self, division: &Chunking) -> Vec<usize> {
        if self.runs {
            return Vec::new();
        }
        let whole = |number: &usize| {
            let fits = |known: &ChunkRecord| known.instances == division.chunk(*number).len();
            self.chunks.get(number).is_some_and(|known| known.whole && fits(known))
        };
        let missing = (0..division.len()).filter(|number| !whole(number));
        let mut shares: Vec<usize> = missing.map(|number| number % self.share.of + 1).collect();
        shares.sort_unstable();
        shares.dedup();
        shares
    }

    /// Begins the journal if there is none yet.
    pub(super) fn begin(&self, prepared: &Recipe, command_line: &str) -> Result<(), Error> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        match (file.as_mut(), &self.begins) {
            (Some(file), Some(first)) => Ok(file.begin(&header(prepared, first, command_line)?)?),
            _ => Ok(()),
        }
    }

    /// Writes a record if there is a file for it.
    fn append(&self, kind: RecordKind, bytes: &[u8]) -> ControlFlow<(), Option<Range<u64>>> {
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        match file.as_mut().map(|file| file.append(kind, bytes)).transpose() {
            Ok(at) => ControlFlow::Continue(at),
            Err(error) => {
                *self.failed.lock().unwrap_or_else(PoisonError::into_inner) = Some(error.into());
                ControlFlow::Break(())
            }
        }
    }

    fn told(&self, kind: RecordKind, bytes: &[u8]) -> ControlFlow<()> {
        self.append(kind, bytes).map_continue(|_| ())
    }

    /// The error of the journal, if there was one.
    pub(super) fn failure(&self) -> Option<Error> {
        self.failed.lock().unwrap_or_else(PoisonError::into_inner).take()
    }

    /// The file it writes to, which the caller must finish.
    pub fn into_file(self) -> Option<RunFile> {
        self.file.into_inner().unwrap_or_else(PoisonError::into_inner)
    }
}

impl ChunkJournal for RunJournal {
    fn shares(&self) -> usize {
        self.divided
    }

    fn partly(&self) -> bool {
        self.runs && self.share.of > 1
    }

    fn wanted(&self, number: usize) -> bool {
        self.runs && self.share.has(number)
    }

    /// Bytes with another number of instances are not this chunk. The check keeps damaged bytes from claiming memory.
    fn known(&self, number: usize, instances: usize) -> Option<Vec<u8>> {
        let known = self.chunks.get(&number).filter(|known| known.instances == instances)?;
        self.journals.get(known.journal)?.record(known.record).ok().map(|(_, bytes)| bytes)
    }

    fn ended(&self, number: usize, whole: bool, bytes: Vec<u8>) -> ControlFlow<()> {
        let kind = if whole { RecordKind::Portion } else { RecordKind::Unfinished };
        let at = self.append(kind, &bytes)?;
        let mut fresh = self.fresh.lock().unwrap_or_else(PoisonError::into_inner);
        at.into_iter().for_each(|at| _ = fresh.insert(number, at));
        ControlFlow::Continue(())
    }

    fn bytes(&self, number: usize, range: Range<usize>) -> Result<Vec<u8>, String> {
        let fresh = self.fresh.lock().unwrap_or_else(PoisonError::into_inner).get(&number).cloned();
        if let Some(at) = fresh {
            let file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
            let read = file.as_ref().map(|file| file.appended(&at, &range));
            return read.ok_or("its file is closed")?.map_err(|error| error.to_string());
        }
        let known = self.chunks.get(&number).ok_or_else(|| format!("portion {number} is in no journal"))?;
        self.journals.get(known.journal).ok_or("a journal is missing")?.part(known.record, &range)
    }

    fn lasts(&self) -> bool {
        self.file.lock().unwrap_or_else(PoisonError::into_inner).is_some()
    }

    fn recalled(&self, asked: &[FollowupKey]) -> Vec<Option<FollowupResult>> {
        self.followups.answers(&self.journals, asked)
    }

    fn answered(&self, all: &[(FollowupKey, FollowupResult)]) -> ControlFlow<()> {
        self.told(RecordKind::Answers, &answers_to_bytes(all))
    }

    fn redone(&self) -> Vec<u32> {
        self.followups.redone()
    }

    fn numbers(&self, asked: &FollowupKey) -> Option<Vec<f64>> {
        self.followups.numbers(&self.journals, asked)
    }

    fn numbered(&self, asked: &FollowupKey, numbers: &[f64]) -> ControlFlow<()> {
        self.told(RecordKind::Numbers, &numbers_to_bytes(asked, numbers))
    }

    fn allowance(&self) -> Option<AuditBudget> {
        self.followups.allowance
    }

    fn spent(&self, so_far: AuditBudget) -> ControlFlow<()> {
        self.told(RecordKind::Allowance, &budget_to_bytes(so_far))
    }
}

fn unread(what: String) -> Error {
    Error::Prepared { what: format!("a journal cannot be read: {what}") }
}

/// Header of a journal that begins with this line and is written by this command.
fn header(prepared: &Recipe, first: &str, command_line: &str) -> Result<String, Error> {
    let command = command_line.replace(char::is_control, " ");
    Ok(format!("{first}\n# by {command}\n{}", prepared.to_toml()?))
}

/// First words of a merge's journal.
const MERGE: &str = "# merge of ";

fn merge_line(shares: usize) -> String {
    format!("{MERGE}{shares}")
}

/// Whether this is the header of a merge's journal.
pub fn is_of_merge(header: &str) -> bool {
    header.starts_with(MERGE)
}

/// The command in a header.
pub fn command_of(header: &str) -> &str {
    header.lines().find_map(|line| line.strip_prefix("# by ")).unwrap_or_default()
}

/// Reads a header.
///
/// # Errors
/// It was written by another version of the program, or names no share.
pub fn read_header(text: &str) -> Result<(Recipe, Share), Error> {
    let share = || {
        let (number, of) = text.lines().next()?.strip_prefix("# share ")?.split_once('/')?;
        let (number, of) = (number.parse().ok()?, of.parse().ok()?);
        (number >= 1 && number <= of).then_some(Share { number, of })
    };
    let what = match is_of_merge(text) {
        true => "it is the journal of a merge, which the same `afmsweep merge` goes on with",
        false => "the header of the journal names no share",
    };
    let wrong = || Error::Prepared { what: what.into() };
    Ok((Recipe::from_toml(text)?, share().ok_or_else(wrong)?))
}
