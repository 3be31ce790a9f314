//! What pictures have in common: the frame with its ticks, the key below it, colours for values.

use super::axis::PlotAxis;
use super::canvas::{Anchor, Canvas, GREY, INK, PALE, Rgb, WHITE, text_width};
use crate::observe::Status;
use crate::store::NO_STATE;
use std::collections::BTreeMap;

/// Letters of ticks and keys, of labels, of titles.
pub(super) const SMALL: f64 = 12.0;
pub(super) const LABEL: f64 = 13.0;
pub(super) const TITLE: f64 = 15.0;

/// What keys say of values that are nothing, of none where nothing failed, and of those beyond the reader's limits.
pub(super) const NOTHING: &str = "0 within error";
pub(super) const NO_VALUE: &str = "no value, nothing failed";
pub(super) const BEYOND: &str = "outside the limits asked for";

/// Stands for the status of an instance that is outside the reader's limits.
pub(super) const EXCLUDED: u8 = 254;

/// What a status code means, in words.
pub(super) fn status_word(code: u8) -> String {
    match Status::from_code(code) {
        Some(Status::NoSetpoint) => "no set-point".to_owned(),
        Some(status) => status.meaning().replace('_', " "),
        None if code == EXCLUDED => BEYOND.to_owned(),
        None if code == NO_STATE => "no such state".to_owned(),
        None => format!("code {code}"),
    }
}

/// What a picture shows for one instance.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// A value to be trusted.
    Good,
    /// A value of an instance that is not steady, sensitive or above the accuracy asked for, by the code of its status.
    Doubtful(u8),
    /// A value that is nothing within its error.
    Zero,
    /// No value though nothing failed: never in contact.
    Empty,
    /// No value to be had, by the code of the status.
    Failed(u8),
    /// Outside the limits that the reader asked for.
    Excluded,
}

impl State {
    /// Of a status code (see [`Status`]) and a value.
    pub fn of(status: u8, value: f64) -> Self {
        match Status::from_code(status) {
            Some(Status::Ok) if value.is_finite() => Self::Good,
            Some(Status::NotSteady | Status::Sensitive | Status::AccuracyNotMet) if value.is_finite() => {
                Self::Doubtful(status)
            }
            Some(Status::Ok | Status::NotSteady | Status::Sensitive | Status::AccuracyNotMet) => Self::Empty,
            None if status == NO_STATE => Self::Empty,
            None if status == EXCLUDED && value.is_finite() => Self::Excluded,
            None if status == EXCLUDED => Self::Empty,
            _ => Self::Failed(status),
        }
    }

    /// The same for a value with an error of this size.
    pub fn within(self, value: f64, error: f64) -> Self {
        if self.has_value() && value.abs() <= error { Self::Zero } else { self }
    }

    /// A value that counts; what is nothing within its error is 0.
    pub(super) fn counted(self, value: f64) -> Option<f64> {
        if self == Self::Zero { Some(0.0) } else { self.has_value().then_some(value) }
    }

    /// Whether there is a value to show.
    pub fn has_value(self) -> bool {
        matches!(self, Self::Good | Self::Doubtful(_))
    }
}

/// How many instances are in each state, and in which words to say it.
#[derive(Clone, Debug, Default)]
pub(super) struct Tally {
    doubtful: BTreeMap<u8, usize>,
    failed: BTreeMap<u8, usize>,
    zero: usize,
    empty: usize,
    excluded: usize,
}

impl Tally {
    pub fn of(states: impl Iterator<Item = State>) -> Self {
        let mut tally = Self::default();
        for state in states {
            match state {
                State::Good => {}
                State::Doubtful(code) => *tally.doubtful.entry(code).or_default() += 1,
                State::Failed(code) => *tally.failed.entry(code).or_default() += 1,
                State::Zero => tally.zero += 1,
                State::Empty => tally.empty += 1,
                State::Excluded => tally.excluded += 1,
            }
        }
        tally
    }

    /// Entries of a key for what there is, with a sample for each: of what is doubtful, nothing, without a value, failed,
    /// outside the limits.
    pub fn entries(&self, samples: [Legend; 5]) -> Vec<(Legend, String)> {
        let codes = |counts: &BTreeMap<u8, usize>| {
            let one = |(code, count): (&u8, &usize)| format!("{} ({count})", status_word(*code));
            counts.iter().map(one).collect::<Vec<_>>().join(", ")
        };
        let count = |words: &str, count: usize| match count {
            0 => String::new(),
            count => format!("{words} ({count})"),
        };
        let words = [
            codes(&self.doubtful),
            count(NOTHING, self.zero),
            count(NO_VALUE, self.empty),
            codes(&self.failed),
            count(BEYOND, self.excluded),
        ];
        samples.into_iter().zip(words).filter(|one| !one.1.is_empty()).collect()
    }
}

/// A sample in a key.
#[derive(Clone, Copy, Debug)]
pub(super) enum Legend {
    Line(Rgb),
    Thin(Rgb),
    Dashes(Rgb),
    Dot(Rgb),
    Ring(Rgb),
    Cross(Rgb),
    /// An upright stroke.
    Tick(Rgb),
    Swatch(Rgb),
    /// That covers its ground by a share.
    Shade(Rgb, f64),
    Marked(Rgb),
    Hatched,
}

/// Height of a key's row.
pub(super) const KEY_ROW: f64 = 20.0;

/// Draws samples with their meanings from (x, y) on, in rows that end before `right`.
pub(super) fn key(canvas: &Canvas, (left, top): (f64, f64), right: f64, entries: &[(Legend, String)]) {
    let (mut x, mut y) = (left, top);
    for (sample, text) in entries {
        let width = 30.0 + text_width(text, SMALL) + 16.0;
        if x > left && x + width > right {
            (x, y) = (left, y + KEY_ROW);
        }
        let (a, b) = ((x, y - 6.0), (x + 22.0, y + 6.0));
        let middle = (x + 11.0, y);
        match *sample {
            Legend::Line(colour) => canvas.line(&[(a.0, y), (b.0, y)], colour, 2.0),
            Legend::Thin(colour) => canvas.line(&[(a.0, y), (b.0, y)], colour, 0.8),
            Legend::Dashes(colour) => canvas.dashes(&[(a.0, y), (b.0, y)], colour, 2.0),
            Legend::Dot(colour) => canvas.dot(middle, 3.0, colour),
            Legend::Ring(colour) => canvas.ring(middle, 3.5, colour),
            Legend::Cross(colour) => canvas.cross(middle, 3.5, colour),
            Legend::Tick(colour) => canvas.line(&[(middle.0, y - 4.0), (middle.0, y + 4.0)], colour, 1.3),
            Legend::Swatch(colour) => canvas.rectangle(a, b, colour),
            Legend::Shade(colour, cover) => canvas.shade(&[a, (b.0, a.1), b, (a.0, b.1)], (colour, cover)),
            Legend::Marked(colour) => {
                canvas.rectangle(a, b, colour);
                mark(canvas, middle);
            }
            Legend::Hatched => canvas.hatched(a, b),
        }
        canvas.text(text, (x + 28.0, y), SMALL, Anchor::Left, INK);
        x += width;
    }
}

/// Rows that [`key`] needs.
pub(super) fn key_rows(width: f64, entries: &[(Legend, String)]) -> f64 {
    let (mut x, mut rows) = (0.0, f64::from(u8::from(!entries.is_empty())));
    for (_, text) in entries {
        let entry = 30.0 + text_width(text, SMALL) + 16.0;
        if x > 0.0 && x + entry > width {
            (x, rows) = (0.0, rows + 1.0);
        }
        x += entry;
    }
    rows
}

/// The mark of a doubtful value on a coloured cell: seen on dark and light colours.
pub(super) fn mark(canvas: &Canvas, at: (f64, f64)) {
    canvas.dot(at, 2.4, INK);
    canvas.dot(at, 1.5, WHITE)
}

/// Whether a place can be shown.
pub(super) fn is_place(at: &(f64, f64)) -> bool {
    at.0.is_finite() && at.1.is_finite()
}

/// The pieces of a line between places that cannot be shown.
pub(super) fn pieces(places: &[(f64, f64)]) -> impl Iterator<Item = &[(f64, f64)]> {
    places.split(|at| !is_place(at))
}

/// A plotting field with its two axes.
pub(super) struct Frame<'a> {
    pub canvas: &'a Canvas,
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    pub x: &'a PlotAxis,
    pub y: &'a PlotAxis,
}

impl Frame<'_> {
    /// Pixels of a value pair; NaN where it cannot be shown.
    pub fn at(&self, x: f64, y: f64) -> (f64, f64) {
        (self.left + self.x.place(x) * self.width, self.top + (1.0 - self.y.place(y)) * self.height)
    }

    /// Whether a place lies in it.
    pub fn holds(&self, (x, y): (f64, f64)) -> bool {
        let (right, bottom) = (self.left + self.width, self.top + self.height);
        (self.left..=right).contains(&x) && (self.top..=bottom).contains(&y)
    }

    /// The lines of zero, upright ones where asked for.
    pub fn zeros(&self, upright: bool) {
        let (x, y) = self.at(0.0, 0.0);
        let (right, bottom) = (self.left + self.width, self.top + self.height);
        if (0.0..=1.0).contains(&self.y.place(0.0)) {
            self.canvas.line(&[(self.left, y), (right, y)], INK, 0.8);
        }
        if upright && (0.0..=1.0).contains(&self.x.place(0.0)) {
            self.canvas.line(&[(x, self.top), (x, bottom)], INK, 0.8);
        }
    }

    /// Words in its middle.
    pub fn words(&self, text: &str) {
        let middle = (self.left + self.width / 2.0, self.top + self.height / 2.0);
        self.canvas.text(text, middle, SMALL, Anchor::Middle, INK)
    }

    /// The fine grid, to be drawn before the data.
    pub fn grid(&self) {
        let (right, bottom) = (self.left + self.width, self.top + self.height);
        for (place, _) in self.x.ticks(self.x_count()).0 {
            let x = self.left + place * self.width;
            self.canvas.line(&[(x, self.top), (x, bottom)], PALE, 0.8);
        }
        for (place, _) in self.y.ticks(self.y_count()).0 {
            let y = bottom - place * self.height;
            self.canvas.line(&[(self.left, y), (right, y)], PALE, 0.8);
        }
    }

    fn x_count(&self) -> usize {
        (self.width / 75.0) as usize + 1
    }

    fn y_count(&self) -> usize {
        (self.height / 45.0) as usize + 1
    }

    /// The box and its ticks, to be drawn after the data; labels where asked for.
    pub fn edges(&self, x_labels: bool, y_labels: bool) {
        self.ticks(x_labels, y_labels);
        if x_labels {
            self.x_label(self.left + self.width / 2.0);
        }
    }

    /// The words below the x axis, centred here.
    pub fn x_label(&self, middle: f64) {
        let y = self.top + self.height + 36.0;
        self.canvas.text(&self.x.label, (middle, y), LABEL, Anchor::Middle, INK)
    }

    /// As [`Frame::edges`] without the words below the x axis.
    pub fn ticks(&self, x_labels: bool, y_labels: bool) {
        let (right, bottom) = (self.left + self.width, self.top + self.height);
        let canvas = self.canvas;
        let (ticks, small) = self.x.ticks(self.x_count());
        let mut free = f64::NEG_INFINITY;
        // Names are cut to their places, so that none is missing.
        let room = if self.x.has_names() { self.width / ticks.len().max(1) as f64 } else { f64::INFINITY };
        for (place, text) in &ticks {
            let x = self.left + place * self.width;
            canvas.line(&[(x, bottom), (x, bottom + 5.0)], INK, 1.0);
            let text = &cut(text, room - 5.0);
            let half = text_width(text, SMALL) / 2.0;
            if x_labels && x - half > free {
                canvas.text(text, (x, bottom + 15.0), SMALL, Anchor::Middle, INK);
                free = x + half + 4.0;
            }
        }
        for place in small {
            let x = self.left + place * self.width;
            canvas.line(&[(x, bottom), (x, bottom + 3.0)], GREY, 0.8);
        }
        let (ticks, small) = self.y.ticks(self.y_count());
        for (place, text) in &ticks {
            let y = bottom - place * self.height;
            canvas.line(&[(self.left - 5.0, y), (self.left, y)], INK, 1.0);
            if y_labels {
                canvas.text(text, (self.left - 8.0, y), SMALL, Anchor::Right, INK);
            }
        }
        for place in small {
            let y = bottom - place * self.height;
            canvas.line(&[(self.left - 3.0, y), (self.left, y)], GREY, 0.8);
        }
        if y_labels {
            let x = self.left - 16.0 - widest(&ticks) - LABEL * 0.6;
            upward(canvas, self.y, (x, self.top + self.height / 2.0), self.height);
        }
        canvas.outline((self.left, self.top), (right, bottom))
    }
}

/// An upright label in the room it has: in smaller letters, or the unit alone, where it is too long.
pub(super) fn upward(canvas: &Canvas, axis: &PlotAxis, at: (f64, f64), room: f64) {
    let room = room + 30.0;
    let sizes = [LABEL, SMALL, 11.0, 10.0];
    let size = sizes.into_iter().find(|size| text_width(&axis.label, *size) <= room);
    let short = if axis.unit.text.is_empty() { String::new() } else { format!("in {}", axis.unit.text) };
    let text = if size.is_some() { &axis.label } else { &short };
    canvas.text(text, at, size.unwrap_or(LABEL), Anchor::Upward, INK)
}

fn widest(ticks: &[(f64, String)]) -> f64 {
    ticks.iter().map(|(_, text)| text_width(text, SMALL)).fold(0.0, f64::max)
}

/// Room that an axis needs at the left of a field of this height.
pub(super) fn left_margin(axis: &PlotAxis, height: f64) -> f64 {
    16.0 + widest(&axis.ticks((height / 45.0) as usize + 1).0) + LABEL * 1.2 + 10.0
}

/// A colour for a value from 0 to 1: from dark violet to yellow with lightness rising evenly, so that
/// the order of values is seen with any colour vision and in a grey copy.
pub(super) fn colour(place: f64) -> Rgb {
    // Evenly spaced in the lightness of the Oklab space (0.26 to 0.92), the hue turning from 305 to 100
    // degrees, the saturation changing smoothly within what a screen can show.
    const POINTS: [u32; 12] = [
        0x340255, 0x31216e, 0x283c7e, 0x1a5589, 0x136c8f, 0x218292, 0x2a9896, 0x43ad94, 0x68c18c, 0x95d17e,
        0xc8de6d, 0xfde75f,
    ];
    let at = if place.is_nan() { 0.0 } else { place.clamp(0.0, 1.0) } * (POINTS.len() - 1) as f64;
    let below = (at as usize).min(POINTS.len() - 2);
    let share = at - below as f64;
    let (a, b) = (POINTS[below], POINTS[below + 1]);
    let channel = |colour: u32, shift: u32| f64::from((colour >> shift) as u8);
    let mix = |shift| (channel(a, shift) + share * (channel(b, shift) - channel(a, shift))).round() as u8;
    Rgb(mix(16), mix(8), mix(0))
}

/// A title from `left` on that ends before `right`: in smaller letters, or cut, where it is too long.
pub(super) fn title(canvas: &Canvas, text: &str, left: f64, right: f64) {
    let room = right - left - 8.0;
    let fits = |size: &f64| text_width(text, *size) <= room;
    let size = [TITLE, 14.0, LABEL, SMALL].into_iter().find(fits);
    let shown = if size.is_some() { text.to_owned() } else { cut(text, room) };
    canvas.text(&shown, (left, 20.0), size.unwrap_or(SMALL), Anchor::Left, INK)
}

/// A text in small letters, cut where there is no room for it.
fn cut(text: &str, room: f64) -> String {
    if text_width(text, SMALL) <= room {
        return text.to_owned();
    }
    let mut shown = text.to_owned();
    while !shown.is_empty() && text_width(&shown, SMALL) + SMALL > room {
        shown.pop();
    }
    format!("{}…", shown.trim_end())
}
