//! What curves and surfaces go out as, found on all cores before they are written.

use super::WriteError;
use super::conic::{Conic, conic};
use crate::report::Shares;
use crate::{Item, ItemForm};
use glam::DVec3;
use nappe::body::{Body, Loop};
use nappe::exact::{to_nurbs_or_approximate, to_nurbs_or_approximate_curve};
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
    Surface(Form<SurfaceShape>),
    Curve(Form<CurveShape>),
}

/// The forms of some items, found on so many threads. Errors: a body that is not one, a shape without a form.
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
    let find = |k: usize| {
        let (item, part) = parts[k];
        let found = match (&items[item].form, part) {
            (ItemForm::Body { body, .. }, Part::Face(f)) => {
                Found::Surface(surface(body.faces[f].surface.as_ref(), tol)?)
            }
            (ItemForm::Body { body, .. }, Part::Curve(e)) => {
                Found::Curve(curve(body.edges[e].curve.as_ref(), tol)?)
            }
            (ItemForm::Curve(c), _) => Found::Curve(curve(c.as_ref(), tol)?),
            (ItemForm::Points(_), _) => unreachable!("points have no parts"),
        };
        steps.step();
        Ok(found)
    };
    let found: Vec<Result<Found, WriteError>> =
        parallel::each(threads, parts.len(), find, Result::is_err);
    for ((item, part), found) in parts.iter().zip(found) {
        match (found?, part) {
            (Found::Surface(form), Part::Face(i)) => all[*item].surfaces[*i] = Some(form),
            (Found::Curve(form), Part::Curve(i)) => all[*item].curves[*i] = Some(form),
            _ => unreachable!("faces have surfaces, edges curves"),
        }
    }
    Ok(all)
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

fn shapeless(e: impl ToString) -> WriteError {
    WriteError::Shape(e.to_string())
}

/// A curve as a part of a line or ellipse, else as a spline.
fn curve(curve: &dyn Curve, tol: f64) -> Result<Form<CurveShape>, WriteError> {
    let form = to_nurbs_or_approximate_curve(curve, tol).map_err(shapeless)?;
    let shape = match conic(&form.nurbs) {
        Some(conic) => CurveShape::Conic(conic),
        None => CurveShape::Spline(spline_curve(form.nurbs)?),
    };
    let certainty = form.certainty;
    Ok(Form { shape, certainty })
}

/// A surface as what it is in elementary geometry, else as the curve that sweeps it, else as a spline.
fn surface(surface: &dyn Surface, tol: f64) -> Result<Form<SurfaceShape>, WriteError> {
    let exact = match surface.elementary() {
        Some(e) => Some(SurfaceShape::Elementary(e)),
        None => surface.swept().map(swept).transpose()?,
    };
    if let Some(shape) = exact {
        let certainty = Certainty::Exact;
        return Ok(Form { shape, certainty });
    }
    let form = to_nurbs_or_approximate(surface, tol).map_err(shapeless)?;
    let shape = SurfaceShape::Spline(spline_surface(form.nurbs)?);
    let certainty = form.certainty;
    Ok(Form { shape, certainty })
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
