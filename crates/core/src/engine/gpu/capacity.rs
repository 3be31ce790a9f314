//! Number of instances that a device takes at a time.

use super::newton::WALK;
use super::{AdapterReport, Gpu};
use crate::kernel::Entry;
use crate::kernel::broyden::state_modes;
use crate::plan::{Class, Plan};

/// Most bytes of Jacobians that are read back at once.
const SLOPE_BYTES: u64 = 256 << 20;

impl Gpu {
    /// Most bytes of a binding.
    pub(super) fn binding(&self) -> u64 {
        let bytes = |report: &AdapterReport| report.binding_bytes.min(report.buffer_bytes);
        self.reports().map(bytes).min().unwrap_or(0)
    }

    /// Most instances of a class on a device at a time; `bytes` is what each takes in the largest table.
    pub(super) fn at_most(&self, bytes: u64) -> usize {
        // Threads are numbered with 32 bits, workgroups up to the device's limit in two dimensions.
        let most = (self.binding() / bytes).min(1 << 24) as usize;
        self.chunk.map_or(most, |chunk| chunk.min(most)).max(1)
    }

    pub(super) fn capacity(&self, plan: &Plan, class: &Class) -> usize {
        let spec = plan.shader(class, Entry::Sweep);
        self.at_most(spec.bytes() * spec.state_fields().len().max(spec.case_fields().len()) as u64)
    }

    /// The same for periods with their Jacobians.
    pub(super) fn slope_capacity(&self, plan: &Plan, class: &Class) -> usize {
        let spec = plan.shader(class, Entry::Kicks);
        let (columns, fields) = ((2 * spec.modes).pow(2), spec.state_fields().len());
        // Kicks of at least two steps.
        let bytes = spec.bytes() * columns.max(fields).max(2 * spec.partials()) as u64;
        self.at_most(bytes).min((SLOPE_BYTES / bytes) as usize)
    }

    /// The same for searches by Broyden's method.
    pub(super) fn stride_capacity(&self, plan: &Plan, class: &Class) -> usize {
        let spec = plan.shader(class, Entry::Stride);
        let size = (2 * state_modes(spec.modes)).pow(2);
        let fields = spec.state_fields().len().max(spec.case_fields().len());
        let bytes = spec.bytes() * size.max(fields) as u64;
        self.at_most(bytes).min((SLOPE_BYTES / bytes) as usize)
    }

    /// The same for searches by Newton's method.
    pub(super) fn walk_capacity(&self, plan: &Plan, class: &Class) -> usize {
        let spec = plan.shader(class, Entry::Kicks);
        let bytes = spec.bytes() * (4 * spec.modes + WALK) as u64;
        self.slope_capacity(plan, class).min(self.at_most(bytes))
    }
}
