//! Pieces of separable surfaces as polynomials of two variables, for lists.
//!
//! Where both sides are polynomials, `R = Σ_kl P_kl sᵏ tˡ` with s and t from -1 to 1 over a piece of u and one of v: a point
//! needs no functions of one variable, only Horner's scheme along u for each power of t, and once along v. A span is
//! prepared when the first point falls in it, and kept.

use super::list::put;
use super::{Core, Separable, Surface, jet_index};
use crate::basis::{Powers, Table};
use crate::breaks::Limit;
use crate::interval::Interval;
use crate::simd::{QuadKernel, Quads, with_quads};
use glam::{DVec3, DVec4, Vec4Swizzles};
use std::sync::OnceLock;

/// The most memory for the spans of a surface, in bytes: they stay in the last-level cache.
const LARGEST: usize = 8 << 20;

/// How far the roundings of Horner's scheme may move a point if all add up, in units in the last place of the size. They
/// do not add up: random nets of all degrees show less than half of this.
const ROUNDING: f64 = 8.0;

/// A homogeneous vector where registers load it at once.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
struct Quad([f64; 4]);

/// The spans of a surface.
#[derive(Debug)]
pub(super) struct Spans {
    /// For each piece of u and each of v, v fastest, the coefficients of `sᵏ tˡ`, k fastest; none if they would lose too
    /// many digits.
    spans: Vec<OnceLock<Box<[Quad]>>>,
    /// The surface's size.
    size: f64,
}

/// The sides as polynomials, with the domains where they are good.
type Sides<'a> = [(&'a Powers, Interval); 2];

fn sides(tables: &[Table; 2]) -> Option<Sides<'_>> {
    Some([tables[0].powers()?, tables[1].powers()?])
}

impl Spans {
    /// `None` if the sides are no polynomials, or if all spans would need too much memory.
    pub(super) fn new(tables: &[Table; 2], size: f64) -> Option<Self> {
        let [(u, _), (v, _)] = sides(tables)?;
        let count = u.pieces() * v.pieces();
        let bytes = size_of::<Quad>() * (u.degree + 1) * (v.degree + 1);
        (count.saturating_mul(bytes) <= LARGEST).then(|| Self {
            spans: (0..count).map(|_| OnceLock::new()).collect(),
            size,
        })
    }

    /// Writes the derivatives up to `order` (at most 2) of the points of a list. In spans that would lose too many digits,
    /// and beyond the domain of a side, they are those of single points.
    pub(super) fn jets(
        &self,
        surface: &Separable,
        tables: &[Table; 2],
        uv: &[[f64; 2]],
        order: usize,
        out: &mut [DVec3],
    ) {
        if let Some(sides) = sides(tables) {
            let list = List {
                spans: self,
                surface,
                sides,
                uv,
                out,
            };
            match order {
                0 => list.choose::<1, 1>(),
                1 => list.choose::<2, 3>(),
                _ => list.choose::<3, 6>(),
            }
        }
    }

    /// The span over two pieces.
    #[inline(always)]
    fn at(&self, surface: &Separable, sides: &Sides, [u, v]: [usize; 2]) -> &[Quad] {
        match self.spans[u * sides[1].0.pieces() + v].get() {
            Some(span) => span,
            None => self.prepare(surface, sides, [u, v]),
        }
    }

    #[cold]
    #[inline(never)]
    fn prepare(&self, surface: &Separable, sides: &Sides, [u, v]: [usize; 2]) -> &[Quad] {
        self.spans[u * sides[1].0.pieces() + v].get_or_init(|| {
            let p = coefficients(surface, sides.map(|s| s.0), [u, v]);
            let wide = sides[0].0.degree + 1;
            let near = self.rounding(&p, wide, surface.is_rational()) <= ROUNDING;
            let p = if near { &p[..] } else { &[] };
            p.iter().map(|p| Quad(p.to_array())).collect()
        })
    }

    /// How far the roundings of Horner's scheme can move a point of a span, in units in the last place of the size:
    /// a coefficient of `sᵏ tˡ` goes through k + l products and k + l + 2 sums, each with half a unit. Those of w move the
    /// point by as much of its distance from the origin; the two are taken as square to each other.
    fn rounding(&self, p: &[DVec4], wide: usize, rational: bool) -> f64 {
        let (mut sum, mut least) = (0.0, 1.0);
        if rational {
            // At the least w is the constant term less the others, but for even powers that only add.
            let less = |(at, p): (usize, &DVec4)| {
                let even = (at % wide).is_multiple_of(2) && (at / wide).is_multiple_of(2);
                if even { p.w.min(0.0) } else { -p.w.abs() }
            };
            least = p[0].w + p.iter().enumerate().skip(1).map(less).sum::<f64>();
        }
        for (at, p) in p.iter().enumerate() {
            let w = if rational { p.w } else { 0.0 };
            let moved = (p.xyz() / self.size).extend(w).length();
            sum += (at % wide + at / wide + 1) as f64 * moved;
        }
        // What is no number is not near.
        if least > 0.0 {
            sum / least
        } else {
            f64::INFINITY
        }
    }
}

/// The coefficients of a surface over two pieces.
fn coefficients(surface: &Separable, [u, v]: [&Powers; 2], pieces: [usize; 2]) -> Vec<DVec4> {
    let [pu, pv] = pieces;
    let (nu, nv) = (u.degree + 1, v.degree + 1);
    let (iu, jv) = (
        u.first(pu)..u.first(pu) + u.width,
        v.first(pv)..v.first(pv) + v.width,
    );
    // Σ_i A_ki C_ij
    let mut columns = vec![DVec4::ZERO; nu * v.width];
    let mut add = |i: usize, j: usize, c: DVec4| {
        for (k, column) in columns[j * nu..][..nu].iter_mut().enumerate() {
            *column += c * u.coefficient(pu, i, k);
        }
    };
    match surface.core() {
        Core::Net(net) => {
            let count = surface.functions_v().count();
            for i in iu.clone() {
                for j in jv.clone() {
                    add(i - iu.start, j - jv.start, net[i * count + j]);
                }
            }
        }
        Core::Terms(terms) => {
            for t in terms {
                if iu.contains(&t.i) && jv.contains(&t.j) {
                    add(t.i - iu.start, t.j - jv.start, t.c);
                }
            }
        }
    }
    let mut p = vec![DVec4::ZERO; nu * nv];
    for (j, column) in columns.chunks_exact(nu).enumerate() {
        for (l, p) in p.chunks_exact_mut(nu).enumerate() {
            let b = v.coefficient(pv, j, l);
            for (p, &c) in p.iter_mut().zip(column) {
                *p += c * b;
            }
        }
    }
    p
}

/// A list to evaluate.
struct List<'a> {
    spans: &'a Spans,
    surface: &'a Separable,
    sides: Sides<'a>,
    uv: &'a [[f64; 2]],
    out: &'a mut [DVec3],
}

impl List<'_> {
    fn choose<const ROWS: usize, const JET: usize>(self) {
        match self.sides.map(|s| s.0.degree) {
            [1, 1] => with_quads(Horner::<2, ROWS, JET>(self)),
            [2, 2] => with_quads(Horner::<3, ROWS, JET>(self)),
            [3, 3] => with_quads(Horner::<4, ROWS, JET>(self)),
            _ => with_quads(Horner::<0, ROWS, JET>(self)),
        }
    }
}

/// Points that are found before they are evaluated: so the processor does not wait for each place.
const BLOCK: usize = 64;

/// Where a point is.
#[derive(Clone, Copy, Default)]
struct Place<'a> {
    span: &'a [Quad],
    /// s and t.
    local: [f64; 2],
    /// `ds/du` and `dt/dv`.
    scale: [f64; 2],
}

/// Spans of `N` coefficients in each direction, or of any number if `N` is 0; `ROWS - 1` is the order of derivatives.
struct Horner<'a, const N: usize, const ROWS: usize, const JET: usize>(List<'a>);

impl<const N: usize, const ROWS: usize, const JET: usize> QuadKernel for Horner<'_, N, ROWS, JET> {
    #[inline(always)]
    fn run<Q: Quads>(self, quads: Q) {
        let List {
            spans,
            surface,
            sides,
            uv,
            out,
        } = self.0;
        let [(u, of_u), (v, of_v)] = sides;
        let [nu, nv] = if N == 0 {
            [u.degree + 1, v.degree + 1]
        } else {
            [N; 2]
        };
        let mut places = [Place::default(); BLOCK];
        let blocks = uv.chunks(BLOCK).zip(out.chunks_mut(BLOCK * JET));
        for (uv, out) in blocks {
            for (&[x, y], place) in uv.iter().zip(&mut places) {
                let ((pu, s), (pv, t)) = (u.locate(x), v.locate(y));
                let span = spans.at(surface, &sides, [pu, pv]);
                *place = Place {
                    span: if of_u.contains(x) & of_v.contains(y) {
                        span
                    } else {
                        &[]
                    },
                    local: [s, t],
                    scale: [u.scale(pu), v.scale(pv)],
                };
            }
            let out = out.as_chunks_mut::<JET>().0;
            for (&uv, (place, out)) in uv.iter().zip(places.iter().zip(out)) {
                let Some(span) = place.span.get(..nu * nv) else {
                    alone(surface, uv, ROWS - 1, out);
                    continue;
                };
                let [s, t] = place.local;
                let mut h = [quads.splat(0.0); JET];
                let [qs, qt] = [s, t].map(|x| quads.splat(x));
                for l in (0..nv).rev() {
                    let mut k = [quads.splat(0.0); ROWS];
                    for (done, c) in span[l * nu..][..nu].iter().rev().enumerate() {
                        step(quads, &mut k, quads.load(c.0), qs, done);
                    }
                    let done = nv - 1 - l;
                    for p in 0..ROWS {
                        let mut row = [quads.splat(0.0); ROWS];
                        for q in 0..ROWS - p {
                            row[q] = h[jet_index(p, q)];
                        }
                        step(quads, &mut row[..ROWS - p], k[p], qt, done);
                        for q in 0..ROWS - p {
                            h[jet_index(p, q)] = row[q];
                        }
                    }
                }
                let scale = place.scale;
                let factors = [
                    1.0,
                    scale[0],
                    scale[1],
                    2.0 * scale[0] * scale[0],
                    scale[0] * scale[1],
                    2.0 * scale[1] * scale[1],
                ];
                for k in 1..JET {
                    h[k] = quads.mul(h[k], quads.splat(factors[k]));
                }
                put(quads, surface, &h, out);
            }
        }
    }
}

/// A point by itself: the same code for all instruction sets.
#[cold]
#[inline(never)]
fn alone(surface: &Separable, uv: [f64; 2], order: usize, out: &mut [DVec3]) {
    surface.jet_into(uv, [Limit::Above; 2], order, out);
}

/// A step of Horner's scheme: the value, the first derivative, half the second; `done` steps were done before.
#[inline(always)]
fn step<Q: Quads>(quads: Q, d: &mut [Q::Quad], c: Q::Quad, s: Q::Quad, done: usize) {
    for k in (1..d.len()).rev() {
        if k < done {
            d[k] = quads.add_product(d[k - 1], d[k], s);
        } else if k == done {
            d[k] = d[k - 1];
        }
    }
    d[0] = if done == 0 {
        c
    } else {
        quads.add_product(c, d[0], s)
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{BSplineBasis, FunctionsRef, Trigonometric};
    use crate::exact::NurbsSurface;
    use crate::laws::Random;
    use crate::simd::Plain;
    use crate::surface::jet_len;
    use glam::{DAffine3, DMat3};
    use std::sync::Arc;

    /// A square, mixed with a share of random points, and weights that vary by a share.
    fn example(degree: usize, points: usize, [random, weights]: [f64; 2], seed: u64) -> Separable {
        let mut numbers = Random(seed);
        let mut number = || 2.0 * numbers.unit() - 1.0;
        let mut point = |k: usize| {
            let square = DVec3::new((k / points) as f64, (k % points) as f64, 0.0) / points as f64;
            square.lerp(DVec3::new(number(), number(), number()), random)
        };
        let net: Vec<DVec3> = (0..points * points).map(&mut point).collect();
        let weight = |_: &DVec3| 1.0 - weights * 0.5 * (1.0 + number());
        let weights: Vec<f64> = net.iter().map(weight).collect();
        let knots = BSplineBasis::clamped_uniform(degree, points);
        let weights = weights.iter().any(|w| *w != 1.0).then_some(&weights[..]);
        let s = NurbsSurface::new([degree; 2], [knots.clone(), knots], &net, weights).unwrap();
        s.separable().clone()
    }

    fn scattered(s: &Separable, n: usize) -> Vec<[f64; 2]> {
        let (domain, mut random) = (s.domain(), Random(6));
        (0..n).map(|_| domain.map(|d| random.within(d))).collect()
    }

    /// The greatest distance between points of a list and single points over the size, in units in the last place.
    fn off(s: &Separable, uv: &[[f64; 2]]) -> f64 {
        let mut list = vec![DVec3::ZERO; uv.len()];
        s.points(uv, &mut list);
        let single: Vec<DVec3> = uv.iter().map(|&uv| s.point(uv)).collect();
        let size = single.iter().fold(0.0, |m: f64, p| m.max(p.length()));
        let off = single.iter().zip(&list).map(|(a, b)| (*a - *b).length());
        off.fold(0.0, f64::max) / size / f64::EPSILON
    }

    #[test]
    fn all_kernels_and_all_lists_give_the_same_bits() {
        for s in [example(3, 7, [0.1, 0.0], 1), example(3, 7, [0.1, 0.2], 2)] {
            let uv = scattered(&s, 3 * BLOCK + 5);
            let (tables, spans) = s.prepared().parts();
            let (spans, sides) = (spans.unwrap(), sides(tables).unwrap());
            let mut out = [(); 4].map(|()| vec![DVec3::ZERO; 6 * uv.len()]);
            let [list, plain, any, alone] = &mut out;
            s.jets(&uv, 2, list);
            fn all<'a>(
                (spans, surface, sides): (&'a Spans, &'a Separable, Sides<'a>),
                uv: &'a [[f64; 2]],
                out: &'a mut [DVec3],
            ) -> List<'a> {
                List {
                    spans,
                    surface,
                    sides,
                    uv,
                    out,
                }
            }
            Horner::<4, 3, 6>(all((spans, &s, sides), &uv, plain)).run(Plain);
            Horner::<0, 3, 6>(all((spans, &s, sides), &uv, any)).run(Plain);
            for (&uv, out) in uv.iter().zip(alone.chunks_exact_mut(6)) {
                s.jets(&[uv], 2, out);
            }
            assert!(out.iter().all(|o| *o == out[0]));
        }
    }

    #[test]
    fn lists_are_near_and_spans_that_lose_digits_are_not_taken() {
        let mut refused = [0; 6];
        for degree in 1..=5 {
            for seed in 0..60 {
                let points = degree + 1 + seed as usize % 4;
                let shape = [[1.0, 0.0], [0.3, 0.3]][seed as usize % 2];
                let s = example(degree, points, shape, seed);
                let uv = scattered(&s, 200);
                let off = off(&s, &uv);
                assert!(off <= 4.0, "degree {degree}, seed {seed}: {off}");
                let spans = &s.prepared().parts().1.unwrap().spans;
                let all = spans.iter().filter_map(OnceLock::get);
                refused[degree] += all.filter(|s| s.is_empty()).count();
            }
        }
        assert!(refused[1] == 0 && refused[5] > 50, "{refused:?}");
    }

    #[test]
    fn a_moved_surface_has_spans_of_its_own() {
        let s = example(2, 4, [0.1, 0.2], 5);
        let uv = scattered(&s, 20);
        assert!(off(&s, &uv) <= 4.0);
        let map = DAffine3::from_mat3_translation(
            DMat3::from_diagonal(DVec3::new(2.0, 3.0, 0.5)),
            DVec3::ONE,
        );
        assert!(off(&s.transformed(&map), &uv) <= 4.0);
    }

    #[test]
    fn beyond_the_domain_of_taylor_polynomials_functions_are_evaluated_as_they_are() {
        let u: FunctionsRef = Arc::new(Trigonometric::new(1.0).unwrap());
        let v: FunctionsRef = Arc::new(BSplineBasis::bernstein(1));
        let mut random = Random(3);
        let net = (0..2 * u.count()).map(|_| DVec3::splat(random.unit()).extend(0.0));
        let s = Separable::polynomial(u, v, Core::Net(net.collect()), DVec3::ZERO);
        for uv in [[-0.25, 0.5], [1.25, 0.5], [1.0f64.next_up(), 0.5]] {
            let mut out = [DVec3::ZERO];
            s.points(&[uv], &mut out);
            assert_eq!(out[0], s.point(uv));
        }
        // Polynomials go on beyond their domain.
        assert!(off(&s, &[[0.5, -0.25], [0.5, 1.25], [1.0, 1.0]]) <= 4.0);
        let mut nothing = vec![DVec3::ZERO; jet_len(1)];
        s.jets(&[[f64::NAN, 0.5]], 1, &mut nothing);
        assert!(nothing[0].is_nan());
    }
}
