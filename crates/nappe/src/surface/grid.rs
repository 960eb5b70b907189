//! Grids of separable surfaces: n + m evaluations of the sides and one small matrix product.
//!
//! For each row (one u) the core is collapsed to a short list of vectors; then a register of neighbouring columns at a
//! time takes their products with the functions of v. The operations of a point are those of [`Surface::jet`] in the
//! same order, so the result is the same to the last bit, with every instruction set.

mod blocks;
mod columns;
mod output;
mod places;
mod row;
mod rows;
#[cfg(test)]
mod tests;

use super::{Dir, Separable, Surface, jet_len};
use crate::breaks::{Breaks, Limit};
use crate::simd::{InstructionSet, Kernel, Registers};
use glam::DVec3;
use output::{JetOutput, NormalOutput};
use places::{LARGE, Places};
use rows::evaluate;

/// The highest order of derivative that kernels write.
pub(super) const KERNEL_ORDER: usize = 2;

/// A grid to evaluate.
struct Grid<'a, 'w> {
    surface: &'a Separable,
    u: &'a [f64],
    v: &'a [f64],
    out: Places<'a, 'w>,
}

/// The derivatives up to `ORDER` of every point of a grid, point by point.
struct Jets<'a, 'w, const ORDER: usize, const JET: usize>(Grid<'a, 'w>);

impl<const ORDER: usize, const JET: usize> Kernel for Jets<'_, '_, ORDER, JET> {
    #[inline(always)]
    fn run<R: Registers>(self, r: R) {
        let Grid {
            surface,
            u,
            v,
            mut out,
        } = self.0;
        // Without negative zeros, so that the sum with a zero of any sign has the positive one.
        let origin = surface.origin() + DVec3::ZERO;
        let output = JetOutput { r, origin };
        evaluate::<R, _, ORDER, JET>(r, surface, [u, v], &mut out, &output);
    }
}

/// The size of a result that goes to memory past the caches: what is narrow has few whole lines in a row.
fn large(v: &[f64]) -> usize {
    const NARROW: usize = 64;
    if v.len() < NARROW { usize::MAX } else { LARGE }
}

/// The derivatives up to an order of at most [`KERNEL_ORDER`] of every point of a grid.
pub(super) fn jets(surface: &Separable, u: &[f64], v: &[f64], order: usize, out: &mut [DVec3]) {
    Places::of(out, 3 * jet_len(order), large(v), |out| {
        jets_on(InstructionSet::best(), Grid { surface, u, v, out }, order);
    });
}

fn jets_on(set: InstructionSet, grid: Grid, order: usize) {
    match order {
        0 => set.run(Jets::<0, 1>(grid)),
        1 => set.run(Jets::<1, 3>(grid)),
        _ => set.run(Jets::<2, 6>(grid)),
    }
}

/// Points and unit normals of a grid.
struct Normals<'a, 'w> {
    grid: Grid<'a, 'w>,
    /// The widths of the pieces that the parameters lie in.
    widths: [Vec<f64>; 2],
}

impl Kernel for Normals<'_, '_> {
    #[inline(always)]
    fn run<R: Registers>(self, r: R) {
        let Grid {
            surface,
            u,
            v,
            mut out,
        } = self.grid;
        let mut widths = self.widths;
        let last = widths[1].last().copied();
        widths[1].resize(v.len() + R::LANES, last.unwrap_or(1.0));
        let output = NormalOutput {
            r,
            surface,
            uv: [u, v],
            widths,
        };
        evaluate::<R, _, 1, 3>(r, surface, [u, v], &mut out, &output);
    }
}

/// Points and unit normals of a grid. Where the tangents may not span a plane, [`normal_at`] decides.
pub(super) fn normals(surface: &Separable, u: &[f64], v: &[f64], out: &mut [[DVec3; 2]]) {
    Places::of(out, 6, large(v), |out| {
        normals_on(InstructionSet::best(), Grid { surface, u, v, out });
    });
}

fn normals_on(set: InstructionSet, grid: Grid) {
    let widths = |dir, t: &[f64]| -> Vec<f64> {
        let breaks = grid.surface.breaks(dir);
        let width = |&t: &f64| breaks.piece(breaks.find(t, Limit::Above)).width();
        t.iter().map(width).collect()
    };
    let widths = [widths(Dir::U, grid.u), widths(Dir::V, grid.v)];
    set.run(Normals { grid, widths });
}
