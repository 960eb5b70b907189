//! Curves on surfaces that are traced: from data to geometry.

use crate::build::{Builder, Built, Stop};
use crate::curves::need;
use crate::data::{Datum, Object};
use crate::diagnostics::Diagnostic;
use nappe::Certainty;
use nappe::curve::CurveRef;
use nappe::measure::CurvatureKind;
use nappe::query::{
    Branch, ExpressionField, Field, Figure, FigureError, SurfaceField, Trace, TraceError,
    TraceOptions, trace,
};
use nappe::significant;
use nappe::surface::SurfaceRef;

/// Branches listed in a message.
const LISTED: usize = 8;

impl Builder<'_> {
    /// Builds one branch of a curve that is the zeros of a function on a surface.
    pub(crate) fn traced(&mut self, o: &Object) -> Built<CurveRef> {
        let surface = self.surface_key(o, "surface")?;
        let field = self.field(o, &surface)?;
        let options = TraceOptions {
            surface: Some(surface),
            tol: o.fields.number("tolerance"),
            ..TraceOptions::default()
        };
        let found = match trace(field.as_ref(), &options) {
            Ok(found) => found,
            Err(e) => return Err(self.trace_error(o, &e)),
        };
        for place in found.undecided.iter().take(LISTED) {
            let message = format!("{}: not decided at {place}", o.label);
            let help =
                "what is drawn is proven elsewhere; move the curve a little to avoid such places";
            self.diags.push(
                Diagnostic::new("not-proven", message)
                    .at(o.fields.place("", &[]), o.kind.name)
                    .help(help)
                    .warning(),
            );
        }
        if found.undecided.len() > LISTED {
            let more = found.undecided.len() - LISTED;
            let message = format!("{}: {more} more places are not decided", o.label);
            self.diags.push(
                Diagnostic::new("not-proven", message)
                    .at(o.fields.place("", &[]), o.kind.name)
                    .help("move the curve a little to avoid such places")
                    .warning(),
            );
        }
        let branch = self.branch(o, &found)?;
        let far = match branch.certainty {
            Certainty::Estimated(_) => Some("not bounded".to_owned()),
            c if c.error() > found.tol => Some(format!(
                "bounded by {} only, more than the tolerance {}",
                significant(c.error(), 3),
                significant(found.tol, 3)
            )),
            _ => None,
        };
        if let Some(far) = far {
            let message = format!("{}: its distance from the exact curve is {far}", o.label);
            self.diags.push(
                Diagnostic::new("not-proven", message)
                    .at(o.fields.place("", &[]), o.kind.name)
                    .help("choose a larger tolerance")
                    .warning(),
            );
        }
        Ok(branch.curve())
    }

    fn field(&mut self, o: &Object, surface: &SurfaceRef) -> Built<Box<dyn Field>> {
        let f = &o.fields;
        let figure = match o.kind.name {
            "trace" => {
                let Some(Datum::Formula(bound)) = f.get("f").map(|i| &i.datum) else {
                    return Err(Stop::Reported);
                };
                let field = ExpressionField::new(bound.clone(), surface.domain());
                return Ok(Box::new(field));
            }
            "section" => Figure::Section {
                point: f.vector("origin").unwrap_or_default(),
                normal: need(f.vector("normal"))?,
            },
            "silhouette" => match f.vector("eye") {
                Some(eye) => Figure::SilhouetteFrom { eye },
                None => Figure::Silhouette {
                    direction: need(f.vector("direction"))?,
                },
            },
            "isophote" => Figure::Isophote {
                direction: need(f.vector("direction"))?,
                angle: need(f.number("angle"))?,
            },
            _ => Figure::Curvature {
                kind: match f.text("curvature") {
                    Some("gaussian") => CurvatureKind::Gaussian,
                    Some("mean") => CurvatureKind::Mean,
                    Some("k1") => CurvatureKind::K1,
                    _ => CurvatureKind::K2,
                },
                value: need(f.number("value"))?,
            },
        };
        match SurfaceField::new(surface.clone(), figure) {
            Ok(field) => Ok(Box::new(field)),
            Err(e) => {
                let keys: &[&str] = match e {
                    FigureError::Angle(_) => &["angle"],
                    FigureError::Direction(_) => &["direction", "normal"],
                    FigureError::Point(_) => &["eye", "origin"],
                    _ => &["value"],
                };
                let key = keys
                    .iter()
                    .copied()
                    .find(|k| f.get(k).is_some())
                    .unwrap_or("");
                Err(self.refuse(o, (key, &[]), e, "change it"))
            }
        }
    }

    fn trace_error(&mut self, o: &Object, e: &TraceError) -> Stop {
        let (key, help) = match e {
            TraceError::Zero(_) => ("", "cut it elsewhere, or let it be a part of the surface"),
            TraceError::NoValue(_) => ("f", "change the formula"),
            TraceError::Tolerance(_) => ("tolerance", "write a number greater than 0"),
            TraceError::Rectangle { .. } => ("surface", "use another surface"),
        };
        self.refuse(o, (key, &[]), e, help)
    }

    /// The branch that is asked for, or the only one.
    fn branch<'t>(&mut self, o: &Object, found: &'t Trace) -> Built<&'t Branch> {
        let n = found.branches.len();
        let asked = o.fields.number("branch").map(|k| k as usize);
        if n == 0 {
            let message = match found.undecided.first() {
                Some(place) => format!("no curve is proven to be there; not decided: {place}"),
                None => "there is no such curve on the surface".to_owned(),
            };
            return Err(self.refuse(
                o,
                ("", &[]),
                message,
                "move it so that it meets the surface",
            ));
        }
        match asked {
            None if n == 1 => return Ok(&found.branches[0]),
            Some(k) if (1..=n).contains(&k) => return Ok(&found.branches[k - 1]),
            _ => {}
        }
        let listed: Vec<String> = found
            .branches
            .iter()
            .take(LISTED)
            .enumerate()
            .map(told)
            .collect();
        let more = if n > LISTED { ", …" } else { "" };
        let what = match asked {
            Some(k) => format!("there is no branch {k}"),
            None => "a curve is one branch, but there are several".to_owned(),
        };
        let branches = if n == 1 { "branch" } else { "branches" };
        let message = format!("{what}: {n} {branches}, {}{more}", listed.join(", "));
        let key = if asked.is_some() { "branch" } else { "" };
        let help =
            format!("write branch = 1, or another up to {n}; one object for each that is wanted");
        Err(self.refuse(o, (key, &[]), message, &help))
    }
}

/// Where a branch is.
fn told((k, branch): (usize, &Branch)) -> String {
    let [u, v] = branch.bounds();
    let closed = if branch.is_closed() { ", closed" } else { "" };
    let number = |x: f64| significant(x, 3);
    format!(
        "{} in u {} to {}, v {} to {}{closed}",
        k + 1,
        number(u.lo),
        number(u.hi),
        number(v.lo),
        number(v.hi)
    )
}
