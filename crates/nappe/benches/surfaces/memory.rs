//! Memory of this process, where the system tells it; elsewhere not a number. The size of the caches.

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

/// The size of the last-level cache in bytes, where the system tells it.
pub(crate) fn last_cache() -> Option<usize> {
    let size = |index: usize| {
        let file = format!("/sys/devices/system/cpu/cpu0/cache/index{index}/size");
        let kilobytes: usize = fs::read_to_string(file)
            .ok()?
            .trim()
            .strip_suffix('K')?
            .parse()
            .ok()?;
        Some(kilobytes << 10)
    };
    (0..).map_while(size).max()
}
