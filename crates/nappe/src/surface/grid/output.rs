//! What is made of the derivatives of points, and written.

use super::places::To;
use crate::breaks::Limit;
use crate::simd::{Lanes, Registers, Single, cross, dot};
use crate::surface::normal::all_plain;
use crate::surface::{Separable, normal_at};
use glam::DVec3;
use pulp::bytemuck::{cast_slice, cast_slice_mut};

/// What is made of the derivatives of a point.
pub(super) trait Output<R: Registers, const JET: usize> {
    /// How many numbers a point takes.
    const EACH: usize;
    /// Writes a register of points of a row from the first one's column and their derivatives without the surface's
    /// origin. Lanes behind the last column of the row repeat it.
    fn put(&self, row: usize, column: usize, x: &[[Lanes<R>; 3]; JET], to: &mut To<R>);
}

pub(super) struct JetOutput<R> {
    pub(super) r: R,
    pub(super) origin: DVec3,
}

impl<R: Registers, const JET: usize> Output<R, JET> for JetOutput<R> {
    const EACH: usize = 3 * JET;

    #[inline(always)]
    fn put(&self, _: usize, _: usize, x: &[[Lanes<R>; 3]; JET], to: &mut To<R>) {
        let points = self.r.interleave(numbers(&moved(&x[0], self.origin)));
        if JET == 1 {
            return to.registers(self.r, points);
        }
        to.numbers(
            self.r,
            3 * JET * R::LANES,
            #[inline(always)]
            |out| {
                for k in 0..JET {
                    let vectors = if k == 0 {
                        points
                    } else {
                        self.r.interleave(numbers(&x[k]))
                    };
                    let jets = out.as_chunks_mut::<3>().0.chunks_exact_mut(JET);
                    for (jet, x) in jets.zip(cast_slice(&vectors)) {
                        jet[k] = *x;
                    }
                }
            },
        );
    }
}

pub(super) struct NormalOutput<'a, R> {
    pub(super) r: R,
    pub(super) surface: &'a Separable,
    pub(super) uv: [&'a [f64]; 2],
    /// Some more for v, since a block may reach beyond the end.
    pub(super) widths: [Vec<f64>; 2],
}

impl<R: Registers> Output<R, 3> for NormalOutput<'_, R> {
    const EACH: usize = 6;

    #[inline(always)]
    fn put(&self, row: usize, column: usize, x: &[[Lanes<R>; 3]; 3], to: &mut To<R>) {
        let r = self.r;
        let [du, dv] = &self.widths;
        let dv = R::arrays(&dv[column..][..R::LANES])[0];
        let (du, dv) = (Lanes::splat(r, du[row]), Lanes(r, r.load(dv)));
        let at = moved(&x[0], self.surface.origin());
        let a = [x[1][0] * du, x[1][1] * du, x[1][2] * du];
        let b = [x[2][0] * dv, x[2][1] * dv, x[2][2] * dv];
        let n = cross(&a, &b);
        let nn = dot(&n, &n);
        let inverse = Lanes::splat(r, 1.0) / nn.sqrt();
        let mut n = [n[0] * inverse, n[1] * inverse, n[2] * inverse];
        if !all_plain(nn, &a, &b, &at) {
            let (mut normals, taken) = (stored(&n), [&a, &b, &at].map(stored));
            self.replace(
                [row, column],
                cast_slice_mut(&mut normals),
                cast_slice(&stored(&[nn])),
                taken.each_ref().map(|x| cast_slice(x)),
            );
            n = normals.map(|x| Lanes(r, r.load(x)));
        }
        let pairs = numbers(&[at[0], at[1], at[2], n[0], n[1], n[2]]);
        to.registers(r, r.interleave_pairs(pairs));
    }
}

impl<R> NormalOutput<'_, R> {
    /// Replaces the normals of points that may have none: `normals` holds a coordinate of all lanes after the other, and so
    /// does each of what [`all_plain`] takes.
    #[cold]
    #[inline(never)]
    fn replace(
        &self,
        [row, column]: [usize; 2],
        normals: &mut [f64],
        cross: &[f64],
        taken: [&[f64]; 3],
    ) {
        let ([u, v], lanes) = (self.uv, cross.len());
        for (lane, &v) in v[column..].iter().take(lanes).enumerate() {
            let one = |x: f64| Lanes::splat(Single, x);
            let [a, b, point] = taken.map(|x| [0, 1, 2].map(|c| one(x[c * lanes + lane])));
            if !all_plain(one(cross[lane]), &a, &b, &point) {
                let normal = normal_at(self.surface, [u[row], v], [Limit::Above; 2]);
                let normal = normal.vector().unwrap_or(DVec3::ZERO).to_array();
                for c in 0..3 {
                    normals[c * lanes + lane] = normal[c];
                }
            }
        }
    }
}

/// Registers in memory.
#[inline(always)]
fn stored<R: Registers, const N: usize>(x: &[Lanes<R>; N]) -> [R::Array; N] {
    let mut stored = [x[0].0.store(x[0].1); N];
    for k in 1..N {
        stored[k] = x[k].0.store(x[k].1);
    }
    stored
}

/// The numbers of a vector in all lanes.
#[inline(always)]
fn numbers<R: Registers, const N: usize>(x: &[Lanes<R>; N]) -> [R::Register; N] {
    let mut numbers = [x[0].1; N];
    for c in 0..N {
        numbers[c] = x[c].1;
    }
    numbers
}

/// `x + origin`.
#[inline(always)]
fn moved<R: Registers>(x: &[Lanes<R>; 3], origin: DVec3) -> [Lanes<R>; 3] {
    [
        x[0] + Lanes::splat(x[0].0, origin.x),
        x[1] + Lanes::splat(x[0].0, origin.y),
        x[2] + Lanes::splat(x[0].0, origin.z),
    ]
}
