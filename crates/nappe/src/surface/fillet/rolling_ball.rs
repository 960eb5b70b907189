//! The sections of a fillet: circular arcs in which a rolling ball touches the surface it leaves behind.
//!
//! A ball with centre c(u) and radius r(u) touches two supports where the unit normals n0(u), n2(u) point to its centre:
//! the contacts are `p = c - r n`. The balls' envelope touches each ball in its characteristic circle, in the plane
//! `(x - c)·c' = -r r'`, with centre `m = c - (r r'/|c'|²) c'` and radius `ρ = r √(1 - r'²/|c'|²)`. Both contacts lie on
//! it (differentiate the contact condition). The section is its arc from p0 to p2, with `a_i = p_i - m`:
//! apex `p1 = m + (a0 + a2) ρ²/(ρ² + a0·a2)`, weight `w = cos(α/2) = √((ρ² + a0·a2)/(2ρ²))`.

use crate::basis::{Functions, FunctionsRef, Value};
use crate::breaks::{Break, Breaks, Limit, UNIT_BREAKS};
use crate::frame::Frame;
use crate::interval::Interval;
use crate::scalar::{Number, Pack};
use crate::series::{Series, series_dot, series_norm2};
use crate::surface::Elementary;
use glam::{DVec2, DVec3};
use smallvec::SmallVec;

/// The radius of a fillet.
#[derive(Clone, Debug)]
pub enum Radius {
    /// The same everywhere.
    Constant(f64),
    /// One function of the fillet's parameter u on `[0, 1]`.
    Along(FunctionsRef),
}

impl Radius {
    /// The radius' series at a parameter, or at those of a pack.
    pub(super) fn series_at<S: Value>(&self, u: S, limit: Limit, order: usize) -> Series<S> {
        match self {
            Radius::Constant(r) => Series::constant(S::from(*r), order),
            Radius::Along(f) => {
                let mut d: SmallVec<[S; 8]> = SmallVec::from_elem(S::ZERO, order + 1);
                S::jet(f.as_ref(), u, limit, order, &mut d);
                Series::from_derivatives(&d)
            }
        }
    }

    /// The same over an interval of parameters in one piece.
    pub(super) fn series_over(&self, u: Interval, limit: Limit, order: usize) -> Series<Interval> {
        match self {
            Radius::Constant(r) => Series::constant(Interval::point(*r), order),
            Radius::Along(f) => {
                let mut d: SmallVec<[Interval; 8]> =
                    SmallVec::from_elem(Interval::ENTIRE, order + 1);
                f.enclose_piece(u, limit, order, &mut d);
                Series::from_derivatives(&d)
            }
        }
    }
}

/// The two supports, seen from an origin, and how the ball's centre moves along them.
#[derive(Clone, Debug)]
pub(super) enum Track {
    /// Two planes through the origin's edge line: `c = s d + r q` with `q·n0 = q·n2 = 1`.
    Planes { n: [DVec3; 2], d: DVec3, q: DVec3 },
    /// A plane (its normal n, the axis' origin at height h over it) and a cylinder that pierces it. The ball is at the
    /// angle s about the axis, at `R + σ r` from it.
    Turning(Cylinder),
    /// A plane and a cylinder with an axis parallel to it. The ball is at the length s along the axis.
    Along { cylinder: Cylinder, branch: f64 },
    /// Two surfaces of revolution about one axis, the z of a frame: the ball is at the angle s about it, in the plane z = 0,
    /// on a ring of the given radius. The normals are constant in the half-plane through the axis: outwards, and along z.
    Ring {
        frame: Frame,
        ring: f64,
        normals: [DVec2; 2],
    },
}

#[derive(Clone, Debug)]
pub(super) struct Cylinder {
    /// The axis is z; its origin is the origin of coordinates here.
    pub frame: Frame,
    pub radius: f64,
    /// +1 if the ball is outside, -1 inside.
    pub side: f64,
    /// The plane's normal, towards the ball, and the height of the axis' origin over the plane.
    pub normal: DVec3,
    pub height: f64,
}

/// The eleven functions `p0 (3), w p1 (3), p2 (3), 1, w` of u on `[0, 1]`.
#[derive(Clone, Debug)]
pub(super) struct RollingBall {
    pub track: Track,
    pub radius: Radius,
    /// The value of s at u = 0 and at u = 1.
    pub range: [f64; 2],
    /// The second support comes first.
    pub swapped: bool,
    pub breaks: Vec<Break>,
}

pub(super) type Vector<S> = [Series<S>; 3];

/// Centre, normals and radius as series of the same order.
pub(super) struct Ball<S: Number> {
    pub centre: Vector<S>,
    pub normals: [Vector<S>; 2],
    pub radius: Series<S>,
}

fn constant<S: Number>(v: DVec3, order: usize) -> Vector<S> {
    v.to_array().map(|x| Series::constant(S::from(x), order))
}

fn along<S: Number>(d: DVec3, s: &Series<S>) -> Vector<S> {
    d.to_array().map(|x| s.scale(S::from(x)))
}

pub(super) fn sum<S: Number>(a: &Vector<S>, b: &Vector<S>) -> Vector<S> {
    std::array::from_fn(|k| a[k].add(&b[k]))
}

pub(super) fn times<S: Number>(a: &Vector<S>, s: &Series<S>) -> Vector<S> {
    std::array::from_fn(|k| a[k].mul(s))
}

impl RollingBall {
    /// With a radius, the breaks are the radius' own; its derivative enters the sections, so one order of smoothness
    /// is lost.
    pub(super) fn new(track: Track, radius: Radius, range: [f64; 2], swapped: bool) -> Self {
        let breaks = match &radius {
            Radius::Constant(_) => UNIT_BREAKS.to_vec(),
            Radius::Along(f) => f
                .breaks()
                .iter()
                .map(|b| Break::new(b.at, b.smooth - 1))
                .collect(),
        };
        Self {
            track,
            radius,
            range,
            swapped,
            breaks,
        }
    }

    /// The ball at a parameter.
    pub(super) fn ball<S: Number>(&self, u: S, radius: Series<S>) -> Ball<S> {
        let order = radius.order();
        let [from, to] = self.range.map(S::from);
        let s = Series::variable(u, order)
            .scale(to - from)
            .add(&Series::constant(from, order));
        let (centre, mut normals) = match &self.track {
            Track::Planes { n, d, q } => (
                sum(&along(*d, &s), &along(*q, &radius)),
                [constant(n[0], order), constant(n[1], order)],
            ),
            Track::Turning(c) => {
                let (sin, cos) = s.sin_cos();
                let outwards = sum(&along(c.frame.x(), &cos), &along(c.frame.y(), &sin));
                let rho = distance(c, &radius);
                let n: Vector<S> = constant(c.normal, order);
                // (centre - plane)·n = r gives the height along the axis.
                let height = Series::constant(S::from(c.height), order);
                let rise = radius
                    .sub(&height)
                    .sub(&rho.mul(&series_dot(&outwards, &n)))
                    .scale(S::ONE / S::from(c.frame.z().dot(c.normal)));
                (
                    sum(&times(&outwards, &rho), &along(c.frame.z(), &rise)),
                    [n, outwards.map(|x| x.scale(S::from(c.side)))],
                )
            }
            Track::Along {
                cylinder: c,
                branch,
            } => {
                let rho = distance(c, &radius);
                let y = radius.sub(&Series::constant(S::from(c.height), order));
                let x = rho.sqr().sub(&y.sqr()).sqrt().scale(S::from(*branch));
                let across = c.frame.z().cross(c.normal);
                let aside = sum(&along(across, &x), &along(c.normal, &y));
                let inverse = Series::constant(S::from(c.side), order).div(&rho);
                (
                    sum(&aside, &along(c.frame.z(), &s)),
                    [constant(c.normal, order), times(&aside, &inverse)],
                )
            }
            Track::Ring {
                frame,
                ring,
                normals,
            } => {
                let (sin, cos) = s.sin_cos();
                let outwards = sum(&along(frame.x(), &cos), &along(frame.y(), &sin));
                let scaled = |f: f64| outwards.each_ref().map(|x| x.scale(S::from(f)));
                let normal = |n: DVec2| sum(&scaled(n.x), &constant(frame.z() * n.y, order));
                (scaled(*ring), normals.map(normal))
            }
        };
        if self.swapped {
            normals.swap(0, 1);
        }
        Ball {
            centre,
            normals,
            radius,
        }
    }

    /// The radius at a parameter.
    pub(super) fn radius_value(&self, u: f64) -> f64 {
        self.radius.series_at(u, Limit::Above, 0).value()
    }

    /// The ball's centre and radius at a parameter.
    pub(super) fn centre(&self, u: f64) -> (DVec3, f64) {
        let ball = self.ball(u, self.radius.series_at(u, Limit::Above, 0));
        (
            DVec3::from_array(ball.centre.each_ref().map(Series::value)),
            ball.radius.value(),
        )
    }

    /// The torus or cylinder that a constant radius sweeps, with its normals to the ball. `origin` is what the track is
    /// measured from.
    pub(super) fn elementary(&self, origin: DVec3) -> Option<Elementary> {
        let Radius::Constant(radius) = self.radius else {
            return None;
        };
        match &self.track {
            Track::Planes { d, q, .. } => Some(Elementary::Cylinder {
                axis: Frame::along(origin + *q * radius, *d).ok()?,
                radius,
                outward: false,
            }),
            Track::Ring { frame, ring, .. } => Some(Elementary::Torus {
                axis: *frame,
                major: *ring,
                minor: radius,
                outward: false,
            }),
            Track::Turning(_) | Track::Along { .. } => None,
        }
    }

    /// The eleven values at a parameter.
    pub(super) fn values(&self, u: f64) -> [f64; COUNT] {
        let mut out = [0.0; COUNT];
        self.jet_into(u, Limit::Above, 0, &mut out);
        out
    }

    fn write<S: Number>(&self, u: S, radius: Series<S>, order: usize, out: &mut [S]) {
        write_sections(&self.ball(u, radius), order, out);
    }

    /// Quantities that are positive where the fillet is a regular surface: the radius; what the track needs under its
    /// root; and those of [`regular`].
    pub(super) fn margins(&self, u: Interval, limit: Limit) -> [Interval; MARGINS] {
        let radius = self.radius.series_over(u, limit, 2);
        let positive = radius.value();
        let root = match &self.track {
            Track::Planes { .. } | Track::Ring { .. } => Interval::ONE,
            Track::Turning(c) => distance(c, &radius).value(),
            Track::Along { cylinder, .. } => {
                let rho = distance(cylinder, &radius).value();
                let y = positive - Interval::point(cylinder.height);
                // ρ² - y² = (ρ - y)(ρ + y), both factors positive.
                (rho - y).min(rho + y)
            }
        };
        if positive.lo <= 0.0 || root.lo <= 0.0 {
            return [positive, root, Interval::ENTIRE, Interval::ENTIRE];
        }
        let [apart, least] = regular(&self.ball(u, radius));
        [positive, root, apart, least]
    }
}

/// Quantities that are positive where the sections make a regular surface, from the ball to order 2: `|c'|² - r'²`
/// (neighbouring balls do not swallow each other), and a lower bound of `|c'|² - r'² - r r'' - (x - c)·c''` over the points x
/// of the section (sections do not cross).
pub(super) fn regular(ball: &Ball<Interval>) -> [Interval; 2] {
    let [c1, c2] = [1, 2].map(|k| ball.centre.each_ref().map(|x| x.c[k]));
    let c2 = c2.map(|x| x + x);
    let r: Vec<Interval> = ball.radius.c.to_vec();
    let apart = c1[0].sqr() + c1[1].sqr() + c1[2].sqr() - r[1].sqr();
    if apart.lo <= 0.0 {
        return [apart, Interval::ENTIRE];
    }
    let base = apart - r[0] * (r[2] + r[2]);
    let [p0, apex, p2, weight] = {
        let s = sections(ball);
        let at = |k: usize| [s[k].value(), s[k + 1].value(), s[k + 2].value()];
        [at(0), at(3), at(6), [s[10].value(); 3]]
    };
    let weight = weight[0];
    // The quantity is linear in x: along the arc a rational polynomial of degree 2, with these Bernstein coefficients.
    let value = |p: [Interval; 3], w: Interval| -> [Interval; 2] {
        let away = |k: usize| (p[k] - ball.centre[k].value() * w) * c2[k];
        [base * w - (away(0) + away(1) + away(2)), w]
    };
    let one = Interval::ONE;
    let mut arcs = vec![[value(p0, one), value(apex, weight), value(p2, one)]];
    let half =
        |a: [Interval; 2], b: [Interval; 2]| [0, 1].map(|k| (a[k] + b[k]) * Interval::point(0.5));
    // Over an eighth of an arc the hull of the coefficients is hardly wider than the values.
    for _ in 0..3 {
        arcs = arcs
            .into_iter()
            .flat_map(|[a, b, c]| {
                let (ab, bc) = (half(a, b), half(b, c));
                let m = half(ab, bc);
                [[a, ab, m], [m, bc, c]]
            })
            .collect();
    }
    let least = arcs
        .into_iter()
        .flatten()
        .map(|[f, w]| f / w)
        .reduce(Interval::min);
    [apart, least.unwrap_or(Interval::ENTIRE)]
}

/// How many conditions [`RollingBall::margins`] has.
pub(super) const MARGINS: usize = 4;
/// How many functions describe a section.
pub(super) const COUNT: usize = 11;

/// The distance of the ball's centre from the cylinder's axis.
fn distance<S: Number>(c: &Cylinder, radius: &Series<S>) -> Series<S> {
    radius
        .scale(S::from(c.side))
        .add(&Series::constant(S::from(c.radius), radius.order()))
}

/// The functions of the sections, one order shorter than the ball's series.
fn sections<S: Number>(ball: &Ball<S>) -> [Series<S>; COUNT] {
    let r = &ball.radius;
    let (c1, r1) = (ball.centre.clone().map(|x| x.derivative()), r.derivative());
    let speed = series_norm2(&c1);
    // From the ball's centre to the circle's, turned round: μ = (r r'/|c'|²) c'.
    let back = times(&c1, &r.mul(&r1).div(&speed));
    let one = Series::constant(S::ONE, r1.order());
    let rho2 = r.sqr().mul(&one.sub(&r1.sqr().div(&speed)));
    let offset = ball.normals.each_ref().map(|n| times(n, &r.neg()));
    let arms = offset.each_ref().map(|o| sum(o, &back));
    let k = rho2.add(&series_dot(&arms[0], &arms[1]));
    let weight = k.div(&rho2.scale(S::from(2.0))).sqrt();
    let reach = rho2.div(&k);
    let apex: Vector<S> = std::array::from_fn(|i| {
        ball.centre[i]
            .sub(&back[i])
            .add(&arms[0][i].add(&arms[1][i]).mul(&reach))
            .mul(&weight)
    });
    let [p0, p2] = offset.each_ref().map(|o| sum(&ball.centre, o));
    let ([a, b, c], [d, e, f], [g, h, i]) = (p0, apex, p2);
    [a, b, c, d, e, f, g, h, i, one, weight]
}

/// The derivatives of the sections' functions, from a ball of one order more.
pub(super) fn write_sections<S: Number>(ball: &Ball<S>, order: usize, out: &mut [S]) {
    let functions = sections(ball);
    let mut row: SmallVec<[S; 8]> = SmallVec::from_elem(S::ZERO, order + 1);
    for (f, series) in functions.iter().enumerate() {
        series.write_derivatives(&mut row);
        for (k, d) in row.iter().enumerate() {
            out[k * COUNT + f] = *d;
        }
    }
}

impl Functions for RollingBall {
    fn count(&self) -> usize {
        COUNT
    }

    fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        self.write(t, self.radius.series_at(t, limit, order + 1), order, out);
    }

    fn pack_into(&self, t: Pack, limit: Limit, order: usize, out: &mut [Pack]) {
        if let Radius::Along(f) = &self.radius
            && t.common(|t| f.active(t, limit)).is_none()
        {
            return t.each_lane(out, |t, out| self.jet_into(t, limit, order, out));
        }
        self.write(t, self.radius.series_at(t, limit, order + 1), order, out);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        self.write(t, self.radius.series_over(t, limit, order + 1), order, out);
    }
}

/// The analytic pieces.
pub(super) fn pieces(breaks: &[Break]) -> Vec<Interval> {
    (0..breaks.pieces()).map(|i| breaks.piece(i)).collect()
}

/// Proves that all margins over some ranges, each in one piece, are positive, or returns which is not, where, and its
/// value there.
pub(super) fn prove<const N: usize>(
    ranges: Vec<Interval>,
    margins: impl Fn(Interval) -> [Interval; N],
) -> Result<(), (usize, f64, f64)> {
    /// Halvings before a margin that cannot be told from zero counts as zero.
    const DEPTH: u32 = 30;
    /// Ranges examined. A ball so large beside its supports that more would be needed drowns in rounding: it is
    /// refused, not computed for minutes.
    const RANGES: usize = 20_000;
    let mut examined = 0;
    for range in ranges {
        let mut stack = vec![(range, 0)];
        while let Some((u, depth)) = stack.pop() {
            let over = margins(u);
            if over.iter().all(|m| m.lo > 0.0) {
                continue;
            }
            examined += 1;
            let last = depth >= DEPTH || examined >= RANGES;
            let at = u.mid();
            let here = margins(Interval::point(at));
            if let Some(k) = here
                .iter()
                .position(|m| m.hi <= 0.0 || (last && m.lo <= 0.0))
            {
                return Err((k, at, here[k].mid()));
            }
            if last {
                let k = over.iter().position(|m| m.lo <= 0.0).unwrap_or(0);
                return Err((k, at, here[k].mid()));
            }
            stack.push((Interval::new(u.lo, at), depth + 1));
            stack.push((Interval::new(at, u.hi), depth + 1));
        }
    }
    Ok(())
}
