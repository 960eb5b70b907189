//! Areas and volumes of trimmed faces against closed forms, and of their images under maps.

use crate::mesh::{Maker, SCALES, cut_cylinder, plane};
use crate::shapes::*;
use nappe::body::{Body, BodyError, BodyMeshError, FaceError, RegionError, figures, mesh, sew};
use nappe::curve::{CurveRef, ExpressionCurve, Line};
use nappe::expr::Expr;
use nappe::surface::{Elementary, bilinear, ruled};
use nappe::{DAffine3, DMat3, DVec3, Dir, Frame, MeshOptions};
use std::f64::consts::{PI, TAU};
use std::sync::Arc;

/// To a share of 10⁻⁸, and within the error that is stated; `size` is that of the coordinates, squared or cubed.
fn near(m: nappe::measure::Measured, exact: f64, rounding: f64) {
    let off = (m.value - exact).abs();
    assert!(
        off <= 1e-8 * exact.abs() + rounding,
        "{} is not {exact}",
        m.value
    );
    let stated = m.certainty.error() + 1e-11 * exact.abs() + rounding;
    assert!(off <= stated, "{off:e} > {stated:e}");
}

fn areas(body: &Body, expected: &[f64], rounding: f64) {
    let found = figures(body).unwrap();
    assert_eq!(found.areas.len(), expected.len());
    for (a, &e) in found.areas.iter().zip(expected) {
        near(a.clone().unwrap(), e, rounding);
    }
}

#[test]
fn trimmed_areas_are_those_of_closed_forms() {
    for (s, o) in SCALES {
        // Rounding of coordinates far away.
        let rounding = 1e-14 * o.length() * s;
        let f = Frame::new(o, v(0.3, 0.2, 1.0), DVec3::X).unwrap();
        let h = 0.5f64;
        let mut m = Maker::default();
        m.circle(f.point(DVec3::Z * (h * s)), f.z(), s * (1.0 - h * h).sqrt());
        let ball = Elementary::Sphere {
            frame: f,
            radius: s,
            outward: true,
        };
        m.face(ball, true, &[&[1]]);
        m.face(ball, true, &[&[-1]]);
        let cone = Elementary::Cone {
            axis: f,
            slope: 3.0f64.sqrt(),
            outward: true,
        };
        // r = √3/2 at height 1/2: slant 1, area π r.
        m.face(cone, true, &[&[-1]]);
        let s2 = s * s;
        let cap = TAU * (1.0 - h) * s2;
        areas(
            &m.body,
            &[cap, 4.0 * PI * s2 - cap, PI * 0.75f64.sqrt() * s2],
            100.0 * rounding,
        );
    }
}

/// A cylinder between a floor and an oblique ellipse: area 2 π r h of its mean height, volume π r² h; moved, mirrored.
#[test]
fn a_closed_shell_has_its_volume() {
    for (s, o) in SCALES {
        let mut m = cut_cylinder(s, o);
        m.body.shells.push(nappe::body::Shell {
            faces: vec![(0, true), (1, true), (2, true)],
            closed: true,
        });
        let rounding = 1e-13 * o.length() * s;
        let s2 = s * s;
        let expected = [PI * s2, 4.0 * PI * s2, PI * s2 * 1.25f64.sqrt()];
        areas(&m.body, &expected, rounding);
        let volume = |body: &Body| figures(body).unwrap().volumes[0].unwrap();
        near(volume(&m.body), 2.0 * PI * s.powi(3), rounding * s);
        let mirror = DMat3::from_diagonal(v(-1.0, 2.0, 3.0));
        let image = m.body.transformed(&DAffine3::from_mat3(mirror)).unwrap();
        assert_eq!(image.counts(), m.body.counts());
        near(volume(&image), 12.0 * PI * s.powi(3), 30.0 * rounding * s);
    }
}

#[test]
fn sewn_bodies_have_their_volume() {
    let ball = sew(&[sphere(v(1.0, 2.0, 3.0), 2.0)], 1e-6).body;
    let found = figures(&ball).unwrap();
    near(found.areas[0].clone().unwrap(), 16.0 * PI, 0.0);
    near(found.volumes[0].unwrap(), 32.0 / 3.0 * PI, 0.0);
    let ring = sew(&[torus(DVec3::ZERO, 3.0, 1.0)], 1e-6).body;
    let found = figures(&ring).unwrap();
    near(found.areas[0].clone().unwrap(), 12.0 * PI * PI, 0.0);
    near(found.volumes[0].unwrap(), 6.0 * PI * PI, 0.0);
    let found = figures(&sew(&cuboid(v(1.0, 2.0, 3.0)), 1e-6).body).unwrap();
    near(found.volumes[0].unwrap(), 6.0, 0.0);
    let lid = sew(&cuboid(v(1.0, 2.0, 3.0))[1..], 1e-6).body;
    assert!(figures(&lid).unwrap().volumes[0].is_none());
}

/// Tetrahedra of triangles that are patches with a side of one point: any of the four sides.
#[test]
fn any_side_of_a_face_may_be_one_point() {
    for (scale, o) in SCALES {
        let rounding = 1e-13 * o.length() * scale;
        let [a, b, c, d] = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| o + p * scale);
        for turn in 0..4 {
            let patch = |[p, q, r]: [DVec3; 3]| {
                let mut round = [p, q, r, r];
                round.rotate_left(turn);
                let [sw, se, ne, nw] = round;
                let quad: nappe::SurfaceRef = Arc::new(bilinear([[sw, nw], [se, ne]]).unwrap());
                quad
            };
            let faces = [[a, c, b], [a, b, d], [a, d, c], [b, c, d]].map(patch);
            let body = sew(&faces, 1e-6 * scale).body;
            let s2 = scale * scale;
            let sloping = 0.75f64.sqrt();
            areas(
                &body,
                &[0.5, 0.5, 0.5, sloping].map(|e| e * s2),
                rounding * scale,
            );
            let volume = figures(&body).unwrap().volumes[0].unwrap();
            near(volume, s2 * scale / 6.0, rounding * s2);
            let triangles = mesh(&body, &MeshOptions::default()).unwrap();
            assert!(triangles.failed.is_empty(), "{turn}");
        }
    }
}

/// Adds a closed polygon; the numbers of its edges, from 1 on.
fn polygon(m: &mut Maker, points: &[DVec3]) -> Vec<i32> {
    (0..points.len())
        .map(|k| m.line(points[k], points[(k + 1) % points.len()]) as i32 + 1)
        .collect()
}

fn square(o: DVec3, side: f64) -> [DVec3; 4] {
    [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| o + side * v(x, y, 0.0))
}

/// The curve of one side of a square ends before its vertex. A small gap is closed and is in the error, on whichever
/// side it is; a large one is no contour.
#[test]
fn edges_that_do_not_meet_are_joined_or_refused() {
    for (s, o) in SCALES {
        let rounding = 1e-13 * o.length() * s;
        for side in 0..4 {
            for end in 0..2 {
                let of = |gap: f64| {
                    let mut m = Maker::default();
                    let p = square(o, s);
                    let all = polygon(&mut m, &p);
                    m.face(plane(o, DVec3::Z), true, &[&all]);
                    let mut ends = [p[side], p[(side + 1) % 4]];
                    ends[end] += gap * (ends[1 - end] - ends[end]);
                    m.body.edges[side].curve = Arc::new(Line::new(ends[0], ends[1]).unwrap());
                    m.body
                };
                let small = of(1e-3);
                let found = figures(&small).unwrap().areas[0].clone().unwrap();
                near(found, s * s, 100.0 * rounding);
                let e = found.certainty.error();
                assert!((1e-3..1e-2).contains(&(e / (s * s))), "{e:e}");
                let mut large = of(0.5);
                let found = figures(&large).unwrap();
                let refused =
                    |e: &FaceError| matches!(e, FaceError::Edge { edge, .. } if *edge == side);
                assert!(found.areas[0].as_ref().is_err_and(refused));
                // Unless it is said to be as rough as that.
                large.edges[side].tolerance = 0.5 * s * (1.0 + 1e-9);
                let found = figures(&large).unwrap().areas[0].clone().unwrap();
                near(found, s * s, 100.0 * rounding);
                assert!(found.certainty.error() >= 0.5 * s * s);
            }
        }
    }
}

/// Loops that cross, holes outside and islands bound nothing, as for meshes.
#[test]
fn loops_that_bound_no_region_have_no_area() {
    let o = DVec3::ZERO;
    let back = |p: [DVec3; 4]| [p[3], p[2], p[1], p[0]];
    let far = |x: f64| v(x, 0.0, 0.0);
    let bow = [o, v(2.0, 2.0, 0.0), v(2.0, 0.0, 0.0), v(0.0, 1.0, 0.0)];
    let inner = v(1.0, 1.0, 0.0);
    let middle = v(2.0, 2.0, 0.0);
    let all: [Vec<[DVec3; 4]>; 4] = [
        vec![bow],
        vec![square(o, 2.0), back(square(far(4.0), 1.0))],
        vec![
            square(o, 6.0),
            back(square(inner, 4.0)),
            square(middle, 1.0),
        ],
        vec![square(o, 2.0), back(square(inner, 2.0))],
    ];
    for loops in all {
        let mut m = Maker::default();
        let edges: Vec<Vec<i32>> = loops.iter().map(|l| polygon(&mut m, l)).collect();
        let edges: Vec<&[i32]> = edges.iter().map(|l| &l[..]).collect();
        m.face(plane(o, DVec3::Z), true, &edges);
        let found = figures(&m.body).unwrap().areas[0].clone();
        assert!(
            matches!(found, Err(FaceError::Region(RegionError::Crosses { .. }))),
            "{found:?}"
        );
        let meshed = mesh(&m.body, &MeshOptions::default()).unwrap();
        assert_eq!(meshed.failed.len(), 1);
    }
    // A hole within is sound; a loop the wrong way round is told, and encloses nothing with others.
    let mut m = Maker::default();
    let outer = polygon(&mut m, &square(o, 6.0));
    let hole = polygon(&mut m, &back(square(inner, 4.0)));
    m.face(plane(o, DVec3::Z), true, &[&outer, &hole]);
    let turned: Vec<i32> = outer.iter().rev().map(|e| -e).collect();
    m.face(plane(o, DVec3::Z), true, &[&turned]);
    areas(&m.body, &[20.0, 36.0], 0.0);
    assert_eq!(figures(&m.body).unwrap().turned_round, [1]);
}

/// Whatever a shell says of itself.
#[test]
fn shells_that_are_not_closed_have_no_volume() {
    let sound = sew(&cuboid(v(1.0, 2.0, 3.0)), 1e-6).body;
    let volume = |change: &dyn Fn(&mut Body)| {
        let mut body = sound.clone();
        change(&mut body);
        assert!(body.shells[0].closed);
        figures(&body).unwrap().volumes[0]
    };
    near(volume(&|_| {}).unwrap(), 6.0, 0.0);
    let all = |b: &mut Body| b.shells[0].faces.iter_mut().for_each(|f| f.1 = !f.1);
    near(volume(&all).unwrap(), -6.0, 0.0);
    // The same solid with one face, and what bounds it, the other way round in the list of faces.
    let face = |b: &mut Body| {
        b.faces[2].turn();
        let used = b.shells[0].faces.iter_mut().find(|f| f.0 == 2).unwrap();
        used.1 = !used.1;
    };
    near(volume(&face).unwrap(), 6.0, 0.0);
    let broken: [&dyn Fn(&mut Body); 5] = [
        &|b| b.shells[0].faces.truncate(5),
        &|b| b.shells[0].faces[3].1 = !b.shells[0].faces[3].1,
        &|b| b.shells[0].faces.extend_from_within(..1),
        &|b| b.shells[0].faces.clear(),
        &|b| b.faces[1].turn(),
    ];
    for (k, change) in broken.iter().enumerate() {
        assert_eq!(volume(change), None, "{k}");
    }
    // Twice the same sphere leaves no edge open either.
    let mut ball = sew(&[sphere(DVec3::ZERO, 1.0)], 1e-6).body;
    let faces = &mut ball.shells[0].faces;
    faces.push((faces[0].0, !faces[0].1));
    assert_eq!(figures(&ball).unwrap().volumes[0], None);
}

/// Sheets over a profile that varies too fast for the rule, or is nearly singular: the error says so.
#[test]
fn what_quadrature_across_misses_is_in_the_error() {
    let curve = |x: &str, y: f64, z: &str| -> CurveRef {
        let bound = |s: &str| Expr::parse(s).unwrap().bind(&["t"], &[]).unwrap();
        let y = bound(&y.to_string());
        Arc::new(ExpressionCurve::new([bound(x), y, bound(z)], [0.0, 1.0]).unwrap())
    };
    // The length of z = a sin(b x), by the midpoint rule over full periods, which converges faster than any power.
    let (a, b) = (0.01, 60.0 * TAU);
    let n = 400;
    let wave = (0..n)
        .map(|k| (a * b * (TAU * (f64::from(k) + 0.5) / f64::from(n)).cos()).hypot(1.0))
        .sum::<f64>()
        / f64::from(n);
    let waves = format!("0.01*sin({b:?}*t)");
    let cases = [
        ("t", waves.as_str(), wave, 0.5),
        ("t*sqrt(t+1e-6)", "0", (1.0 + 1e-6f64).sqrt(), 1e-4),
        ("t+0.1*sin(6*t)", "t*t", f64::NAN, 1e-9),
    ];
    for (x, z, expected, most) in cases {
        let rails = [0.0, 1.0].map(|y| curve(x, y, z));
        let [south, north] = rails.clone();
        let sheet = ruled(south.clone(), north.clone(), Dir::U).unwrap();
        let ends = rails.map(|r| nappe::Curve::ends(r.as_ref()));
        let mut m = Maker::default();
        m.edge(south);
        m.line(ends[0][1], ends[1][1]);
        m.edge(north);
        m.line(ends[0][0], ends[1][0]);
        m.on(Arc::new(sheet), true, &[&[1, 2, -3, -4]]);
        let expected = if expected.is_nan() {
            // The length of the rail by many chords.
            let p = |k: u32| m.body.edges[0].curve.point(f64::from(k) / 1e6);
            (0..1_000_000).map(|k| p(k).distance(p(k + 1))).sum()
        } else {
            expected
        };
        let found = figures(&m.body).unwrap().areas[0].clone().unwrap();
        let (off, e) = ((found.value - expected).abs(), found.certainty.error());
        assert!(off <= e + 1e-9, "{x}, {z}: off by {off:e}, stated {e:e}");
        assert!(e <= most * expected, "{x}, {z}: {e:e}");
    }
}

#[test]
fn tolerances_of_edges_are_numbers() {
    let sound = sew(&cuboid(v(1.0, 2.0, 3.0)), 1e-6).body;
    sound.validate(0.0).unwrap();
    for bad in [f64::INFINITY, f64::NAN, -1e-9] {
        let mut body = sound.clone();
        body.edges[3].tolerance = bad;
        for tol in [0.0, f64::INFINITY] {
            let told = body.validate(tol);
            assert!(matches!(told, Err(BodyError::Tolerance { edge: 3, .. })));
        }
        assert!(matches!(
            figures(&body),
            Err(BodyMeshError::Body(BodyError::Tolerance { .. }))
        ));
    }
}
