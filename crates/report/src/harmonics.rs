//! One instance's harmonics as sticks: travel and force in panels above each other.

use super::axis::PlotAxis;
use super::canvas::LINES;
use super::csv::{number, table};
use super::frame::{Frame, is_place};
use super::hover::{Hint, Hover};
use super::quantity_text::shown;
use super::stack::Stack;
use crate::store::Spectra;

const LAYOUT: Stack = Stack { width: 640.0, gap: 16.0, top: 40.0, key: Some(40.0), beyond: 24.0 };

/// Amplitudes below this share of a panel's largest are not drawn.
const FLOOR: f64 = 1e-6;
/// A harmonic above this share of the first is told in words.
const TOLD: f64 = 0.01;
/// Harmonics that are told one by one.
const MOST_TOLD: usize = 12;

/// One quantity over the harmonics.
struct Panel<'a> {
    label: &'static str,
    units: &'static str,
    amplitude: &'a [f64],
    phase: &'a [f64],
    axis: PlotAxis,
    /// What the axis ends at.
    floor: f64,
}

/// The picture of row `row` of the spectra, and what the pointer is told of it.
pub(super) fn draw(spectra: &Spectra, row: usize, heading: &str) -> (String, Hover) {
    let of = |rows: &'_ [Vec<f64>]| rows.get(row).cloned().unwrap_or_default();
    let frequency = of(&spectra.frequency);
    let (tip, tip_phase) = (of(&spectra.tip_amplitude), of(&spectra.tip_phase));
    let (force, force_phase) = (of(&spectra.force_amplitude), of(&spectra.force_phase));
    let panels = [
        Panel::new(("travel of the tip", "m"), &tip, &tip_phase),
        Panel::new(("force on the tip", "N"), &force, &force_phase),
    ];
    let last = last(&panels) as f64;
    let first = frequency.first().copied().unwrap_or(f64::NAN);
    let label = format!("harmonic of {}", shown(first, "Hz", 6));
    let x_axis = PlotAxis::over([0.0, last + 1.0].into_iter(), "1", &label, false, 0.0);
    let places: Vec<(&PlotAxis, f64)> = panels.iter().map(|panel| (&panel.axis, 190.0)).collect();
    let mut hover = Hover::default();
    let svg = LAYOUT.draw((heading, &[]), &x_axis, &places, |number, frame| {
        frame.grid();
        hover.points(panels[number].sticks(frame, &frequency));
        frame.edges(number == 1, true)
    });
    (svg, hover)
}

/// The last harmonic that any of the panels shows, 1 at least.
fn last(panels: &[Panel]) -> usize {
    let of = |panel: &Panel| panel.amplitude.iter().rposition(|value| *value >= panel.floor);
    panels.iter().filter_map(of).max().map_or(1, |at| at + 1)
}

impl<'a> Panel<'a> {
    fn new((label, units): (&'static str, &'static str), amplitude: &'a [f64], phase: &'a [f64]) -> Self {
        let most = amplitude.iter().copied().filter(|value| value.is_finite()).fold(0.0, f64::max);
        let shown = || amplitude.iter().copied().filter(|value| *value > 0.0 && *value >= FLOOR * most);
        // Whole decades around what is shown.
        let ends = [shown().fold(most, f64::min) / 2.0, most * 2.0];
        let axis = PlotAxis::over(ends.into_iter(), units, label, true, 0.0);
        Self { label, units, amplitude, phase, axis, floor: FLOOR * most.max(f64::MIN_POSITIVE) }
    }

    /// Draws a stick for each harmonic above the floor; gives their ends with what they stand for.
    fn sticks(&self, frame: &Frame, frequency: &[f64]) -> Vec<Hint> {
        let bottom = frame.top + frame.height;
        // Many of them are thin.
        let apart = frame.at(2.0, f64::NAN).0 - frame.at(1.0, f64::NAN).0;
        let (width, radius) = ((0.6 * apart).min(2.0), (0.5 * apart).clamp(0.6, 2.6));
        let mut told = Vec::new();
        for (i, &amplitude) in self.amplitude.iter().enumerate().filter(|(_, value)| **value >= self.floor) {
            let at = frame.at((i + 1) as f64, amplitude);
            if !is_place(&at) {
                continue;
            }
            let value = |all: &[f64], units| shown(all.get(i).copied().unwrap_or(f64::NAN), units, 4);
            frame.canvas.line(&[(at.0, bottom), at], LINES[0], width);
            frame.canvas.dot(at, radius, LINES[0]);
            let (number, label, size) = (i + 1, self.label, shown(amplitude, self.units, 4));
            let (hz, lag) = (value(frequency, "Hz"), value(self.phase, "degree"));
            told.push((at, format!("harmonic {number} at {hz}: {label} {size}, lag {lag}")));
        }
        if told.is_empty() {
            frame.words("nothing");
        }
        told
    }
}

/// What is seen: the harmonics of travel and of force beyond the first that are more than a hundredth of it.
pub(super) fn told(spectra: &Spectra, row: usize) -> String {
    let one = |what: &str, rows: &[Vec<f64>]| {
        let amplitude = rows.get(row).map_or(&[][..], Vec::as_slice);
        let first = amplitude.first().copied().unwrap_or(f64::NAN);
        let above = |(_, value): &(usize, &f64)| **value > TOLD * first;
        let numbers: Vec<usize> =
            amplitude.iter().enumerate().skip(1).filter(above).map(|(i, _)| i + 1).collect();
        match numbers.as_slice() {
            [] => format!("of the {what} none"),
            [some @ .., last] if some.len() < MOST_TOLD => {
                let some: Vec<String> = some.iter().map(usize::to_string).collect();
                let before = if some.is_empty() { String::new() } else { some.join(", ") + " and " };
                format!("of the {what} {before}{last}")
            }
            all => {
                let (count, last) = (all.len(), all[all.len() - 1]);
                let resolved = amplitude.iter().rposition(|value| value.is_finite()).map_or(0, |i| i + 1);
                // The last that the steps resolve is not where the force ends.
                let cut = if last == resolved { ", the last that the steps resolve" } else { "" };
                format!("of the {what} {count} up to harmonic {last}{cut}")
            }
        }
    };
    format!(
        "Harmonics above 1 % of the first: {}; {}.",
        one("travel", &spectra.tip_amplitude),
        one("force", &spectra.force_amplitude)
    )
}

/// Its numbers; harmonics that its steps do not resolve have none.
pub(super) fn csv(spectra: &Spectra, row: usize) -> String {
    let heads = Spectra::COLUMNS.map(|column| format!("{} [{}]", column.name, column.units));
    let rows = (0..spectra.harmonics()).map(|i| {
        let value = |rows: &[Vec<f64>]| rows.get(row).and_then(|row| row.get(i)).copied();
        let values = Spectra::COLUMNS.map(|column| number(value((column.of)(spectra)).unwrap_or(f64::NAN)));
        std::iter::once((i + 1).to_string()).chain(values).collect()
    });
    table(std::iter::once(std::iter::once("harmonic".to_owned()).chain(heads).collect()).chain(rows))
}
