//! Where a contact law is used outside its assumptions: typed, with the numbers.

use super::tabor::fitting_law;
use super::{
    Attraction, Contact, DMT_BELOW, HYPERBOLOID_REACH, JKR_ABOVE, LAYER_REACH, Law, NEGLIGIBLE_ADHESION,
    SPHERE_REACH, SPHERO_CONE_REACH,
};
use crate::scene::{LawChoice, Params, TipShape};
use crate::units::{Dimension, shown};
use std::f64::consts::PI;

/// Largest `a/R` at which all three laws' parabola still stands for a sphere and small strain holds.
///
/// Sneddon's exact solution for a rigid sphere in the same linear half-space,
/// `delta = (a/2) ln((R + a)/(R - a))`, falls short of Hertz's force at the same depth by
/// `0.1 (a/R)^2` to leading order: 0.9 % here. The representative strain of an indentation, `0.2 a/R`,
/// is 6 %, about where polymers stop being linear. Both grow fast beyond.
pub const SMALL_STRAIN: f64 = 0.3;

/// Sample modulus, Pa, above which a rigid tip is worth a word: against silicon or its oxide
/// (70 to 170 GPa) the error in K passes 1 % about here.
pub const RIGID_TIP_MODULUS: f64 = 1e9;

/// A case outside the assumptions of its law. SI values.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Warning {
    /// The law asked for belongs to the other end of Tabor's parameter.
    #[error(
        "contact law {law} with Tabor's parameter {tabor:.4}: {fitting} fits (dmt below {DMT_BELOW}, \
         jkr above {JKR_ABOVE}); set contact.law to \"{fitting}\" or \"auto\""
    )]
    LawDoesNotFit { law: Law, fitting: Law, tabor: f64 },
    /// Tabor's parameter lies between the limits of DMT and JKR.
    #[error(
        "Tabor's parameter {tabor:.4} lies between dmt (below {DMT_BELOW}) and jkr (above \
         {JKR_ABOVE}): {law} is an approximation, its adhesion off by up to a third; run the other \
         law as well to see what depends on it"
    )]
    BetweenLaws { law: Law, tabor: f64 },
    /// Hertz was asked for, and adhesion is not negligible at this load.
    #[error(
        "contact law hertz leaves out an adhesion of up to {:.3} nN at a load of {:.3} nN; \
         set contact.law to \"dmt\" if the sample is viscous or a layer, else to \"auto\", or \
         sample.surface_energy to zero",
        pull * 1e9,
        load * 1e9
    )]
    AdhesionLeftOut { pull: f64, load: f64 },
    /// The contact radius leaves the range of small strain at this indentation.
    #[error(
        "at an indentation of {:.3} nm the contact radius is {:.2} of the tip radius, beyond the \
         small-strain range ({SMALL_STRAIN}) of the contact laws: {}",
        indentation * 1e9,
        contact_radius / tip_radius,
        match (shape, contact_radius < tip_radius) {
            (TipShape::Sphere, _) => "the sphere's shape is exact, but a real sample is no longer linear at such a strain",
            (_, true) => "expect an error in the force of 1 % or more",
            (_, false) => "a tip that sinks in so far is no sphere to them",
        }
    )]
    LargeStrain { indentation: f64, contact_radius: f64, tip_radius: f64, shape: TipShape },
    /// The tip counts as rigid although the sample is stiff.
    #[error(
        "the tip counts as rigid, yet the sample has {}: give instrument.tip.youngs_modulus",
        shown(*sample_modulus, Dimension::Pressure)
    )]
    RigidTip { sample_modulus: f64 },
    /// The tip sinks in deeper than the series of a layer, a hyperboloid or a sphere reaches.
    #[error(
        "at an indentation of {} the {} is {ratio:.3}, beyond the {reach} to which the force is known: do not trust it; see \
         docs/model.md",
        shown(*indentation, Dimension::Length),
        match shape {
            TipShape::Hyperboloid => "indentation times tan(half_angle)^2 over the tip radius",
            TipShape::Sphere | TipShape::SpheroCone => "indentation over the tip's radius",
            _ => "contact radius over the layer's thickness",
        }
    )]
    BeyondSeries { indentation: f64, ratio: f64, reach: f64, shape: TipShape },
    /// A round tip on a layer is pulled as if the sample were thick.
    #[error(
        "the sample is a layer, and DMT's attraction is that of a thick sample: the force in contact is right for small \
         adhesion only"
    )]
    AdhesiveLayer,
    /// The tip sinks in deeper than its table of forces reaches.
    #[error(
        "at an indentation of {} the tip is deeper than the table of forces reaches, {}: there the force goes straight on; do \
         not trust it",
        shown(*indentation, Dimension::Length),
        shown(*reach, Dimension::Length)
    )]
    BeyondTable { indentation: f64, reach: f64 },
}

impl Contact {
    /// What is doubtful about this contact; `params` is what it was built from, `indentation` (m) the
    /// deepest one expected, where known.
    pub fn warnings(&self, params: &Params, indentation: Option<f64>) -> Vec<Warning> {
        let mut warnings = Vec::new();
        warnings.extend(self.tabor_warning());
        if let Some(indentation) = indentation {
            warnings.extend(self.adhesion_warning(indentation));
            warnings.extend(self.strain_warning(indentation));
            warnings.extend(self.series_warning(indentation));
            warnings.extend(self.table_warning(params, indentation));
        }
        if self.layer.is_some() && self.attraction() == Attraction::Distant && self.work > 0.0 {
            warnings.push(Warning::AdhesiveLayer);
        }
        let sample_modulus = params.sample.youngs_modulus;
        let rigid = params.instrument.tip.youngs_modulus == f64::INFINITY;
        let pressed = self.law.acts() && self.choice != LawChoice::Sum;
        if pressed && rigid && sample_modulus > RIGID_TIP_MODULUS {
            warnings.push(Warning::RigidTip { sample_modulus });
        }
        warnings
    }

    /// Whether the law fits Tabor's parameter. It is a thick sample's; of a layer another warning tells.
    fn tabor_warning(&self) -> Option<Warning> {
        let law = match self.law {
            Law::JkrSum => Law::Jkr,
            law if law.is_sum() => Law::Dmt,
            law => law,
        };
        let tabor = self.tabor();
        if self.layer.is_some() {
            return None;
        }
        let wrong = match self.attraction() {
            Attraction::None => return None,
            Attraction::Contact if law == Law::Jkr => tabor < DMT_BELOW,
            // Tabor's parameter tells DMT's range from JKR's alone.
            Attraction::Contact => return None,
            Attraction::Distant => tabor > JKR_ABOVE,
        };
        match wrong {
            true => Some(Warning::LawDoesNotFit { law, fitting: fitting_law(tabor), tabor }),
            _ if (DMT_BELOW..=JKR_ABOVE).contains(&tabor) => Some(Warning::BetweenLaws { law, tabor }),
            _ => None,
        }
    }

    /// Whether Hertz, where it was asked for, leaves out adhesion that shows.
    fn adhesion_warning(&self, indentation: f64) -> Option<Warning> {
        if self.choice != LawChoice::Hertz || !self.is_round() {
            return None;
        }
        let pull = 2.0 * PI * self.work * self.radius;
        let load = self.force(indentation, true);
        (pull > NEGLIGIBLE_ADHESION * load).then_some(Warning::AdhesionLeftOut { pull, load })
    }

    /// Whether `indentation` leaves the range for which the law's series is fitted.
    pub fn series_warning(&self, indentation: f64) -> Option<Warning> {
        let shape = self.shape;
        let (ratio, reach) = match (self.layer, shape) {
            (Some(layer), _) => (self.contact_radius(indentation, true) / layer.thickness, LAYER_REACH),
            (None, TipShape::Hyperboloid) => {
                let tangent = self.half_angle.to_radians().tan();
                (indentation * tangent * tangent / self.radius, HYPERBOLOID_REACH)
            }
            (None, TipShape::Sphere) => (indentation / self.radius, SPHERE_REACH),
            (None, TipShape::SpheroCone) => (indentation / self.radius, SPHERO_CONE_REACH),
            _ => return None,
        };
        (ratio > reach).then_some(Warning::BeyondSeries { indentation, ratio, reach, shape })
    }

    /// Whether `indentation` is deeper than a table that is the whole force.
    fn table_warning(&self, params: &Params, indentation: f64) -> Option<Warning> {
        let table = params.contact.table.as_ref().filter(|_| self.choice == LawChoice::Sum)?;
        let reach = table.indentations.last().copied()?;
        (indentation > reach).then_some(Warning::BeyondTable { indentation, reach })
    }

    /// Whether `indentation` leaves the range of small strain ([`SMALL_STRAIN`]) under a round tip. The strain under a cone or
    /// a pyramid is the same at every depth.
    pub fn strain_warning(&self, indentation: f64) -> Option<Warning> {
        let contact_radius = self.contact_radius(indentation, true);
        (self.is_round() && contact_radius > SMALL_STRAIN * self.radius).then_some(Warning::LargeStrain {
            indentation,
            contact_radius,
            tip_radius: self.radius,
            shape: self.shape,
        })
    }
}
