//! The scene file's JSON Schema, made from its grammar.

use super::grammar::{Block, Key, Kind, Need, SCENE};
use crate::optics::glass;
use serde_json::{Map, Value, json};

/// The JSON Schema (draft 2020-12) of a scene file, with descriptions, units, defaults, bounds.
pub fn schema() -> Value {
    let mut schema = block(&SCENE, None);
    schema["$schema"] = json!("https://json-schema.org/draft/2020-12/schema");
    schema["title"] = json!("midair scene");
    schema
}

fn block(block: &Block, kind: Option<&str>) -> Value {
    let properties: Map<String, Value> = block
        .keys
        .iter()
        .map(|k| {
            let value = match kind {
                Some(kind) if k.name == "kind" => {
                    json!({ "const": kind, "description": k.about })
                }
                _ => key(k),
            };
            (k.name.to_owned(), value)
        })
        .collect();
    let required: Vec<&str> =
        block.keys.iter().filter(|k| matches!(k.need, Need::Required)).map(|k| k.name).collect();
    let mut schema = json!({
        "type": "object",
        "description": block.about,
        "properties": properties,
        "required": required,
        "additionalProperties": false,
    });
    if let [group] = block.exactly_one {
        schema["oneOf"] = group.iter().map(|name| json!({ "required": [name] })).collect();
    }
    schema
}

fn key(key: &Key) -> Value {
    let mut schema = kind(&key.kind);
    match key.unit {
        Some("mm") => allow_text(&mut schema, "^[-+]?[0-9.]+ *(mm|um|cm|m|in|ft)$"),
        Some("degrees") => allow_text(&mut schema, "^[-+]?[0-9.]+ *(deg|degrees?|°)$"),
        _ => {}
    }
    schema["description"] = match key.unit {
        Some(unit) => json!(format!("{} ({unit})", key.about)),
        None => json!(key.about),
    };
    let default = match &key.need {
        Need::Required | Need::Optional => None,
        Need::Number(n) => Some(json!(n)),
        Need::Numbers(n) => Some(json!(n)),
        Need::Integer(n) => Some(json!(n)),
        Need::Integers(n) => Some(json!(n)),
        Need::Flag(f) => Some(json!(f)),
        Need::Text(t) => Some(json!(t)),
    };
    if let Some(default) = default {
        schema["default"] = default;
    }
    schema
}

/// Numbers may be texts with a unit as well.
fn allow_text(schema: &mut Value, pattern: &str) {
    if schema["type"] == "number" {
        schema["type"] = json!(["number", "string"]);
        schema["pattern"] = json!(pattern);
    } else if schema["items"].is_object() {
        allow_text(&mut schema["items"], pattern);
    }
}

fn number(least: f64, most: f64) -> Value {
    json!({ "type": "number", "minimum": least, "maximum": most })
}

fn list(item: Value, len: usize) -> Value {
    json!({ "type": "array", "items": item, "minItems": len, "maxItems": len })
}

fn kind(kind: &Kind) -> Value {
    match kind {
        Kind::Text => json!({ "type": "string" }),
        Kind::File => json!({ "type": "string", "minLength": 1 }),
        Kind::Flag => json!({ "type": "boolean" }),
        &Kind::Number(least, most) => number(least, most),
        Kind::Integer(least, most) => {
            json!({ "type": "integer", "minimum": least, "maximum": most })
        }
        &Kind::Numbers(len, least, most) => list(number(least, most), len),
        Kind::Integers(len, least, most) => {
            list(json!({ "type": "integer", "minimum": least, "maximum": most }), *len)
        }
        &Kind::Colour(least, most) => {
            json!({ "anyOf": [number(least, most), list(number(least, most), 3)] })
        }
        &Kind::Rows(least, most) => json!({
            "type": "array",
            "minItems": 2,
            "items": { "type": "array", "minItems": 2, "items": number(least, most) },
        }),
        &Kind::List(least, most) => json!({ "type": "array", "items": number(least, most) }),
        &Kind::Points(count, least, most) => json!({
            "type": "array",
            "minItems": count,
            "items": list(number(least, most), 2),
        }),
        Kind::Choice(choices) => json!({ "enum": choices }),
        Kind::Glass => {
            json!({ "type": "string", "examples": glass::names().collect::<Vec<_>>() })
        }
        Kind::Block(inner) => block(inner, None),
        Kind::Blocks(inner) => json!({ "type": "array", "items": block(inner, None) }),
        Kind::Variants(variants) => json!({
            "oneOf": variants.iter().map(|(kind, b)| block(b, Some(kind))).collect::<Vec<_>>()
        }),
    }
}
