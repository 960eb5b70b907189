//! A stage as a PNG file.

use super::Paint;
use super::colour::{encoded, linear, mapped, mix};
use super::ink::Ink;
use super::light::{Place, shade};
use super::lines::{Depth, spans};
use super::marks::Mark;
use super::raster::{Band, NONE, Shown, band, by_band, project, seen_normal, shares};
use super::stage::Stage;
use crate::facets::corners;
use crate::report::Progress;
use glam::{DVec2, DVec3, Vec3};
use std::io;
use std::sync::Mutex;
use std::thread;

/// Samples along a pixel's side: 16 in a pixel make edges smooth.
const PER: usize = 4;
/// Pixel rows that are drawn at once: bounds the memory for samples.
const ROWS: usize = 16;

/// The bytes of the PNG file.
pub(crate) fn png(stage: &Stage<'_>, progress: Progress<'_>) -> io::Result<Vec<u8>> {
    let (ink, _) = draw(stage, progress);
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, ink.width as u32, ink.height as u32);
    let opaque = stage.theme.background.is_some();
    encoder.set_color(if opaque {
        png::ColorType::Rgb
    } else {
        png::ColorType::Rgba
    });
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::Balanced);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let channels = if opaque { 3 } else { 4 };
    let data: Vec<u8> = ink
        .pixels
        .iter()
        .flat_map(|p| p[..channels].iter().map(|&c| crate::text::byte(c)))
        .collect();
    let mut writer = encoder.write_header().map_err(io::Error::other)?;
    writer.write_image_data(&data).map_err(io::Error::other)?;
    writer.finish().map_err(io::Error::other)?;
    Ok(bytes)
}

/// The picture and the distances in it.
pub(crate) fn draw(stage: &Stage<'_>, progress: Progress<'_>) -> (Ink, Depth) {
    let (width, height) = (
        stage.options.size[0] as usize,
        stage.options.size[1] as usize,
    );
    let (surfaces, depth) = surfaces(stage, progress);
    let mut ink = Ink::new(width, height, over_background(stage, surfaces));
    lines(stage, &mut ink, &depth);
    marks(stage, &mut ink);
    (ink, depth)
}

/// The surfaces, in linear light multiplied by their cover, and the distances.
fn surfaces(stage: &Stage<'_>, progress: Progress<'_>) -> (Vec<[f32; 4]>, Depth) {
    let (width, height) = (
        stage.options.size[0] as usize,
        stage.options.size[1] as usize,
    );
    let shown = project(stage.scene, &stage.camera);
    let lists = by_band(&shown, height, ROWS);
    let mut colour = vec![[0f32; 4]; width * height];
    let mut far = vec![f32::INFINITY; width * height];
    let threads = thread::available_parallelism()
        .map_or(1, usize::from)
        .min(lists.len());
    let total = lists.len() as f64;
    // Bands are independent, so the picture is the same whoever draws them.
    let queue = Mutex::new(
        lists.iter().enumerate().zip(
            colour
                .chunks_mut(width * ROWS)
                .zip(far.chunks_mut(width * ROWS)),
        ),
    );
    thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let next = queue.lock().map_or(None, |mut queue| {
                        let next = queue.next();
                        // Told under the lock, so that the shares only grow.
                        if let Some(((index, _), _)) = &next {
                            progress.tell(*index as f64 / total * 0.95);
                        }
                        next
                    });
                    let Some(((index, list), (colour, far))) = next else {
                        break;
                    };
                    if !list.is_empty() {
                        let rows = colour.len() / width;
                        let samples = band(
                            &shown,
                            list,
                            width * PER,
                            index * ROWS * PER,
                            rows * PER,
                            PER,
                        );
                        far.copy_from_slice(&Depth::of_band(&samples, PER, &stage.camera));
                        resolve(stage, &shown, &samples, index * ROWS, colour);
                    }
                }
            });
        }
    });
    (colour, Depth { width, height, far })
}

/// Samples to pixels. Samples of one triangle in a pixel are shaded once, in their middle; stripes each for itself.
fn resolve(stage: &Stage<'_>, shown: &[Shown], samples: &Band, top: usize, out: &mut [[f32; 4]]) {
    let columns = samples.width / PER;
    let sharp = matches!(stage.options.paint, Paint::Zebra { .. });
    let mut groups: Vec<(u32, f32, DVec2)> = Vec::with_capacity(PER * PER);
    for (index, pixel) in out.iter_mut().enumerate() {
        let (x, y) = (index % columns, index / columns);
        groups.clear();
        for sample in 0..PER * PER {
            let (sx, sy) = (x * PER + sample % PER, y * PER + sample / PER);
            let number = samples.seen[sy * samples.width + sx];
            if number == NONE {
                continue;
            }
            let at =
                (DVec2::new(sx as f64, sy as f64) + 0.5) / PER as f64 + DVec2::new(0.0, top as f64);
            match groups.iter_mut().find(|g| g.0 == number && !sharp) {
                Some(g) => {
                    g.1 += 1.0;
                    g.2 += at;
                }
                None => groups.push((number, 1.0, at)),
            }
        }
        let mut sum = Vec3::ZERO;
        let mut cover = 0.0;
        for &(number, weight, at) in &groups {
            let at = if sharp { at } else { at / f64::from(weight) };
            sum += shade_at(stage, &shown[number as usize], at) * weight;
            cover += weight;
        }
        let all = (PER * PER) as f32;
        *pixel = (sum / all).extend(cover / all).to_array();
    }
}

/// The linear light from a triangle at a place of the picture.
pub(crate) fn shade_at(stage: &Stage<'_>, shown: &Shown, at: DVec2) -> Vec3 {
    // The middle of samples just inside a triangle may be a rounding error outside.
    let b = shares(&shown.corners, at.x, at.y).map(|s| s.clamp(0.0, 1.0));
    shade_share(stage, shown, stage.camera.shares(b, &shown.corners))
}

/// The point of a triangle where its corners have these shares.
pub(crate) fn place_at(stage: &Stage<'_>, shown: &Shown, share: [f64; 3]) -> DVec3 {
    let patch = &stage.scene.mesh.patches[stage.scene.parts[shown.part as usize].patch];
    let p = corners(
        &stage.scene.mesh,
        patch,
        patch.triangles[shown.triangle as usize],
    );
    p[0] + (p[1] - p[0]) * share[1] + (p[2] - p[0]) * share[2]
}

/// How a triangle faces the eye where its corners have these shares.
pub(crate) fn facing(stage: &Stage<'_>, shown: &Shown, share: [f64; 3]) -> Place {
    let patch = &stage.scene.mesh.patches[stage.scene.parts[shown.part as usize].patch];
    let t = patch.triangles[shown.triangle as usize];
    let eye = stage.camera.to_eye(place_at(stage, shown, share));
    let normals = t.map(|i| patch.vertices[i as usize].normal);
    Place {
        normal: seen_normal(normals, share, shown.back, eye),
        eye,
        back: shown.back,
    }
}

/// The linear light from a triangle where its corners have these shares.
pub(crate) fn shade_share(stage: &Stage<'_>, shown: &Shown, share: [f64; 3]) -> Vec3 {
    let patch = &stage.scene.mesh.patches[stage.scene.parts[shown.part as usize].patch];
    let stuff = stage.stuff(
        shown.part as usize,
        patch.triangles[shown.triangle as usize],
        share,
    );
    shade(stuff, &facing(stage, shown, share), &stage.camera.axes())
}

fn over_background(stage: &Stage<'_>, surfaces: Vec<[f32; 4]>) -> Vec<[f32; 4]> {
    let (width, height) = (
        stage.options.size[0] as usize,
        stage.options.size[1] as usize,
    );
    let mut out = surfaces;
    for (index, p) in out.iter_mut().enumerate() {
        match stage.theme.background {
            Some([top, bottom]) => {
                let share = ((index / width) as f32 + 0.5) / height as f32;
                let behind = mix(top, bottom, share).map(linear);
                *p = [0, 1, 2, 3].map(|k| {
                    if k < 3 {
                        encoded(p[k] + behind[k] * (1.0 - p[3]))
                    } else {
                        1.0
                    }
                });
            }
            None if p[3] > 0.0 => {
                *p = [0, 1, 2, 3].map(|k| if k < 3 { encoded(p[k] / p[3]) } else { p[3] })
            }
            None => {}
        }
    }
    out
}

fn lines(stage: &Stage<'_>, ink: &mut Ink, depth: &Depth) {
    for line in &stage.lines {
        let spans = spans(&line.points, &stage.camera, depth, stage.bias);
        for (seen, opacity) in [(false, line.opacity * line.hidden), (true, line.opacity)] {
            if opacity > 0.0 {
                let pieces = spans
                    .iter()
                    .filter(|s| s.seen == seen)
                    .map(|s| &s.points[..]);
                ink.lines(pieces, line.width, line.colour, opacity);
            }
        }
    }
    for dot in &stage.dots {
        let p = stage.camera.project(dot.at);
        let opacity = if depth.shows(p, &stage.camera, stage.bias) {
            1.0
        } else {
            0.3
        };
        ink.disc(DVec2::new(p.x, p.y), dot.radius, dot.colour, opacity);
    }
}

fn marks(stage: &Stage<'_>, ink: &mut Ink) {
    for mark in &stage.marks {
        match mark {
            Mark::Text {
                at,
                size,
                anchor,
                colour,
                text,
            } => ink.text(*at, *size, *anchor, *colour, text),
            Mark::Stroke {
                from,
                to,
                width,
                colour,
            } => ink.lines([&[*from, *to][..]], *width, *colour, 1.0),
            Mark::Bar { min, max, map } => ink.rectangle(*min, *max, |y| mapped(*map, 1.0 - y)),
        }
    }
}
