//! Lists of points of separable surfaces: the sides as powers about the middle of their piece, then few products a
//! point.

use super::quotient::quotient;
use super::{Core, Separable, jet_index, jet_len};
use crate::basis::{Powers, Table};
use crate::simd::{QuadKernel, Quads, with_quads};
use glam::{DVec3, DVec4};

/// A control net above this size (in points, of 32 bytes each) does not stay in the caches near a core: long lists are
/// evaluated in the order of the net.
const LARGE_NET: usize = 1 << 15;
/// Lists of a large net are sorted in parts of this length, whose results stay in the last-level cache.
const SORTED: usize = 1 << 18;
/// Pieces in one direction of a tile: the net's part that points of one tile use fits the first-level cache.
const TILE: usize = 16;

/// Writes the derivatives up to `order` (at most 2) of every point of a list, point by point.
pub(super) fn jets(
    surface: &Separable,
    tables: &[Table; 2],
    uv: &[[f64; 2]],
    order: usize,
    out: &mut [DVec3],
) {
    let each = jet_len(order);
    if let Core::Net(net) = surface.core()
        && net.len() > LARGE_NET
        && let [Some(u), Some(v)] = [0, 1].map(|k| tables[k].powers())
    {
        for (uv, out) in uv.chunks(SORTED).zip(out.chunks_mut(SORTED * each)) {
            let sorted = by_tile([u, v], uv);
            choose(
                surface,
                tables,
                order,
                uv,
                #[inline(always)]
                |k| sorted[k] as usize,
                out,
            );
        }
    } else {
        choose(
            surface,
            tables,
            order,
            uv,
            #[inline(always)]
            |k| k,
            out,
        );
    }
}

/// The indices of a list in the order of the tiles of the net that the points lie in.
fn by_tile([u, v]: [&Powers; 2], uv: &[[f64; 2]]) -> Vec<u32> {
    let columns = v.pieces().div_ceil(TILE);
    let tiles = u.pieces().div_ceil(TILE) * columns;
    let tile = |&[a, b]: &[f64; 2]| u.locate(a).0 / TILE * columns + v.locate(b).0 / TILE;
    let keys: Vec<u32> = uv.iter().map(|uv| tile(uv) as u32).collect();
    let mut next = vec![0u32; tiles + 1];
    for &k in &keys {
        next[k as usize + 1] += 1;
    }
    for k in 0..tiles {
        next[k + 1] += next[k];
    }
    let mut sorted = vec![0u32; uv.len()];
    for (i, &k) in keys.iter().enumerate() {
        sorted[next[k as usize] as usize] = i as u32;
        next[k as usize] += 1;
    }
    sorted
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

/// A list to evaluate: `index(k)` is the k-th point to take.
struct Task<'a, I> {
    surface: &'a Separable,
    tables: &'a [Table; 2],
    uv: &'a [[f64; 2]],
    index: I,
    out: &'a mut [DVec3],
}

impl<'a, I: Fn(usize) -> usize> Task<'a, I> {
    fn choose<const ROWS: usize, const JET: usize>(self) {
        let powers = [0, 1].map(|k| self.tables[k].powers());
        if let (Core::Net(net), [Some(u), Some(v)]) = (self.surface.core(), powers)
            && [u.degree + 1, u.width, v.degree + 1] == [v.width; 3]
        {
            let sides = [u, v];
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
        let (nu, nv) = (surface.functions_u().count(), surface.functions_v().count());
        let mut a = vec![0.0; ROWS * nu];
        let mut b = vec![0.0; ROWS * nv];
        for k in 0..uv.len() {
            let at = index(k);
            let [u, v] = uv[at];
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
            put(q, surface, &h, out, at);
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
fn put<Q: Quads, const JET: usize>(
    q: Q,
    surface: &Separable,
    h: &[Q::Quad; JET],
    out: &mut [DVec3],
    at: usize,
) {
    let Some(out) = out.as_chunks_mut::<JET>().0.get_mut(at) else {
        return;
    };
    let mut numbers = [[0.0; 4]; JET];
    for k in 0..JET {
        numbers[k] = q.store(h[k]);
    }
    if surface.is_rational() {
        let r = quotient(&numbers);
        for k in 0..JET {
            out[k] = DVec3::from_array(r[k]);
        }
    } else {
        for k in 0..JET {
            let [x, y, z, _] = numbers[k];
            out[k] = DVec3::new(x, y, z);
        }
    }
    out[0] += surface.origin();
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
        let columns = task.surface.functions_v().count();
        for k in 0..task.uv.len() {
            let at = (task.index)(k);
            let [x, y] = task.uv[at];
            let (pu, s) = u.locate(x);
            let (pv, t) = v.locate(y);
            let a = u.four::<Q, N, ROWS>(quads, pu, s);
            let b = v.four::<Q, N, ROWS>(quads, pv, t);
            let start = u.first[pu] * columns + v.first[pv];
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
            put(quads, task.surface, &h, task.out, at);
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
        let tables = s.tables();
        let mut random = Random(8);
        let uv: Vec<[f64; 2]> = (0..99).map(|_| [random.unit(), random.unit()]).collect();
        let Core::Net(net) = s.core() else {
            panic!("a spline has a net")
        };
        let [Some(u), Some(v)] = [0, 1].map(|k| tables[k].powers()) else {
            panic!("cubics are taken by powers")
        };
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
        jets(s, tables, &uv, 2, wide);
        let net = Net::<_, 4, 3, 6> {
            task: task(s, tables, &uv, plain),
            net,
            sides: [u, v],
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
