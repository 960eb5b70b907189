//! Whether the surfaces enclose a solid, and which of them must be turned so that all normals point out of it.

use crate::facets::{area_vector, corners};
use crate::scene::Scene;
use nappe::measure::bodies;

/// What the surfaces make together.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub(crate) struct Shape {
    /// Whether a part's triangles must be reversed: for the normals of a closed body to point outward, and for the parts
    /// of an open one to agree with its first.
    pub(crate) turn: Vec<bool>,
    /// The parts of bodies that are not closed: edges with one triangle or with more than two, or only one side, as a
    /// Möbius strip.
    pub(crate) open: Vec<usize>,
    /// True if the parts of a body cannot agree.
    one_sided: bool,
}

impl Shape {
    /// True if the surfaces enclose solids, all of them.
    pub(crate) fn is_solid(&self) -> bool {
        self.open.is_empty() && !self.turn.is_empty()
    }

    /// What was reversed, and what cannot be told by normals.
    pub(crate) fn notes(&self) -> Vec<String> {
        let all = self.turn.len();
        let turned = self.turn.iter().filter(|&&t| t).count();
        let mut notes = Vec::new();
        if turned > 0 {
            let aim = if self.open.is_empty() {
                "that all normals point out of the solid"
            } else if self.open.len() == all {
                "that neighbours have their normals on the same side"
            } else {
                "that the normals of closed parts point outwards, and neighbours have theirs on the same side"
            };
            notes.push(format!(
                "{turned} of {all} surfaces were reversed so {aim}."
            ));
        }
        if self.one_sided {
            notes.push(
                "Some surfaces have only one side together: their normals cannot agree along all edges.".into(),
            );
        }
        notes
    }
}

/// One use of an edge: its points in increasing order, the part, and whether the triangle runs it in that order.
type Use = (u32, u32, usize, bool);

/// Determines what the surfaces make together, each connected body for itself. Time n log n of the triangles.
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
    // A part without a triangle encloses nothing.
    let mut flawed = vec![true; scene.parts.len()];
    uses.iter().for_each(|u| flawed[u.2] = false);
    let mut twisted = vec![false; scene.parts.len()];
    for edge in uses.chunk_by(|a, b| (a.0, a.1) == (b.0, b.1)) {
        let [a, b] = edge else {
            edge.iter().for_each(|u| flawed[u.2] = true);
            continue;
        };
        // Neighbours that agree run their edge in opposite directions.
        let turned = a.3 == b.3;
        if a.2 == b.2 {
            twisted[a.2] |= turned;
        } else {
            neighbours[a.2].push((b.2, turned));
            neighbours[b.2].push((a.2, turned));
        }
    }
    let mut shape = Shape {
        turn: vec![false; scene.parts.len()],
        ..Shape::default()
    };
    for body in bodies(&neighbours) {
        let parts = || body.parts.iter().map(|p| p.0);
        let one_sided = body.contradiction.is_some() || parts().any(|p| twisted[p]);
        let closed = !one_sided && !parts().any(|p| flawed[p]);
        shape.one_sided |= one_sided;
        if !closed {
            shape.open.extend(parts());
        }
        if one_sided {
            continue;
        }
        let part = |&(p, t): &(usize, bool)| if t { -1.0 } else { 1.0 } * cone_volume(scene, p);
        let inward = closed && body.parts.iter().map(part).sum::<f64>() < 0.0;
        for &(part, turned) in &body.parts {
            shape.turn[part] = turned != inward;
        }
    }
    shape.open.sort_unstable();
    shape
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

    fn solid(turn: &[bool]) -> Shape {
        Shape {
            turn: turn.to_vec(),
            ..Shape::default()
        }
    }

    #[test]
    fn a_closed_surface_is_turned_outward_and_an_open_one_is_open() {
        let sphere = samples::sphere(24, 12);
        assert_eq!(shape(&sphere), solid(&[false]));
        let mut inward = sphere.clone();
        for t in &mut inward.mesh.patches[0].triangles {
            t.swap(1, 2);
        }
        assert_eq!(shape(&inward), solid(&[true]));
        let open = shape(&samples::saddle(8));
        assert_eq!(
            (open.turn.as_slice(), open.open.as_slice()),
            (&[false][..], &[0][..])
        );
        assert!(!open.is_solid());
    }

    #[test]
    fn faces_of_a_cube_with_mixed_directions_are_made_to_agree() {
        let mut cube = samples::cube();
        assert_eq!(shape(&cube), solid(&[false; 6]));
        for face in [1, 4] {
            for t in &mut cube.mesh.patches[face].triangles {
                t.swap(0, 1);
            }
        }
        assert_eq!(
            shape(&cube),
            solid(&[false, true, false, false, true, false])
        );
        // Without a face it is open, but the others still agree with the first.
        cube.parts.pop();
        let open = shape(&cube);
        assert_eq!(open.turn, [false, true, false, false, true]);
        assert_eq!(open.open, [0, 1, 2, 3, 4]);
        assert_eq!(open.notes().len(), 1);
    }

    #[test]
    fn an_open_surface_takes_nothing_from_a_solid_beside_it() {
        let mut cube = samples::cube();
        for t in &mut cube.mesh.patches[2].triangles {
            t.swap(0, 1);
        }
        let saddle = samples::saddle(4);
        let (points, patches) = (cube.mesh.points.len() as u32, cube.mesh.patches.len());
        cube.mesh.points.extend(&saddle.mesh.points);
        for mut patch in saddle.mesh.patches {
            patch.vertices.iter_mut().for_each(|v| v.point += points);
            cube.mesh.patches.push(patch);
        }
        for mut part in saddle.parts {
            part.patch += patches;
            cube.parts.push(part);
        }
        let found = shape(&cube);
        assert_eq!(found.turn, [false, false, true, false, false, false, false]);
        assert_eq!(found.open, [6]);
    }
}
