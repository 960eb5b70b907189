//! Files that need no reader, and what is said of those that are named wrongly.

use nappe::curve::{CurveRef, Line};
use nappe::surface::{SurfaceRef, bilinear};
use nappe::{DVec3, Units};
use nappe_model::{Imported, ImportedCurve, ImportedFace, Importer, Overrides};
use std::sync::Arc;

/// Files whose ending is their unit: two rods and two plates each, of which the second is trimmed and looks down.
#[derive(Debug)]
pub(crate) struct Files;

impl Importer for Files {
    fn import(&self, file: &str) -> Result<Arc<Imported>, String> {
        let (_, unit) = file.split_once('.').unwrap_or_default();
        let units = Units::from_symbol(unit).ok_or_else(|| format!("{file}: no such file"))?;
        let rod = |end| -> CurveRef { Arc::new(Line::new(DVec3::ZERO, end).expect("a line")) };
        let corner = |i: u8, j: u8| DVec3::new(f64::from(i), 2.0 * f64::from(j), 0.0);
        let plate = bilinear([0, 1].map(|i| [0, 1].map(|j| corner(i, j)))).expect("a plate");
        let plate: SurfaceRef = Arc::new(plate);
        let face = |name: &str, whole| ImportedFace {
            name: name.into(),
            surface: plate.clone(),
            forward: whole,
            whole,
        };
        let curve = |name: &str, curve| ImportedCurve {
            name: name.into(),
            curve,
        };
        Ok(Arc::new(Imported {
            units,
            faces: vec![face("part/whole", true), face("part/cut", false)],
            curves: vec![
                curve("short", rod(2.0 * DVec3::X)),
                curve("", rod(3.0 * DVec3::Y)),
            ],
        }))
    }
}

fn refused(keys: &str) -> String {
    let text = format!("nappe = 1\n[surfaces.it]\nkind = 'import'\n{keys}");
    let read = nappe_model::parse_with(&text, "t", &Overrides::default(), Arc::new(Files));
    read.expect_err("a fault").to_string()
}

#[test]
fn what_cannot_be_imported_is_told() {
    for (keys, said) in [
        ("file = 'plates.xyz'", "plates.xyz: no such file"),
        (
            "file = 'plates.mm'",
            "plates.mm holds 2 faces; which is meant?",
        ),
        (
            "file = 'plates.mm'\nface = 3",
            "plates.mm has no face 3: it holds 2",
        ),
        ("file = 'plates.mm'\nface = 0", "whole number from 1"),
        (
            "file = 'plates.mm'\nface = 'hull'",
            "plates.mm has no face \"hull\"",
        ),
        (
            "file = 'plates.mm'\nface = 'hull'",
            "1 \"part/whole\", 2 \"part/cut\"",
        ),
        (
            "file = 'plates.mm'\nface = 'cut'",
            "the face is a part of its surface",
        ),
        ("file = 'plates.mm'\nface = 'cut'", "untrimmed = true"),
        ("face = 1", "`file`"),
    ] {
        let text = refused(keys);
        assert!(text.contains(said), "{keys}: {text}");
    }
    let text = "nappe = 1\n[surfaces.it]\nkind = 'import'\nfile = 'plates.mm'\nface = 1";
    let alone = nappe_model::parse(text, "t", &Overrides::default());
    let alone = alone.expect_err("nothing reads files").to_string();
    assert!(alone.contains("are not read here"), "{alone}");
}

/// What a file holds does not move, whatever else has the same name.
#[test]
fn imports_stay_where_they_are() {
    let text = "nappe = 1\n[params]\nr = 1\n[surfaces.whole]\nkind = 'import'\nfile = 'plates.mm'\nface = 'whole'\n\
                [surfaces.far]\nkind = 'transform'\nsurface = 'whole'\ntranslate = ['r', 0, 0]";
    let none = Overrides::default();
    let model = nappe_model::parse_with(text, "t", &none, Arc::new(Files)).expect("a model");
    let moved = nappe_model::velocities(&model, &none, "r").expect("velocities");
    assert!(matches!(moved.surfaces[0], nappe_model::Velocity::Still));
    let nappe_model::Velocity::Moves(v) = &moved.surfaces[1] else {
        panic!("{:?}", moved.surfaces[1]);
    };
    assert_eq!(v.point([0.3, 0.7]), DVec3::X);
}
