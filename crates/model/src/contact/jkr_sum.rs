//! JKR's contact and the forces beside it.

use super::static_law::Shares;
use super::{Compact, ForceSum, Jkr, KernelUnits, Passed, StaticLaw};

/// JKR's law, with its hysteresis, and up to four forces beside it, which keep their value at touch inside.
///
/// The forces do not widen the neck: JKR's curve is as it is alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JkrSum {
    jkr: Jkr,
    forces: ForceSum,
}

impl From<&Compact> for JkrSum {
    fn from(of: &Compact) -> Self {
        Self { jkr: of.into(), forces: ForceSum::beside_contact(of) }
    }
}

impl JkrSum {
    /// The least and the largest force between two indentations on a branch; not numbers where these are none.
    fn extremes(&self, low: f64, high: f64, in_contact: bool) -> [f64; 2] {
        self.forces.extremes_of((low, high), |delta| self.force(delta, in_contact))
    }
}

impl StaticLaw for JkrSum {
    fn force(&self, delta: f64, in_contact: bool) -> f64 {
        self.jkr.force(delta, in_contact) + self.forces.force(delta, in_contact)
    }

    fn stiffness(&self, delta: f64, in_contact: bool) -> f64 {
        self.jkr.stiffness(delta, in_contact) + self.forces.stiffness(delta, in_contact)
    }

    fn energy(&self, delta: f64, in_contact: bool) -> f64 {
        self.jkr.energy(delta, in_contact) + self.forces.energy(delta, in_contact)
    }

    fn contact_radius(&self, delta: f64, in_contact: bool) -> f64 {
        self.jkr.contact_radius(delta, in_contact)
    }

    fn constants(&self, units: KernelUnits) -> Vec<f64> {
        [self.jkr.constants(units), self.forces.term_constants(units)].concat()
    }

    fn elastic_force(&self, depth: f64) -> f64 {
        self.jkr.elastic_force(depth)
    }

    fn collision_depth(&self, speed: f64, inverse_mass: f64) -> f64 {
        self.jkr.collision_depth(speed, inverse_mass)
    }

    fn release(&self) -> f64 {
        self.jkr.release()
    }

    fn next_contact(&self, delta: f64, was_in_contact: bool) -> bool {
        self.jkr.next_contact(delta, was_in_contact)
    }

    /// As where JKR alone passes through 0, from there on where the forces pull.
    fn zero_force(&self) -> f64 {
        let alone = self.jkr.zero_force();
        match self.force(alone, true) {
            pull if pull < 0.0 => super::static_law::first_depth(|depth| self.force(depth, true) >= 0.0),
            _ => alone,
        }
    }

    fn pull_off(&self) -> f64 {
        let inside = self.extremes(self.release(), self.zero_force(), true)[0];
        inside.min(self.forces.pull_off())
    }

    fn attraction_slope(&self) -> f64 {
        self.forces.attraction_slope()
    }

    fn depth_by_adhesion(&self) -> f64 {
        self.jkr.depth_by_adhesion()
    }

    fn forces(&self, passed: &Passed) -> (f64, f64) {
        let Passed { highest, deepest, held, touched, apart, let_go, .. } = *passed;
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        let mut take = |low: f64, high: f64, in_contact: bool| {
            let [low, high] = self.extremes(low.min(high), high, in_contact);
            (least, most) = (least.min(low), most.max(high));
        };
        if touched {
            take(if let_go { self.release() } else { held.max(self.release()) }, deepest, true);
        }
        if apart || !touched {
            take(highest, deepest.min(0.0), false);
        }
        (least, most)
    }

    /// As those of the forces, with the fold among them.
    fn outside(&self, deepest: f64, shares: Shares) -> Vec<f64> {
        let release = self.release();
        let mut points = self.forces.outside(deepest, shares);
        if let Some(far) = points.first_mut() {
            *far = far.min(1.3 * release);
        }
        let place = points.partition_point(|&delta| delta < release);
        points.insert(place, release);
        points
    }

    fn crowding(&self) -> i32 {
        self.jkr.crowding()
    }
}
