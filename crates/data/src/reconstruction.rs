//! The force of the sample from a curve of oscillations: what an experiment does to its own data.
//!
//! One mode of stiffness k moves as `z = g + A cos`, so that its resonance is shifted by
//! `W = ((f_eff/f0)^2 - 1)/2 = -<F cos>/(k A)`, the mean over a period of the force along the orbit. A curve of such
//! shifts over the closest approach `d = g - A` holds the force as a function of the distance, if that force is the same on
//! the way in and out. [`force`] inverts the mean itself, whatever the amplitudes; [`force_by_sader_jarvis`] is the formula
//! that is in use. Both amplify noise: errors of W count some `sqrt(A/h)` times, h being the step of d.

/// Steps of the closest approach that are shorter, in amplitudes, are passed over.
const FINEST: f64 = 2e-4;

/// What one point of a curve tells: SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Orbit {
    /// Closest approach d, m: the distance of the mean position less the amplitude. Negative in contact.
    pub closest: f64,
    /// A, m.
    pub amplitude: f64,
    /// W = ((f_eff/f0)^2 - 1)/2; for small shifts the shift over the frequency.
    pub shift: f64,
}

impl Orbit {
    /// Of the shift of the resonance, `shift_hz` from `frequency` (Hz).
    pub fn of_shift(closest: f64, amplitude: f64, shift_hz: f64, frequency: f64) -> Self {
        let share = shift_hz / frequency;
        Self { closest, amplitude, shift: share + 0.5 * share * share }
    }

    /// Of an amplitude and a phase at a fixed drive: `ratio` is the drive's frequency over f0, `drive` the force of the drive
    /// over k (m; at resonance the free amplitude over Q), `phase` the lag behind that force (rad). W = [ratio^2 - 1 + (drive/A)
    /// cos(phase)]/2 (A. J. Katan, M. H. van Es, T. H. Oosterkamp, Nanotechnology 20 (2009) 165703).
    pub fn of_phase(closest: f64, amplitude: f64, ratio: f64, drive: f64, phase: f64) -> Self {
        let shift = 0.5 * ((ratio - 1.0) * (ratio + 1.0) + drive / amplitude * phase.cos());
        Self { closest, amplitude, shift }
    }

    /// Whether all of it is known.
    fn known(&self) -> bool {
        self.closest.is_finite() && self.amplitude > 0.0 && self.shift.is_finite()
    }
}

/// The force (N, positive pushes) at distances (m) from the farthest to the nearest, of one continuous piece of a curve.
///
/// Orbits are taken in their order; one that comes no nearer than those before it, by some ten-thousandths of its amplitude, adds
/// nothing. Beyond the first distance
/// there is taken to be no force, between two it is taken to be linear: each orbit's mean is then exact and has one unknown,
/// the force at its own closest approach (F. J. Giessibl, Appl. Phys. Lett. 78 (2001) 123, for amplitudes that vary).
pub fn force(orbits: &[Orbit], stiffness: f64) -> Vec<(f64, f64)> {
    let mut found: Vec<(f64, f64)> = Vec::new();
    for orbit in nearing(orbits) {
        let Some(&(last, _)) = found.last() else {
            found.push((orbit.closest, 0.0));
            continue;
        };
        let known: f64 = found.windows(2).map(|pair| cell(&orbit, pair[1], pair[0])).sum();
        // The mean is linear in the force at the orbit's end, with that at the last distance as it is.
        let beside = found[found.len() - 1];
        let (without, with) =
            (cell(&orbit, (orbit.closest, 0.0), beside), cell(&orbit, (orbit.closest, 1.0), (last, 0.0)));
        let asked = -stiffness * orbit.amplitude * orbit.shift;
        found.push((orbit.closest, (asked - known - without) / with));
    }
    found
}

/// The part of `<F cos>` of an orbit where the force goes linearly from `near` to `far`, each a distance and a force.
fn cell(orbit: &Orbit, near: (f64, f64), far: (f64, f64)) -> f64 {
    let place = |distance: f64| ((distance - orbit.closest) / orbit.amplitude).clamp(0.0, 2.0);
    let (low, high) = (place(near.0), place(far.0));
    if high <= low {
        return 0.0;
    }
    let slope = (far.1 - near.1) / (far.0 - near.0) * orbit.amplitude;
    // In s = 1 + cos: the force is start + slope s.
    let start = near.1 - slope * (near.0 - orbit.closest) / orbit.amplitude;
    // Integrals of (s - 1)/sqrt(s (2 - s)) and of s times that, over pi.
    let first = |s: f64| -(s * (2.0 - s)).max(0.0).sqrt();
    let angle = |s: f64| 2.0 * (0.5 * s).sqrt().min(1.0).asin();
    let second = |s: f64| 0.5 * (angle(s) - (s + 1.0) * (s * (2.0 - s)).max(0.0).sqrt());
    (start * (first(high) - first(low)) + slope * (second(high) - second(low))) / std::f64::consts::PI
}

/// The same by the formula of J. E. Sader & S. P. Jarvis, Appl. Phys. Lett. 84 (2004) 1801, which for one amplitude is within
/// 5 % for whatever force, and better where the amplitude is much larger or smaller than its range:
///
/// `F(d) = 2 k int_d^inf { [1 + sqrt(A)/(8 sqrt(pi (t - d)))] W(t) - A^1.5/sqrt(2 (t - d)) W'(t) } dt`
///
/// Where the amplitude varies along the curve (A. F. Payam, D. Martin-Jimenez, R. Garcia, Nanotechnology 26 (2015) 185706)
/// the derivative here is that of `A^1.5 W`, as the limit of large amplitudes has it: with `A^1.5 W'` a tapping curve, whose
/// amplitude falls to a fraction, gives forces that are off by more than themselves. W and `A^1.5 W` are linear between
/// distances.
pub fn force_by_sader_jarvis(orbits: &[Orbit], stiffness: f64) -> Vec<(f64, f64)> {
    let taken: Vec<Orbit> = nearing(orbits).collect();
    let large = |orbit: &Orbit| orbit.amplitude.powf(1.5) * orbit.shift;
    let at = |number: usize| {
        let d = taken[number].closest;
        let parts = taken[..=number].windows(2).map(|pair| {
            let (far, near) = (pair[0], pair[1]);
            let (low, high) = (near.closest - d, far.closest - d);
            let slope = (far.shift - near.shift) / (high - low);
            let amplitude = 0.5 * (far.amplitude + near.amplitude);
            let roots = 2.0 * (high.sqrt() - low.sqrt());
            let plain = 0.5 * (far.shift + near.shift) * (high - low);
            // W/sqrt(t - d), W being near.shift + slope (t - d - low).
            let weighted =
                (near.shift - slope * low) * roots + slope * 2.0 / 3.0 * (high.powf(1.5) - low.powf(1.5));
            plain + (amplitude / std::f64::consts::PI).sqrt() / 8.0 * weighted
                - (large(&far) - large(&near)) / (high - low) * std::f64::consts::FRAC_1_SQRT_2 * roots
        });
        (d, 2.0 * stiffness * parts.sum::<f64>())
    };
    (0..taken.len()).map(at).collect()
}

/// The orbits that come nearer than all before them, by more than what their errors would blow up.
fn nearing(orbits: &[Orbit]) -> impl Iterator<Item = Orbit> {
    let mut nearest = f64::INFINITY;
    orbits.iter().copied().filter(Orbit::known).filter(move |orbit| {
        let nearer = orbit.closest < nearest - FINEST * orbit.amplitude;
        if nearer {
            nearest = orbit.closest;
        }
        nearer
    })
}
