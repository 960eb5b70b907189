//! PLY, as text and binary in either order of bytes.
//!
//! Of the element `vertex` the properties `x`, `y`, `z` are read, of `face` the list `vertex_indices` (or
//! `vertex_index`), and what this project writes besides: colours and the surface's number of each face, names and the
//! unit in comments. Everything else is passed over.
//! Source: G. Turk, *The PLY Polygon File Format*, 1994.

use super::polygon::triangulate;
use super::{Fault, MOST, shown};
use crate::triangles::{Group, TriangleMesh};
use glam::DVec3;
use nappe::Units;
use std::collections::HashMap;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn of(name: &str) -> Option<Kind> {
        Some(match name {
            "char" | "int8" => Kind::I8,
            "uchar" | "uint8" => Kind::U8,
            "short" | "int16" => Kind::I16,
            "ushort" | "uint16" => Kind::U16,
            "int" | "int32" => Kind::I32,
            "uint" | "uint32" => Kind::U32,
            "float" | "float32" => Kind::F32,
            "double" | "float64" => Kind::F64,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Kind::I8 | Kind::U8 => 1,
            Kind::I16 | Kind::U16 => 2,
            Kind::I32 | Kind::U32 | Kind::F32 => 4,
            Kind::F64 => 8,
        }
    }
}

#[derive(Debug)]
struct Property {
    name: String,
    kind: Kind,
    /// The type of a list's count.
    list: Option<Kind>,
}

#[derive(Debug)]
struct Element {
    name: String,
    count: usize,
    properties: Vec<Property>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Text,
    Little,
    Big,
}

#[derive(Debug)]
struct Header {
    form: Form,
    elements: Vec<Element>,
    units: Option<Units>,
    title: Option<String>,
    names: HashMap<i64, String>,
    /// Bytes and lines of the header.
    bytes: usize,
    lines: usize,
}

/// More properties are no mesh.
const MOST_PROPERTIES: usize = 1000;

fn header(bytes: &[u8]) -> Result<Header, Fault> {
    let mut h = Header {
        form: Form::Text,
        elements: Vec::new(),
        units: None,
        title: None,
        names: HashMap::new(),
        bytes: 0,
        lines: 0,
    };
    let mut form = None;
    loop {
        let rest = &bytes[h.bytes..];
        let Some(end) = rest.iter().position(|b| *b == b'\n') else {
            return Err(Fault::line(
                h.lines + 1,
                "the header has no `end_header`: this is no PLY file, or it is cut off",
            ));
        };
        let line = String::from_utf8_lossy(&rest[..end]);
        let line = line.trim();
        h.bytes += end + 1;
        h.lines += 1;
        let fault = |what: String| Fault::line(h.lines, what);
        let words: Vec<&str> = line.split_whitespace().collect();
        if h.lines == 1 {
            if line != "ply" {
                return Err(fault("a PLY file begins with the line `ply`".into()));
            }
            continue;
        }
        match words[..] {
            ["format", kind, _] => {
                form = Some(match kind {
                    "ascii" => Form::Text,
                    "binary_little_endian" => Form::Little,
                    "binary_big_endian" => Form::Big,
                    _ => {
                        return Err(fault(format!(
                            "`{}` is no form of PLY: ascii, binary_little_endian, binary_big_endian",
                            shown(kind)
                        )));
                    }
                });
            }
            ["element", name, count] => {
                let count =
                    count.parse().ok().filter(|n| *n <= MOST).ok_or_else(|| {
                        fault(format!("`{}` is not a count below 2³²", shown(count)))
                    })?;
                h.elements.push(Element {
                    name: name.to_owned(),
                    count,
                    properties: Vec::new(),
                });
            }
            ["property", ref rest @ ..] => {
                let kind = |name: &str| {
                    Kind::of(name)
                        .ok_or_else(|| fault(format!("`{}` is no type of numbers", shown(name))))
                };
                let property = match rest {
                    ["list", count, item, name] => Property {
                        name: (*name).into(),
                        kind: kind(item)?,
                        list: Some(kind(count)?),
                    },
                    [item, name] => Property {
                        name: (*name).into(),
                        kind: kind(item)?,
                        list: None,
                    },
                    _ => return Err(fault("a property has a type and a name".into())),
                };
                let Some(element) = h.elements.last_mut() else {
                    return Err(fault("a property before any element".into()));
                };
                if element.properties.len() >= MOST_PROPERTIES {
                    return Err(fault(format!("more than {MOST_PROPERTIES} properties")));
                }
                element.properties.push(property);
            }
            ["comment", "units:", unit] => h.units = Units::from_symbol(unit),
            ["comment", "title:", ..] => {
                h.title = line.split_once("title:").map(|t| t.1.trim().to_owned());
            }
            ["comment", "surface", number, ..] => {
                let number = number.strip_suffix(':').and_then(|n| n.parse().ok());
                if let (Some(n), Some((_, name))) = (number, line.split_once(": ")) {
                    h.names.insert(n, name.to_owned());
                }
            }
            ["end_header"] => break,
            ["comment" | "obj_info", ..] | [] => {}
            _ => {
                return Err(fault(format!(
                    "`{}` is no line of a PLY header",
                    shown(line)
                )));
            }
        }
    }
    h.form = form.ok_or_else(|| Fault::line(h.lines, "the header does not say its format"))?;
    Ok(h)
}

/// Where numbers come from.
struct Source<'a> {
    form: Form,
    bytes: &'a [u8],
    /// Bytes done.
    at: usize,
    /// Lines done, of text.
    line: usize,
}

impl Source<'_> {
    fn fault(&self, what: impl Into<String>) -> Fault {
        match self.form {
            Form::Text => Fault::line(self.line + 1, what),
            _ => Fault::byte(self.at, what),
        }
    }

    fn next(&mut self, kind: Kind) -> Result<f64, Fault> {
        if self.form == Form::Text {
            return self.word(kind);
        }
        let n = kind.bytes();
        let Some(b) = self.bytes.get(self.at..self.at + n) else {
            return Err(self.fault("the file ends here, before all that its header counts"));
        };
        let mut b8 = [0; 8];
        b8[..n].copy_from_slice(b);
        if self.form == Form::Big {
            b8[..n].reverse();
        }
        self.at += n;
        let bits = u64::from_le_bytes(b8);
        Ok(match kind {
            Kind::I8 => f64::from(bits as u8 as i8),
            Kind::U8 => f64::from(bits as u8),
            Kind::I16 => f64::from(bits as u16 as i16),
            Kind::U16 => f64::from(bits as u16),
            Kind::I32 => f64::from(bits as u32 as i32),
            Kind::U32 => f64::from(bits as u32),
            Kind::F32 => f64::from(f32::from_bits(bits as u32)),
            Kind::F64 => f64::from_bits(bits),
        })
    }

    fn word(&mut self, kind: Kind) -> Result<f64, Fault> {
        while let Some(b) = self.bytes.get(self.at).filter(|b| b.is_ascii_whitespace()) {
            self.line += usize::from(*b == b'\n');
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(u8::is_ascii_whitespace);
        let word = &rest[..end.unwrap_or(rest.len())];
        if word.is_empty() {
            return Err(self.fault("the file ends here, before all that its header counts"));
        }
        let word = String::from_utf8_lossy(word);
        let value = word
            .parse::<f64>()
            .map_err(|_| self.fault(format!("`{}` is not a number", shown(&word))))?;
        self.at += word.len().min(rest.len());
        // As the binary form would hold it.
        Ok(if kind == Kind::F32 {
            f64::from(value as f32)
        } else {
            value
        })
    }

    /// The least bytes that an element of these properties takes.
    fn least(&self, e: &Element) -> usize {
        let bytes = e.properties.iter().map(|p| match self.form {
            Form::Text => 2,
            _ => p.list.unwrap_or(p.kind).bytes(),
        });
        bytes.sum()
    }
}

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, Fault> {
    let h = header(bytes)?;
    let mut source = Source {
        form: h.form,
        bytes,
        at: h.bytes,
        line: h.lines,
    };
    let mut mesh = TriangleMesh {
        units: h.units,
        title: h.title.clone(),
        ..TriangleMesh::default()
    };
    let mut faces: Vec<(Vec<u32>, Style)> = Vec::new();
    let mut strips = 0;
    for e in &h.elements {
        if e.properties.is_empty() {
            continue;
        }
        let left = bytes.len() - source.at;
        // The last word of a text may end without a blank.
        if e.count > (left + 1) / source.least(e).max(1) {
            let (count, name) = (e.count, shown(&e.name));
            return Err(source.fault(format!("the header counts {count} of `{name}`, more than the {left} bytes from here can hold: the file is cut off")));
        }
        match e.name.as_str() {
            "vertex" => vertices(&mut source, e, &mut mesh.points)?,
            "face" => {
                for number in 0..e.count {
                    faces.push(face(&mut source, e, number)?);
                }
            }
            other => {
                strips += usize::from(other == "tristrips");
                for _ in 0..e.count {
                    row(&mut source, e, |_, _| {}, |_, _| Ok(()))?;
                }
            }
        }
    }
    if strips > 0 {
        mesh.missing.push(
            "Triangle strips were left out: of .ply files the element `face` is read.".into(),
        );
    }
    let mut groups: HashMap<Style, usize> = HashMap::new();
    let mut crossed = 0;
    for (number, (corners, style)) in faces.into_iter().enumerate() {
        let fault = |what: String| Fault::part(format!("face {number}"), what);
        let count = mesh.points.len();
        if let Some(c) = corners.iter().find(|c| **c as usize >= count) {
            return Err(fault(format!(
                "point {c} is named, but there are {count} points"
            )));
        }
        let points: Vec<DVec3> = corners.iter().map(|&c| mesh.points[c as usize]).collect();
        let (cut, crosses) = triangulate(&points).map_err(fault)?;
        crossed += usize::from(crosses);
        let group = *groups.entry(style).or_insert_with(|| {
            mesh.groups.push(Group {
                name: style
                    .0
                    .and_then(|n| h.names.get(&n))
                    .cloned()
                    .unwrap_or_default(),
                colour: style.1.map(|c| c.map(|x| f32::from(x) / 255.0)),
                triangles: Vec::new(),
            });
            mesh.groups.len() - 1
        });
        let global = cut.into_iter().map(|t| t.map(|k| corners[k as usize]));
        mesh.groups[group].triangles.extend(global);
    }
    mesh.notes.extend(super::polygon::note(crossed));
    Ok(mesh)
}

/// The surface's number and the colour of a face.
type Style = (Option<i64>, Option<[u8; 3]>);

/// Reads the properties of one element.
fn row(
    source: &mut Source<'_>,
    e: &Element,
    mut scalar: impl FnMut(usize, f64),
    mut item: impl FnMut(usize, f64) -> Result<(), String>,
) -> Result<(), Fault> {
    for (k, p) in e.properties.iter().enumerate() {
        match p.list {
            None => scalar(k, source.next(p.kind)?),
            Some(count) => {
                let n = source.next(count)?;
                if n < 0.0 || n.fract() != 0.0 {
                    return Err(source.fault(format!("a list of {n} numbers")));
                }
                for _ in 0..n as u64 {
                    let x = source.next(p.kind)?;
                    item(k, x).map_err(|e| source.fault(e))?;
                }
            }
        }
    }
    Ok(())
}

fn vertices(source: &mut Source<'_>, e: &Element, points: &mut Vec<DVec3>) -> Result<(), Fault> {
    let find = |name: &str| {
        e.properties
            .iter()
            .position(|p| p.name == name && p.list.is_none())
    };
    let (Some(x), Some(y), Some(z)) = (find("x"), find("y"), find("z")) else {
        return Err(Fault::whole("the vertices have no properties x, y and z"));
    };
    if points.len() + e.count > MOST {
        return Err(Fault::whole("more points than 32 bits can number"));
    }
    points.reserve(e.count);
    for number in 0..e.count {
        let mut p = DVec3::ZERO;
        let take = |k: usize, value: f64| {
            for (axis, at) in [x, y, z].into_iter().enumerate() {
                if at == k {
                    p[axis] = value;
                }
            }
        };
        row(source, e, take, |_, _| Ok(()))?;
        if !p.is_finite() {
            return Err(source.fault(format!(
                "point {number} is at {p}: coordinates must be finite numbers"
            )));
        }
        points.push(p);
    }
    Ok(())
}

fn face(source: &mut Source<'_>, e: &Element, number: usize) -> Result<(Vec<u32>, Style), Fault> {
    let mut corners = Vec::new();
    let (mut surface, mut colour, mut channels) = (None, [0; 3], 0);
    let name = |k: usize| e.properties[k].name.as_str();
    let scalar = |k: usize, value: f64| {
        let channel = match name(k) {
            "surface" => return surface = Some(value as i64),
            "red" => 0,
            "green" => 1,
            "blue" => 2,
            _ => return,
        };
        if e.properties[k].kind == Kind::U8 {
            colour[channel] = value as u8;
            channels += 1;
        }
    };
    let item = |k: usize, value: f64| {
        if matches!(name(k), "vertex_indices" | "vertex_index") {
            if !(value >= 0.0 && value.fract() == 0.0 && value <= MOST as f64) {
                return Err(format!("face {number} names the point {value}"));
            }
            corners.push(value as u32);
        }
        Ok(())
    };
    row(source, e, scalar, item)?;
    Ok((corners, (surface, (channels == 3).then_some(colour))))
}
