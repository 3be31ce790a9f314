//! The plan as text and JSON.

/// What a plan says of itself.
#[derive(Clone, Debug)]
pub struct Summary;
