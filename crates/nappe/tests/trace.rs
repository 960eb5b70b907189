//! Curves f(u, v) = 0: closed forms, counts of branches, singular places, brute force.

#![allow(clippy::unwrap_used)]

use nappe::expr::Expr;
use nappe::laws::Random;
use nappe::query::{
    BranchEnd, ExpressionField, Field, FieldJet, MeetOptions, Meets, Trace, TraceError,
    TraceOptions, Undecided, meet, trace,
};
use nappe::{Certainty, Curve, Interval, Limit};
use std::f64::consts::{PI, TAU};

fn field(text: &str, u: [f64; 2], v: [f64; 2]) -> ExpressionField {
    let bound = Expr::parse(text).unwrap().bind(&["u", "v"], &[]).unwrap();
    ExpressionField::new(
        bound,
        [Interval::new(u[0], u[1]), Interval::new(v[0], v[1])],
    )
}

/// With a tolerance that leaves time for many: the topology does not depend on it.
fn coarse(text: &str, u: [f64; 2], v: [f64; 2]) -> Trace {
    let options = TraceOptions {
        tol: Some(1e-3 * (u[1] - u[0])),
        ..Default::default()
    };
    trace(&field(text, u, v), &options).unwrap()
}

fn found(text: &str, u: [f64; 2], v: [f64; 2]) -> Trace {
    trace(&field(text, u, v), &TraceOptions::default()).unwrap()
}

/// The length of a path in the plane, by many chords.
fn length(c: &dyn Curve) -> f64 {
    let n = 20_000;
    let p: Vec<_> = (0..=n).map(|k| c.point(k as f64 / n as f64)).collect();
    p.windows(2).map(|w| w[0].distance(w[1])).sum()
}

/// Samples of all branches are near zeros: |f| is at most the error times the greatest slope there.
fn residuals(text: &str, t: &Trace, u: [f64; 2], v: [f64; 2]) {
    let f = field(text, u, v);
    for b in &t.branches {
        let e = b.certainty.error();
        let path = b.in_parameters();
        for k in 0..=500 {
            let p = path.point(k as f64 / 500.0);
            let r = 2.0 * e + 1e-12;
            let near = [p.x, p.y].map(|x| Interval::new(x - r, x + r));
            let near = [0, 1].map(|d| near[d].meet(f.domain()[d]));
            let j = f.enclose(near, f.domain()).unwrap();
            assert!(j[0].contains(0.0), "{text}: at {p} {j:?}");
        }
    }
}

#[test]
fn a_circle_is_one_loop_of_its_length() {
    for (r, at, size) in [
        (1.0, [0.0, 0.0], 2.0),
        (1e-6, [3.0, -7.0], 2e-6),
        (1e6, [1e6, 1e3], 3e6),
    ] {
        let text = format!("(u - ({:?}))^2 + (v - ({:?}))^2 - {r:?}^2", at[0], at[1]);
        let range = |c: f64| [c - size, c + size * 1.1];
        let t = found(&text, range(at[0]), range(at[1]));
        assert_eq!(t.branches.len(), 1, "{r} {t:?}");
        assert!(t.undecided.is_empty() && t.touches.is_empty());
        let b = &t.branches[0];
        assert!(b.is_closed());
        let Certainty::Bounded(e) = b.certainty else {
            panic!("{:?}", b.certainty)
        };
        assert!(e <= 1e-5 * size, "{r}: {e}");
        let path = b.in_parameters();
        let l = length(&path);
        assert!((l - TAU * r).abs() <= TAU * e + 1e-6 * r, "{r}: {l}");
        for k in 0..1000 {
            let p = path.point(k as f64 / 1000.0);
            let off = ((p.x - at[0]).hypot(p.y - at[1]) - r).abs();
            assert!(off <= e, "{r}: off {off}, proven {e}");
        }
        // Positive outside, so to the left: clockwise.
        let d = path.jet(0.0, Limit::Above, 1);
        let out = d.d[0] - nappe::DVec3::new(at[0], at[1], 0.0);
        assert!(d.d[1].cross(out).z > 0.0);
    }
}

#[test]
fn many_small_ovals_are_all_found() {
    // sin(ku) sin(kv) = c has a loop in each of the squares where the product is positive.
    for (k, c) in [(3, 0.5), (7, 0.97), (10, 0.05), (12, 0.999)] {
        let t = found(
            &format!("sin({k}*u)*sin({k}*v) - {c}"),
            [0.0, PI],
            [0.0, PI],
        );
        let positive = (0..k * k).filter(|i| (i / k + i % k) % 2 == 0).count();
        assert_eq!(t.branches.len(), positive, "{k} {c}");
        assert!(t.branches.iter().all(|b| b.is_closed()) && t.undecided.is_empty());
    }
}

#[test]
fn cassini_ovals_change_at_the_node() {
    let text = |b: f64| format!("(u^2 + v^2)^2 - 2*(u^2 - v^2) - {:?}", b.powi(4) - 1.0);
    let at = |b: f64| found(&text(b), [-2.0, 2.1], [-2.05, 2.0]);
    for (b, loops) in [
        (0.5, 2),
        (0.999, 2),
        (0.9999999, 2),
        (1.0000001, 1),
        (1.01, 1),
        (1.3, 1),
    ] {
        let t = at(b);
        assert_eq!(t.branches.len(), loops, "{b}");
        assert!(
            t.branches.iter().all(|b| b.is_closed()) && t.undecided.is_empty(),
            "{b}"
        );
        residuals(&text(b), &t, [-2.0, 2.1], [-2.05, 2.0]);
    }
    // The lemniscate: two loops that begin and end in the node.
    let t = at(1.0);
    assert_eq!((t.branches.len(), t.undecided.len()), (2, 1));
    let node = &t.undecided[0];
    assert_eq!(node.ends, 4);
    assert!(
        node.hull
            .iter()
            .all(|h| h.contains(0.0) && h.width() < 1e-6),
        "{:?}",
        node.hull
    );
}

#[test]
fn singular_places_are_reported() {
    // A point by itself.
    let t = found("u^2 + v^2", [-1.0, 1.0], [-1.0, 1.0]);
    assert!(t.branches.is_empty());
    assert_eq!((t.undecided.len(), t.undecided[0].ends), (1, 0));
    // A node.
    let t = found("u*v", [-1.0, 1.0], [-1.0, 1.0]);
    assert_eq!((t.branches.len(), t.undecided.len()), (4, 1));
    assert_eq!(t.undecided[0].ends, 4);
    for b in &t.branches {
        let ends = b.ends.unwrap();
        assert!(ends.contains(&BranchEnd::Border) && ends.contains(&BranchEnd::Undecided(0)));
    }
    // A cusp.
    let t = found("v^2 - u^3", [-1.0, 1.0], [-1.0, 1.0]);
    assert_eq!((t.branches.len(), t.undecided.len()), (2, 1));
    assert_eq!(t.undecided[0].ends, 2);
    // A double line: nothing is proven, nothing is dropped.
    let options = TraceOptions {
        budget: 5000,
        ..Default::default()
    };
    let t = trace(
        &field("(u - 0.3*v - 0.2)^2", [0.0, 1.0], [0.0, 1.0]),
        &options,
    )
    .unwrap();
    assert!(t.branches.is_empty());
    for k in 0..=100 {
        let v = 0.01 * f64::from(k);
        let u = 0.2 + 0.3 * v;
        let covers = |c: &[Interval; 2]| c[0].contains(u) && c[1].contains(v);
        assert!(
            t.undecided.iter().any(|x| x.cells.iter().any(covers)),
            "{v}"
        );
    }
}

#[test]
fn lines_along_borders_and_through_corners() {
    let unit = [0.0, 1.0];
    for (text, count, expected) in [
        ("u", 1, 1.0),
        ("v - 1", 1, 1.0),
        ("u - v", 1, 2f64.sqrt()),
        ("u + v - 1", 1, 2f64.sqrt()),
        ("u - 0.5", 1, 1.0),
        ("2*u - v", 1, 1.25f64.sqrt()),
        ("u*(u - 0.5)*(u - 1)", 3, 1.0),
    ] {
        let t = found(text, unit, unit);
        assert_eq!(t.branches.len(), count, "{text}: {t:?}");
        assert!(t.undecided.is_empty() && t.touches.is_empty(), "{text}");
        for b in &t.branches {
            let l = length(&b.in_parameters());
            assert!((l - expected).abs() < 1e-9, "{text}: {l}");
            assert_eq!(b.ends, Some([BranchEnd::Border; 2]));
        }
    }
    // Only a corner.
    let t = found("u + v", unit, unit);
    assert!(t.branches.is_empty() && t.undecided.is_empty());
    assert_eq!(t.touches.len(), 1);
    assert!(t.touches[0].iter().all(|x| x.abs() < 1e-11));
    // A circle that touches all four sides is a loop.
    let t = found("(u-0.5)^2 + (v-0.5)^2 - 0.25", unit, unit);
    assert_eq!(t.branches.len(), 1, "{t:?}");
    assert!(t.branches[0].is_closed() && t.undecided.is_empty());
}

#[test]
fn no_zeros_a_region_of_zeros_and_no_values() {
    let unit = [0.0, 1.0];
    assert!(found("u + v + 1", unit, unit).branches.is_empty());
    let error = |text: &str| trace(&field(text, unit, unit), &TraceOptions::default()).unwrap_err();
    assert!(matches!(error("u - u"), TraceError::Zero(_)));
    assert!(matches!(error("max(u - 0.5, 0)"), TraceError::Zero(_)));
    assert!(matches!(error("sqrt(u - 2)"), TraceError::NoValue(_)));
    let both = |f: &str, g: &str| {
        let options = MeetOptions::default();
        meet(&field(f, unit, unit), &field(g, unit, unit), &options).unwrap_err()
    };
    assert!(matches!(both("u - u", "v"), TraceError::Zero(_)));
    assert!(matches!(both("u", "0*v"), TraceError::Zero(_)));
    let options = TraceOptions {
        tol: Some(0.0),
        ..Default::default()
    };
    assert!(matches!(
        trace(&field("u", unit, unit), &options),
        Err(TraceError::Tolerance(_))
    ));
    let options = TraceOptions {
        within: Some([Interval::new(0.0, 2.0), Interval::UNIT]),
        ..Default::default()
    };
    assert!(matches!(
        trace(&field("u", unit, unit), &options),
        Err(TraceError::Rectangle { .. })
    ));
}

#[test]
fn creases_of_the_function_are_crossed() {
    // A diamond: four corners, one loop.
    let t = found(
        "abs(u - 0.31) + abs(v - 0.42) - 0.2",
        [0.0, 1.0],
        [0.0, 1.0],
    );
    assert_eq!(t.branches.len(), 1, "{:?}", t.undecided);
    assert!(t.branches[0].is_closed() && t.undecided.is_empty());
    let l = length(&t.branches[0].in_parameters());
    // Chords across the corners are shorter.
    assert!((l - 0.8 * 2f64.sqrt()).abs() < 1e-4, "{l}");
    // Exactly along a crease; where that meets the border, the continuation beyond it is not known.
    let t = found("min(u - 0.5, 2*(u - 0.5))", [0.0, 1.0], [0.0, 1.0]);
    assert_eq!((t.branches.len(), t.undecided.len()), (1, 2));
    let l = length(&t.branches[0].in_parameters());
    assert!(l > 1.0 - 1e-6 && l <= 1.0, "{l}");
}

#[test]
fn tighter_tolerances_are_met() {
    let f = field("u^3 - 3*u*v^2 + sin(3*v) - 0.2", [-2.0, 2.0], [-2.0, 2.0]);
    for tol in [1e-2, 1e-5, 1e-8, 1e-11] {
        let options = TraceOptions {
            tol: Some(tol),
            ..Default::default()
        };
        let t = trace(&f, &options).unwrap();
        assert!(t.branches.len() >= 3 && t.undecided.is_empty(), "{tol}");
        for b in &t.branches {
            assert!(
                matches!(b.certainty, Certainty::Bounded(e) if e <= tol),
                "{tol}: {:?}",
                b.certainty
            );
        }
        let pieces: usize = t
            .branches
            .iter()
            .map(|b| b.in_parameters().breaks().len())
            .sum();
        println!("{tol:e}: {} cells, {pieces} pieces", t.cells);
    }
}

/// A polynomial of degree 5 with random coefficients, and its value.
fn polynomial(random: &mut Random) -> (String, impl Fn(f64, f64) -> f64) {
    let mut terms = Vec::new();
    // Growing with the degree, so that they wind within the square.
    for i in 0..6i32 {
        for j in 0..6 - i {
            terms.push(((2.0 * random.unit() - 1.0) * 2f64.powi(i + j), i, j));
        }
    }
    let text: Vec<String> = terms
        .iter()
        .map(|(c, i, j)| format!("({c:?})*u^{i}*v^{j}"))
        .collect();
    let value = move |u: f64, v: f64| {
        terms
            .iter()
            .map(|(c, i, j)| c * u.powi(*i) * v.powi(*j))
            .sum()
    };
    (text.join(" + "), value)
}

/// Loops and open curves of the zeros by the signs on a grid, marching through its squares; `None` if a square has all
/// four edges crossed, where signs do not tell.
fn by_grid(f: &dyn Fn(f64, f64) -> f64, n: usize) -> Option<[usize; 2]> {
    let at = |k: usize| -1.0 + 2.0 * k as f64 / n as f64;
    let signs: Vec<bool> = (0..(n + 1) * (n + 1))
        .map(|k| f(at(k / (n + 1)), at(k % (n + 1))) > 0.0)
        .collect();
    let sign = |i: usize, j: usize| signs[i * (n + 1) + j];
    // Edges by number: those along u, then those along v. Each square joins two edges.
    let along_u = |i: usize, j: usize| i * (n + 1) + j;
    let along_v = |i: usize, j: usize| n * (n + 1) + i * n + j;
    let mut joined: Vec<Vec<usize>> = vec![Vec::new(); 2 * n * (n + 1)];
    for i in 0..n {
        for j in 0..n {
            let mut crossed = Vec::new();
            for (edge, a, b) in [
                (along_u(i, j), sign(i, j), sign(i + 1, j)),
                (along_u(i, j + 1), sign(i, j + 1), sign(i + 1, j + 1)),
                (along_v(i, j), sign(i, j), sign(i, j + 1)),
                (along_v(i + 1, j), sign(i + 1, j), sign(i + 1, j + 1)),
            ] {
                if a != b {
                    crossed.push(edge);
                }
            }
            match crossed[..] {
                [] => {}
                [a, b] => {
                    joined[a].push(b);
                    joined[b].push(a);
                }
                _ => return None,
            }
        }
    }
    let mut seen = vec![false; joined.len()];
    let mut count = [0, 0];
    let open = (0..joined.len()).filter(|&e| joined[e].len() == 1);
    let starts: Vec<usize> = open
        .chain((0..joined.len()).filter(|&e| joined[e].len() == 2))
        .collect();
    for start in starts {
        if seen[start] {
            continue;
        }
        count[usize::from(joined[start].len() == 1)] += 1;
        let mut stack = vec![start];
        while let Some(e) = stack.pop() {
            if !std::mem::replace(&mut seen[e], true) {
                stack.extend(&joined[e]);
            }
        }
    }
    Some(count)
}

#[test]
fn random_polynomials_have_the_curves_of_a_fine_grid() {
    let mut random = Random(5);
    let (mut compared, mut loops) = (0, 0);
    for _ in 0..40 {
        let (text, value) = polynomial(&mut random);
        let t = coarse(&text, [-1.0, 1.0], [-1.0, 1.0]);
        assert!(t.undecided.is_empty(), "{text}: {:?}", t.undecided);
        let Some(grid) = by_grid(&value, 400) else {
            continue;
        };
        let closed = t.branches.iter().filter(|b| b.is_closed()).count();
        assert_eq!([closed, t.branches.len() - closed], grid, "{text}");
        compared += 1;
        loops += closed;
        residuals(&text, &t, [-1.0, 1.0], [-1.0, 1.0]);
    }
    assert!(compared >= 25 && loops >= 5, "{compared} {loops}");
}

#[test]
fn curves_do_not_depend_on_place_and_scale() {
    let mut random = Random(9);
    for _ in 0..5 {
        let (text, _) = polynomial(&mut random);
        let plain = coarse(&text, [-1.0, 1.0], [-1.0, 1.0]);
        for (scale, shift) in [(1e-6, 0.0), (1e6, 0.0), (1.0, 1000.0), (1e-3, -7.0)] {
            let inner = |x: &str| format!("(({x} - ({shift:?}))/{scale:?})");
            let moved = text
                .replace('u', &inner("x"))
                .replace('v', &inner("y"))
                .replace('x', "u")
                .replace('y', "v");
            let range = [shift - scale, shift + scale];
            let t = coarse(&moved, range, range);
            let closed = |t: &Trace| t.branches.iter().filter(|b| b.is_closed()).count();
            assert_eq!(
                (t.branches.len(), closed(&t)),
                (plain.branches.len(), closed(&plain)),
                "{moved}"
            );
            assert!(t.undecided.is_empty());
        }
    }
}

fn met(f: &str, g: &str, square: [f64; 2]) -> Meets {
    let points = meet(
        &field(f, square, square),
        &field(g, square, square),
        &MeetOptions::default(),
    )
    .unwrap();
    for p in &points.points {
        for text in [f, g] {
            let j = field(text, square, square)
                .enclose(p.zero.map(|z| z.inflate(1e-15)), [Interval::ENTIRE; 2])
                .unwrap();
            assert!(
                j[0].contains(0.0) && p.zero.iter().all(|z| z.width() < 1e-9),
                "{p:?}"
            );
        }
    }
    points
}

#[test]
fn conics_meet_as_often_as_they_must() {
    let box3 = [-3.0, 3.1];
    for (f, g, count) in [
        // Two ellipses: four points.
        ("u^2/4 + v^2 - 1", "u^2 + v^2/4 - 1", 4),
        ("u^2/4 + v^2 - 1", "(u - 0.7)^2 + v^2/4 - 1", 4),
        ("u^2 + v^2 - 1", "(u - 1)^2 + v^2 - 1", 2),
        ("u^2 + v^2 - 1", "(u - 2.5)^2 + v^2 - 1", 0),
        ("u*v - 1", "u^2 + v^2 - 4", 4),
        ("v - u^2 + 1", "u - v^2 + 1", 4),
        ("u - 0.5", "v - 0.25", 1),
        // Points on the border of the square and in its corners.
        ("u + 3", "v - 3.1", 1),
        ("u + 3", "v^2 - 1", 2),
    ] {
        let m = met(f, g, box3);
        assert_eq!(
            (m.points.len(), m.undecided.len()),
            (count, 0),
            "{f}, {g}: {m:?}"
        );
    }
    // Nine points of two cubics in a grid.
    let m = met("u*(u - 1)*(u + 1)", "v*(v - 1)*(v + 1)", box3);
    assert_eq!(m.points.len(), 9);
    for (k, p) in m.points.iter().enumerate() {
        let expected = [k / 3, k % 3].map(|i| i as f64 - 1.0);
        assert!(
            (0..2)
                .all(|d| (p.uv[d] - expected[d]).abs() < 1e-14 && p.zero[d].contains(expected[d]))
        );
    }
    // Many, without a pattern of cells: sin u = 0 = sin v in (-30, 31).
    let m = met("sin(u)", "sin(v + 0.3*u)", [-30.0, 31.0]);
    let count: i32 = (-9..=9)
        .map(|k| {
            let shift = 0.3 * PI * f64::from(k);
            (((31.0 + shift) / PI).floor() - ((-30.0 + shift) / PI).ceil()) as i32 + 1
        })
        .sum();
    assert_eq!((m.points.len() as i32, m.undecided.len()), (count, 0));
}

#[test]
fn touching_curves_are_not_decided_where_they_touch() {
    let m = met("v", "v - u^2", [-1.0, 1.0]);
    assert_eq!((m.points.len(), m.undecided.len()), (0, 1));
    assert!(
        m.undecided[0]
            .hull
            .iter()
            .all(|h| h.contains(0.0) && h.width() < 0.01),
        "{:?}",
        m.undecided[0].hull
    );
    let m = met("u^2 + v^2 - 1", "(u - 2)^2 + v^2 - 1", [-1.5, 1.6]);
    assert_eq!((m.points.len(), m.undecided.len()), (0, 1));
}

/// With few cells: for functions with whole lines of places that are not decided.
fn few(text: &str, u: [f64; 2], v: [f64; 2]) -> Trace {
    let options = TraceOptions {
        budget: 20_000,
        ..Default::default()
    };
    trace(&field(text, u, v), &options).unwrap()
}

/// True if a place lies within `off` of a branch or at a place that is not decided.
fn covered(t: &Trace, p: [f64; 2], off: f64) -> bool {
    let open = |c: &[Interval; 2]| c[0].contains(p[0]) && c[1].contains(p[1]);
    t.undecided.iter().any(|x| x.cells.iter().any(open))
        || t.branches.iter().any(|b| {
            let path = b.in_parameters();
            (0..=2000).any(|k| {
                let q = path.point(f64::from(k) / 2000.0);
                (q.x - p[0]).hypot(q.y - p[1]) <= off
            })
        })
}

#[test]
fn poles_of_the_tangent_are_no_zeros() {
    let t = few("tan(3*u) - v", [0.0, 1.0], [0.0, 1.0]);
    assert_eq!(t.branches.len(), 1, "{t:?}");
    let b = &t.branches[0];
    assert_eq!(b.ends, Some([BranchEnd::Border; 2]));
    for k in 0..=100 {
        let v = 0.01 * f64::from(k);
        assert!(covered(&t, [v.atan() / 3.0, v], 1e-3), "{v}");
    }
    let path = b.in_parameters();
    for k in 0..=100 {
        let p = path.point(f64::from(k) / 100.0);
        assert!((p.x - p.y.atan() / 3.0).abs() < 1e-5, "{p}");
    }
    for place in &t.undecided {
        assert!(place.hull[0].contains(PI / 6.0), "{place}");
    }
}

#[test]
fn nothing_is_proven_where_a_power_has_no_value() {
    // A hole of the radius 0.05 on the line v = 0.25.
    let text = "((u - 0.7433)^2 + (v - 0.25)^2 - 0.0025)^2.5 + v - 0.25";
    let t = few(text, [0.0, 1.0], [0.0, 1.0]);
    assert_eq!(t.branches.len(), 2, "{t:?}");
    assert!(!t.undecided.is_empty());
    for b in &t.branches {
        let path = b.in_parameters();
        let e = b.certainty.error() + 1e-12;
        for k in 0..=1000 {
            let p = path.point(f64::from(k) / 1000.0);
            let off = (p.x - 0.7433).hypot(p.y - 0.25);
            assert!(off >= 0.05 - e, "{p} is in the hole");
        }
    }
    // The zeros outside, by halving.
    for k in 0..=200 {
        let u = 0.005 * f64::from(k);
        let d = u - 0.7433;
        let positive = |v: f64| {
            let w = d * d + (v - 0.25).powi(2) - 0.0025;
            w.powf(2.5) + v > 0.25
        };
        if d.abs() < 0.0501 || positive(0.0) {
            continue;
        }
        let (mut lo, mut hi) = (0.0, 0.2501);
        for _ in 0..60 {
            let v = 0.5 * (lo + hi);
            *(if positive(v) { &mut hi } else { &mut lo }) = v;
        }
        assert!(covered(&t, [u, lo], 1e-3), "{u} {lo}");
    }
    // Where it has a value, the first is positive.
    let m = met("u^1.5 + u + 0.001", "v", [-1.0, 1.0]);
    assert!(m.points.is_empty(), "{m:?}");
    // The same with a zero.
    let m = met("u^1.5 + u - 0.001", "v", [-1.0, 1.0]);
    assert_eq!(m.points.len(), 1, "{m:?}");
}

#[test]
fn the_jump_of_the_angle_at_a_border_hides_nothing() {
    // atan2(v, u) = -3: the line v = u tan(-3), below the jump on the border v = 0.
    let t = few("atan2(v, u) + 3", [-1.0, -0.5], [-1.0, 0.0]);
    for k in 0..=100 {
        let u = -1.0 + 0.005 * f64::from(k);
        assert!(covered(&t, [u, u * 3f64.tan().abs()], 1e-3), "{u}");
    }
    // The same away from the border.
    let t = few("atan2(v, u) + 3", [-1.0, -0.5], [-1.0, -0.01]);
    assert_eq!((t.branches.len(), t.undecided.len()), (1, 0));
}

/// v = 1/2, of which nothing but the value and the slope along v is known.
#[derive(Debug)]
struct Steep;

impl Field for Steep {
    fn domain(&self) -> [Interval; 2] {
        [Interval::UNIT; 2]
    }

    fn enclose(&self, uv: [Interval; 2], _: [Interval; 2]) -> Option<FieldJet> {
        let mut j = [Interval::ENTIRE; 6];
        j[0] = uv[1] - Interval::point(0.5);
        j[2] = Interval::ONE;
        Some(j)
    }
}

#[test]
fn curves_without_a_bound_end_with_the_budget() {
    let options = TraceOptions {
        budget: 2000,
        ..Default::default()
    };
    let t = trace(&Steep, &options).unwrap();
    assert_eq!(t.branches.len(), 1);
    let b = &t.branches[0];
    assert!(matches!(b.certainty, Certainty::Estimated(_)));
    assert!(b.in_parameters().breaks().len() <= 2001);
    for k in 0..=100 {
        let p = b.in_parameters().point(f64::from(k) / 100.0);
        assert!((p.y - 0.5).abs() < 1e-12, "{p}");
    }
}

#[test]
fn a_curve_ends_where_the_function_has_no_value_beyond() {
    // From (0.3, 0.5), where a root lets it begin.
    let t = found("(u - 0.3)^1.5 + v - 0.5", [0.0, 1.0], [0.0, 1.0]);
    assert_eq!(t.branches.len(), 1);
    // Where the line u = 0.3 meets the border, the continuation beyond it is not known.
    let inner = |place: &&Undecided| place.hull[1].lo > 0.0 && place.hull[1].hi < 1.0;
    assert!(t.undecided.iter().all(|place| place.hull[0].contains(0.3)));
    let inner: Vec<&Undecided> = t.undecided.iter().filter(inner).collect();
    assert_eq!((inner.len(), inner[0].ends), (1, 1), "{inner:?}");
    let place = inner[0];
    assert!(place.to_string().contains("1 branch ends here"), "{place}");
    assert!(
        place.hull.iter().all(|h| h.width() < 1e-6) && place.hull[1].contains(0.5),
        "{place}"
    );
    // Here it begins along the line beyond which there is no value: less is proven, but nothing is lost.
    let t = found("sqrt(u - 0.3) + v - 0.5", [0.0, 1.0], [0.0, 1.0]);
    assert_eq!(t.branches.len(), 1);
    let ends: usize = t.undecided.iter().map(|place| place.ends).sum();
    assert_eq!(ends, 1);
    for place in &t.undecided {
        let near =
            |d: usize, x: f64, off: f64| Interval::new(x - off, x + off).encloses(place.hull[d]);
        let border = place.hull[1].lo <= 0.0 || place.hull[1].hi >= 1.0;
        assert!(
            near(0, 0.3, 1e-6) && (border || near(1, 0.5, 1e-3)),
            "{place}"
        );
    }
}

#[test]
fn branches_are_in_order_though_rounding_differs() {
    // Two circles, the one above the other: the lower one comes first.
    for shift in [0.0, 0.1, 0.3, 1.0 / 3.0, 0.7] {
        let c = |v: f64| format!("((u - {shift:?})^2 + (v - ({v:?}))^2 - 0.09)");
        let [a, b] = [0.4, -0.7].map(|v| v + shift);
        let t = found(
            &format!("{}*{}", c(a), c(b)),
            [shift - 1.0, shift + 1.1],
            [shift - 1.2, shift + 1.0],
        );
        assert_eq!(t.branches.len(), 2);
        let low = [0, 1].map(|k| t.branches[k].bounds()[1].lo);
        assert!(low[0] < low[1], "{shift}: {low:?}");
    }
}

#[test]
fn a_tolerance_that_is_missed_is_said() {
    let text = "u^2 + v^2 - 1";
    let square = [-2.0, 2.1];
    let options = TraceOptions {
        tol: Some(1e-14),
        ..Default::default()
    };
    let t = trace(&field(text, square, square), &options).unwrap();
    assert_eq!(t.tol, 1e-14);
    let b = &t.branches[0];
    assert!(b.certainty.error() > t.tol && b.certainty.error() < 1e-8);
    residuals(text, &t, square, square);
}
