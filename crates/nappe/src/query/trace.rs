//! All curves on which a function of two parameters is zero.

use super::cells::{Cells, CellsError, divide, rectangles};
use super::chains::{Chain, chains, touch};
use super::extended::{Extended, MARGIN};
use super::field::Field;
use super::path::{Part, Path, least};
use super::seams::{Strand, bounds, joined};
use super::tube::{Tube, displacement};
use crate::box3::Box3;
use crate::clusters::clusters;
use crate::curve::CurveRef;
use crate::interval::Interval;
use crate::measure::size;
use crate::mesh::Certainty;
use crate::surface::{Dir, Surface, SurfaceRef};
use std::fmt;
use std::sync::Arc;

/// The default tolerance as a share of the size of the surface, or of the diagonal of the rectangle.
const DEFAULT_TOL: f64 = 1e-6;

/// How to trace.
#[derive(Clone, Debug)]
pub struct TraceOptions {
    /// The rectangle to look in; `None`: the domain of the function.
    pub within: Option<[Interval; 2]>,
    /// The surface whose parameters u and v are. Then `tol` is a length on it, and branches are curves in space too.
    pub surface: Option<SurfaceRef>,
    /// The greatest distance of a branch from the exact curve, and of that from the branch: in space if there is a surface,
    /// else in the plane of the parameters. `None`: a millionth of the size. Where more is left the certainty of the branch
    /// says so: where rounding hides the sign, where the budget ends, and where the tolerance is less than the margin of
    /// 10⁻¹⁰ of the rectangle.
    pub tol: Option<f64>,
    /// The most cells that are looked at, and the most pieces that are tried for all branches. Between jumps of the function
    /// at least 1000 cells are looked at.
    pub budget: usize,
}

impl Default for TraceOptions {
    fn default() -> Self {
        Self {
            within: None,
            surface: None,
            tol: None,
            budget: 100_000,
        }
    }
}

/// Why there is no trace.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum TraceError {
    /// The function is zero on a whole region.
    #[error("the function is zero, within rounding, all over u in [{}, {}], v in [{}, {}]: its zeros are a region and no curve; \
             look elsewhere, or change the function", .0[0].lo, .0[0].hi, .0[1].lo, .0[1].hi)]
    Zero([Interval; 2]),
    /// The function has no value anywhere.
    #[error("the function has no value anywhere in u in [{}, {}], v in [{}, {}]: see where its roots, logarithms and quotients \
             are defined", .0[0].lo, .0[0].hi, .0[1].lo, .0[1].hi)]
    NoValue([Interval; 2]),
    /// The tolerance is no positive length.
    #[error("the tolerance of the curve is {0}: it must be a positive, finite number")]
    Tolerance(f64),
    /// The rectangle is empty, infinite or not in the domain of the function or of the surface.
    #[error("the rectangle u in [{}, {}], v in [{}, {}] is not a part of the domain u in [{}, {}], v in [{}, {}] with an \
             interior", .within[0].lo, .within[0].hi, .within[1].lo, .within[1].hi,
             .domain[0].lo, .domain[0].hi, .domain[1].lo, .domain[1].hi)]
    Rectangle {
        /// What was asked for.
        within: [Interval; 2],
        /// Where the function is given.
        domain: [Interval; 2],
    },
}

/// Where a branch ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BranchEnd {
    /// On the border of the rectangle, or on a line where the function jumps and the curve does not go on.
    Border,
    /// At a place that is not decided: its number in [`Trace::undecided`].
    Undecided(usize),
}

/// A curve of zeros. The function is positive to its left: on the side of growing v if it runs towards growing u.
#[derive(Clone, Debug)]
pub struct Branch {
    parts: Vec<Part>,
    domain: [Interval; 2],
    surface: Option<SurfaceRef>,
    /// Where it ends: its start and its end; `None` for a closed curve.
    pub ends: Option<[BranchEnd; 2]>,
    /// [`Certainty::Bounded`]: every point of the curve given is within this distance of a zero, and every zero of this
    /// branch is within it of the curve; in space if there is a surface, else in the plane of the parameters.
    pub certainty: Certainty,
}

impl Branch {
    /// True if it ends where it begins.
    pub fn is_closed(&self) -> bool {
        self.ends.is_none()
    }

    /// The curve `(u, v, 0)`.
    pub fn in_parameters(&self) -> Path {
        Path::plane(&self.parts, self.domain)
    }

    /// The curve on a surface with the same parameters; [`Self::certainty`] is about the one that it was traced with.
    pub fn on(&self, surface: SurfaceRef) -> Path {
        Path::on(&self.parts, surface)
    }

    /// The curve in space, if it was traced on a surface; else that in the plane of the parameters.
    pub fn curve(&self) -> CurveRef {
        Arc::new(match &self.surface {
            Some(s) => self.on(s.clone()),
            None => self.in_parameters(),
        })
    }

    /// Its first and last place.
    fn end_places(&self) -> [[f64; 2]; 2] {
        [
            self.parts[0].points[0],
            self.parts[self.parts.len() - 1].points[3],
        ]
    }

    /// A box around it in the plane of the parameters.
    pub fn bounds(&self) -> [Interval; 2] {
        bounds(&self.parts)
    }
}

/// A place where it is not decided what the zeros are: cells that touch each other.
///
/// There the curve may cross itself, have a cusp, be double or a single point; or come nearer to that than can be told; or
/// there may be no zero at all. Outside these cells everything is proven.
#[derive(Clone, Debug, PartialEq)]
pub struct Undecided {
    /// The cells.
    pub cells: Vec<[Interval; 2]>,
    /// A box around them.
    pub hull: [Interval; 2],
    /// How many ends of branches lie there: four at an ordinary crossing, two at a cusp or where a bend could not be
    /// followed, one where the function has no value beyond, none at a point by itself.
    pub ends: usize,
}

impl fmt::Display for Undecided {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [u, v] = self.hull;
        write!(
            f,
            "u in [{}, {}], v in [{}, {}]: the zeros are not proven to be a regular curve ",
            u.lo, u.hi, v.lo, v.hi
        )?;
        match self.ends {
            0 => f.write_str("(a point by itself, a double curve, or none)"),
            1 => f.write_str("(1 branch ends here: the function may have no value beyond)"),
            2 => f.write_str("(2 branches end here: a cusp, or a bend too sharp)"),
            n => write!(f, "({n} branches end here: they may cross)"),
        }
    }
}

/// All zeros of a function in a rectangle.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// The curves, by the least u of each; where these are the same within some millionths of the width, by the least v.
    pub branches: Vec<Branch>,
    /// What is not decided.
    pub undecided: Vec<Undecided>,
    /// Points of the border where a curve reaches the rectangle without entering it, as at a corner; and, on a surface,
    /// sides that are one point.
    pub touches: Vec<[f64; 2]>,
    /// The tolerance that was meant: that of the options, or the default.
    pub tol: f64,
    /// How many cells were looked at, in all attempts.
    pub cells: usize,
}

/// All curves of zeros of a function in a rectangle: every zero lies on a branch, at a place not decided, or is a touch.
///
/// No branch is lost, however small, and none is joined to another: see the theorem in the source of `cells`. Zeros beyond
/// the border by less than 10⁻¹⁰ of the width count as on it.
///
/// Errors: see [`TraceError`]. Cost: some enclosures for each cell; the number of cells grows with the length of the curves
/// relative to their smallest radius and distance.
pub fn trace(f: &dyn Field, options: &TraceOptions) -> Result<Trace, TraceError> {
    let domain = f.domain();
    let within = options.within.unwrap_or(domain);
    let sound = |d: usize| {
        within[d].is_finite() && within[d].lo < within[d].hi && domain[d].encloses(within[d])
    };
    if !(sound(0) && sound(1)) {
        return Err(TraceError::Rectangle { within, domain });
    }
    if let Some(tol) = options.tol
        && !(tol > 0.0 && tol.is_finite())
    {
        return Err(TraceError::Tolerance(tol));
    }
    let surface = options.surface.as_deref();
    if let Some(surface) = surface {
        let domain = surface.domain();
        if !(0..2).all(|d| domain[d].encloses(within[d])) {
            return Err(TraceError::Rectangle { within, domain });
        }
    }
    let tol = options.tol.unwrap_or_else(|| {
        DEFAULT_TOL * surface.map_or_else(|| within[0].width().hypot(within[1].width()), size)
    });
    let pieces = rectangles(&[f], within);
    let mut trace = Trace {
        tol,
        ..Trace::default()
    };
    let mut strands = Vec::new();
    let mut budget = options.budget;
    let mut empty = 0;
    for (number, &rect) in pieces.iter().enumerate() {
        let piece = Extended::new(f, rect);
        let share = (options.budget / pieces.len()).max(1000);
        let cells = match divide(piece, share) {
            Ok(mut cells) => {
                absorb(&mut cells, piece);
                cells
            }
            Err(CellsError::Zero(uv)) => return Err(TraceError::Zero(uv)),
            Err(CellsError::NoValue) => {
                empty += 1;
                continue;
            }
        };
        let join = Join {
            piece,
            number,
            cells: &cells,
            surface: &options.surface,
            within,
            tol,
        };
        join.add(&mut trace, &mut strands, &mut budget);
        trace.cells += cells.looked;
    }
    if empty == pieces.len() {
        return Err(TraceError::NoValue(within));
    }
    let cuts = [Dir::U, Dir::V].map(|dir| f.jumps(dir));
    trace.branches = branches(strands, &cuts, within, &options.surface);
    if let Some(surface) = surface {
        points_in_space(&mut trace, surface, within, tol);
    }
    let ends: Vec<[f64; 2]> = trace.branches.iter().flat_map(Branch::end_places).collect();
    trace.touches = distinct(&trace.touches, &ends, within);
    for end in trace.branches.iter().filter_map(|b| b.ends).flatten() {
        if let BranchEnd::Undecided(k) = end {
            trace.undecided[k].ends += 1;
        }
    }
    trace.branches = in_order(trace.branches, within);
    Ok(trace)
}

/// Branches by the least u of each; where these differ by no more than the tolerance may do, by the least v.
fn in_order(branches: Vec<Branch>, within: [Interval; 2]) -> Vec<Branch> {
    let mut all: Vec<([f64; 2], Branch)> = branches
        .into_iter()
        .map(|b| {
            let lowest = |d: usize| {
                let each = b.parts.iter().map(|p| least(&p.points, d));
                each.fold(f64::INFINITY, f64::min)
            };
            ([lowest(0), lowest(1)], b)
        })
        .collect();
    all.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
    let near = 4.0 * DEFAULT_TOL * within[0].width();
    for same in all.chunk_by_mut(|a, b| b.0[0] - a.0[0] <= near) {
        same.sort_by(|a, b| a.0[1].total_cmp(&b.0[1]));
    }
    all.into_iter().map(|b| b.1).collect()
}

/// Cells below this width, relative to the rectangle, say nothing of their own between cells that are not decided.
const SMALL: f64 = 1.0 / (1u64 << 12) as f64;

/// And so many of them: longer branches are kept.
const FEW: usize = 4096;

/// Beside a cusp or an almost double curve cells are decided here and there. Branches of small cells that begin and end at
/// places that are not decided are made parts of these: then each such place is one.
fn absorb(cells: &mut Cells, piece: Extended) {
    let outer = piece.outer;
    let mut open = vec![false; cells.arcs.len()];
    for chain in chains(&cells.arcs) {
        let (first, last) = (chain.arcs[0], chain.arcs[chain.arcs.len() - 1]);
        let inner = |(k, c): (usize, usize)| {
            let crossing = cells.arcs[k].crossings[c];
            let border = outer[crossing.d];
            crossing.at != border.lo && crossing.at != border.hi
        };
        let small = |&(k, _): &(usize, usize)| {
            (0..2).all(|d| cells.arcs[k].uv[d].width() <= SMALL * outer[d].width())
        };
        let ends = inner(first) && inner((last.0, 1 - last.1));
        if !chain.closed && ends && chain.arcs.len() <= FEW && chain.arcs.iter().all(small) {
            chain.arcs.iter().for_each(|&(k, _)| open[k] = true);
        }
    }
    let (lost, kept) = cells
        .arcs
        .iter()
        .zip(&open)
        .partition::<Vec<_>, _>(|x| *x.1);
    let lost: Vec<_> = lost.into_iter().map(|x| x.0.uv).collect();
    let kept = kept.into_iter().map(|x| *x.0).collect();
    cells.open.extend(lost);
    cells.arcs = kept;
}

/// Places nearer than this, relative to the rectangle, are the same.
const SAME: f64 = 1e-9;
/// A branch this near to a side and this long along it, relative to the rectangle, that is a point in space within the
/// tolerance, lies on a side that is one point.
const BESIDE: f64 = 1e-4;
const ALONG: f64 = 1e-2;

/// Places that are neither among others nor repeated.
fn distinct(places: &[[f64; 2]], others: &[[f64; 2]], within: [Interval; 2]) -> Vec<[f64; 2]> {
    let same = |a: &[f64; 2], b: &[f64; 2]| {
        (0..2).all(|d| (a[d] - b[d]).abs() <= SAME * within[d].width())
    };
    let mut out: Vec<[f64; 2]> = Vec::new();
    for p in places {
        if !out.iter().chain(others).any(|q| same(p, q)) {
            out.push(*p);
        }
    }
    out
}

/// A pole on the curve is a whole side of the parameters: such branches become touches.
fn points_in_space(trace: &mut Trace, surface: &dyn Surface, within: [Interval; 2], tol: f64) {
    let is_point = |branch: &Branch| {
        let b = branch.bounds();
        let on_side = |d: usize| {
            let near = BESIDE * within[d].width();
            let beside = b[d].hi - within[d].lo <= near || within[d].hi - b[d].lo <= near;
            beside && b[1 - d].width() >= ALONG * within[1 - d].width()
        };
        let places = branch
            .parts
            .iter()
            .map(|p| p.points[0])
            .chain(branch.end_places());
        let space = Box3::around(places.map(|uv| surface.point(uv)));
        (on_side(0) || on_side(1)) && space.is_some_and(|b| b.diagonal() <= 4.0 * tol)
    };
    let (points, curves) = std::mem::take(&mut trace.branches)
        .into_iter()
        .partition(is_point);
    trace.branches = curves;
    let points: Vec<Branch> = points;
    trace
        .touches
        .extend(points.iter().map(|b| b.parts[0].points[0]));
}

/// A part of a branch within one piece.
struct Found {
    strand: Strand,
    ends: Option<[BranchEnd; 2]>,
    error: f64,
}

/// Branches from their parts in all pieces.
fn branches(
    found: Vec<Found>,
    cuts: &[Vec<f64>; 2],
    within: [Interval; 2],
    surface: &Option<SurfaceRef>,
) -> Vec<Branch> {
    let (strands, rest): (Vec<_>, Vec<_>) = found
        .into_iter()
        .map(|f| (f.strand, (f.ends, f.error)))
        .unzip();
    let lists = joined(&strands, cuts, within.map(Interval::width));
    let make = |(list, closed): (Vec<usize>, bool)| {
        let mut parts: Vec<Part> = Vec::new();
        let mut error = 0.0f64;
        for &k in &list {
            let begin = parts.len();
            parts.extend_from_slice(&strands[k].parts);
            let mut own = rest[k].1;
            if begin > 0 {
                let to = parts[begin - 1].points[3];
                let part = &mut parts[begin].points;
                own += displacement(surface.as_deref(), part, part[0], to);
                part[0] = to;
            }
            error = error.max(own);
        }
        let (first, last) = (rest[list[0]].0, rest[list[list.len() - 1]].0);
        let ends = match (first, last) {
            (Some(first), Some(last)) if !closed => Some([first[0], last[1]]),
            _ => None,
        };
        if closed && let Some(last) = parts.len().checked_sub(1) {
            let to = parts[0].points[0];
            let part = &mut parts[last].points;
            error += displacement(surface.as_deref(), part, part[3], to);
            part[3] = to;
        }
        Branch {
            parts,
            domain: within,
            surface: surface.clone(),
            ends,
            certainty: if error.is_finite() {
                Certainty::Bounded(error)
            } else {
                Certainty::Estimated(error)
            },
        }
    };
    lists.into_iter().map(make).collect()
}

/// Makes branches from the cells of one piece.
struct Join<'a> {
    piece: Extended<'a>,
    /// The number of the piece.
    number: usize,
    cells: &'a Cells,
    surface: &'a Option<SurfaceRef>,
    within: [Interval; 2],
    tol: f64,
}

impl Join<'_> {
    fn add(&self, trace: &mut Trace, out: &mut Vec<Found>, budget: &mut usize) {
        let first = trace.undecided.len();
        for group in clusters(&self.cells.open, 0.0) {
            let cells: Vec<_> = group
                .iter()
                .map(|&k| self.inside(self.cells.open[k]))
                .collect();
            let hull = cells
                .iter()
                .copied()
                .reduce(|a, b| [0, 1].map(|d| a[d].hull(b[d])));
            trace.undecided.push(Undecided {
                hull: hull.unwrap_or(self.piece.rect),
                cells,
                ends: 0,
            });
        }
        for chain in chains(&self.cells.arcs) {
            out.extend(self.strand(&chain, trace, first, budget));
        }
    }

    /// The part of a cell in the rectangle, or the side beside it.
    fn inside(&self, uv: [Interval; 2]) -> [Interval; 2] {
        let (lo, hi) = (
            self.piece.clamp(uv.map(|t| t.lo)),
            self.piece.clamp(uv.map(|t| t.hi)),
        );
        [0, 1].map(|d| Interval {
            lo: lo[d],
            hi: hi[d],
        })
    }

    fn strand(
        &self,
        chain: &Chain,
        trace: &mut Trace,
        first: usize,
        budget: &mut usize,
    ) -> Option<Found> {
        let arcs = &self.cells.arcs;
        let scale = [0, 1].map(|d| self.within[d].width());
        let surface = self.surface.as_deref();
        let tube = || Tube::new(self.piece, surface, self.tol, *budget, scale);
        let (arc, entry) = chain.arcs[0];
        let way: Vec<(usize, usize)> = if tube().enters(&arcs[arc], entry) {
            chain.arcs.clone()
        } else {
            chain.arcs.iter().rev().map(|&(k, c)| (k, 1 - c)).collect()
        };
        let walk = |absorbs: bool| {
            let mut tube = tube();
            tube.absorbs = absorbs;
            way.iter()
                .for_each(|&(k, entry)| tube.through(&arcs[k], entry));
            tube
        };
        let mut tube = walk(true);
        if tube.parts.is_empty() {
            // A branch that is as short as the parts that are left out.
            tube = walk(false);
        }
        *budget = tube.budget;
        let ends = if chain.closed {
            tube.close();
            None
        } else {
            let end = |(k, c): (usize, usize)| {
                let crossing = &arcs[k].crossings[c];
                let outer = self.piece.outer[crossing.d];
                if crossing.at == outer.lo || crossing.at == outer.hi {
                    return BranchEnd::Border;
                }
                let at = Interval::point(crossing.at);
                let edge = if crossing.d == 0 {
                    [at, crossing.along]
                } else {
                    [crossing.along, at]
                };
                let edge = self.inside(edge);
                let found = trace.undecided[first..]
                    .iter()
                    .position(|u| u.cells.iter().any(|&c| touch(c, edge)));
                found.map_or(BranchEnd::Border, |k| BranchEnd::Undecided(first + k))
            };
            let (start, last) = (way[0], way[way.len() - 1]);
            Some([end(start), end((last.0, 1 - last.1))])
        };
        // What lies in the margin alone is a point of the border.
        let length: f64 = tube.parts.iter().map(|p| p.length).sum();
        if length <= 8.0 * MARGIN && !chain.closed {
            let uv = tube.parts.first().map(|p| p.points[0]);
            trace.touches.extend(uv.or_else(|| tube.place()));
            return None;
        }
        // A side of the piece inside the whole rectangle is a line where the function jumps.
        let inner = |uv: [f64; 2]| {
            (0..2).any(|d| {
                let (r, w) = (self.piece.rect[d], self.within[d]);
                (uv[d] == r.lo && r.lo > w.lo) || (uv[d] == r.hi && r.hi < w.hi)
            })
        };
        let (start, end) = (tube.parts.first()?.points[0], tube.parts.last()?.points[3]);
        let open = match ends {
            Some(e) => {
                [(e[0], start), (e[1], end)].map(|(e, p)| e == BranchEnd::Border && inner(p))
            }
            None => [false; 2],
        };
        let error = tube.bound();
        let strand = Strand {
            parts: tube.parts,
            piece: self.number,
            open,
        };
        Some(Found {
            strand,
            ends,
            error,
        })
    }
}
