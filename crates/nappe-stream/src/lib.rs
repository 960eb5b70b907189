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

use std::slice::{Iter, IterMut};

/// Where results go, one part after the other or in any order.
pub struct Writer<'a> {
    out: &'a mut [f64],
}

impl Writer<'_> {
    /// Begins to copy `from` to the places that start at index `at`. What [`Copying::step`] has not copied when it is
    /// dropped is copied then.
    ///
    /// Panics if the places do not all exist.
    #[inline(always)]
    pub fn copying<'a>(&'a mut self, at: usize, from: &'a [f64]) -> Copying<'a> {
        let to = &mut self.out[at..][..from.len()];
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
        }
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
    fill(&mut Writer { out })
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
        // (`copying` sees to it), and pairs are 16 bytes apart. The fence that must come before other accesses: nothing
        // can reach the places before `stream` returns or unwinds, since it holds the only borrow of them, and it ends
        // with one.
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
