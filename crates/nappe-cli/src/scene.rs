//! What a model puts out, as the writers and the picture want it.

use crate::failure::Failure;
use crate::fault;
use crate::screen::Screen;
use nappe::exact::{ApproximationError, to_nurbs_or_approximate, to_nurbs_or_approximate_curve};
use nappe::measure::curvature;
use nappe::mesh::{Mesh, MeshOptions, MeshPatch, flatten, mesh};
use nappe::surface::{Normal, SurfaceRef, normal_at};
use nappe::{Interval, Limit};
use nappe_exchange::{Exact, ExactForm, Field, Part, Polyline, Scene};
use nappe_model::Model;
use std::ops::Range;
use std::sync::Arc;

/// The share of the box's diagonal that a mesh may be away from the surfaces if nothing else is said.
const DEFAULT_TOLERANCE: f64 = 1e-3;

/// The tolerance of a mesh: what is asked for, else the model's own, else a thousandth of the diagonal of its box.
pub(crate) fn tolerance(model: &Model, asked: Option<f64>) -> f64 {
    asked
        .or(model.tolerance)
        .unwrap_or_else(|| share_of_size(model, DEFAULT_TOLERANCE))
}

/// Steps in each direction at which a surface or a curve is measured for its size. More would be slower; fewer could
/// miss a bulge, and the picture or mesh be finer than was meant.
const STEPS: usize = 16;

/// A share of the diagonal of the box around everything that the model puts out; of 1 if nothing bounds it.
///
/// The box is that of samples: enclosures over whole domains may be many times too large.
pub(crate) fn share_of_size(model: &Model, share: f64) -> f64 {
    let at = |d: Interval, i: usize| d.lo + (d.hi - d.lo) * i as f64 / STEPS as f64;
    let mut points = Vec::new();
    for s in model.output() {
        let [u, v] = s.surface.domain();
        for i in 0..=STEPS {
            points.extend((0..=STEPS).map(|j| s.surface.point([at(u, i), at(v, j)])));
        }
    }
    for c in model.curves.iter().filter(|c| !c.construction_only) {
        let t = c.curve.domain();
        points.extend((0..=STEPS).map(|i| c.curve.point(at(t, i))));
    }
    let ends = points
        .into_iter()
        .map(|p| (p, p))
        .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let tolerance = share * ends.map_or(1.0, |(lo, hi)| (hi - lo).length());
    if tolerance > 0.0 && tolerance.is_finite() {
        tolerance
    } else {
        share
    }
}

/// The mesh of everything that the model puts out.
fn meshed(
    model: &Model,
    tolerance: f64,
    asked: Option<f64>,
    screen: &Screen,
) -> Result<Mesh, Failure> {
    let geometry: Vec<SurfaceRef> = model.output().map(|s| s.surface.clone()).collect();
    let progress = screen.progress("Meshing");
    let bar = progress.clone();
    let options = MeshOptions {
        tol: Some(tolerance),
        progress: Some(Arc::new(move |share| bar.tell(share))),
        ..MeshOptions::default()
    };
    let made = mesh(&geometry, &options);
    progress.finish();
    made.map_err(|e| fault::of_mesh(model, asked, &e))
}

/// The most points of a polyline: more are not seen, and would fill the memory.
const MOST_POINTS: usize = 1_000_000;

/// The curves that the model puts out, as polylines within the tolerance of the mesh.
fn polylines(model: &Model, tolerance: f64, asked: Option<f64>) -> Result<Vec<Polyline>, Failure> {
    let curves = model.curves.iter().filter(|c| !c.construction_only);
    let flat = curves.map(|c| {
        let flat = flatten(c.curve.as_ref(), tolerance, MOST_POINTS)
            .map_err(|e| fault::of_curve(model, asked, c, &e))?;
        Ok(Polyline {
            name: c.name.clone(),
            points: flat.points,
        })
    });
    flat.collect()
}

/// A scene with the model's title and units, empty.
pub(crate) fn unmeshed(model: &Model) -> Scene {
    Scene {
        title: Some(model.title.clone()),
        units: model.units,
        ..Scene::default()
    }
}

/// A scene of the mesh of everything that the model puts out, and of its curves. `asked` is the tolerance of the
/// command line, for messages about it.
pub(crate) fn scene(
    model: &Model,
    tolerance: f64,
    asked: Option<f64>,
    screen: &Screen,
) -> Result<Scene, Failure> {
    let names = model.output().map(|s| s.name.clone());
    Ok(Scene {
        mesh: meshed(model, tolerance, asked, screen)?,
        parts: names.enumerate().map(|(i, n)| Part::new(n, i)).collect(),
        curves: polylines(model, tolerance, asked)?,
        ..unmeshed(model)
    })
}

/// The NURBS forms of everything that the model puts out: exact where there is one, else within the tolerance.
pub(crate) fn exact(model: &Model, tolerance: f64) -> Result<Vec<Exact>, Failure> {
    let refused = |what: &str, name: &str, place: &Range<usize>, e: ApproximationError| {
        let message = format!("{what} `{name}` has no NURBS form: {e}");
        let help = "leave it out of a .json file with construction_only = true";
        fault::at(model, message, place, help)
    };
    let mut all = Vec::new();
    for c in model.curves.iter().filter(|c| !c.construction_only) {
        let form = to_nurbs_or_approximate_curve(c.curve.as_ref(), tolerance)
            .map_err(|e| refused("curve", &c.name, &c.place, e))?;
        all.push(Exact {
            name: c.name.clone(),
            kind: c.kind.to_owned(),
            form: ExactForm::Curve(form.nurbs),
            certainty: form.certainty,
        });
    }
    for s in model.output() {
        let form = to_nurbs_or_approximate(s.surface.as_ref(), tolerance)
            .map_err(|e| refused("surface", &s.name, &s.place, e))?;
        all.push(Exact {
            name: s.name.clone(),
            kind: s.kind.to_owned(),
            form: ExactForm::Surface(form.nurbs),
            certainty: form.certainty,
        });
    }
    Ok(all)
}

/// Which curvature of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bend {
    Gaussian,
    Mean,
}

/// A curvature at each vertex of a mesh of what the model puts out; at a pole the mean of its
/// neighbours, since the second derivatives there say nothing.
pub(crate) fn curvature_field(model: &Model, mesh: &Mesh, which: Bend) -> Field {
    let unit = model.units.symbol();
    let (name, unit) = match which {
        Bend::Gaussian => ("Gaussian curvature", format!("1/{unit}²")),
        Bend::Mean => ("Mean curvature", format!("1/{unit}")),
    };
    let values = model.output().zip(&mesh.patches).map(|(s, patch)| {
        let at = |uv| {
            let limit = [Limit::Above; 2];
            if !matches!(normal_at(s.surface.as_ref(), uv, limit), Normal::Regular(_)) {
                return f64::NAN;
            }
            curvature(&s.surface.jet(uv, limit, 2)).map_or(f64::NAN, |c| match which {
                Bend::Gaussian => c.gaussian,
                Bend::Mean => c.mean,
            })
        };
        let mut values: Vec<f64> = patch.vertices.iter().map(|v| at(v.uv)).collect();
        fill_poles(patch, &mut values);
        values
    });
    Field {
        name: name.to_owned(),
        unit,
        values: values.collect(),
    }
}

/// Gives vertices without a value the mean of those they share a triangle with.
fn fill_poles(patch: &MeshPatch, values: &mut [f64]) {
    let mut sums = vec![(0.0, 0usize); values.len()];
    for t in &patch.triangles {
        for (&at, &from) in t.iter().flat_map(|a| t.iter().map(move |b| (a, b))) {
            if values[at as usize].is_nan() && values[from as usize].is_finite() {
                let (sum, count) = &mut sums[at as usize];
                *sum += values[from as usize];
                *count += 1;
            }
        }
    }
    for (value, (sum, count)) in values.iter_mut().zip(sums) {
        if count > 0 {
            *value = sum / count as f64;
        }
    }
}
