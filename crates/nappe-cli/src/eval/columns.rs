//! The names of the columns of a table of points and derivatives.

use super::target::Target;
use crate::table::Column;
use nappe::surface::jet_len;

/// The columns of what evaluating a target up to `order` gives.
pub(crate) fn columns(target: &Target, order: usize) -> Vec<Column> {
    let values = match target {
        Target::Curve(..) => order + 1,
        Target::Surface(..) => jet_len(order),
    };
    let names = names(target, 3 * values).into_iter();
    names.map(Column::numbers).collect()
}

/// The parameters, then `x,y,z`, then the derivatives by order, each with the name of what it is taken by: `x_u`,
/// `x_uv`. As many as there are `values` numbers in a row.
pub(super) fn names(target: &Target, values: usize) -> Vec<String> {
    let mut names: Vec<String> = target.parameters().iter().map(|&p| p.to_owned()).collect();
    let all = names.len() + values;
    let mut order = 0;
    while names.len() < all {
        for by in derivatives(target, order) {
            for coordinate in ["x", "y", "z"] {
                names.push(if order == 0 {
                    coordinate.to_owned()
                } else {
                    format!("{coordinate}_{by}")
                });
            }
        }
        order += 1;
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
