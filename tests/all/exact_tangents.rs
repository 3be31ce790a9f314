//! The slope of a drive period by derivatives carried through its kicks: against differences of periods, against the free
//! flow in closed form, and against Liouville's theorem, with every law and number of modes.

use crate::checks::kernel_case::{constants, fewest, modes};
use afmsweep::contact::Law;
use afmsweep::kernel::{
    Lane, MODES_MAX, Real, Room, Rounding, Tangent, Wave, flown, strict_tangent, tangent, tracer,
};
use nalgebra::DMatrix;
use std::f64::consts::TAU;

/// Instances of a law and a number of modes: from a light touch to a deep one, soft to stiff.
const INSTANCES: usize = 12;
/// Periods from rest to where the slope is taken.
const WARM: u32 = 25;
/// Differences are taken this far from a state, and twice and four times as far. The free amplitude is 20.
const STEP: f64 = 2e-5;

fn steps(count: usize) -> usize {
    64 + 16 * count
}

fn waves(steps: usize) -> Vec<Wave<f64>> {
    let at = |step: usize| TAU * (step as f64 + 0.5) / steps as f64;
    (0..steps).map(|step| Wave { cosine: at(step).cos(), sine: at(step).sin() }).collect()
}

/// What a step did, as far as it says on which of the law's branches it was.
type Branch = (bool, bool, bool);

/// One instance of a law.
struct Instance {
    law: Law,
    modes: usize,
    constants: Vec<f64>,
    waves: Vec<Wave<f64>>,
}

impl Instance {
    fn new(law: Law, modes: usize, i: usize) -> Self {
        let steps = steps(modes);
        Self { law, modes, constants: constants(law, modes, modes, steps, i), waves: waves(steps) }
    }

    fn coasted(&self, state: &[f64], periods: u32) -> Vec<f64> {
        let stepper = f64::stepper(Rounding::STRICT, self.law, self.modes).expect("so many modes");
        let mut state = state.to_vec();
        stepper.coast(&self.constants, &mut state, &self.waves, periods);
        state
    }

    fn begin(&self) -> Vec<f64> {
        self.coasted(&vec![0.0; 2 * self.modes + 1], WARM)
    }

    fn branches(&self, state: &[f64]) -> Vec<Branch> {
        let (mut state, mut all) = (state.to_vec(), Vec::new());
        tracer(Rounding::STRICT, self.law)(
            self.modes,
            &self.constants,
            &mut state,
            &self.waves,
            None,
            &mut |step| all.push((step.touching, step.impulse != 0.0, step.shift != 0.0)),
        );
        all
    }

    /// A column of the slope by central differences of three widths, their error taken out to sixth order, and what the last
    /// order changes; none where one of the states takes a step on another branch than the others.
    fn column(&self, state: &[f64], column: usize, here: &[Branch]) -> Option<Vec<(f64, f64)>> {
        let difference = |width: f64| {
            let end = |push: f64| {
                let mut state = state.to_vec();
                state[column] += push;
                (self.branches(&state) == here).then(|| self.coasted(&state, 1))
            };
            let (high, low) = (end(width)?, end(-width)?);
            Some(high.iter().zip(&low).map(|(high, low)| (high - low) / (2.0 * width)).collect::<Vec<f64>>())
        };
        let [one, two, four] = [difference(STEP)?, difference(2.0 * STEP)?, difference(4.0 * STEP)?];
        let better = |near: f64, far: f64, order: f64| near + (near - far) / (order - 1.0);
        let best = |n: usize| {
            let [near, far] = [better(one[n], two[n], 4.0), better(two[n], four[n], 4.0)];
            (better(near, far, 16.0), (near - far).abs())
        };
        Some((0..2 * self.modes).map(best).collect())
    }
}

/// A period by tangents, of one instance in every lane: where it ends, and its slope. It is asked for alone.
fn sloped<E: Lane<Element = E> + Default>(
    tangent: &Tangent<E>,
    one: (&[f64], &[f64], &[Wave<f64>]),
    (modes, least): (usize, f64),
) -> (Vec<f64>, DMatrix<f64>) {
    let (constants, state, waves) = one;
    let spread = |row: &[f64]| -> Vec<E> {
        row.iter().flat_map(|number| std::iter::repeat_n(E::element(*number), tangent.width)).collect()
    };
    let waves: Vec<Wave<E>> = (waves.iter())
        .map(|wave| Wave { cosine: E::element(wave.cosine), sine: E::element(wave.sine) })
        .collect();
    let mut rows = spread(state);
    let mut slope = DMatrix::zeros(2 * modes, 2 * modes);
    let place = |n: usize| if n < modes { n } else { tangent.modes + n - modes };
    tangent.period(&spread(constants), &mut rows, &waves, &[least], &mut Room::default(), |_, all| {
        slope =
            DMatrix::from_fn(2 * modes, 2 * modes, |row, column| all.at(place(row), place(column)).lane(0));
    });
    (rows.chunks(tangent.width).map(|row| row[0].lane(0)).collect(), slope)
}

/// Whether the slope is the same, to the bit, where that of every lane is asked for; the others hold an instance elsewhere.
fn same_beside_others(tangent: &Tangent<f64>, one: (&[f64], &[f64], &[Wave<f64>]), other: &[f64]) -> bool {
    let (constants, state, waves) = one;
    let wide = |row: &[f64], other: &[f64]| -> Vec<f64> {
        let beside = |(own, other): (&f64, &f64)| {
            (0..tangent.width).map(|lane| if lane == 1 { *own } else { *other }).collect::<Vec<_>>()
        };
        row.iter().zip(other).flat_map(beside).collect()
    };
    let size = 2 * tangent.modes;
    let told = |lanes: usize, own: usize, constants: &[f64], state: &[f64]| {
        let (mut state, mut slope) = (state.to_vec(), Vec::new());
        tangent.period(
            constants,
            &mut state,
            waves,
            &vec![1e-6; lanes],
            &mut Room::default(),
            |lane, all| {
                if lane == own {
                    let numbers = (0..size).flat_map(|row| (0..size).map(move |column| (row, column)));
                    slope = numbers.map(|(row, column)| all.at(row, column).to_bits()).collect();
                }
            },
        );
        slope
    };
    let alone = told(1, 0, &wide(constants, constants), &wide(state, state));
    alone == told(tangent.width, 1, &wide(constants, constants), &wide(state, other))
}

fn middle(mut values: Vec<f64>) -> (f64, f64) {
    values.sort_by(f64::total_cmp);
    (values.get(values.len() / 2).copied().unwrap_or(f64::NAN), values.last().copied().unwrap_or(f64::NAN))
}

/// Truth: central differences of three widths with Richardson's extrapolation, as far as that is sure of itself, wherever all
/// seven states take every step of the period on the same branch. The state a period on is the stepper's own, to the bit.
#[test]
fn slopes_are_those_of_differences_with_every_law() {
    slopes_are_those_of_differences(&[1, 2, 4, 8, MODES_MAX]);
}

#[test]
#[ignore = "half a minute; `make test-all` runs it"]
fn slopes_are_those_of_differences_with_every_law_and_number_of_modes() {
    slopes_are_those_of_differences(&(1..=MODES_MAX).collect::<Vec<_>>());
}

fn slopes_are_those_of_differences(numbers_of_modes: &[usize]) {
    println!("law, modes: columns compared, of all; errors in units of the largest entry: median, largest");
    for law in Law::ALL {
        let (mut compared, mut all, mut acting, mut worst) = (0, 0, 0, (0.0f64, 0.0f64));
        let numbers: Vec<usize> =
            numbers_of_modes.iter().copied().filter(|modes| *modes >= fewest(law)).collect();
        for &modes in &numbers {
            let mut errors = Vec::new();
            let exact = tangent(Rounding::STRICT, law, modes).expect("so many modes");
            for i in 0..INSTANCES {
                let one = Instance::new(law, modes, i);
                let state = one.begin();
                let (end, slope) = sloped(&exact, (&one.constants, &state, &one.waves), (modes, 0.0));
                let bits = |row: &[f64]| row.iter().map(|number| number.to_bits()).collect::<Vec<_>>();
                assert_eq!(bits(&end), bits(&one.coasted(&state, 1)), "{law}, {modes} modes, {i}");
                let branches = one.branches(&state);
                acting += u32::from(branches.iter().any(|(_, pushed, _)| *pushed));
                all += 2 * modes;
                for column in 0..2 * modes {
                    let Some(truth) = one.column(&state, column, &branches) else { continue };
                    let scale = slope.abs().max();
                    for (row, (truth, unsure)) in truth.into_iter().enumerate() {
                        let error = (slope[(row, column)] - truth).abs();
                        // The kick of a viscous contact jumps a little where the tip turns within a step, which no step's
                        // record tells; that of a sample that relaxes bends where the contact no longer widens.
                        let times = match law {
                            _ if law.has_memory() => 16.0,
                            _ if law.is_viscous() => 4.0,
                            _ => 1.0,
                        };
                        let unsure = times * unsure;
                        assert!(
                            error < 2e-8 * scale + unsure,
                            "{law}, {modes} modes, {i}: {error:e}, {unsure:e}"
                        );
                        worst.1 = worst.1.max(unsure / scale);
                        errors.push(error / scale);
                    }
                }
            }
            let columns = errors.len() / (2 * modes);
            compared += columns;
            let (median, largest) = middle(errors.clone());
            println!("{law}, {modes}: {} of {}; {median:.1e}, {largest:.1e}", columns, 2 * modes * INSTANCES);
            worst.0 = worst.0.max(largest);
            assert!(median < 1e-9, "{law}, {modes} modes: {median:e}");
        }
        println!(
            "{law}: {compared} columns of {all}, largest error {:.1e}; of the differences {:.1e}",
            worst.0, worst.1
        );
        assert!(compared > all / 2, "{law}: {compared} of {all}");
        let most = (INSTANCES * numbers.len()) as u32;
        assert!(!law.acts() || acting > most / 2, "{law} acts on {acting} of {most} instances");
    }
}

/// Rounding once in place of twice, whole registers, and modes filled up change the slope by rounding; f32 by its own.
#[test]
fn every_lane_tells_the_same_slope() {
    for law in Law::ALL {
        let (mut double, mut single) = (Vec::new(), Vec::new());
        for modes in [1, 2, 3, 4, 5, 7, 8, 12, 24].into_iter().filter(|modes| *modes >= fewest(law)) {
            let strict = tangent(Rounding::STRICT, law, modes).expect("so many modes");
            let fused = tangent(Rounding::new(false), law, modes).expect("so many modes");
            let narrow = strict_tangent(law, modes).expect("so many modes");
            for i in 0..INSTANCES {
                let one = Instance::new(law, modes, i);
                // As f32 holds them, for all.
                let held =
                    |row: &[f64]| row.iter().map(|number| f64::from(*number as f32)).collect::<Vec<f64>>();
                let (own, state) = (held(&one.constants), held(&one.begin()));
                let filled = constants(law, modes, fused.modes, one.waves.len(), i);
                let wide = |row: &[f64]| -> Vec<f64> {
                    let still = vec![0.0; fused.modes - modes];
                    let (x, u) = (&row[..modes], &row[modes..2 * modes]);
                    [x, &still, u, &still, &row[2 * modes..]].concat()
                };
                let truth = sloped(&strict, (&one.constants, &state, &one.waves), (modes, 0.0)).1;
                let scale = truth.abs().max();
                let other = sloped(&fused, (&filled, &wide(&state), &one.waves), (modes, 0.0)).1;
                double.push((other - &truth).abs().max() / scale);
                let elsewhere: Vec<f64> = wide(&state).iter().map(|number| 0.9 * number).collect();
                let given = (&filled[..], &wide(&state)[..], &one.waves[..]);
                let same = fused.width == 1 || same_beside_others(&fused, given, &elsewhere);
                assert!(same, "{law}, {modes} modes, {i}: another slope beside others");
                let truth = sloped(&strict, (&own, &state, &one.waves), (modes, 0.0)).1;
                let other = sloped(&narrow, (&own, &state, &one.waves), (modes, 0.0)).1;
                single.push((other - &truth).abs().max() / scale);
            }
        }
        let (double, single) = (middle(double), middle(single));
        println!(
            "{law}: fused {:.1e}, {:.1e}; f32 {:.1e}, {:.1e} (median, largest)",
            double.0, double.1, single.0, single.1
        );
        assert!(double.0 < 1e-13 && double.1 < 1e-9, "{law}: {double:?}");
        // The impulse of a viscous contact is solved for, which costs a digit.
        let largest = if law.is_viscous() { 1e-3 } else { 1e-4 };
        assert!(single.0 < 1e-5 && single.1 < largest, "{law}: {single:?}");
    }
}

/// Truth: without a sample the slope is the modes' free flow over the period, in closed form.
#[test]
fn without_a_sample_the_slope_is_the_free_flow() {
    for modes in 1..=MODES_MAX {
        let one = Instance::new(Law::None, modes, 0);
        let exact = tangent(Rounding::new(false), Law::None, modes).expect("so many modes");
        let filled = constants(Law::None, modes, exact.modes, one.waves.len(), 0);
        let still = vec![0.0; 2 * exact.modes + 1];
        let (_, slope) = sloped(&exact, (&filled, &still, &one.waves), (modes, 0.0));
        let mut truth = DMatrix::zeros(2 * modes, 2 * modes);
        for (k, mode) in self::modes(modes).iter().enumerate() {
            for (column, unit) in [(k, [1.0, 0.0]), (modes + k, [0.0, 1.0])] {
                let [x, u] = flown(TAU * mode.omega, mode.damping, unit);
                (truth[(k, column)], truth[(modes + k, column)]) = (x, u);
            }
        }
        assert!((slope - truth).abs().max() < 1e-12, "{modes} modes");
    }
}

/// Truth: a force that depends on place alone, with or without jumps at fixed places, leaves the volume of states to the
/// damping (Liouville): the slope's determinant is exp(-2 sum of damping times angular frequency) a radian of the drive, over a
/// period. The scheme is of fourth order, of third where contact begins and ends.
#[test]
fn the_determinant_is_liouvilles() {
    // A viscous sample takes volume, too.
    for law in Law::ALL.into_iter().filter(|law| law.acts() && !law.is_viscous()) {
        for count in [1, 2, 3] {
            let lost: f64 = modes(count).iter().map(|mode| 2.0 * mode.damping * mode.omega).sum();
            let off = |steps: usize| {
                let exact = tangent(Rounding::STRICT, law, count).expect("so many modes");
                let error = |i: usize| {
                    let all = constants(law, count, count, steps, i);
                    let one = Instance { law, modes: count, constants: all, waves: waves(steps) };
                    let state = one.begin();
                    let slope = sloped(&exact, (&one.constants, &state, &one.waves), (count, 0.0)).1;
                    (slope.determinant() / (-TAU * lost).exp() - 1.0).abs()
                };
                middle((0..INSTANCES).map(error).collect()).0
            };
            // Several forces with corners at touch: their error is small from the start, and falls with more steps.
            let few = if law.is_sum() { 512 } else { 256 };
            let [coarse, fine] = [off(few), off(4 * few)];
            println!(
                "{law}, {count} modes: median off by {coarse:.1e} with {few} steps, {fine:.1e} with four times as many"
            );
            assert!(
                fine < 1e-6 || (fine < 1e-4 && fine < 0.1 * coarse),
                "{law}, {count}: {coarse:e}, {fine:e}"
            );
        }
    }
}

/// What is left out changes the slope by no more than about what was allowed.
#[test]
fn steps_left_out_change_the_slope_as_little_as_asked() {
    for modes in [1, 3, 8] {
        let exact = tangent(Rounding::STRICT, Law::Dmt, modes).expect("so many modes");
        for least in [1e-6, 1e-4, 1e-2] {
            let off = |i: usize| {
                let one = Instance::new(Law::Dmt, modes, i);
                let given = (&one.constants[..], &one.begin()[..], &one.waves[..]);
                let all = sloped(&exact, given, (modes, 0.0)).1;
                (sloped(&exact, given, (modes, least)).1 - &all).abs().max() / all.abs().max()
            };
            let largest = (0..INSTANCES).map(off).fold(0.0, f64::max);
            println!("{modes} modes, {least:e} may be left out: {largest:.1e}");
            assert!(largest < 10.0 * least, "{modes}, {least:e}: {largest:e}");
            assert!(least < 1e-5 || largest > 0.0, "{modes}, {least:e}: nothing was left out");
        }
    }
}
