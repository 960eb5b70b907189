//! The shape operator of a surface as Taylor polynomials, also up to a pole.

use super::integral::{halved, turning};
use super::taylor::{Patch, Taylor};
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::surface::{Dir, Surface, jet_index, jet_len};

/// A side whose tangents amount to less than this part of the surface's size is one point. Larger, and the strong
/// curvature of a short side would be missed; smaller, and rounding would hide poles.
pub(super) const POINT: f64 = 1e-12;
/// Sine of the angle by which the tangents in a pole may leave their plane. Larger, and a blunt cone would count as
/// smooth; smaller, and rounding would make smooth poles cones.
pub(super) const PLANE: f64 = 1e-9;

/// The shape operator `[[p, q], [q, s]]` in an orthonormal basis of the tangent plane, and the metric.
///
/// The basis begins with r_u; with ρ = r_v, or beside a pole ρ = r_v / (u - u₀).
pub(super) struct Shape {
    pub(super) p: Taylor,
    pub(super) q: Taylor,
    pub(super) s: Taylor,
    /// `r_u·r_u`.
    pub(super) e: Taylor,
    /// `r_u·ρ`.
    pub(super) f: Taylor,
    /// `|r_u × ρ|²`.
    pub(super) n2: Taylor,
    /// `|r_u × ρ|`.
    pub(super) w: Taylor,
}

/// The shape operator over a box: enclosures of its Taylor coefficients over the box and at the centre of expansion.
pub(super) struct ShapeForm {
    pub(super) wide: Shape,
    pub(super) at: Shape,
    /// The parameters from the centre of expansion; the first is the one across a pole.
    pub(super) offset: [Interval; 2],
    /// True if u and v change places in the polynomials.
    pub(super) exchanged: bool,
}

impl ShapeForm {
    /// Polynomials of a degree; where nothing can be expanded: the direction in which to halve the box.
    ///
    /// Near a side u = u₀ that is one point, `r_v = (u - u₀) ρ` with a smooth ρ, whose Taylor coefficients are those of
    /// `r_v` moved by one place. If the tangents there lie in one plane, `r_vv·(r_u × ρ)` has the factor (u - u₀)²
    /// likewise, and all powers of u - u₀ cancel.
    pub(super) fn new(
        surface: &dyn Surface,
        uv: [Interval; 2],
        size: f64,
        degree: usize,
    ) -> Result<Self, usize> {
        let poles = poles(surface, uv, size);
        // Beside a pole the normal vanishes, but its factor u - u₀ is no obstacle.
        Self::expanded(surface, uv, &poles, degree).ok_or_else(|| match poles.len() {
            1 => turning(surface, uv).0,
            _ => halved(surface, uv),
        })
    }

    fn expanded(
        surface: &dyn Surface,
        uv: [Interval; 2],
        poles: &[(usize, f64)],
        degree: usize,
    ) -> Option<Self> {
        let (patch, [wide, at]) = match *poles {
            [] => {
                let patch = Patch::new(surface, uv, degree + 2);
                // The basis begins with the longer tangent.
                let swap = patch.at[2].norm().mid() > patch.at[1].norm().mid();
                let forms = [&patch.wide, &patch.at].map(|jet| beside(jet, swap, degree));
                (patch, forms)
            }
            [(d, at)] => {
                let mut centre = uv.map(Interval::mid);
                centre[d] = at;
                let mut patch = Patch::about(surface, uv, centre, degree + 4);
                let both =
                    [&patch.wide, &patch.at].map(|jet| around(jet, d, at == uv[d].hi, degree));
                if !both[1].1 {
                    return None;
                }
                if d == 1 {
                    patch.offset.swap(0, 1);
                }
                (patch, both.map(|b| b.0))
            }
            _ => return None,
        };
        let offset = patch.offset;
        let [wide, at] = shapes(wide, at, offset);
        let exchanged = poles.iter().any(|p| p.0 == 1);
        let form = Self {
            wide,
            at,
            offset,
            exchanged,
        };
        let Shape { p, q, s, .. } = &form.wide;
        [p, q, s].iter().all(|t| t.is_finite()).then_some(form)
    }
}

/// The sides of a box that are one point: the parameter across, and its value.
pub(super) fn poles(surface: &dyn Surface, uv: [Interval; 2], size: f64) -> Vec<(usize, f64)> {
    let domain = surface.domain();
    let mut poles = Vec::new();
    for d in 0..2 {
        for (at, end) in [(uv[d].lo, domain[d].lo), (uv[d].hi, domain[d].hi)] {
            if at == end && is_point(surface, uv, d, at, size) {
                poles.push((d, at));
            }
        }
    }
    poles
}

/// The places along a side where it is seen whether the side is a point: a tangent that is analytic along it does not
/// vanish in all of them by accident.
const PLACES: usize = 9;

/// True if the side of the box where the parameter `d` has the value `at` is one point, within rounding.
fn is_point(surface: &dyn Surface, uv: [Interval; 2], d: usize, at: f64, size: f64) -> bool {
    // The length of the side, not of the part along the box: a short part of a true side is no point.
    let breaks = surface.breaks([Dir::U, Dir::V][1 - d]);
    let piece = breaks.piece(breaks.find(uv[1 - d].mid(), Limit::Above));
    // A box of no width along the side cannot tell.
    let other = if uv[1 - d].is_point() {
        piece
    } else {
        uv[1 - d]
    };
    let mut limit = [Limit::Above; 2];
    if at == uv[d].hi {
        limit[d] = Limit::Below;
    }
    (0..PLACES).all(|k| {
        let mut p = [other.lo + (other.hi - other.lo) * (k as f64 + 0.5) / PLACES as f64; 2];
        p[d] = at;
        let tangent = surface.jet(p, limit, 1).d[2 - d];
        tangent.length() * piece.width() <= POINT * size
    })
}

/// Invariants of the two forms: `r_uu·n, r_uv·n, r_vv·n` with `n = r_u × r_v`, `r_u·r_u`, `r_u·r_v`, `n·n`.
pub(super) type Forms = [Taylor; 6];

/// The shape operator; the basis begins with r_u.
fn shape([l, m, k, e, f, n2]: &Forms) -> Shape {
    let w = n2.sqrt();
    let [l, m, k] = [l, m, k].map(|x| x.div(&w));
    let p = l.div(e);
    let fp = f.mul(&p);
    let q = m.sub(&fp).div(&w);
    let two = Interval::point(2.0);
    let s = e.mul(&k).add(&f.mul(&fp.sub(&m.scale(two)))).div(n2);
    let [e, f, n2] = [e, f, n2].map(Taylor::clone);
    Shape {
        p,
        q,
        s,
        e,
        f,
        n2,
        w,
    }
}

/// The shape operator over a box and in its middle, each step as narrow as these make it: curvature is a quotient, in which
/// wide terms multiply.
pub(super) fn shapes(wide: Forms, at: Forms, offset: [Interval; 2]) -> [Shape; 2] {
    let mut narrow = at.iter();
    let wide = wide.map(|t| match narrow.next() {
        Some(at) => t.tightened(at, offset),
        None => t,
    });
    let (wide, at) = (shape(&wide), shape(&at));
    let tight = |wide: Taylor, at: &Taylor| wide.tightened(at, offset);
    let wide = Shape {
        p: tight(wide.p, &at.p),
        q: tight(wide.q, &at.q),
        s: tight(wide.s, &at.s),
        ..wide
    };
    [wide, at]
}

/// Where `r_u × r_v` does not vanish, from a jet of order `degree` + 2. With `swap`, u and v change places.
pub(super) fn beside(jet: &[Box3], swap: bool, degree: usize) -> Forms {
    let vector = |d: [usize; 2]| Taylor::vector(jet, d, degree);
    let (u, v) = (vector([1, 0]), vector([0, 1]));
    let n = Taylor::cross(&u, &v);
    let [l, m, k] = [[2, 0], [1, 1], [0, 2]].map(|d| Taylor::dot(&n, &vector(d)));
    let (f, n2) = (Taylor::dot(&u, &v), Taylor::square(&n));
    if swap {
        [k, m, l, Taylor::square(&v), f, n2]
    } else {
        [l, m, k, Taylor::square(&u), f, n2]
    }
}

/// Around a side that is one point, across which the parameter `d` runs, from a jet of order `degree` + 4: the forms
/// without the powers of u - u₀. False if the tangents in the pole are not in one plane.
fn around(jet: &[Box3], d: usize, below: bool, degree: usize) -> (Forms, bool) {
    let turned;
    let jet = if d == 0 {
        jet
    } else {
        turned = exchanged(jet);
        &turned[..]
    };
    let each = |a: &[Taylor; 3], f: &dyn Fn(&Taylor) -> Taylor| [0, 1, 2].map(|k| f(&a[k]));
    let low = |a: &[Taylor; 3]| each(a, &|t| t.truncated(degree));
    let rho = each(&Taylor::vector(jet, [0, 1], degree + 3), &|t| t.divided());
    let rho_u = each(&rho, &|t| t.derivative(Dir::U));
    let rho_v = each(&rho, &|t| t.derivative(Dir::V));
    let rho = each(&rho, &|t| t.truncated(degree + 1));
    let u = Taylor::vector(jet, [1, 0], degree + 1);
    // With the sign of u - u₀, and as exchanged parameters turn the normal over.
    let sign = Interval::point(if below != (d == 1) { -1.0 } else { 1.0 });
    let n = each(&Taylor::cross(&u, &rho), &|t| t.scale(sign));
    let across = Taylor::dot(&n, &rho_v);
    let flat = across.c[0].mag() <= PLANE * length(&n) * length(&rho_v);
    let (n, u, rho) = (low(&n), low(&u), low(&rho));
    let forms = [
        Taylor::dot(&n, &Taylor::vector(jet, [2, 0], degree)),
        Taylor::dot(&n, &low(&rho_u)),
        across.divided(),
        Taylor::square(&u),
        Taylor::dot(&u, &rho),
        Taylor::square(&n),
    ];
    (forms, flat)
}

/// The length of the constant term.
fn length(v: &[Taylor; 3]) -> f64 {
    v.iter().map(|t| t.c[0].mag().powi(2)).sum::<f64>().sqrt()
}

/// The jet with u and v exchanged.
pub(super) fn exchanged(jet: &[Box3]) -> Vec<Box3> {
    let mut out = jet.to_vec();
    let mut n = 0;
    while jet_len(n) <= jet.len() {
        for j in 0..=n {
            out[jet_index(j, n - j)] = jet[jet_index(n - j, j)];
        }
        n += 1;
    }
    out
}
