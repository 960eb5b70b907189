//! What curves and surfaces go out as, found on all cores before they are written.

use super::WriteError;
use super::conic::{Conic, conic};
use super::together::Together;
use crate::report::Shares;
use crate::{Item, ItemForm};
use glam::DVec3;
use nappe::body::{Body, Loop};
use nappe::exact::to_nurbs_or_approximate_curve;
use nappe::mesh::Certainty;
use nappe::parallel;
use nappe::surface::{Elementary, Surface, Swept};
use nappe::{Curve, Frame, NurbsCurve, NurbsSurface};

/// Distinct knots and how often each occurs.
pub(super) struct Knots {
    pub(super) times: Vec<usize>,
    pub(super) distinct: Vec<f64>,
}

/// A spline curve.
pub(super) struct SplineCurve {
    pub(super) degree: usize,
    pub(super) knots: Knots,
    pub(super) points: Vec<DVec3>,
    /// Of a rational curve.
    pub(super) weights: Option<Vec<f64>>,
    /// Whether it ends where it begins.
    pub(super) closed: bool,
}

/// A spline surface.
pub(super) struct SplineSurface {
    pub(super) degrees: [usize; 2],
    pub(super) knots: [Knots; 2],
    /// Points of a row, which runs along v.
    pub(super) columns: usize,
    pub(super) points: Vec<DVec3>,
    /// Of a rational surface.
    pub(super) weights: Option<Vec<f64>>,
    /// Whether its opposite sides are one, along u and along v.
    pub(super) closed: [bool; 2],
}

/// What a curve goes out as.
pub(super) enum CurveShape {
    Conic(Conic),
    Spline(SplineCurve),
}

/// What a surface goes out as.
pub(super) enum SurfaceShape {
    Elementary(Elementary),
    /// A curve turned about the axis of a frame. Whether the normal is that of the given surface, which the direction of the
    /// turn × that of the curve has.
    Turned {
        curve: SplineCurve,
        axis: Frame,
        same: bool,
    },
    /// A curve moved by a vector. The normal is the direction of the curve × the vector.
    Moved {
        curve: SplineCurve,
        along: DVec3,
        same: bool,
    },
    Spline(SplineSurface),
}

/// A shape and how far it is from what it stands for.
pub(super) struct Form<T> {
    pub(super) shape: T,
    pub(super) certainty: Certainty,
}

/// The forms of one item, each to be taken once.
#[derive(Default)]
pub(super) struct Forms {
    /// Of each face of a body.
    pub(super) surfaces: Vec<Option<Form<SurfaceShape>>>,
    /// Of each edge of a body that a loop uses, or of a curve.
    pub(super) curves: Vec<Option<Form<CurveShape>>>,
}

impl Forms {
    pub(super) fn surface(&mut self, face: usize) -> Form<SurfaceShape> {
        self.surfaces[face]
            .take()
            .expect("each face is written once")
    }

    pub(super) fn curve(&mut self, edge: usize) -> Form<CurveShape> {
        self.curves[edge].take().expect("each edge is written once")
    }
}

/// Something of an item.
#[derive(Clone, Copy)]
enum Part {
    Face(usize),
    Curve(usize),
}

enum Found {
    Surface(Option<Form<SurfaceShape>>),
    Curve(Option<Form<CurveShape>>),
}

/// The forms of some items, found on so many threads: exact ones where these exist, else within a tolerance. Errors: a body
/// that is not one, a shape without a form.
pub(super) fn forms(
    items: &[Item],
    tol: f64,
    threads: usize,
    steps: &Shares<'_>,
) -> Result<Vec<Forms>, WriteError> {
    let valid = |i: usize| match &items[i].form {
        ItemForm::Body { body, .. } => body
            .validate(f64::INFINITY)
            .map_err(|e| WriteError::Shape(format!("`{}`: {e}", items[i].name))),
        _ => Ok(()),
    };
    let valid = parallel::each(threads, items.len(), valid, Result::is_err);
    valid.into_iter().collect::<Result<(), WriteError>>()?;
    let mut all: Vec<Forms> = Vec::with_capacity(items.len());
    let mut parts: Vec<(usize, Part)> = Vec::new();
    for (i, item) in items.iter().enumerate() {
        let [faces, curves] = match &item.form {
            ItemForm::Body { body, .. } => {
                parts.extend((0..body.faces.len()).map(|f| (i, Part::Face(f))));
                parts.extend(used(body).map(|e| (i, Part::Curve(e))));
                [body.faces.len(), body.edges.len()]
            }
            ItemForm::Curve(_) => {
                parts.push((i, Part::Curve(0)));
                [0, 1]
            }
            ItemForm::Points(_) => [0; 2],
        };
        all.push(Forms {
            surfaces: (0..faces).map(|_| None).collect(),
            curves: (0..curves).map(|_| None).collect(),
        });
    }
    let find = |k: usize| -> Result<Found, WriteError> {
        let (item, part) = parts[k];
        let found = match part {
            Part::Face(f) => match &items[item].form {
                ItemForm::Body { body, .. } => {
                    Found::Surface(exact(body.faces[f].surface.as_ref())?)
                }
                _ => Found::Surface(None),
            },
            Part::Curve(e) => {
                Found::Curve(curve_of(&items[item], e).map_or(Ok(None), exact_curve)?)
            }
        };
        steps.step();
        Ok(found)
    };
    let found = parallel::each(threads, parts.len(), find, Result::is_err);
    // What has no exact form: faces of each item, and edges and curves.
    let mut faces: Vec<Vec<usize>> = vec![Vec::new(); items.len()];
    let mut curves = Vec::new();
    for ((item, part), found) in parts.iter().zip(found) {
        match (found?, part) {
            (Found::Surface(None), Part::Face(i)) => faces[*item].push(*i),
            (Found::Surface(form), Part::Face(i)) => all[*item].surfaces[*i] = form,
            (Found::Curve(None), Part::Curve(i)) => curves.push((*item, *i)),
            (Found::Curve(form), Part::Curve(i)) => all[*item].curves[*i] = form,
            _ => unreachable!("faces have surfaces, edges curves"),
        }
    }
    let mut together: Vec<Option<Together>> = Vec::with_capacity(items.len());
    for (item, faces) in items.iter().zip(&faces) {
        together.push(match &item.form {
            ItemForm::Body { body, .. } if !faces.is_empty() => {
                Some(Together::of(body, faces, tol)?)
            }
            _ => None,
        });
    }
    let find = |k: usize| {
        let (item, i) = curves[k];
        let edge = match &items[item].form {
            ItemForm::Body { body, .. } => body.edges.get(i),
            _ => None,
        };
        // The surface's own side, so that the edge lies on it.
        let side = edge.zip(together[item].as_ref());
        let form = match side.and_then(|(e, t)| t.side(e)) {
            Some((nurbs, certainty)) => Some((nurbs, certainty)),
            None => curve_of(&items[item], i)
                .map(|c| to_nurbs_or_approximate_curve(c, tol).map_err(shapeless))
                .transpose()?
                .map(|form| (form.nurbs, form.certainty)),
        };
        form.map(|(nurbs, certainty)| curve_form(nurbs, certainty))
            .transpose()
    };
    let found = parallel::each(threads, curves.len(), find, Result::is_err);
    for ((item, i), found) in curves.iter().zip(found) {
        all[*item].curves[*i] = found?;
    }
    for (all, together) in all.iter_mut().zip(together) {
        for (face, form) in together.into_iter().flat_map(|t| t.forms) {
            let shape = SurfaceShape::Spline(spline_surface(form.nurbs)?);
            let certainty = form.certainty;
            all.surfaces[face] = Some(Form { shape, certainty });
        }
    }
    Ok(all)
}

/// An item's curve: an edge of a body or itself.
fn curve_of(item: &Item, i: usize) -> Option<&dyn Curve> {
    match &item.form {
        ItemForm::Body { body, .. } => body.edges.get(i).map(|e| e.curve.as_ref()),
        ItemForm::Curve(c) => Some(c.as_ref()),
        ItemForm::Points(_) => None,
    }
}

/// The edges that loops use, once each.
fn used(body: &Body) -> impl Iterator<Item = usize> + use<> {
    let mut used = vec![false; body.edges.len()];
    for l in body.faces.iter().flat_map(|f| &f.loops) {
        if let Loop::Edges(coedges) = l {
            coedges.iter().for_each(|c| used[c.edge] = true);
        }
    }
    let edges = used.into_iter().enumerate();
    edges.filter_map(|(e, used)| used.then_some(e))
}

pub(super) fn shapeless(e: impl ToString) -> WriteError {
    WriteError::Shape(e.to_string())
}

/// A curve as a part of a line or ellipse, else as a spline.
fn curve_form(nurbs: NurbsCurve, certainty: Certainty) -> Result<Form<CurveShape>, WriteError> {
    let shape = match conic(&nurbs) {
        Some(conic) => CurveShape::Conic(conic),
        None => CurveShape::Spline(spline_curve(nurbs)?),
    };
    Ok(Form { shape, certainty })
}

fn exact_curve(curve: &dyn Curve) -> Result<Option<Form<CurveShape>>, WriteError> {
    let nurbs = curve.to_nurbs().or_else(|| curve.to_rational());
    nurbs.map(|n| curve_form(n, Certainty::Exact)).transpose()
}

/// A surface as what it is in elementary geometry, else as the curve that sweeps it, else as a spline, if it is one of these.
fn exact(surface: &dyn Surface) -> Result<Option<Form<SurfaceShape>>, WriteError> {
    let shape = if let Some(e) = surface.elementary() {
        Some(SurfaceShape::Elementary(e))
    } else if let Some(s) = surface.swept() {
        Some(swept(s)?)
    } else {
        let nurbs = surface.to_nurbs().or_else(|| surface.to_rational());
        let spline = nurbs.map(spline_surface).transpose()?;
        spline.map(SurfaceShape::Spline)
    };
    let certainty = Certainty::Exact;
    Ok(shape.map(|shape| Form { shape, certainty }))
}

/// Swept curves go out as splines, which end where they do: whole ellipses could cross the axis of a turn.
fn swept(swept: Swept) -> Result<SurfaceShape, WriteError> {
    Ok(match swept {
        Swept::Turned {
            curve, axis, same, ..
        } => SurfaceShape::Turned {
            curve: spline_curve(curve)?,
            axis,
            same: !same,
        },
        Swept::Moved { curve, along, same } => SurfaceShape::Moved {
            curve: spline_curve(curve)?,
            along,
            same,
        },
    })
}

fn knots(all: &[f64]) -> Knots {
    let (mut times, mut distinct): (Vec<usize>, Vec<f64>) = (Vec::new(), Vec::new());
    for k in all {
        match (times.last_mut(), distinct.last()) {
            (Some(n), Some(last)) if last == k => *n += 1,
            _ => {
                times.push(1);
                distinct.push(*k);
            }
        }
    }
    Knots { times, distinct }
}

fn spline_curve(n: NurbsCurve) -> Result<SplineCurve, WriteError> {
    let n = if n.basis().is_clamped() {
        n
    } else {
        n.clamped().map_err(shapeless)?
    };
    let [first, last] = n.ends();
    Ok(SplineCurve {
        degree: n.degree(),
        knots: knots(n.knots()),
        points: n.control_points(),
        weights: n.is_rational().then(|| n.weights()),
        closed: first == last,
    })
}

fn spline_surface(n: NurbsSurface) -> Result<SplineSurface, WriteError> {
    let clamped = n.basis_u().is_clamped() && n.basis_v().is_clamped();
    let n = if clamped {
        n
    } else {
        n.clamped().map_err(shapeless)?
    };
    let [rows, columns] = n.size();
    let points = n.homogeneous();
    let same = |a: usize, b: usize| points[a] == points[b];
    Ok(SplineSurface {
        degrees: [n.basis_u().degree(), n.basis_v().degree()],
        knots: [knots(n.basis_u().knots()), knots(n.basis_v().knots())],
        columns,
        points: n.control_points(),
        weights: n.is_rational().then(|| n.weights()),
        closed: [
            (0..columns).all(|j| same(j, (rows - 1) * columns + j)),
            (0..rows).all(|i| same(i * columns, i * columns + columns - 1)),
        ],
    })
}
