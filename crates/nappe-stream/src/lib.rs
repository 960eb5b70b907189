//! Writes memory past the caches.
//!
//! A store to memory that no cache holds first reads the line it writes to: a result larger than the caches then moves
//! twice over the bus, and pushes out what the computation needs. Streaming stores write whole lines without reading
//! them. Of all instructions that the kernel wants, these alone have no safe form, so they stand here by themselves, in
//! one loop. This crate has the only unsafe code of the workspace. The rule for it: a change here is reviewed by itself,
//! against the safety comments, and its tests run under an interpreter that finds undefined behaviour where one is at
//! hand; elsewhere the plain path is compiled.
//!
//! x86-64 has streaming stores in its base; on other targets this is plain copying.

use std::marker::PhantomData;
use std::ops::Range;
use std::slice::{Iter, IterMut};

/// Keeps a value on its thread: a fence orders the streaming stores of the thread that runs it, and of no other.
type Here = PhantomData<*const ()>;

/// Where results go, one part after the other or in any order.
///
/// It stays on the thread that called [`stream`], as do its copies: the stores of one thread stay in order for that thread,
/// and its fence puts them in place for all others. This does not compile:
///
/// ```compile_fail,E0277
/// let mut out = vec![0.0; 8];
/// nappe_stream::stream(&mut out, |w| {
///     std::thread::scope(|scope| {
///         scope.spawn(|| drop(w.copying(0, &[1.0; 8])));
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
    /// Begins to copy `from` to the places that start at index `at`. What [`Copying::step`] has not copied when it is
    /// dropped is copied then.
    ///
    /// Places may be written again: what was written first is in place by then. That takes a fence, as does going back to
    /// places between two that were written since the last one; parts one after the other need none.
    ///
    /// Panics if the places do not all exist.
    #[inline(always)]
    pub fn copying<'a>(&'a mut self, at: usize, from: &'a [f64]) -> Copying<'a> {
        let to = &mut self.out[at..][..from.len()];
        if self.fresh.is_met_by(at..at + from.len()) {
            drop(Fence);
        }
        let start = to
            .as_ptr()
            .align_offset(LINE * size_of::<f64>())
            .min(to.len());
        let (head, to) = to.split_at_mut(start);
        let (first, from) = from.split_at(start);
        head.copy_from_slice(first);
        let (lines, tail) = to.as_chunks_mut();
        let (sources, last) = from.as_chunks();
        tail.copy_from_slice(last);
        Copying {
            lines: lines.iter_mut(),
            sources: sources.iter(),
            here: PhantomData,
        }
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

/// A copy under way. Computing beside it takes no longer than the slower of both: the stores wait for memory, the
/// processor need not.
#[derive(Default)]
pub struct Copying<'a> {
    lines: IterMut<'a, [f64; LINE]>,
    sources: Iter<'a, [f64; LINE]>,
    here: Here,
}

impl Copying<'_> {
    /// Copies up to `lines` more lines of the cache, of 64 bytes each.
    #[inline(always)]
    pub fn step(&mut self, lines: usize) {
        for _ in 0..lines {
            let (Some(to), Some(from)) = (self.lines.next(), self.sources.next()) else {
                return;
            };
            copy_line(to, from);
        }
    }
}

impl Drop for Copying<'_> {
    #[inline(always)]
    fn drop(&mut self) {
        self.step(usize::MAX);
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

/// Writes a line without reading it first. The caller must see to a fence before the place is read: here [`stream`]
/// does, which alone makes writers.
#[cfg(target_arch = "x86_64")]
#[allow(
    unsafe_code,
    reason = "streaming stores are not to be had in any other way"
)]
#[inline(always)]
fn copy_line(to: &mut [f64; LINE], from: &[f64; LINE]) {
    use std::arch::x86_64::{_mm_set_pd, _mm_stream_pd};
    for (to, from) in to
        .as_chunks_mut::<2>()
        .0
        .iter_mut()
        .zip(from.as_chunks::<2>().0)
    {
        // SAFETY: both instructions are part of the base of x86-64. `to` is an array of two numbers that is borrowed
        // exclusively, so there are 16 bytes to write, and it starts at a multiple of 16: lines start at multiples of 64
        // (`copying` sees to it), and pairs are 16 bytes apart. The fence that must come before other accesses, on the
        // thread of the store: the borrow of all places is in the writer, which `stream` made and which never leaves its
        // thread, nor do copies. So nothing reaches the places but `copying`, until `stream` returns or unwinds, which
        // ends with a fence; and `copying` fences before it takes up a place that was written since the last one. The
        // plain stores of `copying` beside the lines are to other places by then, and order themselves.
        unsafe { _mm_stream_pd(to.as_mut_ptr(), _mm_set_pd(from[1], from[0])) };
    }
}

/// Elsewhere this is plain copying.
#[cfg(not(target_arch = "x86_64"))]
#[inline(always)]
fn copy_line(to: &mut [f64; LINE], from: &[f64; LINE]) {
    *to = *from;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every start and length in three lines: what is written is what was given, and nothing else.
    #[test]
    fn parts_of_any_place_and_length() {
        let from: Vec<f64> = (1..=24).map(f64::from).collect();
        for at in 0..24 {
            for length in 0..=24 - at {
                let mut out = vec![0.0; 24];
                stream(&mut out, |w| {
                    let mut copying = w.copying(at, &from[..length]);
                    copying.step(1);
                });
                let mut expected = vec![0.0; 24];
                expected[at..at + length].copy_from_slice(&from[..length]);
                assert_eq!(out, expected, "{length} at {at}");
            }
        }
    }

    /// What one thread streamed another one reads.
    #[test]
    fn other_threads_see_it() {
        let from: Vec<f64> = (0..1000).map(f64::from).collect();
        let mut out = vec![0.0; 50_000];
        std::thread::scope(|scope| {
            scope.spawn(|| {
                stream(&mut out, |w| {
                    (0..50).for_each(|k| drop(w.copying(1000 * k, &from)))
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
                    drop(w.copying(at, &from));
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

    /// Neither writers nor copies go to other threads: were one `Send` or `Sync`, two functions would be meant.
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
        assert!(<Writer as Unless<_>>::holds() && <Copying as Unless<_>>::holds());
    }

    /// What lies outside is refused before anything is written.
    #[test]
    fn there_must_be_room() {
        for (at, length) in [(7, 2), (9, 0), (usize::MAX, 1)] {
            let mut out = vec![0.0; 8];
            let written = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
                stream(&mut out, |w| drop(w.copying(at, &vec![1.0; length])));
            }));
            assert!(written.is_err(), "{length} at {at}");
            assert_eq!(out, [0.0; 8]);
        }
    }
}
