//! Quintic blending: second cross-derivatives on four sides, their compatibility, and G2 joins.

use super::*;
use nappe::measure::{Continuity, JumpOptions, Smoothness, continuity};
use nappe::surface::{Swapped, Torus, TorusOptions};

fn quintic() -> CoonsOptions {
    CoonsOptions {
        blend: Blending::quintic(),
        ..CoonsOptions::default()
    }
}

fn all_given(s: &NurbsSurface) -> CoonsOptions {
    CoonsOptions {
        cross: given(s),
        second: Side::ALL.map(|side| Some(boundary(s, side, 2))),
        ..quintic()
    }
}

/// `P1 + P2 - P1P2` is the identity on what is of degree 5 along u or along v, so on both of these.
#[test]
fn surfaces_of_degree_five_in_one_direction_are_reproduced() {
    for degree in [[5, 5], [3, 3], [5, 7], [8, 4]] {
        at_places(|scale, shift| {
            let source = patch(21, degree, scale, shift);
            let c = coons(&sides(&source), &all_given(&source)).unwrap();
            assert!(c.resolved().is_empty() && c.separable().is_some());
            let limit = 4e-14 * scale + 2e-14 * shift.length();
            let error = apart(&c, |uv| source.point(uv));
            assert!(error <= limit, "{degree:?} {scale}: {error:e}");
            let nurbs = c.to_nurbs().unwrap();
            assert_eq!(
                [Dir::U, Dir::V].map(|d| nurbs.basis(d).degree()),
                degree.map(|d| d.max(5))
            );
            let error = apart(&nurbs, |uv| source.point(uv));
            assert!(error <= limit, "nurbs {degree:?} {scale}: {error:e}");
        });
    }
}

/// What is given is met, even if the surface is none of a low degree.
#[test]
fn all_cross_derivatives_are_interpolated() {
    let source = patch(4, [7, 8], 1.0, DVec3::ZERO);
    let c = coons(&sides(&source), &all_given(&source)).unwrap();
    laws::surface(&c);
    assert!(apart(&c, |uv| source.point(uv)) > 1e-4);
    for side in Side::ALL {
        for (m, want) in [
            boundary(&source, side, 0),
            boundary(&source, side, 1),
            boundary(&source, side, 2),
        ]
        .iter()
        .enumerate()
        {
            let error = (0..=50)
                .map(|k| {
                    let t = k as f64 / 50.0;
                    let (i, j) = match side.along() {
                        Dir::U => (0, m),
                        Dir::V => (m, 0),
                    };
                    let got = c.jet(on(side, t), ABOVE, m).partial(i, j);
                    got.distance(want.point(t))
                })
                .fold(0.0, f64::max);
            let limit = [1e-14, 2e-13, 4e-12][m];
            assert!(error <= limit, "{side} {m}: {error:e}");
        }
    }
}

/// Without any derivatives the surface depends on its boundary alone, and moves with it.
#[test]
fn what_is_not_given_is_estimated_from_the_boundary() {
    let source = patch(6, [4, 6], 1.0, DVec3::ZERO);
    for estimate in [Estimate::Ferguson, Estimate::Adini] {
        let options = CoonsOptions {
            estimate,
            ..quintic()
        };
        let c = coons(&sides(&source), &options).unwrap();
        for side in Side::ALL {
            assert!(error_on(&c, side, 0, boundary(&source, side, 0).as_ref()) <= 1e-14);
        }
        // A plane stays one with Adini's twists: all estimates are then exact.
        let flat = patch(6, [1, 1], 1.0, DVec3::ZERO);
        let c = coons(&sides(&flat), &options).unwrap();
        let error = apart(&c, |uv| flat.point(uv));
        assert_eq!(error <= 1e-14, estimate == Estimate::Adini, "{error:e}");
    }
}

/// A change of the control point `index` of a boundary function of degree 5 changes its derivatives of that and higher
/// orders at the end: exactly these conditions are reported, with their distances.
#[test]
fn every_one_of_the_36_conditions_is_checked_and_named() {
    let source = patch(3, [5, 5], 1.0, DVec3::ZERO);
    let delta = DVec3::new(0.01, -0.02, 0.005);
    // |∂^r B_i(0)| for the degree 5.
    let by = [[1.0, 5.0, 20.0], [0.0, 5.0, 40.0], [0.0, 0.0, 20.0]];
    for side in Side::ALL {
        for m in 0..3 {
            for (index, end) in (0..3).flat_map(|i| [(i, 0), (i, 1)]) {
                let mut curves = sides(&source);
                let mut options = all_given(&source);
                let c = match m {
                    0 => boundary(&source, side, 0),
                    1 => boundary(&source, side, 1),
                    _ => boundary(&source, side, 2),
                };
                let mut points = c.to_nurbs().unwrap().control_points();
                points[if end == 0 { index } else { 5 - index }] += delta;
                let broken: CurveRef = Arc::new(NurbsCurve::bezier(&points, None).unwrap());
                let own = match m {
                    0 => {
                        curves[side as usize] = broken;
                        Source::Side(side)
                    }
                    1 => {
                        options.cross[side as usize] = Cross::Curve(broken);
                        Source::Cross(side)
                    }
                    _ => {
                        options.second[side as usize] = Some(broken);
                        Source::Second(side)
                    }
                };
                let e = coons(&curves, &options).unwrap_err();
                let CoonsError::Incompatible(report) = &e else {
                    panic!("{e}")
                };
                assert_eq!(report.disagreements.len(), 3 - index, "{e}");
                for d in &report.disagreements {
                    assert!(d.sources.contains(&own), "{e}");
                    let uv = d.corner.ends();
                    assert_eq!(uv[(side.along() == Dir::V) as usize], end);
                    let names = [
                        [Datum::Position, Datum::TangentU, Datum::SecondU],
                        [Datum::TangentV, Datum::Twist, Datum::TwistU],
                        [Datum::SecondV, Datum::TwistV, Datum::TwistUV],
                    ];
                    let r = (0..3)
                        .find(|&r| {
                            d.datum
                                == match side.along() {
                                    Dir::U => names[m][r],
                                    Dir::V => names[r][m],
                                }
                        })
                        .unwrap();
                    let want = by[index][r] * delta.length();
                    assert!((d.distance - want).abs() <= 1e-11, "{d} {want}");
                }
            }
        }
    }
}

/// The cross-derivatives of a surface with the second one of south changed inside.
fn with_other_second(scale: f64, twists: IncompatibleTwists) -> (NurbsSurface, CoonsOptions) {
    let source = patch(8, [5, 5], scale, DVec3::ZERO);
    let mut options = CoonsOptions {
        incompatible_twists: twists,
        ..all_given(&source)
    };
    let mut points = boundary(&source, Side::South, 2)
        .to_nurbs()
        .unwrap()
        .control_points();
    points[1] += DVec3::new(0.3, -0.2, 0.5) * scale;
    options.second[0] = Some(Arc::new(NurbsCurve::bezier(&points, None).unwrap()));
    (source, options)
}

#[test]
fn incompatible_mixed_derivatives_are_refused_or_averaged() {
    for scale in [1e-6, 1.0, 1e6] {
        let (source, options) = with_other_second(scale, IncompatibleTwists::Error);
        let e = coons(&sides(&source), &options).unwrap_err().to_string();
        for text in [
            "∂³r/∂u∂v²",
            "∂⁴r/∂u²∂v²",
            "second.south",
            "cross.west",
            "\"average\"",
        ] {
            assert!(e.contains(text), "{e}");
        }
        assert!(!e.contains("gregory"), "{e}");

        let (source, options) = with_other_second(scale, IncompatibleTwists::Average);
        let c = coons(&sides(&source), &options).unwrap();
        assert_eq!(c.resolved().len(), 2);
        let jet = c.jet([0.0; 2], ABOVE, 4);
        for d in c.resolved() {
            let mean = d.values[0].midpoint(d.values[1]);
            let got = match d.datum {
                Datum::TwistV => jet.partial(1, 2),
                Datum::TwistUV => jet.partial(2, 2),
                _ => panic!("{d}"),
            };
            assert!(got.distance(mean) <= 1e-11 * scale);
        }
        for side in Side::ALL {
            let want = boundary(&source, side, 0);
            assert!(error_on(&c, side, 0, want.as_ref()) <= 1e-14 * scale);
        }
    }
}

#[test]
fn what_the_blending_cannot_keep_is_refused() {
    let source = patch(8, [5, 5], 1.0, DVec3::ZERO);
    for blend in [Blending::linear(), Blending::cubic()] {
        let mut options = CoonsOptions {
            blend,
            ..CoonsOptions::default()
        };
        options.second[1] = Some(boundary(&source, Side::North, 2));
        let e = coons(&sides(&source), &options).unwrap_err();
        assert_eq!(e, CoonsError::SecondNotKept { side: Side::North });
    }
    let (source, options) = with_other_second(1.0, IncompatibleTwists::Gregory);
    let e = coons(&sides(&source), &options).unwrap_err();
    assert_eq!(e, CoonsError::GregoryQuintic);
    // A second derivative that misses those of the boundary is no twist: it is not averaged away.
    let mut options = CoonsOptions {
        incompatible_twists: IncompatibleTwists::Average,
        ..all_given(&source)
    };
    let wrong = [DVec3::X, DVec3::Y];
    options.second[0] = Some(Arc::new(NurbsCurve::bezier(&wrong, None).unwrap()));
    let e = coons(&sides(&source), &options).unwrap_err().to_string();
    assert!(
        e.contains("second derivatives of the boundary curves"),
        "{e}"
    );
}

/// The middle of 3 × 3 patches of a surface, from the sides of its neighbours, south, north, west, east, of which each is
/// turned in another way. Also the neighbours with the sides that meet it.
fn rebuilt(
    whole: &NurbsSurface,
    cuts: [[f64; 4]; 2],
    tol: f64,
) -> (Coons, [(SurfaceRef, Side); 4]) {
    let [u, v] = cuts.map(|c| [[c[0], c[1]], [c[1], c[2]], [c[2], c[3]]]);
    let part = |i: usize, j: usize| whole.part(u[i], v[j]).unwrap();
    let swapped: SurfaceRef = Arc::new(Swapped::new(Arc::new(part(2, 1))));
    let neighbours: [(SurfaceRef, Side); 4] = [
        (Arc::new(part(1, 0)), Side::North),
        (Arc::new(part(1, 2).reversed(Dir::U).unwrap()), Side::South),
        (Arc::new(part(0, 1).reversed(Dir::U).unwrap()), Side::West),
        (swapped, Side::South),
    ];
    let curves = neighbours
        .clone()
        .map(|(s, side)| -> CurveRef { Arc::new(nappe::curve::Isocurve::side(s, side)) });
    let [south, north, west, east] = curves;
    let north: CurveRef = Arc::new(nappe::curve::Trimmed::reversed(north));
    let cross = neighbours
        .clone()
        .map(|(surface, side)| Cross::Neighbour { surface, side });
    let options = CoonsOptions {
        cross,
        tol,
        ..quintic()
    };
    let middle = Coons::new(south, north, west, east, &options).unwrap();
    (middle, neighbours)
}

fn joint(s: &dyn Surface, own: Side, other: &(SurfaceRef, Side), scale: f64) -> Continuity {
    continuity(
        (s, own),
        (other.0.as_ref(), other.1),
        1e-9 * scale,
        &JumpOptions::default(),
    )
    .unwrap()
}

/// The normal curvatures across the joint, of both surfaces in the direction of this one's derivative across, from jets at
/// many places: the greatest difference of `n · r''` and of what the neighbour has for it, relative to `|r''|`.
fn bends_apart(
    s: &dyn Surface,
    own: Side,
    (other, side): &(SurfaceRef, Side),
    reversed: bool,
) -> f64 {
    let domains = other.domain();
    let partial = |j: &nappe::surface::SurfaceJet, side: Side, along: usize, across: usize| {
        match side.along() {
            Dir::U => j.partial(along, across),
            Dir::V => j.partial(across, along),
        }
    };
    (0..=60)
        .map(|k| {
            let t = k as f64 / 60.0;
            let place = on(*side, if reversed { 1.0 - t } else { t });
            let place = [0, 1].map(|d| domains[d].lo + (domains[d].hi - domains[d].lo) * place[d]);
            let inside = |x: [f64; 2], d: [Interval; 2]| {
                [0, 1].map(|k| {
                    if x[k] >= d[k].hi {
                        Limit::Below
                    } else {
                        Limit::Above
                    }
                })
            };
            let a = s.jet(on(own, t), inside(on(own, t), [Interval::UNIT; 2]), 2);
            let b = other.jet(place, inside(place, domains), 2);
            let n = b.normal().unwrap();
            let (first, second) = (partial(&a, own, 0, 1), partial(&a, own, 0, 2));
            let (x, y) = (partial(&b, *side, 1, 0), partial(&b, *side, 0, 1));
            let (xx, xy, yy) = (x.dot(x), x.dot(y), y.dot(y));
            let det = xx * yy - xy * xy;
            let p = (first.dot(x) * yy - first.dot(y) * xy) / det;
            let q = (first.dot(y) * xx - first.dot(x) * xy) / det;
            let want = partial(&b, *side, 2, 0) * (p * p)
                + partial(&b, *side, 1, 1) * (2.0 * p * q)
                + partial(&b, *side, 0, 2) * (q * q);
            (n.dot(second) - n.dot(want)).abs() / (second.length() + first.length())
        })
        .fold(0.0, f64::max)
}

/// What forms of order 4 prove with 512 parts. Found is nothing but rounding.
fn assert_g2(c: &Continuity, scale: f64, what: &str) {
    assert_eq!(
        c.proven(1e-10 * scale, 1e-6, 1e-2),
        Some(Smoothness::G2),
        "{what}: {c:?}"
    );
    assert!(
        c.angle.found <= 1e-10 && c.curvature.found <= 1e-8,
        "{what}: {c:?}"
    );
}

fn spline(scale: f64, shift: DVec3, degree: usize) -> NurbsSurface {
    let mut random = Random(77);
    let n = degree + 4;
    let points: Vec<DVec3> = (0..n * n)
        .map(|k| {
            let grid = DVec3::new((k / n) as f64, (k % n) as f64, 0.0);
            shift + (grid + vector(&mut random) * 0.5) * scale
        })
        .collect();
    let mut knots = vec![0.0; degree + 1];
    knots.extend([0.8, 2.1, 3.0]);
    knots.extend(vec![4.0; degree + 1]);
    NurbsSurface::new([degree; 2], [knots.clone(), knots], &points, None).unwrap()
}

#[test]
fn the_middle_of_nine_patches_joins_all_its_neighbours_with_equal_curvatures() {
    // The cuts are knots for the degree 5, and between them for the degree 3, whose middle has knots.
    for (degree, cuts) in [
        (5, [[0.0, 0.8, 2.1, 4.0]; 2]),
        (3, [[0.0, 0.5, 2.4, 4.0], [0.3, 1.1, 2.9, 3.3]]),
    ] {
        at_places(|scale, shift| {
            let whole = spline(scale, shift, degree);
            let far = 1.0 + shift.length() / scale;
            // Fourth derivatives of points that are rounded far from the origin differ by more than the default allows.
            let (middle, neighbours) = rebuilt(&whole, cuts, 1e-11 * far);
            for (own, other) in Side::ALL.into_iter().zip(&neighbours) {
                let bent = bends_apart(&middle, own, other, own == Side::North);
                assert!(bent <= 1e-12 * far, "{degree} {scale} {own}: {bent:e}");
                if degree == 5 || scale == 1.0 {
                    let c = joint(&middle, own, other, scale);
                    assert_g2(&c, scale, &format!("{degree} {scale} {shift} {own}"));
                }
            }
            if degree == 5 {
                let [u, v] = cuts;
                let at = |c: [f64; 4], t: f64| c[1] + (c[2] - c[1]) * t;
                let error = apart(&middle, |[x, y]| whole.point([at(u, x), at(v, y)]));
                assert!(error <= 1e-13 * (scale + shift.length()), "{error:e}");
            }
            let nurbs = middle.to_nurbs().unwrap();
            assert!(apart(&nurbs, |uv| middle.point(uv)) <= 1e-13 * (scale + shift.length()));
            // The other's terms are so long that a list keeps one bit less than the law asks for.
            if degree == 5 && scale == 1.0 {
                laws::surface(&middle);
            }
        });
    }
}

#[test]
fn a_patch_of_a_torus_is_rebuilt_from_its_neighbours() {
    let range = [[0.2, 1.6], [-0.3, 0.9]];
    let options = TorusOptions {
        range,
        ..TorusOptions::default()
    };
    let torus = Torus::new(3.0, 1.0, options).unwrap().to_nurbs().unwrap();
    let (middle, neighbours) = rebuilt(&torus, [[0.0, 0.3, 0.7, 1.0], [0.0, 0.4, 0.6, 1.0]], 0.0);
    for (own, other) in Side::ALL.into_iter().zip(&neighbours) {
        assert_g2(&joint(&middle, own, other, 1.0), 1.0, own.name());
        let bent = bends_apart(&middle, own, other, own == Side::North);
        assert!(bent <= 1e-12, "{own}: {bent:e}");
    }
    // It is near the torus between its sides, too, and not equal to it.
    let at = |x: f64, y: f64| torus.point([0.3 + 0.4 * x, 0.4 + 0.2 * y]);
    let error = apart(&middle, |[x, y]| at(x, y));
    assert!(error > 1e-14 && error < 1e-7, "{error:e}");
    let nurbs = middle.to_nurbs().unwrap();
    assert!(apart(&nurbs, |uv| middle.point(uv)) <= 1e-13);
    laws::surface(&middle);
}

/// A quintic curve that leaves the side `other` at the parameter s of its own, with the second derivatives of
/// `S(s + b v + d v²/2, a v + c v²/2)`, outwards.
fn leaving(s: &NurbsSurface, other: Side, t: f64, [a, b, c, d]: [f64; 4]) -> [DVec3; 6] {
    let jet = s.jet(on(other, t), ABOVE, 2);
    let (i, j) = if other.along() == Dir::U {
        (1, 0)
    } else {
        (0, 1)
    };
    let sign = if other.is_upper() { 1.0 } else { -1.0 };
    let (a, c) = (a * sign, c * sign);
    let (along, across) = (jet.partial(i, j), jet.partial(j, i));
    let first = across * a + along * b;
    let second = jet.partial(2 * j, 2 * i) * (a * a)
        + jet.partial(1, 1) * (2.0 * a * b)
        + jet.partial(2 * i, 2 * j) * (b * b)
        + across * c
        + along * d;
    let p = jet.point();
    let p1 = p + first / 5.0;
    let p2 = 2.0 * p1 - p + second / 20.0;
    [p, p1, p2, p2 + first * 0.3, p2 + first * 0.6, p2 + first]
}

/// For every pair of sides and both directions: a boundary that leaves the common side with directions, lengths and second
/// derivatives of its own is continued with equal curvatures.
#[test]
fn slanted_boundaries_join_with_equal_curvatures() {
    let neighbour = patch(11, [3, 4], 1.0, DVec3::ZERO);
    let shared: SurfaceRef = Arc::new(neighbour.clone());
    for (own, other, reversed) in Side::ALL
        .into_iter()
        .flat_map(|a| Side::ALL.map(|b| (a, b)))
        .flat_map(|(a, b)| [(a, b, false), (a, b, true)])
    {
        let bezier = |mut p: Vec<DVec3>, turn: bool| -> CurveRef {
            if turn {
                p.reverse();
            }
            Arc::new(NurbsCurve::bezier(&p, None).unwrap())
        };
        let line = boundary(&neighbour, other, 0).to_nurbs().unwrap();
        let common = bezier(line.control_points(), reversed);
        let ends = if reversed { [1.0, 0.0] } else { [0.0, 1.0] };
        let first = leaving(&neighbour, other, ends[0], [0.9, 0.3, 0.4, -0.6]);
        let last = leaving(&neighbour, other, ends[1], [0.6, -0.2, -0.5, 0.8]);
        let opposite = bezier(vec![first[5], last[5]], false);
        let upper = own.is_upper();
        let (first, last) = (bezier(first.to_vec(), upper), bezier(last.to_vec(), upper));
        let (low, high) = if upper {
            (opposite, common)
        } else {
            (common, opposite)
        };
        let curves = match own.along() {
            Dir::U => [low, high, first, last],
            Dir::V => [first, last, low, high],
        };
        let mut options = CoonsOptions {
            estimate: Estimate::Adini,
            ..quintic()
        };
        options.cross[own as usize] = Cross::Neighbour {
            surface: shared.clone(),
            side: other,
        };
        let c = coons(&curves, &options).unwrap();
        let neighbours = (shared.clone(), other);
        let what = format!("{own} {other} {reversed}");
        assert_g2(&joint(&c, own, &neighbours, 1.0), 1.0, &what);
        let bent = bends_apart(&c, own, &neighbours, reversed);
        assert!(bent <= 1e-12, "{what}: {bent:e}");
        let nurbs = c.to_nurbs().unwrap();
        assert!(apart(&c, |uv| nurbs.point(uv)) <= 1e-12);
        // With cubic blending the curvatures differ: the measure can tell.
        options.blend = Blending::cubic();
        let c = coons(&curves, &options).unwrap();
        assert!(bends_apart(&c, own, &neighbours, reversed) > 1e-3, "{what}");
    }
}

/// Where the neighbour's derivatives along the side jump, a slanted boundary would tear the surface; a straight one does not.
#[test]
fn a_torn_continuation_is_refused() {
    let mut random = Random(3);
    let points: Vec<DVec3> = (0..16)
        .map(|k| DVec3::new((k / 4) as f64, (k % 4) as f64, 0.3 * random.unit()))
        .collect();
    let knots = [
        vec![0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0],
        vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0],
    ];
    let neighbour = NurbsSurface::new([2, 3], knots, &points, None).unwrap();
    let shared: SurfaceRef = Arc::new(neighbour.clone());
    for (b, torn) in [(0.0, false), (0.2, true)] {
        let leave = |t: f64| {
            let p = leaving(&neighbour, Side::North, t, [1.0, b, 0.0, 0.0]);
            Arc::new(NurbsCurve::bezier(&p, None).unwrap())
        };
        let (west, east) = (leave(0.0), leave(1.0));
        let far = [west.point(1.0), east.point(1.0)];
        let south: CurveRef = Arc::new(nappe::curve::Isocurve::side(shared.clone(), Side::North));
        let mut options = quintic();
        let (surface, side) = (shared.clone(), Side::North);
        options.cross[0] = Cross::Neighbour { surface, side };
        let north: CurveRef = Arc::new(NurbsCurve::bezier(&far, None).unwrap());
        let made = Coons::new(south, north, west, east, &options);
        match made {
            Ok(c) => {
                assert!(!torn);
                let other = (shared.clone(), Side::North);
                assert!(bends_apart(&c, Side::South, &other, false) <= 1e-12);
                assert_g2(&joint(&c, Side::South, &other, 1.0), 1.0, "straight");
            }
            Err(e) => {
                assert!(torn, "{e}");
                assert!(
                    matches!(e, CoonsError::NeighbourJumps { at: 0.5, .. }),
                    "{e}"
                );
            }
        }
    }
}
