//! Drawing onto pixels: lines, discs, rectangles and text, smooth at their edges.

use super::marks::Anchor;
use crate::scene::Colour;
use ab_glyph::{Font, FontRef, PxScale, ScaleFont, point};
use glam::DVec2;
use std::sync::OnceLock;

/// Roboto Regular 2.137, reduced to Latin, Greek, Cyrillic and mathematical characters (Apache License 2.0, see
/// `assets/Roboto-LICENSE.txt`).
static ROBOTO: &[u8] = include_bytes!("../../assets/Roboto-Subset.ttf");

fn font() -> Option<&'static FontRef<'static>> {
    static FONT: OnceLock<Option<FontRef<'static>>> = OnceLock::new();
    FONT.get_or_init(|| FontRef::try_from_slice(ROBOTO).ok())
        .as_ref()
}

/// The scale at which the font's em is `size` pixels.
fn scale(font: &FontRef<'_>, size: f64) -> PxScale {
    let em = font.units_per_em().unwrap_or(1000.0);
    PxScale::from(size as f32 * font.height_unscaled() / em)
}

/// The width of a text in pixels.
pub(crate) fn text_width(text: &str, size: f64) -> f64 {
    layout(text, size).1
}

/// Each glyph and where it starts, and where the text ends.
fn layout(text: &str, size: f64) -> (Vec<(ab_glyph::GlyphId, f32)>, f64) {
    let Some(font) = font() else {
        return (Vec::new(), 0.0);
    };
    let scaled = font.as_scaled(scale(font, size));
    let (mut x, mut last, mut out) = (0f32, None, Vec::new());
    for c in text.chars() {
        let id = scaled.glyph_id(c);
        x += last.map_or(0.0, |l| scaled.kern(l, id));
        out.push((id, x));
        x += scaled.h_advance(id);
        last = Some(id);
    }
    (out, f64::from(x))
}

/// A picture of pixels, in sRGB with straight opacity.
pub(crate) struct Ink {
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// Red, green, blue, opacity, each from 0 to 1.
    pub(crate) pixels: Vec<[f32; 4]>,
    /// How much a shape that is being drawn covers each pixel, and the pixels it touches.
    cover: Vec<f32>,
    touched: Vec<usize>,
}

impl Ink {
    pub(crate) fn new(width: usize, height: usize, pixels: Vec<[f32; 4]>) -> Ink {
        Ink {
            width,
            height,
            pixels,
            cover: vec![0.0; width * height],
            touched: Vec::new(),
        }
    }

    fn blend(&mut self, index: usize, colour: Colour, opacity: f32) {
        let p = &mut self.pixels[index];
        let below = p[3] * (1.0 - opacity);
        let sum = opacity + below;
        if sum > 0.0 {
            for k in 0..3 {
                p[k] = (colour[k] * opacity + p[k] * below) / sum;
            }
            p[3] = sum;
        }
    }

    /// Blends what `cover` gathered: once for each pixel, so that joints are not darker.
    fn flush(&mut self, colour: Colour, opacity: f32) {
        for index in std::mem::take(&mut self.touched) {
            let c = std::mem::take(&mut self.cover[index]);
            self.blend(index, colour, c * opacity);
        }
    }

    /// Adds what a distance function covers within a box.
    fn add(&mut self, lo: DVec2, hi: DVec2, distance: impl Fn(DVec2) -> f64) {
        let range = |a: f64, b: f64, n: usize| {
            (
                a.floor().max(0.0) as usize,
                b.ceil().clamp(0.0, n as f64) as usize,
            )
        };
        let ((x0, x1), (y0, y1)) = (
            range(lo.x, hi.x, self.width),
            range(lo.y, hi.y, self.height),
        );
        for y in y0..y1 {
            for x in x0..x1 {
                let c = (0.5 - distance(DVec2::new(x as f64 + 0.5, y as f64 + 0.5))).clamp(0.0, 1.0)
                    as f32;
                let index = y * self.width + x;
                if c > self.cover[index] {
                    if self.cover[index] == 0.0 {
                        self.touched.push(index);
                    }
                    self.cover[index] = c;
                }
            }
        }
    }

    /// Lines with round ends and joints, drawn as one shape.
    pub(crate) fn lines<'a>(
        &mut self,
        lines: impl IntoIterator<Item = &'a [DVec2]>,
        width: f64,
        colour: Colour,
        opacity: f32,
    ) {
        // A line thinner than a pixel is a pixel wide and fainter.
        let (half, opacity) = (width.max(1.0) / 2.0, opacity * width.min(1.0) as f32);
        let reach = DVec2::splat(half + 1.0);
        for line in lines {
            for ends in line.windows(2) {
                let (a, d) = (ends[0], ends[1] - ends[0]);
                let inverse = 1.0 / d.length_squared().max(1e-12);
                self.add(
                    ends[0].min(ends[1]) - reach,
                    ends[0].max(ends[1]) + reach,
                    |p| {
                        let t = ((p - a).dot(d) * inverse).clamp(0.0, 1.0);
                        (p - a - d * t).length() - half
                    },
                );
            }
        }
        self.flush(colour, opacity);
    }

    pub(crate) fn disc(&mut self, centre: DVec2, radius: f64, colour: Colour, opacity: f32) {
        let reach = DVec2::splat(radius + 1.0);
        self.add(centre - reach, centre + reach, |p| {
            (p - centre).length() - radius
        });
        self.flush(colour, opacity);
    }

    /// A rectangle whose colour depends on the height in it, from 0 at the top to 1.
    pub(crate) fn rectangle(&mut self, min: DVec2, max: DVec2, colour: impl Fn(f64) -> Colour) {
        let rows = (
            min.y.round().max(0.0) as usize,
            (max.y.round().max(0.0) as usize).min(self.height),
        );
        let columns = (
            min.x.round().max(0.0) as usize,
            (max.x.round().max(0.0) as usize).min(self.width),
        );
        for y in rows.0..rows.1 {
            let c = colour((y as f64 + 0.5 - min.y) / (max.y - min.y));
            for x in columns.0..columns.1 {
                self.blend(y * self.width + x, c, 1.0);
            }
        }
    }

    /// A text whose base line starts, ends or has its middle at a place.
    pub(crate) fn text(
        &mut self,
        at: DVec2,
        size: f64,
        anchor: Anchor,
        colour: Colour,
        text: &str,
    ) {
        let Some(font) = font() else { return };
        let (glyphs, width) = layout(text, size);
        let left = at.x
            - match anchor {
                Anchor::Start => 0.0,
                Anchor::Middle => width / 2.0,
            };
        let px = scale(font, size);
        for (id, x) in glyphs {
            let glyph = id.with_scale_and_position(px, point(left as f32 + x, at.y as f32));
            let Some(outline) = font.outline_glyph(glyph) else {
                continue;
            };
            let corner = outline.px_bounds().min;
            let (w, h) = (self.width as i64, self.height as i64);
            outline.draw(|dx, dy, c| {
                let (x, y) = (
                    corner.x as i64 + i64::from(dx),
                    corner.y as i64 + i64::from(dy),
                );
                if c > 0.0 && (0..w).contains(&x) && (0..h).contains(&y) {
                    self.blend((y * w + x) as usize, colour, c.min(1.0));
                }
            });
        }
    }
}
