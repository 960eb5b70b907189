//! From homogeneous derivatives to those of a surface, for kernels.

use std::ops::{Add, Div, Mul, Sub};

/// The derivatives of `R.xyz / R.w` from those of R, both placed by [`jet_index`](super::jet_index), for jets of order
/// 0, 1 and 2 (`JET` = 1, 3 and 6). The same operations in the same order as the general quotient rule of the engine,
/// written out so that they stay in registers.
#[inline(always)]
pub(super) fn quotient<S, const JET: usize>(h: &[[S; 4]; JET]) -> [[S; 3]; JET]
where
    S: Copy + Add<Output = S> + Sub<Output = S> + Mul<Output = S> + Div<Output = S>,
{
    let w = h[0][3];
    quotient_with(h, |x| x / w)
}

/// The same where `divide` divides by `R.w`.
#[inline(always)]
pub(super) fn quotient_with<S, const JET: usize>(
    h: &[[S; 4]; JET],
    divide: impl Fn(S) -> S,
) -> [[S; 3]; JET]
where
    S: Copy + Add<Output = S> + Sub<Output = S> + Mul<Output = S>,
{
    let mut r = [[h[0][3]; 3]; JET];
    for c in 0..3 {
        r[0][c] = divide(h[0][c]);
        if JET >= 3 {
            r[1][c] = divide(h[1][c] - r[0][c] * h[1][3]);
            r[2][c] = divide(h[2][c] - r[0][c] * h[2][3]);
        }
        if JET >= 6 {
            let [wu, wv] = [h[1][3], h[2][3]];
            r[3][c] = divide(h[3][c] - r[0][c] * h[3][3] - r[1][c] * (wu + wu));
            r[4][c] = divide(h[4][c] - r[0][c] * h[4][3] - r[2][c] * wu - r[1][c] * wv);
            r[5][c] = divide(h[5][c] - r[0][c] * h[5][3] - r[2][c] * (wv + wv));
        }
    }
    r
}
