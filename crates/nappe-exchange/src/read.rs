//! Files that are read.
//!
//! [`read()`] takes a file by its ending and says what it holds: triangles, or exact shapes. Whatever is in the file, reading ends with a
//! result or with a [`ReadError`] that says where; memory stays in proportion to the file's size.

mod bpt;
mod brep;
#[cfg(test)]
mod exact_tests;
mod gismo;
mod gltf;
mod obj;
mod ply;
mod polygon;
mod sheet;
mod stl;
mod table;
#[cfg(test)]
mod tests;
mod threemf;
mod weld;
mod words;

use crate::document::Document;
use crate::iges;
use crate::report::Progress;
use crate::triangles::TriangleMesh;
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// What a file holds.
#[derive(Clone, Debug)]
pub enum Read {
    /// Exact geometry.
    Document(Document),
    /// Triangles.
    Mesh(TriangleMesh),
}

/// A file could not be read.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file's ending names no format that can be read.
    #[error("{}: {}; what can be read: {}", path.display(), if ending.is_empty() { "the name has no ending".into() } else { format!("files with the ending .{ending} cannot be read") }, endings())]
    UnknownEnding {
        /// The file.
        path: PathBuf,
        /// Its ending, without the dot; empty if it has none.
        ending: String,
    },
    /// The system refused.
    #[error("{}: could not read: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's reason.
        source: io::Error,
    },
    /// The file is not what its format asks for.
    #[error("{}: {fault}", path.display())]
    Fault {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        fault: Fault,
    },
}

/// What is wrong in a file, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{at}{what}")]
pub struct Fault {
    /// Where.
    pub at: Place,
    /// What is wrong there, and what should be.
    pub what: String,
}

/// A place in a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// All of it.
    Whole,
    /// A line, counted from 1.
    Line(usize),
    /// A byte, counted from 0.
    Byte(usize),
    /// Something that the file itself numbers or names: `D45`, `accessor 3`.
    Part(String),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Whole => Ok(()),
            Place::Line(n) => write!(f, "line {n}: "),
            Place::Byte(n) => write!(f, "byte {n}: "),
            Place::Part(name) => write!(f, "{name}: "),
        }
    }
}

impl Fault {
    pub(crate) fn new(at: Place, what: impl Into<String>) -> Fault {
        let what = what.into();
        Fault { at, what }
    }

    pub(crate) fn whole(what: impl Into<String>) -> Fault {
        Fault::new(Place::Whole, what)
    }

    pub(crate) fn line(line: usize, what: impl Into<String>) -> Fault {
        Fault::new(Place::Line(line), what)
    }

    pub(crate) fn byte(byte: usize, what: impl Into<String>) -> Fault {
        Fault::new(Place::Byte(byte), what)
    }

    pub(crate) fn part(part: impl Into<String>, what: impl Into<String>) -> Fault {
        Fault::new(Place::Part(part.into()), what)
    }
}

type ReadBytes = fn(&[u8], &Path, Progress<'_>) -> Result<Read, Fault>;

/// The endings that can be read, and what reads them.
const READERS: [(&str, ReadBytes); 15] = [
    ("igs", |b, _, p| iges::read(b, p).map(Read::Document)),
    ("iges", |b, _, p| iges::read(b, p).map(Read::Document)),
    ("stl", |b, _, _| stl::read(b).map(Read::Mesh)),
    ("obj", |b, _, _| obj::read(b).map(Read::Mesh)),
    ("ply", |b, _, _| ply::read(b).map(Read::Mesh)),
    ("glb", |b, p, _| gltf::read(b, p.parent()).map(Read::Mesh)),
    ("gltf", |b, p, _| gltf::read(b, p.parent()).map(Read::Mesh)),
    ("3mf", |b, _, _| threemf::read(b).map(Read::Mesh)),
    ("step", |b, _, p| step(b, p)),
    ("stp", |b, _, p| step(b, p)),
    ("brep", |b, _, _| brep::read(b).map(Read::Document)),
    ("xml", |b, _, _| gismo::read(b).map(Read::Document)),
    ("bpt", |b, _, _| bpt::read(b).map(Read::Document)),
    ("dat", |b, _, _| table::read(b).map(Read::Document)),
    ("cpt", |b, _, _| {
        table::control_points(b).map(Read::Document)
    }),
];

fn step(bytes: &[u8], progress: Progress<'_>) -> Result<Read, Fault> {
    let file =
        crate::step::read_telling(bytes, progress).map_err(|e| Fault::whole(e.to_string()))?;
    Ok(Read::Document(file.document))
}

/// All endings that can be read, as a list for messages: `.stl .obj …`.
pub fn endings() -> String {
    READERS.map(|r| format!(".{}", r.0)).join(" ")
}

/// Whether a file's ending names a format that can be read.
pub fn can_read(path: &Path) -> bool {
    let ending = ending(path);
    READERS.iter().any(|r| r.0 == ending)
}

fn ending(path: &Path) -> String {
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    ending.unwrap_or_default()
}

/// Reads a file of the format that its ending names, in either case of letters.
///
/// # Errors
/// [`ReadError`]: an unknown ending, a file that cannot be opened, or the place where it is not what its format asks for.
pub fn read(path: &Path) -> Result<Read, ReadError> {
    read_telling(path, Progress::default())
}

/// The same, telling how far it is: STEP and IGES files.
///
/// # Errors
/// As [`read()`].
pub fn read_telling(path: &Path, progress: Progress<'_>) -> Result<Read, ReadError> {
    let ending = ending(path);
    let path = path.to_owned();
    let Some((_, reader)) = READERS.iter().find(|r| r.0 == ending) else {
        return Err(ReadError::UnknownEnding { path, ending });
    };
    match fs::read(&path) {
        Err(source) => Err(ReadError::Io { path, source }),
        Ok(bytes) => {
            reader(&bytes, &path, progress).map_err(|fault| ReadError::Fault { path, fault })
        }
    }
}

/// Reads the bytes of a file as the format that an ending names. A `.gltf` that keeps its numbers in other files is
/// refused.
///
/// # Errors
/// The place where the bytes are not what the format asks for, or that the ending is unknown.
pub fn read_bytes(ending: &str, bytes: &[u8]) -> Result<Read, Fault> {
    let reader = READERS.iter().find(|r| r.0 == ending);
    let (_, reader) = reader.ok_or_else(|| {
        Fault::whole(format!(
            "files with the ending .{ending} cannot be read; what can be read: {}",
            endings()
        ))
    })?;
    reader(bytes, Path::new(""), Progress::default())
}

/// More triangles or points have numbers that do not fit 32 bits, with room for a mark.
const MOST: usize = u32::MAX as usize - 1;

/// How many triangles a file of a size may unfold to: formats that place one mesh many times could otherwise fill the
/// memory from a few bytes.
fn most_triangles(bytes: usize) -> usize {
    bytes
        .saturating_mul(16)
        .saturating_add(1 << 20)
        .min(1 << 28)
}

/// A finite number from text.
fn number(text: &str) -> Option<f64> {
    text.parse::<f64>().ok().filter(|x| x.is_finite())
}

/// Text as a message shows it: on one line, not too long.
fn shown(text: &str) -> String {
    const MOST: usize = 40;
    let mut s: String = text.chars().take(MOST).collect();
    if text.chars().nth(MOST).is_some() {
        s.push('…');
    }
    crate::text::line(&s)
}

/// A net listed with the first parameter running fastest, as the kernel has it: the second one runs fastest.
fn net<T: Copy>(listed: &[T], [rows, columns]: [usize; 2]) -> Vec<T> {
    let at = |k: usize| listed[k % columns * rows + k / columns];
    (0..rows * columns).map(at).collect()
}
