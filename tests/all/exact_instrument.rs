//! The modes against closed forms, the published setup and the continuum they approximate.

use std::f64::consts::TAU;

use crate::continuum::{Continuum, clamped_free, close, hertz};
use afmsweep::instrument::{DEFAULT_TOLERANCE, Instrument, InstrumentError, mode_summary};
use afmsweep::scene::{
    ActuatorModel, DriveLevel, DriveOn, InstrumentParams, LeverMode, LeverSpec, QualityFactor, TipMass,
};

const VOLTS: f64 = 15.0;

fn with(model: ActuatorModel) -> InstrumentParams {
    let mut p = InstrumentParams::default();
    p.actuator.model = model;
    p
}

fn without_tip(model: ActuatorModel) -> InstrumentParams {
    let mut p = with(model);
    p.tip.mass = TipMass::Given(0.0);
    p.tip.half_length = 0.0;
    p
}

fn reduce(p: &InstrumentParams, on: DriveOn) -> Instrument {
    Instrument::reduce(p, on, DEFAULT_TOLERANCE).expect("a sound instrument")
}

fn beam(p: &mut InstrumentParams) -> (&mut f64, &mut f64, &mut f64) {
    match &mut p.cantilever.lever {
        LeverSpec::Dimensions { youngs_modulus, length, thickness, .. } => {
            (youngs_modulus, length, thickness)
        }
        _ => panic!("a lever with dimensions"),
    }
}

#[test]
fn published_table_1_coupled_frequencies() {
    let i = reduce(&InstrumentParams::default(), DriveOn::Actuator);
    let exact = [96230.28875, 192287.4162, 309631.3175, 518649.5031, 727104.7409];
    for (mode, exact) in i.modes.iter().zip(exact) {
        close(hertz(mode), exact, 1e-9, "coupled frequency");
    }
    assert!(i.resolved >= 10, "only {} modes resolved", i.resolved);
    assert!(i.residual < 1e-11, "residual {}", i.residual);
}

#[test]
fn published_table_1_travel_of_the_top() {
    let still = reduce(&InstrumentParams::default(), DriveOn::Actuator);
    let top = still.free_motion(DriveLevel::Voltage(VOLTS), 1e-3).unwrap().top;
    close(top.re, 5.70415785e-9, 1e-9, "static top");
    // 6.225510 nm is the rod without the lever's inertia.
    let prescribed = reduce(&with(ActuatorModel::Prescribed), DriveOn::Actuator);
    let top = prescribed.free_motion(DriveLevel::Voltage(VOLTS), 30e3).unwrap().top;
    close(top.re, 6.225510e-9, 1e-7, "top at 30 kHz");
}

#[test]
fn closed_form_lever_alone() {
    let p = without_tip(ActuatorModel::Rigid);
    let i = reduce(&p, DriveOn::Tip);
    close(1.0 / i.flexibility(), 42.74245549, 1e-10, "3 E I / l^3");
    for (mode, exact) in i.modes.iter().zip([195226.385, 1223462.87, 3425731.47, 6713066.43]) {
        close(hertz(mode), exact, 4e-9, "clamped-free frequency");
    }
    let scale = hertz(&i.modes[0]) / clamped_free(0).powi(2);
    assert!(i.resolved >= 8);
    for k in 0..8 {
        close(hertz(&i.modes[k]), scale * clamped_free(k).powi(2), 1e-10, "lambda_k^2");
        // Mass-normalised, each clamped-free mode has 4/m_beam at its tip.
        let mass = 1.170585e-10;
        close(i.modes[k].tip.powi(2), 4.0 / mass, 1e-8, "tip participation");
    }
    let moved = reduce(&p, DriveOn::Actuator);
    for k in 0..8 {
        // Base participation times tip: 4 sigma / lambda with alternating sign.
        let x = clamped_free(k);
        let sigma = (x.sinh() - x.sin()) / (x.cosh() + x.cos());
        let sign = if k % 2 == 0 { -1.0 } else { 1.0 };
        let exact = sign * 4.0 * sigma / x;
        close(moved.modes[k].tip * moved.modes[k].drive, exact, 1e-8, "tip times base participation");
    }
}

/// Frequencies with a spring between tip and wall: modal receptance = -1/k.
fn with_spring(i: &Instrument, spring: f64) -> f64 {
    let receptance = |omega: f64| -> f64 {
        i.modes.iter().map(|m| m.tip * m.force / (m.omega * m.omega - omega * omega)).sum()
    };
    let (mut low, mut high) = (i.modes[0].omega * (1.0 + 1e-14), i.modes[1].omega * (1.0 - 1e-14));
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        // Rises from -inf to +inf between two poles.
        if receptance(middle) < -1.0 / spring { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

#[test]
fn closed_form_contact_resonance() {
    let i = reduce(&without_tip(ActuatorModel::Rigid), DriveOn::Tip);
    let k_c = 1.0 / i.flexibility();
    for (stiffness, factor) in [(1.0, 1.393502662), (10.0, 2.853808725), (100.0, 4.171600257)] {
        close(with_spring(&i, stiffness * k_c) / i.modes[0].omega, factor, 1e-9, "contact resonance");
    }
}

#[test]
fn closed_form_flexibility_of_the_tip() {
    for arm in [0.0, 5e-6, 40e-6] {
        let mut p = InstrumentParams::default();
        p.tip.half_length = arm;
        p.tip.mass = TipMass::Given(3e-12);
        let ei = 7.03e10 * 39e-6 * 6.9e-6f64.powi(3) / 12.0;
        let l: f64 = 174e-6;
        let lever = (l.powi(3) / 3.0 + l * l * arm + l * arm * arm) / ei;
        let softened = 2.216e10 - 5.45136e8f64.powi(2) / 7.81e7;
        let rod = 4000e-6 / (softened * 500e-6 * 500e-6);
        let coupled = reduce(&p, DriveOn::Tip);
        close(coupled.flexibility(), lever + rod, 1e-9, "coupled");
        let static_tip = coupled.free_motion(DriveLevel::Force(1e-9), 1e-2).unwrap().tip;
        close(static_tip.re, 1e-9 * (lever + rod), 1e-9, "static travel under 1 nN");
        for mode in &coupled.modes {
            assert_eq!((mode.force, mode.force), (mode.tip, mode.drive), "a push is a push, whoever does it");
        }
        p.actuator.model = ActuatorModel::AsPrinted;
        let printed = reduce(&p, DriveOn::Tip);
        // Pushed once, but the top counts twice in the travel; against the lever the rod is stiff.
        close(printed.flexibility(), lever + 2.0 * rod, 1e-9, "as printed");
        assert!(printed.modes.iter().all(|m| m.force == m.drive), "as printed, too");
        p.actuator.model = ActuatorModel::Prescribed;
        close(reduce(&p, DriveOn::Tip).flexibility(), lever, 1e-9, "prescribed: the rod does not give");
    }
}

/// Geometries away from Table 1, each stressing one part of the model.
fn geometries() -> Vec<(&'static str, InstrumentParams)> {
    let table = InstrumentParams::default();
    let mut all = vec![("Table 1", table.clone())];
    let mut short = table.clone();
    (short.actuator.length, short.actuator.width, short.actuator.thickness) = (60e-6, 30e-6, 30e-6);
    all.push(("short rod, hardly heavier than the lever", short));
    let mut long = table.clone();
    (*beam(&mut long).1, *beam(&mut long).2) = (450e-6, 3e-6);
    all.push(("long lever", long));
    let mut heavy = table.clone();
    heavy.tip.mass = TipMass::Given(6e-10);
    heavy.tip.half_length = 30e-6;
    all.push(("heavy tip on a long arm", heavy));
    let mut thin = table.clone();
    *beam(&mut thin).2 = 0.9e-6;
    all.push(("thin lever", thin));
    let mut soft = table;
    soft.actuator.h33 = 1.2e9;
    soft.actuator.length = 1500e-6;
    all.push(("piezoelectric softening close to instability", soft));
    all
}

#[test]
fn continuum_frequencies_of_six_geometries() {
    for (name, p) in geometries() {
        let i = reduce(&p, DriveOn::Actuator);
        let exact = Continuum::new(&p).frequencies(5);
        assert!(i.resolved >= 5, "{name}: {} resolved", i.resolved);
        let mut worst: f64 = 0.0;
        for (k, exact) in exact.iter().enumerate() {
            worst = worst.max((hertz(&i.modes[k]) / exact - 1.0).abs());
            close(hertz(&i.modes[k]), *exact, 1e-9, &format!("{name}, mode {}", k + 1));
        }
        println!("{name}: order {}, {} modes, worst {worst:.1e}", i.order, i.modes.len());
    }
}

#[test]
fn continuum_forced_motion_of_every_model() {
    for (name, p) in geometries() {
        let mut c = Continuum::new(&p);
        let on_top = VOLTS * c.force_per_volt;
        for (model, kappa) in [(ActuatorModel::Coupled, 1.0), (ActuatorModel::AsPrinted, 2.0)] {
            let mut p = p.clone();
            p.actuator.model = model;
            c.kappa = kappa;
            let hz = 0.37 * reduce(&p, DriveOn::Tip).lever_frequency;
            let moved = reduce(&p, DriveOn::Actuator).free_motion(DriveLevel::Voltage(VOLTS), hz).unwrap();
            let (tip, top) = c.forced(hz, on_top, 0.0);
            close(moved.tip.re, tip, 1e-8, &format!("{name}, {model:?}: tip under voltage"));
            close(moved.top.re, top, 1e-8, &format!("{name}, {model:?}: top under voltage"));
            let pushed = reduce(&p, DriveOn::Tip).free_motion(DriveLevel::Force(1e-9), hz).unwrap();
            let (tip, top) = c.forced(hz, 0.0, 1e-9);
            close(pushed.tip.re, tip, 1e-8, &format!("{name}, {model:?}: tip under force"));
            close(pushed.top.re, top, 1e-6, &format!("{name}, {model:?}: top under force"));
        }
        c.kappa = 1.0;
        let mut p = p.clone();
        p.actuator.model = ActuatorModel::Prescribed;
        let i = reduce(&p, DriveOn::Actuator);
        let hz = 0.37 * i.lever_frequency;
        let moved = i.free_motion(DriveLevel::Voltage(VOLTS), hz).unwrap();
        let top = c.rod_alone(hz, on_top);
        close(moved.top.re, top, 1e-8, &format!("{name}, prescribed: top"));
        close(moved.tip.re, top * c.follows(hz), 1e-8, &format!("{name}, prescribed: tip"));
        p.actuator.model = ActuatorModel::Rigid;
        let i = reduce(&p, DriveOn::Actuator);
        assert!(i.moving_base);
        let moved = i.free_motion(DriveLevel::BaseAmplitude(1e-9), hz).unwrap();
        close(moved.tip.re, 1e-9 * c.follows(hz), 1e-8, &format!("{name}, rigid: tip"));
        assert_eq!((moved.top.re, moved.top.im), (1e-9, 0.0));
    }
}

#[test]
fn published_claims_about_the_couplings_of_table_1() {
    let tip = |model| {
        let i = reduce(&with(model), DriveOn::Actuator);
        i.free_motion(DriveLevel::Voltage(VOLTS), 30e3).unwrap().tip.re
    };
    let coupled = tip(ActuatorModel::Coupled);
    // The lever weighs 1.5e-5 of the rod.
    let difference = (tip(ActuatorModel::Prescribed) / coupled - 1.0).abs();
    assert!(difference < 3e-5 && difference > 1e-7, "{difference:e}");
    let ratio = tip(ActuatorModel::AsPrinted) / coupled;
    assert!((ratio - 2.0).abs() < 1e-3, "as printed the tip moves {ratio} times as far");
}

#[test]
fn closed_form_calibrated_lever() {
    let mut p = with(ActuatorModel::Rigid);
    p.cantilever.lever = LeverSpec::Calibrated { stiffness: 42.0, frequency: 300e3 };
    p.cantilever.quality_factor = QualityFactor::All(400.0);
    let i = reduce(&p, DriveOn::Tip);
    for k in 0..8 {
        let ratio = (clamped_free(k) / clamped_free(0)).powi(2);
        close(hertz(&i.modes[k]), 300e3 * ratio, 1e-10, "frequency");
        close((i.modes[k].omega / i.modes[k].tip).powi(2), 42.0 * ratio * ratio, 1e-8, "modal stiffness");
        assert!((i.modes[k].quality_factor - 400.0).abs() < 1e-9);
    }
    close((i.modes[0].omega / i.modes[0].tip).powi(2), 42.0, 1e-11, "calibrated stiffness");
}

fn listed() -> InstrumentParams {
    let mut p = with(ActuatorModel::Rigid);
    let mode = |stiffness, frequency, quality_factor, drive| LeverMode {
        stiffness,
        frequency,
        quality_factor,
        drive,
    };
    // Not in rising order, on purpose.
    p.cantilever.lever = LeverSpec::Modes(vec![mode(80.0, 438.9e3, 250.0, 0.0), mode(2.0, 70e3, 100.0, 1.0)]);
    p
}

#[test]
fn closed_form_listed_modes() {
    let i = reduce(&listed(), DriveOn::Tip);
    assert_eq!((i.modes.len(), i.resolved, i.beam_elements, i.order), (2, 2, 0, 0));
    for (mode, (k, f, q, drive)) in i.modes.iter().zip([(2.0, 70e3, 100.0, 1.0), (80.0, 438.9e3, 250.0, 0.0)])
    {
        close(hertz(mode), f, 1e-15, "frequency");
        close(mode.tip * mode.tip, (TAU * f).powi(2) / k, 1e-14, "1/m");
        close(mode.quality_factor, q, 1e-15, "Q");
        assert_eq!((mode.force, mode.drive), (mode.tip, drive * mode.tip));
    }
    let i = reduce(&listed(), DriveOn::Actuator);
    close(i.modes[0].drive * i.modes[0].tip, -1.0, 1e-14, "inertial participation 1");
    assert_eq!(i.modes[1].drive, 0.0);
}

#[test]
fn closed_form_quality_factors() {
    let mut p = InstrumentParams::default();
    let inverse = |p: &InstrumentParams| -> Vec<f64> {
        reduce(p, DriveOn::Actuator).modes.iter().take(12).map(|m| 1.0 / m.quality_factor).collect()
    };
    (p.actuator.length, p.actuator.width, p.actuator.thickness) = (300e-6, 60e-6, 60e-6);
    assert!(inverse(&p).iter().all(|d| *d == 0.0), "undamped by default");
    p.actuator.quality_factor = 50.0;
    let rod = inverse(&p);
    p.cantilever.quality_factor = QualityFactor::All(50.0);
    assert!(inverse(&p).iter().all(|d| (d * 50.0 - 1.0).abs() < 1e-10), "equal parts, equal modes");
    p.actuator.quality_factor = f64::INFINITY;
    let lever = inverse(&p);
    p.cantilever.quality_factor = QualityFactor::PerMode(vec![50.0, f64::INFINITY]);
    let first = inverse(&p);
    p.cantilever.quality_factor = QualityFactor::PerMode(vec![f64::INFINITY, 50.0]);
    let others = inverse(&p);
    // The lever's share of strain energy is d ln omega^2 / d ln E_b (Hellmann and Feynman).
    let squares = |factor: f64| -> Vec<f64> {
        let mut p = p.clone();
        *beam(&mut p).0 *= factor;
        reduce(&p, DriveOn::Actuator).modes.iter().map(|m| m.omega.ln() * 2.0).collect()
    };
    let (up, down) = (squares(1.0005), squares(0.9995));
    for k in 0..6 {
        assert!((rod[k] + lever[k] - 0.02).abs() < 1e-10, "mode {k}: rod's and lever's shares make one");
        assert!((first[k] + others[k] - lever[k]).abs() < 1e-10, "mode {k}: a list splits the lever's share");
        let share = (up[k] - down[k]) / 1e-3;
        assert!((share - 50.0 * lever[k]).abs() < 1e-5, "mode {k}: {share} is not {}", 50.0 * lever[k]);
    }
    let mut p = with(ActuatorModel::Rigid);
    p.cantilever.quality_factor = QualityFactor::PerMode(vec![100.0, 300.0]);
    let q: Vec<f64> = reduce(&p, DriveOn::Tip).modes.iter().map(|m| m.quality_factor).collect();
    assert!((q[0] - 100.0).abs() < 1e-9 && q[1..].iter().all(|q| (q - 300.0).abs() < 1e-9), "{q:?}");
}

#[test]
fn closed_form_share_of_a_listed_mode_in_damping() {
    // Stiffening one listed mode at its mass shows its share of the strain energy.
    let mut p = listed();
    p.actuator.model = ActuatorModel::Coupled;
    (p.actuator.length, p.actuator.width, p.actuator.thickness) = (500e-6, 20e-6, 20e-6);
    let modified = |factor: f64| {
        let mut p = p.clone();
        if let LeverSpec::Modes(modes) = &mut p.cantilever.lever {
            modes[1].stiffness *= factor;
            modes[1].frequency *= factor.sqrt();
            (modes[0].quality_factor, modes[1].quality_factor) = (f64::INFINITY, 40.0);
        }
        reduce(&p, DriveOn::Actuator)
    };
    let (up, here, down) = (modified(1.0005), modified(1.0), modified(0.9995));
    for k in 0..5 {
        let share = 2.0 * (up.modes[k].omega / down.modes[k].omega).ln() / 1e-3;
        let found = 40.0 / here.modes[k].quality_factor;
        assert!((share - found).abs() < 1e-5, "mode {k}: {share} is not {found}");
    }
}

#[test]
fn shares_and_summary() {
    let mut p = with(ActuatorModel::Coupled);
    let i = reduce(&p, DriveOn::Actuator);
    close(i.tip_shares().iter().sum(), 1.0, 1e-12, "tip shares");
    close(i.drive_shares().iter().map(|s| s.abs()).sum(), 1.0, 1e-12, "drive shares");
    let json = mode_summary::modes_json(&i);
    let modes = json["modes"].as_array().unwrap();
    assert_eq!(modes.len(), i.resolved);
    close(modes[1]["frequency_hz"].as_f64().unwrap(), 192287.4162, 1e-9, "frequency_hz");
    assert!(modes[1]["quality_factor"].is_null(), "undamped is null");
    assert!(modes[1]["tip_share"].as_f64().unwrap() > 0.9);
    assert!(modes[0]["drive_share"].as_f64().unwrap() > 0.5);
    p.cantilever.quality_factor = QualityFactor::All(200.0);
    let i = reduce(&p, DriveOn::Actuator);
    let json = mode_summary::modes_json(&i);
    close(json["modes"][1]["quality_factor"].as_f64().unwrap(), 200.0, 1e-3, "quality_factor");
    let table = mode_summary::modes_table(&i);
    assert!(table.contains("192.2874 kHz"), "{table}");
    p.actuator.h33 = 0.0;
    let still = reduce(&p, DriveOn::Actuator);
    assert!(still.drive_shares().iter().all(|s| *s == 0.0), "no drive, no shares, no NaN");
    let asked = still.free_motion(DriveLevel::FreeAmplitude(1e-9), 30e3);
    assert!(matches!(asked, Err(InstrumentError::NoTipMotion { .. })), "{asked:?}");
}
