//! The GPU adapters of the machine, and the choice among them.

use super::GpuError;
use std::sync::OnceLock;
use wgpu::{Adapter, Backend, Backends, DeviceType, Features, Instance, InstanceDescriptor};

/// Capabilities of one adapter.
#[derive(Clone, Debug)]
pub struct AdapterReport {
    /// Index in the list, by which it can be requested.
    pub index: usize,
    pub name: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub kind: &'static str,
    /// `vulkan`, `metal`, `dx12`, ...
    pub interface: String,
    pub driver: String,
    /// Bus address, as `0000:65:00.0`; empty if the driver does not say.
    pub bus: String,
    /// Whether shaders can compute in f64.
    pub double: bool,
    /// Whether fusing of sums and products can be forbidden.
    pub strict: bool,
    /// Largest buffer visible to a shader, and largest buffer at all, bytes.
    pub binding_bytes: u64,
    pub buffer_bytes: u64,
    pub workgroups: u32,
    pub workgroup_threads: u32,
}

impl AdapterReport {
    /// Whether its driver computes on the processor.
    pub fn software(&self) -> bool {
        self.kind == "software"
    }

    /// Name and driver in one line, for messages and results files.
    pub fn title(&self) -> String {
        let driver = if self.driver.is_empty() { String::new() } else { format!(", {}", self.driver) };
        format!("{} ({} GPU, {}{driver})", self.name, self.kind, self.interface)
    }

    /// Whether both entries are the same card, which two manifests of one driver cause.
    fn is(&self, other: &Self) -> bool {
        !self.software() && !self.bus.is_empty() && self.bus == other.bus && self.title() == other.title()
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
        bus: info.device_pci_bus_id,
        strict: info.backend == Backend::Vulkan && adapter.features().contains(Features::PASSTHROUGH_SHADERS),
        double: adapter.features().contains(Features::SHADER_F64),
        binding_bytes: limits.max_storage_buffer_binding_size,
        buffer_bytes: limits.max_buffer_size,
        workgroups: limits.max_compute_workgroups_per_dimension,
        workgroup_threads: limits.max_compute_invocations_per_workgroup,
    }
}

/// The process's only connection to the drivers. It stays open: NVIDIA's driver 580 finds no card any more in a process that
/// has closed and opened it a few times.
fn instance() -> &'static Instance {
    static INSTANCE: OnceLock<Instance> = OnceLock::new();
    INSTANCE.get_or_init(|| {
        let mut descriptor = InstanceDescriptor::new_without_display_handle();
        descriptor.backends = Backends::VULKAN | Backends::METAL | Backends::DX12;
        Instance::new(descriptor)
    })
}

fn list() -> Vec<(Adapter, AdapterReport)> {
    let adapters = pollster::block_on(instance().enumerate_adapters(Backends::all()));
    adapters
        .into_iter()
        .enumerate()
        .map(|(index, adapter)| {
            let report = report(index, &adapter);
            (adapter, report)
        })
        .collect()
}

/// All adapters of this machine; empty if no driver is installed.
pub fn adapters() -> Vec<AdapterReport> {
    list().into_iter().map(|(_, report)| report).collect()
}

/// The indices of the adapters of each kind that has several cards. Cards of one kind have the same name, interface and
/// driver, and compute the same last bits.
pub fn alike(found: &[AdapterReport]) -> Vec<Vec<usize>> {
    let mut kinds: Vec<(String, Vec<&AdapterReport>)> = Vec::new();
    for one in found {
        match kinds.iter_mut().find(|kind| kind.0 == one.title()) {
            Some((_, cards)) if cards.iter().any(|card| card.is(one)) => {}
            Some((_, cards)) => cards.push(one),
            None => kinds.push((one.title(), vec![one])),
        }
    }
    let several = kinds.into_iter().filter(|kind| kind.1.len() > 1);
    several.map(|(_, cards)| cards.into_iter().map(|one| one.index).collect()).collect()
}

/// An adapter and its capabilities.
pub(super) type Found = (Adapter, AdapterReport);

/// The requested adapters, the first separately.
pub(super) fn choose(wanted: Option<&str>) -> Result<(Found, Vec<Found>), GpuError> {
    let (adapters, reports): (Vec<Adapter>, Vec<AdapterReport>) = list().into_iter().unzip();
    let places = places(&reports, wanted)?;
    let mut all: Vec<Option<Found>> = adapters.into_iter().zip(reports).map(Some).collect();
    let mut chosen = places.into_iter().filter_map(|place| all.get_mut(place)?.take());
    let first = chosen.next().ok_or(GpuError::NoAdapter)?;
    Ok((first, chosen.collect()))
}

/// Positions in the list of the requested adapters: one by its index or a part of its name, several separated by commas, or
/// `all` of the best one's kind; without a request the best one, software drivers last.
fn places(found: &[AdapterReport], wanted: Option<&str>) -> Result<Vec<usize>, GpuError> {
    let best = (0..found.len()).min_by_key(|place| found[*place].rank()).ok_or(GpuError::NoAdapter)?;
    let Some(wanted) = wanted else { return Ok(vec![best]) };
    if wanted == "all" {
        let kind = alike(found).into_iter().find(|kind| kind.contains(&found[best].index));
        let place = |index: &usize| found.iter().position(|one| one.index == *index);
        return Ok(kind.map_or(vec![best], |kind| kind.iter().filter_map(place).collect()));
    }
    let parts: Vec<&str> = wanted.split(',').map(str::trim).collect();
    let indices = parts.iter().all(|part| part.parse::<usize>().is_ok());
    // A name may contain a comma.
    if !indices && let Ok(place) = one(found, wanted) {
        return Ok(vec![place]);
    }
    let places = parts.into_iter().map(|part| one(found, part)).collect::<Result<Vec<_>, _>>()?;
    for (n, place) in places.iter().enumerate() {
        let listed = |other: &&usize| other == &place || found[**other].is(&found[*place]);
        if let Some(before) = places[..n].iter().find(listed) {
            let adapter = format!("{} {}", found[*before].index, found[*before].name);
            return Err(GpuError::Twice { wanted: wanted.into(), adapter });
        }
    }
    let mut kinds: Vec<String> = Vec::new();
    for one in places.iter().map(|place| &found[*place]) {
        if !kinds.iter().any(|kind| *kind == one.title()) {
            kinds.push(one.title());
        }
    }
    if kinds.len() > 1 {
        let of_one_kind = alike(found).into_iter().next().unwrap_or_default();
        return Err(GpuError::Kinds { wanted: wanted.into(), kinds, of_one_kind });
    }
    Ok(places)
}

/// The adapter with this index or part of a name.
fn one(found: &[AdapterReport], wanted: &str) -> Result<usize, GpuError> {
    let named = |report: &AdapterReport| match wanted.parse::<usize>() {
        Ok(index) => report.index == index,
        Err(_) => !wanted.is_empty() && report.name.to_lowercase().contains(&wanted.to_lowercase()),
    };
    found.iter().position(named).ok_or_else(|| GpuError::NoSuchAdapter {
        wanted: wanted.to_owned(),
        found: found.iter().map(|one| format!("{} {}", one.index, one.name)).collect(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A machine with these adapters: name, kind, bus.
    fn machine(adapters: &[(&str, &'static str, &str)]) -> Vec<AdapterReport> {
        let one = |(index, (name, kind, bus)): (usize, &(&str, &'static str, &str))| AdapterReport {
            index,
            name: (*name).into(),
            kind,
            interface: "vulkan".into(),
            driver: "1.0".into(),
            bus: (*bus).into(),
            double: true,
            strict: true,
            binding_bytes: 1 << 27,
            buffer_bytes: 1 << 31,
            workgroups: 65_535,
            workgroup_threads: 1024,
        };
        adapters.iter().enumerate().map(one).collect()
    }

    const BIG: (&str, &str) = ("Big 100", "discrete");
    const SOFT: (&str, &str) = ("soft (LLVM 15, 256 bits)", "software");

    fn node() -> Vec<AdapterReport> {
        machine(&[
            (SOFT.0, SOFT.1, ""),
            (BIG.0, BIG.1, "0000:01:00.0"),
            (BIG.0, BIG.1, "0000:02:00.0"),
            ("Small 5", "integrated", "0000:00:02.0"),
        ])
    }

    #[test]
    fn adapters_are_named_one_by_one_or_all_of_a_kind() {
        let found = node();
        let of = |wanted: &str| places(&found, Some(wanted)).expect("they are there");
        assert_eq!(places(&found, None).expect("there is one"), [1]);
        assert_eq!(of("2"), [2]);
        assert_eq!(of("small"), [3]);
        assert_eq!(of("1,2"), [1, 2]);
        assert_eq!(of("2, 1"), [2, 1]);
        assert_eq!(of("all"), [1, 2]);
        // A comma within a name separates nothing.
        assert_eq!(of("LLVM 15, 256"), [0]);
        assert_eq!(places(&found[..1], Some("all")).expect("there is one"), [0]);
        assert_eq!(alike(&found), [[1, 2]]);
    }

    #[test]
    fn what_cannot_be_dealt_to_is_refused_in_words() {
        let found = node();
        let why = |wanted: &str| places(&found, Some(wanted)).expect_err("it is refused").to_string();
        assert!(why("1,7").contains("no GPU adapter `7`; there is: 0 soft"), "{}", why("1,7"));
        assert!(why("1,").contains("no GPU adapter ``"), "{}", why("1,"));
        assert!(why("1,1").contains("`1,1` names the GPU adapter 1 Big 100 twice"), "{}", why("1,1"));
        assert!(why("big,big").contains("by its index"), "{}", why("big,big"));
        let kinds = why("1,3");
        assert!(kinds.contains("different kinds (Big 100 (discrete GPU, vulkan, 1.0); Small 5"), "{kinds}");
        assert!(kinds.ends_with("name adapters of one kind, as --device 1,2"), "{kinds}");
        assert!(places(&[], Some("all")).is_err());
    }

    /// Two manifests of a driver list each card twice.
    #[test]
    fn a_card_is_taken_once() {
        let (one, two) = ((BIG.0, BIG.1, "0000:01:00.0"), (BIG.0, BIG.1, "0000:02:00.0"));
        let found = machine(&[one, two, one, two]);
        assert_eq!(places(&found, Some("all")).expect("they are there"), [0, 1]);
        assert!(matches!(places(&found, Some("0,2")), Err(GpuError::Twice { .. })));
        let soft = machine(&[(SOFT.0, SOFT.1, ""), (SOFT.0, SOFT.1, "")]);
        assert_eq!(places(&soft, Some("all")).expect("they are there"), [0, 1]);
    }
}
