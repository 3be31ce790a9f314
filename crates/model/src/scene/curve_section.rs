//! `[curve]`: one quantity that changes while the tip oscillates; the state is carried from point to point.

use super::address::Address;
use super::axes::{AXIS_KEYS, MOST_INSTANCES, axis, axis_values};
use super::draft::{Draft, Said};
use super::scene_error::{Checked, Fault};
use super::values::{self, Key, Value};
use super::{Axis, CurveSpec, Layout, Run, Start, Steady, SweptAxes};
use crate::suggestion::nearest;
use std::sync::Arc;
use toml::de::DeTable;

/// Keys of `[curve]`: an axis, its quantity and its direction.
pub(super) const KEYS: [&str; 7] = ["quantity", "from", "to", "points", "scale", "values", "direction"];

/// Keywords of `curve.direction`: whether the curve is followed back as well.
pub(super) const DIRECTIONS: [(&str, bool); 2] = [("forward", false), ("both", true)];

/// What may change while the tip oscillates.
pub(super) const QUANTITIES: [&str; 6] = [
    "approach.gap",
    "drive.frequency",
    "drive.free_amplitude",
    "drive.voltage",
    "drive.force",
    "drive.base_amplitude",
];

/// Name of the axis that tells the two ways along a curve, and what its values 0 and 1 mean.
pub(super) const DIRECTION: &str = "direction";
/// Words of the axis `direction`: what its values 0 and 1 mean.
const WAYS: [&str; 2] = ["forward", "backward"];

/// Reads the section, if there is one, as the last axes of the sweep.
pub(super) fn read(document: &DeTable, sweep: &mut SweptAxes, draft: &mut Draft) {
    if let Some((key, value)) = document.get_key_value("curve") {
        let read = section(key, value, sweep, draft);
        draft.faults.take(read);
    }
}

fn section(key: &Key, value: &Value, sweep: &mut SweptAxes, draft: &mut Draft) -> Checked<()> {
    let table = values::table(value, "curve", "a section [curve]")?;
    values::no_others(table, "curve", &KEYS)?;
    let (name, quantity) = table.get_key_value("quantity").ok_or_else(|| {
        Fault::at(key.span(), "[curve] does not say what changes along it")
            .label("no `quantity`")
            .expected("quantity = \"approach.gap\", or one of the drive")
            .help("add the line")
    })?;
    let address = followed(quantity)?;
    let path = address.path();
    if let Some(said) = draft.said.iter().find(|said| said.swept && said.path == path) {
        return Err(Fault::at(quantity.span(), format!("`{path}` varies along the curve and beside it"))
            .label("the quantity of the curve")
            .related(said.key.clone(), "varies here")
            .expected("each quantity once")
            .help("remove it here: a curve has all its points"));
    }
    let (points, log) = axis_values(value, address, &["quantity", "direction"])?;
    let both = match table.get("direction") {
        Some(word) => values::keyword(word, "curve.direction", &DIRECTIONS)?,
        None => false,
    };
    let instances = sweep.len().saturating_mul(points.len()).saturating_mul(if both { 2 } else { 1 });
    if instances > MOST_INSTANCES {
        return Err(Fault::at(key.span(), "the curves have too many points")
            .label(format!("{instances} of all curves together"))
            .expected(format!("at most {MOST_INSTANCES}"))
            .help("take fewer points, or split the scene into several"));
    }
    if both {
        sweep.axes.push(direction());
    }
    sweep.axes.push(axis(address, points, log));
    (sweep.layout, sweep.curve) = (Layout::Grid, Some(CurveSpec { both }));
    draft.said.push(Said { path, key: name.span(), swept: true });
    Ok(())
}

fn one_of() -> String {
    let words: Vec<String> = QUANTITIES.iter().map(|path| format!("\"{path}\"")).collect();
    format!("one of {}", words.join(", "))
}

/// The quantity that the curve names, or why it cannot be one.
fn followed(value: &Value) -> Checked<Address> {
    let word = values::text(value, "curve.quantity")?;
    if let (true, Some(address)) = (QUANTITIES.contains(&word), Address::find(word)) {
        return Ok(address);
    }
    let fault = |title: String| Fault::at(value.span(), title).expected(one_of());
    Err(match Address::find(word) {
        Some(_) => fault(format!("`{word}` does not change while the tip oscillates"))
            .label("the tip cannot be followed along it")
            .help("make it an axis of [sweep]: each of its values has a curve of its own"),
        None => fault("the quantity of the curve is unknown".into())
            .label("no such path")
            .help("write its path in the scene, as \"approach.gap\"")
            .maybe_help(
                nearest(word, QUANTITIES.iter().copied()).map(|near| format!("did you mean \"{near}\"?")),
            ),
    })
}

/// The axis of the two ways.
fn direction() -> Axis {
    Axis {
        path: "curve.direction".into(),
        name: DIRECTION.into(),
        long_name: "way along the curve".into(),
        units: "1".into(),
        values: Arc::new(vec![0.0, 1.0]),
        words: WAYS.map(str::to_owned).to_vec(),
        ..Axis::default()
    }
}

/// Refuses ways to a steady state that follow no curve.
pub(super) fn check(run_section: Option<&Value>, run: &Run, sweep: &SweptAxes) -> Checked<()> {
    if sweep.curve.is_none() {
        return Ok(());
    }
    let table = run_section.and_then(|section| section.get_ref().as_table());
    let span = |key: &str| table.and_then(|table| table.get(key)).map_or(0..0, |value| value.span());
    if run.start == Start::Rest {
        return Err(Fault::at(span("start"), "a curve does not start from rest")
            .label("each point goes on from the one before")
            .expected("start = \"steady\"")
            .help("remove the line: the first point begins at the free oscillation"));
    }
    if run.steady == Steady::Wait {
        return Err(Fault::at(span("steady"), "a curve follows periodic states")
            .label("waiting has none to follow")
            .expected("steady = \"search\", which a scene with [curve] has by itself")
            .help("remove the line; a point whose state cannot be found is waited for in any case"));
    }
    if run.both_branches {
        return Err(Fault::at(span("branches"), "a curve has one state at each point of each way")
            .label("a search for second states belongs to a grid")
            .expected("direction = \"both\" in [curve]")
            .help("remove the line: there and back, a curve shows both branches where it meets them"));
    }
    Ok(())
}

/// As [`AXIS_KEYS`], which stand beside the two others.
const _: () = assert!(AXIS_KEYS.len() + 2 == KEYS.len());
