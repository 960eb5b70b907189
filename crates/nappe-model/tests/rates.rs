//! Derivatives of figures by a parameter against closed forms.

#![allow(clippy::unwrap_used)]

mod moving;

use moving::moving;
use nappe::DVec3;
use nappe::measure::{
    AreaRate, IntegralOptions, Measured, Moving, Opening, SolidRate, area_centroid, area_rate,
    face_rate, joint_centroid, solid_rate, solids,
};
use nappe::mesh::Certainty;
use std::f64::consts::PI;

const OPTIONS: IntegralOptions = IntegralOptions {
    relative: 1e-7,
    budget: 4000,
};

fn area(parts: &[Moving]) -> AreaRate {
    let each: Vec<_> = parts
        .iter()
        .map(|m| area_centroid(m.surface.as_ref(), &OPTIONS))
        .collect();
    area_rate(parts, &joint_centroid(&each), &OPTIONS)
}

fn solid(parts: &[Moving]) -> SolidRate {
    told(parts).unwrap()
}

fn told(parts: &[Moving]) -> Result<SolidRate, Opening> {
    let surfaces: Vec<_> = parts.iter().map(|m| m.surface.clone()).collect();
    let all = solids(&surfaces, None, &OPTIONS);
    assert_eq!(all.len(), 1);
    solid_rate(parts, all[0].as_ref().unwrap(), None, &OPTIONS)
}

/// The value is within its proven error of the truth, and that error is small against a scale. Beside poles, where the
/// normal vanishes, the area's rate has no expansion and its bound falls more slowly than elsewhere.
fn is(m: Measured, want: f64, scale: f64, what: &str) {
    let Certainty::Bounded(error) = m.certainty else {
        panic!("{what}: {m:?} is not proven");
    };
    assert!(
        (m.value - want).abs() <= error + 1e-14 * scale,
        "{what}: {m:?} {want}"
    );
    assert!(error <= 1e-4 * scale, "{what}: {m:?}");
}

fn quadric(shape: &str, axes: &str, more: &str) -> String {
    format!("[surfaces.s]\nkind = \"quadric\"\nshape = \"{shape}\"\nsemi_axes = {axes}\n{more}\n")
}

#[test]
fn a_sphere_grows_by_its_radius() {
    for r in [1.5e-5, 1.5, 1.5e5] {
        for center in ["[0, 0, 0]", "[\"1e3*p\", \"-2e3*p\", \"7e3*p\"]"] {
            let parts = moving(
                r,
                &quadric("sphere", "[\"p\"]", &format!("center = {center}")),
            );
            let rate = area(&parts);
            is(rate.area, 8.0 * PI * r, 8.0 * PI * r, "area");
            let solid = solid(&parts);
            let far = center.len() > 10;
            let way = if far {
                DVec3::new(1e3, -2e3, 7e3)
            } else {
                DVec3::ZERO
            };
            let scale = if far { 7e3 } else { 1.0 };
            // The accuracy aimed at is relative to the greatest speed.
            let sphere = 4.0 * PI * r * r;
            is(solid.volume, sphere, sphere * scale, "volume");
            for k in 0..3 {
                is(
                    rate.centroid.unwrap()[k],
                    way[k],
                    scale,
                    "centroid of the area",
                );
                is(solid.centroid.unwrap()[k], way[k], scale, "centroid");
                let face = [false, true].map(|g| face_rate(&parts, k, g).unwrap());
                for (f, sign) in face.iter().zip([-1.0, 1.0]) {
                    assert!(f.range.contains(way[k] + sign), "{f:?}");
                    assert!(
                        !f.between && f.range.width() < 1e-3 * scale.max(1.0),
                        "{f:?}"
                    );
                }
            }
            // 8/15 π r⁵, the same about every axis.
            let inertia = solid.inertia.unwrap();
            let want = 8.0 / 3.0 * PI * r.powi(4);
            for i in 0..3 {
                for j in 0..3 {
                    let want_ij = if i == j { want } else { 0.0 };
                    is(inertia[i][j], want_ij, want * scale, "inertia");
                }
            }
            assert_eq!(solid.principal, None);
        }
    }
}

#[test]
fn a_torus_grows_by_either_radius() {
    for (axes, want) in [
        ("major = \"p\"\nminor = 1", [4.0 * PI * PI, 2.0 * PI * PI]),
        ("major = 3\nminor = \"p/3\"", [4.0 * PI * PI, 4.0 * PI * PI]),
    ] {
        let parts = moving(3.0, &format!("[surfaces.s]\nkind = \"torus\"\n{axes}\n"));
        is(area(&parts).area, want[0], want[0], "area");
        is(solid(&parts).volume, want[1], want[1], "volume");
    }
}

#[test]
fn a_cone_grows_up_to_its_tip() {
    // The tip stays; the base circle of radius 2 rises with its height p: area π a sqrt(a² + h²).
    let h = 3.0;
    let parts = moving(h, &quadric("cone", "[2, 2, \"p\"]", ""));
    let want = PI * 2.0 * h / (4.0 + h * h).sqrt();
    is(area(&parts).area, want, want, "area");
    // Its centroid is at 2/3 of the height.
    is(
        area(&parts).centroid.unwrap()[2],
        2.0 / 3.0,
        1.0,
        "centroid",
    );
}

#[test]
fn a_can_grows_however_its_profile_is_parametrized() {
    for spacing in ["uniform", "chord", "centripetal"] {
        for (p, far) in [(2.0, 0.0), (2e-5, 0.0), (2.0, 1e4)] {
            // Radius p, height 3 p.
            let text = format!(
                r#"
[surfaces.s]
kind = "revolution"
axis = {{ origin = [{far:?}, 0, 0], direction = [0, 0, 1] }}
profile = {{ kind = "polyline", points = [[{far:?}, 0, "3*p"], ["{far:?} + p", 0, "3*p"], ["{far:?} + p", 0, 0], [{far:?}, 0, 0]], parametrization = "{spacing}" }}
"#
            );
            let parts = moving(p, &text);
            let want = 16.0 * PI * p;
            is(area(&parts).area, want, want, "area");
            let want = 9.0 * PI * p * p;
            let solid = solid(&parts);
            is(solid.volume, want, want, "volume");
            is(solid.centroid.unwrap()[2], 1.5, 1.5, "centroid");
            let top = face_rate(&parts, 2, true).unwrap();
            assert!(
                top.range.contains(3.0) && top.range.width() < 1e-3,
                "{top:?}"
            );
        }
    }
}

#[test]
fn a_vase_through_points_changes_as_its_differences_tell() {
    let at = |p: f64| {
        let parts = moving(
            p,
            r#"
[surfaces.s]
kind = "revolution"
profile = { kind = "interpolate", points = [[1, 0, 0], ["p", 0, 1], [1, 0, "2*p"], [2, 0, 4]] }
"#,
        );
        let rate = area(&parts);
        let whole = area_centroid(parts[0].surface.as_ref(), &OPTIONS).area;
        (rate, whole.value)
    };
    let (p, h) = (1.4, 1e-3);
    let [a, b, c, d] = [h, -h, 0.5 * h, -0.5 * h].map(|d| at(p + d).1);
    let difference = (4.0 * (c - d) / h - (a - b) / (2.0 * h)) / 3.0;
    let rate = at(p).0.area;
    // Each area is known to a ten-millionth.
    let slack = 1e-6 * a / h;
    assert!(
        (rate.value - difference).abs() < slack,
        "{rate:?} {difference}"
    );
    assert!(rate.value.abs() > 100.0 * slack, "{rate:?} {slack}");
}

/// A unit cube of faces whose corners have these coordinates at the top.
fn cube(lid: &str, walls: &str) -> String {
    let faces = [
        ("floor", "[[0,0,0],[0,1,0]],[[1,0,0],[1,1,0]]".to_owned()),
        (
            "lid",
            format!("[[0,0,{lid}],[0,1,{lid}]],[[1,0,{lid}],[1,1,{lid}]]"),
        ),
        (
            "west",
            format!("[[0,0,0],[0,0,{walls}]],[[0,1,0],[0,1,{walls}]]"),
        ),
        (
            "east",
            format!("[[1,0,0],[1,0,{walls}]],[[1,1,0],[1,1,{walls}]]"),
        ),
        (
            "south",
            format!("[[0,0,0],[0,0,{walls}]],[[1,0,0],[1,0,{walls}]]"),
        ),
        (
            "north",
            format!("[[0,1,0],[0,1,{walls}]],[[1,1,0],[1,1,{walls}]]"),
        ),
    ];
    let face = |(name, corners): &(&str, String)| {
        format!("[surfaces.{name}]\nkind = \"bilinear\"\ncorners = [{corners}]\n")
    };
    faces.iter().map(face).collect()
}

#[test]
fn a_body_whose_joints_open_has_no_derivatives() {
    let closed = told(&moving(1.0, &cube("\"p\"", "\"p\""))).unwrap();
    is(closed.volume, 1.0, 1.0, "volume");
    // Only the lid rises: beside p = 1 nothing is closed.
    let opening = told(&moving(1.0, &cube("\"p\"", "1"))).unwrap_err();
    let sides = [Some(opening.first), opening.second].map(|s| s.unwrap().0);
    assert!(sides.contains(&1), "{opening}");
    assert!((opening.speed - 1.0).abs() < 1e-12, "{opening}");
    // A point on the axis that leaves it.
    let text = r#"
[surfaces.s]
kind = "revolution"
profile = { kind = "polyline", points = [["p - 1", 0, 3], [2, 0, 3], [2, 0, 0], [0, 0, 0]] }
"#;
    let opening = told(&moving(1.0, text)).unwrap_err();
    assert_eq!(opening.second, None, "{opening}");
    // From one end of a diameter to the other.
    assert!((opening.speed - 2.0).abs() < 1e-2, "{opening}");
    // A seam that opens: a turn of less than 360 degrees.
    let text = r#"
[surfaces.s]
kind = "revolution"
profile = { kind = "polyline", points = [[0, 0, 3], [2, 0, 3], [2, 0, 0], [0, 0, 0]] }
angle = "p rad"
"#;
    let opening = told(&moving(std::f64::consts::TAU, text)).unwrap_err();
    assert!((opening.speed - 2.0).abs() < 1e-9, "{opening}");
}

#[test]
fn a_sector_grows_by_its_angle() {
    let text = r#"
[surfaces.s]
kind = "revolution"
profile = { kind = "line", from = [1, 0, 0], to = [3, 0, 2] }
angle = "p rad"
"#;
    // A frustum of slant 2√2 and mean radius 2.
    let want = 2.0 * 2.0 * 2f64.sqrt();
    is(area(&moving(1.2, text)).area, want, want, "area");
}

#[test]
fn a_box_with_a_ridge_has_one_sided_faces_and_moved_things_keep_their_size() {
    // A sheet whose top is an edge that tilts: z = p (x - 1/2) + 1 along x at y = 1.
    let text = r#"
[surfaces.s]
kind = "bilinear"
corners = [[[0, 0, 0], [0, 1, "1 - p/2"]], [[1, 0, 0], [1, 1, "1 + p/2"]]]
"#;
    let level = face_rate(&moving(0.0, text), 2, true).unwrap();
    assert!(level.between, "{level:?}");
    assert!(level.range.contains(-0.5) && level.range.contains(0.5) && level.range.width() < 1.01);
    let tilted = face_rate(&moving(0.3, text), 2, true).unwrap();
    assert!(
        !tilted.between && tilted.range.contains(0.5) && tilted.range.width() < 1e-6,
        "{tilted:?}"
    );
    // Turned about an axis aside.
    let text = r#"
[surfaces.a]
kind = "quadric"
shape = "ellipsoid"
semi_axes = [1, 2, 3]
construction_only = true
[surfaces.s]
kind = "transform"
surface = "a"
rotate = { axis = { origin = [5, 0, 0], direction = [0, 0, 1] }, angle = "p rad" }
"#;
    let parts = moving(0.4, text).split_off(1);
    let rate = area(&parts);
    is(rate.area, 0.0, 50.0, "area");
    let solid = solid(&parts);
    is(solid.volume, 0.0, 8.0 * PI, "volume");
    // The centre (5, 0, 0) - 5 (cos p, sin p, 0) moves square to its way from the axis.
    let want = DVec3::new(5.0 * 0.4f64.sin(), -5.0 * 0.4f64.cos(), 0.0);
    for k in 0..3 {
        is(solid.centroid.unwrap()[k], want[k], 5.0, "centroid");
        is(solid.principal.unwrap()[k], 0.0, 100.0, "principal moment");
    }
}
