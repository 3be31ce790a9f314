//! The place of a results file: links, rights, other programs, and what may stand at its partial name.
//! Truth: the file system, and what stood there before.

use crate::common::{SCENE, grid, scalar};
use afmsweep::store::{Results, StoreError, Writer, partial_path, read};
use std::fs::{self, File};
use std::path::Path;

fn write(path: &Path, results: &Results) -> Result<(), StoreError> {
    let mut writer = Writer::create(path, SCENE, false)?;
    writer.write(results)?;
    writer.finish()
}

fn refused(path: &Path, overwrite: bool) -> StoreError {
    Writer::create(path, SCENE, overwrite).expect_err("it must be refused")
}

#[cfg(unix)]
#[test]
fn a_link_at_the_partial_name_is_refused_and_its_target_untouched() {
    let folder = tempfile::tempdir().unwrap();
    let (path, victim) = (folder.path().join("a.h5"), folder.path().join("victim.txt"));
    fs::write(&victim, "precious\n").unwrap();
    let partial = partial_path(&path);
    std::os::unix::fs::symlink(&victim, &partial).unwrap();
    for overwrite in [false, true] {
        let error = refused(&path, overwrite);
        assert!(matches!(error, StoreError::PartialLink { .. }), "{error}");
        assert!(error.to_string().contains("a.h5.partial is a link"), "{error}");
    }
    fs::remove_file(&partial).unwrap();
    // A link to nothing would make a file where somebody else wants one.
    std::os::unix::fs::symlink(folder.path().join("nothing"), &partial).unwrap();
    assert!(matches!(refused(&path, true), StoreError::PartialLink { .. }));
    assert!(!folder.path().join("nothing").exists());
    fs::remove_file(&partial).unwrap();
    fs::hard_link(&victim, &partial).unwrap();
    for overwrite in [false, true] {
        assert!(matches!(refused(&path, overwrite), StoreError::PartialLink { .. }));
    }
    assert_eq!(fs::read_to_string(&victim).unwrap(), "precious\n");
}

#[test]
fn a_partial_file_of_the_users_own_is_left_alone_unless_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let partial = partial_path(&path);
    fs::write(&partial, "mine\n").unwrap();
    let error = refused(&path, false);
    assert!(matches!(error, StoreError::PartialTaken { .. }), "{error}");
    assert!(
        error.to_string().contains("--overwrite") && error.to_string().contains("a.h5.partial"),
        "{error}"
    );
    assert_eq!(fs::read_to_string(&partial).unwrap(), "mine\n");
    // Results of another scene, then cut ones, of which nobody can say whose they are.
    let mut other = Writer::create(&folder.path().join("b.h5"), "title = \"two\"\n", false).unwrap();
    let mut results = grid();
    results.provenance.remove(0);
    other.write(&results).unwrap();
    let bytes = fs::read(other.partial()).unwrap();
    for kept in [bytes.len(), bytes.len() / 2] {
        fs::write(&partial, &bytes[..kept]).unwrap();
        let error = refused(&path, false);
        assert!(matches!(error, StoreError::PartialTaken { .. }), "{error}");
        assert_eq!(fs::read(&partial).unwrap(), bytes[..kept]);
    }
    let mut writer = Writer::create(&path, SCENE, true).unwrap();
    writer.write(&scalar()).unwrap();
    writer.finish().unwrap();
    assert_eq!(read(&path).unwrap().status, scalar().status);
}

#[test]
fn what_a_run_of_the_scene_left_is_taken_over_and_kept_until_there_is_more() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    let partial = partial_path(&path);
    for torn in [b"".as_slice(), b"afmsweep and then half a file"] {
        fs::write(&partial, torn).unwrap();
        if !torn.is_empty() {
            assert!(matches!(read(&partial), Err(StoreError::Partial { .. })));
        }
        write(&path, &scalar()).unwrap();
        assert!(!partial.exists());
    }
    let mut writer = Writer::create(&path, SCENE, false).unwrap();
    writer.write(&grid()).unwrap();
    drop(writer);
    // A run that comes to nothing leaves what it found.
    drop(Writer::create(&path, SCENE, false).unwrap());
    assert_eq!(read(&partial).unwrap().status, grid().status);
    write(&path, &scalar()).unwrap();
    assert_eq!(read(&path).unwrap().status, scalar().status);
    assert!(!partial.exists());
}

#[test]
fn what_names_no_file_is_refused_before_the_run() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["newdir/", "newdir/.", "new/dir/"] {
        let error = refused(&folder.path().join(name), true);
        assert!(matches!(error, StoreError::Folder { .. }), "{name}: {error}");
    }
    assert!(matches!(refused(Path::new("-"), true), StoreError::Stream));
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
    let mut writer = Writer::create(&folder.path().join("typo/a.h5"), SCENE, false).unwrap();
    assert_eq!(writer.made_folder(), Some(folder.path().join("typo").as_path()));
    writer.write(&scalar()).unwrap();
    writer.finish().unwrap();
    let again = Writer::create(&folder.path().join("typo/a.h5"), SCENE, false).unwrap();
    assert_eq!(again.made_folder(), None);
}

#[cfg(unix)]
#[test]
fn a_link_at_the_name_is_followed_and_stays_one() {
    let folder = tempfile::tempdir().unwrap();
    fs::create_dir(folder.path().join("elsewhere")).unwrap();
    let (link, target) = (folder.path().join("link.h5"), folder.path().join("elsewhere/target.h5"));
    write(&target, &grid()).unwrap();
    std::os::unix::fs::symlink("elsewhere/target.h5", &link).unwrap();
    write(&link, &scalar()).unwrap();
    assert!(fs::symlink_metadata(&link).unwrap().is_symlink());
    assert_eq!(read(&target).unwrap().status, scalar().status);
    fs::remove_file(&target).unwrap();
    assert!(matches!(refused(&link, true), StoreError::DeadLink { .. }));
}

/// Owners can be changed by the superuser alone; permissions by everybody.
#[cfg(unix)]
#[test]
fn the_new_file_has_the_rights_of_the_one_it_replaces() {
    use std::os::unix::fs::{MetadataExt, PermissionsExt};
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    for mode in [0o640, 0o600, 0o444] {
        write(&path, &grid()).unwrap();
        fs::set_permissions(&path, fs::Permissions::from_mode(mode)).unwrap();
        let given = std::os::unix::fs::chown(&path, Some(4321), Some(4322)).is_ok();
        let mut writer = Writer::create(&path, SCENE, false).unwrap();
        let partial = fs::metadata(writer.partial()).unwrap();
        assert_eq!(partial.mode() & 0o777, mode | 0o600, "private while it is written, too");
        writer.write(&scalar()).unwrap();
        writer.finish().unwrap();
        let now = fs::metadata(&path).unwrap();
        assert_eq!(now.mode() & 0o777, mode);
        if given {
            assert_eq!((now.uid(), now.gid()), (4321, 4322));
        }
        fs::remove_file(&path).unwrap();
    }
}

/// HDF5 locks a file that it may write; a lock taken here stands in for the other program.
#[test]
fn a_file_that_is_open_elsewhere_is_neither_foreign_nor_damaged() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.h5");
    write(&path, &grid()).unwrap();
    let mut writer = Writer::create(&path, SCENE, false).unwrap();
    let other = File::options().read(true).write(true).open(&path).unwrap();
    other.try_lock().unwrap();
    for error in [read(&path).unwrap_err(), refused(&folder.path().join("./a.h5"), false)] {
        assert!(matches!(error, StoreError::InUse { .. }), "{error}");
        assert!(error.to_string().contains("is open in another program"), "{error}");
    }
    // Opened after the run began: what was computed stays.
    writer.write(&scalar()).unwrap();
    assert!(matches!(writer.finish(), Err(StoreError::InUse { .. })));
    assert_eq!(read(&partial_path(&path)).unwrap().status, scalar().status);
    drop(other);
    assert_eq!(read(&path).unwrap().status, grid().status);
    // Readers are in nobody's way.
    let reader = File::open(&path).unwrap();
    reader.try_lock_shared().unwrap();
    write(&path, &scalar()).unwrap();
}
