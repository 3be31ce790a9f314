//! A lever by dimensions in a fluid: frequency and quality factor of its modes, by Sader's hydrodynamic function.
//!
//! J. E. Sader, J. Appl. Phys. 84 (1998) 64: the fluid moves with a thin blade as it would with an endless one, so that a
//! length of it carries `pi/4 rho b^2 Gamma(Re)` of the fluid, whose imaginary part is the damping. Here the mass is added
//! to the beam of the finite elements, at each mode's own frequency in the fluid: without a tip this is Sader's formula, and
//! the tip's mass stands as it is. The drag on the tip is left out.

use complex_bessel::besselk_scaled;
use nalgebra::Complex;
use std::f64::consts::{FRAC_PI_4, PI, TAU};

use super::instrument_error::InstrumentError;
use super::{DEFAULT_TOLERANCE, Instrument, Mode, check_positive};
use crate::scene::{ActuatorModel, DriveOn, InstrumentParams, LeverSpec, QualityFactor};

/// Reynolds numbers over which Sader fitted his correction for a rectangular blade.
pub const REYNOLDS: [f64; 2] = [1e-6, 1e4];
/// Lowest quality factor at which the fluid's formulas count as good.
const UNDERDAMPED: f64 = 3.0;
/// Widths per `length/C_n` from which the flow is no longer that around an endless blade (C. A. Van Eysden & J. E. Sader,
/// J. Appl. Phys. 101 (2007) 044908: their normalized mode number has to be well below 1).
const SLENDER: f64 = 1.0;
/// Rounds of the frequency in the fluid; each leaves a tenth of the miss or less.
const ROUNDS: usize = 60;
/// Relative change of the beam's density by which a mode's share of mass is found.
const NUDGE: f64 = 1e-4;

/// A Newtonian fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fluid {
    /// kg/m^3
    pub density: f64,
    /// Shear viscosity, Pa s.
    pub viscosity: f64,
}

impl Fluid {
    /// Water at 25 C (IAPWS-95 and IAPWS R12-08).
    pub const WATER: Self = Self { density: 997.05, viscosity: 0.890e-3 };
    /// Dry air at 25 C and 101.325 kPa.
    pub const AIR: Self = Self { density: 1.184, viscosity: 18.5e-6 };

    /// Reynolds number `rho omega b^2 / (4 eta)` of a blade of that width (m) at that angular frequency (rad/s).
    pub fn reynolds(&self, width: f64, omega: f64) -> f64 {
        self.density * omega * width * width / (4.0 * self.viscosity)
    }
}

/// A mode of a lever in a fluid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluidMode {
    /// Frequency without the fluid, Hz.
    pub vacuum_frequency: f64,
    /// Natural frequency in the fluid, Hz.
    pub frequency: f64,
    /// By the fluid's damping alone.
    pub quality_factor: f64,
    /// Stiffness at the tip, N/m.
    pub stiffness: f64,
    /// Inertial participation: what a base's motion pushes the mode by, as `modes` of a scene has it.
    pub drive: f64,
    /// At the frequency in the fluid.
    pub reynolds: f64,
    /// Gamma(Re): the real part is the mass that moves along, the imaginary one the damping.
    pub hydrodynamic: Complex<f64>,
    /// Width over `length/C_n`, C_n being the mode's wave number times the length; well below 1 for Sader's formula.
    pub wave_number_times_width: f64,
}

impl FluidMode {
    /// Why the formulas should not be trusted here, in words; none where they hold.
    pub fn doubts(&self) -> Vec<String> {
        let mut doubts = Vec::new();
        if !(REYNOLDS[0]..=REYNOLDS[1]).contains(&self.reynolds) {
            doubts.push(format!("Reynolds number outside {:.0e} to {:.0e}", REYNOLDS[0], REYNOLDS[1]));
        }
        if self.wave_number_times_width > SLENDER {
            doubts
                .push("bends over less than its width: the flow is not that around a long blade".to_owned());
        }
        if self.quality_factor < UNDERDAMPED {
            doubts.push("heavily damped: frequency and Q are approximate".to_owned());
        }
        doubts
    }

    /// Whether the flow is that around a long blade, so that the mode can be told at all.
    pub fn slender(&self) -> bool {
        self.wave_number_times_width <= SLENDER
    }
}

/// Sader's hydrodynamic function of a rectangular blade (J. Appl. Phys. 84 (1998) 64): that of a circular cylinder,
/// times a correction whose coefficients he gives for Reynolds numbers from 1e-6 to 1e4.
pub fn hydrodynamic_function(reynolds: f64) -> Complex<f64> {
    const REAL: [&[f64]; 2] = [
        &[0.91324, -0.48274, 0.46842, -0.12886, 0.044055, -0.0035117, 0.00069085],
        &[1.0, -0.56964, 0.48690, -0.13444, 0.045155, -0.0035862, 0.00069085],
    ];
    const IMAGINARY: [&[f64]; 2] = [
        &[-0.024134, -0.029256, 0.016294, -0.00010961, 0.000064577, -0.000044510],
        &[1.0, -0.59702, 0.55182, -0.18357, 0.079156, -0.014369, 0.0028361],
    ];
    let tau = reynolds.log10();
    let ratio = |[above, below]: [&[f64]; 2]| {
        let sum = |terms: &[f64]| terms.iter().rev().fold(0.0, |sum, term| sum * tau + term);
        sum(above) / sum(below)
    };
    Complex::new(ratio(REAL), ratio(IMAGINARY)) * circular(reynolds)
}

/// Of a circular cylinder: 1 + 4 i K1(z)/(sqrt(i Re) K0(z)) at z = -i sqrt(i Re).
fn circular(reynolds: f64) -> Complex<f64> {
    let z = Complex::from_polar(reynolds.sqrt(), -FRAC_PI_4);
    // Scaled alike, so that their quotient is that of the functions and neither is lost in zero.
    let quotient = match (besselk_scaled(1.0, z), besselk_scaled(0.0, z)) {
        (Ok(first), Ok(zeroth)) => first / zeroth,
        _ => return Complex::new(f64::NAN, f64::NAN),
    };
    // sqrt(i Re) = i z, so 4 i / sqrt(i Re) = 4/z.
    Complex::new(1.0, 0.0) + 4.0 * quotient / z
}

/// The modes of the lever in that fluid, on a base that may move; as many as are sure without it.
///
/// # Errors
/// A lever that is not given by its dimensions, impossible values, and what [`Instrument::reduce`] refuses.
pub fn modes_in(params: &InstrumentParams, fluid: Fluid) -> Result<Vec<FluidMode>, InstrumentError> {
    check_positive("the fluid's density", fluid.density)?;
    check_positive("the fluid's viscosity", fluid.viscosity)?;
    let blade = Blade::of(params)?;
    let dry = blade.reduce(1.0)?;
    (0..dry.resolved).map(|k| blade.mode(k, &dry.modes[k], fluid)).collect()
}

/// A lever by dimensions on a rigid base, whose density can be changed.
struct Blade {
    params: InstrumentParams,
    density: f64,
    width: f64,
    thickness: f64,
}

impl Blade {
    fn of(params: &InstrumentParams) -> Result<Self, InstrumentError> {
        let &LeverSpec::Dimensions { density, width, thickness, .. } = &params.cantilever.lever else {
            return Err(InstrumentError::NoDimensions);
        };
        let mut params = params.clone();
        params.actuator.model = ActuatorModel::Rigid;
        // The fluid's damping is all that is asked for.
        params.cantilever.quality_factor = QualityFactor::All(f64::INFINITY);
        Ok(Self { params, density, width, thickness })
    }

    /// Its modes with the beam so many times as heavy, the tip as it is.
    fn reduce(&self, heavier: f64) -> Result<Instrument, InstrumentError> {
        let mut params = self.params.clone();
        if let LeverSpec::Dimensions { density, .. } = &mut params.cantilever.lever {
            *density *= heavier;
        }
        Instrument::reduce(&params, DriveOn::Actuator, DEFAULT_TOLERANCE)
    }

    fn mode(&self, k: usize, dry: &Mode, fluid: Fluid) -> Result<FluidMode, InstrumentError> {
        // Fluid's mass per Gamma over the beam's, pi rho b / (4 rho_c h).
        let lightness = PI * fluid.density * self.width / (4.0 * self.density * self.thickness);
        let gamma = |omega: f64| hydrodynamic_function(fluid.reynolds(self.width, omega));
        let loaded = |omega: f64| 1.0 + lightness * gamma(omega).re;
        let at = |heavier: f64| -> Result<Mode, InstrumentError> {
            let instrument = self.reduce(heavier)?;
            instrument
                .modes
                .get(k)
                .copied()
                .ok_or(InstrumentError::OutOfRange { what: "mode's number", value: k as f64 })
        };
        let mut omega = dry.omega;
        for _ in 0..ROUNDS {
            let next = at(loaded(omega))?.omega;
            let moved = (next / omega - 1.0).abs();
            omega = next;
            if moved < 1e-11 {
                break;
            }
        }
        let (heavier, gamma) = (loaded(omega), gamma(omega));
        let mode = at(heavier)?;
        // How the frequency falls with the beam's mass is the beam's share of what moves (Rayleigh).
        let squared = |nudge: f64| Ok::<f64, InstrumentError>(2.0 * at(heavier * (1.0 + nudge))?.omega.ln());
        let share = (squared(-NUDGE)? - squared(NUDGE)?) / ((1.0 + NUDGE) / (1.0 - NUDGE)).ln();
        let quality_factor = (1.0 / lightness + gamma.re) / (gamma.im * share);
        if !(quality_factor.is_finite() && omega.is_finite()) {
            return Err(InstrumentError::OutOfRange {
                what: "quality factor in the fluid",
                value: quality_factor,
            });
        }
        Ok(FluidMode {
            vacuum_frequency: dry.omega / TAU,
            frequency: omega / TAU,
            quality_factor,
            stiffness: mode.omega * mode.omega / mode.inverse_mass(),
            drive: -mode.drive * mode.tip,
            reynolds: fluid.reynolds(self.width, omega),
            hydrodynamic: gamma,
            wave_number_times_width: self.wave_number(dry.omega) * self.width,
        })
    }

    /// Of a bending wave at that frequency: (omega^2 rho_c b h/(E I))^(1/4), 1/m.
    fn wave_number(&self, omega: f64) -> f64 {
        let LeverSpec::Dimensions { youngs_modulus, density, thickness, .. } = self.params.cantilever.lever
        else {
            return f64::NAN;
        };
        (omega * omega * 12.0 * density / (youngs_modulus * thickness * thickness)).powf(0.25)
    }
}
