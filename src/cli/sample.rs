//! `afmsweep sample`: the points of a scene's samples alone, as CSV.

use super::cells::{head, number};
use super::table::TableArgs;
use super::{Verbosity, instances, write};
use afmsweep::report::defused;
use afmsweep::scene::{Axis, Scene};
use anyhow::bail;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "Examples: afmsweep sample uncertain.toml -o points.csv\n          \
                        afmsweep sample uncertain.toml | head")]
pub struct SampleArgs {
    /// Scene file (TOML) with [uncertain] and [design], or [samples]
    scene: PathBuf,
    /// File for the points [default: standard output]
    #[arg(short, long)]
    output: Option<PathBuf>,
    #[command(flatten)]
    table: TableArgs,
}

pub fn main(args: &SampleArgs, voice: Verbosity) -> anyhow::Result<()> {
    let scene = args.table.load(&args.scene)?;
    scene.warnings().iter().for_each(|line| voice.say(format_args!("warning: {line}")));
    let Some((columns, ids)) = samples(&scene) else {
        bail!(
            "{} has no samples; give it [uncertain] and [design], or [samples] (`afmsweep init --samples` writes one)",
            args.scene.display()
        );
    };
    let text = csv(&columns, ids)?;
    write(args.output.as_deref(), &text)?;
    if let Some(path) = &args.output {
        let rows = columns.first().map_or(0, |column| column.values.len());
        voice.say(format_args!("{} in {}", instances(rows), path.display()));
    }
    Ok(())
}

/// The quantities that vary together over the samples, and the names of these.
fn samples(scene: &Scene) -> Option<(Vec<&Axis>, &[String])> {
    if scene.sweep.layout == afmsweep::scene::Layout::List {
        return Some((scene.sweep.axes.iter().collect(), &[]));
    }
    let axis = scene.sweep.axes.iter().find(|axis| axis.path == "samples")?;
    Some((axis.columns.iter().collect(), &axis.words))
}

/// A header of paths and units, and the values in SI with all their digits: what `[design]` reads as a table.
fn csv(columns: &[&Axis], ids: &[String]) -> anyhow::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let id = (!ids.is_empty()).then(|| "id".to_owned());
    let header = columns.iter().map(|column| head(&column.path, &column.units));
    writer.write_record(id.into_iter().chain(header))?;
    let rows = columns.first().map_or(0, |column| column.values.len());
    for row in 0..rows {
        let values = columns.iter().map(|column| number(column.values[row]));
        writer.write_record(ids.get(row).map(|id| defused(id.clone())).into_iter().chain(values))?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}
