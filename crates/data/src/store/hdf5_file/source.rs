//! A results file that is open for reading: what it claims is not believed before it is looked at.

use super::dimension_scales::read_text;
use super::partial_file::TORN;
use super::{
    COLUMNS, Coordinate, PROVENANCE, Results, StoreError, checksums, heap_check, journal, lock, partial_path,
    share,
};
use hdf5::types::{TypeDescriptor, VarLenUnicode};
use hdf5::{Dataset, File, Group, H5Type, IndexType, IterationOrder, Location, LocationType};
use std::cell::Cell;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The first bytes of every HDF5 file written here.
const SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";
/// Deflate makes data at most this much smaller; what claims more than that of its file, alone or together with the
/// rest, is not believed, before memory is asked for it.
const LARGEST_RATIO: u64 = 1100;

/// An open results file.
pub(super) struct Source {
    pub path: PathBuf,
    pub file: File,
    /// What the file may still claim to hold, in bytes of memory.
    room: Cell<u64>,
}

impl Source {
    pub fn open(path: &Path) -> Result<Self, StoreError> {
        let own = || path.to_path_buf();
        let failed = |e| StoreError::io(path, "read", e);
        let metadata = match std::fs::metadata(path) {
            Ok(metadata) => metadata,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {
                let partial = partial_path(path);
                return Err(match partial.is_file() {
                    true => StoreError::Unfinished { path: own(), partial },
                    false => StoreError::Missing { path: own() },
                });
            }
            Err(e) => return Err(failed(e)),
        };
        let foreign = |why: &str| Err(StoreError::foreign(path, why));
        if !metadata.is_file() {
            return foreign(if metadata.is_dir() { "it is a folder" } else { "it is no ordinary file" });
        }
        let ending = |wanted: &str| path.extension().is_some_and(|extension| extension == wanted);
        let broken_off = ending("partial");
        let mut start = Vec::with_capacity(SIGNATURE.len());
        let mut stream = std::fs::File::open(path).map_err(failed)?;
        stream.by_ref().take(SIGNATURE.len() as u64).read_to_end(&mut start).map_err(failed)?;
        if lock::is_locked(&stream) {
            return Err(StoreError::InUse { path: own() });
        }
        if start != SIGNATURE {
            return match (start.is_empty(), broken_off) {
                _ if start == TORN => Err(StoreError::Partial { path: own() }),
                _ if journal::is_at(path) => Err(StoreError::Running { path: own() }),
                (true, true) => Err(StoreError::Partial { path: own() }),
                (true, false) => foreign("it is empty"),
                _ if ending("toml") => foreign("it is a scene; `afmsweep run` makes results of it"),
                _ => foreign("it is no HDF5 file"),
            };
        }
        if !heap_check::is_sound(&mut stream).map_err(failed)? {
            return Err(match broken_off {
                true => StoreError::Partial { path: own() },
                false => StoreError::damaged(path, "its texts are spoilt"),
            });
        }
        match File::open(path) {
            Ok(file) => {
                let room = Cell::new(metadata.len().saturating_mul(LARGEST_RATIO));
                Ok(Self { path: own(), file, room })
            }
            Err(_) if broken_off => Err(StoreError::Partial { path: own() }),
            Err(e) => Err(StoreError::damaged(path, e)),
        }
    }

    pub fn file_scene(&self) -> Result<String, StoreError> {
        let foreign = |why| StoreError::foreign(&self.path, why);
        let provenance = self.file.group(PROVENANCE).ok();
        let scene = provenance.and_then(|group| read_text(&group, "scene"));
        let scene = scene.ok_or_else(|| foreign("it names no scene"))?;
        if !self.file.link_exists("status") && !self.file.link_exists(share::JOURNAL) {
            return Err(foreign("it has no variable status"));
        }
        Ok(scene)
    }

    pub fn damaged(&self, why: impl std::fmt::Display) -> StoreError {
        StoreError::damaged(&self.path, why)
    }

    /// Refuses results that are not what the run wrote, as the file itself tells, or less than its scene asks for.
    pub fn verify(&self, results: &Results) -> Result<(), StoreError> {
        let names = self.attribute_names(&self.file)?;
        // Files of earlier versions have none.
        if names.iter().any(|name| name == checksums::ATTRIBUTE) {
            let written =
                read_text(&self.file, checksums::ATTRIBUTE).ok_or_else(|| self.damaged("its checksums"))?;
            if let Some(what) = checksums::misfit(&written, results) {
                return Err(StoreError::Changed { path: self.path.clone(), what });
            }
        }
        let lacking = |name: &&String| !results.variables.iter().any(|variable| variable.name == **name);
        match observables(results).iter().find(lacking) {
            Some(what) => Err(StoreError::Lacking { path: self.path.clone(), what: what.clone() }),
            None => Ok(()),
        }
    }

    /// What a group holds, in the order it was written.
    pub fn members(&self, group: &Group) -> Result<Vec<String>, StoreError> {
        let mut all = Vec::new();
        let visited = group.iter_visit_default(|name, info| {
            all.push((info.creation_order, name.to_owned()));
            Ok(())
        });
        visited.map_err(|e| self.damaged(e))?;
        Ok(by_creation(all))
    }

    /// The names of the attributes of the file or of one of its groups, in the order they were written.
    pub fn attribute_names(&self, at: &Location) -> Result<Vec<String>, StoreError> {
        let mut all = Vec::new();
        let visited = at.iter_attrs(IndexType::Name, IterationOrder::Native, |name, info| {
            all.push((info.creation_order.map(i64::from), name.to_owned()));
            Ok(())
        });
        visited.map_err(|e| self.damaged(e))?;
        Ok(by_creation(all))
    }

    pub fn dataset(&self, group: &Group, name: &str) -> Result<Dataset, StoreError> {
        let missing = || self.damaged(format_args!("{} is missing", inside(group, name)));
        if group.link_exists(name) { self.member(group, name)?.ok_or_else(missing) } else { Err(missing()) }
    }

    /// A member of a group that is a dataset. One that cannot be opened is damaged, and not to be passed over.
    pub fn member(&self, group: &Group, name: &str) -> Result<Option<Dataset>, StoreError> {
        match (group.dataset(name), group.loc_type_by_name(name)) {
            (Ok(dataset), _) => Ok(Some(dataset)),
            (_, Ok(kind)) if kind != LocationType::Dataset => Ok(None),
            _ => Err(self.damaged(format_args!("{} cannot be opened", inside(group, name)))),
        }
    }

    /// The numbers of a dataset, row-major.
    pub fn numbers<T: H5Type>(&self, dataset: &Dataset) -> Result<Vec<T>, StoreError> {
        let bytes = |shape: &[usize]| {
            let elements = shape.iter().try_fold(1u64, |n, &dim| n.checked_mul(dim as u64));
            elements.and_then(|n| n.checked_mul(size_of::<T>() as u64))
        };
        // A chunk is unpacked as a whole, however little of it is asked for.
        let chunk = dataset.chunk().map_or(Some(0), |chunk| bytes(&chunk));
        let claimed = bytes(&dataset.shape()).zip(chunk).map(|(all, chunk)| all.max(chunk));
        // What was never written takes no place in the file and as much memory as it claims.
        let left = claimed.and_then(|claimed| self.room.get().checked_sub(claimed));
        let Some(left) = left else {
            return Err(self.damaged(format_args!("{} claims more data than the file holds", dataset.name())));
        };
        self.room.set(left);
        dataset.read_raw().map_err(|e| self.damaged(format_args!("{}: {e}", dataset.name())))
    }

    pub fn column<T: H5Type>(&self, group: &Group, name: &str, length: usize) -> Result<Vec<T>, StoreError> {
        let dataset = self.dataset(group, name)?;
        let data = self.numbers(&dataset)?;
        if data.len() != length {
            return Err(self.damaged(format_args!(
                "{} has {} values, not {length}",
                dataset.name(),
                data.len()
            )));
        }
        Ok(data)
    }

    pub fn table(
        &self,
        group: &Group,
        name: &str,
        rows: usize,
        columns: usize,
    ) -> Result<Vec<Vec<f64>>, StoreError> {
        let data: Vec<f64> = self.column(group, name, rows.saturating_mul(columns))?;
        Ok(data.chunks(columns.max(1)).map(<[f64]>::to_vec).collect())
    }

    pub fn coordinate(&self, group: &Group, name: &str) -> Result<Coordinate, StoreError> {
        let dataset = self.dataset(group, name)?;
        let text = |attribute| read_text(&dataset, attribute).unwrap_or_default();
        let (words, values) = match dataset.dtype().and_then(|kind| kind.to_descriptor()) {
            Ok(TypeDescriptor::VarLenUnicode) => {
                let words: Vec<VarLenUnicode> = self.numbers(&dataset)?;
                let words: Vec<String> = words.iter().map(|word| word.as_str().to_owned()).collect();
                let places = (0..words.len()).map(|n| n as f64).collect();
                (words, places)
            }
            _ => {
                let words = text("flag_meanings").split_whitespace().map(str::to_owned).collect();
                (words, self.numbers(&dataset)?)
            }
        };
        let columns = text(COLUMNS);
        let column = |name: &str| -> Result<Coordinate, StoreError> {
            let column = self.coordinate(group, name)?;
            match column.values.len() == values.len() && column.columns.is_empty() {
                true => Ok(column),
                false => {
                    Err(self.damaged(format_args!("{} does not vary along its axis", inside(group, name))))
                }
            }
        };
        Ok(Coordinate {
            name: name.to_owned(),
            units: text("units"),
            long_name: text("long_name"),
            scene_path: text("scene_path"),
            columns: columns
                .split_whitespace()
                .filter(|one| *one != name)
                .map(column)
                .collect::<Result<_, _>>()?,
            words,
            values: values.into(),
        })
    }
}

/// A member's name as messages have it.
fn inside(group: &Group, name: &str) -> String {
    format!("{}/{name}", group.name().trim_end_matches('/'))
}

/// The observables that the scene asks for, as far as the file tells.
fn observables(results: &Results) -> Vec<String> {
    let of = |name| {
        let scene: toml::Table = results.text(name)?.parse().ok()?;
        let list = scene.get("output")?.get("observables")?.as_array()?.clone();
        Some(list.iter().filter_map(|word| word.as_str().map(str::to_owned)).collect())
    };
    ["scene_resolved", "scene"].into_iter().find_map(of).unwrap_or_default()
}

/// Names in the order of their creation, or, where another tool has lost that, by name. HDF5 is not asked to sort them:
/// the table that it makes to do so frees memory that was never its own where a group is spoilt (1.10.8).
fn by_creation(mut all: Vec<(Option<i64>, String)>) -> Vec<String> {
    all.sort();
    all.into_iter().map(|(_, name)| name).collect()
}
