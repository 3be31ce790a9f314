//! Lays [`Results`] out as the bytes of an HDF5 file.
//!
//! The file is made in memory and handed over as bytes: its size is below that of the results it is made
//! from, and a full disk then is an ordinary I/O error, not a library left with a file it cannot close.

mod chunk_shape;
mod compression;
mod file_contents;
mod file_groups;
mod force_curve_group;
mod root_group;

use super::consistency::{check, check_all};
use super::dimension_scales::{self, DimensionScale, attach};
use super::hdf5_image::{Hdf5Image, in_memory};
use super::{
    COLUMNS, Coordinate, Flags, PROVENANCE, Results, StateSet, StoreError, Variable, VariableSource,
    checksums,
};
use chunk_shape::chunk;
use file_contents::FileContents;
use hdf5::dataset::Layout as Storage;
use hdf5::file::{AttrCreationOrder as AttrOrder, LinkCreationOrder as LinkOrder};
use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, File, Group, H5Type};
use std::borrow::Cow;
use std::path::Path;

/// Below this many bytes a chunk's bookkeeping is larger than what compression saves: the data lie in the dataset's
/// header, which has a checksum of its own.
const TINY: usize = 4096;

/// The axis of the two ways along a curve, by its path.
const DIRECTION: &str = "curve.direction";

/// The results file in memory. `path` only serves messages.
pub(super) fn image(results: &Results, scene_text: &str, path: &Path) -> Result<Hdf5Image, StoreError> {
    check_all(results)?;
    laid_out(results, results, scene_text, path)
}

/// Lays results out as a file, as they are but for the numbers over all instances, which `numbers` gives: one variable after the
/// other. `scene_text` is the scene where the results do not hold it, and `path` only serves messages.
///
/// # Errors
/// Parts that do not fit together; numbers that cannot be had.
pub fn laid_out(
    frame: &Results,
    numbers: &dyn VariableSource,
    scene_text: &str,
    path: &Path,
) -> Result<Hdf5Image, StoreError> {
    check(frame, numbers.count())?;
    let build = || -> hdf5::Result<Hdf5Image> {
        let (file, filled) = (in_memory()?, FileContents::new(frame, numbers));
        root_group::write(&file, &filled)?;
        file_groups::write(&file, &filled, scene_text)?;
        // Last, as the numbers are known now.
        dimension_scales::text(&file, checksums::ATTRIBUTE, &filled.sums())?;
        Hdf5Image::of(file)
    };
    build().map_err(|source| StoreError::Hdf5 { path: path.to_path_buf(), doing: "lay out".into(), source })
}

/// The group of long texts with the scene's alone.
pub(super) fn scene_group(file: &File, scene_text: &str) -> hdf5::Result<()> {
    dimension_scales::text(&Layout::group(file, PROVENANCE)?.group, "scene", scene_text)
}

const INSTANCE: &str = "instance number, counted from 0";

/// Names of the variables that tell more of a variable's values.
#[derive(Clone, Copy)]
struct Beside<'a> {
    /// Where they lie, in a list.
    coordinates: Option<&'a str>,
    /// How good they are.
    ancillary: &'a str,
}

impl Beside<'_> {
    /// Tells a variable's readers where its values lie.
    fn locate(self, dataset: &Dataset) -> hdf5::Result<()> {
        self.coordinates.map_or(Ok(()), |names| dimension_scales::text(dataset, "coordinates", names))
    }
}

/// What tells how good the instances of these variables are.
fn quality(variables: &[Variable]) -> &'static str {
    match variables.iter().any(|one| one.name == "error_estimate") {
        true => "status error_estimate",
        false => "status",
    }
}

/// Tells which quantity of a scene a coordinate is.
fn from_scene(dataset: &Dataset, axis: &Coordinate) -> hdf5::Result<()> {
    match axis.scene_path.as_str() {
        "" => Ok(()),
        path => dimension_scales::text(dataset, "scene_path", path),
    }
}

/// A group being filled: where it is and what its dimensions are.
struct Layout {
    file: File,
    group: Group,
    scales: Vec<DimensionScale>,
}

impl Layout {
    fn group(file: &File, name: &str) -> hdf5::Result<Self> {
        let group = file
            .create_group_builder()
            .with_gcpl(|p| {
                p.link_creation_order(LinkOrder::Indexed)
                    .attr_creation_order(AttrOrder::Indexed)
                    .obj_track_times(false)
            })
            .create(name)?;
        Ok(Self { file: file.clone(), group, scales: Vec::new() })
    }

    /// A dataset with its data, chunked and filtered if that pays.
    fn data<T: H5Type>(&self, name: &str, shape: &[usize], data: &[T]) -> hdf5::Result<Dataset> {
        let mut builder = self.group.new_dataset::<T>().shape(shape.to_vec());
        builder = builder.obj_track_times(false).attr_creation_order(AttrOrder::Indexed);
        if size_of_val(data) < TINY {
            let dataset = builder.layout(Storage::Compact).create(name)?;
            dataset.write_raw(data)?;
            return Ok(dataset);
        }
        let (chunk, deflates) = (chunk(shape), hdf5::filters::deflate_available());
        builder = builder.chunk(chunk.clone()).shuffle();
        if deflates {
            builder = builder.deflate(1);
        }
        let dataset = builder.fletcher32().create(name)?;
        match deflates && compression::is_number::<T>() {
            true => compression::write(&dataset, (shape, &chunk), data)?,
            false => dataset.write_raw(data)?,
        }
        Ok(dataset)
    }

    /// Counts and numbers of instances have no units.
    fn describe(dataset: &Dataset, units: &str, long_name: &str) -> hdf5::Result<()> {
        if !units.is_empty() {
            dimension_scales::text(dataset, "units", units)?;
        }
        dimension_scales::text(dataset, "long_name", long_name)
    }

    /// A dimension with values; gives its number.
    fn coordinate<T: H5Type>(
        &mut self,
        name: &str,
        units: &str,
        long_name: &str,
        values: &[T],
    ) -> hdf5::Result<usize> {
        let dataset = self.data(name, &[values.len()], values)?;
        Self::describe(&dataset, units, long_name)?;
        Ok(self.scale(DimensionScale::new(dataset, name)?))
    }

    /// One more dimension; gives its number.
    fn scale(&mut self, scale: DimensionScale) -> usize {
        self.scales.push(scale);
        self.scales.len() - 1
    }

    /// A dimension whose values 0, 1 and so on have names; gives its number.
    fn named(&mut self, axis: &Coordinate) -> hdf5::Result<usize> {
        let codes: Vec<u8> = (0..axis.words.len() as u8).collect();
        let dim = self.coordinate(&axis.name, &axis.units, &axis.long_name, &codes)?;
        let dataset = self.group.dataset(&axis.name)?;
        dimension_scales::list(&dataset, "flag_values", &codes)?;
        dimension_scales::text(&dataset, "flag_meanings", &axis.words.join(" "))?;
        Ok(dim)
    }

    /// A dimension whose places have labels; gives its number.
    fn labels(&mut self, name: &str, long_name: &str, words: &[String]) -> hdf5::Result<usize> {
        let dataset = self.data(name, &[words.len()], &texts(words)?)?;
        dimension_scales::text(&dataset, "long_name", long_name)?;
        Ok(self.scale(DimensionScale::new(dataset, name)?))
    }

    /// The quantities that vary along a dimension.
    fn columns(&mut self, axis: &Coordinate, dim: usize) -> hdf5::Result<()> {
        for column in &axis.columns {
            let dataset = match column.words.is_empty() {
                true => {
                    let Coordinate { name, units, long_name, values, .. } = column;
                    self.quantity(name, units, long_name, &[dim], values)?
                }
                false => {
                    let words = texts(&column.words)?;
                    let dataset = self.variable(&column.name, &[dim], &words)?;
                    dimension_scales::text(&dataset, "long_name", &column.long_name)?;
                    dataset
                }
            };
            from_scene(&dataset, column)?;
        }
        if !axis.columns.is_empty() {
            let dataset = self.group.dataset(&axis.name)?;
            dimension_scales::text(&dataset, COLUMNS, &names(&axis.columns))?;
        }
        Ok(())
    }

    /// A dimension of this name for some of the instances, beside variable `instance` with their numbers; gives its
    /// number.
    fn some_of(&mut self, name: &str, instances: &[u64]) -> hdf5::Result<usize> {
        let dim = self.dimension(name, instances.len())?;
        self.instances(&[dim], instances)?;
        Ok(dim)
    }

    /// Variable `instance`.
    fn instances(&mut self, dims: &[usize], numbers: &[u64]) -> hdf5::Result<()> {
        let numbers: Vec<i64> = numbers.iter().map(|&n| i64::try_from(n).unwrap_or(i64::MAX)).collect();
        self.numbered(dims, &numbers)
    }

    fn numbered(&mut self, dims: &[usize], numbers: &[i64]) -> hdf5::Result<()> {
        let dataset = self.variable("instance", dims, numbers)?;
        dimension_scales::text(&dataset, "long_name", INSTANCE)
    }

    /// A dimension without values.
    fn dimension(&mut self, name: &str, length: usize) -> hdf5::Result<usize> {
        let dataset = self.data(name, &[length], &vec![0u8; length])?;
        Ok(self.scale(DimensionScale::bare(dataset)?))
    }

    /// Any variable over dimensions of these numbers.
    fn variable<T: H5Type>(&mut self, name: &str, dims: &[usize], data: &[T]) -> hdf5::Result<Dataset> {
        let shape: Vec<usize> = dims.iter().map(|&dim| self.scales[dim].length).collect();
        let dataset = self.data(name, &shape, data)?;
        attach(&self.file, &dataset, &mut self.scales, dims)?;
        Ok(dataset)
    }

    /// An f64 variable; NaN where there is no number.
    fn quantity(
        &mut self,
        name: &str,
        units: &str,
        long_name: &str,
        dims: &[usize],
        data: &[f64],
    ) -> hdf5::Result<Dataset> {
        let dataset = self.variable(name, dims, data)?;
        Self::describe(&dataset, units, long_name)?;
        Ok(dataset)
    }

    /// A u8 variable whose codes or bits have these values, and names.
    fn flags(&mut self, flags: &Flags, dims: &[usize], codes: &[u8], values: &[u8]) -> hdf5::Result<Dataset> {
        let dataset = self.variable(&flags.name, dims, codes)?;
        dimension_scales::text(&dataset, "long_name", &flags.long_name)?;
        dimension_scales::list(&dataset, if flags.bits { "flag_masks" } else { "flag_values" }, values)?;
        dimension_scales::text(&dataset, "flag_meanings", &flags.meanings.join(" "))?;
        Ok(dataset)
    }

    /// Codes from 0 on, or bits.
    fn words(&mut self, flags: &Flags, dims: &[usize], codes: &[u8]) -> hdf5::Result<Dataset> {
        let value = |n: u8| if flags.bits { 1 << n } else { n };
        let values: Vec<u8> = (0..flags.meanings.len() as u8).map(value).collect();
        self.flags(flags, dims, codes, &values)
    }

    /// Variables over the instances, with the dimension `harmonic` behind them where asked for; their numbers are elsewhere, or
    /// in themselves.
    fn variables(
        &mut self,
        variables: &[Variable],
        dims: &[usize],
        beside: Beside,
        elsewhere: Option<(&FileContents, StateSet)>,
    ) -> hdf5::Result<()> {
        let mut harmonic = None;
        for (number, variable) in variables.iter().enumerate() {
            let mut dims = dims.to_vec();
            if let Some(count) = variable.harmonics {
                let dim = match harmonic {
                    Some(dim) => dim,
                    None => {
                        let orders: Vec<i32> = (1..=count as i32).collect();
                        let long_name = "harmonic of the drive frequency";
                        *harmonic.insert(self.coordinate("harmonic", "1", long_name, &orders)?)
                    }
                };
                dims.push(dim);
            }
            let Variable { name, units, long_name, error_scale, .. } = variable;
            let data = match elsewhere {
                Some((filled, of)) => filled.variable(of, number, variable)?,
                None => Cow::from(&variable.data[..]),
            };
            let dataset = self.quantity(name, units, long_name, &dims, &data)?;
            if !error_scale.is_empty() {
                dimension_scales::text(&dataset, "error_scale", error_scale)?;
                dimension_scales::text(&dataset, "ancillary_variables", beside.ancillary)?;
            }
            beside.locate(&dataset)?;
        }
        Ok(())
    }

    /// The dimensions that all instances stand over, and the names of variables that tell of a list what varies.
    fn axes(&mut self, filled: &FileContents) -> hdf5::Result<(Vec<usize>, Option<String>)> {
        let (results, mut dims) = (filled.frame, Vec::new());
        if !results.list {
            for axis in &results.axes {
                let dim = match axis.words.is_empty() {
                    true => self.coordinate(&axis.name, &axis.units, &axis.long_name, &axis.values)?,
                    // The ways along a curve are codes, everything else is called by name.
                    false if axis.scene_path == DIRECTION => self.named(axis)?,
                    false => self.labels(&axis.name, &axis.long_name, &axis.words)?,
                };
                self.columns(axis, dim)?;
                dims.push(dim);
                from_scene(&self.group.dataset(&axis.name)?, axis)?;
            }
            let columns: Vec<&Coordinate> = results.axes.iter().flat_map(|axis| &axis.columns).collect();
            return Ok((dims, (!columns.is_empty()).then(|| names(columns))));
        }
        let numbers: Vec<i64> = (0..filled.count() as i64).collect();
        dims.push(self.coordinate("instance", "", INSTANCE, &numbers)?);
        drop(numbers);
        for axis in &results.axes {
            let dataset = self.quantity(&axis.name, &axis.units, &axis.long_name, &dims, &axis.values)?;
            from_scene(&dataset, axis)?;
        }
        Ok((dims, (!results.axes.is_empty()).then(|| names(&results.axes))))
    }

    fn close(self) -> hdf5::Result<()> {
        self.scales.into_iter().try_for_each(DimensionScale::close)
    }
}

/// Words as a dataset has them.
fn texts(words: &[String]) -> hdf5::Result<Vec<VarLenUnicode>> {
    words.iter().map(|word| dimension_scales::unicode(word)).collect()
}

/// The names of these, as attributes have them.
fn names<'a>(all: impl IntoIterator<Item = &'a Coordinate>) -> String {
    let names: Vec<&str> = all.into_iter().map(|one| one.name.as_str()).collect();
    names.join(" ")
}
