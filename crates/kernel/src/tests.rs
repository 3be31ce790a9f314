//! Lanes against each other: what one instance does alone it does in any register, to the bit.

use super::contact::{Hertz, Interaction, Jkr, RelaxingHertz, ViscousDmt};
use super::pair::Pair;
use super::period::{period, unmeasured_period};
use super::step::{Case, State};
use super::tally::Tally;
use super::x86::{Ymm32, Ymm64, Zmm32, Zmm64};
use super::{FlowMode, HARMONICS, Lane, Lever, Pack, RunSums, Span, Wants, Wave};
use std::f64::consts::TAU;

const STEPS: usize = 96;

/// Lanes that this processor does not have must not be tried.
fn has(instructions: &str) -> bool {
    let avx2 = is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma");
    let avx512 = is_x86_feature_detected!("avx512f")
        && is_x86_feature_detected!("avx512dq")
        && is_x86_feature_detected!("avx512vl");
    if instructions == "avx512" { avx2 && avx512 } else { avx2 }
}

/// Numbers that differ in kind, then some of every size.
fn number(i: usize) -> f64 {
    const KINDS: [f64; 8] =
        [0.0, -0.0, 1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, f64::MIN_POSITIVE, -1e38];
    let part = (i as f64 * 0.618_033_988_749_895).fract() - 0.5;
    *KINDS.get(i).unwrap_or(&(part * 10f64.powi(i as i32 % 13 - 6)))
}

/// Bits of every operation on all pairs and some triples of numbers; a NaN is a NaN.
fn operations<L: Lane>() -> Vec<u64> {
    let count = 40;
    let mut out = Vec::new();
    let mut put = |value: L, i: usize| {
        let value = value.lane(i);
        out.push(if value.is_nan() { f64::NAN.to_bits() } else { value.to_bits() });
    };
    for first in 0..count {
        for second in 0..count {
            // This pair in one lane, others beside it.
            let place = (first * count + second) % L::WIDTH;
            let shifted =
                |from: usize| L::from_lanes(|i| number((from + i + count * L::WIDTH - place) % count));
            let (a, b, c) = (shifted(first), shifted(second), shifted(first + second));
            let less = a.less(b);
            let other = b.less(c);
            let one = |mask: L::Mask| L::select(mask, L::splat(1.0), L::splat(0.0));
            for value in [
                a + b,
                a - b,
                a * b,
                a / b,
                -a,
                a.abs(),
                a.sqrt(),
                a.min(b),
                a.max(b),
                a.mul_add(b, c),
                (-a).mul_add(b, c),
                one(less),
                one(L::both(less, other)),
                one(L::either(less, other)),
                one(L::not(less)),
                L::select(less, a, c),
            ] {
                put(value, place);
            }
        }
    }
    out
}

#[test]
fn every_operation_is_the_same_in_every_register() {
    let (single, double) = (operations::<Pack<f32, 16, true>>(), operations::<Pack<f64, 8, true>>());
    // Rounding twice is another thing: the comparison sees it.
    assert_ne!(single, operations::<f32>());
    assert_ne!(double, operations::<f64>());
    if has("avx2") {
        assert!(single == operations::<Ymm32>() && single == operations::<Pair<Ymm32>>());
        assert!(double == operations::<Ymm64>() && double == operations::<Pair<Ymm64>>());
    }
    if has("avx512") {
        assert!(single == operations::<Zmm32>() && single == operations::<Pair<Zmm32>>());
        assert!(double == operations::<Zmm64>() && double == operations::<Pair<Zmm64>>());
    }
}

#[test]
fn any_sees_each_lane() {
    fn seen<L: Lane>() {
        for place in 0..L::WIDTH {
            let one = L::from_lanes(|i| if i == place { -1.0 } else { 1.0 });
            assert!(L::any(one.less(L::splat(0.0))), "{place} of {}", L::WIDTH);
        }
        assert!(!L::any(L::splat(1.0).less(L::splat(0.0))));
    }
    seen::<Pack<f32, 16, true>>();
    if has("avx2") {
        seen::<Pair<Ymm32>>();
        seen::<Pair<Ymm64>>();
    }
    if has("avx512") {
        seen::<Pair<Zmm32>>();
        seen::<Pair<Zmm64>>();
    }
}

/// Constants of a sample of whose modulus half relaxes, by a 25th a step.
fn relaxing(name: &str) -> Option<f64> {
    let names = ["relaxing", "left", "mean_left", "gain", "mean_gain", "rise_gain", "mean_rise_gain"];
    let values = [0.5, 0.98, 0.99, 0.04, 0.02, 6.7e-5, -3.3e-3];
    names.iter().position(|one| *one == name).map(|place| values[place])
}

/// 32 instances, soft to stiff, from far away to pressed in; the bits of all that is summed.
fn stepped<L: Lane, I: Interaction<L>>() -> Vec<u64> {
    let modes = [(TAU, 0.05, 0.2), (6.27 * TAU, 0.02, 0.8)];
    let modes =
        modes.map(|(omega, damping, share)| FlowMode { omega, damping, share, fast_angle: f64::INFINITY });
    let lever = match I::MEMORY {
        true => Lever::new(&modes[..1], 1.0 / STEPS as f64, 2).remembering(0.02),
        false => Lever::new(&modes, 1.0 / STEPS as f64, 2),
    };
    let waves: Vec<Vec<Wave<L::Element>>> = (1..=HARMONICS)
        .map(|n| {
            let angle = |step: usize| n as f64 * (step as f64 + 0.5) * TAU / STEPS as f64;
            let wave = |a: f64| Wave { cosine: L::element(a.cos()), sine: L::element(a.sin()) };
            (0..STEPS).map(|step| wave(angle(step))).collect()
        })
        .collect();
    let mut out = Vec::new();
    for first in (0..32).step_by(L::WIDTH) {
        let zero = L::splat(0.0);
        let of = |i: usize| {
            let scale = 1e-4 * 1.2f64.powi(((first + i) * 7 % 32) as i32);
            let free = [20.0, 3.0, TAU / STEPS as f64];
            let gap = -2.0 + 0.8 * (first + i) as f64;
            let law = I::FIELDS.iter().map(|field| match *field {
                "stiffness" | "unit_force" => scale,
                "adhesion" => 2.0 * scale,
                "inverse_decay" => 5.0,
                name => relaxing(name).unwrap_or(3.0),
            });
            let motion = lever.motion.iter().copied().chain(free).chain([gap]).chain(law);
            motion.chain(lever.energy.iter().copied()).collect::<Vec<f64>>()
        };
        let columns: Vec<Vec<f64>> = (0..L::WIDTH).map(of).collect();
        let row = |n: usize| columns.iter().map(move |column| L::element(column[n]));
        let rows: Vec<L::Element> = (0..columns[0].len()).flat_map(row).collect();
        let case: Case<L, I, 2> = Case::load(2, &rows);
        let mut state = State { x: [zero; 2], u: [zero; 2], touching: zero };
        let mut alone = state;
        let mut tally = Tally::resume([L::splat(-30.0); 2], zero);
        let mut run_sums = RunSums::new();
        let span =
            Span { waves: &waves, decay: None, wants: Wants::ALL, flights: None, measured: true, periods: 1 };
        for _ in 0..12 {
            period(&case, &mut state, &span, None, &mut tally);
            run_sums.close(&tally, L::splat(STEPS as f64), Some(Wants::ALL));
            tally.next_period();
            unmeasured_period(&case, &mut alone, &waves[0]);
        }
        let numbers = |state: &State<L, 2>| [state.x[0], state.u[0], state.x[1], state.u[1], state.touching];
        for (summed, alone) in numbers(&state).into_iter().zip(numbers(&alone)) {
            let same = |i| summed.lane(i).to_bits() == alone.lane(i).to_bits();
            assert!((0..L::WIDTH).all(same), "without sums it ends elsewhere");
        }
        for i in 0..L::WIDTH {
            let state = [&state.x[0], &state.u[0], &state.x[1], &state.u[1]];
            out.extend(run_sums.numbers().chain(state).map(|value| value.lane(i).to_bits()));
        }
    }
    out
}

/// Truth: registers that are spelt out number by number. Other registers do other operations in
/// `every_operation_is_the_same_in_every_register`, and step under every law in the engine's own tests.
#[test]
fn steps_are_the_same_in_every_register() {
    fn hertz<L: Lane>() -> Vec<u64> {
        stepped::<L, Hertz<L>>()
    }
    // Rounded twice, alone and side by side; rounded once, in registers and two at a time.
    let (single, double) = (hertz::<Pack<f32, 16, true>>(), hertz::<Pack<f64, 8, true>>());
    assert!(hertz::<f32>() == hertz::<Pack<f32, 16, false>>());
    assert!(single != hertz::<f32>() && double != hertz::<f64>(), "nothing was fused");
    if has("avx2") {
        assert!(single == hertz::<Ymm32>() && double == hertz::<Pair<Ymm64>>());
    }
    if has("avx512") {
        assert!(single == hertz::<Pair<Zmm32>>() && double == hertz::<Zmm64>());
    }
}

/// The same of laws that, with Hertz's, have all that laws are made of. Each register more takes seconds to compile.
#[test]
fn steps_of_each_kind_of_law_are_the_same_in_registers() {
    fn laws<L: Lane>() -> [Vec<u64>; 3] {
        [stepped::<L, Jkr<L>>(), stepped::<L, ViscousDmt<L>>(), stepped::<L, RelaxingHertz<L>>()]
    }
    let (double, twice) = (laws::<Pack<f64, 8, true>>(), laws::<f64>());
    assert!(double.iter().zip(&twice).all(|(once, twice)| once != twice), "nothing was fused");
    if has("avx2") {
        assert!(double == laws::<Pair<Ymm64>>());
    }
}
