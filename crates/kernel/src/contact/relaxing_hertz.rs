//! A standard linear solid under Hertz's tip: an elastic half-space with an arm that relaxes. docs/method.md derives the
//! memory's two numbers and the step.

use super::hertz::{Elastic, Hertz};
use super::path::Path;
use super::{Approach, Interaction, Kick, Lane, Zip, extremes_near, touching_at, when};
use crate::constants::{EIGHT, HALF, LEAST, ONE, QUARTER, SIX, TENTH, TWELFTH, TWENTY_FOURTH, TWO, ZERO};

/// `hertz` has the instantaneous modulus, of which the share `relaxing` relaxes. The others are of the memory's flow over a
/// step: it keeps `left` of itself at the end and `mean_left` on the mean; a source of one leaves `gain` and `mean_gain`, and
/// one that rises by one over the step and is zero on its mean `rise_gain` and `mean_rise_gain`.
///
/// The memory is the dashpots' depth under the tip's centre, and their sum in units of a Hertz force: d^1.5 once they have
/// followed.
#[derive(Clone, Copy, Debug)]
pub struct RelaxingHertz<L> {
    pub hertz: Hertz<L>,
    pub relaxing: L,
    pub left: L,
    pub mean_left: L,
    pub gain: L,
    pub mean_gain: L,
    pub rise_gain: L,
    pub mean_rise_gain: L,
}

/// What a pass over the step takes from the one before: the impulse, the memory at the step's end, and the mean of the tip's
/// height above the dashpots.
#[derive(Clone, Copy)]
struct Guess<L> {
    impulse: L,
    depth: L,
    total: L,
    above: L,
}

/// Where the tip goes in a step, as the chord of its path and the path's true ends; and its height above the dashpots, at the
/// ends, as a chord and on the mean, with the share of the step in which it is above them. Where it is not, they recover.
#[derive(Clone, Copy)]
struct Heights<L> {
    path: Path<L>,
    tips: [L; 2],
    above: [L; 2],
    way: Path<L>,
    mean: L,
    share: L,
    /// What the dashpots' depth gains, and what it is at the end.
    deepened: L,
    depth: L,
}

/// A pass: the force as its mean over the step, at its start and at its end, per stiffness; and what the memory gains.
#[derive(Clone, Copy)]
struct Pass<L> {
    force: L,
    ends: [L; 2],
    share: L,
    end: L,
    gains: [L; 2],
}

/// A path of this mean and half length.
#[inline(always)]
fn around<L: Lane>(mean: L, half_way: L) -> Path<L> {
    Path { start: mean - half_way, end: mean + half_way }
}

/// The mean of what of a path is above zero, and its share.
#[inline(always)]
fn inside<L: Lane>(path: Path<L>) -> (L, L) {
    let (zero, share) = (L::splat(ZERO), path.share_inside());
    (L::splat(HALF) * share * (path.start.max(zero) + path.end.max(zero)), share)
}

impl<L: Lane> RelaxingHertz<L> {
    /// Hertz's force per stiffness.
    #[inline(always)]
    fn unit() -> Hertz<L> {
        Hertz { stiffness: L::splat(ONE) }
    }

    /// By how much the contact is wider than a tip would make it that met a flat sample: the dashpots' profile is hollow.
    #[inline(always)]
    fn widening(&self, depth: L, total: L) -> L {
        let hollow = depth * depth * depth / (total * total).max(L::splat(LEAST));
        let (one, half) = (L::splat(ONE), L::splat(HALF));
        // A profile that has followed has a hollow of one; what is more is an error of the two numbers.
        let least = (half - half * self.relaxing).min(L::splat(TENTH));
        let room = (one - self.relaxing * hollow).max(least);
        L::splat(ONE) / room.sqrt()
    }

    /// The force at an indentation that widens the contact, whose memory holds `total`.
    #[inline(always)]
    fn outer(&self, indentation: L, total: L) -> L {
        (Self::unit().sample(indentation) - self.relaxing * total).max(L::splat(ZERO))
    }

    /// What the memory has gained by the end of the step, and what it is on its mean, by a source of such mean and rise.
    #[inline(always)]
    fn gained(&self, (mean, rise): (L, L)) -> L {
        self.gain * mean + self.rise_gain * rise
    }

    #[inline(always)]
    fn heights(&self, at: Approach<L>, guess: Guess<L>) -> Heights<L> {
        let (zero, one, half) = (L::splat(ZERO), L::splat(ONE), L::splat(HALF));
        let (twelfth, arm, depth) = (L::splat(TWELFTH), self.relaxing, at.memory[0]);
        let reach = half * at.speed - L::splat(QUARTER) * guess.impulse;
        let centre = at.indentation + (L::splat(TWENTY_FOURTH) * at.acceleration - twelfth * guess.impulse);
        let path = Path { start: centre - reach, end: centre + reach };
        let bend = twelfth * (at.acceleration - guess.impulse);
        let tips = [path.start + bend, path.end + bend];
        let above = [tips[0] - arm * depth, tips[1] - arm * guess.depth];
        let [first, last] = [above[0].max(zero), above[1].max(zero)];
        let rise = last - first;
        let half_way = half * (above[1] - above[0]);
        let (deep, share) = inside(around(guess.above, half_way));
        let held = self.mean_left * depth + self.mean_gain * deep + self.mean_rise_gain * rise;
        let off = centre - arm * held - guess.above;
        let mean = guess.above + off / (arm * self.mean_gain).mul_add(share, one);
        let way = around(mean, half_way);
        let (deep, share) = inside(way);
        let deepened = self.gained((deep, rise));
        Heights { path, tips, above, way, mean, share, deepened, depth: self.left.mul_add(depth, deepened) }
    }

    #[inline(always)]
    fn pass(&self, at: Approach<L>, guess: Guess<L>) -> (Guess<L>, Pass<L>) {
        let (zero, one, half) = (L::splat(ZERO), L::splat(ONE), L::splat(HALF));
        let (unit, arm) = (Self::unit(), self.relaxing);
        let [depth, total] = at.memory;
        let Heights { path, tips, above, way, mean, share, deepened, depth: end_depth } =
            self.heights(at, guess);
        // The tip widens the contact beyond the dashpots' profile, or withdraws within it.
        let wide = [
            depth * depth * tips[0] - total * total,
            end_depth * end_depth * tips[1] - guess.total * guess.total,
        ];
        let widens = Path { start: wide[0], end: wide[1] }.share_inside();
        let (whole, within) = (unit.mean(path), unit.mean(way));
        let wider = [self.widening(depth, total), self.widening(end_depth, guess.total)];
        let pressed = [unit.sample(above[0]), unit.sample(above[1])];
        let outer = [self.outer(tips[0], total), self.outer(tips[1], guess.total)];
        let ends = [
            L::select(wide[0].less(zero), wider[0] * pressed[0], outer[0]),
            L::select(wide[1].less(zero), wider[1] * pressed[1], outer[1]),
        ];
        let force_rise = ends[1] - ends[0];
        let held = self.mean_left * total + self.mean_rise_gain * force_rise;
        let outer =
            (whole.force - arm * whole.share * held) / (arm * self.mean_gain).mul_add(whole.share, one);
        let mean_wider = half * (wider[0] + wider[1]);
        let bent = L::splat(TWELFTH) * (wider[1] - wider[0]) * (pressed[1] - pressed[0]);
        let inner = mean_wider.mul_add(within.force, bent);
        let force = widens.mul_add(outer - inner, inner).max(zero);
        let summed = self.gained((force, force_rise));
        let next = Guess {
            impulse: self.hertz.stiffness * force,
            depth: end_depth,
            total: self.left.mul_add(total, summed),
            above: mean,
        };
        let pass = Pass {
            force,
            ends,
            share: widens.mul_add(whole.share - share, share),
            end: L::select(wide[1].less(zero), above[1], path.end),
            gains: [deepened, summed],
        };
        (next, pass)
    }

    /// A step that may touch.
    #[inline(always)]
    fn passed(&self, at: Approach<L>) -> Pass<L> {
        let zero = L::splat(ZERO);
        let [depth, total] = at.memory;
        let above = at.indentation - self.relaxing * depth;
        let force = self.outer(at.indentation, total);
        let first = Guess {
            impulse: self.hertz.stiffness * force,
            depth: self.left.mul_add(depth, self.gain * above.max(zero)),
            total: self.left.mul_add(total, self.gain * force),
            above,
        };
        let (second, _) = self.pass(at, first);
        let (third, _) = self.pass(at, second);
        self.pass(at, third).1
    }
}

impl<L: Lane> RelaxingHertz<L> {
    /// A step that may touch. It is long, so it is compiled once, not into every loop over steps.
    #[inline(never)]
    fn contact(&self, at: Approach<L>) -> Kick<L> {
        L::run(
            #[inline(always)]
            || {
                let pass = self.passed(at);
                let stiffness = self.hertz.stiffness;
                Kick {
                    impulse: stiffness * pass.force,
                    contact: pass.share,
                    touching: touching_at(pass.end),
                    memory: pass.gains,
                    ..Kick::none()
                }
            },
        )
    }

    /// Least and largest force of a step that may touch: of the parabola through its ends and its middle.
    #[inline(never)]
    fn forces(&self, at: Approach<L>) -> (L, L) {
        L::run(
            #[inline(always)]
            || {
                let Pass { force, ends: [first, last], .. } = self.passed(at);
                // The parabola with these ends and this mean.
                let middle = (L::splat(SIX) * force - (first + last)) * L::splat(QUARTER);
                let (slope, bend) = (last - first, (last - middle) - (middle - first));
                let turns = slope.abs().less(L::splat(TWO) * bend.abs());
                let curve = L::splat(EIGHT) * L::select(turns, bend, L::splat(ONE));
                let top = L::select(turns, middle - slope * slope / curve, middle).max(L::splat(ZERO));
                let stiffness = self.hertz.stiffness;
                (stiffness * first.min(last).min(top), stiffness * first.max(last).max(top))
            },
        )
    }
}

impl<L: Lane> Interaction<L> for RelaxingHertz<L> {
    const FIELDS: &'static [&'static str] =
        &["stiffness", "relaxing", "left", "mean_left", "gain", "mean_gain", "rise_gain", "mean_rise_gain"];
    const SHIFTS: bool = false;
    const MEMORY: bool = true;

    #[inline(always)]
    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        Self {
            hertz: Hertz { stiffness: next() },
            relaxing: next(),
            left: next(),
            mean_left: next(),
            gain: next(),
            mean_gain: next(),
            rise_gain: next(),
            mean_rise_gain: next(),
        }
    }

    #[inline(always)]
    fn kick(&self, at: Approach<L>, _touching: L) -> Kick<L> {
        let near = at.may_touch();
        when(
            near,
            Kick::none(),
            #[inline(always)]
            || self.contact(at).zip(Kick::none(), &mut |inside, outside| L::select(near, inside, outside)),
        )
    }

    #[inline(always)]
    fn extremes(&self, at: Approach<L>, _: &Kick<L>) -> [L; 2] {
        extremes_near(
            at,
            #[inline(always)]
            || self.forces(at),
        )
    }
}
