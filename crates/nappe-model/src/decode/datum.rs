//! Single values by their shapes.

use super::{Decoded, Decoder};
use crate::data::{CurveSource, Datum, Item, SideName};
use crate::diagnostics::Diagnostic;
use crate::params::{self, Broken, Subject};
use crate::registry::Shape;
use crate::value::{Node, Value};
use nappe::expr::{Bound, nearest};
use nappe::surface::Side;
use nappe::{DVec3, LARGEST_LENGTH};
use std::f64::consts::{PI, TAU};

impl Decoder<'_> {
    /// Reads a value by its shape.
    pub(crate) fn datum(
        &mut self,
        subject: Subject<'_>,
        node: &Node,
        shape: &Shape,
    ) -> Decoded<Datum> {
        match (shape, &node.value) {
            (Shape::Number, Value::Number(_) | Value::Text { .. }) => self
                .scope
                .number(node, subject, self.diags)
                .map(Datum::Number),
            (Shape::Count(least), Value::Number(_) | Value::Text { .. }) => {
                let x = self.scope.number(node, subject, self.diags)?;
                if self.scope.reads_rates() {
                    return self.fixed(subject, node, x).map(Datum::Number);
                }
                if x.fract() == 0.0 && x >= f64::from(*least) && x <= f64::from(u32::MAX) {
                    return Ok(Datum::Number(x));
                }
                self.diags.push(
                    Diagnostic::new(
                        "value",
                        subject.say(format!("expected a whole number from {least}, found {x}")),
                    )
                    .at(node.span.clone(), "not a whole number in range")
                    .help(format!("write a whole number from {least}")),
                );
                Err(Broken)
            }
            (Shape::Angle, _) => self.angle(subject, node).map(Datum::Angle),
            (Shape::Bool, Value::Bool(b)) => Ok(Datum::Bool(*b)),
            (Shape::Text | Shape::Surface, Value::Text { text, .. }) => {
                Ok(Datum::Text(text.clone()))
            }
            (Shape::Vector, Value::List(list)) => {
                self.vector(subject, node, list).map(Datum::Vector)
            }
            (Shape::Choice(words), Value::Text { text, .. }) => {
                self.choice(subject, node, text, words)
            }
            (Shape::Formula(variables), Value::Text { text, .. }) => {
                let e = params::parse(text, 0, node, subject, self.diags)?;
                let formula = self
                    .scope
                    .bind(&e, 0, variables, node, subject, self.diags)?;
                if self.scope.reads_rates() {
                    return self.rate(subject, node, &formula).map(Datum::Formula);
                }
                Ok(Datum::Formula(formula))
            }
            (Shape::Formula(variables), Value::Number(_)) if self.scope.reads_rates() => {
                let variable = variables.first().copied().unwrap_or("t");
                Ok(Datum::Formula(Bound::constant(0.0, variable)))
            }
            (Shape::Formula(variables), Value::Number(x)) => {
                let x = self.scope.number(
                    &Node {
                        value: Value::Number(*x),
                        ..node.clone()
                    },
                    subject,
                    self.diags,
                )?;
                let text = if x < 0.0 {
                    format!("-{:?}", -x)
                } else {
                    format!("{x:?}")
                };
                let e = params::parse(&text, 0, node, subject, self.diags)?;
                self.scope
                    .bind(&e, 0, variables, node, subject, self.diags)
                    .map(Datum::Formula)
            }
            (Shape::Curve, Value::Text { text, .. }) => {
                Ok(Datum::Curve(match text.contains('.') {
                    true => CurveSource::Side(self.side(subject, node, text)?),
                    false => CurveSource::Named(text.clone()),
                }))
            }
            (Shape::Curve, Value::Table(_)) => {
                let label = format!("{}, `{}`", subject.object, subject.key);
                let object = self.object(&label, &node.span, node, crate::registry::CURVES)?;
                Ok(Datum::Curve(CurveSource::Inline(Box::new(object))))
            }
            (Shape::Side, Value::Text { text, .. }) => {
                self.side(subject, node, text).map(Datum::Side)
            }
            (Shape::List(item, length), Value::List(list)) => {
                if length.is_some_and(|n| n != list.len()) {
                    self.wrong(subject, node, shape);
                    return Err(Broken);
                }
                self.list(subject, list, item).map(Datum::List)
            }
            (Shape::Grid(item, size), Value::List(rows)) => {
                self.grid(subject, node, rows, item, *size, shape)
            }
            (Shape::Record(keys), Value::Table(t)) => {
                let what = format!("`{}`", subject.key);
                let fields =
                    self.fields(subject.object, subject.key, &node.span, t, keys, &[], &what)?;
                Ok(Datum::Record(fields))
            }
            (Shape::Either(shapes), _) => match pick(shapes, node) {
                Some(s) => self.datum(subject, node, s),
                None => {
                    self.wrong(subject, node, shape);
                    Err(Broken)
                }
            },
            _ => {
                self.wrong(subject, node, shape);
                Err(Broken)
            }
        }
    }

    /// The rate of a number that may not change.
    fn fixed(&mut self, subject: Subject<'_>, node: &Node, rate: f64) -> Decoded<f64> {
        if rate == 0.0 {
            return Ok(0.0);
        }
        self.diags.push(
            Diagnostic::new("kink", subject.say("a whole number has no derivative"))
                .at(node.span.clone(), "changes with the parameter")
                .help("choose a parameter on which it does not depend"),
        );
        Err(Broken)
    }

    /// The derivative of a formula.
    fn rate(&mut self, subject: Subject<'_>, node: &Node, formula: &Bound) -> Decoded<Bound> {
        let changing = self.scope.changing();
        let rates: Vec<(&str, f64)> = changing
            .iter()
            .map(|(name, [_, rate])| (*name, *rate))
            .collect();
        formula.rate(&rates).map_err(|place| {
            let message =
                "where this changes its formula depends on the parameter: no derivative there";
            self.diags.push(
                Diagnostic::new("kink", subject.say(message))
                    .at(node.place(&place), "moves along the variable")
                    .help("choose a parameter on which the condition does not depend"),
            );
            Broken
        })
    }

    fn choice(
        &mut self,
        subject: Subject<'_>,
        node: &Node,
        text: &str,
        words: &[&str],
    ) -> Decoded<Datum> {
        if words.contains(&text) {
            return Ok(Datum::Text(text.into()));
        }
        let help = match nearest(text, words.iter().copied()) {
            Some(n) => format!("did you mean \"{n}\"?"),
            None => format!("it is one of {}", words.join(", ")),
        };
        self.diags.push(
            Diagnostic::new(
                "value",
                subject.say(format!("\"{text}\" is not one of {}", words.join(", "))),
            )
            .at(node.span.clone(), "unknown word")
            .help(help),
        );
        Err(Broken)
    }

    fn list(&mut self, subject: Subject<'_>, list: &[Node], item: &Shape) -> Decoded<Vec<Item>> {
        // All entries are read, so that all faults are reported.
        let items: Vec<Decoded<Item>> = list
            .iter()
            .enumerate()
            .map(|(i, n)| {
                let datum = match plain(n, item, self.scope.reads_rates()) {
                    Some(datum) => datum,
                    None => {
                        let key = format!("{}[{i}]", subject.key);
                        let subject = Subject {
                            key: &key,
                            ..subject
                        };
                        self.datum(subject, n, item)?
                    }
                };
                Ok(Item {
                    span: n.span.clone(),
                    datum,
                })
            })
            .collect();
        items.into_iter().collect()
    }

    fn grid(
        &mut self,
        subject: Subject<'_>,
        node: &Node,
        rows: &[Node],
        item: &Shape,
        size: Option<(usize, usize)>,
        shape: &Shape,
    ) -> Decoded<Datum> {
        if size.is_some_and(|(r, _)| r != rows.len()) {
            self.wrong(subject, node, shape);
            return Err(Broken);
        }
        let columns = match (size, rows.first().map(|r| &r.value)) {
            (Some((_, c)), _) => Some(c),
            (None, Some(Value::List(l))) => Some(l.len()),
            _ => None,
        };
        if rows.is_empty() || columns == Some(0) {
            let message = format!("expected {}, found no entries", shape.describe());
            self.diags.push(
                Diagnostic::new("shape", subject.say(message))
                    .at(rows.first().unwrap_or(node).span.clone(), "empty")
                    .help(format!("write {}", shape.describe())),
            );
            return Err(Broken);
        }
        let mut out = Vec::with_capacity(rows.len());
        let mut broken = false;
        for (i, row) in rows.iter().enumerate() {
            let key = format!("{}[{i}]", subject.key);
            let subject = Subject {
                key: &key,
                ..subject
            };
            let Value::List(list) = &row.value else {
                self.wrong(subject, row, &Shape::List(&Shape::Vector, None));
                broken = true;
                continue;
            };
            if let Some(c) = columns.filter(|c| *c != list.len()) {
                let why = if size.is_some() {
                    String::new()
                } else {
                    " like the first row".to_owned()
                };
                self.diags.push(
                    Diagnostic::new(
                        "shape",
                        subject.say(format!(
                            "this row is of length {}; it must be of length {c}{why}",
                            list.len()
                        )),
                    )
                    .at(row.span.clone(), format!("length {}", list.len()))
                    .help("let all rows have the same length"),
                );
                broken = true;
                continue;
            }
            match self.list(subject, list, item) {
                Ok(items) => out.push(Item {
                    span: row.span.clone(),
                    datum: Datum::List(items),
                }),
                Err(Broken) => broken = true,
            }
        }
        if broken {
            Err(Broken)
        } else {
            Ok(Datum::List(out))
        }
    }

    fn vector(&mut self, subject: Subject<'_>, node: &Node, list: &[Node]) -> Decoded<DVec3> {
        if list.len() != 3 {
            let what = format!(
                "expected three numbers [x, y, z], found {}",
                node.describe()
            );
            self.diags.push(
                Diagnostic::new("shape", subject.say(what))
                    .at(node.span.clone(), format!("{} instead of 3", list.len()))
                    .help("write three numbers [x, y, z]"),
            );
            return Err(Broken);
        }
        let parts: Vec<Decoded<f64>> = list
            .iter()
            .enumerate()
            .map(|(i, n)| {
                let key = format!("{}.{}", subject.key, ["x", "y", "z"][i]);
                self.scope.number(
                    n,
                    Subject {
                        key: &key,
                        ..subject
                    },
                    self.diags,
                )
            })
            .collect();
        match parts[..] {
            [Ok(x), Ok(y), Ok(z)] => Ok(DVec3::new(x, y, z)),
            _ => Err(Broken),
        }
    }

    fn side(&mut self, subject: Subject<'_>, node: &Node, text: &str) -> Decoded<SideName> {
        let parsed = text.rsplit_once('.').map(|(surface, side)| {
            let found = nappe::surface::Side::ALL
                .into_iter()
                .find(|s| s.name() == side);
            (surface, side, found)
        });
        match parsed {
            Some((surface, _, Some(side))) if !surface.is_empty() => Ok(SideName {
                surface: surface.into(),
                side,
            }),
            Some((surface, wrong, None)) if !surface.is_empty() => {
                let names = Side::ALL.map(Side::name);
                let help = match nearest(wrong, names) {
                    Some(n) => format!("did you mean \"{surface}.{n}\"?"),
                    None => {
                        "sides are south (v = 0), north (v = 1), west (u = 0), east (u = 1)".into()
                    }
                };
                self.diags.push(
                    Diagnostic::new(
                        "unknown-side",
                        subject.say(format!("there is no side `{wrong}`")),
                    )
                    .at(node.place(&(surface.len() + 1..text.len())), "unknown side")
                    .help(help),
                );
                Err(Broken)
            }
            _ => {
                self.wrong(subject, node, &Shape::Side);
                Err(Broken)
            }
        }
    }

    /// An angle with its unit, in radians.
    fn angle(&mut self, subject: Subject<'_>, node: &Node) -> Decoded<f64> {
        match &node.value {
            Value::Text { text, .. } => {
                let unit = split_unit(text);
                let Some((number, factor)) = unit else {
                    self.diags.push(
                        Diagnostic::new(
                            "angle",
                            subject.say(format!("the angle \"{text}\" has no unit")),
                        )
                        .at(node.span.clone(), "deg, rad or turn?")
                        .help(format!("write \"({text}) deg\", or rad, or turn")),
                    );
                    return Err(Broken);
                };
                let x = self.scope.evaluate(number, 0, node, subject, self.diags)? * factor;
                if self.scope.reads_rates() {
                    return Ok(x);
                }
                if x.abs() <= MOST_TURNS * TAU {
                    return Ok(x);
                }
                let message = format!(
                    "the angle is {:e} turns; more than {MOST_TURNS} are not read",
                    x / TAU
                );
                self.diags.push(
                    Diagnostic::new("angle", subject.say(message))
                        .at(node.span.clone(), "out of range")
                        .help("write the angle without its whole turns"),
                );
                Err(Broken)
            }
            Value::Number(x) => {
                self.diags.push(
                    Diagnostic::new("angle", subject.say(format!("the angle {x} has no unit")))
                        .at(node.span.clone(), "deg, rad or turn?")
                        .help(format!(
                            "write \"{x}deg\" if it is in degrees; rad and turn are read too"
                        )),
                );
                Err(Broken)
            }
            _ => {
                self.wrong(subject, node, &Shape::Angle);
                Err(Broken)
            }
        }
    }
}

/// The largest angle in turns: rounding then costs less than 1e-12 of a turn.
const MOST_TURNS: f64 = 1000.0;

/// The number of an angle and what a unit of it is in radians.
fn split_unit(text: &str) -> Option<(&str, f64)> {
    let trimmed = text.trim_end();
    [("deg", PI / 180.0), ("rad", 1.0), ("turn", TAU)]
        .into_iter()
        .find_map(|(unit, factor)| {
            let number = trimmed.strip_suffix(unit)?;
            // The unit follows a number, a bracket or a blank: `my_rad` does not end in a unit.
            let free = number.ends_with(|c: char| !(c.is_alphabetic() || c == '_'));
            free.then_some((number, factor))
        })
}

/// A number or a vector of plain numbers, of which nets are full: nothing can be wrong with them that must be named.
fn plain(node: &Node, shape: &Shape, rates: bool) -> Option<Datum> {
    let number = |n: &Node| match n.value {
        Value::Number(_) if rates => Some(0.0),
        Value::Number(x) if x.abs() <= LARGEST_LENGTH => Some(x),
        _ => None,
    };
    match (shape, &node.value) {
        (Shape::Number, _) => number(node).map(Datum::Number),
        (Shape::Vector, Value::List(list)) => match &list[..] {
            [x, y, z] => Some(Datum::Vector(DVec3::new(
                number(x)?,
                number(y)?,
                number(z)?,
            ))),
            _ => None,
        },
        _ => None,
    }
}

/// The one of several shapes that a value is meant to have.
fn pick<'s>(shapes: &'s [Shape], node: &Node) -> Option<&'s Shape> {
    let exact = shapes.iter().find(|s| match (s, &node.value) {
        (Shape::Choice(words), Value::Text { text, .. }) => words.contains(&text.as_str()),
        (Shape::Record(keys), Value::Table(t)) => {
            t.get("kind").is_none()
                && t.entries
                    .iter()
                    .any(|(k, _)| keys.iter().any(|x| x.name == k.name))
        }
        (Shape::Curve, Value::Table(t)) => t.get("kind").is_some(),
        // One entry that is an angle makes a list of angles; the others lack their units.
        (Shape::List(item, _), Value::List(l)) => l.iter().any(|x| fits(item, x)),
        _ => false,
    });
    exact.or_else(|| {
        let words = |s: &&Shape| matches!(s, Shape::Choice(_));
        // A misspelt word of a choice looks like a name: other shapes that take texts come first.
        shapes
            .iter()
            .filter(|s| !words(s))
            .chain(shapes.iter().filter(words))
            .find(|s| fits(s, node))
    })
}

/// True if a value has the outer form of a shape.
fn fits(shape: &Shape, node: &Node) -> bool {
    match &node.value {
        Value::Number(_) => matches!(shape, Shape::Number | Shape::Count(_) | Shape::Formula(_)),
        Value::Text { text, .. } => match shape {
            Shape::Angle => split_unit(text).is_some(),
            Shape::Number
            | Shape::Count(_)
            | Shape::Formula(_)
            | Shape::Text
            | Shape::Choice(_)
            | Shape::Curve
            | Shape::Surface
            | Shape::Side => true,
            _ => false,
        },
        Value::Bool(_) => matches!(shape, Shape::Bool),
        Value::List(_) => matches!(shape, Shape::List(..) | Shape::Grid(..) | Shape::Vector),
        Value::Table(_) => matches!(shape, Shape::Record(_) | Shape::Curve),
        Value::Date => false,
    }
}
