//! What became of an instance.

macro_rules! statuses {
    ($($(#[$meta:meta])* $name:ident = $code:literal, $meaning:literal, $reason:literal;)*) => {
        /// What became of an instance; the results file stores the code with CF `flag_values` and `flag_meanings`.
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
        #[repr(u8)]
        pub enum Status {
            $($(#[$meta])* $name = $code,)*
        }

        impl Status {
            pub const ALL: [Status; [$($code),*].len()] = [$(Status::$name),*];

            /// One word, as in `flag_meanings`.
            pub fn meaning(self) -> &'static str {
                match self {
                    $(Self::$name => $meaning,)*
                }
            }

            /// Why an instance has it, and what helps.
            pub fn reason(self) -> &'static str {
                match self {
                    $(Self::$name => $reason,)*
                }
            }
        }
    };
}

// Name and code, its one word, why an instance has it and what helps.
statuses! {
    #[default]
    Ok = 0, "ok", "nothing to do";
    /// The response still changes by more than the accuracy asked for.
    NotSteady = 1, "not_steady",
        "the response still changes by more than the accuracy asked for; more [run] periods settle it if every mode that rings has a quality factor and the tapping has a steady state. A scene that waits can search for that state, steady = \"search\" in [run]; one that searched found none, as of a tip that sticks and tears off at odd times: [output] waveforms shows what it does";
    /// A tiny change of the start moves the result.
    Sensitive = 2, "sensitive", "a tiny change of the start moves the result";
    /// Values stopped being finite.
    NonFinite = 3, "non_finite", "values ran out of the range of numbers; more steps per period may help";
    /// The contact left the range in which the law or the step holds.
    OutOfRange = 4, "out_of_range", "a contact lasts only a few steps; raise [run] steps_per_period";
    /// The run was stopped before this instance was computed, or before its error was brought down; then its values are
    /// those of the runs done, and nothing vouches for them.
    NotRun = 5, "not_run", "the run was stopped before it was done";
    /// The estimated error, or the one that an audit found, stayed above the accuracy asked for.
    AccuracyNotMet = 6, "accuracy_not_met",
        "its error is estimated, or was found by an audit, above the accuracy asked for (error_estimate, group audit)";
    /// No gap was found that holds the set-point.
    NoSetpoint = 7, "no_setpoint",
        "no gap was found that holds the set-point: the approach jumps past it and the way back does not meet it, the sample is too soft for it as deep as [approach] deepest says, or the tip feels no sample; a curve over the gap shows which";
}

impl Status {
    /// Whether the instance has a steady motion, known well or not.
    pub fn is_steady(self) -> bool {
        matches!(self, Self::Ok | Self::OutOfRange | Self::AccuracyNotMet)
    }

    /// The status of that code.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|status| *status as u8 == code)
    }
}
