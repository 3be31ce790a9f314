//! Sizes of states and Jacobians, and the allocation of their memory.

use nalgebra::DimMin;
use nalgebra::allocator::Allocator;

/// Number of numbers in a state, constant or dynamic.
pub trait Size: DimMin<Self, Output = Self> {}
impl<D: DimMin<D, Output = D>> Size for D {}

/// Allocates states and Jacobians.
pub trait Memory<D: Size>: Allocator<D> + Allocator<D, D> {}
impl<D: Size, A: Allocator<D> + Allocator<D, D>> Memory<D> for A {}
