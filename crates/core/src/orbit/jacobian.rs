//! First-order information on a period map near a state.

use nalgebra::DMatrix;
use std::borrow::Cow;
use std::sync::Arc;

/// The map's Jacobian at a state, in one of two forms, both column by column: travels of the kept modes, then rates over
/// angular frequency, padded with modes at rest to the size of the search.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Jacobian {
    /// Nothing is known, or no search starts here any more.
    #[default]
    Unknown,
    /// The Jacobian J, the monodromy matrix.
    Monodromy(Box<[f64]>),
    /// The resolvent (I - J)^-1, which turns the residual of a period into a Newton step. f32 suffices: it only leads to
    /// states, and no result depends on it.
    Resolvent(Arc<[f32]>),
}

impl Jacobian {
    pub(super) fn is_known(&self) -> bool {
        !matches!(self, Self::Unknown)
    }

    /// Numbers of the state; 0 if nothing is known.
    pub(super) fn size(&self) -> usize {
        match self {
            Self::Unknown => 0,
            Self::Monodromy(slope) => slope.len().isqrt(),
            Self::Resolvent(undoes) => undoes.len().isqrt(),
        }
    }

    /// The Jacobian; `None` if nothing is known.
    pub(super) fn monodromy(&self) -> Option<Cow<'_, [f64]>> {
        let size = self.size();
        match self {
            Self::Unknown => None,
            Self::Monodromy(slope) => Some(Cow::Borrowed(slope)),
            Self::Resolvent(undoes) => {
                let resolvent = DMatrix::from_iterator(size, size, undoes.iter().copied().map(f64::from));
                let slope = DMatrix::identity(size, size) - resolvent.try_inverse()?;
                Some(Cow::Owned(slope.as_slice().to_vec()))
            }
        }
    }

    /// The resolvent (I - J)^-1; `None` if nothing is known or a multiplier is 1.
    pub fn undoes(&self) -> Option<Arc<[f32]>> {
        let size = self.size();
        match self {
            Self::Unknown => None,
            Self::Resolvent(undoes) => Some(Arc::clone(undoes)),
            Self::Monodromy(slope) => {
                let minus = DMatrix::identity(size, size) - DMatrix::from_column_slice(size, size, slope);
                Some(minus.try_inverse()?.iter().map(|value| *value as f32).collect())
            }
        }
    }
}
