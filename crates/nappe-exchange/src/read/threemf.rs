//! 3MF: objects with meshes or components, placed by the build items.
//!
//! Colours are those of base materials; textures, lattices, slices and what other extensions add are passed over. Parts of
//! the model may be in several files of the archive (production extension).
//!
//! An archive may unpack to at most [`unpacked`] bytes, whatever it says of itself.
//! Source: 3MF Consortium, *3D Manufacturing Format, Core Specification* 1.3, and *Production Extension* 1.1.

use super::{Fault, MOST, most_triangles, number, shown};
use crate::scene::Colour;
use crate::triangles::{Group, TriangleMesh};
use glam::{DAffine3, DMat3, DVec3};
use nappe::Units;
use quick_xml::events::{BytesStart, Event};
use quick_xml::reader::Reader;
use std::collections::HashMap;
use std::io::{BufReader, Cursor, Read};
use zip::ZipArchive;

/// The most bytes that an archive may unpack to. Text of meshes is packed to between a third and a fiftieth; a bomb, to
/// a thousandth.
fn unpacked(packed: usize) -> u64 {
    (packed as u64).saturating_mul(200).saturating_add(1 << 20)
}

/// A longer element is no element of a mesh.
const LONGEST_ELEMENT: usize = 1 << 16;
/// Components of components.
const DEEPEST: usize = 64;
/// Parts of the model in files of their own.
const MOST_FILES: usize = 10_000;

#[derive(Default)]
struct Object {
    name: String,
    points: Vec<DVec3>,
    /// Triangles by colour.
    triangles: Vec<(Option<Material>, [u32; 3])>,
    components: Vec<Placed>,
}

/// An object's place: the file it is in, its number, and where it goes.
struct Placed {
    file: String,
    id: u32,
    map: DAffine3,
}

/// Name and colour of a base material.
type Base = (String, Option<Colour>);

/// The number of a list of base materials, and the place in it.
type Material = (u32, u32);

#[derive(Default)]
struct Model {
    units: Units,
    objects: HashMap<(String, u32), Object>,
    materials: HashMap<(String, u32), Vec<Base>>,
    items: Vec<Placed>,
}

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, Fault> {
    let mut zip = ZipArchive::new(Cursor::new(bytes))
        .map_err(|e| Fault::whole(format!("this is not a zip archive, or it is damaged: {e}")))?;
    let mut left = unpacked(bytes.len());
    let root = root(&mut zip, &mut left)?;
    let mut model = Model::default();
    let mut queue = vec![root.clone()];
    let mut known = vec![root.clone()];
    while let Some(file) = queue.pop() {
        read_part(&mut zip, &file, &mut left, &mut model, file == root)?;
        let more: Vec<String> = model
            .objects
            .values()
            .flat_map(|o| &o.components)
            .chain(&model.items)
            .map(|p| p.file.clone())
            .filter(|f| !known.contains(f))
            .collect();
        for f in more {
            if known.len() >= MOST_FILES {
                return Err(Fault::whole(format!("more than {MOST_FILES} parts")));
            }
            if !known.contains(&f) {
                known.push(f.clone());
                queue.push(f);
            }
        }
    }
    let mut placer = Placer {
        model: &model,
        left: most_triangles(bytes.len()),
        mesh: TriangleMesh {
            units: Some(model.units),
            ..TriangleMesh::default()
        },
    };
    for item in &model.items {
        placer.place(item, DAffine3::IDENTITY, 0)?;
    }
    Ok(placer.mesh)
}

/// The name of the model's first file, which the archive's relationships tell.
fn root(zip: &mut ZipArchive<Cursor<&[u8]>>, left: &mut u64) -> Result<String, Fault> {
    let mut found = None;
    let relationships = "_rels/.rels";
    if zip.by_name(relationships).is_ok() {
        elements(zip, relationships, left, |e| {
            let kind = attribute(e, "Type")?.unwrap_or_default();
            if e.local_name().as_ref() == "Relationship" && kind.ends_with("/3dmodel") {
                found = attribute(e, "Target")?;
            }
            Ok(())
        })?;
    }
    let name = found.unwrap_or_else(|| "3D/3dmodel.model".into());
    Ok(name.trim_start_matches('/').to_owned())
}

/// Calls a function for each start of an element.
fn elements(
    zip: &mut ZipArchive<Cursor<&[u8]>>,
    file: &str,
    left: &mut u64,
    mut tell: impl FnMut(&BytesStart<'_>) -> Result<(), String>,
) -> Result<(), Fault> {
    let entry = zip
        .by_name(file)
        .map_err(|e| Fault::part(shown(file), format!("it is not in the archive: {e}")))?;
    let limit = *left;
    let mut reader = Reader::from_reader(BufReader::new(entry.take(limit)));
    let mut buffer = Vec::new();
    loop {
        buffer.clear();
        let event = reader.read_event_into(&mut buffer);
        let at = reader.buffer_position();
        let fault = |what: String| Fault::part(format!("{}, byte {at}", shown(file)), what);
        if at >= limit {
            return Err(fault(
                "the archive unpacks to far more than its size: it is no mesh".into(),
            ));
        }
        match event {
            Ok(Event::Eof) => {
                *left -= at;
                return Ok(());
            }
            Ok(Event::Start(e) | Event::Empty(e)) => {
                if e.len() > LONGEST_ELEMENT {
                    return Err(fault("an element is too long".into()));
                }
                tell(&e).map_err(fault)?;
            }
            Ok(Event::DocType(_)) => return Err(fault("3MF allows no document types".into())),
            Ok(_) => {}
            Err(e) => return Err(fault(format!("this is not XML: {e}"))),
        }
    }
}

/// The value of an attribute with this local name.
fn attribute(e: &BytesStart<'_>, name: &str) -> Result<Option<String>, String> {
    for a in e.attributes().with_checks(false) {
        let a = a.map_err(|e| format!("an attribute is wrong: {e}"))?;
        if a.key.local_name().as_ref() == name {
            let text = a
                .normalized_value(quick_xml::XmlVersion::Implicit1_0)
                .map_err(|e| format!("an attribute is wrong: {e}"))?;
            return Ok(Some(text.into_owned()));
        }
    }
    Ok(None)
}

fn needed<T>(
    e: &BytesStart<'_>,
    name: &str,
    parse: impl Fn(&str) -> Option<T>,
) -> Result<T, String> {
    let element = e.local_name().as_ref().to_owned();
    let text =
        attribute(e, name)?.ok_or_else(|| format!("<{element}> has no attribute `{name}`"))?;
    parse(text.trim())
        .ok_or_else(|| format!("`{}` is wrong for `{name}` of <{element}>", shown(&text)))
}

fn index(text: &str) -> Option<u32> {
    text.parse().ok()
}

fn placed(e: &BytesStart<'_>, file: &str) -> Result<Placed, String> {
    let map = match attribute(e, "transform")? {
        None => DAffine3::IDENTITY,
        Some(text) => {
            let m: Vec<f64> = text.split_whitespace().map_while(number).collect();
            if m.len() != 12 {
                return Err(format!(
                    "`{}` is no transform of twelve numbers",
                    shown(&text)
                ));
            }
            DAffine3 {
                matrix3: DMat3::from_cols_slice(&m[..9]),
                translation: DVec3::from_slice(&m[9..]),
            }
        }
    };
    let file =
        attribute(e, "path")?.map_or(file.to_owned(), |p| p.trim_start_matches('/').to_owned());
    Ok(Placed {
        file,
        id: needed(e, "objectid", index)?,
        map,
    })
}

fn read_part(
    zip: &mut ZipArchive<Cursor<&[u8]>>,
    file: &str,
    left: &mut u64,
    model: &mut Model,
    is_root: bool,
) -> Result<(), Fault> {
    let mut object: Option<u32> = None;
    let mut materials: Option<u32> = None;
    let mut own: Option<Material> = None;
    elements(zip, file, left, |e| {
        match e.local_name().as_ref() {
            "model" if is_root => {
                if let Some(unit) = attribute(e, "unit")? {
                    model.units = match unit.as_str() {
                        "micron" => return Err("the unit micron cannot be read".into()),
                        "millimeter" => Units::Millimetre,
                        "centimeter" => Units::Centimetre,
                        "meter" => Units::Metre,
                        "inch" => Units::Inch,
                        "foot" => Units::Foot,
                        _ => return Err(format!("`{}` is no unit", shown(&unit))),
                    };
                }
            }
            "basematerials" => {
                let id = needed(e, "id", index)?;
                materials = Some(id);
                model.materials.insert((file.to_owned(), id), Vec::new());
            }
            "base" => {
                let list = materials.and_then(|id| model.materials.get_mut(&(file.to_owned(), id)));
                if let Some(list) = list {
                    let name = attribute(e, "name")?.unwrap_or_default();
                    let colour = attribute(e, "displaycolor")?.and_then(|c| hex(&c));
                    list.push((name, colour));
                }
            }
            "object" => {
                let id = needed(e, "id", index)?;
                object = Some(id);
                let [pid, at] = [attribute(e, "pid")?, attribute(e, "pindex")?];
                own = pid
                    .zip(at)
                    .and_then(|(p, i)| Some((index(&p)?, index(&i)?)));
                let new = Object {
                    name: attribute(e, "name")?.unwrap_or_default(),
                    ..Object::default()
                };
                if model.objects.insert((file.to_owned(), id), new).is_some() {
                    return Err(format!("there are two objects with the number {id}"));
                }
            }
            "vertex" => {
                let p = DVec3::new(
                    needed(e, "x", number)?,
                    needed(e, "y", number)?,
                    needed(e, "z", number)?,
                );
                let o = inside(model, file, object)?;
                if o.points.len() >= MOST {
                    return Err("more points than 32 bits can number".into());
                }
                o.points.push(p);
            }
            "triangle" => {
                let t = [
                    needed(e, "v1", index)?,
                    needed(e, "v2", index)?,
                    needed(e, "v3", index)?,
                ];
                let pid = attribute(e, "pid")?.as_deref().and_then(index);
                let p1 = attribute(e, "p1")?.as_deref().and_then(index);
                let material = match (pid.or(own.map(|o| o.0)), p1) {
                    (Some(list), Some(at)) => Some((list, at)),
                    _ => own,
                };
                let o = inside(model, file, object)?;
                let count = o.points.len();
                if let Some(i) = t.iter().find(|i| **i as usize >= count) {
                    return Err(format!("point {i} is named, but there are {count} points"));
                }
                o.triangles.push((material, t));
            }
            "component" => {
                let p = placed(e, file)?;
                inside(model, file, object)?.components.push(p);
            }
            "item" if is_root => model.items.push(placed(e, file)?),
            _ => {}
        }
        Ok(())
    })
}

fn inside<'a>(model: &'a mut Model, file: &str, id: Option<u32>) -> Result<&'a mut Object, String> {
    let id = id.ok_or("a point, triangle or component outside any object")?;
    model
        .objects
        .get_mut(&(file.to_owned(), id))
        .ok_or_else(|| "a point, triangle or component outside any object".to_owned())
}

/// `#RRGGBB` or `#RRGGBBAA`.
fn hex(text: &str) -> Option<Colour> {
    let digits = text.strip_prefix('#')?;
    let byte = |k: usize| {
        let two = digits.get(2 * k..2 * k + 2)?;
        u8::from_str_radix(two, 16).ok()
    };
    Some([byte(0)?, byte(1)?, byte(2)?].map(|b| f32::from(b) / 255.0))
}

struct Placer<'a> {
    model: &'a Model,
    /// Triangles and points that may still come.
    left: usize,
    mesh: TriangleMesh,
}

impl Placer<'_> {
    fn place(&mut self, p: &Placed, map: DAffine3, depth: usize) -> Result<(), Fault> {
        let fault = |what: &str| Fault::part(format!("object {}", p.id), what);
        let model = self.model;
        let o = model
            .objects
            .get(&(p.file.clone(), p.id))
            .ok_or_else(|| fault("it is placed, but not there"))?;
        if depth > DEEPEST {
            return Err(fault("it is part of itself, or too deep"));
        }
        let map = map * p.map;
        self.left = self
            .left
            .checked_sub(o.triangles.len().max(o.points.len()).max(1))
            .ok_or_else(|| fault("the file places its objects so often that they are out of proportion to its size"))?;
        let first = self.mesh.points.len();
        if first + o.points.len() > MOST {
            return Err(fault("more points than 32 bits can number"));
        }
        for q in &o.points {
            let q = map.transform_point3(*q);
            if !q.is_finite() {
                return Err(fault("its placement makes coordinates that are not finite"));
            }
            self.mesh.points.push(q);
        }
        let mirrored = map.matrix3.determinant() < 0.0;
        let mut groups: HashMap<Option<Material>, usize> = HashMap::new();
        for (material, t) in &o.triangles {
            let group = *groups.entry(*material).or_insert_with(|| {
                let list = material.and_then(|(list, at)| {
                    model
                        .materials
                        .get(&(p.file.clone(), list))?
                        .get(at as usize)
                });
                // Materials of a name are how surfaces of one object are told apart.
                let name = list.map(|m| m.0.clone()).filter(|n| !n.is_empty());
                self.mesh.groups.push(Group {
                    name: name.unwrap_or_else(|| o.name.clone()),
                    colour: list.and_then(|m| m.1),
                    triangles: Vec::new(),
                });
                self.mesh.groups.len() - 1
            });
            let [a, b, c] = t.map(|i| first as u32 + i);
            let t = if mirrored { [a, c, b] } else { [a, b, c] };
            self.mesh.groups[group].triangles.push(t);
        }
        o.components
            .iter()
            .try_for_each(|c| self.place(c, map, depth + 1))
    }
}
