//! From values of the file to typed data, by the registry's shapes. Every fault is reported, not only the first.

mod datum;

use crate::data::{Fields, Item, Object};
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::params::{Broken, Scope, Subject};
use crate::registry::{Key, Kind, Need, Shape};
use crate::value::{Node, Span, Table, Value};
use nappe::expr::nearest;

/// Reads data with a scope of parameters and a list for what is wrong.
pub(crate) struct Decoder<'a> {
    pub(crate) scope: &'a Scope,
    pub(crate) diags: &'a mut Diagnostics,
}

type Decoded<T> = Result<T, Broken>;

impl Decoder<'_> {
    /// Reads a curve or surface: its kind, its keys, everything that is wrong with them.
    pub(crate) fn object(
        &mut self,
        label: &str,
        place: &Span,
        node: &Node,
        kinds: &'static [Kind],
    ) -> Decoded<Object> {
        let Value::Table(table) = &node.value else {
            self.diags.push(
                Diagnostic::new(
                    "shape",
                    format!("{label}: expected a table, found {}", node.describe()),
                )
                .at(node.span.clone(), "not a table")
                .help("write { kind = \"…\", … }"),
            );
            return Err(Broken);
        };
        let kind = self.kind(label, place, table, kinds);
        let construction_only = match table.get("construction_only").map(|n| (&n.value, n)) {
            None => Ok(false),
            Some((Value::Bool(b), _)) => Ok(*b),
            Some((_, n)) => {
                self.wrong(
                    Subject {
                        object: label,
                        key: "construction_only",
                    },
                    n,
                    &Shape::Bool,
                );
                Err(Broken)
            }
        };
        let kind = kind?;
        let fields = self.fields(
            label,
            "",
            place,
            table,
            kind.keys,
            &["kind", "construction_only"],
            kind.name,
        );
        Ok(Object {
            label: label.into(),
            kind,
            fields: fields?,
            construction_only: construction_only?,
        })
    }

    fn kind(
        &mut self,
        label: &str,
        place: &Span,
        table: &Table,
        kinds: &'static [Kind],
    ) -> Decoded<&'static Kind> {
        let names = || kinds.iter().map(|k| k.name);
        let list = || names().collect::<Vec<_>>().join(", ");
        let Some(node) = table.get("kind") else {
            if let Some((k, _)) = table
                .entries
                .iter()
                .find(|(k, _)| k.name.eq_ignore_ascii_case("kind"))
            {
                self.unknown_key(label, &k.name, &k.span, &[], &["kind"], "");
                return Err(Broken);
            }
            self.diags.push(
                Diagnostic::new("missing-key", format!("{label}: `kind` is missing"))
                    .at(place.clone(), "what kind is it?")
                    .help(format!("kinds are {}", list())),
            );
            return Err(Broken);
        };
        let Value::Text { text, .. } = &node.value else {
            self.wrong(
                Subject {
                    object: label,
                    key: "kind",
                },
                node,
                &Shape::Text,
            );
            return Err(Broken);
        };
        kinds.iter().find(|k| k.name == text).ok_or_else(|| {
            let help = match nearest(text, names()) {
                Some(n) => format!("did you mean \"{n}\"?"),
                None => format!("kinds are {}", list()),
            };
            self.diags.push(
                Diagnostic::new(
                    "unknown-kind",
                    format!("{label}: there is no kind \"{text}\""),
                )
                .at(node.span.clone(), "unknown kind")
                .help(help),
            );
            Broken
        })
    }

    /// Reads a table by its keys; `what` names it for messages about its keys.
    #[allow(clippy::too_many_arguments)]
    pub(crate) fn fields(
        &mut self,
        label: &str,
        prefix: &str,
        place: &Span,
        table: &Table,
        keys: &'static [Key],
        also: &[&str],
        what: &str,
    ) -> Decoded<Fields> {
        let mut out = Fields {
            entries: Vec::new(),
            span: place.clone(),
        };
        let mut broken = false;
        for (k, v) in &table.entries {
            if also.contains(&k.name.as_str()) {
                continue;
            }
            let Some(key) = keys.iter().find(|x| x.name == k.name) else {
                self.unknown_key(label, &k.name, &k.span, keys, also, what);
                broken = true;
                continue;
            };
            let path = if prefix.is_empty() {
                k.name.clone()
            } else {
                format!("{prefix}.{}", k.name)
            };
            match self.datum(
                Subject {
                    object: label,
                    key: &path,
                },
                v,
                &key.shape,
            ) {
                Ok(datum) => out.entries.push((
                    key.name,
                    Item {
                        span: v.span.clone(),
                        datum,
                    },
                )),
                Err(Broken) => broken = true,
            }
        }
        broken |= self.missing(label, place, table, keys, what).is_err();
        if broken { Err(Broken) } else { Ok(out) }
    }

    fn unknown_key(
        &mut self,
        label: &str,
        name: &str,
        span: &Span,
        keys: &[Key],
        also: &[&str],
        what: &str,
    ) {
        let names = keys.iter().map(|k| k.name).chain(also.iter().copied());
        let help = match nearest(name, names.clone()) {
            Some(n) => format!("did you mean `{n}`?"),
            None => format!("keys are {}", names.collect::<Vec<_>>().join(", ")),
        };
        let message = if what.is_empty() {
            format!("{label}: there is no key `{name}`")
        } else {
            format!("{label}: {what} has no key `{name}`")
        };
        self.diags.push(
            Diagnostic::new("unknown-key", message)
                .at(span.clone(), "unknown key")
                .help(help),
        );
    }

    /// Reports required keys that are not there, and keys of forms that exclude each other.
    fn missing(
        &mut self,
        label: &str,
        place: &Span,
        table: &Table,
        keys: &[Key],
        what: &str,
    ) -> Decoded<()> {
        let has = |k: &Key| table.get(k.name).is_some();
        let form = |f: usize| keys.iter().filter(move |k| k.need == Need::Form(f));
        let forms = keys
            .iter()
            .filter_map(|k| {
                if let Need::Form(f) = k.need {
                    Some(f + 1)
                } else {
                    None
                }
            })
            .max();
        let forms = forms.unwrap_or(0);
        let chosen =
            (0..forms).max_by_key(|&f| (form(f).filter(|k| has(k)).count(), usize::MAX - f));
        let needed =
            |k: &&Key| k.need == Need::Required || chosen.is_some_and(|f| k.need == Need::Form(f));
        let mut result = Ok(());
        let what = if what.is_empty() {
            String::new()
        } else {
            format!(" ({what})")
        };
        // A misspelt key has been reported with the right name; it is not reported as missing too.
        let misspelt = |k: &Key| {
            let unknown = table
                .entries
                .iter()
                .filter(|(x, _)| keys.iter().all(|k| k.name != x.name));
            unknown
                .map(|(x, _)| nearest(&x.name, keys.iter().map(|k| k.name)))
                .any(|n| n == Some(k.name))
        };
        for k in keys.iter().filter(needed).filter(|k| !has(k)) {
            if misspelt(k) {
                result = Err(Broken);
                continue;
            }
            let mut help = format!("`{}` is {}: {}", k.name, k.shape.describe(), k.doc);
            if matches!(k.need, Need::Form(_)) && chosen.is_some_and(|f| form(f).all(|k| !has(k))) {
                let others: Vec<String> = (0..forms)
                    .map(|f| {
                        form(f)
                            .map(|k| format!("`{}`", k.name))
                            .collect::<Vec<_>>()
                            .join(", ")
                    })
                    .collect();
                help = format!("give {}", others.join(", or "));
            }
            self.diags.push(
                Diagnostic::new(
                    "missing-key",
                    format!("{label}{what}: `{}` is missing", k.name),
                )
                .at(place.clone(), "")
                .help(help),
            );
            result = Err(Broken);
        }
        for (k, _) in &table.entries {
            let Some(Need::Form(f)) = keys.iter().find(|x| x.name == k.name).map(|x| x.need) else {
                continue;
            };
            if Some(f) != chosen {
                let own: Vec<&str> = chosen
                    .into_iter()
                    .flat_map(form)
                    .filter(|k| has(k))
                    .map(|k| k.name)
                    .collect();
                self.diags.push(
                    Diagnostic::new(
                        "conflict",
                        format!(
                            "{label}{what}: `{}` cannot stand together with `{}`",
                            k.name,
                            own.join("`, `")
                        ),
                    )
                    .at(k.span.clone(), "one or the other")
                    .help(format!(
                        "remove `{}`, or `{}`",
                        k.name,
                        own.join("` and `")
                    )),
                );
                result = Err(Broken);
            }
        }
        result
    }

    /// Reports a value of the wrong shape.
    fn wrong(&mut self, subject: Subject<'_>, node: &Node, shape: &Shape) {
        self.diags.push(
            Diagnostic::new(
                "shape",
                subject.say(format!(
                    "expected {}, found {}",
                    shape.describe(),
                    node.describe()
                )),
            )
            .at(node.span.clone(), "wrong shape")
            .help(format!("write {}", shape.describe())),
        );
    }
}
