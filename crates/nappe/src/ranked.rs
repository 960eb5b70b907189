//! What a heap of work hands out: the item of the highest rank, and among equals the earliest, so that results do not
//! depend on the heap.

use std::cmp::Ordering;

/// An item with its rank and a number of its own.
pub(crate) struct Ranked<T> {
    pub(crate) rank: f64,
    pub(crate) number: usize,
    pub(crate) item: T,
}

impl<T> PartialEq for Ranked<T> {
    fn eq(&self, o: &Self) -> bool {
        self.cmp(o) == Ordering::Equal
    }
}

impl<T> Eq for Ranked<T> {}

impl<T> PartialOrd for Ranked<T> {
    fn partial_cmp(&self, o: &Self) -> Option<Ordering> {
        Some(self.cmp(o))
    }
}

impl<T> Ord for Ranked<T> {
    fn cmp(&self, o: &Self) -> Ordering {
        self.rank
            .total_cmp(&o.rank)
            .then(o.number.cmp(&self.number))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BinaryHeap;

    #[test]
    fn the_highest_rank_comes_first_and_among_equals_the_earliest() {
        let ranks = [1.0, 3.0, -2.0, 3.0, f64::INFINITY, 1.0];
        let ranked = ranks.into_iter().enumerate();
        let mut heap: BinaryHeap<_> = ranked
            .map(|(number, rank)| Ranked {
                rank,
                number,
                item: (),
            })
            .collect();
        let order: Vec<usize> = std::iter::from_fn(|| heap.pop().map(|r| r.number)).collect();
        assert_eq!(order, [4, 1, 3, 0, 5, 2]);
    }
}
