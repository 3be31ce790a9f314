//! `[run]` and `[output]`.

use super::STEPPED_MODES;
use super::error::{Checked, Fault};
use super::params::Lever;
use super::read::Draft;
use super::values::{self, Value};
use super::{Output, Run, Start, Steady, WaveformRequest};
use crate::observe::Observable;
use crate::suggest::nearest;
use toml::de::DeTable;

/// Keywords of `run.start`.
pub(super) const STARTS: [(&str, Start); 2] = [("steady", Start::Steady), ("rest", Start::Rest)];
/// Keywords of `run.steady`.
pub(super) const WAYS: [(&str, Steady); 2] = [("wait", Steady::Wait), ("search", Steady::Search)];

/// Keywords of `run.branches`: whether both.
pub(super) const BRANCHES: [(&str, bool); 2] = [("one", false), ("both", true)];

/// What `[output]` asks for when it says nothing.
const USUAL: [Observable; 7] = [
    Observable::Amplitude,
    Observable::Phase,
    Observable::ForceMax,
    Observable::ForceMin,
    Observable::IndentationMax,
    Observable::ContactTime,
    Observable::Dissipation,
];

/// Most steps of one instance, far beyond any settling time: a typing error is likelier.
const MOST_STEPS: u64 = 1_000_000_000;
/// What a period counts for where the scene leaves the steps to the plan: the fewest it takes.
const LIKELY_STEPS: u64 = 64;
const MOST_SAMPLES_PER_PERIOD: u64 = 65_536;
/// Most samples of all waveforms together: 32 bytes each in the file, and five times that in memory.
const MOST_SAMPLES: u64 = 10_000_000;

/// Refuses keys that a section does not have.
fn known<'a, 'i>(
    value: Option<&'a Value<'i>>,
    section: &str,
    keys: &[&str],
) -> Checked<Option<&'a DeTable<'i>>> {
    let Some(value) = value else {
        return Ok(None);
    };
    let table = values::table(value, section, &format!("a section [{section}]"))?;
    match table.keys().find(|key| !keys.contains(&key.get_ref().as_ref())) {
        Some(key) => Err(values::unknown_key(key, section, keys)),
        None => Ok(Some(table)),
    }
}

/// Reads `[run]`.
pub(super) fn run(section: Option<&Value>, draft: &Draft) -> Checked<Run> {
    const KEYS: [&str; 8] =
        ["start", "steady", "branches", "periods", "measure", "accuracy", "modes", "steps_per_period"];
    let mut run = Run {
        start: Start::Steady,
        steady: Steady::Wait,
        both_branches: false,
        periods: 300,
        measure: 50,
        accuracy: 1e-3,
        modes: None,
        steps_per_period: None,
    };
    let Some(table) = known(section, "run", &KEYS)? else {
        return Ok(run);
    };
    way_to_steady(table, &mut run)?;
    length(table, &mut run)?;
    if let Some(value) = table.get("accuracy") {
        run.accuracy = values::ratio(value, "run.accuracy", 1e-9..=0.5)?;
    }
    if let Some(value) = table.get("modes") {
        let most = match &draft.params.instrument.cantilever.lever {
            Lever::Modes(modes) => modes.len().min(STEPPED_MODES),
            _ => STEPPED_MODES,
        };
        run.modes = Some(values::count(value, "run.modes", 1..=most as u64)? as usize);
    }
    Ok(run)
}

/// Reads where runs start, and how they come to which periodic states.
fn way_to_steady(table: &DeTable, run: &mut Run) -> Checked<()> {
    if let Some(value) = table.get("start") {
        run.start = values::keyword(value, "run.start", &STARTS)?;
    }
    if let Some(value) = table.get("steady") {
        run.steady = values::keyword(value, "run.steady", &WAYS)?;
        if (run.start, run.steady) == (Start::Rest, Steady::Search) {
            return Err(Fault::at(value.span(), "a start from rest has no periodic state to search for")
                .label("the search begins at the free oscillation")
                .expected("start = \"steady\" with steady = \"search\"")
                .help("remove one of the two lines"));
        }
    }
    if let Some(value) = table.get("branches") {
        run.both_branches = values::keyword(value, "run.branches", &BRANCHES)?;
        if run.both_branches && run.steady != Steady::Search {
            return Err(Fault::at(value.span(), "only a search looks for two branches")
                .label("waiting ends on one of them")
                .expected("steady = \"search\" with branches = \"both\"")
                .help("add steady = \"search\", or remove this line"));
        }
    }
    Ok(())
}

/// Reads how many steps a period has, and how many periods are run and measured.
fn length(table: &DeTable, run: &mut Run) -> Checked<()> {
    if let Some(value) = table.get("steps_per_period") {
        run.steps_per_period = Some(values::count(value, "run.steps_per_period", 16..=1_000_000)? as u32);
    }
    if let Some(value) = table.get("periods") {
        run.periods = values::count(value, "run.periods", 1..=u64::from(u32::MAX))? as u32;
    }
    let steps = run.steps_per_period.map_or(LIKELY_STEPS, u64::from);
    if u64::from(run.periods) * steps > MOST_STEPS {
        // Whichever was written last made it too long; `periods` is there unless the default times the steps is.
        let value = table.get("periods").or_else(|| table.get("steps_per_period"));
        return Err(Fault::at(value.map_or(0..0, |value| value.span()), "the run is too long")
            .label(format!("found {} periods of {steps} steps or more", run.periods))
            .expected(format!("at most {MOST_STEPS} steps for an instance"))
            .help(format!("periods = {} would do", MOST_STEPS / steps)));
    }
    run.measure = run.measure.min(run.periods);
    if let Some(value) = table.get("measure") {
        run.measure = values::count(value, "run.measure", 1..=u64::from(run.periods)).map_err(|fault| {
            fault.help(format!("measure at most the {} periods of the run, or raise periods", run.periods))
        })? as u32;
    }
    Ok(())
}

/// Reads `[output]`.
pub(super) fn output(section: Option<&Value>, run: &Run, instances: usize) -> Checked<Output> {
    let mut output = Output { observables: USUAL.to_vec(), waveforms: None };
    let Some(table) = known(section, "output", &["observables", "waveforms"])? else {
        return Ok(output);
    };
    if let Some(value) = table.get("observables") {
        output.observables = observables(value)?;
    }
    if let Some(value) = table.get("waveforms") {
        output.waveforms = Some(waveforms(value, run, instances)?);
    }
    Ok(output)
}

fn observables(value: &Value) -> Checked<Vec<Observable>> {
    const PATH: &str = "output.observables";
    let mut found = Vec::new();
    for entry in values::list(value, PATH, "a list such as [\"amplitude\", \"phase\"]")? {
        let name = values::text(entry, PATH)?;
        let Some(observable) = Observable::from_name(name) else {
            let names: Vec<_> = Observable::all().map(Observable::name).collect();
            return Err(Fault::at(entry.span(), format!("`{PATH}` has an unknown observable"))
                .label(format!("found {}", values::described(entry)))
                .expected(format!("one of {}", names.join(", ")))
                .help("put one of these names")
                .maybe_help(
                    nearest(name, names.iter().copied()).map(|name| format!("did you mean \"{name}\"?")),
                ));
        };
        if found.contains(&observable) {
            return Err(Fault::at(entry.span(), format!("`{PATH}` asks twice for \"{name}\""))
                .label("found again here")
                .expected("each observable once")
                .help("remove one of the two"));
        }
        found.push(observable);
    }
    Ok(found)
}

fn waveforms(value: &Value, run: &Run, instances: usize) -> Checked<WaveformRequest> {
    const PATH: &str = "output.waveforms";
    const FORM: &str = "{ instances = [0, 100], samples_per_period = 64, periods = 4 }";
    values::table(value, PATH, FORM)?;
    let table = known(Some(value), PATH, &["instances", "samples_per_period", "periods"])?;
    let Some((table, list)) = table.and_then(|table| Some((table, table.get("instances")?))) else {
        return Err(Fault::at(value.span(), format!("`{PATH}` lacks `instances`"))
            .label("found no `instances`")
            .expected(FORM)
            .help("add the numbers of the instances to keep"));
    };
    let mut request =
        WaveformRequest { instances: Vec::new(), samples_per_period: 64, periods: run.periods.min(4) };
    let mut seen = std::collections::HashSet::new();
    for entry in values::list(list, "output.waveforms.instances", "a list such as [0, 100]")? {
        let last = instances.saturating_sub(1) as u64;
        let instance = values::count(entry, "output.waveforms.instances", 0..=last).map_err(|fault| {
            fault.help(format!("the scene's last instance is number {last}, counted from 0"))
        })?;
        if !seen.insert(instance) {
            return Err(Fault::at(entry.span(), "`output.waveforms.instances` repeats an instance")
                .label("found again here")
                .expected("each instance once")
                .help("remove one of the two"));
        }
        request.instances.push(instance as usize);
    }
    if let Some(value) = table.get("samples_per_period") {
        request.samples_per_period =
            values::count(value, "output.waveforms.samples_per_period", 2..=MOST_SAMPLES_PER_PERIOD)? as u32;
    }
    if let Some(value) = table.get("periods") {
        request.periods = values::count(value, "output.waveforms.periods", 1..=u64::from(run.periods))
            .map_err(|fault| {
                fault
                    .help(format!("the run has {} periods: ask for fewer, or raise run.periods", run.periods))
            })? as u32;
    }
    let samples =
        request.instances.len() as u64 * u64::from(request.samples_per_period) * u64::from(request.periods);
    if samples > MOST_SAMPLES {
        return Err(Fault::at(value.span(), format!("`{PATH}` asks for too many samples"))
            .label(format!("found {samples} in all"))
            .expected(format!("at most {MOST_SAMPLES}: instances times samples_per_period times periods"))
            .help("ask for fewer instances, periods or samples per period"));
    }
    Ok(request)
}
