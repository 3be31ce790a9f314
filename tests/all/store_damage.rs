//! Results files that were cut, spoilt or are none: told apart, and never a panic.

use crate::common::{SCENE, coordinate, grid, list, own_times, ramp, results, scalar};
use afmsweep::store::{
    ExistingFile, RecordKind, Results, RunFile, StoreError, Writer, open_journal, partial_path, read,
};
use std::path::{Path, PathBuf};

/// A file of these results, and a folder that goes away with it.
fn file(results: &Results) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    write(&path, results).unwrap();
    (folder, path)
}

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

/// Truth: what was written. Every byte of a small file with each layout is spoilt in turn; what is read all the same has
/// to be all of it.
#[test]
fn no_spoilt_byte_changes_what_is_read_without_a_word() {
    for results in [grid(), list(), own_times(), scalar()] {
        let (_folder, path) = file(&results);
        let whole = std::fs::read(&path).unwrap();
        let written = read(&path).unwrap();
        let mut refused = 0;
        let tried: Vec<usize> = (0..whole.len()).step_by(whole.len() / 500 + 1).collect();
        for &at in &tried {
            let mut spoilt = whole.clone();
            spoilt[at] ^= 1 << (at % 8);
            std::fs::write(&path, &spoilt).unwrap();
            match read(&path) {
                Ok(read) => assert_eq!(format!("{read:?}"), format!("{written:?}"), "byte {at}"),
                Err(_) => refused += 1,
            }
        }
        assert!(refused > tried.len() / 10, "{refused} of {} noticed", tried.len());
    }
}

/// Truth: what was changed.
#[test]
fn what_was_changed_after_the_run_is_named() {
    let changed = |change: fn(&hdf5::File), expected: &str| {
        let (_folder, path) = file(&grid());
        change(&hdf5::File::open_rw(&path).unwrap());
        let error = read(&path).unwrap_err();
        assert!(error.to_string().contains(expected), "{expected}: {error}");
        assert!(matches!(error, StoreError::Changed { .. } | StoreError::Damaged { .. }), "{error:?}");
    };
    changed(|file| file.unlink("phase").unwrap(), "phase is missing");
    changed(|file| file.unlink("audit").unwrap(), "audit/instance is missing");
    changed(|file| file.unlink("contact_warnings").unwrap(), "contact_warnings is missing");
    changed(|file| file.group("audit").unwrap().unlink("amplitude").unwrap(), "audit/amplitude is missing");
    changed(
        |file| file.dataset("amplitude").unwrap().write_raw(&[60e-9; 12]).unwrap(),
        "amplitude is not what the run wrote",
    );
    changed(
        |file| file.dataset("tip_radius").unwrap().write_raw(&[1e-9, 2e-9, 3e-9, 4e-9]).unwrap(),
        "tip_radius is not what the run wrote",
    );
    changed(|file| file.delete_attr("device").unwrap(), "the attribute device is missing");
    // What is no name does not get into a message.
    changed(
        |file| {
            file.delete_attr("checksums").unwrap();
            let text: hdf5::types::VarLenUnicode = "ampli\ntude:0123456789abcdef".parse().unwrap();
            file.new_attr::<hdf5::types::VarLenUnicode>()
                .create("checksums")
                .unwrap()
                .write_scalar(&text)
                .unwrap();
        },
        "its checksums are spoilt",
    );
}

/// What somebody has put into a file beside the results is nobody's damage.
#[test]
fn what_was_added_to_a_file_is_passed_over() {
    let (_folder, path) = file(&grid());
    let written = read(&path).unwrap();
    {
        let file = hdf5::File::open_rw(&path).unwrap();
        file.create_group("mine").unwrap();
        file.new_dataset::<i64>().shape([3]).create("notes").unwrap();
        file.new_attr::<i32>().create("grade").unwrap().write_scalar(&1).unwrap();
        // A variable without columns is no variable.
        file.new_dataset::<f64>().shape([3, 4, 0]).create("nothing").unwrap();
    }
    let read = read(&path).unwrap();
    assert_eq!(read.variables, written.variables);
    assert_eq!(read.flags, written.flags);
}

/// Truth: the observables of the scene in the file.
#[test]
fn an_observable_that_the_scene_asks_for_and_the_file_lacks_is_named() {
    let mut results = grid();
    let scene = "[output]\nobservables = [\"amplitude\", \"force_max\"]\n";
    results.provenance.push(("scene_resolved".into(), scene.into()));
    let (_folder, path) = file(&results);
    let error = read(&path).unwrap_err();
    assert!(matches!(&error, StoreError::Lacking { what, .. } if what == "force_max"), "{error}");
}

/// Truth: what the datasets claim together; each alone stays below what is believed of a file.
#[test]
fn many_datasets_without_data_are_refused_before_memory_is_asked_for() {
    let (_folder, path) = file(&grid());
    {
        let file = hdf5::File::open_rw(&path).unwrap();
        for number in 0..60 {
            let new = file.new_dataset::<f64>().shape([3, 4, 200_000]).chunk([3, 4, 1000]);
            new.create(format!("bomb_{number}").as_str()).unwrap();
        }
    }
    let length = std::fs::metadata(&path).unwrap().len();
    assert!(3 * 4 * 200_000 * 8 < length * 1100, "each is small enough: {length}");
    let error = read(&path).unwrap_err();
    assert!(error.to_string().contains("claims more data than the file holds"), "{error}");
}

/// Small variables have checksums too: any bit of a number that is not the one written is seen.
#[test]
fn a_spoilt_number_is_seen_in_variables_of_every_size() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let large = results(vec![coordinate("a_x", "m", ramp(2000, 1e-9))], false);
    for results in [scalar(), grid(), large] {
        write(&path, &results).unwrap();
        let whole = std::fs::read(&path).unwrap();
        let mut tried = 0;
        for variable in results.variables.iter().chain(&results.audit.iter().next().unwrap().variables) {
            let number = variable.data.last().unwrap().to_le_bytes();
            for at in (0..whole.len() - 8).filter(|at| whole[*at..at + 8] == number) {
                let mut spoilt = whole.clone();
                spoilt[at + 5] ^= 0x20;
                std::fs::write(&path, &spoilt).unwrap();
                let error = read(&path).expect_err(&variable.name);
                assert!(matches!(error, StoreError::Damaged { .. }), "{}: {error}", variable.name);
                tried += 1;
            }
        }
        // Large variables are compressed: their numbers do not stand in the file as such.
        assert!(tried > 0, "{} instances", results.status.len());
        std::fs::remove_file(&path).unwrap();
    }
}

/// Not one bit of a share's file may turn over: none reaches the HDF5 library, which a spoilt one can bring down.
#[test]
fn a_share_of_which_a_bit_is_spoilt_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let (mut file, _) = RunFile::create(&path, SCENE, ExistingFile::Kept).unwrap();
    file.begin("the header").unwrap();
    file.append(RecordKind::Portion, &[7; 300]).unwrap();
    file.finish_share("a share").unwrap();
    assert_eq!(open_journal(&path).unwrap().records().count(), 1);
    let whole = std::fs::read(&path).unwrap();
    for bit in (0..8 * whole.len()).step_by(37).chain(8 * (whole.len() - 12)..8 * whole.len()) {
        let mut spoilt = whole.clone();
        spoilt[bit / 8] ^= 1 << (bit % 8);
        std::fs::write(&path, &spoilt).unwrap();
        assert!(matches!(open_journal(&path), Err(StoreError::Damaged { .. })), "bit {bit}");
    }
}
