//! Where a curve or surface is less smooth, and from which side a limit is taken.

use crate::interval::Interval;
use smallvec::SmallVec;

/// From which side a value is taken where a map is only piecewise smooth. At a domain end the inner side is meant.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub enum Limit {
    /// The limit from smaller parameters.
    Below,
    /// The limit from larger parameters.
    #[default]
    Above,
}

/// The limits at a place of a rectangle from the inside of the rectangle.
pub(crate) fn inwards(uv: [f64; 2], within: [Interval; 2]) -> [Limit; 2] {
    [0, 1].map(|d| {
        if uv[d] >= within[d].hi {
            Limit::Below
        } else {
            Limit::Above
        }
    })
}

/// A parameter where two analytic pieces meet, or an end of the domain.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Break {
    /// The parameter.
    pub at: f64,
    /// How many derivatives are continuous there: 0 for a corner, -1 for a jump. Not meaningful at the ends.
    pub smooth: i32,
}

impl Break {
    /// A break.
    pub const fn new(at: f64, smooth: i32) -> Self {
        Self { at, smooth }
    }
}

/// A part of a domain that lies in one analytic piece, with the limit that selects the piece.
pub type Part = (Interval, Limit);

/// The breaks of a map that is analytic on `[0, 1]`.
pub const UNIT_BREAKS: [Break; 2] = [Break::new(0.0, 0), Break::new(1.0, 0)];

/// Read access to a list of breaks (strictly increasing; the first and last are the ends of the domain).
pub trait Breaks {
    /// The domain.
    fn domain(&self) -> Interval;
    /// The number of analytic pieces.
    fn pieces(&self) -> usize;
    /// The parameter range of a piece.
    fn piece(&self, i: usize) -> Interval;
    /// The piece that decides the value at `t`: the one after a break for [`Limit::Above`], before it for
    /// [`Limit::Below`]. Parameters outside the domain belong to the first or last piece.
    fn find(&self, t: f64, limit: Limit) -> usize;
    /// The parts of `t` that lie in one piece each, with the limit that selects that piece. A single parameter on a
    /// break has two, one for each side; a range that ends on a break has none beyond it.
    fn parts(&self, t: Interval) -> Vec<Part>;
    /// The breaks where fewer than `smooth + 1` derivatives agree, without the ends.
    fn below(&self, smooth: i32) -> Vec<f64>;
    /// The first place where the map jumps.
    fn tear(&self) -> Option<f64> {
        self.below(0).first().copied()
    }
}

impl Breaks for [Break] {
    fn domain(&self) -> Interval {
        Interval {
            lo: self[0].at,
            hi: self[self.len() - 1].at,
        }
    }

    fn pieces(&self) -> usize {
        self.len() - 1
    }

    fn piece(&self, i: usize) -> Interval {
        Interval {
            lo: self[i].at,
            hi: self[i + 1].at,
        }
    }

    fn find(&self, t: f64, limit: Limit) -> usize {
        let inner = &self[1..self.len() - 1];
        match limit {
            Limit::Above => inner.partition_point(|b| b.at <= t),
            Limit::Below => inner.partition_point(|b| b.at < t),
        }
    }

    fn parts(&self, t: Interval) -> Vec<Part> {
        if t.is_point() {
            let limits = [Limit::Below, Limit::Above];
            let once = self.find(t.lo, limits[0]) == self.find(t.lo, limits[1]);
            return limits[usize::from(once)..]
                .iter()
                .map(|&limit| (t, limit))
                .collect();
        }
        let first = self.find(t.lo, Limit::Above);
        let last = self.find(t.hi, Limit::Below);
        (first..=last)
            .map(|i| {
                let piece = self.piece(i);
                let lo = if i == first { t.lo } else { piece.lo };
                let hi = if i == last { t.hi } else { piece.hi };
                (Interval { lo, hi }, Limit::Above)
            })
            .collect()
    }

    fn below(&self, smooth: i32) -> Vec<f64> {
        self[1..self.len() - 1]
            .iter()
            .filter(|b| b.smooth < smooth)
            .map(|b| b.at)
            .collect()
    }
}

/// The breaks of several maps over the same domain taken together; at equal parameters the least smooth counts.
/// Parameters of different maps closer than 4 units in the last place of the domain's ends are one break.
pub fn merge_breaks<'a>(lists: impl IntoIterator<Item = &'a [Break]>) -> Vec<Break> {
    let lists = lists.into_iter().enumerate();
    let mut all: Vec<(usize, Break)> = lists
        .flat_map(|(list, breaks)| breaks.iter().map(move |b| (list, *b)))
        .collect();
    all.sort_by(|a, b| a.1.at.total_cmp(&b.1.at));
    let ends = [all.first(), all.last()];
    let farthest = |far: f64, b: &(usize, Break)| far.max(b.1.at.abs());
    let near = 4.0 * f64::EPSILON * ends.into_iter().flatten().fold(0.0, farthest);
    let mut merged: Vec<Break> = Vec::with_capacity(all.len());
    // The maps that have the last break: between two breaks of one map there is a piece, however short.
    let mut having: SmallVec<[usize; 8]> = SmallVec::new();
    for (list, b) in all {
        match merged.last_mut() {
            Some(last) if b.at - last.at <= near && !having.contains(&list) => {
                last.smooth = last.smooth.min(b.smooth);
            }
            _ => {
                merged.push(b);
                having.clear();
            }
        }
        having.push(list);
    }
    merged
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_found_and_split() {
        let b = [
            Break::new(0.0, 0),
            Break::new(1.0, 2),
            Break::new(3.0, 0),
            Break::new(4.0, 0),
        ];
        let b = &b[..];
        assert_eq!(b.find(1.0, Limit::Above), 1);
        assert_eq!(b.find(1.0, Limit::Below), 0);
        assert_eq!(b.find(9.0, Limit::Above), 2);
        assert_eq!(b.find(4.0, Limit::Below), 2);
        assert_eq!(b.parts(Interval::new(0.5, 3.5)).len(), 3);
        assert_eq!(
            b.parts(Interval::new(1.2, 1.5)),
            vec![(Interval::new(1.2, 1.5), Limit::Above)]
        );
        let at_break = b.parts(Interval::point(1.0));
        assert_eq!(
            at_break,
            vec![
                (Interval::point(1.0), Limit::Below),
                (Interval::point(1.0), Limit::Above)
            ]
        );
        assert_eq!(
            b.parts(Interval::new(1.0, 3.0)),
            vec![(Interval::new(1.0, 3.0), Limit::Above)]
        );
        for (part, limit) in b.parts(Interval::new(0.0, 4.0)) {
            assert_eq!(b.piece(b.find(part.mid(), limit)), part);
        }
        assert_eq!(b.below(1), vec![3.0]);
    }
}
