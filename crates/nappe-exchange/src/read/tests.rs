//! What is written is read again; what is wrong is said with its place.

use super::{Read, read, read_bytes};
use crate::samples;
use crate::scene::{Polyline, Scene};
use crate::triangles::{MeshFacts, TriangleMesh, mesh_facts};
use crate::write::write;
use crate::{Format, WriteOptions};
use glam::DVec3;
use nappe::Units;

const MESHES: [Format; 6] = [
    Format::Stl,
    Format::Obj,
    Format::Ply,
    Format::Glb,
    Format::Gltf,
    Format::ThreeMf,
];

fn mesh(read: Read) -> TriangleMesh {
    match read {
        Read::Mesh(m) => m,
        other => panic!("{other:?}"),
    }
}

fn written(scene: &Scene, format: Format) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(format!("x.{}", format.ending()));
    write(&path, scene, &WriteOptions::default()).unwrap();
    let m = mesh(read(&path).unwrap());
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(m, mesh(read_bytes(format.ending(), &bytes).unwrap()));
    bytes
}

fn facts(ending: &str, bytes: &[u8]) -> (TriangleMesh, MeshFacts) {
    let m = mesh(read_bytes(ending, bytes).unwrap());
    let f = mesh_facts(&m);
    (m, f)
}

fn fault(ending: &str, bytes: &[u8]) -> String {
    read_bytes(ending, bytes).unwrap_err().to_string()
}

#[test]
fn what_is_written_comes_back() {
    for (mut scene, volume) in [(samples::cube(), 1.0), (samples::sphere(24, 12), 4.0)] {
        scene.units = Units::Inch;
        scene.curves = vec![Polyline {
            name: "edge".into(),
            points: vec![DVec3::ZERO, DVec3::X, DVec3::new(1.0, 0.25, 0.0)],
        }];
        let direct = mesh_facts(&TriangleMesh {
            points: scene.mesh.points.clone(),
            groups: scene
                .patches()
                .map(|(_, p)| crate::triangles::Group {
                    triangles: p
                        .triangles
                        .iter()
                        .map(|t| t.map(|i| p.vertices[i as usize].point))
                        .collect(),
                    ..Default::default()
                })
                .collect(),
            ..TriangleMesh::default()
        });
        assert!(direct.volume.unwrap() > 0.9 * volume);
        for format in MESHES {
            let (m, f) = facts(format.ending(), &written(&scene, format));
            assert_eq!(m.units, Some(Units::Inch), "{format}");
            assert_eq!(
                (
                    f.triangles,
                    f.points,
                    f.open_edges,
                    f.crowded_edges,
                    f.turned_edges
                ),
                (direct.triangles, direct.points, 0, 0, 0),
                "{format}"
            );
            let singles = matches!(format, Format::Stl | Format::Glb | Format::Gltf);
            let digits = if singles { 1e-6 } else { 1e-15 };
            let (a, b) = (f.volume.unwrap(), direct.volume.unwrap());
            assert!((a - b).abs() <= digits * b, "{format}: {a} {b}");
            assert!(
                (f.area - direct.area).abs() <= digits * direct.area,
                "{format}"
            );
            for k in 0..2 {
                let apart = f.extent.unwrap()[k] - direct.extent.unwrap()[k];
                assert!(apart.length() <= digits, "{format}: {apart}");
            }
            if format != Format::Stl {
                let names: Vec<&str> = m.groups.iter().map(|g| g.name.as_str()).collect();
                let wanted: Vec<&str> = scene.parts.iter().map(|p| p.name.as_str()).collect();
                assert_eq!(names, wanted, "{format}");
            }
            if matches!(format, Format::Ply | Format::Glb | Format::ThreeMf) {
                for (g, p) in m.groups.iter().zip(&scene.parts) {
                    for (a, b) in g.colour.unwrap().iter().zip(p.colour) {
                        assert!((a - b).abs() < 0.003, "{format}");
                    }
                }
            }
            if matches!(format, Format::Obj | Format::Glb | Format::Gltf) {
                assert_eq!(m.curves.len(), 1, "{format}");
                assert_eq!(m.curves[0].points.len(), 3);
            }
        }
    }
}

#[test]
fn normals_of_a_sphere_are_smooth_and_those_of_a_cube_are_not() {
    let m = facts("ply", &written(&samples::sphere(48, 24), Format::Ply)).0;
    let scene = m.to_scene();
    scene.validate().unwrap();
    for v in &scene.mesh.patches[0].vertices {
        let p = scene.mesh.points[v.point as usize];
        assert!(v.normal.dot(p.normalize()) > 0.999);
    }
    // Each face of the cube by itself is flat; as one group its edges are sharp.
    let mut cube = facts("ply", &written(&samples::cube(), Format::Ply)).0;
    let all: Vec<[u32; 3]> = cube
        .groups
        .iter()
        .flat_map(|g| g.triangles.clone())
        .collect();
    cube.groups.truncate(1);
    cube.groups[0].triangles = all;
    let scene = cube.to_scene();
    scene.validate().unwrap();
    assert_eq!(scene.mesh.patches[0].vertices.len(), 24);
    for v in &scene.mesh.patches[0].vertices {
        assert!((v.normal.abs().max_element() - 1.0).abs() < 1e-15);
    }
    // What was read is written again, and is the same.
    let again = facts("3mf", &written(&scene, Format::ThreeMf)).1;
    assert_eq!(again.volume, mesh_facts(&cube).volume);
}

#[test]
fn text_forms_are_read() {
    let stl = "solid a b\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n";
    let (m, f) = facts("stl", stl.as_bytes());
    assert_eq!(
        (m.groups[0].name.as_str(), f.area, f.open_edges),
        ("a b", 0.5, 3)
    );
    let obj = "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 0 1 0\ng quad\nf -4/1/1 -3//2 \\\n -2 -1\n";
    let (m, f) = facts("obj", obj.as_bytes());
    assert_eq!(
        (m.groups[0].name.as_str(), f.area, f.triangles),
        ("quad", 2.0, 2)
    );
    let ply = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2";
    assert_eq!(facts("ply", ply.as_bytes()).1.area, 0.5);
    let mut big = b"ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\nproperty double y\nproperty float z\nelement face 1\nproperty list uchar ushort vertex_indices\nend_header\n".to_vec();
    for (x, y) in [(0i16, 0f64), (300, 0.0), (0, 2.5)] {
        big.extend(x.to_be_bytes());
        big.extend(y.to_be_bytes());
        big.extend(0f32.to_be_bytes());
    }
    big.push(3);
    [0u16, 1, 2]
        .iter()
        .for_each(|i| big.extend(i.to_be_bytes()));
    assert_eq!(facts("ply", &big).1.area, 375.0);
}

#[test]
fn faults_say_where() {
    for (ending, text, place, word) in [
        ("stl", "solid\nfacet\nvertex 0 0 nan\n", "line 3", "finite"),
        (
            "stl",
            "solid\nfacet\nvertex 0 0 0\n",
            "line 3",
            "ends inside",
        ),
        ("stl", "xyz", "byte 3", "ends here"),
        ("obj", "v 0 0 0\nv 1 0 0\nf 1 2 7\n", "line 3", "7"),
        ("obj", "v 0 0 0\nv 1e999 0 0\n", "line 2", "finite"),
        ("obj", "v 0 0 0\nf 1 1\n", "line 2", "three"),
        (
            "ply",
            "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float z\nend_header\n",
            "line 8",
            "cut off",
        ),
        ("ply", "plot\n", "line 1", "ply"),
        (
            "gltf",
            "{\"nodes\":[{\"children\":[0]}],\"scenes\":[{\"nodes\":[0]}]}",
            "node 0",
            "tree",
        ),
        (
            "gltf",
            "{\"buffers\":[{\"byteLength\":0,\"uri\":\"data:;base64,\"},{\"byteLength\":0}]}",
            "buffer 1",
            "only the first",
        ),
        ("3mf", "PK nothing", "", "zip"),
        (
            "stl",
            "solid\nfacet\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nfacet\n",
            "line 6",
            "endfacet",
        ),
        ("doc", "", "", ".stl"),
    ] {
        let e = fault(ending, text.as_bytes());
        assert!(e.contains(place) && e.contains(word), "{ending}: {e}");
    }
}

#[test]
fn every_cut_and_every_changed_byte_ends_with_a_result() {
    let scene = samples::cube();
    for format in MESHES {
        let bytes = written(&scene, format);
        let step = (bytes.len() / 400).max(1);
        for cut in (0..bytes.len()).step_by(step) {
            let _ = read_bytes(format.ending(), &bytes[..cut]);
        }
        for at in (0..bytes.len()).step_by(step) {
            for value in [0, 0x7f, 0xff, b'9', b'-'] {
                let mut changed = bytes.clone();
                changed[at] = value;
                if let Ok(Read::Mesh(m)) = read_bytes(format.ending(), &changed) {
                    mesh_facts(&m);
                    m.to_scene().validate().unwrap();
                }
            }
        }
        // Nothing half is taken for a whole.
        let half = &bytes[..bytes.len() / 2];
        if format != Format::Obj {
            assert!(read_bytes(format.ending(), half).is_err(), "{format}");
        }
    }
}

#[test]
fn a_bomb_is_refused() {
    use std::io::Write;
    use zip::write::SimpleFileOptions;
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    let options = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Deflated);
    zip.start_file("3D/3dmodel.model", options).unwrap();
    zip.write_all(b"<model>").unwrap();
    zip.write_all(&vec![b' '; 64 << 20]).unwrap();
    let bytes = zip.finish().unwrap().into_inner();
    let e = fault("3mf", &bytes);
    assert!(e.contains("far more than its size"), "{e}");
    // Components of components, each twice, forty times over.
    let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
    zip.start_file("3D/3dmodel.model", options).unwrap();
    let mut xml = "<model><resources><object id=\"0\"><mesh><vertices/></mesh></object>".to_owned();
    for i in 1..40 {
        xml += &format!(
            "<object id=\"{i}\"><components><component objectid=\"{0}\"/><component objectid=\"{0}\"/></components></object>",
            i - 1
        );
    }
    xml += "</resources><build><item objectid=\"39\"/></build></model>";
    zip.write_all(xml.as_bytes()).unwrap();
    let bytes = zip.finish().unwrap().into_inner();
    assert!(fault("3mf", &bytes).contains("out of proportion"));
}

/// Lengths whose squares, or whose products, are no numbers or hardly any: sides of 10⁻⁸⁰ enclose 10⁻¹⁶⁰, the square of which
/// is 0.
#[test]
fn triangles_of_any_size_have_unit_normals() {
    for size in ["1e-80", "1e-150", "1e-7", "1e80"] {
        let stl = format!(
            "solid\nfacet normal 0 0 0\nouter loop\nvertex 0 0 0\nvertex {size} 0 0\nvertex 0 {size} 0\nendloop\nendfacet\n\
             endsolid\n"
        );
        let obj = format!("v 0 0 0\nv {size} 0 0\nv 0 {size} 0\nf 1 2 3\n");
        for (ending, text) in [("stl", stl), ("obj", obj)] {
            let Ok(read) = read_bytes(ending, text.as_bytes()) else {
                continue;
            };
            let m = mesh(read);
            let scene = m.to_scene();
            assert!(scene.validate().is_ok(), "{ending} {size}");
            let area = mesh_facts(&m).area;
            assert!(area.is_finite() && area >= 0.0, "{ending} {size}: {area}");
            let patches = scene.mesh.patches.iter();
            for v in patches.flat_map(|p| &p.vertices) {
                let off = (v.normal - DVec3::Z).length();
                assert!(off < 1e-12, "{ending} {size}: {}", v.normal);
            }
        }
    }
}
