//! The list of what is summed over the steps of a period. From it follow what a run can ask for ([`Wants`]), the sums of
//! a period and of a run ([`PeriodSums`]), the fields of the device's buffers and the members of the shader's structures.

use super::Lane;
use super::constants::{FAR, ZERO};

/// Harmonics that can be summed: 1 to this.
pub const HARMONICS: usize = 10;

/// What is done with a sum's values, step after step and period after period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum How {
    /// They are added.
    Total,
    /// The largest is kept.
    Largest,
    /// The smallest is kept.
    Smallest,
    /// 1 once it was 1, else 0.
    Ever,
}

impl How {
    /// Before the first step.
    #[inline(always)]
    fn start<L: Lane>(self) -> L {
        match self {
            Self::Total | Self::Ever => L::splat(ZERO),
            Self::Largest => -L::splat(FAR),
            Self::Smallest => L::splat(FAR),
        }
    }

    /// With one more period.
    #[inline(always)]
    fn join<L: Lane>(self, sofar: L, period: L) -> L {
        match self {
            Self::Total => sofar + period,
            Self::Largest | Self::Ever => sofar.max(period),
            Self::Smallest => sofar.min(period),
        }
    }
}

/// One line of the list.
#[derive(Clone, Copy, Debug)]
pub struct Sum {
    /// Field of [`PeriodSums`], member in the shader, and with `tally_` or `run_sums_` before it field of the
    /// device's buffer.
    pub name: &'static str,
    pub how: How,
    /// Whether a run that wants so much keeps it.
    pub kept: fn(Wants) -> bool,
}

/// Each group has a flag in [`Wants`] and a function of its name in `tally.rs`, which says what a step adds. Observables ask for
/// a group by a constant in `impl Wants` below.
macro_rules! sums {
    ($($(#[$wanted:meta])* $group:ident { $($(#[$what:meta])* $name:ident: $how:ident,)* })*) => {
        /// Which sums and extremes an engine must keep; what nobody asked for is not computed.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        pub struct Wants {
            /// Fourier sums of the tip's travel for harmonics 1 to this.
            pub harmonics: usize,
            $($(#[$wanted])* pub $group: bool,)*
        }

        impl Wants {
            /// The least: by the fundamental a run's steadiness is judged.
            pub const FUNDAMENTAL: Self = Self { harmonics: 1, $($group: false,)* };
            /// All there is.
            pub const ALL: Self = Self { harmonics: HARMONICS, $($group: true,)* };

            /// What either of two needs.
            pub fn or(self, other: Self) -> Self {
                Self {
                    harmonics: self.harmonics.max(other.harmonics),
                    $($group: self.$group | other.$group,)*
                }
            }

            /// Every choice of groups, with one harmonic and with all.
            pub fn every() -> Vec<Self> {
                let mut all = vec![Self::FUNDAMENTAL, Self::HARMONIC];
                $(all.extend(all.clone().into_iter().map(|wants| Self { $group: true, ..wants }));)*
                all
            }
        }

        /// Over a period, or over the measured ones of a run. Kernel units.
        #[derive(Clone, Copy, Debug)]
        pub struct PeriodSums<L> {
            $($($(#[$what])* pub $name: L,)*)*
        }

        impl<L: Lane> PeriodSums<L> {
            /// Before the first step.
            #[inline(always)]
            pub(crate) fn new() -> Self {
                Self { $($($name: How::$how.start(),)*)* }
            }

            /// Takes in those of one more period, as far as they are wanted.
            #[inline(always)]
            pub(crate) fn join(&mut self, period: &Self, wants: Wants) {
                $(if wants.$group {
                    $(self.$name = How::$how.join(self.$name, period.$name);)*
                })*
            }

            /// Takes the other one's numbers where the mask says so.
            #[inline(always)]
            pub(crate) fn choose(&mut self, mask: L::Mask, other: &Self) {
                $($(self.$name = L::select(mask, other.$name, self.$name);)*)*
            }

            /// All of them, in the order of [`SUMS`].
            pub fn numbers(&self) -> impl Iterator<Item = &L> {
                [$($(&self.$name,)*)*].into_iter()
            }

            /// Their places, in the same order.
            pub fn places(&mut self) -> impl Iterator<Item = &mut L> {
                [$($(&mut self.$name,)*)*].into_iter()
            }
        }

        /// The list.
        pub const SUMS: &[Sum] = &[
            $($(Sum { name: stringify!($name), how: How::$how, kept: |wants| wants.$group },)*)*
        ];
    };
}

sums! {
    /// Extremes of the indentation, from which those of the force follow.
    extremes {
        /// Largest indentation.
        deepest: Largest,
        /// Smallest indentation.
        highest: Smallest,
        /// Smallest indentation while in contact.
        held: Smallest,
    }
    /// Extremes of the force, under laws whose force does not follow from the indentation.
    forces {
        /// Largest force.
        strongest: Largest,
        /// Smallest force.
        weakest: Smallest,
    }
    /// Contact time, number of contacts.
    contact {
        /// Steps in contact.
        time: Total,
        /// Contacts begun.
        begun: Total,
        /// Contacts ended.
        ended: Total,
        /// Whether the tip was ever out of contact.
        apart: Ever,
    }
    /// Impulse, work and virial.
    energy {
        /// Impulses.
        impulse: Total,
        /// Their work.
        work: Total,
        /// Their virial.
        virial: Total,
    }
}

impl Wants {
    /// All harmonics.
    pub const HARMONIC: Self = Self { harmonics: HARMONICS, ..Self::FUNDAMENTAL };
    /// Times and numbers of contacts.
    pub const CONTACT: Self = Self { contact: true, ..Self::FUNDAMENTAL };
    /// Impulse, work and virial.
    pub const ENERGY: Self = Self { energy: true, ..Self::FUNDAMENTAL };
    /// Extremes of the indentation; whether there was contact belongs to them.
    pub const EXTREMES: Self = Self { extremes: true, ..Self::CONTACT };

    /// Which of the list's sums are kept, in its order.
    pub fn kept(self) -> impl Iterator<Item = &'static Sum> {
        SUMS.iter().filter(move |sum| (sum.kept)(self))
    }

    /// Whether earlier samples are looked back at.
    pub fn looks_back(self) -> bool {
        self.extremes || self.contact
    }
}

impl<L: Lane> PeriodSums<L> {
    /// Those that are kept, in the order of [`Wants::kept`].
    pub fn kept(&self, wants: Wants) -> impl Iterator<Item = &L> {
        self.numbers().zip(SUMS).filter(move |(_, sum)| (sum.kept)(wants)).map(|(number, _)| number)
    }

    /// Their places, in the same order.
    pub fn kept_places(&mut self, wants: Wants) -> impl Iterator<Item = &mut L> {
        self.places().zip(SUMS).filter(move |(_, sum)| (sum.kept)(wants)).map(|(place, _)| place)
    }
}
