//! One fully resolved case: every quantity of a scene as a number in SI units.
//!
//! [`Params`] is what the rest of the program computes from; the scene file
//! and its sweep only fill it in. `Params::default()` is the preset
//! `ha-fung-chen-2005`: Table 1 and the run of section 4 of J.-L. Ha,
//! R.-F. Fung, Y.-C. Chen, J. Dyn. Syst. Meas. Control 127(4), 705-709 (2005).

pub use super::outside_params::{HydrationStrength, NeckForce, NeckModel, OutsideForce, TermForce, TipCone};
pub use super::tabulated_force::TabulatedForce;
pub use super::tip_params::*;
use crate::kernel::{Attraction, Law};
use std::sync::Arc;

/// The preset of the whole instrument; the others are `levers.rs`'s.
pub const PRESET: &str = "ha-fung-chen-2005";

/// Everything one instance needs; lengths in m, stiffness in N/m, frequencies in Hz.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Params {
    pub instrument: InstrumentParams,
    pub sample: SampleParams,
    pub contact: ContactParams,
    pub drive: DriveParams,
    pub approach: ApproachParams,
}

/// The rod, the lever and the tip.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InstrumentParams {
    pub actuator: ActuatorParams,
    pub cantilever: CantileverParams,
    pub tip: TipParams,
}

/// How the rod and the lever act on each other.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ActuatorModel {
    /// Rod and lever act on each other (Hamilton form of the energies).
    Coupled,
    /// The rod moves as if alone and drives the lever, which does not act back.
    Prescribed,
    /// No rod: a base that moves as told, or not at all.
    Rigid,
    /// Equation (13) of the paper taken literally; for the replication study only.
    AsPrinted,
}

/// The piezoelectric rod (Table 1, first column). SI units; `h33` in V/m, `beta33` in V m/C.
#[derive(Clone, Debug, PartialEq)]
pub struct ActuatorParams {
    pub model: ActuatorModel,
    pub youngs_modulus: f64,
    pub density: f64,
    pub h33: f64,
    pub beta33: f64,
    pub length: f64,
    pub width: f64,
    pub thickness: f64,
    /// Infinite means undamped.
    pub quality_factor: f64,
}

/// The lever: by its dimensions, by its thermal calibration, or mode by mode.
#[derive(Clone, Debug, PartialEq)]
pub struct CantileverParams {
    pub lever: LeverSpec,
    pub quality_factor: QualityFactor,
}

/// Three ways to say what the lever is.
#[derive(Clone, Debug, PartialEq)]
pub enum LeverSpec {
    /// A uniform rectangular beam (Table 1, second column).
    Dimensions { youngs_modulus: f64, density: f64, length: f64, width: f64, thickness: f64 },
    /// The first mode's stiffness (N/m) and frequency (Hz) as measured, tip included;
    /// higher modes follow from uniform-beam theory, with the tip's mass where that is given.
    Calibrated { stiffness: f64, frequency: f64 },
    /// Modes with tip participation 1; no tip mass is added.
    Modes(Vec<LeverMode>),
}

/// One measured mode of a lever, tip participation 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeverMode {
    /// N/m
    pub stiffness: f64,
    /// Hz
    pub frequency: f64,
    pub quality_factor: f64,
    /// Push of the drive on this mode relative to a drive on the tip (or, for a moving
    /// base, the mode's inertial participation); 1 by default.
    pub drive: f64,
}

/// Quality factors of the lever's own modes, first mode first; infinite means undamped.
#[derive(Clone, Debug, PartialEq)]
pub enum QualityFactor {
    /// The same for every mode.
    All(f64),
    /// One for each mode; the last one also serves the modes beyond the list. Never empty.
    PerMode(Vec<f64>),
}

/// The sample.
#[derive(Clone, Debug, PartialEq)]
pub struct SampleParams {
    /// Pa
    pub youngs_modulus: f64,
    pub poisson_ratio: f64,
    pub adhesion: Adhesion,
    pub viscosity: Viscosity,
    /// Of a layer on a rigid ground, m; without it the sample is a half-space.
    pub thickness: Option<f64>,
    /// Whether the layer is bonded to its ground; else it slides on it.
    pub bonded: bool,
}

/// What a sample loses when it is deformed: a Kelvin-Voigt solid's viscosity in one of three forms, or a relaxing modulus.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Viscosity {
    /// It is elastic.
    None,
    /// `sample.viscosity`: shear viscosity, Pa s.
    Shear(f64),
    /// `sample.retardation_time`: shear viscosity over shear modulus, s.
    RetardationTime(f64),
    /// `sample.loss_tangent`: loss modulus over storage modulus at the drive's frequency.
    LossTangent(f64),
    /// `sample.instantaneous_modulus` (Pa) and `sample.relaxation_time` (s): a standard linear solid, whose Young's modulus is
    /// the relaxed one.
    Relaxing { modulus: f64, time: f64 },
}

/// How a viscous sample presses on the tip.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ViscosityModel {
    /// Ting's contact of a Kelvin-Voigt half-space.
    #[default]
    KelvinVoigt,
    /// The elastic force and a viscous one on both ways.
    AdHoc,
}

/// Adhesion between tip and sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Adhesion {
    /// `sample.surface_energy`: work of adhesion w, J/m^2.
    Work(f64),
    /// `sample.hamaker`: Hamaker constant H, J, with w = H / (12 pi D0^2) (DMT only).
    Hamaker(f64),
}

macro_rules! law_choice {
    ($($(#[$doc:meta])* $law:ident = $code:literal, $word:literal $(in $scenes:ident)?, $kind:ident $facts:tt;)*) => {
        /// What the scene asks for as contact law.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        pub enum LawChoice {
            $($(#[$doc])* $law,)*
            /// Chosen for each instance by Tabor's parameter.
            Auto,
        }

        impl LawChoice {
            /// Keywords of `contact.law`. Whether the sample is viscous, `[sample]` says.
            pub(super) const WORDS: &[(&str, Self)] =
                &[
                    $($({
                        let _ = stringify!($scenes);
                        ($word, Self::$law)
                    },)?)*
                    ("table", Self::Sum),
                    ("auto", Self::Auto),
                ];

            /// The law asked for; none where it is chosen for each instance.
            pub fn law(self) -> Option<Law> {
                match self {
                    $(Self::$law => Some(Law::$law),)*
                    Self::Auto => None,
                }
            }

            /// Where adhesion may act.
            pub(super) fn attraction(self) -> Option<Attraction> {
                match self {
                    // What a table holds is not adhesion that the sample says.
                    Self::Sum => Some(Attraction::None),
                    _ => self.law().map(Law::attraction),
                }
            }
        }
    };
}

crate::kernel::laws!(law_choice);

/// The contact law and its own constants.
#[derive(Clone, Debug, PartialEq)]
pub struct ContactParams {
    pub law: LawChoice,
    /// Decay length D0 of DMT's attraction outside contact, and z0 of Tabor's parameter, m.
    pub decay_length: f64,
    /// For a viscous sample.
    pub viscosity_model: ViscosityModel,
    /// A force by numbers: the law itself, or outside contact beside it.
    pub table: Option<Arc<TabulatedForce>>,
    /// Forces that act outside contact.
    pub outside: Vec<OutsideForce>,
}

/// Where the drive acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum DriveOn {
    /// The rod's voltage, or the motion of a rigid base.
    Actuator,
    /// A force on the tip.
    Tip,
}

/// How strong the drive is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveLevel {
    /// V, on the rod.
    Voltage(f64),
    /// N, on the tip.
    Force(f64),
    /// m, of a rigid base.
    BaseAmplitude(f64),
    /// m, of the free tip in the steady state: the drive is scaled to it.
    FreeAmplitude(f64),
}

/// The drive's frequency.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveFrequency {
    /// Hz
    Hertz(f64),
    /// The peak of the free tip's response nearest the lever's first mode.
    Resonance,
}

/// The drive: a sine.
#[derive(Clone, Debug, PartialEq)]
pub struct DriveParams {
    pub frequency: DriveFrequency,
    pub on: DriveOn,
    pub level: DriveLevel,
}

/// Where the sample stands.
#[derive(Clone, Debug, PartialEq)]
pub struct ApproachParams {
    /// Distance from the tip at rest to the surface, m; may be zero or negative. Where a set-point is held, it is solved for.
    pub gap: f64,
    /// What is held in place of the gap.
    pub held: Option<Held>,
    /// What a set-point that is no force is of.
    pub of: SetPointOf,
    /// On which branch, where both hold it; none is the one that an approach meets first.
    pub branch: Option<ForceBranch>,
    /// How far below the surface a set-point is looked for, m; none where the scene does not say.
    pub deepest: Option<f64>,
}

impl ApproachParams {
    /// What is held in place of the gap, by what the set-point is of.
    pub fn target(&self) -> Option<Held> {
        self.held.map(|held| match (held, self.of) {
            (Held::Amplitude(share), SetPointOf::Deflection) => Held::Deflection(share),
            (Held::Amplitude(degrees), SetPointOf::Phase) => Held::Phase(degrees),
            _ => held,
        })
    }
}

/// What a set-point is of, where it is no force.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SetPointOf {
    /// The amplitude of the tip's travel, as a share of the free one.
    #[default]
    Tip,
    /// The amplitude of the deflection, which a photodiode shows, as a share of the free one.
    Deflection,
    /// The lag of the tip's travel behind the drive, degree.
    Phase,
}

/// What a feedback holds by moving the sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Held {
    /// The amplitude of the tip, as a share of the free one.
    Amplitude(f64),
    /// The amplitude of the deflection, as a share of the free one.
    Deflection(f64),
    /// The lag of the tip, degree.
    Phase(f64),
    /// The largest force, N.
    Force(f64),
}

/// A branch of tapping, by the sign of its mean force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceBranch {
    Attractive,
    Repulsive,
}

impl Default for ActuatorParams {
    fn default() -> Self {
        Self {
            model: ActuatorModel::Coupled,
            youngs_modulus: 2.216e10,
            density: 8000.0,
            h33: 5.45136e8,
            beta33: 7.81e7,
            length: 4000e-6,
            width: 500e-6,
            thickness: 500e-6,
            quality_factor: f64::INFINITY,
        }
    }
}

impl Default for CantileverParams {
    fn default() -> Self {
        Self {
            lever: LeverSpec::Dimensions {
                youngs_modulus: 7.03e10,
                density: 2500.0,
                length: 174e-6,
                width: 39e-6,
                thickness: 6.9e-6,
            },
            quality_factor: QualityFactor::All(f64::INFINITY),
        }
    }
}

impl Default for SampleParams {
    fn default() -> Self {
        Self {
            youngs_modulus: 1e5,
            poisson_ratio: 0.5,
            adhesion: Adhesion::Work(2e-3),
            viscosity: Viscosity::None,
            thickness: None,
            bonded: true,
        }
    }
}

impl Default for ContactParams {
    fn default() -> Self {
        Self {
            law: LawChoice::Auto,
            decay_length: 0.3e-9,
            viscosity_model: ViscosityModel::default(),
            table: None,
            outside: Vec::new(),
        }
    }
}

impl Default for DriveParams {
    fn default() -> Self {
        Self {
            frequency: DriveFrequency::Hertz(30e3),
            on: DriveOn::Actuator,
            level: DriveLevel::Voltage(15.0),
        }
    }
}

impl Default for ApproachParams {
    fn default() -> Self {
        Self { gap: 0.3e-9, held: None, of: SetPointOf::default(), branch: None, deepest: None }
    }
}
