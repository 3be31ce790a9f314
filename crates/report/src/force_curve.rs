//! Static force against indentation: approach and retraction of one instance.

use super::ReportError;
use super::axis::Axis;
use super::canvas::{INK, LINES, picture};
use super::frame::{Frame, KEY_ROW, Key, key, key_rows, left_margin, title};
use crate::store::ForceCurve;

/// The picture of all curves of one instance. A law without memory has one: its approach and its retraction are the same.
pub(super) fn draw(curves: &[&ForceCurve], heading: &str) -> Result<String, ReportError> {
    let repeats = |one: &ForceCurve, other: &ForceCurve| one.law == other.law && points(one) == points(other);
    let told = |n: &usize| !curves[..*n].iter().any(|before| repeats(curves[*n], before));
    let name = |n: usize| match curves[n + 1..].iter().any(|after| repeats(curves[n], after)) {
        true => curves[n].law.clone(),
        false => format!("{}, {}", curves[n].law, curves[n].branch),
    };
    let (names, curves): (Vec<String>, Vec<&ForceCurve>) =
        (0..curves.len()).filter(told).map(|n| (name(n), curves[n])).unzip();
    let depths = curves.iter().flat_map(|curve| curve.indentation.iter().copied());
    let forces = curves.iter().flat_map(|curve| curve.force.iter().copied());
    let x_axis = Axis::over(depths, "m", "indentation, negative for a gap", false, 0.03);
    let y_axis = Axis::over(forces, "N", "force on the tip", false, 0.06);
    let mut entries = Vec::new();
    for (number, curve) in curves.iter().enumerate() {
        let shade = LINES[number % LINES.len()];
        let sample = if is_retraction(curve) { Key::Dashes(shade) } else { Key::Line(shade) };
        entries.push((sample, names[number].clone()));
    }
    let (width, height, top) = (560.0, 360.0, 40.0);
    let left = left_margin(&y_axis, height);
    let total_width = left + width + 28.0;
    let key_top = top + height + 64.0;
    let total = (total_width, key_top + key_rows(width, &entries) * KEY_ROW);
    picture(total, |canvas| {
        title(canvas, heading, left, total_width)?;
        let frame = Frame { canvas, left, top, width, height, x: &x_axis, y: &y_axis };
        frame.grid()?;
        let (x, y) = (x_axis.place(0.0), y_axis.place(0.0));
        if (0.0..=1.0).contains(&y) {
            let y = top + (1.0 - y) * height;
            canvas.line(&[(left, y), (left + width, y)], INK, 0.8)?;
        }
        if (0.0..=1.0).contains(&x) {
            let x = left + x * width;
            canvas.line(&[(x, top), (x, top + height)], INK, 0.8)?;
        }
        for (number, curve) in curves.iter().enumerate() {
            let points: Vec<(f64, f64)> = curve
                .indentation
                .iter()
                .zip(&curve.force)
                .map(|(&depth, &force)| frame.at(depth, force))
                .filter(|at| at.0.is_finite() && at.1.is_finite())
                .collect();
            let shade = LINES[number % LINES.len()];
            if is_retraction(curve) {
                canvas.dashes(&points, shade, 2.0)?;
            } else {
                canvas.line(&points, shade, 2.0)?;
            }
        }
        frame.edges(true, true)?;
        key(canvas, (left, key_top), left + width, &entries)
    })
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

fn is_retraction(curve: &ForceCurve) -> bool {
    curve.branch == "retract"
}
