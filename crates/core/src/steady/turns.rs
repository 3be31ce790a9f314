//! How the states of solved instances are met by one between them that has other steps, another lever or another drive.

use super::linear::undoing;
use super::map::{Turned, free_slope};
use super::node::{Neighbour, Node};
use crate::periodic::{Memory, Size};
use crate::plan::{Drive, Driven, Plan, ReducedBasis};
use nalgebra::{DefaultAllocator, DimName, OMatrix, OVector};
use std::sync::Arc;

/// Where an instance's state is expected, what undoes a change there, and its largest multiplier.
pub(super) struct Guess<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    pub state: OVector<f64, D>,
    /// The inverse of one minus the map's slope.
    pub undoes: OMatrix<f64, D, D>,
    pub multiplier: f64,
    pub touching: bool,
}

/// How states are met by instances of other steps, levers and drives: few kinds of both, each pair worked out once. And room
/// for the guess of one instance after the other.
pub(super) struct Turns<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    pairs: Vec<Turn<D>>,
    /// What was found out by the very levers, in which most are alike.
    known: Vec<Known>,
    /// Of each neighbour of an instance, and of what is known of it before, how its state is met.
    pub met: Vec<[Option<usize>; 2]>,
    pub states: Vec<OVector<f64, D>>,
    /// Neighbours that are turned alike, and what undoes a change of theirs, added up, one after the other.
    alike: Vec<Alike>,
    sums: Vec<f64>,
    /// What undoes a change of theirs, turned.
    undone: OMatrix<f64, D, D>,
    pub guess: Guess<D>,
}

/// Beyond so many pairs, and so many by their levers in memory, they are forgotten: every instance has a lever of its own.
const PAIRS: usize = 64;
const KNOWN: usize = 16;

struct Turn<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    theirs: (Arc<ReducedBasis>, u32),
    own: (Arc<ReducedBasis>, u32),
    drive: Arc<Drive>,
    turned: Turned,
    /// The inverse of one minus the slope without a sample.
    free: OMatrix<f64, D, D>,
}

/// A pair by its levers in memory: none where the state is met as it is.
struct Known {
    theirs: (Arc<ReducedBasis>, u32),
    own: (Arc<ReducedBasis>, u32),
    drive: Arc<Drive>,
    pair: Option<usize>,
}

/// Neighbours that are met by one pair and have as many numbers: their share together, and where their sums begin.
struct Alike {
    pair: usize,
    share: f64,
    from: usize,
    count: usize,
}

/// An instance that states are met by.
#[derive(Clone, Copy)]
pub(super) struct Meets<'a> {
    plan: &'a Plan,
    instance: u32,
    steps: u32,
    pub driven: &'a Driven,
}

impl<'a> Meets<'a> {
    pub fn new(plan: &'a Plan, instance: u32) -> Self {
        Self { plan, instance, steps: plan.steps(instance), driven: plan.driven(instance) }
    }
}

impl<D: Size + DimName> Turns<D>
where
    DefaultAllocator: Memory<D>,
{
    pub fn new() -> Self {
        let zeros = OMatrix::<f64, D, D>::zeros;
        Self {
            pairs: Vec::new(),
            known: Vec::new(),
            met: Vec::new(),
            states: Vec::new(),
            alike: Vec::new(),
            sums: Vec::new(),
            undone: zeros(),
            guess: Guess {
                state: OVector::<f64, D>::zeros(),
                undoes: zeros(),
                multiplier: 0.0,
                touching: false,
            },
        }
    }

    /// How a state with such steps and such a lever is met by an instance: the number of its pair, none where as it is.
    pub fn of(&mut self, meets: Meets, (kept, steps): (&Arc<ReducedBasis>, u32)) -> Option<usize> {
        let driven = meets.driven;
        let same = |one: &Known| {
            (one.theirs.1, one.own.1) == (steps, meets.steps)
                && Arc::ptr_eq(&one.theirs.0, kept)
                && Arc::ptr_eq(&one.own.0, &driven.kept)
                && Arc::ptr_eq(&one.drive, &driven.drive)
        };
        if let Some(known) = self.known.iter().rev().find(|one| same(one)) {
            return known.pair;
        }
        let as_it_is = steps == meets.steps && same_modes(&driven.kept, kept);
        let pair = (!as_it_is).then(|| self.pair(meets, (kept, steps)));
        self.known.push(Known {
            theirs: (Arc::clone(kept), steps),
            own: (Arc::clone(&driven.kept), meets.steps),
            drive: Arc::clone(&driven.drive),
            pair,
        });
        pair
    }

    /// The number of the pair of levers, which is worked out where it is not known.
    fn pair(
        &mut self,
        Meets { plan, instance, steps, driven }: Meets,
        theirs: (&Arc<ReducedBasis>, u32),
    ) -> usize {
        let fits = |turn: &Turn<D>| {
            Arc::ptr_eq(&turn.drive, &driven.drive)
                && (turn.theirs.1, turn.own.1) == (theirs.1, steps)
                && (Arc::ptr_eq(&turn.own.0, &driven.kept) || turn.own.0.modes == driven.kept.modes)
                && same_modes(&turn.theirs.0, theirs.0)
        };
        self.pairs.iter().rposition(fits).unwrap_or_else(|| {
            // A lever that rings for ever has no step that undoes a change: what meets it is no guide.
            let free = undoing(&free_slope::<D>(plan, instance).0);
            self.pairs.push(Turn {
                theirs: (Arc::clone(theirs.0), theirs.1),
                own: (Arc::clone(&driven.kept), steps),
                drive: Arc::clone(&driven.drive),
                turned: Turned::new(plan, instance, (theirs.0, theirs.1), D::DIM / 2),
                free: free.unwrap_or_else(|| OMatrix::<f64, D, D>::repeat(f64::NAN)),
            });
            self.pairs.len() - 1
        })
    }

    /// Begins with an instance: how it meets each of these.
    pub fn meet(&mut self, meets: Meets, neighbours: &[Neighbour]) {
        if self.pairs.len() >= PAIRS {
            self.pairs.clear();
            self.known.clear();
        }
        if self.known.len() >= KNOWN {
            self.known.clear();
        }
        self.met.clear();
        for Neighbour { node, before, .. } in neighbours {
            let met = self.of(meets, (&node.kept, node.steps));
            let met_before = before.and_then(|node| self.of(meets, (&node.kept, node.steps)));
            self.met.push([met, met_before]);
        }
    }

    /// Puts a node's state with an instance's steps, lever and free amplitude.
    pub fn state(&self, meets: Meets, node: &Node, met: Option<usize>, state: &mut OVector<f64, D>) {
        self.turned(&node.state, met, state);
        let drive = &meets.driven.drive;
        if !Arc::ptr_eq(drive, &node.drive) {
            let scale = drive.free_amplitude() / node.drive.free_amplitude();
            *state *= if scale.is_finite() { scale } else { 1.0 };
        }
    }

    /// Puts a state that is met so, without its free amplitude.
    pub fn turned(&self, theirs: &[f64], met: Option<usize>, state: &mut OVector<f64, D>) {
        match met {
            None => state.copy_from_slice(theirs),
            Some(pair) => self.pairs[pair].turned.state(theirs, state),
        }
    }

    /// What undoes a change of an instance from those of its neighbours, each so often: those that are met alike are added up
    /// and turned once.
    pub fn undoes(&mut self, neighbours: &[Neighbour]) {
        let all = &mut self.guess.undoes;
        all.fill(0.0);
        self.alike.clear();
        self.sums.clear();
        for (Neighbour { node, weight, .. }, [met, _]) in neighbours.iter().zip(&self.met) {
            let sums = match met {
                None => all.as_mut_slice(),
                Some(pair) => {
                    let count = node.undoes.len();
                    let same = |one: &Alike| (one.pair, one.count) == (*pair, count);
                    let place = self.alike.iter().position(same).unwrap_or_else(|| {
                        self.alike.push(Alike { pair: *pair, share: 0.0, from: self.sums.len(), count });
                        self.sums.resize(self.sums.len() + count, 0.0);
                        self.alike.len() - 1
                    });
                    let alike = &mut self.alike[place];
                    alike.share += weight;
                    &mut self.sums[alike.from..][..count]
                }
            };
            sums.iter_mut().zip(&*node.undoes).for_each(|(sum, value)| *sum += weight * f64::from(*value));
        }
        for Alike { pair, share, from, count } in &self.alike {
            let turn = &self.pairs[*pair];
            self.undone.copy_from(&turn.free);
            self.undone *= *share;
            turn.turned.linear::<D>(&self.sums[*from..][..*count], &mut self.undone);
            *all += &self.undone;
        }
    }
}

/// Whether two bases have the same modes; those of levers that are scaled copies stand at the same phase.
fn same_modes(a: &Arc<ReducedBasis>, b: &Arc<ReducedBasis>) -> bool {
    Arc::ptr_eq(a, b) || a.copies(b)
}
