//! The division of a surface's domain into triangles of the plane of its parameters.
//!
//! The domain is cut where the surface is not C¹. Each of these blocks gets a net of lines (`roots`), and each of their
//! cells is bisected (`bisection`) as often as its squares need (`partners`, `division`, `measured`), unless the whole block
//! is proven as a grid (`bound`, `slide`).

use super::bisection::{Bisection, DEPTH, Square};
use super::bound::{Bend, ROUND_UP, sampled};
use super::division::{Division, SETTLED, triangles};
use super::lines::index;
use super::measured::{LEVELS, PARTS, Samples};
use super::options::MeshError;
use super::partners::{BETWEEN, Framed, Place, bounds, greatest_of};
use super::parts::Parts;
use super::pieces::{Enclosed, Pieces};
use super::roots::{Grid, Roots, roots};
use super::slide::slide;
use crate::box3::Box3;
use crate::breaks::Breaks;
use crate::interval::Interval;
use crate::parallel;
use crate::surface::{Corner, Dir, Side, Surface, jet_len};
use glam::DVec3;
use std::cell::LazyCell;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Squares deeper than this would be as small as the rounding of parameters.
const MAX_DEPTH: u32 = DEPTH - 4;
/// The depth at which a surface that cannot bound its position is sampled. Less, and surfaces whose enclosures are merely
/// loose over large rectangles are not proven; more, and surfaces that never bound themselves cost much.
const PATIENCE: u32 = 4;
/// Squares over several pieces that need more bisections than this are better looked at in parts than enclosed.
const FAR: u32 = LEVELS + 2;
/// The most bisections of a square in one piece whose parts are judged together.
const MOST: u32 = 12;
/// So parts can be halved too.
const _: () = assert!(MAX_DEPTH + (MOST - 1) / SETTLED <= DEPTH + 1);
/// Squares of at most this share of a piece are not measured for one bisection.
const SMALL: f64 = 1.0 / 32.0;
/// Samples of the curvature along each direction.
const CURVED: usize = 12;
/// How many times more than samples enclosures may say.
const LOOSE: f64 = 16.0;
/// The least share of the tolerance that is kept for points between partners.
const LEAST_BETWEEN: f64 = 1.0 / 64.0;
/// The shares of a block that threads work on, and the squares to begin with.
const SHARES: usize = 32;
const ENOUGH: usize = 64;
/// From so many pieces on, they are enclosed on all threads before squares ask for them.
const MANY_PIECES: usize = 16;
/// A grid with so few cells needs no sharper bound.
const FEW: f64 = 2.0;

/// Cuts a range of parameters into `n` equal parts. Equal fractions give equal parameters, since a division is correctly
/// rounded: neighbours agree on those that they share.
pub(super) fn parts(range: Interval, n: usize) -> Vec<Interval> {
    let at = |i: usize| match i {
        0 => range.lo,
        _ if i == n => range.hi,
        _ => (range.lo + (range.hi - range.lo) * (i as f64 / n as f64)).clamp(range.lo, range.hi),
    };
    let all = (0..n).map(|i| Interval {
        lo: at(i),
        hi: at(i + 1),
    });
    // Parts as small as rounding are none.
    all.filter(|p| p.lo < p.hi).collect()
}

/// The division of one surface.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// The parts of the domain along u and v between corners of the surface.
    pub(super) blocks: [Vec<Interval>; 2],
    pub(super) net: Bisection,
    /// Rectangles of cells that cover the net, block by block.
    pub(super) regions: Vec<Region>,
    /// The deviation of the mesh whose points lie on the surface.
    pub(super) deviation: f64,
    pub(super) proven: bool,
}

/// A rectangle of cells.
#[derive(Clone, Debug)]
pub(super) struct Region {
    /// The block along u and v.
    pub(super) block: [usize; 2],
    pub(super) cells: [std::ops::Range<usize>; 2],
    /// The normal around which its triangles must be counter-clockwise, where the bound needs that.
    pub(super) normal: Option<DVec3>,
}

impl Region {
    /// All cells, v fastest.
    pub(super) fn each(&self) -> impl Iterator<Item = [usize; 2]> {
        let [u, v] = self.cells.clone();
        u.flat_map(move |i| v.clone().map(move |j| [i, j]))
    }
}

impl Layout {
    /// About the number of triangles.
    pub(super) fn triangles(&self) -> usize {
        2 * self.net.count()
    }

    /// Puts a vertex into the middle of each cell at a corner of the domain where a triangle would have further vertices on
    /// two sides, or where `pinched` (by [`Corner`]) says that no triangle may have all its corners on sides. `is_open` is
    /// true for a side with further vertices between two parameters, and for one that is one point.
    pub(super) fn open_corners(
        &mut self,
        pinched: [bool; 4],
        is_open: impl Fn(Side, [f64; 2]) -> bool,
    ) {
        let cells = self.net.cells();
        for (corner, pinched) in Corner::ALL.into_iter().zip(pinched) {
            let ends = corner.ends();
            let cell = [0, 1].map(|d| ends[d] * (cells[d] - 1));
            let lines = &self.net.lines;
            // The right angle of a triangle is there where the number of lines is odd.
            let right_angle = !(ends[0] * cells[0] + ends[1] * cells[1]).is_multiple_of(2);
            let open = |side: Side| {
                let d = index(side.along());
                is_open(side, [lines[d][cell[d]], lines[d][cell[d] + 1]])
            };
            let sides = [
                [Side::South, Side::North][ends[1]],
                [Side::West, Side::East][ends[0]],
            ];
            if pinched || (right_angle && sides.into_iter().all(open)) {
                self.net.add(Square::cell(cell).centre());
            }
        }
    }
}

/// What one surface must keep to.
pub(super) struct Demand {
    /// The surface's index, for messages.
    pub(super) surface: usize,
    pub(super) tol: f64,
    /// The rounding errors of points.
    pub(super) rounding: f64,
    /// The fewest cells across each block along u and v.
    pub(super) least: [f64; 2],
    /// The largest number of triangles.
    pub(super) max: usize,
    /// The threads that may work on it at once.
    pub(super) threads: usize,
    /// True if only partners with the same parameters may be compared over blocks, so that the triangles may turn anyhow.
    pub(super) plain: bool,
    /// The sides that may get further vertices.
    pub(super) joined: [bool; 4],
}

/// The bound for uniform grids over a block, and the cells of the smallest that keeps the tolerance.
pub(super) fn grid_bound(
    surface: &dyn Surface,
    uv: [Interval; 2],
    least: [f64; 2],
    demand: &Demand,
) -> Option<(Bend, [f64; 2])> {
    let jet = surface.enclose(uv, 2);
    if !jet[0].is_finite() {
        return None;
    }
    let grid = |bend: Bend| Some((bend, bend.cells(demand.tol, least)?));
    let cells = |found: &Option<(Bend, [f64; 2])>| found.map_or(f64::INFINITY, |(_, [n, m])| n * m);
    let plain = Bend::new(&jet, uv);
    let mut found = grid(plain);
    // The sharper bound is worth its enclosures if it could save cells.
    if !demand.plain && cells(&found) > FEW {
        let worth = |bend: &Bend| cells(&grid(*bend)) < cells(&found);
        let sharper = slide(surface, uv, &jet, &plain, demand.tol, worth).and_then(grid);
        if cells(&sharper) < cells(&found) {
            found = sharper;
        }
    }
    found
}

/// Cuts the domain along a direction where the surface is not C¹.
fn blocks(surface: &dyn Surface, dir: Dir, index: usize) -> Result<Vec<Interval>, MeshError> {
    let breaks = surface.breaks(dir);
    if let Some(at) = breaks.tear() {
        return Err(MeshError::Torn {
            surface: index,
            dir,
            at,
        });
    }
    let domain = breaks.domain();
    let mut cuts = vec![domain.lo];
    cuts.extend(breaks.below(1));
    cuts.push(domain.hi);
    Ok(cuts.windows(2).map(|w| Interval::new(w[0], w[1])).collect())
}

/// What is kept of a tolerance for points between the partners of different squares, as samples of the curvature say: where
/// it is not enough, partners have the same parameters.
fn between(surface: &dyn Surface, tol: f64) -> f64 {
    let most = BETWEEN * tol;
    let place = Place {
        uv: surface.domain(),
        block: surface.domain(),
        least: [0.0; 2],
    };
    let params = place.uv.map(|r| -> Vec<f64> {
        let at = |k: usize| r.lo + r.width() * (k as f64 + 0.5) / CURVED as f64;
        (0..CURVED).map(at).collect()
    });
    let mut jets = vec![DVec3::ZERO; CURVED * CURVED * jet_len(2)];
    surface.grid_jets(&params[0], &params[1], 2, &mut jets);
    let of = |jet: &[DVec3]| {
        let boxes: Vec<Box3> = jet.iter().map(|&d| Box3::point(d)).collect();
        Framed::new(&place, &boxes).map_or(most, |f| f.between(tol))
    };
    let all = jets.chunks_exact(jet_len(2)).map(of);
    // Enclosures over large squares say several times more than samples.
    let found = LOOSE * greatest_of(all);
    // NaN is none.
    if found <= most {
        found.max(LEAST_BETWEEN * tol)
    } else {
        most
    }
}

/// Divides a surface.
pub(super) fn layout(surface: &dyn Surface, demand: &Demand) -> Result<Layout, MeshError> {
    let blocks = [
        blocks(surface, Dir::U, demand.surface)?,
        blocks(surface, Dir::V, demand.surface)?,
    ];
    let Roots { lines, grids } = roots(surface, &blocks, demand);
    demand.allows(2.0 * lines[0].len() as f64 * lines[1].len() as f64)?;
    let mut out = Layout {
        blocks,
        net: Bisection::new(lines),
        regions: Vec::new(),
        deviation: 0.0,
        proven: true,
    };
    let [nu, nv] = [0, 1].map(|d| out.blocks[d].len());
    let pieces = Pieces::new(surface, demand.tol);
    // Not for surfaces that are grids throughout.
    let between = LazyCell::new(|| between(surface, demand.tol));
    for (i, j) in (0..nu).flat_map(|i| (0..nv).map(move |j| (i, j))) {
        let grid = grids[i * nv + j].as_ref();
        out.add_block(&pieces, demand, &between, [i, j], grid)?;
    }
    Ok(out)
}

impl Demand {
    fn allows(&self, triangles: f64) -> Result<(), MeshError> {
        if triangles > self.max as f64 {
            return Err(MeshError::TooMany {
                needed: triangles,
                max: self.max,
            });
        }
        Ok(())
    }
}

impl Layout {
    fn add_block(
        &mut self,
        pieces: &Pieces,
        demand: &Demand,
        between: &LazyCell<f64, impl FnOnce() -> f64>,
        at: [usize; 2],
        grid: Option<&Grid>,
    ) -> Result<(), MeshError> {
        if let Some((regions, deviation)) = grid.and_then(|g| self.proven(at, g, demand.tol)) {
            self.regions.extend(regions);
            self.deviation = self.deviation.max(deviation);
            return Ok(());
        }
        let block = [0, 1].map(|d| self.blocks[d][at[d]]);
        let region = Region {
            block: at,
            cells: [0, 1].map(|d| self.cells(d, block[d])),
            normal: None,
        };
        let between = **between;
        if (MANY_PIECES..=region.each().count()).contains(&pieces.count()) {
            pieces.prepare(demand.threads);
        }
        let blank = self.net.of_lines();
        let work = || Work::new(demand, between, blank.of_lines(), pieces, block);
        let mut open: Vec<Square> = region.each().map(Square::cell).collect();
        // The largest squares first, until there are enough for all threads: so that few cells are shared as well.
        let (mut first, mut done) = (work(), 0);
        while (1..ENOUGH).contains(&(open.len() - done)) {
            first.square(open[done], &mut open)?;
            done += 1;
        }
        let shares: Vec<_> = open[done..]
            .chunks(open[done..].len().div_ceil(SHARES).max(1))
            .collect();
        self.join(first.closed(), demand)?;
        let total = AtomicUsize::new(0);
        let (mut complete, mut joined) = (0, Ok(()));
        parallel::in_order(
            demand.threads,
            shares.len(),
            |k| work().run(shares[k]),
            |found| match found {
                Ok(found) => {
                    let own = found.triangles as usize;
                    total.fetch_add(own, Ordering::Relaxed) + own > demand.max
                }
                Err(_) => true,
            },
            |found| {
                complete += 1;
                if joined.is_ok() {
                    joined = found.and_then(|found| self.join(found, demand));
                }
            },
        );
        joined?;
        if complete < shares.len() {
            // Work stopped at the limit.
            return Err(MeshError::TooMany {
                needed: self.triangles() as f64,
                max: demand.max,
            });
        }
        self.regions.push(region);
        Ok(())
    }

    /// Takes in what some squares need.
    fn join(&mut self, found: Found, demand: &Demand) -> Result<(), MeshError> {
        self.net.join(&found.net);
        self.deviation = self.deviation.max(found.deviation);
        self.proven &= found.proven;
        demand.allows(self.triangles() as f64)
    }

    /// The cells between two lines.
    fn cells(&self, d: usize, part: Interval) -> std::ops::Range<usize> {
        let number = |at: f64| self.net.lines[d].partition_point(|&t| t < at);
        number(part.lo)..number(part.hi)
    }

    /// The parts of a grid with their largest deviation, if the lines cut all into small enough cells.
    fn proven(&self, block: [usize; 2], grid: &Grid, tol: f64) -> Option<(Vec<Region>, f64)> {
        let [us, vs] = &grid.parts;
        let parts = us.iter().flat_map(|&u| vs.iter().map(move |&v| [u, v]));
        let (mut regions, mut worst) = (Vec::new(), 0.0f64);
        for (part, bend) in parts.zip(&grid.bends) {
            let cells = [0, 1].map(|d| self.cells(d, part[d]));
            let fewest = [0, 1].map(|d| {
                let lines = self.net.lines[d].get(cells[d].start..=cells[d].end)?;
                // Lines of other grids may not stop here.
                let fits = lines.first() == Some(&part[d].lo) && lines.last() == Some(&part[d].hi);
                let widest = lines.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
                fits.then(|| part[d].width() / widest)
            });
            let deviation = bend.deviation(fewest[0]?, fewest[1]?);
            if deviation.is_nan() || deviation > tol {
                return None;
            }
            worst = worst.max(deviation);
            regions.push(Region {
                block,
                cells,
                normal: bend.normal,
            });
        }
        Some((regions, worst))
    }
}

/// The work on some squares of a block.
struct Work<'a> {
    surface: &'a dyn Surface,
    demand: &'a Demand,
    /// What is kept of the tolerance for points between the partners of different squares.
    between: f64,
    pieces: &'a Pieces<'a>,
    block: [Interval; 2],
    found: Found,
}

/// What some squares need.
struct Found {
    /// The vertices that the squares need.
    net: Bisection,
    /// About the number of triangles.
    triangles: f64,
    deviation: f64,
    proven: bool,
}

impl<'a> Work<'a> {
    fn new(
        demand: &'a Demand,
        between: f64,
        net: Bisection,
        pieces: &'a Pieces<'a>,
        block: [Interval; 2],
    ) -> Self {
        Self {
            surface: pieces.surface(),
            demand,
            between,
            pieces,
            block,
            found: Found {
                net,
                triangles: 0.0,
                deviation: 0.0,
                proven: true,
            },
        }
    }

    fn run(mut self, squares: &[Square]) -> Result<Found, MeshError> {
        let mut open = Vec::new();
        for &square in squares {
            open.push(square);
            while let Some(square) = open.pop() {
                self.square(square, &mut open)?;
            }
        }
        Ok(self.closed())
    }

    /// What was found, with all vertices that others need.
    fn closed(mut self) -> Found {
        self.found.net.close();
        self.found
    }

    /// Refines a square, or leaves that to its children.
    fn square(&mut self, square: Square, open: &mut Vec<Square>) -> Result<(), MeshError> {
        let net = &self.found.net;
        let (lower, upper) = (net.uv(square.corner), net.uv(square.upper()));
        let place = Place {
            uv: [0, 1].map(|d| Interval {
                lo: lower[d],
                hi: upper[d],
            }),
            block: self.block,
            least: [0, 1].map(|d| self.least(d, square)),
        };
        let deeper = square.depth < MAX_DEPTH
            && place.uv.iter().all(|r| {
                let middle = r.lo + 0.5 * r.width();
                r.lo < middle && middle < r.hi
            });
        if deeper && self.is_large(&place) {
            return self.quarter(square, open);
        }
        let judged = self.judge(&place, square)?;
        let level = match judged.level {
            Some(level) if level <= SETTLED || !deeper => level,
            Some(level) => match judged.parts {
                Some(parts) if parts.triangles() < triangles(level) => {
                    self.found.proven &= judged.proven;
                    return self.accept(square, parts, open);
                }
                None if judged.least < level => return self.quarter(square, open),
                _ => level,
            },
            None if deeper => return self.quarter(square, open),
            // Nothing can be said, even about the smallest square.
            _ => {
                self.found.proven = false;
                let ends = [0, 1, 2, 3].map(|k| {
                    self.surface.point([0, 1].map(|d| {
                        let r = place.uv[d];
                        [r.lo, r.hi][k >> d & 1]
                    }))
                });
                let size = Box3::around(ends).map_or(0.0, |b| b.diagonal());
                self.found.deviation = self.found.deviation.max(size);
                0
            }
        };
        let deepest = 2 * (DEPTH - square.depth);
        self.found.proven &= level <= deepest;
        self.found.triangles += triangles(level);
        self.demand.allows(self.found.triangles)?;
        self.found.net.refine(square, level.min(deepest));
        self.found.proven &= judged.proven;
        self.deviate(judged.deviation);
        Ok(())
    }

    /// Takes note of a deviation of points of the mesh.
    fn deviate(&mut self, deviation: f64) {
        if deviation.is_finite() {
            self.found.deviation = self.found.deviation.max(deviation + self.between);
        }
    }

    /// Refines the parts of a square.
    fn accept(
        &mut self,
        square: Square,
        parts: Division,
        open: &mut Vec<Square>,
    ) -> Result<(), MeshError> {
        self.demand
            .allows(self.found.triangles + parts.triangles())?;
        let refined = parts.refine(&mut self.found.net, square, open);
        self.found.triangles += refined.triangles;
        self.found.proven &= refined.fits;
        self.deviate(parts.deviation());
        Ok(())
    }

    /// Leaves a square to its children.
    fn quarter(&mut self, square: Square, open: &mut Vec<Square>) -> Result<(), MeshError> {
        self.found.net.refine(square, 2);
        open.extend(square.children());
        self.demand.allows(self.found.triangles)
    }

    /// True if the curvature in the middle alone needs so many bisections that enclosures over the square are not worth
    /// their cost.
    fn is_large(&self, place: &Place) -> bool {
        let mut jet = [DVec3::ZERO; jet_len(2)];
        let middle = place.uv.map(Interval::mid);
        self.surface
            .jet_into(middle, Default::default(), 2, &mut jet);
        let framed = Framed::new(place, &jet.map(Box3::point));
        self.is_far(place, self.at_best(framed.as_ref()))
    }

    /// True if a square needs more bisections at best than are looked at together.
    fn is_far(&self, place: &Place, at_best: Option<u32>) -> bool {
        at_best
            .is_some_and(|level| level > FAR && (level > MOST || !self.pieces.is_in_one(place.uv)))
    }

    /// The bisections that a square would need if its derivatives were constant.
    fn at_best(&self, framed: Option<&Framed>) -> Option<u32> {
        let (level, _) = framed?.within_reach().level(self.demand.tol, 0.0)?;
        Some(level)
    }

    /// See [`Place::least`].
    fn least(&self, d: usize, square: Square) -> f64 {
        let lines = &self.found.net.lines[d];
        let cell = (square.corner[d] >> DEPTH) as usize;
        let near = lines[cell.saturating_sub(1)..(cell + 3).min(lines.len())].windows(2);
        let least = near.map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
        least / (1u64 << square.depth) as f64
    }

    fn judge(&mut self, place: &Place, square: Square) -> Result<Judged, MeshError> {
        let around = place.surroundings();
        let mut enclosed = self.pieces.enclose(around);
        let mut framed = Framed::new(place, &enclosed.jet);
        let mut at_best = self.at_best(framed.as_ref());
        let coarse = self.is_far(place, at_best);
        let local = if !coarse && framed.is_some() {
            self.pieces.local(place.uv)
        } else {
            None
        };
        let inside = place.is_inside();
        // What is known about the square itself says enough about it, or about its parts.
        let known = local.is_some() && (inside || at_best > Some(SETTLED));
        if !(enclosed.sharp || coarse || known) {
            enclosed = self.pieces.sharpened(enclosed, around);
            framed = Framed::new(place, &enclosed.jet);
            at_best = self.at_best(framed.as_ref());
        }
        let (enclosed, proven) = if enclosed.jet[0].is_finite() {
            (enclosed, true)
        } else if square.depth < PATIENCE {
            return Ok(Judged::UNKNOWN);
        } else {
            // Where there is no surface, smaller squares do not help.
            let uv = place.uv.map(Interval::mid);
            if !self.surface.point(uv).is_finite() {
                let surface = self.demand.surface;
                return Err(MeshError::NotFinite { surface, uv });
            }
            match sampled(self.surface, place.uv) {
                Some(jet) => {
                    let enclosed = Enclosed::from(jet);
                    framed = Framed::new(place, &enclosed.jet);
                    at_best = self.at_best(framed.as_ref());
                    (enclosed, false)
                }
                None => return Ok(Judged::UNKNOWN),
            }
        };
        let jet = &enclosed.jet;
        // Points are no farther from each other than the size; and in a mean that has the parameters of a point, first
        // derivatives count only with their distance from the middle.
        let [du, dv] = place.uv.map(|r| r.width());
        let steady = 0.25 * (jet[1].diagonal() * du + jet[2].diagonal() * dv);
        let size = jet[0].diagonal().min(steady * ROUND_UP);
        let tol = self.demand.tol - self.between;
        if proven && size <= tol {
            // Whatever the second derivatives.
            return Ok(Judged {
                level: Some(0),
                deviation: size,
                least: 0,
                proven,
                parts: None,
            });
        }
        let grain = place
            .uv
            .iter()
            .map(|r| 2.0 * f64::EPSILON * r.mag() / r.width());
        let grain = grain.fold(0.0, f64::max);
        let least = at_best.unwrap_or(0);
        let slides = |f: &Framed| proven && f.between(self.demand.tol) <= self.between;
        let framed = framed.filter(slides);
        let (framed, local) = (framed.as_ref(), local.as_ref());
        let parts = framed.zip(local).map(|(f, l)| Parts::new(f, place, l));
        let parts = parts.as_ref();
        let best = bounds(self.surface, place, jet, parts, proven, framed, tol)
            .iter()
            .filter_map(|b| b.level(tol, grain))
            .min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        let Some((mut level, mut deviation)) = best else {
            return Ok(Judged {
                proven,
                ..Judged::UNKNOWN
            });
        };
        // Bounds of whole squares say too much about their parts.
        let inner = level.min(least + 1);
        let parts = parts
            .filter(|_| (SETTLED + 1..=MOST).contains(&inner))
            .and_then(|parts| Division::new(parts, inner, grain, tol));
        // Of many small squares, some triangles more cost less than measuring.
        let small = local.is_some_and(|l| du * dv <= SMALL * 4.0 * l.half[0] * l.half[1]);
        // With hardly a bisection if all goes well: measuring says for each number of bisections what the bound says for
        // `level` and more.
        if framed.is_some()
            && parts.is_none()
            && level > if small { least + 1 } else { least }
            && level <= LEVELS + 1
            && least <= 1
        {
            let open = Side::ALL.map(|side| {
                let d = index(side.across());
                let (place, domain) = (place.uv[d], self.surface.domain()[d]);
                let on = if side.is_upper() {
                    place.hi >= domain.hi
                } else {
                    place.lo <= domain.lo
                };
                on && self.demand.joined[side as usize]
            });
            // Samples and corners are rounded, and so are their parameters.
            let along = jet[1].norm().hi * du + jet[2].norm().hi * dv;
            let rounding = 4.0 * (self.demand.rounding + grain * along);
            for parts in PARTS {
                if level <= least {
                    break;
                }
                let samples = Samples::new(self.surface, place, jet, parts, tol);
                for fewer in (0..level).rev() {
                    let error = samples.error(fewer, square.is_even(), open) + rounding;
                    let error = error * ROUND_UP;
                    if error.is_nan() || error > tol {
                        break;
                    }
                    (level, deviation) = (fewer, deviation.max(error));
                }
            }
        }
        Ok(Judged {
            level: Some(level),
            deviation,
            least,
            proven,
            parts,
        })
    }
}

/// What is known about a square.
struct Judged {
    /// The bisections that it needs.
    level: Option<u32>,
    deviation: f64,
    /// The bisections that it would need at best.
    least: u32,
    proven: bool,
    /// What its parts need, if that is worth a look.
    parts: Option<Division>,
}

impl Judged {
    const UNKNOWN: Self = Self {
        level: None,
        deviation: f64::INFINITY,
        least: 0,
        proven: false,
        parts: None,
    };
}
