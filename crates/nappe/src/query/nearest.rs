//! The nearest point of some surfaces.

use super::part::{Part, Place};
use super::tree::Tree;
use crate::mesh::Certainty;
use crate::parallel;
use crate::surface::{SurfaceRef, in_parallel};
use glam::DVec3;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The rounding errors of points, as a share of the largest coordinate.
const ROUNDING: f64 = 1e-13;

/// How well to answer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FinderOptions {
    /// The greatest error of distances, in the surfaces' unit of length. `None`: a billionth of the diagonal of the box
    /// around them, or what rounding leaves, if that is more.
    pub tol: Option<f64>,
    /// The parts that are looked at for one point beyond those prepared. Where many points are about equally near (the
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
    /// The index of its surface.
    pub surface: usize,
    /// Its parameters.
    pub uv: [f64; 2],
    /// The point itself.
    pub point: DVec3,
    /// How far away it is.
    pub distance: f64,
    /// [`Certainty::Bounded`]: no point of any surface is nearer than `distance` less this.
    pub certainty: Certainty,
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum QueryError {
    /// There is no surface.
    #[error("there is no surface to look for the nearest point on: give one or more")]
    NoSurface,
    /// A coordinate is no number or not finite.
    #[error("the point ({}, {}, {}) has a coordinate that is no finite number: leave it out or mend it", .point.x, .point.y, .point.z)]
    Point {
        /// What was asked for.
        point: DVec3,
    },
    /// No finite distance was found.
    #[error("the point ({}, {}, {}) has no finite distance from the surfaces: it is too far away to compute with, or they are not finite", .point.x, .point.y, .point.z)]
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
/// Prepared once: each analytic piece is cut until the distance from points about as near as the part is large has one
/// minimum there. The time for a point near the surfaces then hardly depends on their number.
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
    surfaces: Vec<SurfaceRef>,
    tree: Tree,
    tol: Option<f64>,
    diagonal: f64,
    /// The largest coordinate.
    far: f64,
    budget: usize,
}

impl Finder {
    /// Prepares some surfaces. Errors: there is none, or the tolerance is no positive length. Cost: some enclosures for each
    /// analytic piece, on all cores.
    pub fn new(surfaces: &[SurfaceRef], options: FinderOptions) -> Result<Self, QueryError> {
        if surfaces.is_empty() {
            return Err(QueryError::NoSurface);
        }
        if let Some(tol) = options.tol
            && !(tol > 0.0 && tol.is_finite())
        {
            return Err(QueryError::Tolerance { tol });
        }
        let threads = options.threads.unwrap_or_else(parallel::all_threads);
        let tree = Tree::new(surfaces, threads);
        let hull = tree.nodes.first().map(|n| n.hull);
        let (diagonal, far) = hull.map_or((0.0, 0.0), |h| {
            let far = h.lo.abs().max(h.hi.abs()).max_element();
            ((h.hi - h.lo).length(), far)
        });
        Ok(Self {
            surfaces: surfaces.to_vec(),
            tree,
            tol: options.tol,
            diagonal,
            far,
            budget: options.budget,
        })
    }

    /// The nearest point of all surfaces to a point; of several that are equally near one. Errors: a coordinate is not finite,
    /// or no distance is. Cost: some tens of boxes and a few evaluations for points much nearer to the surface than it is
    /// curved, more where the distance has several minima, most where many points are about equally near.
    pub fn nearest(&self, p: DVec3) -> Result<Nearest, QueryError> {
        if !p.is_finite() {
            return Err(QueryError::Point { point: p });
        }
        let rounding = ROUNDING * self.far.max(p.abs().max_element());
        let tol = self.tol.unwrap_or(1e-9 * self.diagonal);
        let mut search = Search {
            finder: self,
            p,
            // Half of it is for what is left undecided.
            tol: 0.5 * (tol - rounding).max(rounding),
            best: None,
            limit: f64::INFINITY,
            lower: f64::INFINITY,
            heap: BinaryHeap::new(),
            own: Vec::new(),
            budget: self.budget,
        };
        search.run();
        let Some(best) = search.best else {
            return Err(QueryError::NoDistance { point: p });
        };
        let distance = (2.0 * best.half_square).sqrt();
        let gap = (distance - search.lower.min(distance)).max(0.0) + rounding;
        Ok(Nearest {
            surface: best.surface as usize,
            uv: best.uv,
            point: best.point,
            distance,
            certainty: Certainty::Bounded(gap),
        })
    }

    /// [`Self::nearest`] for many points, on some threads, in their order and with the same bits on any number of threads. A
    /// point without an answer keeps its place, with its error.
    pub fn nearest_many(
        &self,
        points: &[DVec3],
        threads: usize,
    ) -> Vec<Result<Nearest, QueryError>> {
        let mut out = vec![Err(QueryError::NoSurface); points.len()];
        in_parallel(threads, points, 1, &mut out, |points, out| {
            for (&p, out) in points.iter().zip(out) {
                *out = self.nearest(p);
            }
        });
        out
    }
}

/// What is still to be looked at, the least lower bound first.
struct Open {
    lower: f64,
    below: Item,
}

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Item {
    Node(u32),
    /// A part made for this point.
    Own(u32),
}

impl PartialEq for Open {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}
impl Eq for Open {}
impl PartialOrd for Open {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}
impl Ord for Open {
    /// The heap hands out the greatest.
    fn cmp(&self, o: &Self) -> Ordering {
        let nearest = o.lower.total_cmp(&self.lower);
        nearest.then(o.below.cmp(&self.below))
    }
}

/// The search for one point.
struct Search<'a> {
    finder: &'a Finder,
    p: DVec3,
    tol: f64,
    best: Option<Place>,
    /// Distances from here on need no look.
    limit: f64,
    /// No point of what has been settled is nearer.
    lower: f64,
    heap: BinaryHeap<Open>,
    own: Vec<Part>,
    budget: usize,
}

impl Search<'_> {
    fn push(&mut self, lower: f64, below: Item) {
        if lower >= self.limit {
            self.lower = self.lower.min(lower);
        } else {
            self.heap.push(Open { lower, below });
        }
    }

    fn run(&mut self) {
        let finder = self.finder;
        self.node(0);
        while let Some(Open { lower, below }) = self.heap.pop() {
            if lower >= self.limit {
                // All others are no nearer.
                self.lower = self.lower.min(lower);
                return;
            }
            match below {
                Item::Node(k) => {
                    let node = &finder.tree.nodes[k as usize];
                    match (node.below, node.part) {
                        (Some(first), part) => {
                            let settled = part.is_some_and(|part| {
                                self.convex(&finder.tree.parts[part as usize], lower)
                            });
                            if !settled {
                                self.node(first);
                                self.node(first + 1);
                            }
                        }
                        (None, Some(part)) => self.part(&finder.tree.parts[part as usize], lower),
                        (None, None) => {}
                    }
                }
                Item::Own(k) => {
                    let part = self.own[k as usize].clone();
                    self.part(&part, lower);
                }
            }
        }
    }

    /// Puts a node into the heap, with the bound of its part if it has one.
    fn node(&mut self, k: u32) {
        let tree = &self.finder.tree;
        let node = &tree.nodes[k as usize];
        let mut lower = node.hull.distance2(self.p).sqrt();
        if let Some(part) = node.part
            && lower < self.limit
        {
            let (half_square, _) = tree.parts[part as usize].lower(self.p);
            lower = length(half_square);
        }
        self.push(lower, Item::Node(k));
    }

    fn improve(&mut self, place: Place) {
        let nearer = |b: Place| place.half_square < b.half_square;
        if place.half_square.is_finite() && self.best.is_none_or(nearer) {
            self.best = Some(place);
            self.limit = length(place.half_square) - self.tol;
        }
    }

    /// Looks for the nearest point of a part over which the distance is convex; true if that settles it.
    fn convex(&mut self, part: &Part, lower: f64) -> bool {
        let (p, tol) = (self.p, self.tol);
        if !part.lower(p).1 {
            self.improve(part.middle(p));
            return false;
        }
        let surface = self.finder.surfaces[part.surface as usize].as_ref();
        let best = self.best.map_or(f64::INFINITY, |b| b.half_square);
        let (place, half_square) = part.nearest(surface, p, |found, lower| {
            length(lower) >= length(best.min(found)) - tol
        });
        self.improve(place);
        let least = length(half_square).max(lower);
        let settled = least >= self.limit;
        if settled {
            self.lower = self.lower.min(least);
        }
        settled
    }

    fn part(&mut self, part: &Part, lower: f64) {
        if self.convex(part, lower) {
            return;
        }
        let halves = if self.budget > 0 {
            part.halves(&self.finder.surfaces)
        } else {
            None
        };
        let Some(halves) = halves else {
            self.lower = self.lower.min(lower);
            return;
        };
        self.budget -= 1;
        for half in halves {
            let (half_square, _) = half.lower(self.p);
            let lower = length(half_square).max(lower);
            self.own.push(half);
            let number = self.own.len() as u32 - 1;
            self.push(lower, Item::Own(number));
        }
    }
}

/// The length whose half square that is; 0 for less.
fn length(half_square: f64) -> f64 {
    (2.0 * half_square.max(0.0)).sqrt()
}
