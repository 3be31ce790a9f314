//! The multiply-add peak, measured: chains of them and nothing else, enough side by side to hide their latency.

use afmsweep::plan::Precision;
use std::hint::black_box;
use std::time::Instant;

/// Chains in flight: sixteen vectors of 64 bytes at most.
const CHAINS: usize = 12;
const TURNS: u64 = 40_000_000;

macro_rules! chains {
    ($name:ident, $number:ty, $lanes:expr) => {
        #[multiversion::multiversion(targets(
            "x86_64+avx512f+avx512vl+avx2+fma",
            "x86_64+avx2+fma",
            "aarch64+neon"
        ))]
        fn $name(turns: u64, scale: $number) -> $number {
            let mut all = [[scale; $lanes]; CHAINS];
            for _ in 0..turns {
                for chain in &mut all {
                    for value in chain.iter_mut() {
                        *value = value.mul_add(scale, 0.25);
                    }
                }
            }
            all.iter().flatten().sum()
        }
    };
}
chains!(single, f32, 16);
chains!(double, f64, 8);

/// Multiply-adds per second of all cores together.
pub fn cpu(precision: Precision) -> Option<f64> {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let turns = TURNS / 4;
    let work = move || match precision {
        Precision::F32 => f64::from(black_box(single(turns, black_box(0.5)))),
        Precision::F64 => black_box(double(turns, black_box(0.5))),
    };
    let lanes = if precision == Precision::F32 { 16 } else { 8 };
    let best = (0..3).map(|_| {
        let start = Instant::now();
        std::thread::scope(|scope| (0..threads).for_each(|_| drop(scope.spawn(work))));
        (turns * (CHAINS * lanes * threads) as u64) as f64 / start.elapsed().as_secs_f64()
    });
    Some(best.fold(0.0, f64::max))
}

/// Turns of a thread's loop, below what a software driver can do in one dispatch.
const GPU_TURNS: u32 = 16_384;
const GPU_CHAINS: usize = 8;
const WORKGROUP: u32 = 256;

/// The same on the best adapter; none where it has no such numbers.
pub fn gpu(precision: Precision) -> Option<f64> {
    let number = precision.name();
    let list = |piece: &dyn Fn(usize) -> String| (0..GPU_CHAINS).map(piece).collect::<String>();
    let text = format!(
        "@group(0) @binding(0) var<storage, read_write> out: array<{number}>;
        @compute @workgroup_size({WORKGROUP})
        fn chains(@builtin(global_invocation_id) id: vec3<u32>) {{
            let scale = {number}(0.5) + {number}(id.x) * {number}(1e-9);
            {}
            for (var turn = 0u; turn < {GPU_TURNS}u; turn++) {{ {} }}
            out[id.x] = {number}(0){};
        }}",
        list(&|c| format!("var v{c} = scale + {number}({c});\n")),
        list(&|c| format!("v{c} = fma(v{c}, scale, {number}(0.25));\n")),
        list(&|c| format!(" + v{c}")),
    );
    // fma does not take f64 in WGSL; there the driver is left to fuse.
    let text = if precision == Precision::F64 { unfused(&text) } else { text };
    pollster::block_on(dispatches(&text, precision))
}

fn unfused(text: &str) -> String {
    let lines = text.lines().map(|line| {
        let Some(at) = line.find("fma(") else { return line.to_owned() };
        let inside = &line[at + 4..line.rfind(");").unwrap_or(line.len())];
        let parts: Vec<&str> = inside.splitn(3, ", ").collect();
        format!("{}{} * {} + {};", &line[..at], parts[0], parts[1], parts[2])
    });
    lines.collect::<Vec<_>>().join("\n")
}

async fn dispatches(text: &str, precision: Precision) -> Option<f64> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
    let mut found = wgpu::Instance::new(descriptor).enumerate_adapters(wgpu::Backends::all()).await;
    found.sort_by_key(|adapter| match adapter.get_info().device_type {
        wgpu::DeviceType::DiscreteGpu => 0,
        wgpu::DeviceType::IntegratedGpu => 1,
        wgpu::DeviceType::VirtualGpu => 2,
        wgpu::DeviceType::Other => 3,
        wgpu::DeviceType::Cpu => 4,
    });
    let adapter = found.first()?;
    let software = adapter.get_info().device_type == wgpu::DeviceType::Cpu;
    let double = wgpu::Features::SHADER_F64;
    let features = if precision == Precision::F64 { double } else { wgpu::Features::empty() };
    if !adapter.features().contains(features) {
        return None;
    }
    let wanted = wgpu::DeviceDescriptor { required_features: features, ..Default::default() };
    let (device, queue) = adapter.request_device(&wanted).await.ok()?;
    let groups: u32 = if software { 64 } else { 8192 };
    let source = wgpu::ShaderSource::Wgsl(text.into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("chains"),
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: None,
        size: 8 * u64::from(groups * WORKGROUP),
        usage: wgpu::BufferUsages::STORAGE,
        mapped_at_creation: false,
    });
    let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: buffer.as_entire_binding() }],
    });
    let mut best: f64 = 0.0;
    for _ in 0..4 {
        let start = Instant::now();
        let mut encoder = device.create_command_encoder(&Default::default());
        {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &bindings, &[]);
            pass.dispatch_workgroups(groups, 1, 1);
        }
        queue.submit([encoder.finish()]);
        device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None }).ok()?;
        let count = f64::from(groups * WORKGROUP) * f64::from(GPU_TURNS) * GPU_CHAINS as f64;
        best = best.max(count / start.elapsed().as_secs_f64());
    }
    Some(best)
}
