//! Whether the data of a Coons surface fits together: the report over its corner conditions.

use super::sides::{Corner, Side};
use crate::significant;
use glam::DVec3;
use std::fmt;

/// What is given twice in a corner.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Datum {
    /// The point.
    Position,
    /// `∂r/∂u`.
    TangentU,
    /// `∂r/∂v`.
    TangentV,
    /// `∂²r/∂u∂v`.
    Twist,
    /// `∂²r/∂u²`.
    SecondU,
    /// `∂²r/∂v²`.
    SecondV,
    /// `∂³r/∂u²∂v`.
    TwistU,
    /// `∂³r/∂u∂v²`.
    TwistV,
    /// `∂⁴r/∂u²∂v²`.
    TwistUV,
}

impl Datum {
    /// The derivative of an order up to 2 along u and along v.
    pub(super) fn of_orders(u: usize, v: usize) -> Self {
        [
            [Datum::Position, Datum::TangentV, Datum::SecondV],
            [Datum::TangentU, Datum::Twist, Datum::TwistV],
            [Datum::SecondU, Datum::TwistU, Datum::TwistUV],
        ][u][v]
    }

    /// True for mixed derivatives, which two cross-derivatives give.
    pub fn is_mixed(self) -> bool {
        matches!(
            self,
            Datum::Twist | Datum::TwistU | Datum::TwistV | Datum::TwistUV
        )
    }
}

impl fmt::Display for Datum {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Datum::Position => "position",
            Datum::TangentU => "tangent along u",
            Datum::TangentV => "tangent along v",
            Datum::Twist => "twist",
            Datum::SecondU => "second derivative along u",
            Datum::SecondV => "second derivative along v",
            Datum::TwistU => "derivative ∂³r/∂u²∂v",
            Datum::TwistV => "derivative ∂³r/∂u∂v²",
            Datum::TwistUV => "derivative ∂⁴r/∂u²∂v²",
        })
    }
}

/// Who gives it.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Debug)]
pub enum Source {
    /// A boundary curve.
    Side(Side),
    /// The cross-derivative along a side.
    Cross(Side),
    /// The second derivative across a side: given, or that of the neighbour.
    Second(Side),
    /// The table of twists.
    Twists,
}

impl fmt::Display for Source {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Source::Side(s) => write!(f, "{s}"),
            Source::Cross(s) => write!(f, "cross.{s}"),
            Source::Second(s) => write!(f, "second.{s}"),
            Source::Twists => f.write_str("twists"),
        }
    }
}

/// A condition that is missed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// Where.
    pub corner: Corner,
    /// What.
    pub datum: Datum,
    /// Who disagrees.
    pub sources: [Source; 2],
    /// What they say.
    pub values: [DVec3; 2],
    /// The length of the difference.
    pub distance: f64,
    /// The greatest length allowed.
    pub limit: f64,
}

impl fmt::Display for Disagreement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = self.sources;
        let [x, y] = self.values;
        write!(
            f,
            "{} corner: the {} is {x} by {a} but {y} by {b}, {} apart (allowed: {})",
            self.corner,
            self.datum,
            significant(self.distance, 6),
            significant(self.limit, 2)
        )
    }
}

/// The report: every one of the 16 conditions `L_j(f_i) = L_i(g_j)` (36 with second derivatives) that is missed, and what would help.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Compatibility {
    /// The conditions missed, corner by corner.
    pub disagreements: Vec<Disagreement>,
    /// The boundary curves to reverse, if that closes two corners or more, or makes the gaps of these curves much smaller.
    pub reverse: Vec<Side>,
    /// The greatest gap left when they are reversed, a length.
    pub remaining: f64,
    /// True for quintic blending, which has no Gregory twists.
    pub quintic: bool,
}

impl Compatibility {
    /// True if everything fits.
    pub fn is_compatible(&self) -> bool {
        self.disagreements.is_empty()
    }

    fn has(&self, wanted: impl Fn(Datum) -> bool) -> bool {
        self.disagreements.iter().any(|d| wanted(d.datum))
    }
}

impl fmt::Display for Compatibility {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let all: Vec<String> = self.disagreements.iter().map(|d| d.to_string()).collect();
        write!(f, "{}", all.join("; "))?;
        if !self.reverse.is_empty() {
            let names: Vec<&str> = self.reverse.iter().map(|s| s.name()).collect();
            write!(f, "; reverse {}", names.join(" and "))?;
            if self.remaining > 0.0 {
                write!(
                    f,
                    ", which leaves a gap of {}",
                    significant(self.remaining, 6)
                )?;
            }
        } else if self.has(|d| d == Datum::Position) {
            write!(f, "; move the ends of the boundary curves together")?;
        } else if self.has(|d| matches!(d, Datum::TangentU | Datum::TangentV)) {
            write!(
                f,
                "; a cross-derivative must begin and end with the tangents of the boundary curves it meets"
            )?;
        } else if self.has(|d| matches!(d, Datum::SecondU | Datum::SecondV)) {
            write!(
                f,
                "; a second cross-derivative must begin and end with the second derivatives of the boundary curves it meets"
            )?;
        } else if self.quintic {
            write!(
                f,
                "; change a cross-derivative, or let the mean of both be taken: \"average\""
            )?;
        } else if self.has(|d| d == Datum::Twist) {
            write!(
                f,
                "; choose how incompatible twists are resolved: \"gregory\" or \"average\""
            )?;
        }
        Ok(())
    }
}
