//! `.stl`, `.obj`, `.ply`, `.3mf`: shared points, orientation, precision.

use super::*;
use crate::{ExchangeError, SceneError};
use std::io::{BufReader, Cursor, Read};

fn stl_triangles(bytes: &[u8]) -> Vec<stl_io::Triangle> {
    stl_io::create_stl_reader(&mut Cursor::new(bytes))
        .unwrap()
        .map(Result::unwrap)
        .collect()
}

#[test]
fn stl_is_closed_with_right_volume_and_normals() {
    let mut scene = varied();
    // One face of the cube turned inside: the file must hold it turned back.
    scene.mesh.patches[2]
        .triangles
        .iter_mut()
        .for_each(|t| t.swap(0, 1));
    let (report, bytes) = written(&scene, "stl");
    assert!(
        report
            .notes
            .iter()
            .any(|n| n.starts_with("1 of 7 surfaces")),
        "{:?}",
        report.notes
    );
    assert_eq!(bytes.len(), 84 + 50 * report.triangles);
    let read = stl_triangles(&bytes);
    let corners: Vec<[[f32; 3]; 3]> = read.iter().map(|t| t.vertices.map(|v| v.0)).collect();
    assert_closed(&corners.iter().map(|t| t.map(bits)).collect::<Vec<_>>());
    let points = |t: &[[f32; 3]; 3]| t.map(|p| DVec3::from(p.map(f64::from)));
    assert!((volume6(&corners[..12].iter().map(points).collect::<Vec<_>>()) - 6.0).abs() < 1e-6);
    for (t, c) in read.iter().zip(&corners) {
        let [a, b, c] = points(c);
        let n = DVec3::from(t.normal.0.map(f64::from));
        assert!((n.length() - 1.0).abs() < 1e-6 && n.dot((b - a).cross(c - a).normalize()) > 0.999);
    }
}

#[test]
fn stl_far_from_the_origin_says_what_it_lost() {
    // Around 1e8 the numbers of f32 are 8 apart: the cube of 200 keeps its corners, the sphere's cells of about 6 do not.
    let mut scene = varied();
    scene.mesh.points.iter_mut().for_each(|p| *p *= 200.0);
    scene.curves.clear();
    let (report, bytes) = written(&far(scene), "stl");
    assert!(
        report.dropped_degenerate > 0 && report.rounding > 1.0,
        "{report:?}"
    );
    assert!(report.deviation.error() >= report.rounding);
    assert!(
        report.notes.iter().any(|n| n.contains("f32")),
        "{:?}",
        report.notes
    );
    // What is left is still closed: edges cancel in pairs (two sheets may now touch).
    let mut edges: HashMap<_, i64> = HashMap::new();
    for t in stl_triangles(&bytes) {
        let v = t.vertices.map(|v| bits(v.0));
        assert!(v[0] != v[1] && v[1] != v[2] && v[2] != v[0]);
        assert!(t.normal.0.iter().all(|x| x.is_finite()));
        for k in 0..3 {
            *edges.entry((v[k], v[(k + 1) % 3])).or_default() += 1;
            *edges.entry((v[(k + 1) % 3], v[k])).or_default() -= 1;
        }
    }
    assert!(edges.values().all(|&n| n == 0));
}

#[test]
fn obj_keeps_points_bit_for_bit_and_groups_by_name() {
    let scene = varied();
    let (_, bytes) = written(&scene, "obj");
    let text = String::from_utf8(bytes.clone()).unwrap();
    let points: Vec<DVec3> = text
        .lines()
        .filter_map(|l| l.strip_prefix("v "))
        .map(|l| DVec3::from_slice(&l.split(' ').map(|x| x.parse().unwrap()).collect::<Vec<_>>()))
        .collect();
    assert_eq!(points[..scene.mesh.points.len()], scene.mesh.points);
    let options = tobj::LoadOptions {
        triangulate: false,
        single_index: false,
        ignore_lines: false,
        ignore_points: false,
    };
    let (models, _) = tobj::load_obj_buf(&mut BufReader::new(&bytes[..]), &options, |_| {
        Err(tobj::LoadError::GenericFailure)
    })
    .unwrap();
    let names: Vec<_> = models.iter().map(|m| m.name.as_str()).collect();
    assert_eq!(
        names,
        [
            "bottom",
            "top",
            "front",
            "back",
            "left",
            "right",
            "a_<ball>_&_\"more\"",
            "rail_1"
        ]
    );
    let mut cube = Vec::new();
    for (model, (_, patch)) in models.iter().zip(scene.patches()) {
        let m = &model.mesh;
        assert_eq!(m.indices.len(), 3 * patch.triangles.len());
        for (k, v) in patch
            .triangles
            .iter()
            .flatten()
            .map(|&i| patch.vertices[i as usize])
            .enumerate()
        {
            let n = 3 * m.normal_indices[k] as usize;
            assert!((0..3).all(|c| (f64::from(m.normals[n + c]) - v.normal[c]).abs() < 1e-7));
            let t = 2 * m.texcoord_indices[k] as usize;
            assert!((0..2).all(|c| m.texcoords[t + c] == v.uv[c] as f32));
        }
        if patch.triangles.len() == 2 {
            for t in m.indices.chunks(3) {
                let p = |i: u32| bits([0, 1, 2].map(|c| m.positions[3 * i as usize + c]));
                cube.push([p(t[0]), p(t[1]), p(t[2])]);
            }
        }
    }
    assert_closed(&cube);
}

#[test]
fn ply_has_shared_points_and_the_parameters_of_every_corner() {
    let scene = far(varied());
    let (report, bytes) = written(&scene, "ply");
    assert_eq!(report.rounding, 0.0);
    let end = bytes
        .windows(11)
        .position(|w| w == b"end_header\n")
        .unwrap()
        + 11;
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    assert!(header.starts_with("ply\nformat binary_little_endian 1.0\n"));
    assert!(header.contains("comment surface 6: a <ball> & \"more\"\n"));
    assert!(header.contains(&format!("element vertex {}\n", scene.mesh.points.len())));
    assert!(header.contains(&format!("element face {}\n", scene.triangles())));
    let mut body = Cursor::new(&bytes[end..]);
    fn take<const N: usize>(c: &mut Cursor<&[u8]>) -> [u8; N] {
        let mut b = [0; N];
        c.read_exact(&mut b).unwrap();
        b
    }
    for p in &scene.mesh.points {
        let read = DVec3::from([0; 3].map(|_| f64::from_le_bytes(take(&mut body))));
        assert_eq!(read, *p);
        let n = DVec3::from([0; 3].map(|_| f64::from(f32::from_le_bytes(take(&mut body)))));
        assert!((n.length() - 1.0).abs() < 1e-6);
    }
    let mut triangles = Vec::new();
    for (index, (_, patch)) in scene.patches().enumerate() {
        for t in &patch.triangles {
            let v = t.map(|i| patch.vertices[i as usize]);
            assert_eq!(take::<1>(&mut body), [3]);
            triangles.push([0; 3].map(|_| u32::from_le_bytes(take(&mut body))));
            assert_eq!(triangles.last().unwrap(), &v.map(|c| c.point));
            for c in v {
                assert_eq!([0; 2].map(|_| f64::from_le_bytes(take(&mut body))), c.uv);
            }
            assert_eq!(i32::from_le_bytes(take(&mut body)), index as i32);
            take::<3>(&mut body);
        }
    }
    assert_eq!(body.position() as usize, bytes.len() - end);
    assert_closed(&triangles);
}

#[test]
fn threemf_is_a_solid_in_its_unit_with_normals_outward() {
    let mut scene = varied();
    scene.units = crate::Units::Inch;
    scene.mesh.patches[3]
        .triangles
        .iter_mut()
        .for_each(|t| t.swap(1, 2));
    let (report, bytes) = written(&scene, "3mf");
    let mut zip = zip::ZipArchive::new(Cursor::new(&bytes)).unwrap();
    let names: Vec<_> = zip.file_names().map(|n| n.unwrap().into_owned()).collect();
    assert_eq!(
        names,
        ["[Content_Types].xml", "_rels/.rels", "3D/3dmodel.model"]
    );
    let mut text = String::new();
    zip.by_name("3D/3dmodel.model")
        .unwrap()
        .read_to_string(&mut text)
        .unwrap();
    let xml = roxmltree::Document::parse(&text).unwrap();
    assert_eq!(xml.root_element().attribute("unit"), Some("inch"));
    let all = |tag: &'static str| {
        xml.descendants().filter(move |n| {
            n.has_tag_name((
                "http://schemas.microsoft.com/3dmanufacturing/core/2015/02",
                tag,
            ))
        })
    };
    let bases: Vec<_> = all("base").map(|b| b.attribute("name").unwrap()).collect();
    assert_eq!(
        bases,
        scene
            .parts
            .iter()
            .map(|p| p.name.as_str())
            .collect::<Vec<_>>()
    );
    assert_eq!(
        all("object").next().unwrap().attribute("type"),
        Some("model")
    );
    let points: Vec<DVec3> = all("vertex")
        .map(|v| {
            DVec3::from(["x", "y", "z"].map(|a| v.attribute(a).unwrap().parse::<f64>().unwrap()))
        })
        .collect();
    assert_eq!(points, scene.mesh.points);
    let triangles: Vec<[usize; 3]> = all("triangle")
        .map(|t| ["v1", "v2", "v3"].map(|a| t.attribute(a).unwrap().parse().unwrap()))
        .collect();
    assert_eq!(triangles.len(), report.triangles);
    assert_closed(&triangles);
    let cube: Vec<_> = triangles[..12]
        .iter()
        .map(|t| t.map(|i| points[i]))
        .collect();
    assert!((volume6(&cube) - 6.0).abs() < 1e-12);
}

#[test]
fn an_open_surface_in_3mf_says_that_it_is_no_solid() {
    let (report, bytes) = written(&samples::saddle(4), "3mf");
    assert!(
        report
            .notes
            .iter()
            .any(|n| n.contains("do not enclose a solid"))
    );
    let mut text = String::new();
    let mut zip = zip::ZipArchive::new(Cursor::new(&bytes)).unwrap();
    zip.by_name("3D/3dmodel.model")
        .unwrap()
        .read_to_string(&mut text)
        .unwrap();
    assert!(text.contains(r#"<object id="2" type="surface""#));
}

#[test]
fn scenes_that_cannot_be_written_name_the_place_and_leave_no_file() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("x.stl");
    let fails = |scene: &Scene| match write(&path, scene, &WriteOptions::default()) {
        Err(ExchangeError::Scene { source, .. }) => source,
        other => panic!("{other:?}"),
    };
    let mut scene = samples::cube();
    scene.mesh.points[5].y = f64::NAN;
    assert!(matches!(
        fails(&scene),
        SceneError::PointNotFinite { index: 5, .. }
    ));
    let mut scene = samples::cube();
    scene.mesh.patches[3].vertices[1].normal = DVec3::ZERO;
    assert!(matches!(
        fails(&scene),
        SceneError::Normal { vertex: 1, .. }
    ));
    let mut scene = samples::cube();
    scene.mesh.patches[1].triangles[1][2] = 9;
    assert!(matches!(
        fails(&scene),
        SceneError::NoVertex {
            triangle: 1,
            vertex: 9,
            vertices: 4,
            ..
        }
    ));
    let mut scene = samples::cube();
    scene.parts[0].patch = 6;
    assert!(matches!(
        fails(&scene),
        SceneError::NoPatch {
            patch: 6,
            patches: 6,
            ..
        }
    ));
    let empty = Scene::default();
    assert!(matches!(
        write(&path, &empty, &WriteOptions::default()),
        Err(ExchangeError::Nothing { .. })
    ));
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 0);
}

#[test]
fn progress_grows_to_one() {
    let seen = std::sync::Mutex::new(Vec::new());
    let listener = |share: f64| seen.lock().unwrap().push(share);
    let options = WriteOptions {
        progress: crate::Progress::to(&listener),
        ..Default::default()
    };
    let dir = tempfile::tempdir().unwrap();
    for ending in ["glb", "gltf", "stl", "obj", "ply", "3mf", "vtu"] {
        seen.lock().unwrap().clear();
        write(
            &dir.path().join(format!("x.{ending}")),
            &samples::torus(3.0, 1.0, 150, 150),
            &options,
        )
        .unwrap();
        let s = seen.lock().unwrap();
        assert!(
            s.len() > 2 && s.is_sorted() && *s.last().unwrap() == 1.0,
            "{ending}: {s:?}"
        );
    }
}
