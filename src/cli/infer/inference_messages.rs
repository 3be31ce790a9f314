//! An inference in words and as JSON.

use afmsweep::design::Distribution;
use afmsweep::report::shown;
use afmsweep::report::uncertainty::{Compared, Comparison, Inference, Observation, PredictionPath};
use afmsweep::stats::{Observed, Posterior, Study};
use afmsweep::store::Coordinate;
use serde_json::{Map, Value, json};

/// Shares of which quantiles are told.
const SHARES: [f64; 5] = [0.025, 0.25, 0.5, 0.75, 0.975];
/// Standard deviations in all that the best of many rows does not miss by where the model is right.
const FAR: f64 = 2.0;
/// Likewise of a curve of many values, standard deviations of the sum of squares around what it is on average.
const FAR_IN_ALL: f64 = 4.0;
/// Correlations from which on two quantities are said to hang together.
const TOGETHER: f64 = 0.3;

/// What was found at a point of the sweep.
pub(super) struct InferenceAnswer {
    pub at: Map<String, Value>,
    pub point: usize,
    pub found: Posterior,
    /// What was not known of a measured curve, by row, and its prior.
    pub free: Vec<(Coordinate, Distribution)>,
    pub seen: ObservedValues,
}

/// What was observed.
pub(super) enum ObservedValues {
    Values(Vec<Observed>),
    Curve(Comparison),
}

/// A parameter's or an observable's name, unit and values by row.
struct Column<'a> {
    name: &'a str,
    units: &'a str,
    values: Vec<f64>,
}

impl InferenceAnswer {
    pub fn page<'a>(&'a self, study: &'a Study) -> Inference<'a> {
        let observed = match &self.seen {
            ObservedValues::Values(values) => Observation::Values(values),
            ObservedValues::Curve(curve) => Observation::Curve(curve),
        };
        let warning = self.misfit().map(|words| format!("{words}."));
        Inference { study, posterior: &self.found, free: &self.free, observed, warning }
    }

    /// What is to be said where not even the best row comes near what was observed.
    pub fn misfit(&self) -> Option<String> {
        let squares = self.found.best_chi_squared;
        let (far, off, each) = match &self.seen {
            ObservedValues::Values(_) => (squares > FAR * FAR, squares.sqrt(), ""),
            ObservedValues::Curve(curve) => {
                let values = curve.values as f64;
                let far = squares > values + FAR_IN_ALL * (2.0 * values).sqrt();
                (far, (squares / values).sqrt(), " at each value")
            }
        };
        far.then(|| {
            format!(
                "even the best row misses by {off:.1} standard deviations{each}: the observed values, their errors or the model are wrong"
            )
        })
    }

    fn parameters<'a>(&'a self, study: &'a Study) -> Vec<Column<'a>> {
        let free = self.free.iter().map(|(one, _)| one);
        let column =
            |one: &'a Coordinate| Column { name: &one.name, units: &one.units, values: one.values.to_vec() };
        study.parameters.iter().chain(free).map(column).collect()
    }

    /// Observables that were not observed: what the model then says of them.
    fn predicted<'a>(&self, study: &'a Study) -> Vec<Column<'a>> {
        let ObservedValues::Values(observed) = &self.seen else { return Vec::new() };
        let free = study.outputs.iter().filter(|one| !observed.iter().any(|known| known.name == one.name));
        free.map(|one| Column {
            name: &one.name,
            units: &one.units,
            values: study.at(&one.values, self.point),
        })
        .collect()
    }

    pub fn json(&self, study: &Study) -> Value {
        let found = &self.found;
        let of = |column: &Column| -> Value {
            let quantile = |share: &f64| (share.to_string(), json!(found.quantile(&column.values, *share)));
            let quantiles: Map<String, Value> = SHARES.iter().map(quantile).collect();
            json!({
                "units": column.units,
                "mean": found.mean(&column.values),
                "sd": found.sd(&column.values),
                "quantiles": quantiles,
            })
        };
        let all = |columns: &[Column]| -> Map<String, Value> {
            columns.iter().map(|column| (column.name.to_owned(), of(column))).collect()
        };
        let parameters = self.parameters(study);
        let correlation: Vec<Vec<f64>> = parameters
            .iter()
            .map(|a| parameters.iter().map(|b| found.correlation(&a.values, &b.values)).collect())
            .collect();
        let mut told = json!({
            "version": 1,
            "at": self.at,
            "rows": found.rows.len(),
            "left_out": found.left_out,
            "effective_samples": found.effective,
            "best_chi_squared": found.best_chi_squared,
            "names": parameters.iter().map(|one| one.name).collect::<Vec<_>>(),
            "parameters": all(&parameters),
            "correlation": correlation,
        });
        match &self.seen {
            ObservedValues::Values(observed) => {
                let one = |one: &Observed| (one.name.clone(), json!({ "value": one.value, "sd": one.sd }));
                told["observed"] = observed.iter().map(one).collect::<Map<_, _>>().into();
                told["predicted"] = all(&self.predicted(study)).into();
            }
            ObservedValues::Curve(curve) => {
                told["observed"] = json!({
                    "file": curve.file,
                    "rows": curve.rows,
                    "left_out": curve.left_out,
                    "values": curve.values,
                    "observables": curve.observables,
                });
                let prior = |(one, prior): &(Coordinate, Distribution)| (one.name.clone(), json!(prior));
                told["free"] = self.free.iter().map(prior).collect::<Map<_, _>>().into();
                told["predicted"] = predictions(study, curve).into();
            }
        }
        told
    }

    pub fn text(&self, study: &Study) -> String {
        let found = &self.found;
        let mut text = String::new();
        if !self.at.is_empty() {
            text += &format!("== {}\n", Value::Object(self.at.clone()));
        }
        text += &format!("{} rows, {:.0} effective; the best misses ", found.rows.len(), found.effective);
        let squares = found.best_chi_squared;
        text += &match &self.seen {
            ObservedValues::Values(observed) => {
                let names: Vec<&str> = observed.iter().map(|one| one.name.as_str()).collect();
                format!("{} observed by {:.2} standard deviations in all\n", names.join(", "), squares.sqrt())
            }
            ObservedValues::Curve(curve) => format!(
                "{} values of {} at {} places by {:.2} standard deviations each\n",
                curve.values,
                curve.observables.join(", "),
                curve.rows,
                (squares.max(0.0) / curve.values as f64).sqrt()
            ),
        };
        let line = |column: &Column| {
            let at = |share: f64| shown(found.quantile(&column.values, share), column.units, 4);
            format!("  {}: {}, 95 % from {} to {}\n", column.name, at(0.5), at(0.025), at(0.975))
        };
        let parameters = self.parameters(study);
        parameters.iter().for_each(|column| text += &line(column));
        for (n, a) in parameters.iter().enumerate() {
            for b in &parameters[n + 1..] {
                let together = found.correlation(&a.values, &b.values);
                if together.abs() >= TOGETHER {
                    text +=
                        &format!("  {} and {} hang together: correlation {together:.2}\n", a.name, b.name);
                }
            }
        }
        let predicted = self.predicted(study);
        if !predicted.is_empty() {
            text += "what was not observed is then:\n";
            predicted.iter().for_each(|column| text += &line(column));
        }
        text
    }
}

/// Of each observable its median along the measured curve, and what lies 95 % around it.
fn predictions(study: &Study, curve: &Comparison) -> Map<String, Value> {
    let one = |panel: &Compared| {
        let output = &study.outputs[panel.output];
        let way = |way: &PredictionPath| {
            let quantile = |n: usize| way.band.iter().map(|(_, band)| json!(band[n])).collect::<Vec<Value>>();
            let places: Vec<f64> = way.band.iter().map(|(place, _)| *place).collect();
            json!({
                "direction": way.name,
                (curve.name.as_str()): places,
                "quantiles": { "0.025": quantile(0), "0.5": quantile(1), "0.975": quantile(2) },
            })
        };
        let ways: Vec<Value> = panel.ways.iter().map(way).collect();
        (output.name.clone(), json!({ "units": output.units, "curves": ways }))
    };
    curve.panels.iter().map(one).collect()
}
