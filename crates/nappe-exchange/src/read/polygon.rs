//! Polygons of meshes as triangles.

use glam::{DVec2, DVec3};

/// The most corners of a polygon that is not convex: finding its ears takes time with their square.
const MOST: usize = 4096;

/// Triangles over each other have more area than the polygon, by more than this share.
const OVERLAP: f64 = 1e-9;

/// Triangles with the corners of a polygon (numbers from 0), in its direction. A quadrangle is cut by the diagonal that
/// keeps both triangles on one side, and by the shorter one where both do. Larger ones are cut ear by ear, in the plane
/// that fits best; corners may be visited more than once, as those of a bridge to a hole are. The second value tells
/// whether the polygon crosses itself, so that triangles lie over each other.
///
/// Errors: what is wrong with it, in words.
pub(super) fn triangulate(points: &[DVec3]) -> Result<(Vec<[u32; 3]>, bool), String> {
    match points.len() {
        0..3 => Err(format!("a face of {} points; it needs three", points.len())),
        3 => Ok((vec![[0, 1, 2]], false)),
        4 => Ok((quadrangle(points), false)),
        n if n <= MOST => Ok(ears(points)),
        n => Err(format!(
            "a face of {n} points; faces of at most {MOST} can be read"
        )),
    }
}

/// What is said of faces that cross themselves.
pub(super) fn note(crossed: usize) -> Option<String> {
    (crossed > 0).then(|| {
        format!("{crossed} faces cross themselves: their triangles lie over each other, and area and volume count them so.")
    })
}

fn quadrangle(p: &[DVec3]) -> Vec<[u32; 3]> {
    let area = |i: usize, j: usize, k: usize| (p[j] - p[i]).cross(p[k] - p[i]);
    // Positive if both triangles face the same side.
    let agree = [
        area(0, 1, 2).dot(area(0, 2, 3)),
        area(0, 1, 3).dot(area(1, 2, 3)),
    ];
    let lengths = [p[0].distance(p[2]), p[1].distance(p[3])];
    let second = if (agree[0] > 0.0) == (agree[1] > 0.0) {
        lengths[1] < lengths[0]
    } else {
        agree[1] > 0.0
    };
    if second {
        vec![[0, 1, 3], [1, 2, 3]]
    } else {
        vec![[0, 1, 2], [0, 2, 3]]
    }
}

fn ears(points: &[DVec3]) -> (Vec<[u32; 3]>, bool) {
    let n = points.len();
    let origin = points[0];
    // Newell's normal: twice the area vector of the polygon.
    let normal: DVec3 = (0..n)
        .map(|i| (points[i] - origin).cross(points[(i + 1) % n] - origin))
        .sum();
    let drop = normal.abs().to_array();
    let k = (0..3).fold(0, |m, i| if drop[i] > drop[m] { i } else { m });
    let sign = if normal[k] < 0.0 { -1.0 } else { 1.0 };
    let flat: Vec<DVec2> = points
        .iter()
        .map(|p| {
            let p = *p - origin;
            DVec2::new(p[(k + 1) % 3], p[(k + 2) % 3] * sign)
        })
        .collect();
    let turn = |a: usize, b: usize, c: usize| (flat[b] - flat[a]).perp_dot(flat[c] - flat[b]);
    let mut left: Vec<usize> = (0..n).collect();
    let mut triangles = Vec::with_capacity(n - 2);
    let mut at = 0;
    // Corners looked at since the last ear.
    let mut tried = 0;
    while left.len() > 3 {
        let m = left.len();
        let [a, b, c] = [left[at % m], left[(at + 1) % m], left[(at + 2) % m]];
        let inside = |&p: &usize| {
            let inner = [(a, b), (b, c), (c, a)].map(|(i, j)| turn(i, j, p) >= 0.0);
            // What else passes through a corner of an ear does not enter it: paths that do not cross stay on their side.
            [a, b, c].iter().all(|k| flat[*k] != flat[p]) && inner == [true; 3]
        };
        // A polygon that crosses itself has no more ears at some time: then any corner is cut, and so are all others.
        let spent = tried > m;
        if spent || (turn(a, b, c) > 0.0 && !left.iter().any(inside)) {
            triangles.push([a as u32, b as u32, c as u32]);
            left.remove((at + 1) % m);
            if !spent {
                tried = 0;
            }
        } else {
            tried += 1;
        }
        at = (at + 1) % left.len();
    }
    triangles.push([left[0] as u32, left[1] as u32, left[2] as u32]);
    let areas = triangles.iter().map(|t| {
        let [a, b, c] = t.map(|i| i as usize);
        turn(a, b, c)
    });
    let [sum, all] = areas.fold([0.0, 0.0], |[s, a], x: f64| [s + x, a + x.abs()]);
    (triangles, all - sum > OVERLAP * all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_star_keeps_its_area() {
        // Ten corners, five of them inwards: the area is that of the shoelace formula.
        let star: Vec<DVec3> = (0..10)
            .map(|i| {
                let (r, a) = (
                    if i % 2 == 0 { 2.0 } else { 0.7 },
                    f64::from(i) * std::f64::consts::PI / 5.0,
                );
                DVec3::new(1e3, 5.0 + r * a.cos(), r * a.sin())
            })
            .collect();
        let shoelace: f64 = (0..10)
            .map(|i| star[i].cross(star[(i + 1) % 10]).x / 2.0)
            .sum();
        let (triangles, crossed) = triangulate(&star).unwrap();
        assert!(!crossed);
        assert_eq!(triangles.len(), 8);
        let areas = triangles.iter().map(|t| {
            let [a, b, c] = t.map(|i| star[i as usize]);
            (b - a).cross(c - a).x / 2.0
        });
        // All triangles face the same side, so none lies over another.
        assert!(areas.clone().all(|a| a > 0.0));
        assert!((areas.sum::<f64>() - shoelace).abs() < 1e-10);
    }

    #[test]
    fn a_quadrangle_with_a_dent_is_cut_at_the_dent() {
        let p = [[0., 0.], [4., 0.], [1., 1.], [0., 4.]].map(|[x, y]| DVec3::new(x, y, 0.0));
        assert_eq!(triangulate(&p).unwrap().0, [[0, 1, 2], [0, 2, 3]]);
        let q = [p[1], p[2], p[3], p[0]];
        assert_eq!(triangulate(&q).unwrap().0, [[0, 1, 3], [1, 2, 3]]);
        assert!(triangulate(&p[..2]).is_err());
    }

    /// The area of all triangles, and that of those which face the other side.
    fn areas(points: &[DVec3]) -> [f64; 2] {
        let (triangles, _) = triangulate(points).unwrap();
        triangles.iter().fold([0.0, 0.0], |[all, turned], t| {
            let [a, b, c] = t.map(|i| points[i as usize]);
            let area = (b - a).cross(c - a).z / 2.0;
            [all + area.abs(), turned + (-area).max(0.0)]
        })
    }

    #[test]
    fn a_hole_that_is_reached_by_a_bridge_stays_open() {
        let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let outer = [p(0., 0.), p(4., 0.), p(4., 4.), p(0., 4.)];
        let hole = [p(1., 1.), p(1., 3.), p(3., 3.), p(3., 1.)];
        let mut face: Vec<DVec3> = outer.into_iter().chain([outer[0]]).collect();
        face.extend(hole.into_iter().chain([hole[0]]));
        assert_eq!(areas(&face), [12.0, 0.0]);
        // From wherever the list begins, and with a second hole.
        let second = [p(3.25, 3.25), p(3.25, 3.75), p(3.75, 3.75), p(3.75, 3.25)];
        let two: Vec<DVec3> = outer[..3]
            .iter()
            .copied()
            .chain([second[2], second[3], second[0], second[1], second[2]])
            .chain(outer[2..].iter().copied())
            .chain([outer[0]])
            .chain(hole.into_iter().chain([hole[0]]))
            .collect();
        for (mut polygon, area) in [(face, 12.0), (two, 11.75)] {
            for _ in 0..polygon.len() {
                polygon.rotate_left(1);
                assert_eq!(areas(&polygon), [area, 0.0]);
                assert!(!triangulate(&polygon).unwrap().1);
            }
        }
    }

    #[test]
    fn a_polygon_that_crosses_itself_is_told() {
        let star: Vec<DVec3> = (0..5)
            .map(|i| DVec2::from_angle(f64::from(i) * 0.8 * std::f64::consts::PI).extend(0.0))
            .collect();
        assert!(triangulate(&star).unwrap().1);
    }
}
