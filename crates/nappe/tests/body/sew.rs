//! Surfaces sewn along their sides: what is shared, what is closed, what is turned.

use crate::shapes::*;
use nappe::body::{Body, Loop, sew};
use nappe::surface::{Dir, Revolution, RevolutionOptions, SurfaceRef, ruled};
use nappe::{CurveRef, DVec3, Frame, Limit};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Every edge lies on the faces that use it, and runs with the face to its left; the body is sound.
fn check(body: &Body) {
    body.validate(0.0).unwrap();
    for face in &body.faces {
        for l in &face.loops {
            let Loop::Edges(coedges) = l else { continue };
            for c in coedges {
                let curve = &body.edges[c.edge].curve;
                let d = curve.domain();
                let jet = curve.jet(d.lo + 0.3 * d.width(), Limit::Above, 1);
                let mut way = jet.d[1];
                if !c.forward {
                    way = -way;
                }
                // The nearest of many points of the sides, and the middle of the surface.
                let (s, dom) = (face.surface.as_ref(), face.surface.domain());
                let at = |k: usize, i: usize| dom[k].lo + dom[k].width() * i as f64 / 400.0;
                let around = (0..=400).flat_map(|i| {
                    [
                        [at(0, i), dom[1].lo],
                        [at(0, i), dom[1].hi],
                        [dom[0].lo, at(1, i)],
                        [dom[0].hi, at(1, i)],
                    ]
                });
                // A step inwards from the side, taken in the parameters, is to the left of at least one nearest point:
                // of both at a seam that is used in both directions.
                let near = around
                    .map(|uv| (s.point(uv).distance(jet.d[0]), uv))
                    .min_by(|a, b| a.0.total_cmp(&b.0))
                    .unwrap();
                let size = s.bounds(dom).diagonal();
                assert!(near.0 <= 0.02 * size, "{} of {size}", near.0);
                let uses = coedges.iter().filter(|o| o.edge == c.edge).count();
                if uses == 1 {
                    let uv = near.1;
                    let inside = [0, 1].map(|k| uv[k] + 1e-3 * (dom[k].mid() - uv[k]));
                    let normal = s.jet(inside, [Limit::Above; 2], 1).normal().unwrap();
                    let normal = if face.forward { normal } else { -normal };
                    let inward = s.point(inside) - s.point(uv);
                    assert!(normal.cross(way).dot(inward) > 0.0);
                }
            }
        }
    }
}

/// Vertices, edges, faces.
fn count(body: &Body) -> [usize; 3] {
    [body.vertices.len(), body.edges.len(), body.faces.len()]
}

#[test]
fn six_faces_make_a_box_at_all_scales_and_places() {
    let faces = cuboid(v(1.0, 2.0, 3.0));
    for (scale, by) in [
        (1.0, DVec3::ZERO),
        (1e-6, DVec3::ZERO),
        (1e6, v(-3e6, 1e7, 2.0)),
        (1.0, v(1e5, -2e5, 3e5)),
    ] {
        let sewn = sew(&moved(&faces, scale, by), 1e-6 * scale);
        check(&sewn.body);
        assert_eq!(count(&sewn.body), [8, 12, 6]);
        assert!(sewn.gap <= 1e-13 * (scale + by.length()) * 4.0);
        assert_eq!(sewn.body.shells.len(), 1);
        assert!(sewn.body.shells[0].closed);
        assert!(sewn.body.shells[0].faces.iter().all(|f| f.1));
        // Every normal points away from the middle.
        let middle = by + scale * v(0.5, 1.0, 1.5);
        for face in &sewn.body.faces {
            let jet = face.surface.jet([0.5; 2], [Limit::Above; 2], 1);
            let out = jet.normal().unwrap().dot(jet.point() - middle) > 0.0;
            assert_eq!(out, face.forward);
        }
        for uses in sewn.body.uses() {
            assert_eq!(uses.len(), 2);
            assert_ne!(uses[0].1, uses[1].1);
        }
    }
    // Without a lid it is open along four edges, and faces still agree.
    let sewn = sew(&faces[1..], 1e-6);
    check(&sewn.body);
    assert_eq!(count(&sewn.body), [8, 12, 5]);
    assert!(!sewn.body.shells[0].closed);
    let uses = sewn.body.uses();
    assert_eq!(uses.iter().filter(|u| u.len() == 1).count(), 4);
    assert!(uses.iter().all(|u| u.len() == 1 || u[0].1 != u[1].1));
    assert!(sew(&[], 1.0).body.faces.is_empty());
}

#[test]
fn closed_surfaces_use_their_seams_twice() {
    let ball = sew(&[sphere(v(1.0, 2.0, 3.0), 2.0)], 1e-6);
    check(&ball.body);
    // From pole to pole along one meridian and back.
    assert_eq!(count(&ball.body), [2, 1, 1]);
    assert!(ball.body.shells[0].closed);
    let ring = sew(&[torus(DVec3::ZERO, 3.0, 1.0)], 1e-6);
    check(&ring.body);
    assert_eq!(count(&ring.body), [1, 2, 1]);
    assert!(ring.body.shells[0].closed);
    // A pipe has two circles and a seam, and is open.
    let line: CurveRef =
        Arc::new(nappe::curve::Line::new(v(1.0, 0.0, 0.0), v(1.0, 0.0, 2.0)).unwrap());
    let pipe: SurfaceRef =
        Arc::new(Revolution::new(line, Frame::WORLD, RevolutionOptions::default()).unwrap());
    let pipe = sew(&[pipe], 1e-6);
    check(&pipe.body);
    assert_eq!(count(&pipe.body), [2, 3, 1]);
    assert!(!pipe.body.shells[0].closed);
}

#[test]
fn closed_shells_are_turned_outwards() {
    for inner in [false, true] {
        let ball = sphere(DVec3::ZERO, 1.0);
        let ball = if inner {
            let swapped = nappe::surface::Swapped::new(ball);
            Arc::new(swapped) as SurfaceRef
        } else {
            ball
        };
        let outward = {
            let d = ball.domain();
            let jet = ball.jet([d[0].mid() + 0.1, d[1].mid() + 0.1], [Limit::Above; 2], 1);
            jet.normal().unwrap().dot(jet.point()) > 0.0
        };
        let sewn = sew(&[ball], 1e-6);
        assert_eq!(sewn.body.faces[0].forward, outward);
    }
}

/// A long side that three short ones meet is cut at their ends; a body with such joints closes.
#[test]
fn long_sides_are_cut_where_short_ones_end() {
    // A box of which the top is three strips.
    let [y, z] = [DVec3::Y * 2.0, DVec3::Z];
    let mut faces = cuboid(v(3.0, 2.0, 1.0));
    faces.remove(1);
    for (from, width) in [(0.0, 1.0), (1.0, 0.5), (1.5, 1.5)] {
        faces.push(quad(z + DVec3::X * from, DVec3::X * width, y));
    }
    let sewn = sew(&faces, 1e-6);
    check(&sewn.body);
    assert!(sewn.unsewn.is_empty());
    // Two sides cut in three: 8 + 4 vertices, 12 + 4 edges and two between the strips.
    assert_eq!(count(&sewn.body), [12, 18, 8]);
    assert!(sewn.body.shells[0].closed);
    assert_eq!(sewn.body.shells.len(), 1);
}

/// Two closed sides that start at different points share two edges.
#[test]
fn circles_with_other_starts_are_cut_twice() {
    let pipe = |turn: f64, z: f64| -> SurfaceRef {
        let (s, c) = turn.sin_cos();
        let line: CurveRef =
            Arc::new(nappe::curve::Line::new(v(c, s, z), v(c, s, z + 2.0)).unwrap());
        let options = RevolutionOptions::default();
        Arc::new(Revolution::new(line, Frame::WORLD, options).unwrap())
    };
    for turn in [1.0, 4.0] {
        let sewn = sew(&[pipe(0.0, 0.0), pipe(turn, 2.0)], 1e-6);
        check(&sewn.body);
        assert!(sewn.unsewn.is_empty());
        // Two seams, two free circles, and one circle in two halves.
        assert_eq!(count(&sewn.body), [4, 6, 2]);
        assert_eq!(sewn.body.shells.len(), 1);
        let shared: f64 = sewn
            .body
            .uses()
            .iter()
            .zip(&sewn.body.edges)
            .filter(|(u, _)| u.len() == 2 && u[0].0 != u[1].0)
            .map(|(_, e)| {
                let d = e.curve.domain();
                let at = |k: usize| e.curve.point(d.lo + d.width() * k as f64 / 1000.0);
                (0..1000).map(|k| at(k).distance(at(k + 1))).sum::<f64>()
            })
            .sum();
        assert!((shared - TAU).abs() < 1e-4, "{shared}");
    }
}

#[test]
fn a_strip_with_one_side_is_told() {
    let half = |a: f64| {
        let (s, c) = a.sin_cos();
        let (t, d) = (0.5 * a).sin_cos();
        [-0.3, 0.3].map(|w| v((2.0 + w * d) * c, (2.0 + w * d) * s, w * t))
    };
    let strip: Vec<SurfaceRef> = (0..6)
        .map(|k| {
            let [a, b] = [k, k + 1].map(|k| half(TAU * f64::from(k) / 6.0));
            let line = |p, q| -> CurveRef { Arc::new(nappe::curve::Line::new(p, q).unwrap()) };
            Arc::new(ruled(line(a[0], b[0]), line(a[1], b[1]), Dir::U).unwrap()) as SurfaceRef
        })
        .collect();
    let sewn = sew(&strip, 1e-6);
    assert_eq!(sewn.one_sided, [0]);
    assert!(!sewn.body.shells[0].closed);
    assert_eq!(sewn.body.shells[0].faces.len(), 6);
}

#[test]
fn three_sheets_at_one_edge_are_no_shell_together() {
    let z = DVec3::Z;
    let sheets = [v(1.0, 0.0, 0.0), v(-1.0, 1.0, 0.0), v(-1.0, -1.0, 0.0)]
        .map(|way| quad(DVec3::ZERO, z, way));
    let sewn = sew(&sheets, 1e-6);
    check(&sewn.body);
    assert_eq!(sewn.body.edges.len(), 10);
    assert!(sewn.body.shells.iter().all(|s| !s.closed));
    let most = sewn.body.uses().iter().map(Vec::len).max();
    assert_eq!(most, Some(3));
}
