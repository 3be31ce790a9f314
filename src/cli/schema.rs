//! `afmsweep schema`: the JSON schema of scene files.

use super::{print_json, words};
use afmsweep::scene;

/// Prints it.
pub fn main() -> anyhow::Result<()> {
    let rows = words::all();
    print_json(&scene::schema(&|path| words::of_key(&rows, path)))
}
