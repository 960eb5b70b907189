//! Faces that are the whole of their surface.

use nappe::body::{Body, Loop};
use nappe::curve::{CurveRef, Isocurve};
use nappe::query::{Finder, FinderOptions};
use nappe::surface::Side;
use std::sync::Arc;

/// Places in each piece of an edge that are looked at.
const PLACES: usize = 8;

/// Whether a face is the whole of its surface: it has no loops, or these run along the surface's sides (seams among them)
/// only, within `tolerance` (a length) and the tolerance of the edges. Edges are looked at in some points of each piece.
/// Cost: the nearest of four curves for each.
pub fn is_whole(body: &Body, face: usize, tolerance: f64) -> bool {
    let face = &body.faces[face];
    let loops = face.loops.iter();
    let edges = loops.filter_map(|l| match l {
        Loop::Edges(coedges) => Some(coedges),
        Loop::Vertex(_) => None,
    });
    let edges: Vec<usize> = edges.flatten().map(|c| c.edge).collect();
    if edges.is_empty() {
        return true;
    }
    let side = |s| -> CurveRef { Arc::new(Isocurve::side(face.surface.clone(), s)) };
    let sides = [Side::South, Side::North, Side::West, Side::East].map(side);
    let Ok(finder) = Finder::on_curves(&sides, FinderOptions::default()) else {
        return false;
    };
    edges.into_iter().all(|e| {
        let edge = &body.edges[e];
        let near = tolerance.max(edge.tolerance);
        let breaks = edge.curve.breaks();
        breaks.windows(2).all(|piece| {
            (0..=PLACES).all(|k| {
                let t = piece[0].at + (piece[1].at - piece[0].at) * k as f64 / PLACES as f64;
                let found = finder.nearest(edge.curve.point(t));
                found.is_ok_and(|n| n.distance <= near)
            })
        })
    })
}
