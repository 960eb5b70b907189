//! Parts that hang together, and which of them to turn so that all agree.

use std::collections::VecDeque;

/// Follows parts from neighbour to neighbour: `neighbours[k]` lists the parts that part k meets, each with true if one of
/// both must be turned for them to agree. Returns each body as its parts in the order of the walk, with true for those to
/// turn so that they agree with the first; or a part from which there are ways that contradict each other, as on a Möbius
/// strip. Time proportional to the number of neighbours.
pub fn bodies(neighbours: &[Vec<(usize, bool)>]) -> Result<Vec<Vec<(usize, bool)>>, usize> {
    let mut turn: Vec<Option<bool>> = vec![None; neighbours.len()];
    let mut bodies = Vec::new();
    for start in 0..neighbours.len() {
        if turn[start].is_some() {
            continue;
        }
        turn[start] = Some(false);
        let (mut body, mut queue) = (Vec::new(), VecDeque::from([(start, false)]));
        while let Some((part, turned)) = queue.pop_front() {
            body.push((part, turned));
            for &(next, against) in &neighbours[part] {
                match turn[next] {
                    None => {
                        turn[next] = Some(turned != against);
                        queue.push_back((next, turned != against));
                    }
                    Some(t) if t != (turned != against) => return Err(part),
                    Some(_) => {}
                }
            }
        }
        bodies.push(body);
    }
    Ok(bodies)
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
            match bodies(&ring(&against)) {
                Ok(found) => {
                    assert_eq!(mask.count_ones() % 2, 0);
                    assert_eq!(found.len(), 1);
                    let mut turn = [false; 5];
                    found[0].iter().for_each(|&(k, t)| turn[k] = t);
                    let agree = (0..5).all(|k| (turn[k] != turn[(k + 1) % 5]) == against[k]);
                    assert!(agree && found[0].len() == 5);
                }
                Err(_) => assert_eq!(mask.count_ones() % 2, 1),
            }
        }
        let two = [ring(&[false; 2]), vec![vec![]]].concat();
        assert_eq!(bodies(&two).map(|b| b.len()), Ok(2));
    }
}
