//! A curve seen from a frame.

use super::Functions;
use crate::box3::Box3;
use crate::breaks::{Break, Limit};
use crate::curve::CurveRef;
use crate::frame::Frame;
use crate::interval::Interval;
use crate::scalar::Number;
use glam::DVec3;
use smallvec::SmallVec;

/// The list `1, x(t), y(t), z(t)`: the coordinates of a curve in a frame, with the constant 1 for what does not move.
///
/// The ends may be *snapped* to the frame's z axis: then the linear function of t that takes away the end's x and y is
/// subtracted, so that they are exactly 0 there and nothing else changes by more than that.
#[derive(Clone, Debug)]
pub struct Framed {
    curve: CurveRef,
    frame: Frame,
    /// What is taken away from x and y at the first and the last parameter.
    excess: [[f64; 2]; 2],
}

impl Framed {
    /// The coordinates of a curve; `snap` says which ends (first, last) are to be on the z axis exactly.
    pub fn new(curve: CurveRef, frame: Frame, snap: [bool; 2]) -> Self {
        let ends = curve.ends();
        let excess = std::array::from_fn(|i| {
            let c = frame.coordinates(ends[i]);
            if snap[i] { [c.x, c.y] } else { [0.0; 2] }
        });
        Self {
            curve,
            frame,
            excess,
        }
    }

    /// Takes the linear function away from x and y in `out`, rows of four by derivative.
    fn correct<S: Number>(&self, t: S, order: usize, out: &mut [S]) {
        if self.excess == [[0.0; 2]; 2] {
            return;
        }
        let domain = self.curve.domain();
        let width = S::from(domain.hi) - S::from(domain.lo);
        let (before, after) = (
            (S::from(domain.hi) - t) / width,
            (t - S::from(domain.lo)) / width,
        );
        for k in 0..2 {
            let (a, b) = (S::from(self.excess[0][k]), S::from(self.excess[1][k]));
            out[1 + k] = out[1 + k] - a * before - b * after;
            if order > 0 {
                out[5 + k] = out[5 + k] - (b - a) / width;
            }
        }
    }
}

impl Functions for Framed {
    fn count(&self) -> usize {
        4
    }

    fn breaks(&self) -> &[Break] {
        self.curve.breaks()
    }

    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        let mut d: SmallVec<[DVec3; 4]> = SmallVec::from_elem(DVec3::ZERO, order + 1);
        self.curve.jet_into(t, limit, &mut d);
        d[0] -= self.frame.origin();
        for (k, (o, d)) in out.chunks_exact_mut(4).zip(&d).enumerate() {
            let c = self.frame.components(*d);
            o.copy_from_slice(&[if k == 0 { 1.0 } else { 0.0 }, c.x, c.y, c.z]);
        }
        self.correct(t, order, out);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        let mut d: SmallVec<[Box3; 4]> = SmallVec::from_elem(Box3::ENTIRE, order + 1);
        self.curve.enclose_piece(t, limit, &mut d);
        d[0] = d[0] - Box3::point(self.frame.origin());
        for (k, (o, d)) in out.chunks_exact_mut(4).zip(&d).enumerate() {
            let c = self.frame.enclose_components(*d);
            let one = if k == 0 {
                Interval::ONE
            } else {
                Interval::ZERO
            };
            o.copy_from_slice(&[one, c.x, c.y, c.z]);
        }
        self.correct(t, order, out);
    }
}
