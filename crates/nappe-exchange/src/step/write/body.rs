//! Bodies as entities.

use super::WriteError;
use super::geometry;
use super::out::Out;
use crate::FaceStyle;
use nappe::body::{Body, Coedge, Face, Loop, Shell};
use nappe::mesh::Certainty;

/// What a body became.
pub(super) struct Parts {
    /// Solids and shells, and whether each is a solid.
    pub(super) roots: Vec<(u64, bool)>,
    /// Each face, 0 where it is in no shell.
    pub(super) faces: Vec<u64>,
    /// How far curves and surfaces are from the body's.
    pub(super) certainty: Certainty,
    /// Surfaces that are approximated.
    pub(super) approximated: usize,
    /// The largest tolerance of an edge.
    pub(super) tolerance: f64,
}

struct Writer<'o, 'w, 'b> {
    out: &'o mut Out<'w>,
    body: &'b Body,
    tol: f64,
    vertices: Vec<Option<u64>>,
    edges: Vec<Option<u64>>,
    parts: Parts,
}

/// Writes a body: each closed shell as a solid, the others as sheets.
pub(super) fn body(
    out: &mut Out<'_>,
    body: &Body,
    name: &str,
    styles: &[FaceStyle],
    tol: f64,
) -> Result<Parts, WriteError> {
    let mut writer = Writer {
        out,
        body,
        tol,
        vertices: vec![None; body.vertices.len()],
        edges: vec![None; body.edges.len()],
        parts: Parts {
            roots: Vec::new(),
            faces: vec![0; body.faces.len()],
            certainty: Certainty::Exact,
            approximated: 0,
            tolerance: 0.0,
        },
    };
    for (i, face) in body.faces.iter().enumerate() {
        let name = styles.get(i).map_or("", |s| &s.name);
        writer.parts.faces[i] = writer.face(face, name)?;
    }
    let hollow = hollow(&body.shells);
    let ids: Result<Vec<u64>, WriteError> = body.shells.iter().map(|s| writer.shell(s)).collect();
    let ids = ids?;
    if hollow {
        let outer = ids[0];
        let mut voids = Vec::new();
        for id in &ids[1..] {
            let out = &mut writer.out;
            let oriented = out
                .open("ORIENTED_CLOSED_SHELL")
                .text("")
                .word("*")
                .reference(*id)
                .flag(false)
                .close()?;
            voids.push(oriented);
        }
        let out = &mut writer.out;
        let solid = out
            .open("BREP_WITH_VOIDS")
            .text(name)
            .reference(outer)
            .references(&voids)
            .close()?;
        writer.parts.roots.push((solid, true));
        return Ok(writer.parts);
    }
    let mut sheets = Vec::new();
    for (shell, id) in body.shells.iter().zip(ids) {
        let id = if is_turned(shell) {
            let keyword = if shell.closed {
                "ORIENTED_CLOSED_SHELL"
            } else {
                "ORIENTED_OPEN_SHELL"
            };
            writer
                .out
                .open(keyword)
                .text("")
                .word("*")
                .reference(id)
                .flag(false)
                .close()?
        } else {
            id
        };
        if shell.closed {
            let solid = writer
                .out
                .open("MANIFOLD_SOLID_BREP")
                .text(name)
                .reference(id)
                .close()?;
            writer.parts.roots.push((solid, true));
        } else {
            sheets.push(id);
        }
    }
    if !sheets.is_empty() {
        let out = &mut writer.out;
        let model = out
            .open("SHELL_BASED_SURFACE_MODEL")
            .text(name)
            .references(&sheets)
            .close()?;
        writer.parts.roots.push((model, false));
    }
    Ok(writer.parts)
}

/// Whether a shell takes all its faces the other way round.
fn is_turned(shell: &Shell) -> bool {
    shell.faces.iter().all(|f| !f.1)
}

/// Whether all shells but the first are turned inside out: the hollows of a solid.
fn hollow(shells: &[Shell]) -> bool {
    shells.len() > 1
        && shells.iter().all(|s| s.closed)
        && !is_turned(&shells[0])
        && shells[1..].iter().all(is_turned)
}

impl Writer<'_, '_, '_> {
    /// A shell, as its faces are if all are taken the other way round: the orientation is then left to what uses it.
    fn shell(&mut self, shell: &Shell) -> Result<u64, WriteError> {
        let turned = is_turned(shell);
        let mut faces = Vec::with_capacity(shell.faces.len());
        for (face, same) in &shell.faces {
            let id = self.parts.faces[*face];
            faces.push(if *same || turned {
                id
            } else {
                self.out
                    .open("ORIENTED_FACE")
                    .text("")
                    .word("*")
                    .reference(id)
                    .word(".F.")
                    .close()?
            });
        }
        let keyword = if shell.closed {
            "CLOSED_SHELL"
        } else {
            "OPEN_SHELL"
        };
        Ok(self.out.open(keyword).text("").references(&faces).close()?)
    }

    fn face(&mut self, face: &Face, name: &str) -> Result<u64, WriteError> {
        let surface = geometry::surface(self.out, face.surface.as_ref(), self.tol)?;
        if surface.certainty != Certainty::Exact {
            self.parts.approximated += 1;
        }
        self.parts.certainty = self.parts.certainty.and(surface.certainty);
        let mut bounds = Vec::new();
        for l in &face.loops {
            let id = match l {
                Loop::Vertex(v) => {
                    let vertex = self.vertex(*v)?;
                    self.out
                        .open("VERTEX_LOOP")
                        .text("")
                        .reference(vertex)
                        .close()?
                }
                Loop::Edges(coedges) => {
                    let ids: Result<Vec<u64>, WriteError> =
                        coedges.iter().map(|c| self.coedge(*c)).collect();
                    self.out
                        .open("EDGE_LOOP")
                        .text("")
                        .references(&ids?)
                        .close()?
                }
            };
            bounds.push(
                self.out
                    .open("FACE_BOUND")
                    .text("")
                    .reference(id)
                    .word(".T.")
                    .close()?,
            );
        }
        let same = face.forward == surface.same;
        let out = &mut self.out;
        let id = out
            .open("ADVANCED_FACE")
            .text(name)
            .references(&bounds)
            .reference(surface.id)
            .flag(same)
            .close()?;
        Ok(id)
    }

    fn coedge(&mut self, c: Coedge) -> Result<u64, WriteError> {
        let edge = self.edge(c.edge)?;
        let out = &mut self.out;
        Ok(out
            .open("ORIENTED_EDGE")
            .text("")
            .word("*")
            .word("*")
            .reference(edge)
            .flag(c.forward)
            .close()?)
    }

    fn edge(&mut self, i: usize) -> Result<u64, WriteError> {
        if let Some(id) = self.edges[i] {
            return Ok(id);
        }
        let edge = &self.body.edges[i];
        let ends = [
            self.vertex(edge.vertices[0])?,
            self.vertex(edge.vertices[1])?,
        ];
        let (curve, certainty) = geometry::curve(self.out, edge.curve.as_ref(), self.tol)?;
        self.parts.certainty = self.parts.certainty.and(certainty);
        self.parts.tolerance = self.parts.tolerance.max(edge.tolerance);
        let out = &mut self.out;
        let id = out
            .open("EDGE_CURVE")
            .text("")
            .reference(ends[0])
            .reference(ends[1])
            .reference(curve)
            .word(".T.")
            .close()?;
        self.edges[i] = Some(id);
        Ok(id)
    }

    fn vertex(&mut self, i: usize) -> Result<u64, WriteError> {
        if let Some(id) = self.vertices[i] {
            return Ok(id);
        }
        let point = self.out.point(self.body.vertices[i].point)?;
        let id = self
            .out
            .open("VERTEX_POINT")
            .text("")
            .reference(point)
            .close()?;
        self.vertices[i] = Some(id);
        Ok(id)
    }
}
