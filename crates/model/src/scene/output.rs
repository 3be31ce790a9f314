//! `[run]` and `[output]`.

use super::STEPPED_MODES;
use super::axes;
use super::draft::Draft;
use super::params::LeverSpec;
use super::scene_error::{Checked, Fault, Faults};
use super::synonyms;
use super::values::{self, Value};
use super::{Output, Run, Start, Steady, WaveformRequest};
use crate::observe::Observable;
use crate::suggestion::nearest;
use toml::de::DeTable;

/// Keywords of `run.start`.
pub(super) const STARTS: [(&str, Start); 2] = [("steady", Start::Steady), ("rest", Start::Rest)];
/// Keywords of `run.steady`.
pub(super) const WAYS: [(&str, Steady); 2] = [("wait", Steady::Wait), ("search", Steady::Search)];

/// Keywords of `run.branches`: whether both.
pub(super) const BRANCHES: [(&str, bool); 2] = [("one", false), ("both", true)];

/// The keys of `[run]`.
pub(super) const KEYS: [&str; 8] =
    ["start", "steady", "branches", "periods", "measure", "accuracy", "modes", "steps_per_period"];
/// The keys of `[output]`, of its `waveforms` and of its `spectra`.
pub(super) const OUTPUT_KEYS: [&str; 3] = ["observables", "waveforms", "spectra"];
pub(super) const WAVEFORM_KEYS: [&str; 3] = ["instances", "samples_per_period", "periods"];
pub(super) const SPECTRUM_KEYS: [&str; 1] = ["instances"];
/// What stands for the list of all instances.
pub(super) const ALL: &str = "all";

const OBSERVABLES: &str = "output.observables";

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
/// Most spectra: up to 57 kilobytes each in the file.
const MOST_SPECTRA: usize = 10_000;

/// The table of a section; keys that it does not have are mistakes.
fn known<'a, 'i>(
    value: &'a Value<'i>,
    section: &str,
    keys: &[&str],
    faults: &mut Faults,
) -> Option<&'a DeTable<'i>> {
    let table = faults.take(values::table(value, section, &format!("a section [{section}]")))?;
    for key in table.keys().filter(|key| !keys.contains(&key.get_ref().as_ref())) {
        faults.push(*values::unknown_key(key, section, keys));
    }
    Some(table)
}

/// Reads `[run]`; `usual` is how a periodic state is come by where it does not say.
pub(super) fn run(section: Option<&Value>, usual: Steady, draft: &mut Draft) -> Run {
    let mut run = Run {
        start: Start::Steady,
        steady: usual,
        both_branches: false,
        periods: 300,
        measure: 50,
        accuracy: 1e-3,
        modes: None,
        steps_per_period: None,
    };
    let faults = &mut draft.faults;
    let Some(table) = section.and_then(|section| known(section, "run", &KEYS, faults)) else {
        return run;
    };
    faults.take(way_to_steady(table, &mut run));
    faults.take(length(table, &mut run));
    if let Some(value) = table.get("accuracy")
        && let Some(accuracy) = faults.take(values::ratio(value, "run.accuracy", 1e-9..=0.5))
    {
        run.accuracy = accuracy;
    }
    if let Some(value) = table.get("modes") {
        let most = match &draft.params.instrument.cantilever.lever {
            LeverSpec::Modes(modes) => modes.len().min(STEPPED_MODES),
            _ => STEPPED_MODES,
        };
        let modes = faults.take(values::count(value, "run.modes", 1..=most as u64));
        run.modes = modes.map(|modes| modes as usize);
    }
    run
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

/// Reads `[output]` of a scene with so many instances; a mistake may leave their number unknown.
pub(super) fn output(
    section: Option<&Value>,
    run: &Run,
    instances: Option<usize>,
    faults: &mut Faults,
) -> Output {
    let mut output = Output { observables: USUAL.to_vec(), waveforms: None, spectra: None };
    let table = section.and_then(|section| known(section, "output", &OUTPUT_KEYS, faults));
    let Some(table) = table else { return output };
    if let Some(value) = table.get("observables") {
        output.observables = observables(value, faults);
    }
    if let Some(value) = table.get("waveforms") {
        let read = waveforms(value, run, instances, faults);
        output.waveforms = faults.take(read).flatten();
    }
    if let Some(value) = table.get("spectra") {
        let read = spectra(value, run, instances, faults);
        output.spectra = faults.take(read).flatten();
    }
    output
}

fn observables(value: &Value, faults: &mut Faults) -> Vec<Observable> {
    let list = values::list(value, OBSERVABLES, "a list such as [\"amplitude\", \"phase\"]");
    let mut found = Vec::new();
    for entry in faults.take(list).into_iter().flatten() {
        if let Some(observable) = faults.take(observable(entry, &found)) {
            found.push(observable);
        }
    }
    found
}

fn observable(entry: &Value, found: &[Observable]) -> Checked<Observable> {
    const PATH: &str = OBSERVABLES;
    let name = values::text(entry, PATH)?;
    let Some(observable) = Observable::from_name(name) else {
        let names: Vec<_> = Observable::all().map(Observable::name).collect();
        return Err(values::unfit(entry, format!("`{PATH}` has an unknown observable"))
            .expected(format!("one of {}", names.join(", ")))
            .help("put one of these names")
            .maybe_help(nearest(name, names.iter().copied()).map(|name| format!("did you mean \"{name}\"?")))
            .maybe_help(synonyms::help(name, names.iter().copied())));
    };
    if found.contains(&observable) {
        return Err(Fault::at(entry.span(), format!("`{PATH}` asks twice for \"{name}\""))
            .label("found again here")
            .expected("each observable once")
            .help("remove one of the two"));
    }
    Ok(observable)
}

/// None where a key is not known, which is told already.
fn waveforms(
    value: &Value,
    run: &Run,
    instances: Option<usize>,
    faults: &mut Faults,
) -> Checked<Option<WaveformRequest>> {
    const PATH: &str = "output.waveforms";
    const FORM: &str = "{ instances = [0, 100], samples_per_period = 256, periods = 4 }";
    let Some(table) = with_instances(value, (PATH, FORM), &WAVEFORM_KEYS, faults)? else { return Ok(None) };
    let mut request = WaveformRequest {
        instances: listed(table, (PATH, MOST_SAMPLES as usize), instances)?,
        samples_per_period: 256,
        periods: run.periods.min(4),
    };
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
    Ok(Some(request))
}

/// None where a key is not known, which is told already.
fn spectra(
    value: &Value,
    run: &Run,
    instances: Option<usize>,
    faults: &mut Faults,
) -> Checked<Option<Vec<usize>>> {
    const PATH: &str = "output.spectra";
    const FORM: &str = "{ instances = [0, 100] }";
    let Some(table) = with_instances(value, (PATH, FORM), &SPECTRUM_KEYS, faults)? else { return Ok(None) };
    if run.start == Start::Rest {
        return Err(Fault::at(value.span(), "a start from rest has no spectra")
            .label("its motion is not periodic")
            .expected("start = \"steady\" with spectra")
            .help("remove one of the two lines; waveforms show a start from rest"));
    }
    listed(table, (PATH, MOST_SPECTRA), instances).map(Some)
}

/// The table of such a form, which has `instances`; none where a key is not known, which is told already.
fn with_instances<'a, 'i>(
    value: &'a Value<'i>,
    (path, form): (&str, &str),
    keys: &[&str],
    faults: &mut Faults,
) -> Checked<Option<&'a DeTable<'i>>> {
    values::table(value, path, form)?;
    let Some(table) = known(value, path, keys, faults) else { return Ok(None) };
    if table.get("instances").is_none() {
        return Err(Fault::at(value.span(), format!("`{path}` lacks `instances`"))
            .label("found no `instances`")
            .expected(form)
            .help("add the numbers of the instances to keep, or instances = \"all\""));
    }
    Ok(Some(table))
}

/// The instances that a table lists, `most` of them, or all of the scene's.
fn listed(table: &DeTable, (path, most): (&str, usize), instances: Option<usize>) -> Checked<Vec<usize>> {
    let Some(list) = table.get("instances") else { return Ok(Vec::new()) };
    let path = format!("{path}.instances");
    let all = list.get_ref().as_str() == Some(ALL);
    let entries = match all {
        true => None,
        false => Some(values::list(list, &path, "a list such as [0, 100], or \"all\"")?),
    };
    let count = entries.map_or(instances.unwrap_or(0), |entries| entries.len());
    if count > most {
        return Err(Fault::at(list.span(), format!("`{path}` has too many instances"))
            .label(format!("found {count}"))
            .expected(format!("at most {most}"))
            .help("list fewer of them"));
    }
    let Some(entries) = entries else { return Ok((0..count).collect()) };
    let last = instances.unwrap_or(axes::MOST_INSTANCES).saturating_sub(1) as u64;
    let mut found = Vec::new();
    let mut seen = std::collections::HashSet::new();
    for entry in entries {
        let instance = values::count(entry, &path, 0..=last).map_err(|fault| {
            fault.help(format!("the scene's last instance is number {last}, counted from 0"))
        })?;
        if !seen.insert(instance) {
            return Err(Fault::at(entry.span(), format!("`{path}` repeats an instance"))
                .label("found again here")
                .expected("each instance once")
                .help("remove one of the two"));
        }
        found.push(instance as usize);
    }
    Ok(found)
}
