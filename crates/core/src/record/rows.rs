//! What is known of all instances, some of them after the other.

use crate::contact::{Contact, Law};
use crate::control::{Arithmetic, Piece, Ran};
use crate::engine::{Columns, EngineError, Finished};
use crate::observe::Measured;
use crate::plan::{Plan, Precision};
use rayon::prelude::*;
use std::ops::ControlFlow;
use std::sync::OnceLock;

/// Where it is known.
#[derive(Clone, Copy)]
pub(super) enum Rows<'a> {
    /// A run's portions.
    Run(&'a Ran<'a>),
    /// A plan that was run once as it is.
    Plain { plan: &'a Plan, finished: &'a Columns, arithmetic: &'a Arithmetic },
}

impl<'a> Rows<'a> {
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
    pub fn each(&self, is_read: bool, show: &mut dyn FnMut(&[u32], &Shown)) -> Result<(), EngineError> {
        match *self {
            Self::Run(run) if !is_read => {
                run.each_unread(&mut |piece| show(piece.instances, &Shown::Piece(piece, OnceLock::new())));
                Ok(())
            }
            Self::Run(run) => run.each(&mut |piece| {
                show(piece.instances, &Shown::Piece(piece, OnceLock::new()));
                ControlFlow::Continue(())
            }),
            Self::Plain { plan, finished, arithmetic } => {
                let all: Vec<u32> = plan.instances().collect();
                show(&all, &Shown::Plain { plan, finished, arithmetic });
                Ok(())
            }
        }
    }

    /// So many numbers of each instance, as `write` has them, in the order of the instances; see [`Rows::each`].
    pub fn column<T: Copy + Default + Send + Sync>(
        &self,
        (width, is_read): (usize, bool),
        write: &(dyn Fn(&Shown, usize, &mut [T]) + Sync),
    ) -> Result<Vec<T>, EngineError> {
        let mut all = vec![T::default(); width * self.count()];
        self.each(is_read, &mut |instances, some| {
            let mut rows = vec![T::default(); width * instances.len()];
            rows.par_chunks_exact_mut(width).enumerate().for_each(|(n, row)| write(some, n, row));
            for (i, row) in instances.iter().zip(rows.chunks_exact(width)) {
                all[*i as usize * width..][..width].copy_from_slice(row);
            }
        })?;
        Ok(all)
    }
}

/// Some instances, by their numbers among these.
pub(super) enum Shown<'a> {
    /// With their plan, once it is asked for.
    Piece(&'a Piece<'a>, OnceLock<Box<Plan>>),
    Plain {
        plan: &'a Plan,
        finished: &'a Columns,
        arithmetic: &'a Arithmetic,
    },
}

impl Shown<'_> {
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
            Self::Piece(piece, _) => piece.compact(n).law(),
            Self::Plain { plan, .. } => plan.law(n as u32),
        }
    }

    /// Tabor's parameter of its contact.
    pub fn tabor(&self, n: usize) -> f64 {
        match self {
            Self::Piece(piece, _) => piece.compact(n).tabor(),
            Self::Plain { plan, .. } => plan.contact(n as u32).tabor,
        }
    }

    /// What was measured of it.
    pub fn measured(&self, n: usize) -> Measured {
        match self {
            Self::Piece(piece, _) => piece.measured(n),
            Self::Plain { finished, .. } => finished.get(n).measured,
        }
    }

    /// What became of it.
    pub fn finished(&self, n: usize) -> Finished {
        match self {
            Self::Piece(piece, _) => piece.finished(n),
            Self::Plain { finished, .. } => finished.get(n),
        }
    }

    /// Its steps per period.
    pub fn steps(&self, n: usize) -> u32 {
        match self {
            Self::Piece(piece, _) => piece.steps(n),
            Self::Plain { plan, .. } => plan.steps(n as u32),
        }
    }

    /// The arithmetic of its last run.
    pub fn precision(&self, n: usize) -> Precision {
        match self {
            Self::Piece(piece, _) => piece.precision(n),
            Self::Plain { arithmetic, .. } => arithmetic.of.get(n).copied().unwrap_or_default(),
        }
    }

    /// What only a run with its portions knows.
    fn piece<T>(&self, of: impl FnOnce(&Piece) -> T, none: T) -> T {
        if let Self::Piece(piece, _) = self { of(piece) } else { none }
    }

    /// Its estimated error.
    pub fn estimate(&self, n: usize) -> f64 {
        self.piece(|piece| piece.estimate(n), f64::NAN)
    }

    /// The modulus of its map's largest multiplier.
    pub fn multiplier(&self, n: usize) -> f64 {
        self.piece(|piece| piece.multiplier(n), f64::NAN)
    }

    /// The periods of its last run.
    pub fn periods(&self, n: usize) -> u32 {
        self.piece(|piece| piece.periods(n), 0)
    }

    /// Whether its curve's state was not reached continuously.
    pub fn jump(&self, n: usize) -> bool {
        self.piece(|piece| piece.jump(n), false)
    }
}
