//! Triangles for one cell: a rectangle of parameters with extra vertices on its sides.
//!
//! Every triangle has its corners on at least two sides and never all three on one: none is degenerate in the plane of
//! the parameters. No vertex is added inside, but for a fan around a vertex in the middle.

use crate::surface::Side;

/// The vertices of a cell, counter-clockwise chains that include their end corners: south and north run along u, west
/// and east along v.
pub(super) struct Cell<'a> {
    pub(super) south: &'a [u32],
    pub(super) north: &'a [u32],
    pub(super) west: &'a [u32],
    pub(super) east: &'a [u32],
}

impl Cell<'_> {
    pub(super) fn side(&self, side: Side) -> &[u32] {
        match side {
            Side::South => self.south,
            Side::North => self.north,
            Side::West => self.west,
            Side::East => self.east,
        }
    }

    /// Hands out the triangles around a vertex in the middle, counter-clockwise in (u, v): none has its corners on the
    /// sides alone.
    pub(super) fn fan(&self, middle: u32, mut emit: impl FnMut([u32; 3])) {
        let forward = |chain: &[u32], emit: &mut dyn FnMut([u32; 3])| {
            chain.windows(2).for_each(|e| emit([e[0], e[1], middle]));
        };
        let backward = |chain: &[u32], emit: &mut dyn FnMut([u32; 3])| {
            chain.windows(2).for_each(|e| emit([e[1], e[0], middle]));
        };
        forward(self.south, &mut emit);
        forward(self.east, &mut emit);
        backward(self.north, &mut emit);
        backward(self.west, &mut emit);
    }

    /// Hands out the triangles of a cell with a side that is one point, counter-clockwise in (u, v). Only the first has
    /// two corners on the same side next to the point, besides it: such a side may be straight, and a triangle with all
    /// corners on a straight side has no area in space.
    pub(super) fn around_tip(
        &self,
        collapsed: Side,
        quality: impl Fn([u32; 3]) -> f64,
        mut emit: impl FnMut([u32; 3]),
    ) {
        let on = |chain: &[u32]| chain.to_vec();
        let back = |chain: &[u32]| chain.iter().rev().copied().collect::<Vec<u32>>();
        // Counter-clockwise: the side that leaves the tip, the opposite one, and the other that leaves the tip.
        let [first, opposite, last] = match collapsed {
            Side::West => [on(self.south), on(self.east), on(self.north)],
            Side::South => [on(self.east), back(self.north), on(self.west)],
            Side::East => [back(self.north), back(self.west), back(self.south)],
            Side::North => [back(self.west), on(self.south), back(self.east)],
        };
        let inner = |chain: &[u32]| chain[1..chain.len() - 1].to_vec();
        let (tip, from, to) = (first[0], opposite[0], opposite[opposite.len() - 1]);
        let (right, left, end) = if last.len() > 2 {
            let right = [&first[1..], &inner(&opposite)].concat();
            (right, inner(&last), to)
        } else if first.len() > 2 {
            let left = back(&opposite[1..]);
            (inner(&first), left, from)
        } else {
            zip(&opposite, &[tip], quality, emit);
            return;
        };
        emit([tip, right[0], left[0]]);
        zip(&right, &left, quality, &mut emit);
        emit([right[right.len() - 1], end, left[left.len() - 1]]);
    }

    /// Hands out the triangles, counter-clockwise in (u, v). `quality` is larger for better shaped triangles.
    pub(super) fn triangles(
        &self,
        quality: impl Fn([u32; 3]) -> f64,
        mut emit: impl FnMut([u32; 3]),
    ) {
        if self.west.len() == 2 && self.east.len() == 2 {
            if self.south.len() == 2 && self.north.len() == 2 {
                let [a, b] = [self.south[0], self.south[1]];
                let [d, c] = [self.north[0], self.north[1]];
                let along = [[a, b, c], [a, c, d]];
                let across = [[a, b, d], [b, c, d]];
                let worst = |t: &[[u32; 3]; 2]| quality(t[0]).min(quality(t[1]));
                let chosen = if worst(&along) >= worst(&across) {
                    along
                } else {
                    across
                };
                chosen.into_iter().for_each(emit);
            } else {
                zip(self.south, self.north, quality, emit);
            }
        } else if self.south.len() == 2 && self.north.len() == 2 {
            zip(self.east, self.west, quality, emit);
        } else {
            // From the north-west corner to the south-east corner, on both ways around.
            let mut right: Vec<u32> = self.west.iter().rev().copied().collect();
            right.extend(&self.south[1..]);
            let mut left = self.north.to_vec();
            left.extend(self.east[..self.east.len() - 1].iter().rev());
            let (r, l) = (right.len(), left.len());
            emit([right[0], right[1], left[1]]);
            zip(&right[1..r - 1], &left[1..l - 1], quality, &mut emit);
            emit([right[r - 2], right[r - 1], left[l - 2]]);
        }
    }
}

/// Triangulates the strip between two chains that run the same way, the first on the right.
fn zip(
    right: &[u32],
    left: &[u32],
    quality: impl Fn([u32; 3]) -> f64,
    mut emit: impl FnMut([u32; 3]),
) {
    let (mut i, mut j) = (0, 0);
    while i + 1 < right.len() || j + 1 < left.len() {
        let on_right = (i + 1 < right.len()).then(|| [right[i], right[i + 1], left[j]]);
        let on_left = (j + 1 < left.len()).then(|| [right[i], left[j + 1], left[j]]);
        match (on_right, on_left) {
            (Some(r), Some(l)) if quality(l) > quality(r) => {
                emit(l);
                j += 1;
            }
            (Some(r), _) => {
                emit(r);
                i += 1;
            }
            (None, Some(l)) => {
                emit(l);
                j += 1;
            }
            (None, None) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The ends of south, north, west and east among the corners.
    const ENDS: [[usize; 2]; 4] = [[0, 1], [2, 3], [0, 2], [1, 3]];

    /// A cell in the plane with some vertices between the ends of its sides.
    struct Plane {
        points: Vec<[f64; 2]>,
        chains: [Vec<u32>; 4],
    }

    impl Plane {
        fn new(corners: [[f64; 2]; 4], extra: [u32; 4]) -> Self {
            let mut points = corners.to_vec();
            let chains = [0, 1, 2, 3].map(|s| {
                let [a, b] = ENDS[s];
                let (p, q) = (corners[a], corners[b]);
                let mut chain = vec![a as u32];
                for k in 1..=extra[s] {
                    let t = f64::from(k) / f64::from(extra[s] + 1);
                    points.push([p[0] + (q[0] - p[0]) * t, p[1] + (q[1] - p[1]) * t]);
                    chain.push(points.len() as u32 - 1);
                }
                chain.push(b as u32);
                chain
            });
            Self { points, chains }
        }

        fn cell(&self) -> Cell<'_> {
            let [south, north, west, east] = &self.chains;
            Cell {
                south,
                north,
                west,
                east,
            }
        }

        fn area(&self, t: [u32; 3]) -> f64 {
            let [a, b, c] = t.map(|i| self.points[i as usize]);
            0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
        }
    }

    const UNIT: [[f64; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];

    /// Points of a unit cell with the given numbers of extra points: the triangles are counter-clockwise, not
    /// degenerate and add up to the cell.
    #[test]
    fn cells_are_covered_once() {
        for code in 0..4u32.pow(4) {
            let extra = [0, 1, 2, 3].map(|k| code / 4u32.pow(k) % 4);
            let mut plane = Plane::new(UNIT, extra);
            let (mut sum, mut count) = (0.0, 0);
            plane.cell().triangles(
                |t| plane.area(t),
                |t| {
                    assert!(plane.area(t) > 1e-9, "{t:?} with {extra:?}");
                    sum += plane.area(t);
                    count += 1;
                },
            );
            assert!((sum - 1.0).abs() < 1e-12);
            assert_eq!(count, 2 + extra.iter().sum::<u32>());
            plane.points.push([0.5, 0.5]);
            let middle = plane.points.len() as u32 - 1;
            let mut sum = 0.0;
            plane.cell().fan(middle, |t| {
                assert!(plane.area(t) > 1e-9 && t.contains(&middle));
                sum += plane.area(t);
            });
            assert!((sum - 1.0).abs() < 1e-12);
        }
    }

    /// A cell whose side is one point is, in space, a triangle with straight sides: it is covered once, by triangles that
    /// all have an area, whichever side it is and whatever vertices its sides have.
    #[test]
    fn cells_with_a_tip_are_covered_once() {
        for (code, collapsed) in (0..4u32.pow(4)).flat_map(|c| Side::ALL.map(|s| (c, s))) {
            let mut extra = [0, 1, 2, 3].map(|k| code / 4u32.pow(k) % 4);
            extra[collapsed as usize] = 0;
            // Both ends are in the middle of the side.
            let mut corners = UNIT;
            let [a, b] = ENDS[collapsed as usize];
            let tip = [0, 1].map(|k| 0.5 * (UNIT[a][k] + UNIT[b][k]));
            (corners[a], corners[b]) = (tip, tip);
            let plane = Plane::new(corners, extra);
            let mut sum = 0.0;
            plane.cell().around_tip(
                collapsed,
                |t| plane.area(t),
                |t| {
                    assert!(plane.area(t) > 1e-9, "{t:?} with {extra:?} at {collapsed}");
                    sum += plane.area(t);
                },
            );
            assert!(
                (sum - 0.5).abs() < 1e-12,
                "{sum} with {extra:?} at {collapsed}"
            );
        }
    }
}
