//! Bodies of whole surfaces, as sewing makes them: they are meshed as these.

use super::mesh::{Lengths, Meshed};
use super::sew::sides;
use super::{Body, Face, Loop};
use crate::curve::CurveRef;
use crate::mesh::{MeshOptions, mesh};
use crate::surface::SurfaceRef;

/// Places where curves are compared.
const PLACES: usize = 8;

/// The mesh of a body whose faces are whole surfaces, with the edges and vertices that sewing them within the weld distance gives: so
/// the mesh of the surfaces joins the same sides. `None` for other bodies, and if the surfaces have no mesh.
///
/// Cost: little for others; the search for joints, and the mesh.
pub(super) fn whole(body: &Body, options: &MeshOptions, lengths: Lengths) -> Option<Meshed> {
    let few = |f: &Face| match &f.loops[..] {
        [] => true,
        [Loop::Edges(c)] => c.len() <= 4,
        _ => false,
    };
    if !body.faces.iter().all(few) || body.faces.is_empty() {
        return None;
    }
    let surfaces: Vec<SurfaceRef> = body.faces.iter().map(|f| f.surface.clone()).collect();
    if !is_same(body, &sides(&surfaces, lengths.weld)) {
        return None;
    }
    let options = MeshOptions {
        tol: Some(lengths.tol),
        least_cells: 1,
        ..options.clone()
    };
    let mut mesh = mesh(&surfaces, &options).ok()?;
    for (face, patch) in body.faces.iter().zip(&mut mesh.patches) {
        if !face.forward {
            patch.triangles.iter_mut().for_each(|t| t.swap(1, 2));
            patch.vertices.iter_mut().for_each(|v| v.normal = -v.normal);
        }
    }
    Some(Meshed {
        mesh,
        failed: Vec::new(),
        turned_round: Vec::new(),
    })
}

/// Whether two bodies of the same surfaces are the same, but for faces that are turned.
fn is_same(a: &Body, b: &Body) -> bool {
    let face = |f: &Face| {
        let mut f = f.clone();
        if !f.forward {
            f.turn();
        }
        f.loops
    };
    a.vertices == b.vertices
        && a.edges.len() == b.edges.len()
        && a.edges
            .iter()
            .zip(&b.edges)
            .all(|(a, b)| a.vertices == b.vertices && is_same_curve(&a.curve, &b.curve))
        && a.faces
            .iter()
            .zip(&b.faces)
            .all(|(a, b)| face(a) == face(b))
}

/// To the last bit: these are sides of the same surfaces, or they are not.
fn is_same_curve(a: &CurveRef, b: &CurveRef) -> bool {
    let domain = a.domain();
    let at = |k: usize| domain.lo + (domain.hi - domain.lo) * k as f64 / PLACES as f64;
    domain == b.domain() && (0..=PLACES).map(at).all(|t| a.point(t) == b.point(t))
}
