//! NURBS surfaces with other knots, degrees, domains, and the curves on them: the same points by other data.

use super::curve_tools::{
    check_degree, check_interval, check_multiplicity, check_part, inside, refine, single_rows,
};
use super::piecewise::{PiecewiseRational, bernstein_product};
use super::spline::{Row, Spline, join};
use super::{NurbsCurve, NurbsError, NurbsSurface};
use crate::basis::{BSplineBasis, Functions};
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::series::binomial;
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

    /// The derivative of an order across an isoparametric curve (`∂ᵏr/∂vᵏ` along u, or `∂ᵏr/∂uᵏ` along v), as a
    /// vector-valued curve: a NURBS curve of the same degree, or of `k + 1` times the degree for a rational surface.
    ///
    /// Error: that degree is more than what is possible.
    pub fn cross_derivative(
        &self,
        along: Dir,
        at: f64,
        limit: Limit,
        order: usize,
    ) -> Result<NurbsCurve, NurbsError> {
        let all = self.cross_derivatives(along, at, limit, order, DVec3::ZERO)?;
        let pieces: Vec<Vec<Row>> = (0..all.breaks().pieces())
            .map(|i| {
                let den = all.denominator(i);
                let point = |k: usize| {
                    let [x, y, z] = [0, 1, 2].map(|c| all.numerator(i, 3 * order + c)[k]);
                    vec![DVec4::new(x, y, z, den[k])]
                };
                (0..=all.degree()).map(point).collect()
            })
            .collect();
        NurbsCurve::from_spline(join(all.breaks(), all.degree(), &pieces))
    }

    /// The coordinates of an isoparametric curve, measured from `origin`, and of the derivatives
    /// across it up to an order: three functions for each. All have one denominator, the surface's to the power of
    /// `order + 1`.
    ///
    /// Error: the degree, that of the surface times `order + 1` if it is rational, is more than what is possible.
    pub(crate) fn cross_derivatives(
        &self,
        along: Dir,
        at: f64,
        limit: Limit,
        order: usize,
        origin: DVec3,
    ) -> Result<PiecewiseRational, NurbsError> {
        let own = super::nurbs_curve::middle(self.homogeneous());
        let lines = self.contracted(along, at, limit, order, own);
        let basis = self.basis(along);
        let p = basis.degree();
        // Measured from a point near the curve: less cancellation in the quotients.
        let near = super::nurbs_curve::middle(&lines[0]);
        let shift = own - origin + near;
        let local = |p: DVec4| (p.xyz() - near * p.w).extend(p.w);
        let mut breaks = Vec::new();
        let lines: Vec<Vec<Vec<Row>>> = lines
            .into_iter()
            .map(|line| {
                let rows = single_rows(line.into_iter().map(local));
                let (own, pieces) = Spline::new(basis, rows).pieces();
                breaks = own;
                pieces
            })
            .collect();
        let count = 3 * (order + 1);
        let row = |k: usize, piece: usize, c: usize| -> Vec<f64> {
            lines[k][piece].iter().map(|x| x[0][c]).collect()
        };
        let mut num = Vec::new();
        if !self.is_rational() {
            for piece in 0..breaks.pieces() {
                let w = lines[0][piece][0][0].w;
                for f in 0..count {
                    let added = if f < 3 { shift[f] } else { 0.0 };
                    num.extend(row(f / 3, piece, f % 3).iter().map(|x| x / w + added));
                }
            }
            return Ok(PiecewiseRational::polynomial(breaks, p, count, num));
        }
        // r⁽ᵏ⁾ = N_k / wᵏ⁺¹ with N_k = wᵏ R⁽ᵏ⁾ - Σ_{j<k} C(k, j) w⁽ᵏ⁻ʲ⁾ wᵏ⁻ʲ⁻¹ N_j: the quotient rule.
        let degree = p * (order + 1);
        check_degree(p, degree)?;
        let mut den = Vec::new();
        for piece in 0..breaks.pieces() {
            let weights: Vec<Vec<f64>> = (0..=order).map(|k| row(k, piece, 3)).collect();
            let times_w = |mut f: Vec<f64>, times: usize| {
                for _ in 0..times {
                    f = bernstein_product(&f, &weights[0]);
                }
                f
            };
            let mut n: Vec<Vec<Vec<f64>>> = vec![Vec::new(); 3];
            for k in 0..=order {
                for (c, n) in n.iter_mut().enumerate() {
                    let mut sum = times_w(row(k, piece, c), k);
                    for (j, earlier) in n.iter().enumerate() {
                        let term = bernstein_product(earlier, &weights[k - j]);
                        let term = times_w(term, k - j - 1);
                        let factor = binomial(k, j);
                        sum.iter_mut().zip(term).for_each(|(s, t)| *s -= factor * t);
                    }
                    n.push(sum);
                }
            }
            let w = times_w(weights[0].clone(), order);
            for f in 0..count {
                let (k, c) = (f / 3, f % 3);
                let added = if k == 0 { shift[c] } else { 0.0 };
                let f = times_w(std::mem::take(&mut n[c][k]), order - k);
                num.extend(f.iter().zip(&w).map(|(f, w)| f + added * w));
            }
            den.extend(w);
        }
        Ok(PiecewiseRational::rational(breaks, degree, count, num, den))
    }
}
