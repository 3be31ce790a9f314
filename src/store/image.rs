//! A results file in memory.

use hdf5::File;
use hdf5::file::{AttrCreationOrder as AttrOrder, LinkCreationOrder as LinkOrder};
use std::sync::atomic::{AtomicU64, Ordering};

/// A new file.
pub(super) fn in_memory() -> hdf5::Result<File> {
    // The library takes two files in memory of one name for one file.
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    let name = format!("afmsweep-{}", NUMBER.fetch_add(1, Ordering::Relaxed));
    File::with_options()
        .with_fapl(|p| p.core_filebacked(false))
        .with_fcpl(|p| p.link_creation_order(LinkOrder::Indexed).attr_creation_order(AttrOrder::Indexed))
        .create(&name)
}

/// The whole file as it would stand on a disk.
pub(super) fn file_image(file: &File) -> hdf5::Result<Vec<u8>> {
    use hdf5_sys::h5f::H5Fget_file_image;
    let _lock = hdf5_sys::LOCK.lock();
    // SAFETY: the lock is held and the file open; the first call only asks for the size, the second
    // writes at most that many bytes into a buffer of that size.
    unsafe {
        let size = usize::try_from(H5Fget_file_image(file.id(), std::ptr::null_mut(), 0)).unwrap_or(0);
        let mut bytes = vec![0u8; size];
        let copied = H5Fget_file_image(file.id(), bytes.as_mut_ptr().cast(), size);
        if size == 0 || usize::try_from(copied).ok() != Some(size) {
            return Err("the file's bytes could not be taken from memory".into());
        }
        Ok(bytes)
    }
}
