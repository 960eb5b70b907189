//! Files are read back by other people's readers, or by short ones written from the formats' descriptions.

mod gltf_files;
mod text_files;
mod vtu_files;

use crate::{Polyline, Scene, WriteOptions, WriteReport, samples, write};
use glam::DVec3;
use std::collections::HashMap;
use std::path::PathBuf;

/// Writes a scene to a new file and returns the report and the bytes.
fn written(scene: &Scene, ending: &str) -> (WriteReport, Vec<u8>) {
    let dir = tempfile::tempdir().unwrap();
    let path: PathBuf = dir.path().join(format!("scene.{ending}"));
    let report = write(&path, scene, &WriteOptions::default()).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(report.bytes, bytes.len() as u64);
    assert_eq!(std::fs::read_dir(dir.path()).unwrap().count(), 1);
    save(
        &format!("{}.{ending}", scene.title.as_deref().unwrap_or("scene")),
        &bytes,
    );
    (report, bytes)
}

/// Keeps a copy for a person to look at, in the directory that `NAPPE_KEEP` names.
pub(crate) fn save(name: &str, bytes: &[u8]) {
    if let Some(dir) = std::env::var_os("NAPPE_KEEP") {
        std::fs::write(PathBuf::from(dir).join(name), bytes).unwrap();
    }
}

/// A sphere and a cube, with a curve, whose names need escaping.
fn varied() -> Scene {
    let mut scene = samples::cube();
    let sphere = samples::sphere(24, 12);
    let first = scene.mesh.points.len() as u32;
    scene.mesh.points.extend(
        sphere
            .mesh
            .points
            .iter()
            .map(|p| *p * 0.25 + DVec3::new(3.0, 0.5, 0.5)),
    );
    let mut patch = sphere.mesh.patches[0].clone();
    patch.vertices.iter_mut().for_each(|v| v.point += first);
    scene.parts.push(crate::Part::new(
        "a <ball> & \"more\"",
        scene.mesh.patches.len(),
    ));
    scene.mesh.patches.push(patch);
    let points = (0..=20)
        .map(|i| DVec3::new(i as f64 / 5.0, -1.0, (i as f64).sin()))
        .collect();
    scene.curves.push(Polyline {
        name: "rail 1".into(),
        points,
    });
    scene.title = Some("varied".into());
    scene
}

/// The scene far from the origin of space, where f32 has a spacing of 8.
fn far(mut scene: Scene) -> Scene {
    let shift = DVec3::new(1e8, -1e8, 1e8);
    scene.mesh.points.iter_mut().for_each(|p| *p += shift);
    scene
        .curves
        .iter_mut()
        .flat_map(|c| &mut c.points)
        .for_each(|p| *p += shift);
    scene.title = Some("far".into());
    scene
}

/// Asserts that every edge is used once in each direction.
fn assert_closed<K: std::hash::Hash + Eq + Copy + std::fmt::Debug>(triangles: &[[K; 3]]) {
    let mut edges: HashMap<(K, K), usize> = HashMap::new();
    for t in triangles {
        for k in 0..3 {
            *edges.entry((t[k], t[(k + 1) % 3])).or_default() += 1;
        }
    }
    for (&(a, b), &n) in &edges {
        assert_eq!((n, edges.get(&(b, a))), (1, Some(&1)), "edge {a:?} {b:?}");
    }
}

/// Six times the enclosed volume.
fn volume6(triangles: &[[DVec3; 3]]) -> f64 {
    triangles.iter().map(|t| t[0].dot(t[1].cross(t[2]))).sum()
}

fn bits(p: [f32; 3]) -> [u32; 3] {
    p.map(|x| (x + 0.0).to_bits())
}
