//! Point sets against their definitions, and against SciPy.

use super::*;

const SCIPY_5: [f64; 7] = [0.875, 0.875, 0.125, 0.375, 0.875, 0.625, 0.875];
const SCIPY_1000: [f64; 7] =
    [0.2197265625, 0.0966796875, 0.5185546875, 0.6767578125, 0.2802734375, 0.9072265625, 0.0458984375];
const SOBOL_DISCREPANCY: f64 = 2.2e-4;

fn parameter(n: usize, distribution: Distribution) -> Parameter {
    Parameter {
        path: format!("p.{n}"),
        name: format!("p{n}"),
        units: "1".into(),
        distribution: Some(distribution),
    }
}

const UNIT: Distribution = Distribution::Uniform { from: 0.0, to: 1.0 };

fn settings(kind: DesignKind, samples: usize, parameters: usize) -> Settings {
    Settings {
        kind,
        samples,
        replicates: 1,
        seed: 1,
        scramble: true,
        second_order: false,
        levels: 4,
        groups: (0..parameters).map(|n| vec![n]).collect(),
        correlation: Vec::new(),
    }
}

fn design(settings: Settings, parameters: usize) -> Design {
    let parameters = (0..parameters).map(|n| parameter(n, UNIT)).collect();
    Design::new(settings, parameters).expect("no correlations that contradict each other")
}

/// SciPy 1.17, `qmc.Sobol(7, scramble=False)`: points 1, 5 and 1000 of `random(1024)`.
#[test]
fn unscrambled_points_are_those_of_scipy() {
    let plain = design(Settings { scramble: false, ..settings(DesignKind::Sobol, 1024, 7) }, 7);
    assert_eq!(plain.shares(0), [0.0; 7]);
    assert_eq!(plain.shares(1), [0.5; 7]);
    assert_eq!(plain.shares(5), SCIPY_5);
    assert_eq!(plain.shares(1000), SCIPY_1000);
}

/// Every elementary interval of area 2^-10 in each pair of neighbouring dimensions holds one of 1024 points where
/// their quality parameter is 0: dimensions 1 and 2 of the sequence.
#[test]
fn scrambled_points_keep_their_balance() {
    let scrambled = design(settings(DesignKind::Sobol, 1024, 4), 4);
    let points: Vec<Vec<f64>> = (0..1024).map(|row| scrambled.shares(row)).collect();
    for split in 0..=10 {
        let mut seen = vec![false; 1024];
        for point in &points {
            let cell = |share: f64, bits: u32| (share * f64::from(1u32 << bits)) as usize;
            let at = (cell(point[0], split) << (10 - split)) + cell(point[1], 10 - split);
            assert!(!std::mem::replace(&mut seen[at], true), "split {split}");
        }
    }
    // And they are no longer the plain ones.
    assert!(points.iter().flatten().all(|share| *share > 0.0 && *share < 1.0));
    assert_ne!(points[1], [0.5; 4]);
}

/// Centred L2-discrepancy (F. J. Hickernell, Math. Comp. 67, 299 (1998), equation 5.1c).
fn discrepancy(points: &[Vec<f64>]) -> f64 {
    let (n, d) = (points.len() as f64, points[0].len() as i32);
    let off = |x: f64| (x - 0.5).abs();
    let one: f64 = points
        .iter()
        .map(|x| x.iter().map(|x| 1.0 + 0.5 * off(*x) - 0.5 * off(*x).powi(2)).product::<f64>())
        .sum();
    let two: f64 = points
        .iter()
        .flat_map(|x| points.iter().map(move |y| (x, y)))
        .map(|(x, y)| {
            let pairs = x.iter().zip(y);
            pairs.map(|(x, y)| 1.0 + 0.5 * off(*x) + 0.5 * off(*y) - 0.5 * (x - y).abs()).product::<f64>()
        })
        .sum();
    (13.0f64 / 12.0).powi(d) - 2.0 / n * one + two / (n * n)
}

/// SciPy 1.17: 512 points in 6 dimensions have 1.7e-4 to 1.8e-4 under its own scrambles of Sobol points (20 seeds), and
/// 2.6e-3 to 7.3e-3 at random.
#[test]
fn scrambled_points_have_a_low_discrepancy() {
    for seed in 1..=10 {
        let points = |kind: DesignKind| {
            let drawn = design(Settings { seed, ..settings(kind, 512, 6) }, 6);
            (0..512).map(|row| drawn.shares(row)).collect::<Vec<_>>()
        };
        let (sobol, random) =
            (discrepancy(&points(DesignKind::Sobol)), discrepancy(&points(DesignKind::MonteCarlo)));
        assert!(sobol < SOBOL_DISCREPANCY, "seed {seed}: {sobol:e}");
        assert!(random > 10.0 * sobol, "seed {seed}: {random:e}");
    }
}

#[test]
fn a_design_that_is_doubled_keeps_its_points() {
    for kind in [
        DesignKind::MonteCarlo,
        DesignKind::LatinHypercube,
        DesignKind::Sobol,
        DesignKind::Saltelli,
        DesignKind::Morris,
    ] {
        let replicates = if matches!(kind, DesignKind::Sobol | DesignKind::Saltelli) { 4 } else { 1 };
        let once = design(Settings { replicates, ..settings(kind, 96, 3) }, 3);
        let twice = design(Settings { replicates, ..settings(kind, 192, 3) }, 3);
        for row in 0..once.len() {
            assert_eq!(once.shares(row), twice.shares(row), "{kind:?} {row}");
        }
        let other = design(Settings { replicates, seed: 2, ..settings(kind, 96, 3) }, 3);
        assert!((0..once.len()).any(|row| once.shares(row) != other.shares(row)), "{kind:?}");
    }
}

/// As many dimensions as any scene may ask for.
#[test]
fn the_largest_design_has_its_points() {
    let drawn = design(settings(DesignKind::Saltelli, 2, MOST_PARAMETERS), MOST_PARAMETERS);
    assert!(drawn.shares(drawn.len() - 1).iter().all(|share| *share > 0.0 && *share < 1.0));
}

#[test]
fn rows_between_two_points_are_in_order() {
    let second = Settings { second_order: true, ..settings(DesignKind::Saltelli, 8, 3) };
    let grouped = Settings { groups: vec![vec![0, 2], vec![1]], ..second };
    let drawn = design(grouped, 3);
    assert_eq!((drawn.rows_per_sample(), drawn.len()), (6, 48));
    for sample in 0..8 {
        let row = |within: usize| drawn.shares(6 * sample + within);
        let (a, b) = (row(0), row(5));
        assert_eq!(row(1), [b[0], a[1], b[2]]);
        assert_eq!(row(2), [a[0], b[1], a[2]]);
        assert_eq!(row(3), [a[0], b[1], a[2]]);
        assert_eq!(row(4), [b[0], a[1], b[2]]);
    }
}

/// Spearman's correlation of 20,000 pairs has a standard error of at most 0.0071.
#[test]
fn rank_correlation_is_recovered() {
    const COUNT: usize = 20_000;
    for kind in [DesignKind::MonteCarlo, DesignKind::LatinHypercube, DesignKind::Sobol] {
        for wanted in [-0.9, -0.3, 0.5, 0.95] {
            let correlation = vec![(2, 0, wanted)];
            let drawn = design(Settings { correlation, ..settings(kind, COUNT, 3) }, 3);
            let rows: Vec<Vec<f64>> = (0..COUNT).map(|row| drawn.shares(row)).collect();
            let found = spearman(&rows, 0, 2);
            assert!((found - wanted).abs() < 3.0 * 0.0071, "{kind:?} {wanted}: {found}");
            assert!(spearman(&rows, 0, 1).abs() < 3.0 * 0.0071, "{kind:?}");
        }
    }
    assert!(Copula::new(3, &[(0, 1, 0.9), (1, 2, 0.9), (0, 2, -0.9)]).is_none());
}

fn spearman(rows: &[Vec<f64>], a: usize, b: usize) -> f64 {
    let ranks = |n: usize| {
        let mut order: Vec<usize> = (0..rows.len()).collect();
        order.sort_by(|i, j| rows[*i][n].total_cmp(&rows[*j][n]));
        let mut ranks = vec![0.0; rows.len()];
        order.iter().enumerate().for_each(|(rank, row)| ranks[*row] = rank as f64);
        ranks
    };
    let (a, b, n) = (ranks(a), ranks(b), rows.len() as f64);
    let apart: f64 = a.iter().zip(&b).map(|(a, b)| (a - b).powi(2)).sum();
    1.0 - 6.0 * apart / (n * (n * n - 1.0))
}

#[test]
fn trajectories_stand_on_the_ends_of_what_has_ends() {
    let normal = Distribution::Normal { mean: 0.0, sd: 1.0, from: None, to: None };
    let parameters = vec![parameter(0, UNIT), parameter(1, normal)];
    let drawn = Design::new(settings(DesignKind::Morris, 50, 2), parameters).expect("no correlation");
    let values: Vec<Vec<f64>> = (0..drawn.len()).map(|row| drawn.values(row)).collect();
    let least = |n: usize| values.iter().map(|row| row[n]).fold(f64::INFINITY, f64::min);
    assert_eq!(least(0), 0.0);
    // The quantile of 0.005.
    assert!((least(1) + 2.575_829_303_548_9).abs() < 1e-12);
}

#[test]
fn a_design_survives_its_description() {
    let cut = Distribution::Normal { mean: 40.0, sd: 4.0, from: Some(1.0), to: None };
    let parameters = vec![parameter(0, UNIT), parameter(1, cut)];
    let told = Settings { correlation: vec![(0, 1, 0.5)], ..settings(DesignKind::Sobol, 64, 2) };
    let drawn = Design::new(told, parameters).expect("a correlation of one pair");
    let described = DesignDescription::new(&drawn, &[(0.0, 1.0), (30.0, 50.0)]);
    let text = serde_json::to_string(&described).expect("plain data");
    assert_eq!(serde_json::from_str::<DesignDescription>(&text).expect("as written"), described);
    assert!(text.contains(r#""distribution":"normal","mean":40.0,"sd":4.0,"from":1.0"#), "{text}");
}
