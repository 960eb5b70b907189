//! The picture of the joints: sides in the colour of what they reach, and the places where something is wrong.

use super::Findings;
use super::declared::Declared;
use super::reached::{Reached, SMOOTH_ANGLE, reached};
use crate::commands::render::{self, MOST_POINTS, PIXEL_SHARE};
use crate::failure::Failure;
use crate::screen::Screen;
use crate::{fault, scene};
use nappe::DVec3;
use nappe::curve::{CurveRef, Isocurve, Trimmed};
use nappe::measure::Meeting;
use nappe::mesh::flatten;
use nappe::surface::{Dir, Side, SurfaceRef};
use nappe_exchange::Colour;
use nappe_exchange::render::{Dot, KeyEntry, Line, Paint, Picture, PictureOptions, View};
use nappe_model::{Model, NamedSurface};
use std::path::PathBuf;
use std::sync::Arc;

/// The options of the picture.
#[derive(Debug, clap::Args)]
pub(super) struct Drawing {
    /// Draws the model with its joints: a .png or .svg
    #[arg(long, value_name = "FILE")]
    draw: Option<PathBuf>,

    /// Where it is seen from: iso, front, back, left, right, top, bottom, or azimuth,elevation in degrees
    #[arg(
        long,
        default_value = "iso",
        allow_hyphen_values = true,
        requires = "draw"
    )]
    view: View,

    /// Width and height of the picture in pixels
    #[arg(long, value_name = "WxH", default_value = "1600x1200", value_parser = render::size, requires = "draw")]
    size: [u32; 2],
}

/// The colour of the surfaces: pale, so that the lines stand out.
const SURFACE: Colour = [0.80, 0.82, 0.85];
/// A band behind the sides of a claim that fails.
const FAILED: Colour = [0.88, 0.05, 0.45];
const UNMET: &str = "a claim fails or is not proven";
const OPEN: Colour = [0.35, 0.38, 0.42];
/// Where a surface folds over or passes through itself; where two cross, or touch; where nothing is decided.
const BROKEN: Colour = [0.80, 0.06, 0.10];
const CROSSED: Colour = [0.45, 0.17, 0.62];
const TOUCHED: Colour = [0.16, 0.56, 0.68];
const UNDECIDED: Colour = [0.25, 0.27, 0.30];
/// How much of a line is seen through the surfaces that hide it.
const HIDDEN: f32 = 0.28;

impl Reached {
    /// All, from worst to best.
    const ALL: [Reached; 7] = [
        Reached::Apart,
        Reached::InPart,
        Reached::Edge,
        Reached::Crease,
        Reached::Points,
        Reached::Tangents,
        Reached::Curvatures,
    ];

    /// Colours that are told apart also without red and green; the worse, the wider.
    fn style(self) -> (Colour, f64, &'static str) {
        match self {
            Reached::Apart => ([0.80, 0.06, 0.10], 5.5, "not joined: a gap"),
            Reached::InPart => ([0.62, 0.25, 0.72], 5.0, "in part, but not from end to end"),
            Reached::Edge => ([0.93, 0.49, 0.05], 4.2, "G0: an edge"),
            Reached::Crease => ([0.93, 0.49, 0.05], 4.2, "a crease in a surface"),
            Reached::Points => ([0.85, 0.69, 0.08], 4.2, "G0; more is not proven"),
            Reached::Tangents => ([0.13, 0.42, 0.75], 3.8, "G1"),
            Reached::Curvatures => ([0.10, 0.60, 0.46], 3.4, "G2"),
        }
    }
}

/// What is drawn over the surfaces, with its key.
#[derive(Default)]
struct Overlay {
    lines: Vec<Line>,
    dots: Vec<Dot>,
    key: Vec<KeyEntry>,
}

impl Overlay {
    fn dot(&mut self, at: DVec3, colour: Colour, text: &str) {
        const RADIUS: f64 = 6.5;
        let radius = RADIUS;
        self.dots.push(Dot { at, colour, radius });
        self.explain(colour, 2.0 * RADIUS, true, text);
    }

    /// Adds an entry to the key, once.
    fn explain(&mut self, colour: Colour, width: f64, dot: bool, text: &str) {
        if self.key.iter().all(|e| e.text != text) {
            self.key.push(KeyEntry {
                colour,
                width,
                dot,
                text: text.to_owned(),
            });
        }
    }
}

impl Drawing {
    /// Says early what would keep the picture from being written.
    pub(super) fn check(&self) -> Result<(), Failure> {
        self.draw
            .as_ref()
            .map_or(Ok(()), |path| render::check(path))
    }

    /// Draws the picture, if it is asked for.
    pub(super) fn draw(
        &self,
        model: &Model,
        found: &Findings,
        screen: &Screen,
    ) -> Result<(), Failure> {
        let Some(path) = &self.draw else {
            return Ok(());
        };
        let longest = f64::from(self.size[0].max(self.size[1]));
        let tolerance = scene::share_of_size(model, PIXEL_SHARE / longest);
        let detail = scene::Detail {
            tolerance,
            least_cells: 1,
        };
        let (mut scene, left_out) = scene::visible(model, detail, screen)?;
        scene.curves.clear();
        let overlay = overlay(model, found, tolerance)?;
        let options = PictureOptions {
            size: self.size,
            view: self.view,
            paint: Paint::Plain(SURFACE),
            // Every side has a line of its own.
            borders: false,
            ..PictureOptions::default()
        };
        let picture = Picture::new(&scene, options)
            .lines(overlay.lines)
            .dots(overlay.dots)
            .key(overlay.key);
        render::write(&picture, path, self.size, &left_out, screen)
    }
}

fn overlay(model: &Model, found: &Findings, tolerance: f64) -> Result<Overlay, Failure> {
    let mut all = Overlay::default();
    let named: Vec<&NamedSurface> = model.output().collect();
    let refused = |s: &NamedSurface, what: &str, e: &dyn std::fmt::Display| {
        let message = format!("surface `{}`: {what} of it cannot be drawn: {e}", s.name);
        fault::at(model, message, &s.place, "leave --draw out")
    };
    let flat = |s: &NamedSurface, what: &str, curve: CurveRef| {
        let flat = flatten(curve.as_ref(), tolerance, MOST_POINTS);
        flat.map(|f| f.points).map_err(|e| refused(s, what, &e))
    };
    let points = |surface: &SurfaceRef, side: Side, s: &NamedSurface, range: Option<[f64; 2]>| {
        let curve: CurveRef = Arc::new(Isocurve::side(surface.clone(), side));
        let curve = match range {
            None => curve,
            Some([lo, hi]) => {
                let part = Trimmed::new(curve, lo, hi);
                Arc::new(part.map_err(|e| refused(s, side.name(), &e))?)
            }
        };
        flat(s, side.name(), curve)
    };
    let of = |(i, side): (usize, Side), range| points(&named[i].surface, side, named[i], range);
    // Failed claims lie below the lines that show what is there.
    const BAND: f64 = 13.0;
    let failed = found.declared.iter().filter(|d| !d.verdict.passes());
    for Declared { check, .. } in failed {
        for side in &check.between {
            // A side of something that is not put out has no place of its own in the file: that of any surface serves.
            let Some(s) = named
                .iter()
                .find(|s| s.name == side.surface)
                .or(named.first())
            else {
                continue;
            };
            let line = Line {
                points: points(&side.geometry, side.side, s, None)?,
                colour: FAILED,
                opacity: 0.45,
                width: BAND,
                hidden: 0.3,
            };
            all.lines.push(line);
        }
    }
    for &side in &found.open {
        let points = of(side, None)?;
        all.lines.push(line(points, OPEN, 1.6));
    }
    let mut joints = Vec::new();
    for s in &found.shared {
        joints.push((s.reached(), of(s.first, None)?));
    }
    for s in &found.stretches {
        let reached = match &s.joint {
            Some(j) if found.is_close(j) => reached(j),
            Some(_) => Reached::Apart,
            None => Reached::InPart,
        };
        // Both: one may be hidden by the other where they lie apart.
        for (side, range) in s.sides.into_iter().zip(s.ranges) {
            joints.push((reached, of(side, Some([range.lo, range.hi]))?));
        }
    }
    for (i, (s, _, creases)) in found.surfaces.iter().enumerate() {
        // As a joint at a smaller angle counts as smooth.
        for c in creases.iter().filter(|c| c.angle > SMOOTH_ANGLE) {
            let along = match c.dir {
                Dir::U => Dir::V,
                Dir::V => Dir::U,
            };
            let curve = Isocurve::new(s.surface.clone(), along, c.at);
            let curve: CurveRef = Arc::new(curve.map_err(|e| refused(named[i], "a crease", &e))?);
            let points = flat(named[i], "a crease", curve)?;
            joints.push((Reached::Crease, points));
        }
    }
    // The worst on top.
    joints.sort_by_key(|j| std::cmp::Reverse(Reached::ALL.iter().position(|r| *r == j.0)));
    for (reached, points) in &joints {
        let (colour, width, _) = reached.style();
        all.lines.push(line(points.clone(), colour, width));
    }
    for reached in Reached::ALL {
        let (colour, width, text) = reached.style();
        if joints.iter().any(|j| j.0 == reached) {
            all.explain(colour, width, false, text);
        }
    }
    if !found.open.is_empty() {
        all.explain(OPEN, 1.6, false, "an open side");
    }
    if found.declared.iter().any(|d| !d.verdict.passes()) {
        all.explain(FAILED.map(|c| 0.45 * c + 0.5), BAND, false, UNMET);
    }
    spots(found, &mut all);
    Ok(all)
}

/// The places where something is wrong with surfaces, or not decided.
fn spots(found: &Findings, all: &mut Overlay) {
    for (s, regular, _) in &found.surfaces {
        for uv in &regular.folds {
            all.dot(s.surface.point(*uv), BROKEN, "folds over");
        }
        for p in &regular.pinches {
            all.dot(p.point, UNDECIDED, "a line inside is one point");
        }
        for uv in &regular.degenerate {
            all.dot(
                s.surface.point(*uv),
                UNDECIDED,
                "no tangent plane, or not proven",
            );
        }
    }
    for (o, fails) in found.passing.found() {
        let (colour, text) = match o.meeting {
            _ if fails => (BROKEN, "passes through itself"),
            Meeting::Crosses { .. } => (CROSSED, "cross"),
            Meeting::Overlaps => (CROSSED, "have an area in common"),
            Meeting::Touches { only: true } => (TOUCHED, "touch, proven not to cross"),
            Meeting::Touches { only: false } => {
                (UNDECIDED, "touch; not decided whether they cross")
            }
            Meeting::Undecided { .. } => (UNDECIDED, "not decided whether they cross"),
        };
        all.dot(o.point, colour, text);
    }
}

fn line(points: Vec<DVec3>, colour: Colour, width: f64) -> Line {
    Line {
        points,
        colour,
        opacity: 1.0,
        width,
        hidden: HIDDEN,
    }
}
