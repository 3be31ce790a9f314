//! `afmsweep shader`: the shader of a scene, as a GPU gets it.

use super::{Verbosity, load, print};
use afmsweep::kernel::Entry;
use afmsweep::plan::{Plan, Precision};
use anyhow::Context;
use std::path::PathBuf;

#[derive(clap::Args)]
#[command(
    after_help = "Example: afmsweep shader scenes/quickstart.toml --entry kicks --precision f64 > kicks.wgsl"
)]
pub struct ShaderArgs {
    /// Scene file (TOML)
    scene: PathBuf,
    /// What the shader does: steps of a run, their slopes (kicks, carry), or the corrections of a search (stride, walk)
    #[arg(long, value_name = "ENTRY", default_value = "sweep", value_parser = entry)]
    entry: Entry,
    /// Instances of the scene that have different laws or numbers of modes have different shaders: the instance
    #[arg(short, long, value_name = "N", default_value_t = 0)]
    instance: u32,
    /// f32 or f64
    #[arg(long, value_name = "PRECISION", default_value = "f32", value_parser = precision)]
    precision: Precision,
}

fn entry(word: &str) -> Result<Entry, String> {
    let names = Entry::ALL.map(Entry::name).join(", ");
    Entry::ALL.into_iter().find(|entry| entry.name() == word).ok_or(format!("expected one of {names}"))
}

fn precision(word: &str) -> Result<Precision, String> {
    let known = [Precision::F32, Precision::F64];
    known.into_iter().find(|one| one.name() == word).ok_or("expected f32 or f64".to_owned())
}

pub fn main(args: &ShaderArgs, voice: Verbosity) -> anyhow::Result<()> {
    let scene = load(&args.scene)?;
    let place = || args.scene.display().to_string();
    let plan = Plan::new(&scene, args.precision).with_context(place)?;
    anyhow::ensure!(
        (args.instance as usize) < plan.len(),
        "there is no instance {}: the scene has {}, from 0 on",
        args.instance,
        super::instances(plan.len())
    );
    let classes = plan.classes();
    let class = classes.iter().find(|class| class.instances.contains(&args.instance));
    let class = class.context("this instance never touches the sample: nothing of it is stepped")?;
    voice.say(format_args!(
        "instance {}: {} law, {} modes to begin with; where the run takes another basis, its shader has as many modes",
        args.instance, class.law, class.modes
    ));
    print(&plan.shader(class, args.entry).compose())
}
