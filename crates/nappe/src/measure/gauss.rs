//! How much a surface bends in both directions: the area of its Gauss image.
//!
//! The unit normal n maps a surface to the unit sphere, and `n·(n_u × n_v) = K |r_u × r_v|`: so `∫ |K| dA` is the area
//! that the normal sweeps over, each part as often as it is passed. With any normal vector N that does not vanish
//! `n·(n_u × n_v) = N·(N_u × N_v) / |N|³`. Beside a side u = u₀ that is one point `N = r_u × r_v / (u - u₀)` is smooth, also
//! at the tip of a cone, where curvature has no bound: its tangent planes turn along a curve, which has no area.
//!
//! Source: do Carmo, *Differential geometry of curves and surfaces*, §3.3.

use super::crease::sharpest;
use super::integral::{
    Expansion, Form, Goal, IntegralOptions, Measured, estimate, halved, integrate, is_close,
    measured,
};
use super::model::{Model, cross, dot, square, weight};
use super::shape::{exchanged, poles};
use super::size;
use super::taylor::{Patch, Taylor};
use crate::box3::Box3;
use crate::breaks::Breaks;
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Dir, Elementary, Surface, SurfaceJet};

/// Whether a surface can be laid flat without stretching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Developable {
    /// It can: its Gaussian curvature is 0 everywhere, as that of a plane or a circular cylinder (which a surface is within
    /// rounding, 1e-13 of its size).
    Proven,
    /// Nothing tells it from one that can: `∫ |K| dA` is at most this, in steradians, no more than 1e-6, and may be 0.
    Within(f64),
    /// Its pieces can, within this bound, but there are creases between them: a fold along a straight line can be laid
    /// flat, the rim of a can cannot.
    InPieces(f64),
    /// It cannot: `∫ |K| dA` is greater than 0, by proof.
    No,
    /// Nothing is proven.
    Unknown,
}

/// The total absolute curvature of a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TotalCurvature {
    /// `∫ |K| dA` in steradians, the area that the unit normal sweeps over: 4π for a sphere, 0 if developable. It does not
    /// depend on the surface's size.
    pub value: Measured,
    /// Whether the surface is developable.
    pub developable: Developable,
}

/// The degree of the Taylor polynomials.
const DEGREE: usize = 7;
/// In steradians: an area of the Gauss image that is small enough whatever the rest is.
const SMALL: f64 = 1e-9;
/// In steradians: a greater bound does not say that a surface is developable.
const MOST: f64 = 1e-6;

/// The total absolute curvature `∫ |K| dA` over the analytic pieces of a surface. What is concentrated in creases or in the
/// tip of a cone is not counted: there the surface is not smooth.
///
/// Proven unless the surface cannot enclose its derivatives or has no tangent plane somewhere (but at sides that are one
/// point it may have none). What is a plane or a circular cylinder within rounding has 0. Cost: at most `options.budget`
/// enclosures of order 10 or 11, or one for each analytic piece.
pub fn total_curvature(surface: &dyn Surface, options: &IntegralOptions) -> TotalCurvature {
    if let Some(Elementary::Plane { .. } | Elementary::Cylinder { .. }) = surface.elementary() {
        return TotalCurvature {
            value: Measured {
                value: 0.0,
                certainty: Certainty::Exact,
            },
            developable: Developable::Proven,
        };
    }
    let size = size(surface);
    let integrand = |surface: &dyn Surface, uv: [Interval; 2]| swept(surface, uv, size);
    let goal = Goal {
        least: SMALL,
        ..Goal::one(options)
    };
    let found = integrate(&[surface], &integrand, &goal)[0][0];
    if !found.is_finite() {
        return TotalCurvature {
            value: sampled_sweep(surface),
            developable: Developable::Unknown,
        };
    }
    let found = Interval::new(found.lo.max(0.0), found.hi);
    let best = if is_close(found) || found.hi <= 2.0 * SMALL {
        f64::NAN
    } else {
        sampled_sweep(surface).value
    };
    let developable = match found {
        _ if found.lo > 0.0 => Developable::No,
        _ if found.hi > MOST => Developable::Unknown,
        _ if sharpest(surface).iter().any(Option::is_some) => Developable::InPieces(found.hi),
        // Creases are found by samples: none found is no proof.
        Interval::ZERO if is_smooth(surface) => Developable::Proven,
        _ => Developable::Within(found.hi),
    };
    let value = match found {
        Interval::ZERO => Measured {
            value: 0.0,
            certainty: Certainty::Exact,
        },
        _ => measured(found, best),
    };
    TotalCurvature { value, developable }
}

/// `∫ |K| dA` from samples.
pub(super) fn sampled_sweep(surface: &dyn Surface) -> Measured {
    estimate(surface, 2, &|d| {
        let jet = SurfaceJet { d: d.into() };
        let area = d[1].cross(d[2]).length();
        [super::curvature(&jet).map_or(0.0, |c| c.gaussian.abs() * area)]
    })[0]
}

/// True if the tangents are continuous.
fn is_smooth(surface: &dyn Surface) -> bool {
    let below = |dir| surface.breaks(dir).below(1);
    [Dir::U, Dir::V].into_iter().all(|d| below(d).is_empty())
}

/// `n·(n_u × n_v)` over a box.
fn swept(surface: &dyn Surface, uv: [Interval; 2], size: f64) -> Result<Form, usize> {
    let poles = poles(surface, uv, size);
    let centre = uv.map(Interval::mid);
    let (mut patch, across) = match *poles.as_slice() {
        [] => (Patch::new(surface, uv, DEGREE + 3), None),
        [(d, at)] => {
            let mut centre = centre;
            centre[d] = at;
            (Patch::about(surface, uv, centre, DEGREE + 4), Some(d))
        }
        _ => return Err(halved(surface, uv)),
    };
    if across == Some(1) {
        patch.offset.swap(0, 1);
        patch.wide = exchanged(&patch.wide);
        patch.at = exchanged(&patch.at);
    }
    let ([volume, square], weight) = normal(&patch, across.is_some());
    let swept = volume.div(&square.mul(&square.sqrt()));
    Ok(Form {
        integrands: vec![Expansion::Model(swept)],
        offset: patch.offset,
        exchanged: across == Some(1),
        absolute: true,
        weight: Some(weight),
    })
}

/// `N·(N_u × N_v)` and `N·N`, and how much u and v matter, from a patch of order [`DEGREE`] + 3; beside a pole of one order more.
fn normal(patch: &Patch, pole: bool) -> ([Model; 2], [f64; 2]) {
    let model = |f: &dyn Fn(&[Box3], usize) -> Taylor| {
        [0, 1, 2].map(|axis| {
            let [wide, at] = [&patch.wide, &patch.at].map(|jet| f(jet, axis));
            Model::new(&wide, &at, patch.offset, DEGREE)
        })
    };
    let of_u = |d: [usize; 2]| {
        model(&move |jet, axis| Taylor::coordinate(jet, axis, [1 + d[0], d[1]], DEGREE + 1))
    };
    let of_v = |dir: Option<Dir>| {
        model(&move |jet, axis| {
            let degree = DEGREE + 1 + usize::from(pole) + usize::from(dir.is_some());
            let t = Taylor::coordinate(jet, axis, [0, 1], degree);
            let t = if pole { t.divided() } else { t };
            dir.map_or(t.clone(), |dir| t.derivative(dir))
        })
    };
    let (u, u_u, u_v) = (of_u([0, 0]), of_u([1, 0]), of_u([0, 1]));
    let (v, v_u, v_v) = (of_v(None), of_v(Some(Dir::U)), of_v(Some(Dir::V)));
    let n = cross(&u, &v);
    let product = |a: &[Model; 3], v: &[Model; 3], u: &[Model; 3], b: &[Model; 3]| {
        let (first, second) = (cross(a, v), cross(u, b));
        [0, 1, 2].map(|k| first[k].add(&second[k]))
    };
    let n_u = product(&u_u, &v, &u, &v_u);
    let n_v = product(&u_v, &v, &u, &v_v);
    let swept = dot(&n, &cross(&n_u, &n_v));
    ([swept, square(&n)], weight([&u, &v, &n]))
}
