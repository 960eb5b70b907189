//! Faces, loops and edges, as a body.

use super::ahead::{Ready, ahead};
use super::cover::Border;
use super::curves;
use super::file::{Got, Record, Refused};
use super::left::Left;
use super::place::Space;
use super::surfaces;
use glam::DVec3;
use nappe::CurveRef;
use nappe::body::{Body, Coedge, Edge, Face, Loop, Shell, Vertex};
use nappe::curve::Line;
use std::cell::OnceCell;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// An end of an edge farther from its vertex than this share of the edge, and than some uncertainties, is not one that is
/// meant.
const ASTRAY: f64 = 1e-2;
/// The same in uncertainties.
const UNCERTAINTIES: f64 = 10.0;
/// However large the uncertainty is, not farther than this share of the edge.
const LOST: f64 = 0.5;
/// The direction of a line has so many digits: it may pass its vertices at this share of the distance of its point.
const DIGITS: f64 = 1e-5;

/// A body that grows by the faces of a file.
pub(super) struct Builder<'s, 'a> {
    space: &'s Space<'a>,
    pub(super) body: Body,
    /// The number in the file of each face of the body.
    pub(super) numbers: Vec<u64>,
    vertices: HashMap<u64, usize>,
    /// `None` for an edge without extent, which a loop does not need.
    edges: HashMap<u64, Option<usize>>,
    /// Edges between two points of loops that are made of points.
    straight: HashMap<[u64; 2], usize>,
    points: HashMap<u64, usize>,
    /// Surfaces that are read already.
    ready: Ready,
    threads: usize,
    /// Edges of the file that could not be read, so that the reason is found once.
    refused: HashMap<u64, Refused>,
}

impl<'s, 'a> Builder<'s, 'a> {
    /// An empty body; what can be read ahead is read on so many threads.
    pub(super) fn new(space: &'s Space<'a>, threads: usize) -> Self {
        Builder {
            space,
            body: Body::default(),
            numbers: Vec::new(),
            vertices: HashMap::new(),
            edges: HashMap::new(),
            straight: HashMap::new(),
            points: HashMap::new(),
            ready: Ready::new(),
            threads,
            refused: HashMap::new(),
        }
    }

    /// Adds a shell. Faces that cannot be read are left out, and the shell is then not closed.
    pub(super) fn shell(&mut self, id: u64, solid: bool, left: &mut Left) -> Got<()> {
        let (mut id, mut same) = (id, true);
        // Shells of shells: at most one level is allowed; more is no harm.
        let record = loop {
            let record = self.space.file.record(id)?;
            match record.kind() {
                "ORIENTED_CLOSED_SHELL" | "ORIENTED_OPEN_SHELL" => {
                    same ^= !record.args().flag(3)?;
                    let inner = record.args().reference(2)?;
                    if self.space.file.kind(inner).starts_with("ORIENTED_") {
                        return Err(record.refused("it is the orientation of another orientation"));
                    }
                    id = inner;
                }
                "CLOSED_SHELL" | "OPEN_SHELL" | "CONNECTED_FACE_SET" => break record,
                _ => return Err(record.refused("shells of this kind are not read")),
            }
        };
        let mut shell = Shell {
            faces: Vec::new(),
            closed: solid || record.kind() == "CLOSED_SHELL",
        };
        let faces = record.args().references(1)?;
        ahead(self.space, &faces, self.threads, &mut self.ready);
        for face in faces {
            match self.face(face) {
                Ok((index, forward)) => shell.faces.push((index, forward == same)),
                Err(refused) => {
                    shell.closed = false;
                    left.add(&refused);
                }
            }
        }
        if shell.faces.is_empty() {
            return Err(record.refused("none of its faces could be read"));
        }
        self.body.shells.push(shell);
        Ok(())
    }

    /// Takes the faces of the last shell, a hollow, as they are seen from the solid round it: the shell then takes each of
    /// them the other way round, as those who write it ask for. What is where, and which side is out, stays.
    pub(super) fn turn_inside_out(&mut self) {
        let Some((last, before)) = self.body.shells.split_last_mut() else {
            return;
        };
        // A face of two shells keeps its side.
        let shared: HashSet<usize> = before.iter().flat_map(|s| &s.faces).map(|f| f.0).collect();
        for (face, same) in &mut last.faces {
            if *same && !shared.contains(face) {
                self.body.faces[*face].turn();
                *same = false;
            }
        }
    }

    /// Adds a face; gives its index and whether it is meant as it is.
    pub(super) fn face(&mut self, id: u64) -> Got<(usize, bool)> {
        let record = self.space.file.record(id)?;
        if record.kind() == "ORIENTED_FACE" {
            let args = record.args();
            let (inner, same) = (args.reference(2)?, args.flag(3)?);
            if self.space.file.kind(inner) == "ORIENTED_FACE" {
                return Err(record.refused("it is the orientation of another orientation"));
            }
            let (index, forward) = self.face(inner)?;
            return Ok((index, forward == same));
        }
        let args = record.args();
        if !matches!(record.kind(), "ADVANCED_FACE" | "FACE_SURFACE") {
            return Err(record.refused("faces of this kind are not read"));
        }
        let within = |r: Refused| Refused {
            // Which face is lost is what a person looks for, and the reason is in its parts.
            why: if r.id == id {
                r.why.clone()
            } else {
                format!("#{} {}: {}", r.id, r.what, r.why)
            },
            what: record.kind().to_owned(),
            id,
        };
        let mut loops = Vec::new();
        for bound in args.references(1)? {
            let bound = self.space.file.record(bound)?;
            let (args, kind) = (bound.args(), bound.kind());
            if !matches!(kind, "FACE_BOUND" | "FACE_OUTER_BOUND") {
                return Err(bound.refused("bounds of this kind are not read"));
            }
            let outline = self.outline(args.reference(1)?).map_err(within)?;
            let outline = if args.flag(2)? {
                outline
            } else {
                turned(outline)
            };
            // The outer one comes first, as other formats have it.
            if kind == "FACE_OUTER_BOUND" {
                loops.insert(0, outline);
            } else {
                loops.push(outline);
            }
        }
        let same = args.flag(3)?;
        let surface = args.reference(2)?;
        let expanse = match self.ready.get(&surface) {
            Some(ready) => ready.clone(),
            None => surfaces::expanse(self.space, surface, 0).map_err(within)?,
        };
        let (edges, points) = self.border(&loops);
        let border = Border {
            edges: &edges,
            points: &points,
            tolerance: self.space.uncertainty,
        };
        let (surface, flipped) = expanse
            .cover(&border)
            .map_err(|why| within(record.refused(why)))?;
        let forward = same != flipped;
        self.body.faces.push(Face {
            surface,
            forward,
            loops,
        });
        self.numbers.push(id);
        Ok((self.body.faces.len() - 1, true))
    }

    /// The curves and single points of some loops.
    fn border(&self, loops: &[Loop]) -> (Vec<CurveRef>, Vec<DVec3>) {
        let (mut edges, mut points) = (Vec::new(), Vec::new());
        for l in loops {
            match l {
                Loop::Edges(coedges) => edges.extend(
                    coedges
                        .iter()
                        .map(|c| self.body.edges[c.edge].curve.clone()),
                ),
                Loop::Vertex(v) => points.push(self.body.vertices[*v].point),
            }
        }
        (edges, points)
    }

    fn outline(&mut self, id: u64) -> Got<Loop> {
        let record = self.space.file.record(id)?;
        let args = record.args();
        let coedges = match record.kind() {
            "VERTEX_LOOP" => return Ok(Loop::Vertex(self.vertex(args.reference(1)?)?)),
            "EDGE_LOOP" => {
                let mut coedges = Vec::new();
                let mut last = None;
                for oriented in args.references(1)? {
                    let oriented = self.space.file.record(oriented)?;
                    let args = oriented.needed("ORIENTED_EDGE")?;
                    let (id, forward) = (args.reference(3)?, args.flag(4)?);
                    match self.edge(id)? {
                        Some(edge) => coedges.push(Coedge { edge, forward }),
                        None => last = Some(id),
                    }
                }
                match last {
                    // Nothing but a point.
                    Some(id) if coedges.is_empty() => {
                        let edge = self.space.file.record(id)?;
                        return Ok(Loop::Vertex(self.vertex(edge.args().reference(1)?)?));
                    }
                    _ => coedges,
                }
            }
            "POLY_LOOP" => self.polygon(&args.references(1)?)?,
            _ => return Err(record.refused("loops of this kind are not read")),
        };
        self.joined(&record, &coedges)?;
        Ok(Loop::Edges(coedges))
    }

    /// Checks that edges follow each other.
    fn joined(&self, record: &Record<'_>, coedges: &[Coedge]) -> Got<()> {
        if coedges.is_empty() {
            return Err(record.refused("it has no edges"));
        }
        let next = coedges.iter().cycle().skip(1);
        let open = coedges
            .iter()
            .zip(next)
            .position(|(a, b)| self.body.ends(*a)[1] != self.body.ends(*b)[0]);
        match open {
            Some(i) => Err(record.refused(format!(
                "its edge {} does not begin where the one before ends",
                (i + 1) % coedges.len() + 1
            ))),
            None => Ok(()),
        }
    }

    fn vertex(&mut self, id: u64) -> Got<usize> {
        if let Some(v) = self.vertices.get(&id) {
            return Ok(*v);
        }
        let record = self.space.file.record(id)?;
        let args = record.needed("VERTEX_POINT")?;
        let point = self.space.point(args.reference(1)?)?;
        self.vertices.insert(id, self.body.vertices.len());
        self.body.vertices.push(Vertex { point });
        Ok(self.body.vertices.len() - 1)
    }

    fn edge(&mut self, id: u64) -> Got<Option<usize>> {
        if let Some(e) = self.edges.get(&id) {
            return Ok(*e);
        }
        if let Some(r) = self.refused.get(&id) {
            return Err(r.clone());
        }
        match self.new_edge(id) {
            Ok(edge) => {
                let index = edge.map(|e| {
                    self.body.edges.push(e);
                    self.body.edges.len() - 1
                });
                self.edges.insert(id, index);
                Ok(index)
            }
            Err(r) => {
                self.refused.insert(id, r.clone());
                Err(r)
            }
        }
    }

    fn new_edge(&mut self, id: u64) -> Got<Option<Edge>> {
        let record = self.space.file.record(id)?;
        let args = record.needed("EDGE_CURVE")?;
        let vertices = [
            self.vertex(args.reference(1)?)?,
            self.vertex(args.reference(2)?)?,
        ];
        let closed = vertices[0] == vertices[1];
        let ends = vertices.map(|v| self.body.vertices[v].point);
        let (course, along) = curves::basis(self.space, args.reference(3)?)?;
        if closed && matches!(course, curves::Course::Line { .. }) {
            return Ok(None);
        }
        let tol = self.space.uncertainty;
        let same = args.flag(4)? == along;
        let curve = course
            .reach(ends, same, closed, tol)
            .map_err(|e| record.refused(e))?;
        let own = curve.ends();
        let mut apart = (0..2).map(|i| own[i].distance(ends[i])).fold(0.0, f64::max);
        // Its extent takes longer to find than all else, and is seldom needed.
        let size = OnceCell::new();
        let size = || *size.get_or_init(|| curve.bounds(curve.domain()).diagonal());
        if closed && curves::reaches(&curve) <= tol && size() <= tol {
            return Ok(None);
        }
        let mut allowed = tol;
        if let curves::Course::Line { point, vector } = course {
            // The curve is drawn from vertex to vertex; what the file states may pass them.
            let along = vector.normalize();
            for p in ends {
                let from = p - point;
                apart = apart.max(from.cross(along).length());
                allowed = allowed.max(DIGITS * from.length());
            }
        }
        if apart > allowed {
            let size = size();
            allowed = allowed
                .max(ASTRAY * size)
                .max((UNCERTAINTIES * tol).min(LOST * size));
        }
        if apart > allowed || apart.is_nan() {
            return Err(record.refused(format!(
                "its curve ends {apart} away from its vertex; {allowed} is allowed"
            )));
        }
        let tolerance = if apart > tol { apart } else { tol };
        Ok(Some(Edge {
            curve,
            vertices,
            tolerance,
        }))
    }

    fn polygon(&mut self, ids: &[u64]) -> Got<Vec<Coedge>> {
        let mut at = Vec::with_capacity(ids.len());
        for &id in ids {
            let index = match self.points.get(&id) {
                Some(v) => *v,
                None => {
                    let point = self.space.point(id)?;
                    self.body.vertices.push(Vertex { point });
                    self.points.insert(id, self.body.vertices.len() - 1);
                    self.body.vertices.len() - 1
                }
            };
            at.push((id, index));
        }
        at.dedup();
        if at.len() > 1 && at.first() == at.last() {
            at.pop();
        }
        let mut coedges = Vec::with_capacity(at.len());
        for i in 0..at.len() {
            let (a, b) = (at[i], at[(i + 1) % at.len()]);
            if let Some(&edge) = self.straight.get(&[b.0, a.0]) {
                coedges.push(Coedge {
                    edge,
                    forward: false,
                });
                continue;
            }
            let edge = match self.straight.get(&[a.0, b.0]) {
                Some(&edge) => edge,
                None => {
                    let [from, to] = [a, b].map(|p| self.body.vertices[p.1].point);
                    let line = Line::new(from, to)
                        .map_err(|e| self.space.file.refused(a.0, e.to_string()))?;
                    self.body.edges.push(Edge {
                        curve: Arc::new(line),
                        vertices: [a.1, b.1],
                        tolerance: self.space.uncertainty,
                    });
                    self.straight.insert([a.0, b.0], self.body.edges.len() - 1);
                    self.body.edges.len() - 1
                }
            };
            coedges.push(Coedge {
                edge,
                forward: true,
            });
        }
        Ok(coedges)
    }
}

/// A loop run through the other way.
fn turned(l: Loop) -> Loop {
    match l {
        Loop::Edges(coedges) => {
            let back = |c: Coedge| Coedge {
                forward: !c.forward,
                ..c
            };
            Loop::Edges(coedges.into_iter().rev().map(back).collect())
        }
        vertex @ Loop::Vertex(_) => vertex,
    }
}
