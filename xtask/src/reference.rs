//! `cargo xtask reference`: the parts of the book that the program itself knows best.
//!
//! They stand between the lines `<!-- generated: NAME -->` and `<!-- end -->`; the step `book` of `cargo xtask test`
//! fails where they are not what the program says.

use crate::{book, process};
use anyhow::{Context, Result, bail};
use serde_json::Value;
use std::process::Command;

const SCENE_PAGE: &str = "docs/reference/scene-file.md";
const COMMANDS_PAGE: &str = "docs/reference/commands.md";

/// Brings the pages up to date.
pub fn write() -> Result<()> {
    process::build_for_tests()?;
    for (page, name, text) in generated()? {
        let path = crate::root().join(page);
        let old = std::fs::read_to_string(&path).with_context(|| page.to_owned())?;
        std::fs::write(&path, replaced(&old, name, &text).with_context(|| page.to_owned())?)?;
    }
    Ok(())
}

/// Whether the pages are up to date.
pub fn check() -> Result<()> {
    for (page, name, text) in generated()? {
        let old =
            std::fs::read_to_string(crate::root().join(page)).with_context(|| page.to_owned())?;
        if replaced(&old, name, &text).with_context(|| page.to_owned())? != old {
            bail!("{page}: `{name}` is not what the program says; run `cargo xtask reference`");
        }
    }
    Ok(())
}

fn generated() -> Result<[(&'static str, &'static str, String); 2]> {
    let schema: Value = serde_json::from_str(&midair(&["schema"])?)?;
    Ok([
        (SCENE_PAGE, "scene file", scene_tables(&schema)),
        (COMMANDS_PAGE, "commands", commands()?),
    ])
}

/// What the program prints.
fn midair(arguments: &[&str]) -> Result<String> {
    let mut command = Command::new(book::program_folder(book::Profile::Dev).join("midair"));
    // The width of help must not depend on the terminal.
    let output = command.args(arguments).env("COLUMNS", "100").output();
    let output = output.with_context(|| format!("cannot run `{}`", process::shown(&command)))?;
    if !output.status.success() {
        bail!("`{}` failed ({})", process::shown(&command), output.status);
    }
    Ok(String::from_utf8(output.stdout)?)
}

/// A page with the text between the markers exchanged.
fn replaced(page: &str, name: &str, text: &str) -> Result<String> {
    let start = format!("<!-- generated: {name} -->\n");
    let (before, rest) =
        page.split_once(&start).with_context(|| format!("no line {}", start.trim()))?;
    let (_, after) = rest.split_once("<!-- end -->").context("no line <!-- end -->")?;
    Ok(format!("{before}{start}\n{}\n\n<!-- end -->{after}", text.trim()))
}

/// The help of each command.
fn commands() -> Result<String> {
    let overview = midair(&["--help"])?;
    let mut text = format!("```text\n{overview}```\n");
    for name in subcommands(&overview) {
        let help = midair(&[name, "--help"])?;
        text += &format!("\n## `midair {name}`\n\n```text\n{help}```\n");
        for inner in subcommands(&help) {
            let help = midair(&[name, inner, "--help"])?;
            text += &format!("\n### `midair {name} {inner}`\n\n```text\n{help}```\n");
        }
    }
    Ok(text)
}

/// The commands that a help text lists.
fn subcommands(help: &str) -> impl Iterator<Item = &str> {
    let list = help.split("Commands:\n").nth(1).unwrap_or_default();
    let lines = list.lines().take_while(|line| !line.is_empty());
    let names = lines.filter_map(|line| line.strip_prefix("  ")?.split(' ').next());
    names.filter(|name| !name.is_empty() && *name != "help")
}

/// A table of keys for each block of the scene file.
fn scene_tables(schema: &Value) -> String {
    let mut text = String::new();
    block(&mut text, "Top level", schema);
    let properties = &schema["properties"];
    for name in ["viewpoint", "image", "plate", "display", "tracker"] {
        block(&mut text, &format!("`[{name}]`"), &properties[name]);
    }
    let element = &properties["element"]["items"];
    block(&mut text, "`[[element]]`", element);
    let parts = &element["properties"];
    block(&mut text, "`material`", &parts["material"]);
    block(&mut text, "`fill`", &parts["fill"]);
    for shape in parts["shape"]["oneOf"].as_array().into_iter().flatten() {
        let kind = shape["properties"]["kind"]["const"].as_str().unwrap_or_default();
        block(&mut text, &format!("`shape = {{ kind = \"{kind}\", ... }}`"), shape);
    }
    text
}

fn block(text: &mut String, title: &str, schema: &Value) {
    let about = schema["description"].as_str().unwrap_or_default();
    *text += &format!(
        "### {title}\n\n{about}\n\n| key | value | default | |\n| --- | --- | --- | --- |\n"
    );
    let required = |name: &str| {
        schema["required"].as_array().is_some_and(|list| list.iter().any(|key| key == name))
    };
    for (name, key) in schema["properties"].as_object().into_iter().flatten() {
        if key.get("const").is_some() {
            continue;
        }
        let default = match key.get("default") {
            Some(default) => format!("`{default}`"),
            None if required(name) => "must be given".to_owned(),
            None => String::new(),
        };
        let about = key["description"].as_str().unwrap_or_default();
        *text += &format!("| `{name}` | {} | {default} | {about} |\n", value(key));
    }
    *text += "\n";
}

/// What a key's value may be, in words.
fn value(schema: &Value) -> String {
    let words = |list: &Value, wrap: fn(&Value) -> String| {
        list.as_array().into_iter().flatten().map(wrap).collect::<Vec<_>>()
    };
    if schema.get("enum").is_some() {
        return words(&schema["enum"], |choice| format!("`{choice}`")).join(" or ");
    }
    if schema.get("anyOf").is_some() {
        return words(&schema["anyOf"], value).join(", or ");
    }
    if schema.get("oneOf").is_some() && schema.get("properties").is_none() {
        return "a block, see below".to_owned();
    }
    // A number may be a text with its unit, as all of a kind: the page says so once.
    match schema["type"][0].as_str().or(schema["type"].as_str()).unwrap_or_default() {
        "object" => "a block, see below".to_owned(),
        "array" => match (&schema["items"]["type"], schema["maxItems"].as_u64()) {
            (Value::String(kind), _) if kind == "object" => "blocks, see below".to_owned(),
            (Value::String(kind), _) if kind == "array" => {
                match schema["items"]["maxItems"].as_u64() {
                    Some(2) => "points".to_owned(),
                    _ => "rows of numbers".to_owned(),
                }
            }
            (_, Some(count)) => format!("{count} × {}", value(&schema["items"])),
            _ => "a list".to_owned(),
        },
        kind @ ("number" | "integer") => {
            let name = if kind == "number" { "number" } else { "whole number" };
            let bound = |key: &str| schema[key].as_f64().filter(|b| b.abs() < 3.6e4 && *b != 1e-6);
            match (bound("minimum"), bound("maximum")) {
                (Some(low), Some(high)) => format!("{name}, {low} to {high}"),
                (Some(low), None) => format!("{name}, {low} or more"),
                _ => name.to_owned(),
            }
        }
        "boolean" => "`true` or `false`".to_owned(),
        "string" => "text".to_owned(),
        other => other.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_text_between_the_markers_is_exchanged() {
        let page = "a\n<!-- generated: x -->\nold\n<!-- end -->\nb\n";
        let new = replaced(page, "x", "new").unwrap();
        assert_eq!(new, "a\n<!-- generated: x -->\n\nnew\n\n<!-- end -->\nb\n");
        assert_eq!(replaced(&new, "x", "new").unwrap(), new);
        assert!(replaced(page, "y", "new").is_err());
    }

    #[test]
    fn commands_are_found_in_help() {
        let help = "X\n\nCommands:\n  a     Do a\n          more of it\n  help  Print this\n\nOptions:\n  -v\n";
        assert_eq!(subcommands(help).collect::<Vec<_>>(), ["a"]);
        assert_eq!(subcommands("Usage: x").count(), 0);
    }

    #[test]
    fn keys_are_told_with_their_bounds_and_defaults() {
        let schema = json!({
            "description": "A thing.",
            "required": ["n"],
            "properties": {
                "n": { "type": "integer", "minimum": 1, "maximum": 9, "description": "How many." },
                "c": { "enum": ["a", "b"], "default": "a", "description": "Which." },
                "p": { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
            }
        });
        let mut text = String::new();
        block(&mut text, "T", &schema);
        assert!(
            text.contains("| `n` | whole number, 1 to 9 | must be given | How many. |"),
            "{text}"
        );
        assert!(text.contains("| `c` | `\"a\"` or `\"b\"` | `\"a\"` | Which. |"));
        assert!(text.contains("| `p` | 3 × number |  |  |"));
    }
}
