//! Four boundary curves that close: what Coons and Diagonal-key surfaces are spanned in.

use super::sides::{Corner, Side};
use crate::curve::{CurveRef, on_unit_domain};
use crate::significant;
use glam::DVec3;
use std::fmt;
use thiserror::Error;

/// Two boundary curves that fail to meet in a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CornerGap {
    /// The corner.
    pub corner: Corner,
    /// Where south or north comes to the corner.
    pub along_u: DVec3,
    /// Where west or east comes to the corner.
    pub along_v: DVec3,
    /// The distance of the two, a length.
    pub gap: f64,
}

impl fmt::Display for CornerGap {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [a, b] = self.corner.sides();
        let [u, v] = self.corner.ends();
        let verb = ["starts", "ends"];
        write!(
            f,
            "{a} {} at {} but {b} {} at {}, {} away",
            verb[u],
            self.along_u,
            verb[v],
            self.along_v,
            significant(self.gap, 6)
        )
    }
}

/// What can be wrong with a contour.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum ContourError {
    /// An end of a curve is NaN or infinite.
    #[error("{side} is not finite at t = {t}: {point}")]
    NotFinite {
        /// Which curve.
        side: Side,
        /// The parameter.
        t: f64,
        /// The point there.
        point: DVec3,
    },
    /// Curves do not meet in some corners.
    #[error("the boundary curves do not meet: {}", open_text(gaps, *tol, reverse, *remaining))]
    Open {
        /// The corners with a gap above the tolerance.
        gaps: Vec<CornerGap>,
        /// The greatest gap allowed, a length.
        tol: f64,
        /// The curves to reverse, if that closes two corners or more, or makes the gaps of these curves much smaller.
        reverse: Vec<Side>,
        /// The greatest gap left when they are reversed.
        remaining: f64,
    },
}

fn open_text(gaps: &[CornerGap], tol: f64, reverse: &[Side], remaining: f64) -> String {
    let list: Vec<String> = gaps.iter().map(CornerGap::to_string).collect();
    let mut text = format!("{} (allowed: {})", list.join("; "), significant(tol, 2));
    if !reverse.is_empty() {
        let names: Vec<&str> = reverse.iter().map(|s| s.name()).collect();
        text += &format!("; reverse {}", names.join(" and "));
        if remaining > tol {
            text += &format!(", which leaves a gap of {}", significant(remaining, 6));
        }
    }
    text
}

/// Four boundary curves that meet in the corners, over `[0, 1]` (others are reparametrised linearly): south and north run along u from west to east, west
/// and east run along v from south to north.
#[derive(Clone, Debug)]
pub struct Contour {
    sides: [CurveRef; 4],
    corners: [[DVec3; 2]; 2],
    size: f64,
    gap: f64,
}

impl Contour {
    /// The greatest gap in a corner that is taken for rounding, relative to the size of the contour. Larger, and
    /// surfaces would miss their boundaries visibly; smaller, and data written with ten digits would not close.
    pub const CLOSURE: f64 = 1e-9;

    /// Checks that the curves close within [`Self::CLOSURE`] of the contour's size.
    pub fn new(
        south: CurveRef,
        north: CurveRef,
        west: CurveRef,
        east: CurveRef,
    ) -> Result<Self, ContourError> {
        Self::with_tolerance(south, north, west, east, 0.0)
    }

    /// Checks that the curves close within `tol`, a length (or within [`Self::CLOSURE`] of the size if that is more).
    /// A surface on the contour keeps its sides up to the gap that is left, see [`Self::gap`].
    pub fn with_tolerance(
        south: CurveRef,
        north: CurveRef,
        west: CurveRef,
        east: CurveRef,
        tol: f64,
    ) -> Result<Self, ContourError> {
        let sides = [south, north, west, east].map(on_unit_domain);
        for (side, curve) in Side::ALL.into_iter().zip(&sides) {
            for t in [0.0, 1.0] {
                let point = curve.point(t);
                if !point.is_finite() {
                    return Err(ContourError::NotFinite { side, t, point });
                }
            }
        }
        let size = size(&sides);
        let tol = tol.max(Self::CLOSURE * size);
        let ends = [0, 1, 2, 3].map(|i| sides[i].ends());
        let gaps = corner_gaps(&ends);
        let greatest = |gaps: &[CornerGap; 4]| gaps.iter().fold(0.0, |m: f64, g| m.max(g.gap));
        let gap = greatest(&gaps);
        // NaN cannot occur: the ends are finite, and so the comparison below is meaningful.
        if gap > tol {
            let (reverse, remaining) = best_reversal(&ends, tol);
            return Err(ContourError::Open {
                gaps: gaps.into_iter().filter(|g| g.gap > tol).collect(),
                tol,
                reverse,
                remaining,
            });
        }
        let mut corners = [[DVec3::ZERO; 2]; 2];
        for g in gaps {
            let [u, v] = g.corner.ends();
            corners[u][v] = g.along_u.midpoint(g.along_v);
            if g.along_u == g.along_v {
                corners[u][v] = g.along_u;
            }
        }
        Ok(Self {
            sides,
            corners,
            size,
            gap,
        })
    }

    /// A boundary curve.
    pub fn side(&self, side: Side) -> &CurveRef {
        &self.sides[side as usize]
    }

    /// The curve v = 0.
    pub fn south(&self) -> &CurveRef {
        self.side(Side::South)
    }

    /// The curve v = 1.
    pub fn north(&self) -> &CurveRef {
        self.side(Side::North)
    }

    /// The curve u = 0.
    pub fn west(&self) -> &CurveRef {
        self.side(Side::West)
    }

    /// The curve u = 1.
    pub fn east(&self) -> &CurveRef {
        self.side(Side::East)
    }

    /// The corners, `corners()[u][v]`: the middle of the two curve ends that meet there.
    pub fn corners(&self) -> [[DVec3; 2]; 2] {
        self.corners
    }

    /// A length to compare errors with: the diagonal of a box around points of the curves.
    pub fn size(&self) -> f64 {
        self.size
    }

    /// The greatest gap in a corner, a length; 0 if the curves meet exactly.
    pub fn gap(&self) -> f64 {
        self.gap
    }

    /// The same contour with u and v exchanged: south becomes west, north becomes east.
    pub fn exchanged(&self) -> Self {
        let [s, n, w, e] = self.sides.clone();
        let c = self.corners;
        Self {
            sides: [w, e, s, n],
            corners: [[c[0][0], c[1][0]], [c[0][1], c[1][1]]],
            ..*self
        }
    }
}

/// The gaps for curves with the given ends, in the order south, north, west, east.
fn corner_gaps(ends: &[[DVec3; 2]; 4]) -> [CornerGap; 4] {
    Corner::ALL.map(|corner| {
        let [u, v] = corner.ends();
        let [a, b] = corner.sides();
        let (along_u, along_v) = (ends[a as usize][u], ends[b as usize][v]);
        CornerGap {
            corner,
            along_u,
            along_v,
            gap: along_u.distance(along_v),
        }
    })
}

/// Sums of the same gaps in another order differ by rounding only.
const SAME_SUM: f64 = 1.0 + 1e-12;

/// The curves whose reversal leaves the smallest gaps, as few as possible, if it closes two corners or more or halves the
/// sum of the gaps in their corners; and the greatest gap that is left. Gaps in other corners do not count: a contour may
/// have a curve that is reversed and another that ends in the wrong place.
fn best_reversal(ends: &[[DVec3; 2]; 4], tol: f64) -> (Vec<Side>, f64) {
    let gaps = |mask: u32| {
        let mut e = *ends;
        for (i, pair) in e.iter_mut().enumerate() {
            if mask >> i & 1 == 1 {
                pair.swap(0, 1);
            }
        }
        // What is within the tolerance is closed.
        corner_gaps(&e).map(|g| if g.gap > tol { g.gap } else { 0.0 })
    };
    let now = gaps(0);
    let helps = |mask: u32| {
        let left = gaps(mask);
        let open = |gaps: [f64; 4]| gaps.iter().filter(|g| **g > 0.0).count();
        let of_curves = |gaps: [f64; 4]| -> f64 {
            let corners = Corner::ALL.into_iter().zip(gaps);
            corners
                .filter(|(c, _)| c.sides().iter().any(|s| mask >> (*s as u32) & 1 == 1))
                .map(|(_, gap)| gap)
                .sum()
        };
        open(left) + 2 <= open(now) || of_curves(left) < 0.5 * of_curves(now)
    };
    let sum = |mask: u32| gaps(mask).iter().sum::<f64>();
    let mut masks: Vec<u32> = (1..16).filter(|m| helps(*m)).collect();
    masks.sort_by_key(|m| m.count_ones());
    let least = masks.iter().map(|m| sum(*m)).fold(f64::INFINITY, f64::min);
    let best = masks.into_iter().find(|m| sum(*m) <= least * SAME_SUM);
    let best = best.unwrap_or(0);
    let sides = Side::ALL.into_iter().enumerate();
    let reverse = sides.filter(|(i, _)| best >> i & 1 == 1);
    (
        reverse.map(|(_, s)| s).collect(),
        gaps(best).into_iter().fold(0.0, f64::max),
    )
}

/// The diagonal of a box around points of the curves.
pub(super) fn size(sides: &[CurveRef; 4]) -> f64 {
    const SAMPLES: usize = 16;
    let points = sides
        .iter()
        .flat_map(|c| (0..=SAMPLES).map(|k| c.point(k as f64 / SAMPLES as f64)))
        .filter(|p| p.is_finite());
    crate::box3::Box3::around(points).map_or(0.0, |b| b.diagonal())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exact::NurbsCurve;
    use std::sync::Arc;

    fn line(a: [f64; 3], b: [f64; 3]) -> CurveRef {
        let p = [DVec3::from_array(a), DVec3::from_array(b)];
        Arc::new(NurbsCurve::bezier(&p, None).unwrap())
    }

    const P: [[[f64; 3]; 2]; 2] = [
        [[0.0, 0.0, 0.0], [0.0, 1.0, 0.2]],
        [[1.0, 0.0, 0.1], [1.0, 1.0, 0.0]],
    ];

    #[test]
    fn a_closed_contour_knows_its_corners() {
        let c = Contour::new(
            line(P[0][0], P[1][0]),
            line(P[0][1], P[1][1]),
            line(P[0][0], P[0][1]),
            line(P[1][0], P[1][1]),
        )
        .unwrap();
        assert_eq!(c.gap(), 0.0);
        for (u, v) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            assert_eq!(c.corners()[u][v].to_array(), P[u][v]);
            assert_eq!(c.exchanged().corners()[v][u].to_array(), P[u][v]);
        }
        assert_eq!(c.exchanged().north().point(1.0).to_array(), P[1][1]);
    }

    #[test]
    fn every_set_of_reversed_curves_is_named_or_an_equally_good_one() {
        let ends = [
            (P[0][0], P[1][0]),
            (P[0][1], P[1][1]),
            (P[0][0], P[0][1]),
            (P[1][0], P[1][1]),
        ];
        for mask in 1..16u32 {
            let curves: Vec<_> = (0..4)
                .map(|i| {
                    let (a, b) = ends[i];
                    if mask >> i & 1 == 1 {
                        line(b, a)
                    } else {
                        line(a, b)
                    }
                })
                .collect();
            let [s, n, w, e] = [0, 1, 2, 3].map(|i| curves[i].clone());
            let Err(ContourError::Open {
                reverse, remaining, ..
            }) = Contour::new(s, n, w, e)
            else {
                // All four reversed is the same contour turned by half a turn.
                assert_eq!(mask, 15);
                continue;
            };
            assert_eq!(remaining, 0.0, "{mask:b}");
            let named: u32 = reverse.iter().map(|s| 1 << *s as u32).sum();
            assert!(
                named == mask || named.count_ones() <= mask.count_ones(),
                "{mask:b} {named:b}"
            );
        }
    }

    #[test]
    fn a_reversed_curve_is_named_beside_another_gap() {
        // West is reversed; besides, north or south ends too far, by less and by more than the reversal opens.
        let far = |p: [f64; 3], by: f64| [p[0] + by, p[1], p[2]];
        for by in [0.1, 5.0] {
            for wrong in [Side::North, Side::South] {
                let end = |side: Side, p| far(p, if side == wrong { by } else { 0.0 });
                let open = Contour::new(
                    line(P[0][0], end(Side::South, P[1][0])),
                    line(P[0][1], end(Side::North, P[1][1])),
                    line(P[0][1], P[0][0]),
                    line(P[1][0], P[1][1]),
                );
                let Err(ContourError::Open {
                    gaps,
                    reverse,
                    remaining,
                    ..
                }) = open
                else {
                    panic!("closed")
                };
                assert_eq!((gaps.len(), reverse), (3, vec![Side::West]));
                assert!((remaining - by).abs() < 1e-12);
            }
        }
        // A gap alone is no reason to reverse anything.
        let open = Contour::new(
            line(P[0][0], P[1][0]),
            line(P[0][1], far(P[1][1], 0.1)),
            line(P[0][0], P[0][1]),
            line(P[1][0], P[1][1]),
        );
        assert!(matches!(open, Err(ContourError::Open { reverse, .. }) if reverse.is_empty()));
    }

    #[test]
    fn a_gap_is_reported_with_its_corner_and_length() {
        let open = Contour::new(
            line(P[0][0], P[1][0]),
            line(P[0][1], P[1][1]),
            line(P[0][1], [0.0, 0.0, 0.5]),
            line(P[1][0], P[1][1]),
        )
        .unwrap_err();
        let text = open.to_string();
        let ContourError::Open {
            gaps,
            reverse,
            remaining,
            ..
        } = open
        else {
            panic!("{text}");
        };
        assert_eq!(reverse, [Side::West]);
        assert_eq!(remaining, 0.5);
        assert_eq!(gaps.len(), 2);
        assert_eq!(gaps[0].corner, Corner::SouthWest);
        assert!(
            text.contains("south starts at [0, 0, 0] but west starts at [0, 1, 0.2]"),
            "{text}"
        );
        assert!(
            text.contains("reverse west, which leaves a gap of 0.5"),
            "{text}"
        );
    }

    #[test]
    fn another_domain_is_mapped_to_the_unit_interval() {
        let p = P.map(|row| row.map(DVec3::from_array));
        let west = NurbsCurve::new(1, vec![3.0, 3.0, 5.0, 5.0], &p[0], None).unwrap();
        let c = Contour::new(
            line(P[0][0], P[1][0]),
            line(P[0][1], P[1][1]),
            Arc::new(west),
            line(P[1][0], P[1][1]),
        )
        .unwrap();
        assert_eq!(c.west().ends(), p[0]);
    }
}
