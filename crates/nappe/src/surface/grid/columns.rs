//! The functions of v at the columns of a grid, and the columns that share them.

use crate::basis::Functions;
use crate::breaks::Limit;
use crate::scalar::{Number, Pack};
use crate::simd::far_from_limits;
use crate::surface::{Core, Separable};
use smallvec::SmallVec;
use std::ops::Range;

/// How many columns are prepared together: their functions fill a part of the second-level cache.
pub(super) const COLUMNS: usize = 2048;

/// Neighbouring columns with the same active functions of v.
pub(super) struct Piece {
    pub(super) columns: Range<usize>,
    pub(super) active: Range<usize>,
    /// All functions are [`far_from_limits`].
    pub(super) moderate: bool,
    pub(super) sparse: Sparse,
}

/// Hands on the functions at all parameters, as many as a pack has at a time: their derivatives, and where the lanes are
/// among the parameters. Lanes behind the last parameter repeat it.
#[inline(always)]
pub(super) fn in_packs(
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
pub(super) struct Columns {
    pub(super) count: usize,
    pub(super) pieces: Vec<Piece>,
    /// The number of active functions at a column.
    pub(super) active: usize,
    /// For each derivative and each active function its values at all columns, and at some behind the last.
    values: Vec<f64>,
    /// How far apart these lists are.
    stride: usize,
}

impl Columns {
    pub(super) fn new(surface: &Separable, v: &[f64], order: usize) -> Self {
        let functions = surface.functions_v().as_ref();
        let stride = v.len().next_multiple_of(Pack::LANES) + Pack::LANES;
        let mut values = Vec::new();
        in_packs(functions, v, order, |columns, pack| {
            values.resize(pack.len() * stride, 0.0);
            for (values, pack) in values.chunks_exact_mut(stride).zip(pack) {
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
                moderate: surface.is_rational() && values.chunks_exact(stride).all(moderate),
                sparse: Sparse::new(surface, &active),
                columns,
                active,
            }
        };
        let pieces = active.chunk_by(|a, b| a == b).map(piece).collect();
        Self {
            count: v.len(),
            active: values.len() / stride / (order + 1),
            pieces,
            values,
            stride,
        }
    }

    /// Values of the j-th active function's q-th derivative from a column on, so many as a register may hold.
    pub(super) fn values(&self, q: usize, j: usize, column: usize) -> &[f64] {
        &self.values[(q * self.active + j) * self.stride + column..][..Pack::LANES]
    }
}

/// The part of a sparse core that a piece sees; empty if the core is a net.
#[derive(Default)]
pub(super) struct Sparse {
    /// For each coordinate which of the active functions of v it depends on, side by side: most functions of a Coons surface
    /// move one coordinate. One with fewer has more of the first function, with vectors that stay zero.
    pub(super) used: Vec<[usize; 4]>,
    pub(super) products: Vec<Product>,
}

/// A function of u times a constant, which goes to a coordinate of the vector of a used function.
pub(super) struct Product {
    i: usize,
    factor: f64,
    to: [usize; 2],
}

impl Sparse {
    pub(super) fn new(surface: &Separable, active: &Range<usize>) -> Self {
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
    pub(super) fn collapse(
        &self,
        a: &[f64],
        active: &Range<usize>,
        rows: usize,
        out: &mut Vec<[f64; 4]>,
    ) {
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
