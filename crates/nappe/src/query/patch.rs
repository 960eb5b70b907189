//! Polynomial pieces of surfaces, for which the distance is a polynomial too.
//!
//! Half the squared distance of a point p from the points r of a bicubic piece is `½ |r - c|² - (p - c) · (r - c) + ½ |p - c|²`,
//! of degree 6 along each parameter. Its Bernstein coefficients are linear in p: what they are made of is prepared. They know
//! how far curvature and distance cancel each other, so that few parts need a look where the distance is nearly the same
//! over a wide area, as at a centre of curvature.

use super::bernstein::{Coefficients, DEGREE};
use crate::exact::NurbsSurface;
use crate::interval::Interval;
use crate::simd::vectorized;
use crate::surface::{Dir, Surface};
use glam::{DVec3, Vec4Swizzles};

/// The highest degree of a piece; its square is that of [`Coefficients`].
const CUBIC: usize = DEGREE / 2;
/// The rounding errors of a coefficient, as a share of the largest number that goes in.
const ROUNDING: f64 = 256.0 * f64::EPSILON;

/// A piece of degree 3 at most along each parameter.
#[derive(Debug)]
pub(super) struct Patch {
    /// c of the module, how far control points are from it at most, and their largest coordinate.
    centre: DVec3,
    radius: f64,
    largest: f64,
    /// Half the square of `r - c`, and its coordinates.
    square: Coefficients,
    points: [Coefficients; 3],
}

/// The net of a surface whose pieces are patches; `None` if they are not.
pub(super) fn net(surface: &dyn Surface) -> Option<NurbsSurface> {
    let net = surface.to_nurbs()?;
    let cubic = [net.basis_u(), net.basis_v()]
        .iter()
        .all(|b| b.degree() <= CUBIC);
    (cubic && !net.is_rational()).then_some(net)
}

impl Patch {
    /// Over a piece of a net; `None` if the net has knots inside, or numbers that are too large to compute with.
    pub(super) fn new(net: &NurbsSurface, uv: [Interval; 2]) -> Option<Self> {
        let knots_inside = |dir: Dir| {
            let t = uv[dir as usize];
            let breaks = net.breaks(dir).iter();
            breaks.map(|b| b.at).any(|at| t.lo < at && at < t.hi)
        };
        if knots_inside(Dir::U) || knots_inside(Dir::V) {
            return None;
        }
        let points: Vec<DVec3> = net
            .bezier_points(uv)
            .iter()
            .map(|b| b.xyz() / b.w)
            .collect();
        let centre = points.iter().sum::<DVec3>() / points.len() as f64;
        let largest = points.iter().map(|b| b.abs().max_element());
        let largest = largest.fold(0.0, f64::max);
        let points: Vec<DVec3> = points.iter().map(|&b| b - centre).collect();
        let radius = points.iter().map(|b| b.length()).fold(0.0, f64::max);
        if !centre.is_finite() || radius + largest >= 1e100 {
            return None;
        }
        let degrees = [net.basis_u().degree(), net.basis_v().degree()];
        let shares = degrees.map(Shares::new);
        let columns = degrees[1] + 1;
        let at = |i: usize, j: usize| points[i * columns + j];
        let coordinate = |c: usize| {
            Coefficients::of(|[k, l]| {
                let pairs = shares[0].pairs(k, &shares[1], l);
                pairs.map(|([i, _], [j, _], s)| s * at(i, j)[c]).sum()
            })
        };
        let square = Coefficients::of(|[k, l]| {
            let pairs = shares[0].pairs(k, &shares[1], l);
            pairs
                .map(|([i, i2], [j, j2], s)| 0.5 * s * at(i, j).dot(at(i2, j2)))
                .sum()
        });
        Some(Self {
            centre,
            radius,
            largest,
            square,
            points: [0, 1, 2].map(coordinate),
        })
    }

    /// The coefficients of half the squared distance of a point, and the least of them.
    pub(super) fn half_square(&self, p: DVec3, out: &mut Coefficients) -> f64 {
        let q = p - self.centre;
        let constant = 0.5 * q.length_squared();
        let [x, y, z] = &self.points;
        vectorized(
            #[inline(always)]
            || {
                for (k, out) in out.0.iter_mut().enumerate() {
                    let along = x.0[k] * q.x + y.0[k] * q.y + z.0[k] * q.z;
                    *out = (self.square.0[k] + constant) - along;
                }
                out.least()
            },
        )
    }

    /// The rounding errors of coefficients, of halves too; infinite where numbers are too large.
    pub(super) fn rounding(&self, p: DVec3) -> f64 {
        let reach = self.radius + (p - self.centre).length();
        if reach < 1e100 {
            ROUNDING * reach * (reach + self.largest) + f64::MIN_POSITIVE
        } else {
            f64::INFINITY
        }
    }

    /// How far the piece is from its middle at most.
    pub(super) fn radius(&self) -> f64 {
        self.radius
    }
}

/// Products of Bernstein polynomials of some degree, as shares of those of degree [`DEGREE`].
struct Shares(Vec<Vec<([usize; 2], f64)>>);

impl Shares {
    /// `B_i B_j`, raised to the full degree.
    fn new(degree: usize) -> Self {
        let raised = DEGREE - 2 * degree;
        let of = |k: usize| {
            let mut out = Vec::new();
            for i in 0..=degree.min(k) {
                for j in 0..=degree.min(k - i) {
                    let rest = k - i - j;
                    if rest <= raised {
                        let product = binomial(degree, i) * binomial(degree, j);
                        let share = product * binomial(raised, rest) / binomial(DEGREE, k);
                        out.push(([i, j], share));
                    }
                }
            }
            out
        };
        Self((0..=DEGREE).map(of).collect())
    }

    /// The products of both parameters that go into one coefficient.
    fn pairs<'a>(
        &'a self,
        k: usize,
        other: &'a Self,
        l: usize,
    ) -> impl Iterator<Item = ([usize; 2], [usize; 2], f64)> + 'a {
        let along_v = &other.0[l];
        self.0[k]
            .iter()
            .flat_map(move |&(i, s)| along_v.iter().map(move |&(j, t)| (i, j, s * t)))
    }
}

fn binomial(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |b, i| b * (n - i) as f64 / (i + 1) as f64)
}
