//! All points where a curve meets a surface.

use super::chains::touch;
use super::extended::{beyond, margins, surface_over};
use super::solve::{Enclosed, System, solve};
use crate::box3::Box3;
use crate::breaks::Breaks;
use crate::clusters::clusters;
use crate::curve::Curve;
use crate::interval::Interval;
use crate::surface::{Dir, Surface};
use glam::DVec3;

/// The smallest box relative to the ranges of the parameters; see `meet`.
const SMALLEST: f64 = 1.0 / (1u64 << 20) as f64;

/// A point where a curve goes through a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurveSurfacePoint {
    /// The parameter of the curve.
    pub t: f64,
    /// The parameters of the surface.
    pub uv: [f64; 2],
    /// The point.
    pub point: DVec3,
    /// t, u and v are proven to be in here.
    pub zero: [Interval; 3],
    /// It is proven to be the only one in here, and the curve not to lie in the tangent plane.
    pub alone: [Interval; 3],
}

/// All points where a curve meets a surface.
#[derive(Clone, Debug, Default)]
pub struct CurveSurface {
    /// The proven points, by growing t. A point on a seam of the surface, where two sides of its parameters are one curve,
    /// is found on both.
    pub points: Vec<CurveSurfacePoint>,
    /// Boxes of t, u and v in which it is not decided whether there are points, and how many: the curve touches the surface,
    /// lies in it, meets it in a pole, or may do so
    /// where one of them jumps.
    pub undecided: Vec<[Interval; 3]>,
    /// How many boxes were looked at.
    pub boxes: usize,
}

struct Difference<'a> {
    curve: &'a dyn Curve,
    surface: &'a dyn Surface,
    /// Where the curve jumps, and the surface along u and along v.
    jumps: [Vec<f64>; 3],
}

impl System<3> for Difference<'_> {
    fn enclose(&self, x: &[Interval; 3]) -> Option<Enclosed<3>> {
        let c = self.curve_over(x[0])?;
        let s = surface_over(self.surface, self.surface.domain(), [x[1], x[2]]);
        let value = (s[0] - c[0]).to_array();
        // Over a jump the derivatives of its two sides say nothing.
        let jumps = |k: usize| self.jumps[k].iter().any(|&at| x[k].lo < at && at < x[k].hi);
        let [t, u, v] = if (0..3).any(jumps) {
            [[Interval::ENTIRE; 3]; 3]
        } else {
            [c[1], s[1], s[2]].map(Box3::to_array)
        };
        Some(Enclosed {
            value,
            slopes: [0, 1, 2].map(|k| [-t[k], u[k], v[k]]),
        })
    }
}

impl Difference<'_> {
    /// Point and derivative; beyond its ends the curve goes on along its tangents.
    fn curve_over(&self, t: Interval) -> Option<[Box3; 2]> {
        let parts = beyond(self.curve.domain(), t);
        let over = parts.iter().flatten().map(|&(t, way)| {
            let c = self.curve.enclose(t, 1);
            [c[0] + c[1].scale(way), c[1]]
        });
        over.reduce(|a, b| [0, 1].map(|k| a[k].hull(b[k])))
    }
}

/// All points where a curve meets a surface: each is proven to be the only one in its box; every other one lies in a box that
/// is not decided. Points beyond an end or a side by less than 10⁻¹⁰ of the range count as on it.
///
/// Cost: some enclosures of both for each box, of which `budget` are looked at; the boxes that are left then are undecided.
///
/// ```
/// use nappe::curve::Line;
/// use nappe::query::intersect;
/// use nappe::surface::{Torus, TorusOptions};
/// use nappe::DVec3;
///
/// let torus = Torus::new(3.0, 1.0, TorusOptions::default()).unwrap();
/// let line = Line::new(DVec3::new(-5.0, 0.1, 0.2), DVec3::new(5.0, 0.3, 0.1)).unwrap();
/// let found = intersect(&line, &torus, 100_000);
/// assert_eq!((found.points.len(), found.undecided.len()), (4, 0));
/// ```
pub fn intersect(curve: &dyn Curve, surface: &dyn Surface, budget: usize) -> CurveSurface {
    let [u, v] = surface.domain();
    let domain = [curve.domain(), u, v];
    let outer = [0, 1, 2].map(|k| margins(domain[k], [1.0, 1.0]));
    let [u, v] = [Dir::U, Dir::V].map(|dir| surface.breaks(dir).below(0));
    let system = Difference {
        curve,
        surface,
        jumps: [curve.breaks().below(0), u, v],
    };
    let found = solve(&system, outer, SMALLEST, budget);
    let mut points: Vec<CurveSurfacePoint> = Vec::new();
    for zero in found.zeros.iter().filter(|z| touch(z.at, outer)) {
        let [t, u, v] = [0, 1, 2].map(|k| zero.at[k].mid().clamp(domain[k].lo, domain[k].hi));
        points.push(CurveSurfacePoint {
            t,
            uv: [u, v],
            point: surface.point([u, v]),
            zero: zero.at,
            alone: zero.alone,
        });
    }
    points.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.uv[0].total_cmp(&b.uv[0])));
    let hull = |group: Vec<usize>| {
        let boxes = group.iter().map(|&k| found.open[k]);
        boxes.reduce(|a, b| [0, 1, 2].map(|k| a[k].hull(b[k])))
    };
    CurveSurface {
        points,
        undecided: clusters(&found.open, 0.0)
            .into_iter()
            .filter_map(hull)
            .collect(),
        boxes: found.looked,
    }
}
