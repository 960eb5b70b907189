//! Blending functions: reference values, identities, enclosures and refusals.

#![allow(
    clippy::unwrap_used,
    clippy::approx_constant,
    clippy::excessive_precision
)]

use nappe::basis::{
    BSplineBasis, Blending, BlendingError, Functions, Hermite, Trigonometric, TrigonometricError,
};
use nappe::laws::Random;
use nappe::{Interval, Limit};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

/// H1 … H4 and their first and third derivatives for an angle and a parameter, from the formulas (8) of the source
/// as printed there, evaluated with mpmath in 60 digits (`taylor`) and rounded to 17.
type Reference = (f64, f64, [[f64; 4]; 3]);
#[rustfmt::skip]
const REFERENCE: [Reference; 8] = [
    (1e-06, 0.3, [
        [0.82809999999998759, 0.16904999999999746, -0.040950000000006208, 0.17190000000001241],
        [-1.0920000000000664, 0.15399999999998081, -0.24600000000003321, 1.0920000000000664],
        [7.2000000000018597, 3.6000000000005299, 3.6000000000009299, -7.2000000000018597],
    ]),
    (1e-06, 0.95, [
        [0.0095062499999985866, 0.0035031249999994791, -0.043996875000000749, 0.99049375000000141],
        [-0.37049999999994758, -0.13524999999998087, 0.76475000000002616, 0.37049999999994758],
        [22.799999999990451, 11.399999999996126, 11.399999999995226, -22.799999999990451],
    ]),
    (0.01, 0.3, [
        [0.8280987578446277, 0.16904974641904303, -0.040950621081826716, 0.1719012421553723],
        [-1.0920066430231413, 0.15399807847008906, -0.24600332153371431, 1.0920066430231413],
        [7.2001860011220641, 3.600053001041042, 3.6000930011810424, -7.2001860011220641],
    ]),
    (0.01, 0.95, [
        [0.0095061070104091812, 0.0035030723068455992, -0.043996946495272088, 0.99049389298959082],
        [-0.37049472810103743, -0.13524807653430224, 0.7647526359670544, 0.37049472810103743],
        [22.799045254853813, 11.399612624315645, 11.399522624244395, -22.799045254853813],
    ]),
    (2.5, 0.3, [
        [0.72425700629959509, 0.084378080755070074, -0.15261636068357421, 0.27574299370040491],
        [-1.6103574680530943, -0.29442988081383057, -0.7996283095615587, 1.6103574680530943],
        [24.477765029868699, 19.19099498239181, 22.348485162065111, -24.477765029868699],
    ]),
    (2.5, 0.95, [
        [0.0020157006853635929, -0.0027882777111511461, -0.051621167956335133, 0.99798429931463641],
        [-0.086456371905692497, 0.10424310820032974, 1.0550146757224519, 0.086456371905692497],
        [-13.898655383540314, -18.03359931366033, -23.975921610673593, 13.898655383540314],
    ]),
    (3.14159, 0.3, [
        [0.63026601314717358, -39255.331410089775, -39255.588928091656, 0.36973398685282642],
        [-2.0177569113450311, -179201.37679119915, -179201.96457602208, 2.0177569113450311],
        [42.030925360952649, 7074592.240545689, 7074598.0417395642, -42.030925360952649],
    ]),
    (3.14159, 0.95, [
        [3.7896666958094646e-5, -1467.7452518195831, -1467.7950464514922, 0.99996210333304191],
        [-0.0030254457306388424, 58226.133587817395, 58227.121275971189, 0.0030254457306388424],
        [-7.156333215606049, -2298700.9782737078, -2298710.7263485897, 7.156333215606049],
    ]),
];

fn jet(f: &dyn Functions, t: f64, order: usize) -> Vec<f64> {
    let mut out = vec![0.0; f.count() * (order + 1)];
    f.jet_into(t, Limit::Above, order, &mut out);
    out
}

#[test]
fn values_and_derivatives_keep_13_digits_for_every_angle() {
    for (alpha, t, want) in REFERENCE {
        let got = jet(&Trigonometric::new(alpha).unwrap(), t, 3);
        for (row, k) in [0, 1, 3].into_iter().enumerate() {
            for i in 0..4 {
                let (g, w) = (got[4 * k + i], want[row][i]);
                let error = (g - w).abs() / w.abs().max(1.0);
                assert!(
                    error <= 1e-13,
                    "H{} order {k} at α = {alpha}, t = {t}: {g} {w}",
                    i + 1
                );
            }
        }
    }
}

const ANGLES: [f64; 9] = [1e-9, 1e-6, 0.01, 0.5, 1.0, FRAC_PI_2, 2.5, 3.1, 3.14159];

#[test]
fn the_identities_of_the_source_hold_to_rounding() {
    for alpha in ANGLES {
        let h = Trigonometric::new(alpha).unwrap();
        let (s, c) = alpha.sin_cos();
        for i in 0..=200 {
            let t = i as f64 / 200.0;
            let [h1, h2, h3, h4] = jet(&h, t, 0)[..] else {
                panic!()
            };
            let size = 1.0 + alpha * h3.abs();
            assert!((h1 + h4 - 1.0).abs() <= 2e-15);
            let cosine = h1 - alpha * s * h3 + c * h4;
            assert!(
                (cosine - (alpha * t).cos()).abs() <= 3e-15 * size,
                "{alpha} {t}"
            );
            let sine = (alpha * h2 + alpha * c * h3 + s * h4) / alpha;
            assert!(
                (sine - (alpha * t).sin() / alpha).abs() <= 3e-15 * size,
                "{alpha} {t}"
            );
        }
    }
}

#[test]
fn a_right_angle_gives_squares() {
    let h = Trigonometric::new(FRAC_PI_2).unwrap();
    for i in 0..=100 {
        let t = i as f64 / 100.0;
        let (s, c) = (FRAC_PI_2 * t).sin_cos();
        let want = [
            c * c,
            (s - s * s) / FRAC_PI_2,
            (c * c - c) / FRAC_PI_2,
            s * s,
        ];
        for (got, want) in jet(&h, t, 0).iter().zip(want) {
            assert!((got - want).abs() <= 2e-15, "{t}: {got} {want}");
        }
    }
}

#[test]
fn a_small_angle_gives_the_limit() {
    for alpha in [Trigonometric::MIN, 1e-12, 1e-9] {
        let h = Trigonometric::new(alpha).unwrap();
        for i in 0..=50 {
            let t = i as f64 / 50.0;
            let (p, m) = ((1.0 - t * t).powi(2), 1.0 - t);
            let want = [
                p,
                t * m * m * (1.0 + 0.5 * t),
                -0.5 * t * t * (1.0 - t * t),
                1.0 - p,
            ];
            let slopes = [
                -4.0 * t * (1.0 - t * t),
                1.0 - 3.0 * t + 2.0 * t * t * t,
                -t + 2.0 * t * t * t,
                4.0 * t * (1.0 - t * t),
            ];
            let got = jet(&h, t, 1);
            for k in 0..4 {
                assert!((got[k] - want[k]).abs() <= 1e-15);
                assert!((got[4 + k] - slopes[k]).abs() <= 4e-15);
            }
        }
    }
}

fn conditions(h: &dyn Functions, tol: f64) {
    let (a, b) = (jet(h, 0.0, 1), jet(h, 1.0, 1));
    for j in 0..4 {
        for (i, l) in [a[j], a[4 + j], b[4 + j], b[j]].into_iter().enumerate() {
            assert!(
                (l - if i == j { 1.0 } else { 0.0 }).abs() <= tol,
                "L{} H{}: {l}",
                i + 1,
                j + 1
            );
        }
    }
}

#[test]
fn both_bases_satisfy_their_defining_conditions() {
    conditions(&Hermite::new(), 1e-15);
    for alpha in ANGLES {
        conditions(&Trigonometric::new(alpha).unwrap(), 1e-15);
    }
}

/// Each function has one derivative equal to 1 at one end and all others that count equal to 0, exactly; the functions of the
/// two values sum to 1; a polynomial of the degree is the sum of its own data.
#[test]
fn hermite_functions_of_all_orders() {
    for m in 0..=2 {
        for n in 0..=2 {
            let h = Hermite::of_orders([m, n]);
            let (count, degree) = (h.count(), m + n + 1);
            assert_eq!(count, degree + 1);
            let all = |t: f64, limit: Limit, order: usize| {
                let mut out = vec![0.0; count * (order + 1)];
                h.jet_into(t, limit, order, &mut out);
                out
            };
            let (start, end) = (all(0.0, Limit::Above, 2), all(1.0, Limit::Below, 2));
            for f in 0..count {
                for k in 0..=m {
                    let one = f64::from(u8::from(f == k));
                    assert!(
                        (start[k * count + f] - one).abs() <= 4e-16,
                        "{m} {n} {f} {k}"
                    );
                }
                for k in 0..=n {
                    let one = f64::from(u8::from(f == degree - k));
                    assert!((end[k * count + f] - one).abs() <= 4e-16, "{m} {n} {f} {k}");
                }
            }
            // (t - c)^degree by its derivatives at both ends.
            let power = |t: f64, k: usize| {
                let falling: f64 = (0..k).map(|i| (degree - i) as f64).product();
                falling * (t - 0.3f64).powi((degree - k) as i32)
            };
            let exact = h.to_piecewise().unwrap();
            for t in [0.0, 0.1, 0.35, 0.5, 0.9, 1.0] {
                let values = all(t, Limit::Above, 0);
                let mut sum = 0.0;
                (0..=m).for_each(|k| sum += power(0.0, k) * values[k]);
                (0..=n).for_each(|k| sum += power(1.0, k) * values[degree - k]);
                assert!((sum - power(t, 0)).abs() <= 1e-15, "{m} {n} {t}: {sum}");
                assert!((values[0] + values[degree] - 1.0).abs() <= 4e-16);
                for (a, b) in values.iter().zip(exact.value(t)) {
                    assert!((a - b).abs() <= 4e-16);
                }
            }
        }
    }
}

#[test]
fn enclosures_hold_the_values_and_shrink() {
    let mut random = Random(1);
    for alpha in ANGLES {
        let bases: [Box<dyn Functions>; 2] = [
            Box::new(Trigonometric::new(alpha).unwrap()),
            Box::new(Hermite::new()),
        ];
        for h in bases {
            for _ in 0..2000 {
                let t = random.part(Interval::UNIT);
                let mut boxes = [Interval::ENTIRE; 20];
                h.enclose_piece(t, Limit::Above, 4, &mut boxes);
                for x in [t.lo, t.hi, random.within(t)] {
                    for (b, v) in boxes.iter().zip(jet(h.as_ref(), x, 4)) {
                        let slack = 1e-14 * b.mag().max(1.0);
                        assert!(b.inflate(slack).contains(v), "{alpha} {t:?} {x}: {v} {b:?}");
                    }
                }
            }
            let width = |w: f64| {
                let mut boxes = [Interval::ENTIRE; 12];
                h.enclose_piece(Interval::new(0.4, 0.4 + w), Limit::Above, 2, &mut boxes);
                boxes.map(|b| b.width() / b.mag().max(1.0))
            };
            for (a, b) in width(1e-3).into_iter().zip(width(1e-5)) {
                assert!(b <= 0.02 * a + 1e-13, "{alpha}: {a} {b}");
            }
        }
    }
}

#[test]
fn angles_out_of_range_are_refused_with_a_reason() {
    for alpha in [0.0, -1.0, f64::NAN, 1e-300, f64::NEG_INFINITY] {
        assert!(matches!(
            Trigonometric::new(alpha).unwrap_err(),
            TrigonometricError::TooSmall { .. }
        ));
    }
    for alpha in [PI, PI - 1e-7, 4.0, f64::INFINITY] {
        let e = Trigonometric::new(alpha).unwrap_err();
        assert!(matches!(e, TrigonometricError::TooLarge { .. }));
        assert!(e.to_string().contains("grow without bound"), "{e}");
    }
}

#[test]
fn user_blending_is_checked_function_by_function() {
    for ok in [
        Blending::user(Arc::new(Hermite::new())).unwrap(),
        Blending::user(Arc::new(Trigonometric::new(1.0).unwrap())).unwrap(),
        Blending::user(Arc::new(BSplineBasis::bernstein(1))).unwrap(),
    ] {
        assert!(ok.is_affine());
    }
    // Bernstein polynomials of degree 3 have the right values at the ends, and the wrong derivatives.
    let e = Blending::user(Arc::new(BSplineBasis::bernstein(3))).unwrap_err();
    let BlendingError::Conditions { faults } = &e else {
        panic!("{e}")
    };
    let wrong: Vec<_> = faults
        .iter()
        .map(|f| (f.functional, f.function, f.value))
        .collect();
    assert_eq!(
        wrong,
        [(2, 1, -3.0), (2, 2, 3.0), (3, 3, -3.0), (3, 4, 3.0)]
    );
    assert!(e.to_string().contains("h1'(0) is -3, it must be 0"), "{e}");
    assert!(matches!(
        Blending::user(Arc::new(BSplineBasis::bernstein(2))).unwrap_err(),
        BlendingError::Count { count: 3 }
    ));
    let long = BSplineBasis::new(1, vec![0.0, 0.0, 2.0, 2.0]).unwrap();
    assert!(matches!(
        Blending::user(Arc::new(long)).unwrap_err(),
        BlendingError::Domain { .. }
    ));
}
