//! A group of a results file as labelled arrays, before it is written in any format.

use super::super::{Attribute, COLUMNS, Coordinate, Flags, StateSet, Variable};
use super::FileContents;
use std::borrow::Cow;

/// The axis of the two ways along a curve, by its path.
const DIRECTION: &str = "curve.direction";
const INSTANCE: &str = "instance number, counted from 0";

/// A group: its attributes and its arrays, in the order of the file.
#[derive(Clone, Debug)]
pub struct GroupLayout<'a> {
    /// Empty for the root.
    pub name: &'static str,
    pub attributes: Vec<(&'a str, AttributeValue<'a>)>,
    pub arrays: Vec<ArrayLayout<'a>>,
}

/// An attribute of a group or of an array.
#[derive(Clone, Debug, PartialEq)]
pub enum AttributeValue<'a> {
    Text(Cow<'a, str>),
    Number(f64),
    Codes(Vec<u8>),
}

/// An array with its labels.
#[derive(Clone, Debug)]
pub struct ArrayLayout<'a> {
    pub name: &'a str,
    pub role: ArrayRole,
    /// Places of its dimensions among the group's arrays, slowest first. A dimension stands along itself, and has none.
    pub dims: Vec<usize>,
    pub attributes: Vec<(&'static str, AttributeValue<'a>)>,
    pub values: ArrayValues<'a>,
}

/// What an array is to the others of its group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArrayRole {
    Variable,
    /// A dimension, with its values.
    Coordinate,
    /// A dimension whose values mean nothing.
    Dimension,
}

/// The numbers or words of an array, row-major.
#[derive(Clone, Debug)]
pub enum ArrayValues<'a> {
    F64(Cow<'a, [f64]>),
    U8(Cow<'a, [u8]>),
    U32(Cow<'a, [u32]>),
    I32(Vec<i32>),
    I64(Vec<i64>),
    Words(&'a [String]),
    /// The numbers of so many instances, from 0.
    Count(usize),
    /// Numbers over all instances, which [`super::FileLayout::values`] gives.
    Instances(StateSet, InstanceColumn),
}

/// Numbers over all instances, by their place among the variables or the flags.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InstanceColumn {
    Variable(usize),
    Status,
    Steps,
    Flags(usize),
}

impl ArrayValues<'_> {
    /// How many a dimension has.
    pub(super) fn places(&self) -> usize {
        match self {
            Self::F64(all) => all.len(),
            Self::U8(all) => all.len(),
            Self::U32(all) => all.len(),
            Self::I32(all) => all.len(),
            Self::I64(all) => all.len(),
            Self::Words(all) => all.len(),
            Self::Count(count) => *count,
            Self::Instances(..) => 0,
        }
    }
}

/// Names of the variables that tell more of a variable's values.
#[derive(Clone, Copy)]
pub(super) struct Beside<'a> {
    /// Where they lie, in a list.
    pub coordinates: Option<&'a str>,
    /// How good they are.
    pub ancillary: &'static str,
}

impl<'a> GroupLayout<'a> {
    pub(super) fn new(name: &'static str) -> Self {
        Self { name, attributes: Vec::new(), arrays: Vec::new() }
    }

    pub(super) fn attribute(&mut self, name: &'a str, value: &'a Attribute) {
        let value = match value {
            Attribute::Text(text) => AttributeValue::Text(text.into()),
            Attribute::Number(number) => AttributeValue::Number(*number),
        };
        self.attributes.push((name, value));
    }

    pub(super) fn text(&mut self, name: &'a str, text: impl Into<Cow<'a, str>>) {
        self.attributes.push((name, AttributeValue::Text(text.into())));
    }

    /// Lengths of an array's dimensions.
    pub fn shape(&self, of: &ArrayLayout) -> Vec<usize> {
        match of.role {
            ArrayRole::Variable => of.dims.iter().map(|dim| self.arrays[*dim].values.places()).collect(),
            _ => vec![of.values.places()],
        }
    }

    fn push(&mut self, name: &'a str, role: ArrayRole, dims: &[usize], values: ArrayValues<'a>) -> usize {
        self.arrays.push(ArrayLayout { name, role, dims: dims.to_vec(), attributes: Vec::new(), values });
        self.arrays.len() - 1
    }

    /// Gives an array a text.
    pub(super) fn label(&mut self, array: usize, name: &'static str, text: impl Into<Cow<'a, str>>) {
        self.arrays[array].attributes.push((name, AttributeValue::Text(text.into())));
    }

    /// Counts and numbers of instances have no units.
    fn describe(&mut self, array: usize, units: &'a str, long_name: &'a str) {
        if !units.is_empty() {
            self.label(array, "units", units);
        }
        self.label(array, "long_name", long_name);
    }

    /// A dimension with values.
    pub(super) fn coordinate(
        &mut self,
        name: &'a str,
        units: &'a str,
        long_name: &'a str,
        values: ArrayValues<'a>,
    ) -> usize {
        let place = self.push(name, ArrayRole::Coordinate, &[], values);
        self.describe(place, units, long_name);
        place
    }

    /// A dimension without values.
    pub(super) fn dimension(&mut self, name: &'static str, length: usize) -> usize {
        self.push(name, ArrayRole::Dimension, &[], ArrayValues::U8(vec![0; length].into()))
    }

    /// Any variable.
    pub(super) fn variable(&mut self, name: &'a str, dims: &[usize], values: ArrayValues<'a>) -> usize {
        self.push(name, ArrayRole::Variable, dims, values)
    }

    /// A variable with units; NaN where there is no number.
    pub(super) fn quantity(
        &mut self,
        name: &'a str,
        (units, long_name): (&'a str, &'a str),
        dims: &[usize],
        values: ArrayValues<'a>,
    ) -> usize {
        let place = self.variable(name, dims, values);
        self.describe(place, units, long_name);
        place
    }

    /// A dimension whose values 0, 1 and so on have names.
    fn named(&mut self, axis: &'a Coordinate) -> usize {
        let codes: Vec<u8> = (0..axis.words.len() as u8).collect();
        let values = ArrayValues::U8(codes.clone().into());
        let place = self.coordinate(&axis.name, &axis.units, &axis.long_name, values);
        self.arrays[place].attributes.push(("flag_values", AttributeValue::Codes(codes)));
        self.label(place, "flag_meanings", axis.words.join(" "));
        place
    }

    /// A dimension for some of the instances, beside variable `instance` with their numbers.
    pub(super) fn some_of(&mut self, name: &'static str, instances: &[u64]) -> usize {
        let dim = self.dimension(name, instances.len());
        self.instances(&[dim], instances);
        dim
    }

    /// Variable `instance`.
    pub(super) fn instances(&mut self, dims: &[usize], numbers: &[u64]) {
        let numbers = numbers.iter().map(|&n| i64::try_from(n).unwrap_or(i64::MAX)).collect();
        self.numbered(dims, ArrayValues::I64(numbers));
    }

    pub(super) fn numbered(&mut self, dims: &[usize], numbers: ArrayValues<'a>) {
        let place = self.variable("instance", dims, numbers);
        self.label(place, "long_name", INSTANCE);
    }

    /// A variable whose codes or bits have these values, and names.
    pub(super) fn codes(
        &mut self,
        (name, long_name, meanings): (&'a str, &'a str, String),
        dims: &[usize],
        (kind, values): (&'static str, Vec<u8>),
        codes: ArrayValues<'a>,
    ) -> usize {
        let place = self.variable(name, dims, codes);
        self.label(place, "long_name", long_name);
        self.arrays[place].attributes.push((kind, AttributeValue::Codes(values)));
        self.label(place, "flag_meanings", meanings);
        place
    }

    /// Codes from 0 on, or bits.
    pub(super) fn words(&mut self, flags: &'a Flags, dims: &[usize], codes: ArrayValues<'a>) -> usize {
        let (kind, value): (_, fn(u8) -> u8) =
            if flags.bits { ("flag_masks", |n| 1 << n) } else { ("flag_values", |n| n) };
        let values = (0..flags.meanings.len() as u8).map(value).collect();
        self.codes((&flags.name, &flags.long_name, flags.meanings.join(" ")), dims, (kind, values), codes)
    }

    /// Variables over the instances, with the dimension `harmonic` behind them where asked for; their numbers are those of the
    /// states, or in themselves.
    pub(super) fn variables(
        &mut self,
        variables: &'a [Variable],
        dims: &[usize],
        beside: Beside,
        states: Option<StateSet>,
    ) {
        let mut harmonic = None;
        for (number, variable) in variables.iter().enumerate() {
            let mut dims = dims.to_vec();
            if let Some(count) = variable.harmonics {
                dims.push(*harmonic.get_or_insert_with(|| {
                    let orders = ArrayValues::I32((1..=count as i32).collect());
                    self.coordinate("harmonic", "1", "harmonic of the drive frequency", orders)
                }));
            }
            let values = match states {
                Some(of) => ArrayValues::Instances(of, InstanceColumn::Variable(number)),
                None => ArrayValues::F64(variable.data.as_slice().into()),
            };
            let of = (variable.units.as_str(), variable.long_name.as_str());
            let place = self.quantity(&variable.name, of, &dims, values);
            if !variable.error_scale.is_empty() {
                self.label(place, "error_scale", variable.error_scale.as_str());
                self.label(place, "ancillary_variables", beside.ancillary);
            }
            self.locate(place, beside);
        }
    }

    /// Tells a variable's readers where its values lie.
    pub(super) fn locate(&mut self, place: usize, beside: Beside) {
        if let Some(names) = beside.coordinates {
            self.label(place, "coordinates", names.to_owned());
        }
    }

    /// Tells which quantity of a scene a coordinate is.
    fn name_quantity(&mut self, place: usize, axis: &'a Coordinate) {
        if !axis.scene_path.is_empty() {
            self.label(place, "scene_path", axis.scene_path.as_str());
        }
    }

    /// The quantities that vary along a dimension.
    fn columns(&mut self, axis: &'a Coordinate, dim: usize) {
        for column in &axis.columns {
            let (name, long_name) = (column.name.as_str(), column.long_name.as_str());
            let place = match column.words.as_slice() {
                [] => {
                    let values = ArrayValues::F64(column.values.as_slice().into());
                    self.quantity(name, (&column.units, long_name), &[dim], values)
                }
                words => {
                    let place = self.variable(name, &[dim], ArrayValues::Words(words));
                    self.label(place, "long_name", long_name);
                    place
                }
            };
            self.name_quantity(place, column);
        }
        if !axis.columns.is_empty() {
            self.label(dim, COLUMNS, names(&axis.columns));
        }
    }

    /// The dimensions that all instances stand over, and the names of variables that tell of a list what varies.
    pub(super) fn axes(&mut self, filled: &FileContents<'a>) -> (Vec<usize>, Option<String>) {
        let (results, mut dims) = (filled.frame, Vec::new());
        if !results.list {
            for axis in &results.axes {
                let dim = match axis.words.as_slice() {
                    [] => {
                        let values = ArrayValues::F64(axis.values.as_slice().into());
                        self.coordinate(&axis.name, &axis.units, &axis.long_name, values)
                    }
                    // The ways along a curve are codes, everything else is called by name.
                    _ if axis.scene_path == DIRECTION => self.named(axis),
                    words => self.coordinate(&axis.name, "", &axis.long_name, ArrayValues::Words(words)),
                };
                self.columns(axis, dim);
                self.name_quantity(dim, axis);
                dims.push(dim);
            }
            let columns: Vec<&Coordinate> = results.axes.iter().flat_map(|axis| &axis.columns).collect();
            return (dims, (!columns.is_empty()).then(|| names(columns)));
        }
        dims.push(self.coordinate("instance", "", INSTANCE, ArrayValues::Count(filled.count())));
        for axis in &results.axes {
            let values = ArrayValues::F64(axis.values.as_slice().into());
            let place = self.quantity(&axis.name, (&axis.units, &axis.long_name), &dims, values);
            self.name_quantity(place, axis);
        }
        (dims, (!results.axes.is_empty()).then(|| names(&results.axes)))
    }
}

/// The names of these, as attributes have them.
fn names<'a>(all: impl IntoIterator<Item = &'a Coordinate>) -> String {
    let names: Vec<&str> = all.into_iter().map(|one| one.name.as_str()).collect();
    names.join(" ")
}
