//! What the kernel refuses of a built model, shown at its place in the model file.

use crate::failure::Failure;
use crate::text::bound;
use nappe::mesh::{FlattenError, MeshError};
use nappe::surface::Dir;
use nappe_model::{Label, Model, NamedCurve, NamedSurface};
use std::ops::Range;

/// An error at one place of the file.
pub(crate) fn at(
    model: &Model,
    message: impl Into<String>,
    place: &Range<usize>,
    help: impl Into<String>,
) -> Failure {
    fault(model, message, vec![label(place, "here")], help)
}

fn fault(
    model: &Model,
    message: impl Into<String>,
    labels: Vec<Label>,
    help: impl Into<String>,
) -> Failure {
    Failure::Model(Box::new(model.fault("geometry", message, labels, help)))
}

fn label(place: &Range<usize>, text: impl Into<String>) -> Label {
    Label {
        span: place.clone(),
        text: text.into(),
    }
}

/// Why there is no mesh of these surfaces. `asked` is the tolerance of the command line: then the file is not to blame for it.
pub(crate) fn of_mesh(
    model: &Model,
    surfaces: &[&NamedSurface],
    asked: Option<f64>,
    e: &MeshError,
) -> Failure {
    let tolerance = Tolerance { model, asked };
    let on = |index: usize, message: String, help: &str| match surfaces.get(index) {
        Some(s) => at(
            model,
            format!("surface `{}` {message}", s.name),
            &s.place,
            help,
        ),
        None => fault(model, e.to_string(), Vec::new(), help),
    };
    match *e {
        MeshError::Tolerance { .. } => {
            tolerance.fault(e.to_string(), Vec::new(), "to a positive, finite length")
        }
        MeshError::TooFine { tol, smallest } => {
            // The rounding errors are those of the largest coordinates.
            let reach = |s: &NamedSurface| {
                let b = s.surface.bounds(s.surface.domain());
                b.to_array().iter().fold(0.0f64, |a, i| a.max(i.mag()))
            };
            let far = surfaces
                .iter()
                .map(|s| (reach(s), *s))
                .max_by(|a, b| a.0.total_cmp(&b.0));
            let smallest = bound(smallest, 3);
            let message = format!(
                "{} is {tol:e}, below the rounding errors of coordinates as large as these: the smallest possible is \
                 {smallest}",
                tolerance.name()
            );
            let labels = far
                .map(|(reach, s)| label(&s.place, format!("its coordinates reach {}", bound(reach, 3))))
                .into_iter()
                .collect();
            let help = format!("to at least {smallest}, or move the model nearer to the origin");
            tolerance.fault(message, labels, &help)
        }
        MeshError::TooMany { needed, max } => tolerance.fault(
            format!(
                "about {needed:.3e} triangles or more would be needed for {}; at most {max} are made",
                tolerance.name()
            ),
            Vec::new(),
            "; twice as much needs about half the triangles",
        ),
        MeshError::Weld { .. } => fault(model, e.to_string(), Vec::new(), "change the tolerance"),
        MeshError::NotFinite { surface, uv } => on(
            surface,
            format!("has no finite point at u = {}, v = {}", uv[0], uv[1]),
            "change what it is made of, so that it is finite there, or leave that part out",
        ),
        MeshError::Collapsed { surface, weld } => on(
            surface,
            format!("is collapsed: all of it lies on one point or line within {weld:e}"),
            "give points or curves that span a surface, or lower the tolerance",
        ),
        MeshError::Torn { surface, dir, at } => on(
            surface,
            format!("is torn at {} = {at}: it jumps there", name(dir)),
            "make two surfaces of it, or close the jump in the curves that it is made of",
        ),
        MeshError::Gap {
            surface,
            deviation,
            tol,
        } => on(
            surface,
            format!(
                "is {deviation:e} away from its mesh after its sides were joined to those of its neighbours; {tol:e} \
                 is allowed"
            ),
            "let it and its neighbours use the same curve along the shared side",
        ),
    }
}

/// Why there is no polyline of a curve.
pub(crate) fn of_curve(
    model: &Model,
    asked: Option<f64>,
    c: &NamedCurve,
    e: &FlattenError,
) -> Failure {
    let message = format!("curve `{}`: {e}", c.name);
    match e {
        FlattenError::NotFinite { .. } => at(
            model,
            message,
            &c.place,
            "change what it is made of, so that it is finite there, or leave that part out",
        ),
        FlattenError::Tolerance { .. } | FlattenError::TooMany { .. } => {
            let tolerance = Tolerance { model, asked };
            tolerance.fault(message, vec![label(&c.place, "this curve")], "")
        }
    }
}

fn name(dir: Dir) -> char {
    match dir {
        Dir::U => 'u',
        Dir::V => 'v',
    }
}

/// Where the tolerance comes from.
struct Tolerance<'a> {
    model: &'a Model,
    asked: Option<f64>,
}

impl Tolerance<'_> {
    fn name(&self) -> &'static str {
        match (self.asked, self.model.tolerance) {
            (Some(_), _) => "the tolerance (--tolerance on the command line)",
            (None, Some(_)) => "the tolerance",
            (None, None) => "the tolerance (none is given, so a share of the model's size)",
        }
    }

    /// An error of the tolerance: at its line, where it has one. The remedy goes on with `how`.
    fn fault(&self, message: String, more: Vec<Label>, how: &str) -> Failure {
        let mut labels = Vec::new();
        let help = match (self.asked, &self.model.tolerance_place) {
            (Some(_), _) => "raise --tolerance",
            (None, Some(place)) => {
                labels.push(label(place, "the tolerance"));
                "raise `tolerance`"
            }
            (None, None) => "raise it by a line `tolerance = …` or by --tolerance",
        };
        labels.extend(more);
        fault(
            self.model,
            message,
            labels,
            format!("{help} {how}").trim_end().replace(" ;", ";"),
        )
    }
}
