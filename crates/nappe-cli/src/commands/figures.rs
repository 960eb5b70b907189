//! Figures of `nappe info` beyond area and volume: centroids, inertia, how surfaces bend.

use super::info::{error, measured};
use super::report::{certainty_json, measured_json};
use crate::text::{Table, bound, bound_below, number};
use nappe::measure::{Centroid, Developable, Inertia, Measured, RollingBall, Solid};
use nappe::mesh::Certainty;
use serde_json::{Value, json};

/// Where a centroid is.
pub(super) fn place(c: &Centroid, unit: &str) -> String {
    // Rounding leaves 1e-17 where 0 is meant.
    let size = c.point.abs().max_element();
    let coordinate = |x: f64| {
        let noise = x.abs() <= 1e-14 * size || x.abs() <= c.certainty.error();
        number(if noise { 0.0 } else { x }, 10)
    };
    let at = c.point.to_array().map(coordinate).join(", ");
    format!("({at}){} {unit}", error(c.certainty))
}

/// The rows on a solid.
pub(super) fn rows(head: &mut Table, solid: &Solid, unit: &str) {
    if let Some(centroid) = &solid.centroid {
        head.row(["centroid of the volume", &place(centroid, unit)]);
    }
    let Some(inertia) = &solid.inertia else {
        return;
    };
    for (k, (moment, axis)) in inertia.principal.iter().zip(inertia.axes).enumerate() {
        let name = if k == 0 { "principal moments" } else { "" };
        let about = match inertia.turned[k].error() {
            turned if turned < UNTOLD => {
                let axis = axis
                    .to_array()
                    .map(|x| number(if x.abs() < 1e-12 { 0.0 } else { x }, 5));
                format!(" about ({})", axis.join(", "))
            }
            _ => " about an axis that nothing tells from another".to_owned(),
        };
        head.row([name, &format!("{} {unit}⁵{about}", measured(*moment))]);
    }
}

/// Radians. An axis that may be off by more is not shown.
const UNTOLD: f64 = 0.1;

/// Whether a surface is developable, in a word.
pub(super) fn developable(d: Developable) -> &'static str {
    match d {
        Developable::Proven => "proven",
        Developable::Within(_) => "within the bound",
        Developable::InPieces(_) => "in pieces",
        Developable::No => "no",
        Developable::Unknown => "not known",
    }
}

/// An integral of curvature, to few digits. One that may be 0 is told by its bound.
pub(super) fn integral(m: Measured) -> String {
    if m.value.is_infinite() {
        return "∞".to_owned();
    }
    match m.certainty {
        Certainty::Bounded(e) if e >= m.value => format!("≤ {}", bound(m.value + e, 2)),
        _ => format!("{}{}", number(m.value, 6), error(m.certainty)),
    }
}

/// The radius of the ball that fits; any, if that is larger than a length.
pub(super) fn room(ball: RollingBall, huge: f64) -> String {
    if ball.at_least >= huge {
        return "any".to_owned();
    }
    let found = if ball.radius.is_infinite() {
        "any found".to_owned()
    } else {
        number(ball.radius, 5)
    };
    if ball.radius == 0.0 {
        return "none".to_owned();
    }
    if ball.at_least == 0.0 {
        return format!("{found} (sampled)");
    }
    format!("{found}, at least {}", bound_below(ball.at_least, 4))
}

/// The smallest of several balls, and what fits everywhere.
pub(super) fn smallest(balls: Vec<RollingBall>) -> Option<RollingBall> {
    let least = balls
        .iter()
        .map(|b| b.at_least)
        .fold(f64::INFINITY, f64::min);
    let ball = balls
        .into_iter()
        .min_by(|a, b| a.radius.total_cmp(&b.radius))?;
    Some(RollingBall {
        at_least: least,
        ..ball
    })
}

pub(super) fn ball_json(b: RollingBall) -> Value {
    // JSON has no infinity.
    let finite = |x: f64| Some(x).filter(|x| x.is_finite());
    json!({
        "radius": finite(b.radius),
        "any": b.at_least.is_infinite(),
        "at_least": finite(b.at_least),
        "uv": b.uv,
    })
}

pub(super) fn balls_json([front, back]: [RollingBall; 2]) -> Value {
    json!({ "normal_side": ball_json(front), "behind": ball_json(back) })
}

pub(super) fn centroid_json(c: Centroid) -> Value {
    json!({ "point": c.point.to_array(), "certainty": certainty_json(c.certainty) })
}

pub(super) fn inertia_json(i: Inertia) -> Value {
    json!({
        "tensor": i.tensor.map(|row| row.map(measured_json)),
        "principal": i.principal.map(measured_json),
        "axes": i.axes.map(|a| a.to_array()),
        "axes_turned_by_radians": i.turned.map(certainty_json),
    })
}
