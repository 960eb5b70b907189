//! Triangles of trimmed faces: closed forms for area and volume, watertight borders, deviations that hold.

use crate::shapes::*;
use nappe::body::{
    Body, Coedge, Edge, Face, FaceError, Loop, Meshed, RegionError, Shell, Vertex, cover, mesh, sew,
};
use nappe::curve::{Ellipse, EllipseOptions, Line};
use nappe::surface::{Elementary, SurfaceRef};
use nappe::{Certainty, CurveRef, DVec3, Frame, MeshOptions};
use std::collections::HashMap;
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;

/// A body that is built edge by edge.
#[derive(Default)]
pub(crate) struct Maker {
    pub(crate) body: Body,
}

impl Maker {
    pub(crate) fn edge(&mut self, curve: CurveRef) -> usize {
        let ends = curve.ends().map(|p| {
            let near = |v: &Vertex| v.point.distance(p) <= 1e-9 * (1e-9 + p.length());
            self.body.vertices.iter().position(near).unwrap_or_else(|| {
                self.body.vertices.push(Vertex { point: p });
                self.body.vertices.len() - 1
            })
        });
        self.body.edges.push(Edge {
            curve,
            vertices: ends,
            tolerance: 0.0,
        });
        self.body.edges.len() - 1
    }

    pub(crate) fn circle(&mut self, center: DVec3, normal: DVec3, radius: f64) -> usize {
        self.arc(center, normal, DVec3::ZERO, radius, [0.0, TAU])
    }

    pub(crate) fn arc(
        &mut self,
        center: DVec3,
        normal: DVec3,
        x: DVec3,
        r: f64,
        [from, to]: [f64; 2],
    ) -> usize {
        let options = EllipseOptions {
            from,
            to,
            normal,
            x_direction: (x != DVec3::ZERO).then_some(x),
        };
        self.edge(Arc::new(Ellipse::new(center, [r; 2], options).unwrap()))
    }

    pub(crate) fn line(&mut self, a: DVec3, b: DVec3) -> usize {
        self.edge(Arc::new(Line::new(a, b).unwrap()))
    }

    /// A face of an elementary surface; edges from 1 on, negative: backwards.
    pub(crate) fn face(&mut self, form: Elementary, forward: bool, loops: &[&[i32]]) {
        let edge = |&e: &i32| self.body.edges[e.unsigned_abs() as usize - 1].curve.clone();
        let curves: Vec<CurveRef> = loops.iter().copied().flatten().map(edge).collect();
        let surface = cover(&form, &curves).unwrap();
        self.on(surface, forward, loops);
    }

    pub(crate) fn on(&mut self, surface: SurfaceRef, forward: bool, loops: &[&[i32]]) {
        let coedge = |&e: &i32| Coedge {
            edge: e.unsigned_abs() as usize - 1,
            forward: e > 0,
        };
        let one = |l: &&[i32]| Loop::Edges(l.iter().map(coedge).collect());
        self.body.faces.push(Face {
            surface,
            forward,
            loops: loops.iter().map(one).collect(),
        });
    }
}

pub(crate) fn plane(origin: DVec3, normal: DVec3) -> Elementary {
    Elementary::Plane { origin, normal }
}

pub(crate) fn area(m: &Meshed) -> f64 {
    let mesh = &m.mesh;
    let triangle = |p: [DVec3; 3]| 0.5 * (p[1] - p[0]).cross(p[2] - p[0]).length();
    mesh.patches
        .iter()
        .flat_map(|patch| {
            patch.triangles.iter().map(|t| {
                triangle(t.map(|k| mesh.points[patch.vertices[k as usize].point as usize]))
            })
        })
        .sum()
}

pub(crate) fn volume(m: &Meshed) -> f64 {
    let mesh = &m.mesh;
    let o = mesh.points[0];
    mesh.patches
        .iter()
        .flat_map(|patch| {
            patch.triangles.iter().map(|t| {
                let p = t.map(|k| mesh.points[patch.vertices[k as usize].point as usize] - o);
                p[0].dot(p[1].cross(p[2])) / 6.0
            })
        })
        .sum()
}

/// Edges of triangles that are not used twice in opposite directions.
pub(crate) fn open_edges(m: &Meshed) -> usize {
    let mut uses: HashMap<(u32, u32), [usize; 2]> = HashMap::new();
    for patch in &m.mesh.patches {
        for t in &patch.triangles {
            let p = t.map(|k| patch.vertices[k as usize].point);
            for k in 0..3 {
                let (a, b) = (p[k], p[(k + 1) % 3]);
                assert_ne!(a, b);
                uses.entry((a.min(b), a.max(b))).or_default()[usize::from(a < b)] += 1;
            }
        }
    }
    uses.values().filter(|u| **u != [1, 1]).count()
}

/// Meshes with a tolerance; all is proven, triangles are on the side of their normals, and points of triangles are
/// within the deviation of what they should be on by `distance`.
pub(crate) fn check(body: &Body, tol: f64, distance: impl Fn(usize, DVec3) -> f64) -> Meshed {
    let m = mesh(body, &MeshOptions::with_tol(tol)).unwrap();
    assert_eq!(m.failed, []);
    for (i, patch) in m.mesh.patches.iter().enumerate() {
        let Certainty::Bounded(e) = patch.deviation else {
            panic!("face {i}: {:?}", patch.deviation)
        };
        assert!(e <= tol * (1.0 + 1e-9), "face {i}: {e:e}");
        for t in &patch.triangles {
            let v = t.map(|k| patch.vertices[k as usize]);
            let p = v.map(|v| m.mesh.points[v.point as usize]);
            let normal = (p[1] - p[0]).cross(p[2] - p[0]);
            let mean = v[0].normal + v[1].normal + v[2].normal;
            let thin = normal.length() <= 1e-9 * (p[1] - p[0]).length() * (p[2] - p[0]).length();
            assert!(thin || normal.dot(mean) > 0.0, "face {i} at {}", p[0]);
            for w in [
                [1.0, 1.0, 1.0],
                [0.0, 1.0, 1.0],
                [1.0, 0.0, 1.0],
                [1.0, 1.0, 0.0],
            ] {
                let sum = w[0] + w[1] + w[2];
                let q = (p[0] * w[0] + p[1] * w[1] + p[2] * w[2]) / sum;
                let d = distance(i, q).abs();
                assert!(d <= e, "face {i}: {d:e} > {e:e}");
            }
        }
    }
    m
}

pub(crate) fn near(a: f64, b: f64, share: f64) {
    assert!((a - b).abs() <= share * b.abs(), "{a} is not {b}");
}

pub(crate) const SCALES: [(f64, DVec3); 4] = [
    (1.0, DVec3::ZERO),
    (1e-6, DVec3::ZERO),
    (1e6, DVec3::ZERO),
    (1.0, DVec3::new(1e5, -3e5, 2e5)),
];

#[test]
fn a_square_with_a_round_hole() {
    for (s, o) in SCALES {
        let at = |x: f64, y: f64| o + s * v(x, y, 0.0);
        let mut m = Maker::default();
        let p = [at(0.0, 0.0), at(4.0, 0.0), at(4.0, 4.0), at(0.0, 4.0)];
        for k in 0..4 {
            m.line(p[k], p[(k + 1) % 4]);
        }
        m.circle(at(2.0, 2.0), DVec3::Z, s);
        // The hole may be written either way round.
        for hole in [-5, 5] {
            for forward in [true, false] {
                m.body.faces.clear();
                m.face(plane(o, DVec3::Z), true, &[&[1, 2, 3, 4], &[hole]]);
                if !forward {
                    m.body.faces[0].turn();
                }
                let made = check(&m.body, 1e-4 * s, |_, q| q.z - o.z);
                near(area(&made), (16.0 - PI) * s * s, 1e-4);
            }
        }
    }
}

#[test]
fn sewn_surfaces_are_meshed_as_bodies() {
    let m = check(&sew(&cuboid(v(1.0, 2.0, 3.0)), 1e-6).body, 1e-3, |_, _| 0.0);
    assert_eq!(open_edges(&m), 0);
    near(volume(&m), 6.0, 1e-12);
}

/// A cylinder between a flat floor and an oblique ellipse.
#[test]
fn a_cylinder_cut_obliquely_is_closed() {
    for (s, o) in SCALES {
        let mut m = Maker::default();
        m.circle(o, DVec3::Z, s);
        // z = 2 + x/2 on the cylinder: semi-axes √(5/4) and 1.
        let ellipse = EllipseOptions {
            normal: v(-0.5, 0.0, 1.0),
            x_direction: Some(v(1.0, 0.0, 0.5)),
            ..EllipseOptions::default()
        };
        let top = o + s * v(0.0, 0.0, 2.0);
        let axes = [s * 1.25f64.sqrt(), s];
        m.edge(Arc::new(Ellipse::new(top, axes, ellipse).unwrap()));
        let axis = Frame::new(o, DVec3::Z, v(1.0, 1.0, 0.0)).unwrap();
        let side = Elementary::Cylinder {
            axis,
            radius: s,
            outward: true,
        };
        m.face(plane(o, -DVec3::Z), true, &[&[-1]]);
        m.face(side, true, &[&[1], &[-2]]);
        m.face(plane(top, v(-0.5, 0.0, 1.0)), true, &[&[2]]);
        let distance = |i: usize, q: DVec3| match i {
            0 => q.z - o.z,
            1 => (q - o).truncate().length() - s,
            _ => (q - top).dot(v(-0.5, 0.0, 1.0)) / 1.25f64.sqrt(),
        };
        let made = check(&m.body, 1e-3 * s, distance);
        assert_eq!(open_edges(&made), 0);
        near(volume(&made), 2.0 * PI * s.powi(3), 2e-3);
        // No points are put inside: the cylinder is straight.
        assert!(made.mesh.patches[1].triangles.len() < 600);
    }
}

/// A cap of a sphere with the pole inside, and the rest of it.
#[test]
fn one_circle_divides_a_sphere_in_two() {
    for (s, o) in SCALES {
        let f = Frame::new(o, v(0.3, 0.2, 1.0), DVec3::X).unwrap();
        let mut m = Maker::default();
        let h = 0.5f64;
        let r = (1.0 - h * h).sqrt();
        m.circle(f.point(DVec3::Z * (h * s)), f.z(), r * s);
        let ball = Elementary::Sphere {
            frame: f,
            radius: s,
            outward: true,
        };
        for (loops, expected) in [(1, TAU * (1.0 - h)), (-1, TAU * (1.0 + h))] {
            m.body.faces.clear();
            m.face(ball, true, &[&[loops]]);
            let made = check(&m.body, 1e-3 * s, |_, q| q.distance(o) - s);
            near(area(&made), expected * s * s, 4e-3);
        }
        m.body.faces.clear();
        m.face(ball, true, &[&[1]]);
        m.face(ball, true, &[&[-1]]);
        let both = check(&m.body, 1e-3 * s, |_, q| q.distance(o) - s);
        assert_eq!(open_edges(&both), 0);
        near(volume(&both), 4.0 / 3.0 * PI * s.powi(3), 4e-3);
    }
}

/// A circle through the poles of the frame, and small circles that are holes only.
#[test]
fn spheres_with_holes_alone() {
    let f = Frame::WORLD;
    let ball = Elementary::Sphere {
        frame: f,
        radius: 1.0,
        outward: true,
    };
    let mut m = Maker::default();
    let h = 0.8f64;
    let ways = [DVec3::X, -DVec3::X, DVec3::Y, -DVec3::Y, DVec3::Z];
    for w in ways {
        m.circle(w * h, w, 0.6);
    }
    m.face(ball, true, &[&[-1], &[-2], &[-3], &[-4], &[-5]]);
    let made = check(&m.body, 1e-3, |_, q| q.length() - 1.0);
    near(area(&made), 4.0 * PI - 5.0 * TAU * (1.0 - h), 4e-3);
    // Half a sphere through the poles.
    let mut m = Maker::default();
    m.circle(DVec3::ZERO, DVec3::X, 1.0);
    m.face(ball, true, &[&[1]]);
    let made = check(&m.body, 1e-3, |_, q| q.length() - 1.0);
    near(area(&made), TAU, 4e-3);
    assert!(made.mesh.points.iter().all(|p| p.x >= -1e-3));
}

#[test]
fn a_cone_with_its_tip() {
    for (s, o) in SCALES {
        let f = Frame::new(o, v(0.3, 0.2, 1.0), DVec3::X).unwrap();
        let mut m = Maker::default();
        let base = f.point(DVec3::Z * (2.0 * s));
        m.circle(base, f.z(), s);
        let side = Elementary::Cone {
            axis: f,
            slope: 0.5,
            outward: true,
        };
        m.face(side, true, &[&[-1]]);
        m.face(plane(base, f.z()), true, &[&[1]]);
        let distance = |i: usize, q: DVec3| {
            let c = f.coordinates(q);
            if i == 0 {
                (c.x.hypot(c.y) - 0.5 * c.z) / 1.25f64.sqrt()
            } else {
                c.z - 2.0 * s
            }
        };
        let made = check(&m.body, 1e-3 * s, distance);
        assert_eq!(open_edges(&made), 0);
        near(volume(&made), 2.0 / 3.0 * PI * s.powi(3), 4e-3);
    }
}

/// A box with a round hole through it: the hole's wall has two circles.
#[test]
fn a_drilled_box_is_closed() {
    for (s, o) in SCALES {
        let at = |x: f64, y: f64, z: f64| o + s * v(x, y, z);
        let mut m = Maker::default();
        let ring = |z: f64| {
            [
                at(0.0, 0.0, z),
                at(4.0, 0.0, z),
                at(4.0, 4.0, z),
                at(0.0, 4.0, z),
            ]
        };
        let (low, high) = (ring(0.0), ring(2.0));
        for k in 0..4 {
            m.line(low[k], low[(k + 1) % 4]);
        }
        for k in 0..4 {
            m.line(high[k], high[(k + 1) % 4]);
        }
        for k in 0..4 {
            m.line(low[k], high[k]);
        }
        m.circle(at(2.0, 2.0, 0.0), DVec3::Z, s);
        m.circle(at(2.0, 2.0, 2.0), DVec3::Z, s);
        m.face(plane(o, -DVec3::Z), true, &[&[-4, -3, -2, -1], &[13]]);
        m.face(
            plane(at(0.0, 0.0, 2.0), DVec3::Z),
            true,
            &[&[5, 6, 7, 8], &[-14]],
        );
        let out = [-DVec3::Y, DVec3::X, DVec3::Y, -DVec3::X];
        for k in 0..4 {
            let (a, b) = (k as i32 + 1, (k as i32 + 1) % 4 + 9);
            m.face(
                plane(low[k], out[k]),
                true,
                &[&[a, b, -(a + 4), -(k as i32 + 9)]],
            );
        }
        let wall = Elementary::Cylinder {
            axis: Frame::new(at(2.0, 2.0, 0.0), DVec3::Z, DVec3::X).unwrap(),
            radius: s,
            outward: false,
        };
        m.face(wall, true, &[&[-13], &[14]]);
        let made = check(&m.body, 1e-3 * s, |i, q| {
            if i < 6 {
                0.0
            } else {
                (q - at(2.0, 2.0, 0.0)).truncate().length() - s
            }
        });
        assert_eq!(open_edges(&made), 0);
        near(volume(&made), (32.0 - 2.0 * PI) * s.powi(3), 1e-3);
    }
}

/// A quarter of a torus, over the seams of its cover or not.
#[test]
fn a_quarter_of_a_torus() {
    let form = Elementary::Torus {
        axis: Frame::WORLD,
        major: 3.0,
        minor: 1.0,
        outward: true,
    };
    for turn in [0.0, 2.5, 4.0] {
        let mut m = Maker::default();
        let way = |a: f64| v((a + turn).cos(), (a + turn).sin(), 0.0);
        let tube = |m: &mut Maker, a: f64| {
            let normal = way(a).cross(DVec3::Z);
            m.arc(way(a) * 3.0, normal, way(a), 1.0, [0.0, TAU])
        };
        tube(&mut m, 0.0);
        tube(&mut m, FRAC_PI_2);
        for loops in [[1, -2], [-1, 2]] {
            m.body.faces.clear();
            m.face(form, true, &[&loops[..1], &loops[1..]]);
            let made = check(&m.body, 1e-3, |_, q| {
                (q.x.hypot(q.y) - 3.0).hypot(q.z) - 1.0
            });
            let whole = 12.0 * PI * PI;
            let share = area(&made) / whole;
            assert!(
                (share - 0.25).abs() < 1e-3 || (share - 0.75).abs() < 3e-3,
                "{share}"
            );
        }
    }
}

#[test]
fn bad_loops_are_told() {
    let o = DVec3::ZERO;
    let mut m = Maker::default();
    // A bow tie.
    let p = [
        v(0.0, 0.0, 0.0),
        v(1.0, 1.0, 0.0),
        v(1.0, 0.0, 0.0),
        v(0.0, 1.0, 0.0),
    ];
    for k in 0..4 {
        m.line(p[k], p[(k + 1) % 4]);
    }
    m.face(plane(o, DVec3::Z), true, &[&[1, 2, 3, 4]]);
    // A circle that is far off its plane.
    m.circle(v(0.0, 0.0, 5.0), DVec3::X, 1.0);
    m.face(plane(o, DVec3::Z), true, &[&[5]]);
    // No loop at all, and a sound face.
    m.on(quad(o, DVec3::X, DVec3::Y), true, &[]);
    m.circle(o, DVec3::Z, 1.0);
    m.face(plane(o, DVec3::Z), true, &[&[6]]);
    // One circle around a cylinder: nothing bounds the other side.
    let side = Elementary::Cylinder {
        axis: Frame::WORLD,
        radius: 1.0,
        outward: true,
    };
    m.face(side, true, &[&[6]]);
    m.body.shells.push(Shell::default());
    let made = mesh(&m.body, &MeshOptions::with_tol(1e-3)).unwrap();
    let failed: Vec<usize> = made.failed.iter().map(|f| f.0).collect();
    assert_eq!(failed, [0, 1, 2, 4], "{:?}", made.failed);
    assert!(matches!(made.failed[1].1, FaceError::Off { edge: 4, .. }));
    assert!(matches!(
        made.failed[2].1,
        FaceError::Region(RegionError::Unbounded)
    ));
    assert!(matches!(
        made.failed[3].1,
        FaceError::Region(RegionError::Around { .. })
    ));
    assert_eq!(made.mesh.patches.len(), 5);
    assert!(made.mesh.patches[0].triangles.is_empty());
    assert!(!made.mesh.patches[3].triangles.is_empty());
}
