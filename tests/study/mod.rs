//! Results files whose observables are functions with known answers, at the points of a design.

use afmsweep::design::{Design, DesignDescription, DesignKind, Distribution, Parameter, Settings};
use afmsweep::stats::Study;
use afmsweep::store::{Attribute, Coordinate, Results, Variable};
use std::sync::Arc;

/// A design of so many base samples over the same distribution of each parameter.
pub fn settings(kind: DesignKind, samples: usize, parameters: usize) -> Settings {
    Settings {
        kind,
        samples,
        replicates: if matches!(kind, DesignKind::Sobol | DesignKind::Saltelli) { 16 } else { 1 },
        seed: 1,
        scramble: true,
        second_order: false,
        levels: 4,
        groups: (0..parameters).map(|n| vec![n]).collect(),
        correlation: Vec::new(),
    }
}

/// The design, and the file of a run whose observable `amplitude` is this function of the parameters.
pub fn results(
    settings: Settings,
    distributions: &[Distribution],
    function: impl Fn(&[f64]) -> f64,
) -> Results {
    let parameter = |(n, distribution): (usize, &Distribution)| Parameter {
        path: format!("x.{n}"),
        name: format!("x_{n}"),
        units: "1".into(),
        distribution: Some(*distribution),
    };
    let parameters = distributions.iter().enumerate().map(parameter).collect();
    let design = Design::new(settings, parameters).unwrap();
    let rows: Vec<Vec<f64>> = (0..design.len()).map(|row| design.values(row)).collect();
    let column = |(n, one): (usize, &Parameter)| Coordinate {
        name: one.name.clone(),
        units: one.units.clone(),
        long_name: one.name.clone(),
        scene_path: one.path.clone(),
        values: Arc::new(rows.iter().map(|row| row[n]).collect()),
        ..Coordinate::default()
    };
    let samples = Coordinate {
        name: "sample".into(),
        units: "1".into(),
        long_name: "sample".into(),
        scene_path: "samples".into(),
        values: Arc::new((0..rows.len()).map(|row| row as f64).collect()),
        columns: design.parameters.iter().enumerate().map(column).collect(),
        ..Coordinate::default()
    };
    let ends = vec![(0.0, 1.0); distributions.len()];
    let told = serde_json::to_string(&DesignDescription::new(&design, &ends)).unwrap();
    Results {
        title: "made up".into(),
        axes: vec![samples],
        variables: vec![Variable {
            name: "amplitude".into(),
            units: "m".into(),
            long_name: "made up".into(),
            data: rows.iter().map(|row| function(row)).collect(),
            ..Variable::default()
        }],
        status: vec![0; rows.len()],
        steps_per_period: vec![1; rows.len()],
        attributes: vec![("design".into(), Attribute::Text(told))],
        ..Results::default()
    }
}

/// The study of such a file.
pub fn study(settings: Settings, distributions: &[Distribution], function: impl Fn(&[f64]) -> f64) -> Study {
    Study::of(&results(settings, distributions, function)).unwrap()
}

/// Uniform from one end to the other.
pub fn uniform(parameters: usize, from: f64, to: f64) -> Vec<Distribution> {
    vec![Distribution::Uniform { from, to }; parameters]
}

/// T. Ishigami and T. Homma (ISUMA 1990) with a = 7, b = 0.1, in nanometres: SI sizes are small.
pub fn ishigami(x: &[f64]) -> f64 {
    1e-9 * (x[0].sin() + 7.0 * x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin())
}

/// Its first and total indices.
pub fn ishigami_indices() -> ([f64; 3], [f64; 3]) {
    use std::f64::consts::PI;
    let (a, b) = (7.0, 0.1);
    let first = [0.5 * (1.0 + b * PI.powi(4) / 5.0f64).powi(2), a * a / 8.0, 0.0];
    let pair = b * b * PI.powi(8) * (1.0 / 18.0 - 1.0 / 50.0);
    let all = first.iter().sum::<f64>() + pair;
    let total = [first[0] + pair, first[1], pair];
    (first.map(|v| v / all), total.map(|v| v / all))
}

/// Sobol's g-function (A. Saltelli and I. M. Sobol', 1995) with these coefficients.
pub const G: [f64; 6] = [0.0, 1.0, 4.5, 9.0, 99.0, 99.0];

pub fn g_function(x: &[f64]) -> f64 {
    1e-18 * x.iter().zip(G).map(|(x, a)| ((4.0 * x - 2.0).abs() + a) / (1.0 + a)).product::<f64>()
}

/// Its first and total indices.
pub fn g_indices() -> ([f64; 6], [f64; 6]) {
    let own = G.map(|a| 1.0 / (3.0 * (1.0 + a) * (1.0 + a)));
    let product: f64 = own.iter().map(|v| 1.0 + v).product();
    let all = product - 1.0;
    (own.map(|v| v / all), own.map(|v| v * product / (1.0 + v) / all))
}
