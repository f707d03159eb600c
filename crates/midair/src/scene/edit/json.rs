//! Changes of JSON text.

use super::super::tree::STRICT;
use super::path::Step;
use super::{Change, Setting};
use jsonc_parser::cst::{CstInputValue, CstNode, CstObject, CstRootNode};

/// The text with the changes made.
///
/// # Errors
/// What the text's form does not allow.
pub(super) fn write(text: &str, changes: &[Change]) -> Result<String, String> {
    let root = CstRootNode::parse(text, &STRICT).map_err(|error| error.to_string())?;
    let block = root.object_value().ok_or("the outermost value must be an object")?;
    for (steps, value) in changes {
        put(&block, steps, value.as_ref())?;
    }
    Ok(root.to_string())
}

fn put(block: &CstObject, steps: &[Step], value: Option<&Setting>) -> Result<(), String> {
    match steps {
        [Step::Key(key)] => {
            match (value, block.get(key)) {
                (None, Some(property)) => property.remove(),
                (None, None) => {}
                (Some(value), Some(property)) => match property.value() {
                    Some(old) => replace(old, value),
                    None => property.set_value(fresh(value)),
                },
                (Some(value), None) => drop(block.append(key, fresh(value))),
            }
            Ok(())
        }
        [Step::Key(key), Step::Item(i), rest @ ..] => {
            let list = block.array_value(key);
            let item = list.and_then(|list| list.elements().into_iter().nth(*i));
            let item = item.and_then(|item| item.as_object());
            put(&item.ok_or_else(|| format!("the file has no `{key}` number {i}"))?, rest, value)
        }
        [Step::Key(key), rest @ ..] => {
            if value.is_none() && block.get(key).is_none() {
                return Ok(());
            }
            let inner = block.object_value_or_create(key);
            put(&inner.ok_or_else(|| format!("`{key}` is not a block of keys"))?, rest, value)
        }
        _ => Err("this names no key".to_owned()),
    }
}

/// A value in the place of another; the numbers of a list that are the same stay as they are written.
fn replace(old: CstNode, value: &Setting) {
    let numbers: Option<Vec<f64>> = match value {
        Setting::Numbers(numbers) => Some(numbers.clone()),
        Setting::Integers(integers) => Some(integers.iter().map(|&i| i as f64).collect()),
        _ => None,
    };
    let items = old.as_array().map(|list| list.elements()).unwrap_or_default();
    let CstInputValue::Array(written) = fresh(value) else { return exchange(old, fresh(value)) };
    match numbers {
        Some(numbers) if numbers.len() == items.len() => {
            for ((item, number), written) in items.into_iter().zip(numbers).zip(written) {
                let before = item.as_number_lit().and_then(|item| item.to_string().parse().ok());
                if before != Some(number) {
                    exchange(item, written);
                }
            }
        }
        _ => exchange(old, fresh(value)),
    }
}

fn exchange(old: CstNode, new: CstInputValue) {
    if let Some(number) = old.as_number_lit() {
        number.replace_with(new);
    } else if let Some(text) = old.as_string_lit() {
        text.replace_with(new);
    } else if let Some(flag) = old.as_boolean_lit() {
        flag.replace_with(new);
    } else if let Some(list) = old.as_array() {
        list.replace_with(new);
    } else if let Some(object) = old.as_object() {
        object.replace_with(new);
    }
}

fn fresh(value: &Setting) -> CstInputValue {
    // The shortest text that reads back as the same number, and is JSON.
    let number = |number: &f64| CstInputValue::Number(format!("{number:?}"));
    let list = |numbers: &[f64]| CstInputValue::Array(numbers.iter().map(number).collect());
    match value {
        Setting::Flag(flag) => CstInputValue::Bool(*flag),
        Setting::Integer(i) => CstInputValue::Number(i.to_string()),
        Setting::Number(n) => number(n),
        Setting::Text(text) => CstInputValue::String(text.clone()),
        Setting::Integers(integers) => CstInputValue::Array(
            integers.iter().map(|i| CstInputValue::Number(i.to_string())).collect(),
        ),
        Setting::Numbers(numbers) => list(numbers),
        Setting::Rows(rows) => CstInputValue::Array(rows.iter().map(|row| list(row)).collect()),
    }
}
