//! Contact laws: static force-indentation curves in f64, closed forms.
//!
//! Signs: `f > 0` pushes the tip away from the sample; `delta > 0` is indentation and
//! `-delta` the gap; `K` is the combined modulus, `1/K = 3/4 [(1 - nu_t^2)/E_t + (1 - nu_s^2)/E_s]`;
//! `w` is the work of adhesion (Ha, Fung & Chen 2005 call it surface energy, equations (14)-(18)).
//!
//! Energies count from far apart: `U = 0` there, and `dU/d delta = f`. As `delta` falls by what
//! the tip rises, `f = -dU/dz` for a tip position `z` counted away from the sample.
//!
//! One law is one file: its struct, its formula, its source, and [`StaticLaw`] for it, which also answers what other
//! modules ask of a law. The list of laws is the kernel's ([`crate::kernel::laws`]).
//!
//! | law | in contact | outside | hysteresis |
//! |---|---|---|---|
//! | [`Hertz`] | `K sqrt(R) delta^1.5` | 0 | no |
//! | [`Dmt`] | `K sqrt(R) delta^1.5 - 2 pi w R` | `-2 pi w R/(1 - delta/D0)^2` | no |
//! | [`ShapedHertz`] | a tip of another shape, or a thin [`Layer`]; DMT's attraction under a round tip | as above | no |
//! | [`Viscous`] | those of Hertz and DMT with a term of the rate, see there | those | no |
//! | [`Relaxing`] | that of Hertz with a modulus that falls from one value to another | 0, or forces beside it | no |
//! | [`ForceSum`] | a contact without adhesion or DMT's, or none, and up to four forces beside it | those | no |
//! | [`HystereticSum`] | the same, where one of these forces remembers | those | from where that forms to where it breaks |
//! | [`Jkr`] | `K a^3/R - sqrt(6 pi w K a^3)` | 0 | from touch at 0 to the fold at `-3 a_s^2/R` |
//! | [`JkrSum`] | the same and up to four forces beside it | those | the same |

mod contact_parameters;
mod dmt;
mod hertz;
mod hysteretic_sum;
mod jkr;
mod jkr_sum;
mod layer;
mod no_sample;
mod ramp;
mod relaxing;
mod shaped;
mod sphero_cone;
mod static_curve;
mod static_law;
mod sum;
mod tabor;
mod viscous;
mod warning;

pub use crate::kernel::{Attraction, Law};
pub use contact_parameters::Compact;
pub use dmt::Dmt;
pub use hertz::Hertz;
pub use hysteretic_sum::HystereticSum;
pub use jkr::Jkr;
pub use jkr_sum::JkrSum;
pub use layer::{LAYER_REACH, Layer};
pub use ramp::{Jump, Ramp, RampCurve};
pub use relaxing::Relaxing;
pub use shaped::ShapedHertz;
pub use shaped::{HYPERBOLOID_REACH, SPHERE_REACH};
pub use sphero_cone::{SPHERO_CONE_REACH, SpheroCone};
pub use static_curve::{CurveBranch, StaticCurve, StaticCurves};
pub use static_law::{KernelUnits, Passed, StaticLaw};
pub use sum::ForceSum;
pub use tabor::{AUTO_BOUNDARY, DMT_BELOW, JKR_ABOVE, NEGLIGIBLE_ADHESION, tabor_parameter};
pub use viscous::Viscous;
pub use warning::{RIGID_TIP_MODULUS, SMALL_STRAIN, Warning};

use crate::scene::{Adhesion, Params, Viscosity};
use no_sample::Nothing;
use relaxing::{RelaxingHertz, RelaxingSum};
use std::f64::consts::PI;
use viscous::{ViscousDmt, ViscousHertz, ViscousSum};

type ShapedDmt = Dmt<ShapedHertz>;

/// From the kernel's list, whose types have the names of those here.
macro_rules! model {
    ($($(#[$doc:meta])* $law:ident = $code:literal, $word:literal $(in $scenes:ident)?, $kind:ident $facts:tt;)*) => {
        /// A law with its constants.
        #[derive(Clone, Copy, Debug, PartialEq)]
        enum Model {
            $($law($kind),)*
        }

        impl Model {
            fn new(law: Law, of: &Compact) -> Self {
                match law {
                    $(Law::$law => Self::$law(of.into()),)*
                }
            }

            fn law(&self) -> &dyn StaticLaw {
                match self {
                    $(Self::$law(law) => law,)*
                }
            }
        }
    };
}

crate::kernel::laws!(model);

/// One instance's contact: the law decided, its constants worked out.
///
/// The fields are for reading; for other values build another one.
///
/// ```
/// use afmsweep_model::contact::{Contact, Law};
/// use afmsweep_model::scene::Params;
///
/// // Soft and sticky: Tabor's parameter is far beyond 5, so `auto` takes JKR.
/// let contact = Contact::new(&Params::default());
/// assert_eq!(contact.law, Law::Jkr);
/// assert!((contact.force(75e-9, true) / 0.42e-9 - 1.0).abs() < 0.01);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    of: Compact,
    model: Model,
}

/// What a contact says of itself beside its law's constants.
impl std::ops::Deref for Contact {
    type Target = Compact;

    #[inline]
    fn deref(&self) -> &Compact {
        &self.of
    }
}

impl Contact {
    /// Whether the contact gives back all energy that it takes.
    pub fn is_reversible(&self) -> bool {
        !self.law.has_hysteresis() && self.retardation == 0.0
    }

    /// Decides the law and works out its constants.
    ///
    /// `auto` goes by Tabor's parameter (see [`AUTO_BOUNDARY`]); without adhesion it is Hertz, and
    /// so is JKR. A Hamaker constant stands for `w = H/(12 pi D0^2)` under every law.
    pub fn new(params: &Params) -> Self {
        Compact::new(params).contact()
    }

    /// As [`Contact::new`], where the largest load (N) is known beforehand: `auto` then also takes
    /// Hertz where adhesion can pull with less than [`NEGLIGIBLE_ADHESION`] of that load.
    ///
    /// A load that is not a number leaves that rule out.
    pub fn for_load(params: &Params, load: f64) -> Self {
        Compact::for_load(params, load).contact()
    }

    /// The law with its constants.
    pub fn law(&self) -> &dyn StaticLaw {
        self.model.law()
    }

    /// JKR's constants, where that is the law.
    pub fn jkr(&self) -> Option<&Jkr> {
        match &self.model {
            Model::Jkr(law) => Some(law),
            _ => None,
        }
    }

    /// The sum of powers, where the law is one of a shape or of a layer.
    pub fn shaped(&self) -> Option<&ShapedHertz> {
        match &self.model {
            Model::ShapedHertz(law) => Some(law),
            Model::ShapedDmt(law) => Some(&law.elastic),
            Model::Sum(law) => Some(&law.contact.elastic),
            Model::HystereticSum(law) => Some(law.elastic()),
            _ => None,
        }
    }

    /// Force on the tip, N; see [`StaticLaw::force`].
    pub fn force(&self, delta: f64, in_contact: bool) -> f64 {
        self.law().force(delta, in_contact)
    }

    /// Force on the tip while the indentation changes by `rate` (m/s), N; see [`StaticLaw::force_moving`].
    pub fn force_moving(&self, delta: f64, rate: f64, in_contact: bool) -> f64 {
        self.law().force_moving(delta, rate, in_contact)
    }

    /// Slope of the force, N/m; see [`StaticLaw::stiffness`].
    pub fn stiffness(&self, delta: f64, in_contact: bool) -> f64 {
        self.law().stiffness(delta, in_contact)
    }

    /// Energy, J; see [`StaticLaw::energy`].
    pub fn energy(&self, delta: f64, in_contact: bool) -> f64 {
        self.law().energy(delta, in_contact)
    }

    /// Contact radius, m; see [`StaticLaw::contact_radius`].
    pub fn contact_radius(&self, delta: f64, in_contact: bool) -> f64 {
        self.law().contact_radius(delta, in_contact)
    }

    /// Whether the tip is in contact at `delta`, given whether it was just before.
    pub fn next_contact(&self, delta: f64, was_in_contact: bool) -> bool {
        self.law().next_contact(delta, was_in_contact)
    }

    /// Whether the tip is in contact at `delta` within a step at whose start it was, and at whose end it is.
    pub fn in_contact_within(&self, delta: f64, was: bool, is: bool) -> bool {
        match self.law.has_hysteresis() {
            true if was => self.next_contact(delta, true),
            true => is && self.next_contact(delta, false),
            false => delta > 0.0,
        }
    }

    /// Whether a tip that swings by `amplitude` (m) at that mean `gap` (m) never feels the sample.
    pub fn is_out_of_reach(&self, amplitude: f64, gap: f64) -> bool {
        match self.law.attraction() {
            _ if !self.law.acts() => true,
            // No force at a distance: a swing that ends above the surface stays free. One that ends just there, as in
            // sweeps up to the free amplitude, touches by its rounding alone.
            Attraction::None => amplitude * (1.0 - 1e-13) < gap,
            Attraction::Contact => amplitude * (1.0 + 1e-9) < gap,
            Attraction::Distant => false,
        }
    }
}

/// Combined modulus `K` of tip and sample, Pa: `1/K = 3/4 [(1 - nu_t^2)/E_t + (1 - nu_s^2)/E_s]`.
///
/// An infinite modulus of the tip is a rigid one.
///
/// ```
/// use afmsweep_model::{contact::combined_modulus, scene::Params};
/// assert!((combined_modulus(&Params::default()) / 177777.777777777778 - 1.0).abs() < 1e-15);
/// ```
pub fn combined_modulus(params: &Params) -> f64 {
    modulus_of(params, params.sample.youngs_modulus)
}

/// The same with a sample of this Young's modulus, Pa.
fn modulus_of(params: &Params, sample_modulus: f64) -> f64 {
    let compliance = |modulus: f64, ratio: f64| (1.0 - ratio) * (1.0 + ratio) / modulus;
    let tip = &params.instrument.tip;
    let sample = &params.sample;
    4.0 / (3.0
        * (compliance(tip.youngs_modulus, tip.poisson_ratio)
            + compliance(sample_modulus, sample.poisson_ratio)))
}

/// Retardation time of the sample, s: shear viscosity over shear modulus, or the loss tangent over the drive's angular
/// frequency (Hz given); 0 where it is elastic.
pub fn retardation_time(params: &Params, frequency: f64) -> f64 {
    let sample = &params.sample;
    match sample.viscosity {
        Viscosity::None | Viscosity::Relaxing { .. } => 0.0,
        Viscosity::Shear(viscosity) => viscosity * 2.0 * (1.0 + sample.poisson_ratio) / sample.youngs_modulus,
        Viscosity::RetardationTime(time) => time,
        Viscosity::LossTangent(0.0) => 0.0,
        Viscosity::LossTangent(tangent) => tangent / (2.0 * PI * frequency),
    }
}

/// Work of adhesion `w`, J/m^2, given or from the Hamaker constant: `w = H/(12 pi D0^2)`.
pub fn work_of_adhesion(params: &Params) -> f64 {
    match params.sample.adhesion {
        Adhesion::Work(work) => work,
        Adhesion::Hamaker(hamaker) => {
            let decay_length = params.contact.decay_length;
            hamaker / (12.0 * PI * decay_length * decay_length)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::LawChoice;

    /// Zero, huge, negative, infinite and missing values: some answer, no panic.
    #[test]
    fn contact_takes_any_scene() {
        let values = [0.0, 1e-300, 1e-9, 1.0, 1e12, 1e300, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
        let choices = [LawChoice::None, LawChoice::Hertz, LawChoice::Dmt, LawChoice::Jkr, LawChoice::Auto];
        for (i, &modulus) in values.iter().enumerate() {
            for (j, &radius) in values.iter().enumerate() {
                for (k, &adhesion) in values.iter().enumerate() {
                    let mut params = Params::default();
                    params.sample.youngs_modulus = modulus;
                    params.instrument.tip.radius = radius;
                    let hamaker = (i + j + k) % 2 == 0;
                    params.sample.adhesion =
                        if hamaker { Adhesion::Hamaker(adhesion) } else { Adhesion::Work(adhesion) };
                    params.contact.decay_length = values[(i + 2 * j + 3 * k) % values.len()];
                    for law in choices {
                        params.contact.law = law;
                        let contact = Contact::new(&params);
                        for delta in values {
                            for warning in contact.warnings(&params, Some(delta)) {
                                assert!(!warning.to_string().is_empty());
                            }
                        }
                        for curve in contact.curves_at(&values).curves {
                            assert_eq!(curve.force_n.len(), values.len());
                        }
                    }
                    assert_eq!(Contact::new(&params).curves().curves.len(), 2);
                }
            }
        }
    }

    #[test]
    fn contact_names_are_those_of_the_scene_file() -> Result<(), serde_json::Error> {
        let names = [
            "none",
            "hertz",
            "dmt",
            "jkr",
            "hertz-viscous",
            "dmt-viscous",
            "hertz-relaxing",
            "hertz-shaped",
            "dmt-shaped",
            "sum",
            "sum-hysteretic",
            "sum-jkr",
            "sum-viscous",
            "sum-relaxing",
        ];
        assert_eq!(Law::ALL.map(Law::name), names);
        for law in Law::ALL {
            assert_eq!(serde_json::to_value(law)?, law.to_string());
        }
        Ok(())
    }
}
