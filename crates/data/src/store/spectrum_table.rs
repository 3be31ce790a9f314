//! Group `spectra`.

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

/// A variable of the group.
pub struct SpectrumColumn {
    pub name: &'static str,
    pub units: &'static str,
    pub long_name: &'static str,
    /// Its rows.
    pub of: fn(&Spectra) -> &Vec<Vec<f64>>,
}

impl Spectra {
    /// Its variables, in the order of the file.
    #[rustfmt::skip]
    pub const COLUMNS: [SpectrumColumn; 7] = [
        SpectrumColumn { name: "frequency", units: "Hz", long_name: "frequency of the harmonic", of: |s| &s.frequency },
        SpectrumColumn { name: "tip_amplitude", units: "m", long_name: "amplitude of the tip's travel", of: |s| &s.tip_amplitude },
        SpectrumColumn { name: "tip_phase", units: "degree", long_name: "lag of the tip's travel", of: |s| &s.tip_phase },
        SpectrumColumn { name: "deflection_amplitude", units: "m", long_name: "amplitude of the deflection", of: |s| &s.deflection_amplitude },
        SpectrumColumn { name: "deflection_phase", units: "degree", long_name: "lag of the deflection", of: |s| &s.deflection_phase },
        SpectrumColumn { name: "force_amplitude", units: "N", long_name: "amplitude of the force on the tip", of: |s| &s.force_amplitude },
        SpectrumColumn { name: "force_phase", units: "degree", long_name: "lag of the force on the tip", of: |s| &s.force_phase },
    ];

    /// Harmonics of each instance.
    pub fn harmonics(&self) -> usize {
        self.frequency.first().map_or(0, Vec::len)
    }
}
