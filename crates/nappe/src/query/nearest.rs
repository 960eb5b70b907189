//! The nearest point of some surfaces.

use super::part::{Part, Place, length};
use super::shape::Shape;
use super::tree::Tree;
use crate::curve::CurveRef;
use crate::mesh::Certainty;
use crate::parallel;
use crate::ranked::Ranked;
use crate::surface::{SurfaceRef, in_parallel};
use glam::DVec3;
use std::collections::BinaryHeap;

/// The default tolerance as a share of the diagonal.
const DEFAULT_TOL: f64 = 1e-9;
/// How many times the rounding errors of points are asked for at least.
const ABOVE_ROUNDING: f64 = 4.0;

/// How well to answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinderOptions {
    /// The error of distances to search for, in the surfaces' unit of length. `None`: a billionth of the diagonal of the box
    /// around them, or around the parts of them that have one. What rounding leaves is not asked for.
    pub tol: Option<f64>,
    /// How many parts are halved for one point beyond what is prepared. Where many points are about equally near (the
    /// middle of a sphere), they may not suffice: then the certainty says what was reached.
    pub budget: usize,
    /// The threads that prepare; the answers do not depend on their number. `None`: as many as the machine runs at once.
    pub threads: Option<usize>,
}

impl Default for FinderOptions {
    fn default() -> Self {
        Self {
            tol: None,
            budget: 20_000,
            threads: None,
        }
    }
}

/// The nearest point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nearest {
    /// The index of its surface, or curve.
    pub surface: usize,
    /// Its parameters; on a curve t and 0.
    pub uv: [f64; 2],
    /// The point itself.
    pub point: DVec3,
    /// How far away it is.
    pub distance: f64,
    /// [`Certainty::Bounded`]: no point of any surface is nearer than `distance` less this. Points are evaluated in floating
    /// point; 10⁻¹³ of the largest coordinate is included for that, the accuracy to which every surface is held.
    pub certainty: Certainty,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum QueryError {
    /// There is no surface.
    #[error("there is no surface to look for the nearest point on: give one or more")]
    NoSurface,
    /// There is no curve.
    #[error("there is no curve to look for the nearest point on: give one or more")]
    NoCurve,
    /// A coordinate is no number or not finite.
    #[error("the point ({}, {}, {}) has a coordinate that is no finite number: leave it out or mend it", .point.x, .point.y, .point.z)]
    Point {
        /// What was asked for.
        point: DVec3,
    },
    /// No finite distance was found.
    #[error("the point ({:e}, {:e}, {:e}) has no finite distance from the surfaces or curves: it is too far away to compute with, or they are not finite", .point.x, .point.y, .point.z)]
    NoDistance {
        /// What was asked for.
        point: DVec3,
    },
    /// The tolerance is no positive length.
    #[error("the tolerance of distances is {tol}: it must be a positive, finite length")]
    Tolerance {
        /// What was asked for.
        tol: f64,
    },
}

/// Finds nearest points on some surfaces.
///
/// Prepared once: each analytic piece is cut until the curvature of the distance is known well over its parts. The time
/// for a point near the surfaces then hardly depends on their number.
///
/// ```
/// use nappe::query::{Finder, FinderOptions};
/// use nappe::surface::{Torus, TorusOptions};
/// use nappe::DVec3;
/// use std::sync::Arc;
///
/// let torus = Torus::new(3.0, 1.0, TorusOptions::default()).unwrap();
/// let finder = Finder::new(&[Arc::new(torus)], FinderOptions::default()).unwrap();
/// let found = finder.nearest(DVec3::new(5.0, 0.0, 0.0)).unwrap();
/// assert!((found.distance - 1.0).abs() <= found.certainty.error());
/// ```
pub struct Finder {
    pub(super) shapes: Vec<Shape>,
    pub(super) tree: Tree,
    pub(super) tol: f64,
    pub(super) budget: usize,
}

impl Finder {
    /// Prepares some surfaces. Errors: there is none, or the tolerance is no positive length. Cost: some enclosures for each
    /// analytic piece, on all cores.
    pub fn new(surfaces: &[SurfaceRef], options: FinderOptions) -> Result<Self, QueryError> {
        let shapes = surfaces.iter().cloned().map(Shape::Surface).collect();
        Self::prepare(shapes, options, QueryError::NoSurface)
    }

    /// The same for curves: `surface` is then the number of the curve in all answers, and `uv` are t and 0.
    pub fn on_curves(curves: &[CurveRef], options: FinderOptions) -> Result<Self, QueryError> {
        let shapes = curves.iter().cloned().map(Shape::Curve).collect();
        Self::prepare(shapes, options, QueryError::NoCurve)
    }

    fn prepare(
        shapes: Vec<Shape>,
        options: FinderOptions,
        none: QueryError,
    ) -> Result<Self, QueryError> {
        if shapes.is_empty() {
            return Err(none);
        }
        if let Some(tol) = options.tol {
            check_tolerance(tol)?;
        }
        let threads = options.threads.unwrap_or_else(parallel::all_threads);
        let tree = Tree::new(&shapes, threads);
        Ok(Self {
            // What is one point has no diagonal.
            tol: options
                .tol
                .unwrap_or((DEFAULT_TOL * tree.diagonal).max(f64::MIN_POSITIVE)),
            shapes,
            tree,
            budget: options.budget,
        })
    }

    /// The error of distances that is searched for.
    pub fn tol(&self) -> f64 {
        self.tol
    }

    /// The nearest point of all surfaces, or curves, to a point; of several that are equally near one. Errors: a coordinate is not finite,
    /// or no distance is. Cost: some tens of boxes and a few evaluations for points much nearer to the surface than it is
    /// curved, more where the distance has several minima, most where many points are about equally near. The first points
    /// on a surface prepare it for lists (see [`Surface::jets`](crate::surface::Surface::jets)).
    pub fn nearest(&self, p: DVec3) -> Result<Nearest, QueryError> {
        if !p.is_finite() {
            return Err(QueryError::Point { point: p });
        }
        let mut search = Search {
            finder: self,
            p,
            best: None,
            rounding: 0.0,
            limit: f64::INFINITY,
            lower: f64::INFINITY,
            heap: BinaryHeap::new(),
            pushed: 0,
            budget: self.budget,
        };
        search.run();
        let Some(best) = search.best else {
            return Err(QueryError::NoDistance { point: p });
        };
        let distance = length(best.half_square);
        let gap = (distance - search.lower).max(0.0) + search.rounding;
        Ok(Nearest {
            surface: best.surface as usize,
            uv: best.uv,
            point: best.point,
            distance,
            certainty: Certainty::Bounded(gap),
        })
    }

    /// The true distance of the nearest point that was found is no longer.
    pub(super) fn reach(&self, p: DVec3, found: &Nearest) -> f64 {
        found.distance + found.certainty.error().min(self.tree.rounding(p))
    }

    /// What may be left between the distance found and the least that is not excluded, for some rounding errors of points.
    pub(super) fn gap(&self, rounding: f64) -> f64 {
        (self.tol - rounding).max(ABOVE_ROUNDING * rounding)
    }

    /// [`Self::nearest`] for many points, on some threads, in their order and with the same bits on any number of threads. A
    /// point without an answer keeps its place, with its error.
    pub fn nearest_many(
        &self,
        points: &[DVec3],
        threads: usize,
    ) -> Vec<Result<Nearest, QueryError>> {
        answers(points, threads, |p| self.nearest(p))
    }
}

/// The answers for many points, on some threads, in their order.
pub(super) fn answers<T: Clone + Send>(
    points: &[DVec3],
    threads: usize,
    answer: impl Fn(DVec3) -> Result<T, QueryError> + Sync,
) -> Vec<Result<T, QueryError>> {
    let mut out = vec![Err(QueryError::NoSurface); points.len()];
    in_parallel(threads, points, 1, &mut out, |points, out| {
        for (&p, out) in points.iter().zip(out) {
            *out = answer(p);
        }
    });
    out
}

/// That a tolerance is a positive, finite length.
pub(super) fn check_tolerance(tol: f64) -> Result<(), QueryError> {
    if tol > 0.0 && tol.is_finite() {
        Ok(())
    } else {
        Err(QueryError::Tolerance { tol })
    }
}

/// What is still to be looked at.
pub(super) enum Item {
    Node(u32),
    /// Made for this point.
    Part(Box<Part>),
}

/// The search for one point.
pub(super) struct Search<'a> {
    pub(super) finder: &'a Finder,
    pub(super) p: DVec3,
    pub(super) best: Option<Place>,
    /// The rounding errors of its distance.
    rounding: f64,
    /// Distances from here on need no look.
    pub(super) limit: f64,
    /// No point of what has been settled is nearer.
    pub(super) lower: f64,
    /// The least lower bound first.
    heap: BinaryHeap<Ranked<Item>>,
    pushed: usize,
    budget: usize,
}

impl Search<'_> {
    pub(super) fn push(&mut self, lower: f64, item: Item) {
        if lower >= self.limit {
            self.lower = self.lower.min(lower);
        } else {
            self.pushed += 1;
            self.heap.push(Ranked {
                rank: -lower,
                number: self.pushed,
                item,
            });
        }
    }

    fn run(&mut self) {
        let tree = &self.finder.tree;
        // What comes before all in the heap, if that is known.
        let mut next = (!tree.nodes.is_empty()).then(|| (self.bound(0, 0.0), Item::Node(0)));
        loop {
            let (lower, item) = match next.take() {
                Some(next) => next,
                None => match self.heap.pop() {
                    Some(Ranked { rank, item, .. }) => (-rank, item),
                    None => return,
                },
            };
            if lower >= self.limit {
                // All others are no nearer.
                self.lower = self.lower.min(lower);
                return;
            }
            match item {
                Item::Node(k) if tree.nodes[k as usize].patched => self.patches(k, lower),
                Item::Node(k) => {
                    let node = &tree.nodes[k as usize];
                    let part = node.part.map(|part| &tree.parts[part as usize]);
                    match (node.below, part) {
                        (Some(first), part) => {
                            let open = match part {
                                Some(part) => self.convex(part, lower),
                                None => Some(lower),
                            };
                            if let Some(lower) = open {
                                next = self.below(first, lower);
                            }
                        }
                        (None, Some(part)) => self.part(part, lower),
                        (None, None) => {}
                    }
                }
                Item::Part(part) => self.part(&part, lower),
            }
        }
    }

    /// Puts two nodes into the heap, but for the nearer one if that comes before all.
    fn below(&mut self, first: u32, above: f64) -> Option<(f64, Item)> {
        let [a, b] = [first, first + 1].map(|k| (self.bound(k, above), k));
        let (near, far) = if b.0 < a.0 { (b, a) } else { (a, b) };
        self.push(far.0, Item::Node(far.1));
        if self.heap.peek().is_none_or(|top| near.0 <= -top.rank) {
            return Some((near.0, Item::Node(near.1)));
        }
        self.push(near.0, Item::Node(near.1));
        None
    }

    /// The bound of a node: that of its part if it has one, or that of what it is part of.
    pub(super) fn bound(&self, k: u32, above: f64) -> f64 {
        let tree = &self.finder.tree;
        let node = &tree.nodes[k as usize];
        let lower = node.hull.distance2(self.p).sqrt().max(above);
        match node.part {
            Some(part) if lower < self.limit => lower.max(tree.parts[part as usize].lower(self.p)),
            _ => lower,
        }
    }

    pub(super) fn improve(&mut self, part: &Part, place: Place) {
        let nearer = |b: Place| place.half_square < b.half_square;
        if place.half_square.is_finite() && self.best.is_none_or(nearer) {
            self.best = Some(place);
            self.rounding = part.rounding(self.p);
            self.limit = length(place.half_square) - self.finder.gap(self.rounding);
        }
    }

    /// Looks for the nearest point of a part over which the distance is convex. `None` if that settles it, or else a lower
    /// bound.
    fn convex(&mut self, part: &Part, lower: f64) -> Option<f64> {
        let p = self.p;
        if !part.is_convex(p) {
            self.improve(part, part.middle(p));
            return Some(lower);
        }
        let shape = &self.finder.shapes[part.surface as usize];
        let best = self.best.map_or(f64::INFINITY, |b| b.half_square);
        let tol = self.finder.gap(part.rounding(p));
        let (place, least) = part.nearest(shape, p, |found, lower| {
            lower >= length(best.min(found)) - tol
        });
        self.improve(part, place);
        let least = least.max(lower);
        if least >= self.limit {
            self.lower = self.lower.min(least);
            return None;
        }
        Some(least)
    }

    pub(super) fn part(&mut self, part: &Part, lower: f64) {
        let Some(lower) = self.convex(part, lower) else {
            return;
        };
        let halves = if self.budget > 0 {
            part.halves(&self.finder.shapes)
        } else {
            None
        };
        let Some(halves) = halves else {
            self.lower = self.lower.min(lower);
            return;
        };
        self.budget -= 1;
        for half in halves {
            let lower = half.lower(self.p).max(lower);
            self.push(lower, Item::Part(Box::new(half)));
        }
    }
}
