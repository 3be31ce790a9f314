//! Forces beside a contact: those that act at a distance, and one given by numbers.

use crate::kernel::LENGTH;
use crate::kernel::contact::force_table::{self, EXPONENTIAL, ForceTable, INVERSE, Knot};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// Permittivity of the vacuum, F/m.
const VACUUM: f64 = 8.854_187_812_8e-12;
/// Of water at 25 degree C, relative.
pub(super) const WATER: f64 = 78.4;

/// A force that acts outside contact; inside it keeps its value at touch. SI units; `R` is the tip's radius, `d` the distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OutsideForce {
    /// `-pi eps0 R V^2/(d + cut_off)`, V the bias less the contact potential: a round tip much closer than its radius.
    Electrostatic { bias: f64, contact_potential: f64, cut_off: f64 },
    /// `4 pi R s_t s_s L/(eps eps0) exp(-d/L)` of two charges per area: Butt (1991).
    DoubleLayer { tip_charge: f64, sample_charge: f64, screening_length: f64, permittivity: f64 },
    /// `F exp(-d/L) cos(2 pi d/period + phase)`, or `2 pi R L p exp(-d/L)` of a pressure p between flat walls.
    Hydration { strength: HydrationStrength, decay_length: f64, period: Option<f64>, phase: f64 },
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

impl OutsideForce {
    /// Keywords of `force` in `[[contact.outside]]`.
    pub(super) const WORDS: [(&str, Self); 3] = [
        ("electrostatic", Self::Electrostatic { bias: f64::NAN, contact_potential: 0.0, cut_off: f64::NAN }),
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
    ];

    /// Its keyword.
    pub(super) fn word(&self) -> &'static str {
        let same =
            |other: &&(&'static str, Self)| std::mem::discriminant(&other.1) == std::mem::discriminant(self);
        Self::WORDS.iter().find(same).map_or("", |(word, _)| word)
    }

    /// Whether it is in proportion to the tip's radius.
    pub fn needs_radius(&self) -> bool {
        !matches!(self, Self::Hydration { strength: HydrationStrength::Force(_), .. })
    }

    /// The force under a tip of this radius, m. Where a process has no room for one more table it is no number.
    pub fn term(&self, radius: f64) -> TermForce {
        match *self {
            Self::Electrostatic { bias, contact_potential, cut_off } => TermForce {
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
                match ForceTable::member("hydration", [rate, phase], knots) {
                    Some(table) => of(amplitude, table),
                    None => of(f64::NAN, EXPONENTIAL),
                }
            }
        }
    }
}

/// A force by numbers over the indentation: cubic between them, monotone where they are.
#[derive(Debug, PartialEq)]
pub struct TabulatedForce {
    /// Indentations, rising, m; one that stands twice is a corner.
    pub indentations: Vec<f64>,
    /// N
    pub forces: Vec<f64>,
    peak: f64,
    whole: usize,
    outside: usize,
}

impl TabulatedForce {
    /// From indentations that rise and as many forces, at least two and at most [`force_table::KNOTS`]; none where a process
    /// has no room for one more table.
    pub(super) fn new(indentations: Vec<f64>, forces: Vec<f64>) -> Option<Arc<Self>> {
        let peak = forces.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        let peak = if peak > 0.0 { peak } else { 1.0 };
        let knots = knots(
            &indentations.iter().map(|place| place / LENGTH).collect::<Vec<_>>(),
            &forces.iter().map(|force| force / peak).collect::<Vec<_>>(),
        );
        let whole = ForceTable::number(&knots)?;
        let outside = ForceTable::number(&until_touch(&knots, whole))?;
        Some(Arc::new(Self { indentations, forces, peak, whole, outside }))
    }

    /// All of it, or its part outside contact.
    pub fn term(&self, whole: bool) -> TermForce {
        TermForce {
            amplitude: self.peak,
            length: LENGTH,
            table: if whole { self.whole } else { self.outside },
        }
    }
}

/// The knots outside contact; from touch on the force keeps its value.
fn until_touch(knots: &[Knot], whole: usize) -> Vec<Knot> {
    let mut outside: Vec<Knot> = knots.iter().copied().filter(|knot| knot.at < 0.0).collect();
    if outside.len() < knots.len() {
        let [force, slope, _] = ForceTable::numbered(whole).at(0.0);
        let slope = knots.iter().find(|knot| knot.at == 0.0).map_or(slope, |knot| knot.slope_before);
        outside.push(Knot::smooth(0.0, force, slope));
    }
    if let Some(last) = outside.last_mut() {
        last.slope_after = 0.0;
    }
    outside
}

/// Knots with slopes after Fritsch & Butland (SIAM J. Sci. Stat. Comput. 5, 300 (1984)), between corners.
fn knots(places: &[f64], forces: &[f64]) -> Vec<Knot> {
    let mut all: Vec<Knot> = Vec::new();
    let mut from = 0;
    while from < places.len() {
        let smooth = (from + 1..places.len()).find(|n| places[*n] == places[n - 1]).unwrap_or(places.len());
        let slopes = slopes(&places[from..smooth], &forces[from..smooth]);
        for (n, slope) in slopes.into_iter().enumerate() {
            match all.last_mut() {
                Some(corner) if n == 0 => corner.slope_after = slope,
                _ => all.push(Knot::smooth(places[from + n], forces[from + n], slope)),
            }
        }
        from = smooth;
    }
    all
}

fn slopes(places: &[f64], forces: &[f64]) -> Vec<f64> {
    let pieces: Vec<(f64, f64)> = (places.windows(2).zip(forces.windows(2)))
        .map(|(x, f)| (x[1] - x[0], (f[1] - f[0]) / (x[1] - x[0])))
        .collect();
    match pieces[..] {
        [] => return vec![0.0],
        [(_, slope)] => return vec![slope; 2],
        _ => {}
    }
    // At an end a parabola's slope, no steeper than monotone cubics allow.
    let end = |(near, own): (f64, f64), (far, next): (f64, f64)| {
        let slope = ((2.0 * near + far) * own - near * next) / (near + far);
        match slope * own > 0.0 {
            false => 0.0,
            true if own * next < 0.0 && slope.abs() > 3.0 * own.abs() => 3.0 * own,
            true => slope,
        }
    };
    let inside = pieces.windows(2).map(|two| {
        let ((before, rise), (after, next)) = (two[0], two[1]);
        let (one, other) = (2.0 * after + before, after + 2.0 * before);
        if rise * next > 0.0 { (one + other) / (one / rise + other / next) } else { 0.0 }
    });
    let last = pieces.len() - 1;
    let ends = (end(pieces[0], pieces[1]), end(pieces[last], pieces[last - 1]));
    std::iter::once(ends.0).chain(inside).chain(std::iter::once(ends.1)).collect()
}
