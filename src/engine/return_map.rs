//! Where instances are some periods later, on the CPU: their constants are made once, and periods stepped from any
//! place, again and again.

use super::lanes::{self, Family, Rounding, Stepping};
use super::law::KernelLaw;
use super::track::{Member, case, member};
use super::walk::{Shape, shaped};
use super::{EngineError, Progress, start};
use crate::kernel::{Case, LENGTH, Lane, State, WRITTEN_OUT, Wave, unmeasured_period};
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
    /// Takes a pack on, and puts its ends into the starts' places.
    fn after(&self, pack: &Pack, out: &mut [Option<Station>]);
}

/// Up to [`Table::width`] starts that go on together.
struct Pack<'a> {
    /// Their places among the starts, and their instances' rows.
    places: &'a [(usize, u32)],
    starts: &'a [(u32, Station)],
    periods: u32,
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
        let mut own = Vec::with_capacity(starts.len());
        for (number, table) in self.tables.iter().enumerate() {
            own.clear();
            own.extend(starts.iter().enumerate().filter_map(|(n, (instance, _))| {
                let (table, row) = self.places[*instance as usize];
                (table as usize == number).then_some((n, row))
            }));
            for places in own.chunks(table.width()) {
                if progress.stopped() {
                    return out;
                }
                table.after(&Pack { places, starts, periods }, &mut out);
                progress.add(places.len() as u64 * u64::from(periods) * u64::from(table.steps()));
            }
        }
        out
    }
}

/// Constants of a class: those that all its instances share, and a row of the others for each.
struct Rows<L: Lane, I, const M: usize> {
    /// In their order; none where the next number of a row stands.
    shared: Vec<Option<L::Element>>,
    rows: Vec<L::Element>,
    /// Numbers in a row.
    length: usize,
    modes: usize,
    waves: Vec<Wave<L::Element>>,
    law: std::marker::PhantomData<I>,
}

/// The table of a class.
fn table<L: Lane + 'static, I: KernelLaw<L> + Send + Sync + 'static, const M: usize>(
    plan: &Plan,
    class: &Class,
) -> Box<dyn Table> {
    let packs: Vec<(Vec<L::Element>, usize)> =
        class.instances.par_chunks(L::WIDTH).map(|pack| rows::<L, I, M>(plan, pack)).collect();
    let all = packs.first().map_or(0, |(_, length)| *length);
    let rows = || packs.iter().flat_map(|(rows, _)| rows.chunks_exact(all));
    let mut shared: Vec<Option<L::Element>> =
        rows().next().map_or_else(Vec::new, |row| row.iter().copied().map(Some).collect());
    let bits = |element: L::Element| -> u64 { element.into().to_bits() };
    for row in rows() {
        for (place, own) in shared.iter_mut().zip(row) {
            *place = place.filter(|element| bits(*element) == bits(*own));
        }
    }
    let own = rows().flat_map(|row| row.iter().zip(&shared).filter(|(_, shared)| shared.is_none()));
    Box::new(Rows::<L, I, M> {
        rows: own.map(|(element, _)| *element).collect(),
        length: shared.iter().filter(|shared| shared.is_none()).count(),
        shared,
        modes: class.modes,
        waves: start::waves::<L>(class.steps, 1).into_iter().flatten().collect(),
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
        self.waves.len() as u32
    }

    fn after(&self, pack: &Pack, out: &mut [Option<Station>]) {
        L::run(
            #[inline(always)]
            || self.stepped(pack, out),
        );
    }
}

impl<L: Lane, I: KernelLaw<L>, const M: usize> Rows<L, I, M> {
    #[inline(always)]
    fn stepped(&self, pack: &Pack, out: &mut [Option<Station>]) {
        let Pack { places, starts, periods } = *pack;
        let modes = if M <= WRITTEN_OUT { M } else { self.modes.min(M) };
        let mut buffer = [L::element(0.0); WIDEST];
        // The last one fills the lanes left over.
        let last = places[places.len() - 1];
        let mut begin: [(&Station, &[L::Element]); WIDEST] = [(&starts[last.0].1, self.row(last.1)); WIDEST];
        for (place, (n, row)) in begin.iter_mut().zip(places) {
            *place = (&starts[*n].1, self.row(*row));
        }
        let begin = &begin[..L::WIDTH];
        let mut state =
            State::<L, M> { x: [L::splat(0.0); M], u: [L::splat(0.0); M], touching: L::splat(0.0) };
        for k in 0..modes {
            for (place, (station, _)) in buffer.iter_mut().zip(begin) {
                *place = L::element(station.x[k] / LENGTH);
            }
            state.x[k] = L::load(&buffer);
            for (place, (station, _)) in buffer.iter_mut().zip(begin) {
                *place = L::element(station.u[k] / LENGTH);
            }
            state.u[k] = L::load(&buffer);
        }
        for (place, (station, _)) in buffer.iter_mut().zip(begin) {
            *place = L::element(f64::from(u8::from(station.touching)));
        }
        state.touching = L::load(&buffer);
        let (mut shared, mut own) = (self.shared.iter(), 0..self.length);
        let case: Case<L, I, M> = Case::from_numbers(
            self.modes,
            #[inline(always)]
            || {
                if let Some(Some(element)) = shared.next() {
                    return L::broadcast(*element);
                }
                let field = own.next().unwrap_or(0);
                for (place, (_, row)) in buffer.iter_mut().zip(begin) {
                    *place = row[field];
                }
                L::load(&buffer)
            },
        );
        for _ in 0..periods {
            unmeasured_period(&case, &mut state, &self.waves);
        }
        for ((n, _), (station, _)) in places.iter().zip(begin) {
            out[*n] = Some(**station);
        }
        let mut put = |field: L, put: fn(&mut Station, usize, f64), k: usize| {
            field.store(&mut buffer);
            for ((n, _), value) in places.iter().zip(&buffer) {
                if let Some(end) = &mut out[*n] {
                    put(end, k, (*value).into());
                }
            }
        };
        for k in 0..modes {
            put(state.x[k], |end, k, value| end.x[k] = value * LENGTH, k);
            put(state.u[k], |end, k, value| end.u[k] = value * LENGTH, k);
        }
        put(state.touching, |end, _, value| end.touching = value > 0.0, 0);
        for (n, _) in places {
            let Some(end) = &mut out[*n] else { continue };
            // Beyond f32 counts as none, as in a run.
            let numbers = |all: &[f64]| all.iter().all(|value| ((value / LENGTH) as f32).is_finite());
            end.finite &= numbers(&end.x[..modes]) && numbers(&end.u[..modes]);
        }
    }

    fn row(&self, row: u32) -> &[L::Element] {
        &self.rows[row as usize * self.length..][..self.length]
    }
}
