//! `afmsweep live`: a page that computes by itself, with the engine for WebAssembly in it.

use super::{Verbosity, load};
use afmsweep::Scene;
use afmsweep::report::live_page;
use afmsweep::scene::{ActuatorModel, LEVERS, SweptAxes};
use anyhow::{Context, bail};
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

#[derive(clap::Args)]
#[command(after_help = "Example: afmsweep live lever.toml -o lever.html")]
pub struct LiveArgs {
    /// Scene that the page begins with, without what it sweeps; - for standard input [default: a calibrated lever on polystyrene]
    scene: Option<PathBuf>,
    /// The page
    #[arg(short, long, value_name = "FILE", default_value = "live.html")]
    output: PathBuf,
    /// The page's engine, as `make live` builds it [default: the one in this program]
    #[arg(long, value_name = "FILE")]
    engine: Option<PathBuf>,
}

/// The engine that `make live` has built before this program.
#[cfg(feature = "live")]
const BUILT_IN: Option<&[u8]> =
    Some(include_bytes!(concat!(env!("CARGO_MANIFEST_DIR"), "/target/web/engine.wasm.zst")));
#[cfg(not(feature = "live"))]
const BUILT_IN: Option<&[u8]> = None;

/// The first bytes of a file packed by zstd.
const ZSTD: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Tables of a scene that the page's sliders and pictures take the place of.
const LEFT_OUT: [&str; 7] = ["title", "sweep", "samples", "uncertain", "design", "curve", "output"];
/// What the page keeps of `[run]`: it searches for steady states.
const RUN_KEPT: [&str; 2] = ["accuracy", "modes"];

/// Writes the page.
pub fn main(args: &LiveArgs, voice: Verbosity) -> anyhow::Result<()> {
    let scene = match &args.scene {
        Some(path) => load(path)?,
        None => Scene::parse(Path::new("begin.toml"), include_str!("../../crates/web/page/begin.toml"))?,
    };
    let Some(engine) = engine(args.engine.as_deref())? else {
        bail!(
            "this program has no engine for pages in it: run `make live` in the project's folder, which builds one, \
             or name its file by --engine"
        )
    };
    let page = live_page(&start(&scene)?, &engine);
    std::fs::write(&args.output, &page).with_context(|| format!("cannot write {}", args.output.display()))?;
    if args.scene.is_some() && scene.len() > 1 {
        voice.say("note: the page begins with the scene's first values; its sliders take the place of what the scene varies");
    }
    let size = page.len() as f64 / 1e6;
    voice.say(format_args!("wrote {} ({size:.1} MB): open it in a browser", args.output.display()));
    Ok(())
}

/// The engine in that file, or the one in this program; none where there is neither.
pub(super) fn engine(file: Option<&Path>) -> anyhow::Result<Option<Vec<u8>>> {
    let Some(path) = file else { return Ok(BUILT_IN.map(<[u8]>::to_vec)) };
    let engine = std::fs::read(path).with_context(|| format!("cannot read {}", path.display()))?;
    if !engine.starts_with(&ZSTD) {
        bail!(
            "{} is no engine for pages: expected the file engine.wasm.zst that `make live` builds",
            path.display()
        );
    }
    Ok(Some(engine))
}

/// What the page begins with.
pub(super) fn start(scene: &Scene) -> anyhow::Result<Value> {
    let mut first = scene.clone();
    (first.base, first.sweep) = (scene.instance(0), SweptAxes::default());
    let resolved: toml::Table = first.resolved_toml().parse().context("the scene with every value")?;
    let mut base = object(&resolved);
    for table in LEFT_OUT {
        base.remove(table);
    }
    // What only repeats the default would make the scene that the page gives longer than the reader's own.
    if let Some(Value::Object(instrument)) = base.get_mut("instrument") {
        if scene.lever.is_none() {
            instrument.remove("preset");
        }
        if scene.base.instrument.actuator.model == ActuatorModel::Rigid {
            instrument.insert("actuator".into(), json!({ "model": "rigid" }));
        }
        // The page has a slider for each value that it finds, and a point has no radius.
        if let Some(Value::Object(tip)) = instrument.get_mut("tip")
            && !scene.base.instrument.tip.shape.has_radius()
        {
            tip.remove("radius");
        }
    }
    let mut run = Map::new();
    run.insert("steady".into(), "search".into());
    if let Some(Value::Object(given)) = base.get("run") {
        run.extend(
            given
                .iter()
                .filter(|(key, _)| RUN_KEPT.contains(&key.as_str()))
                .map(|(key, value)| (key.clone(), value.clone())),
        );
    }
    base.insert("run".into(), Value::Object(run));
    let lever = |lever: &afmsweep::scene::MakersLever| {
        json!({
            "preset": lever.preset,
            "model": lever.source,
            "stiffness": lever.stiffness,
            "frequency": lever.frequency,
            "radius": lever.tip_radius,
        })
    };
    Ok(json!({
        "title": scene.title,
        "base": base,
        "levers": LEVERS.iter().map(lever).collect::<Vec<_>>(),
    }))
}

fn object(table: &toml::Table) -> Map<String, Value> {
    table.iter().map(|(key, value)| (key.clone(), as_json(value))).collect()
}

/// JSON has no infinite numbers; a scene takes them as texts too.
fn as_json(value: &toml::Value) -> Value {
    match value {
        toml::Value::Table(table) => Value::Object(object(table)),
        toml::Value::Array(all) => all.iter().map(as_json).collect(),
        toml::Value::Float(number) if !number.is_finite() => number.to_string().into(),
        toml::Value::Float(number) => (*number).into(),
        toml::Value::Integer(number) => (*number).into(),
        toml::Value::Boolean(word) => (*word).into(),
        other => other.as_str().unwrap_or_default().into(),
    }
}
