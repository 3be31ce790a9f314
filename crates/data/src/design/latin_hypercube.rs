//! Latin hypercubes that can be doubled: the points of the first half stay.

use super::mix::Mix;

/// A coordinate of point `index` of so many: one point in each of `count` strata of equal width.
///
/// Where the number is a multiple of two, the first half of the points is a hypercube of half as many strata, and each
/// later point takes the empty half of a stratum (P. Z. G. Qian, Biometrika 96, 957 (2009), nested Latin hypercubes).
pub(super) fn coordinate(index: u64, count: u64, mix: Mix) -> f64 {
    let mut first = count >> count.trailing_zeros();
    if index < first {
        return at(mix.of(first).permuted(index, first), first, mix, index);
    }
    while index >= 2 * first {
        first *= 2;
    }
    // The partner whose stratum of the coarser cube this point shares.
    let partner = mix.of(first).of(1).permuted(index - first, first);
    let taken = stratum(coordinate(partner, first, mix), 2 * first);
    at(taken ^ 1, 2 * first, mix, index)
}

/// A place inside a stratum, never on its edge.
fn at(stratum: u64, count: u64, mix: Mix, index: u64) -> f64 {
    (stratum as f64 + 1e-6 + (1.0 - 2e-6) * mix.of(u64::MAX).of(index).share()) / count as f64
}

fn stratum(share: f64, count: u64) -> u64 {
    (share * count as f64) as u64
}

#[cfg(test)]
mod tests {
    use super::{Mix, coordinate};

    #[test]
    fn every_stratum_has_one_point_and_halves_stay() {
        for count in [1u64, 2, 3, 7, 12, 64, 100, 1000, 4096] {
            let mut seen = vec![false; count as usize];
            for index in 0..count {
                let share = coordinate(index, count, Mix::new(5));
                let stratum = (share * count as f64) as usize;
                assert!(!std::mem::replace(&mut seen[stratum], true), "{count}: stratum {stratum} twice");
                assert_eq!(share, coordinate(index, 2 * count, Mix::new(5)));
            }
        }
    }
}
