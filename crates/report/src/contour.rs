//! Lines of equal value over the cells of a map, at the round values that stand beside its colours.

use super::canvas::{Anchor, INK, WHITE, text_width};
use super::frame::{Frame, State};
use super::heat_cells::CellField;
use std::collections::HashMap;

/// Pixels for each line that a map may have.
const ROOM: f64 = 50.0;
/// Shorter ones, in pixels, are not drawn, and more pieces than this at one value are noise.
const SHORTEST: f64 = 24.0;
const MOST_PIECES: usize = 30;
/// Pixels between points of a line, and height of the letters on it.
const STEP: f64 = 1.5;
const LETTERS: f64 = 11.0;

/// Draws the lines of a panel and their values; `cells` are those that the panel shows, the lowest row first, and `branches`
/// the branch of each.
pub(super) fn draw(field: &CellField, cells: &[(f64, State)], branches: &[u8]) {
    let CellField { frame, across, up, bar } = field;
    let values = || cells.iter().filter(|cell| cell.1.has_value()).map(|cell| cell.0);
    // Counts have no values between.
    if across.axis.has_names() || up.axis.has_names() || values().all(|value| value.fract() == 0.0) {
        return;
    }
    let place = |(value, state): &(f64, State)| match state {
        State::Zero => bar.place(0.0),
        state if state.has_value() => bar.place(*value),
        _ => f64::NAN,
    };
    let places: Vec<f64> = cells.iter().map(place).collect();
    let (columns, rows) = field.centres();
    let at = |(x, y): (f64, f64)| (between(&columns, x), between(&rows, y));
    let mut labels = Labels { frame, taken: Vec::new() };
    let (levels, _) = bar.ticks(((frame.height / ROOM) as usize).clamp(2, 5));
    for (level, text) in levels.into_iter().filter(|(place, _)| (0.02..0.98).contains(place)) {
        let lines = lines((&places, branches), columns.len(), level);
        let lines = lines.into_iter().map(|line| thinned(line.into_iter().map(at)));
        let mut lines: Vec<Vec<(f64, f64)>> = lines.filter(|line| length(line) >= SHORTEST).collect();
        if lines.len() > MOST_PIECES {
            continue;
        }
        lines.sort_by(|a, b| length(b).total_cmp(&length(a)));
        for line in &lines {
            frame.canvas.line(line, WHITE, 2.6);
            frame.canvas.line(line, INK, 1.1);
        }
        labels.on(&lines, &bar.unit.of(&text));
    }
    labels.draw()
}

/// The lines of one level through values on a lattice of so many columns, in units of its steps; none goes where a corner
/// has no value, nor from one branch to another: between two branches the value jumps.
fn lines((values, branches): (&[f64], &[u8]), columns: usize, level: f64) -> Vec<Vec<(f64, f64)>> {
    let value = |(x, y): (usize, usize)| values[y * columns + x];
    let rows = values.len() / columns.max(1);
    let mut joined: HashMap<Edge, Vec<Edge>> = HashMap::new();
    for y in 0..rows.saturating_sub(1) {
        for x in 0..columns.saturating_sub(1) {
            // Around the square.
            let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
            let edges = [Edge(x, y, false), Edge(x + 1, y, true), Edge(x, y + 1, false), Edge(x, y, true)];
            let high = corners.map(|corner| value(corner) >= level);
            let sum: f64 = corners.iter().map(|corner| value(*corner)).sum();
            let of = |(x, y): (usize, usize)| branches.get(y * columns + x).copied().filter(|code| *code > 0);
            let mut known = corners.into_iter().filter_map(of);
            let torn = known.next().is_some_and(|first| known.any(|code| code != first));
            if sum.is_nan() || torn {
                continue;
            }
            let crossed: Vec<Edge> =
                (0..4).filter(|n| high[*n] != high[(n + 1) % 4]).map(|n| edges[n]).collect();
            let pairs = match crossed.as_slice() {
                [a, b] => vec![(*a, *b)],
                // A saddle: its middle belongs to one pair of corners.
                [a, b, c, d] if (sum / 4.0 >= level) == high[0] => vec![(*a, *b), (*c, *d)],
                [a, b, c, d] => vec![(*a, *d), (*b, *c)],
                _ => Vec::new(),
            };
            for (a, b) in pairs {
                joined.entry(a).or_default().push(b);
                joined.entry(b).or_default().push(a);
            }
        }
    }
    let point = |edge: Edge| {
        let (a, b) = edge.ends();
        let share = (level - value(a)) / (value(b) - value(a));
        let mix = |a: usize, b: usize| a as f64 + share * (b as f64 - a as f64);
        (mix(a.0, b.0), mix(a.1, b.1))
    };
    // Open lines are begun at their ends; in a set order, so that pictures repeat.
    let mut starts: Vec<(usize, Edge)> = joined.iter().map(|(edge, next)| (next.len(), *edge)).collect();
    starts.sort_unstable();
    let mut found = Vec::new();
    for (_, start) in starts {
        let mut line = Vec::new();
        let (mut at, mut before) = (Some(start), start);
        while let Some((edge, next)) = at.and_then(|edge| Some((edge, joined.remove(&edge)?))) {
            line.push(point(edge));
            at = next.iter().copied().find(|one| joined.contains_key(one));
            if at.is_none() && next.contains(&start) && before != start {
                line.push(point(start));
            }
            before = edge;
        }
        if line.len() > 1 {
            found.push(line);
        }
    }
    found
}

/// The side of a square from a corner on, upwards or to the right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
struct Edge(usize, usize, bool);

impl Edge {
    fn ends(self) -> ((usize, usize), (usize, usize)) {
        let Self(x, y, upward) = self;
        ((x, y), if upward { (x, y + 1) } else { (x + 1, y) })
    }
}

/// The pixel of a place between cells.
fn between(centres: &[f64], place: f64) -> f64 {
    let below = (place.max(0.0) as usize).min(centres.len().saturating_sub(2));
    let (from, to) = (centres[below], centres.get(below + 1).copied().unwrap_or(centres[below]));
    from + (place - below as f64) * (to - from)
}

fn thinned(line: impl Iterator<Item = (f64, f64)>) -> Vec<(f64, f64)> {
    let mut kept: Vec<(f64, f64)> = Vec::new();
    let mut last = None;
    for point in line {
        last = Some(point);
        if kept.last().is_none_or(|one| (one.0 - point.0).hypot(one.1 - point.1) >= STEP) {
            kept.push(point);
            last = None;
        }
    }
    kept.extend(last);
    kept
}

fn length(line: &[(f64, f64)]) -> f64 {
    line.windows(2).map(|pair| (pair[1].0 - pair[0].0).hypot(pair[1].1 - pair[0].1)).sum()
}

/// The values on the lines, drawn after all lines.
struct Labels<'a, 'b> {
    frame: &'a Frame<'b>,
    taken: Vec<Label>,
}

/// A value on a line: its middle, half of its size, and what it says.
struct Label {
    at: (f64, f64),
    half: (f64, f64),
    text: String,
}

impl Labels<'_, '_> {
    /// Finds a place on the longest of these lines that has one.
    fn on(&mut self, lines: &[Vec<(f64, f64)>], text: &str) {
        let half = (text_width(text, LETTERS) / 2.0 + 2.0, LETTERS / 2.0 + 2.0);
        let frame = self.frame;
        let inside = |(x, y): (f64, f64)| {
            (frame.left + half.0..=frame.left + frame.width - half.0).contains(&x)
                && (frame.top + half.1..=frame.top + frame.height - half.1).contains(&y)
        };
        let is_free = |at: &(f64, f64)| {
            let apart = |other: &Label| {
                (other.at.0 - at.0).abs() > half.0 + other.half.0
                    || (other.at.1 - at.1).abs() > half.1 + other.half.1
            };
            inside(*at) && self.taken.iter().all(apart)
        };
        let places = |line: &Vec<(f64, f64)>| {
            let shares = [0.5, 0.35, 0.65, 0.2, 0.8, 0.1, 0.9];
            shares.map(|share| line[((line.len() - 1) as f64 * share) as usize])
        };
        let place = lines.iter().flat_map(places).find(is_free);
        self.taken.extend(place.map(|at| Label { at, half, text: text.to_owned() }));
    }

    fn draw(&self) {
        for Label { at: (x, y), half: (across, up), text } in &self.taken {
            self.frame.canvas.rectangle((x - across, y - up), (x + across, y + up), WHITE);
            self.frame.canvas.text(text, (*x, *y), LETTERS, Anchor::Middle, INK);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lattice(columns: usize, rows: usize, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        (0..rows)
            .flat_map(|y| (0..columns).map(move |x| (x, y)))
            .map(|(x, y)| f(x as f64, y as f64))
            .collect()
    }

    /// Truth: the plane put in, on which interpolation is exact.
    #[test]
    fn the_line_of_a_plane_is_straight() {
        let found = lines((&lattice(9, 7, |x, y| x + 2.0 * y), &[]), 9, 7.3);
        assert_eq!(found.len(), 1);
        assert!(found[0].iter().all(|(x, y)| (x + 2.0 * y - 7.3).abs() < 1e-12), "{found:?}");
        let ends = (found[0][0], found[0][found[0].len() - 1]);
        assert!((ends.0.1 == 0.0) != (ends.1.1 == 0.0), "{ends:?}");
    }

    /// Truth: the circle, and its length.
    #[test]
    fn a_ring_is_closed_and_a_hole_interrupts() {
        let circle = |x: f64, y: f64| (x - 20.0).hypot(y - 20.0);
        let mut values = lattice(41, 41, circle);
        let found = lines((&values, &[]), 41, 12.0);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].first(), found[0].last());
        assert!((length(&found[0]) / (2.0 * std::f64::consts::PI * 12.0) - 1.0).abs() < 2e-3);
        values[20 * 41 + 32] = f64::NAN;
        let open = lines((&values, &[]), 41, 12.0);
        assert_eq!(open.len(), 1);
        assert_ne!(open[0].first(), open[0].last());
    }

    /// Truth: the two planes put in, one on each branch: a line follows each, and none runs along the step between them.
    #[test]
    fn no_line_leads_from_branch_to_branch() {
        let step = |x: f64, y: f64| y + if x < 4.0 { 0.0 } else { 3.0 };
        let values = lattice(9, 7, step);
        let branches: Vec<u8> =
            lattice(9, 7, |x, _| x).iter().map(|x| if *x < 4.0 { 1 } else { 2 }).collect();
        let found = lines((&values, &branches), 9, 4.5);
        assert_eq!(found.len(), 2, "{found:?}");
        for line in &found {
            let height = line[0].1;
            assert!(line.iter().all(|(_, y)| (y - height).abs() < 1e-12), "{line:?}");
        }
        // What is on no branch does not tear lines.
        assert_eq!(lines((&values, &[0; 63]), 9, 4.5).len(), 1);
    }

    /// Truth: by hand: two hills of a chessboard are not joined.
    #[test]
    fn a_saddle_belongs_to_one_side() {
        let found = lines((&[1.0, 0.0, 0.0, 1.0], &[]), 2, 0.6);
        assert_eq!(found.len(), 2);
        assert!(lines((&[1.0, 0.0, 0.0, 1.0], &[]), 2, 2.0).is_empty());
    }
}
