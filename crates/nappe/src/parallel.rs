//! Independent work on several threads, with results that do not depend on their number.

use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::thread;

/// As many threads as the machine runs at once.
pub fn all_threads() -> usize {
    thread::available_parallelism().map_or(1, NonZero::get)
}

/// Calls `work` with 0, 1, … `count - 1` on `threads` threads, one number after the other as threads become free, so that
/// few large pieces of work are shared as well as many small ones. Returns the results in this order.
///
/// After a result that is `enough` no further work is begun: the results are then those of the first numbers, up to this
/// one or some more.
pub fn each<R: Send>(
    threads: usize,
    count: usize,
    work: impl Fn(usize) -> R + Sync,
    enough: impl Fn(&R) -> bool + Sync,
) -> Vec<R> {
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    let share = count.div_ceil(threads.max(1));
    let take = || {
        let mut done = Vec::with_capacity(share);
        while !stop.load(Ordering::Relaxed) {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                break;
            }
            let result = work(i);
            if enough(&result) {
                stop.store(true, Ordering::Relaxed);
            }
            done.push((i, result));
        }
        done
    };
    let mut done = thread::scope(|scope| {
        let others: Vec<_> = (1..threads.min(count)).map(|_| scope.spawn(take)).collect();
        let mut done = take();
        for other in others {
            match other.join() {
                Ok(more) => done.extend(more),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        done
    });
    done.sort_unstable_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_come_in_order_for_any_number_of_threads() {
        for threads in [0, 1, 2, 5] {
            for count in [0, 1, 2, 1000] {
                let squares = each(threads, count, |i| i * i, |_| false);
                assert!(squares.into_iter().eq((0..count).map(|i| i * i)));
            }
        }
    }

    #[test]
    fn enough_ends_the_work_with_a_first_part_that_has_the_result() {
        for threads in [1, 2, 4] {
            let found = each(threads, 100_000, |i| i, |i| *i == 70);
            assert!(found.len() > 70 && found.len() < 100_000, "{}", found.len());
            assert!(found.iter().enumerate().all(|(i, f)| i == *f));
        }
    }
}
