//! What is evaluated: a curve or a surface of a model.

use crate::table::Wanted;
use nappe::curve::CurveRef;
use nappe::surface::{SurfaceRef, jet_len};
use nappe::{DVec3, Interval, Limit};
use std::fmt;

/// A named curve or surface.
#[derive(Clone, Debug)]
pub(crate) enum Target {
    Curve(String, CurveRef),
    Surface(String, SurfaceRef),
}

impl Target {
    /// The names of its parameters.
    pub(crate) fn parameters(&self) -> &'static [&'static str] {
        match self {
            Target::Curve(..) => &["t"],
            Target::Surface(..) => &["u", "v"],
        }
    }

    /// What a table of parameters must have.
    pub(crate) fn wanted(&self) -> Wanted {
        Wanted {
            columns: self.parameters(),
            what: "parameters",
            purpose: format!("{self} is evaluated at {}", self.parameters().join(", ")),
            option: "--uv",
            others: false,
        }
    }

    /// The range of each parameter.
    pub(crate) fn domain(&self) -> Vec<Interval> {
        match self {
            Target::Curve(_, c) => vec![c.domain()],
            Target::Surface(_, s) => s.domain().to_vec(),
        }
    }

    /// Appends the coordinates of the point and of its derivatives up to `order` for each row of parameters. At a
    /// break the piece above it decides.
    pub(super) fn evaluate(
        &self,
        parameters: &[f64],
        grid: Option<&[Vec<f64>; 2]>,
        order: usize,
        values: &mut Vec<f64>,
    ) {
        let mut put = |points: &[DVec3]| values.extend(points.iter().flat_map(|p| p.to_array()));
        match self {
            Target::Curve(_, c) if order == 0 => {
                let mut points = vec![DVec3::ZERO; parameters.len()];
                c.points(parameters, &mut points);
                put(&points);
            }
            Target::Curve(_, c) => {
                let mut jet = vec![DVec3::ZERO; order + 1];
                for &t in parameters {
                    c.jet_into(t, Limit::Above, &mut jet);
                    put(&jet);
                }
            }
            Target::Surface(_, s) => {
                let (uv, _) = parameters.as_chunks::<2>();
                let mut points = vec![DVec3::ZERO; uv.len() * jet_len(order)];
                match grid {
                    Some([u, v]) => s.grid_jets(u, v, order, &mut points),
                    None => s.jets(uv, order, &mut points),
                }
                put(&points);
            }
        }
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Target::Curve(name, _) => write!(f, "the curve `{name}`"),
            Target::Surface(name, _) => write!(f, "the surface `{name}`"),
        }
    }
}
