//! A results file in memory.

use hdf5::File;
use hdf5::file::{AttrCreationOrder as AttrOrder, LinkCreationOrder as LinkOrder};
use hdf5_sys::h5f::{H5Fget_file_image, H5Fget_vfd_handle};
use std::sync::atomic::{AtomicU64, Ordering};

/// A new file.
pub(super) fn in_memory() -> hdf5::Result<File> {
    // The library takes two files in memory of one name for one file.
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    let name = format!("afmsweep-{}", NUMBER.fetch_add(1, Ordering::Relaxed));
    File::with_options()
        // HDF5 2 would write a newer form of the head, and older libraries could not read the file.
        .with_fapl(|p| p.core_filebacked(false).libver_earliest())
        .with_fcpl(|p| p.link_creation_order(LinkOrder::Indexed).attr_creation_order(AttrOrder::Indexed))
        .create(&name)
}

/// A file in memory that is whole: nothing is written to it any more.
pub struct Hdf5Image {
    /// Holds the bytes.
    _file: File,
    start: *const u8,
    length: usize,
}

/// Where a file of the two oldest forms of its head, which the library writes unless told otherwise, has the mark of a file
/// that is open for writing.
const MARK: std::ops::Range<usize> = 20..24;
/// Where the number of the head's form stands.
const FORM: usize = 8;

impl Hdf5Image {
    /// Of a file that [`in_memory`] made, and that nobody else has.
    pub(super) fn of(file: File) -> hdf5::Result<Self> {
        file.flush()?;
        let none = || hdf5::Error::from("the file's bytes could not be taken from memory");
        let mut handle: *mut std::ffi::c_void = std::ptr::null_mut();
        let lock = hdf5_sys::LOCK.lock();
        // SAFETY: the lock is held and the file open. The first call only asks for the size; the second writes a pointer to
        // where there is room for it: a file in memory answers with where its own pointer to its bytes is.
        let (size, start) = unsafe {
            let size = H5Fget_file_image(file.id(), std::ptr::null_mut(), 0);
            let told = H5Fget_vfd_handle(file.id(), hdf5_sys::h5p::H5P_DEFAULT, &raw mut handle);
            let known = told >= 0 && !handle.is_null();
            (size, if known { *handle.cast::<*mut u8>() } else { std::ptr::null_mut() })
        };
        drop(lock);
        let length = usize::try_from(size).unwrap_or(0);
        if start.is_null() || length < MARK.end {
            return Err(none());
        }
        // SAFETY: so many bytes lie there while the file is open, and nobody else has it.
        let head = unsafe { std::slice::from_raw_parts_mut(start, MARK.end) };
        if head[FORM] > 1 {
            return Err(none());
        }
        head[MARK].fill(0);
        Ok(Self { _file: file, start, length })
    }

    /// The whole file as it would stand on a disk.
    pub fn bytes(&self) -> &[u8] {
        // SAFETY: so many bytes lie there while the file is open, which is as long as `self` is; nobody writes to it, as
        // nobody else has it.
        unsafe { std::slice::from_raw_parts(self.start, self.length) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The bytes are those that the library itself copies out of memory, and make a file that it reads.
    #[test]
    fn bytes_are_those_of_the_librarys_own_copy() {
        for count in [3, 300_000] {
            let file = in_memory().expect("there is memory");
            let numbers: Vec<f64> = (0..count).map(f64::from).collect();
            let builder = file.new_dataset::<f64>().shape([numbers.len()]);
            builder.create("numbers").and_then(|data| data.write_raw(&numbers)).expect("it can be written");
            file.flush().expect("it can be written");
            let mut copy = vec![0u8; 10_000_000];
            let lock = hdf5_sys::LOCK.lock();
            // SAFETY: the lock is held, the file is open, and the buffer has the room that is told.
            let copied = unsafe { H5Fget_file_image(file.id(), copy.as_mut_ptr().cast(), copy.len()) };
            drop(lock);
            copy.truncate(usize::try_from(copied).expect("it fits"));
            let image = Hdf5Image::of(file).expect("it is in memory");
            let ours = image.bytes();
            let apart: Vec<usize> =
                (0..copy.len().min(ours.len())).filter(|n| ours[*n] != copy[*n]).collect();
            assert_eq!((ours.len(), apart), (copy.len(), Vec::new()));
            let folder = tempfile::tempdir().expect("there is room");
            let path = folder.path().join("a.h5");
            std::fs::write(&path, image.bytes()).expect("there is room");
            let read = File::open(&path).and_then(|file| file.dataset("numbers")?.read_raw::<f64>());
            assert_eq!(read.expect("it is a file"), numbers);
        }
    }
}
