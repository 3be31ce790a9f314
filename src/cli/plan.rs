//! `afmsweep plan`: what a run would do.

use super::backend::{EngineArgs, say_choice};
use super::table::TableArgs;
use super::{SceneArgs, Verbosity, instances, plan_notice, print, print_json};
use afmsweep::engine::estimate;
use afmsweep::sweep::{EngineChoice, Forecast};
use afmsweep::{Observer, Sweep};
use serde_json::Value;

#[derive(clap::Args)]
#[command(after_help = "Examples: afmsweep plan lever.toml\n          afmsweep plan lever.toml --json")]
pub struct PlanArgs {
    #[command(flatten)]
    scene: SceneArgs,
    #[command(flatten)]
    table: TableArgs,
    #[command(flatten)]
    engine: EngineArgs,
}

pub fn main(args: &PlanArgs, voice: Verbosity) -> anyhow::Result<()> {
    let sweep = args.engine.sweep(args.table.load(&args.scene.scene)?)?;
    plan_notice::announce(sweep.scene(), voice);
    if args.scene.json {
        return print_json(&answer(&sweep, true)?);
    }
    let (plan, engine) = sweep.plan(&PlanObserver(voice))?;
    let scene = sweep.scene();
    let summary = plan.summary(Some(estimate(&plan, engine.as_ref())?));
    let mut warnings = scene.warnings();
    warnings.extend(plan.doubts());
    let mut text = told(&sweep.forecast()?);
    text += &summary.to_string();
    for line in scene.preset_line().into_iter().chain(warnings.iter().map(|line| format!("warning: {line}")))
    {
        text += &line;
        text.push('\n');
    }
    print(&text)
}

/// What a run would do; with `forecast` some instances are run, for the time of all.
///
/// # Errors
/// Those of a plan.
pub fn answer(sweep: &Sweep, forecast: bool) -> anyhow::Result<Value> {
    let (plan, engine) = sweep.plan(&PlanObserver(Verbosity { quiet: true, verbose: false }))?;
    let scene = sweep.scene();
    let mut answer = plan.summary(Some(estimate(&plan, engine.as_ref())?)).json().clone();
    let mut warnings = scene.warnings();
    warnings.extend(plan.doubts());
    answer["from_preset"] = scene.from_preset().into_iter().map(|(path, _)| path).collect();
    answer["warnings"] = warnings.into();
    if forecast {
        answer["expected_time_s"] = sweep.forecast()?.expected.into();
    }
    Ok(answer)
}

/// The time that a run takes, by those of its instances that were run.
fn told(forecast: &Forecast) -> String {
    let Forecast { tried, seconds, expected } = *forecast;
    match expected {
        Some(expected) => format!(
            "expected time {} on this machine: {} were run in {seconds:.2} s\n",
            rounded(expected),
            instances(tried)
        ),
        None => format!(
            "no expected time: trials of a few instances took more than {seconds:.0} s and were stopped\n"
        ),
    }
}

/// A time that is good to a figure or two.
fn rounded(seconds: f64) -> String {
    match seconds {
        0.0..10.0 => format!("{seconds:.1} s"),
        10.0..600.0 => format!("{seconds:.0} s"),
        600.0..36_000.0 => format!("{:.0} min", seconds / 60.0),
        _ => format!("{:.0} h", seconds / 3600.0),
    }
}

/// Says which engine would run.
struct PlanObserver(Verbosity);

impl Observer for PlanObserver {
    fn chosen(&self, choice: &EngineChoice) {
        // Nothing runs: which engine would is told to those who ask, what more there is to all.
        if self.0.verbose || matches!(choice, EngineChoice::OneOf(_) | EngineChoice::Without(_)) {
            say_choice(choice, self.0);
        }
    }
}
