//! The numbers that error control decides by.

/// Makes the policy, its standard values, and the list of both.
macro_rules! policy {
    ($($(#[$meaning:meta])* $name:ident: $kind:ty = $standard:expr,)*) => {
        /// The numbers that error control decides by, in one place. docs/tuning.md has the evidence for each: what it
        /// trades, what was measured, and the command that measures it again. A results file carries them.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub struct Policy {
            $($(#[$meaning])* pub $name: $kind,)*
        }

        impl Policy {
            /// What a run has unless it is told otherwise.
            pub const STANDARD: Self = Self { $($name: $standard,)* };

            /// One line for each number, as `name = value`.
            pub fn lines(&self) -> Vec<String> {
                vec![$(format!("{} = {:?}", stringify!($name), self.$name),)*]
            }
        }
    };
}

policy! {
    /// How often an instance runs again with twice as many steps.
    doublings: u32 = 4,
    /// Runs of an instance beyond the doublings, which may all have gone into steps, to try richer bases.
    richer_bases: u32 = 2,
    /// Fewest steps per period of any run.
    fewest_steps: u32 = 16,
    /// Share of the accuracy that an estimate may have before an instance runs again. The rest is left to what no
    /// estimate sees: undamped modes of small share, rounding.
    aim: f64 = 0.6,
    /// What is left of the difference between two runs in the finer one's error. Errors fall by 6 to 16 times with twice
    /// the steps (orders 2.6 to 4), which leaves a fifth to a fifteenth; single cases do worse.
    left_of_steps: f64 = 0.25,
    /// The same of two numbers of oscillators for a fast contact, whose error falls by 2 to 8 times from one to the next.
    left_of_fast: f64 = 0.5,
    /// The same of two bases for slow contacts where corners of the force move all modes: under JKR, whose force jumps,
    /// and under any law below the accuracy `corners_below`.
    left_of_corners: f64 = 0.75,
    /// The same of two numbers of oscillators for such fast contacts.
    left_of_fast_corners: f64 = 1.5,
    /// Below this accuracy the corners of every law count.
    corners_below: f64 = 1e-3,
    /// With twice the steps errors fall by no more than so many times. What of a first difference, of steps and bases
    /// together, is more than so many times the second, which is of steps alone, is the basis's.
    steepest: f64 = 16.0,
    /// A finer run of a fast contact, from the second on, that brings the estimate down by less is the last.
    least_gain: f64 = 1.25,
    /// A stopped run keeps an instance as done where its first estimate was below this share of the accuracy: less than
    /// `aim`, because some more could still have been added to it.
    certain: f64 = 0.5,

    /// Members of the sample that bases are tried on.
    sample: usize = 64,
    /// The jump of force with which contact ends under JKR is strong from this share of the force at the deepest indentation to
    /// expect. Bases are tried on contacts with a strong one by themselves.
    strong_jump: f64 = 0.04,
    /// From so many instances on the poorest bases are tried too.
    many: usize = 256,
    /// The poorer bases on trial, by the accuracy whose modes they carry over the one asked for.
    poorer: [f64; 3] = [1000.0, 100.0, 10.0],
    /// The richer ones.
    richer: [f64; 3] = [1.0, 0.5, 0.25],
    /// No basis is made for an accuracy worse than this: it would have no mode.
    poorest: f64 = 0.3,
    /// Share of the accuracy that what a basis leaves out may cost the sample. The rarest instance costs several times
    /// its neighbours in it, where a contact lasts as long as a mode left out takes to swing.
    basis_share: f64 = 0.2,
    /// The same for the poorer bases, which leave out more.
    poorer_basis_share: f64 = 0.1,
    /// The same for the basis of the first run, the next smaller one. Its difference to the second run is each instance's
    /// own estimate, and little of it is left in the second.
    first_basis_share: f64 = 1.5,
    /// Members of the sample on either side of an instance whose largest difference stands for its own.
    neighbours: usize = 2,

    /// Share of the accuracy that rounding in f32 may cost the sample.
    rounding_share: f64 = 0.1,
    /// What a step in f32 costs of one in f64: a register holds twice as many.
    single_cost: f64 = 0.5,
    /// f32 is taken only where it costs less than this share of f64.
    single_worth: f64 = 0.8,

    /// The shift of the start that tells sensitive instances: of the slowest mode, over the accuracy asked for and the
    /// free amplitude.
    shift: f64 = 0.01,
    /// Two states of an instance are different branches where they differ by more than so many accuracies.
    branches_apart: f64 = 10.0,
}

impl Default for Policy {
    fn default() -> Self {
        Self::STANDARD
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_is_in_the_list_once() {
        let lines = Policy::STANDARD.lines();
        assert!(lines.contains(&"left_of_steps = 0.25".to_owned()), "{lines:?}");
        assert!(lines.contains(&"poorer = [1000.0, 100.0, 10.0]".to_owned()), "{lines:?}");
        let mut names: Vec<&str> = lines.iter().filter_map(|line| line.split(" = ").next()).collect();
        names.sort_unstable();
        let all = names.len();
        names.dedup();
        assert_eq!(names.len(), all);
    }
}
