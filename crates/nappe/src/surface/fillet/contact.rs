//! A ball that touches two surfaces: the equations of its contacts, with derivatives of any order, as numbers and as
//! enclosures.
//!
//! The unknowns are the parameters `x = (u1, v1, u2, v2)` of both contacts. The ball's centre is at the same time
//! `S1(u1, v1) + r N1(u1, v1)` and `S2(u2, v2) + r N2(u2, v2)`, with the unit normals towards the ball: three equations.
//! The fourth holds the ball at its place along the path, most often the plane through a point g of a guide, square to
//! its direction: `(c - g)·g' = 0`.

use super::rolling_ball::{Ball, Vector, sum, times};
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::scalar::{Number, Scalar};
use crate::series::{Series, series_cross, series_dot, series_norm2};
use crate::surface::{Dir, Surface, SurfaceRef, jet_index, jet_len};
use glam::{DMat4, DVec3, DVec4};

/// Parameters of both contacts: `(u1, v1, u2, v2)`.
pub(super) type Place<S> = [S; 4];

/// A number in which surfaces have jets.
pub(super) trait Evaluated: Scalar {
    /// The coordinates of the jet of a surface at a place in one of its pieces.
    fn jet(
        surface: &dyn Surface,
        uv: [Self; 2],
        within: [Interval; 2],
        order: usize,
    ) -> Vec<[Self; 3]>;
}

impl Evaluated for f64 {
    fn jet(
        surface: &dyn Surface,
        uv: [f64; 2],
        within: [Interval; 2],
        order: usize,
    ) -> Vec<[f64; 3]> {
        let limit = [0, 1].map(|k| limit_in(within[k], uv[k]));
        let mut d = vec![DVec3::ZERO; jet_len(order)];
        surface.jet_into(uv, limit, order, &mut d);
        d.iter().map(DVec3::to_array).collect()
    }
}

impl Evaluated for Interval {
    fn jet(
        surface: &dyn Surface,
        uv: [Interval; 2],
        within: [Interval; 2],
        order: usize,
    ) -> Vec<[Interval; 3]> {
        // A box that reaches over the end of a piece takes the piece's formula there too: its middle must lie inside.
        let uv = [0, 1].map(|k| {
            let (piece, x) = (within[k], uv[k]);
            if x.mid() > piece.hi {
                Interval::new(x.lo.min(2.0 * piece.hi - x.hi), x.hi)
            } else if x.mid() < piece.lo {
                Interval::new(x.lo, x.hi.max(2.0 * piece.lo - x.lo))
            } else {
                x
            }
        });
        let limit = [0, 1].map(|k| limit_in(within[k], uv[k].mid()));
        let mut d = vec![Box3::ENTIRE; jet_len(order)];
        surface.enclose_piece(uv, limit, order, &mut d);
        d.into_iter().map(Box3::to_array).collect()
    }
}

/// The limit that selects a piece at a parameter in it.
fn limit_in(piece: Interval, t: f64) -> Limit {
    if t >= piece.hi {
        Limit::Below
    } else {
        Limit::Above
    }
}

/// The two surfaces, and on which sides of them the ball is: +1 where `r_u × r_v` points.
#[derive(Clone, Debug)]
pub(super) struct Supports {
    pub surfaces: [SurfaceRef; 2],
    pub sides: [f64; 2],
    /// What centres and contacts are measured from.
    pub origin: DVec3,
}

/// The fourth equation at a place, `value = 0`, and its derivatives.
pub(super) struct Fourth {
    pub value: f64,
    pub row: Place<f64>,
}

/// What the equations say at a place.
#[derive(Clone, Debug)]
pub(super) struct State {
    /// The centre from the first and from the second surface.
    pub centres: [DVec3; 2],
    pub normals: [DVec3; 2],
    /// The derivatives of the centre by the parameters of its surface.
    pub columns: [DVec3; 4],
    /// The tangents of the surfaces.
    pub tangents: [DVec3; 4],
}

impl State {
    /// How far the two centres are apart.
    pub(super) fn gap(&self) -> DVec3 {
        self.centres[0] - self.centres[1]
    }

    /// The derivatives of the gap by all parameters.
    fn gap_columns(&self) -> [DVec3; 4] {
        let c = self.columns;
        [c[0], c[1], -c[2], -c[3]]
    }

    /// The contacts with the first and the second surface, for a radius.
    pub(super) fn contacts(&self, radius: f64) -> [DVec3; 2] {
        [0, 1].map(|k| self.centres[k] - self.normals[k] * radius)
    }

    /// The direction in parameters along which the gap stays zero.
    pub(super) fn null(&self) -> Place<f64> {
        let g = self.gap_columns();
        let det = |a: usize, b: usize, c: usize| g[a].dot(g[b].cross(g[c]));
        [det(1, 2, 3), -det(0, 2, 3), det(0, 1, 3), -det(0, 1, 2)]
    }

    /// The derivative of the centre along a direction in parameters.
    pub(super) fn centre_along(&self, d: Place<f64>) -> DVec3 {
        self.columns[0] * d[0] + self.columns[1] * d[1]
    }

    /// How fast the fastest of centre and contacts moves along a direction in parameters.
    pub(super) fn speed(&self, d: Place<f64>) -> f64 {
        let t = self.tangents;
        let contact = |k: usize| (t[2 * k] * d[2 * k] + t[2 * k + 1] * d[2 * k + 1]).length();
        self.centre_along(d)
            .length()
            .max(contact(0))
            .max(contact(1))
    }

    /// The Newton step for all four equations, `None` where they are singular.
    pub(super) fn step(&self, fourth: &Fourth) -> Option<Place<f64>> {
        let inverse = self.inverse(fourth.row)?;
        let step = inverse * self.gap().extend(fourth.value);
        step.is_finite().then(|| (-step).to_array())
    }

    /// The inverse of the derivatives of all four equations.
    pub(super) fn inverse(&self, row: Place<f64>) -> Option<DMat4> {
        let g = self.gap_columns();
        let [a, b, c, d] = [0, 1, 2, 3].map(|j| g[j].extend(row[j]));
        invert(a, b, c, d)
    }

    /// What is left of the surfaces' curvature beside the ball's, `1 - r κ` for the principal curvature κ that is greatest
    /// towards the ball, of a surface: at most 0 if the ball cuts into it.
    pub(super) fn fit(&self, k: usize) -> f64 {
        let (t, o) = (&self.tangents[2 * k..], &self.columns[2 * k..]);
        let n = t[0].cross(t[1]);
        let area = n.length_squared();
        let product = o[0].cross(o[1]).dot(n) / area;
        let half = 0.5 * (o[0].cross(t[1]) + t[0].cross(o[1])).dot(n) / area;
        half - (half * half - product).max(0.0).sqrt()
    }
}

/// The inverse of a matrix from its columns.
pub(super) fn invert(a: DVec4, b: DVec4, c: DVec4, d: DVec4) -> Option<DMat4> {
    let inverse = DMat4::from_cols(a, b, c, d).inverse();
    inverse.is_finite().then_some(inverse)
}

/// A surface along a curve in its parameter plane: the point and both tangents as series.
struct Along<S: Number> {
    point: Vector<S>,
    tangents: [Vector<S>; 2],
}

/// Composes the Taylor polynomial of a surface with the series of its parameters less their values.
fn compose<S: Number>(jet: &[[S; 3]], [du, dv]: [&Series<S>; 2]) -> Along<S> {
    let order = du.order();
    let zero = || -> Vector<S> { std::array::from_fn(|_| Series::constant(S::ZERO, order)) };
    let mut along = Along {
        point: zero(),
        tangents: [zero(), zero()],
    };
    let add = |to: &mut Vector<S>, power: &Series<S>, d: &[S; 3]| {
        for k in 0..3 {
            to[k] = to[k].add(&power.scale(d[k]));
        }
    };
    // du^i/i! and dv^j/j!, then their products.
    let powers = |d: &Series<S>| {
        let mut all = vec![Series::constant(S::ONE, order)];
        for i in 1..=order {
            all.push(all[i - 1].mul(d).scale(S::ONE / S::from(i as f64)));
        }
        all
    };
    let (pu, pv) = (powers(du), powers(dv));
    for n in 0..=order {
        for j in 0..=n {
            let i = n - j;
            let power = if j == 0 {
                pu[i].clone()
            } else if i == 0 {
                pv[j].clone()
            } else {
                pu[i].mul(&pv[j])
            };
            add(&mut along.point, &power, &jet[jet_index(i, j)]);
            add(&mut along.tangents[0], &power, &jet[jet_index(i + 1, j)]);
            add(&mut along.tangents[1], &power, &jet[jet_index(i, j + 1)]);
        }
    }
    along
}

/// Centre and normal of the ball that touches a surface, along a curve in its parameter plane.
fn offset<S: Number>(along: &Along<S>, side: f64, radius: &Series<S>) -> [Vector<S>; 2] {
    let cross = series_cross(&along.tangents[0], &along.tangents[1]);
    let length = series_norm2(&cross).sqrt();
    let normal = cross.map(|x| x.div(&length).scale(S::from(side)));
    [sum(&along.point, &times(&normal, radius)), normal]
}

/// The surfaces' jets at a place, the points measured from the origin.
pub(super) struct Expansion<S: Number> {
    jets: [Vec<[S; 3]>; 2],
    sides: [f64; 2],
}

impl<S: Evaluated> Expansion<S> {
    /// The ball as a series in the parameter of a path, from the series of both contacts' parameters: from the first
    /// surface, and its centre from the second.
    fn ball(&self, x: &Place<Series<S>>, radius: &Series<S>) -> (Ball<S>, Vector<S>) {
        let order = x[0].order();
        let away = x.each_ref().map(|s| {
            let mut s = s.clone();
            s.c[0] = S::ZERO;
            s
        });
        let radius = Series {
            c: radius.c[..=order].into(),
        };
        let [[centre, n0], [other, n2]] = [0, 1].map(|k| {
            let along = compose(&self.jets[k], [&away[2 * k], &away[2 * k + 1]]);
            offset(&along, self.sides[k], &radius)
        });
        let ball = Ball {
            centre,
            normals: [n0, n2],
            radius,
        };
        (ball, other)
    }

    /// The derivatives of a centre by the parameters of its surface, with the surface's tangents.
    fn columns(&self, k: usize, radius: S) -> [[S; 3]; 2] {
        let radius = Series::constant(radius, 1);
        let (still, moving) = (Series::constant(S::ZERO, 1), Series::variable(S::ZERO, 1));
        [[&moving, &still], [&still, &moving]].map(|d| {
            let [centre, _] = offset(&compose(&self.jets[k], d), self.sides[k], &radius);
            centre.map(|x| x.c[1])
        })
    }

    /// The contacts.
    pub(super) fn points(&self) -> [[S; 3]; 2] {
        [0, 1].map(|k| self.jets[k][0])
    }

    /// What is left of a surface's curvature beside the ball's: the product and the half sum of `1 - r κ` over the
    /// principal curvatures. Both are positive where the ball fits.
    pub(super) fn fit(&self, k: usize, radius: S) -> [S; 2] {
        let [ou, ov] = self.columns(k, radius);
        let (su, sv) = (self.jets[k][1], self.jets[k][2]);
        let n = cross(su, sv);
        let area = dot(n, n);
        let (a, b) = (cross(ou, sv), cross(su, ov));
        let trace = dot(a, n) + dot(b, n);
        [dot(cross(ou, ov), n) / area, trace / (area + area)]
    }
}

fn dot<S: Number>(a: [S; 3], b: [S; 3]) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross<S: Number>(a: [S; 3], b: [S; 3]) -> [S; 3] {
    let d = |i: usize, j: usize| a[i] * b[j] - a[j] * b[i];
    [d(1, 2), d(2, 0), d(0, 1)]
}

/// The guide's point and the radius as series of the same parameter, the guide with one order more.
pub(super) struct Course<S: Number> {
    pub guide: Vector<S>,
    pub radius: Series<S>,
}

impl<S: Number> Course<S> {
    fn direction(&self) -> Vector<S> {
        self.guide.each_ref().map(Series::derivative)
    }

    /// `(c - g)·g'`.
    fn plane(&self, centre: &Vector<S>) -> Series<S> {
        let away: Vector<S> = std::array::from_fn(|k| centre[k].sub(&self.guide[k]));
        series_dot(&away, &self.direction())
    }
}

impl Supports {
    /// The supports' jets at a place, in the pieces `within`.
    pub(super) fn expand<S: Evaluated>(
        &self,
        x: Place<S>,
        within: Place<Interval>,
        order: usize,
    ) -> Expansion<S> {
        let jets = [0, 1].map(|k| {
            let uv = [x[2 * k], x[2 * k + 1]];
            let piece = [within[2 * k], within[2 * k + 1]];
            let mut jet = S::jet(self.surfaces[k].as_ref(), uv, piece, order);
            for (x, o) in jet[0].iter_mut().zip(self.origin.to_array()) {
                *x = *x - S::from(o);
            }
            jet
        });
        Expansion {
            jets,
            sides: self.sides,
        }
    }

    /// The equations at a place; `None` at poles and where something is not finite.
    pub(super) fn state(
        &self,
        x: Place<f64>,
        within: Place<Interval>,
        radius: f64,
    ) -> Option<State> {
        let e = self.expand(x, within, 2);
        let vector = DVec3::from_array;
        let mut state = State {
            centres: [DVec3::ZERO; 2],
            normals: [DVec3::ZERO; 2],
            columns: [DVec3::ZERO; 4],
            tangents: [DVec3::ZERO; 4],
        };
        for k in 0..2 {
            let jet = &e.jets[k];
            let [p, su, sv] = [0, 1, 2].map(|i| vector(jet[i]));
            let n = su.cross(sv);
            let length = n.length();
            let unit = n / length;
            let turned = |nu: DVec3| (nu - unit * unit.dot(nu)) * (self.sides[k] * radius / length);
            let [suu, suv, svv] = [3, 4, 5].map(|i| vector(jet[i]));
            state.centres[k] = p + unit * (self.sides[k] * radius);
            state.normals[k] = unit * self.sides[k];
            state.columns[2 * k] = su + turned(suu.cross(sv) + su.cross(suv));
            state.columns[2 * k + 1] = sv + turned(suv.cross(sv) + su.cross(svv));
            state.tangents[2 * k] = su;
            state.tangents[2 * k + 1] = sv;
        }
        let all = state.columns.iter().chain(&state.centres);
        all.copied().all(DVec3::is_finite).then_some(state)
    }

    /// The parameter ranges of both surfaces.
    pub(super) fn domain(&self) -> Place<Interval> {
        let [a, b] = self.surfaces.each_ref().map(|s| s.domain());
        [a[0], a[1], b[0], b[1]]
    }

    /// The pieces that hold a place, on the side to which a direction leads from a break.
    pub(super) fn pieces(&self, x: Place<f64>, towards: Place<f64>) -> Place<Interval> {
        std::array::from_fn(|j| {
            let breaks = self.breaks(j);
            let near = |b: f64| (x[j] - b).abs() <= AT_BREAK * breaks.domain().width();
            match breaks.iter().position(|b| near(b.at)) {
                Some(b) if b + 1 < breaks.len() && (b == 0 || towards[j] > 0.0) => breaks.piece(b),
                Some(b) => breaks.piece(b - 1),
                None => breaks.piece(breaks.find(x[j], Limit::Above)),
            }
        })
    }

    /// The breaks of one parameter.
    pub(super) fn breaks(&self, j: usize) -> &[crate::breaks::Break] {
        self.surfaces[j / 2].breaks([Dir::U, Dir::V][j % 2])
    }

    /// The series of the contacts' parameters to an order, over the places `x` in the pieces `within`: the derivatives of
    /// the equations' solution. `inverse` is about the inverse of the equations' derivatives.
    pub(super) fn series<S: Evaluated>(
        &self,
        e: &Expansion<S>,
        x: Place<S>,
        course: &Course<S>,
        inverse: &DMat4,
        order: usize,
    ) -> Place<Series<S>> {
        let mut series = x.map(|x| Series::constant(x, order));
        if order == 0 {
            return series;
        }
        let matrix = self.preconditioned(e, course, inverse);
        for k in 1..=order {
            let known = series.each_ref().map(|s| Series {
                c: s.c[..=k].into(),
            });
            let (ball, other) = e.ball(&known, &course.radius);
            let right: Place<S> = std::array::from_fn(|i| match i {
                3 => -course.plane(&ball.centre).c[k],
                i => -(ball.centre[i].c[k] - other[i].c[k]),
            });
            let next = eliminate(matrix, apply(inverse, right));
            (0..4).for_each(|j| series[j].c[k] = next[j]);
        }
        series
    }

    /// The derivatives of the equations multiplied by about their inverse.
    pub(super) fn preconditioned<S: Evaluated>(
        &self,
        e: &Expansion<S>,
        course: &Course<S>,
        inverse: &DMat4,
    ) -> [[S; 4]; 4] {
        let [a, b] = [0, 1].map(|k| e.columns(k, course.radius.value()));
        let direction = course.direction().map(|x| x.value());
        let column = |j: usize| -> [S; 4] {
            let c = if j < 2 { a[j] } else { b[j - 2].map(|x| -x) };
            let last = if j < 2 { dot(c, direction) } else { S::ZERO };
            apply(inverse, [c[0], c[1], c[2], last])
        };
        let columns = [column(0), column(1), column(2), column(3)];
        std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]))
    }

    /// The ball from the series of its contacts, to their order.
    pub(super) fn ball<S: Evaluated>(
        e: &Expansion<S>,
        x: &Place<Series<S>>,
        radius: &Series<S>,
    ) -> Ball<S> {
        e.ball(x, radius).0
    }

    /// The four equations at a place, multiplied by about the inverse of their derivatives.
    pub(super) fn residual<S: Evaluated>(
        &self,
        e: &Expansion<S>,
        course: &Course<S>,
        inverse: &DMat4,
    ) -> Place<S> {
        let x = [S::ZERO; 4].map(|x| Series::constant(x, 0));
        let (ball, other) = e.ball(&x, &course.radius);
        let gap = |i: usize| ball.centre[i].value() - other[i].value();
        let value = [gap(0), gap(1), gap(2), course.plane(&ball.centre).value()];
        apply(inverse, value)
    }
}

/// Relative to the width of a domain: a parameter so near to a break is on it.
pub(super) const AT_BREAK: f64 = 1e-12;

fn apply<S: Number>(m: &DMat4, x: [S; 4]) -> [S; 4] {
    let columns = m.to_cols_array_2d();
    std::array::from_fn(|i| (0..4).fold(S::ZERO, |acc, j| acc + S::from(columns[j][i]) * x[j]))
}

/// Solves equations whose matrix is near the unit matrix, without exchange of rows.
fn eliminate<S: Number>(mut a: [[S; 4]; 4], mut b: [S; 4]) -> [S; 4] {
    for k in 0..4 {
        for i in k + 1..4 {
            let f = a[i][k] / a[k][k];
            for j in k + 1..4 {
                a[i][j] = a[i][j] - f * a[k][j];
            }
            b[i] = b[i] - f * b[k];
        }
    }
    for i in (0..4).rev() {
        let sum = (i + 1..4).fold(b[i], |x, j| x - a[i][j] * b[j]);
        b[i] = sum / a[i][i];
    }
    b
}
