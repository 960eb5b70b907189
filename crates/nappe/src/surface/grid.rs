//! Grids of separable surfaces: n + m evaluations of the sides and one small matrix product.
//!
//! For each row (one u) the core is collapsed to a short list of vectors; then [`QUAD`] neighbouring columns at a time
//! take their products with the functions of v. The operations of a point are those of
//! [`Surface::jet`] in the same order, so the result is the same to the last bit, with every instruction set.

use super::normal::is_plain;
use super::quotient::quotient;
use super::{Core, Dir, Separable, Surface, jet_index, normal_at};
use crate::breaks::{Breaks, Limit};
use crate::simd::{Lanes, QUAD, QuadKernel, Quads, with_quads};
use glam::{DVec3, DVec4};
use smallvec::SmallVec;
use std::ops::Range;

/// The highest order of derivative that kernels write.
pub(super) const KERNEL_ORDER: usize = 2;

/// How many columns are prepared together: their functions fill a part of the second-level cache.
const COLUMNS: usize = 2048;

/// Columns that are evaluated together: neighbours in one piece of v.
struct Block {
    columns: Range<usize>,
    active: Range<usize>,
    /// Where their functions start: for each derivative and each active function one value a lane.
    at: usize,
}

/// The functions of v at some columns.
struct Columns {
    blocks: Vec<Block>,
    values: Vec<f64>,
}

impl Columns {
    fn new(surface: &Separable, v: &[f64], order: usize) -> Self {
        let functions = surface.functions_v();
        let active: Vec<_> = v
            .iter()
            .map(|&v| functions.active(v, Limit::Above))
            .collect();
        let (mut blocks, mut values) = (Vec::new(), Vec::new());
        let mut buffer: Vec<f64> = Vec::new();
        let mut start = 0;
        while start < v.len() {
            let range = active[start].clone();
            let (n, at) = (range.len(), values.len());
            let same = active[start..].iter().take(QUAD);
            let end = start + same.take_while(|a| **a == range).count();
            values.resize(at + (order + 1) * n * QUAD, 0.0);
            buffer.resize((order + 1) * n, 0.0);
            for (lane, &v) in v[start..end].iter().enumerate() {
                functions.jet_into(v, Limit::Above, order, &mut buffer);
                for (k, &x) in buffer.iter().enumerate() {
                    values[at + k * QUAD + lane] = x;
                }
            }
            blocks.push(Block {
                columns: start..end,
                active: range,
                at,
            });
            start = end;
        }
        Self { blocks, values }
    }
}

/// For each coordinate the functions of v that it depends on: most functions of a Coons surface move one coordinate.
fn used(surface: &Separable) -> Option<[Vec<usize>; 4]> {
    let Core::Terms(terms) = surface.core() else {
        return None;
    };
    let dimensions = if surface.is_rational() { 4 } else { 3 };
    Some(std::array::from_fn(|c| {
        let mut js: Vec<usize> = terms
            .iter()
            .filter(|t| c < dimensions && t.c[c] != 0.0)
            .map(|t| t.j)
            .collect();
        js.sort_unstable();
        js.dedup();
        js
    }))
}

/// Evaluates a grid with derivatives up to `ORDER` and hands on [`QUAD`] points at a time: the row, the columns and
/// the derivatives (without the surface's origin).
#[inline(always)]
fn evaluate<Q: Quads, const ORDER: usize, const JET: usize>(
    quads: Q,
    surface: &Separable,
    u: &[f64],
    v: &[f64],
    mut put: impl FnMut(usize, Range<usize>, &[[Lanes<Q>; 3]; JET]),
) {
    let count = surface.functions_v().count();
    let (used, rational) = (used(surface), surface.is_rational());
    let mut k = vec![[0.0; 4]; (ORDER + 1) * count];
    let mut a: SmallVec<[f64; 32]> = SmallVec::new();
    for (tile, v) in v.chunks(COLUMNS).enumerate() {
        let columns = Columns::new(surface, v, ORDER);
        for (row, &u) in u.iter().enumerate() {
            let side = surface.functions_u();
            let active = side.active_jet(u, Limit::Above, ORDER, &mut a);
            match surface.core() {
                Core::Net(net) => collapse_net(&a, &net[active.start * count..], count, &mut k),
                Core::Terms(_) => {
                    surface.collapse(&a, [active, 0..count], None, false, &mut k);
                }
            }
            for b in &columns.blocks {
                let values = &columns.values[b.at..][..(ORDER + 1) * b.active.len() * QUAD];
                let zero = Lanes::splat(quads, 0.0);
                let mut h = [[zero; 4]; JET];
                for p in 0..=ORDER {
                    let k = &k[p * count..][b.active.clone()];
                    for q in 0..=ORDER - p {
                        let f = &values[q * b.active.len() * QUAD..][..b.active.len() * QUAD];
                        let f = f.as_chunks::<QUAD>().0;
                        let h = &mut h[jet_index(p, q)];
                        match (&used, rational) {
                            (None, false) => product::<Q, 3>(quads, f, k, h),
                            (None, true) => product::<Q, 4>(quads, f, k, h),
                            (Some(used), _) => sparse(quads, f, k, used, b.active.start, h),
                        }
                    }
                }
                let mut r = [[zero; 3]; JET];
                if rational {
                    r = quotient(&h);
                } else {
                    for k in 0..JET {
                        r[k] = [h[k][0], h[k][1], h[k][2]];
                    }
                }
                let at = tile * COLUMNS;
                put(row, at + b.columns.start..at + b.columns.end, &r);
            }
        }
    }
}

/// `K_j⁽ᵖ⁾ = Σ_i a_i⁽ᵖ⁾ C_ij` of a net that starts with the first active row and has rows of `count` points.
#[inline(always)]
fn collapse_net(a: &[f64], net: &[DVec4], count: usize, k: &mut [[f64; 4]]) {
    let n = a.len() / (k.len() / count);
    for (k, a) in k.chunks_exact_mut(count).zip(a.chunks_exact(n)) {
        k.fill([0.0; 4]);
        for (&a, row) in a.iter().zip(net.chunks_exact(count)) {
            for (k, c) in k.iter_mut().zip(row) {
                *k = [
                    k[0] + a * c.x,
                    k[1] + a * c.y,
                    k[2] + a * c.z,
                    k[3] + a * c.w,
                ];
            }
        }
    }
}

/// `Σ_j b_j K_j` for all lanes, in the first `D` coordinates.
#[inline(always)]
fn product<Q: Quads, const D: usize>(
    q: Q,
    f: &[[f64; QUAD]],
    k: &[[f64; 4]],
    h: &mut [Lanes<Q>; 4],
) {
    let mut sum = [q.splat(0.0); D];
    for (f, k) in f.iter().zip(k) {
        let f = q.load(*f);
        for c in 0..D {
            sum[c] = q.add_product(sum[c], f, q.splat(k[c]));
        }
    }
    for c in 0..D {
        h[c] = Lanes(q, sum[c]);
    }
}

/// The same where each coordinate has its own list of functions.
#[inline(always)]
fn sparse<Q: Quads>(
    q: Q,
    f: &[[f64; QUAD]],
    k: &[[f64; 4]],
    used: &[Vec<usize>; 4],
    start: usize,
    h: &mut [Lanes<Q>; 4],
) {
    for c in 0..4 {
        let mut sum = q.splat(0.0);
        for j in &used[c] {
            let j = j.wrapping_sub(start);
            if let (Some(f), Some(k)) = (f.get(j), k.get(j)) {
                sum = q.add_product(sum, q.load(*f), q.splat(k[c]));
            }
        }
        h[c] = Lanes(q, sum);
    }
}

/// The points in all lanes.
#[inline(always)]
fn points<Q: Quads>(q: Q, x: &[Lanes<Q>; 3]) -> [DVec3; QUAD] {
    pulp::bytemuck::cast(q.interleave(x[0].1, x[1].1, x[2].1))
}

/// `x + origin`.
#[inline(always)]
fn moved<Q: Quads>(q: Q, x: &[Lanes<Q>; 3], origin: DVec3) -> [Lanes<Q>; 3] {
    [
        x[0] + Lanes::splat(q, origin.x),
        x[1] + Lanes::splat(q, origin.y),
        x[2] + Lanes::splat(q, origin.z),
    ]
}

/// `x · x`, summed as [`DVec3::length_squared`] does.
#[inline(always)]
fn square<Q: Quads>(x: &[Lanes<Q>; 3]) -> Lanes<Q> {
    x[0] * x[0] + x[1] * x[1] + x[2] * x[2]
}

/// A grid to evaluate.
struct Grid<'a, T> {
    surface: &'a Separable,
    u: &'a [f64],
    v: &'a [f64],
    out: &'a mut [T],
}

/// The derivatives up to `ORDER` of every point of a grid, point by point.
struct Jets<'a, const ORDER: usize, const JET: usize>(Grid<'a, DVec3>);

impl<const ORDER: usize, const JET: usize> QuadKernel for Jets<'_, ORDER, JET> {
    #[inline(always)]
    fn run<Q: Quads>(self, q: Q) {
        let Grid { surface, u, v, out } = self.0;
        let origin = surface.origin();
        let out = out.as_chunks_mut::<JET>().0;
        evaluate::<Q, ORDER, JET>(
            q,
            surface,
            u,
            v,
            #[inline(always)]
            |row, columns, r| {
                let out = &mut out[row * v.len() + columns.start..][..columns.len()];
                let mut jets = [[DVec3::ZERO; JET]; QUAD];
                for k in 0..JET {
                    let four = if k == 0 {
                        points(q, &moved(q, &r[0], origin))
                    } else {
                        points(q, &r[k])
                    };
                    for lane in 0..QUAD {
                        jets[lane][k] = four[lane];
                    }
                }
                // Full blocks apart: the compiler then knows the length.
                match out.first_chunk_mut::<QUAD>() {
                    Some(out) => *out = jets,
                    None => out.copy_from_slice(&jets[..out.len()]),
                }
            },
        );
    }
}

/// The derivatives up to an order of at most [`KERNEL_ORDER`] of every point of a grid.
pub(super) fn jets(surface: &Separable, u: &[f64], v: &[f64], order: usize, out: &mut [DVec3]) {
    let grid = Grid { surface, u, v, out };
    match order {
        0 => with_quads(Jets::<0, 1>(grid)),
        1 => with_quads(Jets::<1, 3>(grid)),
        _ => with_quads(Jets::<2, 6>(grid)),
    }
}

/// Points and unit normals of a grid.
struct Normals<'a> {
    grid: Grid<'a, [DVec3; 2]>,
    /// The widths of the pieces that the parameters lie in; some more for v, since a block may reach beyond the end.
    widths: [Vec<f64>; 2],
}

impl QuadKernel for Normals<'_> {
    #[inline(always)]
    fn run<Q: Quads>(self, q: Q) {
        let Grid { surface, u, v, out } = self.grid;
        let [du, dv] = self.widths;
        let origin = surface.origin();
        evaluate::<Q, 1, 3>(
            q,
            surface,
            u,
            v,
            #[inline(always)]
            |row, columns, r| {
                let dv = dv[columns.start..].first_chunk().unwrap_or(&[0.0; QUAD]);
                let (du, dv) = (Lanes::splat(q, du[row]), Lanes(q, q.load(*dv)));
                let at = moved(q, &r[0], origin);
                let a = [r[1][0] * du, r[1][1] * du, r[1][2] * du];
                let b = [r[2][0] * dv, r[2][1] * dv, r[2][2] * dv];
                let n = [
                    a[1] * b[2] - b[1] * a[2],
                    a[2] * b[0] - b[2] * a[0],
                    a[0] * b[1] - b[0] * a[1],
                ];
                let (nn, aa, bb, rr) = (square(&n), square(&a), square(&b), square(&at));
                let inverse = Lanes::splat(q, 1.0) / nn.sqrt();
                let n = [n[0] * inverse, n[1] * inverse, n[2] * inverse];
                let (at, n) = (points(q, &at), points(q, &n));
                let out = &mut out[row * v.len() + columns.start..][..columns.len()];
                for (o, (at, n)) in out.iter_mut().zip(at.into_iter().zip(n)) {
                    *o = [at, n];
                }
                let (nn, aa, bb, rr) = (nn.store(), aa.store(), bb.store(), rr.store());
                let mut regular = true;
                for l in 0..QUAD {
                    regular &= is_plain(nn[l], aa[l], bb[l], rr[l]) | (l >= columns.len());
                }
                if !regular {
                    for (o, v) in out.iter_mut().zip(&v[columns]) {
                        let normal = normal_at(surface, [u[row], *v], [Limit::Above; 2]);
                        o[1] = normal.vector().unwrap_or(DVec3::ZERO);
                    }
                }
            },
        );
    }
}

/// Points and unit normals of a grid. Where the tangents may not span a plane, [`normal_at`] decides.
pub(super) fn normals(surface: &Separable, u: &[f64], v: &[f64], out: &mut [[DVec3; 2]]) {
    let widths = |dir, t: &[f64]| -> Vec<f64> {
        let breaks = surface.breaks(dir);
        let width = |&t: &f64| breaks.piece(breaks.find(t, Limit::Above)).width();
        t.iter().map(width).collect()
    };
    let mut widths = [widths(Dir::U, u), widths(Dir::V, v)];
    widths[1].resize(v.len() + QUAD, 0.0);
    with_quads(Normals {
        grid: Grid { surface, u, v, out },
        widths,
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::NurbsSurface;
    use crate::laws::Random;
    use crate::simd::Plain;

    fn example(weights: bool) -> Separable {
        let mut random = Random(3);
        let points: Vec<DVec3> = (0..42)
            .map(|i| DVec3::new((i / 7) as f64, (i % 7) as f64, random.unit()))
            .collect();
        let weights: Option<Vec<f64>> =
            weights.then(|| (0..42).map(|_| 0.5 + random.unit()).collect());
        let knots = [6, 7].map(|n| crate::basis::BSplineBasis::clamped_uniform(3, n));
        let s = NurbsSurface::new([3, 3], knots, &points, weights.as_deref()).unwrap();
        s.separable().clone()
    }

    #[test]
    fn all_instruction_sets_give_the_bits_of_the_plain_path() {
        let t: Vec<f64> = (0..37).map(|i| i as f64 / 36.0).collect();
        for surface in [example(false), example(true)] {
            let mut out = [(); 2].map(|_| vec![DVec3::ZERO; 6 * 37 * 37]);
            jets(&surface, &t, &t, 2, &mut out[0]);
            let grid = Grid {
                surface: &surface,
                u: &t,
                v: &t,
                out: &mut out[1],
            };
            Jets::<2, 6>(grid).run(Plain);
            assert_eq!(out[0], out[1]);
        }
    }
}
