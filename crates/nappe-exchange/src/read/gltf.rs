//! glTF 2.0, as `.glb` and `.gltf`: triangles and lines of the scene, with names, base colours and placements.
//!
//! glTF is y-up and in metres. Points are turned to z up, (x, y, z) → (x, -z, y), and stay in metres, unless the file says
//! that this project wrote it from another unit. Points with the same numbers are one. Normals, texture coordinates,
//! skins, animations and morphs are not read; compressed or sparse numbers are refused.
//!
//! The JSON is taken apart here and not by a glTF crate: those hold placements as f32, which would cost models far from
//! the origin their digits.
//! Source: Khronos, *glTF 2.0 Specification*, §3.6 (geometry), §4.4 (GLB).

use super::weld::Weld;
use super::{Fault, most_triangles};
use crate::scene::{Colour, Polyline};
use crate::triangles::{Group, TriangleMesh};
use base64::Engine as _;
use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3};
use nappe::Units;
use serde::Deserialize;
use std::borrow::Cow;
use std::path::{Component, Path};

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
struct Root {
    asset: Asset,
    scene: usize,
    scenes: Vec<Scene>,
    nodes: Vec<Node>,
    meshes: Vec<MeshOf>,
    materials: Vec<Material>,
    accessors: Vec<Accessor>,
    buffer_views: Vec<View>,
    buffers: Vec<Buffer>,
    extensions_required: Vec<String>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Asset {
    extras: serde_json::Value,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Scene {
    name: Option<String>,
    nodes: Vec<usize>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Node {
    name: Option<String>,
    children: Vec<usize>,
    mesh: Option<usize>,
    skin: Option<usize>,
    matrix: Option<[f64; 16]>,
    translation: Option<[f64; 3]>,
    rotation: Option<[f64; 4]>,
    scale: Option<[f64; 3]>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct MeshOf {
    name: Option<String>,
    primitives: Vec<Primitive>,
}

#[derive(Deserialize, Default)]
#[serde(default)]
struct Primitive {
    attributes: Attributes,
    indices: Option<usize>,
    material: Option<usize>,
    mode: Option<u32>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "UPPERCASE", default)]
struct Attributes {
    position: Option<usize>,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
struct Material {
    pbr_metallic_roughness: Pbr,
}

#[derive(Deserialize, Default)]
#[serde(rename_all = "camelCase", default)]
struct Pbr {
    base_color_factor: Option<[f32; 4]>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Accessor {
    buffer_view: Option<usize>,
    #[serde(default)]
    byte_offset: usize,
    component_type: u32,
    #[serde(default)]
    normalized: bool,
    count: usize,
    #[serde(rename = "type")]
    kind: String,
    sparse: Option<serde_json::Value>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct View {
    buffer: usize,
    #[serde(default)]
    byte_offset: usize,
    byte_length: usize,
    byte_stride: Option<usize>,
    extensions: Option<serde_json::Map<String, serde_json::Value>>,
}

#[derive(Deserialize)]
#[serde(rename_all = "camelCase")]
struct Buffer {
    uri: Option<String>,
    byte_length: usize,
}

/// Required extensions that change nothing that is read here.
const HARMLESS: [&str; 4] = [
    "KHR_materials_",
    "KHR_texture_",
    "KHR_mesh_quantization",
    "EXT_texture_",
];
/// Nodes below nodes.
const DEEPEST: usize = 256;

pub(super) fn read(bytes: &[u8], folder: Option<&Path>) -> Result<TriangleMesh, Fault> {
    let (text, blob) = if bytes.starts_with(b"glTF") {
        chunks(bytes)?
    } else {
        (bytes, None)
    };
    let root: Root = serde_json::from_slice(text).map_err(|e| {
        Fault::line(
            e.line(),
            format!("the JSON is not that of a glTF file: {e}"),
        )
    })?;
    let refused = root
        .extensions_required
        .iter()
        .find(|e| !HARMLESS.iter().any(|h| e.starts_with(h)));
    if let Some(e) = refused {
        return Err(Fault::whole(format!(
            "the file needs the extension {e}, which cannot be read; export it without compression"
        )));
    }
    let buffers = root
        .buffers
        .iter()
        .enumerate()
        .map(|(i, b)| buffer(i, b, blob, folder))
        .collect::<Result<Vec<_>, _>>()?;
    let unit = root.asset.extras.get("units").and_then(|u| u.as_str());
    let units = unit.and_then(Units::from_symbol).unwrap_or(Units::Metre);
    let mut reader = Reader {
        root: &root,
        buffers: &buffers,
        seen: vec![false; root.nodes.len()],
        left: most_triangles(bytes.len()),
        weld: Weld::default(),
        mesh: TriangleMesh {
            units: Some(units),
            ..TriangleMesh::default()
        },
        skipped: 0,
        skins: 0,
    };
    // y up to z up, and metres to the unit.
    let per = units.metres().recip();
    let turn = DMat3::from_cols(DVec3::X, DVec3::Z, DVec3::NEG_Y);
    let map = DAffine3::from_mat3(turn * per);
    let every: Vec<usize>;
    let nodes = match root.scenes.get(root.scene) {
        Some(scene) => {
            reader.mesh.title.clone_from(&scene.name);
            &scene.nodes
        }
        None => {
            let mut child = vec![false; root.nodes.len()];
            for c in root.nodes.iter().flat_map(|n| &n.children) {
                if let Some(is) = child.get_mut(*c) {
                    *is = true;
                }
            }
            every = (0..child.len()).filter(|i| !child[*i]).collect();
            &every
        }
    };
    for &n in nodes {
        reader.node(n, map, 0)?;
    }
    if reader.mesh.title.is_none() && unit.is_some() {
        reader.mesh.title = root
            .nodes
            .first()
            .and_then(|n| n.name.clone())
            .filter(|n| n != "nappe");
    }
    let told =
        |count: usize, what: &str| (count > 0).then(|| format!("{count} {what} were left out."));
    let skipped = told(reader.skipped, "primitives of points or of loose lines");
    reader.mesh.missing.extend(skipped);
    reader.mesh.notes.extend(told(reader.skins, "skins"));
    reader.mesh.points = reader.weld.points;
    Ok(reader.mesh)
}

fn u32_at(bytes: &[u8], at: usize) -> Option<usize> {
    let b = bytes.get(at..at.checked_add(4)?)?;
    Some(u32::from_le_bytes([b[0], b[1], b[2], b[3]]) as usize)
}

/// The JSON and the numbers of a `.glb`.
fn chunks(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), Fault> {
    let mut at = 12;
    let (mut text, mut blob) = (None, None);
    if u32_at(bytes, 4) != Some(2) {
        return Err(Fault::byte(4, "this is not version 2 of glTF"));
    }
    while at < bytes.len() {
        let fault = || Fault::byte(at, "the file ends inside a chunk: it is cut off");
        let length = u32_at(bytes, at).ok_or_else(fault)?;
        let kind = bytes.get(at + 4..at + 8).ok_or_else(fault)?;
        let chunk = bytes.get(at + 8..at + 8 + length).ok_or_else(fault)?;
        match kind {
            b"JSON" if text.is_none() => text = Some(chunk),
            b"BIN\0" if blob.is_none() => blob = Some(chunk),
            _ => {}
        }
        at += 8 + length;
    }
    let text = text.ok_or_else(|| Fault::byte(12, "the file has no JSON chunk"))?;
    Ok((text, blob))
}

fn buffer<'a>(
    index: usize,
    b: &Buffer,
    blob: Option<&'a [u8]>,
    folder: Option<&Path>,
) -> Result<Cow<'a, [u8]>, Fault> {
    let fault = |what: String| Fault::part(format!("buffer {index}"), what);
    let data =
        match b.uri.as_deref() {
            None if index > 0 => {
                return Err(fault(
                    "it has no data: only the first buffer can be the file's binary chunk".into(),
                ));
            }
            None => Cow::Borrowed(blob.ok_or_else(|| {
                fault("it is in the file's binary chunk, but there is none".into())
            })?),
            Some(uri) if uri.starts_with("data:") => {
                let text = uri
                    .split_once(";base64,")
                    .ok_or_else(|| fault("its data is not in base64".into()))?
                    .1;
                let data = base64::engine::general_purpose::STANDARD
                    .decode(text)
                    .map_err(|e| fault(format!("its data is not base64: {e}")))?;
                Cow::Owned(data)
            }
            Some(uri) => {
                let name = Path::new(uri);
                let plain = name.components().all(|c| matches!(c, Component::Normal(_)));
                // Only files beside this one: a file from elsewhere must not make us open anything.
                let folder = folder.filter(|_| plain && !uri.contains(':'));
                let folder = folder.ok_or_else(|| {
                    fault(format!(
                        "its numbers are in `{}`; only files beside the .gltf are opened",
                        super::shown(uri)
                    ))
                })?;
                let data = std::fs::read(folder.join(name))
                    .map_err(|e| fault(format!("could not read `{}`: {e}", super::shown(uri))))?;
                Cow::Owned(data)
            }
        };
    if data.len() < b.byte_length {
        return Err(fault(format!(
            "it should have {} bytes, but there are {}: the file is cut off",
            b.byte_length,
            data.len()
        )));
    }
    Ok(data)
}

struct Reader<'a> {
    root: &'a Root,
    buffers: &'a [Cow<'a, [u8]>],
    seen: Vec<bool>,
    /// Triangles and points of lines that may still come.
    left: usize,
    weld: Weld,
    mesh: TriangleMesh,
    skipped: usize,
    skins: usize,
}

/// The numbers of an accessor.
struct Numbers<'a> {
    bytes: &'a [u8],
    count: usize,
    stride: usize,
    kind: u32,
    normalized: bool,
}

impl Numbers<'_> {
    /// Panics if there are not so many; the accessor was checked.
    fn get(&self, index: usize, component: usize) -> f64 {
        let size = size_of(self.kind).unwrap_or(1);
        let at = index * self.stride + component * size;
        let b = &self.bytes[at..at + size];
        let (value, most) = match (self.kind, b) {
            (5120, [a]) => (f64::from(*a as i8), 127.0),
            (5121, [a]) => (f64::from(*a), 255.0),
            (5122, [a, b]) => (f64::from(i16::from_le_bytes([*a, *b])), 32767.0),
            (5123, [a, b]) => (f64::from(u16::from_le_bytes([*a, *b])), 65535.0),
            (5125, [a, b, c, d]) => return f64::from(u32::from_le_bytes([*a, *b, *c, *d])),
            (_, [a, b, c, d]) => return f64::from(f32::from_le_bytes([*a, *b, *c, *d])),
            _ => (0.0, 1.0),
        };
        if self.normalized {
            (value / most).max(-1.0)
        } else {
            value
        }
    }
}

fn size_of(kind: u32) -> Option<usize> {
    match kind {
        5120 | 5121 => Some(1),
        5122 | 5123 => Some(2),
        5125 | 5126 => Some(4),
        _ => None,
    }
}

impl<'a> Reader<'a> {
    fn numbers(&self, index: usize, components: usize) -> Result<Numbers<'a>, Fault> {
        let root = self.root;
        let fault = |what: &str| Fault::part(format!("accessor {index}"), what);
        let a = root
            .accessors
            .get(index)
            .ok_or_else(|| fault("it is named, but not there"))?;
        if a.sparse.is_some() {
            return Err(fault("sparse numbers cannot be read"));
        }
        let expected = if components == 1 { "SCALAR" } else { "VEC3" };
        if a.kind != expected {
            return Err(fault(&format!("its type should be {expected}")));
        }
        let size =
            size_of(a.component_type).ok_or_else(|| fault("its component type is unknown"))?;
        let view = a.buffer_view.ok_or_else(|| fault("it has no numbers"))?;
        let view = root
            .buffer_views
            .get(view)
            .ok_or_else(|| fault("its buffer view is not there"))?;
        if let Some(e) = view.extensions.as_ref().and_then(|e| e.keys().next()) {
            return Err(fault(&format!(
                "its numbers are stored with {e}, which cannot be read"
            )));
        }
        let out = || fault("its numbers lie outside the buffer: the file is damaged or cut off");
        let buffer = self.buffers.get(view.buffer).ok_or_else(out)?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let bytes = end.and_then(|e| buffer.get(view.byte_offset..e));
        let bytes = bytes.and_then(|b| b.get(a.byte_offset..)).ok_or_else(out)?;
        let element = size * components;
        let stride = view.byte_stride.unwrap_or(element);
        if stride < element {
            return Err(fault("its numbers overlap"));
        }
        let needed = match a.count {
            0 => Some(0),
            n => (n - 1)
                .checked_mul(stride)
                .and_then(|b| b.checked_add(element)),
        };
        if needed.is_none_or(|n| n > bytes.len()) {
            return Err(out());
        }
        Ok(Numbers {
            bytes,
            count: a.count,
            stride,
            kind: a.component_type,
            normalized: a.normalized,
        })
    }

    fn node(&mut self, index: usize, map: DAffine3, depth: usize) -> Result<(), Fault> {
        let fault = |what: &str| Fault::part(format!("node {index}"), what);
        let root = self.root;
        let node = root
            .nodes
            .get(index)
            .ok_or_else(|| fault("it is named, but not there"))?;
        if depth > DEEPEST || std::mem::replace(&mut self.seen[index], true) {
            return Err(fault(
                "it is placed twice, or too deep: nodes must form a tree",
            ));
        }
        let map = map * placement(node);
        if !map.is_finite() {
            return Err(fault("its placement is not finite"));
        }
        self.skins += usize::from(node.skin.is_some());
        if let Some(m) = node.mesh {
            let mesh = root
                .meshes
                .get(m)
                .ok_or_else(|| fault("its mesh is not there"))?;
            let name = node.name.as_ref().or(mesh.name.as_ref());
            let name = name.cloned().unwrap_or_default();
            for (k, p) in mesh.primitives.iter().enumerate() {
                self.primitive(p, &name, map).map_err(|f| match f.at {
                    super::Place::Whole => Fault::part(format!("mesh {m}, primitive {k}"), f.what),
                    _ => f,
                })?;
            }
        }
        node.children
            .iter()
            .try_for_each(|&c| self.node(c, map, depth + 1))
    }

    fn primitive(&mut self, p: &Primitive, name: &str, map: DAffine3) -> Result<(), Fault> {
        let Some(position) = p.attributes.position else {
            return Ok(());
        };
        let mode = p.mode.unwrap_or(4);
        if !(3..=6).contains(&mode) {
            self.skipped += 1;
            return Ok(());
        }
        let positions = self.numbers(position, 3)?;
        let indices = p.indices.map(|i| self.numbers(i, 1)).transpose()?;
        let count = indices.as_ref().map_or(positions.count, |i| i.count);
        let triangles = if mode == 4 {
            count / 3
        } else {
            count.saturating_sub(2)
        };
        self.left = self
            .left
            .checked_sub(triangles.max(positions.count))
            .ok_or_else(|| Fault::whole("the file places its meshes so often that they are out of proportion to its size"))?;
        let mut numbers = Vec::with_capacity(positions.count);
        let mut points = Vec::new();
        for i in 0..positions.count {
            let p = DVec3::from([0, 1, 2].map(|c| positions.get(i, c)));
            let p = map.transform_point3(p);
            if !p.is_finite() {
                let what = format!("point {i} is at {p}: coordinates must be finite numbers");
                return Err(Fault::whole(what));
            }
            if mode == 3 {
                points.push(p);
            } else {
                numbers.push(self.weld.number(p)?);
            }
        }
        let index = |k: usize| -> Result<usize, Fault> {
            let i = indices.as_ref().map_or(k, |n| n.get(k, 0) as usize);
            if i < positions.count {
                return Ok(i);
            }
            let there = positions.count;
            let what = format!("point {i} is named, but there are {there} points");
            Err(Fault::whole(what))
        };
        if mode == 3 {
            let order = (0..count).map(index).collect::<Result<Vec<_>, _>>()?;
            if order.len() > 1 {
                self.mesh.curves.push(Polyline {
                    name: name.to_owned(),
                    points: order.into_iter().map(|i| points[i]).collect(),
                });
            }
            return Ok(());
        }
        let mirrored = map.matrix3.determinant() < 0.0;
        let mut group = Group {
            name: name.to_owned(),
            colour: p.material.and_then(|m| colour(self.root.materials.get(m)?)),
            triangles: Vec::with_capacity(triangles),
        };
        for k in 0..triangles {
            let [a, b, c] = match mode {
                4 => [3 * k, 3 * k + 1, 3 * k + 2],
                5 if k % 2 == 1 => [k + 1, k, k + 2],
                5 => [k, k + 1, k + 2],
                _ => [0, k + 1, k + 2],
            };
            let [a, b, c] = [numbers[index(a)?], numbers[index(b)?], numbers[index(c)?]];
            group
                .triangles
                .push(if mirrored { [a, c, b] } else { [a, b, c] });
        }
        self.mesh.groups.push(group);
        Ok(())
    }
}

fn placement(node: &Node) -> DAffine3 {
    if let Some(m) = node.matrix {
        return DAffine3::from_mat4(DMat4::from_cols_array(&m));
    }
    let scale = node.scale.map_or(DVec3::ONE, DVec3::from);
    let turn = node
        .rotation
        .map_or(DQuat::IDENTITY, |r| DQuat::from_array(r).normalize());
    let shift = node.translation.map_or(DVec3::ZERO, DVec3::from);
    DAffine3::from_scale_rotation_translation(scale, turn, shift)
}

fn colour(m: &Material) -> Option<Colour> {
    let [r, g, b, _] = m.pbr_metallic_roughness.base_color_factor?;
    Some([r, g, b].map(encoded))
}

/// The sRGB channel of linear light (IEC 61966-2-1).
fn encoded(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    if x <= 0.003_130_8 {
        12.92 * x
    } else {
        1.055 * x.powf(1.0 / 2.4) - 0.055
    }
}
