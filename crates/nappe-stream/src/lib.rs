//! Writes memory past the caches.
//!
//! A store to memory that no cache holds first reads the line it writes to: a result larger than the caches then moves
//! twice over the bus, and pushes out what the computation needs. Streaming stores write whole lines without reading
//! them. Of all instructions that the kernel wants, these alone have no safe form, so they stand here by themselves. This
//! crate has the only unsafe code of the workspace. The rule for it: a change here is reviewed by itself, against the
//! safety comments, and its tests run under an interpreter that finds undefined behaviour where one is at hand; elsewhere
//! the plain path is compiled.
//!
//! x86-64 has streaming stores in its base, wider ones with AVX and AVX-512; on other targets this is plain copying.

mod stores;

pub use stores::{Base, Part, Stores};

use std::marker::PhantomData;
use std::ops::Range;
use std::slice::IterMut;

/// Keeps a value on its thread: a fence orders the streaming stores of the thread that runs it, and of no other.
type Here = PhantomData<*const ()>;

/// Where results go, one part after the other or in any order.
///
/// It stays on the thread that called [`stream`], as do its lines: the stores of one thread stay in order for that thread,
/// and its fence puts them in place for all others. This does not compile:
///
/// ```compile_fail,E0277
/// let mut out = vec![0.0; 8];
/// nappe_stream::stream(&mut out, |w| {
///     std::thread::scope(|scope| {
///         scope.spawn(|| w.copy(0, &[1.0; 8]));
///     });
/// });
/// ```
pub struct Writer<'a> {
    out: &'a mut [f64],
    /// What was written since the last fence.
    fresh: Fresh,
    here: Here,
}

impl Writer<'_> {
    /// How many places there are from index `at` to the next one where a line of the cache begins.
    #[inline(always)]
    pub fn to_line(&self, at: usize) -> usize {
        // So many places come before the first line that begins in `out`.
        let first = self.out.as_ptr().align_offset(LINE * size_of::<f64>()) % LINE;
        (first + LINE - at % LINE) % LINE
    }

    /// Copies `from` to the places that start at index `at`: whole lines past the caches, the rest through them.
    ///
    /// Places may be written again: what was written first is in place by then. That takes a fence, as does going back to
    /// places between two that were written since the last one; parts one after the other need none.
    ///
    /// Panics if the places do not all exist.
    pub fn copy(&mut self, at: usize, from: &[f64]) {
        let to = self.places(at, from.len());
        let start = to
            .as_ptr()
            .align_offset(LINE * size_of::<f64>())
            .min(to.len());
        let (head, to) = to.split_at_mut(start);
        let (first, from) = from.split_at(start);
        head.copy_from_slice(first);
        let (lines, tail) = to.as_chunks_mut::<LINE>();
        let (sources, last) = from.as_chunks::<LINE>();
        tail.copy_from_slice(last);
        let parts = lines.as_flattened_mut().as_chunks_mut().0.iter_mut();
        let mut lines = Lines::<[f64; 4]> {
            parts,
            here: PhantomData,
        };
        for &part in sources.as_flattened().as_chunks().0 {
            lines.put(Base, part);
        }
    }

    /// Hands out `count` places from index `at` on, one after the other; those that are not taken stay as they are. Written
    /// again as by [`Self::copy`].
    ///
    /// Panics if the places do not all exist, or are not whole lines of the cache.
    #[inline(always)]
    pub fn lines<A: Part>(&mut self, at: usize, count: usize) -> Lines<'_, A> {
        assert!(
            self.to_line(at) == 0 && count.is_multiple_of(LINE),
            "{count} places from {at} on are not whole lines"
        );
        self.out[at..]
            .chunks(PAGE)
            .take(count.div_ceil(PAGE) + 1)
            .for_each(|page| stores::find(&page[0]));
        Lines {
            parts: A::parts(self.places(at, count)).iter_mut(),
            here: PhantomData,
        }
    }

    /// Places to write to, after a fence if need be.
    #[inline(always)]
    fn places(&mut self, at: usize, count: usize) -> &mut [f64] {
        let to = &mut self.out[at..][..count];
        if self.fresh.is_met_by(at..at + count) {
            drop(Fence);
        }
        to
    }
}

/// The smallest range around all places written since a fence.
#[derive(Default)]
struct Fresh(Range<usize>);

impl Fresh {
    /// Adds some places. If they may have been written since the fence another one is due: they are the first after that.
    #[inline(always)]
    fn is_met_by(&mut self, part: Range<usize>) -> bool {
        if part.is_empty() {
            return false;
        }
        let old = &self.0;
        let met = part.start < old.end && old.start < part.end;
        self.0 = if met || old.is_empty() {
            part
        } else {
            old.start.min(part.start)..old.end.max(part.end)
        };
        met
    }
}

/// The length of a line of the cache in numbers.
pub const LINE: usize = 8;

/// The length of a page of memory in numbers.
const PAGE: usize = 512;

/// Whole lines of the cache that are written part by part, in their order.
pub struct Lines<'a, A> {
    /// The first one starts where a line does.
    parts: IterMut<'a, A>,
    here: Here,
}

/// No lines.
impl<A> Default for Lines<'_, A> {
    fn default() -> Self {
        Self {
            parts: IterMut::default(),
            here: PhantomData,
        }
    }
}

impl<A: Part> Lines<'_, A> {
    /// How many parts are left.
    #[inline(always)]
    pub fn left(&self) -> usize {
        self.parts.len()
    }

    /// Writes the next part.
    ///
    /// Panics if none is left.
    #[allow(unsafe_code, reason = "streaming stores need a fence")]
    #[inline(always)]
    pub fn put<S: Stores<A>>(&mut self, stores: S, part: A) {
        let to = self.parts.next().expect("a part is left");
        // SAFETY: parts divide lines, and the first one starts where a line does, at a multiple of 64 (`lines` and `copy`
        // see to it): so each starts at a multiple of its size. The fence that must come before other accesses, on the
        // thread of the store: the borrow of all places is in the writer, which `stream` made and which never leaves its
        // thread, nor do lines. So nothing reaches the places but `copy` and `lines`, until `stream` returns or unwinds,
        // which ends with a fence; and both fence before they take up a place that was written since the last one. The
        // plain stores of `copy` beside the lines are to other places by then, and order themselves.
        unsafe { stores.store(to, part) };
    }
}

/// Hands a writer for `out` to `fill`. When this returns, or unwinds, everything written is in place for all threads.
///
/// Worth its while only for results that the caches cannot keep: what is read again soon is faster there.
pub fn stream<T>(out: &mut [f64], fill: impl FnOnce(&mut Writer) -> T) -> T {
    // Dropped after `fill`, even if that panics. A caller cannot forget it, as it could a guard in the writer.
    let _fence = Fence;
    fill(&mut Writer {
        out,
        fresh: Fresh::default(),
        here: PhantomData,
    })
}

/// Orders streaming stores before everything that follows.
struct Fence;

impl Drop for Fence {
    #[allow(unsafe_code, reason = "the fence belongs to the streaming stores")]
    fn drop(&mut self) {
        // SAFETY: the instruction is part of the base of x86-64 and touches no memory.
        #[cfg(target_arch = "x86_64")]
        unsafe {
            std::arch::x86_64::_mm_sfence();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every start and length in four lines: what is written is what was given, and nothing else.
    #[test]
    fn parts_of_any_place_and_length() {
        let from: Vec<f64> = (1..=32).map(f64::from).collect();
        for at in 0..32 {
            for length in 0..=32 - at {
                let mut out = vec![0.0; 32];
                stream(&mut out, |w| w.copy(at, &from[..length]));
                let mut expected = vec![0.0; 32];
                expected[at..at + length].copy_from_slice(&from[..length]);
                assert_eq!(out, expected, "{length} at {at}");
            }
        }
    }

    /// Lines are found wherever the places start, and written by every width of store, also in part.
    #[test]
    fn lines_are_found_and_written() {
        lines_by::<[f64; 1]>(Base);
        lines_by::<[f64; 4]>(Base);
        #[cfg(target_arch = "x86_64")]
        {
            use pulp::x86::{V3, V4};
            V3::try_new().into_iter().for_each(lines_by::<[f64; 4]>);
            V4::try_new().into_iter().for_each(lines_by::<[f64; 8]>);
        }
    }

    fn lines_by<A: Part + pulp::bytemuck::Pod>(stores: impl Stores<A>) {
        let from: Vec<f64> = (1..=24).map(f64::from).collect();
        let parts: &[A] = pulp::bytemuck::cast_slice(&from);
        for start in 0..8 {
            for taken in 0..=parts.len() {
                let mut all = vec![0.0; 48];
                let out = &mut all[start..];
                let place = out.as_ptr() as usize;
                let first = stream(out, |w| {
                    let first = w.to_line(3) + 3;
                    let mut lines = w.lines::<A>(first, 24);
                    for (k, &part) in parts[..taken].iter().enumerate() {
                        assert_eq!(lines.left(), parts.len() - k);
                        lines.put(stores, part);
                    }
                    first
                });
                assert!((3..11).contains(&first));
                assert_eq!((place + 8 * first) % 64, 0);
                let written = taken * 24 / parts.len();
                let mut expected = vec![0.0; out.len()];
                expected[first..first + written].copy_from_slice(&from[..written]);
                assert_eq!(out, expected);
            }
        }
    }

    /// What is no whole line is refused, and so is a part too many.
    #[test]
    fn lines_must_be_whole() {
        let refused = |f: &dyn Fn(&mut Writer)| {
            let mut out = vec![0.0; 40];
            let f = std::panic::AssertUnwindSafe(|| stream(&mut out, |w| f(w)));
            assert!(std::panic::catch_unwind(f).is_err());
            assert_eq!(out, [0.0; 40]);
        };
        refused(&|w| _ = w.lines::<[f64; 4]>(w.to_line(0) + 4, 8));
        refused(&|w| _ = w.lines::<[f64; 4]>(w.to_line(0), 12));
        refused(&|w| _ = w.lines::<[f64; 4]>(w.to_line(0), 48));
        refused(&|w| w.lines::<[f64; 4]>(w.to_line(0), 0).put(Base, [1.0; 4]));
    }

    /// What one thread streamed another one reads.
    #[test]
    fn other_threads_see_it() {
        let from: Vec<f64> = (0..1000).map(f64::from).collect();
        let mut out = vec![0.0; 50_000];
        std::thread::scope(|scope| {
            scope.spawn(|| {
                stream(&mut out, |w| {
                    (0..50).for_each(|k| w.copy(1000 * k, &from));
                });
            });
        });
        assert!(out.chunks(1000).all(|row| row == from));
    }

    /// What is written again holds what came last, also where lines of one copy are beside the ends of another.
    #[test]
    fn places_are_written_again() {
        let mut out = vec![0.0; 64];
        let mut expected = out.clone();
        stream(&mut out, |w| {
            let mut value = 0.0;
            for at in (0..40).chain((0..40).rev()) {
                for length in [1, 7, 8, 24] {
                    value += 1.0;
                    let from: Vec<f64> = (0..length).map(|k| value + 1e-3 * f64::from(k)).collect();
                    w.copy(at, &from);
                    expected[at..at + from.len()].copy_from_slice(&from);
                }
            }
        });
        assert_eq!(out, expected);
    }

    /// A fence is due exactly before places within what was written since the last one.
    #[test]
    fn fences_come_before_places_are_written_again() {
        let fences = |parts: &[Range<usize>]| {
            let mut fresh = Fresh::default();
            parts
                .iter()
                .map(|p| fresh.is_met_by(p.clone()))
                .collect::<Vec<bool>>()
        };
        assert_eq!(fences(&[0..8, 8..16, 16..24]), [false; 3]);
        assert_eq!(fences(&[0..8, 0..8, 8..16]), [false, true, false]);
        assert_eq!(fences(&[8..16, 0..8, 7..9]), [false, false, true]);
        assert_eq!(
            fences(&[0..0, 5..9, 7..7, 9..9, 8..10]),
            [false, false, false, false, true]
        );
        // Tiles of a grid of three rows: one fence for each but the first.
        let tile = |first: usize| (0..3).map(move |row| 10 * row + first..10 * row + first + 5);
        let both: Vec<_> = tile(0).chain(tile(5)).collect();
        assert_eq!(fences(&both), [false, false, false, true, false, false]);
    }

    /// Neither writers nor lines go to other threads: were one `Send` or `Sync`, two functions would be meant.
    #[test]
    fn they_stay_on_their_thread() {
        trait Unless<T> {
            fn holds() -> bool {
                true
            }
        }
        struct Sends;
        struct Shares;
        impl<T> Unless<()> for T {}
        impl<T: Send> Unless<Sends> for T {}
        impl<T: Sync> Unless<Shares> for T {}
        assert!(<Writer as Unless<_>>::holds() && <Lines<[f64; 4]> as Unless<_>>::holds());
    }

    /// What lies outside is refused before anything is written.
    #[test]
    fn there_must_be_room() {
        for (at, length) in [(7, 2), (9, 0), (usize::MAX, 1)] {
            let mut out = vec![0.0; 8];
            let written = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                stream(&mut out, |w| w.copy(at, &vec![1.0; length]));
            }));
            assert!(written.is_err(), "{length} at {at}");
            assert_eq!(out, [0.0; 8]);
        }
    }
}
