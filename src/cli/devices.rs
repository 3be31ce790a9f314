//! `afmsweep devices`: what could run a scene here.

use super::{print, print_json};
use serde_json::json;

#[derive(clap::Args)]
pub struct DevicesArgs {
    /// Machine-readable answer on standard output
    #[arg(long)]
    json: bool,
}

/// The processor's name, where the system tells it.
fn processor() -> String {
    let name = std::fs::read_to_string("/proc/cpuinfo").ok().and_then(|text| {
        let line = text.lines().find(|line| line.starts_with("model name"))?;
        Some(line.split_once(':')?.1.trim().to_owned())
    });
    name.unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}

pub fn main(args: &DevicesArgs) -> anyhow::Result<()> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    if args.json {
        return print_json(&json!({ "devices": [{
            "backend": "cpu",
            "name": processor(),
            "threads": threads,
            "precisions": ["f32", "f64"],
        }] }));
    }
    print(&format!("cpu  {}, {threads} threads, f32 and f64\n", processor()))
}
