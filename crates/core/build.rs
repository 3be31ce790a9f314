//! Tells the program which revision of its sources its numbers come from.

use std::path::Path;
use std::process::Command;

/// What results follow from. Commands and pictures do not stand here: a change in them leaves this crate as it is built.
const SOURCES: &[&str] =
    &["crates/core", "crates/data", "crates/kernel", "crates/model", "shaders", "Cargo.toml", "Cargo.lock"];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=AFMSWEEP_REVISION");
    // A package that was unpacked inside another project must not take that project's revision for its own.
    let root = Path::new("../..");
    if !(root.join(".git").exists() && root.join("crates/core/build.rs").exists()) {
        return println!("cargo::rustc-env=AFMSWEEP_REVISION={}", given().unwrap_or("unknown".into()));
    }
    // Every commit and every checkout writes a line there; what is changed and not committed is built with the sources.
    for path in SOURCES.iter().chain(&[".git/logs/HEAD"]).map(|path| root.join(path)) {
        if path.exists() {
            println!("cargo::rerun-if-changed={}", path.display());
        }
    }
    let revision = given().or_else(|| described(root)).unwrap_or("unknown".into());
    println!("cargo::rustc-env=AFMSWEEP_REVISION={revision}");
}

/// What whoever builds it says: a packager without a repository.
fn given() -> Option<String> {
    std::env::var("AFMSWEEP_REVISION").ok().filter(|text| !text.trim().is_empty())
}

/// The newest tag and the commit, or the commit alone; `-dirty` where what computes differs from it.
fn described(root: &Path) -> Option<String> {
    let git = |arguments: &[&str]| Command::new("git").arg("-C").arg(root).args(arguments).output().ok();
    let output = git(&["describe", "--tags", "--always", "--abbrev=12"])?;
    let text = String::from_utf8(output.stdout).ok()?.trim().to_owned();
    if !output.status.success() || text.is_empty() {
        return None;
    }
    let same = git(&[&["diff", "--quiet", "HEAD", "--"], SOURCES].concat())?.status.success();
    Some(if same { text } else { text + "-dirty" })
}
