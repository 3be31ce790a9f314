//! Designs: at which points of uncertain quantities a scene is simulated.
//!
//! Plain mathematics: distributions, point sets, correlation. Every point follows from the design and its own index, so
//! that parts of a design agree with the whole, and one that is doubled keeps its points.

mod copula;
mod description;
mod distribution;
mod latin_hypercube;
mod mix;
mod morris;
mod sobol;

pub use copula::Copula;
pub use description::{DesignDescription, DesignRecord, Problem};
pub use distribution::{Distribution, normal_below, normal_quantile};

use self::sobol::Sequence;
pub use mix::Mix;
use morris::Trajectories;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Most parameters of a design: two of the dimensions of a Sobol' sequence for each.
pub const MOST_PARAMETERS: usize = Sequence::DIMENSIONS / 2;

/// Part of the seed's stream that serves trajectories, beside those of the replicates.
const TRAJECTORIES: u64 = u64::MAX;
/// Shares of the ends of a grid of trajectories under a distribution that has none.
const MORRIS_ENDS: (f64, f64) = (0.005, 0.995);

/// Rows that are drawn together: there may be very many.
const AT_ONCE: usize = 1 << 16;

/// How points are laid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum DesignKind {
    /// Each by itself, at random.
    MonteCarlo,
    /// One in each stratum of every parameter.
    LatinHypercube,
    /// Spread evenly over all parameters together.
    Sobol,
    /// Two Sobol' points for each base sample, and those between them: for first, second and total indices.
    Saltelli,
    /// Trajectories in which one parameter moves after the other.
    Morris,
    /// As a file lists them.
    Table,
}

impl DesignKind {
    /// Words of `design.kind`.
    pub const WORDS: [(&'static str, Self); 6] = [
        ("monte-carlo", Self::MonteCarlo),
        ("latin-hypercube", Self::LatinHypercube),
        ("sobol", Self::Sobol),
        ("saltelli", Self::Saltelli),
        ("morris", Self::Morris),
        ("table", Self::Table),
    ];

    pub fn word(self) -> &'static str {
        Self::WORDS.iter().find(|(_, kind)| *kind == self).map_or("", |(word, _)| word)
    }

    /// Rows that belong to one base sample of so many groups.
    pub fn rows_per_sample(self, groups: usize, second_order: bool) -> usize {
        match self {
            Self::Saltelli if second_order => 2 * groups + 2,
            Self::Saltelli => groups + 2,
            Self::Morris => groups + 1,
            _ => 1,
        }
    }
}

/// An uncertain quantity.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Path in the scene, as `instrument.tip.radius`.
    pub path: String,
    /// Name in the results file, as `tip_radius`.
    pub name: String,
    /// SI unit.
    pub units: String,
    /// None in a table.
    pub distribution: Option<Distribution>,
}

/// What decides the points.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    pub kind: DesignKind,
    /// Base samples of all replicates together; trajectories; rows of a table.
    pub samples: usize,
    /// Independent scrambles, each of the same number of base samples; 1 where there are none.
    pub replicates: usize,
    pub seed: u64,
    pub scramble: bool,
    pub second_order: bool,
    /// Of a grid of trajectories.
    pub levels: u64,
    /// Parameters that move together, by their numbers; every parameter is in one.
    pub groups: Vec<Vec<usize>>,
    /// Rank correlations of pairs of parameters.
    pub correlation: Vec<(usize, usize, f64)>,
}

/// A design, ready to be drawn.
#[derive(Clone, Debug)]
pub struct Design {
    pub settings: Settings,
    pub parameters: Vec<Parameter>,
    copula: Option<Copula>,
    sequence: Option<Sequence>,
    group_of: Vec<usize>,
}

impl PartialEq for Design {
    fn eq(&self, other: &Self) -> bool {
        (&self.settings, &self.parameters) == (&other.settings, &other.parameters)
    }
}

impl Design {
    /// None where the correlations contradict each other. Settings and parameters fit together: indices are below their
    /// number, replicates divide the samples, levels are even.
    pub fn new(settings: Settings, parameters: Vec<Parameter>) -> Option<Self> {
        let copula = match settings.correlation.as_slice() {
            [] => None,
            pairs => Some(Copula::new(parameters.len(), pairs)?),
        };
        let sequence = match settings.kind {
            DesignKind::Sobol => Some(Sequence::new(parameters.len())),
            DesignKind::Saltelli => Some(Sequence::new(2 * parameters.len())),
            _ => None,
        };
        let mut group_of = vec![0; parameters.len()];
        for (number, members) in settings.groups.iter().enumerate() {
            members.iter().for_each(|member| group_of[*member] = number);
        }
        Some(Self { settings, parameters, copula, sequence, group_of })
    }

    /// That of a table of so many rows; of each parameter something is told by itself.
    pub fn table(samples: usize, levels: u64, parameters: Vec<Parameter>) -> Self {
        let settings = Settings {
            kind: DesignKind::Table,
            samples,
            replicates: 1,
            seed: 0,
            scramble: false,
            second_order: false,
            levels,
            groups: (0..parameters.len()).map(|n| vec![n]).collect(),
            correlation: Vec::new(),
        };
        let group_of = (0..parameters.len()).collect();
        Self { settings, parameters, copula: None, sequence: None, group_of }
    }

    /// Rows that belong to one base sample.
    pub fn rows_per_sample(&self) -> usize {
        let Settings { kind, groups, second_order, .. } = &self.settings;
        kind.rows_per_sample(groups.len(), *second_order)
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.settings.samples * self.rows_per_sample()
    }

    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The shares of a row: of each parameter, how much of its distribution lies below its value. Nothing for a table.
    pub fn shares(&self, row: usize) -> Vec<f64> {
        let per = self.rows_per_sample();
        let (sample, within) = (row / per, row % per);
        let mut shares: Vec<f64> = match self.settings.kind {
            DesignKind::MonteCarlo => {
                let mix = Mix::new(self.settings.seed).of(row as u64);
                (0..self.parameters.len()).map(|n| mix.of(n as u64).share()).collect()
            }
            DesignKind::LatinHypercube => {
                let (mix, count) = (Mix::new(self.settings.seed), self.settings.samples as u64);
                let dimensions = 0..self.parameters.len() as u64;
                dimensions.map(|n| latin_hypercube::coordinate(row as u64, count, mix.of(n))).collect()
            }
            DesignKind::Sobol => (0..self.parameters.len()).map(|n| self.coordinate(sample, n)).collect(),
            DesignKind::Saltelli => self.between(sample, within),
            DesignKind::Morris => self.on_trajectory(sample as u64, within),
            DesignKind::Table => Vec::new(),
        };
        if let Some(copula) = &self.copula {
            copula.correlate(&mut shares);
        }
        shares
    }

    /// The values of a row, SI.
    pub fn values(&self, row: usize) -> Vec<f64> {
        let of = |(parameter, share): (&Parameter, f64)| {
            parameter.distribution.map_or(f64::NAN, |distribution| distribution.value(share))
        };
        self.parameters.iter().zip(self.shares(row)).map(of).collect()
    }

    /// The values of each parameter by itself, in the order of the rows.
    pub fn columns(&self) -> Vec<Vec<f64>> {
        let mut columns = vec![Vec::new(); self.parameters.len()];
        columns.iter_mut().for_each(|column: &mut Vec<f64>| column.reserve_exact(self.len()));
        for from in (0..self.len()).step_by(AT_ONCE) {
            let to = self.len().min(from + AT_ONCE);
            let rows: Vec<Vec<f64>> = (from..to).into_par_iter().map(|row| self.values(row)).collect();
            for (n, column) in columns.iter_mut().enumerate() {
                column.extend(rows.iter().map(|row| row[n]));
            }
        }
        columns
    }

    /// A coordinate of a base sample's point. Replicates take turns, so that each keeps its points when there are more.
    fn coordinate(&self, sample: usize, dimension: usize) -> f64 {
        let (replicate, index) = (sample % self.settings.replicates, sample / self.settings.replicates);
        let Some(sequence) = &self.sequence else { return f64::NAN };
        match self.settings.scramble {
            false => sequence.plain(dimension, index as u64),
            true => {
                let mix = Mix::new(self.settings.seed).of(replicate as u64).of(dimension as u64);
                sequence.scrambled(dimension, index as u64, mix)
            }
        }
    }

    /// A row of a base sample in Saltelli's order: the point A; A with each group from B; with second order B with each group
    /// from A; B.
    fn between(&self, sample: usize, within: usize) -> Vec<f64> {
        let (count, groups) = (self.parameters.len(), self.settings.groups.len());
        let last = self.rows_per_sample() - 1;
        let from_b = |group: usize| match within {
            0 => false,
            _ if within == last => true,
            _ if within <= groups => group == within - 1,
            _ => group != within - 1 - groups,
        };
        let one = |n: usize| self.coordinate(sample, if from_b(self.group_of[n]) { count + n } else { n });
        (0..count).map(one).collect()
    }

    fn on_trajectory(&self, trajectory: u64, point: usize) -> Vec<f64> {
        let Settings { levels, seed, .. } = self.settings;
        let all = Trajectories { levels, group_of: &self.group_of, groups: self.settings.groups.len() };
        let mix = Mix::new(seed).of(TRAJECTORIES);
        let share = |(level, parameter): (u64, &Parameter)| {
            let place = level as f64 / (levels - 1) as f64;
            match parameter.distribution {
                Some(distribution) if !distribution.is_bounded() => {
                    MORRIS_ENDS.0 * (1.0 - place) + MORRIS_ENDS.1 * place
                }
                _ => place,
            }
        };
        all.levels(trajectory, point, mix).into_iter().zip(&self.parameters).map(share).collect()
    }
}

#[cfg(test)]
mod tests;
