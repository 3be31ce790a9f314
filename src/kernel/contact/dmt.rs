//! Derjaguin, Muller & Toporov (1975): Hertz's force less a constant adhesion in contact, and
//! its decay with distance outside; equations (17), (18) of Ha, Fung & Chen 2005 in the form
//! that is continuous at first touch.

use super::hertz::Hertz;
use super::path::{Path, corrected};
use super::{Approach, Interaction, Kick, Lane, LawShader, hertz};
use crate::kernel::constants::{ONE, TWO, ZERO};

/// `adhesion` is 2 pi R w as impulse per step; `inverse_decay` 1/D0 per unit of length.
#[derive(Clone, Copy, Debug)]
pub struct Dmt<L> {
    pub hertz: Hertz<L>,
    pub adhesion: L,
    pub inverse_decay: L,
}

impl<L: Lane> Dmt<L> {
    /// One and the distance from the surface in decay lengths; 1 in contact.
    #[inline(always)]
    fn stretch(&self, indentation: L) -> L {
        (-indentation).max(L::splat(ZERO)).mul_add(self.inverse_decay, L::splat(ONE))
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
    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        Self { hertz: Hertz { stiffness: next() }, adhesion: next(), inverse_decay: next() }
    }

    #[inline(always)]
    fn kick(&self, at: Approach<L>, _touching: L) -> Kick<L> {
        let (zero, one, two) = (L::splat(ZERO), L::splat(ONE), L::splat(TWO));
        let y = one / self.stretch(at.indentation);
        let mut sample = -(self.adhesion * y * y);
        if L::any(zero.less(at.indentation)) {
            sample = (-(self.adhesion * y)).mul_add(y, self.hertz.sample(at.indentation));
        }
        let path = Path::around(at, sample);
        // Mean attraction along a piece of path: 1/((1 + x1)(1 + x2)) outside, 1 inside, by shares.
        let outside = one / (self.stretch(path.start) * self.stretch(path.end));
        // Slope of the attraction outside, relative to it: -2/(D0 + distance); in contact none.
        let fall = two * self.inverse_decay * y;
        if !L::any(L::either(zero.less(path.start), zero.less(path.end))) {
            let pull = self.adhesion * outside;
            return Kick { impulse: corrected(-pull, -(pull * fall)), contact: zero, touching: zero };
        }
        let mean = self.hertz.mean(path);
        let pull = self.adhesion * mean.share.mul_add(one - outside, outside);
        let slope = mean.slope - pull * fall * (one - mean.share);
        let impulse = corrected(mean.force - pull, slope);
        Kick { impulse, contact: mean.share, touching: self.touching_at(path.end) }
    }

    #[inline(always)]
    fn touching_at(&self, indentation: L) -> L {
        self.hertz.touching_at(indentation)
    }
}
