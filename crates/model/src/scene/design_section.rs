//! `[design]`: at which points of the uncertain quantities a scene is simulated; and files of samples.

use super::axes::{MOST_INSTANCES, axis};
use super::draft::Draft;
use super::sample_table::SampleTable;
use super::scene_error::{Checked, Fault, Faults, SceneError};
use super::uncertain_section::{self, CUT, Uncertain};
use super::values::{self, Key, Value};
use super::{Axis, SweptAxes, TableFile, axis_zip, table_file};
use crate::design::DesignKind::{self, LatinHypercube, MonteCarlo, Morris, Saltelli, Sobol, Table};
use crate::design::{Design, Parameter, Settings};
use std::ops::Range;
use std::path::Path;
use toml::de::DeTable;

/// Keys of `[design]`, and the kinds that each matters to.
pub(super) const KEYS: [(&str, &[DesignKind]); 11] = [
    ("kind", &ALL),
    ("samples", &[MonteCarlo, LatinHypercube, Sobol, Saltelli, Morris]),
    ("replicates", &[Sobol, Saltelli]),
    ("seed", &[MonteCarlo, LatinHypercube, Sobol, Saltelli, Morris]),
    ("correlation", &[MonteCarlo, LatinHypercube, Sobol]),
    ("groups", &[Saltelli, Morris]),
    ("scramble", &[Sobol, Saltelli]),
    ("second_order", &[Saltelli]),
    ("levels", &[Morris]),
    ("file", &[Table]),
    ("names", &[Table]),
];
const ALL: [DesignKind; 6] = [MonteCarlo, LatinHypercube, Sobol, Saltelli, Morris, Table];

/// Replicates where the scene does not say, and from how many samples on.
pub(super) const REPLICATES: usize = 16;
const FEWEST_FOR_REPLICATES: usize = 256;
/// Most levels of a grid of trajectories.
pub(super) const MOST_LEVELS: u64 = 1024;
/// Trajectories where the scene gives no levels have so many.
pub(super) const LEVELS: u64 = 4;
/// Largest rank correlation between two quantities: beyond it they are one.
const LARGEST_CORRELATION: f64 = 0.9999;

/// `[design]` while it is read.
struct Section<'a> {
    key: Range<usize>,
    table: &'a DeTable<'a>,
    kind: DesignKind,
}

/// Reads `[uncertain]` and `[design]`, if they are there, as one more axis of the sweep.
pub(super) fn read(document: &DeTable, sweep: &mut SweptAxes, draft: &mut Draft) {
    let read = sections(document, sweep, draft);
    draft.faults.take(read);
}

/// The design of a text's `[uncertain]` and `[design]`; the other sections may be anything.
///
/// # Errors
/// As of a scene; it has no such sections.
pub fn design_of(text: &str) -> Result<Design, SceneError> {
    let path = Path::new("design");
    let refuse = |faults: Faults| faults.in_file(path, text);
    let document = DeTable::parse(text).map_err(|error| {
        refuse(Fault::at(error.span().unwrap_or(0..0), error.message()).expected("TOML").into())
    })?;
    let mut draft = Draft::default();
    read(document.get_ref(), &mut SweptAxes::default(), &mut draft);
    if !draft.faults.is_empty() {
        return Err(refuse(draft.faults));
    }
    let none = || Fault::whole("there is no design").expected("[uncertain] and [design]").into();
    draft.drawn.design.map(|design| *design).ok_or_else(|| refuse(none()))
}

fn sections(document: &DeTable, sweep: &mut SweptAxes, draft: &mut Draft) -> Checked<()> {
    let (uncertain, design) = (document.get_key_value("uncertain"), document.get_key_value("design"));
    let Some((key, _)) = uncertain.or(design) else { return Ok(()) };
    if let Some((other, _)) = document.get_key_value("samples") {
        return Err(Fault::at(key.span(), "the samples are given in two ways")
            .label("a design here")
            .related(other.span(), "a list here")
            .expected("[uncertain] with [design], or [samples]")
            .help("remove one of the two"));
    }
    let Some((key, value)) = design else {
        return Err(Fault::at(key.span(), "[uncertain] has no design")
            .label("at which points is not said")
            .expected("a section [design] with kind = \"sobol\" and samples = 1024, for example")
            .help("add [design]; `afmsweep explain design.kind` lists the kinds"));
    };
    let table = values::table(value, "design", "a section [design]")?;
    let section = Section::new(key, table)?;
    match (section.kind, uncertain) {
        (Table, Some((key, _))) => Err(Fault::at(key.span(), "a table has its own quantities")
            .label("[uncertain] here")
            .related(section.key.clone(), "kind = \"table\" in [design]")
            .expected("columns of the table in place of [uncertain]")
            .help("remove [uncertain], or take another kind")),
        (Table, None) => section.listed(sweep, draft),
        (_, None) => Err(Fault::at(section.key.clone(), "[design] has nothing to draw")
            .label("no section [uncertain]")
            .expected("[uncertain] with a distribution for each quantity")
            .help("add it, or kind = \"table\" with a file of points")),
        (_, Some((key, value))) => {
            let all = uncertain_section::read(key, value, draft)?;
            // What is not known of the quantities cannot be wrong of their design.
            if draft.faults.is_empty() { section.drawn(all, sweep, draft) } else { Ok(()) }
        }
    }
}

impl<'a> Section<'a> {
    fn new(key: &Key, table: &'a DeTable<'a>) -> Checked<Self> {
        let known = KEYS.map(|(key, _)| key);
        values::no_others(table, "design", &known)?;
        let kind = table.get("kind").ok_or_else(|| {
            Fault::at(key.span(), "[design] does not say which kind")
                .label("no `kind`")
                .expected("kind = \"sobol\", for example")
                .help("add the line; `afmsweep explain design.kind` lists the kinds")
        })?;
        let kind = values::keyword(kind, "design.kind", &DesignKind::WORDS)?;
        let idle =
            |key: &&Key| KEYS.iter().any(|(name, kinds)| key.get_ref() == name && !kinds.contains(&kind));
        if let Some(key) = table.keys().find(idle) {
            return Err(idle_key(key, kind));
        }
        Ok(Self { key: key.span(), table, kind })
    }

    /// A whole number.
    fn count(&self, key: &str, least: u64, most: u64) -> Checked<Option<u64>> {
        let read = |value| values::count(value, &format!("design.{key}"), least..=most);
        self.table.get(key).map(read).transpose()
    }

    fn flag(&self, key: &str) -> Checked<Option<bool>> {
        self.table.get(key).map(|value| values::flag(value, &format!("design.{key}"))).transpose()
    }

    fn settings(&self, all: &[Uncertain]) -> Checked<Settings> {
        let samples = self.count("samples", 1, MOST_INSTANCES as u64)?.ok_or_else(|| {
            Fault::at(self.key.clone(), "[design] does not say how many samples")
                .label("no `samples`")
                .expected("samples = 1024, for example")
                .help("add the line")
        })? as usize;
        let scramble = self.flag("scramble")?.unwrap_or(true);
        let levels = self.count("levels", 2, MOST_LEVELS)?.unwrap_or(LEVELS);
        if levels % 2 == 1 {
            return Err(self
                .fault("levels", "`design.levels` is odd")
                .expected("an even number: a step is half of the levels")
                .help(format!("write {} or {}", levels - 1, levels + 1)));
        }
        Ok(Settings {
            kind: self.kind,
            samples,
            replicates: self.replicates(samples, scramble)?,
            seed: self.count("seed", 0, u64::MAX)?.unwrap_or(0),
            scramble,
            second_order: self.flag("second_order")?.unwrap_or(false),
            levels,
            groups: self.groups(all)?,
            correlation: self.correlation(all)?,
        })
    }

    /// The fault of an entry, marked there.
    fn fault(&self, key: &str, title: impl Into<String>) -> Box<Fault> {
        let place = self.table.get(key);
        let found = place.map_or_else(String::new, |value| format!("found {}", values::described(value)));
        Fault::at(place.map_or(self.key.clone(), |value| value.span()), title).label(found)
    }

    fn replicates(&self, samples: usize, scramble: bool) -> Checked<usize> {
        let usual = matches!(self.kind, Sobol | Saltelli)
            && scramble
            && samples >= FEWEST_FOR_REPLICATES
            && samples.is_multiple_of(REPLICATES);
        let asked = self.count("replicates", 1, 1024)?;
        let replicates = asked.map_or(if usual { REPLICATES } else { 1 }, |count| count as usize);
        if !scramble && replicates > 1 {
            return Err(self
                .fault("replicates", "replicates that are not scrambled are all alike")
                .expected("scramble = true, or one replicate")
                .help("remove `replicates` or `scramble`"));
        }
        if !samples.is_multiple_of(replicates) {
            return Err(self
                .fault("replicates", "the samples do not go evenly into the replicates")
                .expected(format!("a number that divides samples = {samples}"))
                .help(format!("write samples = {}", samples.div_ceil(replicates) * replicates)));
        }
        Ok(replicates)
    }

    /// Quantities named in a list, by their numbers.
    fn named(&self, value: &Value, all: &[Uncertain], what: &str) -> Checked<usize> {
        let path = values::text(value, what)?;
        all.iter().position(|one| one.parameter.path == path).ok_or_else(|| {
            let paths: Vec<&str> = all.iter().map(|one| one.parameter.path.as_str()).collect();
            values::unfit(value, format!("`{what}` names a quantity that is not uncertain"))
                .expected(format!("one of {}", paths.join(", ")))
                .help("write its path as [uncertain] has it")
        })
    }

    /// Groups of parameters; those of none are each their own.
    fn groups(&self, all: &[Uncertain]) -> Checked<Vec<Vec<usize>>> {
        const FORM: &str =
            "a list of lists of paths, such as [[\"instrument.tip.radius\", \"sample.youngs_modulus\"]]";
        let mut groups: Vec<Vec<usize>> = Vec::new();
        if let Some(value) = self.table.get("groups") {
            for group in values::list(value, "design.groups", FORM)? {
                let mut members = Vec::new();
                for entry in values::list(group, "design.groups", FORM)? {
                    let member = self.named(entry, all, "design.groups")?;
                    if members.contains(&member) || groups.iter().flatten().any(|other| *other == member) {
                        return Err(Fault::at(entry.span(), "a quantity is in two groups")
                            .label(format!("found {} again", values::described(entry)))
                            .expected("each quantity in one group at most")
                            .help("remove it from one"));
                    }
                    members.push(member);
                }
                groups.push(members);
            }
        }
        let alone: Vec<Vec<usize>> = (0..all.len())
            .filter(|n| !groups.iter().flatten().any(|member| member == n))
            .map(|n| vec![n])
            .collect();
        groups.extend(alone);
        // In the order of the quantities, as names are.
        groups.sort_by_key(|members| members.iter().copied().min());
        Ok(groups)
    }

    fn correlation(&self, all: &[Uncertain]) -> Checked<Vec<(usize, usize, f64)>> {
        const FORM: &str = "a list such as [[\"instrument.tip.radius\", \"sample.youngs_modulus\", 0.5]]";
        let mut pairs: Vec<(usize, usize, f64)> = Vec::new();
        let Some(value) = self.table.get("correlation") else { return Ok(pairs) };
        for entry in values::list(value, "design.correlation", FORM)? {
            let triple: Vec<&Value> = values::list(entry, "design.correlation", FORM)?.iter().collect();
            let [a, b, rank] = triple[..] else {
                return Err(Fault::at(entry.span(), "a correlation is of two quantities")
                    .label(format!("found {} entries", triple.len()))
                    .expected(FORM)
                    .help("write two paths and a number from -1 to 1"));
            };
            let rank = values::ratio(rank, "design.correlation", -LARGEST_CORRELATION..=LARGEST_CORRELATION)?;
            let (a, b) =
                (self.named(a, all, "design.correlation")?, self.named(b, all, "design.correlation")?);
            let known = |&(c, d, _): &(usize, usize, f64)| (c, d) == (a, b) || (c, d) == (b, a);
            if a == b || pairs.iter().any(known) {
                let title =
                    if a == b { "a quantity is not correlated with itself" } else { "a pair is there twice" };
                return Err(Fault::at(entry.span(), title)
                    .label("here")
                    .expected("each pair of two quantities once")
                    .help("remove the entry"));
            }
            pairs.push((a, b, rank));
        }
        Ok(pairs)
    }

    /// Draws the points.
    fn drawn(&self, all: Vec<Uncertain>, sweep: &mut SweptAxes, draft: &mut Draft) -> Checked<()> {
        let settings = self.settings(&all)?;
        let parameters: Vec<Parameter> = all.iter().map(|one| one.parameter.clone()).collect();
        let design = Design::new(settings, parameters).ok_or_else(|| {
            self.fault("correlation", "the correlations contradict each other")
                .expected("a matrix that quantities can have: positive definite")
                .help("bring them closer to zero; what hangs together with a third hangs together itself")
        })?;
        self.not_too_many(design.len(), sweep)?;
        let columns: Vec<Axis> =
            all.iter().zip(design.columns()).map(|(one, values)| axis(one.address, values, false)).collect();
        all.iter().zip(&columns).try_for_each(|(one, column)| possible(one, &column.values))?;
        for one in &all {
            let doubts = one.wide().into_iter().chain(one.doubt());
            draft.drawn.odd.extend(doubts.map(|line| (one.key.clone(), line)));
        }
        draft.drawn.odd.extend(self.not_a_power(&design));
        sweep.axes.push(axis_zip::samples(columns, design.len()));
        draft.drawn.design = Some(Box::new(design));
        axis_zip::check(sweep, self.key.clone(), draft)
    }

    /// A word about numbers of points that are not balanced.
    fn not_a_power(&self, design: &Design) -> Option<(Range<usize>, String)> {
        let Settings { samples, replicates, kind, .. } = design.settings;
        let each = samples / replicates;
        (matches!(kind, Sobol | Saltelli) && !each.is_power_of_two()).then(|| {
            let place = self.table.get("samples").map_or(self.key.clone(), |value| value.span());
            let better = each.next_power_of_two() * replicates;
            let line = format!(
                "design.samples = {samples} in {replicates} replicate{} is no power of two each: Sobol' points are balanced only then; {better} would be",
                if replicates == 1 { "" } else { "s" }
            );
            (place, line)
        })
    }

    fn not_too_many(&self, rows: usize, sweep: &SweptAxes) -> Checked<()> {
        let instances = rows.saturating_mul(sweep.len());
        if instances <= MOST_INSTANCES {
            return Ok(());
        }
        Err(self
            .fault("samples", "the design is too large")
            .label(format!("{instances} instances with it"))
            .expected(format!("at most {MOST_INSTANCES}"))
            .help("take fewer samples, or split the scene into several"))
    }

    /// The points of a file.
    fn listed(&self, sweep: &mut SweptAxes, draft: &mut Draft) -> Checked<()> {
        let (table, file) = self.file(draft)?;
        let SampleTable { columns, ids } = table;
        let parameters: Vec<Parameter> =
            columns.iter().map(|(address, _)| uncertain_section::parameter(*address, None)).collect();
        let rows = columns.first().map_or(0, |(_, values)| values.len());
        self.not_too_many(rows, sweep)?;
        let columns = table_file::axes(columns, self.key.clone(), draft)?;
        let mut samples = axis_zip::samples(columns, rows);
        if !ids.is_empty() {
            // Names have no unit.
            samples.units.clear();
        }
        samples.words = ids;
        sweep.axes.push(samples);
        draft.drawn.design = Some(Box::new(Design::table(rows, LEVELS, parameters)));
        draft.drawn.file = Some(file);
        axis_zip::check(sweep, self.key.clone(), draft)
    }

    fn file(&self, draft: &Draft) -> Checked<(SampleTable, TableFile)> {
        let Some(value) = self.table.get("file") else {
            return Err(Fault::at(self.key.clone(), "[design] does not say which table")
                .label("no `file`")
                .expected("file = \"points.csv\"")
                .help("add the line"));
        };
        table_file::file_of(value, self.table.get("names"), "design", draft)
    }
}

/// Refuses a drawn value that its quantity cannot have.
fn possible(one: &Uncertain, values: &[f64]) -> Checked<()> {
    let (address, domain) = (one.address, one.address.quantity.domain);
    if let Some((row, value)) = values.iter().enumerate().find(|(_, value)| !domain.holds(**value)) {
        let path = &one.parameter.path;
        return Err(Fault::at(one.key.clone(), format!("`{path}` is drawn with an impossible value"))
            .label(format!(
                "row {row} has {}; the probability of such values is {:.1e}",
                address.shown(*value),
                one.impossible()
            ))
            .expected(domain.described())
            .help(one.wide().unwrap_or_else(|| format!("{CUT}, or take a lognormal one"))));
    }
    let of = |fold: fn(f64, f64) -> f64, start: f64| values.iter().copied().fold(start, fold);
    for value in [of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY)] {
        values::in_domain(value, one.key.clone(), || address.shown(value), address, &one.parameter.path)?;
    }
    Ok(())
}

/// The fault of a key that this kind has no use for.
fn idle_key(key: &Key, kind: DesignKind) -> Box<Fault> {
    let name = key.get_ref().as_ref();
    let own: Vec<&str> =
        KEYS.iter().filter(|(_, kinds)| kinds.contains(&kind)).map(|(name, _)| *name).collect();
    let kinds = KEYS.iter().find(|(one, _)| *one == name).map_or(&[][..], |(_, kinds)| *kinds);
    let others: Vec<String> = kinds.iter().map(|kind| format!("\"{}\"", kind.word())).collect();
    let help = match name {
        "correlation" => {
            "indices of correlated quantities mean nothing by themselves: put them in one group, groups = [[...]]"
                .to_owned()
        }
        _ => format!("remove it, or write kind = {}", others.join(" or ")),
    };
    Fault::at(key.span(), format!("`design.{name}` has no effect on a design of kind \"{}\"", kind.word()))
        .label(format!("a key of {}", others.join(", ")))
        .expected(format!("one of {}", own.join(", ")))
        .help(help)
}
