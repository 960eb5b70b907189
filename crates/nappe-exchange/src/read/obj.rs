//! Wavefront OBJ: `v`, `f`, `l`, `o`, `g`; polygons are cut into triangles.
//!
//! Stored normals and texture coordinates are passed over, and so are materials, whose colours are in another file.
//! Source: Wavefront, *Object Files*, Advanced Visualizer manual, appendix B1.

use super::polygon::triangulate;
use super::{Fault, MOST, number, shown};
use crate::scene::Polyline;
use crate::triangles::{Group, TriangleMesh};
use glam::DVec3;
use nappe::Units;

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, Fault> {
    let text = String::from_utf8_lossy(bytes);
    let mut mesh = TriangleMesh::default();
    let (mut name, mut shapes, mut crossed) = (String::new(), 0, 0);
    let mut open = false;
    let mut lines = text.lines().enumerate();
    let mut joined = String::new();
    while let Some((i, line)) = lines.next() {
        let n = i + 1;
        // A backslash at the end continues the line.
        let mut line = line;
        if line.ends_with('\\') {
            joined.clear();
            while let Some(part) = line.strip_suffix('\\') {
                joined.push_str(part);
                joined.push(' ');
                line = lines.next().map_or("", |(_, l)| l);
            }
            joined.push_str(line);
            line = &joined;
        }
        if let Some(unit) = line.strip_prefix("# units:") {
            mesh.units = Units::from_symbol(unit.trim());
        }
        let line = line.split('#').next().unwrap_or_default();
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let coordinates: Vec<f64> = words.by_ref().take(3).map_while(number).collect();
                let [x, y, z] = coordinates[..] else {
                    let line = shown(line);
                    return Err(Fault::line(
                        n,
                        format!("`{line}` should be `v` and three finite numbers"),
                    ));
                };
                if mesh.points.len() >= MOST {
                    return Err(Fault::line(n, "more points than 32 bits can number"));
                }
                mesh.points.push(DVec3::new(x, y, z));
            }
            Some("f") => {
                let corners = corners(words, mesh.points.len()).map_err(|e| Fault::line(n, e))?;
                let points: Vec<DVec3> = corners.iter().map(|&c| mesh.points[c as usize]).collect();
                let (cut, crosses) = triangulate(&points).map_err(|e| Fault::line(n, e))?;
                crossed += usize::from(crosses);
                if !open {
                    open = true;
                    mesh.groups.push(Group {
                        name: name.clone(),
                        ..Group::default()
                    });
                }
                if let Some(group) = mesh.groups.last_mut() {
                    let global = cut.into_iter().map(|t| t.map(|k| corners[k as usize]));
                    group.triangles.extend(global);
                }
            }
            Some("l") => {
                let corners = corners(words, mesh.points.len()).map_err(|e| Fault::line(n, e))?;
                if corners.len() < 2 {
                    return Err(Fault::line(n, "a line of one point; it needs two"));
                }
                mesh.curves.push(Polyline {
                    name: name.clone(),
                    points: corners.iter().map(|&c| mesh.points[c as usize]).collect(),
                });
            }
            Some("g" | "o") => {
                let new = words.collect::<Vec<_>>().join(" ");
                open &= new == name;
                name = new;
            }
            Some("curv" | "curv2" | "surf") => shapes += 1,
            _ => {}
        }
    }
    if shapes > 0 {
        mesh.missing.push(format!("{shapes} free-form curves and surfaces were left out: of .obj files triangles and lines are read."));
    }
    mesh.notes.extend(super::polygon::note(crossed));
    Ok(mesh)
}

/// The points of a face or line: numbers from 1, or back from the last point if negative, before the first slash.
fn corners<'a>(words: impl Iterator<Item = &'a str>, points: usize) -> Result<Vec<u32>, String> {
    words
        .map(|word| {
            let digits = word.split('/').next().unwrap_or_default();
            let index: i64 = digits
                .parse()
                .map_err(|_| format!("`{}` is not a point's number", shown(word)))?;
            let at = if index < 0 {
                points as i64 + index
            } else {
                index - 1
            };
            let there = u32::try_from(at).ok().filter(|&i| (i as usize) < points);
            there.ok_or_else(|| {
                format!("point {index} is named, but there are {points} points so far")
            })
        })
        .collect()
}
