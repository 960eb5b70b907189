//! Bodies as entities.

use super::WriteError;
use super::forms::Forms;
use super::geometry;
use super::out::Out;
use crate::FaceStyle;
use crate::hollow::{is_hollow, is_turned};
use crate::report::Shares;
use glam::DVec3;
use nappe::body::{Body, Coedge, Face, Loop, Shell};
use nappe::mesh::Certainty;
use nappe::surface::Surface;

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

/// Places along a side where two sides are compared.
const SAMPLES: usize = 8;
/// Sides nearer to each other than this share of the surface are one.
const MEETING: f64 = 1e-6;

struct Writer<'o, 'w, 'b> {
    out: &'o mut Out<'w>,
    body: &'b Body,
    forms: Forms,
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
    forms: Forms,
    steps: &Shares<'_>,
) -> Result<Parts, WriteError> {
    let mut writer = Writer {
        out,
        body,
        forms,
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
        writer.parts.faces[i] = writer.face(i, face, name)?;
        steps.step();
    }
    let hollow = is_hollow(body);
    let ids: Result<Vec<u64>, WriteError> = body.shells.iter().map(|s| writer.shell(s)).collect();
    let ids = ids?;
    if hollow {
        let outer = ids[0];
        let mut voids = Vec::new();
        for (shell, id) in body.shells.iter().zip(&ids).skip(1) {
            let out = &mut writer.out;
            let oriented = out
                .open("ORIENTED_CLOSED_SHELL")
                .text("")
                .word("*")
                .reference(*id)
                .flag(!is_turned(shell))
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

/// Whether each two opposite sides of a surface are one curve or a point each, by samples.
fn is_closed(surface: &dyn Surface) -> bool {
    let domain = surface.domain();
    let at = |dir: usize, side: f64, along: usize| {
        let t = along as f64 / SAMPLES as f64;
        let mut uv = [0.0; 2];
        for (i, d) in domain.iter().enumerate() {
            let share = if i == dir { side } else { t };
            uv[i] = d.lo + (d.hi - d.lo) * share;
        }
        surface.point(uv)
    };
    let inside = (0..=SAMPLES).map(|i| at(0, i as f64 / SAMPLES as f64, SAMPLES / 2));
    let middle = at(0, 0.5, SAMPLES / 2);
    let size = inside.map(|p| p.distance(middle)).fold(0.0, f64::max);
    let same = |a: DVec3, b: DVec3| a.distance(b) <= MEETING * size;
    (0..2).all(|dir| {
        let all = || 0..=SAMPLES;
        let point = |side: f64| all().all(|i| same(at(dir, side, i), at(dir, side, 0)));
        all().all(|i| same(at(dir, 0.0, i), at(dir, 1.0, i))) || (point(0.0) && point(1.0))
    })
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

    fn vertex_loop(&mut self, vertex: u64) -> Result<u64, WriteError> {
        let out = self.out.open("VERTEX_LOOP").text("");
        Ok(out.reference(vertex).close()?)
    }

    fn bound(&mut self, of: u64) -> Result<u64, WriteError> {
        let out = self.out.open("FACE_BOUND").text("");
        Ok(out.reference(of).word(".T.").close()?)
    }

    fn face(&mut self, i: usize, face: &Face, name: &str) -> Result<u64, WriteError> {
        let form = self.forms.surface(i);
        if form.certainty != Certainty::Exact {
            self.parts.approximated += 1;
        }
        self.parts.certainty = self.parts.certainty.and(form.certainty);
        let surface = geometry::surface(self.out, form.shape)?;
        let mut bounds = Vec::new();
        if face.loops.is_empty() {
            let vertex = self.anywhere(face)?;
            let id = self.vertex_loop(vertex)?;
            bounds.push(self.bound(id)?);
        }
        for l in &face.loops {
            let id = match l {
                Loop::Vertex(v) => {
                    let vertex = self.vertex(*v)?;
                    self.vertex_loop(vertex)?
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
            bounds.push(self.bound(id)?);
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

    /// A vertex on a face that is a whole closed surface: the standard wants a bound of every face.
    fn anywhere(&mut self, face: &Face) -> Result<u64, WriteError> {
        if !is_closed(face.surface.as_ref()) {
            let why = "a face has no loops, but its surface has sides; give it a loop along them";
            return Err(WriteError::Shape(why.into()));
        }
        let [u, v] = face.surface.domain();
        let point = self.out.point(face.surface.point([u.lo, v.lo]))?;
        Ok(self
            .out
            .open("VERTEX_POINT")
            .text("")
            .reference(point)
            .close()?)
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
        let form = self.forms.curve(i);
        self.parts.certainty = self.parts.certainty.and(form.certainty);
        let curve = geometry::curve(self.out, form.shape, "")?;
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
