//! `nappe render`.

use super::traced::Traced;
use crate::failure::{Failure, Problem};
use crate::fault;
use crate::model::ModelArgs;
use crate::scene::{self, Bend};
use crate::screen::Screen;
use crate::{output, text};
use clap::ValueEnum;
use nappe::curve::Isocurve;
use nappe::mesh::flatten;
use nappe::surface::Dir;
use nappe::{Breaks, DVec3};
use nappe_exchange::render::{
    Background, ColourMap, Line, Net, Paint, Picture, PictureOptions, Projection, View,
};
use nappe_exchange::{Format, Progress, Scene};
use nappe_model::{Model, NamedSurface};
use std::path::{Path, PathBuf};

/// Draw a model as a picture, without a GPU or a screen
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe render vase.nappe.toml -o vase.png
  nappe render vase.nappe.toml -o vase.svg --view front --projection parallel --isolines 8
  nappe render vase.nappe.toml -o bend.png --style curvature-gaussian --size 1200x1200
  nappe render wing.nappe.toml -o wing.png --style zebra --azimuth 30 --elevation 20
  nappe render vase.nappe.toml -o lines.png --silhouettes --sections z:12 --isolines 0
  nappe render vase.nappe.toml -o light.png --isophotes 8 --isocurvature gaussian=0")]
pub(crate) struct Args {
    #[command(flatten)]
    model: ModelArgs,

    /// The picture: .png or .svg
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,

    /// Where it is seen from: iso, front, back, left, right, top, bottom, or azimuth,elevation in degrees
    #[arg(long, default_value = "iso", allow_hyphen_values = true)]
    view: View,

    /// Degrees around z, counter-clockwise from above: 0 is the front, 90 the right. In place of the view's
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = super::number)]
    azimuth: Option<f64>,

    /// Degrees above the horizon. In place of the view's
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true, value_parser = super::number)]
    elevation: Option<f64>,

    /// How depth is shown
    #[arg(long, default_value = "perspective")]
    projection: Depth,

    /// Width and height in pixels
    #[arg(long, value_name = "WxH", default_value = "1600x1200", value_parser = size)]
    size: [u32; 2],

    /// How surfaces are coloured
    #[arg(long, default_value = "shaded")]
    style: Style,

    /// Lines of constant u and of constant v on each surface, between its sides. Default: 4 if shaded, 9 for wire
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(0..=500))]
    isolines: Option<u16>,

    #[command(flatten)]
    traced: Traced,

    /// Draw the control nets
    #[arg(long)]
    nets: bool,

    /// Draw the model's curves
    #[arg(long)]
    curves: bool,

    /// Leave out the borders of the surfaces
    #[arg(long)]
    no_edges: bool,

    /// What is behind
    #[arg(long, default_value = "light")]
    background: Behind,

    /// Leave out the title and the axes
    #[arg(long)]
    bare: bool,

    /// The greatest distance between the drawn mesh and the surface, in the model's units. Default: too small to be seen
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true, value_parser = super::length)]
    tolerance: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Depth {
    /// As an eye sees.
    Perspective,
    /// Parallel rays.
    Parallel,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Style {
    /// Each surface in its colour, with light.
    Shaded,
    /// By Gaussian curvature, with a legend.
    CurvatureGaussian,
    /// By mean curvature, with a legend.
    CurvatureMean,
    /// Stripes as a mirror shows them: they tell where surfaces meet with a kink.
    Zebra,
    /// Lines only, hidden ones left out.
    Wire,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Behind {
    Light,
    Dark,
    Transparent,
}

/// Pixels that the silhouette of the mesh may be off.
pub(super) const PIXEL_SHARE: f64 = 0.25;
/// Cells along each direction between which a curvature is interpolated, also where the surface is straight.
const SHADES: usize = 32;
/// Dark stripes over half a turn.
const STRIPES: u32 = 12;

impl Args {
    pub(crate) fn run(&self, screen: &Screen) -> Result<(), Failure> {
        let path = &self.output;
        check(path)?;
        let model = self.model.open(screen)?;
        let longest = f64::from(self.size[0].max(self.size[1]));
        let tolerance = self
            .tolerance
            .unwrap_or_else(|| scene::share_of_size(&model, PIXEL_SHARE / longest));
        let curved = matches!(self.style, Style::CurvatureGaussian | Style::CurvatureMean);
        let detail = scene::Detail {
            tolerance,
            least_cells: if curved { SHADES } else { 1 },
        };
        let (mut scene, left_out) = match self.tolerance {
            None => scene::visible(&model, detail, screen)?,
            asked => (scene::scene(&model, detail, asked, screen)?, Vec::new()),
        };
        let options = self.options(&model, &mut scene);
        let view = options.view;
        let mut picture = Picture::new(&scene, options).lines(self.lines(&model, tolerance)?);
        if self.traced.any() {
            let eye = picture.eye().map_err(|e| Problem::new(e.to_string()))?;
            let lines = self.traced.lines(&model, view, eye, tolerance, screen)?;
            picture = picture.lines(lines);
        }
        if self.nets {
            picture = picture.nets(model.output().filter_map(net));
        }
        write(&picture, path, self.size, &left_out, screen)?;
        if self.nets {
            without_net(&model)
                .iter()
                .for_each(|note| screen.note(note));
        }
        Ok(())
    }

    fn options(&self, model: &Model, scene: &mut Scene) -> PictureOptions {
        let mut view = self.view;
        if let Some(degrees) = self.azimuth {
            view.azimuth = degrees.to_radians();
        }
        if let Some(degrees) = self.elevation {
            view.elevation = degrees.to_radians();
        }
        let paint = match self.style {
            Style::Shaded => Paint::Parts,
            Style::Wire if self.background == Behind::Dark => Paint::Plain([0.1, 0.1, 0.12]),
            Style::Wire => Paint::Plain([1.0; 3]),
            Style::Zebra => Paint::Zebra { stripes: STRIPES },
            Style::CurvatureGaussian => curved(model, scene, Bend::Gaussian),
            Style::CurvatureMean => curved(model, scene, Bend::Mean),
        };
        PictureOptions {
            size: self.size,
            view,
            projection: match self.projection {
                Depth::Perspective => Projection::default(),
                Depth::Parallel => Projection::Parallel,
            },
            paint,
            background: match self.background {
                Behind::Light => Background::Light,
                Behind::Dark => Background::Dark,
                Behind::Transparent => Background::Transparent,
            },
            borders: !self.no_edges,
            // A model of curves alone is drawn by them.
            curves: self.curves || scene.parts.is_empty(),
            title: !self.bare,
            axes: !self.bare,
            ..PictureOptions::default()
        }
    }

    fn lines(&self, model: &Model, tolerance: f64) -> Result<Vec<Line>, Failure> {
        let n = self.isolines.unwrap_or(match self.style {
            Style::Shaded => 4,
            Style::Wire => 9,
            _ => 0,
        });
        let mut lines = Vec::new();
        for s in model.output() {
            for (along, across) in [(Dir::U, Dir::V), (Dir::V, Dir::U)] {
                let range = s.surface.breaks(across).domain();
                for k in 1..=n {
                    let at = range.lo + range.width() * f64::from(k) / f64::from(n + 1);
                    lines.push(Line::isoline(isoline(model, s, along, at, tolerance)?));
                }
            }
        }
        Ok(lines)
    }
}

/// Draws a picture into a file, and tells how large it is and which surfaces are not in it.
pub(super) fn write(
    picture: &Picture,
    path: &Path,
    size: [u32; 2],
    left_out: &[String],
    screen: &Screen,
) -> Result<(), Failure> {
    let progress = screen.progress("Drawing");
    let tell = |share| progress.tell(share);
    let report = picture.write(path, Progress::to(&tell));
    progress.finish();
    let report = report.map_err(output::refused)?;
    screen.note(format!(
        "{}: {} × {} pixels, {}",
        path.display(),
        size[0],
        size[1],
        text::bytes(report.bytes)
    ));
    report.notes.into_iter().for_each(|note| screen.note(note));
    tell_left_out(left_out, screen);
    Ok(())
}

/// Tells which surfaces are not drawn.
fn tell_left_out(names: &[String], screen: &Screen) {
    if !names.is_empty() {
        screen.note(format!(
            "note: too small to be seen at this size, and not drawn: {}\n  help: to see it, draw it alone, with the rest \
             construction_only = true",
            names.join(", ")
        ));
    }
}

/// Colours by curvature, on a scale of the values themselves.
fn curved(model: &Model, scene: &mut Scene, which: Bend) -> Paint {
    scene.fields = vec![scene::curvature_field(model, &scene.mesh, which)];
    Paint::Field {
        index: 0,
        map: ColourMap::default(),
        range: None,
    }
}

/// The most points of a line: enough for any picture.
pub(super) const MOST_POINTS: usize = 100_000;

fn isoline(
    model: &Model,
    s: &NamedSurface,
    along: Dir,
    at: f64,
    tolerance: f64,
) -> Result<Vec<DVec3>, Failure> {
    let refused = |e: &dyn std::fmt::Display| {
        let message = format!(
            "surface `{}`: an isoline of it cannot be drawn: {e}",
            s.name
        );
        let help = "leave the isolines out with --isolines 0";
        fault::at(model, message, &s.place, help)
    };
    let line = Isocurve::new(s.surface.clone(), along, at).map_err(|e| refused(&e))?;
    let flat = flatten(&line, tolerance, MOST_POINTS).map_err(|e| refused(&e))?;
    Ok(flat.points)
}

/// The net that a surface is given by, else that of its exact NURBS form.
fn net(s: &NamedSurface) -> Option<Net> {
    if let Some(rows) = &s.control_net {
        let columns = rows.first()?.len();
        return Some(Net::new(s.name.as_str(), rows.concat(), columns));
    }
    let nurbs = s.surface.to_nurbs()?;
    Some(Net::new(
        s.name.as_str(),
        nurbs.control_points(),
        nurbs.size()[1],
    ))
}

/// Why surfaces have no net, in words.
fn without_net(model: &Model) -> Vec<String> {
    let without: Vec<&NamedSurface> = model.output().filter(|s| net(s).is_none()).collect();
    let (same_points, none): (Vec<_>, Vec<_>) = without
        .into_iter()
        .partition(|s| s.surface.to_rational().is_some());
    let names = |list: &[&NamedSurface]| {
        let names: Vec<String> = list
            .iter()
            .map(|s| format!("{} ({})", s.name, s.kind))
            .collect();
        names.join(", ")
    };
    let mut notes = Vec::new();
    if !same_points.is_empty() {
        let help = if same_points.iter().any(|s| s.kind == "revolution") {
            "\n  help: a revolution with construction = \"rational\" has one"
        } else {
            ""
        };
        notes.push(format!(
            "note: no control net is drawn for {}: its points are those of a NURBS surface, but its parameters are not{help}",
            names(&same_points)
        ));
    }
    if !none.is_empty() {
        notes.push(format!(
            "note: no control net is drawn for {}: it has no exact NURBS form, since it is not a piecewise rational function",
            names(&none)
        ));
    }
    notes
}

/// Says early what would keep the picture from being written.
pub(super) fn check(path: &Path) -> Result<(), Failure> {
    match Format::from_path(path) {
        Ok(Format::Png | Format::Svg) => output::check(path),
        Ok(other) => Err(Problem::new(format!(
            "{}: {other} is not a format of pictures",
            path.display()
        ))
        .help("pictures are .png or .svg; `nappe build` writes meshes and exact surfaces")
        .into()),
        Err(e) => Err(output::refused(e)),
    }
}

pub(super) fn size(text: &str) -> Result<[u32; 2], String> {
    let wrong = || format!("`{text}` is not a size such as 1600x1200");
    let (w, h) = text.split_once(['x', 'X', '×']).ok_or_else(wrong)?;
    let pixels = |s: &str| match s.trim().parse::<u32>() {
        Ok(n) if (16..=16384).contains(&n) => Ok(n),
        Ok(n) => Err(format!("{n} pixels; a side has from 16 to 16384")),
        Err(_) => Err(wrong()),
    };
    Ok([pixels(w)?, pixels(h)?])
}
