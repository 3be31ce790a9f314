//! The scene with every value written out; reading it again gives the same scene.

use super::address::Address;
use super::axes;
use super::axis_zip::SAMPLES;
use super::draft::keys_of;
use super::params::PRESET;
use super::params::*;
use super::quantities::QUANTITIES;
use super::scene_reader::{BRANCHES_HELD, DRIVE_ON, MODELS, SETPOINTS_OF, VISCOUS};
use super::{Axis, Drawn, Layout, Scene, TableFile, curve_section, output, outside_section};
use crate::design::{Design, DesignKind, Distribution, Parameter};
use crate::units::{Dimension, format as written};
use std::fmt::Write;

impl Scene {
    /// Every value the scene uses, as a scene file: [`Scene::parse`] of it gives the same base case,
    /// sweep, run and output, to the bit.
    pub fn resolved_toml(&self) -> String {
        let mut text = String::new();
        // Writing into a String cannot fail.
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, text: &mut String) -> std::fmt::Result {
        let base = &self.base;
        writeln!(text, "title = {}", quoted(&self.title))?;
        writeln!(
            text,
            "\n[instrument]\npreset = {}",
            quoted(self.lever.map_or(PRESET, |lever| lever.preset))
        )?;
        writeln!(text, "\n[instrument.actuator]\nmodel = {}", word(&MODELS, base.instrument.actuator.model))?;
        self.write_section(text, "instrument.actuator")?;
        writeln!(text, "\n[instrument.cantilever]")?;
        self.write_section(text, "instrument.cantilever")?;
        self.write_modes(text)?;
        writeln!(text, "\n[instrument.tip]")?;
        if base.instrument.tip.shape != TipShape::default() {
            writeln!(text, "shape = {}", word(TipShape::WORDS, base.instrument.tip.shape))?;
        }
        self.write_section(text, "instrument.tip")?;
        writeln!(text, "\n[sample]")?;
        self.write_section(text, "sample")?;
        if base.sample.thickness.is_some() || !base.sample.bonded {
            writeln!(text, "bonded = {}", base.sample.bonded)?;
        }
        writeln!(text, "\n[contact]\nlaw = {}", word(LawChoice::WORDS, base.contact.law))?;
        if !matches!(base.sample.viscosity, Viscosity::None | Viscosity::Relaxing { .. }) {
            let model = word(&VISCOUS, base.contact.viscosity_model);
            writeln!(text, "viscosity_model = {model}")?;
        }
        self.write_section(text, "contact")?;
        self.write_outside(text)?;
        writeln!(text, "\n[drive]\non = {}", word(&DRIVE_ON, base.drive.on))?;
        if base.drive.frequency == DriveFrequency::Resonance {
            writeln!(text, "frequency = \"resonance\"")?;
        }
        self.write_section(text, "drive")?;
        writeln!(text, "\n[approach]")?;
        self.write_section(text, "approach")?;
        if base.approach.of != SetPointOf::default() {
            writeln!(text, "setpoint_of = {}", word(&SETPOINTS_OF, base.approach.of))?;
        }
        if let Some(branch) = base.approach.branch {
            writeln!(text, "setpoint_branch = {}", word(&BRANCHES_HELD, branch))?;
        }
        self.write_sweep(text)?;
        self.write_run(text)?;
        self.write_output(text)
    }

    fn write_section(&self, text: &mut String, section: &str) -> std::fmt::Result {
        let sized = matches!(self.base.instrument.cantilever.lever, LeverSpec::Dimensions { .. });
        let listed = matches!(self.base.instrument.cantilever.lever, LeverSpec::Modes(_));
        for key in keys_of(section) {
            let path = format!("{section}.{key}");
            // What a calibrated or listed lever already contains must not be said again.
            let contained = (!sized
                && section == "instrument.tip"
                && (["half_length", "width", "height", "density"].contains(&key)
                    || (listed && key == "mass")))
                || (listed && path == "instrument.cantilever.quality_factor");
            if let Some(address) = Address::find(&path).filter(|_| !contained)
                && let Some(value) = address.get(&self.base)
            {
                writeln!(text, "{key} = {}", address.written(value))?;
            }
        }
        if section == "instrument.cantilever"
            && let QualityFactor::PerMode(values) = &self.base.instrument.cantilever.quality_factor
        {
            let values = list(values.iter().map(|q| written(*q, Dimension::Dimensionless)));
            writeln!(text, "quality_factor = {values}")?;
        }
        Ok(())
    }

    fn write_modes(&self, text: &mut String) -> std::fmt::Result {
        let LeverSpec::Modes(modes) = &self.base.instrument.cantilever.lever else {
            return Ok(());
        };
        writeln!(text, "modes = [")?;
        for index in 0..modes.len() {
            let entries: Vec<String> = QUANTITIES
                .iter()
                .filter_map(|quantity| {
                    let key = quantity.path.strip_prefix("instrument.cantilever.modes.#.")?;
                    let address = Address { quantity, index };
                    Some(format!("{key} = {}", address.written(address.get(&self.base)?)))
                })
                .collect();
            writeln!(text, "    {{ {} }},", entries.join(", "))?;
        }
        writeln!(text, "]")
    }

    fn write_outside(&self, text: &mut String) -> std::fmt::Result {
        let contact = &self.base.contact;
        if let Some(table) = &contact.table {
            writeln!(text, "{}", outside_section::written(table))?;
        }
        for (index, force) in contact.outside.iter().enumerate() {
            writeln!(text, "\n[[contact.outside]]\nforce = {}", quoted(force.word()))?;
            if let OutsideForce::Capillary { model, .. } = force {
                writeln!(text, "model = {}", word(&NeckModel::WORDS, *model))?;
            }
            for key in outside_section::keys(force).0 {
                if let Some(address) = Address::find(&format!("contact.outside.{index}.{key}"))
                    && let Some(value) = address.get(&self.base)
                {
                    writeln!(text, "{key} = {}", address.written(value))?;
                }
            }
        }
        Ok(())
    }

    fn write_sweep(&self, text: &mut String) -> std::fmt::Result {
        if self.sweep.axes.is_empty() {
            return Ok(());
        }
        let curve = usize::from(self.sweep.curve.is_some());
        let (swept, curve) = self.sweep.axes.split_at(self.sweep.axes.len() - curve);
        let (samples, swept): (Vec<&Axis>, Vec<&Axis>) = swept
            .iter()
            .filter(|axis| !axis.path.starts_with("curve."))
            .partition(|axis| axis.path == SAMPLES);
        let mut swept = swept.into_iter().peekable();
        // Rows of a list that stands in a file are not repeated.
        let filed = self.sweep.layout == Layout::List && (self.drawn.file.is_some() || self.drawn.arrays);
        if swept.peek().is_some() && !filed {
            writeln!(text, "\n[{}]", if self.sweep.layout == Layout::Grid { "sweep" } else { "samples" })?;
        }
        for axis in swept.filter(|_| !filed) {
            writeln!(text, "{}", written_axis(axis, self.sweep.layout))?;
        }
        if self.drawn.arrays {
            text.push_str("\n# samples: arrays of the caller\n");
        } else if self.drawn.design.is_some() || self.drawn.file.is_some() {
            text.push_str(&written_samples(&self.drawn));
        }
        for axis in samples.into_iter().filter(|_| self.drawn == Drawn::default()) {
            writeln!(text, "\n[samples]")?;
            axis.columns
                .iter()
                .try_for_each(|column| writeln!(text, "{}", written_axis(column, Layout::List)))?;
        }
        for axis in curve {
            let Some(address) = Address::find(&axis.path) else { continue };
            let both = self.sweep.curve.is_some_and(|curve| curve.both);
            writeln!(text, "\n[curve]\nquantity = {}", quoted(&axis.path))?;
            writeln!(text, "{}", grid_axis(axis, address, "\n"))?;
            writeln!(text, "direction = {}", word(&curve_section::DIRECTIONS, both))?;
        }
        Ok(())
    }

    fn write_run(&self, text: &mut String) -> std::fmt::Result {
        let run = &self.run;
        writeln!(text, "\n[run]\nstart = {}", word(&output::STARTS, run.start))?;
        writeln!(text, "steady = {}", word(&output::WAYS, run.steady))?;
        writeln!(text, "branches = {}", word(&output::BRANCHES, run.both_branches))?;
        writeln!(
            text,
            "periods = {}\nmeasure = {}\naccuracy = {:?}",
            run.periods, run.measure, run.accuracy
        )?;
        if let Some(modes) = run.modes {
            writeln!(text, "modes = {modes}")?;
        }
        if let Some(steps) = run.steps_per_period {
            writeln!(text, "steps_per_period = {steps}")?;
        }
        Ok(())
    }

    fn write_output(&self, text: &mut String) -> std::fmt::Result {
        let names = list(self.output.observables.iter().map(|o| quoted(o.name())));
        writeln!(text, "\n[output]\nobservables = {names}")?;
        if let Some(waveforms) = &self.output.waveforms {
            let (samples, periods) = (waveforms.samples_per_period, waveforms.periods);
            let instances = self.written_instances(&waveforms.instances);
            writeln!(
                text,
                "waveforms = {{ instances = {instances}, samples_per_period = {samples}, periods = {periods} }}"
            )?;
        }
        if let Some(instances) = &self.output.spectra {
            writeln!(text, "spectra = {{ instances = {} }}", self.written_instances(instances))?;
        }
        Ok(())
    }

    /// Several that are all there are have a word of their own.
    fn written_instances(&self, instances: &[usize]) -> String {
        if instances.len() > 1 && instances.iter().copied().eq(0..self.sweep.len()) {
            return quoted(output::ALL);
        }
        list(instances.iter().map(usize::to_string))
    }
}

/// An axis as its section has it.
fn written_axis(axis: &Axis, layout: Layout) -> String {
    if !axis.columns.is_empty() {
        let column = |column: &Axis| format!("{} = {}", quoted(&column.path), entries(column));
        let columns: Vec<String> = axis.columns.iter().map(column).collect();
        return format!("{} = {{ label = {}, {} }}", axis.name, entries(axis), columns.join(", "));
    }
    let values = match (Address::find(&axis.path), layout) {
        (Some(address), Layout::Grid) => format!("{{ {} }}", grid_axis(axis, address, ", ")),
        (None, Layout::Grid) => format!("{{ values = {} }}", entries(axis)),
        (_, Layout::List) => entries(axis),
    };
    format!("{} = {values}", quoted(&axis.path))
}

/// The list of an axis' values, or of the words that stand for them.
fn entries(axis: &Axis) -> String {
    match Address::find(&axis.path) {
        Some(address) => value_list(axis, address),
        None => list(axis.words.iter().map(|word| quoted(word))),
    }
}

/// From, to and points where these give the very same values; the list of values otherwise.
fn grid_axis(axis: &Axis, address: Address, between: &str) -> String {
    if let (true, Some(&from), Some(&to)) =
        (axis.values.len() > 3 || axis.log, axis.values.first(), axis.values.last())
        && from.is_finite()
        && to.is_finite()
        && axes::spaced(from, to, axis.values.len(), axis.log) == *axis.values
    {
        let scale = if axis.log { "log" } else { "lin" };
        return [
            format!("from = {}", address.written(from)),
            format!("to = {}", address.written(to)),
            format!("points = {}", axis.values.len()),
            format!("scale = \"{scale}\""),
        ]
        .join(between);
    }
    format!("values = {}", value_list(axis, address))
}

fn value_list(axis: &Axis, address: Address) -> String {
    list(axis.values.iter().map(|value| address.written(*value)))
}

/// A list as TOML has it.
fn list(entries: impl Iterator<Item = String>) -> String {
    format!("[{}]", entries.collect::<Vec<_>>().join(", "))
}

/// The keyword of a choice, quoted.
fn word<T: PartialEq>(words: &[(&str, T)], meaning: T) -> String {
    words.iter().find(|(_, other)| *other == meaning).map_or_else(String::new, |(word, _)| quoted(word))
}

/// The sections that say where the samples come from.
fn written_samples(drawn: &Drawn) -> String {
    match (&drawn.design, &drawn.file) {
        (Some(design), Some(file)) if design.settings.kind == DesignKind::Table => {
            format!("\n[design]\nkind = \"table\"\n{}", written_file(file))
        }
        (Some(design), _) => written_design(design),
        (None, Some(file)) => format!("\n[samples]\n{}", written_file(file)),
        (None, None) => String::new(),
    }
}

fn written_file(table: &TableFile) -> String {
    let names = table.names.as_ref().map_or_else(String::new, |names| {
        format!("names = {}\n", list(names.iter().map(|name| quoted(name))))
    });
    format!("file = {}\n{names}", quoted(&table.file))
}

fn written_design(design: &Design) -> String {
    let settings = &design.settings;
    let mut lines = vec![String::new(), "[uncertain]".to_owned()];
    lines.extend(design.parameters.iter().map(written_parameter));
    lines.push(String::new());
    lines.push("[design]".into());
    lines.push(format!("kind = \"{}\"", settings.kind.word()));
    lines.push(format!("samples = {}", settings.samples));
    let kind = settings.kind;
    if matches!(kind, DesignKind::Sobol | DesignKind::Saltelli) {
        lines.push(format!("replicates = {}", settings.replicates));
        lines.push(format!("scramble = {}", settings.scramble));
    }
    if kind == DesignKind::Saltelli {
        lines.push(format!("second_order = {}", settings.second_order));
    }
    if kind == DesignKind::Morris {
        lines.push(format!("levels = {}", settings.levels));
    }
    lines.push(format!("seed = {}", settings.seed));
    let path = |n: &usize| quoted(&design.parameters[*n].path);
    let mut together = settings.groups.iter().filter(|members| members.len() > 1).peekable();
    if together.peek().is_some() {
        lines.push(format!("groups = {}", list(together.map(|members| list(members.iter().map(path))))));
    }
    if !settings.correlation.is_empty() {
        let pair = |(a, b, rank): &(usize, usize, f64)| format!("[{}, {}, {rank:?}]", path(a), path(b));
        lines.push(format!("correlation = {}", list(settings.correlation.iter().map(pair))));
    }
    lines.join("\n") + "\n"
}

/// The line of an uncertain quantity.
fn written_parameter(parameter: &Parameter) -> String {
    let value = |value: f64| {
        Address::find(&parameter.path).map_or_else(|| format!("{value:?}"), |address| address.written(value))
    };
    let (word, entries) = match parameter.distribution {
        Some(Distribution::Uniform { from, to }) => ("uniform", vec![("from", from), ("to", to)]),
        Some(Distribution::LogUniform { from, to }) => ("loguniform", vec![("from", from), ("to", to)]),
        Some(Distribution::Triangular { from, mode, to }) => {
            ("triangular", vec![("from", from), ("mode", mode), ("to", to)])
        }
        Some(Distribution::Normal { mean, sd, from, to }) => {
            ("normal", cut([("mean", mean), ("sd", sd)], from, to))
        }
        Some(Distribution::LogNormal { median, sigma, from, to }) => {
            ("lognormal", cut([("median", median), ("sigma", sigma)], from, to))
        }
        None => return String::new(),
    };
    let entry = |(key, number): (&str, f64)| match key {
        "sigma" => format!(", {key} = {number:?}"),
        _ => format!(", {key} = {}", value(number)),
    };
    let entries: String = entries.into_iter().map(entry).collect();
    format!("{} = {{ distribution = \"{word}\"{entries} }}", quoted(&parameter.path))
}

/// Entries of a distribution, with the ends of its cut as far as there are.
fn cut(own: [(&'static str, f64); 2], from: Option<f64>, to: Option<f64>) -> Vec<(&'static str, f64)> {
    let ends = [from.map(|from| ("from", from)), to.map(|to| ("to", to))];
    own.into_iter().chain(ends.into_iter().flatten()).collect()
}

/// A TOML string, whatever it contains.
fn quoted(text: &str) -> String {
    toml::Value::String(text.to_string()).to_string()
}
