//! Tips of other shapes, and the parabola's own limit: a force that is a sum of half-integer powers of the indentation,
//! f = sum c_n d^(n/2), n = 2 to 11. A flat punch is d, a cone d^2, a sphere a short series (Sneddon 1965; docs/model.md).

use super::hertz::{Elastic, Mean, elastic_kick};
use super::path::Path;
use super::{Approach, Interaction, Kick, Lane};
use crate::constants::{LEAST, POWER_MEANS, ZERO};

/// How many powers there are: of d, d^1.5, ... d^5.5.
pub const POWERS: usize = POWER_MEANS.len();

/// `force` has the coefficients in kernel units: impulse per step of a unit indentation, by powers.
#[derive(Clone, Copy, Debug)]
pub struct ShapedHertz<L> {
    pub force: [L; POWERS],
}

impl<L: Lane> Elastic<L> for ShapedHertz<L> {
    const FIELDS: &'static [&'static str] = SHAPED_DMT.split_at(POWERS).0;
    const WITH_TAIL: &'static [&'static str] = &SHAPED_DMT;

    #[inline(always)]
    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        Self { force: std::array::from_fn(|_| next()) }
    }

    #[inline(always)]
    fn sample(&self, indentation: L) -> L {
        let inside = indentation.max(L::splat(ZERO));
        let root = inside.sqrt();
        let mut sum = self.force[POWERS - 1];
        for coefficient in self.force[..POWERS - 1].iter().rev() {
            sum = sum.mul_add(root, *coefficient);
        }
        inside * sum
    }

    /// Difference quotients of d^(n/2 + 1)/(n/2 + 1) and of d^(n/2): with the roots a, b of both ends they are h_(n+1)/(a + b)
    /// times 2/(n + 2) and h_(n-1)/(a + b), where h_m = a^m + a^(m-1) b + ... + b^m.
    #[inline(always)]
    fn mean(&self, path: Path<L>) -> Mean<L> {
        let zero = L::splat(ZERO);
        let (a, b) = (path.start.max(zero).sqrt(), path.end.max(zero).sqrt());
        let share = path.share_inside();
        let sum = a + b;
        // h_1, h_2, ... and b^2, b^3, ...
        let mut power = b * b;
        let mut last = sum;
        let mut here = a.mul_add(sum, power);
        let (mut force, mut slope) = (zero, zero);
        for (coefficient, mean) in self.force.iter().zip(POWER_MEANS) {
            slope = coefficient.mul_add(last, slope);
            power = power * b;
            let next = a.mul_add(here, power);
            force = (*coefficient * L::splat(mean)).mul_add(next, force);
            (last, here) = (here, next);
        }
        let scale = share / sum.max(L::splat(LEAST));
        Mean { force: force * scale, slope: slope * scale, share }
    }
}

/// The constants, with DMT's attraction last.
const SHAPED_DMT: [&str; POWERS + 2] = [
    "force_2",
    "force_3",
    "force_4",
    "force_5",
    "force_6",
    "force_7",
    "force_8",
    "force_9",
    "force_10",
    "force_11",
    "adhesion",
    "inverse_decay",
];

impl<L: Lane> Interaction<L> for ShapedHertz<L> {
    const FIELDS: &'static [&'static str] = <Self as Elastic<L>>::FIELDS;
    const SHIFTS: bool = false;
    const ONLY_IN_CONTACT: bool = true;

    #[inline(always)]
    fn from_numbers(next: impl FnMut() -> L) -> Self {
        <Self as Elastic<L>>::from_numbers(next)
    }

    #[inline(always)]
    fn kick(&self, at: Approach<L>, _touching: L) -> Kick<L> {
        elastic_kick(self, at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::Hertz;

    /// Truth: Hertz's own form, and closed antiderivatives of d and d^2.
    #[test]
    fn means_are_those_of_the_antiderivatives() {
        let alone =
            |n: usize| ShapedHertz { force: std::array::from_fn(|k| if k + 2 == n { 3.0 } else { 0.0 }) };
        for (start, end) in [(0.2, 0.7), (0.7, 0.2), (-0.3, 0.4), (1.1, -0.1), (0.5, 0.5)] {
            let path = Path { start, end };
            let (ours, hertz) = (alone(3).mean(path), Hertz { stiffness: 3.0 }.mean(path));
            assert!((ours.force - hertz.force).abs() < 1e-15 && (ours.slope - hertz.slope).abs() < 1e-15);
            let (low, high) = (f64::max(start, 0.0), f64::max(end, 0.0));
            for n in [2, 4, 11] {
                let (ours, power) = (alone(n).mean(path), n as f64 / 2.0);
                let work = |d: f64| 3.0 * d.powf(power + 1.0) / (power + 1.0);
                let (mean, slope) = match start == end {
                    true => (3.0 * low.powf(power), 3.0 * power * low.powf(power - 1.0)),
                    false => (
                        (work(high) - work(low)) / (end - start),
                        3.0 * (high.powf(power) - low.powf(power)) / (end - start),
                    ),
                };
                assert!((ours.force - mean).abs() < 1e-14, "{n}: {} {mean}", ours.force);
                assert!((ours.slope - slope).abs() < 1e-13, "{n}: {} {slope}", ours.slope);
            }
            assert!((alone(5).sample(0.64) - 3.0 * 0.8f64.powi(5)).abs() < 1e-15);
        }
        assert_eq!(alone(2).mean(Path { start: -1.0, end: -2.0 }).force, 0.0);
        assert_eq!(POWER_MEANS.map(|mean| (2.0 / mean).round()), std::array::from_fn(|k| k as f64 + 4.0));
    }
}
