//! Lists of points of separable surfaces: the sides as powers about the middle of their piece, then few products a
//! point.

use super::effect::effects;
use super::spans::Spans;
use super::{Core, Separable, jet_index, jet_len};
use crate::basis::{Powers, Table};
use crate::interval::Interval;
use crate::simd::{QuadKernel, Quads, with_quads};
use glam::{DVec3, DVec4};

/// A control net above this size (in points, of 32 bytes each) does not stay in the caches near a core: long lists are
/// evaluated in the order of the net.
const LARGE_NET: usize = 1 << 15;
/// Lists of a large net are sorted in parts of this length, whose results stay in the last-level cache.
const SORTED: usize = 1 << 18;
/// Pieces in one direction of a tile: the net's part that points of one tile use fits the first-level cache.
const TILE: usize = 16;

/// A surface prepared for lists.
#[derive(Debug)]
pub(super) struct Prepared {
    tables: [Table; 2],
    spans: Option<Spans>,
}

impl Prepared {
    pub(super) fn new(surface: &Separable) -> Self {
        let effects = effects(surface);
        let [u, v] = effects.of;
        let tables = [
            Table::new(surface.functions_u(), &u),
            Table::new(surface.functions_v(), &v),
        ];
        let spans = Spans::new(&tables, effects.size);
        Self { tables, spans }
    }

    #[cfg(test)]
    pub(super) fn parts(&self) -> (&[Table; 2], Option<&Spans>) {
        (&self.tables, self.spans.as_ref())
    }
}

/// Writes the derivatives up to `order` (at most 2) of every point of a list, point by point.
pub(super) fn jets(
    surface: &Separable,
    prepared: &Prepared,
    uv: &[[f64; 2]],
    order: usize,
    out: &mut [DVec3],
) {
    let tables = &prepared.tables;
    if let Some(spans) = &prepared.spans {
        return spans.jets(surface, tables, uv, order, out);
    }
    let each = jet_len(order);
    if let (Core::Net(net), Some(sides)) = (surface.core(), splines(tables))
        && net.len() > LARGE_NET
    {
        let mut sorted = Sorted::default();
        for (uv, out) in uv.chunks(SORTED).zip(out.chunks_mut(SORTED * each)) {
            sorted.by_tile(sides, uv);
            let at = |k: usize| sorted.index[k] as usize;
            choose(surface, tables, order, &sorted.uv, at, out);
        }
    } else {
        choose(surface, tables, order, uv, |k| k, out);
    }
}

/// Both sides, if they are splines (or other polynomials over all parameters).
fn splines(tables: &[Table; 2]) -> Option<[&Powers; 2]> {
    let [(u, of_u), (v, of_v)] = [tables[0].powers()?, tables[1].powers()?];
    (of_u == Interval::ENTIRE && of_v == Interval::ENTIRE).then_some([u, v])
}

/// Points in the order of the tiles of the net that they lie in.
#[derive(Default)]
struct Sorted {
    /// Where each stands in the list.
    index: Vec<u32>,
    uv: Vec<[f64; 2]>,
    tiles: Vec<u32>,
}

impl Sorted {
    /// Sorts a list.
    fn by_tile(&mut self, [u, v]: [&Powers; 2], uv: &[[f64; 2]]) {
        let columns = v.pieces().div_ceil(TILE);
        let mut next = vec![0u32; u.pieces().div_ceil(TILE) * columns + 1];
        let tile = |&[a, b]: &[f64; 2]| u.locate(a).0 / TILE * columns + v.locate(b).0 / TILE;
        self.tiles.clear();
        self.tiles.extend(uv.iter().map(|uv| tile(uv) as u32));
        for &k in &self.tiles {
            next[k as usize + 1] += 1;
        }
        for k in 1..next.len() {
            next[k] += next[k - 1];
        }
        self.index.resize(uv.len(), 0);
        self.uv.resize(uv.len(), [0.0; 2]);
        for (i, (&uv, &k)) in uv.iter().zip(&self.tiles).enumerate() {
            let at = &mut next[k as usize];
            self.index[*at as usize] = i as u32;
            // Parameters move along: picked out one by one they would come from everywhere.
            self.uv[*at as usize] = uv;
            *at += 1;
        }
    }
}

/// Takes the kernel that fits: nets of equal low degree have their own.
fn choose(
    surface: &Separable,
    tables: &[Table; 2],
    order: usize,
    uv: &[[f64; 2]],
    index: impl Fn(usize) -> usize,
    out: &mut [DVec3],
) {
    let task = Task {
        surface,
        tables,
        uv,
        index,
        out,
    };
    match order {
        0 => task.choose::<1, 1>(),
        1 => task.choose::<2, 3>(),
        _ => task.choose::<3, 6>(),
    }
}

/// A list to evaluate: the k-th point is written to place `index(k)`.
struct Task<'a, I> {
    surface: &'a Separable,
    tables: &'a [Table; 2],
    uv: &'a [[f64; 2]],
    index: I,
    out: &'a mut [DVec3],
}

impl<'a, I: Fn(usize) -> usize> Task<'a, I> {
    fn choose<const ROWS: usize, const JET: usize>(self) {
        if let (Core::Net(net), Some(sides)) = (self.surface.core(), splines(self.tables))
            && let [u, v] = sides
            && [u.degree + 1, u.width, v.degree + 1] == [v.width; 3]
        {
            match v.width {
                2 => {
                    return with_quads(Net::<_, 2, ROWS, JET> {
                        task: self,
                        net,
                        sides,
                    });
                }
                3 => {
                    return with_quads(Net::<_, 3, ROWS, JET> {
                        task: self,
                        net,
                        sides,
                    });
                }
                4 => {
                    return with_quads(Net::<_, 4, ROWS, JET> {
                        task: self,
                        net,
                        sides,
                    });
                }
                _ => {}
            }
        }
        with_quads(Any::<_, ROWS, JET>(self));
    }
}

/// Any sides and any core; `ROWS - 1` is the order of derivatives.
struct Any<'a, I, const ROWS: usize, const JET: usize>(Task<'a, I>);

impl<I: Fn(usize) -> usize, const ROWS: usize, const JET: usize> QuadKernel
    for Any<'_, I, ROWS, JET>
{
    #[inline(always)]
    fn run<Q: Quads>(self, q: Q) {
        let Task {
            surface,
            tables,
            uv,
            index,
            out,
        } = self.0;
        let out = out.as_chunks_mut().0;
        let (nu, nv) = (surface.functions_u().count(), surface.functions_v().count());
        let mut a = vec![0.0; ROWS * nu];
        let mut b = vec![0.0; ROWS * nv];
        for k in 0..uv.len() {
            let [u, v] = uv[k];
            let (first_u, wide_u) = tables[0].eval::<Q, ROWS>(q, u, &mut a);
            let (first_v, wide_v) = tables[1].eval::<Q, ROWS>(q, v, &mut b);
            let factors = Factors {
                a: &a,
                b: &b,
                wide: [wide_u, wide_v],
            };
            let mut h = [q.splat(0.0); JET];
            match surface.core() {
                Core::Net(net) => {
                    for i in 0..wide_u {
                        let row = &net[(first_u + i) * nv + first_v..][..wide_v];
                        for (j, c) in row.iter().enumerate() {
                            factors.add::<Q, ROWS, JET>(q, i, j, c, &mut h);
                        }
                    }
                }
                Core::Terms(terms) => {
                    let whole = [first_u..first_u + wide_u, first_v..first_v + wide_v];
                    for t in terms {
                        if whole[0].contains(&t.i) && whole[1].contains(&t.j) {
                            let (i, j) = (t.i - first_u, t.j - first_v);
                            factors.add::<Q, ROWS, JET>(q, i, j, &t.c, &mut h);
                        }
                    }
                }
            }
            put(q, surface, &h, &mut out[index(k)]);
        }
    }
}

/// The active functions at a point.
struct Factors<'a> {
    a: &'a [f64],
    b: &'a [f64],
    wide: [usize; 2],
}

impl Factors<'_> {
    /// Adds a term to all derivatives.
    #[inline(always)]
    fn add<Q: Quads, const ROWS: usize, const JET: usize>(
        &self,
        quads: Q,
        i: usize,
        j: usize,
        c: &DVec4,
        h: &mut [Q::Quad; JET],
    ) {
        let c = quads.load(c.to_array());
        for p in 0..ROWS {
            for q in 0..ROWS - p {
                let f = self.a[p * self.wide[0] + i] * self.b[q * self.wide[1] + j];
                let h = &mut h[jet_index(p, q)];
                *h = quads.add_product(*h, quads.splat(f), c);
            }
        }
    }
}

/// Divides if need be and writes one point of a list.
#[inline(always)]
pub(super) fn put<Q: Quads, const JET: usize>(
    quads: Q,
    surface: &Separable,
    h: &[Q::Quad; JET],
    out: &mut [DVec3; JET],
) {
    let r = if surface.is_rational() {
        quotient(quads, h)
    } else {
        *h
    };
    let [x, y, z] = surface.origin().to_array();
    let origin = quads.load([x, y, z, 0.0]);
    for k in 0..JET {
        let r = if k == 0 {
            quads.add(r[0], origin)
        } else {
            r[k]
        };
        let [x, y, z, _] = quads.store(r);
        out[k] = DVec3::new(x, y, z);
    }
}

/// The derivatives of `R.xyz / R.w` from those of R, for jets of order 0, 1 and 2, one register a vector: a division
/// for all.
#[inline(always)]
fn quotient<Q: Quads, const JET: usize>(quads: Q, h: &[Q::Quad; JET]) -> [Q::Quad; JET] {
    let w = h.map(|h| quads.store(h)[3]);
    let inverse = quads.splat(1.0 / w[0]);
    let minus = |h, r, w| quads.sub(h, quads.mul(r, quads.splat(w)));
    let over = |h| quads.mul(h, inverse);
    let mut r = *h;
    r[0] = over(h[0]);
    if JET >= 3 {
        r[1] = over(minus(h[1], r[0], w[1]));
        r[2] = over(minus(h[2], r[0], w[2]));
    }
    if JET >= 6 {
        let [wu, wv] = [w[1], w[2]];
        r[3] = over(minus(minus(h[3], r[0], w[3]), r[1], wu + wu));
        r[4] = over(minus(minus(minus(h[4], r[0], w[4]), r[2], wu), r[1], wv));
        r[5] = over(minus(minus(h[5], r[0], w[5]), r[2], wv + wv));
    }
    r
}

/// A net with spline sides of `N` active functions of degree `N - 1`; `ROWS - 1` is the order of derivatives.
struct Net<'a, I, const N: usize, const ROWS: usize, const JET: usize> {
    task: Task<'a, I>,
    net: &'a [DVec4],
    sides: [&'a Powers; 2],
}

impl<I: Fn(usize) -> usize, const N: usize, const ROWS: usize, const JET: usize> QuadKernel
    for Net<'_, I, N, ROWS, JET>
{
    #[inline(always)]
    fn run<Q: Quads>(self, quads: Q) {
        let ([u, v], task) = (self.sides, self.task);
        let out = task.out.as_chunks_mut().0;
        let columns = task.surface.functions_v().count();
        for k in 0..task.uv.len() {
            let [x, y] = task.uv[k];
            let (pu, s) = u.locate(x);
            let (pv, t) = v.locate(y);
            let a = u.four::<Q, N, ROWS>(quads, pu, s);
            let b = v.four::<Q, N, ROWS>(quads, pv, t);
            let start = u.first(pu) * columns + v.first(pv);
            let net = &self.net[start..][..(N - 1) * columns + N];
            let mut h = [quads.splat(0.0); JET];
            for j in 0..N {
                let mut column = [quads.splat(0.0); ROWS];
                for i in 0..N {
                    let c = quads.load(net[i * columns + j].to_array());
                    for p in 0..ROWS {
                        column[p] = quads.add_product(column[p], quads.splat(a[p][i]), c);
                    }
                }
                for p in 0..ROWS {
                    for q in 0..ROWS - p {
                        let h = &mut h[jet_index(p, q)];
                        *h = quads.add_product(*h, quads.splat(b[q][j]), column[p]);
                    }
                }
            }
            put(quads, task.surface, &h, &mut out[(task.index)(k)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::BSplineBasis;
    use crate::exact::NurbsSurface;
    use crate::laws::Random;
    use crate::simd::Plain;
    use crate::surface::Surface;

    fn example(points: usize) -> NurbsSurface {
        let mut random = Random(3);
        let net: Vec<DVec3> = (0..points * points)
            .map(|i| DVec3::new((i / points) as f64, (i % points) as f64, random.unit()))
            .collect();
        let knots = BSplineBasis::clamped_uniform(3, points);
        NurbsSurface::new([3, 3], [knots.clone(), knots], &net, None).unwrap()
    }

    #[test]
    fn the_widest_and_the_plain_path_give_the_same_bits() {
        let surface = example(9);
        let s = surface.separable();
        let prepared = s.prepared();
        let tables = &prepared.tables;
        let mut random = Random(8);
        let uv: Vec<[f64; 2]> = (0..99).map(|_| [random.unit(), random.unit()]).collect();
        let Core::Net(net) = s.core() else {
            panic!("a spline has a net")
        };
        let sides = splines(tables).expect("cubics are taken by powers");
        let mut out = [(); 4].map(|()| vec![DVec3::ZERO; 6 * uv.len()]);
        let [wide, plain, any, any_plain] = &mut out;
        fn task<'a>(
            surface: &'a Separable,
            tables: &'a [Table; 2],
            uv: &'a [[f64; 2]],
            out: &'a mut [DVec3],
        ) -> Task<'a, impl Fn(usize) -> usize> {
            Task {
                surface,
                tables,
                uv,
                index: |k| k,
                out,
            }
        }
        choose(s, tables, 2, &uv, |k| k, wide);
        let net = Net::<_, 4, 3, 6> {
            task: task(s, tables, &uv, plain),
            net,
            sides,
        };
        net.run(Plain);
        with_quads(Any::<_, 3, 6>(task(s, tables, &uv, any)));
        Any::<_, 3, 6>(task(s, tables, &uv, any_plain)).run(Plain);
        assert_eq!(out[0], out[1]);
        assert_eq!(out[2], out[3]);
        // The kernel for any sides takes the same sums in another order.
        for (a, b) in out[1].iter().zip(&out[2]) {
            assert!((*a - *b).length() <= 1e-13 * (a.length() + 81.0 * 36.0));
        }
    }

    #[test]
    fn lists_of_large_nets_keep_their_order() {
        let surface = example(200);
        assert!(surface.homogeneous().len() > LARGE_NET);
        let mut random = Random(8);
        let uv: Vec<[f64; 2]> = (0..2000).map(|_| [random.unit(), random.unit()]).collect();
        let mut out = vec![DVec3::ZERO; uv.len()];
        surface.points(&uv, &mut out);
        for (&uv, p) in uv.iter().zip(out) {
            assert!((surface.point(uv) - p).length() <= 4.0 * f64::EPSILON * 200.0 * 1.5);
        }
    }
}
