//! Ensemble sweeps of atomic force microscope dynamics: a piezoelectric rod, a cantilever on it, a tip at
//! its end and a sample below, thousands of instances side by side.
//!
//! The instrument is that of J.-L. Ha, R.-F. Fung and Y.-C. Chen, J. Dyn. Syst. Meas. Control 127(4),
//! 705-709 (2005), cited as "Ha, Fung & Chen 2005"; contact is Hertz, DMT or JKR, for tips of several shapes and for samples
//! that are elastic, viscous or relaxing.
//!
//! # Flow
//!
//! [`scene`] (what the user wrote) to [`instrument`] (modes and free motion) and [`contact`] (laws), to
//! [`plan`] (what the scene needs), to [`engine`] (steps it, with [`kernel`]) under [`control`] (of errors), to
//! [`record`] and [`store`]
//! (the results file), to [`report`] (pictures from that file). Imports go the same way. [`Sweep`] is the whole of
//! it up to the results. [`compare`] says how far results are from each other, [`mod@bench`] measures the engines,
//! [`study`] answers a question by many scenes and one page.
//!
//! # Units and signs
//!
//! SI throughout, f64; only [`kernel`] has units of its own. Travel is positive away from the sample, so is
//! the tip force. Indentation is positive in contact. The drive is a sine and phases are lags behind it.
//!
//! # Features
//!
//! `cli` (default; the program) needs all others: `gpu` (the GPU engine), `hdf5` (results files), `report` (pictures and
//! pages). `live` puts the engine of `afmsweep live` into the program; `make live` builds that engine first. With
//! `default-features = false` there is what computes, on the CPU and in memory.
//!
//! # Limits
//!
//! The instrument is linear and its damping modal. The sample is a half-space that deforms a little. A contact shorter than
//! about four steps is reported as out of range.
//!
//! # A run
//!
//! ```
//! use afmsweep::{Scene, Sweep};
//!
//! let text = r#"
//! [instrument.cantilever]
//! quality_factor = 100
//! [contact]
//! law = "hertz"
//! [drive]
//! frequency = "resonance"
//! free_amplitude = "20 nm"
//! [approach]
//! gap = "15 nm"
//! "#;
//! let swept = Sweep::new(Scene::parse("example.toml".as_ref(), text)?).run()?;
//! let amplitude = swept.results.observable("amplitude").expect("scenes ask for it unless they say otherwise");
//! assert!(amplitude.values[0] > 15e-9 && amplitude.values[0] < 20e-9);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

// The program's files call the library by its name, as those of every other program do.
#[cfg(feature = "cli")]
extern crate self as afmsweep;

#[cfg(feature = "report")]
pub mod bench;
// Its comments are texts for terminals.
#[cfg(feature = "cli")]
#[doc(hidden)]
#[allow(rustdoc::all)]
pub mod cli;
#[cfg(feature = "report")]
pub mod study;

pub use observe::{Observable, Status};
pub use plan::{Policy, Precision};
pub use scene::Scene;
pub use store::{Array, Results};
pub use sweep::{Audit, Backend, Error, Observer, Sweep, SweepOutcome};

// The crates below this one, each with the modules that its own page describes.
pub use afmsweep_core::{compare, control, engine, orbit, periodic, plan, record, sweep};
pub use afmsweep_data::{design, observe, reconstruction, stats, store, units};
pub use afmsweep_kernel as kernel;
pub use afmsweep_model::{contact, instrument, scene};
#[cfg(feature = "report")]
pub use afmsweep_report as report;
