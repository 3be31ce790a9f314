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
    let (mut days, clock) = (seconds / 86_400, seconds % 86_400);
    let leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while days >= 365 + u64::from(leap(year)) {
        days -= 365 + u64::from(leap(year));
        year += 1;
    }
    let lengths = [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 1;
    for length in lengths {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    format!(
        "{year:04}-{month:02}-{:02}T{:02}:{:02}:{:02}Z",
        days + 1,
        clock / 3600,
        clock / 60 % 60,
        clock % 60
    )
}
