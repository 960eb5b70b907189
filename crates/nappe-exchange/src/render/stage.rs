//! Everything a picture is made of, before it becomes pixels or vectors.

use super::colour::{mapped, rgb};
use super::light::Stuff;
use super::lines::borders;
use super::marks::{Mark, Theme, key_marks, marks, reserve};
use super::scale::{Scale, areas};
use super::view::{Camera, Frame};
use super::{Background, Dot, Line, Net, Paint, Picture, PictureOptions};
use crate::scene::{Colour, Scene};
use glam::{DVec2, DVec3};

/// A picture's content.
pub(crate) struct Stage<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) options: &'a PictureOptions,
    pub(crate) camera: Camera,
    pub(crate) theme: Theme,
    pub(crate) scale: Option<Scale>,
    pub(crate) lines: Vec<Line>,
    pub(crate) dots: Vec<Dot>,
    pub(crate) marks: Vec<Mark>,
    /// How far behind a surface a line may lie and still be on it.
    pub(crate) bias: f64,
}

/// The shorter side of the picture in which line widths and text sizes are pixels.
const DESIGN_SIDE: f64 = 800.0;
/// Lines of small pictures do not get thinner than at this share of the design's size: they would fade.
const LEAST_LINE_UNIT: f64 = 0.5;
/// Lines on a surface may lie this share of the scene's size behind its mesh, beside the mesh's own deviation.
const BIAS_SHARE: f64 = 4e-4;
/// The colour of places where a field has no value.
const NO_VALUE: Colour = rgb(0x9aa0a6);

impl<'a> Stage<'a> {
    pub(crate) fn new(picture: &'a Picture<'_>) -> Stage<'a> {
        let (scene, options) = (picture.scene, &picture.options);
        let [width, height] = options.size.map(f64::from);
        let unit = width.min(height) / DESIGN_SIDE;
        let theme = Theme::of(options.background);
        let scale = match options.paint {
            Paint::Field { index, map, range } => {
                let patches: Vec<usize> = scene.parts.iter().map(|p| p.patch).collect();
                let weights = areas(&scene.mesh);
                let field = &scene.fields[index];
                Some(Scale::of(field, &patches, &weights, map, range))
            }
            _ => None,
        };
        let mut lines = picture.lines.clone();
        if options.borders {
            lines.extend(borders(scene).into_iter().map(Line::border));
        }
        if options.curves {
            lines.extend(scene.curves.iter().map(|c| Line::curve(c.points.clone())));
        }
        let mut dots = picture.dots.clone();
        for net in &picture.nets {
            net_lines(net, &mut lines);
            dots.extend(net.points.iter().map(|&at| Dot {
                at,
                colour: net.colour,
                radius: 3.2,
            }));
        }
        let line_unit = unit.max(LEAST_LINE_UNIT);
        for line in &mut lines {
            line.width *= line_unit * options.line_width;
            if options.background == Background::Dark && scene.triangles() == 0 {
                line.colour = theme.ink;
            }
        }
        for dot in &mut dots {
            dot.radius *= line_unit * options.line_width;
        }
        let title = scene.title.as_deref().filter(|_| options.title);
        let legend = scale.as_ref().zip(match options.paint {
            Paint::Field { index, .. } => scene.fields.get(index),
            _ => None,
        });
        let key = &picture.key;
        let room = reserve(unit, title, legend, key);
        let frame = Frame {
            min: DVec2::new(room.side, room.top),
            max: DVec2::new(width - room.legend.max(room.side), height - room.side),
        };
        let used = scene.patches().flat_map(|(_, p)| {
            p.vertices
                .iter()
                .map(|v| scene.mesh.points[v.point as usize])
        });
        let in_lines = lines.iter().flat_map(|l| l.points.iter().copied());
        let all = used.chain(in_lines).chain(dots.iter().map(|d| d.at));
        let camera = Camera::fit(options.view, options.projection, frame, all.clone());
        let size = all.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[lo, hi], p| {
            [lo.min(p), hi.max(p)]
        });
        let size = (size[1] - size[0]).length();
        let deviation = scene.deviation().error();
        let bias = BIAS_SHARE * size
            + if deviation.is_finite() {
                deviation
            } else {
                0.0
            };
        let mut marks = marks(options, unit, title, legend, &camera, &theme);
        marks.extend(key_marks(options, unit, key, &theme));
        Stage {
            scene,
            options,
            camera,
            theme,
            scale,
            lines,
            dots,
            marks,
            bias,
        }
    }

    /// What a part is made of where its triangle's corners have the shares.
    pub(crate) fn stuff(&self, part: usize, triangle: [u32; 3], share: [f64; 3]) -> Stuff {
        let p = &self.scene.parts[part];
        match self.options.paint {
            Paint::Parts => Stuff::Paint(p.colour),
            Paint::Plain(colour) => Stuff::Paint(colour),
            Paint::Zebra { stripes } => Stuff::Zebra(f64::from(stripes)),
            Paint::Field { index, .. } => {
                let values = &self.scene.fields[index].values[p.patch];
                let value: f64 = (0..3)
                    .map(|k| values[triangle[k] as usize] * share[k])
                    .sum();
                match &self.scale {
                    Some(s) if value.is_finite() => Stuff::Data(mapped(s.map, s.share(value))),
                    _ => Stuff::Data(NO_VALUE),
                }
            }
        }
    }
}

fn net_lines(net: &Net, lines: &mut Vec<Line>) {
    let line = |points| Line {
        points,
        colour: net.colour,
        opacity: 0.95,
        width: 1.2,
        hidden: 0.28,
    };
    let rows = net.points.len() / net.columns;
    lines.extend(
        net.points
            .chunks(net.columns)
            .filter(|r| r.len() > 1)
            .map(|r| line(r.to_vec())),
    );
    if rows > 1 {
        lines.extend(
            (0..net.columns)
                .map(|c| line((0..rows).map(|r| net.points[r * net.columns + c]).collect())),
        );
    }
}
