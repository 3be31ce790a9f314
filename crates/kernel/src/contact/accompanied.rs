//! A contact of any law with tabulated forces beside it (docs/method.md). The contact meets a path that these forces bend
//! evenly; they are met along the path that its kick and theirs bend.

use super::dmt::{Beside, TermMean};
use super::path::Path;
use super::sum::{TERM_FIELDS, Terms};
use super::{Approach, Interaction, Kick, Lane};
use crate::constants::{HALF, TWELFTH, TWENTY_FOURTH, ZERO};

/// The contact, and what acts beside it.
#[derive(Clone, Copy, Debug)]
pub struct Accompanied<L, C> {
    contact: C,
    terms: Terms<L>,
}

/// Most constants of a contact.
const ROOM: usize = 16;

impl<L: Lane, C: Interaction<L>> Accompanied<L, C> {
    const ALL: [&'static str; ROOM + TERM_FIELDS.len()] = {
        let mut all = [""; ROOM + TERM_FIELDS.len()];
        let mut n = 0;
        while n < C::FIELDS.len() + TERM_FIELDS.len() {
            let own = C::FIELDS.len();
            all[n] = if n < own { C::FIELDS[n] } else { TERM_FIELDS[n - own] };
            n += 1;
        }
        all
    };
}

impl<L: Lane> Approach<L> {
    /// The same where a `force` acts evenly over the step, whose own kick is left out.
    #[inline(always)]
    fn under(self, force: L) -> Self {
        Self {
            indentation: (-L::splat(TWENTY_FOURTH)).mul_add(force, self.indentation),
            speed: (-L::splat(HALF)).mul_add(force, self.speed),
            acceleration: self.acceleration - force,
            ..self
        }
    }
}

impl<L: Lane, C: Interaction<L>> Interaction<L> for Accompanied<L, C> {
    const FIELDS: &'static [&'static str] = Self::ALL.split_at(C::FIELDS.len() + TERM_FIELDS.len()).0;
    const SHIFTS: bool = true;
    const MEMORY: bool = C::MEMORY;

    #[inline(always)]
    fn from_numbers(mut next: impl FnMut() -> L) -> Self {
        Self { contact: C::from_numbers(&mut next), terms: Terms::from_numbers(next) }
    }

    #[inline(always)]
    fn kick(&self, at: Approach<L>, touching: L) -> Kick<L> {
        let beside = self.terms.sampled(L::splat(ZERO), at.indentation);
        let kick = self.contact.kick(at.under(beside), touching);
        let path = Path::around(at, kick.impulse + beside);
        let TermMean { force, slope, lean } = self.terms.mean(path);
        let all = kick.impulse + force;
        let bending = at.acceleration - all;
        let straight = (-(all * slope)).mul_add(L::splat(TWELFTH), all);
        Kick {
            impulse: (-bending).mul_add(lean, straight),
            shift: (-lean).mul_add(path.end - path.start, kick.shift),
            ..kick
        }
    }

    #[inline(always)]
    fn extremes(&self, at: Approach<L>, kick: &Kick<L>) -> [L; 2] {
        let beside = self.terms.sampled(L::splat(ZERO), at.indentation);
        let own = Kick { impulse: kick.impulse - beside, ..*kick };
        let [least, most] = self.contact.extremes(at.under(beside), &own);
        [least + beside, most + beside]
    }
}
