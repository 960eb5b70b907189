//! The ball between any two surfaces as a function of u: the contacts solve their equations in the planes square to a
//! guide, exactly; nothing is fitted.
//!
//! The guide is a curve near the path of the centre, most often a spline; its only part is to say which plane belongs to which u. A table
//! holds the contacts at some u. Between them Newton's method gives them to rounding, the equations' derivatives give their
//! series of any order, and Krawczyk's operator encloses them over a range of u, which proves that they exist and are
//! the only ones near. Source: Neumaier, *Interval methods for systems of equations*, §5.1.

use super::contact::{AT_BREAK, Course, Expansion, Fourth, Place, State, Supports};
use super::memo::Memo;
use super::rolling_ball::{Ball, COUNT, Radius, Vector, regular, write_sections};
use crate::basis::Functions;
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::{Curve, CurveRef};
use crate::interval::Interval;
use crate::series::Series;
use glam::{DMat4, DVec3};

/// The most steps of Newton's method from the table.
const NEWTON: usize = 8;
/// Relative to the radius: a last step so short says that Newton's method has come to its end.
const SETTLED: f64 = 1e-9;
/// Relative to the width of a domain: how far a contact may lie beyond the end of its support, by rounding, where the table
/// ends there.
const AT_END: f64 = 1e-9;
/// The most steps of the contraction where Newton's method fails.
const CONTRACTIONS: usize = 200;
/// The most halvings of a range until its contacts are enclosed, and the most ranges.
const DEPTH: u32 = 24;
const RANGES: usize = 20_000;
/// How much wider than a first enclosure the box is in which the contacts are looked for.
const WIDER: f64 = 1.5;
/// What is added to the reach of each parameter, of the longest reach.
const SHARE: f64 = 0.1;
/// How many boxes are tried for a range.
const TRIES: usize = 4;

/// The contacts at a parameter, with their derivatives.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub u: f64,
    pub x: Place<f64>,
    pub d: Place<f64>,
}

/// A range of u in which both contacts stay in one piece of their supports.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub within: Place<Interval>,
    pub nodes: Vec<Node>,
}

/// A range of u over which the contacts are proven to be the only ones in a box.
#[derive(Clone, Debug)]
struct Cell {
    u: Interval,
    x: Place<Interval>,
    /// The matrix of the proof.
    inverse: DMat4,
}

/// The path of a ball of constant or variable radius between two surfaces.
#[derive(Clone, Debug)]
pub(super) struct Spine {
    pub supports: Supports,
    pub radius: Radius,
    /// Measured from the supports' origin.
    pub guide: CurveRef,
    pub breaks: Vec<Break>,
    pub pieces: Vec<Piece>,
    cells: Vec<Cell>,
    memo: Memo,
}

/// What cannot be proven about the contacts, and where.
#[derive(Clone, Copy, Debug)]
pub(super) enum Unsettled {
    /// That they exist.
    Unproven { at: f64 },
    /// That parameter `j` stays in its piece of the support.
    Leaves { at: f64, j: usize },
}

/// A value and the enclosures around it for one range of u.
struct Enclosed {
    x: Place<Interval>,
    course: Course<Interval>,
    inverse: DMat4,
    within: Place<Interval>,
}

impl Spine {
    pub(super) fn new(
        supports: Supports,
        radius: Radius,
        guide: CurveRef,
        breaks: Vec<Break>,
        pieces: Vec<Piece>,
    ) -> Self {
        Self {
            supports,
            radius,
            guide,
            breaks,
            pieces,
            cells: Vec::new(),
            memo: Memo::default(),
        }
    }

    fn course(&self, u: f64, limit: Limit, order: usize) -> Course<f64> {
        course(self.guide.as_ref(), &self.radius, u, limit, order)
    }

    fn course_over(&self, u: Interval, limit: Limit, order: usize) -> Course<Interval> {
        let mut d = vec![Box3::ENTIRE; order + 2];
        self.guide.enclose_piece(u, limit, &mut d);
        let guide = std::array::from_fn(|k| {
            let c: Vec<Interval> = d.iter().map(|p| p.to_array()[k]).collect();
            Series::from_derivatives(&c)
        });
        Course {
            guide,
            radius: self.radius.series_over(u, limit, order),
        }
    }

    /// The contacts at a parameter.
    pub(super) fn contacts(&self, u: f64, limit: Limit) -> Place<f64> {
        let i = self.breaks.find(u, limit);
        let piece = &self.pieces[i];
        let course = self.course(u, limit, 0);
        let mut x = piece.guess(u);
        let mut last = f64::INFINITY;
        let mut settled = false;
        for _ in 0..NEWTON {
            let Some((step, length)) = newton(&self.supports, x, piece.within, &course) else {
                break;
            };
            settled = length <= SETTLED * course.radius.value();
            // Rounding only.
            if length.is_nan() || length >= 0.5 * last {
                break;
            }
            last = length;
            (0..4).for_each(|j| x[j] += step[j]);
        }
        if let Some(cell) = self.cell(i, u)
            && !(settled && (0..4).all(|j| cell.x[j].contains(x[j])))
        {
            x = self.contract(cell, piece.within, &course);
        }
        std::array::from_fn(|j| x[j].clamp(piece.within[j].lo, piece.within[j].hi))
    }

    /// The cell that holds a parameter of a piece; `None` before they are proven.
    fn cell(&self, piece: usize, u: f64) -> Option<&Cell> {
        let piece = self.breaks.piece(piece);
        let start = self.cells.partition_point(|c| c.u.lo < piece.lo);
        let end = self.cells.partition_point(|c| c.u.lo < piece.hi);
        let cells = &self.cells[start..end];
        let after = cells.partition_point(|c| c.u.lo <= u).max(1);
        cells.get(after - 1)
    }

    /// The contacts by the iteration whose convergence in the whole box of a cell is what its proof says.
    fn contract(&self, cell: &Cell, within: Place<Interval>, course: &Course<f64>) -> Place<f64> {
        let mut x = cell.x.map(Interval::mid);
        let mut last = f64::INFINITY;
        for _ in 0..CONTRACTIONS {
            let e = self.supports.expand(x, within, 1);
            let step = self.supports.residual(&e, course, &cell.inverse);
            // Relative to the box, in which all parameters have their share.
            let length = (0..4).fold(0.0, |a: f64, j| a.max(step[j].abs() / cell.x[j].width()));
            if !(length < last || length > 1e-6) {
                break;
            }
            last = length;
            (0..4).for_each(|j| x[j] = (x[j] - step[j]).clamp(cell.x[j].lo, cell.x[j].hi));
        }
        x
    }

    /// The contacts' series, with what the ball's needs.
    fn series_at(
        &self,
        u: f64,
        limit: Limit,
        order: usize,
    ) -> (Expansion<f64>, Course<f64>, Place<Series<f64>>) {
        let within = self.pieces[self.breaks.find(u, limit)].within;
        let x = self.contacts(u, limit);
        let e = self.supports.expand(x, within, order + 1);
        let course = self.course(u, limit, order);
        let inverse = self
            .supports
            .state(x, within, course.radius.value())
            .and_then(|s| s.inverse(square(&s, &course)))
            .unwrap_or(DMat4::NAN);
        let series = self.supports.series(&e, x, &course, &inverse, order);
        (e, course, series)
    }

    /// The ball at a parameter.
    pub(super) fn ball(&self, u: f64, limit: Limit, order: usize) -> Ball<f64> {
        let (e, course, series) = self.series_at(u, limit, order);
        Supports::ball(&e, &series, &course.radius)
    }

    /// The ball's centre at a parameter, from the supports' origin.
    pub(super) fn centre(&self, u: f64) -> DVec3 {
        let ball = self.ball(u, Limit::Above, 0);
        DVec3::from_array(ball.centre.map(|x| x.value()))
    }

    /// Krawczyk's operator over a range of u in one piece: an enclosure of the contacts, and the box in which they are
    /// the only ones.
    fn krawczyk(&self, u: Interval, limit: Limit) -> Option<(Enclosed, Place<Interval>)> {
        let m = u.mid();
        let piece = &self.pieces[self.breaks.find(m, limit)];
        let middle = self.contacts(m, limit);
        let here = self.course(m, limit, 0);
        let state = self
            .supports
            .state(middle, piece.within, here.radius.value())?;
        let inverse = state.inverse(square(&state, &here))?;
        let course = self.course_over(u, limit, 0);
        let at = middle.map(Interval::point);
        let e = self.supports.expand(at, piece.within, 1);
        let residual = self.supports.residual(&e, &course, &inverse);
        // Beside its own residual each parameter has a share of the longest, as a length: they act on each other.
        let long = |j: usize| state.tangents[j].length();
        let longest = (0..4)
            .map(|j| residual[j].mag() * long(j))
            .fold(0.0, f64::max);
        let mut reach: Place<f64> = std::array::from_fn(|j| {
            WIDER * residual[j].mag()
                + SHARE * longest / long(j)
                + 4.0 * f64::EPSILON * piece.within[j].mag()
        });
        for _ in 0..TRIES {
            if !reach.iter().all(|r| r.is_finite()) {
                return None;
            }
            let x: Place<Interval> = std::array::from_fn(|j| at[j].inflate(reach[j]));
            let image = self.image(&at, &residual, &x, &course, &inverse, piece.within);
            if (0..4).all(|j| x[j].lo < image[j].lo && image[j].hi < x[j].hi) {
                let enclosed = Enclosed {
                    x: image,
                    course,
                    inverse,
                    within: piece.within,
                };
                return Some((enclosed, x));
            }
            reach = std::array::from_fn(|j| WIDER * (image[j] - at[j]).mag());
        }
        None
    }

    /// `m - Y F(m) + (1 - Y F'(X)) (X - m)`.
    fn image(
        &self,
        at: &Place<Interval>,
        residual: &Place<Interval>,
        x: &Place<Interval>,
        course: &Course<Interval>,
        inverse: &DMat4,
        within: Place<Interval>,
    ) -> Place<Interval> {
        let e = self.supports.expand(*x, within, 2);
        let a = self.supports.preconditioned(&e, course, inverse);
        std::array::from_fn(|i| {
            (0..4).fold(at[i] - residual[i], |acc, j| {
                let unit = if i == j {
                    Interval::ONE
                } else {
                    Interval::ZERO
                };
                acc + (unit - a[i][j]) * (x[j] - at[j])
            })
        })
    }

    /// Proves that there are contacts for every u, and that they stay in their pieces of the supports: `Err` says where that
    /// fails. What is enclosed afterwards rests on it.
    pub(super) fn settle(&mut self) -> Result<(), Unsettled> {
        let mut cells: Vec<Cell> = Vec::new();
        for i in 0..self.breaks.pieces() {
            let first = cells.len();
            let mut stack = vec![(self.breaks.piece(i), 0)];
            while let Some((u, depth)) = stack.pop() {
                // Small enough for what is asked of them.
                let mut leaves = None;
                let found = match self.krawczyk(u, Limit::Above) {
                    Some((e, x)) => {
                        let (ball, _, series) = self.ball_over(u, Limit::Above, &e, 2);
                        let finite = regular(&ball).iter().all(|m| m.is_finite());
                        leaves = self.leaving(u, &e, &series)?;
                        (finite && leaves.is_none()).then_some((e, x))
                    }
                    None => None,
                };
                match found {
                    Some((e, x)) => cells.push(Cell {
                        u,
                        x,
                        inverse: e.inverse,
                    }),
                    None if depth >= DEPTH || cells.len() >= RANGES => {
                        let at = u.mid();
                        return Err(match leaves {
                            Some(j) => Unsettled::Leaves { at, j },
                            None => Unsettled::Unproven { at },
                        });
                    }
                    None => {
                        let m = u.mid();
                        stack.push((Interval::new(m, u.hi), depth + 1));
                        stack.push((Interval::new(u.lo, m), depth + 1));
                    }
                }
            }
            // Neighbours hold the same contacts: those at their common end are in both boxes.
            for pair in cells[first..].windows(2) {
                let u = pair[1].u.lo;
                let same = self.krawczyk(Interval::point(u), Limit::Above);
                let held = |x: &Place<Interval>| {
                    pair.iter().all(|c| (0..4).all(|j| c.x[j].encloses(x[j])))
                };
                if !same.is_some_and(|(e, _)| held(&e.x)) {
                    return Err(Unsettled::Unproven { at: u });
                }
            }
        }
        self.cells = cells;
        self.memo = Memo::default();
        Ok(())
    }

    /// The parameter that may leave its piece of the support over a range of u, or `Err` where one surely does. A contact
    /// stays inside if it is enclosed inside, or if it goes one way from one place inside to another.
    fn leaving(
        &self,
        u: Interval,
        e: &Enclosed,
        series: &Place<Series<Interval>>,
    ) -> Result<Option<usize>, Unsettled> {
        let domain = self.supports.domain();
        let piece = self.breaks.piece(self.breaks.find(u.mid(), Limit::Above));
        let room = |j: usize, share: f64| e.within[j].inflate(share * domain[j].width());
        let out = |j: usize| !room(j, AT_BREAK).encloses(e.x[j]);
        let Some(first) = (0..4).find(|&j| out(j)) else {
            return Ok(None);
        };
        for at in [u.lo, u.hi] {
            // The ends of the piece are there by rounding.
            let share = if at == piece.lo || at == piece.hi {
                AT_END
            } else {
                AT_BREAK
            };
            let limit = if at == piece.hi {
                Limit::Below
            } else {
                Limit::Above
            };
            let Some((end, _)) = self.krawczyk(Interval::point(at), limit) else {
                return Ok(Some(first));
            };
            for j in (0..4).filter(|&j| out(j)) {
                let room = room(j, share);
                if end.x[j].lo > room.hi || end.x[j].hi < room.lo {
                    return Err(Unsettled::Leaves { at, j });
                }
                if !room.encloses(end.x[j]) {
                    return Ok(Some(j));
                }
            }
        }
        let turns = |j: usize| series[j].c[1].contains(0.0) || !series[j].c[1].is_finite();
        Ok((0..4).find(|&j| out(j) && turns(j)))
    }

    /// The ranges of u over which the contacts are enclosed at one go.
    pub(super) fn ranges(&self) -> Vec<Interval> {
        self.cells.iter().map(|c| c.u).collect()
    }

    /// Enclosures of the contacts over a range of u in one piece, cell by cell.
    fn each(&self, u: Interval, limit: Limit, mut take: impl FnMut(Interval, Option<Enclosed>)) {
        for (cell, part) in self.parts(u, limit) {
            take(part, self.enclosed(cell, part, limit));
        }
    }

    fn enclosed(&self, cell: Option<&Cell>, u: Interval, limit: Limit) -> Option<Enclosed> {
        match cell {
            Some(cell) => self.within(cell, u, limit),
            None => self.krawczyk(u, limit).map(|(e, _)| e),
        }
    }

    /// A range of u in one piece, cut where cells meet; without a cell before they are proven.
    fn parts(&self, u: Interval, limit: Limit) -> Vec<(Option<&Cell>, Interval)> {
        let piece = self.breaks.piece(self.breaks.find(u.mid(), limit));
        let start = self.cells.partition_point(|c| c.u.lo < piece.lo);
        let end = self.cells.partition_point(|c| c.u.lo < piece.hi);
        let cells = &self.cells[start..end];
        if cells.is_empty() {
            return vec![(None, u)];
        }
        let first = cells.partition_point(|c| c.u.hi <= u.lo && !u.is_point() || c.u.hi < u.lo);
        let first = first.min(cells.len() - 1);
        let after = cells.partition_point(|c| c.u.lo < u.hi).max(first + 1);
        let last = if u.is_point() { first + 1 } else { after };
        let part = |i: usize| {
            // The first and the last part reach as far as the range.
            let cell = &cells[i];
            let lo = if i == first { u.lo } else { cell.u.lo };
            let hi = if i + 1 == last { u.hi } else { cell.u.hi };
            (Some(cell), Interval::new(lo, hi))
        };
        (first..last).map(part).collect()
    }

    /// The contacts of a cell over a part of it.
    fn within(&self, cell: &Cell, u: Interval, limit: Limit) -> Option<Enclosed> {
        let (e, _) = self.krawczyk(u, limit)?;
        if (0..4).all(|j| cell.x[j].encloses(e.x[j])) {
            return Some(e);
        }
        // Not surely those of the cell: all contacts in its box are in its image.
        let at = self.contacts(u.mid(), limit).map(Interval::point);
        let thin = self.supports.expand(at, e.within, 1);
        let residual = self.supports.residual(&thin, &e.course, &e.inverse);
        let image = self.image(&at, &residual, &cell.x, &e.course, &e.inverse, e.within);
        let x: Option<Vec<Interval>> = (0..4).map(|j| image[j].intersection(cell.x[j])).collect();
        let x = <[Interval; 4]>::try_from(x?).ok()?;
        Some(Enclosed { x, ..e })
    }

    /// The ball over a range of u, from enclosed contacts.
    fn ball_over(
        &self,
        u: Interval,
        limit: Limit,
        e: &Enclosed,
        order: usize,
    ) -> (Ball<Interval>, Expansion<Interval>, Place<Series<Interval>>) {
        let expansion = self.supports.expand(e.x, e.within, order + 1);
        let course = self.course_over(u, limit, order);
        let series = self
            .supports
            .series(&expansion, e.x, &course, &e.inverse, order);
        let ball = Supports::ball(&expansion, &series, &course.radius);
        (ball, expansion, series)
    }

    /// Quantities that are positive where the fillet is a regular surface and the ball fits: the radius; 1 if there are
    /// proven contacts; those of [`regular`]; and what the curvature of each support leaves to the ball.
    pub(super) fn margins(&self, u: Interval, limit: Limit) -> [Interval; MARGINS] {
        let mut all: Option<[Interval; MARGINS]> = None;
        self.each(u, limit, |part, enclosed| {
            let here = match enclosed {
                None => {
                    let mut none = [Interval::ENTIRE; MARGINS];
                    none[0] = self.radius.series_over(part, limit, 0).value();
                    none
                }
                Some(e) => {
                    let (ball, expansion, _) = self.ball_over(part, limit, &e, 2);
                    let radius = ball.radius.value();
                    let [f0, f1] = [0, 1].map(|k| {
                        let [product, half] = expansion.fit(k, radius);
                        product.min(half)
                    });
                    let [apart, least] = regular(&ball);
                    [radius, Interval::ONE, apart, least, f0, f1]
                }
            };
            all = Some(match all {
                None => here,
                Some(a) => std::array::from_fn(|k| a[k].hull(here[k])),
            });
        });
        all.unwrap_or([Interval::ENTIRE; MARGINS])
    }

    /// What the curvature of a support leaves to the ball, `1 - r κ`, at a parameter.
    pub(super) fn fit(&self, u: f64, k: usize) -> Option<f64> {
        let within = self.pieces[self.breaks.find(u, Limit::Above)].within;
        let radius = self.radius.series_at(u, Limit::Above, 0).value();
        let x = self.contacts(u, Limit::Above);
        Some(self.supports.state(x, within, radius)?.fit(k))
    }

    /// A bound of how far the distances of a centre from both contacts, which are enclosed, are from the radius.
    pub(super) fn contact_error(&self, u: f64, centre: DVec3) -> f64 {
        let mut worst: f64 = 0.0;
        for (u, limit) in self.breaks.parts(Interval::point(u)) {
            self.each(u, limit, |_, enclosed| {
                let Some(e) = enclosed else {
                    worst = f64::INFINITY;
                    return;
                };
                let radius = self.radius.series_over(u, limit, 0).value();
                let expansion = self.supports.expand(e.x, e.within, 1);
                for p in expansion.points() {
                    let away = Box3::point(centre) - Box3::from(p);
                    worst = worst.max((away.norm() - radius).mag());
                }
            });
        }
        worst
    }

    /// The parameters of one contact with their derivatives.
    fn write_contact(&self, k: usize, u: f64, limit: Limit, order: usize, out: &mut [f64]) {
        let (_, _, series) = self.series_at(u, limit, order);
        write(&series[2 * k..2 * k + 2], order, out);
    }
}

/// How many conditions [`Spine::margins`] has.
pub(super) const MARGINS: usize = 6;

/// Derivatives 0 to `order` of functions, row-major by derivative.
fn write<S: crate::scalar::Number>(functions: &[Series<S>], order: usize, out: &mut [S]) {
    let mut row = vec![S::ZERO; order + 1];
    for (f, series) in functions.iter().enumerate() {
        series.write_derivatives(&mut row);
        for (k, d) in row.iter().enumerate() {
            out[k * functions.len() + f] = *d;
        }
    }
}

/// The guide and the radius at a parameter.
pub(super) fn course(
    guide: &dyn Curve,
    radius: &Radius,
    u: f64,
    limit: Limit,
    order: usize,
) -> Course<f64> {
    let jet = guide.jet(u, limit, order + 1);
    let guide: Vector<f64> = std::array::from_fn(|k| {
        let c: Vec<f64> = jet.d.iter().map(|p| p[k]).collect();
        Series::from_derivatives(&c)
    });
    Course {
        guide,
        radius: radius.series_at(u, limit, order),
    }
}

/// The guide's point and its first two derivatives.
fn guide_at(course: &Course<f64>) -> [DVec3; 2] {
    let at = |k: usize| DVec3::from_array(course.guide.each_ref().map(|x| x.c[k]));
    [at(0), at(1)]
}

/// The row of the guide's plane.
fn square(s: &State, course: &Course<f64>) -> Place<f64> {
    let [_, d] = guide_at(course);
    [s.columns[0].dot(d), s.columns[1].dot(d), 0.0, 0.0]
}

/// A step of Newton's method in the guide's plane, and its length.
pub(super) fn newton(
    supports: &Supports,
    x: Place<f64>,
    within: Place<Interval>,
    course: &Course<f64>,
) -> Option<(Place<f64>, f64)> {
    let s = supports.state(x, within, course.radius.value())?;
    let [g, d] = guide_at(course);
    let fourth = Fourth {
        value: (s.centres[0] - g).dot(d),
        row: square(&s, course),
    };
    let step = s.step(&fourth)?;
    Some((step, s.speed(step)))
}

impl Piece {
    /// About the contacts: by Hermite's cubic between the nodes.
    fn guess(&self, u: f64) -> Place<f64> {
        let n = &self.nodes;
        let i = n.partition_point(|n| n.u <= u).clamp(1, n.len() - 1);
        let (a, b) = (&n[i - 1], &n[i]);
        let h = b.u - a.u;
        let t = (u - a.u) / h;
        let s = 1.0 - t;
        let guess: Place<f64> = std::array::from_fn(|j| {
            let (p, q) = (a.x[j], b.x[j]);
            s * s * ((1.0 + 2.0 * t) * p + t * h * a.d[j])
                + t * t * ((1.0 + 2.0 * s) * q - s * h * b.d[j])
        });
        std::array::from_fn(|j| guess[j].clamp(self.within[j].lo, self.within[j].hi))
    }

    /// Whether a parameter lies beyond the piece by more than rounding.
    pub(super) fn leaves(&self, x: Place<f64>, j: usize, width: f64) -> bool {
        let slack = AT_BREAK * width;
        x[j] < self.within[j].lo - slack || x[j] > self.within[j].hi + slack
    }
}

impl Functions for Spine {
    fn count(&self) -> usize {
        COUNT
    }

    fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        write_sections(&self.ball(t, limit, order + 1), order, out);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        let mut first = true;
        for (cell, u) in self.parts(t, limit) {
            let part = self.memo.get(u, limit, order, || {
                let mut part = vec![Interval::ENTIRE; out.len()];
                if let Some(e) = self.enclosed(cell, u, limit) {
                    let (ball, _, _) = self.ball_over(u, limit, &e, order + 1);
                    write_sections(&ball, order, &mut part);
                }
                part.into()
            });
            for (o, p) in out.iter_mut().zip(part.iter()) {
                *o = if first { *p } else { o.hull(*p) };
            }
            first = false;
        }
    }
}

/// The parameters of one contact, two functions of u: the trimming curve in the parameter plane of a support.
#[derive(Clone, Debug)]
pub(super) struct ContactCurve {
    spine: std::sync::Arc<Spine>,
    index: usize,
    breaks: Vec<Break>,
}

impl ContactCurve {
    /// The curve on one support. At the seam of a closed support it jumps to the other side.
    pub(super) fn new(spine: std::sync::Arc<Spine>, index: usize) -> Self {
        let mut breaks = spine.breaks.clone();
        for (b, pair) in breaks[1..].iter_mut().zip(spine.pieces.windows(2)) {
            let before = pair[0].nodes[pair[0].nodes.len() - 1].x;
            let after = pair[1].nodes[0].x;
            if (2 * index..2 * index + 2).any(|j| before[j] != after[j]) {
                *b = Break::new(b.at, -1);
            }
        }
        Self {
            spine,
            index,
            breaks,
        }
    }
}

impl Functions for ContactCurve {
    fn count(&self) -> usize {
        2
    }

    fn breaks(&self) -> &[Break] {
        &self.breaks
    }

    fn jet_into(&self, t: f64, limit: Limit, order: usize, out: &mut [f64]) {
        self.spine.write_contact(self.index, t, limit, order, out);
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, order: usize, out: &mut [Interval]) {
        let mut first = true;
        let mut part = vec![Interval::ENTIRE; out.len()];
        self.spine.each(t, limit, |u, enclosed| {
            match enclosed {
                None => part.fill(Interval::ENTIRE),
                Some(e) => {
                    let (_, _, series) = self.spine.ball_over(u, limit, &e, order);
                    let k = 2 * self.index;
                    write(&series[k..k + 2], order, &mut part);
                }
            }
            for (o, p) in out.iter_mut().zip(&part) {
                *o = if first { *p } else { o.hull(*p) };
            }
            first = false;
        });
    }
}
