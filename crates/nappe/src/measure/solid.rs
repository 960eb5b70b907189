//! The volumes inside closed surfaces with their centroids and moments of inertia.
//!
//! By Gauss's theorem a homogeneous polynomial f of degree k about a point c has the integral
//! `∫ f dV = ∮ f(r - c) (r - c)·n dA / (3 + k)`: the field `f(r - c) (r - c)` has the divergence (3 + k) f. So volume,
//! first and second moments have one factor in common, and all ten are integrated at once.

use super::area::normal;
use super::centroid::{Centroid, from, quotient, units};
use super::inertia::Inertia;
use super::integral::{Goal, IntegralOptions, Measured, estimate, integrate, measured, of_patch};
use super::taylor::{Patch, Taylor};
use super::volume::{Shell, VolumeError, shells_with};
use crate::box3::Box3;
use crate::interval::Interval;
use crate::mesh::Certainty;
use crate::surface::{Surface, SurfaceRef};
use glam::DVec3;

/// What a shell encloses, filled with a material of density 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// The shell and its volume.
    pub shell: Shell,
    /// The centroid of the volume; `None` if the volume is not known to be more than 0.
    pub centroid: Option<Centroid>,
    /// The inertia about the centroid; `None` as the centroid.
    pub inertia: Option<Inertia>,
}

/// The shells that surfaces make together (see [`shells`](super::shells)), each with centroid and inertia.
///
/// The moments are proven as the volume is, for every way to close gaps that adds no more than ruled strips and cones of
/// area S: these count with `S R / (3 + k)` times half the extents in a moment of degree k. `options.relative` is relative to the volume, and to
/// the volume times half the extents of the shell for each degree. Cost: about twice that of the volume alone.
pub fn solids(
    surfaces: &[SurfaceRef],
    weld: Option<f64>,
    options: &IntegralOptions,
) -> Vec<Result<Solid, VolumeError>> {
    let solid = |(shell, moments): (Shell, Moments)| {
        let (centroid, inertia) = moments.about_centroid().unzip();
        Solid {
            shell,
            centroid,
            inertia,
        }
    };
    let found = shells_with(surfaces, weld, options, 2).into_iter();
    found.map(|one| one.map(solid)).collect()
}

/// The second moments are those of these products of coordinates.
pub(super) const PAIRS: [[usize; 2]; 6] = [[0, 0], [1, 1], [2, 2], [1, 2], [2, 0], [0, 1]];
/// The degrees of the moments: of the volume, of three first and of six second moments.
const DEGREES: [usize; 10] = [0, 1, 1, 1, 2, 2, 2, 2, 2, 2];

/// Moments of a volume about a point.
pub(super) struct Moments {
    centre: DVec3,
    /// In the order of [`DEGREES`]; perhaps the volume alone.
    all: Vec<Interval>,
    proven: bool,
    /// Half the extents of the surfaces.
    half: [f64; 3],
}

/// The moments up to a degree (0 or 2) about the middle of the hull; `true` for surfaces whose normals count the other way.
pub(super) fn moments(
    surfaces: &[(&dyn Surface, bool)],
    hull: Box3,
    options: &IntegralOptions,
    degree: usize,
) -> Moments {
    let (centre, half) = if hull.is_finite() {
        let half = hull.to_array().map(|i| 0.5 * i.width());
        (hull.mid(), units(DVec3::from_array(half)).to_array())
    } else {
        (DVec3::ZERO, [1.0; 3])
    };
    let count = if degree == 0 { 1 } else { DEGREES.len() };
    let flux = |jet: &[Box3], degree: usize| {
        let n = normal(jet, degree);
        let r = [0, 1, 2].map(|axis| from(centre, jet, axis, degree));
        let q = Taylor::dot(&r, &n);
        let share = |t: &Taylor, k: usize| t.scale(Interval::ONE / Interval::point((3 + k) as f64));
        let mut all = vec![share(&q, 0)];
        if count > 1 {
            let first = r.each_ref().map(|r| r.mul(&q));
            all.extend(first.iter().map(|f| share(f, 1)));
            all.extend(PAIRS.map(|[i, j]| share(&r[i].mul(&first[j]), 2)));
        }
        all
    };
    let integrand = of_patch(|p: &Patch, degree: usize| {
        let [wide, at] = [&p.wide, &p.at].map(|j| flux(j, degree));
        wide.into_iter().zip(at).map(|(a, b)| [a, b]).collect()
    });
    let mut goal_units = vec![1.0];
    if count > 1 {
        goal_units.extend(half);
        goal_units.extend(PAIRS.map(|[i, j]| half[i] * half[j]));
    }
    let own: Vec<&dyn Surface> = surfaces.iter().map(|s| s.0).collect();
    let parts = integrate(&own, &integrand, &Goal::several(&goal_units, options));
    let mut found = Moments {
        centre,
        all: vec![Interval::ZERO; count],
        proven: true,
        half: hull.to_array().map(|i| 0.5 * i.width()),
    };
    for (&(surface, turned), mut part) in surfaces.iter().zip(parts) {
        if part.iter().any(|p| !p.is_finite()) {
            let sampled = sampled(surface, centre);
            let error = |m: Measured| Interval::point(m.value).inflate(m.certainty.error());
            part.iter_mut()
                .zip(sampled)
                .for_each(|(p, m)| *p = error(m));
            found.proven = false;
        }
        for (sum, p) in found.all.iter_mut().zip(part) {
            *sum = if turned { *sum - p } else { *sum + p };
        }
    }
    found
}

/// All moments without proof.
fn sampled(surface: &dyn Surface, centre: DVec3) -> [Measured; 10] {
    estimate(surface, 1, &|d| {
        let r = (d[0] - centre).to_array();
        let q = DVec3::from_array(r).dot(d[1].cross(d[2]));
        std::array::from_fn(|k| match k {
            0 => q / 3.0,
            1..4 => r[k - 1] * q / 4.0,
            _ => r[PAIRS[k - 4][0]] * r[PAIRS[k - 4][1]] * q / 5.0,
        })
    })
}

impl Moments {
    pub(super) fn volume(&self) -> Interval {
        self.all[0]
    }

    /// The volume as a number.
    pub(super) fn measured(&self) -> Measured {
        let m = measured(self.all[0], f64::NAN);
        let error = m.certainty.error();
        let certainty = if self.proven && error.is_finite() {
            Certainty::Bounded(error)
        } else {
            Certainty::Estimated(error)
        };
        Measured { certainty, ..m }
    }

    /// True if the normals point inwards.
    pub(super) fn is_negative(&self) -> bool {
        self.all[0].mid() < 0.0
    }

    pub(super) fn turn(&mut self) {
        self.all.iter_mut().for_each(|m| *m = -*m);
    }

    /// What surfaces of this area may add that are nowhere farther than `near` from the others, nor than `reach` from the
    /// centre.
    pub(super) fn open(&mut self, area: f64, near: f64, reach: f64, proven: bool) {
        let whole = Interval::point(area) * Interval::point(reach);
        let along = self
            .half
            .map(|h| Interval::point(h) + Interval::point(near));
        let pairs = PAIRS.map(|[i, j]| along[i] * along[j]);
        let greatest = [&[Interval::ONE], &along[..], &pairs[..]].concat();
        for ((m, k), f) in self.all.iter_mut().zip(DEGREES).zip(greatest) {
            let most = whole * f / Interval::point((3 + k) as f64);
            *m = m.inflate(most.hi);
        }
        self.proven &= proven;
    }

    /// Centroid and inertia by Steiner's theorem; `None` if the volume may be 0.
    fn about_centroid(&self) -> Option<(Centroid, Inertia)> {
        let [volume, x, y, z, ref second @ ..] = self.all[..] else {
            return None;
        };
        let first = [x, y, z];
        let centroid = quotient(self.centre, volume, first, self.proven)?;
        let mut about = [[Interval::ZERO; 3]; 3];
        for ([i, j], &m) in PAIRS.into_iter().zip(second) {
            let product = if i == j {
                first[i].sqr()
            } else {
                first[i] * first[j]
            };
            let moved = m - product / volume;
            about[i][j] = moved;
            about[j][i] = moved;
        }
        if !about.iter().flatten().all(|m| m.is_finite()) {
            return None;
        }
        Some((centroid, Inertia::of_moments(about, self.proven)))
    }
}
