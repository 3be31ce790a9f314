//! `afmsweep explain WORD`: what a word of a scene, of a results file or of a message means.
//!
//! Its answers are the rows of the tables in docs/scene.md and docs/results.md.

use super::glossary::{GlossaryRow, all};
use super::print;
use afmsweep::scene::{self, Meant};
use anyhow::bail;
use std::collections::BTreeSet;

#[derive(clap::Args)]
#[command(
    after_help = "Examples: afmsweep explain accuracy_not_met\n          afmsweep explain approach.gap"
)]
pub struct ExplainArgs {
    /// A key of a scene, an observable, a status, an attribute or a variable of a results file; without it, all words
    word: Vec<String>,
}

/// All words in their order.
fn words<'a>(rows: &[GlossaryRow<'a>]) -> Vec<&'a str> {
    let words: BTreeSet<&str> = rows.iter().flat_map(GlossaryRow::words).collect();
    words.into_iter().collect()
}

pub fn main(args: &ExplainArgs) -> anyhow::Result<()> {
    let rows = all();
    if args.word.is_empty() {
        return print(&(words(&rows).join("\n") + "\n"));
    }
    // As it is written, or as names here are: `set-point` and `contact time` with underscores.
    let spelled = args.word.join("_");
    let named = |word: &str| rows.iter().any(|row| row.names(word)) || scene::meant(word).is_some();
    let word = &if named(&spelled) { spelled } else { spelled.replace('-', "_") };
    let found: Vec<String> = rows.iter().filter(|row| row.names(word)).map(GlossaryRow::told).collect();
    if found.is_empty()
        && let Some(meant) = scene::meant(word)
    {
        return match meant {
            Meant::Instead(text) => print(&format!("{word}: {text}\n")),
            Meant::Name(name) => {
                let told: Vec<String> =
                    rows.iter().filter(|row| row.names(name)).map(GlossaryRow::told).collect();
                print(&format!("{word}: here that is {name}\n\n{}", told.join("\n")))
            }
        };
    }
    if found.is_empty() {
        let like: Vec<&str> = words(&rows).into_iter().filter(|one| one.contains(&**word)).collect();
        match like.as_slice() {
            [] => {
                let near = scene::nearest(word, rows.iter().flat_map(|row| row.words()));
                let meant = near.map_or_else(String::new, |one| format!(" did you mean {one}?"));
                bail!(
                    "nothing is known of \"{word}\";{meant} `afmsweep explain` without a word lists what there is"
                )
            }
            some => bail!("nothing is called \"{word}\"; there is {}", some[..some.len().min(8)].join(", ")),
        }
    }
    print(&found.join("\n"))
}
