//! `afmsweep bench`: speed and error of each engine.

use super::{Verbosity, load, print, print_json};
use afmsweep::bench::{self, BenchOptions, GENERATOR, Machine};
use afmsweep::engine::gpu::{Gpu, adapters};
use afmsweep::engine::{Cpu, on_threads, processor};
use afmsweep::plan::Precision;
use afmsweep::report::{check_folder, save};
use afmsweep::scene::Scene;
use afmsweep::store::now;
use std::path::{Path, PathBuf};

/// What is benched unless a scene is named: the example sweep.
const SCENE: &str = include_str!("../../scenes/quickstart.toml");

#[derive(clap::Args)]
#[command(after_help = "Example: afmsweep bench scenes/quickstart.toml")]
pub struct BenchArgs {
    /// Scene file (TOML) [default: the example sweep, quickstart.toml]
    scene: Option<PathBuf>,
    /// Folder for the page, its picture and the numbers [default: results/bench/<device>]
    #[arg(short, long)]
    output: Option<PathBuf>,
    /// Sizes of the ensemble, by commas: the scene's sweep with about so many points
    #[arg(long, value_delimiter = ',', default_value = "1000,10000,100000,1000000", value_parser = clap::value_parser!(u32).range(1..=16_777_216))]
    sizes: Vec<u32>,
    /// Engines: auto has the CPU and a real GPU where there is one, gpu whatever adapter there is
    #[arg(long, value_enum, value_delimiter = ',', default_value = "auto")]
    backend: Vec<Which>,
    /// GPU adapter, by its index or a part of its name as `afmsweep devices` lists them
    #[arg(long, value_name = "ADAPTER")]
    device: Option<String>,
    /// Threads of the CPU engine [default: all cores]
    #[arg(long, value_name = "N", value_parser = super::backend::parse_threads)]
    threads: Option<usize>,
    /// Seconds that a measured run should take
    #[arg(long, value_name = "S", default_value_t = 1.0, value_parser = parse_seconds)]
    seconds: f64,
    /// Instances held against the reference
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u32).range(1..=10_000))]
    compared: u32,
    /// Machine-readable answer on standard output
    #[arg(long)]
    json: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Which {
    Auto,
    Cpu,
    Gpu,
}

fn parse_seconds(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(seconds) if (0.01..=600.0).contains(&seconds) => Ok(seconds),
        _ => Err("expected seconds from 0.01 to 600".into()),
    }
}

pub fn main(args: &BenchArgs, voice: Verbosity) -> anyhow::Result<()> {
    let (name, scene) = match &args.scene {
        Some(path) => (path.file_name().unwrap_or_default().to_string_lossy().into_owned(), load(path)?),
        None => ("quickstart.toml".into(), Scene::parse(Path::new("quickstart.toml"), SCENE)?),
    };
    let machines = on_threads(args.threads, || machines(args, voice))??;
    let gpu = machines.iter().find(|machine| machine.backend == "gpu");
    let device = gpu.map_or_else(processor, |machine| machine.engine.device());
    let folder = args.output.clone().unwrap_or_else(|| Path::new("results/bench").join(slug(&device)));
    // Minutes of measuring are not to end in a folder that cannot be written.
    check_folder(&folder, GENERATOR)?;
    let options = BenchOptions {
        sizes: args.sizes.iter().map(|size| *size as usize).collect(),
        seconds: args.seconds,
        repeats: 2,
        compared: args.compared as usize,
    };
    let measured = || bench::measure(&scene, &machines, &options, &|what| voice.say(what));
    let all = on_threads(args.threads, measured)??;
    let sizes: Vec<String> = args.sizes.iter().map(u32::to_string).collect();
    let mut backends: Vec<&str> = machines.iter().map(|machine| machine.backend).collect();
    backends.dedup();
    let command =
        format!("afmsweep bench {name} --backend {} --sizes {}", backends.join(","), sizes.join(","));
    let files = bench::files(&format!("{name} on {}", short(&device)), &command, &now(), &all);
    save(&folder, GENERATOR, &files)?;
    if args.json {
        print_json(&serde_json::json!({ "series": all }))?;
    } else {
        print(&aligned(&bench::table(&all)))?;
    }
    voice.say(format_args!("bench in {}", folder.join("index.html").display()));
    Ok(())
}

fn machines(args: &BenchArgs, voice: Verbosity) -> anyhow::Result<Vec<Machine>> {
    let has = |which| args.backend.contains(&which);
    let mut all = Vec::new();
    if has(Which::Cpu) || has(Which::Auto) {
        for precision in [Precision::F32, Precision::F64] {
            all.push(Machine { backend: "cpu", precision, engine: Box::new(Cpu::default()) });
        }
    }
    let real = adapters().into_iter().find(|adapter| !adapter.software());
    let wanted = match (&args.device, has(Which::Gpu), real) {
        (Some(device), ..) => Some(Some(device.clone())),
        (None, true, _) => Some(None),
        (None, false, Some(real)) if has(Which::Auto) => Some(Some(real.index.to_string())),
        _ => None,
    };
    match wanted {
        Some(wanted) => {
            let open = || Gpu::new(wanted.as_deref());
            let double = open()?.report().double;
            let precisions = if double { vec![Precision::F32, Precision::F64] } else { vec![Precision::F32] };
            for precision in precisions {
                all.push(Machine { backend: "gpu", precision, engine: Box::new(open()?) });
            }
        }
        None if has(Which::Auto) => {
            voice.say("no real GPU found: the CPU alone; --backend gpu takes a software driver too");
        }
        None => {}
    }
    Ok(all)
}

/// A device's name without what stands in brackets.
fn short(device: &str) -> &str {
    device.split(" (").next().unwrap_or(device).trim()
}

/// A folder's name for a device.
fn slug(device: &str) -> String {
    let letters = short(device).to_lowercase();
    let words: Vec<&str> =
        letters.split(|c: char| !c.is_ascii_alphanumeric()).filter(|w| !w.is_empty()).collect();
    if words.is_empty() { "device".into() } else { words.join("-") }
}

/// A table in columns, the first to the left, the others to the right.
fn aligned(rows: &[Vec<String>]) -> String {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |c: usize| rows.iter().filter_map(|row| row.get(c)).map(|cell| cell.chars().count()).max();
    let widths: Vec<usize> = (0..columns).map(|c| width(c).unwrap_or(0)).collect();
    let mut text = String::new();
    for row in rows {
        for (c, cell) in row.iter().enumerate() {
            text += &if c == 0 {
                format!("{cell:<w$}", w = widths[0])
            } else {
                format!("  {cell:>w$}", w = widths[c])
            };
        }
        text.push('\n');
    }
    text
}
