//! The results file as Python's readers see it: xarray with both engines, netCDF4, h5py, and h5dump.
//! Truth: those programs, through `tests/python/check_results.py`.

use crate::common::{SCENE, coordinate, grid, list, own_times, ramp, results, scalar, with_spectra};
use afmsweep::store::{Attribute, Results, Writer};
use std::io::Write;
use std::path::Path;
use std::process::Command;

/// Skipped, with a line that says so, where there is no `.venv`; with AFMSWEEP_PYTHON set, a failure there.
#[test]
fn python_reads_every_kind_of_results_file() {
    let python = Path::new(env!("CARGO_MANIFEST_DIR")).join(".venv/bin/python");
    if !python.exists() {
        assert!(
            std::env::var_os("AFMSWEEP_PYTHON").is_none(),
            "AFMSWEEP_PYTHON is set, but there is no .venv"
        );
        // Past the test harness, which would swallow the line.
        let line =
            b"SKIPPED python_reads_every_kind_of_results_file: no .venv (make python-check makes it)\n";
        std::io::stderr().write_all(line).unwrap();
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let mut paths = Vec::new();
    for (name, results) in examples() {
        let path = folder.path().join(name);
        let mut writer = Writer::create(&path, SCENE, false).unwrap();
        writer.write(&results).unwrap();
        writer.finish().unwrap();
        paths.push(path);
    }
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/python/check_results.py");
    let output = Command::new(python).arg("-W").arg("error").arg(script).args(&paths).output().unwrap();
    let (out, err) = (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr));
    assert!(output.status.success(), "{out}{err}");
    assert_eq!(out.lines().filter(|line| line.contains("dimensions")).count(), paths.len(), "{out}{err}");
}

fn examples() -> Vec<(&'static str, Results)> {
    let mut own_times = own_times();
    own_times.variables[0].data.fill(f64::NAN);
    let mut long_text = scalar();
    long_text.provenance[1].1 = "κ = \"30 nm\"\n".repeat(20_000);
    long_text.attributes.extend((0..40).map(|i| (format!("extra_{i}"), Attribute::Number(f64::from(i)))));
    let bare = Results {
        axes: vec![coordinate("tip_radius", "m", ramp(3, 1e-9))],
        status: vec![0; 3],
        steps_per_period: vec![1; 3],
        ..Results::default()
    };
    let large = vec![coordinate("a_x", "m", ramp(300, 1e-9)), coordinate("a_y", "m", ramp(400, 1e-9))];
    vec![
        ("grid.h5", grid()),
        ("list.h5", list()),
        ("scalar.h5", scalar()),
        ("spectra.h5", with_spectra()),
        ("own_times.h5", own_times),
        ("long_text.h5", long_text),
        ("bare.h5", bare),
        ("large.h5", results(large, false)),
    ]
}
