//! `afmsweep force`: static curves of one instance's contact, over the indentation or under a lever over the base.

use super::{cells, load, print, print_json};
use afmsweep::contact::{Contact, Jump, Ramp, StaticCurve};
use afmsweep::instrument::Instrument;
use afmsweep::units::{self, Dimension};
use std::fmt::Write;
use std::path::PathBuf;

/// To which the lever's finite elements are fine enough.
const TOLERANCE: f64 = 1e-10;

#[derive(clap::Args)]
#[command(
    after_help = "Examples: afmsweep force lever.toml --indentation \"2 nm\"\n          afmsweep force lever.toml --lever\n          \
                  afmsweep force lever.toml --json\n          afmsweep force lever.toml --csv > force.csv"
)]
pub struct ForceArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Machine-readable answer on standard output, SI units
    #[arg(long)]
    json: bool,
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
    let scene = load(&args.scene)?;
    if args.instance >= scene.len() {
        anyhow::bail!(
            "there is no instance {}: {} has {}, counted from 0; give --instance 0 to {}",
            args.instance,
            args.scene.display(),
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
    if args.lever {
        let instrument = Instrument::reduce(&params.instrument, params.drive.on, TOLERANCE)?;
        return ramp(&contact.ramp(1.0 / instrument.bending()), (&contact, &head(&contact, &which)), args);
    }
    let curves =
        if args.indentation.is_empty() { contact.curves() } else { contact.curves_at(&args.indentation) };
    if args.json {
        let mut answer = serde_json::to_value(&curves)?;
        answer["instance"] = args.instance.into();
        return print_json(&answer);
    }
    if args.csv {
        let columns = [("indentation", "m"), ("force", "N"), ("contact_radius", "m")];
        let rows = curves.curves.iter().flat_map(|curve| {
            let none = |value: Option<f64>| value.unwrap_or(f64::NAN);
            let row = move |n: usize| {
                let (force, radius) = (none(curve.force_n[n]), none(curve.contact_radius_m[n]));
                (curve.branch.name(), [curve.indentation_m[n], force, radius])
            };
            (0..curve.indentation_m.len()).map(row)
        });
        return print(&csv((&contact, columns), rows)?);
    }
    let mut text = head(&contact, &which);
    for curve in &curves.curves {
        table(&mut text, curve);
    }
    print(&text)
}

fn head(contact: &Contact, which: &str) -> String {
    format!(
        "law {}, K {:.6e} Pa, R {:.6e} m, w {:.6e} J/m^2, Tabor's parameter {:.3}{which}\n",
        contact.law,
        contact.modulus,
        contact.radius,
        contact.work,
        contact.tabor()
    )
}

/// The ramp of the base: both ways, their jumps, and what they lose.
fn ramp(ramp: &Ramp, (contact, head): (&Contact, &str), args: &ForceArgs) -> anyhow::Result<()> {
    if args.json {
        let mut answer = serde_json::to_value(ramp)?;
        answer["instance"] = args.instance.into();
        return print_json(&answer);
    }
    if args.csv {
        let columns = [("base_position", "m"), ("indentation", "m"), ("force", "N")];
        let rows = ramp.curves.iter().flat_map(|curve| {
            let row = move |n: usize| {
                (curve.branch.name(), [curve.base_position_m[n], curve.indentation_m[n], curve.force_n[n]])
            };
            (0..curve.force_n.len()).map(row)
        });
        return print(&csv((contact, columns), rows)?);
    }
    let jump = |name: &str, jump: Option<Jump>| match jump {
        Some(Jump { base_position_m, force_n: [before, after], .. }) => format!(
            "{name}: base at {:.6} nm, force from {:.6} to {:.6} nN\n",
            base_position_m / 1e-9,
            before / 1e-9,
            after / 1e-9
        ),
        None => format!("{name}: none, the tip moves smoothly\n"),
    };
    let mut text = format!("{head}lever {:.6} N/m at its tip\n", ramp.stiffness_n_per_m);
    text += &jump("snap-in", ramp.snap_in);
    text += &jump("pull-off", ramp.pull_off);
    let _ = writeln!(text, "loss in a cycle: {:.6e} J", ramp.loss_j);
    for curve in &ramp.curves {
        let _ = writeln!(
            text,
            "{}\n{:>16}  {:>16}  {:>16}",
            curve.branch.name(),
            "base position/nm",
            "indentation/nm",
            "force/nN"
        );
        for ((base, indentation), force) in
            curve.base_position_m.iter().zip(&curve.indentation_m).zip(&curve.force_n)
        {
            let _ =
                writeln!(text, "{:>16.6}  {:>16.6}  {:>16.6}", base / 1e-9, indentation / 1e-9, force / 1e-9);
        }
    }
    print(&text)
}

/// Curves below each other, each row with its law and way.
fn csv<'a>(
    (contact, columns): (&Contact, [(&str, &str); 3]),
    rows: impl Iterator<Item = (&'a str, [f64; 3])>,
) -> anyhow::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    let heads = columns.map(|(name, units)| cells::head(name, units));
    writer.write_record(["law".to_owned(), "branch".to_owned()].into_iter().chain(heads))?;
    for (way, values) in rows {
        let first = [contact.law.to_string(), way.to_owned()];
        writer.write_record(first.into_iter().chain(values.map(cells::number)))?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

fn table(text: &mut String, curve: &StaticCurve) {
    let shown = |value: Option<f64>, unit: f64| {
        value.map_or_else(|| "none".to_owned(), |value| format!("{:.6}", value / unit))
    };
    // Writing to a String cannot fail.
    let _ = writeln!(
        text,
        "{}\n{:>16}  {:>16}  {:>16}",
        curve.branch.name(),
        "indentation/nm",
        "force/nN",
        "contact radius/nm"
    );
    for (i, indentation) in curve.indentation_m.iter().enumerate() {
        let force = shown(curve.force_n[i], 1e-9);
        let radius = shown(curve.contact_radius_m[i], 1e-9);
        let _ = writeln!(text, "{:>16.6}  {force:>16}  {radius:>16}", indentation / 1e-9);
    }
}
