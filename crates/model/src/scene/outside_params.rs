//! Forces beside a contact: those that act at a distance, and one given by numbers.

use crate::kernel::contact::force_table::{self, EXPONENTIAL, ForceTable, INVERSE, Knot};
use std::f64::consts::{PI, TAU};

/// Permittivity of the vacuum, F/m.
const VACUUM: f64 = 8.854_187_812_8e-12;
/// Of water at 25 degree C, relative.
pub(super) const WATER: f64 = 78.4;

/// A force that acts outside contact; inside it keeps its value at touch. SI units; `R` is the tip's radius, `d` the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutsideForce {
    /// `-pi eps0 R V^2/(d + cut_off)`, V the bias less the contact potential: a round tip much closer than its radius; with the
    /// cone behind it, if that is given.
    Electrostatic { bias: f64, contact_potential: f64, cut_off: f64, cone: Option<TipCone> },
    /// `4 pi R s_t s_s L/(eps eps0) exp(-d/L)` of two charges per area: Butt (1991).
    DoubleLayer { tip_charge: f64, sample_charge: f64, screening_length: f64, permittivity: f64 },
    /// `F exp(-d/L) cos(2 pi d/period + phase)`, or `2 pi R L p exp(-d/L)` of a pressure p between flat walls.
    Hydration { strength: HydrationStrength, decay_length: f64, period: Option<f64>, phase: f64 },
    /// A liquid neck, which forms at the distance `forms_at` on the way in and breaks at `breaks_at` on the way out: between
    /// them `-F/(1 + d/s)^2`, s being `decay_length` or else `forms_at` (after Zitzler et al. 2002), or `-F (1 - d/breaks_at)`.
    Capillary { strength: f64, forms_at: f64, breaks_at: f64, decay_length: Option<f64>, model: NeckModel },
}

/// How a liquid neck's force falls off with the distance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NeckModel {
    InverseSquare,
    Linear,
}

impl NeckModel {
    /// Keywords of `model`.
    pub(super) const WORDS: [(&str, Self); 2] =
        [("inverse-square", Self::InverseSquare), ("linear", Self::Linear)];
}

/// The cone of a tip behind its round end: the angle of its side to the axis, degree, and its height, m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TipCone {
    pub half_angle: f64,
    pub height: f64,
}

impl TipCone {
    /// What it adds to an electrostatic force of this potential (V) under a tip of this radius (m), the charges being `cut_off`
    /// (m) apart at touch: Hudlet, Saint Jean, Guthmann & Berger (1998), with `a = d + cut_off + R (1 - sin)`,
    /// `-pi eps0 V^2 (k^2 (ln(height/a) - 1 + R cos^2/(sin a)) - R/a)`, `1/k = ln tan(half_angle/2)`.
    ///
    /// The logarithm less 1 counts as nothing from where it would be negative.
    fn term(self, potential: f64, cut_off: f64, radius: f64) -> TermForce {
        let (sine, cosine) = self.half_angle.to_radians().sin_cos();
        let factor = (0.5 * self.half_angle).to_radians().tan().ln().powi(-2);
        let length = cut_off + radius * (1.0 - sine);
        let level = (self.height / length).ln() - 1.0;
        let round = radius * (cosine * cosine / sine - 1.0 / factor) / length;
        let knots = || {
            force_table::falling(|x| {
                let away = 1.0 - x;
                let left = level - away.ln();
                let (side, slope) = if left > 0.0 { (left, 1.0 / away) } else { (0.0, 0.0) };
                (side + round / away, slope + round / (away * away))
            })
        };
        let amplitude = -PI * VACUUM * potential.powi(2) * factor;
        member(
            TermForce { amplitude, length, table: INVERSE },
            ForceTable::member("cone", [level, round], knots),
        )
    }
}

/// How strong hydration is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum HydrationStrength {
    /// Pa, between flat walls that touch.
    Pressure(f64),
    /// N, at touch and phase 0.
    Force(f64),
}

/// A force of the sum law: `amplitude` (N) times the table's value at the indentation over `length` (m).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TermForce {
    pub amplitude: f64,
    pub length: f64,
    pub table: usize,
}

impl TermForce {
    /// Force (N), slope (N/m) and energy (J, none far away) at an indentation (m).
    pub fn at(&self, delta: f64) -> [f64; 3] {
        let [force, slope, work] = ForceTable::numbered(self.table).at(delta / self.length);
        [self.amplitude * force, self.amplitude / self.length * slope, self.amplitude * self.length * work]
    }
}

/// A force that remembers: it acts from the indentation (m) where it forms, on the way in, to the one where it breaks, on the
/// way out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NeckForce {
    pub term: TermForce,
    pub forms: f64,
    pub breaks: f64,
}

impl OutsideForce {
    /// Keywords of `force` in `[[contact.outside]]`.
    pub(super) const WORDS: [(&str, Self); 4] = [
        (
            "electrostatic",
            Self::Electrostatic { bias: f64::NAN, contact_potential: 0.0, cut_off: f64::NAN, cone: None },
        ),
        (
            "double-layer",
            Self::DoubleLayer {
                tip_charge: f64::NAN,
                sample_charge: f64::NAN,
                screening_length: f64::NAN,
                permittivity: WATER,
            },
        ),
        (
            "hydration",
            Self::Hydration {
                strength: HydrationStrength::Pressure(f64::NAN),
                decay_length: f64::NAN,
                period: None,
                phase: 0.0,
            },
        ),
        (
            "capillary",
            Self::Capillary {
                strength: f64::NAN,
                forms_at: 0.0,
                breaks_at: f64::NAN,
                decay_length: None,
                model: NeckModel::InverseSquare,
            },
        ),
    ];

    /// Its keyword.
    pub(super) fn word(&self) -> &'static str {
        let same =
            |other: &&(&'static str, Self)| std::mem::discriminant(&other.1) == std::mem::discriminant(self);
        Self::WORDS.iter().find(same).map_or("", |(word, _)| word)
    }

    /// Whether it is in proportion to the tip's radius.
    pub fn needs_radius(&self) -> bool {
        !matches!(
            self,
            Self::Hydration { strength: HydrationStrength::Force(_), .. } | Self::Capillary { .. }
        )
    }

    /// Whether it acts only from where it forms to where it breaks.
    pub fn remembers(&self) -> bool {
        matches!(self, Self::Capillary { .. })
    }

    /// The force, if it remembers.
    pub fn neck(&self) -> Option<NeckForce> {
        match *self {
            Self::Capillary { forms_at, breaks_at, .. } => {
                Some(NeckForce { term: self.term(0.0), forms: -forms_at, breaks: -breaks_at })
            }
            _ => None,
        }
    }

    /// The forces that it is made of under a tip of this radius, m.
    pub fn terms(&self, radius: f64) -> impl Iterator<Item = TermForce> {
        let cone = match *self {
            Self::Electrostatic { bias, contact_potential, cut_off, cone } => {
                cone.map(|cone| cone.term(bias - contact_potential, cut_off, radius))
            }
            _ => None,
        };
        std::iter::once(self.term(radius)).chain(cone)
    }

    /// Of how many forces it is made.
    pub(super) fn count(&self) -> usize {
        1 + usize::from(matches!(self, Self::Electrostatic { cone: Some(_), .. }))
    }

    /// The force of its round end under a tip of this radius, m. Where a process has no room for one more table it is no
    /// number.
    fn term(&self, radius: f64) -> TermForce {
        match *self {
            Self::Electrostatic { bias, contact_potential, cut_off, .. } => TermForce {
                amplitude: -PI * VACUUM * radius * (bias - contact_potential).powi(2) / cut_off,
                length: cut_off,
                table: INVERSE,
            },
            Self::DoubleLayer { tip_charge, sample_charge, screening_length, permittivity } => TermForce {
                amplitude: 4.0 * PI * radius * tip_charge * sample_charge * screening_length
                    / (permittivity * VACUUM),
                length: screening_length,
                table: EXPONENTIAL,
            },
            Self::Hydration { strength, decay_length, period, phase } => {
                let amplitude = match strength {
                    HydrationStrength::Pressure(pressure) => 2.0 * PI * radius * decay_length * pressure,
                    HydrationStrength::Force(force) => force,
                };
                let of = |amplitude, table| TermForce { amplitude, length: decay_length, table };
                let Some(period) = period else {
                    return of(amplitude * phase.to_radians().cos(), EXPONENTIAL);
                };
                let (rate, phase) = (TAU * decay_length / period, phase.to_radians());
                let knots = || {
                    force_table::decaying(|x| {
                        let (sine, cosine) = (phase - rate * x).sin_cos();
                        (x.exp() * cosine, x.exp() * (cosine + rate * sine))
                    })
                };
                member(of(amplitude, EXPONENTIAL), ForceTable::member("hydration", [rate, phase], knots))
            }
            Self::Capillary { strength, breaks_at, model: NeckModel::Linear, .. } => {
                let knots = || {
                    let touch = Knot { slope_before: 1.0, ..Knot::smooth(0.0, 1.0, 0.0) };
                    vec![Knot { slope_after: 1.0, ..Knot::smooth(-1.0, 0.0, 0.0) }, touch]
                };
                let term = TermForce { amplitude: -strength, length: breaks_at, table: INVERSE };
                member(term, ForceTable::member("straight", [0.0; 2], knots))
            }
            Self::Capillary { strength, forms_at, decay_length, .. } => {
                TermForce::inverse_square(-strength, decay_length.unwrap_or(forms_at))
            }
        }
    }
}

impl TermForce {
    /// The amplitude over (1 + d/length)^2 at the distance d.
    pub(crate) fn inverse_square(amplitude: f64, length: f64) -> Self {
        let knots = || force_table::falling(|x| ((1.0 - x).powi(-2), 2.0 * (1.0 - x).powi(-3)));
        let term = Self { amplitude, length, table: INVERSE };
        member(term, ForceTable::member("inverse square", [0.0; 2], knots))
    }
}

/// The force with this table, which is no number where a process has no room for one more.
fn member(of: TermForce, table: Option<usize>) -> TermForce {
    match table {
        Some(table) => TermForce { table, ..of },
        None => TermForce { amplitude: f64::NAN, ..of },
    }
}
