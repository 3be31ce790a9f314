//! Points of another program for a scene: `--table` and `--names`.

use super::{STANDARD_INPUT, load};
use afmsweep::scene::Scene;
use anyhow::Context;
use std::path::{Path, PathBuf};

/// Points to run a scene at.
#[derive(clap::Args)]
pub struct TableArgs {
    /// Run the scene at the points of this table: CSV with a header of paths and units, or with --names plain columns
    #[arg(long, value_name = "FILE")]
    table: Option<PathBuf>,
    /// Paths of the columns of a table without a header, in SI units: "instrument.tip.radius,sample.youngs_modulus"
    #[arg(long, value_name = "PATHS", requires = "table", value_delimiter = ',')]
    names: Vec<String>,
}

impl TableArgs {
    /// Reads the scene, with the table as its `[design]`.
    pub fn load(&self, path: &Path) -> anyhow::Result<Scene> {
        let Some(table) = &self.table else { return load(path) };
        // As a scene that says so itself: whoever reads the results sees where the points came from.
        let (path, text) = match path == Path::new(STANDARD_INPUT.0) {
            true => (Path::new(STANDARD_INPUT.1), std::io::read_to_string(std::io::stdin())),
            false => (path, std::fs::read_to_string(path)),
        };
        let text = text.with_context(|| format!("cannot read {}", path.display()))?;
        let quoted = |text: &str| toml::Value::String(text.to_owned()).to_string();
        let beside = path.parent().is_none_or(|folder| folder.as_os_str().is_empty());
        // A scene looks for its files in its own folder.
        let table = if beside { table.clone() } else { std::path::absolute(table)? };
        let names = match self.names.as_slice() {
            [] => String::new(),
            names => {
                let names: Vec<String> = names.iter().map(|name| quoted(name.trim())).collect();
                format!("names = [{}]\n", names.join(", "))
            }
        };
        let file = quoted(&table.to_string_lossy());
        let text = format!("{}\n\n[design]\nkind = \"table\"\nfile = {file}\n{names}", text.trim_end());
        Ok(Scene::parse(path, &text)?)
    }
}
