//! glTF 2.0, as binary `.glb` and as text `.gltf` with the numbers embedded.
//!
//! - glTF is y-up and in metres; scenes are z-up and in their own unit. A root node turns and scales, so that the
//!   stored numbers are the scene's.
//! - Positions are f32, measured from the middle of the whole scene, which the root node's translation puts back: a
//!   model far from the origin keeps its digits (a viewer that holds that translation as f32 moves the whole model, not
//!   its points against each other). One middle for all surfaces makes points that they share bit-equal,
//!   so the mesh is watertight where equal positions are taken as one.
//! - One node and one mesh for each surface, with its name, its normals and its parameters (u, v) as texture
//!   coordinates (glTF images have v downward). Materials are double-sided.
//! - `asset.extras` tells the unit and the proven deviation.
//!
//! Source: Khronos, *glTF 2.0 Specification*, §3.6 (geometry), §4.4 (GLB).

use crate::facets::{Store, corners};
use crate::report::{Tally, Ticker};
use crate::scene::{Colour, Scene};
use glam::{DVec3, Vec3};
use nappe::mesh::{Certainty, MeshPatch};
use serde_json::{Value, json};
use std::f64::consts::FRAC_1_SQRT_2;
use std::io::{self, Write};

const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const UNSIGNED_SHORT: u32 = 5123;
const UNSIGNED_INT: u32 = 5125;
const FLOAT: u32 = 5126;
const LINE_STRIP: u32 = 3;
/// The last index of 16 bits is reserved, to restart primitives.
const MOST_SHORT_VERTICES: usize = 65535;
const LINE_COLOUR: Colour = [0.13, 0.15, 0.18];

/// `.gltf`: one JSON text.
pub(crate) fn write_text(
    scene: &Scene,
    out: &mut dyn Write,
    ticker: Ticker<'_>,
) -> io::Result<Tally> {
    let Document { text, bytes, tally } = document(scene);
    out.write_all(text.as_bytes())?;
    if bytes == 0 {
        out.write_all(b"}")?;
        return Ok(tally);
    }
    // The buffer comes last and is streamed: a large mesh as one string would be in memory twice.
    write!(
        out,
        r#","buffers":[{{"byteLength":{bytes},"uri":"data:application/octet-stream;base64,"#
    )?;
    let mut encoder =
        base64::write::EncoderWriter::new(&mut *out, &base64::engine::general_purpose::STANDARD);
    write_buffer(scene, &mut encoder, ticker)?;
    encoder.finish()?;
    drop(encoder);
    out.write_all(b"\"}]}")?;
    Ok(tally)
}

/// `.glb`: a header, the JSON and the numbers.
pub(crate) fn write_binary(
    scene: &Scene,
    out: &mut dyn Write,
    ticker: Ticker<'_>,
) -> io::Result<Tally> {
    let Document { text, bytes, tally } = document(scene);
    let mut text = text.into_bytes();
    if bytes > 0 {
        write!(text, r#","buffers":[{{"byteLength":{bytes}}}]"#)?;
    }
    text.push(b'}');
    text.resize(text.len().next_multiple_of(4), b' ');
    let body = if bytes > 0 { 8 + bytes } else { 0 };
    let total = u32::try_from(12 + 8 + text.len() as u64 + body).map_err(io::Error::other)?;
    out.write_all(b"glTF")?;
    out.write_all(&2u32.to_le_bytes())?;
    out.write_all(&total.to_le_bytes())?;
    out.write_all(&(text.len() as u32).to_le_bytes())?;
    out.write_all(b"JSON")?;
    out.write_all(&text)?;
    if bytes > 0 {
        out.write_all(&(bytes as u32).to_le_bytes())?;
        out.write_all(b"BIN\0")?;
        write_buffer(scene, out, ticker)?;
    }
    Ok(tally)
}

/// The size of the numbers of a scene, at most: what the limit of 4 GiB is checked against.
pub(crate) fn buffer_bound(scene: &Scene) -> u64 {
    let patches: u64 = scene
        .patches()
        .map(|(_, p)| 32 * p.vertices.len() as u64 + 12 * p.triangles.len() as u64)
        .sum();
    patches
        + scene
            .curves
            .iter()
            .map(|c| 12 * c.points.len() as u64)
            .sum::<u64>()
}

fn store(scene: &Scene) -> Store {
    Store::Single {
        origin: middle(scene),
    }
}

fn middle(scene: &Scene) -> DVec3 {
    scene
        .extent()
        .map_or(DVec3::ZERO, |[lo, hi]| lo + (hi - lo) / 2.0)
}

/// Whether the indices of a patch take 16 bits.
fn is_short(patch: &MeshPatch) -> bool {
    patch.vertices.len() <= MOST_SHORT_VERTICES
}

/// A JSON list as text: as a tree the entries of many surfaces would take more memory than their mesh.
#[derive(Default)]
struct List {
    text: String,
    len: usize,
}

impl List {
    /// Adds an entry and returns its index.
    fn push(&mut self, entry: &Value) -> usize {
        if self.len > 0 {
            self.text.push(',');
        }
        self.text += &entry.to_string();
        self.len += 1;
        self.len - 1
    }
}

/// Gathers accessors and their views of the one buffer, in the order in which `write_buffer` writes.
#[derive(Default)]
struct Layout {
    views: List,
    accessors: List,
    bytes: u64,
}

impl Layout {
    fn add(&mut self, target: Option<u32>, bytes: u64, mut accessor: Value) -> usize {
        let mut view = json!({"buffer": 0, "byteOffset": self.bytes, "byteLength": bytes});
        if let Some(target) = target {
            view["target"] = target.into();
        }
        accessor["bufferView"] = self.views.push(&view).into();
        self.bytes += bytes.next_multiple_of(4);
        self.accessors.push(&accessor)
    }

    fn positions(&mut self, count: usize, bounds: [Vec3; 2]) -> usize {
        let [min, max] = bounds.map(|b| b.to_array());
        let accessor =
            json!({"componentType": FLOAT, "count": count, "type": "VEC3", "min": min, "max": max});
        self.add(Some(ARRAY_BUFFER), 12 * count as u64, accessor)
    }

    fn floats(&mut self, count: usize, components: u64) -> usize {
        let accessor =
            json!({"componentType": FLOAT, "count": count, "type": format!("VEC{components}")});
        self.add(Some(ARRAY_BUFFER), 4 * components * count as u64, accessor)
    }
}

fn bounds(points: impl Iterator<Item = Vec3>) -> [Vec3; 2] {
    points.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[lo, hi], p| {
        [lo.min(p), hi.max(p)]
    })
}

/// The JSON without what says where the numbers are.
struct Document {
    /// Without the last bracket.
    text: String,
    /// The length of the numbers.
    bytes: u64,
    tally: Tally,
}

fn document(scene: &Scene) -> Document {
    let store = store(scene);
    let (mut tally, mut layout) = (Tally::default(), Layout::default());
    let (mut nodes, mut meshes, mut materials, mut colours) = (
        List::default(),
        List::default(),
        List::default(),
        Vec::<Colour>::new(),
    );
    // The root comes first and holds all others.
    let count = scene.parts.len() + scene.curves.len();
    nodes.push(&root(scene, count));
    let mut material = |colour: Colour, name: &str| {
        if let Some(known) = colours.iter().position(|c| *c == colour) {
            return known;
        }
        colours.push(colour);
        let [r, g, b] = colour.map(linear);
        materials.push(&json!({
            "name": name,
            "doubleSided": true,
            "pbrMetallicRoughness": {"baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.55},
        }));
        colours.len() - 1
    };
    for (part, patch) in scene.patches() {
        let before = tally.triangles;
        for &t in &patch.triangles {
            tally.admit(corners(&scene.mesh, patch, t), store);
        }
        let kept = tally.triangles - before;
        let mut node =
            json!({"name": part.name, "extras": {"deviation": deviation(patch.deviation)}});
        // An accessor cannot be empty; a surface without triangles keeps its name and place in the tree.
        if kept > 0 {
            let n = patch.vertices.len();
            let points = || {
                patch
                    .vertices
                    .iter()
                    .map(|v| scene.mesh.points[v.point as usize])
            };
            points().for_each(|p| tally.note_rounding(p, store));
            let position = layout.positions(n, bounds(points().map(|p| store.single(p))));
            let normal = layout.floats(n, 3);
            let uv = layout.floats(n, 2);
            let (kind, width) = if is_short(patch) {
                (UNSIGNED_SHORT, 2)
            } else {
                (UNSIGNED_INT, 4)
            };
            let accessor = json!({"componentType": kind, "count": 3 * kept, "type": "SCALAR"});
            let indices = layout.add(
                Some(ELEMENT_ARRAY_BUFFER),
                3 * kept as u64 * width,
                accessor,
            );
            let mesh = meshes.push(&json!({"name": part.name, "primitives": [{
                "attributes": {"POSITION": position, "NORMAL": normal, "TEXCOORD_0": uv},
                "indices": indices,
                "material": material(part.colour, &part.name),
            }]}));
            node["mesh"] = mesh.into();
        }
        nodes.push(&node);
    }
    for curve in &scene.curves {
        curve
            .points
            .iter()
            .for_each(|&p| tally.note_rounding(p, store));
        let position = layout.positions(
            curve.points.len(),
            bounds(curve.points.iter().map(|&p| store.single(p))),
        );
        let mesh = meshes.push(&json!({"name": curve.name, "primitives": [{
            "attributes": {"POSITION": position}, "mode": LINE_STRIP, "material": material(LINE_COLOUR, "line"),
        }]}));
        nodes.push(&json!({"name": curve.name, "mesh": mesh}));
    }
    let asset = json!({
        "version": "2.0",
        "generator": concat!("nappe ", env!("CARGO_PKG_VERSION")),
        "extras": {
            "units": scene.units.symbol(),
            "deviation": deviation(scene.deviation()),
            "rounding": tally.rounding,
        },
    });
    let mut text = format!(r#"{{"asset":{asset},"scene":0,"scenes":[{{"nodes":[0]}}]"#);
    let lists = [
        ("nodes", nodes),
        ("meshes", meshes),
        ("materials", materials),
        ("accessors", layout.accessors),
        ("bufferViews", layout.views),
    ];
    for (name, list) in lists.into_iter().filter(|(_, list)| list.len > 0) {
        text += &format!(r#","{name}":[{}]"#, list.text);
    }
    Document {
        text,
        bytes: layout.bytes,
        tally,
    }
}

/// Turns z up into y up, (x, y, z) → (x, z, -y), and the scene's unit into metres.
fn root(scene: &Scene, children: usize) -> Value {
    let metres = scene.units.metres();
    let m = middle(scene) * metres;
    let mut root = json!({
        "name": scene.title.as_deref().unwrap_or("nappe"),
        "translation": [m.x, m.z, -m.y],
        "rotation": [-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2],
        "scale": [metres, metres, metres],
    });
    if children > 0 {
        root["children"] = (1..=children).collect();
    }
    root
}

fn deviation(c: Certainty) -> Value {
    let kind = match c {
        Certainty::Exact => "exact",
        Certainty::Bounded(_) => "bounded",
        Certainty::Estimated(_) => "estimated",
    };
    json!({"kind": kind, "value": c.error()})
}

/// The linear light of an sRGB channel (IEC 61966-2-1).
fn linear(c: f32) -> f32 {
    if c <= 0.04045 {
        c / 12.92
    } else {
        ((c + 0.055) / 1.055).powf(2.4)
    }
}

fn write_buffer(scene: &Scene, out: &mut dyn Write, mut ticker: Ticker<'_>) -> io::Result<()> {
    let store = store(scene);
    for (_, patch) in scene.patches() {
        let mut kept = Tally::default();
        let sound: Vec<bool> = patch
            .triangles
            .iter()
            .map(|&t| kept.admit(corners(&scene.mesh, patch, t), store))
            .collect();
        if kept.triangles == 0 {
            continue;
        }
        for v in &patch.vertices {
            put(
                out,
                &store.single(scene.mesh.points[v.point as usize]).to_array(),
            )?;
        }
        for v in &patch.vertices {
            put(out, &v.normal.normalize().as_vec3().to_array())?;
        }
        for v in &patch.vertices {
            put(out, &v.uv.map(|x| x as f32))?;
        }
        let short = is_short(patch);
        for (t, _) in patch.triangles.iter().zip(&sound).filter(|(_, s)| **s) {
            ticker.step();
            for &i in t {
                if short {
                    out.write_all(&(i as u16).to_le_bytes())?;
                } else {
                    out.write_all(&i.to_le_bytes())?;
                }
            }
        }
        if short && kept.triangles % 2 == 1 {
            out.write_all(&[0, 0])?;
        }
    }
    for curve in &scene.curves {
        for &p in &curve.points {
            put(out, &store.single(p).to_array())?;
        }
    }
    Ok(())
}

fn put(out: &mut dyn Write, values: &[f32]) -> io::Result<()> {
    values
        .iter()
        .try_for_each(|x| out.write_all(&x.to_le_bytes()))
}
