//! Registers of four numbers, chosen when the program runs.
//!
//! Kernels are written over [`Quads`], so that the compiler cannot take registers apart, and run through
//! [`with_quads`]. Every instruction set executes the same operations in the same order, without fusing a product with
//! a sum, and so gives the same bits.

use std::ops::{Add, Div, Mul, Sub};

/// The length of a register: that of AVX2, and the number of homogeneous coordinates of a point.
pub(crate) const QUAD: usize = 4;

/// Arithmetic with four numbers at a time.
pub(crate) trait Quads: Copy {
    /// Four numbers.
    type Quad: Copy;
    fn load(self, x: [f64; 4]) -> Self::Quad;
    fn store(self, x: Self::Quad) -> [f64; 4];
    fn splat(self, x: f64) -> Self::Quad;
    /// `sum + a b`, rounded twice.
    #[inline(always)]
    fn add_product(self, sum: Self::Quad, a: Self::Quad, b: Self::Quad) -> Self::Quad {
        self.add(sum, self.mul(a, b))
    }
    fn add(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;
    fn sub(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;
    fn mul(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;
    fn div(self, a: Self::Quad, b: Self::Quad) -> Self::Quad;
    fn sqrt(self, a: Self::Quad) -> Self::Quad;
    /// Four points from their coordinates: `x0 y0 z0 x1 …`.
    fn interleave(self, x: Self::Quad, y: Self::Quad, z: Self::Quad) -> [[f64; 4]; 3];
}

/// Four numbers without special instructions.
#[derive(Clone, Copy)]
pub(crate) struct Plain;

impl Quads for Plain {
    type Quad = [f64; 4];
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
    fn interleave(self, x: [f64; 4], y: [f64; 4], z: [f64; 4]) -> [[f64; 4]; 3] {
        [
            [x[0], y[0], z[0], x[1]],
            [y[1], z[1], x[2], y[2]],
            [z[2], x[3], y[3], z[3]],
        ]
    }
}

#[cfg(target_arch = "x86_64")]
impl Quads for pulp::x86::V3 {
    type Quad = std::arch::x86_64::__m256d;
    #[inline(always)]
    fn load(self, x: [f64; 4]) -> Self::Quad {
        pulp::bytemuck::cast(x)
    }
    #[inline(always)]
    fn store(self, x: Self::Quad) -> [f64; 4] {
        pulp::bytemuck::cast(x)
    }
    #[inline(always)]
    fn splat(self, x: f64) -> Self::Quad {
        self.avx._mm256_set1_pd(x)
    }
    #[inline(always)]
    fn add(self, a: Self::Quad, b: Self::Quad) -> Self::Quad {
        self.avx._mm256_add_pd(a, b)
    }
    #[inline(always)]
    fn sub(self, a: Self::Quad, b: Self::Quad) -> Self::Quad {
        self.avx._mm256_sub_pd(a, b)
    }
    #[inline(always)]
    fn mul(self, a: Self::Quad, b: Self::Quad) -> Self::Quad {
        self.avx._mm256_mul_pd(a, b)
    }
    #[inline(always)]
    fn div(self, a: Self::Quad, b: Self::Quad) -> Self::Quad {
        self.avx._mm256_div_pd(a, b)
    }
    #[inline(always)]
    fn sqrt(self, a: Self::Quad) -> Self::Quad {
        self.avx._mm256_sqrt_pd(a)
    }
    #[inline(always)]
    fn interleave(self, x: Self::Quad, y: Self::Quad, z: Self::Quad) -> [[f64; 4]; 3] {
        let avx = self.avx;
        let xy = avx._mm256_unpacklo_pd(x, y); // x0 y0 x2 y2
        let yz = avx._mm256_unpackhi_pd(y, z); // y1 z1 y3 z3
        let zx = avx._mm256_shuffle_pd::<0b1010>(z, x); // z0 x1 z2 x3
        [
            avx._mm256_permute2f128_pd::<0x20>(xy, zx),
            avx._mm256_blend_pd::<0b1100>(yz, xy),
            avx._mm256_permute2f128_pd::<0x31>(zx, yz),
        ]
        .map(pulp::bytemuck::cast)
    }
}

/// A register with its instructions, so that formulas can be written with operators.
#[derive(Clone, Copy)]
pub(crate) struct Lanes<Q: Quads>(pub(crate) Q, pub(crate) Q::Quad);

impl<Q: Quads> Lanes<Q> {
    /// The same number in all lanes.
    #[inline(always)]
    pub(crate) fn splat(q: Q, x: f64) -> Self {
        Self(q, q.splat(x))
    }

    #[inline(always)]
    pub(crate) fn sqrt(self) -> Self {
        Self(self.0, self.0.sqrt(self.1))
    }

    #[inline(always)]
    pub(crate) fn store(self) -> [f64; QUAD] {
        self.0.store(self.1)
    }
}

macro_rules! operator {
    ($trait:ident $method:ident) => {
        impl<Q: Quads> $trait for Lanes<Q> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self(self.0, self.0.$method(self.1, other.1))
            }
        }
    };
}

operator!(Add add);
operator!(Sub sub);
operator!(Mul mul);
operator!(Div div);

/// A computation with [`Quads`] of any kind; `run` must be inlined.
pub(crate) trait QuadKernel {
    fn run<Q: Quads>(self, q: Q);
}

/// Runs a kernel with the registers of the machine.
pub(crate) fn with_quads(kernel: impl QuadKernel) {
    #[cfg(target_arch = "x86_64")]
    if let Some(simd) = pulp::x86::V3::try_new() {
        return pulp::Simd::vectorize(
            simd,
            #[inline(always)]
            || kernel.run(simd),
        );
    }
    kernel.run(Plain);
}
