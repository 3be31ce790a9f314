//! Forces reconstructed from curves.
//! Truth: forces whose shift is known in closed form (SciPy 1.17.1 for the Bessel function in it), and the contact law that a
//! simulated curve was made with, as its own formula says it.

use afmsweep::reconstruction::{Orbit, force, force_by_sader_jarvis};
use afmsweep::{Scene, Sweep};
use std::f64::consts::PI;

/// Orbits over an exponential force `F0 exp(-z/range)`: its mean along a sine is a modified Bessel function,
/// `W = F0 exp(-d/range) exp(-A/range) I1(A/range)/(k A)`.
fn exponential(stiffness: f64, amplitude: f64, range: f64, scaled_bessel: f64) -> Vec<Orbit> {
    let orbit = |n: u32| {
        let closest = 30.0 * range * (1.0 - f64::from(n) / 1500.0);
        let mean = 1e-9 * (-closest / range).exp() * scaled_bessel;
        Orbit { closest, amplitude, shift: mean / (stiffness * amplitude) }
    };
    (0..=1500).map(orbit).collect()
}

/// Largest error over the largest force.
fn miss(found: &[(f64, f64)], law: impl Fn(f64) -> f64) -> f64 {
    let largest = found.iter().map(|(distance, _)| law(*distance).abs()).fold(0.0, f64::max);
    found.iter().map(|(distance, value)| (value - law(*distance)).abs() / largest).fold(0.0, f64::max)
}

#[test]
fn an_exponential_force_comes_back_from_its_shift() {
    // Amplitude over range, and exp(-x) I1(x) of it (scipy.special.ive).
    let table = [
        (0.1, 0.045298446808809324),
        (1.0, 0.20791041534970842),
        (3.0, 0.19682671329730086),
        (10.0, 0.12126268138445552),
        (30.0, 0.07191633059864756),
        (100.0, 0.039744153025130256),
    ];
    let range = 0.5e-9;
    for (ratio, scaled) in table {
        let orbits = exponential(40.0, ratio * range, range, scaled);
        let law = |distance: f64| 1e-9 * (-distance / range).exp();
        let (exact, formula) =
            (miss(&force(&orbits, 40.0), law), miss(&force_by_sader_jarvis(&orbits, 40.0), law));
        println!("A/range {ratio}: off by {exact:.1e}; by Sader and Jarvis {formula:.1e}");
        assert!(exact < 1e-3, "A/range {ratio}: {exact:e}");
        // What their paper says of the formula: 5 % at most.
        assert!(formula < 0.05, "A/range {ratio}: {formula:e}");
    }
}

/// Truth: W from the equation of motion of one driven mode: at resonance without a sample the lag is 90 degrees and W nothing;
/// a spring of stiffness c on the tip shifts (f/f0)^2 by c/k and turns the phase with it.
#[test]
fn phases_and_shifts_tell_the_same() {
    let (ratio, quality, spring): (f64, f64, f64) = (1.0, 200.0, 1e-3);
    // (1 + spring - ratio^2 + i ratio/Q) A = drive, lag = its argument.
    let (real, imaginary) = (1.0 + spring - ratio * ratio, ratio / quality);
    let (amplitude, lag) = (1e-9 / real.hypot(imaginary), imaginary.atan2(real));
    let by_phase = Orbit::of_phase(0.0, amplitude, ratio, 1e-9, lag);
    let by_shift = Orbit::of_shift(0.0, amplitude, 300e3 * ((1.0 + spring).sqrt() - 1.0), 300e3);
    assert!((by_phase.shift - 0.5 * spring).abs() < 1e-15, "{}", by_phase.shift);
    assert!((by_shift.shift - 0.5 * spring).abs() < 1e-15, "{}", by_shift.shift);
    let free = Orbit::of_phase(0.0, 200e-9, 1.0, 1e-9, 0.5 * PI);
    assert!(free.shift.abs() < 1e-15);
}

const CURVE: &str = r#"
[instrument.cantilever]
stiffness = "40 N/m"
frequency = "300 kHz"
quality_factor = 400
[instrument.tip]
radius = "10 nm"
[sample]
youngs_modulus = "50 MPa"
poisson_ratio = 0.34
surface_energy = "ENERGY mJ/m^2"
[contact]
law = "LAW"
decay_length = "0.3 nm"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[curve]
quantity = "approach.gap"
from = "26 nm"
to = "6 nm"
points = 861
[run]
modes = 1
accuracy = 1e-4
[output]
observables = ["amplitude", "phase", "frequency_shift", "deflection_mean"]
"#;

/// Both ways of saying the shift; the law's own formula.
#[test]
fn simulated_curves_give_their_laws_back() {
    let modulus = 50e6 / (1.0 - 0.34 * 0.34);
    for (law, energy) in [("hertz", 0.0), ("dmt", 10e-3)] {
        let text = CURVE.replace("LAW", law).replace("ENERGY", &format!("{}", 1e3 * energy));
        let swept = Sweep::new(Scene::parse("curve.toml".as_ref(), &text).unwrap()).run().unwrap();
        let of = |name: &str| swept.results.observable(name).unwrap().values;
        let (amplitudes, shifts, phases) = (of("amplitude"), of("frequency_shift"), of("phase"));
        let means = of("deflection_mean");
        let gaps = &swept.results.axes.last().unwrap().values;
        let truth = |distance: f64| {
            let pull = 2.0 * PI * 10e-9 * energy;
            match distance {
                apart if apart > 0.0 => -pull * (0.3e-9 / (0.3e-9 + apart)).powi(2),
                inside => 4.0 / 3.0 * modulus * 10e-9_f64.sqrt() * (-inside).powf(1.5) - pull,
            }
        };
        let closest = |i: usize| gaps[i] + means[i] - amplitudes[i];
        let by_shift: Vec<Orbit> =
            (0..gaps.len()).map(|i| Orbit::of_shift(closest(i), amplitudes[i], shifts[i], 300e3)).collect();
        let by_phase: Vec<Orbit> = (0..gaps.len())
            .map(|i| Orbit::of_phase(closest(i), amplitudes[i], 1.0, 20e-9 / 400.0, phases[i].to_radians()))
            .collect();
        for (what, orbits) in [("shift", &by_shift), ("phase", &by_phase)] {
            let (exact, formula) = (force(orbits, 40.0), force_by_sader_jarvis(orbits, 40.0));
            let deepest = exact.last().unwrap().0;
            assert!(deepest < -6.5e-9, "{law}: reaches {deepest:e}");
            let (exact, formula) = (miss(&exact, truth), miss(&formula, truth));
            println!(
                "{law} by {what}: off by {exact:.1e}; by Sader and Jarvis {formula:.1e}; down to {deepest:.2e} m"
            );
            assert!(exact < 0.01, "{law} by {what}: {exact:e}");
            // Made for one amplitude; here it falls from 20 to 6 nm and less.
            assert!(formula < 0.1, "{law} by {what}: {formula:e}");
        }
    }
}
