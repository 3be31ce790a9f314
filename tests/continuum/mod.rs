//! The same instrument without elements: continuous rod, continuous beam, rigid tip.
//!
//! Rod: u = U sin(a Z)/sin(a l_p), a = omega sqrt(rho_p/E_p), with the spring -h33^2 A/(beta33 l_p) on top.
//! Beam: W = kappa U (cosh + cos)/2 + B (cosh - cos) + C (sinh - sin) of b x, with
//! b^4 = rho_b A_b omega^2/(E_b I_b), so that W(0) = kappa U and W_x(0) = 0 hold already. What is left
//! of the variation of T - U, with s = W(L) + l W_x(L) the tip's travel:
//!   top:    E_p A_p u_Z + spring U + kappa E I W_xxx(0) = F_top
//!   moment: E I W_xx(L) - omega^2 m l s = l F_tip
//!   shear: -E I W_xxx(L) - omega^2 m s = F_tip
// Each test file that shares this uses its own part.

use afmsweep::instrument::Mode;
use afmsweep::scene::{InstrumentParams, LeverSpec, TipMass};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::{PI, TAU};

pub fn close(found: f64, exact: f64, tolerance: f64, what: &str) {
    let error = ((found - exact) / exact).abs();
    assert!(error <= tolerance, "{what}: {found:e} is not {exact:e}, off by {error:.1e} (relative)");
}

pub fn hertz(mode: &Mode) -> f64 {
    mode.omega / TAU
}

/// A root of 1 + cos x cosh x.
pub fn clamped_free(k: usize) -> f64 {
    let mut x = (k as f64 + 0.5) * PI;
    for _ in 0..50 {
        let f = x.cos() + 1.0 / x.cosh();
        let slope = -x.sin() - x.tanh() / x.cosh();
        x -= f / slope;
    }
    x
}

/// Numbers of one geometry.
pub struct Continuum {
    pub rod_ea: f64,
    pub rod_speed: f64,
    pub rod_length: f64,
    pub spring: f64,
    pub force_per_volt: f64,
    pub ei: f64,
    pub beam_line_mass: f64,
    pub beam_length: f64,
    pub tip_mass: f64,
    pub arm: f64,
    pub kappa: f64,
}

impl Continuum {
    pub fn new(p: &InstrumentParams) -> Self {
        let a = &p.actuator;
        let LeverSpec::Dimensions { youngs_modulus, density, length, width, thickness } = p.cantilever.lever
        else {
            panic!("continuum of a lever with dimensions only");
        };
        let area = a.width * a.thickness;
        let tip_mass = match p.tip.mass {
            TipMass::Given(mass) => mass,
            TipMass::Pyramid { width, height, density } => {
                density * 2.0 * p.tip.half_length * width * height / 3.0
            }
        };
        Self {
            rod_ea: a.youngs_modulus * area,
            rod_speed: (a.youngs_modulus / a.density).sqrt(),
            rod_length: a.length,
            spring: -a.h33 * a.h33 * area / (a.beta33 * a.length),
            force_per_volt: a.h33 * area / (a.beta33 * a.length),
            ei: youngs_modulus * width * thickness.powi(3) / 12.0,
            beam_line_mass: density * width * thickness,
            beam_length: length,
            tip_mass,
            arm: p.tip.half_length,
            kappa: 1.0,
        }
    }

    /// Rows top, moment, shear; columns U / sin(a l_p), B, C; and the row of the tip's travel.
    fn system(&self, omega: f64) -> (Matrix3<f64>, Vector3<f64>, f64) {
        let a = omega / self.rod_speed;
        let (sin, cos) = (a * self.rod_length).sin_cos();
        let b = (self.beam_line_mass * omega * omega / self.ei).powf(0.25);
        let x = b * self.beam_length;
        let (s, c, sh, ch) = (x.sin(), x.cos(), x.sinh(), x.cosh());
        let k = self.kappa * sin;
        // Value, slope, curvature and third derivative at the end, for each column.
        let value = Vector3::new(0.5 * k * (ch + c), ch - c, sh - s);
        let slope = b * Vector3::new(0.5 * k * (sh - s), sh + s, ch - c);
        let curve = b * b * Vector3::new(0.5 * k * (ch - c), ch + c, sh + s);
        let third = b.powi(3) * Vector3::new(0.5 * k * (sh + s), sh - s, ch + c);
        let tip = value + self.arm * slope;
        let inertia = omega * omega * self.tip_mass;
        let top = Vector3::new(
            self.rod_ea * a * cos + self.spring * sin,
            0.0,
            self.kappa * self.ei * 2.0 * b.powi(3),
        );
        let moment = self.ei * curve - inertia * self.arm * tip;
        let shear = -self.ei * third - inertia * tip;
        (Matrix3::from_rows(&[top.transpose(), moment.transpose(), shear.transpose()]), tip, sin)
    }

    fn determinant(&self, omega: f64) -> f64 {
        let (mut m, _, _) = self.system(omega);
        let b = (self.beam_line_mass * omega * omega / self.ei).powf(0.25);
        let size = (b * self.beam_length).cosh() * self.ei * b * b;
        m.row_mut(0).scale_mut(self.rod_length / self.rod_ea);
        m.row_mut(1).scale_mut(1.0 / size);
        m.row_mut(2).scale_mut(1.0 / (size * b));
        m.determinant()
    }

    /// The first `count` natural frequencies, Hz: sign changes on a fine scan, then bisected.
    pub fn frequencies(&self, count: usize) -> Vec<f64> {
        let rod = std::f64::consts::PI * self.rod_speed / self.rod_length;
        let beam = 3.5 * (self.ei / self.beam_line_mass).sqrt() / self.beam_length.powi(2);
        let step = rod.min(beam) / 2000.0;
        let mut found = Vec::new();
        let mut low = step;
        let mut before = self.determinant(low);
        while found.len() < count {
            let high = low + step;
            let after = self.determinant(high);
            if before.signum() != after.signum() {
                let (mut a, mut b) = (low, high);
                while {
                    let middle = 0.5 * (a + b);
                    let inside = middle > a && middle < b;
                    if inside {
                        if self.determinant(middle).signum() == before.signum() {
                            a = middle
                        } else {
                            b = middle
                        }
                    }
                    inside
                } {}
                found.push(0.5 * (a + b) / std::f64::consts::TAU);
            }
            (low, before) = (high, after);
        }
        found
    }

    /// Undamped (tip, top) amplitudes, signed, for forces on top and tip at `hz`.
    pub fn forced(&self, hz: f64, on_top: f64, on_tip: f64) -> (f64, f64) {
        let (m, tip, sin) = self.system(hz * std::f64::consts::TAU);
        // The tip's force works on u once, whatever kappa: as printed that is the odd one out.
        let load = Vector3::new(on_top + (1.0 - self.kappa) * on_tip, self.arm * on_tip, on_tip);
        let x = m.lu().solve(&load).expect("not on a natural frequency");
        (tip.dot(&x), sin * x[0])
    }

    /// The tip's travel per unit of travel of a base that moves as told.
    pub fn follows(&self, hz: f64) -> f64 {
        let (m, tip, sin) = self.system(hz * std::f64::consts::TAU);
        let inner = m.fixed_view::<2, 2>(1, 1).into_owned();
        let load = -m.fixed_view::<2, 1>(1, 0).into_owned() / sin;
        let x = inner.lu().solve(&load).expect("not on a natural frequency");
        tip[0] / sin + tip[1] * x[0] + tip[2] * x[1]
    }

    /// Travel of the top of the rod alone under a force, N.
    pub fn rod_alone(&self, hz: f64, on_top: f64) -> f64 {
        let a = hz * std::f64::consts::TAU / self.rod_speed;
        on_top / (self.rod_ea * a / (a * self.rod_length).tan() + self.spring)
    }
}
