//! Figures of a surface, enclosed with their derivatives to order 2: what curves of constant figure are traced with.

use super::shape::{Shape, ShapeForm, beside, shapes};
use super::taylor::{Patch, Taylor};
use crate::box3::Box3;
use crate::breaks::Limit;
use crate::interval::Interval;
use crate::surface::{Surface, jet_len};
use glam::DVec3;

/// Enclosures of `f, f_u, f_v, f_uu, f_uv, f_vv`.
pub(crate) type FigureJet = [Interval; 6];

/// Nothing is known.
const UNKNOWN: FigureJet = [Interval::ENTIRE; 6];

/// A curvature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CurvatureKind {
    /// The mean of the principal curvatures.
    Mean,
    /// The product of the principal curvatures.
    Gaussian,
    /// The larger principal curvature.
    K1,
    /// The smaller principal curvature.
    K2,
}

/// The derivatives in the coefficients of a Taylor polynomial of degree 2 or more.
fn jet(t: &Taylor) -> FigureJet {
    let two = Interval::point(2.0);
    [t.c[0], t.c[1], t.c[2], two * t.c[3], t.c[4], two * t.c[5]]
}

fn constant(v: DVec3) -> [Interval; 3] {
    v.to_array().map(Interval::point)
}

/// `a · v`.
fn along(a: &[Taylor; 3], v: DVec3) -> Taylor {
    let [x, y, z] = constant(v);
    a[0].scale(x).add(&a[1].scale(y)).add(&a[2].scale(z))
}

/// A curvature over a box in one analytic piece of a surface of the given size.
pub(crate) fn curvature_over(
    surface: &dyn Surface,
    uv: [Interval; 2],
    poles: &[Pole],
    size: f64,
    kind: CurvatureKind,
) -> FigureJet {
    if poles.iter().all(|p| !uv[p.d].contains(p.at)) {
        return jet(&curvature(surface, uv, kind, LOW)[0]);
    }
    let Ok(form) = ShapeForm::new(surface, uv, size, AT_POLES) else {
        return UNKNOWN;
    };
    let [wide, at] = [&form.wide, &form.at].map(|s| of_shape(s, kind));
    let t = if at.is_finite() {
        wide.tightened(&at, form.offset)
    } else {
        wide
    };
    let mut j = jet(&t);
    if form.exchanged {
        j.swap(1, 2);
        j.swap(3, 5);
    }
    j
}

/// The range of the same alone, for boxes that are narrow in one direction.
pub(crate) fn curvature_range(
    surface: &dyn Surface,
    uv: [Interval; 2],
    poles: &[Pole],
    size: f64,
    kind: CurvatureKind,
) -> Interval {
    if poles.iter().any(|p| uv[p.d].contains(p.at)) {
        return curvature_over(surface, uv, poles, size, kind)[0];
    }
    curvature(surface, uv, kind, HIGH)[0].c[0]
}

/// The Taylor polynomials of a curvature over a box and in its middle.
fn curvature(
    surface: &dyn Surface,
    uv: [Interval; 2],
    kind: CurvatureKind,
    degree: usize,
) -> [Taylor; 2] {
    let patch = Patch::new(surface, uv, degree + 2);
    let offset = patch.offset;
    let [wide, at] = [&patch.wide, &patch.at].map(|jet| beside(jet, false, degree));
    let [wide, at] = shapes(wide, at, offset);
    let [wide, at] = [of_shape(&wide, kind), of_shape(&at, kind)];
    [wide.tightened(&at, offset), at]
}

fn of_shape(f: &Shape, kind: CurvatureKind) -> Taylor {
    let half = Interval::point(0.5);
    let mean = f.p.add(&f.s).scale(half);
    match kind {
        CurvatureKind::Mean => mean,
        CurvatureKind::Gaussian => f.p.mul(&f.s).sub(&f.q.sqr()),
        CurvatureKind::K1 | CurvatureKind::K2 => {
            let off = f.p.sub(&f.s).scale(half);
            let radius = off.sqr().add(&f.q.sqr()).sqrt();
            if kind == CurvatureKind::K1 {
                mean.add(&radius)
            } else {
                mean.sub(&radius)
            }
        }
    }
}

/// `n · (r - p)` over a box in one analytic piece.
pub(crate) fn height_over(
    surface: &dyn Surface,
    uv: [Interval; 2],
    p: DVec3,
    n: DVec3,
) -> FigureJet {
    jet(&height(surface, uv, p, n, 2))
}

/// The range of the same alone, for boxes that are narrow in one direction.
pub(crate) fn height_range(
    surface: &dyn Surface,
    uv: [Interval; 2],
    p: DVec3,
    n: DVec3,
) -> Interval {
    range(uv, |uv| Some(height(surface, uv, p, n, HIGH)))
}

fn height(surface: &dyn Surface, uv: [Interval; 2], p: DVec3, n: DVec3, degree: usize) -> Taylor {
    let mut over = vec![Box3::ENTIRE; jet_len(degree)];
    surface.enclose_piece(uv, [Limit::Above; 2], degree, &mut over);
    over[0] = over[0] - Box3::point(p);
    along(&Taylor::vector(&over, [0, 0], degree), n)
}

/// A surface by an equation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Implicit {
    /// A sphere.
    Sphere {
        /// The centre.
        center: DVec3,
        /// The radius.
        radius: f64,
    },
    /// A round cylinder without ends.
    Cylinder {
        /// A point of the axis.
        point: DVec3,
        /// The direction of the axis.
        axis: DVec3,
        /// The radius.
        radius: f64,
    },
    /// A round cone, both halves, without ends.
    Cone {
        /// The apex.
        apex: DVec3,
        /// The direction of the axis.
        axis: DVec3,
        /// The angle between axis and cone, radians, between 0 and π/2.
        half_angle: f64,
    },
    /// A torus.
    Torus {
        /// The centre.
        center: DVec3,
        /// The direction of the axis.
        axis: DVec3,
        /// The radius of the circle round the axis.
        major: f64,
        /// The radius of the tube.
        minor: f64,
    },
}

/// The left side of an equation, zero on the surface it describes, over a box in one analytic piece of another surface. The axis
/// is a unit vector.
pub(crate) fn implicit_over(
    surface: &dyn Surface,
    uv: [Interval; 2],
    other: Implicit,
) -> FigureJet {
    jet(&equation(surface, uv, other, 2))
}

/// The range of the same alone, for boxes that are narrow in one direction.
pub(crate) fn implicit_range(
    surface: &dyn Surface,
    uv: [Interval; 2],
    other: Implicit,
) -> Interval {
    range(uv, |uv| Some(equation(surface, uv, other, HIGH)))
}

fn equation(surface: &dyn Surface, uv: [Interval; 2], other: Implicit, degree: usize) -> Taylor {
    let (Implicit::Sphere { center: from, .. }
    | Implicit::Cylinder { point: from, .. }
    | Implicit::Cone { apex: from, .. }
    | Implicit::Torus { center: from, .. }) = other;
    let mut over = vec![Box3::ENTIRE; jet_len(degree)];
    surface.enclose_piece(uv, [Limit::Above; 2], degree, &mut over);
    over[0] = over[0] - Box3::point(from);
    let way = Taylor::vector(&over, [0, 0], degree);
    let square = Taylor::square(&way);
    // The squares of the ways along and off an axis, times the square of its length, which is 1 but for rounding. As a
    // difference the latter would lose all digits far along the axis.
    let sideways = |a: DVec3| {
        let [x, y, z] = constant(a);
        let cross =
            |i: usize, j: usize, a: Interval, b: Interval| way[i].scale(b).sub(&way[j].scale(a));
        Taylor::square(&[cross(1, 2, y, z), cross(2, 0, z, x), cross(0, 1, x, y)])
    };
    let length2 = |a: DVec3| {
        let [x, y, z] = constant(a).map(Interval::sqr);
        x + y + z
    };
    let off = |a: DVec3| sideways(a).scale(Interval::ONE / length2(a));
    let less = |t: Taylor, x: Interval| {
        let mut t = t;
        t.c[0] = t.c[0] - x;
        t
    };
    let sqr = |x: f64| Interval::point(x).sqr();
    match other {
        Implicit::Sphere { radius, .. } => less(square, sqr(radius)),
        Implicit::Cylinder { axis, radius, .. } => less(off(axis), sqr(radius)),
        Implicit::Cone {
            axis, half_angle, ..
        } => {
            let angle = Interval::point(half_angle);
            let [sine, cosine] = [angle.sin().sqr(), angle.cos().sqr()];
            let ahead = along(&way, axis).sqr().scale(sine);
            ahead.sub(&sideways(axis).scale(cosine))
        }
        Implicit::Torus {
            axis, major, minor, ..
        } => {
            let sum = less(square, sqr(minor) - sqr(major));
            let turned = off(axis).scale(Interval::point(4.0) * sqr(major));
            sum.sqr().sub(&turned)
        }
    }
}

/// The degree for curvatures elsewhere.
const LOW: usize = 3;
/// The same beside poles, where two degrees are lost.
const AT_POLES: usize = 6;
/// The degree of Taylor polynomials where f is to be told from zero by very little: along a border it is zero on.
const HIGH: usize = 7;

/// The range of a Taylor polynomial over a box.
fn range(uv: [Interval; 2], f: impl Fn([Interval; 2]) -> Option<Taylor>) -> Interval {
    let middle = uv.map(|t| Interval::point(t.mid()));
    let offset = [0, 1].map(|d| uv[d] - middle[d]);
    match (f(uv), f(middle)) {
        (Some(wide), Some(at)) => wide.range(&at, offset),
        _ => Interval::ENTIRE,
    }
}

/// A side that is one point: the parameter that is constant along it, its value, and whether it is the upper end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Pole {
    pub(crate) d: usize,
    pub(crate) at: f64,
    pub(crate) upper: bool,
}

/// Places along a side where it is seen whether it is a point.
const PLACES: usize = 17;

/// The sides of a surface that are one point, within rounding.
pub(crate) fn poles(surface: &dyn Surface, size: f64) -> Vec<Pole> {
    let domain = surface.domain();
    let mut poles = Vec::new();
    for d in 0..2 {
        for (at, upper) in [(domain[d].lo, false), (domain[d].hi, true)] {
            let mut limit = [Limit::Above; 2];
            if upper {
                limit[d] = Limit::Below;
            }
            let other = domain[1 - d];
            let point = (0..PLACES).all(|k| {
                let t = other.lo + (other.hi - other.lo) * (k as f64 + 0.5) / PLACES as f64;
                let p = if d == 0 { [at, t] } else { [t, at] };
                let tangent = surface.jet(p, limit, 1).d[2 - d];
                tangent.length() * other.width() <= super::shape::POINT * size
            });
            if point {
                poles.push(Pole { d, at, upper });
            }
        }
    }
    poles
}

/// What is asked of the normal `n = r_u × r_v`, of any length.
#[derive(Clone, Copy, Debug)]
pub(crate) enum NormalFigure {
    /// `n · d`.
    Along(DVec3),
    /// `n · (r - eye)`.
    Towards(DVec3),
    /// `n · d - c |n|` for a unit vector d.
    Angle(DVec3, f64),
}

/// A figure of the normal over a box in one analytic piece. The normal is divided by the distances to the poles in
/// parameters: the figure keeps its zeros and its sign, and does not vanish in the poles for their sake.
pub(crate) fn normal_over(
    surface: &dyn Surface,
    uv: [Interval; 2],
    poles: &[Pole],
    figure: NormalFigure,
) -> FigureJet {
    normal_taylor(surface, uv, poles, figure, 2).map_or(UNKNOWN, |t| jet(&t))
}

/// The range of the same alone, for boxes that are narrow in one direction.
pub(crate) fn normal_range(
    surface: &dyn Surface,
    uv: [Interval; 2],
    poles: &[Pole],
    figure: NormalFigure,
) -> Interval {
    range(uv, |uv| normal_taylor(surface, uv, poles, figure, HIGH))
}

/// `None` for a box at two poles.
fn normal_taylor(
    surface: &dyn Surface,
    uv: [Interval; 2],
    poles: &[Pole],
    figure: NormalFigure,
    degree: usize,
) -> Option<Taylor> {
    let touched: Vec<&Pole> = poles.iter().filter(|p| uv[p.d].contains(p.at)).collect();
    if touched.len() > 1 {
        return None;
    }
    let order = degree + 1 + touched.len();
    let mut jet_over = vec![Box3::ENTIRE; jet_len(order)];
    surface.enclose_piece(uv, [Limit::Above; 2], order, &mut jet_over);
    let vector = |d: [usize; 2], n: usize| Taylor::vector(&jet_over, d, n);
    let mut tangents = [vector([1, 0], degree), vector([0, 1], degree)];
    for pole in touched {
        // Along the side the other parameter runs: its tangent has the factor.
        let other = 1 - pole.d;
        let whole = vector([1 - other, other], degree + 1);
        let sign = Interval::point(if pole.upper { -1.0 } else { 1.0 });
        tangents[other] = [0, 1, 2].map(|k| whole[k].divided_along(pole.d).scale(sign));
    }
    let mut normal = Taylor::cross(&tangents[0], &tangents[1]);
    for pole in poles.iter().filter(|p| !uv[p.d].contains(p.at)) {
        let away = if pole.upper {
            Interval::point(pole.at) - uv[pole.d]
        } else {
            uv[pole.d] - Interval::point(pole.at)
        };
        let sign = if pole.upper { -1.0 } else { 1.0 };
        let mut factor = normal[0].scale(Interval::ZERO);
        factor.c[0] = away;
        factor.c[1 + pole.d] = Interval::point(sign);
        normal = normal.map(|t| t.div(&factor));
    }
    let figure = match figure {
        NormalFigure::Along(d) => along(&normal, d),
        NormalFigure::Towards(eye) => {
            let mut way = vector([0, 0], degree);
            for (w, e) in way.iter_mut().zip(constant(eye)) {
                w.c[0] = w.c[0] - e;
            }
            Taylor::dot(&normal, &way)
        }
        NormalFigure::Angle(d, cosine) => {
            let length = Taylor::square(&normal).sqrt();
            along(&normal, d).sub(&length.scale(Interval::point(cosine)))
        }
    };
    Some(figure)
}
