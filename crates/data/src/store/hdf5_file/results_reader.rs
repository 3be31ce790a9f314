//! Reads a results file back, and says clearly what is wrong with one that cannot be read.

use super::dimension_scales::{is_scale, read_text};
use super::share::JOURNAL;
use super::source::Source;
use super::{
    Attribute, AuditTable, BranchTable, Coordinate, ERROR, Flags, ForceCurve, HDF5_VERSION, OBSERVABLE,
    OWN_ATTRIBUTES, PROVENANCE, Results, RowColumn, Spectra, StoreError, Variable, Waveforms,
};
use hdf5::Group;
use hdf5::types::TypeDescriptor;
use std::path::Path;

/// Reads all of a results file.
pub fn read(path: &Path) -> Result<Results, StoreError> {
    let source = Source::open(path)?;
    source.file_scene()?;
    source.refuse_share()?;
    let results = source.results()?;
    source.verify(&results)?;
    Ok(results)
}

/// The scene whose results a file holds.
pub fn scene_of(path: &Path) -> Result<String, StoreError> {
    Source::open(path)?.file_scene()
}

/// What a file tells of how it came about; empty where it tells nothing.
///
/// # Errors
/// It is no results file.
pub fn history_of(path: &Path) -> Result<String, StoreError> {
    Ok(read_text(&Source::open(path)?.file, "history").unwrap_or_default())
}

impl Source {
    fn refuse_share(&self) -> Result<(), StoreError> {
        if self.file.link_exists(JOURNAL) {
            let why = "it is a share of a run; `afmsweep merge` makes results of all of them";
            return Err(StoreError::foreign(&self.path, why));
        }
        Ok(())
    }

    fn results(&self) -> Result<Results, StoreError> {
        let root = self.file.group("/").map_err(|e| self.damaged(e))?;
        let members = self.members(&root)?;
        let status = self.dataset(&root, "status")?;
        let shape = status.shape();
        let instance = self.member(&root, "instance")?;
        let list = instance.is_some_and(|dataset| is_scale(&dataset));
        let axis_names: Vec<String> = if list {
            let names = read_text(&status, "coordinates").unwrap_or_default();
            names.split_whitespace().map(str::to_owned).collect()
        } else {
            let mut names = Vec::new();
            for name in members.iter().filter(|name| *name != "harmonic") {
                if self.member(&root, name)?.is_some_and(|dataset| is_scale(&dataset)) {
                    names.push(name.clone());
                }
            }
            names
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
        if count == 0 {
            return Err(self.damaged("it has no instance"));
        }
        let steps_per_period = self.column(&root, "steps_per_period", count)?;
        let column = |name: &String| axes.iter().flat_map(|axis| &axis.columns).any(|one| one.name == *name);
        let other = |name: &&String| !axis_names.contains(name) && !column(name);
        let others: Vec<&String> = members.iter().filter(other).collect();
        Ok(Results {
            title: read_text(&self.file, "title").unwrap_or_default(),
            axes,
            list,
            variables: self.variables(&root, &others, &shape)?,
            flags: self.flags(&root, &others, &shape)?,
            other_branch: self.branch(&root, &axis_names, &shape)?,
            status,
            steps_per_period,
            waveforms: self.waveforms(&root)?,
            spectra: self.spectra(&root)?,
            force_curves: self.force_curves(&root)?,
            audit: self.audit(&root)?,
            comments: comments(&root, &others),
            attributes: self.attributes()?,
            provenance: self.provenance(&root)?,
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
            let Some(dataset) = self.member(group, name)? else { continue };
            let float = dataset.dtype().and_then(|kind| kind.to_descriptor());
            if !matches!(float, Ok(TypeDescriptor::Float(_))) || is_scale(&dataset) {
                continue;
            }
            let harmonics = match dataset.shape().strip_prefix(shape) {
                Some([]) => None,
                // Without columns there is nothing to show.
                Some([count]) if *count > 0 => Some(*count),
                _ => continue,
            };
            let text = |attribute| read_text(&dataset, attribute).unwrap_or_default();
            variables.push(Variable {
                name: (*name).clone(),
                units: text("units"),
                long_name: text("long_name"),
                harmonics,
                error_scale: text("error_scale"),
                data: self.numbers(&dataset)?,
            });
        }
        Ok(variables)
    }

    /// The u8 variables with words for their codes or bits, `status` apart.
    fn flags(&self, group: &Group, names: &[&String], shape: &[usize]) -> Result<Vec<Flags>, StoreError> {
        let mut all = Vec::new();
        for name in names.iter().filter(|name| name.as_str() != "status") {
            let Some(dataset) = self.member(group, name)? else { continue };
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
        let mut attributes = Vec::new();
        for name in self.attribute_names(&self.file)? {
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

    /// The texts of group `provenance`.
    fn provenance(&self, root: &Group) -> Result<Vec<(String, String)>, StoreError> {
        let group = root.group(PROVENANCE).map_err(|e| self.damaged(format_args!("{PROVENANCE}: {e}")))?;
        let text = |name: String| read_text(&group, &name).map(|text| (name, text));
        let names = self.attribute_names(&group)?.into_iter().filter(|name| name != HDF5_VERSION);
        Ok(names.filter_map(text).collect())
    }

    /// A group that holds something.
    fn group(&self, root: &Group, name: &str) -> Result<Option<Group>, StoreError> {
        if !root.link_exists(name) {
            return Ok(None);
        }
        let group = root.group(name).map_err(|e| self.damaged(format_args!("{name}: {e}")))?;
        Ok((!group.is_empty()).then_some(group))
    }

    fn instances(&self, group: &Group) -> Result<Vec<u64>, StoreError> {
        let numbers: Vec<i64> = self.numbers(&self.dataset(group, "instance")?)?;
        let own = |number| {
            u64::try_from(number)
                .map_err(|_| self.damaged(format_args!("{}: instance {number}", group.name())))
        };
        numbers.into_iter().map(own).collect()
    }

    fn waveforms(&self, root: &Group) -> Result<Option<Waveforms>, StoreError> {
        let Some(group) = self.group(root, "waveforms")? else { return Ok(None) };
        let instances = self.instances(&group)?;
        let time = self.dataset(&group, "time")?;
        let (rows, length) = match time.shape().as_slice() {
            [length] if *length > 0 => (1, *length),
            [rows, length] if *rows == instances.len() && *length > 0 => (*rows, *length),
            shape => return Err(self.damaged(format_args!("the waveforms' time has dimensions {shape:?}"))),
        };
        let time = self.table(&group, "time", rows, length)?;
        let mut waveforms = Waveforms { instances, time, ..Waveforms::default() };
        for RowColumn { name, of_mut, .. } in Waveforms::COLUMNS {
            *of_mut(&mut waveforms) = self.table(&group, name, waveforms.instances.len(), length)?;
        }
        Ok(Some(waveforms))
    }

    fn spectra(&self, root: &Group) -> Result<Option<Spectra>, StoreError> {
        let Some(group) = self.group(root, "spectra")? else { return Ok(None) };
        let instances = self.instances(&group)?;
        let length = match self.dataset(&group, "frequency")?.shape().as_slice() {
            [rows, length] if *rows == instances.len() && *length > 0 => *length,
            shape => return Err(self.damaged(format_args!("the spectra have dimensions {shape:?}"))),
        };
        let mut spectra = Spectra { instances, ..Spectra::default() };
        for RowColumn { name, of_mut, .. } in Spectra::COLUMNS {
            *of_mut(&mut spectra) = self.table(&group, name, spectra.instances.len(), length)?;
        }
        Ok(Some(spectra))
    }

    fn force_curves(&self, root: &Group) -> Result<Vec<ForceCurve>, StoreError> {
        let Some(group) = self.group(root, "force_curves")? else { return Ok(Vec::new()) };
        let instances = self.instances(&group)?;
        let count = instances.len();
        let length = match self.dataset(&group, "force")?.shape().as_slice() {
            [rows, length] if *rows == count && *length > 0 => *length,
            shape => return Err(self.damaged(format_args!("the force curves have dimensions {shape:?}"))),
        };
        let points: Vec<u32> = self.column(&group, "points", count)?;
        let laws = self.words(&group, "law", count)?;
        let branches = self.words(&group, "branch", count)?;
        let cut = |name| -> Result<Vec<Vec<f64>>, StoreError> {
            let mut rows = self.table(&group, name, count, length)?;
            rows.iter_mut().zip(&points).for_each(|(row, points)| row.truncate(*points as usize));
            Ok(rows)
        };
        let mut columns = [cut("indentation")?, cut("force")?, cut("contact_radius")?];
        let one = |(n, ((instance, law), branch))| {
            let [indentation, force, contact_radius] =
                columns.each_mut().map(|rows: &mut Vec<Vec<f64>>| std::mem::take(&mut rows[n]));
            ForceCurve { instance, law, branch, indentation, force, contact_radius }
        };
        Ok(instances.into_iter().zip(laws).zip(branches).enumerate().map(one).collect())
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

    /// Group `other_branch`, over the dimensions of the root; as files before these had it, a list of some instances
    /// without a status, it is passed over.
    fn branch(
        &self,
        root: &Group,
        axes: &[String],
        shape: &[usize],
    ) -> Result<Option<BranchTable>, StoreError> {
        let Some(group) = self.group(root, "other_branch")? else { return Ok(None) };
        if !group.link_exists("status") && group.link_exists("instance") {
            return Ok(None);
        }
        let members = self.members(&group)?;
        let names: Vec<&String> = members.iter().filter(|name| !axes.contains(name)).collect();
        let count = shape.iter().product();
        Ok(Some(BranchTable {
            variables: self.variables(&group, &names, shape)?,
            status: self.column(&group, "status", count)?,
            steps_per_period: self.column(&group, "steps_per_period", count)?,
            flags: self.flags(&group, &names, shape)?,
        }))
    }

    fn audit(&self, root: &Group) -> Result<Option<AuditTable>, StoreError> {
        let Some(group) = self.group(root, "audit")? else { return Ok(None) };
        let instances = self.instances(&group)?;
        let mut names = self.members(&group)?;
        names.retain(|name| name != OBSERVABLE && name != ERROR);
        let names: Vec<&String> = names.iter().collect();
        let shape = [instances.len()];
        let observables = self.coordinate(&group, OBSERVABLE)?.words;
        Ok(Some(AuditTable {
            variables: self.variables(&group, &names, &shape)?,
            flags: self.flags(&group, &names, &shape)?,
            errors: self.table(&group, ERROR, instances.len(), observables.len())?.concat(),
            observables,
            instances,
        }))
    }
}

/// What the variables of these names have as their comments.
fn comments(root: &Group, names: &[&String]) -> Vec<(String, String)> {
    let one = |name: &&String| {
        let dataset = root.dataset(name).ok()?;
        Some(((*name).clone(), read_text(&dataset, "comment")?))
    };
    names.iter().filter_map(one).collect()
}
