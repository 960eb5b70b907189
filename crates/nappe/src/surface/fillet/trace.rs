//! Following a ball of one radius along both supports: from a place where it touches both, in both directions, until a
//! contact reaches the end of its support or the path closes.

use super::contact::{AT_BREAK, Fourth, Place, State, Supports};
use glam::DVec3;

/// The turn of the centre's direction in one step, in radians, at most.
const TURN: f64 = 0.15;
/// Relative to a step: how far the place found may be from the one foreseen.
const ASTRAY: f64 = 0.3;
/// Relative to the size of both supports: the first step, and the shortest.
const STEPS: [f64; 2] = [0.01, 1e-9];
/// Relative to a step: a way so short has no direction.
const STAYS: f64 = 1e-6;
/// The most steps in one direction.
const MOST: usize = 20_000;
/// The most steps of Newton's method. From a good start it needs three or four.
const NEWTON: usize = 12;
/// Relative to the size: points of two sides so near are one (a seam), and normals that differ by less than this (radians).
const SEAM: [f64; 2] = [1e-9, 1e-6];

/// A place on the path.
#[derive(Clone, Debug)]
pub(super) struct Sample {
    pub x: Place<f64>,
    pub centre: DVec3,
    pub contacts: [DVec3; 2],
    /// The length of the centre's path up to here.
    pub length: f64,
}

/// The path of a ball of one radius.
#[derive(Clone, Debug)]
pub(super) struct Trace {
    pub samples: Vec<Sample>,
    pub closed: bool,
    /// The sum of all turns of the centre's direction, in radians.
    pub turn: f64,
}

/// The ball could not be followed beyond a place.
#[derive(Clone, Debug)]
pub(super) struct Lost {
    pub x: Place<f64>,
    pub centre: DVec3,
}

/// Follows balls of one radius.
pub(super) struct Tracer<'a> {
    pub supports: &'a Supports,
    pub radius: f64,
    /// The size of both supports.
    pub size: f64,
}

impl Tracer<'_> {
    fn state(&self, x: Place<f64>) -> Option<State> {
        self.supports.state(x, self.supports.domain(), self.radius)
    }

    fn sample(&self, x: Place<f64>) -> Option<Sample> {
        let s = self.state(x)?;
        Some(Sample {
            x,
            centre: s.centres[0],
            contacts: s.contacts(self.radius),
            length: 0.0,
        })
    }

    /// Newton's method for the contacts, with a fourth equation.
    pub(super) fn solve(
        &self,
        mut x: Place<f64>,
        fourth: impl Fn(&State, Place<f64>) -> Fourth,
    ) -> Option<Place<f64>> {
        let mut last = f64::INFINITY;
        for _ in 0..NEWTON {
            let s = self.state(x)?;
            let step = s.step(&fourth(&s, x))?;
            let length = s.speed(step) + s.gap().length();
            (0..4).for_each(|j| x[j] += step[j]);
            let small = length <= 1e-9 * self.radius + 1e-12 * s.centres[0].length();
            if small && length >= 0.25 * last || length == 0.0 {
                return Some(x);
            }
            if length.is_nan() || length > 1e3 * self.size {
                return None;
            }
            last = length;
        }
        (last <= 1e-9 * self.radius + 1e-12 * self.size).then_some(x)
    }

    /// The surface, and the place along a path, into which the ball cuts most, with what its curvature leaves to the ball;
    /// `None` if the ball fits everywhere.
    pub(super) fn tightest(&self, trace: &Trace) -> Option<(usize, DVec3, f64)> {
        let states = trace.samples.iter().filter_map(|s| self.state(s.x));
        states
            .flat_map(|s| [0, 1].map(|k| (k, s.centres[0], s.fit(k))))
            .filter(|(_, _, fit)| *fit <= 0.0)
            .min_by(|a, b| a.2.total_cmp(&b.2))
    }

    /// The place where the ball touches both, square to the way to it from another place.
    pub(super) fn nearest(&self, x: Place<f64>) -> Option<Place<f64>> {
        let x = self.solve(x, |s, _| Fourth {
            value: 0.0,
            row: weighted(s, s.null()),
        })?;
        self.inside(x)
    }

    /// The place with the centre in a plane.
    pub(super) fn in_plane(
        &self,
        x: Place<f64>,
        point: DVec3,
        normal: DVec3,
    ) -> Option<Place<f64>> {
        self.solve(x, |s, _| plane(s, point, normal))
    }

    /// A place in the domains, moved onto their ends from beyond them by rounding only.
    pub(super) fn inside(&self, mut x: Place<f64>) -> Option<Place<f64>> {
        for (x, d) in x.iter_mut().zip(self.supports.domain()) {
            let slack = AT_BREAK * d.width();
            if !(*x >= d.lo - slack && *x <= d.hi + slack) {
                return None;
            }
            *x = x.clamp(d.lo, d.hi);
        }
        Some(x)
    }

    /// The path through a place where the ball touches both. u runs along `n0 × n2`.
    pub(super) fn trace(&self, x: Place<f64>) -> Result<Trace, Lost> {
        let start = self.sample(x).ok_or(Lost {
            x,
            centre: DVec3::NAN,
        })?;
        let (mut samples, closed) = self.walk(&start, 1.0)?;
        if !closed {
            let (back, _) = self.walk(&start, -1.0)?;
            samples = back.into_iter().skip(1).rev().chain(samples).collect();
        }
        let mut turn = 0.0;
        let mut direction = DVec3::ZERO;
        for i in 1..samples.len() {
            let way = samples[i].centre - samples[i - 1].centre;
            samples[i].length = samples[i - 1].length + way.length();
            if let Some(d) = way.try_normalize() {
                if direction != DVec3::ZERO {
                    turn += direction.angle_between(d);
                }
                direction = d;
            }
        }
        Ok(Trace {
            samples,
            closed,
            turn,
        })
    }

    /// The path from a place in one sense; whether it closes.
    pub(super) fn walk(&self, start: &Sample, sense: f64) -> Result<(Vec<Sample>, bool), Lost> {
        let domain = self.supports.domain();
        let mut samples = vec![start.clone()];
        let mut step = STEPS[0] * self.size;
        let mut x = start.x;
        let mut heading: Option<DVec3> = None;
        let lost = |x: Place<f64>, samples: &[Sample]| Lost {
            x,
            centre: samples[samples.len() - 1].centre,
        };
        for _ in 0..MOST {
            let here = self.state(x).ok_or_else(|| lost(x, &samples))?;
            let mut ahead = self.ahead(&here).ok_or_else(|| lost(x, &samples))?;
            // The first direction is that of n0 × n2, the others go on.
            let way = here.centre_along(ahead);
            let onwards = match heading {
                Some(h) => way.dot(h),
                None => sense * way.dot(here.normals[0].cross(here.normals[1])),
            };
            if onwards < 0.0 {
                ahead = ahead.map(|a| -a);
            }
            let next = loop {
                if step < STEPS[1] * self.size {
                    return Err(lost(x, &samples));
                }
                let mut to: Place<f64> = std::array::from_fn(|j| x[j] + step * ahead[j]);
                for (j, d) in domain.iter().enumerate() {
                    if (to[j] - to[j].clamp(d.lo, d.hi)).abs() <= AT_BREAK * d.width() {
                        to[j] = to[j].clamp(d.lo, d.hi);
                    }
                }
                let found = self.forward(x, &here, ahead, to, step);
                if let Some((y, fast)) = found {
                    let taken = step;
                    if fast {
                        step *= 1.6;
                    }
                    break (y, taken);
                }
                step *= 0.5;
            };
            let ((y, end), taken) = next;
            let sample = self.sample(y).ok_or_else(|| lost(x, &samples))?;
            let from = &samples[samples.len() - 1];
            // Two contacts may reach their seams at one place: the way between is rounding, and no heading.
            let way = sample.centre - from.centre;
            if way.length() > STAYS * taken {
                heading = way.try_normalize().or(heading);
            }
            if samples.len() > 2 && passes(start, from, &sample, taken) {
                samples.push(start.clone());
                return Ok((samples, true));
            }
            samples.push(sample);
            x = y;
            if let Some(j) = end {
                match self.across_seam(x, j) {
                    Some(y) => {
                        let sample = self.sample(y).ok_or_else(|| lost(x, &samples))?;
                        samples.push(sample);
                        x = y;
                    }
                    None => return Ok((samples, false)),
                }
            }
        }
        Err(lost(x, &samples))
    }

    /// The direction of the path in parameters, one unit of length a unit for the fastest of centre and contacts.
    fn ahead(&self, s: &State) -> Option<Place<f64>> {
        let d = s.null();
        let speed = s.speed(d);
        (speed > 0.0 && speed.is_finite()).then(|| d.map(|x| x / speed))
    }

    /// One step: the place reached, with the parameter that ended it, and whether the next may be longer.
    #[allow(clippy::type_complexity)]
    fn forward(
        &self,
        x: Place<f64>,
        here: &State,
        ahead: Place<f64>,
        to: Place<f64>,
        step: f64,
    ) -> Option<((Place<f64>, Option<usize>), bool)> {
        let domain = self.supports.domain();
        let row = weighted(here, ahead);
        let found = self.solve(to, |_, y| Fourth {
            value: (0..4).map(|j| row[j] * (y[j] - to[j])).sum(),
            row,
        });
        let leaves = |y: Place<f64>, j: usize| {
            let slack = AT_BREAK * domain[j].width();
            y[j] < domain[j].lo - slack || y[j] > domain[j].hi + slack
        };
        let outside = |y: Place<f64>| (0..4).any(|j| leaves(y, j));
        if let Some(y) = found
            && !outside(y)
            && !outside(to)
        {
            let there = self.state(y)?;
            let turn = here
                .centre_along(ahead)
                .angle_between(self.oriented(&there, ahead)?);
            let off: Place<f64> = std::array::from_fn(|j| y[j] - to[j]);
            let good = turn <= TURN && there.speed(off) <= ASTRAY * step;
            return good.then_some(((self.inside(y)?, None), turn < 0.4 * TURN));
        }
        // A contact reaches the end of its support: the nearest end first.
        let beyond = if outside(to) { to } else { found? };
        let mut ends: Vec<(f64, usize, f64)> = (0..4)
            .filter(|&j| leaves(beyond, j))
            .map(|j| {
                let end = beyond[j].clamp(domain[j].lo, domain[j].hi);
                ((end - x[j]) / (beyond[j] - x[j]), j, end)
            })
            .collect();
        ends.sort_by(|a, b| a.0.total_cmp(&b.0));
        ends.into_iter().find_map(|(share, j, end)| {
            let mut guess: Place<f64> = std::array::from_fn(|k| x[k] + share * (beyond[k] - x[k]));
            guess[j] = end;
            let y = self.land(guess, j, end)?;
            let y = self.inside(y)?;
            let off: Place<f64> = std::array::from_fn(|k| y[k] - x[k]);
            (here.speed(off) <= 1.5 * step).then_some(((y, Some(j)), false))
        })
    }

    /// The direction of the centre at a place, in the sense of a direction in parameters.
    fn oriented(&self, s: &State, like: Place<f64>) -> Option<DVec3> {
        let d = self.ahead(s)?;
        let way = s.centre_along(d);
        Some(if way.dot(s.centre_along(like)) < 0.0 {
            -way
        } else {
            way
        })
    }

    /// The place with one parameter given.
    fn land(&self, x: Place<f64>, j: usize, end: f64) -> Option<Place<f64>> {
        let mut y = self.solve(x, |s, y| {
            let mut row = [0.0; 4];
            row[j] = s.tangents[j].length();
            Fourth {
                value: row[j] * (y[j] - end),
                row,
            }
        })?;
        y[j] = end;
        Some(y)
    }

    /// The same place on the other side of a seam: where two opposite sides of a support are one.
    pub(super) fn across_seam(&self, x: Place<f64>, j: usize) -> Option<Place<f64>> {
        let d = self.supports.domain()[j];
        let mut y = x;
        y[j] = if x[j] == d.lo { d.hi } else { d.lo };
        let (a, b, k) = (self.state(x)?, self.state(y)?, j / 2);
        let apart = a.contacts(self.radius)[k].distance(b.contacts(self.radius)[k]);
        let kink = a.normals[k].angle_between(b.normals[k]);
        (apart <= SEAM[0] * self.size && kink <= SEAM[1]).then_some(y)
    }
}

/// The row of the equation that holds a place square to a direction, lengths in space counting.
fn weighted(s: &State, d: Place<f64>) -> Place<f64> {
    let weights = s.tangents.map(DVec3::length_squared);
    let row: Place<f64> = std::array::from_fn(|j| weights[j] * d[j]);
    let length = (0..4).map(|j| row[j] * d[j]).sum::<f64>().sqrt();
    row.map(|r| r / length)
}

/// The equation of a plane for the centre.
pub(super) fn plane(s: &State, point: DVec3, normal: DVec3) -> Fourth {
    Fourth {
        value: (s.centres[0] - point).dot(normal),
        row: [s.columns[0].dot(normal), s.columns[1].dot(normal), 0.0, 0.0],
    }
}

/// Whether a step passes a place.
fn passes(place: &Sample, from: &Sample, to: &Sample, step: f64) -> bool {
    let way = to.centre - from.centre;
    let share = (place.centre - from.centre).dot(way) / way.length_squared();
    if !(share > 0.0 && share <= 1.0) {
        return false;
    }
    let apart = |p: DVec3, a: DVec3, b: DVec3| p.distance(a.lerp(b, share));
    let mut all = [0, 1]
        .map(|k| apart(place.contacts[k], from.contacts[k], to.contacts[k]))
        .into_iter()
        .chain([apart(place.centre, from.centre, to.centre)]);
    all.all(|d| d <= 0.2 * step)
}

impl Trace {
    /// The length of the path.
    pub(super) fn length(&self) -> f64 {
        self.samples[self.samples.len() - 1].length
    }

    /// The parameters, centre and direction at a share of the length, between samples nearly.
    pub(super) fn at(&self, share: f64) -> (Place<f64>, DVec3, DVec3) {
        let s = &self.samples;
        let length = share * self.length();
        let after = s
            .partition_point(|p| p.length < length)
            .clamp(1, s.len() - 1);
        // Across a seam there are two samples at one place.
        let mut i = after;
        while i + 1 < s.len() && s[i].length <= s[i - 1].length {
            i += 1;
        }
        let (a, b) = (&s[i - 1], &s[i]);
        let f = ((length - a.length) / (b.length - a.length)).clamp(0.0, 1.0);
        let x = std::array::from_fn(|j| a.x[j] + f * (b.x[j] - a.x[j]));
        (
            x,
            a.centre.lerp(b.centre, f),
            (b.centre - a.centre).normalize_or_zero(),
        )
    }

    /// Whether a place where the ball touches both is on the path.
    pub(super) fn holds(&self, p: &Sample) -> bool {
        self.samples.windows(2).any(|w| {
            let step = w[0].centre.distance(w[1].centre);
            let step = step.max(w[0].contacts[0].distance(w[1].contacts[0]));
            let step = step.max(w[0].contacts[1].distance(w[1].contacts[1]));
            passes(p, &w[0], &w[1], step) || p.centre.distance(w[0].centre) <= 1e-6 * step
        })
    }

    /// The least distance of a point from the centres.
    pub(super) fn distance(&self, p: DVec3) -> f64 {
        let each = self.samples.iter().map(|s| s.centre.distance(p));
        each.fold(f64::INFINITY, f64::min)
    }
}

impl Tracer<'_> {
    /// A sample at a place.
    pub(super) fn at(&self, x: Place<f64>) -> Option<Sample> {
        self.sample(x)
    }
}
