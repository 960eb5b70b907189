//! Faces that share edges: 186, 514, 510 with 508, 504 and 502.

use super::curves::text;
use super::record::Got;
use super::space::Space;
use super::surfaces::Sheet;
use crate::document::FaceStyle;
use glam::{DAffine3, DVec3};
use nappe::CurveRef;
use nappe::body::{Body, Coedge, Edge, Face, Loop, Shell, Vertex, cover};
use std::collections::HashMap;
use std::sync::Arc;

/// The ends of an edge's curve may be this far from its vertices, relative to the size of the edge.
const GAP: f64 = 1e-2;
/// Curves smaller than this, relative to the coordinates, are points.
const POINT: f64 = 1e-12;

/// A body under construction.
pub(super) struct Builder<'a> {
    space: &'a Space,
    map: DAffine3,
    pub(super) body: Body,
    pub(super) faces: Vec<FaceStyle>,
    /// Faces that were left out, with the reason.
    pub(super) left: Vec<(i64, String)>,
    lists: HashMap<i64, Arc<Vec<DVec3>>>,
    edge_lists: HashMap<i64, Arc<Vec<[i64; 5]>>>,
    vertices: HashMap<(i64, i64), usize>,
    edges: HashMap<(i64, i64), Option<usize>>,
}

impl<'a> Builder<'a> {
    pub(super) fn new(space: &'a Space, map: DAffine3) -> Self {
        Builder {
            space,
            map,
            body: Body::default(),
            faces: Vec::new(),
            left: Vec::new(),
            lists: HashMap::new(),
            edge_lists: HashMap::new(),
            vertices: HashMap::new(),
            edges: HashMap::new(),
        }
    }

    /// 186: a shell around the solid and shells around its holes.
    pub(super) fn solid(&mut self, number: i64) -> Got<()> {
        let (entry, mut r) = self.space.open(number)?;
        self.map *= self.space.placement(entry)?;
        let (outer, agrees) = (r.int()?, r.int()? != 0);
        self.shell(outer, agrees, true)?;
        for _ in 0..r.count(2)? {
            let (hole, agrees) = (r.int()?, r.int()? != 0);
            self.shell(hole, agrees, true)?;
        }
        Ok(())
    }

    /// 514. `agrees`: its normals are those of the solid.
    pub(super) fn shell(&mut self, number: i64, agrees: bool, solid: bool) -> Got<()> {
        let (entry, mut r) = self.space.open(number)?;
        if entry.kind != 514 {
            return Err(format!("D{number} should be a shell"));
        }
        let before = self.map;
        self.map *= self.space.placement(entry)?;
        let mut shell = Shell::default();
        let mut all = true;
        for _ in 0..r.count(2)? {
            let (face, own) = (r.int()?, r.int()? != 0);
            match self.face(face) {
                Ok(index) => {
                    let mirrored = self.mirrors(face)?;
                    shell.faces.push((index, (own == agrees) != mirrored));
                }
                Err(why) => {
                    all = false;
                    self.left.push((face, why));
                }
            }
        }
        self.map = before;
        shell.closed = all && (solid || entry.form == 1);
        if shell.faces.is_empty() {
            return Err("none of its faces can be read".into());
        }
        self.body.shells.push(shell);
        Ok(())
    }

    /// Whether a face is placed by a mirror: its image has the normal of its own parameters, on the other side.
    fn mirrors(&self, face: i64) -> Got<bool> {
        let map = self.map * self.space.placement(self.space.entry(face)?)?;
        Ok(map.matrix3.determinant() < 0.0)
    }

    /// 510.
    pub(super) fn face(&mut self, number: i64) -> Got<usize> {
        let (entry, mut r) = self.space.open(number)?;
        if entry.kind != 510 {
            return Err(format!("D{number} should be a face"));
        }
        let before = self.map;
        self.map *= self.space.placement(entry)?;
        let made = self.face_of(&mut r);
        self.map = before;
        let face = made?;
        self.body.faces.push(face);
        self.faces.push(FaceStyle {
            name: self.space.name_of(number),
            colour: self.space.colour(entry),
        });
        Ok(self.body.faces.len() - 1)
    }

    fn face_of(&mut self, r: &mut super::record::Record) -> Got<Face> {
        let sheet = self.space.sheet(r.int()?, self.map)?;
        let n = r.count(1)?;
        r.skip(1);
        let mut loops = Vec::new();
        for number in r.ints(n)? {
            loops.extend(self.border(number)?);
        }
        let surface = match sheet {
            Sheet::Bounded(s, _) => s,
            Sheet::Endless(e) => {
                let edges = loops.iter().flat_map(|l| match l {
                    Loop::Edges(c) => c.as_slice(),
                    Loop::Vertex(_) => &[],
                });
                let curves: Vec<CurveRef> = edges
                    .map(|c| self.body.edges[c.edge].curve.clone())
                    .collect();
                cover(&e, &curves).map_err(text)?
            }
        };
        if loops.is_empty() {
            let whole = nappe::body::sew(std::slice::from_ref(&surface), 0.0).body;
            if whole
                .edges
                .iter()
                .zip(whole.uses())
                .any(|(_, u)| u.len() < 2)
            {
                return Err("a face without borders on a surface that is not closed".into());
            }
        }
        Ok(Face {
            surface,
            forward: true,
            loops,
        })
    }

    /// 508.
    fn border(&mut self, number: i64) -> Got<Option<Loop>> {
        let mut r = self.space.record(number, 508)?;
        let (mut coedges, mut vertex) = (Vec::new(), None);
        for _ in 0..r.count(5)? {
            let kind = r.int()?;
            let (list, index, forward) = (r.int()?, r.int()?, r.int()? != 0);
            let flat = r.count(2)?;
            r.skip(2 * flat);
            if kind == 1 {
                vertex = Some(self.vertex(list, index)?);
            } else if let Some(edge) = self.edge(list, index)? {
                coedges.push(Coedge { edge, forward });
            }
        }
        if coedges.is_empty() {
            return Ok(vertex.map(Loop::Vertex));
        }
        let n = coedges.len();
        for i in 0..n {
            let (a, b) = (coedges[i], coedges[(i + 1) % n]);
            if self.body.ends(a)[1] != self.body.ends(b)[0] {
                return Err(format!("its loop D{number} is open after its edge {i}"));
            }
        }
        Ok(Some(Loop::Edges(coedges)))
    }

    fn vertex(&mut self, list: i64, index: i64) -> Got<usize> {
        if let Some(&v) = self.vertices.get(&(list, index)) {
            return Ok(v);
        }
        if !self.lists.contains_key(&list) {
            let map = self.map * self.space.placement(self.space.entry(list)?)?;
            let mut r = self.space.record(list, 502)?;
            let n = r.count(3)?;
            let points = r.points(n)?.into_iter().map(|p| map.transform_point3(p));
            self.lists.insert(list, Arc::new(points.collect()));
        }
        let points = &self.lists[&list];
        let point = usize::try_from(index - 1).ok().and_then(|i| points.get(i));
        let point = *point
            .ok_or_else(|| format!("it names vertex {index} of D{list}, which is not there"))?;
        self.body.vertices.push(Vertex { point });
        self.vertices
            .insert((list, index), self.body.vertices.len() - 1);
        Ok(self.body.vertices.len() - 1)
    }

    /// The edge, or none if it is a point.
    fn edge(&mut self, list: i64, index: i64) -> Got<Option<usize>> {
        if let Some(&e) = self.edges.get(&(list, index)) {
            return Ok(e);
        }
        if !self.edge_lists.contains_key(&list) {
            let mut r = self.space.record(list, 504)?;
            let n = r.count(5)?;
            let rows = (0..n).map(|_| Ok([r.int()?, r.int()?, r.int()?, r.int()?, r.int()?]));
            self.edge_lists
                .insert(list, Arc::new(rows.collect::<Got<_>>()?));
        }
        let rows = self.edge_lists[&list].clone();
        let row = usize::try_from(index - 1).ok().and_then(|i| rows.get(i));
        let &[curve, l0, v0, l1, v1] =
            row.ok_or_else(|| format!("it names edge {index} of D{list}, which is not there"))?;
        let mut curve = self.space.curve(curve, self.map)?;
        let vertices = [self.vertex(l0, v0)?, self.vertex(l1, v1)?];
        let points = vertices.map(|v| self.body.vertices[v].point);
        let bounds = curve.bounds(curve.domain());
        let size = bounds.diagonal();
        let far = points[0].abs().max_element();
        if size <= POINT * far.max(f64::MIN_POSITIVE) && vertices[0] == vertices[1] {
            self.edges.insert((list, index), None);
            return Ok(None);
        }
        let off = |[a, b]: [DVec3; 2]| a.distance(points[0]).max(b.distance(points[1]));
        let [a, b] = curve.ends();
        // Some programs give the curve the other way round than its vertices.
        if off([b, a]) < off([a, b]) && off([a, b]) > GAP * size {
            curve = reversed(curve)?;
        }
        let tolerance = off(curve.ends());
        if tolerance.is_nan() || tolerance > GAP * size {
            return Err(format!(
                "its edge {index} of D{list} ends {tolerance:.3e} away from its vertices"
            ));
        }
        self.body.edges.push(Edge {
            curve,
            vertices,
            tolerance,
        });
        let edge = Some(self.body.edges.len() - 1);
        self.edges.insert((list, index), edge);
        Ok(edge)
    }
}

fn reversed(curve: CurveRef) -> Got<CurveRef> {
    if let Some(n) = curve.to_nurbs() {
        return Ok(Arc::new(n.reversed().map_err(text)?));
    }
    Ok(Arc::new(nappe::curve::Trimmed::reversed(curve)))
}
