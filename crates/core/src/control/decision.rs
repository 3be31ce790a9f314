//! The decision what an instance needs next. It is pure: nothing runs here.

use super::error_parts::ErrorParts;
use crate::observe::Status;
use crate::plan::{Policy, STEPS_MAX};

/// What the decision knows of an instance after its last run.
#[derive(Clone, Copy, Debug)]
pub(super) struct InstanceSummary<'a> {
    pub status: Status,
    /// Estimated error, and requested accuracy.
    pub estimate: f64,
    pub accuracy: f64,
    /// Steps per period of the last run.
    pub steps: u32,
    /// Whether it ran in f32 and may continue in f64.
    pub single: bool,
    /// Whether a richer basis exists.
    pub can_be_richer: bool,
    pub parts: &'a ErrorParts,
}

/// What an instance needs next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Next {
    /// Nothing: the result stands.
    Accept,
    /// The same run in f64, because rounding may be why the motion does not repeat.
    InF64,
    /// Twice the steps.
    MoreSteps,
    /// A richer basis.
    RicherBasis,
    /// The same basis with the resonant modes that it leaves out.
    WaitingModes,
}

/// Decides from the summary alone: the largest part of the error tells what to do. If it is that of waiting modes, they join; if
/// that of the basis, a richer one follows; else more steps.
///
/// More steps do not help a motion that does not repeat. In f32 that verdict may be wrong, so the instance runs in f64. An
/// instance that left the range or overflowed may have had too few steps.
pub(super) fn next(known: &InstanceSummary, policy: &Policy) -> Next {
    let parts = known.parts;
    if parts.stalled || known.steps > STEPS_MAX / 2 {
        return Next::Accept;
    }
    match known.status {
        Status::NotSteady if known.single => return Next::InF64,
        // Without an estimate, further runs teach nothing.
        Status::Ok if known.estimate.is_nan() || known.estimate <= policy.aim * known.accuracy => {
            return Next::Accept;
        }
        Status::Ok | Status::OutOfRange | Status::NonFinite => {}
        _ => return Next::Accept,
    }
    // The force that a failed run measured means nothing.
    if parts.resonances_lead() && known.status == Status::Ok {
        return Next::WaitingModes;
    }
    // More steps do not help if the truncation error dominates. That is known once two runs had the same basis.
    let modes_lead = parts.unsplit.is_none() && parts.of_modes > parts.of_steps;
    if modes_lead && known.can_be_richer {
        Next::RicherBasis
    } else if known.steps <= parts.most_steps / 2 {
        Next::MoreSteps
    } else {
        Next::Accept
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OF_STEPS: ErrorParts = ErrorParts {
        of_steps: 9e-4,
        of_modes: 1e-4,
        of_resonances: 0.0,
        unsplit: None,
        most_steps: 1024,
        finer_before: false,
        stalled: false,
    };
    const OF_MODES: ErrorParts = ErrorParts { of_steps: 1e-4, of_modes: 9e-4, ..OF_STEPS };
    const OF_RESONANCES: ErrorParts = ErrorParts { of_resonances: 1e-3, ..OF_MODES };
    const UNTOLD: ErrorParts = ErrorParts { unsplit: Some(4e-3), ..OF_MODES };
    const IN_VAIN: ErrorParts = ErrorParts { stalled: true, ..OF_STEPS };
    const KNOWN: InstanceSummary = InstanceSummary {
        status: Status::Ok,
        estimate: 1e-3,
        accuracy: 1e-3,
        steps: 64,
        single: false,
        can_be_richer: true,
        parts: &OF_STEPS,
    };

    #[test]
    fn each_case_of_the_table() {
        let lost = |status| InstanceSummary { status, ..KNOWN };
        let of = |parts| InstanceSummary { parts, ..KNOWN };
        let table = [
            ("steps lead", KNOWN, Next::MoreSteps),
            ("below the aim", InstanceSummary { estimate: 5.9e-4, ..KNOWN }, Next::Accept),
            ("just above it", InstanceSummary { estimate: 6.1e-4, ..KNOWN }, Next::MoreSteps),
            ("never estimated", InstanceSummary { estimate: f64::NAN, ..KNOWN }, Next::Accept),
            ("modes lead", of(&OF_MODES), Next::RicherBasis),
            ("resonances lead", of(&OF_RESONANCES), Next::WaitingModes),
            (
                "no force is told",
                InstanceSummary { parts: &OF_RESONANCES, can_be_richer: false, ..lost(Status::NonFinite) },
                Next::MoreSteps,
            ),
            ("not told apart", of(&UNTOLD), Next::MoreSteps),
            ("no richer basis", InstanceSummary { can_be_richer: false, ..of(&OF_MODES) }, Next::MoreSteps),
            ("all steps taken", InstanceSummary { steps: 1024, ..KNOWN }, Next::Accept),
            ("a basis is left", InstanceSummary { steps: 1024, ..of(&OF_MODES) }, Next::RicherBasis),
            ("most steps there are", InstanceSummary { steps: STEPS_MAX, ..of(&OF_MODES) }, Next::Accept),
            ("in vain before", of(&IN_VAIN), Next::Accept),
            ("overflowed", lost(Status::NonFinite), Next::MoreSteps),
            ("out of range", lost(Status::OutOfRange), Next::MoreSteps),
            ("does not repeat", lost(Status::NotSteady), Next::Accept),
            ("does not in f32", InstanceSummary { single: true, ..lost(Status::NotSteady) }, Next::InF64),
            ("f32 and steps lead", InstanceSummary { single: true, ..KNOWN }, Next::MoreSteps),
            ("not run", lost(Status::NotRun), Next::Accept),
            ("sensitive", lost(Status::Sensitive), Next::Accept),
        ];
        for (what, known, expected) in table {
            assert_eq!(next(&known, &Policy::STANDARD), expected, "{what}");
        }
    }
}
