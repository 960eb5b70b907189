//! VTK unstructured grid: XML with the numbers appended in base64 (raw bytes would be a quarter smaller, but are no XML).
//!
//! A grid point is a vertex of a surface, so that normals and parameters are its own; vertices that share a point of
//! the mesh have bit-equal coordinates and the same `point_id`, by which the watertight mesh is put together again.
//! Point data: `Normals`, `uv`, `point_id` and the scene's fields; cell data: `surface`, a number whose
//! name the field data tells: the array `surface NAME` holds the number of NAME (text arrays would be plainer, but some
//! readers refuse them). Curves are line cells of surface -1, their `point_id` is -1 and their fields are NaN.
//! Source: Kitware, *VTK File Formats*, §XML file formats.

use crate::facets::{Store, corners};
use crate::report::{Tally, Ticker};
use crate::scene::Scene;
use crate::text::{number, xml};
use base64::engine::general_purpose::{GeneralPurpose, STANDARD};
use base64::write::EncoderWriter;
use nappe::mesh::Certainty;
use std::io::{self, Write};

const TRIANGLE: u8 = 5;
const LINE: u8 = 3;
/// Bytes of the length before each block.
const LENGTH: u64 = 8;

/// How much there is of everything.
struct Counts {
    vertices: usize,
    curve_points: usize,
    triangles: usize,
    lines: usize,
}

impl Counts {
    fn points(&self) -> usize {
        self.vertices + self.curve_points
    }

    fn cells(&self) -> usize {
        self.triangles + self.lines
    }

    fn corners(&self) -> usize {
        3 * self.triangles + 2 * self.lines
    }
}

pub(crate) fn write(scene: &Scene, out: &mut dyn Write, ticker: Ticker<'_>) -> io::Result<Tally> {
    let mut tally = Tally::default();
    for (_, patch) in scene.patches() {
        for &t in &patch.triangles {
            tally.admit(corners(&scene.mesh, patch, t), Store::Double);
        }
    }
    let counts = Counts {
        vertices: scene.patches().map(|(_, p)| p.vertices.len()).sum(),
        curve_points: scene.curves.iter().map(|c| c.points.len()).sum(),
        triangles: tally.triangles,
        lines: scene.curves.iter().map(|c| c.points.len() - 1).sum(),
    };
    head(scene, &counts, out)?;
    write!(out, "<AppendedData encoding=\"base64\">\n_")?;
    point_blocks(scene, &counts, out)?;
    cell_blocks(scene, &counts, out, ticker)?;
    writeln!(out, "\n</AppendedData>\n</VTKFile>")?;
    Ok(tally)
}

/// Tells each data array where its block will be.
struct Tags<'a> {
    out: &'a mut dyn Write,
    offset: u64,
}

impl Tags<'_> {
    fn tag(&mut self, kind: &str, name: &str, components: usize, count: usize) -> io::Result<()> {
        let width = match kind {
            "UInt8" => 1,
            "Int32" => 4,
            _ => 8,
        };
        writeln!(
            self.out,
            r#"<DataArray type="{kind}" Name="{}" NumberOfComponents="{components}" format="appended" offset="{}"/>"#,
            xml(name),
            self.offset
        )?;
        self.offset += (LENGTH + width * (components * count) as u64).div_ceil(3) * 4;
        Ok(())
    }
}

fn head(scene: &Scene, n: &Counts, out: &mut dyn Write) -> io::Result<()> {
    writeln!(out, r#"<?xml version="1.0"?>"#)?;
    writeln!(
        out,
        r#"<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64">"#
    )?;
    writeln!(out, "<UnstructuredGrid>\n<FieldData>")?;
    for (index, part) in scene.parts.iter().enumerate() {
        value(
            out,
            "Int32",
            &format!("surface {}", part.name),
            &index.to_string(),
        )?;
    }
    value(
        out,
        "Float64",
        "metres_per_unit",
        &number(scene.units.metres()),
    )?;
    let (proven, deviation) = match scene.deviation() {
        Certainty::Estimated(e) => ("0", e),
        certain => ("1", certain.error()),
    };
    value(out, "Float64", "deviation", &number(deviation))?;
    value(out, "Int32", "deviation_is_proven", proven)?;
    writeln!(out, "</FieldData>")?;
    writeln!(
        out,
        r#"<Piece NumberOfPoints="{}" NumberOfCells="{}">"#,
        n.points(),
        n.cells()
    )?;
    let mut tags = Tags { out, offset: 0 };
    writeln!(tags.out, "<Points>")?;
    tags.tag("Float64", "Points", 3, n.points())?;
    writeln!(
        tags.out,
        "</Points>\n<PointData Normals=\"Normals\" TCoords=\"uv\">"
    )?;
    tags.tag("Float64", "Normals", 3, n.points())?;
    tags.tag("Float64", "uv", 2, n.points())?;
    tags.tag("Int64", "point_id", 1, n.points())?;
    for field in &scene.fields {
        tags.tag("Float64", &field.name, 1, n.points())?;
    }
    writeln!(tags.out, "</PointData>\n<CellData Scalars=\"surface\">")?;
    tags.tag("Int32", "surface", 1, n.cells())?;
    writeln!(tags.out, "</CellData>\n<Cells>")?;
    tags.tag("Int64", "connectivity", 1, n.corners())?;
    tags.tag("Int64", "offsets", 1, n.cells())?;
    tags.tag("UInt8", "types", 1, n.cells())?;
    writeln!(tags.out, "</Cells>\n</Piece>\n</UnstructuredGrid>")
}

/// One number of the field data.
fn value(out: &mut dyn Write, kind: &str, name: &str, value: &str) -> io::Result<()> {
    let name = xml(name);
    writeln!(
        out,
        r#"<DataArray type="{kind}" Name="{name}" NumberOfTuples="1" format="ascii">{value}</DataArray>"#
    )
}

type Encoder<'a> = EncoderWriter<'a, GeneralPurpose, &'a mut dyn Write>;

/// One array: the number of its bytes and the bytes, as one piece of base64.
fn block(
    out: &mut dyn Write,
    bytes: usize,
    fill: impl FnOnce(&mut Encoder<'_>) -> io::Result<()>,
) -> io::Result<()> {
    let mut encoder = EncoderWriter::new(out, &STANDARD);
    encoder.write_all(&(bytes as u64).to_le_bytes())?;
    fill(&mut encoder)?;
    encoder.finish().map(|_| ())
}

fn floats(out: &mut Encoder<'_>, values: &[f64]) -> io::Result<()> {
    values
        .iter()
        .try_for_each(|x| out.write_all(&x.to_le_bytes()))
}

fn int(out: &mut Encoder<'_>, i: usize) -> io::Result<()> {
    out.write_all(&(i as i64).to_le_bytes())
}

fn point_blocks(scene: &Scene, n: &Counts, out: &mut dyn Write) -> io::Result<()> {
    let vertices = || scene.patches().flat_map(|(_, p)| &p.vertices);
    let curve_points = || scene.curves.iter().flat_map(|c| &c.points);
    block(out, 24 * n.points(), |out| {
        vertices()
            .try_for_each(|v| floats(out, &scene.mesh.points[v.point as usize].to_array()))?;
        curve_points().try_for_each(|p| floats(out, &p.to_array()))
    })?;
    block(out, 24 * n.points(), |out| {
        vertices().try_for_each(|v| floats(out, &v.normal.to_array()))?;
        curve_points().try_for_each(|_| floats(out, &[0.0; 3]))
    })?;
    block(out, 16 * n.points(), |out| {
        vertices().try_for_each(|v| floats(out, &v.uv))?;
        curve_points().try_for_each(|_| floats(out, &[0.0; 2]))
    })?;
    block(out, 8 * n.points(), |out| {
        vertices().try_for_each(|v| int(out, v.point as usize))?;
        curve_points().try_for_each(|_| out.write_all(&(-1i64).to_le_bytes()))
    })?;
    for field in &scene.fields {
        block(out, 8 * n.points(), |out| {
            scene
                .parts
                .iter()
                .try_for_each(|part| floats(out, &field.values[part.patch]))?;
            curve_points().try_for_each(|_| floats(out, &[f64::NAN]))
        })?;
    }
    Ok(())
}

fn cell_blocks(
    scene: &Scene,
    n: &Counts,
    out: &mut dyn Write,
    mut ticker: Ticker<'_>,
) -> io::Result<()> {
    // The triangles that are written, each with its part and the number of that part's first vertex.
    let triangles = || {
        let mut first = 0;
        scene
            .patches()
            .enumerate()
            .flat_map(move |(part, (_, patch))| {
                let base = first;
                first += patch.vertices.len();
                let sound = |t: &&[u32; 3]| {
                    Tally::default().admit(corners(&scene.mesh, patch, **t), Store::Double)
                };
                patch
                    .triangles
                    .iter()
                    .filter(sound)
                    .map(move |t| (part, base, *t))
            })
    };
    block(out, 4 * n.cells(), |out| {
        triangles().try_for_each(|(part, ..)| out.write_all(&(part as i32).to_le_bytes()))?;
        (0..n.lines).try_for_each(|_| out.write_all(&(-1i32).to_le_bytes()))
    })?;
    block(out, 8 * n.corners(), |out| {
        triangles().try_for_each(|(_, base, t)| {
            ticker.step();
            t.iter().try_for_each(|&i| int(out, base + i as usize))
        })?;
        let mut first = n.vertices;
        scene.curves.iter().try_for_each(|curve| {
            let own = first..first + curve.points.len() - 1;
            first += curve.points.len();
            own.into_iter()
                .try_for_each(|i| int(out, i).and_then(|()| int(out, i + 1)))
        })
    })?;
    block(out, 8 * n.cells(), |out| {
        (1..=n.triangles).try_for_each(|k| int(out, 3 * k))?;
        (1..=n.lines).try_for_each(|k| int(out, 3 * n.triangles + 2 * k))
    })?;
    block(out, n.cells(), |out| {
        (0..n.triangles).try_for_each(|_| out.write_all(&[TRIANGLE]))?;
        (0..n.lines).try_for_each(|_| out.write_all(&[LINE]))
    })
}
