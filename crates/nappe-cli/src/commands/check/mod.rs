//! `nappe check`.

use crate::commands::report::ReportFormat;
use crate::failure::Failure;
use crate::model::ModelArgs;
use crate::scene;
use crate::screen::Screen;
use crate::slits::{JOINED, Partial, Stretch};
use declared::Declared;
use nappe::measure::{Crease, JumpOptions, Regularity, continuity, creases, regularity, tear};
use nappe::mesh::joints;
use nappe::surface::{Side, SurfaceRef};
use nappe_model::{Model, NamedSurface};
use passing::Passing;
use rayon::prelude::*;
use reached::Shared;
use std::io::{self, Write};
use std::sync::atomic::{AtomicUsize, Ordering};
use verdict::Verdict;

mod declared;
mod draw;
mod json;
mod passing;
mod reached;
mod text;
mod verdict;
mod words;

/// Prove the declared checks, and examine every shared side and every surface
///
/// The checks declared in the model claim how smoothly sides meet. Besides, all sides that surfaces share are found and their
/// gap, angle and jump of curvature bounded, and every surface is searched for folds and degenerate points. A bound is
/// proven over the whole side unless it says `estimated`.
///
/// Every surface with itself, and every two surfaces, are proven to have no points in common but those within the
/// tolerance of the mesh of a shared side or corner, or the place is told where they cross, touch, or where that is not
/// decided. Of surfaces that touch it is told whether that they cross elsewhere is excluded.
///
/// It fails (exit code 1) if a declared check is missed, or can be neither proven nor estimated to hold, if sides meet
/// within the tolerance of the mesh but not closely enough to be joined, or if a surface is torn, folds over or passes
/// through itself. A line inside that is one point, where a surface only touches itself, is told. Two surfaces that pass
/// through each other are told (•) but are no failure: a handle may well be stuck through a wall. Nor are sides that meet in
/// part only, of which the same bounds are told along the stretch in common. A check of such sides is a claim about that
/// stretch, which is told, if one of the two lies on the other from end to end, or the check says `in_part = true`; else it
/// fails. Of sides that do not meet at all it is told how far they are apart. The last line tells how many claims are only
/// estimated and how many pairs are not decided.
///
/// With --draw, a picture shows all sides in the colour of the smoothness that they reach, the claims that fail or are not
/// proven, and the places where surfaces fold over, cross or are not decided. A torn surface cannot be drawn.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
Examples:
  nappe check duct.nappe.toml
  nappe check duct.nappe.toml --set lift=0 --format json
  nappe check duct.nappe.toml --draw joints.png --view 30,40")]
pub(crate) struct Args {
    #[command(flatten)]
    model: ModelArgs,

    /// A report for people, or JSON for programs
    #[arg(long, default_value = "text")]
    format: ReportFormat,

    #[command(flatten)]
    drawing: draw::Drawing,
}

impl Args {
    pub(crate) fn run(&self, screen: &Screen) -> Result<(), Failure> {
        self.drawing.check()?;
        let model = self.model.open(screen)?;
        let found = Findings::of(&model, screen);
        let text = match self.format {
            ReportFormat::Text => found.text(),
            ReportFormat::Json => format!("{:#}\n", found.json()),
        };
        io::stdout().lock().write_all(text.as_bytes())?;
        for note in found.in_part.notes() {
            screen.note(note);
        }
        self.drawing.draw(&model, &found, screen)?;
        if found.pass() {
            Ok(())
        } else {
            Err(Failure::Verdict)
        }
    }
}

struct Findings<'a> {
    unit: &'static str,
    /// That of the mesh.
    tolerance: f64,
    declared: Vec<Declared<'a>>,
    shared: Vec<Shared>,
    open: Vec<(usize, Side)>,
    in_part: Partial<'a>,
    stretches: Vec<Stretch>,
    surfaces: Vec<(&'a NamedSurface, Regularity, Vec<Crease>)>,
    passing: Passing,
}

impl<'a> Findings<'a> {
    fn of(model: &'a Model, screen: &Screen) -> Findings<'a> {
        let tolerance = scene::tolerance(model, None);
        let named: Vec<&NamedSurface> = model.output().collect();
        let surfaces: Vec<SurfaceRef> = named.iter().map(|s| s.surface.clone()).collect();
        let met = joints(&surfaces, tolerance);
        let progress = screen.progress("Checking");
        let work = model.checks.len() + met.joints.len() + named.len();
        let done = AtomicUsize::new(0);
        let step = || {
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress.tell(done as f64 / work as f64);
        };
        let declared = model.checks.par_iter().map(|c| {
            let d = Declared::of(c, tolerance);
            step();
            d
        });
        let declared = declared.collect();
        let name = |(i, side): (usize, Side)| format!("{}.{side}", named[i].name);
        let shared = met.joints.par_iter().map(|j| {
            let of = |(i, side): (usize, Side)| (surfaces[i].as_ref(), side);
            let joint = continuity(
                of(j.first),
                of(j.second),
                tolerance,
                &JumpOptions::default(),
            );
            step();
            let gap = joint.as_ref().map(|c| c.gap);
            Shared {
                sides: [name(j.first), name(j.second)],
                first: j.first,
                verdict: gap.map_or(Verdict::Fails, |g| Verdict::of(&g, JOINED * tolerance)),
                joint,
                gap: j.gap,
            }
        });
        let shared = shared.collect();
        let open = met.open.iter().enumerate();
        let open = open.flat_map(|(i, sides)| sides.iter().map(move |side| (i, *side)));
        let open = open.collect();
        let regular = named.par_iter().map(|s| {
            let r = regularity(s.surface.as_ref(), &JumpOptions::default());
            step();
            (*s, r, creases(s.surface.as_ref()))
        });
        let regular = regular.collect();
        let unit = model.units.symbol();
        let passing = Passing::of(&named, tolerance, unit);
        let in_part = Partial::of(model, &met, tolerance);
        let stretches = in_part.measured();
        progress.finish();
        Findings {
            unit,
            declared,
            shared,
            open,
            in_part,
            stretches,
            tolerance,
            surfaces: regular,
            passing,
        }
    }

    fn pass(&self) -> bool {
        self.failures() == 0
    }

    fn failures(&self) -> usize {
        let declared = self.declared.iter().filter(|d| !d.verdict.passes()).count();
        let shared = self.shared.iter().filter(|s| !s.verdict.passes()).count();
        let broken = |s: &&(&NamedSurface, Regularity, Vec<Crease>)| {
            !s.1.folds.is_empty() || tear(s.0.surface.as_ref()).is_some()
        };
        let broken = self.surfaces.iter().filter(broken).count();
        declared + shared + broken + self.passing.failures()
    }
}
