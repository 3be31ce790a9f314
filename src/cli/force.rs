//! `afmsweep force`: static force-indentation curves of one instance's contact.

use super::{load, print, print_json};
use afmsweep::contact::{Contact, Curve};
use afmsweep::units::{self, Dimension};
use std::fmt::Write;
use std::path::PathBuf;

#[derive(clap::Args)]
pub struct ForceArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// Machine-readable answer on standard output, SI units
    #[arg(long)]
    json: bool,
    /// A single indentation such as "75 nm" in place of the whole curve; may be repeated
    #[arg(long, value_name = "LENGTH", value_parser = parse_length, allow_hyphen_values = true)]
    indentation: Vec<f64>,
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
    let contact = Contact::new(&scene.instance(args.instance));
    let curves =
        if args.indentation.is_empty() { contact.curves() } else { contact.curves_at(&args.indentation) };
    if args.json {
        let mut answer = serde_json::to_value(&curves)?;
        answer["instance"] = args.instance.into();
        return print_json(&answer);
    }
    let which = match scene.sweep.axes.is_empty() {
        true => String::new(),
        false => format!(", instance {}{}", args.instance, scene.described(args.instance)),
    };
    let mut text = format!(
        "law {}, K {:.6e} Pa, R {:.6e} m, w {:.6e} J/m^2, Tabor's parameter {:.3}{which}\n",
        contact.law, contact.modulus, contact.radius, contact.work, contact.tabor
    );
    for curve in &curves.curves {
        table(&mut text, curve);
    }
    print(&text)
}

fn table(text: &mut String, curve: &Curve) {
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
