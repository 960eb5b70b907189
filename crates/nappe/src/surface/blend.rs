//! The blend: a bridge between a side of one surface and a side of another, smooth at both.

use super::{Core, Elementary, Separable, Side, Surface, SurfaceRef, Term};
use crate::basis::{Functions, FunctionsRef, Hermite, SideJet, Stack};
use crate::box3::Box3;
use crate::breaks::{Breaks, Limit};
use crate::exact::NurbsSurface;
use crate::significant::significant;
use glam::{DVec3, DVec4};
use std::sync::Arc;
use thiserror::Error;

/// How a blend meets its two surfaces; the first entry of each pair is for the first side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlendOptions {
    /// The order of geometric continuity at each side: 0 for common points, 1 for common tangent planes, 2 for common
    /// curvatures as well. Default: 2.
    pub continuity: [usize; 2],
    /// How far the blend follows each surface: the mean length of its tangents there, in units of the mean distance of
    /// the sides. Positive; without effect at a side that is met with G0 alone. Default: 1.
    pub bulge: [f64; 2],
    /// Whether the second side is run through backwards. Default: whatever leaves corresponding points nearer.
    pub reverse: Option<bool>,
    /// Whether second derivatives across are taken over as they are, so that the blend goes on with the parameters of the
    /// surfaces as well. Default: no; where those run unevenly, the blend would fold. Common curvatures need it in neither
    /// case.
    pub as_parametrised: bool,
}

impl Default for BlendOptions {
    fn default() -> Self {
        Self {
            continuity: [2; 2],
            bulge: [1.0; 2],
            reverse: None,
            as_parametrised: false,
        }
    }
}

/// What can be wrong with a blend; `end` is 0 for the first side and 1 for the second.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum BlendError {
    /// An order of continuity is not 0, 1 or 2.
    #[error("continuity of order {value} at the {} side: only G0, G1 and G2 are possible", ["first", "second"][*end])]
    Continuity {
        /// Which side.
        end: usize,
        /// The order.
        value: usize,
    },
    /// A factor is not a positive number.
    #[error("the bulge is {value} at the {} side: it must be a positive number", ["first", "second"][*end])]
    Bulge {
        /// Which side.
        end: usize,
        /// The factor.
        value: f64,
    },
    /// The powers of a factor are not numbers.
    #[error("at the {} side the blend would go on over {value:e} times the range of the surface's parameter: the square of that, or of the width of this range, is no number greater than 0", ["first", "second"][*end])]
    Range {
        /// Which side.
        end: usize,
        /// The factor.
        value: f64,
    },
    /// A point or a derivative is NaN or infinite.
    #[error("the {} side, {side}, or a derivative across it is not finite at {at} of its length in parameters", ["first", "second"][*end])]
    NotFinite {
        /// Which side.
        end: usize,
        /// Its name.
        side: Side,
        /// The share of its parameter range.
        at: f64,
    },
    /// Both sides are the same points.
    #[error("both sides are the same curve, at most {} apart: there is nothing between them", significant(*distance, 2))]
    Same {
        /// The greatest distance of corresponding points.
        distance: f64,
    },
    /// A side that is to be continued is a pole.
    #[error("the {} side, {side}, is one point, {point}: a surface that ends there cannot be continued", ["first", "second"][*end])]
    Pole {
        /// Which side.
        end: usize,
        /// Its name.
        side: Side,
        /// The point.
        point: DVec3,
    },
    /// A surface that is to be continued has no tangent plane somewhere on the side.
    #[error("the surface of the {} side, {side}, has no tangent plane at {at} of that side, near {point}: its derivatives along and across it are parallel, or zero", ["first", "second"][*end])]
    NoPlane {
        /// Which side.
        end: usize,
        /// Its name.
        side: Side,
        /// The share of its parameter range.
        at: f64,
        /// The point.
        point: DVec3,
    },
}

/// A surface from a side of one surface to a side of another that continues both, by Hermite interpolation across.
///
/// On `[0, 1]²`, `r(u, v) = Σ_k aᵏ n_k(u) H_k(v) + Σ_k (-b)ᵏ m_k(u) G_k(v) + c n_1(u) H_2(v) + d m_1(u) G_2(v)`: n_k is the k-th derivative of the first surface
/// out of it across its side, m_k that of the second, for parameters that run over a unit range; H and G are the
/// [Hermite functions](Hermite) of the k-th derivatives at 0 and at 1. A surface continued by `v ↦ a v + c v²/2` has the
/// derivatives `a n_1` and `a² n_2 + c n_1`, so with derivatives up to order 2 and a, b > 0 tangent planes and curvatures agree exactly (G2), with those up
/// to order 1 tangent planes (G1), and with the points alone the surface is ruled. The degree across is the number of
/// derivatives taken less one: 5 for G2 at both sides.
///
/// South is the first side, run through in its own direction; north is the second. So the normals are those of the first
/// surface if its side is north or west, and opposite if it is south or east.
///
/// The constants a and b follow from the bulge: `a` times the mean length of n_1 is the bulge times the mean distance of
/// corresponding points. The constants c and d leave the second derivatives without a part along the first ones, on the mean:
/// `c = -a² ∫n_1·n_2 / ∫n_1²`, so that a surface whose parameter runs faster or slower towards the side is continued evenly
/// (0 if this is not wanted, or for less than G2). Where the surfaces have breaks along the sides, the blend has, as smooth as both. Exactly a NURBS
/// surface if both surfaces are: along u of the sides' degree if they are polynomials, else at most of three times the sum
/// of their degrees; there is no such form if that is more than [`crate::basis::BSplineBasis::MAX_DEGREE`].
///
/// Whether the surfaces can be continued (a tangent plane everywhere along the sides) is sampled. A closed side is not
/// turned: both should start at places that face each other. A blend of sides whose surfaces point away from each other
/// runs round in a loop, and may pass through itself or through them; so it does in a corner where the sides meet, since a
/// and b are the same all along.
/// Source: Hermite interpolation; derivatives after a reparametrisation by the chain rule.
#[derive(Clone, Debug)]
pub struct Blend {
    form: Separable,
    reversed: bool,
    factors: [f64; 2],
}

/// Pairs of corresponding points from which their mean distance is taken.
const PAIRS: usize = 64;
/// Places in each piece of a side where the tangent plane is looked for, besides its ends.
const PLACES: usize = 16;
/// A normal shorter than this part of the longest one along the side is taken for zero, as where continuity is measured.
const NO_NORMAL: f64 = 1e-10;
/// Points nearer to each other than this part of the size are one: what rounding leaves.
const ONE_POINT: f64 = 1e-13;

impl Blend {
    /// The blend from a side of one surface to a side of another, or of the same one.
    pub fn new(
        first: (SurfaceRef, Side),
        second: (SurfaceRef, Side),
        options: &BlendOptions,
    ) -> Result<Self, BlendError> {
        let orders = options.continuity;
        for (end, &value) in orders.iter().enumerate() {
            if value > Hermite::MAX_ORDER {
                return Err(BlendError::Continuity { end, value });
            }
        }
        for (end, &value) in options.bulge.iter().enumerate() {
            if !(value > 0.0 && value.is_finite()) {
                return Err(BlendError::Bulge { end, value });
            }
        }
        let sides = [first, second];
        let ends = sides.each_ref().map(|(s, side)| {
            let jet = SideJet::new((s.clone(), *side), false, 0, DVec3::ZERO);
            [0.0, 1.0].map(|t| jet.derivatives(t, inside(t), 0)[0][0])
        });
        let origin = Box3::around(ends.into_iter().flatten().filter(|p| p.is_finite()))
            .map_or(DVec3::ZERO, Box3::mid);
        let jet = |end: usize, reversed: bool| {
            SideJet::new(sides[end].clone(), reversed, orders[end], origin)
        };
        let jets = [jet(0, false), jet(1, false)];
        let mut lengths = [0.0; 2];
        for end in 0..2 {
            lengths[end] = examine(end, &sides[end], &jets[end], orders[end])?;
        }
        let apart = [false, true].map(|reversed| Apart::of(&jets, reversed));
        let reversed = options
            .reverse
            .unwrap_or(apart[1].squares < apart[0].squares);
        let apart = &apart[usize::from(reversed)];
        if apart.greatest <= ONE_POINT * apart.size + rounding(origin) {
            return Err(BlendError::Same {
                distance: apart.greatest,
            });
        }
        let factors = [0, 1].map(|end| match orders[end] {
            0 => 0.0,
            _ => options.bulge[end] * apart.mean / lengths[end],
        });
        // The derivatives across for parameters that grow from the first side to the second.
        let scales = [0, 1].map(|end| {
            let (surface, side) = &sides[end];
            let width = surface.breaks(side.across()).domain().width();
            let out = if side.is_upper() { width } else { -width };
            if end == 0 {
                out * factors[0]
            } else {
                -out * factors[1]
            }
        });
        for end in (0..2).filter(|&end| orders[end] > 0) {
            let square = scales[end] * scales[end];
            if !(square > 0.0 && square.is_finite()) {
                let value = factors[end];
                return Err(BlendError::Range { end, value });
            }
        }
        let evened = [0, 1].map(|end| {
            if orders[end] < 2 || options.as_parametrised {
                return 0.0;
            }
            -scales[end] * (scales[end] * unevenness(&jets[end]))
        });
        let [south, north] = jets;
        let north = if reversed { jet(1, true) } else { north };
        let degree = orders[0] + orders[1] + 1;
        let axes = [DVec4::X, DVec4::Y, DVec4::Z];
        let mut terms = Vec::new();
        for end in 0..2 {
            for k in 0..=orders[end] {
                let (first, across) = if end == 0 {
                    (0, k)
                } else {
                    (3 * (orders[0] + 1), degree - k)
                };
                let scale = if k == 0 {
                    1.0
                } else {
                    scales[end].powi(k as i32)
                };
                let term = |of: usize, scale: f64| {
                    move |c: usize| Term::new(first + 3 * of + c, across, axes[c] * scale)
                };
                terms.extend((0..3).map(term(k, scale)));
                if k == 2 && evened[end] != 0.0 {
                    terms.extend((0..3).map(term(1, evened[end])));
                }
            }
        }
        let curves = Stack::new(vec![Arc::new(south) as FunctionsRef, Arc::new(north)]);
        let form = Separable::polynomial(
            Arc::new(curves),
            Arc::new(Hermite::of_orders(orders)),
            Core::Terms(terms),
            origin,
        );
        Ok(Self {
            form,
            reversed,
            factors,
        })
    }

    /// True if the second side is run through backwards.
    pub fn is_reversed(&self) -> bool {
        self.reversed
    }

    /// The constants a and b: the parameter ranges of the surfaces, as parts of the whole ones, that the blend's unit range
    /// corresponds to at the first and at the second side; 0 where only points are met.
    pub fn factors(&self) -> [f64; 2] {
        self.factors
    }

    /// The separable form.
    pub fn separable(&self) -> &Separable {
        &self.form
    }
}

/// The limit from the inside of `[0, 1]`.
fn inside(t: f64) -> Limit {
    if t < 1.0 { Limit::Above } else { Limit::Below }
}

/// What rounding leaves of the distance of points that are one, for coordinates measured from a far origin.
fn rounding(origin: DVec3) -> f64 {
    4.0 * f64::EPSILON * origin.length()
}

/// `∫n_1·n_2 / ∫n_1²` of the first and second derivatives across; 0 if that is no number.
fn unevenness(jet: &SideJet) -> f64 {
    let mut sums = [0.0; 2];
    for k in 0..PAIRS {
        let t = (k as f64 + 0.5) / PAIRS as f64;
        let d = jet.derivatives(t, inside(t), 0);
        let (first, second) = (d[1][0], d[2][0]);
        sums[0] += first.dot(second);
        sums[1] += first.length_squared();
    }
    let ratio = sums[0] / sums[1];
    if ratio.is_finite() { ratio } else { 0.0 }
}

/// Tells whether the surface can be continued over the side, if derivatives up to `order > 0` are to be taken over. Returns
/// the mean length of the derivative across, for a unit range of the parameter; 0 if none is taken over.
fn examine(
    end: usize,
    (surface, side): &(SurfaceRef, Side),
    jet: &SideJet,
    order: usize,
) -> Result<f64, BlendError> {
    let side = *side;
    let width = surface.breaks(side.across()).domain().width();
    let mut found = Vec::new();
    for i in 0..jet.breaks().pieces() {
        let piece = jet.breaks().piece(i);
        for k in 0..=PLACES {
            let share = k as f64 / PLACES as f64;
            let (at, limit) = if k == PLACES {
                (piece.hi, Limit::Below)
            } else {
                (piece.lo + piece.width() * share, Limit::Above)
            };
            let d = jet.derivatives(at, limit, order.min(1));
            if !d.iter().flatten().all(|x| x.is_finite()) {
                return Err(BlendError::NotFinite { end, side, at });
            }
            let across = d.get(1).map_or(DVec3::ZERO, |n| n[0] * width);
            let along = d[0].get(1).copied().unwrap_or(DVec3::ZERO);
            found.push((at, d[0][0], along, across));
        }
    }
    if order == 0 {
        return Ok(0.0);
    }
    let longest =
        |f: fn(&(f64, DVec3, DVec3, DVec3)) -> f64| found.iter().map(f).fold(0.0, f64::max);
    let (along, across) = (longest(|x| x.2.length()), longest(|x| x.3.length()));
    let extent = Box3::around(found.iter().map(|x| x.1)).map_or(0.0, Box3::diagonal);
    if extent <= ONE_POINT * across + rounding(jet.origin()) {
        let point = found[0].1 + jet.origin();
        return Err(BlendError::Pole { end, side, point });
    }
    for &(at, p, t, n) in &found {
        if t.cross(n).length() <= NO_NORMAL * along * across {
            let point = p + jet.origin();
            return Err(BlendError::NoPlane {
                end,
                side,
                at,
                point,
            });
        }
    }
    // The mean over pieces of any width is that over the side only for places that are spread evenly.
    let mean = |k: usize| {
        let t = (k as f64 + 0.5) / PAIRS as f64;
        jet.derivatives(t, inside(t), 0)[1][0].length() * width
    };
    Ok((0..PAIRS).map(mean).sum::<f64>() / PAIRS as f64)
}

/// How far corresponding points are from each other.
struct Apart {
    mean: f64,
    /// The sum of the squared distances.
    squares: f64,
    greatest: f64,
    /// The extent of all points.
    size: f64,
}

impl Apart {
    fn of(jets: &[SideJet; 2], reversed: bool) -> Self {
        let pair = |k: usize| {
            let t = (k as f64 + 0.5) / PAIRS as f64;
            let other = if reversed { 1.0 - t } else { t };
            let at = |jet: &SideJet, t: f64| jet.derivatives(t, inside(t), 0)[0][0];
            [at(&jets[0], t), at(&jets[1], other)]
        };
        let pairs: Vec<[DVec3; 2]> = (0..PAIRS).map(pair).collect();
        let distances = || pairs.iter().map(|[p, q]| p.distance(*q));
        Self {
            mean: distances().sum::<f64>() / PAIRS as f64,
            squares: distances().map(|d| d * d).sum(),
            greatest: distances().fold(0.0, f64::max),
            size: Box3::around(pairs.iter().flatten().copied()).map_or(0.0, Box3::diagonal),
        }
    }
}

impl Surface for Blend {
    evaluate_through!(self => self.form);

    fn to_nurbs(&self) -> Option<NurbsSurface> {
        self.form.to_nurbs()
    }

    fn elementary(&self) -> Option<Elementary> {
        self.form.elementary()
    }
}
