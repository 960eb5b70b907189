//! The points on the sides of all surfaces, one for every place.

use super::lines::{Key, Lines, key};
use super::shared::{Edge, Map, Shared, edge, ends};
use crate::surface::{Corner, SurfaceRef};
use glam::DVec3;
use smallvec::SmallVec;
use std::collections::HashMap;

/// A vertex of a shared edge.
struct Knot {
    /// The parameter on the leading side.
    t: f64,
    p: DVec3,
    /// The parameter on each member, where known.
    params: SmallVec<[Option<f64>; 2]>,
}

/// Replaces the vertices on the sides by the union of what all members ask for and gives out the points. Returns for
/// each surface the point of every vertex on its border.
pub(super) fn stitch(
    surfaces: &[SurfaceRef],
    shared: &Shared,
    weld: f64,
    lines: &mut [Lines],
    points: &mut Vec<DVec3>,
) -> Vec<HashMap<Key, u32>> {
    let mut border: Vec<HashMap<Key, u32>> = vec![HashMap::new(); surfaces.len()];
    let mut id_of_corner = Vec::with_capacity(shared.corners.len());
    for (c, &first) in shared.corners.iter().enumerate() {
        let domain = surfaces[c / 4].domain();
        let end = Corner::ALL[c % 4].ends();
        let uv = [0, 1].map(|d| {
            if end[d] == 0 {
                domain[d].lo
            } else {
                domain[d].hi
            }
        });
        let id = if first == c {
            points.push(surfaces[c / 4].point(uv));
            points.len() as u32 - 1
        } else {
            id_of_corner[first]
        };
        id_of_corner.push(id);
        border[c / 4].insert(key(uv), id);
    }
    for leader in 0..shared.joins.len() {
        let lead = edge(surfaces, leader);
        let inner = |e: &Edge, lines: &[Lines], number: usize| -> Vec<f64> {
            let on = lines[number / 4].on(e.side);
            on.iter()
                .copied()
                .filter(|&t| e.range.lo < t && t < e.range.hi)
                .collect()
        };
        if shared.collapsed[leader] {
            for t in inner(&lead, lines, leader) {
                border[leader / 4].insert(key(lead.uv(t)), id_of_corner[ends(leader)[0]]);
            }
            continue;
        }
        if shared.joins[leader].is_some() {
            continue;
        }
        let members: Vec<(usize, &Map)> = shared.followers[leader]
            .iter()
            .filter_map(|&k| Some((k, &shared.joins[k].as_ref()?.map)))
            .collect();
        let edges: Vec<Edge> = members.iter().map(|&(k, _)| edge(surfaces, k)).collect();

        // What each member asks for, as parameters of the leader.
        let mut asked: Vec<(f64, usize, f64)> = inner(&lead, lines, leader)
            .into_iter()
            .map(|t| (t, 0, t))
            .collect();
        for (m, (&(number, map), e)) in members.iter().zip(&edges).enumerate() {
            let mut own = inner(e, lines, number);
            if map.is_reversed() {
                own.reverse();
            }
            let mut previous = lead.range.lo;
            for t in own {
                // In order, whatever the rounding of Newton's method.
                previous = map.partner(1, t, e.point(t), &lead).max(previous);
                asked.push((previous, m + 1, t));
            }
        }
        asked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut knots: Vec<Knot> = Vec::with_capacity(asked.len());
        for (t, m, own) in asked {
            let p = lead.point(t);
            let joined = knots
                .last_mut()
                .filter(|k| k.params[m].is_none() && k.p.distance(p) <= 0.5 * weld);
            let knot = match joined {
                Some(knot) => knot,
                None => {
                    let params = SmallVec::from_elem(None, members.len() + 1);
                    knots.push(Knot { t, p, params });
                    let last = knots.len() - 1;
                    &mut knots[last]
                }
            };
            knot.params[m] = Some(own);
            if m == 0 {
                (knot.t, knot.p) = (own, p);
            }
        }
        let first_id = points.len() as u32;
        points.extend(knots.iter().map(|k| k.p));
        let known: Vec<Option<f64>> = knots.iter().map(|k| k.params[0]).collect();
        let found = filled(&known, [lead.range.lo, lead.range.hi], |i| knots[i].t);
        record(&lead, leader, &found, first_id, lines, &mut border);
        for (m, (&(number, map), e)) in members.iter().zip(&edges).enumerate() {
            let known: Vec<Option<f64>> = knots.iter().map(|k| k.params[m + 1]).collect();
            let range = if map.is_reversed() {
                [e.range.hi, e.range.lo]
            } else {
                [e.range.lo, e.range.hi]
            };
            let found = filled(&known, range, |i| map.partner(0, knots[i].t, knots[i].p, e));
            record(e, number, &found, first_id, lines, &mut border);
        }
    }
    border
}

/// Fills in the unknown parameters so that all run strictly from one end of the range to the other.
fn filled(known: &[Option<f64>], [from, to]: [f64; 2], guess: impl Fn(usize) -> f64) -> Vec<f64> {
    let mut out = Vec::with_capacity(known.len());
    let mut previous = from;
    for i in 0..known.len() {
        let t = known[i].unwrap_or_else(|| {
            let run = known[i..].iter().take_while(|k| k.is_none()).count();
            let next = known.get(i + run).copied().flatten().unwrap_or(to);
            let t = guess(i);
            if (previous < t && t < next) || (next < t && t < previous) {
                t
            } else {
                previous + (next - previous) / (run + 1) as f64
            }
        });
        out.push(t);
        previous = t;
    }
    out
}

/// Writes down the vertices of one side.
fn record(
    e: &Edge,
    number: usize,
    params: &[f64],
    first_id: u32,
    lines: &mut [Lines],
    border: &mut [HashMap<Key, u32>],
) {
    let surface = number / 4;
    for (i, &t) in params.iter().enumerate() {
        border[surface].insert(key(e.uv(t)), first_id + i as u32);
    }
    let mut line = vec![e.range.lo];
    line.extend(params);
    line.push(e.range.hi);
    line.sort_by(f64::total_cmp);
    lines[surface].set(e.side, line);
}

#[cfg(test)]
mod tests {
    use super::filled;

    #[test]
    fn unknown_parameters_are_put_in_order() {
        let known = [None, Some(0.4), None, None, Some(0.5), None];
        let out = filled(&known, [0.0, 1.0], |i| [0.2, 9.0, 0.45, 0.1, 9.0, 0.9][i]);
        assert_eq!(out[..3], [0.2, 0.4, 0.45]);
        assert!(out.windows(2).all(|w| w[0] < w[1]));
        let back = filled(&[None, Some(0.5), None], [1.0, 0.0], |_| 0.7);
        assert_eq!(back, [0.7, 0.5, 0.25]);
    }
}
