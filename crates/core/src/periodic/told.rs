//! Searches of maps that tell their slopes, and how any search ends.

use super::options::Options;
use super::search::{Found, Lost, Search, Stage, Taken, Verdict};
use super::size::{Memory, Size};
use super::spectrum::{Spectrum, factors};
use nalgebra::{DefaultAllocator, LU, OMatrix, OVector};

/// Where the map leads from a state, and its slope there.
type WithSlope<D> = (OVector<f64, D>, OMatrix<f64, D, D>);

impl<D: Size> Found<D>
where
    DefaultAllocator: Memory<D>,
{
    /// A fixed point with the map's slope there; none where a small push leaves it for good.
    pub fn stable(state: OVector<f64, D>, slope: OMatrix<f64, D, D>) -> Option<Self> {
        let spectrum = Spectrum::new(&slope, &factors(&slope, 1.0));
        (spectrum.multiplier < 1.0).then_some(Self { state, slope, spectrum })
    }
}

impl<D: Size> Search<D>
where
    DefaultAllocator: Memory<D>,
{
    /// Time, in periods, that its next stride stands for: infinitely many where that is Newton's step.
    pub fn time(&self) -> f64 {
        self.time
    }

    /// The map tells its slope itself, which costs as much as so many columns of it by differences.
    pub fn by_tangents(&mut self, columns: usize) {
        self.options.tangent = Some(columns);
    }

    /// Whether the slope is to be told by the map: all of it, or where some columns would do.
    pub(super) fn tells(&self, whole: bool) -> bool {
        self.options.tangent.is_some_and(|worth| self.instead(whole) > worth)
    }

    /// Whether the slope at the end is to be told by the map.
    pub(super) fn tells_last(&self) -> bool {
        self.options.tangent.is_some_and(|worth| 2 * self.size() > worth)
    }

    /// Evaluations that differences would take for all of the slope, or for as much of it as will do on the way.
    fn instead(&self, whole: bool) -> usize {
        match (whole, self.options.last_step) {
            (false, _) => self.columns.len(),
            (true, None) => self.size(),
            (true, Some(_)) => 2 * self.size(),
        }
    }

    /// Whether it wants to know the slope, too, at the state that it asks for: [`Search::answer_sloped`] takes both.
    pub fn wants_slope(&self) -> bool {
        match &self.stage {
            Stage::Begin => self.known.is_none() && !self.options.carried && self.tells(false),
            Stage::Slope { whole } => self.tells(*whole),
            Stage::Last => self.tells_last(),
            Stage::Stride { .. } | Stage::Done(_) => false,
        }
    }

    /// Takes the answer with its slope; none where the map has no answer of use.
    pub fn answer_sloped(&mut self, answer: Option<WithSlope<D>>) {
        self.evaluations += 1;
        self.spent += match self.stage {
            Stage::Slope { whole } => self.instead(whole) as u32,
            Stage::Last => 2 * self.size() as u32,
            _ => 1 + self.instead(false) as u32,
        };
        let next = match answer {
            Some((_, slope)) if matches!(self.stage, Stage::Last) => {
                self.slope = slope;
                self.found(Spectrum::new(&self.slope, &factors(&self.slope, 1.0)))
            }
            Some((value, slope)) => {
                (self.change, self.slope) = (value - &self.state, slope);
                // What was known led astray.
                (self.taken, self.known) = (Taken::Whole, None);
                self.stride()
            }
            None => Stage::Done(Verdict::Lost(Lost::Undefined)),
        };
        self.go_on(next);
    }

    /// Where Newton's last step leads; `newton` are the factors that it is by.
    pub(super) fn ended(&mut self, step: OVector<f64, D>, newton: &LU<f64, D, D>) -> Stage<D> {
        let Options { stable, near, clearly, certainly, .. } = self.options;
        let tells = self.tells(true);
        let central = self.options.last_step.is_some() && !tells;
        if !central && self.known.is_none() && stable && self.taken != Taken::Whole {
            return Stage::Slope { whole: true };
        }
        let below = if self.known.is_some() { certainly } else { clearly };
        let sure = |at: &Spectrum| !stable || at.multiplier < below;
        if tells {
            if self.known.is_some_and(|at| !sure(&at)) {
                return Stage::Slope { whole: true };
            }
            self.state += step;
            return self.found(self.known.unwrap_or_else(|| Spectrum::new(&self.slope, newton)));
        }
        self.state += step;
        // Where nobody asks for stability the slope will do as it is.
        let enough = near && (!stable || self.taken == Taken::Whole);
        let at = match self.known {
            None if enough || !central => Some(Spectrum::new(&self.slope, newton)),
            known => known,
        };
        at.filter(sure).map_or(Stage::Last, |at| self.found(at))
    }
}
