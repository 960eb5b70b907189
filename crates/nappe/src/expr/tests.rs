use super::*;
use crate::breaks::{Breaks, Limit};
use crate::interval::Interval;
use crate::series::Series;
use proptest::prelude::*;

fn bound(text: &str) -> Bound {
    Expr::parse(text).unwrap().bind(&["t"], &[]).unwrap()
}

fn at(text: &str, t: f64) -> f64 {
    bound(text).value(&[t]).unwrap()
}

#[test]
fn operators_bind_as_in_mathematics() {
    for (text, want) in [
        ("1 + 2*3", 7.0),
        ("-2^2", -4.0),
        ("2^3^2", 512.0),
        ("2^-1", 0.5),
        ("(1+2)*3", 9.0),
        ("8/4/2", 1.0),
        ("8 - 4 - 2", 2.0),
        ("2*-3", -6.0),
        ("--3", 3.0),
        ("1 < 2", 1.0),
        ("1 + 1 >= 3", 0.0),
        ("if(1 > 2, 1/0, 5)", 5.0),
        ("1.5e2 + .5", 150.5),
        ("max(2, 3) + min(2, 3)", 5.0),
        ("floor(-1.5) + ceil(1.2)", 0.0),
        ("atan2(1, -1)*4/pi", 3.0),
        ("tau/pi", 2.0),
        ("ln(e^2)", 2.0),
        ("0^0", 1.0),
        ("abs(-3) != 3", 0.0),
        ("4^0.5", 2.0),
        ("(-8)^3", -512.0),
    ] {
        let got = at(text, 0.0);
        assert!((got - want).abs() < 1e-14, "{text} = {got}, not {want}");
    }
}

#[test]
fn errors_say_where_and_what() {
    let parse = |s: &str| Expr::parse(s).unwrap_err();
    let e = parse("2*sine(t)");
    assert_eq!(
        (e.span.clone(), e.to_string().as_str()),
        (2..6, "there is no function `sine`")
    );
    assert!(e.help().contains("`sin`"), "{}", e.help());
    let e = parse("1 + (2*t");
    assert_eq!(
        (e.span.clone(), e.kind.clone()),
        (4..5, ParseErrorKind::Unclosed)
    );
    let e = parse("2t");
    assert_eq!(e.span, 1..2);
    assert!(e.help().contains("2*t"), "{}", e.help());
    assert!(matches!(
        parse("sqrt(1, 2)").kind,
        ParseErrorKind::WrongCount {
            expected: 1,
            found: 2,
            ..
        }
    ));
    assert!(matches!(
        parse("max()").kind,
        ParseErrorKind::WrongCount {
            expected: 2,
            found: 0,
            ..
        }
    ));
    assert!(matches!(
        parse("0 < t < 1").kind,
        ParseErrorKind::ChainedComparison
    ));
    assert!(matches!(
        parse("t $ 2").kind,
        ParseErrorKind::BadCharacter('$')
    ));
    assert!(matches!(parse("1 +").kind, ParseErrorKind::Expected { .. }));
    assert!(matches!(parse("  ").kind, ParseErrorKind::Empty));
    assert!(matches!(
        parse("sin t").kind,
        ParseErrorKind::FunctionWithoutBrackets(_)
    ));
    assert!(matches!(
        parse("1e999").kind,
        ParseErrorKind::NumberTooLarge(_)
    ));
    assert!(matches!(
        parse(&"1+".repeat(3000)).kind,
        ParseErrorKind::TooLong(6000)
    ));
    for deep in ["(", "-", "2^", "sin(", "1+(", "if(1,"] {
        assert!(
            matches!(parse(&deep.repeat(700)).kind, ParseErrorKind::TooDeep),
            "{deep}"
        );
    }
    assert!(matches!(
        parse(&format!("1{}", "+1".repeat(300))).kind,
        ParseErrorKind::TooDeep
    ));
    let unknown = Expr::parse("radus*2 + zzz")
        .unwrap()
        .bind(&["t"], &[("radius", 2.0)])
        .unwrap_err();
    assert_eq!(unknown.len(), 2);
    assert_eq!(
        (unknown[0].near.as_deref(), unknown[0].span.clone()),
        (Some("radius"), 0..5)
    );
    assert!(unknown[1].near.is_none() && unknown[1].help().contains("radius"));
}

#[test]
fn the_deepest_expression_allowed_is_evaluated() {
    let deep = |n: usize| format!("{}t{}", "sin(".repeat(n), ")".repeat(n));
    let most = (1..MAX_DEPTH)
        .rev()
        .find(|&n| Expr::parse(&deep(n)).is_ok())
        .unwrap();
    assert!(most > MAX_DEPTH - 3);
    let b = bound(&deep(most));
    assert!(b.derivatives(&[0.5], Some(0), 8).is_ok());
    let enclosed = b.series(&[Series::variable(Interval::UNIT, 8)], 8).unwrap();
    assert!(enclosed.c[0].contains(b.value(&[0.5]).unwrap()));
}

#[test]
fn values_that_do_not_exist_are_located() {
    let e = bound("2 + 1/(t-0.5)").value(&[0.5]).unwrap_err();
    assert_eq!(e.to_string(), "division by zero at t = 0.5 in `1/(t-0.5)`");
    let fails = |text: &str, t: f64| bound(text).value(&[t]).unwrap_err().fault.kind;
    assert_eq!(fails("sqrt(t)", -4.0), FaultKind::RootOfNegative(-4.0));
    assert_eq!(fails("ln(t)", 0.0), FaultKind::LogOfNonPositive(0.0));
    assert_eq!(fails("acos(t)", 2.0), FaultKind::ArcOutOfRange(2.0));
    assert_eq!(fails("t^0.5", -1.0), FaultKind::PowerOfNegative(-1.0, 0.5));
    assert_eq!(fails("t^-1", 0.0), FaultKind::DivisionByZero(1.0));
    assert_eq!(fails("exp(t)", 1e4), FaultKind::Overflow);
    assert_eq!(fails("t*1e300*1e300", 1.0), FaultKind::Overflow);
    assert_eq!(fails("atan2(t, t)", 0.0), FaultKind::NoDirection);
    assert_eq!(fails("t^t", 0.0), FaultKind::LogOfNonPositive(0.0));
}

fn derivatives(text: &str, t: f64, order: usize) -> Vec<f64> {
    let mut d = vec![0.0; order + 1];
    bound(text)
        .derivatives(&[t], Some(0), order)
        .unwrap()
        .write_derivatives(&mut d);
    d
}

#[test]
fn derivatives_are_the_symbolic_ones() {
    // Each row: f and an expression for its derivative, all orders compared along the chain.
    for (f, slope) in [
        ("t^5", "5*t^4"),
        ("t^-2", "-2*t^-3"),
        ("t^2.5", "2.5*t^1.5"),
        ("sqrt(1+t^2)", "t/sqrt(1+t^2)"),
        ("sin(2*t)*cos(t)", "2*cos(2*t)*cos(t) - sin(2*t)*sin(t)"),
        ("exp(-t^2)", "-2*t*exp(-t^2)"),
        ("ln(1+t)", "1/(1+t)"),
        ("tan(t)", "1+tan(t)^2"),
        ("asin(t/2)", "0.5/sqrt(1-t^2/4)"),
        ("acos(t/2)", "-0.5/sqrt(1-t^2/4)"),
        ("atan(3*t)", "3/(1+9*t^2)"),
        ("atan2(sin(t), cos(t)-3)", "(1-3*cos(t))/(10-6*cos(t))"),
        ("sinh(t)", "cosh(t)"),
        ("cosh(t)", "sinh(t)"),
        ("tanh(t)", "1-tanh(t)^2"),
        ("t^t", "t^t*(1+ln(t))"),
        ("2^t", "ln(2)*2^t"),
        ("abs(t-3)", "-1+0*t"),
        ("if(t < 2, t^2, t)", "2*t"),
        ("1/(1+t)", "-1/(1+t)^2"),
        ("max(t, t^3) + min(t, t^3)", "1 + 3*t^2"),
    ] {
        let (a, b) = (derivatives(f, 0.7, 6), derivatives(slope, 0.7, 5));
        for k in 0..6 {
            let (got, want) = (a[k + 1], b[k]);
            assert!(
                (got - want).abs() <= 1e-12 * want.abs().max(1.0),
                "{f}, order {}: {got} {want}",
                k + 1
            );
        }
    }
}

#[test]
fn powers_are_exact_at_zero() {
    assert_eq!(derivatives("t^3", 0.0, 4), [0.0, 0.0, 0.0, 6.0, 0.0]);
    assert_eq!(derivatives("t^1.5", 0.0, 1), [0.0, 0.0]);
    let enclosed = bound("t^1.5")
        .series(&[Series::variable(Interval::new(0.0, 0.25), 2)], 2)
        .unwrap();
    assert!(enclosed.c[0].encloses(Interval::new(0.0, 0.125)) && enclosed.c[0].hi < 0.1251);
    assert!(enclosed.c[1].is_finite() && !enclosed.c[2].is_finite());
}

fn function(text: &str, lo: f64, hi: f64) -> Result<Function, FunctionError> {
    Function::new(bound(text), [lo, hi])
}

#[test]
fn breaks_are_found_to_the_double() {
    for (text, want) in [
        ("abs(t-0.5)", vec![(0.5, 0)]),
        ("abs(t-0.3)", vec![(0.3, 0)]),
        ("abs(t-0.3)*(t-0.3)", vec![(0.3, 1)]),
        ("max(t-0.3, 0)^3", vec![(0.3, 2)]),
        ("if(t < 0.25, 1, t)", vec![(0.25, -1)]),
        (
            "floor(3*t + 0.5)",
            vec![(0.5 / 3.0, -1), (0.5, -1), (2.5 / 3.0, -1)],
        ),
        ("min(t, 1-t) + abs(t - 0.75)", vec![(0.5, 0), (0.75, 0)]),
        ("abs((t-0.4)^2)", vec![]),
        ("abs(abs(t-0.5)-0.25)", vec![(0.25, 0), (0.5, 0), (0.75, 0)]),
        (
            "if(t <= 0.5, if(t < 0.1, 0, t), 1-t)",
            vec![(0.1, -1), (0.5, 0)],
        ),
        ("sin(t)", vec![]),
        ("atan2(sin(tau*t), cos(tau*t))", vec![(0.5, -1)]),
    ] {
        let f = function(text, 0.0, 1.0).unwrap_or_else(|e| panic!("{text}: {e}"));
        let found: Vec<_> = f.breaks()[1..f.breaks().len() - 1]
            .iter()
            .filter(|b| b.smooth < 8)
            .collect();
        assert_eq!(found.len(), want.len(), "{text}: {found:?}");
        for (b, (t, smooth)) in found.iter().zip(want) {
            assert!(
                (b.at - t).abs() <= 2e-16 && b.smooth == smooth,
                "{text}: {b:?}, not {t} {smooth}"
            );
        }
    }
}

#[test]
fn one_sided_limits_follow_the_pieces() {
    let f = function("abs(t-0.3)", 0.0, 1.0).unwrap();
    let at = f.breaks()[1].at;
    let mut d = [0.0; 2];
    f.jet_into(at, Limit::Below, &mut d);
    assert_eq!(d[1], -1.0);
    f.jet_into(at, Limit::Above, &mut d);
    assert_eq!(d[1], 1.0);
    let mut e = [Interval::ENTIRE; 3];
    f.enclose_piece(Interval::new(at, 1.0), Limit::Above, &mut e);
    assert_eq!((e[1], e[2]), (Interval::ONE, Interval::ZERO));
}

#[test]
fn functions_are_finite_or_refused() {
    for text in [
        "t^2",
        "exp(t)*sin(9*t)",
        "1/(1.0001-t)",
        "if(t > 0.5, 1/t, t)",
        "sqrt(t+1e-9)",
        "t^1.5",
        "sin(1/(t+0.01))",
    ] {
        let f = function(text, 0.0, 1.0).unwrap_or_else(|e| panic!("{text}: {e}"));
        assert_eq!(f.finding(), Finding::Proven, "{text}");
    }
    for (text, t, part) in [
        ("1/(t-0.5)", 0.5, "1/(t-0.5)"),
        ("3 + 1/(t-0.3)", 0.3, "1/(t-0.3)"),
        ("1/(t^2-0.5)", 0.5f64.sqrt(), "1/(t^2-0.5)"),
        ("1/(t-1/3)^2", 1.0 / 3.0, "1/(t-1/3)^2"),
        ("sin(t)/t", 0.0, "sin(t)/t"),
        ("tan(2*t)", std::f64::consts::FRAC_PI_4, "tan(2*t)"),
        ("ln(t)", 0.0, "ln(t)"),
        ("sqrt(1-t)", 1.0, "sqrt(1-t)"),
    ] {
        let Err(FunctionError::Value(e)) = function(text, 0.0, 1.0) else {
            panic!("{text} is accepted")
        };
        assert!((e.at[0].1 - t).abs() < 1e-14, "{text}: {e}");
        assert_eq!(e.part, part, "{text}");
    }
    assert!(matches!(
        function("sqrt(t-0.5)", 0.0, 1.0),
        Err(FunctionError::Value(_))
    ));
    assert!(matches!(
        function("t", 1.0, 1.0),
        Err(FunctionError::Domain(..))
    ));
    assert!(matches!(
        function("t", 0.0, f64::NAN),
        Err(FunctionError::Domain(..))
    ));
}

/// Texts of random expressions, fully bracketed.
fn any_expression() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        Just("t".to_owned()),
        Just("pi".to_owned()),
        (0.0f64..4.0).prop_map(|x| format!("{x:?}")),
        (0u32..5).prop_map(|x| x.to_string()),
    ];
    leaf.prop_recursive(5, 40, 3, |inner| {
        let sign = prop::sample::select(vec!["+", "-", "*", "/", "<", "<=", ">=", "=="]);
        let call = prop::sample::select(TABLE.map(|x| (x.0, x.2)).to_vec());
        prop_oneof![
            3 => (inner.clone(), sign, inner.clone()).prop_map(|(a, s, b)| format!("({a}{s}{b})")),
            1 => inner.clone().prop_map(|a| format!("(-{a})")),
            1 => (inner.clone(), -3i32..5).prop_map(|(a, n)| format!("({a})^({n})")),
            1 => (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a})^({b})")),
            3 => (call, inner.clone(), inner.clone()).prop_map(|((f, n), a, b)| {
                if n == 1 { format!("{f}({a})") } else { format!("{f}({a}, {b})") }
            }),
            1 => (inner.clone(), inner.clone(), inner).prop_map(|(c, a, b)| format!("if({c}, {a}, {b})")),
        ]
    })
}

/// True if `x` is in the interval up to the rounding of x itself: a slip relative to the terms that make it up.
fn holds(i: Interval, x: f64, slip: f64) -> bool {
    i.inflate(slip).contains(x)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn printed_expressions_parse_to_themselves(text in any_expression()) {
        let e = Expr::parse(&text).unwrap();
        let printed = e.to_string();
        let again = Expr::parse(&printed).unwrap();
        prop_assert!(e.same(&again), "{text} -> {printed}");
    }

    #[test]
    fn any_text_is_parsed_or_refused(text in "\\PC{0,60}") {
        let _ = Expr::parse(&text);
    }

    #[test]
    fn any_near_expression_is_parsed_or_refused(text in "[-+*/^(),.<>=! 0-9etsinqrtax]{0,60}") {
        if let Ok(e) = Expr::parse(&text) && let Ok(b) = e.bind(&["t"], &[]) {
            let _ = b.value(&[0.5]);
            let _ = b.series(&[Series::variable(Interval::UNIT, 3)], 3);
        }
    }

    /// What an enclosure says of a range holds at each number in it, and a value never is a NaN.
    #[test]
    fn enclosures_contain_values_and_derivatives(text in any_expression(), lo in -2.0f64..2.0, w in 0.0f64..1.0, s in 0.0f64..=1.0) {
        let b = bound(&text);
        let t = (lo + w * w * w * s).clamp(lo, lo + w * w * w);
        let range = Interval::new(lo, lo + w * w * w);
        let Ok(value) = b.derivatives(&[t], Some(0), 2) else { return Ok(()) };
        prop_assert!(value.c[0].is_finite());
        let enclosed = b.series(&[Series::variable(range, 2)], 2);
        let enclosed = enclosed.map_err(|f| TestCaseError::fail(format!("{text}: {f:?} on {range:?}, but {value:?}")))?;
        // At a point the enclosure of the exact value bounds the rounding error of the double too.
        let exact = b.series(&[Series::variable(Interval::point(t), 2)], 2);
        for k in 0..3 {
            let Ok(exact) = &exact else { continue };
            let slip = exact.c[k].width() * 4.0 + exact.c[k].mag() * 1e-14 + 1e-300;
            if value.c[k].is_finite() && slip.is_finite() {
                prop_assert!(holds(enclosed.c[k], value.c[k], slip), "{text} order {k}: {} not in {:?}", value.c[k], enclosed.c[k]);
                prop_assert!(enclosed.c[k].inflate(slip).encloses(exact.c[k]), "{text}: not monotone");
            }
        }
    }

    /// A function that is accepted is finite, inside its enclosures, and equal to the value of the expression.
    #[test]
    fn accepted_functions_are_finite(text in any_expression(), s in 0.0f64..=1.0) {
        let Ok(f) = function(&text, 0.0, 1.0) else { return Ok(()) };
        prop_assert!(f.breaks().windows(2).all(|w| w[0].at < w[1].at), "{text}: {:?}", f.breaks());
        let mut d = [0.0; 2];
        f.jet_into(s, Limit::Above, &mut d);
        if f.finding() == Finding::Proven {
            prop_assert!(d[0].is_finite() && d[1].is_finite(), "{text} at {s}: {d:?}");
        }
        let mut e = [Interval::ENTIRE; 2];
        let piece = f.breaks().piece(f.breaks().find(s, Limit::Above));
        f.enclose_piece(piece, Limit::Above, &mut e);
        prop_assert!(holds(e[0], d[0], 1e-12 * (1.0 + d[0].abs())), "{text} at {s}: {} not in {:?}", d[0], e[0]);
    }
}
