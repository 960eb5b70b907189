//! Where a picture is seen from, and how points get onto it.

use crate::error::PictureError;
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// The direction a scene is seen from. z is up; `front` looks along +y, with x to the right.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Radians around z, counter-clockwise from above: 0 front, π/2 right, π back.
    pub azimuth: f64,
    /// Radians above the xy plane: π/2 is the top.
    pub elevation: f64,
    /// Radians by which the camera is turned about its direction, clockwise as the picture's viewer sees the scene turn
    /// counter-clockwise.
    pub roll: f64,
}

impl View {
    /// From -y.
    pub const FRONT: View = View::at(0.0, 0.0);
    /// From +y.
    pub const BACK: View = View::at(PI, 0.0);
    /// From -x.
    pub const LEFT: View = View::at(-FRAC_PI_2, 0.0);
    /// From +x.
    pub const RIGHT: View = View::at(FRAC_PI_2, 0.0);
    /// From +z, y upward in the picture.
    pub const TOP: View = View::at(0.0, FRAC_PI_2);
    /// From -z, x to the right.
    pub const BOTTOM: View = View::at(0.0, -FRAC_PI_2);
    /// From (1, -1, 1): the three axes look equally long. The elevation is atan(1/√2).
    pub const ISO: View = View::at(FRAC_PI_4, 0.615_479_708_670_387_3);

    const NAMED: [(&'static str, View); 7] = [
        ("front", View::FRONT),
        ("back", View::BACK),
        ("left", View::LEFT),
        ("right", View::RIGHT),
        ("top", View::TOP),
        ("bottom", View::BOTTOM),
        ("iso", View::ISO),
    ];

    /// From an azimuth and an elevation in radians.
    pub const fn at(azimuth: f64, elevation: f64) -> View {
        View {
            azimuth,
            elevation,
            roll: 0.0,
        }
    }

    /// The unit vectors to the picture's right, to its top and towards the eye.
    pub fn axes(&self) -> [DVec3; 3] {
        // sin and cos of the named directions must be exact for symmetric pictures.
        let ((sa, ca), (se, ce), (sr, cr)) =
            (clean(self.azimuth), clean(self.elevation), clean(self.roll));
        let right = DVec3::new(ca, sa, 0.0);
        let eye = DVec3::new(sa * ce, -ca * ce, se);
        let up = eye.cross(right);
        [right * cr - up * sr, up * cr + right * sr, eye]
    }
}

/// sin and cos, exact at multiples of a quarter turn. Rounding of π leaves 6e-17 there, which would tilt axis views.
fn clean(angle: f64) -> (f64, f64) {
    const NEGLIGIBLE: f64 = 1e-15;
    let (s, c) = angle.sin_cos();
    let exact = |x: f64| if x.abs() < NEGLIGIBLE { 0.0 } else { x };
    (exact(s), exact(c))
}

impl Default for View {
    fn default() -> View {
        View::ISO
    }
}

impl std::str::FromStr for View {
    type Err = PictureError;

    /// A name (`front`, `back`, `left`, `right`, `top`, `bottom`, `iso`) or `azimuth,elevation` or
    /// `azimuth,elevation,roll` in degrees.
    fn from_str(text: &str) -> Result<View, PictureError> {
        if let Some((_, view)) = View::NAMED.iter().find(|(name, _)| *name == text.trim()) {
            return Ok(*view);
        }
        let angles: Option<Vec<f64>> = text
            .split(',')
            .map(|s| s.trim().parse::<f64>().ok().filter(|x| x.is_finite()))
            .collect();
        match angles.as_deref() {
            Some([a, e]) => Ok(View::at(a.to_radians(), e.to_radians())),
            Some([a, e, r]) => Ok(View {
                roll: r.to_radians(),
                ..View::at(a.to_radians(), e.to_radians())
            }),
            _ => Err(PictureError::View {
                text: text.to_owned(),
                known: "front, back, left, right, top, bottom, iso",
            }),
        }
    }
}

/// How depth changes size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Projection {
    /// As an eye sees.
    Perspective {
        /// The vertical field of view in radians.
        field_of_view: f64,
    },
    /// Parallel rays: lengths square to the view keep their ratio.
    Parallel,
}

impl Default for Projection {
    /// A perspective of 28°, about that of a person looking at a thing on a table.
    fn default() -> Projection {
        Projection::Perspective {
            field_of_view: 28f64.to_radians(),
        }
    }
}

/// A rectangle of the picture in pixels, y downward.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    pub(crate) min: DVec2,
    pub(crate) max: DVec2,
}

/// A point on the picture.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Pixel {
    pub(crate) x: f64,
    pub(crate) y: f64,
    /// What is linear over the picture and greater when nearer: 1/distance in perspective, minus the distance otherwise.
    pub(crate) near: f64,
}

/// Takes points to the picture.
#[derive(Clone, Debug)]
pub(crate) struct Camera {
    /// What points are measured from: keeps digits far from the origin.
    pub(crate) origin: DVec3,
    axes: [DVec3; 3],
    /// Coordinates of the eye (perspective) or of the middle (parallel) along the axes.
    eye: DVec3,
    /// Pixels per unit: at distance 1 in perspective.
    scale: f64,
    centre: DVec2,
    perspective: bool,
}

/// Share of the scene's size that the eye is moved back beyond what the frame needs, so that no point is at the eye.
const STAND_OFF: f64 = 0.02;

impl Camera {
    /// A camera that shows all points within the frame, as large as possible.
    pub(crate) fn fit(
        view: View,
        projection: Projection,
        frame: Frame,
        points: impl Iterator<Item = DVec3> + Clone,
    ) -> Camera {
        let axes = view.axes();
        let (lo, hi) = points
            .clone()
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| {
                (lo.min(p), hi.max(p))
            });
        let origin = if lo.is_finite() {
            lo + (hi - lo) / 2.0
        } else {
            DVec3::ZERO
        };
        let radius = if lo.is_finite() {
            ((hi - lo) / 2.0).length()
        } else {
            0.0
        };
        // A scene of one point has no size to fit.
        let size = if radius > 0.0 {
            radius
        } else {
            origin.length().max(1.0)
        };
        let local = points.map(move |p| {
            let d = p - origin;
            DVec3::new(d.dot(axes[0]), d.dot(axes[1]), -d.dot(axes[2]))
        });
        let half = (frame.max - frame.min) / 2.0;
        let centre = (frame.max + frame.min) / 2.0;
        match projection {
            Projection::Parallel => {
                let (lo, hi) = local.fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| {
                    (lo.min(p), hi.max(p))
                });
                let (lo, hi) = if lo.is_finite() {
                    (lo, hi)
                } else {
                    (DVec3::ZERO, DVec3::ZERO)
                };
                let extent = ((hi - lo) / 2.0).max(DVec3::splat(size * 1e-3));
                let scale = (half.x / extent.x).min(half.y / extent.y);
                Camera {
                    origin,
                    axes,
                    eye: lo + (hi - lo) / 2.0,
                    scale,
                    centre,
                    perspective: false,
                }
            }
            Projection::Perspective { field_of_view } => {
                let ty = (field_of_view / 2.0).tan();
                let tx = ty * half.x / half.y;
                // The four sides of the pyramid of sight touch the scene: each is one linear condition on the eye.
                let (mut r, mut l, mut t, mut b) = (
                    f64::NEG_INFINITY,
                    f64::INFINITY,
                    f64::NEG_INFINITY,
                    f64::INFINITY,
                );
                for p in local {
                    r = r.max(p.x - p.z * tx);
                    l = l.min(p.x + p.z * tx);
                    t = t.max(p.y - p.z * ty);
                    b = b.min(p.y + p.z * ty);
                }
                if !r.is_finite() {
                    (r, l, t, b) = (0.0, 0.0, 0.0, 0.0);
                }
                let z = ((l - r) / (2.0 * tx)).min((b - t) / (2.0 * ty)) - STAND_OFF * size;
                let eye = DVec3::new((r + l) / 2.0, (t + b) / 2.0, z);
                Camera {
                    origin,
                    axes,
                    eye,
                    scale: half.y / ty,
                    centre,
                    perspective: true,
                }
            }
        }
    }

    /// The point in the camera's coordinates: right, up, away.
    fn local(&self, p: DVec3) -> DVec3 {
        let d = p - self.origin;
        DVec3::new(
            d.dot(self.axes[0]),
            d.dot(self.axes[1]),
            -d.dot(self.axes[2]),
        ) - self.eye
    }

    /// The eye in space; `None` for parallel rays.
    pub(crate) fn eye(&self) -> Option<DVec3> {
        let [x, y, z] = self.axes;
        let eye = self.origin + x * self.eye.x + y * self.eye.y - z * self.eye.z;
        self.perspective.then_some(eye)
    }

    pub(crate) fn project(&self, p: DVec3) -> Pixel {
        let q = self.local(p);
        let s = if self.perspective {
            self.scale / q.z
        } else {
            self.scale
        };
        let near = if self.perspective { 1.0 / q.z } else { -q.z };
        Pixel {
            x: self.centre.x + q.x * s,
            y: self.centre.y - q.y * s,
            near,
        }
    }

    /// The distance along the view of something with this nearness.
    pub(crate) fn distance(&self, near: f64) -> f64 {
        if self.perspective { 1.0 / near } else { -near }
    }

    /// Shares of a triangle's corners at a place with shares `b` on the picture.
    pub(crate) fn shares(&self, b: [f64; 3], corners: &[Pixel; 3]) -> [f64; 3] {
        if !self.perspective {
            return b;
        }
        let w = [
            b[0] * corners[0].near,
            b[1] * corners[1].near,
            b[2] * corners[2].near,
        ];
        let sum = w[0] + w[1] + w[2];
        w.map(|x| x / sum)
    }

    /// The unit vector from a point to the eye.
    pub(crate) fn to_eye(&self, p: DVec3) -> DVec3 {
        if !self.perspective {
            return self.axes[2];
        }
        let q = self.local(p);
        -(self.axes[0] * q.x + self.axes[1] * q.y - self.axes[2] * q.z).normalize_or(-self.axes[2])
    }

    /// The unit vectors to the right, up and towards the viewer.
    pub(crate) fn axes(&self) -> [DVec3; 3] {
        self.axes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn named_views_look_along_the_axes() {
        for (view, right, up, eye) in [
            (View::FRONT, DVec3::X, DVec3::Z, -DVec3::Y),
            (View::BACK, -DVec3::X, DVec3::Z, DVec3::Y),
            (View::LEFT, -DVec3::Y, DVec3::Z, -DVec3::X),
            (View::RIGHT, DVec3::Y, DVec3::Z, DVec3::X),
            (View::TOP, DVec3::X, DVec3::Y, DVec3::Z),
            (View::BOTTOM, DVec3::X, -DVec3::Y, -DVec3::Z),
        ] {
            assert_eq!(view.axes(), [right, up, eye]);
        }
        let [_, _, eye] = View::ISO.axes();
        assert!((eye - DVec3::new(1.0, -1.0, 1.0).normalize()).length() < 1e-15);
        assert_eq!("90, 0".parse::<View>().unwrap().axes(), View::RIGHT.axes());
        assert!("frnt".parse::<View>().is_err() && "1,nan".parse::<View>().is_err());
    }

    #[test]
    fn everything_fits_and_touches_the_frame() {
        let frame = Frame {
            min: DVec2::new(10.0, 20.0),
            max: DVec2::new(410.0, 270.0),
        };
        let points: Vec<DVec3> = (0..300)
            .map(|k| {
                let (s, c) = (k as f64 * 0.7).sin_cos();
                DVec3::new(1e6 + 3.0 * s, -1e6 + c, 1e6 + 0.01 * k as f64)
            })
            .collect();
        for projection in [Projection::Parallel, Projection::default()] {
            for view in [
                View::ISO,
                View::FRONT,
                View {
                    roll: 0.3,
                    ..View::at(2.0, -1.0)
                },
            ] {
                let camera = Camera::fit(view, projection, frame, points.iter().copied());
                let seen: Vec<Pixel> = points.iter().map(|p| camera.project(*p)).collect();
                let (mut slack, tolerance) = (f64::INFINITY, 1e-6);
                for p in &seen {
                    for gap in [
                        p.x - frame.min.x,
                        frame.max.x - p.x,
                        p.y - frame.min.y,
                        frame.max.y - p.y,
                    ] {
                        assert!(gap > -tolerance);
                        slack = slack.min(gap);
                    }
                    assert!(camera.distance(p.near).is_finite());
                }
                // The stand-off costs a few pixels of 250.
                assert!(slack < 4.0, "{slack}");
            }
        }
    }
}
