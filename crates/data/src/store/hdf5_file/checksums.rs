//! Checksums of what a file says: written with it, compared when it is read.
//!
//! HDF5 sums its own headers, and numbers where they are chunked. Texts and the lists of chunks it does not. So the
//! root attribute `checksums` has one sum for each thing that [`Results`] holds, as `name:sum`. It speaks of contents,
//! not of bytes: a file that was repacked, or that somebody has added to, still fits it.

use super::{
    Attribute, AuditTable, Coordinate, Flags, ForceCurve, OWN_ATTRIBUTES, Results, Spectra, StateSet, States,
    Variable, Waveforms,
};
use std::collections::HashMap;
use std::fmt::Write;

/// The root attribute.
pub(super) const ATTRIBUTE: &str = "checksums";

/// What the attribute says of these results; of what has been asked for before, the sums are known.
pub(super) fn text(results: &Results, known: &HashMap<String, u64>) -> String {
    let mut text = String::new();
    for (name, sum) in all(results, known) {
        // Writing to a String cannot fail.
        let _ = write!(text, "{}{name}:{sum:016x}", if text.is_empty() { "" } else { " " });
    }
    text
}

/// The first thing that is missing or is not what was written, in words.
pub(super) fn misfit(written: &str, results: &Results) -> Option<String> {
    let now: HashMap<String, u64> = all(results, &HashMap::new()).into_iter().collect();
    for entry in written.split(' ') {
        let sum =
            entry.rsplit_once(':').and_then(|(name, sum)| Some((name, u64::from_str_radix(sum, 16).ok()?)));
        let odd = |c: char| c.is_control() || c == char::REPLACEMENT_CHARACTER;
        let Some((name, sum)) = sum.filter(|(name, _)| !name.contains(odd)) else {
            return Some(format!("its {ATTRIBUTE} are spoilt"));
        };
        let shown =
            name.strip_prefix('@').map_or_else(|| name.to_owned(), |name| format!("the attribute {name}"));
        match now.get(name) {
            None => return Some(format!("{shown} is missing")),
            Some(now) if *now != sum => return Some(format!("{shown} is not what the run wrote")),
            Some(_) => {}
        }
    }
    None
}

/// A sum for each thing; names of attributes begin with `@`.
fn all(results: &Results, known: &HashMap<String, u64>) -> Vec<(String, u64)> {
    let Results { title, axes, list, variables, .. } = results;
    let mut sums = Vec::new();
    let mut put = |name: &str, sum: Sum| sums.push((name.to_owned(), sum.0));
    put("@title", Sum::new().text(title));
    for (name, value) in &results.attributes {
        if OWN_ATTRIBUTES.contains(&name.as_str()) {
            continue;
        }
        put(
            &format!("@{name}"),
            match value {
                Attribute::Text(text) => Sum::new().text(text),
                Attribute::Number(number) => Sum::new().numbers(&[*number]),
            },
        );
    }
    for (name, text) in &results.provenance {
        put(&format!("@{name}"), Sum::new().text(text));
    }
    let all = axes.iter().flat_map(|axis| std::iter::once(axis).chain(&axis.columns));
    all.for_each(|axis| put(&axis.name, of_axis(axis)));
    let there = |name: &String| variables.iter().any(|variable| variable.name == *name);
    for (name, comment) in results.comments.iter().filter(|(name, _)| there(name)) {
        put(&format!("{name}/comment"), Sum::new().text(comment));
    }
    let names = axes.iter().fold(Sum::new().word(u64::from(*list)), |sum, axis| sum.text(&axis.name));
    put("axes", names);
    sums.extend(results.states(StateSet::First).iter().flat_map(|all| of_states("", *all, known)));
    let mut put = |name: &str, sum: Sum| sums.push((name.to_owned(), sum.0));
    if let Some(waveforms) = results.waveforms.as_ref().filter(|one| !one.instances.is_empty()) {
        put("waveforms", of_waveforms(waveforms));
    }
    if let Some(spectra) = results.spectra.as_ref().filter(|one| !one.instances.is_empty()) {
        put("spectra", of_spectra(spectra));
    }
    if !results.force_curves.is_empty() {
        put("force_curves", results.force_curves.iter().fold(Sum::new(), with_curve));
    }
    if let Some(table) = results.audit.as_ref().filter(|one| !one.instances.is_empty()) {
        of_audit(table).into_iter().for_each(|(name, sum)| put(&name, sum));
    }
    if let Some(second) = results.states(StateSet::Second) {
        let mut second_sums = of_states("other_branch/", second, known);
        // What tells whether there is a state comes first.
        let count = second.0.len();
        second_sums[..count + 2].rotate_left(count);
        sums.extend(second_sums);
    }
    sums
}

/// Of the instances' states.
fn of_states(
    before: &str,
    (variables, status, steps, flags): States,
    known: &HashMap<String, u64>,
) -> Vec<(String, u64)> {
    let mut sums = Vec::new();
    let mut put = |name: &str, sum: &dyn Fn() -> u64| {
        let name = format!("{before}{name}");
        let sum = known.get(&name).copied().unwrap_or_else(sum);
        sums.push((name, sum));
    };
    variables.iter().for_each(|one| put(&one.name, &|| of_variable(one, &one.data)));
    put("status", &|| of_codes(status));
    put("steps_per_period", &|| of_steps(steps));
    flags.iter().for_each(|one| put(&one.name, &|| of_flags(one, &one.data)));
    sums
}

fn of_axis(axis: &Coordinate) -> Sum {
    let Coordinate { name: _, units, long_name, scene_path, words, values, columns: _ } = axis;
    let named = Sum::new().text(units).text(long_name).text(scene_path).numbers(values);
    words.iter().fold(named, |sum, word| sum.text(word))
}

/// Of status codes.
pub(super) fn of_codes(codes: &[u8]) -> u64 {
    Sum::new().bytes(codes).0
}

/// Of steps per period.
pub(super) fn of_steps(all: &[u32]) -> u64 {
    Sum::new().words(all.iter().map(|steps| u64::from(*steps))).0
}

/// Of group `audit`, by name.
fn of_audit(table: &AuditTable) -> Vec<(String, Sum)> {
    let AuditTable { instances, variables, observables, errors, flags } = table;
    let instances = Sum::new().words(instances.iter().copied());
    let errors = observables.iter().fold(Sum::new().numbers(errors), |sum, one| sum.text(one));
    let mut sums = vec![("audit/instance".to_owned(), instances), ("audit/error".to_owned(), errors)];
    sums.extend(
        variables.iter().map(|one| (format!("audit/{}", one.name), Sum(of_variable(one, &one.data)))),
    );
    sums.extend(flags.iter().map(|one| (format!("audit/{}", one.name), Sum(of_flags(one, &one.data)))));
    sums
}

/// Of flags with these codes.
pub(super) fn of_flags(flags: &Flags, data: &[u8]) -> u64 {
    let Flags { long_name, meanings, bits, .. } = flags;
    let sum = Sum::new().text(long_name).word(u64::from(*bits)).bytes(data);
    meanings.iter().fold(sum, |sum, word| sum.text(word)).0
}

/// Of a variable with these numbers.
pub(super) fn of_variable(variable: &Variable, data: &[f64]) -> u64 {
    let Variable { units, long_name, harmonics, error_scale, .. } = variable;
    let sum = Sum::new().text(units).text(long_name).text(error_scale);
    sum.word(harmonics.unwrap_or(0) as u64).numbers(data).0
}

fn of_waveforms(waveforms: &Waveforms) -> Sum {
    let columns = Waveforms::COLUMNS.iter().flat_map(|column| (column.of)(waveforms));
    of_rows(&waveforms.instances, waveforms.time.iter().chain(columns))
}

fn of_spectra(spectra: &Spectra) -> Sum {
    of_rows(&spectra.instances, Spectra::COLUMNS.iter().flat_map(|column| (column.of)(spectra)))
}

fn of_rows<'a>(instances: &[u64], rows: impl Iterator<Item = &'a Vec<f64>>) -> Sum {
    rows.fold(Sum::new().words(instances.iter().copied()), |sum, row| sum.numbers(row))
}

fn with_curve(sum: Sum, curve: &ForceCurve) -> Sum {
    let ForceCurve { instance, law, branch, indentation, force, contact_radius } = curve;
    let sum = sum.word(*instance).text(law).text(branch);
    sum.numbers(indentation).numbers(force).numbers(contact_radius)
}

/// A sum of words of 64 bits that any change of one of them changes.
#[derive(Clone, Copy)]
struct Sum(u64);

impl Sum {
    fn new() -> Self {
        Self(0x9e37_79b9_7f4a_7c15)
    }

    fn word(self, word: u64) -> Self {
        // Each step can be undone, so two different words never lead to one sum from the same place.
        let mixed = (self.0 ^ word).wrapping_mul(0xff51_afd7_ed55_8ccd);
        Self((mixed ^ (mixed >> 32)).wrapping_mul(0xc4ce_b9fe_1a85_ec53).rotate_left(29))
    }

    fn words(self, words: impl Iterator<Item = u64>) -> Self {
        words.fold(self, Self::word)
    }

    fn numbers(self, numbers: &[f64]) -> Self {
        numbers.iter().fold(self.word(numbers.len() as u64), |sum, number| sum.word(number.to_bits()))
    }

    fn bytes(self, bytes: &[u8]) -> Self {
        bytes.chunks(8).fold(self.word(bytes.len() as u64), |sum, part| {
            let mut word = [0; 8];
            word[..part.len()].copy_from_slice(part);
            sum.word(u64::from_le_bytes(word))
        })
    }

    fn text(self, text: &str) -> Self {
        // As the file holds it.
        self.bytes(text.replace('\0', "\u{fffd}").as_bytes())
    }
}
