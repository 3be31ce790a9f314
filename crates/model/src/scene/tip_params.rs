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

/// What the tip looks like where it touches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TipShape {
    /// A paraboloid of revolution: a sphere while the indentation is small beside it.
    #[default]
    Paraboloid,
    Sphere,
    Cone,
    /// Four-sided.
    Pyramid,
    /// With a flat round face.
    Punch,
    /// A cone whose end is rounded: a hyperboloid of revolution.
    Hyperboloid,
    /// A cone with a spherical cap.
    SpheroCone,
}

impl TipShape {
    /// Keywords of `instrument.tip.shape`.
    pub(super) const WORDS: [(&str, Self); 7] = [
        ("paraboloid", Self::Paraboloid),
        ("sphere", Self::Sphere),
        ("cone", Self::Cone),
        ("pyramid", Self::Pyramid),
        ("punch", Self::Punch),
        ("hyperboloid", Self::Hyperboloid),
        ("sphero-cone", Self::SpheroCone),
    ];

    /// Whether a half-angle belongs to what describes it.
    pub fn has_angle(self) -> bool {
        matches!(self, Self::Cone | Self::Pyramid | Self::Hyperboloid | Self::SpheroCone)
    }

    /// Whether a radius does.
    pub fn has_radius(self) -> bool {
        !matches!(self, Self::Cone | Self::Pyramid)
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
