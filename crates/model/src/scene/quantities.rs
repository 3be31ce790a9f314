//! The closed table of a scene's quantities: path, dimension, domain, sizes, and their place in [`Params`].
//!
//! Reading, sweeping and the resolved echo all go through this table, so a quantity added here can be
//! written, swept and echoed at once. When it matters stands in `provenance.rs`.

use super::params::LeverSpec::{Calibrated, Dimensions};
use super::params::TipMass::{Given, Pyramid};
use super::params::*;
use super::quantity::{Access, Domain, Quantity};
use crate::units::Dimension;

/// A plain field.
macro_rules! field {
    ($($field:ident).+) => {
        Access { get: |params, _| Some(params.$($field).+), set: |params, _, value| params.$($field).+ = value }
    };
}

/// The one value of an enum's variant.
macro_rules! variant {
    ($($field:ident).+, $variant:path) => {
        Access {
            get: |params, _| if let $variant(value) = params.$($field).+ { Some(value) } else { None },
            set: |params, _, value| params.$($field).+ = $variant(value),
        }
    };
}

/// One of several values of an enum's variant; `$default` makes that variant.
macro_rules! member {
    ($($field:ident).+, $variant:path, $member:ident, $default:path) => {
        Access {
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

/// A value of one of the lever's listed modes.
macro_rules! mode {
    ($member:ident) => {
        Access {
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

/// What is held in place of the gap.
macro_rules! held {
    ($variant:path) => {
        Access {
            get: |params, _| match params.approach.held {
                Some($variant(value)) => Some(value),
                _ => None,
            },
            set: |params, _, value| params.approach.held = Some($variant(value)),
        }
    };
}

/// One of the listed quality factors of the lever.
const PER_MODE: Access = Access {
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
};
/// A value of one of the forces outside contact.
macro_rules! outside {
    ($variant:ident, $member:ident) => {
        Access {
            get: |params, index| match params.contact.outside.get(index) {
                Some(OutsideForce::$variant { $member, .. }) => Some(*$member),
                _ => None,
            },
            set: |params, index, value| {
                if let Some(OutsideForce::$variant { $member, .. }) = params.contact.outside.get_mut(index) {
                    *$member = value;
                }
            },
        }
    };
}

/// The cone behind a charged tip.
macro_rules! cone {
    ($member:ident) => {
        Access {
            get: |params, index| match params.contact.outside.get(index) {
                Some(OutsideForce::Electrostatic { cone: Some(cone), .. }) => {
                    Some(cone.$member).filter(|value| !value.is_nan())
                }
                _ => None,
            },
            set: |params, index, value| {
                if let Some(OutsideForce::Electrostatic { cone, .. }) = params.contact.outside.get_mut(index)
                {
                    let unknown = TipCone { half_angle: f64::NAN, height: f64::NAN };
                    cone.get_or_insert(unknown).$member = value;
                }
            },
        }
    };
}

/// Hydration's pressure, which stands in place of its strength.
const PRESSURE: Access = Access {
    get: |params, index| match params.contact.outside.get(index) {
        Some(OutsideForce::Hydration { strength: HydrationStrength::Pressure(value), .. }) => Some(*value),
        _ => None,
    },
    set: |params, index, value| {
        if let Some(OutsideForce::Hydration { strength, .. }) = params.contact.outside.get_mut(index) {
            *strength = HydrationStrength::Pressure(value);
        }
    },
};
/// The force at touch of hydration, or of a liquid neck.
const STRENGTH: Access = Access {
    get: |params, index| match params.contact.outside.get(index) {
        Some(OutsideForce::Hydration { strength: HydrationStrength::Force(value), .. }) => Some(*value),
        Some(OutsideForce::Capillary { strength, .. }) => Some(*strength),
        _ => None,
    },
    set: |params, index, value| match params.contact.outside.get_mut(index) {
        Some(OutsideForce::Hydration { strength, .. }) => *strength = HydrationStrength::Force(value),
        Some(OutsideForce::Capillary { strength, .. }) => *strength = value,
        _ => {}
    },
};
/// The decay length of hydration, or of a liquid neck that has one of its own.
const DECAY: Access = Access {
    get: |params, index| match params.contact.outside.get(index) {
        Some(OutsideForce::Hydration { decay_length, .. }) => Some(*decay_length),
        Some(OutsideForce::Capillary { decay_length, .. }) => *decay_length,
        _ => None,
    },
    set: |params, index, value| match params.contact.outside.get_mut(index) {
        Some(OutsideForce::Hydration { decay_length, .. }) => *decay_length = value,
        Some(OutsideForce::Capillary { decay_length, .. }) => *decay_length = Some(value),
        _ => {}
    },
};

const PERIOD: Access = Access {
    get: |params, index| match params.contact.outside.get(index) {
        Some(OutsideForce::Hydration { period, .. }) => *period,
        _ => None,
    },
    set: |params, index, value| {
        if let Some(OutsideForce::Hydration { period, .. }) = params.contact.outside.get_mut(index) {
            *period = Some(value);
        }
    },
};
const GAP: Access = Access {
    get: |params, _| params.approach.held.is_none().then_some(params.approach.gap),
    set: |params, _, value| (params.approach.gap, params.approach.held) = (value, None),
};
const TIP_ANGLE: Access = Access {
    get: |params, _| params.instrument.tip.half_angle,
    set: |params, _, value| params.instrument.tip.half_angle = Some(value),
};
const THICKNESS: Access = Access {
    get: |params, _| params.sample.thickness,
    set: |params, _, value| params.sample.thickness = Some(value),
};
const DEEPEST: Access = Access {
    get: |params, _| params.approach.deepest,
    set: |params, _, value| params.approach.deepest = Some(value),
};

fn table_lever() -> LeverSpec {
    CantileverParams::default().lever
}

fn table_tip() -> TipMass {
    TipParams::default().mass
}

/// Both values must be given, so neither has a default that could pass for one.
fn unknown_calibration() -> LeverSpec {
    Calibrated { stiffness: f64::NAN, frequency: f64::NAN }
}

fn unknown_relaxation() -> Viscosity {
    Viscosity::Relaxing { modulus: f64::NAN, time: f64::NAN }
}

/// Lengths of solid parts, m.
const PARTS: [f64; 2] = [1e-11, 0.1];
/// Lengths of levers, m, and of rods.
const LEVERS: [f64; 2] = [1e-11, 1.0];
const RODS: [f64; 2] = [1e-9, 1e3];
/// How far a tip, its base and its gap go, m.
const PATHS: [f64; 2] = [1e-21, 0.1];
/// Moduli, Pa: a hundred times a diamond's, so that a part can be as good as rigid; and less than any gel has.
const MODULI: [f64; 2] = [1e-2, 1e14];
const DENSITIES: [f64; 2] = [1.0, 1e5];
const FREQUENCIES: [f64; 2] = [1e-4, 1e11];
const QUALITIES: [f64; 2] = [0.5, 1e12];
const ANY: [f64; 2] = [0.0, f64::INFINITY];

macro_rules! quantities {
    ($($path:literal, $access:expr, $long_name:literal, $dimension:ident, $domain:ident, $usual:expr, $possible:expr;)*) => {
        /// Every quantity of a scene, in the order the resolved scene writes them.
        pub static QUANTITIES: &[Quantity] = &[$(Quantity {
            path: $path,
            access: $access,
            long_name: $long_name,
            dimension: Dimension::$dimension,
            domain: Domain::$domain,
            usual: $usual,
            possible: $possible,
        }),*];
    };
}

// Of a drive's frequency and force the right size depends on the lever.
quantities! {
    "instrument.actuator.youngs_modulus", field!(instrument.actuator.youngs_modulus),
        "rod Young's modulus", Pressure, Positive, [1e8, 1e12], MODULI;
    "instrument.actuator.density", field!(instrument.actuator.density),
        "rod density", Density, Positive, [100.0, 3e4], DENSITIES;
    "instrument.actuator.h33", field!(instrument.actuator.h33),
        "rod piezoelectric constant h33", ElectricField, Positive, [1e6, 1e11], [1e3, 1e14];
    "instrument.actuator.beta33", field!(instrument.actuator.beta33),
        "rod inverse permittivity beta33", InversePermittivity, Positive, [1e5, 1e12], [1e2, 1e15];
    "instrument.actuator.length", field!(instrument.actuator.length),
        "rod length", Length, Positive, [1e-6, 1.0], RODS;
    "instrument.actuator.width", field!(instrument.actuator.width),
        "rod width", Length, Positive, [1e-6, 1.0], RODS;
    "instrument.actuator.thickness", field!(instrument.actuator.thickness),
        "rod thickness", Length, Positive, [1e-6, 1.0], RODS;
    "instrument.actuator.quality_factor", field!(instrument.actuator.quality_factor),
        "rod quality factor", Dimensionless, QualityFactor, [0.5, 1e7], QUALITIES;
    "instrument.cantilever.youngs_modulus", member!(instrument.cantilever.lever, Dimensions, youngs_modulus, table_lever),
        "lever Young's modulus", Pressure, Positive, [1e6, 2e12], MODULI;
    "instrument.cantilever.density", member!(instrument.cantilever.lever, Dimensions, density, table_lever),
        "lever density", Density, Positive, [100.0, 3e4], DENSITIES;
    "instrument.cantilever.length", member!(instrument.cantilever.lever, Dimensions, length, table_lever),
        "lever length", Length, Positive, [1e-7, 1e-2], LEVERS;
    "instrument.cantilever.width", member!(instrument.cantilever.lever, Dimensions, width, table_lever),
        "lever width", Length, Positive, [1e-8, 1e-2], LEVERS;
    "instrument.cantilever.thickness", member!(instrument.cantilever.lever, Dimensions, thickness, table_lever),
        "lever thickness", Length, Positive, [1e-10, 1e-3], LEVERS;
    "instrument.cantilever.stiffness", member!(instrument.cantilever.lever, Calibrated, stiffness, unknown_calibration),
        "lever stiffness, first mode", Stiffness, Positive, [1e-5, 1e5], [1e-7, 5e6];
    "instrument.cantilever.frequency", member!(instrument.cantilever.lever, Calibrated, frequency, unknown_calibration),
        "lever frequency, first mode", Frequency, Positive, [10.0, 1e9], FREQUENCIES;
    "instrument.cantilever.modes.#.stiffness", mode!(stiffness),
        "lever mode # stiffness", Stiffness, Positive, [1e-5, 1e7], [1e-7, 5e8];
    "instrument.cantilever.modes.#.frequency", mode!(frequency),
        "lever mode # frequency", Frequency, Positive, [10.0, 1e10], FREQUENCIES;
    "instrument.cantilever.modes.#.quality_factor", mode!(quality_factor),
        "lever mode # quality factor", Dimensionless, QualityFactor, [0.5, 1e7], QUALITIES;
    "instrument.cantilever.modes.#.drive", mode!(drive),
        "lever mode # relative drive", Dimensionless, Finite, [1e-6, 1e6], ANY;
    "instrument.cantilever.quality_factor", variant!(instrument.cantilever.quality_factor, QualityFactor::All),
        "lever quality factor", Dimensionless, QualityFactor, [0.5, 1e7], QUALITIES;
    "instrument.cantilever.quality_factor.#", PER_MODE,
        "lever mode # quality factor", Dimensionless, QualityFactor, [0.5, 1e7], QUALITIES;
    "instrument.tip.half_length", field!(instrument.tip.half_length),
        "tip half length", Length, NonNegative, [1e-9, 1e-3], PARTS;
    "instrument.tip.width", member!(instrument.tip.mass, Pyramid, width, table_tip),
        "tip width", Length, Positive, [1e-9, 1e-3], PARTS;
    "instrument.tip.height", member!(instrument.tip.mass, Pyramid, height, table_tip),
        "tip height", Length, Positive, [1e-9, 1e-3], PARTS;
    "instrument.tip.density", member!(instrument.tip.mass, Pyramid, density, table_tip),
        "tip density", Density, Positive, [100.0, 3e4], DENSITIES;
    "instrument.tip.mass", variant!(instrument.tip.mass, Given),
        "tip mass", Mass, NonNegative, [1e-21, 1e-7], [1e-24, 1e-6];
    "instrument.tip.radius", field!(instrument.tip.radius),
        "tip radius", Length, Positive, [1e-10, 1e-3], PARTS;
    "instrument.tip.half_angle", TIP_ANGLE,
        "half-angle of the tip", Angle, HalfAngle, [3.0, 89.0], [1e-3, 90.0];
    "instrument.tip.youngs_modulus", field!(instrument.tip.youngs_modulus),
        "tip Young's modulus", Pressure, PositiveOrInfinite, [1e3, 2e12], MODULI;
    "instrument.tip.poisson_ratio", field!(instrument.tip.poisson_ratio),
        "tip Poisson ratio", Dimensionless, PoissonRatio, [0.0, 0.5], ANY;
    "sample.youngs_modulus", field!(sample.youngs_modulus),
        "sample Young's modulus", Pressure, Positive, [10.0, 2e12], MODULI;
    "sample.poisson_ratio", field!(sample.poisson_ratio),
        "sample Poisson ratio", Dimensionless, PoissonRatio, [0.0, 0.5], ANY;
    "sample.surface_energy", variant!(sample.adhesion, Adhesion::Work),
        "work of adhesion", SurfaceEnergy, NonNegative, [1e-9, 10.0], [1e-15, 1e3];
    "sample.hamaker", variant!(sample.adhesion, Adhesion::Hamaker),
        "Hamaker constant", Energy, NonNegative, [1e-24, 1e-17], [1e-27, 1e-14];
    "sample.viscosity", variant!(sample.viscosity, Viscosity::Shear),
        "sample shear viscosity", Viscosity, NonNegative, [1e-6, 1e9], [1e-9, 1e12];
    "sample.retardation_time", variant!(sample.viscosity, Viscosity::RetardationTime),
        "sample retardation time", Time, NonNegative, [1e-13, 10.0], [1e-18, 1e6];
    "sample.loss_tangent", variant!(sample.viscosity, Viscosity::LossTangent),
        "sample loss tangent at the drive's frequency", Dimensionless, NonNegative, [1e-6, 100.0], [1e-12, 1e6];
    "sample.instantaneous_modulus", member!(sample.viscosity, Viscosity::Relaxing, modulus, unknown_relaxation),
        "sample Young's modulus before it relaxes", Pressure, Positive, [10.0, 2e12], MODULI;
    "sample.relaxation_time", member!(sample.viscosity, Viscosity::Relaxing, time, unknown_relaxation),
        "sample relaxation time", Time, Positive, [1e-13, 10.0], [1e-18, 1e6];
    "sample.thickness", THICKNESS,
        "thickness of a layer on a rigid ground", Length, Positive, [1e-9, 1e-3], PARTS;
    "contact.decay_length", field!(contact.decay_length),
        "decay length of the attraction", Length, Positive, [1e-12, 1e-8], [1e-16, 1e-6];
    "contact.outside.#.bias", outside!(Electrostatic, bias),
        "force # bias", Voltage, Finite, [1e-3, 100.0], [1e-9, 1e4];
    "contact.outside.#.contact_potential", outside!(Electrostatic, contact_potential),
        "force # contact potential", Voltage, Finite, [1e-3, 10.0], [1e-9, 1e4];
    "contact.outside.#.cut_off", outside!(Electrostatic, cut_off),
        "force # distance of the charges at touch", Length, Positive, [1e-11, 1e-7], [1e-13, 1e-3];
    "contact.outside.#.cone_half_angle", cone!(half_angle),
        "force # angle of the cone's side to its axis", Angle, Positive, [5.0, 45.0], [1.0, 80.0];
    "contact.outside.#.cone_height", cone!(height),
        "force # height of the cone", Length, Positive, [1e-6, 1e-4], [1e-9, 1e-2];
    "contact.outside.#.tip_charge", outside!(DoubleLayer, tip_charge),
        "force # charge of the tip per area", SurfaceCharge, Finite, [1e-6, 1.0], [1e-9, 100.0];
    "contact.outside.#.sample_charge", outside!(DoubleLayer, sample_charge),
        "force # charge of the sample per area", SurfaceCharge, Finite, [1e-6, 1.0], [1e-9, 100.0];
    "contact.outside.#.screening_length", outside!(DoubleLayer, screening_length),
        "force # Debye length", Length, Positive, [1e-10, 1e-6], [1e-12, 1e-4];
    "contact.outside.#.permittivity", outside!(DoubleLayer, permittivity),
        "force # relative permittivity", Dimensionless, Positive, [1.0, 200.0], [0.1, 1e4];
    "contact.outside.#.pressure", PRESSURE,
        "force # pressure between flat walls at touch", Pressure, Finite, [1e3, 1e10], [1.0, 1e13];
    "contact.outside.#.strength", STRENGTH,
        "force # at touch", Force, Finite, [1e-13, 1e-6], [1e-17, 1e-2];
    "contact.outside.#.decay_length", DECAY,
        "force # decay length", Length, Positive, [1e-11, 1e-7], [1e-13, 1e-4];
    "contact.outside.#.forms_at", outside!(Capillary, forms_at),
        "force # distance where the neck forms", Length, NonNegative, [1e-11, 1e-6], [1e-13, 1e-3];
    "contact.outside.#.breaks_at", outside!(Capillary, breaks_at),
        "force # distance where the neck breaks", Length, Positive, [1e-11, 1e-6], [1e-13, 1e-3];
    "contact.outside.#.period", PERIOD,
        "force # period", Length, Positive, [1e-11, 1e-7], [1e-13, 1e-4];
    "contact.outside.#.phase", outside!(Hydration, phase),
        "force # phase at touch", Angle, Finite, [1e-3, 360.0], [1e-9, 1e6];
    "drive.frequency", variant!(drive.frequency, DriveFrequency::Hertz),
        "drive frequency", Frequency, Positive, [0.1, 1e9], FREQUENCIES;
    "drive.voltage", variant!(drive.level, DriveLevel::Voltage),
        "drive voltage", Voltage, NonNegative, [1e-9, 1e4], [1e-12, 1e6];
    "drive.free_amplitude", variant!(drive.level, DriveLevel::FreeAmplitude),
        "free tip amplitude", Length, NonNegative, [1e-15, 1e-3], PATHS;
    "drive.force", variant!(drive.level, DriveLevel::Force),
        "drive force on the tip", Force, NonNegative, [1e-18, 1e-2], [1e-21, 0.1];
    "drive.base_amplitude", variant!(drive.level, DriveLevel::BaseAmplitude),
        "base amplitude", Length, NonNegative, [1e-18, 1e-3], PATHS;
    "approach.gap", GAP, "gap between the tip at rest and the surface", Length, Finite, [0.0, 1e-3], PATHS;
    "approach.setpoint", held!(Held::Amplitude),
        "amplitude set-point", Dimensionless, SetPoint, [0.05, 360.0], ANY;
    "approach.force_setpoint", held!(Held::Force),
        "force set-point", Force, Positive, [1e-14, 1e-3], [1e-17, 1e-2];
    "approach.deepest", DEEPEST,
        "how far below the surface a set-point is looked for", Length, Positive, [1e-12, 1e-3], PATHS;
}
