//! Pictures of scenes without a GPU or a screen: `.png` by an own z-buffer, `.svg` as vectors.
//!
//! A [`Picture`] shows a scene's surfaces painted (three soft lights), coloured by a [`Field`](crate::Field) with a
//! legend, or striped as a mirror in a light tunnel (zebra), with their borders as crisp lines; further [`Line`]s
//! (isolines) and [`Net`]s (control nets) are given by the caller. What a surface hides is left out of lines, or faint.
//! Normals are the exact ones of the mesh's vertices. The camera fits the scene into the frame by itself. Same scene,
//! same bytes.
//!
//! ```no_run
//! # use nappe_exchange::{Scene, WriteOptions, render::*};
//! # fn show(scene: &Scene) -> Result<(), Box<dyn std::error::Error>> {
//! let options = PictureOptions { view: "iso".parse()?, paint: Paint::Zebra { stripes: 12 }, ..Default::default() };
//! let lines = [Line::isoline(vec![[0.0, 0.0, 0.0].into(), [1.0, 0.0, 0.0].into()])];
//! Picture::new(scene, options).lines(lines).write("stripes.png".as_ref(), Default::default())?;
//! # Ok(())
//! # }
//! ```

mod colour;
mod ink;
mod light;
mod lines;
mod marks;
mod pieces;
mod pixels;
mod raster;
mod scale;
mod stage;
mod svg;
#[cfg(test)]
mod tests;
mod view;

pub use colour::ColourMap;
pub use view::{Projection, View};

use crate::atomic::write_atomically;
use crate::error::{ExchangeError, PictureError};
use crate::format::Format;
use crate::report::{Progress, Tally, WriteReport};
use crate::scene::{Colour, Scene};
use crate::write::report;
use glam::DVec3;
use stage::Stage;
use std::io::Write;
use std::path::Path;

/// How surfaces are coloured.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Paint {
    /// Each part in its colour.
    #[default]
    Parts,
    /// All in one colour.
    Plain(Colour),
    /// By a field of the scene, with a legend.
    Field {
        /// Index of the field.
        index: usize,
        /// The colours.
        map: ColourMap,
        /// The values that the colours cover; by default those of the field, without far outliers. The ends are moved
        /// outward to round numbers; where values lie beyond, the legend says so (`≥ 3.2`).
        range: Option<[f64; 2]>,
    },
    /// Reflection lines of a tunnel of light stripes: they show breaks of tangency and curvature.
    Zebra {
        /// The number of dark stripes over half a turn.
        stripes: u32,
    },
}

/// What is behind the scene.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Background {
    /// Near white.
    #[default]
    Light,
    /// Near black.
    Dark,
    /// Nothing.
    Transparent,
}

/// How a picture is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureOptions {
    /// Width and height in pixels, each from 16 to 16384.
    pub size: [u32; 2],
    /// Where the scene is seen from.
    pub view: View,
    /// Perspective or parallel.
    pub projection: Projection,
    /// The colours of the surfaces.
    pub paint: Paint,
    /// What is behind.
    pub background: Background,
    /// Whether the borders of the surfaces are drawn.
    pub borders: bool,
    /// Whether the scene's curves are drawn.
    pub curves: bool,
    /// A factor on the widths of all lines.
    pub line_width: f64,
    /// Whether the scene's title is written at the top.
    pub title: bool,
    /// Whether the directions of the axes are shown in a corner.
    pub axes: bool,
    /// Of `.svg` only: neighbouring pieces whose colours differ by less than this share of the whole range become one
    /// shape. Larger values give smaller files and visible steps.
    pub colour_step: f64,
}

impl Default for PictureOptions {
    fn default() -> PictureOptions {
        PictureOptions {
            size: [1600, 1200],
            view: View::ISO,
            projection: Projection::default(),
            paint: Paint::Parts,
            background: Background::Light,
            borders: true,
            curves: true,
            line_width: 1.0,
            title: true,
            axes: true,
            colour_step: 0.012,
        }
    }
}

/// A line drawn with a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The points; closed if the first is repeated at the end.
    pub points: Vec<DVec3>,
    /// The colour.
    pub colour: Colour,
    /// The opacity, from 0 to 1.
    pub opacity: f32,
    /// The width in pixels of a picture whose shorter side has 800.
    pub width: f64,
    /// The opacity where a surface hides it: 0 leaves it out.
    pub hidden: f32,
}

impl Line {
    /// Thin and translucent: isolines of parameters.
    pub fn isoline(points: Vec<DVec3>) -> Line {
        Line {
            points,
            colour: [0.06, 0.09, 0.14],
            opacity: 0.42,
            width: 0.9,
            hidden: 0.0,
        }
    }

    /// Crisp: borders of surfaces.
    pub fn border(points: Vec<DVec3>) -> Line {
        Line {
            points,
            colour: [0.07, 0.09, 0.12],
            opacity: 0.92,
            width: 1.6,
            hidden: 0.0,
        }
    }

    /// Bold and coloured: curves.
    pub fn curve(points: Vec<DVec3>) -> Line {
        Line {
            points,
            colour: [0.75, 0.22, 0.17],
            opacity: 1.0,
            width: 2.2,
            hidden: 0.12,
        }
    }
}

/// A dot drawn with a scene: a place. Where a surface hides it, it is faint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dot {
    /// The place.
    pub at: DVec3,
    /// The colour.
    pub colour: Colour,
    /// The radius in pixels of a picture whose shorter side has 800.
    pub radius: f64,
}

/// An entry of a key: what lines or dots of a colour mean.
#[derive(Clone, Debug, PartialEq)]
pub struct KeyEntry {
    /// The colour.
    pub colour: Colour,
    /// The width of the line or of the dot, in pixels of a picture whose shorter side has 800.
    pub width: f64,
    /// Whether a dot is shown, not a line.
    pub dot: bool,
    /// What it means.
    pub text: String,
}

/// A control net: points joined along rows and columns.
#[derive(Clone, Debug, PartialEq)]
pub struct Net {
    /// The name, for messages.
    pub name: String,
    /// The points, row by row.
    pub points: Vec<DVec3>,
    /// The number of points in a row: all of them for the polygon of a curve.
    pub columns: usize,
    /// The colour.
    pub colour: Colour,
}

impl Net {
    /// A net in the usual colour.
    pub fn new(name: impl Into<String>, points: Vec<DVec3>, columns: usize) -> Net {
        Net {
            name: name.into(),
            points,
            columns,
            colour: [0.80, 0.33, 0.10],
        }
    }
}

/// The longest side of a picture in pixels.
pub(crate) const MAX_SIDE: u32 = 16384;
const MIN_SIDE: u32 = 16;

/// A picture of a scene.
#[derive(Clone, Debug)]
pub struct Picture<'a> {
    scene: &'a Scene,
    options: PictureOptions,
    lines: Vec<Line>,
    nets: Vec<Net>,
    dots: Vec<Dot>,
    key: Vec<KeyEntry>,
}

impl<'a> Picture<'a> {
    /// A picture of the scene's surfaces and curves.
    pub fn new(scene: &'a Scene, options: PictureOptions) -> Picture<'a> {
        Picture {
            scene,
            options,
            lines: Vec::new(),
            nets: Vec::new(),
            dots: Vec::new(),
            key: Vec::new(),
        }
    }

    /// Adds lines.
    pub fn lines(mut self, lines: impl IntoIterator<Item = Line>) -> Self {
        self.lines.extend(lines);
        self
    }

    /// Adds control nets.
    pub fn nets(mut self, nets: impl IntoIterator<Item = Net>) -> Self {
        self.nets.extend(nets);
        self
    }

    /// Where the eye is; `None` if the projection is parallel: then it is everywhere towards the third of [`View::axes`].
    ///
    /// # Errors
    /// [`PictureError`]: options out of range.
    pub fn eye(&self) -> Result<Option<DVec3>, PictureError> {
        Ok(self.stage()?.camera.eye())
    }

    /// Adds dots.
    pub fn dots(mut self, dots: impl IntoIterator<Item = Dot>) -> Self {
        self.dots.extend(dots);
        self
    }

    /// Adds entries to the key, which stands in the lower right corner.
    pub fn key(mut self, entries: impl IntoIterator<Item = KeyEntry>) -> Self {
        self.key.extend(entries);
        self
    }

    /// Writes `.png` or `.svg`, as the path's ending says.
    ///
    /// # Errors
    /// [`ExchangeError`]: another ending, options out of range, a scene that is not valid, a file that cannot be
    /// written.
    pub fn write(&self, path: &Path, progress: Progress<'_>) -> Result<WriteReport, ExchangeError> {
        let format = Format::from_path(path)?;
        let nothing = |what| ExchangeError::Nothing {
            path: path.to_owned(),
            what,
        };
        self.scene
            .validate()
            .map_err(|source| ExchangeError::Scene {
                path: path.to_owned(),
                source,
            })?;
        let stage = self.stage().map_err(|source| ExchangeError::Picture {
            path: path.to_owned(),
            source,
        })?;
        if self.scene.triangles() == 0 && stage.lines.is_empty() && stage.dots.is_empty() {
            return Err(nothing("surfaces or curves"));
        }
        let tally = match format {
            Format::Png => {
                let bytes = pixels::png(&stage, progress);
                write_atomically(path, |out| out.write_all(&bytes?))?;
                Tally {
                    triangles: self.scene.triangles(),
                    ..Tally::default()
                }
            }
            Format::Svg => {
                let (text, shapes) = svg::svg(&stage, progress);
                write_atomically(path, |out| out.write_all(text.as_bytes()))?;
                Tally {
                    triangles: shapes,
                    ..Tally::default()
                }
            }
            _ => {
                return Err(nothing(
                    "picture that this format could hold; pictures are .png and .svg",
                ));
            }
        };
        progress.tell(1.0);
        Ok(report(path, format, self.scene, tally))
    }

    fn stage(&self) -> Result<Stage<'_>, PictureError> {
        self.check()?;
        Ok(Stage::new(self))
    }

    fn check(&self) -> Result<(), PictureError> {
        let o = &self.options;
        let [width, height] = o.size;
        if o.size.iter().any(|s| !(MIN_SIDE..=MAX_SIDE).contains(s)) {
            return Err(PictureError::Size {
                width,
                height,
                limit: MAX_SIDE,
            });
        }
        if let Projection::Perspective { field_of_view } = o.projection {
            let degrees = field_of_view.to_degrees();
            if !(1.0..=120.0).contains(&degrees) {
                return Err(PictureError::FieldOfView { degrees });
            }
        }
        let range = |what, value: f64, least: f64, greatest: f64| {
            let fine = value.is_finite() && (least..=greatest).contains(&value);
            if fine {
                Ok(())
            } else {
                Err(PictureError::Range {
                    what,
                    value,
                    least,
                    greatest,
                })
            }
        };
        range("the line width", o.line_width, 0.01, 100.0)?;
        range("the colour step", o.colour_step, 1e-3, 1.0)?;
        for (what, angle) in [
            ("the azimuth", o.view.azimuth),
            ("the elevation", o.view.elevation),
            ("the roll", o.view.roll),
        ] {
            range(what, angle, -1e3, 1e3)?;
        }
        match o.paint {
            Paint::Field { index, .. } if index >= self.scene.fields.len() => {
                return Err(PictureError::NoField {
                    index,
                    fields: self.scene.fields.len(),
                });
            }
            Paint::Field {
                range: Some(ends), ..
            } => {
                for end in ends {
                    range("an end of the colour range", end, f64::MIN, f64::MAX)?;
                }
            }
            Paint::Zebra { stripes } => {
                range("the number of stripes", f64::from(stripes), 1.0, 1000.0)?
            }
            _ => {}
        }
        for net in &self.nets {
            if net.columns == 0 || !net.points.len().is_multiple_of(net.columns) {
                let (net, points, columns) = (net.name.clone(), net.points.len(), net.columns);
                return Err(PictureError::Net {
                    net,
                    points,
                    columns,
                });
            }
        }
        if let Some((index, dot)) = self.dots.iter().enumerate().find(|d| !d.1.at.is_finite()) {
            return Err(PictureError::DotNotFinite {
                index,
                point: dot.at,
            });
        }
        let lines = self
            .lines
            .iter()
            .enumerate()
            .map(|(k, l)| (k.to_string(), &l.points));
        for (line, points) in lines.chain(self.nets.iter().map(|n| (n.name.clone(), &n.points))) {
            if let Some(index) = points.iter().position(|p| !p.is_finite()) {
                return Err(PictureError::LineNotFinite {
                    line,
                    index,
                    point: points[index],
                });
            }
        }
        Ok(())
    }
}
