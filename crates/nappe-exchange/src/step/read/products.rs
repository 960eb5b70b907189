//! Products, the representations of their shapes, and how they are put together.

use super::file::{File, Got, Refused};
use super::left::Left;
use super::place::Space;
use super::units::{Context, assumed};
use glam::DAffine3;
use nappe::Units;
use std::collections::{HashMap, HashSet};

/// A representation somewhere in the whole.
pub(super) struct Placed {
    /// Its number.
    pub(super) id: u64,
    /// The names on the way to it.
    pub(super) path: Vec<String>,
    /// Where it is.
    pub(super) map: DAffine3,
    /// Whether no product has it: then it may repeat what others show.
    pub(super) orphan: bool,
}

/// Assemblies of assemblies are followed so far.
const DEPTH: usize = 64;
/// More placed representations than this are refused: a file of a few lines can ask for any number.
const MOST: usize = 1_000_000;

/// What an entry of a list takes, in bytes: it counts towards what a file may ask for.
const LISTED: usize = 64;

/// One part in another.
struct Use {
    /// The representation of the part.
    child: u64,
    name: String,
    /// The placements in the part and in the whole that are laid on each other.
    onto: Option<[u64; 2]>,
}

/// How representations hang together.
pub(super) struct Tree<'a> {
    file: &'a File<'a>,
    units: Units,
    contexts: HashMap<u64, Context>,
    /// The same by their own numbers.
    stated: HashMap<u64, Context>,
    /// What of them could not be read.
    faults: Vec<Refused>,
    /// Representations that hold the same shape.
    same: HashMap<u64, Vec<u64>>,
    uses: HashMap<u64, Vec<Use>>,
    /// Representations of products, in the order of the file, with their names.
    products: Vec<(u64, String)>,
    /// Those that are parts of others.
    parts: HashSet<u64>,
    /// Those of them that are somewhere that could not be read.
    lost: Vec<u64>,
}

impl<'a> Tree<'a> {
    pub(super) fn new(file: &'a File<'a>, units: Units, left: &mut Left) -> Self {
        let mut tree = Tree {
            file,
            units,
            contexts: HashMap::new(),
            stated: HashMap::new(),
            faults: Vec::new(),
            same: HashMap::new(),
            uses: HashMap::new(),
            products: Vec::new(),
            parts: HashSet::new(),
            lost: Vec::new(),
        };
        let shapes = tree.shapes();
        for id in file.all("SHAPE_REPRESENTATION_RELATIONSHIP") {
            let Ok(record) = file.record(id) else {
                continue;
            };
            if let (Ok(a), Ok(b)) = (record.args().reference(2), record.args().reference(3)) {
                tree.same.entry(a).or_default().push(b);
                tree.same.entry(b).or_default().push(a);
            }
        }
        let mut used = HashSet::new();
        for id in file.all("CONTEXT_DEPENDENT_SHAPE_REPRESENTATION") {
            if let Err(r) = tree.occurrence(id, &shapes, &mut used) {
                left.add(&r);
            }
        }
        for id in file.all("(REPRESENTATION_RELATIONSHIP") {
            if !used.contains(&id)
                && let Err(r) = tree.relation(id, None, String::new())
            {
                left.add(&r);
            }
        }
        tree
    }

    /// The representation of each product definition.
    fn shapes(&mut self) -> HashMap<u64, u64> {
        let mut shapes = HashMap::new();
        for id in self.file.all("SHAPE_DEFINITION_REPRESENTATION") {
            let Ok(record) = self.file.record(id) else {
                continue;
            };
            let args = record.args();
            let (Ok(property), Ok(shape)) = (args.reference(0), args.reference(1)) else {
                continue;
            };
            let Some(definition) = self.definition_of(property) else {
                continue;
            };
            if !self.file.kind(definition).starts_with("PRODUCT_DEFINITION") {
                continue;
            }
            // What a product has besides its shape (holes, views) is a property of another kind.
            if shapes.insert(definition, shape).is_none() {
                self.products.push((shape, self.name_of(definition)));
            }
        }
        shapes
    }

    fn definition_of(&self, property: u64) -> Option<u64> {
        let record = self.file.record(property).ok()?;
        record.part("PRODUCT_DEFINITION_SHAPE")?.reference(2).ok()
    }

    fn name_of(&self, definition: u64) -> String {
        let name = || -> Option<String> {
            let formation = self
                .file
                .record(definition)
                .ok()?
                .args()
                .reference(2)
                .ok()?;
            let product = self.file.record(formation).ok()?.args().reference(2).ok()?;
            let record = self.file.record(product).ok()?;
            let args = record.part("PRODUCT")?;
            let name = args.text(1);
            Some(if name.is_empty() { args.text(0) } else { name })
        };
        name().unwrap_or_default()
    }

    fn occurrence(
        &mut self,
        id: u64,
        shapes: &HashMap<u64, u64>,
        used: &mut HashSet<u64>,
    ) -> Got<()> {
        let record = self.file.record(id)?;
        let relation = record.args().reference(0)?;
        used.insert(relation);
        let usage = || -> Got<(Option<u64>, String)> {
            let usage = self
                .definition_of(record.args().reference(1)?)
                .ok_or_else(|| record.refused("it names no use of a part"))?;
            let usage = self.file.record(usage)?;
            let args = usage.args();
            let child = args.reference(4)?;
            let name = self.name_of(child);
            let name = if name.is_empty() { args.text(1) } else { name };
            Ok((shapes.get(&child).copied(), name))
        };
        match usage() {
            Ok((part, name)) => self.relation(relation, part, name),
            // The part is where it is, whatever it is called.
            Err(r) => self.relation(relation, None, String::new()).and(Err(r)),
        }
    }

    /// Two representations with placements that are laid on each other; the first is the part unless the second is
    /// known to be it.
    fn relation(&mut self, id: u64, part: Option<u64>, name: String) -> Got<()> {
        let record = self.file.record(id)?;
        let args = record.needed("REPRESENTATION_RELATIONSHIP")?;
        let [mut child, mut parent] = [args.reference(2)?, args.reference(3)?];
        let swapped = part == Some(parent) && child != parent;
        if swapped {
            (child, parent) = (parent, child);
        }
        self.parts.insert(child);
        let onto = || -> Got<Option<[u64; 2]>> {
            let Some(args) = record.part("REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION") else {
                return Ok(None);
            };
            let map = self.file.record(args.reference(0)?)?;
            let args = map.needed("ITEM_DEFINED_TRANSFORMATION")?;
            let [a, b] = [args.reference(2)?, args.reference(3)?];
            Ok(Some(if swapped { [b, a] } else { [a, b] }))
        };
        let onto = onto();
        let onto = match onto {
            Ok(onto) => onto,
            Err(r) => {
                // Where it is not known to be it is not shown.
                self.lost.push(child);
                return Err(r);
            }
        };
        self.uses
            .entry(parent)
            .or_default()
            .push(Use { child, name, onto });
        Ok(())
    }

    /// The units and accuracy of a representation.
    pub(super) fn context(&mut self, id: u64) -> Context {
        if let Some(c) = self.contexts.get(&id) {
            return *c;
        }
        let file = self.file;
        let context = match file.record(id).and_then(|r| r.args().reference(2)) {
            Ok(number) => match self.stated.get(&number) {
                Some(context) => *context,
                None => {
                    let context = Context::read(file, number, &mut |r| self.faults.push(r));
                    self.stated.insert(number, context);
                    context
                }
            },
            Err(r) => {
                self.faults.push(assumed(r));
                Context::default()
            }
        };
        self.contexts.insert(id, context);
        context
    }

    /// What of units and uncertainties could not be read, once.
    pub(super) fn faults(&mut self) -> Vec<Refused> {
        std::mem::take(&mut self.faults)
    }

    fn space(&mut self, id: u64, map: DAffine3) -> Space<'a> {
        let context = self.context(id);
        Space::new(self.file, &context, self.units, Some(map))
    }

    /// How the numbers of a placed representation are to be read.
    pub(super) fn space_of(&mut self, placed: &Placed) -> Space<'a> {
        self.space(placed.id, placed.map)
    }

    /// The name of the only product that is not part of another.
    pub(super) fn title(&self) -> Option<String> {
        let mut tops = self.tops();
        let first = tops.next().filter(|t| !t.1.is_empty())?;
        tops.next().is_none().then(|| first.1.clone())
    }

    fn tops(&self) -> impl Iterator<Item = &(u64, String)> {
        self.products.iter().filter(|p| !self.parts.contains(&p.0))
    }

    /// Every representation with everything that it is made of, laid out.
    pub(super) fn laid_out(&mut self, left: &mut Left) -> Vec<Placed> {
        let mut out = Vec::new();
        let mut tops: Vec<(u64, String)> = self.tops().cloned().collect();
        let all = representations(self.file);
        let whole = tops.len() == 1;
        let mut seen = HashSet::new();
        let mut ways = Ways {
            out: &mut out,
            seen: &mut seen,
            left,
            orphans: false,
        };
        for (id, name) in tops.drain(..) {
            let path = if whole || name.is_empty() {
                vec![]
            } else {
                vec![name]
            };
            self.lay_out(id, path, DAffine3::IDENTITY, &mut Vec::new(), &mut ways);
        }
        // Shapes without a product.
        ways.orphans = true;
        for &id in &all {
            if !ways.seen.contains(&id) && !self.parts.contains(&id) {
                self.lay_out(id, vec![], DAffine3::IDENTITY, &mut Vec::new(), &mut ways);
            }
        }
        // What is left is part of itself: it is shown once and told.
        for id in self.lost.clone() {
            self.pass_over(id, ways.seen);
        }
        let products: Vec<u64> = self.products.iter().map(|p| p.0).collect();
        for id in products.into_iter().chain(all) {
            if !ways.seen.contains(&id) && ways.out.len() < MOST && self.file.bounded(id).is_ok() {
                self.lay_out(id, vec![], DAffine3::IDENTITY, &mut Vec::new(), &mut ways);
            }
        }
        out
    }

    /// Takes a representation and all its parts as seen: they are not shown, and that is told elsewhere.
    fn pass_over(&self, id: u64, seen: &mut HashSet<u64>) {
        let mut next = vec![id];
        while let Some(id) = next.pop() {
            if seen.insert(id) {
                next.extend(self.same.get(&id).into_iter().flatten());
                next.extend(self.uses.get(&id).into_iter().flatten().map(|u| u.child));
            }
        }
    }

    fn lay_out(
        &mut self,
        id: u64,
        path: Vec<String>,
        map: DAffine3,
        above: &mut Vec<u64>,
        ways: &mut Ways<'_>,
    ) {
        // Each place has its names.
        let names: usize = path.iter().map(|name| name.len() + LISTED).sum();
        self.file.charge(LISTED + names);
        let why = if ways.out.len() >= MOST {
            Err(self
                .file
                .refused(id, format!("the parts are more than {MOST}")))
        } else if above.contains(&id) || above.len() > DEPTH {
            Err(self.file.refused(id, "it is a part of itself"))
        } else {
            self.file.bounded(id)
        };
        if let Err(r) = why {
            self.pass_over(id, ways.seen);
            return ways.left.add(&r);
        }
        let mut group = vec![id];
        let mut i = 0;
        while i < group.len() {
            for other in self.same.get(&group[i]).into_iter().flatten() {
                if !group.contains(other) {
                    group.push(*other);
                }
            }
            i += 1;
        }
        let depth = above.len();
        above.extend(&group);
        for id in &group {
            ways.seen.insert(*id);
            ways.out.push(Placed {
                id: *id,
                path: path.clone(),
                map,
                orphan: ways.orphans,
            });
            for (child, name, onto) in self.uses_of(*id) {
                let placed = onto.map_or(Ok(DAffine3::IDENTITY), |o| self.laid_on(child, *id, o));
                match placed {
                    Ok(inner) => {
                        let mut path = path.clone();
                        path.extend((!name.is_empty()).then_some(name));
                        self.lay_out(child, path, map * inner, above, ways);
                    }
                    Err(r) => {
                        self.pass_over(child, ways.seen);
                        ways.left.add(&r);
                    }
                }
            }
        }
        above.truncate(depth);
    }

    fn uses_of(&self, id: u64) -> Vec<(u64, String, Option<[u64; 2]>)> {
        let uses = self.uses.get(&id).into_iter().flatten();
        uses.map(|u| (u.child, u.name.clone(), u.onto)).collect()
    }

    /// The map that lays a placement of one representation on one of another.
    fn laid_on(&mut self, child: u64, parent: u64, [from, to]: [u64; 2]) -> Got<DAffine3> {
        let from = self.space(child, DAffine3::IDENTITY).map_of(from)?;
        let to = self.space(parent, DAffine3::IDENTITY).map_of(to)?;
        Ok(to * from.inverse())
    }

    /// What a `MAPPED_ITEM` of a representation places, and where. The origin is one of what is placed, in its units.
    pub(super) fn mapped(&mut self, space: &Space<'_>, id: u64) -> Got<(u64, DAffine3)> {
        let record = space.file.record(id)?;
        let args = record.needed("MAPPED_ITEM")?;
        let source = space.file.record(args.reference(1)?)?;
        let source = source.needed("REPRESENTATION_MAP")?;
        let inner = source.reference(1)?;
        let from = self.space(inner, DAffine3::IDENTITY);
        let from = from.map_of(source.reference(0)?)?;
        let to = space.own().map_of(args.reference(2)?)?;
        Ok((inner, to * from.inverse()))
    }
}

/// What laying out adds to.
struct Ways<'l> {
    out: &'l mut Vec<Placed>,
    seen: &'l mut HashSet<u64>,
    left: &'l mut Left,
    orphans: bool,
}

/// All representations that may hold shapes, but for those that are only there to be placed by others.
fn representations(file: &File<'_>) -> Vec<u64> {
    let mapped: HashSet<u64> = file
        .all("REPRESENTATION_MAP")
        .filter_map(|id| file.record(id).ok()?.args().reference(1).ok())
        .collect();
    let kinds = file
        .kinds()
        .iter()
        .filter(|k| k.name.ends_with("SHAPE_REPRESENTATION"));
    kinds
        .filter(|k| k.name != "CONTEXT_DEPENDENT_SHAPE_REPRESENTATION")
        .flat_map(|k| file.all(&k.name))
        .filter(|id| !mapped.contains(id))
        .collect()
}
