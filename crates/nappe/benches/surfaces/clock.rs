//! Time.

use pulp::bytemuck::{Pod, cast_slice_mut};
use std::hint::black_box;
use std::time::{Duration, Instant};

/// Runs are repeated until they took this long together.
const ENOUGH: Duration = Duration::from_millis(300);

/// Repeats a round that returns times, and returns the best of each in seconds. The first round, which finds cold caches,
/// is not counted.
fn best_of<const N: usize>(runs: usize, mut round: impl FnMut() -> [Duration; N]) -> [f64; N] {
    round();
    let (mut least, mut total, mut done) = ([Duration::MAX; N], Duration::ZERO, 0);
    while done < runs || total < ENOUGH && done < 50 * runs {
        for (least, time) in least.iter_mut().zip(round()) {
            *least = time.min(*least);
            total += time;
        }
        done += 1;
    }
    least.map(|t| t.as_secs_f64())
}

fn time(f: impl FnOnce()) -> Duration {
    let start = Instant::now();
    f();
    start.elapsed()
}

/// The best time of at least `runs` runs, in nanoseconds for each of `n` items.
pub(crate) fn best(runs: usize, n: usize, mut f: impl FnMut()) -> f64 {
    best_of(runs, || [time(&mut f)])[0] * 1e9 / n as f64
}

/// The best times of a task that fills `part` places, and of filling these with one number: the limit of what stores its
/// result. Both walk through all of `ring`, part by part, and take turns; times are for each of the `items` of a part. A
/// ring of one part is written where the last run left it in the caches; one that is larger than these, in memory.
pub(crate) fn beside_writing<T: Pod>(
    runs: usize,
    ring: &mut [T],
    part: usize,
    items: usize,
    mut task: impl FnMut(&mut [T]),
) -> [f64; 2] {
    let all = ring.len() / part * items;
    let times = best_of(runs, || {
        let ours = time(|| {
            black_box(&mut *ring)
                .chunks_exact_mut(part)
                .for_each(&mut task)
        });
        let fill = |part: &mut [T]| cast_slice_mut::<T, u64>(part).fill(black_box(1));
        [
            ours,
            time(|| black_box(&mut *ring).chunks_exact_mut(part).for_each(fill)),
        ]
    });
    times.map(|t| t * 1e9 / all as f64)
}
