//! The results file: HDF5 that netCDF-4 readers open with labelled axes and units.

/// Everything a results file holds, as plain data. Written by [`Writer`], read back by [`read`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Results {
    pub title: String,
    /// Swept axes; dimensions of a grid, or variables over `instance` for a list.
    pub axes: Vec<Coordinate>,
    /// True for a list of samples (dimension `instance`), false for a grid.
    pub list: bool,
    pub variables: Vec<Variable>,
    /// One code per instance, see [`crate::observe::Status`].
    pub status: Vec<u8>,
    pub steps_per_period: Vec<u32>,
    pub waveforms: Option<Waveforms>,
    /// Scene text, resolved scene, plan, device, times: root attributes in this order.
    pub attributes: Vec<(String, Attribute)>,
}

/// A labelled axis.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coordinate {
    pub name: String,
    pub units: String,
    pub long_name: String,
    pub values: Vec<f64>,
}

/// An f64 variable over the instances, with further dimensions behind them.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Variable {
    pub name: String,
    pub units: String,
    pub long_name: String,
    /// `Some(n)`: a last dimension `harmonic` of length n, coordinate 1..=n.
    pub harmonics: Option<usize>,
    /// Row-major, instance first.
    pub data: Vec<f64>,
}

/// Root attribute.
#[derive(Clone, Debug, PartialEq)]
pub enum Attribute {
    Text(String),
    Number(f64),
}

/// Group `waveforms`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Waveforms {
    /// Instance numbers.
    pub instances: Vec<u64>,
    /// Time in s from the drive's zero phase: one row shared by all instances, or, where their
    /// drive frequencies differ, one row each (then the dimension is `sample`).
    pub time: Vec<Vec<f64>>,
    /// m, by instance then time.
    pub tip_travel: Vec<Vec<f64>>,
    /// m
    pub actuator_top: Vec<Vec<f64>>,
    /// m
    pub indentation: Vec<Vec<f64>>,
    /// N
    pub force: Vec<Vec<f64>>,
}
