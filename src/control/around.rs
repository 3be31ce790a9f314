//! Solved instances of a sweep, and what they say of the ones between them.

use super::levels::{Level, Weighted};
use crate::engine::Finished;
use crate::plan::Plan;
use crate::steady::{Hint, Neighbour, Node, PeriodicState};

/// Of an instance the states of its first two runs.
pub(super) type Solved = Option<Box<[Node; 2]>>;

/// Of some instances what others rest on.
pub(super) struct Around<'a> {
    /// By instance of the whole plan.
    solved: &'a [Solved],
    /// By instance of the portion.
    lines: Vec<Vec<Weighted>>,
}

impl<'a> Around<'a> {
    /// For these points of a level.
    pub fn new(level: &Level, points: &[u32], solved: &'a [Solved]) -> Self {
        Self { solved, lines: points.iter().map(|point| level.line(*point)).collect() }
    }

    /// For the first run of each of these instances of the portion: where its neighbours' first runs lead to.
    pub fn first(&self, instances: &[u32]) -> Vec<Option<Hint<'a>>> {
        let of = |i: &u32| {
            let hint = |weighted: &Weighted, [first, _]: &'a [Node; 2]| neighbour(weighted, first, None);
            Some(Hint { neighbours: self.line(*i, hint)?, own: None })
        };
        instances.iter().map(of).collect()
    }

    /// For the second run: from the instance's own state in the first, by how far the two are apart at its neighbours.
    pub fn second(&self, found: &[Option<&'a PeriodicState>]) -> Vec<Option<Hint<'a>>> {
        let of = |(i, own): (usize, &Option<&'a PeriodicState>)| {
            let hint = |weighted: &Weighted, [first, second]: &'a [Node; 2]| {
                neighbour(weighted, second, Some(first))
            };
            Some(Hint { own: Some((*own)?), neighbours: self.line(i as u32, hint)? })
        };
        found.iter().enumerate().map(of).collect()
    }

    /// The neighbours of an instance; where one of the farther ones is not known, the nearest two. None where one of these
    /// is not.
    fn line<T>(&self, i: u32, hint: impl Fn(&Weighted, &'a [Node; 2]) -> T) -> Option<Vec<T>> {
        let line = &self.lines[i as usize];
        let node = |weighted: &Weighted| self.solved[weighted.0 as usize].as_deref();
        let all = |line: &[Weighted]| -> Option<Vec<T>> {
            line.iter().map(|one| Some(hint(one, node(one)?))).collect()
        };
        let nearest = || -> Vec<Weighted> {
            line.iter().filter(|one| one.2 != 0.0).map(|(i, _, nearest)| (*i, *nearest, *nearest)).collect()
        };
        all(line).or_else(|| all(&nearest()))
    }
}

fn neighbour<'a>((_, weight, nearest): &Weighted, node: &'a Node, before: Option<&'a Node>) -> Neighbour<'a> {
    Neighbour { node, before, weight: *weight, nearest: *nearest }
}

/// What later instances may rest on of one: both its first two runs have found it.
pub(super) fn solved(
    (first, i, before): (&Plan, u32, &Finished),
    (second, there, after): (&Plan, u32, &Finished),
    (rough, fine): (Option<&PeriodicState>, Option<&PeriodicState>),
) -> Solved {
    let rough = Node::new(first, i, rough?, before)?;
    let fine = Node::new(second, there, fine?, after)?;
    Some(Box::new([rough, fine]))
}
