//! First-order indices from any sample: how much of the variance lies between bins of a parameter.

use super::estimate::{Estimate, NORMAL_95, Spread};

/// Most bins.
const BINS: usize = 64;
/// Fewest samples in a bin, and where there are replicates, of each of them.
const IN_BIN: usize = 8;
const OF_REPLICATE: usize = 2;

/// A parameter's bins: which one each base sample is in, about as many in each.
struct Bins {
    of: Vec<u16>,
    count: usize,
}

impl Bins {
    fn new(parameter: &[f64], units: &[u32], count: usize) -> Self {
        let mut order: Vec<u32> = units.to_vec();
        order.sort_by(|a, b| parameter[*a as usize].total_cmp(&parameter[*b as usize]));
        let mut of = vec![0; parameter.len()];
        for (place, unit) in order.iter().enumerate() {
            of[*unit as usize] = (place * count / order.len()) as u16;
        }
        // Equal values are one bin: a parameter of few values has no more bins than these.
        for pair in order.windows(2) {
            let (before, after) = (pair[0] as usize, pair[1] as usize);
            if parameter[before] == parameter[after] {
                of[after] = of[before];
            }
        }
        Self { of, count }
    }

    /// The share of the variance that lies between the bins, less what the scatter inside them makes of it by chance.
    ///
    /// `output` is centred. Of points drawn one by one the scatter inside bins tells that (analysis of variance); points of
    /// one scramble are balanced, and only replicates know how far the means of bins are off.
    fn share(&self, output: &[f64], units: &[u32], replicates: usize) -> f64 {
        let mut cells = vec![(0.0, 0.0); self.count * replicates];
        let mut squares = 0.0;
        for unit in units {
            let y = output[*unit as usize];
            let bin = usize::from(self.of[*unit as usize]);
            let (number, sum) = &mut cells[bin * replicates + *unit as usize % replicates];
            (*number, *sum) = (*number + 1.0, *sum + y);
            squares += y * y;
        }
        let whole =
            |cells: &[(f64, f64)]| cells.iter().fold((0.0, 0.0), |all, one| (all.0 + one.0, all.1 + one.1));
        let (count, sum) = whole(&cells);
        let all = squares - sum * sum / count;
        let (mut between, mut chance, mut bins) = (-sum * sum / count, 0.0, 0.0);
        for cells in cells.chunks(replicates) {
            let (number, sum) = whole(cells);
            if number > 0.0 {
                between += sum * sum / number;
                bins += 1.0;
                chance += number * mean_by_chance(cells);
            }
        }
        if !(bins >= 2.0 && all > 0.0 && count > bins) {
            return f64::NAN;
        }
        if replicates == 1 {
            chance = (bins - 1.0) * (all - between) / (count - bins);
        }
        (between - chance) / all
    }
}

/// Variance of the mean of a bin, from the means of its replicates.
fn mean_by_chance(cells: &[(f64, f64)]) -> f64 {
    let filled = || cells.iter().filter(|(number, _)| *number > 0.0);
    let count = filled().count() as f64;
    if count < 2.0 {
        return 0.0;
    }
    let mean = filled().map(|(number, sum)| sum / number).sum::<f64>() / count;
    let squares: f64 = filled().map(|(number, sum)| (sum / number - mean).powi(2)).sum();
    squares / (count - 1.0) / count
}

/// Standard deviation of a share that is nothing but chance: the scatter of what lies between so many bins of samples drawn
/// one by one (chi-squared with a degree of freedom less than bins). A bootstrap repeats samples within a bin and finds less.
fn sd_by_chance(share: f64, samples: usize, bins: usize) -> f64 {
    (2.0 * (bins as f64 - 1.0)).sqrt() * (1.0 - share).max(0.0) / (samples - bins) as f64
}

/// First-order indices of every parameter. What a parameter does inside a bin is left out, a share of about one over the
/// square of the bins. Half as many bins leave out several times as much, so intervals are widened by what these lack.
///
/// `output` and `parameters` are by base sample; only those among `units` count. NaN with fewer than two bins.
pub fn first_order(output: &[f64], parameters: &[&[f64]], units: &[u32], spread: Spread) -> Vec<Estimate> {
    let (replicates, count) = match spread {
        Spread::Bootstrap(_) => (1, units.len() / IN_BIN),
        Spread::Replicates(replicates) => (replicates, units.len() / replicates / OF_REPLICATE),
    };
    let count = count.min(BINS);
    if count < 2 {
        return vec![Estimate { value: f64::NAN, half_width: f64::NAN }; parameters.len()];
    }
    let shift = units.iter().map(|unit| output[*unit as usize]).sum::<f64>() / units.len() as f64;
    let output: Vec<f64> = output.iter().map(|y| y - shift).collect();
    let cut = |count| parameters.iter().map(|one| Bins::new(one, units, count)).collect::<Vec<Bins>>();
    let shares = |bins: &[Bins], units: &[u32]| -> Vec<f64> {
        bins.iter().map(|one| one.share(&output, units, replicates)).collect()
    };
    let bins = cut(count);
    let mut found = spread.estimate(units, |units| shares(&bins, units));
    // One bin has nothing between bins.
    let coarser = if count < 4 { vec![0.0; found.len()] } else { shares(&cut(count / 2), units) };
    for (one, coarser) in found.iter_mut().zip(coarser) {
        one.half_width += (one.value - coarser).max(0.0);
        if replicates == 1 {
            one.half_width = one.half_width.max(NORMAL_95 * sd_by_chance(one.value, units.len(), count));
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::design::{Mix, normal_quantile};

    /// Truth: a parameter that does nothing has a share of 0, which intervals of 95 % hold in most samples.
    #[test]
    fn intervals_hold_the_share_of_what_does_nothing() {
        for count in [64, 128, 255, 1024] {
            for spread in [Spread::Bootstrap(1), Spread::Replicates(8)] {
                let held = (0..200).filter(|seed| {
                    let mix = Mix::new(*seed);
                    let drawn = |from: u64| -> Vec<f64> {
                        let number = |i| (mix.of(from + i).below(1 << 30) as f64 + 0.5) / (1u64 << 30) as f64;
                        (0..count).map(number).collect()
                    };
                    let (output, parameter) = (drawn(0), drawn(1 << 32));
                    let units: Vec<u32> = (0..count as u32).collect();
                    first_order(&output, &[&parameter], &units, spread)[0].holds_zero()
                });
                let held = held.count();
                assert!(held >= 180, "{count} {spread:?}: {held} of 200");
            }
        }
    }

    /// Truth: the one quantity there is explains all. The interval holds that with few rows too, and tightens with many.
    #[test]
    fn intervals_hold_what_few_bins_leave_out() {
        let drawn = |count: usize| -> Vec<f64> {
            let mix = Mix::new(7);
            (0..count).map(|i| (mix.of(i as u64).below(1 << 30) as f64 + 0.5) / (1u64 << 30) as f64).collect()
        };
        let normal = |count| -> Vec<f64> { drawn(count).into_iter().map(normal_quantile).collect() };
        for count in [16, 32, 64, 128, 256, 1024, 8192] {
            for values in [drawn(count), normal(count)] {
                let units: Vec<u32> = (0..count as u32).collect();
                for spread in [Spread::Bootstrap(1), Spread::Replicates(2)] {
                    let one = first_order(&values, &[&values], &units, spread)[0];
                    assert!((1.0 - one.value).abs() <= one.half_width, "{count} {spread:?}: {one:?}");
                    assert!(count < 1024 || one.half_width < 0.05, "{count} {spread:?}: {one:?}");
                }
            }
        }
    }
}
