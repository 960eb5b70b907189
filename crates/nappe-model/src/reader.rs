//! From a text to a model.

use crate::build::Builder;
use crate::checks;
use crate::data::{Datum, Object};
use crate::decode::Decoder;
use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::import::{Importer, Imports};
use crate::model::{Model, NamedCurve, NamedSurface};
use crate::params::{self, Scope, Subject};
use crate::registry::{CURVES, Kind, SURFACES, TOP};
use crate::value::{self, Node, Table, Value};
use crate::velocity::Rates;
use crate::{MAX_FILE, MAX_OBJECTS};
use nappe::Units;
use nappe::expr::nearest;
use std::path::Path;
use std::sync::Arc;
use toml::de::DeTable;

/// Values for parameters, given beside the file: `--set name=value`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides {
    list: Vec<(String, String)>,
}

impl Overrides {
    /// Sets a parameter to a number or an expression over the others. The last of several counts.
    pub fn set(&mut self, name: &str, value: &str) {
        self.list.retain(|(n, _)| n != name);
        self.list
            .push((name.trim().to_owned(), value.trim().to_owned()));
    }

    /// Reads `name=value`; the error is a sentence.
    pub fn set_from(&mut self, text: &str) -> Result<(), String> {
        match text.split_once('=') {
            Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
                if self.list.iter().any(|(n, _)| n == name.trim()) {
                    return Err(format!("`{}` is set twice", name.trim()));
                }
                self.set(name.trim(), value);
                Ok(())
            }
            _ => Err(format!("`{text}` is not of the form name=value")),
        }
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = (&str, &str)> {
        self.list.iter().map(|(n, v)| (n.as_str(), v.as_str()))
    }
}

/// Reads and builds a file. Objects of the kind `import` are refused: see [`load_with`].
pub fn load(path: &Path, overrides: &Overrides) -> Result<Model, Diagnostics> {
    load_file(path, overrides, None)
}

/// [`load`], with something that reads the files of objects of the kind `import`.
pub fn load_with(
    path: &Path,
    overrides: &Overrides,
    importer: Arc<dyn Importer>,
) -> Result<Model, Diagnostics> {
    load_file(path, overrides, Some(importer))
}

fn load_file(
    path: &Path,
    overrides: &Overrides,
    importer: Option<Arc<dyn Importer>>,
) -> Result<Model, Diagnostics> {
    let name = path.display().to_string();
    let refuse = |message: String, help: &str| {
        let mut d = Diagnostics::new(&name, "");
        d.push(Diagnostic::new("file", message).help(help));
        Err(d)
    };
    match std::fs::metadata(path) {
        Err(e) => {
            return refuse(
                format!("cannot be read: {e}"),
                "check the path and its permissions",
            );
        }
        Ok(m) if m.is_dir() => {
            return refuse(
                "is a directory".into(),
                "name a file such as model.nappe.toml",
            );
        }
        Ok(m) if m.len() > MAX_FILE as u64 => return refuse(too_large(m.len()), "split the model"),
        Ok(_) => {}
    }
    match std::fs::read(path) {
        Err(e) => refuse(
            format!("cannot be read: {e}"),
            "check the path and its permissions",
        ),
        Ok(bytes) => match String::from_utf8(bytes) {
            Ok(text) => parse_text(&text, &name, overrides, importer),
            Err(e) => {
                let at = e.utf8_error().valid_up_to();
                let mut bytes = e.into_bytes();
                bytes.truncate(at);
                let mut d = Diagnostics::new(&name, &String::from_utf8(bytes).unwrap_or_default());
                d.push(
                    Diagnostic::new("file", format!("byte {at} is not UTF-8 text"))
                        .at(at..at, "up to here it is")
                        .help("model files are text; save it as UTF-8"),
                );
                Err(d)
            }
        },
    }
}

fn too_large(len: u64) -> String {
    format!("is {len} bytes long; at most {MAX_FILE} are read")
}

/// Reads and builds a text; `name` is what messages call the file. Does no input or output and never panics.
/// Objects of the kind `import` are refused: see [`parse_with`].
pub fn parse(text: &str, name: &str, overrides: &Overrides) -> Result<Model, Diagnostics> {
    parse_text(text, name, overrides, None)
}

/// [`parse`], with something that reads the files of objects of the kind `import`.
pub fn parse_with(
    text: &str,
    name: &str,
    overrides: &Overrides,
    importer: Arc<dyn Importer>,
) -> Result<Model, Diagnostics> {
    parse_text(text, name, overrides, Some(importer))
}

fn parse_text(
    text: &str,
    name: &str,
    overrides: &Overrides,
    importer: Option<Arc<dyn Importer>>,
) -> Result<Model, Diagnostics> {
    let mut diags = Diagnostics::new(name, text);
    if text.len() > MAX_FILE {
        diags.push(Diagnostic::new("file", too_large(text.len() as u64)).help("split the model"));
        return Err(diags);
    }
    let (tree, faults) = DeTable::parse_recoverable(text);
    for e in &faults {
        // A place can lie one beyond the end of the text.
        let span = e
            .span()
            .map_or(0..0, |s| s.start.min(text.len())..s.end.min(text.len()));
        diags.push(
            Diagnostic::new("syntax", format!("not valid TOML: {}", e.message()))
                .at(span, "here")
                .help("see https://toml.io for how tables, lists and texts are written"),
        );
    }
    let top = value::table(text, tree.into_inner());
    let model = read(
        top,
        name,
        overrides,
        importer,
        &mut diags,
        !faults.is_empty(),
    );
    diags.sort();
    match model {
        Some(mut model) if !diags.has_errors() => {
            model.warnings = diags;
            Ok(model)
        }
        _ => Err(diags),
    }
}

/// Reads everything that can be read. After a syntax error what is there is checked, but nothing is said about what
/// is missing, which the error may have swallowed.
fn read(
    mut top: Table,
    name: &str,
    overrides: &Overrides,
    importer: Option<Arc<dyn Importer>>,
    diags: &mut Diagnostics,
    damaged: bool,
) -> Option<Model> {
    version(&top, diags, damaged);
    let (scope, params) = params::resolve(top.get("params"), overrides, diags);
    let mut decoder = Decoder {
        scope: &scope,
        diags,
    };
    let header = header(&top, &mut decoder);
    let mut count = 0;
    for table in ["curves", "surfaces"] {
        if let Some(Value::Table(t)) = top.get(table).map(|n| &n.value) {
            count += t.entries.len();
        }
    }
    if count > MAX_OBJECTS {
        diags.push(
            Diagnostic::new(
                "limit",
                format!("there are {count} curves and surfaces; at most {MAX_OBJECTS} are built"),
            )
            .help("split the model"),
        );
        return None;
    }
    let curves = objects(top.take("curves"), "curve", CURVES, &mut decoder);
    let surfaces = objects(top.take("surfaces"), "surface", SURFACES, &mut decoder);
    let written = top
        .get("checks")
        .map(|n| checks::read(&mut decoder, n))
        .unwrap_or_default();
    if damaged {
        // Objects may be incomplete: building them would report what is not wrong.
        return None;
    }
    let imports = Imports {
        importer: importer.clone(),
        units: header.units,
    };
    let mut builder = Builder::new(curves, surfaces, imports, diags);
    builder.all();
    let checks = written
        .iter()
        .filter_map(|w| checks::resolve(&mut builder, w))
        .collect();
    let curves = builder.curves().map(|(name, object, curve)| NamedCurve {
        name: name.to_owned(),
        kind: object.kind.name,
        curve,
        construction_only: object.construction_only,
        place: object.fields.span.clone(),
    });
    let curves: Vec<NamedCurve> = curves.collect();
    let surfaces: Vec<NamedSurface> = builder
        .surfaces()
        .flat_map(|(name, object, patches)| {
            let one = |p: &crate::build::Patch| NamedSurface {
                name: p
                    .suffix
                    .as_ref()
                    .map_or(name.to_owned(), |s| format!("{name}/{s}")),
                object: name.to_owned(),
                kind: object.kind.name,
                surface: p.surface.clone(),
                construction_only: object.construction_only,
                place: object.fields.span.clone(),
                control_net: p.net.clone(),
            };
            // A join's members are in the list already.
            let own = if object.kind.name == "join" {
                &[]
            } else {
                patches.as_slice()
            };
            own.iter().map(one).collect::<Vec<_>>()
        })
        .collect();
    Some(Model {
        title: header.title.unwrap_or_else(|| name.to_owned()),
        units: header.units,
        tolerance: header.tolerance,
        tolerance_place: top.get("tolerance").map(|n| n.span.clone()),
        params,
        curves,
        surfaces,
        joins: builder.joins(),
        checks,
        warnings: Diagnostics::new(name, ""),
        importer,
    })
}

/// Reads a text that has been read without error, and gives its builder and the rates of all numbers by a parameter.
pub(crate) fn with_rates(
    overrides: &Overrides,
    imports: Imports,
    parameter: &str,
    diags: &mut Diagnostics,
    work: impl FnOnce(&mut Builder<'_>, Rates),
) {
    let text = diags.text.clone();
    let (tree, _) = DeTable::parse_recoverable(&text);
    let mut top = value::table(&text, tree.into_inner());
    let (scope, _) = params::resolve(top.get("params"), overrides, diags);
    let read =
        |scope: &Scope, diags: &mut Diagnostics, top: &mut dyn FnMut(&str) -> Option<Node>| {
            let mut decoder = Decoder { scope, diags };
            let curves = objects(top("curves"), "curve", CURVES, &mut decoder);
            let surfaces = objects(top("surfaces"), "surface", SURFACES, &mut decoder);
            (curves, surfaces)
        };
    let Some(rates) = scope.by(parameter, diags) else {
        return;
    };
    let (curves, surfaces) = read(&rates, diags, &mut |key| top.get(key).cloned());
    let named = |list: Vec<(String, Option<Object>)>| {
        let list = list.into_iter();
        list.filter_map(|(name, o)| Some((name, Arc::new(o?))))
            .collect()
    };
    let rates = Rates {
        curves: named(curves),
        surfaces: named(surfaces),
    };
    if diags.has_errors() {
        return;
    }
    let (curves, surfaces) = read(&scope, diags, &mut |key| top.take(key));
    let mut builder = Builder::new(curves, surfaces, imports, diags);
    builder.all();
    work(&mut builder, rates);
}

/// Checks the version, before anything else.
fn version(top: &Table, diags: &mut Diagnostics, damaged: bool) {
    let message = match top.get("nappe") {
        None if damaged => return,
        None => {
            diags.push(
                Diagnostic::new(
                    "version",
                    "`nappe = 1` is missing: the version of the format",
                )
                .at(0..0, "the first line")
                .help("write `nappe = 1` at the beginning of the file"),
            );
            return;
        }
        Some(n) => match n.value {
            Value::Number(1.0) => return,
            Value::Number(x) => (n, format!("`nappe`: the format version {x} is not known")),
            _ => (
                n,
                format!(
                    "`nappe`: expected the format version 1, found {}",
                    n.describe()
                ),
            ),
        },
    };
    diags.push(
        Diagnostic::new("version", message.1)
            .at(message.0.span.clone(), "version")
            .help("this program reads version 1: write `nappe = 1`"),
    );
}

/// The keys at the top of a file.
struct Header {
    title: Option<String>,
    units: Units,
    tolerance: Option<f64>,
}

fn header(top: &Table, decoder: &mut Decoder<'_>) -> Header {
    const TABLES: [&str; 4] = ["params", "curves", "surfaces", "checks"];
    let mut header = Header {
        title: None,
        units: Units::default(),
        tolerance: None,
    };
    for (k, v) in &top.entries {
        let name = k.name.as_str();
        if TABLES.contains(&name) {
            if name != "checks" && !matches!(v.value, Value::Table(_)) {
                decoder.diags.push(
                    Diagnostic::new(
                        "shape",
                        format!("`{name}`: expected a table, found {}", v.describe()),
                    )
                    .at(v.span.clone(), "not a table")
                    .help(format!("write [{name}] and one entry for each")),
                );
            }
            continue;
        }
        let Some(key) = TOP.iter().find(|x| x.name == name) else {
            let names = TOP.iter().map(|k| k.name).chain(TABLES);
            let help = match nearest(name, names.clone()) {
                Some(n) => format!("did you mean `{n}`?"),
                None => format!("the file has {}", names.collect::<Vec<_>>().join(", ")),
            };
            decoder.diags.push(
                Diagnostic::new(
                    "unknown-key",
                    format!("there is no key `{name}` at the top of a model"),
                )
                .at(k.span.clone(), "unknown key")
                .help(help),
            );
            continue;
        };
        if name == "nappe" {
            continue;
        }
        let subject = Subject {
            object: "",
            key: name,
        };
        match (name, decoder.datum(subject, v, &key.shape)) {
            ("title", Ok(Datum::Text(t))) => header.title = Some(t),
            ("units", Ok(Datum::Text(t))) => {
                header.units = Units::from_symbol(&t).unwrap_or_default()
            }
            ("tolerance", Ok(Datum::Number(x))) if x > 0.0 => header.tolerance = Some(x),
            ("tolerance", Ok(Datum::Number(x))) => decoder.diags.push(
                Diagnostic::new(
                    "value",
                    format!("`tolerance` is {x}: it must be greater than 0"),
                )
                .at(v.span.clone(), "not positive")
                .help("write the greatest distance allowed between mesh and surface"),
            ),
            _ => {}
        }
    }
    header
}

/// Reads a table of objects, which goes as they come; those that are wrong are kept by name, so that references to them are not unknown.
fn objects(
    node: Option<Node>,
    what: &str,
    kinds: &'static [Kind],
    decoder: &mut Decoder<'_>,
) -> Vec<(String, Option<Object>)> {
    let Some(Value::Table(table)) = node.map(|n| n.value) else {
        return Vec::new();
    };
    let mut list = Vec::with_capacity(table.entries.len());
    for (k, v) in table.entries {
        let label = format!("{what} `{}`", k.name);
        if !k
            .name
            .chars()
            .all(|c| c.is_alphanumeric() || c == '_' || c == '-')
            || k.name.is_empty()
        {
            decoder.diags.push(
                Diagnostic::new("name", format!("{label}: this is not a name"))
                    .at(k.span.clone(), "")
                    .help("a name is made of letters, digits, _ and -"),
            );
            continue;
        }
        let before = decoder.diags.list.len();
        let object = decoder.object(&label, &k.span, &v, kinds).ok();
        if object.is_none() && decoder.diags.list.len() == before {
            // It uses a parameter that is wrong.
            decoder.diags.skipped += 1;
        }
        list.push((k.name, object));
    }
    list
}
