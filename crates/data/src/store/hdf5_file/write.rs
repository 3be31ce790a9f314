//! Lays [`Results`] out as labelled arrays, and these as the bytes of an HDF5 file.
//!
//! The file is made in memory and handed over as bytes: its size is below that of the results it is made
//! from, and a full disk then is an ordinary I/O error, not a library left with a file it cannot close.

mod chunk_shape;
mod compression;
mod file_contents;
mod file_groups;
mod force_curve_group;
mod group_layout;
mod root_group;

pub use group_layout::{ArrayLayout, ArrayRole, ArrayValues, AttributeValue, GroupLayout, InstanceColumn};

use super::consistency::{check, check_all};
use super::dimension_scales::{self, DimensionScale, attach};
use super::hdf5_image::{Hdf5Image, in_memory};
use super::{PROVENANCE, Results, StoreError, Unread, VariableSource, checksums};
use chunk_shape::chunk;
use file_contents::FileContents;
use hdf5::dataset::Layout as Storage;
use hdf5::file::{AttrCreationOrder as AttrOrder, LinkCreationOrder as LinkOrder};
use hdf5::types::VarLenUnicode;
use hdf5::{Dataset, File, Group, H5Type, Location};
use std::path::Path;

/// Below this many bytes a chunk's bookkeeping is larger than what compression saves: the data lie in the dataset's
/// header, which has a checksum of its own.
const TINY: usize = 4096;

/// Everything that a results file holds, as groups of labelled arrays. HDF5 files are written from it, and whoever wants the
/// results in another form reads them here.
pub struct FileLayout<'a> {
    /// The root first.
    pub groups: Vec<GroupLayout<'a>>,
    filled: FileContents<'a>,
}

impl<'a> FileLayout<'a> {
    /// Results as they are but for the numbers over all instances, which `numbers` gives: one variable after the other.
    /// `scene_text` is the scene where the results do not hold it.
    ///
    /// # Errors
    /// Parts that do not fit together.
    pub fn of(
        frame: &'a Results,
        numbers: &'a dyn VariableSource,
        scene_text: &'a str,
    ) -> Result<Self, StoreError> {
        check(frame, numbers.count())?;
        let filled = FileContents::new(frame, numbers);
        Ok(Self { groups: file_groups::all(&filled, scene_text)?, filled })
    }

    /// The values of an array, numbers over all instances among them.
    ///
    /// # Errors
    /// They cannot be had.
    pub fn values<'s>(&'s self, array: &'s ArrayLayout<'a>) -> Result<ArrayValues<'s>, Unread> {
        Ok(match array.values {
            ArrayValues::Count(count) => ArrayValues::I64((0..count as i64).collect()),
            ArrayValues::Instances(of, InstanceColumn::Variable(n)) => {
                ArrayValues::F64(self.filled.variable(of, n)?)
            }
            ArrayValues::Instances(of, InstanceColumn::Flags(n)) => {
                ArrayValues::U8(self.filled.flags(of, n)?)
            }
            ArrayValues::Instances(of, InstanceColumn::Status) => ArrayValues::U8(self.filled.status(of)?),
            ArrayValues::Instances(of, InstanceColumn::Steps) => ArrayValues::U32(self.filled.steps(of)?),
            ref other => borrowed(other),
        })
    }

    /// Root attribute `checksums`, quickest once all values were asked for.
    pub fn checksums(&self) -> (&'static str, String) {
        (checksums::ATTRIBUTE, self.filled.sums())
    }
}

/// The same values, not copied where they are many.
fn borrowed<'s>(values: &'s ArrayValues) -> ArrayValues<'s> {
    match values {
        ArrayValues::F64(all) => ArrayValues::F64(all[..].into()),
        ArrayValues::U8(all) => ArrayValues::U8(all[..].into()),
        ArrayValues::U32(all) => ArrayValues::U32(all[..].into()),
        few => few.clone(),
    }
}

/// The results file in memory. `path` only serves messages.
pub(super) fn image(results: &Results, scene_text: &str, path: &Path) -> Result<Hdf5Image, StoreError> {
    check_all(results)?;
    laid_out(results, results, scene_text, path)
}

/// Lays results out as a file, see [`FileLayout::of`]; `path` only serves messages.
///
/// # Errors
/// Parts that do not fit together; numbers that cannot be had.
pub fn laid_out(
    frame: &Results,
    numbers: &dyn VariableSource,
    scene_text: &str,
    path: &Path,
) -> Result<Hdf5Image, StoreError> {
    let layout = FileLayout::of(frame, numbers, scene_text)?;
    let build = || -> hdf5::Result<Hdf5Image> {
        let file = in_memory()?;
        layout.groups.iter().try_for_each(|group| write(&file, group, &layout))?;
        // Last, as the numbers are known now.
        let (name, sums) = layout.checksums();
        dimension_scales::text(&file, name, &sums)?;
        Hdf5Image::of(file)
    };
    build().map_err(|source| StoreError::Hdf5 { path: path.to_path_buf(), doing: "lay out".into(), source })
}

/// The group of long texts with the scene's alone.
pub(super) fn scene_group(file: &File, scene_text: &str) -> hdf5::Result<()> {
    dimension_scales::text(&*group(file, PROVENANCE)?, "scene", scene_text)
}

/// Makes a group; the root is there already.
fn group(file: &File, name: &str) -> hdf5::Result<Group> {
    if name.is_empty() {
        return file.group("/");
    }
    file.create_group_builder()
        .with_gcpl(|p| {
            p.link_creation_order(LinkOrder::Indexed)
                .attr_creation_order(AttrOrder::Indexed)
                .obj_track_times(false)
        })
        .create(name)
}

/// Writes a group with its arrays.
fn write(file: &File, layout: &GroupLayout, all: &FileLayout) -> hdf5::Result<()> {
    let group = group(file, layout.name)?;
    layout.attributes.iter().try_for_each(|(name, value)| attribute(&group, name, value))?;
    let mut scales: Vec<Option<DimensionScale>> = Vec::new();
    for array in &layout.arrays {
        let values = all.values(array).map_err(|error| hdf5::Error::from(error.to_string()))?;
        let dataset = dataset(&group, array.name, &layout.shape(array), &values)?;
        if array.role == ArrayRole::Variable {
            attach(file, &dataset, &mut scales, &array.dims)?;
        }
        array.attributes.iter().try_for_each(|(name, value)| attribute(&dataset, name, value))?;
        scales.push(match array.role {
            ArrayRole::Variable => None,
            ArrayRole::Coordinate => Some(DimensionScale::new(dataset, array.name)?),
            ArrayRole::Dimension => Some(DimensionScale::bare(dataset)?),
        });
    }
    scales.into_iter().flatten().try_for_each(DimensionScale::close)
}

fn attribute(at: &Location, name: &str, value: &AttributeValue) -> hdf5::Result<()> {
    match value {
        AttributeValue::Text(text) => dimension_scales::text(at, name, text),
        AttributeValue::Number(number) => dimension_scales::number(at, name, *number),
        AttributeValue::Codes(codes) => dimension_scales::list(at, name, codes),
    }
}

fn dataset(group: &Group, name: &str, shape: &[usize], values: &ArrayValues) -> hdf5::Result<Dataset> {
    match values {
        ArrayValues::F64(all) => numbers(group, name, shape, all),
        ArrayValues::U8(all) => numbers(group, name, shape, all),
        ArrayValues::U32(all) => numbers(group, name, shape, all),
        ArrayValues::I32(all) => numbers(group, name, shape, all),
        ArrayValues::I64(all) => numbers(group, name, shape, all),
        ArrayValues::Words(words) => {
            let words = words.iter().map(|word| dimension_scales::unicode(word));
            numbers(group, name, shape, &words.collect::<hdf5::Result<Vec<VarLenUnicode>>>()?)
        }
        ArrayValues::Count(_) | ArrayValues::Instances(..) => Err(format!("{name} has no values").into()),
    }
}

/// A dataset with its data, chunked and filtered if that pays.
fn numbers<T: H5Type>(group: &Group, name: &str, shape: &[usize], data: &[T]) -> hdf5::Result<Dataset> {
    let mut builder = group.new_dataset::<T>().shape(shape.to_vec());
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
