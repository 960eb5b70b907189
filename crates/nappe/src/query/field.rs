//! Functions of two parameters that enclose themselves: what is traced and what is solved.

use crate::expr::Bound;
use crate::interval::Interval;
use crate::series::Series;
use crate::surface::Dir;
use std::fmt::{self, Debug};

/// Enclosures of `f, f_u, f_v, f_uu, f_uv, f_vv`, in the order of [`jet_index`](crate::surface::jet_index).
pub type FieldJet = [Interval; 6];

/// A function `f(u, v)` on a rectangle.
///
/// Where f is continuous but its first derivatives jump (a crease) the enclosures of these hold the values on both sides,
/// and those of the second derivative across it are [`Interval::ENTIRE`]. Where f itself jumps, the first
/// derivatives are [`Interval::ENTIRE`] too, or the place is one of [`Field::jumps`].
pub trait Field: Debug + Send + Sync {
    /// The rectangle.
    fn domain(&self) -> [Interval; 2];

    /// The parameters inside the domain where f may jump, increasing: the rectangle is divided there.
    fn jumps(&self, dir: Dir) -> Vec<f64> {
        let _ = dir;
        Vec::new()
    }

    /// Enclosures over a box inside the domain that lies between jumps (a box that ends on a jump sees the side it lies
    /// on; a box of width zero there is `beside` a larger one). `None` if f has no value anywhere in the box;
    /// [`Interval::ENTIRE`] for what is not known. They must shrink with the box.
    ///
    /// If f may have no value at some places of the box, the first enclosure holds all that it has, and all others are
    /// [`Interval::ENTIRE`]: what is proven by derivatives needs f all over the box.
    fn enclose(&self, uv: [Interval; 2], beside: [Interval; 2]) -> Option<FieldJet>;

    /// An enclosure of f alone over an edge: a box of width zero in one direction. It is asked for on borders, where f
    /// may be zero all along: by Taylor polynomials of a high degree much fewer parts are needed.
    fn edge(&self, uv: [Interval; 2], beside: [Interval; 2]) -> Option<Interval> {
        self.enclose(uv, beside).map(|j| j[0])
    }
}

/// The degree of the polynomials along edges.
const HIGH: usize = 8;

/// The range of a formula of power series over an edge, by Taylor's formula about its middle; the formula says too whether
/// it may have no value at some places.
fn on_edge(
    uv: [Interval; 2],
    formula: impl Fn(&[Series<Interval>; 2], usize) -> Option<(Series<Interval>, bool)>,
) -> Option<Interval> {
    let d = usize::from(uv[0].is_point());
    let at = |t: Interval| {
        let mut s = uv.map(|x| Series::constant(x, HIGH));
        s[d] = Series::variable(t, HIGH);
        formula(&s, HIGH)
    };
    let (wide, doubt) = at(uv[d])?;
    if doubt {
        return Some(wide.c[0]);
    }
    let middle = Interval::point(uv[d].mid());
    let (narrow, _) = at(middle)?;
    let x = uv[d] - middle;
    let sum = (0..HIGH).fold(wide.c[HIGH] * x.powi(HIGH as i32), |sum, k| {
        sum + narrow.c[k] * x.powi(k as i32)
    });
    Some(if sum.is_finite() {
        sum.meet(wide.c[0])
    } else {
        wide.c[0]
    })
}

/// The value and derivatives of a formula of power series along three directions of the parameter plane.
///
/// With `g(t) = f(u + t, v + t)`: `f_uv = ½ (g'' - f_uu - f_vv)`. The formula says too whether it may have no value at some
/// places.
fn along(
    uv: [Interval; 2],
    formula: impl Fn(&[Series<Interval>; 2]) -> Option<(Series<Interval>, bool)>,
) -> Option<FieldJet> {
    let towards = |a: f64, b: f64| {
        let series = |x: Interval, slope: f64| {
            let mut s = Series::constant(x, 2);
            s.c[1] = Interval::point(slope);
            s
        };
        let (s, doubt) = formula(&[series(uv[0], a), series(uv[1], b)])?;
        Some(if doubt {
            [s.c[0], Interval::ENTIRE, Interval::ENTIRE]
        } else {
            [s.c[0], s.c[1], s.c[2]]
        })
    };
    let (u, v, both) = (towards(1.0, 0.0)?, towards(0.0, 1.0)?, towards(1.0, 1.0)?);
    let two = Interval::point(2.0);
    Some([
        u[0],
        u[1],
        v[1],
        two * u[2],
        both[2] - u[2] - v[2],
        two * v[2],
    ])
}

/// An expression of two variables as a [`Field`].
#[derive(Clone, Debug)]
pub struct ExpressionField {
    bound: Bound,
    domain: [Interval; 2],
}

impl ExpressionField {
    /// An expression bound to two variables, u first. Panics if it was bound to another number of variables.
    pub fn new(bound: Bound, domain: [Interval; 2]) -> Self {
        assert_eq!(bound.variables().len(), 2, "an expression of u and v");
        Self { bound, domain }
    }
}

impl Field for ExpressionField {
    fn domain(&self) -> [Interval; 2] {
        self.domain
    }

    fn enclose(&self, uv: [Interval; 2], _: [Interval; 2]) -> Option<FieldJet> {
        along(uv, |s| self.bound.doubtful_series(s, 2).ok())
    }

    fn edge(&self, uv: [Interval; 2], _: [Interval; 2]) -> Option<Interval> {
        on_edge(uv, |s, order| self.bound.doubtful_series(s, order).ok())
    }
}

/// A formula of power series as a [`Field`]: a closure that computes f from u and v.
///
/// ```
/// use nappe::query::{FormulaField, TraceOptions, trace};
/// use nappe::Interval;
///
/// // The circle u² + v² = 1.
/// let square = Interval::new(-2.0, 2.0);
/// let one = Interval::ONE;
/// let f = FormulaField::new([square, square], move |[u, v]| {
///     let mut f = u.sqr().add(&v.sqr());
///     f.c[0] = f.c[0] - one;
///     f
/// });
/// let found = trace(&f, &TraceOptions::default()).unwrap();
/// assert!(found.branches.len() == 1 && found.branches[0].is_closed() && found.undecided.is_empty());
/// ```
pub struct FormulaField<F> {
    formula: F,
    domain: [Interval; 2],
}

impl<F: Fn(&[Series<Interval>; 2]) -> Series<Interval> + Send + Sync> FormulaField<F> {
    /// A formula over a rectangle, all over which it has a value.
    pub fn new(domain: [Interval; 2], formula: F) -> Self {
        Self { formula, domain }
    }
}

impl<F> Debug for FormulaField<F> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "FormulaField over {:?}", self.domain)
    }
}

impl<F: Fn(&[Series<Interval>; 2]) -> Series<Interval> + Send + Sync> Field for FormulaField<F> {
    fn domain(&self) -> [Interval; 2] {
        self.domain
    }

    fn enclose(&self, uv: [Interval; 2], _: [Interval; 2]) -> Option<FieldJet> {
        along(uv, |s| Some(((self.formula)(s), false)))
    }

    fn edge(&self, uv: [Interval; 2], _: [Interval; 2]) -> Option<Interval> {
        on_edge(uv, |s, _| Some(((self.formula)(s), false)))
    }
}
