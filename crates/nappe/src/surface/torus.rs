//! The torus.

use super::turned::carried_round;
use super::{Elementary, Surface};
use crate::exact::{ConicArcs, NurbsSurface};
use crate::frame::Frame;
use crate::interval::Interval;
use glam::DVec4;
use std::f64::consts::TAU;
use thiserror::Error;

/// Relative to the torus: a distance from the axis, or the excess of a range over one turn, that is taken as rounding.
const ROUNDING: f64 = 1e-12;

/// What can be wrong with a torus.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum TorusError {
    /// A radius is not a positive, finite number (the major one may be 0).
    #[error("the {name} radius is {value}: it must be a positive, finite number")]
    Radius {
        /// `major` or `minor`.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A range is empty, decreasing, not finite or more than one turn.
    #[error(
        "the range of {parameter} is {} to {} degrees: it must increase, by at most one turn", from.to_degrees(), to.to_degrees()
    )]
    Range {
        /// `u` or `v`.
        parameter: char,
        /// The first angle, radians.
        from: f64,
        /// The last angle, radians.
        to: f64,
    },
    /// The tube crosses the axis.
    #[error(
        "the tube crosses the axis, since the minor radius {minor} exceeds the major radius {major}: keep the range of v between -{} and {} degrees", limit.to_degrees(), limit.to_degrees()
    )]
    CrossesAxis {
        /// The major radius.
        major: f64,
        /// The minor radius.
        minor: f64,
        /// The greatest possible angle in the tube's section to either side of its outermost point, radians.
        limit: f64,
    },
}

/// Where a torus lies and which part of it is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorusOptions {
    /// The centre, and z along the axis.
    pub frame: Frame,
    /// The first and last angle round the axis (u) and round the tube (v, from its outermost circle upwards), radians.
    pub range: [[f64; 2]; 2],
}

impl Default for TorusOptions {
    fn default() -> Self {
        Self {
            frame: Frame::WORLD,
            range: [[0.0, TAU]; 2],
        }
    }
}

/// A torus or a part of one on `[0, 1]²`: in the frame, at angles α (u) and β (v),
/// `((R + r cos β) cos α, (R + r cos β) sin α, r sin β)`.
///
/// An exact NURBS surface of equal biquadratic patches of at most a quarter turn each way, weights `cos` of the half angles;
/// the parameters run evenly over the patches. The normals `r_u × r_v` point out of the tube. With R = r the tube
/// touches the axis in a point, which is allowed; with R < r it must keep to the outer part (|β| at most
/// `arccos(-R/r)`), where it stays on one side of the axis.
/// Source: Golovanov, *Geometric modelling*, §3.9 (a torus piece with weights `cos(α/2)`, `cos(β/2)`).
#[derive(Clone, Debug)]
pub struct Torus {
    nurbs: NurbsSurface,
    major: f64,
    minor: f64,
    options: TorusOptions,
}

impl Torus {
    /// A torus from the radius of the circle round the axis and the radius of the tube.
    pub fn new(major: f64, minor: f64, options: TorusOptions) -> Result<Self, TorusError> {
        if !(major >= 0.0 && major.is_finite()) {
            let (name, value) = ("major", major);
            return Err(TorusError::Radius { name, value });
        }
        if !(minor > 0.0 && minor.is_finite()) {
            let (name, value) = ("minor", minor);
            return Err(TorusError::Radius { name, value });
        }
        for ([from, to], parameter) in options.range.into_iter().zip(['u', 'v']) {
            let turn = to - from;
            if !(turn > 0.0 && turn <= TAU * (1.0 + ROUNDING)) {
                return Err(TorusError::Range {
                    parameter,
                    from,
                    to,
                });
            }
        }
        let [round, section] = options.range.map(|[a, b]| ConicArcs::circle(a, b));
        let on_axis = ROUNDING * (major + minor);
        if major < minor {
            let limit = (-major / minor).acos();
            let [from, to] = options.range[1];
            if major + minor * Interval::new(from, to).cos().lo < -on_axis {
                return Err(TorusError::CrossesAxis {
                    major,
                    minor,
                    limit,
                });
            }
        }
        let last = section.points.len() - 1;
        let profile: Vec<DVec4> = section
            .points
            .iter()
            .enumerate()
            .map(|(i, p)| {
                let rho = major * p.z + minor * p.x;
                let pole = (i == 0 || i == last) && rho.abs() <= on_axis;
                DVec4::new(if pole { 0.0 } else { rho }, 0.0, minor * p.y, p.z)
            })
            .collect();
        let (e, origin) = (options.frame.directions(), options.frame.origin());
        let points = carried_round(&profile, &round.points, e, origin);
        let nurbs = NurbsSurface::from_homogeneous(round.basis, section.basis, points);
        Ok(Self {
            nurbs,
            major,
            minor,
            options,
        })
    }

    /// The radius of the circle round the axis.
    pub fn major(&self) -> f64 {
        self.major
    }

    /// The radius of the tube.
    pub fn minor(&self) -> f64 {
        self.minor
    }

    /// The frame and the ranges.
    pub fn options(&self) -> &TorusOptions {
        &self.options
    }

    /// The NURBS surface that this is.
    pub fn nurbs(&self) -> &NurbsSurface {
        &self.nurbs
    }
}

impl Surface for Torus {
    evaluate_through!(self => self.nurbs);

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        Some(self.nurbs.clone())
    }

    fn elementary(&self) -> Option<Elementary> {
        Some(Elementary::Torus {
            axis: self.options.frame,
            major: self.major,
            minor: self.minor,
            outward: true,
        })
    }
}
