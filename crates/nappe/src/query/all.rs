//! All nearest points.

use super::nearest::{Finder, Nearest, QueryError, check_tolerance};
use super::part::{EXACTNESS, Hull, Place, length};
use super::within::{Effort, Within, within};
use crate::box3::Box3;
use crate::clusters::clusters;
use crate::mesh::Certainty;
use glam::DVec3;

/// Places that hang together and are all about equally near.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Locus {
    /// The nearest of them that was found. Its certainty is about the places of this locus: none is nearer than its distance
    /// less the error.
    pub nearest: Nearest,
    /// A box around all of them.
    pub hull: Box3,
    /// True if they are one place, as far as the tolerance can tell: the distance is convex over the parts they are in, and
    /// the minima of these are no farther apart than the foot of a perpendicular is from places whose distances are equal
    /// within the tolerance, or within rounding errors where these are more; or else the whole box is not much wider than that. False if they may be a curve (a point on
    /// the axis of a torus), a whole surface (the middle of a sphere), or several places that are connected within the
    /// tolerance.
    pub isolated: bool,
}

/// How many times the way from the foot of a perpendicular to places whose distances are equal within the tolerance a box
/// may be wide that counts as one place: such places are all around, and parts at their border reach beyond.
const FOOT: f64 = 8.0;

impl Finder {
    /// All places that are no farther away than the nearest one by more than `tol`, one locus for each connected set of them.
    /// Proven: each such place is in the box of one of the loci, and boxes of different ones are more than `tol` apart.
    ///
    /// A locus of which it was not decided whether it is near enough is among them; its own distance shows that. Errors: as
    /// [`Self::nearest`], or the tolerance is no positive length. Cost: little more than [`Self::nearest`] for isolated
    /// places, up to [`FinderOptions::budget`](super::FinderOptions::budget) halvings for others.
    ///
    /// ```
    /// use nappe::query::{Finder, FinderOptions};
    /// use nappe::surface::{Torus, TorusOptions};
    /// use nappe::DVec3;
    /// use std::sync::Arc;
    ///
    /// let torus = Torus::new(3.0, 1.0, TorusOptions::default()).unwrap();
    /// let finder = Finder::new(&[Arc::new(torus)], FinderOptions::default()).unwrap();
    /// // A point of the circle in the middle of the tube is equally far from a circle of the surface.
    /// let loci = finder.all_nearest(DVec3::new(3.0, 0.0, 0.0), 1e-6).unwrap();
    /// assert!(loci.len() == 1 && !loci[0].isolated && loci[0].hull.diagonal() > 2.0);
    /// ```
    pub fn all_nearest(&self, p: DVec3, tol: f64) -> Result<Vec<Locus>, QueryError> {
        check_tolerance(tol)?;
        let best = self.nearest(p)?;
        let reach = self.reach(p, &best) + tol;
        // Within a plane, this far from the foot of a perpendicular, distances are longer by that much.
        let foot = |longer: f64| (longer * (2.0 * best.distance + longer)).sqrt();
        let rounding = EXACTNESS * best.point.abs().max(p.abs()).max_element();
        // The distance of a minimum that was found may be longer by twice the rounding, on both sides of the true one.
        let feet = [foot(tol), foot(tol).max(2.0 * foot(2.0 * rounding))];
        let effort = Effort {
            size: 0.5 * feet[0],
            halvings: self.budget,
        };
        let mut found: Vec<(Hull, Within)> = within(self, p, reach, &effort)
            .into_iter()
            .map(|w| (self.hull(&w), w))
            .collect();
        // The answer itself, where parts that are not convex were left before it was found again.
        let hull = Hull {
            lo: best.point,
            hi: best.point,
        };
        found.push((hull, of_nearest(p, &best, rounding)));
        let boxes: Vec<_> = found.iter().map(|f| f.0.to_box().to_array()).collect();
        let mut loci: Vec<Locus> = clusters(&boxes, tol)
            .into_iter()
            .map(|group| locus(&found, &group, feet))
            .collect();
        loci.sort_by(|a, b| a.nearest.distance.total_cmp(&b.nearest.distance));
        Ok(loci)
    }

    /// A box around what is within reach.
    fn hull(&self, w: &Within) -> Hull {
        Hull::of(self.shapes[w.surface as usize].enclose(w.uv, 0)[0])
    }
}

/// The error of the nearest place holds its rounding, no less than this, which is counted apart here.
fn of_nearest(p: DVec3, best: &Nearest, rounding: f64) -> Within {
    Within {
        surface: best.surface as u32,
        uv: best.uv.map(crate::interval::Interval::point),
        place: Place {
            surface: best.surface as u32,
            uv: best.uv,
            point: best.point,
            half_square: 0.5 * (best.point - p).length_squared(),
        },
        lower: best.distance - best.certainty.error() + rounding,
        rounding,
        convex: true,
    }
}

/// A group as a locus, with how wide one place may be where the distance is not convex, and where it is.
fn locus(found: &[(Hull, Within)], group: &[usize], feet: [f64; 2]) -> Locus {
    let of = |k: &usize| &found[*k];
    let hull = group.iter().map(|k| of(k).0).reduce(Hull::join);
    let hull = hull.unwrap_or(found[group[0]].0);
    let all = || group.iter().map(|k| &of(k).1);
    let best = all().min_by(|a, b| a.place.half_square.total_cmp(&b.place.half_square));
    let best = best.unwrap_or(&found[group[0]].1);
    let lower = all().map(|w| w.lower).fold(f64::INFINITY, f64::min);
    let rounding = all().map(|w| w.rounding).fold(0.0, f64::max);
    let distance = length(best.place.half_square);
    // Minima of neighbours over which the distance is convex may be one on their common side, or several.
    let minima = || {
        all().map(|w| Hull {
            lo: w.place.point,
            hi: w.place.point,
        })
    };
    let width = |h: Hull| (h.hi - h.lo).length();
    let isolated = if all().all(|w| w.convex) {
        minima().reduce(Hull::join).map_or(0.0, width) <= feet[1]
    } else {
        width(hull) <= FOOT * feet[0]
    };
    Locus {
        nearest: Nearest {
            surface: best.surface as usize,
            uv: best.place.uv,
            point: best.place.point,
            distance,
            certainty: Certainty::Bounded((distance - lower).max(0.0) + rounding),
        },
        hull: hull.to_box(),
        isolated,
    }
}
