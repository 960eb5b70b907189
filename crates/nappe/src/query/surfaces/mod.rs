//! All curves in which two surfaces meet.
//!
//! The parameters `(u, v, s, t)` of common points solve three equations, `a(u, v) = b(s, t)`: curves in four dimensions. Two
//! ways were weighed. Where one surface is a graph over a plane, its height field on the other one could be traced as a
//! function of two parameters; but such pieces end inside both surfaces, and every branch would have to be glued along their
//! sides. So curves are followed in all four parameters at once, by steps that are proven (`step`, `follow`): each box on the
//! way is shown to hold nothing but one arc. Then boxes of parameters are halved until each is proven empty or lies in boxes
//! of known curves (`search`): that finds places to begin at, and shows that no branch is missing. `pair` is the equations, `join`
//! joins across creases and seams.

mod follow;
mod join;
mod pair;
mod parts;
mod search;
mod step;

use super::path::Path;
use super::trace::BranchEnd;
use crate::clusters::clusters;
use crate::curve::CurveRef;
use crate::interval::Interval;
use crate::measure::size;
use crate::mesh::Certainty;
use crate::surface::SurfaceRef;
use follow::End;
use glam::DVec3;
use join::{Joined, Piece, joined};
use pair::{Box4, Place};
use parts::{Pairs, pairs};
use search::{Open, STEP, search};
use std::array::from_fn;
use std::fmt;
use std::sync::Arc;
use step::{Part4, Stepper};

/// The default tolerance as a share of the size of the smaller surface.
const DEFAULT_TOL: f64 = 1e-6;
/// Boxes nearer than this, relative to the domains, are one place that is not decided.
const ONE_PLACE: f64 = 1e-3;
/// Curves shorter than this, relative to the size, that end where no step could be proven are parts of such a place.
const SCRAP: f64 = 2e-3;
/// The share of what is left of the budget that one pair of parts may take.
const SHARE: usize = 3;
/// At least so many boxes are looked at for each pair of parts between creases, while [`ALL`] allows it.
const LEAST: usize = 2000;
/// All pairs together take no more than so many budgets, a step counting as [`STEP`] boxes.
const ALL: usize = 10;

/// How to intersect two surfaces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntersectOptions {
    /// The greatest distance of a branch from the exact curve, and of that from the branch, in space. `None`: a millionth of the
    /// size of the smaller surface. Where rounding or a place that is almost singular leaves more, the certainty of the branch
    /// says so.
    pub tol: Option<f64>,
    /// The most boxes that are looked at, and the most steps that are tried. Where there are creases at least 2000 are for each
    /// pair of parts between them whose boxes touch, until all together have taken ten times the budget, a step counting as
    /// eight boxes. What is not looked at is told as not decided.
    pub budget: usize,
}

impl Default for IntersectOptions {
    fn default() -> Self {
        Self {
            tol: None,
            budget: 200_000,
        }
    }
}

/// Why surfaces are not intersected.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SurfacesError {
    /// The tolerance is no positive length.
    #[error("the tolerance of the curve is {0}: it must be a positive, finite number")]
    Tolerance(f64),
}

/// A branch of the curve in which two surfaces meet. It runs along the cross product of the normals `a_u × a_v` and `b_s × b_t`.
#[derive(Clone, Debug)]
pub struct SurfaceCurve {
    parts: Vec<Part4>,
    surfaces: [SurfaceRef; 2],
    /// Where it ends: its start and its end; `None` for a closed curve. Numbers are those in [`SurfaceSurface::undecided`].
    pub ends: Option<[BranchEnd; 2]>,
    /// [`Certainty::Bounded`]: every point of this curve, on either surface, is within this distance of a common point of both,
    /// and every common point of this branch is within it of the curve.
    pub certainty: Certainty,
}

impl SurfaceCurve {
    /// True if it ends where it begins.
    pub fn is_closed(&self) -> bool {
        self.ends.is_none()
    }

    /// The curve in the parameters of one surface, 0 or 1, as `(u, v, 0)`: it jumps where the branch goes on across a seam.
    /// Panics if the number is another one.
    pub fn in_parameters(&self, surface: usize) -> Path {
        Path::plane(&self.halves(surface), self.surfaces[surface].domain())
    }

    /// The curve on one surface, 0 or 1; with the same parameter t as that on the other one and those in the parameters. Panics
    /// if the number is another one.
    pub fn on(&self, surface: usize) -> Path {
        Path::on(&self.halves(surface), self.surfaces[surface].clone())
    }

    /// The curve in space: that on the first surface.
    pub fn curve(&self) -> CurveRef {
        Arc::new(self.on(0))
    }

    /// A box around its parameters on one surface, 0 or 1. Panics if the number is another one.
    pub fn bounds(&self, surface: usize) -> [Interval; 2] {
        super::seams::bounds(&self.halves(surface))
    }

    fn halves(&self, surface: usize) -> Vec<super::path::Part> {
        self.parts.iter().map(|p| p.half(surface)).collect()
    }
}

/// A place where it is not decided how two surfaces meet: boxes of parameters near each other. One on a seam is told on both
/// sides of it.
///
/// There the surfaces may touch, or branches cross; or come nearer to that than can be told; or they may have no common point.
/// Outside of these boxes everything is proven.
#[derive(Clone, Debug, PartialEq)]
pub struct Contact {
    /// The boxes of u, v, s and t.
    pub boxes: Vec<[Interval; 4]>,
    /// A box around them.
    pub hull: [Interval; 4],
    /// The middle of it, on the first surface.
    pub point: DVec3,
    /// The size of it in space: the longest diagonal of the boxes around the parts of the surfaces.
    pub size: f64,
    /// True if the surfaces coincide in a region there: within rounding, at all of nine places of each of some boxes.
    pub overlaps: bool,
    /// How many ends of branches lie there: four at an ordinary crossing.
    pub ends: usize,
}

impl fmt::Display for Contact {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = |x: f64| crate::significant(x, 4);
        let p = self.point;
        write!(
            f,
            "near ({}, {}, {}), within {}: ",
            number(p.x),
            number(p.y),
            number(p.z),
            number(self.size)
        )?;
        match (self.overlaps, self.ends) {
            (true, _) => f.write_str("the surfaces coincide in a region, within rounding"),
            (_, 0) => f.write_str("the surfaces may touch, or come very near"),
            (_, 1) => f.write_str("a branch could not be followed farther"),
            (_, 2) => f.write_str("2 branches end: the surfaces may touch there"),
            (_, n) => write!(f, "{n} branches end: they may cross"),
        }
    }
}

/// All that two surfaces have in common.
#[derive(Clone, Debug, Default)]
pub struct SurfaceSurface {
    /// The curves, by the least u of each; where these agree within a millionth, by the least v.
    pub branches: Vec<SurfaceCurve>,
    /// What is not decided.
    pub undecided: Vec<Contact>,
    /// Parameters of points in which a curve reaches the sides of the surfaces without entering.
    pub touches: Vec<[f64; 4]>,
    /// The tolerance that was meant: that of the options, or the default.
    pub tol: f64,
    /// How many boxes were looked at.
    pub boxes: usize,
}

/// All curves in which two surfaces meet: every common point lies on a branch, at a place not decided, or is a touch.
///
/// No branch is lost, however small, and none is joined to another. Curves that run along a side of a surface, or beyond it by
/// less than a quarter of the tolerance, count as on it. Across a seam, where two sides of a closed surface are one curve, and across
/// creases branches go on where their ends agree within rounding. Where surfaces touch, coincide or cross at a vanishing
/// angle the place is given with its size. Poles, where a side is one point, are such places.
///
/// Errors: the tolerance is not positive. Cost: the boxes of the parts between creases are sorted along an axis; then one or
/// two enclosures for each part of a surface that is looked at, and some for each step; two bicubic surfaces with a few branches take some ten thousand boxes.
///
/// ```
/// use nappe::query::{IntersectOptions, intersect_surfaces};
/// use nappe::surface::{Quadric, QuadricOptions, QuadricShape, Transformed};
/// use nappe::{DAffine3, DVec3, SurfaceRef};
/// use std::sync::Arc;
///
/// let ball = Quadric::new(QuadricShape::Sphere, &[1.0], QuadricOptions::default()).unwrap();
/// let ball: SurfaceRef = Arc::new(ball);
/// let by = DAffine3::from_translation(DVec3::new(1.1, 0.2, 0.3));
/// let moved: SurfaceRef = Arc::new(Transformed::new(ball.clone(), by).unwrap());
/// let found = intersect_surfaces(&ball, &moved, &IntersectOptions::default()).unwrap();
/// assert_eq!((found.branches.len(), found.undecided.len()), (1, 0));
/// assert!(found.branches[0].is_closed());
/// ```
pub fn intersect_surfaces(
    a: &SurfaceRef,
    b: &SurfaceRef,
    options: &IntersectOptions,
) -> Result<SurfaceSurface, SurfacesError> {
    if let Some(tol) = options.tol
        && !(tol > 0.0 && tol.is_finite())
    {
        return Err(SurfacesError::Tolerance(tol));
    }
    let smaller = size(a.as_ref()).min(size(b.as_ref()));
    let tol = options.tol.unwrap_or(DEFAULT_TOL * smaller);
    let Pairs { pairs, rest } = pairs([a, b], tol, smaller, options.budget);
    let mut out = SurfaceSurface {
        tol,
        ..SurfaceSurface::default()
    };
    let [p, q] = [a, b].map(|s| s.domain());
    let domain = [p[0], p[1], q[0], q[1]];
    let mut left = options.budget;
    let mut all = options.budget.saturating_mul(ALL);
    let mut strands = Vec::new();
    let around_rest = rest.map(|x| Open {
        x,
        coincides: false,
    });
    let mut open: Vec<Open> = around_rest.into_iter().collect();
    for (number, pair) in pairs.iter().enumerate() {
        let stepper = Stepper {
            pair,
            tol,
            widths: domain.map(Interval::width),
        };
        // None takes all that the others need.
        let own = (left / SHARE).max(LEAST.min(options.budget)).min(all);
        let found = search(&stepper, own);
        left = left.saturating_sub(found.looked);
        all = all.saturating_sub(found.looked + STEP * found.steps);
        out.boxes += found.looked;
        out.touches.extend(found.touches);
        open.extend(found.open.into_iter().map(|o| Open {
            x: pair.inside(&o.x),
            ..o
        }));
        // Beside a singular point there are scraps of curves: they are parts of that place.
        let size = pair.size;
        let (scraps, kept): (Vec<_>, Vec<_>) = found
            .strands
            .into_iter()
            .partition(|s| s.is_stuck() && s.length(&stepper) <= SCRAP * size);
        open.extend(scraps.iter().flat_map(|s| &s.covers).map(|x| Open {
            x: pair.inside(x),
            coincides: false,
        }));
        strands.extend(kept.into_iter().map(|s| (number, s)));
    }
    let widths = domain.map(Interval::width);
    out.undecided = contacts([a, b], &open, widths);
    let mut pieces = Vec::with_capacity(strands.len());
    for (number, strand) in strands {
        let ends = strand.ends.map(|ends| {
            ends.map(|end| match end {
                End::Side(_) => BranchEnd::Border,
                End::Stuck(knot) => {
                    let near = |c: &Contact| c.boxes.iter().any(|b| is_near(b, &knot.zero, widths));
                    let k = out.undecided.iter().position(near).unwrap_or_else(|| {
                        let x = pairs[number].inside(&knot.zero);
                        out.undecided.push(contact([a, b], vec![x], false));
                        out.undecided.len() - 1
                    });
                    BranchEnd::Undecided(k)
                }
            })
        });
        pieces.push(Piece {
            strand,
            pair: number,
            ends,
        });
    }
    let largest = size(a.as_ref()).max(size(b.as_ref()));
    let surfaces = [a.clone(), b.clone()];
    let make = |joined: Joined| SurfaceCurve {
        parts: joined.parts,
        surfaces: surfaces.clone(),
        ends: joined.ends,
        certainty: Certainty::Bounded(joined.error),
    };
    let branches = joined(&pieces, &pairs, domain, largest, tol)
        .into_iter()
        .map(make);
    out.branches = in_order(branches.collect(), domain[0].width());
    for end in out.branches.iter().filter_map(|b| b.ends).flatten() {
        if let BranchEnd::Undecided(k) = end {
            out.undecided[k].ends += 1;
        }
    }
    out.touches = distinct(&out, [a, b]);
    Ok(out)
}

/// True if a box comes near to another one.
fn is_near(b: &Box4, x: &Box4, widths: Place) -> bool {
    (0..4).all(|j| {
        let room = ONE_PLACE * widths[j];
        b[j].inflate(room).intersection(x[j]).is_some()
    })
}

/// Open boxes that are near each other, together.
fn contacts(surfaces: [&SurfaceRef; 2], open: &[Open], widths: Place) -> Vec<Contact> {
    let boxes: Vec<Box4> = open.iter().map(|o| o.x).collect();
    let scaled: Vec<Box4> = boxes
        .iter()
        .map(|x| {
            from_fn(|j| Interval {
                lo: x[j].lo / widths[j],
                hi: x[j].hi / widths[j],
            })
        })
        .collect();
    let group = |group: Vec<usize>| {
        let overlaps = group.iter().any(|&k| open[k].coincides);
        let boxes = group.iter().map(|&k| boxes[k]).collect();
        contact(surfaces, boxes, overlaps)
    };
    clusters(&scaled, ONE_PLACE)
        .into_iter()
        .map(group)
        .collect()
}

/// A contact of at least one box.
fn contact(surfaces: [&SurfaceRef; 2], boxes: Vec<Box4>, overlaps: bool) -> Contact {
    let hull = boxes[1..]
        .iter()
        .fold(boxes[0], |a, b| from_fn(|j| a[j].hull(b[j])));
    let [p, q] = [0, 1].map(|n| surfaces[n].bounds([hull[2 * n], hull[2 * n + 1]]));
    Contact {
        point: surfaces[0].point([hull[0].mid(), hull[1].mid()]),
        size: p.diagonal().max(q.diagonal()),
        boxes,
        hull,
        overlaps,
        ends: 0,
    }
}

/// Branches by the least u of each; where these are nearly the same, by the least v.
fn in_order(branches: Vec<SurfaceCurve>, width: f64) -> Vec<SurfaceCurve> {
    let mut all: Vec<([f64; 2], SurfaceCurve)> = branches
        .into_iter()
        .map(|b| (b.bounds(0).map(|t| t.lo), b))
        .collect();
    all.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let near = 4.0 * DEFAULT_TOL * width;
    for same in all.chunk_by_mut(|a, b| b.0[0] - a.0[0] <= near) {
        same.sort_by(|a, b| a.0[1].total_cmp(&b.0[1]));
    }
    all.into_iter().map(|b| b.1).collect()
}

/// Touches that are different points and no ends of branches.
fn distinct(found: &SurfaceSurface, surfaces: [&SurfaceRef; 2]) -> Vec<Place> {
    let point = |x: &Place| surfaces[0].point([x[0], x[1]]);
    let ends = found
        .branches
        .iter()
        .flat_map(|b| [b.parts[0].points[0], b.parts[b.parts.len() - 1].points[3]]);
    let near = found.tol;
    let mut kept: Vec<DVec3> = ends.map(|x| point(&x)).collect();
    let mut out = Vec::new();
    for x in &found.touches {
        let p = point(x);
        if kept.iter().all(|k| k.distance(p) > near) {
            kept.push(p);
            out.push(*x);
        }
    }
    out
}
