//! The Diagonal-key surface: a surface on a contour of four curves by a linear operator.

use super::{Contour, Core, Corner, Dir, Separable, Side, Surface, Term};
use crate::basis::{BSplineBasis, Combination, Coordinates, Functions, FunctionsRef, One, Stack};
use crate::breaks::{Breaks, Limit};
use crate::curve::{CurveRef, on_unit_domain};
use crate::exact::NurbsSurface;
use crate::interval::Interval;
use glam::{DMat3, DVec3};
use std::sync::Arc;

mod error;
mod factor;
mod operator;
mod plane;
mod turning;

pub use error::DiagonalKeyError;
use operator::Operator;
pub(crate) use plane::dyad;
use plane::{PLANE, Plane};
use turning::Turning;

/// The free part Lo of the operator: it vanishes on d11 and at both generators.
#[derive(Clone, Debug, Default)]
pub enum Free {
    /// None: the particular solution alone.
    #[default]
    None,
    /// In the plane-parallel case `Lo[x] = (x·n) (p e1 + q e2)` with `n = -sin φ e1 + cos φ e2`, φ the angle of d11
    /// from e1, and e1, e2 the plane's axes: (y, z), (z, x) or (x, y) for a plane square to x, y or z, or those given.
    /// p and q are single functions of v (of u, if generators and guides are exchanged) without unit that vanish at
    /// 0 and 1.
    Plane {
        /// The component along the first axis.
        p: FunctionsRef,
        /// The component along the second axis.
        q: FunctionsRef,
    },
    /// `Lo[x] = (x·n1) g1 + (x·n2) g2` with vectors g1, g2 of three functions that vanish at 0 and 1.
    Space {
        /// g1 and g2, three functions each.
        g: [FunctionsRef; 2],
        /// n1 and n2, which span the plane square to d11. They are made orthonormal in this order. By default n1 is
        /// the coordinate axis furthest from d11, made square to it, and `n2 = d11/|d11| × n1`.
        normals: Option<[DVec3; 2]>,
    },
}

/// How a Diagonal-key surface is chosen among all on the same contour.
#[derive(Clone, Debug, Default)]
pub struct DiagonalKeyOptions {
    /// West and east are the generators (what is deformed) instead of south and north.
    pub exchange: bool,
    /// Axes of the generators' plane, where p and q are not meant along the coordinate axes. They are made
    /// orthonormal, the first keeps its direction.
    pub plane_axes: Option<[DVec3; 2]>,
    /// The free part of the operator.
    pub free: Free,
    /// Smooth stitching: the derivative across the first and the second guide, `∂r/∂u` on west and east (`∂r/∂v` on
    /// south and north if exchanged), as a vector function of the guide's parameter.
    pub tangents: [Option<CurveRef>; 2],
    /// The function b with b(0) = 0 and b(1) = 1 in `L = b I`, used only if d11 = 0. The default is b(v) = v.
    pub blend: Option<FunctionsRef>,
}

/// The kind of the particular solution Lc.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Particular {
    /// Scale and rotation in a plane with these axes.
    Plane {
        /// Orthonormal axes.
        axes: [DVec3; 2],
    },
    /// Scale and rotation in space, from d11 straight to the direction of d(1, v).
    Space,
    /// Scale and rotation in space by way of an intermediate direction, as d(1, v) comes near the direction opposite
    /// to d11.
    SpaceDetour,
    /// d11 = 0, and the guides are translates of each other: `b(v) I`.
    Translation,
    /// Decided altogether by the tangents along both guides.
    Stitched,
}

/// The Diagonal-key surface on a contour:
/// `r(u, v) = v0(v) - p00 + u0(u) + L(v)[u1(u) - p01 - u0(u) + p00]` on `[0, 1]²`, with the generators u0 = south and
/// u1 = north, the guides v0 = west and v1 = east, and a linear operator with `L(0) = 0, L(1) = I, L(v)[d11] = d(1, v)`,
/// where `d11 = p11 - p01 - p10 + p00` and `d(1, v) = v1(v) - v0(v) - p10 + p00`.
///
/// The operator is `L = Lc + Lo`. Lc scales and rotates d11 to d(1, v): in the plane-parallel case (all differences in
/// one plane, within 1e-9 of the longest) in that plane, otherwise in space; smoothly also where d(1, v) vanishes or
/// points opposite to d11. Lo is free, see [`Free`]. Prescribed tangents along the guides decide L wholly or in part:
/// with one of them, what is square to d11 and to the change of the generators' end tangent is mapped as by Lc.
///
/// The surface keeps its four sides to rounding, or up to [`Contour::gap`]. It commutes with rotations and uniform
/// scalings. It is exactly a NURBS surface if the curves and functions are, except in the space cases. Break
/// parameters of the space cases include the zeros of d(1, v).
///
/// Source: Bolotov, Rogachev, Ronshin, "Design of surfaces on a given contour of four lines by operators of linear
/// algebra", (5)–(14) and statement 1.
#[derive(Clone, Debug)]
pub struct DiagonalKey {
    form: Separable,
    contour: Contour,
    d11: DVec3,
    particular: Particular,
    /// The functions of the operator's variable and the operator's matrix for each of them.
    functions: FunctionsRef,
    matrices: Vec<DMat3>,
}

/// The contour seen from its generators, with everything that is derived from it alone.
struct Frame {
    /// u0, u1, v0, v1.
    curves: [CurveRef; 4],
    corners: [[DVec3; 2]; 2],
    sides: [Side; 2],
    d: FunctionsRef,
    d11: DVec3,
    /// The rounding of differences of points, a length.
    noise: f64,
    /// Below this length d11 is zero.
    zero: f64,
}

impl DiagonalKey {
    /// Builds the surface. Cost: some hundred evaluations of the curves; in space some thousand.
    pub fn new(contour: Contour, options: &DiagonalKeyOptions) -> Result<Self, DiagonalKeyError> {
        let seen = if options.exchange {
            contour.exchanged()
        } else {
            contour.clone()
        };
        let frame = Frame::new(&seen, options.exchange)?;
        let tangents = frame.tangents(options)?;
        if !tangents.is_empty() && !matches!(options.free, Free::None) {
            return Err(DiagonalKeyError::FreeAndTangents);
        }
        let (mut operator, particular, plane) = frame.particular(options, tangents.len())?;
        frame.add_free(&mut operator, &options.free, plane)?;
        if !tangents.is_empty() {
            operator.stitch(frame.d11_or_zero(), &tangents)?;
        }
        Ok(frame.assemble(contour, operator, particular, options.exchange))
    }

    /// The surface in the form of the engine.
    pub fn form(&self) -> &Separable {
        &self.form
    }

    /// The contour.
    pub fn contour(&self) -> &Contour {
        &self.contour
    }

    /// `p11 - p01 - p10 + p00`.
    pub fn d11(&self) -> DVec3 {
        self.d11
    }

    /// Which particular solution was taken.
    pub fn particular(&self) -> Particular {
        self.particular
    }

    /// The matrix of L(v) (of L(u) if generators and guides are exchanged).
    pub fn operator(&self, v: f64) -> DMat3 {
        let mut f = vec![0.0; self.functions.count()];
        let active = self.functions.active(v, Limit::Above);
        self.functions
            .jet_into(v, Limit::Above, 0, &mut f[active.clone()]);
        self.matrices
            .iter()
            .zip(&f)
            .fold(DMat3::ZERO, |l, (m, f)| l + *m * *f)
    }
}

/// The coordinates of a curve relative to its start.
pub(crate) fn relative(curve: &CurveRef) -> FunctionsRef {
    Arc::new(Coordinates::new(curve.clone(), curve.point(0.0)))
}

/// Samples of three functions over every analytic piece.
pub(crate) fn samples(f: &dyn Functions) -> Vec<(f64, DVec3)> {
    /// Enough to notice what a curve of moderate degree does between.
    const SAMPLES: usize = 32;
    let breaks = f.breaks();
    let mut out = vec![0.0; 3];
    let mut all = Vec::new();
    for i in 0..breaks.pieces() {
        let piece = breaks.piece(i);
        for k in 0..=SAMPLES {
            let t = piece.lo + (piece.hi - piece.lo) * k as f64 / SAMPLES as f64;
            let limit = if k < SAMPLES {
                Limit::Above
            } else {
                Limit::Below
            };
            f.jet_into(t, limit, 0, &mut out);
            all.push((t, DVec3::new(out[0], out[1], out[2])));
        }
    }
    all
}

fn longest(vectors: &[DVec3]) -> f64 {
    vectors.iter().map(|v| v.length()).fold(0.0, f64::max)
}

impl Frame {
    fn new(seen: &Contour, exchanged: bool) -> Result<Self, DiagonalKeyError> {
        let curves = [seen.south(), seen.north(), seen.west(), seen.east()].map(Arc::clone);
        let names = if exchanged {
            [Side::West, Side::East, Side::South, Side::North]
        } else {
            Side::ALL
        };
        let mut far = 0.0f64;
        for (curve, side) in curves.iter().zip(names) {
            for (t, p) in samples(&Coordinates::new(curve.clone(), DVec3::ZERO)) {
                let value = p.x + p.y + p.z;
                if !value.is_finite() {
                    let name = side.name();
                    return Err(DiagonalKeyError::FunctionNotFinite { name, t, value });
                }
                far = far.max(p.abs().max_element());
            }
        }
        let [_, _, v0, v1] = &curves;
        let d: FunctionsRef = Arc::new(Combination::difference(relative(v1), relative(v0)));
        let mut end = [0.0; 3];
        d.jet_into(1.0, Limit::Below, 0, &mut end);
        let noise = 16.0 * f64::EPSILON * far;
        /// Part of the size below which d11 counts as zero. Larger, and contours that have an operator would be
        /// refused; smaller, and rounding would decide the operator.
        const PARALLELOGRAM: f64 = 1e-12;
        Ok(Self {
            corners: seen.corners(),
            sides: [names[2], names[3]],
            d,
            d11: DVec3::from_array(end),
            noise,
            zero: noise.max(PARALLELOGRAM * seen.size()) + 4.0 * seen.gap(),
            curves,
        })
    }

    fn d11_or_zero(&self) -> DVec3 {
        if self.d11.length() <= self.zero {
            DVec3::ZERO
        } else {
            self.d11
        }
    }

    /// The prescribed tangents as pairs of `e_i = u1'(i) - u0'(i)` and `T_i(v) - u0'(i)`.
    fn tangents(
        &self,
        options: &DiagonalKeyOptions,
    ) -> Result<Vec<(DVec3, FunctionsRef)>, DiagonalKeyError> {
        let mut all = Vec::new();
        for (i, tangent) in options.tangents.iter().enumerate() {
            let Some(tangent) = tangent else { continue };
            let side = self.sides[i];
            let tangent = on_unit_domain(tangent.clone());
            let ends = [0, 1].map(|j| {
                let limit = [Limit::Above, Limit::Below][i];
                self.curves[j].jet(i as f64, limit, 1).d[1]
            });
            let size = ends[0].length().max(ends[1].length());
            for (t, value) in samples(&Coordinates::new(tangent.clone(), DVec3::ZERO)) {
                let value = value.x + value.y + value.z;
                if !value.is_finite() {
                    let name = side.name();
                    return Err(DiagonalKeyError::FunctionNotFinite { name, t, value });
                }
            }
            for (j, expected) in ends.into_iter().enumerate() {
                let given = tangent.point(j as f64);
                // Tangents that disagree by more than the contour's own tolerance would tear the surface there.
                if given.distance(expected) > Contour::CLOSURE * size {
                    let corner = if matches!(side.along(), Dir::V) {
                        [
                            [Corner::SouthWest, Corner::NorthWest],
                            [Corner::SouthEast, Corner::NorthEast],
                        ][i][j]
                    } else {
                        [
                            [Corner::SouthWest, Corner::SouthEast],
                            [Corner::NorthWest, Corner::NorthEast],
                        ][i][j]
                    };
                    return Err(DiagonalKeyError::Tangent {
                        side,
                        corner,
                        given,
                        expected,
                    });
                }
            }
            let change = ends[1] - ends[0];
            let w = samples(&Coordinates::new(tangent.clone(), ends[0]));
            let still = w.iter().all(|(_, w)| w.length() <= Contour::CLOSURE * size);
            if still && change.length() <= Contour::CLOSURE * size {
                // L[0] = 0 says nothing: the surface has this tangent whatever L is.
                continue;
            }
            all.push((
                change,
                Arc::new(Coordinates::new(tangent, ends[0])) as FunctionsRef,
            ));
        }
        Ok(all)
    }

    /// The particular solution.
    fn particular(
        &self,
        options: &DiagonalKeyOptions,
        tangents: usize,
    ) -> Result<(Operator, Particular, Option<Plane>), DiagonalKeyError> {
        let (d11, wants_plane) = (self.d11, matches!(options.free, Free::Plane { .. }));
        let d: Vec<(f64, DVec3)> = samples(self.d.as_ref());
        if self.d11_or_zero() == DVec3::ZERO {
            let far = d.iter().fold(
                d[0],
                |m, x| if x.1.length() > m.1.length() { *x } else { m },
            );
            if far.1.length() > 4.0 * self.zero {
                let [[p00, p01], [p10, p11]] = self.corners;
                return Err(DiagonalKeyError::Parallelogram {
                    corners: Box::new([p00, p10, p01, p11]),
                    d11,
                    v: far.0,
                    d: far.1,
                });
            }
            let b = match &options.blend {
                Some(b) => {
                    check_function("blend", b, 1, [0.0, 1.0])?;
                    b.clone()
                }
                None => Arc::new(Combination::new(
                    Arc::new(BSplineBasis::bernstein(1)),
                    &[&[0.0, 1.0]],
                )),
            };
            let plane = if wants_plane {
                Some(self.plane(options, &d)?)
            } else {
                None
            };
            return Ok((
                Operator::multiple_of_identity(b),
                Particular::Translation,
                plane,
            ));
        }
        if tangents == 2 {
            return Ok((Operator::rank_one(d11), Particular::Stitched, None));
        }
        match self.plane(options, &d) {
            Ok(plane) => {
                let kind = Particular::Plane { axes: plane.axes };
                Ok((Operator::in_plane(&plane, d11), kind, Some(plane)))
            }
            Err(e) if wants_plane || options.plane_axes.is_some() => Err(e),
            Err(_) => {
                let turning = Turning::new(self.d.clone(), d11, self.noise)?;
                let kind = if turning.is_direct() {
                    Particular::Space
                } else {
                    Particular::SpaceDetour
                };
                Ok((Operator::entries(Arc::new(turning)), kind, None))
            }
        }
    }

    /// The plane of all differences, if the contour is plane-parallel (and its axes are known, if p and q need them).
    fn plane(
        &self,
        options: &DiagonalKeyOptions,
        d: &[(f64, DVec3)],
    ) -> Result<Plane, DiagonalKeyError> {
        let [u0, u1] = [0, 1].map(|i| relative(&self.curves[i]));
        let vectors = |s: Vec<(f64, DVec3)>| s.into_iter().map(|x| x.1);
        let mut wanted: Vec<DVec3> = vectors(samples(u0.as_ref())).collect();
        wanted.extend(vectors(samples(u1.as_ref())));
        let mut needed: Vec<DVec3> = d.iter().map(|x| x.1).collect();
        needed.extend(vectors(samples(&Combination::difference(u1, u0))));
        let tol = |v: &[DVec3]| PLANE * longest(v) + self.noise;
        let allowed = tol(&needed);
        let plane = match options.plane_axes {
            Some(axes) => Plane::given(axes)?,
            None => Plane::find((&needed, allowed), (&wanted, tol(&wanted))),
        };
        let deviation = plane.deviation(&needed);
        // d11 must have a direction in the plane, however short it is against the other differences.
        let upright = self.d11_or_zero().dot(plane.normal).abs() > 0.1 * self.d11.length();
        if deviation > allowed || upright {
            return Err(DiagonalKeyError::NotPlane {
                normal: plane.normal,
                deviation,
                tol: allowed,
            });
        }
        if matches!(options.free, Free::Plane { .. }) && !plane.named {
            return Err(DiagonalKeyError::AxesNeeded {
                normal: plane.normal,
            });
        }
        Ok(plane)
    }

    /// Adds Lo.
    fn add_free(
        &self,
        operator: &mut Operator,
        free: &Free,
        plane: Option<Plane>,
    ) -> Result<(), DiagonalKeyError> {
        let d11 = self.d11_or_zero();
        match (free, plane) {
            (Free::Plane { p, q }, Some(plane)) => {
                check_function("p", p, 1, [0.0; 2])?;
                check_function("q", q, 1, [0.0; 2])?;
                let [x, y] = plane.axes;
                // With d11 = 0 the angle of nothing is taken for 0.
                let (sin, cos) = d11.dot(y).atan2(d11.dot(x)).sin_cos();
                let n = y * cos - x * sin;
                operator.add_free(p.clone(), &[x], n);
                operator.add_free(q.clone(), &[y], n);
            }
            (Free::Space { g, normals }, _) => {
                check_function("g1", &g[0], 3, [0.0; 2])?;
                check_function("g2", &g[1], 3, [0.0; 2])?;
                let normals = square_to(d11, *normals)?;
                for (g, n) in g.iter().zip(normals) {
                    operator.add_free(g.clone(), &[DVec3::X, DVec3::Y, DVec3::Z], n);
                }
            }
            _ => {}
        }
        Ok(())
    }

    /// The terms of the engine.
    fn assemble(
        self,
        contour: Contour,
        operator: Operator,
        particular: Particular,
        exchange: bool,
    ) -> DiagonalKey {
        let [u0, u1, v0, v1] = &self.curves;
        // 1, the coordinates of a - a(0), and those of b - b(0) - a + a(0), each curve evaluated once.
        let sums = |a: &CurveRef, b: &CurveRef| -> FunctionsRef {
            let mut rows = vec![vec![0.0; 7]; 7];
            for (k, row) in rows.iter_mut().enumerate() {
                row[k] = 1.0;
                if k > 3 {
                    row[k - 3] = -1.0;
                }
            }
            let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
            let list = Stack::new(vec![Arc::new(One), relative(a), relative(b)]);
            Arc::new(Combination::new(Arc::new(list), &rows))
        };
        let along = sums(u0, u1);
        let is_linear = operator.linear.iter().any(|m| *m != DMat3::ZERO);
        let mut matrices = vec![DMat3::ZERO; 4];
        let mut parts: Vec<FunctionsRef> = if is_linear {
            matrices.extend(operator.linear);
            vec![sums(v0, v1)]
        } else {
            vec![Arc::new(One), relative(v0)]
        };
        for (functions, m) in operator.extra {
            parts.push(functions);
            matrices.extend(m);
        }
        let across: FunctionsRef = Arc::new(Stack::new(parts));
        let unit = [DVec3::X, DVec3::Y, DVec3::Z];
        let mut terms = Vec::new();
        for (k, e) in unit.into_iter().enumerate() {
            terms.push(Term::new(1 + k, 0, e.extend(0.0)));
            terms.push(Term::new(0, 1 + k, e.extend(0.0)));
        }
        for (j, m) in matrices.iter().enumerate() {
            for i in 0..3 {
                if m.col(i) != DVec3::ZERO {
                    terms.push(Term::new(4 + i, j, m.col(i).extend(0.0)));
                }
            }
        }
        if exchange {
            for t in &mut terms {
                std::mem::swap(&mut t.i, &mut t.j);
            }
        }
        let (u, v) = if exchange {
            (across.clone(), along)
        } else {
            (along, across.clone())
        };
        DiagonalKey {
            form: Separable::polynomial(u, v, Core::Terms(terms), self.corners[0][0]),
            contour,
            d11: self.d11,
            particular,
            functions: across,
            matrices,
        }
    }
}

/// Checks the count, the domain, finiteness, and the values at both ends of every function.
fn check_function(
    name: &'static str,
    f: &FunctionsRef,
    expected: usize,
    ends: [f64; 2],
) -> Result<(), DiagonalKeyError> {
    /// What an end value may be off, against the greatest value: rounding of formulas like sin πt.
    const ROUNDING: f64 = 1e-12;
    const SAMPLES: usize = 32;
    let count = f.count();
    if count != expected {
        return Err(DiagonalKeyError::FunctionCount {
            name,
            count,
            expected,
        });
    }
    let domain = f.breaks().domain();
    if domain != Interval::UNIT {
        return Err(DiagonalKeyError::FunctionDomain { name, domain });
    }
    let values = |t: f64| {
        let limit = if t < 1.0 { Limit::Above } else { Limit::Below };
        let active = f.active(t, limit);
        let mut all = vec![0.0; count];
        f.jet_into(t, limit, 0, &mut all[active]);
        all
    };
    let mut greatest = 1.0f64;
    for k in 0..=SAMPLES {
        let t = k as f64 / SAMPLES as f64;
        for value in values(t) {
            if !value.is_finite() {
                return Err(DiagonalKeyError::FunctionNotFinite { name, t, value });
            }
            greatest = greatest.max(value.abs());
        }
    }
    for (t, expected) in [0.0, 1.0].into_iter().zip(ends) {
        if let Some(&value) = values(t)
            .iter()
            .find(|x| (**x - expected).abs() > ROUNDING * greatest)
        {
            return Err(DiagonalKeyError::FunctionEnd {
                name,
                t,
                value,
                expected,
            });
        }
    }
    Ok(())
}

/// Two orthonormal vectors square to d11: those given, made so, or the default.
fn square_to(d11: DVec3, given: Option<[DVec3; 2]>) -> Result<[DVec3; 2], DiagonalKeyError> {
    /// The cosine to d11 that given normals may have. Larger, and a wrong normal would be bent silently.
    const SQUARE: f64 = 1e-6;
    let a = d11.normalize_or(DVec3::X);
    let Some(normals) = given else {
        let off = [DVec3::X, DVec3::Y, DVec3::Z].map(|e| e - a * e.dot(a));
        let n = off.into_iter().fold(
            DVec3::ZERO,
            |m, x| if x.length() > m.length() { x } else { m },
        );
        let n1 = n.normalize();
        return Ok([n1, a.cross(n1)]);
    };
    let bad = DiagonalKeyError::Normals { normals, d11 };
    let [Some(x), Some(y)] = normals.map(|n| n.try_normalize()) else {
        return Err(bad);
    };
    if d11 != DVec3::ZERO && (x.dot(a).abs() > SQUARE || y.dot(a).abs() > SQUARE) {
        return Err(bad);
    }
    let n1 = (x - a * x.dot(a) * if d11 == DVec3::ZERO { 0.0 } else { 1.0 }).normalize();
    let n2 = y - n1 * y.dot(n1);
    let n2 = if d11 == DVec3::ZERO {
        n2
    } else {
        n2 - a * n2.dot(a)
    };
    match n2.length() > SQUARE {
        true => Ok([n1, n2.normalize()]),
        false => Err(bad),
    }
}

impl Surface for DiagonalKey {
    evaluate_through!(self => self.form);

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        self.form.to_nurbs()
    }
}
