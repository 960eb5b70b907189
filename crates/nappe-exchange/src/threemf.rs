//! 3MF: a zip archive with one XML model.
//!
//! One object holds all surfaces on shared points in full f64, with the scene's unit; every triangle names its
//! surface through a base material of the surface's name and colour. If the surfaces enclose a solid, the object is a
//! `model` and its triangles are turned outward; otherwise it is a `surface`, which slicers show but do not fill.
//! Source: 3MF Consortium, *3D Manufacturing Format, Core Specification* 1.3.

use crate::Output;
use crate::facets::{Store, corners};
use crate::report::{Tally, Ticker};
use crate::scene::Scene;
use crate::solid::shape;
use crate::text::{byte, certainty, number, xml};
use nappe::Units;
use std::io::{self, Write};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

const CONTENT_TYPES: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Types xmlns="http://schemas.openxmlformats.org/package/2006/content-types"><Default Extension="rels" ContentType="application/vnd.openxmlformats-package.relationships+xml"/><Default Extension="model" ContentType="application/vnd.ms-package.3dmanufacturing-3dmodel+xml"/></Types>
"#;

const RELATIONSHIPS: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<Relationships xmlns="http://schemas.openxmlformats.org/package/2006/relationships"><Relationship Target="/3D/3dmodel.model" Id="rel0" Type="http://schemas.microsoft.com/3dmanufacturing/2013/01/3dmodel"/></Relationships>
"#;

/// Triangles above which the model's XML may pass 4 GiB and needs the archive's 64-bit form.
const LARGE: usize = 10_000_000;

pub(crate) fn write(scene: &Scene, out: &mut dyn Output, ticker: Ticker<'_>) -> io::Result<Tally> {
    let mut zip = ZipWriter::new(out);
    // The archive's default time is a constant: same scene, same bytes.
    let options = SimpleFileOptions::default()
        .compression_method(CompressionMethod::Deflated)
        .last_modified_time(zip::DateTime::default())
        .large_file(scene.triangles() > LARGE);
    for (name, text) in [
        ("[Content_Types].xml", CONTENT_TYPES),
        ("_rels/.rels", RELATIONSHIPS),
    ] {
        zip.start_file(name, options)?;
        zip.write_all(text.as_bytes())?;
    }
    zip.start_file("3D/3dmodel.model", options)?;
    let tally = model(scene, &mut io::BufWriter::new(&mut zip), ticker)?;
    zip.finish()?;
    Ok(tally)
}

fn unit(units: Units) -> &'static str {
    match units {
        Units::Millimetre => "millimeter",
        Units::Centimetre => "centimeter",
        Units::Metre => "meter",
        Units::Inch => "inch",
        Units::Foot => "foot",
    }
}

fn model(scene: &Scene, out: &mut dyn Write, mut ticker: Ticker<'_>) -> io::Result<Tally> {
    let mut tally = Tally::default();
    let shape = shape(scene);
    let kind = if shape.is_solid() {
        "model"
    } else {
        let which = match shape.open.len() {
            n if n == scene.parts.len() => "The surfaces".to_owned(),
            n => format!("{n} of {} surfaces", scene.parts.len()),
        };
        tally.notes.push(format!(
            "{which} do not enclose a solid, so the .3mf holds all as a surface: a slicer will not fill it."
        ));
        "surface"
    };
    let title = scene.title.as_deref().unwrap_or("nappe");
    writeln!(out, r#"<?xml version="1.0" encoding="UTF-8"?>"#)?;
    writeln!(
        out,
        r#"<model unit="{}" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02">"#,
        unit(scene.units)
    )?;
    writeln!(out, r#"<metadata name="Title">{}</metadata>"#, xml(title))?;
    writeln!(
        out,
        r#"<metadata name="Application">nappe {}</metadata>"#,
        env!("CARGO_PKG_VERSION")
    )?;
    let deviation = certainty(scene.deviation(), scene.units.symbol());
    writeln!(
        out,
        r#"<metadata name="Description">{deviation}</metadata>"#
    )?;
    writeln!(out, "<resources>\n<basematerials id=\"1\">")?;
    for part in &scene.parts {
        let [r, g, b] = part.colour.map(byte);
        writeln!(
            out,
            r##"<base name="{}" displaycolor="#{r:02X}{g:02X}{b:02X}"/>"##,
            xml(&part.name)
        )?;
    }
    writeln!(out, "</basematerials>")?;
    writeln!(
        out,
        r#"<object id="2" type="{kind}" name="{}" pid="1" pindex="0">"#,
        xml(title)
    )?;
    writeln!(out, "<mesh>\n<vertices>")?;
    for p in &scene.mesh.points {
        writeln!(
            out,
            r#"<vertex x="{}" y="{}" z="{}"/>"#,
            number(p.x),
            number(p.y),
            number(p.z)
        )?;
    }
    writeln!(out, "</vertices>\n<triangles>")?;
    for (index, (_, patch)) in scene.patches().enumerate() {
        for &t in &patch.triangles {
            ticker.step();
            if !tally.admit(corners(&scene.mesh, patch, t), Store::Double) {
                continue;
            }
            let [a, mut b, mut c] = t.map(|i| patch.vertices[i as usize].point);
            if shape.turn[index] {
                std::mem::swap(&mut b, &mut c);
            }
            writeln!(
                out,
                r#"<triangle v1="{a}" v2="{b}" v3="{c}" pid="1" p1="{index}"/>"#
            )?;
        }
    }
    writeln!(out, "</triangles>\n</mesh>\n</object>\n</resources>")?;
    writeln!(out, "<build><item objectid=\"2\"/></build>\n</model>")?;
    tally.notes.extend(shape.notes());
    if !scene.curves.is_empty() {
        tally.notes.push(format!(
            "The {} curves were left out: a .3mf file has no place for them.",
            scene.curves.len()
        ));
    }
    out.flush()?;
    Ok(tally)
}
