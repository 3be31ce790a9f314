//! The built program as a user starts it, in a folder of its own.

// Each test file uses its own part of this.

use afmsweep::store::{Results, read};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// A temporary current folder.
pub struct Desk {
    folder: tempfile::TempDir,
}

/// What a call left behind.
pub struct Said {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
}

/// A scene of the `scenes` folder.
pub fn scene(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes").join(name).to_str().unwrap().to_owned()
}

/// Every scene of the `scenes` folder.
pub fn scenes() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "toml"));
    files.sort();
    assert!(files.len() >= 6, "only {} scenes", files.len());
    files
}

pub fn said(output: Output) -> Said {
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let said = Said { code: output.status.code(), out: text(output.stdout), err: text(output.stderr) };
    // Nothing here writes to a terminal.
    assert!(!said.out.contains('\x1b') && !said.err.contains('\x1b'), "escape codes: {}", said.err);
    assert!(!said.err.contains("panicked"), "{}", said.err);
    said
}

impl Desk {
    pub fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Writes a file, as a user's scene.
    pub fn write(&self, name: &str, text: &str) -> PathBuf {
        let path = self.path(name);
        std::fs::write(&path, text).unwrap();
        path
    }

    /// The program with these arguments, started here.
    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_afmsweep"));
        command.args(arguments).current_dir(self.folder.path());
        command
    }

    pub fn call(&self, arguments: &[&str]) -> Said {
        said(self.command(arguments).output().unwrap())
    }

    /// A call that must succeed.
    pub fn works(&self, arguments: &[&str]) -> Said {
        let said = self.call(arguments);
        assert_eq!(said.code, Some(0), "{arguments:?}: {}{}", said.out, said.err);
        said
    }

    /// A call that must be refused with exit code 1, one that says all of `words` on standard error
    /// and nothing on standard output.
    pub fn refuses(&self, arguments: &[&str], words: &[&str]) -> Said {
        let said = self.call(arguments);
        assert_eq!(said.code, Some(1), "{arguments:?}: {}{}", said.out, said.err);
        assert_eq!(said.out, "", "{arguments:?}");
        assert!(said.err.starts_with("error: "), "{}", said.err);
        for word in words {
            assert!(said.err.contains(word), "{arguments:?} does not say {word:?}:\n{}", said.err);
        }
        said
    }

    /// Standard output as JSON, alone.
    pub fn json(&self, arguments: &[&str]) -> Value {
        let said = self.works(arguments);
        assert_eq!(said.err, "", "{arguments:?}");
        serde_json::from_str(&said.out).unwrap()
    }

    /// Runs a scene without an audit, which takes time, and reads its default results file back.
    pub fn run(&self, scene: &Path, more: &[&str]) -> Results {
        let mut arguments = vec!["run", scene.to_str().unwrap(), "-q", "--no-audit"];
        arguments.extend(more);
        let said = self.works(&arguments);
        assert_eq!((said.out.as_str(), said.err.as_str()), ("", ""));
        read(&self.results(scene)).unwrap()
    }

    /// Where a run of this scene puts its results unless told otherwise.
    pub fn results(&self, scene: &Path) -> PathBuf {
        let name = format!("{}.h5", scene.file_stem().unwrap().to_str().unwrap());
        self.path("results").join(name)
    }
}

/// The numbers of an array.
pub fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

/// A variable of the results.
pub fn variable<'a>(results: &'a Results, name: &str) -> &'a [f64] {
    let found = results.variables.iter().find(|variable| variable.name == name);
    &found.unwrap_or_else(|| panic!("no variable {name}")).data
}

/// Largest difference relative to the larger magnitude; equal values, NaN included, differ by 0.
pub fn difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    let one = |(a, b): (&f64, &f64)| {
        let same = a == b || (a.is_nan() && b.is_nan());
        if same { 0.0 } else { (a - b).abs() / a.abs().max(b.abs()) }
    };
    // NaN in one of the two must not slip through a maximum.
    a.iter().zip(b).map(one).fold(0.0, |most, d| if d.is_nan() { f64::INFINITY } else { f64::max(most, d) })
}
