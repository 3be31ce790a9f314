//! A force by numbers, with a way out of its own if it has one.

use super::outside_params::{NeckForce, TermForce};
use crate::kernel::LENGTH;
use crate::kernel::contact::force_table::{ForceTable, Knot};

/// A force by numbers over the indentation: cubic between them, monotone where they are.
#[derive(Debug, PartialEq)]
pub struct TabulatedForce {
    /// Indentations, rising, m; one that stands twice is a corner.
    pub indentations: Vec<f64>,
    /// On the way in, N.
    pub forces: Vec<f64>,
    /// On the way out, if it differs there.
    pub retraction: Option<Retraction>,
    peak: f64,
    /// The tables of all of it, and of its part outside contact.
    tables: [usize; 2],
}

/// How a force by numbers differs on the way out.
#[derive(Debug, PartialEq)]
pub struct Retraction {
    /// N
    pub forces: Vec<f64>,
    /// Where both ways meet, inside and far away, m.
    forms: f64,
    breaks: f64,
    /// Of the difference, as those of the force.
    tables: [usize; 2],
}

/// Both ways of a force by numbers meet where they differ by less than this share of its largest force.
const MEETING_SHARE: f64 = 1e-3;

/// Why a force has no way out that a tip could take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum RetractionFault {
    /// They differ at the innermost place, or at the farthest.
    ApartInside,
    ApartFar,
    /// The way out gives back more work than the way in has taken.
    Gains,
    /// No room for one more table.
    NoRoom,
}

impl TabulatedForce {
    /// From indentations that rise and as many forces, at least two and no more than a table has room for; none where a process
    /// has no room for one more table.
    pub(super) fn new(indentations: Vec<f64>, forces: Vec<f64>) -> Option<Self> {
        let peak = forces.iter().fold(0.0, |most: f64, force| most.max(force.abs()));
        let peak = if peak > 0.0 { peak } else { 1.0 };
        let knots = knots(
            &indentations.iter().map(|place| place / LENGTH).collect::<Vec<_>>(),
            &forces.iter().map(|force| force / peak).collect::<Vec<_>>(),
        );
        let tables = tables(&knots)?;
        Some(Self { indentations, forces, retraction: None, peak, tables })
    }

    /// The same with these forces on the way out, one for each place.
    pub(super) fn with_retraction(self, forces: Vec<f64>) -> Result<Self, RetractionFault> {
        let most = forces.iter().fold(self.peak, |most, force| most.max(force.abs()));
        let differs = |n: &usize| (forces[*n] - self.forces[*n]).abs() > MEETING_SHARE * most;
        let rows = forces.len();
        let (Some(first), Some(last)) = ((0..rows).find(differs), (0..rows).rfind(differs)) else {
            return Ok(self);
        };
        if last + 1 == rows {
            return Err(RetractionFault::ApartInside);
        }
        if first == 0 {
            return Err(RetractionFault::ApartFar);
        }
        let places: Vec<f64> = self.indentations.iter().map(|place| place / LENGTH).collect();
        let between = |n: usize| if (first..=last).contains(&n) { forces[n] } else { self.forces[n] };
        let scaled = |all: Vec<f64>| all.into_iter().map(|force| force / self.peak).collect::<Vec<_>>();
        let there = knots(&places, &scaled(self.forces.clone()));
        let back = knots(&places, &scaled((0..rows).map(between).collect()));
        let difference: Vec<Knot> = (there.iter().zip(&back))
            .map(|(there, back)| Knot {
                at: there.at,
                force: back.force - there.force,
                slope_before: back.slope_before - there.slope_before,
                slope_after: back.slope_after - there.slope_after,
            })
            .collect();
        let tables = tables(&difference).ok_or(RetractionFault::NoRoom)?;
        let (from, to) = (places[first - 1], places[last + 1]);
        let work = |place: f64| ForceTable::numbered(tables[0]).at(place)[2];
        if work(to) > work(from) {
            return Err(RetractionFault::Gains);
        }
        let (forms, breaks) = (self.indentations[last + 1], self.indentations[first - 1]);
        Ok(Self { retraction: Some(Retraction { forces, forms, breaks, tables }), ..self })
    }

    /// All of it, or its part outside contact, on the way in.
    pub fn term(&self, whole: bool) -> TermForce {
        TermForce { amplitude: self.peak, length: LENGTH, table: self.tables[usize::from(!whole)] }
    }

    /// By what the force differs on the way out.
    pub fn neck(&self, whole: bool) -> Option<NeckForce> {
        let Retraction { forms, breaks, tables, .. } = self.retraction.as_ref()?;
        let forms = if whole { *forms } else { forms.min(0.0) };
        let term = TermForce { table: tables[usize::from(!whole)], ..self.term(whole) };
        (*breaks < forms).then_some(NeckForce { term, forms, breaks: *breaks })
    }
}

/// The tables of all of a force, and of its part outside contact.
fn tables(knots: &[Knot]) -> Option<[usize; 2]> {
    let whole = ForceTable::number(knots)?;
    Some([whole, ForceTable::number(&until_touch(knots, whole))?])
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
