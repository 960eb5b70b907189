//! The names of the columns of a table of points and derivatives.

use super::target::{Asked, Target};
use crate::table::Column;

/// The columns of what evaluating a target gives.
pub(crate) fn columns(target: &Target, asked: &Asked) -> Vec<Column> {
    let names = names(target, asked).into_iter();
    names.map(Column::numbers).collect()
}

/// The parameters, then `x,y,z`, then the derivatives by order, each with the name of what it is taken by: `x_u`,
/// `x_uv`; then those by parameters of the model: `dx_dradius`.
pub(super) fn names(target: &Target, asked: &Asked) -> Vec<String> {
    const COORDINATES: [&str; 3] = ["x", "y", "z"];
    let mut names: Vec<String> = target.parameters().iter().map(|&p| p.to_owned()).collect();
    for order in 0..=asked.order {
        for by in derivatives(target, order) {
            for coordinate in COORDINATES {
                names.push(if order == 0 {
                    coordinate.to_owned()
                } else {
                    format!("{coordinate}_{by}")
                });
            }
        }
    }
    for (parameter, _) in &asked.rates {
        names.extend(COORDINATES.map(|c| format!("d{c}_d{parameter}")));
    }
    names
}

/// What the derivatives of one order are taken by, in the order in which jets hold them.
fn derivatives(target: &Target, order: usize) -> Vec<String> {
    match target {
        Target::Curve(..) => vec!["t".repeat(order)],
        Target::Surface(..) => (0..=order)
            .map(|j| "u".repeat(order - j) + &"v".repeat(j))
            .collect(),
    }
}
