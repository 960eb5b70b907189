//! Blends: the laws, closed forms (planes, the missing piece of a polynomial surface), the measured continuity with all
//! kinds of neighbours, exact forms, bad input.

#![allow(clippy::unwrap_used)]

use nappe::basis::BSplineBasis;
use nappe::curve::{Curve, CurveRef, Line};
use nappe::exact::NurbsSurface;
use nappe::laws::{self, Random};
use nappe::measure::{Continuity, JumpOptions, Smoothness, continuity};
use nappe::mesh::Certainty;
use nappe::surface::{
    Blend, BlendError, BlendOptions, Dir, Elementary, Quadric, QuadricOptions, QuadricShape,
    Revolution, RevolutionOptions, Side, Surface, SurfaceRef, bilinear, ruled,
};
use nappe::{Box3, Break, DAffine3, DVec3, Frame, Interval, Limit, UNIT_BREAKS};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

fn v(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

fn options(continuity: [usize; 2]) -> BlendOptions {
    BlendOptions {
        continuity,
        ..BlendOptions::default()
    }
}

fn blend(first: (&SurfaceRef, Side), second: (&SurfaceRef, Side), o: &BlendOptions) -> Blend {
    Blend::new((first.0.clone(), first.1), (second.0.clone(), second.1), o).unwrap()
}

/// A random spline surface over [0, 4] × [0, 3] with breaks in both directions, over a box of about 3 × 2 × 1 that begins
/// at a place.
fn spline(seed: u64, at: DVec3, scale: f64, rational: bool) -> SurfaceRef {
    let mut random = Random(seed);
    let points: Vec<DVec3> = (0..30)
        .map(|k| {
            let [x, y] = [k / 5, k % 5].map(|i| i as f64);
            let off = v(random.unit(), random.unit(), random.unit()) * 0.3;
            (at + v(x * 0.6, y * 0.5, 0.0) + off) * scale
        })
        .collect();
    let weights: Vec<f64> = (0..30).map(|_| 0.6 + random.unit()).collect();
    let knots = |p: usize, n: usize, end: f64| -> Vec<f64> {
        let knots = BSplineBasis::clamped_uniform(p, n);
        let last = knots[n];
        knots.into_iter().map(|k| k / last * end).collect()
    };
    let knots = [knots(3, 6, 4.0), knots(3, 5, 3.0)];
    Arc::new(NurbsSurface::new([3, 3], knots, &points, rational.then_some(&weights)).unwrap())
}

fn measured(a: (&dyn Surface, Side), b: (&dyn Surface, Side), size: f64) -> Continuity {
    continuity(a, b, 1e-6 * size, &JumpOptions::default()).unwrap()
}

/// What is proven of both sides of a blend: gap (of the size), angle, relative curvature.
fn joints(b: &Blend, ends: [(&SurfaceRef, Side); 2], size: f64) -> [Continuity; 2] {
    [
        measured((ends[0].0.as_ref(), ends[0].1), (b, Side::South), size),
        measured((ends[1].0.as_ref(), ends[1].1), (b, Side::North), size),
    ]
}

#[test]
fn laws_hold() {
    let a = spline(1, DVec3::ZERO, 1.0, false);
    let b = spline(2, v(0.3, 4.0, 0.7), 1.0, true);
    for continuity in [[2, 2], [1, 1], [0, 0], [2, 1], [0, 2]] {
        for (first, second) in [(Side::North, Side::South), (Side::East, Side::North)] {
            for reverse in [false, true] {
                let o = BlendOptions {
                    reverse: Some(reverse),
                    bulge: [0.8, 1.7],
                    ..options(continuity)
                };
                laws::surface(&blend((&a, first), (&b, second), &o));
            }
        }
    }
}

#[test]
fn laws_hold_between_surfaces_without_a_nurbs_form() {
    let line: CurveRef = Arc::new(Line::new(v(2.0, 0.0, 0.0), v(1.0, 0.0, 3.0)).unwrap());
    let turned: SurfaceRef =
        Arc::new(Revolution::new(line, Frame::WORLD, RevolutionOptions::default()).unwrap());
    let options = QuadricOptions {
        range: [Some([-2.0, 2.0]), Some([-0.4, 0.6])],
        ..QuadricOptions::default()
    };
    let ball: SurfaceRef = Arc::new(Quadric::new(QuadricShape::Sphere, &[1.0], options).unwrap());
    for second in Side::ALL {
        let b = blend(
            (&turned, Side::North),
            (&ball, second),
            &BlendOptions::default(),
        );
        assert!(b.to_nurbs().is_none());
        laws::surface(&b);
    }
}

/// Two rectangles of one plane: the blend is the rectangle between them, at even parameters.
#[test]
fn between_coplanar_planes_it_is_their_plane() {
    for (scale, shift) in [
        (1.0, DVec3::ZERO),
        (1e-6, DVec3::ZERO),
        (1e6, v(1e9, -1e9, 0.0)),
    ] {
        let at = |x: f64, y: f64| shift + v(x, y, 0.5 * y) * scale;
        let plane = |x: [f64; 2], y: [f64; 2]| -> SurfaceRef {
            let corner = |i: usize, j: usize| at(x[i], y[j]);
            let c = [[corner(0, 0), corner(0, 1)], [corner(1, 0), corner(1, 1)]];
            Arc::new(bilinear(c).unwrap())
        };
        let (a, b) = (plane([0.0, 3.0], [0.0, 1.0]), plane([0.0, 3.0], [3.0, 8.0]));
        for continuity in [[2, 2], [1, 2], [0, 0], [1, 1]] {
            let s = blend((&a, Side::North), (&b, Side::South), &options(continuity));
            let rounding = 1e-15 * (scale + shift.abs().max_element());
            for k in 0..=100 {
                let (x, y) = ((k % 10) as f64 / 9.0, (k / 10) as f64 / 10.0);
                let p = s.point([x.min(1.0), y]);
                let expected = at(3.0 * x.min(1.0), 1.0 + 2.0 * y);
                assert!(p.distance(expected) <= 8.0 * rounding, "{p} {expected}");
            }
            let Some(Elementary::Plane { normal, .. }) = s.elementary() else {
                panic!("not a plane")
            };
            assert!(normal.cross(v(0.0, -0.5, 1.0).normalize()).length() <= 1e-12);
        }
    }
}

/// A random polynomial surface of degree 3 × q on the unit square.
fn polynomial(seed: u64, q: usize) -> NurbsSurface {
    let mut random = Random(seed);
    let points: Vec<DVec3> = (0..4 * (q + 1))
        .map(|k| {
            let [x, y] = [k / (q + 1), k % (q + 1)].map(|i| i as f64);
            v(x, y * 6.0 / q as f64, 0.0) + v(random.unit(), random.unit(), random.unit())
        })
        .collect();
    NurbsSurface::bezier(4, &points, None).unwrap()
}

/// The same surface with another side where v = 0 was: (the surface, where south and where north have come to).
fn turns(s: &NurbsSurface) -> [(SurfaceRef, [Side; 2]); 4] {
    [
        (Arc::new(s.clone()), [Side::South, Side::North]),
        (Arc::new(s.swapped()), [Side::West, Side::East]),
        (
            Arc::new(s.reversed(Dir::V).unwrap().reversed(Dir::U).unwrap()),
            [Side::North, Side::South],
        ),
        (
            Arc::new(s.swapped().reversed(Dir::U).unwrap()),
            [Side::East, Side::West],
        ),
    ]
}

/// Two pieces of one polynomial surface: the blend that follows each for the length of the gap is the missing piece, as
/// long as the degree across is no more than the number of derivatives less one.
#[test]
fn it_is_the_missing_piece_of_a_polynomial_surface() {
    let cases: [([usize; 2], usize); 6] = [
        ([2, 2], 5),
        ([2, 2], 3),
        ([2, 1], 4),
        ([1, 2], 4),
        ([1, 1], 3),
        ([0, 0], 1),
    ];
    // The gap is from 0.2 to 0.5: 1.5 times the first piece, 0.6 times the second.
    let (cut, factors) = ([0.2, 0.5], [1.5, 0.6]);
    for (seed, (continuity, q)) in cases.into_iter().enumerate() {
        let whole = polynomial(seed as u64, q);
        let part = |from: f64, to: f64| whole.part([0.0, 1.0], [from, to]).unwrap();
        for (a, [_, last]) in turns(&part(0.0, cut[0])) {
            for (b, [first, _]) in turns(&part(cut[1], 1.0)) {
                let free = blend((&a, last), (&b, first), &options(continuity));
                let found = free.factors();
                let o = BlendOptions {
                    as_parametrised: true,
                    bulge: [0, 1].map(|k| {
                        if continuity[k] == 0 {
                            1.0
                        } else {
                            factors[k] / found[k]
                        }
                    }),
                    ..options(continuity)
                };
                let s = blend((&a, last), (&b, first), &o);
                let backwards = matches!(last, Side::South);
                for k in 0..=120 {
                    let [x, y] = [(k % 11) as f64 / 10.0, (k / 11) as f64 / 10.0];
                    let u = if backwards { 1.0 - x } else { x };
                    let expected = whole.point([u, cut[0] + (cut[1] - cut[0]) * y]);
                    let p = s.point([x, y]);
                    assert!(
                        p.distance(expected) <= 2e-13,
                        "{continuity:?} {last} {first} at ({x}, {y}): {:e}",
                        p.distance(expected)
                    );
                }
                let nurbs = s.to_nurbs().unwrap();
                assert_eq!(nurbs.basis_u().degree(), 3);
                assert_eq!(nurbs.basis_v().degree(), continuity[0] + continuity[1] + 1);
            }
        }
    }
}

/// Proven over the whole sides: what is left is rounding and the remainders of rational functions over a 512th of a side;
/// and at samples the derivatives themselves, to rounding.
#[test]
fn tangent_planes_and_curvatures_agree() {
    for (scale, far) in [(1.0, 0.0), (1e-6, 0.0), (1e6, 0.0), (1.0, 1e4)] {
        let shift = v(far, -far, far);
        for rational in [false, true] {
            let mut worst = [0.0f64; 3];
            for seed in 0..3 {
                let a = spline(seed, shift, scale, rational);
                let b = spline(
                    seed + 50,
                    shift + v(0.5, 4.5, 1.0),
                    scale,
                    rational && seed != 1,
                );
                let sides = [
                    [Side::North, Side::South],
                    [Side::East, Side::South],
                    [Side::North, Side::West],
                ][seed as usize];
                let ends = [(&a, sides[0]), (&b, sides[1])];
                for reverse in [false, true] {
                    let o = BlendOptions {
                        reverse: Some(reverse),
                        bulge: [1.0, 0.7],
                        ..BlendOptions::default()
                    };
                    let s = blend(ends[0], ends[1], &o);
                    derivatives_agree(&s, ends, scale, 1.0 + far);
                    for j in joints(&s, ends, scale) {
                        for (w, j) in worst.iter_mut().zip([j.gap, j.angle, j.curvature]) {
                            let Certainty::Bounded(e) = j.greatest else {
                                panic!("{j:?}")
                            };
                            *w = w.max(e);
                        }
                    }
                }
            }
            worst[0] /= scale;
            println!("scale {scale:e}, far {far:e}, rational {rational}: {worst:?}");
            let limits = if rational {
                [1e-10, 1e-8, 1e-5]
            } else {
                [1e-12, 1e-9, 1e-6]
            };
            for (w, limit) in worst.iter().zip(limits) {
                assert!(*w <= limit * (1.0 + far), "{worst:?} {limits:?}");
            }
        }
    }
}

/// `r_v = a n` and `r_vv = a² m + c n` with one c all along at the first side, with the signs that follow at the second.
fn derivatives_agree(s: &Blend, ends: [(&SurfaceRef, Side); 2], scale: f64, rounding: f64) {
    for (end, (surface, side)) in ends.into_iter().enumerate() {
        let mut evened: Option<f64> = None;
        for k in 0..=50 {
            let t = k as f64 / 50.0;
            let limit = |x: f64| if x < 1.0 { Limit::Above } else { Limit::Below };
            let own = s.jet([t, end as f64], [limit(t), limit(end as f64)], 2);
            let turned = end == 1 && s.is_reversed();
            let along = if turned { 1.0 - t } else { t };
            let [u, v] = surface.domain();
            let (along_range, across_range) = if side.along() == Dir::U {
                (u, v)
            } else {
                (v, u)
            };
            let x = along_range.lo + along_range.width() * along;
            let (y, inside) = if side.is_upper() {
                (across_range.hi, Limit::Below)
            } else {
                (across_range.lo, Limit::Above)
            };
            // Beside a break of the second derivative its sides may not be compared.
            if surface
                .breaks(side.along())
                .iter()
                .any(|b| (b.at - x).abs() < 1e-9)
            {
                continue;
            }
            let d = |m: usize| {
                if side.along() == Dir::U {
                    surface.jet([x, y], [Limit::Above, inside], 2).partial(0, m)
                } else {
                    surface.jet([y, x], [inside, Limit::Above], 2).partial(m, 0)
                }
            };
            let out = if side.is_upper() { 1.0 } else { -1.0 };
            let a =
                s.factors()[end] * across_range.width() * out * if end == 0 { 1.0 } else { -1.0 };
            let size = 1e-13 * scale * rounding;
            assert!(own.point().distance(d(0)) <= size);
            assert!(own.partial(0, 1).distance(d(1) * a) <= 10.0 * size);
            let more = own.partial(0, 2) - d(2) * a * a;
            let c = *evened.get_or_insert(more.dot(d(1)) / d(1).length_squared());
            assert!(more.distance(d(1) * c) <= 1000.0 * size);
        }
    }
}

/// A flat patch whose parameter slows down towards the side: the blend goes on evenly in the plane, and is G2.
#[test]
fn uneven_parameters_do_not_fold_it() {
    let points: Vec<DVec3> = (0..4)
        .flat_map(|i| [0.0, 0.5, 0.95, 1.0].map(|y| v(i as f64, y, 0.0)))
        .collect();
    let slow: SurfaceRef = Arc::new(NurbsSurface::bezier(4, &points, None).unwrap());
    let corner = |x: f64, y: f64| v(3.0 * x, 2.0 + y, 0.0);
    let corners = [0.0, 1.0].map(|x| [0.0, 1.0].map(|y| corner(x, y)));
    let even: SurfaceRef = Arc::new(bilinear(corners).unwrap());
    let ends = [(&slow, Side::North), (&even, Side::South)];
    let s = blend(ends[0], ends[1], &BlendOptions::default());
    for k in 0..=100 {
        let y = k as f64 / 100.0;
        assert!(s.point([0.3, y]).distance(v(0.9, 1.0 + y, 0.0)) <= 1e-13);
    }
    // As it is parametrised it folds.
    let o = BlendOptions {
        as_parametrised: true,
        ..BlendOptions::default()
    };
    assert!(blend(ends[0], ends[1], &o).point([0.3, 0.4]).y < 0.0);
    // A bent one stays G2.
    let bent = points.iter().map(|p| v(p.x, p.y, p.y * p.y + 0.2 * p.x));
    let bent: Vec<DVec3> = bent.collect();
    let bent: SurfaceRef = Arc::new(NurbsSurface::bezier(4, &bent, None).unwrap());
    let ends = [(&bent, Side::North), (&even, Side::South)];
    for j in joints(
        &blend(ends[0], ends[1], &BlendOptions::default()),
        ends,
        1.0,
    ) {
        assert_eq!(j.proven(1e-10, 1e-7, 1e-5), Some(Smoothness::G2));
    }
}

/// A surface that counts how often it is evaluated.
#[derive(Debug)]
struct Counted(SurfaceRef, AtomicUsize);

impl Surface for Counted {
    fn breaks(&self, dir: Dir) -> &[Break] {
        self.0.breaks(dir)
    }

    fn jet_into(&self, uv: [f64; 2], limit: [Limit; 2], order: usize, out: &mut [DVec3]) {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.jet_into(uv, limit, order, out);
    }

    fn enclose_piece(&self, uv: [Interval; 2], limit: [Limit; 2], order: usize, out: &mut [Box3]) {
        self.1.fetch_add(1, Ordering::Relaxed);
        self.0.enclose_piece(uv, limit, order, out);
    }
}

/// A blend of a blend of a blend evaluates the surface at its end once.
#[test]
fn blends_of_blends_cost_no_power() {
    let counted = Arc::new(Counted(
        spline(30, DVec3::ZERO, 1.0, false),
        AtomicUsize::new(0),
    ));
    let mut last: SurfaceRef = counted.clone();
    for k in 0..3 {
        let next = spline(31 + k, v(4.0 * (k + 1) as f64, 4.0, 0.3), 1.0, false);
        let s = blend(
            (&last, Side::East),
            (&next, Side::West),
            &BlendOptions::default(),
        );
        // Its west and east lie beside the first surface.
        last = Arc::new(s);
    }
    counted.1.store(0, Ordering::Relaxed);
    last.jet([0.3, 0.6], [Limit::Above; 2], 2);
    assert_eq!(counted.1.load(Ordering::Relaxed), 1);
    last.enclose_piece(
        [Interval::new(0.3, 0.31), Interval::new(0.6, 0.61)],
        [Limit::Above; 2],
        0,
        &mut [Box3::ENTIRE],
    );
    assert_eq!(counted.1.load(Ordering::Relaxed), 2);
}

/// 1 - 0.97 is not 0.03 to the last bit: one break all the same.
#[test]
fn a_break_of_both_sides_is_one() {
    let strip = |knot: f64, y: f64| -> SurfaceRef {
        let knots = [vec![0.0, 0.0, knot, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
        let points: Vec<DVec3> = [0.0, knot, 1.0]
            .iter()
            .flat_map(|&x| [v(x, y, 0.0), v(x, y + 1.0, 0.0)])
            .collect();
        Arc::new(NurbsSurface::new([1, 1], knots, &points, None).unwrap())
    };
    let o = BlendOptions {
        reverse: Some(true),
        ..BlendOptions::default()
    };
    let (a, b) = (strip(0.03, 0.0), strip(0.97, 3.0));
    let s = blend((&a, Side::North), (&b, Side::South), &o);
    assert_eq!(s.breaks(Dir::U).len(), 3, "{:?}", s.breaks(Dir::U));
    // Between breaks of one surface there is a piece, however short.
    let thin = strip(1e-17, 0.0);
    let o = BlendOptions {
        continuity: [0, 2],
        ..o
    };
    let s = blend((&thin, Side::North), (&b, Side::South), &o);
    assert_eq!(s.breaks(Dir::U).len(), 4, "{:?}", s.breaks(Dir::U));
}

/// What is not asked for is not there: with G1 the curvatures differ, with G0 the tangent planes.
#[test]
fn less_continuity_is_less() {
    let a = spline(3, DVec3::ZERO, 1.0, true);
    let b = spline(4, v(0.5, 4.5, 1.0), 1.0, false);
    let ends = [(&a, Side::North), (&b, Side::South)];
    for (continuity, expected) in [
        ([2, 1], [Smoothness::G2, Smoothness::G1]),
        ([1, 0], [Smoothness::G1, Smoothness::G0]),
        ([0, 2], [Smoothness::G0, Smoothness::G2]),
    ] {
        let s = blend(ends[0], ends[1], &options(continuity));
        for (j, expected) in joints(&s, ends, 1.0).iter().zip(expected) {
            assert_eq!(j.proven(1e-10, 1e-7, 1e-5), Some(expected));
            match expected {
                Smoothness::G0 => assert!(j.angle.found > 0.1),
                Smoothness::G1 => assert!(j.curvature.found > 0.1),
                Smoothness::G2 => {}
            }
        }
    }
}

/// With points alone it is the ruled surface.
#[test]
fn with_points_alone_it_is_ruled() {
    let a = spline(7, DVec3::ZERO, 1.0, true);
    let b = spline(8, v(0.5, 4.5, 1.0), 1.0, false);
    let s = blend((&a, Side::North), (&b, Side::South), &options([0, 0]));
    let side = |s: &SurfaceRef, side: Side| -> CurveRef {
        Arc::new(nappe::curve::Isocurve::side(s.clone(), side))
    };
    let lines = ruled(side(&a, Side::North), side(&b, Side::South), Dir::U).unwrap();
    for k in 0..100 {
        let uv = [(k % 10) as f64 / 9.0, (k / 10) as f64 / 9.0].map(|x| x.min(1.0));
        assert!(s.point(uv).distance(lines.point(uv)) <= 4e-15);
    }
}

/// The direction of the second side is found, and the normals are those of the first surface.
#[test]
fn direction_and_orientation() {
    let a = spline(9, DVec3::ZERO, 1.0, false);
    let grid = spline(10, v(0.0, 4.0, 0.0), 1.0, false).to_nurbs().unwrap();
    for (b, [first, _]) in turns(&grid) {
        let s = blend((&a, Side::North), (&b, first), &BlendOptions::default());
        // Both directions are turned there; of the swapped ones it is the one across alone.
        assert_eq!(s.is_reversed(), first == Side::North);
        let j = measured((a.as_ref(), Side::North), (&s, Side::South), 1.0);
        assert!(j.same_orientation);
        assert!(s.normal_z([0.5, 0.5]) > 0.0);
    }
    for (side, same) in [
        (Side::North, true),
        (Side::West, true),
        (Side::South, false),
        (Side::East, false),
    ] {
        let b = spline(11, v(0.0, 0.0, 9.0), 1.0, false);
        let s = blend((&a, side), (&b, Side::North), &BlendOptions::default());
        let j = measured((a.as_ref(), side), (&s, Side::South), 1.0);
        assert_eq!(j.same_orientation, same, "{side}");
    }
}

trait NormalZ {
    fn normal_z(&self, uv: [f64; 2]) -> f64;
}

impl NormalZ for Blend {
    fn normal_z(&self, uv: [f64; 2]) -> f64 {
        let limit = [Limit::Above; 2];
        self.jet(uv, limit, 1).normal().unwrap().z
    }
}

/// A rotated, moved pair has the rotated, moved blend.
#[test]
fn it_moves_with_its_surfaces() {
    let map = DAffine3::from_translation(v(5.0, -3.0, 2.0))
        * DAffine3::from_axis_angle(v(1.0, 2.0, -1.0).normalize(), 0.8);
    let [a, b] = [
        spline(12, DVec3::ZERO, 1.0, true),
        spline(13, v(0.0, 4.0, 1.0), 1.0, true),
    ];
    let moved =
        |s: &SurfaceRef| -> SurfaceRef { Arc::new(s.to_nurbs().unwrap().transformed(&map)) };
    let o = BlendOptions::default();
    let s = blend((&a, Side::North), (&b, Side::South), &o);
    let t = blend((&moved(&a), Side::North), (&moved(&b), Side::South), &o);
    for k in 0..100 {
        let uv = [(k % 10) as f64 / 10.0, (k / 10) as f64 / 10.0];
        let image = map.transform_point3(s.point(uv));
        assert!(image.distance(t.point(uv)) <= 2e-14);
    }
}

/// The exact form of a blend of rational surfaces of degree 3 has degree 3·(3 + 3), not the 6·(3 + 3) of all powers of the
/// denominators multiplied.
#[test]
fn the_exact_form_has_a_low_degree() {
    let a = spline(14, DVec3::ZERO, 1.0, true);
    let b = spline(15, v(0.0, 4.0, 1.0), 1.0, true);
    let degree = |continuity: usize, b: &SurfaceRef| {
        let s = blend(
            (&a, Side::North),
            (b, Side::South),
            &options([continuity; 2]),
        );
        let nurbs = s.to_nurbs().unwrap();
        [nurbs.basis_u().degree(), nurbs.basis_v().degree()]
    };
    assert_eq!(degree(2, &b), [18, 5]);
    assert_eq!(degree(1, &b), [12, 3]);
    assert_eq!(degree(0, &b), [6, 1]);
    assert_eq!(
        degree(2, &spline(15, v(0.0, 4.0, 1.0), 1.0, false)),
        [12, 5]
    );
}

/// `(u, √u, 1 - v)`, with an infinite derivative along u at u = 0.
#[derive(Debug)]
struct Steep;

impl Surface for Steep {
    fn breaks(&self, _: Dir) -> &[Break] {
        &UNIT_BREAKS
    }

    fn jet_into(&self, [x, y]: [f64; 2], _: [Limit; 2], order: usize, out: &mut [DVec3]) {
        out.fill(DVec3::ZERO);
        out[0] = v(x, x.sqrt(), 1.0 - y);
        if order > 0 {
            out[1] = v(1.0, 0.5 / x.sqrt(), 0.0);
            out[2] = v(0.0, 0.0, -1.0);
        }
    }

    fn enclose_piece(&self, _: [Interval; 2], _: [Limit; 2], _: usize, out: &mut [Box3]) {
        out.fill(Box3::ENTIRE);
    }
}

#[test]
fn bad_data_is_refused() {
    let a = spline(20, DVec3::ZERO, 1.0, false);
    let b = spline(21, v(0.0, 4.0, 1.0), 1.0, false);
    let err = |first: (&SurfaceRef, Side), second: (&SurfaceRef, Side), o: &BlendOptions| {
        Blend::new((first.0.clone(), first.1), (second.0.clone(), second.1), o).unwrap_err()
    };
    let (south, north) = ((&b, Side::South), (&a, Side::North));
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let o = BlendOptions {
            bulge: [1.0, value],
            ..BlendOptions::default()
        };
        assert!(matches!(
            err(north, south, &o),
            BlendError::Bulge { end: 1, .. }
        ));
    }
    // Numbers themselves, but not their squares.
    for value in [1e160, 1e-170] {
        let o = BlendOptions {
            bulge: [value, 1.0],
            ..BlendOptions::default()
        };
        let e = err(north, south, &o);
        assert!(matches!(e, BlendError::Range { end: 0, .. }), "{e}");
    }
    assert_eq!(
        err(north, south, &options([3, 2])),
        BlendError::Continuity { end: 0, value: 3 }
    );
    assert!(matches!(
        err(north, north, &BlendOptions::default()),
        BlendError::Same { .. }
    ));
    // A sphere's pole, and a meridian, across which the derivative vanishes at the poles.
    let sphere = QuadricOptions::default();
    let ball: SurfaceRef = Arc::new(Quadric::new(QuadricShape::Sphere, &[1.0], sphere).unwrap());
    let pole = Side::ALL
        .into_iter()
        .find(|s| {
            let c = nappe::curve::Isocurve::side(ball.clone(), *s);
            c.point(c.domain().mid()).distance(c.ends()[0]) < 1e-9
        })
        .unwrap();
    assert!(matches!(
        err((&ball, pole), south, &BlendOptions::default()),
        BlendError::Pole { end: 0, .. }
    ));
    let meridian = if pole.along() == Dir::U {
        Side::West
    } else {
        Side::South
    };
    let e = err(north, (&ball, meridian), &BlendOptions::default());
    assert!(matches!(e, BlendError::NoPlane { end: 1, .. }), "{e}");
    // Where only points are met, a side of infinite slope will do.
    let steep: SurfaceRef = Arc::new(Steep);
    let s = blend((&steep, Side::North), south, &options([0, 2]));
    assert!(s.point([0.25, 0.0]).distance(v(0.25, 0.5, 0.0)) <= 1e-15);
    let e = err((&steep, Side::North), south, &options([1, 2]));
    assert!(matches!(e, BlendError::NotFinite { end: 0, .. }), "{e}");
    // Points are no obstacle: straight lines to a pole.
    laws::surface(&blend((&ball, pole), south, &options([0, 2])));
    // A net whose first two rows are one line of points: no derivative across.
    let row = |y: f64| (0..3).map(move |i| v(i as f64, y, 0.0));
    let points: Vec<DVec3> = row(0.0).chain(row(0.0)).chain(row(1.0)).collect();
    let flat: SurfaceRef = Arc::new(NurbsSurface::bezier(3, &points, None).unwrap());
    let e = err((&flat, Side::West), south, &BlendOptions::default());
    assert!(matches!(e, BlendError::NoPlane { end: 0, .. }), "{e}");
}
