//! `afmsweep cite`: what to cite for a results file, as BibTeX.

use super::print;
use afmsweep::scene::{ActuatorModel, Scene};
use afmsweep::store::{self, Results};
use anyhow::Context;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(after_help = "Example: afmsweep cite results/quickstart.h5 >> references.bib")]
pub struct CiteArgs {
    /// Results file (HDF5)
    file: PathBuf,
}

/// The instrument of rod and lever.
const ROD: &str = r#"@article{ha2005afm,
  author  = {Ha, J.-L. and Fung, R.-F. and Chen, Y.-C.},
  title   = {Dynamic Responses of an Atomic Force Microscope Interacting With Samples},
  journal = {Journal of Dynamic Systems, Measurement, and Control},
  volume  = {127},
  number  = {4},
  pages   = {705--709},
  year    = {2005}
}
"#;

/// By a law's name in the file, where it comes from.
const LAWS: [(&str, &str); 3] = [
    (
        "hertz",
        r#"@article{hertz1882contact,
  author  = {Hertz, Heinrich},
  title   = {{\"U}ber die Ber{\"u}hrung fester elastischer K{\"o}rper},
  journal = {Journal f{\"u}r die reine und angewandte Mathematik},
  volume  = {92},
  pages   = {156--171},
  year    = {1882}
}
"#,
    ),
    (
        "dmt",
        r#"@article{derjaguin1975effect,
  author  = {Derjaguin, B. V. and Muller, V. M. and Toporov, Yu. P.},
  title   = {Effect of contact deformations on the adhesion of particles},
  journal = {Journal of Colloid and Interface Science},
  volume  = {53},
  number  = {2},
  pages   = {314--326},
  year    = {1975}
}
"#,
    ),
    (
        "jkr",
        r#"@article{johnson1971surface,
  author  = {Johnson, K. L. and Kendall, K. and Roberts, A. D.},
  title   = {Surface energy and the contact of elastic solids},
  journal = {Proceedings of the Royal Society of London A},
  volume  = {324},
  number  = {1558},
  pages   = {301--313},
  year    = {1971}
}
"#,
    ),
];

pub fn main(args: &CiteArgs) -> anyhow::Result<()> {
    let results = store::read(&args.file)?;
    let mut entries = vec![program(&results)];
    let text = results.text("scene").unwrap_or_default();
    let scene =
        Scene::parse(&args.file, text).with_context(|| format!("the scene in {}", args.file.display()))?;
    if scene.base.instrument.actuator.model != ActuatorModel::Rigid {
        entries.push(ROD.into());
    }
    let used = laws(&results);
    entries.extend(LAWS.iter().filter(|(law, _)| used.contains(law)).map(|(_, entry)| (*entry).into()));
    print(&entries.join("\n"))
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
