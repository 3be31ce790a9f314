//! One instance's search among many.

use super::PeriodicState;
use super::aims::options;
use super::begin::Along;
use super::map::{as_its_own, free_slope, vector};
use crate::engine::Sloped;
use crate::periodic::{Memory, Options, Search, Size};
use crate::plan::{Plan, Station};
use nalgebra::{DefaultAllocator, DimName, OMatrix, OVector};

/// Of a state of so many numbers those of modes that the instance has, travels, then rates; none where it has them all.
fn moving(plan: &Plan, instance: u32, numbers: usize) -> Option<Vec<usize>> {
    let (modes, most) = (plan.driven(instance).kept.modes.len(), numbers / 2);
    (modes < most).then(|| (0..modes).chain((most..).take(modes)).collect())
}

/// The slope of a state's own numbers, column by column, as that of so many, of which the others are at rest.
pub(super) fn widened<D: Size + DimName>(slope: &[f64]) -> OMatrix<f64, D, D>
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

/// One instance's search.
pub(super) struct One<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    /// Its number in the batch.
    pub slot: u32,
    /// Periods stepped before.
    pub periods: u32,
    /// Where it began; contact at a period's start stays as it was there.
    pub start: Station,
    /// Whether contact is a memory of the past, not what the indentation says.
    remembers: bool,
    pub search: Search<D>,
}

impl<D: Size + DimName> One<D>
where
    DefaultAllocator: Memory<D>,
{
    pub fn begin(plan: &Plan, slot: u32, instance: u32, start: Station) -> Self {
        let (remembers, options) = options(plan, instance);
        let (slope, columns) = free_slope(plan, instance);
        Self {
            slot,
            periods: 0,
            start,
            remembers,
            search: Search::guided(vector(&start), slope, columns, options).among(moving(
                plan,
                instance,
                D::DIM,
            )),
        }
    }

    /// From a state with other steps or another lever.
    pub fn beside(plan: &Plan, slot: u32, instance: u32, place: &PeriodicState) -> Self {
        let (remembers, options) = options(plan, instance);
        let (start, slope) = as_its_own::<D>(plan, instance, place);
        let search = Search::beside(vector(&start), slope, place.spectrum, options);
        let search = search.among(moving(plan, instance, D::DIM));
        Self { slot, periods: 0, start, remembers, search }
    }

    /// From a place that a curve leads to: the slope at the curve's last point, or else without a sample, will do on the
    /// way; the state's own tells its stability.
    pub fn along(plan: &Plan, slot: u32, instance: u32, last: Option<&PeriodicState>, along: &Along) -> Self {
        let start = along.places[instance as usize];
        let (remembers, options) = options(plan, instance);
        let moving = moving(plan, instance, D::DIM);
        let lightly = along.lightly.get(instance as usize).copied().unwrap_or(false);
        let options = Options {
            near: true,
            carried: last.is_some(),
            most: along.most.0 + along.most.1 * moving.as_ref().map_or(D::DIM, Vec::len) as u32,
            last_step: options.last_step.filter(|_| !lightly),
            stable: !lightly,
            ..options
        };
        let search = match last {
            Some(last) => {
                let slope = as_its_own::<D>(plan, instance, last).1;
                Search::guided(vector(&start), slope, (0..D::DIM).collect(), options)
            }
            None => Search::new(vector(&start), options),
        };
        let search = search.among(moving);
        Self { slot, periods: 0, start, remembers, search }
    }

    /// From a place that is thought to be next to a state, of whose slope nothing is known.
    pub fn next_to(plan: &Plan, slot: u32, instance: u32, start: Station) -> Self {
        let (remembers, options) = options(plan, instance);
        let search = Search::new(vector(&start), Options { near: true, ..options });
        let search = search.among(moving(plan, instance, D::DIM));
        Self { slot, periods: 0, start, remembers, search }
    }

    /// Periods stepped for the instance.
    pub fn stepped(&self) -> u32 {
        self.periods + self.search.evaluations()
    }

    /// Takes the map's answer with its slope.
    pub fn answer_sloped(&mut self, sloped: Option<Sloped>) {
        let answer = sloped.and_then(|Sloped { end, slope }| Some((self.useful(end)?, widened(&slope))));
        self.search.answer_sloped(answer);
    }

    /// The map's answer, if it is one: numbers, and the same contact as before.
    pub fn useful(&self, end: Station) -> Option<OVector<f64, D>> {
        let good = end.finite && (!self.remembers || end.touching == self.start.touching);
        good.then(|| vector(&end))
    }
}
