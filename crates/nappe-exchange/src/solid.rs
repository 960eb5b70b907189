//! Whether the surfaces enclose a solid, and which of them must be turned so that all normals point out of it.

use crate::facets::{area_vector, corners};
use crate::scene::Scene;
use nappe::measure::bodies;

/// What the surfaces make together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Shape {
    /// Every edge is shared by exactly two triangles, and the sides can be told apart. `turn[part]` says whether a
    /// part's triangles must be reversed for the normals to point outward.
    Closed { turn: Vec<bool> },
    /// Edges with one triangle or with more than two, or only one side, as a Möbius strip.
    Open,
}

/// One use of an edge: its points in increasing order, the part, and whether the triangle runs it in that order.
type Use = (u32, u32, usize, bool);

/// Determines what the surfaces make together. Time n log n of the triangles.
pub(crate) fn shape(scene: &Scene) -> Shape {
    let mut uses: Vec<Use> = Vec::with_capacity(3 * scene.triangles());
    for (part, (_, patch)) in scene.patches().enumerate() {
        for t in &patch.triangles {
            let p = t.map(|i| patch.vertices[i as usize].point);
            if p[0] == p[1] || p[1] == p[2] || p[2] == p[0] {
                continue;
            }
            for k in 0..3 {
                let (a, b) = (p[k], p[(k + 1) % 3]);
                uses.push((a.min(b), a.max(b), part, a < b));
            }
        }
    }
    uses.sort_unstable();
    let mut neighbours: Vec<Vec<(usize, bool)>> = vec![Vec::new(); scene.parts.len()];
    for edge in uses.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let [a, b] = edge else { return Shape::Open };
        // Neighbours that agree run their edge in opposite directions.
        let turned = a.3 == b.3;
        if a.2 == b.2 {
            if turned {
                return Shape::Open;
            }
            continue;
        }
        neighbours[a.2].push((b.2, turned));
        neighbours[b.2].push((a.2, turned));
    }
    match orient(scene, &neighbours) {
        Some(turn) if !uses.is_empty() => Shape::Closed { turn },
        _ => Shape::Open,
    }
}

/// Turns each connected body so that its volume is positive.
fn orient(scene: &Scene, neighbours: &[Vec<(usize, bool)>]) -> Option<Vec<bool>> {
    let mut turn = vec![false; neighbours.len()];
    for body in bodies(neighbours).ok()? {
        let volume: f64 = body
            .iter()
            .map(|&(p, t)| if t { -1.0 } else { 1.0 } * cone_volume(scene, p))
            .sum();
        for (part, turned) in body {
            turn[part] = turned != (volume < 0.0);
        }
    }
    Some(turn)
}

/// Six times the volume between a part and a fixed point near the scene.
fn cone_volume(scene: &Scene, part: usize) -> f64 {
    let patch = &scene.mesh.patches[scene.parts[part].patch];
    // Any one point serves; one of the mesh keeps precision far from the origin.
    let Some(&base) = scene.mesh.points.first() else {
        return 0.0;
    };
    patch
        .triangles
        .iter()
        .map(|&t| {
            let c = corners(&scene.mesh, patch, t);
            area_vector(c).dot(c[0] - base)
        })
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    #[test]
    fn a_closed_surface_is_turned_outward_and_an_open_one_is_open() {
        let sphere = samples::sphere(24, 12);
        assert_eq!(shape(&sphere), Shape::Closed { turn: vec![false] });
        let mut inward = sphere.clone();
        for t in &mut inward.mesh.patches[0].triangles {
            t.swap(1, 2);
        }
        assert_eq!(shape(&inward), Shape::Closed { turn: vec![true] });
        assert_eq!(shape(&samples::saddle(8)), Shape::Open);
    }

    #[test]
    fn faces_of_a_cube_with_mixed_directions_are_made_to_agree() {
        let mut cube = samples::cube();
        assert_eq!(
            shape(&cube),
            Shape::Closed {
                turn: vec![false; 6]
            }
        );
        for face in [1, 4] {
            for t in &mut cube.mesh.patches[face].triangles {
                t.swap(0, 1);
            }
        }
        assert_eq!(
            shape(&cube),
            Shape::Closed {
                turn: vec![false, true, false, false, true, false]
            }
        );
        cube.parts.pop();
        assert_eq!(shape(&cube), Shape::Open);
    }
}
