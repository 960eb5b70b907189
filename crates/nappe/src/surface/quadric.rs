//! The quadrics: exact rational surfaces of degree at most 2 × 2.

use super::turned::{carried_round, homogeneous};
use super::{Elementary, Surface, Swept, swept};
use crate::basis::{BSplineBasis, Functions};
use crate::exact::{ConicArcs, NurbsCurve, NurbsSurface};
use crate::frame::Frame;
use glam::{DVec3, DVec4, Vec4Swizzles};
use std::f64::consts::{FRAC_PI_2, TAU};
use thiserror::Error;

/// Relative excess of a range over its limits that is taken as rounding.
const ROUNDING: f64 = 1e-12;

/// The ten shapes. In the coordinates x, y, z of the frame, with semi-axes a, b, c in the order given.
///
/// The seven shapes that go round the z axis have u round it (from the first angle to the second, radians, of the
/// eccentric anomaly: x = ρ a cos, y = ρ b sin; default one turn) and v upwards; their normals `r_u × r_v` point away
/// from the axis.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum QuadricShape {
    /// `x²/a² + y²/b² + z²/c² = 1`. v: the latitude, radians, z = c sin; default and widest -π/2 to π/2 (poles).
    Ellipsoid,
    /// The ellipsoid with one semi-axis, the radius.
    Sphere,
    /// `x²/a² + y²/b² - z²/c² = 1`. v: the height z; default -c to c.
    Hyperboloid1,
    /// `x²/a² + y²/b² - z²/c² = -1`, one of its two sheets. v: the height z; default c to 2c. Heights of at least c are on the upper
    /// sheet, of at most -c on the lower one; the apex is at z = ±c.
    Hyperboloid2,
    /// `x²/a² + y²/b² = z/c`. v: the height z, at least 0 (the apex); default 0 to c.
    EllipticParaboloid,
    /// `x²/a² - y²/b² = z/c`. u: x, default -a to a; v: y, default -b to b. The normals point upwards.
    HyperbolicParaboloid,
    /// `x²/a² + y²/b² = z²/c²`. v: the height z, on one side of the apex z = 0; default 0 to c.
    Cone,
    /// `x²/a² + y²/b² = 1`, two semi-axes, or one for a circular cylinder. v: the height z; default 0 to 2a.
    Cylinder,
    /// `x²/a² = z/c`, semi-axes a and c. u: x, default -a to a; v: y, default 0 to 2a. The normals point upwards.
    ParabolicCylinder,
    /// `x²/a² - y²/b² = 1`, semi-axes a and b, the branch x > 0. u: y, default -b to b; v: z, default 0 to 2a. The
    /// normals point to +x. The other branch: turn the frame by half a turn.
    HyperbolicCylinder,
}

impl QuadricShape {
    /// All shapes.
    pub const ALL: [QuadricShape; 10] = [
        QuadricShape::Ellipsoid,
        QuadricShape::Sphere,
        QuadricShape::Hyperboloid1,
        QuadricShape::Hyperboloid2,
        QuadricShape::EllipticParaboloid,
        QuadricShape::HyperbolicParaboloid,
        QuadricShape::Cone,
        QuadricShape::Cylinder,
        QuadricShape::ParabolicCylinder,
        QuadricShape::HyperbolicCylinder,
    ];

    /// The name in model files.
    pub fn name(self) -> &'static str {
        match self {
            QuadricShape::Ellipsoid => "ellipsoid",
            QuadricShape::Sphere => "sphere",
            QuadricShape::Hyperboloid1 => "hyperboloid-1",
            QuadricShape::Hyperboloid2 => "hyperboloid-2",
            QuadricShape::EllipticParaboloid => "elliptic-paraboloid",
            QuadricShape::HyperbolicParaboloid => "hyperbolic-paraboloid",
            QuadricShape::Cone => "cone",
            QuadricShape::Cylinder => "cylinder",
            QuadricShape::ParabolicCylinder => "parabolic-cylinder",
            QuadricShape::HyperbolicCylinder => "hyperbolic-cylinder",
        }
    }

    /// How many semi-axes may be given, the least and the most.
    pub fn semi_axes(self) -> [usize; 2] {
        match self {
            QuadricShape::Sphere => [1, 1],
            QuadricShape::Cylinder => [1, 2],
            QuadricShape::ParabolicCylinder | QuadricShape::HyperbolicCylinder => [2, 2],
            _ => [3, 3],
        }
    }

    /// True for the shapes whose u goes round the z axis.
    pub fn is_round(self) -> bool {
        !matches!(
            self,
            QuadricShape::HyperbolicParaboloid
                | QuadricShape::ParabolicCylinder
                | QuadricShape::HyperbolicCylinder
        )
    }
}

/// What can be wrong with a quadric.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum QuadricError {
    /// The wrong number of semi-axes.
    #[error("{} semi-axes are given for the shape {}, it takes {}", given, shape.name(), least_most(*.shape))]
    SemiAxisCount {
        /// The shape.
        shape: QuadricShape,
        /// How many are given.
        given: usize,
    },
    /// A semi-axis is not positive and finite.
    #[error("semi-axis {index} is {value}: it must be a positive, finite number")]
    SemiAxis {
        /// Which one, from 0.
        index: usize,
        /// Its value.
        value: f64,
    },
    /// A range is empty, decreasing or not finite.
    #[error("the range of {parameter} is {from} to {to}: it must increase and be finite")]
    Range {
        /// `u` or `v`.
        parameter: char,
        /// The first value.
        from: f64,
        /// The last value.
        to: f64,
    },
    /// A range leaves the part where the shape is.
    #[error(
        "the range of {parameter} is {from} to {to}, but the {} has {meaning} from {least} to {most}", shape.name()
    )]
    Outside {
        /// The shape.
        shape: QuadricShape,
        /// `u` or `v`.
        parameter: char,
        /// What the parameter measures.
        meaning: &'static str,
        /// The first value.
        from: f64,
        /// The last value.
        to: f64,
        /// The least possible value.
        least: f64,
        /// The greatest possible value.
        most: f64,
    },
    /// The numbers are so far apart that the surface leaves the range of double precision.
    #[error(
        "the ranges {range:?} are too large for the semi-axes {semi_axes:?}: coordinates overflow"
    )]
    Overflow {
        /// The ranges of u and v.
        range: [[f64; 2]; 2],
        /// The semi-axes.
        semi_axes: [f64; 3],
    },
    /// A range of heights covers parts of both halves of a cone, or of both sheets of a hyperboloid.
    #[error(
        "the heights {from} to {to} are not on one half of the {}: they must be at least {gap} or at most -{gap}; make two surfaces", shape.name()
    )]
    TwoHalves {
        /// The shape.
        shape: QuadricShape,
        /// The first height.
        from: f64,
        /// The last height.
        to: f64,
        /// The height of the apex.
        gap: f64,
    },
}

fn least_most(shape: QuadricShape) -> String {
    match shape.semi_axes() {
        [a, b] if a == b => a.to_string(),
        [a, b] => format!("{a} or {b}"),
    }
}

/// Where a quadric lies and which part of it is meant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuadricOptions {
    /// The centre (or apex) and the directions x, y, z.
    pub frame: Frame,
    /// The ranges of u and v as the shape says; `None` for its default.
    pub range: [Option<[f64; 2]>; 2],
}

impl Default for QuadricOptions {
    fn default() -> Self {
        Self {
            frame: Frame::WORLD,
            range: [None; 2],
        }
    }
}

/// A quadric or a part of one, on `[0, 1]²`: a smooth composite of rational biquadratic patches of at most a quarter turn
/// each, in one NURBS surface.
///
/// The parameters run evenly over the patches, not over angles: the ranges of [`QuadricShape`] are those of the whole
/// surface. Ends of ranges lie on the given values within rounding, poles and apices collapse exactly.
/// Source: Golovanov, *Geometric modelling*, §3.9 (the nine-vertex patch (3.9.2), weights `cos(α/2)`).
#[derive(Clone, Debug)]
pub struct Quadric {
    nurbs: NurbsSurface,
    shape: QuadricShape,
    semi_axes: [f64; 3],
    frame: Frame,
    range: [[f64; 2]; 2],
}

impl Quadric {
    /// A quadric from its shape and semi-axes.
    pub fn new(
        shape: QuadricShape,
        semi_axes: &[f64],
        options: QuadricOptions,
    ) -> Result<Self, QuadricError> {
        let [least, most] = shape.semi_axes();
        let given = semi_axes.len();
        if given < least || given > most {
            return Err(QuadricError::SemiAxisCount { shape, given });
        }
        if let Some(index) = semi_axes.iter().position(|a| !(*a > 0.0 && a.is_finite())) {
            let value = semi_axes[index];
            return Err(QuadricError::SemiAxis { index, value });
        }
        let a = semi_axes[0];
        let semi_axes = match shape {
            QuadricShape::Sphere => [a; 3],
            QuadricShape::Cylinder => [a, *semi_axes.get(1).unwrap_or(&a), 1.0],
            QuadricShape::ParabolicCylinder => [a, 1.0, semi_axes[1]],
            QuadricShape::HyperbolicCylinder => [a, semi_axes[1], 1.0],
            _ => [a, semi_axes[1], semi_axes[2]],
        };
        let range = ranges(shape, semi_axes, options.range)?;
        let nurbs = surface(shape, semi_axes, &options.frame, range);
        if nurbs.homogeneous().iter().any(|p| !p.is_finite()) {
            return Err(QuadricError::Overflow { range, semi_axes });
        }
        Ok(Self {
            nurbs,
            shape,
            semi_axes,
            frame: options.frame,
            range,
        })
    }

    /// The shape.
    pub fn shape(&self) -> QuadricShape {
        self.shape
    }

    /// The semi-axes along x, y and z; 1 where the shape has none.
    pub fn semi_axes(&self) -> [f64; 3] {
        self.semi_axes
    }

    /// The frame.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The ranges of u and v in the shape's own measure.
    pub fn range(&self) -> [[f64; 2]; 2] {
        self.range
    }

    /// The NURBS surface that this is.
    pub fn nurbs(&self) -> &NurbsSurface {
        &self.nurbs
    }

    /// The left side minus the right side of the shape's equation at a point, and the sum of the absolute values of all
    /// terms: on the surface the first is 0 up to rounding of the second.
    pub fn equation(&self, p: DVec3) -> (f64, f64) {
        let c = self.frame.coordinates(p);
        let [a, b, h] = self.semi_axes;
        let [x2, y2, z2] = [(c.x / a).powi(2), (c.y / b).powi(2), (c.z / h).powi(2)];
        let z = c.z / h;
        let terms: &[f64] = match self.shape {
            QuadricShape::Ellipsoid | QuadricShape::Sphere => &[x2, y2, z2, -1.0],
            QuadricShape::Hyperboloid1 => &[x2, y2, -z2, -1.0],
            QuadricShape::Hyperboloid2 => &[x2, y2, -z2, 1.0],
            QuadricShape::EllipticParaboloid => &[x2, y2, -z],
            QuadricShape::HyperbolicParaboloid => &[x2, -y2, -z],
            QuadricShape::Cone => &[x2, y2, -z2],
            QuadricShape::Cylinder => &[x2, y2, -1.0],
            QuadricShape::ParabolicCylinder => &[x2, -z],
            QuadricShape::HyperbolicCylinder => &[x2, -y2, -1.0],
        };
        (terms.iter().sum(), terms.iter().map(|t| t.abs()).sum())
    }
}

/// The ranges with their defaults, checked.
fn ranges(
    shape: QuadricShape,
    [a, b, c]: [f64; 3],
    given: [Option<[f64; 2]>; 2],
) -> Result<[[f64; 2]; 2], QuadricError> {
    let whole = [0.0, TAU];
    let default = match shape {
        QuadricShape::Ellipsoid | QuadricShape::Sphere => [whole, [-FRAC_PI_2, FRAC_PI_2]],
        QuadricShape::Hyperboloid1 => [whole, [-c, c]],
        QuadricShape::Hyperboloid2 => [whole, [c, 2.0 * c]],
        QuadricShape::EllipticParaboloid | QuadricShape::Cone => [whole, [0.0, c]],
        QuadricShape::HyperbolicParaboloid => [[-a, a], [-b, b]],
        QuadricShape::Cylinder => [whole, [0.0, 2.0 * a]],
        QuadricShape::ParabolicCylinder => [[-a, a], [0.0, 2.0 * a]],
        QuadricShape::HyperbolicCylinder => [[-b, b], [0.0, 2.0 * a]],
    };
    let mut range = [0, 1].map(|k| given[k].unwrap_or(default[k]));
    for ([from, to], parameter) in range.into_iter().zip(['u', 'v']) {
        if !(from.is_finite() && to.is_finite() && from < to) {
            return Err(QuadricError::Range {
                parameter,
                from,
                to,
            });
        }
    }
    let inside = |k: usize, meaning, least: f64, most: f64| {
        let [from, to] = range[k];
        let slack = ROUNDING * (most - least).min(to.abs().max(from.abs()));
        if from < least - slack || to > most + slack {
            return Err(QuadricError::Outside {
                shape,
                parameter: ['u', 'v'][k],
                meaning,
                from,
                to,
                least,
                most,
            });
        }
        Ok([from.max(least), to.min(most)])
    };
    if shape.is_round() {
        let [from, to] = range[0];
        if to - from > TAU * (1.0 + ROUNDING) {
            return Err(QuadricError::Outside {
                shape,
                parameter: 'u',
                meaning: "at most one turn round the axis, here",
                from,
                to,
                least: from,
                most: from + TAU,
            });
        }
    }
    match shape {
        QuadricShape::Ellipsoid | QuadricShape::Sphere => {
            range[1] = inside(1, "latitudes (in radians)", -FRAC_PI_2, FRAC_PI_2)?;
        }
        QuadricShape::EllipticParaboloid => {
            range[1] = inside(1, "heights", 0.0, f64::INFINITY)?;
        }
        QuadricShape::Cone | QuadricShape::Hyperboloid2 => {
            let gap = if shape == QuadricShape::Cone { 0.0 } else { c };
            let [from, to] = range[1];
            let slack = ROUNDING * c;
            range[1] = if from >= gap - slack {
                [from.max(gap), to]
            } else if to <= -gap + slack {
                [from, to.min(-gap)]
            } else {
                return Err(QuadricError::TwoHalves {
                    shape,
                    from,
                    to,
                    gap,
                });
            };
        }
        _ => {}
    }
    Ok(range)
}

/// A quadratic over `[from, to]` in Bernstein form: the points of t and of t².
fn parabola([from, to]: [f64; 2]) -> [[f64; 2]; 3] {
    [
        [from, from * from],
        [0.5 * (from + to), from * to],
        [to, to * to],
    ]
}

/// The control net: a profile `(ρ, 0, ζ, w)` along v carried round along u, or the sum of two curves.
fn surface(
    shape: QuadricShape,
    [a, b, c]: [f64; 3],
    frame: &Frame,
    range: [[f64; 2]; 2],
) -> NurbsSurface {
    let [x, y, z] = frame.directions();
    let e = [x * a, y * b, z * c];
    let quadratic = || BSplineBasis::bernstein(2);
    let linear = || BSplineBasis::bernstein(1);
    let [ru, rv] = range;
    if shape.is_round() {
        let profile_arcs = |arcs: ConicArcs, to: fn(DVec3) -> DVec4| {
            let points: Vec<_> = arcs.points.into_iter().map(to).collect();
            (arcs.basis, points)
        };
        let (basis, profile): (BSplineBasis, Vec<DVec4>) = match shape {
            QuadricShape::Ellipsoid | QuadricShape::Sphere => {
                profile_arcs(ConicArcs::circle(rv[0], rv[1]), |p| {
                    DVec4::new(p.x, 0.0, p.y, p.z)
                })
            }
            QuadricShape::Hyperboloid1 => {
                profile_arcs(ConicArcs::hyperbola(rv[0] / c, rv[1] / c), |p| {
                    DVec4::new(p.x, 0.0, p.y, p.z)
                })
            }
            QuadricShape::Hyperboloid2 => {
                // ρ from the height, without cancellation at the apex.
                let rho = rv.map(|z| ((z.abs() - c) / c * ((z.abs() + c) / c)).sqrt());
                let arcs = ConicArcs::hyperbola(rho[0], rho[1]);
                if rv[0] > 0.0 {
                    profile_arcs(arcs, |p| DVec4::new(p.y, 0.0, p.x, p.z))
                } else {
                    profile_arcs(arcs, |p| DVec4::new(p.y, 0.0, -p.x, p.z))
                }
            }
            QuadricShape::EllipticParaboloid => {
                let points = parabola(rv.map(|z| (z / c).sqrt()));
                let points = points.map(|[rho, zeta]| DVec4::new(rho, 0.0, zeta, 1.0));
                (quadratic(), points.to_vec())
            }
            QuadricShape::Cone => {
                let points = rv.map(|z| DVec4::new((z / c).abs(), 0.0, z / c, 1.0));
                (linear(), points.to_vec())
            }
            _ => {
                let points = rv.map(|z| DVec4::new(1.0, 0.0, z, 1.0));
                (linear(), points.to_vec())
            }
        };
        let round = ConicArcs::circle(ru[0], ru[1]);
        let points = carried_round(&profile, &round.points, e, frame.origin());
        return NurbsSurface::from_homogeneous(round.basis, basis, points);
    }
    let at = |p: DVec3, w: f64| {
        let local = homogeneous(p.extend(w), DVec3::new(1.0, 0.0, 1.0), [x, y, z]);
        (local.xyz() + frame.origin() * w).extend(w)
    };
    match shape {
        QuadricShape::HyperbolicParaboloid => {
            let (px, py) = (parabola(ru.map(|x| x / a)), parabola(rv.map(|y| y / b)));
            let points = px.iter().flat_map(|s| {
                py.map(|t| at(DVec3::new(a * s[0], b * t[0], c * (s[1] - t[1])), 1.0))
            });
            NurbsSurface::from_homogeneous(quadratic(), quadratic(), points.collect())
        }
        QuadricShape::ParabolicCylinder => {
            let px = parabola(ru.map(|x| x / a));
            let points = px
                .iter()
                .flat_map(|s| rv.map(|y| at(DVec3::new(a * s[0], y, c * s[1]), 1.0)));
            NurbsSurface::from_homogeneous(quadratic(), linear(), points.collect())
        }
        _ => {
            let arcs = ConicArcs::hyperbola(ru[0] / b, ru[1] / b);
            let points = arcs
                .points
                .iter()
                .flat_map(|p| rv.map(|z| at(DVec3::new(a * p.x, b * p.y, z * p.z), p.z)));
            NurbsSurface::from_homogeneous(arcs.basis.clone(), linear(), points.collect())
        }
    }
}

impl Surface for Quadric {
    evaluate_through!(self => self.nurbs);

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        Some(self.nurbs.clone())
    }

    fn elementary(&self) -> Option<Elementary> {
        let [a, b, c] = self.semi_axes;
        match self.shape {
            QuadricShape::Cylinder if a == b => Some(Elementary::Cylinder {
                axis: self.frame,
                radius: a,
                outward: true,
            }),
            QuadricShape::Cone if a == b => {
                let [x, _, z] = self.frame.directions();
                let [_, heights] = self.range;
                let up = if heights[0] + heights[1] < 0.0 { -z } else { z };
                Some(Elementary::Cone {
                    axis: Frame::new(self.frame.origin(), up, x).ok()?,
                    slope: a / c,
                    outward: true,
                })
            }
            QuadricShape::Sphere | QuadricShape::Ellipsoid if a == b && b == c => {
                Some(Elementary::Sphere {
                    frame: self.frame,
                    radius: a,
                    outward: true,
                })
            }
            _ => None,
        }
    }

    /// Turned where the shape goes round the axis with equal semi-axes, moved if it is a cylinder.
    fn swept(&self) -> Option<Swept> {
        let [a, b, _] = self.semi_axes;
        if !self.shape.is_round() || self.shape == QuadricShape::Cylinder {
            return swept::moved(&self.nurbs);
        }
        let [from, to] = self.range[0];
        let profile = self.nurbs.basis_v();
        let first = self.nurbs.homogeneous()[..profile.count()].to_vec();
        (a == b).then(|| Swept::Turned {
            curve: NurbsCurve::from_homogeneous(profile.clone(), first),
            axis: self.frame,
            angle: (to - from).min(TAU),
            same: false,
        })
    }
}
