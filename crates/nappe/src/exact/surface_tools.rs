//! NURBS surfaces with other knots, degrees, domains, and the curves on them: the same points by other data.

use super::curve_tools::{
    check_degree, check_interval, check_multiplicity, check_part, inside, refine, single_rows,
};
use super::piecewise::bernstein_product;
use super::spline::{Row, Spline, join};
use super::{NurbsCurve, NurbsError, NurbsSurface};
use crate::basis::{BSplineBasis, Functions};
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::surface::{Dir, Surface};
use glam::{DAffine3, DVec3, DVec4, Vec4Swizzles};
use smallvec::SmallVec;

impl NurbsSurface {
    /// The basis along a direction.
    pub fn basis(&self, dir: Dir) -> &BSplineBasis {
        match dir {
            Dir::U => self.basis_u(),
            Dir::V => self.basis_v(),
        }
    }

    /// The surface as a spline in one direction, with the net lines of the other as control points.
    pub(super) fn to_spline(&self, dir: Dir) -> Spline {
        let columns = self.size()[1];
        let rows: Vec<Row> = match dir {
            Dir::U => self
                .homogeneous()
                .chunks(columns)
                .map(<[DVec4]>::to_vec)
                .collect(),
            Dir::V => (0..columns)
                .map(|j| {
                    self.homogeneous()[j..]
                        .iter()
                        .step_by(columns)
                        .copied()
                        .collect()
                })
                .collect(),
        };
        Spline::new(self.basis(dir), rows)
    }

    /// The surface whose net in one direction is a changed spline.
    pub(super) fn with_spline(&self, dir: Dir, s: Spline) -> Result<Self, NurbsError> {
        let basis = BSplineBasis::new(s.degree, s.knots)?;
        Ok(match dir {
            Dir::U => {
                let points = s.rows.into_iter().flatten().collect();
                Self::from_homogeneous(basis, self.basis_v().clone(), points)
            }
            Dir::V => {
                let points = (0..self.size()[0])
                    .flat_map(|i| s.rows.iter().map(move |r| r[i]))
                    .collect();
                Self::from_homogeneous(self.basis_u().clone(), basis, points)
            }
        })
    }

    /// The same surface with a knot inserted `times` times.
    ///
    /// Errors: `t` is outside the domain; the knot would occur more than `degree` times.
    pub fn insert_knot(&self, dir: Dir, t: f64, times: usize) -> Result<Self, NurbsError> {
        let mut s = self.to_spline(dir);
        inside(t, s.domain())?;
        let multiplicity = s.multiplicity(t) + times;
        check_multiplicity(&s, t, multiplicity)?;
        s.raise(t, multiplicity);
        self.with_spline(dir, s)
    }

    /// The same surface with several knots inserted. Errors: as [`Self::insert_knot`].
    pub fn refined(&self, dir: Dir, knots: &[f64]) -> Result<Self, NurbsError> {
        let mut s = self.to_spline(dir);
        refine(&mut s, knots)?;
        self.with_spline(dir, s)
    }

    /// The same surface with higher degrees (in u and v), clamped. Error: a degree is lower than the surface's or too
    /// high.
    pub fn elevated(&self, degrees: [usize; 2]) -> Result<Self, NurbsError> {
        let mut out = self.clone();
        for (dir, degree) in [Dir::U, Dir::V].into_iter().zip(degrees) {
            check_degree(self.basis(dir).degree(), degree)?;
            let s = out.to_spline(dir).elevated(degree);
            out = out.with_spline(dir, s)?;
        }
        Ok(out)
    }

    /// The part over a rectangle of parameters, clamped, with the parameters it had. Error: not a part of positive
    /// extent.
    pub fn part(&self, u: [f64; 2], v: [f64; 2]) -> Result<Self, NurbsError> {
        let mut out = self.clone();
        for (dir, [from, to]) in [(Dir::U, u), (Dir::V, v)] {
            let s = out.to_spline(dir);
            check_part(from, to, s.domain())?;
            out = out.with_spline(dir, s.part(from, to))?;
        }
        Ok(out)
    }

    /// The parts before and after a parameter of one direction.
    pub fn split(&self, dir: Dir, t: f64) -> Result<[Self; 2], NurbsError> {
        let s = self.to_spline(dir);
        let Interval { lo, hi } = s.domain();
        check_part(lo, t, s.domain())?;
        check_part(t, hi, s.domain())?;
        Ok([
            self.with_spline(dir, s.clone().part(lo, t))?,
            self.with_spline(dir, s.part(t, hi))?,
        ])
    }

    /// The Bézier surfaces between the knots, those of the first span of u first, each with the parameters it had.
    pub fn bezier_pieces(&self) -> Result<Vec<Self>, NurbsError> {
        let mut out = Vec::new();
        for u in self.breaks(Dir::U).windows(2) {
            for v in self.breaks(Dir::V).windows(2) {
                out.push(self.part([u[0].at, u[1].at], [v[0].at, v[1].at])?);
            }
        }
        Ok(out)
    }

    /// The same surface with end knots of full multiplicity in both directions.
    pub fn clamped(&self) -> Result<Self, NurbsError> {
        let [u, v] = self.domain();
        self.part([u.lo, u.hi], [v.lo, v.hi])
    }

    /// The surface with one parameter run through backwards over the same range. The normal changes its sign.
    ///
    /// Error: knots so near each other that rounding makes them one too often.
    pub fn reversed(&self, dir: Dir) -> Result<Self, NurbsError> {
        let s = self.to_spline(dir);
        let Interval { lo, hi } = s.domain();
        self.with_spline(dir, s.on(hi, lo))
    }

    /// The surface with its parameter ranges mapped linearly to others.
    ///
    /// Errors: not intervals; knots so near each other that rounding makes them one too often.
    pub fn on_domain(&self, u: [f64; 2], v: [f64; 2]) -> Result<Self, NurbsError> {
        let mut out = self.clone();
        for (dir, [lo, hi]) in [(Dir::U, u), (Dir::V, v)] {
            check_interval(lo, hi)?;
            let s = out.to_spline(dir).on(lo, hi);
            out = out.with_spline(dir, s)?;
        }
        Ok(out)
    }

    /// The surface with u and v exchanged: `(u, v) ↦ r(v, u)`. The normal changes its sign.
    pub fn swapped(&self) -> Self {
        let points = self.to_spline(Dir::V).rows.into_iter().flatten().collect();
        Self::from_homogeneous(self.basis_v().clone(), self.basis_u().clone(), points)
    }

    /// The image under an affine map: exact, since only the points move.
    pub fn transformed(&self, map: &DAffine3) -> Self {
        let image = |p: &DVec4| (map.matrix3 * p.xyz() + map.translation * p.w).extend(p.w);
        let points = self.homogeneous().iter().map(image).collect();
        Self::from_homogeneous(self.basis_u().clone(), self.basis_v().clone(), points)
    }

    /// For each control point along `along`, the `k`-th derivatives (k up to `order`) of the net line that crosses
    /// it, at the parameter `at` of the other direction.
    /// Points are measured from `origin`.
    fn contracted(
        &self,
        along: Dir,
        at: f64,
        limit: Limit,
        order: usize,
        origin: DVec3,
    ) -> Vec<Vec<DVec4>> {
        let across = match along {
            Dir::U => self.basis_v(),
            Dir::V => self.basis_u(),
        };
        let active = across.active(at, limit);
        let n = active.len();
        let mut b: SmallVec<[f64; 16]> = SmallVec::from_elem(0.0, (order + 1) * n);
        across.jet_into(at, limit, order, &mut b);
        (0..=order)
            .map(|k| {
                let weights = &b[k * n..][..n];
                let sum = |row: &Row| {
                    let points = row[active.clone()].iter().zip(weights);
                    points
                        .map(|(p, w)| (p.xyz() - origin * p.w).extend(p.w) * *w)
                        .sum()
                };
                self.to_spline(along).rows.iter().map(sum).collect()
            })
            .collect()
    }

    /// The isoparametric curve that runs along `along` with the other parameter held at `at`: the net contracted with
    /// one basis, exactly. `limit` decides where the surface has a break at `at`.
    pub fn isocurve(&self, along: Dir, at: f64, limit: Limit) -> NurbsCurve {
        let points = self
            .contracted(along, at, limit, 0, DVec3::ZERO)
            .swap_remove(0);
        NurbsCurve::from_homogeneous(self.basis(along).clone(), points)
    }

    /// The derivative across an isoparametric curve (`∂r/∂v` along u, or `∂r/∂u` along v), as a vector-valued curve:
    /// a NURBS curve of the same degree, or of twice the degree for a rational surface.
    ///
    /// Error: the degree is more than half of what is possible.
    pub fn cross_derivative(
        &self,
        along: Dir,
        at: f64,
        limit: Limit,
    ) -> Result<NurbsCurve, NurbsError> {
        // The surface's own origin: the derivative is then that of its jets to the last digits, also far away.
        let origin = super::nurbs_curve::middle(self.homogeneous());
        let mut rows = self.contracted(along, at, limit, 1, origin).into_iter();
        let (point, slope) = (
            rows.next().unwrap_or_default(),
            rows.next().unwrap_or_default(),
        );
        let basis = self.basis(along);
        if !self.is_rational() {
            let w = point[0].w;
            let points = slope.iter().map(|p| (p.xyz() / w).extend(1.0)).collect();
            return Ok(NurbsCurve::from_homogeneous(basis.clone(), points));
        }
        // ∂r = (w ∂R - ∂w R) / w², with R measured from a point near the curve: less cancellation.
        check_degree(basis.degree(), 2 * basis.degree())?;
        let origin = super::nurbs_curve::middle(&point);
        let local = |p: DVec4| (p.xyz() - origin * p.w).extend(p.w);
        let spline = |points: Vec<DVec4>| {
            Spline::new(basis, single_rows(points.into_iter().map(local))).pieces()
        };
        let (breaks, point) = spline(point);
        let (_, slope) = spline(slope);
        let pieces: Vec<Vec<Row>> = point
            .iter()
            .zip(&slope)
            .map(|(r, d)| {
                let c =
                    |rows: &[Row], k: usize| -> Vec<f64> { rows.iter().map(|x| x[0][k]).collect() };
                let (w, dw) = (c(r, 3), c(d, 3));
                let mut out = vec![vec![DVec4::ZERO]; 2 * basis.degree() + 1];
                for k in 0..3 {
                    let (a, b) = (
                        bernstein_product(&w, &c(d, k)),
                        bernstein_product(&dw, &c(r, k)),
                    );
                    for (o, (a, b)) in out.iter_mut().zip(a.iter().zip(&b)) {
                        o[0][k] = a - b;
                    }
                }
                for (o, w2) in out.iter_mut().zip(bernstein_product(&w, &w)) {
                    o[0].w = w2;
                }
                out
            })
            .collect();
        debug_assert_eq!(breaks.pieces(), pieces.len());
        NurbsCurve::from_spline(join(&breaks, 2 * basis.degree(), &pieces))
    }
}
