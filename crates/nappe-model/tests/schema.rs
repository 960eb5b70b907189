//! The JSON Schema names every kind and key of the registry.

use nappe_model::registry;
use serde_json::Value;

fn document() -> Value {
    serde_json::from_str(&nappe_model::schema()).expect("the schema is JSON")
}

/// The branch of a kind.
fn branch<'a>(doc: &'a Value, table: &str, kind: &str) -> &'a Value {
    doc["$defs"][table]["allOf"]
        .as_array()
        .and_then(|all| {
            all.iter()
                .find(|b| b["if"]["properties"]["kind"]["const"] == kind)
        })
        .map(|b| &b["then"])
        .unwrap_or_else(|| panic!("no branch for {kind}"))
}

#[test]
fn every_kind_and_key_is_in_it() {
    let doc = document();
    assert_eq!(
        doc["$schema"],
        "https://json-schema.org/draft/2020-12/schema"
    );
    assert_eq!(doc["properties"]["nappe"]["const"], 1);
    for (table, kinds) in [("curve", registry::CURVES), ("surface", registry::SURFACES)] {
        let names: Vec<&str> = kinds.iter().map(|k| k.name).collect();
        assert_eq!(
            doc["$defs"][table]["properties"]["kind"]["enum"],
            serde_json::json!(names)
        );
        for kind in kinds {
            let branch = branch(&doc, table, kind.name);
            for key in kind.keys {
                let schema = &branch["properties"][key.name];
                assert!(
                    schema["description"].is_string(),
                    "{} of {}",
                    key.name,
                    kind.name
                );
                let required = branch["required"]
                    .as_array()
                    .expect("a list")
                    .contains(&key.name.into());
                assert_eq!(
                    required,
                    key.need == registry::Need::Required,
                    "{} of {}",
                    key.name,
                    kind.name
                );
            }
            assert_eq!(branch["additionalProperties"], false);
        }
    }
}

#[test]
fn references_lead_somewhere() {
    fn walk(value: &Value, defs: &Value) {
        match value {
            Value::Object(map) => {
                if let Some(Value::String(target)) = map.get("$ref") {
                    let name = target.strip_prefix("#/$defs/").expect("a local reference");
                    assert!(defs.get(name).is_some(), "{target}");
                }
                map.values().for_each(|v| walk(v, defs));
            }
            Value::Array(list) => list.iter().for_each(|v| walk(v, defs)),
            _ => {}
        }
    }
    let doc = document();
    walk(&doc, &doc["$defs"]);
}
