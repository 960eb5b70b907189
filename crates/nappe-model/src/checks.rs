//! Declared checks: two sides and how smoothly they are claimed to meet.

use crate::build::Builder;
use crate::data::{Datum, Fields, SideName};
use crate::decode::Decoder;
use crate::diagnostics::Diagnostic;
use crate::registry::CHECK;
use crate::value::{Node, Span, Value};
use nappe::surface::{Side, SurfaceRef};
use std::ops::Range;

/// How smoothly two surfaces meet.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
pub enum Continuity {
    /// They meet.
    G0,
    /// Their normals agree too.
    G1,
    /// Their curvatures agree too.
    G2,
}

impl Continuity {
    /// G0, G1 or G2.
    pub fn name(self) -> &'static str {
        match self {
            Continuity::G0 => "G0",
            Continuity::G1 => "G1",
            Continuity::G2 => "G2",
        }
    }
}

/// How far from perfect a check lets two sides be.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum CheckTolerance {
    /// Of G0: a distance in the model's units.
    Length(f64),
    /// Of G1: an angle between normals in radians.
    Angle(f64),
    /// Of G2: a difference of curvatures relative to the larger.
    Relative(f64),
}

/// One side of a check.
#[derive(Clone, Debug)]
pub struct CheckSide {
    /// The surface's name.
    pub surface: String,
    /// Its side.
    pub side: Side,
    /// The surface.
    pub geometry: SurfaceRef,
}

/// A declared check.
#[derive(Clone, Debug)]
pub struct Check {
    /// The two sides.
    pub between: [CheckSide; 2],
    /// What is claimed.
    pub continuity: Continuity,
    /// How far it may be missed.
    pub tolerance: CheckTolerance,
    /// Whether it is about what both sides have in common, however short: else one must lie on the other from end to end.
    pub in_part: bool,
    /// Where in the file it stands.
    pub place: Range<usize>,
}

/// A check as written.
#[derive(Debug)]
pub(crate) struct Written {
    label: String,
    span: Span,
    between: [(SideName, Span); 2],
    continuity: Continuity,
    tolerance: CheckTolerance,
    in_part: bool,
}

/// Reads the list of checks.
pub(crate) fn read(decoder: &mut Decoder<'_>, node: &Node) -> Vec<Written> {
    let Value::List(list) = &node.value else {
        decoder.diags.push(
            Diagnostic::new(
                "shape",
                format!(
                    "`checks`: expected [[checks]] tables, found {}",
                    node.describe()
                ),
            )
            .at(node.span.clone(), "not a list of tables")
            .help("write [[checks]] before each check"),
        );
        return Vec::new();
    };
    list.iter()
        .enumerate()
        .filter_map(|(i, n)| one(decoder, i, n))
        .collect()
}

fn one(decoder: &mut Decoder<'_>, index: usize, node: &Node) -> Option<Written> {
    let label = format!("check {}", index + 1);
    let Value::Table(table) = &node.value else {
        decoder.diags.push(
            Diagnostic::new(
                "shape",
                format!("{label}: expected a table, found {}", node.describe()),
            )
            .at(node.span.clone(), "not a table")
            .help("write [[checks]] and its keys"),
        );
        return None;
    };
    let f = decoder
        .fields(&label, "", &node.span, table, CHECK, &[], "")
        .ok()?;
    let continuity = match f.text("continuity")? {
        "G0" => Continuity::G0,
        "G1" => Continuity::G1,
        _ => Continuity::G2,
    };
    let tolerance = tolerance(decoder, &label, &f, continuity)?;
    let sides: Vec<(SideName, Span)> = f
        .list("between")?
        .iter()
        .filter_map(|i| match &i.datum {
            Datum::Side(s) => Some((s.clone(), i.span.clone())),
            _ => None,
        })
        .collect();
    let between = <[(SideName, Span); 2]>::try_from(sides).ok()?;
    Some(Written {
        label,
        span: node.span.clone(),
        between,
        continuity,
        tolerance,
        in_part: f.flag("in_part"),
    })
}

/// The tolerance in the unit that the continuity asks for.
fn tolerance(
    decoder: &mut Decoder<'_>,
    label: &str,
    f: &Fields,
    continuity: Continuity,
) -> Option<CheckTolerance> {
    let item = f.get("tolerance")?;
    let wrong = |message: String, help: &str| {
        Diagnostic::new("value", format!("{label}, `tolerance`: {message}"))
            .at(item.span.clone(), continuity.name())
            .help(help)
    };
    let result = match (continuity, &item.datum) {
        (Continuity::G1, Datum::Angle(x)) => Ok(CheckTolerance::Angle(*x)),
        (Continuity::G1, Datum::Number(x)) => Err(wrong(
            format!("G1 compares angles; {x} has no unit"),
            "write an angle such as \"0.1deg\"",
        )),
        (Continuity::G0, Datum::Number(x)) => Ok(CheckTolerance::Length(*x)),
        (Continuity::G2, Datum::Number(x)) => Ok(CheckTolerance::Relative(*x)),
        (Continuity::G1, _) => Err(wrong(
            "G1 compares angles".into(),
            "write an angle such as \"0.1deg\"",
        )),
        (Continuity::G0, _) => Err(wrong(
            "G0 compares places; an angle is given".into(),
            "write a length",
        )),
        (Continuity::G2, _) => Err(wrong(
            "G2 compares curvatures; an angle is given".into(),
            "write a relative difference such as 0.01",
        )),
    };
    match result {
        Ok(t) => {
            let (CheckTolerance::Angle(x)
            | CheckTolerance::Length(x)
            | CheckTolerance::Relative(x)) = t;
            if x >= 0.0 {
                return Some(t);
            }
            decoder.diags.push(wrong(
                "it is negative".into(),
                "write a number that is not negative",
            ));
            None
        }
        Err(d) => {
            decoder.diags.push(d);
            None
        }
    }
}

/// Finds the surfaces of a check.
pub(crate) fn resolve(builder: &mut Builder<'_>, w: &Written) -> Option<Check> {
    let label = format!("{}, `between`", w.label);
    let mut side = |(name, span): &(SideName, Span)| {
        let geometry = builder.surface(&name.surface, &label, span).ok()?;
        Some(CheckSide {
            surface: name.surface.clone(),
            side: name.side,
            geometry,
        })
    };
    let (a, b) = (side(&w.between[0]), side(&w.between[1]));
    Some(Check {
        between: [a?, b?],
        continuity: w.continuity,
        tolerance: w.tolerance,
        in_part: w.in_part,
        place: w.span.clone(),
    })
}
