//! The engine: `R(u, v) = Σ_ij a_i(u) C_ij b_j(v)` in homogeneous coordinates, `r = origin + R.xyz / R.w`.
//!
//! Every surface of the five sources is of this form. A kind states its two lists of functions and the constant core
//! `C`; derivatives, enclosures, grids and the exact conversion to NURBS are here, once.

use super::list::Prepared;
use super::quotient::quotient;
use super::{Dir, Surface, Swept, check_length, grid, jet_index, jet_len, list, pairs, swept};
use crate::basis::{FunctionsRef, TABLE_ORDER, jet_of, room};
use crate::box3::Box3;
use crate::breaks::{Break, Limit, Part};
use crate::exact::NurbsSurface;
use crate::interval::Interval;
use crate::scalar::Scalar;
use crate::series::binomial;
use glam::{DAffine3, DVec3, DVec4, Vec4Swizzles};
use smallvec::SmallVec;
use std::ops::Range;
use std::sync::{Arc, OnceLock};

/// One product `c · a_i(u) · b_j(v)` of a separable surface; `c` holds (x, y, z, w).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Term {
    /// The index of the function of u.
    pub i: usize,
    /// The index of the function of v.
    pub j: usize,
    /// The constant factor, a homogeneous vector.
    pub c: DVec4,
}

impl Term {
    /// A term.
    pub fn new(i: usize, j: usize, c: DVec4) -> Self {
        Self { i, j, c }
    }
}

/// The constant factors of a separable surface.
#[derive(Clone, Debug, PartialEq)]
pub enum Core {
    /// One homogeneous vector for each pair of functions, row-major (v fastest): a control net.
    Net(Vec<DVec4>),
    /// Only some pairs.
    Terms(Vec<Term>),
}

/// A separable surface.
#[derive(Clone, Debug)]
pub struct Separable {
    u: FunctionsRef,
    v: FunctionsRef,
    core: Core,
    origin: DVec3,
    rational: bool,
    /// The number of functions of v.
    columns: usize,
    /// What lists need, prepared when the first list comes.
    prepared: Arc<OnceLock<Prepared>>,
}

impl Separable {
    /// `r = origin + Σ a_i(u) C_ij b_j(v)`; the w of every core vector is ignored.
    ///
    /// Panics if the core refers to functions that are not there.
    pub fn polynomial(u: FunctionsRef, v: FunctionsRef, core: Core, origin: DVec3) -> Self {
        Self::checked(u, v, core, origin, false)
    }

    /// `r = origin + R.xyz / R.w`. The caller knows that `R.w > 0`.
    ///
    /// Panics if the core refers to functions that are not there.
    pub fn rational(u: FunctionsRef, v: FunctionsRef, core: Core, origin: DVec3) -> Self {
        Self::checked(u, v, core, origin, true)
    }

    fn checked(
        u: FunctionsRef,
        v: FunctionsRef,
        core: Core,
        origin: DVec3,
        rational: bool,
    ) -> Self {
        match &core {
            Core::Net(c) => assert_eq!(
                c.len(),
                u.count() * v.count(),
                "a net has one point for each pair"
            ),
            Core::Terms(t) => {
                assert!(
                    t.iter().all(|t| t.i < u.count() && t.j < v.count()),
                    "terms refer to functions that exist"
                )
            }
        }
        let columns = v.count();
        Self {
            u,
            v,
            core,
            origin,
            rational,
            columns,
            prepared: Arc::default(),
        }
    }

    pub(super) fn prepared(&self) -> &Prepared {
        self.prepared.get_or_init(|| Prepared::new(self))
    }

    /// The functions of u.
    pub fn functions_u(&self) -> &FunctionsRef {
        &self.u
    }

    /// The functions of v.
    pub fn functions_v(&self) -> &FunctionsRef {
        &self.v
    }

    /// The constant factors.
    pub fn core(&self) -> &Core {
        &self.core
    }

    /// The point that is added at the end.
    pub fn origin(&self) -> DVec3 {
        self.origin
    }

    /// True if the w coordinate is not constant 1.
    pub fn is_rational(&self) -> bool {
        self.rational
    }

    /// The image under an affine map: exact, since only the core changes.
    pub fn transformed(&self, map: &DAffine3) -> Self {
        let t = |c: &DVec4| (map.matrix3 * c.xyz()).extend(c.w);
        let core = match &self.core {
            Core::Net(c) => Core::Net(c.iter().map(t).collect()),
            Core::Terms(c) => Core::Terms(c.iter().map(|x| Term { c: t(&x.c), ..*x }).collect()),
        };
        Self {
            core,
            origin: map.transform_point3(self.origin),
            prepared: Arc::default(),
            ..self.clone()
        }
    }

    /// The first half of the sum: `K_j⁽ᵖ⁾ = Σ_i a_i⁽ᵖ⁾ C_ij` for the functions of v in `range_v`, written to
    /// `out[p * range_v.len() + j]`. It depends on u alone, so a grid shares it along a row.
    ///
    /// With `shift` the core is measured from there: near that point the quotient rule loses nothing to cancellation.
    /// With `centre` a net's columns are measured from their means, see [`mean`]; the functions of u must sum to 1.
    pub(super) fn collapse<S: Scalar>(
        &self,
        a: &[S],
        [range_u, range_v]: [Range<usize>; 2],
        shift: Option<[S; 3]>,
        centre: bool,
        out: &mut [[S; 4]],
    ) {
        let (na, nb) = (range_u.len(), range_v.len());
        let lift = |c: DVec4| -> [S; 4] {
            let (x, y, z, w) = (S::from(c.x), S::from(c.y), S::from(c.z), S::from(c.w));
            match shift {
                _ if !self.rational => [x, y, z, S::ZERO],
                Some(s) => [x - s[0] * w, y - s[1] * w, z - s[2] * w, w],
                None => [x, y, z, w],
            }
        };
        out.fill([S::ZERO; 4]);
        let add = |out: &mut [[S; 4]], i: usize, j: usize, c: [S; 4]| {
            for (p, row) in out.chunks_exact_mut(nb).enumerate() {
                let f = a[p * na + i];
                for (o, c) in row[j].iter_mut().zip(c) {
                    if !c.is_zero() {
                        *o = *o + f * c;
                    }
                }
            }
        };
        match &self.core {
            Core::Net(net) => {
                let at = |i: usize, j: usize| {
                    lift(net[(range_u.start + i) * self.columns + range_v.start + j])
                };
                if centre {
                    for j in 0..nb {
                        let m = mean(na, |i| at(i, j));
                        for i in 0..na {
                            add(out, i, j, sub(at(i, j), m));
                        }
                        out[j] = sum(out[j], m);
                    }
                    return;
                }
                for (i, row) in net
                    .chunks_exact(self.columns)
                    .skip(range_u.start)
                    .take(na)
                    .enumerate()
                {
                    for (j, c) in row[range_v.clone()].iter().enumerate() {
                        add(out, i, j, lift(*c));
                    }
                }
            }
            Core::Terms(terms) => {
                for t in terms
                    .iter()
                    .filter(|t| range_u.contains(&t.i) && range_v.contains(&t.j))
                {
                    add(out, t.i - range_u.start, t.j - range_v.start, lift(t.c));
                }
            }
        }
    }

    /// The second half: homogeneous derivatives `Σ_j K_j⁽ᵖ⁾ b_j⁽ᑫ⁾` for all `p + q <= order`. `centre` as for the
    /// first half.
    fn contract<S: Scalar>(
        collapsed: &mut [[S; 4]],
        b: &[S],
        count: usize,
        order: usize,
        centre: bool,
        out: &mut [[S; 4]],
    ) {
        for p in 0..=order {
            let row = &mut collapsed[p * count..][..count];
            let m = if centre {
                mean(count, |j| row[j])
            } else {
                [S::ZERO; 4]
            };
            if centre {
                row.iter_mut().for_each(|k| *k = sub(*k, m));
            }
            for q in 0..=order - p {
                let o = &mut out[jet_index(p, q)];
                *o = [S::ZERO; 4];
                for (k, &f) in row.iter().zip(&b[q * count..]) {
                    for (o, &k) in o.iter_mut().zip(k) {
                        *o = *o + f * k;
                    }
                }
                if centre && q == 0 {
                    *o = sum(*o, m);
                }
            }
        }
    }

    /// The derivatives up to `ROWS - 1` for a net: the operations of a grid in the same order. Up to `ROOM` values of a
    /// side need no allocation.
    fn net_jet<const ROWS: usize, const JET: usize, const ROOM: usize>(
        &self,
        net: &[DVec4],
        [u, v]: [f64; 2],
        limit: [Limit; 2],
        out: &mut [DVec3],
    ) {
        let (mut a, mut b) = ([0.0; ROOM], [0.0; ROOM]);
        let active = [
            self.u.active_jet(u, limit[0], ROWS - 1, &mut a),
            self.v.active_jet(v, limit[1], ROWS - 1, &mut b),
        ];
        // With the numbers of functions known the compiler takes all loops apart.
        match [active[0].len(), active[1].len()] {
            [3, 3] => self.net_jet_of::<3, ROWS, JET>(net, [&a, &b], active, out),
            [4, 4] => self.net_jet_of::<4, ROWS, JET>(net, [&a, &b], active, out),
            [nu, nv] if ROWS * nu.max(nv) <= ROOM => {
                self.net_jet_of::<0, ROWS, JET>(net, [&a, &b], active, out);
            }
            _ => self.long_net_jet::<ROWS, JET>(net, [u, v], limit, out),
        }
    }

    /// The same for any number of active functions.
    #[cold]
    #[inline(never)]
    fn long_net_jet<const ROWS: usize, const JET: usize>(
        &self,
        net: &[DVec4],
        [u, v]: [f64; 2],
        limit: [Limit; 2],
        out: &mut [DVec3],
    ) {
        let (mut a, mut b) = (Vec::new(), Vec::new());
        let (iu, a) = jet_of(&*self.u, (u, limit[0]), ROWS - 1, &mut [], &mut a);
        let (jv, b) = jet_of(&*self.v, (v, limit[1]), ROWS - 1, &mut [], &mut b);
        self.net_jet_of::<0, ROWS, JET>(net, [a, b], [iu, jv], out);
    }

    /// The same for `N` active functions on each side, or any number if `N` is 0.
    #[inline(always)]
    fn net_jet_of<const N: usize, const ROWS: usize, const JET: usize>(
        &self,
        net: &[DVec4],
        [a, b]: [&[f64]; 2],
        [u, v]: [Range<usize>; 2],
        out: &mut [DVec3],
    ) {
        let [na, nb] = if N == 0 { [u.len(), v.len()] } else { [N; 2] };
        let count = self.columns;
        let net = &net[u.start * count + v.start..][..(na - 1) * count + nb];
        let (a, b) = (&a[..ROWS * na], &b[..ROWS * nb]);
        // If their number is known: no check of each index then.
        let rows: [&[DVec4]; N] = std::array::from_fn(|i| &net[i * count..][..nb]);
        let mut h = [DVec4::ZERO; JET];
        for j in 0..nb {
            let mut k = [DVec4::ZERO; ROWS];
            for i in 0..na {
                let c = if N == 0 {
                    net[i * count + j]
                } else {
                    rows[i][j]
                };
                for p in 0..ROWS {
                    k[p] += c * a[p * na + i];
                }
            }
            for p in 0..ROWS {
                for q in 0..ROWS - p {
                    h[jet_index(p, q)] += k[p] * b[q * nb + j];
                }
            }
        }
        let mut put = |mut r: [DVec3; JET]| {
            r[0] += self.origin;
            out.copy_from_slice(&r);
        };
        if self.rational {
            put(quotient(&h.map(|h| h.to_array())).map(DVec3::from_array));
        } else {
            put(h.map(DVec4::xyz));
        }
    }

    /// The same for any core and order.
    #[inline(never)]
    fn any_jet(&self, [u, v]: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        let (mut a, mut b) = ([0.0; 32], [0.0; 32]);
        let (mut more_a, mut more_b) = (Vec::new(), Vec::new());
        let (iu, a) = jet_of(&*self.u, (u, limit[0]), order, &mut a, &mut more_a);
        let (jv, b) = jet_of(&*self.v, (v, limit[1]), order, &mut b, &mut more_b);
        let active = [iu, jv];
        let (mut k, mut more_k) = ([[0.0; 4]; 16], Vec::new());
        let (mut h, mut r) = ([[0.0; 4]; 10], [[0.0; 3]; 10]);
        let (mut more_h, mut more_r) = (Vec::new(), Vec::new());
        let count = active[1].len();
        let k = room(&mut k, &mut more_k, (order + 1) * count, [0.0; 4]);
        let h = room(&mut h, &mut more_h, jet_len(order), [0.0; 4]);
        let r = room(&mut r, &mut more_r, jet_len(order), [0.0; 3]);
        self.collapse(a, active, None, false, k);
        Self::contract(k, b, count, order, false, h);
        self.dehomogenise(h, order, r);
        for (o, r) in out.iter_mut().zip(r) {
            *o = DVec3::from_array(*r);
        }
        out[0] += self.origin;
    }

    /// Encloses the surface over the product of two parts.
    fn enclose_product(&self, [u, v]: [&Enclosed; 2], order: usize, out: &mut [Box3]) {
        let shift = self.rational.then(|| {
            let mut p = [DVec3::ZERO];
            let middle = [u, v].map(|side| side.part.0.mid());
            self.jet_into(middle, [u.part.1, v.part.1], 0, &mut p);
            let p = p[0] - self.origin;
            if p.is_finite() { p } else { DVec3::ZERO }
        });
        let lifted = shift.map(|p| p.to_array().map(Interval::point));
        let (zero, count) = ([Interval::ZERO; 4], v.active.len());
        let mut k: SmallVec<[[Interval; 4]; 16]> = SmallVec::from_elem(zero, (order + 1) * count);
        let centre = self.u.sums_to_one() && matches!(self.core, Core::Net(_));
        let active = [u, v].map(|side| side.active.clone());
        self.collapse(&u.jet, active, lifted, centre, &mut k);
        let mut h: SmallVec<[[Interval; 4]; 16]> = SmallVec::from_elem(zero, jet_len(order));
        let centre = self.v.sums_to_one();
        Self::contract(&mut k, &v.jet, count, order, centre, &mut h);
        let mut r: SmallVec<[[Interval; 3]; 16]> =
            SmallVec::from_elem([Interval::ZERO; 3], jet_len(order));
        self.dehomogenise(&h, order, &mut r);
        for (o, r) in out.iter_mut().zip(&r) {
            *o = Box3::from(*r);
        }
        if let Some(p) = shift {
            out[0] = out[0] + Box3::point(p);
        }
        out[0] = out[0] + Box3::point(self.origin);
    }

    /// The derivatives of `r - origin` (or `r - origin - shift` if rational), written over homogeneous ones.
    pub(crate) fn dehomogenise<S: Scalar>(&self, h: &[[S; 4]], order: usize, out: &mut [[S; 3]]) {
        for n in 0..=order {
            for j in 0..=n {
                let i = n - j;
                let at = jet_index(i, j);
                if !self.rational {
                    out[at] = [h[at][0], h[at][1], h[at][2]];
                    continue;
                }
                // r_ij = (R_ij - Σ_{(p,q) < (i,j)} C(i,p) C(j,q) r_pq w_{i-p,j-q}) / w
                let mut s = [h[at][0], h[at][1], h[at][2]];
                for p in 0..=i {
                    for q in 0..=j {
                        if (p, q) == (i, j) {
                            continue;
                        }
                        let w = S::from(binomial(i, p) * binomial(j, q))
                            * h[jet_index(i - p, j - q)][3];
                        for k in 0..3 {
                            s[k] = s[k] - out[jet_index(p, q)][k] * w;
                        }
                    }
                }
                let w = h[0][3];
                out[at] = [s[0] / w, s[1] / w, s[2] / w];
            }
        }
    }
}

/// The active functions of one side, enclosed over a part of its domain.
struct Enclosed {
    part: Part,
    active: Range<usize>,
    /// Row-major by derivative.
    jet: SmallVec<[Interval; 32]>,
}

impl Enclosed {
    fn new(functions: &FunctionsRef, part: Part, order: usize) -> Self {
        let (t, limit) = part;
        let active = functions.active(t.mid(), limit);
        let mut jet = SmallVec::from_elem(Interval::ENTIRE, (order + 1) * active.len());
        functions.enclose_piece(t, limit, order, &mut jet);
        Self { part, active, jet }
    }
}

/// A number near the mean of each coordinate. Where `Σ f_i = 1`, `Σ f_i c_i = m + Σ f_i (c_i - m)` and
/// `Σ f_i' c_i = Σ f_i' (c_i - m)` for every m: with enclosures of the `f_i` the right sides are much narrower.
fn mean<S: Scalar>(n: usize, point: impl Fn(usize) -> [S; 4]) -> [S; 4] {
    let mut total = [0.0; 4];
    for i in 0..n {
        for (t, c) in total.iter_mut().zip(point(i)) {
            *t += c.mid();
        }
    }
    total.map(|t| {
        let m = t / n as f64;
        S::from(if m.is_finite() { m } else { 0.0 })
    })
}

fn sum<S: Scalar>(a: [S; 4], b: [S; 4]) -> [S; 4] {
    [0, 1, 2, 3].map(|k| a[k] + b[k])
}

fn sub<S: Scalar>(a: [S; 4], b: [S; 4]) -> [S; 4] {
    [0, 1, 2, 3].map(|k| a[k] - b[k])
}

impl Surface for Separable {
    fn breaks(&self, dir: Dir) -> &[Break] {
        match dir {
            Dir::U => self.u.breaks(),
            Dir::V => self.v.breaks(),
        }
    }

    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        match (&self.core, order) {
            (Core::Net(net), 0) => self.net_jet::<1, 1, 8>(net, uv, limit, out),
            (Core::Net(net), 1) => self.net_jet::<2, 3, 16>(net, uv, limit, out),
            (Core::Net(net), 2) => self.net_jet::<3, 6, 24>(net, uv, limit, out),
            _ => self.any_jet(uv, limit, order, out),
        }
    }

    fn jets(&self, uv: &[[f64; 2]], order: usize, out: &mut [DVec3]) {
        check_length(uv.len() * jet_len(order), out.len());
        if order <= TABLE_ORDER {
            list::jets(self, self.prepared(), uv, order, out);
            return;
        }
        for (out, &uv) in out.chunks_exact_mut(jet_len(order)).zip(uv) {
            self.jet_into(uv, [Limit::Above; 2], order, out);
        }
    }

    fn grid_jets(&self, u: &[f64], v: &[f64], order: usize, out: &mut [DVec3]) {
        check_length(u.len() * v.len() * jet_len(order), out.len());
        if order <= grid::KERNEL_ORDER {
            grid::jets(self, u, v, order, out);
            return;
        }
        for (out, uv) in out.chunks_exact_mut(jet_len(order)).zip(pairs(u, v)) {
            self.jet_into(uv, [Limit::Above; 2], order, out);
        }
    }

    fn grid_normals(&self, u: &[f64], v: &[f64], out: &mut [[DVec3; 2]]) {
        check_length(u.len() * v.len(), out.len());
        grid::normals(self, u, v, out);
    }

    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]) {
        let side = |f: &FunctionsRef, d: usize| Enclosed::new(f, (uv[d], limit[d]), order);
        self.enclose_product([&side(&self.u, 0), &side(&self.v, 1)], order, out);
    }

    fn enclose_pieces(&self, [us, vs]: [&[Part]; 2], order: usize, out: &mut [Box3]) {
        let each = jet_len(order);
        check_length(us.len() * vs.len() * each, out.len());
        let side = |f: &FunctionsRef, &part: &Part| Enclosed::new(f, part, order);
        let vs: Vec<_> = vs.iter().map(|p| side(&self.v, p)).collect();
        let mut jets = out.chunks_exact_mut(each);
        for u in us.iter().map(|p| side(&self.u, p)) {
            for (v, jet) in vs.iter().zip(&mut jets) {
                self.enclose_product([&u, v], order, jet);
            }
        }
    }

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        NurbsSurface::from_separable(self)
    }

    /// Moved, as a ruled surface between two places of one curve is.
    fn swept(&self) -> Option<Swept> {
        swept::moved(&self.to_nurbs()?)
    }
}
