//! Places where two rectangles of parameters have a point in common: found by Newton's method, proven by Krawczyk's test.

use super::links::Links;
use crate::box3::Box3;
use crate::breaks::Limit;
use crate::interval::Interval;
use crate::surface::{Surface, normal_at};
use glam::{DMat3, DVec3};

/// The most steps of Newton's method: where surfaces touch each step only halves the distance of the parameters.
const STEPS: usize = 40;
/// A step that leaves more than this share of the distance leads nowhere.
const SLOW: f64 = 0.6;
/// Relative to the trace of the normal equations: what keeps them solvable where the tangents of both surfaces are in one
/// plane. Larger, and the method would slow down; smaller, and rounding would throw it off.
const DAMPING: f64 = 1e-10;
/// Half the size of the box of parameters, relative to the domain, in which a common point is proven.
const TRIALS: [f64; 4] = [1e-7, 1e-5, 1e-9, 1e-3];
/// Sine of the angle between tangent planes below which a common point that is not proven counts as a touch.
const TRANSVERSAL: f64 = 1e-4;
/// Relative to the domain: nearer to its end a parameter is on a side.
pub(super) const ON_SIDE: f64 = 1e-7;
/// The step, relative to the domain, at which the surroundings of a common point are looked at.
const BESIDE: f64 = 1e-2;

/// How surfaces meet in a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Crosses { proven: bool, angle: f64 },
    Overlaps,
    Touches,
}

/// A pair of parameters whose points agree within rounding.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    pub(super) uv: [[f64; 2]; 2],
    pub(super) point: DVec3,
}

/// Two surfaces, and the distance within which points are the same but for rounding.
pub(super) struct Meet<'a> {
    pub(super) surfaces: [&'a dyn Surface; 2],
    pub(super) rounding: f64,
}

impl Meet<'_> {
    /// The difference of the points, and its derivatives by the four parameters.
    fn difference(&self, uv: [[f64; 2]; 2]) -> (DVec3, [DVec3; 4]) {
        let [a, b] = [0, 1].map(|i| self.surfaces[i].jet(uv[i], [Limit::Above; 2], 1).d);
        (a[0] - b[0], [a[1], a[2], -b[1], -b[2]])
    }

    /// A common point with parameters in the given rectangles, by steps of least length.
    pub(super) fn find(&self, within: [[Interval; 2]; 2]) -> Option<Root> {
        let range = |k: usize| within[k / 2][k % 2];
        let mut x = [0, 1, 2, 3].map(|k| range(k).mid());
        let split = |x: [f64; 4]| [[x[0], x[1]], [x[2], x[3]]];
        let mut last = f64::INFINITY;
        for step in 0..STEPS {
            let (f, d) = self.difference(split(x));
            let distance = f.length();
            if distance <= self.rounding {
                let uv = split(x);
                let point = self.surfaces[0].point(uv[0]);
                return Some(Root { uv, point });
            }
            // The first steps may be clamped; afterwards they must gain.
            if !distance.is_finite() || (step > 2 && distance > SLOW * last) {
                return None;
            }
            last = distance;
            let scaled = [0, 1, 2, 3].map(|k| d[k] * range(k).width());
            let square = |v: DVec3| DMat3::from_cols(v * v.x, v * v.y, v * v.z);
            let sum = scaled.iter().fold(DMat3::ZERO, |m, &v| m + square(v));
            let trace = sum.x_axis.x + sum.y_axis.y + sum.z_axis.z;
            let solvable = sum + DMat3::from_diagonal(DVec3::splat(DAMPING * trace));
            let z = solvable.inverse() * f;
            if !z.is_finite() {
                return None;
            }
            for k in 0..4 {
                let t = range(k);
                x[k] = (x[k] - scaled[k].dot(z) * t.width()).clamp(t.lo, t.hi);
            }
        }
        None
    }

    /// A common point in the middle of a side of one of the surfaces, if a rectangle reaches to it: where a side is tangent
    /// to the other surface, steps from elsewhere are slow.
    pub(super) fn find_on_side(&self, within: [[Interval; 2]; 2]) -> Option<Root> {
        let tries = (0..8).filter_map(|n| {
            let [k, d, upper] = [n / 4, n / 2 % 2, n % 2];
            let domain = self.surfaces[k].domain()[d];
            let at = [domain.lo, domain.hi][upper];
            let mut point = within;
            point[k][d] = within[k][d].contains(at).then(|| Interval::point(at))?;
            point[k][1 - d] = Interval::point(within[k][1 - d].mid());
            Some(point)
        });
        tries.into_iter().find_map(|point| self.find(point))
    }

    pub(super) fn classify(&self, root: &Root, links: &Links) -> Kind {
        let normals = [0, 1].map(|i| {
            normal_at(self.surfaces[i], root.uv[i], [Limit::Above; 2])
                .vector()
                .unwrap_or(DVec3::ZERO)
        });
        let cross = normals[0].cross(normals[1]).length();
        let angle = cross.atan2(normals[0].dot(normals[1]).abs());
        let on_side = [0, 1].map(|i| self.on_side(root, i));
        if on_side != [false; 2] {
            // A seam is inside the surface all the same.
            let passes = |i: usize| {
                !on_side[1 - i]
                    && links.passes(self.surfaces[i], root.uv[i], normals[1 - i], TRANSVERSAL)
            };
            return if passes(0) || passes(1) {
                Kind::Crosses {
                    proven: false,
                    angle,
                }
            } else {
                Kind::Touches
            };
        }
        if self.is_proven(root) {
            Kind::Crosses {
                proven: true,
                angle,
            }
        } else if cross > TRANSVERSAL {
            Kind::Crosses {
                proven: false,
                angle,
            }
        } else if self.is_area(root) {
            Kind::Overlaps
        } else {
            Kind::Touches
        }
    }

    fn on_side(&self, root: &Root, i: usize) -> bool {
        let domain = self.surfaces[i].domain();
        (0..2).any(|d| {
            let (t, all) = (root.uv[i][d], domain[d]);
            let margin = ON_SIDE * all.width();
            t < all.lo + margin || t > all.hi - margin
        })
    }

    /// Proves that there is a common point near by, and one surface passes through the other there: with one parameter
    /// fixed, Krawczyk's operator maps a box of the three others into itself. Then their three tangents are independent
    /// over the box.
    fn is_proven(&self, root: &Root) -> bool {
        let x = [root.uv[0][0], root.uv[0][1], root.uv[1][0], root.uv[1][1]];
        let width = |k: usize| self.surfaces[k / 2].domain()[k % 2].width();
        let (_, d) = self.difference(root.uv);
        let others =
            |fixed: usize| -> [usize; 3] { [0, 1, 2].map(|k| if k < fixed { k } else { k + 1 }) };
        let matrix = |fixed: usize| {
            let [a, b, c] = others(fixed).map(|k| d[k] * width(k));
            DMat3::from_cols(a, b, c)
        };
        let volume = |fixed: usize| matrix(fixed).determinant().abs();
        let fixed = (1..4).fold(0, |best, k| if volume(k) > volume(best) { k } else { best });
        let inverse = matrix(fixed).inverse();
        if !inverse.is_finite() {
            return false;
        }
        let free = others(fixed);
        let at = [0, 1].map(|i| self.surfaces[i].bounds(root.uv[i].map(Interval::point)));
        let start = (at[0] - at[1]).linear_image(&inverse);
        TRIALS.iter().any(|&trial| {
            let mut range = x.map(Interval::point);
            for k in free {
                range[k] = Interval::new(x[k] - trial * width(k), x[k] + trial * width(k));
                if !self.surfaces[k / 2].domain()[k % 2].encloses(range[k]) {
                    return false;
                }
            }
            let jets =
                [0, 1].map(|i| self.surfaces[i].enclose([range[2 * i], range[2 * i + 1]], 1));
            let minus = Interval::point(-1.0);
            // K - x, in units of the widths: -Y F(x) + (1 - Y F') (X - x).
            let mut moved = start.scale(minus);
            for (column, k) in free.into_iter().enumerate() {
                let tangent = jets[k / 2][1 + k % 2].scale(Interval::point(width(k)));
                let tangent = if k < 2 { tangent } else { tangent.scale(minus) };
                let unit = Box3::point([DVec3::X, DVec3::Y, DVec3::Z][column]);
                let left = unit - tangent.linear_image(&inverse);
                let step = (range[k] - Interval::point(x[k])) / Interval::point(width(k));
                moved = moved + left.scale(step);
            }
            let inside = |i: Interval| i.mag() < trial * (1.0 - 1e-9);
            inside(moved.x) && inside(moved.y) && inside(moved.z)
        })
    }

    /// True if points beside it, along both parameters of the first surface, are common as well.
    fn is_area(&self, root: &Root) -> bool {
        let [own, other] = [0, 1].map(|i| self.surfaces[i].domain());
        (0..2).all(|d| {
            [-1.0, 1.0].iter().any(|sign| {
                let mut uv = root.uv[0];
                uv[d] += sign * BESIDE * own[d].width();
                if !own[d].contains(uv[d]) {
                    return false;
                }
                let around = |t: f64, all: Interval| {
                    let w = 8.0 * BESIDE * all.width();
                    Interval::new((t - w).max(all.lo), (t + w).min(all.hi))
                };
                let near = [0, 1].map(|e| around(root.uv[1][e], other[e]));
                self.find([uv.map(Interval::point), near]).is_some()
            })
        })
    }
}
