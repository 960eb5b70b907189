//! The widest vector instructions of the machine, chosen when the program runs.

/// Runs `kernel` compiled for the widest instruction set there is: on x86-64 AVX-512, AVX2 or the baseline, on 64-bit
/// Arm NEON. The kernel and all it calls must be inlined (`#[inline(always)]`), else they stay at the baseline.
///
/// A kernel is ordinary Rust: every instruction set executes the same operations in the same order, without fusing a
/// product with a sum, and so gives the same bits as a plain call.
#[inline]
pub(crate) fn widest<R>(kernel: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(kernel)
}

/// How many numbers kernels take together: one register of AVX-512, two of AVX2, four of the baseline and NEON.
pub(crate) const LANES: usize = 8;

/// Numbers that take the same steps together.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lanes(pub(crate) [f64; LANES]);

impl Lanes {
    pub(crate) const ZERO: Self = Self([0.0; LANES]);
}

impl From<f64> for Lanes {
    #[inline(always)]
    fn from(x: f64) -> Self {
        Self([x; LANES])
    }
}

macro_rules! lanewise {
    ($trait:ident $method:ident $op:tt) => {
        impl std::ops::$trait for Lanes {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                let mut out = self;
                for l in 0..LANES {
                    out.0[l] = self.0[l] $op other.0[l];
                }
                out
            }
        }
    };
}

lanewise!(Add add +);
lanewise!(Sub sub -);
lanewise!(Mul mul *);
lanewise!(Div div /);

/// Sums of products in registers of four numbers, written so that the compiler cannot take them apart: kernels that
/// work on one point at a time would otherwise be shuffled to pieces.
pub(crate) trait Quads: Copy {
    /// Four numbers.
    type Quad: Copy;
    fn load(self, x: [f64; 4]) -> Self::Quad;
    fn store(self, x: Self::Quad) -> [f64; 4];
    fn splat(self, x: f64) -> Self::Quad;
    /// `sum + a b`, rounded twice.
    fn add_product(self, sum: Self::Quad, a: Self::Quad, b: Self::Quad) -> Self::Quad;
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
    fn add_product(self, s: [f64; 4], a: [f64; 4], b: [f64; 4]) -> [f64; 4] {
        [
            s[0] + a[0] * b[0],
            s[1] + a[1] * b[1],
            s[2] + a[2] * b[2],
            s[3] + a[3] * b[3],
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
    fn add_product(self, sum: Self::Quad, a: Self::Quad, b: Self::Quad) -> Self::Quad {
        self.avx._mm256_add_pd(sum, self.avx._mm256_mul_pd(a, b))
    }
}

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
