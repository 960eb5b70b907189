//! Taylor forms of what a surface is along a side: the point, the tangents, the normal and the curvature across.

use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::mesh::shared::Edge;
use crate::series::{Series, series_cross, series_dot, series_norm2};
use crate::surface::{Dir, jet_index, jet_len};

/// A vector of series in the parameter along an edge.
pub(super) type Vector = [Series<Interval>; 3];

/// The order of the Taylor forms. Their error falls with the (order)-th power of a part's width.
pub(super) const ORDER: usize = 4;

/// The derivatives `∂ᵗᵃ∂ᶜᵇ r` along an edge (t along it, c across) as series in t.
pub(super) struct Along<'a> {
    pub(super) edge: Edge<'a>,
}

impl Along<'_> {
    /// The limit that selects the piece beside the edge.
    fn limit_across(&self) -> Limit {
        if self.edge.side.is_upper() {
            Limit::Below
        } else {
            Limit::Above
        }
    }

    /// Enclosures of the series of all derivatives up to a total order of `orders`, to the order [`ORDER`] in t.
    /// `t` is in one piece; `limit` selects it where t is one point.
    pub(super) fn fields(&self, t: Interval, limit: Limit, orders: usize) -> Fields {
        let across = Interval::point(self.edge.at);
        let along = self.edge.side.along();
        let (uv, limits) = match along {
            Dir::U => ([t, across], [limit, self.limit_across()]),
            Dir::V => ([across, t], [self.limit_across(), limit]),
        };
        let mut d = vec![Box3::ENTIRE; jet_len(orders + ORDER)];
        self.edge
            .surface
            .enclose_piece(uv, limits, orders + ORDER, &mut d);
        Fields { d, along }
    }

    /// The parameters where pieces meet, and the ends.
    pub(super) fn breaks(&self) -> Vec<f64> {
        let Interval { lo, hi } = self.edge.range;
        let breaks = self.edge.surface.breaks(self.edge.side.along());
        let inside = breaks.iter().map(|b| b.at).filter(|&t| lo < t && t < hi);
        std::iter::once(lo).chain(inside).chain([hi]).collect()
    }

    /// The piece that holds most of `t`.
    pub(super) fn piece(&self, t: Interval) -> Interval {
        let breaks = self.edge.surface.breaks(self.edge.side.along());
        breaks.piece(breaks.find(t.mid(), Limit::Above))
    }
}

/// Enclosed derivatives along an edge.
pub(super) struct Fields {
    d: Vec<Box3>,
    along: Dir,
}

impl Fields {
    /// The series in t of the derivative that is the a-th along and the b-th across.
    pub(super) fn series(&self, a: usize, b: usize) -> Vector {
        self.series_to(ORDER, a, b)
    }

    /// The same to another order: together with a and b at most the orders of the fields and [`ORDER`].
    pub(super) fn series_to(&self, order: usize, a: usize, b: usize) -> Vector {
        let d: Vec<[Interval; 3]> = (0..=order)
            .map(|k| {
                let (i, j) = match self.along {
                    Dir::U => (a + k, b),
                    Dir::V => (b, a + k),
                };
                self.d[jet_index(i, j)].to_array()
            })
            .collect();
        [0, 1, 2].map(|c| {
            let column: Vec<Interval> = d.iter().map(|x| x[c]).collect();
            Series::from_derivatives(&column)
        })
    }

    /// `r_t × r_c`.
    pub(super) fn normal(&self) -> Vector {
        series_cross(&self.series(1, 0), &self.series(0, 1))
    }

    /// The normal curvature across the edge, in the tangent plane square to the edge, with the sign of `r_t × r_c`:
    /// `II(w, w)/|w|²` with `w = r_c - r_t (r_c·r_t)/(r_t·r_t)`.
    pub(super) fn curvature(&self) -> Series<Interval> {
        let (t, c) = (self.series(1, 0), self.series(0, 1));
        let n = series_cross(&t, &c);
        let (tt, ct) = (series_norm2(&t), series_dot(&c, &t));
        let [rtt, rtc, rcc] = [self.series(2, 0), self.series(1, 1), self.series(0, 2)];
        // II along w, times |n| (t·t)².
        let two = Interval::point(2.0);
        let form = series_dot(&rcc, &n)
            .mul(&tt.sqr())
            .sub(&series_dot(&rtc, &n).mul(&ct.mul(&tt)).scale(two))
            .add(&series_dot(&rtt, &n).mul(&ct.sqr()));
        // |w|² = |n|²/(t·t).
        let n2 = series_norm2(&n);
        form.div(&tt.mul(&n2).mul(&n2.sqrt()))
    }
}

/// The series of `f(φ(t))` from the series of f at φ(t) and that of φ at t.
pub(super) fn compose(f: &Series<Interval>, phi: &Series<Interval>) -> Series<Interval> {
    let mut step = phi.clone();
    step.c[0] = Interval::ZERO;
    let order = phi.order();
    let mut r = Series::constant(f.c[order], order);
    for k in (0..order).rev() {
        r = r.mul(&step);
        r.c[0] = r.c[0] + f.c[k];
    }
    r
}

/// `Σ_{k < order} c_k(m) xᵏ⁻ᵈ + c_order(T) xᵒʳᵈᵉʳ⁻ᵈ` over x = T - m: the function, or if its first d coefficients
/// vanish, the function over xᵈ.
pub(super) fn taylor(
    at: &Series<Interval>,
    over: &Series<Interval>,
    x: Interval,
    drop: usize,
) -> Interval {
    let order = over.order();
    let mut sum = Interval::ZERO;
    for k in drop..=order {
        let c = if k < order { at.c[k] } else { over.c[k] };
        sum = sum + c * x.powi((k - drop) as i32);
    }
    sum
}
