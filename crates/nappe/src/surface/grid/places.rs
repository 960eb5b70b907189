//! Where points go: through the caches or past them.

use crate::simd::Registers;
use nappe_stream::{LINE, Lines, Writer};
use pulp::bytemuck::{Pod, cast_slice, cast_slice_mut};
use std::mem::{swap, take};

/// A result of so many bytes is written past the caches, which could not keep it. With less, a caller may read it where it
/// still is: in the second-level cache or its share of the last-level one.
pub(super) const LARGE: usize = 1 << 24;

/// The most numbers that a block of points takes: derivatives up to order 2 of eight points.
const MOST: usize = 3 * 6 * 8;

/// Where all points go.
pub(super) enum Places<'a, 'w> {
    /// Through the caches.
    Near(&'a mut [f64]),
    /// To memory.
    Far(Far<'a, 'w>),
}

impl Places<'_, '_> {
    /// Hands on the way to places of points of `each` numbers: to memory if all together take `large` bytes or more.
    pub(super) fn of<T: Pod>(out: &mut [T], each: usize, large: usize, fill: impl FnOnce(Places)) {
        let is_large = size_of_val(out) >= large;
        let out: &mut [f64] = cast_slice_mut(out);
        // Points of an even number of places never begin where a line does if the first one is at an odd place.
        let is_odd = !(out.as_ptr() as usize).is_multiple_of(2 * size_of::<f64>());
        if is_large && (each % 2 == 1 || !is_odd) {
            nappe_stream::stream(out, |writer| {
                fill(Places::Far(Far {
                    writer,
                    join: Vec::new(),
                    join_at: 0,
                    tail: Vec::new(),
                }));
            });
        } else {
            fill(Places::Near(out));
        }
    }
}

/// The way to memory, in whole lines of the cache: a store of less would read the line first.
pub(super) struct Far<'a, 'w> {
    writer: &'a mut Writer<'w>,
    /// What waits for the rest of its line, and where it goes.
    join: Vec<f64>,
    join_at: usize,
    /// What is left of a row behind its lines.
    tail: Vec<f64>,
}

impl Far<'_, '_> {
    /// How many points from a place on come before one that begins where a line does.
    pub(super) fn head(&self, at: usize, each: usize) -> usize {
        let places = self.writer.to_line(at);
        let is_head = |head: &usize| head * each % LINE == places;
        (0..LINE).find(is_head).unwrap_or(0)
    }

    /// Begins a row of `width` numbers, of which `head` come before its lines, in blocks of so many numbers. It ends with
    /// [`Self::end`].
    pub(super) fn begin<R: Registers>(
        &mut self,
        r: R,
        at: usize,
        [width, head, block]: [usize; 3],
    ) -> (To<'_, R>, Begun) {
        if self.join_at + self.join.len() != at {
            self.flush();
            self.join_at = at;
        }
        let unit = if block.is_multiple_of(LINE) {
            block
        } else {
            block * LINE
        };
        let main = (width - head) / unit * unit;
        let is_joined = main > 0 && self.writer.to_line(self.join_at) == 0;
        let first = if is_joined { self.join_at } else { at + head };
        let lines = if main > 0 {
            self.writer.lines(first, at + head + main - first)
        } else {
            Lines::default()
        };
        let mut row = Row {
            head,
            join: &mut self.join,
            is_joined,
            lines,
            rest: width - head - main,
            tail: &mut self.tail,
        };
        if head == 0 {
            row.put_join(r);
        }
        let begun = Begun {
            end: at + width,
            is_joined,
            has_lines: main > 0,
        };
        (To::Far(row), begun)
    }

    /// Ends a row.
    pub(super) fn end(&mut self, row: Begun) {
        if row.has_lines {
            if !row.is_joined {
                self.writer.copy(self.join_at, &self.join);
            }
            self.join.clear();
            swap(&mut self.join, &mut self.tail);
            self.join_at = row.end - self.join.len();
        } else {
            self.join.append(&mut self.tail);
            if self.join.len() >= MOST {
                self.flush();
            }
        }
    }

    /// Writes what waits.
    pub(super) fn flush(&mut self) {
        self.writer.copy(self.join_at, &self.join);
        self.join_at += self.join.len();
        self.join.clear();
    }
}

/// A row that was begun.
pub(super) struct Begun {
    end: usize,
    is_joined: bool,
    has_lines: bool,
}

/// Where a row goes: what it writes comes one after the other.
pub(super) enum To<'a, R: Registers> {
    /// The places that are left.
    Near(&'a mut [f64]),
    Far(Row<'a, R>),
}

/// A row on its way to memory.
pub(super) struct Row<'a, R: Registers> {
    /// How many numbers are to come before its lines.
    head: usize,
    /// What comes before the head.
    join: &'a mut Vec<f64>,
    /// The lines begin with what comes before.
    is_joined: bool,
    lines: Lines<'a, R::Array>,
    /// How many numbers come behind the lines, and those that came.
    rest: usize,
    tail: &'a mut Vec<f64>,
}

impl<R: Registers> To<'_, R> {
    /// Writes registers one after the other; behind the end of the row nothing.
    #[inline(always)]
    pub(super) fn registers<const N: usize>(&mut self, r: R, x: [R::Array; N]) {
        match self {
            Self::Near(rest) if rest.len() >= N * R::LANES => {
                let (now, later) = take(rest).split_at_mut(N * R::LANES);
                let places = &mut R::arrays_mut(now)[..N];
                // One by one they go from registers to their places; as a slice they would be copied from the stack.
                #[allow(clippy::manual_memcpy)]
                for k in 0..N {
                    places[k] = x[k];
                }
                *rest = later;
            }
            Self::Far(row) if row.head == 0 && row.lines.left() >= N => {
                for k in 0..N {
                    row.lines.put(r.stores(), x[k]);
                }
            }
            _ => {
                // A copy: what a function is given has a place in memory, also where it is not called.
                let copy = x;
                self.part(r, cast_slice(&copy));
            }
        }
    }

    /// Writes so many numbers, which `fill` puts to their places.
    #[inline(always)]
    pub(super) fn numbers(&mut self, r: R, count: usize, fill: impl FnOnce(&mut [f64])) {
        if let Self::Near(rest) = self
            && rest.len() >= count
        {
            let (now, later) = take(rest).split_at_mut(count);
            fill(now);
            *rest = later;
        } else {
            let mut block = [0.0; MOST];
            fill(&mut block[..count]);
            self.part(r, &block[..count]);
        }
    }

    /// Writes numbers that may be a part of a block alone.
    #[cold]
    #[inline(never)]
    fn part(&mut self, r: R, x: &[f64]) {
        match self {
            Self::Near(rest) => {
                let count = rest.len().min(x.len());
                let (now, later) = take(rest).split_at_mut(count);
                now.copy_from_slice(&x[..count]);
                *rest = later;
            }
            Self::Far(row) if row.head > 0 => {
                let count = row.head.min(x.len());
                row.join.extend_from_slice(&x[..count]);
                row.head -= count;
                if row.head == 0 {
                    row.put_join(r);
                }
            }
            Self::Far(row) if row.lines.left() * R::LANES >= x.len() => {
                for &x in R::arrays(x) {
                    row.lines.put(r.stores(), x);
                }
            }
            Self::Far(row) => {
                let count = row.rest.min(x.len());
                row.tail.extend_from_slice(&x[..count]);
                row.rest -= count;
            }
        }
    }
}

impl<R: Registers> Row<'_, R> {
    /// Writes what comes before the row's own lines, if it goes with them.
    fn put_join(&mut self, r: R) {
        if self.is_joined {
            for &x in R::arrays(self.join) {
                self.lines.put(r.stores(), x);
            }
            self.join.clear();
        }
    }
}
