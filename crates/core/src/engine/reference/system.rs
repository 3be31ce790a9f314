//! The instrument and its sample as the reference integrates them: the deviation from free motion.

use super::Model;
use super::dop853::Rates;
use super::reference_force::ReferenceForce;
use super::reference_neck::Branch;
use crate::engine::start;
use crate::instrument::Mode;
use crate::plan::{Case, Driven, compliance, reduced};
use crate::scene::Start;
use std::f64::consts::TAU;

/// Modes in order of their share of the tip's flexibility are taken until less than this is left.
const DROP_SHARE: f64 = 1e-6;
/// Modes up to so many times as fast as the contact, or slower than one that stays, stay as well until less than this share of
/// the flexibility at the contact's rate is left. Without them the largest force of a lever of 0.048 N/m on 88 GPa was 1.3e-4
/// off.
const FELT_RATIO: f64 = 16.0;
const FELT_SHARE: f64 = 1e-5;
/// Onset and end of a contact are so many times faster than its middle.
const ONSET: f64 = 4.0;
/// By the tolerance of the steps: modes that are faster than the contact by so much are not resolved one by one. They follow
/// the contact as springs do, but for their inertia. Where a force has a corner or a jump they ring all the same: with 16 the
/// largest force of a lever of 0.37 N/m on 2.2 GPa is 4e-4 wrong under JKR, with 32 4e-5, with 64 6e-6; under DMT and Hertz
/// 16 leaves up to 2e-4.
const FAR_MODE_RATIOS: [(f64, f64); 3] = [(5e-8, 16.0), (5e-9, 32.0), (5e-12, 64.0)];
/// And no mode counts as far faster that is not so many times faster than the lever's first.
const SLOWEST_RATIO: f64 = 200.0;
/// Transients smaller than this part of the scale of length are over.
const TRANSIENT_END_SHARE: f64 = 1e-17;

/// Tip travel z(theta) = z_free + sum x_k, x_k'' + (w_k/(Q_k w)) x_k' + (w_k/w)^2 x_k = (c_k b_k/w^2) f,
/// theta = w t being the drive's angle since the run's start, counted afresh in each period.
///
/// Unknowns: x_k (m), then x_k' (m per rad), then a law's memory (m), if it has one, then, while measuring, the integrals of f,
/// f z' and f z.
pub(super) struct System {
    /// (w_k/w)^2, w_k/(Q_k w), c_k b_k/w^2 of each oscillator.
    stiffness: Vec<f64>,
    loss: Vec<f64>,
    push: Vec<f64>,
    /// Which of the instrument's modes each oscillator is; the plan's residual one is none.
    pub indices: Vec<Option<usize>>,
    /// Amplitudes of the steady free motion's cosine and sine, m.
    free: (f64, f64),
    /// Decaying free motion after a start from rest: each mode with its start as tip travel and speed.
    transients: Vec<(Mode, [f64; 2])>,
    /// rad/s
    pub omega: f64,
    /// Time at which the present period began, s.
    begun: f64,
    pub gap: f64,
    pub force: ReferenceForce,
    pub branch: Branch,
    /// Whether the integrals are among the unknowns.
    pub measuring: bool,
    /// Share of the tip's flexibility that no oscillator carries.
    pub left_out: f64,
    /// Fastest transient worth resolving, over the drive.
    pub fastest_transient: f64,
}

/// By how much a mode has to be faster than the contact not to be resolved, where steps of this tolerance do without.
pub fn far(tolerance: f64) -> Option<f64> {
    FAR_MODE_RATIOS.into_iter().find(|(from, _)| tolerance >= *from).map(|(_, far)| far)
}

impl System {
    /// `far`: modes that are faster than the contact by more are not resolved one by one, which leaves the tip's compliance
    /// at the contact's rates as it is to some 1e-7; see [`far`].
    pub fn new(case: &Case, driven: &Driven, start: Start, model: Model, far: Option<f64>) -> Self {
        let omega = driven.free.omega;
        let (indices, modes, left_out) = oscillators(case, driven, model, far);
        let mut system = Self {
            stiffness: modes.iter().map(|mode| (mode[0] / omega).powi(2)).collect(),
            loss: modes.iter().map(|mode| mode[1] / omega).collect(),
            push: modes.iter().map(|mode| mode[2] / (omega * omega)).collect(),
            indices,
            free: start::amplitudes(driven, start),
            transients: Vec::new(),
            omega,
            begun: 0.0,
            gap: case.gap,
            force: ReferenceForce::new(&case.contact),
            branch: Branch { touching: false, joined: false },
            measuring: false,
            left_out,
            fastest_transient: 0.0,
        };
        if start == Start::Rest {
            let transient = |(k, mode): (usize, &Mode)| {
                let [q, rate] = driven.free.transient(&driven.instrument, k);
                (*mode, [mode.tip * q, mode.tip * rate])
            };
            system.transients = driven.instrument.modes.iter().enumerate().map(transient).collect();
            system.begin_period(0);
            let size = |(mode, [x, v]): &(Mode, [f64; 2])| x.abs() + v.abs() / mode.omega;
            let seen = 1e-12 * system.length();
            let fast = system.transients.iter().filter(|one| size(one) > seen);
            system.fastest_transient = fast.map(|(mode, _)| mode.omega / omega).fold(0.0, f64::max);
        }
        system.branch = system.force.branch_at(-(case.gap + system.free_at(0.0).0));
        system
    }

    /// What a law with hysteresis remembers; of the others, contact.
    pub fn past(&self) -> bool {
        self.force.past(self.branch)
    }

    /// How far the indentation is from where the branch changes, positive before, and the branch behind there.
    pub fn change(&self, delta: f64) -> Option<(f64, Branch)> {
        self.force.change(self.branch, delta)
    }

    /// Oscillators.
    pub fn modes(&self) -> usize {
        self.push.len()
    }

    /// Angular frequency (rad/s) and damping ratio of oscillator `k`.
    pub fn oscillator(&self, k: usize) -> (f64, f64) {
        let ratio = self.stiffness[k].sqrt();
        (self.omega * ratio, 0.5 * self.loss[k] / ratio)
    }

    /// Unknowns.
    pub fn size(&self) -> usize {
        self.remembered() + if self.measuring { 3 } else { 0 }
    }

    /// Unknowns but for the integrals.
    pub fn remembered(&self) -> usize {
        2 * self.modes() + if self.force.remembers { 2 } else { 0 }
    }

    /// The law's memory in a state; zero if it has none.
    pub fn memory_of(&self, y: &[f64]) -> [f64; 2] {
        match y[2 * self.modes()..] {
            [depth, total, ..] if self.force.remembers => [depth, total],
            _ => [0.0; 2],
        }
    }

    /// Scale of length that errors count on at first, m: the free swing, or a femtometre.
    pub fn length(&self) -> f64 {
        self.free.0.hypot(self.free.1).max(1e-15)
    }

    /// Frequency of oscillator `k` over the drive's, at least 1: its speeds are that much larger than its travel.
    pub fn pace(&self, k: usize) -> f64 {
        self.stiffness[k].sqrt().max(1.0)
    }

    /// Static travel of the tip per force by oscillator `k`, m/N.
    pub fn flexibility_of(&self, k: usize) -> f64 {
        self.push[k] / self.stiffness[k]
    }

    /// The same by all oscillators.
    pub fn flexibility(&self) -> f64 {
        (0..self.modes()).map(|k| self.flexibility_of(k)).sum()
    }

    /// Counts the angle from period `number` on and lets go of transients that are over.
    pub fn begin_period(&mut self, number: u32) {
        self.begun = f64::from(number) * TAU / self.omega;
        let (begun, over) = (self.begun, TRANSIENT_END_SHARE * self.length());
        self.transients.retain(|(mode, state)| {
            let [x, v] = turned(mode, begun, *state);
            x.abs() + v.abs() / mode.omega > over
        });
    }

    /// Decaying part of the free motion: travel (m) and its rate (m per rad).
    pub fn transient(&self, theta: f64) -> (f64, f64) {
        let time = self.begun + theta / self.omega;
        let sum = self.transients.iter().fold([0.0; 2], |sum, (mode, state)| {
            let [x, v] = turned(mode, time, *state);
            [sum[0] + x, sum[1] + v]
        });
        (sum[0], sum[1] / self.omega)
    }

    /// Travel (m) without a sample and its rate (m per rad).
    pub fn free_at(&self, theta: f64) -> (f64, f64) {
        let (sine, cosine) = theta.sin_cos();
        let (travel, rate) =
            (self.free.0 * cosine + self.free.1 * sine, self.free.1 * cosine - self.free.0 * sine);
        if self.transients.is_empty() {
            return (travel, rate);
        }
        let (more, faster) = self.transient(theta);
        (travel + more, rate + faster)
    }

    /// Indentation (m) with the oscillators' travel `beyond`, and its rate (m per rad) with theirs.
    pub fn indentation(&self, theta: f64, beyond: f64, rate: f64) -> (f64, f64) {
        let (travel, free_rate) = self.free_at(theta);
        (-(self.gap + travel + beyond), -(free_rate + rate))
    }

    /// The same of a state.
    pub fn indentation_of(&self, theta: f64, y: &[f64]) -> (f64, f64) {
        let n = self.modes();
        self.indentation(theta, y[..n].iter().sum(), y[n..2 * n].iter().sum())
    }
}

impl Rates for System {
    fn rates(&mut self, theta: f64, y: &[f64], out: &mut [f64]) -> f64 {
        let n = self.modes();
        let (x, rest) = y.split_at(n);
        let v = &rest[..n];
        let (free, free_rate) = self.free_at(theta);
        let travel = free + x.iter().sum::<f64>();
        let delta = -(self.gap + travel);
        let rate = || free_rate + v.iter().sum::<f64>();
        let memory = self.memory_of(y);
        let force = self.force.at(delta, || -rate() * self.omega, memory, self.branch);
        out[..n].copy_from_slice(v);
        let (stiffness, loss, push) = (&self.stiffness[..n], &self.loss[..n], &self.push[..n]);
        let bent = &mut out[n..2 * n];
        for k in 0..n {
            bent[k] = push[k] * force - loss[k] * v[k] - stiffness[k] * x[k];
        }
        if self.force.remembers {
            let rates = self
                .force
                .law
                .form()
                .remembered(delta, self.branch.touching, memory)
                .map(|rate| rate / self.omega);
            out[2 * n..2 * n + 2].copy_from_slice(&rates);
        }
        if self.measuring {
            let integrals = self.remembered();
            out[integrals..integrals + 3].copy_from_slice(&[force, force * rate(), force * travel]);
        }
        delta
    }
}

fn turned(mode: &Mode, time: f64, [x, v]: [f64; 2]) -> [f64; 2] {
    let [[a, b], [c, d]] = mode.propagator(time);
    [a * x + b * v, c * x + d * v]
}

/// Which mode, and frequency, frequency over quality factor, and inverse mass of each oscillator; the share left out.
fn oscillators(
    case: &Case,
    driven: &Driven,
    model: Model,
    far: Option<f64>,
) -> (Vec<Option<usize>>, Vec<[f64; 3]>, f64) {
    if model == Model::Kept {
        let kept = &driven.kept;
        let each = kept.modes.iter().map(|m| [m.omega, 2.0 * m.damping * m.omega, m.inverse_mass]);
        return (kept.modes.iter().map(|m| m.index).collect(), each.collect(), kept.residual_share);
    }
    let rate = driven.contact_rate(&case.contact, case.gap);
    let modes = &driven.instrument.modes;
    let (order, left) = chosen(driven, rate, far);
    let each = order.iter().map(|&k| {
        let mode = &modes[k];
        [mode.omega, mode.omega / mode.quality_factor, mode.inverse_mass()]
    });
    let mut each: Vec<[f64; 3]> = each.collect();
    let mut indices: Vec<Option<usize>> = order.iter().copied().map(Some).collect();
    // A fast contact feels what a static force does not: the modes left out then are an oscillator or two, which have their
    // compliance, and its slope, at the rates of the contact's onset.
    let fastest = each.iter().map(|one| one[0]).fold(0.0, f64::max);
    let gone: Vec<&Mode> = (0..modes.len())
        .filter(|k| !order.contains(k))
        .map(|k| &modes[k])
        .filter(|mode| mode.omega > fastest)
        .collect();
    let answer = |some: &mut dyn Iterator<Item = &Mode>| {
        compliance(some.map(|m| (m.omega, m.inverse_mass())), ONSET * rate)
    };
    if answer(&mut gone.iter().copied()).abs() > DROP_SHARE * answer(&mut modes.iter())
        && let Some(one) =
            reduced(&gone, if far.is_some() { 2 } else { 1 }, ONSET * rate, far.unwrap_or(ONSET) * rate)
    {
        each.extend(one.iter().map(|one| [one.omega, 2.0 * one.damping * one.omega, one.inverse_mass]));
        indices.extend(one.iter().map(|_| None));
    }
    (indices, each, left)
}

/// The modes that stay, and the share of the tip's flexibility that those carry which are left out.
fn chosen(driven: &Driven, rate: f64, far: Option<f64>) -> (Vec<usize>, f64) {
    let modes = &driven.instrument.modes;
    let share = |k: usize| modes[k].tip * modes[k].force / (modes[k].omega * modes[k].omega);
    let whole: f64 = (0..modes.len()).map(share).sum();
    let planned = |k: usize| driven.kept.modes.iter().any(|mode| mode.index == Some(k));
    let moved = (0..modes.len()).filter(|&k| share(k) != 0.0).collect();
    let mut order = largest(moved, |k| share(k) / whole, DROP_SHARE, planned);
    // A contact much stiffer than the lever feels modes of a smaller share, too, unless they are much faster. Modes that are
    // slower than one that stays cost no smaller steps.
    let slow = order.iter().map(|&k| modes[k].omega).fold(FELT_RATIO * rate, f64::max);
    let at_rate = |some: &[Mode]| compliance(some.iter().map(|m| (m.omega, m.inverse_mass())), rate);
    let one = |k: usize| at_rate(&modes[k..=k]);
    let rest = (0..modes.len()).filter(|k| modes[*k].omega <= slow && !order.contains(k)).collect();
    let felt = largest(rest, one, FELT_SHARE * at_rate(modes).abs(), |_| false);
    order.extend(felt);
    let left = 1.0 - order.iter().map(|&k| share(k)).sum::<f64>() / whole;
    if let Some(far) = far {
        let far = (far * rate).max(SLOWEST_RATIO * TAU * driven.instrument.lever_frequency);
        order.retain(|&k| modes[k].omega <= far || planned(k));
    }
    (order, left)
}

/// These modes without the smallest, which have no more than `most` together; a mode that `stays` keeps the larger ones, too.
fn largest(
    mut modes: Vec<usize>,
    share: impl Fn(usize) -> f64,
    most: f64,
    stays: impl Fn(usize) -> bool,
) -> Vec<usize> {
    modes.sort_by(|a, b| share(*b).abs().total_cmp(&share(*a).abs()));
    let mut gone = 0.0;
    while let Some(&k) = modes.last() {
        gone += share(k).abs();
        if gone > most || stays(k) {
            break;
        }
        modes.pop();
    }
    modes
}
