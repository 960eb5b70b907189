//! The JSON Schema (draft 2020-12) of the model file, made from the registry: editors complete and check with it.

use crate::registry::{CHECK, CURVES, Key, Kind, Need, SURFACES, Shape, TOP};
use serde_json::{Map, Value, json};

/// The schema as JSON text.
pub fn schema() -> String {
    let mut properties = Map::new();
    for k in TOP {
        properties.insert(k.name.into(), described(shape(&k.shape), k));
    }
    properties["nappe"] = json!({ "const": 1, "description": "the version of the format" });
    properties.insert(
        "params".into(),
        json!({
            "type": "object",
            "description": "numbers by name, for expressions",
            "additionalProperties": { "$ref": "#/$defs/parameter" }
        }),
    );
    let table = |kind: &str, what: &str| {
        json!({
            "type": "object",
            "description": what,
            "propertyNames": { "pattern": "^[^\\s./]+$" },
            "additionalProperties": { "$ref": format!("#/$defs/{kind}") }
        })
    };
    properties.insert("curves".into(), table("curve", "curves by name"));
    properties.insert("surfaces".into(), table("surface", "surfaces by name"));
    properties.insert(
        "checks".into(),
        json!({ "type": "array", "description": "claims that `nappe check` proves", "items": record(CHECK, None) }),
    );
    let defs = json!({
        "number": {
            "type": ["number", "string"],
            "description": "a number, or an expression over the parameters in quotes"
        },
        "vector": { "type": "array", "items": { "$ref": "#/$defs/number" }, "minItems": 3, "maxItems": 3 },
        "angle": {
            "type": "string",
            "pattern": "(deg|rad|turn)\\s*$",
            "description": "a number or expression with its unit: \"45deg\", \"0.5rad\", \"1/4 turn\""
        },
        "side": {
            "type": "string",
            "pattern": "\\.(south|north|west|east)$",
            "description": "a side of a surface: south is v = 0, north v = 1, west u = 0, east u = 1"
        },
        "parameter": {
            "anyOf": [
                { "$ref": "#/$defs/number" },
                {
                    "type": "object",
                    "properties": {
                        "value": { "$ref": "#/$defs/number" },
                        "min": { "$ref": "#/$defs/number" },
                        "max": { "$ref": "#/$defs/number" },
                        "doc": { "type": "string" }
                    },
                    "required": ["value"],
                    "additionalProperties": false
                }
            ]
        },
        "curve": kinds(CURVES),
        "surface": kinds(SURFACES)
    });
    let document = json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "nappe model file",
        "type": "object",
        "properties": properties,
        "required": ["nappe"],
        "additionalProperties": false,
        "$defs": defs
    });
    // A tree of texts and lists always prints.
    serde_json::to_string_pretty(&document).unwrap_or_default() + "\n"
}

/// One of the kinds, told apart by `kind`.
fn kinds(kinds: &[Kind]) -> Value {
    let names: Vec<&str> = kinds.iter().map(|k| k.name).collect();
    let branches: Vec<Value> = kinds
        .iter()
        .map(|k| {
            json!({
                "if": { "properties": { "kind": { "const": k.name } }, "required": ["kind"] },
                "then": record(k.keys, Some(k))
            })
        })
        .collect();
    json!({
        "type": "object",
        "properties": { "kind": { "enum": names } },
        "required": ["kind"],
        "allOf": branches
    })
}

/// A table with keys; of a kind, with `kind` and `construction_only` too.
fn record(keys: &[Key], kind: Option<&Kind>) -> Value {
    let mut properties = Map::new();
    if let Some(k) = kind {
        properties.insert(
            "kind".into(),
            json!({ "const": k.name, "description": k.doc }),
        );
        properties.insert(
            "construction_only".into(),
            json!({ "type": "boolean", "default": false, "description": "built for others, not put out" }),
        );
    }
    let mut required: Vec<&str> = Vec::new();
    let mut forms: Vec<Vec<&str>> = Vec::new();
    for k in keys {
        properties.insert(k.name.into(), described(shape(&k.shape), k));
        match k.need {
            Need::Required => required.push(k.name),
            Need::Form(f) => {
                forms.resize(forms.len().max(f + 1), Vec::new());
                forms[f].push(k.name);
            }
            Need::Optional(_) => {}
        }
    }
    let mut out = json!({
        "type": "object",
        "properties": properties,
        "required": required,
        "additionalProperties": false
    });
    if !forms.is_empty() {
        let forms: Vec<Value> = forms.iter().map(|f| json!({ "required": f })).collect();
        out["oneOf"] = json!(forms);
    }
    out
}

/// Adds what the key is and what happens without it.
fn described(mut schema: Value, key: &Key) -> Value {
    let text = match key.need {
        Need::Optional(default) => format!("{} (default: {default})", key.doc),
        _ => key.doc.to_owned(),
    };
    schema["description"] = json!(text);
    schema
}

fn shape(s: &Shape) -> Value {
    let of = |name: &str| json!({ "$ref": format!("#/$defs/{name}") });
    match s {
        Shape::Number => of("number"),
        Shape::Count(least) => {
            json!({ "anyOf": [{ "type": "integer", "minimum": least }, { "type": "string" }] })
        }
        Shape::Angle => of("angle"),
        Shape::Bool => json!({ "type": "boolean" }),
        Shape::Text | Shape::Surface => json!({ "type": "string" }),
        Shape::Vector => of("vector"),
        Shape::Choice(words) => json!({ "enum": words }),
        Shape::Formula(_) => json!({ "type": ["number", "string"] }),
        Shape::Curve => json!({ "anyOf": [{ "type": "string" }, of("curve")] }),
        Shape::Side => of("side"),
        Shape::List(item, length) => list(shape(item), *length),
        Shape::Grid(item, size) => list(list(shape(item), size.map(|s| s.1)), size.map(|s| s.0)),
        Shape::Record(keys) => record(keys, None),
        Shape::Either(shapes) => {
            let all: Vec<Value> = shapes.iter().map(shape).collect();
            json!({ "anyOf": all })
        }
    }
}

fn list(items: Value, length: Option<usize>) -> Value {
    match length {
        Some(n) => json!({ "type": "array", "items": items, "minItems": n, "maxItems": n }),
        None => json!({ "type": "array", "items": items }),
    }
}
