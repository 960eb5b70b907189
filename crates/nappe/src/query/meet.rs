//! All points where two functions of two parameters are zero.

use super::cells::rectangles;
use super::chains::touch;
use super::extended::Extended;
use super::field::Field;
use super::solve::{Enclosed, System, solve};
use super::trace::{TraceError, Undecided};
use crate::clusters::clusters;
use crate::interval::Interval;

/// The smallest box relative to the rectangle. Where curves touch, the boxes left grow in number as the root of their
/// inverse width.
const SMALLEST: f64 = 1.0 / (1u64 << 20) as f64;

/// How to solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeetOptions {
    /// The rectangle to look in; `None`: the domain of the first function.
    pub within: Option<[Interval; 2]>,
    /// The most boxes that are looked at.
    pub budget: usize,
}

impl Default for MeetOptions {
    fn default() -> Self {
        Self {
            within: None,
            budget: 100_000,
        }
    }
}

/// A point where both functions are zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeetPoint {
    /// The parameters.
    pub uv: [f64; 2],
    /// It is proven to be in here.
    pub zero: [Interval; 2],
    /// It is proven to be the only one in here, and to be a crossing: the gradients of the two functions are independent.
    pub alone: [Interval; 2],
}

/// All points.
#[derive(Clone, Debug, Default)]
pub struct Meets {
    /// The proven points, by growing u, then v.
    pub points: Vec<MeetPoint>,
    /// Where it is not decided whether there are points, and how many: the curves touch, or run together.
    pub undecided: Vec<Undecided>,
    /// How many boxes were looked at.
    pub boxes: usize,
}

struct Both<'a>([Extended<'a>; 2]);

impl System<2> for Both<'_> {
    fn enclose(&self, x: &[Interval; 2]) -> Option<Enclosed<2>> {
        let [f, g] = [self.0[0].slopes(*x)?, self.0[1].slopes(*x)?];
        Some(Enclosed {
            value: [f[0], g[0]],
            slopes: [[f[1], f[2]], [g[1], g[2]]],
        })
    }
}

/// All points where f and g are zero: each is proven to be the only one in its box, and every other one lies at a place
/// that is not decided. Points beyond the border by less than 10⁻¹⁰ of the width count as on it.
///
/// Errors: the rectangle is not a part of both domains; a function has no value anywhere, or is zero everywhere. Cost: some enclosures for each
/// box; simple points need few.
///
/// ```
/// use nappe::expr::Expr;
/// use nappe::query::{ExpressionField, MeetOptions, meet};
/// use nappe::Interval;
///
/// let square = [Interval::new(-2.0, 2.0); 2];
/// let field = |text| {
///     let bound = Expr::parse(text).unwrap().bind(&["u", "v"], &[]).unwrap();
///     ExpressionField::new(bound, square)
/// };
/// let found = meet(&field("u^2 + v^2 - 1"), &field("v - u^2"), &MeetOptions::default()).unwrap();
/// assert_eq!((found.points.len(), found.undecided.len()), (2, 0));
/// ```
pub fn meet(f: &dyn Field, g: &dyn Field, options: &MeetOptions) -> Result<Meets, TraceError> {
    let within = options.within.unwrap_or(f.domain());
    for field in [f, g] {
        let domain = field.domain();
        let sound = |d: usize| {
            within[d].is_finite() && within[d].lo < within[d].hi && domain[d].encloses(within[d])
        };
        if !(sound(0) && sound(1)) {
            return Err(TraceError::Rectangle { within, domain });
        }
    }
    let rectangles = rectangles(&[f, g], within);
    let share = (options.budget / rectangles.len()).max(1000);
    let mut out = Meets::default();
    let mut empty = 0;
    for rect in &rectangles {
        let both = Both([f, g].map(|field| Extended::new(field, *rect)));
        let outer = both.0[0].outer;
        if both.enclose(&outer).is_none() {
            empty += 1;
            continue;
        }
        if both.0.iter().any(|f| f.is_zero(*rect)) {
            return Err(TraceError::Zero(*rect));
        }
        let found = solve(&both, outer, SMALLEST, share);
        out.boxes += found.looked;
        let before = out.points.len();
        for zero in found.zeros {
            // On a line where a function jumps a point may belong to both sides.
            let known = out.points[..before].iter().any(|p| touch(p.zero, zero.at));
            if touch(zero.at, outer) && !known {
                out.points.push(MeetPoint {
                    uv: both.0[0].clamp(zero.at.map(Interval::mid)),
                    zero: zero.at,
                    alone: zero.alone,
                });
            }
        }
        for group in clusters(&found.open, 0.0) {
            let cells: Vec<_> = group.iter().map(|&k| found.open[k]).collect();
            let hull = cells
                .iter()
                .copied()
                .reduce(|a, b| [0, 1].map(|d| a[d].hull(b[d])));
            out.undecided.push(Undecided {
                hull: hull.unwrap_or(*rect),
                cells,
                ends: 0,
            });
        }
    }
    if empty == rectangles.len() {
        return Err(TraceError::NoValue(within));
    }
    out.points.sort_by(|a, b| {
        let [p, q] = [a.uv, b.uv];
        p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1]))
    });
    Ok(out)
}
