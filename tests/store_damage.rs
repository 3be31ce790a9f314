//! Results files that were cut, spoilt or are none: told apart, and never a panic.

mod common;

use afmsweep::store::{Results, StoreError, Writer, partial_path, read};
use common::{SCENE, coordinate, grid, ramp, results};
use std::path::Path;

fn write(path: &Path, results: &Results) -> Result<(), StoreError> {
    let mut writer = Writer::create(path, SCENE, false)?;
    writer.write(results)?;
    writer.finish()
}

#[test]
fn missing_empty_cut_and_spoilt_files_are_told_apart() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    assert!(matches!(read(&path), Err(StoreError::Missing { .. })));
    assert!(matches!(read(folder.path()), Err(StoreError::Foreign { .. })));
    std::fs::write(&path, "").unwrap();
    assert!(matches!(read(&path), Err(StoreError::Foreign { .. })));
    let partial = partial_path(&path);
    std::fs::write(&partial, "").unwrap();
    assert!(matches!(read(&partial), Err(StoreError::Partial { .. })));

    let axes = vec![coordinate("a_x", "m", ramp(100, 1e-9)), coordinate("a_y", "m", ramp(100, 1e-9))];
    std::fs::remove_file(&path).unwrap();
    write(&path, &results(axes, false)).unwrap();
    let whole = std::fs::read(&path).unwrap();
    for cut in [9, 100, whole.len() / 2, whole.len() - 1] {
        std::fs::write(&path, &whole[..cut]).unwrap();
        let error = read(&path).unwrap_err();
        assert!(matches!(error, StoreError::Damaged { .. }), "{cut}: {error}");
        std::fs::write(&partial, &whole[..cut]).unwrap();
        assert!(matches!(read(&partial), Err(StoreError::Partial { .. })), "{cut}");
    }
}

#[test]
fn no_spoilt_byte_makes_reading_panic() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    write(&path, &grid()).unwrap();
    let whole = std::fs::read(&path).unwrap();
    let mut refused = 0;
    for at in (8..whole.len()).step_by(whole.len() / 400) {
        let mut spoilt = whole.clone();
        spoilt[at] ^= 0xff;
        std::fs::write(&path, &spoilt).unwrap();
        refused += usize::from(read(&path).is_err());
    }
    assert!(refused > 0, "spoiling bytes should be noticed at least in the labels");
}

#[test]
fn a_spoilt_text_size_is_an_error_and_no_endless_loop() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    write(&path, &grid()).unwrap();
    let mut bytes = std::fs::read(&path).unwrap();
    let heap = bytes.windows(4).position(|four| four == b"GCOL").expect("texts lie in a global heap");
    // The size of the first text, 24 bytes in; the library adds to it without looking and gets nowhere.
    bytes[heap + 24..heap + 32].copy_from_slice(&(u64::MAX - 15).to_le_bytes());
    std::fs::write(&path, &bytes).unwrap();
    assert!(matches!(read(&path), Err(StoreError::Damaged { .. })));
    assert!(matches!(Writer::create(&path, SCENE, false), Err(StoreError::Occupied { .. })));
}
