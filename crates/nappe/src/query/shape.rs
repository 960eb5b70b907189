//! Surfaces and curves alike, as far as the distance from them goes.
//!
//! A curve is taken for a surface whose second parameter is always 0 and changes nothing.

use super::patch::net;
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit, inwards};
use crate::curve::CurveRef;
use crate::exact::NurbsSurface;
use crate::interval::Interval;
use crate::surface::{Dir, SurfaceRef, jet_len};
use glam::DVec3;

/// What points are near to.
#[derive(Clone, Debug)]
pub(super) enum Shape {
    Surface(SurfaceRef),
    Curve(CurveRef),
}

impl Shape {
    /// The parameters of its analytic pieces.
    pub(super) fn pieces(&self) -> Vec<[Interval; 2]> {
        let all = |breaks: &[Break]| -> Vec<Interval> {
            (0..breaks.pieces()).map(|i| breaks.piece(i)).collect()
        };
        let [us, vs] = match self {
            Shape::Surface(s) => [Dir::U, Dir::V].map(|dir| all(s.breaks(dir))),
            Shape::Curve(c) => [all(c.breaks()), vec![Interval::ZERO]],
        };
        us.iter()
            .flat_map(|&u| vs.iter().map(move |&v| [u, v]))
            .collect()
    }

    /// The ranges of its parameters.
    pub(super) fn domain(&self) -> [Interval; 2] {
        match self {
            Shape::Surface(s) => s.domain(),
            Shape::Curve(c) => [c.domain(), Interval::ZERO],
        }
    }

    /// Its net, if its pieces are polynomials of low degrees.
    pub(super) fn net(&self) -> Option<NurbsSurface> {
        match self {
            Shape::Surface(s) => net(s.as_ref()),
            Shape::Curve(_) => None,
        }
    }

    /// A box around it.
    pub(super) fn bounds(&self) -> Box3 {
        match self {
            Shape::Surface(s) => s.bounds(s.domain()),
            Shape::Curve(c) => c.bounds(c.domain()),
        }
    }

    /// Boxes that enclose the point and its derivatives up to `order`, 2 at most, over a part of a piece.
    pub(super) fn enclose(&self, uv: [Interval; 2], order: usize) -> Vec<Box3> {
        match self {
            Shape::Surface(s) => s.enclose(uv, order),
            Shape::Curve(c) => {
                let mut boxes = vec![Box3::ZERO; jet_len(order)];
                for (k, b) in c.enclose(uv[0], order).into_iter().enumerate() {
                    boxes[ALONG[k]] = b;
                }
                boxes
            }
        }
    }

    /// The point and its derivatives up to `order`, 2 at most, with the limits from the inside of a part.
    pub(super) fn jet_into(
        &self,
        uv: [f64; 2],
        within: [Interval; 2],
        order: usize,
        out: &mut [DVec3],
    ) {
        let limits = inwards(uv, within);
        match self {
            // Lists are evaluated faster, from polynomials that are prepared where points fall.
            Shape::Surface(s) if limits == [Limit::Above; 2] => s.jets(&[uv], order, out),
            Shape::Surface(s) => s.jet_into(uv, limits, order, out),
            Shape::Curve(c) => {
                let mut jet = [DVec3::ZERO; 3];
                c.jet_into(uv[0], limits[0], &mut jet[..=order]);
                out.fill(DVec3::ZERO);
                for k in 0..=order {
                    out[ALONG[k]] = jet[k];
                }
            }
        }
    }
}

/// Where the derivatives along u stand among those of a surface.
const ALONG: [usize; 3] = [0, 1, 3];
