//! Calibrated levers against closed forms.

use crate::continuum::{clamped_free, close, hertz};
use afmsweep::instrument::{DEFAULT_TOLERANCE, Instrument};
use afmsweep::scene::{ActuatorModel, DriveOn, InstrumentParams, LeverSpec, TipMass};
use std::f64::consts::{PI, TAU};

fn rigid(lever: LeverSpec, tip: f64) -> InstrumentParams {
    let mut p = InstrumentParams::default();
    p.actuator.model = ActuatorModel::Rigid;
    p.cantilever.lever = lever;
    p.tip.mass = TipMass::Given(tip);
    p
}

/// Truth: the calibration itself, and the beam with a point mass at its end: in b = k l,
/// 1 + cos b cosh b + mu b (cos b sinh b - sin b cosh b) = 0, mu the tip's mass in beam masses.
#[test]
fn closed_form_calibrated_lever_with_a_tip_mass() {
    let (stiffness, frequency) = (0.4, 70e3);
    let moving = stiffness / (TAU * frequency).powi(2);
    for share in [0.01, 0.2, 0.7, 0.95] {
        let p = rigid(LeverSpec::Calibrated { stiffness, frequency }, share * moving);
        let lever = Instrument::reduce(&p, DriveOn::Tip, DEFAULT_TOLERANCE).expect("a sound instrument");
        let first = &lever.modes[0];
        close(hertz(first), frequency, 1e-9, "first frequency");
        close(first.omega.powi(2) / first.tip.powi(2), stiffness, 1e-9, "first stiffness");
        // mu from the first frequency's own root: the share of the tip in the first mode is 1/(1 + rest/mu).
        let equation =
            |b: f64, mu: f64| 1.0 + b.cos() * b.cosh() + mu * b * (b.cos() * b.sinh() - b.sin() * b.cosh());
        let root = |k: usize, mu: f64| {
            // Between the roots of the free and of the pinned end.
            let (mut low, mut high) = (((k as f64) - 0.75) * PI, clamped_free(k));
            low = low.max(1e-3);
            for _ in 0..200 {
                let middle = 0.5 * (low + high);
                let same = equation(middle, mu) * equation(high, mu) > 0.0;
                if same { high = middle } else { low = middle }
            }
            0.5 * (low + high)
        };
        let ratios = |mu: f64| {
            let first = root(0, mu);
            [1, 2, 3].map(|k| (root(k, mu) / first).powi(2))
        };
        // The one mu that gives the second frequency has to give the third and fourth, too.
        let found = [1, 2, 3].map(|k| hertz(&lever.modes[k]) / frequency);
        let (mut low, mut high): (f64, f64) = (1e-6, 1e3);
        for _ in 0..200 {
            let middle = (low * high).sqrt();
            if ratios(middle)[0] < found[0] { low = middle } else { high = middle }
        }
        let expected = ratios((low * high).sqrt());
        close(found[1], expected[1], 1e-7, "third over first");
        close(found[2], expected[2], 1e-7, "fourth over first");
    }
    let p = rigid(LeverSpec::Calibrated { stiffness, frequency }, 1.01 * moving);
    let error = Instrument::reduce(&p, DriveOn::Tip, DEFAULT_TOLERANCE).expect_err("more than all");
    assert!(error.to_string().contains("the tip's mass"), "{error}");
}
