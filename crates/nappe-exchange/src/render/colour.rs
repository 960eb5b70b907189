//! Colours: sRGB and linear light, and maps from numbers to colours.

use crate::scene::Colour;
use crate::text::byte;

/// Which colours numbers become.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ColourMap {
    /// [`ColourMap::Diverging`] if the values have both signs, otherwise [`ColourMap::Sequential`].
    #[default]
    Auto,
    /// Dark blue over green to yellow: viridis, in which equal steps look equal (S. van der Walt, N. Smith, 2015).
    Sequential,
    /// Blue over white, which is 0, to red: RdBu of C. Brewer, colorbrewer2.org.
    Diverging,
}

const VIRIDIS: [u32; 11] = [
    0x440154, 0x482475, 0x414487, 0x355f8d, 0x2a788e, 0x21918c, 0x22a884, 0x44bf70, 0x7ad151,
    0xbddf26, 0xfde725,
];
const BLUE_RED: [u32; 9] = [
    0x2166ac, 0x4393c3, 0x92c5de, 0xd1e5f0, 0xf7f7f7, 0xfddbc7, 0xf4a582, 0xd6604d, 0xb2182b,
];

/// The colour at a share from 0 to 1 of a map that is not `Auto`.
pub(crate) fn mapped(map: ColourMap, share: f64) -> Colour {
    let stops: &[u32] = if map == ColourMap::Diverging {
        &BLUE_RED
    } else {
        &VIRIDIS
    };
    let x = share.clamp(0.0, 1.0) * (stops.len() - 1) as f64;
    let k = (x as usize).min(stops.len() - 2);
    mix(rgb(stops[k]), rgb(stops[k + 1]), (x - k as f64) as f32)
}

/// A colour from its usual notation, 0xrrggbb.
pub(crate) const fn rgb(c: u32) -> Colour {
    [
        (c >> 16) as f32 / 255.0,
        (c >> 8 & 255) as f32 / 255.0,
        (c & 255) as f32 / 255.0,
    ]
}

/// The notation of SVG.
pub(crate) fn hex(c: Colour) -> String {
    let [r, g, b] = c.map(byte);
    format!("#{r:02x}{g:02x}{b:02x}")
}

pub(crate) fn mix(a: Colour, b: Colour, t: f32) -> Colour {
    [0, 1, 2].map(|k| a[k] + (b[k] - a[k]) * t)
}

/// sRGB to linear light (IEC 61966-2-1).
pub(crate) fn linear(c: f32) -> f32 {
    if c <= 0.04045 {
        c / 12.92
    } else {
        ((c + 0.055) / 1.055).powf(2.4)
    }
}

/// Linear light to sRGB.
pub(crate) fn encoded(c: f32) -> f32 {
    let c = c.clamp(0.0, 1.0);
    if c <= 0.003_130_8 {
        c * 12.92
    } else {
        1.055 * c.powf(1.0 / 2.4) - 0.055
    }
}
