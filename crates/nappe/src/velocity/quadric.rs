//! Quadrics.

use super::round::along;
use super::{FrameRate, Sum, Term};
use crate::surface::{Dir, Quadric, QuadricShape, SurfaceRef};
use std::sync::Arc;

/// How a quadric changes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct QuadricRate {
    /// The velocity of its frame.
    pub frame: FrameRate,
    /// The rates of the semi-axes along x, y and z, as [`Quadric::semi_axes`] gives them.
    pub semi_axes: [f64; 3],
    /// The rates of the ranges of u and v.
    pub range: [[f64; 2]; 2],
}

/// How a parameter runs over its range, measured in a length.
enum Run {
    /// Evenly.
    Even(f64, f64),
    /// Its square root evenly.
    Root(f64, f64),
    /// By rational arcs.
    Arcs(f64, f64),
}

/// A rate that is this much smaller than its parts is rounding.
const ROUNDING: f64 = 1e-13;

/// The velocity of a quadric. In parts of its semi-axes its shape is fixed, so it is stretched with them, and slides along
/// its parameters where their ranges change in these parts.
///
/// Error: the direction along which a range changes that is covered by rational arcs, which do not run evenly.
pub fn quadric(at: &Quadric, rate: &QuadricRate) -> Result<SurfaceRef, Dir> {
    use QuadricShape::*;
    let [a, b, c] = at.semi_axes();
    let [da, db, dc] = rate.semi_axes;
    let runs = match at.shape() {
        Ellipsoid | Sphere => [Run::Arcs(1.0, 0.0), Run::Arcs(1.0, 0.0)],
        Hyperboloid1 | Hyperboloid2 => [Run::Arcs(1.0, 0.0), Run::Arcs(c, dc)],
        EllipticParaboloid => [Run::Arcs(1.0, 0.0), Run::Root(c, dc)],
        HyperbolicParaboloid => [Run::Even(a, da), Run::Even(b, db)],
        Cone => [Run::Arcs(1.0, 0.0), Run::Even(c, dc)],
        Cylinder => [Run::Arcs(1.0, 0.0), Run::Even(1.0, 0.0)],
        ParabolicCylinder => [Run::Even(a, da), Run::Even(1.0, 0.0)],
        HyperbolicCylinder => [Run::Arcs(b, db), Run::Even(1.0, 0.0)],
    };
    let surface: SurfaceRef = Arc::new(at.clone());
    let [x, y, z] = at.frame().directions().map(along);
    let stretch = x * (da / a) + y * (db / b) + z * (dc / c);
    let origin = at.frame().origin();
    let mut terms = vec![Term::image(
        surface.clone(),
        rate.frame.spin() + stretch,
        origin,
    )];
    for (k, (run, dir)) in runs.into_iter().zip([Dir::U, Dir::V]).enumerate() {
        let (Run::Even(unit, grows) | Run::Root(unit, grows) | Run::Arcs(unit, grows)) = run;
        let measured = |(value, rate): (f64, f64)| {
            let (value, own, scaled) = (value / unit, rate / unit, value / unit * (grows / unit));
            let rate = own - scaled;
            let noise = rate.abs() <= ROUNDING * (own.abs() + scaled.abs());
            [value, if noise { 0.0 } else { rate }]
        };
        let [[from, to], [dfrom, dto]] = [at.range()[k], rate.range[k]];
        let [from, to] = [(from, dfrom), (to, dto)].map(measured);
        if from[1] == 0.0 && to[1] == 0.0 {
            continue;
        }
        let root = |[value, rate]: [f64; 2]| match rate {
            0.0 => [value.sqrt(), 0.0],
            _ => [value.sqrt(), rate / (2.0 * value.sqrt())],
        };
        let [[s0, d0], [s1, d1]] = match run {
            Run::Even(..) => [from, to],
            Run::Root(..) => [from, to].map(root),
            Run::Arcs(..) => return Err(dir),
        };
        if !(d0.is_finite() && d1.is_finite()) {
            return Err(dir);
        }
        let width = s1 - s0;
        terms.push(Term::slide(
            surface.clone(),
            dir,
            d0 / width,
            (d1 - d0) / width,
        ));
    }
    Ok(Arc::new(Sum::new(rate.frame.origin, terms)))
}
