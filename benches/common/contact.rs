//! Contacts beside those that are a law alone, each with the quantities that are its own and where they lie.

/// One of them: lines of a scene, and random quantities by path, unit, ends, and what they are parts of.
#[derive(Clone, Copy, Debug)]
pub struct Contact<'a> {
    pub word: &'a str,
    pub law: &'a str,
    /// Lines of `[instrument.tip]` and of `[contact]`.
    pub tip: &'static str,
    pub beside: &'static str,
    pub own: &'static [Own],
}

type Own = (&'static str, &'static str, [f64; 2], Of);

/// What a random number is multiplied by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    Itself,
    /// 1 over the drive's angular frequency.
    Turn,
    Radius,
    Modulus,
    /// The quantity listed before it.
    Before,
}

impl<'a> Contact<'a> {
    /// A law alone.
    pub const fn alone(law: &'a str) -> Self {
        Self { word: law, law, tip: "", beside: "", own: &[] }
    }

    /// By its word; one that is not listed is a law alone.
    pub fn named(word: &'a str) -> Self {
        CONTACTS.into_iter().find(|contact| contact.word == word).unwrap_or(Self::alone(word))
    }

    /// Whether the sample has a time of its own.
    pub fn loses(&self) -> bool {
        self.own.iter().any(|(.., of)| *of == Of::Turn)
    }

    /// Whether the tip ends in a point, which has no radius.
    pub fn pointed(&self) -> bool {
        [r#""cone""#, r#""pyramid""#].iter().any(|shape| self.tip.contains(shape))
    }
}

const JKR: Contact<'static> = Contact::alone("jkr");
const HERTZ: Contact<'static> = Contact::alone("hertz");
const DMT: Contact<'static> = Contact::alone("dmt");

const RETARDATION: Own = ("sample.retardation_time", "s", [0.01, 5.0], Of::Turn);
const RELAXATION: [Own; 2] = [
    ("sample.relaxation_time", "s", [0.01, 5.0], Of::Turn),
    ("sample.instantaneous_modulus", "Pa", [1.1, 10.0], Of::Modulus),
];
const THICKNESS: Own = ("sample.thickness", "m", [0.5, 50.0], Of::Radius);
const ANGLE: Own = ("instrument.tip.half_angle", "deg", [10.0, 70.0], Of::Itself);
const VOLTS: [Own; 2] = [
    ("contact.outside.0.bias", "V", [0.1, 5.0], Of::Itself),
    ("contact.outside.0.cut_off", "m", [3e-10, 3e-9], Of::Itself),
];
const NECK: [Own; 3] = [
    ("contact.outside.0.strength", "N", [1e-9, 3e-8], Of::Itself),
    ("contact.outside.0.forms_at", "m", [1e-10, 1e-9], Of::Itself),
    ("contact.outside.0.breaks_at", "m", [1.2, 8.0], Of::Before),
];
/// The first value of what is listed stands here, for a section has to have it.
const CHARGES: &str = r#"[[contact.outside]]
force = "electrostatic"
bias = "1 V"
cut_off = "1 nm"
"#;
const CONE: &str = r#"[[contact.outside]]
force = "electrostatic"
bias = "1 V"
cut_off = "1 nm"
cone_half_angle = "20 deg"
cone_height = "12 um"
"#;
const DOUBLE_LAYER: &str = r#"[[contact.outside]]
force = "double-layer"
tip_charge = "-4 mC/m^2"
sample_charge = "-4 mC/m^2"
screening_length = "3 nm"
"#;
const HYDRATION: &str = r#"[[contact.outside]]
force = "hydration"
pressure = "2 MPa"
decay_length = "0.6 nm"
"#;
const INVERSE_SQUARE: &str = r#"[[contact.outside]]
force = "capillary"
strength = "10 nN"
forms_at = "0.6 nm"
breaks_at = "2 nm"
"#;
const LINEAR: &str = r#"[[contact.outside]]
force = "capillary"
model = "linear"
strength = "10 nN"
forms_at = "0.6 nm"
breaks_at = "2 nm"
"#;
const TABLE: &str = r#"table = { distance = ["6 nm", "3 nm", "1.5 nm", "0.8 nm", "0.4 nm", "0 nm", "-1 nm", "-3 nm"], force = ["0 nN", "-0.1 nN", "-0.6 nN", "-2 nN", "-5 nN", "-6 nN", "30 nN", "150 nN"] }
"#;
const RETRACT: &str = r#"table = { distance = ["6 nm", "3 nm", "1.5 nm", "0.8 nm", "0.4 nm", "0 nm", "-1 nm", "-3 nm"], force = ["0 nN", "-0.1 nN", "-0.6 nN", "-2 nN", "-5 nN", "-6 nN", "30 nN", "150 nN"], force_retract = ["0 nN", "-0.4 nN", "-1.5 nN", "-4 nN", "-8 nN", "-9 nN", "29 nN", "150 nN"] }
"#;

/// All of them.
pub const CONTACTS: [Contact<'static>; 24] = [
    Contact { word: "hertz-viscous", own: &[RETARDATION], ..HERTZ },
    Contact { word: "dmt-viscous", own: &[RETARDATION], ..DMT },
    Contact { word: "ad-hoc", own: &[RETARDATION], beside: "viscosity_model = \"ad-hoc\"\n", ..DMT },
    Contact { word: "hertz-relaxing", own: &RELAXATION, ..HERTZ },
    Contact { word: "sphere", tip: r#"shape = "sphere""#, ..HERTZ },
    Contact { word: "sphere-dmt", tip: r#"shape = "sphere""#, ..DMT },
    Contact { word: "cone", tip: r#"shape = "cone""#, own: &[ANGLE], ..HERTZ },
    Contact { word: "pyramid", tip: r#"shape = "pyramid""#, own: &[ANGLE], ..HERTZ },
    Contact { word: "punch", tip: r#"shape = "punch""#, ..HERTZ },
    Contact { word: "hyperboloid", tip: r#"shape = "hyperboloid""#, own: &[ANGLE], ..HERTZ },
    Contact { word: "sphero-cone", tip: r#"shape = "sphero-cone""#, own: &[ANGLE], ..HERTZ },
    Contact { word: "layer", own: &[THICKNESS], ..HERTZ },
    Contact { word: "dmt with charges", beside: CHARGES, own: &VOLTS, ..DMT },
    // Each cut-off and radius makes a table, of which a scene has a thousand.
    Contact { word: "hertz with a charged cone", beside: CONE, own: &[VOLTS[0]], ..HERTZ },
    Contact {
        word: "dmt with a double layer",
        beside: DOUBLE_LAYER,
        own: &[("contact.outside.0.screening_length", "m", [5e-10, 2e-8], Of::Itself)],
        ..DMT
    },
    Contact {
        word: "hertz with hydration",
        beside: HYDRATION,
        own: &[
            ("contact.outside.0.pressure", "Pa", [1e5, 1e8], Of::Itself),
            ("contact.outside.0.decay_length", "m", [2e-10, 1e-9], Of::Itself),
        ],
        ..HERTZ
    },
    Contact { word: "hertz with a neck", beside: INVERSE_SQUARE, own: &NECK, ..HERTZ },
    Contact { word: "dmt with a linear neck", beside: LINEAR, own: &NECK, ..DMT },
    Contact { word: "jkr with charges", beside: CHARGES, own: &VOLTS, ..JKR },
    Contact {
        word: "dmt-viscous with charges",
        beside: CHARGES,
        own: &[RETARDATION, VOLTS[0], VOLTS[1]],
        ..DMT
    },
    Contact { word: "dmt-relaxing", own: &RELAXATION, ..DMT },
    Contact {
        word: "hertz-relaxing with charges",
        beside: CHARGES,
        own: &[RELAXATION[0], RELAXATION[1], VOLTS[0], VOLTS[1]],
        ..HERTZ
    },
    Contact { word: "table", law: "table", beside: TABLE, ..HERTZ },
    Contact { word: "table with a way out", law: "table", beside: RETRACT, ..HERTZ },
];
