//! Which engine is taken, in words.

/// Why an engine was taken that was not named.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum EngineChoice {
    /// The CPU: so short a run is done before a GPU is ready.
    Short,
    /// The CPU: of a search there is too little to step for a GPU to be ahead.
    Searched,
    /// The CPU: there is no GPU.
    NoGpu,
    /// The CPU: the GPU of this name cannot compute in f64.
    NoDouble(String),
    /// The only GPU adapter is a software driver, which computes on the processor.
    Software,
    /// One GPU of several of its kind, which have these indices.
    OneOf(Vec<usize>),
    /// All GPUs of one kind; others, which are told, are left out.
    Without(Vec<String>),
}
