//! `nappe intersect`.

use crate::failure::{Failure, Problem};
use crate::model::{self, ModelArgs};
use crate::output;
use crate::screen::Screen;
use crate::table::{Cell, Column, OutputFormat};
use nappe::Limit;
use nappe::curve::CurveRef;
use nappe::mesh::flatten;
use nappe::query::{
    CurveSurface, IntersectOptions, SurfaceCurve, SurfaceSurface, intersect, intersect_surfaces,
};
use nappe::significant;
use nappe::surface::SurfaceRef;
use std::io;
use std::path::PathBuf;

/// The most points of a branch.
const MOST_POINTS: usize = 200_000;
/// Places told in notes.
const TOLD: usize = 8;
/// The most boxes that are looked at for a curve and a surface.
const BOXES: usize = 100_000;

/// Find the curves in which two surfaces meet, or the points of a curve and a surface
///
/// All branches are found, closed ones included; none is lost, however small. Their points are put out: branch,x,y,z, the
/// parameters u,v on the first surface and s,t on the second one, and error: how far the line through the points is from the
/// exact curve at most. Notes tell the branches, and each place where it is not decided what the surfaces have in
/// common, with its size: where they touch, coincide in a region, or cross at a vanishing angle.
///
/// For a curve and a surface each row is a proven point: t,u,v,x,y,z.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe intersect pipes.nappe.toml --surfaces main.side branch.side > seam.csv
  nappe intersect pipes.nappe.toml --surfaces main branch --tolerance 0.01 -o seam.csv
  nappe intersect hull.nappe.toml --curve waterline --surface hull --format jsonl")]
pub(crate) struct Args {
    #[command(flatten)]
    model: ModelArgs,

    /// The two surfaces
    #[arg(
        long,
        value_name = "NAME",
        num_args = 2,
        required_unless_present = "curve"
    )]
    surfaces: Vec<String>,

    /// The curve
    #[arg(
        long,
        value_name = "NAME",
        conflicts_with = "surfaces",
        requires = "surface"
    )]
    curve: Option<String>,

    /// The surface that the curve meets
    #[arg(long, value_name = "NAME", requires = "curve")]
    surface: Option<String>,

    /// The greatest distance of the lines from the exact curves; default: about a ten-thousandth of the smaller surface
    #[arg(long, value_name = "LENGTH", value_parser = super::length)]
    tolerance: Option<f64>,

    /// The format of the output; default: by the ending of -o, else csv
    #[arg(long)]
    format: Option<OutputFormat>,

    /// Write to this file, .csv, .jsonl or .parquet, instead of standard output
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

/// A table of numbers.
struct Rows {
    columns: &'static [&'static str],
    numbers: Vec<f64>,
}

impl Args {
    pub(crate) fn run(&self, screen: &Screen) -> Result<(), Failure> {
        let format = OutputFormat::choose(self.format, self.output.as_deref())?;
        if let Some(path) = &self.output {
            output::check(path)?;
        }
        let model = self.model.open(screen)?;
        let rows = match (&self.curve, &self.surface, &self.surfaces[..]) {
            (Some(curve), Some(surface), _) => {
                let (curve, surface) = (
                    model::curve(&model, curve)?,
                    model::surface(&model, surface)?,
                );
                points(&curve, &surface, screen)
            }
            (_, _, [a, b]) => {
                let (a, b) = (model::surface(&model, a)?, model::surface(&model, b)?);
                self.curves(&a, &b, screen)?
            }
            _ => {
                return Err(Failure::usage(
                    "two surfaces, or a curve and a surface, are needed",
                ));
            }
        };
        let fill = |out: &mut (dyn io::Write + Send)| -> Result<(), Failure> {
            let n = rows.columns.len();
            let columns: Vec<Column> = rows.columns.iter().map(|c| Column::numbers(*c)).collect();
            let mut sink = format.sink(&columns, out)?;
            sink.rows(rows.numbers.len() / n, &|i, j| {
                Cell::Number(rows.numbers[i * n + j])
            })?;
            Ok(sink.finish()?)
        };
        match &self.output {
            None => fill(&mut io::BufWriter::with_capacity(
                output::BUFFER,
                io::stdout(),
            )),
            Some(path) => output::write_with(path, |out| fill(out)),
        }
    }

    fn curves(&self, a: &SurfaceRef, b: &SurfaceRef, screen: &Screen) -> Result<Rows, Failure> {
        // Half of the tolerance for the curves, half for the lines.
        let options = IntersectOptions {
            tol: self.tolerance.map(|t| 0.5 * t),
            ..IntersectOptions::default()
        };
        let found = intersect_surfaces(a, b, &options)
            .map_err(|e| Problem::new(e.to_string()).help("say another --tolerance"))?;
        let chord = self.tolerance.map_or(100.0 * found.tol, |t| 0.5 * t);
        tell(&found, screen);
        let mut numbers = Vec::new();
        for (k, branch) in found.branches.iter().enumerate() {
            add(&mut numbers, k + 1, branch, chord)?;
        }
        Ok(Rows {
            columns: &["branch", "x", "y", "z", "u", "v", "s", "t", "error"],
            numbers,
        })
    }
}

/// The points of a branch.
fn add(
    numbers: &mut Vec<f64>,
    number: usize,
    branch: &SurfaceCurve,
    chord: f64,
) -> Result<(), Failure> {
    let flat = flatten(branch.curve().as_ref(), chord, MOST_POINTS)
        .map_err(|e| Problem::new(e.to_string()).help("say a greater --tolerance"))?;
    let paths = [0, 1].map(|n| branch.in_parameters(n));
    let error = branch.certainty.error() + flat.deviation.error();
    for (t, p) in flat.parameters.iter().zip(&flat.points) {
        let [uv, st] = paths
            .each_ref()
            .map(|path| path.parameters(*t, Limit::Above));
        numbers.push(number as f64);
        numbers.extend(p.to_array());
        numbers.extend(uv.into_iter().chain(st));
        numbers.push(error);
    }
    Ok(())
}

/// Tells the branches, and what is not decided.
fn tell(found: &SurfaceSurface, screen: &Screen) {
    let closed = found.branches.iter().filter(|b| b.is_closed()).count();
    let worst = found.branches.iter().map(|b| b.certainty.error());
    screen.note(format!(
        "{} branches, {closed} of them closed, each within {} of the exact curve{}",
        found.branches.len(),
        significant(worst.fold(0.0, f64::max), 3),
        if found.undecided.is_empty() {
            "; there are no others"
        } else {
            ""
        }
    ));
    for x in found.touches.iter().take(TOLD) {
        screen.note(format!("a side is touched at u = {}, v = {}", x[0], x[1]));
    }
    for place in found.undecided.iter().take(TOLD) {
        screen.note(format!("not decided: {place}"));
    }
    if found.undecided.len() > TOLD {
        let more = found.undecided.len() - TOLD;
        screen.note(format!("{more} more places are not decided"));
    }
}

/// The points of a curve and a surface.
fn points(curve: &CurveRef, surface: &SurfaceRef, screen: &Screen) -> Rows {
    let CurveSurface {
        points, undecided, ..
    } = intersect(curve.as_ref(), surface.as_ref(), BOXES);
    for [t, u, v] in undecided.iter().take(TOLD) {
        screen.note(format!(
            "not decided: t in [{}, {}], u in [{}, {}], v in [{}, {}]: the curve may touch the surface or lie in it",
            t.lo, t.hi, u.lo, u.hi, v.lo, v.hi
        ));
    }
    if undecided.len() > TOLD {
        screen.note(format!(
            "{} more places are not decided",
            undecided.len() - TOLD
        ));
    }
    let row = |p: &nappe::query::CurveSurfacePoint| {
        let [x, y, z] = p.point.to_array();
        [p.t, p.uv[0], p.uv[1], x, y, z]
    };
    Rows {
        columns: &["t", "u", "v", "x", "y", "z"],
        numbers: points.iter().flat_map(row).collect(),
    }
}
