//! Covers contain the edges they are made for, and have the normal that is asked for.

use crate::shapes::*;
use nappe::body::{CoverError, cover};
use nappe::curve::{Ellipse, EllipseOptions, Line};
use nappe::query::{Finder, FinderOptions};
use nappe::surface::Elementary;
use nappe::{CurveRef, DVec3, Limit};
use std::sync::Arc;

fn circle(center: DVec3, normal: DVec3, radius: f64) -> CurveRef {
    let options = EllipseOptions {
        normal,
        ..EllipseOptions::default()
    };
    Arc::new(Ellipse::new(center, [radius; 2], options).unwrap())
}

#[test]
fn covers_contain_their_edges_and_keep_the_normal() {
    for (scale, o) in [
        (1.0, DVec3::ZERO),
        (1e-6, DVec3::ZERO),
        (1e6, v(1e7, 2e7, -3e6)),
    ] {
        let axis = frame(o);
        let at = |x: f64, y: f64, z: f64| axis.point(scale * v(x, y, z));
        let ring = |z: f64, r: f64| circle(at(0.0, 0.0, z), axis.z(), r * scale);
        for outward in [false, true] {
            let cases: [(Elementary, Vec<CurveRef>); 5] = [
                (
                    Elementary::Plane {
                        origin: at(50.0, 3.0, 2.0),
                        normal: if outward { axis.z() } else { -axis.z() },
                    },
                    vec![ring(2.0, 3.0)],
                ),
                (
                    Elementary::Cylinder {
                        axis,
                        radius: 2.0 * scale,
                        outward,
                    },
                    vec![ring(1.0, 2.0), ring(5.0, 2.0)],
                ),
                (
                    Elementary::Cone {
                        axis,
                        slope: 0.5,
                        outward,
                    },
                    vec![ring(2.0, 1.0)],
                ),
                (
                    Elementary::Sphere {
                        frame: axis,
                        radius: 2.0 * scale,
                        outward,
                    },
                    // Through the poles of the frame.
                    vec![circle(o, axis.x(), 2.0 * scale)],
                ),
                (
                    Elementary::Torus {
                        axis,
                        major: 3.0 * scale,
                        minor: scale,
                        outward,
                    },
                    vec![ring(0.0, 4.0), ring(1.0, 3.0)],
                ),
            ];
            for (form, edges) in cases {
                let surface = cover(&form, &edges).unwrap();
                let rounding = 1e-11 * (scale + o.length());
                let options = FinderOptions {
                    tol: Some(rounding),
                    ..FinderOptions::default()
                };
                let finder = Finder::new(std::slice::from_ref(&surface), options).unwrap();
                for edge in &edges {
                    for k in 0..50 {
                        let p = edge.point(f64::from(k) / 50.0);
                        let found = finder.nearest(p).unwrap();
                        let off = found.point.distance(p);
                        assert!(off <= 2.0 * rounding, "{form:?} {off}");
                    }
                }
                let d = surface.domain();
                let uv = [0, 1].map(|k| d[k].lo + 0.7 * d[k].width());
                let jet = surface.jet(uv, [Limit::Above; 2], 1);
                let (n, c) = (jet.normal().unwrap(), axis.coordinates(jet.point()));
                let away = match form {
                    Elementary::Plane { normal, .. } => normal,
                    Elementary::Sphere { .. } => jet.point() - o,
                    Elementary::Torus { .. } => {
                        let r = c.truncate().length();
                        jet.point() - axis.point(v(c.x, c.y, 0.0) * (3.0 * scale / r))
                    }
                    _ => axis.point(c) - axis.point(v(0.0, 0.0, c.z)),
                };
                let expected = outward || matches!(form, Elementary::Plane { .. });
                assert_eq!(n.dot(away) > 0.0, expected, "{form:?}");
                if scale == 1.0 {
                    let own = surface.elementary().unwrap();
                    assert_eq!(std::mem::discriminant(&own), std::mem::discriminant(&form));
                }
            }
        }
    }
}

#[test]
fn what_has_no_end_is_refused() {
    let plane = Elementary::Plane {
        origin: DVec3::ZERO,
        normal: DVec3::Z,
    };
    assert!(matches!(
        cover(&plane, &[]),
        Err(CoverError::Unbounded { kind: "plane" })
    ));
    let line: CurveRef = Arc::new(Line::new(DVec3::ZERO, DVec3::X).unwrap());
    assert!(cover(&plane, &[line]).is_ok());
}
