//! First-order indices from any sample: how much of the variance lies between bins of a parameter.

use super::estimate::{Estimate, Spread};

/// Most bins.
const BINS: usize = 64;
/// Fewest samples in a bin.
const IN_BIN: usize = 8;

/// Which bin each base sample is in, by the parameter's value: about as many samples in each.
fn bins(parameter: &[f64], units: &[u32]) -> (Vec<u16>, usize) {
    let count = BINS.min(units.len() / IN_BIN);
    let mut order: Vec<u32> = units.to_vec();
    order.sort_by(|a, b| parameter[*a as usize].total_cmp(&parameter[*b as usize]));
    let mut bin_of = vec![0; parameter.len()];
    for (place, unit) in order.iter().enumerate() {
        bin_of[*unit as usize] = (place * count / order.len()) as u16;
    }
    // Equal values are one bin: a parameter of few values has no more bins than these.
    for pair in order.windows(2) {
        let (before, after) = (pair[0] as usize, pair[1] as usize);
        if parameter[before] == parameter[after] {
            bin_of[after] = bin_of[before];
        }
    }
    (bin_of, count)
}

/// First-order indices of every parameter. Of the variance between bins what the scatter inside them makes by chance is
/// taken away (analysis of variance, the estimate of T. L. Kelley's epsilon squared); what a parameter does inside a bin is
/// left out, a share of about one over the square of the bins.
///
/// `output` and `parameters` are by base sample; only those among `units` count. NaN with fewer than two bins.
pub fn first_order(output: &[f64], parameters: &[&[f64]], units: &[u32], spread: Spread) -> Vec<Estimate> {
    let binned: Vec<(Vec<u16>, usize)> = parameters.iter().map(|one| bins(one, units)).collect();
    let shift = units.iter().map(|unit| output[*unit as usize]).sum::<f64>() / units.len() as f64;
    let one = |units: &[u32], (bin_of, count): &(Vec<u16>, usize)| {
        let mut sums = vec![(0.0, 0.0); *count];
        let mut squares = 0.0;
        for unit in units {
            let y = output[*unit as usize] - shift;
            let (number, sum) = &mut sums[usize::from(bin_of[*unit as usize])];
            (*number, *sum) = (*number + 1.0, *sum + y);
            squares += y * y;
        }
        let (count, sum) = (units.len() as f64, sums.iter().map(|(_, sum)| sum).sum::<f64>());
        let all = squares - sum * sum / count;
        let filled = sums.iter().filter(|(number, _)| *number > 0.0);
        let between = filled.clone().map(|(number, sum)| sum * sum / number).sum::<f64>() - sum * sum / count;
        let bins = filled.count() as f64;
        match bins >= 2.0 && all > 0.0 && count > bins {
            true => (between - (bins - 1.0) * (all - between) / (count - bins)) / all,
            false => f64::NAN,
        }
    };
    if units.len() < 2 * IN_BIN {
        return vec![Estimate { value: f64::NAN, half_width: f64::NAN }; parameters.len()];
    }
    spread.estimate(units, |units| binned.iter().map(|bins| one(units, bins)).collect())
}
