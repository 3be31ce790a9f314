//! Which GPUs there are, and which one to take.

use super::GpuError;
use wgpu::{Adapter, Backend, Backends, DeviceType, Features, Instance, InstanceDescriptor};

/// What one adapter can do.
#[derive(Clone, Debug)]
pub struct AdapterReport {
    /// Its place in the list, by which it can be asked for.
    pub index: usize,
    pub name: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub kind: &'static str,
    /// `vulkan`, `metal`, `dx12`, ...
    pub interface: String,
    pub driver: String,
    /// Whether shaders can compute in f64.
    pub double: bool,
    /// Whether it can be kept from fusing sums and products.
    pub strict: bool,
    /// Largest buffer that a shader can see, and largest buffer at all, bytes.
    pub binding_bytes: u64,
    pub buffer_bytes: u64,
    pub workgroups: u32,
    pub workgroup_threads: u32,
}

impl AdapterReport {
    /// Whether it is a driver that computes on the processor.
    pub fn software(&self) -> bool {
        self.kind == "software"
    }

    /// Name and driver in one line, for messages and results files.
    pub fn title(&self) -> String {
        let driver = if self.driver.is_empty() { String::new() } else { format!(", {}", self.driver) };
        format!("{} ({} GPU, {}{driver})", self.name, self.kind, self.interface)
    }

    fn rank(&self) -> usize {
        let order = ["discrete", "integrated", "virtual", "other", "software"];
        order.iter().position(|kind| *kind == self.kind).unwrap_or(order.len())
    }
}

fn report(index: usize, adapter: &Adapter) -> AdapterReport {
    let info = adapter.get_info();
    let limits = adapter.limits();
    AdapterReport {
        index,
        name: info.name,
        kind: match info.device_type {
            DeviceType::DiscreteGpu => "discrete",
            DeviceType::IntegratedGpu => "integrated",
            DeviceType::VirtualGpu => "virtual",
            DeviceType::Cpu => "software",
            DeviceType::Other => "other",
        },
        interface: info.backend.to_str().to_owned(),
        driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
        strict: info.backend == Backend::Vulkan && adapter.features().contains(Features::PASSTHROUGH_SHADERS),
        double: adapter.features().contains(Features::SHADER_F64),
        binding_bytes: limits.max_storage_buffer_binding_size,
        buffer_bytes: limits.max_buffer_size,
        workgroups: limits.max_compute_workgroups_per_dimension,
        workgroup_threads: limits.max_compute_invocations_per_workgroup,
    }
}

fn list() -> Vec<(Adapter, AdapterReport)> {
    let mut descriptor = InstanceDescriptor::new_without_display_handle();
    descriptor.backends = Backends::VULKAN | Backends::METAL | Backends::DX12;
    let adapters = pollster::block_on(Instance::new(descriptor).enumerate_adapters(Backends::all()));
    adapters
        .into_iter()
        .enumerate()
        .map(|(index, adapter)| {
            let report = report(index, &adapter);
            (adapter, report)
        })
        .collect()
}

/// Every adapter of this machine; none where no driver is installed.
pub fn adapters() -> Vec<AdapterReport> {
    list().into_iter().map(|(_, report)| report).collect()
}

/// The adapter asked for, by its index or a part of its name; else the best one there is, a software driver
/// last.
pub(super) fn choose(wanted: Option<&str>) -> Result<(Adapter, AdapterReport), GpuError> {
    let mut found = list();
    if found.is_empty() {
        return Err(GpuError::NoAdapter);
    }
    let place = match wanted {
        None => {
            let best = found.iter().enumerate().min_by_key(|(_, (_, report))| report.rank());
            best.map_or(0, |(place, _)| place)
        }
        Some(wanted) => {
            let named = |report: &AdapterReport| match wanted.parse::<usize>() {
                Ok(index) => report.index == index,
                Err(_) => report.name.to_lowercase().contains(&wanted.to_lowercase()),
            };
            found.iter().position(|(_, report)| named(report)).ok_or_else(|| GpuError::NoSuchAdapter {
                wanted: wanted.to_owned(),
                found: found.iter().map(|(_, one)| format!("{} {}", one.index, one.name)).collect(),
            })?
        }
    };
    Ok(found.swap_remove(place))
}
