//! The closed table of a scene's quantities: path, dimension, domain, and their place in [`Params`].
//!
//! Reading, sweeping and the resolved echo all go through this table, so a quantity added here can be
//! written, swept and echoed at once. Its usual and possible sizes stand in `plausibility.rs`, when it matters in `provenance.rs`.

use super::params::*;
use super::quantity::{Domain, Quantity};
use crate::units::Dimension;

/// An entry whose value is a plain field.
macro_rules! field {
    ($path:literal, $long_name:literal, $dimension:ident, $domain:ident, $($field:ident).+) => {
        Quantity {
            path: $path,
            long_name: $long_name,
            dimension: Dimension::$dimension,
            domain: Domain::$domain,
            get: |params, _| Some(params.$($field).+),
            set: |params, _, value| params.$($field).+ = value,
        }
    };
}

/// An entry that is the one value of an enum's variant.
macro_rules! variant {
    ($path:literal, $long_name:literal, $dimension:ident, $domain:ident, $($field:ident).+, $variant:path) => {
        Quantity {
            path: $path,
            long_name: $long_name,
            dimension: Dimension::$dimension,
            domain: Domain::$domain,
            get: |params, _| if let $variant(value) = params.$($field).+ { Some(value) } else { None },
            set: |params, _, value| params.$($field).+ = $variant(value),
        }
    };
}

/// An entry that is one of several values of an enum's variant; `$default` makes that variant.
macro_rules! member {
    ($path:literal, $long_name:literal, $dimension:ident, $domain:ident, $($field:ident).+, $variant:path, $member:ident, $default:path) => {
        Quantity {
            path: $path,
            long_name: $long_name,
            dimension: Dimension::$dimension,
            domain: Domain::$domain,
            get: |params, _| if let $variant { $member, .. } = &params.$($field).+ { Some(*$member) } else { None },
            set: |params, _, value| {
                if !matches!(params.$($field).+, $variant { .. }) {
                    params.$($field).+ = $default();
                }
                if let $variant { $member, .. } = &mut params.$($field).+ {
                    *$member = value;
                }
            },
        }
    };
}

/// An entry of one of the lever's listed modes.
macro_rules! mode {
    ($path:literal, $long_name:literal, $dimension:ident, $domain:ident, $member:ident) => {
        Quantity {
            path: $path,
            long_name: $long_name,
            dimension: Dimension::$dimension,
            domain: Domain::$domain,
            get: |params, index| match &params.instrument.cantilever.lever {
                LeverSpec::Modes(modes) => modes.get(index).map(|mode| mode.$member),
                _ => None,
            },
            set: |params, index, value| {
                if let LeverSpec::Modes(modes) = &mut params.instrument.cantilever.lever
                    && let Some(mode) = modes.get_mut(index)
                {
                    mode.$member = value;
                }
            },
        }
    };
}

/// An entry that is held in place of the gap.
macro_rules! held {
    ($path:literal, $long_name:literal, $dimension:ident, $domain:ident, $variant:path) => {
        Quantity {
            path: $path,
            long_name: $long_name,
            dimension: Dimension::$dimension,
            domain: Domain::$domain,
            get: |params, _| match params.approach.held {
                Some($variant(value)) => Some(value),
                _ => None,
            },
            set: |params, _, value| params.approach.held = Some($variant(value)),
        }
    };
}

fn table_lever() -> LeverSpec {
    CantileverParams::default().lever
}

fn table_tip() -> TipMass {
    TipParams::default().mass
}

/// Both values must be given, so neither has a default that could pass for one.
fn unknown_calibration() -> LeverSpec {
    LeverSpec::Calibrated { stiffness: f64::NAN, frequency: f64::NAN }
}

/// Every quantity of a scene, in the order the resolved scene writes them.
pub static QUANTITIES: &[Quantity] = &[
    field!(
        "instrument.actuator.youngs_modulus",
        "rod Young's modulus",
        Pressure,
        Positive,
        instrument.actuator.youngs_modulus
    ),
    field!("instrument.actuator.density", "rod density", Density, Positive, instrument.actuator.density),
    field!(
        "instrument.actuator.h33",
        "rod piezoelectric constant h33",
        ElectricField,
        Positive,
        instrument.actuator.h33
    ),
    field!(
        "instrument.actuator.beta33",
        "rod inverse permittivity beta33",
        InversePermittivity,
        Positive,
        instrument.actuator.beta33
    ),
    field!("instrument.actuator.length", "rod length", Length, Positive, instrument.actuator.length),
    field!("instrument.actuator.width", "rod width", Length, Positive, instrument.actuator.width),
    field!("instrument.actuator.thickness", "rod thickness", Length, Positive, instrument.actuator.thickness),
    field!(
        "instrument.actuator.quality_factor",
        "rod quality factor",
        Dimensionless,
        QualityFactor,
        instrument.actuator.quality_factor
    ),
    member!(
        "instrument.cantilever.youngs_modulus",
        "lever Young's modulus",
        Pressure,
        Positive,
        instrument.cantilever.lever,
        LeverSpec::Dimensions,
        youngs_modulus,
        table_lever
    ),
    member!(
        "instrument.cantilever.density",
        "lever density",
        Density,
        Positive,
        instrument.cantilever.lever,
        LeverSpec::Dimensions,
        density,
        table_lever
    ),
    member!(
        "instrument.cantilever.length",
        "lever length",
        Length,
        Positive,
        instrument.cantilever.lever,
        LeverSpec::Dimensions,
        length,
        table_lever
    ),
    member!(
        "instrument.cantilever.width",
        "lever width",
        Length,
        Positive,
        instrument.cantilever.lever,
        LeverSpec::Dimensions,
        width,
        table_lever
    ),
    member!(
        "instrument.cantilever.thickness",
        "lever thickness",
        Length,
        Positive,
        instrument.cantilever.lever,
        LeverSpec::Dimensions,
        thickness,
        table_lever
    ),
    member!(
        "instrument.cantilever.stiffness",
        "lever stiffness, first mode",
        Stiffness,
        Positive,
        instrument.cantilever.lever,
        LeverSpec::Calibrated,
        stiffness,
        unknown_calibration
    ),
    member!(
        "instrument.cantilever.frequency",
        "lever frequency, first mode",
        Frequency,
        Positive,
        instrument.cantilever.lever,
        LeverSpec::Calibrated,
        frequency,
        unknown_calibration
    ),
    mode!(
        "instrument.cantilever.modes.#.stiffness",
        "lever mode # stiffness",
        Stiffness,
        Positive,
        stiffness
    ),
    mode!(
        "instrument.cantilever.modes.#.frequency",
        "lever mode # frequency",
        Frequency,
        Positive,
        frequency
    ),
    mode!(
        "instrument.cantilever.modes.#.quality_factor",
        "lever mode # quality factor",
        Dimensionless,
        QualityFactor,
        quality_factor
    ),
    mode!("instrument.cantilever.modes.#.drive", "lever mode # relative drive", Dimensionless, Finite, drive),
    Quantity {
        path: "instrument.cantilever.quality_factor",
        long_name: "lever quality factor",
        dimension: Dimension::Dimensionless,
        domain: Domain::QualityFactor,
        get: |params, _| match params.instrument.cantilever.quality_factor {
            QualityFactor::All(value) => Some(value),
            QualityFactor::PerMode(_) => None,
        },
        set: |params, _, value| params.instrument.cantilever.quality_factor = QualityFactor::All(value),
    },
    Quantity {
        path: "instrument.cantilever.quality_factor.#",
        long_name: "lever mode # quality factor",
        dimension: Dimension::Dimensionless,
        domain: Domain::QualityFactor,
        get: |params, index| match &params.instrument.cantilever.quality_factor {
            QualityFactor::PerMode(values) => values.get(index).copied(),
            QualityFactor::All(_) => None,
        },
        set: |params, index, value| {
            if let QualityFactor::PerMode(values) = &mut params.instrument.cantilever.quality_factor
                && let Some(slot) = values.get_mut(index)
            {
                *slot = value;
            }
        },
    },
    field!("instrument.tip.half_length", "tip half length", Length, NonNegative, instrument.tip.half_length),
    member!(
        "instrument.tip.width",
        "tip width",
        Length,
        Positive,
        instrument.tip.mass,
        TipMass::Pyramid,
        width,
        table_tip
    ),
    member!(
        "instrument.tip.height",
        "tip height",
        Length,
        Positive,
        instrument.tip.mass,
        TipMass::Pyramid,
        height,
        table_tip
    ),
    member!(
        "instrument.tip.density",
        "tip density",
        Density,
        Positive,
        instrument.tip.mass,
        TipMass::Pyramid,
        density,
        table_tip
    ),
    variant!("instrument.tip.mass", "tip mass", Mass, NonNegative, instrument.tip.mass, TipMass::Given),
    field!("instrument.tip.radius", "tip radius", Length, Positive, instrument.tip.radius),
    field!(
        "instrument.tip.youngs_modulus",
        "tip Young's modulus",
        Pressure,
        PositiveOrInfinite,
        instrument.tip.youngs_modulus
    ),
    field!(
        "instrument.tip.poisson_ratio",
        "tip Poisson ratio",
        Dimensionless,
        PoissonRatio,
        instrument.tip.poisson_ratio
    ),
    field!("sample.youngs_modulus", "sample Young's modulus", Pressure, Positive, sample.youngs_modulus),
    field!("sample.poisson_ratio", "sample Poisson ratio", Dimensionless, PoissonRatio, sample.poisson_ratio),
    variant!(
        "sample.surface_energy",
        "work of adhesion",
        SurfaceEnergy,
        NonNegative,
        sample.adhesion,
        Adhesion::Work
    ),
    variant!("sample.hamaker", "Hamaker constant", Energy, NonNegative, sample.adhesion, Adhesion::Hamaker),
    field!("contact.decay_length", "decay length of the attraction", Length, Positive, contact.decay_length),
    variant!(
        "drive.frequency",
        "drive frequency",
        Frequency,
        Positive,
        drive.frequency,
        DriveFrequency::Hertz
    ),
    variant!("drive.voltage", "drive voltage", Voltage, NonNegative, drive.level, DriveLevel::Voltage),
    variant!(
        "drive.free_amplitude",
        "free tip amplitude",
        Length,
        NonNegative,
        drive.level,
        DriveLevel::FreeAmplitude
    ),
    variant!("drive.force", "drive force on the tip", Force, NonNegative, drive.level, DriveLevel::Force),
    variant!(
        "drive.base_amplitude",
        "base amplitude",
        Length,
        NonNegative,
        drive.level,
        DriveLevel::BaseAmplitude
    ),
    Quantity {
        path: "approach.gap",
        long_name: "gap between the tip at rest and the surface",
        dimension: Dimension::Length,
        domain: Domain::Finite,
        get: |params, _| params.approach.held.is_none().then_some(params.approach.gap),
        set: |params, _, value| (params.approach.gap, params.approach.held) = (value, None),
    },
    held!("approach.setpoint", "amplitude set-point", Dimensionless, SetPoint, Held::Amplitude),
    held!("approach.force_setpoint", "force set-point", Force, Positive, Held::Force),
    Quantity {
        path: "approach.deepest",
        long_name: "how far below the surface a set-point is looked for",
        dimension: Dimension::Length,
        domain: Domain::Positive,
        get: |params, _| params.approach.deepest,
        set: |params, _, value| params.approach.deepest = Some(value),
    },
];
