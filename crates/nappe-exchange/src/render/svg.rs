//! A stage as an SVG file: true vectors.
//!
//! Surfaces become filled shapes, painted from back to front. Which must be painted before which is found with the
//! z-buffer: at every sample, what is seen comes after all else that covers it; triangles seen nowhere are left out.
//! (Surfaces that cut through each other have no such order; there the deeper triangle is painted first.) Where a
//! triangle's corners differ in colour it is split, and pieces of one colour become one shape, so the size of the file
//! follows the picture, not the mesh: about 0.1 to 1 MB. Text stays text; lines are cut where surfaces hide them.

use super::colour::{encoded, hex, mapped};
use super::lines::{Depth, Span, spans};
use super::marks::{Anchor, Mark};
use super::pieces::{Shape, shapes};
use super::raster::{Band, NONE, Shown, band, by_band, each_sample, project};
use super::stage::Stage;
use super::view::Pixel;
use crate::report::Progress;
use crate::text::xml;
use glam::DVec2;
use std::fmt::Write;

/// Samples along a pixel's side.
const PER: usize = 2;
/// Pixel rows that are sampled at once.
const ROWS: usize = 32;
/// Nearness that differs less, relatively, is the same: neighbours on their common edge.
const SAME: f64 = 1e-7;
/// Width of the outline, in the fill's colour, that closes the hairlines between neighbouring shapes.
const OVERLAP: f64 = 0.6;

/// The text of the file and the number of shapes in it.
pub(crate) fn svg(stage: &Stage<'_>, progress: Progress<'_>) -> (String, usize) {
    let shown = project(stage.scene, &stage.camera);
    let (depth, before, seen) = order(stage, &shown, progress);
    let layers = layers(&shown, &before, &seen);
    let shapes = shapes(stage, &shown, &layers);
    progress.tell(0.9);
    let mut out = String::new();
    // Writing to a string cannot fail.
    let _ = document(stage, &shapes, &depth, &mut out);
    (out, shapes.len())
}

/// The distances, the pairs (first, then) in which triangles must be painted, and which triangles are seen.
fn order(
    stage: &Stage<'_>,
    shown: &[Shown],
    progress: Progress<'_>,
) -> (Depth, Vec<(u32, u32)>, Vec<bool>) {
    let (width, height) = (
        stage.options.size[0] as usize,
        stage.options.size[1] as usize,
    );
    let lists = by_band(shown, height, ROWS);
    let mut far = Vec::with_capacity(width * height);
    let (mut pairs, mut seen) = (Vec::new(), vec![false; shown.len()]);
    for (index, list) in lists.iter().enumerate() {
        let rows = ROWS.min(height - index * ROWS);
        let (samples_wide, top, samples_high) = (width * PER, index * ROWS * PER, rows * PER);
        let samples = band(shown, list, samples_wide, top, samples_high, PER);
        far.extend(Depth::of_band(&samples, PER, &stage.camera));
        samples
            .seen
            .iter()
            .filter(|s| **s != NONE)
            .for_each(|&s| seen[s as usize] = true);
        for &number in list {
            let mut last = NONE;
            each_sample(
                &shown[number as usize].corners,
                samples_wide,
                top,
                samples_high,
                PER,
                |at, near| {
                    let front = samples.seen[at];
                    let same = (samples.near[at] - near).abs() <= SAME * near.abs();
                    if front != number && front != last && !same {
                        last = front;
                        pairs.push((number, front));
                    }
                },
            );
        }
        for &number in list {
            seen[number as usize] |= is_between(shown, number, &samples, top);
        }
        progress.tell(0.6 * index as f64 / lists.len() as f64);
    }
    pairs.retain(|p| seen[p.0 as usize]);
    pairs.sort_unstable();
    pairs.dedup();
    (Depth { width, height, far }, pairs, seen)
}

/// Whether a triangle that no sample hit is to be painted all the same: its middle is not behind all of the samples
/// around it, and they show its side. Such slivers make the rim of a finely meshed surface.
fn is_between(shown: &[Shown], number: u32, samples: &Band, top: usize) -> bool {
    let own = &shown[number as usize];
    let mean = |f: fn(&Pixel) -> f64| own.corners.iter().map(f).sum::<f64>() / 3.0;
    let (x, y) = (
        mean(|c| c.x) * PER as f64 - 0.5,
        mean(|c| c.y) * PER as f64 - 0.5 - top as f64,
    );
    let (mut before, mut same_side) = (false, true);
    for (x, y) in
        [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0)].map(|d| (x.floor() + d.0, y.floor() + d.1))
    {
        if x < 0.0 || y < 0.0 || x >= samples.width as f64 || y >= samples.height as f64 {
            continue;
        }
        let at = y as usize * samples.width + x as usize;
        before |= samples.near[at] <= mean(|c| c.near);
        same_side &= samples.seen[at] == NONE || shown[samples.seen[at] as usize].back == own.back;
    }
    before && same_side
}

/// The seen triangles in layers: none must be painted before another of its layer.
fn layers(shown: &[Shown], before: &[(u32, u32)], seen: &[bool]) -> Vec<Vec<u32>> {
    let mut waits = vec![0u32; shown.len()];
    for (_, then) in before {
        waits[*then as usize] += 1;
    }
    let mut left: Vec<u32> = (0..shown.len() as u32)
        .filter(|&n| seen[n as usize])
        .collect();
    let nearness = |n: u32| {
        shown[n as usize]
            .corners
            .iter()
            .map(|c| c.near)
            .sum::<f64>()
    };
    let mut out = Vec::new();
    while !left.is_empty() {
        let (mut layer, mut rest): (Vec<u32>, Vec<u32>) =
            left.iter().partition(|&&n| waits[n as usize] == 0);
        if layer.is_empty() {
            // Triangles that cut through each other: the deepest goes first.
            if let Some(k) =
                (0..rest.len()).min_by(|&a, &b| nearness(rest[a]).total_cmp(&nearness(rest[b])))
            {
                layer.push(rest.swap_remove(k));
                rest.sort_unstable();
            }
        }
        for &n in &layer {
            let first = before.partition_point(|p| p.0 < n);
            for (_, then) in before[first..].iter().take_while(|p| p.0 == n) {
                waits[*then as usize] = waits[*then as usize].saturating_sub(1);
            }
        }
        out.push(layer);
        left = rest;
    }
    out
}

fn document(
    stage: &Stage<'_>,
    shapes: &[Shape],
    depth: &Depth,
    out: &mut String,
) -> std::fmt::Result {
    let [w, h] = stage.options.size;
    writeln!(
        out,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{w}" height="{h}" viewBox="0 0 {w} {h}">"#
    )?;
    if let Some(title) = &stage.scene.title {
        writeln!(out, "<title>{}</title>", xml(title))?;
    }
    if let Some([top, bottom]) = stage.theme.background {
        writeln!(
            out,
            r#"<linearGradient id="background" x2="0" y2="1"><stop stop-color="{}"/><stop offset="1" stop-color="{}"/></linearGradient>"#,
            hex(top),
            hex(bottom)
        )?;
        writeln!(
            out,
            r#"<rect width="{w}" height="{h}" fill="url(#background)"/>"#
        )?;
    }
    writeln!(
        out,
        r#"<g stroke-width="{OVERLAP}" stroke-linejoin="round">"#
    )?;
    for shape in shapes {
        let colour = hex(shape.colour.map(encoded));
        writeln!(
            out,
            r#"<path fill="{colour}" stroke="{colour}" d="{}"/>"#,
            shape.path
        )?;
    }
    writeln!(out, "</g>")?;
    writeln!(
        out,
        r#"<g fill="none" stroke-linecap="round" stroke-linejoin="round">"#
    )?;
    for line in &stage.lines {
        let spans = spans(&line.points, &stage.camera, depth, stage.bias);
        for (seen, opacity) in [(false, line.opacity * line.hidden), (true, line.opacity)] {
            let d = path(spans.iter().filter(|s| s.seen == seen));
            if opacity > 0.0 && !d.is_empty() {
                let (colour, width) = (hex(line.colour), tenths(line.width));
                writeln!(
                    out,
                    r#"<path stroke="{colour}" stroke-width="{width}" opacity="{opacity:.3}" d="{d}"/>"#
                )?;
            }
        }
    }
    writeln!(out, "</g>")?;
    for dot in &stage.dots {
        let p = stage.camera.project(dot.at);
        let opacity = if depth.shows(p, &stage.camera, stage.bias) {
            ""
        } else {
            r#" opacity="0.3""#
        };
        let (x, y, r) = (tenths(p.x), tenths(p.y), tenths(dot.radius));
        writeln!(
            out,
            r#"<circle cx="{x}" cy="{y}" r="{r}" fill="{}"{opacity}/>"#,
            hex(dot.colour)
        )?;
    }
    writeln!(
        out,
        r#"<g font-family="Roboto, 'Helvetica Neue', Arial, sans-serif">"#
    )?;
    for mark in &stage.marks {
        self::mark(mark, out)?;
    }
    writeln!(out, "</g>\n</svg>")
}

/// A coordinate with one decimal.
fn tenths(x: f64) -> String {
    let s = format!("{x:.1}");
    s.strip_suffix(".0").map(str::to_owned).unwrap_or(s)
}

fn path<'a>(spans: impl Iterator<Item = &'a Span>) -> String {
    let mut d = String::new();
    for span in spans {
        for (k, p) in span.points.iter().enumerate() {
            let command = match k {
                0 => "M",
                1 => "L",
                _ => " ",
            };
            let _ = write!(d, "{command}{} {}", tenths(p.x), tenths(p.y));
        }
    }
    d
}

fn mark(mark: &Mark, out: &mut String) -> std::fmt::Result {
    match mark {
        Mark::Text {
            at,
            size,
            anchor,
            colour,
            text,
        } => {
            let anchor = match anchor {
                Anchor::Start => "",
                Anchor::Middle => r#" text-anchor="middle""#,
            };
            let (x, y, size) = (tenths(at.x), tenths(at.y), tenths(*size));
            writeln!(
                out,
                r#"<text x="{x}" y="{y}" font-size="{size}"{anchor} fill="{}">{}</text>"#,
                hex(*colour),
                xml(text)
            )
        }
        Mark::Stroke {
            from,
            to,
            width,
            colour,
        } => {
            let d = path(
                [Span {
                    points: vec![*from, *to],
                    seen: true,
                }]
                .iter(),
            );
            let (colour, width) = (hex(*colour), tenths(*width));
            writeln!(
                out,
                r#"<path stroke="{colour}" stroke-width="{width}" stroke-linecap="round" d="{d}"/>"#
            )
        }
        Mark::Bar { min, max, map } => {
            const STOPS: usize = 40;
            write!(
                out,
                r#"<linearGradient id="colours" x1="0" y1="1" x2="0" y2="0">"#
            )?;
            for k in 0..=STOPS {
                let share = k as f64 / STOPS as f64;
                write!(
                    out,
                    r#"<stop offset="{share:.3}" stop-color="{}"/>"#,
                    hex(mapped(*map, share))
                )?;
            }
            let size: DVec2 = *max - *min;
            let (x, y, w, h) = (tenths(min.x), tenths(min.y), tenths(size.x), tenths(size.y));
            writeln!(out, "</linearGradient>")?;
            writeln!(
                out,
                r#"<rect x="{x}" y="{y}" width="{w}" height="{h}" fill="url(#colours)"/>"#
            )
        }
    }
}
