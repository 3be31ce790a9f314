//! `afmsweep devices`: what could run a scene here.

use super::{print, print_json};
use afmsweep::engine::processor;
use serde_json::json;

#[derive(clap::Args)]
pub struct DevicesArgs {
    /// Machine-readable answer on standard output
    #[arg(long)]
    json: bool,
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
