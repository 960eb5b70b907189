//! Unit normals, also where `r_u × r_v` vanishes.

use super::{Dir, Surface, jet_index, jet_len};
use crate::breaks::{Breaks, Limit};
use crate::series::binomial;
use crate::simd::{Lanes, Registers};
use glam::DVec3;

/// How many derivatives of the normal field are tried. Poles need one; a touching of the axis of order m needs m - 1.
const ORDERS: usize = 4;
/// Tangents (over the width of the piece) whose cross product is above this fraction of the longer one's square are
/// taken as they are without a look at higher derivatives.
const PLAIN: f64 = 1e-6;
/// Relative to the point's distance from the origin of space: tangents longer than this give a direction that the
/// rounding of the coordinates cannot turn by more than 10⁻⁶.
const WELL_ABOVE_ROUNDING: f64 = 1e-9;
/// Relative to the piece's width: nearer to an end of the domain, "into the surface" means away from that end.
const AT_END: f64 = 1e-6;
/// In units of the rounding error of a cross product: one that is longer has a sign that can be believed.
const BEYOND_ROUNDING: f64 = 64.0;
/// Limits from different directions that differ by no more than this (radians) are one.
const ONE_LIMIT: f64 = 1e-6;

/// The normal of a surface at a point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Normal {
    /// The tangents span the plane; the unit vector along `r_u × r_v`.
    Regular(DVec3),
    /// They do not, but the normal of the points near by has this limit: at a pole or on a collapsed side along the
    /// line of constant parameter that leads inside. On a cone it differs from line to line.
    Limit(DVec3),
    /// There is no limit: the surface is collapsed, or has a corner that turns.
    None,
}

impl Normal {
    /// The unit vector, if there is one.
    pub fn vector(self) -> Option<DVec3> {
        match self {
            Normal::Regular(n) | Normal::Limit(n) => Some(n),
            Normal::None => None,
        }
    }
}

/// The unit normal at a point of a surface. At a break the piece on the side of `limit` decides.
///
/// Where `r_u × r_v` vanishes, its Taylor series along a line that leads from the point into the surface is taken, and
/// the first term that does not vanish gives the direction: along u where `r_v = 0` (a side u = const collapsed to a
/// point), along v where `r_u = 0`. In other degenerate points (parallel tangents in a corner) the limits along u,
/// along v and along the diagonal must agree. Never a NaN. Cost: one jet of order 1; at degenerate points one of order 5.
pub fn normal_at(surface: &dyn Surface, uv: [f64; 2], limit: [Limit; 2]) -> Normal {
    normal_of(surface, uv, limit)
}

/// The same for a surface of a kind that need not be known.
pub(super) fn normal_of<S: Surface + ?Sized>(
    surface: &S,
    uv: [f64; 2],
    limit: [Limit; 2],
) -> Normal {
    let mut jet = [DVec3::ZERO; jet_len(1)];
    surface.jet_into(uv, limit, 1, &mut jet);
    normal_from(surface, uv, limit, &jet)
}

/// The same from a point and first derivatives that are known.
pub(crate) fn normal_from<S: Surface + ?Sized>(
    surface: &S,
    uv: [f64; 2],
    limit: [Limit; 2],
    jet: &[DVec3; 3],
) -> Normal {
    let width = [0, 1].map(|k| {
        let breaks = surface.breaks([Dir::U, Dir::V][k]);
        breaks.piece(breaks.find(uv[k], limit[k])).width()
    });
    let (a, b) = (jet[1] * width[0], jet[2] * width[1]);
    let plain = a.cross(b);
    let (shorter, longer) = (a.length().min(b.length()), a.length().max(b.length()));
    if plain.length() > PLAIN * longer * longer && shorter > WELL_ABOVE_ROUNDING * jet[0].length() {
        return plain.try_normalize().map_or(Normal::None, Normal::Regular);
    }
    Tangents::new(surface, uv, limit, width).normal()
}

/// Squares outside lose digits or overflow.
const RANGE: [f64; 2] = [1e-250, 1e250];

/// The normals of many points from first derivatives that are known, where the tangents surely span a plane by
/// [`normal_at`]'s rule, whatever the piece.
pub(crate) struct PlainNormals {
    /// The squares of the widths of the widest pieces along u and v, and of the narrowest.
    widest: [f64; 2],
    narrowest: [f64; 2],
}

impl PlainNormals {
    pub(crate) fn new(surface: &dyn Surface) -> Self {
        let breaks = [Dir::U, Dir::V].map(|d| surface.breaks(d));
        let widths = breaks.map(|b| {
            let widths = (0..b.pieces()).map(|k| b.piece(k).width());
            widths.fold([f64::INFINITY, 0.0], |[a, b], w| [w.min(a), w.max(b)])
        });
        Self {
            narrowest: widths.map(|[least, _]| least * least),
            widest: widths.map(|[_, most]| most * most),
        }
    }

    /// The unit normal; `None` where the piece, or more than first derivatives, has to be known.
    #[inline]
    pub(crate) fn of(&self, jet: &[DVec3; 3]) -> Option<DVec3> {
        let cross = jet[1].cross(jet[2]);
        let [square, a, b] = [cross, jet[1], jet[2]].map(DVec3::length_squared);
        let ([u, v], [narrow_u, narrow_v]) = (self.widest, self.narrowest);
        // Twice the limits: rounding decides nothing.
        let longer = (a * u).max(b * v);
        let shorter = (a * narrow_u).min(b * narrow_v);
        let rounding = 4.0 * WELL_ABOVE_ROUNDING * WELL_ABOVE_ROUNDING;
        let plain = square * (narrow_u * narrow_v) > 4.0 * PLAIN * PLAIN * (longer * longer)
            && shorter > rounding * jet[0].length_squared()
            && RANGE[0] < square
            && square < RANGE[1]
            && longer < RANGE[1].sqrt();
        plain.then(|| cross / square.sqrt())
    }
}

/// True if the tangents surely span a plane by [`normal_at`]'s rule in all lanes: from the squared length of their cross
/// product, both (over the width of the piece) and the point. The roundings of what it computes may differ between
/// machines; the rule has room for them.
#[inline(always)]
pub(super) fn all_plain<R: Registers>(
    cross: Lanes<R>,
    a: &[Lanes<R>; 3],
    b: &[Lanes<R>; 3],
    point: &[Lanes<R>; 3],
) -> bool {
    /// Squares of lengths outside lose digits or overflow: that of the cross product is at most the product of the others.
    const LEAST: f64 = 1e-250;
    const MOST: f64 = 1e125;
    let of = |x| Lanes::splat(cross.0, x);
    // At least the longer one's square, and its product with the shorter one's is at least that of the cross product.
    let both = square_fused(a, Some(square_fused(b, None)));
    // Twice the limits: rounding decides nothing.
    let plain = of(4.0 * PLAIN * PLAIN) * both;
    let rounding = of(4.0 * WELL_ABOVE_ROUNDING * WELL_ABOVE_ROUNDING) * square_fused(point, None);
    // Where something is not a number, so is the bound.
    let bound = of(LEAST).max(plain.max(rounding) * both);
    cross.exceeds(bound) & of(MOST).exceeds(both)
}

/// The square of a length, added to a sum.
#[inline(always)]
fn square_fused<R: Registers>(x: &[Lanes<R>; 3], sum: Option<Lanes<R>>) -> Lanes<R> {
    let first = sum.map_or(x[0] * x[0], |sum| sum.plus_fused(x[0], x[0]));
    first.plus_fused(x[1], x[1]).plus_fused(x[2], x[2])
}

/// Taylor coefficients of both tangents at a point, in parameters that run over `[0, 1]` in the piece: all vectors are
/// then lengths in space.
struct Tangents {
    /// `r_u` and `r_v`: the coefficient of `du^i dv^j` at `jet_index(i, j)`.
    series: [Vec<DVec3>; 2],
    /// The highest total order that is finite, and the greatest length of a coefficient of either.
    orders: usize,
    size: [f64; 2],
    /// The sense in which u and v lead into the piece.
    inwards: [f64; 2],
    /// Relative to those lengths: what is shorter counts as zero. With rounding errors ε in the coordinates, a cross
    /// product of relative length δ has a direction that is wrong by ε/δ, and the limit at the nearest degenerate
    /// point is wrong by δ; δ = √ε makes both small.
    vanishing: f64,
}

impl Tangents {
    fn new<S: Surface + ?Sized>(
        surface: &S,
        uv: [f64; 2],
        limit: [Limit; 2],
        width: [f64; 2],
    ) -> Self {
        let jet = surface.jet(uv, limit, ORDERS + 1);
        let domain = surface.domain();
        let inwards = [0, 1].map(|k| match limit[k] {
            _ if uv[k] - domain[k].lo <= AT_END * width[k] => 1.0,
            _ if domain[k].hi - uv[k] <= AT_END * width[k] => -1.0,
            Limit::Above => 1.0,
            Limit::Below => -1.0,
        });
        let mut series = [vec![], vec![]];
        let (mut orders, mut finite) = (0, true);
        for n in 0..=ORDERS {
            // The coefficient of du^i dv^j is the derivative over i! j!.
            let factorial: f64 = (1..=n).map(|k| k as f64).product();
            for j in 0..=n {
                let i = n - j;
                let scale =
                    width[0].powi(i as i32) * width[1].powi(j as i32) * binomial(n, j) / factorial;
                let a = jet.partial(i + 1, j) * (scale * width[0]);
                let b = jet.partial(i, j + 1) * (scale * width[1]);
                finite &= a.is_finite() && b.is_finite();
                series[0].push(a);
                series[1].push(b);
            }
            if finite {
                orders = n + 1;
            }
        }
        let known = super::jet_len(orders.saturating_sub(1));
        let size = [0, 1].map(|k| {
            let known: &[DVec3] = if orders == 0 {
                &[]
            } else {
                &series[k][..known]
            };
            known.iter().map(|d| d.length()).fold(0.0, f64::max)
        });
        Self {
            series,
            orders,
            size,
            inwards,
            vanishing: (f64::EPSILON * (1.0 + jet.point().length() / size[0].max(size[1]))).sqrt(),
        }
    }

    fn normal(&self) -> Normal {
        let noise = self.vanishing * self.size[0] * self.size[1];
        if self.orders == 0 || noise.is_nan() || noise <= 0.0 {
            return Normal::None;
        }
        let (a, b) = (self.series[0][0], self.series[1][0]);
        let plain = a.cross(b);
        if plain.length() > noise {
            return plain.try_normalize().map_or(Normal::None, Normal::Regular);
        }
        let [su, sv] = self.inwards;
        let vanishes = [
            a.length() <= self.vanishing * self.size[0],
            b.length() <= self.vanishing * self.size[1],
        ];
        let found = match vanishes {
            [false, true] => self.towards(su, 0.0, noise),
            [true, false] => self.towards(0.0, sv, noise),
            _ => None,
        };
        if let Some(n) = found {
            return Normal::Limit(n);
        }
        let Some(n) = self.towards(su, sv, noise) else {
            return Normal::None;
        };
        let agree = [(su, 0.0), (0.0, sv)]
            .into_iter()
            .filter_map(|(x, y)| self.towards(x, y, noise))
            .all(|m| m.cross(n).length() <= ONE_LIMIT && m.dot(n) > 0.0);
        if agree {
            Normal::Limit(n)
        } else {
            Normal::None
        }
    }

    /// The limit of the normal along the straight line of parameters that leaves the point in a direction: the first
    /// term of the series of `r_u × r_v` on it that does not vanish. If the degenerate point is a little aside of this
    /// one, the product here is small but beyond rounding, and it says on which side this point lies.
    fn towards(&self, x: f64, y: f64, noise: f64) -> Option<DVec3> {
        let on_line = |k: usize, n: usize| -> DVec3 {
            (0..=n)
                .map(|j| {
                    self.series[k][jet_index(n - j, j)]
                        * (x.powi((n - j) as i32) * y.powi(j as i32))
                })
                .sum()
        };
        (0..self.orders).find_map(|n| {
            let term: DVec3 = (0..=n)
                .map(|k| on_line(0, k).cross(on_line(1, n - k)))
                .sum();
            if term.length() <= noise {
                return None;
            }
            let direction = term.normalize();
            let here = self.series[0][0].cross(self.series[1][0]).dot(direction);
            let beyond_rounding = BEYOND_ROUNDING * self.vanishing * noise;
            Some(if here < -beyond_rounding {
                -direction
            } else {
                direction
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::NurbsSurface;

    fn v(x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z)
    }

    /// The octant of the unit sphere, with a pole on its east side.
    fn octant(scale: f64, shift: DVec3) -> NurbsSurface {
        let h = 0.5f64.sqrt();
        let points = [
            v(1.0, 0.0, 0.0),
            v(1.0, 1.0, 0.0),
            v(0.0, 1.0, 0.0),
            v(1.0, 0.0, 1.0),
            v(1.0, 1.0, 1.0),
            v(0.0, 1.0, 1.0),
            DVec3::Z,
            DVec3::Z,
            DVec3::Z,
        ]
        .map(|p| shift + p * scale);
        NurbsSurface::bezier(3, &points, Some(&[1.0, h, 1.0, h, 0.5, h, 1.0, h, 1.0])).unwrap()
    }

    const ABOVE: [Limit; 2] = [Limit::Above; 2];

    #[test]
    fn the_pole_of_a_sphere_has_the_axis_as_its_normal() {
        for scale in [1e-6, 1.0, 1e6] {
            for shift in [DVec3::ZERO, v(1e3, -2e3, 5e2) * scale] {
                let s = octant(scale, shift);
                for k in 0..=10 {
                    let b = k as f64 / 10.0;
                    let Normal::Limit(n) = normal_at(&s, [1.0, b], ABOVE) else {
                        panic!("a limit at {b}")
                    };
                    assert!((n + DVec3::Z).length() < 1e-9, "{n}");
                    for u in [0.0, 0.5, 1.0 - 1e-6, 1.0 - 1e-11] {
                        let n = normal_at(&s, [u, b], ABOVE).vector().unwrap();
                        let p = (s.point([u, b]) - shift) / scale;
                        assert!((n + p.normalize()).length() < 1e-5, "{u} {b}: {n} {p}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_apex_of_a_cone_has_the_normal_of_each_generator() {
        let points = [
            DVec3::ZERO,
            DVec3::ZERO,
            DVec3::ZERO,
            v(1.0, 0.0, 1.0),
            v(1.0, 1.0, 1.0),
            v(0.0, 1.0, 1.0),
        ];
        let h = 0.5f64.sqrt();
        let s = NurbsSurface::bezier(2, &points, Some(&[1.0, h, 1.0, 1.0, h, 1.0])).unwrap();
        for k in 0..=10 {
            let b = k as f64 / 10.0;
            let apex = normal_at(&s, [0.0, b], ABOVE);
            let Normal::Regular(want) = normal_at(&s, [0.5, b], ABOVE) else {
                panic!("regular away from the apex")
            };
            assert!(matches!(apex, Normal::Limit(n) if (n - want).length() < 1e-12));
        }
    }

    #[test]
    fn tangents_that_are_parallel_in_a_corner_have_a_limit() {
        // The corner (0, 0) is flat: both sides leave along x. In the plane the limit is its normal.
        let points = [
            v(0.0, 0.0, 0.0),
            v(1.0, 0.0, 0.0),
            v(2.0, 1.0, 0.0),
            v(-1.0, 0.0, 0.0),
            v(0.5, 0.7, 0.0),
            v(2.0, 2.0, 0.0),
            v(-2.0, 1.0, 0.0),
            v(0.0, 2.0, 0.0),
            v(1.0, 3.0, 0.0),
        ];
        let s = NurbsSurface::bezier(3, &points, None).unwrap();
        assert_eq!(normal_at(&s, [0.0, 0.0], ABOVE), Normal::Limit(-DVec3::Z));
        assert_eq!(normal_at(&s, [0.2, 0.2], ABOVE), Normal::Regular(-DVec3::Z));
    }

    #[test]
    fn a_collapsed_surface_has_none() {
        let line = [DVec3::ZERO, DVec3::ZERO, DVec3::X, DVec3::X];
        let s = NurbsSurface::bezier(2, &line, None).unwrap();
        assert_eq!(normal_at(&s, [0.5, 0.5], ABOVE), Normal::None);
        let point = NurbsSurface::bezier(2, &[DVec3::ONE; 4], None).unwrap();
        assert_eq!(normal_at(&point, [0.5, 0.5], ABOVE), Normal::None);
    }
}
