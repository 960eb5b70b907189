//! STEP files in.

mod ahead;
mod bodies;
mod cover;
mod curves;
mod faces;
mod file;
mod left;
mod place;
mod products;
mod scan;
mod splines;
mod styles;
mod surfaces;
mod sweep;
mod text;
mod units;
mod value;

pub(crate) use curves::Course;

use super::StepError;
use crate::document::Lost;
use crate::report::Progress;
use crate::{Colour, Document, Item, ItemForm};
use bodies::{Job, Next, Source, WAITING};
use file::{File, Got, Refused};
use left::{Left, lost_with};
use nappe::Units;
use nappe::parallel;
use place::Space;
use products::{Placed, Tree};
use std::collections::{HashMap, HashSet};

/// What was read.
#[derive(Clone, Debug, Default)]
pub struct StepFile {
    /// The shapes.
    pub document: Document,
    /// The standard that the file says it follows: `AUTOMOTIVE_DESIGN`.
    pub schema: String,
    /// The number of entities.
    pub entities: usize,
    /// How often each keyword occurs, the most frequent first.
    pub kinds: Vec<(String, usize)>,
}

/// Bodies: where no representation that is shown has one, that is told.
const BODIES: [&str; 5] = [
    "MANIFOLD_SOLID_BREP",
    "FACETED_BREP",
    "BREP_WITH_VOIDS",
    "SHELL_BASED_SURFACE_MODEL",
    "FACE_BASED_SURFACE_MODEL",
];
/// Items inside items are followed so far.
const DEPTH: usize = 32;
/// More items than this, placed ones counted as often as they are placed, are not read.
const MOST: usize = 10_000_000;

/// Reads a file from its bytes.
///
/// Shapes are read in the file's own unit if that is one of [`Units`], else in the nearest one. What is not understood, or
/// is wrong in one place only, is listed in [`Document::left_out`]. Cost: one pass over the bytes, then each entity that a
/// shape needs; the bytes stay in memory while that is done, with 28 bytes an entity.
///
/// # Errors
/// [`StepError`]: no STEP file, one that is cut off, or two entities of one number.
pub fn read(bytes: &[u8]) -> Result<StepFile, StepError> {
    read_telling(bytes, Progress::default())
}

/// The same, telling how far it is.
pub(crate) fn read_telling(bytes: &[u8], progress: Progress<'_>) -> Result<StepFile, StepError> {
    read_on(bytes, parallel::all_threads(), progress)
}

/// The same on so many threads, on which the result does not depend.
fn read_on(bytes: &[u8], threads: usize, progress: Progress<'_>) -> Result<StepFile, StepError> {
    let file = File::new(bytes, threads, progress)?;
    let mut left = Left::default();
    let mut tree = Tree::new(&file, Units::default(), &mut left);
    let units = units(&file, &mut tree);
    left = Left::default();
    tree = Tree::new(&file, units, &mut left);
    let placed = tree.laid_out(&mut left);
    let mut reader = Reader {
        file: &file,
        colours: styles::colours(&file, &mut left),
        tree,
        left,
        document: Document {
            units,
            ..Document::default()
        },
        read: HashSet::new(),
        items: 0,
        threads,
        waiting: Vec::new(),
    };
    for p in &placed {
        reader.representation(p, None, 0);
    }
    reader.make();
    reader.unshown();
    for fault in reader.tree.faults() {
        reader.left.tell(&fault);
    }
    reader.document.name = reader
        .tree
        .title()
        .or_else(|| file.header("FILE_NAME"))
        .filter(|n| !n.is_empty());
    reader.document.left_out = reader.left.done();
    let mut kinds: Vec<(String, usize)> = file
        .kinds()
        .iter()
        .map(|k| (k.name.trim_start_matches('(').to_owned(), k.count))
        .collect();
    kinds.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    let schema = file.header("FILE_SCHEMA").unwrap_or_default();
    Ok(StepFile {
        document: reader.document,
        schema: schema.split_whitespace().next().unwrap_or("").to_owned(),
        entities: file.count(),
        kinds,
    })
}

/// The unit of the first representation that states one.
fn units(file: &File<'_>, tree: &mut Tree<'_>) -> Units {
    let kinds = file
        .kinds()
        .iter()
        .filter(|k| k.name.ends_with("REPRESENTATION"));
    let ids: Vec<u64> = kinds.flat_map(|k| file.all(&k.name)).collect();
    ids.into_iter()
        .map(|id| tree.context(id))
        .find(|c| c.stated)
        .unwrap_or_default()
        .nearest()
}

struct Reader<'a> {
    file: &'a File<'a>,
    colours: HashMap<u64, Colour>,
    tree: Tree<'a>,
    left: Left,
    document: Document,
    /// Items that were read.
    read: HashSet<u64>,
    /// How many items were looked at.
    items: usize,
    threads: usize,
    /// What the document is to have next.
    waiting: Vec<Next<'a>>,
}

impl<'a> Reader<'a> {
    /// Takes what the document has next.
    fn push(&mut self, next: Next<'a>) {
        self.waiting.push(next);
        if self.waiting.len() >= WAITING {
            self.make();
        }
    }

    fn leave(&mut self, refused: Refused) {
        self.push(Next::Left(refused, Lost::Geometry));
    }

    /// Makes all that waits.
    fn make(&mut self) {
        let waiting = std::mem::take(&mut self.waiting);
        let items = &mut self.document.items;
        bodies::make(
            self.file,
            &self.colours,
            self.threads,
            waiting,
            items,
            &mut self.left,
        );
    }

    /// All items of a placed representation.
    fn representation(&mut self, placed: &Placed, colour: Option<Colour>, depth: usize) {
        let space = self.tree.space_of(placed);
        let items = self
            .file
            .record(placed.id)
            .and_then(|r| r.args().references(1));
        let items = match items {
            Ok(items) => items,
            Err(r) => return self.leave(r),
        };
        let colour = self.colours.get(&placed.id).copied().or(colour);
        for id in items {
            if self.items > MOST {
                return;
            }
            if placed.orphan && !self.read.insert(id) {
                continue;
            }
            self.read.insert(id);
            if let Err(r) = self.item(&space, placed, id, colour, depth) {
                self.push(Next::Left(r, lost_with(self.file.kind(id))));
            }
        }
    }

    fn item(
        &mut self,
        space: &Space<'a>,
        placed: &Placed,
        id: u64,
        inherited: Option<Colour>,
        depth: usize,
    ) -> Got<()> {
        self.items += 1;
        if depth > DEPTH || self.items > MOST {
            return Err(self.file.refused(id, "items are made of items without end"));
        }
        let colour = self.colours.get(&id).copied().or(inherited);
        match self.file.kind(id) {
            // Where things are.
            "AXIS2_PLACEMENT_3D" | "AXIS1_PLACEMENT" | "AXIS2_PLACEMENT_2D" => Ok(()),
            "MAPPED_ITEM" => {
                let (inner, map) = self.tree.mapped(space, id)?;
                let placed = Placed {
                    id: inner,
                    path: placed.path.clone(),
                    map: placed.map * map,
                    orphan: false,
                };
                self.representation(&placed, colour, depth + 1);
                Ok(())
            }
            "MANIFOLD_SOLID_BREP" | "FACETED_BREP" | "BREP_WITH_VOIDS" => {
                let record = self.file.record(id)?;
                let args = record.args();
                let mut shells = vec![args.reference(1)?];
                if record.kind() == "BREP_WITH_VOIDS" {
                    shells.extend(args.references(2)?);
                }
                let solid = true;
                let source = Source::Shells { shells, solid };
                self.later(space, placed, id, source, colour);
                Ok(())
            }
            "SHELL_BASED_SURFACE_MODEL" | "FACE_BASED_SURFACE_MODEL" => {
                let shells = self.file.record(id)?.args().references(1)?;
                let solid = false;
                let source = Source::Shells { shells, solid };
                self.later(space, placed, id, source, colour);
                Ok(())
            }
            "CLOSED_SHELL" | "OPEN_SHELL" | "CONNECTED_FACE_SET" => {
                let (shells, solid) = (vec![id], false);
                let source = Source::Shells { shells, solid };
                self.later(space, placed, id, source, colour);
                Ok(())
            }
            "ADVANCED_FACE" | "FACE_SURFACE" => {
                self.later(space, placed, id, Source::Face, colour);
                Ok(())
            }
            "GEOMETRIC_CURVE_SET" | "GEOMETRIC_SET" => self.set(space, placed, id, colour),
            _ => {
                let record = self.file.record(id)?;
                if splines::is_curve(&record) || record.kind().ends_with("CURVE") {
                    let curve = curves::course(space, id, 0)?
                        .whole()
                        .map_err(|e| record.refused(e))?;
                    self.add(space, placed, id, colour, ItemForm::Curve(curve));
                    return Ok(());
                }
                Err(record.refused("items of this kind are not read"))
            }
        }
    }

    /// Lists the bodies that no representation of a shape has.
    fn unshown(&mut self) {
        for kind in BODIES {
            for id in self.file.all(kind) {
                if !self.read.contains(&id) {
                    let why = "no shape of a product that is shown has it";
                    self.left.tell(&self.file.refused(id, why));
                }
            }
        }
    }

    fn set(
        &mut self,
        space: &Space<'a>,
        placed: &Placed,
        id: u64,
        colour: Option<Colour>,
    ) -> Got<()> {
        let mut points = Vec::new();
        for id in self.file.record(id)?.args().references(1)? {
            let own = self.colours.get(&id).copied().or(colour);
            if self.file.kind(id) == "CARTESIAN_POINT" {
                match space.point(id) {
                    Ok(p) => points.push(p),
                    Err(r) => self.leave(r),
                }
                continue;
            }
            let read = curves::course(space, id, 0)
                .and_then(|c| c.whole().map_err(|e| self.file.refused(id, e)));
            match read {
                Ok(curve) => self.add(space, placed, id, own, ItemForm::Curve(curve)),
                Err(r) => self.leave(r),
            }
        }
        if !points.is_empty() {
            self.add(space, placed, id, colour, ItemForm::Points(points));
        }
        Ok(())
    }

    /// A body, which is made later.
    fn later(
        &mut self,
        space: &Space<'a>,
        placed: &Placed,
        id: u64,
        source: Source,
        colour: Option<Colour>,
    ) {
        self.count_uncertainty(space, placed);
        self.push(Next::Job(Box::new(Job {
            space: space.clone(),
            path: placed.path.clone(),
            id,
            source,
            colour,
        })));
    }

    fn add(
        &mut self,
        space: &Space<'a>,
        placed: &Placed,
        id: u64,
        colour: Option<Colour>,
        form: ItemForm,
    ) {
        self.count_uncertainty(space, placed);
        let name = bodies::named(self.file, placed.path.clone(), id);
        self.push(Next::Item(Item { name, colour, form }));
    }

    /// Takes the uncertainty of what is placed into that of the document, if it is stated.
    fn count_uncertainty(&mut self, space: &Space<'a>, placed: &Placed) {
        let uncertainty = &mut self.document.uncertainty;
        if self.tree.context(placed.id).uncertainty.is_some() {
            *uncertainty = Some(uncertainty.unwrap_or(0.0).max(space.uncertainty));
        }
    }
}
