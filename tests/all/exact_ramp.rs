//! Static approach and retraction under a lever's own stiffness against closed forms: where and at which force the tip snaps
//! in and lets go, and what the cycle loses.

use crate::program::Desk;
use afmsweep::contact::{Contact, Jump, Ramp};
use afmsweep::scene::{Adhesion, LawChoice, NeckModel, OutsideForce, Params};
use std::f64::consts::PI;

const RADIUS: f64 = 10e-9;
const WORK: f64 = 0.05;
const DECAY: f64 = 0.3e-9;

fn contact(law: LawChoice) -> Contact {
    let mut params = Params::default();
    params.contact.law = law;
    params.contact.decay_length = DECAY;
    params.instrument.tip.radius = RADIUS;
    params.sample.youngs_modulus = 1e9;
    params.sample.adhesion = Adhesion::Work(WORK);
    Contact::new(&params)
}

/// Pull at touch (N) of a liquid neck, and where it forms and breaks (m).
const NECK: [f64; 3] = [8e-9, 1e-9, 4e-9];

fn necked() -> Contact {
    let [strength, forms_at, breaks_at] = NECK;
    let mut params = Params::default();
    params.contact.law = LawChoice::Hertz;
    params.instrument.tip.radius = RADIUS;
    params.sample.youngs_modulus = 1e9;
    params.sample.adhesion = Adhesion::Work(0.0);
    let (decay_length, model) = (None, NeckModel::InverseSquare);
    params.contact.outside =
        vec![OutsideForce::Capillary { strength, forms_at, breaks_at, decay_length, model }];
    Contact::new(&params)
}

fn close(ours: f64, truth: f64, scale: f64) {
    assert!((ours - truth).abs() <= 1e-9 * scale.abs(), "{ours:e} {truth:e}");
}

/// DMT's attraction -2 pi R w D0^2/(D0 - delta)^2 pulls harder than the lever from (D0 - delta)^3 = 4 pi R w D0^2/k on, and
/// lets go of the tip at the surface with 2 pi R w.
#[test]
fn dmt_snaps_in_and_lets_go_where_its_closed_forms_say() {
    let pull = 2.0 * PI * RADIUS * WORK;
    for stiffness in [0.1, 1.0, 10.0] {
        let Ramp { snap_in, pull_off, .. } = contact(LawChoice::Dmt).ramp(stiffness);
        let (Some(snap), Some(off)) = (snap_in, pull_off) else { panic!("{stiffness} N/m is soft") };
        let apart = (2.0 * pull * DECAY * DECAY / stiffness).cbrt();
        let force = -pull * (DECAY / apart).powi(2);
        close(snap.force_n[0], force, force);
        close(snap.base_position_m, apart - DECAY - force / stiffness, apart);
        close(off.force_n[0], -pull, pull);
        close(off.base_position_m, pull / stiffness, pull / stiffness);
        // The other ends are states of the same lever at the same base.
        for Jump { base_position_m, force_n, indentation_m } in [snap, off] {
            for n in [0, 1] {
                close(-indentation_m[n] - force_n[n] / stiffness, base_position_m, pull / stiffness);
            }
        }
    }
    // 4 pi R w/D0 = 20.9 N/m: a stiffer lever goes through the attraction smoothly.
    let stiff = contact(LawChoice::Dmt).ramp(25.0);
    assert!(stiff.snap_in.is_none() && stiff.pull_off.is_none() && stiff.loss_j == 0.0);
}

/// By the square root b of the contact radius: f = K b^6/R - sqrt(6 pi w K) b^3, delta = b^4/R - (2/3) sqrt(6 pi w/K) b. The
/// tip lets go where df/db = -k d delta/db, found here by halving in b alone.
#[test]
fn jkr_snaps_in_at_the_surface_and_lets_go_where_its_parametric_form_says() {
    let contact = contact(LawChoice::Jkr);
    let k = contact.modulus;
    let (pull, dip) = ((6.0 * PI * WORK * k).sqrt(), (6.0 * PI * WORK / k).sqrt() * 2.0 / 3.0);
    let force = |b: f64| k * b.powi(6) / RADIUS - pull * b.powi(3);
    let delta = |b: f64| b.powi(4) / RADIUS - dip * b;
    for stiffness in [0.1, 1.0, 10.0, 1000.0] {
        let slope = |b: f64| {
            6.0 * k * b.powi(5) / RADIUS - 3.0 * pull * b * b + stiffness * (4.0 * b.powi(3) / RADIUS - dip)
        };
        let (mut low, mut high) = ((dip * RADIUS / 4.0).cbrt(), 1e-3);
        for _ in 0..200 {
            let middle = 0.5 * (low + high);
            if slope(middle) > 0.0 { high = middle } else { low = middle }
        }
        let ramp = contact.ramp(stiffness);
        let (Some(snap), Some(off)) = (ramp.snap_in, ramp.pull_off) else {
            panic!("JKR jumps under any lever")
        };
        assert_eq!((snap.base_position_m, snap.force_n[0]), (0.0, 0.0));
        let truth = (force(high), -delta(high) - force(high) / stiffness);
        close(off.force_n[0], truth.0, truth.0);
        close(off.base_position_m, truth.1, truth.1.abs() + delta(high).abs());
        assert_eq!(off.force_n[1], 0.0);
    }
    // Under a lever far softer than the contact the force at letting go is 3/2 pi w R.
    let Some(off) = contact.ramp(1e-9).pull_off else { panic!("JKR jumps under any lever") };
    close(off.force_n[0], -1.5 * PI * WORK * RADIUS, PI * WORK * RADIUS);
}

/// Truth: under a stiff lever the tip stands where the base does, and the cycle loses what a neck takes: the integral of its
/// force from where it forms to where it breaks. Under a soft one each jump still conserves the base.
#[test]
fn a_neck_forms_and_breaks_where_it_should_and_takes_its_work() {
    let [strength, forms_at, breaks_at] = NECK;
    let contact = necked();
    let force = |d: f64| -strength / (1.0 + d / forms_at).powi(2);
    let Ramp { snap_in, pull_off, loss_j, .. } = contact.ramp(1e5);
    let (Some(snap), Some(off)) = (snap_in, pull_off) else { panic!("a neck jumps under any lever") };
    close(snap.base_position_m, forms_at, forms_at);
    close(off.base_position_m, breaks_at - force(breaks_at) / 1e5, breaks_at);
    assert!((snap.force_n[1] / force(forms_at) - 1.0).abs() < 1e-3 && off.force_n[1] == 0.0);
    let work = strength * forms_at * (0.5 - 1.0 / (1.0 + breaks_at / forms_at));
    assert!((loss_j / work - 1.0).abs() < 1e-2, "{loss_j:e} {work:e}");
    for stiffness in [0.05, 0.5, 5.0] {
        let ramp = contact.ramp(stiffness);
        for Jump { base_position_m, force_n, indentation_m } in
            [ramp.snap_in, ramp.pull_off].into_iter().flatten()
        {
            for n in [0, 1] {
                close(-indentation_m[n] - force_n[n] / stiffness, base_position_m, strength / stiffness);
            }
        }
    }
}

/// Area between the two ways over the base, by trapezes; at a jump the base stands still.
#[test]
fn the_area_of_the_loop_is_the_loss() {
    for contact in [contact(LawChoice::Dmt), contact(LawChoice::Jkr), necked()] {
        for stiffness in [0.5, 5.0] {
            let (law, ramp) = (contact.law, contact.ramp(stiffness));
            let work = |n: usize| -> f64 {
                let (base, force) = (&ramp.curves[n].base_position_m, &ramp.curves[n].force_n);
                let pieces = base.windows(2).zip(force.windows(2));
                pieces.map(|(z, f)| 0.5 * (f[0] + f[1]) * (z[1] - z[0])).sum()
            };
            // Both ways end where the other begins.
            let [there, back] = &ramp.curves;
            assert_eq!(there.indentation_m.first(), back.indentation_m.last());
            assert_eq!(there.indentation_m.last(), back.indentation_m.first());
            let area = -(work(0) + work(1));
            assert!(
                (area / ramp.loss_j - 1.0).abs() < 2e-3,
                "{law:?} {stiffness}: {area:e} {:e}",
                ramp.loss_j
            );
        }
    }
}

#[test]
fn cli_the_command_tells_jumps_by_their_names_and_units() {
    let desk = Desk::new();
    let scene = "[instrument.cantilever]\nstiffness = \"0.5 N/m\"\nfrequency = \"30 kHz\"\n[instrument.tip]\nradius = \"10 nm\"\n[sample]\nyoungs_modulus = \"1 GPa\"\nsurface_energy = \"50 mJ/m^2\"\n[contact]\nlaw = \"dmt\"\n[drive]\nfree_amplitude = \"1 nm\"\n";
    let path = desk.write("ramp.toml", scene);
    let file = path.to_str().unwrap();
    let said = desk.works(&["force", file, "--lever"]).out;
    for word in [
        "snap-in: base at",
        "pull-off: base at",
        "loss in a cycle:",
        "approach",
        "retract",
        "base position/nm",
    ] {
        assert!(said.contains(word), "{word}: {said}");
    }
    let json = desk.json(&["force", file, "--lever", "--json"]);
    // A beam's first mode is lambda^4/12 times as stiff as all modes together.
    let stiffness = json["stiffness_n_per_m"].as_f64().unwrap();
    let beam = 0.5 / (1.875_104_068_711_961_f64.powi(4) / 12.0);
    assert!((stiffness / beam - 1.0).abs() < 1e-8, "{stiffness} {beam}");
    let pull = 2.0 * PI * RADIUS * WORK;
    assert!((json["pull_off"]["force_n"][0].as_f64().unwrap() / -pull - 1.0).abs() < 1e-9);
    assert!((json["pull_off"]["base_position_m"].as_f64().unwrap() * stiffness / pull - 1.0).abs() < 1e-9);
    assert_eq!(json["snap_in"]["force_n"].as_array().unwrap().len(), 2);
}
