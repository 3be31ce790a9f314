//! The search for one instance's state within a batch.

use super::PeriodicState;
use super::free_jacobian::free_monodromy;
use super::initial_guess::CurvePrediction;
use super::period_map::{transfer_with_jacobian, vector};
use super::tolerances::newton_options;
use crate::engine::PeriodJacobian;
use crate::periodic::{Memory, NewtonOptions, PtcNewton, Size};
use crate::plan::{Plan, SectionState};
use nalgebra::{DefaultAllocator, DimName, OMatrix, OVector};

/// Indices of the instance's own travels, then rates, among a state's `numbers`; `None` if it has all of them.
fn moving(plan: &Plan, instance: u32, numbers: usize) -> Option<Vec<usize>> {
    let (modes, most) = (plan.pairs(instance), numbers / 2);
    (modes < most).then(|| (0..modes).chain((most..).take(modes)).collect())
}

/// Pads a Jacobian, given column by column, to the size of the search. The added modes are at rest.
pub(super) fn padded<D: Size + DimName>(slope: &[f64]) -> OMatrix<f64, D, D>
where
    DefaultAllocator: Memory<D>,
{
    let own = slope.len().isqrt();
    let place = |n: usize| if n < own / 2 { n } else { D::DIM / 2 + n - own / 2 };
    let mut all = OMatrix::<f64, D, D>::zeros();
    for (n, value) in slope.iter().enumerate() {
        all[(place(n % own), place(n / own))] = *value;
    }
    all
}

/// The search of one instance.
pub(super) struct InstanceSearch<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    /// Number in the batch.
    pub slot: u32,
    /// Periods stepped before the search.
    pub periods: u32,
    /// Initial guess. Contact at the start of a period keeps its value from here.
    pub start: SectionState,
    /// Whether contact depends on the past and not on the indentation alone.
    remembers: bool,
    pub search: PtcNewton<D>,
}

impl<D: Size + DimName> InstanceSearch<D>
where
    DefaultAllocator: Memory<D>,
{
    pub fn cold(plan: &Plan, slot: u32, instance: u32, start: SectionState) -> Self {
        let (remembers, options) = newton_options(plan, instance);
        let (slope, columns) = free_monodromy(plan, instance);
        Self {
            slot,
            periods: 0,
            start,
            remembers,
            search: PtcNewton::with_partial_jacobian(vector(&start), slope, columns, options)
                .restricted_to(moving(plan, instance, D::DIM)),
        }
    }

    /// Starts from a state with other steps or another lever.
    pub fn from_known(plan: &Plan, slot: u32, instance: u32, place: &PeriodicState) -> Self {
        let (remembers, options) = newton_options(plan, instance);
        let (start, slope) = transfer_with_jacobian::<D>(plan, instance, place);
        let search = PtcNewton::near_fixed_point(vector(&start), slope, place.floquet, options);
        let search = search.restricted_to(moving(plan, instance, D::DIM));
        Self { slot, periods: 0, start, remembers, search }
    }

    /// Starts from a curve's prediction. The Jacobian of the curve's last point, if it is known, serves on the way; stability
    /// needs the state's own.
    pub fn along_curve(
        plan: &Plan,
        slot: u32,
        instance: u32,
        last: Option<&PeriodicState>,
        along: &CurvePrediction,
    ) -> Self {
        let start = along.places[instance as usize];
        let (remembers, options) = newton_options(plan, instance);
        let moving = moving(plan, instance, D::DIM);
        let lightly = along.accept_unverified.get(instance as usize).copied().unwrap_or(false);
        let options = NewtonOptions {
            start_is_close: true,
            reuse_jacobian: last.is_some(),
            max_evaluations: along.max_evaluations.0
                + along.max_evaluations.1 * moving.as_ref().map_or(D::DIM, Vec::len) as u32,
            central_fd_step: options.central_fd_step.filter(|_| !lightly),
            require_stable: !lightly,
            ..options
        };
        let search = match last {
            Some(last) => {
                let slope = transfer_with_jacobian::<D>(plan, instance, last).1;
                PtcNewton::with_partial_jacobian(vector(&start), slope, (0..D::DIM).collect(), options)
            }
            None => PtcNewton::new(vector(&start), options),
        };
        let search = search.restricted_to(moving);
        Self { slot, periods: 0, start, remembers, search }
    }

    /// Starts close to a state whose Jacobian is unknown.
    pub fn near(plan: &Plan, slot: u32, instance: u32, start: SectionState) -> Self {
        let (remembers, options) = newton_options(plan, instance);
        let search = PtcNewton::new(vector(&start), NewtonOptions { start_is_close: true, ..options });
        let search = search.restricted_to(moving(plan, instance, D::DIM));
        Self { slot, periods: 0, start, remembers, search }
    }

    /// Periods stepped for the instance.
    pub fn stepped(&self) -> u32 {
        self.periods + self.search.evaluations()
    }

    /// Gives the search an end of a period and its Jacobian.
    pub fn tell_with_jacobian(&mut self, sloped: Option<PeriodJacobian>) {
        let answer =
            sloped.and_then(|PeriodJacobian { end, slope }| Some((self.usable(end)?, padded(&slope))));
        self.search.tell_with_jacobian(answer);
    }

    /// The end of a period as a vector, if it is finite and in the same contact as the start.
    pub fn usable(&self, end: SectionState) -> Option<OVector<f64, D>> {
        let good = end.finite && (!self.remembers || end.touching == self.start.touching);
        good.then(|| vector(&end))
    }
}
