//! Where instances are some periods later, on the CPU: their constants are made once, and periods stepped from any
//! place, again and again.

use super::lanes::{self, Family, Rounding, Stepping};
use super::law::KernelLaw;
use super::track::{Member, case, member};
use super::walk::{Shape, shaped};
use super::{EngineError, Progress, start};
use crate::kernel::{Case, LENGTH, Lane, State, Tally, Wave, period};
use crate::observe::Wants;
use crate::plan::{Class, Plan, Station};
use crate::scene::Start;
use rayon::ThreadPool;
use rayon::prelude::*;

/// The map that takes an instance's place at the start of a period of its drive to the one some periods later, with
/// the plan's steps and in f64.
pub trait ReturnMap: Send + Sync {
    /// Does `work`, which may split itself up, on the engine's threads.
    fn on_threads(&self, work: &mut (dyn FnMut() + Send));

    /// Where each of `starts` (a number in the list of instances that the map was made for, and a place) is after
    /// `periods`; none where the run was stopped.
    ///
    /// This is done on the calling thread: callers have many lists.
    fn after(&self, starts: &[(u32, Station)], periods: u32, progress: &Progress) -> Vec<Option<Station>>;
}

/// Instances of one class: their constants, and how they are stepped.
trait Table: Send + Sync {
    /// Instances stepped side by side.
    fn width(&self) -> usize;
    /// Steps per period.
    fn steps(&self) -> u32;
    /// Takes up to [`Table::width`] places on; the number of an instance is its row.
    fn after(&self, pack: &mut [(u32, Station)], periods: u32);
}

pub(super) struct Map {
    tables: Vec<Box<dyn Table>>,
    /// By instance, its table and its row there.
    places: Vec<(u32, u32)>,
    pool: Option<ThreadPool>,
}

impl Map {
    pub fn new(
        plan: &Plan,
        instances: &[u32],
        rounding: Rounding,
        pool: Option<ThreadPool>,
    ) -> Result<Self, EngineError> {
        let part = plan.trial(instances, 1, 1);
        let mut places = vec![(0, 0); instances.len()];
        let mut tables = Vec::with_capacity(part.classes.len());
        for (number, class) in part.classes.iter().enumerate() {
            for (row, instance) in class.instances.iter().enumerate() {
                places[*instance as usize] = (number as u32, row as u32);
            }
            let make = || lanes::with_double(rounding, Tabulate { plan: &part, class });
            tables.push(match &pool {
                None => make()?,
                Some(pool) => pool.install(make)?,
            });
        }
        Ok(Self { tables, places, pool })
    }
}

struct Tabulate<'a> {
    plan: &'a Plan,
    class: &'a Class,
}

impl Stepping for Tabulate<'_> {
    type Output = Result<Box<dyn Table>, EngineError>;

    fn with<F: Family>(self) -> Self::Output {
        shaped::<F, _>(self.class.law, self.class.modes, self)
    }
}

impl<E> Shape<E> for Tabulate<'_> {
    type Output = Box<dyn Table>;

    fn with<L, I, const M: usize>(self) -> Box<dyn Table>
    where
        L: Lane<Element = E> + 'static,
        I: KernelLaw<L> + Send + Sync + 'static,
    {
        table::<L, I, M>(self.plan, self.class)
    }
}

impl ReturnMap for Map {
    fn on_threads(&self, work: &mut (dyn FnMut() + Send)) {
        match &self.pool {
            None => work(),
            Some(pool) => pool.install(work),
        }
    }

    fn after(&self, starts: &[(u32, Station)], periods: u32, progress: &Progress) -> Vec<Option<Station>> {
        let mut out = vec![None; starts.len()];
        let (mut own, mut pack) = (Vec::with_capacity(starts.len()), Vec::new());
        for (number, table) in self.tables.iter().enumerate() {
            own.clear();
            let here = |(_, (instance, _)): &(usize, &(u32, Station))| {
                self.places[*instance as usize].0 as usize == number
            };
            own.extend(starts.iter().enumerate().filter(here).map(|(n, _)| n));
            for some in own.chunks(table.width()) {
                if progress.stopped() {
                    return out;
                }
                pack.clear();
                pack.extend(some.iter().map(|n| (self.places[starts[*n].0 as usize].1, starts[*n].1)));
                table.after(&mut pack, periods);
                progress.add(pack.len() as u64 * u64::from(periods) * u64::from(table.steps()));
                some.iter().zip(&pack).for_each(|(n, (_, end))| out[*n] = Some(*end));
            }
        }
        out
    }
}

/// Constants of a class, a row for each instance.
struct Rows<L: Lane, I, const M: usize> {
    rows: Vec<L::Element>,
    /// Numbers in a row.
    length: usize,
    waves: Vec<Vec<Wave<L::Element>>>,
    law: std::marker::PhantomData<I>,
}

/// The table of a class.
fn table<L: Lane + 'static, I: KernelLaw<L> + Send + Sync + 'static, const M: usize>(
    plan: &Plan,
    class: &Class,
) -> Box<dyn Table> {
    let packs: Vec<(Vec<L::Element>, usize)> =
        class.instances.par_chunks(L::WIDTH).map(|pack| rows::<L, I, M>(plan, pack)).collect();
    let length = packs.first().map_or(0, |(_, length)| *length);
    Box::new(Rows::<L, I, M> {
        rows: packs.into_iter().flat_map(|(rows, _)| rows).collect(),
        length,
        waves: start::waves::<L>(class.steps, 1),
        law: std::marker::PhantomData,
    })
}

/// Rows of a pack, and their length.
fn rows<L: Lane, I: KernelLaw<L>, const M: usize>(plan: &Plan, pack: &[u32]) -> (Vec<L::Element>, usize) {
    let mut members: Vec<Member> = pack.iter().map(|instance| member(plan, *instance)).collect();
    members.resize(L::WIDTH, members[pack.len() - 1]);
    let numbers = case::<L, I, M>(&members, Start::Steady).numbers();
    let all = (0..pack.len()).flat_map(|lane| numbers.iter().map(move |field| L::element(field.lane(lane))));
    (all.collect(), numbers.len())
}

/// Most lanes side by side.
const WIDEST: usize = 32;

impl<L: Lane, I: KernelLaw<L> + Send + Sync, const M: usize> Table for Rows<L, I, M> {
    fn width(&self) -> usize {
        L::WIDTH
    }

    fn steps(&self) -> u32 {
        self.waves[0].len() as u32
    }

    fn after(&self, pack: &mut [(u32, Station)], periods: u32) {
        let mut buffer = [L::element(0.0); WIDEST];
        // The last one fills the lanes left over.
        let mut row = [0; WIDEST];
        for (lane, row) in row.iter_mut().enumerate().take(L::WIDTH) {
            *row = pack[lane.min(pack.len() - 1)].0 as usize * self.length;
        }
        let mut gather = |value: &dyn Fn(usize) -> f64| -> L {
            for (lane, place) in buffer.iter_mut().enumerate().take(L::WIDTH) {
                *place = L::element(value(lane.min(pack.len() - 1)));
            }
            L::load(&buffer)
        };
        let mut state: State<L, M> = State {
            x: std::array::from_fn(|k| gather(&|lane| pack[lane].1.x[k] / LENGTH)),
            u: std::array::from_fn(|k| gather(&|lane| pack[lane].1.u[k] / LENGTH)),
            touching: gather(&|lane| f64::from(u8::from(pack[lane].1.touching))),
        };
        let mut field = 0;
        let case: Case<L, I, M> = Case::from_numbers(|| {
            for (place, row) in buffer.iter_mut().zip(row).take(L::WIDTH) {
                *place = self.rows[row + field];
            }
            field += 1;
            L::load(&buffer)
        });
        let mut tally = Tally::start(state.touching, state.touching);
        for _ in 0..periods {
            // As a run does before the measured part; the sums are left.
            period(&case, &mut state, &self.waves, None, Wants::FUNDAMENTAL, &mut tally);
        }
        let mut scatter = |field: L, put: &dyn Fn(&mut Station, f64)| {
            field.store(&mut buffer);
            pack.iter_mut().zip(buffer).for_each(|((_, end), value)| put(end, value.into()));
        };
        for k in 0..M {
            scatter(state.x[k], &|end, value| end.x[k] = value * LENGTH);
            scatter(state.u[k], &|end, value| end.u[k] = value * LENGTH);
        }
        scatter(state.touching, &|end, value| end.touching = value > 0.0);
        for (_, end) in pack {
            // Beyond f32 counts as none, as in a run.
            let numbers = |all: &[f64]| all.iter().all(|value| ((value / LENGTH) as f32).is_finite());
            end.finite &= numbers(&end.x) && numbers(&end.u);
        }
    }
}
