//! Enclosures over any rectangle, from those over one analytic piece.

use super::{Dir, Surface, jet_index, jet_len};
use crate::box3::Box3;
use crate::breaks::{Breaks, Part};
use crate::interval::Interval;

/// So many parts in each direction are enclosed together: their boxes stay in the second-level cache.
const TILE: usize = 16;

/// The hull of the centred forms over all parts of a rectangle.
pub(crate) fn enclose_centred<F: Surface + ?Sized>(
    surface: &F,
    uv: [Interval; 2],
    order: usize,
) -> Vec<Box3> {
    if uv[0].is_point() && uv[1].is_point() {
        return enclose_direct(surface, uv, order);
    }
    let (mut over, mut at, mut hull) = (Vec::new(), Vec::new(), Vec::new());
    for tile in tiles(&parts(surface, uv)) {
        let [us, vs] = tile;
        let middles = tile.map(|parts| -> Vec<Part> {
            let middle = |&(t, limit): &Part| (Interval::point(t.mid()), limit);
            parts.iter().map(middle).collect()
        });
        enclose_tile(surface, tile, order + 2, &mut over);
        enclose_tile(surface, [&middles[0], &middles[1]], order + 1, &mut at);
        let jets = over
            .chunks_exact(jet_len(order + 2))
            .zip(at.chunks_exact(jet_len(order + 1)));
        let pairs = us.iter().flat_map(|u| vs.iter().map(|v| [u.0, v.0]));
        for ((over, at), uv) in jets.zip(pairs) {
            join(&mut hull, centred(over, at, uv, order));
        }
    }
    hull
}

/// The hull of the enclosures over all parts of a rectangle, as the surface states them.
pub(crate) fn enclose_direct<F: Surface + ?Sized>(
    surface: &F,
    uv: [Interval; 2],
    order: usize,
) -> Vec<Box3> {
    let (mut over, mut hull) = (Vec::new(), Vec::new());
    for tile in tiles(&parts(surface, uv)) {
        enclose_tile(surface, tile, order, &mut over);
        for boxes in over.chunks_exact(jet_len(order)) {
            join(&mut hull, boxes.iter().copied());
        }
    }
    hull
}

fn parts<F: Surface + ?Sized>(surface: &F, uv: [Interval; 2]) -> [Vec<Part>; 2] {
    [(Dir::U, uv[0]), (Dir::V, uv[1])].map(|(dir, t)| surface.breaks(dir).parts(t))
}

fn tiles(parts: &[Vec<Part>; 2]) -> impl Iterator<Item = [&[Part]; 2]> {
    let in_v = || parts[1].chunks(TILE);
    parts[0]
        .chunks(TILE)
        .flat_map(move |us| in_v().map(move |vs| [us, vs]))
}

fn enclose_tile<F: Surface + ?Sized>(
    surface: &F,
    tile: [&[Part]; 2],
    order: usize,
    out: &mut Vec<Box3>,
) {
    let [us, vs] = tile;
    out.resize(us.len() * vs.len() * jet_len(order), Box3::ENTIRE);
    surface.enclose_pieces(tile, order, out);
}

fn join(hull: &mut Vec<Box3>, boxes: impl Iterator<Item = Box3>) {
    if hull.is_empty() {
        hull.extend(boxes);
    } else {
        hull.iter_mut().zip(boxes).for_each(|(h, b)| *h = h.hull(b));
    }
}

/// The centred form, from enclosures over a rectangle in one piece (of order + 2) and of its middle m (of order + 1):
/// `∂ r(box) ⊂ Σ_{|a|<2} ∂ᵃ∂ r(m) (p - m)ᵃ/a! + Σ_{|a|=2} ∂ᵃ∂ r(box) (p - m)ᵃ/a!`.
fn centred<'a>(
    over: &'a [Box3],
    at: &'a [Box3],
    uv: [Interval; 2],
    order: usize,
) -> impl Iterator<Item = Box3> + 'a {
    let [hu, hv] = uv.map(|t| t - Interval::point(t.mid()));
    let half = Interval::point(0.5);
    let (huu, huv, hvv) = (hu.sqr() * half, hu * hv, hv.sqr() * half);
    let places = (0..=order).flat_map(|n| (0..=n).map(move |j| (n - j, j)));
    places.map(move |(i, j)| {
        let x = |a: usize, b: usize| jet_index(i + a, j + b);
        let centred = at[x(0, 0)]
            + at[x(1, 0)].scale(hu)
            + at[x(0, 1)].scale(hv)
            + over[x(2, 0)].scale(huu)
            + over[x(1, 1)].scale(huv)
            + over[x(0, 2)].scale(hvv);
        if centred.is_finite() {
            centred.meet(over[x(0, 0)])
        } else {
            over[x(0, 0)]
        }
    })
}
