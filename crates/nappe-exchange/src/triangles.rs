//! Meshes as files hold them: triangles without surfaces.

use crate::facets::area_vector;
use crate::scene::{Colour, Part, Polyline, Scene};
use glam::DVec3;
use nappe::Units;
use nappe::mesh::{Certainty, Mesh, MeshPatch, MeshVertex};

/// Triangles read from a file. Nothing is known of surfaces behind them: no parameters, no normals.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct TriangleMesh {
    /// The name of the whole, if the file has one.
    pub title: Option<String>,
    /// The unit of all coordinates, if the file says which.
    pub units: Option<Units>,
    /// The points. Triangles that share an edge share its points, as far as the file tells.
    pub points: Vec<DVec3>,
    /// The parts, in the order of the file.
    pub groups: Vec<Group>,
    /// Curves beside the triangles.
    pub curves: Vec<Polyline>,
    /// What the file holds besides and was not taken over, in full sentences.
    pub notes: Vec<String>,
    /// The geometry of the file that is not here, in full sentences: the mesh is then not whole.
    pub missing: Vec<String>,
}

/// Triangles of one name and colour.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Group {
    /// The name; empty if there is none.
    pub name: String,
    /// The colour, if there is one.
    pub colour: Option<Colour>,
    /// Indices into [`TriangleMesh::points`], counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// Two triangles that meet in a point at less than this angle (radians, 30°) are taken as parts of one smooth surface
/// there, and share a normal. What files of curved parts are cut to is mostly finer, edges of parts are mostly sharper.
const SMOOTH: f64 = std::f64::consts::FRAC_PI_6;
/// A point with more triangles gets their flat normals: comparing all of them with each other would take too long.
const MOST_AROUND: usize = 256;

impl TriangleMesh {
    /// The number of triangles.
    pub fn triangles(&self) -> usize {
        self.groups.iter().map(|g| g.triangles.len()).sum()
    }

    /// As a scene: each group a part, with computed normals. A normal is the mean of the triangles around the point
    /// that bend from the corner's own by less than 30°, weighted with their areas. There are no surfaces, so all
    /// parameters are 0, and the deviation is [`Certainty::Exact`]: the triangles are what they are. Without a unit in the
    /// file, millimetres are assumed. Groups without triangles are left out.
    pub fn to_scene(&self) -> Scene {
        let around = Around::of(self);
        let (mut patches, mut parts) = (Vec::new(), Vec::new());
        let mut first = 0;
        for group in &self.groups {
            let range = first..first + group.triangles.len();
            first = range.end;
            if group.triangles.is_empty() {
                continue;
            }
            let mut part = Part::new(group.name.clone(), patches.len());
            if let Some(colour) = group.colour {
                part.colour = colour;
            }
            parts.push(part);
            patches.push(around.patch(group, range));
        }
        Scene {
            title: self.title.clone(),
            units: self.units.unwrap_or_default(),
            mesh: Mesh {
                points: self.points.clone(),
                patches,
            },
            parts,
            curves: self.curves.clone(),
            ..Scene::default()
        }
    }

    fn corners(&self, t: [u32; 3]) -> [DVec3; 3] {
        t.map(|i| self.points[i as usize])
    }
}

/// The triangles around each point, as one list, and their area vectors.
struct Around {
    /// Where each point's triangles begin in `list`.
    starts: Vec<usize>,
    list: Vec<u32>,
    areas: Vec<DVec3>,
}

impl Around {
    fn of(mesh: &TriangleMesh) -> Around {
        let all = || mesh.groups.iter().flat_map(|g| &g.triangles);
        let mut starts = vec![0; mesh.points.len() + 1];
        all()
            .flatten()
            .for_each(|&p| starts[p as usize + 1] += 1usize);
        for i in 1..starts.len() {
            starts[i] += starts[i - 1];
        }
        let mut next = starts.clone();
        let mut list = vec![0; starts[mesh.points.len()]];
        for (number, t) in all().enumerate() {
            for &p in t {
                list[next[p as usize]] = number as u32;
                next[p as usize] += 1;
            }
        }
        let size = mesh
            .points
            .iter()
            .fold(0.0f64, |m, p| m.max(p.abs().max_element()));
        // Scaled, so that products of very large or very small lengths neither overflow nor vanish.
        let scale = Some(size.recip()).filter(|s| s.is_finite()).unwrap_or(1.0);
        let areas = all().map(|&t| area_vector(mesh.corners(t).map(|c| c * scale)));
        Around {
            starts,
            list,
            areas: areas.collect(),
        }
    }

    /// The part of the mesh that a group is; `range` numbers its triangles.
    fn patch(&self, group: &Group, range: std::ops::Range<usize>) -> MeshPatch {
        // The vertices made so far at each point of the group: the last of them, and the one before each.
        let mut last: std::collections::HashMap<u32, u32> = std::collections::HashMap::new();
        let mut before: Vec<u32> = Vec::new();
        let mut vertices: Vec<MeshVertex> = Vec::new();
        let mut triangles = Vec::with_capacity(group.triangles.len());
        for (t, number) in group.triangles.iter().zip(range.clone()) {
            triangles.push(t.map(|point| {
                let normal = self.normal(point, number, &range);
                let mut at = last.get(&point).copied().unwrap_or(NONE);
                while at != NONE && vertices[at as usize].normal != normal {
                    at = before[at as usize];
                }
                if at == NONE {
                    at = vertices.len() as u32;
                    before.push(last.insert(point, at).unwrap_or(NONE));
                    let uv = [0.0; 2];
                    vertices.push(MeshVertex { point, uv, normal });
                }
                at
            }));
        }
        MeshPatch {
            vertices,
            triangles,
            deviation: Certainty::Exact,
        }
    }

    fn normal(&self, point: u32, number: usize, range: &std::ops::Range<usize>) -> DVec3 {
        let around = &self.list[self.starts[point as usize]..self.starts[point as usize + 1]];
        let own = direction(self.areas[number]);
        let same = around.iter().map(|&t| t as usize);
        let same = same.filter(|t| range.contains(t));
        let Some(own) = own else {
            // A triangle without area: that of its neighbours, or any.
            let sum: DVec3 = same.map(|t| self.areas[t]).sum();
            return direction(sum).unwrap_or(DVec3::Z);
        };
        if around.len() > MOST_AROUND {
            return own;
        }
        let smooth = SMOOTH.cos();
        let sum: DVec3 = same
            .map(|t| self.areas[t])
            .filter(|a| a.dot(own) >= smooth * a.length())
            .sum();
        direction(sum).unwrap_or(own)
    }
}

/// The unit vector along another one, `None` for zero. Scaled first: the square of an area of 1e-160 underflows.
fn direction(v: DVec3) -> Option<DVec3> {
    (v / v.abs().max_element()).try_normalize()
}

/// The length of a vector whose square may be no number, or nothing.
fn length(v: DVec3) -> f64 {
    let size = v.abs().max_element();
    if size > 0.0 && size.is_finite() {
        (v / size).length() * size
    } else {
        size
    }
}

/// No vertex.
const NONE: u32 = u32::MAX;

/// What can be told of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshFacts {
    /// The number of triangles.
    pub triangles: usize,
    /// The number of points that triangles use.
    pub points: usize,
    /// Triangles without area: corners that are equal, or on one line.
    pub degenerate: usize,
    /// Edges with one triangle: where the mesh is open.
    pub open_edges: usize,
    /// Edges with more than two triangles.
    pub crowded_edges: usize,
    /// Edges of two triangles that run them in the same direction, so that their normals disagree.
    pub turned_edges: usize,
    /// The area.
    pub area: f64,
    /// What the triangles enclose, negative if they face inwards; `None` if they enclose nothing: some edge is open,
    /// crowded or turned.
    pub volume: Option<f64>,
    /// The least and the greatest coordinates of the triangles; `None` if there are none.
    pub extent: Option<[DVec3; 2]>,
}

/// Measures a mesh. Time n log n of the triangles.
///
/// Edges are matched by the points' numbers. Triangles with two equal corner numbers have no edges. Area and volume are
/// sums of exact formulas for each triangle, rounded as f64.
pub fn mesh_facts(mesh: &TriangleMesh) -> MeshFacts {
    let all = || mesh.groups.iter().flat_map(|g| &g.triangles);
    let mut used = vec![false; mesh.points.len()];
    let mut extent: Option<[DVec3; 2]> = None;
    for &p in all().flatten() {
        used[p as usize] = true;
        let p = mesh.points[p as usize];
        extent = Some(extent.map_or([p, p], |[lo, hi]| [lo.min(p), hi.max(p)]));
    }
    let (mut area, mut volume, mut degenerate) = (0.0, 0.0, 0);
    // Measured from the middle, volumes of thin cones to a far origin do not cancel.
    let middle = extent.map_or(DVec3::ZERO, |[lo, hi]| lo + (hi - lo) / 2.0);
    let mut edges: Vec<(u32, u32, bool)> = Vec::with_capacity(3 * mesh.triangles());
    for &t in all() {
        let c = mesh.corners(t).map(|c| c - middle);
        let twice = area_vector(c);
        area += length(twice) / 2.0;
        volume += twice.dot(c[0]) / 6.0;
        degenerate += usize::from(twice == DVec3::ZERO);
        if t[0] != t[1] && t[1] != t[2] && t[2] != t[0] {
            edges.extend([0, 1, 2].map(|k| {
                let (a, b) = (t[k], t[(k + 1) % 3]);
                (a.min(b), a.max(b), a < b)
            }));
        }
    }
    edges.sort_unstable();
    let (mut open, mut crowded, mut turned) = (0, 0, 0);
    for edge in edges.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        match edge {
            [_] => open += 1,
            [a, b] => turned += usize::from(a.2 == b.2),
            _ => crowded += 1,
        }
    }
    let closed = open + crowded + turned == 0 && !edges.is_empty();
    MeshFacts {
        triangles: mesh.triangles(),
        points: used.iter().filter(|u| **u).count(),
        degenerate,
        open_edges: open,
        crowded_edges: crowded,
        turned_edges: turned,
        area,
        volume: closed.then_some(volume),
        extent,
    }
}
