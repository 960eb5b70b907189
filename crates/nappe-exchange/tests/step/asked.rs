//! Files of a few lines that ask for very much.

use crate::meant::file;
use nappe_exchange::step;

#[test]
fn a_degree_beyond_all_is_refused_before_its_knots_are_made() {
    for degree in [65u64, 4_000_000_000] {
        let half = degree.div_ceil(2) + 1;
        let other = degree + 3 - half;
        let text = file(&format!(
            "#1=SHAPE_REPRESENTATION('',(#2),#9);\n\
             #2=B_SPLINE_CURVE_WITH_KNOTS('',{degree},(#3,#4),.UNSPECIFIED.,.F.,.F.,({half},{other}),(0.,1.),.UNSPECIFIED.);\n\
             #3=CARTESIAN_POINT('',(0.,0.,0.));\n#4=CARTESIAN_POINT('',(1.,0.,0.));\n#9=CONTEXT();"
        ));
        let d = step::read(text.as_bytes()).unwrap().document;
        assert!(d.items.is_empty());
        assert!(
            d.left_out.iter().any(|l| l.why.contains("its degree is")),
            "{:?}",
            d.left_out
        );
    }
}

#[test]
fn copies_of_copies_end_with_what_a_file_may_ask_for() {
    let mut data = String::from(
        "#1=CARTESIAN_POINT('',(0.,0.,0.));\n#2=AXIS2_PLACEMENT_3D('',#1,$,$);\n#3=CARTESIAN_POINT('',(1.,0.,0.));\n\
         #4=GEOMETRIC_SET('',(#5));\n#5=POLYLINE('',(#1,#3,#1,#3,#1,#3,#1,#3,#1,#3));\n#9=CONTEXT();\n",
    );
    for i in 0..22 {
        let (own, next) = (100 + 10 * i, 110 + 10 * i);
        data += &format!(
            "#{own}=SHAPE_REPRESENTATION('',(#{},#{}),#9);\n#{}=REPRESENTATION_MAP(#2,#{next});\n#{}=MAPPED_ITEM('',#{},#2);\n#{}=MAPPED_ITEM('',#{},#2);\n",
            own + 1,
            own + 2,
            own + 3,
            own + 1,
            own + 3,
            own + 2,
            own + 3
        );
    }
    data += "#320=SHAPE_REPRESENTATION('',(#4),#9);";
    let d = step::read(file(&data).as_bytes()).unwrap().document;
    // All would be four million.
    assert!(
        (1000..300_000).contains(&d.items.len()),
        "{}",
        d.items.len()
    );
    assert!(
        d.left_out.iter().any(|l| l.why.contains("so often")),
        "{:?}",
        d.left_out
    );
}
