//! Viscous samples. Truth: an independent integrator below, closed forms of the loss, the elastic laws.

use crate::checks::driven_lever::{
    DrivenLever, FREQUENCY, GAP, Measured, RADIUS, Surroundings, WORK, answer,
};
use afmsweep::Scene;
use afmsweep::contact::{Contact, Law};
use afmsweep::scene::{DriveFrequency, LawChoice, Params, Viscosity, ViscosityModel};
use std::f64::consts::{PI, TAU};

/// A lever of one or two modes over a viscous sample, driven at its tip. SI units.
#[derive(Clone, Copy)]
struct Case {
    beside: Surroundings,
    ad_hoc: bool,
    lever: DrivenLever,
    /// Retardation time times the drive's angular frequency.
    loss_tangent: f64,
    modulus: f64,
}

const HERTZ: Surroundings = Surroundings { adhesive: false, bias: 0.0 };
const DMT: Surroundings = Surroundings { adhesive: true, bias: 0.0 };

/// Both laws and forms, one and two modes, on and off resonance, from hardly viscous to strongly; and charged tips.
const CASES: [Case; 11] = [
    case(HERTZ, false, 1, 1.0, 0.01, 1e9),
    case(HERTZ, false, 2, 1.0, 0.1, 2e9),
    case(HERTZ, false, 1, 0.97, 5.0, 5e7),
    case(DMT, false, 1, 1.0, 0.05, 1e9),
    case(DMT, false, 2, 1.03, 0.5, 3e8),
    case(HERTZ, true, 1, 1.0, 0.1, 1e9),
    case(DMT, true, 2, 1.0, 0.05, 1e9),
    case(DMT, true, 1, 0.97, 1.0, 1e8),
    charged(2.0, case(HERTZ, false, 1, 1.0, 0.1, 1e9)),
    charged(1.0, case(DMT, false, 2, 0.98, 0.5, 5e8)),
    charged(2.0, case(DMT, true, 1, 1.0, 0.1, 1e9)),
];

const fn charged(bias: f64, case: Case) -> Case {
    Case { beside: Surroundings { bias, ..case.beside }, ..case }
}

const fn case(
    beside: Surroundings,
    ad_hoc: bool,
    modes: usize,
    detuning: f64,
    loss_tangent: f64,
    modulus: f64,
) -> Case {
    Case { beside, ad_hoc, lever: DrivenLever { modes, detuning }, loss_tangent, modulus }
}

impl Case {
    fn text(&self, accuracy: f64) -> String {
        let sample = format!(
            "youngs_modulus = \"{} Pa\"\nsurface_energy = \"{WORK} J/m^2\"\nloss_tangent = {}",
            self.modulus, self.loss_tangent
        );
        let form = if self.ad_hoc { "ad-hoc" } else { "kelvin-voigt" };
        let contact = self.beside.text(&format!("viscosity_model = \"{form}\""));
        self.lever.text([&sample, &contact, &format!("accuracy = {accuracy}\nsteady = \"search\"")])
    }
}

/// The program's answer, at so many steps or at those it chooses.
fn swept(case: &Case, accuracy: f64, steps: Option<u32>) -> Measured {
    let mut scene = Scene::parse("viscous.toml".as_ref(), &case.text(accuracy)).unwrap();
    scene.run.steps_per_period = steps;
    answer(scene)
}

/// The independent program: Runge and Kutta's method of fourth order in uneven steps that end where the tip meets the
/// surface, and after first touch grow from tiny ones, since the viscous force begins as a root.
struct Lever {
    case: Case,
    /// N
    drive: f64,
    /// Whether the tip is below the surface.
    inside: bool,
    /// Travel and speed of each mode, then integrals of travel times cosine and sine, and of power.
    state: [f64; 7],
    forces: [f64; 2],
}

impl Lever {
    fn new(case: Case) -> Self {
        Self { case, drive: case.lever.drive(), inside: false, state: [0.0; 7], forces: [0.0; 2] }
    }

    /// Force at an indentation and its rate: Ting's, or the ad hoc one, and DMT's attraction.
    fn force(&self, d: f64, v: f64) -> f64 {
        let kappa = 4.0 / 3.0 * self.case.modulus / (1.0 - 0.09) * RADIUS.sqrt();
        let tau = self.case.loss_tangent / self.case.lever.omega();
        let beside = self.case.beside;
        if !self.inside {
            return beside.force((-d).max(0.0));
        }
        let d = d.max(0.0);
        let contact = match v < 0.0 && !self.case.ad_hoc {
            true => kappa * (d + tau * v).max(0.0).powf(1.5),
            false => kappa * (d.powf(1.5) + 1.5 * tau * d.sqrt() * v),
        };
        contact + beside.force(0.0)
    }

    fn indentation(&self, state: &[f64; 7]) -> (f64, f64) {
        (-(GAP + state[0] + state[2]), -(state[1] + state[3]))
    }

    fn rates(&self, time: f64, state: &[f64; 7]) -> [f64; 7] {
        let (d, v) = self.indentation(state);
        let mut rates = [0.0; 7];
        self.case.lever.rates(time, state, (self.force(d, v), self.drive), &mut rates);
        rates
    }

    fn stepped(&self, time: f64, h: f64) -> [f64; 7] {
        let moved = |by: &[f64; 7], share: f64| std::array::from_fn(|n| self.state[n] + share * h * by[n]);
        let a = self.rates(time, &self.state);
        let b = self.rates(time + 0.5 * h, &moved(&a, 0.5));
        let c = self.rates(time + 0.5 * h, &moved(&b, 0.5));
        let d = self.rates(time + h, &moved(&c, 1.0));
        std::array::from_fn(|n| self.state[n] + h / 6.0 * (a[n] + 2.0 * b[n] + 2.0 * c[n] + d[n]))
    }

    /// One period in about so many steps.
    fn period(&mut self, steps: usize) {
        let period = 1.0 / self.case.lever.frequency();
        let longest = period / steps as f64;
        let (mut time, mut h) = (0.0, longest);
        self.state[4..].fill(0.0);
        self.forces = [f64::NEG_INFINITY, f64::INFINITY];
        while time < period {
            // Under the ad hoc form the force ends as a root, too.
            let (d, v) = self.indentation(&self.state);
            let ends = if self.inside && v < 0.0 { (-0.1 * d / v).max(1e-6 * longest) } else { longest };
            let mut next = h.min(ends).min(period - time);
            let beyond = |state: &[f64; 7]| (self.indentation(state).0 > 0.0) != self.inside;
            let mut end = self.stepped(time, next);
            h = (1.3 * h).min(longest);
            if beyond(&end) {
                let (mut low, mut high) = (0.0, next);
                for _ in 0..60 {
                    let middle = 0.5 * (low + high);
                    if beyond(&self.stepped(time, middle)) { high = middle } else { low = middle }
                }
                (next, end) = (high, self.stepped(time, high));
                self.inside = !self.inside;
                h = 1e-6 * longest;
            }
            self.state = end;
            time = if next < period - time { time + next } else { period };
            let (d, v) = self.indentation(&self.state);
            let force = self.force(d, v);
            self.forces = [self.forces[0].max(force), self.forces[1].min(force)];
        }
    }

    /// In the steady state. The transient falls by a third in each period.
    fn steady(mut self) -> Measured {
        let steps = 6000;
        for _ in 0..75 {
            self.period(steps);
        }
        self.case.lever.measured(&self.state, self.forces)
    }
}

/// At the steps that the plan chooses the errors are within the accuracy, of forces within twice as much; at 8,192 steps within
/// 1e-7 of their scales.
#[test]
fn agree_with_an_independent_integrator() {
    for (n, case) in CASES.into_iter().enumerate() {
        let truth = Lever::new(case).steady();
        let scales = [1.0, 1.0, truth[2].max(1.0), truth[3].max(-truth[4]), truth[3].max(-truth[4])];
        for (accuracy, steps, bound) in
            [(1e-3, None, 1e-3f64), (1e-4, None, 1e-4), (1e-3, Some(128), 1e-3), (1e-3, Some(8192), 1e-7)]
        {
            let ours = swept(&case, accuracy, steps);
            let loss = ours[2] / truth[2] - 1.0;
            println!(
                "case {n}, asked for {accuracy:e}, steps {steps:?}: amplitude {:.1e}, phase {:.1e}, loss {loss:.1e} of itself",
                ours[0] - truth[0],
                ours[1] - truth[1]
            );
            for (what, ((a, b), scale)) in ours.iter().zip(&truth).zip(scales).enumerate() {
                // The independent program looks for extreme forces among its steps only, and at the onset of a strongly viscous
                // contact the plan's steps see them to twice the accuracy (1.1e-3 for 1e-3 in case 2).
                let bound = if what > 2 { (2.0 * bound).max(1e-5) } else { bound };
                let off = (a - b).abs() / scale;
                assert!(off <= bound, "case {n}, {accuracy:e}, {steps:?}: number {what} is off by {off:e}");
            }
        }
    }
}

fn params(law: LawChoice, viscosity: Viscosity, model: ViscosityModel) -> Params {
    let mut params = Params::default();
    params.sample.youngs_modulus = 1e9;
    params.sample.viscosity = viscosity;
    (params.contact.law, params.contact.viscosity_model) = (law, model);
    params.drive.frequency = DriveFrequency::Hertz(FREQUENCY);
    params
}

/// Small swings about a depth that is held: the loss of a period is pi c sqrt(d) w b^2, c = 1.5 K sqrt(R) tau.
#[test]
fn exact_loss_of_small_swings_is_that_of_a_dashpot() {
    let (tau, depth, swing, omega) = (2e-8, 1e-9, 1e-14, TAU * FREQUENCY);
    for law in [LawChoice::Hertz, LawChoice::Dmt] {
        for model in [ViscosityModel::KelvinVoigt, ViscosityModel::AdHoc] {
            let contact = Contact::new(&params(law, Viscosity::RetardationTime(tau), model));
            let steps = 1000;
            let loss: f64 = (0..steps)
                .map(|n| {
                    let angle = TAU * f64::from(n) / f64::from(steps);
                    let (d, v) = (depth + swing * angle.sin(), swing * omega * angle.cos());
                    contact.force_moving(d, v, true) * v / (FREQUENCY * f64::from(steps))
                })
                .sum();
            let exact = PI
                * 1.5
                * contact.modulus
                * contact.radius.sqrt()
                * tau
                * depth.sqrt()
                * omega
                * swing
                * swing;
            assert!((loss / exact - 1.0).abs() < 1e-6, "{law:?}, {model:?}: {loss:e} for {exact:e}");
        }
    }
}

/// The three ways to say it are one: eta/G = 2 (1 + nu) eta/E, and the loss tangent over the drive's angular frequency.
#[test]
fn exact_retardation_time_follows_from_viscosity_and_from_loss_tangent() {
    let of = |viscosity| Contact::new(&params(LawChoice::Hertz, viscosity, ViscosityModel::default()));
    let tau = 5e-8;
    let shear = 1e9 / (2.0 * 1.5);
    for viscosity in [
        Viscosity::RetardationTime(tau),
        Viscosity::Shear(tau * shear),
        Viscosity::LossTangent(tau * TAU * FREQUENCY),
    ] {
        let contact = of(viscosity);
        assert_eq!(contact.law, Law::ViscousHertz);
        assert!((contact.retardation / tau - 1.0).abs() < 1e-14, "{viscosity:?}: {}", contact.retardation);
    }
}

/// Without viscosity the contact is the elastic one, so that every engine gives the same bits.
#[test]
fn exact_elastic_limit_is_the_elastic_law_itself() {
    for law in [LawChoice::Hertz, LawChoice::Dmt] {
        let elastic = Contact::new(&params(law, Viscosity::None, ViscosityModel::default()));
        for none in [Viscosity::Shear(0.0), Viscosity::RetardationTime(0.0), Viscosity::LossTangent(0.0)] {
            assert_eq!(Contact::new(&params(law, none, ViscosityModel::AdHoc)), elastic);
        }
    }
}

/// Ting's contact pushes: whatever the indentation and the rate, its force without adhesion is not negative, and it takes
/// more energy in than it gives back.
#[test]
fn exact_force_of_a_kelvin_voigt_contact_never_pulls() {
    let contact = Contact::new(&params(
        LawChoice::Hertz,
        Viscosity::RetardationTime(1e-7),
        ViscosityModel::KelvinVoigt,
    ));
    for n in 0..200 {
        for m in -100..=100 {
            let (d, v) = (f64::from(n) * 1e-11, f64::from(m) * 1e-3);
            let force = contact.force_moving(d, v, d > 0.0);
            assert!(
                force >= 0.0 && (force - contact.force(d, true)) * v >= 0.0,
                "{d:e} m, {v:e} m/s: {force:e} N"
            );
        }
    }
}

/// A viscosity that no law would use, and a law that has no viscous contact, are refused at their place.
#[test]
fn refusals_of_a_viscous_sample_name_the_law_and_the_way_out() {
    let good = CASES[0].text(1e-3);
    let refused = |from: &str, to: &str, words: &[&str]| {
        let text = good.replace(from, to);
        assert_ne!(text, good);
        let told = Scene::parse("viscous.toml".as_ref(), &text).expect_err(to).to_string();
        words.iter().for_each(|word| assert!(told.contains(word), "{word} in: {told}"));
    };
    let law = ["needs the Hertz or the DMT law", "law = \"dmt\""];
    refused("law = \"hertz\"", "law = \"jkr\"", &law);
    refused("law = \"hertz\"", "law = \"auto\"", &law);
    refused("loss_tangent =", "viscosity = \"1 Pa s\"\nloss_tangent =", &["in two ways", "retardation_time"]);
    refused("loss_tangent = 0.01", "", &["`contact.viscosity_model` has no effect", "loss_tangent"]);
    refused("\"kelvin-voigt\"", "\"maxwell\"", &["kelvin-voigt", "ad-hoc"]);
    refused("loss_tangent = 0.01", "loss_tangent = -0.01", &["loss_tangent"]);
}
