//! Points that are followed along a curve.
//!
//! Where a corner moves along the parameter of a curve, the velocity at fixed parameters jumps. What does not jump is the
//! velocity of points that keep their share of the way between two corners: these slide along the parameter with the
//! corners.

use nappe::curve::CurveRef;
use nappe::exact::{NurbsCurve, NurbsError};
use nappe::surface::{Dir, SurfaceRef};
use nappe::velocity::{Factor, Sum, Term, as_curve, extended};
use nappe::{Breaks, DVec3};
use std::sync::Arc;

/// Relative: rates that differ by less are the same but for rounding.
const ROUNDING: f64 = 1e-12;

/// The rate of the parameter of a followed point, along a curve over `[0, 1]`: linear between corners, 0 at both ends.
#[derive(Clone, Debug)]
pub(super) struct Slide {
    /// The corners with the ends.
    at: Vec<f64>,
    /// The rates there.
    rates: Vec<f64>,
    /// Why there is no velocity at fixed parameters.
    why: String,
}

impl Slide {
    pub(super) fn new(at: Vec<f64>, rates: Vec<f64>, why: String) -> Self {
        Self { at, rates, why }
    }

    /// True if the points slide in the same way.
    fn is_like(&self, other: &Slide) -> bool {
        let same = |a: &[f64], b: &[f64]| {
            let most = a.iter().chain(b).fold(0.0, |m: f64, x| m.max(x.abs()));
            a.len() == b.len()
                && a.iter()
                    .zip(b)
                    .all(|(x, y)| (x - y).abs() <= ROUNDING * most)
        };
        same(&self.at, &other.at) && same(&self.rates, &other.rates)
    }

    /// Along the curve run through backwards.
    pub(super) fn reversed(self) -> Self {
        Self {
            at: self.at.iter().rev().map(|t| 1.0 - t).collect(),
            rates: self.rates.iter().rev().map(|r| -r).collect(),
            why: self.why,
        }
    }

    /// Along curves with equal shares of `[0, 1]`, if points slide along one of them.
    pub(super) fn joined(parts: &[Option<Slide>]) -> Option<Self> {
        let why = parts.iter().flatten().next()?.why.clone();
        let share = 1.0 / parts.len() as f64;
        let (mut at, mut rates) = (vec![0.0], vec![0.0]);
        for (k, part) in parts.iter().enumerate() {
            let whole = ([0.0, 1.0], [0.0; 2]);
            let (own_at, own_rates) = match part {
                Some(s) => (s.at.as_slice(), s.rates.as_slice()),
                None => (whole.0.as_slice(), whole.1.as_slice()),
            };
            let start = k as f64 * share;
            at.extend(own_at.iter().skip(1).map(|t| start + t * share));
            rates.extend(own_rates.iter().skip(1).map(|r| r * share));
        }
        Some(Self { at, rates, why })
    }

    /// The velocity of points that slide so along a curve without corners, from that at fixed parameters: `r' + s r_t`.
    fn along(&self, curve: &CurveRef, velocity: Option<CurveRef>) -> Result<CurveRef, NurbsError> {
        let mut knots = vec![0.0];
        knots.extend(&self.at);
        knots.push(1.0);
        let rates: Vec<DVec3> = self.rates.iter().map(|r| DVec3::X * *r).collect();
        let of = extended(Arc::new(NurbsCurve::new(1, knots, &rates, None)?));
        let slide = Term::slide(extended(curve.clone()), Dir::U, 0.0, 0.0);
        let mut terms = vec![slide.times(Factor::Coordinate { of, axis: 0 })];
        terms.extend(velocity.map(|v| Term::new(extended(v))));
        Ok(as_curve(Sum::new(DVec3::ZERO, terms)))
    }
}

/// A velocity, of points at fixed parameters or of such as slide along u or v; a curve is along u.
#[derive(Clone, Debug)]
pub(super) struct Moved<T> {
    pub(super) velocity: T,
    pub(super) slides: [Option<Slide>; 2],
}

impl<T> Moved<T> {
    /// At fixed parameters.
    pub(super) fn new(velocity: T) -> Self {
        Self {
            velocity,
            slides: [None, None],
        }
    }

    /// The velocity at fixed parameters; why there is none.
    pub(super) fn fixed(self) -> Result<T, String> {
        match self.slides.into_iter().flatten().next() {
            Some(slide) => Err(slide.why),
            None => Ok(self.velocity),
        }
    }
}

impl Moved<CurveRef> {
    pub(super) fn sliding(velocity: CurveRef, slide: Option<Slide>) -> Self {
        Self {
            velocity,
            slides: [slide, None],
        }
    }

    pub(super) fn slide(&self) -> Option<&Slide> {
        self.slides[0].as_ref()
    }
}

impl Moved<SurfaceRef> {
    /// The velocity of a surface of which points slide along one direction.
    pub(super) fn surface(velocity: SurfaceRef, dir: Dir, slide: Option<Slide>) -> Self {
        Self {
            velocity,
            slides: match dir {
                Dir::U => [slide, None],
                Dir::V => [None, slide],
            },
        }
    }

    /// How points slide along a direction, if they do not along the other.
    pub(super) fn slide_along(&self, dir: Dir) -> Result<Option<Slide>, String> {
        let [u, v] = &self.slides;
        let (along, across) = match dir {
            Dir::U => (u, v),
            Dir::V => (v, u),
        };
        match across {
            Some(slide) => Err(slide.why.clone()),
            None => Ok(along.clone()),
        }
    }
}

/// A curve with its velocity; none: it does not move.
pub(super) type Carried = (CurveRef, Option<Moved<CurveRef>>);

/// The velocities of two curves that face each other, of points that slide in the same way along both.
pub(super) fn together(curves: [Carried; 2]) -> Result<([CurveRef; 2], Option<Slide>), String> {
    let slides = curves.each_ref().map(|c| c.1.as_ref()?.slide().cloned());
    let common = match slides {
        [None, None] => None,
        [Some(a), Some(b)] if a.is_like(&b) => return Ok((curves.map(still), Some(a))),
        [Some(s), None] if curves[1].0.breaks().below(1).is_empty() => Some((s, 1)),
        [None, Some(s)] if curves[0].0.breaks().below(1).is_empty() => Some((s, 0)),
        [Some(s), _] | [None, Some(s)] => return Err(s.why),
    };
    let Some((slide, fixed)) = common else {
        return Ok((curves.map(still), None));
    };
    let (curve, moved) = &curves[fixed];
    let own = moved.as_ref().map(|m| m.velocity.clone());
    let carried = slide.along(curve, own).map_err(|e| e.to_string())?;
    let mut both = curves.map(still);
    both[fixed] = carried;
    Ok((both, Some(slide)))
}

/// A velocity; zero if the curve does not move.
fn still((curve, moved): Carried) -> CurveRef {
    match moved {
        Some(m) => m.velocity,
        None => nappe::velocity::still_curve(curve.breaks()),
    }
}
