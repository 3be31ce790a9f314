//! A slow ramp of the base: what a lever of some stiffness makes of the static curve, with its jumps.
//!
//! The base stands where the tip at rest would be a distance `Z` from the surface. The lever bends until `f(delta) = k d`,
//! d being how far the tip is pushed back, so `Z = -delta - f(delta)/k`. That is stable while `k + df/d delta > 0`; where it
//! ends the tip jumps at this Z to the other branch (B. Cappella, G. Dietler, Surf. Sci. Rep. 34 (1999) 1).

use super::static_curve::CurveBranch;
use super::{Contact, Law};
use serde::Serialize;

/// One way of the base; the lists have one length.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RampCurve {
    pub branch: CurveBranch,
    /// Distance of the tip from the surface if the lever were not bent, m.
    pub base_position_m: Vec<f64>,
    /// m
    pub indentation_m: Vec<f64>,
    /// N
    pub force_n: Vec<f64>,
}

/// A jump of the tip while the base stands still.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Jump {
    /// m
    pub base_position_m: f64,
    /// Before and after, N.
    pub force_n: [f64; 2],
    /// Likewise, m.
    pub indentation_m: [f64; 2],
}

/// What `afmsweep force --lever --json` prints.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ramp {
    pub law: Law,
    /// Of the lever at its tip, N/m.
    pub stiffness_n_per_m: f64,
    pub curves: [RampCurve; 2],
    /// None where the tip comes into contact smoothly; of several that which releases most.
    pub snap_in: Option<Jump>,
    /// None where it leaves smoothly; likewise.
    pub pull_off: Option<Jump>,
    /// What all jumps release in a cycle: the area between the two ways, J.
    pub loss_j: f64,
}

/// Halvings of an interval: more than a double has digits.
const HALVINGS: u32 = 200;

impl Contact {
    /// A slow ramp of the base towards the sample and back, under a lever of this stiffness (N/m), down to the indentation
    /// that [`Contact::curves`] shows.
    ///
    /// ```
    /// use afmsweep_model::{contact::Contact, scene::Params};
    /// let contact = Contact::new(&Params::default());
    /// let ramp = contact.ramp(1.0);
    /// // JKR acts on contact alone: the tip snaps in where it touches.
    /// assert_eq!(ramp.snap_in.unwrap().base_position_m, 0.0);
    /// assert!(ramp.loss_j > contact.jkr().unwrap().loss_per_cycle());
    /// ```
    pub fn ramp(&self, stiffness: f64) -> Ramp {
        let bent = Bent { contact: self, stiffness };
        let deepest = self.telling_indentation();
        let law = self.law();
        let outside = farther(self.outside(deepest), law.release().min(0.0) + law.pull_off() / stiffness);
        let mut rising: Vec<f64> =
            outside.into_iter().chain(self.inside(deepest).into_iter().rev()).collect();
        rising.sort_by(f64::total_cmp);
        rising.dedup();
        let (there, jumps_in) = bent.way(CurveBranch::Approach, &rising);
        rising.reverse();
        let (back, jumps_out) = bent.way(CurveBranch::Retract, &rising);
        let released = |all: &[(Jump, f64)]| all.iter().map(|(_, energy)| energy).sum::<f64>();
        // A sum of nothing is -0.
        let loss_j = 0.0 + released(&jumps_in) + released(&jumps_out);
        let largest = |all: Vec<(Jump, f64)>| {
            all.into_iter().max_by(|one, other| one.1.total_cmp(&other.1)).map(|(jump, _)| jump)
        };
        let (snap_in, pull_off) = (largest(jumps_in), largest(jumps_out));
        Ramp { law: self.law, stiffness_n_per_m: stiffness, curves: [there, back], snap_in, pull_off, loss_j }
    }
}

/// How much farther than where a tip may land a curve begins, and in how many points.
const FARTHER: f64 = 1.5;
const FAR_POINTS: u32 = 100;
/// More than a force has wells.
const MOST_JUMPS: usize = 64;

/// A contact at the end of a lever.
struct Bent<'a> {
    contact: &'a Contact,
    /// N/m
    stiffness: f64,
}

/// Indentation, and whether the tip is in contact there by its past.
type Place = (f64, bool);

impl Bent<'_> {
    /// Where the base stands, m.
    fn position(&self, (delta, touching): Place) -> f64 {
        -delta - self.contact.force(delta, touching) / self.stiffness
    }

    fn stable(&self, (delta, touching): Place) -> bool {
        self.stiffness + self.contact.stiffness(delta, touching) > 0.0
    }

    /// Energy of contact and lever, J.
    fn energy(&self, (delta, touching): Place) -> f64 {
        let force = self.contact.force(delta, touching);
        self.contact.energy(delta, touching) + 0.5 * force * force / self.stiffness
    }

    /// One way of the base along these indentations, with its jumps and the energy (J) that each releases.
    fn way(&self, branch: CurveBranch, points: &[f64]) -> (RampCurve, Vec<(Jump, f64)>) {
        let mut touching = branch == CurveBranch::Retract;
        let (mut places, mut jumps): (Vec<Place>, Vec<(Jump, f64)>) = (Vec::new(), Vec::new());
        let mut next = 0;
        while let Some(&delta) = points.get(next).filter(|_| jumps.len() < MOST_JUMPS) {
            // Contact may change, or the lever lose its hold, before this point.
            let change =
                self.level(touching).filter(|_| self.contact.next_contact(delta, touching) != touching);
            let end = change.unwrap_or(delta);
            let stable = self.stable((end, touching));
            if stable && change.is_none() {
                places.push((delta, touching));
                next += 1;
                continue;
            }
            let last = places.last().map_or(end, |(last, _)| *last);
            let held = if stable { end } else { halved((last, end), |delta| self.stable((delta, touching))) };
            let from = (held, touching);
            places.push(from);
            let Some((to, beyond)) = self.landing(from, points, next) else { break };
            if (to.0 - from.0).abs() > 1e-9 * from.0.abs().max(to.0.abs()) {
                jumps.push((self.jump(from, to), self.energy(from) - self.energy(to)));
            }
            places.push(to);
            (touching, next) = (to.1, beyond);
        }
        let curve = RampCurve {
            branch,
            base_position_m: places.iter().map(|place| self.position(*place)).collect(),
            indentation_m: places.iter().map(|(delta, _)| *delta).collect(),
            force_n: places.iter().map(|(delta, touching)| self.contact.force(*delta, *touching)).collect(),
        };
        (curve, jumps)
    }

    /// Where contact changes by the tip's past; nowhere under a law without memory.
    fn level(&self, touching: bool) -> Option<f64> {
        let law = self.contact.law();
        let level = if touching { law.release() } else { law.formation() };
        self.contact.law.has_hysteresis().then_some(level)
    }

    /// Where a tip lands that leaves a place while the base stands still, and the first of the points behind there.
    fn landing(&self, from: Place, points: &[f64], next: usize) -> Option<(Place, usize)> {
        let base = self.position(from);
        let inward = points.last() > points.first();
        let touching = |delta: f64| match self.level(from.1) {
            Some(level) if (delta >= level) == inward || delta == level => !from.1,
            _ => from.1,
        };
        let reached = |delta: f64| {
            let place = (delta, touching(delta));
            let position = self.position(place);
            // Next to where it left the position is as flat as rounding.
            self.stable(place) && if inward { position <= base } else { position >= base }
        };
        let ahead = |delta: f64| if inward { delta > from.0 } else { delta < from.0 };
        let mut before = from.0;
        for (n, &delta) in points.iter().enumerate().skip(next) {
            if !ahead(delta) {
                continue;
            }
            if reached(delta) {
                let at = halved((delta, before), reached);
                return Some(((at, touching(at)), n + usize::from(at == delta)));
            }
            before = delta;
        }
        None
    }

    fn jump(&self, from: Place, to: Place) -> Jump {
        let force = |(delta, touching): Place| self.contact.force(delta, touching);
        Jump {
            base_position_m: self.position(from),
            force_n: [force(from), force(to)],
            indentation_m: [from.0, to.0],
        }
    }
}

/// Rising indentations out of contact, with some more at their far end where a tip that lets go may land beyond it: a soft
/// lever springs far back.
fn farther(outside: Vec<f64>, go: f64) -> Vec<f64> {
    let Some(&first) = outside.first().filter(|first| FARTHER * go < **first) else { return outside };
    let ratio = (FARTHER * go / first).powf(1.0 / f64::from(FAR_POINTS));
    let more = (1..=FAR_POINTS).rev().map(|n| first * ratio.powi(n as i32));
    more.chain(outside).collect()
}

/// Where `holds` ends, from a place where it does towards one where it does not: the last double at which it holds.
fn halved((mut good, mut bad): (f64, f64), holds: impl Fn(f64) -> bool) -> f64 {
    for _ in 0..HALVINGS {
        let middle = 0.5 * (good + bad);
        if middle == good || middle == bad {
            break;
        }
        if holds(middle) { good = middle } else { bad = middle }
    }
    good
}
