//! One open device: its queue, its pipelines, and its first failure.

use super::adapter::AdapterReport;
use super::{Failure, GpuError, strict};
use crate::kernel::{Binding, ShaderSpec, WORKGROUP};
use std::borrow::Cow;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;
use wgpu::{
    BindGroupLayout, BindGroupLayoutDescriptor, BindGroupLayoutEntry, BindingType, Buffer, BufferBindingType,
    BufferUsages, ComputePipeline, DeviceDescriptor, Features, MapMode, PassthroughShaderEntryPoint,
    PipelineLayout, PipelineLayoutDescriptor, PollType, Queue, ShaderModule, ShaderModuleDescriptor,
    ShaderModuleDescriptorPassthrough, ShaderRuntimeChecks, ShaderSource, ShaderStages, SubmissionIndex,
};

/// Options for opening a device.
pub(super) struct Opening<'a> {
    pub adapter: &'a wgpu::Adapter,
    pub report: &'a AdapterReport,
    /// Index among the engine's devices.
    pub place: usize,
    pub strict: bool,
    /// Changes the shader's text before it is compiled.
    pub edit: Option<fn(String) -> String>,
}

/// A device and the pipelines compiled on it.
pub(super) struct Session {
    /// Index among the engine's devices.
    pub place: usize,
    pub device: wgpu::Device,
    pub queue: Queue,
    /// Whether the driver must round after each operation.
    strict: bool,
    edit: Option<fn(String) -> String>,
    pipelines: Mutex<Vec<(ShaderSpec, ComputePipeline)>>,
    trouble: Arc<Mutex<Option<Failure>>>,
}

/// Bytes of a buffer requested from a device.
pub(super) struct Later {
    copy: Buffer,
    size: u64,
    submitted: SubmissionIndex,
}

/// Parameters of one dispatch; `Job` of shaders/job.wgsl.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Job {
    pub instances: u32,
    pub drives: u32,
    pub steps: u32,
    pub first: u32,
    pub count: u32,
    /// Workgroups side by side; set at the dispatch.
    pub width: u32,
    /// The round of a search.
    pub round: u32,
}

/// Number of polls for the loss of a device after a driver has refused, and the pause between them.
const WORDS: u32 = 50;
const WORD: Duration = Duration::from_millis(2);

/// Keeps the first failure, because later ones are its consequences; but the loss of a device explains all.
fn note(trouble: &Mutex<Option<Failure>>, failure: Failure) {
    if let Ok(mut slot) = trouble.lock()
        && (slot.is_none() || matches!(failure, Failure::Lost(_)))
    {
        *slot = Some(failure);
    }
}

impl Session {
    /// Opens a device, with f64 if it has it, so that one session serves both precisions.
    pub fn open(opening: &Opening) -> Result<Self, GpuError> {
        let Opening { adapter, report, place, strict, edit } = *opening;
        let mut features = Features::empty();
        if report.double {
            features |= Features::SHADER_F64;
        }
        if strict {
            if !report.strict {
                return Err(GpuError::NoStrict(report.name.clone()));
            }
            features |= Features::PASSTHROUGH_SHADERS;
        }
        let descriptor = DeviceDescriptor {
            label: Some("afmsweep"),
            required_features: features,
            required_limits: adapter.limits(),
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&descriptor))
            .map_err(|error| GpuError::Device { adapter: report.name.clone(), why: error.to_string() })?;
        let trouble = Arc::new(Mutex::new(None));
        let seen = Arc::clone(&trouble);
        // The default handler ends the program.
        device.on_uncaptured_error(Arc::new(move |error| {
            let failure = match &error {
                wgpu::Error::OutOfMemory { .. } => Failure::Memory,
                _ => Failure::Refused(error.to_string()),
            };
            note(&seen, failure);
        }));
        let seen = Arc::clone(&trouble);
        device.set_device_lost_callback(move |reason, message| {
            note(&seen, Failure::Lost(format!("{reason:?} {message}").trim().to_owned()));
        });
        Ok(Self { device, queue, place, strict, edit, pipelines: Mutex::default(), trouble })
    }

    /// The cause of `failure`: the message of a lost device may come after its first consequences.
    pub fn cause(&self, failure: Failure) -> Failure {
        let mut cause = failure;
        for _ in 0..WORDS {
            // Polls for its callbacks only.
            let _ = self.device.poll(PollType::Poll);
            cause = self.check().err().unwrap_or(cause);
            if !matches!(cause, Failure::Refused(_)) {
                break;
            }
            std::thread::sleep(WORD);
        }
        cause
    }

    /// The failure so far, if any.
    pub fn check(&self) -> Result<(), Failure> {
        match self.trouble.lock() {
            Ok(slot) => slot.clone().map_or(Ok(()), Err),
            Err(_) => Err(Failure::Refused("the error record was left locked".into())),
        }
    }

    /// The compiled shader for `spec`, and the layout of its bindings.
    pub fn pipeline(&self, spec: ShaderSpec) -> Result<(ComputePipeline, BindGroupLayout), Failure> {
        let mut pipelines = self.pipelines.lock().unwrap_or_else(PoisonError::into_inner);
        let found = pipelines.iter().find(|(known, _)| *known == spec).map(|(_, pipeline)| pipeline.clone());
        let pipeline = match found {
            Some(pipeline) => pipeline,
            None => {
                let pipeline = self.compile(&spec)?;
                pipelines.push((spec, pipeline.clone()));
                pipeline
            }
        };
        let layout = pipeline.get_bind_group_layout(0);
        Ok((pipeline, layout))
    }

    fn compile(&self, spec: &ShaderSpec) -> Result<ComputePipeline, Failure> {
        let text = spec.compose();
        let text = self.edit.map_or_else(|| text.clone(), |edit| edit(text.clone()));
        let name = spec.entry.name();
        let module = if self.strict { self.strict_module(name, &text)? } else { self.module(name, text) };
        let layout = self.layout(spec);
        let pipeline = self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(spec.entry.name()),
            layout: Some(&layout),
            module: &module,
            entry_point: Some(spec.entry.name()),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        });
        self.check()?;
        Ok(pipeline)
    }

    fn module(&self, name: &str, text: String) -> ShaderModule {
        let source = ShaderSource::Wgsl(Cow::Owned(text));
        let descriptor = ShaderModuleDescriptor { label: Some(name), source };
        // An edited text may say anything.
        if self.edit.is_some() {
            return self.device.create_shader_module(descriptor);
        }
        // SAFETY: the text is our own. Every index is below the buffers' lengths if the thread's number is, which the entry
        // point checks. Its loops end after `job.count` iterations, one more, and 32 for each, or after as many as a state has
        // numbers, or their square.
        unsafe { self.device.create_shader_module_trusted(descriptor, ShaderRuntimeChecks::unchecked()) }
    }

    fn strict_module(&self, name: &str, text: &str) -> Result<ShaderModule, Failure> {
        let words = strict::compile(text, self.edit.is_some())?;
        let point =
            PassthroughShaderEntryPoint { name: name.to_owned().into(), workgroup_size: (WORKGROUP, 1, 1) };
        let descriptor = ShaderModuleDescriptorPassthrough {
            label: Some(name),
            entry_points: Cow::Owned(vec![point]),
            spirv: Some(Cow::Owned(words)),
            ..Default::default()
        };
        // SAFETY: as above, or each index of an edited text is checked; naga generates the words and has checked the text.
        Ok(unsafe { self.device.create_shader_module_passthrough(descriptor) })
    }

    /// The bindings, in order.
    fn layout(&self, spec: &ShaderSpec) -> PipelineLayout {
        let bindings = spec.bindings();
        let entries: Vec<BindGroupLayoutEntry> = bindings
            .iter()
            .enumerate()
            .map(|(binding, kind)| BindGroupLayoutEntry {
                binding: binding as u32,
                visibility: ShaderStages::COMPUTE,
                ty: BindingType::Buffer {
                    ty: match kind {
                        Binding::Uniform => BufferBindingType::Uniform,
                        Binding::Read => BufferBindingType::Storage { read_only: true },
                        Binding::Write => BufferBindingType::Storage { read_only: false },
                    },
                    has_dynamic_offset: false,
                    min_binding_size: None,
                },
                count: None,
            })
            .collect();
        let bindings = self
            .device
            .create_bind_group_layout(&BindGroupLayoutDescriptor { label: None, entries: &entries });
        self.device.create_pipeline_layout(&PipelineLayoutDescriptor {
            label: None,
            bind_group_layouts: &[Some(&bindings)],
            ..Default::default()
        })
    }

    /// Dispatches a job with these buffers, the job's own first, in the order of the bindings.
    pub fn dispatch(
        &self,
        spec: ShaderSpec,
        job: Job,
        threads: u32,
        buffers: &[&Buffer],
    ) -> Result<SubmissionIndex, Failure> {
        let groups = threads.div_ceil(WORKGROUP);
        let job = Job { width: groups.min(1 << 15), ..job };
        self.queue.write_buffer(buffers[0], 0, bytemuck::bytes_of(&job));
        let (pipeline, layout) = self.pipeline(spec)?;
        let resources = buffers.iter().map(|buffer| buffer.as_entire_binding());
        let entries: Vec<wgpu::BindGroupEntry> = (0..)
            .zip(resources)
            .map(|(binding, resource)| wgpu::BindGroupEntry { binding, resource })
            .collect();
        let descriptor = wgpu::BindGroupDescriptor { label: None, layout: &layout, entries: &entries };
        let bindings = self.device.create_bind_group(&descriptor);
        let mut encoder = self.device.create_command_encoder(&Default::default());
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &bindings, &[]);
        pass.dispatch_workgroups(job.width, groups.div_ceil(job.width), 1);
        drop(pass);
        let submitted = self.queue.submit([encoder.finish()]);
        self.check()?;
        Ok(submitted)
    }

    /// A buffer that holds `bytes`.
    pub fn buffer(&self, label: &str, bytes: &[u8], usage: BufferUsages) -> Result<Buffer, Failure> {
        let buffer = self.empty(label, bytes.len() as u64, usage | BufferUsages::COPY_DST)?;
        self.queue.write_buffer(&buffer, 0, bytes);
        self.check()?;
        Ok(buffer)
    }

    pub fn empty(&self, label: &str, size: u64, usage: BufferUsages) -> Result<Buffer, Failure> {
        let size = size.next_multiple_of(4).max(16);
        let descriptor =
            wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false };
        let buffer = self.device.create_buffer(&descriptor);
        self.check()?;
        Ok(buffer)
    }

    /// Requests bytes of a buffer, as they are now; the buffer must allow copies.
    pub fn later(&self, buffer: &Buffer, first: u64, size: u64) -> Result<Later, Failure> {
        let copy = self.empty("readback", size, BufferUsages::MAP_READ | BufferUsages::COPY_DST)?;
        let mut encoder = self.device.create_command_encoder(&Default::default());
        encoder.copy_buffer_to_buffer(buffer, first, &copy, 0, Some(size));
        let submitted = self.queue.submit([encoder.finish()]);
        // An error shows when the range is read.
        copy.slice(..).map_async(MapMode::Read, |_| ());
        Ok(Later { copy, size, submitted })
    }

    /// Waits for requested bytes.
    pub fn now(&self, later: &Later) -> Result<Vec<u8>, Failure> {
        self.wait(later.submitted.clone())?;
        let view = later.copy.slice(..later.size).get_mapped_range();
        view.map(|view| view.to_vec()).map_err(|error| Failure::Lost(error.to_string()))
    }

    /// Waits until everything up to that submission is done.
    pub fn wait(&self, submission: SubmissionIndex) -> Result<(), Failure> {
        let poll = PollType::Wait { submission_index: Some(submission), timeout: None };
        let polled = self.device.poll(poll);
        self.check()?;
        polled.map(|_| ()).map_err(|error| Failure::Lost(error.to_string()))
    }

    /// The contents of buffers that allow copies: for each, the given number of bytes.
    pub fn read(&self, buffers: &[(&Buffer, u64)]) -> Result<Vec<Vec<u8>>, Failure> {
        let copies: Vec<Later> =
            buffers.iter().map(|(buffer, size)| self.later(buffer, 0, *size)).collect::<Result<_, _>>()?;
        copies.iter().map(|copy| self.now(copy)).collect()
    }
}
