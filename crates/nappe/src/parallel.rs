//! Independent work on several threads, with results that do not depend on their number.

use rustc_hash::FxHashMap;
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
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
    let mut all = Vec::with_capacity(count);
    in_order(threads, count, work, enough, |result| all.push(result));
    all
}

/// The same, but the results are handed to `take`, in order, while others are worked on: by one thread at a time, whichever
/// has just finished a piece of work.
pub fn in_order<R: Send>(
    threads: usize,
    count: usize,
    work: impl Fn(usize) -> R + Sync,
    enough: impl Fn(&R) -> bool + Sync,
    take: impl FnMut(R) + Send,
) {
    let (next, stop) = (AtomicUsize::new(0), AtomicBool::new(false));
    // What waits for those before it, and whoever has taken so many.
    let waiting: Mutex<FxHashMap<usize, R>> = Mutex::default();
    let taker = Mutex::new((0, take));
    // Its own results are whole even if another thread has panicked, which ends all.
    let locked = || waiting.lock().unwrap_or_else(PoisonError::into_inner);
    let hand_on = || {
        // Without waiting: who takes at the moment looks again afterwards.
        while let Ok(mut taker) = taker.try_lock() {
            let (taken, take) = &mut *taker;
            loop {
                let result = locked().remove(taken);
                let Some(result) = result else { break };
                take(result);
                *taken += 1;
            }
            let taken = *taken;
            drop(taker);
            if !locked().contains_key(&taken) {
                break;
            }
        }
    };
    let run = || {
        while !stop.load(Ordering::Relaxed) {
            let i = next.fetch_add(1, Ordering::Relaxed);
            if i >= count {
                break;
            }
            let result = work(i);
            if enough(&result) {
                stop.store(true, Ordering::Relaxed);
            }
            locked().insert(i, result);
            hand_on();
        }
    };
    thread::scope(|scope| {
        let others: Vec<_> = (1..threads.min(count)).map(|_| scope.spawn(run)).collect();
        run();
        for other in others {
            if let Err(panic) = other.join() {
                std::panic::resume_unwind(panic);
            }
        }
    });
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
    fn results_are_taken_in_order_while_others_are_worked_on() {
        for threads in [1, 2, 5] {
            let mut taken = Vec::new();
            let work = |i: usize| {
                // The first ones take longest.
                (0..(100 - i) * 100).fold(i, |a, b| std::hint::black_box(a ^ b));
                i
            };
            in_order(threads, 100, work, |_| false, |i| taken.push(i));
            assert!(taken.into_iter().eq(0..100));
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
