//! Contact forces written down afresh, each with its memory and the places where it is not smooth.

use std::f64::consts::PI;

/// SI; `k` is the combined modulus K, `r` the tip radius, `w` the work of adhesion.
#[derive(Clone, Copy, Debug)]
pub enum Law {
    None,
    Hertz { k: f64, r: f64 },
    Dmt { k: f64, r: f64, w: f64, d0: f64 },
    Jkr { k: f64, r: f64, w: f64 },
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
            Law::Jkr { k, r, w } => fold(k, r, w),
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
            Law::Jkr { k, r, w } => {
                let b = fold(k, r, w);
                -3.0 * b.powi(4) / r
            }
            _ => 0.0,
        }
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
