//! Access to the data of all instances, group by group.

use crate::contact::{Contact, Law};
use crate::control::{Arithmetic, ChunkView, JournaledRun};
use crate::engine::{EngineError, ResultColumns};
use crate::observe::{Measured, Observable, Status};
use crate::plan::{Plan, Precision};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::OnceLock;

/// The source of the data.
#[derive(Clone, Copy)]
pub(super) enum InstanceRows<'a> {
    /// The chunks of a run.
    Run(&'a JournaledRun<'a>),
    /// A plan that ran once.
    Plain { plan: &'a Plan, finished: &'a ResultColumns, arithmetic: &'a Arithmetic },
}

impl<'a> InstanceRows<'a> {
    /// Number of instances.
    pub fn count(&self) -> usize {
        match self {
            Self::Run(run) => run.len(),
            Self::Plain { plan, .. } => plan.len(),
        }
    }

    /// The plan of all instances, for a run that before refinement.
    pub fn plan(&self) -> &'a Plan {
        match self {
            Self::Run(run) => &run.plan,
            Self::Plain { plan, .. } => plan,
        }
    }

    /// Status code of each instance.
    pub fn statuses(&self) -> Vec<u8> {
        match self {
            Self::Run(run) => run.marks().iter().map(|mark| mark.status() as u8).collect(),
            Self::Plain { finished, .. } => finished.statuses().iter().map(|one| *one as u8).collect(),
        }
    }

    /// Shows all instances. Without `is_read`, instances of a run come with their plan and flags alone.
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

    /// Numbers of all instances in their order, `width` for each. `of` gives those of a group; see [`InstanceRows::each`].
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

/// A group of instances, numbered within the group.
pub(super) enum RowView<'a> {
    /// A chunk, with its plan once it is needed.
    Piece(&'a ChunkView<'a>, OnceLock<Box<Plan>>),
    Plain {
        plan: &'a Plan,
        finished: &'a ResultColumns,
        arithmetic: &'a Arithmetic,
    },
}

impl RowView<'_> {
    /// The plan of these instances as they ran.
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

    /// Law of the contact of an instance.
    pub fn law(&self, n: usize) -> Law {
        match self {
            Self::Piece(piece, _) => piece.compact(n).law,
            Self::Plain { plan, .. } => plan.law(n as u32),
        }
    }

    /// Tabor's parameter of the contact of an instance.
    pub fn tabor(&self, n: usize) -> f64 {
        match self {
            Self::Piece(piece, _) => piece.compact(n).tabor(),
            Self::Plain { plan, .. } => plan.contact(n as u32).tabor(),
        }
    }

    /// Measurements of an instance.
    pub fn measured(&self, n: usize) -> Measured {
        match self {
            Self::Piece(piece, _) => piece.measured(n),
            Self::Plain { finished, .. } => finished.get(n).measured,
        }
    }

    /// Status of an instance.
    pub fn status(&self, n: usize) -> Status {
        match self {
            Self::Piece(piece, _) => piece.status(n),
            Self::Plain { finished, .. } => finished.statuses()[n],
        }
    }

    /// Arithmetic of an instance's last run.
    pub fn precision(&self, n: usize) -> Precision {
        match self {
            Self::Piece(piece, _) => piece.precision(n),
            Self::Plain { arithmetic, .. } => arithmetic.of.get(n).copied().unwrap_or_default(),
        }
    }

    /// Number of instances in the group.
    pub fn count(&self) -> usize {
        match self {
            Self::Piece(piece, _) => piece.instances.len(),
            Self::Plain { plan, .. } => plan.len(),
        }
    }

    /// Calls `of` for each instance.
    pub fn map<T: Send>(&self, of: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
        (0..self.count()).into_par_iter().map(of).collect()
    }

    /// Numbers of an observable, instance after instance.
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

    /// Steps per period of each instance.
    pub fn steps(&self) -> Vec<u32> {
        let of = |n: usize| match self {
            Self::Piece(piece, _) => piece.steps(n),
            Self::Plain { plan, .. } => plan.steps(n as u32),
        };
        (0..self.count()).map(of).collect()
    }

    /// Data that only a run with chunks has.
    fn of_run<T: Clone>(&self, of: impl FnOnce(&ChunkView) -> Vec<T>, none: T) -> Vec<T> {
        if let Self::Piece(piece, _) = self { of(piece) } else { vec![none; self.count()] }
    }

    /// Estimated error of each instance.
    pub fn estimates(&self) -> Vec<f64> {
        self.of_run(|piece| piece.estimates(), f64::NAN)
    }

    /// Modulus of the largest multiplier of each instance's period map.
    pub fn multipliers(&self) -> Vec<f64> {
        self.of_run(|piece| piece.multipliers(), f64::NAN)
    }

    /// Periods of each instance's last run.
    pub fn periods(&self) -> Vec<u32> {
        self.of_run(|piece| (0..self.count()).map(|n| piece.periods(n)).collect(), 0)
    }

    /// For each instance, whether its curve jumped to its state.
    pub fn jumps(&self) -> Vec<bool> {
        self.of_run(|piece| (0..self.count()).map(|n| piece.jump(n)).collect(), false)
    }
}
