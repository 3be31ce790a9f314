//! An SVG picture, in pixels with fractions.

use std::cell::RefCell;
use std::fmt::{Display, Formatter, Write};

/// Places are whole numbers in the picture's text; a pixel is this many of them.
const FINE: f64 = 10.0;

/// A colour by its red, green and blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rgb(pub u8, pub u8, pub u8);

impl Display for Rgb {
    fn fmt(&self, to: &mut Formatter) -> std::fmt::Result {
        write!(to, "#{:02X}{:02X}{:02X}", self.0, self.1, self.2)
    }
}

pub(super) const INK: Rgb = Rgb(34, 34, 34);
pub(super) const GREY: Rgb = Rgb(120, 120, 120);
pub(super) const PALE: Rgb = Rgb(228, 228, 228);
/// What stands back: outside the limits asked for.
pub(super) const BACK: Rgb = Rgb(202, 202, 202);
pub(super) const WHITE: Rgb = Rgb(255, 255, 255);
/// Lines told apart by readers with any colour vision: blue, vermilion, green, plum, ochre, sky.
pub(super) const LINES: [Rgb; 6] = [
    Rgb(0, 95, 170),
    Rgb(205, 85, 10),
    Rgb(0, 140, 105),
    Rgb(175, 95, 150),
    Rgb(190, 130, 0),
    Rgb(70, 165, 220),
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

/// A picture while it is drawn.
pub(super) struct Canvas {
    /// In the picture's own units.
    size: (i32, i32),
    svg: RefCell<String>,
}

/// Draws a picture of this size in pixels and gives its SVG text.
pub(super) fn picture((width, height): (f64, f64), draw: impl FnOnce(&Canvas)) -> String {
    // The drawing keeps its fine units; the picture is shown at its size in pixels.
    let size @ (wide, high) = ((width * FINE) as i32, (height * FINE) as i32);
    let head = format!(
        "<svg width=\"{width:.0}\" height=\"{height:.0}\" viewBox=\"0 0 {wide} {high}\" \
         xmlns=\"http://www.w3.org/2000/svg\">\n"
    );
    let canvas = Canvas { size, svg: RefCell::new(head) };
    canvas.rectangle((0.0, 0.0), (width, height), WHITE);
    draw(&canvas);
    canvas.svg.into_inner() + "</svg>\n"
}

/// Width of a text in pixels, roughly: the viewer's font is not known here.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * size * 0.56
}

impl Canvas {
    /// A place in the picture's own units; what lies outside stands at its edge.
    fn fine(&self, (x, y): (f64, f64)) -> (i32, i32) {
        let within = |pixels: f64, end: i32| ((pixels * FINE).round() as i32).clamp(0, end);
        (within(x, self.size.0), within(y, self.size.1))
    }

    /// Places as shapes have them.
    fn listed(&self, points: &[(f64, f64)]) -> String {
        let places = points.iter().map(|&point| self.fine(point));
        places.fold(String::new(), |list, (x, y)| list + &format!("{x},{y} "))
    }

    /// Left and upper end of a rectangle, its width and its height.
    fn sides(&self, a: (f64, f64), b: (f64, f64)) -> (i32, i32, i32, i32) {
        let (a, b) = (self.fine(a), self.fine(b));
        (a.0.min(b.0), a.1.min(b.1), (a.0 - b.0).abs(), (a.1 - b.1).abs())
    }

    /// Adds an element.
    fn add(&self, element: std::fmt::Arguments) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.svg.borrow_mut(), "<{element}>");
    }

    pub fn rectangle(&self, a: (f64, f64), b: (f64, f64), colour: Rgb) {
        let (x, y, width, height) = self.sides(a, b);
        self.add(format_args!(
            "rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{colour}\"/"
        ));
    }

    /// An area that covers its ground by this share.
    pub fn shade(&self, points: &[(f64, f64)], (colour, cover): (Rgb, f64)) {
        let points = self.listed(points);
        self.add(format_args!("polygon opacity=\"{cover}\" fill=\"{colour}\" points=\"{points}\"/"));
    }

    /// An image, given by its address, that fills this rectangle.
    pub fn image(&self, a: (f64, f64), b: (f64, f64), address: &str) {
        let (x, y, width, height) = self.sides(a, b);
        self.add(format_args!(
            "image x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\"  preserveAspectRatio=\"none\" \
             href=\"{address}\"/"
        ));
    }

    pub fn outline(&self, a: (f64, f64), b: (f64, f64)) {
        self.line(&[a, (b.0, a.1), b, (a.0, b.1), a, (b.0, a.1)], INK, 1.0);
    }

    pub fn line(&self, points: &[(f64, f64)], colour: Rgb, width: f64) {
        if points.len() > 1 {
            let (width, points) = (((width * FINE) as u32).max(1), self.listed(points));
            self.add(format_args!(
                "polyline fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" points=\"{points}\"/"
            ));
        }
    }

    /// A line, or one of dashes.
    pub fn stroke(&self, points: &[(f64, f64)], (colour, width): (Rgb, f64), dashed: bool) {
        if dashed { self.dashes(points, colour, width) } else { self.line(points, colour, width) }
    }

    /// A line of dashes, for what must be told from its neighbour without colour.
    pub fn dashes(&self, points: &[(f64, f64)], colour: Rgb, width: f64) {
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
                    self.line(&dash, colour, width);
                    dash.clear();
                }
            }
            travelled += length;
        }
        self.line(&dash, colour, width);
    }

    pub fn dot(&self, at: (f64, f64), radius: f64, colour: Rgb) {
        let ((x, y), radius) = (self.fine(at), (radius * FINE) as i32);
        self.add(format_args!(
            "circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" fill=\"{colour}\" stroke-width=\"1\"/"
        ));
    }

    pub fn ring(&self, at: (f64, f64), radius: f64, colour: Rgb) {
        self.dot(at, radius, colour);
        self.dot(at, radius - 1.3, WHITE);
    }

    pub fn cross(&self, (x, y): (f64, f64), half: f64, colour: Rgb) {
        self.line(&[(x - half, y - half), (x + half, y + half)], colour, 1.3);
        self.line(&[(x - half, y + half), (x + half, y - half)], colour, 1.3);
    }

    /// A grey rectangle with slanted lines: a case that failed.
    pub fn hatched(&self, a: (f64, f64), b: (f64, f64)) {
        self.rectangle(a, b, PALE);
        let (left, right, top, bottom) = (a.0.min(b.0), a.0.max(b.0), a.1.min(b.1), a.1.max(b.1));
        // Lines x + y = const on one lattice for the whole picture, so that neighbours join.
        let first = ((left + top) / 6.0).ceil() as i64;
        let last = ((right + bottom) / 6.0).floor() as i64;
        for number in first..=last.min(first + 2000) {
            let sum = number as f64 * 6.0;
            let from = (sum - top).min(right);
            let to = (sum - bottom).max(left);
            self.line(&[(from, sum - from), (to, sum - to)], GREY, 0.8);
        }
    }

    /// A text whose middle is at the height of `at`; `size` is that of the letters in pixels.
    pub fn text(&self, text: &str, at: (f64, f64), size: f64, anchor: Anchor, colour: Rgb) {
        let (x, y) = self.fine(at);
        let (across, turned) = match anchor {
            Anchor::Left => ("start", String::new()),
            Anchor::Middle => ("middle", String::new()),
            Anchor::Right => ("end", String::new()),
            Anchor::Upward => ("middle", format!(" transform=\"rotate(270, {x}, {y})\"")),
        };
        // This way round the last digit is that of earlier pictures.
        let size = size * 1.24 * FINE / 1.24;
        let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
        let text = text.replace('"', "&quot;").replace('\'', "&apos;");
        self.add(format_args!(
            "text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\" text-anchor=\"{across}\" font-family=\"sans-serif\" \
             font-size=\"{size}\" fill=\"{colour}\"{turned}>\n{text}\n</text"
        ));
    }
}
