//! A solved instance as its neighbours in a sweep see it, and what several of them say of one between them.

use super::PeriodicState;
use super::map::{Turned, own_vector};
use crate::contact::Law;
use crate::engine::Finished;
use crate::periodic::{Memory, Size};
use crate::plan::{Drive, Plan, ReducedBasis};
use nalgebra::{DefaultAllocator, DimName, OMatrix, OVector};
use std::sync::Arc;

/// Two starts for one instance, by many of its neighbours and by the nearest alone, are farther apart than this share of
/// the free amplitude only where its neighbours are no guide.
const ASTRAY: f64 = 0.02;
/// So many times farther apart than the neighbours beyond them, the nearest two are on different branches.
const JUMP: f64 = 4.0;

/// A periodic state, and the period map's slope there.
#[derive(Clone, Debug)]
pub struct Node {
    /// Travel of the kept modes, then rate over angular frequency, m.
    state: Box<[f64]>,
    /// Column by column. Single precision: it leads to states, and no result hangs on it.
    slope: Box<[f32]>,
    multiplier: f64,
    touching: bool,
    /// Whether the mean force draws the tip, and contacts in a period: where they differ, so does the motion.
    drawn: bool,
    contacts: f64,
    law: Law,
    steps: u32,
    kept: Arc<ReducedBasis>,
    drive: Arc<Drive>,
}

impl Node {
    /// Of an instance that was found steady; none where its state or the slope there is not known.
    pub fn new(plan: &Plan, instance: u32, state: &PeriodicState, finished: &Finished) -> Option<Self> {
        let size = state.slope.len().isqrt();
        let known = state.searched() && size > 0 && finished.status.is_steady();
        known.then(|| Self {
            state: own_vector(&state.station, size / 2),
            slope: state.slope.iter().map(|value| *value as f32).collect(),
            multiplier: state.spectrum.multiplier,
            touching: state.station.touching,
            drawn: finished.measured.force_mean < 0.0,
            contacts: finished.measured.contacts.round(),
            law: plan.law(instance),
            steps: state.steps,
            kept: Arc::clone(&state.kept),
            drive: Arc::clone(&plan.driven(instance).drive),
        })
    }

    /// Whether both move alike: under one law, in the same contact, as often.
    pub fn moves_as(&self, other: &Self) -> bool {
        let contacts = self.contacts == other.contacts || self.contacts.is_nan() || other.contacts.is_nan();
        let touching = self.touching == other.touching || !self.law.has_memory();
        touching && self.law == other.law && contacts
    }
}

/// How nodes are met by instances of other steps, levers and drives: few kinds of both, each pair worked out once.
#[derive(Default)]
pub(super) struct Turns(Vec<Turn>);

/// Beyond so many pairs they are forgotten: every instance has a lever of its own.
const PAIRS: usize = 64;

struct Turn {
    theirs: (Arc<ReducedBasis>, u32),
    own: (Arc<ReducedBasis>, u32),
    drive: Arc<Drive>,
    turned: Turned,
}

impl Turns {
    /// How a node is met by an instance, whose state has so many modes; none where as it is.
    fn of(&mut self, plan: &Plan, instance: u32, node: &Node, modes: usize) -> Option<&Turned> {
        let (driven, steps) = (plan.driven(instance), plan.steps(instance));
        if met_as_it_is(plan, instance, node) {
            return None;
        }
        let fits = |turn: &Turn| {
            Arc::ptr_eq(&turn.drive, &driven.drive)
                && (turn.theirs.1, turn.own.1) == (node.steps, steps)
                && (Arc::ptr_eq(&turn.own.0, &driven.kept) || turn.own.0.modes == driven.kept.modes)
                && same_modes(&turn.theirs.0, &node.kept)
        };
        let place = self.0.iter().rposition(fits).unwrap_or_else(|| {
            if self.0.len() >= PAIRS {
                self.0.clear();
            }
            self.0.push(Turn {
                theirs: (Arc::clone(&node.kept), node.steps),
                own: (Arc::clone(&driven.kept), steps),
                drive: Arc::clone(&driven.drive),
                turned: Turned::new(plan, instance, (&node.kept, node.steps), modes),
            });
            self.0.len() - 1
        });
        Some(&self.0[place].turned)
    }

    /// A node's state with an instance's steps, lever and free amplitude.
    fn state<D: Size + DimName>(&mut self, plan: &Plan, instance: u32, node: &Node) -> OVector<f64, D>
    where
        DefaultAllocator: Memory<D>,
    {
        let mut state = match self.of(plan, instance, node, D::DIM / 2) {
            None => OVector::<f64, D>::from_column_slice(&node.state),
            Some(turned) => turned.state::<D>(&node.state),
        };
        let drive = &plan.driven(instance).drive;
        let scale = drive.free_amplitude() / node.drive.free_amplitude();
        if !Arc::ptr_eq(drive, &node.drive) && scale.is_finite() {
            state *= scale;
        }
        state
    }

    /// The slope of an instance from those of nodes, each so often: nodes that are met alike are added up and turned once.
    fn slope<'a, D: Size + DimName>(
        &mut self,
        plan: &Plan,
        instance: u32,
        nodes: impl Iterator<Item = (&'a Node, f64)>,
    ) -> OMatrix<f64, D, D>
    where
        DefaultAllocator: Memory<D>,
    {
        let mut all = OMatrix::<f64, D, D>::zeros();
        let mut others: Vec<(&Node, f64, Vec<f64>)> = Vec::new();
        for (node, weight) in nodes {
            let add = |sums: &mut [f64]| {
                let terms = sums.iter_mut().zip(&node.slope);
                terms.for_each(|(sum, value)| *sum += weight * f64::from(*value));
            };
            if met_as_it_is(plan, instance, node) {
                add(all.as_mut_slice());
                continue;
            }
            let alike = |(other, ..): &(&Node, f64, Vec<f64>)| {
                node.steps == other.steps
                    && node.slope.len() == other.slope.len()
                    && same_modes(&node.kept, &other.kept)
            };
            let place = others.iter().position(alike).unwrap_or_else(|| {
                others.push((node, 0.0, vec![0.0; node.slope.len()]));
                others.len() - 1
            });
            others[place].1 += weight;
            add(&mut others[place].2);
        }
        for (node, share, sums) in others {
            if let Some(turned) = self.of(plan, instance, node, D::DIM / 2) {
                all += turned.slope::<D>(plan, instance, (&sums, share));
            }
        }
        all
    }
}

/// Whether two bases have the same modes; those of levers that are scaled copies stand at the same phase.
fn same_modes(a: &Arc<ReducedBasis>, b: &Arc<ReducedBasis>) -> bool {
    Arc::ptr_eq(a, b) || a.copies(b)
}

/// Whether an instance has a node's steps and modes.
fn met_as_it_is(plan: &Plan, instance: u32, node: &Node) -> bool {
    node.steps == plan.steps(instance) && same_modes(&plan.driven(instance).kept, &node.kept)
}

/// One of the neighbours that a guess is made of.
#[derive(Clone, Copy, Debug)]
pub struct Neighbour<'a> {
    pub node: &'a Node,
    /// The same instance's state with the steps and the lever of the run before, where the guess is made from the
    /// instance's own state in that run.
    pub before: Option<&'a Node>,
    /// Its weight, and the one by the nearest alone.
    pub weight: f64,
    pub nearest: f64,
}

/// Where neighbours lead an instance.
#[derive(Clone, Debug)]
pub enum Lead<'a> {
    Hint(Hint<'a>),
    /// They were searched for in vain.
    Vain,
    /// They are no guide.
    None,
}

impl<'a> Lead<'a> {
    pub(super) fn hint(&self) -> Option<&Hint<'a>> {
        match self {
            Self::Hint(hint) => Some(hint),
            Self::Vain | Self::None => None,
        }
    }
}

/// What is known of an instance before it is stepped.
#[derive(Clone, Debug, Default)]
pub struct Hint<'a> {
    pub neighbours: Vec<Neighbour<'a>>,
    /// The instance's own state in the run before; the neighbours tell how far the two runs are apart.
    pub own: Option<&'a PeriodicState>,
    /// Whether the neighbours lie around it, the nearest first; else along a line, in its order.
    pub scattered: bool,
}

/// Where an instance's state is expected, the slope there, and its largest multiplier.
pub(super) struct Guess<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    pub state: OVector<f64, D>,
    pub slope: OMatrix<f64, D, D>,
    pub multiplier: f64,
    pub touching: bool,
}

impl<'a> Hint<'a> {
    /// One neighbour's state as it is.
    pub(super) fn alone(neighbour: Neighbour<'a>) -> Self {
        let neighbour = Neighbour { weight: 1.0, nearest: 1.0, ..neighbour };
        Self { neighbours: vec![neighbour], own: None, scattered: false }
    }

    /// The nearest on either side of an instance on a line; none where neighbours lie around it.
    pub(super) fn nearest_two(&self) -> Option<[Neighbour<'a>; 2]> {
        let mut nearest = self.neighbours.iter().filter(|one| one.nearest != 0.0);
        let two = [*nearest.next()?, *nearest.next()?];
        (!self.scattered).then_some(two)
    }
}

impl Hint<'_> {
    /// What the neighbours lead to; none where they are no guide: they move differently, or say different things, or one
    /// of them is not clearly stable.
    pub(super) fn guess<D: Size + DimName>(
        &self,
        plan: &Plan,
        instance: u32,
        turns: &mut Turns,
    ) -> Option<Guess<D>>
    where
        DefaultAllocator: Memory<D>,
    {
        let first = self.neighbours.first()?.node;
        let stable = super::aims::certainly(plan, instance);
        let counts = |one: &Neighbour| !self.scattered || one.nearest != 0.0;
        let sound =
            |one: &Neighbour| one.node.moves_as(first) && (!counts(one) || one.node.multiplier < stable);
        if !self.neighbours.iter().all(sound) || first.law != plan.law(instance) {
            return None;
        }
        let mut guess = Guess {
            state: OVector::<f64, D>::zeros(),
            slope: turns.slope(plan, instance, self.neighbours.iter().map(|one| (one.node, one.weight))),
            multiplier: 0.0,
            touching: first.touching,
        };
        let mut nearest = OVector::<f64, D>::zeros();
        let states: Vec<OVector<f64, D>> =
            self.neighbours.iter().map(|one| turns.state::<D>(plan, instance, one.node)).collect();
        let scale = plan.driven(instance).free_amplitude().max(1e-15);
        if self.own.is_none() && !self.scattered && self.jumps(&states, scale) {
            return None;
        }
        for (one, mut state) in self.neighbours.iter().zip(states) {
            if let Some(before) = one.before {
                state -= turns.state::<D>(plan, instance, before);
            }
            guess.state.axpy(one.weight, &state, 1.0);
            nearest.axpy(one.nearest, &state, 1.0);
            guess.multiplier += one.nearest * one.node.multiplier;
        }
        if let Some(own) = self.own {
            if own.station.touching != first.touching && first.law.has_memory() {
                return None;
            }
            guess.state += super::map::own_state::<D>(plan, instance, own);
        }
        let apart = (&guess.state - nearest).norm() / scale;
        (self.own.is_some() || self.scattered || apart <= ASTRAY).then_some(guess)
    }

    /// Whether the nearest two are on different branches: far apart beside those beyond them; of two alone, where one is
    /// drawn to the sample and the other is not.
    fn jumps<D: Size>(&self, states: &[OVector<f64, D>], scale: f64) -> bool
    where
        DefaultAllocator: Memory<D>,
    {
        let all = &self.neighbours;
        let inner = |n: usize| all[n].nearest != 0.0 && all[n + 1].nearest != 0.0;
        let (mut between, mut beyond) = (0.0f64, None::<f64>);
        for n in 0..all.len().saturating_sub(1) {
            let apart = (&states[n + 1] - &states[n]).norm();
            match inner(n) {
                true => between = between.max(apart),
                false => beyond = Some(beyond.unwrap_or(0.0).max(apart)),
            }
        }
        match beyond {
            Some(beyond) => between > ASTRAY * scale && between > JUMP * beyond,
            None => all.iter().any(|one| one.node.drawn != all[0].node.drawn),
        }
    }
}
