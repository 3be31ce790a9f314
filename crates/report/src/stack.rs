//! Panels of one width above each other, with their title above them and their key above or below.

use super::axis::PlotAxis;
use super::canvas::picture;
use super::frame::{Frame, KEY_ROW, Legend, key, key_rows, left_margin, title};

/// How such a picture is laid out, in pixels.
pub(super) struct Stack {
    /// Width of the panels, and what lies between two.
    pub width: f64,
    pub gap: f64,
    /// Upper end of the panels where there is no key above them.
    pub top: f64,
    /// Middle of the first row of a key above the panels; below them without it.
    pub key: Option<f64>,
    /// How far the title may reach beyond the panels.
    pub beyond: f64,
}

impl Stack {
    /// The picture as SVG. Each of `panels` has its axis upwards and its height; `draw` fills their frames, by their numbers.
    pub fn draw(
        &self,
        (heading, entries): (&str, &[(Legend, String)]),
        x: &PlotAxis,
        panels: &[(&PlotAxis, f64)],
        mut draw: impl FnMut(usize, &Frame),
    ) -> String {
        let width = self.width;
        let left = panels.iter().map(|(y, height)| left_margin(y, *height)).fold(0.0, f64::max);
        let right = left + width;
        let room = key_rows(width, entries) * KEY_ROW;
        let top = if self.key.is_some() { self.top + room } else { self.top };
        let bottom = top + panels.iter().map(|(_, height)| height + self.gap).sum::<f64>() - self.gap;
        let (size, key_top) = match self.key {
            Some(key_top) => ((right + 24.0, bottom + 52.0), key_top),
            None => ((right + 28.0, bottom + 64.0 + room), bottom + 64.0),
        };
        picture(size, |canvas| {
            title(canvas, heading, left, right + self.beyond);
            if self.key.is_some() {
                key(canvas, (left, key_top), right, entries);
            }
            let mut top = top;
            for (number, (y, height)) in panels.iter().enumerate() {
                draw(number, &Frame { canvas, left, top, width, height: *height, x, y });
                top += height + self.gap;
            }
            if self.key.is_none() {
                key(canvas, (left, key_top), right, entries);
            }
        })
    }
}
