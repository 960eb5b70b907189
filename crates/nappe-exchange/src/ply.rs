//! Binary little-endian PLY with shared points, so that the mesh stays watertight.
//!
//! A vertex is a point of the mesh (f64) with one normal: where surfaces meet at an angle, or a surface has a pole,
//! the normals of its corners differ and their mean is stored. Each face carries the parameters (u, v) of its own
//! corners as `u0 v0 u1 v1 u2 v2`, its surface's number and colour; a comment gives each surface's name.
//! (A `texcoord` list, which some readers know, makes them split the points and so opens the mesh.)
//! Source: G. Turk, *The PLY Polygon File Format*, 1994.

use crate::facets::{Store, corners};
use crate::report::{Tally, Ticker};
use crate::scene::Scene;
use crate::text::{byte, certainty, line};
use glam::DVec3;
use std::io::{self, Write};

pub(crate) fn write(
    scene: &Scene,
    out: &mut dyn Write,
    mut ticker: Ticker<'_>,
) -> io::Result<Tally> {
    let mut tally = Tally::default();
    for (_, patch) in scene.patches() {
        for &t in &patch.triangles {
            tally.admit(corners(&scene.mesh, patch, t), Store::Double);
        }
    }
    header(scene, out, tally.triangles)?;
    for (&p, normal) in scene.mesh.points.iter().zip(point_normals(scene)) {
        for x in p.to_array() {
            out.write_all(&x.to_le_bytes())?;
        }
        for x in normal.as_vec3().to_array() {
            out.write_all(&x.to_le_bytes())?;
        }
    }
    let mut written = Tally::default();
    for (index, (part, patch)) in scene.patches().enumerate() {
        let colour = part.colour.map(byte);
        for &t in &patch.triangles {
            ticker.step();
            if !written.admit(corners(&scene.mesh, patch, t), Store::Double) {
                continue;
            }
            let v = t.map(|i| patch.vertices[i as usize]);
            out.write_all(&[3])?;
            for corner in v {
                out.write_all(&corner.point.to_le_bytes())?;
            }
            for x in v.iter().flat_map(|corner| corner.uv) {
                out.write_all(&x.to_le_bytes())?;
            }
            out.write_all(&(index as i32).to_le_bytes())?;
            out.write_all(&colour)?;
        }
    }
    if !scene.curves.is_empty() {
        tally.notes.push(format!(
            "The {} curves were left out: a .ply file has no place for them.",
            scene.curves.len()
        ));
    }
    Ok(tally)
}

fn header(scene: &Scene, out: &mut dyn Write, faces: usize) -> io::Result<()> {
    writeln!(out, "ply\nformat binary_little_endian 1.0")?;
    writeln!(
        out,
        "comment nappe: {}",
        certainty(scene.deviation(), scene.units.symbol())
    )?;
    writeln!(out, "comment units: {}", scene.units.symbol())?;
    if let Some(title) = &scene.title {
        writeln!(out, "comment title: {}", line(title))?;
    }
    for (index, part) in scene.parts.iter().enumerate() {
        writeln!(out, "comment surface {index}: {}", line(&part.name))?;
    }
    writeln!(out, "element vertex {}", scene.mesh.points.len())?;
    for name in ["x", "y", "z"] {
        writeln!(out, "property double {name}")?;
    }
    for name in ["nx", "ny", "nz"] {
        writeln!(out, "property float {name}")?;
    }
    writeln!(out, "element face {faces}")?;
    writeln!(out, "property list uchar uint vertex_indices")?;
    for name in ["u0", "v0", "u1", "v1", "u2", "v2"] {
        writeln!(out, "property double {name}")?;
    }
    writeln!(out, "property int surface")?;
    writeln!(
        out,
        "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header"
    )
}

/// The mean of the normals of all corners at each point; the first of them if they cancel.
fn point_normals(scene: &Scene) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; scene.mesh.points.len()];
    let mut first = vec![DVec3::Z; sums.len()];
    for (_, patch) in scene.patches() {
        for v in &patch.vertices {
            let p = v.point as usize;
            if sums[p] == DVec3::ZERO {
                first[p] = v.normal;
            }
            sums[p] += v.normal;
        }
    }
    sums.iter()
        .zip(first)
        .map(|(s, f)| s.try_normalize().unwrap_or(f))
        .collect()
}
