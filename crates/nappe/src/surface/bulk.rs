//! Results that are larger than caches, or take longer than one core should.

use super::Surface;
use glam::DVec3;
use std::sync::{Mutex, PoisonError};
use std::thread;

/// Each thread takes about this many parts, so that all end together.
const PARTS_A_THREAD: usize = 8;

/// Fills `out`, which has `each` places for every item, on `threads` threads: `fill` gets some consecutive items with
/// their places. The result is that of one call of `fill` with everything, to the last bit, if the value of an item
/// does not depend on the items beside it; so it is for the grids and lists of [`Surface`].
///
/// For a grid the items are the values of u and `each` is the number of values of v; for a list they are parameter
/// pairs, and `each` is the number of vectors a point. Panics if the lengths do not fit.
///
/// ```
/// use nappe::surface::{Surface, Torus, TorusOptions, in_parallel};
/// use nappe::DVec3;
///
/// let torus = Torus::new(3.0, 1.0, TorusOptions::default()).unwrap();
/// let t: Vec<f64> = (0..200).map(|i| i as f64 / 199.0).collect();
/// let mut points = vec![DVec3::ZERO; 200 * 200];
/// in_parallel(2, &t, t.len(), &mut points, |u, out| torus.grid(u, &t, out));
/// let mut alone = points.clone();
/// torus.grid(&t, &t, &mut alone);
/// assert_eq!(points, alone);
/// ```
pub fn in_parallel<I: Sync, T: Send>(
    threads: usize,
    items: &[I],
    each: usize,
    out: &mut [T],
    fill: impl Fn(&[I], &mut [T]) + Sync,
) {
    super::check_length(items.len() * each, out.len());
    if threads < 2 || items.len() < 2 || each == 0 {
        return fill(items, out);
    }
    let part = items.len().div_ceil(threads * PARTS_A_THREAD);
    let parts = Mutex::new(items.chunks(part).zip(out.chunks_mut(part * each)));
    let work = || {
        loop {
            // A panic in `fill` reaches the caller when the scope ends; the list of parts is still whole.
            let next = parts.lock().unwrap_or_else(PoisonError::into_inner).next();
            let Some((items, out)) = next else { break };
            fill(items, out);
        }
    };
    thread::scope(|scope| {
        for _ in 1..threads {
            scope.spawn(work);
        }
        work();
    });
}

/// Hands on a grid block by block, for results that need not be in memory at once: `buffer` is filled with as many
/// whole rows as it has room for, and `each` gets the index of the first of these rows and their points, until all is
/// done. A buffer that stays in the caches is filled several times faster than fresh memory; with 16 rows or more the
/// evaluation of v, which every block repeats, costs little. Panics if the buffer is shorter than a row.
pub fn grid_blocks<S: Surface + ?Sized>(
    surface: &S,
    u: &[f64],
    v: &[f64],
    buffer: &mut [DVec3],
    mut each: impl FnMut(usize, &[DVec3]),
) {
    if v.is_empty() {
        return;
    }
    let rows = buffer.len() / v.len();
    assert!(rows > 0, "room for at least one row of the grid");
    for (k, u) in u.chunks(rows).enumerate() {
        let block = &mut buffer[..u.len() * v.len()];
        surface.grid(u, v, block);
        each(k * rows, block);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::NurbsSurface;
    use crate::laws::Random;

    fn example() -> NurbsSurface {
        let mut random = Random(5);
        let net: Vec<DVec3> = (0..16)
            .map(|i| DVec3::new((i / 4) as f64, (i % 4) as f64, random.unit()))
            .collect();
        NurbsSurface::bezier(4, &net, None).unwrap()
    }

    #[test]
    fn any_number_of_threads_gives_the_same_bits() {
        let s = example();
        let mut random = Random(9);
        let uv: Vec<[f64; 2]> = (0..1003).map(|_| [random.unit(), random.unit()]).collect();
        let mut alone = vec![DVec3::ZERO; 3 * uv.len()];
        s.jets(&uv, 1, &mut alone);
        for threads in [1, 2, 3, 7] {
            let mut out = vec![DVec3::ZERO; 3 * uv.len()];
            in_parallel(threads, &uv, 3, &mut out, |uv, out| s.jets(uv, 1, out));
            assert_eq!(out, alone, "{threads} threads");
        }
    }

    #[test]
    fn blocks_are_the_rows_of_the_grid() {
        let s = example();
        let t: Vec<f64> = (0..13).map(|i| i as f64 / 12.0).collect();
        let mut whole = vec![DVec3::ZERO; 13 * 13];
        s.grid(&t, &t, &mut whole);
        let mut buffer = vec![DVec3::ZERO; 4 * 13 + 5];
        let mut seen = Vec::new();
        grid_blocks(&s, &t, &t, &mut buffer, |first, block| {
            assert_eq!(first * 13, seen.len());
            seen.extend_from_slice(block);
        });
        assert_eq!(seen, whole);
    }
}
