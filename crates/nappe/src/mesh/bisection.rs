//! Triangles that arise by bisection: a net of lines cut into right triangles, each halved as often as need be.
//!
//! Lines of constant u and v divide the domain into cells; the diagonals of neighbouring cells mirror each other. A
//! triangle is halved from its right angle to the middle of its longest side, so all stay right and isosceles in the
//! measure of their cell. The middle of a longest side belongs to two triangles (or one on the border): both are halved
//! or none, and nowhere does a corner of one lie on a side of another. So a triangulation is a set of such middles, its
//! *vertices*, that holds with each one also the right angles of the two triangles that share the side: these triangles
//! have to exist. This is newest-vertex bisection (Maubach, *Local bisection refinement*, 1995).

use rustc_hash::FxHashMap;
use smallvec::{SmallVec, smallvec};

/// A vertex: along u and v, the number of the line below times 2^[`DEPTH`] and the distance from it.
pub(super) type Place = [u64; 2];

/// How often a cell can be halved along each direction.
pub(super) const DEPTH: u32 = 30;
/// The distance of neighbouring lines.
pub(super) const CELL: u64 = 1 << DEPTH;

/// A square of the quadtree over one cell.
#[derive(Clone, Copy, Debug)]
pub(super) struct Square {
    /// The lower corner.
    pub(super) corner: Place,
    /// How often the cell was halved.
    pub(super) depth: u32,
}

impl Square {
    /// A cell of the net of lines.
    pub(super) fn cell(at: [usize; 2]) -> Self {
        Self {
            corner: at.map(|i| (i as u64) << DEPTH),
            depth: 0,
        }
    }

    pub(super) fn size(self) -> u64 {
        CELL >> self.depth
    }

    /// The corner opposite to the lower one.
    pub(super) fn upper(self) -> Place {
        self.corner.map(|x| x + self.size())
    }

    pub(super) fn children(self) -> [Self; 4] {
        let half = self.size() / 2;
        [[0, 0], [half, 0], [0, half], [half, half]].map(|d| Self {
            corner: [self.corner[0] + d[0], self.corner[1] + d[1]],
            depth: self.depth + 1,
        })
    }

    pub(super) fn centre(self) -> Place {
        self.corner.map(|x| x + self.size() / 2)
    }

    /// True if the diagonal of its two triangles leads from the lower corner to the upper one.
    pub(super) fn is_even(self) -> bool {
        let [i, j] = self.corner.map(|x| x / self.size());
        (i + j).is_multiple_of(2)
    }

    fn middles(self) -> [Place; 4] {
        let ([x, y], h) = (self.corner, self.size() / 2);
        [
            [x + h, y],
            [x + h, y + 2 * h],
            [x, y + h],
            [x + 2 * h, y + h],
        ]
    }
}

/// A triangulation.
#[derive(Clone, Debug)]
pub(super) struct Bisection {
    /// The lines of constant u and v, increasing.
    pub(super) lines: [Vec<f64>; 2],
    /// All vertices, those of the net of lines first.
    pub(super) places: Vec<Place>,
    index: FxHashMap<Place, u32>,
}

impl Bisection {
    /// Two triangles for each cell.
    pub(super) fn new(lines: [Vec<f64>; 2]) -> Self {
        let mut out = Self {
            places: Vec::with_capacity(lines[0].len() * lines[1].len()),
            lines,
            index: FxHashMap::default(),
        };
        let count = [0, 1].map(|d| out.lines[d].len() as u64);
        for i in 0..count[0] {
            for j in 0..count[1] {
                out.insert([i << DEPTH, j << DEPTH]);
            }
        }
        out
    }

    /// The number of cells along u and v.
    pub(super) fn cells(&self) -> [usize; 2] {
        [0, 1].map(|d| self.lines[d].len() - 1)
    }

    /// The largest coordinates.
    pub(super) fn last(&self) -> Place {
        self.cells().map(|n| (n as u64) << DEPTH)
    }

    fn insert(&mut self, place: Place) -> bool {
        let next = self.places.len() as u32;
        let new = *self.index.entry(place).or_insert(next) == next;
        if new {
            self.places.push(place);
        }
        new
    }

    /// The parameter of a coordinate along u (0) or v (1).
    pub(super) fn param(&self, d: usize, x: u64) -> f64 {
        let (line, from) = ((x >> DEPTH) as usize, x & (CELL - 1));
        let lo = self.lines[d][line];
        if from == 0 {
            return lo;
        }
        let hi = self.lines[d][line + 1];
        (lo + (hi - lo) * (from as f64 / CELL as f64)).clamp(lo, hi)
    }

    pub(super) fn uv(&self, place: Place) -> [f64; 2] {
        [0, 1].map(|d| self.param(d, place[d]))
    }

    /// Adds a vertex with all that it needs.
    pub(super) fn add(&mut self, place: Place) {
        let mut open: SmallVec<[Place; 8]> = smallvec![place];
        while let Some(p) = open.pop() {
            if self.insert(p) {
                open.extend(self.right_angles(p));
            }
        }
    }

    /// The right angles of the triangles whose longest side has its middle here.
    fn right_angles(&self, [x, y]: Place) -> SmallVec<[Place; 2]> {
        let t = x.trailing_zeros().min(y.trailing_zeros());
        let s = 1 << t;
        let mut out = SmallVec::new();
        let odd = [x, y].map(|c| c >> t & 1 == 1);
        match odd {
            _ if t >= DEPTH => {}
            [true, true] => {
                // The centre of a square. Corners whose numbers have an even sum are on its diagonal.
                let parity = ((x - s) >> (t + 1)) + ((y - s) >> (t + 1));
                if parity.is_multiple_of(2) {
                    out.extend([[x + s, y - s], [x - s, y + s]]);
                } else {
                    out.extend([[x - s, y - s], [x + s, y + s]]);
                }
            }
            _ => {
                // The middle of a side: the centres of the squares beside it.
                let d = usize::from(odd[0]);
                let (at, last) = ([x, y], self.last()[d]);
                for beside in [at[d].checked_sub(s), at[d].checked_add(s)] {
                    if let Some(c) = beside.filter(|&c| c <= last) {
                        let mut centre = at;
                        centre[d] = c;
                        out.push(centre);
                    }
                }
            }
        }
        out
    }

    /// Halves all triangles of a square `levels` times, if they are not yet.
    pub(super) fn refine(&mut self, square: Square, levels: u32) {
        if levels >= 1 {
            self.add(square.centre());
        }
        if levels >= 2 {
            square.middles().into_iter().for_each(|m| self.add(m));
        }
        if levels >= 3 {
            for child in square.children() {
                self.refine(child, levels - 2);
            }
        }
    }

    /// Hands out the triangles of a cell as the numbers of their vertices, counter-clockwise, the right angle first.
    pub(super) fn triangles(&self, cell: [usize; 2], mut emit: impl FnMut([u32; 3])) {
        let square = Square::cell(cell);
        let ([x, y], [z, w]) = (square.corner, square.upper());
        let [a, b, c, d] = [[x, y], [z, y], [z, w], [x, w]];
        let halves = if (cell[0] + cell[1]).is_multiple_of(2) {
            [[b, c, a], [d, a, c]]
        } else {
            [[a, b, d], [c, d, b]]
        };
        for half in halves {
            self.halved(half, half.map(|p| self.index[&p]), &mut emit);
        }
    }

    fn halved(&self, [a, b, c]: [Place; 3], [i, j, k]: [u32; 3], emit: &mut impl FnMut([u32; 3])) {
        let middle = [0, 1].map(|d| (b[d] + c[d]) / 2);
        match self.index.get(&middle) {
            // The middle of the smallest side would be one of its ends.
            Some(&m) if m != j && m != k => {
                self.halved([middle, a, b], [m, i, j], emit);
                self.halved([middle, c, a], [m, k, i], emit);
            }
            _ => emit([i, j, k]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::Random;
    use std::collections::HashMap;

    /// Twice the area in the measure of the cells, and how often each side is used.
    fn examined(net: &Bisection) -> (f64, HashMap<[u32; 2], i32>) {
        let (mut area, mut sides) = (0.0, HashMap::new());
        let [n, m] = net.cells();
        for cell in (0..n).flat_map(|i| (0..m).map(move |j| [i, j])) {
            net.triangles(cell, |t| {
                let [a, b, c] = t.map(|k| net.places[k as usize].map(|x| x as f64 / CELL as f64));
                let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
                assert!(twice > 0.0);
                area += twice;
                for k in 0..3 {
                    let [i, j] = [t[k], t[(k + 1) % 3]];
                    *sides.entry([i.min(j), i.max(j)]).or_insert(0) += if i < j { 1 } else { -1 };
                }
            });
        }
        (area, sides)
    }

    #[test]
    fn triangles_fit_together_however_they_are_halved() {
        let mut random = Random(4);
        for (n, m) in [(1, 1), (2, 3), (3, 2)] {
            let lines = [n, m].map(|k| (0..=k).map(f64::from).collect());
            let mut net = Bisection::new(lines);
            for _ in 0..40 {
                let mut square = Square::cell([
                    (random.unit() * f64::from(n)) as usize,
                    (random.unit() * f64::from(m)) as usize,
                ]);
                let depth = (random.unit() * 8.0) as u32;
                for _ in 0..depth {
                    square = square.children()[(random.unit() * 4.0) as usize];
                }
                net.refine(square, (random.unit() * 5.0) as u32);
                let (area, sides) = examined(&net);
                assert_eq!(area, 2.0 * f64::from(n * m));
                // A side without partner lies on the border.
                for (side, count) in sides {
                    let ends = side.map(|k| net.places[k as usize]);
                    let border = (0..2).any(|d| {
                        ends[0][d] == ends[1][d] && [0, net.last()[d]].contains(&ends[0][d])
                    });
                    assert_eq!(count == 0, !border, "{ends:?}");
                }
            }
        }
    }

    #[test]
    fn a_refined_square_has_all_its_triangles() {
        for levels in 0..7 {
            let mut net = Bisection::new([vec![0.0, 1.0], vec![0.0, 1.0]]);
            net.refine(Square::cell([0, 0]), levels);
            let mut count = 0;
            net.triangles([0, 0], |_| count += 1);
            assert_eq!(count, 2 << levels);
        }
    }

    #[test]
    fn parameters_run_from_line_to_line() {
        let net = Bisection::new([vec![0.0, 1.0, 3.0], vec![-1.0, 1.0]]);
        assert_eq!(net.uv([CELL, 0]), [1.0, -1.0]);
        assert_eq!(net.uv([CELL + CELL / 2, CELL / 4]), [2.0, -0.5]);
        assert_eq!(net.uv([2 * CELL, CELL]), [3.0, 1.0]);
    }
}
