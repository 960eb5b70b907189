//! The laws every curve and surface obeys, as functions that panic with the place and the numbers when one is broken.
//! A new kind proves itself with one line in a test: `laws::curve(&my_curve)` or `laws::surface(&my_surface)`.
//!
//! Checked: jets are prefixes of longer jets; packs and grids equal single points to the last bit, and lists
//! within four units in the last place of the size; normals of grids are those of single points; derivatives agree with Richardson
//! differences of the next lower order inside each analytic piece; both sides of a break agree as far as the break's
//! smoothness says; enclosures contain samples and shrink at first order; a NURBS form, if any, is the same map.

use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit};
use crate::curve::Curve;
use crate::interval::Interval;
use crate::scalar::{Number, Pack};
use crate::surface::{Dir, Surface, jet_index, jet_len, normal_at};
use glam::DVec3;

/// Relative agreement of positions: exact formulas in double precision, with a margin for their length.
const POSITION: f64 = 1e-13;
/// Relative agreement of the positions of lists with single points: 4 units in the last place of the size.
const LIST: f64 = 4.0 * f64::EPSILON;
/// Relative agreement of a derivative with that of an exactly equal form.
const DERIVATIVE: f64 = 1e-11;
/// Relative agreement with a Richardson difference, whose own rounding error limits it.
const DIFFERENCE: f64 = 2e-6;
/// The order of derivatives tested.
const ORDER: usize = 3;

/// A small deterministic generator (splitmix64), so that laws need no dependency and repeat exactly.
#[derive(Clone, Debug)]
pub struct Random(pub u64);

impl Random {
    /// A number in `[0, 1)`.
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// A number in an interval.
    pub fn within(&mut self, i: Interval) -> f64 {
        (i.lo + (i.hi - i.lo) * self.unit()).clamp(i.lo, i.hi)
    }

    /// An interval inside another, of a width that varies over orders of magnitude.
    pub fn part(&mut self, i: Interval) -> Interval {
        let w = (i.hi - i.lo) * 10f64.powf(-4.0 * self.unit());
        let lo = i.lo + (i.hi - i.lo - w).max(0.0) * self.unit();
        Interval {
            lo,
            hi: (lo + w).min(i.hi),
        }
    }
}

/// Richardson's difference of f at t with step h: error of order h⁶.
fn richardson(f: impl Fn(f64) -> DVec3, t: f64, h: f64) -> DVec3 {
    let d = |h: f64| (f(t + h) - f(t - h)) / (2.0 * h);
    let (a, b, c) = (d(h), d(h / 2.0), d(h / 4.0));
    let (ab, bc) = ((b * 4.0 - a) / 3.0, (c * 4.0 - b) / 3.0);
    (bc * 16.0 - ab) / 15.0
}

/// Asserts that `p` is in `b`, up to the rounding of `p` itself.
fn assert_inside(b: Box3, p: DVec3, rounding: f64, what: &str) {
    assert!(
        b.inflate(rounding).contains(p),
        "{what}: {p} is not in {b:?} (rounding {rounding:e})"
    );
}

fn magnitude(b: &Box3) -> f64 {
    let m = b.x.mag().max(b.y.mag()).max(b.z.mag());
    if m.is_finite() { m } else { 0.0 }
}

/// Parts of a curve whose boxes together give the size: rational kinds cannot bound themselves at one go, since the
/// enclosure of a denominator over the whole domain may contain zero.
const PARTS: usize = 256;
/// Likewise along each direction of a surface, where they cost their square.
const PARTS_OF_SURFACE: usize = 16;

/// The k-th of `parts` parts of a domain.
fn part(domain: Interval, k: usize, parts: usize) -> Interval {
    let at = |k: usize| domain.lo + (domain.hi - domain.lo) * (k as f64 / parts as f64);
    Interval::new(at(k), if k + 1 == parts { domain.hi } else { at(k + 1) })
}

/// Checks every law on a curve with 10³ random intervals.
pub fn curve(c: &dyn Curve) {
    curve_with(c, 1000);
}

/// Checks every law on a curve with the given number of random intervals.
pub fn curve_with(c: &dyn Curve, boxes: usize) {
    let breaks = c.breaks();
    assert!(
        breaks.len() >= 2 && breaks.windows(2).all(|w| w[0].at < w[1].at),
        "breaks increase: {breaks:?}"
    );
    let domain = c.domain();
    let bounds = (0..PARTS)
        .map(|k| c.bounds(part(domain, k, PARTS)))
        .reduce(Box3::hull)
        .unwrap_or(Box3::ENTIRE);
    assert!(
        bounds.is_finite(),
        "the curve encloses itself: without that no tolerance below says anything"
    );
    let size = bounds.diagonal();
    let far = magnitude(&bounds).max(size);
    let mut random = Random(7);
    for i in 0..breaks.pieces() {
        let piece = breaks.piece(i);
        for _ in 0..12 {
            let t = random.within(piece);
            let jet = c.jet(t, Limit::Above, ORDER);
            let short = c.jet(t, Limit::Above, 1);
            assert!(
                (short.d[0] - jet.d[0]).length() <= POSITION * far,
                "order changes the point at {t}"
            );
            assert_eq!(
                c.point(t),
                c.jet(t, Limit::Above, 0).d[0],
                "point(t) is the jet's point"
            );
            let mut list = [DVec3::ZERO; 2];
            c.points(&[t, domain.lo], &mut list);
            assert_eq!(list[0], c.point(t), "a list gives the same points");
            let h = 0.02 * piece.width().min(1.0);
            let room = piece.lo + h < t && t + h < piece.hi;
            for k in 0..if room { ORDER } else { 0 } {
                let want = richardson(|x| c.jet(x, Limit::Above, k).d[k], t, h);
                let got = jet.d[k + 1];
                // What the difference can lose: rounding of the lower derivative over h, and truncation.
                let lower = c.enclose(Interval::new(t - h, t + h), k + 1);
                let noise = 1e-12 * (magnitude(&lower[k]) + if k == 0 { far } else { 0.0 }) / h;
                let tol = DIFFERENCE * (got.length() + magnitude(&lower[k + 1])) + noise;
                assert!(
                    (got - want).length() <= tol,
                    "derivative {} at {t}: {got} but {want}",
                    k + 1
                );
            }
        }
    }
    let mut lanes = Random(5);
    for order in 0..=2 {
        let t = Pack(std::array::from_fn(|_| lanes.within(domain)));
        let mut pack = vec![[Pack::ZERO; 3]; order + 1];
        c.pack_into(t, Limit::Above, &mut pack);
        for (lane, &t) in t.0.iter().enumerate() {
            let lane: Vec<_> = pack.iter().map(|d| d.map(|x| x.0[lane])).collect();
            let single = c.jet(t, Limit::Above, order).d;
            assert!(
                single.iter().map(|d| d.to_array()).eq(lane),
                "a pack gives the same jet of order {order} at {t}"
            );
        }
    }
    for b in &breaks[1..breaks.len() - 1] {
        let (l, r) = (
            c.jet(b.at, Limit::Below, ORDER),
            c.jet(b.at, Limit::Above, ORDER),
        );
        for k in 0..=ORDER.min(b.smooth.max(-1) as usize) {
            if b.smooth < k as i32 {
                break;
            }
            let tol = 1e-9 * (l.d[k].length() + far / piece_width(breaks).powi(k as i32));
            assert!(
                (l.d[k] - r.d[k]).length() <= tol,
                "break at {} is not C{k}: {} {}",
                b.at,
                l.d[k],
                r.d[k]
            );
        }
    }
    for _ in 0..boxes {
        let t = random.part(domain);
        let boxes = c.enclose(t, 2);
        for s in [t.lo, t.hi, random.within(t), random.within(t)] {
            let jet = c.jet(s, Limit::Above, 2);
            for k in 0..=2 {
                let rounding = rounding(&boxes[k], far, k, piece_width(breaks));
                assert_inside(
                    boxes[k],
                    jet.d[k],
                    rounding,
                    &format!("derivative {k} at {s} over {t:?}"),
                );
            }
        }
    }
    for i in 0..breaks.pieces() {
        let piece = breaks.piece(i);
        let m = random.within(start_of(piece));
        let width = |h: f64| {
            let t = Interval::new(m, (m + h * piece.width()).min(piece.hi));
            c.enclose(t, 1)
                .iter()
                .map(|b| b.diagonal())
                .collect::<Vec<_>>()
        };
        shrinks(
            &width(1e-2),
            &width(1e-4),
            &format!("curve enclosure near {m}"),
            far,
        );
    }
    if let Some(n) = c.to_nurbs() {
        assert_eq!(n.domain().lo, domain.lo);
        for _ in 0..40 {
            let t = random.within(domain);
            let (a, b) = (c.jet(t, Limit::Above, 2), n.jet(t, Limit::Above, 2));
            assert!(
                (a.d[0] - b.d[0]).length() <= POSITION * far,
                "NURBS form at {t}: {} {}",
                a.d[0],
                b.d[0]
            );
            for k in 1..=2 {
                let tol = DERIVATIVE * (a.d[k].length() + far / piece_width(breaks).powi(k as i32));
                assert!(
                    (a.d[k] - b.d[k]).length() <= tol,
                    "derivative {k} of the NURBS form at {t}"
                );
            }
        }
    }
}

/// The narrowest piece: derivatives of order k scale with its inverse k-th power.
fn piece_width(breaks: &[Break]) -> f64 {
    breaks
        .windows(2)
        .map(|w| w[1].at - w[0].at)
        .fold(f64::INFINITY, f64::min)
}

/// The rounding error a computed sample may have itself: some units in the last place of what it is made of.
fn rounding(b: &Box3, far: f64, order: usize, width: f64) -> f64 {
    1e-14 * (magnitude(b) + far / width.powi(order as i32)) * (order + 1) as f64
}

/// A piece without its end, so that intervals that start in it are not cut short there.
fn start_of(piece: Interval) -> Interval {
    Interval::new(piece.lo, piece.lo + 0.95 * (piece.hi - piece.lo))
}

/// A hundred times smaller intervals give at least twenty times smaller boxes, until rounding takes over: where the curve
/// turns back in the middle of the larger interval, 25 times.
fn shrinks(coarse: &[f64], fine: &[f64], what: &str, far: f64) {
    for (k, (c, f)) in coarse.iter().zip(fine).enumerate() {
        assert!(
            *f <= 0.05 * c + 1e-10 * far,
            "{what}: order {k} shrinks only from {c:e} to {f:e}"
        );
    }
}

/// Checks every law on a surface with 10³ random boxes.
pub fn surface(s: &dyn Surface) {
    surface_with(s, 1000);
}

/// Checks every law on a surface with the given number of random boxes.
pub fn surface_with(s: &dyn Surface, boxes: usize) {
    let domain = s.domain();
    let (bu, bv) = (s.breaks(Dir::U), s.breaks(Dir::V));
    for b in [bu, bv] {
        assert!(
            b.len() >= 2 && b.windows(2).all(|w| w[0].at < w[1].at),
            "breaks increase: {b:?}"
        );
    }
    let n = PARTS_OF_SURFACE;
    let bounds = (0..n * n)
        .map(|k| s.bounds([part(domain[0], k / n, n), part(domain[1], k % n, n)]))
        .reduce(Box3::hull)
        .unwrap_or(Box3::ENTIRE);
    assert!(
        bounds.is_finite(),
        "the surface encloses itself: without that no tolerance below says anything"
    );
    let far = magnitude(&bounds).max(bounds.diagonal());
    let width = piece_width(bu).min(piece_width(bv));
    let above = [Limit::Above; 2];
    let mut random = Random(11);
    for a in 0..bu.pieces().min(6) {
        for b in 0..bv.pieces().min(6) {
            let pieces = [bu.piece(a), bv.piece(b)];
            let uv = pieces.map(|p| random.within(p));
            let jet = s.jet(uv, above, ORDER);
            assert_eq!(
                s.point(uv),
                s.jet(uv, above, 0).d[0],
                "point(uv) is the jet's point"
            );
            assert!(
                (s.point(uv) - jet.d[0]).length() <= POSITION * far,
                "order changes the point at {uv:?}"
            );
            for dir in 0..2 {
                let h = 0.02 * pieces[dir].width().min(1.0);
                if !(pieces[dir].lo + h < uv[dir] && uv[dir] + h < pieces[dir].hi) {
                    continue;
                }
                let around = {
                    let mut r = uv.map(Interval::point);
                    r[dir] = Interval::new(uv[dir] - h, uv[dir] + h);
                    s.enclose(r, ORDER)
                };
                for n in 0..ORDER {
                    for j in 0..=n {
                        let (i, lower) = (n - j, jet_index(n - j, j));
                        let upper = if dir == 0 {
                            jet_index(i + 1, j)
                        } else {
                            jet_index(i, j + 1)
                        };
                        let at = |x: f64| {
                            let mut p = uv;
                            p[dir] = x;
                            s.jet(p, above, n).d[lower]
                        };
                        let want = richardson(at, uv[dir], h);
                        let got = jet.d[upper];
                        let noise = 1e-12 * (magnitude(&around[lower]) + far) / h;
                        let tol = DIFFERENCE * (got.length() + magnitude(&around[upper])) + noise;
                        assert!(
                            (got - want).length() <= tol,
                            "derivative ({i}, {j}) + direction {dir} at {uv:?}: {got} but {want}"
                        );
                    }
                }
            }
        }
    }
    many(s, far, width, &mut random);
    for dir in [Dir::U, Dir::V] {
        let breaks = s.breaks(dir);
        for b in &breaks[1..breaks.len() - 1] {
            let uv = match dir {
                Dir::U => [b.at, random.within(domain[1])],
                Dir::V => [random.within(domain[0]), b.at],
            };
            let limit = |l| {
                if dir == Dir::U {
                    [l, Limit::Above]
                } else {
                    [Limit::Above, l]
                }
            };
            let (l, r) = (
                s.jet(uv, limit(Limit::Below), ORDER),
                s.jet(uv, limit(Limit::Above), ORDER),
            );
            for k in (0..=ORDER).take_while(|&k| k as i32 <= b.smooth) {
                let at = if dir == Dir::U {
                    jet_index(k, 0)
                } else {
                    jet_index(0, k)
                };
                let tol = 1e-9 * (l.d[at].length() + far / width.powi(k as i32));
                assert!(
                    (l.d[at] - r.d[at]).length() <= tol,
                    "break {} is not C{k} at {uv:?}",
                    b.at
                );
            }
        }
    }
    for _ in 0..boxes {
        let uv = domain.map(|d| random.part(d));
        let boxes = s.enclose(uv, 2);
        let [u, v] = uv;
        for p in [
            [u.lo, v.lo],
            [u.hi, v.hi],
            [random.within(u), random.within(v)],
        ] {
            let jet = s.jet(p, above, 2);
            for k in 0..jet_len(2) {
                let order = [0, 1, 1, 2, 2, 2][k];
                let slack = rounding(&boxes[k], far, order, width);
                assert_inside(
                    boxes[k],
                    jet.d[k],
                    slack,
                    &format!("derivative {k} at {p:?} over {uv:?}"),
                );
            }
        }
    }
    let m = [bu.piece(0), bv.piece(0)].map(|p| random.within(start_of(p)));
    let widths = |h: f64| {
        let part = |x: f64, p: Interval| Interval::new(x, (x + h * p.width()).min(p.hi));
        let boxes = s.enclose([part(m[0], bu.piece(0)), part(m[1], bv.piece(0))], 1);
        boxes.iter().map(|b| b.diagonal()).collect::<Vec<_>>()
    };
    shrinks(
        &widths(1e-2),
        &widths(1e-4),
        &format!("enclosure near {m:?}"),
        far,
    );
    if let Some(n) = s.to_nurbs() {
        for _ in 0..60 {
            let uv = domain.map(|d| random.within(d));
            let (a, b) = (s.jet(uv, above, 2), n.jet(uv, above, 2));
            assert!(
                (a.d[0] - b.d[0]).length() <= POSITION * far,
                "NURBS form at {uv:?}: {} {}",
                a.d[0],
                b.d[0]
            );
            for k in 1..jet_len(2) {
                let order = [0, 1, 1, 2, 2, 2][k];
                let tol = DERIVATIVE * (a.d[k].length() + far / width.powi(order));
                let d = (a.d[k] - b.d[k]).length();
                assert!(
                    d <= tol,
                    "derivative {k} of the NURBS form at {uv:?} differs by {d:e}"
                );
            }
        }
    }
}

/// Lists and grids: a grid is the same as single points to the last bit, a list within [`LIST`] of the size, and
/// normals are those of [`normal_at`].
fn many(s: &dyn Surface, far: f64, width: f64, random: &mut Random) {
    let (domain, above) = (s.domain(), [Limit::Above; 2]);
    // Both ends, all breaks of some pieces, and more columns than a kernel takes at once.
    let mut some = |d: usize, dir: Dir, n: usize| {
        let mut t: Vec<f64> = (0..n).map(|_| random.within(domain[d])).collect();
        t.sort_by(f64::total_cmp);
        t.extend(s.breaks(dir).iter().take(4).map(|b| b.at));
        t.push(domain[d].hi);
        t
    };
    let (us, vs) = (some(0, Dir::U, 3), some(1, Dir::V, 21));
    let uv: Vec<[f64; 2]> = us
        .iter()
        .flat_map(|&u| vs.iter().map(move |&v| [u, v]))
        .collect();
    for order in 0..=2 {
        let each = jet_len(order);
        let mut grid = vec![DVec3::ZERO; uv.len() * each];
        s.grid_jets(&us, &vs, order, &mut grid);
        let mut list = grid.clone();
        s.jets(&uv, order, &mut list);
        for (k, &uv) in uv.iter().enumerate() {
            let jet = s.jet(uv, above, order);
            for (i, d) in jet.d.iter().enumerate() {
                assert_eq!(
                    grid[k * each + i],
                    *d,
                    "a grid of order {order} gives the same derivative {i} at {uv:?}"
                );
                let (got, order) = (list[k * each + i], [0, 1, 1, 2, 2, 2][i]);
                let tol = if order == 0 {
                    LIST * far
                } else {
                    DERIVATIVE * (d.length() + far / width.powi(order))
                };
                assert!(
                    (got - *d).length() <= tol,
                    "a list gives {got} for derivative {i} at {uv:?}, a point {d}: off by {:e}, allowed {tol:e}",
                    (got - *d).length()
                );
            }
        }
    }
    let mut short = [DVec3::ZERO];
    s.points(&uv[..1], &mut short);
    assert!((short[0] - s.point(uv[0])).length() <= LIST * far);
    let mut normals = vec![[DVec3::ZERO; 2]; uv.len()];
    s.grid_normals(&us, &vs, &mut normals);
    for (&uv, [point, normal]) in uv.iter().zip(normals) {
        let want = normal_at(s, uv, above).vector().unwrap_or(DVec3::ZERO);
        assert_eq!(point, s.point(uv), "points beside normals are the same");
        assert_eq!(normal, want, "normals of grids are the same at {uv:?}");
    }
}
