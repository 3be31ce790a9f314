//! The numbers that error control decides by.

/// Makes the policy, its standard values, and the list of both.
macro_rules! policy {
    ($($(#[$meaning:meta])* $name:ident: $kind:ty = $standard:expr,)*) => {
        /// The numbers that error control decides by, in one place. docs/tuning.md has the evidence for each: its trade-off,
        /// the measurement, and the command that repeats it. A results file carries them.
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[non_exhaustive]
        pub struct Policy {
            $($(#[$meaning])* pub $name: $kind,)*
        }

        impl Policy {
            /// The values of a run that sets no others.
            pub const STANDARD: Self = Self { $($name: $standard,)* };

            /// One line for each number, as `name = value`.
            pub fn lines(&self) -> Vec<String> {
                vec![$(format!("{} = {:?}", stringify!($name), self.$name),)*]
            }
        }
    };
}

policy! {
    /// Times that an instance may run again with twice as many steps.
    doublings: u32 = 4,
    /// Further runs of an instance, when doublings may all have gone into steps, to try larger bases.
    richer_bases: u32 = 2,
    /// Fewest steps per period of any run.
    fewest_steps: u32 = 16,
    /// Largest estimate, as a share of the accuracy, with which an instance does not run again. The rest allows for errors
    /// that no estimate sees: undamped modes of small share, rounding.
    aim: f64 = 0.6,
    /// Share of the difference between two runs that remains as the finer one's error. Errors fall by 6 to 16 times with twice
    /// the steps (orders 2.6 to 4), which leaves a fifth to a fifteenth; single cases do worse.
    left_of_steps: f64 = 0.25,
    /// The same, below the accuracy `corners_below`, where the fastest oscillator turns by more than half a turn in each step of
    /// the coarser run. That run does not follow it, so the difference shows less of the finer one's error.
    left_of_aliased: f64 = 0.5,
    /// The same for two numbers of oscillators for a fast contact, whose error falls by 2 to 8 times from one to the next.
    left_of_fast: f64 = 0.5,
    /// The same for two bases for slow contacts whose force has corners that excite all modes: under JKR, whose force jumps,
    /// and under any law below the accuracy `corners_below`.
    left_of_corners: f64 = 0.75,
    /// The same for two numbers of oscillators for such fast contacts.
    left_of_fast_corners: f64 = 1.5,
    /// Below this accuracy the corners of every law count.
    corners_below: f64 = 1e-3,
    /// Errors fall by at most this factor with twice the steps. The first difference is of steps and bases together; what
    /// exceeds this factor times the second, of steps alone, is due to the basis.
    steepest: f64 = 16.0,
    /// From the second finer run of a fast contact on, a run that reduces the estimate by less than this factor is the last. One
    /// that raises it is not.
    least_gain: f64 = 1.25,
    /// A stopped run keeps an instance as done if its first estimate was below this share of the accuracy. It is less than
    /// `aim`, because later runs could have raised the estimate.
    certain: f64 = 0.5,

    /// Size of the sample on which bases are tried.
    sample: usize = 64,
    /// The jump of force at the end of contact under JKR is strong from this share of the force at the expected largest
    /// indentation. Contacts with a strong jump have trials of their own.
    strong_jump: f64 = 0.04,
    /// From so many instances on the smallest bases are tried, too.
    many: usize = 256,
    /// Smaller bases on trial: the accuracy that their modes are for, over the requested one.
    poorer: [f64; 3] = [1000.0, 100.0, 10.0],
    /// Larger bases on trial.
    richer: [f64; 3] = [1.0, 0.5, 0.25],
    /// No basis is made for an accuracy worse than this: it would have no mode.
    poorest: f64 = 0.3,
    /// Error of the sample, as a share of the accuracy, that a truncated basis may cost. The rarest instance costs several
    /// times its neighbours in it, where a contact lasts as long as a truncated mode takes to swing.
    basis_share: f64 = 0.2,
    /// The same for the smaller bases, which truncate more.
    poorer_basis_share: f64 = 0.1,
    /// The same for the basis of the first run, the next smaller one. Its difference to the second run is each instance's own
    /// estimate, and little of it remains in the second.
    first_basis_share: f64 = 1.5,
    /// Fewest oscillators with which the first run of a fast contact may have the next smaller basis, and its difference to the
    /// second run both errors. With fewer the basis lacks lever modes, and few steps do not show what those do.
    first_oscillators: usize = 8,
    /// Members of the sample on either side of an instance whose largest difference stands for its own.
    neighbours: usize = 2,

    /// Error of the sample, as a share of the accuracy, that rounding in f32 may cost.
    rounding_share: f64 = 0.1,
    /// Cost of a step in f32 over one in f64: a register holds twice as many.
    single_cost: f64 = 0.5,
    /// f32 is used only if it costs less than this share of f64.
    single_worth: f64 = 0.8,

    /// Shift of the start that reveals sensitive instances: in the slowest mode, in units of the requested accuracy times the
    /// free amplitude.
    shift: f64 = 0.01,
    /// Two states of an instance are on different branches if they differ by more than so many accuracies.
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
