//! One function for all formats.

use crate::atomic::write_atomically;
use crate::error::ExchangeError;
use crate::format::Format;
use crate::iges::{self, IgesOptions};
use crate::render::Picture;
use crate::report::{Tally, Ticker, WriteOptions, WriteReport};
use crate::scene::Scene;
use crate::step::{self, StepOptions};
use crate::{gltf, json, obj, ply, stl, threemf, vtu};
use nappe::mesh::Certainty;
use std::io::{Seek, Write};
use std::path::Path;

/// Where writers write: archives go back to fill in sizes.
pub(crate) trait Output: Write + Seek {}

impl<T: Write + Seek> Output for T {}

/// Writes a scene to a file of the format that its ending names. An existing file is replaced only when the new one is
/// whole.
///
/// # Errors
/// [`ExchangeError`]: a scene that is not valid or has nothing for this format, or a file that cannot be written.
pub fn write(
    path: &Path,
    scene: &Scene,
    options: &WriteOptions<'_>,
) -> Result<WriteReport, ExchangeError> {
    let format = Format::from_path(path)?;
    scene.validate().map_err(|source| ExchangeError::Scene {
        path: path.to_owned(),
        source,
    })?;
    if format.is_mesh() && scene.triangles() == 0 {
        return Err(ExchangeError::Nothing {
            path: path.to_owned(),
            what: "triangles",
        });
    }
    if format == Format::Json && scene.exact.is_empty() {
        return Err(ExchangeError::Nothing {
            path: path.to_owned(),
            what: "exact curves or surfaces",
        });
    }
    if format.is_exact() {
        return exact(path, format, scene, options);
    }
    check_limits(path, format, scene)?;
    if matches!(format, Format::Png | Format::Svg) {
        return Picture::new(scene, options.picture.clone()).write(path, options.progress);
    }
    let tally = write_atomically(path, |out| {
        let ticker = Ticker::new(options.progress, scene.triangles());
        match format {
            Format::Glb => gltf::write_binary(scene, out, ticker),
            Format::Gltf => gltf::write_text(scene, out, ticker),
            Format::Stl => stl::write(scene, out, ticker),
            Format::Obj => obj::write(scene, out, ticker),
            Format::Ply => ply::write(scene, out, ticker),
            Format::ThreeMf => threemf::write(scene, out, ticker),
            Format::Json => json::write(scene, out),
            _ => vtu::write(scene, out, ticker),
        }
    })?;
    options.progress.tell(1.0);
    Ok(report(path, format, scene, tally))
}

/// How far stand-ins for what has no exact form may be, metres, if nothing is said.
const CLOSE: f64 = 1e-6;

/// A file of exact shapes.
fn exact(
    path: &Path,
    format: Format,
    scene: &Scene,
    options: &WriteOptions<'_>,
) -> Result<WriteReport, ExchangeError> {
    let close = CLOSE / scene.document.units.metres();
    let tolerance = options.tolerance.unwrap_or(close);
    let (approximated, certainty) = if format == Format::Iges {
        let trimmed = true;
        let iges = IgesOptions { tolerance, trimmed };
        let written = iges::write_telling(path, &scene.document, &iges, options.progress)?;
        (written.approximated, written.certainty)
    } else {
        let step = StepOptions {
            schema: options.schema,
            tolerance,
        };
        let written = step::write_telling(path, &scene.document, &step, options.progress)?;
        (written.approximated, written.certainty)
    };
    options.progress.tell(1.0);
    let mut notes = Vec::new();
    if approximated > 0 {
        notes.push(format!(
            "{} surfaces have no exact form that the format holds and are approximated.",
            approximated
        ));
    }
    Ok(WriteReport {
        path: path.to_owned(),
        format,
        bytes: std::fs::metadata(path).map_or(0, |m| m.len()),
        triangles: 0,
        dropped_degenerate: 0,
        kept_slivers: 0,
        rounding: 0.0,
        deviation: certainty,
        notes,
    })
}

/// The counters of STL and GLB have 32 bits.
fn check_limits(path: &Path, format: Format, scene: &Scene) -> Result<(), ExchangeError> {
    let (what, count) = match format {
        Format::Stl => ("triangles", scene.triangles() as u64),
        Format::Glb => ("bytes", gltf::buffer_bound(scene)),
        _ => return Ok(()),
    };
    let limit = u64::from(u32::MAX) - HEADER_ROOM;
    if count > limit {
        return Err(ExchangeError::TooLarge {
            path: path.to_owned(),
            format,
            what,
            count,
            limit,
        });
    }
    Ok(())
}

/// Room left below the limit for the description in front of the numbers.
const HEADER_ROOM: u64 = 1 << 24;

pub(crate) fn report(path: &Path, format: Format, scene: &Scene, tally: Tally) -> WriteReport {
    let mut notes = tally.notes;
    let (mesh, unit) = (scene.deviation(), scene.units.symbol());
    let total = mesh.error() + tally.rounding;
    let deviation = match mesh {
        Certainty::Exact if tally.rounding == 0.0 => Certainty::Exact,
        Certainty::Exact | Certainty::Bounded(_) => Certainty::Bounded(total),
        Certainty::Estimated(_) => Certainty::Estimated(total),
    };
    if tally.rounding > mesh.error() && tally.rounding > 0.0 {
        notes.push(format!(
            "Rounding to the f32 numbers of {format} moves points by up to {:.3e} {unit}, more than the mesh's deviation \
             of {:.3e} {unit}; .obj, .ply, .3mf and .vtu keep f64.",
            tally.rounding,
            mesh.error()
        ));
    }
    if tally.dropped > 0 {
        notes.push(format!(
            "{} triangles were left out because two of their corners are the same number in the file; the mesh stays \
             watertight.",
            tally.dropped
        ));
    }
    if tally.slivers > 0 {
        notes.push(format!("{} triangles have their corners on one line, as stored; they keep the mesh watertight.", tally.slivers));
    }
    WriteReport {
        path: path.to_owned(),
        format,
        bytes: std::fs::metadata(path).map_or(0, |m| m.len()),
        triangles: tally.triangles,
        dropped_degenerate: tally.dropped,
        kept_slivers: tally.slivers,
        rounding: tally.rounding,
        deviation,
        notes,
    }
}
