//! Curvature of a surface at a point, and its extremes over a surface.

use super::apex::apexes;
use super::search::{End, Extreme, Quantities, Search, SearchOptions};
use super::shape::{Shape, ShapeForm};
use super::size;
use super::taylor::Taylor;
use crate::breaks::Limit;
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Surface, SurfaceJet};
use glam::DVec3;

/// The curvature of a surface at a point.
///
/// Signs are those of the normal `n = r_u × r_v / |r_u × r_v|`: a normal section that bends towards `n` has positive
/// curvature. So a sphere of radius R whose normals point outwards has `k1 = k2 = mean = -1/R` and Gaussian curvature
/// `1/R²`. Units: 1/length; the Gaussian curvature 1/length².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curvature {
    /// `K = k1 k2 = (LN - M²)/(EG - F²)`.
    pub gaussian: f64,
    /// `H = (k1 + k2)/2 = (EN - 2FM + GL)/(2(EG - F²))`.
    pub mean: f64,
    /// The larger principal curvature.
    pub k1: f64,
    /// The smaller principal curvature.
    pub k2: f64,
    /// The unit tangent vectors along which the normal section has curvature `k1` and `k2`; square to each other. Where
    /// both are equal (an umbilic) every pair would do; then the first is along `r_u`.
    pub directions: [DVec3; 2],
}

/// Below this relative difference of the principal curvatures their directions are rounding errors.
const UMBILIC: f64 = 1e-12;

/// The curvature from a jet of order 2 or more; `None` where the tangents do not span a plane, as at a pole.
///
/// Source: do Carmo, *Differential geometry of curves and surfaces*, §3.3.
pub fn curvature(jet: &SurfaceJet) -> Option<Curvature> {
    let n = jet.normal()?;
    let (ru, rv) = (jet.d[1], jet.d[2]);
    // In an orthonormal basis of the tangent plane the shape operator is a symmetric matrix: no cancellation between
    // the metric and the second form.
    let e1 = ru.normalize();
    let e2 = n.cross(e1);
    let (a, b, c) = (ru.dot(e1), rv.dot(e1), rv.dot(e2));
    let (l, m, k) = (n.dot(jet.d[3]), n.dot(jet.d[4]), n.dot(jet.d[5]));
    // e1 = r_u / a, e2 = (r_v - b e1) / c.
    let p = l / (a * a);
    let q = (m - b * a * p) / (a * c);
    let s = (k - b * b * p - 2.0 * b * c * q) / (c * c);
    let (mean, half) = (0.5 * (p + s), 0.5 * (p - s));
    let radius = half.hypot(q);
    let (k1, k2) = (mean + radius, mean - radius);
    let direction = if radius <= UMBILIC * (mean.abs() + radius) {
        e1
    } else {
        // Half the angle of (half, q), without cancellation.
        let angle = 0.5 * q.atan2(half);
        e1 * angle.cos() + e2 * angle.sin()
    };
    let found = Curvature {
        gaussian: p * s - q * q,
        mean,
        k1,
        k2,
        directions: [direction, n.cross(direction)],
    };
    (found.k1.is_finite() && found.k2.is_finite()).then_some(found)
}

/// What is looked for over a surface: `[K, H, k1, k2]`.
struct Curvatures<'a> {
    surface: &'a dyn Surface,
    size: f64,
    /// The longest tangents along u and v that samples found.
    longest: [f64; 2],
}

pub(super) const GAUSSIAN: usize = 0;
pub(super) const MEAN: usize = 1;
pub(super) const K1: usize = 2;
pub(super) const K2: usize = 3;
/// Curvatures of less than this over the size are compared as if they were this great. Smaller, and the rounding errors
/// of planes would be searched; larger, and faint curvature would be found coarsely.
const FLAT: f64 = 1e-6;

/// Where a tangent is shorter than this part of the longest along the same parameter no curvature is sampled: it is divided
/// by its square, which leaves 10 of 16 digits at 10⁻³. (A needle is thin everywhere: that is no pole.) Smaller, and rounding beside a pole would pass for curvature; larger, and the samples
/// would miss what is in a pole.
pub(super) const CLEAR: f64 = 1e-3;

/// The degree of the Taylor polynomials. Higher degrees need fewer boxes but each costs more.
const DEGREE: usize = 6;

/// Samples in each direction for the longest tangents.
const LINES: usize = 9;

/// The longest tangents along u and v at samples inside.
pub(super) fn longest(surface: &dyn Surface) -> [f64; 2] {
    let domain = surface.domain();
    let at =
        |d: usize, k: usize| domain[d].lo + domain[d].width() * (k as f64 + 0.5) / LINES as f64;
    let mut longest = [0.0f64; 2];
    for k in 0..LINES * LINES {
        let jet = surface.jet([at(0, k / LINES), at(1, k % LINES)], [Limit::Above; 2], 1);
        longest = [0, 1].map(|d| longest[d].max(jet.d[1 + d].length()));
    }
    longest
}

impl Quantities<4> for Curvatures<'_> {
    const ORDER: usize = 2;

    fn values(&self, jet: &SurfaceJet) -> Option<[f64; 4]> {
        let short = |d: usize| jet.d[1 + d].length() < CLEAR * self.longest[d];
        if short(0) || short(1) {
            return None;
        }
        let c = curvature(jet)?;
        Some([c.gaussian, c.mean, c.k1, c.k2])
    }

    fn enclose(&self, uv: [Interval; 2]) -> ([Interval; 4], usize) {
        let form = match ShapeForm::new(self.surface, uv, self.size, DEGREE) {
            Ok(form) => form,
            Err(next) => return ([Interval::ENTIRE; 4], next),
        };
        let offset = form.offset;
        let both = |f: &dyn Fn(&Shape) -> Taylor| [f(&form.wide), f(&form.at)];
        let range = |[wide, at]: [Taylor; 2]| wide.range(&at, offset);
        let half = Interval::point(0.5);
        let gaussian = range(both(&|f| f.p.mul(&f.s).sub(&f.q.sqr())));
        let mean = range(both(&|f| f.p.add(&f.s).scale(half)));
        let [k1, k2] = principal(&form);
        let terms: [fn(&Shape) -> &Taylor; 3] = [|f| &f.p, |f| &f.q, |f| &f.s];
        let weight = terms.map(|t| t(&form.wide).weight(t(&form.at), offset));
        let sum = |d: usize| weight.iter().map(|w| w[d]).sum::<f64>();
        let next = usize::from((sum(1) > sum(0)) != form.exchanged);
        ([gaussian, mean, k1, k2], next)
    }

    fn unit(&self, quantity: usize, greatest: [f64; 4]) -> f64 {
        let k = greatest[K1].max(greatest[K2]).max(FLAT / self.size);
        if quantity == GAUSSIAN { k * k } else { k }
    }
}

/// The eigenvalues of `[[p, q], [q, s]]` over a box.
///
/// In the basis that is principal at the centre q is small. Then `p ≤ k1 ≤ p + q²/(p - s)` if p > s, as
/// `(k1 - p)(k1 - s) = q²`; near an umbilic `k1 ≤ max(p, s) + |q|` (Gershgorin). All is linear in p, q, s up to terms of
/// the second order, so nothing of the Taylor polynomials is lost.
fn principal(form: &ShapeForm) -> [Interval; 2] {
    let at = [&form.at.p, &form.at.q, &form.at.s].map(|t| t.c[0].mid());
    let angle = 0.5 * at[1].atan2(0.5 * (at[0] - at[2]));
    let [c, s] = [angle.cos(), angle.sin()].map(Interval::point);
    let (c2, s2, cs) = (c.sqr(), s.sqr(), c * s);
    // Cosine and sine are rounded: the basis is too long or short by a factor.
    let one = c2 + s2;
    let two = Interval::point(2.0);
    let range = |f: &dyn Fn(&Shape) -> Taylor| f(&form.wide).range(&f(&form.at), form.offset) / one;
    let p = range(&|f| f.p.scale(c2).add(&f.q.scale(two * cs)).add(&f.s.scale(s2)));
    let r = range(&|f| f.p.scale(s2).sub(&f.q.scale(two * cs)).add(&f.s.scale(c2)));
    let q = range(&|f| f.q.scale(c2 - s2).sub(&f.p.sub(&f.s).scale(cs))).abs();
    let excess = if p.lo > r.hi {
        let gap = Interval::point(p.lo) - Interval::point(r.hi);
        (Interval::point(q.hi).sqr() / gap).min(Interval::point(q.hi))
    } else {
        Interval::point(q.hi)
    };
    let upper = p.max(r) + Interval::new(0.0, excess.hi);
    let lower = p.min(r) - Interval::new(0.0, excess.hi);
    [upper, lower]
}

/// The extremes of a surface's curvature. See [`Curvature`] for the signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CurvatureExtremes {
    /// The least and greatest Gaussian curvature.
    pub gaussian: [Extreme; 2],
    /// The least and greatest mean curvature.
    pub mean: [Extreme; 2],
    /// The greatest of the larger principal curvature.
    pub k1: Extreme,
    /// The least of the smaller principal curvature.
    pub k2: Extreme,
    /// The smallest radius of curvature of any normal section, `1 / max(|k1|, |k2|)`; infinite for a plane, 0 where
    /// they are unbounded. Its certainty is in `k1` and `k2`.
    pub smallest_radius: f64,
}

/// The extremes of the curvature over a surface with the places where they are; `None` if there is no place with a
/// normal. They are suprema.
///
/// A side that is shorter than 10⁻¹² of the surface's size counts as one point; if the tangents there lie in one plane,
/// the bounds hold up to it, with the limits of the curvature there. Where curvature is proven to grow without bound in
/// such a point (the apex of a cone) the extreme is infinite, and exact. Where nothing could be bounded, the value is the
/// most extreme one found and its certainty `Estimated(∞)`.
///
/// Cost: branch and bound, limited by `options.budget` boxes for each of the six numbers, which share their boxes.
pub fn curvature_extremes(
    surface: &dyn Surface,
    options: &SearchOptions,
) -> Option<CurvatureExtremes> {
    let size = size(surface);
    let curvatures = Curvatures {
        surface,
        size,
        longest: longest(surface),
    };
    let mut search = Search::new(surface, &curvatures);
    let apexes = apexes(surface, size);
    let mut find = |quantity, end: End| {
        let unbounded = apexes.iter().find(|a| {
            let sign = match quantity {
                GAUSSIAN => a.gaussian,
                _ => a.principal,
            };
            sign == end.sign()
        });
        if let Some(apex) = unbounded {
            return Some(Extreme {
                value: f64::INFINITY * end.sign(),
                uv: apex.uv,
                certainty: Certainty::Exact,
            });
        }
        let mut found = search.extreme(quantity, end, options)?;
        if let Certainty::Estimated(_) = found.certainty {
            found.certainty = Certainty::Estimated(f64::INFINITY);
        }
        Some(found)
    };
    let k1 = find(K1, End::Greatest)?;
    let k2 = find(K2, End::Least)?;
    let mut both = |q| Some([find(q, End::Least)?, find(q, End::Greatest)?]);
    Some(CurvatureExtremes {
        gaussian: both(GAUSSIAN)?,
        mean: both(MEAN)?,
        k1,
        k2,
        smallest_radius: 1.0 / k1.value.abs().max(k2.value.abs()),
    })
}
