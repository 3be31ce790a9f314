//! The conventions by which netCDF-4 readers find labels in an HDF5 file: dimension scales and text.
//!
//! Readers are strict about storage: CLASS and NAME must be fixed, null-terminated strings, other text
//! is read best as variable-length UTF-8 (which also has no limit of 64 KiB, as its bytes lie outside
//! the object's header), and references must be of the oldest kind.

use hdf5::types::{TypeDescriptor, VarLenArray, VarLenUnicode};
use hdf5::{Dataset, File, H5Type, Location, ObjectReference1, Result};
use std::ffi::{CStr, CString, c_char, c_void};

/// A dimension without values of its own; readers know it by this beginning of NAME.
const NO_VARIABLE: &str = "This is a netCDF dimension but not a netCDF variable.";

/// An entry of a scale's REFERENCE_LIST: who uses it, as which dimension.
#[derive(Clone, Copy, H5Type)]
#[repr(C)]
struct Use {
    dataset: ObjectReference1,
    dimension: i32,
}

/// A dimension scale and the variables that use it.
pub(super) struct DimensionScale {
    path: String,
    dataset: Dataset,
    uses: Vec<Use>,
}

impl DimensionScale {
    /// Makes `dataset` a dimension whose values mean nothing.
    pub fn bare(dataset: Dataset) -> Result<Self> {
        let label = format!("{NO_VARIABLE}{:10}", dataset.size());
        Self::new(dataset, &label)
    }

    /// Makes `dataset` a dimension; one that is labelled with its own name is a coordinate, too.
    pub fn new(dataset: Dataset, label: &str) -> Result<Self> {
        fixed_text(&dataset, "CLASS", "DIMENSION_SCALE")?;
        fixed_text(&dataset, "NAME", label)?;
        Ok(Self { path: dataset.name(), dataset, uses: Vec::new() })
    }

    /// Writes who uses the scale; once, after all variables.
    pub fn close(self) -> Result<()> {
        if self.uses.is_empty() {
            return Ok(());
        }
        self.dataset.new_attr::<Use>().shape(self.uses.len()).create("REFERENCE_LIST")?.write_raw(&self.uses)
    }
}

/// Ties the dimensions of `variable` to the scales of these numbers, slowest first.
pub(super) fn attach(
    file: &File,
    variable: &Dataset,
    scales: &mut [Option<DimensionScale>],
    dims: &[usize],
) -> Result<()> {
    if dims.is_empty() {
        return Ok(());
    }
    let own: ObjectReference1 = file.reference(&variable.name())?;
    let mut list = Vec::with_capacity(dims.len());
    for (position, &dim) in dims.iter().enumerate() {
        let along = scales.get_mut(dim).and_then(Option::as_mut).ok_or("no such dimension")?;
        let scale: ObjectReference1 = file.reference(&along.path)?;
        list.push(VarLenArray::from_slice(&[scale]));
        along.uses.push(Use { dataset: own, dimension: position as i32 });
    }
    variable
        .new_attr::<VarLenArray<ObjectReference1>>()
        .shape(list.len())
        .create("DIMENSION_LIST")?
        .write_raw(&list)
}

/// Writes a text attribute.
pub(super) fn text(at: &Location, name: &str, value: &str) -> Result<()> {
    at.new_attr::<VarLenUnicode>().create(name)?.write_scalar(&unicode(value)?)
}

/// A text as it lies in a file.
pub(super) fn unicode(value: &str) -> Result<VarLenUnicode> {
    // A NUL would end the text for every reader.
    value.replace('\0', "\u{fffd}").parse().map_err(|e| hdf5::Error::from(format!("a text: {e}")))
}

/// Writes a number attribute.
pub(super) fn number<T: H5Type>(at: &Location, name: &str, value: T) -> Result<()> {
    at.new_attr::<T>().create(name)?.write_scalar(&value)
}

/// Writes a list attribute.
pub(super) fn list<T: H5Type>(at: &Location, name: &str, values: &[T]) -> Result<()> {
    at.new_attr::<T>().shape(values.len()).create(name)?.write_raw(values)
}

/// Writes a fixed-length, null-terminated ASCII attribute, which the crate's own types cannot express.
fn fixed_text(at: &Location, name: &str, value: &str) -> Result<()> {
    use hdf5_sys::{h5a, h5p::H5P_DEFAULT, h5s, h5t};
    let name = CString::new(name).map_err(|_| "attribute name with a NUL")?;
    let value = CString::new(value).map_err(|_| "attribute text with a NUL")?;
    let bytes = value.as_bytes_with_nul();
    let _lock = hdf5_sys::LOCK.lock();
    // SAFETY: the lock is held, `at` is open while borrowed, both strings end in NUL, and the buffer is
    // as long as the type says. Identifiers are closed whether or not the calls in between succeed.
    let written = unsafe {
        let kind = h5t::H5Tcopy(*h5t::H5T_C_S1);
        h5t::H5Tset_size(kind, bytes.len());
        let space = h5s::H5Screate(h5s::H5S_SCALAR);
        let attribute = h5a::H5Acreate2(at.id(), name.as_ptr(), kind, space, H5P_DEFAULT, H5P_DEFAULT);
        let written =
            if attribute < 0 { -1 } else { h5a::H5Awrite(attribute, kind, bytes.as_ptr().cast::<c_void>()) };
        if attribute >= 0 {
            h5a::H5Aclose(attribute);
        }
        h5s::H5Sclose(space);
        h5t::H5Tclose(kind);
        written
    };
    if written < 0 { Err("a label could not be written".into()) } else { Ok(()) }
}

/// Reads a text attribute of whatever kind of string; `None` if there is none or it is no text.
pub(super) fn read_text(at: &Location, name: &str) -> Option<String> {
    use hdf5_sys::{h5, h5a, h5t};
    let attribute = at.attr(name).ok()?;
    if attribute.shape().iter().product::<usize>() != 1 {
        return None;
    }
    let kind = attribute.dtype().ok()?;
    let bytes = match kind.to_descriptor().ok()? {
        TypeDescriptor::FixedAscii(size) | TypeDescriptor::FixedUnicode(size) => {
            let mut buffer = vec![0u8; size];
            let _lock = hdf5_sys::LOCK.lock();
            // SAFETY: the buffer has the size of the file's own type, in which one element is read.
            let read = unsafe { h5a::H5Aread(attribute.id(), kind.id(), buffer.as_mut_ptr().cast()) };
            if read < 0 {
                return None;
            }
            buffer.truncate(buffer.iter().position(|&byte| byte == 0).unwrap_or(size));
            buffer
        }
        TypeDescriptor::VarLenAscii | TypeDescriptor::VarLenUnicode => {
            let mut pointer: *mut c_char = std::ptr::null_mut();
            let _lock = hdf5_sys::LOCK.lock();
            // SAFETY: one variable-length string is read as one pointer to NUL-terminated bytes, owned by
            // us and freed by the library; other writers store an empty text as a null pointer.
            unsafe {
                let copy = h5t::H5Tcopy(kind.id());
                let read = h5a::H5Aread(attribute.id(), copy, (&raw mut pointer).cast());
                h5t::H5Tclose(copy);
                if read < 0 {
                    return None;
                }
                if pointer.is_null() {
                    Vec::new()
                } else {
                    let bytes = CStr::from_ptr(pointer).to_bytes().to_vec();
                    h5::H5free_memory(pointer.cast());
                    bytes
                }
            }
        }
        _ => return None,
    };
    Some(String::from_utf8_lossy(&bytes).into_owned())
}

/// True for a dimension scale.
pub(super) fn is_scale(dataset: &Dataset) -> bool {
    read_text(dataset, "CLASS").is_some_and(|class| class == "DIMENSION_SCALE")
}
