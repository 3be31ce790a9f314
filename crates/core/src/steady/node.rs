//! A solved instance as its neighbours in a sweep see it, and what several of them say of one between them.

use super::PeriodicState;
use super::linear::undoing;
use super::map::{Turned, free_slope, own_vector, vector};
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

/// A periodic state, and what takes a change of the period map there to the step that undoes it.
#[derive(Clone, Debug)]
pub struct Node {
    /// Travel of the kept modes, then rate over angular frequency, m.
    state: Box<[f64]>,
    /// The inverse of one minus the map's slope, column by column; see [`Linear::Undoes`](super::Linear::Undoes).
    undoes: Arc<[f32]>,
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
    /// Of an instance that was found steady; none where its state or the map there is not known.
    pub fn new(plan: &Plan, instance: u32, state: &PeriodicState, finished: &Finished) -> Option<Self> {
        if !state.searched() || !finished.status.is_steady() {
            return None;
        }
        Some(Self {
            state: own_vector(&state.station, state.linear.size() / 2),
            undoes: state.linear.undoes()?,
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

/// How states are met by instances of other steps, levers and drives: few kinds of both, each pair worked out once.
pub(super) struct Turns<D: Size>
where
    DefaultAllocator: Memory<D>,
{
    pairs: Vec<Turn<D>>,
    /// Room for the states of the neighbours of one instance.
    states: Vec<OVector<f64, D>>,
}

/// Beyond so many pairs they are forgotten: every instance has a lever of its own.
const PAIRS: usize = 64;

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

impl<D: Size + DimName> Turns<D>
where
    DefaultAllocator: Memory<D>,
{
    pub(super) fn new() -> Self {
        Self { pairs: Vec::new(), states: Vec::new() }
    }

    /// How a state with such steps and such a lever is met by an instance; none where as it is.
    fn of(&mut self, plan: &Plan, instance: u32, theirs: (&Arc<ReducedBasis>, u32)) -> Option<&Turn<D>> {
        let (driven, steps) = (plan.driven(instance), plan.steps(instance));
        if met_as_it_is(plan, instance, theirs) {
            return None;
        }
        let fits = |turn: &Turn<D>| {
            Arc::ptr_eq(&turn.drive, &driven.drive)
                && (turn.theirs.1, turn.own.1) == (theirs.1, steps)
                && (Arc::ptr_eq(&turn.own.0, &driven.kept) || turn.own.0.modes == driven.kept.modes)
                && same_modes(&turn.theirs.0, theirs.0)
        };
        let place = self.pairs.iter().rposition(fits).unwrap_or_else(|| {
            if self.pairs.len() >= PAIRS {
                self.pairs.clear();
            }
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
        });
        Some(&self.pairs[place])
    }

    /// A node's state with an instance's steps, lever and free amplitude.
    fn state(&mut self, plan: &Plan, instance: u32, node: &Node) -> OVector<f64, D> {
        let mut state = match self.of(plan, instance, (&node.kept, node.steps)) {
            None => OVector::<f64, D>::from_column_slice(&node.state),
            Some(turn) => turn.turned.state::<D>(&node.state),
        };
        let drive = &plan.driven(instance).drive;
        if !Arc::ptr_eq(drive, &node.drive) {
            let scale = drive.free_amplitude() / node.drive.free_amplitude();
            state *= if scale.is_finite() { scale } else { 1.0 };
        }
        state
    }

    /// An instance's own state of the run before.
    fn own_state(&mut self, plan: &Plan, instance: u32, own: &PeriodicState) -> OVector<f64, D> {
        let theirs = vector::<D>(&own.station);
        match self.of(plan, instance, (&own.kept, own.steps)) {
            None => theirs,
            Some(turn) => turn.turned.state::<D>(theirs.as_slice()),
        }
    }

    /// What undoes a change of an instance from those of nodes, each so often: nodes that are met alike are added up and
    /// turned once.
    fn undoes<'a>(
        &mut self,
        plan: &Plan,
        instance: u32,
        nodes: impl Iterator<Item = (&'a Node, f64)>,
    ) -> OMatrix<f64, D, D> {
        let mut all = OMatrix::<f64, D, D>::zeros();
        let mut others: Vec<(&Node, f64, Vec<f64>)> = Vec::new();
        for (node, weight) in nodes {
            let add = |sums: &mut [f64]| {
                let terms = sums.iter_mut().zip(&*node.undoes);
                terms.for_each(|(sum, value)| *sum += weight * f64::from(*value));
            };
            if met_as_it_is(plan, instance, (&node.kept, node.steps)) {
                add(all.as_mut_slice());
                continue;
            }
            let alike = |(other, ..): &(&Node, f64, Vec<f64>)| {
                node.steps == other.steps
                    && node.undoes.len() == other.undoes.len()
                    && same_modes(&node.kept, &other.kept)
            };
            let place = others.iter().position(alike).unwrap_or_else(|| {
                others.push((node, 0.0, vec![0.0; node.undoes.len()]));
                others.len() - 1
            });
            others[place].1 += weight;
            add(&mut others[place].2);
        }
        for (node, share, sums) in others {
            if let Some(turn) = self.of(plan, instance, (&node.kept, node.steps)) {
                all += turn.turned.linear::<D>(&sums, &turn.free * share);
            }
        }
        all
    }
}

/// Whether two bases have the same modes; those of levers that are scaled copies stand at the same phase.
fn same_modes(a: &Arc<ReducedBasis>, b: &Arc<ReducedBasis>) -> bool {
    Arc::ptr_eq(a, b) || a.copies(b)
}

/// Whether an instance has these steps and modes.
fn met_as_it_is(plan: &Plan, instance: u32, (kept, steps): (&Arc<ReducedBasis>, u32)) -> bool {
    steps == plan.steps(instance) && same_modes(&plan.driven(instance).kept, kept)
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
    /// A search has found nothing: each of them alone may lead to it.
    Each(Vec<Neighbour<'a>>),
    /// No search is to be tried.
    Vain,
    /// They are no guide.
    None,
}

impl<'a> Lead<'a> {
    /// Each of these alone.
    pub fn each(nodes: impl Iterator<Item = &'a Node>) -> Self {
        Self::Each(nodes.map(|node| Neighbour { node, before: None, weight: 1.0, nearest: 1.0 }).collect())
    }

    pub(super) fn hint(&self) -> Option<&Hint<'a>> {
        match self {
            Self::Hint(hint) => Some(hint),
            Self::Each(_) | Self::Vain | Self::None => None,
        }
    }

    /// Those of which each alone may lead to it where a search does not.
    pub(super) fn alone(&self) -> Vec<Neighbour<'a>> {
        match self {
            Self::Hint(hint) if hint.own.is_none() => hint.nearest_two().into_iter().flatten().collect(),
            Self::Each(neighbours) => neighbours.clone(),
            _ => Vec::new(),
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

impl<'a> From<Hint<'a>> for Lead<'a> {
    fn from(hint: Hint<'a>) -> Self {
        Self::Hint(hint)
    }
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
        turns: &mut Turns<D>,
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
            undoes: turns.undoes(plan, instance, self.neighbours.iter().map(|one| (one.node, one.weight))),
            multiplier: 0.0,
            touching: first.touching,
        };
        let mut nearest = OVector::<f64, D>::zeros();
        let mut states = std::mem::take(&mut turns.states);
        states.clear();
        states.extend(self.neighbours.iter().map(|one| turns.state(plan, instance, one.node)));
        let scale = plan.driven(instance).free_amplitude().max(1e-15);
        if self.own.is_none() && !self.scattered && self.jumps(&states, scale) {
            return None;
        }
        for (one, mut state) in self.neighbours.iter().zip(states.drain(..)) {
            if let Some(before) = one.before {
                state -= turns.state(plan, instance, before);
            }
            guess.state.axpy(one.weight, &state, 1.0);
            nearest.axpy(one.nearest, &state, 1.0);
            guess.multiplier += one.nearest * one.node.multiplier;
        }
        if let Some(own) = self.own {
            if own.station.touching != first.touching && first.law.has_memory() {
                return None;
            }
            guess.state += turns.own_state(plan, instance, own);
        }
        turns.states = states;
        let apart = (&guess.state - nearest).norm() / scale;
        (self.own.is_some() || self.scattered || apart <= ASTRAY).then_some(guess)
    }

    /// The place between the nearest two on a line, how far they are from it, m, and whether they touch the sample there; none
    /// where one of the two alone does, or where the instance's own state is known.
    pub(super) fn middle<D: Size + DimName>(
        &self,
        plan: &Plan,
        instance: u32,
        turns: &mut Turns<D>,
    ) -> Option<(OVector<f64, D>, f64, bool)>
    where
        DefaultAllocator: Memory<D>,
    {
        let two = self.nearest_two().filter(|_| self.own.is_none())?;
        let [a, b] = two.map(|one| one.node);
        let one_contact = a.touching == b.touching || !a.law.has_memory();
        if !one_contact || [a, b].iter().any(|node| node.law != plan.law(instance)) {
            return None;
        }
        let states = [a, b].map(|node| turns.state(plan, instance, node));
        let middle = &states[0] * two[0].nearest + &states[1] * two[1].nearest;
        let far = states.iter().map(|state| (state - &middle).norm()).fold(0.0, f64::max);
        Some((middle, far, a.touching))
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
