//! afmsweep for a web page: the text of a scene in, its results out as JSON. WebAssembly calls [`run`] over plain memory; native
//! programs call [`answer`].

// Those that the compiler brings may be of another version than the program's.
#[cfg(target_arch = "wasm32")]
#[path = "../../../src/elementary_functions.rs"]
mod elementary_functions;
mod memory;

use afmsweep_core::plan::Precision;
use afmsweep_core::sweep::{Audit, Backend, Sweep, SweepOutcome};
use afmsweep_data::observe::Status;
use afmsweep_data::store::{Coordinate, Flags, Results, Variable};
use afmsweep_model::scene::Scene;
use serde_json::{Map, Value, json};
use std::path::Path;

/// The results of a scene as a JSON object, or `{"error": why}`. Numbers are in SI units and f64, `null` for what is no number.
///
/// `axes`, `variables`, `status` (codes), `words` (of the codes: one word, and what it means), `flags` and `waveforms` are those
/// of the results file; `warnings` are messages. The engine is that of the CPU, in f64; nothing is audited.
pub fn answer(scene: &str) -> String {
    let told = match outcome(scene) {
        Ok(outcome) => results(&outcome),
        Err(why) => json!({ "error": why }),
    };
    told.to_string()
}

fn outcome(scene: &str) -> Result<SweepOutcome, String> {
    let scene = Scene::parse(Path::new("scene.toml"), scene).map_err(|error| error.to_string())?;
    let sweep = Sweep::new(scene).backend(Backend::Cpu).precision(Some(Precision::F64));
    sweep.audit(Audit::None).run().map_err(|error| error.to_string())
}

fn results(outcome: &SweepOutcome) -> Value {
    let results = &outcome.results;
    let words = |status: &Status| json!({ "word": status.meaning(), "reason": status.reason() });
    json!({
        "axes": results.axes.iter().map(axis).collect::<Vec<_>>(),
        "variables": variables(&results.variables),
        "status": results.status,
        "words": Status::ALL.iter().map(words).collect::<Vec<_>>(),
        "flags": flags(&results.flags),
        "waveforms": waveforms(results),
        "warnings": outcome.warnings,
    })
}

fn axis(axis: &Coordinate) -> Value {
    json!({
        "name": axis.name,
        "units": axis.units,
        "long_name": axis.long_name,
        "scene_path": axis.scene_path,
        "words": axis.words,
        "values": *axis.values,
    })
}

fn variables(all: &[Variable]) -> Value {
    let told = |one: &Variable| {
        (one.name.clone(), json!({ "units": one.units, "long_name": one.long_name, "data": one.data }))
    };
    Value::Object(all.iter().map(told).collect::<Map<_, _>>())
}

fn flags(all: &[Flags]) -> Value {
    let told = |one: &Flags| {
        let value = json!({ "long_name": one.long_name, "meanings": one.meanings, "bits": one.bits, "data": one.data });
        (one.name.clone(), value)
    };
    Value::Object(all.iter().map(told).collect::<Map<_, _>>())
}

fn waveforms(results: &Results) -> Value {
    results.waveforms.as_ref().map_or(Value::Null, |waves| {
        json!({
            "time": waves.time,
            "tip_travel": waves.tip_travel,
            "force": waves.force,
        })
    })
}
