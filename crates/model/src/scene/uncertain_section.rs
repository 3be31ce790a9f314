//! `[uncertain]`: quantities of which a distribution is known.

use super::address::Address;
use super::axes::{axis_name, swept_quantity};
use super::axis_zip;
use super::draft::{Draft, Said};
use super::scene_error::{Checked, Fault};
use super::values::{self, Key, Value};
use crate::design::{Distribution, MOST_PARAMETERS, Parameter, normal_below};
use crate::units::{self, Dimension};
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// Words of `distribution` and the keys that go with each.
pub(super) const KEYS: [(&str, &[&str]); 5] = [
    ("normal", &["mean", "sd", "from", "to"]),
    ("uniform", &["from", "to"]),
    ("lognormal", &["median", "sigma", "from", "to"]),
    ("loguniform", &["from", "to"]),
    ("triangular", &["from", "mode", "to"]),
];

const FORM: &str = "a table such as { distribution = \"normal\", mean = \"40 N/m\", sd = \"10 %\" }";
/// Least share of a distribution that a cut may leave.
const LEAST_LEFT: f64 = 1e-9;
/// Standard deviations of the logarithm.
pub(super) const SIGMAS: (f64, f64) = (1e-9, 5.0);
/// What to do about a tail, in a scene and in Python.
pub(super) const CUT: &str = "cut the distribution with from or to (in Python with low= or high=)";
/// Probabilities of impossible values below this are not worth a word.
const WORTH_A_WORD: f64 = 1e-9;

/// An uncertain quantity and its place in the file.
#[derive(Clone, Debug)]
pub(super) struct Uncertain {
    pub address: Address,
    pub parameter: Parameter,
    pub key: Range<usize>,
}

/// Reads the section.
pub(super) fn read(key: &Key, value: &Value, draft: &mut Draft) -> Checked<Vec<Uncertain>> {
    let table = values::table(value, "uncertain", "a section [uncertain]")?;
    if table.is_empty() {
        return Err(Fault::at(key.span(), "[uncertain] is empty")
            .label("no quantity varies")
            .expected(format!("at least one line, such as \"instrument.tip.radius\" = {FORM}"))
            .help("leave the section out to run the one case"));
    }
    if table.len() > MOST_PARAMETERS {
        return Err(Fault::at(key.span(), "too many uncertain quantities")
            .label(format!("found {}", table.len()))
            .expected(format!("at most {MOST_PARAMETERS}"))
            .help("leave out those that hardly matter"));
    }
    let mut all: Vec<Uncertain> = Vec::new();
    for (key, value) in table {
        let read = one(key, value, draft);
        let Some(uncertain) = draft.faults.take(read) else { continue };
        let path = uncertain.parameter.path.clone();
        draft.said.push(Said { path, key: key.span(), swept: true });
        all.push(uncertain);
    }
    Ok(all)
}

fn one(key: &Key, value: &Value, draft: &Draft) -> Checked<Uncertain> {
    let address = swept_quantity(key, value, "uncertain")?;
    let path = address.path();
    if draft.said.iter().any(|said| said.swept && said.path == path) {
        return Err(axis_zip::varies_twice(&path, key.span(), draft));
    }
    let distribution = distribution(value, address)?;
    let parameter = parameter(address, Some(distribution));
    Ok(Uncertain { address, parameter, key: key.span() })
}

/// The parameter of a design that this quantity is.
pub(super) fn parameter(address: Address, distribution: Option<Distribution>) -> Parameter {
    let path = address.path();
    let units = address.quantity.dimension.si_unit().to_string();
    Parameter { name: axis_name(&path), path, units, distribution }
}

/// A distribution while it is read.
struct Entry<'a> {
    path: String,
    address: Address,
    value: &'a Value<'a>,
    table: &'a DeTable<'a>,
    word: &'static str,
}

fn distribution(value: &Value, address: Address) -> Checked<Distribution> {
    let path = address.path();
    let table = values::table(value, &path, FORM)?;
    let Some(kind) = table.get("distribution") else {
        return Err(Fault::at(value.span(), format!("`{path}` does not say which distribution"))
            .label("no `distribution`")
            .expected(FORM)
            .help(
                "add distribution = \"normal\", \"uniform\", \"lognormal\", \"loguniform\" or \"triangular\"",
            ));
    };
    let words = KEYS.map(|(word, _)| (word, word));
    let word = values::keyword(kind, &format!("uncertain.{path}.distribution"), &words)?;
    let entry = Entry { path, address, value, table, word };
    entry.check_keys()?;
    entry.read()
}

impl Entry<'_> {
    fn keys(&self) -> &'static [&'static str] {
        KEYS.iter().find(|(word, _)| *word == self.word).map_or(&[], |(_, keys)| *keys)
    }

    /// Refuses keys of other distributions.
    fn check_keys(&self) -> Checked<()> {
        let keys = self.keys();
        let own = |key: &str| key == "distribution" || keys.contains(&key);
        let Some(other) = self.table.keys().find(|key| !own(key.get_ref())) else { return Ok(()) };
        let found = other.get_ref().as_ref();
        let homes: Vec<&str> =
            KEYS.iter().filter(|(_, keys)| keys.contains(&found)).map(|(word, _)| *word).collect();
        if homes.is_empty() {
            return Err(values::unknown_key(other, &format!("uncertain.{}", self.path), keys));
        }
        Err(Fault::at(other.span(), format!("`{found}` is no key of a {} distribution", self.word))
            .label(format!("a key of: {}", homes.join(", ")))
            .expected(keys.join(", "))
            .help(format!("remove it, or write distribution = \"{}\"", homes[0])))
    }

    fn read(&self) -> Checked<Distribution> {
        match self.word {
            "normal" => {
                let mean = self.need("mean")?;
                let sd = self.sd(mean)?;
                let (from, to) = self.cut()?;
                self.something_left(from, to, |end| (end - mean) / sd)?;
                Ok(Distribution::Normal { mean, sd, from, to })
            }
            "lognormal" => {
                let median = self.need("median")?;
                self.above_zero(median, "median")?;
                let sigma = self.table.get("sigma").ok_or_else(|| self.lacks("sigma"))?;
                let path = format!("uncertain.{}.sigma", self.path);
                let sigma = values::ratio(sigma, &path, SIGMAS.0..=SIGMAS.1)?;
                let (from, to) = self.cut()?;
                self.something_left(from, to, |end| (end.ln() - median.ln()) / sigma)?;
                Ok(Distribution::LogNormal { median, sigma, from, to })
            }
            "triangular" => {
                let (from, to) = self.ends()?;
                let mode = self.need("mode")?;
                if !(from..=to).contains(&mode) {
                    return Err(self
                        .fault("mode", format!("the mode of `{}` lies outside its ends", self.path))
                        .expected("from <= mode <= to")
                        .help("move the mode, or the ends"));
                }
                Ok(Distribution::Triangular { from, mode, to })
            }
            "loguniform" => {
                let (from, to) = self.ends()?;
                self.above_zero(from, "from")?;
                Ok(Distribution::LogUniform { from, to })
            }
            _ => {
                let (from, to) = self.ends()?;
                Ok(Distribution::Uniform { from, to })
            }
        }
    }

    /// A value that the distribution cannot do without, finite.
    fn need(&self, key: &str) -> Checked<f64> {
        let value = self.table.get(key).ok_or_else(|| self.lacks(key))?;
        let number = values::quantity(value, self.address, &format!("uncertain.{}.{key}", self.path))?;
        match number.is_finite() {
            true => Ok(number),
            false => Err(self
                .fault(key, format!("`{key}` of `{}` is infinite", self.path))
                .expected("a finite value")
                .help("give a large one if it should hardly matter")),
        }
    }

    fn lacks(&self, key: &str) -> Box<Fault> {
        Fault::at(self.value.span(), format!("`{}` lacks `{key}`", self.path))
            .label(format!("a {} distribution", self.word))
            .expected(format!("its keys: {}", self.keys().join(", ")))
            .help(format!("add `{key}`"))
    }

    /// The fault of an entry, marked there.
    fn fault(&self, key: &str, title: String) -> Box<Fault> {
        let value = self.table.get(key).unwrap_or(self.value);
        values::unfit(value, title)
    }

    fn above_zero(&self, number: f64, key: &str) -> Checked<()> {
        if number > 0.0 {
            return Ok(());
        }
        Err(self
            .fault(key, format!("`{key}` of `{}` is not above zero, as its logarithm needs", self.path))
            .expected("a value above zero")
            .help("write distribution = \"uniform\" or \"normal\" for a quantity that may be zero or less"))
    }

    /// Both ends, in order.
    fn ends(&self) -> Checked<(f64, f64)> {
        let (from, to) = (self.need("from")?, self.need("to")?);
        self.in_order(from, to)?;
        Ok((from, to))
    }

    /// The ends of a cut, as far as there are.
    fn cut(&self) -> Checked<(Option<f64>, Option<f64>)> {
        let end = |key: &str| self.table.contains_key(key).then(|| self.need(key)).transpose();
        let (from, to) = (end("from")?, end("to")?);
        if let (Some(from), Some(to)) = (from, to) {
            self.in_order(from, to)?;
        }
        Ok((from, to))
    }

    fn in_order(&self, from: f64, to: f64) -> Checked<()> {
        if from < to {
            return Ok(());
        }
        Err(self
            .fault("to", format!("`to` of `{}` is not above `from`", self.path))
            .expected("from below to (in Python low below high)")
            .help("exchange the ends; a quantity that is known belongs in its section"))
    }

    /// The standard deviation: with the quantity's unit, or as a share of the mean.
    fn sd(&self, mean: f64) -> Checked<f64> {
        let value = self.table.get("sd").ok_or_else(|| self.lacks("sd"))?;
        let path = format!("uncertain.{}.sd", self.path);
        let percent = value.get_ref().as_str().and_then(|text| text.trim().strip_suffix('%'));
        let sd = match percent {
            Some(number) => match number.trim().parse::<f64>() {
                Ok(number) => number / 100.0 * mean.abs(),
                Err(_) => f64::NAN,
            },
            None => values::raw_quantity(value, self.address.quantity.dimension, &path).map_err(|fault| {
                let plain = matches!(value.get_ref(), DeValue::Integer(_) | DeValue::Float(_));
                let unit = self.address.quantity.dimension != Dimension::Dimensionless;
                fault.maybe_help((plain && unit).then(|| "give its unit, or a share: \"10 %\"".to_owned()))
            })?,
        };
        if sd.is_finite() && sd > 0.0 {
            return Ok(sd);
        }
        let help = match (percent.is_some(), mean == 0.0) {
            (true, true) => "no share of a mean of zero is a spread: give the sd with its unit",
            _ => "a quantity without spread belongs in its section",
        };
        Err(self
            .fault("sd", format!("the standard deviation of `{}` is not above zero", self.path))
            .expected("a spread above zero, such as \"4 N/m\" or \"10 %\"")
            .help(help))
    }

    /// Refuses a cut that leaves next to nothing; `z` makes standard normal numbers of its ends.
    fn something_left(&self, from: Option<f64>, to: Option<f64>, z: impl Fn(f64) -> f64) -> Checked<()> {
        let (from, to) = (from.map_or(f64::NEG_INFINITY, &z), to.map_or(f64::INFINITY, &z));
        // By whichever tail keeps its digits.
        let left = match from > 0.0 {
            true => normal_below(-from) - normal_below(-to),
            false => normal_below(to) - normal_below(from),
        };
        if left >= LEAST_LEFT {
            return Ok(());
        }
        let key = if self.table.contains_key("from") { "from" } else { "to" };
        Err(self
            .fault(key, format!("the cut of `{}` leaves nothing of its distribution", self.path))
            .expected(format!("ends between which at least {LEAST_LEFT:e} of it lie; found {left:.1e}"))
            .help("move the ends, or the middle"))
    }
}

impl Uncertain {
    /// Probability of a value that the quantity cannot have.
    pub fn impossible(&self) -> f64 {
        let (least, most) = self.address.quantity.domain.ends();
        self.parameter.distribution.map_or(0.0, |one| one.below(least) + (1.0 - one.below(most)))
    }

    /// A word about a standard deviation larger than the mean.
    pub fn wide(&self) -> Option<String> {
        let Some(Distribution::Normal { mean, sd, .. }) = self.parameter.distribution else { return None };
        (mean != 0.0 && sd > mean.abs()).then(|| {
            let shown = |value| units::shown(value, self.address.quantity.dimension);
            format!(
                "the standard deviation of {}, {}, is larger than its mean, {}: a share is written \"10 %\"",
                self.parameter.path,
                shown(sd),
                shown(mean)
            )
        })
    }

    /// A word about values that it cannot have.
    pub fn doubt(&self) -> Option<String> {
        let probability = self.impossible();
        (probability >= WORTH_A_WORD).then(|| {
            format!(
                "{} may have impossible values (probability {probability:.1e}; possible is {}): {CUT}",
                self.parameter.path,
                self.address.quantity.domain.described()
            )
        })
    }
}
