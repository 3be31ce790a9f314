//! What an AFM shows: the tip against the base, and the free oscillation's lag.
//! Truth: closed forms of a driven base, and the waveforms, which come from the stepped modes one by one.

use afmsweep::store::Results;
use afmsweep::{Audit, Scene, Sweep};
use nalgebra::Complex;
use std::f64::consts::TAU;
use std::path::Path;

fn run(text: &str) -> Results {
    let scene = Scene::parse(Path::new("deflection.toml"), text).unwrap();
    Sweep::new(scene).audit(Audit::None).run().unwrap().results
}

fn value(results: &Results, name: &str) -> f64 {
    results.observable(name).unwrap().values[0]
}

const ASKED: &str = "[output]\nobservables = [\"amplitude\", \"phase\", \"force_mean\", \"deflection_amplitude\", \
                     \"deflection_phase\", \"deflection_mean\", \"free_phase\"]\n";

/// One mode on a base that moves by Y at its frequency: the lever bends by Q Y, a quarter behind; the tip moves by
/// `Y sqrt(1 + Q^2)`.
#[test]
fn a_lever_of_one_mode_on_a_moving_base_bends_by_its_quality_factor() {
    let results = run(&format!(
        "[instrument.cantilever]\nmodes = [{{ stiffness = \"0.1 N/m\", frequency = \"8 kHz\", quality_factor = 2 }}]\n\
         [contact]\nlaw = \"none\"\n[drive]\nfrequency = \"8 kHz\"\nbase_amplitude = \"1 nm\"\n{ASKED}"
    ));
    let close = |name: &str, truth: f64| {
        let found = value(&results, name);
        assert!((found / truth - 1.0).abs() < 1e-9, "{name}: {found:e}, not {truth:e}");
    };
    close("deflection_amplitude", 2e-9);
    close("deflection_phase", 90.0);
    close("amplitude", 5f64.sqrt() * 1e-9);
    let lag = 2f64.atan().to_degrees();
    close("phase", lag);
    close("free_phase", lag);
    assert_eq!(value(&results, "deflection_mean"), 0.0);
}

/// The k-th root of 1 + cos(x) cosh(x), from 1, by Newton on cos(x) + 1/cosh(x).
fn root(k: u32) -> f64 {
    let mut x = (f64::from(k) - 0.5) * std::f64::consts::PI;
    for _ in 0..20 {
        x -= (x.cos() + 1.0 / x.cosh()) / (-x.sin() - x.tanh() / x.cosh());
    }
    x
}

/// A clamped-free beam with the same Q for all modes on a base that moves by Y: its modes move the tip by 4 sigma/lambda
/// of what a push on all of the beam does, by turns up and down.
#[test]
fn a_calibrated_lever_bends_as_a_beam_with_all_its_modes() {
    for share in [0.3, 1.0, 3.7] {
        let results = run(&format!(
            "[instrument.cantilever]\nstiffness = \"0.1 N/m\"\nfrequency = \"8 kHz\"\nquality_factor = 2\n[contact]\n\
             law = \"none\"\n[drive]\nfrequency = \"{} Hz\"\nbase_amplitude = \"1 nm\"\n{ASKED}",
            8000.0 * share
        ));
        let first = root(1);
        let bends: Complex<f64> = (1..=400)
            .map(|k| {
                let x = root(k);
                let sigma = if k < 20 { (x.sinh() - x.sin()) / (x.cosh() + x.cos()) } else { 1.0 };
                let sign = if k % 2 == 1 { 1.0 } else { -1.0 };
                let square = (x / first).powi(4);
                let response = Complex::new(square - share * share, share * square.sqrt() / 2.0);
                Complex::new(sign * 4.0 * sigma / x * share * share, 0.0) / response
            })
            .sum();
        let found = value(&results, "deflection_amplitude");
        assert!((found / (bends.norm() * 1e-9) - 1.0).abs() < 1e-9, "{share}: {found:e}, {:e}", bends.norm());
        let lag = (-bends.arg().to_degrees()).rem_euclid(360.0);
        let found = value(&results, "deflection_phase");
        assert!((found - lag).abs() < 1e-7, "{share}: {found}, {lag}");
    }
}

/// The fundamental of samples over whole periods that begin with the drive's sine, and their mean.
fn analysed(values: &[f64], periods: usize) -> (Complex<f64>, f64) {
    let n = values.len();
    let turn = |i: usize| Complex::from_polar(2.0 / n as f64, -TAU * (i * periods) as f64 / n as f64);
    let sum: Complex<f64> = values.iter().enumerate().map(|(i, value)| turn(i) * *value).sum();
    // z = Im(Z exp(i omega t)).
    (sum * Complex::i(), values.iter().sum::<f64>() / n as f64)
}

/// In contact, with a rod that the lever pushes back and on a base that moves.
#[test]
fn deflection_in_contact_is_that_of_the_waveforms() {
    let lever =
        "[instrument.cantilever]\nstiffness = \"2 N/m\"\nfrequency = \"70 kHz\"\nquality_factor = 20\n";
    let rod = "[instrument.actuator]\nquality_factor = 50\n";
    for (instrument, drive, modulus) in [
        (lever.to_owned(), "free_amplitude = \"20 nm\"\n", "1 GPa"),
        (
            format!("[instrument]\npreset = \"ha-fung-chen-2005\"\n{rod}{lever}"),
            "free_amplitude = \"20 nm\"\n",
            "1 GPa",
        ),
        (format!("{rod}{lever}"), "on = \"tip\"\nfree_amplitude = \"20 nm\"\n", "1 GPa"),
        // So light a rod that the lever moves it.
        (
            format!("{rod}width = \"5 um\"\nthickness = \"5 um\"\n{lever}"),
            "on = \"tip\"\nfree_amplitude = \"20 nm\"\n",
            "50 MPa",
        ),
    ] {
        let results = run(&format!(
            "{instrument}[instrument.tip]\nradius = \"10 nm\"\n[sample]\nyoungs_modulus = \"{modulus}\"\n\
             surface_energy = \"20 mJ/m^2\"\n[contact]\nlaw = \"dmt\"\n[drive]\nfrequency = \"68 kHz\"\n{drive}[approach]\n\
             gap = \"14 nm\"\n[run]\nsteady = \"search\"\naccuracy = 1e-4\n{ASKED}\
             waveforms = {{ instances = [0], samples_per_period = 1024, periods = 2 }}\n"
        ));
        assert_eq!(results.status, [0]);
        let waves = results.waveforms.as_ref().unwrap();
        let bends: Vec<f64> =
            waves.tip_travel[0].iter().zip(&waves.actuator_top[0]).map(|(tip, top)| tip - top).collect();
        let (fundamental, mean) = analysed(&bends, 2);
        let scale = 20e-9;
        let amplitude = value(&results, "deflection_amplitude");
        assert!(
            (amplitude - fundamental.norm()).abs() < 1e-4 * scale,
            "{amplitude:e} {:e}",
            fundamental.norm()
        );
        let lag = (-fundamental.arg().to_degrees()).rem_euclid(360.0);
        let phase = value(&results, "deflection_phase");
        assert!((phase - lag).abs() < 1e-2, "{phase} {lag}");
        let found = value(&results, "deflection_mean");
        assert!((found - mean).abs() < 1e-4 * scale && found.abs() > 1e-12, "{found:e} {mean:e}");
        // The base does move, or is pushed.
        assert!((amplitude - value(&results, "amplitude")).abs() > 1e-6 * scale, "{instrument}");
    }
}

/// Far from the sample DMT's attraction alone acts. Over a sine of amplitude A about a gap g its virial is known, with
/// a = 1 + g/D0 and b = A/D0: 2 pi w R A b/(a^2 - b^2)^(3/2).
#[test]
fn the_shift_of_a_weak_attraction_is_its_virial() {
    for (amplitude, gap) in [(10e-9, 12e-9), (1e-9, 5e-9)] {
        let results = run(&format!(
            "[instrument.cantilever]\nmodes = [{{ stiffness = \"40 N/m\", frequency = \"300 kHz\", quality_factor = 300 }}]\n\
             [instrument.tip]\nradius = \"5 nm\"\n[sample]\nyoungs_modulus = \"1 GPa\"\nsurface_energy = \"10 mJ/m^2\"\n\
             [contact]\nlaw = \"dmt\"\n[drive]\non = \"tip\"\nfrequency = \"300 kHz\"\nfree_amplitude = \"{amplitude:e} m\"\n\
             [approach]\ngap = \"{gap:e} m\"\n[run]\nsteady = \"search\"\naccuracy = 1e-7\n[output]\n\
             observables = [\"amplitude\", \"frequency_shift\", \"indentation_max\"]\n"
        ));
        assert_eq!(results.status, [0]);
        assert!(value(&results, "indentation_max").is_nan(), "it does not touch");
        let swing = value(&results, "amplitude");
        let b = swing / 0.3e-9;
        // The mean pull, pull a/(a^2 - b^2)^(3/2), bends the lever of 40 N/m towards the sample.
        let pull = TAU * 0.01 * 5e-9;
        let mut a = 1.0 + gap / 0.3e-9;
        for _ in 0..9 {
            a = 1.0 + (gap - pull * a / (a * a - b * b).powf(1.5) / 40.0) / 0.3e-9;
        }
        let virial = TAU * 0.01 * 5e-9 * swing * b / (a * a - b * b).powf(1.5);
        let truth = 300e3 * ((1.0 - 2.0 * virial / (40.0 * swing * swing)).sqrt() - 1.0);
        let found = value(&results, "frequency_shift");
        assert!(truth < -0.1, "{truth}");
        println!(
            "{truth} Hz: off by {:.1e} of the frequency, {:.1e} of the shift",
            (found - truth).abs() / 300e3,
            (found / truth - 1.0).abs()
        );
        assert!((found - truth).abs() < 1e-10 * 300e3, "{found} Hz, not {truth} Hz");
        assert!((found / truth - 1.0).abs() < 2e-5, "{found} Hz, not {truth} Hz");
    }
}
