//! What is evaluated: a curve or a surface of a model.

use crate::table::Wanted;
use nappe::curve::CurveRef;
use nappe::surface::{SurfaceRef, jet_len};
use nappe::{DVec3, Interval, Limit};
use std::fmt;

/// What is wanted at each row of parameters.
#[derive(Clone, Debug, Default)]
pub(crate) struct Asked {
    /// The point and its derivatives up to this order.
    pub(crate) order: usize,
    /// The names of parameters of the model, each with the velocity of the target by it; none: it does not move.
    pub(crate) rates: Vec<(String, Option<Target>)>,
}

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

    /// Appends the coordinates of the point, of its derivatives, and of its velocities for each row of parameters. At a
    /// break the piece above it decides.
    pub(super) fn evaluate(
        &self,
        parameters: &[f64],
        grid: Option<&[Vec<f64>; 2]>,
        asked: &Asked,
        values: &mut Vec<f64>,
    ) {
        if asked.rates.is_empty() {
            return self.jets(parameters, grid, asked.order, values);
        }
        let rows = parameters.len() / self.parameters().len();
        let mut jets = Vec::new();
        self.jets(parameters, grid, asked.order, &mut jets);
        let velocity = |(_, of): &(String, Option<Target>)| match of {
            Some(of) => {
                let mut points = Vec::with_capacity(3 * rows);
                of.jets(parameters, grid, 0, &mut points);
                points
            }
            None => vec![0.0; 3 * rows],
        };
        let rates: Vec<Vec<f64>> = asked.rates.iter().map(velocity).collect();
        let width = jets.len() / rows;
        for (row, jet) in jets.chunks_exact(width).enumerate() {
            values.extend(jet);
            rates
                .iter()
                .for_each(|rate| values.extend(&rate[3 * row..3 * row + 3]));
        }
    }

    /// Appends the coordinates of the point and of its derivatives up to `order` for each row of parameters.
    fn jets(
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
