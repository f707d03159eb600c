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

/// The text with one more element of these keys.
pub(super) fn added(text: &str, keys: &str) -> String {
    format!("{}\n\n[[element]]\n{}\n", text.trim_end(), keys.trim())
}

/// The text without an element.
///
/// # Errors
/// Where there is none of that number.
pub(super) fn without(text: &str, number: usize) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    let missing = || format!("there is no element {number}");
    let left = match document.get_mut("element").ok_or_else(missing)? {
        Item::ArrayOfTables(tables) if number < tables.len() => {
            tables.remove(number);
            tables.len()
        }
        Item::Value(Value::Array(list)) if number < list.len() => {
            list.remove(number);
            list.len()
        }
        _ => return Err(missing()),
    };
    if left == 0 {
        // An empty list is written as `element = []`, and no block of an element could follow.
        document.remove("element");
    }
    Ok(document.to_string())
}

/// The text with one more element like another, by another name.
///
/// # Errors
/// Where there is none of that number.
pub(super) fn with_copy(text: &str, number: usize, name: &str) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    let missing = || format!("there is no element {number}");
    match document.get_mut("element").ok_or_else(missing)? {
        Item::ArrayOfTables(tables) => {
            let mut copy = tables.get(number).ok_or_else(missing)?.clone();
            copy.insert("name", toml_edit::value(name));
            copy.decor_mut().set_prefix("");
            // By itself: within the document its blocks would stand among those of the first.
            let mut alone = DocumentMut::new();
            alone.insert("element", Item::ArrayOfTables([copy].into_iter().collect()));
            Ok(format!("{}\n\n{alone}", text.trim_end()))
        }
        Item::Value(Value::Array(list)) => {
            let mut copy = list.get(number).ok_or_else(missing)?.clone();
            let table = copy.as_inline_table_mut().ok_or_else(missing)?;
            table.insert("name", name.into());
            list.push_formatted(copy);
            Ok(document.to_string())
        }
        _ => Err(missing()),
    }
}

/// The text with a block, written in braces, in the place of the one at these steps.
///
/// # Errors
/// Where `block` is none, or there is no place for it.
pub(super) fn with_block(text: &str, steps: &[Step], block: &str) -> Result<String, String> {
    let mut document: DocumentMut = text.parse().map_err(|error| format!("{error}"))?;
    let value: Value = block.parse().map_err(|error| format!("{error}"))?;
    if !value.is_inline_table() {
        return Err("this is no block of keys".to_owned());
    }
    let [inner @ .., Step::Key(last)] = steps else {
        return Err("this names no block".to_owned());
    };
    let mut table: &mut dyn TableLike = document.as_table_mut();
    let mut rest = inner;
    while let [Step::Key(key), more @ ..] = rest {
        let missing = || format!("the file has no `{key}`");
        let item = table.get_mut(key).ok_or_else(missing)?;
        (table, rest) = match (item, more) {
            (Item::ArrayOfTables(tables), [Step::Item(i), more @ ..]) => {
                (tables.get_mut(*i).ok_or_else(missing)? as &mut dyn TableLike, more)
            }
            (Item::Value(Value::Array(list)), [Step::Item(i), more @ ..]) => {
                let inline = list.get_mut(*i).and_then(Value::as_inline_table_mut);
                (inline.ok_or_else(missing)? as &mut dyn TableLike, more)
            }
            (item, more) => (item.as_table_like_mut().ok_or_else(missing)?, more),
        };
    }
    table.insert(last, Item::Value(value));
    Ok(document.to_string())
}
