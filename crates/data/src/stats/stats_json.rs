//! Statistics as JSON: SI, names as in the results file, intervals beside what they are of.

use super::estimate::Estimate;
use super::observable_summary::{Convergence, SHARES, SensitivityIndices, Summary};
use super::{Study, StudyOutput};
use serde_json::{Map, Value, json};

/// JSON has no NaN.
fn number(value: f64) -> Value {
    if value.is_finite() { json!(value) } else { Value::Null }
}

fn values(all: &[Estimate]) -> Value {
    all.iter().map(|one| number(one.value)).collect()
}

fn half_widths(all: &[Estimate]) -> Value {
    all.iter().map(|one| number(one.half_width)).collect()
}

fn numbers(all: &[f64]) -> Value {
    all.iter().map(|value| number(*value)).collect()
}

fn interval(one: Estimate) -> Value {
    json!([number(one.value - one.half_width), number(one.value + one.half_width)])
}

/// Where a point stands: of each axis its value, or the word for it.
pub fn place(study: &Study, point: usize) -> Map<String, Value> {
    let at = study.place(point);
    let one = |(axis, at): (&crate::store::Coordinate, &usize)| {
        let value = axis.words.get(*at).map_or_else(|| number(axis.values[*at]), |word| json!(word));
        (axis.name.clone(), value)
    };
    study.beside.iter().zip(&at).map(one).collect()
}

/// What is told of one observable at one point.
pub fn summary(summary: &Summary, output: &StudyOutput) -> Value {
    let mut told = Map::new();
    let mut say = |key: &str, value: Value| drop(told.insert(key.into(), value));
    say("units", json!(output.units));
    say("count", json!(summary.count));
    say("left_out", json!(summary.left_out));
    say("interval", json!(summary.intervals.name()));
    if let Some(spread) = &summary.spread {
        say("mean", number(spread.mean.value));
        say("mean_interval", interval(spread.mean));
        say("sd", number(spread.sd.value));
        say("sd_interval", interval(spread.sd));
        let named = |tell: &dyn Fn(Estimate) -> Value| -> Map<String, Value> {
            SHARES.iter().zip(&spread.quantiles).map(|(share, one)| (share.to_string(), tell(*one))).collect()
        };
        say("quantiles", named(&|one| number(one.value)).into());
        say("quantile_intervals", named(&interval).into());
    }
    match &summary.indices {
        SensitivityIndices::Saltelli(indices) => {
            say("S1", values(&indices.first));
            say("S1_conf", half_widths(&indices.first));
            say("ST", values(&indices.total));
            say("ST_conf", half_widths(&indices.total));
            if !indices.second.is_empty() {
                let groups = indices.first.len();
                say("S2", pairs(groups, &indices.second, |one| number(one.value)));
                say("S2_conf", pairs(groups, &indices.second, |one| number(one.half_width)));
            }
        }
        SensitivityIndices::Morris(effects) => {
            say("mu", numbers(&effects.mu));
            say("mu_star", values(&effects.mu_star));
            say("mu_star_conf", half_widths(&effects.mu_star));
            say("sigma", numbers(&effects.sigma));
        }
        SensitivityIndices::Bins(first) => {
            say("S1", values(first));
            say("S1_conf", half_widths(first));
        }
    }
    summary.few_told().into_iter().for_each(|doubt| say("S1_doubt", json!(doubt)));
    if let (Some(sum), Some(told)) = (summary.overlap, summary.overlap_told()) {
        say("S1_sum", number(sum));
        say("S1_note", json!(told));
    }
    say("convergence", summary.convergence.iter().map(|one| convergence(one, summary)).collect());
    let (median, largest) = summary.simulation_error;
    let sampling = summary.spread.as_ref().map_or(f64::NAN, |spread| spread.mean.half_width);
    say(
        "errors",
        json!({
            "simulation_median": number(median),
            "simulation_largest": number(largest),
            "simulation_scale": output.error_scale,
            "sampling_of_mean": number(sampling),
        }),
    );
    Value::Object(told)
}

/// A matrix with pairs above its diagonal, null elsewhere.
fn pairs(groups: usize, all: &[Estimate], tell: impl Fn(&Estimate) -> Value) -> Value {
    let mut next = all.iter();
    let row = |j: usize, next: &mut std::slice::Iter<Estimate>| -> Value {
        let one = |k: usize| if k > j { next.next().map_or(Value::Null, &tell) } else { Value::Null };
        (0..groups).map(one).collect()
    };
    (0..groups).map(|j| row(j, &mut next)).collect()
}

fn convergence(one: &Convergence, summary: &Summary) -> Value {
    let mut told = Map::new();
    told.insert("samples".into(), json!(one.samples));
    if let Some(mean) = one.mean {
        told.insert("mean".into(), number(mean.value));
        told.insert("mean_interval".into(), interval(mean));
    }
    let first = if matches!(summary.indices, SensitivityIndices::Morris(_)) { "mu_star" } else { "S1" };
    told.insert(first.into(), values(&one.first));
    told.insert(format!("{first}_conf"), half_widths(&one.first));
    if !one.total.is_empty() {
        told.insert("ST".into(), values(&one.total));
        told.insert("ST_conf".into(), half_widths(&one.total));
    }
    Value::Object(told)
}
