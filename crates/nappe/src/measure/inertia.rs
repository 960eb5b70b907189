//! The inertia of a solid.

use super::integral::Measured;
use crate::box3::Box3;
use crate::interval::Interval;
use crate::mesh::Certainty;
use glam::DVec3;

/// The tensor of inertia of a solid of density 1 about its centroid, in the unit of length to the fifth.
///
/// `T = ∫ (|x|² δ - x xᵀ) dV`, x from the centroid: moments of inertia on the diagonal, `∫ (y² + z²) dV` first, products
/// with the minus sign, `-∫ x y dV`, beside it. Source: Goldstein, *Classical mechanics*, §5.3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inertia {
    /// The tensor along the axes x, y and z; symmetric.
    pub tensor: [[Measured; 3]; 3],
    /// The principal moments, increasing.
    pub principal: [Measured; 3],
    /// The principal axes: unit vectors, right-handed. An axis and its negative mean the same.
    pub axes: [DVec3; 3],
    /// By how many radians each axis may be off: π/2 where nothing tells it from another, as for a ball.
    pub turned: [Certainty; 3],
}

type Matrix = [[Interval; 3]; 3];

impl Inertia {
    /// From the second moments `∫ x_i x_j dV` about the centroid.
    pub(super) fn of_moments(m: Matrix, proven: bool) -> Self {
        let tensor: Matrix = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                if i == j {
                    let [a, b] = [(i + 1) % 3, (i + 2) % 3];
                    m[a][a] + m[b][b]
                } else {
                    -m[i][j]
                }
            })
        });
        let (principal, axes, turned) = principal(&tensor);
        let number = |i: Interval| Measured {
            value: i.mid(),
            certainty: certainty(i, proven),
        };
        Self {
            tensor: tensor.map(|row| row.map(number)),
            principal: principal.map(number),
            axes,
            turned: turned.map(|t| {
                if proven {
                    Certainty::Bounded(t)
                } else {
                    Certainty::Estimated(t)
                }
            }),
        }
    }
}

fn certainty(i: Interval, proven: bool) -> Certainty {
    let m = i.mid();
    let error = (i.hi - m).max(m - i.lo).next_up();
    if proven && error.is_finite() {
        Certainty::Bounded(error)
    } else {
        Certainty::Estimated(error)
    }
}

/// Eigenvalues, increasing, and unit vectors with their errors as angles.
///
/// For a unit vector x and a number μ an eigenvalue lies within `|T x - μ x|` of μ, and for orthonormal ones all do, by the
/// norm of all residuals together (Weyl; what is missing to orthonormal is bounded likewise). The angle between x and
/// an eigenvector is at most `asin(|T x - μ x| / gap)`, gap being the distance of μ from the other eigenvalues. Source:
/// Parlett, *The symmetric eigenvalue problem*, chapters 4 and 11.
fn principal(t: &Matrix) -> ([Interval; 3], [DVec3; 3], [f64; 3]) {
    let (values, axes) = jacobi(t.map(|row| row.map(Interval::mid)));
    let rows = t.map(Box3::from);
    let residual = |k: usize| {
        let x = Box3::point(axes[k]);
        let image = Box3::from(rows.map(|r| r.dot(x)));
        (image - x.scale(Interval::point(values[k]))).norm().hi
    };
    let residuals = [0, 1, 2].map(residual);
    let sum = |x: [f64; 3]| {
        let squares = x.map(|x| Interval::point(x).sqr());
        (squares[0] + squares[1] + squares[2]).sqrt().hi
    };
    // `|QᵀQ - 1|`: the orthonormal basis nearest to Q is no farther from it.
    let skew = sum([0, 1, 2].map(|i| {
        sum([0, 1, 2].map(|j| {
            let dot = Box3::point(axes[i]).dot(Box3::point(axes[j]));
            (dot - Interval::point(f64::from(u8::from(i == j)))).mag()
        }))
    }));
    let size = sum(rows.map(|r| r.norm().hi)) + values.iter().fold(0.0, |m, v| v.abs().max(m));
    // With the roundings of these few sums.
    let error = (sum(residuals) + size * skew) * (1.0 + 1e-12);
    let principal = values.map(|v| Interval::point(v).inflate(error));
    let turned = [0, 1, 2].map(|k| {
        let others = [(k + 1) % 3, (k + 2) % 3];
        let gap = others.map(|o| (principal[o] - Interval::point(values[k])).mig());
        let sine = (Interval::point(residuals[k]) / Interval::point(gap[0].min(gap[1]))).hi;
        let length = Box3::point(axes[k]).norm().lo;
        if sine < length {
            Interval::point((sine / length).next_up().min(1.0))
                .asin()
                .hi
        } else {
            std::f64::consts::FRAC_PI_2
        }
    });
    (principal, axes, turned)
}

/// Sweeps of rotations; a symmetric matrix of three rows needs five or six.
const SWEEPS: usize = 30;

/// Eigenvalues, increasing, and a right-handed basis of eigenvectors of a symmetric matrix, by Jacobi's rotations.
fn jacobi(mut a: [[f64; 3]; 3]) -> ([f64; 3], [DVec3; 3]) {
    let mut q = [DVec3::X, DVec3::Y, DVec3::Z];
    if !a.iter().flatten().all(|x| x.is_finite()) {
        return ([f64::NAN; 3], q);
    }
    for _ in 0..SWEEPS {
        for [i, j] in [[0, 1], [0, 2], [1, 2]] {
            if a[i][j] == 0.0 {
                continue;
            }
            let k = 3 - i - j;
            let theta = (a[j][j] - a[i][i]) / (2.0 * a[i][j]);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            let (change, ik, jk) = (t * a[i][j], a[i][k], a[j][k]);
            a[i][i] -= change;
            a[j][j] += change;
            [a[i][j], a[j][i]] = [0.0; 2];
            [a[i][k], a[j][k]] = [c * ik - s * jk, s * ik + c * jk];
            [a[k][i], a[k][j]] = [a[i][k], a[j][k]];
            [q[i], q[j]] = [c * q[i] - s * q[j], s * q[i] + c * q[j]];
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&i, &j| a[i][i].total_cmp(&a[j][j]));
    let values = order.map(|k| a[k][k]);
    let [x, y, z] = order.map(|k| q[k].normalize());
    let z = if x.cross(y).dot(z) < 0.0 { -z } else { z };
    (values, [x, y, z])
}
