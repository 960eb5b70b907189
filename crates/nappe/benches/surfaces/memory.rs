//! Memory of this process, where the system tells it; elsewhere not a number.

use std::fs;

/// A line of the process's status, in bytes.
fn status(name: &str) -> f64 {
    let text = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let kilobytes = text.lines().find_map(|l| {
        l.strip_prefix(name)?
            .strip_prefix(':')?
            .split_whitespace()
            .next()
    });
    kilobytes.map_or(f64::NAN, |k| 1024.0 * k.parse().unwrap_or(f64::NAN))
}

/// What is in use.
pub(crate) fn now() -> f64 {
    status("VmRSS")
}

/// The most that was in use since the start of the process.
pub(crate) fn peak() -> f64 {
    status("VmHWM")
}
