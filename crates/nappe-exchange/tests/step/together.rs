//! Surfaces without an exact form: their splines have the edges that they share.

use crate::sewn;
use nappe::curve::{ExpressionCurve, Trimmed};
use nappe::expr::Expr;
use nappe::query::{Finder, FinderOptions};
use nappe::surface::{Coons, CoonsOptions, SurfaceRef};
use nappe::{CurveRef, DVec3, Units};
use nappe_exchange::ItemForm;
use nappe_exchange::step::{self, Schema, StepOptions};
use std::sync::Arc;

fn curve(x: &str, y: &str, z: &str, size: f64) -> CurveRef {
    let expr = |s: &str| {
        let text = format!("{size:e}*({s})");
        Expr::parse(&text).unwrap().bind(&["t"], &[]).unwrap()
    };
    Arc::new(ExpressionCurve::new([expr(x), expr(y), expr(z)], [0.0, 1.0]).unwrap())
}

/// Four patches over squares of a plane whose sides are on z = sin(2 x) cos(3 y), one with u and v exchanged, one turned about.
fn quilt(size: f64) -> Vec<SurfaceRef> {
    let along_x = |i: usize, j: usize| {
        let z = format!("sin(2*({i}+t))*cos(3*{j})");
        curve(&format!("{i}+t"), &format!("0*t+{j}"), &z, size)
    };
    let along_y = |i: usize, j: usize| {
        let z = format!("sin(2*{i})*cos(3*({j}+t))");
        curve(&format!("0*t+{i}"), &format!("{j}+t"), &z, size)
    };
    let patch = |k: usize| -> SurfaceRef {
        let (i, j) = (k / 2, k % 2);
        let back = |c: CurveRef| -> CurveRef { Arc::new(Trimmed::reversed(c)) };
        let (south, north) = (along_x(i, j), along_x(i, j + 1));
        let (west, east) = (along_y(i, j), along_y(i + 1, j));
        let [a, b, c, d] = match k {
            1 => [back(south), back(north), east, west],
            2 => [west, east, south, north],
            _ => [south, north, west, east],
        };
        Arc::new(Coons::new(a, b, c, d, &CoonsOptions::default()).unwrap())
    };
    (0..4).map(patch).collect()
}

#[test]
fn edges_lie_on_all_their_surfaces_however_large_the_tolerance_is() {
    let dir = tempfile::tempdir().unwrap();
    for size in [1.0, 1e-3, 1e4] {
        for share in [1e-2, 1e-5] {
            let surfaces = quilt(size);
            let document = sewn(&surfaces, Units::Millimetre);
            let path = dir.path().join("a.step");
            let options = StepOptions {
                schema: Schema::Ap242,
                tolerance: share * size,
            };
            let report = step::write(&path, &document, &options).unwrap();
            assert_eq!(report.approximated, 4);
            assert!(report.certainty.error() <= options.tolerance);
            let file = step::read(&std::fs::read(&path).unwrap()).unwrap();
            assert_eq!(file.document.left_out, []);
            let ItemForm::Body { body, .. } = &file.document.items[0].form else {
                panic!()
            };
            assert_eq!((body.faces.len(), body.edges.len()), (4, 12));
            let ItemForm::Body { body: old, .. } = &document.items[0].form else {
                panic!()
            };
            let options = FinderOptions {
                tol: Some(1e-13 * size),
                ..FinderOptions::default()
            };
            for (i, face) in body.faces.iter().enumerate() {
                let find = |s: &SurfaceRef| Finder::new(std::slice::from_ref(s), options);
                let finder = find(&face.surface).unwrap();
                for l in &face.loops {
                    let nappe::body::Loop::Edges(coedges) = l else {
                        panic!()
                    };
                    for c in coedges {
                        let edge = &body.edges[c.edge].curve;
                        let d = edge.domain();
                        for k in 0..=20 {
                            let p = edge.point(d.lo + d.width() * f64::from(k) / 20.0);
                            let far = finder.nearest(p).unwrap().distance;
                            assert!(far <= 2e-12 * size, "{size} {share} face {i}: {far:e}");
                        }
                    }
                }
                // And the surface is the one that was written.
                let finder = find(&old.faces[i].surface).unwrap();
                for uv in [[0.1, 0.2], [0.5, 0.5], [0.9, 0.3]] {
                    let [u, v] = face.surface.domain();
                    let uv = [u.lo + u.width() * uv[0], v.lo + v.width() * uv[1]];
                    let p: DVec3 = face.surface.point(uv);
                    let far = finder.nearest(p).unwrap().distance;
                    assert!(far <= share * size, "{size} {share} face {i}: {far:e}");
                }
            }
        }
    }
}
