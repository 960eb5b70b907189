//! STL, as text and binary.
//!
//! Corners with the same numbers are one point. Text is told from binary by the size of the file: a binary file has 84
//! bytes and 50 for each triangle that it counts, and may begin with `solid` as text does. Stored normals are not used:
//! the order of the corners says the same.
//! Source: 3D Systems, *StereoLithography Interface Specification*, 1989.

use super::weld::Weld;
use super::{Fault, number, shown};
use crate::triangles::{Group, TriangleMesh};
use glam::DVec3;
use nappe::Units;

/// Bytes before the count.
const HEADER: usize = 80;
/// Bytes before the triangles.
const HEAD: usize = HEADER + 4;
/// Bytes of a triangle.
const TRIANGLE: usize = 50;

pub(super) fn read(bytes: &[u8]) -> Result<TriangleMesh, Fault> {
    let counted = bytes.get(HEADER..HEAD).map(u32_of);
    let whole = |n: usize| n.checked_mul(TRIANGLE).map(|b| b + HEAD);
    if counted.is_some_and(|n| whole(n as usize) == Some(bytes.len())) {
        return binary(bytes, counted.unwrap_or(0) as usize);
    }
    let start = bytes.trim_ascii_start();
    if start.len() >= 5 && start[..5].eq_ignore_ascii_case(b"solid") && is_text(bytes) {
        return text(bytes);
    }
    match counted {
        // What comes after the triangles is ignored: some programs fill up blocks.
        Some(n) if whole(n as usize).is_some_and(|w| w < bytes.len()) => binary(bytes, n as usize),
        Some(n) => {
            let there = (bytes.len() - HEAD) / TRIANGLE;
            Err(Fault::byte(
                bytes.len(),
                format!("the file ends here, after {there} of the {n} triangles that it counts"),
            ))
        }
        None => Err(Fault::byte(
            bytes.len(),
            "the file ends here: neither text that begins with `solid`, nor the 84 bytes at the head of a binary file",
        )),
    }
}

fn u32_of(b: &[u8]) -> u32 {
    u32::from_le_bytes([b[0], b[1], b[2], b[3]])
}

/// Binary files have zeros or other control characters in their head.
fn is_text(bytes: &[u8]) -> bool {
    let head = &bytes[..bytes.len().min(512)];
    head.iter().all(|b| *b >= b' ' || b.is_ascii_whitespace())
}

fn binary(bytes: &[u8], count: usize) -> Result<TriangleMesh, Fault> {
    let mut weld = Weld::default();
    let mut triangles = Vec::with_capacity(count);
    for (i, t) in bytes[HEAD..].chunks_exact(TRIANGLE).take(count).enumerate() {
        let mut triangle = [0; 3];
        for (k, corner) in triangle.iter_mut().enumerate() {
            let at = 12 + 12 * k;
            let [x, y, z] = [0, 4, 8].map(|c| f32::from_bits(u32_of(&t[at + c..])));
            let p = DVec3::new(x.into(), y.into(), z.into());
            if !p.is_finite() {
                return Err(Fault::byte(
                    HEAD + i * TRIANGLE + at,
                    format!(
                        "corner {k} of triangle {i} is at {p}: coordinates must be finite numbers"
                    ),
                ));
            }
            *corner = weld.number(p)?;
        }
        triangles.push(triangle);
    }
    let head = String::from_utf8_lossy(&bytes[..HEADER]);
    // The head that this project writes names the unit.
    let units = head
        .trim_end_matches('\0')
        .strip_prefix("nappe binary STL, ")
        .and_then(Units::from_symbol);
    Ok(TriangleMesh {
        units,
        points: weld.points,
        groups: vec![Group {
            triangles,
            ..Group::default()
        }],
        ..TriangleMesh::default()
    })
}

fn text(bytes: &[u8]) -> Result<TriangleMesh, Fault> {
    let text = String::from_utf8_lossy(bytes);
    let mut weld = Weld::default();
    let mut groups: Vec<Group> = Vec::new();
    let mut corners: Vec<DVec3> = Vec::new();
    let mut last = 0;
    for (i, line) in text.lines().enumerate() {
        let n = i + 1;
        last = n;
        let mut words = line.split_whitespace();
        let Some(word) = words.next() else { continue };
        match word.to_ascii_lowercase().as_str() {
            "solid" => groups.push(Group {
                name: line.trim()[5..].trim().to_owned(),
                ..Group::default()
            }),
            "vertex" => {
                let numbers: Vec<f64> = words.map_while(number).collect();
                let [x, y, z] = numbers[..] else {
                    let line = shown(line);
                    return Err(Fault::line(
                        n,
                        format!("`{line}` should be `vertex` and three finite numbers"),
                    ));
                };
                corners.push(DVec3::new(x, y, z));
            }
            "facet" if !corners.is_empty() => {
                return Err(Fault::line(
                    n,
                    "a facet begins inside another; `endfacet` is missing",
                ));
            }
            "facet" => {}
            "endfacet" => {
                let [a, b, c] = corners[..] else {
                    let count = corners.len();
                    return Err(Fault::line(
                        n,
                        format!("this facet has {count} corners, not three"),
                    ));
                };
                let triangle = [weld.number(a)?, weld.number(b)?, weld.number(c)?];
                match groups.last_mut() {
                    Some(g) => g.triangles.push(triangle),
                    None => return Err(Fault::line(n, "a facet before any `solid`")),
                }
                corners.clear();
            }
            "outer" | "endloop" | "endsolid" | "color" | "colour" => {}
            _ => {
                let word = shown(word);
                return Err(Fault::line(
                    n,
                    format!(
                        "`{word}` is no word of an STL file: solid, facet, outer, vertex, endloop, endfacet, endsolid"
                    ),
                ));
            }
        }
    }
    if !corners.is_empty() {
        return Err(Fault::line(last, "the file ends inside a facet"));
    }
    Ok(TriangleMesh {
        points: weld.points,
        groups,
        ..TriangleMesh::default()
    })
}
