//! The kinds of surfaces: from data to geometry.

use crate::build::{Builder, Built, Patch, Stop};
use crate::curves::{clamped_uniform, knot_place, need, nurbs_place};
use crate::data::Object;
use crate::round::rows;
use nappe::DVec3;
use nappe::basis::KnotError;
use nappe::exact::{NurbsError, NurbsSurface, bad_weights};
use nappe::surface::{
    BiquadraticError, Construction, Dir, HermiteData, Revolution, RevolutionError,
    RevolutionOptions, Surface, SurfaceRef, TransformError, Transformed, bilinear, biquadratic,
    hermite, ruled,
};
use std::f64::consts::TAU;
use std::sync::Arc;

type Square = [[DVec3; 2]; 2];

impl Builder<'_> {
    /// Builds what a surface object makes: one surface, or several parts.
    pub(crate) fn surface_of(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let f = &o.fields;
        match o.kind.name {
            "bilinear" => {
                let corners = square(o, "corners")?;
                let surface = bilinear(corners)
                    .map_err(|e| self.refuse(o, ("corners", &[]), e, "use finite coordinates"))?;
                Ok(netted(surface, Some(corners.map(|r| r.to_vec()).to_vec())))
            }
            "ruled" => self.ruled(o),
            "hermite" => {
                let twists = if f.get("twists").is_some() {
                    square(o, "twists")?
                } else {
                    Square::default()
                };
                let data = HermiteData {
                    corners: square(o, "corners")?,
                    tangents_u: square(o, "tangents_u")?,
                    tangents_v: square(o, "tangents_v")?,
                    twists,
                };
                let surface = hermite(&data)
                    .map_err(|e| self.refuse(o, ("corners", &[]), e, "use finite coordinates"))?;
                Ok(Patch::one(Arc::new(surface)))
            }
            "bezier" | "nurbs" => self.net(o),
            "biquadratic" => self.biquadratic(o),
            "revolution" => Ok(Patch::one(Arc::new(self.revolution(o)?))),
            "rational" => self.rational(o),
            "fillet" => self.fillet(o),
            "blend" => self.blend_between(o),
            "coons" => self.coons(o),
            "diagonal-key" => self.diagonal_key(o),
            "quadric" => {
                let quadric = self.quadric(o)?;
                let net = rows(quadric.nurbs());
                Ok(netted(quadric, Some(net)))
            }
            "torus" => {
                let torus = self.torus(o)?;
                let net = rows(torus.nurbs());
                Ok(netted(torus, Some(net)))
            }
            "transform" => self.transform(o),
            "join" => self.join(o),
            "import" => self.imported_surface(o),
            other => Err(self.refuse(
                o,
                ("", &[]),
                format!("the kind \"{other}\" is not built"),
                "use another kind",
            )),
        }
    }

    fn ruled(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let (keys, along) = match o.fields.get("south") {
            Some(_) => (["south", "north"], Dir::U),
            None => (["west", "east"], Dir::V),
        };
        let rails = keys.map(|k| self.curve_key(o, k));
        let [first, second] = rails;
        let (first, second) = (first?, second?);
        let surface = ruled(first, second, along)
            .map_err(|e| self.refuse(o, (keys[0], &[]), e, "use curves with finite points"))?;
        Ok(Patch::one(Arc::new(surface)))
    }

    /// A Bézier or NURBS surface from its net.
    fn net(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let f = &o.fields;
        let rows = need(f.vector_rows("points"))?;
        let columns = rows.first().map_or(0, Vec::len);
        let points: Vec<DVec3> = rows.iter().flatten().copied().collect();
        let weights = self.weights(o, rows.len(), columns)?;
        let surface = if o.kind.name == "bezier" {
            if rows.len() < 2 || columns < 2 {
                let message = format!(
                    "a net of {} × {columns} points; at least 2 × 2 are needed",
                    rows.len()
                );
                return Err(self.refuse(o, ("points", &[]), message, "add rows or columns"));
            }
            NurbsSurface::bezier(rows.len(), &points, weights.as_deref())
        } else {
            let degree = need(f.numbers("degree"))?;
            let [p, q] = [degree[0] as usize, degree[1] as usize];
            for (direction, count, degree, which) in
                [("rows", rows.len(), p, 0), ("columns", columns, q, 1)]
            {
                if count <= degree {
                    let message =
                        format!("{count} {direction} of points are too few for degree {degree}");
                    let help = format!(
                        "give at least {} {direction}, or lower the degree",
                        degree + 1
                    );
                    return Err(self.refuse(o, ("degree", &[which]), message, help));
                }
            }
            let knots_u = f
                .numbers("knots_u")
                .unwrap_or_else(|| clamped_uniform(rows.len(), p));
            let knots_v = f
                .numbers("knots_v")
                .unwrap_or_else(|| clamped_uniform(columns, q));
            // One direction at a time, so that an error is known to be of u or of v.
            for (key, degree, count, knots) in [
                ("knots_u", p, rows.len(), &knots_u),
                ("knots_v", q, columns, &knots_v),
            ] {
                if knots.len() != count + degree + 1 {
                    let e = KnotError::Count {
                        points: count,
                        degree,
                        knots: knots.len(),
                    };
                    let (path, help) = knot_place(&e);
                    return Err(self.refuse(o, (key, &path), format!("`{key}`: {e}"), help));
                }
                if let Err(e) = nappe::basis::BSplineBasis::new(degree, knots.clone()) {
                    let (path, help) = knot_place(&e);
                    let key = if matches!(e, KnotError::Degree { .. }) {
                        "degree"
                    } else {
                        key
                    };
                    return Err(self.refuse(o, (key, &path), format!("`{key}`: {e}"), help));
                }
            }
            NurbsSurface::new([p, q], [knots_u, knots_v], &points, weights.as_deref())
        };
        let surface = surface.map_err(|e| self.net_error(o, &e, columns))?;
        Ok(netted(surface, Some(rows)))
    }

    /// The weights of a net, row by row.
    pub(crate) fn weights(
        &mut self,
        o: &Object,
        rows: usize,
        columns: usize,
    ) -> Built<Option<Vec<f64>>> {
        let Some(weights) = o.fields.number_rows("weights") else {
            return Ok(None);
        };
        if weights.len() != rows || weights.iter().any(|r| r.len() != columns) {
            let found = (weights.len(), weights.first().map_or(0, Vec::len));
            let message = format!(
                "{} × {} weights are given for {rows} × {columns} points",
                found.0, found.1
            );
            return Err(self.refuse(
                o,
                ("weights", &[]),
                message,
                "write one weight for each point, in the same rows",
            ));
        }
        let weights: Vec<f64> = weights.into_iter().flatten().collect();
        // The first bad weight is told when the surface is made.
        for e in bad_weights(&weights).skip(1) {
            self.net_error(o, &e, columns);
        }
        Ok(Some(weights))
    }

    /// An error of a net: the kernel counts along rows.
    pub(crate) fn net_error(&mut self, o: &Object, e: &NurbsError, columns: usize) -> Stop {
        let columns = columns.max(1);
        match e {
            NurbsError::Weight { index, value } => {
                let (row, column) = (index / columns, index % columns);
                let message = format!(
                    "weights[{row}][{column}] is {value}: weights must be positive, finite numbers"
                );
                self.refuse(
                    o,
                    ("weights", &[row, column]),
                    message,
                    "write a number greater than 0",
                )
            }
            NurbsError::PointNotFinite { index, point } => {
                let (row, column) = (index / columns, index % columns);
                let message =
                    format!("points[{row}][{column}] is {point}: coordinates must be finite");
                self.refuse(
                    o,
                    ("points", &[row, column]),
                    message,
                    "use finite coordinates",
                )
            }
            e => {
                let (key, path, help) = nurbs_place(e);
                self.refuse(o, (key, &path), e, help)
            }
        }
    }

    fn biquadratic(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let f = &o.fields;
        let rows = need(f.vector_rows("points"))?;
        let mut points = [[DVec3::ZERO; 3]; 3];
        for (to, from) in points.iter_mut().zip(&rows) {
            to.copy_from_slice(from);
        }
        let weights = [need(f.number("weight_u"))?, need(f.number("weight_v"))?];
        let surface = biquadratic(&points, weights[0], weights[1]).map_err(|e| match &e {
            BiquadraticError::Weight { name, .. } => {
                let key = if name.starts_with("weight_v") {
                    "weight_v"
                } else {
                    "weight_u"
                };
                self.refuse(o, (key, &[]), e, "write a number greater than 0")
            }
            BiquadraticError::NotFinite { row, column, .. } => {
                self.refuse(o, ("points", &[*row, *column]), e, "use finite coordinates")
            }
        })?;
        Ok(netted(surface, Some(rows)))
    }

    /// A surface of revolution.
    pub(crate) fn revolution(&mut self, o: &Object) -> Built<Revolution> {
        let f = &o.fields;
        let axis = self.axis(&o.label, f, "axis")?;
        let profile = self.curve_key(o, "profile")?;
        let mu = f.record("section").and_then(|s| s.number("conic"));
        let construction = match (mu, f.text("construction")) {
            (Some(_), Some(word @ ("angle" | "coons"))) => {
                let message = format!("a section by μ is always rational, not \"{word}\"");
                return Err(self.refuse(
                    o,
                    ("construction", &[]),
                    message,
                    "remove `construction` or `section`",
                ));
            }
            (Some(mu), _) => Construction::Conic { mu },
            (None, Some("rational")) => Construction::Rational,
            (None, Some("coons")) => Construction::Coons,
            (None, _) => Construction::Angle,
        };
        // Grigoriev's sections are a quarter unless an angle is given.
        let whole = if mu.is_some() { TAU / 4.0 } else { TAU };
        let options = RevolutionOptions {
            start: f.number("start").unwrap_or(0.0),
            angle: f.number("angle").unwrap_or(whole),
            construction,
        };
        Revolution::new(profile, axis, options).map_err(|e| self.revolution_error(o, &e))
    }

    pub(crate) fn revolution_error(&mut self, o: &Object, e: &RevolutionError) -> Stop {
        let (key, help) = match e {
            RevolutionError::Angle { .. } => {
                ("angle", "write an angle above 0deg and up to 360deg")
            }
            RevolutionError::Quarters { .. } => ("angle", "write 90deg, 180deg, 270deg or 360deg"),
            RevolutionError::Start { .. } => ("start", "write a finite angle"),
            RevolutionError::Mu { .. } => ("section", "write { conic = 0.5 } for a circle"),
            RevolutionError::Crosses { .. } => (
                "profile",
                "trim the profile at the axis, or move it to one side",
            ),
            RevolutionError::OnAxis { .. } => ("profile", "leave out the part on the axis"),
            RevolutionError::Point { .. } => ("profile", "use a profile of some length"),
            RevolutionError::NotFinite { .. } => ("profile", "use a profile with finite points"),
            RevolutionError::Coons(_) => (
                "construction",
                "use the construction \"angle\", which needs no sectors",
            ),
        };
        self.refuse(o, (key, &[]), e, help)
    }

    fn transform(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let map = self.map(o)?;
        let name = need(o.fields.text("surface"))?.to_owned();
        let span = o.fields.place("surface", &[]);
        let label = format!("{}, `surface`", o.label);
        let sources = if name.contains('/') {
            Arc::new(Patch::one(self.surface(&name, &label, &span)?))
        } else {
            self.patches(&name, &label, &span)?
        };
        let mut patches = Vec::with_capacity(sources.len());
        for p in sources.iter() {
            let surface = Transformed::new(p.surface.clone(), map).map_err(|e| {
                let key = ["scale", "mirror", "rotate"]
                    .into_iter()
                    .find(|k| o.fields.get(k).is_some());
                let help = match e {
                    TransformError::Flattens { .. } => "use factors that are not 0",
                    _ => "use numbers of a reasonable size",
                };
                self.refuse(o, (key.unwrap_or("translate"), &[]), e, help)
            })?;
            let net = p.net.as_ref().map(|rows| {
                rows.iter()
                    .map(|r| r.iter().map(|p| map.transform_point3(*p)).collect())
                    .collect()
            });
            patches.push(Patch {
                suffix: p.suffix.clone(),
                surface: Arc::new(surface),
                net,
            });
        }
        Ok(patches)
    }
}

/// A 2 × 2 table of vectors.
pub(crate) fn square(o: &Object, key: &str) -> Built<Square> {
    let rows = need(o.fields.vector_rows(key))?;
    match rows.as_slice() {
        [a, b] if a.len() == 2 && b.len() == 2 => Ok([[a[0], a[1]], [b[0], b[1]]]),
        _ => Err(Stop::Reported),
    }
}

/// One surface with its net.
fn netted<S: Surface + 'static>(surface: S, net: Option<Vec<Vec<DVec3>>>) -> Vec<Patch> {
    let surface: SurfaceRef = Arc::new(surface);
    vec![Patch {
        suffix: None,
        surface,
        net,
    }]
}
