//! The vertices of a triangulation by their numbers, and its triangles.
//!
//! Vertices are *plain*, or *marked* for those who take a closer look at them; both have numbers of their own, in the order of
//! the crossings of lines and of the tiles. The triangles of a tile come from the numbers of its 9 × 9 places: those beyond
//! its upper sides are in the tiles beside.

use super::bisection::{BAND, Bisection, CELL, DEPTH, Name, Place, Square, Tile, WIDE, each};
use std::ops::Range;

/// What numbers of marked vertices have and those of plain ones have not.
pub(super) const MARKED: u32 = 1 << 31;
/// No vertex is there.
const NONE: u32 = u32::MAX;
/// The places along each direction of a tile, both ends included.
const PLACES: usize = WIDE as usize + 1;
/// The place of the first bits along u and v.
const ROW: u64 = 0xff;
const COLUMN: u64 = 0x0101_0101_0101_0101;

/// A triangulation whose vertices have numbers.
pub(super) struct Numbered<'a> {
    pub(super) net: &'a Bisection,
    /// The numbers of the crossings of lines, v fastest.
    crossings: Vec<u32>,
    tiles: Vec<Numbers>,
    /// The places of the marked vertices.
    pub(super) marked: Vec<Place>,
    /// The number of plain vertices.
    pub(super) plain: usize,
}

/// The numbers of a tile's vertices.
struct Numbers {
    /// The first plain and the first marked one.
    first: [u32; 2],
    marked: u64,
    /// The squares of the next band that have a centre.
    finer: u64,
}

/// Some plain vertices with numbers one after the other: at crossings of lines or in tiles.
pub(super) struct Share {
    pub(super) first: usize,
    crossings: Range<usize>,
    tiles: Range<usize>,
}

impl<'a> Numbered<'a> {
    /// Marks vertices on some lines of constant u and v, and others.
    pub(super) fn new(
        net: &'a Bisection,
        lines: &[Vec<bool>; 2],
        other: Option<impl Fn(Place) -> bool>,
    ) -> Self {
        debug_assert!(net.is_closed());
        let on_line = |d: usize, x: u64| x.is_multiple_of(CELL) && lines[d][(x >> DEPTH) as usize];
        let is_other = |p: Place| other.as_ref().is_some_and(|other| other(p));
        let (mut plain, mut marked) = (0, Vec::new());
        let [n, m] = [0, 1].map(|d| net.lines[d].len());
        let crossings = (0..n * m).map(|k| {
            let place = [k / m, k % m].map(|i| (i as u64) << DEPTH);
            if on_line(0, place[0]) || on_line(1, place[1]) || is_other(place) {
                marked.push(place);
                MARKED + marked.len() as u32 - 1
            } else {
                plain += 1;
                plain - 1
            }
        });
        let crossings: Vec<u32> = crossings.collect();
        let mut finer = vec![0; net.tiles.len()];
        for Tile { name, .. } in net.tiles.iter().filter(|t| t.name.band > 0) {
            let larger = Name {
                band: name.band - 1,
                at: name.at.map(|k| k >> BAND),
            };
            if let Some(k) = net.find(larger) {
                let [i, j] = name.at.map(|k| k % u64::from(WIDE));
                finer[k] |= 1 << (i << BAND | j);
            }
        }
        let tiles = net
            .tiles
            .iter()
            .zip(finer)
            .map(|(&Tile { name, bits }, finer)| {
                let corner = name.place([0, 0]);
                let mut special = 0;
                for (d, first) in [ROW, COLUMN].into_iter().enumerate() {
                    if on_line(d, corner[d]) {
                        special |= bits & first;
                    }
                }
                if other.is_some() {
                    let others = each(bits).filter(|&n| is_other(place(name, n)));
                    special |= others.fold(0, |all, n| all | 1 << n);
                }
                let first = [plain, MARKED + marked.len() as u32];
                marked.extend(each(special).map(|n| place(name, n)));
                plain += (bits & !special).count_ones();
                Numbers {
                    first,
                    marked: special,
                    finer,
                }
            });
        let tiles = tiles.collect();
        Self {
            net,
            crossings,
            tiles,
            marked,
            plain: plain as usize,
        }
    }

    /// Shares of the plain vertices, of about so many each.
    pub(super) fn shares(&self, size: usize) -> Vec<Share> {
        let mut first = 0;
        let crossings = self.crossings.chunks(size).enumerate().map(|(k, some)| {
            let share = Share {
                first,
                crossings: k * size..k * size + some.len(),
                tiles: 0..0,
            };
            first += some.iter().filter(|&&n| n < MARKED).count();
            share
        });
        let mut all: Vec<Share> = crossings.collect();
        let mut from = 0;
        for k in 1..=self.tiles.len() {
            let next = self
                .tiles
                .get(k)
                .map_or(self.plain, |t| t.first[0] as usize);
            if next - first >= size || k == self.tiles.len() {
                all.push(Share {
                    first,
                    crossings: 0..0,
                    tiles: from..k,
                });
                (from, first) = (k, next);
            }
        }
        all
    }

    /// The parameters of plain vertices.
    pub(super) fn uv(&self, share: &Share, uv: &mut Vec<[f64; 2]>) {
        let m = self.net.lines[1].len();
        let plain = share
            .crossings
            .clone()
            .filter(|&k| self.crossings[k] < MARKED);
        uv.extend(plain.map(|k| [self.net.lines[0][k / m], self.net.lines[1][k % m]]));
        for k in share.tiles.clone() {
            let Tile { name, bits } = self.net.tiles[k];
            // Those of all columns or rows are computed once; some of them may be beyond the last line.
            let params = [0, 1].map(|d| -> [f64; WIDE as usize] {
                let used = if d == 0 { columns(bits) } else { rows(bits) };
                let at = |i: usize| name.place([i as u32; 2])[d];
                let is_used = |i: usize| used >> i & 1 == 1;
                std::array::from_fn(|i| {
                    if is_used(i) {
                        self.net.param(d, at(i))
                    } else {
                        0.0
                    }
                })
            });
            let plain = each(bits & !self.tiles[k].marked);
            uv.extend(plain.map(|n| {
                let [i, j] = within(n);
                [params[0][i as usize], params[1][j as usize]]
            }));
        }
    }

    /// The triangles of a cell as the numbers of their vertices, counter-clockwise, the right angle first; and whether they
    /// are halves, not those that every cell has to begin with.
    pub(super) fn triangles(&self, cell: [usize; 2], mut emit: impl FnMut([u32; 3], bool)) {
        let columns = self.net.lines[1].len();
        let crossing = |i: usize, j: usize| self.crossings[(cell[0] + i) * columns + cell[1] + j];
        let corners = [
            [crossing(0, 0), crossing(0, 1)],
            [crossing(1, 0), crossing(1, 1)],
        ];
        let name = Name {
            band: 0,
            at: cell.map(|i| i as u64),
        };
        if let Some(tile) = self.net.find(name) {
            return self.tile(tile, corners, &mut |t| emit(t, true));
        }
        let [[a, d], [b, c]] = corners;
        let halves = if Square::cell(cell).is_even() {
            [[b, c, a], [d, a, c]]
        } else {
            [[a, b, d], [c, d, b]]
        };
        halves.into_iter().for_each(|t| emit(t, false));
    }

    /// The triangles of a tile with some corners, by the ends along u and v.
    fn tile(&self, k: usize, corners: [[u32; 2]; 2], emit: &mut impl FnMut([u32; 3])) {
        let tile = &self.net.tiles[k];
        let mut at = [[NONE; PLACES]; PLACES];
        for i in [0, 1] {
            for j in [0, 1] {
                at[i * WIDE as usize][j * WIDE as usize] = corners[i][j];
            }
        }
        self.number(k, u64::MAX, |[i, j], number| at[i][j] = number);
        let beside = |d: usize| self.net.find(tile.name.beside(d));
        if let Some(east) = beside(0) {
            self.number(east, ROW, |[_, j], number| at[WIDE as usize][j] = number);
        }
        if let Some(north) = beside(1) {
            self.number(north, COLUMN, |[i, _], number| {
                at[i][WIDE as usize] = number
            });
        }
        let places = Places {
            of: self,
            at,
            name: tile.name,
            finer: self.tiles[k].finer,
        };
        places.halved([0, 0], WIDE as usize / 2, emit);
    }

    /// Tells the numbers of some vertices of a tile with their places there.
    #[inline]
    fn number(&self, k: usize, some: u64, mut tell: impl FnMut([usize; 2], u32)) {
        let Numbers { first, marked, .. } = self.tiles[k];
        let bits = self.net.tiles[k].bits;
        for (first, bits) in first.into_iter().zip([bits & !marked, bits & marked]) {
            // Rows lie side by side.
            let (mut last, mut number) = (0, first);
            for n in each(bits & some) {
                let skipped = bits & ((1 << n) - 1) & !last;
                number += skipped.count_ones();
                tell(within(n).map(|i| i as usize), number);
                number += 1;
                last = u64::MAX >> (63 - n);
            }
        }
    }
}

/// The numbers of the vertices in and around a tile.
struct Places<'a> {
    of: &'a Numbered<'a>,
    /// By the steps along u and along v.
    at: [[u32; PLACES]; PLACES],
    name: Name,
    finer: u64,
}

impl Places<'_> {
    /// The triangles of a square with a centre, of two times so many steps.
    fn halved(&self, [i, j]: [usize; 2], step: usize, emit: &mut impl FnMut([u32; 3])) {
        let at = |u: usize, v: usize| self.at[i + u * step][j + v * step];
        let quarters = [[0, 0], [1, 0], [1, 1], [0, 1]];
        let is_halved = quarters.map(|[u, v]| {
            let (i, j) = (i + u * step, j + v * step);
            if step > 1 {
                self.at[i + step / 2][j + step / 2] != NONE
            } else {
                self.finer >> (i << BAND | j) & 1 == 1
            }
        });
        let centre = at(1, 1);
        // From corner to corner, with the middles of the sides.
        let border = [
            [0, 0],
            [1, 0],
            [2, 0],
            [2, 1],
            [2, 2],
            [1, 2],
            [0, 2],
            [0, 1],
        ];
        let border = border.map(|[u, v]| at(u, v));
        for k in 0..4 {
            let [from, middle, to] = [border[2 * k], border[2 * k + 1], border[(2 * k + 2) % 8]];
            if middle == NONE {
                emit([centre, from, to]);
                continue;
            }
            if !is_halved[k] {
                emit([middle, centre, from]);
            }
            if !is_halved[(k + 1) % 4] {
                emit([middle, to, centre]);
            }
        }
        for ([u, v], _) in quarters.into_iter().zip(is_halved).filter(|q| q.1) {
            let quarter = [i + u * step, j + v * step];
            if step > 1 {
                self.halved(quarter, step / 2, emit);
            } else {
                self.finer_tile(quarter, emit);
            }
        }
    }

    fn finer_tile(&self, [i, j]: [usize; 2], emit: &mut impl FnMut([u32; 3])) {
        let Name { band, at } = self.name;
        let name = Name {
            band: band + 1,
            at: [0, 1].map(|d| (at[d] << BAND) + [i, j][d] as u64),
        };
        let corners = [0, 1].map(|u| [0, 1].map(|v| self.at[i + u][j + v]));
        if let Some(tile) = self.of.net.find(name) {
            self.of.tile(tile, corners, emit);
        }
    }
}

/// The place of a bit within its tile.
#[inline]
fn within(number: u32) -> [u32; 2] {
    [number >> BAND, number & (WIDE - 1)]
}

fn place(name: Name, number: u32) -> Place {
    name.place(within(number))
}

/// The places along u, and along v, at which bits are set.
fn columns(bits: u64) -> u64 {
    (0..u64::from(WIDE)).fold(0, |all, i| {
        all | u64::from(bits >> (i << BAND) & ROW != 0) << i
    })
}

fn rows(bits: u64) -> u64 {
    (0..u64::from(WIDE)).fold(0, |all, i| all | bits >> (i << BAND) & ROW)
}

#[cfg(test)]
impl<'a> Numbered<'a> {
    /// Without marked vertices.
    pub(super) fn plain(net: &'a Bisection) -> Self {
        let lines = [0, 1].map(|d| vec![false; net.lines[d].len()]);
        Self::new(net, &lines, None::<fn(Place) -> bool>)
    }

    /// The places of all, if they are plain.
    pub(super) fn places(&self) -> Vec<Place> {
        assert!(self.marked.is_empty());
        let m = self.net.lines[1].len();
        let crossings = 0..self.crossings.len();
        let crossings = crossings.map(|k| [k / m, k % m].map(|i| (i as u64) << DEPTH));
        let tiles = self.net.tiles.iter();
        let inside = tiles.flat_map(|t| each(t.bits).map(|n| place(t.name, n)));
        crossings.chain(inside).collect()
    }
}
