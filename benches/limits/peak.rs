//! The multiply-add peak, measured: chains of them and nothing else, enough side by side to hide their latency.

use afmsweep::plan::Precision;
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::*;
use std::hint::black_box;
use std::time::Instant;

/// Chains in flight, fewer than there are registers.
const CHAINS: usize = 12;
/// A few milliseconds.
const TURNS: u64 = 1_000_000;
const RUNS: usize = 50;

macro_rules! chains {
    ($name:ident, $features:literal, $number:ty, $lanes:literal, $splat:ident, $fused:ident, $store:ident) => {
        /// Turns of all chains, and the numbers in each.
        #[cfg(target_arch = "x86_64")]
        #[target_feature(enable = $features)]
        fn $name(turns: u64) -> (f64, usize) {
            let (scale, term) = ($splat(black_box(0.5)), $splat(black_box(0.25)));
            let mut all = [scale; CHAINS];
            for _ in 0..turns {
                for chain in &mut all {
                    *chain = $fused(*chain, scale, term);
                }
            }
            let mut sum = 0.0;
            for chain in all {
                let mut values: [$number; $lanes] = [0.0; $lanes];
                // SAFETY: the array has the register's size.
                unsafe { $store(values.as_mut_ptr(), chain) };
                sum += f64::from(values.iter().sum::<$number>());
            }
            (sum, $lanes)
        }
    };
}
chains!(avx512_single, "avx512f", f32, 16, _mm512_set1_ps, _mm512_fmadd_ps, _mm512_storeu_ps);
chains!(avx512_double, "avx512f", f64, 8, _mm512_set1_pd, _mm512_fmadd_pd, _mm512_storeu_pd);
chains!(avx2_single, "avx2,fma", f32, 8, _mm256_set1_ps, _mm256_fmadd_ps, _mm256_storeu_ps);
chains!(avx2_double, "avx2,fma", f64, 4, _mm256_set1_pd, _mm256_fmadd_pd, _mm256_storeu_pd);

macro_rules! portable {
    ($name:ident, $number:ty, $lanes:literal) => {
        /// What the compiler makes of arrays, by products and sums apart where it has nothing better.
        fn $name(turns: u64) -> (f64, usize) {
            let (scale, term) = (black_box(0.5), black_box(0.25));
            let mut all = [[scale; $lanes]; CHAINS];
            for _ in 0..turns {
                for chain in &mut all {
                    *chain = chain.map(|value: $number| match cfg!(target_arch = "aarch64") {
                        true => value.mul_add(scale, term),
                        false => value * scale + term,
                    });
                }
            }
            (f64::from(all.iter().flatten().sum::<$number>()), $lanes)
        }
    };
}
portable!(portable_single, f32, 4);
portable!(portable_double, f64, 2);

fn chains(precision: Precision, turns: u64) -> (f64, usize) {
    let single = precision == Precision::F32;
    #[cfg(target_arch = "x86_64")]
    {
        // SAFETY: each only where the processor has the instructions.
        if is_x86_feature_detected!("avx512f") {
            return unsafe { if single { avx512_single(turns) } else { avx512_double(turns) } };
        }
        // SAFETY: likewise.
        if is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma") {
            return unsafe { if single { avx2_single(turns) } else { avx2_double(turns) } };
        }
    }
    if single { portable_single(turns) } else { portable_double(turns) }
}

/// Multiply-adds per second of so many threads together, the best of many short runs.
pub fn cpu(precision: Precision, threads: usize) -> f64 {
    let work = move || {
        let start = Instant::now();
        let lanes = black_box(chains(precision, TURNS)).1;
        (TURNS * (CHAINS * lanes) as u64) as f64 / start.elapsed().as_secs_f64()
    };
    let best = (0..RUNS).map(|_| {
        std::thread::scope(|scope| {
            let all: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
            all.into_iter().map(|one| one.join().expect("it ends")).sum()
        })
    });
    best.fold(0.0, f64::max)
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
