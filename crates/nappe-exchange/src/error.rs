//! What can go wrong.

use crate::format::Format;
use glam::DVec3;
use std::path::PathBuf;

/// A file could not be written.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ExchangeError {
    /// The file's ending names no format that can be written.
    #[error("{}: {}; known endings: {}{}", path.display(), ending_text(ending), Format::endings(), nearest_text(*nearest))]
    UnknownEnding {
        /// The file.
        path: PathBuf,
        /// Its ending, without the dot; empty if it has none.
        ending: String,
        /// The known format that is spelled most like it.
        nearest: Option<Format>,
    },
    /// The directory the file would be in does not exist.
    #[error("{}: the directory {} does not exist; make it first or choose another", path.display(), directory.display())]
    NoDirectory {
        /// The file.
        path: PathBuf,
        /// The missing directory.
        directory: PathBuf,
    },
    /// What should be the directory of the file is something else.
    #[error("{}: {} is not a directory; choose another name", path.display(), directory.display())]
    NotADirectory {
        /// The file.
        path: PathBuf,
        /// What is no directory.
        directory: PathBuf,
    },
    /// The path names a directory, a device or a pipe, which cannot be replaced by a file.
    #[error("{}: is {what}, not a file that can be replaced; choose another name", path.display())]
    NotAFile {
        /// The path.
        path: PathBuf,
        /// What it is.
        what: &'static str,
    },
    /// The system refused. The old file, if there was one, is as it was.
    #[error("{}: could not {action}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What was attempted.
        action: &'static str,
        /// The system's reason.
        source: std::io::Error,
    },
    /// The scene cannot be written to any format.
    #[error("{}: {source}", path.display())]
    Scene {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        source: SceneError,
    },
    /// The scene has none of what the format holds.
    #[error("{}: there is nothing to write: the scene has no {what}", path.display())]
    Nothing {
        /// The file.
        path: PathBuf,
        /// What the format holds.
        what: &'static str,
    },
    /// A shape cannot be written.
    #[error("{}: {why}", path.display())]
    Shape {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        why: String,
    },
    /// The format's counters are too narrow for the scene.
    #[error("{}: {count} {what} are more than the {limit} that a {format} file can hold; use a larger tolerance or another format", path.display())]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// The format.
        format: Format,
        /// What there is too much of.
        what: &'static str,
        /// How much there is.
        count: u64,
        /// How much there can be.
        limit: u64,
    },
    /// A picture cannot be drawn as asked.
    #[error("{}: {source}", path.display())]
    Picture {
        /// The file.
        path: PathBuf,
        /// What is wrong with the request.
        source: PictureError,
    },
}

/// A scene whose parts do not fit each other, or with numbers that cannot be written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages name every field
pub enum SceneError {
    #[error("part `{part}` is patch {patch}, but the mesh has {patches} patches")]
    NoPatch {
        part: String,
        patch: usize,
        patches: usize,
    },
    #[error("vertex {vertex} of `{part}` is at point {point}, but the mesh has {points} points")]
    NoPoint {
        part: String,
        vertex: usize,
        point: u32,
        points: usize,
    },
    #[error(
        "triangle {triangle} of `{part}` has the vertex {vertex}, but the part has {vertices} vertices"
    )]
    NoVertex {
        part: String,
        triangle: usize,
        vertex: u32,
        vertices: usize,
    },
    #[error("mesh point {index} is {point}, not finite")]
    PointNotFinite { index: usize, point: DVec3 },
    #[error("the normal at vertex {vertex} of `{part}` is {normal}, not a unit vector")]
    Normal {
        part: String,
        vertex: usize,
        normal: DVec3,
    },
    #[error("the parameters at vertex {vertex} of `{part}` are {uv:?}, not finite")]
    Parameters {
        part: String,
        vertex: usize,
        uv: [f64; 2],
    },
    #[error("curve `{curve}` has {points} points; a polyline needs two or more")]
    ShortCurve { curve: String, points: usize },
    #[error("point {index} of curve `{curve}` is {point}, not finite")]
    CurveNotFinite {
        curve: String,
        index: usize,
        point: DVec3,
    },
    #[error("the field `{field}` has {values} values for `{part}`, which has {vertices} vertices")]
    FieldLength {
        field: String,
        part: String,
        values: usize,
        vertices: usize,
    },
    #[error(
        "point {index} of the NURBS form of `{name}` is {point} with the weight {weight}, not finite"
    )]
    ExactNotFinite {
        name: String,
        index: usize,
        point: DVec3,
        weight: f64,
    },
}

/// A picture that cannot be drawn as asked.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs)] // the messages name every field
pub enum PictureError {
    #[error(
        "a picture of {width} × {height} pixels was asked for; each side can be from 16 to {limit}"
    )]
    Size { width: u32, height: u32, limit: u32 },
    #[error("the field {index} was asked for, but the scene has {fields}")]
    NoField { index: usize, fields: usize },
    #[error("the field of view is {degrees}°; it can be from 1° to 120°")]
    FieldOfView { degrees: f64 },
    #[error("{what} is {value}, not a finite number from {least} to {greatest}")]
    Range {
        what: &'static str,
        value: f64,
        least: f64,
        greatest: f64,
    },
    #[error(
        "the net `{net}` has {points} points, which is not a multiple of its {columns} columns"
    )]
    Net {
        net: String,
        points: usize,
        columns: usize,
    },
    #[error("point {index} of the line `{line}` is {point}, not finite")]
    LineNotFinite {
        line: String,
        index: usize,
        point: DVec3,
    },
    #[error("dot {index} is at {point}, not finite")]
    DotNotFinite { index: usize, point: DVec3 },
    #[error("unknown view `{text}`; known: {known}, or `azimuth,elevation` in degrees")]
    View { text: String, known: &'static str },
}

fn ending_text(ending: &str) -> String {
    if ending.is_empty() {
        "the name has no ending".into()
    } else {
        format!("the ending .{ending} is not known")
    }
}

fn nearest_text(nearest: Option<Format>) -> String {
    nearest.map_or(String::new(), |f| {
        format!("; did you mean .{}?", f.ending())
    })
}
