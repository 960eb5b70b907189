//! Curves and surfaces of files of other systems.
//!
//! This crate knows no such format. Whoever loads a model hands in an [`Importer`] that reads files; what a file holds,
//! which of it a model can take, and its unit are then data like any other.

use crate::build::{Builder, Built, Patch, Stop};
use crate::data::{Datum, Object};
use nappe::curve::{self, CurveRef};
use nappe::expr::nearest;
use nappe::surface::{SurfaceRef, Swapped, Transformed};
use nappe::{DAffine3, DVec3, Units};
use std::fmt::Debug;
use std::sync::Arc;

/// Reads files of other systems for the kind `import`.
pub trait Importer: Debug + Send + Sync {
    /// The shapes in a file, named as the model names it: relative to the model. The same file may be asked for many
    /// times. The error is a sentence that names the file.
    fn import(&self, file: &str) -> Result<Arc<Imported>, String>;
}

/// What a file of another system holds.
#[derive(Clone, Debug, Default)]
pub struct Imported {
    /// The unit of its coordinates. The model takes them in its own.
    pub units: Units,
    /// Its faces, numbered from 1 in this order.
    pub faces: Vec<ImportedFace>,
    /// Its curves, numbered from 1 in this order.
    pub curves: Vec<ImportedCurve>,
}

/// A face in a file.
#[derive(Clone, Debug)]
pub struct ImportedFace {
    /// Its name, `item/face`; the last part is enough to name it where it is the only one. Empty if it has none.
    pub name: String,
    /// The whole surface on which it lies.
    pub surface: SurfaceRef,
    /// Whether it has the normal of its surface, and not the opposite.
    pub forward: bool,
    /// Whether it is the whole surface: its loops are the sides of it.
    pub whole: bool,
}

/// A curve in a file.
#[derive(Clone, Debug)]
pub struct ImportedCurve {
    /// Its name; empty if it has none.
    pub name: String,
    /// The curve.
    pub curve: CurveRef,
}

/// What a model needs for its imports.
#[derive(Clone, Debug, Default)]
pub(crate) struct Imports {
    /// `None`: files are not read.
    pub(crate) importer: Option<Arc<dyn Importer>>,
    /// The unit of the model.
    pub(crate) units: Units,
}

/// Names listed in a message: more would hide what is said.
const MOST_NAMES: usize = 12;

impl Builder<'_> {
    /// The surface of a face.
    pub(crate) fn imported_surface(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let (file, imported) = self.imported(o)?;
        let names: Vec<&str> = imported.faces.iter().map(|f| f.name.as_str()).collect();
        let face = &imported.faces[self.chosen(o, "face", &file, &names)?];
        if !face.whole && !o.fields.flag("untrimmed") {
            let message = format!(
                "the face is a part of its surface, cut out along its edges in {file}; surfaces of a model are whole"
            );
            let help = "set untrimmed = true to take the whole surface, or `nappe convert` the file to a mesh";
            return Err(self.refuse(o, ("face", &[]), message, help));
        }
        let mut surface = face.surface.clone();
        if !face.forward {
            surface = Arc::new(Swapped::new(surface));
        }
        if let Some(map) = self.scaling(&imported) {
            let scaled = Transformed::new(surface, map);
            surface = Arc::new(scaled.map_err(|e| self.refuse(o, ("file", &[]), e, UNIT))?);
        }
        Ok(Patch::one(surface))
    }

    /// A curve of a file.
    pub(crate) fn imported_curve(&mut self, o: &Object) -> Built<CurveRef> {
        let (file, imported) = self.imported(o)?;
        let names: Vec<&str> = imported.curves.iter().map(|c| c.name.as_str()).collect();
        let found = self.chosen(o, "curve", &file, &names)?;
        let curve = imported.curves[found].curve.clone();
        match self.scaling(&imported) {
            None => Ok(curve),
            Some(map) => match curve::Transformed::new(curve, map) {
                Ok(scaled) => Ok(Arc::new(scaled)),
                Err(e) => Err(self.refuse(o, ("file", &[]), e, UNIT)),
            },
        }
    }

    /// The name of the file and what it holds.
    fn imported(&mut self, o: &Object) -> Built<(String, Arc<Imported>)> {
        let file = o.fields.text("file").ok_or(Stop::Reported)?.to_owned();
        let Some(importer) = self.imports.importer.clone() else {
            let message = "files of other systems are not read here";
            let help = "load the model with something that reads them, as the command `nappe` does";
            return Err(self.refuse(o, ("file", &[]), message, help));
        };
        match importer.import(&file) {
            Ok(imported) => Ok((file, imported)),
            Err(e) => {
                let help = "the path is relative to the model's file; `nappe info` tells what a file holds";
                Err(self.refuse(o, ("file", &[]), e, help))
            }
        }
    }

    /// From the unit of a file to that of the model; `None` if they are the same.
    fn scaling(&self, imported: &Imported) -> Option<DAffine3> {
        let (from, to) = (imported.units, self.imports.units);
        (from != to).then(|| DAffine3::from_scale(DVec3::splat(from.metres() / to.metres())))
    }

    /// The index of what a key names by its name or its number; the only one if the key is not given.
    fn chosen(&mut self, o: &Object, key: &str, file: &str, names: &[&str]) -> Built<usize> {
        let (message, help) = match o.fields.get(key).map(|i| &i.datum) {
            None if names.len() == 1 => return Ok(0),
            None => (
                format!("{file} holds {} {key}s; which is meant?", names.len()),
                format!("set `{key}`: {}", there(key, names)),
            ),
            Some(Datum::Number(x)) if (1.0..=names.len() as f64).contains(x) => {
                return Ok(*x as usize - 1);
            }
            Some(Datum::Number(x)) => {
                let message = format!("{file} has no {key} {x}: it holds {}", names.len());
                (message, there(key, names))
            }
            Some(Datum::Text(name)) => {
                let last = |n: &str| n.rsplit('/').next() == Some(name);
                let all = 0..names.len();
                let mut found: Vec<usize> = all.clone().filter(|&i| names[i] == *name).collect();
                if found.is_empty() {
                    found = all.filter(|&i| last(names[i])).collect();
                }
                match found.as_slice() {
                    [one] => return Ok(*one),
                    [] => {
                        let help = match nearest(name, names.iter().copied()) {
                            Some(near) => format!("did you mean \"{near}\"?"),
                            None => there(key, names),
                        };
                        (format!("{file} has no {key} \"{name}\""), help)
                    }
                    several => {
                        let numbers = several.iter().take(MOST_NAMES);
                        let numbers: Vec<String> = numbers.map(|i| (i + 1).to_string()).collect();
                        let count = several.len();
                        (
                            format!("{file} has {count} {key}s \"{name}\""),
                            format!("name one by its number: {}", numbers.join(", ")),
                        )
                    }
                }
            }
            Some(_) => return Err(Stop::Reported),
        };
        Err(self.refuse(o, (key, &[]), message, help))
    }
}

const UNIT: &str = "use another unit for the model or the file";

/// What a file holds, in words.
fn there(key: &str, names: &[&str]) -> String {
    if names.is_empty() {
        return format!("it has no {key}s at all");
    }
    let shown = names.iter().enumerate().take(MOST_NAMES);
    let shown = shown.map(|(i, n)| match *n {
        "" => (i + 1).to_string(),
        name => format!("{} \"{name}\"", i + 1),
    });
    let mut text = format!("its {key}s are {}", shown.collect::<Vec<_>>().join(", "));
    if names.len() > MOST_NAMES {
        text.push_str(&format!(", … ({} in all)", names.len()));
    }
    text
}
