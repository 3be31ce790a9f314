//! What is known of all instances, some of them after the other.

use crate::contact::{Contact, Law};
use crate::control::{Arithmetic, ChunkView, JournaledRun};
use crate::engine::{EngineError, ResultColumns};
use crate::observe::{Measured, Observable, Status};
use crate::plan::{Plan, Precision};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::OnceLock;

/// Where it is known.
#[derive(Clone, Copy)]
pub(super) enum InstanceRows<'a> {
    /// A run's chunks.
    Run(&'a JournaledRun<'a>),
    /// A plan that was run once as it is.
    Plain { plan: &'a Plan, finished: &'a ResultColumns, arithmetic: &'a Arithmetic },
}

impl<'a> InstanceRows<'a> {
    /// How many instances there are.
    pub fn count(&self) -> usize {
        match self {
            Self::Run(run) => run.len(),
            Self::Plain { plan, .. } => plan.len(),
        }
    }

    /// The plan of all instances; of a run the one before anything was refined.
    pub fn plan(&self) -> &'a Plan {
        match self {
            Self::Run(run) => &run.plan,
            Self::Plain { plan, .. } => plan,
        }
    }

    /// One code per instance.
    pub fn statuses(&self) -> Vec<u8> {
        match self {
            Self::Run(run) => run.marks().iter().map(|mark| mark.status() as u8).collect(),
            Self::Plain { finished, .. } => finished.statuses().iter().map(|one| *one as u8).collect(),
        }
    }

    /// Shows all instances; of those of a run nothing but what their plan and marks tell, where no more `is_read`.
    pub fn each(&self, is_read: bool, show: &mut dyn FnMut(&[u32], &RowView)) -> Result<(), EngineError> {
        match *self {
            Self::Run(run) if !is_read => {
                run.each_unread(&mut |piece| show(piece.instances, &RowView::Piece(piece, OnceLock::new())));
                Ok(())
            }
            Self::Run(run) => run.each(&mut |piece| {
                show(piece.instances, &RowView::Piece(piece, OnceLock::new()));
                ControlFlow::Continue(())
            }),
            Self::Plain { plan, finished, arithmetic } => {
                let all: Vec<u32> = plan.instances().collect();
                show(&all, &RowView::Plain { plan, finished, arithmetic });
                Ok(())
            }
        }
    }

    /// So many numbers of each instance in the order of the instances, of `of` in that of those shown; see [`InstanceRows::each`].
    pub fn column<T: Copy + Default>(
        &self,
        (width, is_read): (usize, bool),
        of: &dyn Fn(&RowView) -> Vec<T>,
    ) -> Result<Vec<T>, EngineError> {
        let mut all = vec![T::default(); width * self.count()];
        self.each(is_read, &mut |instances, some| {
            let rows = of(some);
            if width == 1 {
                return instances.iter().zip(rows).for_each(|(i, number)| all[*i as usize] = number);
            }
            for (i, row) in instances.iter().zip(rows.chunks_exact(width)) {
                all[*i as usize * width..][..width].copy_from_slice(row);
            }
        })?;
        Ok(all)
    }
}

/// Some instances, by their numbers among these.
pub(super) enum RowView<'a> {
    /// With their plan, once it is asked for.
    Piece(&'a ChunkView<'a>, OnceLock<Box<Plan>>),
    Plain {
        plan: &'a Plan,
        finished: &'a ResultColumns,
        arithmetic: &'a Arithmetic,
    },
}

impl RowView<'_> {
    /// The plan of them, as it was carried out.
    pub fn plan(&self) -> &Plan {
        match self {
            Self::Piece(piece, plan) => plan.get_or_init(|| Box::new(piece.plan())),
            Self::Plain { plan, .. } => plan,
        }
    }

    /// An instance's contact.
    pub fn contact(&self, n: usize) -> Contact {
        match self {
            Self::Piece(piece, _) => piece.contact(n),
            Self::Plain { plan, .. } => plan.contact(n as u32),
        }
    }

    /// The law of its contact.
    pub fn law(&self, n: usize) -> Law {
        match self {
            Self::Piece(piece, _) => piece.compact(n).law,
            Self::Plain { plan, .. } => plan.law(n as u32),
        }
    }

    /// Tabor's parameter of its contact.
    pub fn tabor(&self, n: usize) -> f64 {
        match self {
            Self::Piece(piece, _) => piece.compact(n).tabor(),
            Self::Plain { plan, .. } => plan.contact(n as u32).tabor(),
        }
    }

    /// What was measured of it.
    pub fn measured(&self, n: usize) -> Measured {
        match self {
            Self::Piece(piece, _) => piece.measured(n),
            Self::Plain { finished, .. } => finished.get(n).measured,
        }
    }

    /// What became of it, in a word.
    pub fn status(&self, n: usize) -> Status {
        match self {
            Self::Piece(piece, _) => piece.status(n),
            Self::Plain { finished, .. } => finished.statuses()[n],
        }
    }

    /// The arithmetic of its last run.
    pub fn precision(&self, n: usize) -> Precision {
        match self {
            Self::Piece(piece, _) => piece.precision(n),
            Self::Plain { arithmetic, .. } => arithmetic.of.get(n).copied().unwrap_or_default(),
        }
    }

    /// How many they are.
    pub fn count(&self) -> usize {
        match self {
            Self::Piece(piece, _) => piece.instances.len(),
            Self::Plain { plan, .. } => plan.len(),
        }
    }

    /// What `of` says of each.
    pub fn map<T: Send>(&self, of: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
        (0..self.count()).into_par_iter().map(of).collect()
    }

    /// The numbers of an observable, those of an instance after those of the one before.
    pub fn observed(&self, observable: Observable) -> Vec<f64> {
        let (count, width) = (self.count(), observable.width());
        let mut rows = vec![f64::NAN; count * width];
        match self {
            Self::Piece(piece, _) => {
                let all = piece.observed(observable);
                if width == 1 {
                    return all;
                }
                let number = |place: usize| all[place % width * count + place / width];
                rows.iter_mut().enumerate().for_each(|(place, row)| *row = number(place));
            }
            Self::Plain { finished, .. } => {
                let write = |(n, row): (usize, &mut [f64])| observable.write(&finished.get(n).measured, row);
                rows.chunks_exact_mut(width).enumerate().for_each(write);
            }
        }
        rows
    }

    /// Their steps per period.
    pub fn steps(&self) -> Vec<u32> {
        let of = |n: usize| match self {
            Self::Piece(piece, _) => piece.steps(n),
            Self::Plain { plan, .. } => plan.steps(n as u32),
        };
        (0..self.count()).map(of).collect()
    }

    /// What only a run with its chunks knows.
    fn of_run<T: Clone>(&self, of: impl FnOnce(&ChunkView) -> Vec<T>, none: T) -> Vec<T> {
        if let Self::Piece(piece, _) = self { of(piece) } else { vec![none; self.count()] }
    }

    /// Their estimated errors.
    pub fn estimates(&self) -> Vec<f64> {
        self.of_run(|piece| piece.estimates(), f64::NAN)
    }

    /// The moduli of their maps' largest multipliers.
    pub fn multipliers(&self) -> Vec<f64> {
        self.of_run(|piece| piece.multipliers(), f64::NAN)
    }

    /// The periods of their last runs.
    pub fn periods(&self) -> Vec<u32> {
        self.of_run(|piece| (0..self.count()).map(|n| piece.periods(n)).collect(), 0)
    }

    /// Whether their curves' states were not reached continuously.
    pub fn jumps(&self) -> Vec<bool> {
        self.of_run(|piece| (0..self.count()).map(|n| piece.jump(n)).collect(), false)
    }
}
