//! Parameters: numbers by name, each a number or an expression over the others.

use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::value::{Node, Span, Table, Value};
use crate::{MAX_PARAMETERS, Overrides};
use nappe::expr::{CONSTANTS, Expr, FUNCTIONS, Slope, nearest};
use nappe::{LARGEST_LENGTH, significant};
use std::collections::HashMap;

/// A parameter with its value.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// The name.
    pub name: String,
    /// The value.
    pub value: f64,
    /// The expression it was computed from, if it is not a plain number.
    pub expression: Option<String>,
    /// The least value allowed.
    pub min: Option<f64>,
    /// The greatest value allowed.
    pub max: Option<f64>,
    /// What it is.
    pub doc: Option<String>,
}

/// The names that expressions use for curve and surface parameters.
const VARIABLES: [&str; 3] = ["t", "u", "v"];

/// Values by name, those that are wrong set apart.
#[derive(Clone, Debug, Default)]
pub(crate) struct Scope {
    values: Vec<(String, f64)>,
    index: HashMap<String, Option<usize>>,
    /// What each value was computed from.
    sources: Vec<Node>,
    /// How fast each value changes, where rates are read and not values.
    rates: Option<Vec<f64>>,
    /// All names, in the order of the file, also of those that are wrong or not evaluated yet: for near names.
    names: Vec<String>,
}

impl Scope {
    fn set(&mut self, name: &str, value: Option<(f64, &Node)>) {
        let at = value.map(|(x, node)| {
            self.values.push((name.to_owned(), x));
            self.sources.push(node.clone());
            self.values.len() - 1
        });
        self.index.insert(name.to_owned(), at);
    }

    /// True if the name is a parameter whose own definition is wrong: its users are not to blame.
    fn is_broken(&self, name: &str) -> bool {
        matches!(self.index.get(name), Some(None))
    }

    /// The parameters that an expression uses and, if a name is not known, all of them (for the near names).
    fn visible<'a>(&'a self, e: &Expr) -> Vec<(&'a str, f64)> {
        let known = |n: &str| {
            self.index.contains_key(n) || CONSTANTS.contains(&n) || VARIABLES.contains(&n)
        };
        if e.names().all(|(n, _)| known(n)) {
            let used = e
                .names()
                .filter_map(|(n, _)| self.index.get(n).copied().flatten());
            return used
                .map(|i| (self.values[i].0.as_str(), self.values[i].1))
                .collect();
        }
        self.values.iter().map(|(n, x)| (n.as_str(), *x)).collect()
    }
}

impl Scope {
    /// The scope in which every number is read as its derivative with respect to a parameter. `None` if there is no such
    /// parameter.
    pub(crate) fn by(&self, parameter: &str, diags: &mut Diagnostics) -> Option<Self> {
        let by = self.index.get(parameter).copied().flatten()?;
        let mut scope = self.clone();
        // Each after those it uses.
        for i in 0..scope.values.len() {
            let mut rates = scope.rates.take().unwrap_or_default();
            rates.resize(self.values.len(), 0.0);
            rates[by] = 1.0;
            scope.rates = Some(rates);
            if i == by {
                continue;
            }
            let object = format!("parameter `{}`", self.values[i].0);
            let subject = Subject {
                object: &object,
                key: "",
            };
            let rate = scope.number(&self.sources[i], subject, diags);
            if let (Some(rates), Ok(rate)) = (&mut scope.rates, rate) {
                rates[i] = rate;
            }
        }
        Some(scope)
    }

    /// True if numbers are read as derivatives.
    pub(crate) fn reads_rates(&self) -> bool {
        self.rates.is_some()
    }

    /// The parameters that change: name, value, rate.
    pub(crate) fn changing(&self) -> Vec<(&str, [f64; 2])> {
        let rates = self.rates.as_deref().unwrap_or_default();
        let all = self.values.iter().zip(rates);
        all.filter(|(_, rate)| **rate != 0.0)
            .map(|((name, x), rate)| (name.as_str(), [*x, *rate]))
            .collect()
    }

    /// The derivative of an expression over the parameters.
    fn rate(
        &self,
        text: &str,
        from: usize,
        node: &Node,
        subject: Subject<'_>,
        diags: &mut Diagnostics,
    ) -> Result<f64, Broken> {
        let e = parse(text, from, node, subject, diags)?;
        let changing = self.changing();
        let names: Vec<&str> = changing.iter().map(|c| c.0).collect();
        if e.names().all(|(name, _)| !names.contains(&name)) {
            return Ok(0.0);
        }
        let bound = self.bind(&e, from, &names, node, subject, diags)?;
        let at: Vec<[f64; 2]> = changing.iter().map(|c| c.1).collect();
        match bound.slope(&at) {
            Ok(Slope::One(rate)) if rate.is_finite() => Ok(rate),
            Ok(Slope::Kink(range)) => {
                let rates = if range.is_finite() {
                    let [a, b] = [range.lo, range.hi].map(|x| significant(x, 6));
                    format!("its derivative is {a} on one side and {b} on the other")
                } else {
                    "it jumps".to_owned()
                };
                diags.push(
                    Diagnostic::new(
                        "kink",
                        subject.say(format!("here \"{text}\" changes its formula: {rates}")),
                    )
                    .at(node.span.clone(), "no derivative")
                    .help("give the parameter a value a little off this one"),
                );
                Err(Broken)
            }
            Ok(Slope::One(_)) | Err(_) => {
                diags.push(
                    Diagnostic::new(
                        "kink",
                        subject.say(format!("\"{text}\" has no finite derivative here")),
                    )
                    .at(node.span.clone(), "no derivative")
                    .help("give the parameter a value a little off this one"),
                );
                Err(Broken)
            }
        }
    }
}

/// A number's place and what it belongs to, for messages.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Subject<'a> {
    /// Such as "surface `dome`".
    pub(crate) object: &'a str,
    /// Such as "radius" or "points[2]".
    pub(crate) key: &'a str,
}

impl Subject<'_> {
    pub(crate) fn say(&self, what: impl std::fmt::Display) -> String {
        match (self.object.is_empty(), self.key.is_empty()) {
            (true, true) => what.to_string(),
            (true, false) => format!("`{}`: {what}", self.key),
            (false, true) => format!("{}: {what}", self.object),
            (false, false) => format!("{}, `{}`: {what}", self.object, self.key),
        }
    }
}

/// Something is wrong and has been reported, or depends on something that has been.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) struct Broken;

/// Parses a text of an expression; the text begins at `from` of the node's text.
pub(crate) fn parse(
    text: &str,
    from: usize,
    node: &Node,
    subject: Subject<'_>,
    diags: &mut Diagnostics,
) -> Result<Expr, Broken> {
    Expr::parse(text).map_err(|e| {
        let span = node.place(&(e.span.start + from..e.span.end + from));
        diags.push(
            Diagnostic::new("expression", subject.say(&e))
                .at(span, "here")
                .help(e.help()),
        );
        Broken
    })
}

impl Scope {
    /// Gives the names of an expression a meaning.
    pub(crate) fn bind(
        &self,
        e: &Expr,
        from: usize,
        variables: &[&str],
        node: &Node,
        subject: Subject<'_>,
        diags: &mut Diagnostics,
    ) -> Result<nappe::expr::Bound, Broken> {
        if e.names()
            .any(|(n, _)| self.is_broken(n) && !variables.contains(&n))
        {
            return Err(Broken);
        }
        e.bind(variables, &self.visible(e)).map_err(|unknown| {
            for mut u in unknown {
                let more = self.names.iter().filter(|n| !u.known.contains(n));
                let more: Vec<String> = more.cloned().collect();
                u.known.extend(more);
                let near = nearest(&u.name, u.known.iter().map(String::as_str));
                u.near = near.map(str::to_owned);
                let span = node.place(&(u.span.start + from..u.span.end + from));
                let wrong_variable = VARIABLES.contains(&u.name.as_str());
                let help = match (wrong_variable, variables) {
                    (true, []) => format!(
                        "`{}` has a value only in a function; use a parameter",
                        u.name
                    ),
                    (true, [v, ..]) => format!("the variable here is `{v}`"),
                    (false, _) => u.help(),
                };
                diags.push(
                    Diagnostic::new("unknown-name", subject.say(&u))
                        .at(span, "not defined")
                        .help(help),
                );
            }
            Broken
        })
    }

    /// The value of a number or of an expression over the parameters. It is finite and at most [`LARGEST_LENGTH`].
    pub(crate) fn number(
        &self,
        node: &Node,
        subject: Subject<'_>,
        diags: &mut Diagnostics,
    ) -> Result<f64, Broken> {
        if self.reads_rates() {
            return match &node.value {
                Value::Text { text, .. } => self.rate(text, 0, node, subject, diags),
                _ => Ok(0.0),
            };
        }
        let value = match &node.value {
            Value::Number(x) if x.is_finite() => Ok(*x),
            Value::Number(x) => {
                diags.push(
                    Diagnostic::new("not-finite", subject.say(format!("the number is {x}")))
                        .at(node.span.clone(), "must be finite")
                        .help("write a finite number"),
                );
                Err(Broken)
            }
            Value::Text { text, .. } => self.evaluate(text, 0, node, subject, diags),
            _ => {
                diags.push(
                    Diagnostic::new(
                        "shape",
                        subject.say(format!("expected a number, found {}", node.describe())),
                    )
                    .at(node.span.clone(), "not a number")
                    .help("write a number, or an expression in quotes such as \"2*radius\""),
                );
                Err(Broken)
            }
        }?;
        if value.abs() <= LARGEST_LENGTH {
            return Ok(value);
        }
        let message =
            format!("the number is {value:e}; numbers beyond ±{LARGEST_LENGTH:e} are not read");
        diags.push(
            Diagnostic::new("size", subject.say(message))
                .at(node.span.clone(), "too large")
                .help("write a smaller number, or choose a larger unit: products of such lengths overflow"),
        );
        Err(Broken)
    }

    /// The value of an expression over the parameters.
    pub(crate) fn evaluate(
        &self,
        text: &str,
        from: usize,
        node: &Node,
        subject: Subject<'_>,
        diags: &mut Diagnostics,
    ) -> Result<f64, Broken> {
        if self.reads_rates() {
            return self.rate(text, from, node, subject, diags);
        }
        let e = parse(text, from, node, subject, diags)?;
        let bound = self.bind(&e, from, &[], node, subject, diags)?;
        bound.value(&[]).map_err(|e| {
            let span = node.place(&(e.fault.span.start + from..e.fault.span.end + from));
            diags.push(
                Diagnostic::new("expression", subject.say(&e))
                    .at(span, "has no value")
                    .help(e.help()),
            );
            Broken
        })
    }
}

/// A parameter as written.
struct Entry<'a> {
    name: &'a str,
    span: Span,
    value: Source<'a>,
    min: Option<&'a Node>,
    max: Option<&'a Node>,
    doc: Option<String>,
}

/// Where a value comes from.
enum Source<'a> {
    File(&'a Node),
    /// The command line. The node has the place of the parameter, so that errors show what is overridden.
    Override(Node),
    Missing,
}

impl Source<'_> {
    /// What messages add if the file is not to blame.
    fn set_by(&self) -> &'static str {
        match self {
            Source::Override(_) => " (set on the command line)",
            _ => "",
        }
    }

    fn node(&self) -> Option<&Node> {
        match self {
            Source::File(n) => Some(n),
            Source::Override(n) => Some(n),
            Source::Missing => None,
        }
    }
}

/// Evaluates all parameters: overrides replace values, cycles and values out of range are errors.
pub(crate) fn resolve(
    table: Option<&Node>,
    overrides: &Overrides,
    diags: &mut Diagnostics,
) -> (Scope, Vec<Parameter>) {
    let empty = Table::default();
    let table = match table.map(|n| &n.value) {
        Some(Value::Table(t)) => t,
        _ => &empty,
    };
    if table.entries.len() > MAX_PARAMETERS {
        let n = table.entries.len();
        diags.push(
            Diagnostic::new(
                "limit",
                format!("there are {n} parameters; at most {MAX_PARAMETERS} are read"),
            )
            .help("write numbers that do not change as numbers"),
        );
        return (Scope::default(), Vec::new());
    }
    let mut entries: Vec<Entry<'_>> = table
        .entries
        .iter()
        .filter_map(|(k, v)| entry(&k.name, &k.span, v, diags))
        .collect();
    apply(overrides, &mut entries, diags);
    let mut scope = Scope {
        names: table.entries.iter().map(|(k, _)| k.name.clone()).collect(),
        ..Scope::default()
    };
    // A parameter whose table could not be read is broken, not unknown.
    for (k, _) in &table.entries {
        if !entries.iter().any(|e| e.name == k.name) {
            scope.set(&k.name, None);
        }
    }
    let index: HashMap<&str, usize> = entries
        .iter()
        .enumerate()
        .map(|(i, e)| (e.name, i))
        .collect();
    let mut state = vec![State::New; entries.len()];
    for i in 0..entries.len() {
        visit(i, &entries, &index, &mut state, &mut scope, diags);
    }
    let list = entries
        .iter()
        .filter_map(|e| finish(e, &scope, diags))
        .collect();
    (scope, list)
}

#[derive(Clone, Copy, PartialEq)]
enum State {
    New,
    Open,
    Done,
}

/// Reads one entry of `[params]`.
fn entry<'a>(
    name: &'a str,
    span: &Span,
    node: &'a Node,
    diags: &mut Diagnostics,
) -> Option<Entry<'a>> {
    let object = format!("parameter `{name}`");
    let mut letters = name.chars();
    let valid = letters
        .next()
        .is_some_and(|c| c.is_alphabetic() || c == '_')
        && letters.all(|c| c.is_alphanumeric() || c == '_');
    let reserved =
        VARIABLES.contains(&name) || CONSTANTS.contains(&name) || FUNCTIONS.contains(&name);
    if !valid || reserved {
        let what = if reserved {
            "this name has a fixed meaning in expressions"
        } else {
            "this is not a name"
        };
        let help = if reserved {
            format!("choose another name, such as `{name}_0`")
        } else {
            "a name is made of letters, digits and _, and does not start with a digit".into()
        };
        diags.push(
            Diagnostic::new("name", format!("{object}: {what}"))
                .at(span.clone(), "")
                .help(help),
        );
        return None;
    }
    let mut e = Entry {
        name,
        span: span.clone(),
        value: Source::File(node),
        min: None,
        max: None,
        doc: None,
    };
    if let Value::Table(t) = &node.value {
        e.value = Source::Missing;
        for (k, v) in &t.entries {
            match (k.name.as_str(), &v.value) {
                ("value", _) => e.value = Source::File(v),
                ("min", _) => e.min = Some(v),
                ("max", _) => e.max = Some(v),
                ("doc", Value::Text { text, .. }) => e.doc = Some(text.clone()),
                ("doc", _) => diags.push(
                    Diagnostic::new(
                        "shape",
                        format!("{object}, `doc`: expected a text, found {}", v.describe()),
                    )
                    .at(v.span.clone(), "not a text")
                    .help("write the text in quotes"),
                ),
                (other, _) => {
                    let help = match nearest(other, ["value", "min", "max", "doc"]) {
                        Some(n) => format!("did you mean `{n}`?"),
                        None => "a parameter has the keys value, min, max, doc".into(),
                    };
                    diags.push(
                        Diagnostic::new(
                            "unknown-key",
                            format!("{object}: there is no key `{other}`"),
                        )
                        .at(k.span.clone(), "unknown")
                        .help(help),
                    );
                }
            }
        }
        if matches!(e.value, Source::Missing) {
            diags.push(
                Diagnostic::new("missing-key", format!("{object}: `value` is missing"))
                    .at(span.clone(), "")
                    .help("write { value = … }"),
            );
            return None;
        }
    }
    Some(e)
}

/// Replaces values by those of the command line.
fn apply(overrides: &Overrides, entries: &mut [Entry<'_>], diags: &mut Diagnostics) {
    for (name, text) in overrides.iter() {
        let Some(i) = entries.iter().position(|e| e.name == name) else {
            let names = entries.iter().map(|e| e.name);
            let help = match nearest(name, names.clone()) {
                Some(n) => format!("did you mean `{n}`?"),
                None if entries.is_empty() => "the model has no [params]".into(),
                None => format!("parameters are {}", names.collect::<Vec<_>>().join(", ")),
            };
            diags.push(
                Diagnostic::new(
                    "override",
                    format!("--set {name}={text}: there is no parameter `{name}`"),
                )
                .help(help),
            );
            continue;
        };
        let value = Value::Text {
            text: text.to_owned(),
            start: None,
        };
        entries[i].value = Source::Override(Node {
            span: entries[i].span.clone(),
            value,
        });
    }
}

/// Evaluates a parameter after those it uses. Recursion is as deep as the longest chain, at most the number of
/// parameters, so the walk keeps its own stack.
fn visit(
    start: usize,
    entries: &[Entry<'_>],
    index: &HashMap<&str, usize>,
    state: &mut [State],
    scope: &mut Scope,
    diags: &mut Diagnostics,
) {
    // Each frame: the parameter, and those it uses that are still to be looked at.
    let mut stack: Vec<(usize, Vec<usize>)> = Vec::new();
    if state[start] == State::New {
        state[start] = State::Open;
        stack.push((start, uses(&entries[start], index)));
    }
    while let Some((i, waiting)) = stack.last_mut() {
        let i = *i;
        match waiting.pop() {
            Some(next) if state[next] == State::Open => {
                let from = stack.iter().position(|(j, _)| *j == next).unwrap_or(0);
                let mut path: Vec<&str> = stack[from..]
                    .iter()
                    .map(|(j, _)| entries[*j].name)
                    .collect();
                path.push(entries[next].name);
                diags.push(
                    Diagnostic::new(
                        "cycle",
                        format!("parameters depend on each other: {}", path.join(" → ")),
                    )
                    .at(entries[next].span.clone(), "the cycle starts here")
                    .help("give one of them a number"),
                );
                for (j, _) in &stack[from..] {
                    scope.set(entries[*j].name, None);
                }
            }
            Some(next) if state[next] == State::New => {
                state[next] = State::Open;
                stack.push((next, uses(&entries[next], index)));
            }
            Some(_) => {}
            None => {
                stack.pop();
                state[i] = State::Done;
                let e = &entries[i];
                if !scope.index.contains_key(e.name) {
                    let by = e.value.set_by();
                    let object = format!("parameter `{}`{by}", e.name);
                    let subject = Subject {
                        object: &object,
                        key: "",
                    };
                    let node = e.value.node();
                    let value = node.and_then(|n| Some((scope.number(n, subject, diags).ok()?, n)));
                    scope.set(e.name, value);
                }
            }
        }
    }
}

/// The parameters that a parameter's expression names.
fn uses(e: &Entry<'_>, index: &HashMap<&str, usize>) -> Vec<usize> {
    match e.value.node().map(|n| &n.value) {
        Some(Value::Text { text, .. }) => match Expr::parse(text) {
            Ok(x) => x
                .names()
                .filter_map(|(n, _)| index.get(n).copied())
                .collect(),
            Err(_) => Vec::new(),
        },
        _ => Vec::new(),
    }
}

/// Checks the range of a parameter.
fn finish(e: &Entry<'_>, scope: &Scope, diags: &mut Diagnostics) -> Option<Parameter> {
    let object = format!("parameter `{}`", e.name);
    let limit = |key: &str, node: Option<&Node>, diags: &mut Diagnostics| {
        node.and_then(|n| {
            scope
                .number(
                    n,
                    Subject {
                        object: &object,
                        key,
                    },
                    diags,
                )
                .ok()
        })
    };
    let (min, max) = (limit("min", e.min, diags), limit("max", e.max, diags));
    let value = scope
        .index
        .get(e.name)
        .copied()
        .flatten()
        .map(|i| scope.values[i].1)?;
    let range = match (min, max) {
        (Some(a), Some(b)) => format!("{a} to {b}"),
        (Some(a), None) => format!("at least {a}"),
        (None, Some(b)) => format!("at most {b}"),
        (None, None) => String::new(),
    };
    if min.is_some_and(|m| value < m) || max.is_some_and(|m| value > m) {
        let place = e.value.node().map_or(e.span.clone(), |n| n.span.clone());
        let by = e.value.set_by();
        let empty = matches!((min, max), (Some(a), Some(b)) if a > b);
        let help = if empty {
            "min must not exceed max".to_owned()
        } else {
            format!("it must be {range}")
        };
        diags.push(
            Diagnostic::new(
                "range",
                format!("{object} is {value}{by}, outside its range {range}"),
            )
            .at(place, format!("is {value}"))
            .help(help),
        );
    }
    let expression = match e.value.node().map(|n| &n.value) {
        Some(Value::Text { text, .. }) => Some(text.clone()),
        _ => None,
    };
    Some(Parameter {
        name: e.name.into(),
        value,
        expression,
        min,
        max,
        doc: e.doc.clone(),
    })
}
