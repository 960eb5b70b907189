//! Splines for surfaces that have no exact form: with common curves along the edges that they share.

use super::WriteError;
use super::forms::shapeless;
use nappe::body::{Body, Edge, Loop};
use nappe::exact::{Converted, to_nurbs_together};
use nappe::mesh::Certainty;
use nappe::surface::{Dir, Surface, SurfaceRef};
use nappe::{Curve, Limit, NurbsCurve, NurbsSurface};

/// Sides nearer than this share of the tolerance are one, as where surfaces are sewn.
const JOINED: f64 = 0.05;
/// Places along a side where it is compared with an edge.
const PLACES: usize = 8;

/// The forms of some faces.
pub(super) struct Together {
    /// The faces and their forms.
    pub(super) forms: Vec<(usize, Converted<NurbsSurface>)>,
}

/// The faces that use an edge together with these, and these.
fn beside(body: &Body, faces: &[usize]) -> Vec<usize> {
    let edges = |face: usize| {
        let loops = body.faces[face].loops.iter();
        loops.flat_map(|l| match l {
            Loop::Edges(coedges) => coedges.as_slice(),
            Loop::Vertex(_) => &[],
        })
    };
    let mut bounds = vec![false; body.edges.len()];
    for face in faces {
        edges(*face).for_each(|c| bounds[c.edge] = true);
    }
    let near = |face: &usize| faces.contains(face) || edges(*face).any(|c| bounds[c.edge]);
    (0..body.faces.len()).filter(near).collect()
}

impl Together {
    /// The forms of faces of which each is without an exact one.
    pub(super) fn of(body: &Body, faces: &[usize], tol: f64) -> Result<Self, WriteError> {
        let all = beside(body, faces);
        let surfaces: Vec<SurfaceRef> =
            all.iter().map(|f| body.faces[*f].surface.clone()).collect();
        let weld = body.edges.iter().map(|e| e.tolerance);
        let weld = weld.fold(JOINED * tol, f64::max);
        let (forms, _) = to_nurbs_together(&surfaces, tol, weld).map_err(|(_, e)| shapeless(e))?;
        let forms = all.into_iter().zip(forms);
        let forms = forms.filter(|(f, _)| faces.contains(f)).collect();
        Ok(Together { forms })
    }

    /// The side of one of the forms that an edge is, and how far it may be from it.
    pub(super) fn side(&self, edge: &Edge) -> Option<(NurbsCurve, Certainty)> {
        self.forms.iter().find_map(|(_, form)| {
            let near = 2.0 * form.certainty.error() + edge.tolerance;
            let side = sides(&form.nurbs).find_map(|side| along(edge, side, near))?;
            Some((side, form.certainty))
        })
    }
}

fn sides(surface: &NurbsSurface) -> impl Iterator<Item = NurbsCurve> + '_ {
    [Dir::U, Dir::V].into_iter().flat_map(move |dir| {
        let across = match dir {
            Dir::U => Dir::V,
            Dir::V => Dir::U,
        };
        let range = surface.domain()[usize::from(across == Dir::V)];
        [(range.lo, Limit::Above), (range.hi, Limit::Below)]
            .into_iter()
            .map(move |(at, limit)| surface.isocurve(dir, at, limit))
    })
}

/// A side in the direction of an edge, if it is that within a length.
fn along(edge: &Edge, side: NurbsCurve, near: f64) -> Option<NurbsCurve> {
    let place = |curve: &dyn Curve, k: usize| {
        let d = curve.domain();
        curve.point(d.lo + d.width() * k as f64 / PLACES as f64)
    };
    let own = |k| place(edge.curve.as_ref(), k);
    let same = |back: bool| {
        (0..=PLACES).all(|k| {
            let at = if back { PLACES - k } else { k };
            own(k).distance(place(&side, at)) <= near
        })
    };
    if same(false) {
        return Some(side);
    }
    if same(true) {
        side.reversed().ok()
    } else {
        None
    }
}
