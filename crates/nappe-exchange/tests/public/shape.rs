//! What triangles within a distance of surfaces must have in common with these.

use nappe::DVec3;
use nappe::body::{self, Body};
use nappe::mesh::Mesh;
use std::collections::HashMap;

/// The two triangles at an edge: how often it is run each way, and their area vectors.
#[derive(Default)]
struct Meeting {
    ways: [usize; 2],
    areas: Vec<DVec3>,
}

/// Compares a mesh with the body it is of.
///
/// With e the distance, moving a border by e changes an area by at most e times its length, and moving a surface by e along its
/// normals by at most 2 e ∫ |H| dA, which for triangles is e times the sum of their edges' lengths and angles (Steiner); e²
/// terms and that normals of triangles differ from the surfaces' are covered by taking both twice. Solids within e of each
/// other differ by no more volume than the layer of that thickness on either side.
pub(crate) fn compare(body: &Body, mesh: &Mesh, what: &str) {
    let mut edges: HashMap<(u32, u32), Meeting> = HashMap::new();
    let (mut area, mut volume) = (0.0, 0.0);
    let middle = body::extent(body).mid();
    for (face, patch) in mesh.patches.iter().enumerate() {
        // A shell may take a face the other way round.
        let mut shells = body.shells.iter().flat_map(|s| &s.faces);
        let kept = shells.find(|s| s.0 == face).is_none_or(|s| s.1);
        for t in &patch.triangles {
            let t = if kept { *t } else { [t[0], t[2], t[1]] };
            let ids = t.map(|k| patch.vertices[k as usize].point);
            let [a, b, c] = ids.map(|i| mesh.points[i as usize] - middle);
            let half = (b - a).cross(c - a) / 2.0;
            area += half.length();
            volume += half.dot(a) / 3.0;
            for k in 0..3 {
                let (i, j) = (ids[k], ids[(k + 1) % 3]);
                let met = edges.entry((i.min(j), i.max(j))).or_default();
                met.ways[usize::from(i > j)] += 1;
                met.areas.push(half);
            }
        }
    }
    let deviation = mesh.patches.iter().map(|p| p.deviation.error());
    let e = deviation.fold(0.0, f64::max);
    let (mut bent, mut border) = (0.0, 0.0);
    for ((i, j), met) in &edges {
        let length = mesh.points[*i as usize].distance(mesh.points[*j as usize]);
        match met.areas.as_slice() {
            [a, b] => bent += length * a.angle_between(*b),
            _ => border += length,
        }
    }
    let exact = body::figures(body).unwrap();
    let of_faces = exact.areas.iter().map(|a| *a.as_ref().unwrap());
    let of_faces: nappe::measure::Measured = of_faces.sum();
    let allowed = 2.0 * e * (bent + border) + of_faces.certainty.error();
    let apart = (area - of_faces.value).abs();
    assert!(
        apart <= allowed,
        "{what}: area {area}, not {}: {apart} apart, more than {allowed}",
        of_faces.value
    );
    if body.shells.is_empty() || !body.shells.iter().all(|s| s.closed) {
        return;
    }
    let open = edges.values().filter(|m| m.ways != [1, 1]).count();
    assert_eq!(open, 0, "{what}: edges that do not close");
    let volumes: Option<Vec<_>> = exact.volumes.into_iter().collect();
    let enclosed: nappe::measure::Measured = volumes.unwrap().into_iter().sum();
    let allowed = 2.0 * e * area + enclosed.certainty.error();
    let apart = (volume - enclosed.value).abs();
    assert!(
        apart <= allowed,
        "{what}: volume {volume}, not {}: {apart} apart, more than {allowed}",
        enclosed.value
    );
}
