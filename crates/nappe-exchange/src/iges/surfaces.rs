//! Surfaces.

use super::curves::{SAME_PARAMETER, bernstein, some_weights, text};
use super::file::Entry;
use super::record::{Got, Record};
use super::space::Space;
use glam::{DAffine3, DVec3};
use nappe::curve::{Trimmed, on_unit_domain};
use nappe::surface::{self, Dir, Elementary, ruled};
use nappe::{CurveRef, Frame, NurbsSurface, Revolution, RevolutionOptions, Surface, SurfaceRef};
use std::f64::consts::TAU;
use std::sync::Arc;

/// What a face lies on.
pub(super) enum Sheet {
    /// A surface with ends. Whether its parameters are those of the file.
    Bounded(SurfaceRef, bool),
    /// A surface that needs edges to end.
    Endless(Elementary),
}

/// Surfaces that stand by themselves.
pub(super) fn is_surface(entry: &Entry) -> bool {
    matches!(entry.kind, 114 | 118 | 120 | 122 | 128 | 196 | 198)
}

impl Space {
    pub(super) fn sheet(&self, number: i64, map: DAffine3) -> Got<Sheet> {
        let (entry, mut r) = self.open(number)?;
        let map = map * self.placement(entry)?;
        let r = &mut r;
        let bounded = |s: SurfaceRef, same: bool| Ok(Sheet::Bounded(placed(s, map)?, same));
        match entry.kind {
            108 => {
                let n = r.point()?;
                let length = n.length();
                let origin = n * (r.real()? / (length * length));
                endless(
                    Elementary::Plane {
                        origin,
                        normal: n / length,
                    },
                    map,
                )
            }
            114 => bounded(Arc::new(spline(r)?), true),
            118 => bounded(self.ruled(entry, r)?, false),
            120 => bounded(self.revolution(r)?, false),
            122 => {
                let directrix = self.curve(r.int()?, DAffine3::IDENTITY)?;
                let shift = r.point()? - directrix.ends()[0];
                let other =
                    super::curves::placed(directrix.clone(), DAffine3::from_translation(shift))?;
                bounded(
                    Arc::new(ruled(directrix, other, Dir::U).map_err(text)?),
                    false,
                )
            }
            128 => bounded(Arc::new(nurbs(r)?), true),
            190 => {
                let origin = self.point(r.int()?)?;
                let normal = self.direction(r.int()?)?.normalize();
                endless(Elementary::Plane { origin, normal }, map)
            }
            192 => {
                let axis = self.axis(r)?;
                let radius = positive(r.real()?)?;
                endless(
                    Elementary::Cylinder {
                        axis,
                        radius,
                        outward: true,
                    },
                    map,
                )
            }
            194 => {
                let axis = self.axis(r)?;
                let (radius, angle) = (r.real()?, r.real()?);
                let slope = positive(angle.to_radians().tan())?;
                let apex = axis.moved_to(axis.origin() - axis.z() * (radius / slope));
                endless(
                    Elementary::Cone {
                        axis: apex,
                        slope,
                        outward: true,
                    },
                    map,
                )
            }
            196 => {
                let centre = self.point(r.int()?)?;
                let radius = positive(r.real()?)?;
                let axis = r.int()?;
                let z = if axis == 0 {
                    DVec3::Z
                } else {
                    self.direction(axis)?
                };
                endless(
                    Elementary::Sphere {
                        frame: Frame::along(centre, z).map_err(text)?,
                        radius,
                        outward: true,
                    },
                    map,
                )
            }
            198 => {
                let axis = self.axis(r)?;
                let (major, minor) = (positive(r.real()?)?, positive(r.real()?)?);
                endless(
                    Elementary::Torus {
                        axis,
                        major,
                        minor,
                        outward: true,
                    },
                    map,
                )
            }
            kind => Err(format!("surfaces of the kind {kind} cannot be read")),
        }
    }

    fn axis(&self, r: &mut Record) -> Got<Frame> {
        let origin = self.point(r.int()?)?;
        Frame::along(origin, self.direction(r.int()?)?).map_err(text)
    }

    /// 118.
    fn ruled(&self, entry: &Entry, r: &mut Record) -> Got<SurfaceRef> {
        let rails = [r.int()?, r.int()?];
        let turned = r.int()? == 1;
        // Lines join equal shares of the lengths in form 0, and of the parameters in form 1.
        let even = |n: i64| self.entry(n).is_ok_and(|e| matches!(e.kind, 100 | 110));
        if entry.form == 0 && !rails.iter().all(|n| even(*n)) {
            return Err("a ruled surface between equal lengths of curves of uneven speed".into());
        }
        let first = self.curve(rails[0], DAffine3::IDENTITY)?;
        let mut second = self.curve(rails[1], DAffine3::IDENTITY)?;
        if turned {
            second = Arc::new(Trimmed::reversed(second));
        }
        Ok(Arc::new(ruled(first, second, Dir::U).map_err(text)?))
    }

    /// 120: u along the generatrix, the second parameter the angle.
    fn revolution(&self, r: &mut Record) -> Got<SurfaceRef> {
        let axis = self.curve(r.int()?, DAffine3::IDENTITY)?;
        let profile: CurveRef = on_unit_domain(self.curve(r.int()?, DAffine3::IDENTITY)?);
        let (start, end) = (r.real()?, r.real_or(TAU)?);
        let [from, to] = axis.ends();
        let options = RevolutionOptions {
            start,
            angle: (end - start).min(TAU),
            ..RevolutionOptions::default()
        };
        let axis = Frame::along(from, to - from).map_err(text)?;
        Ok(Arc::new(
            Revolution::new(profile, axis, options).map_err(text)?,
        ))
    }
}

fn positive(x: f64) -> Got<f64> {
    if x > 0.0 {
        Ok(x)
    } else {
        Err(format!("{x} should be greater than zero"))
    }
}

fn endless(e: Elementary, map: DAffine3) -> Got<Sheet> {
    if map == DAffine3::IDENTITY {
        return Ok(Sheet::Endless(e));
    }
    let image = e.transformed(&map);
    image
        .map(Sheet::Endless)
        .ok_or_else(|| "its placement stretches a round surface".into())
}

fn placed(s: SurfaceRef, map: DAffine3) -> Got<SurfaceRef> {
    if map == DAffine3::IDENTITY {
        return Ok(s);
    }
    if let Some(n) = s.to_nurbs() {
        return Ok(Arc::new(n.transformed(&map)));
    }
    Ok(Arc::new(surface::Transformed::new(s, map).map_err(text)?))
}

/// 128. The file has u fastest.
fn nurbs(r: &mut Record) -> Got<NurbsSurface> {
    let k = [r.int()?, r.int()?];
    let m = [r.int()?, r.int()?];
    let [rows, columns] = [
        r.fits(k[0].saturating_add(1), 1)?,
        r.fits(k[1].saturating_add(1), 1)?,
    ];
    let degree = [r.fits(m[0], 1)?, r.fits(m[1], 1)?];
    let count = rows
        .checked_mul(columns)
        .and_then(|n| i64::try_from(n).ok());
    let count = r.fits(count.ok_or("its net is too large")?, 4)?;
    r.skip(5);
    let knots = rows + degree[0] + columns + degree[1] + 2;
    r.has(knots.saturating_add(count.saturating_mul(4)))?;
    let knots = [
        r.reals(rows + degree[0] + 1)?,
        r.reals(columns + degree[1] + 1)?,
    ];
    let weights = r.reals(count)?;
    let points = r.points(count)?;
    let turn = |k: usize| (k % columns) * rows + k / columns;
    let points: Vec<DVec3> = (0..count).map(|k| points[turn(k)]).collect();
    let weights: Vec<f64> = (0..count).map(|k| weights[turn(k)]).collect();
    let ends = r.reals(4)?;
    let s = NurbsSurface::new(degree, knots, &points, some_weights(&weights)).map_err(text)?;
    let domain = s.domain();
    let mut range = [[0.0; 2]; 2];
    let mut part = false;
    for d in 0..2 {
        let slack = SAME_PARAMETER * (domain[d].hi - domain[d].lo);
        let (from, to) = (
            ends[2 * d].max(domain[d].lo),
            ends[2 * d + 1].min(domain[d].hi),
        );
        range[d] = [domain[d].lo, domain[d].hi];
        // Defaults leave both 0.
        if to - from > slack && (from - domain[d].lo > slack || domain[d].hi - to > slack) {
            range[d] = [from, to];
            part = true;
        }
    }
    if part {
        return s.part(range[0], range[1]).map_err(text);
    }
    Ok(s)
}

/// 114: bicubic polynomials over a grid of parameters.
fn spline(r: &mut Record) -> Got<NurbsSurface> {
    r.skip(2);
    let (m, n) = (r.count(48)?, r.count(48)?);
    let at = [r.reals(m + 1)?, r.reals(n + 1)?];
    // After each row there may be a column, and after all a row, that means nothing.
    let cells = m.checked_mul(n).and_then(|c| c.checked_mul(48));
    if cells.is_none_or(|c| c > r.left() + 16) {
        return Err("it has fewer coefficients than its patches need".into());
    }
    let padded = r.left() >= (m * (n + 1)).saturating_mul(48);
    let (rows, columns) = (3 * m + 1, 3 * n + 1);
    let mut net = vec![DVec3::ZERO; rows * columns];
    for i in 0..m {
        for j in 0..n {
            let mut c = [[DVec3::ZERO; 4]; 4];
            for axis in 0..3 {
                for row in &mut c {
                    for term in row.iter_mut() {
                        term[axis] = r.real()?;
                    }
                }
            }
            // `c[l][k]` belongs to sᵏ tˡ.
            let [hu, hv] = [at[0][i + 1] - at[0][i], at[1][j + 1] - at[1][j]];
            let along = c.map(|row| bernstein(row, hu));
            for k in 0..4 {
                let across = bernstein([0, 1, 2, 3].map(|l| along[l][k]), hv);
                for (l, p) in across.into_iter().enumerate() {
                    net[(3 * i + k) * columns + 3 * j + l] = p;
                }
            }
        }
        if padded {
            r.skip(48);
        }
    }
    let knots = at.map(|t| {
        let ends = [t[0], t[t.len() - 1]];
        let inner = t.iter().flat_map(|x| [*x; 3]);
        [ends[0]]
            .into_iter()
            .chain(inner)
            .chain([ends[1]])
            .collect()
    });
    NurbsSurface::new([3, 3], knots, &net, None).map_err(text)
}
