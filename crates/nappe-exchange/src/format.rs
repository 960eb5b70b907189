//! The formats and their endings.

use crate::error::ExchangeError;
use std::fmt;
use std::path::Path;

/// A file format that can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// Binary glTF 2.0: mesh, colours, names, curves.
    Glb,
    /// glTF 2.0 as text with the numbers embedded.
    Gltf,
    /// Binary STL: triangles only.
    Stl,
    /// Wavefront OBJ: shared points, normals, parameters, names, curves.
    Obj,
    /// Binary PLY: shared points, normals, parameters of each corner.
    Ply,
    /// 3D Manufacturing Format: a solid for printing, with units, names and colours.
    ThreeMf,
    /// VTK unstructured grid: mesh and all numbers at its vertices.
    Vtu,
    /// The exact NURBS curves and surfaces.
    Json,
    /// STEP, ISO 10303-21: exact surfaces as bodies. Also `.stp`.
    Step,
    /// IGES 5.3: exact NURBS surfaces, trimmed or as bodies. Also `.iges`.
    Iges,
    /// A picture of pixels.
    Png,
    /// A picture of vectors.
    Svg,
}

impl Format {
    /// All formats.
    pub const ALL: [Format; 12] = [
        Format::Glb,
        Format::Gltf,
        Format::Stl,
        Format::Obj,
        Format::Ply,
        Format::ThreeMf,
        Format::Vtu,
        Format::Json,
        Format::Step,
        Format::Iges,
        Format::Png,
        Format::Svg,
    ];

    /// The ending, without the dot.
    pub fn ending(self) -> &'static str {
        match self {
            Format::Glb => "glb",
            Format::Gltf => "gltf",
            Format::Stl => "stl",
            Format::Obj => "obj",
            Format::Ply => "ply",
            Format::ThreeMf => "3mf",
            Format::Vtu => "vtu",
            Format::Json => "json",
            Format::Step => "step",
            Format::Iges => "igs",
            Format::Png => "png",
            Format::Svg => "svg",
        }
    }

    /// Whether it holds exact shapes as bodies.
    pub fn is_exact(self) -> bool {
        matches!(self, Format::Step | Format::Iges)
    }

    /// Another ending of the format.
    fn other_ending(self) -> Option<&'static str> {
        match self {
            Format::Step => Some("stp"),
            Format::Iges => Some("iges"),
            _ => None,
        }
    }

    /// Whether it holds a mesh, as opposed to exact geometry or a picture.
    pub fn is_mesh(self) -> bool {
        !matches!(
            self,
            Format::Json | Format::Step | Format::Iges | Format::Png | Format::Svg
        )
    }

    /// All endings as a list for messages: `.glb .gltf …`.
    pub fn endings() -> String {
        Format::ALL.map(|f| format!(".{}", f.ending())).join(" ")
    }

    /// The format that a file's ending names, in either case of letters.
    ///
    /// # Errors
    /// [`ExchangeError::UnknownEnding`], with the nearest known ending.
    pub fn from_path(path: &Path) -> Result<Format, ExchangeError> {
        let ending = path
            .extension()
            .map(|e| e.to_string_lossy().to_lowercase())
            .unwrap_or_default();
        Format::ALL
            .into_iter()
            .find(|f| f.ending() == ending || f.other_ending() == Some(&ending))
            .ok_or_else(|| ExchangeError::UnknownEnding {
                path: path.to_owned(),
                nearest: nearest(&ending),
                ending,
            })
    }
}

impl fmt::Display for Format {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, ".{}", self.ending())
    }
}

fn nearest(ending: &str) -> Option<Format> {
    let (distance, format) = Format::ALL
        .into_iter()
        .map(|f| (edits(ending, f.ending()), f))
        .min_by_key(|c| c.0)?;
    // More edits than half the letters is another word, not a slip.
    (2 * distance <= ending.chars().count().max(2)).then_some(format)
}

/// The number of letters to insert, remove, replace or exchange with their neighbour to make one word of the other
/// (optimal string alignment distance).
fn edits(a: &str, b: &str) -> usize {
    let (a, b): (Vec<char>, Vec<char>) = (a.chars().collect(), b.chars().collect());
    let mut d = vec![vec![0; b.len() + 1]; a.len() + 1];
    for i in 0..=a.len() {
        for j in 0..=b.len() {
            d[i][j] = if i == 0 || j == 0 {
                i + j
            } else {
                let replaced = d[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
                let mut best = replaced.min(d[i - 1][j] + 1).min(d[i][j - 1] + 1);
                if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                    best = best.min(d[i - 2][j - 2] + 1);
                }
                best
            };
        }
    }
    d[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn endings_are_found_in_either_case() {
        for f in Format::ALL {
            let upper = format!("a.b/x.{}", f.ending().to_uppercase());
            assert_eq!(Format::from_path(Path::new(&upper)).unwrap(), f);
        }
    }

    #[test]
    fn a_slip_is_answered_with_the_nearest_ending() {
        for (slip, meant) in [
            ("slt", Format::Stl),
            ("gbl", Format::Glb),
            ("pgn", Format::Png),
            ("jsn", Format::Json),
        ] {
            match Format::from_path(Path::new(&format!("x.{slip}"))) {
                Err(ExchangeError::UnknownEnding {
                    ending, nearest, ..
                }) => {
                    assert_eq!((ending.as_str(), nearest), (slip, Some(meant)));
                }
                other => panic!("{other:?}"),
            }
        }
        for far in ["x.docx", "x"] {
            let e = Format::from_path(Path::new(far)).unwrap_err();
            assert!(
                matches!(e, ExchangeError::UnknownEnding { nearest: None, .. }),
                "{e}"
            );
            assert!(
                e.to_string()
                    .contains(".glb .gltf .stl .obj .ply .3mf .vtu .json .step .igs .png .svg"),
                "{e}"
            );
        }
    }
}
