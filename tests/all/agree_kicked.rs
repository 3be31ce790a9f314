//! A curve that stays on its branch when the sample comes slowly, and leaves it when the sample comes in jerks.
//! Truth: an independent integrator (tests/support/sweeper.rs) that moves the sample a little every period.

use crate::support::laws::Law;
use crate::support::sweeper::{Mode, Place, Sweeper};
use afmsweep::{Audit, Scene, Sweep};

/// A sticky, blunt tip: waiting for points a quarter of a nanometre apart, each reached at one stroke, ends on the repulsive
/// branch from 12 nm on and comes back at 19 nm; strokes of 0.06 nm do not.
const SCENE: &str = r#"
[instrument.cantilever]
modes = [{ stiffness = "40 N/m", frequency = "300 kHz", quality_factor = 279.227 }]
[instrument.tip]
radius = "25.548 nm"
[sample]
youngs_modulus = "5.22593 GPa"
surface_energy = "99.8735 mJ/m^2"
[contact]
law = "dmt"
[drive]
on = "tip"
frequency = "300 kHz"
free_amplitude = "20 nm"
[curve]
quantity = "approach.gap"
from = "21 nm"
to = "2 nm"
points = 20
direction = "both"
[run]
accuracy = 1e-3
[output]
observables = ["amplitude", "force_mean"]
"#;

/// At resonance, so that the force is a Q-th of what would bend the lever as far.
fn place(gap: f64) -> Place {
    Place { gap, frequency: 300e3, force: 40.0 * 20e-9 / 279.227 }
}

/// The lever of the scene in free oscillation.
fn far_away(gap: f64) -> Sweeper {
    let mode = Mode { stiffness: 40.0, frequency: 300e3, quality: 279.227 };
    let k = 4.0 / 3.0 * 5.22593e9 / (1.0 - 0.25);
    let law = Law::Dmt { k, r: 25.548e-9, w: 99.8735e-3, d0: 0.3e-9 };
    Sweeper::free(&[mode], law, place(gap))
}

#[test]
fn a_curve_is_followed_as_a_slow_approach_goes() {
    let scene = Scene::parse("kicked.toml".as_ref(), SCENE).unwrap();
    let results = Sweep::new(scene).audit(Audit::None).run().unwrap().results;
    let ours = results.observable("amplitude").unwrap().values;
    let gaps = results.axes.last().unwrap().values.clone();
    let mut lever = far_away(25e-9);
    let there = (0..gaps.len()).map(|i| (i, 0));
    let back = (0..gaps.len()).rev().map(|i| (i, gaps.len()));
    for (i, way) in there.chain(back) {
        let motion = lever.go(place(gaps[i])).expect("it settles");
        let off = (motion.amplitude - ours[way + i]).abs() / 20e-9;
        assert!(off < 1e-3, "{} nm: {:e}, not {:e}", 1e9 * gaps[i], ours[way + i], motion.amplitude);
    }
}

/// The same integrator, whose sample comes in strokes of a quarter of a nanometre: at 12 nm it has left the branch, with an
/// amplitude 0.84 nm above that of the slow approach.
#[test]
fn strokes_of_the_sample_throw_a_tip_off_its_branch() {
    let mut lever = far_away(21e-9);
    let mut amplitude = f64::NAN;
    for n in 0..=36 {
        let to = place(21e-9 - 0.25e-9 * f64::from(n));
        lever.at = to;
        amplitude = lever.go(to).expect("it settles").amplitude;
    }
    assert!((amplitude - 12.964e-9).abs() < 0.02e-9, "{amplitude:e}");
}
