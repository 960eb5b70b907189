//! Tables of points: aerofoils and rows of points (`.dat`), control points (`.cpt`).
//!
//! An aerofoil has a line with its name and two numbers a line: either once round from the trailing edge (Selig), or
//! the numbers of points of the upper and lower side and then both from the leading edge (Lednicer). Both become the cubic
//! spline through the points, from the trailing edge over the upper side; between the points its course is not in the file.
//! Everything else is read as points.

use super::sheet::{dots, wire};
use super::{Fault, number, shown};
use crate::document::Document;
use glam::DVec3;
use nappe::curve::{InterpolateOptions, interpolate};
use std::sync::Arc;

/// A row of numbers, and its line.
type Row = (usize, Vec<f64>);

/// A table of an aerofoil, or of points in space.
pub(super) fn read(bytes: &[u8]) -> Result<Document, Fault> {
    let text = String::from_utf8_lossy(bytes);
    let mut title = None;
    let mut rows: Vec<Row> = Vec::new();
    for (i, line) in text.lines().enumerate() {
        let content = line.split('#').next().unwrap_or_default();
        let words = || {
            content
                .split([' ', '\t', ',', ';'])
                .map(str::trim)
                .filter(|w| !w.is_empty())
        };
        let row: Option<Vec<f64>> = words().map(number).collect();
        match row {
            Some(row) if row.is_empty() => {}
            Some(row) if row.len() > 1 => rows.push((i + 1, row)),
            // The name comes first, and may be a number.
            _ if rows.is_empty() && title.is_none() => title = Some(line.trim().to_owned()),
            _ => {
                return Err(Fault::line(
                    i + 1,
                    format!(
                        "`{}` should be two or three finite numbers",
                        shown(content.trim())
                    ),
                ));
            }
        }
    }
    let Some(width) = rows.first().map(|r| r.1.len()) else {
        return Err(Fault::whole("the table has no points"));
    };
    if let Some((line, row)) = rows.iter().find(|r| r.1.len() != width || width > 3) {
        return Err(Fault::line(
            *line,
            format!(
                "{} numbers; all lines should have two (an aerofoil) or three (points)",
                row.len()
            ),
        ));
    }
    let name = crate::text::line(title.unwrap_or_default().trim());
    let first = rows[0].0;
    let item = if width == 3 {
        let points = rows.iter().map(|(_, r)| DVec3::new(r[0], r[1], r[2]));
        dots(name, points.collect())
    } else {
        let mut points = outline(&rows)?;
        points.dedup();
        interpolate(&points, InterpolateOptions::default())
            .map_err(|e| e.to_string())
            .and_then(|c| wire(name, Arc::new(c)))
    };
    Ok(Document {
        items: vec![item.map_err(|e| Fault::line(first, e))?],
        ..Document::default()
    })
}

/// The points of an aerofoil once round, whichever way they are listed.
fn outline(rows: &[Row]) -> Result<Vec<DVec3>, Fault> {
    let all: Vec<DVec3> = rows
        .iter()
        .map(|(_, r)| DVec3::new(r[0], r[1], 0.0))
        .collect();
    let (head, points) = (all[0], &all[1..]);
    let whole = |x: f64| x >= 2.0 && x.fract() == 0.0;
    // Coordinates are parts of the chord; only the numbers of points are larger than it.
    let counts = whole(head.x) && whole(head.y) && points.iter().all(|p| p.x.abs() < 2.0);
    if !counts {
        return Ok(all);
    }
    if head.x + head.y != points.len() as f64 {
        return Err(Fault::line(
            rows[0].0,
            format!(
                "{} and {} points are announced, and {} follow",
                head.x,
                head.y,
                points.len()
            ),
        ));
    }
    let (upper, lower) = points.split_at(head.x as usize);
    Ok(upper.iter().rev().chain(lower).copied().collect())
}

/// Control points: `x,y,z` with `;` between the points of a row, one row a line. The degrees are not in the file, so they
/// stay points; a net has an item for each row.
pub(super) fn control_points(bytes: &[u8]) -> Result<Document, Fault> {
    let text = String::from_utf8_lossy(bytes);
    let mut rows: Vec<(usize, Vec<DVec3>)> = Vec::new();
    for (i, line) in text.lines().enumerate() {
        // A first line of quoted names.
        if line.trim().is_empty() || (rows.is_empty() && line.trim_start().starts_with('"')) {
            continue;
        }
        let points: Option<Vec<DVec3>> = line
            .trim()
            .trim_end_matches(';')
            .split(';')
            .map(point)
            .collect();
        let points = points.ok_or_else(|| {
            let line = shown(line.trim());
            Fault::line(
                i + 1,
                format!("`{line}` should be points `x,y,z`, with `;` between them"),
            )
        })?;
        rows.push((i + 1, points));
    }
    let Some(width) = rows.first().map(|r| r.1.len()) else {
        return Err(Fault::whole("the table has no points"));
    };
    if let Some((line, row)) = rows.iter().find(|r| r.1.len() != width) {
        return Err(Fault::line(
            *line,
            format!("a row of {} points after rows of {width}", row.len()),
        ));
    }
    let first = rows[0].0;
    let items: Result<Vec<_>, String> = if width == 1 {
        let points = rows.into_iter().flat_map(|r| r.1).collect();
        dots(String::new(), points).map(|i| vec![i])
    } else {
        let rows = rows.into_iter().enumerate();
        rows.map(|(i, r)| dots(format!("row {}", i + 1), r.1))
            .collect()
    };
    Ok(Document {
        items: items.map_err(|e| Fault::line(first, e))?,
        ..Document::default()
    })
}

fn point(text: &str) -> Option<DVec3> {
    let xs: Option<Vec<f64>> = text.split(',').map(|w| number(w.trim())).collect();
    match xs?[..] {
        [x, y] => Some(DVec3::new(x, y, 0.0)),
        [x, y, z] => Some(DVec3::new(x, y, z)),
        _ => None,
    }
}
