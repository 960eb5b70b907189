//! How figures change when surfaces move: shape derivatives, from the velocities of
//! [`velocity`](crate::velocity).
//!
//! With the velocity r' of the surface r and `n = r_u × r_v`, at fixed parameters:
//!
//! * area: `∫ n/|n| · (r'_u × r_v + r_u × r'_v) du dv`;
//! * the integral of a fixed function over what closed surfaces enclose: `∮ f r'·n du dv` (Hadamard): so volume, first and
//!   second moments have one factor in common;
//! * the greatest coordinate: that coordinate of the velocity where it is reached (the envelope theorem). Reached in
//!   several places it has a derivative to either side, the greatest and the least of these (Danskin).

use super::area::normal;
use super::centroid::{AreaCentroid, Centroid, from};
use super::inertia::Inertia;
use super::integral::{
    DEGREE, Expansion, Form, Goal, IntegralOptions, Measured, ORDER, integrate, measured,
};
use super::opening::{Opening, opening};
use super::solid::{PAIRS, Solid};
use super::taylor::{Patch, Taylor};
use super::volume::{joints_of, openings};
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit, merge_breaks};
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Dir, Surface, SurfaceRef};
use glam::DVec3;

/// A surface and its velocity, over the same domain; `None`: it does not move.
#[derive(Clone, Debug)]
pub struct Moving {
    /// The surface.
    pub surface: SurfaceRef,
    /// Its velocity, at fixed parameters or of points that slide along these, continuously: the figures are the same.
    pub velocity: Option<SurfaceRef>,
}

/// A surface that is cut also where its velocity is.
#[derive(Debug)]
struct Cut {
    surface: SurfaceRef,
    breaks: [Vec<Break>; 2],
}

impl Surface for Cut {
    fn breaks(&self, dir: Dir) -> &[Break] {
        &self.breaks[usize::from(dir == Dir::V)]
    }
    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        self.surface.jet_into(uv, limit, order, out);
    }
    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]) {
        self.surface.enclose_piece(uv, limit, order, out);
    }
}

impl Moving {
    /// The surface for integrals over both, and the velocity, if it moves.
    fn cut(&self) -> Option<(Cut, &SurfaceRef)> {
        let velocity = self.velocity.as_ref()?;
        let merged = |dir: Dir| merge_breaks([self.surface.breaks(dir), velocity.breaks(dir)]);
        let cut = Cut {
            surface: self.surface.clone(),
            breaks: [merged(Dir::U), merged(Dir::V)],
        };
        Some((cut, velocity))
    }

    /// The greatest speed found at samples.
    pub(super) fn speed(&self) -> f64 {
        const STEPS: usize = 8;
        let Some(velocity) = &self.velocity else {
            return 0.0;
        };
        let domain = velocity.domain();
        let at = |d: usize, k: usize| {
            domain[d].lo + (domain[d].hi - domain[d].lo) * k as f64 / STEPS as f64
        };
        let places = (0..=STEPS).flat_map(|i| (0..=STEPS).map(move |j| (i, j)));
        let speeds = places.map(|(i, j)| velocity.point([at(0, i), at(1, j)]).length());
        speeds.filter(|s| s.is_finite()).fold(0.0, f64::max)
    }
}

/// Half the diagonal of a box around surfaces, and its middle; from samples.
fn reach(parts: &[Moving]) -> f64 {
    let sizes = parts.iter().map(|p| super::size(p.surface.as_ref()));
    sizes.fold(0.0, f64::max)
}

fn certainty(value: Interval, proven: bool) -> Measured {
    let m = measured(value, f64::NAN);
    let error = m.certainty.error();
    Measured {
        certainty: if proven && error.is_finite() {
            Certainty::Bounded(error)
        } else {
            Certainty::Estimated(error)
        },
        ..m
    }
}

fn is_proven(c: Certainty) -> bool {
    !matches!(c, Certainty::Estimated(_))
}

/// What a measured number may be.
fn interval(m: Measured) -> Interval {
    Interval::point(m.value).inflate(m.certainty.error())
}

/// A centroid from a reference point.
fn off(c: &Centroid, reference: DVec3) -> [Interval; 3] {
    let way = Box3::point(c.point) - Box3::point(reference);
    way.to_array().map(|i| i.inflate(c.certainty.error()))
}

/// How area and centroid change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AreaRate {
    /// The derivative of the area.
    pub area: Measured,
    /// That of the centroid; `None` where the centroid is not known.
    pub centroid: Option<[Measured; 3]>,
}

/// The derivatives of the area of surfaces and of its centroid, which are given.
///
/// `options.relative` is relative to the largest of the area's derivative and of speed times size. Errors are bounds,
/// or infinite where nothing can be proven. Cost: a few times that of the area.
pub fn area_rate(parts: &[Moving], whole: &AreaCentroid, options: &IntegralOptions) -> AreaRate {
    let about = whole.centroid.map_or(DVec3::ZERO, |c| c.point);
    let half = reach(parts).max(f64::MIN_POSITIVE);
    let units = [1.0, half, half, half];
    let mut sum = [Interval::ZERO; 4];
    for part in parts {
        let Some((cut, velocity)) = part.cut() else {
            continue;
        };
        let integrand = |surface: &dyn Surface, uv: [Interval; 2]| {
            let [p, q] = [surface, velocity.as_ref()].map(|s| Patch::new(s, uv, ORDER));
            let at = element(&p.at, &q.at, about, None);
            let tight = |t: Taylor| t.tightened(&at.square, p.offset);
            let wide = element(&p.wide, &q.wide, about, Some(&tight));
            let pairs = wide.integrands.into_iter().zip(at.integrands);
            Ok(form(p.offset, pairs))
        };
        let goal = Goal {
            units: &units,
            relative: options.relative,
            least: options.relative * part.speed() * half,
            budget: options.budget,
        };
        let found = integrate(&[&cut], &integrand, &goal);
        for (sum, found) in sum.iter_mut().zip(&found[0]) {
            *sum = *sum + *found;
        }
    }
    let [area, first @ ..] = sum;
    let known = is_proven(whole.area.certainty);
    let centroid = whole.centroid.map(|c| {
        let proven = known && is_proven(c.certainty);
        let [way, size] = [off(&c, about), [interval(whole.area); 3]];
        [0, 1, 2].map(|k| certainty((first[k] - way[k] * area) / size[k], proven))
    });
    AreaRate {
        area: certainty(area, true),
        centroid,
    }
}

fn form(offset: [Interval; 2], pairs: impl Iterator<Item = (Taylor, Taylor)>) -> Form {
    Form {
        integrands: pairs.map(|(a, b)| Expansion::Enclosed([a, b])).collect(),
        offset,
        exchanged: false,
        absolute: false,
        weight: None,
    }
}

/// The rates of `|n|` and of `|n| (r - about)`.
struct Element {
    /// `|n|²`.
    square: Taylor,
    integrands: Vec<Taylor>,
}

fn element(
    jet: &[Box3],
    rate: &[Box3],
    about: DVec3,
    tight: Option<&dyn Fn(Taylor) -> Taylor>,
) -> Element {
    let vector = |jet: &[Box3], d: [usize; 2]| Taylor::vector(jet, d, DEGREE);
    let [ru, rv] = [vector(jet, [1, 0]), vector(jet, [0, 1])];
    let [du, dv] = [vector(rate, [1, 0]), vector(rate, [0, 1])];
    let n = Taylor::cross(&ru, &rv);
    let [a, b] = [Taylor::cross(&du, &rv), Taylor::cross(&ru, &dv)];
    let m = [0, 1, 2].map(|k| a[k].add(&b[k]));
    let square = Taylor::square(&n);
    let length = match tight {
        Some(tight) => tight(square.clone()),
        None => square.clone(),
    }
    .sqrt();
    let mut e = Taylor::dot(&n, &m).div(&length);
    // Where n may vanish there is no quotient, but n/|n| · m is no longer than m.
    let most = Box3::from(m.each_ref().map(|t| t.c[0])).norm().hi;
    if most.is_finite() {
        e.c[0] = e.c[0].meet(Interval::new(-most, most));
    }
    let moment = |axis: usize| {
        let r = from(about, jet, axis, DEGREE);
        let v = Taylor::coordinate(rate, axis, [0, 0], DEGREE);
        r.mul(&e).add(&v.mul(&length))
    };
    let [x, y, z] = [0, 1, 2].map(moment);
    Element {
        square,
        integrands: vec![e, x, y, z],
    }
}

/// How what a shell encloses changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolidRate {
    /// The derivative of the volume.
    pub volume: Measured,
    /// That of the centroid; `None` where the centroid is not known.
    pub centroid: Option<[Measured; 3]>,
    /// That of the inertia tensor about the centroid, density 1; `None` as the centroid.
    pub inertia: Option<[[Measured; 3]; 3]>,
    /// That of the principal moments, in the order of these; `None` also where nothing tells an axis from another.
    pub principal: Option<[Measured; 3]>,
}

/// Radians. Axes that may be off by more do not tell how a principal moment changes.
const UNTOLD: f64 = 0.1;

/// The derivatives of what a shell encloses. `parts` are all surfaces that the indices of the shell mean, `weld` the
/// distance within which sides were joined, both as given to [`solids`](super::solids).
///
/// Proven as the volume is: gaps along the joints count with the area of the strips that close them times the greatest
/// speed. Error: a joint opens (found at samples), so that nothing is closed beside this place.
pub fn solid_rate(
    parts: &[Moving],
    solid: &Solid,
    weld: Option<f64>,
    options: &IntegralOptions,
) -> Result<SolidRate, Opening> {
    let surfaces: Vec<SurfaceRef> = parts.iter().map(|m| m.surface.clone()).collect();
    let (joined, weld) = joints_of(&surfaces, &solid.shell, weld);
    let is_own = |k: usize| solid.shell.surfaces.iter().any(|f| f.0 == k);
    if let Some(opening) = opening(parts, &joined, is_own, weld) {
        return Err(opening);
    }
    let own: Vec<&Moving> = solid.shell.surfaces.iter().map(|f| &parts[f.0]).collect();
    let cloned: Vec<Moving> = own.iter().map(|m| (*m).clone()).collect();
    let half = reach(&cloned).max(f64::MIN_POSITIVE);
    let about = solid.centroid.map_or_else(
        || {
            own.first()
                .map_or(DVec3::ZERO, |m| m.surface.bounds(m.surface.domain()).mid())
        },
        |c| c.point,
    );
    let mut units = vec![1.0, half, half, half];
    units.extend([half * half; 6]);
    let mut sum = [Interval::ZERO; 10];
    let mut fastest: f64 = 0.0;
    for (part, &(_, inwards)) in own.iter().zip(&solid.shell.surfaces) {
        let Some((cut, velocity)) = part.cut() else {
            continue;
        };
        let bounds = velocity.bounds(velocity.domain());
        fastest = fastest.max(bounds.norm().hi);
        let flux = |jet: &[Box3], rate: &[Box3]| {
            let n = normal(jet, DEGREE);
            let v = Taylor::vector(rate, [0, 0], DEGREE);
            let r = [0, 1, 2].map(|axis| from(about, jet, axis, DEGREE));
            let q = Taylor::dot(&v, &n);
            let first = r.each_ref().map(|r| r.mul(&q));
            let second = PAIRS.map(|[i, j]| r[i].mul(&first[j]));
            let mut all = vec![q];
            all.extend(first);
            all.extend(second);
            all
        };
        let integrand = |surface: &dyn Surface, uv: [Interval; 2]| {
            let [p, q] = [surface, velocity.as_ref()].map(|s| Patch::new(s, uv, ORDER));
            let (wide, at) = (flux(&p.wide, &q.wide), flux(&p.at, &q.at));
            Ok(form(p.offset, wide.into_iter().zip(at)))
        };
        let goal = Goal {
            units: &units,
            relative: options.relative,
            least: options.relative * part.speed() * half * half,
            budget: options.budget,
        };
        let found = integrate(&[&cut], &integrand, &goal);
        for (sum, found) in sum.iter_mut().zip(&found[0]) {
            *sum = if inwards {
                *sum - *found
            } else {
                *sum + *found
            };
        }
    }
    let (strips, strips_proven) = if fastest > 0.0 {
        openings(&surfaces, &solid.shell, &joined, weld, options)
    } else {
        (0.0, true)
    };
    let lost = Interval::point(strips) * Interval::point(fastest);
    let far = Interval::point(2.0 * half);
    for (k, sum) in sum.iter_mut().enumerate() {
        let most = lost * far.powi([0, 1, 1, 1, 2, 2, 2, 2, 2, 2][k]);
        *sum = sum.inflate(most.hi);
    }
    let proven = strips_proven && is_proven(solid.shell.volume.certainty);
    let [volume, x, y, z, second @ ..] = sum;
    let first = [x, y, z];
    let size = interval(solid.shell.volume);
    let known = solid.centroid.filter(|_| size.lo > 0.0);
    let centroid = known.map(|c| {
        let way = off(&c, about);
        [0, 1, 2].map(|k| certainty((first[k] - way[k] * volume) / size, proven))
    });
    let tensor = known.map(|c| {
        // The second moments about the centroid: its own motion does not count, since the first vanish there.
        let way = off(&c, about).map(|i| -i);
        let mut p = [[Interval::ZERO; 3]; 3];
        for ([i, j], &m) in PAIRS.into_iter().zip(&second) {
            let moved = m + way[i] * first[j] + way[j] * first[i] + way[i] * way[j] * volume;
            p[i][j] = moved;
            p[j][i] = moved;
        }
        let trace = p[0][0] + p[1][1] + p[2][2];
        let mut inertia = p.map(|row| row.map(|x| -x));
        for k in 0..3 {
            inertia[k][k] = match k {
                0 => p[1][1] + p[2][2],
                1 => p[0][0] + p[2][2],
                _ => p[0][0] + p[1][1],
            }
            .meet(trace - p[k][k]);
        }
        inertia
    });
    let principal = tensor
        .zip(solid.inertia)
        .and_then(|(t, i)| principal(&t, &i, proven));
    Ok(SolidRate {
        volume: certainty(volume, proven),
        centroid,
        inertia: tensor.map(|t| t.map(|row| row.map(|x| certainty(x, proven)))),
        principal,
    })
}

/// The rates of the principal moments: `x · T' x` for unit axes x. An axis that is off by an angle θ changes that by
/// no more than `2 θ |T'|`.
fn principal(rate: &[[Interval; 3]; 3], inertia: &Inertia, proven: bool) -> Option<[Measured; 3]> {
    if inertia.turned.iter().any(|t| t.error() >= UNTOLD) {
        return None;
    }
    let rows = rate.map(Box3::from);
    let size = rows.iter().map(|r| r.norm().hi.powi(2)).sum::<f64>().sqrt();
    Some([0, 1, 2].map(|k| {
        let x = Box3::point(inertia.axes[k]);
        let image = Box3::from(rows.map(|r| r.dot(x)));
        let slack = Interval::point(2.0 * size) * Interval::point(inertia.turned[k].error());
        let own = proven && is_proven(inertia.turned[k]);
        // And for the rounding of the axis' length.
        certainty(x.dot(image).inflate(slack.hi + 1e-14 * size), own)
    }))
}

/// How a face of the box around surfaces moves.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FaceRate {
    /// The derivatives to either side lie in this range: one number but for its error, unless the surfaces reach the face
    /// in several places that move apart.
    pub range: Interval,
    /// True if places that move differently could not be told from those that touch the face.
    pub between: bool,
}

/// Cells looked at for a face.
const CELLS: usize = 3000;
/// Halvings of the whole domain: below, cells are all rounding.
const ROUNDS: usize = 80;
/// Relative to the greatest speed: a range narrower than this needs no more work.
const CLOSE: f64 = 1e-9;
/// Relative to the size: a cell whose greatest point and bound differ by less is flat.
const FLAT: f64 = 1e-12;
/// Relative to size and speed: less is rounding.
const NO_CHANGE: f64 = 1e-13;
/// Wider than this, it tells that the face touches in several places.
const APART: f64 = 1e-3;

/// How the least (false) and the greatest (true) coordinate along an axis change. `None` if nothing bounds the surfaces.
pub fn face_rate(parts: &[Moving], axis: usize, greatest: bool) -> Option<FaceRate> {
    struct Cell {
        part: usize,
        uv: [Interval; 2],
        most: f64,
        /// The greatest at points of it that were looked at.
        found: f64,
        depth: [usize; 2],
    }
    let signed = |b: Box3| {
        let i = b.to_array()[axis];
        if greatest { i } else { -i }
    };
    let cuts: Vec<[Vec<Break>; 2]> = parts
        .iter()
        .map(|p| {
            let own = |dir: Dir| match &p.velocity {
                Some(v) => merge_breaks([p.surface.breaks(dir), v.breaks(dir)]),
                None => p.surface.breaks(dir).to_vec(),
            };
            [own(Dir::U), own(Dir::V)]
        })
        .collect();
    let most = |part: usize, uv: [Interval; 2]| signed(parts[part].surface.bounds(uv)).hi;
    let mut best = f64::NEG_INFINITY;
    let mut cells = Vec::new();
    for (part, [bu, bv]) in cuts.iter().enumerate() {
        for i in 0..bu.pieces() {
            for j in 0..bv.pieces() {
                let uv = [bu.piece(i), bv.piece(j)];
                let most = most(part, uv);
                cells.push(Cell {
                    part,
                    uv,
                    most,
                    found: f64::NEG_INFINITY,
                    depth: [0; 2],
                });
            }
        }
    }
    let speed = parts.iter().map(Moving::speed).fold(0.0, f64::max);
    let velocity = |c: &Cell| match &parts[c.part].velocity {
        Some(v) => v.bounds(c.uv).to_array()[axis],
        None => Interval::ZERO,
    };
    let size = reach(parts).max(f64::MIN_POSITIVE);
    // How much place and velocity change along a direction, through the middle of a cell.
    let varies = |c: &Cell, d: usize| {
        let along = [c.uv[d].lo, c.uv[d].mid(), c.uv[d].hi].map(|t| {
            let mut uv = c.uv.map(Interval::mid);
            uv[d] = t;
            let place = parts[c.part].surface.point(uv)[axis] / size;
            let own = parts[c.part].velocity.as_ref();
            let rate = own.map_or(0.0, |v| v.point(uv)[axis] / speed);
            [place, rate]
        });
        let width = |k: usize| {
            let [a, b, c] = along.map(|x| x[k]);
            a.max(b).max(c) - a.min(b).min(c)
        };
        let sum = width(0) + width(1);
        if sum > NO_CHANGE { sum } else { 0.0 }
    };
    let mut looks = 0;
    let mut range: Option<Interval> = None;
    for _ in 0..ROUNDS {
        // Corners and middles are points of the surface: the face is beyond all of them.
        for c in &mut cells {
            let [u, v] = c.uv;
            for uv in [
                [u.mid(), v.mid()],
                [u.lo, v.lo],
                [u.lo, v.hi],
                [u.hi, v.lo],
                [u.hi, v.hi],
            ] {
                let point = parts[c.part].surface.bounds(uv.map(Interval::point));
                c.found = c.found.max(signed(point).lo);
            }
        }
        best = cells.iter().fold(best, |best, c| best.max(c.found));
        cells.retain(|c| c.most >= best || c.most.is_nan());
        let now = cells.iter().map(&velocity).reduce(Interval::hull)?;
        range = Some(range.map_or(now, |r| r.meet(now)));
        looks += cells.len();
        if now.width() <= CLOSE * speed || looks > CELLS {
            break;
        }
        let mut next = Vec::with_capacity(2 * cells.len());
        for c in cells {
            // Flat in the face, and moving as one: nothing would come of halves.
            let flat = c.most - c.found <= FLAT * size.max(c.most.abs());
            if flat && velocity(&c).width() <= CLOSE * speed {
                next.push(c);
                continue;
            }
            let [du, dv] = [0, 1].map(|d| varies(&c, d));
            let by_depth = usize::from(c.depth[1] < c.depth[0]);
            let d = if du == dv {
                by_depth
            } else {
                usize::from(dv > du)
            };
            let m = c.uv[d].mid();
            let mut depth = c.depth;
            depth[d] += 1;
            if m <= c.uv[d].lo || m >= c.uv[d].hi {
                next.push(Cell { depth, ..c });
                continue;
            }
            for (lo, hi) in [(c.uv[d].lo, m), (m, c.uv[d].hi)] {
                let mut uv = c.uv;
                uv[d] = Interval::new(lo, hi);
                let most = most(c.part, uv).min(c.most);
                next.push(Cell {
                    uv,
                    most,
                    found: f64::NEG_INFINITY,
                    depth,
                    ..c
                });
            }
        }
        cells = next;
    }
    let range = range.filter(|r| r.is_finite())?;
    Some(FaceRate {
        range,
        between: range.width() > APART * speed,
    })
}
