//! Exact parametric surfaces with certified answers.
//!
//! A surface here is a formula, not a net of samples: it has exact derivatives of any order, it encloses itself and its
//! derivatives over any rectangle of parameters with proven bounds, and it converts to NURBS exactly wherever an exact
//! form exists. What approximates (a mesh, an area, a conversion) says how far it is from the truth, and whether that is
//! proven: see [`Certainty`].
//!
//! # A tour
//!
//! A profile curve, turned about the z axis:
//!
//! ```
//! use nappe::curve::{Ellipse, EllipseOptions};
//! use nappe::mesh::{MeshOptions, mesh};
//! use nappe::surface::{Normal, RevolutionOptions, normal_at};
//! use nappe::{Certainty, Curve, DVec3, Frame, Interval, Limit, Revolution, Surface, SurfaceRef};
//! use std::{f64::consts::FRAC_PI_2, sync::Arc};
//!
//! // A curve: a quarter of a circle with radius 2 in the plane y = 0, from the axis down to the equator.
//! let arc = EllipseOptions { from: FRAC_PI_2, to: 0.0, normal: -DVec3::Y, x_direction: Some(DVec3::X) };
//! let profile = Ellipse::new(DVec3::ZERO, [2.0, 2.0], arc)?;
//! assert!((profile.point(0.0) - DVec3::new(0.0, 0.0, 2.0)).length() < 1e-15);
//!
//! // A surface: half a sphere. Its parameters u and v run over [0, 1]; at u = 0 is the pole.
//! let dome = Revolution::new(Arc::new(profile), Frame::WORLD, RevolutionOptions::default())?;
//!
//! // A jet: the point with its derivatives, here up to order 2. Where the surface has no single formula, at breaks, the
//! // limits say from which side.
//! let jet = dome.jet([1.0, 0.25], [Limit::Above; 2], 2);
//! assert!((jet.point() - DVec3::new(0.0, 2.0, 0.0)).length() < 1e-14);
//! assert!(matches!(normal_at(&dome, [0.0, 0.0], [Limit::Above; 2]), Normal::Regular(_) | Normal::Limit(_)));
//!
//! // An enclosure: boxes that are proven to contain the surface, and its derivatives, over a rectangle of parameters.
//! let part = [Interval::new(0.4, 0.5), Interval::new(0.0, 0.1)];
//! let boxes = dome.enclose(part, 1);
//! assert!(boxes[0].contains(dome.point([0.43, 0.07])));
//!
//! // A mesh within 0.01 of the surface, both ways, with proof. Many surfaces are meshed together, watertight.
//! let dome: SurfaceRef = Arc::new(dome);
//! let triangles = mesh(&[dome.clone()], &MeshOptions::with_tol(0.01))?;
//! assert!(matches!(triangles.patches[0].deviation, Certainty::Bounded(e) if e <= 0.01));
//!
//! // The exact NURBS form. By angle there is none, but rational arcs draw the same half of a sphere.
//! assert!(dome.to_nurbs().is_none());
//! let nurbs = dome.to_rational().expect("a circle turned is rational");
//! assert!((nurbs.point([0.3, 0.8]).length() - 2.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Where things are
//!
//! * [`curve`]: the trait [`Curve`] and its kinds; [`basis`]: lists of functions of one variable.
//! * [`surface`]: the trait [`Surface`], the separable engine [`Separable`] and the kinds built on it.
//! * [`exact`]: NURBS curves and surfaces, their tools, conversion and approximation.
//! * [`body`]: faces that share edges, as other systems exchange them.
//! * [`mesh`](mod@mesh): certified triangles. [`measure`]: area, volume, curvature, continuity, each with its error.
//! * [`query`]: nearest points, with proofs.
//! * [`velocity`]: how curves and surfaces move with a number that they are made of.
//! * [`expr`]: formulas as text. [`laws`]: what every curve and surface must obey, as a test of one line.
//!
//! # Conventions
//!
//! Lengths are in the caller's unit, angles in radians. u comes before v. The side *south* is v = 0, *north* v = 1,
//! *west* u = 0, *east* u = 1. A surface is oriented by `r_u × r_v`. A tolerance `tol` says what it bounds. Nothing here
//! panics on data: what is wrong is a typed error with the place and the numbers.

pub mod basis;
pub mod body;
pub mod curve;
pub mod exact;
pub mod expr;
pub mod laws;
pub mod maps;
pub mod measure;
pub mod mesh;
pub mod query;
pub mod scalar;
pub mod series;
pub mod surface;
pub mod velocity;

mod ball;
mod box3;
mod breaks;
mod clusters;
mod frame;
mod interval;
mod linear;
pub mod parallel;
mod ranked;
mod significant;
mod simd;
mod size;
mod units;

pub use box3::Box3;
pub use breaks::{Break, Breaks, Limit, Part, UNIT_BREAKS, merge_breaks};
pub use curve::{Curve, CurveRef};
pub use exact::{NurbsCurve, NurbsSurface};
pub use frame::{Frame, FrameError, cos_sin};
pub use glam::{DAffine3, DMat3, DVec3, DVec4};
pub use interval::Interval;
pub use mesh::{Certainty, Mesh, MeshOptions};
pub use significant::significant;
pub use size::{LARGEST_LENGTH, SMALLEST_EXTENT};
pub use surface::{
    Contour, Coons, CoonsOptions, DiagonalKey, DiagonalKeyOptions, Dir, Fillet, FilletOptions,
    Quadric, Revolution, RevolutionOptions, Separable, Side, Surface, SurfaceRef, Torus,
};
pub use units::Units;
