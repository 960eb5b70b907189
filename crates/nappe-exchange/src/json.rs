//! The exact curves and surfaces as JSON.
//!
//! ```json
//! {
//!   "nappe_exact": 1,
//!   "title": "Dome",
//!   "units": "mm",
//!   "curves": [{
//!     "name": "profile", "kind": "bezier", "exactness": {"is": "exact"},
//!     "degree": 2, "knots": [0, 0, 0, 1, 1, 1], "points": [[20, 0, 0], [12, 0, 17], [0, 0, 35]], "weights": [1, 0.7, 1]
//!   }],
//!   "surfaces": [{
//!     "name": "dome", "kind": "revolution", "exactness": {"is": "bounded", "by": 1e-9},
//!     "degree": [2, 1], "knots_u": [0, 0, 0, 1, 1, 1], "knots_v": [0, 0, 1, 1],
//!     "points": [[[0, 0, 0], [0, 1, 0]], [[1, 0, 0], [1, 1, 0]], [[2, 0, 0], [2, 1, 0]]]
//!   }],
//!   "missing": ["hull"]
//! }
//! ```
//!
//! The keys are those of the model file's `nurbs` curves and surfaces. `points` are Cartesian, of a surface rows along
//! u; `weights` have the same shape and are absent if all are 1; `knots` are full vectors. `exactness` says how far the
//! NURBS is from the object: `exact` (rounding only), `bounded` (proven, at most `by`, in units) or `estimated`.
//! `missing` names the objects that have no NURBS form. Each number is the shortest decimal that reads back as the
//! same f64 (at most 17 significant digits).

use crate::error::SceneError;
use crate::report::Tally;
use crate::scene::{Exact, ExactForm, Scene};
use glam::DVec3;
use nappe::mesh::Certainty;
use serde::Serialize;
use std::io::{self, Write};

#[derive(Serialize)]
struct Document<'a> {
    nappe_exact: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    title: Option<&'a str>,
    units: &'a str,
    curves: Vec<Curve<'a>>,
    surfaces: Vec<Surface<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    missing: Vec<&'a str>,
}

#[derive(Serialize)]
struct Curve<'a> {
    name: &'a str,
    kind: &'a str,
    exactness: Exactness,
    same_parameters: bool,
    degree: usize,
    knots: &'a [f64],
    points: Vec<[f64; 3]>,
    #[serde(skip_serializing_if = "Option::is_none")]
    weights: Option<Vec<f64>>,
}

#[derive(Serialize)]
struct Surface<'a> {
    name: &'a str,
    kind: &'a str,
    exactness: Exactness,
    same_parameters: bool,
    degree: [usize; 2],
    knots_u: &'a [f64],
    knots_v: &'a [f64],
    points: Vec<Vec<[f64; 3]>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    weights: Option<Vec<Vec<f64>>>,
}

#[derive(Serialize)]
#[serde(tag = "is", content = "by", rename_all = "lowercase")]
enum Exactness {
    Exact,
    Bounded(f64),
    Estimated(f64),
}

impl From<Certainty> for Exactness {
    fn from(c: Certainty) -> Exactness {
        match c {
            Certainty::Exact => Exactness::Exact,
            Certainty::Bounded(e) => Exactness::Bounded(e),
            Certainty::Estimated(e) => Exactness::Estimated(e),
        }
    }
}

/// Checks that every number can be written: JSON has no infinity.
pub(crate) fn validate(scene: &Scene) -> Result<(), SceneError> {
    for Exact { name, form, .. } in &scene.exact {
        let (points, weights) = match form {
            ExactForm::Curve(c) => (c.control_points(), c.weights()),
            ExactForm::Surface(s) => (s.control_points(), s.weights()),
            ExactForm::None => continue,
        };
        for (index, (point, weight)) in points.into_iter().zip(weights).enumerate() {
            if !(point.is_finite() && weight.is_finite()) {
                return Err(SceneError::ExactNotFinite {
                    name: name.clone(),
                    index,
                    point,
                    weight,
                });
            }
        }
    }
    Ok(())
}

pub(crate) fn write(scene: &Scene, out: &mut dyn Write) -> io::Result<Tally> {
    let (mut curves, mut surfaces, mut missing) = (Vec::new(), Vec::new(), Vec::new());
    for Exact {
        name,
        kind,
        form,
        certainty,
        same_parameters,
    } in &scene.exact
    {
        let exactness = Exactness::from(*certainty);
        match form {
            ExactForm::Curve(c) => curves.push(Curve {
                name,
                kind,
                exactness,
                same_parameters: *same_parameters,
                degree: c.degree(),
                knots: c.knots(),
                points: c.control_points().iter().map(DVec3::to_array).collect(),
                weights: c.is_rational().then(|| c.weights()),
            }),
            ExactForm::Surface(s) => {
                let columns = s.size()[1].max(1);
                let points: Vec<_> = s.control_points().iter().map(DVec3::to_array).collect();
                surfaces.push(Surface {
                    name,
                    kind,
                    exactness,
                    same_parameters: *same_parameters,
                    degree: [s.basis_u().degree(), s.basis_v().degree()],
                    knots_u: s.basis_u().knots(),
                    knots_v: s.basis_v().knots(),
                    points: points.chunks(columns).map(<[_]>::to_vec).collect(),
                    weights: s
                        .is_rational()
                        .then(|| s.weights().chunks(columns).map(<[_]>::to_vec).collect()),
                });
            }
            ExactForm::None => missing.push(name.as_str()),
        }
    }
    let mut tally = Tally::default();
    if !missing.is_empty() {
        tally
            .notes
            .push(format!("No NURBS form exists for: {}.", missing.join(", ")));
    }
    let (title, units) = (scene.title.as_deref(), scene.units.symbol());
    let document = Document {
        nappe_exact: 1,
        title,
        units,
        curves,
        surfaces,
        missing,
    };
    serde_json::to_writer_pretty(&mut *out, &document)?;
    writeln!(out)?;
    Ok(tally)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{WriteOptions, write};
    use nappe::exact::{NurbsCurve, NurbsSurface};

    fn exact(name: &str, form: ExactForm, certainty: Certainty) -> Exact {
        Exact {
            name: name.into(),
            kind: "nurbs".into(),
            form,
            certainty,
            same_parameters: true,
        }
    }

    #[test]
    fn numbers_come_back_bit_for_bit_and_rows_run_along_u() {
        let points: Vec<DVec3> = (0..6)
            .map(|k| DVec3::new(k as f64 / 3.0, 1e-17 * k as f64, 1e22 / (k as f64 + 0.1)))
            .collect();
        let knots = [vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0], vec![0.1, 0.1, 0.7, 0.7]];
        let surface = NurbsSurface::new([2, 1], knots.clone(), &points, None).unwrap();
        let weights = [1.0, 0.5f64.sqrt(), 1.0];
        let arc = [DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Y];
        let curve = NurbsCurve::new(2, knots[0].clone(), &arc, Some(&weights)).unwrap();
        let scene = Scene {
            exact: vec![
                exact("s", ExactForm::Surface(surface), Certainty::Bounded(1e-9)),
                exact("c", ExactForm::Curve(curve), Certainty::Exact),
                exact("hull", ExactForm::None, Certainty::Exact),
            ],
            ..Scene::default()
        };
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("a.json");
        let report = write(&path, &scene, &WriteOptions::default()).unwrap();
        assert_eq!(report.notes, ["No NURBS form exists for: hull."]);
        let read: serde_json::Value =
            serde_json::from_reader(std::fs::File::open(&path).unwrap()).unwrap();
        let s = &read["surfaces"][0];
        for (k, p) in points.iter().enumerate() {
            let q = &s["points"][k / 2][k % 2];
            assert_eq!([0, 1, 2].map(|c| q[c].as_f64().unwrap()), p.to_array());
        }
        assert_eq!(s["knots_v"], serde_json::json!([0.1, 0.1, 0.7, 0.7]));
        assert_eq!(
            s["exactness"],
            serde_json::json!({"is": "bounded", "by": 1e-9})
        );
        assert!(s.get("weights").is_none());
        let c = &read["curves"][0];
        assert_eq!(c["exactness"], serde_json::json!({"is": "exact"}));
        assert_eq!(c["weights"][1].as_f64(), Some(weights[1]));
        assert_eq!(read["missing"][0], "hull");
    }
}
