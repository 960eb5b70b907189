//! Trimmed faces without shared edges: 144 with 142, 143 with 141, and bounded planes 108.

use super::curves::text;
use super::record::Got;
use super::space::Space;
use super::surfaces::Sheet;
use glam::{DAffine3, DVec2, DVec3};
use nappe::body::{Body, Coedge, Edge, Face, Loop, Shell, Vertex, cover, sew};
use nappe::query::{Finder, FinderOptions};
use nappe::surface::Side;
use nappe::{CurveRef, SurfaceRef};

/// The pieces of a boundary may be this far apart, relative to its size. What is farther apart has a piece missing.
const GAP: f64 = 1e-3;
/// Samples of each piece that tell which way round a boundary goes.
const SAMPLES: usize = 16;
/// Samples of a boundary that are projected for that, where the file has no curve in parameters, and the fewest of a piece.
const PROJECTED: [usize; 2] = [64, 8];
/// Sides this near, relative to the size of the surface, make it closed.
const CLOSED: f64 = 1e-9;

/// A boundary: its pieces in space, and in parameters if the file has them.
struct Border {
    pieces: Vec<CurveRef>,
    flat: Vec<CurveRef>,
}

impl Space {
    /// The body of one face.
    pub(super) fn trimmed(&self, number: i64, map: DAffine3) -> Got<Body> {
        let (entry, mut r) = self.open(number)?;
        let own = map * self.placement(entry)?;
        match entry.kind {
            144 => {
                let sheet = self.sheet(r.int()?, own)?;
                let (outer, inner) = (r.int()?, r.count(1)?);
                let whole = outer == 0;
                let first = r.int()?;
                let mut borders = Vec::new();
                if !whole {
                    borders.push(self.on_surface(first, own)?);
                }
                for n in r.ints(inner)? {
                    borders.push(self.on_surface(n, own)?);
                }
                face(sheet, borders, whole, true)
            }
            143 => {
                r.skip(1);
                let sheet = self.sheet(r.int()?, own)?;
                let n = r.count(1)?;
                let borders = r.ints(n)?;
                let borders = borders.into_iter().map(|b| self.boundary(b, own));
                face(sheet, borders.collect::<Got<_>>()?, false, false)
            }
            108 if entry.form == 1 => {
                r.skip(4);
                let pieces = self.pieces(r.int()?, own)?;
                let flat = Vec::new();
                face(
                    self.sheet(number, map)?,
                    vec![Border { pieces, flat }],
                    false,
                    true,
                )
            }
            _ => match self.sheet(number, map)? {
                Sheet::Bounded(s, _) => Ok(sew(&[s], 0.0).body),
                Sheet::Endless(e) => {
                    let s = cover(&e, &[]).map_err(text)?;
                    Ok(sew(&[s], 0.0).body)
                }
            },
        }
    }

    /// 142.
    fn on_surface(&self, number: i64, map: DAffine3) -> Got<Border> {
        let map = map * self.placement(self.entry(number)?)?;
        let mut r = self.record(number, 142)?;
        r.skip(2);
        let (flat, space) = (r.int()?, r.int()?);
        if space == 0 {
            return Err("a boundary that is given in parameters only".into());
        }
        Ok(Border {
            pieces: self.pieces(space, map)?,
            flat: match flat {
                0 => Vec::new(),
                n => self.pieces(n, DAffine3::IDENTITY).unwrap_or_default(),
            },
        })
    }

    /// 141.
    fn boundary(&self, number: i64, map: DAffine3) -> Got<Border> {
        let map = map * self.placement(self.entry(number)?)?;
        let mut r = self.record(number, 141)?;
        r.skip(3);
        let mut pieces = Vec::new();
        for _ in 0..r.count(3)? {
            let (curve, turned) = (r.int()?, r.int()? == 2);
            let flat = r.count(1)?;
            r.skip(flat);
            let mut part = self.pieces(curve, map)?;
            if turned {
                part.reverse();
            }
            pieces.extend(part);
        }
        let flat = Vec::new();
        Ok(Border { pieces, flat })
    }
}

/// A face inside borders. `whole`: its surface is bounded by its own sides as well. `ordered`: the first border is the
/// outer one.
fn face(sheet: Sheet, borders: Vec<Border>, whole: bool, ordered: bool) -> Got<Body> {
    let (surface, same) = match sheet {
        Sheet::Bounded(s, same) => (s, same),
        Sheet::Endless(_) if whole => {
            return Err("a face of an endless surface without a border".into());
        }
        Sheet::Endless(e) => {
            let all: Vec<CurveRef> = borders.iter().flat_map(|b| b.pieces.clone()).collect();
            (cover(&e, &all).map_err(text)?, false)
        }
    };
    let mut body = Body::default();
    if whole {
        body = sew(std::slice::from_ref(&surface), 0.0).body;
        let face = &mut body.faces[0];
        if !face.forward {
            // As the file sees it: with the surface's own normal.
            face.forward = true;
            for l in &mut face.loops {
                if let Loop::Edges(c) = l {
                    turn(c);
                }
            }
        }
    } else {
        body.faces.push(Face {
            surface: surface.clone(),
            forward: true,
            loops: Vec::new(),
        });
    }
    let mut loops = Vec::new();
    for b in &borders {
        let coedges = chain(&mut body, &b.pieces)?;
        loops.push((coedges, signed_area(&surface, same, b, &body)));
    }
    let outer = if ordered && !whole {
        Some(0)
    } else if whole {
        None
    } else {
        let size = |i: &usize| loops[*i].1.unwrap_or(0.0).abs();
        (0..loops.len()).max_by(|a, b| size(a).total_cmp(&size(b)))
    };
    for (i, (mut coedges, area)) in loops.into_iter().enumerate() {
        let wanted = outer == Some(i);
        if area.is_some_and(|a| a != 0.0 && (a > 0.0) != wanted) {
            turn(&mut coedges);
        }
        body.faces[0].loops.push(Loop::Edges(coedges));
    }
    body.shells = vec![Shell {
        faces: vec![(0, true)],
        closed: false,
    }];
    Ok(body)
}

/// A loop the other way round.
fn turn(coedges: &mut [Coedge]) {
    coedges.reverse();
    coedges.iter_mut().for_each(|c| c.forward = !c.forward);
}

/// Edges end to end, each run through as it fits the one before.
fn chain(body: &mut Body, pieces: &[CurveRef]) -> Got<Vec<Coedge>> {
    let boxes = pieces.iter().map(|p| p.bounds(p.domain()));
    let whole = boxes.clone().reduce(|a, b| a.hull(b));
    let size = whole.map_or(0.0, |b| b.diagonal());
    if !size.is_finite() {
        return Err("a boundary that has no finite box".into());
    }
    // A piece that is a point has no course.
    let kept: Vec<&CurveRef> = pieces
        .iter()
        .zip(boxes)
        .filter(|(_, b)| b.diagonal() > CLOSED * size)
        .map(|p| p.0)
        .collect();
    let n = kept.len();
    if n == 0 {
        return Err("a boundary without extent".into());
    }
    let ends: Vec<[DVec3; 2]> = kept.iter().map(|c| c.ends()).collect();
    // Either end of a circle fits: rounding must not tell which way it runs.
    let closed: Vec<bool> = kept
        .iter()
        .zip(&ends)
        .map(|(c, [a, b])| a.distance(*b) <= GAP * c.bounds(c.domain()).diagonal())
        .collect();
    let mut forward = vec![true; n];
    if n > 1 && !closed[0] {
        let near = |p: DVec3| {
            ends[1]
                .iter()
                .map(|q| p.distance(*q))
                .fold(f64::INFINITY, f64::min)
        };
        // Of two pieces that make a loop, either way fits.
        forward[0] = near(ends[0][1]) <= near(ends[0][0]) + GAP * size;
    }
    let end = |i: usize, forward: bool, last: bool| ends[i][usize::from(forward == last)];
    let mut gaps = vec![0.0; n];
    for i in 0..n {
        let before = (i + n - 1) % n;
        if i > 0 && !closed[i] {
            let at = end(before, forward[before], true);
            forward[i] = at.distance(ends[i][0]) <= at.distance(ends[i][1]);
        }
    }
    for i in 0..n {
        let before = (i + n - 1) % n;
        gaps[i] = end(before, forward[before], true).distance(end(i, forward[i], false));
        if gaps[i] > GAP * size {
            return Err(format!(
                "a boundary that is open by {:.3e} before its piece {i}",
                gaps[i]
            ));
        }
    }
    let (v0, e0) = (body.vertices.len(), body.edges.len());
    for i in 0..n {
        let point = end(i, forward[i], false);
        body.vertices.push(Vertex { point });
        let (a, b) = (v0 + i, v0 + (i + 1) % n);
        body.edges.push(Edge {
            curve: kept[i].clone(),
            vertices: if forward[i] { [a, b] } else { [b, a] },
            tolerance: gaps[(i + 1) % n],
        });
    }
    Ok((0..n)
        .map(|i| Coedge {
            edge: e0 + i,
            forward: forward[i],
        })
        .collect())
}

/// Twice the area that a border goes round in parameters, positive if it is to the left; `None` if that cannot be told.
fn signed_area(surface: &SurfaceRef, same: bool, b: &Border, body: &Body) -> Option<f64> {
    let mut points: Vec<DVec2> = Vec::new();
    if b.flat.is_empty() {
        let edges: Vec<(&CurveRef, bool)> = border_edges(b, body, body.edges.len()).collect();
        return projected_area(surface, &edges);
    }
    for c in &b.flat {
        let d = c.domain();
        let at = |k: usize| c.point(d.lo + k as f64 / SAMPLES as f64 * (d.hi - d.lo));
        points.extend((0..=SAMPLES).map(|k| at(k).truncate()));
    }
    let area = polygon(&points);
    // The curve in parameters should run as the one in space does; where that can be seen, it is looked at.
    let first = &b.pieces[0];
    let forward = border_edges(b, body, body.edges.len()).next()?.1;
    let d = first.domain();
    let space = |share: f64| {
        let share = if forward { share } else { 1.0 - share };
        first.point(d.lo + share * (d.hi - d.lo))
    };
    let flat = &b.flat[0];
    let f = flat.domain();
    let uv = flat.point(f.lo + 0.25 * (f.hi - f.lo));
    if same && b.pieces.len() == b.flat.len() {
        let p = surface.point([uv.x, uv.y]);
        if p.distance(space(0.75)) < p.distance(space(0.25)) {
            return Some(-area);
        }
    }
    Some(area)
}

/// Twice the area that curves go round in parameters, by samples that are projected, positive if it is to the left. The
/// curves are end to end, each with whether it is run through forwards. `None` on a surface that closes: there an area
/// may be on either side.
pub(super) fn projected_area(surface: &SurfaceRef, curves: &[(&CurveRef, bool)]) -> Option<f64> {
    if is_closed(surface) {
        return None;
    }
    let finder = Finder::new(std::slice::from_ref(surface), FinderOptions::default()).ok()?;
    let [all, least] = PROJECTED;
    let each = all.div_ceil(curves.len().max(1)).max(least);
    let mut points: Vec<DVec2> = Vec::new();
    for &(curve, forward) in curves {
        for k in 0..each {
            let share = k as f64 / each as f64;
            let d = curve.domain();
            let share = if forward { share } else { 1.0 - share };
            let p = curve.point(d.lo + share * (d.hi - d.lo));
            points.push(DVec2::from(finder.nearest(p).ok()?.uv));
        }
    }
    Some(polygon(&points))
}

/// The curves of the border's edges, the last that were added to the body, and whether the loop runs with them.
fn border_edges<'a>(
    b: &Border,
    body: &'a Body,
    n: usize,
) -> impl Iterator<Item = (&'a CurveRef, bool)> {
    let start = n.saturating_sub(b.pieces.len());
    let edges = &body.edges[start..];
    // Vertices of the chain follow each other: an edge that runs with it starts at its own vertex.
    let first = edges.iter().flat_map(|e| e.vertices).min().unwrap_or(0);
    edges.iter().enumerate().map(move |(i, e)| {
        let single = edges.len() == 1;
        (&e.curve, single || e.vertices[0] == first + i)
    })
}

fn polygon(points: &[DVec2]) -> f64 {
    let n = points.len();
    let Some(&o) = points.first() else { return 0.0 };
    (0..n)
        .map(|i| (points[i] - o).perp_dot(points[(i + 1) % n] - o))
        .sum()
}

/// Whether opposite sides of a surface are one curve.
fn is_closed(surface: &SurfaceRef) -> bool {
    let [u, v] = surface.domain();
    let size = surface.bounds([u, v]).diagonal();
    let meet = |side: Side, share: f64| {
        let at = match side {
            Side::West => [
                [u.lo, v.lo + share * (v.hi - v.lo)],
                [u.hi, v.lo + share * (v.hi - v.lo)],
            ],
            _ => [
                [u.lo + share * (u.hi - u.lo), v.lo],
                [u.lo + share * (u.hi - u.lo), v.hi],
            ],
        };
        surface.point(at[0]).distance(surface.point(at[1])) <= CLOSED * size
    };
    [Side::West, Side::South]
        .into_iter()
        .any(|side| [0.2, 0.5, 0.7].into_iter().all(|s| meet(side, s)))
}
