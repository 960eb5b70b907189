//! Sides that run along each other but are not joined, because they do not have the same ends.

use super::closing::{length, within};
use super::joints::Joints;
use super::shared::{Edge, GUESSES, edge};
use crate::box3::Box3;
use crate::interval::Interval;
use crate::parallel;
use crate::surface::{Side, Surface, SurfaceRef};
use glam::DVec3;
use std::sync::OnceLock;

/// Samples of the shorter side.
const SAMPLES: usize = 32;
/// The fewest steps between samples that have partners one after the other: sides that only meet in a corner have fewer.
const LEAST: usize = 2;
/// In units of the distance within which sides meet: shorter stretches are as good as one point.
const LONG: f64 = 4.0;

/// A stretch of one side that runs along another side without being joined to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PartialJoint {
    /// The surface and the side along which the other lies.
    pub along: (usize, Side),
    /// The surface and the side of which a greater part lies on the other.
    pub part: (usize, Side),
    /// The ends of the stretch as parameters of `part`.
    pub range: Interval,
    /// The partners of these ends on `along`.
    pub partners: [f64; 2],
    /// The points there.
    pub ends: [DVec3; 2],
    /// The greatest distance found between partners (sampled).
    pub gap: f64,
    /// True if both sides are closed and all of `part` lies on the other: they only start at different points.
    pub closed: bool,
    /// The ranges of `part` and of `along` that run along each other from end to end, in either direction: one, or two
    /// where the seam of a closed side is between its ends.
    pub stretches: [Option<[Interval; 2]>; 2],
    /// False if at an end of the stretch the sides are known to go apart by more than the distance before either of them
    /// ends: then there is a gap right beside it.
    pub to_ends: bool,
}

/// Finds the sides that run along each other within `weld` but are not the same curve from end to end: a long side that
/// two shorter ones meet, or closed sides that start at different points. At least one of the two is open in `joined`,
/// what [`joints`](super::joints) found within `weld`. [`mesh`](super::mesh) does not join them: it has two borders there.
///
/// Sampled: a stretch shorter than a sixteenth of both sides is not seen, nor one that ends in the middle of both. Cost:
/// little if there are no open sides; else some tens of points of each side, and 10³ for each pair whose boxes meet.
pub fn partial_joints(surfaces: &[SurfaceRef], joined: &Joints, weld: f64) -> Vec<PartialJoint> {
    if joined.open.iter().all(Vec::is_empty) {
        return Vec::new();
    }
    let threads = parallel::all_threads();
    let of_surface = |i: usize| {
        let sides = Side::ALL.into_iter().enumerate();
        let lines = sides.filter(|(_, side)| !joined.collapsed[i].contains(side));
        let lines: Vec<Line> = lines
            .map(|(k, _)| Line::new(edge(surfaces, 4 * i + k), 4 * i + k, weld, false))
            .collect();
        lines
    };
    let lines = parallel::each(threads, surfaces.len(), of_surface, |_| false);
    let mut lines: Vec<Line> = lines.into_iter().flatten().collect();
    lines.sort_by(|a, b| a.hull.x.lo.total_cmp(&b.hull.x.lo));
    let is_open = |i: &usize| joined.is_open(lines[*i].number);
    let all: Vec<usize> = (0..lines.len()).collect();
    let open: Vec<usize> = all.iter().copied().filter(is_open).collect();
    // The stretches along which a line and later ones, of which one is open, lie on each other.
    let along = |i: usize| {
        let a = &lines[i];
        let others = if is_open(&i) { &all } else { &open };
        let later = others[others.partition_point(|&j| j <= i)..].iter();
        let near = later
            .map(|&j| &lines[j])
            .take_while(|b| b.hull.x.lo <= a.hull.x.hi)
            .filter(|b| a.hull.touches(b.hull));
        let joint = |b: &Line| {
            let (first, second) = if a.number < b.number { (a, b) } else { (b, a) };
            first.common(second)
        };
        near.filter_map(joint).collect::<Vec<_>>()
    };
    let found = parallel::each(threads, lines.len(), along, |_| false);
    let mut found: Vec<PartialJoint> = found.into_iter().flatten().collect();
    found.sort_by_key(|j| [j.along, j.part].map(|(surface, side)| (surface, side as usize)));
    found
}

/// The longest stretch along which two given sides run along each other within `weld`, whatever else they meet: what
/// [`partial_joints`] would find of them, but a distance that is asked for of these two need not be small beside their
/// surfaces. In the result the first side is of surface 0 and the second of surface 1. `None` also if a side is one point.
///
/// Sampled: not seen is also a stretch that is no longer than four times `weld`. Cost: 10³ points.
pub fn partial_joint(
    a: (&dyn Surface, Side),
    b: (&dyn Surface, Side),
    weld: f64,
) -> Option<PartialJoint> {
    let [first, second] = two(a, b, weld);
    let is_point = |line: &Line| line.edge.is_collapsed(weld);
    if is_point(&first) || is_point(&second) {
        return None;
    }
    first.common(&second)
}

/// How far two sides are from each other: the least distance of a point of one from the other, and how far the side that
/// keeps nearer to the other is from it at most: some point of each side is that far from the other. Sampled. Cost: 10³
/// points.
pub fn sides_apart(a: (&dyn Surface, Side), b: (&dyn Surface, Side)) -> [f64; 2] {
    let [first, second] = two(a, b, 0.0);
    let distances = |from: &Line, to: &Line| {
        let points = from.near().points.iter().step_by(GUESSES / SAMPLES);
        let distance = |&p: &DVec3| to.edge.point(to.nearest(p, to.guess(p).0)).distance(p);
        points
            .map(distance)
            .fold([f64::INFINITY, 0.0], |[lo, hi], d| [d.min(lo), d.max(hi)])
    };
    let (x, y) = (distances(&first, &second), distances(&second, &first));
    [x[0].min(y[0]), x[1].min(y[1])]
}

/// Two sides as lines.
fn two<'a>(a: (&'a dyn Surface, Side), b: (&'a dyn Surface, Side), weld: f64) -> [Line<'a>; 2] {
    let line = |k: usize, (surface, side): (&'a dyn Surface, Side)| {
        Line::new(Edge::new(surface, side), 4 * k + side as usize, weld, true)
    };
    [line(0, a), line(1, b)]
}

/// A side with samples.
struct Line<'a> {
    number: usize,
    edge: Edge<'a>,
    weld: f64,
    /// Whether the weld distance is for this side, not for a whole model.
    own: bool,
    /// A box around it, wide enough for whatever meets it.
    hull: Box3,
    /// Once another line is near: the samples of all lines together would be larger than the mesh.
    near: OnceLock<Near>,
}

/// What is known of a line that another one is near.
struct Near {
    /// Finer samples.
    points: Vec<DVec3>,
    /// Between samples the line is no farther from them than this.
    step: f64,
    /// What lies no farther than this lies on the line.
    within: f64,
    closed: bool,
}

/// A point of one line beside another one.
struct Beside {
    t: f64,
    p: DVec3,
    /// The parameter of the nearest point on the other line, and how far it is; if that is near enough.
    partner: Option<(f64, f64)>,
}

/// The greatest distance between neighbours, by as much as which a side may about leave its samples.
fn greatest_step(points: &[DVec3]) -> f64 {
    let steps = points.windows(2).map(|p| p[0].distance(p[1]));
    steps.fold(0.0, f64::max)
}

impl<'a> Line<'a> {
    fn new(edge: Edge<'a>, number: usize, weld: f64, own: bool) -> Self {
        let points = edge.points(&edge.parts(SAMPLES));
        let hull = Box3::around(points.iter().copied()).unwrap_or(Box3::ZERO);
        Self {
            hull: hull.inflate(weld + greatest_step(&points)),
            number,
            edge,
            weld,
            own,
            near: OnceLock::new(),
        }
    }

    fn near(&self) -> &Near {
        self.near.get_or_init(|| {
            let points = self.edge.points(&self.edge.parts(GUESSES));
            let within = if self.own {
                self.weld
            } else {
                within(self.edge.surface, self.weld)[self.number % 4].join
            };
            Near {
                step: greatest_step(&points),
                closed: points[0].distance(points[GUESSES]) <= within,
                within,
                points,
            }
        })
    }

    fn name(&self) -> (usize, Side) {
        (self.number / 4, self.edge.side)
    }

    /// The sample nearest to a point, and how far it is.
    fn guess(&self, p: DVec3) -> (usize, f64) {
        let points = &self.near().points;
        let distances = points.iter().map(|q| q.distance_squared(p)).enumerate();
        let nearest = distances.min_by(|a, b| a.1.total_cmp(&b.1));
        nearest.map_or((0, f64::NAN), |(k, squared)| (k, squared.sqrt()))
    }

    /// The parameter of the point nearest to `p`, which is near a sample; of a closed line on either side of its seam.
    fn nearest(&self, p: DVec3, guess: usize) -> f64 {
        let at = |k: usize| self.edge.sample(k.min(GUESSES), GUESSES);
        let near = |guess: usize| {
            let range = Interval::new(at(guess.saturating_sub(1)), at(guess + 1));
            self.edge.nearest(p, at(guess), range)
        };
        let t = near(guess);
        if !self.near().closed || ![0, GUESSES].contains(&guess) {
            return t;
        }
        let beyond = near(GUESSES - guess);
        let distance = |t: f64| self.edge.point(t).distance(p);
        if distance(beyond) < distance(t) {
            beyond
        } else {
            t
        }
    }

    /// The longest stretch along which this side and a later one lie on each other.
    fn common(&self, later: &Line) -> Option<PartialJoint> {
        let [x, y] = [later.on(self), self.on(later)];
        let share = |s: &Option<(f64, PartialJoint)>| s.as_ref().map_or(0.0, |s| s.0);
        let longer = if share(&y) > share(&x) { y } else { x };
        longer.map(|(_, joint)| joint)
    }

    /// The longest stretch of this side that lies on another one, and its share of this side.
    fn on(&self, other: &Line) -> Option<(f64, PartialJoint)> {
        let [own, near] = [self, other].map(Line::near);
        let within = own.within.min(near.within);
        let partner = |p: DVec3| {
            if !other.hull.contains(p) {
                return None;
            }
            let (guess, distance) = other.guess(p);
            if distance > within + near.step {
                return None;
            }
            let t = other.nearest(p, guess);
            let distance = other.edge.point(t).distance(p);
            (distance <= within).then_some((t, distance))
        };
        let points = own.points.iter().step_by(GUESSES / SAMPLES).enumerate();
        let samples: Vec<Beside> = points
            .map(|(k, &p)| Beside {
                t: self.edge.sample(k, SAMPLES),
                p,
                partner: partner(p),
            })
            .collect();
        let runs = samples.chunk_by(|a, b| a.partner.is_some() == b.partner.is_some());
        let mut first = 0;
        let (from, stretch) = runs
            .map(|run| {
                first += run.len();
                (first - run.len(), run)
            })
            .filter(|(_, run)| run[0].partner.is_some() && run.len() > LEAST)
            .max_by_key(|(_, run)| run.len())?;
        // Sides that touch part in the middle of both; those that run along each other do so until one of them ends.
        let ends_there = |next: Option<&Beside>| {
            next.is_none_or(|s| {
                let t = other.nearest(s.p, other.guess(s.p).0);
                t <= other.edge.range.lo || t >= other.edge.range.hi
            })
        };
        let before = from.checked_sub(1).and_then(|k| samples.get(k));
        let after = samples.get(from + stretch.len());
        if !ends_there(before) || !ends_there(after) {
            return None;
        }
        let points: Vec<DVec3> = stretch.iter().map(|s| s.p).collect();
        if length(&points) <= LONG * within {
            return None;
        }
        let partners: Vec<(f64, f64)> = stretch.iter().filter_map(|s| s.partner).collect();
        let last = stretch.len() - 1;
        let closed = own.closed && near.closed && stretch.len() == samples.len();
        // The stretch goes on from its last sample to where the other side ends, if they are still together there.
        let end = |k: usize, next: Option<&Beside>| {
            let known = (stretch[k].t, partners[k].0, points[k]);
            let Some(next) = next else {
                return (known, true);
            };
            let ends = [other.edge.range.lo, other.edge.range.hi];
            let at = ends.map(|t| (t, other.edge.point(t)));
            let (partner, p) = if at[0].1.distance(next.p) <= at[1].1.distance(next.p) {
                at[0]
            } else {
                at[1]
            };
            let t = self.nearest(p, self.guess(p).0);
            let between = stretch[k].t.min(next.t) <= t && t <= stretch[k].t.max(next.t);
            let q = self.edge.point(t);
            if between && q.distance(p) <= within {
                ((t, partner, q), true)
            } else {
                (known, q.distance(p) <= within)
            }
        };
        let ((first, at_first), (second, at_second)) = (end(0, before), end(last, after));
        let range = Interval::new(first.0, second.0);
        let whole = other.edge.range;
        // A step over the seam of a closed side is a short one in the other direction.
        let step = |w: &[(f64, f64)]| {
            let step = w[1].0 - w[0].0;
            if near.closed && step.abs() > 0.5 * whole.width() {
                step - whole.width().copysign(step)
            } else {
                step
            }
        };
        let rising = partners.windows(2).map(step).sum::<f64>() > 0.0;
        let seam = other.edge.point(whole.lo);
        let (lower, upper) = if rising {
            (whole.lo, whole.hi)
        } else {
            (whole.hi, whole.lo)
        };
        // At the seam the stretch begins or ends where it can go on from or to.
        let at_seam = |t: f64| near.closed && other.edge.point(t).distance(seam) <= within;
        let [p, q] = [(first.1, lower), (second.1, upper)]
            .map(|(t, end)| if !closed && at_seam(t) { end } else { t });
        let over_seam = closed || (near.closed && (p < q) != rising);
        let stretches = if over_seam {
            let turn = self.nearest(seam, self.guess(seam).0);
            let partners = if closed { [partners[0].0; 2] } else { [p, q] };
            around(range, turn, whole, partners, rising)
        } else {
            let on_other = Interval::new(p.min(q), p.max(q));
            [(on_other.width() > 0.0).then_some([range, on_other]), None]
        };
        let joint = PartialJoint {
            along: other.name(),
            part: self.name(),
            range,
            partners: [p, q],
            ends: [first.2, second.2],
            gap: partners.iter().fold(0.0, |gap, p| p.1.max(gap)),
            closed,
            stretches,
            to_ends: at_first && at_second,
        };
        Some((stretch.len() as f64 / samples.len() as f64, joint))
    }
}

/// The stretches of a side, over `range`, that lies on a closed one, over `whole`, from one of the parameters `partners` of it
/// to the other, over its seam, which is at the parameter `turn` of the first; `rising` if both run in the same direction.
fn around(
    range: Interval,
    turn: f64,
    whole: Interval,
    [start, end]: [f64; 2],
    rising: bool,
) -> [Option<[Interval; 2]>; 2] {
    let halves = [
        Interval { hi: turn, ..range },
        Interval { lo: turn, ..range },
    ];
    let from = |lo: f64| Interval { lo, ..whole };
    let to = |hi: f64| Interval { hi, ..whole };
    let others = if rising {
        [from(start), to(end)]
    } else {
        [to(start), from(end)]
    };
    [0, 1].map(|k| {
        let stretch = [halves[k], others[k]];
        stretch.iter().all(|r| r.width() > 0.0).then_some(stretch)
    })
}
