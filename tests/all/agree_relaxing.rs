//! Samples that relax (standard linear solid). Truth: an independent integrator of the two numbers below, a half-space of many
//! elements, closed forms, and the laws of which this one is a limit.

use crate::checks::driven_lever::{DrivenLever, GAP, Measured, RADIUS, Surroundings, WORK, answer};
use afmsweep::Scene;
use afmsweep::contact::{Contact, KernelUnits, Law};
use afmsweep::kernel::LENGTH;
use afmsweep::kernel::contact::{Approach, Interaction, RelaxingHertz};
use afmsweep::scene::{LawChoice, Params, Viscosity};
use std::f64::consts::{PI, TAU};

/// A lever of one or two modes over a sample that relaxes, driven at its tip. SI units.
#[derive(Clone, Copy)]
struct Case {
    beside: Surroundings,
    lever: DrivenLever,
    /// Relaxed modulus, and by how many times of it the one at once is higher.
    modulus: f64,
    ratio: f64,
    /// Relaxation time times the drive's angular frequency.
    time: f64,
}

/// One and two modes, on and off resonance; samples that have recovered at the next tap and that have not.
const CASES: [Case; 6] = [
    case(1, 1.0, 5e8, 0.3, 0.1),
    case(1, 1.0, 5e8, 5.0, 0.5),
    case(2, 1.0, 2e9, 1.0, 0.1),
    case(1, 0.97, 2e7, 5.0, 0.1),
    case(2, 1.03, 3e8, 1.0, 4.0),
    case(1, 1.0, 5e9, 1.0, 0.5),
];

const fn case(modes: usize, detuning: f64, modulus: f64, ratio: f64, time: f64) -> Case {
    let beside = Surroundings { adhesive: false, bias: 0.0 };
    Case { beside, lever: DrivenLever { modes, detuning }, modulus, ratio, time }
}

/// With what acts beside the contact: DMT's attraction, charges, or both.
const BESIDE: [Case; 4] = [
    beside(true, 0.0, case(1, 1.0, 5e8, 0.3, 0.1)),
    beside(true, 0.0, case(2, 1.03, 3e8, 1.0, 4.0)),
    beside(false, 2.0, case(1, 1.0, 1e9, 5.0, 0.5)),
    beside(true, 1.0, case(1, 0.98, 2e9, 1.0, 0.1)),
];

const fn beside(adhesive: bool, bias: f64, case: Case) -> Case {
    Case { beside: Surroundings { adhesive, bias }, ..case }
}

impl Case {
    /// What the scene says of the sample beside its modulus.
    fn relaxation(&self) -> String {
        let (at_once, time) = (self.modulus * (1.0 + self.ratio), self.time / self.lever.omega());
        format!("instantaneous_modulus = \"{at_once} Pa\"\nrelaxation_time = \"{time} s\"")
    }

    fn scene(&self, loss: &str, run: &str) -> Scene {
        let sample =
            format!("youngs_modulus = \"{} Pa\"\nsurface_energy = \"{WORK} J/m^2\"\n{loss}", self.modulus);
        self.lever.scene([&sample, &self.beside.text(""), run])
    }
}

/// The program's answer, at so many steps or at those it chooses.
fn swept(case: &Case, loss: &str, accuracy: f64, steps: Option<u32>) -> Measured {
    let mut scene = case.scene(loss, &format!("accuracy = {accuracy}\nsteady = \"search\""));
    scene.run.steps_per_period = steps;
    answer(scene)
}

/// What the independent program takes the sample for.
#[derive(Clone, Copy)]
enum Sample {
    /// The two numbers of docs/method.md.
    Reduced,
    /// So many springs with dashpots side by side, each of which touches or not (method of dimensionality reduction).
    Elements(usize),
}

/// The independent program: Runge and Kutta's method of fourth order in even steps.
struct Lever {
    case: Case,
    sample: Sample,
    /// N
    drive: f64,
    /// Travel and speed of each mode, integrals of travel times cosine and sine, and of power; then the sample's numbers, in
    /// units of nm.
    state: Vec<f64>,
}

/// Numbers before those of the sample.
const OWN: usize = 7;
/// Roots of nm up to which there are elements.
const WIDEST: f64 = 4.0;

impl Lever {
    fn new(case: Case, sample: Sample) -> Self {
        let numbers = match sample {
            Sample::Reduced => 2,
            Sample::Elements(count) => count,
        };
        Self { case, sample, drive: case.lever.drive(), state: vec![0.0; OWN + numbers] }
    }

    /// Force over its prefactor at an indentation, nm, and the rates of the sample's numbers, per relaxation time.
    fn sample(&self, d: f64, state: &[f64], rates: &mut [f64]) -> f64 {
        let arm = self.case.ratio / (1.0 + self.case.ratio);
        match self.sample {
            Sample::Reduced => {
                let [y, s] = [state[0].max(0.0), state[1].max(0.0)];
                let force = match (d - arm * y).max(0.0) {
                    0.0 => 0.0,
                    _ if d * y * y >= s * s => (d.powf(1.5) - arm * s).max(0.0),
                    above => {
                        let room = (1.0 - arm * y.powi(3) / (s * s)).max((0.5 * (1.0 - arm)).min(0.1));
                        above.powf(1.5) / room.sqrt()
                    }
                };
                (rates[0], rates[1]) = (d.max(arm * y) - y, force - (1.0 - arm) * s);
                force
            }
            Sample::Elements(count) => {
                let width = WIDEST / count as f64;
                let mut force = 0.0;
                for (n, (c, rate)) in state.iter().zip(rates).enumerate() {
                    let place = (n as f64 + 0.5) * width;
                    let u = (d - place * place).max(arm * c);
                    force += u - arm * c;
                    *rate = u - c;
                }
                1.5 * width * force
            }
        }
    }

    /// The state's rates, and the force, N.
    fn rates(&self, time: f64, state: &[f64]) -> (Vec<f64>, f64) {
        let mut rates = vec![0.0; state.len()];
        let indentation = -(GAP + state[0] + state[2]);
        let force = self.sample(indentation / 1e-9, &state[OWN..], &mut rates[OWN..]);
        rates[OWN..].iter_mut().for_each(|rate| *rate *= self.case.lever.omega() / self.case.time);
        let at_once = self.case.modulus * (1.0 + self.case.ratio);
        let force = 4.0 / 3.0 * at_once / (1.0 - 0.09) * RADIUS.sqrt() * 1e-9f64.powf(1.5) * force;
        let force = force + self.case.beside.force((-indentation).max(0.0));
        self.case.lever.rates(time, state, (force, self.drive), &mut rates);
        (rates, force)
    }

    /// The steady state after so many periods. The transient falls by a third or more in each.
    fn steady(mut self, periods: usize, steps: usize) -> Measured {
        let h = TAU / self.case.lever.omega() / steps as f64;
        let mut forces = [f64::NEG_INFINITY, f64::INFINITY];
        for _ in 0..periods {
            self.state[4..OWN].fill(0.0);
            forces = [f64::NEG_INFINITY, f64::INFINITY];
            for n in 0..steps {
                let time = n as f64 * h;
                let moved = |by: &[f64], share: f64| -> Vec<f64> {
                    self.state.iter().zip(by).map(|(value, by)| value + share * h * by).collect()
                };
                let (a, force) = self.rates(time, &self.state);
                let b = self.rates(time + 0.5 * h, &moved(&a, 0.5)).0;
                let c = self.rates(time + 0.5 * h, &moved(&b, 0.5)).0;
                let d = self.rates(time + h, &moved(&c, 1.0)).0;
                let sum = |n: usize| h / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]);
                forces = [forces[0].max(force), forces[1].min(force)];
                self.state = (0..self.state.len()).map(|n| self.state[n] + sum(n)).collect();
            }
        }
        self.case.lever.measured(&self.state, forces)
    }
}

/// At the steps that the plan chooses the errors are within the accuracy; at 4,096 steps within 1e-6 of their scales.
#[test]
fn agree_with_an_independent_integrator() {
    for (n, case) in CASES.into_iter().chain(BESIDE).enumerate() {
        // What has not recovered at the next tap settles slowly.
        let periods = if case.time > 1.0 { 150 } else { 75 };
        let truth = Lever::new(case, Sample::Reduced).steady(periods, 12_000);
        let largest = truth[3].max(-truth[4]);
        let scales = [1.0, 1.0, truth[2].max(1.0), largest, largest];
        for (accuracy, steps, bound) in [(1e-3, None, 1e-3f64), (1e-4, None, 1e-4), (1e-3, Some(4096), 1e-6)]
        {
            let ours = swept(&case, &case.relaxation(), accuracy, steps);
            println!(
                "case {n}, asked for {accuracy:e}, steps {steps:?}: amplitude {:.1e}, phase {:.1e}, loss {:.1e} of itself, force {:.1e}",
                ours[0] - truth[0],
                ours[1] - truth[1],
                ours[2] / truth[2] - 1.0,
                ours[3] / truth[3] - 1.0,
            );
            for (what, ((a, b), scale)) in ours.iter().zip(&truth).zip(scales).enumerate() {
                // The independent program looks for the largest force among its steps only, and the plan's steps see that at an
                // onset to twice the accuracy.
                let bound = if what == 3 { (2.0 * bound).max(2e-5) } else { bound };
                let off = (a - b).abs() / scale;
                assert!(off <= bound, "case {n}, {accuracy:e}, {steps:?}: number {what} is off by {off:e}");
            }
        }
    }
}

/// Two numbers stand for the whole half-space: within the bounds that docs/model.md states. Those of the first cases are closer.
#[test]
fn agree_with_a_half_space_of_many_elements() {
    let mut cases = CASES.to_vec();
    for modulus in [2e7, 5e8, 5e9] {
        for ratio in [0.3, 1.0, 5.0] {
            cases.extend([0.02, 0.3, 4.0].map(|time| case(1, 1.0, modulus, ratio, time)));
        }
    }
    // At once twenty times as stiff.
    cases.extend([0.3, 4.0].map(|time| case(1, 1.0, 5e8, 19.0, time)));
    for (n, case) in cases.into_iter().enumerate() {
        let first = n < CASES.len();
        let periods = if first || case.time > 1.0 { 60 } else { 40 };
        let truth = Lever::new(case, Sample::Elements(240)).steady(periods, 1500);
        let ours = swept(&case, &case.relaxation(), 1e-4, None);
        let (loss, force) = (ours[2] / truth[2] - 1.0, ours[3] / truth[3] - 1.0);
        println!(
            "case {n} ({:e} Pa, ratio {}, time {}): amplitude {:.1e}, phase {:.1e}, loss {loss:.1e}, force {force:.1e}",
            case.modulus,
            case.ratio,
            case.time,
            ours[0] - truth[0],
            ours[1] - truth[1]
        );
        let (turn, lost) = if first { (1.2e-3, 0.02) } else { (2e-3, 0.022) };
        let pushed = if case.ratio > 5.0 { 1.2e-2 } else { 5e-3 };
        assert!((ours[0] - truth[0]).abs() < 6e-4 && (ours[1] - truth[1]).abs() < turn, "case {n}");
        assert!(loss.abs() < lost && force.abs() < pushed, "case {n}: {loss}, {force}");
    }
}

fn contact(viscosity: Viscosity) -> Contact {
    let mut params = Params::default();
    params.sample.youngs_modulus = 1e9;
    params.sample.viscosity = viscosity;
    params.contact.law = LawChoice::Hertz;
    Contact::new(&params)
}

/// With one modulus the sample is elastic: the same law, so that every engine gives the same bits.
#[test]
fn exact_elastic_limit_is_the_elastic_law_itself() {
    assert_eq!(contact(Viscosity::Relaxing { modulus: 1e9, time: 1e-6 }), contact(Viscosity::None));
    assert_eq!(contact(Viscosity::Relaxing { modulus: 2e9, time: 1e-6 }).law, Law::RelaxingHertz);
}

/// A fast sample has the relaxed modulus, a slow one that at once: nothing of the first taps is remembered.
#[test]
fn agree_with_elastic_samples_in_both_limits() {
    let of = |case: Case, loss: &str, run: &str| answer(case.scene(loss, run));
    let near = |a: Measured, b: Measured, bound: f64| {
        let off = [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] / b[3] - 1.0];
        assert!(off.iter().all(|off| off.abs() < bound), "{off:?}");
    };
    let steps = "steps_per_period = 4096\nperiods = 60\nmeasure = 5\nsteady = \"wait\"";
    let fast = case(1, 1.0, 5e8, 1.0, 5e-4);
    near(of(fast, &fast.relaxation(), steps), of(fast, "", steps), 3e-3);
    let slow = case(1, 1.0, 5e8, 1.0, 1e7);
    let stiff = Case { modulus: 1e9, ..slow };
    near(of(slow, &slow.relaxation(), steps), of(stiff, "", steps), 1e-5);
}

/// Much stiffer at once than relaxed, the sample is Kelvin and Voigt's of the same retardation time, up to a part that falls
/// with the ratio of the moduli.
#[test]
fn agree_with_kelvin_and_voigts_sample_in_the_limit() {
    let tangent = 0.1;
    let off = [10.0, 30.0].map(|ratio| {
        let case = case(1, 1.0, 5e8, ratio, tangent / (1.0 + ratio));
        let viscous = swept(&case, &format!("loss_tangent = {tangent}"), 1e-3, Some(8192));
        let ours = swept(&case, &case.relaxation(), 1e-3, Some(8192));
        println!("ratio {ratio}: {ours:?} for {viscous:?}");
        (ours[2] / viscous[2] - 1.0).abs() + (ours[1] - viscous[1]).abs()
    });
    assert!(off[0] < 0.1 && off[1] < 0.5 * off[0], "{off:?}");
}

/// Small swings about a depth that has been held: the loss of a period is pi b^2 1.5 K sqrt(R d) w t/(1 + (w t)^2) times the
/// share of the modulus K at once that relaxes.
#[test]
fn exact_loss_of_small_swings_is_that_of_the_solid() {
    let (depth, swing, steps) = (3.0f64, 1e-4, 512);
    let step = TAU / f64::from(steps);
    for (time, modulus) in [(0.1, 3e9), (1.0, 3e9), (5.0, 3e9), (0.1, 30e9), (1.0, 30e9)] {
        let contact = contact(Viscosity::Relaxing { modulus, time });
        // Radians for seconds: the step's impulse is the force.
        let all = contact.law().constants(KernelUnits { impulse: LENGTH.powf(-1.5), step });
        let mut numbers = all.iter();
        let law = RelaxingHertz::<f64>::from_numbers(|| *numbers.next().unwrap());
        let left = all[2];
        let mut memory = [depth, depth.powf(1.5)];
        let mut loss = 0.0;
        for n in 0..40 * steps {
            let angle = step * (f64::from(n) + 0.5);
            let speed = swing * step * angle.cos();
            // No force of the sample's moves this tip: its impulse is a millionth.
            let at = Approach {
                indentation: depth + swing * angle.sin(),
                speed,
                acceleration: -swing * step * step * angle.sin(),
                memory,
            };
            let kick = RelaxingHertz { hertz: afmsweep::kernel::contact::Hertz { stiffness: 1e-9 }, ..law }
                .kick(at, 1.0);
            memory = [0, 1].map(|n| left * memory[n] + kick.memory[n]);
            if n >= 39 * steps {
                loss += kick.impulse / 1e-9 * speed;
            }
        }
        let arm = 1.0 - contact.modulus / contact.instantaneous;
        let relaxation = contact.retardation * contact.modulus / contact.instantaneous;
        let exact =
            PI * swing * swing * 1.5 * depth.sqrt() * arm * relaxation / (1.0 + relaxation * relaxation);
        assert!((loss / exact - 1.0).abs() < 2e-3, "{time}: {loss:e} for {exact:e}");
    }
}

/// A distribution may hold a relaxed modulus above the one at once, which no single line of the scene shows.
#[test]
fn refusals_of_a_drawn_sample_that_stiffens_come_before_the_run() {
    let text = r#"
        [instrument.cantilever]
        modes = [{ stiffness = "26 N/m", frequency = "300 kHz", quality_factor = 100 }]
        [sample]
        instantaneous_modulus = "2 GPa"
        relaxation_time = "1 us"
        [contact]
        law = "hertz"
        [drive]
        on = "tip"
        frequency = "300 kHz"
        free_amplitude = "20 nm"
        [approach]
        gap = "15 nm"
        [uncertain]
        "sample.youngs_modulus" = { distribution = "uniform", from = "1 GPa", to = "2.5 GPa" }
        [design]
        kind = "sobol"
        samples = 16
        seed = 1
    "#;
    let error = Scene::parse("drawn.toml".as_ref(), text).expect_err("some sample stiffens");
    let told = error.to_string();
    assert!(told.contains("cannot stiffen as it relaxes"), "{told}");
}
