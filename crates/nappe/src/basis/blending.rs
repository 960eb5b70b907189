//! Blending functions of Coons surfaces.

use super::{BSplineBasis, Functions, FunctionsRef, Hermite, Trigonometric, TrigonometricError};
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use std::fmt;
use std::sync::Arc;
use thiserror::Error;

/// A condition `L_i(H_j) = δ_ij` that blending functions miss.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlendingFault {
    /// Which function, 1 to 4 (1 and 4 if there are only two).
    pub function: usize,
    /// Which functional: 1 is the value at 0, 2 the derivative at 0, 3 the derivative at 1, 4 the value at 1.
    pub functional: usize,
    /// What it should be, 0 or 1.
    pub expected: f64,
    /// What it is.
    pub value: f64,
}

impl fmt::Display for BlendingFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let at = ["(0)", "'(0)", "'(1)", "(1)"][(self.functional - 1).min(3)];
        let (h, value, expected) = (self.function, self.value, self.expected);
        write!(f, "h{h}{at} is {value}, it must be {expected}")
    }
}

/// Why functions cannot blend.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum BlendingError {
    /// Neither two nor four functions.
    #[error(
        "blending needs 2 functions (positions only) or 4 (positions and tangents), {count} are given"
    )]
    Count {
        /// How many there are.
        count: usize,
    },
    /// Not over `[0, 1]`.
    #[error("blending functions run over [{}, {}], they must run over [0, 1]", domain.lo, domain.hi)]
    Domain {
        /// Their domain.
        domain: Interval,
    },
    /// Some conditions are missed; all of them are listed.
    #[error("the blending functions do not fit: {}", list(faults))]
    Conditions {
        /// Every condition that is missed.
        faults: Vec<BlendingFault>,
    },
    /// The angle of trigonometric blending.
    #[error(transparent)]
    Angle(#[from] TrigonometricError),
}

fn list(faults: &[BlendingFault]) -> String {
    let all: Vec<String> = faults.iter().map(BlendingFault::to_string).collect();
    all.join("; ")
}

/// The blending functions of a Coons surface: H1 and H4 for positions at 0 and 1, and, unless only positions are
/// blended, H2 and H3 for derivatives at 0 and 1. `L_i(H_j) = δ_ij` for `L1 f = f(0), L2 f = f'(0), L3 f = f'(1),
/// L4 f = f(1)`. Quintic blending has two more, between H2 and H3, for second derivatives at 0 and 1.
///
/// Source: Chashnikov, "A surface of revolution as a Coons surface" (2007), §1.
#[derive(Clone, Debug)]
pub struct Blending {
    functions: FunctionsRef,
    affine: bool,
}

impl Blending {
    /// How far `L_i(H_j)` may be from `δ_ij`. A surface misses its boundary data by this part of its size; smaller,
    /// and functions written with a dozen digits would be refused.
    pub const TOLERANCE: f64 = 1e-11;

    /// `1-t` and `t`: positions only.
    pub fn linear() -> Self {
        Self {
            functions: Arc::new(BSplineBasis::bernstein(1)),
            affine: true,
        }
    }

    /// The cubic Hermite functions.
    pub fn cubic() -> Self {
        Self {
            functions: Arc::new(Hermite::new()),
            affine: true,
        }
    }

    /// The quintic Hermite functions: positions, first and second derivatives.
    pub fn quintic() -> Self {
        Self {
            functions: Arc::new(Hermite::of_orders([2, 2])),
            affine: true,
        }
    }

    /// Chashnikov's functions for an angle in radians, see [`Trigonometric`].
    pub fn trigonometric(alpha: f64) -> Result<Self, BlendingError> {
        Ok(Self {
            functions: Arc::new(Trigonometric::new(alpha)?),
            affine: true,
        })
    }

    /// Any two functions (H1, H4) or four (H1, H2, H3, H4) on `[0, 1]`, checked against `L_i(H_j) = δ_ij`.
    pub fn user(functions: FunctionsRef) -> Result<Self, BlendingError> {
        let count = functions.count();
        if count != 2 && count != 4 {
            return Err(BlendingError::Count { count });
        }
        let domain = functions.breaks().domain();
        if domain != Interval::UNIT {
            return Err(BlendingError::Domain { domain });
        }
        let blending = Self {
            affine: sums_to_one(functions.as_ref()),
            functions,
        };
        let faults = blending.faults();
        if faults.is_empty() {
            Ok(blending)
        } else {
            Err(BlendingError::Conditions { faults })
        }
    }

    /// The functions: H1, H4 or H1, H2, H3, H4 or the six quintic ones.
    pub fn functions(&self) -> &FunctionsRef {
        &self.functions
    }

    /// The highest order of the derivatives that are blended: 0 if only positions are.
    pub fn order(&self) -> usize {
        self.functions.count() / 2 - 1
    }

    /// True if derivatives are blended too.
    pub fn has_tangents(&self) -> bool {
        self.order() > 0
    }

    /// True if `H1 + H4 = 1`: only then does the surface move with its boundary, whatever the origin of space.
    pub fn is_affine(&self) -> bool {
        self.affine
    }

    fn faults(&self) -> Vec<BlendingFault> {
        let n = self.functions.count();
        let number: &[usize] = if n == 2 { &[1, 4] } else { &[1, 2, 3, 4] };
        let ends = [(0.0, Limit::Above), (1.0, Limit::Below)];
        let rows = ends.map(|(t, limit)| row(self.functions.as_ref(), t, limit, 1));
        let mut faults = Vec::new();
        for &functional in number {
            let (end, order) = [(0, 0), (0, 1), (1, 1), (1, 0)][functional - 1];
            for (j, &function) in number.iter().enumerate() {
                let expected = if function == functional { 1.0 } else { 0.0 };
                let value = rows[end][order * n + j];
                // NaN is a fault, too.
                if (value - expected).abs().partial_cmp(&Self::TOLERANCE)
                    != Some(std::cmp::Ordering::Less)
                {
                    faults.push(BlendingFault {
                        function,
                        functional,
                        expected,
                        value,
                    });
                }
            }
        }
        faults
    }
}

/// All functions and derivatives at a parameter; those that are not active are zero.
fn row(functions: &dyn Functions, t: f64, limit: Limit, order: usize) -> Vec<f64> {
    let (n, active) = (functions.count(), functions.active(t, limit));
    let mut part = vec![0.0; (order + 1) * active.len()];
    functions.jet_into(t, limit, order, &mut part);
    let mut out = vec![0.0; (order + 1) * n];
    for k in 0..=order {
        out[k * n + active.start..][..active.len()]
            .copy_from_slice(&part[k * active.len()..][..active.len()]);
    }
    out
}

fn sums_to_one(functions: &dyn Functions) -> bool {
    /// Enough to tell any formula from the constant 1.
    const SAMPLES: usize = 64;
    (0..=SAMPLES).all(|i| {
        let values = row(functions, i as f64 / SAMPLES as f64, Limit::Above, 0);
        (values[0] + values[values.len() - 1] - 1.0).abs() <= Blending::TOLERANCE
    })
}
