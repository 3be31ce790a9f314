//! Derjaguin, Muller & Toporov (1975): Hertz's force less a constant adhesion in contact, and
//! its decay with distance outside; equations (17), (18) of Ha, Fung & Chen 2005 in the form
//! that is continuous at first touch.

use super::hertz::Hertz;
use super::path::Path;
use super::{Approach, Interaction, Kick, Lane, LawShader, hertz};
use crate::kernel::constants::{ONE, TWELFTH, TWO, ZERO};

/// `adhesion` is 2 pi R w as impulse per step; `inverse_decay` 1/D0 per unit of length.
#[derive(Clone, Copy, Debug)]
pub struct Dmt<L> {
    pub hertz: Hertz<L>,
    pub adhesion: L,
    pub inverse_decay: L,
}

impl<L: Lane> Dmt<L> {
    /// Distance from the surface in decay lengths; 0 in contact.
    #[inline(always)]
    fn distance(&self, indentation: L) -> L {
        (-indentation).max(L::splat(ZERO)) * self.inverse_decay
    }

    /// Mean attraction along a piece of path: 1/((1 + x1)(1 + x2)) outside, 1 inside, by shares.
    #[inline(always)]
    fn attraction(&self, path: Path<L>, inside: L) -> L {
        let one = L::splat(ONE);
        let product = (one + self.distance(path.start)) * (one + self.distance(path.end));
        let outside = one / product;
        self.adhesion * inside.mul_add(one - outside, outside)
    }
}

impl<L: Lane> Interaction<L> for Dmt<L> {
    const SHADER: &'static LawShader = &LawShader {
        name: "dmt",
        texts: &[hertz::TEXT, include_str!("../../../shaders/contact/dmt.wgsl")],
        fields: &["stiffness", "adhesion", "inverse_decay"],
    };

    fn numbers(&self) -> Vec<L> {
        vec![self.hertz.stiffness, self.adhesion, self.inverse_decay]
    }

    #[inline(always)]
    fn kick(&self, at: Approach<L>, _touching: L) -> Kick<L> {
        let one = L::splat(ONE);
        let y = one / (one + self.distance(at.indentation));
        let sample = self.hertz.sample(at.indentation) - self.adhesion * y * y;
        let path = Path::around(at, sample);
        let zero = L::splat(ZERO);
        if !L::any(L::either(zero.less(path.start), zero.less(path.end))) {
            let pull = self.attraction(path, zero);
            let slope = -(L::splat(TWO) * pull * self.inverse_decay * y);
            let impulse = -pull + pull * slope * L::splat(TWELFTH);
            return Kick { impulse, contact: zero, touching: zero };
        }
        let mean = self.hertz.mean(path);
        let pull = self.attraction(path, mean.share);
        let force = mean.force - pull;
        // Slope of the attraction outside: -2 pull/(D0 + distance), in contact none.
        let slope = mean.slope - L::splat(TWO) * pull * self.inverse_decay * y * (one - mean.share);
        let impulse = force - force * slope * L::splat(TWELFTH);
        Kick { impulse, contact: mean.share, touching: self.touching_at(path.end) }
    }

    #[inline(always)]
    fn touching_at(&self, indentation: L) -> L {
        self.hertz.touching_at(indentation)
    }
}
