//! Coons surfaces: interpolation of all boundary data, the corner report and twists, joins, and the laws.

#![allow(clippy::unwrap_used)]

mod compatibility;
mod interpolation;
mod joins;
mod laws_hold;
mod quintic;

use nappe::basis::{Blending, ExpressionFunctions};
use nappe::curve::{Curve, CurveRef};
use nappe::exact::{NurbsCurve, NurbsSurface};
use nappe::expr::Expr;
use nappe::laws::{self, Random};
use nappe::series::Series;
use nappe::surface::{
    Coons, CoonsError, CoonsOptions, Corner, Cross, Datum, Dir, Estimate, IncompatibleTwists, Side,
    Source, Surface, SurfaceRef, bilinear, check_not_collapsed,
};
use nappe::{Box3, Break, DAffine3, DMat3, DVec3, Interval, Limit, UNIT_BREAKS};
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

const ABOVE: [Limit; 2] = [Limit::Above; 2];

fn vector(random: &mut Random) -> DVec3 {
    DVec3::new(random.unit(), random.unit(), random.unit())
}

/// A Bézier surface whose net is a disturbed grid.
fn patch(seed: u64, degree: [usize; 2], scale: f64, shift: DVec3) -> NurbsSurface {
    let mut random = Random(seed);
    let [p, q] = degree;
    let points: Vec<DVec3> = (0..(p + 1) * (q + 1))
        .map(|k| {
            let grid = DVec3::new((k / (q + 1)) as f64, (k % (q + 1)) as f64, 0.0);
            shift + (grid + vector(&mut random) * 0.6) * scale
        })
        .collect();
    NurbsSurface::bezier(p + 1, &points, None).unwrap()
}

/// A side of a Bézier surface (m = 0) or the m-th derivative across it, as a Bézier curve.
fn boundary(s: &NurbsSurface, side: Side, m: usize) -> CurveRef {
    let [rows, columns] = s.size();
    let net = s.control_points();
    let along_u = side.along() == Dir::U;
    let (length, depth) = if along_u {
        (rows, columns)
    } else {
        (columns, rows)
    };
    // The d-th point from the side.
    let at = |k: usize, d: usize| {
        let d = if side.is_upper() { depth - 1 - d } else { d };
        net[if along_u {
            k * columns + d
        } else {
            d * columns + k
        }]
    };
    let inwards = if side.is_upper() { -1.0 } else { 1.0 };
    let degree = depth - 1;
    let points: Vec<DVec3> = (0..length)
        .map(|k| match m {
            0 => at(k, 0),
            1 => (at(k, 1) - at(k, 0)) * (inwards * degree as f64),
            _ => {
                let by = (degree * (degree - 1)) as f64;
                ((at(k, 2) - at(k, 1)) - (at(k, 1) - at(k, 0))) * by
            }
        })
        .collect();
    Arc::new(NurbsCurve::bezier(&points, None).unwrap())
}

fn sides(s: &NurbsSurface) -> [CurveRef; 4] {
    Side::ALL.map(|side| boundary(s, side, 0))
}

fn given(s: &NurbsSurface) -> [Cross; 4] {
    Side::ALL.map(|side| Cross::Curve(boundary(s, side, 1)))
}

fn coons(sides: &[CurveRef; 4], options: &CoonsOptions) -> Result<Coons, CoonsError> {
    let [s, n, w, e] = sides.clone();
    Coons::new(s, n, w, e, options)
}

fn cubic() -> CoonsOptions {
    CoonsOptions {
        blend: Blending::cubic(),
        ..CoonsOptions::default()
    }
}

fn blendings() -> [Blending; 3] {
    [
        Blending::cubic(),
        Blending::trigonometric(1e-6).unwrap(),
        Blending::trigonometric(1.2).unwrap(),
    ]
}

fn on(side: Side, t: f64) -> [f64; 2] {
    let x = if side.is_upper() { 1.0 } else { 0.0 };
    match side.along() {
        Dir::U => [t, x],
        Dir::V => [x, t],
    }
}

/// The greatest error of the derivative of order m across a side against a curve.
fn error_on(s: &dyn Surface, side: Side, m: usize, want: &dyn Curve) -> f64 {
    (0..=50)
        .map(|k| {
            let t = k as f64 / 50.0;
            let jet = s.jet(on(side, t), ABOVE, m);
            let got = match (m, side.along()) {
                (0, _) => jet.point(),
                (_, Dir::U) => jet.partial(0, 1),
                (_, Dir::V) => jet.partial(1, 0),
            };
            got.distance(want.point(t))
        })
        .fold(0.0, f64::max)
}

fn apart(a: &dyn Surface, b: impl Fn([f64; 2]) -> DVec3) -> f64 {
    let at = |k: usize| [(k / 11) as f64 / 10.0, (k % 11) as f64 / 10.0];
    (0..121)
        .map(|k| a.point(at(k)).distance(b(at(k))))
        .fold(0.0, f64::max)
}

fn at_places(check: impl Fn(f64, DVec3)) {
    for scale in [1e-6, 1.0, 1e6] {
        for shift in [DVec3::ZERO, DVec3::new(1e3, -2e3, 5e2) * scale] {
            check(scale, shift);
        }
    }
}

/// Cross-derivatives of one surface on south and north and of another, changed inside, on west and east.
fn incompatible(scale: f64, shift: DVec3, twists: IncompatibleTwists) -> Result<Coons, CoonsError> {
    let source = patch(8, [4, 4], scale, shift);
    let mut options = CoonsOptions {
        cross: given(&source),
        incompatible_twists: twists,
        ..cubic()
    };
    for side in [Side::West, Side::East] {
        options.cross[side as usize] = Cross::Curve(changed(&source, side, scale));
    }
    coons(&sides(&source), &options)
}

/// The cross-derivative with other derivatives at its ends.
fn changed(source: &NurbsSurface, side: Side, scale: f64) -> CurveRef {
    let c = boundary(source, side, 1).to_nurbs().unwrap();
    let mut points = c.control_points();
    points[1] += DVec3::new(0.3, -0.2, 0.5) * scale;
    Arc::new(NurbsCurve::bezier(&points, None).unwrap())
}

fn gregory(scale: f64, shift: DVec3) -> Coons {
    incompatible(scale, shift, IncompatibleTwists::Gregory).unwrap()
}
