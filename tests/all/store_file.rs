//! The results file: what is written is read back, and nothing is overwritten or half-written.
//! Truth: the data put in; for the labels, Python's readers (`tests/python/check_results.py`).

use crate::common::{SCENE, coordinate, grid, list, own_times, ramp, results, scalar, with_spectra};
use afmsweep::store::{Attribute, Results, StoreError, Writer, partial_path, read};
use std::path::Path;

fn write(path: &Path, results: &Results) -> Result<(), StoreError> {
    let mut writer = Writer::create(path, SCENE, false)?;
    writer.write(results)?;
    writer.finish()
}

/// Equality that takes NaN for equal to NaN, as `Debug` prints every f64 so that it reads back the same.
#[track_caller]
fn assert_same(found: &Results, expected: &Results) {
    assert_eq!(format!("{found:#?}"), format!("{expected:#?}"));
}

#[track_caller]
fn assert_round_trip(results: &Results) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    write(&path, results).unwrap();
    assert_same(&read(&path).unwrap(), results);
}

#[test]
fn grid_list_and_single_case_come_back_as_written() {
    for results in [grid(), list(), scalar()] {
        assert_round_trip(&results);
    }
}

#[test]
fn nan_infinity_and_signed_zero_come_back_as_written() {
    let mut results = grid();
    results.variables[0].data[..4].copy_from_slice(&[f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0]);
    results.force_curves[0].force[3] = f64::NAN;
    assert_round_trip(&results);
}

#[test]
fn all_nan_comes_back_as_written() {
    let mut results = list();
    results.variables[0].data.fill(f64::NAN);
    assert_round_trip(&results);
}

#[test]
fn a_single_instance_and_a_single_point_axis_come_back_as_written() {
    assert_round_trip(&results(vec![coordinate("tip_radius", "m", vec![1e-8])], false));
    assert_round_trip(&results(vec![coordinate("tip_radius", "m", vec![1e-8])], true));
}

#[test]
fn waveforms_with_times_of_their_own_come_back_as_written() {
    assert_round_trip(&own_times());
}

#[test]
fn spectra_of_unequal_length_come_back_as_written() {
    let results = with_spectra();
    assert_round_trip(&results);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    results.write(&path, false).unwrap();
    // A reader notices what was changed in it.
    let file = hdf5::File::open_rw(&path).unwrap();
    let dataset = file.dataset("spectra/force_amplitude").unwrap();
    let mut numbers: Vec<f64> = dataset.read_raw().unwrap();
    numbers[0] *= 2.0;
    dataset.write_raw(&numbers).unwrap();
    drop((dataset, file));
    let error = read(&path).unwrap_err().to_string();
    assert!(error.contains("spectra is not what the run wrote"), "{error}");
}

#[test]
fn text_longer_than_an_object_header_comes_back_as_written() {
    let mut results = scalar();
    let long = "κ = \"30 nm\" # a long scene\n".repeat(10_000);
    assert!(long.len() > 4 * 65_536);
    results.provenance[1].1 = long;
    results.attributes.extend((0..40).map(|i| (format!("extra_{i:02}"), Attribute::Number(f64::from(i)))));
    assert_round_trip(&results);
}

#[test]
fn a_given_history_replaces_the_one_made_here() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let mut results = scalar();
    results.attributes.push(("history".into(), Attribute::Text("merged from 3 shards".into())));
    write(&path, &results).unwrap();
    let file = hdf5::File::open(&path).unwrap();
    let text: hdf5::types::VarLenUnicode = file.attr("history").unwrap().read_scalar().unwrap();
    assert_eq!(text.as_str(), "merged from 3 shards");
}

#[test]
fn large_variables_are_compressed_and_checksummed_and_tiny_ones_lie_in_checksummed_headers() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let axes = vec![coordinate("a_x", "m", ramp(300, 1e-9)), coordinate("a_y", "m", ramp(400, 1e-9))];
    write(&path, &results(axes, false)).unwrap();
    let file = hdf5::File::open(&path).unwrap();
    let amplitude = file.dataset("amplitude").unwrap();
    assert_eq!(amplitude.filters().len(), 3, "{:?}", amplitude.filters());
    assert_eq!(amplitude.chunk(), Some(vec![163, 400]));
    assert_eq!(file.dataset("a_x").unwrap().layout(), hdf5::dataset::Layout::Compact);
}

#[test]
fn a_million_instances_are_written_and_read_in_seconds() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let axes = vec![coordinate("a_x", "m", ramp(1000, 1e-9)), coordinate("a_y", "m", ramp(1000, 1e-9))];
    let results = results(axes, false);
    let start = std::time::Instant::now();
    write(&path, &results).unwrap();
    let written = start.elapsed();
    let bytes = std::fs::metadata(&path).unwrap().len();
    assert_eq!(read(&path).unwrap(), results);
    let total = start.elapsed();
    eprintln!(
        "10^6 instances, 6 values each: {bytes} bytes, written in {written:?}, read in {:?}",
        total - written
    );
    // A quarter of a minute is generous for a loaded machine and far below what a quadratic slip costs.
    assert!(total.as_secs() < 60, "{total:?}");
}

#[test]
fn parent_folders_are_made_and_the_final_name_appears_only_at_the_end() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("deep/er/a.h5");
    let mut writer = Writer::create(&path, SCENE, false).unwrap();
    assert!(partial_path(&path).exists() && !path.exists());
    writer.write(&grid()).unwrap();
    assert!(!path.exists());
    assert!(matches!(read(&path), Err(StoreError::Unfinished { .. })));
    writer.finish().unwrap();
    assert!(path.exists() && !partial_path(&path).exists());
}

#[test]
fn a_second_write_replaces_the_first() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let mut writer = Writer::create(&path, SCENE, false).unwrap();
    writer.write(&grid()).unwrap();
    writer.write(&scalar()).unwrap();
    writer.finish().unwrap();
    assert_same(&read(&path).unwrap(), &scalar());
}

#[test]
fn a_dropped_writer_keeps_what_was_written_and_nothing_else() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    drop(Writer::create(&path, SCENE, false).unwrap());
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    let mut writer = Writer::create(&path, SCENE, false).unwrap();
    writer.write(&grid()).unwrap();
    drop(writer);
    assert!(!path.exists());
    assert_same(&read(&partial_path(&path)).unwrap(), &grid());
}

#[test]
fn two_runs_to_one_place_do_not_mix() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let mut first = Writer::create(&path, SCENE, false).unwrap();
    let error = Writer::create(&path, SCENE, true).unwrap_err();
    assert!(matches!(error, StoreError::Busy { .. }), "{error}");
    first.write(&scalar()).unwrap();
    first.finish().unwrap();
    Writer::create(&path, SCENE, false).unwrap();
    assert_same(&read(&path).unwrap(), &scalar());
}

#[test]
fn finishing_without_writing_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let writer = Writer::create(&path, SCENE, false).unwrap();
    assert!(matches!(writer.finish(), Err(StoreError::Inconsistent { .. })));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

#[test]
fn the_same_scene_is_replaced_and_another_only_when_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    write(&path, &grid()).unwrap();
    write(&path, &scalar()).unwrap();
    assert_same(&read(&path).unwrap(), &scalar());
    let error = Writer::create(&path, "title = \"two\"\n", false).unwrap_err();
    assert!(matches!(error, StoreError::OtherScene { .. }), "{error}");
    let message = error.to_string();
    assert!(
        message.contains("--overwrite") && message.contains("-o") && message.contains("a.h5"),
        "{message}"
    );
    assert_same(&read(&path).unwrap(), &scalar());
    assert!(!partial_path(&path).exists());
    let mut writer = Writer::create(&path, "title = \"two\"\n", true).unwrap();
    let mut other = grid();
    other.provenance.remove(0);
    writer.write(&other).unwrap();
    writer.finish().unwrap();
    // Without the attribute in the results, the writer's own scene text stands in the file.
    assert_eq!(read(&path).unwrap().text("scene"), Some("title = \"two\"\n"));
}

#[test]
fn results_put_there_during_the_run_are_not_replaced() {
    let folder = tempfile::tempdir().unwrap();
    let (path, other) = (folder.path().join("a.h5"), folder.path().join("b.h5"));
    let mut writer = Writer::create(&path, "title = \"two\"\n", false).unwrap();
    writer.write(&grid()).unwrap();
    write(&other, &scalar()).unwrap();
    std::fs::copy(&other, &path).unwrap();
    assert!(matches!(writer.finish(), Err(StoreError::OtherScene { .. })));
    assert_same(&read(&path).unwrap(), &scalar());
    assert_same(&read(&partial_path(&path)).unwrap(), &grid());
}

#[test]
fn a_foreign_file_a_folder_and_a_device_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let text = folder.path().join("notes.txt");
    std::fs::write(&text, "mine\n").unwrap();
    let foreign = folder.path().join("foreign.h5");
    hdf5::File::create(&foreign).unwrap().create_group("g").unwrap();
    for path in [&text, &foreign] {
        let error = Writer::create(path, SCENE, false).unwrap_err();
        assert!(matches!(error, StoreError::Occupied { .. }), "{error}");
        assert!(error.to_string().contains("--overwrite"), "{error}");
        assert!(matches!(read(path), Err(StoreError::Foreign { .. })), "{path:?}");
    }
    assert_eq!(std::fs::read_to_string(&text).unwrap(), "mine\n");
    assert!(matches!(Writer::create(folder.path(), SCENE, true), Err(StoreError::Folder { .. })));
    assert!(matches!(Writer::create(Path::new(""), SCENE, true), Err(StoreError::Nameless { .. })));
    assert!(matches!(Writer::create(Path::new(".."), SCENE, true), Err(StoreError::Folder { .. })));
    if cfg!(unix) {
        assert!(matches!(
            Writer::create(Path::new("/dev/null"), SCENE, true),
            Err(StoreError::Special { .. })
        ));
    }
    write(&folder.path().join("free.h5"), &scalar()).unwrap();
    assert!(Writer::create(&text, SCENE, true).is_ok());
}

#[test]
fn a_place_that_cannot_be_written_is_refused_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("file"), "").unwrap();
    // A file where a folder is needed fails for every user, root too.
    for path in [folder.path().join("file/a.h5"), folder.path().join("file/b/a.h5")] {
        let error = Writer::create(&path, SCENE, false).unwrap_err();
        assert!(matches!(error, StoreError::Io { .. }), "{error}");
        assert!(error.to_string().contains("-o"), "{error}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_read_only_disk_is_refused_before_the_run() {
    let error = Writer::create(Path::new("/proc/afmsweep/a.h5"), SCENE, false).unwrap_err();
    assert!(matches!(error, StoreError::Io { .. }), "{error}");
}

#[test]
fn what_a_user_adds_to_the_file_is_passed_over() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    write(&path, &grid()).unwrap();
    {
        let file = hdf5::File::open_rw(&path).unwrap();
        file.new_dataset::<f64>().shape([5]).create("mine").unwrap();
        file.new_dataset::<i32>().shape([3, 4]).create("also_mine").unwrap();
        file.new_dataset::<f64>().shape([3, 4, 0]).create("without_columns").unwrap();
        file.create_group("my_group").unwrap();
    }
    assert_same(&read(&path).unwrap(), &grid());
}

#[test]
fn results_that_do_not_fit_together_are_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    type Spoil = fn(&mut Results);
    let cases: [(&str, Spoil); 13] = [
        ("no instance", |r| r.status.clear()),
        ("12 instances", |r| _ = r.status.pop()),
        ("steps_per_period", |r| _ = r.steps_per_period.pop()),
        ("phase", |r| _ = r.variables[1].data.pop()),
        ("harmonic", |r| r.variables[2].harmonics = Some(0)),
        ("tip_radius", |r| r.axes[0].name = "tip_radius".into()),
        ("status", |r| r.variables[0].name = "status".into()),
        ("a/b", |r| r.variables[0].name = "a/b".into()),
        ("waveforms", |r| r.waveforms.iter_mut().for_each(|w| w.force[0].truncate(3))),
        ("spectra", |r| r.spectra.iter_mut().for_each(|s| s.force_phase[0].truncate(3))),
        ("force curve", |r| _ = r.force_curves[0].force.pop()),
        ("one word", |r| r.force_curves[0].law = "two words".into()),
        ("called plan", |r| r.attributes.push(("plan".into(), Attribute::Number(0.0)))),
    ];
    for (expected, spoil) in cases {
        let mut results = with_spectra();
        spoil(&mut results);
        let mut writer = Writer::create(&path, SCENE, false).unwrap();
        let error = writer.write(&results).unwrap_err();
        assert!(matches!(error, StoreError::Inconsistent { .. }), "{error}");
        assert!(error.to_string().contains(expected), "{expected}: {error}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_place_without_room_is_a_typed_error_and_leaves_the_old_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    write(&path, &scalar()).unwrap();
    // A limit on file sizes stands in for a full disk: the system refuses the write half-way.
    let output = std::process::Command::new("sh")
        .args(["-c", "trap '' XFSZ; ulimit -f 16; exec \"$0\" \"$@\""])
        .arg(std::env::current_exe().unwrap())
        .args(["--exact", "store_file::child_without_room", "--ignored", "--nocapture"])
        .env("AFMSWEEP_TEST_PATH", &path)
        .output()
        .unwrap();
    let text =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && text.contains("1 passed"), "{text}");
    assert!(text.contains("cannot write") && text.contains("a.h5.partial") && text.contains("-o"), "{text}");
    assert!(!text.contains("HDF5-DIAG"), "{text}");
    assert_same(&read(&path).unwrap(), &scalar());
}

#[test]
#[ignore = "run by a_place_without_room_is_a_typed_error_and_leaves_the_old_file"]
fn child_without_room() {
    let path = std::env::var_os("AFMSWEEP_TEST_PATH").expect("the parent test sets it");
    let error = write(Path::new(&path), &grid()).unwrap_err();
    assert!(matches!(error, StoreError::Io { .. }), "{error}");
    eprintln!("{error}");
}
