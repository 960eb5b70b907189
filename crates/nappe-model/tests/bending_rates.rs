//! Derivatives of extreme curvatures and of integrals of curvature against closed forms.

#![allow(clippy::unwrap_used)]

mod moving;

use moving::moving;
use nappe::measure::{
    CurvatureRate, ExtremeRate, IntegralOptions, Moving, SearchOptions, bending_rate,
    curvature_extremes, curvature_rate, curvature_variation,
};
use std::f64::consts::PI;

fn rates(part: &Moving) -> CurvatureRate {
    let found = curvature_extremes(part.surface.as_ref(), &SearchOptions::default()).unwrap();
    curvature_rate(part, &found)
}

/// The same to either side, within the stated error and 10⁻⁶ of a scale.
fn is(rate: Option<ExtremeRate>, want: f64, scale: f64) {
    either(rate, [want; 2], scale);
}

fn either(rate: Option<ExtremeRate>, want: [f64; 2], scale: f64) {
    let rate = rate.unwrap();
    for (x, want) in rate.range.into_iter().zip(want) {
        let off = (x - want).abs();
        assert!(off <= 1e-6 * scale, "{rate:?} for {want}");
        assert!(
            off <= rate.certainty.error() + 1e-9 * scale,
            "{rate:?} for {want}"
        );
    }
}

fn one(p: f64, text: &str) -> Moving {
    moving(p, text).pop().unwrap()
}

#[test]
fn a_sphere_bends_less_as_it_grows() {
    for (r, center) in [
        (1e-4, "[0, 0, 0]"),
        (2.0, "[100, \"3*p\", -50]"),
        (3e5, "[0, 0, 0]"),
    ] {
        let ball = one(
            r,
            &format!(
                "[surfaces.s]\nkind = \"quadric\"\nshape = \"sphere\"\nsemi_axes = [\"p\"]\ncenter = {center}"
            ),
        );
        let rate = rates(&ball);
        let (k, h) = (r.powi(-3), r.powi(-2));
        for e in rate.gaussian {
            is(e, -2.0 * k, k);
        }
        // The normals point outwards: H = -1/r.
        for e in [rate.mean[0], rate.mean[1], rate.k1, rate.k2] {
            is(e, h, h);
        }
        let bending = bending_rate(&ball);
        assert!(bending.total.value.abs() <= 1e-6 / r, "{bending:?}");
        assert!(bending.variation.value.abs() <= 1e-6 * k, "{bending:?}");
    }
}

#[test]
fn a_torus_bends_by_either_radius() {
    let (major, minor) = (3.0, 1.0f64);
    let by_major = one(
        major,
        "[surfaces.s]\nkind = \"torus\"\nmajor = \"p\"\nminor = 1",
    );
    let rate = rates(&by_major);
    // K from -1/(r (R - r)) to 1/(r (R + r)).
    is(
        rate.gaussian[0],
        (minor * (major - minor).powi(2)).recip(),
        1.0,
    );
    is(
        rate.gaussian[1],
        -(minor * (major + minor).powi(2)).recip(),
        1.0,
    );
    is(rate.k2, 0.0, 1.0);
    // The other one is that of the inner circle: 1/(R - r) towards outward normals.
    is(rate.k1, -(major - minor).powi(-2), 1.0);
    let by_minor = one(
        minor,
        "[surfaces.s]\nkind = \"torus\"\nmajor = 3\nminor = \"p\"",
    );
    let rate = rates(&by_minor);
    is(rate.k2, minor.powi(-2), 1.0);
    is(rate.k1, (major - minor).powi(-2), 1.0);
    let bending = bending_rate(&by_minor);
    assert!(bending.total.value.abs() <= 1e-6, "{bending:?}");
}

/// K of an ellipsoid is a²/(b²c²) at the ends of the axis a, both of which move alike.
#[test]
fn an_ellipsoid_bends_at_the_ends_of_its_axes() {
    let text = |axes: &str| {
        format!("[surfaces.s]\nkind = \"quadric\"\nshape = \"ellipsoid\"\nsemi_axes = {axes}")
    };
    let (a, b, c) = (3.0f64, 2.0f64, 1.0f64);
    let rate = rates(&one(a, &text("[\"p\", 2, 1]")));
    is(rate.gaussian[1], 2.0 * a / (b * c).powi(2), 3.0);
    is(rate.gaussian[0], -2.0 * c * c / (a.powi(3) * b * b), 1.0);
    // Outward normals: the least principal curvature is -a/c², there.
    is(rate.k2, -1.0 / (c * c), 1.0);
}

/// Waves of one height, which grow by how far along they are: the sharpest bend is in three places.
#[test]
fn extremes_in_several_places_have_two_derivatives() {
    let text = "[surfaces.s]\nkind = \"ruled\"\n".to_owned()
        + &["south", "north"]
            .iter()
            .zip([0, 1])
            .map(|(side, y)| {
                format!(
                    "{side} = {{ kind = \"expression\", x = \"t\", y = \"{y}\", z = \"0.1*cos(4*pi*t)*(1 + (p - 1)*t)\" }}\n"
                )
            })
            .collect::<String>();
    let rate = rates(&one(1.0, &text));
    let crest = 1.6 * PI * PI;
    // Crests at 0, 1/2 and 1 bend down, troughs at 1/4 and 3/4 up; at p = 1 they are equal. r_u × r_v points up.
    either(rate.k2, [-crest, 0.0], crest);
    either(rate.k1, [0.25 * crest, 0.75 * crest], crest);
}

/// Against differences of proven integrals.
#[test]
fn the_variation_of_curvature_changes_as_its_integrals_tell() {
    let text = "[surfaces.s]\nkind = \"torus\"\nmajor = 3\nminor = \"p\"";
    let options = IntegralOptions {
        relative: 1e-9,
        ..Default::default()
    };
    let variation = |p: f64| curvature_variation(one(p, text).surface.as_ref(), &options).value;
    let h = 1e-3;
    let slope = (8.0 * (variation(1.0 + h) - variation(1.0 - h))
        - (variation(1.0 + 2.0 * h) - variation(1.0 - 2.0 * h)))
        / (12.0 * h);
    let rate = bending_rate(&one(1.0, text)).variation;
    let off = (rate.value - slope).abs();
    assert!(
        off <= rate.certainty.error() + 1e-6 * slope.abs(),
        "{rate:?} for {slope}"
    );
    assert!(off <= 1e-4 * slope.abs(), "{rate:?} for {slope}");
}
