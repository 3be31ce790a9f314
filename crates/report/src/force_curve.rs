//! Force against indentation of one instance: the law, and the forces that its motion tells, where something happens.

use super::axis::PlotAxis;
use super::canvas::LINES;
use super::curve_forces::{LARGEST, ORBIT};
use super::frame::{Frame, Legend, is_place};
use super::stack::Stack;
use crate::store::ForceCurve;

const LAYOUT: Stack = Stack { width: 560.0, gap: 0.0, top: 40.0, key: None, beyond: 28.0 };

/// Decay lengths of the attraction and largest indentations from the surface that are shown.
const REACH: f64 = 3.0;
/// Room beyond the largest indentation and force met, as a share of them.
const ROOM: f64 = 0.1;

/// The picture of all curves of one instance. A law without memory has one: its approach and its retraction are the same.
/// `decay` is the law's decay length, m, where it has one.
pub(super) fn draw(curves: &[&ForceCurve], heading: &str, decay: Option<f64>) -> String {
    let repeats = |one: &ForceCurve, other: &ForceCurve| one.law == other.law && points(one) == points(other);
    let told = |n: &usize| !curves[..*n].iter().any(|before| repeats(curves[*n], before));
    let name = |n: usize| match curves[n + 1..].iter().any(|after| repeats(curves[n], after)) {
        true => curves[n].law.clone(),
        false => format!("{}, {}", curves[n].law, curves[n].branch),
    };
    let (names, curves): (Vec<String>, Vec<&ForceCurve>) =
        (0..curves.len()).filter(told).map(|n| (name(n), curves[n])).unzip();
    let all = || curves.iter().flat_map(|curve| pairs(curve));
    let (x_axis, y_axis) = match field(&curves, decay) {
        Some(((from, to), (low, high))) => (
            PlotAxis::over([from, to].into_iter(), "m", X, false, 0.0),
            PlotAxis::over([low, high].into_iter(), "N", Y, false, 0.0),
        ),
        None => (
            PlotAxis::over(all().map(|one| one.0), "m", X, false, 0.03),
            PlotAxis::over(all().map(|one| one.1), "N", Y, false, 0.06),
        ),
    };
    let mut entries = Vec::new();
    for (number, curve) in curves.iter().enumerate() {
        let shade = LINES[number % LINES.len()];
        let sample = match curve {
            curve if is_retraction(curve) => Legend::Dashes(shade),
            curve if is_cloud(curve) => Legend::Dot(shade),
            _ => Legend::Line(shade),
        };
        entries.push((sample, names[number].clone()));
    }
    LAYOUT.draw((heading, &entries), &x_axis, &[(&y_axis, 360.0)], |_, frame| {
        frame.grid();
        frame.zeros(true);
        for (number, curve) in curves.iter().enumerate() {
            stroke(frame, curve, number);
        }
        frame.edges(true, true)
    })
}

/// Draws the curve of this number, as far as it is in the frame.
fn stroke(frame: &Frame, curve: &ForceCurve, number: usize) {
    let (canvas, shade) = (frame.canvas, LINES[number % LINES.len()]);
    let places: Vec<(f64, f64)> = pairs(curve).map(|(depth, force)| frame.at(depth, force)).collect();
    if is_cloud(curve) {
        let shown = places.into_iter().filter(|at| frame.holds(*at));
        return shown.for_each(|at| canvas.dot(at, 1.8, shade));
    }
    let pieces = inside(frame, &places);
    pieces.iter().for_each(|piece| canvas.stroke(piece, (shade, 2.0), is_retraction(curve)))
}

const X: &str = "indentation, negative for a gap";
const Y: &str = "force on the tip";

/// The points of a curve that are numbers.
fn pairs(curve: &ForceCurve) -> impl Iterator<Item = (f64, f64)> + Clone {
    let all = curve.indentation.iter().copied().zip(curve.force.iter().copied());
    all.filter(is_place)
}

type Ends = (f64, f64);

/// Where something happens: a few decay lengths or indentations from the surface, and what the motion reaches. None where
/// nothing is known of the motion.
fn field(curves: &[&ForceCurve], decay: Option<f64>) -> Option<(Ends, Ends)> {
    // The law itself is drawn deeper than the tip goes; all else is of the motion, and has no contact radius.
    let of_motion = |curve: &&&ForceCurve| curve.contact_radius.iter().all(|radius| radius.is_nan());
    let met = || curves.iter().filter(of_motion).flat_map(|curve| pairs(curve));
    let deepest = met().map(|one| one.0).reduce(f64::max)?;
    let out = REACH * decay.unwrap_or(0.0).max(deepest);
    // A tip that only hovers is shown from where it comes closest.
    let (from, to) = (deepest.min(0.0) - out, deepest.max(0.0) + ROOM * deepest.max(out / REACH));
    let seen = |one: &Ends| (from..=to).contains(&one.0);
    let (low, high) =
        met().filter(seen).fold((0.0f64, 0.0f64), |ends, one| (ends.0.min(one.1), ends.1.max(one.1)));
    // The law's pull belongs to the picture where the tip comes near.
    let pull = curves.iter().flat_map(|curve| pairs(curve)).filter(seen).map(|one| one.1);
    let low = pull.filter(|_| deepest > 0.0).fold(low, f64::min);
    let room = ROOM * (high - low);
    (out > 0.0 && room > 0.0).then_some(((from, to), (low - room, high + room)))
}

/// The pieces of a line inside the frame, cut at its edges.
fn inside(frame: &Frame, places: &[(f64, f64)]) -> Vec<Vec<(f64, f64)>> {
    let (right, bottom) = (frame.left + frame.width, frame.top + frame.height);
    let mut pieces: Vec<Vec<(f64, f64)>> = Vec::new();
    for pair in places.windows(2) {
        let ((x, y), (dx, dy)) = (pair[0], (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1));
        // Shares of the way at which it comes in and goes out (Liang and Barsky).
        let (mut from, mut to) = (0.0f64, 1.0f64);
        for (step, room) in [(-dx, x - frame.left), (dx, right - x), (-dy, y - frame.top), (dy, bottom - y)] {
            match step {
                0.0 if room < 0.0 => to = -1.0,
                0.0 => {}
                step if step < 0.0 => from = from.max(room / step),
                step => to = to.min(room / step),
            }
        }
        if from > to {
            continue;
        }
        let (a, b) = ((x + from * dx, y + from * dy), (x + to * dx, y + to * dy));
        match pieces.last_mut().filter(|piece| piece.last() == Some(&a)) {
            Some(piece) => piece.push(b),
            None => pieces.push(vec![a, b]),
        }
    }
    pieces
}

/// The points of a curve in rising order, each once; bits, so that none is lost by being no number.
fn points(curve: &ForceCurve) -> Vec<(u64, u64)> {
    let pairs = curve.indentation.iter().zip(&curve.force);
    let mut points: Vec<(u64, u64)> =
        pairs.map(|(depth, force)| (depth.to_bits(), force.to_bits())).collect();
    points.sort_unstable();
    points.dedup();
    points
}

/// Whether nothing is known between its points: they are of different states, or instants apart, within which a contact may begin
/// and end.
fn is_cloud(curve: &ForceCurve) -> bool {
    curve.law == LARGEST || curve.law == ORBIT
}

fn is_retraction(curve: &ForceCurve) -> bool {
    curve.branch == "retract"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(law: &str, points: &[(f64, f64)], radius: f64) -> ForceCurve {
        ForceCurve {
            law: law.into(),
            indentation: points.iter().map(|one| one.0).collect(),
            force: points.iter().map(|one| one.1).collect(),
            contact_radius: vec![radius; points.len()],
            ..ForceCurve::default()
        }
    }

    /// Truth: by hand: an orbit from 30 nm away to 1 nm inside with 5 nN, and a law drawn to 250 nN.
    #[test]
    fn the_picture_ends_where_the_motion_does() {
        let law = curve("dmt", &[(-30e-9, 0.0), (0.0, -2e-9), (1e-9, 5e-9), (9e-9, 250e-9)], 1e-9);
        let orbit = curve("along the orbit", &[(-30e-9, 0.0), (-1e-9, -1e-9), (1e-9, 5e-9)], f64::NAN);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-12 * b.abs();
        let ((from, to), (low, high)) = field(&[&law, &orbit], Some(0.3e-9)).unwrap();
        assert!(near(from, -3e-9) && near(to, 1.1e-9), "{from} {to}");
        assert!(near(low, -2.7e-9) && near(high, 5.7e-9), "{low} {high}");
        assert_eq!(field(&[&law], Some(0.3e-9)), None);
    }

    /// Truth: by hand.
    #[test]
    fn lines_are_cut_at_the_edges() {
        crate::canvas::picture((100.0, 100.0), |canvas| {
            let axis = PlotAxis::over([0.0, 1.0].into_iter(), "1", "", false, 0.0);
            let (width, height) = (10.0, 10.0);
            let frame = Frame { canvas, left: 0.0, top: 0.0, width, height, x: &axis, y: &axis };
            let found = inside(&frame, &[(-5.0, 5.0), (5.0, 5.0), (5.0, 25.0), (50.0, 50.0)]);
            assert_eq!(found, [vec![(0.0, 5.0), (5.0, 5.0), (5.0, 10.0)]]);
        });
    }
}
