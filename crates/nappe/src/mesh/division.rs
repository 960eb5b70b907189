//! The best division of a square in one analytic piece into squares of different sizes.
//!
//! The bounds for all equal parts of a square cost little together (`parts`). So they are taken for parts of each size, and
//! from the smallest up four squares are made one where that does not need more triangles. Squares at a side of the block,
//! which these bounds are not for, are left open.

use super::bisection::{Bisection, DEPTH, Square};
use super::parts::Parts;
use super::partners::Bound;

/// With so few bisections, looking at the parts of a square saves hardly a triangle.
pub(super) const SETTLED: u32 = 2;
/// Parts that need this many times the triangles that their second derivatives ask for are enclosed by themselves.
const ENOUGH_KNOWN: f64 = 1.5;

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
    fn settled(bound: &Bound, tol: f64, grain: f64) -> Option<Self> {
        let (level, deviation) = bound.level(tol, grain)?;
        Some(Self {
            choice: Choice::Settled(level),
            triangles: triangles(level),
            deviation,
        })
    }

    /// With the triangles that it needs at best.
    fn open(best: &Bound, tol: f64) -> Option<Self> {
        let (level, _) = best.level(tol, 0.0)?;
        Some(Self {
            choice: Choice::Open,
            triangles: triangles(level),
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
    2.0 * (1u64 << level) as f64
}

impl Division {
    /// That of a square which by itself would need so many bisections; `None` if what is known is too little to say that its
    /// parts need hardly more than their second derivatives ask for.
    pub(super) fn new(parts: &Parts, level: u32, grain: f64, tol: f64) -> Option<Self> {
        // The smallest parts are about settled.
        let depth = (level - 1) / SETTLED;
        let mut sizes: Vec<Vec<Node>> = Vec::with_capacity(depth as usize + 1);
        for depth in (0..=depth).rev() {
            let n = 1 << depth;
            let bounds = parts.all(n);
            let node = |k: usize| {
                let [bound, best] = &bounds[k];
                if parts.touch([k / n, k % n], n) {
                    Node::open(best, tol)
                } else {
                    Node::settled(bound, tol, grain * n as f64)
                }
            };
            let nodes: Option<Vec<Node>> = match sizes.last() {
                None => (0..n * n).map(node).collect(),
                Some(below) => {
                    let better = |k: usize| {
                        let first = 2 * (k / n * 2 * n + k % n);
                        let quarters = [first, first + 1, first + 2 * n, first + 2 * n + 1];
                        let quartered = Node::quartered(quarters.map(|k| below[k]));
                        let whole = node(k).filter(|w| w.triangles <= quartered.triangles);
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
                let (mut needed, mut fewest) = (0.0, 0.0);
                for (node, [_, best]) in nodes.iter().zip(&bounds) {
                    if let Choice::Settled(level) = node.choice {
                        let least = if level == 0 {
                            0
                        } else {
                            best.level(tol, 0.0)?.0
                        };
                        needed += node.triangles;
                        fewest += triangles(least);
                    }
                }
                if needed > ENOUGH_KNOWN * fewest {
                    return None;
                }
            }
            sizes.push(nodes);
        }
        sizes.reverse();
        Some(Self { sizes })
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
                net.refine(part, 2);
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
