//! Sizes of states and Jacobians, and where their memory comes from.

use nalgebra::DimMin;
use nalgebra::allocator::Allocator;

/// How many numbers a state has: a constant, or as many as it is made with.
pub trait Size: DimMin<Self, Output = Self> {}
impl<D: DimMin<D, Output = D>> Size for D {}

/// Where memory for states and Jacobians comes from.
pub trait Memory<D: Size>: Allocator<D> + Allocator<D, D> {}
impl<D: Size, A: Allocator<D> + Allocator<D, D>> Memory<D> for A {}
