//! Curves on surfaces that are traced: from data to geometry.

use crate::build::{Builder, Built, Stop};
use crate::curves::need;
use crate::data::{Datum, Object};
use crate::diagnostics::Diagnostic;
use nappe::curve::CurveRef;
use nappe::measure::CurvatureKind;
use nappe::query::{
    Branch, ExpressionField, Field, Figure, FigureError, IntersectOptions, SurfaceCurve,
    SurfaceField, TraceError, TraceOptions, intersect_surfaces, trace,
};
use nappe::significant;
use nappe::surface::SurfaceRef;
use nappe::{Certainty, Interval};
use std::fmt::Display;

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
        self.not_decided(
            o,
            &found.undecided,
            "move the curve a little to avoid such places",
        );
        let told: Vec<String> = found.branches.iter().map(told).collect();
        let k = self.branch(o, &told, found.undecided.first(), "on the surface")?;
        let branch = &found.branches[k];
        self.far(o, branch.certainty, found.tol);
        Ok(branch.curve())
    }

    /// Builds one branch of the curve in which two surfaces meet.
    pub(crate) fn intersection(&mut self, o: &Object) -> Built<CurveRef> {
        let [a, b] = self.two_surfaces(o, "surfaces")?;
        let options = IntersectOptions {
            tol: o.fields.number("tolerance"),
            ..IntersectOptions::default()
        };
        let found = match intersect_surfaces(&a, &b, &options) {
            Ok(found) => found,
            Err(e) => {
                return Err(self.refuse(o, ("tolerance", &[]), e, "write a number greater than 0"));
            }
        };
        self.not_decided(
            o,
            &found.undecided,
            "move a surface a little to avoid such places",
        );
        let range = |c: &SurfaceCurve| (c.bounds(0), c.is_closed());
        let told: Vec<String> = found.branches.iter().map(|c| told_in(range(c))).collect();
        let k = self.branch(o, &told, found.undecided.first(), "of the two surfaces")?;
        let branch = &found.branches[k];
        self.far(o, branch.certainty, found.tol);
        Ok(branch.curve())
    }

    /// Warns of places that are not decided.
    fn not_decided<T: Display>(&mut self, o: &Object, places: &[T], remedy: &str) {
        let mut warn = |message: String, help: String| {
            self.diags.push(
                Diagnostic::new("not-proven", message)
                    .at(o.fields.place("", &[]), o.kind.name)
                    .help(help)
                    .warning(),
            );
        };
        for place in places.iter().take(LISTED) {
            let message = format!("{}: not decided at {place}", o.label);
            warn(
                message,
                format!("what is drawn is proven elsewhere; {remedy}"),
            );
        }
        if places.len() > LISTED {
            let more = places.len() - LISTED;
            let message = format!("{}: {more} more places are not decided", o.label);
            warn(message, remedy.to_owned());
        }
    }

    /// Warns of a curve that is not proven to be within the tolerance.
    fn far(&mut self, o: &Object, certainty: Certainty, tol: f64) {
        let far = match certainty {
            Certainty::Estimated(_) => "not bounded".to_owned(),
            c if c.error() > tol => format!(
                "bounded by {} only, more than the tolerance {}",
                significant(c.error(), 3),
                significant(tol, 3)
            ),
            _ => return,
        };
        let message = format!("{}: its distance from the exact curve is {far}", o.label);
        self.diags.push(
            Diagnostic::new("not-proven", message)
                .at(o.fields.place("", &[]), o.kind.name)
                .help("choose a larger tolerance")
                .warning(),
        );
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

    /// The number of the branch that is asked for, or of the only one, from 0. `told` says where each is.
    fn branch<T: Display>(
        &mut self,
        o: &Object,
        told: &[String],
        undecided: Option<&T>,
        whose: &str,
    ) -> Built<usize> {
        let n = told.len();
        let asked = o.fields.number("branch").map(|k| k as usize);
        if n == 0 {
            let message = match undecided {
                Some(place) => format!("no curve is proven to be there; not decided: {place}"),
                None => format!("there is no such curve {whose}"),
            };
            return Err(self.refuse(
                o,
                ("", &[]),
                message,
                "move it so that it meets the surface",
            ));
        }
        match asked {
            None if n == 1 => return Ok(0),
            Some(k) if (1..=n).contains(&k) => return Ok(k - 1),
            _ => {}
        }
        let listed: Vec<String> = (1..)
            .zip(told)
            .take(LISTED)
            .map(|(k, t)| format!("{k} {t}"))
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
fn told(branch: &Branch) -> String {
    told_in((branch.bounds(), branch.is_closed()))
}

/// The same from its ranges of parameters, and whether it is closed.
fn told_in(([u, v], closed): ([Interval; 2], bool)) -> String {
    let closed = if closed { ", closed" } else { "" };
    let number = |x: f64| significant(x, 3);
    format!(
        "in u {} to {}, v {} to {}{closed}",
        number(u.lo),
        number(u.hi),
        number(v.lo),
        number(v.hi)
    )
}
