//! What a model puts out, as the writers and the picture want it.

use crate::failure::Failure;
use crate::fault;
use crate::screen::Screen;
use crate::slits::JOINED;
use crate::text::bound;
use nappe::body::sew;
use nappe::exact::{
    ApproximationError, SharedSide, to_nurbs_or_approximate_curve, to_nurbs_together,
};
use nappe::measure::{Curvature, curvature, unbounded_curvature};
use nappe::mesh::{Certainty, Mesh, MeshError, MeshOptions, MeshPatch, flatten, mesh};
use nappe::surface::{Normal, SurfaceRef, normal_at};
use nappe::{DVec3, Interval, Limit};
use nappe_exchange::{
    Document, Exact, ExactForm, FaceStyle, Field, Item, ItemForm, Part, Polyline, Scene,
};
use nappe_model::{Model, NamedSurface};
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
    let curves = model.curves.iter().filter(|c| !c.construction_only);
    let on_curves =
        curves.flat_map(|c| (0..=STEPS).map(|i| c.curve.point(step(c.curve.domain(), i))));
    let ends = around(model.output().flat_map(samples).chain(on_curves));
    let tolerance = share * ends.map_or(1.0, |(lo, hi)| (hi - lo).length());
    if tolerance > 0.0 && tolerance.is_finite() {
        tolerance
    } else {
        share
    }
}

fn step(d: Interval, i: usize) -> f64 {
    d.lo + (d.hi - d.lo) * i as f64 / STEPS as f64
}

/// Points all over a surface.
fn samples(s: &NamedSurface) -> impl Iterator<Item = DVec3> + '_ {
    let [u, v] = s.surface.domain();
    let row = move |i| (0..=STEPS).map(move |j| s.surface.point([step(u, i), step(v, j)]));
    (0..=STEPS).flat_map(row)
}

/// The least and greatest corner of the box around points.
fn around(points: impl Iterator<Item = DVec3>) -> Option<(DVec3, DVec3)> {
    points
        .map(|p| (p, p))
        .reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)))
}

/// How finely surfaces are meshed.
#[derive(Clone, Copy)]
pub(crate) struct Detail {
    pub(crate) tolerance: f64,
    /// The fewest cells along each direction, see [`MeshOptions::least_cells`].
    pub(crate) least_cells: usize,
}

/// The mesh of surfaces.
fn meshed(geometry: &[SurfaceRef], detail: Detail, screen: &Screen) -> Result<Mesh, MeshError> {
    let progress = screen.progress("Meshing");
    let bar = progress.clone();
    let options = MeshOptions {
        tol: Some(detail.tolerance),
        least_cells: detail.least_cells,
        progress: Some(Arc::new(move |share| bar.tell(share))),
        ..MeshOptions::default()
    };
    let made = mesh(geometry, &options);
    progress.finish();
    made
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
    detail: Detail,
    asked: Option<f64>,
    screen: &Screen,
) -> Result<Scene, Failure> {
    let named: Vec<&NamedSurface> = model.output().collect();
    let geometry: Vec<SurfaceRef> = named.iter().map(|s| s.surface.clone()).collect();
    let mesh =
        meshed(&geometry, detail, screen).map_err(|e| fault::of_mesh(model, &named, asked, &e))?;
    let names = named.iter().map(|s| s.name.clone());
    Ok(Scene {
        mesh,
        parts: names.enumerate().map(|(i, n)| Part::new(n, i)).collect(),
        curves: polylines(model, detail.tolerance, asked)?,
        ..unmeshed(model)
    })
}

/// What the model puts out as exact shapes: all surfaces sewn to one body, and the curves. Sides are one if the mesh would
/// join them.
pub(crate) fn document(model: &Model, tolerance: f64) -> Document {
    let named: Vec<&NamedSurface> = model.output().collect();
    let surfaces: Vec<SurfaceRef> = named.iter().map(|s| s.surface.clone()).collect();
    let mut items = Vec::new();
    if !surfaces.is_empty() {
        let sewn = sew(&surfaces, JOINED * tolerance);
        let face = |s: &&NamedSurface| FaceStyle {
            name: s.name.clone(),
            colour: None,
        };
        items.push(Item {
            name: model.title.clone(),
            colour: None,
            form: ItemForm::Body {
                body: sewn.body,
                faces: named.iter().map(face).collect(),
            },
        });
    }
    let curves = model.curves.iter().filter(|c| !c.construction_only);
    items.extend(curves.map(|c| Item {
        name: c.name.clone(),
        colour: None,
        form: ItemForm::Curve(c.curve.clone()),
    }));
    Document {
        name: Some(model.title.clone()),
        units: model.units,
        items,
        ..Document::default()
    }
}

/// A scene for a picture, whose mesh has a tolerance far below a pixel: surfaces so small that the mesh takes them for one
/// point or line are left out, as long as others remain; and the names of these. They have an empty patch.
pub(crate) fn visible(
    model: &Model,
    detail: Detail,
    screen: &Screen,
) -> Result<(Scene, Vec<String>), Failure> {
    let tolerance = detail.tolerance;
    let named: Vec<&NamedSurface> = model.output().collect();
    let is_large = |i: &usize| {
        let ends = around(samples(named[*i]));
        ends.is_none_or(|(lo, hi)| (hi - lo).length() > JOINED * tolerance)
    };
    let mut shown: Vec<usize> = (0..named.len()).filter(is_large).collect();
    if shown.is_empty() {
        // Let the mesh say what is wrong.
        shown = (0..named.len()).collect();
    }
    let mut mesh = loop {
        let geometry: Vec<SurfaceRef> = shown.iter().map(|&i| named[i].surface.clone()).collect();
        match meshed(&geometry, detail, screen) {
            Ok(mesh) => break mesh,
            // Thin ones, of which there are few.
            Err(MeshError::Collapsed { surface, .. }) if shown.len() > 1 => {
                shown.remove(surface);
            }
            Err(e) => {
                let shown: Vec<&NamedSurface> = shown.iter().map(|&i| named[i]).collect();
                return Err(fault::of_mesh(model, &shown, None, &e));
            }
        }
    };
    let is_shown = |i: usize| shown.binary_search(&i).is_ok();
    let mut patches = mesh.patches.into_iter();
    mesh.patches = (0..named.len())
        .map(|i| {
            let drawn = is_shown(i).then(|| patches.next()).flatten();
            drawn.unwrap_or(MeshPatch {
                vertices: Vec::new(),
                triangles: Vec::new(),
                deviation: Certainty::Exact,
            })
        })
        .collect();
    let name = |i: usize| named[i].name.clone();
    let left_out = (0..named.len()).filter(|&i| !is_shown(i));
    let left_out = left_out.map(name).collect();
    let scene = Scene {
        mesh,
        parts: shown.iter().map(|&i| Part::new(name(i), i)).collect(),
        curves: polylines(model, tolerance, None)?,
        ..unmeshed(model)
    };
    Ok((scene, left_out))
}

/// The NURBS forms of everything that the model puts out: exact where there is one, else within the tolerance, with common
/// curves where surfaces share sides; and a note where that was not possible.
pub(crate) fn exact(
    model: &Model,
    tolerance: f64,
) -> Result<(Vec<Exact>, Option<String>), Failure> {
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
            same_parameters: form.same_parameters,
        });
    }
    let named: Vec<&NamedSurface> = model.output().collect();
    let surfaces: Vec<SurfaceRef> = named.iter().map(|s| s.surface.clone()).collect();
    let (forms, shared) = to_nurbs_together(&surfaces, tolerance, JOINED * tolerance)
        .map_err(|(i, e)| refused("surface", &named[i].name, &named[i].place, e))?;
    for (s, form) in named.iter().zip(forms) {
        all.push(Exact {
            name: s.name.clone(),
            kind: s.kind.to_owned(),
            form: ExactForm::Surface(form.nurbs),
            certainty: form.certainty,
            same_parameters: form.same_parameters,
        });
    }
    Ok((all, apart(model, &named, &shared, tolerance)))
}

/// Gaps below this part of the tolerance are rounding.
const NO_GAP: f64 = 1e-6;

/// Where the forms of surfaces that share sides are apart, in words.
fn apart(
    model: &Model,
    named: &[&NamedSurface],
    shared: &[SharedSide],
    tolerance: f64,
) -> Option<String> {
    let gaps = shared.iter().filter(|s| s.gap.error() > NO_GAP * tolerance);
    let greatest = gaps
        .clone()
        .max_by(|a, b| a.gap.error().total_cmp(&b.gap.error()))?;
    let [a, b] = greatest
        .sides
        .map(|(i, side)| format!("{}.{side}", named[i].name));
    let proven = match greatest.gap {
        Certainty::Estimated(_) => "estimated",
        _ => "proven",
    };
    let more = match gaps.count() {
        1 => String::new(),
        n => format!(", and less along {} more", n - 1),
    };
    Some(format!(
        "note: the NURBS forms of {a} and {b} are at most {} {} apart ({proven}){more}: at least one is approximated, and could \
         not take the curve of the other within the tolerance\n  help: let both sides run at the same parameters, or set a \
         smaller tolerance",
        bound(greatest.gap.error(), 2),
        model.units.symbol()
    ))
}

/// Which curvature of a surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bend {
    Gaussian,
    Mean,
}

/// Curvatures below this share of the greater one, or of one over the size of the model, are rounding: a surface that bends
/// in one direction only has no Gaussian curvature.
const ROUNDING: f64 = 1e-9;

/// A curvature at each vertex of a mesh of what the model puts out; at a pole the mean of its
/// neighbours, since the second derivatives there say nothing.
pub(crate) fn curvature_field(model: &Model, mesh: &Mesh, which: Bend) -> Field {
    let unit = model.units.symbol();
    let (name, unit) = match which {
        Bend::Gaussian => ("Gaussian curvature", format!("1/{unit}²")),
        Bend::Mean => ("Mean curvature", format!("1/{unit}")),
    };
    let size = around(mesh.points.iter().copied()).map_or(0.0, |(lo, hi)| (hi - lo).length());
    let value = |c: Curvature| {
        let greater = c.k1.abs().max(c.k2.abs()).max(1.0 / size);
        let [k1, k2] = [c.k1, c.k2].map(|k| if k.abs() > ROUNDING * greater { k } else { 0.0 });
        match which {
            Bend::Gaussian if k1 == 0.0 || k2 == 0.0 => 0.0,
            Bend::Gaussian => c.gaussian,
            Bend::Mean if k1 == 0.0 && k2 == 0.0 => 0.0,
            Bend::Mean => c.mean,
        }
    };
    let values = model.output().zip(&mesh.patches).map(|(s, patch)| {
        let at = |uv| {
            let limit = [Limit::Above; 2];
            if !matches!(normal_at(s.surface.as_ref(), uv, limit), Normal::Regular(_)) {
                return f64::NAN;
            }
            curvature(&s.surface.jet(uv, limit, 2)).map_or(f64::NAN, value)
        };
        let mut values: Vec<f64> = patch.vertices.iter().map(|v| at(v.uv)).collect();
        fill_poles(patch, &mut values);
        values
    });
    let values = values.collect();
    let mut unbounded = [false; 2];
    for (s, _) in model
        .output()
        .zip(&mesh.patches)
        .filter(|(_, p)| !p.triangles.is_empty())
    {
        let found = unbounded_curvature(s.surface.as_ref());
        let found = match which {
            Bend::Gaussian => found.gaussian,
            Bend::Mean => found.mean,
        };
        unbounded = [0, 1].map(|k| unbounded[k] || found[k]);
    }
    Field {
        name: name.to_owned(),
        unit,
        values,
        unbounded,
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
