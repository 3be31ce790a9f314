//! A design as its results file tells of it.

use super::{Design, DesignKind, Distribution, Settings};
use serde::{Deserialize, Serialize};

/// What is written of a design, as JSON; the points themselves are variables of the file.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DesignDescription {
    pub kind: DesignKind,
    pub samples: usize,
    /// Instances for each point of the sweep beside it.
    pub rows: usize,
    pub replicates: usize,
    pub seed: u64,
    pub scramble: bool,
    pub second_order: bool,
    pub levels: u64,
    pub distributions: Vec<DesignRecord>,
    /// Names of parameters that move together; every parameter is in one.
    pub groups: Vec<Vec<String>>,
    /// Rank correlations.
    pub correlation: Vec<(String, String, f64)>,
    /// The same for SALib.
    pub problem: Problem,
}

/// An uncertain quantity, SI.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DesignRecord {
    pub path: String,
    pub name: String,
    pub units: String,
    #[serde(flatten)]
    pub distribution: Option<Distribution>,
}

/// What SALib calls a problem.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Problem {
    pub num_vars: usize,
    pub names: Vec<String>,
    pub bounds: Vec<Vec<f64>>,
    pub dists: Vec<String>,
    /// Of each parameter, the name of its group; none where each moves alone.
    pub groups: Option<Vec<String>>,
}

impl DesignDescription {
    /// `ends`: the least and largest value of each parameter in the file, which tables have in place of a distribution.
    pub fn new(design: &Design, ends: &[(f64, f64)]) -> Self {
        let Settings { kind, samples, replicates, seed, scramble, second_order, levels, .. } =
            design.settings.clone();
        let names: Vec<String> = design.parameters.iter().map(|one| one.name.clone()).collect();
        let groups: Vec<Vec<String>> = design
            .settings
            .groups
            .iter()
            .map(|members| members.iter().map(|member| names[*member].clone()).collect())
            .collect();
        let named = |&(a, b, rank): &(usize, usize, f64)| (names[a].clone(), names[b].clone(), rank);
        let told = design.parameters.iter().map(|one| DesignRecord {
            path: one.path.clone(),
            name: one.name.clone(),
            units: one.units.clone(),
            distribution: one.distribution,
        });
        let bounds = design.parameters.iter().zip(ends).map(|(one, ends)| match one.distribution {
            Some(distribution) => distribution.salib(),
            None => ("unif", vec![ends.0, ends.1]),
        });
        let (dists, bounds): (Vec<&str>, Vec<Vec<f64>>) = bounds.unzip();
        let group_of = |name: &String| {
            groups.iter().find(|group| group.contains(name)).map_or_else(String::new, |group| called(group))
        };
        let problem = Problem {
            num_vars: names.len(),
            bounds,
            dists: dists.into_iter().map(str::to_owned).collect(),
            groups: (groups.len() < names.len()).then(|| names.iter().map(group_of).collect()),
            names: names.clone(),
        };
        Self {
            kind,
            samples,
            rows: design.len(),
            replicates,
            seed,
            scramble,
            second_order,
            levels,
            distributions: told.collect(),
            correlation: design.settings.correlation.iter().map(named).collect(),
            groups,
            problem,
        }
    }

    /// Names of the groups: what indices are of.
    pub fn group_names(&self) -> Vec<String> {
        self.groups.iter().map(|group| called(group)).collect()
    }

    /// Rows that belong to one base sample.
    pub fn rows_per_sample(&self) -> usize {
        self.rows.checked_div(self.samples).unwrap_or(1)
    }
}

/// The name of a group.
fn called(members: &[String]) -> String {
    members.join("+")
}
