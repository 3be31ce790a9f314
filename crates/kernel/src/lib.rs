//! What runs per step and per instance: the path-averaged kick.
//!
//! The instrument is linear between contacts, so its driven motion without a sample is known
//! in closed form; only the deviation that the contact force excites is stepped. One step of
//! length h is a kick by the contact force and the exact flow of every damped mode. The kick is
//! the mean of the force along the tip's path from half a step before the sample to half a step
//! after it, taken from the law's antiderivative, so that onset, pull-off, jumps and attractions
//! much shorter than a step are weighed exactly instead of sampled. docs/method.md derives the
//! corrections that make it fourth order where the force is smooth, and those that tell when within the step it acts.
//!
//! Everything here is generic over [`Lane`] and uses + - * / sqrt min max abs and select only,
//! so that a shader can say the same in the same order. Whether a product that is summed rounds before the
//! sum is the lane's nature: in the shader's text, and in lanes without [`Pack`]'s FUSED, it does.
//!
//! Units inside: length [`LENGTH`], time one step, impulse as change of tip travel per step.

//! This is a crate of its own because it takes long to compile and changes least: [`Stepper`] is all that the CPU
//! engine calls of it, and the one place where lanes, laws and numbers of modes meet.

pub mod broyden;
mod constants;
pub mod contact;
mod dual;
mod flight;
mod flow;
mod lane;
mod lanes;
mod law;
mod law_text;
pub mod newton;
mod operation_form;
mod pair;
mod period;
mod recorded;
mod recorded_step;
mod run_sums;
mod sample;
mod shader;
mod slopes;
mod step;
mod stepper;
mod sums;
mod tally;
mod tangent;
#[cfg(all(test, target_arch = "x86_64"))]
mod tests;
#[cfg(target_feature = "simd128")]
mod wasm;
mod wgsl;
#[cfg(target_arch = "x86_64")]
mod x86;

pub use flight::{Flight, Flights, flight_block};
pub use flow::{FAST_ANGLE, FlowMode, LANDS, Lever, flown, increments, own_answer};
pub use lane::{Lane, Pack, Zip, when};
pub use lanes::{ROUNDING_VARIABLE, Rounding, instructions, vectorized};
pub use law::{Attraction, Law, WithLaw};
pub use period::Span;
pub use run_sums::RunSums;
pub use sample::Wave;
pub use shader::{Binding, Entry, ShaderSpec, WORKGROUP};
pub use slopes::{Room, SlopeRows, Tangent, little, strict_tangent, tangent};
pub use step::Decay;
pub use stepper::{Real, Stepper, Traced, Tracer, tracer};
pub use sums::{HARMONICS, How, PeriodSums, SUMS, Sum, Wants};
pub use tangent::powers;

/// Length unit inside the kernel, m: keeps f32 far from its limits for any lever.
pub const LENGTH: f64 = 1e-9;

/// Most modes one instance may carry.
pub const MODES_MAX: usize = 24;

/// Most modes for which a kernel of its own is written out; for more there is one with a loop.
pub const WRITTEN_OUT: usize = 8;
