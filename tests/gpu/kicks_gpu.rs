//! Each law's kick on the GPU against the CPU's in f64, function by function: what a driver makes of sums,
//! products, quotients and roots.
//!
//! Without any GPU adapter these tests are listed as ignored.

use afmsweep::contact::Law;
use afmsweep::engine::gpu::AdapterReport;
use afmsweep::kernel::contact::{Approach, Interaction, Kick};
use afmsweep::kernel::{Entry, Lane, ShaderSpec, WORKGROUP, WithLaw};
use afmsweep::observe::Wants;
use bytemuck::cast_slice;
use libtest_mimic::{Failed, Trial};
use wgpu::util::{BufferInitDescriptor, DeviceExt};

const COUNT: usize = 1 << 16;

/// Largest error beside the CPU's own in f32, of impulse and shift relative to the terms they are the sum of, and of
/// the share of the step in contact. Seen on lavapipe: 1.0, at 2.7e-7 (Hertz, DMT) and 7e-7 (JKR).
const TIMES: f64 = 4.0;

/// Numbers between 0 and 1: a van der Corput sequence in one base for each use.
fn spread(i: usize, base: usize) -> f64 {
    let (mut i, mut part, mut sum) = (i + 1, 1.0, 0.0);
    while i > 0 {
        part /= base as f64;
        sum += part * (i % base) as f64;
        i /= base;
    }
    sum
}

/// Soft to stiff, sticky or not, slow to fast, in and out of contact. Every second one that touched before.
fn approach(i: usize) -> (Approach<f64>, f64) {
    let reach = 10f64.powf(-3.0 + 4.0 * spread(i, 2));
    let indentation = reach * (2.0 * spread(i, 3) - 1.0);
    let speed = reach * (4.0 * spread(i, 5) - 2.0);
    let acceleration = 0.1 * reach * (2.0 * spread(i, 7) - 1.0);
    // As f32 holds them, for both.
    let single = |value: f64| f64::from(value as f32);
    let approach = Approach {
        indentation: single(indentation),
        speed: single(speed),
        acceleration: single(acceleration),
        memory: [0.0; 2],
    };
    (approach, f64::from(u8::from(i.is_multiple_of(2))))
}

/// Constants by instance, in the order of the shader's fields.
fn constants(i: usize, law: Law) -> Vec<f64> {
    let stiffness = 10f64.powf(-4.0 + 4.0 * spread(i, 11));
    let constant = |field: &&str| match *field {
        "stiffness" => stiffness,
        "adhesion" | "unit_force" => stiffness * spread(i, 13),
        "ad_hoc" => (i % 2) as f64,
        _ => 1.0 + 9.0 * spread(i, 17),
    };
    law.fields().iter().map(constant).map(|value| f64::from(value as f32)).collect()
}

/// A kick, of a law with these constants.
struct KickOf<L> {
    constants: Vec<L>,
    at: Approach<L>,
    touching: L,
}

impl<L: Lane> WithLaw<L> for KickOf<L> {
    type Output = Kick<L>;

    fn with<I: Interaction<L>>(self) -> Kick<L> {
        let mut constants = self.constants.into_iter();
        I::from_numbers(|| constants.next().expect("a number for each field")).kick(self.at, self.touching)
    }
}

/// The kick on the CPU.
fn on_cpu<L: Lane + From<f32>>(law: Law, i: usize, shift: f64) -> Kick<L> {
    let single = |value: f64| L::from(value as f32);
    let (at, touching) = approach(i);
    let at = Approach {
        indentation: L::from_lanes(|_| at.indentation + shift),
        speed: single(at.speed),
        acceleration: single(at.acceleration),
        memory: [single(0.0); 2],
    };
    let constants = constants(i, law).into_iter().map(single).collect();
    law.with(KickOf { constants, at, touching: single(touching) })
}

/// The size of the terms that an impulse is made of.
fn size(i: usize, law: Law) -> f64 {
    let (at, _) = approach(i);
    let c = constants(i, law);
    let deepest = at.indentation.abs() + at.speed.abs() + at.acceleration.abs();
    match law {
        Law::Hertz => c[0] * deepest.powf(1.5),
        Law::Dmt => c[0] * deepest.powf(1.5) + c[1],
        _ => c[0] * (1.0 + (deepest * c[1]).powf(1.5)),
    }
}

fn spec(law: Law) -> ShaderSpec {
    let wants = Wants::FUNDAMENTAL;
    let entry = Entry::Sweep;
    let (measured, decay, double, one_drive) = (false, false, false, true);
    ShaderSpec { entry, law, modes: 1, wants, measured, decay, double, one_drive }
}

/// The kicks by the best adapter: [4][instance].
async fn kicks(law: Law) -> Vec<f32> {
    let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
    descriptor.backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
    let mut found = wgpu::Instance::new(descriptor).enumerate_adapters(wgpu::Backends::all()).await;
    found.sort_by_key(|adapter| adapter.get_info().device_type == wgpu::DeviceType::Cpu);
    let (device, queue) = found[0].request_device(&Default::default()).await.expect("an adapter opens");
    let spec = spec(law);
    let text = spec.law_text() + include_str!("kicks.wgsl");
    let source = wgpu::ShaderSource::Wgsl(text.into());
    let module = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source });
    let pipeline = device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: None,
        layout: None,
        module: &module,
        entry_point: Some("kick"),
        compilation_options: Default::default(),
        cache: None,
    });
    let fields = spec.case_fields().len();
    let mut cases = vec![0f32; fields * COUNT];
    let mut approaches = vec![0f32; 4 * COUNT];
    for i in 0..COUNT {
        for (field, value) in constants(i, law).into_iter().enumerate() {
            cases[(field + 1) * COUNT + i] = value as f32;
        }
        let (at, touching) = approach(i);
        for (field, value) in [at.indentation, at.speed, at.acceleration, touching].into_iter().enumerate() {
            approaches[field * COUNT + i] = value as f32;
        }
    }
    let buffer = |bytes: &[u8], usage| {
        device.create_buffer_init(&BufferInitDescriptor { label: None, contents: bytes, usage })
    };
    let storage = wgpu::BufferUsages::STORAGE;
    let out = buffer(cast_slice(&vec![0f32; 4 * COUNT]), storage | wgpu::BufferUsages::COPY_SRC);
    let buffers = [
        buffer(cast_slice(&[COUNT as u32, 0, 0, 0]), wgpu::BufferUsages::UNIFORM),
        buffer(cast_slice(&cases), storage),
        buffer(cast_slice(&approaches), storage),
    ];
    let entries: Vec<wgpu::BindGroupEntry> = (buffers.iter().chain([&out]).enumerate())
        .map(|(n, one)| wgpu::BindGroupEntry { binding: n as u32, resource: one.as_entire_binding() })
        .collect();
    let layout = pipeline.get_bind_group_layout(0);
    let bindings = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &layout,
        entries: &entries,
    });
    let usage = wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST;
    let back = buffer(cast_slice(&vec![0f32; 4 * COUNT]), usage);
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bindings, &[]);
        pass.dispatch_workgroups(COUNT as u32 / WORKGROUP, 1, 1);
    }
    encoder.copy_buffer_to_buffer(&out, 0, &back, 0, None);
    queue.submit([encoder.finish()]);
    back.slice(..).map_async(wgpu::MapMode::Read, |_| ());
    device.poll(wgpu::PollType::Wait { submission_index: None, timeout: None }).expect("it ends");
    let view = back.slice(..).get_mapped_range().expect("it is mapped");
    bytemuck::pod_collect_to_vec(&view)
}

/// A decision, touching or not, that the last bits decide: some near neighbour has it the other way.
fn undecided(i: usize, law: Law) -> bool {
    let (at, _) = approach(i);
    let unit = if law == Law::Jkr { 3.0 / constants(i, law)[1] } else { 0.0 };
    let near = 3e-7 * (at.indentation.abs() + at.speed.abs() + at.acceleration.abs() + unit);
    on_cpu::<f64>(law, i, near).touching != on_cpu::<f64>(law, i, -near).touching
}

fn kicks_agree(law: Law) -> Result<(), Failed> {
    let ours = pollster::block_on(kicks(law));
    // Impulse, share and shift: the GPU's largest errors, and the CPU's in f32.
    let (mut errors, mut cpu) = ([0.0f64; 3], [0.0f64; 3]);
    let (mut left, mut acting) = (0, 0);
    for i in 0..COUNT {
        let truth = on_cpu::<f64>(law, i, 0.0);
        let single = on_cpu::<f32>(law, i, 0.0);
        let got = |field: usize| f64::from(ours[field * COUNT + i]);
        if undecided(i, law) {
            left += 1;
            continue;
        }
        assert_eq!(got(2), truth.touching, "{law} {i}: touching");
        acting += usize::from(truth.impulse != 0.0);
        let scale = size(i, law);
        errors[0] = errors[0].max((got(0) - truth.impulse).abs() / scale);
        errors[1] = errors[1].max((got(1) - truth.contact).abs());
        errors[2] = errors[2].max((got(3) - truth.shift).abs() / scale);
        cpu[0] = cpu[0].max((f64::from(single.impulse) - truth.impulse).abs() / scale);
        cpu[1] = cpu[1].max((f64::from(single.contact) - truth.contact).abs());
        cpu[2] = cpu[2].max((f64::from(single.shift) - truth.shift).abs() / scale);
    }
    println!(
        "{law}: impulse within {:.1e} (CPU in f32 {:.1e}), share {:.1e} ({:.1e}), shift {:.1e} ({:.1e}); {acting} of {COUNT} act, {left} on the edge",
        errors[0], cpu[0], errors[1], cpu[1], errors[2], cpu[2]
    );
    for (ours, theirs) in errors.iter().zip(cpu) {
        assert!(*ours <= TIMES * theirs, "{law}: {ours:e}, the CPU in f32 {theirs:e}");
    }
    assert!(acting > COUNT / 4 && left < COUNT / 1000, "{acting} act, {left} left out");
    Ok(())
}

/// The tests of this file, of which those run that the adapters found can run. A law with tables is compared in whole runs
/// alone: its tables follow those of the drives.
pub fn tests(found: &[AdapterReport]) -> Vec<Trial> {
    let ignored = found.is_empty();
    let tests = Law::ALL.into_iter().filter(|law| law.acts() && !law.is_sum()).map(|law| {
        Trial::test(format!("kicks_are_the_cpus_{law}"), move || kicks_agree(law)).with_ignored_flag(ignored)
    });
    tests.collect()
}
