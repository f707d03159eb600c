//! Changes of TOML text.

use super::path::Step;
use super::{Change, Setting};
use toml_edit::{Array, DocumentMut, Item, Table, TableLike, Value};

/// The text with the changes made.
///
/// # Errors
/// What the text's form does not allow.
pub(super) fn write(text: &str, changes: &[Change]) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    for (steps, value) in changes {
        put(document.as_table_mut(), steps, value.as_ref())?;
    }
    Ok(document.to_string())
}

fn put(block: &mut dyn TableLike, steps: &[Step], value: Option<&Setting>) -> Result<(), String> {
    match steps {
        [Step::Key(key)] => {
            match value {
                None => drop(block.remove(key)),
                Some(value) => match block.get_mut(key) {
                    Some(item) => replace(item, value),
                    None => drop(block.insert(key, Item::Value(fresh(value)))),
                },
            }
            Ok(())
        }
        [Step::Key(key), Step::Item(i), rest @ ..] => {
            let missing = || format!("the file has no `{key}` number {i}");
            match block.get_mut(key).ok_or_else(missing)? {
                Item::ArrayOfTables(tables) => {
                    put(tables.get_mut(*i).ok_or_else(missing)?, rest, value)
                }
                Item::Value(Value::Array(list)) => {
                    let table = list.get_mut(*i).and_then(Value::as_inline_table_mut);
                    put(table.ok_or_else(missing)?, rest, value)
                }
                _ => Err(missing()),
            }
        }
        [Step::Key(key), rest @ ..] => {
            if block.get(key).is_none() {
                if value.is_none() {
                    return Ok(());
                }
                block.insert(key, Item::Table(Table::new()));
            }
            let inner = block.get_mut(key).and_then(Item::as_table_like_mut);
            put(inner.ok_or_else(|| format!("`{key}` is not a block of keys"))?, rest, value)
        }
        _ => Err("this names no key".to_owned()),
    }
}

/// A value in the place of another; what stands around it stays, and so do the numbers of a list that are the same.
fn replace(item: &mut Item, value: &Setting) {
    let Item::Value(old) = item else {
        *item = Item::Value(fresh(value));
        return;
    };
    match (old, value) {
        (Value::Array(list), Setting::Numbers(new)) if list.len() == new.len() => {
            for (old, &new) in list.iter_mut().zip(new) {
                let written = old.as_str().and_then(super::super::tree::measured);
                let written = written.or(old.as_float()).or(old.as_integer().map(|i| i as f64));
                let same = written == Some(new);
                if !same {
                    exchange(old, new.into());
                }
            }
        }
        (Value::Array(list), Setting::Integers(new)) if list.len() == new.len() => {
            for (old, &new) in list.iter_mut().zip(new) {
                if old.as_integer() != Some(new) {
                    exchange(old, new.into());
                }
            }
        }
        (old, value) => exchange(old, fresh(value)),
    }
}

fn exchange(old: &mut Value, mut new: Value) {
    *new.decor_mut() = old.decor().clone();
    *old = new;
}

fn fresh(value: &Setting) -> Value {
    match value {
        Setting::Flag(flag) => (*flag).into(),
        Setting::Integer(i) => (*i).into(),
        Setting::Number(n) => (*n).into(),
        Setting::Text(text) => text.as_str().into(),
        Setting::Integers(integers) => Value::Array(integers.iter().copied().collect()),
        Setting::Numbers(numbers) => Value::Array(numbers.iter().copied().collect()),
        Setting::Rows(rows) => {
            let row = |row: &Vec<f64>| Value::Array(row.iter().copied().collect());
            Value::Array(rows.iter().map(row).collect::<Array>())
        }
    }
}
