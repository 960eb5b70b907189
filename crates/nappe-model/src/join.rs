//! Surfaces that belong together: a patch complex without gaps.

use crate::build::{Builder, Built, Patch};
use crate::curves::need;

use crate::data::{Datum, Item, Object};
use nappe::curve::{Curve, Isocurve};
use nappe::surface::Side;
use nappe::{Box3, DVec3};

/// The greatest gap allowed along a shared side when nothing is said, relative to the size of the members.
const DEFAULT_GAP: f64 = 1e-6;
/// Sides whose ends are this near, relative to the size, are meant to be shared: if they part in between, that is
/// reported as a gap and not taken for two free sides.
const MEANT: f64 = 1e-2;
/// Points at which two sides are compared.
const SAMPLES: usize = 33;
/// Points of the other side among which the nearest is looked for, and steps that then refine it.
const COARSE: usize = 65;
const REFINE: usize = 60;

/// A side of a member.
struct Border {
    member: usize,
    side: Side,
    points: Vec<DVec3>,
    curve: Isocurve,
}

impl Builder<'_> {
    /// A join: its members must hang together, sides that are meant to be shared must not gap.
    pub(crate) fn join(&mut self, o: &Object) -> Built<Vec<Patch>> {
        let items: Vec<Item> = need(o.fields.list("surfaces"))?.to_vec();
        let label = format!("{}, `surfaces`", o.label);
        let mut members: Vec<(String, Patch, usize)> = Vec::new();
        let mut stop = None;
        for (i, item) in items.iter().enumerate() {
            let Datum::Text(name) = &item.datum else {
                continue;
            };
            let found = if name.contains('/') {
                self.surface(name, &label, &item.span)
                    .map(|s| std::sync::Arc::new(Patch::one(s)))
            } else {
                self.patches(name, &label, &item.span)
            };
            match found {
                Ok(patches) => members.extend(patches.iter().map(|p| {
                    let full = p
                        .suffix
                        .as_ref()
                        .map_or(name.clone(), |s| format!("{name}/{s}"));
                    (full, p.clone(), i)
                })),
                Err(s) => stop = Some(s),
            }
        }
        if let Some(s) = stop {
            return Err(s);
        }
        if members.is_empty() {
            return Err(self.refuse(
                o,
                ("surfaces", &[]),
                "no surfaces are named",
                "name at least one surface",
            ));
        }
        let size = Box3::around(members.iter().flat_map(|(_, p, _)| corner_points(p)))
            .map_or(0.0, Box3::diagonal);
        let tol = match o.fields.number("tolerance") {
            Some(t) if t > 0.0 => t,
            Some(t) => {
                let message = format!("the tolerance is {t}: it must be greater than 0");
                return Err(self.refuse(o, ("tolerance", &[]), message, "write a length"));
            }
            None => DEFAULT_GAP * size,
        };
        self.compare(o, &members, size, tol)?;
        Ok(members
            .into_iter()
            .map(|(name, p, _)| Patch {
                suffix: Some(name),
                ..p
            })
            .collect())
    }

    /// Reports sides that gap and members that touch no other.
    fn compare(
        &mut self,
        o: &Object,
        members: &[(String, Patch, usize)],
        size: f64,
        tol: f64,
    ) -> Built<()> {
        let borders: Vec<Border> = members
            .iter()
            .enumerate()
            .flat_map(|(member, (_, p, _))| {
                Side::ALL.map(|side| {
                    let curve = Isocurve::side(p.surface.clone(), side);
                    let points = samples(&curve);
                    Border {
                        member,
                        side,
                        points,
                        curve,
                    }
                })
            })
            .collect();
        let mut group: Vec<usize> = (0..members.len()).collect();
        let mut result = Ok(());
        for (i, a) in borders.iter().enumerate() {
            for b in &borders[i + 1..] {
                if a.member == b.member || !ends_meet(a, b, (MEANT * size).max(tol)) {
                    continue;
                }
                let (gap, at) = gap(a, b);
                if gap <= tol {
                    let (from, to) = (group[b.member], group[a.member]);
                    group
                        .iter_mut()
                        .filter(|g| **g == from)
                        .for_each(|g| *g = to);
                } else if gap <= MEANT * size {
                    let (na, nb) = (&members[a.member].0, &members[b.member].0);
                    let message = format!(
                        "{na}.{} and {nb}.{} gap by {gap:.6e} near ({:.6}, {:.6}, {:.6}) (allowed: {tol:.1e})",
                        a.side, b.side, at.x, at.y, at.z
                    );
                    let help = "let both surfaces use the same curve, or raise `tolerance`";
                    result =
                        Err(self.refuse(o, ("surfaces", &[members[b.member].2]), message, help));
                }
            }
        }
        result?;
        let Some(lone) = group.iter().position(|g| *g != group[0]) else {
            return Ok(());
        };
        let message = format!(
            "{} shares no side with {} and its neighbours",
            members[lone].0, members[0].0
        );
        let help = "surfaces share a side when they use the same curve or side; leave this one out otherwise";
        Err(self.refuse(o, ("surfaces", &[members[lone].2]), message, help))
    }
}

fn corner_points(p: &Patch) -> [DVec3; 4] {
    let [u, v] = p.surface.domain();
    [[u.lo, v.lo], [u.lo, v.hi], [u.hi, v.lo], [u.hi, v.hi]].map(|uv| p.surface.point(uv))
}

fn samples(c: &dyn Curve) -> Vec<DVec3> {
    let d = c.domain();
    (0..SAMPLES)
        .map(|i| c.point(d.lo + (d.hi - d.lo) * i as f64 / (SAMPLES - 1) as f64))
        .collect()
}

/// True if the two sides join the same two points, in either order.
fn ends_meet(a: &Border, b: &Border, tol: f64) -> bool {
    let ([a0, a1], [b0, b1]) = (a.curve.ends(), b.curve.ends());
    let near = |p: DVec3, q: DVec3| p.distance(q) <= tol;
    (near(a0, b0) && near(a1, b1)) || (near(a0, b1) && near(a1, b0))
}

/// The greatest distance of the samples of one side from the other, and where.
fn gap(a: &Border, b: &Border) -> (f64, DVec3) {
    let mut worst = (0.0, a.points[0]);
    for &p in &a.points {
        let d = distance(p, &b.curve);
        if d > worst.0 {
            worst = (d, p);
        }
    }
    worst
}

/// The distance of a point from a curve: the nearest of some points, refined by golden sections.
fn distance(p: DVec3, c: &dyn Curve) -> f64 {
    let d = c.domain();
    let t = |i: usize| d.lo + (d.hi - d.lo) * i as f64 / (COARSE - 1) as f64;
    let at = |t: f64| c.point(t).distance(p);
    let nearest = (0..COARSE)
        .min_by(|&i, &j| at(t(i)).total_cmp(&at(t(j))))
        .unwrap_or(0);
    let (mut lo, mut hi) = (
        t(nearest.saturating_sub(1)),
        t((nearest + 1).min(COARSE - 1)),
    );
    let mut best = at(t(nearest));
    for _ in 0..REFINE {
        let (a, b) = (lo + (hi - lo) * 0.381_966, lo + (hi - lo) * 0.618_034);
        let (fa, fb) = (at(a), at(b));
        best = best.min(fa).min(fb);
        if fa < fb { hi = b } else { lo = a }
    }
    best
}
