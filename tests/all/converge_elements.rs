//! How fast the elements converge, and that the mesh chosen meets what was asked.

use std::f64::consts::PI;

use crate::continuum::Continuum;
use afmsweep::instrument::{Instrument, Mesh};
use afmsweep::scene::{ActuatorModel, DriveOn, InstrumentParams, TipMass};

/// Slope of log(error) over log(elements), between each mesh and the next.
fn orders(errors: &[(usize, f64)]) -> Vec<f64> {
    errors.windows(2).map(|w| (w[0].1 / w[1].1).ln() / (w[1].0 as f64 / w[0].0 as f64).ln()).collect()
}

fn omega(p: &InstrumentParams, elements: usize, order: usize, k: usize) -> f64 {
    let mesh = Mesh { rod_elements: elements, beam_elements: elements, order };
    Instrument::on_mesh(p, DriveOn::Actuator, mesh).unwrap().modes[k].omega
}

/// The second mode of a rod alone: eigenvalues converge with twice the degree.
#[test]
fn closed_form_rod_converges_with_order_2p() {
    let mut p = InstrumentParams::default();
    p.actuator.model = ActuatorModel::Prescribed;
    p.actuator.h33 = 0.0;
    // So short a lever that its modes lie far above the rod's.
    if let afmsweep::scene::LeverSpec::Dimensions { length, .. } = &mut p.cantilever.lever {
        *length = 20e-6;
    }
    p.tip.mass = TipMass::Given(0.0);
    let a = &p.actuator;
    let exact = 1.5 * PI * (a.youngs_modulus / a.density).sqrt() / a.length;
    for (order, meshes) in [(1, [8, 16, 32]), (2, [4, 8, 16]), (3, [3, 6, 12]), (4, [2, 4, 8])] {
        let errors = meshes.map(|n| (n, (omega(&p, n, order, 1) / exact).powi(2) - 1.0));
        assert!(errors.iter().all(|e| e.1 > 0.0), "order {order}: frequencies come from above: {errors:?}");
        for found in orders(&errors) {
            assert!(
                (found - 2.0 * order as f64).abs() < 0.35,
                "bar, degree {order}: order {found}, {errors:?}"
            );
        }
    }
}

/// The third clamped-free mode: eigenvalues converge with twice (degree - 1).
#[test]
fn closed_form_beam_converges_with_order_2p_minus_2() {
    let mut p = InstrumentParams::default();
    p.actuator.model = ActuatorModel::Rigid;
    p.tip.mass = TipMass::Given(0.0);
    p.tip.half_length = 0.0;
    let lambda: f64 = 7.854757438237613;
    let rigidity = 7.03e10 * 6.9e-6f64.powi(2) / 12.0 / 2500.0;
    let exact = (lambda / 174e-6).powi(2) * rigidity.sqrt();
    for (order, meshes) in [(3, [4, 8, 16]), (4, [4, 8, 16]), (5, [2, 4, 8]), (6, [2, 4, 8])] {
        let errors = meshes.map(|n| (n, (omega(&p, n, order, 2) / exact).powi(2) - 1.0));
        assert!(errors.iter().all(|e| e.1 > 0.0), "degree {order}: frequencies come from above: {errors:?}");
        for found in orders(&errors).into_iter().skip(1) {
            let expected = 2.0 * (order as f64 - 1.0);
            assert!((found - expected).abs() < 0.5, "beam, degree {order}: order {found}, {errors:?}");
        }
    }
}

/// Every mode called resolved meets the tolerance asked for, judged by a much finer mesh.
#[test]
fn finer_mesh_confirms_the_resolved_modes() {
    for model in [ActuatorModel::Coupled, ActuatorModel::Prescribed, ActuatorModel::Rigid] {
        for tolerance in [1e-3, 1e-6, 1e-8, 1e-10] {
            let mut p = InstrumentParams::default();
            p.actuator.model = model;
            let i = Instrument::reduce(&p, DriveOn::Actuator, tolerance).unwrap();
            let mesh = Mesh { rod_elements: 6, beam_elements: 4, order: 16 };
            let fine = Instrument::on_mesh(&p, DriveOn::Actuator, mesh).unwrap();
            assert!(i.resolved >= 8, "{model:?}: {} modes resolved", i.resolved);
            for k in 0..i.resolved {
                let error = (i.modes[k].omega / fine.modes[k].omega - 1.0).abs();
                assert!(error <= tolerance, "{model:?}, {tolerance:e}: mode {} is off by {error:.1e}", k + 1);
            }
        }
    }
}

/// The same for rods and levers of many dimensions: what two degrees fewer would give is read off the shapes, not computed.
#[test]
fn finer_meshes_confirm_instruments_of_many_dimensions() {
    let mut state = 1u64;
    let mut draw = |least: f64, most: f64| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        least * (most / least).powf((state >> 11) as f64 / (1u64 << 53) as f64)
    };
    let models =
        [ActuatorModel::Coupled, ActuatorModel::Prescribed, ActuatorModel::AsPrinted, ActuatorModel::Rigid];
    let mut worst: f64 = 0.0;
    for case in 0..48 {
        let mut p = InstrumentParams::default();
        p.actuator.model = models[case % models.len()];
        p.actuator.length = draw(0.5e-3, 8e-3);
        p.actuator.width = draw(5e-5, 1e-3);
        if let afmsweep::scene::LeverSpec::Dimensions { length, thickness, .. } = &mut p.cantilever.lever {
            (*length, *thickness) = (draw(60e-6, 300e-6), draw(1e-6, 8e-6));
        }
        p.tip.half_length = draw(1e-6, 1e-5);
        let i = Instrument::reduce(&p, DriveOn::Actuator, 1e-8).unwrap();
        let mesh = Mesh { rod_elements: 6, beam_elements: 4, order: 16 };
        let fine = Instrument::on_mesh(&p, DriveOn::Actuator, mesh).unwrap();
        assert!(i.resolved >= 8, "case {case}: {} modes resolved", i.resolved);
        for k in 0..i.resolved.min(30) {
            let error = (i.modes[k].omega / fine.modes[k].omega - 1.0).abs();
            assert!(error <= 1e-8, "case {case}: mode {} of {} is off by {error:.1e}", k + 1, i.resolved);
            worst = worst.max(error);
        }
    }
    println!("48 instruments, largest error of a resolved mode {worst:.1e}");
}

/// A tighter tolerance asks for a higher degree, and never resolves fewer modes of the band.
#[test]
fn tolerance_steers_the_degree() {
    let p = InstrumentParams::default();
    let order = |tolerance| Instrument::reduce(&p, DriveOn::Actuator, tolerance).unwrap().order;
    assert!(order(1e-2) < order(1e-11), "{} and {}", order(1e-2), order(1e-11));
}

/// Elements joined in a chain tell the same as one: the joints add nothing.
#[test]
fn continuum_frequencies_on_many_low_elements() {
    let p = InstrumentParams::default();
    let exact = Continuum::new(&p).frequencies(5);
    let mesh = Mesh { rod_elements: 12, beam_elements: 6, order: 7 };
    let i = Instrument::on_mesh(&p, DriveOn::Actuator, mesh).unwrap();
    for (mode, exact) in i.modes.iter().zip(exact) {
        let error = (mode.omega / std::f64::consts::TAU / exact - 1.0).abs();
        assert!(error < 1e-10, "{exact} Hz is off by {error:.1e}");
    }
}
