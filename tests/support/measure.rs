//! What is measured over whole periods: integrals ride along as extra states, extremes are taken at
//! events, between which the indentation is monotonic.

use super::oscillator::{State, System};

/// How exact, and what to measure.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Error per step, relative to the largest travel.
    pub tolerance: f64,
    pub settle: usize,
    pub measure: usize,
    pub harmonics: usize,
}

impl Default for Options {
    fn default() -> Self {
        Self { tolerance: 1e-15, settle: 0, measure: 1, harmonics: 1 }
    }
}

/// Over the periods measured; SI. Angles in degrees, lag behind the drive's sine, 0 to 360.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    pub amplitude: f64,
    pub phase: f64,
    /// Mean of the travel.
    pub offset: f64,
    /// Amplitude and lag of harmonics 1, 2, ...
    pub harmonics: Vec<(f64, f64)>,
    pub force_max: f64,
    pub force_min: f64,
    pub force_mean: f64,
    /// NaN where never in contact.
    pub indentation_max: f64,
    /// Share of the time.
    pub contact_share: f64,
    /// Contacts begun, per period.
    pub contacts: f64,
    /// J per period left in the sample.
    pub loss: f64,
    /// J, mean of force times travel.
    pub virial: f64,
    pub evaluations: u64,
}

impl Outcome {
    /// J per contact begun.
    pub fn loss_per_tap(&self) -> f64 {
        self.loss / self.contacts
    }
}

/// What is added up between events while measuring.
pub struct Meter {
    pub harmonics: usize,
    pub force: (f64, f64),
    pub deepest: f64,
    pub contact: f64,
    pub contacts: usize,
}

impl Meter {
    /// Takes note of the force and depth here.
    pub fn see(&mut self, system: &System, state: &State) {
        self.note(system, system.indentation(state.phase, &state.x), state.touch);
    }

    fn note(&mut self, system: &System, delta: f64, touch: bool) {
        let force = system.law.force(delta, touch);
        self.force = (self.force.0.min(force), self.force.1.max(force));
        if touch {
            self.deepest = self.deepest.max(delta);
        }
    }

    /// Takes note of a step over which the indentation is monotonic.
    pub fn pass(&mut self, system: &System, from: (f64, &[f64]), to: (f64, &[f64]), touch: bool, h: f64) {
        let ends = [system.indentation(from.0, from.1), system.indentation(to.0, to.1)];
        self.note(system, ends[1], touch);
        for place in system.law.extremes_between(ends, touch) {
            self.note(system, place, touch);
        }
        if !touch {
            return;
        }
        self.contact += h;
        if let Some(least) = system.law.turning()
            && (ends[0] - least) * (ends[1] - least) < 0.0
        {
            self.note(system, least, touch);
        }
    }
}
