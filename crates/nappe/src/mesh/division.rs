//! The best division of a square in one analytic piece into squares of different sizes.
//!
//! The bounds for all equal parts of a square cost little together (`parts`). So they are taken for parts of each size, and
//! from the smallest up four squares are made one where that does not need more triangles. Squares in corners of the block,
//! which these bounds are not for, are left open, and those along its sides where the bounds say much too much.

use super::bisection::{Bisection, DEPTH, Square};
use super::levels::Level;
use super::parts::{Beside, Parts};

/// With so few bisections, looking at the parts of a square saves hardly a triangle.
pub(super) const SETTLED: u32 = 2;
/// A part that would get more than this many times the triangles that its second derivatives ask for is left open, and the
/// quarters are looked at if that is so for the whole square. As sizes go in powers of two, half as many more are common.
const ENOUGH_KNOWN: f64 = 2.0;
/// But a square that needs so many triangles is not: that would cost more than it saves.
const MANY: f64 = 128.0;
/// With a larger share of open parts, the quarters of the square are looked at instead.
const FEW_OPEN: f64 = 0.25;

/// The division of a square.
pub(super) struct Division {
    /// The equal parts of each size, v fastest, the square itself first.
    sizes: Vec<Vec<Node>>,
}

/// A part of the square.
#[derive(Clone, Copy)]
struct Node {
    choice: Choice,
    triangles: f64,
    deviation: f64,
}

/// What becomes of a part.
#[derive(Clone, Copy)]
enum Choice {
    /// It gets so many bisections.
    Settled(u32),
    Quartered,
    /// It is judged by itself.
    Open,
}

impl Node {
    fn settled(need: &Level) -> Option<Self> {
        let (level, deviation) = need.settled()?;
        Some(Self {
            choice: Choice::Settled(level),
            triangles: triangles(level),
            deviation,
        })
    }

    /// With the triangles that it needs at best.
    fn open(need: &Level) -> Option<Self> {
        Some(Self {
            choice: Choice::Open,
            triangles: triangles(need.best()?),
            deviation: 0.0,
        })
    }

    fn quartered(quarters: [Self; 4]) -> Self {
        Self {
            choice: Choice::Quartered,
            triangles: quarters.iter().map(|q| q.triangles).sum(),
            deviation: quarters.iter().map(|q| q.deviation).fold(0.0, f64::max),
        }
    }
}

/// Those of a square after some bisections.
pub(super) fn triangles(level: u32) -> f64 {
    // 2^(level + 1), by its exponent.
    f64::from_bits((1024 + u64::from(level)) << 52)
}

impl Division {
    /// That of a square which by itself would need so many bisections; `None` if what is known is too little to say that its
    /// parts need hardly more than their second derivatives ask for.
    pub(super) fn new(parts: &Parts, level: u32, grain: f64, tol: f64) -> Option<Self> {
        // The smallest parts are about settled.
        let depth = (level - 1) / SETTLED;
        let mut fewest = 0.0;
        let mut sizes: Vec<Vec<Node>> = Vec::with_capacity(depth as usize + 1);
        for depth in (0..=depth).rev() {
            let n = 1 << depth;
            let needs = parts.levels(n, grain * n as f64, tol);
            let node = |k: usize, open: bool| {
                let need = &needs[k];
                let other = Node::open(need);
                if parts.beside([k / n, k % n], n) == Beside::Corner {
                    return other;
                }
                let other = other.filter(|_| open);
                let most = other.map_or(f64::INFINITY, |o| ENOUGH_KNOWN * o.triangles);
                let settled = Node::settled(need);
                settled.filter(|s| s.triangles <= most).or(other)
            };
            let nodes: Option<Vec<Node>> = match sizes.last() {
                None => (0..n * n).map(|k| node(k, true)).collect(),
                Some(below) => {
                    let better = |k: usize| {
                        let first = 2 * (k / n * 2 * n + k % n);
                        let quarters = [first, first + 1, first + 2 * n, first + 2 * n + 1];
                        let quarters = quarters.map(|k| below[k]);
                        let open = quarters.iter().any(|q| matches!(q.choice, Choice::Open));
                        let quartered = Node::quartered(quarters);
                        let whole = node(k, open).filter(|w| w.triangles <= quartered.triangles);
                        // Those left open are to be settled when they are judged; the square itself is being judged.
                        let fits = |w: &Node| match w.choice {
                            Choice::Open => n > 1 && w.triangles <= triangles(SETTLED),
                            _ => true,
                        };
                        whole.filter(fits).unwrap_or(quartered)
                    };
                    Some((0..n * n).map(better).collect())
                }
            };
            let nodes = nodes?;
            if sizes.is_empty() {
                let open = nodes.iter().filter(|n| matches!(n.choice, Choice::Open));
                if open.count() as f64 > FEW_OPEN * nodes.len() as f64 {
                    return None;
                }
                // Twice the triangles have half the error.
                let errors = needs.iter().map(|need| need.best_error / tol);
                fewest = 2.0 * errors.sum::<f64>();
            }
            sizes.push(nodes);
        }
        sizes.reverse();
        let found = Self { sizes };
        let enough = fewest >= MANY || found.triangles() <= ENOUGH_KNOWN * fewest;
        enough.then_some(found)
    }

    pub(super) fn triangles(&self) -> f64 {
        self.sizes[0][0].triangles
    }

    pub(super) fn deviation(&self) -> f64 {
        self.sizes[0][0].deviation
    }

    /// Halves the triangles of the square as often as they need, and hands on what is left open.
    pub(super) fn refine(
        &self,
        net: &mut Bisection,
        square: Square,
        open: &mut Vec<Square>,
    ) -> Refined {
        let mut done = Refined {
            fits: true,
            triangles: 0.0,
        };
        self.refine_part(net, square, open, [0; 3], &mut done);
        done
    }

    fn refine_part(
        &self,
        net: &mut Bisection,
        part: Square,
        open: &mut Vec<Square>,
        [depth, i, j]: [usize; 3],
        done: &mut Refined,
    ) {
        let node = self.sizes[depth][(i << depth) + j];
        match node.choice {
            Choice::Settled(level) => {
                let deepest = 2 * (DEPTH - part.depth);
                net.refine(part, level.min(deepest));
                done.fits &= level <= deepest;
                done.triangles += node.triangles;
            }
            Choice::Quartered => {
                let quarters = [0, 1].map(|k| {
                    let first = ((2 * i + k) << (depth + 1)) + 2 * j;
                    &self.sizes[depth + 1][first..first + 2]
                });
                // A quarter that is halved needs its corners, and these the rest.
                let halved = |q: &Node| match q.choice {
                    Choice::Settled(level) => level > 0,
                    Choice::Quartered => true,
                    Choice::Open => false,
                };
                if !quarters.into_iter().flatten().all(halved) {
                    net.refine(part, 2);
                }
                for (k, quarter) in part.children().into_iter().enumerate() {
                    let at = [depth + 1, 2 * i + (k & 1), 2 * j + (k >> 1)];
                    self.refine_part(net, quarter, open, at, done);
                }
            }
            Choice::Open => open.push(part),
        }
    }
}

/// What became of a square that was divided.
pub(super) struct Refined {
    /// False if there was no room for so many bisections.
    pub(super) fits: bool,
    /// Those of the parts that are not open.
    pub(super) triangles: f64,
}

#[cfg(test)]
mod tests {
    use super::super::numbered::Numbered;
    use super::super::partners::{Framed, Place};
    use super::super::pieces::Pieces;
    use super::*;
    use crate::basis::BSplineBasis;
    use crate::exact::NurbsSurface;
    use crate::interval::Interval;
    use crate::surface::Surface;
    use glam::DVec3;

    const TOL: f64 = 1e-4;

    /// `z = (1 + 3 u)³ (1 + 3 v)³ / 4⁸`, which bends most in one corner.
    fn surface() -> NurbsSurface {
        const DEGREE: usize = 3;
        let at = |i: usize| i as f64 / DEGREE as f64;
        let numbers = (0..=DEGREE).flat_map(|i| (0..=DEGREE).map(move |j| [i, j]));
        let points: Vec<DVec3> = numbers
            .map(|[i, j]| DVec3::new(at(i), at(j), 0.25f64.powi((2 * DEGREE + 2 - i - j) as i32)))
            .collect();
        let knots = BSplineBasis::clamped_uniform(DEGREE, DEGREE + 1);
        let knots = [knots.clone(), knots];
        NurbsSurface::new([DEGREE; 2], knots, &points, None).expect("a regular surface")
    }

    /// The division of its domain, as if it ended at some sides.
    fn divided(touches: [[bool; 2]; 2], level: u32) -> Division {
        let surface = surface();
        let place = Place {
            uv: surface.domain(),
            block: touches.map(|[lower, upper]| {
                let beyond = |at: bool| if at { 0.0 } else { 1.0 };
                Interval::new(-beyond(lower), 1.0 + beyond(upper))
            }),
            least: [1.0; 2],
        };
        let pieces = Pieces::new(&surface, TOL);
        let jet = surface.enclose(place.uv, 2);
        let framed = Framed::new(&place, &jet).expect("the normal stays up");
        let local = pieces.local(place.uv).expect("it is one piece");
        let parts = Parts::new(&framed, &place, &local);
        Division::new(&parts, level, 0.0, TOL).expect("it is smooth")
    }

    fn net() -> Bisection {
        Bisection::new([vec![0.0, 1.0], vec![0.0, 1.0]])
    }

    #[test]
    fn squares_are_as_large_as_their_curvature_allows() {
        let division = divided([[false; 2]; 2], 9);
        let (mut net, mut open) = (net(), Vec::new());
        let refined = division.refine(&mut net, Square::cell([0, 0]), &mut open);
        assert!(refined.fits && open.is_empty() && division.deviation() <= TOL);
        assert_eq!(refined.triangles, division.triangles());
        // What the neighbours of small squares need comes on top.
        let (mut count, mut least) = (0.0, f64::INFINITY);
        net.close();
        let numbered = Numbered::plain(&net);
        let places = numbered.places();
        numbered.triangles([0, 0], |t, _| {
            let [a, b, c] = t.map(|k| net.uv(places[k as usize]));
            let twice = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            least = least.min(0.5 * twice);
            count += 1.0;
        });
        assert!((refined.triangles..1.2 * refined.triangles).contains(&count));
        // As small as in the corner where it bends most, there would be many more.
        assert!(count < 0.5 / least, "{count} of {}", 1.0 / least);
    }

    #[test]
    fn squares_are_left_open_in_corners() {
        for (touches, corners) in [
            ([[true, false], [false, false]], 0),
            ([[false, true], [true, false]], 1),
            ([[true, true], [true, true]], 4),
        ] {
            let (mut net, mut open) = (net(), Vec::new());
            let division = divided(touches, 9);
            let refined = division.refine(&mut net, Square::cell([0, 0]), &mut open);
            assert_eq!(refined.triangles > 0.0, division.deviation() > 0.0);
            let last = Square::cell([0, 0]).upper();
            assert_eq!(open.len(), corners);
            for square in open {
                let (lower, upper) = (square.corner, square.upper());
                for d in 0..2 {
                    let at = [lower[d] == 0, upper[d] == last[d]];
                    assert!((0..2).any(|e| at[e] && touches[d][e]));
                }
            }
        }
    }
}
