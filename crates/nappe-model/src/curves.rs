//! The kinds of curves: from data to geometry.

use crate::build::{Builder, Built, Stop};
use crate::data::{Datum, Fields, Item, Object};
use nappe::basis::KnotError;
use nappe::curve::{CurveError, CurveRef, InterpolateOptions, conic, interpolate, polyline};
use nappe::curve::{
    Ellipse, EllipseOptions, ExpressionCurve, ExpressionCurveError, Hermite, Isocurve, JoinOptions,
    Joined, Line, Spacing, Transformed, Trimmed,
};
use nappe::exact::{NurbsCurve, NurbsError, bad_weights};
use nappe::expr::Bound;
use nappe::surface::Dir;
use nappe::{DAffine3, DVec3, Frame, maps};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A datum that the registry promises. It is there whenever the object was read without error.
pub(crate) fn need<T>(x: Option<T>) -> Built<T> {
    x.ok_or(Stop::Reported)
}

/// What an arc, a circle or an ellipse is made of.
pub(crate) struct ArcData {
    pub(crate) center: DVec3,
    pub(crate) semi_axes: [f64; 2],
    /// In radians.
    pub(crate) range: [f64; 2],
}

impl ArcData {
    /// The data of an object; where no range is given it ends at `to`.
    pub(crate) fn of(o: &Object, to: f64) -> Built<Self> {
        let f = &o.fields;
        let semi_axes = match f.number("radius") {
            Some(r) => [r, r],
            None => need(f.numbers("semi_axes").and_then(|a| a.try_into().ok()))?,
        };
        Ok(Self {
            center: f.vector("center").unwrap_or(DVec3::ZERO),
            semi_axes,
            range: [("from", 0.0), ("to", to)].map(|(k, d)| f.number(k).unwrap_or(d)),
        })
    }

    /// The curve, in the plane that the fields say.
    pub(crate) fn ellipse(&self, f: &Fields) -> Result<Ellipse, CurveError> {
        let options = EllipseOptions {
            from: self.range[0],
            to: self.range[1],
            normal: f.vector("normal").unwrap_or(DVec3::Z),
            x_direction: f.vector("x_direction"),
        };
        Ellipse::new(self.center, self.semi_axes, options)
    }
}

impl Builder<'_> {
    /// Builds a curve.
    pub(crate) fn curve_of(&mut self, o: &Object) -> Built<CurveRef> {
        let f = &o.fields;
        let vector = |key: &str| need(f.vector(key));
        let number = |key: &str| need(f.number(key));
        match o.kind.name {
            "line" => self.curve_result(o, Line::new(vector("from")?, vector("to")?)),
            "polyline" => {
                let points = need(f.vectors("points"))?;
                self.curve_result(o, polyline(&points, spacing(f)))
            }
            "bezier" => {
                let points = need(f.vectors("points"))?;
                let weights = f.numbers("weights");
                self.further_weights(o, weights.as_deref());
                self.curve_result(
                    o,
                    NurbsCurve::bezier(&points, weights.as_deref()).map_err(CurveError::from),
                )
            }
            "nurbs" => {
                let points = need(f.vectors("points"))?;
                let weights = f.numbers("weights");
                self.further_weights(o, weights.as_deref());
                let degree = number("degree")? as usize;
                let knots = f
                    .numbers("knots")
                    .unwrap_or_else(|| clamped_uniform(points.len(), degree));
                let curve = NurbsCurve::new(degree, knots.clone(), &points, weights.as_deref());
                if matches!(
                    curve,
                    Err(NurbsError::Weight { .. } | NurbsError::WeightCount { .. })
                ) && let Err(e) = NurbsCurve::new(degree, knots, &points, None)
                {
                    // The knots are wrong too; both are said.
                    self.curve_error(o, &e.into());
                }
                self.curve_result(o, curve.map_err(CurveError::from))
            }
            "hermite" => {
                let tangents = [vector("from_tangent")?, vector("to_tangent")?];
                self.curve_result(
                    o,
                    Hermite::new(vector("from")?, vector("to")?, tangents[0], tangents[1]),
                )
            }
            "arc" if f.get("through").is_some() => {
                let points = need(f.vectors("through"))?;
                let points = need(<[DVec3; 3]>::try_from(points).ok())?;
                self.curve_result(o, Ellipse::through(points))
            }
            "arc" | "circle" | "ellipse" => {
                let data = ArcData::of(o, TAU)?;
                self.curve_result(o, data.ellipse(f))
            }
            "conic" => {
                let points = need(f.vectors("points"))?;
                let points = need(<[DVec3; 3]>::try_from(points).ok())?;
                self.curve_result(o, conic(points, number("weight")?))
            }
            "interpolate" => {
                let points = need(f.vectors("points"))?;
                let options = InterpolateOptions {
                    degree: f.number("degree").map_or(3, |d| d as usize),
                    closed: f.flag("closed"),
                    spacing: spacing(f),
                    start_tangent: f.vector("start_tangent"),
                    end_tangent: f.vector("end_tangent"),
                };
                self.curve_result(o, interpolate(&points, options))
            }
            "expression" => self.expression(o),
            "isocurve" => {
                let surface = self.surface_key(o, "surface")?;
                let (along, at) = match f.number("u") {
                    Some(u) => (Dir::V, u),
                    None => (Dir::U, number("v")?),
                };
                self.curve_result(o, Isocurve::new(surface, along, at))
            }
            "trace" | "section" | "silhouette" | "isophote" | "isocurvature" => self.traced(o),
            "intersection" => self.intersection(o),
            "side" => match f.get("side").map(|i| i.datum.clone()) {
                Some(Datum::Side(side)) => self.side(&side, &o.label, &f.place("side", &[])),
                _ => Err(Stop::Reported),
            },
            "reverse" => {
                let curve = self.curve_key(o, "curve")?;
                Ok(Arc::new(Trimmed::reversed(curve)))
            }
            "trim" => {
                let curve = self.curve_key(o, "curve")?;
                let domain = curve.domain();
                let [from, to] =
                    [("from", domain.lo), ("to", domain.hi)].map(|(k, d)| f.number(k).unwrap_or(d));
                self.curve_result(o, Trimmed::new(curve, from, to))
            }
            "join" => {
                let items: Vec<Item> = need(f.list("curves"))?.to_vec();
                let label = format!("{}, `curves`", o.label);
                let curves: Vec<Built<CurveRef>> =
                    items.iter().map(|i| self.curve(i, &label)).collect();
                let curves = curves.into_iter().collect::<Built<Vec<_>>>()?;
                self.curve_result(o, Joined::new(curves, JoinOptions::default()))
            }
            "transform" => {
                let curve = self.curve_key(o, "curve")?;
                let map = self.map(o)?;
                self.curve_result(o, Transformed::new(curve, map))
            }
            "import" => self.imported_curve(o),
            other => Err(self.refuse(
                o,
                ("", &[]),
                format!("the kind \"{other}\" is not built"),
                "use another kind",
            )),
        }
    }

    fn expression(&mut self, o: &Object) -> Built<CurveRef> {
        let f = &o.fields;
        let formula = |key: &str| match f.get(key).map(|i| &i.datum) {
            Some(Datum::Formula(b)) => Ok(b.clone()),
            _ => Err(Stop::Reported),
        };
        let coordinates: [Bound; 3] = [formula("x")?, formula("y")?, formula("z")?];
        let domain = f.numbers("domain").unwrap_or_else(|| vec![0.0, 1.0]);
        let domain = need(<[f64; 2]>::try_from(domain).ok())?;
        let curve = match ExpressionCurve::new(coordinates, domain) {
            Ok(c) => c,
            Err(ExpressionCurveError::Coordinate { coordinate, error }) => {
                let key = ["x", "y", "z"][coordinate.min(2)];
                let key = if matches!(error, nappe::expr::FunctionError::Domain(..)) {
                    "domain"
                } else {
                    key
                };
                let help = error.help();
                return Err(self.refuse(o, (key, &[]), format!("`{key}`: {error}"), help));
            }
            Err(e) => return Err(self.refuse(o, ("", &[]), e, "change the formula or the domain")),
        };
        for (key, function) in ["x", "y", "z"].into_iter().zip(curve.coordinates()) {
            self.undecided(o, key, function);
        }
        Ok(Arc::new(curve))
    }

    /// Warns where a function is not proven to be finite.
    pub(crate) fn undecided(&mut self, o: &Object, key: &str, function: &nappe::expr::Function) {
        if let nappe::expr::Finding::Undecided(e) = function.finding() {
            let message = format!(
                "{}, `{key}`: not proven to be finite, though all samples are: {e}",
                o.label
            );
            self.diags.push(
                crate::diagnostics::Diagnostic::new("not-proven", message)
                    .at(o.fields.place(key, &[]), format!("`{key}`"))
                    .help("results that need a bound here will be estimates")
                    .warning(),
            );
        }
    }

    /// A curve from the kernel, or its error at the place it speaks of.
    pub(crate) fn curve_result<C: nappe::curve::Curve + 'static>(
        &mut self,
        o: &Object,
        result: Result<C, CurveError>,
    ) -> Built<CurveRef> {
        match result {
            Ok(c) => Ok(Arc::new(c)),
            Err(e) => Err(self.curve_error(o, &e)),
        }
    }

    /// The bad weights but the first, which is told when the curve is made.
    fn further_weights(&mut self, o: &Object, weights: Option<&[f64]>) {
        for e in bad_weights(weights.unwrap_or_default()).skip(1) {
            self.curve_error(o, &e.into());
        }
    }

    pub(crate) fn curve_error(&mut self, o: &Object, e: &CurveError) -> Stop {
        let f = &o.fields;
        let first = |keys: &[&'static str]| {
            keys.iter()
                .copied()
                .find(|k| f.get(k).is_some())
                .unwrap_or("")
        };
        let (key, path, help): (&str, Vec<usize>, &str) = match e {
            CurveError::Nurbs(NurbsError::Weight { value, .. }) if f.get("weight").is_some() => {
                let message =
                    format!("the weight is {value}: it must be a positive, finite number");
                return self.refuse(o, ("weight", &[]), message, "write a number greater than 0");
            }
            CurveError::Nurbs(e) => {
                let (key, path, help) = nurbs_place(e);
                // The degree of a Bézier curve is that of its points.
                let key = if key == "degree" {
                    first(&["degree", "points"])
                } else {
                    key
                };
                return self.refuse(o, (key, &path), e, help);
            }
            CurveError::NotPositive { what, .. } => {
                let key = if what.contains("radius") {
                    "radius"
                } else if what.contains("weight") {
                    "weight"
                } else {
                    first(&["radius", "semi_axes"])
                };
                let path = if what.contains("second") {
                    vec![1]
                } else {
                    vec![0]
                };
                (key, path, "write a number greater than 0")
            }
            CurveError::Plane(_) => (
                first(&["x_direction", "normal"]),
                vec![],
                "give a normal that is not zero and an x_direction aside from it",
            ),
            CurveError::Turn { .. } => (
                first(&["to", "from"]),
                vec![],
                "let `to` differ from `from` by at most one turn (360deg)",
            ),
            CurveError::Collinear { .. } => {
                ("through", vec![1], "move a point aside, or use a line")
            }
            CurveError::Coincident { second, .. } => (
                first(&["points", "through"]),
                vec![*second],
                "remove one of the two points",
            ),
            CurveError::TooFewPoints { .. } => ("points", vec![], "add points"),
            CurveError::Degree { .. } => (
                "degree",
                vec![],
                "choose a degree in this range, or add points",
            ),
            CurveError::TangentOfClosed => (
                first(&["start_tangent", "end_tangent"]),
                vec![],
                "remove it, or `closed`",
            ),
            CurveError::Range { .. } => (
                first(&["to", "from"]),
                vec![],
                "choose two different parameters of the curve",
            ),
            CurveError::Outside { .. } => (
                first(&["u", "v"]),
                vec![],
                "choose a parameter of the surface",
            ),
            CurveError::TooManyPieces { .. } => ("curves", vec![], "join fewer curves"),
            CurveError::Gap {
                second, reversed, ..
            } => {
                let help = if *reversed {
                    "write { kind = \"reverse\", curve = … } for it"
                } else {
                    "move the ends together, or join other curves"
                };
                ("curves", vec![*second], help)
            }
            CurveError::IllConditioned { index, .. } => (
                "points",
                vec![*index],
                "use degree 3, or parametrization = \"centripetal\", or spread the points more evenly",
            ),
            CurveError::Nothing => ("curves", vec![], "name at least one curve"),
            CurveError::VectorNotFinite { .. } | CurveError::NotFinite { .. } => {
                ("", vec![], "use numbers of a reasonable size")
            }
        };
        self.refuse(o, (key, &path), e, help)
    }

    /// The map of a `transform`: mirrored, then scaled, then turned, then moved.
    pub(crate) fn map(&mut self, o: &Object) -> Built<DAffine3> {
        let f = &o.fields;
        let mut map = DAffine3::IDENTITY;
        if let Some(item) = f.get("mirror") {
            let normal = match &item.datum {
                Datum::Text(plane) => match plane.as_str() {
                    "xy" => DVec3::Z,
                    "yz" => DVec3::X,
                    _ => DVec3::Y,
                },
                _ => f
                    .record("mirror")
                    .and_then(|r| r.vector("normal"))
                    .unwrap_or(DVec3::Z),
            };
            let origin = f
                .record("mirror")
                .and_then(|r| r.vector("origin"))
                .unwrap_or(DVec3::ZERO);
            let plane = Frame::along(origin, normal).map_err(|e| {
                self.refuse(o, ("mirror", &[]), e, "give a normal that is not zero")
            })?;
            map = maps::mirror(&plane) * map;
        }
        if let Some(item) = f.get("scale") {
            let factors = match item.datum {
                Datum::Vector(v) => v,
                _ => DVec3::splat(item.number().unwrap_or(1.0)),
            };
            if factors.to_array().contains(&0.0) {
                let message = format!("the scale {factors} flattens space");
                return Err(self.refuse(o, ("scale", &[]), message, "use factors other than 0"));
            }
            map = DAffine3::from_scale(factors) * map;
        }
        if let Some(r) = f.record("rotate").cloned() {
            let axis = self.axis(&o.label, &r, "axis")?;
            map = maps::rotation(&axis, r.number("angle").unwrap_or(0.0)) * map;
        }
        if let Some(t) = f.vector("translate") {
            map = DAffine3::from_translation(t) * map;
        }
        Ok(map)
    }
}

/// Equally spaced knots on `[0, 1]` with full multiplicity at the ends. Wrong sizes give a list that the kernel
/// refuses with the numbers.
pub(crate) fn clamped_uniform(points: usize, degree: usize) -> Vec<f64> {
    let inner = points.saturating_sub(degree);
    let ends = (degree + 1).min(points);
    let mut knots = vec![0.0; ends];
    knots.extend((1..inner).map(|i| i as f64 / inner as f64));
    knots.resize(knots.len() + ends, 1.0);
    knots
}

pub(crate) fn spacing(f: &Fields) -> Spacing {
    match f.text("parametrization") {
        Some("centripetal") => Spacing::Centripetal,
        Some("uniform") => Spacing::Uniform,
        _ => Spacing::Chord,
    }
}

/// The key, the index and the remedy of an error in NURBS data of a curve.
pub(crate) fn nurbs_place(e: &NurbsError) -> (&'static str, Vec<usize>, &'static str) {
    match e {
        NurbsError::Knots(k) => {
            let (path, help) = knot_place(k);
            let key = match k {
                KnotError::Degree { .. } => "degree",
                KnotError::TooFewPoints { .. } => "points",
                _ => "knots",
            };
            (key, path, help)
        }
        NurbsError::PointNotFinite { index, .. } => {
            ("points", vec![*index], "use finite coordinates")
        }
        NurbsError::Weight { index, .. } => (
            "weights",
            vec![*index],
            "write a number greater than 0; the ratio of the weights is what matters",
        ),
        NurbsError::WeightCount { .. } => ("weights", vec![], "write one weight for each point"),
        NurbsError::NetSize { .. } => ("points", vec![], "let all rows have the same length"),
        NurbsError::Outside { .. } | NurbsError::Empty { .. } => {
            ("knots", vec![], "choose parameters of the curve")
        }
        NurbsError::Lower { .. } => ("degree", vec![], "choose a higher degree"),
    }
}

/// The index and the remedy of an error in knots.
pub(crate) fn knot_place(e: &KnotError) -> (Vec<usize>, &'static str) {
    match e {
        KnotError::Count { .. } => (
            vec![],
            "write points + degree + 1 knots, or none for clamped uniform ones",
        ),
        KnotError::TooFewPoints { .. } => (vec![], "add points or lower the degree"),
        KnotError::Degree { .. } => (vec![], "choose another degree"),
        KnotError::NotFinite { index, .. } => (vec![*index], "write finite numbers"),
        KnotError::Unsorted { index, .. } => (vec![*index], "sort the knots"),
        KnotError::Multiplicity { index, .. } => (
            vec![*index],
            "repeat an inner knot at most degree times, an end knot at most degree + 1 times",
        ),
        _ => (vec![], "change the knots"),
    }
}
