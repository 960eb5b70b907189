//! Sums of linear images of surfaces and their derivatives, times numbers that vary.

use crate::box3::Box3;
use crate::breaks::{Break, Limit, merge_breaks};
use crate::interval::Interval;
use crate::scalar::{Number as _, Scalar};
use crate::series::binomial;
use crate::surface::{Dir, Surface, SurfaceRef, jet_index, jet_len};
use glam::{DMat3, DVec3};
use smallvec::SmallVec;

/// A number at each place.
#[derive(Clone, Debug)]
pub enum Factor {
    /// `constant + u · along[0] + v · along[1]`.
    Linear {
        /// The number at u = v = 0.
        constant: f64,
        /// Its slopes along u and v.
        along: [f64; 2],
    },
    /// A coordinate of a surface.
    Coordinate {
        /// The surface.
        of: SurfaceRef,
        /// 0, 1 or 2.
        axis: usize,
    },
}

impl Factor {
    /// The number 1.
    pub const ONE: Factor = Factor::Linear {
        constant: 1.0,
        along: [0.0; 2],
    };
}

/// `factor · map (∂ⁱᵤ∂ʲᵥ r - less)`.
#[derive(Clone, Debug)]
pub struct Term {
    /// The surface r.
    pub of: SurfaceRef,
    /// The order of the derivative along u and v.
    pub order: [usize; 2],
    /// What is taken away first: near the surface, digits are not lost far from the origin.
    pub less: DVec3,
    /// The linear map.
    pub map: DMat3,
    /// The number.
    pub factor: Factor,
}

impl Term {
    /// The surface itself.
    pub fn new(of: SurfaceRef) -> Self {
        Self {
            of,
            order: [0; 2],
            less: DVec3::ZERO,
            map: DMat3::IDENTITY,
            factor: Factor::ONE,
        }
    }

    /// A linear image of the way from a point to the surface.
    pub fn image(of: SurfaceRef, map: DMat3, less: DVec3) -> Self {
        Self {
            map,
            less,
            ..Self::new(of)
        }
    }

    /// The derivative along a direction, times a number that is linear in the parameter along it:
    /// `(constant + slope · t) ∂r/∂t`.
    pub fn slide(of: SurfaceRef, dir: Dir, constant: f64, slope: f64) -> Self {
        let (order, along) = match dir {
            Dir::U => ([1, 0], [slope, 0.0]),
            Dir::V => ([0, 1], [0.0, slope]),
        };
        Self {
            order,
            factor: Factor::Linear { constant, along },
            ..Self::new(of)
        }
    }

    /// The same times a number.
    pub fn times(self, factor: Factor) -> Self {
        Self { factor, ..self }
    }
}

/// `constant + Σ terms`, over the domain that all terms share.
#[derive(Clone, Debug)]
pub struct Sum {
    constant: DVec3,
    terms: Vec<Term>,
    breaks: [Vec<Break>; 2],
}

impl Sum {
    /// A sum of at least one term.
    ///
    /// Panics without terms: the domain is theirs.
    pub fn new(constant: DVec3, terms: Vec<Term>) -> Self {
        assert!(!terms.is_empty(), "a sum takes its domain from its terms");
        let breaks = [Dir::U, Dir::V].map(|dir| {
            let own = |t: &Term| {
                let order = t.order[usize::from(dir == Dir::V)] as i32;
                let less_smooth = |b: &Break| Break::new(b.at, b.smooth - order);
                let breaks = t.of.breaks(dir).iter().map(less_smooth);
                let mut all = vec![breaks.collect::<Vec<Break>>()];
                if let Factor::Coordinate { of, .. } = &t.factor {
                    all.push(of.breaks(dir).to_vec());
                }
                all
            };
            let lists: Vec<Vec<Break>> = terms.iter().flat_map(own).collect();
            merge_breaks(lists.iter().map(Vec::as_slice))
        });
        Self {
            constant,
            terms,
            breaks,
        }
    }

    /// Zero, over a domain with the breaks along u and v.
    pub fn still(breaks: [&[Break]; 2]) -> Self {
        Self {
            constant: DVec3::ZERO,
            terms: Vec::new(),
            breaks: breaks.map(<[Break]>::to_vec),
        }
    }
}

/// A vector of numbers or of intervals.
trait Vector: Copy {
    type Number: Scalar;
    const ZERO: Self;
    fn plus(self, o: Self) -> Self;
    fn minus(self, o: DVec3) -> Self;
    fn times(self, s: Self::Number) -> Self;
    fn image(self, map: &DMat3) -> Self;
    fn coordinate(self, axis: usize) -> Self::Number;
}

impl Vector for DVec3 {
    type Number = f64;
    const ZERO: Self = DVec3::ZERO;
    fn plus(self, o: Self) -> Self {
        self + o
    }
    fn minus(self, o: DVec3) -> Self {
        self - o
    }
    fn times(self, s: f64) -> Self {
        self * s
    }
    fn image(self, map: &DMat3) -> Self {
        *map * self
    }
    fn coordinate(self, axis: usize) -> f64 {
        self[axis]
    }
}

impl Vector for Box3 {
    type Number = Interval;
    const ZERO: Self = Box3::ZERO;
    fn plus(self, o: Self) -> Self {
        self + o
    }
    fn minus(self, o: DVec3) -> Self {
        self - Box3::point(o)
    }
    fn times(self, s: Interval) -> Self {
        self.scale(s)
    }
    fn image(self, map: &DMat3) -> Self {
        self.linear_image(map)
    }
    fn coordinate(self, axis: usize) -> Interval {
        self.to_array()[axis]
    }
}

/// The pairs of orders of a jet, in its order.
fn orders(order: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..=order).flat_map(|n| (0..=n).map(move |j| [n - j, j]))
}

impl Sum {
    /// The jet of the sum; `jet` gives that of a surface.
    fn sum<V: Vector>(
        &self,
        uv: [V::Number; 2],
        order: usize,
        jet: impl Fn(&SurfaceRef, usize) -> Vec<V>,
        out: &mut [V],
    ) {
        out.fill(V::ZERO);
        out[0] = V::ZERO.minus(-self.constant);
        for t in &self.terms {
            let [a, b] = t.order;
            let mut d = jet(&t.of, order + a + b);
            if a + b == 0 {
                d[0] = d[0].minus(t.less);
            }
            let d: Vec<V> = orders(order)
                .map(|[i, j]| d[jet_index(i + a, j + b)].image(&t.map))
                .collect();
            let zero = V::Number::ZERO;
            let f: SmallVec<[V::Number; 10]> = match &t.factor {
                Factor::Linear { constant, along } => {
                    let [su, sv] = along.map(V::Number::from);
                    let at = V::Number::from(*constant) + su * uv[0] + sv * uv[1];
                    [at, su, sv].into_iter().take(jet_len(order)).collect()
                }
                Factor::Coordinate { of, axis } => {
                    let jet = jet(of, order).into_iter();
                    jet.map(|v| v.coordinate(*axis)).collect()
                }
            };
            // Leibniz: ∂ⁱʲ(f d) = Σ C(i,p) C(j,q) ∂ᵖ𐞥f ∂ⁱ⁻ᵖ ʲ⁻𐞥d.
            for [p, q] in orders(order) {
                let Some(&f) = f.get(jet_index(p, q)).filter(|f| **f != zero) else {
                    continue;
                };
                for [i, j] in orders(order).filter(|[i, j]| p <= *i && q <= *j) {
                    let c = V::Number::from(binomial(i, p) * binomial(j, q));
                    let at = &mut out[jet_index(i, j)];
                    *at = at.plus(d[jet_index(i - p, j - q)].times(c * f));
                }
            }
        }
    }
}

impl Surface for Sum {
    fn breaks(&self, dir: Dir) -> &[Break] {
        &self.breaks[usize::from(dir == Dir::V)]
    }

    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        let jet = |of: &SurfaceRef, order: usize| of.jet(uv, limit, order).d.to_vec();
        self.sum(uv, order, jet, out);
    }

    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]) {
        let jet = |of: &SurfaceRef, order: usize| {
            let mut d = vec![Box3::ENTIRE; jet_len(order)];
            of.enclose_piece(uv, limit, order, &mut d);
            d
        };
        self.sum(uv, order, jet, out);
    }
}
