//! Every law's mean along a piece of path against the static law integrated numerically.

use afmsweep::contact::{self, StaticLaw};
use afmsweep::kernel::contact::{Approach, Dmt, Hertz, Interaction, Jkr, Kick, Tail};
use afmsweep::kernel::{LENGTH, Lane};
use std::f64::consts::PI;

const MODULUS: f64 = 2e9;
const RADIUS: f64 = 1.5e-8;
const WORK: f64 = 0.04;
const DECAY: f64 = 0.25e-9;

/// N to impulse: so weak that a law does not bend its own path.
const SCALE: f64 = 1e-3;

fn hertz<L: Lane>() -> Hertz<L> {
    Hertz { stiffness: L::splat(MODULUS * RADIUS.sqrt() * LENGTH.powf(1.5) * SCALE) }
}

fn dmt<L: Lane>() -> Dmt<L> {
    Dmt {
        contact: hertz(),
        tail: Tail {
            adhesion: L::splat(2.0 * PI * RADIUS * WORK * SCALE),
            inverse_decay: L::splat(LENGTH / DECAY),
        },
    }
}

fn jkr<L: Lane>() -> Jkr<L> {
    let unit = contact::Jkr::new(MODULUS, RADIUS, WORK).indentation_scale();
    Jkr { unit_force: L::splat(PI * WORK * RADIUS * SCALE), inverse_unit: L::splat(LENGTH / unit) }
}

/// Kick of a straight piece from `start` to `end`, nm; force in N.
fn kick<L: Lane + Into<f64>>(law: &impl Interaction<L>, start: f64, end: f64, touching: bool) -> Kick<f64> {
    bent_kick(law, start, end, 0.0, touching)
}

/// The same where the path is a parabola with its sample off the middle of the chord by an eighth of `acceleration`.
fn bent_kick<L: Lane + Into<f64>>(
    law: &impl Interaction<L>,
    start: f64,
    end: f64,
    acceleration: f64,
    touching: bool,
) -> Kick<f64> {
    let approach = Approach {
        indentation: L::splat(0.5 * (start + end) - 0.125 * acceleration),
        speed: L::splat(end - start),
        acceleration: L::splat(acceleration),
        memory: [L::splat(0.0); 2],
    };
    let kick = law.kick(approach, L::splat(if touching { 1.0 } else { 0.0 }));
    Kick {
        impulse: kick.impulse.into() / SCALE,
        shift: kick.shift.into() / SCALE,
        contact: kick.contact.into(),
        touching: kick.touching.into(),
        memory: kick.memory.map(Into::into),
    }
}

/// Mean force, share in contact and contact at the end by the static law and its memory, from
/// `start` to `end` in small steps, each taken at its middle.
fn integrate(law: &dyn StaticLaw, start: f64, end: f64, mut touching: bool) -> (f64, f64, bool) {
    let count = 100_000;
    let (mut force, mut share) = (0.0, 0.0);
    for n in 0..count {
        let delta = (start + (end - start) * (f64::from(n) + 0.5) / f64::from(count)) * LENGTH;
        touching = law.next_contact(delta, touching);
        force += law.force(delta, touching) / f64::from(count);
        share += if touching { 1.0 / f64::from(count) } else { 0.0 };
    }
    (force, share, touching)
}

/// From, to, in contact before: within, without, across, standing, either way, tiny and large; nm.
const PIECES: [(f64, f64, bool); 16] = [
    (0.3, 0.8, true),
    (0.8, 0.3, true),
    (-0.4, 0.7, false),
    (0.7, -0.4, true),
    (-1e-3, 1e-3, false),
    (1e-3, -1e-3, true),
    (-2.0, -0.5, false),
    (-0.5, -2.0, false),
    (0.6, -8.0, true),
    (-8.0, 6.0, false),
    (0.2, 0.2, true),
    (-0.2, -0.2, true),
    (-0.2, -0.2, false),
    (-0.1, -0.9, true),
    (-0.3, -0.35, true),
    (40.0, 41.0, true),
];

fn check<D: Interaction<f64>, S: Interaction<f32>>(
    name: &str,
    laws: (D, S),
    law: &dyn StaticLaw,
    memory: bool,
) {
    let unit = 2.0 * PI * WORK * RADIUS;
    for (start, end, before) in PIECES {
        let before = before && (memory || start > 0.0);
        let (force, share, after) = integrate(law, start, end, before);
        let largest = law.force(start.max(end).max(0.0) * LENGTH, true).abs().max(unit);
        for (kick, bound, what) in [
            (kick(&laws.0, start, end, before), 3e-5, "f64"),
            (kick(&laws.1, start, end, before), 4e-5, "f32"),
        ] {
            let error = (kick.impulse - force).abs() / largest;
            let piece = format!("{name}, {what}, {start} to {end} nm, in contact {before}");
            assert!(error < bound, "{piece}: {:e} N, expected {force:e} N, off by {error:e}", kick.impulse);
            assert!((kick.contact - share).abs() < 5e-5, "{piece}: share {} not {share}", kick.contact);
            assert_eq!(kick.touching > 0.0, after, "{piece}");
        }
    }
}

#[test]
fn means_along_a_path() {
    check("Hertz", (hertz(), hertz()), &contact::Hertz::new(MODULUS, RADIUS), false);
    check("DMT", (dmt(), dmt()), &contact::Dmt::new(MODULUS, RADIUS, WORK, DECAY), false);
    check("JKR", (jkr(), jkr()), &contact::Jkr::new(MODULUS, RADIUS, WORK), true);
}

/// At rest the kick is the static force.
#[test]
fn standing_still() {
    type Standing<'a> = &'a dyn Fn(f64, bool) -> f64;
    let laws: [(&dyn StaticLaw, Standing); 3] = [
        (&contact::Hertz::new(MODULUS, RADIUS), &|d, t| kick(&hertz::<f64>(), d, d, t).impulse),
        (&contact::Dmt::new(MODULUS, RADIUS, WORK, DECAY), &|d, t| kick(&dmt::<f64>(), d, d, t).impulse),
        (&contact::Jkr::new(MODULUS, RADIUS, WORK), &|d, t| kick(&jkr::<f64>(), d, d, t).impulse),
    ];
    for (law, standing) in laws {
        for i in -300..2000 {
            let nm = f64::from(i) * 5e-3 + 1e-4;
            for touching in [false, true] {
                let now = law.next_contact(nm * LENGTH, touching);
                let expected = law.force(nm * LENGTH, now);
                let value = standing(nm, touching);
                let scale = expected.abs().max(2.0 * PI * WORK * RADIUS);
                // What is left is the law bending its own path.
                assert!((value - expected).abs() < 1e-6 * scale, "{nm} nm: {value:e}, static {expected:e}");
            }
        }
    }
}

/// Impulse along a bent path and the shift of the tip, against the static law's force summed over the time of one step:
/// the shift is the first moment less that of a force that changes evenly between the ends, the other way.
fn check_bent(
    name: &str,
    kick: impl Fn(f64, f64, f64, bool) -> Kick<f64>,
    law: &dyn StaticLaw,
    memory: bool,
    bounds: [f64; 2],
) {
    let unit = 2.0 * PI * WORK * RADIUS;
    let mut worst = [0.0f64; 4];
    for (start, end, before) in PIECES {
        let before = before && (memory || start > 0.0);
        for bend in [-0.02, 0.0, 0.05] {
            let acceleration = bend * (end - start).abs();
            let count = 100_000;
            let place =
                |s: f64| 0.5 * (start + end) + (end - start) * s + 0.5 * acceleration * (s * s - 0.25);
            let mut touching = law.next_contact(start * LENGTH, before);
            let first = law.force(start * LENGTH, touching);
            let (mut impulse, mut moment) = (0.0, 0.0);
            for n in 0..count {
                let s = (f64::from(n) + 0.5) / f64::from(count) - 0.5;
                touching = law.next_contact(place(s) * LENGTH, touching);
                let force = law.force(place(s) * LENGTH, touching) / f64::from(count);
                impulse += force;
                moment += force * s;
            }
            let last = law.force(end * LENGTH, law.next_contact(end * LENGTH, touching));
            let shift = (last - first) / 12.0 - moment;
            let scale = first.abs().max(last.abs()).max(unit);
            let got = kick(start, end, acceleration, before);
            let errors = [(got.impulse - impulse).abs() / scale, (got.shift - shift).abs() / scale];
            // What a straight path, and no shift, would be off by.
            let straight = (kick(start, end, 0.0, before).impulse - impulse).abs() / scale;
            let all = [errors[0], errors[1], straight, shift.abs() / scale];
            worst = std::array::from_fn(|n| worst[n].max(all[n]));
        }
    }
    let [impulse, shift, straight, none] = worst;
    println!("{name}: impulse, shift within {impulse:.1e}, {shift:.1e}; without {straight:.1e}, {none:.1e}");
    assert!(worst[0] < bounds[0] && worst[1] < bounds[1], "{name}: {worst:?}");
    let seen = worst[2] > 2.0 * bounds[0] && worst[3] > 2.0 * bounds[1];
    assert!(seen, "{name}: nothing to see, {worst:?}");
}

#[test]
fn impulse_and_first_moment_along_a_bent_path() {
    // Attraction alone: to Hertz's onset, which is smooth enough, no shift belongs.
    let tail = Dmt { contact: Hertz { stiffness: 0.0 }, ..dmt::<f64>() };
    let law = contact::Dmt::new(1e-9, RADIUS, WORK, DECAY);
    check_bent("DMT", |a, b, bend, t| bent_kick(&tail, a, b, bend, t), &law, false, [1e-4, 2e-3]);
    let law = contact::Jkr::new(MODULUS, RADIUS, WORK);
    check_bent("JKR", |a, b, bend, t| bent_kick(&jkr::<f64>(), a, b, bend, t), &law, true, [1e-3, 2e-2]);
}
