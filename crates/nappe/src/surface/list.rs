//! Lists of points of separable surfaces: the sides as powers about the middle of their piece, then few products a
//! point.

use super::quotient::quotient;
use super::{Core, Separable, jet_index, jet_len};
use crate::basis::{Powers, Table};
use crate::simd::widest;
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
                uv.len(),
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
            uv.len(),
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
    n: usize,
    index: impl Fn(usize) -> usize,
    out: &mut [DVec3],
) {
    let powers = [0, 1].map(|k| tables[k].powers());
    if let (Core::Net(net), [Some(u), Some(v)]) = (surface.core(), powers) {
        let size = |p: &Powers| (p.degree == p.width - 1).then_some(p.width);
        if size(u) == size(v) {
            let net = Net {
                surface,
                net,
                sides: [u, v],
            };
            macro_rules! kernel {
                ($n:literal) => {
                    match order {
                        0 => widest(
                            #[inline(always)]
                            || net.jets::<$n, 1, 1>(uv, n, index, out),
                        ),
                        1 => widest(
                            #[inline(always)]
                            || net.jets::<$n, 2, 3>(uv, n, index, out),
                        ),
                        _ => widest(
                            #[inline(always)]
                            || net.jets::<$n, 3, 6>(uv, n, index, out),
                        ),
                    }
                };
            }
            match size(u) {
                Some(2) => return kernel!(2),
                Some(3) => return kernel!(3),
                Some(4) => return kernel!(4),
                _ => {}
            }
        }
    }
    match order {
        0 => widest(
            #[inline(always)]
            || any::<1, 1>(surface, tables, uv, n, index, out),
        ),
        1 => widest(
            #[inline(always)]
            || any::<2, 3>(surface, tables, uv, n, index, out),
        ),
        _ => widest(
            #[inline(always)]
            || any::<3, 6>(surface, tables, uv, n, index, out),
        ),
    }
}

/// Any sides and any core.
#[inline(always)]
fn any<const ROWS: usize, const JET: usize>(
    surface: &Separable,
    tables: &[Table; 2],
    uv: &[[f64; 2]],
    n: usize,
    index: impl Fn(usize) -> usize,
    out: &mut [DVec3],
) {
    let (nu, nv) = (surface.functions_u().count(), surface.functions_v().count());
    let mut a = vec![0.0; ROWS * nu];
    let mut b = vec![0.0; ROWS * nv];
    for k in 0..n {
        let at = index(k);
        let [u, v] = uv[at];
        let (first_u, wide_u) = tables[0].eval::<ROWS>(u, &mut a);
        let (first_v, wide_v) = tables[1].eval::<ROWS>(v, &mut b);
        let mut h = [[0.0; 4]; JET];
        let factors = Factors {
            a: &a,
            b: &b,
            wide: [wide_u, wide_v],
        };
        match surface.core() {
            Core::Net(net) => {
                for i in 0..wide_u {
                    let row = &net[(first_u + i) * nv + first_v..][..wide_v];
                    for (j, c) in row.iter().enumerate() {
                        factors.add(i, j, c, &mut h);
                    }
                }
            }
            Core::Terms(terms) => {
                let (whole_u, whole_v) = (first_u..first_u + wide_u, first_v..first_v + wide_v);
                for t in terms {
                    if whole_u.contains(&t.i) && whole_v.contains(&t.j) {
                        factors.add(t.i - first_u, t.j - first_v, &t.c, &mut h);
                    }
                }
            }
        }
        put(surface, &h, out, at);
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
    fn add<const JET: usize>(&self, i: usize, j: usize, c: &DVec4, h: &mut [[f64; 4]; JET]) {
        let order = [0, 0, 1, 1, 1, 2, 2][JET];
        for p in 0..=order {
            for q in 0..=order - p {
                let f = self.a[p * self.wide[0] + i] * self.b[q * self.wide[1] + j];
                accumulate(&mut h[jet_index(p, q)], f, c);
            }
        }
    }
}

#[inline(always)]
fn accumulate(h: &mut [f64; 4], f: f64, c: &DVec4) {
    *h = [
        h[0] + f * c.x,
        h[1] + f * c.y,
        h[2] + f * c.z,
        h[3] + f * c.w,
    ];
}

/// Divides if need be and writes one point of a list.
#[inline(always)]
fn put<const JET: usize>(surface: &Separable, h: &[[f64; 4]; JET], out: &mut [DVec3], at: usize) {
    let Some(out) = out.as_chunks_mut::<JET>().0.get_mut(at) else {
        return;
    };
    if surface.is_rational() {
        let r = quotient(h);
        for k in 0..JET {
            out[k] = DVec3::from_array(r[k]);
        }
    } else {
        for k in 0..JET {
            out[k] = DVec3::new(h[k][0], h[k][1], h[k][2]);
        }
    }
    out[0] += surface.origin();
}

/// A net with spline sides.
struct Net<'a> {
    surface: &'a Separable,
    net: &'a [DVec4],
    sides: [&'a Powers; 2],
}

impl Net<'_> {
    /// `N` active functions of degree `N - 1` in both directions, `ROWS - 1` the order.
    #[inline(always)]
    fn jets<const N: usize, const ROWS: usize, const JET: usize>(
        &self,
        uv: &[[f64; 2]],
        n: usize,
        index: impl Fn(usize) -> usize,
        out: &mut [DVec3],
    ) {
        let [u, v] = self.sides;
        let columns = self.surface.functions_v().count();
        for k in 0..n {
            let at = index(k);
            let (pu, s) = u.locate(uv[at][0]);
            let (pv, t) = v.locate(uv[at][1]);
            let a: [[f64; N]; ROWS] = u.square(pu, s);
            let b: [[f64; N]; ROWS] = v.square(pv, t);
            let start = u.first[pu] * columns + v.first[pv];
            let net = &self.net[start..][..(N - 1) * columns + N];
            let mut h = [[0.0; 4]; JET];
            for j in 0..N {
                let mut column = [[0.0; 4]; ROWS];
                for i in 0..N {
                    let c = &net[i * columns + j];
                    for p in 0..ROWS {
                        accumulate(&mut column[p], a[p][i], c);
                    }
                }
                for p in 0..ROWS {
                    for q in 0..ROWS - p {
                        let h = &mut h[jet_index(p, q)];
                        for x in 0..4 {
                            h[x] += b[q][j] * column[p][x];
                        }
                    }
                }
            }
            put(self.surface, &h, out, at);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::BSplineBasis;
    use crate::exact::NurbsSurface;
    use crate::laws::Random;
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
        let tables = [s.functions_u(), s.functions_v()].map(Table::new);
        let mut random = Random(8);
        let uv: Vec<[f64; 2]> = (0..99).map(|_| [random.unit(), random.unit()]).collect();
        let mut out = [(); 3].map(|()| vec![DVec3::ZERO; 6 * uv.len()]);
        jets(s, &tables, &uv, 2, &mut out[0]);
        let Core::Net(net) = s.core() else {
            panic!("a spline has a net")
        };
        let [Some(u), Some(v)] = [0, 1].map(|k| tables[k].powers()) else {
            panic!("cubics are taken by powers")
        };
        let net = Net {
            surface: s,
            net,
            sides: [u, v],
        };
        net.jets::<4, 3, 6>(&uv, uv.len(), |k| k, &mut out[1]);
        assert_eq!(out[0], out[1]);
        // The kernel for any sides takes the same sums in another order.
        any::<3, 6>(s, &tables, &uv, uv.len(), |k| k, &mut out[2]);
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
