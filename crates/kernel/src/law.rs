//! The list of contact laws.

use crate::Lane;
use crate::contact::{self, Interaction};

/// Hands the list to the macro `$then`: one entry for each law. Whatever has to be written out for each law is made from it.
///
/// An entry says the law's variant, its code in results files (its place in the list), its word in scene and results files
/// (`in scenes`: a scene may name it), the name of its type (in the kernel and in the main crate's `contact`), and
///
/// - where its adhesion acts; whether it has hysteresis ([`Law::has_hysteresis`]) and a history ([`Law::is_viscous`]);
/// - its kin: the laws of the same contact on another sample, under another tip, or with forces beside it;
/// - its form in the reference engine;
/// - for how many modes there is a stepper of two registers side by side (`wide`) or of one (`narrow`). Up to 8 modes,
///   numbers between are filled up with modes at rest; beyond 8 there is one stepper with a loop. Of a law with a memory nothing
///   is filled up: it has a stepper for 2 modes, one of them the memory, and the loop for all others.
///
/// Wide where it was faster (`cargo bench --bench limits`): DMT's attraction, which never ends, is two quotients that wait
/// for each other; the others have more to gain from leaving the law out.
#[macro_export]
macro_rules! laws {
    ($then:ident) => {
        $then! {
            /// No sample.
            None = 0, "none" in scenes, Nothing {
                attraction: None, hysteresis: false, history: false, kin: [],
                reference: NoForce, wide: [], narrow: [8 24]
            };
            /// Hertz (1882): elastic, without adhesion.
            Hertz = 1, "hertz" in scenes, Hertz {
                attraction: None, hysteresis: false, history: false,
                kin: [Viscous: ViscousHertz, Relaxing: RelaxingHertz, Shaped: ShapedHertz, Summed: Sum],
                reference: ReferenceHertz, wide: [1 2], narrow: [3 4 6 8 24]
            };
            /// Derjaguin, Muller & Toporov (1975): adhesion acts from outside the contact.
            Dmt = 2, "dmt" in scenes, Dmt {
                attraction: Distant, hysteresis: false, history: false,
                kin: [Viscous: ViscousDmt, Relaxing: RelaxingSum, Shaped: ShapedDmt, Summed: Sum],
                reference: ReferenceDmt, wide: [1 2 3 4], narrow: [6 8 24]
            };
            /// Johnson, Kendall & Roberts (1971): adhesion acts within the contact.
            Jkr = 3, "jkr" in scenes, Jkr {
                attraction: Contact, hysteresis: true, history: false, kin: [Summed: JkrSum],
                reference: ReferenceJkr, wide: [1 2], narrow: [3 4 6 8 24]
            };
            /// Hertz with a viscous sample (Kelvin-Voigt).
            ViscousHertz = 4, "hertz-viscous", ViscousHertz {
                attraction: None, hysteresis: false, history: true, kin: [],
                reference: ReferenceViscous, wide: [], narrow: [2 8 24]
            };
            /// DMT with a viscous sample.
            ViscousDmt = 5, "dmt-viscous", ViscousDmt {
                attraction: Distant, hysteresis: false, history: true, kin: [],
                reference: ReferenceViscous, wide: [], narrow: [2 8 24]
            };
            /// Hertz with a sample that relaxes (standard linear solid).
            RelaxingHertz = 6, "hertz-relaxing", RelaxingHertz {
                attraction: None, hysteresis: false, history: true, kin: [],
                reference: ReferenceRelaxing, wide: [], narrow: [2 24]
            };
            /// Hertz's half-space under a tip that is no paraboloid (Sneddon 1965).
            ShapedHertz = 7, "hertz-shaped", ShapedHertz {
                attraction: None, hysteresis: false, history: false, kin: [Summed: Sum],
                reference: ReferenceShaped, wide: [], narrow: [2 8 24]
            };
            /// The same under DMT's attraction.
            ShapedDmt = 8, "dmt-shaped", ShapedDmt {
                attraction: Distant, hysteresis: false, history: false, kin: [Summed: Sum],
                reference: ReferenceShaped, wide: [], narrow: [2 8 24]
            };
            /// A contact with up to four forces beside it that are tabulated.
            Sum = 9, "sum", ForceSum {
                attraction: Distant, hysteresis: false, history: false,
                kin: [Viscous: ViscousSum, Relaxing: RelaxingSum, Summed: Sum],
                reference: ReferenceShaped, wide: [], narrow: [2 8 24]
            };
            /// The same, where one of the forces acts only from where it forms to where it breaks.
            HystereticSum = 10, "sum-hysteretic", HystereticSum {
                attraction: Distant, hysteresis: true, history: false, kin: [],
                reference: ReferenceShaped, wide: [], narrow: [2 24]
            };
            /// JKR's contact with such forces beside it.
            JkrSum = 11, "sum-jkr", JkrSum {
                attraction: Distant, hysteresis: true, history: false, kin: [],
                reference: ReferenceJkr, wide: [], narrow: [2 24]
            };
            /// A viscous sample (Kelvin-Voigt) with such forces beside the contact.
            ViscousSum = 12, "sum-viscous", ViscousSum {
                attraction: Distant, hysteresis: false, history: true, kin: [],
                reference: ReferenceViscous, wide: [], narrow: [2 24]
            };
            /// A sample that relaxes with such forces, or DMT's attraction, beside the contact.
            RelaxingSum = 13, "sum-relaxing", RelaxingSum {
                attraction: Distant, hysteresis: false, history: true, kin: [],
                reference: ReferenceRelaxing, wide: [], narrow: [2 24]
            };
        }
    };
}

/// Where a law's adhesion acts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Attraction {
    /// The law has none.
    None,
    /// Only while tip and sample touch.
    Contact,
    /// Also at a distance.
    Distant,
}

/// In what a law may vary another one.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Variation {
    Viscous,
    Relaxing,
    Shaped,
    Summed,
}

macro_rules! enumerate {
    ($($(#[$doc:meta])* $law:ident = $code:literal, $word:literal $(in $scenes:ident)?, $kernel:ident
        { attraction: $attraction:ident, hysteresis: $hysteresis:literal, history: $history:literal,
          kin: [$($way:ident: $kin:ident),*], $($rest:tt)* };)*) => {
        /// The law one instance uses.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
        #[repr(u8)]
        pub enum Law {
            $($(#[$doc])* #[serde(rename = $word)] $law = $code,)*
        }

        impl Law {
            /// Every law, in the order of their codes.
            pub const ALL: [Law; [$($code),*].len()] = [$(Law::$law),*];

            /// The word the scene file and the results file use.
            pub fn name(self) -> &'static str {
                match self {
                    $(Law::$law => $word,)*
                }
            }

            /// Where its adhesion acts.
            pub fn attraction(self) -> Attraction {
                match self {
                    $(Law::$law => Attraction::$attraction,)*
                }
            }

            /// True where one indentation has two answers, in contact and out of it, and the past decides.
            pub fn has_hysteresis(self) -> bool {
                match self {
                    $(Law::$law => $hysteresis,)*
                }
            }

            /// Whether the sample takes time to yield or to recover, or remembers otherwise, so that the force depends on how the
            /// tip came here.
            pub fn is_viscous(self) -> bool {
                match self {
                    $(Law::$law => $history,)*
                }
            }

            /// The law that varies this one so, where there is one.
            fn varied(self, by: Variation) -> Option<Self> {
                let kin: &[(Variation, Self)] = match self {
                    $(Law::$law => &[$((Variation::$way, Law::$kin)),*],)*
                };
                kin.iter().find(|(way, _)| *way == by).map(|(_, law)| *law)
            }

            /// Does `work` with the kernel's type for the law.
            pub fn with<L: Lane, W: WithLaw<L>>(self, work: W) -> W::Output {
                match self {
                    $(Law::$law => work.with::<contact::$kernel<L>>(),)*
                }
            }
        }
    };
}

crate::laws!(enumerate);

/// Something to be done for a law whose type is known only when the program runs.
pub trait WithLaw<L: Lane> {
    type Output;

    fn with<I: Interaction<L>>(self) -> Self::Output;
}

/// Names of the law's constants, whether its kick moves the tip, and whether it has a memory.
struct LawForm;

impl WithLaw<f64> for LawForm {
    type Output = (&'static [&'static str], bool, bool);

    fn with<I: Interaction<f64>>(self) -> Self::Output {
        (I::FIELDS, I::SHIFTS, I::MEMORY)
    }
}

impl Law {
    /// Its code in results files.
    pub fn code(self) -> u8 {
        self as u8
    }

    /// The law of that word.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|law| law.name() == name)
    }

    /// The same law with a viscous sample, where there is one.
    pub fn viscous(self) -> Option<Self> {
        self.varied(Variation::Viscous)
    }

    /// The same law with a sample that relaxes, where there is one.
    pub fn relaxing(self) -> Option<Self> {
        self.varied(Variation::Relaxing)
    }

    /// The same law under a tip that is no paraboloid, where there is one.
    pub fn shaped(self) -> Option<Self> {
        self.varied(Variation::Shaped)
    }

    /// The law of the same contact with other forces beside it, where there is one.
    pub fn summed(self) -> Option<Self> {
        self.varied(Variation::Summed)
    }

    /// Whether it is a contact with other forces beside it, which are tables among its constants.
    pub fn is_sum(self) -> bool {
        self.fields().iter().any(|name| name.starts_with("table_"))
    }

    /// Whether the force jumps where contact forms or ends. A jump rings all modes: it takes more oscillators and steps, and its
    /// error is estimated more carefully.
    pub fn jumps(self) -> bool {
        self.has_hysteresis() || self.attraction() == Attraction::Contact
    }

    /// Whether there is a sample at all.
    pub fn acts(self) -> bool {
        self != Law::None
    }

    /// Names of its constants in the kernel, in their order.
    pub fn fields(self) -> &'static [&'static str] {
        self.with(LawForm).0
    }

    /// Whether its kick also moves the tip.
    pub fn shifts(self) -> bool {
        self.with(LawForm).1
    }

    /// Whether it remembers two numbers: see [`Interaction::MEMORY`].
    pub fn has_memory(self) -> bool {
        self.with(LawForm).2
    }
}

impl std::fmt::Display for Law {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Results files hold a list of all names and, for each instance, a number in it.
    #[test]
    fn a_laws_code_is_its_place_in_the_list() {
        for (place, law) in Law::ALL.into_iter().enumerate() {
            assert_eq!(usize::from(law.code()), place, "{law}");
            assert_eq!(Law::from_name(law.name()), Some(law));
        }
    }
}
