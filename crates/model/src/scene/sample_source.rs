//! Designs and tables written out: what they follow from, never their rows.

use super::address::Address;
use super::toml_text::quoted;
use super::{Drawn, TableFile};
use crate::design::{Design, DesignKind, Distribution, Parameter};

/// The sections that say where the samples come from.
pub(super) fn written(drawn: &Drawn) -> String {
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
        let names: Vec<String> = names.iter().map(|name| quoted(name)).collect();
        format!("names = [{}]\n", names.join(", "))
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
    let together = settings.groups.iter().filter(|members| members.len() > 1);
    let groups: Vec<String> = together
        .map(|members| format!("[{}]", members.iter().map(path).collect::<Vec<_>>().join(", ")))
        .collect();
    if !groups.is_empty() {
        lines.push(format!("groups = [{}]", groups.join(", ")));
    }
    let pair = |(a, b, rank): &(usize, usize, f64)| format!("[{}, {}, {rank:?}]", path(a), path(b));
    let pairs: Vec<String> = settings.correlation.iter().map(pair).collect();
    if !pairs.is_empty() {
        lines.push(format!("correlation = [{}]", pairs.join(", ")));
    }
    lines.join("\n") + "\n"
}

/// The line of an uncertain quantity.
fn written_parameter(parameter: &Parameter) -> String {
    let value = |value: f64| {
        Address::find(&parameter.path).map_or_else(|| format!("{value:?}"), |address| address.written(value))
    };
    let cut = |from: Option<f64>, to: Option<f64>| {
        let end = |key: &str, end: Option<f64>| {
            end.map_or_else(String::new, |end| format!(", {key} = {}", value(end)))
        };
        end("from", from) + &end("to", to)
    };
    let entries = match parameter.distribution {
        Some(Distribution::Uniform { from, to }) => {
            format!("\"uniform\", from = {}, to = {}", value(from), value(to))
        }
        Some(Distribution::LogUniform { from, to }) => {
            format!("\"loguniform\", from = {}, to = {}", value(from), value(to))
        }
        Some(Distribution::Triangular { from, mode, to }) => {
            format!("\"triangular\", from = {}, mode = {}, to = {}", value(from), value(mode), value(to))
        }
        Some(Distribution::Normal { mean, sd, from, to }) => {
            format!("\"normal\", mean = {}, sd = {}{}", value(mean), value(sd), cut(from, to))
        }
        Some(Distribution::LogNormal { median, sigma, from, to }) => {
            format!("\"lognormal\", median = {}, sigma = {sigma:?}{}", value(median), cut(from, to))
        }
        None => String::new(),
    };
    format!("{} = {{ distribution = {entries} }}", quoted(&parameter.path))
}
