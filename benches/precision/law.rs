//! The laws on vectors, for the hand-written method.

use crate::lanes::Lanes;
use crate::problem::Sample;

/// A law with its constants for each lane.
pub trait Law<const N: usize>: Copy {
    /// Whether there is a flag to be kept.
    const MEMORY: bool;
    fn new<'a>(sample: impl Fn(usize) -> &'a Sample) -> Self;
    fn force(&self, indentation: Lanes<N>, touching: Lanes<N>) -> Lanes<N>;
    /// The flag after a step.
    fn next(&self, indentation: Lanes<N>, touching: Lanes<N>) -> Lanes<N>;
    /// One lane's force.
    fn force_at(&self, lane: usize, indentation: f64, touching: bool) -> f64;
}

#[derive(Clone, Copy)]
pub struct Hertz<const N: usize> {
    stiffness: Lanes<N>,
}

#[derive(Clone, Copy)]
pub struct Dmt<const N: usize> {
    hertz: Hertz<N>,
    adhesion: Lanes<N>,
    decay: Lanes<N>,
}

#[derive(Clone, Copy)]
pub struct Jkr<const N: usize> {
    pull: Lanes<N>,
    unit: Lanes<N>,
    inverse_unit: Lanes<N>,
}

impl<const N: usize> Law<N> for Hertz<N> {
    const MEMORY: bool = false;

    fn new<'a>(sample: impl Fn(usize) -> &'a Sample) -> Self {
        Self { stiffness: Lanes::from_lanes(|i| sample(i).hertz) }
    }

    #[inline(always)]
    fn force(&self, indentation: Lanes<N>, _: Lanes<N>) -> Lanes<N> {
        if !indentation.any() {
            return Lanes::splat(0.0);
        }
        let inside = indentation.max(Lanes::splat(0.0));
        self.stiffness * inside * inside.sqrt()
    }

    #[inline(always)]
    fn next(&self, _: Lanes<N>, touching: Lanes<N>) -> Lanes<N> {
        touching
    }

    fn force_at(&self, lane: usize, indentation: f64, _: bool) -> f64 {
        self.stiffness.lane(lane) * indentation.max(0.0).powf(1.5)
    }
}

impl<const N: usize> Law<N> for Dmt<N> {
    const MEMORY: bool = false;

    fn new<'a>(sample: impl Fn(usize) -> &'a Sample) -> Self {
        Self {
            adhesion: Lanes::from_lanes(|i| sample(i).adhesion),
            decay: Lanes::from_lanes(|i| sample(i).decay),
            hertz: Hertz::new(sample),
        }
    }

    #[inline(always)]
    fn force(&self, indentation: Lanes<N>, touching: Lanes<N>) -> Lanes<N> {
        let outside = indentation.min(Lanes::splat(0.0));
        let share = self.decay.over(self.decay - outside);
        self.hertz.force(indentation, touching) - self.adhesion * share * share
    }

    #[inline(always)]
    fn next(&self, _: Lanes<N>, touching: Lanes<N>) -> Lanes<N> {
        touching
    }

    fn force_at(&self, lane: usize, indentation: f64, _: bool) -> f64 {
        let decay = self.decay.lane(lane);
        let share = decay / (decay - indentation.min(0.0));
        self.hertz.force_at(lane, indentation, true) - self.adhesion.lane(lane) * share * share
    }
}

impl<const N: usize> Law<N> for Jkr<N> {
    const MEMORY: bool = true;

    fn new<'a>(sample: impl Fn(usize) -> &'a Sample) -> Self {
        Self {
            pull: Lanes::from_lanes(|i| sample(i).pull),
            unit: Lanes::from_lanes(|i| sample(i).unit),
            inverse_unit: Lanes::from_lanes(|i| 1.0 / sample(i).unit),
        }
    }

    /// The contact radius by two of Newton's steps from a start that is good to some percent.
    #[inline(always)]
    fn force(&self, indentation: Lanes<N>, touching: Lanes<N>) -> Lanes<N> {
        if !touching.any() {
            return Lanes::splat(0.0);
        }
        let one = Lanes::splat(1.0);
        let rise = indentation.fma(self.inverse_unit, Lanes::splat(3.0)).max(Lanes::splat(1e-14));
        let s = ((rise * Lanes::splat(1.0 / 1.5)).sqrt() + one).sqrt() + one;
        let mut e = rise.over(Lanes::splat(2.0).over(s * s) + one).sqrt();
        let mut s = (e + one).sqrt();
        for _ in 0..2 {
            let t = s + one;
            // e^2 (1 + 2/(s + 1)^2) - rise over its slope, both times (s + 1)^2.
            let value = (e * e - rise).fma(t * t, e * e * Lanes::splat(2.0));
            let slope = (e * Lanes::splat(2.0) * t).over(s) * s.fma(s, s + one);
            e = e - value.over(slope);
            s = (e + one).sqrt();
        }
        let cube = (e + one) * s;
        let force = self.pull * cube * cube.scaled(1.0 / 6.0, Lanes::splat(-1.0));
        force * touching
    }

    #[inline(always)]
    fn next(&self, indentation: Lanes<N>, touching: Lanes<N>) -> Lanes<N> {
        indentation.reaches(Lanes::splat(-3.0) * self.unit * touching)
    }

    fn force_at(&self, lane: usize, indentation: f64, touching: bool) -> f64 {
        if touching { jkr(self.pull.lane(lane), self.unit.lane(lane), indentation) } else { 0.0 }
    }
}

/// JKR's force in contact. Past the fold, where a step may look before it is cut back, it stays what it is there.
pub fn jkr(pull: f64, unit: f64, indentation: f64) -> f64 {
    let rise = (indentation / unit + 3.0).max(1e-20);
    let s = 1.0 + (1.0 + (rise / 1.5).sqrt()).sqrt();
    let mut e = (rise / (1.0 + 2.0 / (s * s))).sqrt();
    for _ in 0..3 {
        let s = (1.0 + e).sqrt();
        let t = s + 1.0;
        e -= ((e * e - rise) * t * t + 2.0 * e * e) / (2.0 * e * t / s * (s * s + s + 1.0));
    }
    let cube = (1.0 + e) * (1.0 + e).sqrt();
    pull * cube * (cube / 6.0 - 1.0)
}
