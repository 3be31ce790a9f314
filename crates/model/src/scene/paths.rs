//! Paths of quantities that rules speak of, and what they say.

pub(super) const MODES: &str = "instrument.cantilever.modes";

pub(super) const CALIBRATION: [&str; 2] =
    ["instrument.cantilever.stiffness", "instrument.cantilever.frequency"];

pub(super) const LEVELS: [&str; 4] =
    ["drive.voltage", "drive.free_amplitude", "drive.force", "drive.base_amplitude"];

/// How to have the rod that such a lever does not have by itself.
pub(super) const NAME_ROD: &str = "name the preset's rod by preset = \"ha-fung-chen-2005\" in [instrument]";

/// What makes a sample viscous, and the choice of its contact.
pub(super) const VISCOSITIES: [&str; 3] =
    ["sample.viscosity", "sample.retardation_time", "sample.loss_tangent"];
pub(super) const VISCOSITY_MODEL: &str = "contact.viscosity_model";

/// What makes a sample relax: both together.
pub(super) const RELAXATION: [&str; 2] = ["sample.instantaneous_modulus", "sample.relaxation_time"];

/// The shape of the tip, and what describes a cone or a pyramid.
pub(super) const TIP_SHAPE: &str = "instrument.tip.shape";
pub(super) const HALF_ANGLE: &str = "instrument.tip.half_angle";

/// The thickness of a layer, and whether it is bonded to its ground.
pub(super) const THICKNESS: &str = "sample.thickness";
pub(super) const BONDED: &str = "sample.bonded";

/// The path of the contact law.
pub(super) const LAW: &str = "contact.law";
