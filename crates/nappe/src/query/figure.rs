//! Figures of a surface whose zeros are curves on it: sections, silhouettes, isophotes, lines of equal curvature.

use super::field::{Field, FieldJet};
use crate::breaks::{Break, Breaks, Limit};
use crate::interval::Interval;
use crate::measure::{
    CurvatureKind, FigureJet, Implicit, NormalFigure, Pole, curvature_over, curvature_range,
    height_over, height_range, implicit_over, implicit_range, normal_over, normal_range, poles,
    size,
};
use crate::surface::{Dir, SurfaceRef};
use glam::DVec3;

/// Which curve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Figure {
    /// Where the surface meets the plane through a point with a normal.
    Section {
        /// A point of the plane.
        point: DVec3,
        /// Its normal, of any length.
        normal: DVec3,
    },
    /// Where the surface meets another one that is given by its equation, whole and without ends.
    Meets(Implicit),
    /// Where it is seen edge-on from a direction: the contour of a parallel projection.
    Silhouette {
        /// The direction of view.
        direction: DVec3,
    },
    /// Where it is seen edge-on from a point.
    SilhouetteFrom {
        /// The eye.
        eye: DVec3,
    },
    /// Where the normal `r_u × r_v` has an angle with a direction: equally lit by light from there.
    Isophote {
        /// The direction.
        direction: DVec3,
        /// The angle in radians, from 0 to π.
        angle: f64,
    },
    /// Where a curvature has a value. Signs are those of [`Curvature`](crate::measure::Curvature).
    Curvature {
        /// Which curvature.
        kind: CurvatureKind,
        /// The value in 1/length, of the Gaussian curvature 1/length².
        value: f64,
    },
}

/// Why a figure is none.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum FigureError {
    /// A direction is zero or not finite.
    #[error("the direction ({}, {}, {}) must be finite and not zero", .0.x, .0.y, .0.z)]
    Direction(DVec3),
    /// A point is not finite.
    #[error("the point ({}, {}, {}) must be finite", .0.x, .0.y, .0.z)]
    Point(DVec3),
    /// An angle is not between 0 and half a turn.
    #[error("the angle of the normal is {0} radians: it must be between 0 and pi (180deg)")]
    Angle(f64),
    /// A radius or an angle of the other surface is out of range.
    #[error("the other surface has the {what} {value}: it must be {needed}")]
    Size {
        /// Which.
        what: &'static str,
        /// What was given.
        value: f64,
        /// What would be right.
        needed: &'static str,
    },
    /// A curvature is not finite.
    #[error("the curvature is {0}: it must be a finite number")]
    Value(f64),
}

/// A figure of a surface as a function of its parameters, zero on the curve. Cost: jets of order 2 for sections, 3 for
/// what the normal says, 4 for curvatures; on borders 7 to 9.
#[derive(Clone, Debug)]
pub struct SurfaceField {
    surface: SurfaceRef,
    figure: Figure,
    size: f64,
    poles: Vec<Pole>,
}

impl SurfaceField {
    /// A figure of a surface. Errors: a direction is zero, a number is not finite or out of range.
    ///
    /// ```
    /// use nappe::query::{Figure, SurfaceField, TraceOptions, trace};
    /// use nappe::surface::{Torus, TorusOptions};
    /// use nappe::{DVec3, SurfaceRef};
    /// use std::sync::Arc;
    ///
    /// let torus: SurfaceRef = Arc::new(Torus::new(3.0, 1.0, TorusOptions::default()).unwrap());
    /// let plane = Figure::Section { point: DVec3::new(2.9, 0.0, 0.0), normal: DVec3::X };
    /// let field = SurfaceField::new(torus.clone(), plane).unwrap();
    /// let options = TraceOptions { surface: Some(torus), ..Default::default() };
    /// let curve = trace(&field, &options).unwrap().branches[0].curve();
    /// assert!((curve.point(0.5).x - 2.9).abs() < 1e-5);
    /// ```
    pub fn new(surface: SurfaceRef, figure: Figure) -> Result<Self, FigureError> {
        let figure = match figure {
            Figure::Section { point: p, normal } => Figure::Section {
                point: point(p)?,
                normal: direction(normal)?,
            },
            Figure::Meets(other) => Figure::Meets(checked(other)?),
            Figure::Silhouette { direction: d } => Figure::Silhouette {
                direction: direction(d)?,
            },
            Figure::SilhouetteFrom { eye } => Figure::SilhouetteFrom { eye: point(eye)? },
            Figure::Isophote {
                direction: d,
                angle,
            } => {
                if !(0.0..=std::f64::consts::PI).contains(&angle) {
                    return Err(FigureError::Angle(angle));
                }
                Figure::Isophote {
                    direction: direction(d)?,
                    angle,
                }
            }
            Figure::Curvature { value, .. } if !value.is_finite() => {
                return Err(FigureError::Value(value));
            }
            curvature @ Figure::Curvature { .. } => curvature,
        };
        let size = size(surface.as_ref());
        let poles = poles(surface.as_ref(), size);
        Ok(Self {
            surface,
            figure,
            size,
            poles,
        })
    }

    /// The order of the derivatives of the surface in the figure.
    fn order(&self) -> i32 {
        match self.figure {
            Figure::Section { .. } | Figure::Meets(_) => 0,
            Figure::Curvature { .. } => 2,
            _ => 1,
        }
    }

    fn over(&self, uv: [Interval; 2]) -> FigureJet {
        let surface = self.surface.as_ref();
        let normal = |figure| normal_over(surface, uv, &self.poles, figure);
        match self.figure {
            Figure::Section { point, normal } => height_over(surface, uv, point, normal),
            Figure::Meets(other) => implicit_over(surface, uv, other),
            Figure::Silhouette { direction } => normal(NormalFigure::Along(direction)),
            Figure::SilhouetteFrom { eye } => normal(NormalFigure::Towards(eye)),
            Figure::Isophote { direction, angle } => {
                normal(NormalFigure::Angle(direction, angle.cos()))
            }
            Figure::Curvature { kind, value } => {
                let mut j = curvature_over(surface, uv, &self.poles, self.size, kind);
                j[0] = j[0] - Interval::point(value);
                j
            }
        }
    }

    /// The range of the figure over a box in one analytic piece that is narrow in one direction.
    fn range(&self, uv: [Interval; 2]) -> Interval {
        let surface = self.surface.as_ref();
        let normal = |figure| normal_range(surface, uv, &self.poles, figure);
        match self.figure {
            Figure::Section { point, normal } => height_range(surface, uv, point, normal),
            Figure::Meets(other) => implicit_range(surface, uv, other),
            Figure::Silhouette { direction } => normal(NormalFigure::Along(direction)),
            Figure::SilhouetteFrom { eye } => normal(NormalFigure::Towards(eye)),
            Figure::Isophote { direction, angle } => {
                normal(NormalFigure::Angle(direction, angle.cos()))
            }
            Figure::Curvature { kind, value } => {
                curvature_range(surface, uv, &self.poles, self.size, kind) - Interval::point(value)
            }
        }
    }

    /// The parts of a range of a parameter in one analytic piece each, and the least number of derivatives of the figure that
    /// are continuous between them. A single parameter on a break is stretched a little into the piece that is meant.
    fn parts(&self, breaks: &[Break], t: Interval, beside: Interval) -> (Vec<Interval>, i32) {
        let inner = &breaks[1..breaks.len() - 1];
        let smooth = |b: &Break| b.smooth - self.order();
        if t.is_point() {
            let Some(b) = inner.iter().find(|b| b.at == t.lo) else {
                return (vec![t], i32::MAX);
            };
            // The break may be at 0: then the width of the piece says how small a step is.
            let step = |limit: Limit| {
                let piece = breaks.piece(breaks.find(t.lo, limit));
                4.0 * f64::EPSILON * t.mag().max(piece.width())
            };
            let below = Interval {
                lo: t.lo - step(Limit::Below),
                hi: t.hi,
            };
            let above = Interval {
                lo: t.lo,
                hi: t.hi + step(Limit::Above),
            };
            return match smooth(b) {
                s if s >= 0 => (vec![below, above], s),
                _ if beside.hi <= t.lo => (vec![below], i32::MAX),
                _ => (vec![above], i32::MAX),
            };
        }
        let across = inner.iter().filter(|b| t.lo < b.at && b.at < t.hi);
        let least = across.map(smooth).min().unwrap_or(i32::MAX);
        (breaks.parts(t).into_iter().map(|p| p.0).collect(), least)
    }
}

fn direction(d: DVec3) -> Result<DVec3, FigureError> {
    d.try_normalize()
        .filter(|d| d.is_finite())
        .ok_or(FigureError::Direction(d))
}

fn point(p: DVec3) -> Result<DVec3, FigureError> {
    if p.is_finite() {
        Ok(p)
    } else {
        Err(FigureError::Point(p))
    }
}

/// The other surface with a unit axis.
fn checked(other: Implicit) -> Result<Implicit, FigureError> {
    let length = |what: &'static str, value: f64| {
        let needed = "a positive, finite length";
        let sound = value > 0.0 && value.is_finite();
        if sound {
            Ok(value)
        } else {
            Err(FigureError::Size {
                what,
                value,
                needed,
            })
        }
    };
    Ok(match other {
        Implicit::Sphere { center, radius } => Implicit::Sphere {
            center: point(center)?,
            radius: length("radius", radius)?,
        },
        Implicit::Cylinder {
            point: p,
            axis,
            radius,
        } => Implicit::Cylinder {
            point: point(p)?,
            axis: direction(axis)?,
            radius: length("radius", radius)?,
        },
        Implicit::Cone {
            apex,
            axis,
            half_angle,
        } => {
            if !(half_angle > 0.0 && half_angle < std::f64::consts::FRAC_PI_2) {
                let needed = "an angle between 0 and pi/2 (90deg)";
                return Err(FigureError::Size {
                    what: "half angle",
                    value: half_angle,
                    needed,
                });
            }
            Implicit::Cone {
                apex: point(apex)?,
                axis: direction(axis)?,
                half_angle,
            }
        }
        Implicit::Torus {
            center,
            axis,
            major,
            minor,
        } => Implicit::Torus {
            center: point(center)?,
            axis: direction(axis)?,
            major: length("major radius", major)?,
            minor: length("minor radius", minor)?,
        },
    })
}

impl Field for SurfaceField {
    fn domain(&self) -> [Interval; 2] {
        self.surface.domain()
    }

    fn jumps(&self, dir: Dir) -> Vec<f64> {
        self.surface.breaks(dir).below(self.order())
    }

    fn enclose(&self, uv: [Interval; 2], beside: [Interval; 2]) -> Option<FieldJet> {
        let [u, v] = [Dir::U, Dir::V].map(|dir| {
            let d = dir as usize;
            self.parts(self.surface.breaks(dir), uv[d], beside[d])
        });
        let mut hull: Option<FieldJet> = None;
        for &u in &u.0 {
            for &v in &v.0 {
                let j = self.over([u, v]);
                hull = Some(match hull {
                    None => j,
                    Some(h) => [0, 1, 2, 3, 4, 5].map(|k| h[k].hull(j[k])),
                });
            }
        }
        // Across a crease of the figure the derivative along it does not jump, so only one second derivative is lost.
        let mut j = hull?;
        if u.1 < 1 {
            j[3] = Interval::ENTIRE;
        }
        if v.1 < 1 {
            j[5] = Interval::ENTIRE;
        }
        Some(j)
    }

    fn edge(&self, uv: [Interval; 2], beside: [Interval; 2]) -> Option<Interval> {
        let [u, v] = [Dir::U, Dir::V].map(|dir| {
            let d = dir as usize;
            self.parts(self.surface.breaks(dir), uv[d], beside[d]).0
        });
        let pairs = u.iter().flat_map(|&u| v.iter().map(move |&v| [u, v]));
        pairs.map(|uv| self.range(uv)).reduce(Interval::hull)
    }
}
