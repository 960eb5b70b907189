//! From two surfaces to the path of the ball between them: looked for, followed, and put into a table.

use super::contact::{AT_BREAK, Place, Supports};
use super::find::Search;
use super::motion::{Carried, Motion};
use super::rolling_ball::prove;
use super::spine::{Node, Piece, Spine, Unsettled, course, newton};
use super::trace::{Lost, Trace, Tracer};
use super::{FilletError, FilletOptions, Radius};
use crate::breaks::{Break, Limit, merge_breaks};
use crate::curve::{Curve, CurveRef, InterpolateOptions, interpolate};
use crate::exact::NurbsCurve;
use crate::interval::Interval;
use crate::surface::{Elementary, SurfaceRef};
use glam::DVec3;
use std::sync::Arc;

/// The guide's degree, and its turn from point to point in radians.
const GUIDE: (usize, f64) = (5, 0.5);
/// The most points of a guide.
const MOST_POINTS: usize = 400;
/// The cosine of the angle between the guide and the path, at least.
const FOLLOWS: f64 = 0.9;
/// The steps of the table in a piece of the guide, at least.
const STEPS: f64 = 8.0;
/// The most steps along the guide, those that fail and are halved included.
const MOST_STEPS: usize = 20_000;
/// Relative to the range of u: the shortest step of the table, and places that are one.
const SHORTEST: f64 = 1e-10;
const ONE_PLACE: f64 = 1e-13;
/// The most steps of Newton's method for a place of the table, and how far it may be from where it is foreseen, relative to
/// the step.
const NEWTON: usize = 10;
const ASTRAY: f64 = 0.2;
/// Normals on both sides of a break that differ by more (radians) make a crease.
const CREASE: f64 = 1e-6;
/// A contact where less than this is left of the curvature is named as the likely reason why a ball is lost.
const TIGHT: f64 = 0.05;
/// How often a table is made again with one more place.
const MOST_STOPS: usize = 8;
/// Relative: radii at both ends of a closed path that differ by no more are the same, by rounding.
const SAME_RADIUS: f64 = 1e-9;
/// Steps from one radius to another.
const RADII: usize = 8;
/// How far inside of the path of another radius a ball is looked for that then rolls to its own end, as shares.
const INSETS: [f64; 7] = [0.0, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5];
/// Samples of a radius for the least and the greatest one.
const SAMPLES: usize = 64;

/// The spine of the fillet between two surfaces, proven.
pub(super) fn spine(
    surfaces: [SurfaceRef; 2],
    radius: Radius,
    options: &FilletOptions,
    forms: Option<[Elementary; 2]>,
) -> Result<(Spine, Option<Carried>), FilletError> {
    let (origin, size) = middle_and_size(&surfaces);
    let sides = options.side.unwrap_or([true; 2]);
    let supports = Supports {
        surfaces,
        sides: sides.map(|front| if front { 1.0 } else { -1.0 }),
        origin,
    };
    let middle = radius_at(&radius, 0.5)?;
    let search = Search::new(&supports, size).ok_or(FilletError::NoBall {
        radius: middle,
        fits: None,
    })?;
    let (main, trace) = main_path(&search, &radius, options.near)?;
    // The path that a motion of both supports makes of a constant radius.
    let carried = match radius {
        Radius::Constant(r) => forms
            .and_then(|forms| Motion::of(forms, size))
            .and_then(|motion| motion.carry(&search.tracer(r), &trace)),
        Radius::Along(_) => None,
    };
    let (start, guide) = match &carried {
        Some(c) => (trace.samples[0].x, c.guide.clone()),
        None => {
            let (path, guide) = guided(&search, &radius, (main, &trace))?;
            (path.start, Arc::new(guide) as CurveRef)
        }
    };
    let walker = Walker {
        tracer: search.tracer(radius_at(&radius, 0.0)?),
        supports: &supports,
        radius: &radius,
        guide: &guide,
    };
    let spine = settled(&walker, start)?;
    match prove(spine.ranges(), |u| spine.margins(u, Limit::Above)) {
        Ok(()) => match search.cut(&spine) {
            None => Ok((spine, carried)),
            Some(error) => Err(error),
        },
        Err((condition, at, margin)) => Err(refused(&spine, condition, at, margin)),
    }
}

/// The path of one radius that can be taken: the middle one's, or else the least's or the greatest's.
fn main_path(
    search: &Search,
    radius: &Radius,
    near: Option<DVec3>,
) -> Result<(f64, Trace), FilletError> {
    let middle = radius_at(radius, 0.5)?;
    let error = match (choose(search, middle, near), radius) {
        (Ok(trace), _) => return Ok((middle, trace)),
        (Err(e @ (FilletError::CutsIn { .. } | FilletError::Lost { .. })), Radius::Along(_)) => e,
        (Err(e), _) => return Err(e),
    };
    let all: Result<Vec<f64>, _> = (0..=SAMPLES)
        .map(|i| radius_at(radius, i as f64 / SAMPLES as f64))
        .collect();
    let all = all?;
    let least = all.iter().copied().fold(middle, f64::min);
    let greatest = all.iter().copied().fold(middle, f64::max);
    [least, greatest]
        .into_iter()
        .filter(|r| *r != middle)
        .find_map(|r| Some((r, choose(search, r, near).ok()?)))
        .ok_or(error)
}

/// The table with its proof. A contact that leaves its piece between two places of the table and comes back is seen by the
/// proof: the table is made again with a place there.
fn settled(walker: &Walker, start: Place<f64>) -> Result<Spine, FilletError> {
    let mut stops: Vec<f64> = Vec::new();
    let mut left = None;
    loop {
        let (breaks, pieces) = match walker.walk(start, &stops) {
            Ok(table) => table,
            Err(e) => return Err(left.unwrap_or(e)),
        };
        let mut spine = Spine::new(
            walker.supports.clone(),
            walker.radius.clone(),
            walker.guide.clone(),
            breaks,
            pieces,
        );
        match spine.settle() {
            Ok(()) => return Ok(spine),
            Err(Unsettled::Unproven { at }) => return Err(refused(&spine, 1, at, 0.0)),
            Err(Unsettled::Leaves { at, j }) => {
                let place = spine.centre(at) + walker.supports.origin;
                let leaves = FilletError::Leaves {
                    index: j / 2,
                    at,
                    place,
                };
                if stops.len() == MOST_STOPS || stops.contains(&at) {
                    return Err(leaves);
                }
                left = Some(leaves);
                stops.push(at);
                stops.sort_by(f64::total_cmp);
            }
        }
    }
}

/// The path with a guide that follows it: with too few points a spline may swing.
fn guided(
    search: &Search,
    radius: &Radius,
    (from, trace): (f64, &Trace),
) -> Result<(Path, NurbsCurve), FilletError> {
    let mut count = (trace.turn / GUIDE.1).ceil() as usize + 1;
    loop {
        count = count.clamp(GUIDE.0 + 1, MOST_POINTS);
        let path = Path::new(search, radius, (from, trace), count)?;
        let guide = path.guide()?;
        let samples = 8 * count;
        let follows = (0..=samples).all(|k| {
            let u = k as f64 / samples as f64;
            let (_, _, way) = trace.at(u);
            let d = guide.jet(u, Limit::Above, 1).d[1];
            d.dot(way) >= FOLLOWS * d.length()
        });
        if follows || count == MOST_POINTS {
            return Ok((path, guide));
        }
        count *= 2;
    }
}

/// Why a spine is refused, from the condition that is not met.
fn refused(spine: &Spine, condition: usize, at: f64, margin: f64) -> FilletError {
    let radius = spine.radius.series_at(at, Limit::Above, 0).value();
    let place = spine.centre(at) + spine.supports.origin;
    // What is tighter comes first: a ball that cuts into a support breaks the other conditions too.
    let cuts = |k: usize| {
        let fit = spine.fit(at, k).filter(|f| *f <= 0.0)?;
        Some(FilletError::CutsIn {
            index: k,
            place,
            radius,
            largest: radius / (1.0 - fit),
        })
    };
    let unproven = FilletError::Unproven { at, place };
    match condition {
        0 => FilletError::Radius { at, value: radius },
        1 => (0..2).find_map(cuts).unwrap_or(unproven),
        2 => FilletError::Swallowed { at, margin },
        3 => FilletError::SectionsCross { at, radius },
        k => cuts(k - 4).unwrap_or(unproven),
    }
}

/// The value of a radius, which must be positive.
fn radius_at(radius: &Radius, at: f64) -> Result<f64, FilletError> {
    let value = radius.series_at(at, Limit::Above, 0).value();
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(FilletError::Radius { at, value })
    }
}

/// The middle of the box around samples of the smaller surface, and the size of both.
fn middle_and_size(surfaces: &[SurfaceRef; 2]) -> (DVec3, f64) {
    const SAMPLES: usize = 9;
    let boxes = surfaces.each_ref().map(|s| {
        let domain = s.domain();
        let at = |k: usize| {
            let f = |i: usize, d: Interval| d.lo + d.width() * i as f64 / (SAMPLES - 1) as f64;
            let uv = [f(k / SAMPLES, domain[0]), f(k % SAMPLES, domain[1])];
            s.point([0, 1].map(|d: usize| uv[d].min(domain[d].hi)))
        };
        (0..SAMPLES * SAMPLES)
            .map(at)
            .filter(|p| p.is_finite())
            .fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(lo, hi), p| {
                (lo.min(p), hi.max(p))
            })
    });
    let size = boxes.map(|(lo, hi)| (hi - lo).length());
    let (lo, hi) = boxes[usize::from(size[1] < size[0])];
    (0.5 * (lo + hi), size[0].min(size[1]))
}

/// The path to take for a radius. What is nearest to a point that is given decides, also if it cannot be taken.
fn choose(search: &Search, radius: f64, near: Option<DVec3>) -> Result<Trace, FilletError> {
    let origin = search.supports().origin;
    if let Some(near) = near.filter(|p| !p.is_finite()) {
        return Err(FilletError::Near { near });
    }
    let (all, lost) = search.traces(radius);
    let tracer = search.tracer(radius);
    let (mut traces, mut bad) = (Vec::new(), Vec::new());
    let away = |t: &Trace| near.map_or(0.0, |p| t.distance(p - origin));
    for trace in all {
        match tracer.tightest(&trace) {
            None => traces.push(trace),
            Some((index, centre, fit)) => {
                let error = FilletError::CutsIn {
                    index,
                    place: centre + origin,
                    radius,
                    largest: radius / (1.0 - fit),
                };
                bad.push((away(&trace), fit, error));
            }
        }
    }
    for l in &lost {
        let away = near.map_or(0.0, |p| l.centre.distance(p - origin));
        bad.push((away, f64::INFINITY, lost_at(&tracer, l)));
    }
    // The nearest, of those the one that cuts in most.
    bad.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    let bad = bad.into_iter().next();
    traces.sort_by(|a, b| away(a).total_cmp(&away(b)));
    if near.is_none() && traces.len() > 1 {
        return Err(FilletError::Several {
            count: traces.len(),
            places: traces.iter().map(|t| t.at(0.5).1 + origin).collect(),
        });
    }
    match (traces.into_iter().next(), bad) {
        (Some(trace), Some((nearer, _, error))) => {
            if near.is_some() && nearer < away(&trace) {
                return Err(error);
            }
            Ok(trace)
        }
        (Some(trace), None) => Ok(trace),
        (None, Some((_, _, error))) => Err(error),
        (None, None) => Err(FilletError::NoBall {
            radius,
            fits: search.fits(radius).map(|(r, p)| (r, p + origin)),
        }),
    }
}

/// Why a ball could not be followed.
fn lost_at(tracer: &Tracer, lost: &Lost) -> FilletError {
    let place = lost.centre + tracer.supports.origin;
    let domain = tracer.supports.domain();
    let state = tracer.supports.state(lost.x, domain, tracer.radius);
    let tight = state.and_then(|s| {
        let (k, fit) = [0, 1]
            .map(|k| (k, s.fit(k)))
            .into_iter()
            .min_by(|a, b| a.1.total_cmp(&b.1))?;
        (fit < TIGHT).then_some((k, fit, tracer.radius / (1.0 - fit)))
    });
    match tight {
        Some((index, fit, largest)) if fit <= 0.0 => FilletError::CutsIn {
            index,
            place,
            radius: tracer.radius,
            largest,
        },
        near => FilletError::Lost {
            place,
            radius: tracer.radius,
            tight: near.map(|(index, _, largest)| (index, largest)),
        },
    }
}

/// Points of the centre's path, from which the guide is made.
struct Path {
    start: Place<f64>,
    closed: bool,
    centres: Vec<DVec3>,
}

/// What finds balls of other radii beside the path of one radius.
struct Beside<'a> {
    search: &'a Search<'a>,
    trace: &'a Trace,
    radius: f64,
}

impl Beside<'_> {
    /// The place of a ball of another radius, in the plane at a length along the path or its straight continuation.
    fn place(&self, radius: f64, length: f64) -> Result<Place<f64>, FilletError> {
        let whole = self.trace.length();
        let (x, c, d) = self.trace.at(length / whole);
        let point = c + d * (length - length.clamp(0.0, whole));
        let tracer = self.search.tracer(radius);
        let found = (1..=RADII).try_fold(x, |x, k| {
            let r = self.radius + (radius - self.radius) * k as f64 / RADII as f64;
            self.search.tracer(r).in_plane(x, point, d)
        });
        found.ok_or_else(|| lost_at(&tracer, &Lost { x, centre: c }))
    }

    /// Where a ball of another radius comes to the start (0) or the end (1) of its own path, from as near as it touches
    /// both: the length along the main path, and the place.
    fn end(&self, radius: f64, which: usize) -> Result<(f64, Place<f64>), FilletError> {
        let tracer = self.search.tracer(radius);
        let whole = self.trace.length();
        let mut error = None;
        for inset in INSETS {
            let share = if which == 0 { inset } else { 1.0 - inset };
            let x = match self.place(radius, share * whole) {
                Ok(x) => x,
                Err(e) => {
                    error.get_or_insert(e);
                    continue;
                }
            };
            let Some(sample) = tracer.inside(x).and_then(|x| tracer.at(x)) else {
                continue;
            };
            let sense = if which == 0 { -1.0 } else { 1.0 };
            match tracer.walk(&sample, sense) {
                Ok((samples, false)) => {
                    let last = &samples[samples.len() - 1];
                    let (_, c, d) = self.trace.at(which as f64);
                    let along = which as f64 * whole + (last.centre - c).dot(d);
                    return Ok((along, last.x));
                }
                Ok(_) => {}
                Err(l) => {
                    error.get_or_insert(lost_at(&tracer, &l));
                }
            }
        }
        Err(error.unwrap_or_else(|| {
            let (x, centre, _) = self.trace.at(which as f64);
            lost_at(&tracer, &Lost { x, centre })
        }))
    }
}

impl Path {
    /// Along the path of one radius, `from`. A ball of another radius is beside it, in the plane square to it, at a share of
    /// the way between the ends that it has itself: it need not roll anywhere else.
    fn new(
        search: &Search,
        radius: &Radius,
        (from, main): (f64, &Trace),
        count: usize,
    ) -> Result<Self, FilletError> {
        if main.closed {
            let [from, to] = [radius_at(radius, 0.0)?, radius_at(radius, 1.0)?];
            if (to - from).abs() > SAME_RADIUS * from {
                return Err(FilletError::Unclosed { from, to });
            }
        }
        let shares = shares(main, count);
        let mut centres = Vec::with_capacity(shares.len());
        let mut start = main.samples[0].x;
        let last = shares.len() - 1;
        let beside = Beside {
            search,
            trace: main,
            radius: from,
        };
        // Where the path of the first and of the last radius end, as lengths along the main one.
        let mut ends = [0.0, main.length()];
        if let (Radius::Along(_), false) = (radius, main.closed) {
            let [first, end] = [0, 1].map(|k| beside.end(radius_at(radius, k as f64)?, k));
            let ((begin, x), (stop, _)) = (first?, end?);
            (ends, start) = ([begin, stop], x);
        } else if let Radius::Along(_) = radius {
            start = beside.place(radius_at(radius, 0.0)?, 0.0)?;
        }
        for (i, &share) in shares.iter().enumerate() {
            let r = radius_at(radius, share)?;
            let tracer = search.tracer(r);
            let x = match i {
                0 => start,
                i if i == last && main.closed => start,
                i if i == last && matches!(radius, Radius::Constant(_)) => {
                    main.samples[main.samples.len() - 1].x
                }
                _ => beside.place(r, ends[0] + share * (ends[1] - ends[0]))?,
            };
            let sample = tracer.at(x).ok_or_else(|| {
                let centre = main.at(share).1;
                lost_at(&tracer, &Lost { x, centre })
            })?;
            centres.push(sample.centre);
        }
        if main.closed {
            centres[last] = centres[0];
        }
        Ok(Self {
            start,
            closed: main.closed,
            centres,
        })
    }

    fn guide(&self) -> Result<NurbsCurve, FilletError> {
        let options = InterpolateOptions {
            degree: GUIDE.0,
            closed: self.closed,
            ..Default::default()
        };
        interpolate(&self.centres, options).map_err(FilletError::Guide)
    }
}

/// Shares of the length for the guide's points: evenly in length, and in turn with half the weight.
fn shares(trace: &Trace, n: usize) -> Vec<f64> {
    let mut measure = vec![0.0];
    let mut before = DVec3::ZERO;
    let (length, whole) = (trace.length(), trace.turn.max(1.0));
    for w in trace.samples.windows(2) {
        let way = w[1].centre - w[0].centre;
        let direction = way.try_normalize().unwrap_or(before);
        let turn = if before == DVec3::ZERO {
            0.0
        } else {
            before.angle_between(direction)
        };
        before = direction;
        let last = measure[measure.len() - 1];
        measure.push(last + way.length() / length + 0.5 * turn / whole);
    }
    let total = measure[measure.len() - 1];
    (0..n)
        .map(|k| {
            if k + 1 == n {
                return 1.0;
            }
            let at = total * k as f64 / (n - 1) as f64;
            let i = measure
                .partition_point(|m| *m <= at)
                .clamp(1, measure.len() - 1);
            let f = ((at - measure[i - 1]) / (measure[i] - measure[i - 1])).clamp(0.0, 1.0);
            let [a, b] = [i - 1, i].map(|i| trace.samples[i].length);
            (a + f * (b - a)) / length
        })
        .collect()
}

/// Goes along the guide and makes the table of contacts, with breaks where the contacts pass breaks of their supports.
struct Walker<'a> {
    tracer: Tracer<'a>,
    supports: &'a Supports,
    radius: &'a Radius,
    guide: &'a CurveRef,
}

impl Walker<'_> {
    fn lost(&self, x: Place<f64>, u: f64) -> FilletError {
        let centre = self.guide.point(u);
        let tracer = Tracer {
            supports: self.supports,
            radius: self.radius.series_at(u, Limit::Above, 0).value(),
            size: self.tracer.size,
        };
        lost_at(&tracer, &Lost { x, centre })
    }

    /// Newton's method in the guide's plane at a parameter.
    fn solve(
        &self,
        mut x: Place<f64>,
        within: Place<Interval>,
        u: f64,
        limit: Limit,
    ) -> Option<Place<f64>> {
        let course = course(self.guide.as_ref(), self.radius, u, limit, 0);
        let mut last = f64::INFINITY;
        for _ in 0..NEWTON {
            let (step, length) = newton(self.supports, x, within, &course)?;
            if length >= 0.5 * last {
                break;
            }
            (0..4).for_each(|j| x[j] += step[j]);
            last = length;
        }
        (last <= 1e-9 * self.tracer.size).then_some(x)
    }

    /// The derivatives of the contacts at a parameter.
    fn slope(
        &self,
        x: Place<f64>,
        within: Place<Interval>,
        u: f64,
        limit: Limit,
    ) -> Option<Place<f64>> {
        let (s, t) = self.by_parameter(x, within, u, limit)?;
        let d = self.guide.jet(u, limit, 1).d[1];
        let inverse = s.inverse([s.columns[0].dot(d), s.columns[1].dot(d), 0.0, 0.0])?;
        let slope = (-(inverse * t)).to_array();
        slope.iter().all(|x| x.is_finite()).then_some(slope)
    }

    /// The equations at a place, and their derivatives by u.
    fn by_parameter(
        &self,
        x: Place<f64>,
        within: Place<Interval>,
        u: f64,
        limit: Limit,
    ) -> Option<(super::contact::State, glam::DVec4)> {
        let g = self.guide.jet(u, limit, 2).d;
        let r = self.radius.series_at(u, limit, 1);
        let s = self.supports.state(x, within, r.value())?;
        let n = s.normals;
        let plane = (n[0] * r.c[1] - g[1]).dot(g[1]) + (s.centres[0] - g[0]).dot(g[2]);
        let gap = (n[0] - n[1]) * r.c[1];
        Some((s, gap.extend(plane)))
    }

    /// The parameter and the contacts where one of them reaches a value.
    fn land(
        &self,
        mut x: Place<f64>,
        within: Place<Interval>,
        mut u: f64,
        j: usize,
        end: f64,
    ) -> Option<(f64, Place<f64>)> {
        let mut last = f64::INFINITY;
        for _ in 0..NEWTON {
            x[j] = end;
            let (s, t) = self.by_parameter(x, within, u, Limit::Below)?;
            let [g, d] = [0, 1].map(|k| self.guide.jet(u, Limit::Below, 1).d[k]);
            let c = s.columns;
            let mut columns = [
                c[0].extend(c[0].dot(d)),
                c[1].extend(c[1].dot(d)),
                (-c[2]).extend(0.0),
                (-c[3]).extend(0.0),
            ];
            columns[j] = t;
            let [a, b, e, f] = columns;
            let value = s.gap().extend((s.centres[0] - g).dot(d));
            let step = (-(super::contact::invert(a, b, e, f)? * value)).to_array();
            let mut moved = step;
            moved[j] = 0.0;
            let length = s.speed(moved) + (d * step[j]).length();
            if length >= 0.5 * last {
                break;
            }
            last = length;
            for k in 0..4 {
                if k == j {
                    u += step[k];
                } else {
                    x[k] += step[k];
                }
            }
        }
        (last <= 1e-9 * self.tracer.size && u.is_finite()).then_some((u, x))
    }

    /// The breaks of the table and its pieces, with a place at each of some parameters, which increase.
    fn walk(
        &self,
        start: Place<f64>,
        stops: &[f64],
    ) -> Result<(Vec<Break>, Vec<Piece>), FilletError> {
        let lessened = |breaks: &[Break], by: i32| -> Vec<Break> {
            let less = |b: &Break| Break::new(b.at, b.smooth - by);
            breaks.iter().map(less).collect()
        };
        // The guide's derivative is in the equations, and theirs in the sections; the radius' in the sections.
        let guide = lessened(self.guide.breaks(), 2);
        let radius = match self.radius {
            Radius::Constant(_) => Vec::new(),
            Radius::Along(f) => lessened(f.breaks(), 1),
        };
        let events = merge_breaks([&guide[..], &radius[..]]);
        let mut breaks = vec![events[0]];
        let mut pieces = Vec::new();
        let domain = self.supports.domain();
        let (mut u, mut x) = (0.0, start);
        // The sense of the path decides which pieces it starts in.
        let any = self
            .slope(x, domain, u, Limit::Above)
            .ok_or_else(|| self.lost(x, u))?;
        let mut within = self.supports.pieces(x, any);
        x = self
            .solve(x, within, u, Limit::Above)
            .ok_or_else(|| self.lost(x, u))?;
        let mut d = self
            .slope(x, within, u, Limit::Above)
            .ok_or_else(|| self.lost(x, u))?;
        let mut nodes = vec![Node { u, x, d }];
        let mut next = 1;
        let longest = 1.0 / (STEPS * (events.len() - 1) as f64);
        let mut step = longest;
        let mut count = 0;
        while next < events.len() {
            count += 1;
            if count > MOST_STEPS {
                return Err(self.lost(x, u));
            }
            let event = events[next];
            let stop = stops[stops.partition_point(|s| *s <= u + SHORTEST)..].first();
            let goal = stop.map_or(event.at, |s| s.min(event.at));
            let to = if step >= (goal - u) * (1.0 - 1e-9) {
                goal
            } else {
                u + step
            };
            let foreseen: Place<f64> = std::array::from_fn(|j| x[j] + d[j] * (to - u));
            let found = self.solve(foreseen, within, to, Limit::Below).filter(|y| {
                let off: Place<f64> = std::array::from_fn(|j| y[j] - foreseen[j]);
                let way: Place<f64> = std::array::from_fn(|j| d[j] * (to - u));
                let state = self.supports.state(x, within, self.tracer.radius);
                state.is_some_and(|s| s.speed(off) <= ASTRAY * s.speed(way))
            });
            let Some(y) = found else {
                step = 0.5 * (to - u);
                if step < SHORTEST {
                    return Err(self.lost(x, u));
                }
                continue;
            };
            let piece = Piece {
                within,
                nodes: Vec::new(),
            };
            let leaves = |y: Place<f64>, j: usize| piece.leaves(y, j, domain[j].width());
            let mut ends: Vec<(f64, usize, f64)> = (0..4)
                .filter(|&j| leaves(y, j))
                .map(|j| {
                    let end = y[j].clamp(within[j].lo, within[j].hi);
                    (((end - x[j]) / (y[j] - x[j])).clamp(0.0, 1.0), j, end)
                })
                .collect();
            // The end of the path lies on the end of a support, within rounding.
            if to == 1.0
                && ends
                    .iter()
                    .all(|&(_, j, end)| (y[j] - end).abs() <= 1e-9 * domain[j].width())
            {
                ends.clear();
            }
            if ends.is_empty() {
                (u, x) = (to, y);
                d = self
                    .slope(x, within, u, Limit::Below)
                    .ok_or_else(|| self.lost(x, u))?;
                nodes.push(Node { u, x, d });
                step = (1.6 * step).min(longest);
                if u == event.at {
                    let mut smooth = event.smooth;
                    pieces.push(Piece {
                        within,
                        nodes: std::mem::take(&mut nodes),
                    });
                    next += 1;
                    if next < events.len() {
                        let before = within;
                        within = self.supports.pieces(x, d);
                        // A contact may pass a break of its support at the same place.
                        for j in (0..4).filter(|&j| within[j] != before[j]) {
                            let end = if within[j].lo == before[j].hi {
                                within[j].lo
                            } else {
                                within[j].hi
                            };
                            smooth = smooth.min(self.smooth_at(j, end));
                            self.check_crease((before, x), (within, x), u, j)?;
                        }
                        d = self
                            .slope(x, within, u, Limit::Above)
                            .ok_or_else(|| self.lost(x, u))?;
                        nodes.push(Node { u, x, d });
                        step = longest;
                    }
                    breaks.push(Break::new(event.at, smooth));
                }
                continue;
            }
            ends.sort_by(|a, b| a.0.total_cmp(&b.0));
            let landed = ends.iter().find_map(|&(share, j, end)| {
                let guess = std::array::from_fn(|k| x[k] + share * (y[k] - x[k]));
                let (at, z) = self.land(guess, within, u + share * (to - u), j, end)?;
                let slack = |k: usize| 1e3 * AT_BREAK * domain[k].width();
                let inside = (0..4)
                    .all(|k| z[k] >= within[k].lo - slack(k) && z[k] <= within[k].hi + slack(k));
                // Not where the contact has just come in.
                let inwards = if end == within[j].hi { -d[j] } else { d[j] };
                let entered = nodes.len() == 1 && at - u <= ONE_PLACE && inwards > 0.0;
                let on = at >= u - ONE_PLACE && at <= to + ONE_PLACE;
                (on && inside && !entered).then_some((at, z, j, end))
            });
            let Some((at, z, j, end)) = landed else {
                step = 0.5 * (to - u);
                if step < SHORTEST {
                    return Err(self.lost(x, u));
                }
                continue;
            };
            let smooth = self.smooth_at(j, end);
            let beyond = if end == domain[j].lo || end == domain[j].hi {
                let across = self.tracer_at(at).across_seam(z, j);
                across.ok_or_else(|| self.lost(z, at))?
            } else {
                z
            };
            let before = within;
            let fresh = at - u > ONE_PLACE;
            if fresh || nodes.len() > 1 {
                // A step may have ended on this end by itself: the place landed on is its last node then.
                let at = if event.at - at.max(u) <= ONE_PLACE {
                    event.at
                } else if fresh {
                    at
                } else {
                    nodes.pop();
                    u
                };
                d = self
                    .slope(z, within, at, Limit::Below)
                    .ok_or_else(|| self.lost(z, at))?;
                nodes.push(Node { u: at, x: z, d });
                pieces.push(Piece {
                    within,
                    nodes: std::mem::take(&mut nodes),
                });
                let break_smooth = if at == event.at {
                    smooth.min(event.smooth)
                } else {
                    smooth
                };
                breaks.push(Break::new(at, break_smooth));
                if at == event.at {
                    next += 1;
                }
                u = at;
            } else {
                // The piece has just begun: two ends at one place.
                nodes.clear();
                let last = breaks.len() - 1;
                let b = &breaks[last];
                breaks[last] = Break::new(b.at, b.smooth.min(smooth));
            }
            x = beyond;
            within = self.supports.pieces(x, d);
            if within == before && x == z {
                // The direction is not decided by the rounding of the slope: the piece beyond this end.
                let sign = if end == within[j].hi { 1.0 } else { -1.0 };
                let mut towards = d;
                towards[j] = sign;
                within = self.supports.pieces(x, towards);
            }
            self.check_crease((before, z), (within, x), u, j)?;
            if next < events.len() {
                d = self
                    .slope(x, within, u, Limit::Above)
                    .ok_or_else(|| self.lost(x, u))?;
                nodes.push(Node { u, x, d });
            }
        }
        Ok((breaks, pieces))
    }

    fn tracer_at(&self, u: f64) -> Tracer<'_> {
        Tracer {
            supports: self.supports,
            radius: self.radius.series_at(u, Limit::Above, 0).value(),
            size: self.tracer.size,
        }
    }

    /// How smooth the contacts are where one passes a break: one order less than its support, whose normal enters.
    fn smooth_at(&self, j: usize, at: f64) -> i32 {
        let breaks = self.supports.breaks(j);
        let n = breaks.len();
        let inner = breaks[1..n - 1].iter().find(|b| b.at == at);
        inner.map_or(0, |b| (b.smooth - 1).max(0))
    }

    /// An edge of a support that a contact cannot pass.
    fn check_crease(
        &self,
        (before, x): (Place<Interval>, Place<f64>),
        (after, y): (Place<Interval>, Place<f64>),
        u: f64,
        j: usize,
    ) -> Result<(), FilletError> {
        let radius = self.radius.series_at(u, Limit::Above, 0).value();
        let normal = |x, within| {
            let s = self.supports.state(x, within, radius)?;
            Some((s.normals[j / 2], s.contacts(radius)[j / 2]))
        };
        match (normal(x, before), normal(y, after)) {
            (Some((m, p)), Some((n, _))) => {
                let angle = m.angle_between(n);
                if angle <= CREASE {
                    return Ok(());
                }
                Err(FilletError::Crease {
                    index: j / 2,
                    place: p + self.supports.origin,
                    angle,
                })
            }
            _ => Err(self.lost(x, u)),
        }
    }
}
