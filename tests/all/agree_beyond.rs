//! Contact where the free oscillation does not reach the sample: followed along curves to the end of the branch, and found as
//! second states. Truth: an independent integrator (tests/support/sweeper.rs) that steps slowly through the same points.

use crate::agree_curves::{BRANCHES, DAMPED, GAP, KHZ, NM, System, agrees, run};
use crate::support::follow::Motion;
use crate::support::sweeper::{Mode, Sweeper};
use afmsweep::control::{self, MemoryJournal};
use afmsweep::engine::{Cpu, Progress};
use afmsweep::observe::Measured;
use afmsweep::scene::Scene;
use std::path::Path;

/// A frequency sweep up and down without adhesion, the gap at 0.8 of the largest amplitude: contact goes on far beyond the
/// frequency at which the free oscillation no longer reaches the sample, to a fold; on the way down it begins where the free
/// amplitude is the gap.
const BEYOND: System = System {
    modes: &[DAMPED],
    law: "hertz",
    energy: 0.0,
    force: 8.0,
    gap: 16.0,
    curve: ("drive.frequency", KHZ, (298.0, 303.0, 26)),
    jumps: 2,
};
/// A soft lever, of which the free oscillation is 0.3 of what adhesion pulls it down by: the tip snaps in at that gap, and is held far
/// beyond it.
const HELD: System = System {
    modes: &[SOFT],
    law: "jkr",
    energy: 30.0,
    force: 0.00849,
    gap: 5.0,
    curve: (GAP, NM, (3.05, -0.95, 21)),
    jumps: 2,
};
const SOFT: Mode = Mode { stiffness: 0.5, frequency: 300e3, quality: 50.0 };

#[test]
fn contact_lasts_beyond_the_free_amplitude_as_slow_stepping_has_it() {
    agrees(BEYOND);
}

#[test]
fn adhesion_holds_a_soft_lever_beyond_its_free_amplitude_as_slow_stepping_has_it() {
    agrees(HELD);
}

/// At a fold a multiplier reaches 1, as the square root of the way that is left to it. Truth: the integrator, which lets go at the
/// same frequency, and that law.
#[test]
fn contact_beyond_the_free_amplitude_ends_where_a_multiplier_reaches_one() {
    let system = System { curve: ("drive.frequency", KHZ, (300.0, 303.0, 301)), jumps: 1, ..BEYOND };
    let text = system.scene(1e-5).source.replace("\"both\"", "\"forward\"");
    let scene = Scene::parse(Path::new("fold.toml"), &text).expect("it is whole");
    let values = &scene.sweep.axes[0].values;
    let run = run(&scene);
    let jump = run.jumps.iter().position(|jump| *jump).expect("the branch ends");
    let multiplier = |n: usize| run.found.get(n).expect("it is found").floquet.multiplier;
    // (1 - multiplier)^2 falls in a straight line to 0 at the fold.
    let left = |n: usize| (1.0 - multiplier(n)).powi(2);
    let fold = values[jump - 1]
        + (values[jump - 1] - values[jump - 2]) * left(jump - 1) / (left(jump - 2) - left(jump - 1));
    println!("jumps at {} Hz, multiplier {} before, 1 at {fold} Hz", values[jump], multiplier(jump - 1));
    assert!(multiplier(jump - 1) > 0.985 && multiplier(jump) < 0.97);
    assert!(values[jump - 1] <= fold && fold <= values[jump], "{fold}");
    let mut slow = Sweeper::free(system.modes, system.law(), system.place(values[0]));
    // Every tenth point at first: who lets go there already does not take hold again.
    let near = jump.saturating_sub(20);
    let points = (1..values.len()).filter(|n| *n >= near || n % 10 == 0);
    let end = points.into_iter().find(|n| {
        let motion = slow.go(system.place(values[*n])).expect("it settles");
        motion.amplitude < 16e-9
    });
    assert_eq!(end, Some(jump));
}

/// Second states are looked for where the free oscillation does not reach the sample, too. Truth: the integrator, which holds contact
/// on one way and is free on the other.
#[test]
fn second_states_beyond_the_free_amplitude_are_those_of_the_way_that_keeps_contact() {
    for system in [BEYOND, HELD] {
        let (path, (unit, _), (from, to, points)) = system.curve;
        let scene = system.scene(1e-3);
        let (before, _) = scene.source.split_once("[curve]").expect("it has a curve");
        let text = format!(
            "{before}[sweep]\n\"{path}\" = {{ from = \"{from} {unit}\", to = \"{to} {unit}\", points = {points} }}\n\
             [run]\nsteady = \"search\"\nbranches = \"both\"\n[output]\nobservables = [\"amplitude\", \"phase\", \"force_mean\"]"
        );
        let swept = Scene::parse(Path::new("both.toml"), &text).expect("it is whole");
        let truth = system.truth(&scene.sweep.axes[1].values);
        let run = run(&swept);
        let (engine, progress) = (Cpu::default(), Progress::default());
        let shape = swept.sweep.shape();
        let others = control::second_orbits(&run, &shape, &MemoryJournal::default(), &engine, &progress)
            .expect("they are found");
        let motion = |one: &Measured| Motion { amplitude: one.harmonics[0], phase: one.phase };
        let mut second = 0;
        for n in 0..points {
            let [(there, free), (back, _)] = [truth[n], truth[points + n]];
            if there.apart(&back) <= BRANCHES * free {
                continue;
            }
            second += 1;
            let ours = motion(&run.results.get(n).measured);
            let other = others.orbits.iter().find(|one| one.instance as usize == n);
            let other = motion(
                &other.unwrap_or_else(|| panic!("{path}: point {n} has a second state")).finished.measured,
            );
            let off = |a: &Motion, b: &Motion| ours.apart(a).max(other.apart(b)) / free;
            assert!(off(&there, &back).min(off(&back, &there)) < 1e-3, "{path}: point {n}");
        }
        println!("{path}: {second} second states");
        assert!(second > 8, "{second}");
    }
}
