//! An SVG picture drawn with plotters, in pixels with fractions.

use super::ReportError;
use plotters::coord::Shift;
use plotters::element::{Circle, PathElement, Polygon, Rectangle, Text};
use plotters::prelude::{DrawingArea, IntoDrawingArea, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, IntoFont, RGBColor, ShapeStyle, TextStyle};
use std::cell::RefCell;

/// Plotters places things on whole units; a pixel is this many of them.
const FINE: f64 = 10.0;

pub(super) const INK: RGBColor = RGBColor(34, 34, 34);
pub(super) const GREY: RGBColor = RGBColor(120, 120, 120);
pub(super) const PALE: RGBColor = RGBColor(228, 228, 228);
/// What stands back: outside the limits asked for.
pub(super) const BACK: RGBColor = RGBColor(202, 202, 202);
pub(super) const WHITE: RGBColor = RGBColor(255, 255, 255);
/// Stands for an image until the picture is whole.
const PLACEHOLDER: RGBColor = RGBColor(1, 2, 3);
/// Lines told apart by readers with any colour vision: blue, vermilion, green, plum, ochre, sky.
pub(super) const LINES: [RGBColor; 6] = [
    RGBColor(0, 95, 170),
    RGBColor(205, 85, 10),
    RGBColor(0, 140, 105),
    RGBColor(175, 95, 150),
    RGBColor(190, 130, 0),
    RGBColor(70, 165, 220),
];

/// Where a text stands relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Left,
    Middle,
    Right,
    /// Read from below, centred.
    Upward,
}

pub(super) struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
    /// Addresses of images, in the order of their placeholders.
    images: RefCell<Vec<String>>,
}

/// Draws a picture of this size in pixels and gives its SVG text.
pub(super) fn picture(
    (width, height): (f64, f64),
    draw: impl FnOnce(&Canvas) -> Result<(), ReportError>,
) -> Result<String, ReportError> {
    let mut svg = String::new();
    let images;
    let size = ((width * FINE) as u32, (height * FINE) as u32);
    {
        let area = SVGBackend::with_string(&mut svg, size).into_drawing_area();
        let canvas = Canvas { area, images: RefCell::default() };
        canvas.rectangle((0.0, 0.0), (width, height), WHITE)?;
        draw(&canvas)?;
        canvas.area.present().map_err(ReportError::draw)?;
        images = canvas.images.into_inner();
    }
    for address in images {
        svg = with_image(&svg, &address);
    }
    // The drawing keeps its fine units; the picture is shown at its size in pixels.
    let fine = format!("width=\"{}\" height=\"{}\" viewBox", size.0, size.1);
    // Said of every shape and true without saying: a third of a map's size.
    let svg = svg.replace(" opacity=\"1\"", "").replace(" stroke=\"none\"", "");
    Ok(svg.replacen(&fine, &format!("width=\"{width:.0}\" height=\"{height:.0}\" viewBox"), 1))
}

/// The picture with an image in place of the first placeholder.
fn with_image(svg: &str, address: &str) -> String {
    let shade = format!("fill=\"#{:02X}{:02X}{:02X}\"", PLACEHOLDER.0, PLACEHOLDER.1, PLACEHOLDER.2);
    let Some(begin) = svg.find(&shade).and_then(|at| svg[..at].rfind("<rect")) else { return svg.to_owned() };
    let Some(length) = svg[begin..].find("/>") else { return svg.to_owned() };
    let place = svg[begin..begin + length].trim_start_matches("<rect").replace(&shade, "");
    let image = format!("<image{place} preserveAspectRatio=\"none\" href=\"{address}\"/>");
    format!("{}{image}{}", &svg[..begin], &svg[begin + length + 2..])
}

fn fine((x, y): (f64, f64)) -> (i32, i32) {
    ((x * FINE).round() as i32, (y * FINE).round() as i32)
}

fn stroke(colour: RGBColor, width: f64) -> ShapeStyle {
    ShapeStyle { color: colour.to_rgba(), filled: false, stroke_width: ((width * FINE) as u32).max(1) }
}

/// Width of a text in pixels, roughly: the viewer's font is not known here.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * size * 0.56
}

impl Canvas<'_> {
    pub fn rectangle(&self, a: (f64, f64), b: (f64, f64), colour: RGBColor) -> Result<(), ReportError> {
        let shape = Rectangle::new([fine(a), fine(b)], colour.filled());
        self.area.draw(&shape).map_err(ReportError::draw)
    }

    /// An area that covers its ground by this share.
    pub fn shade(&self, points: &[(f64, f64)], (colour, cover): (RGBColor, f64)) -> Result<(), ReportError> {
        let points: Vec<(i32, i32)> = points.iter().map(|&point| fine(point)).collect();
        self.area.draw(&Polygon::new(points, colour.mix(cover).filled())).map_err(ReportError::draw)
    }

    /// An image, given by its address, that fills this rectangle. The drawing library has no such element: a rectangle of a
    /// colour that nothing else has stands for it until the picture is whole.
    pub fn image(&self, a: (f64, f64), b: (f64, f64), address: String) -> Result<(), ReportError> {
        self.images.borrow_mut().push(address);
        self.rectangle(a, b, PLACEHOLDER)
    }

    pub fn outline(&self, a: (f64, f64), b: (f64, f64)) -> Result<(), ReportError> {
        // As a line: plotters gives rectangles no line width.
        self.line(&[a, (b.0, a.1), b, (a.0, b.1), a, (b.0, a.1)], INK, 1.0)
    }

    pub fn line(&self, points: &[(f64, f64)], colour: RGBColor, width: f64) -> Result<(), ReportError> {
        if points.len() < 2 {
            return Ok(());
        }
        let points: Vec<(i32, i32)> = points.iter().map(|&point| fine(point)).collect();
        self.area.draw(&PathElement::new(points, stroke(colour, width))).map_err(ReportError::draw)
    }

    /// A line, or one of dashes.
    pub fn stroke(
        &self,
        points: &[(f64, f64)],
        (colour, width): (RGBColor, f64),
        dashed: bool,
    ) -> Result<(), ReportError> {
        if dashed { self.dashes(points, colour, width) } else { self.line(points, colour, width) }
    }

    /// A line of dashes, for what must be told from its neighbour without colour.
    pub fn dashes(&self, points: &[(f64, f64)], colour: RGBColor, width: f64) -> Result<(), ReportError> {
        const DASH: f64 = 6.0;
        let mut travelled = 0.0;
        let mut dash: Vec<(f64, f64)> = Vec::new();
        for pair in points.windows(2) {
            let (dx, dy) = (pair[1].0 - pair[0].0, pair[1].1 - pair[0].1);
            let length = dx.hypot(dy);
            let pieces = (length / 1.5).ceil().clamp(1.0, 4000.0);
            for piece in 0..=pieces as usize {
                let share = piece as f64 / pieces;
                let on = (travelled + share * length) % (DASH * 1.7) < DASH;
                if on {
                    dash.push((pair[0].0 + share * dx, pair[0].1 + share * dy));
                } else {
                    self.line(&dash, colour, width)?;
                    dash.clear();
                }
            }
            travelled += length;
        }
        self.line(&dash, colour, width)
    }

    pub fn dot(&self, at: (f64, f64), radius: f64, colour: RGBColor) -> Result<(), ReportError> {
        let shape = Circle::new(fine(at), (radius * FINE) as i32, colour.filled());
        self.area.draw(&shape).map_err(ReportError::draw)
    }

    pub fn ring(&self, at: (f64, f64), radius: f64, colour: RGBColor) -> Result<(), ReportError> {
        // As two dots: plotters gives circles no line width.
        self.dot(at, radius, colour)?;
        self.dot(at, radius - 1.3, WHITE)
    }

    pub fn cross(&self, (x, y): (f64, f64), half: f64, colour: RGBColor) -> Result<(), ReportError> {
        self.line(&[(x - half, y - half), (x + half, y + half)], colour, 1.3)?;
        self.line(&[(x - half, y + half), (x + half, y - half)], colour, 1.3)
    }

    /// A grey rectangle with slanted lines: a case that failed.
    pub fn hatched(&self, a: (f64, f64), b: (f64, f64)) -> Result<(), ReportError> {
        self.rectangle(a, b, PALE)?;
        let (left, right, top, bottom) = (a.0.min(b.0), a.0.max(b.0), a.1.min(b.1), a.1.max(b.1));
        // Lines x + y = const on one lattice for the whole picture, so that neighbours join.
        let first = ((left + top) / 6.0).ceil() as i64;
        let last = ((right + bottom) / 6.0).floor() as i64;
        for number in first..=last.min(first + 2000) {
            let sum = number as f64 * 6.0;
            let from = (sum - top).min(right);
            let to = (sum - bottom).max(left);
            self.line(&[(from, sum - from), (to, sum - to)], GREY, 0.8)?;
        }
        Ok(())
    }

    /// A text whose middle is at the height of `at`; `size` is that of the letters in pixels.
    pub fn text(
        &self,
        text: &str,
        at: (f64, f64),
        size: f64,
        anchor: Anchor,
        colour: RGBColor,
    ) -> Result<(), ReportError> {
        // Plotters takes the height of a line, 1.24 times that of the letters.
        let font = ("sans-serif", size * 1.24 * FINE).into_font();
        let (font, across) = match anchor {
            Anchor::Left => (font, HPos::Left),
            Anchor::Middle => (font, HPos::Center),
            Anchor::Right => (font, HPos::Right),
            Anchor::Upward => (font.transform(FontTransform::Rotate270), HPos::Center),
        };
        let style = TextStyle::from(font).color(&colour).pos(Pos::new(across, VPos::Center));
        self.area.draw(&Text::new(text.to_owned(), fine(at), style)).map_err(ReportError::draw)
    }
}

impl ReportError {
    pub(super) fn draw<E: std::error::Error + Send + Sync>(
        error: plotters::drawing::DrawingAreaErrorKind<E>,
    ) -> Self {
        Self::Draw { why: error.to_string() }
    }
}
