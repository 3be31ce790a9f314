//! The search for fixed points on maps whose fixed points and multipliers are known in closed form.

use afmsweep::periodic::{FixedPoint, NewtonOptions, PtcNewton, PtcOutcome, SearchFailure};
use nalgebra::{DMatrix, DVector, Dyn};

const OPTIONS: NewtonOptions = NewtonOptions {
    scale: 1.0,
    tolerance: 1e-10,
    fallback_tolerance: 1e-6,
    fd_step: 1e-6,
    central_fd_step: Some(1e-6),
    jacobian_columns: None,
    max_evaluations: 500,
    start_is_close: false,
    reuse_jacobian: false,
    stable_below_fd: 0.99,
    stable_below: 0.99,
    require_stable: true,
};

/// The end of a search, and its evaluations.
fn search(
    start: &[f64],
    options: NewtonOptions,
    map: impl Fn(&DVector<f64>) -> Option<DVector<f64>>,
) -> (PtcOutcome<Dyn>, u32) {
    let mut search = PtcNewton::new(DVector::from_column_slice(start), options);
    while search.verdict().is_none() {
        let values: Vec<_> = search.ask().map(|state| map(&state)).collect();
        search.tell(&values);
    }
    (search.verdict().expect("it has ended").clone(), search.evaluations())
}

fn found(verdict: PtcOutcome<Dyn>) -> FixedPoint<Dyn> {
    match verdict {
        PtcOutcome::Converged(found) => *found,
        PtcOutcome::Failed(why) => panic!("{why:?}"),
    }
}

/// Henon, Commun. Math. Phys. 50 (1976) 69: x' = 1 - a x^2 + y, y' = b x. Fixed at
/// x = (b - 1 + sqrt((1 - b)^2 + 4a))/(2a) with multipliers -a x +- sqrt(a^2 x^2 + b).
fn henon(a: f64, b: f64) -> impl Fn(&DVector<f64>) -> Option<DVector<f64>> {
    move |s| Some(DVector::from_vec(vec![1.0 - a * s[0] * s[0] + s[1], b * s[0]]))
}

#[test]
fn henons_fixed_point_and_its_multiplier_are_found() {
    let b = 0.3;
    for a in [0.05f64, 0.2, 0.35] {
        let x = (b - 1.0 + ((1.0 - b) * (1.0 - b) + 4.0 * a).sqrt()) / (2.0 * a);
        let multiplier = a * x + (a * a * x * x + b).sqrt();
        let (verdict, spent) = search(&[0.0, 0.0], OPTIONS, henon(a, b));
        let found = found(verdict);
        assert!((found.state[0] - x).abs() < 1e-10, "{a}: {} {x}", found.state[0]);
        assert!((found.state[1] - b * x).abs() < 1e-10);
        let off = (found.spectrum.multiplier - multiplier).abs();
        assert!(off < 1e-8, "{a}: {} {multiplier}", found.spectrum.multiplier);
        // One-sided differences are off by half the second derivative, which is a, times their step.
        let (verdict, fewer) =
            search(&[0.0, 0.0], NewtonOptions { central_fd_step: None, ..OPTIONS }, henon(a, b));
        let off = (self::found(verdict).spectrum.multiplier - multiplier).abs();
        assert!(off < 2.0 * a * OPTIONS.fd_step && fewer < spent, "{a}: off by {off:e}, {fewer} of {spent}");
        println!("a = {a}: {spent} evaluations");
        assert!(spent < 100, "{spent}");
    }
}

/// Truth: as above; a map that tells its slope is asked for no differences, and its multiplier is exact.
#[test]
fn a_map_that_tells_its_slope_is_asked_for_no_differences() {
    let b = 0.3;
    for a in [0.05f64, 0.2, 0.35] {
        let x = (b - 1.0 + ((1.0 - b) * (1.0 - b) + 4.0 * a).sqrt()) / (2.0 * a);
        let multiplier = a * x + (a * a * x * x + b).sqrt();
        let options = NewtonOptions { jacobian_columns: Some(0), ..OPTIONS };
        let (map, mut search) = (henon(a, b), PtcNewton::new(DVector::from_vec(vec![0.0, 0.0]), options));
        let mut slopes = 0;
        while search.verdict().is_none() {
            let states: Vec<DVector<f64>> = search.ask().collect();
            assert_eq!(states.len(), 1, "differences were asked for");
            let value = map(&states[0]);
            if search.wants_jacobian() {
                slopes += 1;
                let slope = DMatrix::from_row_slice(2, 2, &[-2.0 * a * states[0][0], 1.0, b, 0.0]);
                search.tell_with_jacobian(value.map(|value| (value, slope)));
            } else {
                search.tell(&[value]);
            }
        }
        let (verdict, spent) = (search.verdict().expect("it has ended").clone(), search.evaluations());
        let found = found(verdict);
        println!("a = {a}: {spent} evaluations, {slopes} of them with slopes");
        assert!((found.state[0] - x).abs() < 1e-10);
        let off = (found.spectrum.multiplier - multiplier).abs();
        assert!(off < 1e-9, "{a}: {} {multiplier}", found.spectrum.multiplier);
        assert!(slopes > 0 && spent < self::search(&[0.0, 0.0], OPTIONS, henon(a, b)).1);
    }
}

/// Beyond a = 3 (1 - b)^2/4 the fixed point doubles its period.
#[test]
fn a_fixed_point_that_repels_is_called_unstable() {
    let (verdict, _) = search(&[0.6, 0.2], OPTIONS, henon(0.5, 0.3));
    assert!(matches!(verdict, PtcOutcome::Failed(SearchFailure::Unstable)), "{verdict:?}");
}

/// Of a linear map the number of evaluations does not depend on how slowly it settles.
#[test]
fn a_slow_linear_map_costs_no_more_than_a_fast_one() {
    let mut counts = Vec::new();
    for quality in [10.0, 1e3, 1e5] {
        let shrink = (-std::f64::consts::PI / quality).exp();
        let (sine, cosine) = 0.7f64.sin_cos();
        let matrix = DMatrix::from_row_slice(2, 2, &[cosine, -sine, sine, cosine]) * shrink;
        let push = DVector::from_vec(vec![0.02, 0.01]);
        let fixed = (DMatrix::identity(2, 2) - &matrix).lu().solve(&push).unwrap();
        let (verdict, spent) = search(&[0.0, 0.0], OPTIONS, |s| Some(&matrix * s + &push));
        let found = found(verdict);
        assert!((&found.state - fixed).norm() < 1e-10);
        assert!((found.spectrum.multiplier - shrink).abs() < 1e-9, "{} {shrink}", found.spectrum.multiplier);
        counts.push(spent);
    }
    println!("{counts:?} evaluations");
    assert!(counts.iter().all(|count| *count < 40), "{counts:?}");
}

#[test]
fn what_has_no_fixed_point_or_no_answer_ends_in_words() {
    // A shift.
    let (verdict, spent) = search(&[0.0], OPTIONS, |s| Some(s.add_scalar(0.01)));
    assert!(matches!(verdict, PtcOutcome::Failed(SearchFailure::OutOfEvaluations)), "{verdict:?}");
    assert!(spent <= OPTIONS.max_evaluations + 2);
    let (verdict, _) = search(&[0.0], OPTIONS, |_| None);
    assert!(matches!(verdict, PtcOutcome::Failed(SearchFailure::Undefined)), "{verdict:?}");
    // Numbers that are none.
    let (verdict, _) = search(&[0.1], OPTIONS, |s| Some(s * f64::NAN));
    assert!(matches!(verdict, PtcOutcome::Failed(_)), "{verdict:?}");
}
