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
    /// None where the tip comes into contact smoothly.
    pub snap_in: Option<Jump>,
    /// None where it leaves smoothly.
    pub pull_off: Option<Jump>,
    /// What both jumps release in a cycle: the area between the two ways, J.
    pub loss_j: f64,
}

/// Halvings of an interval, and doublings to come to one: more than a double has digits.
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
        let (edge, end) = (bent.edge(), bent.end());
        // Without a memory the branches are one, and what is stable all along is smooth.
        let jumps = edge < 0.0 || self.law.has_hysteresis();
        let snap_in =
            jumps.then(|| bent.jump((edge, false), bent.touching_at(bent.position(edge, false), end)));
        let pull_off = jumps.then(|| bent.jump((end, true), bent.apart_at(bent.position(end, true), edge)));
        let released = |jump: Option<Jump>, before: bool| {
            jump.map_or(0.0, |Jump { indentation_m: [from, to], .. }| {
                bent.energy(from, before) - bent.energy(to, !before)
            })
        };
        Ramp {
            law: self.law,
            stiffness_n_per_m: stiffness,
            curves: bent.curves((edge, end), (snap_in, pull_off)),
            snap_in,
            pull_off,
            loss_j: released(snap_in, false) + released(pull_off, true),
        }
    }
}

/// How much farther than where a tip lands a curve begins, and in how many points.
const FARTHER: f64 = 1.5;
const FAR_POINTS: u32 = 100;

/// A contact at the end of a lever.
struct Bent<'a> {
    contact: &'a Contact,
    /// N/m
    stiffness: f64,
}

impl Bent<'_> {
    /// Where the base stands, m.
    fn position(&self, delta: f64, touching: bool) -> f64 {
        -delta - self.contact.force(delta, touching) / self.stiffness
    }

    fn stable(&self, delta: f64, touching: bool) -> bool {
        self.stiffness + self.contact.stiffness(delta, touching) > 0.0
    }

    /// Energy of contact and lever, J.
    fn energy(&self, delta: f64, touching: bool) -> f64 {
        let force = self.contact.force(delta, touching);
        self.contact.energy(delta, touching) + 0.5 * force * force / self.stiffness
    }

    /// Deepest indentation at which a tip that has not touched is stable, m: 0 where it is so up to the surface.
    fn edge(&self) -> f64 {
        let nearest = -f64::MIN_POSITIVE;
        if self.stable(nearest, false) {
            return 0.0;
        }
        let far = beyond(-self.contact.radius, |delta| self.stable(delta, false));
        halved((far, nearest), |delta| self.stable(delta, false))
    }

    /// Least indentation at which a tip in contact is stable, m: where contact ends if it is so all the way.
    fn end(&self) -> f64 {
        let release = self.contact.law().release();
        if self.stable(release, true) {
            return release;
        }
        let deep = beyond(self.contact.radius, |delta| self.stable(delta, true));
        halved((deep, release), |delta| self.stable(delta, true))
    }

    /// The stable state in contact where the base is at `position`; `end` is the last one.
    fn touching_at(&self, position: f64, end: f64) -> f64 {
        let deep = beyond(self.contact.radius, |delta| self.position(delta, true) < position);
        halved((deep, end), |delta| self.position(delta, true) < position)
    }

    /// The stable state out of contact where the base is at `position`; `edge` is the last one.
    fn apart_at(&self, position: f64, edge: f64) -> f64 {
        let far = beyond(-self.contact.radius, |delta| self.position(delta, false) > position);
        halved((far, edge), |delta| self.position(delta, false) > position)
    }

    fn jump(&self, (from, touching): (f64, bool), to: f64) -> Jump {
        Jump {
            base_position_m: self.position(from, touching),
            force_n: [self.contact.force(from, touching), self.contact.force(to, !touching)],
            indentation_m: [from, to],
        }
    }

    /// Both ways, with both ends of each jump. What is stable ends at `edge` out of contact and at `end` in it.
    fn curves(
        &self,
        (edge, end): (f64, f64),
        (snap_in, pull_off): (Option<Jump>, Option<Jump>),
    ) -> [RampCurve; 2] {
        let deepest = self.contact.telling_indentation();
        let (outside, inside) = (self.contact.outside(deepest), self.contact.inside(deepest));
        let (lands, leaves) =
            (snap_in.map(|jump| jump.indentation_m[1]), pull_off.map(|jump| jump.indentation_m[1]));
        let outside = farther(outside, leaves.unwrap_or(0.0));
        let apart = |limit: f64| outside.iter().copied().filter(move |delta| *delta < limit);
        let touching = |limit: f64| inside.iter().copied().filter(move |delta| *delta > limit);
        let out = |delta: f64| (delta, false);
        let held = |delta: f64| (delta, true);
        let mut there: Vec<(f64, bool)> = apart(edge).chain([edge]).map(out).collect();
        let mut rest: Vec<(f64, bool)> = touching(lands.unwrap_or(0.0)).map(held).collect();
        rest.reverse();
        there.extend(lands.map(held).into_iter().chain(rest));
        let mut back: Vec<(f64, bool)> = touching(end).chain([end]).map(held).collect();
        let mut rest: Vec<(f64, bool)> = apart(leaves.unwrap_or(0.0)).map(out).collect();
        rest.reverse();
        back.extend(leaves.map(out).into_iter().chain(rest));
        [self.way(CurveBranch::Approach, &there), self.way(CurveBranch::Retract, &back)]
    }

    fn way(&self, branch: CurveBranch, states: &[(f64, bool)]) -> RampCurve {
        RampCurve {
            branch,
            base_position_m: states
                .iter()
                .map(|(delta, touching)| self.position(*delta, *touching))
                .collect(),
            indentation_m: states.iter().map(|(delta, _)| *delta).collect(),
            force_n: states.iter().map(|(delta, touching)| self.contact.force(*delta, *touching)).collect(),
        }
    }
}

/// Rising indentations out of contact, with some more at their far end where a tip that lets `go` lands beyond it: a soft
/// lever springs far back.
fn farther(outside: Vec<f64>, go: f64) -> Vec<f64> {
    let Some(&first) = outside.first().filter(|first| FARTHER * go < **first) else { return outside };
    let ratio = (FARTHER * go / first).powf(1.0 / f64::from(FAR_POINTS));
    let more = (1..=FAR_POINTS).rev().map(|n| first * ratio.powi(n as i32));
    more.chain(outside).collect()
}

/// The first of `start`, twice that, and so on, that `holds`; no more doublings than [`HALVINGS`].
fn beyond(start: f64, holds: impl Fn(f64) -> bool) -> f64 {
    let mut at = start;
    for _ in 0..HALVINGS {
        if holds(at) {
            break;
        }
        at *= 2.0;
    }
    at
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
