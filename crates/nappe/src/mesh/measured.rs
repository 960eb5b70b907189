//! How far the triangles of one square are from the surface: measured at samples, bounded between them.
//!
//! The bound of `partners` multiplies the greatest derivatives with the greatest turns of the normal. In squares of a few
//! triangles that says several times too much. Here each triangle is cut into up to [`K`]² equal ones; their corners `p_s`
//! get partners `p_s + d_s` like there, and the partner of `p = Σ λ_s p_s` is `p + Σ λ_s d_s`. As `L` is linear,
//!
//! `r(p + d) - L(p) = Σ λ_s (r(p_s + d_s) - L(p_s)) + [r(Σ λ_s (p_s + d_s)) - Σ λ_s r(p_s + d_s)]`:
//!
//! at most the largest of the distances at the samples, which are measured, and the error of interpolation over a part
//! that is so many times smaller (`bound`). The choice of partners keeps the sides of the domain; it depends on `p_s` and
//! `L(p_s)` alone, and so is continuous, but for edges between triangles that are cut into other parts. So this is one more
//! kind of square in the theorem of `partners`.

use super::partners::{BETWEEN, Place, greatest, greatest_of};
use crate::box3::Box3;
use crate::breaks::inwards;
use crate::surface::{Surface, jet_len};
use glam::DVec3;

/// The most parts of a triangle's edge.
const K: usize = 8;
/// The parts that are tried: few are often enough.
pub(super) const PARTS: [usize; 2] = [K / 2, K];

/// The most bisections that can be measured: smaller triangles have too few samples.
pub(super) const LEVELS: u32 = 4;

/// The triangles of a square after some bisections, in steps of samples, with the parts of their edges. The diagonal leads
/// up if the lower corner is even.
fn triangles(level: u32, even: bool, k: usize) -> (Vec<[[usize; 2]; 3]>, usize) {
    let [a, b, c, d] = [[0, 0], [2 * k, 0], [2 * k, 2 * k], [0, 2 * k]];
    let mut all = if even {
        vec![[b, c, a], [d, a, c]]
    } else {
        vec![[a, b, d], [c, d, b]]
    };
    for _ in 0..level {
        let halves = |[a, b, c]: [[usize; 2]; 3]| {
            let m = [0, 1].map(|d| (b[d] + c[d]) / 2);
            [[m, a, b], [m, c, a]]
        };
        all = all.into_iter().flat_map(halves).collect();
    }
    // Corners of parts are samples: the right angle of an odd triangle is half as far away as the others.
    let parts = ((2 * k) >> level.div_ceil(2)).min(k);
    (all, parts)
}

/// True if one of so many samples along each side is on one of the marked sides.
fn is_on([i, j]: [usize; 2], wide: usize, [south, north, west, east]: [bool; 4]) -> bool {
    (south && j == 0) || (north && j + 1 == wide) || (west && i == 0) || (east && i + 1 == wide)
}

/// The samples of a square.
pub(super) struct Samples {
    /// The most parts of a triangle's edge: there are twice as many along the sides of the square, since triangles around
    /// its centre have corners in the middle.
    k: usize,
    /// The point and the derivatives along the sides of the square, v fastest.
    jets: Vec<[DVec3; 3]>,
    /// The greatest second derivatives along the sides of the square.
    second: [f64; 3],
    /// Where partners may be, as shares of the square.
    room: [[f64; 2]; 2],
    /// What partners may add.
    most: f64,
}

impl Samples {
    /// Takes the samples; `jet` is an enclosure of order 2 over the surroundings.
    pub(super) fn new(
        surface: &dyn Surface,
        place: &Place,
        jet: &[Box3],
        k: usize,
        tol: f64,
    ) -> Self {
        let wide = 2 * k + 1;
        let size = place.uv.map(|r| r.width());
        let params = place.uv.map(|r| -> Vec<f64> {
            (0..wide)
                .map(|k| match k {
                    0 => r.lo,
                    _ if k + 1 == wide => r.hi,
                    _ => r.lo + r.width() * (k as f64 / (wide - 1) as f64),
                })
                .collect()
        });
        let mut jets = vec![[DVec3::ZERO; jet_len(1)]; wide * wide];
        let [us, vs] = &params;
        if surface.domain() == place.block {
            surface.grid_jets(us, vs, 1, jets.as_flattened_mut());
        } else {
            // Derivatives from inside the block.
            let uv = us.iter().flat_map(|&u| vs.iter().map(move |&v| [u, v]));
            for (uv, jet) in uv.zip(&mut jets) {
                surface.jet_into(uv, inwards(uv, place.block), 1, jet);
            }
        }
        for jet in &mut jets {
            jet[1] *= size[0];
            jet[2] *= size[1];
        }
        Self {
            k,
            jets,
            second: [
                jet[3].norm().hi * size[0] * size[0],
                jet[4].norm().hi * size[0] * size[1],
                jet[5].norm().hi * size[1] * size[1],
            ],
            most: BETWEEN * tol,
            room: [0, 1].map(|d| {
                let [below, above] = place.room(d);
                [-below, 1.0 + above]
            }),
        }
    }

    /// The bound for the triangles after at most [`LEVELS`] bisections; sides marked may get further vertices.
    pub(super) fn error(&self, level: u32, even: bool, open: [bool; 4]) -> f64 {
        let (all, parts) = triangles(level, even, self.k);
        greatest_of(all.into_iter().map(|t| self.triangle(t, parts, open)))
    }

    fn triangle(&self, corners: [[usize; 2]; 3], parts: usize, open: [bool; 4]) -> f64 {
        let at = |[i, j]: [usize; 2]| &self.jets[i * (2 * self.k + 1) + j];
        let tips = corners.map(|c| at(c)[0]);
        let (mut worst, mut edge) = (0.0f64, None);
        let (mut far, mut uneven) = ([0.0f64; 2], [0.0f64; 2]);
        let mut before = [[0.0; 2]; K + 1];
        for i in 0..=parts {
            let mut row = [[0.0; 2]; K + 1];
            for j in 0..=parts - i {
                let weights = [i, j, parts - i - j];
                let place = [0, 1]
                    .map(|d| (0..3).map(|k| weights[k] * corners[k][d]).sum::<usize>() / parts);
                let jet = at(place);
                let [a, b, c] = weights.map(|w| w as f64 / parts as f64);
                let e = tips[0] * a + tips[1] * b + tips[2] * c - jet[0];
                let d = self.partner(place, jet, e);
                let distance = (e - jet[1] * d[0] - jet[2] * d[1]).length();
                if !distance.is_finite() {
                    return f64::INFINITY;
                }
                worst = worst.max(distance);
                if is_on(place, 2 * self.k + 1, open) {
                    edge = Some(e.length().max(edge.unwrap_or(0.0)));
                }
                for k in 0..2 {
                    far[k] = far[k].max(d[k].abs());
                    let mut compare = |o: [f64; 2]| uneven[k] = uneven[k].max((d[k] - o[k]).abs());
                    if j > 0 {
                        compare(row[j - 1]);
                    }
                    if i > 0 {
                        compare(before[j]);
                        compare(before[j + 1]);
                    }
                }
                row[j] = d;
            }
            before = row;
        }
        let size = [0, 1].map(|d| {
            let all = corners.map(|c| c[d]);
            let extent = all.iter().max().unwrap_or(&0) - all.iter().min().unwrap_or(&0);
            extent as f64 / (2 * self.k * parts) as f64 + uneven[d]
        });
        let added = 0.5 * greatest(self.second, far);
        if added <= self.most {
            // Further vertices on an edge move the points of the triangle by no more than the edge leaves the surface.
            let between = 0.125 * greatest(self.second, size);
            let moved = edge.map_or(0.0, |e| e + between);
            worst + added + between + moved
        } else {
            f64::INFINITY
        }
    }

    /// The way to the partner of a sample, as shares of the square: what lies in the tangent plane, but not out of the room
    /// and not away from a side of the block.
    fn partner(&self, place: [usize; 2], [_, a, b]: &[DVec3; 3], e: DVec3) -> [f64; 2] {
        let at = place.map(|k| k as f64 / (2 * self.k) as f64);
        let held = [0, 1].map(|d| self.room[d].contains(&at[d]));
        let d = match held {
            [true, true] => [0.0; 2],
            [false, true] => [a.dot(e) / a.length_squared(), 0.0],
            [true, false] => [0.0, b.dot(e) / b.length_squared()],
            [false, false] => {
                let n = a.cross(*b);
                let area = n.length_squared();
                [e.cross(*b).dot(n) / area, a.cross(e).dot(n) / area]
            }
        };
        [0, 1].map(|k| {
            let [lo, hi] = self.room[k];
            if d[k].is_finite() {
                (at[k] + d[k]).clamp(lo, hi) - at[k]
            } else {
                0.0
            }
        })
    }
}
