//! `nappe check`.

use crate::commands::report::{ReportFormat, certainty_json};
use crate::failure::Failure;
use crate::model::ModelArgs;
use crate::scene;
use crate::screen::Screen;
use crate::slits::{JOINED, Partial, Stretch};
use crate::text::{Table, bound, number, torn};
use nappe::measure::{
    Continuity, Crease, Jump, JumpOptions, Regularity, Smoothness, continuity, creases, regularity,
    tear,
};
use nappe::mesh::{Certainty, joints};
use nappe::surface::{Side, SurfaceRef};
use nappe_model::{Check, CheckTolerance, Model, NamedSurface};
use passing::Passing;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::f64::consts::PI;
use std::io::{self, Write};
use std::sync::atomic::{AtomicUsize, Ordering};

mod draw;
mod passing;

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
/// part only, of which the same bounds are told along the stretch in common. The last line tells how many claims are only
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

/// Tangent planes that differ by less (0.1°) count as smooth where nothing is declared.
const SMOOTH_ANGLE: f64 = PI / 1800.0;
/// Curvatures that differ by less, relatively, count as the same where nothing is declared.
const SAME_CURVATURE: f64 = 0.01;

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

/// What is known of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Verdict {
    /// Proven.
    Holds,
    /// Sampling found nothing against it, and nothing can be proven.
    Seems,
    /// Neither proven nor refuted.
    Open,
    /// Refuted.
    Fails,
}

impl Verdict {
    fn of(jump: &Jump, tolerance: f64) -> Verdict {
        match (jump.within(tolerance), jump.greatest) {
            (Some(true), _) => Verdict::Holds,
            (Some(false), _) => Verdict::Fails,
            (None, Certainty::Estimated(e)) if e <= tolerance => Verdict::Seems,
            (None, _) => Verdict::Open,
        }
    }

    /// The less certain of two claims that must both hold.
    fn and(self, other: Verdict) -> Verdict {
        let rank = |v| {
            [
                Verdict::Holds,
                Verdict::Seems,
                Verdict::Open,
                Verdict::Fails,
            ]
            .iter()
            .position(|&w| w == v)
        };
        if rank(self) >= rank(other) {
            self
        } else {
            other
        }
    }

    fn passes(self) -> bool {
        matches!(self, Verdict::Holds | Verdict::Seems)
    }

    fn mark(self) -> &'static str {
        if self.passes() { "✓" } else { "✗" }
    }

    fn word(self) -> &'static str {
        match self {
            Verdict::Holds => "proven",
            Verdict::Seems => "estimated",
            Verdict::Open => "not proven",
            Verdict::Fails => "fails",
        }
    }
}

/// A declared check and what is known of it.
struct Declared<'a> {
    check: &'a Check,
    /// `None`: the sides do not meet.
    joint: Option<Continuity>,
    /// Without a joint: one lies along a part of the other.
    in_part: bool,
    verdict: Verdict,
}

/// A side that two surfaces, or one with itself, have in common.
struct Shared {
    sides: [String; 2],
    first: (usize, Side),
    joint: Option<Continuity>,
    /// The greatest distance found while looking for shared sides.
    gap: f64,
    verdict: Verdict,
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
            let d = declared(c, tolerance);
            step();
            d
        });
        let mut declared: Vec<Declared> = declared.collect();
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
        for d in declared.iter_mut().filter(|d| d.joint.is_none()) {
            let of = |side: (usize, Side)| (named[side.0].name.as_str(), side.1);
            let own = [0, 1]
                .map(|k| &d.check.between[k])
                .map(|s| (s.surface.as_str(), s.side));
            let is_own = |pair: [(usize, Side); 2]| {
                let [a, b] = pair.map(of);
                [a, b] == own || [b, a] == own
            };
            d.in_part = in_part.pairs().any(is_own);
        }
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

    fn text(&self) -> String {
        let mut parts = Vec::new();
        if !self.declared.is_empty() {
            parts.push(format!("Declared checks\n\n{}", self.declared_table()));
        }
        if !self.shared.is_empty() {
            parts.push(format!("Shared sides\n\n{}", self.shared_table()));
        }
        if !self.stretches.is_empty() {
            parts.push(format!(
                "Sides that meet in part\n\n{}",
                self.stretch_table()
            ));
        }
        if !self.open.is_empty() {
            parts.push(format!("Open sides: {}", self.open_sides().join(", ")));
        }
        if !self.surfaces.is_empty() {
            parts.push(format!("Surfaces\n\n{}", self.surface_table()));
            parts.push(self.passing.text());
        }
        parts.push(match self.failures() {
            0 => format!("✓ nothing fails{}", self.reservations()),
            1 => "✗ 1 failure".to_owned(),
            n => format!("✗ {n} failures"),
        });
        parts.join("\n\n") + "\n"
    }

    /// What passes without a proof, for the last line.
    fn reservations(&self) -> String {
        let seems = |v: Verdict| v == Verdict::Seems;
        let estimated = self.declared.iter().filter(|d| seems(d.verdict)).count()
            + self.shared.iter().filter(|s| seems(s.verdict)).count();
        let open = self.passing.undecided();
        let told = [
            (
                estimated,
                "claim is only estimated",
                "claims are only estimated",
            ),
            (
                open,
                "pair is not decided for crossings",
                "pairs are not decided for crossings",
            ),
        ];
        let told = told.into_iter().filter(|t| t.0 > 0);
        told.map(|(n, one, many)| format!("; {n} {}", if n == 1 { one } else { many }))
            .collect()
    }

    fn declared_table(&self) -> Table {
        let mut table = Table::headed(["", "sides", "claim", "found", "verdict"]);
        for d in &self.declared {
            let found = match &d.joint {
                None if d.in_part => "the sides meet in part only".to_owned(),
                None => "the sides do not meet".to_owned(),
                Some(j) => match d.check.tolerance {
                    CheckTolerance::Length(_) => format!("gap {}", self.length(&j.gap)),
                    CheckTolerance::Angle(_) => {
                        format!("angle {}, gap {}", degrees(&j.angle), self.length(&j.gap))
                    }
                    CheckTolerance::Relative(_) => format!(
                        "curvature {}, angle {}, gap {}",
                        plain(&j.curvature),
                        degrees(&j.angle),
                        self.length(&j.gap)
                    ),
                },
            };
            table.row([
                d.verdict.mark().to_owned(),
                d.sides().join(" – "),
                format!(
                    "{} within {}",
                    d.check.continuity.name(),
                    self.tolerance(d.check)
                ),
                found,
                d.verdict.word().to_owned(),
            ]);
        }
        table
    }

    fn shared_table(&self) -> Table {
        let mut table =
            Table::headed(["", "sides", "gap", "angle", "curvature jump", "smoothness"]);
        for s in &self.shared {
            let [gap, angle, jump, smooth] = match &s.joint {
                None => [
                    format!("about {} {}", bound(s.gap, 2), self.unit),
                    String::new(),
                    String::new(),
                    "not joined".to_owned(),
                ],
                Some(j) => [
                    self.length(&j.gap),
                    degrees(&j.angle),
                    plain(&j.curvature),
                    if s.verdict.passes() {
                        smoothness(j)
                    } else {
                        "not joined"
                    }
                    .to_owned(),
                ],
            };
            let sides = s.sides.join(" – ");
            table.row([s.verdict.mark().to_owned(), sides, gap, angle, jump, smooth]);
        }
        table
    }

    fn open_sides(&self) -> Vec<String> {
        let name = |(i, side): &(usize, Side)| format!("{}.{side}", self.surfaces[*i].0.name);
        self.open.iter().map(name).collect()
    }

    fn stretch_table(&self) -> Table {
        let mut table = Table::headed([
            "",
            "sides",
            "along the first",
            "gap",
            "angle",
            "curvature jump",
            "smoothness",
        ]);
        for s in &self.stretches {
            let [gap, angle, jump, smooth] = match &s.joint {
                None => ["", "", "", "not from end to end"].map(str::to_owned),
                Some(j) => [
                    self.length(&j.gap),
                    degrees(&j.angle),
                    plain(&j.curvature),
                    if self.is_close(j) {
                        smoothness(j)
                    } else {
                        "apart"
                    }
                    .to_owned(),
                ],
            };
            let [sides, place] = self.in_part.place(s);
            table.row(["•".to_owned(), sides, place, gap, angle, jump, smooth]);
        }
        table
    }

    /// Whether sides meet so closely that the mesh would join them if they had the same ends.
    fn is_close(&self, j: &Continuity) -> bool {
        Verdict::of(&j.gap, JOINED * self.tolerance).passes()
    }

    fn surface_table(&self) -> Table {
        let mut table = Table::headed(["", "surface", "tangent plane", "creases", "poles"]);
        for (s, r, creases) in &self.surfaces {
            let tear = tear(s.surface.as_ref());
            let mark = if r.folds.is_empty() && tear.is_none() {
                "✓"
            } else {
                "✗"
            };
            let state = if let Some(tear) = tear {
                torn(tear)
            } else if !r.pinches.is_empty() && r.folds.is_empty() {
                pinched(r)
            } else if r.regular {
                "in every piece, proven".to_owned()
            } else if !r.folds.is_empty() {
                format!("folds over at {}", places(&r.folds))
            } else if !r.degenerate.is_empty() {
                format!("none, or not proven, at {}", places(&r.degenerate))
            } else {
                format!("not proven; the normal is least at {}", places(&[r.at]))
            };
            let poles: Vec<&str> = r.collapsed.iter().map(|s| s.name()).collect();
            table.row([
                mark,
                s.name.as_str(),
                state.as_str(),
                creases
                    .iter()
                    .map(crease)
                    .collect::<Vec<_>>()
                    .join(", ")
                    .as_str(),
                poles.join(", ").as_str(),
            ]);
        }
        table
    }

    fn tolerance(&self, check: &Check) -> String {
        match check.tolerance {
            CheckTolerance::Length(x) => format!("{} {}", number(x, 4), self.unit),
            CheckTolerance::Angle(x) => format!("{}°", number(x.to_degrees(), 4)),
            CheckTolerance::Relative(x) => number(x, 4),
        }
    }

    fn length(&self, jump: &Jump) -> String {
        shown(jump.greatest, 1.0, &format!(" {}", self.unit))
    }

    fn json(&self) -> Value {
        let declared: Vec<Value> = self
            .declared
            .iter()
            .map(|d| {
                let (kind, tolerance) = match d.check.tolerance {
                    CheckTolerance::Length(x) => ("length", x),
                    CheckTolerance::Angle(x) => ("angle", x),
                    CheckTolerance::Relative(x) => ("relative curvature", x),
                };
                json!({
                    "between": d.sides(),
                    "continuity": d.check.continuity.name(),
                    "tolerance": { "of": kind, "value": tolerance },
                    "found": d.joint.as_ref().map(joint_json),
                    "in_part": d.in_part,
                    "verdict": d.verdict.word(),
                    "passes": d.verdict.passes(),
                })
            })
            .collect();
        let shared: Vec<Value> = self
            .shared
            .iter()
            .map(|s| {
                json!({
                    "sides": s.sides,
                    "found": s.joint.as_ref().map(joint_json),
                    "sampled_gap": s.gap,
                    "joined": s.verdict.passes(),
                })
            })
            .collect();
        let surfaces: Vec<Value> = self
            .surfaces
            .iter()
            .map(|(s, r, creases)| {
                json!({
                    "name": s.name,
                    "regular": r.regular,
                    "torn": tear(s.surface.as_ref())
                        .map(|(dir, at)| json!({ "dir": dir.to_string(), "at": at })),
                    "creases": creases
                        .iter()
                        .map(|c| json!({"dir": c.dir.to_string(), "at": c.at, "angle": c.angle, "uv": c.uv}))
                        .collect::<Vec<_>>(),
                    "collapsed_sides": r.collapsed.iter().map(|s| s.name()).collect::<Vec<_>>(),
                    "pinches": r.pinches
                        .iter()
                        .map(|p| json!({ "dir": p.dir.to_string(), "at": p.at, "point": p.point.to_array() }))
                        .collect::<Vec<_>>(),
                    "folds": r.folds,
                    "degenerate": r.degenerate,
                })
            })
            .collect();
        json!({
            "units": self.unit,
            "angles": "radians",
            "checks": declared,
            "shared_sides": shared,
            "open_sides": self.open_sides(),
            "sides_in_part": self.in_part.json(|k| self.stretches_json(k)),
            "surfaces": surfaces,
            "passing_through": self.passing.json(),
            "failures": self.failures(),
        })
    }
}

impl Findings<'_> {
    /// The stretches of a partial joint.
    fn stretches_json(&self, of: usize) -> Value {
        let range = |r: nappe::Interval| [r.lo, r.hi];
        let one = |s: &Stretch| {
            json!({
                "along": range(s.ranges[0]),
                "part": range(s.ranges[1]),
                "found": s.joint.as_ref().map(joint_json),
            })
        };
        let own = self.stretches.iter().filter(|s| s.of == of);
        own.map(one).collect()
    }
}

impl Declared<'_> {
    fn sides(&self) -> [String; 2] {
        let of = |i: usize| {
            let s = &self.check.between[i];
            format!("{}.{}", s.surface, s.side)
        };
        [of(0), of(1)]
    }
}

/// Examines a declared check. Tangent planes and curvatures are compared only of sides that meet within the tolerance of
/// the mesh, and curvatures only where tangent planes agree.
fn declared(check: &Check, tolerance: f64) -> Declared<'_> {
    let [a, b] = &check.between;
    // Sides that miss the claim by far are still to be measured, to say by how much.
    let near = match check.tolerance {
        CheckTolerance::Length(x) => tolerance.max(2.0 * x),
        _ => tolerance,
    };
    let joint = continuity(
        (a.geometry.as_ref(), a.side),
        (b.geometry.as_ref(), b.side),
        near,
        &JumpOptions::default(),
    );
    let verdict = joint.as_ref().map_or(Verdict::Fails, |j| {
        let meets = Verdict::of(&j.gap, tolerance);
        match check.tolerance {
            CheckTolerance::Length(x) => Verdict::of(&j.gap, x),
            CheckTolerance::Angle(x) => meets.and(Verdict::of(&j.angle, x)),
            CheckTolerance::Relative(x) => meets
                .and(Verdict::of(&j.angle, SMOOTH_ANGLE))
                .and(Verdict::of(&j.curvature, x)),
        }
    });
    Declared {
        check,
        joint,
        in_part: false,
        verdict,
    }
}

/// How well two sides are joined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Reached {
    /// Too far apart to be joined.
    Apart,
    /// Along a part of one of them only, and there not from end to end.
    InPart,
    /// At an angle.
    Edge,
    /// A surface with itself at an angle.
    Crease,
    /// In their points; what is more is not proven.
    Points,
    /// With their tangent planes.
    Tangents,
    /// With their curvatures.
    Curvatures,
}

impl Shared {
    fn reached(&self) -> Reached {
        match &self.joint {
            Some(j) if self.verdict.passes() => reached(j),
            _ => Reached::Apart,
        }
    }
}

/// How smoothly sides without a gap meet, by what is proven.
fn reached(j: &Continuity) -> Reached {
    match j.proven(f64::INFINITY, SMOOTH_ANGLE, SAME_CURVATURE) {
        Some(Smoothness::G2) => Reached::Curvatures,
        Some(Smoothness::G1) => Reached::Tangents,
        // Found at one place is proven, also where the gap is only estimated.
        _ if j.angle.within(SMOOTH_ANGLE) == Some(false) => Reached::Edge,
        _ => Reached::Points,
    }
}

fn smoothness(j: &Continuity) -> &'static str {
    match reached(j) {
        Reached::Curvatures => "G2",
        Reached::Tangents => "G1",
        Reached::Edge => "G0, an edge",
        _ => "G0",
    }
}

/// A bound in some unit.
fn shown(c: Certainty, unit: f64, symbol: &str) -> String {
    match c {
        Certainty::Exact => format!("0{symbol}"),
        Certainty::Bounded(e) if !e.is_finite() => "unbounded".to_owned(),
        Certainty::Estimated(e) if !e.is_finite() => "unknown".to_owned(),
        Certainty::Bounded(e) => format!("≤ {}{symbol}", bound(e * unit, 4)),
        Certainty::Estimated(e) => format!("{}{symbol} (estimated)", bound(e * unit, 4)),
    }
}

/// What is said of a surface with lines that are one point.
fn pinched(r: &Regularity) -> String {
    let lines: Vec<String> = r
        .pinches
        .iter()
        .map(|p| format!("{} = {}", p.dir, number(p.at, 6)))
        .collect();
    let rest = match (r.regular, r.degenerate.is_empty()) {
        (true, _) => "; elsewhere proven".to_owned(),
        (false, true) => "; elsewhere proven, but not close to it".to_owned(),
        (false, false) => format!("; none, or not proven, at {}", places(&r.degenerate)),
    };
    format!(
        "{} is one point, where it touches itself{rest}",
        lines.join(", ")
    )
}

fn crease(c: &Crease) -> String {
    format!(
        "{} = {} ({}°)",
        c.dir,
        number(c.at, 6),
        number(c.angle.to_degrees(), 4)
    )
}

fn degrees(jump: &Jump) -> String {
    // A bound of half a turn, rounded upwards, would show an angle that there is not.
    let greatest = match jump.greatest {
        Certainty::Bounded(e) if e.is_finite() => Certainty::Bounded(e.min(PI)),
        other => other,
    };
    shown(greatest, 1f64.to_degrees(), "°")
}

fn plain(jump: &Jump) -> String {
    shown(jump.greatest, 1.0, "")
}

/// Places told in a line; the JSON has all.
const MOST_PLACES: usize = 3;

fn places(uv: &[[f64; 2]]) -> String {
    let some = uv.iter().take(MOST_PLACES);
    let told: Vec<String> = some
        .map(|[u, v]| format!("u = {}, v = {}", number(*u, 4), number(*v, 4)))
        .collect();
    let more = uv.len().saturating_sub(MOST_PLACES);
    if more > 0 {
        format!("{} and {more} more places", told.join("; "))
    } else {
        told.join("; ")
    }
}

fn joint_json(j: &Continuity) -> Value {
    let jump = |x: &Jump| {
        json!({
            "at_most": certainty_json(x.greatest), "found": x.found, "at": x.at, "point": x.point.to_array(),
        })
    };
    json!({
        "gap": jump(&j.gap),
        "angle": jump(&j.angle),
        "relative_curvature_jump": jump(&j.curvature),
        "same_orientation": j.same_orientation,
    })
}
