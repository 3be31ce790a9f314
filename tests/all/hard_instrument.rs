//! Inputs at and beyond the edge: a typed error that carries its numbers, or a sane answer; never a panic.

use afmsweep::instrument::{DEFAULT_TOLERANCE, Instrument, InstrumentError as Error, Mesh};
use afmsweep::scene::{
    ActuatorModel, DriveLevel, DriveOn, InstrumentParams, LeverMode, LeverSpec, QualityFactor, TipMass,
};

/// Failures print the error, not hundreds of modes.
fn short<T>(result: &Result<T, Error>) -> Result<(), &Error> {
    result.as_ref().map(|_| ())
}

fn reduce(change: impl Fn(&mut InstrumentParams)) -> Result<Instrument, Error> {
    let mut p = InstrumentParams::default();
    change(&mut p);
    Instrument::reduce(&p, DriveOn::Actuator, DEFAULT_TOLERANCE)
}

fn calibrated(p: &mut InstrumentParams, frequency: f64) {
    p.cantilever.lever = LeverSpec::Calibrated { stiffness: 40.0, frequency };
}

#[test]
fn unstable_rod_is_refused_with_both_moduli() {
    // h33^2/beta33 passes E_p at h33 = 1.3156e9 V/m.
    assert!(reduce(|p| p.actuator.h33 = 1.315e9).is_ok());
    match reduce(|p| p.actuator.h33 = 1.316e9) {
        Err(Error::UnstableRod { youngs_modulus, softening }) => {
            assert!(youngs_modulus == 2.216e10 && softening > youngs_modulus && softening < 2.22e10);
        }
        other => panic!("{:?}", short(&other)),
    }
    assert!(reduce(|p| (p.actuator.h33, p.actuator.model) = (1.316e9, ActuatorModel::Rigid)).is_ok());
}

#[test]
fn impossible_values_are_named() {
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let cases: [(&str, Result<Instrument, Error>); 6] = [
            ("the rod's length", reduce(|p| p.actuator.length = value)),
            ("the rod's beta33", reduce(|p| p.actuator.beta33 = value)),
            ("the lever's thickness", {
                reduce(|p| {
                    if let LeverSpec::Dimensions { thickness, .. } = &mut p.cantilever.lever {
                        *thickness = value;
                    }
                })
            }),
            ("the lever's frequency", reduce(|p| calibrated(p, value))),
            ("the tip's width", {
                reduce(|p| p.tip.mass = TipMass::Pyramid { width: value, height: 1e-5, density: 2500.0 })
            }),
            ("a lever mode's stiffness", {
                reduce(|p| {
                    let mode =
                        LeverMode { stiffness: value, frequency: 1e5, quality_factor: 10.0, drive: 1.0 };
                    p.cantilever.lever = LeverSpec::Modes(vec![mode]);
                })
            }),
        ];
        for (name, result) in cases {
            assert!(
                matches!(result, Err(Error::BadValue { what, .. }) if what == name),
                "{name}: {result:?}"
            );
        }
    }
    for value in [0.0, -3.0, f64::NAN] {
        for result in [
            reduce(|p| p.actuator.quality_factor = value),
            reduce(|p| p.cantilever.quality_factor = QualityFactor::PerMode(vec![100.0, value])),
        ] {
            assert!(matches!(result, Err(Error::BadValue { .. })), "Q = {value}: {:?}", short(&result));
        }
    }
    assert_eq!(
        reduce(|p| p.cantilever.quality_factor = QualityFactor::PerMode(vec![])),
        Err(Error::NoQualityFactors)
    );
    assert_eq!(reduce(|p| p.cantilever.lever = LeverSpec::Modes(vec![])), Err(Error::NoModes));
    for tolerance in [0.0, -1e-8, 1.0, f64::NAN] {
        let result = Instrument::reduce(&InstrumentParams::default(), DriveOn::Tip, tolerance);
        assert!(matches!(result, Err(Error::BadValue { .. })), "tolerance {tolerance}: {:?}", short(&result));
    }
    let mesh = Mesh { rod_elements: 0, beam_elements: 1, order: 4 };
    assert!(Instrument::on_mesh(&InstrumentParams::default(), DriveOn::Tip, mesh).is_err());
}

/// Sizes from the absurdly small to the absurdly large: an answer or an error, and finite numbers.
#[test]
fn extreme_sizes_neither_panic_nor_give_nan() {
    let mut answered = 0;
    for exponent in (-320..=300).step_by(20) {
        let size = 10f64.powi(exponent);
        let changes: [&dyn Fn(&mut InstrumentParams); 8] = [
            &|p| p.actuator.length = size,
            &|p| p.actuator.density = size,
            &|p| (p.actuator.width, p.actuator.thickness) = (size, size),
            &|p| p.actuator.h33 = size,
            &|p| p.tip.mass = TipMass::Given(size),
            &|p| p.tip.half_length = size,
            &|p| p.cantilever.lever = LeverSpec::Calibrated { stiffness: size, frequency: 1e5 },
            &|p| calibrated(p, size),
        ];
        for model in [
            ActuatorModel::Coupled,
            ActuatorModel::Prescribed,
            ActuatorModel::Rigid,
            ActuatorModel::AsPrinted,
        ] {
            for (n, change) in changes.iter().enumerate() {
                let result = reduce(|p| {
                    change(p);
                    p.actuator.model = model;
                });
                if let Ok(i) = result {
                    answered += 1;
                    for m in &i.modes {
                        let numbers = [m.omega, m.tip, m.force, m.drive, m.top];
                        assert!(
                            numbers.iter().all(|v| v.is_finite()),
                            "{model:?}, case {n}, {size:e}: {m:?}"
                        );
                    }
                    let _ = i.resonance();
                    let _ = i.free_motion(DriveLevel::FreeAmplitude(1e-9), 3e4);
                }
            }
        }
    }
    assert!(answered > 100, "only {answered} sizes answered");
}

/// Every combination a laboratory might hold: all are answered, with a peak near the lever's first mode.
#[test]
fn plausible_instruments_all_reduce() {
    let (mut count, mut order, mut size) = (0, 0, 0);
    let begin = std::time::Instant::now();
    for rod in [50e-6, 300e-6, 1e-3, 3e-3, 10e-3] {
        for side in [20e-6, 200e-6, 2e-3] {
            for lever in [30e-6, 90e-6, 200e-6, 500e-6] {
                for thick in [0.2e-6, 1e-6, 7e-6] {
                    for tip in [0.0, 1e-13, 1e-11] {
                        let result = reduce(|p| {
                            let a = &mut p.actuator;
                            (a.length, a.width, a.thickness) = (rod, side, side);
                            if let LeverSpec::Dimensions { length, thickness, .. } = &mut p.cantilever.lever {
                                (*length, *thickness) = (lever, thick);
                            }
                            p.tip.mass = TipMass::Given(tip);
                            p.cantilever.quality_factor = QualityFactor::All(100.0);
                        });
                        if matches!(result, Err(Error::RodTooSlow { .. })) {
                            continue;
                        }
                        let case = format!("{rod:e} {side:e} {lever:e} {thick:e} {tip:e}");
                        let i = result.unwrap_or_else(|e| panic!("{case}: {e}"));
                        let peak = i.resonance().unwrap_or_else(|e| panic!("{case}: {e}"));
                        assert!(peak > 0.05 * i.lever_frequency && peak < 20.0 * i.lever_frequency, "{case}");
                        count += 1;
                        order = order.max(i.order);
                        size = size.max(i.modes.len());
                        assert!(i.resolved >= 2, "{case}: {} resolved", i.resolved);
                    }
                }
            }
        }
    }
    println!("{count} instruments, degree up to {order}, modes up to {size}, {:?}", begin.elapsed() / count);
    assert!(count > 450, "only {count} answered");
}

#[test]
fn rod_far_slower_than_its_lever_is_refused_and_one_a_little_slower_is_not() {
    let result = reduce(|p| p.actuator.length = 0.4);
    assert!(
        matches!(result, Err(Error::RodTooSlow { needed, most: 96, .. }) if needed > 96.0),
        "{:?}",
        short(&result)
    );
    let i = reduce(|p| p.actuator.length = 0.05).unwrap();
    let reach = i.modes[i.resolved - 1].omega / std::f64::consts::TAU;
    assert!(reach > 1.4 * i.lever_frequency, "resolved to {reach} Hz");
}

/// A prescribed rod tuned to its lever has no independent modes: the numbers stay finite and right.
#[test]
fn prescribed_rod_in_tune_with_its_lever() {
    let rod_hz = {
        let i = reduce(|p| p.actuator.model = ActuatorModel::Prescribed).unwrap();
        i.modes[0].omega / std::f64::consts::TAU
    };
    let tip = |detuning: f64| {
        let i = reduce(|p| {
            p.actuator.model = ActuatorModel::Prescribed;
            calibrated(p, rod_hz * (1.0 + detuning));
        })
        .unwrap();
        i.free_motion(DriveLevel::Voltage(1.0), 60e3).unwrap().tip.re
    };
    let far = 0.5 * (tip(1e-3) + tip(-1e-3));
    for detuning in [0.0, 1e-16, 1e-12, -1e-9, 1e-7, -1e-6, 1e-5] {
        let error = (tip(detuning) / far - 1.0).abs();
        assert!(error < 3e-5, "detuned by {detuning:e}: off by {error:.1e}");
    }
}

#[test]
fn drives_that_do_not_fit_are_refused() {
    let p = InstrumentParams::default();
    let on = |model, on| {
        let mut p = p.clone();
        p.actuator.model = model;
        Instrument::reduce(&p, on, DEFAULT_TOLERANCE).unwrap()
    };
    let all = [
        (on(ActuatorModel::Coupled, DriveOn::Actuator), DriveLevel::Voltage(1.0)),
        (on(ActuatorModel::Coupled, DriveOn::Tip), DriveLevel::Force(1e-9)),
        (on(ActuatorModel::Rigid, DriveOn::Actuator), DriveLevel::BaseAmplitude(1e-9)),
    ];
    for (instrument, own) in &all {
        for (_, level) in &all {
            let result = instrument.free_motion(*level, 30e3);
            if level == own {
                assert!(result.is_ok(), "{level:?}: {:?}", short(&result));
            } else {
                assert!(matches!(result, Err(Error::WrongDrive { .. })), "{level:?}: {:?}", short(&result));
            }
        }
        for bad in [f64::NAN, f64::INFINITY] {
            assert!(matches!(
                instrument.free_motion(DriveLevel::FreeAmplitude(bad), 30e3),
                Err(Error::BadValue { .. })
            ));
            assert!(matches!(instrument.free_motion(*own, bad), Err(Error::BadValue { .. })));
        }
    }
}

#[test]
fn undamped_resonance_is_refused() {
    let i = reduce(|_| ()).unwrap();
    let hz = i.modes[1].omega / std::f64::consts::TAU;
    match i.free_motion(DriveLevel::Voltage(1.0), hz) {
        Err(Error::DrivenOnResonance { frequency_hz, mode }) => {
            assert!((frequency_hz / hz - 1.0).abs() < 1e-12 && mode == 1);
        }
        other => panic!("{:?}", short(&other)),
    }
    assert!(i.free_motion(DriveLevel::Voltage(1.0), hz * (1.0 + 1e-9)).is_ok());
    assert!(matches!(i.resonance(), Err(Error::UndampedPeak { .. })));
    // Overdamped: no peak at all.
    let slow = reduce(|p| {
        p.actuator.model = ActuatorModel::Prescribed;
        p.actuator.quality_factor = 0.1;
        p.cantilever.quality_factor = QualityFactor::All(0.1);
    });
    let peak = slow.unwrap().resonance();
    assert!(matches!(peak, Err(Error::NoPeak { .. })), "{:?}", short(&peak));
}
