//! What is known of a period map near a state, to first order.

use crate::periodic::{Memory, Size, inverse};
use nalgebra::{DMatrix, DefaultAllocator, DimName, OMatrix};
use std::borrow::Cow;
use std::sync::Arc;

/// The map's Jacobian at a state, in one of two forms. Columns one after the other: travel of the kept modes, then rate over
/// angular frequency, both filled up with modes at rest to the size of the search.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Jacobian {
    /// Nothing, or nobody asks for it any more.
    #[default]
    Unknown,
    /// The Jacobian.
    Monodromy(Box<[f64]>),
    /// The resolvent (I - J)^-1, which takes the change of a period to Newton's step. Single precision:
    /// it leads to states, and no result hangs on it.
    Resolvent(Arc<[f32]>),
}

impl Jacobian {
    pub(super) fn is_known(&self) -> bool {
        !matches!(self, Self::Unknown)
    }

    /// Numbers of the state; none where nothing is known.
    pub(super) fn size(&self) -> usize {
        match self {
            Self::Unknown => 0,
            Self::Monodromy(slope) => slope.len().isqrt(),
            Self::Resolvent(undoes) => undoes.len().isqrt(),
        }
    }

    /// The Jacobian; none where nothing is known.
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

    /// The inverse of one minus the Jacobian; none where nothing is known, or where a multiplier is 1.
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

    /// The same of what nobody asks any more.
    pub fn into_resolvent(self) -> Option<Arc<[f32]>> {
        match self {
            Self::Resolvent(undoes) => Some(undoes),
            other => other.undoes(),
        }
    }
}

/// The inverse of one minus this Jacobian.
pub(super) fn resolvent_of<D: Size + DimName>(slope: &OMatrix<f64, D, D>) -> Option<OMatrix<f64, D, D>>
where
    DefaultAllocator: Memory<D>,
{
    inverse(OMatrix::<f64, D, D>::identity() - slope)
}
