//! Proof of what samples say: that sides of a surface meet, or are one point.

use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::interval::{Interval, greater};
use crate::surface::{Dir, Surface, jet_index, jet_len};
use glam::DVec3;

/// The most parts of a side.
const PARTS: usize = 4096;

/// What a side is compared with.
#[derive(Clone, Copy)]
pub(super) enum Other {
    Side,
    Point(DVec3),
}

/// How far a side at an end of parameter `d` is at most from the other one, at the same other parameter, or from a point:
/// a bound that is either small beside `near` or about the greatest distance. `None` if that cannot be shown.
///
/// Centred forms of the difference over parts, which are halved: what agrees cancels in their middles. Cost: for sides
/// that agree some parts for each analytic piece.
pub(super) fn apart(
    surface: &dyn Surface,
    d: usize,
    upper: bool,
    other: Other,
    near: f64,
) -> Option<f64> {
    let ends = surface.domain()[d];
    let dir = if d == 0 { Dir::V } else { Dir::U };
    let side = |upper: bool, t: Interval, limit: Limit, order: usize| {
        let (at, from) = if upper {
            (ends.hi, Limit::Below)
        } else {
            (ends.lo, Limit::Above)
        };
        let mut boxes = vec![Box3::ENTIRE; jet_len(order)];
        let (across, along) = ([(Interval::point(at), from)], [(t, limit)]);
        let parts = if d == 0 {
            [&across[..], &along[..]]
        } else {
            [&along[..], &across[..]]
        };
        surface.enclose_pieces(parts, order, &mut boxes);
        let own = |k: usize| {
            boxes[if d == 0 {
                jet_index(0, k)
            } else {
                jet_index(k, 0)
            }]
        };
        (0..=order).map(own).collect::<Vec<Box3>>()
    };
    let difference = |t: Interval, limit: Limit, order: usize| {
        let mut a = side(upper, t, limit, order);
        match other {
            Other::Side => {
                let b = side(!upper, t, limit, order);
                a.iter_mut().zip(b).for_each(|(a, b)| *a = *a - b);
            }
            Other::Point(p) => a[0] = a[0] - Box3::point(p),
        }
        a
    };
    let breaks = surface.breaks(dir);
    let mut waiting = breaks.parts(breaks.domain());
    let mut made = waiting.len();
    let mut greatest = 0.0;
    while let Some((t, limit)) = waiting.pop() {
        let h = t - Interval::point(t.mid());
        let middle = difference(Interval::point(t.mid()), limit, ORDER - 1);
        let all = difference(t, limit, ORDER);
        let term = |d: Box3, k: usize| {
            let factorial = (1..=k).product::<usize>() as f64;
            d.scale(h.powi(k as i32) / Interval::point(factorial))
        };
        let rest = term(all[ORDER], ORDER);
        let centred = (0..ORDER).fold(rest, |sum, k| sum + term(middle[k], k));
        let (a, b) = (centred.norm().hi, all[0].norm().hi);
        let bound = if a < b { a } else { b };
        // Halves would give no less: what remains is rounding, or the greater part is the distance in the middle.
        let rounding = bound <= near && rest.norm().hi <= 0.25 * bound;
        if bound <= SMALL * near || rounding || bound <= 2.0 * middle[0].norm().lo {
            greatest = greater(greatest, bound);
            continue;
        }
        let m = t.mid();
        made += 2;
        if made > PARTS || !(t.lo < m && m < t.hi) {
            return None;
        }
        waiting.push((Interval::new(t.lo, m), limit));
        waiting.push((Interval::new(m, t.hi), limit));
    }
    Some(greatest)
}

/// A distance that is this share of what is near is small.
const SMALL: f64 = 0.25;
/// The order of the centred forms.
const ORDER: usize = 4;
