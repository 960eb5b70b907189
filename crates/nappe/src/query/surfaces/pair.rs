//! The equations `a(u, v) = b(s, t)` of two surfaces: three for four parameters, so that their solutions are curves.

use crate::box3::Box3;
use crate::interval::Interval;
use crate::query::extended::{surface_at, surface_over};
use crate::query::solve::{encloses, intersection, inverse};
use crate::surface::{SurfaceRef, enclose_direct};
use glam::DVec3;
use std::array::from_fn;

/// The parameters `(u, v, s, t)` of a point on both surfaces.
pub(super) type Place = [f64; 4];
/// Ranges of them.
pub(super) type Box4 = [Interval; 4];

/// Steps of Newton's method.
const STEPS: usize = 16;
/// How often the box around a point is widened until the proof holds.
const WIDENED: usize = 8;

/// Two surfaces, each over a rectangle of its parameters without a crease inside; beyond the rectangles they go on smoothly.
#[derive(Clone, Debug)]
pub(super) struct Pair {
    pub(super) surfaces: [SurfaceRef; 2],
    pub(super) rect: Box4,
    /// The rectangles with a margin: curves that leave `rect` but not this one run along a side.
    pub(super) outer: Box4,
    /// The size of the smaller part, for the lengths of steps.
    pub(super) size: f64,
}

/// What the equations say over a box: `a - b`, and its derivatives by the four parameters.
pub(super) struct Over {
    pub(super) value: Box3,
    pub(super) columns: [Box3; 4],
}

/// A point of a curve, proven.
#[derive(Clone, Copy, Debug)]
pub(super) struct Knot {
    pub(super) x: Place,
    /// There is exactly one solution with the same parameter `k`, and it is in here.
    pub(super) zero: Box4,
    /// The derivatives of the parameters by the length of the curve in space, which runs along the cross product of the normals.
    pub(super) tangent: Place,
    /// How far a step of each parameter goes in space.
    pub(super) scale: Place,
}

/// Krawczyk's operator for three of the parameters, the fourth one, `k`, being any number of its range in the box.
///
/// If the image of the other three lies inside the box, then for each value of parameter k there is exactly one solution in
/// the box, and it depends on k smoothly: one arc. Source: Neumaier, *Interval methods for systems of equations* (1990), §5.1.
pub(super) struct Contraction {
    pub(super) k: usize,
    pub(super) image: Box4,
    /// About the inverse of the derivatives by the other three.
    pub(super) y: [[f64; 3]; 3],
    /// Bounds for `|1 - Y J|` over the box.
    pub(super) error: [[f64; 3]; 3],
    /// What the equations say over the box.
    pub(super) over: Over,
}

/// The parameters other than k.
pub(super) fn others(k: usize) -> [usize; 3] {
    from_fn(|i| i + usize::from(i >= k))
}

/// The direction in which four vectors of three numbers have no sum, by Cramer's rule.
pub(super) fn null(g: &[DVec3; 4]) -> Place {
    let det = |a: usize, b: usize, c: usize| g[a].dot(g[b].cross(g[c]));
    [-det(1, 2, 3), det(0, 2, 3), -det(0, 1, 3), det(0, 1, 2)]
}

impl Pair {
    /// The equations over a box.
    pub(super) fn over(&self, x: &Box4) -> Over {
        let [a, b] = [0, 1].map(|n| {
            let (rect, uv) = (
                [self.rect[2 * n], self.rect[2 * n + 1]],
                [x[2 * n], x[2 * n + 1]],
            );
            surface_over(self.surfaces[n].as_ref(), rect, uv)
        });
        let minus = |b: Box3| Box3::ZERO - b;
        Over {
            value: a[0] - b[0],
            columns: [a[1], a[2], minus(b[1]), minus(b[2])],
        }
    }

    /// The difference of the points at a place, and its derivatives, in numbers.
    pub(super) fn at(&self, x: &Place) -> (DVec3, [DVec3; 4]) {
        let [a, b] = [0, 1].map(|n| {
            let rect = [self.rect[2 * n], self.rect[2 * n + 1]];
            surface_at(self.surfaces[n].as_ref(), rect, [x[2 * n], x[2 * n + 1]])
        });
        (a[0] - b[0], [a[1], a[2], -b[1], -b[2]])
    }

    /// The nearest place inside the rectangles.
    pub(super) fn held(&self, x: Place) -> Place {
        from_fn(|j| x[j].clamp(self.rect[j].lo, self.rect[j].hi))
    }

    /// The part of a box in the rectangles, or the side beside it.
    pub(super) fn inside(&self, x: &Box4) -> Box4 {
        let (lo, hi) = (self.held(x.map(|t| t.lo)), self.held(x.map(|t| t.hi)));
        from_fn(|j| Interval {
            lo: lo[j],
            hi: hi[j],
        })
    }

    /// The point of the first surface.
    pub(super) fn point(&self, x: Place) -> DVec3 {
        let x = self.held(x).map(Interval::point);
        enclose_direct(self.surfaces[0].as_ref(), [x[0], x[1]], 0)[0].mid()
    }

    /// A solution near a place, by steps of least length in space; `None` where there seems to be none.
    pub(super) fn near(&self, guess: Place) -> Option<Place> {
        let mut x = guess;
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let (f, columns) = self.at(&x);
            let scale = columns.map(|c| 1.0 / c.length().max(f64::MIN_POSITIVE));
            let unit: [DVec3; 4] = from_fn(|j| columns[j] * scale[j]);
            let square: [[f64; 3]; 3] =
                from_fn(|i| from_fn(|l| unit.iter().map(|c| c[i] * c[l]).sum()));
            let y = inverse(square)?;
            let w = DVec3::from_array(from_fn(|i| (0..3).map(|l| y[i][l] * f[l]).sum()));
            let step: Place = from_fn(|j| scale[j] * unit[j].dot(w));
            x = self.toward(x, from_fn(|j| x[j] - step[j]))?;
            let length = f.length();
            if length >= last && length <= 1e-9 * self.size {
                break;
            }
            // No way there: a curve is begun from somewhere else, or there is none.
            if length > 2.0 * last {
                return None;
            }
            last = length;
        }
        (last <= 1e-9 * self.size).then_some(x)
    }

    /// A step, not much farther than the rectangles reach; `None` if it is no number.
    fn toward(&self, from: Place, to: Place) -> Option<Place> {
        if !to.iter().all(|t| t.is_finite()) {
            return None;
        }
        Some(from_fn(|j| {
            let w = self.rect[j].width();
            to[j]
                .clamp(from[j] - 0.25 * w, from[j] + 0.25 * w)
                .clamp(self.rect[j].lo - 0.1 * w, self.rect[j].hi + 0.1 * w)
        }))
    }

    /// The solution near a place that has its parameter k, in numbers.
    pub(super) fn with(&self, guess: Place, k: usize) -> Option<Place> {
        let at = others(k);
        let mut x = guess;
        let mut last = f64::INFINITY;
        for _ in 0..STEPS {
            let (f, columns) = self.at(&x);
            let a = from_fn(|i| from_fn(|l| columns[at[l]][i]));
            let y = inverse::<3>(a)?;
            let step: [f64; 3] = from_fn(|i| (0..3).map(|l| y[i][l] * f[l]).sum());
            let longest = (0..3)
                .map(|i| step[i].abs() / self.rect[at[i]].width())
                .fold(0.0, f64::max);
            // As good as rounding allows, or no convergence.
            if longest >= last {
                return (last <= 1e-6).then_some(x);
            }
            last = longest;
            for i in 0..3 {
                x[at[i]] -= step[i];
                let w = self.rect[at[i]].width();
                if !(x[at[i]] - guess[at[i]]).is_finite() || (x[at[i]] - guess[at[i]]).abs() > w {
                    return None;
                }
            }
            if longest == 0.0 {
                break;
            }
        }
        Some(x)
    }

    /// The proven solution near a place that has its parameter k.
    pub(super) fn knot(&self, guess: Place, k: usize) -> Option<Knot> {
        let x = self.with(guess, k)?;
        let o = self.over(&x.map(Interval::point));
        let at = others(k);
        let a = from_fn(|i| from_fn(|l| o.columns[at[l]].mid()[i]));
        let y = inverse::<3>(a)?;
        let f = o.value.to_array();
        let mut around = [0.0; 4];
        for i in 0..3 {
            let off = (0..3).fold(Interval::ZERO, |s, l| s + Interval::point(y[i][l]) * f[l]);
            let j = at[i];
            around[j] = 4.0 * off.mag() + 4.0 * f64::EPSILON * self.rect[j].mag();
        }
        for _ in 0..WIDENED {
            let mut wide = x.map(Interval::point);
            for &j in &at {
                wide[j] = wide[j].inflate(around[j]);
            }
            let c = self.contraction(&x, &wide, k)?;
            if c.proves(&wide) {
                return self.known(x, intersection(&c.image, &wide)?);
            }
            around = around.map(|r| 8.0 * r);
        }
        None
    }

    fn known(&self, x: Place, zero: Box4) -> Option<Knot> {
        let (_, g) = self.at(&x);
        let null = null(&g);
        let speed = (g[0] * null[0] + g[1] * null[1]).length();
        let tangent = null.map(|n| n / speed);
        tangent.iter().all(|t| t.is_finite()).then_some(Knot {
            x,
            zero,
            tangent,
            scale: g.map(DVec3::length),
        })
    }

    /// The operator about a place in a box; `None` where the derivatives are too uncertain.
    pub(super) fn contraction(&self, centre: &Place, x: &Box4, k: usize) -> Option<Contraction> {
        let at = others(k);
        let over = self.over(x);
        let slopes: [[Interval; 3]; 3] =
            from_fn(|i| from_fn(|l| over.columns[at[l]].to_array()[i]));
        if !slopes.as_flattened().iter().all(|s| s.is_finite()) {
            return None;
        }
        let y = inverse(slopes.map(|row| row.map(Interval::mid)))?;
        let mut middle = centre.map(Interval::point);
        let still = Interval::point(x[k].mid());
        middle[k] = still;
        let f = self.over(&middle).value.to_array();
        // Along parameter k by the mean value theorem: the three equations move together.
        middle[k] = x[k];
        let along = self.over(&middle).columns[k].to_array();
        let mut error = [[0.0; 3]; 3];
        let mut image = *x;
        for i in 0..3 {
            let row = |c: &dyn Fn(usize) -> Interval| {
                (0..3).fold(Interval::ZERO, |s, l| s + Interval::point(y[i][l]) * c(l))
            };
            let way = row(&|l| along[l]) * (x[k] - still);
            let mut sum = middle[at[i]] - row(&|l| f[l]) - way;
            for j in 0..3 {
                let unit = if i == j {
                    Interval::ONE
                } else {
                    Interval::ZERO
                };
                let e = unit - row(&|l| slopes[l][j]);
                error[i][j] = e.mag();
                sum = sum + e * (x[at[j]] - middle[at[j]]);
            }
            image[at[i]] = sum;
        }
        image.iter().all(|k| k.is_finite()).then_some(Contraction {
            k,
            image,
            y,
            error,
            over,
        })
    }
}

impl Contraction {
    /// True if there is one arc over the whole range of parameter k in the box.
    pub(super) fn proves(&self, x: &Box4) -> bool {
        encloses(x, &self.image)
            && others(self.k)
                .iter()
                .all(|&j| x[j].lo < self.image[j].lo && self.image[j].hi < x[j].hi)
    }

    /// Y times three numbers.
    pub(super) fn times(&self, f: Box3) -> [Interval; 3] {
        let f = f.to_array();
        from_fn(|i| {
            (0..3).fold(Interval::ZERO, |s, l| {
                s + Interval::point(self.y[i][l]) * f[l]
            })
        })
    }

    /// A bound for |d| from one for |Y M d|, M being among the derivatives over the box: `z = r + |1 - Y J| z` has a solution
    /// z, and `|d| ≤ z`. `None` if none is found.
    pub(super) fn solved(&self, r: [f64; 3]) -> Option<[f64; 3]> {
        let next = |z: [f64; 3]| -> [f64; 3] {
            from_fn(|i| r[i] + (0..3).map(|l| self.error[i][l] * z[l]).sum::<f64>())
        };
        let mut z = r;
        for _ in 0..60 {
            z = next(z);
        }
        let largest = z.iter().copied().fold(0.0, f64::max);
        let z = z.map(|z| z * (1.0 + 1e-9) + largest * 1e-9);
        let proven = next(z);
        (0..3)
            .all(|i| proven[i] * (1.0 + 1e-12) <= z[i])
            .then_some(z)
    }

    /// The derivatives of the other parameters by parameter k, anywhere on the arc.
    pub(super) fn slopes(&self) -> Option<[Interval; 3]> {
        let straight = self.times(self.over.columns[self.k]);
        let z = self.solved(straight.map(Interval::mag))?;
        Some(from_fn(|i| {
            let rest: f64 = (0..3).map(|l| self.error[i][l] * z[l]).sum();
            (Interval::ZERO - straight[i]).inflate(rest * (1.0 + 1e-12))
        }))
    }
}
