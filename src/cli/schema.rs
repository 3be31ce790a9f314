//! `afmsweep schema`: the JSON schema of scene files.

use super::{glossary, print_json};
use afmsweep::scene;

/// Prints it.
pub fn main() -> anyhow::Result<()> {
    let rows = glossary::all();
    print_json(&scene::schema(&|path| glossary::of_key(&rows, path)))
}
