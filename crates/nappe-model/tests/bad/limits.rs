//! Limits.

use crate::faults;
use nappe_model::{Overrides, parse};

#[test]
fn limits_are_said() {
    let mut many = String::from("nappe = 1\n[params]\n");
    for i in 0..=nappe_model::MAX_PARAMETERS {
        many += &format!("p{i} = {i}\n");
    }
    assert!(faults(&many).to_string().contains("at most 2000"));
    let mut deep =
        String::from("nappe = 1\n[curves.c0]\nkind = 'line'\nfrom = [0,0,0]\nto = [1,0,0]\n");
    for i in 1..500 {
        deep = format!(
            "{deep}[curves.c{i}]\nkind = 'reverse'\ncurve = 'c{}'\n",
            i + 1
        );
    }
    deep += "[curves.c500]\nkind = 'reverse'\ncurve = 'c0'\n";
    assert!(faults(&deep).to_string().contains("nested deeper than 64"));
    let mut joined = String::from("nappe = 1\n[curves]\nc0 = { kind = 'circle', radius = 1 }\n");
    for i in 0..40 {
        joined += &format!(
            "c{} = {{ kind = 'join', curves = ['c{i}', 'c{i}'] }}\n",
            i + 1
        );
    }
    assert!(
        faults(&joined)
            .to_string()
            .contains("at most 65536 can be joined")
    );
    let nested = format!(
        "nappe = 1\n[curves]\na = {}1{}",
        "[".repeat(5000),
        "]".repeat(5000)
    );
    assert!(faults(&nested).has_errors());
    let chain: String = (0..1999)
        .map(|i| format!("p{i} = 'p{}'\n", i + 1))
        .collect();
    let model = parse(
        &format!("nappe = 1\n[params]\n{chain}p1999 = 7\n"),
        "f",
        &Overrides::default(),
    )
    .unwrap();
    assert!(model.params.iter().all(|p| p.value == 7.0));
}

#[test]
fn of_very_many_faults_the_first_are_listed_and_the_others_counted() {
    let list = vec!["'x'"; 5000].join(", ");
    let d = faults(&format!(
        "nappe = 1\n[curves.c]\nkind = 'nurbs'\ndegree = 1\npoints = [[0,0,0],[1,0,0]]\nknots = [{list}]\n"
    ));
    assert_eq!((d.list.len(), d.unlisted), (200, 4800));
    assert_eq!(d.summary(), "200 errors; 4800 more are not listed");
}

#[test]
fn messages_do_not_repeat_very_long_names() {
    let name = "x".repeat(100_000);
    let d = faults(&format!("nappe = 1\n{name} = 1\n"));
    assert!(d.to_string().len() < 3000, "{}", d.to_string().len());
}
