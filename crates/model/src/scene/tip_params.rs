//! The tip: its mass, and what it looks like where it touches.

/// The rigid tip at the lever's end (Table 1, third column) and its apex.
#[derive(Clone, Debug, PartialEq)]
pub struct TipParams {
    /// Distance l from the lever's end to the tip's centre, m.
    pub half_length: f64,
    pub mass: TipMass,
    /// What it looks like where it touches.
    pub shape: TipShape,
    /// Half-angle of a shape that has one, degree.
    pub half_angle: Option<f64>,
    /// Radius R of the apex, of the sphere, or of the punch's face, m.
    pub radius: f64,
    /// Pa; infinite means rigid (the paper does not give it).
    pub youngs_modulus: f64,
    pub poisson_ratio: f64,
}

/// From the list of shapes: the word in `instrument.tip.shape`, how the tip ends, whether it has a half-angle.
macro_rules! tip_shapes {
    ($($(#[$doc:meta])* $shape:ident, $word:literal, $end:ident, $angle:literal;)*) => {
        /// What the tip looks like where it touches.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
        pub enum TipShape {
            #[default]
            $($(#[$doc])* $shape,)*
        }

        impl TipShape {
            /// Keywords of `instrument.tip.shape`.
            pub(super) const WORDS: &[(&str, Self)] = &[$(($word, Self::$shape),)*];

            /// How it ends.
            pub fn end(self) -> TipEnd {
                match self { $(Self::$shape => TipEnd::$end,)* }
            }

            /// Whether a half-angle belongs to what describes it.
            pub fn has_angle(self) -> bool {
                match self { $(Self::$shape => $angle,)* }
            }
        }
    };
}

/// How a tip ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TipEnd {
    /// With an apex that has a radius; forces in proportion to the radius act on it.
    Round,
    /// With a face that has a radius.
    Flat,
    /// In a point.
    Point,
}

tip_shapes! {
    /// A paraboloid of revolution: a sphere while the indentation is small beside it.
    Paraboloid, "paraboloid", Round, false;
    Sphere, "sphere", Round, false;
    Cone, "cone", Point, true;
    /// Four-sided.
    Pyramid, "pyramid", Point, true;
    /// With a flat round face.
    Punch, "punch", Flat, false;
    /// A cone whose end is rounded: a hyperboloid of revolution.
    Hyperboloid, "hyperboloid", Round, true;
    /// A cone with a spherical cap.
    SpheroCone, "sphero-cone", Round, true;
}

impl TipShape {
    /// Whether a radius belongs to what describes it.
    pub fn has_radius(self) -> bool {
        self.end() != TipEnd::Point
    }

    /// The words of these shapes in a sentence: "cone, pyramid or punch".
    pub(super) fn listed(are: impl Fn(Self) -> bool) -> String {
        let words: Vec<_> =
            Self::WORDS.iter().filter(|(_, shape)| are(*shape)).map(|(word, _)| *word).collect();
        match words.as_slice() {
            [first @ .., last] if !first.is_empty() => format!("{} or {last}", first.join(", ")),
            _ => words.concat(),
        }
    }
}

/// The tip's mass: given, or that of a pyramid of base `2 half_length` x `width`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TipMass {
    /// kg
    Given(f64),
    /// Width and height in m, density in kg/m^3.
    Pyramid { width: f64, height: f64, density: f64 },
}

impl Default for TipParams {
    fn default() -> Self {
        Self {
            half_length: 5e-6,
            mass: TipMass::Pyramid { width: 10e-6, height: 10e-6, density: 2500.0 },
            shape: TipShape::Paraboloid,
            half_angle: None,
            radius: 30e-9,
            youngs_modulus: f64::INFINITY,
            poisson_ratio: 0.28,
        }
    }
}
