//! The automatic choice of the engine, for messages.

/// The reason for an engine that the user did not name.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EngineChoice {
    /// The CPU: a run this short is done before a GPU is ready.
    Short,
    /// The CPU: a search has too few steps for a GPU to be faster.
    Searched,
    /// The CPU: there is no GPU.
    NoGpu,
    /// The CPU: the GPU of this name cannot compute in f64.
    NoDouble(String),
    /// The only GPU adapter is a software driver, which computes on the processor.
    Software,
    /// One of several GPUs of the same kind, which have these indices.
    OneOf(Vec<usize>),
    /// All GPUs of one kind. These others are not used.
    Without(Vec<String>),
}
