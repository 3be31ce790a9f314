//! Contact forces written down afresh, each with its memory and the places where it is not smooth.

use std::f64::consts::PI;

/// SI; `k` is the combined modulus K, `r` the tip radius, `w` the work of adhesion.
#[derive(Clone, Copy, Debug)]
pub enum Law {
    None,
    Hertz {
        k: f64,
        r: f64,
    },
    Dmt {
        k: f64,
        r: f64,
        w: f64,
        d0: f64,
    },
    Jkr {
        k: f64,
        r: f64,
        w: f64,
    },
    /// JKR's contact with forces beside it, which keep their value at touch inside; while its neck holds a tip that is out of the
    /// surface they go by the distance.
    JkrBeside {
        k: f64,
        r: f64,
        w: f64,
        outside: [Outside; 4],
    },
    /// `e` is the plane-strain modulus E*, `pull` DMT's attraction in N with its decay length `d0`.
    Indenter {
        e: f64,
        tip: Tip,
        pull: f64,
        d0: f64,
    },
    /// The same with forces beside it, which keep their value at touch inside.
    Beside {
        e: f64,
        tip: Tip,
        pull: f64,
        d0: f64,
        outside: [Outside; 4],
        neck: Option<Neck>,
    },
}

/// The last of the forces outside acts from the indentation `forms`, once the tip has come so near, to `breaks`, once it has gone
/// so far.
#[derive(Clone, Copy, Debug)]
pub struct Neck {
    pub forms: f64,
    pub breaks: f64,
    /// Whether it acts now.
    pub acts: bool,
}

/// The one charged tip of the tests with a cone: bias (V), cut-off, radius of the tip (m), half-angle (degree), height (m).
pub const CHARGED_CONE: [f64; 5] = [3.0, 0.4e-9, 15e-9, 14.0, 12e-6];

/// A force at a distance D: `at_touch` (N) times exp(-D/length), that times a cosine, 1/(1 + D/length), that squared, or 1 - D/length.
#[derive(Clone, Copy, Debug)]
pub enum Outside {
    None,
    Decay {
        at_touch: f64,
        length: f64,
    },
    Wave {
        strength: f64,
        length: f64,
        period: f64,
        phase: f64,
    },
    Inverse {
        at_touch: f64,
        length: f64,
    },
    /// The cone of a charged tip: Hudlet and others (1998), less the part of its round end that [`Outside::Inverse`] has.
    Cone,
    InverseSquare {
        at_touch: f64,
        length: f64,
    },
    Straight {
        at_touch: f64,
        length: f64,
    },
}

impl Outside {
    /// Continued smoothly past touch where the tip is not in contact.
    fn force(self, d: f64, touch: bool) -> f64 {
        let away = if touch { 0.0 } else { -d };
        match self {
            Outside::None => 0.0,
            Outside::Decay { at_touch, length } => at_touch * (-away / length).exp(),
            Outside::Wave { strength, length, period, phase } => {
                strength * (-away / length).exp() * (2.0 * PI * away / period + phase).cos()
            }
            Outside::Inverse { at_touch, length } => at_touch / (1.0 + away.max(-0.5 * length) / length),
            Outside::Cone => {
                let [potential, cut_off, r, half_angle, height] = CHARGED_CONE;
                let half_angle = half_angle.to_radians();
                let z = away + cut_off;
                let (sine, cosine) = half_angle.sin_cos();
                let a = z + r * (1.0 - sine);
                let log = (half_angle / 2.0).tan().ln();
                // The whole force, less pi eps0 V^2 R/z.
                let apex = r * r * (1.0 - sine) / (z * a) - r / z;
                let cone = ((height / a).ln() - 1.0 + r * cosine * cosine / (sine * a)) / (log * log);
                -PI * 8.854_187_812_8e-12 * potential * potential * (apex + cone)
            }
            Outside::InverseSquare { at_touch, length } => {
                at_touch / (1.0 + away.max(-0.5 * length) / length).powi(2)
            }
            Outside::Straight { at_touch, length } => at_touch * (1.0 - away / length),
        }
    }
}

/// A rigid tip on an elastic half-space, by the method of dimensionality reduction: springs side by side under a profile g(x),
/// f = 2 E* times the integral of `d - g(x)` from the axis to the contact radius a, where g(a) = d.
#[derive(Clone, Copy, Debug)]
pub enum Tip {
    /// g = x atanh(x/R)
    Sphere { r: f64 },
    /// g = pi x/(2 tan(alpha))
    Cone { tangent: f64 },
    /// g = x^2/R
    Paraboloid { r: f64 },
    /// No axis: a cone of the force that Bilodeau (1992) gives.
    Pyramid { tangent: f64 },
    /// g = 0 up to its radius
    Punch { r: f64 },
    /// On a layer: the sum of c_n d^(n/2), n from 2 on, that is the program's model of it
    Layer { terms: [f64; 10] },
    /// g = x^2/R up to b = R cos(alpha), then x (x - sqrt(x^2 - b^2))/R + x acos(b/x)/tan(alpha)
    SpheroCone { r: f64, tangent: f64 },
    /// g = (A/R) x atan(x/A), A = R/tan(alpha)
    Hyperboloid { r: f64, tangent: f64 },
}

impl Tip {
    fn force(self, e: f64, d: f64) -> f64 {
        match self {
            Tip::Sphere { .. } if d == 0.0 => 0.0,
            Tip::Sphere { r } => {
                let (mut a, depth) = ((r * d).sqrt().min(0.999 * r), d / r);
                for _ in 0..80 {
                    let x = a / r;
                    let next = a - r * (x * x.atanh() - depth) / (x.atanh() + x / (1.0 - x * x));
                    let next = next.clamp(0.1 * a, 0.5 * (a + r));
                    let done = (next - a).abs() < 1e-15 * a;
                    a = next;
                    if done {
                        break;
                    }
                }
                let under = 0.5 * ((a * a - r * r) * (a / r).atanh() + a * r);
                2.0 * e * (a * d - under)
            }
            Tip::Paraboloid { r } => {
                let a = (r * d).sqrt();
                2.0 * e * (a * d - a.powi(3) / (3.0 * r))
            }
            Tip::Cone { tangent } => {
                let a = 2.0 / PI * tangent * d;
                2.0 * e * (a * d - PI / (4.0 * tangent) * a * a)
            }
            Tip::Pyramid { tangent } => Tip::Cone { tangent: 0.7453 * PI / 2.0 * tangent }.force(e, d),
            Tip::Punch { r } => 2.0 * e * r * d,
            Tip::Layer { terms } => {
                let root = d.sqrt();
                d * terms.iter().rev().fold(0.0, |sum, term| sum * root + term)
            }
            Tip::SpheroCone { r, tangent } => {
                let b = r / (1.0 + tangent * tangent).sqrt();
                if d <= b * b / r {
                    return Tip::Paraboloid { r }.force(e, d);
                }
                let side = |a: f64| (a * a - b * b).sqrt();
                let depth = |a: f64| a * (a - side(a)) / r + a * (b / a).acos() / tangent;
                let (mut low, mut high) = (b, 2.0 * b + d * tangent);
                while high - low > 4.0 * f64::EPSILON * high {
                    let a = 0.5 * (low + high);
                    if depth(a) < d { low = a } else { high = a }
                }
                let (a, s) = (low, side(low));
                let wedge = (a * a * (b / a).acos() - b * s) / (2.0 * tangent);
                2.0 * e * (a * d - wedge - (a * a * a - s * s * s) / (3.0 * r))
            }
            Tip::Hyperboloid { r, tangent } => {
                let (axis, depth) = (r / tangent, d * tangent * tangent / r);
                let (mut low, mut high) = (0.0, 2.0 + depth);
                while high - low > 4.0 * f64::EPSILON * high {
                    let x: f64 = 0.5 * (low + high);
                    if x * x.atan() < depth { low = x } else { high = x }
                }
                let x = low;
                // The integral of t atan(t) up to x is ((1 + x^2) atan(x) - x)/2.
                let under = match x < 0.02 {
                    true => x.powi(3) / 3.0 - x.powi(5) / 15.0 + x.powi(7) / 35.0,
                    false => 0.5 * ((1.0 + x * x) * x.atan() - x),
                };
                2.0 * e * axis.powi(3) / r * (x * depth - under)
            }
        }
    }
}

impl Law {
    /// Force at indentation `d` on the branch `touch` says; each branch is continued smoothly past
    /// its end, so that an integrator's step may overshoot before it is cut back.
    pub fn force(&self, d: f64, touch: bool) -> f64 {
        self.force_from(self.fold(), d, touch)
    }

    /// The root of the contact radius at which contact ends; of JKR alone.
    pub fn fold(&self) -> f64 {
        match *self {
            Law::Jkr { k, r, w } | Law::JkrBeside { k, r, w, .. } => fold(k, r, w),
            _ => 0.0,
        }
    }

    /// [`force`](Self::force) for who calls it millions of times and knows [`fold`](Self::fold).
    #[inline]
    pub fn force_from(&self, fold: f64, d: f64, touch: bool) -> f64 {
        match *self {
            Law::None => 0.0,
            Law::Hertz { k, r } => {
                if touch {
                    k * (r * d.max(0.0).powi(3)).sqrt()
                } else {
                    0.0
                }
            }
            Law::Dmt { k, r, w, d0 } => {
                let pull = 2.0 * PI * r * w;
                if touch {
                    k * (r * d.max(0.0).powi(3)).sqrt() - pull
                } else if d < 0.0 {
                    -pull * (d0 / (d0 - d)).powi(2)
                } else {
                    -pull * (1.0 + 2.0 * d / d0)
                }
            }
            Law::Indenter { e, tip, pull, d0 } => {
                if touch {
                    tip.force(e, d.max(0.0)) - pull
                } else {
                    Law::Dmt { k: 0.0, r: 1.0, w: pull / (2.0 * PI), d0 }.force(d, false)
                }
            }
            Law::Beside { e, tip, pull, d0, outside, neck } => {
                let contact = Law::Indenter { e, tip, pull, d0 }.force(d, touch);
                let act = if neck.is_some_and(|neck| !neck.acts) { 3 } else { 4 };
                contact + outside[..act].iter().map(|one| one.force(d, touch)).sum::<f64>()
            }
            Law::JkrBeside { k, r, w, outside } => {
                let contact = Law::Jkr { k, r, w }.force_from(fold, d, touch);
                contact + outside.iter().map(|one| one.force(d, touch && d >= 0.0)).sum::<f64>()
            }
            Law::Jkr { k, r, w } => {
                if touch {
                    let b = root_of_radius(fold, r, d);
                    let b3 = b * b * b;
                    k / r * b3 * b3 - (6.0 * PI * w * k).sqrt() * b3
                } else {
                    0.0
                }
            }
        }
    }

    /// Indentation at which contact ends.
    pub fn release(&self) -> f64 {
        match *self {
            Law::Jkr { k, r, w } | Law::JkrBeside { k, r, w, .. } => {
                let b = fold(k, r, w);
                -3.0 * b.powi(4) / r
            }
            _ => 0.0,
        }
    }

    /// How far the indentation is from where a force that remembers begins or ends; positive before.
    pub fn room(&self, d: f64) -> f64 {
        match self {
            Law::Beside { neck: Some(Neck { breaks, acts: true, .. }), .. } => d - breaks,
            Law::Beside { neck: Some(Neck { forms, .. }), .. } => forms - d,
            _ => f64::INFINITY,
        }
    }

    /// The law while a force that remembers acts or does not.
    pub fn acting(mut self, acts: bool) -> Self {
        if let Law::Beside { neck: Some(neck), .. } = &mut self {
            neck.acts = acts;
        }
        self
    }

    /// Whether a force of it remembers.
    pub fn remembers(&self) -> bool {
        matches!(self, Law::Beside { neck: Some(_), .. })
    }

    /// Where between two indentations a force beside a contact is least or largest.
    pub fn extremes_between(&self, [from, to]: [f64; 2], touch: bool) -> Vec<f64> {
        if !matches!(self, Law::Beside { .. } | Law::JkrBeside { .. }) {
            return Vec::new();
        }
        let at = |n: i32| from + (to - from) * f64::from(n) / 16.0;
        let force = |d: f64| self.force(d, touch);
        let mut found = Vec::new();
        for n in 1..16 {
            for sign in [1.0, -1.0] {
                let worth = |d: f64| sign * force(d);
                if worth(at(n)) > worth(at(n - 1)) && worth(at(n)) >= worth(at(n + 1)) {
                    let (mut left, mut right) = (at(n - 1), at(n + 1));
                    for _ in 0..60 {
                        let (one, other) = (left + (right - left) / 3.0, right - (right - left) / 3.0);
                        if worth(one) > worth(other) { right = other } else { left = one }
                    }
                    found.push(0.5 * (left + right));
                }
            }
        }
        found
    }

    /// Indentation inside the contact branch at which the force is least, where there is one.
    pub fn turning(&self) -> Option<f64> {
        match *self {
            // df/da = 0 at a^3 = 3 pi w R^2/(2K)
            Law::Jkr { k, r, w } => {
                let a = (1.5 * PI * w * r * r / k).cbrt();
                Some(a * a / r - 2.0 / 3.0 * (6.0 * PI * w * a / k).sqrt())
            }
            _ => None,
        }
    }
}

/// `b = sqrt(a)` at the fold: `4 b^3/R = (2/3) sqrt(6 pi w/K)`.
fn fold(k: f64, r: f64, w: f64) -> f64 {
    ((6.0 * PI * w / k).sqrt() * r / 6.0).cbrt()
}

/// `b = sqrt(a)` of `delta = b^4/R - (2/3) sqrt(6 pi w/K) b` by Newton's method from above, where the
/// curve is convex and the iteration can only fall; counted from the fold, where nothing cancels.
fn root_of_radius(b: f64, r: f64, delta: f64) -> f64 {
    let scale = b.powi(4) / r;
    let rise = (delta + 3.0 * scale) / scale;
    if rise <= 0.0 {
        return b;
    }
    let mut e = (rise / 6.0).sqrt().min(rise.sqrt().sqrt());
    for _ in 0..60 {
        let value = e * e * (6.0 + e * (4.0 + e)) - rise;
        let next = e - value / (e * (12.0 + e * (12.0 + 4.0 * e)));
        if next >= e {
            break;
        }
        e = next;
    }
    b * (1.0 + e)
}
