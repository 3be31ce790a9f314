//! Free motion against closed forms and against the matrix exponential of the modes' equations.

use std::f64::consts::TAU;

use afmsweep::instrument::{DEFAULT_TOLERANCE, Instrument, Mode, MotionPlace};
use afmsweep::scene::{
    ActuatorModel, DriveLevel, DriveOn, InstrumentParams, LeverMode, LeverSpec, QualityFactor,
};
use nalgebra::{Matrix4, Vector4};

fn close(found: f64, exact: f64, tolerance: f64, what: &str) {
    let error = ((found - exact) / exact).abs();
    assert!(error <= tolerance, "{what}: {found:e} is not {exact:e}, off by {error:.1e} (relative)");
}

fn instrument(model: ActuatorModel, on: DriveOn, q: f64) -> Instrument {
    let mut p = InstrumentParams::default();
    p.actuator.model = model;
    p.actuator.quality_factor = q;
    p.cantilever.quality_factor = QualityFactor::All(q);
    Instrument::reduce(&p, on, DEFAULT_TOLERANCE).expect("a sound instrument")
}

/// One listed mode on a rigid base.
fn single(on: DriveOn, hz: f64, q: f64) -> Instrument {
    let mut p = InstrumentParams::default();
    p.actuator.model = ActuatorModel::Rigid;
    let mode = LeverMode { stiffness: 10.0, frequency: hz, quality_factor: q, drive: 1.0 };
    p.cantilever.lever = LeverSpec::Modes(vec![mode]);
    Instrument::reduce(&p, on, DEFAULT_TOLERANCE).expect("a sound instrument")
}

/// exp(m) by scaling, a Taylor sum, and squaring.
fn exponential(m: Matrix4<f64>) -> Matrix4<f64> {
    let halvings = (m.abs().max() * 4.0).log2().ceil().max(0.0) as i32 + 4;
    let small = m / 2f64.powi(halvings);
    let (mut sum, mut term) = (Matrix4::identity(), Matrix4::identity());
    for n in 1..16 {
        term = term * small / n as f64;
        sum += term;
    }
    for _ in 0..halvings {
        sum *= sum;
    }
    sum
}

/// Travel and speed of one mode's coordinate at the end of `t`: the equation of motion with the
/// drive's sine and cosine as further unknowns. `push` is the modal force per sine, `kick` the rate at t = 0.
/// In units of 1/omega: [q, q'/omega, sin, cos].
fn integrated(mode: &Mode, omega: f64, push: f64, kick: f64, t: f64) -> [f64; 2] {
    let r = mode.omega / omega;
    #[rustfmt::skip]
    let m = Matrix4::new(
        0.0, 1.0, 0.0, 0.0,
        -r * r, -r / mode.quality_factor, push / (omega * omega), 0.0,
        0.0, 0.0, 0.0, 1.0,
        0.0, 0.0, -1.0, 0.0,
    );
    let end = exponential(m * (omega * t)) * Vector4::new(0.0, kick / omega, 0.0, 1.0);
    [end[0], end[1] * omega]
}

#[test]
fn integrated_start_from_rest() {
    let cases = [
        (ActuatorModel::Coupled, DriveOn::Actuator, DriveLevel::Voltage(15.0)),
        (ActuatorModel::AsPrinted, DriveOn::Actuator, DriveLevel::Voltage(15.0)),
        (ActuatorModel::Prescribed, DriveOn::Actuator, DriveLevel::Voltage(15.0)),
        (ActuatorModel::Coupled, DriveOn::Tip, DriveLevel::Force(1e-9)),
        (ActuatorModel::Rigid, DriveOn::Actuator, DriveLevel::BaseAmplitude(1e-9)),
        (ActuatorModel::Rigid, DriveOn::Tip, DriveLevel::FreeAmplitude(20e-9)),
    ];
    let hz = 150e3;
    for (model, on, level) in cases {
        // Undamped, lightly, strongly, critically and more than critically damped.
        for q in [f64::INFINITY, 200.0, 3.0, 0.5, 0.500001, 0.499999, 0.2] {
            let i = instrument(model, on, q);
            let m = i.free_motion(level, hz).unwrap();
            // Two slow modes alone, so that the exponential is accurate; the others in the next test.
            let skip: Vec<bool> = (0..i.modes.len()).map(|k| k > 1).collect();
            for periods in [0.05, 0.4, 1.0, 3.3] {
                let t = periods / hz;
                let transient = m.transient_at(&i, MotionPlace::Tip, t, &skip);
                let (mut z, mut rate, mut size) = (0.0, 0.0, 0.0);
                for k in 0..2 {
                    let mode = &i.modes[k];
                    let (push, kick) = if i.moving_base {
                        (-mode.drive * m.level * m.omega * m.omega, mode.drive * m.level * m.omega)
                    } else {
                        (mode.drive * m.level, 0.0)
                    };
                    let whole = integrated(mode, m.omega, push, kick, t);
                    let steady = m.mode(k) * nalgebra::Complex::from_polar(1.0, m.omega * t);
                    z += mode.tip * (whole[0] - steady.im);
                    rate += mode.tip * (whole[1] - m.omega * steady.re);
                    size += mode.tip.abs() * (whole[0].abs() + steady.norm());
                }
                let error = (transient.0 - z).abs().max((transient.1 - rate).abs() / (10.0 * m.omega));
                assert!(
                    error < 1e-9 * size,
                    "{model:?} {on:?} Q {q}, {periods} periods: {error:e} of {size:e}"
                );
            }
        }
    }
}

#[test]
fn rest_is_rest() {
    for q in [f64::INFINITY, 100.0] {
        for (model, level) in [
            (ActuatorModel::Coupled, DriveLevel::Voltage(15.0)),
            (ActuatorModel::Prescribed, DriveLevel::Voltage(15.0)),
            (ActuatorModel::AsPrinted, DriveLevel::Voltage(15.0)),
        ] {
            let i = instrument(model, DriveOn::Actuator, q);
            let m = i.free_motion(level, 30e3).unwrap();
            for (z, rate) in [m.tip_from_rest(&i, 0.0, &[]), m.top_from_rest(&i, 0.0, &[])] {
                assert!(z.abs() < 1e-12 * m.tip.norm(), "{model:?}: travel {z:e} at the start");
                assert!(
                    rate.abs() < 1e-11 * m.tip.norm() * m.omega,
                    "{model:?}: speed {rate:e} at the start"
                );
            }
            // The drive sets in as a sine: the tip has hardly moved by a thousandth of a period.
            let (z, _) = m.tip_from_rest(&i, 1e-3 / 30e3, &[]);
            assert!(z.abs() < 1e-3 * m.tip.norm(), "{model:?}: {z:e} soon after");
        }
    }
}

/// A lever at rest above a base that sets off: W'' + w0^2 (W - Y sin wt) = 0 from W = W' = 0.
#[test]
fn closed_form_moving_base_from_rest() {
    let i = single(DriveOn::Actuator, 100e3, f64::INFINITY);
    let m = i.free_motion(DriveLevel::BaseAmplitude(2e-9), 40e3).unwrap();
    let (w, w0) = (TAU * 40e3, TAU * 100e3);
    let gain = 2e-9 * w0 * w0 / (w0 * w0 - w * w);
    for t in [0.0, 1e-7, 3e-6, 1.7e-5] {
        let (z, rate) = m.tip_from_rest(&i, t, &[]);
        let exact = gain * ((w * t).sin() - w / w0 * (w0 * t).sin());
        let exact_rate = gain * w * ((w * t).cos() - (w0 * t).cos());
        assert!((z - exact).abs() < 1e-12 * gain, "t = {t}: {z:e}, not {exact:e}");
        assert!((rate - exact_rate).abs() < 1e-12 * gain * w0, "t = {t}: rate {rate:e}, not {exact_rate:e}");
    }
}

#[test]
fn table_equals_single_evaluations() {
    for (q, hz) in [(f64::INFINITY, 30e3), (200.0, 192e3), (0.3, 192e3)] {
        let i = instrument(ActuatorModel::Coupled, DriveOn::Actuator, q);
        let m = i.free_motion(DriveLevel::Voltage(15.0), hz).unwrap();
        let skip = [false, true];
        let (first, step) = (19.5, 1.0 / hz / 97.0);
        for place in [MotionPlace::Tip, MotionPlace::Top] {
            let table = m.transient_table(&i, place, &skip, first, step, 5000);
            let largest = table.iter().fold(0.0, |a: f64, b| a.max(b[0].abs()));
            let fastest = table.iter().fold(0.0, |a: f64, b| a.max(b[1].abs()));
            assert!(largest > 0.0);
            let mut worst: f64 = 0.0;
            for (n, row) in table.iter().enumerate() {
                let (z, rate) = m.transient_at(&i, place, (first + n as f64) * step, &skip);
                worst = worst.max((row[0] - z).abs() / largest).max((row[1] - rate).abs() / fastest);
            }
            println!("Q {q}, {place:?}: table off by {worst:.1e}");
            // Both sides know their time only to rounding, and the fastest modes turn by it.
            assert!(worst < 1e-12, "Q {q}, {place:?}: {worst:e}");
            for begin in [1, 31, 32, 33, 1000] {
                let later = m.transient_table(&i, place, &skip, first + begin as f64, step, 100);
                assert!(later == table[begin..begin + 100], "Q {q}: not the same bits from {begin} on");
            }
        }
    }
}

/// Half a step before the start, which the engines' first acceleration looks at.
#[test]
fn heavily_damped_modes_have_a_table_from_before_the_start() {
    let i = instrument(ActuatorModel::Coupled, DriveOn::Actuator, 0.1);
    let m = i.free_motion(DriveLevel::Voltage(15.0), 30e3).unwrap();
    let table = m.transient_table(&i, MotionPlace::Tip, &[], -0.5, 1.0 / 30e3 / 64.0, 200);
    assert!(table.iter().flatten().all(|value| value.is_finite()), "{:?}", &table[..3]);
    assert!(table[199][0].abs() < table[1][0].abs());
}

#[test]
fn transients_die_out_to_the_steady_state() {
    let i = instrument(ActuatorModel::Coupled, DriveOn::Actuator, 50.0);
    let m = i.free_motion(DriveLevel::Voltage(15.0), 180e3).unwrap();
    let t = 200.3 / 90e3;
    let (z, rate) = m.tip_from_rest(&i, t, &[]);
    let steady = m.tip_at(t);
    assert!((z - steady.0).abs() < 1e-5 * m.tip.norm(), "{z:e} and {:e}", steady.0);
    assert!((rate - steady.1).abs() < 1e-5 * m.tip.norm() * m.omega);
    close(m.tip_at(0.0).0, m.tip.im, 1e-15, "Im Z at t = 0");
    let h = 1e-10;
    let slope = (m.top_at(t + h).0 - m.top_at(t - h).0) / (2.0 * h);
    assert!((slope - m.top_at(t).1).abs() < 1e-6 * m.top.norm() * m.omega, "speed is travel's derivative");
}

#[test]
fn free_amplitude_is_met() {
    for (model, on) in [
        (ActuatorModel::Coupled, DriveOn::Actuator),
        (ActuatorModel::Rigid, DriveOn::Actuator),
        (ActuatorModel::Coupled, DriveOn::Tip),
    ] {
        let i = instrument(model, on, 80.0);
        let m = i.free_motion(DriveLevel::FreeAmplitude(20e-9), 180e3).unwrap();
        close(m.tip.norm(), 20e-9, 1e-14, "free amplitude");
        let level = match (model, on) {
            (ActuatorModel::Rigid, _) => DriveLevel::BaseAmplitude(m.level),
            (_, DriveOn::Actuator) => DriveLevel::Voltage(m.level),
            (_, DriveOn::Tip) => DriveLevel::Force(m.level),
        };
        let again = i.free_motion(level, 180e3).unwrap();
        close(again.tip.norm(), 20e-9, 1e-14, "the level found");
        assert_eq!(again.unit_modes.len(), i.modes.len());
    }
}

#[test]
fn closed_form_resonance() {
    for q in [0.8f64, 2.0, 25.0, 400.0, 1e6] {
        let exact = 45e3 * (1.0 - 0.5 / (q * q)).sqrt();
        close(single(DriveOn::Tip, 45e3, q).resonance().unwrap(), exact, 1e-12, "force on the tip");
        // A base that moves, damping relative to it: the peak of transmission.
        let zeta: f64 = 0.5 / q;
        let square = 8.0 * zeta * zeta;
        let exact = 45e3 * (square / (1.0 + (1.0 + square).sqrt())).sqrt() / (2.0 * zeta);
        close(single(DriveOn::Actuator, 45e3, q).resonance().unwrap(), exact, 1e-12, "moving base");
    }
}

#[test]
fn resonance_is_a_peak_of_the_whole_response_near_the_lever() {
    for (model, on) in [
        (ActuatorModel::Coupled, DriveOn::Actuator),
        (ActuatorModel::Coupled, DriveOn::Tip),
        (ActuatorModel::Prescribed, DriveOn::Actuator),
        (ActuatorModel::Rigid, DriveOn::Actuator),
    ] {
        for q in [20.0, 200.0, 1e4] {
            let mut p = InstrumentParams::default();
            p.actuator.model = model;
            // An undamped rod: its peaks are infinite, but farther away.
            p.cantilever.quality_factor = QualityFactor::All(q);
            let i = Instrument::reduce(&p, on, DEFAULT_TOLERANCE).unwrap();
            let peak = i.resonance().unwrap();
            assert!((peak / i.lever_frequency - 1.0).abs() < 1.0 / q, "{model:?} {on:?} Q {q}: {peak}");
            let tip = |hz: f64| i.free_motion(DriveLevel::FreeAmplitude(1.0), hz).unwrap().level.recip();
            // Equally high on both sides: the top lies between to far better than the offset.
            let offset = 0.1 / q;
            let (left, here, right) = (tip(peak * (1.0 - offset)), tip(peak), tip(peak * (1.0 + offset)));
            assert!(left < here && right < here, "{model:?} {on:?} Q {q}: {left:e} {here:e} {right:e}");
            let near = 1e-3 / q;
            let slope = (tip(peak * (1.0 + near)) - tip(peak * (1.0 - near))) / here / (2.0 * near);
            assert!(slope.abs() < 1e-4 * q, "{model:?} {on:?} Q {q}: slope {slope:e} at the peak");
        }
    }
}

/// A rigid base sets off at once; the elements cannot keep a whole lever at rest above it, as their
/// travel vanishes at the base, but the tip, a lever's length away, hardly notices.
#[test]
fn moving_base_leaves_the_tip_at_rest() {
    let i = instrument(ActuatorModel::Rigid, DriveOn::Actuator, f64::INFINITY);
    let m = i.free_motion(DriveLevel::BaseAmplitude(1e-9), 30e3).unwrap();
    let (z, rate) = m.tip_from_rest(&i, 0.0, &[]);
    println!("tip starts at {:.1e} of the base's rate", rate / (1e-9 * m.omega));
    assert!(z.abs() < 1e-12 * m.tip.norm(), "{z:e}");
    assert!(rate.abs() < 0.01 * 1e-9 * m.omega, "{rate:e}");
}
