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

#[test]
fn a_curve_is_followed_as_a_slow_approach_goes() {
    let scene = Scene::parse("kicked.toml".as_ref(), SCENE).unwrap();
    let results = Sweep::new(scene).audit(Audit::None).run().unwrap().results;
    let ours = results.observable("amplitude").unwrap().values;
    let gaps = results.axes.last().unwrap().values.clone();
    let (stiffness, quality) = (40.0, 279.227);
    let mode = Mode { stiffness, frequency: 300e3, quality };
    let k = 4.0 / 3.0 * 5.22593e9 / (1.0 - 0.25);
    let law = Law::Dmt { k, r: 25.548e-9, w: 99.8735e-3, d0: 0.3e-9 };
    let place = |gap: f64| Place { gap, frequency: 300e3, force: stiffness * 20e-9 / quality };
    let mut lever = Sweeper::free(&[mode], law, place(25e-9));
    let there = (0..gaps.len()).map(|i| (i, 0));
    let back = (0..gaps.len()).rev().map(|i| (i, gaps.len()));
    for (i, way) in there.chain(back) {
        let motion = lever.go(place(gaps[i])).expect("it settles");
        let off = (motion.amplitude - ours[way + i]).abs() / 20e-9;
        assert!(off < 1e-3, "{} nm: {:e}, not {:e}", 1e9 * gaps[i], ours[way + i], motion.amplitude);
    }
}
