//! Areas and volumes of trimmed faces against closed forms, and of their images under maps.

use crate::mesh::{Maker, SCALES, plane};
use crate::shapes::*;
use nappe::body::{Body, figures, sew};
use nappe::curve::{Ellipse, EllipseOptions};
use nappe::surface::Elementary;
use nappe::{DAffine3, DMat3, DVec3, Frame};
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
        let mut m = Maker::default();
        m.circle(o, DVec3::Z, s);
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
