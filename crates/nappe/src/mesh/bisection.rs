//! Triangles that arise by bisection: a net of lines cut into right triangles, each halved as often as need be.
//!
//! Lines of constant u and v divide the domain into cells; the diagonals of neighbouring cells mirror each other. A
//! triangle is halved from its right angle to the middle of its longest side, so all stay right and isosceles in the
//! measure of their cell. The middle of a longest side belongs to two triangles (or one on the border): both are halved
//! or none, and nowhere does a corner of one lie on a side of another. So a triangulation is a set of such middles, its
//! *vertices*, that holds with each one also the right angles of the two triangles that share the side: these triangles
//! have to exist. This is newest-vertex bisection (Maubach, *Local bisection refinement*, 1995).
//!
//! The vertices that first are corners of squares of the depths `3 b + 1` to `3 b + 3` make up the band `b`; those in a square
//! of the depth `3 b` are 8 × 8 bits of one tile. The crossings of lines are all there, and need no bits.

use rustc_hash::FxHashMap;
use std::sync::Arc;

/// A vertex: along u and v, the number of the line below times 2^[`DEPTH`] and the distance from it.
pub(super) type Place = [u64; 2];

/// How often a cell can be halved along each direction.
pub(super) const DEPTH: u32 = 33;
/// The distance of neighbouring lines.
pub(super) const CELL: u64 = 1 << DEPTH;

/// The depths of one band.
const BAND: u32 = 3;
/// Gives the place of a vertex along one direction of a tile.
const WITHIN: u64 = (1 << BAND) - 1;
/// The number of bands: the smallest squares have no vertices inside.
const BANDS: usize = (DEPTH / BAND) as usize;

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

/// The vertices of one band in a square, by bits.
#[derive(Clone, Debug)]
struct Tile {
    name: Name,
    /// One for each place, v fastest.
    bits: u64,
}

/// The band and the place of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
struct Name {
    band: u32,
    at: [u64; 2],
}

/// Where a vertex that is no crossing of lines has its bit.
struct Bit {
    tile: Name,
    number: u32,
}

impl Bit {
    /// `None` for crossings of lines.
    #[inline]
    fn of([x, y]: Place) -> Option<Self> {
        let depth = DEPTH.checked_sub((x | y).trailing_zeros())?;
        if depth == 0 {
            return None;
        }
        let band = (depth - 1) / BAND;
        let shift = DEPTH - BAND * (band + 1);
        let [i, j] = [x, y].map(|c| c >> shift);
        Some(Self {
            tile: Name {
                band,
                at: [i >> BAND, j >> BAND],
            },
            number: (((i & WITHIN) << BAND) | (j & WITHIN)) as u32,
        })
    }

    /// If it is set.
    #[inline]
    fn is_in(&self, bits: u64) -> bool {
        bits >> self.number & 1 == 1
    }
}

impl Tile {
    /// The vertices, v fastest.
    fn places(&self) -> impl Iterator<Item = Place> {
        let Name { band, at } = self.name;
        let shift = DEPTH - BAND * (band + 1);
        let mut bits = self.bits;
        std::iter::from_fn(move || {
            let number = u64::from(bits.trailing_zeros());
            // Without the lowest bit.
            bits &= bits.checked_sub(1)?;
            let within = [number >> BAND, number & WITHIN];
            Some([0, 1].map(|d| (at[d] << BAND | within[d]) << shift))
        })
    }
}

/// A triangulation.
#[derive(Clone, Debug)]
pub(super) struct Bisection {
    /// The lines of constant u and v, increasing.
    pub(super) lines: Arc<[Vec<f64>; 2]>,
    tiles: Vec<Tile>,
    index: FxHashMap<Name, u32>,
    /// For each band the tile that was used last: the next vertex is mostly in the same.
    last: [u32; BANDS],
    /// The number of vertices.
    count: usize,
}

impl Bisection {
    /// Two triangles for each cell.
    pub(super) fn new(lines: [Vec<f64>; 2]) -> Self {
        Self::of(Arc::new(lines))
    }

    /// With the same lines, and no other vertices.
    pub(super) fn of_lines(&self) -> Self {
        Self::of(self.lines.clone())
    }

    fn of(lines: Arc<[Vec<f64>; 2]>) -> Self {
        Self {
            count: lines[0].len() * lines[1].len(),
            lines,
            tiles: Vec::new(),
            index: FxHashMap::default(),
            last: [0; BANDS],
        }
    }

    /// Adds the vertices of another triangulation of the same lines: each has with it what it needs.
    pub(super) fn join(&mut self, other: &Self) {
        for tile in &other.tiles {
            let own = self.tile(tile.name);
            let new = tile.bits & !own.bits;
            own.bits |= new;
            self.count += new.count_ones() as usize;
        }
    }

    /// The number of cells along u and v.
    pub(super) fn cells(&self) -> [usize; 2] {
        [0, 1].map(|d| self.lines[d].len() - 1)
    }

    /// The number of vertices.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// The largest coordinates.
    pub(super) fn last(&self) -> Place {
        self.cells().map(|n| (n as u64) << DEPTH)
    }

    fn insert(&mut self, place: Place) -> bool {
        let Some(bit) = Bit::of(place) else {
            return false;
        };
        let tile = self.tile(bit.tile);
        let new = !bit.is_in(tile.bits);
        tile.bits |= 1 << bit.number;
        self.count += usize::from(new);
        new
    }

    /// A tile that is there from now on.
    #[inline]
    fn tile(&mut self, name: Name) -> &mut Tile {
        let last = &mut self.last[name.band as usize];
        let at_hand = self.tiles.get(*last as usize);
        if at_hand.is_none_or(|t| t.name != name) {
            let next = self.tiles.len() as u32;
            *last = *self.index.entry(name).or_insert(next);
            if *last == next {
                self.tiles.push(Tile { name, bits: 0 });
            }
        }
        &mut self.tiles[*last as usize]
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

    /// The coordinates along the side where the other coordinate is the least or the greatest one, in no order. The side
    /// runs along u (0) or v (1).
    pub(super) fn on_side(&self, along: usize, upper: bool) -> Vec<u64> {
        let across = 1 - along;
        let at = if upper { self.last()[across] } else { 0 };
        let crossings = (0..self.lines[along].len() as u64).map(|i| i << DEPTH);
        let tiles = self.tiles.iter().filter(|t| {
            let Name { band, at: tile } = t.name;
            tile[across] << (DEPTH - BAND * band) == at
        });
        let inside = tiles.flat_map(Tile::places).filter(|p| p[across] == at);
        crossings.chain(inside.map(|p| p[along])).collect()
    }

    /// Adds a vertex with all that it needs.
    pub(super) fn add(&mut self, place: Place) {
        if self.insert(place) {
            for right_angle in self.right_angles(place).into_iter().flatten() {
                self.add(right_angle);
            }
        }
    }

    /// The right angles of the triangles whose longest side has its middle here, at no crossing of lines.
    fn right_angles(&self, [x, y]: Place) -> [Option<Place>; 2] {
        let t = x.trailing_zeros().min(y.trailing_zeros());
        let s = 1 << t;
        let odd = [x, y].map(|c| c >> t & 1 == 1);
        if odd == [true, true] {
            // The centre of a square. Corners whose numbers have an even sum are on its diagonal.
            let parity = ((x - s) >> (t + 1)) + ((y - s) >> (t + 1));
            return if parity.is_multiple_of(2) {
                [Some([x + s, y - s]), Some([x - s, y + s])]
            } else {
                [Some([x - s, y - s]), Some([x + s, y + s])]
            };
        }
        // The middle of a side: the centres of the squares beside it.
        let d = usize::from(odd[0]);
        let (at, last) = ([x, y], self.last()[d]);
        [at[d].checked_sub(s), at[d].checked_add(s)].map(|beside| {
            let mut centre = at;
            centre[d] = beside.filter(|&c| c <= last)?;
            Some(centre)
        })
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

    /// Gives all vertices numbers.
    pub(super) fn numbered(&self) -> Numbered<'_> {
        let [n, m] = [0, 1].map(|d| self.lines[d].len());
        let mut places = Vec::with_capacity(self.count);
        places.extend((0..n * m).map(|k| [k / m, k % m].map(|i| (i as u64) << DEPTH)));
        let first = self.tiles.iter().map(|tile| {
            let first = places.len() as u32;
            places.extend(tile.places());
            first
        });
        let first = first.collect();
        Numbered {
            net: self,
            first,
            places,
        }
    }
}

/// A triangulation whose vertices have numbers.
pub(super) struct Numbered<'a> {
    net: &'a Bisection,
    /// The number of the first vertex of each tile.
    first: Vec<u32>,
    /// All vertices by their numbers.
    pub(super) places: Vec<Place>,
}

impl Numbered<'_> {
    /// The triangles of a cell as the numbers of their vertices, counter-clockwise, the right angle first.
    pub(super) fn triangles(&self, cell: [usize; 2], mut emit: impl FnMut([u32; 3])) {
        let columns = self.net.lines[1].len();
        let square = Square::cell(cell);
        let ([x, y], [z, w]) = (square.corner, square.upper());
        let [a, b, c, d] = [[x, y], [z, y], [z, w], [x, w]].map(|p| {
            let [i, j] = p.map(|x| (x >> DEPTH) as usize);
            (p, (i * columns + j) as u32)
        });
        let halves = if (cell[0] + cell[1]).is_multiple_of(2) {
            [[b, c, a], [d, a, c]]
        } else {
            [[a, b, d], [c, d, b]]
        };
        let mut finder = Finder {
            of: self,
            last: [(NOWHERE, None); BANDS],
        };
        for half in halves {
            finder.halved(half, &mut emit);
        }
    }
}

/// No tile is there.
const NOWHERE: [u64; 2] = [u64::MAX; 2];

/// Looks for the numbers of vertices that lie near each other.
struct Finder<'a> {
    of: &'a Numbered<'a>,
    /// For each band the place and the number of the tile that was looked for last.
    last: [([u64; 2], Option<u32>); BANDS],
}

impl Finder<'_> {
    /// The number of a vertex that is no crossing of lines, if it is one.
    #[inline]
    fn number(&mut self, place: Place) -> Option<u32> {
        let bit = Bit::of(place)?;
        let net = self.of.net;
        let last = &mut self.last[bit.tile.band as usize];
        if last.0 != bit.tile.at {
            *last = (bit.tile.at, net.index.get(&bit.tile).copied());
        }
        let tile = last.1? as usize;
        let bits = net.tiles[tile].bits;
        let below = bits & ((1 << bit.number) - 1);
        bit.is_in(bits)
            .then(|| self.of.first[tile] + below.count_ones())
    }

    fn halved(&mut self, [a, b, c]: [(Place, u32); 3], emit: &mut impl FnMut([u32; 3])) {
        // The smallest sides have none.
        let sum = [0, 1].map(|d| b.0[d] + c.0[d]);
        let p = sum.map(|s| s / 2);
        let middle = (sum.iter().all(|s| s % 2 == 0)).then(|| self.number(p));
        match middle.flatten() {
            Some(number) => {
                let m = (p, number);
                self.halved([m, a, b], emit);
                self.halved([m, c, a], emit);
            }
            None => emit([a.1, b.1, c.1]),
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
        let numbered = net.numbered();
        assert_eq!(numbered.places.len(), net.count());
        for cell in (0..n).flat_map(|i| (0..m).map(move |j| [i, j])) {
            numbered.triangles(cell, |t| {
                let [a, b, c] =
                    t.map(|k| numbered.places[k as usize].map(|x| x as f64 / CELL as f64));
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
                let places = net.numbered().places;
                assert_eq!(area, 2.0 * f64::from(n * m));
                // A side without partner lies on the border.
                for (side, count) in sides {
                    let ends = side.map(|k| places[k as usize]);
                    let border = (0..2).any(|d| {
                        ends[0][d] == ends[1][d] && [0, net.last()[d]].contains(&ends[0][d])
                    });
                    assert_eq!(count == 0, !border, "{ends:?}");
                }
            }
        }
    }

    #[test]
    fn joined_triangulations_are_those_of_all_squares() {
        let mut random = Random(6);
        let whole = || Bisection::new([vec![0.0, 1.0, 2.0], vec![0.0, 1.0]]);
        let (mut one, mut shares) = (whole(), [whole().of_lines(), whole().of_lines()]);
        for k in 0..60 {
            let mut square = Square::cell([(random.unit() * 2.0) as usize, 0]);
            for _ in 0..(random.unit() * 9.0) as u32 {
                square = square.children()[(random.unit() * 4.0) as usize];
            }
            one.refine(square, k % 4);
            shares[k as usize % 2].refine(square, k % 4);
        }
        let mut joined = whole();
        shares.iter().for_each(|s| joined.join(s));
        assert_eq!(joined.count(), one.count());
        let sorted = |net: &Bisection| {
            let mut places = net.numbered().places;
            places.sort_unstable();
            places
        };
        assert_eq!(sorted(&joined), sorted(&one));
        examined(&joined);
    }

    #[test]
    fn a_refined_square_has_all_its_triangles() {
        for levels in 0..7 {
            let mut net = Bisection::new([vec![0.0, 1.0], vec![0.0, 1.0]]);
            net.refine(Square::cell([0, 0]), levels);
            let mut count = 0;
            net.numbered().triangles([0, 0], |_| count += 1);
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
