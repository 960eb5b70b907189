//! How smoothly surfaces join along shared sides: gap, angle and curvature jump, bounded over the whole edge.

use super::along::{Along, Fields, ORDER, Vector, compose, taylor};
use super::jump::{Jump, JumpOptions, Part, greatest};
use crate::box3::Box3;
use crate::breaks::Limit;
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::mesh::shared::{Edge, Map, matching};
use crate::series::{Series, series_cross, series_dot};
use crate::surface::{Dir, Side, Surface};
use glam::DVec3;

/// Bounds below this part of the size (or this angle in radians, or this relative curvature) are not sharpened: it is
/// what rounding leaves. Smaller, and parts would be spent on rounding errors; larger, and bounds would be coarse.
const ENOUGH: [f64; 3] = [1e-13, 1e-10, 1e-9];
/// A normal shorter than this part of the longest one along the edge, at an end of the edge, is taken for zero: the end
/// is a pole. Larger, and narrow corners would count as poles; smaller, and rounding would hide poles.
const POLE: f64 = 1e-10;
/// Curvatures differ by at most twice the greatest. A bound of this many times the greatest found is that of rounding
/// errors beside a pole, where curvature comes from 0/0: there nothing is proven.
const NO_BOUND: f64 = 1e3;
/// Parts with a cubic reparametrisation each, where the parameters of two sides do not correspond linearly.
const CUBICS: usize = 128;

/// The order of geometric continuity.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Smoothness {
    /// The sides are one curve.
    G0,
    /// The tangent planes agree as well, and the surfaces go on rather than fold back.
    G1,
    /// The curvatures agree as well.
    G2,
}

/// How two surfaces join along a shared side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Continuity {
    /// The distance of corresponding points, a length.
    pub gap: Jump,
    /// The angle by which the surface turns on crossing the edge, in radians: 0 for tangent planes that agree with the
    /// surfaces on opposite sides of the edge, π for a surface that folds back onto itself.
    pub angle: Jump,
    /// The difference of the normal curvatures across the edge, relative to [`Self::curvature_scale`].
    pub curvature: Jump,
    /// The greatest curvature across the edge found on either side, but at least 1/(size of the edge); 1/length.
    pub curvature_scale: f64,
    /// True if `r_u × r_v` of both surfaces point to the same side (where the joint is smooth).
    pub same_orientation: bool,
}

impl Continuity {
    /// The highest continuity that is proven within tolerances for the gap (a length), the angle (radians) and the
    /// relative curvature difference; `None` if not even the gap is.
    pub fn proven(&self, gap: f64, angle: f64, curvature: f64) -> Option<Smoothness> {
        let holds = |e: &Jump, tol: f64| e.within(tol) == Some(true);
        if !holds(&self.gap, gap) {
            None
        } else if !holds(&self.angle, angle) {
            Some(Smoothness::G0)
        } else if !holds(&self.curvature, curvature) {
            Some(Smoothness::G1)
        } else {
            Some(Smoothness::G2)
        }
    }
}

/// A side of a surface.
pub type SideOf<'a> = (&'a dyn Surface, Side);

/// Measures how two surfaces (or two sides of one surface) join along sides that coincide within `tol`, a length, with
/// equal or opposite direction and any parametrisation. `None` if they do not coincide (sampled).
///
/// Bounds are proven over the whole edge by Taylor forms of order 4 with enclosed remainders. Where nothing can be
/// proven (curvature at a pole) the result is estimated. At a pole, what is shorter than rounding counts as zero.
/// Cost: some hundred points for the correspondence, and four enclosures of order 4 to 6 for each part.
pub fn continuity(a: SideOf, b: SideOf, tol: f64, options: &JumpOptions) -> Option<Continuity> {
    let edges = [a, b].map(|(surface, side)| Edge::new(surface, side));
    measured(edges, tol, options)
}

/// The same for a part of each side, from end to end: for ranges of their parameters, such as those of a
/// [`PartialJoint`](crate::mesh::PartialJoint). `None` also if a range is not in the domain of its side, or has no width.
pub fn continuity_in_part(
    a: (SideOf, Interval),
    b: (SideOf, Interval),
    tol: f64,
    options: &JumpOptions,
) -> Option<Continuity> {
    let fits = |((surface, side), range): (SideOf, Interval)| {
        let whole = Edge::new(surface, side).range;
        whole.lo <= range.lo && range.lo < range.hi && range.hi <= whole.hi
    };
    if !(fits(a) && fits(b)) {
        return None;
    }
    let edges = [a, b].map(|((surface, side), range)| Edge::part(surface, side, range));
    measured(edges, tol, options)
}

/// A bound of the distance of corresponding points alone; `None` if the sides do not coincide within `tol`, or if nothing
/// is proven.
pub(crate) fn greatest_gap(a: SideOf, b: SideOf, tol: f64) -> Option<f64> {
    let [a, b] = [a, b].map(|(surface, side)| Along {
        edge: Edge::new(surface, side),
    });
    let map = matching(&a.edge, &b.edge, tol)?;
    Pair::new(a, b, &map).greatest_gap()
}

fn measured(edges: [Edge; 2], tol: f64, options: &JumpOptions) -> Option<Continuity> {
    let [a, b] = edges.map(|edge| Along { edge });
    let map = matching(&a.edge, &b.edge, tol)?;
    let pair = Pair::new(a, b, &map);
    let parts: Vec<Interval> = pair.cells.iter().map(|c| c.t).collect();
    let jump = |(certainty, best): (_, Part), factor: f64| Jump {
        greatest: scaled(certainty, factor),
        found: best.found * factor,
        at: best.at,
        point: pair.a.edge.point(best.at),
    };
    let scale = pair.curvature_scale();
    let [gap, angle, curvature] = ENOUGH;
    Some(Continuity {
        gap: jump(
            greatest(&parts, |t| pair.gap(t), gap * pair.size, options),
            1.0,
        ),
        angle: jump(greatest(&parts, |t| pair.angle(t), angle, options), 1.0),
        curvature: jump(
            meaningful(
                greatest(&parts, |t| pair.curvature(t), curvature * scale, options),
                NO_BOUND * scale,
            ),
            1.0 / scale,
        ),
        curvature_scale: scale,
        same_orientation: pair.same_orientation(),
    })
}

/// A bound of at least `most` bounds nothing: the result is an estimate.
fn meaningful((certainty, best): (Certainty, Part), most: f64) -> (Certainty, Part) {
    match certainty {
        Certainty::Bounded(e) if e >= most => (Certainty::Estimated(best.found), best),
        other => (other, best),
    }
}

fn scaled(c: Certainty, factor: f64) -> Certainty {
    use Certainty::{Bounded, Estimated, Exact};
    match c {
        Exact => Exact,
        Bounded(e) => Bounded(e * factor),
        Estimated(e) => Estimated(e * factor),
    }
}

/// A range of the first side's parameter with the polynomial that gives the second's: `Σ c_k (t - from)ᵏ`.
#[derive(Clone, Debug)]
pub(super) struct Cell {
    pub(super) t: Interval,
    from: f64,
    c: [f64; 4],
}

impl Cell {
    pub(super) fn series(&self, t: Interval) -> Series<Interval> {
        let x = Series::variable(t - Interval::point(self.from), ORDER);
        let mut r = Series::constant(Interval::point(self.c[3]), ORDER);
        for k in (0..3).rev() {
            r = r.mul(&x);
            r.c[0] = r.c[0] + Interval::point(self.c[k]);
        }
        r
    }

    /// A range of parameters that contains all in the cell whose partners are in `range`; `None` if there are none.
    pub(super) fn back(&self, range: Interval) -> Option<Interval> {
        range.intersection(self.series(self.t).c[0])?;
        let [start, slope, bent @ ..] = self.c;
        if bent != [0.0; 2] || slope == 0.0 {
            return Some(self.t);
        }
        let t = (range - Interval::point(start)) / Interval::point(slope);
        (t + Interval::point(self.from)).intersection(self.t)
    }

    fn value(&self, t: f64) -> f64 {
        let x = t - self.from;
        ((self.c[3] * x + self.c[2]) * x + self.c[1]) * x + self.c[0]
    }
}

/// Two sides with the correspondence of their parameters.
pub(super) struct Pair<'a> {
    a: Along<'a>,
    b: Along<'a>,
    pub(super) cells: Vec<Cell>,
    /// The sign that turns the second side's `r_t × r_c` to that of the first, if the surface goes on across the edge.
    sign: f64,
    size: f64,
    /// Whether the normal of the first and of the second side vanishes at the start and at the end of the edge.
    poles: [[bool; 2]; 2],
}

/// Enclosures of a quantity at the centre of expansion and over a part.
pub(super) struct Form<T> {
    pub(super) at: T,
    pub(super) over: T,
    pub(super) x: Interval,
}

impl<'a> Pair<'a> {
    pub(super) fn new(a: Along<'a>, b: Along<'a>, map: &Map) -> Self {
        let inward = |e: &Edge| if e.side.is_upper() { -1.0 } else { 1.0 };
        let sign = inward(&a.edge) * inward(&b.edge) * if map.is_reversed() { 1.0 } else { -1.0 };
        let size = size(&a.edge).max(size(&b.edge));
        let cells = cells(&a, &b, map);
        let mut pair = Self {
            a,
            b,
            cells,
            sign,
            size,
            poles: [[false; 2]; 2],
        };
        pair.poles = pair.find_poles();
        pair
    }

    /// South and north have u along them: there `r_t × r_c` is `r_u × r_v`, on west and east it is the opposite.
    fn same_orientation(&self) -> bool {
        let along_u = |e: &Edge| e.side.along() == Dir::U;
        (along_u(&self.a.edge) == along_u(&self.b.edge)) == (self.sign > 0.0)
    }

    fn cell(&self, t: Interval) -> &Cell {
        let m = t.mid();
        let k = self.cells.partition_point(|c| c.t.hi <= m);
        &self.cells[k.min(self.cells.len() - 1)]
    }

    /// The fields of both sides over a range of the first one's parameter, and the correspondence there.
    fn fields(&self, t: Interval, limit: Limit, orders: usize) -> ([Fields; 2], Series<Interval>) {
        let cell = self.cell(t);
        let mut phi = cell.series(t);
        // The ends of cells are breaks of either side; rounding must not carry the parameter across one.
        phi.c[0] = phi.c[0].meet(self.b.piece(Interval::point(cell.value(cell.t.mid()))));
        let turned = if self.is_reversed() {
            match limit {
                Limit::Above => Limit::Below,
                Limit::Below => Limit::Above,
            }
        } else {
            limit
        };
        let fields = [
            self.a.fields(t, limit, orders),
            self.b.fields(phi.c[0], turned, orders),
        ];
        (fields, phi)
    }

    pub(super) fn is_reversed(&self) -> bool {
        let (first, last) = (&self.cells[0], &self.cells[self.cells.len() - 1]);
        last.value(last.t.hi) < first.value(first.t.lo)
    }

    fn find_poles(&self) -> [[bool; 2]; 2] {
        let mut longest = [0.0f64; 2];
        let mut ends = [[0.0; 2]; 2];
        let last = self.cells.len() - 1;
        let mut lengths = |t: f64, limit: Limit| {
            let (fields, _) = self.fields(Interval::point(t), limit, 1);
            let n = fields.map(|f| middle(&f.normal()).length());
            longest = [longest[0].max(n[0]), longest[1].max(n[1])];
            n
        };
        for c in &self.cells {
            lengths(c.t.mid(), Limit::Above);
        }
        let n = [
            lengths(self.cells[0].t.lo, Limit::Above),
            lengths(self.cells[last].t.hi, Limit::Below),
        ];
        for (e, n) in n.iter().enumerate() {
            for s in 0..2 {
                ends[s][e] = n[s];
            }
        }
        [0, 1].map(|s| ends[s].map(|n| n <= POLE * longest[s]))
    }

    /// The centre of expansion for a part, the limit there, and how often both normals are divided by `t - centre`.
    fn centre(&self, t: Interval) -> (f64, Limit, [usize; 2]) {
        let (lo, hi) = (self.cells[0].t.lo, self.cells[self.cells.len() - 1].t.hi);
        let drops = |e: usize| self.poles.map(|p| usize::from(p[e]));
        if t.lo <= lo && drops(0) != [0, 0] {
            (lo, Limit::Above, drops(0))
        } else if t.hi >= hi && drops(1) != [0, 0] {
            (hi, Limit::Below, drops(1))
        } else {
            (t.mid(), Limit::Above, [0, 0])
        }
    }

    /// Both sides' vector quantities, as functions of the first side's parameter.
    pub(super) fn vectors(
        &self,
        t: Interval,
        m: f64,
        limit: Limit,
        orders: usize,
        f: impl Fn(&Fields) -> Vector,
    ) -> Form<[Vector; 2]> {
        let both = |t: Interval, limit: Limit| {
            let ([a, b], phi) = self.fields(t, limit, orders);
            [f(&a), f(&b).map(|s| compose(&s, &phi))]
        };
        Form {
            at: both(Interval::point(m), limit),
            over: both(t, limit),
            x: t - Interval::point(m),
        }
    }

    /// A bound of the distance between corresponding points along the whole edge; `None` if nothing is proven.
    pub(super) fn greatest_gap(&self) -> Option<f64> {
        let parts: Vec<Interval> = self.cells.iter().map(|c| c.t).collect();
        let enough = ENOUGH[0] * self.size;
        match greatest(&parts, |t| self.gap(t), enough, &JumpOptions::default()).0 {
            Certainty::Exact => Some(0.0),
            Certainty::Bounded(e) => Some(e),
            Certainty::Estimated(_) => None,
        }
    }

    /// `|a(t) - b(φ(t))|`.
    fn gap(&self, t: Interval) -> Part {
        let m = t.mid();
        let form = self.vectors(t, m, Limit::Above, 0, |f| f.series(0, 0));
        let difference = |[a, b]: &[Vector; 2]| -> Vector { [0, 1, 2].map(|i| a[i].sub(&b[i])) };
        let d = enclose(&difference(&form.at), &difference(&form.over), form.x, 0);
        let [a, b] = [
            self.a.edge.point(m),
            self.b.edge.point(self.cell(t).value(m)),
        ];
        Part {
            upper: d.norm().hi,
            found: a.distance(b),
            at: m,
        }
    }

    /// The angle between the normals, turned so that 0 is a smooth surface.
    fn angle(&self, t: Interval) -> Part {
        let (m, limit, drops) = self.centre(t);
        let form = self.vectors(t, m, limit, 1, Fields::normal);
        let both = drops[0] + drops[1];
        // Division by t - m turns the sign of a normal for t < m.
        let odd = both % 2 == 1 && form.x.hi <= 0.0;
        let sign = Interval::point(if odd { -self.sign } else { self.sign });
        let length = |i: usize| enclose(&form.at[i], &form.over[i], form.x, drops[i]).norm();
        let product = length(0) * length(1);
        let cross = |[a, b]: &[Vector; 2]| series_cross(a, b);
        let dot = |[a, b]: &[Vector; 2]| series_dot(a, b);
        let sin = enclose(&cross(&form.at), &cross(&form.over), form.x, both).norm() / product;
        let cos = taylor(&dot(&form.at), &dot(&form.over), form.x, both) * sign / product;
        let mut upper = f64::INFINITY;
        if product.lo > 0.0 {
            upper = Interval::point(cos.lo.clamp(-1.0, 1.0)).acos().hi;
            if cos.lo > 0.0 && sin.hi < 1.0 {
                upper = upper.min(Interval::point(sin.hi).asin().hi);
            }
        }
        let inner = t.mid();
        let (fields, _) = self.fields(Interval::point(inner), Limit::Above, 1);
        // What is certain: beside a pole the middle of an enclosure would be rounding errors.
        let [a, b] = fields.map(|f| Box3::from(f.normal().map(|s| s.c[0])));
        let cos = (a.dot(b) * Interval::point(self.sign)).hi;
        let known = a.norm().lo > 0.0 && b.norm().lo > 0.0;
        Part {
            upper,
            found: if known {
                a.cross(b).norm().lo.atan2(cos)
            } else {
                f64::NAN
            },
            at: inner,
        }
    }

    /// The difference of the curvatures across the edge.
    fn curvature(&self, t: Interval) -> Part {
        let m = t.mid();
        let both = |t: Interval| {
            let ([a, b], phi) = self.fields(t, Limit::Above, 2);
            let b = compose(&b.curvature(), &phi).scale(Interval::point(self.sign));
            a.curvature().sub(&b)
        };
        let (at, over) = (both(Interval::point(m)), both(t));
        let d = taylor(&at, &over, t - Interval::point(m), 0).meet(over.c[0]);
        Part {
            upper: d.mag(),
            // What is certain: beside a pole, where curvatures come from 0/0, the middle would be rounding errors.
            found: if at.c[0].is_finite() {
                at.c[0].mig()
            } else {
                f64::NAN
            },
            at: m,
        }
    }

    /// The greatest curvature found on either side, but at least 1/size.
    fn curvature_scale(&self) -> f64 {
        self.cells
            .iter()
            .flat_map(|c| {
                let (fields, _) = self.fields(Interval::point(c.t.mid()), Limit::Above, 2);
                fields.map(|f| f.curvature().c[0].mid().abs())
            })
            .filter(|k| k.is_finite())
            .fold(1.0 / self.size, f64::max)
    }
}

/// The middle of the value of a vector series.
fn middle(v: &Vector) -> DVec3 {
    DVec3::new(v[0].c[0].mid(), v[1].c[0].mid(), v[2].c[0].mid())
}

pub(super) fn enclose(at: &Vector, over: &Vector, x: Interval, drop: usize) -> Box3 {
    Box3::from([0, 1, 2].map(|i| {
        let e = taylor(&at[i], &over[i], x, drop);
        if drop == 0 { e.meet(over[i].c[0]) } else { e }
    }))
}

/// The diagonal of a box around points of the edge.
fn size(e: &Edge) -> f64 {
    const SAMPLES: usize = 16;
    let points = (0..=SAMPLES).map(|k| e.point(e.sample(k, SAMPLES)));
    Box3::around(points).map_or(0.0, Box3::diagonal)
}

/// Divides the first side at the breaks of both, and gives each part its polynomial.
fn cells(a: &Along, b: &Along, map: &Map) -> Vec<Cell> {
    let (ra, rb) = (a.edge.range, b.edge.range);
    let [start, end] = if map.is_reversed() {
        [rb.hi, rb.lo]
    } else {
        [rb.lo, rb.hi]
    };
    let linear = map.is_linear();
    let mut at = a.breaks();
    for s in b.breaks() {
        at.push(if linear {
            ra.lo + (ra.hi - ra.lo) * ((s - start) / (end - start))
        } else {
            map.partner(1, s, b.edge.point(s), &a.edge)
        });
    }
    if !linear {
        at.extend((1..CUBICS).map(|k| a.edge.sample(k, CUBICS)));
    }
    at.sort_by(f64::total_cmp);
    /// Breaks closer than this part of the range are one.
    const ONE: f64 = 1e-12;
    at.dedup_by(|x, y| (*x - *y).abs() <= ONE * (ra.hi - ra.lo));
    let last = at.len() - 1;
    (at[0], at[last]) = (ra.lo, ra.hi);
    let slope = (end - start) / (ra.hi - ra.lo);
    at.windows(2)
        .map(|w| {
            let t = Interval::new(w[0], w[1]);
            if linear {
                return Cell {
                    t,
                    from: ra.lo,
                    c: [start, slope, 0.0, 0.0],
                };
            }
            cubic(a, b, map, t)
        })
        .collect()
}

/// The cubic with the right values and slopes of the correspondence at both ends of a part.
fn cubic(a: &Along, b: &Along, map: &Map, t: Interval) -> Cell {
    let h = t.hi - t.lo;
    let end = |t: f64, limit: Limit| {
        let s = map.partner(0, t, a.edge.point(t), &b.edge);
        let turned = if map.is_reversed() == (limit == Limit::Below) {
            Limit::Above
        } else {
            Limit::Below
        };
        let d = middle(&a.fields(Interval::point(t), limit, 1).series(1, 0));
        let e = middle(&b.fields(Interval::point(s), turned, 1).series(1, 0));
        let slope = d.dot(e) / e.length_squared();
        (s, if slope.is_finite() { Some(slope) } else { None })
    };
    let ((s0, d0), (s1, d1)) = (end(t.lo, Limit::Above), end(t.hi, Limit::Below));
    let mean = (s1 - s0) / h;
    let (d0, d1) = (d0.unwrap_or(mean), d1.unwrap_or(mean));
    Cell {
        t,
        from: t.lo,
        c: [
            s0,
            d0,
            (3.0 * mean - 2.0 * d0 - d1) / h,
            (d0 + d1 - 2.0 * mean) / (h * h),
        ],
    }
}
