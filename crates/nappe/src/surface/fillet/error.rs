//! What can be wrong with a fillet.

use crate::curve::CurveError;
use crate::significant;
use glam::DVec3;
use thiserror::Error;

fn ordinal(index: usize) -> &'static str {
    ["first", "second"][index]
}

fn place_of(p: DVec3) -> String {
    let [x, y, z] = p.to_array().map(|x| significant(x, 6));
    format!("({x}, {y}, {z})")
}

fn list(all: &[DVec3]) -> String {
    let all: Vec<String> = all.iter().map(|p| place_of(*p)).collect();
    all.join(", ")
}

fn other_radius(fits: Option<(f64, DVec3)>) -> String {
    match fits {
        None => " (looked for at samples of both)".into(),
        Some((r, p)) => format!(
            ": one of radius {} does about {} (estimated)",
            significant(r, 4),
            place_of(p)
        ),
    }
}

fn why_lost(tight: Option<(usize, f64)>) -> String {
    match tight {
        None => "the surfaces touch each other, or one has a crease or a pole there".into(),
        Some((index, largest)) => format!(
            "the {} surface is curved there nearly as much as the ball (its radius is {})",
            ordinal(index),
            significant(largest, 4)
        ),
    }
}

/// What can be wrong with a fillet.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FilletError {
    /// No ball was found that touches both surfaces.
    #[error("no ball of radius {radius} touches both surfaces on these sides{}", other_radius(*fits))]
    NoBall {
        /// The radius, where u = 0.5.
        radius: f64,
        /// Another radius for which one was found, the nearest by samples, and its centre.
        fits: Option<(f64, DVec3)>,
    },
    /// Several fillets, of which none is chosen.
    #[error(
        "{count} fillets lie between these surfaces, about {}: say near which point",
        list(places)
    )]
    Several {
        /// How many were found.
        count: usize,
        /// The middle of the centre's path of each.
        places: Vec<DVec3>,
    },
    /// The ball cuts into a support that is curved more than the ball.
    #[error(
        "a ball of radius {radius} cuts into the {} surface about {}: at most {largest} fits there", ordinal(*index), place_of(*place)
    )]
    CutsIn {
        /// 0 or 1.
        index: usize,
        /// The ball's centre.
        place: DVec3,
        /// The radius there.
        radius: f64,
        /// The radius of curvature of the surface there.
        largest: f64,
    },
    /// The ball touches a support where it should, and cuts through another part of it.
    #[error(
        "at u = {at}, about {}, the ball of radius {radius} cuts {} deep into another part of the {} surface than the one it touches", place_of(*place), significant(*depth, 4), ordinal(*index)
    )]
    CutsThrough {
        /// 0 or 1.
        index: usize,
        /// The parameter.
        at: f64,
        /// The ball's centre.
        place: DVec3,
        /// The radius there.
        radius: f64,
        /// How much nearer to the centre than the radius a point of the surface is.
        depth: f64,
    },
    /// The ball could not be followed.
    #[error("a ball of radius {radius} cannot be followed beyond {}: {}", place_of(*place), why_lost(*tight))]
    Lost {
        /// The ball's centre.
        place: DVec3,
        /// The radius there.
        radius: f64,
        /// The surface, 0 or 1, that is curved there nearly as much as the ball, with its radius of curvature.
        tight: Option<(usize, f64)>,
    },
    /// The ball would roll over a crease.
    #[error(
        "the ball rolls over a crease of the {} surface at {}, where its normal turns by {angle} radians", ordinal(*index), place_of(*place)
    )]
    Crease {
        /// 0 or 1.
        index: usize,
        /// Where, on the surface.
        place: DVec3,
        /// The angle between the normals on both sides, in radians.
        angle: f64,
    },
    /// The contacts could not be enclosed.
    #[error("at u = {at}, about {}, it cannot be proven that the ball touches both surfaces: they are nearly tangent there, or too uneven", place_of(*place))]
    Unproven {
        /// The parameter.
        at: f64,
        /// The ball's centre.
        place: DVec3,
    },
    /// A contact leaves its support inside of the path, or runs along a line where the support's formula changes.
    #[error("at u = {at}, about {}, the contact with the {} surface leaves it and comes back, or runs along an end of one of its pieces: make the surface larger, move its knots, or change the radius", place_of(*place), ordinal(*index))]
    Leaves {
        /// 0 or 1.
        index: usize,
        /// The parameter.
        at: f64,
        /// The ball's centre.
        place: DVec3,
    },
    /// The path closes, the radius does not.
    #[error(
        "the path of the ball closes, but its radius is {from} at u = 0 and {to} at u = 1: make them equal, by a function of period 1"
    )]
    Unclosed {
        /// The radius at u = 0.
        from: f64,
        /// The radius at u = 1.
        to: f64,
    },
    /// The point near which a fillet is chosen is not finite.
    #[error("the point near the fillet is ({}, {}, {}): it must be finite", near.x, near.y, near.z)]
    Near {
        /// The point.
        near: DVec3,
    },
    /// A part of a traced fillet.
    #[error(
        "a range is given, but only fillets between two planes, and between a plane and a whole cylinder, are made in part"
    )]
    RangeOfTraced,
    /// No guide could be put through the path of the ball.
    #[error("the path of the ball is too uneven: {0}")]
    Guide(CurveError),
    /// The planes do not meet.
    #[error(
        "the planes are parallel (the sine of their angle is {}): they have no edge to fillet", significant(*sine, 3)
    )]
    Parallel {
        /// The sine of the angle between them.
        sine: f64,
    },
    /// The radius is not positive and finite.
    #[error("the radius is {value} at u = {at}: it must be a positive, finite number")]
    Radius {
        /// The parameter.
        at: f64,
        /// The radius there.
        value: f64,
    },
    /// A radius function with more or less than one value, or another domain.
    #[error(
        "the radius must be one function of u on [0, 1]: {count} functions on [{from}, {to}] are given"
    )]
    RadiusFunction {
        /// How many functions it is.
        count: usize,
        /// Where its domain begins.
        from: f64,
        /// Where its domain ends.
        to: f64,
    },
    /// The ball does not fit, or its contact leaves a support.
    #[error("the radius {radius} at u = {at} is too large: at most {largest} fits there")]
    TooLarge {
        /// The parameter.
        at: f64,
        /// The radius there.
        radius: f64,
        /// The greatest radius that fits.
        largest: f64,
    },
    /// The plane is too far from the cylinder for this ball.
    #[error(
        "the radius {radius} at u = {at} does not reach from the plane to the cylinder: more than {least} is needed"
    )]
    TooSmall {
        /// The parameter.
        at: f64,
        /// The radius there.
        radius: f64,
        /// What it must exceed.
        least: f64,
    },
    /// The supports do not extend to this side of their edge.
    #[error(
        "the {} surface does not extend to the side where the ball touches it: choose another side (front is where its normals point)",
        ordinal(*index)
    )]
    Side {
        /// 0 or 1.
        index: usize,
    },
    /// The plane and the cylinder do not come together on the given sides.
    #[error(
        "no ball touches both on these sides: the cylinder's axis is {height} from the plane, on the side of the ball if positive"
    )]
    NoContact {
        /// The height of the axis over the plane, positive on the ball's side.
        height: f64,
    },
    /// The supports do not lie beside a common part of their edge.
    #[error(
        "the supports do not lie beside a common part of their edge: the first ends {gap} before the second begins"
    )]
    Apart {
        /// How far apart they are along the edge.
        gap: f64,
    },
    /// The range of the fillet is empty, not finite, or more than one turn.
    #[error(
        "the range is {from} to {to}: it must increase and be finite, and be at most one turn round a cylinder"
    )]
    Range {
        /// The first value.
        from: f64,
        /// The last value.
        to: f64,
    },
    /// The radius changes faster than the ball moves.
    #[error(
        "the radius changes too fast at u = {at}: each ball swallows the next (|c'|² - r'² is {margin})"
    )]
    Swallowed {
        /// The parameter.
        at: f64,
        /// The quantity that must be positive.
        margin: f64,
    },
    /// Sections cross: the path bends or the radius changes more sharply than the ball can follow.
    #[error(
        "the sections cross at u = {at}: the path bends or the radius changes too sharply for a ball of radius {radius}"
    )]
    SectionsCross {
        /// The parameter.
        at: f64,
        /// The radius there.
        radius: f64,
    },
}
