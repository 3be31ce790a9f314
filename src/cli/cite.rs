//! `afmsweep cite`: what to cite for a results file, as BibTeX.

use super::print;
use afmsweep::scene::{ActuatorModel, LawChoice, OutsideForce, TipShape};
use afmsweep::store::{self, Results};
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "Example: afmsweep cite results/quickstart.h5 >> references.bib")]
pub struct CiteArgs {
    /// Results file (HDF5)
    file: PathBuf,
}

/// An entry for the instrument of rod and lever and for each contact law, with a blank line between two.
const REFERENCES: &str = include_str!("references.bib");

/// By a word of a law's name in the file, the key of its source.
const LAWS: [(&str, &str); 6] = [
    ("hertz", "hertz1882contact"),
    ("dmt", "derjaguin1975effect"),
    ("jkr", "johnson1971surface"),
    ("viscous", "ting1966contact"),
    ("relaxing", "popov2015method"),
    ("shaped", "sneddon1965relation"),
];

pub fn main(args: &CiteArgs) -> anyhow::Result<()> {
    let results = store::read(&args.file)?;
    let mut entries = vec![program(&results)];
    let scene = super::scene_in(&args.file, &results)?;
    if scene.base.instrument.actuator.model != ActuatorModel::Rigid {
        entries.push(entry("ha2005afm"));
    }
    let used = laws(&results);
    let is_used = |word: &str| used.iter().any(|law| law.split('-').any(|one| one == word));
    entries.extend(LAWS.iter().filter(|(word, _)| is_used(word)).map(|(_, key)| entry(key)));
    let contact = &scene.base.contact;
    if is_used("sum") && contact.law != LawChoice::Sum {
        entries.push(entry(if contact.law == LawChoice::Dmt { LAWS[1].1 } else { LAWS[0].1 }));
    }
    let mut outside: Vec<&str> = contact.outside.iter().filter_map(source).collect();
    outside.sort_unstable();
    outside.dedup();
    entries.extend(outside.into_iter().map(entry));
    if scene.base.instrument.tip.shape == TipShape::SpheroCone {
        entries.push(entry("briscoe1994effect"));
    }
    if scene.base.instrument.tip.shape == TipShape::Pyramid {
        entries.push(entry("bilodeau1992regular"));
    }
    if scene.instance(0).sample.thickness.is_some() {
        entries.push(entry("lebedev1958axisymmetric"));
    }
    print(&entries.join("\n"))
}

/// Whose formula a force beside the contact is, where it is one paper's.
fn source(force: &OutsideForce) -> Option<&'static str> {
    match force {
        OutsideForce::DoubleLayer { .. } => Some("butt1991measuring"),
        OutsideForce::Electrostatic { cone: Some(_), .. } => Some("hudlet1998evaluation"),
        OutsideForce::Capillary { .. } => Some("zitzler2002capillary"),
        _ => None,
    }
}

/// The entry of that key, on lines of its own.
fn entry(key: &str) -> String {
    let found = REFERENCES.trim_end().split("\n\n").find(|entry| entry.contains(key));
    found.map_or_else(String::new, |entry| format!("{entry}\n"))
}

/// The program, in the version that wrote the file.
fn program(results: &Results) -> String {
    let version = results.text("version").unwrap_or("of an unknown version");
    format!(
        "@software{{afmsweep,\n  author  = {{{{The afmsweep developers}}}},\n  title   = {{afmsweep: ensemble sweeps of \
         atomic force microscope dynamics}},\n  version = {{{version}}}\n}}\n"
    )
}

/// Names of the contact laws of the file's instances.
fn laws(results: &Results) -> Vec<&str> {
    let Some(flags) = results.flags.iter().find(|flags| flags.name == "contact_law") else {
        return Vec::new();
    };
    let names = flags.meanings.iter().enumerate();
    names.filter(|(code, _)| flags.data.contains(&(*code as u8))).map(|(_, name)| name.as_str()).collect()
}
