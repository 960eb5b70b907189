//! What is wrong in a file is told with its place.

use crate::{sewn, wave, written};
use nappe::{DVec3, Units};
use nappe_exchange::ItemForm;
use nappe_exchange::step::{self, Schema, StepError};

fn text() -> String {
    let document = sewn(&[wave(4, 4, DVec3::ZERO, 1.0)], Units::Millimetre);
    String::from_utf8(written(&document, Schema::Ap242)).unwrap()
}

fn refused(text: &str) -> StepError {
    step::read(text.as_bytes()).unwrap_err()
}

#[test]
fn other_files_and_cut_off_files_are_told() {
    assert!(matches!(
        refused("solid a"),
        StepError::NotStep { line: 1, .. }
    ));
    assert!(matches!(refused(""), StepError::NotStep { .. }));
    let whole = text();
    // Wherever it is cut off, but for the last line's end.
    for at in (20..whole.trim_end().len()).step_by(37) {
        let e = refused(&whole[..at]);
        assert!(
            matches!(e, StepError::CutOff { .. } | StepError::Syntax { .. }),
            "{at}: {e}"
        );
    }
    let e = refused("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=A('abc);\n/* ");
    assert_eq!(
        e,
        StepError::CutOff {
            line: 5,
            what: "a text"
        }
    );
    let none = "ISO-10303-21;\nHEADER;\nENDSEC;\nEND-ISO-10303-21;\n";
    assert_eq!(refused(none), StepError::NoData);
}

#[test]
fn numbers_that_are_there_twice_or_too_large_are_told() {
    let file = |data: &str| {
        format!("ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n{data}\nENDSEC;\nEND-ISO-10303-21;\n")
    };
    let e = refused(&file("#7=A();\n#8=A();\n#7=B();"));
    assert_eq!(
        e,
        StepError::Twice {
            id: 7,
            lines: [5, 7]
        }
    );
    let e = refused(&file(
        "#18446744073709551615=A();\n#18446744073709551615=A();",
    ));
    assert!(matches!(e, StepError::Twice { .. }));
    let e = refused(&file("#99999999999999999999999=A();"));
    assert!(matches!(e, StepError::Number { line: 5, .. }));
    let e = refused(&file("#1 A();"));
    assert!(matches!(e, StepError::Syntax { line: 5, .. }));
}

#[test]
fn a_missing_or_broken_entity_loses_its_face_only() {
    let whole = text();
    let line = whole
        .lines()
        .find(|l| l.contains("=CARTESIAN_POINT("))
        .unwrap();
    for broken in [
        "",
        &line.replace("CARTESIAN_POINT", "DIRECTION"),
        &line.replace("(0.", "(0.,,"),
    ] {
        if broken == line {
            continue;
        }
        let file = step::read(whole.replacen(line, broken, 1).as_bytes()).unwrap();
        assert!(!file.document.left_out.is_empty(), "{broken}");
        let faces = file
            .document
            .items
            .iter()
            .filter(|i| matches!(i.form, ItemForm::Body { .. }));
        assert_eq!(faces.count(), 0);
    }
}

#[test]
fn lists_without_end_and_circles_of_references_are_refused() {
    let file = |data: &str| {
        format!(
            "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n#1=SHAPE_REPRESENTATION('',(#2),#9);\n{data}\nENDSEC;\nEND-ISO-10303-21;\n"
        )
    };
    for data in [
        format!("#2=TRIMMED_CURVE('',{}#2{},#2,#2,.T.,.T.);", "(".repeat(100_000), ")".repeat(100_000)),
        "#2=TRIMMED_CURVE('',#2,(#2),(#2),.T.,.CARTESIAN.);".into(),
        "#2=MAPPED_ITEM('',#3,#4);\n#3=REPRESENTATION_MAP(#4,#1);\n#4=AXIS2_PLACEMENT_3D('',#5,$,$);\n#5=CARTESIAN_POINT('',(0.,0.,0.));\n#6=SHAPE_REPRESENTATION('',(#2),#9);".into(),
        "#2=SHELL_BASED_SURFACE_MODEL('',(#3));\n#3=ORIENTED_OPEN_SHELL('',*,#4,.T.);\n#4=ORIENTED_CLOSED_SHELL('',*,#3,.T.);".into(),
        "#2=COMPOSITE_CURVE('',(#3,#3,#3),.F.);\n#3=COMPOSITE_CURVE_SEGMENT(.CONTINUOUS.,.T.,#2);".into(),
    ] {
        let read = step::read(file(&data).as_bytes()).unwrap();
        assert!(!read.document.left_out.is_empty(), "{}", &data[..60]);
    }
}
