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
use crate::simd::{InstructionSet, Kernel, Lanes, Registers, cross, dot, far_from_limits};
use glam::{DVec3, DVec4};
use nappe_stream::{Copying, LINE, Writer};
use pulp::bytemuck::{Pod, cast_slice, cast_slice_mut};
use smallvec::SmallVec;
use std::mem::swap;
use std::ops::Range;

/// The highest order of derivative that kernels write.
pub(super) const KERNEL_ORDER: usize = 2;

/// How many columns are prepared together: their functions fill a part of the second-level cache.
const COLUMNS: usize = 2048;

/// Neighbouring columns with the same active functions of v.
struct Piece {
    columns: Range<usize>,
    active: Range<usize>,
    /// All functions are [`far_from_limits`].
    moderate: bool,
    sparse: Sparse,
}

/// Hands on the functions at all parameters, as many as a pack has at a time: their derivatives, and where the lanes are
/// among the parameters. Lanes behind the last parameter repeat it.
#[inline(always)]
fn in_packs(
    functions: &dyn Functions,
    t: &[f64],
    order: usize,
    mut each: impl FnMut(Range<usize>, &[Pack]),
) {
    /// Fewer parameters are evaluated faster one by one.
    const FEW: usize = 3;
    let mut pack: SmallVec<[Pack; 8]> = SmallVec::new();
    let mut one: SmallVec<[f64; 32]> = SmallVec::new();
    for (part, t) in t.chunks(Pack::LANES).enumerate() {
        let last = t.len() - 1;
        let active = functions.active(t[last], Limit::Above).len();
        pack.resize((order + 1) * active, Pack::ZERO);
        if t.len() < FEW {
            one.resize(pack.len(), 0.0);
            for (lane, &t) in t.iter().enumerate() {
                functions.jet_into(t, Limit::Above, order, &mut one);
                for (pack, &x) in pack.iter_mut().zip(&one) {
                    pack.0[lane..].fill(x);
                }
            }
        } else {
            let t = Pack(std::array::from_fn(|lane| t[lane.min(last)]));
            functions.pack_into(t, Limit::Above, order, &mut pack);
        }
        each(part * Pack::LANES..part * Pack::LANES + t.len(), &pack);
    }
}

/// The functions of v at some columns.
struct Columns {
    pieces: Vec<Piece>,
    /// For each derivative and each active function its values at all columns, and at some behind the last.
    values: Vec<f64>,
    /// Where the first of these lists starts, and how far apart they are: places that no register straddles.
    start: usize,
    stride: usize,
}

impl Columns {
    fn new(surface: &Separable, v: &[f64], order: usize) -> Self {
        let functions = surface.functions_v().as_ref();
        let (stride, mut start) = (v.len().next_multiple_of(Pack::LANES) + Pack::LANES, 0);
        let mut values = Vec::new();
        in_packs(functions, v, order, |columns, pack| {
            if values.is_empty() {
                values.resize(pack.len() * stride + Pack::LANES, 0.0);
                start = values.as_ptr().align_offset(size_of::<Pack>());
            }
            for (values, pack) in values[start..].chunks_exact_mut(stride).zip(pack) {
                values[columns.start..][..Pack::LANES].copy_from_slice(&pack.0);
                // A register may begin at any column and reach behind the last one.
                if columns.end == v.len() {
                    values[columns.start + Pack::LANES..].fill(pack.0[Pack::LANES - 1]);
                }
            }
        });
        let active: Vec<_> = v
            .iter()
            .map(|&v| functions.active(v, Limit::Above))
            .collect();
        let mut end = 0;
        let piece = |same: &[Range<usize>]| {
            let (active, columns) = (same[0].clone(), end..end + same.len());
            end = columns.end;
            let moderate = |f: &[f64]| f[columns.clone()].iter().all(|&x| far_from_limits(x));
            Piece {
                moderate: surface.is_rational()
                    && values[start..].chunks_exact(stride).all(moderate),
                sparse: Sparse::new(surface, &active, stride),
                columns,
                active,
            }
        };
        let pieces = active.chunk_by(|a, b| a == b).map(piece).collect();
        Self {
            pieces,
            values,
            start,
            stride,
        }
    }
}

/// The part of a sparse core that a piece sees; empty if the core is a net.
#[derive(Default)]
struct Sparse {
    /// For each coordinate where the active functions of v start that it depends on, side by side: most functions of a
    /// Coons surface move one coordinate. One with fewer has more of the first function, with vectors that stay zero.
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
    fn new(surface: &Separable, active: &Range<usize>, stride: usize) -> Self {
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
                used[c] = (j - active.start) * stride;
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
struct Grid<'a, 'w> {
    surface: &'a Separable,
    u: &'a [f64],
    v: &'a [f64],
    out: Places<'a, 'w>,
}

/// What is made of the derivatives of a point.
trait Output<R: Registers, const JET: usize> {
    /// How many numbers a point takes.
    const EACH: usize;
    /// Writes a register of points of a row from the first one's column and their derivatives without the surface's
    /// origin. Lanes behind the last column of a piece may hold anything.
    fn put(&self, row: usize, column: usize, x: &[[Lanes<R>; 3]; JET], out: &mut [f64]);
}

/// A result of so many bytes is written past the caches, which could not keep it. With less, a caller may read it where it
/// still is: in the second-level cache or its share of the last-level one.
const LARGE: usize = 1 << 24;

/// Where points go.
enum Places<'a, 'w> {
    /// Through the caches.
    Near(&'a mut [f64]),
    /// To memory: rows are put together in the cache first.
    Far(&'a mut Writer<'w>),
}

impl Places<'_, '_> {
    /// Hands on the way to places, to memory if they take `large` bytes or more.
    fn of<T: Pod>(out: &mut [T], large: usize, fill: impl FnOnce(Places)) {
        let is_large = size_of_val(out) >= large;
        let out = cast_slice_mut(out);
        if is_large {
            nappe_stream::stream(out, |w| fill(Places::Far(w)));
        } else {
            fill(Places::Near(out));
        }
    }
}

/// Evaluates a grid with derivatives up to `ORDER`, a register of points at a time.
#[inline(always)]
fn evaluate<R: Registers, O: Output<R, JET>, const ORDER: usize, const JET: usize>(
    r: R,
    surface: &Separable,
    uv: [&[f64]; 2],
    out: &mut Places,
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
    out: &mut Places,
    output: &O,
) {
    let (side, count) = (surface.functions_u(), surface.functions_v().count());
    let mut all = vec![[0.0; 4]; (ORDER + 1) * count];
    let (mut a, mut sparse) = (Vec::new(), Vec::new());
    let room = O::EACH * (v.len().min(COLUMNS) + R::LANES);
    // A row that is put together, and the one before on its way to memory.
    let mut stage = vec![0.0; room];
    let mut before = stage.clone();
    for (tile, columns) in v.chunks(COLUMNS).enumerate() {
        let first = tile * COLUMNS;
        let Columns {
            pieces,
            values,
            start,
            stride,
        } = Columns::new(surface, columns, ORDER);
        // Long sums of products load so much for each point that they wait for stores under way; their rows are put
        // together first. Short sums load little (in a sparse core each coordinate has functions of its own), and
        // divisions and normals take long enough to store beside them.
        let is_long = |p: &Piece| match net {
            Some(_) => p.active.len() > 4,
            None => p.sparse.used.len() > 2,
        };
        let is_long = D == 3 && JET == 1 && pieces.iter().any(is_long);
        let width = O::EACH * columns.len();
        let mut waiting = None;
        in_packs(
            side.as_ref(),
            u,
            ORDER,
            #[inline(always)]
            |rows, pack| {
                for (lane, row) in rows.enumerate() {
                    let active = side.active(u[row], Limit::Above);
                    let at = O::EACH * (row * v.len() + first);
                    a.clear();
                    a.extend(pack.iter().map(|f| f.0[lane]));
                    if let Some(net) = net {
                        collapse_net(&a, &net[active.start * count..], count, &mut all);
                    }
                    let mut beside = Copying::default();
                    let mut staged = true;
                    let places = match out {
                        Places::Near(out) => {
                            // What blocks write behind a row must be written later, and there must be room for it.
                            staged = is_long || columns.len() < v.len() || out.len() - at < room;
                            if staged {
                                &mut stage[..]
                            } else {
                                &mut out[at..]
                            }
                        }
                        Places::Far(out) => {
                            if let Some(at) = waiting.replace(at) {
                                beside = out.copying(at, &before[..width]);
                            }
                            &mut stage[..]
                        }
                    };
                    for piece in &pieces {
                        let slots = if net.is_some() {
                            piece.active.len()
                        } else {
                            piece.sparse.collapse(&a, &active, ORDER + 1, &mut sparse);
                            piece.sparse.used.len()
                        };
                        let k = std::array::from_fn(|p| match net {
                            _ if p > ORDER => &[][..],
                            Some(_) => &all[p * count + piece.active.start..][..slots],
                            None => &sparse[p * slots..][..slots],
                        });
                        let moderate =
                            |k: &&[[f64; 4]]| k.as_flattened().iter().all(|&x| far_from_limits(x));
                        let strip = Strip {
                            r,
                            row,
                            columns: first + piece.columns.start..first + piece.columns.end,
                            functions: &values[start + piece.columns.start..],
                            stride,
                            active: piece.active.len(),
                            k,
                            quick: D == 4 && ORDER < 2 && piece.moderate && k.iter().all(moderate),
                        };
                        let to = To {
                            places: &mut places[O::EACH * piece.columns.start..],
                            beside: &mut beside,
                        };
                        match net {
                            Some(_) => strip.dense::<D, ORDER, JET>(to, output),
                            None => {
                                strip.sparse::<D, ORDER, JET>(&piece.sparse.used, to, output);
                            }
                        }
                    }
                    drop(beside);
                    match out {
                        Places::Near(out) if staged => {
                            out[at..][..width].copy_from_slice(&stage[..width]);
                        }
                        Places::Near(_) => {}
                        Places::Far(_) => swap(&mut stage, &mut before),
                    }
                }
            },
        );
        if let (Places::Far(out), Some(at)) = (&mut *out, waiting) {
            drop(out.copying(at, &before[..width]));
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

/// Where a strip goes, and the copy of an earlier row to memory that is made beside it.
struct To<'a, 'b> {
    places: &'a mut [f64],
    beside: &'a mut Copying<'b>,
}

/// The part of a row that lies in a piece.
struct Strip<'a, R: Registers> {
    r: R,
    row: usize,
    columns: Range<usize>,
    /// The values of the functions of v from the first column on, one list after the other.
    functions: &'a [f64],
    stride: usize,
    /// The number of active functions.
    active: usize,
    /// The vectors of the row that the functions take, for each derivative by u.
    k: [&'a [[f64; 4]]; KERNEL_ORDER + 1],
    /// Quotients may be computed with [`Lanes::div_by`].
    quick: bool,
}

impl<R: Registers> Strip<'_, R> {
    /// Every coordinate has all functions.
    #[inline(always)]
    fn dense<const D: usize, const ORDER: usize, const JET: usize>(
        &self,
        out: To,
        output: &impl Output<R, JET>,
    ) {
        self.sums::<_, D, ORDER, JET>(
            #[inline(always)]
            |j, _| j * self.stride,
            out,
            output,
        );
    }

    /// Each coordinate has its own functions.
    #[inline(always)]
    fn sparse<const D: usize, const ORDER: usize, const JET: usize>(
        &self,
        used: &[[usize; 4]],
        out: To,
        output: &impl Output<R, JET>,
    ) {
        let used = &used[..self.k[0].len()];
        self.sums::<_, D, ORDER, JET>(
            #[inline(always)]
            |j, c| used[j][c],
            out,
            output,
        );
    }

    /// The values of the j-th function that the coordinate c has start at `place(j, c)`.
    #[inline(always)]
    fn sums<
        P: Fn(usize, usize) -> usize + Copy,
        const D: usize,
        const ORDER: usize,
        const JET: usize,
    >(
        &self,
        place: P,
        out: To,
        output: &impl Output<R, JET>,
    ) {
        match (JET, self.k[0].len()) {
            (1, 2) => self.unrolled::<P, D, 2, JET>(place, out, output),
            (1, 3) => self.unrolled::<P, D, 3, JET>(place, out, output),
            (1, 4) => self.unrolled::<P, D, 4, JET>(place, out, output),
            (1, 5) => self.unrolled::<P, D, 5, JET>(place, out, output),
            (1, 6) => self.unrolled::<P, D, 6, JET>(place, out, output),
            _ => {
                let r = self.r;
                self.blocks::<_, D, ORDER, JET>(
                    out,
                    output,
                    #[inline(always)]
                    |block, p, q| {
                        let column = block * R::LANES;
                        let functions = &self.functions[q * self.active * self.stride + column..];
                        let mut sum = [r.splat(0.0); D];
                        for (j, k) in self.k[p].iter().enumerate() {
                            for c in 0..D {
                                let f = load(r, functions, place(j, c));
                                sum[c] = r.add_product(sum[c], f, r.splat(k[c]));
                            }
                        }
                        sum
                    },
                );
            }
        }
    }

    /// The same for points alone and `N` functions, with the row in registers. The sums start from their first products:
    /// a zero less changes at most the sign of a sum that is zero, and that is lost when the origin is added.
    #[inline(always)]
    fn unrolled<P: Fn(usize, usize) -> usize, const D: usize, const N: usize, const JET: usize>(
        &self,
        place: P,
        out: To,
        output: &impl Output<R, JET>,
    ) {
        let r = self.r;
        let blocks = self.columns.len().div_ceil(R::LANES);
        let mut k = [[r.splat(0.0); D]; N];
        let mut f: [[&[R::Array]; D]; N] = [[&[]; D]; N];
        for j in 0..N {
            for c in 0..D {
                k[j][c] = r.splat(self.k[0][j][c]);
                f[j][c] = &R::arrays(&self.functions[place(j, c)..])[..blocks];
            }
        }
        self.blocks::<_, D, 0, JET>(
            out,
            output,
            #[inline(always)]
            |block, _, _| {
                let mut sum = k[0];
                for j in 0..N {
                    for c in 0..D {
                        let f = r.load(f[j][c][block]);
                        sum[c] = if j == 0 {
                            r.mul(f, k[j][c])
                        } else {
                            r.add_product(sum[c], f, k[j][c])
                        };
                    }
                }
                sum
            },
        );
    }

    /// All blocks of neighbouring columns, one a lane; `sum` gives `Σ_j b_j⁽ᑫ⁾ K_j⁽ᵖ⁾` in `D` coordinates of a block.
    #[inline(always)]
    fn blocks<O: Output<R, JET>, const D: usize, const ORDER: usize, const JET: usize>(
        &self,
        out: To,
        output: &O,
        sum: impl Fn(usize, usize, usize) -> [R::Register; D],
    ) {
        // The last block may reach into the next piece, which comes later and is written over it.
        let blocks = self.columns.len().div_ceil(R::LANES);
        let To { places, beside } = out;
        let places = places.chunks_exact_mut(O::EACH * R::LANES).take(blocks);
        debug_assert_eq!(places.len(), blocks);
        let lines = (O::EACH * R::LANES).div_ceil(LINE);
        if D == 4 && JET == 1 {
            // The reciprocal of the next block is under way while the quotients of one are taken.
            let mut block = self.begin::<D, ORDER, JET>(0, &sum);
            for (number, places) in places.enumerate() {
                let next = self.begin::<D, ORDER, JET>((number + 1).min(blocks - 1), &sum);
                self.end::<O, D, JET>(number, &block, places, output);
                beside.step(lines);
                block = next;
            }
        } else {
            for (number, places) in places.enumerate() {
                let block = self.begin::<D, ORDER, JET>(number, &sum);
                self.end::<O, D, JET>(number, &block, places, output);
                beside.step(lines);
            }
        }
    }

    /// The homogeneous derivatives of a block.
    #[inline(always)]
    fn begin<const D: usize, const ORDER: usize, const JET: usize>(
        &self,
        number: usize,
        sum: &impl Fn(usize, usize, usize) -> [R::Register; D],
    ) -> Block<R, JET> {
        let zero = Lanes::splat(self.r, 0.0);
        let mut h = [[zero; 4]; JET];
        for p in 0..=ORDER {
            for q in 0..=ORDER - p {
                let sum = sum(number, p, q);
                for c in 0..D {
                    h[jet_index(p, q)][c] = Lanes(self.r, sum[c]);
                }
            }
        }
        let inverse = if D == 4 && self.quick {
            Lanes::splat(self.r, 1.0) / h[0][3]
        } else {
            zero
        };
        Block { h, inverse }
    }

    /// What is made of them.
    #[inline(always)]
    fn end<O: Output<R, JET>, const D: usize, const JET: usize>(
        &self,
        number: usize,
        Block { h, inverse }: &Block<R, JET>,
        out: &mut [f64],
        output: &O,
    ) {
        let mut x = [[*inverse; 3]; JET];
        if D == 3 {
            for k in 0..JET {
                x[k] = [h[k][0], h[k][1], h[k][2]];
            }
        } else if self.quick {
            x = quotient_with(
                h,
                #[inline(always)]
                |x| x.div_by(h[0][3], *inverse),
            );
        } else {
            x = quotient(h);
        }
        let column = self.columns.start + number * R::LANES;
        output.put(self.row, column, &x, out);
    }
}

/// A register of the values from a place on.
#[inline(always)]
fn load<R: Registers>(r: R, values: &[f64], place: usize) -> R::Register {
    r.load(R::arrays(&values[place..][..R::LANES])[0])
}

/// A register of neighbouring columns.
struct Block<R: Registers, const JET: usize> {
    /// Their homogeneous derivatives.
    h: [[Lanes<R>; 4]; JET],
    /// Of the denominators, where quotients are computed with it.
    inverse: Lanes<R>,
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
    Places::of(out, LARGE, |out| {
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
        let n = cross(&a, &b);
        let nn = dot(&n, &n);
        let inverse = Lanes::splat(r, 1.0) / nn.sqrt();
        let n = [n[0] * inverse, n[1] * inverse, n[2] * inverse];
        let pairs = numbers(&[at[0], at[1], at[2], n[0], n[1], n[2]]);
        write::<R, 6>(&r.interleave_pairs(pairs), out);
        if !all_plain(nn, dot(&a, &a), dot(&b, &b), dot(&at, &at)) {
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
    Places::of(out.as_flattened_mut(), LARGE, |out| {
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

#[cfg(test)]
mod tests;
