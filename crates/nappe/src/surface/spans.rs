//! Pieces of separable surfaces as polynomials of two variables, for lists.
//!
//! Where both sides are polynomials, `R = Σ_kl P_kl sᵏ tˡ` with s and t from -1 to 1 over a piece of u and one of v: a point
//! needs no functions of one variable, only Horner's scheme along u for each power of t, and once along v. A span is
//! prepared when the first point falls in it, and kept.

use super::list::put;
use super::{Core, Separable, jet_index};
use crate::basis::{Powers, Table};
use crate::interval::Interval;
use crate::simd::{QuadKernel, Quads, with_quads};
use glam::{DVec3, DVec4, Vec4Swizzles};
use std::sync::OnceLock;

/// The most memory for the spans of a surface, in bytes: they stay in the last-level cache.
const LARGEST: usize = 8 << 20;

/// How far the roundings of Horner's scheme may move a point if all add up, in units in the last place of the size. They
/// do not add up: what is found is less than a third.
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

    /// Writes the derivatives up to `order` (at most 2) of the points of a list, but for those in spans that would lose
    /// too many digits and those beyond the domain of a side: it returns their indices.
    pub(super) fn jets(
        &self,
        surface: &Separable,
        tables: &[Table; 2],
        uv: &[[f64; 2]],
        order: usize,
        out: &mut [DVec3],
    ) -> Vec<usize> {
        let mut rest = Vec::new();
        if let Some(sides) = sides(tables) {
            let list = List {
                spans: self,
                surface,
                sides,
                uv,
                out,
                rest: &mut rest,
            };
            match order {
                0 => list.choose::<1, 1>(),
                1 => list.choose::<2, 3>(),
                _ => list.choose::<3, 6>(),
            }
        }
        rest
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
    /// a coefficient of `sᵏ tˡ` goes through k + l products and k + l + 2 sums, each with half a unit.
    fn rounding(&self, p: &[DVec4], wide: usize, rational: bool) -> f64 {
        let (mut sum, mut least) = (0.0, if rational { 0.0 } else { 1.0 });
        for (at, p) in p.iter().enumerate() {
            let (k, l) = (at % wide, at / wide);
            let mut moved = p.xyz().length() / self.size;
            if rational {
                moved += p.w.abs();
                // At the least w is the constant term less the others, but for even powers that only add.
                let even = k % 2 == 0 && l % 2 == 0;
                least += if even {
                    p.w.min(if at == 0 { p.w } else { 0.0 })
                } else {
                    -p.w.abs()
                };
            }
            sum += (k + l + 1) as f64 * moved;
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
    rest: &'a mut Vec<usize>,
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
            rest,
        } = self.0;
        let [(u, of_u), (v, of_v)] = sides;
        let [nu, nv] = if N == 0 {
            [u.degree + 1, v.degree + 1]
        } else {
            [N; 2]
        };
        let mut places = [Place::default(); BLOCK];
        let blocks = uv.chunks(BLOCK).zip(out.chunks_mut(BLOCK * JET));
        for (block, (uv, out)) in blocks.enumerate() {
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
            for (at, (place, out)) in places.iter().zip(out).enumerate() {
                let Some(span) = place.span.get(..nu * nv) else {
                    rest.push(block * BLOCK + at);
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
