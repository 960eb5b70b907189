//! Wavefront OBJ: text with shared points, so that the mesh stays watertight, and with each surface's own normals and
//! parameters.
//!
//! `v` are the mesh's points in full f64, `vt` the surface's parameters (u, v), `vn` the normals, one `g` for each
//! surface, `l` for curves. Blanks in names become `_`: the format ends a name at a blank.
//! Source: Wavefront, *Object Files*, Advanced Visualizer manual, appendix B1.

use crate::facets::{Store, corners};
use crate::report::{Tally, Ticker};
use crate::scene::Scene;
use crate::text::{certainty, line, number, triple, word};
use std::io::{self, Write};

pub(crate) fn write(
    scene: &Scene,
    out: &mut dyn Write,
    mut ticker: Ticker<'_>,
) -> io::Result<Tally> {
    let mut tally = Tally::default();
    writeln!(
        out,
        "# nappe: {}",
        certainty(scene.deviation(), scene.units.symbol())
    )?;
    writeln!(out, "# units: {}", scene.units.symbol())?;
    if let Some(title) = &scene.title {
        writeln!(out, "# {}", line(title))?;
        writeln!(out, "o {}", word(title))?;
    }
    for &p in &scene.mesh.points {
        writeln!(out, "v {}", triple(p))?;
    }
    // The format counts from 1, over the whole file.
    let mut first = 1;
    for (part, patch) in scene.patches() {
        writeln!(out, "g {}", word(&part.name))?;
        for v in &patch.vertices {
            writeln!(out, "vt {} {}", number(v.uv[0]), number(v.uv[1]))?;
        }
        for v in &patch.vertices {
            writeln!(out, "vn {}", triple(v.normal))?;
        }
        for &t in &patch.triangles {
            ticker.step();
            if tally.admit(corners(&scene.mesh, patch, t), Store::Double) {
                let [a, b, c] = t.map(|i| {
                    let (point, own) = (
                        patch.vertices[i as usize].point as u64 + 1,
                        first + u64::from(i),
                    );
                    format!("{point}/{own}/{own}")
                });
                writeln!(out, "f {a} {b} {c}")?;
            }
        }
        first += patch.vertices.len() as u64;
    }
    let mut next = scene.mesh.points.len() + 1;
    for curve in &scene.curves {
        writeln!(out, "g {}", word(&curve.name))?;
        for &p in &curve.points {
            writeln!(out, "v {}", triple(p))?;
        }
        write!(out, "l")?;
        for k in 0..curve.points.len() {
            write!(out, " {}", next + k)?;
        }
        writeln!(out)?;
        next += curve.points.len();
    }
    Ok(tally)
}
