//! Coons surfaces.

use crate::build::{Builder, Built, Patch, Stop};
use crate::curves::need;
use crate::data::{Datum, Fields, Item, Object};
use crate::diagnostics::Diagnostic;
use crate::surfaces::square;
use nappe::basis::{Blending, BlendingError, ExpressionFunctions, ExpressionFunctionsError};
use nappe::curve::{CrossDerivative, CurveRef, on_unit_domain};
use nappe::expr::Bound;
use nappe::surface::{
    Compatibility, Contour, ContourError, Coons, CoonsError, CoonsOptions, Cross, Disagreement,
    Estimate, IncompatibleTwists, Side, Source,
};
use std::sync::Arc;

impl Builder<'_> {
    /// The four boundary curves of an object, south, north, west, east. All are tried, so that all faults are said.
    pub(crate) fn boundary(&mut self, o: &Object) -> Built<[CurveRef; 4]> {
        let [s, n, w, e] = Side::ALL.map(|side| self.curve_key(o, side.name()));
        Ok([s?, n?, w?, e?])
    }

    pub(crate) fn coons(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let f = &o.fields;
        let boundary = self.boundary(o);
        let blend = self.blend(o);
        let cross = self.cross(o);
        let second = self.second(o);
        let ([south, north, west, east], blend, (cross, estimate)) = (boundary?, blend?, cross?);
        if !blend.has_tangents() {
            self.positions_only(o)?;
        }
        let mut options = CoonsOptions {
            blend,
            cross,
            second: second?,
            estimate,
            twists: None,
            incompatible_twists: match f.text("incompatible_twists") {
                Some("gregory") => IncompatibleTwists::Gregory,
                Some("average") => IncompatibleTwists::Average,
                _ => IncompatibleTwists::Error,
            },
            tol: CoonsOptions::default().tol,
        };
        if f.get("twists").is_some() {
            options.twists = Some(square(o, "twists")?);
        }
        if let Some(tol) = f.number("tolerance") {
            // The kernel's is relative to the size of the contour.
            let size = match Contour::with_tolerance(
                on_unit_domain(south.clone()),
                on_unit_domain(north.clone()),
                on_unit_domain(west.clone()),
                on_unit_domain(east.clone()),
                tol.max(0.0),
            ) {
                Ok(c) => c.size(),
                Err(e) => return Err(self.contour_error(o, &e)),
            };
            if size > 0.0 {
                options.tol = options.tol.max(tol / size);
            }
        }
        let surface =
            Coons::new(south, north, west, east, &options).map_err(|e| self.coons_error(o, &e))?;
        if !surface.resolved().is_empty() {
            let list: Vec<String> = surface
                .resolved()
                .iter()
                .map(Disagreement::to_string)
                .collect();
            let how = f.text("incompatible_twists").unwrap_or_default();
            self.diags.push(
                Diagnostic::new(
                    "twists",
                    format!(
                        "{}: twists were resolved by \"{how}\": {}",
                        o.label,
                        list.join("; ")
                    ),
                )
                .at(f.place("incompatible_twists", &[]), "as asked for")
                .help("second derivatives are not those of both cross-derivatives in these corners")
                .warning(),
            );
        }
        Ok(Patch::one(Arc::new(surface)))
    }

    /// Refuses words on derivatives, which linear blending does not take.
    fn positions_only(&mut self, o: &Object) -> Built<()> {
        let word = matches!(
            o.fields.get("cross").map(|i| &i.datum),
            Some(Datum::Text(_))
        );
        let given = [
            ("cross", word),
            (
                "incompatible_twists",
                o.fields.get("incompatible_twists").is_some(),
            ),
        ];
        let Some((key, _)) = given.into_iter().find(|g| g.1) else {
            return Ok(());
        };
        let message = format!("`{key}` is given, but linear blending keeps positions only");
        let help = format!("write blend = \"cubic\", or remove `{key}`");
        Err(self.refuse(o, (key, &[]), message, help))
    }

    /// The blending functions.
    pub(crate) fn blend(&mut self, o: &Object) -> Built<Blending> {
        let f = &o.fields;
        match f.get("blend").map(|i| &i.datum) {
            None => Ok(Blending::linear()),
            Some(Datum::Record(r)) => match r.number("trigonometric") {
                Some(alpha) => Blending::trigonometric(alpha).map_err(|e| {
                    let help =
                        "choose an angle above 0deg that keeps away from 180deg, such as \"90deg\"";
                    self.refuse(o, ("blend", &[]), e, help)
                }),
                None => self.user_blend(o, &r.clone()),
            },
            Some(_) if f.text("blend") == Some("cubic") => Ok(Blending::cubic()),
            Some(_) if f.text("blend") == Some("quintic") => Ok(Blending::quintic()),
            Some(_) => Ok(Blending::linear()),
        }
    }

    fn user_blend(&mut self, o: &Object, r: &Fields) -> Built<Blending> {
        const NAMES: [&str; 4] = ["h1", "h2", "h3", "h4"];
        let mut functions = Vec::new();
        for name in NAMES {
            match r.get(name).map(|i| &i.datum) {
                Some(Datum::Formula(b)) => functions.push(b.clone()),
                _ => return Err(Stop::Reported),
            }
        }
        let functions = self.functions(&o.label, r, &NAMES, functions)?;
        Blending::user(Arc::new(functions)).map_err(|e| {
            let key = match &e {
                BlendingError::Conditions { faults } => faults
                    .first()
                    .map_or("h1", |f| NAMES[(f.function.max(1) - 1).min(3)]),
                _ => "h1",
            };
            let help =
                "h1 is 1 at 0, h4 is 1 at 1, h2' is 1 at 0, h3' is 1 at 1; all else is 0 there";
            self.refuse_in(&format!("{}, `blend`", o.label), r, (key, &[]), e, help)
        })
    }

    /// Functions on `[0, 1]` from formulas; the keys say where each stands.
    pub(crate) fn functions(
        &mut self,
        label: &str,
        fields: &Fields,
        keys: &[&str],
        formulas: Vec<Bound>,
    ) -> Built<ExpressionFunctions> {
        ExpressionFunctions::new(formulas, [0.0, 1.0]).map_err(|e| match &e {
            ExpressionFunctionsError::Function { index, error } => {
                // One key for each, or one key with a list.
                let (key, path): (&str, Vec<usize>) = match keys {
                    [one] => (one, vec![*index]),
                    many => (many.get(*index).copied().unwrap_or(""), vec![]),
                };
                let message = format!("`{key}`: {error}");
                self.refuse_in(label, fields, (key, &path), message, error.help())
            }
            _ => self.refuse_in(
                label,
                fields,
                (keys.first().copied().unwrap_or(""), &[]),
                &e,
                "add a function",
            ),
        })
    }

    /// The cross-derivatives and how unknown twists are estimated.
    pub(crate) fn cross(&mut self, o: &Object) -> Built<([Cross; 4], Estimate)> {
        let word = |w: &str| {
            if w == "adini" {
                Estimate::Adini
            } else {
                Estimate::Ferguson
            }
        };
        let mut cross: [Cross; 4] = Default::default();
        let record = match o.fields.get("cross").map(|i| &i.datum) {
            Some(Datum::Text(w)) => return Ok((cross, word(w))),
            Some(Datum::Record(r)) => r.clone(),
            _ => return Ok((cross, Estimate::default())),
        };
        let mut estimate: Option<Estimate> = None;
        let mut stop = None;
        for (to, side) in cross.iter_mut().zip(Side::ALL) {
            let Some(item) = record.get(side.name()) else {
                continue;
            };
            if let Datum::Text(w) = &item.datum {
                if estimate.is_some_and(|e| e != word(w)) {
                    let message = "\"ferguson\" and \"adini\" are mixed; unknown twists are estimated in one way";
                    let label = format!("{}, `cross`", o.label);
                    return Err(self.refuse_in(
                        &label,
                        &record,
                        (side.name(), &[]),
                        message,
                        "write the same word for all",
                    ));
                }
                estimate = Some(word(w));
                continue;
            }
            match self.cross_of(o, item, &format!("{}, `cross.{side}`", o.label)) {
                Ok(c) => *to = c,
                Err(s) => stop = Some(s),
            }
        }
        match stop {
            Some(s) => Err(s),
            None => Ok((cross, estimate.unwrap_or_default())),
        }
    }

    /// The second cross-derivatives that are given.
    pub(crate) fn second(&mut self, o: &Object) -> Built<[Option<CurveRef>; 4]> {
        let mut second: [Option<CurveRef>; 4] = Default::default();
        let Some(Datum::Record(record)) = o.fields.get("second").map(|i| &i.datum) else {
            return Ok(second);
        };
        let mut stop = None;
        for (to, side) in second.iter_mut().zip(Side::ALL) {
            let Some(item) = record.get(side.name()) else {
                continue;
            };
            match self.curve(item, &format!("{}, `second.{side}`", o.label)) {
                Ok(c) => *to = Some(c),
                Err(s) => stop = Some(s),
            }
        }
        match stop {
            Some(s) => Err(s),
            None => Ok(second),
        }
    }

    /// A cross-derivative: of a neighbour, or a curve.
    fn cross_of(&mut self, _o: &Object, item: &Item, label: &str) -> Built<Cross> {
        if let Datum::Record(r) = &item.datum {
            let Some(Datum::Side(name)) = r.get("from").map(|i| &i.datum) else {
                return Err(Stop::Reported);
            };
            let surface = self.surface(&name.surface, label, &r.place("from", &[]))?;
            return Ok(Cross::Neighbour {
                surface,
                side: name.side,
            });
        }
        Ok(Cross::Curve(self.curve(item, label)?))
    }

    fn coons_error(&mut self, o: &Object, e: &CoonsError) -> Stop {
        match e {
            CoonsError::Contour(e) => self.contour_error(o, e),
            CoonsError::Incompatible(report) => self.incompatible(o, report),
            CoonsError::PositionsOnly { source_name } => {
                let (key, _) = source_key(*source_name);
                self.refuse(
                    o,
                    (key, &[]),
                    e,
                    "write blend = \"cubic\", or remove what is given",
                )
            }
            CoonsError::SecondNotKept { side } => {
                let place = match o.fields.record("second") {
                    Some(r) => r.place(side.name(), &[]),
                    None => o.fields.place("second", &[]),
                };
                self.diags.push(
                    Diagnostic::new("geometry", format!("{}: {e}", o.label))
                        .at(place, format!("`second.{side}`"))
                        .help("write blend = \"quintic\", or remove `second`"),
                );
                Stop::Reported
            }
            CoonsError::GregoryQuintic => self.refuse(
                o,
                ("incompatible_twists", &[]),
                e,
                "write incompatible_twists = \"average\", or remove it",
            ),
            CoonsError::NotFinite { source_name, .. } => {
                let (key, _) = source_key(*source_name);
                self.refuse(o, (key, &[]), e, "use a curve with finite derivatives")
            }
            CoonsError::TwistNotFinite { u, v, .. } => {
                self.refuse(o, ("twists", &[*u, *v]), e, "write finite numbers")
            }
            CoonsError::NeighbourApart { side, .. } => {
                let help = format!(
                    "let `{side}` be the neighbour's side itself, such as {side} = \"other.north\""
                );
                self.refuse(o, ("cross", &[]), e, help)
            }
            CoonsError::NeighbourJumps { side, .. } => {
                let help = format!(
                    "let the boundary follow the neighbour's parameter lines, write `second.{side}`, or write blend = \"cubic\""
                );
                self.refuse(o, ("cross", &[]), e, help)
            }
            CoonsError::NeighbourFolds { .. } => self.refuse(
                o,
                ("cross", &[]),
                e,
                "let the boundary leave the neighbour, or remove this cross-derivative",
            ),
        }
    }

    /// The report over the corner data: every place that disagrees is shown.
    fn incompatible(&mut self, o: &Object, report: &Compatibility) -> Stop {
        let positions = report
            .disagreements
            .iter()
            .any(|d| d.datum == nappe::surface::Datum::Position);
        let unmixed = |first: bool| {
            use nappe::surface::Datum::{TangentU, TangentV};
            report
                .disagreements
                .iter()
                .any(|d| !d.datum.is_mixed() && matches!(d.datum, TangentU | TangentV) == first)
        };
        let (tangents, seconds) = (unmixed(true), unmixed(false));
        let help = if !report.reverse.is_empty() {
            reversal(&report.reverse)
        } else if positions {
            "move the ends together: south and north run along u from west to east, west and east along v from south to \
             north"
                .to_owned()
        } else if tangents {
            "let each cross-derivative begin and end with the tangents of the boundary curves that it meets".to_owned()
        } else if seconds {
            "let each second cross-derivative begin and end with the second derivatives of the boundary curves that it \
             meets"
                .to_owned()
        } else if report.quintic {
            "write incompatible_twists = \"average\", or change a cross-derivative".to_owned()
        } else {
            "write incompatible_twists = \"gregory\" or \"average\", or change a cross-derivative"
                .to_owned()
        };
        let mut d = Diagnostic::new(
            "geometry",
            format!(
                "{}: the boundary data does not fit together: {report}",
                o.label
            ),
        );
        let mut shown: Vec<&str> = Vec::new();
        // What to reverse comes first: the message names that line.
        let reverse = report.reverse.iter().map(|&side| Source::Side(side));
        let sources = report.disagreements.iter().flat_map(|x| x.sources);
        for source in reverse.chain(sources) {
            let (key, text) = source_key(source);
            if !shown.contains(&text) {
                shown.push(text);
                let place = match (o.fields.record("cross"), source) {
                    (Some(r), Source::Cross(side)) => r.place(side.name(), &[]),
                    // What follows from a neighbour is not written.
                    (cross, Source::Second(side)) => {
                        match o
                            .fields
                            .record("second")
                            .filter(|r| r.get(side.name()).is_some())
                            .or(cross)
                        {
                            Some(r) => r.place(side.name(), &[]),
                            None => o.fields.place(key, &[]),
                        }
                    }
                    _ => o.fields.place(key, &[]),
                };
                d = d.at(place, format!("`{text}`"));
            }
        }
        self.diags.push(d.help(help));
        Stop::Reported
    }

    /// Boundary curves that do not close: the corners, the distances, and which curve to reverse.
    pub(crate) fn contour_error(&mut self, o: &Object, e: &ContourError) -> Stop {
        match e {
            ContourError::Open { gaps, reverse, .. } => {
                let mut sides: Vec<Side> = reverse.clone();
                for g in gaps {
                    sides.extend(g.corner.sides());
                }
                let mut d = Diagnostic::new("geometry", format!("{}: {e}", o.label));
                let mut shown: Vec<Side> = Vec::new();
                for side in sides {
                    if !shown.contains(&side) {
                        shown.push(side);
                        d = d.at(o.fields.place(side.name(), &[]), format!("`{side}`"));
                    }
                }
                let help = if reverse.is_empty() {
                    "south and north run along u from west to east, west and east along v from south to north; move the \
                     ends together"
                        .to_owned()
                } else {
                    reversal(reverse)
                };
                self.diags.push(d.help(help));
                Stop::Reported
            }
            ContourError::NotFinite { side, .. } => {
                self.refuse(o, (side.name(), &[]), e, "use a curve with finite points")
            }
        }
    }

    /// A cross-derivative that must be there: of a neighbour, or a curve.
    pub(crate) fn tangent(&mut self, o: &Object, key: &str) -> Built<Option<CurveRef>> {
        let Some(item) = o.fields.get(key) else {
            return Ok(None);
        };
        let label = format!("{}, `{key}`", o.label);
        match self.cross_of(o, item, &label)? {
            Cross::Neighbour { surface, side } => {
                Ok(Some(Arc::new(CrossDerivative::side(surface, side))))
            }
            Cross::Curve(c) => Ok(Some(c)),
            Cross::Estimated => need(None),
        }
    }
}

/// Which curves to reverse, and how that is written.
fn reversal(sides: &[Side]) -> String {
    let names: Vec<&str> = sides.iter().map(|s| s.name()).collect();
    format!(
        "reverse {}: write {} = {{ kind = \"reverse\", curve = … }}",
        names.join(" and "),
        names.join(" and ")
    )
}

/// The key where something is given, and its full name.
fn source_key(s: Source) -> (&'static str, &'static str) {
    match s {
        Source::Side(side) => (side.name(), side.name()),
        Source::Cross(Side::South) => ("cross", "cross.south"),
        Source::Cross(Side::North) => ("cross", "cross.north"),
        Source::Cross(Side::West) => ("cross", "cross.west"),
        Source::Cross(Side::East) => ("cross", "cross.east"),
        Source::Second(Side::South) => ("second", "second.south"),
        Source::Second(Side::North) => ("second", "second.north"),
        Source::Second(Side::West) => ("second", "second.west"),
        Source::Second(Side::East) => ("second", "second.east"),
        Source::Twists => ("twists", "twists"),
    }
}
