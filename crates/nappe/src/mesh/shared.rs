//! Which sides of the surfaces are one and the same curve, and which are one point.
//!
//! Two sides match if they have the same ends, in the same or the opposite order, and samples of one have partners on
//! the other no farther than the weld distance, in order. The parametrisations may differ. Sampling decides only what is
//! joined; how far the joined points are from each surface is measured at every vertex and counts as deviation.

use super::closing::{self, Within};
use super::lines::index;
use crate::breaks::Limit;
use crate::clusters::Sets;
use crate::interval::Interval;
use crate::parallel;
use crate::surface::{Corner, Dir, Side, Surface, SurfaceRef, jet_len};
use glam::DVec3;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;
use std::sync::OnceLock;

/// The number of samples along a side; partners between them are found by Newton's method from these.
const SAMPLES: usize = 32;
/// Finer samples among which the first guess of a partner is taken.
pub(super) const GUESSES: usize = 128;
/// The most steps of Newton's method, and of halving in between.
const STEPS: usize = 40;

/// A side as a curve: its parameter is the one that runs along it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Edge<'a> {
    pub(crate) surface: &'a dyn Surface,
    pub(crate) side: Side,
    pub(crate) range: Interval,
    /// The constant parameter.
    pub(crate) at: f64,
}

impl<'a> Edge<'a> {
    pub(crate) fn new(surface: &'a dyn Surface, side: Side) -> Self {
        let domain = surface.domain();
        let across = domain[index(side.across())];
        Self {
            surface,
            side,
            range: domain[index(side.along())],
            at: if side.is_upper() {
                across.hi
            } else {
                across.lo
            },
        }
    }

    /// A part of a side: what belongs to a range of its parameter.
    pub(crate) fn part(surface: &'a dyn Surface, side: Side, range: Interval) -> Self {
        Self {
            range,
            ..Self::new(surface, side)
        }
    }

    /// The line where the parameter across has the value `at`; `side` says only which way it runs.
    pub(crate) fn inside(surface: &'a dyn Surface, across: Dir, at: f64) -> Self {
        let side = match across {
            Dir::U => Side::West,
            Dir::V => Side::South,
        };
        Self {
            at,
            ..Self::new(surface, side)
        }
    }

    pub(crate) fn uv(&self, t: f64) -> [f64; 2] {
        match self.side.along() {
            Dir::U => [t, self.at],
            Dir::V => [self.at, t],
        }
    }

    pub(crate) fn point(&self, t: f64) -> DVec3 {
        self.surface.point(self.uv(t))
    }

    pub(crate) fn sample(&self, k: usize, of: usize) -> f64 {
        if k == of {
            self.range.hi
        } else {
            self.range.lo + (self.range.hi - self.range.lo) * k as f64 / of as f64
        }
    }

    /// Parameters that divide the side evenly.
    pub(super) fn parts(&self, of: usize) -> Vec<f64> {
        (0..=of).map(|k| self.sample(k, of)).collect()
    }

    /// The points at many parameters, the same as one by one.
    pub(super) fn points(&self, t: &[f64]) -> Vec<DVec3> {
        let mut points = vec![DVec3::ZERO; t.len()];
        match self.side.along() {
            Dir::U => self.surface.grid(t, &[self.at], &mut points),
            Dir::V => self.surface.grid(&[self.at], t, &mut points),
        }
        points
    }

    /// The parameter in `within` of the point nearest to `p`, near `guess`: Newton's method on `(r - p)·r' = 0` with
    /// the step of Gauss, halved until the distance does not grow.
    pub(super) fn nearest(&self, p: DVec3, guess: f64, within: Interval) -> f64 {
        let mut t = guess.clamp(within.lo, within.hi);
        let mut best = self.point(t).distance(p);
        let mut d = [DVec3::ZERO; jet_len(1)];
        let first = match self.side.along() {
            Dir::U => 1,
            Dir::V => 2,
        };
        for _ in 0..STEPS {
            let limit = if t >= within.hi {
                Limit::Below
            } else {
                Limit::Above
            };
            self.surface.jet_into(self.uv(t), [limit; 2], 1, &mut d);
            let (r, slope) = (d[0] - p, d[first]);
            let mut step = -r.dot(slope) / slope.length_squared();
            if !step.is_finite() {
                return t;
            }
            let mut moved = false;
            for _ in 0..STEPS {
                let next = (t + step).clamp(within.lo, within.hi);
                let distance = self.point(next).distance(p);
                if distance < best {
                    (t, best, moved) = (next, distance, true);
                    break;
                }
                step *= 0.5;
                if t + step == t {
                    break;
                }
            }
            if !moved {
                break;
            }
        }
        t
    }

    /// True if the whole side (sampled) lies within `weld` of one point.
    pub(crate) fn is_collapsed(&self, weld: f64) -> bool {
        let p = self.point(self.range.mid());
        (0..=GUESSES).all(|k| self.point(self.sample(k, GUESSES)).distance(p) <= 0.5 * weld)
    }
}

/// The correspondence between the parameters of two sides that match.
#[derive(Clone, Debug)]
pub(crate) struct Map {
    /// Increasing parameters of the leading side and their partners, increasing or decreasing; the ends if linear.
    table: Vec<[f64; 2]>,
    /// True if the parameters correspond linearly.
    linear: bool,
    /// The greatest distance of the partners that were looked at.
    pub(super) gap: f64,
    /// The length of the polygon through those on the leading side.
    pub(super) length: f64,
}

impl Map {
    /// True if the parameters correspond linearly.
    pub(crate) fn is_linear(&self) -> bool {
        self.linear
    }

    pub(crate) fn is_reversed(&self) -> bool {
        self.table[0][1] > self.table[self.table.len() - 1][1]
    }

    /// The partner of a parameter `t` of side `from` (0 or 1) on the other side, whose curve is `on`; `p` is the point.
    pub(crate) fn partner(&self, from: usize, t: f64, p: DVec3, on: &Edge) -> f64 {
        let to = 1 - from;
        let last = self.table.len() - 1;
        let flip = from == 1 && self.is_reversed();
        let k = if flip {
            self.table.partition_point(|e| e[from] > t)
        } else {
            self.table.partition_point(|e| e[from] <= t)
        }
        .clamp(1, last);
        let (a, b) = (self.table[k - 1], self.table[k]);
        let share = (t - a[from]) / (b[from] - a[from]);
        let guess = a[to] + (b[to] - a[to]) * share;
        if self.linear {
            return guess.clamp(on.range.lo, on.range.hi);
        }
        on.nearest(p, guess, Interval::new(a[to], b[to]))
    }
}

/// The correspondence of side `b` to side `a`, if they match within `weld`.
pub(crate) fn matching(a: &Edge, b: &Edge, weld: f64) -> Option<Map> {
    let ends = |e: &Edge| [e.point(e.range.lo), e.point(e.range.hi)];
    let (p, q) = (ends(a), ends(b));
    [false, true]
        .into_iter()
        .filter(|&reversed| {
            let [first, last] = if reversed { [1, 0] } else { [0, 1] };
            p[0].distance(q[first]) <= weld && p[1].distance(q[last]) <= weld
        })
        .find_map(|reversed| linear(a, b, reversed, weld).or_else(|| general(a, b, reversed, weld)))
}

fn linear(a: &Edge, b: &Edge, reversed: bool, weld: f64) -> Option<Map> {
    let [s, mut t] = [a, b].map(|e| e.parts(SAMPLES));
    if reversed {
        t.reverse();
    }
    let (mut gap, points) = (0.0f64, a.points(&s));
    for (p, q) in points.iter().zip(b.points(&t)) {
        let distance = p.distance(q);
        if distance.is_nan() || distance > weld {
            return None;
        }
        gap = gap.max(distance);
    }
    Some(Map {
        table: vec![[s[0], t[0]], [s[SAMPLES], t[SAMPLES]]],
        linear: true,
        gap,
        length: closing::length(&points),
    })
}

fn general(a: &Edge, b: &Edge, reversed: bool, weld: f64) -> Option<Map> {
    let s = a.parts(SAMPLES);
    let on_a = a.points(&s);
    let mut guesses = b.parts(GUESSES);
    if reversed {
        guesses.reverse();
    }
    let points = b.points(&guesses);
    let at = |k: usize| guesses[k];
    let mut table = vec![[s[0], at(0)]];
    let mut gap = on_a[0].distance(points[0]);
    let mut from = 0;
    for k in 1..SAMPLES {
        let p = on_a[k];
        // The first local minimum from here on that is near enough decides; loops that come back are not jumped to.
        let mut best = from;
        for j in from..=GUESSES {
            if points[j].distance(p) < points[best].distance(p) {
                best = j;
            }
        }
        let (lo, hi) = (at(best.saturating_sub(1)), at((best + 1).min(GUESSES)));
        let t = b.nearest(p, at(best), Interval::new(lo, hi));
        let previous = table[table.len() - 1][1];
        let ahead = if reversed { t < previous } else { t > previous };
        let distance = b.point(t).distance(p);
        if !ahead || distance > weld {
            return None;
        }
        gap = gap.max(distance);
        table.push([s[k], t]);
        from = best.saturating_sub(1);
    }
    table.push([s[SAMPLES], at(GUESSES)]);
    Some(Map {
        table,
        linear: false,
        gap: gap.max(on_a[SAMPLES].distance(points[GUESSES])),
        length: closing::length(&on_a),
    })
}

/// How one side is joined to an earlier one.
#[derive(Clone, Debug)]
pub(super) struct Join {
    /// The leading side: 4 times its surface's index plus its own.
    pub(super) leader: usize,
    pub(super) map: Map,
}

/// What is shared. Sides are numbered 4 × surface + side, corners 4 × surface + corner.
#[derive(Debug)]
pub(super) struct Shared {
    pub(super) joins: Vec<Option<Join>>,
    pub(super) collapsed: Vec<bool>,
    /// For each leading side the sides joined to it.
    pub(super) followers: Vec<SmallVec<[usize; 1]>>,
    /// For each corner the first corner that is the same point.
    pub(super) corners: Vec<usize>,
}

/// The edge with a number.
pub(super) fn edge(surfaces: &[SurfaceRef], number: usize) -> Edge<'_> {
    Edge::new(surfaces[number / 4].as_ref(), Side::ALL[number % 4])
}

/// The corners at the start and end of a side.
pub(crate) fn ends(number: usize) -> [usize; 2] {
    let side = Side::ALL[number % 4];
    let [a, b] = match side {
        Side::South => [Corner::SouthWest, Corner::SouthEast],
        Side::North => [Corner::NorthWest, Corner::NorthEast],
        Side::West => [Corner::SouthWest, Corner::NorthWest],
        Side::East => [Corner::SouthEast, Corner::NorthEast],
    };
    [a, b].map(|c| number / 4 * 4 + c as usize)
}

/// The sides by the place of the middle of their ends, so that only sides that may match are compared.
struct Places {
    /// The size of a cell: partners are in the same cell or the next.
    size: f64,
    cells: FxHashMap<[i64; 3], SmallVec<[usize; 2]>>,
}

impl Places {
    fn new(weld: f64) -> Self {
        // Middles of partners are no farther apart than their ends.
        let size = 2.0 * weld.max(f64::MIN_POSITIVE);
        Self {
            size,
            cells: FxHashMap::default(),
        }
    }

    fn cell(&self, [p, q]: [DVec3; 2]) -> [i64; 3] {
        // Saturates far away, where welding is below rounding anyway: then more is compared.
        ((0.5 * p + 0.5 * q) / self.size)
            .to_array()
            .map(|x| (x.floor() as i64).clamp(i64::MIN + 1, i64::MAX - 1))
    }

    fn add(&mut self, ends: [DVec3; 2], side: usize) {
        self.cells.entry(self.cell(ends)).or_default().push(side);
    }

    /// The sides that may match one with these ends, increasing.
    fn near(&self, ends: [DVec3; 2]) -> Vec<usize> {
        let c = self.cell(ends);
        let mut found = Vec::new();
        for k in 0..27 {
            let next = [
                c[0] + (k % 3 - 1),
                c[1] + (k / 3 % 3 - 1),
                c[2] + (k / 9 - 1),
            ];
            found.extend(self.cells.get(&next).into_iter().flatten());
        }
        found.sort_unstable();
        found
    }
}

/// A surface whose sides may be joined.
struct Measured<'a> {
    surface: &'a dyn Surface,
    corners: [DVec3; 4],
    weld: f64,
    /// How near is near enough for each side, once a side comes within the weld distance of something.
    within: OnceLock<[Within; 4]>,
    collapsed: [bool; 4],
}

impl<'a> Measured<'a> {
    fn of(surface: &'a dyn Surface, weld: f64) -> Self {
        let domain = surface.domain().map(|d| [d.lo, d.hi]);
        let corner = |c: Corner| surface.point([0, 1].map(|d| domain[d][c.ends()[d]]));
        let mut new = Self {
            surface,
            corners: Corner::ALL.map(corner),
            weld,
            within: OnceLock::new(),
            collapsed: [false; 4],
        };
        new.collapsed = Side::ALL.map(|side| {
            let [p, q] = new.tips(side as usize);
            p.distance(q) <= weld
                && Edge::new(surface, side).is_collapsed(new.within()[side as usize].point)
        });
        new
    }

    fn within(&self) -> &[Within; 4] {
        self.within
            .get_or_init(|| closing::within(self.surface, self.weld))
    }

    /// The points at the ends of a side.
    fn tips(&self, side: usize) -> [DVec3; 2] {
        ends(side).map(|corner| self.corners[corner])
    }
}

/// The distance within which two sides may be joined, if their ends are that near.
fn ends_meet(measured: &[Measured], a: usize, b: usize) -> Option<f64> {
    let [(x, i), (y, j)] = [a, b].map(|k| (&measured[k / 4], k % 4));
    let ([p, q], [s, e]) = (x.tips(i), y.tips(j));
    let near = |within: f64| {
        let near = |p: DVec3, q: DVec3| p.distance(q) <= within;
        (near(p, s) && near(q, e)) || (near(p, e) && near(q, s))
    };
    let within = || x.within()[i].join.min(y.within()[j].join);
    near(x.weld).then(within).filter(|&within| near(within))
}

/// What a side may be joined to.
struct Candidates {
    /// The earlier sides whose ends agree with its own.
    near: Vec<usize>,
    /// How the first of these matches: most often it leads.
    map: Option<Map>,
}

/// Finds what is shared within `weld`, or within a small share of what is smaller than that (see `closing`), on some
/// threads. Cost: proportional to the number of sides, and some hundred points for each pair whose ends agree.
pub(super) fn find(surfaces: &[SurfaceRef], weld: f64, threads: usize) -> Shared {
    find_with(surfaces, weld, threads, |_| true)
}

/// The same, but only sides of which at least one is `wanted` are joined.
pub(super) fn find_with(
    surfaces: &[SurfaceRef],
    weld: f64,
    threads: usize,
    wanted: impl Fn(usize) -> bool + Sync,
) -> Shared {
    let measured = |i: usize| Measured::of(surfaces[i].as_ref(), weld);
    let measured = parallel::each(threads, surfaces.len(), measured, |_| false);
    let count = 4 * surfaces.len();
    let collapsed = |k: usize| measured[k / 4].collapsed[k % 4];
    let tips = |k: usize| measured[k / 4].tips(k % 4);
    let mut places = Places::new(weld);
    for k in (0..count).filter(|&k| !collapsed(k)) {
        places.add(tips(k), k);
    }
    let join = |a: usize, b: usize| {
        let within = ends_meet(&measured, a, b)?;
        matching(&edge(surfaces, a), &edge(surfaces, b), within)
    };
    let candidates = |b: usize| {
        if collapsed(b) {
            return None;
        }
        let near = places.near(tips(b)).into_iter();
        let near: Vec<usize> = near
            .filter(|&a| a < b && (wanted(a) || wanted(b)))
            .filter(|&a| ends_meet(&measured, a, b).is_some())
            .collect();
        let map = join(*near.first()?, b);
        Some(Box::new(Candidates { near, map }))
    };
    let candidates = parallel::each(threads, count, candidates, |_| false);
    drop(places);
    let mut corners = Sets::new(count);
    let mut joins: Vec<Option<Join>> = vec![None; count];
    for (b, candidates) in candidates.into_iter().enumerate() {
        if collapsed(b) {
            let [s, e] = ends(b);
            corners.unite(s, e);
            continue;
        }
        joins[b] = candidates.and_then(|c| {
            let Candidates { near, mut map } = *c;
            let leaders = near.iter().filter(|&&a| joins[a].is_none());
            leaders.into_iter().find_map(|&leader| {
                let map = if leader == near[0] {
                    map.take()
                } else {
                    join(leader, b)
                };
                Some(Join { leader, map: map? })
            })
        });
        if let Some(join) = &joins[b] {
            let ([p, q], [s, e]) = (ends(join.leader), ends(b));
            let (s, e) = if join.map.is_reversed() {
                (e, s)
            } else {
                (s, e)
            };
            corners.unite(p, s);
            corners.unite(q, e);
        }
    }
    let corners = (0..count).map(|c| corners.leader(c)).collect();
    let mut followers = vec![SmallVec::new(); count];
    for (k, join) in joins.iter().enumerate() {
        if let Some(join) = join {
            followers[join.leader].push(k);
        }
    }
    Shared {
        followers,
        joins,
        collapsed: (0..count).map(collapsed).collect(),
        corners,
    }
}

impl Shared {
    /// The side that leads the sides joined to this one, or itself.
    fn leader(&self, number: usize) -> usize {
        self.joins[number].as_ref().map_or(number, |j| j.leader)
    }

    /// True if another surface has both of these sides of a surface, not collapsed.
    fn both_shared(&self, surface: usize, sides: [Side; 2]) -> bool {
        let numbers = sides.map(|s| 4 * surface + s as usize);
        let leaders = numbers.map(|k| self.leader(k));
        !numbers.iter().any(|&k| self.collapsed[k])
            && self
                .members(leaders[0])
                .any(|a| a / 4 != surface && self.members(leaders[1]).any(|b| b / 4 == a / 4))
    }

    /// The sides joined to a leading side, and itself.
    fn members(&self, leader: usize) -> impl Iterator<Item = usize> + '_ {
        let of_leader = &self.followers[leader];
        std::iter::once(leader).chain(of_leader.iter().copied())
    }

    /// The corners at which both sides are sides of another surface as well: there both surfaces must not have the
    /// triangle of the corner and its neighbours on the two sides, which would lie back to back.
    pub(super) fn pinched(&self, surface: usize) -> [bool; 4] {
        Corner::ALL.map(|c| self.both_shared(surface, c.sides()))
    }

    /// The fewest cells across a surface along u and v for which no triangle has two corners in one place, and no two
    /// triangles the same three: around closed directions three, between two poles two, and two between two sides that
    /// are also sides of another surface.
    pub(super) fn least_cells(&self, surface: usize) -> [f64; 2] {
        let number = |s: Side| 4 * surface + s as usize;
        let group = |s: Side| self.leader(number(s));
        let mut least = [1.0f64; 2];
        for (i, a) in Side::ALL.into_iter().enumerate() {
            for b in Side::ALL.into_iter().skip(i + 1) {
                let opposite = a.along() == b.along();
                if self.collapsed[number(a)] && self.collapsed[number(b)] {
                    if opposite {
                        let d = index(a.across());
                        least[d] = least[d].max(2.0);
                    } else {
                        least = least.map(|l| l.max(2.0));
                    }
                } else if group(a) == group(b) {
                    if opposite {
                        let d = index(a.across());
                        least[d] = least[d].max(3.0);
                    } else {
                        least = least.map(|l| l.max(3.0));
                    }
                } else if opposite && self.both_shared(surface, [a, b]) {
                    let d = index(a.across());
                    least[d] = least[d].max(2.0);
                }
            }
        }
        least
    }

    /// For each side of a surface whether other sides have the same points.
    pub(super) fn joined(&self, surface: usize) -> [bool; 4] {
        [0, 1, 2, 3].map(|side| {
            let k = 4 * surface + side;
            self.joins[k].is_some() || !self.followers[k].is_empty()
        })
    }

    /// True if something of the surface is shared or collapsed.
    pub(super) fn touches(&self, surface: usize) -> bool {
        (4 * surface..4 * surface + 4)
            .any(|k| self.collapsed[k] || self.joins[k].is_some() || !self.followers[k].is_empty())
    }
}
