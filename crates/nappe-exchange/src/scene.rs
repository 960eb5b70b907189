//! What is written: a mesh with names and colours, and what goes with it.

use crate::document::Document;
use crate::error::SceneError;
use glam::DVec3;
use nappe::Units;
use nappe::exact::{NurbsCurve, NurbsSurface};
use nappe::mesh::{Certainty, Mesh, MeshPatch};

/// A colour in sRGB, each channel from 0 to 1.
pub type Colour = [f32; 3];

/// Colours for parts that state none, told apart by their order: muted, of similar lightness.
pub const PALETTE: [Colour; 8] = [
    [0.45, 0.63, 0.78],
    [0.91, 0.70, 0.45],
    [0.56, 0.73, 0.55],
    [0.83, 0.55, 0.55],
    [0.66, 0.60, 0.79],
    [0.52, 0.74, 0.74],
    [0.88, 0.80, 0.52],
    [0.75, 0.68, 0.63],
];

/// One surface of the scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// The surface's name.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// Index of its mesh in [`Mesh::patches`].
    pub patch: usize,
}

impl Part {
    /// A part with a colour from [`PALETTE`].
    pub fn new(name: impl Into<String>, patch: usize) -> Part {
        Part {
            name: name.into(),
            colour: PALETTE[patch % PALETTE.len()],
            patch,
        }
    }
}

/// A curve as a polyline.
#[derive(Clone, Debug, PartialEq)]
pub struct Polyline {
    /// The curve's name.
    pub name: String,
    /// The points, two or more; closed if the first is repeated at the end.
    pub points: Vec<DVec3>,
}

/// A number at each mesh vertex, for example a curvature.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The name, for example `Gaussian curvature`.
    pub name: String,
    /// The unit of the values, empty if they have none, for example `1/mm²`.
    pub unit: String,
    /// The values, `[patch][vertex]` as in the mesh. A value that is not finite means "none here".
    pub values: Vec<Vec<f64>>,
    /// Whether what is measured has values below every bound, and above, though not at a vertex: as curvature at the tip
    /// of a cone. The ends of a legend say so.
    pub unbounded: [bool; 2],
}

/// The NURBS form of a curve or surface of the model.
#[derive(Clone, Debug)]
pub struct Exact {
    /// The object's name.
    pub name: String,
    /// Its kind in the model file, for example `coons`.
    pub kind: String,
    /// The form.
    pub form: ExactForm,
    /// How far the form is from the object.
    pub certainty: Certainty,
    /// False if the form is the same set of points with other parameters.
    pub same_parameters: bool,
}

/// A NURBS form.
#[derive(Clone, Debug)]
pub enum ExactForm {
    /// Of a curve.
    Curve(NurbsCurve),
    /// Of a surface.
    Surface(NurbsSurface),
    /// There is none: the file says so.
    None,
}

/// What is written to a file or drawn.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The model's title.
    pub title: Option<String>,
    /// The unit of all coordinates.
    pub units: Units,
    /// The mesh.
    pub mesh: Mesh,
    /// The surfaces, in the order they are written. A patch of the mesh that no part names is left out.
    pub parts: Vec<Part>,
    /// Curves written beside the surfaces.
    pub curves: Vec<Polyline>,
    /// Numbers at the vertices: data of `.vtu`, colours of pictures.
    pub fields: Vec<Field>,
    /// The exact curves and surfaces, for `.json`.
    pub exact: Vec<Exact>,
    /// The exact surfaces as bodies, for `.step`.
    pub document: Document,
}

impl Scene {
    /// A scene of all patches of a mesh; names are taken in the order of the patches.
    pub fn from_mesh<N: Into<String>>(
        mesh: Mesh,
        names: impl IntoIterator<Item = N>,
        units: Units,
    ) -> Scene {
        let parts = names
            .into_iter()
            .enumerate()
            .map(|(i, n)| Part::new(n, i))
            .collect();
        Scene {
            units,
            mesh,
            parts,
            ..Scene::default()
        }
    }

    /// Each part with its mesh, of a scene that is valid.
    pub(crate) fn patches(&self) -> impl Iterator<Item = (&Part, &MeshPatch)> + Clone {
        self.parts.iter().map(|p| (p, &self.mesh.patches[p.patch]))
    }

    /// The number of triangles of all parts.
    pub fn triangles(&self) -> usize {
        self.patches().map(|(_, p)| p.triangles.len()).sum()
    }

    /// The deviation of the mesh from its surfaces: the greatest of the parts', and the weakest statement.
    pub fn deviation(&self) -> Certainty {
        self.patches()
            .fold(Certainty::Exact, |c, (_, p)| c.and(p.deviation))
    }

    /// The least and the greatest coordinates of everything in the scene; `None` if it is empty.
    pub fn extent(&self) -> Option<[DVec3; 2]> {
        let of_parts = self.patches().flat_map(|(_, p)| {
            p.vertices
                .iter()
                .map(|v| self.mesh.points[v.point as usize])
        });
        let of_curves = self.curves.iter().flat_map(|c| c.points.iter().copied());
        of_parts.chain(of_curves).fold(None, |b, p| match b {
            None => Some([p, p]),
            Some([lo, hi]) => Some([lo.min(p), hi.max(p)]),
        })
    }

    /// Checks that all indices exist and all numbers can be written.
    ///
    /// # Errors
    /// The first thing that is wrong, with its place and value.
    pub fn validate(&self) -> Result<(), SceneError> {
        for (index, point) in self.mesh.points.iter().enumerate() {
            if !point.is_finite() {
                return Err(SceneError::PointNotFinite {
                    index,
                    point: *point,
                });
            }
        }
        for part in &self.parts {
            let Some(patch) = self.mesh.patches.get(part.patch) else {
                return Err(SceneError::NoPatch {
                    part: part.name.clone(),
                    patch: part.patch,
                    patches: self.mesh.patches.len(),
                });
            };
            validate_patch(part, patch, self.mesh.points.len())?;
        }
        for curve in &self.curves {
            if curve.points.len() < 2 {
                return Err(SceneError::ShortCurve {
                    curve: curve.name.clone(),
                    points: curve.points.len(),
                });
            }
            if let Some(index) = curve.points.iter().position(|p| !p.is_finite()) {
                return Err(SceneError::CurveNotFinite {
                    curve: curve.name.clone(),
                    index,
                    point: curve.points[index],
                });
            }
        }
        for field in &self.fields {
            for part in &self.parts {
                let values = field.values.get(part.patch).map_or(0, Vec::len);
                let vertices = self.mesh.patches[part.patch].vertices.len();
                if values != vertices {
                    let (field, part) = (field.name.clone(), part.name.clone());
                    return Err(SceneError::FieldLength {
                        field,
                        part,
                        values,
                        vertices,
                    });
                }
            }
        }
        crate::json::validate(self)
    }
}

/// How far the length of a normal may be from 1. The kernel's normals are unit to rounding; a larger value here would
/// let normals through that viewers refuse (the glTF validator allows 5e-4).
const NORMAL_LENGTH_TOLERANCE: f64 = 1e-6;

fn validate_patch(part: &Part, patch: &MeshPatch, points: usize) -> Result<(), SceneError> {
    let name = || part.name.clone();
    for (index, v) in patch.vertices.iter().enumerate() {
        if v.point as usize >= points {
            return Err(SceneError::NoPoint {
                part: name(),
                vertex: index,
                point: v.point,
                points,
            });
        }
        let length = v.normal.length();
        if length.is_nan() || (length - 1.0).abs() > NORMAL_LENGTH_TOLERANCE {
            return Err(SceneError::Normal {
                part: name(),
                vertex: index,
                normal: v.normal,
            });
        }
        if !(v.uv[0].is_finite() && v.uv[1].is_finite()) {
            return Err(SceneError::Parameters {
                part: name(),
                vertex: index,
                uv: v.uv,
            });
        }
    }
    for (index, t) in patch.triangles.iter().enumerate() {
        if let Some(&vertex) = t.iter().find(|&&i| i as usize >= patch.vertices.len()) {
            let vertices = patch.vertices.len();
            return Err(SceneError::NoVertex {
                part: name(),
                triangle: index,
                vertex,
                vertices,
            });
        }
    }
    Ok(())
}
