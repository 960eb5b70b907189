//! Enclosures over many small rectangles, from Taylor polynomials over larger ones.
//!
//! Over a rectangle Q in which the surface is analytic, with the middle m,
//!
//! `r(p) ∈ Σ_{|a| ≤ n} ∂ᵃ r(m) (p - m)ᵃ / a!`, with the derivatives of order n taken from all of Q.
//!
//! So one enclosure of order n serves all parts of Q: the polynomial is moved to the middle of the part, where its range is
//! plain to see. If what is not known of the highest derivatives is too much for that, Q is quartered. To begin with, Q is
//! a piece of the surface. The answer for a rectangle does not depend on those asked for before.

use super::bound::ROUND_UP;
use super::partners::greatest;
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit, Part};
use crate::interval::Interval;
use crate::parallel;
use crate::surface::{Dir, Surface, jet_index, jet_len};
use glam::DVec3;
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// The order of Taylor's formula: of two cubic sides nothing is left.
pub(super) const ORDER: usize = 6;
/// Pieces along each direction that are enclosed together, by one thread.
const TILE: usize = 8;
/// A rectangle over more pieces is enclosed by itself.
const MOST: usize = 16;
/// A rectangle larger than this share of a piece is enclosed by itself,
const LARGE: f64 = 0.25;
/// unless it is one piece with at most so much around it.
const WHOLE: f64 = 1.5;
/// The most pieces that are kept.
const KEPT: usize = 1 << 15;
/// The share of derivatives that what is not known of them may be.
const SHARE: f64 = 1.0 / 64.0;
/// Likewise for what only the hull of the part itself tells.
const LOOSE: f64 = 1.0 / 16.0;
/// A part is taken to be at least this wide, in halves of the piece: powers of its size stay numbers.
const NARROWEST: f64 = 1e-40;
/// Rounding errors as a share of the sum of absolute terms: there are fewer operations, of half a unit each, between a term and
/// a sum, also if the polynomial is moved, scaled and evaluated (`parts`).
const ROUNDING: f64 = 64.0 * f64::EPSILON;

const DIRS: [Dir; 2] = [Dir::U, Dir::V];

/// A surface whose enclosures are prepared, for all threads that ask.
pub(super) struct Pieces<'a> {
    surface: &'a dyn Surface,
    tol: f64,
    /// For each tile of pieces, v fastest, its pieces, v fastest; made when they are first asked for.
    tiles: OnceLock<Vec<Mutex<Option<Tile>>>>,
    /// The number of pieces that are kept, with their quarters.
    kept: AtomicUsize,
    prepared: AtomicBool,
}

/// Some pieces that are enclosed together.
type Tile = Arc<[Piece]>;

impl<'a> Pieces<'a> {
    /// Enclosures that tell what a mesh within `tol` needs.
    pub(super) fn new(surface: &'a dyn Surface, tol: f64) -> Self {
        Self {
            surface,
            tol,
            tiles: OnceLock::new(),
            kept: AtomicUsize::new(0),
            prepared: AtomicBool::new(false),
        }
    }

    pub(super) fn surface(&self) -> &'a dyn Surface {
        self.surface
    }

    /// Encloses the jet of order 2 over a rectangle.
    pub(super) fn enclose(&self, uv: [Interval; 2]) -> Enclosed {
        let range = self.covered(uv);
        let shares = [0, 1].map(|d| {
            let breaks = self.surface.breaks(DIRS[d]);
            uv[d].width() / breaks.piece(breaks.find(uv[d].mid(), Limit::Above)).width()
        });
        let (share, count) = (shares[0] * shares[1], range[0].len() * range[1].len());
        let all = || {
            let in_v = |i: usize| range[1].clone().map(move |j| [i, j]);
            range[0].clone().flat_map(in_v).map(|at| self.piece(at))
        };
        let mut hull = None;
        if share <= LARGE && count <= MOST {
            all().for_each(|(tile, k)| tile[k].join(self, uv, &mut hull));
        } else if share <= WHOLE && count <= MOST && self.all_known() {
            let known = all().filter_map(|(tile, k)| tile[k].over(uv, self.tol));
            let jets: Option<Vec<Jet<Box3>>> = known.collect();
            let of_all = jets.into_iter().flatten();
            hull = of_all
                .reduce(|a, b| std::array::from_fn(|k| a[k].hull(b[k])))
                .map(|jet| Enclosed {
                    jet,
                    local: None,
                    sharp: true,
                });
        }
        hull.unwrap_or_else(|| Enclosed::direct(self.surface, uv))
    }

    /// The number of pieces.
    pub(super) fn count(&self) -> usize {
        let [n, m] = DIRS.map(|d| self.surface.breaks(d).pieces());
        n.saturating_mul(m)
    }

    /// Encloses all pieces, on some threads. For surfaces that have a piece in about every square.
    pub(super) fn prepare(&self, threads: usize) {
        if self.count() > KEPT || self.all_known() {
            return;
        }
        let count = DIRS.map(|d| self.surface.breaks(d).pieces());
        let tiles = count.map(|n| n.div_ceil(TILE));
        let tile = |k: usize| {
            self.piece([k / tiles[1] * TILE, k % tiles[1] * TILE]);
        };
        parallel::each(threads, tiles[0] * tiles[1], tile, |()| false);
        self.prepared.store(true, Ordering::Relaxed);
    }

    /// True if all pieces are enclosed.
    fn all_known(&self) -> bool {
        self.prepared.load(Ordering::Relaxed)
    }

    /// Encloses the jet over a rectangle more sharply: what is lost falls with the square of the size.
    pub(super) fn sharpened(&self, enclosed: Enclosed, uv: [Interval; 2]) -> Enclosed {
        let meet = |a: Jet<Box3>, b: Jet<Box3>| std::array::from_fn(|k| a[k].meet(b[k]));
        let halves = uv.map(|t| halves(t, t.mid()));
        let quarters = halves[0]
            .iter()
            .flat_map(|&u| halves[1].map(|v| self.enclose([u, v]).jet));
        let hull = quarters.reduce(|a, b| std::array::from_fn(|k| a[k].hull(b[k])));
        let mut jet = hull.map_or(enclosed.jet, |hull| meet(hull, enclosed.jet));
        // Over several pieces, whose expansions are hulled, the surface's own enclosure tells more.
        if !self.is_in_one(uv) {
            jet = meet(jet, Enclosed::direct(self.surface, uv).jet);
        }
        Enclosed { jet, ..enclosed }
    }

    /// What is known about a small rectangle in one piece.
    pub(super) fn local(&self, uv: [Interval; 2]) -> Option<Local> {
        let (tile, place) = self.piece(self.one(uv)?);
        let mut hull = None;
        tile[place].join(self, uv, &mut hull);
        hull.and_then(|h| h.local)
    }

    /// True for a rectangle in one piece.
    pub(super) fn is_in_one(&self, uv: [Interval; 2]) -> bool {
        self.one(uv).is_some()
    }

    /// The piece that a rectangle lies in, if it is one.
    fn one(&self, uv: [Interval; 2]) -> Option<[usize; 2]> {
        let range = self.covered(uv);
        let one = range.iter().all(|range| range.len() == 1);
        one.then(|| range.map(|range| range.start))
    }

    /// The pieces that a rectangle covers along u and v.
    fn covered(&self, uv: [Interval; 2]) -> [Range<usize>; 2] {
        [0, 1].map(|d| {
            let breaks = self.surface.breaks(DIRS[d]);
            breaks.find(uv[d].lo, Limit::Above)..breaks.find(uv[d].hi, Limit::Below) + 1
        })
    }

    /// The tile of a piece, and the piece's place there.
    fn piece(&self, at: [usize; 2]) -> (Tile, usize) {
        let count = DIRS.map(|d| self.surface.breaks(d).pieces());
        let tile = at.map(|k| k / TILE);
        let within = [0, 1].map(|d| tile[d] * TILE..count[d].min((tile[d] + 1) * TILE));
        let number = tile[0] * count[1].div_ceil(TILE) + tile[1];
        let place = (at[0] - within[0].start) * within[1].len() + at[1] - within[1].start;
        let tiles = self.tiles.get_or_init(|| {
            let tiles = count.map(|n| n.div_ceil(TILE));
            (0..tiles[0] * tiles[1]).map(|_| Mutex::new(None)).collect()
        });
        if self.kept.load(Ordering::Relaxed) > KEPT {
            tiles.iter().for_each(|t| *locked(t) = None);
            self.kept.store(0, Ordering::Relaxed);
        }
        let mut kept = locked(&tiles[number]);
        let tile = kept.get_or_insert_with(|| {
            let parts = [0, 1].map(|d| -> Vec<Interval> {
                let breaks = self.surface.breaks(DIRS[d]);
                within[d].clone().map(|k| breaks.piece(k)).collect()
            });
            self.pieces(parts).into()
        });
        (tile.clone(), place)
    }

    /// The pieces for each pair of a part of u and one of v.
    fn pieces(&self, parts: [Vec<Interval>; 2]) -> Vec<Piece> {
        self.kept
            .fetch_add(parts[0].len() * parts[1].len(), Ordering::Relaxed);
        Piece::all(self.surface, parts)
    }
}

/// A panic while it was locked has left nothing half done.
fn locked<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What is known about a rectangle.
pub(super) struct Enclosed {
    /// The jet of order 2.
    pub(super) jet: Jet<Box3>,
    /// If it lies in one piece.
    pub(super) local: Option<Local>,
    /// True if enclosures of its parts would hardly tell more.
    pub(super) sharp: bool,
}

impl Enclosed {
    fn direct(surface: &dyn Surface, uv: [Interval; 2]) -> Self {
        Self::from(surface.enclose(uv, 2))
    }
}

impl From<Vec<Box3>> for Enclosed {
    fn from(jet: Vec<Box3>) -> Self {
        Self {
            jet: std::array::from_fn(|k| jet[k]),
            local: None,
            sharp: true,
        }
    }
}

/// What is known about a rectangle in one piece.
pub(super) struct Local {
    /// The unit of parameters along u and v.
    pub(super) half: [f64; 2],
    /// Taylor's polynomial about its middle.
    pub(super) terms: Polynomial,
    /// How much the derivatives up to second order over the rectangle are off from those of the polynomial.
    pub(super) off: Jet<DVec3>,
}

/// A jet of order 2.
pub(super) type Jet<T> = [T; jet_len(2)];
/// The coefficients of `sⁱ tʲ`, at `[i][j]`.
pub(super) type Polynomial = [[DVec3; ORDER + 1]; ORDER + 1];

/// A rectangle in which the surface is analytic.
#[derive(Clone)]
struct Piece {
    uv: [Interval; 2],
    middle: [f64; 2],
    half: [f64; 2],
    /// About the middle, in halves of the rectangle; those of the highest order are the middles of what they are over it.
    terms: Polynomial,
    /// For each derivative, how much it is off for what is not known of those of the highest order, at the border.
    rest: Jet<DVec3>,
    /// Likewise for rounding and what is not known of the derivatives in the middle.
    noise: Jet<DVec3>,
    /// What is known over all of it.
    over: Jet<Box3>,
    quarters: OnceLock<Box<[Piece]>>,
}

impl Piece {
    /// For each pair of a part of u and one of v.
    fn all(surface: &dyn Surface, parts: [Vec<Interval>; 2]) -> Vec<Self> {
        let enclosed = |order: usize, of: fn(&Interval) -> Part| {
            let [us, vs] = parts
                .each_ref()
                .map(|p| p.iter().map(of).collect::<Vec<_>>());
            let mut out = vec![Box3::ENTIRE; us.len() * vs.len() * jet_len(order)];
            surface.enclose_pieces([&us, &vs], order, &mut out);
            out
        };
        let over = enclosed(ORDER, |&t| (t, Limit::Above));
        let at = enclosed(ORDER - 1, |t| (Interval::point(t.mid()), Limit::Above));
        let [us, vs] = &parts;
        let pairs = us.iter().flat_map(|&u| vs.iter().map(move |&v| [u, v]));
        let jets = over
            .chunks_exact(jet_len(ORDER))
            .zip(at.chunks_exact(jet_len(ORDER - 1)));
        pairs
            .zip(jets)
            .map(|(uv, (over, at))| Self::new(uv, over, at))
            .collect()
    }

    fn new(uv: [Interval; 2], over: &[Box3], at: &[Box3]) -> Self {
        let middle = uv.map(Interval::mid);
        let half = [0, 1].map(|d| farthest(uv[d], middle[d]));
        let [powers_u, powers_v] = half.map(powers);
        let mut terms = [[DVec3::ZERO; ORDER + 1]; ORDER + 1];
        let [mut rest, mut noise] = [[DVec3::ZERO; jet_len(2)]; 2];
        for (i, j) in (0..=ORDER).flat_map(|n| (0..=n).map(move |j| (n - j, j))) {
            let k = jet_index(i, j);
            let highest = i + j == ORDER;
            let of = if highest { over[k] } else { at[k] };
            let share = powers_u[i] * powers_v[j] / (FACTORIALS[i] * FACTORIALS[j]);
            let term = of.mid() * share;
            terms[i][j] = term;
            let unknown = DVec3::from_array(of.to_array().map(Interval::width)) * (0.5 * share);
            let taken = SECOND.into_iter().enumerate();
            for (k, (a, b)) in taken.filter(|&(_, (a, b))| a <= i && b <= j) {
                let factor = falling(i, a) * falling(j, b);
                noise[k] += term.abs() * (factor * ROUNDING);
                let off = if highest { &mut rest } else { &mut noise };
                off[k] += unknown * factor;
            }
        }
        Self {
            uv,
            middle,
            half,
            terms,
            rest,
            noise,
            over: std::array::from_fn(|k| over[k]),
            quarters: OnceLock::new(),
        }
    }

    /// The common part with a rectangle. Where it touches the rectangle with a side alone, the piece beside it tells.
    fn common(&self, uv: [Interval; 2]) -> Option<[Interval; 2]> {
        let part = [
            self.uv[0].intersection(uv[0])?,
            self.uv[1].intersection(uv[1])?,
        ];
        let touches = |d: usize| part[d].is_point() && !uv[d].is_point();
        (!touches(0) && !touches(1)).then_some(part)
    }

    /// The jet over the common part with a rectangle, if there is one; if it is known well.
    fn over(&self, uv: [Interval; 2], tol: f64) -> Option<Option<Jet<Box3>>> {
        let expanded = self.expand(self.common(uv)?, tol, true);
        Some(expanded.and_then(|e| e.local.is_some().then_some(e.jet)))
    }

    /// Joins the enclosure over the common part with a rectangle to a hull.
    fn join(&self, pieces: &Pieces, uv: [Interval; 2], hull: &mut Option<Enclosed>) {
        let Some([u, v]) = self.common(uv) else {
            return;
        };
        let halves = [0, 1].map(|d| halves(self.uv[d], self.middle[d]));
        let can_be_halved = |d: usize, part: Interval| {
            let wide = halves[d].iter().all(|t| t.lo < t.hi);
            wide && 2.0 * part.width() <= self.uv[d].width()
        };
        let can_be_quartered = can_be_halved(0, u) && can_be_halved(1, v);
        let Some(enclosed) = self.expand([u, v], pieces.tol, !can_be_quartered) else {
            let quarters = self
                .quarters
                .get_or_init(|| pieces.pieces(halves.map(Vec::from)).into());
            for quarter in quarters {
                quarter.join(pieces, [u, v], hull);
            }
            return;
        };
        *hull = Some(match hull {
            Some(hull) => Enclosed {
                jet: std::array::from_fn(|k| hull.jet[k].hull(enclosed.jet[k])),
                local: None,
                sharp: hull.sharp && enclosed.sharp,
            },
            None => enclosed,
        });
    }

    /// The jet over a part; `None` if it should be looked at in a smaller piece, since what is not known of the highest
    /// derivatives matters, unless that must do.
    fn expand(&self, part: [Interval; 2], tol: f64, must_do: bool) -> Option<Enclosed> {
        let at = part.map(Interval::mid);
        let half = [0, 1].map(|d| {
            let half = farthest(part[d], at[d]) / self.half[d] * ROUND_UP;
            half.max(NARROWEST)
        });
        let away = [0, 1].map(|d| (at[d] - self.middle[d]) / self.half[d]);
        let moved = moved(&self.terms, away);
        let [hu, hv] = half.map(powers);
        let far = [0, 1].map(|d| away[d].abs() + half[d]);
        let far = powers(far[0].max(far[1]) * ROUND_UP);
        let sizes = |jet: &Jet<DVec3>| {
            let x = |k: usize| jet[k].length();
            let second = greatest([x(3), x(4), x(5)], half);
            [x(1) * half[0] + x(2) * half[1], second]
        };
        let mut unknown = self.noise;
        let mut mid = [DVec3::ZERO; jet_len(2)];
        for (k, (a, b)) in SECOND.into_iter().enumerate() {
            unknown[k] += self.rest[k] * far[ORDER - a - b];
            mid[k] = moved[a][b] * (FACTORIALS[a] * FACTORIALS[b]);
        }
        // Half of a square is in the middle.
        let squares = SECOND.map(|(a, b)| {
            [
                moved[a + 2][b] * (falling(a + 2, a) * FACTORIALS[b] * hu[2]),
                moved[a][b + 2] * (FACTORIALS[a] * falling(b + 2, b) * hv[2]),
            ]
        });
        for (mid, [u, v]) in mid.iter_mut().zip(squares) {
            *mid += 0.5 * (u + v);
        }
        let (known, lost) = (sizes(&mid), sizes(&unknown));
        let near = lost[0] <= SHARE * known[0] && lost[1] <= SHARE * known[1].max(tol);
        if !(near || must_do) {
            return None;
        }
        // What the terms of higher order amount to in each derivative, but for squares.
        let mut higher = [[0.0; jet_len(2)]; 3];
        for (&(i, j), factors) in ALL.iter().zip(&HIGHER) {
            let size = (moved[i][j].abs() * (hu[i] * hv[j])).to_array();
            for (sums, size) in higher.iter_mut().zip(size) {
                for (sum, factor) in sums.iter_mut().zip(factors) {
                    *sum += factor * size;
                }
            }
        }
        let (mut error, mut loose) = (unknown, unknown);
        for (k, (a, b)) in SECOND.into_iter().enumerate() {
            let share = ROUND_UP / (hu[a] * hv[b]);
            let other = DVec3::from_array(higher.map(|sums| sums[k])) * share;
            let [u, v] = squares[k];
            let squares = u.abs() + v.abs();
            let factor = FACTORIALS[a] * FACTORIALS[b];
            let linear = moved[a + 1][b].abs() * ((a + 1) as f64 * hu[1])
                + moved[a][b + 1].abs() * ((b + 1) as f64 * hv[1]);
            error[k] += linear * factor + 0.5 * squares + other;
            loose[k] += other;
        }
        let loose = sizes(&loose);
        let sharp = near && loose[0] + loose[1] <= LOOSE * known[1].max(tol);
        let (su, sv) = (powers(self.half[0]), powers(self.half[1]));
        let mut jet = self.over;
        for (k, (a, b)) in SECOND.into_iter().enumerate() {
            let size = su[a] * sv[b];
            let (mid, error) = ((mid[k] / size).to_array(), error[k] * (ROUND_UP / size));
            let ends = [0, 1, 2].map(|c| {
                let error = error[c] + mid[c].abs() * ROUNDING;
                Interval::new(mid[c] - error, mid[c] + error)
            });
            jet[k] = self.over[k].meet(Box3::from(ends));
        }
        let local = Local {
            half: self.half,
            terms: moved,
            off: unknown,
        };
        Some(Enclosed {
            jet,
            local: near.then_some(local),
            sharp,
        })
    }
}

fn halves(t: Interval, middle: f64) -> [Interval; 2] {
    [Interval { hi: middle, ..t }, Interval { lo: middle, ..t }]
}

/// The distance of the farther end.
fn farthest(t: Interval, from: f64) -> f64 {
    (t.hi - from).max(from - t.lo) * ROUND_UP
}

/// The polynomial about another point.
fn moved(terms: &Polynomial, [s, t]: [f64; 2]) -> Polynomial {
    let mut p = *terms;
    for i in 0..=ORDER {
        for k in 0..ORDER - i {
            for j in (k..ORDER - i).rev() {
                let next = p[i][j + 1];
                p[i][j] += next * t;
            }
        }
    }
    for k in 0..ORDER {
        for i in (k..ORDER).rev() {
            let (row, next) = p.split_at_mut(i + 1);
            for j in 0..ORDER - i {
                row[i][j] += next[0][j] * s;
            }
        }
    }
    p
}

pub(super) fn powers(x: f64) -> [f64; ORDER + 1] {
    let mut p = [1.0; ORDER + 1];
    for k in 0..ORDER {
        p[k + 1] = p[k] * x;
    }
    p
}

const FACTORIALS: [f64; ORDER + 1] = [1.0, 1.0, 2.0, 6.0, 24.0, 120.0, 720.0];

/// `i! / (i - a)!`: what the a-th derivative makes of the term of order i.
pub(super) const fn falling(i: usize, a: usize) -> f64 {
    FACTORIALS[i] / FACTORIALS[i - a]
}

/// The places of a jet of order 2, by [`jet_index`].
const SECOND: [(usize, usize); jet_len(2)] = [(0, 0), (1, 0), (0, 1), (2, 0), (1, 1), (0, 2)];
/// The number of terms of a polynomial.
const TERMS: usize = jet_len(ORDER);
/// The places of all terms.
const ALL: [(usize, usize); TERMS] = {
    let mut all = [(0, 0); TERMS];
    let (mut i, mut n) = (0, 0);
    while i <= ORDER {
        let mut j = 0;
        while j <= ORDER - i {
            all[n] = (i, j);
            (j, n) = (j + 1, n + 1);
        }
        i += 1;
    }
    all
};
/// For each term, its factors in the expansions of all derivatives, where it is of second or higher order and no square.
const HIGHER: [[f64; jet_len(2)]; TERMS] = {
    let mut out = [[0.0; jet_len(2)]; TERMS];
    let mut k = 0;
    while k < SECOND.len() {
        let (a, b) = SECOND[k];
        let mut n = 0;
        while n < TERMS {
            let (i, j) = ALL[n];
            if i >= a && j >= b && i + j >= a + b + 2 && !matches!((i - a, j - b), (2, 0) | (0, 2))
            {
                out[n][k] = falling(i, a) * falling(j, b);
            }
            n += 1;
        }
        k += 1;
    }
    out
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::BSplineBasis;
    use crate::exact::NurbsSurface;
    use crate::laws::Random;
    use crate::surface::{Torus, TorusOptions};

    fn examples() -> Vec<Box<dyn Surface>> {
        let mut random = Random(5);
        let mut nurbs = |degree: usize, points: usize, weights: f64, size: f64| {
            let net: Vec<DVec3> = (0..points * points)
                .map(|k| {
                    let [x, y] = [k / points, k % points].map(|i| i as f64);
                    size * DVec3::new(x + random.unit(), y + random.unit(), random.unit())
                })
                .collect();
            let weights: Vec<f64> = net.iter().map(|_| 1.0 + weights * random.unit()).collect();
            let knots = BSplineBasis::clamped_uniform(degree, points);
            let knots = [knots.clone(), knots];
            Box::new(NurbsSurface::new([degree; 2], knots, &net, Some(&weights)).unwrap())
        };
        vec![
            nurbs(3, 9, 0.0, 1.0),
            nurbs(2, 6, 1.0, 1e6),
            nurbs(5, 7, 0.5, 1e-6),
            Box::new(Torus::new(3.0, 1.0, TorusOptions::default()).unwrap()),
        ]
    }

    #[test]
    fn derivatives_are_where_they_are_said_to_be() {
        let mut random = Random(8);
        for (number, surface) in examples().iter().enumerate() {
            let domain = surface.domain();
            let size = surface.bounds(domain).diagonal();
            let mut local = 0;
            for tol in [1e-1, 1e-4] {
                let pieces = Pieces::new(surface.as_ref(), tol * size);
                for _ in 0..150 {
                    let share = 10f64.powf(-4.0 * random.unit());
                    let uv = domain.map(|d| {
                        let width = share * d.width();
                        let lo = d.lo + random.unit() * (d.width() - width);
                        Interval::new(lo, (lo + width).min(d.hi))
                    });
                    let found = pieces.enclose(uv);
                    let again = Pieces::new(surface.as_ref(), tol * size).enclose(uv);
                    assert_eq!(found.jet, again.jet);
                    local += usize::from(found.local.is_some());
                    let middle = uv.map(Interval::mid);
                    for _ in 0..8 {
                        let at = uv.map(|t| random.within(t));
                        let jet = surface.jet(at, [Limit::Above; 2], 2);
                        for (k, d) in jet.d.iter().enumerate() {
                            let widths: f64 = [0, 1].map(|d| domain[d].width()).iter().product();
                            let rounding = 1e-12 * size / widths.powi(2);
                            assert!(found.jet[k].inflate(rounding).contains(*d), "{number} {k}");
                        }
                        let Some(local) = &found.local else { continue };
                        let [s, t] = [0, 1].map(|d| (at[d] - middle[d]) / local.half[d]);
                        for (k, &(a, b)) in SECOND.iter().enumerate() {
                            let mut told = DVec3::ZERO;
                            for (i, j) in ALL.into_iter().filter(|&(i, j)| i >= a && j >= b) {
                                let powers = s.powi((i - a) as i32) * t.powi((j - b) as i32);
                                told +=
                                    local.terms[i][j] * (powers * falling(i, a) * falling(j, b));
                            }
                            let half = local.half[0].powi(a as i32) * local.half[1].powi(b as i32);
                            let off = (jet.d[k] * half - told).abs();
                            let rounding = DVec3::splat(1e-12 * size);
                            assert!(off.cmple(local.off[k] + rounding).all(), "{number} {k}");
                        }
                    }
                }
            }
            assert!(local > 100, "{number}: {local} of 300 lie in one piece");
        }
    }
}
