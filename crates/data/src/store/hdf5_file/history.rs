//! The date, and the line of history a results file begins with.

use std::time::{SystemTime, UNIX_EPOCH};

/// Now, the program's version and how it was called, as `2026-11-21T10:00:00Z afmsweep 0.1.0: afmsweep run a.toml`.
pub(super) fn history(command_line: Option<&str>) -> String {
    let called = command_line.map_or(String::new(), |line| format!(": {line}"));
    format!("{} afmsweep {}{called}", now(), env!("CARGO_PKG_VERSION"))
}

/// Now, as `2026-11-21T10:00:00Z`.
pub fn now() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let (days, clock) = (seconds / 86_400, seconds % 86_400);
    // Years from March on, in eras of 400 years: H. Hinnant, chrono-compatible low-level date algorithms.
    let (era, day) = ((days + 719_468) / 146_097, (days + 719_468) % 146_097);
    let of_era = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * of_era + of_era / 4 - of_era / 100);
    let from_march = (5 * day + 2) / 153;
    let (day, month) =
        (day - (153 * from_march + 2) / 5, if from_march < 10 { from_march + 3 } else { from_march - 9 });
    let year = 400 * era + of_era + u64::from(month < 3);
    format!(
        "{year:04}-{month:02}-{:02}T{:02}:{:02}:{:02}Z",
        day + 1,
        clock / 3600,
        clock / 60 % 60,
        clock % 60
    )
}
