//! The lines of `nappe render` that are traced on surfaces.

use crate::failure::Failure;
use crate::fault;
use crate::screen::Screen;
use nappe::measure::CurvatureKind;
use nappe::mesh::flatten;
use nappe::query::{Figure, SurfaceField, TraceError, TraceOptions, trace};
use nappe::{Certainty, DVec3, Interval};
use nappe_exchange::render::{Line, View};
use nappe_model::{Model, NamedSurface};
use std::f64::consts::PI;
use std::fmt;

/// Lines that are traced.
#[derive(Debug, clap::Args)]
pub(crate) struct Traced {
    /// Draw where surfaces are seen edge-on
    #[arg(long)]
    silhouettes: bool,

    /// Draw sections with planes square to an axis: one such as z=2.5, or some at equal distances such as z:12
    #[arg(long, value_name = "AXIS=X|AXIS:N", value_parser = sections)]
    sections: Vec<Sections>,

    /// Draw lines of equal angle between the normal and the axis of the view, at equal steps of it
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=100))]
    isophotes: Option<u16>,

    /// Draw where a curvature (gaussian, mean, k1, k2) has a value, such as gaussian=0
    #[arg(long, value_name = "KIND=VALUE", value_parser = isocurvature)]
    isocurvature: Vec<Isocurvature>,
}

/// Planes square to an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Sections {
    axis: usize,
    planes: Planes,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Planes {
    At(f64),
    Count(u16),
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Isocurvature {
    kind: CurvatureKind,
    value: f64,
}

/// The most points of a line, and the most cells looked at for it: enough for any picture.
const MOST_POINTS: usize = 100_000;
const MOST_CELLS: usize = 30_000;
/// Samples of a surface in each direction for its extent.
const SAMPLES: usize = 17;

/// A line to be traced on a surface.
struct Wanted {
    figure: Figure,
    colour: [f32; 3],
    width: f64,
}

impl Traced {
    pub(crate) fn any(&self) -> bool {
        self.silhouettes
            || !self.sections.is_empty()
            || self.isophotes.is_some()
            || !self.isocurvature.is_empty()
    }

    /// All lines on all surfaces. What could not be decided is told.
    pub(crate) fn lines(
        &self,
        model: &Model,
        view: View,
        eye: Option<DVec3>,
        tolerance: f64,
        screen: &Screen,
    ) -> Result<Vec<Line>, Failure> {
        let wanted = self.wanted(model, view, eye);
        let surfaces: Vec<&NamedSurface> = model.output().collect();
        let progress = screen.progress("Tracing");
        let mut lines = Vec::new();
        for (k, s) in surfaces.iter().enumerate() {
            let (mut undecided, mut far, mut flat) = (0, 0, false);
            for (i, w) in wanted.iter().enumerate() {
                let done = k * wanted.len() + i;
                progress.tell(done as f64 / (wanted.len() * surfaces.len()) as f64);
                match traced(model, s, w, tolerance)? {
                    Some(found) => {
                        lines.extend(found.lines);
                        undecided += found.undecided;
                        far += found.far;
                    }
                    None => flat = true,
                }
            }
            if undecided > 0 {
                screen.note(format!(
                    "note: surface `{}`: {undecided} places are not decided: lines may cross or end there",
                    s.name
                ));
            }
            if far > 0 {
                screen.note(format!(
                    "note: surface `{}`: {far} lines are not proven to be within the tolerance",
                    s.name
                ));
            }
            if flat {
                screen.note(format!(
                    "note: surface `{}`: a line would be a whole region of it, and is not drawn",
                    s.name
                ));
            }
        }
        progress.finish();
        Ok(lines)
    }

    fn wanted(&self, model: &Model, view: View, eye: Option<DVec3>) -> Vec<Wanted> {
        let mut wanted = Vec::new();
        let towards = view.axes()[2];
        if self.silhouettes {
            let figure = match eye {
                Some(eye) => Figure::SilhouetteFrom { eye },
                None => Figure::Silhouette { direction: towards },
            };
            wanted.push(Wanted {
                figure,
                colour: [0.05, 0.06, 0.08],
                width: 2.4,
            });
        }
        for s in &self.sections {
            let at: Vec<f64> = match s.planes {
                Planes::At(x) => vec![x],
                Planes::Count(n) => {
                    let range = extent(model, s.axis);
                    let part = |k: u16| f64::from(k) / f64::from(n + 1);
                    (1..=n)
                        .map(|k| range.lo + (range.hi - range.lo) * part(k))
                        .collect()
                }
            };
            let normal = DVec3::AXES[s.axis];
            wanted.extend(at.into_iter().map(|x| Wanted {
                figure: Figure::Section {
                    point: normal * x,
                    normal,
                },
                colour: [0.75, 0.22, 0.17],
                width: 1.4,
            }));
        }
        for k in 1..=self.isophotes.unwrap_or(0) {
            let angle = PI * f64::from(k) / f64::from(self.isophotes.unwrap_or(0) + 1);
            wanted.push(Wanted {
                figure: Figure::Isophote {
                    direction: towards,
                    angle,
                },
                colour: [0.60, 0.35, 0.02],
                width: 1.4,
            });
        }
        wanted.extend(self.isocurvature.iter().map(|c| Wanted {
            figure: Figure::Curvature {
                kind: c.kind,
                value: c.value,
            },
            colour: [0.10, 0.30, 0.65],
            width: 2.0,
        }));
        wanted
    }
}

/// A line on a surface in its branches.
struct Drawn {
    lines: Vec<Line>,
    /// How many places are not decided.
    undecided: usize,
    /// How many branches are not proven to be within the tolerance.
    far: usize,
}

/// A line on a surface; `None` if it is a region.
fn traced(
    model: &Model,
    s: &NamedSurface,
    wanted: &Wanted,
    tolerance: f64,
) -> Result<Option<Drawn>, Failure> {
    let refused = |e: &dyn fmt::Display| {
        let message = format!("surface `{}`: a line cannot be traced on it: {e}", s.name);
        fault::at(model, message, &s.place, "draw other lines")
    };
    let field = SurfaceField::new(s.surface.clone(), wanted.figure).map_err(|e| refused(&e))?;
    let options = TraceOptions {
        surface: Some(s.surface.clone()),
        tol: Some(tolerance),
        budget: MOST_CELLS,
        ..TraceOptions::default()
    };
    let found = match trace(&field, &options) {
        Ok(found) => found,
        Err(TraceError::Zero(_)) => return Ok(None),
        Err(e) => return Err(refused(&e)),
    };
    let mut lines = Vec::new();
    for branch in &found.branches {
        let flat =
            flatten(branch.curve().as_ref(), tolerance, MOST_POINTS).map_err(|e| refused(&e))?;
        lines.push(Line {
            colour: wanted.colour,
            width: wanted.width,
            ..Line::border(flat.points)
        });
    }
    let far = |c: Certainty| matches!(c, Certainty::Estimated(_)) || c.error() > found.tol;
    Ok(Some(Drawn {
        lines,
        undecided: found.undecided.len(),
        far: found.branches.iter().filter(|b| far(b.certainty)).count(),
    }))
}

/// The extent of the drawn surfaces along an axis, by samples.
fn extent(model: &Model, axis: usize) -> Interval {
    let mut range: Option<Interval> = None;
    for s in model.output() {
        let [u, v] = s.surface.domain();
        for k in 0..SAMPLES * SAMPLES {
            let at = |d: Interval, i: usize| d.lo + (d.hi - d.lo) * i as f64 / (SAMPLES - 1) as f64;
            let x = s.surface.point([at(u, k / SAMPLES), at(v, k % SAMPLES)])[axis];
            if x.is_finite() {
                let x = Interval::point(x);
                range = Some(range.map_or(x, |r| r.hull(x)));
            }
        }
    }
    range.unwrap_or(Interval::ZERO)
}

fn sections(text: &str) -> Result<Sections, String> {
    let wrong = || format!("`{text}` is not a section such as z=2.5 or z:12");
    let at = text.find(['=', ':']).ok_or_else(wrong)?;
    let axis = match text[..at].trim() {
        "x" => 0,
        "y" => 1,
        "z" => 2,
        _ => return Err(wrong()),
    };
    let number = text[at + 1..].trim();
    let planes = if text[at..].starts_with('=') {
        Planes::At(super::number(number)?)
    } else {
        match number.parse() {
            Ok(n @ 1..=500) => Planes::Count(n),
            Ok(n) => return Err(format!("{n} sections; there can be 1 to 500")),
            Err(_) => return Err(wrong()),
        }
    };
    Ok(Sections { axis, planes })
}

fn isocurvature(text: &str) -> Result<Isocurvature, String> {
    let wrong = || format!("`{text}` is not a curvature such as gaussian=0 or mean=0.5");
    let (kind, value) = text.split_once('=').ok_or_else(wrong)?;
    let kind = match kind.trim() {
        "gaussian" => CurvatureKind::Gaussian,
        "mean" => CurvatureKind::Mean,
        "k1" => CurvatureKind::K1,
        "k2" => CurvatureKind::K2,
        _ => return Err(wrong()),
    };
    let value = super::number(value.trim())?;
    Ok(Isocurvature { kind, value })
}
