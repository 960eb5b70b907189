//! Surfaces that join a neighbour.

use super::*;

/// For every pair of sides and both directions: a surface whose boundary leaves the common side in the tangent plane of
/// the neighbour, with lengths and directions of its own, has the neighbour's normals along it.
#[test]
fn a_surface_joins_its_neighbour_without_a_crease() {
    let neighbour = patch(11, [3, 4], 1.0, DVec3::ZERO);
    let shared: SurfaceRef = Arc::new(neighbour.clone());
    for own in Side::ALL {
        for other in Side::ALL {
            for reversed in [false, true] {
                let (curves, _) = beside(&neighbour, own, other, reversed, 0.0);
                let mut options = CoonsOptions {
                    estimate: Estimate::Adini,
                    ..cubic()
                };
                let side = other;
                let surface = shared.clone();
                options.cross[own as usize] = Cross::Neighbour { surface, side };
                let c = coons(&curves, &options).unwrap();
                let nurbs = c.to_nurbs().unwrap();
                assert!(apart(&c, |uv| nurbs.point(uv)) <= 2e-14);
                for k in 1..40 {
                    let t = k as f64 / 40.0;
                    let s = if reversed { 1.0 - t } else { t };
                    let (a, b) = (
                        c.jet(on(own, t), ABOVE, 1),
                        neighbour.jet(on(other, s), ABOVE, 1),
                    );
                    assert!(a.point().distance(b.point()) <= 4e-15);
                    let sine = a.normal().unwrap().cross(b.normal().unwrap()).length();
                    assert!(sine <= 1e-13, "{own} {other} {reversed} {t}: {sine:e}");
                    // It goes on, not back.
                    let out = |side: Side, j: &nappe::surface::SurfaceJet| {
                        let d = match side.across() {
                            Dir::U => j.partial(1, 0),
                            Dir::V => j.partial(0, 1),
                        };
                        if side.is_upper() { d } else { -d }
                    };
                    let edge = b.partial(
                        (other.along() == Dir::U) as usize,
                        (other.along() == Dir::V) as usize,
                    );
                    let flat = |d: DVec3| d - edge * (d.dot(edge) / edge.length_squared());
                    assert!(flat(out(own, &a)).dot(flat(out(other, &b))) < 0.0);
                }
            }
        }
    }
}

/// Boundary curves of a surface beside another, meeting its side `other` in the side `own`; `fold` turns the first of
/// the meeting curves back, and the second value is its corner.
fn beside(
    neighbour: &NurbsSurface,
    own: Side,
    other: Side,
    reversed: bool,
    fold: f64,
) -> ([CurveRef; 4], Corner) {
    let mut line = boundary(neighbour, other, 0)
        .to_nurbs()
        .unwrap()
        .control_points();
    if reversed {
        line.reverse();
    }
    let common: CurveRef = Arc::new(NurbsCurve::bezier(&line, None).unwrap());
    let frame = |t: f64| {
        let s = if reversed { 1.0 - t } else { t };
        let jet = neighbour.jet(on(other, s), ABOVE, 1);
        let (u, v) = (jet.partial(1, 0), jet.partial(0, 1));
        let (across, along) = if other.across() == Dir::U {
            (u, v)
        } else {
            (v, u)
        };
        (if other.is_upper() { across } else { -across }, along)
    };
    let leave = |t: f64, a: f64, b: f64| {
        let (n, l) = frame(t);
        let start = common.point(t);
        let inward = n * a + l * b;
        [
            start,
            start + inward,
            start + inward * 2.0 + DVec3::Z,
            start + inward * 3.0,
        ]
    };
    let (first, second) = (leave(0.0, 1.7 - fold, 0.3), leave(1.0, 0.6, -0.2));
    let far = [first[3], second[3]];
    let bezier = |mut p: Vec<DVec3>, turn: bool| -> CurveRef {
        if turn {
            p.reverse();
        }
        Arc::new(NurbsCurve::bezier(&p, None).unwrap())
    };
    let upper = own.is_upper();
    let first = bezier(first.to_vec(), upper);
    let second = bezier(second.to_vec(), upper);
    let opposite = bezier(far.to_vec(), false);
    let (low, high) = if upper {
        (opposite, common)
    } else {
        (common, opposite)
    };
    let curves = match own.along() {
        Dir::U => [low, high, first, second],
        Dir::V => [first, second, low, high],
    };
    let corner = match own {
        Side::South | Side::West => Corner::SouthWest,
        Side::North => Corner::NorthWest,
        Side::East => Corner::SouthEast,
    };
    (curves, corner)
}

#[test]
fn joins_that_cannot_be_are_refused() {
    let neighbour = patch(11, [3, 4], 1.0, DVec3::ZERO);
    let surface: SurfaceRef = Arc::new(neighbour.clone());
    for own in Side::ALL {
        let (curves, corner) = beside(&neighbour, own, Side::North, false, 5.0);
        let mut options = cubic();
        let side = Side::North;
        let surface = surface.clone();
        options.cross[own as usize] = Cross::Neighbour {
            surface: surface.clone(),
            side,
        };
        let e = coons(&curves, &options).unwrap_err();
        let CoonsError::NeighbourFolds { corner: at, .. } = &e else {
            panic!("{e}")
        };
        assert_eq!(*at, corner);
        let side = Side::East;
        options.cross[own as usize] = Cross::Neighbour { surface, side };
        let e = coons(&curves, &options).unwrap_err();
        assert!(matches!(e, CoonsError::NeighbourApart { .. }), "{e}");
    }
    // A boundary that leaves the tangent plane is a disagreement of tangents.
    let (mut curves, _) = beside(&neighbour, Side::South, Side::North, false, 0.0);
    let mut points = curves[2].to_nurbs().unwrap().control_points();
    points[1].z += 0.5;
    curves[2] = Arc::new(NurbsCurve::bezier(&points, None).unwrap());
    let mut options = cubic();
    options.cross[0] = Cross::Neighbour {
        surface,
        side: Side::North,
    };
    let e = coons(&curves, &options).unwrap_err();
    let CoonsError::Incompatible(report) = &e else {
        panic!("{e}")
    };
    assert_eq!(report.disagreements[0].datum, Datum::TangentV);
    assert_eq!(report.disagreements[0].corner, Corner::SouthWest);
}
