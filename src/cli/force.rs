//! `afmsweep force`: static curves of one instance's contact, over the indentation or under a lever over the base.

use super::{SceneArgs, cells, load, print, print_json};
use afmsweep::contact::{Contact, Jump, Ramp, RampCurve, StaticCurve, StaticCurves};
use afmsweep::instrument::Instrument;
use afmsweep::scene::{Params, Scene};
use afmsweep::units::{self, Dimension};
use serde_json::Value;

/// To which the lever's finite elements are fine enough.
const TOLERANCE: f64 = 1e-10;

#[derive(clap::Args)]
#[command(
    after_help = "Examples: afmsweep force lever.toml --indentation \"2 nm\"\n          afmsweep force lever.toml --lever\n          \
                  afmsweep force lever.toml --json\n          afmsweep force lever.toml --csv > force.csv"
)]
pub struct ForceArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// The curves as a table (CSV) on standard output, SI units
    #[arg(long, conflicts_with = "json")]
    csv: bool,
    /// A single indentation such as "75 nm" in place of the whole curve; may be repeated
    #[arg(long, value_name = "LENGTH", value_parser = parse_length, allow_hyphen_values = true)]
    indentation: Vec<f64>,
    /// Over the position of the base in place of the indentation, as the lever bends: approach and retraction with snap-in
    /// and pull-off
    #[arg(long, conflicts_with = "indentation")]
    lever: bool,
    /// Instance of the sweep whose contact is shown, counted from 0; the first has the first value of each axis
    #[arg(short, long, value_name = "N", default_value_t = 0)]
    instance: usize,
}

fn parse_length(text: &str) -> Result<f64, String> {
    units::parse(text, Dimension::Length).map_err(|error| error.to_string())
}

pub fn main(args: &ForceArgs) -> anyhow::Result<()> {
    let scene = load(&args.scene.scene)?;
    if args.instance >= scene.len() {
        anyhow::bail!(
            "there is no instance {}: {} has {}, counted from 0; give --instance 0 to {}",
            args.instance,
            args.scene.scene.display(),
            scene.len(),
            scene.len() - 1
        );
    }
    let params = scene.instance(args.instance);
    let contact = Contact::new(&params);
    let which = match scene.sweep.axes.is_empty() {
        true => String::new(),
        false => format!(", instance {}{}", args.instance, scene.described(args.instance)),
    };
    let mut tip = match contact.shape.has_radius() {
        true => format!("R {:.6e} m", contact.radius),
        false => format!("half-angle {:.4} degree", contact.half_angle),
    };
    if let Some(layer) = contact.layer {
        tip += &format!(", layer of {:.6e} m", layer.thickness);
    }
    let tabor = match contact.tabor() {
        tabor if tabor.is_nan() => String::new(),
        tabor => format!(", Tabor's parameter {tabor:.3}"),
    };
    let mut head = format!(
        "law {}, K {:.6e} Pa, {tip}, w {:.6e} J/m^2{tabor}{which}\n",
        contact.law, contact.modulus, contact.work,
    );
    if args.scene.json {
        return print_json(&answer(&scene, args.instance, &args.indentation, args.lever)?);
    }
    let table = if args.lever {
        let ramp = ramp(&params)?;
        head += &jumps(&ramp);
        Table::of_ramp(&ramp)
    } else {
        Table::of_curves(&curves(&contact, &args.indentation).curves)
    };
    print(&if args.csv { table.csv(&contact.law.to_string())? } else { head + &table.text() })
}

/// The curves of an instance's contact, of single indentations if there are some; `lever`: over the base.
///
/// # Errors
/// The instrument cannot be reduced.
pub fn answer(scene: &Scene, instance: usize, indentations: &[f64], lever: bool) -> anyhow::Result<Value> {
    let params = scene.instance(instance);
    let mut answer = match lever {
        true => serde_json::to_value(ramp(&params)?)?,
        false => serde_json::to_value(curves(&Contact::new(&params), indentations))?,
    };
    answer["instance"] = instance.into();
    Ok(answer)
}

fn ramp(params: &Params) -> anyhow::Result<Ramp> {
    let instrument = Instrument::reduce(&params.instrument, params.drive.on, TOLERANCE)?;
    Ok(Contact::new(params).ramp(1.0 / instrument.bending()))
}

fn curves(contact: &Contact, indentations: &[f64]) -> StaticCurves {
    match indentations {
        [] => contact.curves(),
        some => contact.curves_at(some),
    }
}

/// The jumps of a ramp of the base, and what it loses.
fn jumps(ramp: &Ramp) -> String {
    let jump = |name: &str, jump: Option<Jump>| match jump {
        Some(Jump { base_position_m, force_n: [before, after], .. }) => format!(
            "{name}: base at {:.6} nm, force from {:.6} to {:.6} nN\n",
            base_position_m / 1e-9,
            before / 1e-9,
            after / 1e-9
        ),
        None => format!("{name}: none, the tip moves smoothly\n"),
    };
    format!(
        "lever {:.6} N/m at its tip\n{}{}loss in a cycle: {:.6e} J\n",
        ramp.stiffness_n_per_m,
        jump("snap-in", ramp.snap_in),
        jump("pull-off", ramp.pull_off),
        ramp.loss_j
    )
}

/// The row of a curve, SI; none for what there is not.
type Row = [Option<f64>; 3];

/// Curves below each other: names and units of their columns, and each way with its rows.
struct Table {
    columns: [(&'static str, &'static str); 3],
    curves: Vec<(&'static str, Vec<Row>)>,
}

impl Table {
    fn of_ramp(ramp: &Ramp) -> Self {
        let rows = |curve: &RampCurve| {
            let row =
                |n: usize| [curve.base_position_m[n], curve.indentation_m[n], curve.force_n[n]].map(Some);
            (curve.branch.name(), (0..curve.force_n.len()).map(row).collect())
        };
        let columns = [("base_position", "m"), ("indentation", "m"), ("force", "N")];
        Self { columns, curves: ramp.curves.iter().map(rows).collect() }
    }

    fn of_curves(curves: &[StaticCurve]) -> Self {
        let rows = |curve: &StaticCurve| {
            let row = |n: usize| [Some(curve.indentation_m[n]), curve.force_n[n], curve.contact_radius_m[n]];
            (curve.branch.name(), (0..curve.indentation_m.len()).map(row).collect())
        };
        let columns = [("indentation", "m"), ("force", "N"), ("contact_radius", "m")];
        Self { columns, curves: curves.iter().map(rows).collect() }
    }

    /// Each row with its law and way.
    fn csv(&self, law: &str) -> anyhow::Result<String> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        let heads = self.columns.map(|(name, units)| cells::head(name, units));
        writer.write_record(["law".to_owned(), "branch".to_owned()].into_iter().chain(heads))?;
        for (way, row) in self.curves.iter().flat_map(|(way, rows)| rows.iter().map(move |row| (way, row))) {
            let values = row.map(|value| cells::number(value.unwrap_or(f64::NAN)));
            writer.write_record([law.to_owned(), (*way).to_owned()].into_iter().chain(values))?;
        }
        Ok(String::from_utf8(writer.into_inner()?)?)
    }

    /// In nm and nN.
    fn text(&self) -> String {
        let line = |cells: [String; 3]| cells.map(|cell| format!("{cell:>16}")).join("  ") + "\n";
        let head = self.columns.map(|(name, units)| format!("{}/n{units}", name.replace('_', " ")));
        let shown = |value: f64| format!("{:.6}", value / 1e-9);
        let row = |row: &Row| line(row.map(|value| value.map_or_else(|| "none".to_owned(), shown)));
        let curve = |(way, rows): &(&str, Vec<Row>)| {
            format!("{way}\n{}{}", line(head.clone()), rows.iter().map(row).collect::<String>())
        };
        self.curves.iter().map(curve).collect()
    }
}
