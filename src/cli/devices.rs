//! `afmsweep devices`: what could run a scene here.

use super::{print, print_json};
use afmsweep::engine::gpu::{AdapterReport, adapters, alike};
use afmsweep::engine::processor;
use serde_json::{Value, json};

#[derive(clap::Args)]
#[command(after_help = "Example: afmsweep devices")]
pub struct DevicesArgs {
    /// Machine-readable answer on standard output
    #[arg(long)]
    json: bool,
}

pub fn main(args: &DevicesArgs) -> anyhow::Result<()> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let adapters = adapters();
    if args.json {
        let mut devices = vec![json!({
            "backend": "cpu",
            "name": processor(),
            "threads": threads,
            "precisions": ["f32", "f64"],
        })];
        devices.extend(adapters.iter().map(adapter_json));
        return print_json(&json!({ "devices": devices }));
    }
    let mut text = format!("cpu    {}, {threads} threads, f32 and f64\n", processor());
    for one in &adapters {
        text += &format!(
            "gpu {}  {}, {}{}; {} MiB a binding, {} MiB a buffer, workgroups of {} threads\n",
            one.index,
            one.title(),
            if one.double { "f32 and f64" } else { "f32" },
            if one.bus.is_empty() { String::new() } else { format!("; bus {}", one.bus) },
            one.binding_bytes >> 20,
            one.buffer_bytes >> 20,
            one.workgroup_threads,
        );
    }
    if adapters.is_empty() {
        text += "gpu    none: no Vulkan, Metal or DirectX 12 driver with an adapter was found\n";
    } else if adapters.iter().all(AdapterReport::software) {
        text +=
            "       only software adapters, which compute on the processor: --backend auto takes the cpu\n";
    }
    for kind in alike(&adapters) {
        let indices = kind.iter().map(ToString::to_string).collect::<Vec<_>>().join(",");
        text += &format!("       of one kind: --device {indices} deals a run out to all of them\n");
    }
    print(&text)
}

fn adapter_json(one: &AdapterReport) -> Value {
    json!({
        "backend": "gpu",
        "index": one.index,
        "name": one.name,
        "kind": one.kind,
        "interface": one.interface,
        "driver": one.driver,
        "bus": one.bus,
        "precisions": if one.double { vec!["f32", "f64"] } else { vec!["f32"] },
        "binding_bytes": one.binding_bytes,
        "buffer_bytes": one.buffer_bytes,
        "workgroups": one.workgroups,
        "workgroup_threads": one.workgroup_threads,
    })
}
