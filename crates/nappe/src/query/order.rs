//! An order in which points come after others near them: along Morton's curve. What is looked at for one is then in the caches
//! for the next.

use glam::DVec3;

/// Bits of each coordinate.
const BITS: u32 = 10;

/// The numbers of the points in such an order. Cost: some ten nanoseconds a point.
pub(super) fn along_curve(points: &[DVec3]) -> Vec<usize> {
    let finite = || points.iter().copied().filter(|p| p.is_finite());
    let lo = finite().reduce(DVec3::min).unwrap_or(DVec3::ZERO);
    let hi = finite().reduce(DVec3::max).unwrap_or(DVec3::ZERO);
    let largest = f64::from((1u32 << BITS) - 1);
    let scale = largest / (hi - lo).max_element().max(f64::MIN_POSITIVE);
    // Of what is not finite or not far apart the numbers are 0: any order will do.
    let code = |p: DVec3| {
        let [x, y, z] = ((p - lo) * scale)
            .to_array()
            .map(|x| spread(x.min(largest) as u32));
        x | y << 1 | z << 2
    };
    if u32::try_from(points.len()).is_err() {
        return (0..points.len()).collect();
    }
    let keys = points.iter().enumerate();
    let mut keys: Vec<u64> = keys
        .map(|(k, &p)| u64::from(code(p)) << 32 | k as u64)
        .collect();
    keys.sort_unstable();
    keys.into_iter()
        .map(|key| (key & u64::from(u32::MAX)) as usize)
        .collect()
}

/// The bits of a number of ten bits, each followed by two that are 0.
fn spread(x: u32) -> u32 {
    let x = (x | x << 16) & 0x0300_00ff;
    let x = (x | x << 8) & 0x0300_f00f;
    let x = (x | x << 4) & 0x030c_30c3;
    (x | x << 2) & 0x0924_9249
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_points_are_there_and_neighbours_are_near() {
        let at = |k: usize| DVec3::new((k % 8) as f64, (k / 8 % 8) as f64, (k / 64) as f64);
        let mut points: Vec<DVec3> = (0..512).map(|k| at(k * 101 % 512)).collect();
        let order = along_curve(&points);
        let way: f64 = order
            .windows(2)
            .map(|w| points[w[0]].distance(points[w[1]]))
            .sum();
        // A step of 1 from each to the next at best; some 4 at random.
        assert!(way < 2.0 * 512.0, "{way}");
        points.extend([DVec3::NAN, DVec3::INFINITY, DVec3::splat(-1e300)]);
        for points in [&points[..], &points[..1], &[], &[DVec3::NAN; 3]] {
            let mut order = along_curve(points);
            order.sort_unstable();
            assert_eq!(order, (0..points.len()).collect::<Vec<_>>());
        }
    }
}
