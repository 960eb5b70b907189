//! How extreme curvatures change when a surface moves.
//!
//! With the forms I and II of the surface r in its parameters, and I', II' their derivatives along the velocity r':
//!
//! * `N' = r'_u × r_v + r_u × r'_v` and `n' = (N' - n (n·N'))/|N|`, so `II'_uu = n'·r_uu + n·r'_uu`, and so on;
//! * `K = det II / det I` and `H = (EN - 2FM + GL)/(2 det I)` by the rule of the quotient;
//! * a principal curvature k with direction x, `xᵀ I x = 1`: `k' = xᵀ (II' - k I') x`. At an umbilic all directions are
//!   principal: the larger curvature goes on with the greatest of these to one side, and with the least to the other.
//!
//! Source: do Carmo, *Differential geometry of curves and surfaces*, §3.3, differentiated.
//!
//! The derivative of the greatest value over the surface is that of the value in the place where it is reached (the
//! envelope theorem); reached in several places it has a derivative to either side, the greatest and the least of
//! these (Danskin). A sharper bend elsewhere is looked for by samples: all here is estimated.

use super::curvature::{CLEAR, CurvatureExtremes, GAUSSIAN, K1, K2, MEAN, curvature, longest};
use super::rate::Moving;
use super::search::{Extreme, beside};
use crate::breaks::Limit;
use crate::mesh::Certainty;
use crate::surface::{Dir, Surface, SurfaceJet};
use glam::DVec3;
use smallvec::SmallVec;

/// Derivatives of an extreme, to one side and to the other; most often they are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ExtremeRate {
    /// The lesser and the greater. At a knot that moves, where the curvature has no ridge that samples see, the derivatives lie
    /// between them.
    pub range: [f64; 2],
    /// How far each may be off; never proven.
    pub certainty: Certainty,
}

/// Derivatives of [`CurvatureExtremes`]; `None` where an extreme is infinite, or no place has one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CurvatureRate {
    /// Of the least and greatest Gaussian curvature.
    pub gaussian: [Option<ExtremeRate>; 2],
    /// Of the least and greatest mean curvature.
    pub mean: [Option<ExtremeRate>; 2],
    /// Of the greatest of the larger principal curvature.
    pub k1: Option<ExtremeRate>,
    /// Of the least of the smaller principal curvature.
    pub k2: Option<ExtremeRate>,
}

/// The curvatures of a place and their derivatives: K, H, k1, k2. Those of principal curvatures may be two.
struct Place {
    values: [f64; 4],
    rates: [[f64; 2]; 4],
}

/// Principal curvatures that differ by no more than this share are those of an umbilic.
const UMBILIC: f64 = 1e-7;

/// A symmetric form on the parameters: uu, uv, vv.
type Form = [f64; 3];

fn apply(f: Form, [u, v]: [f64; 2]) -> f64 {
    f[0] * u * u + 2.0 * f[1] * u * v + f[2] * v * v
}

/// `uu·vv + vv·uu - 2 uv·uv` of two forms: twice the determinant if they are the same.
fn mixed(a: Form, b: Form) -> f64 {
    a[0] * b[2] + a[2] * b[0] - 2.0 * a[1] * b[1]
}

/// The curvatures where surface and velocity have these jets of order 2.
fn place(r: &SurfaceJet, w: &SurfaceJet) -> Option<Place> {
    let c = curvature(r)?;
    let (r, w) = (&r.d, &w.d);
    let (ru, rv, wu, wv) = (r[1], r[2], w[1], w[2]);
    let normal = ru.cross(rv);
    let length = normal.length();
    let n = normal / length;
    let turned = wu.cross(rv) + ru.cross(wv);
    let nn = (turned - n * n.dot(turned)) / length;
    let one: Form = [ru.dot(ru), ru.dot(rv), rv.dot(rv)];
    let one_rate: Form = [2.0 * ru.dot(wu), ru.dot(wv) + rv.dot(wu), 2.0 * rv.dot(wv)];
    let two: Form = [3, 4, 5].map(|k| n.dot(r[k]));
    let two_rate: Form = [3, 4, 5].map(|k| nn.dot(r[k]) + n.dot(w[k]));
    let det = 0.5 * mixed(one, one);
    let det_rate = mixed(one, one_rate);
    let gaussian = (mixed(two, two_rate) - c.gaussian * det_rate) / det;
    let trace_rate = mixed(one_rate, two) + mixed(one, two_rate);
    let mean = (0.5 * trace_rate - c.mean * det_rate) / det;
    // Along a unit tangent in the basis of r_u and r_v.
    let along = |k: f64, d: DVec3| {
        let (a, b) = (ru.dot(d), rv.dot(d));
        let x = [
            (one[2] * a - one[1] * b) / det,
            (one[0] * b - one[1] * a) / det,
        ];
        let moved: Form = [0, 1, 2].map(|i| two_rate[i] - k * one_rate[i]);
        (moved, x)
    };
    let [d1, d2] = c.directions;
    let (is_umbilic, k) = (
        c.k1 - c.k2 <= UMBILIC * c.k1.abs().max(c.k2.abs()),
        [c.k1, c.k2],
    );
    let [k1, k2] = if is_umbilic {
        let (moved, x) = along(c.mean, d1);
        let y = along(c.mean, d2).1;
        let (p, s) = (apply(moved, x), apply(moved, y));
        let q = moved[0] * x[0] * y[0]
            + moved[1] * (x[0] * y[1] + x[1] * y[0])
            + moved[2] * x[1] * y[1];
        let (middle, spread) = (0.5 * (p + s), (0.5 * (p - s)).hypot(q));
        [[middle - spread, middle + spread]; 2]
    } else {
        [(k[0], d1), (k[1], d2)].map(|(k, d)| {
            let (moved, x) = along(k, d);
            [apply(moved, x); 2]
        })
    };
    let found = Place {
        values: [c.gaussian, c.mean, c.k1, c.k2],
        rates: [[gaussian; 2], [mean; 2], k1, k2],
    };
    let all = found.rates.iter().flatten();
    all.copied().all(f64::is_finite).then_some(found)
}

/// Lines of samples in each direction, and the most places from where better ones are looked for.
const LINES: usize = 25;
const CLIMBS: usize = 12;
/// Steps of a climb, in parts of the domain: the first, and the last. A value errs by the square of the last.
const STEPS: [f64; 2] = [0.02, 1e-9];
/// The most steps of a climb.
const MOST: usize = 200;
/// Values that differ by no more than this share of the extreme's unit are the same extreme.
const SAME: f64 = 1e-8;
/// Rates that differ by no more than this share are the same.
const NEAR: f64 = 1e-6;

/// What is at a place from one side.
struct Side {
    limit: [Limit; 2],
    value: f64,
    rates: [f64; 2],
}

struct Search<'a> {
    surface: &'a dyn Surface,
    velocity: &'a dyn Surface,
    /// The longest tangents: near a pole, where one is far shorter, curvatures are rounding.
    longest: [f64; 2],
    quantity: usize,
    sign: f64,
}

impl Search<'_> {
    /// Values, times the sign, and rates at a place, from all sides of it.
    fn sides(&self, uv: [f64; 2]) -> SmallVec<[Side; 1]> {
        const SIDES: [Limit; 2] = [Limit::Above, Limit::Below];
        let domain = self.surface.domain();
        let at_break = [Dir::U, Dir::V].map(|dir| {
            let d = usize::from(dir == Dir::V);
            [self.surface, self.velocity]
                .iter()
                .any(|s| s.breaks(dir).iter().any(|b| b.at == uv[d]))
        });
        let limits = |d: usize| &SIDES[..if at_break[d] { 2 } else { 1 }];
        let mut all = SmallVec::new();
        for &u in limits(0) {
            for &v in limits(1) {
                let limit = [u, v];
                let inside = (0..2).all(|d| match limit[d] {
                    Limit::Above => uv[d] < domain[d].hi,
                    Limit::Below => uv[d] > domain[d].lo,
                });
                if !inside {
                    continue;
                }
                let jets = [self.surface, self.velocity].map(|s| s.jet(uv, limit, 2));
                let short = |d: usize| jets[0].d[1 + d].length() < CLEAR * self.longest[d];
                if short(0) || short(1) {
                    continue;
                }
                if let Some(p) = place(&jets[0], &jets[1]) {
                    all.push(Side {
                        limit,
                        value: self.sign * p.values[self.quantity],
                        rates: p.rates[self.quantity],
                    });
                }
            }
        }
        all
    }

    /// The greatest value at a place.
    fn value(&self, uv: [f64; 2]) -> Option<f64> {
        let values = self.sides(uv).into_iter().map(|s| s.value);
        values.reduce(f64::max)
    }

    /// The greatest value at a place, and its rates.
    fn moving(&self, uv: [f64; 2]) -> Option<(f64, [f64; 2])> {
        let sides = self.sides(uv);
        let top = sides.iter().map(|s| s.value).reduce(f64::max)?;
        let level: SmallVec<[&Side; 4]> = sides
            .iter()
            .filter(|s| s.value >= top - SAME * top.abs())
            .collect();
        if let [a, b] = level[..]
            && let Some(both) = self.ridge(uv, top, [a, b])
        {
            return Some((top, both));
        }
        let least = level.iter().map(|s| s.rates[0]);
        let greatest = level.iter().map(|s| s.rates[1]);
        let rates = [
            least.fold(f64::INFINITY, f64::min),
            greatest.fold(f64::NEG_INFINITY, f64::max),
        ];
        Some((top, rates))
    }

    /// The rates where the value falls to both sides of a break that may itself move, as knots do: with slopes a and b
    /// the two sides meet, a moment dp later, at the height `top + (a R' + b L')/(a + b) dp`.
    fn ridge(&self, uv: [f64; 2], top: f64, sides: [&Side; 2]) -> Option<[f64; 2]> {
        let d = (0..2).find(|&d| sides[0].limit[d] != sides[1].limit[d])?;
        let step = 1e-6 * self.surface.domain()[d].width();
        let falls = |side: &Side| {
            let mut p = uv;
            p[d] += if side.limit[d] == Limit::Above {
                step
            } else {
                -step
            };
            Some((top - self.value(p)?) / step)
        };
        let [a, b] = [falls(sides[0])?, falls(sides[1])?];
        let is_ridge = a > 0.0 && b > 0.0 && sides[0].limit[1 - d] == sides[1].limit[1 - d];
        is_ridge.then(|| [0, 1].map(|k| (a * sides[1].rates[k] + b * sides[0].rates[k]) / (a + b)))
    }

    /// From a place to better ones beside it.
    fn climb(&self, from: [f64; 2], steps: [f64; 2]) -> Option<([f64; 2], f64)> {
        let domain = self.surface.domain();
        let (mut uv, mut value) = (from, self.value(from)?);
        let mut step = steps[0];
        for _ in 0..MOST {
            if step <= steps[1] {
                break;
            }
            let mut moved = false;
            for (d, way) in [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)] {
                let p = beside(domain, uv, d, way * step);
                // Along level ground no step counts.
                if let Some(x) = self.value(p).filter(|x| *x > value + 1e-15 * value.abs()) {
                    (uv, value, moved) = (p, x, true);
                }
            }
            if !moved {
                step *= 0.5;
            }
        }
        Some((uv, value))
    }

    /// The rates of all places that were found where the value is as great as at `uv`.
    fn rate(&self, extreme: &Extreme, unit: f64) -> Option<ExtremeRate> {
        if !extreme.value.is_finite() {
            return None;
        }
        let (first, top) = self.climb(extreme.uv, [1e-4, STEPS[1]])?;
        let domain = self.surface.domain();
        let line =
            |d: usize, k: usize| domain[d].lo + domain[d].width() * k as f64 / (LINES - 1) as f64;
        // Places all over, and along the lines through the extreme: of turned surfaces it is a circle.
        let mut places: Vec<[f64; 2]> = Vec::new();
        for k in 0..LINES {
            places.push([first[0], line(1, k)]);
            places.push([line(0, k), first[1]]);
            places.extend((0..LINES).map(|i| [line(0, i), line(1, k)]));
        }
        let mut ranked: Vec<(f64, [f64; 2])> = places
            .into_iter()
            .filter_map(|p| Some((self.value(p)?, p)))
            .collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let mut found = vec![(first, top)];
        let level = ranked.iter().take_while(|p| p.0 >= top - SAME * unit);
        found.extend(level.map(|&(x, p)| (p, x)));
        let levels = found.len() - 1;
        let below = ranked.iter().skip(levels).take(CLIMBS);
        found.extend(below.filter_map(|p| self.climb(p.1, STEPS)));
        let greatest = found.iter().map(|f| f.1).fold(top, f64::max);
        let mut range = [f64::INFINITY, f64::NEG_INFINITY];
        let mut error = 0.0f64;
        for (uv, value) in found {
            if value < greatest - SAME * unit {
                continue;
            }
            let Some((_, rates)) = self.moving(uv) else {
                continue;
            };
            range = [range[0].min(rates[0]), range[1].max(rates[1])];
            // What the last step of a climb may miss, a few times over; beside a pole, what lies between its samples and it.
            let around = |step: f64| {
                [(0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)]
                    .map(|(d, way)| self.moving(beside(domain, uv, d, way * step)))
            };
            let close = around(STEPS[1] * 1e3);
            let (near, level) = if close.iter().any(Option::is_none) {
                (around(CLEAR), f64::NEG_INFINITY)
            } else {
                (close, greatest - SAME * unit)
            };
            for (_, other) in near.into_iter().flatten().filter(|n| n.0 >= level) {
                error = error
                    .max((other[0] - rates[0]).abs())
                    .max((other[1] - rates[1]).abs());
            }
        }
        if range[0] > range[1] {
            return None;
        }
        let size = range[0].abs().max(range[1].abs());
        if range[1] - range[0] <= NEAR * size + 2.0 * error {
            let middle = 0.5 * (range[0] + range[1]);
            error += 0.5 * (range[1] - range[0]);
            range = [middle; 2];
        }
        Some(ExtremeRate {
            range,
            certainty: Certainty::Estimated(error + 1e-12 * size),
        })
    }
}

/// The derivatives of the extremes of a moving surface's curvature, which are given. Units: of the curvature by that
/// of the parameter.
///
/// Estimated: the place of the extreme, and others where it is reached too, are looked for by samples. Cost: some thousand
/// evaluations for each of the six numbers.
pub fn curvature_rate(part: &Moving, extremes: &CurvatureExtremes) -> CurvatureRate {
    let Some(velocity) = &part.velocity else {
        let still = Some(ExtremeRate {
            range: [0.0; 2],
            certainty: Certainty::Exact,
        });
        let unless = |e: &Extreme| still.filter(|_| e.value.is_finite());
        return CurvatureRate {
            gaussian: [0, 1].map(|k| unless(&extremes.gaussian[k])),
            mean: [0, 1].map(|k| unless(&extremes.mean[k])),
            k1: unless(&extremes.k1),
            k2: unless(&extremes.k2),
        };
    };
    let reach = longest(part.surface.as_ref());
    let unit = extremes.k1.value.abs().max(extremes.k2.value.abs());
    let of = |quantity: usize, sign: f64, extreme: &Extreme| {
        let unit = if quantity == GAUSSIAN {
            unit * unit
        } else {
            unit
        };
        let search = Search {
            surface: part.surface.as_ref(),
            velocity: velocity.as_ref(),
            longest: reach,
            quantity,
            sign,
        };
        search.rate(extreme, unit)
    };
    let both =
        |quantity: usize, e: &[Extreme; 2]| [of(quantity, -1.0, &e[0]), of(quantity, 1.0, &e[1])];
    CurvatureRate {
        gaussian: both(GAUSSIAN, &extremes.gaussian),
        mean: both(MEAN, &extremes.mean),
        k1: of(K1, 1.0, &extremes.k1),
        k2: of(K2, -1.0, &extremes.k2),
    }
}
