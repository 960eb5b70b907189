//! `.vtu`: the XML head and the raw blocks it points to.

use super::*;

#[test]
fn every_array_is_where_the_head_says() {
    let mut scene = varied();
    let values = scene
        .mesh
        .patches
        .iter()
        .map(|p| (0..p.vertices.len()).map(|i| i as f64 / 7.0).collect())
        .collect();
    scene.fields.push(crate::Field {
        name: "height < 1".into(),
        unit: "mm".into(),
        values,
        unbounded: [false; 2],
    });
    let (report, bytes) = written(&scene, "vtu");
    let text = std::str::from_utf8(&bytes).unwrap();
    let xml = roxmltree::Document::parse(text).unwrap();
    let appended = xml
        .descendants()
        .find(|n| n.has_tag_name("AppendedData"))
        .unwrap();
    assert_eq!(appended.attribute("encoding"), Some("base64"));
    let data = appended
        .text()
        .unwrap()
        .trim_start()
        .strip_prefix('_')
        .unwrap();
    let block = |name: &str| {
        use base64::Engine;
        let decode = |s: &str| base64::engine::general_purpose::STANDARD.decode(s).unwrap();
        let tag = xml
            .descendants()
            .find(|n| n.attribute("Name") == Some(name))
            .unwrap();
        let text = &data[tag.attribute("offset").unwrap().parse::<usize>().unwrap()..];
        let length = u64::from_le_bytes(decode(&text[..12])[..8].try_into().unwrap()) as usize;
        decode(&text[..(length + 8).div_ceil(3) * 4])[8..].to_vec()
    };
    let floats = |name: &str| -> Vec<f64> {
        block(name)
            .chunks(8)
            .map(|c| f64::from_le_bytes(c.try_into().unwrap()))
            .collect()
    };
    let ints = |name: &str| -> Vec<i64> {
        block(name)
            .chunks(8)
            .map(|c| i64::from_le_bytes(c.try_into().unwrap()))
            .collect()
    };
    let piece = xml.descendants().find(|n| n.has_tag_name("Piece")).unwrap();
    let count = |a: &str| piece.attribute(a).unwrap().parse::<usize>().unwrap();
    let vertices: Vec<_> = scene
        .patches()
        .flat_map(|(_, p)| p.vertices.clone())
        .collect();
    let on_curves = scene.curves[0].points.len();
    assert_eq!(count("NumberOfPoints"), vertices.len() + on_curves);
    assert_eq!(count("NumberOfCells"), report.triangles + on_curves - 1);
    let (points, normals, uvs, ids) = (
        floats("Points"),
        floats("Normals"),
        floats("uv"),
        ints("point_id"),
    );
    let field = floats("height < 1");
    for (i, v) in vertices.iter().enumerate() {
        assert_eq!(
            DVec3::from_slice(&points[3 * i..]),
            scene.mesh.points[v.point as usize]
        );
        assert_eq!(DVec3::from_slice(&normals[3 * i..]), v.normal);
        assert_eq!(uvs[2 * i..2 * i + 2], v.uv);
        assert_eq!(ids[i], i64::from(v.point));
    }
    assert_eq!(field[..4], [0.0, 1.0 / 7.0, 2.0 / 7.0, 3.0 / 7.0]);
    assert!(field[vertices.len()..].iter().all(|x| x.is_nan()));
    let (connectivity, offsets) = (ints("connectivity"), ints("offsets"));
    assert_eq!(*offsets.last().unwrap() as usize, connectivity.len());
    assert_eq!(
        connectivity.len(),
        3 * report.triangles + 2 * (on_curves - 1)
    );
    let by_point: Vec<[i64; 3]> = connectivity[..3 * report.triangles]
        .chunks(3)
        .map(|c| [ids[c[0] as usize], ids[c[1] as usize], ids[c[2] as usize]])
        .collect();
    assert_closed(&by_point);
    let types = block("types");
    assert!(
        types[..report.triangles].iter().all(|&t| t == 5)
            && types[report.triangles..].iter().all(|&t| t == 3)
    );
    let surfaces: Vec<i32> = block("surface")
        .chunks(4)
        .map(|c| i32::from_le_bytes(c.try_into().unwrap()))
        .collect();
    assert_eq!(
        (surfaces[0], surfaces[12], *surfaces.last().unwrap()),
        (0, 6, -1)
    );
    for (index, part) in scene.parts.iter().enumerate() {
        let name = format!("surface {}", part.name);
        let tag = xml
            .descendants()
            .find(|n| n.attribute("Name") == Some(&name))
            .unwrap();
        assert_eq!(tag.text(), Some(index.to_string().as_str()));
    }
}
