//! How much a surface bends in both directions: the area of its Gauss image.
//!
//! The unit normal n maps a surface to the unit sphere, and `n·(n_u × n_v) = K |r_u × r_v|`: so `∫ |K| dA` is the area
//! that the normal sweeps over, each part as often as it is passed. With any normal vector N that does not vanish
//! `n·(n_u × n_v) = N·(N_u × N_v) / |N|³`. Beside a side u = u₀ that is one point `N = r_u × r_v / (u - u₀)` is smooth, also
//! at the tip of a cone, where curvature has no bound: its tangent planes turn along a curve, which has no area.
//!
//! Source: do Carmo, *Differential geometry of curves and surfaces*, §3.3.

use super::integral::{
    Form, Goal, IntegralOptions, Measured, estimate, halved, integrate, is_close, measured, turning,
};
use super::shape::{exchanged, poles};
use super::size;
use super::taylor::{Patch, Taylor};
use crate::box3::Box3;
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Dir, Elementary, Surface, SurfaceJet};

/// Whether a surface can be laid flat without stretching.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Developable {
    /// It can: its Gaussian curvature is 0 everywhere, as that of a plane or a circular cylinder.
    Proven,
    /// Nothing tells it from one that can: `∫ |K| dA` is at most this, in steradians, and may be 0.
    Within(f64),
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
const DEGREE: usize = 5;
/// In steradians: an area of the Gauss image that is small enough whatever the rest is.
const SMALL: f64 = 1e-9;

/// The total absolute curvature `∫ |K| dA` over the analytic pieces of a surface. What is concentrated in creases or in the
/// tip of a cone is not counted: there the surface is not smooth.
///
/// Proven unless the surface cannot enclose its derivatives or has no tangent plane somewhere (but at sides that are one
/// point it may have none). Cost: at most `options.budget` enclosures of order 8.
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
    let sampled = || {
        estimate(surface, 2, &|d| {
            let jet = SurfaceJet { d: d.into() };
            let area = d[1].cross(d[2]).length();
            [super::curvature(&jet).map_or(0.0, |c| c.gaussian.abs() * area)]
        })[0]
    };
    if !found.is_finite() {
        return TotalCurvature {
            value: sampled(),
            developable: Developable::Unknown,
        };
    }
    let found = Interval::new(found.lo.max(0.0), found.hi);
    let best = if is_close(found) || found.hi <= 2.0 * SMALL {
        f64::NAN
    } else {
        sampled().value
    };
    let developable = match found {
        Interval::ZERO => Developable::Proven,
        _ if found.lo > 0.0 => Developable::No,
        _ => Developable::Within(found.hi),
    };
    let value = match developable {
        Developable::Proven => Measured {
            value: 0.0,
            certainty: Certainty::Exact,
        },
        _ => measured(found, best),
    };
    TotalCurvature { value, developable }
}

/// `n·(n_u × n_v)` over a box.
fn swept(surface: &dyn Surface, uv: [Interval; 2], size: f64) -> Result<Form, usize> {
    let poles = poles(surface, uv, size);
    let centre = uv.map(Interval::mid);
    let (mut patch, across) = match *poles.as_slice() {
        [] => (Patch::new(surface, uv, DEGREE + 2), None),
        [(d, at)] => {
            let mut centre = centre;
            centre[d] = at;
            (Patch::about(surface, uv, centre, DEGREE + 3), Some(d))
        }
        _ => return Err(halved(surface, uv)),
    };
    if across == Some(1) {
        patch.offset.swap(0, 1);
        patch.wide = exchanged(&patch.wide);
        patch.at = exchanged(&patch.at);
    }
    let both = [&patch.wide, &patch.at].map(|jet| normal(jet, across.is_some()));
    let [wide, at] = &both;
    let tight: Vec<Taylor> = wide
        .iter()
        .zip(at)
        .map(|(w, a)| w.clone().tightened(a, patch.offset))
        .collect();
    let [Some(wide), Some(at)] = [tight.as_slice(), at.as_slice()].map(|f| match f {
        [volume, square] => Some(volume.div(&square.mul(&square.sqrt()))),
        _ => None,
    }) else {
        return Err(halved(surface, uv));
    };
    if !wide.is_finite() {
        return Err(match across {
            Some(_) => turning(surface, uv).0,
            None => halved(surface, uv),
        });
    }
    Ok(Form {
        integrands: vec![[wide, at]],
        offset: patch.offset,
        exchanged: across == Some(1),
        absolute: true,
    })
}

/// `N·(N_u × N_v)` and `N·N`, from a jet of order [`DEGREE`] + 2; beside a pole of one order more.
fn normal(jet: &[Box3], pole: bool) -> Vec<Taylor> {
    let each = |a: &[Taylor; 3], f: &dyn Fn(&Taylor) -> Taylor| [0, 1, 2].map(|k| f(&a[k]));
    let u = Taylor::vector(jet, [1, 0], DEGREE + 1);
    let v = if pole {
        each(&Taylor::vector(jet, [0, 1], DEGREE + 2), &|t| t.divided())
    } else {
        Taylor::vector(jet, [0, 1], DEGREE + 1)
    };
    let n = Taylor::cross(&u, &v);
    let [nu, nv] = [Dir::U, Dir::V].map(|dir| each(&n, &|t| t.derivative(dir)));
    let n = each(&n, &|t| t.truncated(DEGREE));
    vec![
        Taylor::dot(&n, &Taylor::cross(&nu, &nv)),
        Taylor::square(&n),
    ]
}
