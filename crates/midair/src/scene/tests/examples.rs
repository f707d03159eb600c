//! The example scenes, and the schema that all scenes follow.

use super::*;
use crate::scene::tree::Value;

pub(super) fn scenes() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn scene_files() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = ["", "paper"]
        .iter()
        .flat_map(|folder| std::fs::read_dir(scenes().join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    assert!(files.len() >= 13, "{files:?}");
    files
}

#[test]
fn every_example_loads() {
    for path in scene_files() {
        match load(&path) {
            Ok(loaded) => {
                assert_eq!(loaded.assets.len(), loaded.scene.elements.len());
            }
            Err(error) if path.ends_with("bunny.toml") => {
                // The mesh is not shipped: the message names it, at the line that asks for it.
                assert!(error.message.contains("bunny.ply"), "{error}");
                assert!(error.place.contains("bunny.toml:"), "{error}");
            }
            Err(error) => panic!("{error}"),
        }
    }
}

#[test]
fn every_example_follows_the_schema() {
    let schema = schema();
    jsonschema::meta::validate(&schema).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    for path in scene_files() {
        let text = std::fs::read_to_string(&path).unwrap();
        let value = json_of(&text);
        if let Err(error) = validator.validate(&value) {
            panic!("{}: {error}", path.display());
        }
    }
    for (from, to) in [
        ("radius = 25.0", "radus = 25.0"),
        ("radius = 25.0", "radius = 0.0"),
        ("size = [20, 20.0]\n", ""),
        ("ior = 1.49", "ior = 1.49, mirror = true"),
        ("[64, 32]", "[64]"),
    ] {
        assert!(!validator.is_valid(&json_of(&with(from, to))), "{to} is valid");
    }
}

/// TOML text as JSON, by the tree.
fn json_of(text: &str) -> serde_json::Value {
    fn value(node: &tree::Node) -> serde_json::Value {
        match &node.value {
            Value::Flag(f) => (*f).into(),
            Value::Integer(i) => (*i).into(),
            Value::Number(n) => (*n).into(),
            Value::Text(t) => t.clone().into(),
            Value::List(list) => list.iter().map(value).collect(),
            Value::Table(table) => table.iter().map(|e| (e.key.clone(), value(&e.node))).collect(),
            Value::Other(_) => serde_json::Value::Null,
        }
    }
    value(&tree::parse(&SceneText::new("a", text), text, Format::Toml).unwrap())
}

#[test]
fn schema_and_reader_know_the_same_keys() {
    // What a scene with everything in it is written with are the keys that the reader reads; the schema
    // has those, and the ones that stand for several of them.
    fn schema_keys(schema: &serde_json::Value, keys: &mut std::collections::BTreeSet<String>) {
        match schema {
            serde_json::Value::Object(object) => {
                if let Some(properties) = object.get("properties").and_then(|p| p.as_object()) {
                    keys.extend(properties.keys().cloned());
                }
                object.values().for_each(|v| schema_keys(v, keys));
            }
            serde_json::Value::Array(list) => list.iter().for_each(|v| schema_keys(v, keys)),
            _ => {}
        }
    }
    let mut known = std::collections::BTreeSet::new();
    schema_keys(&schema(), &mut known);
    let mut written = std::collections::BTreeSet::new();
    fn keys(node: &tree::Node, written: &mut std::collections::BTreeSet<String>) {
        match &node.value {
            Value::Table(table) => {
                for entry in table {
                    written.insert(entry.key.clone());
                    keys(&entry.node, written);
                }
            }
            Value::List(list) => list.iter().for_each(|n| keys(n, written)),
            _ => {}
        }
    }
    let mut runner = proptest::test_runner::TestRunner::deterministic();
    for _ in 0..200 {
        let scene = scene_strategy().new_tree(&mut runner).unwrap().current();
        let text = to_toml(&scene);
        keys(&tree::parse(&SceneText::new("a", &text), &text, Format::Toml).unwrap(), &mut written);
    }
    written.insert("$schema".into());
    // A display described so is written by its size and resolution.
    written.extend(["diagonal_inches", "portrait", "ppi"].map(String::from));
    // Swept, hollow and opaque elements are written and read in tests of their own.
    let solids = "aspheric_back aspheric_front conic fill opaque open outline profile smooth thickness tube wall";
    written.extend(solids.split(' ').map(String::from));
    assert_eq!(known, written);
}
