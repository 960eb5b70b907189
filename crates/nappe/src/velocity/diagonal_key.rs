//! How Diagonal-key surfaces move with their contour.

use super::cross_matrix;
use crate::basis::{BSplineBasis, Combination, Coordinates, FunctionsRef, One, Stack};
use crate::breaks::Limit;
use crate::curve::{CurveRef, on_unit_domain};
use crate::surface::diagonal_key::{dyad, relative, samples};
use crate::surface::{Core, DiagonalKey, DiagonalKeyOptions, Free, Particular, Separable, Term};
use glam::{DMat3, DVec3};
use std::sync::Arc;

/// Relative to the fastest difference: what leaves a plane, or a parallelogram, by less is rounding.
const STAYS: f64 = 1e-9;

const UNIT: [DVec3; 3] = [DVec3::X, DVec3::Y, DVec3::Z];

/// How the data of a Diagonal-key surface move.
#[derive(Clone, Debug)]
pub struct DiagonalKeyRate {
    /// The velocities of south, north, west and east.
    pub sides: [CurveRef; 4],
    /// The rates of p and q, if the surface has these.
    pub free: Option<[FunctionsRef; 2]>,
    /// The velocities of the tangents along the first and the second guide, if both are given.
    pub tangents: Option<[CurveRef; 2]>,
}

/// Some functions of the operator's variable with matrices for each: those that go with the difference of the generators,
/// and with its velocity.
struct Part {
    functions: FunctionsRef,
    still: Vec<DMat3>,
    moved: Vec<DMat3>,
}

impl Part {
    fn new(functions: FunctionsRef, still: Vec<DMat3>, moved: Vec<DMat3>) -> Self {
        Self {
            functions,
            still,
            moved,
        }
    }
}

/// What the velocity is made of, seen from the generators.
struct Frame {
    /// The differences d(1, v) of the guides and x(u) of the generators, and their velocities.
    d: [FunctionsRef; 2],
    x: [FunctionsRef; 2],
    /// d11 and its velocity.
    a: [DVec3; 2],
}

/// The velocity of a Diagonal-key surface that was made with these options: with `L(v) = Σ F_j A_j` and `x` for
/// `u1 - p01 - u0 + p00` it is `v0' - p00' + u0' + Σ (F_j' A_j + F_j A_j') x + F_j A_j x'`.
///
/// In a plane `L[x] = ((d·a) x + (a × d) × x) / |a|²` with `a = d11` and `d = d(1, v)`, without regard to its axes. With
/// tangents along both guides L maps three vectors to three others.
///
/// Errors: what is not known: rotations in space, a single tangent, free functions in space, and contours that leave their
/// plane or their parallelogram, beside which the surface is of another kind.
pub fn diagonal_key(
    own: &DiagonalKey,
    options: &DiagonalKeyOptions,
    rate: &DiagonalKeyRate,
) -> Result<Separable, &'static str> {
    let c = own.contour();
    let seen = |[s, n, w, e]: [CurveRef; 4]| {
        if options.exchange {
            [w, e, s, n]
        } else {
            [s, n, w, e]
        }
    };
    let curves = seen([c.south(), c.north(), c.west(), c.east()].map(Arc::clone));
    let rates = seen(rate.sides.clone().map(on_unit_domain));
    let difference = |c: &[CurveRef; 4], first: usize| -> FunctionsRef {
        let [a, b] = [first, first + 1].map(|k| relative(&c[k]));
        Arc::new(Combination::difference(b, a))
    };
    let [x, d] = [0, 2].map(|first| [&curves, &rates].map(|c| difference(c, first)));
    let a = d.each_ref().map(|d| {
        let mut end = [0.0; 3];
        d.jet_into(1.0, Limit::Below, 0, &mut end);
        DVec3::from_array(end)
    });
    let frame = Frame { d, x, a };
    let parts = match own.particular() {
        Particular::Plane { axes } => {
            if options.tangents.iter().any(Option::is_some) {
                return Err("how it changes with the tangent along one guide is not known");
            }
            frame.in_plane(axes, &options.free, rate)?
        }
        Particular::Stitched => frame.stitched(&curves, &rates, options, rate)?,
        Particular::Translation => frame.translation(options)?,
        Particular::Space | Particular::SpaceDetour => {
            return Err("how its rotation in space changes with its contour is not known");
        }
    };
    Ok(frame.sum(&rates, parts, options.exchange))
}

impl Frame {
    fn in_plane(
        &self,
        axes: [DVec3; 2],
        free: &Free,
        rate: &DiagonalKeyRate,
    ) -> Result<Vec<Part>, &'static str> {
        let [e1, e2] = axes;
        let normal = e1.cross(e2);
        let [a, da] = self.a;
        let square = a.length_squared();
        let by_a = |a: DVec3, e: DVec3| DMat3::IDENTITY * a.dot(e) + cross_matrix(a.cross(e));
        let own = UNIT.map(|e| by_a(a, e) * (1.0 / square));
        let growth = 2.0 * a.dot(da) / square;
        let turned = [0, 1, 2].map(|k| by_a(da, UNIT[k]) * (1.0 / square) - own[k] * growth);
        let [d, dd] = &self.d;
        let mut parts = vec![
            Part::new(d.clone(), turned.to_vec(), own.to_vec()),
            Part::new(dd.clone(), own.to_vec(), vec![DMat3::ZERO; 3]),
        ];
        let tilted = self.tilt(axes)?;
        match (free, &rate.free) {
            (Free::None, _) => {}
            (Free::Plane { p, q }, Some(rates)) => {
                if tilted {
                    return Err("its plane turns, and p and q belong to axes that stay");
                }
                let n = normal.cross(a) / square.sqrt();
                let turn = da / square.sqrt();
                let dn = normal.cross(turn - a * (a.dot(turn) / square));
                for ((f, df), e) in [p, q].into_iter().zip(rates).zip(axes) {
                    let (still, moved) = (vec![dyad(e, dn)], vec![dyad(e, n)]);
                    parts.push(Part::new(f.clone(), still, moved.clone()));
                    parts.push(Part::new(df.clone(), moved, vec![DMat3::ZERO]));
                }
            }
            _ => return Err("how it changes with its free functions is not known"),
        }
        Ok(parts)
    }

    /// Whether the plane of the differences turns; an error if they leave every plane.
    fn tilt(&self, axes: [DVec3; 2]) -> Result<bool, &'static str> {
        let normal = axes[0].cross(axes[1]);
        let both = |[at, rate]: &[FunctionsRef; 2]| {
            let value = |f: &FunctionsRef, t: f64| {
                let mut out = [0.0; 3];
                f.jet_into(t, Limit::Above, 0, &mut out);
                DVec3::from_array(out)
            };
            // At the samples of the velocities, which have all breaks of the curves.
            let places: Vec<(f64, DVec3)> = samples(rate.as_ref());
            let pairs = places.into_iter().map(|(t, rate)| (value(at, t), rate));
            pairs.collect::<Vec<_>>()
        };
        let all = [both(&self.d), both(&self.x)].concat();
        let fastest = all.iter().map(|w| w.1.length()).fold(0.0, f64::max);
        // The turn m of the normal in the plane with the least Σ (m·w + n·w')².
        let (mut g, mut right) = ([0.0; 3], [0.0; 2]);
        for (w, rate) in &all {
            let [x, y] = axes.map(|e| w.dot(e));
            let off = normal.dot(*rate);
            g = [g[0] + x * x, g[1] + x * y, g[2] + y * y];
            right = [right[0] - off * x, right[1] - off * y];
        }
        let (determinant, trace) = (g[0] * g[2] - g[1] * g[1], g[0] + g[2]);
        let m = if determinant > 1e-18 * trace * trace {
            [
                (right[0] * g[2] - right[1] * g[1]) / determinant,
                (right[1] * g[0] - right[0] * g[1]) / determinant,
            ]
        } else {
            // All differences lie on one line.
            right.map(|r| r / trace)
        };
        let turn = axes[0] * m[0] + axes[1] * m[1];
        let allowed = STAYS * fastest;
        let leaves = |(w, rate): &(DVec3, DVec3)| (turn.dot(*w) + normal.dot(*rate)).abs();
        if !all.iter().all(|w| leaves(w) <= allowed) {
            return Err("its contour leaves the plane that its generators are parallel to");
        }
        Ok(all.iter().any(|(w, _)| turn.dot(*w).abs() > allowed))
    }

    /// `L = Σ W_i ρ_iᵀ` with W of d and the tangents' changes, and ρ the rows of the inverse of `[d11 | e0 | e1]`.
    fn stitched(
        &self,
        curves: &[CurveRef; 4],
        rates: &[CurveRef; 4],
        options: &DiagonalKeyOptions,
        rate: &DiagonalKeyRate,
    ) -> Result<Vec<Part>, &'static str> {
        let ([Some(first), Some(second)], Some(moved)) = (&options.tangents, &rate.tangents) else {
            return Err("its tangents are missing");
        };
        let slope = |c: &CurveRef, end: usize| {
            let limit = [Limit::Above, Limit::Below][end];
            c.jet(end as f64, limit, 1).d[1]
        };
        let vectors = |c: &[CurveRef; 4], a: DVec3| {
            DMat3::from_cols(
                a,
                slope(&c[1], 0) - slope(&c[0], 0),
                slope(&c[1], 1) - slope(&c[0], 1),
            )
        };
        let inverse = vectors(curves, self.a[0]).inverse();
        let turned = inverse * vectors(rates, self.a[1]) * inverse;
        if !turned.is_finite() {
            return Err("its tangents and d11 lie in one plane");
        }
        let image = |tangent: &CurveRef, c: &[CurveRef; 4], end: usize| -> FunctionsRef {
            let tangent = on_unit_domain(tangent.clone());
            Arc::new(Coordinates::new(tangent, slope(&c[0], end)))
        };
        let images = [
            self.d.clone(),
            [image(first, curves, 0), image(&moved[0], rates, 0)],
            [image(second, curves, 1), image(&moved[1], rates, 1)],
        ];
        let mut parts = Vec::new();
        for (i, [at, rate]) in images.into_iter().enumerate() {
            let by = |m: &DMat3| UNIT.map(|e| dyad(e, m.row(i))).to_vec();
            let own = by(&inverse);
            let still = by(&(turned * -1.0));
            parts.push(Part::new(at, still, own.clone()));
            parts.push(Part::new(rate, own, vec![DMat3::ZERO; 3]));
        }
        Ok(parts)
    }

    /// `L = b I`, as long as the guides stay translates of each other.
    fn translation(&self, options: &DiagonalKeyOptions) -> Result<Vec<Part>, &'static str> {
        if !matches!(options.free, Free::None) || options.tangents.iter().any(Option::is_some) {
            return Err("how it changes with its free functions or tangents is not known");
        }
        let fastest = |f: &FunctionsRef| {
            let all = samples(f.as_ref());
            all.iter().map(|w| w.1.length()).fold(0.0, f64::max)
        };
        let [d, x] = [&self.d, &self.x].map(|pair| fastest(&pair[1]));
        if d > STAYS * (d + x).max(fastest(&self.x[0]) * STAYS) {
            return Err("its guides do not stay translates of each other");
        }
        let b = options.blend.clone().unwrap_or_else(|| {
            let line = Arc::new(BSplineBasis::bernstein(1));
            Arc::new(Combination::new(line, &[&[0.0, 1.0]]))
        });
        Ok(vec![Part::new(b, vec![DMat3::ZERO], vec![DMat3::IDENTITY])])
    }

    fn sum(&self, rates: &[CurveRef; 4], parts: Vec<Part>, exchange: bool) -> Separable {
        let [x, dx] = self.x.clone();
        let along: FunctionsRef =
            Arc::new(Stack::new(vec![Arc::new(One), relative(&rates[0]), x, dx]));
        let mut terms = Vec::new();
        for (k, e) in UNIT.into_iter().enumerate() {
            terms.push(Term::new(1 + k, 0, e.extend(0.0)));
            terms.push(Term::new(0, 1 + k, e.extend(0.0)));
        }
        let mut lists: Vec<FunctionsRef> = vec![Arc::new(One), relative(&rates[2])];
        let mut next = 4;
        for part in parts {
            for (matrices, first) in [(&part.still, 4), (&part.moved, 7)] {
                for (j, m) in matrices.iter().enumerate() {
                    let columns = (0..3).filter(|i| m.col(*i) != DVec3::ZERO);
                    let term = |i: usize| Term::new(first + i, next + j, m.col(i).extend(0.0));
                    terms.extend(columns.map(term));
                }
            }
            next += part.functions.count();
            lists.push(part.functions);
        }
        let across: FunctionsRef = Arc::new(Stack::new(lists));
        let corner = rates[0].point(0.0);
        if !exchange {
            return Separable::polynomial(along, across, Core::Terms(terms), corner);
        }
        for t in &mut terms {
            std::mem::swap(&mut t.i, &mut t.j);
        }
        Separable::polynomial(across, along, Core::Terms(terms), corner)
    }
}
