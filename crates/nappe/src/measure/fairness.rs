//! How evenly the curvature of a surface varies.

use super::apex::apexes;
use super::integral::{
    Form, Goal, IntegralOptions, Measured, estimate, integrate, is_close, measured,
};
use super::shape::{Shape, ShapeForm};
use super::size;
use super::taylor::Taylor;
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Dir, Surface, SurfaceJet};

/// The degree that is left of the shape operator's polynomials: one derivative, and one division beside a pole, less.
const DEGREE: usize = super::shape::DEGREE - 2;
/// Relative to the curvature of a sphere as large as the surface: what is small enough whatever the rest is.
const SMALL: f64 = 1e-6;

/// The variation of curvature `∫ |∇II|² dA`, per square of the unit of length: the smaller, the fairer. 0 for planes,
/// spheres and circular cylinders, and for nothing else.
///
/// `∇II` is the covariant derivative of the second fundamental form, symmetric in its three arguments (the equations of
/// Codazzi). In principal directions `|∇II|² = (∂k₁/∂e₁)² + 3 (∂k₁/∂e₂)² + 3 (∂k₂/∂e₁)² + (∂k₂/∂e₂)²`: the functional of
/// Moreton and Séquin, *Functional optimization for fair surface design* (SIGGRAPH 1992), has the first and the last
/// term; with the others it needs no principal directions, which turn without a limit around umbilics, and is smooth
/// there. It does not depend on parameters or position. A surface c times as large has `c⁻²` times the variation.
///
/// Over the analytic pieces; jumps of the curvature in between are not counted. Infinite where curvature is proven to grow
/// without bound towards a side that is one point, as at the tip of a cone. Proven unless the surface cannot enclose its
/// derivatives or has no tangent plane somewhere. Cost: at most `options.budget` enclosures of order 8 to 10.
pub fn curvature_variation(surface: &dyn Surface, options: &IntegralOptions) -> Measured {
    let size = size(surface);
    if !apexes(surface, size).is_empty() {
        return Measured {
            value: f64::INFINITY,
            certainty: Certainty::Exact,
        };
    }
    let integrand = |surface: &dyn Surface, uv: [Interval; 2]| {
        let form = ShapeForm::new(surface, uv, size)?;
        let direction = [Dir::U, Dir::V][usize::from(form.swapped)];
        let below = form.pole && form.offset[0].lo < 0.0;
        let [wide, at] = [(&form.wide, false), (&form.at, true)].map(|(shape, narrow)| {
            let x = form.pole.then(|| {
                let range = if narrow {
                    Interval::ZERO
                } else {
                    form.offset[0]
                };
                (Taylor::variable(range, super::shape::DEGREE), below)
            });
            variation(shape, direction, x)
        });
        Ok(Form {
            integrands: vec![[wide, at]],
            offset: form.offset,
            exchanged: form.exchanged,
            absolute: false,
        })
    };
    let goal = Goal {
        least: if size > 0.0 {
            SMALL / (size * size)
        } else {
            0.0
        },
        ..Goal::one(options)
    };
    let found = integrate(&[surface], &integrand, &goal)[0][0];
    let sampled = || {
        estimate(surface, 3, &|d| {
            let jet = SurfaceJet { d: d.into() };
            let area = d[1].cross(d[2]).length();
            [curvature_derivative(&jet).map_or(0.0, |t| square(t) * area)]
        })[0]
    };
    if !found.is_finite() {
        return sampled();
    }
    let found = Interval::new(found.lo.max(0.0), found.hi.max(0.0));
    let close = is_close(found) || found.hi <= 2.0 * goal.least;
    measured(found, if close { f64::NAN } else { sampled().value })
}

/// `|∇II|² dA`.
///
/// In the orthonormal basis e₁ = r_u / |r_u|, e₂ of the shape operator `[[p, q], [q, s]]`, which turns by ω:
/// `∇II(e₁, e₁, x) = x p - 2 ω(x) q`, `∇II(e₁, e₂, x) = x q - ω(x) (s - p)` and `∇II(e₂, e₂, x) = x s + 2 ω(x) q`. All but
/// `∇II(e₂, e₂, e₂)` are needed along e₁ alone, where a pole does no harm.
fn variation(shape: &Shape, first: Dir, pole: Option<(Taylor, bool)>) -> Taylor {
    let second = match first {
        Dir::U => Dir::V,
        Dir::V => Dir::U,
    };
    let two = Interval::point(2.0);
    let half = Interval::point(0.5);
    let cut = |t: &Taylor, degree: usize| t.truncated(degree);
    let full = super::shape::DEGREE;
    let Shape {
        p,
        q,
        s,
        e,
        f,
        n2,
        w,
    } = shape;
    // r_uu·ρ and r_uv·ρ, from derivatives of the metric.
    let g = n2.add(&f.sqr()).div(e);
    let [e_1, e_2] = [first, second].map(|d| e.derivative(d).scale(half));
    let (f_1, g_1) = (f.derivative(first), g.derivative(first).scale(half));
    let low = |t: &Taylor| cut(t, full - 1);
    let (a1, a2) = match &pole {
        None => (f_1.sub(&e_2), g_1),
        Some((x, _)) => {
            let mixed = e_2.sub(&low(f)).divided();
            (
                cut(&f_1, DEGREE).sub(&mixed),
                low(&g).add(&low(x).mul(&g_1)),
            )
        }
    };
    // How the basis turns along u and along v.
    let lean = f.div(e);
    let turn = |a: &Taylor, e: &Taylor| {
        let n = a.degree;
        a.sub(&cut(&lean, n).mul(&cut(e, n))).div(&cut(w, n))
    };
    let (turn1, turn2) = (turn(&cut(&a1, DEGREE), &e_1), turn(&a2, &e_2));
    let at = |t: &Taylor| cut(t, DEGREE);
    let along = |t: &Taylor| cut(&t.derivative(first), DEGREE);
    let twist = turn1.mul(&at(q)).scale(two);
    let t0 = along(p).sub(&twist);
    let t1 = along(q).sub(&turn1.mul(&at(s).sub(&at(p))));
    let t2 = along(s).add(&twist);
    let across = s.derivative(second).add(&turn2.mul(&low(q)).scale(two));
    let across = match &pole {
        None => cut(&across, DEGREE),
        Some(_) => across.divided(),
    };
    let t3 = across.sub(&at(&lean).mul(&t2));
    let three = Interval::point(3.0);
    let sum = t0.sqr().add(&t1.sqr().add(&t2.sqr()).scale(three));
    // |∇II|² |r_u × ρ|
    let density = sum
        .mul(&at(w))
        .div(&at(e))
        .add(&t3.sqr().mul(&at(e)).div(&at(w)));
    match &pole {
        None => density,
        Some((x, below)) => {
            let signed = density.mul(&at(x));
            if *below {
                signed.scale(-Interval::ONE)
            } else {
                signed
            }
        }
    }
}

/// The components `∇II(e₁, e₁, e₁)`, `∇II(e₁, e₁, e₂)`, `∇II(e₁, e₂, e₂)` and `∇II(e₂, e₂, e₂)` of the derivative of the
/// second fundamental form, with e₁ along r_u, from a jet of order 3 or more; `None` where the tangents do not span a
/// plane.
///
/// With `Γ` the part of second derivatives in the tangent plane, `∇II_ijk = n·r_ijk - II(Γ_ij, r_k) - II(Γ_ik, r_j) -
/// II(Γ_jk, r_i)`. Signs are those of [`Curvature`](super::Curvature). Unit: 1 / length².
pub fn curvature_derivative(jet: &SurfaceJet) -> Option<[f64; 4]> {
    let n = jet.normal()?;
    let (ru, rv) = (jet.d[1], jet.d[2]);
    let e1 = ru.normalize();
    let e2 = n.cross(e1);
    // e1 = r_u / a, e2 = (r_v - b e1) / c.
    let (a, b, c) = (ru.dot(e1), rv.dot(e1), rv.dot(e2));
    // A symmetric form of r_u and r_v in the orthonormal basis.
    let second = [n.dot(jet.d[3]), n.dot(jet.d[4]), n.dot(jet.d[5])];
    let p = second[0] / (a * a);
    let q = (second[1] - b * a * p) / (a * c);
    let s = (second[2] - b * b * p - 2.0 * b * c * q) / (c * c);
    let tangent = |k: usize| [jet.d[3 + k].dot(e1), jet.d[3 + k].dot(e2)];
    let along = [[a, 0.0], [b, c]];
    let form = |x: [f64; 2], y: [f64; 2]| {
        p * x[0] * y[0] + q * (x[0] * y[1] + x[1] * y[0]) + s * x[1] * y[1]
    };
    // The number of indices v, of a third derivative with k of them.
    let third = [0, 1, 2, 3].map(|k: usize| {
        let index = [0, 1, 2].map(|i| usize::from(i >= 3 - k));
        let [i, j, l] = index;
        let one = |i: usize, j: usize, l: usize| form(tangent(i + j), along[l]);
        n.dot(jet.d[6 + k]) - one(i, j, l) - one(i, l, j) - one(j, l, i)
    });
    let [uuu, uuv, uvv, vvv] = third;
    let t0 = uuu / (a * a * a);
    let t1 = (uuv / (a * a) - b * t0) / c;
    let t2 = (uvv / a - b * b * t0 - 2.0 * b * c * t1) / (c * c);
    let t3 = (vvv - b * b * b * t0 - 3.0 * b * b * c * t1 - 3.0 * b * c * c * t2) / (c * c * c);
    Some([t0, t1, t2, t3])
}

/// The square of the length of a symmetric form of three arguments.
fn square([a, b, c, d]: [f64; 4]) -> f64 {
    a * a + 3.0 * (b * b + c * c) + d * d
}
