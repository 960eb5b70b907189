//! `nappe info`.

use super::figures;
use super::info_file;
use super::rates::Rates;
use super::report::{ReportFormat, certainty_json, measured_json};
use super::touching::{self, Touching};
use crate::failure::{Failure, Problem};
use crate::model::ModelArgs;
use crate::scene;
use crate::screen::Screen;
use crate::slits::JOINED;
use crate::text::{Table, bound, number, torn};
use nappe::Box3;
use nappe::exact::NurbsSurface;
use nappe::measure::{
    AreaCentroid, CurvatureExtremes, Extent, Extreme, IntegralOptions, Measured, RollingBall,
    SearchOptions, Shell, Solid, TotalCurvature, VolumeError, area_centroid, curvature_extremes,
    curvature_variation, extent, joint_centroid, rolling_balls, solids, tear, total_curvature,
};
use nappe::mesh::{Certainty, Joints, joints};
use nappe::surface::{Dir, Side, SurfaceRef};
use nappe_exchange::Format;
use nappe_model::{Model, NamedSurface};
use rayon::prelude::*;
use serde_json::{Value, json};
use std::io::{self, Write};
use std::sync::atomic::{AtomicUsize, Ordering};

/// Tell what is in a model: surfaces, degrees, exactness, box, area, enclosed volume, centroids, inertia, curvature; or in
/// a file of another system
///
/// Every number is given with its error: proven, or estimated where that is said. Curvature is signed by the normal
/// r_u × r_v: where the surface bends towards it the mean curvature is positive.
///
/// The room for a tool is the radius of the largest ball that touches a surface from the side of its normal, or from
/// behind, without being stopped by its curvature or a crease in it; where it meets others is not looked at. Inertia is that of a solid of density 1 about its centroid.
///
/// Fillets are told with their certificate: the ball touches both supports along its whole path, which is proven when the
/// surface is made, and how far the numbers are from that.
///
/// Derivatives by a parameter are exact formulas and not differences, but for the integrals of `--bending`. Those of
/// curvature and of the room for a tool are estimated: other places where an extreme is reached are looked for by samples.
/// Where an extreme, or a face of the box, is reached in several places its derivatives to either side are in a range. A surface
/// whose motion is not known is named, and what depends on it is not told.
///
/// Sides are one, and surfaces closed, if the mesh would join them: within a twentieth of its tolerance. Surfaces that
/// close up make a shell; its volume is what it encloses unless surfaces pass through themselves or each other, which
/// `nappe check` tells. The volumes of several shells are added only if their boxes prove them to lie beside each other.
///
/// Of .step .stp .igs .iges files it tells unit, solids, sheets, curves and points, faces by what their surfaces are, box,
/// area, volume, what the reader left out and what is wrong; of .stl .obj .ply .glb .gltf .3mf files the triangles, and
/// whether they close.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe info vase.nappe.toml
  nappe info vase.nappe.toml --bending
  nappe info torus.nappe.toml --sensitivity major --sensitivity minor
  nappe info vase.nappe.toml --set height=300 --format json
  nappe info part.step")]
pub(crate) struct Args {
    #[command(flatten)]
    model: ModelArgs,

    /// Also how surfaces bend, which takes longer: total curvature ∫ |K| dA, 0 for developable surfaces, and the
    /// variation of curvature ∫ |∇II|² dA, the smaller the fairer
    #[arg(long)]
    bending: bool,

    /// Also how box, area, volume, centroids and moments change with a parameter: their derivatives; may be given
    /// several times
    #[arg(long, value_name = "PARAMETER")]
    sensitivity: Vec<String>,

    /// A report for people, or JSON for programs
    #[arg(long, default_value = "text")]
    format: ReportFormat,
}

/// A report is read by people who wait for it: a few digits, each proven, rather than all.
pub(super) const INTEGRALS: IntegralOptions = IntegralOptions {
    relative: 1e-6,
    budget: 2000,
};
/// Integrals of curvature, which cost more for each box.
const BENDING: IntegralOptions = IntegralOptions {
    relative: 1e-3,
    budget: 1000,
};
/// A radius of curvature that is none for a model, in sizes of the surface.
const HUGE: f64 = 1e6;
const SEARCH: SearchOptions = SearchOptions {
    relative: 1e-3,
    budget: 300,
};

impl Args {
    pub(crate) fn run(&self, screen: &Screen) -> Result<(), Failure> {
        if nappe_exchange::read::can_read(self.model.path()) {
            return self.file(screen);
        }
        refuse_other_formats(&self.model)?;
        let model = self.model.open(screen)?;
        let velocities = self.model.velocities(&model, &self.sensitivity)?;
        let facts = Facts::of(&model, self.bending, screen);
        let rates: Vec<Rates> = velocities
            .iter()
            .map(|v| Rates::of(&model, v, &facts))
            .collect();
        let text = match self.format {
            ReportFormat::Text => {
                let mut text = facts.text(&model);
                for r in &rates {
                    text.push_str(&format!("\n{}", r.text(&model)));
                }
                text
            }
            ReportFormat::Json => {
                let mut all = facts.json(&model);
                if !rates.is_empty() {
                    all["sensitivities"] = rates.iter().map(|r| r.json(&model)).collect();
                }
                format!("{all:#}\n")
            }
        };
        Ok(io::stdout().lock().write_all(text.as_bytes())?)
    }
}

impl Args {
    /// The report on a file of another system.
    fn file(&self, screen: &Screen) -> Result<(), Failure> {
        if self.bending || !self.sensitivity.is_empty() || self.model.sets_parameters() {
            let path = self.model.path().display();
            return Err(Failure::usage(format!(
                "{path} is no model file: --set, --bending and --sensitivity are for models"
            )));
        }
        let text = info_file::report(self.model.path(), self.format, screen)?;
        Ok(io::stdout().lock().write_all(text.as_bytes())?)
    }
}

/// Files that are written only, such as pictures, are not models: to say so is kinder than to call them wrong TOML.
fn refuse_other_formats(model: &ModelArgs) -> Result<(), Problem> {
    let ending = model.path().extension().unwrap_or_default();
    let ending = ending.to_string_lossy().to_ascii_lowercase();
    if !Format::ALL.iter().any(|f| f.ending() == ending) {
        return Ok(());
    }
    Err(Problem::new(format!(
        "{}: .{ending} files cannot be read",
        model.path().display()
    ))
    .help(format!(
        "`nappe info` reads model files, *.nappe.toml, and {}",
        nappe_exchange::read::endings()
    )))
}

/// What is said of a whole model.
pub(super) struct Facts {
    surfaces: Vec<SurfaceFacts>,
    /// `None` if a surface is torn.
    pub(super) area: Option<AreaCentroid>,
    /// What the closed shells enclose.
    pub(super) shells: Vec<Solid>,
    /// The distance within which sides were joined.
    pub(super) joined: f64,
    /// Why the other surfaces enclose nothing.
    not_closed: Vec<String>,
    /// True if the boxes of all shells are proven to be apart.
    apart: bool,
    extent: Option<(Box3, Certainty)>,
}

/// What is said of one surface.
pub(super) struct SurfaceFacts {
    nurbs: Option<NurbsSurface>,
    /// The same set of points, perhaps with other parameters.
    shape: Option<NurbsSurface>,
    torn: Option<(Dir, f64)>,
    area: AreaCentroid,
    extent: Option<Extent>,
    pub(super) curvature: Option<CurvatureExtremes>,
    /// The room on the side of the normal and behind.
    pub(super) balls: Option<[RollingBall; 2]>,
    /// The ball, if the surface is a fillet.
    fillet: Option<Touching>,
    /// Total curvature and its variation, if asked for.
    pub(super) bending: Option<(TotalCurvature, Measured)>,
    closed: [bool; 2],
    collapsed: Vec<Side>,
}

impl Facts {
    fn of(model: &Model, bending: bool, screen: &Screen) -> Facts {
        let named: Vec<&NamedSurface> = model.output().collect();
        let surfaces: Vec<SurfaceRef> = named.iter().map(|s| s.surface.clone()).collect();
        let joined = JOINED * scene::tolerance(model, None);
        let met = joints(&surfaces, joined);
        let progress = screen.progress("Measuring");
        let done = AtomicUsize::new(0);
        let facts: Vec<SurfaceFacts> = named
            .par_iter()
            .enumerate()
            .map(|(i, s)| {
                let facts = SurfaceFacts::of(s, i, &met, bending);
                let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                progress.tell(done as f64 / surfaces.len() as f64);
                facts
            })
            .collect();
        let unit = model.units.symbol();
        let (mut closed, mut not_closed) = (Vec::new(), Vec::new());
        for body in solids(&surfaces, Some(joined), &INTEGRALS) {
            match body {
                Ok(shell) => closed.push(shell),
                Err(e) => not_closed.push(open(&e, &named, unit)),
            }
        }
        progress.finish();
        let torn = facts.iter().any(|f| f.torn.is_some());
        Facts {
            area: (!torn)
                .then(|| joint_centroid(&facts.iter().map(|f| f.area).collect::<Vec<_>>())),
            apart: are_apart(&closed, &facts),
            shells: closed,
            joined,
            not_closed,
            extent: whole(&facts),
            surfaces: facts,
        }
    }

    /// The area of each surface.
    /// For each surface the extremes of its curvature, the room beside it, and the integrals if they were asked for.
    pub(super) fn bends(&self) -> impl Iterator<Item = &SurfaceFacts> {
        self.surfaces.iter()
    }

    pub(super) fn areas(&self) -> impl Iterator<Item = &AreaCentroid> {
        self.surfaces.iter().map(|f| &f.area)
    }

    /// What all shells enclose, if that is known.
    fn volume(&self) -> Option<Measured> {
        let all = self.not_closed.is_empty() && !self.shells.is_empty();
        (all && self.apart).then(|| self.shells.iter().map(|s| s.shell.volume).sum())
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
            let area = match self.area {
                Some(a) => format!("{} {unit}²", measured(a.area)),
                None => "not told: a surface is torn".to_owned(),
            };
            head.row(["area", &area]);
            if let Some(centroid) = self.area.and_then(|a| a.centroid) {
                head.row(["centroid of the area", &figures::place(&centroid, unit)]);
            }
            self.volumes(&mut head, model);
            let named: Vec<&NamedSurface> = model.output().collect();
            for one in &self.shells {
                if self.shells.len() > 1 {
                    head.row(["shell", &members(&one.shell, &named)]);
                }
                figures::rows(&mut head, one, unit);
            }
        }
        let mut text = format!("{head}\n");
        if !self.surfaces.is_empty() {
            text.push_str(&format!("\n{}\n", self.table(model, unit)));
            text.push_str(&format!("\n{}\n", self.room(model, unit)));
            let balls = model.output().zip(self.surfaces.iter().map(|f| f.fillet));
            if let Some(fillets) = touching::table(balls, unit) {
                text.push_str(&format!("\n{fillets}\n"));
            }
            if let Some(bending) = self.bending(model, unit) {
                text.push_str(&format!("\n{bending}\n"));
            }
        }
        text
    }

    /// The rows on volumes.
    fn volumes(&self, head: &mut Table, model: &Model) {
        let unit = model.units.symbol();
        let shells = &self.shells;
        let more = match self.not_closed.len() {
            0 | 1 => String::new(),
            n => format!(", and {} more", n - 1),
        };
        if let (Some(why), true) = (self.not_closed.first(), shells.is_empty()) {
            return head.row(["volume", &format!("none: {why}{more}")]);
        }
        if let Some(volume) = self.volume() {
            let facing = match shells.as_slice() {
                [one] => format!("; {}", facing(&one.shell)),
                _ => format!(" in {} shells beside each other", shells.len()),
            };
            return head.row([
                "volume",
                &format!(
                    "{} {unit}³ enclosed, if nothing passes through itself (see `nappe check`){facing}",
                    measured(volume)
                ),
            ]);
        }
        let text = match self.not_closed.first() {
            Some(why) => {
                let n = shells.len();
                let plural = if n == 1 { "" } else { "s" };
                format!("of {n} closed shell{plural}; the rest encloses nothing: {why}{more}")
            }
            None => format!(
                "of {} shells, not added: they may cross or lie inside each other (see `nappe check`)",
                shells.len()
            ),
        };
        head.row(["volume", &text]);
        let named: Vec<&NamedSurface> = model.output().collect();
        for s in shells.iter().map(|s| &s.shell) {
            let volume = format!(
                "{} {unit}³: {}; {}",
                measured(s.volume),
                members(s, &named),
                facing(s)
            );
            head.row(["", &volume]);
        }
    }

    fn shell_json(&self, solid: &Solid, model: &Model) -> Value {
        let shell = &solid.shell;
        let names: Vec<&str> = model.output().map(|s| s.name.as_str()).collect();
        let named = |inwards: bool| -> Vec<&str> {
            let those = shell.surfaces.iter().filter(|f| f.1 == inwards);
            those.map(|f| names[f.0]).collect()
        };
        // Seen from outside: on the side of the normal where that points outwards.
        let balls = shell
            .surfaces
            .iter()
            .map(|&(k, inwards)| Some(self.surfaces[k].balls?[usize::from(inwards)]));
        let concave = balls
            .collect::<Option<Vec<_>>>()
            .and_then(figures::smallest);
        json!({
            "volume": measured_json(shell.volume),
            "normals_outwards": named(false),
            "normals_inwards": named(true),
            "centroid": solid.centroid.map(figures::centroid_json),
            "inertia": solid.inertia.map(figures::inertia_json),
            "smallest_concave_radius_within_surfaces": concave.map(figures::ball_json),
        })
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
            let degrees =
                |n: &NurbsSurface| format!("{} × {}", n.basis_u().degree(), n.basis_v().degree());
            let nurbs = match (&f.nurbs, &f.shape) {
                (Some(n), _) => degrees(n),
                (None, Some(n)) => format!("{}, other parameters", degrees(n)),
                (None, None) => "no exact form".to_owned(),
            };
            let size = f.extent.as_ref().map_or(String::new(), |e| {
                e.hull
                    .to_array()
                    .map(|i| number(i.hi - i.lo, 5))
                    .join(" × ")
            });
            // What a curvature is to be compared with: that of a sphere as large as the surface.
            let round = f.extent.as_ref().map_or(0.0, |e| 2.0 / e.hull.diagonal());
            let (gaussian, mean) = f.curvature.as_ref().map_or_else(
                || ("no normal anywhere".to_owned(), String::new()),
                |c| (range(&c.gaussian, round * round), range(&c.mean, round)),
            );
            table.row([
                s.name.clone(),
                s.kind.to_owned(),
                nurbs,
                size,
                f.torn.map_or_else(|| measured(f.area.area), torn),
                gaussian,
                mean,
                f.closure(),
            ]);
        }
        table
    }

    /// The balls that fit: a second table, as one would be too wide.
    fn room(&self, model: &Model, unit: &str) -> Table {
        let room = format!("room for a tool in {unit}");
        let mut table = Table::headed(["surface", &room, "behind"]);
        for (s, f) in model.output().zip(&self.surfaces) {
            let size = f.extent.as_ref().map_or(0.0, |e| e.hull.diagonal());
            let [front, back] = f.balls.map_or_else(
                || [String::new(), String::new()],
                |balls| balls.map(|b| figures::room(b, HUGE * size)),
            );
            table.row([s.name.clone(), front, back]);
        }
        table
    }

    /// How the surfaces bend; `None` if that was not asked for.
    fn bending(&self, model: &Model, unit: &str) -> Option<Table> {
        let variation = format!("variation of curvature in 1/{unit}²");
        let headings = [
            "surface",
            "developable",
            "total curvature in sr",
            &variation,
        ];
        let mut table = Table::headed(headings);
        for (s, f) in model.output().zip(&self.surfaces) {
            let (total, variation) = f.bending?;
            table.row([
                s.name.clone(),
                figures::developable(total.developable).to_owned(),
                figures::integral(total.value),
                figures::integral(variation),
            ]);
        }
        Some(table)
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
                    "exact_nurbs": nurbs.is_some(),
                    "exact_shape": c.curve.to_rational().is_some(), "degree": nurbs.map(|n| n.degree()),
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
            "area": self.area.map(|a| measured_json(a.area)),
            "centroid": self.area.and_then(|a| a.centroid).map(figures::centroid_json),
            "volume": self.volume().map(measured_json),
            "shells": self.shells.iter().map(|s| self.shell_json(s, model)).collect::<Vec<_>>(),
            "not_closed": self.not_closed,
        })
    }
}

impl SurfaceFacts {
    fn of(named: &NamedSurface, index: usize, met: &Joints, bending: bool) -> SurfaceFacts {
        let surface = &named.surface;
        let own = |a: Side, b: Side| {
            met.joints.iter().any(|j| {
                let sides = [j.first, j.second];
                sides.contains(&(index, a)) && sides.contains(&(index, b))
            })
        };
        let curvature = curvature_extremes(surface.as_ref(), &SEARCH);
        SurfaceFacts {
            nurbs: surface.to_nurbs(),
            shape: surface.to_rational(),
            torn: tear(surface.as_ref()),
            area: area_centroid(surface.as_ref(), &INTEGRALS),
            extent: extent(surface.as_ref(), &SEARCH),
            balls: curvature
                .as_ref()
                .map(|c| rolling_balls(surface.as_ref(), c)),
            curvature,
            fillet: named.fillet.as_deref().map(Touching::of),
            bending: bending.then(|| {
                let total = total_curvature(surface.as_ref(), &BENDING);
                (total, curvature_variation(surface.as_ref(), &BENDING))
            }),
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
            "exact_shape": self.shape.is_some(),
            "degree": self.nurbs.as_ref().map(|n| [n.basis_u().degree(), n.basis_v().degree()]),
            "rational": self.nurbs.as_ref().map(NurbsSurface::is_rational),
            "box": self.extent.as_ref().map(|e| box_json(e.hull, e.certainty)),
            "torn": self.torn.map(|(dir, at)| json!({ "dir": dir.to_string(), "at": at })),
            "area": self.torn.is_none().then(|| measured_json(self.area.area)),
            "centroid": self.area.centroid.filter(|_| self.torn.is_none()).map(figures::centroid_json),
            "gaussian_curvature": self.curvature.as_ref().map(|c| c.gaussian.map(extreme_json)),
            "mean_curvature": self.curvature.as_ref().map(|c| c.mean.map(extreme_json)),
            "smallest_radius": self.curvature.as_ref().map(|c| c.smallest_radius).filter(|r| r.is_finite()),
            "fillet": self.fillet.map(Touching::json),
            "rolling_balls": self.balls.map(figures::balls_json),
            "total_curvature": self.bending.map(|b| measured_json(b.0.value)),
            "developable": self.bending.map(|b| figures::developable(b.0.developable)),
            "curvature_variation": self.bending.map(|b| measured_json(b.1)),
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
fn open(e: &VolumeError, named: &[&NamedSurface], unit: &str) -> String {
    let name = |i: usize| format!("`{}`", named[i].name);
    match *e {
        VolumeError::Open {
            surface,
            side,
            weld,
        } => format!(
            "{} is open along its {side} side: nothing within {} {unit} meets it",
            name(surface),
            number(weld, 4)
        ),
        VolumeError::Torn { surface, dir, at } => {
            format!("{} is {}", name(surface), torn((dir, at)))
        }
        VolumeError::OneSided { surface } => {
            format!("{} and what it meets have only one side", name(surface))
        }
        VolumeError::Orientation { first, second } => format!(
            "{} (its {} side) and {} (its {} side) have normals on different sides",
            name(first.0),
            first.1,
            name(second.0),
            second.1
        ),
        VolumeError::Branched { surface, side } => format!(
            "more than two sides meet along the {side} side of {}",
            name(surface)
        ),
    }
}

/// The names of a shell's surfaces; of many, the first and their number.
pub(super) fn members(shell: &Shell, named: &[&NamedSurface]) -> String {
    const MOST: usize = 4;
    let names = shell.surfaces.iter().take(MOST);
    let names: Vec<&str> = names.map(|f| named[f.0].name.as_str()).collect();
    let more = shell.surfaces.len().saturating_sub(MOST);
    if more > 0 {
        format!("{} and {more} more", names.join(", "))
    } else {
        names.join(", ")
    }
}

/// Which way the normals of a shell point.
fn facing(shell: &Shell) -> &'static str {
    let inwards = shell.surfaces.iter().filter(|f| f.1).count();
    if inwards == 0 {
        "the normals point outwards"
    } else if inwards == shell.surfaces.len() {
        "the normals point inwards"
    } else {
        "the normals of some surfaces point inwards, of others outwards"
    }
}

/// True if the boxes around the shells, as far as they may be too small, have nothing in common.
fn are_apart(shells: &[Solid], facts: &[SurfaceFacts]) -> bool {
    let around = |k: usize| {
        let e = facts[k].extent.as_ref()?;
        let Certainty::Bounded(error) = e.certainty.and(Certainty::Bounded(0.0)) else {
            return None;
        };
        Some(Box3::from(e.hull.to_array().map(|i| i.inflate(error))))
    };
    let boxes: Option<Vec<Box3>> = shells
        .iter()
        .map(|s| {
            let all: Option<Vec<Box3>> = s.shell.surfaces.iter().map(|f| around(f.0)).collect();
            all?.into_iter().reduce(Box3::hull)
        })
        .collect();
    match boxes {
        Some(boxes) => (1..boxes.len()).all(|i| !boxes[..i].iter().any(|b| b.touches(boxes[i]))),
        None => shells.len() < 2,
    }
}

fn whole(facts: &[SurfaceFacts]) -> Option<(Box3, Certainty)> {
    facts
        .iter()
        .filter_map(|f| f.extent.as_ref())
        .map(|e| (e.hull, e.certainty))
        .reduce(|a, b| (a.0.hull(b.0), a.1.and(b.1)))
}

/// The digits that are known, and the error.
pub(super) fn measured(m: Measured) -> String {
    format!("{}{}", number(m.value, 10), error(m.certainty))
}

pub(super) fn error(c: Certainty) -> String {
    match c {
        Certainty::Exact => String::new(),
        Certainty::Bounded(e) => format!(" ± {}", bound(e, 1)),
        Certainty::Estimated(e) => format!(" ± {} (estimated)", bound(e, 1)),
    }
}

/// The least and greatest value: a bound on each is in the JSON.
fn range([least, greatest]: &[Extreme; 2], round: f64) -> String {
    // A bound larger than the value says no more than none.
    let largest = least.value.abs().max(greatest.value.abs()).max(round);
    let unknown = |e: &Extreme| {
        let error = e.certainty.error();
        !error.is_finite() || (largest.is_finite() && error > largest)
    };
    let about = match (unknown(least), unknown(greatest)) {
        (true, true) => " (sampled; not closely bounded)",
        (true, false) => " (least sampled; not closely bounded)",
        (false, true) => " (greatest sampled; not closely bounded)",
        (false, false) => "",
    };
    // Rounding leaves a curvature of 1e-17 where 0 is meant.
    let finite = |x: f64| if x.is_finite() { x.abs() } else { 0.0 };
    let size = finite(least.value).max(finite(greatest.value)).max(round);
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

fn extreme_json(e: Extreme) -> Value {
    // JSON has no infinity: an unbounded extreme has no value.
    json!({
        "value": Some(e.value).filter(|x| x.is_finite()),
        "unbounded": e.value.is_infinite(),
        "uv": e.uv,
        "certainty": certainty_json(e.certainty),
    })
}

pub(super) fn box_json(hull: Box3, certainty: Certainty) -> Value {
    json!({
        "min": hull.to_array().map(|i| i.lo),
        "max": hull.to_array().map(|i| i.hi),
        "certainty": certainty_json(certainty),
    })
}
