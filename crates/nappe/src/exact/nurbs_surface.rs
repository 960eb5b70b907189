//! NURBS surfaces.

use super::hull;
use super::nurbs_curve::{homogeneous, middle};
use super::piecewise::bernstein_elevate;
use super::spline::{Row, join};
use super::{NurbsError, PiecewiseRational};
use crate::basis::{BSplineBasis, Functions, KnotError};
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit, Part};
use crate::interval::Interval;
use crate::surface::{
    Core, Dir, Separable, Surface, check_length, enclose_centred, enclose_direct, jet_len,
};
use glam::{DVec3, DVec4, Vec4Swizzles};
use smallvec::SmallVec;
use std::sync::Arc;

/// A NURBS surface; without weights a B-spline surface, without inner knots a (rational) Bézier surface.
///
/// `r(u, v) = ΣΣ N_i(u) M_j(v) w_ij p_ij / ΣΣ N_i(u) M_j(v) w_ij`. The net is row-major: v fastest.
/// Source: Golovanov, *Geometric modelling*, §3.9 (3.9.1) and (3.9.4).
#[derive(Clone, Debug)]
pub struct NurbsSurface {
    basis_u: Arc<BSplineBasis>,
    basis_v: Arc<BSplineBasis>,
    /// Homogeneous points as given.
    points: Vec<DVec4>,
    form: Separable,
}

impl NurbsSurface {
    /// From a row-major net (`points[i * columns + j]`, i along u), knots and weights (`None`: all 1).
    pub fn new(
        degree: [usize; 2],
        knots: [Vec<f64>; 2],
        points: &[DVec3],
        weights: Option<&[f64]>,
    ) -> Result<Self, NurbsError> {
        let [ku, kv] = knots;
        let basis_u = BSplineBasis::new(degree[0], ku)?;
        let basis_v = BSplineBasis::new(degree[1], kv)?;
        let (rows, columns) = (basis_u.count(), basis_v.count());
        if rows * columns != points.len() {
            return Err(NurbsError::NetSize {
                rows,
                columns,
                points: points.len(),
            });
        }
        Ok(Self::from_homogeneous(
            basis_u,
            basis_v,
            homogeneous(points, weights)?,
        ))
    }

    /// A (rational) Bézier surface on `[0, 1]²` from a row-major net with the given number of rows.
    pub fn bezier(
        rows: usize,
        points: &[DVec3],
        weights: Option<&[f64]>,
    ) -> Result<Self, NurbsError> {
        let columns = points.len().checked_div(rows).unwrap_or(0);
        if rows * columns != points.len() || points.is_empty() {
            return Err(NurbsError::NetSize {
                rows,
                columns,
                points: points.len(),
            });
        }
        for n in [rows, columns] {
            if n < 2 {
                return Err(KnotError::TooFewPoints {
                    points: n,
                    degree: 1,
                }
                .into());
            }
            if n > BSplineBasis::MAX_DEGREE + 1 {
                return Err(KnotError::Degree { degree: n - 1 }.into());
            }
        }
        let h = homogeneous(points, weights)?;
        Ok(Self::from_homogeneous(
            BSplineBasis::bernstein(rows - 1),
            BSplineBasis::bernstein(columns - 1),
            h,
        ))
    }

    /// From points `(w x, w y, w z, w)`. Panics if their number is not that of the bases.
    pub fn from_homogeneous(
        basis_u: BSplineBasis,
        basis_v: BSplineBasis,
        points: Vec<DVec4>,
    ) -> Self {
        let (basis_u, basis_v) = (Arc::new(basis_u), Arc::new(basis_v));
        let origin = middle(&points);
        let w0 = points[0].w;
        let rational = points.iter().any(|p| p.w != w0);
        let scale = if rational { 1.0 } else { w0 };
        let net = points
            .iter()
            .map(|p| ((p.xyz() - origin * p.w) / scale).extend(p.w / scale))
            .collect();
        let make = if rational {
            Separable::rational
        } else {
            Separable::polynomial
        };
        let form = make(basis_u.clone(), basis_v.clone(), Core::Net(net), origin);
        Self {
            basis_u,
            basis_v,
            points,
            form,
        }
    }

    fn enclose_part(&self, parts: [&hull::Part; 2], order: usize, out: &mut [Box3]) {
        let Core::Net(net) = self.form.core() else {
            return out.fill(Box3::ENTIRE);
        };
        let columns = self.basis_v.count();
        let middle = hull::middle(net, columns, parts);
        let rational = self.is_rational();
        let shift = if rational {
            middle.xyz() / middle.w
        } else {
            middle.xyz()
        };
        // With the roundings of the difference, and of the product before it.
        let point = |c: DVec4| {
            let moved = if rational {
                (c.xyz() - shift * c.w).extend(c.w)
            } else {
                (c.xyz() - shift).extend(0.0)
            };
            let product = if rational { shift * c.w } else { DVec3::ZERO };
            let off = (moved.xyz().abs() + product.abs()) * f64::EPSILON;
            [moved.to_array(), off.extend(0.0).to_array()]
        };
        let h = hull::derivatives(net, columns, parts, point, order);
        let mut r: SmallVec<[[Interval; 3]; 16]> =
            SmallVec::from_elem([Interval::ZERO; 3], jet_len(order));
        self.form.dehomogenise(&h, order, &mut r);
        for (o, r) in out.iter_mut().zip(&r) {
            *o = Box3::from(*r);
        }
        out[0] = out[0] + Box3::point(shift) + Box3::point(self.form.origin());
    }

    /// The exact NURBS form of a separable surface whose functions are all piecewise rational.
    pub(crate) fn from_separable(s: &Separable) -> Option<Self> {
        let (u, v) = (
            s.functions_u().to_piecewise()?,
            s.functions_v().to_piecewise()?,
        );
        let (p, q) = (u.degree().max(1), v.degree().max(1));
        let (pieces_u, pieces_v) = (u.breaks().len() - 1, v.breaks().len() - 1);
        let origin = s.origin();
        // The Bézier net of every piece pair; `grid[a][b][i][j]` flattened.
        let at = |a: usize, b: usize, i: usize, j: usize| {
            ((a * pieces_v + b) * (p + 1) + i) * (q + 1) + j
        };
        let mut grid = vec![DVec4::ZERO; pieces_u * pieces_v * (p + 1) * (q + 1)];
        let num = |f: &PiecewiseRational, piece, k, degree| {
            bernstein_elevate(f.numerator(piece, k), degree)
        };
        for a in 0..pieces_u {
            let nu: Vec<_> = (0..u.count()).map(|k| num(&u, a, k, p)).collect();
            let du = bernstein_elevate(&u.denominator(a), p);
            for b in 0..pieces_v {
                let nv: Vec<_> = (0..v.count()).map(|k| num(&v, b, k, q)).collect();
                let dv = bernstein_elevate(&v.denominator(b), q);
                let mut add = |k: usize, l: usize, c: DVec4| {
                    for i in 0..=p {
                        for j in 0..=q {
                            grid[at(a, b, i, j)] += c * (nu[k][i] * nv[l][j]);
                        }
                    }
                };
                match s.core() {
                    Core::Net(net) => {
                        for k in (0..u.count()).filter(|&k| nu[k].iter().any(|x| *x != 0.0)) {
                            for l in (0..v.count()).filter(|&l| nv[l].iter().any(|x| *x != 0.0)) {
                                add(k, l, net[k * v.count() + l]);
                            }
                        }
                    }
                    Core::Terms(terms) => terms.iter().for_each(|t| add(t.i, t.j, t.c)),
                }
                for i in 0..=p {
                    for j in 0..=q {
                        let g = &mut grid[at(a, b, i, j)];
                        if !s.is_rational() {
                            g.w = du[i] * dv[j];
                        }
                        *g = (g.xyz() + origin * g.w).extend(g.w);
                    }
                }
            }
        }
        let point = |a, b, i, j| grid[at(a, b, i, j)];
        Self::from_grid([u.breaks(), v.breaks()], [p, q], point).ok()
    }

    /// Joins Bézier patches over a grid of breaks (whose smoothness is that of the homogeneous form) into one surface:
    /// `point(a, b, i, j)` is the point (i, j) of the patch over the a-th piece in u and the b-th in v.
    pub(crate) fn from_grid(
        breaks: [&[Break]; 2],
        degree: [usize; 2],
        point: impl Fn(usize, usize, usize, usize) -> DVec4,
    ) -> Result<Self, NurbsError> {
        let [pieces_u, pieces_v] = breaks.map(|b| b.pieces());
        let [p, q] = degree;
        // Along v for all rows of the grid together, then along u.
        let along_v: Vec<Vec<Row>> = (0..pieces_v)
            .map(|b| {
                let column = |j| {
                    let rows = (0..pieces_u).flat_map(|a| (0..=p).map(move |i| (a, i)));
                    rows.map(|(a, i)| point(a, b, i, j)).collect()
                };
                (0..=q).map(column).collect()
            })
            .collect();
        let v = join(breaks[1], q, &along_v);
        let along_u: Vec<Vec<Row>> = (0..pieces_u)
            .map(|a| {
                let row = |i| v.rows.iter().map(|c| c[a * (p + 1) + i]).collect();
                (0..=p).map(row).collect()
            })
            .collect();
        let u = join(breaks[0], p, &along_u);
        Ok(Self::from_homogeneous(
            BSplineBasis::new(p, u.knots)?,
            BSplineBasis::new(q, v.knots)?,
            u.rows.into_iter().flatten().collect(),
        ))
    }

    /// The basis along u: degree and knots.
    pub fn basis_u(&self) -> &BSplineBasis {
        &self.basis_u
    }

    /// The basis along v.
    pub fn basis_v(&self) -> &BSplineBasis {
        &self.basis_v
    }

    /// The number of rows (along u) and columns (along v) of the net.
    pub fn size(&self) -> [usize; 2] {
        [self.basis_u.count(), self.basis_v.count()]
    }

    /// The points `(w x, w y, w z, w)`, row-major.
    pub fn homogeneous(&self) -> &[DVec4] {
        &self.points
    }

    /// The control points in space, row-major.
    pub fn control_points(&self) -> Vec<DVec3> {
        self.points.iter().map(|p| p.xyz() / p.w).collect()
    }

    /// The weights, row-major.
    pub fn weights(&self) -> Vec<f64> {
        self.points.iter().map(|p| p.w).collect()
    }

    /// The surface as a sum of products.
    pub fn separable(&self) -> &Separable {
        &self.form
    }

    /// The homogeneous Bézier points over a part of a span, those of the first row of u first, each with a few roundings of
    /// the points of the span.
    pub(crate) fn bezier_points(&self, uv: [Interval; 2]) -> Vec<DVec4> {
        let part = |basis, t| hull::Part::new(basis, t, Limit::Above, 0);
        let parts = [part(&self.basis_u, uv[0]), part(&self.basis_v, uv[1])];
        hull::bezier_points(
            self.homogeneous(),
            self.basis_v.count(),
            [&parts[0], &parts[1]],
        )
    }

    /// True if the weights differ.
    pub fn is_rational(&self) -> bool {
        self.form.is_rational()
    }
}

impl Surface for NurbsSurface {
    fn breaks(&self, dir: Dir) -> &[Break] {
        self.form.breaks(dir)
    }

    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        self.form.jet_into(uv, limit, order, out);
    }

    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]) {
        let part = |d: usize| [(uv[d], limit[d])];
        self.enclose_pieces([&part(0), &part(1)], order, out);
    }

    fn enclose_pieces(&self, [us, vs]: [&[Part]; 2], order: usize, out: &mut [Box3]) {
        let each = jet_len(order);
        check_length(us.len() * vs.len() * each, out.len());
        let part =
            |basis: &BSplineBasis, &(t, limit): &Part| hull::Part::new(basis, t, limit, order);
        let vs: Vec<_> = vs.iter().map(|p| part(&self.basis_v, p)).collect();
        let mut jets = out.chunks_exact_mut(each);
        for u in us.iter().map(|p| part(&self.basis_u, p)) {
            for (v, jet) in vs.iter().zip(&mut jets) {
                self.enclose_part([&u, v], order, jet);
            }
        }
    }

    /// The hulls of a polynomial surface converge at second order by themselves, and so do not need the centred form.
    fn enclose(&self, uv: [Interval; 2], order: usize) -> Vec<Box3> {
        if self.is_rational() {
            enclose_centred(self, uv, order)
        } else {
            enclose_direct(self, uv, order)
        }
    }

    fn jets(&self, uv: &[[f64; 2]], order: usize, out: &mut [DVec3]) {
        self.form.jets(uv, order, out);
    }

    fn grid_jets(&self, u: &[f64], v: &[f64], order: usize, out: &mut [DVec3]) {
        self.form.grid_jets(u, v, order, out);
    }

    fn grid_normals(&self, u: &[f64], v: &[f64], out: &mut [[DVec3; 2]]) {
        self.form.grid_normals(u, v, out);
    }

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        Some(self.clone())
    }
}
