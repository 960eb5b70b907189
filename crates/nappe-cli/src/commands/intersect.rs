//! `nappe intersect`.

use crate::failure::{Failure, Problem};
use crate::model::{self, ModelArgs};
use crate::output;
use crate::screen::Screen;
use crate::table::{Cell, Column, OutputFormat};
use nappe::Limit;
use nappe::curve::CurveRef;
use nappe::mesh::{Certainty, flatten};
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
/// exact curve at most; nothing where that is not proven. Notes tell the branches, and each place where it is not decided what
/// the surfaces have in common, with its size: where they touch, coincide in a region, or cross at a vanishing angle.
///
/// For a curve and a surface each row is a proven point: t,u,v,x,y,z.
///
/// Where there are places that are not decided it fails (exit code 1) after everything that was found is put out: more may
/// be there. Outside of them nothing is missing.
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
    /// Not a number where there is nothing.
    numbers: Vec<f64>,
    /// Whether nothing else can be anywhere.
    decided: bool,
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
                let x = rows.numbers[i * n + j];
                if x.is_nan() {
                    Cell::Missing
                } else {
                    Cell::Number(x)
                }
            })?;
            Ok(sink.finish()?)
        };
        match &self.output {
            None => fill(&mut io::BufWriter::with_capacity(
                output::BUFFER,
                io::stdout(),
            )),
            Some(path) => output::write_with(path, |out| fill(out)),
        }?;
        if rows.decided {
            Ok(())
        } else {
            Err(Failure::Verdict)
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
        let most = self.tolerance.unwrap_or(found.tol + chord);
        let mut numbers = Vec::new();
        for (k, branch) in found.branches.iter().enumerate() {
            match add(&mut numbers, k + 1, branch, chord)? {
                None => screen.note(format!(
                    "branch {}: how far its line is from the exact curve is not proven",
                    k + 1
                )),
                // Rounding of the sum is no news.
                Some(error) if error > most * (1.0 + 1e-9) => screen.note(format!(
                    "branch {}: its line is within {} of the exact curve, more than the tolerance {}",
                    k + 1,
                    significant(error, 3),
                    significant(most, 3)
                )),
                Some(_) => {}
            }
        }
        Ok(Rows {
            columns: &["branch", "x", "y", "z", "u", "v", "s", "t", "error"],
            numbers,
            decided: found.undecided.is_empty(),
        })
    }
}

/// The greatest distance of a line from the exact curve, of which both are within some distances of a curve between them;
/// `None` if one of these is only estimated.
fn bound(distances: [Certainty; 2]) -> Option<f64> {
    let proven = |c: &Certainty| !matches!(c, Certainty::Estimated(_));
    let sum = distances[0].error() + distances[1].error();
    (distances.iter().all(proven) && sum.is_finite()).then_some(sum)
}

/// Adds the points of a branch. Returns the bound of its error.
fn add(
    numbers: &mut Vec<f64>,
    number: usize,
    branch: &SurfaceCurve,
    chord: f64,
) -> Result<Option<f64>, Failure> {
    let flat = flatten(branch.curve().as_ref(), chord, MOST_POINTS)
        .map_err(|e| Problem::new(e.to_string()).help("say a greater --tolerance"))?;
    let paths = [0, 1].map(|n| branch.in_parameters(n));
    let error = bound([branch.certainty, flat.deviation]);
    for (t, p) in flat.parameters.iter().zip(&flat.points) {
        let [uv, st] = paths
            .each_ref()
            .map(|path| path.parameters(*t, Limit::Above));
        numbers.push(number as f64);
        numbers.extend(p.to_array());
        numbers.extend(uv.into_iter().chain(st));
        numbers.push(error.unwrap_or(f64::NAN));
    }
    Ok(error)
}

/// Tells the branches, and what is not decided.
fn tell(found: &SurfaceSurface, screen: &Screen) {
    let closed = found.branches.iter().filter(|b| b.is_closed()).count();
    let worst = found.branches.iter().map(|b| b.certainty.error());
    let others = match found.undecided.len() {
        0 => "there are no others".to_owned(),
        1 => "1 place is not decided: there may be others there".to_owned(),
        n => format!("{n} places are not decided: there may be others there"),
    };
    screen.note(format!(
        "{} branches, {closed} of them closed, each within {} of the exact curve; {others}",
        found.branches.len(),
        significant(worst.fold(0.0, f64::max), 3),
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
        decided: undecided.is_empty(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_estimated_is_no_bound() {
        use Certainty::{Bounded, Estimated, Exact};
        assert_eq!(bound([Bounded(0.25), Bounded(0.5)]), Some(0.75));
        assert_eq!(bound([Exact, Bounded(0.5)]), Some(0.5));
        assert_eq!(bound([Bounded(0.25), Estimated(0.0)]), None);
        assert_eq!(bound([Estimated(0.25), Exact]), None);
        assert_eq!(bound([Bounded(f64::INFINITY), Exact]), None);
    }
}
