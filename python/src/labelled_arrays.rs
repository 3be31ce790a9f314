//! What a results file would hold, as objects of Python: groups, arrays, labels.

use crate::exception;
use afmsweep::store::{
    ArrayLayout, ArrayRole, ArrayValues, AttributeValue, FileLayout, GroupLayout, Results, VariableSource,
};
use pyo3::prelude::*;
use pyo3::types::{PyByteArray, PyBytes, PyDict, PyList};

/// A group with its numbers, which nothing else holds.
pub struct LabelledGroup {
    name: &'static str,
    attributes: Vec<(String, Label)>,
    arrays: Vec<LabelledArray>,
}

struct LabelledArray {
    name: String,
    is_dimension: bool,
    dims: Vec<String>,
    shape: Vec<usize>,
    attributes: Vec<(String, Label)>,
    numbers: Numbers,
}

enum Label {
    Text(String),
    Number(f64),
    Codes(Vec<u8>),
}

enum Numbers {
    F64(Vec<f64>),
    U8(Vec<u8>),
    U32(Vec<u32>),
    I32(Vec<i32>),
    I64(Vec<i64>),
    Words(Vec<String>),
}

/// Everything of these results, with the numbers over all instances from where they are.
pub fn groups(results: &Results, numbers: &dyn VariableSource) -> PyResult<Vec<LabelledGroup>> {
    let layout = FileLayout::of(results, numbers, "").map_err(|error| exception::of_store(&error))?;
    let mut all = layout.groups.iter().map(|group| owned(&layout, group)).collect::<PyResult<Vec<_>>>()?;
    if let Some(root) = all.first_mut() {
        let (name, sums) = layout.checksums();
        root.attributes.push((name.to_owned(), Label::Text(sums)));
    }
    Ok(all)
}

fn owned(layout: &FileLayout, group: &GroupLayout) -> PyResult<LabelledGroup> {
    let mut arrays = Vec::new();
    for array in group.arrays.iter().filter(|array| array.role != ArrayRole::Dimension) {
        arrays.push(of_array(layout, group, array)?);
    }
    Ok(LabelledGroup { name: group.name, attributes: labels(&group.attributes), arrays })
}

fn of_array(layout: &FileLayout, group: &GroupLayout, array: &ArrayLayout) -> PyResult<LabelledArray> {
    let values = layout.values(array).map_err(|error| exception::failed(&error.to_string()))?;
    let numbers = match values {
        ArrayValues::F64(all) => Numbers::F64(all.into_owned()),
        ArrayValues::U8(all) => Numbers::U8(all.into_owned()),
        ArrayValues::U32(all) => Numbers::U32(all.into_owned()),
        ArrayValues::I32(all) => Numbers::I32(all),
        ArrayValues::I64(all) => Numbers::I64(all),
        ArrayValues::Words(all) => Numbers::Words(all.to_vec()),
        ArrayValues::Count(_) | ArrayValues::Instances(..) => {
            return Err(exception::failed(&format!("{} has no values", array.name)));
        }
    };
    let is_dimension = array.role == ArrayRole::Coordinate;
    let dims = match is_dimension {
        true => vec![array.name.to_owned()],
        false => array.dims.iter().map(|dim| group.arrays[*dim].name.to_owned()).collect(),
    };
    Ok(LabelledArray {
        name: array.name.to_owned(),
        is_dimension,
        dims,
        shape: group.shape(array),
        attributes: labels(&array.attributes),
        numbers,
    })
}

fn labels(all: &[(&str, AttributeValue)]) -> Vec<(String, Label)> {
    let one = |(name, value): &(&str, AttributeValue)| {
        let value = match value {
            AttributeValue::Text(text) => Label::Text(text.clone().into_owned()),
            AttributeValue::Number(number) => Label::Number(*number),
            AttributeValue::Codes(codes) => Label::Codes(codes.clone()),
        };
        ((*name).to_owned(), value)
    };
    all.iter().map(one).collect()
}

/// `[(name, attributes, [(name, is a dimension, dims, shape, attributes, kind, buffer or words)])]`; numbers are handed
/// over one array after the other.
pub fn to_python(py: Python<'_>, groups: Vec<LabelledGroup>) -> PyResult<Bound<'_, PyList>> {
    let all = PyList::empty(py);
    for group in groups {
        let arrays = PyList::empty(py);
        for array in group.arrays {
            let LabelledArray { name, is_dimension, dims, shape, attributes, numbers } = array;
            let (kind, numbers) = of_numbers(py, numbers)?;
            let attributes = of_labels(py, attributes)?;
            arrays.append((name, is_dimension, dims, shape, attributes, kind, numbers))?;
        }
        all.append((group.name, of_labels(py, group.attributes)?, arrays))?;
    }
    Ok(all)
}

fn of_numbers<'py>(py: Python<'py>, numbers: Numbers) -> PyResult<(&'static str, Bound<'py, PyAny>)> {
    let buffer = |kind, bytes: &[u8]| Ok((kind, PyByteArray::new(py, bytes).into_any()));
    match numbers {
        Numbers::F64(all) => buffer("f8", bytemuck::cast_slice(&all)),
        Numbers::U8(all) => buffer("u1", &all),
        Numbers::U32(all) => buffer("u4", bytemuck::cast_slice(&all)),
        Numbers::I32(all) => buffer("i4", bytemuck::cast_slice(&all)),
        Numbers::I64(all) => buffer("i8", bytemuck::cast_slice(&all)),
        Numbers::Words(all) => Ok(("O", PyList::new(py, all)?.into_any())),
    }
}

/// Texts, numbers, and codes as bytes.
fn of_labels(py: Python<'_>, labels: Vec<(String, Label)>) -> PyResult<Bound<'_, PyDict>> {
    let all = PyDict::new(py);
    for (name, value) in labels {
        match value {
            Label::Text(text) => all.set_item(name, text)?,
            Label::Number(number) => all.set_item(name, number)?,
            Label::Codes(codes) => all.set_item(name, PyBytes::new(py, &codes))?,
        }
    }
    Ok(all)
}
