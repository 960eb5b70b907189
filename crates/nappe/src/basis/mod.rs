//! One-variable scalar functions: the bases and blending functions that surfaces are made of.

use crate::box3::Box3;
use crate::breaks::{Break, Limit, UNIT_BREAKS, merge_breaks};
use crate::curve::CurveRef;
use crate::exact::PiecewiseRational;
use crate::interval::Interval;
use crate::scalar::{Number, Pack};
use glam::DVec3;
use pulp::bytemuck::cast_slice_mut;
use smallvec::SmallVec;
use std::fmt::Debug;
use std::ops::Range;
use std::sync::Arc;

/// A list of scalar functions `a_0(t) … a_{n-1}(t)` of one variable: one side of a separable surface.
///
/// All lists are row-major by derivative: `out[k * active.len() + i]` is the k-th derivative of the i-th active
/// function.
pub trait Functions: Debug + Send + Sync {
    /// The number of functions.
    fn count(&self) -> usize;

    /// The parameters where analytic pieces meet, with the ends of the domain first and last.
    fn breaks(&self) -> &[Break];

    /// The functions that may be other than zero in the piece that holds `t`. The default is all.
    fn active(&self, _t: f64, _limit: Limit) -> Range<usize> {
        0..self.count()
    }

    /// True if the functions sum to 1 everywhere, exactly: enclosures of what they combine are then much narrower.
    fn sums_to_one(&self) -> bool {
        false
    }

    /// Writes derivatives 0 to `order` of the active functions at `t`.
    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]);

    /// Writes the same at the parameters of a pack, with the bits of [`Functions::jet_into`]. They may lie in different
    /// pieces, with different active functions in the lanes, but with the same number of them. By default `jet_into` is
    /// called for each; a formula over [`Number`] is evaluated several times faster with a pack.
    fn pack_into(&self, t: Pack, limit: Limit, order: usize, out: &mut [Pack]) {
        t.each_lane(out, |t, out| self.jet_into(t, limit, order, out));
    }

    /// The active functions at `t`, with their derivatives 0 to `order` in the first places of `out`, if these are enough;
    /// otherwise `out` keeps what it holds.
    fn active_jet(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) -> Range<usize> {
        let active = self.active(t, limit);
        if let Some(out) = out.get_mut(..(order + 1) * active.len()) {
            self.jet_into(t, limit, order, out);
        }
        active
    }

    /// Writes enclosures of the same for every parameter in `t`, which lies in one piece (found from its middle
    /// and `limit`).
    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]);

    /// The exact piecewise rational form, where there is one.
    fn to_piecewise(&self) -> Option<PiecewiseRational> {
        None
    }

    /// The functions prepared for many parameters, where that pays. An error of 1 in each function moves the surface
    /// that is made of them by `effects` of the surface's size.
    fn table(&self, _effects: &[f64]) -> Option<Table> {
        Table::from_piecewise(&self.to_piecewise()?)
    }
}

/// A shared list of functions.
pub type FunctionsRef = Arc<dyn Functions>;

/// What functions have values in: one number, or a pack.
pub(crate) trait Value: Number {
    /// [`Functions::jet_into`] or [`Functions::pack_into`].
    fn jet(functions: &dyn Functions, t: Self, limit: Limit, order: usize, out: &mut [Self]);
}

impl Value for f64 {
    fn jet(functions: &dyn Functions, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        functions.jet_into(t, limit, order, out);
    }
}

impl Value for Pack {
    fn jet(functions: &dyn Functions, t: Pack, limit: Limit, order: usize, out: &mut [Pack]) {
        functions.pack_into(t, limit, order, out);
    }
}

/// The constant function 1 on `[0, 1]`.
#[derive(Clone, Copy, Debug)]
pub struct One;

impl Functions for One {
    fn count(&self) -> usize {
        1
    }
    fn breaks(&self) -> &[Break] {
        &UNIT_BREAKS
    }
    fn jet_into(&self, _t: f64, _limit: Limit, order: usize, out: &mut [f64]) {
        out[..=order].fill(0.0);
        out[0] = 1.0;
    }
    fn enclose_piece(&self, _t: Interval, _limit: Limit, order: usize, out: &mut [Interval]) {
        out[..=order].fill(Interval::ZERO);
        out[0] = Interval::ONE;
    }
    fn to_piecewise(&self) -> Option<PiecewiseRational> {
        Some(PiecewiseRational::polynomial(
            UNIT_BREAKS.to_vec(),
            0,
            1,
            vec![1.0],
        ))
    }
}

/// The three coordinates of a curve, measured from an origin: subtracting it keeps enclosures tight far from the
/// origin of space.
#[derive(Clone, Debug)]
pub struct Coordinates {
    curve: CurveRef,
    origin: DVec3,
}

impl Coordinates {
    /// The coordinates of `curve - origin`.
    pub fn new(curve: CurveRef, origin: DVec3) -> Self {
        Self { curve, origin }
    }
}

impl Functions for Coordinates {
    fn count(&self) -> usize {
        3
    }
    fn breaks(&self) -> &[Break] {
        self.curve.breaks()
    }
    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        let d: &mut [DVec3] = cast_slice_mut(&mut out[..3 * (order + 1)]);
        self.curve.jet_into(t, limit, d);
        d[0] -= self.origin;
    }
    fn pack_into(&self, t: Pack, limit: Limit, order: usize, out: &mut [Pack]) {
        let d = &mut out.as_chunks_mut().0[..=order];
        self.curve.pack_into(t, limit, d);
        for (x, origin) in d[0].iter_mut().zip(self.origin.to_array()) {
            *x = *x - Pack::from(origin);
        }
    }
    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        let mut d: SmallVec<[Box3; 4]> = SmallVec::from_elem(Box3::ENTIRE, order + 1);
        self.curve.enclose_piece(t, limit, &mut d);
        d[0] = d[0] - Box3::point(self.origin);
        for (o, d) in out.chunks_exact_mut(3).zip(&d) {
            o.copy_from_slice(&d.to_array());
        }
    }
    fn to_piecewise(&self) -> Option<PiecewiseRational> {
        Some(self.curve.to_nurbs()?.to_piecewise(self.origin))
    }
}

/// Several lists of functions of the same variable, one after the other.
#[derive(Clone, Debug)]
pub struct Stack {
    parts: Vec<FunctionsRef>,
    breaks: Vec<Break>,
    count: usize,
}

impl Stack {
    /// All functions of all parts in order. The parts share a domain. Panics without parts.
    pub fn new(parts: Vec<FunctionsRef>) -> Self {
        let breaks = merge_breaks(parts.iter().map(|p| p.breaks()));
        assert!(
            breaks.len() >= 2,
            "a stack of functions needs parts over a common domain"
        );
        let count = parts.iter().map(|p| p.count()).sum();
        Self {
            parts,
            breaks,
            count,
        }
    }

    /// Spreads the active functions of one part into the rows of the whole list.
    fn gather<T: Copy>(
        &self,
        t: f64,
        limit: Limit,
        order: usize,
        zero: T,
        out: &mut [T],
        eval: impl Fn(&dyn Functions, &mut [T]),
    ) {
        let mut start = 0;
        let mut buffer: SmallVec<[T; 32]> = SmallVec::new();
        for part in &self.parts {
            let (active, count) = (part.active(t, limit), part.count());
            if order == 0 {
                let row = &mut out[start..][..count];
                row.fill(zero);
                eval(part.as_ref(), &mut row[active]);
            } else {
                buffer.clear();
                buffer.resize((order + 1) * active.len(), zero);
                eval(part.as_ref(), &mut buffer);
                for k in 0..=order {
                    let row = &mut out[k * self.count + start..][..count];
                    row.fill(zero);
                    row[active.clone()]
                        .copy_from_slice(&buffer[k * active.len()..][..active.len()]);
                }
            }
            start += count;
        }
    }
}

impl Functions for Stack {
    fn count(&self) -> usize {
        self.count
    }
    fn breaks(&self) -> &[Break] {
        &self.breaks
    }
    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        self.gather(t, limit, order, 0.0, out, |p, o| {
            p.jet_into(t, limit, order, o)
        });
    }
    fn pack_into(&self, t: Pack, limit: Limit, order: usize, out: &mut [Pack]) {
        let same = |p: &FunctionsRef| t.common(|t| p.active(t, limit)).is_some();
        if !self.parts.iter().all(same) {
            return t.each_lane(out, |t, out| self.jet_into(t, limit, order, out));
        }
        self.gather(t.0[0], limit, order, Pack::ZERO, out, |p, o| {
            p.pack_into(t, limit, order, o)
        });
    }
    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        self.gather(t.mid(), limit, order, Interval::ZERO, out, |p, o| {
            p.enclose_piece(t, limit, order, o)
        });
    }
    fn to_piecewise(&self) -> Option<PiecewiseRational> {
        let parts: Option<Vec<_>> = self.parts.iter().map(|p| p.to_piecewise()).collect();
        Some(PiecewiseRational::stack(&parts?))
    }
    fn table(&self, effects: &[f64]) -> Option<Table> {
        // Together the parts are found and evaluated once.
        let whole: FunctionsRef = Arc::new(self.clone());
        Table::taylor(&whole, effects).or_else(|| Some(Table::stack(&self.parts, effects)))
    }
}

mod blending;
mod bspline;
mod combination;
mod expression;
mod framed;
mod hermite;
mod side_jet;
mod table;
mod taylor;
mod trigonometric;
mod turn;

pub use blending::{Blending, BlendingError, BlendingFault};
pub use bspline::{BSplineBasis, KnotError};
pub use combination::Combination;
pub use expression::{ExpressionFunctions, ExpressionFunctionsError};
pub use framed::Framed;
pub use hermite::Hermite;
pub(crate) use side_jet::SideJet;
pub use table::Table;
pub(crate) use table::{Powers, TABLE_ORDER};
pub use trigonometric::{Trigonometric, TrigonometricError};
pub use turn::Turn;

/// The active functions at `t` and their derivatives 0 to `order`: on the stack if it is enough, else on the heap.
#[inline(always)]
pub(crate) fn jet_of<'a>(
    functions: &dyn Functions,
    (t, limit): (f64, Limit),
    order: usize,
    stack: &'a mut [f64],
    heap: &'a mut Vec<f64>,
) -> (Range<usize>, &'a [f64]) {
    let active = functions.active_jet(t, limit, order, stack);
    let n = (order + 1) * active.len();
    if n <= stack.len() {
        return (active, &stack[..n]);
    }
    heap.resize(n, 0.0);
    functions.jet_into(t, limit, order, heap);
    (active, heap)
}

/// Room for `n` items of `zero`: on the stack if it is enough, else on the heap.
#[inline(always)]
pub(crate) fn room<'a, T: Copy>(
    stack: &'a mut [T],
    heap: &'a mut Vec<T>,
    n: usize,
    zero: T,
) -> &'a mut [T] {
    if n <= stack.len() {
        &mut stack[..n]
    } else {
        heap.resize(n, zero);
        heap
    }
}
