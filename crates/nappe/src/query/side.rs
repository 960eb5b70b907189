//! On which side of surfaces a point is.

use super::nearest::{Finder, FinderOptions, Nearest, QueryError, answers};
use super::within::{Effort, Within, within};
use crate::box3::Box3;
use crate::breaks::Breaks;
use crate::measure::{IntegralOptions, VolumeError, bodies, shells};
use crate::mesh::joints;
use crate::surface::{Dir, Side, SurfaceRef};
use glam::DVec3;

/// The nearest point, and on which side of it a point is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Signed {
    /// The nearest point.
    pub nearest: Nearest,
    /// The distance, negative inside of the shell that is nearest, or behind an open surface. `None` where no side is
    /// defined or proven.
    pub distance: Option<f64>,
}

/// Finds nearest points with signs.
///
/// Surfaces that close a shell have an inside, wherever their own normals point; there the distance is negative. Of shells
/// within each other, that of the nearest point counts. Open surfaces have the side of their normal `r_u × r_v`, where the
/// distance is positive; it may differ from face to face where they are joined with normals that disagree. There is no
/// sign near surfaces that are closed without an inside that is known: where more than two sides meet, of one-sided ones,
/// and where the sign of the volume is not above its error. [`SignedFinder::sidedness`] tells which is which.
///
/// What is proven: of all places that may be the nearest, rounding included, the normals were enclosed together with the
/// ways from there to the point, and all of these are on the same side. So there is no sign on the surface itself, and of
/// open surfaces none where an open side or a tear is nearest, at a pole, and at creases where the sides disagree. Of a closed shell
/// there is one at these places too: it is that of another point in the ball around it that no surface enters, for
/// which it is proven in the same way. There must then be room between the point and the shell: a thousand times the distance
/// within which sides are taken for joined (10⁻⁷ of the diagonal).
///
/// What is assumed: that sides which were found to be joined (see [`joints`]) are so along their whole length, that a
/// shell does not pass through itself (see [`overlaps`](crate::measure::overlaps)), and that the sign of its volume is
/// right where that can only be estimated (see [`shells`]).
///
/// ```
/// use nappe::query::{FinderOptions, SignedFinder};
/// use nappe::surface::{Torus, TorusOptions};
/// use nappe::DVec3;
/// use std::sync::Arc;
///
/// let torus = Torus::new(3.0, 1.0, TorusOptions::default()).unwrap();
/// let finder = SignedFinder::new(&[Arc::new(torus)], FinderOptions::default()).unwrap();
/// let inside = finder.nearest(DVec3::new(3.5, 0.0, 0.0)).unwrap();
/// assert!((inside.distance.unwrap() + 0.5).abs() < 1e-7);
/// ```
pub struct SignedFinder {
    finder: Finder,
    /// For each surface what its signs are about.
    own: Vec<Own>,
    /// The sides of each that meet no other, and the parameters where it is torn.
    open: Vec<Vec<Side>>,
    tears: Vec<[Vec<f64>; 2]>,
    weld: f64,
}

/// What the signs near a surface are about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sidedness {
    /// The inside of the shell that it closes, alone or with others.
    Closed,
    /// The side of its normal.
    Open,
    /// It is closed, but its inside is not known: there are no signs.
    Unknown,
}

/// What the signs near a surface are about.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Own {
    /// The shell of this number; true if the normal points into it.
    Shell(usize, bool),
    Open,
    Unknown,
}

impl Own {
    fn shell(self) -> Option<usize> {
        match self {
            Own::Shell(number, _) => Some(number),
            Own::Open | Own::Unknown => None,
        }
    }
}

/// The distance within which sides are joined, as a share of the diagonal.
const WELD: f64 = 1e-7;
/// How many times that the corners of surfaces that meet may be apart.
const APART: f64 = 4.0;
/// How many times that a shell must be away for signs that are taken from elsewhere.
const ROOM: f64 = 1e3;
/// How far to go at once to where a sign is taken from, as a share of the room.
const HOP: f64 = 0.9;
/// How often: around a tip each turns by about 42°.
const HOPS: usize = 4;
/// What is spent on places over which the distance is not convex.
const EFFORT: Effort = Effort {
    size: 0.0,
    halvings: 256,
};
/// What is spent on telling in from out.
const VOLUME: IntegralOptions = IntegralOptions {
    relative: 1e-2,
    budget: 2000,
};

/// What the places that may be the nearest say.
enum Opinion {
    /// All say so: true for outside, or the side of the normal.
    Agreed(bool),
    /// They differ or do not know. The shell that all belong to, if there is one.
    Open(Option<usize>),
}

impl SignedFinder {
    /// Prepares some surfaces, and finds the shells that they close. Errors: as [`Finder::new`]. Cost: that of it, and some
    /// hundred enclosures for each closed surface.
    pub fn new(surfaces: &[SurfaceRef], options: FinderOptions) -> Result<Self, QueryError> {
        let finder = Finder::new(surfaces, options)?;
        let weld = WELD * finder.tree.diagonal;
        let joined = joints(surfaces, weld);
        let mut neighbours = vec![Vec::new(); surfaces.len()];
        for j in &joined.joints {
            let (a, b) = (j.first.0, j.second.0);
            neighbours[a].push((b, j.is_turned()));
            neighbours[b].push((a, j.is_turned()));
        }
        let mut own = vec![Own::Open; surfaces.len()];
        // Both are in the same order.
        let found = shells(surfaces, Some(weld), &VOLUME);
        for (number, (body, shell)) in bodies(&neighbours).into_iter().zip(found).enumerate() {
            match shell {
                Ok(shell) => {
                    let sure = shell.volume.value > shell.volume.certainty.error();
                    for (surface, turned) in shell.surfaces {
                        own[surface] = if sure {
                            Own::Shell(number, turned)
                        } else {
                            Own::Unknown
                        };
                    }
                }
                Err(VolumeError::Branched { .. } | VolumeError::OneSided { .. }) => {
                    for (surface, _) in body.parts {
                        own[surface] = Own::Unknown;
                    }
                }
                Err(_) => {}
            }
        }
        Ok(Self {
            finder,
            own,
            open: joined.open,
            tears: surfaces
                .iter()
                .map(|s| [Dir::U, Dir::V].map(|dir| s.breaks(dir).below(0)))
                .collect(),
            weld,
        })
    }

    /// What the signs near each surface are about.
    pub fn sidedness(&self) -> Vec<Sidedness> {
        let of = |own: &Own| match own {
            Own::Shell(..) => Sidedness::Closed,
            Own::Open => Sidedness::Open,
            Own::Unknown => Sidedness::Unknown,
        };
        self.own.iter().map(of).collect()
    }

    /// The finder of points alone.
    pub fn finder(&self) -> &Finder {
        &self.finder
    }

    /// The nearest point, and its distance with a sign. Errors: as [`Finder::nearest`]. Cost: some times that of it;
    /// where a sign must be taken from elsewhere tens of times, and hundreds of times where no such place is found soon.
    pub fn nearest(&self, p: DVec3) -> Result<Signed, QueryError> {
        let nearest = self.finder.nearest(p)?;
        let outside = match self.opinion(p, &nearest) {
            Opinion::Agreed(outside) => Some(outside),
            Opinion::Open(Some(shell)) => self.around(p, &nearest, shell),
            Opinion::Open(None) => None,
        };
        let sign = |outside| if outside { 1.0 } else { -1.0 };
        Ok(Signed {
            nearest,
            distance: outside.map(|o| sign(o) * nearest.distance),
        })
    }

    /// [`Self::nearest`] for many points, on some threads, in their order and with the same bits on any number of threads.
    pub fn nearest_many(
        &self,
        points: &[DVec3],
        threads: usize,
    ) -> Vec<Result<Signed, QueryError>> {
        answers(points, threads, |p| self.nearest(p))
    }

    /// What all places say that may be the nearest.
    fn opinion(&self, p: DVec3, nearest: &Nearest) -> Opinion {
        let reach = self.finder.reach(p, nearest);
        let mut places = within(&self.finder, p, reach, &EFFORT);
        // At a side, the surface that it is joined to has a say too, even if there is a gap.
        if places.iter().any(|w| self.sides(w).next().is_some()) {
            places = within(&self.finder, p, reach + APART * self.weld, &EFFORT);
        }
        let shell = |w: &Within| self.own[w.surface as usize].shell();
        let first = places.first().and_then(shell);
        let same = first.filter(|_| places.iter().all(|w| shell(w) == first));
        let mut sides = places.iter().map(|w| self.side(p, w));
        let agreed = sides
            .next()
            .flatten()
            .filter(|&first| sides.all(|side| side == Some(first)));
        match agreed {
            Some(outside) => Opinion::Agreed(outside),
            None => Opinion::Open(same),
        }
    }

    /// The sides of its surface that a part's places within reach may be on.
    fn sides(&self, w: &Within) -> impl Iterator<Item = Side> {
        let (uv, domain) = (w.uv, self.finder.shapes[w.surface as usize].domain());
        Side::ALL.into_iter().filter(move |side| {
            let d = side.across() as usize;
            if side.is_upper() {
                uv[d].hi >= domain[d].hi
            } else {
                uv[d].lo <= domain[d].lo
            }
        })
    }

    /// The side that all of a part's places within reach are seen from.
    fn side(&self, p: DVec3, w: &Within) -> Option<bool> {
        let surface = w.surface as usize;
        let shape = &self.finder.shapes[surface];
        if !w.convex || self.own[surface] == Own::Unknown {
            return None;
        }
        let torn = |d: usize| self.tears[surface][d].iter().any(|&t| w.uv[d].contains(t));
        if torn(0) || torn(1) || self.sides(w).any(|s| self.open[surface].contains(&s)) {
            return None;
        }
        let jet = shape.enclose(w.uv, 1);
        let way = Box3::point(p) - jet[0];
        let height = way.dot(jet[1].cross(jet[2]));
        let turned = matches!(self.own[surface], Own::Shell(_, true));
        if height.lo > 0.0 {
            Some(!turned)
        } else if height.hi < 0.0 {
            Some(turned)
        } else {
            None
        }
    }

    /// The side of a shell, as other points see it that no surface parts from this one. The way there leads through balls
    /// that no surface enters: around the nearest point, which may be a tip that is nearest from almost everywhere, and
    /// from there to the surface, where its curvature matters less.
    fn around(&self, p: DVec3, nearest: &Nearest, shell: usize) -> Option<bool> {
        let (e, f) = (nearest.point - p).try_normalize()?.any_orthonormal_pair();
        let ways = [e, f, e + f, e - f].map(|w| [w, -w]);
        let beside = ways.into_iter().flatten().find_map(|mut aside| {
            let (mut q, mut there) = (p, *nearest);
            for _ in 0..HOPS {
                let way = (there.point - q).try_normalize()?;
                aside = aside.reject_from(way).try_normalize()?;
                q += aside * (HOP * self.room(&there)?);
                there = self.finder.nearest(q).ok()?;
                if let Some(outside) = self.towards(q, there, shell) {
                    return Some(outside);
                }
            }
            None
        });
        beside.or_else(|| self.towards(p, *nearest, shell))
    }

    /// The side of a shell, as seen from some points on the way to its nearest point.
    fn towards(&self, mut q: DVec3, mut there: Nearest, shell: usize) -> Option<bool> {
        for _ in 0..HOPS {
            let room = self.room(&there)?;
            if let Opinion::Agreed(outside) = self.opinion(q, &there)
                && self.own[there.surface].shell() == Some(shell)
            {
                return Some(outside);
            }
            q += (there.point - q).try_normalize()? * (HOP * room);
            there = self.finder.nearest(q).ok()?;
        }
        None
    }

    /// How far away all surfaces are at least, if that is far enough.
    fn room(&self, nearest: &Nearest) -> Option<f64> {
        let room = nearest.distance - nearest.certainty.error();
        (room > ROOM * self.weld).then_some(room)
    }
}
