//! Grids of separable surfaces: n + m evaluations of the sides and one small matrix product.
//!
//! For each row (one u) the core is collapsed to a short list of vectors; then [`LANES`] neighbouring columns at a time
//! take their products with the functions of v. The operations of a point are those of
//! [`Surface::jet`] in the same order, so the result is the same to the last bit, with every instruction set.

use super::normal::is_plain;
use super::quotient::quotient;
use super::{Core, Dir, Separable, Surface, normal_at};
use crate::breaks::{Breaks, Limit};
use crate::simd::{LANES, Lanes, widest};
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
            let same = active[start..].iter().take(LANES);
            let end = start + same.take_while(|a| **a == range).count();
            values.resize(at + (order + 1) * n * LANES, 0.0);
            buffer.resize((order + 1) * n, 0.0);
            for (lane, &v) in v[start..end].iter().enumerate() {
                functions.jet_into(v, Limit::Above, order, &mut buffer);
                for (k, &x) in buffer.iter().enumerate() {
                    values[at + k * LANES + lane] = x;
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

/// Evaluates a grid with derivatives up to `ORDER` and hands on [`LANES`] points at a time: the row, the columns and
/// the derivatives (without the surface's origin).
#[inline(always)]
fn evaluate<const ORDER: usize, const JET: usize>(
    surface: &Separable,
    u: &[f64],
    v: &[f64],
    mut put: impl FnMut(usize, Range<usize>, &[[Lanes; 3]; JET]),
) {
    let count = surface.functions_v().count();
    let (used, rational) = (used(surface), surface.is_rational());
    let mut k = vec![[0.0; 4]; (ORDER + 1) * count];
    let mut a: SmallVec<[f64; 32]> = SmallVec::new();
    for (tile, v) in v.chunks(COLUMNS).enumerate() {
        let columns = Columns::new(surface, v, ORDER);
        for (row, &u) in u.iter().enumerate() {
            let active = surface.functions_u().active(u, Limit::Above);
            a.clear();
            a.resize((ORDER + 1) * active.len(), 0.0);
            surface
                .functions_u()
                .jet_into(u, Limit::Above, ORDER, &mut a);
            match surface.core() {
                Core::Net(net) => collapse_net(&a, &net[active.start * count..], count, &mut k),
                Core::Terms(_) => {
                    surface.collapse(&a, [active, 0..count], None, false, &mut k);
                }
            }
            for b in &columns.blocks {
                let values = &columns.values[b.at..][..(ORDER + 1) * b.active.len() * LANES];
                let mut h = [[Lanes::ZERO; 4]; JET];
                for p in 0..=ORDER {
                    let k = &k[p * count..][b.active.clone()];
                    for q in 0..=ORDER - p {
                        let f = &values[q * b.active.len() * LANES..][..b.active.len() * LANES];
                        let h = &mut h[(p + q) * (p + q + 1) / 2 + q];
                        match (&used, rational) {
                            (None, false) => product::<3>(f, k, h),
                            (None, true) => product::<4>(f, k, h),
                            (Some(used), _) => sparse(f, k, used, b.active.start, h),
                        }
                    }
                }
                let mut r = [[Lanes::ZERO; 3]; JET];
                if rational {
                    r = quotient(&h);
                } else {
                    for (r, h) in r.iter_mut().zip(&h) {
                        r.copy_from_slice(&h[..3]);
                    }
                }
                let at = tile * COLUMNS;
                put(row, at + b.columns.start..at + b.columns.end, &r);
            }
        }
    }
}

/// `K_j⁽ᵖ⁾ = Σ_i a_i⁽ᵖ⁾ C_ij` for all j, of a net that starts with the first active row.
#[inline(always)]
fn collapse_net(a: &[f64], net: &[DVec4], count: usize, k: &mut [[f64; 4]]) {
    let orders = k.len() / count;
    let n = a.len() / orders;
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
fn product<const D: usize>(f: &[f64], k: &[[f64; 4]], h: &mut [Lanes; 4]) {
    let mut sum = [[0.0; LANES]; D];
    for (f, k) in f.as_chunks::<LANES>().0.iter().zip(k) {
        for c in 0..D {
            for l in 0..LANES {
                sum[c][l] += f[l] * k[c];
            }
        }
    }
    for c in 0..D {
        h[c] = Lanes(sum[c]);
    }
}

/// The same where each coordinate has its own list of functions.
#[inline(always)]
fn sparse(f: &[f64], k: &[[f64; 4]], used: &[Vec<usize>; 4], start: usize, h: &mut [Lanes; 4]) {
    let f = f.as_chunks::<LANES>().0;
    for c in 0..4 {
        let mut sum = [0.0; LANES];
        for j in &used[c] {
            let j = j.wrapping_sub(start);
            if let (Some(f), Some(k)) = (f.get(j), k.get(j)) {
                for l in 0..LANES {
                    sum[l] += f[l] * k[c];
                }
            }
        }
        h[c] = Lanes(sum);
    }
}

#[inline(always)]
fn vector(x: &[Lanes; 3], lane: usize) -> DVec3 {
    DVec3::new(x[0].0[lane], x[1].0[lane], x[2].0[lane])
}

#[inline(always)]
fn jet<const JET: usize>(r: &[[Lanes; 3]; JET], lane: usize, origin: DVec3) -> [DVec3; JET] {
    let mut jet = [DVec3::ZERO; JET];
    for k in 0..JET {
        jet[k] = vector(&r[k], lane);
    }
    jet[0] += origin;
    jet
}

/// `x · x`, summed as [`DVec3::length_squared`] does.
#[inline(always)]
fn square(x: &[Lanes; 3]) -> Lanes {
    x[0] * x[0] + x[1] * x[1] + x[2] * x[2]
}

/// Writes the derivatives up to `ORDER` of every point of a grid, point by point.
#[inline(always)]
fn write<const ORDER: usize, const JET: usize>(
    surface: &Separable,
    u: &[f64],
    v: &[f64],
    out: &mut [DVec3],
) {
    let origin = surface.origin();
    evaluate::<ORDER, JET>(
        surface,
        u,
        v,
        #[inline(always)]
        |row, columns, r| {
            let out = &mut out[(row * v.len() + columns.start) * JET..][..columns.len() * JET];
            let out = out.as_chunks_mut::<JET>().0;
            // Full blocks apart: the compiler then knows the number of lanes.
            if let Some(full) = out.first_chunk_mut::<LANES>() {
                for lane in 0..LANES {
                    full[lane] = jet(r, lane, origin);
                }
            } else {
                for (lane, o) in out.iter_mut().enumerate() {
                    *o = jet(r, lane, origin);
                }
            }
        },
    );
}

/// The derivatives up to an order of at most [`KERNEL_ORDER`] of every point of a grid.
pub(super) fn jets(surface: &Separable, u: &[f64], v: &[f64], order: usize, out: &mut [DVec3]) {
    match order {
        0 => widest(
            #[inline(always)]
            || write::<0, 1>(surface, u, v, out),
        ),
        1 => widest(
            #[inline(always)]
            || write::<1, 3>(surface, u, v, out),
        ),
        _ => widest(
            #[inline(always)]
            || write::<2, 6>(surface, u, v, out),
        ),
    }
}

/// Points and unit normals of a grid. Where the tangents may not span a plane, [`normal_at`] decides.
pub(super) fn normals(surface: &Separable, u: &[f64], v: &[f64], out: &mut [[DVec3; 2]]) {
    let widths = |dir, t: &[f64]| -> Vec<f64> {
        let breaks = surface.breaks(dir);
        let width = |&t: &f64| breaks.piece(breaks.find(t, Limit::Above)).width();
        t.iter().map(width).collect()
    };
    let (du, mut dv) = (widths(Dir::U, u), widths(Dir::V, v));
    // A block may reach beyond the last column.
    dv.resize(v.len() + LANES, 0.0);
    let origin = surface.origin();
    let origins = origin.to_array().map(Lanes::from);
    widest(
        #[inline(always)]
        || {
            evaluate::<1, 3>(
                surface,
                u,
                v,
                #[inline(always)]
                |row, columns, r| {
                    let dv: &[f64; LANES] =
                        dv[columns.start..].first_chunk().unwrap_or(&[0.0; LANES]);
                    let (du, dv) = (Lanes::from(du[row]), Lanes(*dv));
                    let at = [
                        r[0][0] + origins[0],
                        r[0][1] + origins[1],
                        r[0][2] + origins[2],
                    ];
                    let a = [r[1][0] * du, r[1][1] * du, r[1][2] * du];
                    let b = [r[2][0] * dv, r[2][1] * dv, r[2][2] * dv];
                    let n = [
                        a[1] * b[2] - b[1] * a[2],
                        a[2] * b[0] - b[2] * a[0],
                        a[0] * b[1] - b[0] * a[1],
                    ];
                    let (nn, aa, bb, rr) = (square(&n), square(&a), square(&b), square(&at));
                    let mut inverse = nn;
                    for x in &mut inverse.0 {
                        *x = 1.0 / x.sqrt();
                    }
                    let n = [n[0] * inverse, n[1] * inverse, n[2] * inverse];
                    let out = &mut out[row * v.len() + columns.start..][..columns.len()];
                    if let Some(full) = out.first_chunk_mut::<LANES>() {
                        for lane in 0..LANES {
                            full[lane] = [vector(&at, lane), vector(&n, lane)];
                        }
                    } else {
                        for (lane, o) in out.iter_mut().enumerate() {
                            *o = [vector(&at, lane), vector(&n, lane)];
                        }
                    }
                    let mut regular = true;
                    for l in 0..LANES {
                        regular &=
                            is_plain(nn.0[l], aa.0[l], bb.0[l], rr.0[l]) | (l >= columns.len());
                    }
                    if !regular {
                        for (o, v) in out.iter_mut().zip(&v[columns]) {
                            let normal = normal_at(surface, [u[row], *v], [Limit::Above; 2]);
                            o[1] = normal.vector().unwrap_or(DVec3::ZERO);
                        }
                    }
                },
            );
        },
    );
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::NurbsSurface;
    use crate::laws::Random;

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
            write::<2, 6>(&surface, &t, &t, &mut out[1]);
            assert_eq!(out[0], out[1]);
        }
    }
}
