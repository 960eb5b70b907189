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
