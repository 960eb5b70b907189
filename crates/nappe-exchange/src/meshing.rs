//! Exact geometry as triangles: a document becomes a scene.

use crate::document::{Document, FaceStyle, Item, ItemForm};
use crate::report::Progress;
use crate::scene::{PALETTE, Part, Polyline, Scene};
use nappe::body::{self, Body, Meshed};
use nappe::mesh::{Mesh, MeshOptions, MeshPatch, flatten};
use nappe::{Box3, DVec3};

/// The triangles of a document, and what has none.
#[derive(Clone, Debug, Default)]
pub struct DocumentMesh {
    /// A part for each face that has triangles, in the order of the file, and a polyline for each curve.
    pub scene: Scene,
    /// The distance that triangles and surfaces were to keep, in the document's unit.
    pub tolerance: f64,
    /// The number of bodies.
    pub bodies: usize,
    /// The number of their faces, with those that have no triangles.
    pub faces: usize,
    /// Faces and curves that are not in the scene.
    pub missing: Vec<Missing>,
    /// Faces of which loops run the wrong way round, and were turned to bound anything: [`face_place`] of each.
    pub turned_round: Vec<String>,
    /// The number of single points, for which a scene has no place.
    pub points: usize,
}

/// A face or curve without triangles or lines.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Missing {
    /// Which, see [`face_place`].
    pub place: String,
    /// Why.
    pub why: String,
}

/// The share of the box's diagonal that triangles may be away from the surfaces if nothing else is said.
const DEFAULT_TOLERANCE: f64 = 1e-3;
/// Points at which a curve is looked at for its size.
const STEPS: usize = 16;
/// The most points of a polyline: more are not seen, and would fill the memory.
const MOST_POINTS: usize = 1_000_000;

/// Triangles of all bodies, see [`body::mesh`], and polylines of all curves, within `tolerance` (a length in the document's
/// unit; `None`: a thousandth of the diagonal of the document's box). Each body is watertight along the edges that its faces
/// share; bodies share nothing with each other.
///
/// Parts have the names of [`face_name`] and the colour of their face, else of their item, else one of [`PALETTE`] for each
/// item. Where the surface has no normal, that of the triangles around is taken.
///
/// Nothing is dropped in silence: what has no triangles is in [`DocumentMesh::missing`] with its reason.
pub fn mesh_document(
    document: &Document,
    tolerance: Option<f64>,
    progress: Progress<'_>,
) -> DocumentMesh {
    let tolerance = tolerance.unwrap_or_else(|| default_tolerance(document));
    let mut out = DocumentMesh {
        scene: Scene {
            title: document.name.clone(),
            units: document.units,
            ..Scene::default()
        },
        tolerance,
        ..DocumentMesh::default()
    };
    for (number, item) in document.items.iter().enumerate() {
        match &item.form {
            ItemForm::Body { body, faces } => {
                out.bodies += 1;
                out.faces += body.faces.len();
                out.body(number, item, body, faces);
            }
            ItemForm::Curve(curve) => match flatten(curve.as_ref(), tolerance, MOST_POINTS) {
                Ok(flat) => out.scene.curves.push(Polyline {
                    name: item_name(number, item),
                    points: flat.points,
                }),
                Err(e) => out.missing.push(Missing {
                    place: item_place(number, item),
                    why: e.to_string(),
                }),
            },
            ItemForm::Points(points) => out.points += points.len(),
        }
        progress.tell((number + 1) as f64 / document.items.len() as f64);
    }
    out
}

impl DocumentMesh {
    fn body(&mut self, number: usize, item: &Item, body: &Body, faces: &[FaceStyle]) {
        let mut miss = |face: usize, why: String| {
            let place = face_place(number, item, face);
            self.missing.push(Missing { place, why });
        };
        let made = match body::mesh(body, &MeshOptions::with_tol(self.tolerance)) {
            Ok(made) if room(&self.scene.mesh, &made) => made,
            Ok(_) => {
                let why = "with it the mesh has more points than 32 bits number";
                (0..body.faces.len()).for_each(|f| miss(f, why.to_owned()));
                return;
            }
            Err(e) => {
                (0..body.faces.len()).for_each(|f| miss(f, e.to_string()));
                return;
            }
        };
        made.failed
            .iter()
            .for_each(|(f, e)| miss(*f, e.to_string()));
        let turned = made.turned_round.iter();
        self.turned_round
            .extend(turned.map(|&f| face_place(number, item, f)));
        let mesh = &mut self.scene.mesh;
        let first = mesh.points.len() as u32;
        mesh.points.extend(made.mesh.points);
        for (face, mut patch) in made.mesh.patches.into_iter().enumerate() {
            for v in &mut patch.vertices {
                v.point += first;
            }
            let mut shells = body.shells.iter().flat_map(|s| &s.faces);
            if shells.find(|s| s.0 == face).is_some_and(|s| !s.1) {
                // The shell takes the face the other way round.
                patch.triangles.iter_mut().for_each(|t| t.swap(1, 2));
                patch.vertices.iter_mut().for_each(|v| v.normal = -v.normal);
            }
            fill_normals(&mesh.points, &mut patch);
            if patch.triangles.is_empty() {
                if !made.failed.iter().any(|(f, _)| *f == face) {
                    let place = face_place(number, item, face);
                    let why = "none of its triangles has an area".to_owned();
                    self.missing.push(Missing { place, why });
                }
                continue;
            }
            let own = faces.get(face).and_then(|f| f.colour);
            self.scene.parts.push(Part {
                name: face_name(number, item, face),
                colour: own
                    .or(item.colour)
                    .unwrap_or(PALETTE[number % PALETTE.len()]),
                patch: mesh.patches.len(),
            });
            mesh.patches.push(patch);
        }
    }
}

/// Whether another mesh can be added.
fn room(mesh: &Mesh, more: &Meshed) -> bool {
    u32::try_from(mesh.points.len() + more.mesh.points.len()).is_ok()
}

/// Gives vertices without a normal that of the triangles around them.
fn fill_normals(points: &[DVec3], patch: &mut MeshPatch) {
    if patch.vertices.iter().all(|v| v.normal != DVec3::ZERO) {
        return;
    }
    let mut sums = vec![DVec3::ZERO; patch.vertices.len()];
    for t in &patch.triangles {
        let [a, b, c] = t.map(|k| points[patch.vertices[k as usize].point as usize]);
        let area = (b - a).cross(c - a);
        t.iter().for_each(|&k| sums[k as usize] += area);
    }
    for (v, sum) in patch.vertices.iter_mut().zip(sums) {
        if v.normal == DVec3::ZERO {
            v.normal = sum.try_normalize().unwrap_or(DVec3::Z);
        }
    }
}

/// The name of an item, or `item 3`, counted from 1.
pub fn item_name(number: usize, item: &Item) -> String {
    if item.name.is_empty() {
        format!("item {}", number + 1)
    } else {
        item.name.clone()
    }
}

/// The name of a face: that of its item if it is the only one, else `item/face` with its own name or number from 1.
pub fn face_name(number: usize, item: &Item, face: usize) -> String {
    let ItemForm::Body { body, faces } = &item.form else {
        return item_name(number, item);
    };
    match faces.get(face).map(|f| f.name.as_str()) {
        Some(own) if !own.is_empty() && item.name.is_empty() => own.to_owned(),
        Some(own) if !own.is_empty() => format!("{}/{own}", item.name),
        _ if body.faces.len() == 1 => item_name(number, item),
        _ => format!("{}/{}", item_name(number, item), face + 1),
    }
}

/// An item in words, with its number and its name: ``item 3 `bolt` ``.
pub fn item_place(number: usize, item: &Item) -> String {
    let number = number + 1;
    match item.name.as_str() {
        "" => format!("item {number}"),
        name => format!("item {number} `{name}`"),
    }
}

/// A face in words, with its number and its name: ``face 2 `rim` of item 3 `bolt` ``. All are counted from 1.
pub fn face_place(number: usize, item: &Item, face: usize) -> String {
    let own = match &item.form {
        ItemForm::Body { faces, .. } => faces.get(face).map_or("", |f| f.name.as_str()),
        _ => "",
    };
    let of = item_place(number, item);
    match own {
        "" => format!("face {} of {of}", face + 1),
        name => format!("face {} `{name}` of {of}", face + 1),
    }
}

/// A thousandth of the diagonal of the box around everything; of 1 if nothing has a size.
fn default_tolerance(document: &Document) -> f64 {
    let hull = |item: &Item| match &item.form {
        ItemForm::Body { body, .. } => Some(body::extent(body)),
        ItemForm::Curve(c) => {
            let d = c.domain();
            let at = |i| d.lo + (d.hi - d.lo) * i as f64 / STEPS as f64;
            let points = (0..=STEPS).map(|i| c.point(at(i)));
            Box3::around(points.filter(|p| p.is_finite()))
        }
        ItemForm::Points(_) => None,
    };
    let all = document.items.iter().filter_map(hull).reduce(Box3::hull);
    let tolerance = DEFAULT_TOLERANCE * all.map_or(1.0, Box3::diagonal);
    if tolerance > 0.0 && tolerance.is_finite() {
        tolerance
    } else {
        DEFAULT_TOLERANCE
    }
}
