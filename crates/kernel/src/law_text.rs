//! A law's functions in WGSL, recorded from its kick.

use crate::Lane;
use crate::contact::{Approach, Interaction, Kick};
use crate::dual::Dual;
use crate::law::{Law, WithLaw};
use crate::recorded::Recorded;
use crate::wgsl::function;

/// A kick by its members' names in the shader.
pub(super) fn kick_at(place: &str) -> Kick<Recorded> {
    let own = |member| Recorded::named(format!("{place}.{member}"));
    Kick {
        impulse: own("impulse"),
        shift: own("shift"),
        contact: own("contact"),
        touching: own("touching"),
        memory: MEMORY.map(own),
    }
}

/// A law whose constants have the shader's names.
fn recorded_law<L: Lane, I: Interaction<L>>(constant: impl Fn(Recorded) -> L) -> I {
    let mut fields = I::FIELDS.iter();
    I::from_numbers(|| {
        // A law that takes more numbers than it has fields is no shader to any driver.
        constant(Recorded::named(format!("law.{}", fields.next().unwrap_or(&"no field"))))
    })
}

/// What a law makes of an approach and of contact before it, both by their names in the shader.
fn recorded_kick<L: Lane, I: Interaction<L>>(constant: impl Fn(Recorded) -> L, at: Approach<L>) -> Kick<L> {
    let law: I = recorded_law(&constant);
    law.kick(at, constant(Recorded::named("touching")))
}

/// The law's kick as a function of the shader.
struct KickText;

impl WithLaw<Recorded> for KickText {
    type Output = String;

    fn with<I: Interaction<Recorded>>(self) -> String {
        let head = "fn law_kick(law: Law, at: Approach, touching: real) -> Kick";
        let kick = || {
            let kick = recorded_kick::<_, I>(|number| number, approach_at("at", |_, number| number));
            let memory = I::MEMORY.then_some(kick.memory).into_iter().flatten();
            [kick.impulse, kick.shift, kick.contact, kick.touching].into_iter().chain(memory).collect()
        };
        function(head, kick, |words| format!("Kick({})", words.join(", ")))
    }
}

/// The extreme forces within a step, likewise.
struct ForcesText;

impl WithLaw<Recorded> for ForcesText {
    type Output = String;

    fn with<I: Interaction<Recorded>>(self) -> String {
        let head = "fn law_forces(law: Law, at: Approach, kick: Kick) -> vec2<real>";
        let forces = || {
            let law: I = recorded_law(|number| number);
            law.extremes(approach_at("at", |_, number| number), &kick_at("kick")).to_vec()
        };
        function(head, forces, |words| format!("vec2<real>({})", words.join(", ")))
    }
}

/// The derivatives of the law's kick, likewise: by the numbers of the approach, and those by its memory, if it has one.
struct SlopeText;

impl WithLaw<Dual<Recorded>> for SlopeText {
    type Output = String;

    fn with<I: Interaction<Dual<Recorded>>>(self) -> String {
        let slopes_by = |first: usize| {
            let own = |n: usize, number| match n.checked_sub(first).filter(|n| *n < 3) {
                Some(n) => Dual::own(number, n),
                None => Dual::constant(number),
            };
            let kick = recorded_kick::<_, I>(Dual::constant, approach_at("at", own));
            let memory = I::MEMORY.then_some(kick.memory.map(|number| number.by)).into_iter().flatten();
            [kick.impulse.by, kick.shift.by].into_iter().chain(memory).flatten().collect()
        };
        let value = |words: &[String]| {
            let vectors = words.chunks(3).map(|words| format!("vec3<real>({})", words.join(", ")));
            format!("KickSlope({})", vectors.collect::<Vec<_>>().join(", "))
        };
        let text = |name: &str, first| {
            let head = format!("fn {name}(law: Law, at: Approach, touching: real) -> KickSlope");
            function(&head, || slopes_by(first), value)
        };
        let own = text("law_slope", 0);
        if I::MEMORY { own + "\n" + &text("law_slope_by_memory", 3) } else { own }
    }
}

/// The numbers of an approach as a shader calls them, its memory last, and those of a memory.
const APPROACH: [&str; 5] = ["indentation", "speed", "acceleration", MEMORY[0], MEMORY[1]];
const MEMORY: [&str; 2] = ["memory_x", "memory_u"];

/// An approach by its members' names in the shader, of which `number` makes what is wanted, each with its place.
pub(super) fn approach_at<L>(place: &str, number: impl Fn(usize, Recorded) -> L) -> Approach<L> {
    let own = |n: usize| number(n, Recorded::named(format!("{place}.{}", APPROACH[n])));
    let [indentation, speed, acceleration, x, u] = std::array::from_fn(own);
    Approach { indentation, speed, acceleration, memory: [x, u] }
}

impl Law {
    /// Its kick in WGSL, as [`Interaction::kick`] makes it operation by operation: `law_kick`. shaders/recorded/ shows it.
    pub fn kick_text(self) -> String {
        self.with(KickText)
    }

    /// The extreme forces within a step in WGSL: `law_forces`.
    pub fn forces_text(self) -> String {
        self.with(ForcesText)
    }

    /// The derivatives of its kick by the numbers of an [`Approach`] in WGSL: `law_slope`.
    pub fn slope_text(self) -> String {
        self.with(SlopeText)
    }
}
