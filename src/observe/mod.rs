//! What is measured on each instance, with its name, unit and meaning in the results file.

/// A quantity a scene can ask for (`[output] observables`).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Observable {
    Amplitude,
    Phase,
    ForceMax,
    ForceMin,
    ForceMean,
    IndentationMax,
    ContactTime,
    Dissipation,
    Virial,
    Contacts,
    HarmonicAmplitude,
}

/// Harmonics stored by [`Observable::HarmonicAmplitude`]: 1 to this.
pub const HARMONICS: usize = 10;

impl Observable {
    pub const ALL: [Observable; 11] = [
        Observable::Amplitude,
        Observable::Phase,
        Observable::ForceMax,
        Observable::ForceMin,
        Observable::ForceMean,
        Observable::IndentationMax,
        Observable::ContactTime,
        Observable::Dissipation,
        Observable::Virial,
        Observable::Contacts,
        Observable::HarmonicAmplitude,
    ];

    /// Keyword in the scene file and variable name in the results file.
    pub fn name(self) -> &'static str {
        match self {
            Self::Amplitude => "amplitude",
            Self::Phase => "phase",
            Self::ForceMax => "force_max",
            Self::ForceMin => "force_min",
            Self::ForceMean => "force_mean",
            Self::IndentationMax => "indentation_max",
            Self::ContactTime => "contact_time",
            Self::Dissipation => "dissipation",
            Self::Virial => "virial",
            Self::Contacts => "contacts",
            Self::HarmonicAmplitude => "harmonic_amplitude",
        }
    }

    /// SI unit as the results file writes it.
    pub fn units(self) -> &'static str {
        match self {
            Self::Amplitude | Self::IndentationMax | Self::HarmonicAmplitude => "m",
            Self::Phase => "degree",
            Self::ForceMax | Self::ForceMin | Self::ForceMean => "N",
            Self::ContactTime | Self::Contacts => "1",
            Self::Dissipation | Self::Virial => "J",
        }
    }

    /// Label for people.
    pub fn long_name(self) -> &'static str {
        match self {
            Self::Amplitude => "amplitude of the tip's travel, fundamental",
            Self::Phase => "phase lag of the tip's travel behind the drive",
            Self::ForceMax => "largest tip force",
            Self::ForceMin => "smallest tip force",
            Self::ForceMean => "mean tip force",
            Self::IndentationMax => "largest indentation",
            Self::ContactTime => "share of the period in contact",
            Self::Dissipation => "energy lost in the sample per period",
            Self::Virial => "virial: mean of tip force times tip travel",
            Self::Contacts => "contacts begun per period",
            Self::HarmonicAmplitude => "amplitude of the tip's travel by harmonic",
        }
    }

    /// The observable of that keyword.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|observable| observable.name() == name)
    }
}

/// What became of an instance; the results file stores the code with CF `flag_values` and `flag_meanings`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(u8)]
pub enum Status {
    #[default]
    Ok = 0,
    /// The response still changes by more than the accuracy asked for.
    NotSteady = 1,
    /// A tiny change of the start moves the result.
    Sensitive = 2,
    /// Values stopped being finite.
    NonFinite = 3,
    /// The contact left the range in which the law or the step holds.
    OutOfRange = 4,
    /// The run ended before this instance was computed.
    NotRun = 5,
}

impl Status {
    pub const ALL: [Status; 6] = [
        Status::Ok,
        Status::NotSteady,
        Status::Sensitive,
        Status::NonFinite,
        Status::OutOfRange,
        Status::NotRun,
    ];

    /// One word, as in `flag_meanings`.
    pub fn meaning(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::NotSteady => "not_steady",
            Self::Sensitive => "sensitive",
            Self::NonFinite => "non_finite",
            Self::OutOfRange => "out_of_range",
            Self::NotRun => "not_run",
        }
    }

    /// The status of that code.
    pub fn from_code(code: u8) -> Option<Self> {
        Self::ALL.into_iter().find(|status| *status as u8 == code)
    }
}
