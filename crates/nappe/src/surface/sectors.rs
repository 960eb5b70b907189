//! Chashnikov's construction: sectors of a surface of revolution as Coons surfaces.

use super::{Coons, CoonsError, Dir, Surface, check_length, jet_len};
use crate::basis::{Blending, Functions, Turn};
use crate::box3::Box3;
use crate::breaks::{Break, Breaks, Limit, UNIT_BREAKS};
use crate::curve::{Curve, CurveRef, MAX_ORDER, Transformed, on_unit_domain};
use crate::frame::Frame;
use crate::interval::Interval;
use crate::maps::rotation;
use glam::{DAffine3, DMat3, DVec3};
use smallvec::SmallVec;
use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

/// The widest sector. Towards a half turn the blending functions grow without bound; at a quarter they are below 1.
const WIDEST_SECTOR: f64 = FRAC_PI_2;
/// Excess over a whole number of sectors that is taken as rounding.
const WHOLE: f64 = 1e-12;

/// A point, or a vector, carried round an axis: one boundary function of a sector.
#[derive(Clone, Debug)]
struct Carried {
    turn: Turn,
    /// What does not move, what goes with the cosine, what with the sine.
    parts: [DVec3; 3],
}

impl Carried {
    /// `offset` is added after turning: the axis' origin for a point, nothing for a vector.
    fn new(vector: DVec3, offset: DVec3, axis: &Frame, start: f64, angle: f64) -> Self {
        let c = axis.components(vector);
        Self {
            turn: Turn::new(start, angle),
            parts: [
                offset + axis.z() * c.z,
                axis.x() * c.x + axis.y() * c.y,
                axis.y() * c.x - axis.x() * c.y,
            ],
        }
    }
}

impl Curve for Carried {
    fn breaks(&self) -> &[Break] {
        &UNIT_BREAKS
    }

    fn jet_into(&self, t: f64, limit: Limit, out: &mut [DVec3]) {
        let mut f: SmallVec<[f64; 12]> = SmallVec::from_elem(0.0, 3 * out.len());
        self.turn.jet_into(t, limit, out.len() - 1, &mut f);
        for (o, f) in out.iter_mut().zip(f.chunks_exact(3)) {
            *o = self.parts[0] * f[0] + self.parts[1] * f[1] + self.parts[2] * f[2];
        }
    }

    fn enclose_piece(&self, t: Interval, limit: Limit, out: &mut [Box3]) {
        let mut f: SmallVec<[Interval; 12]> = SmallVec::from_elem(Interval::ENTIRE, 3 * out.len());
        self.turn.enclose_piece(t, limit, out.len() - 1, &mut f);
        let part = |k: usize, s: Interval| Box3::point(self.parts[k]).scale(s);
        for (o, f) in out.iter_mut().zip(f.chunks_exact(3)) {
            *o = part(0, f[0]) + part(1, f[1]) + part(2, f[2]);
        }
    }
}

/// Equal sectors of a surface of revolution, each the Coons surface of its eight boundary functions
/// `r, r_u` on u = 0, 1 and `r, r_v` on v = 0, 1 with the trigonometric blending functions of its angle.
///
/// The theorem: it *is* the surface of revolution. u is the profile's parameter brought to `[0, 1]`, v runs evenly over the
/// sectors. Source: Chashnikov 2007, (6) to (8), §4 (whole turns from sectors).
#[derive(Clone, Debug)]
pub(super) struct Sectors {
    parts: Vec<Coons>,
    breaks_v: Vec<Break>,
}

impl Sectors {
    pub(super) fn new(
        profile: &CurveRef,
        axis: &Frame,
        start: f64,
        angle: f64,
    ) -> Result<Self, CoonsError> {
        let profile = on_unit_domain(profile.clone());
        let count = (angle / WIDEST_SECTOR - WHOLE).ceil().max(1.0) as usize;
        let each = angle / count as f64;
        let blend = Blending::trigonometric(each).expect("a sector is a quarter turn at most");
        let ends = [
            profile.jet(0.0, Limit::Above, 1),
            profile.jet(1.0, Limit::Below, 1),
        ];
        let origin = axis.origin();
        let parts = (0..count).map(|k| {
            let from = start + each * k as f64;
            let to = if k + 1 == count {
                start + angle
            } else {
                from + each
            };
            let carried = |v: DVec3, offset: DVec3| -> CurveRef {
                Arc::new(Carried::new(v, offset, axis, from, to - from))
            };
            let f = [
                carried(ends[0].d[0] - origin, origin),
                carried(ends[0].d[1], DVec3::ZERO),
                carried(ends[1].d[1], DVec3::ZERO),
                carried(ends[1].d[0] - origin, origin),
            ];
            let image = |map: DAffine3| -> CurveRef {
                Arc::new(
                    Transformed::new(profile.clone(), map).expect("rotations have finite numbers"),
                )
            };
            // r_v = α a × (r - origin), turned like r.
            let velocity = |angle: f64| {
                let matrix3 = spin(axis.z() * (to - from)) * rotation(axis, angle).matrix3;
                image(DAffine3 {
                    matrix3,
                    translation: -(matrix3 * origin),
                })
            };
            let g = [
                image(rotation(axis, from)),
                velocity(from),
                velocity(to),
                image(rotation(axis, to)),
            ];
            Coons::from_boundary_functions(f, g, blend.clone())
        });
        let parts = parts.collect::<Result<Vec<_>, _>>()?;
        let breaks_v = (0..=count)
            .map(|k| Break::new(k as f64 / count as f64, MAX_ORDER as i32))
            .collect();
        Ok(Self { parts, breaks_v })
    }

    /// The sector at v, and where v is in it.
    fn find(&self, v: f64, limit: Limit) -> (&Coons, usize) {
        let k = self.breaks_v.find(v, limit);
        (&self.parts[k], k)
    }
}

/// The matrix of `x → w × x`.
fn spin(w: DVec3) -> DMat3 {
    DMat3::from_cols(w.cross(DVec3::X), w.cross(DVec3::Y), w.cross(DVec3::Z))
}

/// Multiplies every `∂ⁱᵤ∂ʲᵥ` of a jet by `speed^j`.
fn rescale<T>(order: usize, speed: f64, out: &mut [T], times: impl Fn(&T, f64) -> T) {
    for n in 1..=order {
        for j in 1..=n {
            let at = super::jet_index(n - j, j);
            out[at] = times(&out[at], speed.powi(j as i32));
        }
    }
}

impl Surface for Sectors {
    fn breaks(&self, dir: Dir) -> &[Break] {
        match dir {
            Dir::U => self.parts[0].breaks(Dir::U),
            Dir::V => &self.breaks_v,
        }
    }

    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        let (part, k) = self.find(uv[1], limit[1]);
        let count = self.parts.len() as f64;
        part.jet_into([uv[0], uv[1] * count - k as f64], limit, order, out);
        rescale(order, count, out, |d, s| *d * s);
    }

    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]) {
        let (part, k) = self.find(uv[1].mid(), limit[1]);
        let count = self.parts.len() as f64;
        let v = uv[1] * Interval::point(count) - Interval::point(k as f64);
        part.enclose_piece([uv[0], v], limit, order, out);
        // The number of sectors to a small power is a whole number: exact.
        rescale(order, count, out, |b, s| b.scale(Interval::point(s)));
    }

    fn jets(&self, uv: &[[f64; 2]], order: usize, out: &mut [DVec3]) {
        let (each, count) = (jet_len(order), self.parts.len() as f64);
        check_length(uv.len() * each, out.len());
        let sector: Vec<usize> = uv
            .iter()
            .map(|uv| self.breaks_v.find(uv[1], Limit::Above))
            .collect();
        for (k, part) in self.parts.iter().enumerate() {
            let inside: Vec<usize> = (0..uv.len()).filter(|&i| sector[i] == k).collect();
            let local: Vec<[f64; 2]> = inside
                .iter()
                .map(|&i| [uv[i][0], uv[i][1] * count - k as f64])
                .collect();
            let mut jets = vec![DVec3::ZERO; inside.len() * each];
            part.jets(&local, order, &mut jets);
            for (i, jet) in inside.into_iter().zip(jets.chunks_exact_mut(each)) {
                rescale(order, count, jet, |d, s| *d * s);
                out[i * each..][..each].copy_from_slice(jet);
            }
        }
    }

    fn grid_jets(&self, u: &[f64], v: &[f64], order: usize, out: &mut [DVec3]) {
        let (each, count) = (jet_len(order), self.parts.len() as f64);
        check_length(u.len() * v.len() * each, out.len());
        let mut start = 0;
        // Columns of one sector at a time.
        while start < v.len() {
            let (part, k) = self.find(v[start], Limit::Above);
            let same = |v: &&f64| self.breaks_v.find(**v, Limit::Above) == k;
            let local: Vec<f64> = v[start..]
                .iter()
                .take_while(same)
                .map(|v| v * count - k as f64)
                .collect();
            let mut jets = vec![DVec3::ZERO; local.len() * each];
            for (u, row) in u.iter().zip(out.chunks_exact_mut(v.len() * each)) {
                part.grid_jets(&[*u], &local, order, &mut jets);
                for jet in jets.chunks_exact_mut(each) {
                    rescale(order, count, jet, |d, s| *d * s);
                }
                row[start * each..][..jets.len()].copy_from_slice(&jets);
            }
            start += local.len();
        }
    }
}
