//! First, total and second order indices from Saltelli's design.

use super::estimate::{Estimate, Spread};

/// Indices in the order of the groups.
#[derive(Clone, Debug, PartialEq)]
pub struct SobolIndices {
    pub first: Vec<Estimate>,
    pub total: Vec<Estimate>,
    /// Of pairs (0, 1), (0, 2), ..., (1, 2), ...; empty without second order.
    pub second: Vec<Estimate>,
}

/// Outputs of a design, by base sample and by what its rows are, centred and scaled.
struct Outputs {
    values: Vec<f64>,
    per: usize,
    groups: usize,
    second_order: bool,
}

/// Estimates of A. Saltelli et al., Comput. Phys. Commun. 181, 259 (2010), table 2 (b) and (f), and of A. Saltelli,
/// Comput. Phys. Commun. 145, 280 (2002) for pairs, each over the variance of rows A and B, as SALib has them.
///
/// `rows`: the output of every row of the design. Only base samples among `units` count; all their rows are finite.
pub fn indices(
    rows: &[f64],
    units: &[u32],
    (groups, second_order): (usize, bool),
    spread: Spread,
) -> SobolIndices {
    let per = if second_order { 2 * groups + 2 } else { groups + 2 };
    let own = |unit: &u32| rows[*unit as usize * per..(*unit as usize + 1) * per].iter();
    let count = (units.len() * per) as f64;
    let mean = units.iter().flat_map(own).sum::<f64>() / count;
    let scale = (units.iter().flat_map(own).map(|y| (y - mean).powi(2)).sum::<f64>() / count).sqrt();
    let values = rows.iter().map(|y| if scale > 0.0 { (y - mean) / scale } else { 0.0 }).collect();
    let outputs = Outputs { values, per, groups, second_order };
    let mut all = spread.estimate(units, |units| outputs.statistic(units)).into_iter();
    SobolIndices {
        first: all.by_ref().take(groups).collect(),
        total: all.by_ref().take(groups).collect(),
        second: all.collect(),
    }
}

impl Outputs {
    fn statistic(&self, units: &[u32]) -> Vec<f64> {
        let (groups, count) = (self.groups, units.len() as f64);
        let mut first = vec![0.0; groups];
        let mut total = vec![0.0; groups];
        let pairs = if self.second_order { groups * (groups - 1) / 2 } else { 0 };
        let mut second = vec![0.0; pairs];
        let (mut sum, mut squares) = (0.0, 0.0);
        for unit in units {
            let row = &self.values[*unit as usize * self.per..(*unit as usize + 1) * self.per];
            let (a, b) = (row[0], row[self.per - 1]);
            sum += a + b;
            squares += a * a + b * b;
            for (group, ab) in row[1..=groups].iter().enumerate() {
                first[group] += b * (ab - a);
                total[group] += (a - ab) * (a - ab);
            }
            if self.second_order {
                let mut pair = second.iter_mut();
                for (j, ba) in row[1 + groups..1 + 2 * groups].iter().enumerate() {
                    row[j + 2..=groups].iter().zip(pair.by_ref()).for_each(|(ab, at)| *at += ba * ab - a * b);
                }
            }
        }
        let variance = squares / (2.0 * count) - (sum / (2.0 * count)).powi(2);
        // An output that does not vary has no indices.
        let share = |sum: f64| if variance > f64::EPSILON { sum / count / variance } else { 0.0 };
        let first: Vec<f64> = first.into_iter().map(share).collect();
        let total = total.into_iter().map(|sum| 0.5 * share(sum));
        let names = (0..groups).flat_map(|j| (j + 1..groups).map(move |k| (j, k)));
        let second = second.into_iter().zip(names).map(|(sum, (j, k))| share(sum) - first[j] - first[k]);
        first.iter().copied().chain(total).chain(second).collect()
    }
}
