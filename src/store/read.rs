//! Reads a results file back, and says clearly what is wrong with one that cannot be read.

use super::heap;
use super::labels::{is_scale, read_text};
use super::{
    Attribute, Coordinate, Flags, ForceCurve, Listed, OWN_ATTRIBUTES, Results, StoreError, Variable,
    Waveforms, partial_path,
};
use hdf5::types::TypeDescriptor;
use hdf5::{Dataset, File, Group, H5Type, IndexType, IterationOrder};
use std::io::Read;
use std::path::{Path, PathBuf};

/// The first bytes of every HDF5 file written here.
const SIGNATURE: [u8; 8] = *b"\x89HDF\r\n\x1a\n";
/// Deflate makes data at most this much smaller; a dataset that claims more than that of its file is not
/// believed, before memory is asked for it.
const LARGEST_RATIO: u64 = 1100;

/// Reads all of a results file.
pub fn read(path: &Path) -> Result<Results, StoreError> {
    let source = Source::open(path)?;
    source.file_scene()?;
    source.results()
}

/// The scene whose results a file holds.
pub(super) fn scene_of(path: &Path) -> Result<String, StoreError> {
    Source::open(path)?.file_scene()
}

/// An open results file.
struct Source {
    path: PathBuf,
    file: File,
    bytes: u64,
}

impl Source {
    fn open(path: &Path) -> Result<Self, StoreError> {
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
        if metadata.is_dir() {
            return Err(StoreError::Foreign { path: own(), why: "it is a folder".into() });
        }
        if !metadata.is_file() {
            return Err(StoreError::Foreign { path: own(), why: "it is no ordinary file".into() });
        }
        let broken_off = path.extension().is_some_and(|extension| extension == "partial");
        let mut start = Vec::with_capacity(SIGNATURE.len());
        let mut stream = std::fs::File::open(path).map_err(failed)?;
        stream.by_ref().take(SIGNATURE.len() as u64).read_to_end(&mut start).map_err(failed)?;
        if start != SIGNATURE {
            return Err(match (start.is_empty(), broken_off) {
                (true, true) => StoreError::Partial { path: own() },
                (true, false) => StoreError::Foreign { path: own(), why: "it is empty".into() },
                _ => StoreError::Foreign { path: own(), why: "it is no HDF5 file".into() },
            });
        }
        if !heap::is_sound(&mut stream).map_err(failed)? {
            return Err(match broken_off {
                true => StoreError::Partial { path: own() },
                false => StoreError::Damaged { path: own(), why: "its texts are spoilt".into() },
            });
        }
        match File::open(path) {
            Ok(file) => Ok(Self { path: own(), file, bytes: metadata.len() }),
            Err(_) if broken_off => Err(StoreError::Partial { path: own() }),
            Err(e) => Err(StoreError::Damaged { path: own(), why: e.to_string() }),
        }
    }

    fn file_scene(&self) -> Result<String, StoreError> {
        let foreign = |why: &str| StoreError::Foreign { path: self.path.clone(), why: why.into() };
        let scene = read_text(&self.file, "scene").ok_or_else(|| foreign("it names no scene"))?;
        if !self.file.link_exists("status") {
            return Err(foreign("it has no variable status"));
        }
        Ok(scene)
    }

    fn damaged(&self, why: impl std::fmt::Display) -> StoreError {
        StoreError::Damaged { path: self.path.clone(), why: why.to_string() }
    }

    /// What a group holds, in the order it was written.
    fn members(&self, group: &Group) -> Result<Vec<String>, StoreError> {
        group
            .member_names_by(IndexType::CreationOrder, IterationOrder::Increasing)
            // A file repacked by another tool may have lost that order.
            .or_else(|_| group.member_names())
            .map_err(|e| self.damaged(e))
    }

    fn dataset(&self, group: &Group, name: &str) -> Result<Dataset, StoreError> {
        group.dataset(name).map_err(|_| self.damaged(format_args!("{}/{name} is missing", group.name())))
    }

    /// The numbers of a dataset, row-major.
    fn numbers<T: H5Type>(&self, dataset: &Dataset) -> Result<Vec<T>, StoreError> {
        let elements = dataset.shape().iter().try_fold(1u64, |n, &dim| n.checked_mul(dim as u64));
        let claimed = elements.and_then(|n| n.checked_mul(size_of::<T>() as u64));
        if claimed.is_none_or(|claimed| claimed > self.bytes.saturating_mul(LARGEST_RATIO)) {
            return Err(self.damaged(format_args!("{} claims more data than the file holds", dataset.name())));
        }
        dataset.read_raw().map_err(|e| self.damaged(format_args!("{}: {e}", dataset.name())))
    }

    fn column<T: H5Type>(&self, group: &Group, name: &str, length: usize) -> Result<Vec<T>, StoreError> {
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

    fn table(
        &self,
        group: &Group,
        name: &str,
        rows: usize,
        columns: usize,
    ) -> Result<Vec<Vec<f64>>, StoreError> {
        let data: Vec<f64> = self.column(group, name, rows.saturating_mul(columns))?;
        Ok(data.chunks(columns.max(1)).map(<[f64]>::to_vec).collect())
    }

    fn coordinate(&self, group: &Group, name: &str) -> Result<Coordinate, StoreError> {
        let dataset = self.dataset(group, name)?;
        let text = |attribute| read_text(&dataset, attribute).unwrap_or_default();
        Ok(Coordinate {
            name: name.to_owned(),
            units: text("units"),
            long_name: text("long_name"),
            values: self.numbers(&dataset)?,
        })
    }

    fn results(&self) -> Result<Results, StoreError> {
        let root = self.file.group("/").map_err(|e| self.damaged(e))?;
        let members = self.members(&root)?;
        let status = self.dataset(&root, "status")?;
        let shape = status.shape();
        let list = members.iter().any(|name| name == "instance");
        let axis_names: Vec<String> = if list {
            let names = read_text(&status, "coordinates").unwrap_or_default();
            names.split_whitespace().map(str::to_owned).collect()
        } else {
            let is_axis = |name: &&String| {
                *name != "harmonic" && root.dataset(name).is_ok_and(|dataset| is_scale(&dataset))
            };
            members.iter().filter(is_axis).cloned().collect()
        };
        let axes = axis_names
            .iter()
            .map(|name| self.coordinate(&root, name))
            .collect::<Result<Vec<Coordinate>, StoreError>>()?;
        let lengths: Vec<usize> = axes.iter().map(|axis| axis.values.len()).collect();
        let fits = if list {
            shape.len() == 1 && lengths.iter().all(|&length| length == shape[0])
        } else {
            shape == lengths
        };
        if !fits {
            return Err(self.damaged(format_args!("status has dimensions {shape:?}, its axes {lengths:?}")));
        }
        let status: Vec<u8> = self.numbers(&status)?;
        let count = status.len();
        let steps_per_period = self.column(&root, "steps_per_period", count)?;
        let others: Vec<&String> = members.iter().filter(|name| !axis_names.contains(name)).collect();
        Ok(Results {
            title: read_text(&self.file, "title").unwrap_or_default(),
            axes,
            list,
            variables: self.variables(&root, &others, &shape)?,
            flags: self.flags(&root, &others, &shape)?,
            status,
            steps_per_period,
            waveforms: self.waveforms(&root)?,
            force_curves: self.force_curves(&root)?,
            audit: self.listed(&root, "audit")?,
            other_branch: self.listed(&root, "other_branch")?,
            attributes: self.attributes()?,
        })
    }

    /// The f64 variables over dimensions of these lengths; whatever else a user has put into the file is
    /// passed over.
    fn variables(
        &self,
        group: &Group,
        names: &[&String],
        shape: &[usize],
    ) -> Result<Vec<Variable>, StoreError> {
        let mut variables = Vec::new();
        for name in names {
            let Ok(dataset) = group.dataset(name) else { continue };
            let float = dataset.dtype().and_then(|kind| kind.to_descriptor());
            if !matches!(float, Ok(TypeDescriptor::Float(_))) || is_scale(&dataset) {
                continue;
            }
            let harmonics = match dataset.shape().strip_prefix(shape) {
                Some([]) => None,
                Some([count]) => Some(*count),
                _ => continue,
            };
            let text = |attribute| read_text(&dataset, attribute).unwrap_or_default();
            variables.push(Variable {
                name: (*name).clone(),
                units: text("units"),
                long_name: text("long_name"),
                harmonics,
                data: self.numbers(&dataset)?,
            });
        }
        Ok(variables)
    }

    /// The u8 variables with words for their codes or bits, `status` apart.
    fn flags(&self, group: &Group, names: &[&String], shape: &[usize]) -> Result<Vec<Flags>, StoreError> {
        let mut all = Vec::new();
        for name in names.iter().filter(|name| name.as_str() != "status") {
            let Ok(dataset) = group.dataset(name) else { continue };
            let Some(meanings) = read_text(&dataset, "flag_meanings") else { continue };
            if dataset.shape() != shape {
                continue;
            }
            all.push(Flags {
                name: (*name).clone(),
                long_name: read_text(&dataset, "long_name").unwrap_or_default(),
                meanings: meanings.split_whitespace().map(str::to_owned).collect(),
                bits: dataset.attr("flag_masks").is_ok(),
                data: self.numbers(&dataset)?,
            });
        }
        Ok(all)
    }

    fn attributes(&self) -> Result<Vec<(String, Attribute)>, StoreError> {
        let names = self
            .file
            .attr_names_by(IndexType::CreationOrder, IterationOrder::Increasing)
            .or_else(|_| self.file.attr_names())
            .map_err(|e| self.damaged(e))?;
        let mut attributes = Vec::new();
        for name in names {
            // netCDF libraries keep their own notes under names that begin so.
            if OWN_ATTRIBUTES.contains(&name.as_str()) || name.starts_with("_N") {
                continue;
            }
            if let Some(text) = read_text(&self.file, &name) {
                attributes.push((name, Attribute::Text(text)));
            } else if let Ok(number) = self.file.attr(&name).and_then(|a| a.read_scalar::<f64>()) {
                attributes.push((name, Attribute::Number(number)));
            }
        }
        Ok(attributes)
    }

    fn group(&self, root: &Group, name: &str) -> Result<Option<Group>, StoreError> {
        if !root.link_exists(name) {
            return Ok(None);
        }
        root.group(name).map(Some).map_err(|e| self.damaged(format_args!("{name}: {e}")))
    }

    fn instances(&self, group: &Group) -> Result<Vec<u64>, StoreError> {
        let numbers: Vec<i64> = self.numbers(&self.dataset(group, "instance")?)?;
        Ok(numbers.into_iter().map(|number| u64::try_from(number).unwrap_or(0)).collect())
    }

    fn waveforms(&self, root: &Group) -> Result<Option<Waveforms>, StoreError> {
        let Some(group) = self.group(root, "waveforms")? else { return Ok(None) };
        let instances = self.instances(&group)?;
        let time = self.dataset(&group, "time")?;
        let (rows, length) = match time.shape().as_slice() {
            [length] => (1, *length),
            [rows, length] if *rows == instances.len() => (*rows, *length),
            shape => return Err(self.damaged(format_args!("the waveforms' time has dimensions {shape:?}"))),
        };
        let table = |name| self.table(&group, name, instances.len(), length);
        Ok(Some(Waveforms {
            time: self.table(&group, "time", rows, length)?,
            tip_travel: table("tip_travel")?,
            actuator_top: table("actuator_top")?,
            indentation: table("indentation")?,
            force: table("force")?,
            instances,
        }))
    }

    fn force_curves(&self, root: &Group) -> Result<Vec<ForceCurve>, StoreError> {
        let Some(group) = self.group(root, "force_curves")? else { return Ok(Vec::new()) };
        let instances = self.instances(&group)?;
        let count = instances.len();
        let length = match self.dataset(&group, "force")?.shape().as_slice() {
            [rows, length] if *rows == count => *length,
            shape => return Err(self.damaged(format_args!("the force curves have dimensions {shape:?}"))),
        };
        let points: Vec<u32> = self.column(&group, "points", count)?;
        let laws = self.words(&group, "law", count)?;
        let branches = self.words(&group, "branch", count)?;
        let mut indentation = self.table(&group, "indentation", count, length)?.into_iter();
        let mut force = self.table(&group, "force", count, length)?.into_iter();
        let mut radius = self.table(&group, "contact_radius", count, length)?.into_iter();
        let mut curves = Vec::with_capacity(count);
        for (((instance, points), law), branch) in instances.into_iter().zip(points).zip(laws).zip(branches) {
            let cut = |rows: &mut std::vec::IntoIter<Vec<f64>>| {
                let mut row = rows.next().unwrap_or_default();
                row.truncate(points as usize);
                row
            };
            curves.push(ForceCurve {
                instance,
                law,
                branch,
                indentation: cut(&mut indentation),
                force: cut(&mut force),
                contact_radius: cut(&mut radius),
            });
        }
        Ok(curves)
    }

    /// The words behind a variable of codes.
    fn words(&self, group: &Group, name: &str, count: usize) -> Result<Vec<String>, StoreError> {
        let codes: Vec<u8> = self.column(group, name, count)?;
        let dataset = self.dataset(group, name)?;
        let values: Vec<u8> =
            dataset.attr("flag_values").and_then(|a| a.read_raw()).map_err(|e| self.damaged(e))?;
        let meanings = read_text(&dataset, "flag_meanings").unwrap_or_default();
        let meanings: Vec<&str> = meanings.split_whitespace().collect();
        let word = |code: u8| {
            let meaning = values.iter().position(|&value| value == code).and_then(|at| meanings.get(at));
            meaning.map(|word| (*word).to_owned())
        };
        codes
            .into_iter()
            .map(|code| word(code).ok_or_else(|| self.damaged(format_args!("{name} {code} has no meaning"))))
            .collect()
    }

    fn listed(&self, root: &Group, name: &str) -> Result<Option<Listed>, StoreError> {
        let Some(group) = self.group(root, name)? else { return Ok(None) };
        let instances = self.instances(&group)?;
        let members = self.members(&group)?;
        let names: Vec<&String> = members.iter().collect();
        let variables = self.variables(&group, &names, &[instances.len()])?;
        Ok(Some(Listed { instances, variables }))
    }
}
