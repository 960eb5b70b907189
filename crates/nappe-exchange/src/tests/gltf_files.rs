//! `.glb` and `.gltf` through the `gltf` crate's validating reader.

use super::*;
use glam::{DMat4, DQuat, Vec3};

/// Everything a reader gets: names, world positions, normals, parameters, triangles of local positions.
struct Read {
    names: Vec<String>,
    world: Vec<Vec<DVec3>>,
    normals: Vec<Vec<[f32; 3]>>,
    uvs: Vec<Vec<[f32; 2]>>,
    triangles: Vec<Vec<[[u32; 3]; 3]>>,
}

fn read(bytes: &[u8]) -> Read {
    let file = ::gltf::Gltf::from_slice(bytes).unwrap();
    let embedded;
    let blob: &[u8] = match &file.blob {
        Some(b) => b,
        None => {
            let json: serde_json::Value = serde_json::from_slice(bytes).unwrap();
            let uri = json["buffers"][0]["uri"].as_str().unwrap();
            let text = uri
                .strip_prefix("data:application/octet-stream;base64,")
                .unwrap();
            use base64::Engine;
            embedded = base64::engine::general_purpose::STANDARD
                .decode(text)
                .unwrap();
            assert_eq!(json["buffers"][0]["byteLength"], embedded.len());
            &embedded
        }
    };
    let root = file.scenes().next().unwrap().nodes().next().unwrap();
    // The crate's own types would round the numbers of the root to f32.
    let text = match bytes.strip_prefix(b"glTF") {
        Some(_) => &bytes[20..20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize],
        None => bytes,
    };
    let json: serde_json::Value = serde_json::from_slice(text).unwrap();
    let numbers = |key: &str| -> Vec<f64> {
        json["nodes"][root.index()][key]
            .as_array()
            .unwrap()
            .iter()
            .map(|x| x.as_f64().unwrap())
            .collect()
    };
    let (t, r, s) = (
        numbers("translation"),
        numbers("rotation"),
        numbers("scale"),
    );
    let rotation = DQuat::from_array([r[0], r[1], r[2], r[3]]).normalize();
    let matrix = DMat4::from_scale_rotation_translation(
        DVec3::from_slice(&s),
        rotation,
        DVec3::from_slice(&t),
    );
    let mut out = Read {
        names: vec![],
        world: vec![],
        normals: vec![],
        uvs: vec![],
        triangles: vec![],
    };
    for node in root.children() {
        out.names.push(node.name().unwrap().to_owned());
        let primitive = node.mesh().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(blob));
        let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
        let accessor = primitive.get(&::gltf::Semantic::Positions).unwrap();
        let (lo, hi) = positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lo, hi), p| {
                (lo.min(Vec3::from(*p)), hi.max(Vec3::from(*p)))
            });
        for (k, (lo, hi)) in lo.to_array().into_iter().zip(hi.to_array()).enumerate() {
            assert_eq!(accessor.min().unwrap()[k].as_f64().unwrap() as f32, lo);
            assert_eq!(accessor.max().unwrap()[k].as_f64().unwrap() as f32, hi);
        }
        out.world.push(
            positions
                .iter()
                .map(|p| matrix.transform_point3(Vec3::from(*p).as_dvec3()))
                .collect(),
        );
        out.normals.push(
            reader
                .read_normals()
                .map(|n| n.collect())
                .unwrap_or_default(),
        );
        out.uvs.push(
            reader
                .read_tex_coords(0)
                .map(|t| t.into_f32().collect())
                .unwrap_or_default(),
        );
        let indices: Vec<u32> = reader
            .read_indices()
            .map(|i| i.into_u32().collect())
            .unwrap_or_default();
        let corner = |i: u32| bits(positions[i as usize]);
        out.triangles.push(
            indices
                .chunks(3)
                .map(|c| [corner(c[0]), corner(c[1]), corner(c[2])])
                .collect(),
        );
    }
    out
}

#[test]
fn names_positions_normals_and_parameters_come_back() {
    let scene = varied();
    for ending in ["glb", "gltf"] {
        let (report, bytes) = written(&scene, ending);
        let r = read(&bytes);
        let mut names: Vec<_> = scene.parts.iter().map(|p| p.name.as_str()).collect();
        names.push("rail 1");
        assert_eq!(r.names, names);
        assert_eq!(report.triangles, scene.triangles());
        for (k, (_, patch)) in scene.patches().enumerate() {
            for (i, v) in patch.vertices.iter().enumerate() {
                // Millimetres, z up, to metres, y up.
                let p = scene.mesh.points[v.point as usize] / 1000.0;
                assert!(
                    (r.world[k][i] - DVec3::new(p.x, p.z, -p.y)).length()
                        <= report.rounding / 1000.0 + 1e-15
                );
                assert!((Vec3::from(r.normals[k][i]).as_dvec3() - v.normal).length() < 1e-7);
                assert_eq!(r.uvs[k][i], v.uv.map(|x| x as f32));
            }
        }
        assert_closed(&r.triangles[..6].concat());
        assert_closed(&r.triangles[6]);
    }
}

#[test]
fn a_model_far_from_the_origin_keeps_its_digits() {
    let near = written(&varied(), "glb").0;
    let scene = far(varied());
    let (report, bytes) = written(&scene, "glb");
    assert_eq!((report.dropped_degenerate, report.kept_slivers), (0, 0));
    // f64 itself has a spacing of 1.5e-8 there.
    assert!(
        report.rounding < near.rounding + 3e-8,
        "{}",
        report.rounding
    );
    let r = read(&bytes);
    for (k, (_, patch)) in scene.patches().enumerate() {
        for (i, v) in patch.vertices.iter().enumerate() {
            let p = scene.mesh.points[v.point as usize] / 1000.0;
            assert!((r.world[k][i] - DVec3::new(p.x, p.z, -p.y)).length() < 1e-10);
        }
    }
    assert_closed(&r.triangles[..6].concat());
}

#[test]
fn large_surfaces_take_wide_indices_and_the_same_bytes_come_out_twice() {
    let scene = samples::torus(3.0, 1.0, 300, 300);
    assert!(scene.mesh.patches[0].vertices.len() > 65535);
    let (_, a) = written(&scene, "glb");
    let (_, b) = written(&scene, "glb");
    assert!(a == b);
    assert_closed(&read(&a).triangles[0]);
}

#[test]
fn triangles_that_rounding_collapses_are_dropped_and_counted() {
    // A sphere of 1e-9 beside a point at 1: f32 cannot tell its points apart.
    let mut scene = samples::sphere(16, 8);
    scene.mesh.points.iter_mut().for_each(|p| *p *= 1e-9);
    scene.curves.push(Polyline {
        name: "far".into(),
        points: vec![DVec3::ONE, DVec3::ONE * 2.0],
    });
    let (report, bytes) = written(&scene, "glb");
    assert!(report.dropped_degenerate > 0);
    assert_eq!(
        report.triangles + report.dropped_degenerate,
        scene.triangles()
    );
    assert!(report.notes.iter().any(|n| n.contains("left out")));
    ::gltf::Gltf::from_slice(&bytes).unwrap();
}
