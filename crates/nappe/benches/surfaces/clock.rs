//! Time.

use std::hint::black_box;
use std::time::{Duration, Instant};

/// Runs are repeated until they took this long together.
const ENOUGH: Duration = Duration::from_millis(300);

/// The best time of at least `runs` runs, in nanoseconds for each of `n` items. The first run, which finds cold caches,
/// is not counted.
pub(crate) fn best(runs: usize, n: usize, mut f: impl FnMut()) -> f64 {
    f();
    let (mut least, mut total, mut done) = (Duration::MAX, Duration::ZERO, 0);
    while done < runs || total < ENOUGH && done < 50 * runs {
        let start = Instant::now();
        f();
        let time = start.elapsed();
        least = least.min(time);
        total += time;
        done += 1;
    }
    least.as_secs_f64() * 1e9 / n as f64
}

/// The time to write `n` items of `bytes` bytes each to memory that is already mapped.
pub(crate) fn write_limit(runs: usize, n: usize, bytes: usize) -> f64 {
    let mut out = vec![0u64; n * bytes / 8];
    best(runs, n, || black_box(&mut out).fill(black_box(1)))
}
