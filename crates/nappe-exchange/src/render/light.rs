//! How surfaces look: three lights and a sky, or the stripes of a light tunnel.

use super::colour::{linear, mix, rgb};
use crate::scene::Colour;
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// The lamps of a portrait: key from the upper left, fill from the right, rim from behind, fixed to the camera.
const KEY: Vec3 = Vec3::new(-0.47, 0.66, 0.59);
const FILL: Vec3 = Vec3::new(0.80, 0.10, 0.59);
const RIM: Vec3 = Vec3::new(0.30, 0.65, -0.70);
const KEY_LIGHT: Vec3 = Vec3::new(0.72, 0.705, 0.68);
const FILL_LIGHT: Vec3 = Vec3::new(0.125, 0.14, 0.16);
const RIM_LIGHT: Vec3 = Vec3::new(0.16, 0.17, 0.19);
const SKY: Vec3 = Vec3::new(0.32, 0.335, 0.36);
const GROUND: Vec3 = Vec3::new(0.20, 0.19, 0.18);
/// How far the key light reaches around: soft, as from a large lamp.
const WRAP: f32 = 0.2;
const GLOSS: f32 = 0.10;
const GLOSS_EXPONENT: f32 = 42.0;
/// The colour that the back of a surface is mixed with, and how much: a reversed surface is seen at a glance.
const BACK: Colour = rgb(0x8c7f78);
const BACK_SHARE: f32 = 0.45;
/// Numbers shown as colours must be read off a legend: light may only darken them this much.
const DATA_SHADE: f32 = 0.34;
const DARK: Colour = rgb(0x2b3440);
const BRIGHT: Colour = rgb(0xf4f5f6);
/// How much the light darkens stripes: just enough to see the form.
const STRIPE_SHADE: f32 = 0.28;

/// What a place of a surface is made of.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Stuff {
    /// Paint, in sRGB.
    Paint(Colour),
    /// A colour that stands for a number, in sRGB.
    Data(Colour),
    /// A mirror in a tunnel with this many stripes.
    Zebra(f64),
}

/// A place on a surface.
pub(crate) struct Place {
    /// The unit normal of the side that is seen.
    pub(crate) normal: DVec3,
    /// The unit vector to the eye.
    pub(crate) eye: DVec3,
    /// Whether the side is the back.
    pub(crate) back: bool,
}

/// The light, linear, that reaches the eye.
pub(crate) fn shade(stuff: Stuff, place: &Place, axes: &[DVec3; 3]) -> Vec3 {
    let in_camera = |d: DVec3| Vec3::from(axes.map(|a| d.dot(a) as f32));
    let (n, eye) = (in_camera(place.normal), in_camera(place.eye));
    match stuff {
        Stuff::Paint(colour) => {
            let colour = if place.back {
                mix(colour, BACK, BACK_SHARE)
            } else {
                colour
            };
            painted(Vec3::from(colour.map(linear)), n, eye)
        }
        Stuff::Data(colour) => {
            let soft = 0.5 + 0.5 * n.dot(KEY.normalize());
            Vec3::from(colour.map(linear))
                * (1.0 - DATA_SHADE + DATA_SHADE * (soft * 1.12).min(1.0))
        }
        Stuff::Zebra(stripes) => striped(
            place,
            axes,
            phase(place, axes, stripes).floor().rem_euclid(2.0) == 1.0,
        ),
    }
}

/// The light from a dark or a bright stripe.
pub(crate) fn striped(place: &Place, axes: &[DVec3; 3], dark: bool) -> Vec3 {
    let n = Vec3::from(axes.map(|a| place.normal.dot(a) as f32));
    let base = Vec3::from(if dark { DARK } else { BRIGHT }.map(linear));
    base * (1.0 - STRIPE_SHADE + STRIPE_SHADE * (0.5 + 0.5 * n.dot(KEY.normalize())))
}

fn painted(colour: Vec3, n: Vec3, eye: Vec3) -> Vec3 {
    let lamp = |direction: Vec3, wrap: f32| {
        ((n.dot(direction.normalize()) + wrap) / (1.0 + wrap)).max(0.0)
    };
    let sky = GROUND + (SKY - GROUND) * (0.5 + 0.5 * n.y);
    let light = sky
        + KEY_LIGHT * lamp(KEY, WRAP)
        + FILL_LIGHT * lamp(FILL, WRAP)
        + RIM_LIGHT * lamp(RIM, 0.0);
    let half = (KEY.normalize() + eye).normalize_or_zero();
    let gloss = GLOSS * n.dot(half).max(0.0).powf(GLOSS_EXPONENT);
    let edge = 0.10 * (1.0 - n.dot(eye).clamp(0.0, 1.0)).powi(3);
    soft_limit(colour * light + Vec3::splat(gloss) + SKY * edge)
}

/// Keeps bright colours from losing their hue at the limit of the screen.
fn soft_limit(c: Vec3) -> Vec3 {
    const KNEE: f32 = 0.8;
    c.map(|x| {
        if x < KNEE {
            x
        } else {
            1.0 - (1.0 - KNEE) * (-(x - KNEE) / (1.0 - KNEE)).exp()
        }
    })
}

/// Where in the stripes the mirrored line of sight ends: odd whole parts are dark. The stripes are equal steps of its
/// angle to the picture's upward axis. A break in a stripe is a break of tangency, a corner in it one of curvature.
pub(crate) fn phase(place: &Place, axes: &[DVec3; 3], stripes: f64) -> f64 {
    let mirrored = place.normal * (2.0 * place.normal.dot(place.eye)) - place.eye;
    mirrored.dot(axes[1]).clamp(-1.0, 1.0).acos() / PI * 2.0 * stripes
}
