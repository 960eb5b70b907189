//! Parts that hang together, and which of them to turn so that all agree.

use std::collections::VecDeque;

/// Parts that hang together.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Body {
    /// The parts in the order of a walk; true for those to turn so that they agree with the first.
    pub parts: Vec<(usize, bool)>,
    /// A part from which there are ways that contradict each other, as on a Möbius strip: then no turns make all agree.
    pub contradiction: Option<usize>,
}

/// Follows parts from neighbour to neighbour: `neighbours[k]` lists the parts that part k meets, each with true if one of
/// both must be turned for them to agree. Time proportional to the number of neighbours.
pub fn bodies(neighbours: &[Vec<(usize, bool)>]) -> Vec<Body> {
    let mut turn: Vec<Option<bool>> = vec![None; neighbours.len()];
    let mut bodies = Vec::new();
    for start in 0..neighbours.len() {
        if turn[start].is_some() {
            continue;
        }
        turn[start] = Some(false);
        let mut body = Body {
            parts: Vec::new(),
            contradiction: None,
        };
        let mut queue = VecDeque::from([(start, false)]);
        while let Some((part, turned)) = queue.pop_front() {
            body.parts.push((part, turned));
            for &(next, against) in &neighbours[part] {
                match turn[next] {
                    None => {
                        turn[next] = Some(turned != against);
                        queue.push_back((next, turned != against));
                    }
                    Some(t) if t != (turned != against) => {
                        body.contradiction.get_or_insert(part);
                    }
                    Some(_) => {}
                }
            }
        }
        bodies.push(body);
    }
    bodies
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A ring of n parts, of which neighbours disagree where `against` says so.
    fn ring(against: &[bool]) -> Vec<Vec<(usize, bool)>> {
        let n = against.len();
        let before = |k: usize| (k + n - 1) % n;
        (0..n)
            .map(|k| vec![((k + 1) % n, against[k]), (before(k), against[before(k)])])
            .collect()
    }

    #[test]
    fn a_ring_agrees_if_it_is_turned_an_even_number_of_times() {
        for mask in 0..32u32 {
            let against: Vec<bool> = (0..5).map(|k| mask >> k & 1 == 1).collect();
            let found = bodies(&ring(&against));
            assert_eq!((found.len(), found[0].parts.len()), (1, 5));
            let odd = mask.count_ones() % 2 == 1;
            assert_eq!(found[0].contradiction.is_some(), odd);
            let mut turn = [false; 5];
            found[0].parts.iter().for_each(|&(k, t)| turn[k] = t);
            let agree = (0..5).all(|k| (turn[k] != turn[(k + 1) % 5]) == against[k]);
            assert_eq!(agree, !odd);
        }
        // One that contradicts itself says nothing about others.
        let lone = |k: usize| vec![(k, true)];
        let found = bodies(&[ring(&[false; 2]), vec![lone(2)], vec![vec![]]].concat());
        let wrong: Vec<_> = found.iter().map(|b| b.contradiction).collect();
        assert_eq!(wrong, [None, Some(2), None]);
    }
}
