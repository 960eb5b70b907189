//! What is laid over a picture: the legend, the title, the axes. Both PNG and SVG draw it from here.

use super::colour::{ColourMap, rgb};
use super::ink::text_width;
use super::scale::Scale;
use super::view::Camera;
use super::{Background, KeyEntry, PictureOptions};
use crate::scene::{Colour, Field};
use glam::{DVec2, DVec3};

/// Where a text stands in relation to its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
}

/// One thing laid over a picture, in pixels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Mark {
    /// A text; `at` is on its base line.
    Text {
        at: DVec2,
        size: f64,
        anchor: Anchor,
        colour: Colour,
        text: String,
    },
    /// A straight line.
    Stroke {
        from: DVec2,
        to: DVec2,
        width: f64,
        colour: Colour,
    },
    /// The colours of a map, low at the bottom.
    Bar {
        min: DVec2,
        max: DVec2,
        map: ColourMap,
    },
}

/// The colours of a background.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Theme {
    /// At the top and at the bottom; `None` is transparent.
    pub(crate) background: Option<[Colour; 2]>,
    pub(crate) ink: Colour,
    axes: [Colour; 3],
}

impl Theme {
    pub(crate) fn of(background: Background) -> Theme {
        match background {
            Background::Light | Background::Transparent => Theme {
                background: (background == Background::Light)
                    .then_some([rgb(0xfcfdfe), rgb(0xe3e8ee)]),
                ink: rgb(0x252b33),
                axes: [rgb(0xc8434f), rgb(0x3d9160), rgb(0x3568b2)],
            },
            Background::Dark => Theme {
                background: Some([rgb(0x323943), rgb(0x171a1f)]),
                ink: rgb(0xe8ebef),
                axes: [rgb(0xf0727c), rgb(0x74c795), rgb(0x7aa7ea)],
            },
        }
    }
}

const MARGIN: f64 = 44.0;
const TITLE: f64 = 23.0;
const LABEL: f64 = 14.5;
const BAR_WIDTH: f64 = 17.0;
const TICK: f64 = 5.0;
/// Share of the picture's height that the colour bar takes.
const BAR_SHARE: f64 = 0.52;

/// Pixels that the marks need at the edges.
pub(crate) struct Room {
    pub(crate) side: f64,
    pub(crate) top: f64,
    pub(crate) legend: f64,
}

type Legend<'a> = Option<(&'a Scale, &'a Field)>;

/// The room that marks need.
pub(crate) fn reserve(
    unit: f64,
    title: Option<&str>,
    legend: Legend<'_>,
    key: &[KeyEntry],
) -> Room {
    let side = MARGIN * unit;
    let top = side
        + if title.is_some() {
            1.3 * TITLE * unit
        } else {
            0.0
        };
    let bar = legend.map_or(0.0, |l| side + legend_width(unit, l));
    Room {
        side,
        top,
        legend: bar.max(key_width(unit, key)),
    }
}

/// The length of a line in the key, and the room between it and its text.
const SWATCH: [f64; 2] = [26.0, 9.0];
/// The distance of lines of text in the key, in units of their size.
const LEADING: f64 = 1.55;
/// The width that a key takes; 0 if there is none.
fn key_width(unit: f64, key: &[KeyEntry]) -> f64 {
    let texts = key.iter().map(|e| text_width(&e.text, LABEL * unit));
    texts
        .reduce(f64::max)
        .map_or(0.0, |w| w + (SWATCH[0] + SWATCH[1] + 1.5 * MARGIN) * unit)
}

/// The key in the lower right corner, the first entry at the top.
pub(crate) fn key_marks(
    options: &PictureOptions,
    unit: f64,
    key: &[KeyEntry],
    theme: &Theme,
) -> Vec<Mark> {
    let [width, height] = options.size.map(f64::from);
    let left = width - key_width(unit, key) + 0.5 * MARGIN * unit;
    let size = LABEL * unit;
    let mut out = Vec::new();
    for (row, entry) in key.iter().rev().enumerate() {
        let y = height - MARGIN * unit - row as f64 * LEADING * size;
        let swatch = SWATCH[0] * unit;
        let (from, to) = if entry.dot {
            let middle = DVec2::new(left + 0.5 * swatch, y);
            // A line hardly longer than nothing has round ends: a dot.
            (middle, middle + DVec2::new(0.01, 0.0))
        } else {
            // Within the swatch with its round ends.
            let end = (0.5 * entry.width * unit).min(0.49 * swatch);
            (
                DVec2::new(left + end, y),
                DVec2::new(left + swatch - end, y),
            )
        };
        out.push(Mark::Stroke {
            from,
            to,
            width: entry.width * unit,
            colour: entry.colour,
        });
        out.push(Mark::Text {
            at: DVec2::new(left + swatch + SWATCH[1] * unit, y + 0.35 * size),
            size,
            anchor: Anchor::Start,
            colour: theme.ink,
            text: entry.text.clone(),
        });
    }
    out
}

fn heading(field: &Field) -> [String; 2] {
    [
        field.name.clone(),
        if field.unit.is_empty() {
            String::new()
        } else {
            format!("in {}", field.unit)
        },
    ]
}

fn legend_width(unit: f64, (scale, field): (&Scale, &Field)) -> f64 {
    let size = LABEL * unit;
    let labels = (0..scale.ticks.len())
        .map(|k| text_width(&scale.label(k), size))
        .fold(0.0, f64::max);
    let bar = (BAR_WIDTH + 2.0 * TICK) * unit + labels;
    heading(field)
        .iter()
        .map(|h| text_width(h, size))
        .fold(bar, f64::max)
        + 0.5 * MARGIN * unit
}

pub(crate) fn marks(
    options: &PictureOptions,
    unit: f64,
    title: Option<&str>,
    legend: Legend<'_>,
    camera: &Camera,
    theme: &Theme,
) -> Vec<Mark> {
    let [width, height] = options.size.map(f64::from);
    let mut out = Vec::new();
    if let Some(title) = title {
        let (size, text) = fit_title(title, TITLE * unit, width - 2.0 * MARGIN * unit);
        let at = DVec2::new(MARGIN * unit, MARGIN * unit + 0.35 * size);
        out.push(Mark::Text {
            at,
            size,
            anchor: Anchor::Start,
            colour: theme.ink,
            text,
        });
    }
    if let Some((scale, field)) = legend {
        let left = width - legend_width(unit, (scale, field)) - 0.5 * MARGIN * unit;
        bar(
            &mut out,
            scale,
            field,
            DVec2::new(left, height * (1.0 - BAR_SHARE) / 2.0),
            height * BAR_SHARE,
            unit,
            theme,
        );
    }
    if options.axes {
        triad(
            &mut out,
            camera,
            DVec2::new(1.35 * MARGIN * unit, height - 1.35 * MARGIN * unit),
            unit,
            theme,
        );
    }
    out
}

/// A title too long for the picture is set smaller, and at last shortened.
fn fit_title(title: &str, size: f64, room: f64) -> (f64, String) {
    const SMALLEST: f64 = 0.6;
    let size = (size * room / text_width(title, size).max(1e-9))
        .min(size)
        .max(SMALLEST * size);
    let mut text = title.to_owned();
    while text_width(&text, size) > room && text.chars().count() > 1 {
        let keep = text.trim_end_matches('…').chars().count() - 1;
        text = text.chars().take(keep).chain(['…']).collect();
    }
    (size, text)
}

fn bar(
    out: &mut Vec<Mark>,
    scale: &Scale,
    field: &Field,
    min: DVec2,
    height: f64,
    unit: f64,
    theme: &Theme,
) {
    let size = LABEL * unit;
    let max = min + DVec2::new(BAR_WIDTH * unit, height);
    for (row, text) in heading(field)
        .into_iter()
        .rev()
        .filter(|t| !t.is_empty())
        .enumerate()
    {
        let at = DVec2::new(min.x, min.y - size * (1.0 + 1.3 * row as f64));
        out.push(Mark::Text {
            at,
            size,
            anchor: Anchor::Start,
            colour: theme.ink,
            text,
        });
    }
    out.push(Mark::Bar {
        min,
        max,
        map: scale.map,
    });
    for (k, tick) in scale.ticks.iter().enumerate() {
        let y = max.y - scale.share(*tick) * height;
        let from = DVec2::new(max.x, y);
        let to = from + DVec2::new(TICK * unit, 0.0);
        out.push(Mark::Stroke {
            from,
            to,
            width: unit,
            colour: theme.ink,
        });
        // The middle of a digit is about 0.35 of the size above the base line.
        let at = DVec2::new(to.x + 0.8 * TICK * unit, y + 0.35 * size);
        out.push(Mark::Text {
            at,
            size,
            anchor: Anchor::Start,
            colour: theme.ink,
            text: scale.label(k),
        });
    }
}

/// The directions of x, y and z as the camera sees them, the farthest first.
fn triad(out: &mut Vec<Mark>, camera: &Camera, origin: DVec2, unit: f64, theme: &Theme) {
    const LENGTH: f64 = 30.0;
    let [right, up, eye] = camera.axes();
    let mut axes: Vec<(usize, DVec3)> = [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .enumerate()
        .collect();
    axes.sort_by(|a, b| a.1.dot(eye).total_cmp(&b.1.dot(eye)));
    for (k, axis) in axes {
        let flat = DVec2::new(axis.dot(right), -axis.dot(up));
        let tip = origin + flat * (LENGTH * unit);
        // An axis along the line of sight is a dot, with its letter beside.
        let seen = flat.length() > 0.12;
        let to = if seen {
            tip
        } else {
            origin + DVec2::new(0.01, 0.0)
        };
        let width = if seen { 2.2 } else { 6.0 } * unit;
        out.push(Mark::Stroke {
            from: origin,
            to,
            width,
            colour: theme.axes[k],
        });
        let away = if seen {
            flat.normalize()
        } else {
            DVec2::new(-0.8, 0.8)
        };
        let size = LABEL * unit;
        let at = to + away * (0.75 * size) + DVec2::new(0.0, 0.32 * size);
        out.push(Mark::Text {
            at,
            size,
            anchor: Anchor::Middle,
            colour: theme.axes[k],
            text: ["x", "y", "z"][k].into(),
        });
    }
}
