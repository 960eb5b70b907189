//! Grids of separable surfaces: n + m evaluations of the sides and one small matrix product.
//!
//! For each row (one u) the core is collapsed to a short list of vectors; then a register of neighbouring columns at a
//! time takes their products with the functions of v. The operations of a point are those of [`Surface::jet`] in the
//! same order, so the result is the same to the last bit, with every instruction set.

use super::normal::all_plain;
use super::quotient::{quotient, quotient_with};
use super::{Core, Dir, Separable, Surface, jet_index, normal_at};
use crate::breaks::{Breaks, Limit};
use crate::simd::{InstructionSet, Kernel, Lanes, Registers, far_from_limits};
use glam::{DVec3, DVec4};
use pulp::bytemuck::{cast_slice, cast_slice_mut};
use smallvec::SmallVec;
use std::ops::Range;

/// The highest order of derivative that kernels write.
pub(super) const KERNEL_ORDER: usize = 2;

/// How many columns are prepared together: their functions fill a part of the second-level cache.
const COLUMNS: usize = 2048;

/// Neighbouring columns with the same active functions of v.
struct Piece {
    active: Range<usize>,
    blocks: Vec<Block>,
    /// For each coordinate the active functions that it depends on: most functions of a Coons surface move one
    /// coordinate. Only for sparse cores.
    used: [Vec<usize>; 4],
}

/// Columns that are evaluated together, one a lane.
struct Block {
    columns: Range<usize>,
    /// Where their functions start: for each derivative and each active function one register.
    at: usize,
    /// All functions are [`far_from_limits`].
    moderate: bool,
}

/// The functions of v at some columns.
struct Columns {
    pieces: Vec<Piece>,
    values: Vec<f64>,
}

impl Columns {
    fn new(surface: &Separable, v: &[f64], order: usize, lanes: usize) -> Self {
        let functions = surface.functions_v();
        let active: Vec<_> = v
            .iter()
            .map(|&v| functions.active(v, Limit::Above))
            .collect();
        let (mut pieces, mut values) = (Vec::new(), Vec::new());
        let mut buffer: Vec<f64> = Vec::new();
        let mut start = 0;
        for same in active.chunk_by(|a, b| a == b) {
            let (range, columns) = (&same[0], start..start + same.len());
            buffer.resize((order + 1) * range.len(), 0.0);
            let mut of_columns = Vec::with_capacity(same.len() * buffer.len());
            for &v in &v[columns.clone()] {
                functions.jet_into(v, Limit::Above, order, &mut buffer);
                of_columns.extend_from_slice(&buffer);
            }
            let blocks = columns.clone().step_by(lanes).map(|first| {
                // The last block is full too where it can be: some columns are then evaluated twice.
                let first = first.min(columns.end.saturating_sub(lanes)).max(start);
                let at = values.len();
                for k in 0..buffer.len() {
                    values.extend((first..first + lanes).map(|column| {
                        // Lanes without a column repeat the last one.
                        let column = column.min(columns.end - 1) - start;
                        of_columns[column * buffer.len() + k]
                    }));
                }
                Block {
                    columns: first..columns.end.min(first + lanes),
                    at,
                    moderate: values[at..].iter().all(|&x| far_from_limits(x)),
                }
            });
            pieces.push(Piece {
                blocks: blocks.collect(),

                active: range.clone(),
                used: used(surface, range),
            });
            start = columns.end;
        }
        Self { pieces, values }
    }
}

/// The functions of v that each coordinate depends on, counted from the first active one; none if the core is a net.
fn used(surface: &Separable, active: &Range<usize>) -> [Vec<usize>; 4] {
    let Core::Terms(terms) = surface.core() else {
        return Default::default();
    };
    std::array::from_fn(|c| {
        let terms = terms.iter().filter(|t| t.c[c] != 0.0);
        let mut js: Vec<usize> = terms
            .filter(|t| active.contains(&t.j))
            .map(|t| t.j - active.start)
            .collect();
        js.sort_unstable();
        js.dedup();
        js
    })
}

/// A grid to evaluate.
struct Grid<'a, T> {
    surface: &'a Separable,
    u: &'a [f64],
    v: &'a [f64],
    out: &'a mut [T],
}

/// Evaluates a grid with derivatives up to `ORDER` and hands on a register of points at a time: the row, the columns
/// and the derivatives (without the surface's origin).
#[inline(always)]
fn evaluate<R: Registers, const ORDER: usize, const JET: usize>(
    r: R,
    surface: &Separable,
    [u, v]: [&[f64]; 2],
    put: impl FnMut(usize, Range<usize>, &[[Lanes<R>; 3]; JET]),
) {
    match (surface.core(), surface.is_rational()) {
        (Core::Net(net), false) => rows::<R, 3, ORDER, JET>(r, surface, Some(net), [u, v], put),
        (Core::Net(net), true) => rows::<R, 4, ORDER, JET>(r, surface, Some(net), [u, v], put),
        (Core::Terms(_), false) => rows::<R, 3, ORDER, JET>(r, surface, None, [u, v], put),
        (Core::Terms(_), true) => rows::<R, 4, ORDER, JET>(r, surface, None, [u, v], put),
    }
}

/// The same in `D` homogeneous coordinates, for a net or a sparse core.
#[inline(always)]
fn rows<R: Registers, const D: usize, const ORDER: usize, const JET: usize>(
    r: R,
    surface: &Separable,
    net: Option<&[DVec4]>,
    [u, v]: [&[f64]; 2],
    mut put: impl FnMut(usize, Range<usize>, &[[Lanes<R>; 3]; JET]),
) {
    let (side, count) = (surface.functions_u(), surface.functions_v().count());
    let zero = Lanes::splat(r, 0.0);
    let mut k = vec![[0.0; 4]; (ORDER + 1) * count];
    let mut factors = [const { Vec::new() }; 4];
    let mut a: SmallVec<[f64; 32]> = SmallVec::new();
    for (tile, v) in v.chunks(COLUMNS).enumerate() {
        let columns = Columns::new(surface, v, ORDER, R::LANES);
        for (row, &u) in u.iter().enumerate() {
            let active = side.active_jet(u, Limit::Above, ORDER, &mut a);
            match net {
                Some(net) => collapse_net(&a, &net[active.start * count..], count, &mut k),
                None => surface.collapse(&a, [active, 0..count], None, false, &mut k),
            }
            let moderate =
                D == 4 && ORDER < 2 && k.as_flattened().iter().all(|&x| far_from_limits(x));
            for piece in &columns.pieces {
                let n = piece.active.len();
                if net.is_none() {
                    for c in 0..D {
                        factors[c].clear();
                        for k in k.chunks_exact(count) {
                            let k = &k[piece.active.clone()];
                            factors[c].extend(piece.used[c].iter().map(|&j| k[j][c]));
                        }
                    }
                }
                for b in &piece.blocks {
                    let f = &columns.values[b.at..][..(ORDER + 1) * n * R::LANES];
                    let f = R::arrays(f);
                    let mut h = [[zero; 4]; JET];
                    for p in 0..=ORDER {
                        for q in 0..=ORDER - p {
                            let f = &f[q * n..][..n];
                            let h = &mut h[jet_index(p, q)];
                            if net.is_some() {
                                let k = &k[p * count..][piece.active.clone()];
                                dense::<R, D>(r, f, k, h);
                            } else {
                                for c in 0..D {
                                    let used = &piece.used[c];
                                    let factors = &factors[c][p * used.len()..][..used.len()];
                                    h[c] = sparse(r, f, factors, used);
                                }
                            }
                        }
                    }
                    let mut x = [[zero; 3]; JET];
                    if D == 3 {
                        for k in 0..JET {
                            x[k] = [h[k][0], h[k][1], h[k][2]];
                        }
                    } else if moderate && b.moderate {
                        let w = h[0][3];
                        let inverse = Lanes::splat(r, 1.0) / w;
                        x = quotient_with(
                            &h,
                            #[inline(always)]
                            |x| x.div_by(w, inverse),
                        );
                    } else {
                        x = quotient(&h);
                    }
                    let at = tile * COLUMNS;
                    put(row, at + b.columns.start..at + b.columns.end, &x);
                }
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
fn dense<R: Registers, const D: usize>(
    r: R,
    f: &[R::Array],
    k: &[[f64; 4]],
    h: &mut [Lanes<R>; 4],
) {
    let mut sum = [r.splat(0.0); D];
    for (f, k) in f.iter().zip(k) {
        let f = r.load(*f);
        for c in 0..D {
            sum[c] = r.add_product(sum[c], f, r.splat(k[c]));
        }
    }
    for c in 0..D {
        h[c] = Lanes(r, sum[c]);
    }
}

/// The same in one coordinate, which depends on some of the functions.
#[inline(always)]
fn sparse<R: Registers>(r: R, f: &[R::Array], factors: &[f64], used: &[usize]) -> Lanes<R> {
    let mut sum = r.splat(0.0);
    for (&j, &k) in used.iter().zip(factors) {
        sum = r.add_product(sum, r.load(f[j]), r.splat(k));
    }
    Lanes(r, sum)
}

/// The numbers of a vector in all lanes.
#[inline(always)]
fn numbers<R: Registers, const N: usize>(x: &[Lanes<R>; N]) -> [R::Register; N] {
    let mut numbers = [x[0].1; N];
    for c in 0..N {
        numbers[c] = x[c].1;
    }
    numbers
}

/// Writes registers to places for fewer numbers, if they are the last.
#[inline(always)]
fn write<R: Registers, const N: usize>(x: [R::Array; N], out: &mut [f64]) {
    // Full blocks apart: the compiler then knows the length.
    if out.len() == N * R::LANES {
        R::arrays_mut(out).copy_from_slice(&x);
    } else {
        out.copy_from_slice(&cast_slice(&x)[..out.len()]);
    }
}

/// `x + origin`.
#[inline(always)]
fn moved<R: Registers>(x: &[Lanes<R>; 3], origin: DVec3) -> [Lanes<R>; 3] {
    [
        x[0] + Lanes::splat(x[0].0, origin.x),
        x[1] + Lanes::splat(x[0].0, origin.y),
        x[2] + Lanes::splat(x[0].0, origin.z),
    ]
}

/// `x · x`, summed as [`DVec3::length_squared`] does.
#[inline(always)]
fn square<R: Registers>(x: &[Lanes<R>; 3]) -> Lanes<R> {
    x[0] * x[0] + x[1] * x[1] + x[2] * x[2]
}

/// The derivatives up to `ORDER` of every point of a grid, point by point.
struct Jets<'a, const ORDER: usize, const JET: usize>(Grid<'a, DVec3>);

impl<const ORDER: usize, const JET: usize> Kernel for Jets<'_, ORDER, JET> {
    #[inline(always)]
    fn run<R: Registers>(self, r: R) {
        let Grid { surface, u, v, out } = self.0;
        let origin = surface.origin();
        let out = out.as_chunks_mut::<JET>().0;
        evaluate::<R, ORDER, JET>(
            r,
            surface,
            [u, v],
            #[inline(always)]
            |row, columns, x| {
                let out = &mut out[row * v.len() + columns.start..][..columns.len()];
                let points = r.interleave(numbers(&moved(&x[0], origin)));
                if JET == 1 {
                    return write::<R, 3>(points, cast_slice_mut(out.as_flattened_mut()));
                }
                for k in 0..JET {
                    let vectors = if k == 0 {
                        points
                    } else {
                        r.interleave(numbers(&x[k]))
                    };
                    for (out, x) in out.iter_mut().zip(cast_slice(&vectors)) {
                        out[k] = *x;
                    }
                }
            },
        );
    }
}

/// The derivatives up to an order of at most [`KERNEL_ORDER`] of every point of a grid.
pub(super) fn jets(surface: &Separable, u: &[f64], v: &[f64], order: usize, out: &mut [DVec3]) {
    jets_on(InstructionSet::best(), Grid { surface, u, v, out }, order);
}

fn jets_on(set: InstructionSet, grid: Grid<'_, DVec3>, order: usize) {
    match order {
        0 => set.run(Jets::<0, 1>(grid)),
        1 => set.run(Jets::<1, 3>(grid)),
        _ => set.run(Jets::<2, 6>(grid)),
    }
}

/// Points and unit normals of a grid.
struct Normals<'a> {
    grid: Grid<'a, [DVec3; 2]>,
    /// The widths of the pieces that the parameters lie in; some more for v, since a block may reach beyond the end.
    widths: [Vec<f64>; 2],
}

impl Kernel for Normals<'_> {
    #[inline(always)]
    fn run<R: Registers>(self, r: R) {
        let Grid { surface, u, v, out } = self.grid;
        let [du, mut dv] = self.widths;
        if let Some(&last) = dv.last() {
            dv.resize(v.len() + R::LANES, last);
        }
        let origin = surface.origin();
        evaluate::<R, 1, 3>(
            r,
            surface,
            [u, v],
            #[inline(always)]
            |row, columns, x| {
                let dv = R::arrays(&dv[columns.start..][..R::LANES])[0];
                let (du, dv) = (Lanes::splat(r, du[row]), Lanes(r, r.load(dv)));
                let at = moved(&x[0], origin);
                let a = [x[1][0] * du, x[1][1] * du, x[1][2] * du];
                let b = [x[2][0] * dv, x[2][1] * dv, x[2][2] * dv];
                let n = [
                    a[1] * b[2] - b[1] * a[2],
                    a[2] * b[0] - b[2] * a[0],
                    a[0] * b[1] - b[0] * a[1],
                ];
                let nn = square(&n);
                let inverse = Lanes::splat(r, 1.0) / nn.sqrt();
                let n = [n[0] * inverse, n[1] * inverse, n[2] * inverse];
                let pairs = numbers(&[at[0], at[1], at[2], n[0], n[1], n[2]]);
                let out = &mut out[row * v.len() + columns.start..][..columns.len()];
                let vectors = out.as_flattened_mut();
                write::<R, 6>(r.interleave_pairs(pairs), cast_slice_mut(vectors));
                if !all_plain(nn, square(&a), square(&b), square(&at)) {
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
    normals_on(InstructionSet::best(), Grid { surface, u, v, out });
}

fn normals_on(set: InstructionSet, grid: Grid<'_, [DVec3; 2]>) {
    let widths = |dir, t: &[f64]| -> Vec<f64> {
        let breaks = grid.surface.breaks(dir);
        let width = |&t: &f64| breaks.piece(breaks.find(t, Limit::Above)).width();
        t.iter().map(width).collect()
    };
    let widths = [widths(Dir::U, grid.u), widths(Dir::V, grid.v)];
    set.run(Normals { grid, widths });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{BSplineBasis, FunctionsRef};
    use crate::exact::NurbsSurface;
    use crate::laws::Random;
    use crate::surface::{Term, Torus, TorusOptions};
    use std::sync::Arc;

    const COUNTS: [usize; 2] = [6, 7];

    fn net(weights: bool) -> Separable {
        let mut random = Random(3);
        let points: Vec<DVec3> = (0..42)
            .map(|i| DVec3::new((i / 7) as f64, (i % 7) as f64, random.unit()))
            .collect();
        let weights: Option<Vec<f64>> =
            weights.then(|| (0..42).map(|_| 0.5 + random.unit()).collect());
        let knots = COUNTS.map(|n| BSplineBasis::clamped_uniform(3, n));
        let s = NurbsSurface::new([3, 3], knots, &points, weights.as_deref()).unwrap();
        s.separable().clone()
    }

    /// The same net as terms, with coordinates that few functions move: a flat sheet, bent once.
    fn sparse(weights: bool) -> Separable {
        let [u, v] = COUNTS.map(|n| -> FunctionsRef {
            Arc::new(BSplineBasis::new(3, BSplineBasis::clamped_uniform(3, n)).unwrap())
        });
        let Core::Net(net) = net(weights).core().clone() else {
            unreachable!("a NURBS surface has a net")
        };
        let terms = net.iter().enumerate().map(|(at, &c)| {
            let z = if at % 7 == 3 { c.z } else { 0.0 };
            Term::new(at / 7, at % 7, DVec4::new(c.x, c.y, z, c.w))
        });
        let core = Core::Terms(terms.collect());
        let origin = DVec3::new(0.5, -0.25, -0.0);
        if weights {
            Separable::rational(u, v, core, origin)
        } else {
            Separable::polynomial(u, v, core, origin)
        }
    }

    fn bits(x: &[DVec3]) -> Vec<[u64; 3]> {
        x.iter().map(|x| x.to_array().map(f64::to_bits)).collect()
    }

    /// Nets and sparse cores, rational and not, at knots, beside them, and in pieces with fewer columns than lanes.
    #[test]
    fn all_instruction_sets_give_the_bits_of_single_points() {
        // It touches its axis: normals are limits there.
        let torus = Torus::new(1.0, 1.0, TorusOptions::default()).unwrap();
        let torus = torus.to_nurbs().unwrap();
        let nets = [false, true].map(net);
        let sparse = [false, true].map(sparse);
        let huge = nets[1].transformed(&glam::DAffine3::from_scale(DVec3::splat(1e200)));
        let surfaces = nets.iter().chain(&sparse).chain([torus.separable(), &huge]);
        for (k, surface) in surfaces.enumerate() {
            let of = |dir, n: usize| -> Vec<f64> {
                let d = surface.breaks(dir).domain();
                let even = (0..n).map(|i| d.lo + (d.hi - d.lo) * i as f64 / (n - 1) as f64);
                even.flat_map(|t| [t, t.next_up()])
                    .filter(|&t| t <= d.hi)
                    .collect()
            };
            for n in [3, 9, 37] {
                let (u, v) = (of(Dir::U, 5), of(Dir::V, n));
                let uv: Vec<[f64; 2]> = u
                    .iter()
                    .flat_map(|&u| v.iter().map(move |&v| [u, v]))
                    .collect();
                for set in InstructionSet::all() {
                    for order in 0..=KERNEL_ORDER {
                        let each = crate::surface::jet_len(order);
                        let mut out = vec![DVec3::ZERO; uv.len() * each];
                        let (u, v, out) = (&u, &v, &mut out);
                        jets_on(set, Grid { surface, u, v, out }, order);
                        for (out, &uv) in out.chunks_exact(each).zip(&uv) {
                            let single = surface.jet(uv, [Limit::Above; 2], order).d;
                            assert_eq!(bits(out), bits(&single), "{k}, {uv:?}, order {order}");
                        }
                    }
                    let mut out = vec![[DVec3::ZERO; 2]; uv.len()];
                    let (u, v, out) = (&u, &v, &mut out);
                    normals_on(set, Grid { surface, u, v, out });
                    for (out, &uv) in out.iter().zip(&uv) {
                        let normal = normal_at(surface, uv, [Limit::Above; 2]);
                        let single = [surface.point(uv), normal.vector().unwrap_or(DVec3::ZERO)];
                        assert_eq!(bits(out), bits(&single), "{k}, {uv:?}, normal");
                    }
                }
            }
        }
    }
}
