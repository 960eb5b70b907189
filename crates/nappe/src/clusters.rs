//! What hangs together.

use crate::interval::Interval;

/// The numbers from 0 to n - 1 in sets, each led by its smallest number.
pub(crate) struct Sets(Vec<usize>);

impl Sets {
    /// Every number alone.
    pub(crate) fn new(n: usize) -> Self {
        Self((0..n).collect())
    }

    /// The leader of a number's set; ways to it are shortened.
    pub(crate) fn leader(&mut self, mut k: usize) -> usize {
        let leaders = &mut self.0;
        while leaders[k] != k {
            leaders[k] = leaders[leaders[k]];
            k = leaders[k];
        }
        k
    }

    /// Makes one set of two. The smaller number leads, so the result does not depend on the order.
    pub(crate) fn unite(&mut self, a: usize, b: usize) {
        let (a, b) = (self.leader(a), self.leader(b));
        self.0[a.max(b)] = a.min(b);
    }
}

/// The numbers of boxes that come within a distance of each other along every axis, directly or by others in between.
pub(crate) fn clusters<const N: usize>(boxes: &[[Interval; N]], apart: f64) -> Vec<Vec<usize>> {
    let near = |a: Interval, b: Interval| a.lo - b.hi <= apart && b.lo - a.hi <= apart;
    // Along the longest side of them all fewest are abreast.
    let length = |d: usize| {
        let all = boxes.iter().map(|b| b[d]).reduce(Interval::hull);
        all.map_or(0.0, Interval::width)
    };
    let axis = (0..N)
        .max_by(|&a, &b| length(a).total_cmp(&length(b)))
        .unwrap_or(0);
    let mut order: Vec<usize> = (0..boxes.len()).collect();
    order.sort_by(|&a, &b| boxes[a][axis].lo.total_cmp(&boxes[b][axis].lo));
    let mut sets = Sets::new(boxes.len());
    // Those that began along it and have not ended yet.
    let mut open: Vec<usize> = Vec::new();
    for &k in &order {
        open.retain(|&o| near(boxes[o][axis], boxes[k][axis]));
        for &o in &open {
            if (0..N).all(|d| near(boxes[o][d], boxes[k][d])) {
                sets.unite(o, k);
            }
        }
        open.push(k);
    }
    let mut groups: Vec<Vec<usize>> = vec![Vec::new(); boxes.len()];
    for k in 0..boxes.len() {
        groups[sets.leader(k)].push(k);
    }
    groups.retain(|g| !g.is_empty());
    groups
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::laws::Random;

    /// Against sets that grow by every pair, in any order of the axes' lengths.
    #[test]
    fn clusters_are_those_of_all_pairs() {
        let mut random = Random(5);
        for scale in [[1.0, 1.0, 1.0], [0.01, 4.0, 1.0], [3.0, 0.1, 0.1]] {
            for apart in [0.0, 0.03] {
                let boxes: Vec<[Interval; 3]> = (0..120)
                    .map(|_| {
                        scale.map(|s| {
                            let lo = s * random.unit();
                            Interval::new(lo, lo + 0.1 * s * random.unit())
                        })
                    })
                    .collect();
                let mut sets = Sets::new(boxes.len());
                for (i, a) in boxes.iter().enumerate() {
                    for (j, b) in boxes[..i].iter().enumerate() {
                        if (0..3).all(|d| a[d].lo <= b[d].hi + apart && b[d].lo <= a[d].hi + apart)
                        {
                            sets.unite(i, j);
                        }
                    }
                }
                let found = clusters(&boxes, apart);
                assert!(found.len() > 1 && found.len() < boxes.len());
                assert_eq!(found.iter().map(Vec::len).sum::<usize>(), boxes.len());
                for group in &found {
                    assert!(group.iter().all(|&k| sets.leader(k) == group[0]));
                }
            }
        }
    }
}
