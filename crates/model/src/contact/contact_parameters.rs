//! What decides a contact: the law for a case, and what its constants are made of.

use super::tabor::{fitting_law, tabor_parameter};
use super::{
    Attraction, Contact, Law, Layer, Model, NEGLIGIBLE_ADHESION, SpheroCone, combined_modulus,
    retardation_time, work_of_adhesion,
};
use crate::kernel::contact::TERMS;
use crate::scene::{
    ContactParams, DriveFrequency, LawChoice, NeckForce, OutsideForce, Params, TermForce, TipShape,
    Viscosity, ViscosityModel,
};
use std::f64::consts::PI;

/// A contact without the constants of its law, which follow: half as large, for those who hold very many.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Compact {
    pub law: Law,
    /// What the scene asked for.
    pub choice: LawChoice,
    /// Combined modulus K, Pa.
    pub modulus: f64,
    /// Tip radius R, m.
    pub radius: f64,
    /// Work of adhesion w, J/m^2, as given; [`Law::Hertz`] and [`Law::None`] leave it out.
    pub work: f64,
    /// D0 of DMT's attraction and z0 of Tabor's parameter, m.
    pub decay_length: f64,
    /// Combined modulus K at once, Pa: higher than `modulus` where the sample relaxes.
    pub instantaneous: f64,
    /// Retardation time of a viscous sample or of one that relaxes, s; else 0.
    pub retardation: f64,
    /// Whether its force is the literature's ad hoc form; else Ting's.
    pub ad_hoc: bool,
    /// The tip's shape, and the half-angle (degree) of a shape that has one, else 0.
    pub shape: TipShape,
    pub half_angle: f64,
    /// The sample, if it is a thin layer.
    pub layer: Option<Layer>,
    /// Forces beside the contact, of a law that is a sum; of a sphero-cone the first is the contact itself. Under
    /// [`Law::HystereticSum`] the last is the one that remembers.
    pub terms: [Option<TermForce>; TERMS],
    /// Indentations at which the one that remembers forms and breaks, m.
    pub neck: [f64; 2],
}

impl Compact {
    /// How many [`Self::constants`] there are.
    pub const CONSTANTS: usize = 11 + 2 * TERMS;

    /// Decides the law; see [`Contact::new`].
    pub fn new(params: &Params) -> Self {
        let frequency = match params.drive.frequency {
            DriveFrequency::Hertz(frequency) => frequency,
            DriveFrequency::Resonance => f64::NAN,
        };
        Self::at_frequency(params, frequency)
    }

    /// The same under a drive of this frequency (Hz), at which the sample's loss tangent counts.
    pub fn at_frequency(params: &Params, frequency: f64) -> Self {
        let of = Self::for_load(params, f64::NAN).shaped(params).summed(params);
        if let Viscosity::Relaxing { modulus, time } = params.sample.viscosity {
            return of.relaxing(params, modulus, time);
        }
        let retardation = retardation_time(params, frequency);
        match of.law.viscous() {
            // Not a number where the frequency is unknown.
            Some(law) if retardation != 0.0 => Self {
                law,
                retardation,
                ad_hoc: params.contact.viscosity_model == ViscosityModel::AdHoc,
                ..of
            },
            _ => of,
        }
    }

    pub(super) fn for_load(params: &Params, load: f64) -> Self {
        let modulus = combined_modulus(params);
        let radius = params.instrument.tip.radius;
        let decay_length = params.contact.decay_length;
        let work = work_of_adhesion(params);
        let choice = params.contact.law;
        let negligible = 2.0 * PI * work * radius < NEGLIGIBLE_ADHESION * load;
        let law = match choice.law() {
            Some(Law::Jkr) if work == 0.0 => Law::Hertz,
            Some(law) => law,
            None if work == 0.0 || negligible => Law::Hertz,
            None => fitting_law(tabor_parameter(modulus, radius, work, decay_length)),
        };
        Self {
            law,
            choice,
            modulus,
            radius,
            work,
            decay_length,
            instantaneous: modulus,
            retardation: 0.0,
            ad_hoc: false,
            shape: TipShape::Paraboloid,
            half_angle: 0.0,
            layer: None,
            terms: [None; TERMS],
            neck: [0.0; 2],
        }
    }

    /// The same under a tip of the shape that the case has, on a layer if the sample is one.
    fn shaped(self, params: &Params) -> Self {
        let (tip, sample) = (&params.instrument.tip, &params.sample);
        let (poisson_ratio, bonded) = (sample.poisson_ratio, sample.bonded);
        let layer = sample.thickness.map(|thickness| Layer { thickness, poisson_ratio, bonded });
        match self.law.shaped() {
            Some(law) if tip.shape != TipShape::Paraboloid || layer.is_some() => {
                Self { law, shape: tip.shape, half_angle: tip.half_angle.unwrap_or(0.0), layer, ..self }
            }
            _ => self,
        }
    }

    /// The same with the forces that the case has beside the contact.
    fn summed(self, params: &Params) -> Self {
        let ContactParams { table, outside, .. } = &params.contact;
        let whole = self.choice == LawChoice::Sum;
        let neck = outside.iter().find_map(OutsideForce::neck);
        let neck = neck.or_else(|| table.as_ref().and_then(|table| table.neck(whole)));
        let table = table.as_ref().map(|table| table.term(whole));
        let cap = (self.shape == TipShape::SpheroCone)
            .then(|| SpheroCone::new(self.half_angle).term(0.75 * self.modulus, self.radius));
        let others = outside.iter().filter(|force| !force.remembers());
        let outside = others.flat_map(|force| force.terms(self.radius));
        let mut all = cap.into_iter().chain(table).chain(outside).peekable();
        match self.law.summed() {
            Some(law) if all.peek().is_some() || neck.is_some() => {
                let mut terms = std::array::from_fn(|_| all.next());
                let Some(NeckForce { term, forms, breaks }) = neck else {
                    return Self { law, terms, ..self };
                };
                terms[TERMS - 1] = Some(term);
                Self { law: Law::HystereticSum, terms, neck: [forms, breaks], ..self }
            }
            _ => self,
        }
    }

    /// The forces beside the contact with DMT's attraction among them, if the scene has that.
    pub(super) fn with_attraction(&self) -> [Option<TermForce>; TERMS] {
        let mut terms = self.terms;
        let free = terms.iter_mut().find(|term| term.is_none());
        if let Some(slot) = free.filter(|_| self.choice == LawChoice::Dmt) {
            *slot = Some(TermForce::inverse_square(-2.0 * PI * self.work * self.radius, self.decay_length));
        }
        terms
    }

    /// Where adhesion of the contact itself acts.
    pub(super) fn attraction(&self) -> Attraction {
        match (self.law, self.choice) {
            (Law::JkrSum, _) => Attraction::Contact,
            (law, LawChoice::Dmt) if law.is_sum() => Attraction::Distant,
            (law, _) if law.is_sum() => Attraction::None,
            (law, _) => law.attraction(),
        }
    }

    /// Whether the tip's radius is that of its curvature.
    pub(super) fn is_round(&self) -> bool {
        matches!(self.shape, TipShape::Paraboloid | TipShape::Sphere)
    }

    /// Tabor's parameter; not a number under a tip without a radius of curvature.
    #[inline]
    pub fn tabor(&self) -> f64 {
        match self.is_round() {
            true => tabor_parameter(self.modulus, self.radius, self.work, self.decay_length),
            false => f64::NAN,
        }
    }

    /// Combined modulus (Pa), tip radius (m), work of adhesion (J/m^2), decay length (m), combined modulus at once (Pa),
    /// retardation time (s), half-angle (degree), a layer's thickness (m) and Poisson ratio, and the other forces' amplitudes
    /// (N) and lengths (m), and where the last of them forms and breaks (m).
    pub fn constants(&self) -> [f64; Self::CONSTANTS] {
        let [at_once, later, angle] = [self.instantaneous, self.retardation, self.half_angle];
        let (thickness, ratio) =
            self.layer.map_or((f64::INFINITY, 0.0), |layer| (layer.thickness, layer.poisson_ratio));
        let own = [
            self.modulus,
            self.radius,
            self.work,
            self.decay_length,
            at_once,
            later,
            angle,
            thickness,
            ratio,
            self.neck[0],
            self.neck[1],
        ];
        let terms = self.terms.map(|term| term.map_or([0.0; 2], |term| [term.amplitude, term.length]));
        std::array::from_fn(|n| match n.checked_sub(own.len()) {
            None => own[n],
            Some(n) => terms[n / 2][n % 2],
        })
    }

    /// The contact, to the bit.
    #[inline]
    pub fn contact(self) -> Contact {
        Contact { of: self, model: Model::new(self.law, &self) }
    }
}
