//! Registers of four or eight numbers, chosen when the program runs.
//!
//! Kernels are written over [`Registers`], or [`Quads`] where four numbers belong together, so that the compiler cannot
//! take registers apart, and run through [`InstructionSet::run`] or [`with_quads`]. Every instruction set executes the same
//! operations in the same order, without fusing a sum with its product, and so gives the same bits. What
//! [`Registers::div_by`] fuses rounds as a division does.
//!
//! x86-64 has AVX-512 and AVX2 kernels beside the plain one. Elsewhere the plain one runs, compiled for what every
//! machine of the target has: on aarch64 that includes NEON, whose registers of two numbers the compiler fills by itself.

use nappe_stream::{Base, Part, Stores};
use pulp::bytemuck::Pod;
#[cfg(target_arch = "x86_64")]
use pulp::{
    bytemuck::cast,
    x86::{V3, V4},
};
#[cfg(target_arch = "x86_64")]
use std::arch::x86_64::_CMP_GT_OQ;
use std::ops::{Add, Div, Mul, Sub};

/// The length of a register of [`Quads`]: that of AVX2, and the number of homogeneous coordinates of a point.
pub(crate) const QUAD: usize = 4;

/// Arithmetic with several numbers at a time.
pub(crate) trait Registers: Copy {
    /// [`Self::LANES`] numbers in a register.
    type Register: Copy;
    /// The same in memory.
    type Array: Pod + Part;
    const LANES: usize = size_of::<Self::Array>() / size_of::<f64>();
    /// Stores of a register past the caches.
    type Stores: Stores<Self::Array>;
    fn stores(self) -> Self::Stores;
    /// All whole registers of a slice.
    fn arrays(x: &[f64]) -> &[Self::Array];
    fn arrays_mut(x: &mut [f64]) -> &mut [Self::Array];
    fn load(self, x: Self::Array) -> Self::Register;
    fn store(self, x: Self::Register) -> Self::Array;
    fn splat(self, x: f64) -> Self::Register;
    /// `sum + a b`, rounded twice.
    #[inline(always)]
    fn add_product(
        self,
        sum: Self::Register,
        a: Self::Register,
        b: Self::Register,
    ) -> Self::Register {
        self.add(sum, self.mul(a, b))
    }
    /// `sum + a b`, rounded once where the machine can: for what decides, not for results.
    #[inline(always)]
    fn add_product_fused(
        self,
        sum: Self::Register,
        a: Self::Register,
        b: Self::Register,
    ) -> Self::Register {
        self.add_product(sum, a, b)
    }
    fn add(self, a: Self::Register, b: Self::Register) -> Self::Register;
    fn sub(self, a: Self::Register, b: Self::Register) -> Self::Register;
    fn mul(self, a: Self::Register, b: Self::Register) -> Self::Register;
    fn div(self, a: Self::Register, b: Self::Register) -> Self::Register;
    fn sqrt(self, a: Self::Register) -> Self::Register;
    /// `a / b`, the same bits as [`Self::div`], with the rounded `1 / b` at hand, which instruction sets may use whose
    /// divisions are slow. Where both are far from overflow and underflow, see [`far_from_limits`].
    #[inline(always)]
    fn div_by(
        self,
        a: Self::Register,
        b: Self::Register,
        _inverse: Self::Register,
    ) -> Self::Register {
        self.div(a, b)
    }
    fn abs(self, a: Self::Register) -> Self::Register;
    /// In each lane the greater one; b where one is NaN.
    fn max(self, a: Self::Register, b: Self::Register) -> Self::Register;
    /// True if `a > b` in all lanes.
    fn all_greater(self, a: Self::Register, b: Self::Register) -> bool;
    /// In lanes where `a > b` the first of two numbers, else the second one.
    fn where_greater(
        self,
        a: Self::Register,
        b: Self::Register,
        of: [Self::Register; 2],
    ) -> Self::Register;
    /// Points from their coordinates: `x0 y0 z0 x1 …`.
    fn interleave(self, x: [Self::Register; 3]) -> [Self::Array; 3];
    /// Pairs of vectors from their coordinates: `x0 y0 z0 a0 b0 c0 x1 …`.
    fn interleave_pairs(self, x: [Self::Register; 6]) -> [Self::Array; 6];
}

/// Arithmetic with four numbers at a time.
pub(crate) trait Quads:
    Registers<Array = [f64; QUAD], Register = <Self as Quads>::Quad>
{
    /// Four numbers.
    type Quad: Copy;
}

impl<R: Registers<Array = [f64; QUAD]>> Quads for R {
    type Quad = R::Register;
}

/// Four numbers without special instructions.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

impl Registers for Plain {
    type Register = [f64; 4];
    type Array = [f64; 4];
    type Stores = Base;
    #[inline(always)]
    fn stores(self) -> Base {
        Base
    }
    #[inline(always)]
    fn arrays(x: &[f64]) -> &[[f64; 4]] {
        x.as_chunks().0
    }
    #[inline(always)]
    fn arrays_mut(x: &mut [f64]) -> &mut [[f64; 4]] {
        x.as_chunks_mut().0
    }
    #[inline(always)]
    fn load(self, x: [f64; 4]) -> [f64; 4] {
        x
    }
    #[inline(always)]
    fn store(self, x: [f64; 4]) -> [f64; 4] {
        x
    }
    #[inline(always)]
    fn splat(self, x: f64) -> [f64; 4] {
        [x; 4]
    }
    #[inline(always)]
    fn add(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [a[0] + b[0], a[1] + b[1], a[2] + b[2], a[3] + b[3]]
    }
    #[inline(always)]
    fn sub(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [a[0] - b[0], a[1] - b[1], a[2] - b[2], a[3] - b[3]]
    }
    #[inline(always)]
    fn mul(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [a[0] * b[0], a[1] * b[1], a[2] * b[2], a[3] * b[3]]
    }
    #[inline(always)]
    fn div(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [a[0] / b[0], a[1] / b[1], a[2] / b[2], a[3] / b[3]]
    }
    #[inline(always)]
    fn sqrt(self, a: [f64; 4]) -> [f64; 4] {
        [a[0].sqrt(), a[1].sqrt(), a[2].sqrt(), a[3].sqrt()]
    }
    #[inline(always)]
    fn abs(self, a: [f64; 4]) -> [f64; 4] {
        a.map(f64::abs)
    }
    #[inline(always)]
    fn max(self, a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        std::array::from_fn(|l| if a[l] > b[l] { a[l] } else { b[l] })
    }
    #[inline(always)]
    fn all_greater(self, a: [f64; 4], b: [f64; 4]) -> bool {
        (a[0] > b[0]) & (a[1] > b[1]) & (a[2] > b[2]) & (a[3] > b[3])
    }
    #[inline(always)]
    fn where_greater(self, a: [f64; 4], b: [f64; 4], [x, y]: [[f64; 4]; 2]) -> [f64; 4] {
        std::array::from_fn(|l| if a[l] > b[l] { x[l] } else { y[l] })
    }
    #[inline(always)]
    fn interleave(self, [x, y, z]: [[f64; 4]; 3]) -> [[f64; 4]; 3] {
        [
            [x[0], y[0], z[0], x[1]],
            [y[1], z[1], x[2], y[2]],
            [z[2], x[3], y[3], z[3]],
        ]
    }
    #[inline(always)]
    fn interleave_pairs(self, [x, y, z, a, b, c]: [[f64; 4]; 6]) -> [[f64; 4]; 6] {
        [
            [x[0], y[0], z[0], a[0]],
            [b[0], c[0], x[1], y[1]],
            [z[1], a[1], b[1], c[1]],
            [x[2], y[2], z[2], a[2]],
            [b[2], c[2], x[3], y[3]],
            [z[3], a[3], b[3], c[3]],
        ]
    }
}

/// One number: for formulas that are written for registers and wanted for a single place as well.
#[derive(Clone, Copy)]
pub(crate) struct Single;

impl Registers for Single {
    type Register = f64;
    type Array = [f64; 1];
    type Stores = Base;
    #[inline(always)]
    fn stores(self) -> Base {
        Base
    }
    #[inline(always)]
    fn arrays(x: &[f64]) -> &[[f64; 1]] {
        x.as_chunks().0
    }
    #[inline(always)]
    fn arrays_mut(x: &mut [f64]) -> &mut [[f64; 1]] {
        x.as_chunks_mut().0
    }
    #[inline(always)]
    fn load(self, [x]: [f64; 1]) -> f64 {
        x
    }
    #[inline(always)]
    fn store(self, x: f64) -> [f64; 1] {
        [x]
    }
    #[inline(always)]
    fn splat(self, x: f64) -> f64 {
        x
    }
    #[inline(always)]
    fn add(self, a: f64, b: f64) -> f64 {
        a + b
    }
    #[inline(always)]
    fn sub(self, a: f64, b: f64) -> f64 {
        a - b
    }
    #[inline(always)]
    fn mul(self, a: f64, b: f64) -> f64 {
        a * b
    }
    #[inline(always)]
    fn div(self, a: f64, b: f64) -> f64 {
        a / b
    }
    #[inline(always)]
    fn sqrt(self, a: f64) -> f64 {
        a.sqrt()
    }
    #[inline(always)]
    fn abs(self, a: f64) -> f64 {
        a.abs()
    }
    #[inline(always)]
    fn max(self, a: f64, b: f64) -> f64 {
        if a > b { a } else { b }
    }
    #[inline(always)]
    fn all_greater(self, a: f64, b: f64) -> bool {
        a > b
    }
    #[inline(always)]
    fn where_greater(self, a: f64, b: f64, [x, y]: [f64; 2]) -> f64 {
        if a > b { x } else { y }
    }
    #[inline(always)]
    fn interleave(self, x: [f64; 3]) -> [[f64; 1]; 3] {
        x.map(|x| [x])
    }
    #[inline(always)]
    fn interleave_pairs(self, x: [f64; 6]) -> [[f64; 1]; 6] {
        x.map(|x| [x])
    }
}

/// The operations of x86-64 that only differ in their names.
#[cfg(target_arch = "x86_64")]
macro_rules! x86 {
    ($register:ident, $lanes:literal, $set:ident, $splat:ident $add:ident $sub:ident $mul:ident $div:ident $sqrt:ident $max:ident) => {
        type Register = std::arch::x86_64::$register;
        type Array = [f64; $lanes];
        type Stores = Self;
        #[inline(always)]
        fn stores(self) -> Self {
            self
        }
        #[inline(always)]
        fn arrays(x: &[f64]) -> &[Self::Array] {
            x.as_chunks().0
        }
        #[inline(always)]
        fn arrays_mut(x: &mut [f64]) -> &mut [Self::Array] {
            x.as_chunks_mut().0
        }
        #[inline(always)]
        fn load(self, x: Self::Array) -> Self::Register {
            cast(x)
        }
        #[inline(always)]
        fn store(self, x: Self::Register) -> Self::Array {
            cast(x)
        }
        #[inline(always)]
        fn splat(self, x: f64) -> Self::Register {
            self.$set.$splat(x)
        }
        #[inline(always)]
        fn add(self, a: Self::Register, b: Self::Register) -> Self::Register {
            self.$set.$add(a, b)
        }
        #[inline(always)]
        fn sub(self, a: Self::Register, b: Self::Register) -> Self::Register {
            self.$set.$sub(a, b)
        }
        #[inline(always)]
        fn mul(self, a: Self::Register, b: Self::Register) -> Self::Register {
            self.$set.$mul(a, b)
        }
        #[inline(always)]
        fn div(self, a: Self::Register, b: Self::Register) -> Self::Register {
            self.$set.$div(a, b)
        }
        #[inline(always)]
        fn sqrt(self, a: Self::Register) -> Self::Register {
            self.$set.$sqrt(a)
        }
        #[inline(always)]
        fn max(self, a: Self::Register, b: Self::Register) -> Self::Register {
            self.$set.$max(a, b)
        }
    };
}

#[cfg(target_arch = "x86_64")]
impl Registers for V3 {
    x86!(__m256d, 4, avx, _mm256_set1_pd _mm256_add_pd _mm256_sub_pd _mm256_mul_pd _mm256_div_pd _mm256_sqrt_pd _mm256_max_pd);

    #[inline(always)]
    fn add_product_fused(
        self,
        sum: Self::Register,
        a: Self::Register,
        b: Self::Register,
    ) -> Self::Register {
        self.fma._mm256_fmadd_pd(a, b, sum)
    }
    #[inline(always)]
    fn abs(self, a: Self::Register) -> Self::Register {
        self.avx._mm256_andnot_pd(self.splat(-0.0), a)
    }
    #[inline(always)]
    fn all_greater(self, a: Self::Register, b: Self::Register) -> bool {
        let greater = self.avx._mm256_cmp_pd::<_CMP_GT_OQ>(a, b);
        self.avx._mm256_movemask_pd(greater) == 0b1111
    }
    #[inline(always)]
    fn where_greater(
        self,
        a: Self::Register,
        b: Self::Register,
        [x, y]: [Self::Register; 2],
    ) -> Self::Register {
        let greater = self.avx._mm256_cmp_pd::<_CMP_GT_OQ>(a, b);
        self.avx._mm256_blendv_pd(y, x, greater)
    }
    #[inline(always)]
    fn interleave(self, [x, y, z]: [Self::Register; 3]) -> [[f64; 4]; 3] {
        let avx = self.avx;
        let xy = avx._mm256_unpacklo_pd(x, y); // x0 y0 x2 y2
        let yz = avx._mm256_unpackhi_pd(y, z); // y1 z1 y3 z3
        let zx = avx._mm256_shuffle_pd::<0b1010>(z, x); // z0 x1 z2 x3
        [
            cast(avx._mm256_permute2f128_pd::<0x20>(xy, zx)),
            cast(avx._mm256_blend_pd::<0b1100>(yz, xy)),
            cast(avx._mm256_permute2f128_pd::<0x31>(zx, yz)),
        ]
    }
    #[inline(always)]
    fn interleave_pairs(self, [x, y, z, a, b, c]: [Self::Register; 6]) -> [[f64; 4]; 6] {
        let avx = self.avx;
        let (xy0, xy1) = (avx._mm256_unpacklo_pd(x, y), avx._mm256_unpackhi_pd(x, y)); // x0 y0 x2 y2, x1 y1 x3 y3
        let (za0, za1) = (avx._mm256_unpacklo_pd(z, a), avx._mm256_unpackhi_pd(z, a));
        let (bc0, bc1) = (avx._mm256_unpacklo_pd(b, c), avx._mm256_unpackhi_pd(b, c));
        [
            cast(avx._mm256_permute2f128_pd::<0x20>(xy0, za0)),
            cast(avx._mm256_permute2f128_pd::<0x20>(bc0, xy1)),
            cast(avx._mm256_permute2f128_pd::<0x20>(za1, bc1)),
            cast(avx._mm256_permute2f128_pd::<0x31>(xy0, za0)),
            cast(avx._mm256_permute2f128_pd::<0x31>(bc0, xy1)),
            cast(avx._mm256_permute2f128_pd::<0x31>(za1, bc1)),
        ]
    }
}

#[cfg(target_arch = "x86_64")]
impl Registers for V4 {
    x86!(__m512d, 8, avx512f, _mm512_set1_pd _mm512_add_pd _mm512_sub_pd _mm512_mul_pd _mm512_div_pd _mm512_sqrt_pd _mm512_max_pd);

    #[inline(always)]
    fn add_product_fused(
        self,
        sum: Self::Register,
        a: Self::Register,
        b: Self::Register,
    ) -> Self::Register {
        self.avx512f._mm512_fmadd_pd(a, b, sum)
    }
    /// Eight divisions take sixteen cycles, five fused multiply-adds two and a half. By a theorem of Markstein
    /// (Handbook of Floating-Point Arithmetic, 2nd ed., 4.7.1) `q + (a - q b) inverse`, fused, is the rounded quotient
    /// if q is within a unit in the last place and the inverse is rounded to nearest; `a inverse` may be off by one
    /// and a half, and its own correction is within one.
    #[inline(always)]
    fn div_by(
        self,
        a: Self::Register,
        b: Self::Register,
        inverse: Self::Register,
    ) -> Self::Register {
        let f = self.avx512f;
        let mut q = f._mm512_mul_pd(a, inverse);
        for _ in 0..2 {
            q = f._mm512_fmadd_pd(f._mm512_fnmadd_pd(q, b, a), inverse, q);
        }
        q
    }
    #[inline(always)]
    fn abs(self, a: Self::Register) -> Self::Register {
        self.avx512f._mm512_abs_pd(a)
    }
    #[inline(always)]
    fn all_greater(self, a: Self::Register, b: Self::Register) -> bool {
        self.avx512f._mm512_cmp_pd_mask::<_CMP_GT_OQ>(a, b) == 0xFF
    }
    #[inline(always)]
    fn where_greater(
        self,
        a: Self::Register,
        b: Self::Register,
        [x, y]: [Self::Register; 2],
    ) -> Self::Register {
        let greater = self.avx512f._mm512_cmp_pd_mask::<_CMP_GT_OQ>(a, b);
        self.avx512f._mm512_mask_blend_pd(greater, y, x)
    }
    #[inline(always)]
    fn interleave(self, [x, y, z]: [Self::Register; 3]) -> [[f64; 8]; 3] {
        // Places 0 to 7 are those of the first register, 8 to 15 those of the second.
        let pick = |a, b, places: [u64; 8]| self.avx512f._mm512_permutex2var_pd(a, cast(places), b);
        let xy = [
            pick(x, y, [0, 8, 0, 1, 9, 0, 2, 10]),
            pick(x, y, [0, 3, 11, 0, 4, 12, 0, 5]),
            pick(x, y, [13, 0, 6, 14, 0, 7, 15, 0]),
        ];
        [
            cast(pick(xy[0], z, [0, 1, 8, 3, 4, 9, 6, 7])),
            cast(pick(xy[1], z, [10, 1, 2, 11, 4, 5, 12, 7])),
            cast(pick(xy[2], z, [0, 13, 2, 3, 14, 5, 6, 15])),
        ]
    }
    #[inline(always)]
    fn interleave_pairs(self, [x, y, z, a, b, c]: [Self::Register; 6]) -> [[f64; 8]; 6] {
        let f = self.avx512f;
        // As with AVX2 in both halves, whose results then come one after the other.
        let (xy0, xy1) = (f._mm512_unpacklo_pd(x, y), f._mm512_unpackhi_pd(x, y));
        let (za0, za1) = (f._mm512_unpacklo_pd(z, a), f._mm512_unpackhi_pd(z, a));
        let (bc0, bc1) = (f._mm512_unpacklo_pd(b, c), f._mm512_unpackhi_pd(b, c));
        let pick = |a, b, places: [u64; 8]| f._mm512_permutex2var_pd(a, cast(places), b);
        const LOW: [u64; 8] = [0, 1, 8, 9, 4, 5, 12, 13];
        const HIGH: [u64; 8] = [2, 3, 10, 11, 6, 7, 14, 15];
        let low = [
            pick(xy0, za0, LOW),
            pick(bc0, xy1, LOW),
            pick(za1, bc1, LOW),
        ];
        let high = [
            pick(xy0, za0, HIGH),
            pick(bc0, xy1, HIGH),
            pick(za1, bc1, HIGH),
        ];
        [
            cast(f._mm512_shuffle_f64x2::<0x44>(low[0], low[1])),
            cast(f._mm512_shuffle_f64x2::<0x44>(low[2], high[0])),
            cast(f._mm512_shuffle_f64x2::<0x44>(high[1], high[2])),
            cast(f._mm512_shuffle_f64x2::<0xEE>(low[0], low[1])),
            cast(f._mm512_shuffle_f64x2::<0xEE>(low[2], high[0])),
            cast(f._mm512_shuffle_f64x2::<0xEE>(high[1], high[2])),
        ]
    }
}

/// True for numbers that sums of products of two such numbers, and quotients of such sums, can be computed from by
/// [`Registers::div_by`]: zero, and those from 2⁻¹⁰⁰ to 2¹⁰⁰.
///
/// With a, b such sums, `2⁻²⁵³ <= |a|, |b| <= 2²¹⁰` unless zero (a sum is a multiple of the last place of its terms), and
/// so is `a / b` within 2⁻⁴⁶³ and 2⁴⁶³; for a third and fourth sum c, d `c - (a / b) d` within 2⁻⁷⁶⁹ and 2⁶⁷⁴. Remainders
/// of quotients of these by b, 2⁻¹⁰⁶ times as large, are still normal numbers. Zeros come out positive, as sums that
/// start from zero are.
pub(crate) fn far_from_limits(x: f64) -> bool {
    const LIMIT: f64 = (1u128 << 100) as f64;
    x == 0.0 || (1.0 / LIMIT..=LIMIT).contains(&x.abs())
}

/// A register with its instructions, so that formulas can be written with operators.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<R: Registers>(pub(crate) R, pub(crate) R::Register);

impl<R: Registers> Lanes<R> {
    /// The same number in all lanes.
    #[inline(always)]
    pub(crate) fn splat(r: R, x: f64) -> Self {
        Self(r, r.splat(x))
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self(self.0, self.0.sqrt(self.1))
    }

    /// [`Registers::add_product_fused`].
    #[inline(always)]
    pub(crate) fn plus_fused(self, a: Self, b: Self) -> Self {
        Self(self.0, self.0.add_product_fused(self.1, a.1, b.1))
    }

    /// [`Registers::div_by`].
    #[inline(always)]
    pub(crate) fn div_by(self, other: Self, inverse: Self) -> Self {
        Self(self.0, self.0.div_by(self.1, other.1, inverse.1))
    }

    /// The numbers of a slice, which is a register long.
    #[inline(always)]
    pub(crate) fn load(r: R, x: &[f64]) -> Self {
        Self(r, r.load(R::arrays(x)[0]))
    }

    #[inline(always)]
    pub(crate) fn store(self, out: &mut [f64]) {
        R::arrays_mut(out)[0] = self.0.store(self.1);
    }

    #[inline(always)]
    pub(crate) fn abs(self) -> Self {
        Self(self.0, self.0.abs(self.1))
    }

    /// In each lane the greater one; `other` where one is NaN.
    #[inline(always)]
    pub(crate) fn max(self, other: Self) -> Self {
        Self(self.0, self.0.max(self.1, other.1))
    }

    /// In lanes that are greater than those of `other` the first of two numbers, else the second one.
    #[inline(always)]
    pub(crate) fn where_greater(self, other: Self, of: [Self; 2]) -> Self {
        let [x, y] = [of[0].1, of[1].1];
        Self(self.0, self.0.where_greater(self.1, other.1, [x, y]))
    }

    /// True if all lanes are greater than those of `other`.
    #[inline(always)]
    pub(crate) fn exceeds(self, other: Self) -> bool {
        self.0.all_greater(self.1, other.1)
    }
}

macro_rules! operator {
    ($trait:ident $method:ident) => {
        impl<R: Registers> $trait for Lanes<R> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0, self.0.$method(self.1, other.1))
            }
        }
    };
}

impl<R: Registers> Mul<f64> for Lanes<R> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: f64) -> Self {
        self * Self::splat(self.0, factor)
    }
}

operator!(Add add);
operator!(Sub sub);
operator!(Mul mul);
operator!(Div div);

/// `a · b`, summed as [`DVec3::dot`](glam::DVec3::dot) does.
#[inline(always)]
pub(crate) fn dot<R: Registers>(a: &[Lanes<R>; 3], b: &[Lanes<R>; 3]) -> Lanes<R> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// `a × b`, as [`DVec3::cross`](glam::DVec3::cross).
#[inline(always)]
pub(crate) fn cross<R: Registers>(a: &[Lanes<R>; 3], b: &[Lanes<R>; 3]) -> [Lanes<R>; 3] {
    [
        a[1] * b[2] - b[1] * a[2],
        a[2] * b[0] - b[2] * a[0],
        a[0] * b[1] - b[0] * a[1],
    ]
}

/// A computation with [`Registers`] of any kind; `run` must be inlined.
pub(crate) trait Kernel {
    fn run<R: Registers>(self, r: R);
}

/// A computation with [`Quads`] of any kind; `run` must be inlined.
pub(crate) trait QuadKernel {
    fn run<Q: Quads>(self, q: Q);
}

/// What a machine has.
#[derive(Clone, Copy)]
pub(crate) enum InstructionSet {
    Plain,
    #[cfg(target_arch = "x86_64")]
    Avx2(V3),
    #[cfg(target_arch = "x86_64")]
    Avx512(V4),
}

impl InstructionSet {
    /// Those of this machine, the best first.
    pub(crate) fn all() -> impl Iterator<Item = Self> {
        #[cfg(target_arch = "x86_64")]
        let special = [
            V4::try_new().map(Self::Avx512),
            V3::try_new().map(Self::Avx2),
        ];
        #[cfg(not(target_arch = "x86_64"))]
        let special: [Option<Self>; 0] = [];
        special.into_iter().flatten().chain([Self::Plain])
    }

    pub(crate) fn best() -> Self {
        Self::all().next().unwrap_or(Self::Plain)
    }

    /// Runs a kernel.
    pub(crate) fn run(self, kernel: impl Kernel) {
        match self {
            Self::Plain => kernel.run(Plain),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(simd) => pulp::Simd::vectorize(
                simd,
                #[inline(always)]
                || kernel.run(simd),
            ),
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(simd) => pulp::Simd::vectorize(
                simd,
                #[inline(always)]
                || kernel.run(simd),
            ),
        }
    }
}

/// Runs a kernel with the quads of the machine.
pub(crate) fn with_quads(kernel: impl QuadKernel) {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = V3::try_new() {
        return pulp::Simd::vectorize(
            simd,
            #[inline(always)]
            || kernel.run(simd),
        );
    }
    kernel.run(Plain);
}

/// Runs a computation of plain loops, which the compiler fills with registers as long as AVX2's where the machine has them; it must be
/// inlined.
#[inline]
pub(crate) fn vectorized<R>(work: impl FnOnce() -> R) -> R {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = V3::try_new() {
        return pulp::Simd::vectorize(simd, work);
    }
    work()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::Random;

    struct Quotients<'a> {
        a: &'a [f64],
        b: &'a [f64],
        out: &'a mut [f64],
    }

    impl Kernel for Quotients<'_> {
        #[inline(always)]
        fn run<R: Registers>(self, r: R) {
            let pairs = R::arrays(self.a).iter().zip(R::arrays(self.b));
            for (out, (&a, &b)) in R::arrays_mut(self.out).iter_mut().zip(pairs) {
                let (a, b) = (r.load(a), r.load(b));
                let inverse = r.div(r.splat(1.0), b);
                *out = r.store(r.div_by(a, b, inverse));
            }
        }
    }

    /// Over the whole range of [`far_from_limits`]; fractions of any length, and next to powers of two, where the
    /// relative errors of roundings are greatest.
    #[test]
    fn quotients_round_as_divisions_do() {
        let mut random = Random(11);
        let mut number = |low: f64, high: f64| {
            let exponent = (low + (high - low) * random.unit()).round() as i32;
            let fraction = match (4.0 * random.unit()) as u32 {
                0 => 1.0 + (16.0 * random.unit()).floor() * f64::EPSILON,
                1 => 2.0 - (16.0 * random.unit() + 1.0).floor() * f64::EPSILON,
                _ => 1.0 + random.unit(),
            };
            fraction * 2f64.powi(exponent)
        };
        let n = 400_000;
        let b: Vec<f64> = (0..n).map(|_| number(-253.0, 209.0)).collect();
        let near = (0..n / 2).map(|k| number(-8.0, 8.0) * b[k]);
        let mut a: Vec<f64> = near.collect();
        a.extend((0..n / 2).map(|_| -number(-768.0, 673.0)));
        a[n / 2] = 0.0;
        for set in InstructionSet::all() {
            let mut out = vec![0.0; n];
            let (a, b) = (&a, &b);
            set.run(Quotients {
                a,
                b,
                out: &mut out,
            });
            for k in 0..n {
                let exact = a[k] / b[k];
                assert_eq!(out[k].to_bits(), exact.to_bits(), "{:e} / {:e}", a[k], b[k]);
            }
        }
    }
}
