//! A lever of one or two modes that is driven at its tip, as scenes and the independent programs of samples with losses have
//! it. SI units.

use afmsweep::{Audit, Scene, Sweep};
use std::f64::consts::{PI, TAU};

pub const STIFFNESS: f64 = 26.0;
pub const FREQUENCY: f64 = 300e3;
pub const QUALITY: f64 = 10.0;
pub const AMPLITUDE: f64 = 20e-9;
pub const GAP: f64 = 15e-9;
pub const RADIUS: f64 = 20e-9;

/// The work of adhesion (J/m^2) and the decay length (m) of its cases with DMT's law, and the cut-off (m) of those with a charged
/// tip.
pub const WORK: f64 = 0.03;
pub const DECAY: f64 = 0.3e-9;
const CUT_OFF: f64 = 0.5e-9;

/// What acts beside a contact: DMT's attraction if `adhesive`, and the force of a tip that is charged to so many volts.
#[derive(Clone, Copy)]
pub struct Surroundings {
    pub adhesive: bool,
    pub bias: f64,
}

impl Surroundings {
    /// Lines of `[contact]`, of which `more` are others.
    pub fn text(self, more: &str) -> String {
        let law = if self.adhesive { "dmt" } else { "hertz" };
        let charges = format!(
            "[[contact.outside]]\nforce = \"electrostatic\"\nbias = \"{} V\"\ncut_off = \"{CUT_OFF} m\"",
            self.bias
        );
        format!("law = \"{law}\"\n{more}\n{}", if self.bias == 0.0 { "" } else { &charges })
    }

    /// Its force (N) at a distance (m), 0 in contact.
    pub fn force(self, away: f64) -> f64 {
        let adhesion = if self.adhesive { TAU * WORK * RADIUS } else { 0.0 };
        let charged = PI * 8.854_187_812_8e-12 * RADIUS * self.bias * self.bias / CUT_OFF;
        -adhesion / (1.0 + away / DECAY).powi(2) - charged / (1.0 + away / CUT_OFF)
    }
}

/// The lever, and the drive's frequency over that of its first mode.
#[derive(Clone, Copy)]
pub struct DrivenLever {
    pub modes: usize,
    pub detuning: f64,
}

impl DrivenLever {
    /// The drive's frequency, Hz.
    pub fn frequency(self) -> f64 {
        self.detuning * FREQUENCY
    }

    /// The drive's angular frequency, rad/s.
    pub fn omega(self) -> f64 {
        TAU * self.frequency()
    }

    /// Stiffness and frequency of each mode; the quality factor is that of all.
    pub fn oscillators(self) -> Vec<[f64; 2]> {
        [[STIFFNESS, FREQUENCY], [39.3 * STIFFNESS, 6.27 * FREQUENCY]][..self.modes].to_vec()
    }

    /// Force (N) that drives the free tip to its amplitude.
    pub fn drive(self) -> f64 {
        let omega = self.omega();
        // The free tip's response to a unit force, as a complex number.
        let (mut re, mut im) = (0.0, 0.0);
        for [k, f] in self.oscillators() {
            let w = TAU * f;
            let (a, b) = (w * w - omega * omega, omega * w / QUALITY);
            let size = w * w / k / (a * a + b * b);
            (re, im) = (re + a * size, im - b * size);
        }
        AMPLITUDE / re.hypot(im)
    }

    /// Rates of travel and speed of each mode under a contact `force` and the `drive` (N), and of the integrals of travel times
    /// cosine and sine, and of the force's power: the first seven numbers of a state.
    pub fn rates(self, time: f64, state: &[f64], (force, drive): (f64, f64), rates: &mut [f64]) {
        let angle = self.omega() * time;
        let push = force + drive * angle.sin();
        for (n, [k, f]) in self.oscillators().into_iter().enumerate() {
            let w = TAU * f;
            let (x, u) = (state[2 * n], state[2 * n + 1]);
            (rates[2 * n], rates[2 * n + 1]) = (u, w * w * (push / k - x) - w / QUALITY * u);
        }
        let travel = state[0] + state[2];
        rates[4..7].copy_from_slice(&[
            travel * angle.cos(),
            travel * angle.sin(),
            force * (state[1] + state[3]),
        ]);
    }

    /// What was measured in a period that ends in `state`, with its largest and least force.
    pub fn measured(self, state: &[f64], forces: [f64; 2]) -> Measured {
        let half = PI / self.omega();
        let (cosine, sine) = (state[4] / half, state[5] / half);
        measured(cosine.hypot(sine), (-cosine).atan2(sine), -state[6], forces)
    }

    /// The text of a scene, with these lines of its sample, contact and run.
    pub fn text(self, [sample, contact, run]: [&str; 3]) -> String {
        let mode = |[k, f]: &[f64; 2]| {
            format!("{{ stiffness = \"{k} N/m\", frequency = \"{f} Hz\", quality_factor = {QUALITY} }}")
        };
        format!(
            r#"
            [instrument.cantilever]
            modes = [{}]
            [instrument.tip]
            radius = "{RADIUS} m"
            [sample]
            poisson_ratio = 0.3
            {sample}
            [contact]
            {contact}
            [drive]
            on = "tip"
            frequency = "{} Hz"
            free_amplitude = "{AMPLITUDE} m"
            [approach]
            gap = "{GAP} m"
            [run]
            {run}
            [output]
            observables = ["amplitude", "phase", "force_max", "force_min", "dissipation", "contact_time"]
            "#,
            self.oscillators().iter().map(mode).collect::<Vec<_>>().join(", "),
            self.frequency(),
        )
    }

    /// The scene of this text.
    pub fn scene(self, lines: [&str; 3]) -> Scene {
        Scene::parse("lever.toml".as_ref(), &self.text(lines)).unwrap_or_else(|error| panic!("{error}"))
    }
}

/// What both programs measure: amplitude over the free one, phase in rad, loss over the drive's work, largest and least force
/// in N.
pub type Measured = [f64; 5];

/// The same from amplitude (m), phase (rad), loss (J) and forces.
fn measured(amplitude: f64, phase: f64, loss: f64, forces: [f64; 2]) -> Measured {
    let work = PI * STIFFNESS * AMPLITUDE * AMPLITUDE / QUALITY;
    [amplitude / AMPLITUDE, phase, loss / work, forces[0], forces[1]]
}

/// The program's answer.
pub fn answer(scene: Scene) -> Measured {
    let results = Sweep::new(scene).audit(Audit::None).run().unwrap().results;
    let of = |name| results.observable(name).unwrap().values[0];
    measured(of("amplitude"), of("phase").to_radians(), of("dissipation"), [of("force_max"), of("force_min")])
}
