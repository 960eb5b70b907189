//! `nappe info`.

use super::report::{ReportFormat, certainty_json};
use crate::failure::{Failure, Problem};
use crate::model::ModelArgs;
use crate::scene;
use crate::screen::Screen;
use crate::text::{Table, bound, number};
use nappe::Box3;
use nappe::exact::NurbsSurface;
use nappe::measure::{
    CurvatureExtremes, Extent, Extreme, IntegralOptions, Measured, SearchOptions, VolumeError,
    area, curvature_extremes, extent, volume,
};
use nappe::mesh::{Certainty, Joints, joints};
use nappe::surface::{Side, SurfaceRef};
use nappe_exchange::Format;
use nappe_model::{Model, NamedSurface};
use serde_json::{Value, json};
use std::io::{self, Write};

/// Tell what is in a model: surfaces, degrees, exactness, box, area, enclosed volume, curvature
///
/// Every number is given with its error: proven, or estimated where that is said. Curvature is signed by the normal
/// r_u × r_v: where the surface bends towards it the mean curvature is positive.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe info vase.nappe.toml
  nappe info vase.nappe.toml --set height=300 --format json")]
pub(crate) struct Args {
    #[command(flatten)]
    model: ModelArgs,

    /// A report for people, or JSON for programs
    #[arg(long, default_value = "text")]
    format: ReportFormat,
}

/// Sides nearer than this share of the box are the same side.
const SAME_SIDE: f64 = 1e-7;

/// A report is read by people who wait for it: a few digits, each proven, rather than all.
const INTEGRALS: IntegralOptions = IntegralOptions {
    relative: 1e-6,
    budget: 2000,
};
const SEARCH: SearchOptions = SearchOptions {
    relative: 1e-3,
    budget: 300,
};

impl Args {
    pub(crate) fn run(&self, screen: &Screen) -> Result<(), Failure> {
        refuse_other_formats(&self.model)?;
        let model = self.model.open(screen)?;
        let facts = Facts::of(&model, screen);
        let text = match self.format {
            ReportFormat::Text => facts.text(&model),
            ReportFormat::Json => format!("{:#}\n", facts.json(&model)),
        };
        Ok(io::stdout().lock().write_all(text.as_bytes())?)
    }
}

/// A mesh or a STEP file is not a model: to say so is kinder than to call it wrong TOML.
fn refuse_other_formats(model: &ModelArgs) -> Result<(), Problem> {
    let ending = model.path().extension().unwrap_or_default();
    let ending = ending.to_string_lossy().to_ascii_lowercase();
    let exact = ["step", "stp", "iges", "igs"].contains(&ending.as_str());
    if !exact && !Format::ALL.iter().any(|f| f.ending() == ending) {
        return Ok(());
    }
    Err(Problem::new(format!(
        "{}: .{ending} files cannot be read yet",
        model.path().display()
    ))
    .help("`nappe info` reads model files, *.nappe.toml"))
}

/// What is said of a whole model.
struct Facts {
    surfaces: Vec<SurfaceFacts>,
    area: Measured,
    volume: Result<Measured, String>,
    extent: Option<(Box3, Certainty)>,
}

/// What is said of one surface.
struct SurfaceFacts {
    nurbs: Option<NurbsSurface>,
    area: Measured,
    extent: Option<Extent>,
    curvature: Option<CurvatureExtremes>,
    closed: [bool; 2],
    collapsed: Vec<Side>,
}

impl Facts {
    fn of(model: &Model, screen: &Screen) -> Facts {
        let named: Vec<&NamedSurface> = model.output().collect();
        let surfaces: Vec<SurfaceRef> = named.iter().map(|s| s.surface.clone()).collect();
        let met = joints(&surfaces, scene::share_of_size(model, SAME_SIDE));
        let progress = screen.progress("Measuring");
        let facts: Vec<SurfaceFacts> = surfaces
            .iter()
            .enumerate()
            .map(|(i, s)| {
                let facts = SurfaceFacts::of(s, i, &met);
                progress.tell((i + 1) as f64 / surfaces.len() as f64);
                facts
            })
            .collect();
        progress.finish();
        Facts {
            area: sum(facts.iter().map(|f| f.area)),
            volume: volume(&surfaces, None, &INTEGRALS).map_err(|e| open(&e, &named)),
            extent: whole(&facts),
            surfaces: facts,
        }
    }

    fn text(&self, model: &Model) -> String {
        let unit = model.units.symbol();
        let mut head = Table::of_facts();
        head.row(["title", &model.title]);
        head.row(["units", unit]);
        for (i, p) in model.params.iter().enumerate() {
            let name = if i == 0 { "parameters" } else { "" };
            let from = p
                .expression
                .as_ref()
                .map_or(String::new(), |e| format!(" = {e}"));
            let doc = p.doc.as_ref().map_or(String::new(), |d| format!("  ({d})"));
            head.row([
                name.to_owned(),
                format!("{}{from} = {}{doc}", p.name, number(p.value, 7)),
            ]);
        }
        let put_out = model.curves.iter().filter(|c| !c.construction_only).count();
        head.row(["curves", &counted(put_out, model.curves.len())]);
        head.row([
            "surfaces",
            &counted(self.surfaces.len(), model.surfaces.len()),
        ]);
        if let Some((hull, certainty)) = self.extent {
            let size = hull.to_array().map(|i| number(i.hi - i.lo, 7)).join(" × ");
            let range = hull
                .to_array()
                .map(|i| format!("{} … {}", number(i.lo, 7), number(i.hi, 7)))
                .join(", ");
            head.row([
                "box",
                &format!("{size} {unit}{}: {range}", error(certainty)),
            ]);
        }
        if !self.surfaces.is_empty() {
            head.row(["area", &format!("{} {unit}²", measured(self.area))]);
            let volume = match &self.volume {
                Ok(v) if v.value < 0.0 => {
                    let outward = Measured {
                        value: -v.value,
                        ..*v
                    };
                    format!(
                        "{} {unit}³ enclosed; the normals point inwards",
                        measured(outward)
                    )
                }
                Ok(v) => format!("{} {unit}³ enclosed", measured(*v)),
                Err(e) => format!("none: {e}"),
            };
            head.row(["volume", &volume]);
        }
        let mut text = format!("{head}\n");
        if !self.surfaces.is_empty() {
            text.push_str(&format!("\n{}\n", self.table(model, unit)));
        }
        text
    }

    fn table(&self, model: &Model, unit: &str) -> Table {
        let headings = [
            "surface".to_owned(),
            "kind".to_owned(),
            "NURBS".to_owned(),
            format!("box in {unit}"),
            format!("area in {unit}²"),
            format!("Gaussian curvature in 1/{unit}²"),
            format!("mean curvature in 1/{unit}"),
            "closed".to_owned(),
        ];
        let mut table = Table::headed(headings.each_ref().map(String::as_str));
        for (s, f) in model.output().zip(&self.surfaces) {
            let nurbs = f.nurbs.as_ref().map_or("no exact form".to_owned(), |n| {
                format!("{} × {}", n.basis_u().degree(), n.basis_v().degree())
            });
            let size = f.extent.as_ref().map_or(String::new(), |e| {
                e.hull
                    .to_array()
                    .map(|i| number(i.hi - i.lo, 5))
                    .join(" × ")
            });
            let (gaussian, mean) = f.curvature.as_ref().map_or_else(
                || ("no normal anywhere".to_owned(), String::new()),
                |c| (range(&c.gaussian), range(&c.mean)),
            );
            table.row([
                s.name.clone(),
                s.kind.to_owned(),
                nurbs,
                size,
                measured(f.area),
                gaussian,
                mean,
                f.closure(),
            ]);
        }
        table
    }

    fn json(&self, model: &Model) -> Value {
        let params: Vec<Value> = model
            .params
            .iter()
            .map(|p| {
                json!({
                    "name": p.name, "value": p.value, "expression": p.expression,
                    "min": p.min, "max": p.max, "doc": p.doc,
                })
            })
            .collect();
        let curves: Vec<Value> = model
            .curves
            .iter()
            .map(|c| {
                let nurbs = c.curve.to_nurbs();
                let domain = c.curve.domain();
                json!({
                    "name": c.name, "kind": c.kind, "construction_only": c.construction_only,
                    "domain": [domain.lo, domain.hi],
                    "exact_nurbs": nurbs.is_some(), "degree": nurbs.map(|n| n.degree()),
                })
            })
            .collect();
        let surfaces: Vec<Value> = model
            .output()
            .zip(&self.surfaces)
            .map(|(s, f)| f.json(s))
            .collect();
        json!({
            "title": model.title,
            "units": model.units.symbol(),
            "params": params,
            "curves": curves,
            "surfaces": surfaces,
            "box": self.extent.map(|(hull, certainty)| box_json(hull, certainty)),
            "area": measured_json(self.area),
            "volume": self.volume.as_ref().ok().map(|v| measured_json(*v)),
            "not_closed": self.volume.as_ref().err(),
        })
    }
}

impl SurfaceFacts {
    fn of(surface: &SurfaceRef, index: usize, met: &Joints) -> SurfaceFacts {
        let own = |a: Side, b: Side| {
            met.joints.iter().any(|j| {
                let sides = [j.first, j.second];
                sides.contains(&(index, a)) && sides.contains(&(index, b))
            })
        };
        SurfaceFacts {
            nurbs: surface.to_nurbs(),
            area: area(surface.as_ref(), &INTEGRALS),
            extent: extent(surface.as_ref(), &SEARCH),
            curvature: curvature_extremes(surface.as_ref(), &SEARCH),
            closed: [own(Side::West, Side::East), own(Side::South, Side::North)],
            collapsed: met.collapsed[index].clone(),
        }
    }

    fn closure(&self) -> String {
        let mut words: Vec<String> = Vec::new();
        for (closed, name) in self.closed.iter().zip(["along u", "along v"]) {
            if *closed {
                words.push(name.to_owned());
            }
        }
        words.extend(self.collapsed.iter().map(|s| format!("{s} is a point")));
        if words.is_empty() {
            "no".to_owned()
        } else {
            words.join(", ")
        }
    }

    fn json(&self, s: &NamedSurface) -> Value {
        let domain = s.surface.domain().map(|d| [d.lo, d.hi]);
        json!({
            "name": s.name,
            "object": s.object,
            "kind": s.kind,
            "domain": domain,
            "exact_nurbs": self.nurbs.is_some(),
            "degree": self.nurbs.as_ref().map(|n| [n.basis_u().degree(), n.basis_v().degree()]),
            "rational": self.nurbs.as_ref().map(NurbsSurface::is_rational),
            "box": self.extent.as_ref().map(|e| box_json(e.hull, e.certainty)),
            "area": measured_json(self.area),
            "gaussian_curvature": self.curvature.as_ref().map(|c| c.gaussian.map(extreme_json)),
            "mean_curvature": self.curvature.as_ref().map(|c| c.mean.map(extreme_json)),
            "smallest_radius": self.curvature.as_ref().map(|c| c.smallest_radius).filter(|r| r.is_finite()),
            "closed_u": self.closed[0],
            "closed_v": self.closed[1],
            "collapsed_sides": self.collapsed.iter().map(|s| s.name()).collect::<Vec<_>>(),
        })
    }
}

fn counted(put_out: usize, all: usize) -> String {
    if put_out == all {
        all.to_string()
    } else {
        format!("{put_out}, and {} for construction only", all - put_out)
    }
}

/// Why there is no volume, with names instead of numbers.
fn open(e: &VolumeError, named: &[&NamedSurface]) -> String {
    let mut text = e.to_string();
    // From the last, so that `surface 1` is not found in `surface 12`.
    for (i, s) in named.iter().enumerate().rev() {
        text = text.replace(&format!("surface {i} "), &format!("`{}` ", s.name));
        if let Some(start) = text.strip_suffix(&format!("surface {i}")) {
            text = format!("{start}`{}`", s.name);
        }
    }
    text
}

fn sum(parts: impl Iterator<Item = Measured>) -> Measured {
    parts.fold(
        Measured {
            value: 0.0,
            certainty: Certainty::Exact,
        },
        |a, b| {
            let e = a.certainty.error() + b.certainty.error();
            Measured {
                value: a.value + b.value,
                certainty: match a.certainty.and(b.certainty) {
                    Certainty::Exact => Certainty::Exact,
                    Certainty::Bounded(_) => Certainty::Bounded(e),
                    Certainty::Estimated(_) => Certainty::Estimated(e),
                },
            }
        },
    )
}

fn whole(facts: &[SurfaceFacts]) -> Option<(Box3, Certainty)> {
    facts
        .iter()
        .filter_map(|f| f.extent.as_ref())
        .map(|e| (e.hull, e.certainty))
        .reduce(|a, b| (a.0.hull(b.0), a.1.and(b.1)))
}

/// The digits that are known, and the error.
fn measured(m: Measured) -> String {
    format!("{}{}", number(m.value, 10), error(m.certainty))
}

fn error(c: Certainty) -> String {
    match c {
        Certainty::Exact => String::new(),
        Certainty::Bounded(e) => format!(" ± {}", bound(e, 1)),
        Certainty::Estimated(e) => format!(" ± {} (estimated)", bound(e, 1)),
    }
}

/// The least and greatest value: a bound on each is in the JSON.
fn range([least, greatest]: &[Extreme; 2]) -> String {
    let unknown = |e: &Extreme| !e.certainty.error().is_finite();
    let about = match (unknown(least), unknown(greatest)) {
        (true, true) => " (sampled; not bounded)",
        (true, false) => " (least sampled; not bounded)",
        (false, true) => " (greatest sampled; not bounded)",
        (false, false) => "",
    };
    // Rounding leaves a curvature of 1e-17 where 0 is meant.
    let finite = |x: f64| if x.is_finite() { x.abs() } else { 0.0 };
    let size = finite(least.value).max(finite(greatest.value));
    let place = |x: f64| {
        if x.is_infinite() {
            (if x > 0.0 { "∞" } else { "-∞" }).to_owned()
        } else {
            number(if x.abs() <= 1e-12 * size { 0.0 } else { x }, 5)
        }
    };
    let (a, b) = (place(least.value), place(greatest.value));
    if a == b {
        format!("{a}{about}")
    } else {
        format!("{a} … {b}{about}")
    }
}

fn measured_json(m: Measured) -> Value {
    json!({ "value": m.value, "certainty": certainty_json(m.certainty) })
}

fn extreme_json(e: Extreme) -> Value {
    // JSON has no infinity: an unbounded extreme has no value.
    json!({
        "value": Some(e.value).filter(|x| x.is_finite()),
        "unbounded": e.value.is_infinite(),
        "uv": e.uv,
        "certainty": certainty_json(e.certainty),
    })
}

fn box_json(hull: Box3, certainty: Certainty) -> Value {
    json!({
        "min": hull.to_array().map(|i| i.lo),
        "max": hull.to_array().map(|i| i.hi),
        "certainty": certainty_json(certainty),
    })
}
