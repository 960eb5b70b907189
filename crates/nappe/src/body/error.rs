//! What can be wrong with a body.

use glam::DVec3;
use thiserror::Error;

/// What can be wrong with a body.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BodyError {
    /// An index is out of range.
    #[error("{what} {index} is named, but there are only {count}")]
    Index {
        /// What is named.
        what: &'static str,
        /// The index.
        index: usize,
        /// How many there are.
        count: usize,
    },
    /// A vertex has a coordinate that is NaN or infinite.
    #[error("vertex {vertex} is at {point}: coordinates must be finite numbers")]
    Point {
        /// The vertex.
        vertex: usize,
        /// Where it is.
        point: DVec3,
    },
    /// The tolerance of an edge is infinite, NaN or negative.
    #[error(
        "edge {edge} has the tolerance {tolerance:e}: it must be a finite number that is not negative"
    )]
    Tolerance {
        /// The edge.
        edge: usize,
        /// Its tolerance.
        tolerance: f64,
    },
    /// The curve of an edge does not end at its vertex.
    #[error("edge {edge} {} {distance:e} away from its vertex, more than {allowed:e}", if *.end == 0 { "starts" } else { "ends" })]
    End {
        /// The edge.
        edge: usize,
        /// 0 at the start, 1 at the end.
        end: usize,
        /// How far the curve ends from the vertex.
        distance: f64,
        /// How far it may.
        allowed: f64,
    },
    /// The edges of a loop do not join.
    #[error("loop {number} of face {face} {}", match .after { Some(i) => format!("is open after its edge {i}"), None => "has no edges".into() })]
    Open {
        /// The face.
        face: usize,
        /// The loop in it.
        number: usize,
        /// The coedge after which it is open; `None` if it has none.
        after: Option<usize>,
    },
}
