//! Grids of separable surfaces: n + m evaluations of the sides and one small matrix product.
//!
//! For each row (one u) the core is collapsed to a short list of vectors; then a register of neighbouring columns at a
//! time takes their products with the functions of v. The operations of a point are those of [`Surface::jet`] in the
//! same order, so the result is the same to the last bit, with every instruction set.

use super::normal::all_plain;
use super::quotient::{quotient, quotient_with};
use super::{Core, Dir, Separable, Surface, jet_index, normal_at};
use crate::basis::Functions;
use crate::breaks::{Breaks, Limit};
use crate::scalar::{Number, Pack};
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
    columns: Range<usize>,
    active: Range<usize>,
    /// Where their functions start. A block of columns, one a lane, has for each derivative and each active function one
    /// register.
    at: usize,
    /// All functions are [`far_from_limits`].
    moderate: bool,
    sparse: Sparse,
}

/// Neighbouring parameters with the same active functions, and these.
fn runs(functions: &dyn Functions, t: &[f64]) -> Vec<(Range<usize>, Range<usize>)> {
    let active: Vec<_> = t
        .iter()
        .map(|&t| functions.active(t, Limit::Above))
        .collect();
    let mut start = 0;
    let run = |same: &[Range<usize>]| {
        start += same.len();
        (start - same.len()..start, same[0].clone())
    };
    active.chunk_by(|a, b| a == b).map(run).collect()
}

/// The functions at the first parameters of a pack, `count` of them with the same active functions; lanes behind repeat
/// the last one.
fn evaluate_pack(functions: &dyn Functions, t: &[f64], order: usize, out: &mut [Pack]) {
    /// Fewer are evaluated faster one by one.
    const FEW: usize = 3;
    let last = t.len() - 1;
    if t.len() >= FEW {
        let t = Pack(std::array::from_fn(|lane| t[lane.min(last)]));
        return functions.pack_into(t, Limit::Above, order, out);
    }
    let mut one: SmallVec<[f64; 32]> = SmallVec::from_elem(0.0, out.len());
    for (lane, &t) in t.iter().enumerate() {
        functions.jet_into(t, Limit::Above, order, &mut one);
        for (out, &x) in out.iter_mut().zip(&one) {
            out.0[lane..].fill(x);
        }
    }
}

/// The functions of v at some columns.
struct Columns {
    pieces: Vec<Piece>,
    values: Vec<f64>,
}

impl Columns {
    fn new(surface: &Separable, v: &[f64], order: usize, lanes: usize) -> Self {
        let functions = surface.functions_v().as_ref();
        let (mut pieces, mut values) = (Vec::new(), Vec::<f64>::new());
        let mut pack = Vec::new();
        for (columns, active) in runs(functions, v) {
            let at = values.len();
            pack.resize((order + 1) * active.len(), Pack::ZERO);
            for part in columns.clone().step_by(Pack::LANES) {
                let blocks = (part..columns.end.min(part + Pack::LANES)).step_by(lanes);
                let first = |block| {
                    columns.start + first_of_block(block - columns.start, columns.len(), lanes)
                };
                let t: SmallVec<[f64; Pack::LANES]> = blocks
                    .clone()
                    .flat_map(|block| &v[first(block)..columns.end.min(first(block) + lanes)])
                    .copied()
                    .collect();
                evaluate_pack(functions, &t, order, &mut pack);
                for block in 0..blocks.len() {
                    for k in &pack {
                        values.extend_from_slice(&k.0[block * lanes..][..lanes]);
                    }
                }
            }
            pieces.push(Piece {
                at,
                moderate: values[at..].iter().all(|&x| far_from_limits(x)),
                sparse: Sparse::new(surface, &active),
                columns,
                active,
            });
        }
        Self { pieces, values }
    }

    /// The functions of a piece.
    fn of(&self, piece: usize) -> &[f64] {
        let end = self.pieces.get(piece + 1).map(|next| next.at);
        &self.values[self.pieces[piece].at..end.unwrap_or(self.values.len())]
    }
}

/// The first column of the block that would start at `block`. The last one is full too where it can be: some columns are
/// then evaluated twice.
#[inline(always)]
fn first_of_block(block: usize, columns: usize, lanes: usize) -> usize {
    block.min(columns.saturating_sub(lanes))
}

/// The part of a sparse core that a piece sees; empty if the core is a net.
#[derive(Default)]
struct Sparse {
    /// For each coordinate the active functions of v that it depends on, side by side: most functions of a Coons surface
    /// move one coordinate. One with fewer has more of the first function, with vectors that stay zero.
    used: Vec<[usize; 4]>,
    products: Vec<Product>,
}

/// A function of u times a constant, which goes to a coordinate of the vector of a used function.
struct Product {
    i: usize,
    factor: f64,
    to: [usize; 2],
}

impl Sparse {
    fn new(surface: &Separable, active: &Range<usize>) -> Self {
        let Core::Terms(terms) = surface.core() else {
            return Self::default();
        };
        let dimensions = if surface.is_rational() { 4 } else { 3 };
        let (mut used, mut products) = (Vec::new(), Vec::new());
        for c in 0..dimensions {
            let terms = terms
                .iter()
                .filter(|t| t.c[c] != 0.0 && active.contains(&t.j));
            let mut js: Vec<usize> = terms.clone().map(|t| t.j).collect();
            js.sort_unstable();
            js.dedup();
            used.resize(js.len().max(used.len()), [0; 4]);
            for (used, j) in used.iter_mut().zip(&js) {
                used[c] = j - active.start;
            }
            products.extend(terms.filter_map(|t| {
                let slot = js.binary_search(&t.j).ok()?;
                Some(Product {
                    i: t.i,
                    factor: t.c[c],
                    to: [slot, c],
                })
            }));
        }
        Self { used, products }
    }

    /// The vectors of the used functions for each derivative of the active functions of u, in the order of the terms.
    fn collapse(&self, a: &[f64], active: &Range<usize>, rows: usize, out: &mut Vec<[f64; 4]>) {
        let slots = self.used.len();
        out.clear();
        out.resize(rows * slots, [0.0; 4]);
        for (p, a) in a.chunks_exact(active.len()).enumerate() {
            let out = &mut out[p * slots..][..slots];
            for product in &self.products {
                if let Some(a) = a.get(product.i.wrapping_sub(active.start)) {
                    let [slot, c] = product.to;
                    out[slot][c] += a * product.factor;
                }
            }
        }
    }
}

/// A grid to evaluate.
struct Grid<'a, T> {
    surface: &'a Separable,
    u: &'a [f64],
    v: &'a [f64],
    out: &'a mut [T],
}

/// What is made of the derivatives of a point.
trait Output<R: Registers, const JET: usize> {
    /// How many numbers a point takes.
    const EACH: usize;
    /// Writes a register of points of a row from the first one's column and their derivatives without the surface's
    /// origin. Lanes behind the last column of a piece may hold anything.
    fn put(&self, row: usize, column: usize, x: &[[Lanes<R>; 3]; JET], out: &mut [f64]);
}

/// Evaluates a grid with derivatives up to `ORDER`, a register of points at a time.
#[inline(always)]
fn evaluate<R: Registers, O: Output<R, JET>, const ORDER: usize, const JET: usize>(
    r: R,
    surface: &Separable,
    uv: [&[f64]; 2],
    out: &mut [f64],
    output: &O,
) {
    match (surface.core(), surface.is_rational()) {
        (Core::Net(net), false) => {
            rows::<R, O, 3, ORDER, JET>(r, surface, Some(net), uv, out, output);
        }
        (Core::Net(net), true) => {
            rows::<R, O, 4, ORDER, JET>(r, surface, Some(net), uv, out, output);
        }
        (Core::Terms(_), false) => rows::<R, O, 3, ORDER, JET>(r, surface, None, uv, out, output),
        (Core::Terms(_), true) => rows::<R, O, 4, ORDER, JET>(r, surface, None, uv, out, output),
    }
}

/// The same in `D` homogeneous coordinates, for a net or a sparse core.
#[inline(always)]
fn rows<R: Registers, O: Output<R, JET>, const D: usize, const ORDER: usize, const JET: usize>(
    r: R,
    surface: &Separable,
    net: Option<&[DVec4]>,
    [u, v]: [&[f64]; 2],
    out: &mut [f64],
    output: &O,
) {
    let (side, count) = (
        surface.functions_u().as_ref(),
        surface.functions_v().count(),
    );
    let mut all = vec![[0.0; 4]; (ORDER + 1) * count];
    let (mut pack, mut a, mut k) = (Vec::new(), Vec::new(), Vec::new());
    let rows = runs(side, u);
    let mut spare = vec![0.0; O::EACH * R::LANES];
    for (tile, columns) in v.chunks(COLUMNS).enumerate() {
        let columns = Columns::new(surface, columns, ORDER, R::LANES);
        for (rows, active) in &rows {
            for part in rows.clone().step_by(Pack::LANES) {
                let part = part..rows.end.min(part + Pack::LANES);
                pack.resize((ORDER + 1) * active.len(), Pack::ZERO);
                evaluate_pack(side, &u[part.clone()], ORDER, &mut pack);
                for (lane, row) in part.enumerate() {
                    a.clear();
                    a.extend(pack.iter().map(|f| f.0[lane]));
                    if let Some(net) = net {
                        collapse_net(&a, &net[active.start * count..], count, &mut all);
                    }
                    for (index, piece) in columns.pieces.iter().enumerate() {
                        if net.is_some() {
                            k.clear();
                            for all in all.chunks_exact(count) {
                                k.extend_from_slice(&all[piece.active.clone()]);
                            }
                        } else {
                            piece.sparse.collapse(&a, active, ORDER + 1, &mut k);
                        }
                        let (first, width) =
                            (tile * COLUMNS + piece.columns.start, piece.columns.len());
                        let out = &mut out[O::EACH * (row * v.len() + first)..][..O::EACH * width];
                        let short = width < R::LANES;
                        let places = if short { &mut spare } else { &mut *out };
                        let strip = Strip {
                            r,
                            row,
                            columns: first..first + width,
                            active: piece.active.len(),
                            functions: R::arrays(columns.of(index)),
                            k: &k,
                            quick: D == 4
                                && ORDER < 2
                                && piece.moderate
                                && k.as_flattened().iter().all(|&x| far_from_limits(x)),
                        };
                        match (net, JET, strip.active) {
                            (None, ..) => {
                                strip.sparse::<D, ORDER, JET>(&piece.sparse.used, places, output);
                            }
                            (_, 1, 3) => strip.unrolled::<D, 3, JET>(places, output),
                            (_, 1, 4) => strip.unrolled::<D, 4, JET>(places, output),
                            _ => strip.dense::<D, ORDER, JET>(places, output),
                        }
                        if short {
                            out.copy_from_slice(&spare[..out.len()]);
                        }
                    }
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

/// The part of a row that lies in a piece.
struct Strip<'a, R: Registers> {
    r: R,
    row: usize,
    columns: Range<usize>,
    /// The number of active functions.
    active: usize,
    functions: &'a [R::Array],
    /// The vectors of the row that the functions take, for each derivative by u.
    k: &'a [[f64; 4]],
    /// Quotients may be computed with [`Lanes::div_by`].
    quick: bool,
}

impl<R: Registers> Strip<'_, R> {
    /// Every coordinate has all functions.
    #[inline(always)]
    fn dense<const D: usize, const ORDER: usize, const JET: usize>(
        &self,
        out: &mut [f64],
        output: &impl Output<R, JET>,
    ) {
        let r = self.r;
        self.blocks::<_, D, ORDER, JET>(
            out,
            output,
            #[inline(always)]
            |f, k| {
                let mut sum = [r.splat(0.0); D];
                for (f, k) in f.iter().zip(k) {
                    let f = r.load(*f);
                    for c in 0..D {
                        sum[c] = r.add_product(sum[c], f, r.splat(k[c]));
                    }
                }
                sum
            },
        );
    }

    /// The same for points alone and `N` functions, with the row in registers.
    #[inline(always)]
    fn unrolled<const D: usize, const N: usize, const JET: usize>(
        &self,
        out: &mut [f64],
        output: &impl Output<R, JET>,
    ) {
        let r = self.r;
        let mut k = [[r.splat(0.0); D]; N];
        for j in 0..N {
            for c in 0..D {
                k[j][c] = r.splat(self.k[j][c]);
            }
        }
        self.blocks::<_, D, 0, JET>(
            out,
            output,
            #[inline(always)]
            |f, _| {
                let mut sum = [r.splat(0.0); D];
                let f = &f[..N];
                for j in 0..N {
                    let f = r.load(f[j]);
                    for c in 0..D {
                        sum[c] = r.add_product(sum[c], f, k[j][c]);
                    }
                }
                sum
            },
        );
    }

    /// Each coordinate has its own functions.
    #[inline(always)]
    fn sparse<const D: usize, const ORDER: usize, const JET: usize>(
        &self,
        used: &[[usize; 4]],
        out: &mut [f64],
        output: &impl Output<R, JET>,
    ) {
        let r = self.r;
        self.blocks::<_, D, ORDER, JET>(
            out,
            output,
            #[inline(always)]
            |f, k| {
                let mut sum = [r.splat(0.0); D];
                for (js, k) in used.iter().zip(k) {
                    for c in 0..D {
                        sum[c] = r.add_product(sum[c], r.load(f[js[c]]), r.splat(k[c]));
                    }
                }
                sum
            },
        );
    }

    /// All blocks; `sum` gives `Σ_j b_j K_j` in `D` coordinates.
    #[inline(always)]
    fn blocks<O: Output<R, JET>, const D: usize, const ORDER: usize, const JET: usize>(
        &self,
        out: &mut [f64],
        output: &O,
        sum: impl Fn(&[R::Array], &[[f64; 4]]) -> [R::Register; D],
    ) {
        let (r, n) = (self.r, self.active);
        let slots = self.k.len() / (ORDER + 1);
        let zero = Lanes::splat(r, 0.0);
        for (block, f) in self.functions.chunks_exact((ORDER + 1) * n).enumerate() {
            let mut h = [[zero; 4]; JET];
            for p in 0..=ORDER {
                for q in 0..=ORDER - p {
                    let sum = sum(&f[q * n..][..n], &self.k[p * slots..][..slots]);
                    for c in 0..D {
                        h[jet_index(p, q)][c] = Lanes(r, sum[c]);
                    }
                }
            }
            let mut x = [[zero; 3]; JET];
            if D == 3 {
                for k in 0..JET {
                    x[k] = [h[k][0], h[k][1], h[k][2]];
                }
            } else if self.quick {
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
            let first = first_of_block(block * R::LANES, self.columns.len(), R::LANES);
            let room = &mut out[O::EACH * first..][..O::EACH * R::LANES];
            output.put(self.row, self.columns.start + first, &x, room);
        }
    }
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

/// Writes registers one after the other.
#[inline(always)]
fn write<R: Registers, const N: usize>(x: &[R::Array; N], out: &mut [f64]) {
    let places = &mut R::arrays_mut(out)[..N];
    // One by one they go from registers to their places; as a slice they would be copied from the stack.
    #[allow(clippy::manual_memcpy)]
    for k in 0..N {
        places[k] = x[k];
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
        let output = JetOutput {
            r,
            origin: surface.origin(),
        };
        evaluate::<R, _, ORDER, JET>(r, surface, [u, v], cast_slice_mut(out), &output);
    }
}

struct JetOutput<R> {
    r: R,
    origin: DVec3,
}

impl<R: Registers, const JET: usize> Output<R, JET> for JetOutput<R> {
    const EACH: usize = 3 * JET;

    #[inline(always)]
    fn put(&self, _: usize, _: usize, x: &[[Lanes<R>; 3]; JET], out: &mut [f64]) {
        let points = self.r.interleave(numbers(&moved(&x[0], self.origin)));
        if JET == 1 {
            return write::<R, 3>(&points, out);
        }
        for k in 0..JET {
            let vectors = if k == 0 {
                points
            } else {
                self.r.interleave(numbers(&x[k]))
            };
            let jets = out.as_chunks_mut::<3>().0.chunks_exact_mut(JET);
            for (jet, x) in jets.zip(cast_slice(&vectors)) {
                jet[k] = *x;
            }
        }
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
    /// The widths of the pieces that the parameters lie in.
    widths: [Vec<f64>; 2],
}

impl Kernel for Normals<'_> {
    #[inline(always)]
    fn run<R: Registers>(self, r: R) {
        let Grid { surface, u, v, out } = self.grid;
        let mut widths = self.widths;
        let last = widths[1].last().copied();
        widths[1].resize(v.len() + R::LANES, last.unwrap_or(1.0));
        let output = NormalOutput {
            r,
            surface,
            uv: [u, v],
            widths,
        };
        let out = cast_slice_mut(out.as_flattened_mut());
        evaluate::<R, _, 1, 3>(r, surface, [u, v], out, &output);
    }
}

struct NormalOutput<'a, R> {
    r: R,
    surface: &'a Separable,
    uv: [&'a [f64]; 2],
    /// Some more for v, since a block may reach beyond the end.
    widths: [Vec<f64>; 2],
}

impl<R: Registers> Output<R, 3> for NormalOutput<'_, R> {
    const EACH: usize = 6;

    #[inline(always)]
    fn put(&self, row: usize, column: usize, x: &[[Lanes<R>; 3]; 3], out: &mut [f64]) {
        let r = self.r;
        let [du, dv] = &self.widths;
        let dv = R::arrays(&dv[column..][..R::LANES])[0];
        let (du, dv) = (Lanes::splat(r, du[row]), Lanes(r, r.load(dv)));
        let at = moved(&x[0], self.surface.origin());
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
        write::<R, 6>(&r.interleave_pairs(pairs), out);
        if !all_plain(nn, square(&a), square(&b), square(&at)) {
            self.normals_at(row, column, out);
        }
    }
}

impl<R> NormalOutput<'_, R> {
    /// Normals of points some of which may have none.
    #[cold]
    fn normals_at(&self, row: usize, column: usize, out: &mut [f64]) {
        let [u, v] = self.uv;
        let places = out.as_chunks_mut::<6>().0;
        for (place, &v) in places.iter_mut().zip(&v[column..]) {
            let normal = normal_at(self.surface, [u[row], v], [Limit::Above; 2]);
            let normal = normal.vector().unwrap_or(DVec3::ZERO);
            place[3..].copy_from_slice(&normal.to_array());
        }
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
