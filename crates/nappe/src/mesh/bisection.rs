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
//! of the depth `3 b` are 8 × 8 bits of one tile. The crossings of lines are all there, and need no bits. So a square is
//! refined with some masks, and what its vertices need comes from shifts of whole tiles, once all squares are refined.

use rustc_hash::FxHashMap;
use std::sync::Arc;

/// A vertex: along u and v, the number of the line below times 2^[`DEPTH`] and the distance from it.
pub(super) type Place = [u64; 2];

/// How often a cell can be halved along each direction.
pub(super) const DEPTH: u32 = 33;
/// The distance of neighbouring lines.
pub(super) const CELL: u64 = 1 << DEPTH;

/// The depths of one band.
pub(super) const BAND: u32 = 3;
/// The places along each direction of a tile.
pub(super) const WIDE: u32 = 1 << BAND;
/// Gives the place of a vertex along one direction of a tile.
const WITHIN: u64 = (1 << BAND) - 1;
/// The number of bands: the smallest squares have no vertices inside.
pub(super) const BANDS: usize = (DEPTH / BAND) as usize;

/// The places of a tile along u by the bits of a byte.
const ROWS: [u64; 256] = {
    let mut out = [0; 256];
    let mut k = 0;
    while k < 256 {
        let mut i = 0;
        while i < 8 {
            if (k >> i) & 1 == 1 {
                out[k] |= 0xff << (8 * i);
            }
            i += 1;
        }
        k += 1;
    }
    out
};
/// The same along v, times the byte.
const COLUMN: u64 = 0x0101_0101_0101_0101;
/// The multiples of 1, 2, 4 and 8 within a tile, and the odd multiples.
const MULTIPLES: [u8; 4] = [0xff, 0x55, 0x11, 0x01];
const ODD: [u8; 3] = [0xaa, 0x44, 0x10];

/// The bits at some places along u and along v.
#[inline]
const fn bits(u: u8, v: u8) -> u64 {
    ROWS[u as usize] & (v as u64 * COLUMN)
}

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
}

/// The vertices of one band in a square, by bits.
#[derive(Clone, Debug)]
pub(super) struct Tile {
    pub(super) name: Name,
    /// One for each place, v fastest; never the first, which is the corner of a larger square.
    pub(super) bits: u64,
}

/// The band and the place of a tile.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Name {
    pub(super) band: u32,
    pub(super) at: [u64; 2],
}

impl Name {
    /// That of the tile beside, at an upper end.
    pub(super) fn beside(self, d: usize) -> Self {
        let mut at = self.at;
        at[d] += 1;
        Self { at, ..self }
    }

    /// The vertex at some steps of the tile from its lower corner.
    #[inline]
    pub(super) fn place(self, within: [u32; 2]) -> Place {
        let shift = DEPTH - BAND * (self.band + 1);
        [0, 1].map(|d| ((self.at[d] << BAND) + u64::from(within[d])) << shift)
    }
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
}

/// The numbers of the bits that are set, from the lowest on.
pub(super) fn each(mut bits: u64) -> impl Iterator<Item = u32> {
    std::iter::from_fn(move || {
        let number = bits.trailing_zeros();
        // Without the lowest bit.
        bits &= bits.checked_sub(1)?;
        Some(number)
    })
}

impl Tile {
    /// The vertices, v fastest.
    fn places(&self) -> impl Iterator<Item = Place> {
        each(self.bits).map(|n| self.name.place([n >> BAND, n & (WIDE - 1)]))
    }
}

/// A triangulation.
#[derive(Clone, Debug)]
pub(super) struct Bisection {
    /// The lines of constant u and v, increasing.
    pub(super) lines: Arc<[Vec<f64>; 2]>,
    pub(super) tiles: Vec<Tile>,
    index: FxHashMap<Name, u32>,
    /// For each band the tile that was used last: the next vertex is mostly in the same.
    last: [u32; BANDS],
    /// The number of vertices.
    count: usize,
    /// True if all vertices have what they need.
    closed: bool,
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
            closed: true,
        }
    }

    /// Adds the vertices of another triangulation of the same lines: each has with it what it needs.
    pub(super) fn join(&mut self, other: &Self) {
        debug_assert!(other.closed);
        for tile in &other.tiles {
            self.set(tile.name, tile.bits);
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

    /// Adds vertices of a tile.
    #[inline]
    fn set(&mut self, name: Name, bits: u64) {
        let tile = self.tile(name);
        let new = bits & !tile.bits;
        tile.bits |= new;
        self.count += new.count_ones() as usize;
    }

    fn insert(&mut self, place: Place) -> bool {
        let Some(bit) = Bit::of(place) else {
            return false;
        };
        let before = self.count;
        self.set(bit.tile, 1 << bit.number);
        self.count > before
    }

    /// True if no vertex lacks what it needs.
    pub(super) fn is_closed(&self) -> bool {
        self.closed
    }

    /// The number of a tile, if it has vertices.
    #[inline]
    pub(super) fn find(&self, name: Name) -> Option<usize> {
        self.index.get(&name).map(|&k| k as usize)
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

    /// Halves all triangles of a square `levels` times, if they are not yet. What its vertices need elsewhere is to be added
    /// by [`Self::close`].
    pub(super) fn refine(&mut self, square: Square, levels: u32) {
        let depth = square.depth + levels / 2;
        if depth > square.depth {
            for band in square.depth / BAND..depth.div_ceil(BAND) {
                let finest = BAND * (band + 1);
                self.mark(
                    square,
                    band,
                    MULTIPLES[(finest - depth.min(finest)) as usize],
                );
            }
        }
        if levels % 2 == 1 {
            // The centres of its parts.
            let band = depth / BAND;
            self.mark(square, band, ODD[(BAND * (band + 1) - depth - 1) as usize]);
        }
        self.closed &= levels == 0;
    }

    /// Adds the vertices of a band in a square and on its sides, at some places along both directions of a tile.
    fn mark(&mut self, square: Square, band: u32, places: u8) {
        let finest = BAND * (band + 1);
        let size = 1 << (finest - square.depth);
        let from = square.corner.map(|x| x >> (DEPTH - finest));
        let [us, vs] = from.map(|x| x >> BAND..=(x + size) >> BAND);
        let within = |d: usize, tile: u64| {
            let first = tile << BAND;
            let lo = from[d].max(first) - first;
            let hi = (from[d] + size).min(first + WITHIN) - first;
            places & (0xff << lo) & (0xff >> (WITHIN - hi))
        };
        for u in us {
            let rows = within(0, u);
            for v in vs.clone() {
                let new = bits(rows, within(1, v)) & !1;
                if new != 0 {
                    self.set(Name { band, at: [u, v] }, new);
                }
            }
        }
    }

    /// Adds what all vertices need.
    pub(super) fn close(&mut self) {
        if self.closed {
            return;
        }
        let mut bands: [Vec<u32>; BANDS] = std::array::from_fn(|_| Vec::new());
        let mut known = 0;
        // Tiles that are new since the last time: what vertices need is in the same band or those before.
        let mut look = |net: &Self, bands: &mut [Vec<u32>; BANDS]| {
            for (k, tile) in net.tiles.iter().enumerate().skip(known) {
                bands[tile.name.band as usize].push(k as u32);
            }
            known = net.tiles.len();
        };
        look(self, &mut bands);
        for band in (0..BANDS).rev() {
            for step in [1, 2, 4] {
                // What middles of sides need are centres of the same squares, and these need the corners.
                for of in [Self::add_centres, Self::add_corners] {
                    for k in 0..bands[band].len() {
                        of(self, bands[band][k] as usize, step);
                    }
                    look(self, &mut bands);
                }
            }
        }
        self.closed = true;
    }

    /// Adds the centres of the squares beside whose side the middles are vertices of a tile, at odd multiples of some steps.
    fn add_centres(&mut self, tile: usize, step: u32) {
        let Tile { name, bits: all } = self.tiles[tile];
        let k = step.trailing_zeros() as usize;
        let (odd, even) = (ODD[k], MULTIPLES[k + 1]);
        let (last, shift) = (self.last(), DEPTH - BAND * name.band);
        let mut own = 0;
        for (d, middles) in [all & bits(even, odd), all & bits(odd, even)]
            .into_iter()
            .enumerate()
            .filter(|m| m.1 != 0)
        {
            // A step along u is a byte, one along v a bit.
            let unit = if d == 0 { WIDE } else { 1 };
            let first = middles & [0xff, COLUMN][d];
            if name.at[d] << shift < last[d] {
                own |= middles << (step * unit);
            }
            own |= (middles & !first) >> (step * unit);
            if first != 0 && name.at[d] > 0 {
                let mut at = name.at;
                at[d] -= 1;
                self.set(Name { at, ..name }, first << ((WIDE - step) * unit));
            }
        }
        let new = own & !self.tiles[tile].bits;
        self.tiles[tile].bits |= new;
        self.count += new.count_ones() as usize;
    }

    /// Adds the corners that have to be there for the centres of squares among the vertices of a tile, at odd multiples of
    /// some steps: those that are not on the diagonal.
    fn add_corners(&mut self, tile: usize, step: u32) {
        let Tile { name, bits: all } = self.tiles[tile];
        let odd = ODD[step.trailing_zeros() as usize];
        let centres = all & bits(odd, odd);
        if centres == 0 {
            return;
        }
        // The squares whose numbers have an even sum.
        let even = match step {
            1 => bits(0x22, 0x22) | bits(0x88, 0x88),
            2 => bits(0x04, 0x04) | bits(0x40, 0x40),
            _ if (name.at[0] + name.at[1]).is_multiple_of(2) => u64::MAX,
            _ => 0,
        };
        let (even, odd) = (centres & even, centres & !even);
        // Centres in the last row and in the last column have corners in the tiles beside.
        let (row, column) = (0xff << (WIDE * (WIDE - step)), COLUMN << (WIDE - step));
        let (along, across) = (step * WIDE, step);
        let own = (even & !row) << along >> across
            | (even & !column) >> along << across
            | odd >> along >> across
            | (odd & !row & !column) << along << across;
        let above = WIDE - step;
        let (mut east, mut north) = (
            (even & row) >> (WIDE * above) >> across,
            (even & column) >> above >> along,
        );
        east |= (odd & row & !column) >> (WIDE * above) << across;
        north |= (odd & column & !row) >> above << along;
        let new = own & !self.tiles[tile].bits & !1;
        self.tiles[tile].bits |= new;
        self.count += new.count_ones() as usize;
        // The corners of the tile are of earlier bands.
        let corners = [
            (own & 1 == 1, [0, 0]),
            (east & 1 == 1, [WIDE, 0]),
            (north & 1 == 1, [0, WIDE]),
            (odd & row & column != 0, [WIDE, WIDE]),
        ];
        for (_, within) in corners.into_iter().filter(|c| c.0) {
            self.insert(name.place(within));
        }
        for (d, new) in [east & !1, north & !1].into_iter().enumerate() {
            if new != 0 {
                self.set(name.beside(d), new);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::numbered::Numbered;
    use super::*;
    use crate::laws::Random;
    use std::collections::HashMap;

    /// Twice the area in the measure of the cells, and how often each side is used.
    fn examined(net: &Bisection) -> (f64, HashMap<[u32; 2], i32>) {
        let (mut area, mut sides) = (0.0, HashMap::new());
        let [n, m] = net.cells();
        let numbered = Numbered::plain(net);
        let places = numbered.places();
        assert_eq!(places.len(), net.count());
        for cell in (0..n).flat_map(|i| (0..m).map(move |j| [i, j])) {
            numbered.triangles(cell, |t, halved| {
                let corners = t.map(|k| places[k as usize]);
                let crossing = |p: &Place| p.iter().all(|x| x.is_multiple_of(CELL));
                assert_eq!(halved, !corners.iter().all(crossing));
                let [a, b, c] = corners.map(|p| p.map(|x| x as f64 / CELL as f64));
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
                net.refine(square, (random.unit() * 9.0) as u32);
                net.close();
                let (area, sides) = examined(&net);
                let places = Numbered::plain(&net).places();
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
        one.close();
        shares.iter_mut().for_each(Bisection::close);
        let mut joined = whole();
        shares.iter().for_each(|s| joined.join(s));
        assert_eq!(joined.count(), one.count());
        let sorted = |net: &Bisection| {
            let mut places = Numbered::plain(net).places();
            places.sort_unstable();
            places
        };
        assert_eq!(sorted(&joined), sorted(&one));
        examined(&joined);
    }

    #[test]
    fn closing_adds_just_what_each_vertex_needs() {
        let mut random = Random(9);
        for round in 0..200 {
            let lines = || [vec![0.0, 1.0, 2.0, 3.0], vec![0.0, 1.0, 2.0]];
            let (mut net, mut one_by_one) = (Bisection::new(lines()), Bisection::new(lines()));
            for _ in 0..=round % 4 {
                let mut square = Square::cell([3.0, 2.0].map(|n| (random.unit() * n) as usize));
                for _ in 0..(random.unit() * 11.0) as u32 {
                    square = square.children()[(random.unit() * 4.0) as usize];
                }
                let levels = (random.unit() * 8.0) as u32;
                net.refine(square, levels);
                // The middles of longest sides, from halving to halving.
                let mut squares = vec![square];
                for level in 0..levels {
                    for square in &squares {
                        if level % 2 == 0 {
                            one_by_one.add(square.centre());
                            continue;
                        }
                        let ([x, y], h) = (square.corner, square.size() / 2);
                        for (i, j) in [(1, 0), (0, 1), (1, 2), (2, 1)] {
                            one_by_one.add([x + i * h, y + j * h]);
                        }
                    }
                    if level % 2 == 1 {
                        squares = squares.into_iter().flat_map(Square::children).collect();
                    }
                }
            }
            net.close();
            assert_eq!(net.count(), one_by_one.count());
            let vertices = |net: &Bisection| {
                let tiles = net.tiles.iter().map(|t| ((t.name.band, t.name.at), t.bits));
                tiles.collect::<std::collections::BTreeMap<_, _>>()
            };
            assert_eq!(vertices(&net), vertices(&one_by_one));
        }
    }

    #[test]
    fn a_refined_square_has_all_its_triangles() {
        for levels in 0..7 {
            let mut net = Bisection::new([vec![0.0, 1.0], vec![0.0, 1.0]]);
            net.refine(Square::cell([0, 0]), levels);
            net.close();
            let mut count = 0;
            Numbered::plain(&net).triangles([0, 0], |_, _| count += 1);
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
