//! Approximation of any curve or surface by NURBS to a tolerance, with a proven bound of the error.

use super::hermite::{DATA, DEGREE, ORDER, SMOOTH, bezier, operator_bound, remainder};
use super::spline::{Row, join};
use super::{NurbsCurve, NurbsError, NurbsSurface};
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::Curve;
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Dir, Surface, jet_index, jet_len};
use glam::DVec3;
use std::collections::HashMap;
use std::collections::hash_map::Entry;
use thiserror::Error;

/// What can prevent an approximation.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ApproximationError {
    /// The tolerance is not a positive, finite length.
    #[error("the tolerance is {tol}: it must be a positive, finite length")]
    Tolerance {
        /// The tolerance given.
        tol: f64,
    },
    /// The curve or surface jumps.
    #[error("it jumps at the parameter {at}: split it there and convert both parts")]
    Jump {
        /// Where.
        at: f64,
    },
    /// A point is not finite.
    #[error("at the parameter {at:?} the point is not finite, so nothing can follow it there")]
    NotFinite {
        /// The parameter, or u and v.
        at: Vec<f64>,
    },
    /// The degree cannot be lowered to that.
    #[error("the degree is {own}: it can be lowered to 1 … {own}, not to {degree}")]
    Degree {
        /// The degree it has.
        own: usize,
        /// The degree asked for.
        degree: usize,
    },
    /// The weights vary too much for the lower degree.
    #[error(
        "in this degree the weights would not be positive: insert knots first, or keep the degree"
    )]
    Weights,
    /// The result is not a valid spline: the parameters are too near each other.
    #[error(transparent)]
    Nurbs(#[from] NurbsError),
}

/// A NURBS form and how far it may be from what it stands for.
///
/// The error bound holds for the mathematical spline with the given points; evaluating it adds the usual rounding of
/// a few units in the last place.
#[derive(Clone, Debug)]
pub struct Converted<T> {
    /// The NURBS form.
    pub nurbs: T,
    /// The error: exact, proven, or (only where something cannot be enclosed) sampled.
    pub certainty: Certainty,
    /// True if the error holds at equal parameters. Otherwise the form is the same set of points, run through in the same
    /// directions with other parameters.
    pub same_parameters: bool,
}

impl<T> Converted<T> {
    fn exact(nurbs: T, same_parameters: bool) -> Self {
        Self {
            nurbs,
            certainty: Certainty::Exact,
            same_parameters,
        }
    }

    /// With fewer knots in what is left of the tolerance.
    fn fewer(
        self,
        tol: f64,
        reduce: impl Fn(&T, f64) -> Result<Self, ApproximationError>,
    ) -> Result<Self, ApproximationError> {
        let room = tol - self.certainty.error();
        if matches!(self.certainty, Certainty::Estimated(_)) || room.is_nan() || room <= 0.0 {
            return Ok(self);
        }
        let few = reduce(&self.nurbs, room)?;
        let error = (self.certainty.error() + few.certainty.error()).next_up();
        Ok(Self {
            certainty: Certainty::Bounded(error),
            ..few
        })
    }
}

/// The most pieces of a curve, or of a surface in one direction. At the sixth order of convergence a smooth curve
/// needs hundreds for all digits; where derivatives grow without bound halving alone does not help.
const MOST_PIECES: usize = 512;
/// The most cells of a surface.
const MOST_CELLS: usize = 20_000;
/// Pieces shorter than this share of the whole range are not split: their ends would run together.
const SHORTEST: f64 = 1e-9;
/// Samples in each direction of a piece where nothing can be proven.
const SAMPLES: usize = 7;
/// Rounding errors of the points computed from end data, in units in the last place of the largest coordinate.
const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// The curve as a NURBS curve: exactly where that exists, with the same parameters if possible, else
/// [`approximate_curve`] with only those knots that the tolerance needs. What exporters call.
pub fn to_nurbs_or_approximate_curve(
    curve: &dyn Curve,
    tol: f64,
) -> Result<Converted<NurbsCurve>, ApproximationError> {
    let same = curve.to_nurbs().map(|n| Converted::exact(n, true));
    let exact = same.or_else(|| Some(Converted::exact(curve.to_rational()?, false)));
    exact.map_or_else(
        || {
            let close = approximate_curve(curve, 0.5 * tol)?;
            close.fewer(tol, NurbsCurve::with_fewer_knots)
        },
        Ok,
    )
}

/// The surface as a NURBS surface: exactly where that exists, with the same parameters if possible, else
/// [`approximate_surface`] with only those knots that the tolerance needs. What exporters call.
pub fn to_nurbs_or_approximate(
    surface: &dyn Surface,
    tol: f64,
) -> Result<Converted<NurbsSurface>, ApproximationError> {
    let same = surface.to_nurbs().map(|n| Converted::exact(n, true));
    let exact = same.or_else(|| Some(Converted::exact(surface.to_rational()?, false)));
    exact.map_or_else(
        || {
            let close = approximate_surface(surface, 0.5 * tol)?;
            close.fewer(tol, NurbsSurface::with_fewer_knots)
        },
        Ok,
    )
}

/// A spline of degree 5 that stays within `tol` of the curve at equal parameters. Its ends are those of the curve; it
/// is twice differentiable where the curve is.
///
/// Each piece takes over the point and two derivatives at its ends and is halved until the remainder, bounded with an
/// enclosure of the sixth derivative, is below the tolerance. If the tolerance is out of reach (derivatives without
/// bound, rounding), the result tells the error it has. Cost: one enclosure a piece, pieces ~ tol^(-1/6).
pub fn approximate_curve(
    curve: &dyn Curve,
    tol: f64,
) -> Result<Converted<NurbsCurve>, ApproximationError> {
    check(tol, curve.breaks())?;
    let domain = curve.domain();
    let shortest = SHORTEST * (domain.hi - domain.lo);
    let mut breaks = vec![curve.breaks()[0]];
    let mut certainty = Certainty::Bounded(0.0);
    let mut pieces: Vec<Vec<Row>> = Vec::new();
    for w in curve.breaks().windows(2) {
        // Parts still to be done, the next one last.
        let mut parts = vec![Interval::new(w[0].at, w[1].at)];
        while let Some(part) = parts.pop() {
            let piece = curve_piece(curve, part)?;
            let may_split = part.width() > shortest && pieces.len() + parts.len() < MOST_PIECES;
            if piece.error > 0.5 * tol && may_split {
                let m = part.mid();
                parts.push(Interval::new(m, part.hi));
                parts.push(Interval::new(part.lo, m));
                continue;
            }
            certainty = certainty.and(piece.certainty());
            pieces.push(piece.points);
            let smooth = if part.hi < w[1].at {
                SMOOTH
            } else {
                w[1].smooth.min(SMOOTH)
            };
            breaks.push(Break::new(part.hi, smooth));
        }
    }
    let nurbs = NurbsCurve::from_spline(join(&breaks, DEGREE, &pieces))?;
    Ok(Converted {
        nurbs,
        certainty,
        same_parameters: true,
    })
}

/// A Bézier piece with what is known of its error.
struct Piece {
    points: Vec<Row>,
    /// The remainder, which splitting lowers: a bound, or without one, the largest of samples.
    error: f64,
    /// The rounding of the data, a bound.
    rounding: f64,
    proven: bool,
}

impl Piece {
    fn certainty(&self) -> Certainty {
        let rounding = self.rounding + ROUNDING * largest(&self.points);
        if self.proven && rounding.is_finite() {
            Certainty::Bounded((self.error + rounding).next_up())
        } else {
            Certainty::Estimated(self.error)
        }
    }
}

fn curve_piece(curve: &dyn Curve, part: Interval) -> Result<Piece, ApproximationError> {
    let mut boxes = [Box3::ENTIRE; ORDER + 1];
    curve.enclose_piece(part, Limit::Above, &mut boxes);
    let mut rounding = 0.0f64;
    let mut end = |t, limit| -> Result<[Row; DATA], ApproximationError> {
        let (mut b, mut d) = ([Box3::ENTIRE; DATA], [DVec3::ZERO; DATA]);
        curve.enclose_piece(Interval::point(t), limit, &mut b);
        curve.jet_into(t, limit, &mut d);
        follow(&mut d, || vec![t])?;
        let off = [0, 1, 2].map(|k| (b[k] - Box3::point(d[k])).norm().hi);
        rounding = rounding.max(operator_bound(off, part.width()));
        Ok(d.map(|d| vec![d.extend(0.0)]))
    };
    let (start, stop) = (end(part.lo, Limit::Above)?, end(part.hi, Limit::Below)?);
    let points = weightless(bezier(&start, &stop, part.hi - part.lo));
    let bound = remainder(boxes[ORDER].norm().hi, part.width());
    let proven = bound.is_finite() && rounding.is_finite();
    let error = if proven {
        bound
    } else {
        sampled_curve(curve, part, &points)
    };
    Ok(Piece {
        points,
        error,
        rounding,
        proven,
    })
}

/// Refuses a point that is not finite. A derivative that is not finite (at the nose of `√t`) cannot be followed: it is
/// replaced by 0, and the error tells what that costs.
fn follow(d: &mut [DVec3], at: impl Fn() -> Vec<f64>) -> Result<(), ApproximationError> {
    if !d[0].is_finite() {
        return Err(ApproximationError::NotFinite { at: at() });
    }
    d.iter_mut()
        .filter(|d| !d.is_finite())
        .for_each(|d| *d = DVec3::ZERO);
    Ok(())
}

fn check(tol: f64, breaks: &[Break]) -> Result<(), ApproximationError> {
    if !(tol.is_finite() && tol > 0.0) {
        return Err(ApproximationError::Tolerance { tol });
    }
    match breaks[1..breaks.len() - 1].iter().find(|b| b.smooth < 0) {
        Some(b) => Err(ApproximationError::Jump { at: b.at }),
        None => Ok(()),
    }
}

/// Bézier points with weight 1, whatever the arithmetic of Hermite data made of the fourth coordinate.
fn weightless(mut piece: Vec<Row>) -> Vec<Row> {
    piece.iter_mut().flatten().for_each(|p| p.w = 1.0);
    piece
}

fn largest(piece: &[Row]) -> f64 {
    piece
        .iter()
        .flatten()
        .fold(0.0, |m, p| m.max(p.truncate().abs().max_element()))
}

/// The largest distance found by comparing points.
fn sampled_curve(curve: &dyn Curve, part: Interval, piece: &[Row]) -> f64 {
    (1..=SAMPLES)
        .map(|i| {
            let s = i as f64 / (SAMPLES + 1) as f64;
            let t = part.lo + (part.hi - part.lo) * s;
            curve.point(t).distance(casteljau(piece, s)[0].truncate())
        })
        .fold(0.0, f64::max)
}

fn casteljau(piece: &[Row], s: f64) -> Row {
    let mut d = piece.to_vec();
    while d.len() > 1 {
        for i in 0..d.len() - 1 {
            let next = d[i + 1].clone();
            d[i].iter_mut()
                .zip(&next)
                .for_each(|(a, b)| *a = *a * (1.0 - s) + *b * s);
        }
        d.pop();
    }
    d.swap_remove(0)
}

/// A biquintic spline surface that stays within `tol` of the surface at equal parameters.
///
/// With `P` and `Q` the Hermite operators in u and v, the error of a cell is `r - P Q r = (r - P r) + P (r - Q r)`. The
/// first is a remainder in u; for the second, the end data of `P` are remainders in v of `r`, `r_u` and `r_uu`:
///
///   `|r - P Q r| <= (hu⁶ |r_u⁶| + hv⁶ (|r_v⁶| + 5/16 hu |r_u v⁶| + hu²/32 |r_uu v⁶|)) / 46080`
///
/// with enclosed derivatives over the cell. Columns and rows of cells are halved until that is below the tolerance; if
/// the tolerance is out of reach, the result tells the error it has.
pub fn approximate_surface(
    surface: &dyn Surface,
    tol: f64,
) -> Result<Converted<NurbsSurface>, ApproximationError> {
    let own = [surface.breaks(Dir::U), surface.breaks(Dir::V)];
    check(tol, own[0])?;
    check(tol, own[1])?;
    let mut breaks = own.map(|b| {
        let smooth = |b: &Break| Break::new(b.at, b.smooth.min(SMOOTH));
        b.iter().map(smooth).collect::<Vec<_>>()
    });
    // Cells that are known already; a refinement keeps many of them.
    let mut cells: HashMap<[u64; 4], Cell> = HashMap::new();
    loop {
        let [bu, bv] = &breaks;
        let mut split = [vec![false; bu.pieces()], vec![false; bv.pieces()]];
        for a in 0..bu.pieces() {
            for b in 0..bv.pieces() {
                let range = [bu.piece(a), bv.piece(b)];
                let cell = match cells.entry(key(range)) {
                    Entry::Occupied(e) => e.into_mut(),
                    Entry::Vacant(e) => e.insert(Cell::new(surface, range)?),
                };
                let [eu, ev] = cell.parts;
                if eu + ev > 0.5 * tol {
                    split[0][a] |= eu > 0.25 * tol;
                    split[1][b] |= ev > 0.25 * tol;
                }
            }
        }
        let refined = [refined(bu, &split[0]), refined(bv, &split[1])];
        let grown = refined[0].len() > bu.len() || refined[1].len() > bv.len();
        if !grown || refined[0].pieces() * refined[1].pieces() > MOST_CELLS {
            break;
        }
        breaks = refined;
    }
    let [bu, bv] = &breaks;
    let cell = |a: usize, b: usize| &cells[&key([bu.piece(a), bv.piece(b)])];
    let mut certainty = Certainty::Bounded(0.0);
    for a in 0..bu.pieces() {
        for b in 0..bv.pieces() {
            certainty = certainty.and(cell(a, b).piece.certainty());
        }
    }
    let point = |a, b, i: usize, j: usize| cell(a, b).piece.points[i][j];
    let nurbs = NurbsSurface::from_grid([bu, bv], [DEGREE; 2], point)?;
    Ok(Converted {
        nurbs,
        certainty,
        same_parameters: true,
    })
}

/// A piece of a surface (rows of its net along u).
struct Cell {
    piece: Piece,
    /// The parts of the error that splitting in u and in v lowers.
    parts: [f64; 2],
}

fn key(cell: [Interval; 2]) -> [u64; 4] {
    [cell[0].lo, cell[0].hi, cell[1].lo, cell[1].hi].map(f64::to_bits)
}

/// The breaks with a new one in the middle of each marked piece.
fn refined(breaks: &[Break], split: &[bool]) -> Vec<Break> {
    let domain = breaks.domain();
    let shortest = SHORTEST * (domain.hi - domain.lo);
    let mut out = vec![breaks[0]];
    for (i, &s) in split.iter().enumerate() {
        let piece = breaks.piece(i);
        if s && piece.hi - piece.lo > shortest && breaks.pieces() < MOST_PIECES {
            out.push(Break::new(piece.mid(), SMOOTH));
        }
        out.push(breaks[i + 1]);
    }
    out
}

impl Cell {
    fn new(surface: &dyn Surface, range: [Interval; 2]) -> Result<Self, ApproximationError> {
        let order = ORDER + DATA - 1;
        let mut d = vec![Box3::ENTIRE; jet_len(order)];
        surface.enclose_piece(range, [Limit::Above; 2], order, &mut d);
        let norm = |i, j| d[jet_index(i, j)].norm().hi;
        let (hu, hv) = (range[0].width(), range[1].width());
        let in_v = [0, 1, 2].map(|i| remainder(norm(i, ORDER), hv));
        let mut parts = [remainder(norm(ORDER, 0), hu), operator_bound(in_v, hu)];
        let (points, rounding) = cell_net(surface, range)?;
        let proven = parts[0].is_finite() && parts[1].is_finite() && rounding.is_finite();
        let mut error = (parts[0] + parts[1]).next_up();
        if !proven {
            error = sampled_surface(surface, range, &points);
            // A sample says nothing about a direction: both are to blame.
            parts = [error; 2];
        }
        let piece = Piece {
            points,
            error,
            rounding,
            proven,
        };
        Ok(Self { piece, parts })
    }
}

/// The Bézier net of a cell (rows along u), and how much the rounding of the data at its corners may change it.
fn cell_net(
    surface: &dyn Surface,
    range: [Interval; 2],
) -> Result<(Vec<Row>, f64), ApproximationError> {
    let (hu, hv) = (range[0].hi - range[0].lo, range[1].hi - range[1].lo);
    let order = 2 * (DATA - 1);
    let mut rounding = 0.0f64;
    let mut corner = |u: usize, v: usize| -> Result<Vec<DVec3>, ApproximationError> {
        let side =
            |i: usize, k: usize| [(range[i].lo, Limit::Above), (range[i].hi, Limit::Below)][k];
        let ((u, lu), (v, lv)) = (side(0, u), side(1, v));
        let mut d = vec![DVec3::ZERO; jet_len(order)];
        surface.jet_into([u, v], [lu, lv], order, &mut d);
        follow(&mut d, || vec![u, v])?;
        let mut b = vec![Box3::ENTIRE; jet_len(order)];
        surface.enclose_piece([u, v].map(Interval::point), [lu, lv], order, &mut b);
        let off = |i: usize, j: usize| {
            let k = jet_index(i, j);
            (b[k] - Box3::point(d[k])).norm().hi
        };
        let in_v = [0, 1, 2].map(|i| operator_bound([off(i, 0), off(i, 1), off(i, 2)], hv));
        rounding = rounding.max(operator_bound(in_v, hu));
        Ok(d)
    };
    let corners = [
        [corner(0, 0)?, corner(0, 1)?],
        [corner(1, 0)?, corner(1, 1)?],
    ];
    // At each end of u: the Bézier points along v of r, r_u and r_uu.
    let along_v = |u: usize| -> [Row; DATA] {
        [0, 1, 2].map(|i| {
            let data =
                |v: usize| [0, 1, 2].map(|j| vec![corners[u][v][jet_index(i, j)].extend(0.0)]);
            bezier(&data(0), &data(1), hv).concat()
        })
    };
    let net = bezier(&along_v(0), &along_v(1), hu);
    Ok((weightless(net), rounding))
}

/// The largest distance found by comparing points.
fn sampled_surface(surface: &dyn Surface, cell: [Interval; 2], net: &[Row]) -> f64 {
    let mut most = 0.0f64;
    for i in 1..=SAMPLES {
        let s = i as f64 / (SAMPLES + 1) as f64;
        let row = casteljau(net, s);
        let line: Vec<Row> = row.into_iter().map(|p| vec![p]).collect();
        for j in 1..=SAMPLES {
            let t = j as f64 / (SAMPLES + 1) as f64;
            let uv = [
                cell[0].lo + (cell[0].hi - cell[0].lo) * s,
                cell[1].lo + (cell[1].hi - cell[1].lo) * t,
            ];
            let p = casteljau(&line, t)[0].truncate();
            most = most.max(surface.point(uv).distance(p));
        }
    }
    most
}
