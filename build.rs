//! Tells the program which revision of its sources it is built from.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed=AFMSWEEP_REVISION");
    // A package that was unpacked inside another project must not take that project's revision for its own.
    if !Path::new(".git").exists() {
        return println!("cargo::rustc-env=AFMSWEEP_REVISION={}", given().unwrap_or("unknown".into()));
    }
    // Every commit and every checkout writes a line there; what is changed and not committed is built with the sources.
    for path in [".git/logs/HEAD", "src", "crates", "shaders", "Cargo.toml", "Cargo.lock"] {
        if Path::new(path).exists() {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    let revision = given().or_else(described).unwrap_or("unknown".into());
    println!("cargo::rustc-env=AFMSWEEP_REVISION={revision}");
}

/// What whoever builds it says: a packager without a repository.
fn given() -> Option<String> {
    std::env::var("AFMSWEEP_REVISION").ok().filter(|text| !text.trim().is_empty())
}

/// The newest tag and the commit, or the commit alone; `-dirty` where tracked files differ from it.
fn described() -> Option<String> {
    let output = Command::new("git")
        .args(["describe", "--tags", "--always", "--dirty", "--abbrev=12"])
        .output()
        .ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    Some(text.trim().to_owned()).filter(|text| output.status.success() && !text.is_empty())
}
