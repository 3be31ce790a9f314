//! Statistics of the samples in a results file: how an observable is distributed, and which parameter decides it.
//!
//! Rows that failed never count silently: they are told by their status, and where rows of a design belong together the
//! whole base sample goes.

mod bins;
mod curve_pieces;
mod elementary_effects;
mod estimate;
mod likelihood;
mod marginal;
mod measured_curve;
mod observable_summary;
mod saltelli;
pub mod stats_json;
mod study_samples;

pub use bins::first_order;
pub use elementary_effects::{Effects, Steps, effects};
pub use estimate::{Estimate, NORMAL_95, Spread, mean, quantile, quantiles_by_order, sd};
pub use likelihood::{FEWEST_EFFECTIVE, Observed, Posterior, posterior};
pub use measured_curve::{
    CurveColumn, CurveMeasurement, Fit, FreeParameter, SampleCurve, curve_posterior, quantity,
};
pub use observable_summary::{
    Convergence, Distributed, SHARES, SensitivityIndices, Summary, SummaryOptions, sorted_out, summary,
};
pub use saltelli::{SobolIndices, indices};
pub use study_samples::{Study, StudyOutput, outputs, status_word};

use thiserror::Error;

/// Why there are no statistics.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum StatsError {
    #[error(
        "the file has no samples: it is a single case or a grid; give its scene [uncertain] and [design], or [samples]"
    )]
    NoSamples,
    #[error("attribute `design` does not fit the file ({why}); run the scene again")]
    Design { why: String },
    #[error("the file has no observable {name}; it has {known}")]
    Output { name: String, known: String },
    #[error(
        "{lost} of {rows} rows cannot count for {output}, more than {share} %: {told}. What is left is no fair sample. \
         See why they failed (`afmsweep report`, `afmsweep explain`), or allow it: --left-out 100; --keep STATUS counts a status as ok"
    )]
    LeftOut { output: String, lost: usize, rows: usize, share: f64, told: String },
    #[error(
        "rows of a {kind} design are no sample of the parameters: indices come from it, not inference. Run the scene with \
         kind = \"sobol\", \"latin-hypercube\" or \"monte-carlo\""
    )]
    NoSample { kind: &'static str },
    #[error(
        "only {effective:.1} effective samples of {rows} agree with what was observed, fewer than {FEWEST_EFFECTIVE}: nothing is told by so \
         few. The best row misses by {best:.1} standard deviations in all, {each:.1} at each value. {spans}Take more samples, or \
         distributions that lie closer around that; where even the best row misses by many, the observed values or their errors do not fit the model"
    )]
    FewEffective { effective: f64, rows: usize, best: f64, each: f64, spans: String },
}
