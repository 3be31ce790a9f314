//! Groups `waveforms` and `spectra`: variables with a row for each of some instances.

/// A variable of such a group.
pub struct RowColumn<T> {
    pub name: &'static str,
    pub units: &'static str,
    pub long_name: &'static str,
    /// Its rows.
    pub of: fn(&T) -> &Vec<Vec<f64>>,
    /// Where they are put when a file is read.
    #[cfg_attr(not(feature = "hdf5"), expect(dead_code))]
    pub(super) of_mut: fn(&mut T) -> &mut Vec<Vec<f64>>,
}

macro_rules! columns {
    ($table:ident: $($name:ident, $units:literal, $long_name:literal;)*) => {
        impl $table {
            /// Its variables, in the order of the file.
            pub const COLUMNS: [RowColumn<Self>; [$(stringify!($name)),*].len()] = [$(RowColumn {
                name: stringify!($name),
                units: $units,
                long_name: $long_name,
                of: |table| &table.$name,
                of_mut: |table| &mut table.$name,
            }),*];
        }
    };
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

// The time is a dimension where all instances share it.
columns! {
    Waveforms:
    tip_travel, "m", "travel of the tip";
    actuator_top, "m", "travel of the actuator's top, or of a rigid base";
    indentation, "m", "indentation, negative for a gap";
    force, "N", "force on the tip, positive away from the sample";
}

/// Harmonics of the drive in the motion of some instances, and in the force on them. Rows of equal length, one for each
/// instance: its first number is of the fundamental. NaN where an instance's steps resolve less.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Spectra {
    /// Instance numbers.
    pub instances: Vec<u64>,
    /// Hz
    pub frequency: Vec<Vec<f64>>,
    /// Travel of the tip, m.
    pub tip_amplitude: Vec<Vec<f64>>,
    /// Lag behind that multiple of the drive's phase, degree, 0 to below 360; NaN where the amplitude is 0.
    pub tip_phase: Vec<Vec<f64>>,
    /// The tip against the actuator's top, m.
    pub deflection_amplitude: Vec<Vec<f64>>,
    pub deflection_phase: Vec<Vec<f64>>,
    /// Force on the tip, N.
    pub force_amplitude: Vec<Vec<f64>>,
    pub force_phase: Vec<Vec<f64>>,
}

columns! {
    Spectra:
    frequency, "Hz", "frequency of the harmonic";
    tip_amplitude, "m", "amplitude of the tip's travel";
    tip_phase, "degree", "lag of the tip's travel";
    deflection_amplitude, "m", "amplitude of the deflection";
    deflection_phase, "degree", "lag of the deflection";
    force_amplitude, "N", "amplitude of the force on the tip";
    force_phase, "degree", "lag of the force on the tip";
}

impl Spectra {
    /// Harmonics of each instance.
    pub fn harmonics(&self) -> usize {
        self.frequency.first().map_or(0, Vec::len)
    }
}
