//! A Kelvin-Voigt sample: the force follows indentation and rate. Ting (1966), J. Appl. Mech. 33, 845, or the *ad hoc* form
//! of the literature; docs/method.md derives the step.

use super::cubic_path::CubicPath;
use super::dmt::Tail;
use super::hertz::{Elastic, Hertz};
use super::path::Path;
use super::{Approach, Interaction, Kick, Lane, Zip, extremes_near, touching_at};
use crate::constants::{
    EIGHTH, FIVE, HALF, HERTZ_SLOPE, LEAST, ONE, THIRD, TWELFTH, TWENTY_FOURTH, TWO, ZERO,
};
use crate::lane::when;

/// What attracts the tip beside the viscous contact.
pub trait ContactAdhesion<L: Lane>: Copy {
    /// The law's constants with it: those of the contact, then its own.
    const FIELDS: &'static [&'static str];

    fn from_numbers(next: impl FnMut() -> L) -> Self;

    /// Force at one indentation.
    fn sample(&self, indentation: L) -> L;

    /// Impulse and shift of a step along `path`, of which this share is in contact, if the contact gives the `repulsion`.
    fn pull(&self, at: Approach<L>, path: Path<L>, share: L, repulsion: L) -> (L, L);
}

/// No adhesion: Hertz's contact.
#[derive(Clone, Copy, Debug)]
pub struct Clean;

impl<L: Lane> ContactAdhesion<L> for Clean {
    const FIELDS: &'static [&'static str] = &["stiffness", "retardation", "ad_hoc"];

    fn from_numbers(_: impl FnMut() -> L) -> Self {
        Self
    }

    #[inline(always)]
    fn sample(&self, _: L) -> L {
        L::splat(ZERO)
    }

    #[inline(always)]
    fn pull(&self, _: Approach<L>, _: Path<L>, _: L, _: L) -> (L, L) {
        (L::splat(ZERO), L::splat(ZERO))
    }
}

impl<L: Lane> ContactAdhesion<L> for Tail<L> {
    const FIELDS: &'static [&'static str] =
        &["stiffness", "retardation", "ad_hoc", "adhesion", "inverse_decay"];

    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        Self { adhesion: next(), inverse_decay: next() }
    }

    #[inline(always)]
    fn sample(&self, indentation: L) -> L {
        let y = L::splat(ONE) / self.stretch(indentation);
        -(self.adhesion * y * y)
    }

    #[inline(always)]
    fn pull(&self, at: Approach<L>, path: Path<L>, share: L, repulsion: L) -> (L, L) {
        let mean = self.along(self.fall(path), share);
        let force = repulsion - mean.force;
        let straight = (force * mean.slope).mul_add(L::splat(TWELFTH), -mean.force);
        mean.bent((self.adhesion, at.acceleration - force), share, straight)
    }
}

/// `retardation` is the sample's retardation time in steps, viscosity over modulus. `ad_hoc` is 1 for the form that adds the
/// viscous force on both ways and pulls on withdrawal, 0 for Ting's.
#[derive(Clone, Copy, Debug)]
pub struct KelvinVoigt<L, A> {
    pub hertz: Hertz<L>,
    pub retardation: L,
    pub ad_hoc: L,
    pub adhesion: A,
}

/// The contact's force at one indentation and rate, and its elastic part with its slope.
#[derive(Clone, Copy)]
struct RatePoint<L> {
    indentation: L,
    rate: L,
    force: L,
    elastic: L,
    slope: L,
}

/// The step without its kick: half a step before the sample and half a step after it.
#[derive(Clone, Copy)]
struct StepEnds<L> {
    start: L,
    start_rate: L,
    end: L,
    end_rate: L,
}

impl<L: Lane> StepEnds<L> {
    #[inline(always)]
    fn of(at: Approach<L>) -> Self {
        let half = L::splat(HALF);
        let middle = L::splat(EIGHTH).mul_add(at.acceleration, at.indentation);
        let (reach, change) = (half * at.speed, half * at.acceleration);
        Self {
            start: middle - reach,
            start_rate: at.speed - change,
            end: middle + reach,
            end_rate: at.speed + change,
        }
    }
}

/// The contact's part of a step.
#[derive(Clone, Copy)]
struct ContactPass<L> {
    impulse: L,
    /// Travel by which the impulse falls late.
    lag: L,
    share: L,
    touching: L,
}

impl<L: Lane, A: ContactAdhesion<L>> KelvinVoigt<L, A> {
    /// Whether the tip withdraws from a sample that lets it go early.
    #[inline(always)]
    fn withdraws(&self, rate: L) -> L::Mask {
        let zero = L::splat(ZERO);
        L::both(rate.less(zero), L::not(zero.less(self.ad_hoc)))
    }

    #[inline(always)]
    fn point(&self, indentation: L, rate: L) -> RatePoint<L> {
        let inside = indentation.max(L::splat(ZERO));
        let root = inside.sqrt();
        let elastic = self.hertz.stiffness * inside * root;
        let slope = L::splat(HERTZ_SLOPE) * self.hertz.stiffness * root;
        let along = self.retardation * rate;
        let force = L::select(
            self.withdraws(rate),
            self.hertz.sample(indentation + along),
            slope.mul_add(along, elastic),
        );
        RatePoint { indentation, rate, force, elastic, slope }
    }

    /// By how much the force on withdrawal exceeds the same with the rate's term alone.
    #[inline(always)]
    fn curvature(&self, at: &RatePoint<L>) -> L {
        let along = self.retardation * at.rate;
        let whole = self.hertz.sample(at.indentation + along);
        let more = whole - at.slope.mul_add(along, at.elastic);
        L::select(self.withdraws(-L::splat(ONE)), more, L::splat(ZERO))
    }

    /// The point at an end of the step. The tip's path is off the stepped one by a twelfth of the force there, and at the end of a
    /// pass, whose start and elastic mean are given, by how late the viscous force acts.
    #[inline(always)]
    fn end_point(&self, indentation: L, rate: L, pass: Option<(&RatePoint<L>, L)>) -> RatePoint<L> {
        let twelfth = L::splat(TWELFTH);
        let mut point = self.point(indentation, rate);
        for _ in 0..2 {
            let force = point.force + self.adhesion.sample(point.indentation);
            let late = match pass {
                Some(pass) => self.lag(pass, &point),
                None => L::splat(ZERO),
            };
            point = self.point(twelfth.mul_add(force, indentation) + late, rate);
        }
        point
    }

    /// How late the viscous force of a pass acts: between its start and its end, with the mean of the elastic force.
    #[inline(always)]
    fn lag(&self, (start, mean): (&RatePoint<L>, L), end: &RatePoint<L>) -> L {
        let middle = L::splat(HALF) * (start.elastic + end.elastic) - mean;
        let bend = end.slope * end.rate - start.slope * start.rate;
        self.retardation * (-L::splat(TWELFTH)).mul_add(bend, middle)
    }

    /// The impulse to begin with: the force at the sample with the rate in the middle of the kick.
    #[inline(always)]
    fn predicted(&self, at: Approach<L>) -> L {
        let half = L::splat(HALF);
        let here = self.point(at.indentation, at.speed);
        let slope = L::select(
            self.withdraws(at.speed),
            self.point(self.retardation.mul_add(at.speed, at.indentation), L::splat(ZERO)).slope,
            here.slope,
        );
        let force = here.force + self.adhesion.sample(at.indentation);
        force / (half * self.retardation).mul_add(slope, L::splat(ONE))
    }

    /// The contact's part if the whole impulse is `impulse`, the end of the step, and the slope of the impulse's equation.
    #[inline(always)]
    fn pass(
        &self,
        at: Approach<L>,
        (ends, start): (&StepEnds<L>, &RatePoint<L>),
        impulse: L,
    ) -> (ContactPass<L>, RatePoint<L>, L) {
        let (zero, one, half) = (L::splat(ZERO), L::splat(ONE), L::splat(HALF));
        let (twelfth, tau) = (L::splat(TWELFTH), self.retardation);
        let half_kick = half * impulse;
        let end_rate = ends.end_rate - impulse;
        let reach = half * (at.speed - half_kick);
        let shifted = L::splat(TWENTY_FOURTH) * at.acceleration - twelfth * impulse;
        let centre = at.indentation + shifted;
        let chord = Path { start: centre - reach, end: centre + reach };
        // On approach: the elastic mean, and the viscous impulse, which is exact for any path.
        let mean = self.hertz.mean(chord);
        let end = self.end_point(ends.end - half_kick, end_rate, Some((start, mean.force)));
        let turn = (start.rate - end_rate).abs().max(L::splat(LEAST));
        let third = L::splat(THIRD) / turn;
        let turned = L::select(end_rate.less(zero), -(end_rate * self.curvature(&end)) * third, zero);
        let inward = mean.force + tau * (end.elastic - start.elastic) + turned;
        let inward_slope = one + twelfth * mean.slope + L::splat(FIVE) * twelfth * tau * end.slope;
        // On withdrawal: Ting's force is Hertz's at d + tau v, so its mean is Hertz's along the chord of that.
        let bent = (end.force + self.adhesion.sample(end.indentation))
            - (start.force + self.adhesion.sample(start.indentation));
        let early = tau.mul_add(at.speed - half_kick + twelfth * bent, centre);
        let early_reach = half.mul_add(tau * (at.acceleration - impulse), reach);
        let away = Path { start: early - early_reach, end: early + early_reach };
        let away_mean = self.hertz.mean(away);
        let began = L::select(zero.less(start.rate), start.rate * self.curvature(start) * third, zero);
        let outward = away_mean.force - began;
        let outward_slope = half.mul_add(tau, twelfth).mul_add(away_mean.slope, one);
        let leaves = self.withdraws(start.rate + end_rate);
        let pass = ContactPass {
            impulse: L::select(leaves, outward, inward),
            lag: L::select(leaves, zero, self.lag((start, mean.force), &end)),
            share: L::select(leaves, away_mean.share, mean.share),
            touching: touching_at(L::select(leaves, away.end, chord.end)),
        };
        (pass, end, L::select(leaves, outward_slope, inward_slope))
    }

    /// What passes through zero where d^1.5 + 1.5 tau sqrt(d) v turns along a path, 2 d (v + tau a) + tau v^2, with its slope.
    #[inline(always)]
    fn turning(&self, path: &CubicPath<L>, share: L) -> (L, L) {
        let (two, tau) = (L::splat(TWO), self.retardation);
        let [indentation, rate, turn] = path.at(share);
        let early = tau.mul_add(turn, rate);
        let change = tau.mul_add(path.jerk(), turn);
        let height = two * indentation * early + tau * rate * rate;
        (height, two * (rate * early + indentation * change + tau * rate * turn))
    }

    /// The force after a share of the step.
    #[inline(always)]
    fn force_on(&self, path: &CubicPath<L>, share: L) -> L {
        let [indentation, rate, _] = path.at(share);
        self.point(indentation, rate).force + self.adhesion.sample(indentation)
    }

    /// The force where it turns next to an extreme of the samples.
    #[inline(always)]
    fn turn_near(&self, path: &CubicPath<L>, sampled: L) -> L {
        let (zero, one, apart) = (L::splat(ZERO), L::splat(ONE), L::splat(EIGHTH));
        let (low, high) = ((sampled - apart).max(zero), (sampled + apart).min(one));
        let mut share = sampled;
        for _ in 0..3 {
            let (height, slope) = self.turning(path, share);
            let level = slope.abs().less(L::splat(LEAST));
            share = (share - height / L::select(level, one, slope)).max(low).min(high);
        }
        self.force_on(path, share)
    }

    /// Least and largest force of a step that may touch.
    #[inline(never)]
    fn forces(&self, at: Approach<L>, impulse: L) -> (L, L) {
        L::run(
            #[inline(always)]
            || self.followed(at, impulse),
        )
    }

    /// The same: of nine samples of the step, of where the force turns next to their extremes, of where the tip turns, and of
    /// where it crosses the surface. A curve through samples would overshoot where the contact begins or ends between two.
    #[inline(always)]
    fn followed(&self, at: Approach<L>, impulse: L) -> (L, L) {
        let zero = L::splat(ZERO);
        let ends = StepEnds::of(at);
        let start = self.end_point(ends.start, ends.start_rate, None);
        let (_, end, _) = self.pass(at, (&ends, &start), impulse);
        let path = CubicPath::between((start.indentation, start.rate), (end.indentation, end.rate));
        let first = self.force_on(&path, zero);
        let (mut least, mut most) = ((first, zero), (first, zero));
        let mut share = zero;
        for _ in 0..8 {
            share = share + L::splat(EIGHTH);
            let force = self.force_on(&path, share);
            let (lower, higher) = (force.less(least.0), most.0.less(force));
            least = (force.min(least.0), L::select(lower, share, least.1));
            most = (force.max(most.0), L::select(higher, share, most.1));
        }
        let tip = path.turn();
        let turns =
            [self.turn_near(&path, least.1), self.turn_near(&path, most.1), self.force_on(&path, tip)];
        let (low, high) = (start.indentation.min(end.indentation), start.indentation.max(end.indentation));
        let crosses = L::both(low.less(zero), zero.less(high.max(path.at(tip)[0])));
        let surface = self.adhesion.sample(low.max(zero));
        let mut extremes = (least.0.min(L::select(crosses, surface, first)), most.0);
        for force in turns {
            extremes = (extremes.0.min(force), extremes.1.max(force));
        }
        extremes
    }
}

impl<L: Lane, A: ContactAdhesion<L>> KelvinVoigt<L, A> {
    /// A step that may touch. It is long, so it is compiled once, not into every loop over steps.
    #[inline(never)]
    fn contact(&self, at: Approach<L>) -> Kick<L> {
        L::run(
            #[inline(always)]
            || self.contact_kick(at),
        )
    }

    #[inline(always)]
    fn contact_kick(&self, at: Approach<L>) -> Kick<L> {
        let first = self.predicted(at);
        let path = Path::around(at, first);
        let repulsion = first - self.adhesion.sample(at.indentation);
        let (pull, shift) = self.adhesion.pull(at, path, path.share_inside(), repulsion);
        let ends = StepEnds::of(at);
        let start = self.end_point(ends.start, ends.start_rate, None);
        let most = first.abs() + at.speed.abs() + at.acceleration.abs();
        let mut impulse = first;
        for _ in 0..2 {
            let (pass, _, slope) = self.pass(at, (&ends, &start), impulse);
            // Where the contact is not resolved the iteration stays bounded.
            let change = (pass.impulse + pull - impulse) / slope;
            impulse = impulse + change.max(-most).min(most);
        }
        let (pass, _, _) = self.pass(at, (&ends, &start), impulse);
        Kick {
            impulse,
            shift: shift - pass.lag,
            contact: pass.share,
            touching: pass.touching,
            ..Kick::none()
        }
    }
}

impl<L: Lane, A: ContactAdhesion<L>> Interaction<L> for KelvinVoigt<L, A> {
    const FIELDS: &'static [&'static str] = A::FIELDS;
    const SHIFTS: bool = true;

    #[inline(always)]
    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        let (stiffness, retardation, ad_hoc) = (next(), next(), next());
        Self { hertz: Hertz { stiffness }, retardation, ad_hoc, adhesion: A::from_numbers(next) }
    }

    #[inline(always)]
    fn kick(&self, at: Approach<L>, _touching: L) -> Kick<L> {
        let zero = L::splat(ZERO);
        let near = at.may_touch();
        let path = Path::around(at, self.adhesion.sample(at.indentation));
        let (impulse, shift) = self.adhesion.pull(at, path, zero, zero);
        let far = Kick { impulse, shift, ..Kick::none() };
        when(
            near,
            far,
            #[inline(always)]
            || self.contact(at).zip(far, &mut |inside, outside| L::select(near, inside, outside)),
        )
    }

    #[inline(always)]
    fn extremes(&self, at: Approach<L>, kick: &Kick<L>) -> [L; 2] {
        extremes_near(
            at,
            #[inline(always)]
            || self.forces(at, kick.impulse),
        )
    }
}
