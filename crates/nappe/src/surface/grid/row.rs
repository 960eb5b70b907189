//! A part of a row whose columns have the same active functions: sums of products, a register of columns at a time.

use super::KERNEL_ORDER;
use super::blocks::Run;
use super::output::Output;
use super::places::To;
use crate::scalar::Pack;
use crate::simd::{Lanes, Registers};
use crate::surface::jet_index;
use crate::surface::quotient::{quotient, quotient_with};

/// The blocks of a run, in one row.
pub(super) struct Part<'a, R: Registers> {
    pub(super) r: R,
    pub(super) row: usize,
    pub(super) run: &'a Run,
    /// The first column of each block, from the tile's first one on, and that one.
    pub(super) columns: &'a [usize],
    pub(super) first: usize,
    /// The functions of v of each block.
    pub(super) functions: &'a [f64],
    /// The vectors of the row that the functions take, for each derivative by u.
    pub(super) k: [&'a [[f64; 4]]; KERNEL_ORDER + 1],
    /// Quotients may be computed with [`Lanes::div_by`].
    pub(super) is_quick: bool,
}

/// The homogeneous derivatives at the columns of a block.
pub(super) struct Block<R: Registers, const JET: usize> {
    h: [[Lanes<R>; 4]; JET],
    is_quick: bool,
}

impl<R: Registers, const JET: usize> Block<R, JET> {
    pub(super) fn new(r: R) -> Self {
        Self {
            h: [[Lanes::splat(r, 0.0); 4]; JET],
            is_quick: false,
        }
    }

    /// This block with the lanes of another one from some lane on.
    #[inline(always)]
    fn joined<const D: usize>(&self, next: &mut Self, r: R, lane: usize) {
        let lanes: [f64; Pack::LANES] = std::array::from_fn(|l| l as f64);
        let number = Lanes::load(r, &lanes[..R::LANES]);
        let bound = Lanes::splat(r, lane as f64 - 0.5);
        for (next, before) in next.h.iter_mut().zip(&self.h) {
            for c in 0..D {
                next[c] = number.where_greater(bound, [next[c], before[c]]);
            }
        }
        next.is_quick &= self.is_quick;
    }
}

impl<R: Registers> Part<'_, R> {
    /// Evaluates the run. `before` is the block that its first one shares, and becomes the one that its last one shares.
    /// `SHARED` functions are those of all coordinates; else each has its own.
    #[inline(always)]
    pub(super) fn evaluate<
        O: Output<R, JET>,
        const SHARED: bool,
        const D: usize,
        const ORDER: usize,
        const JET: usize,
    >(
        &self,
        to: &mut To<R>,
        before: &mut Block<R, JET>,
        output: &O,
    ) {
        match self.k[0].len() {
            2 if JET < 6 => self.unrolled::<O, SHARED, D, 2, ORDER, JET>(to, before, output),
            3 if JET < 6 => self.unrolled::<O, SHARED, D, 3, ORDER, JET>(to, before, output),
            4 if JET < 6 => self.unrolled::<O, SHARED, D, 4, ORDER, JET>(to, before, output),
            5 if JET < 6 => self.unrolled::<O, SHARED, D, 5, ORDER, JET>(to, before, output),
            6 if JET < 6 => self.unrolled::<O, SHARED, D, 6, ORDER, JET>(to, before, output),
            n => {
                let r = self.r;
                let width = if SHARED { 1 } else { D };
                self.blocks::<O, D, ORDER, JET>(
                    (ORDER + 1) * n * width,
                    to,
                    before,
                    output,
                    #[inline(always)]
                    |functions, p, q| {
                        let functions = &functions[q * n * width..];
                        let mut sum = [r.splat(0.0); D];
                        for (k, f) in self.k[p].iter().zip(functions.chunks_exact(width)) {
                            for c in 0..D {
                                let f = r.load(f[if SHARED { 0 } else { c }]);
                                sum[c] = r.add_product(sum[c], f, r.splat(k[c]));
                            }
                        }
                        sum
                    },
                );
            }
        }
    }

    /// The same for `N` functions of each coordinate. Sums of points start from their first products: a zero less changes
    /// at most the sign of a sum that is zero, and that is lost when the origin is added.
    #[inline(always)]
    fn unrolled<
        O: Output<R, JET>,
        const SHARED: bool,
        const D: usize,
        const N: usize,
        const ORDER: usize,
        const JET: usize,
    >(
        &self,
        to: &mut To<R>,
        before: &mut Block<R, JET>,
        output: &O,
    ) {
        let r = self.r;
        let width = if SHARED { 1 } else { D };
        let k = self.k.map(|k| k.first_chunk().unwrap_or(&[[0.0; 4]; N]));
        // Points alone leave room for the vectors in registers.
        let mut held = [[r.splat(0.0); D]; N];
        if JET == 1 {
            for j in 0..N {
                for c in 0..D {
                    held[j][c] = r.splat(k[0][j][c]);
                }
            }
        }
        self.blocks::<O, D, ORDER, JET>(
            (ORDER + 1) * N * width,
            to,
            before,
            output,
            #[inline(always)]
            |functions, p, q| {
                let mut sum = [r.splat(0.0); D];
                for j in 0..N {
                    for c in 0..D {
                        let at = (q * N + j) * width + if SHARED { 0 } else { c };
                        let f = r.load(functions[at]);
                        let k = if JET == 1 {
                            held[j][c]
                        } else {
                            r.splat(k[p][j][c])
                        };
                        sum[c] = if j == 0 && (JET == 1 || D == 3 && p + q == 0) {
                            r.mul(f, k)
                        } else {
                            r.add_product(sum[c], f, k)
                        };
                    }
                }
                sum
            },
        );
    }

    /// All blocks, of `each` registers of functions; `sum` gives `Σ_j b_j⁽ᑫ⁾ K_j⁽ᵖ⁾` of a block from its functions, p and q.
    #[inline(always)]
    fn blocks<O: Output<R, JET>, const D: usize, const ORDER: usize, const JET: usize>(
        &self,
        each: usize,
        to: &mut To<R>,
        before: &mut Block<R, JET>,
        output: &O,
        sum: impl Fn(&[R::Array], usize, usize) -> [R::Register; D],
    ) {
        let functions = R::arrays(self.functions);
        let last = self.columns.len() - 1;
        for (number, &column) in self.columns.iter().enumerate() {
            let functions = &functions[number * each..][..each];
            let mut block = Block {
                h: self.sums::<D, ORDER, JET>(functions, &sum),
                is_quick: self.is_quick,
            };
            if number == 0 && self.run.lane > 0 {
                before.joined::<D>(&mut block, self.r, self.run.lane);
            }
            if number == last && self.run.is_shared {
                *before = block;
                return;
            }
            let x = self.divided::<D, JET>(&block);
            output.put(self.row, self.first + column, &x, to);
        }
    }

    /// The homogeneous derivatives of a block.
    #[inline(always)]
    fn sums<const D: usize, const ORDER: usize, const JET: usize>(
        &self,
        functions: &[R::Array],
        sum: &impl Fn(&[R::Array], usize, usize) -> [R::Register; D],
    ) -> [[Lanes<R>; 4]; JET] {
        let mut h = [[Lanes::splat(self.r, 0.0); 4]; JET];
        // One by one: the compiler takes loops apart too late to keep what sums share in registers.
        h[0] = self.lanes(sum(functions, 0, 0));
        if ORDER >= 1 {
            h[jet_index(1, 0)] = self.lanes(sum(functions, 1, 0));
            h[jet_index(0, 1)] = self.lanes(sum(functions, 0, 1));
        }
        if ORDER >= 2 {
            h[jet_index(2, 0)] = self.lanes(sum(functions, 2, 0));
            h[jet_index(1, 1)] = self.lanes(sum(functions, 1, 1));
            h[jet_index(0, 2)] = self.lanes(sum(functions, 0, 2));
        }
        h
    }

    /// `D` coordinates, with zero behind them.
    #[inline(always)]
    fn lanes<const D: usize>(&self, x: [R::Register; D]) -> [Lanes<R>; 4] {
        let mut lanes = [Lanes::splat(self.r, 0.0); 4];
        for c in 0..D {
            lanes[c] = Lanes(self.r, x[c]);
        }
        lanes
    }

    /// The derivatives at the columns of a block without the surface's origin.
    #[inline(always)]
    fn divided<const D: usize, const JET: usize>(
        &self,
        Block { h, is_quick }: &Block<R, JET>,
    ) -> [[Lanes<R>; 3]; JET] {
        if D == 3 {
            let mut x = [[h[0][0]; 3]; JET];
            for k in 0..JET {
                x[k] = [h[k][0], h[k][1], h[k][2]];
            }
            x
        } else if *is_quick {
            let inverse = Lanes::splat(self.r, 1.0) / h[0][3];
            quotient_with(
                h,
                #[inline(always)]
                |x| x.div_by(h[0][3], inverse),
            )
        } else {
            quotient(h)
        }
    }
}
