//! The points on the sides of all surfaces, one for every place.

use super::Laid;
use super::lines::{self, Key, key};
use super::shared::{Edge, Map, Shared, edge, ends};
use crate::surface::{Corner, Side, Surface, SurfaceRef};
use glam::DVec3;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

/// A vertex of a shared edge.
struct Knot {
    /// The parameter on the leading side.
    t: f64,
    p: DVec3,
    /// The parameter on each member, where known.
    params: SmallVec<[Option<f64>; 2]>,
}

/// The vertices on the border of a surface.
#[derive(Clone, Debug, Default)]
pub(super) struct Border {
    /// The points of the corners.
    corners: [u32; 4],
    /// For each side the vertices between its corners: their parameters, increasing, and their points.
    sides: [Vec<(f64, u32)>; 4],
}

impl Border {
    /// The points of all vertices.
    pub(super) fn points(&self, surface: &dyn Surface) -> FxHashMap<Key, u32> {
        let corners = Corner::ALL.map(|c| key(place(surface, c)));
        let mut points: FxHashMap<Key, u32> = corners.into_iter().zip(self.corners).collect();
        for (side, vertices) in Side::ALL.into_iter().zip(&self.sides) {
            let e = Edge::new(surface, side);
            points.extend(vertices.iter().map(|&(t, id)| (key(e.uv(t)), id)));
        }
        points
    }

    /// The vertices on a side strictly between two parameters, increasing.
    pub(super) fn between(&self, side: Side, from: f64, to: f64) -> &[(f64, u32)] {
        let line = &self.sides[side as usize];
        let first = line.partition_point(|v| v.0 <= from);
        let last = line.partition_point(|v| v.0 < to);
        &line[first..last.max(first)]
    }

    /// Replaces points by others.
    pub(super) fn rename(&mut self, name: impl Fn(u32) -> u32) {
        let sides = self.sides.iter_mut().flatten().map(|v| &mut v.1);
        for id in sides.chain(&mut self.corners) {
            *id = name(*id);
        }
    }
}

/// The parameters of a corner.
fn place(surface: &dyn Surface, corner: Corner) -> [f64; 2] {
    let (domain, end) = (surface.domain(), corner.ends());
    [0, 1].map(|d| [domain[d].lo, domain[d].hi][end[d]])
}

/// Finds the vertices on the sides, the union of what all members of a shared side ask for, and gives out the points.
pub(super) fn stitch(
    surfaces: &[SurfaceRef],
    layouts: &[Laid],
    shared: &Shared,
    weld: f64,
    points: &mut Vec<DVec3>,
) -> Vec<Border> {
    let mut borders = vec![Border::default(); surfaces.len()];
    for (c, &first) in shared.corners.iter().enumerate() {
        borders[c / 4].corners[c % 4] = if first == c {
            let surface = surfaces[c / 4].as_ref();
            points.push(surface.point(place(surface, Corner::ALL[c % 4])));
            points.len() as u32 - 1
        } else {
            borders[first / 4].corners[first % 4]
        };
    }
    for leader in 0..shared.joins.len() {
        let lead = edge(surfaces, leader);
        let inner = |e: &Edge, number: usize| -> Vec<f64> {
            let mut on = lines::on(&layouts[number / 4].layout, e.side);
            on.retain(|&t| e.range.lo < t && t < e.range.hi);
            on
        };
        let own = &mut borders[leader / 4];
        if shared.collapsed[leader] {
            let corner = own.corners[ends(leader)[0] % 4];
            let vertices = inner(&lead, leader).into_iter().map(|t| (t, corner));
            own.sides[leader % 4] = vertices.collect();
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
        let mut asked: Vec<(f64, usize, f64)> = inner(&lead, leader)
            .into_iter()
            .map(|t| (t, 0, t))
            .collect();
        for (m, (&(number, map), e)) in members.iter().zip(&edges).enumerate() {
            let mut own = inner(e, number);
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
        record(leader, found, first_id, &mut borders);
        for (m, (&(number, map), e)) in members.iter().zip(&edges).enumerate() {
            let known: Vec<Option<f64>> = knots.iter().map(|k| k.params[m + 1]).collect();
            let range = if map.is_reversed() {
                [e.range.hi, e.range.lo]
            } else {
                [e.range.lo, e.range.hi]
            };
            let found = filled(&known, range, |i| map.partner(0, knots[i].t, knots[i].p, e));
            record(number, found, first_id, &mut borders);
        }
    }
    borders
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
fn record(number: usize, params: Vec<f64>, first_id: u32, borders: &mut [Border]) {
    let mut vertices: Vec<(f64, u32)> = params.into_iter().zip(first_id..).collect();
    vertices.sort_by(|a, b| a.0.total_cmp(&b.0));
    borders[number / 4].sides[number % 4] = vertices;
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
