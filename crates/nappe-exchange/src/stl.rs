//! Binary STL: 80 bytes of header, a count, then 50 bytes a triangle.
//!
//! Coordinates are f32 in the scene's units, not moved to another origin (the format has no place to say so), so a
//! model far from the origin loses digits; the report says how much. Solids are written with normals outward.
//! Source: 3D Systems, *StereoLithography Interface Specification*, 1989.

use crate::facets::{Store, corners, facet_normal};
use crate::report::{Tally, Ticker};
use crate::scene::Scene;
use crate::solid::shape;
use glam::{DVec3, Vec3};
use std::io::{self, Write};

const HEADER: usize = 80;

pub(crate) fn write(
    scene: &Scene,
    out: &mut dyn Write,
    mut ticker: Ticker<'_>,
) -> io::Result<Tally> {
    let store = Store::Single {
        origin: DVec3::ZERO,
    };
    let shape = shape(scene);
    let mut tally = Tally::default();
    for (_, patch) in scene.patches() {
        for &t in &patch.triangles {
            tally.admit(corners(&scene.mesh, patch, t), store);
        }
    }
    // A header that starts with "solid" makes readers take the file for text.
    let mut header = format!("nappe binary STL, {}", scene.units.symbol()).into_bytes();
    header.resize(HEADER, 0);
    out.write_all(&header)?;
    let count = u32::try_from(tally.triangles).map_err(io::Error::other)?;
    out.write_all(&count.to_le_bytes())?;
    let mut written = Tally::default();
    for (index, (_, patch)) in scene.patches().enumerate() {
        for &t in &patch.triangles {
            ticker.step();
            let mut c = corners(&scene.mesh, patch, t);
            if !written.admit(c, store) {
                continue;
            }
            let mut normal = facet_normal(c, t.map(|i| patch.vertices[i as usize].normal));
            if shape.turn[index] {
                c.swap(1, 2);
                normal = -normal;
            }
            put(out, normal.as_vec3())?;
            for p in c {
                tally.note_rounding(p, store);
                put(out, store.single(p))?;
            }
            out.write_all(&[0, 0])?;
        }
    }
    tally.notes.extend(shape.notes());
    Ok(tally)
}

fn put(out: &mut dyn Write, v: Vec3) -> io::Result<()> {
    for x in v.to_array() {
        out.write_all(&x.to_le_bytes())?;
    }
    Ok(())
}
