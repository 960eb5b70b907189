//! How evenly the curvature of a surface varies.

use super::apex::apexes;
use super::integral::{
    Expansion, Form, Goal, IntegralOptions, Measured, estimate, integrate, is_close, measured,
    turning,
};
use super::model::{Model, cross, dot, square, weight};
use super::shape::{Shape, ShapeForm, poles};
use super::size;
use super::taylor::{Patch, Taylor};
use super::twin::Twin;
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Dir, Elementary, Surface, SurfaceJet};

/// The degree of the models where there is no pole.
const MODEL: usize = 6;
/// Beside a pole, the degree of the shape operator's polynomials. One derivative, and one division beside a pole, take two away.
const DEGREE: usize = 8;
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
/// derivatives or has no tangent plane somewhere. What is a plane or a
/// circular cylinder within rounding has 0. Cost: at most `options.budget` enclosures of order 10 (beside a pole 12), or one
/// for each analytic piece.
pub fn curvature_variation(surface: &dyn Surface, options: &IntegralOptions) -> Measured {
    if let Some(Elementary::Plane { .. } | Elementary::Cylinder { .. }) = surface.elementary() {
        return Measured {
            value: 0.0,
            certainty: Certainty::Exact,
        };
    }
    let size = size(surface);
    if !apexes(surface, size).is_empty() {
        return Measured {
            value: f64::INFINITY,
            certainty: Certainty::Exact,
        };
    }
    let integrand = |surface: &dyn Surface, uv: [Interval; 2]| {
        if poles(surface, uv, size).is_empty() {
            let patch = Patch::new(surface, uv, MODEL + 4);
            let (variation, weight) = model(&patch);
            return Ok(Form {
                integrands: vec![Expansion::Model(variation)],
                offset: patch.offset,
                exchanged: false,
                absolute: false,
                weight: Some(weight),
            });
        }
        let form = ShapeForm::new(surface, uv, size, DEGREE)?;
        let variation = variation(&form);
        if !variation.is_finite() {
            return Err(turning(surface, uv).0);
        }
        Ok(Form {
            integrands: vec![Expansion::Enclosed(variation.into_pair())],
            offset: form.offset,
            exchanged: form.exchanged,
            absolute: false,
            weight: None,
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
    if !found.is_finite() {
        return sampled_variation(surface);
    }
    let found = Interval::new(found.lo.max(0.0), found.hi.max(0.0));
    let close = is_close(found) || found.hi <= 2.0 * goal.least;
    measured(
        found,
        if close {
            f64::NAN
        } else {
            sampled_variation(surface).value
        },
    )
}

/// `|∇II|² dA` beside a pole.
///
/// In the orthonormal basis e₁ = r_u / |r_u|, e₂ of the shape operator `[[p, q], [q, s]]`, which turns by ω:
/// `∇II(e₁, e₁, x) = x p - 2 ω(x) q`, `∇II(e₁, e₂, x) = x q - ω(x) (s - p)` and `∇II(e₂, e₂, x) = x s + 2 ω(x) q`. All but
/// `∇II(e₂, e₂, e₂)` are needed along e₁ alone, where a pole does no harm.
fn variation(form: &ShapeForm) -> Twin {
    let twin = |of: fn(&Shape) -> &Taylor| {
        Twin::new([&form.wide, &form.at].map(|s| of(s).clone()), form.offset)
    };
    let (p, q, s) = (twin(|s| &s.p), twin(|s| &s.q), twin(|s| &s.s));
    let (e, f) = (twin(|s| &s.e), twin(|s| &s.f));
    let (n2, w) = (twin(|s| &s.n2), twin(|s| &s.w));
    let x = Twin::variable(form.offset, DEGREE);
    let [e_u, e_v] = [Dir::U, Dir::V].map(|d| e.derivative(d).scale(0.5));
    // r_uu·ρ and r_uv·ρ, from derivatives of the metric: r_u·r_uv = f + (u - u₀) r_u·ρ_u.
    let g = n2.add(&f.sqr()).div(&e);
    let a_u = f.derivative(Dir::U).sub(&e_v.sub(&f).divided());
    let a_v = g.add(&x.mul(&g.derivative(Dir::U).scale(0.5)));
    // How the basis turns along u and along v.
    let lean = f.div(&e);
    let turn = |a: &Twin, e: &Twin| a.sub(&lean.mul(e)).div(&w);
    let (turn_u, turn_v) = (turn(&a_u, &e_u), turn(&a_v, &e_v));
    let twist = turn_u.mul(&q).scale(2.0);
    let t0 = p.derivative(Dir::U).sub(&twist);
    let t1 = q.derivative(Dir::U).sub(&turn_u.mul(&s.sub(&p)));
    let t2 = s.derivative(Dir::U).add(&twist);
    let across = s.derivative(Dir::V).add(&turn_v.mul(&q).scale(2.0));
    let t3 = across.divided().sub(&lean.mul(&t2));
    let sum = t0.sqr().add(&t1.sqr().add(&t2.sqr()).scale(3.0));
    // |∇II|² |r_u × ρ|
    let density = sum.mul(&w).div(&e).add(&t3.sqr().mul(&e).div(&w));
    // An offset from 0 may be rounded to a little less.
    let below = form.offset[0].mid() < 0.0;
    density.mul(&x).scale(if below { -1.0 } else { 1.0 })
}

/// `|∇II|² dA` where `r_u × r_v` does not vanish, from a patch of order [`MODEL`] + 4.
///
/// As [`curvature_derivative`], all of it multiplied with `w = |r_u × r_v|`: with v' = r_v - (f / e) r_u square to r_u, of
/// length w / √e.
fn model(patch: &Patch) -> (Model, [f64; 2]) {
    let vector = |i: usize, j: usize| {
        [0, 1, 2].map(|axis| {
            let jets = [&patch.wide, &patch.at];
            let [wide, at] = jets.map(|jet| Taylor::coordinate(jet, axis, [i, j], MODEL + 1));
            Model::new(&wide, &at, patch.offset, MODEL)
        })
    };
    let (u, v) = (vector(1, 0), vector(0, 1));
    let n = cross(&u, &v);
    let (e, f, g) = (square(&u), dot(&u, &v), square(&v));
    let n2 = square(&n);
    // n·r_uu, n·r_uv, n·r_vv, and the tangent parts α r_u + β r_v of these derivatives.
    let second = [vector(2, 0), vector(1, 1), vector(0, 2)];
    let form = second.each_ref().map(|r| dot(&n, r));
    let tangent = second.each_ref().map(|r| {
        let (a, b) = (dot(r, &u), dot(r, &v));
        let alpha = g.mul(&a).sub(&f.mul(&b)).div(&n2);
        let beta = e.mul(&b).sub(&f.mul(&a)).div(&n2);
        [alpha, beta]
    });
    // The form of a tangent part and a tangent vector, by their numbers of derivatives along v.
    let bent = |k: usize, l: usize| {
        let [alpha, beta] = &tangent[k];
        alpha.mul(&form[l]).add(&beta.mul(&form[l + 1]))
    };
    let third = |k: usize| dot(&n, &vector(3 - k, k));
    let uuu = third(0).sub(&bent(0, 0).scale(3.0));
    let uuv = third(1).sub(&bent(0, 1)).sub(&bent(1, 0).scale(2.0));
    let uvv = third(2).sub(&bent(2, 0)).sub(&bent(1, 1).scale(2.0));
    let vvv = third(3).sub(&bent(2, 1).scale(3.0));
    // v replaced by v', one place after the other.
    let lean = f.div(&e);
    let less = |a: &Model, b: &Model| a.sub(&lean.mul(b));
    let (uu, uv, vv) = (less(&uuv, &uuu), less(&uvv, &uuv), less(&vvv, &uvv));
    let (u2, v2) = (less(&uv, &uu), less(&vv, &uv));
    let last = less(&v2, &u2);
    // |∇II|² = (t0²/e³ + 3 t1²/(e n2) + 3 t2² e/n2² + t3² e³/n2³) / n2
    let ratio = e.div(&n2);
    let squares = [&uuu, &uu, &u2, &last].map(Model::sqr);
    let e2 = e.sqr();
    let sum = squares[0]
        .div(&e2.mul(&e))
        .add(&squares[1].scale(3.0).div(&e.mul(&n2)))
        .add(&squares[2].scale(3.0).mul(&ratio).div(&n2))
        .add(&squares[3].mul(&ratio).mul(&ratio.sqr()));
    (sum.div(&n2.sqrt()), weight([&u, &v, &n]))
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

/// The variation of curvature from samples.
pub(super) fn sampled_variation(surface: &dyn Surface) -> Measured {
    estimate(surface, 3, &|d| {
        let jet = SurfaceJet { d: d.into() };
        let area = d[1].cross(d[2]).length();
        [curvature_derivative(&jet).map_or(0.0, |t| length2(t) * area)]
    })[0]
}

/// The square of the length of a symmetric form of three arguments.
fn length2([a, b, c, d]: [f64; 4]) -> f64 {
    a * a + 3.0 * (b * b + c * c) + d * d
}
