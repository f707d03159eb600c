//! Holds a tree of values against the grammar and says what does not conform.

mod words;

use super::error::{SceneError, SceneText};
use super::grammar::{Block, Key, Kind, Need};
use super::tree::{Entry, Node, Value, with_unit};
use crate::optics::glass;
use std::ops::Range;
use words::{
    chosen, example, in_sentence, instead, join, nearest, number_in_text, numeric, quoted,
    shortened, suggestion, wanted,
};

/// Collects every fault of a tree, and records where each key stands.
pub(super) struct Conformance<'a> {
    pub source: &'a mut SceneText,
    pub faults: Vec<SceneError>,
}

impl Conformance<'_> {
    fn fault(&mut self, span: &Range<usize>, message: String, help: String) {
        // A file of a million wrong keys is not worth a million messages.
        const MOST: usize = 64;
        if self.faults.len() >= MOST {
            return;
        }
        let fault = self.source.error(Some(span.clone()), message, help);
        self.faults.push(fault);
    }

    /// Checks a table against a block; `path` is its key, empty for the root.
    pub fn block(&mut self, block: &Block, path: &str, table: &[Entry], span: &Range<usize>) {
        for entry in table {
            match block.keys.iter().find(|key| key.name == entry.key) {
                Some(key) => {
                    let path = join(path, key.name);
                    self.source.record(path.clone(), entry.node.span.clone());
                    self.value(key, &path, &entry.node);
                }
                None => self.unknown_key(block, entry),
            }
        }
        // A misspelt key is not also a missing one.
        let names = || block.keys.iter().map(|k| k.name);
        let misspelt: Vec<&str> = table
            .iter()
            .filter(|e| names().all(|name| name != e.key))
            .take(block.keys.len())
            .filter_map(|e| nearest(&e.key, names()))
            .collect();
        for key in block.keys {
            let given = table.iter().any(|e| e.key == key.name);
            if matches!(key.need, Need::Required) && !given && !misspelt.contains(&key.name) {
                let example = example(key);
                self.fault(
                    span,
                    format!("{} lacks the key `{}`", block.name, key.name),
                    format!("add {example}: {}", in_sentence(key.about)),
                );
            }
        }
        for group in block.exactly_one {
            let given: Vec<&Entry> = table.iter().filter(|e| chosen(group, e)).collect();
            let names = quoted(group.iter().copied());
            match given[..] {
                [_] => {}
                [] if group.iter().any(|name| misspelt.contains(name)) => {}
                [] => self.fault(
                    span,
                    format!("{} needs one of {names}", block.name),
                    format!("give exactly one of them; {}", in_sentence(block.about)),
                ),
                [_, second, ..] => self.fault(
                    &second.key_span,
                    format!(
                        "{} has more than one of {names}: {}",
                        block.name,
                        quoted(given.iter().map(|e| e.key.as_str()))
                    ),
                    "keep exactly one of them".to_owned(),
                ),
            }
        }
    }

    fn unknown_key(&mut self, block: &Block, entry: &Entry) {
        let known = block.keys.iter().map(|k| k.name);
        let all = format!("{} has the keys {}", block.name, quoted(known.clone()));
        self.fault(
            &entry.key_span,
            format!("unknown key `{}` in {}", shortened(&entry.key), block.name),
            suggestion(&entry.key, known, &all),
        );
    }

    fn value(&mut self, key: &Key, path: &str, node: &Node) {
        match (&key.kind, &node.value) {
            (Kind::Text, Value::Text(_)) | (Kind::Flag, Value::Flag(_)) => {}
            (Kind::File, Value::Text(file)) => {
                if file.is_empty() || file.contains('\0') {
                    self.fault(
                        &node.span,
                        format!("`{}` is not a file name", key.name),
                        "give a path relative to the scene file, with forward slashes".to_owned(),
                    );
                }
            }
            (&Kind::Number(least, most), _) => {
                self.number(key, node, least, most);
            }
            (&Kind::Integer(least, most), _) => self.integer(key, node, least, most),
            (&Kind::Numbers(len, least, most), Value::List(list)) => {
                if self.length(key, node, list.len(), len) {
                    list.iter().for_each(|item| self.number(key, item, least, most));
                }
            }
            (&Kind::Integers(len, least, most), Value::List(list)) => {
                if self.length(key, node, list.len(), len) {
                    list.iter().for_each(|item| self.integer(key, item, least, most));
                }
            }
            (&Kind::Colour(least, most), Value::List(list)) => {
                if self.length(key, node, list.len(), 3) {
                    list.iter().for_each(|item| self.number(key, item, least, most));
                }
            }
            (&Kind::Colour(least, most), _) => self.number(key, node, least, most),
            (&Kind::Rows(least, most), Value::List(rows)) => {
                self.rows(key, node, rows, least, most);
            }
            (&Kind::List(least, most), Value::List(list)) => {
                list.iter().for_each(|item| self.number(key, item, least, most));
            }
            (&Kind::Points(count, least, most), Value::List(list)) => {
                self.points(key, node, list, count, [least, most]);
            }
            (&Kind::Choice(choices), Value::Text(text)) => {
                if !choices.contains(&text.as_str()) {
                    self.fault(
                        &node.span,
                        format!("`{}` cannot be `{}`", key.name, shortened(text)),
                        suggestion(
                            text,
                            choices.iter().copied(),
                            &format!("it is one of {}", quoted(choices.iter().copied())),
                        ),
                    );
                }
            }
            (Kind::Glass, Value::Text(text)) => {
                if glass::lookup(text).is_none() {
                    let all = format!(
                        "the catalogue has {}; any other: ior = n, or cauchy = [A, B]",
                        quoted(glass::names())
                    );
                    self.fault(
                        &node.span,
                        format!("unknown glass `{}`", shortened(text)),
                        suggestion(text, glass::names(), &all),
                    );
                }
            }
            (Kind::Block(block), Value::Table(table)) => {
                self.block(block, path, table, &node.span);
            }
            (Kind::Blocks(block), Value::List(list)) => {
                for (i, item) in list.iter().enumerate() {
                    let path = format!("{path}[{i}]");
                    self.source.record(path.clone(), item.span.clone());
                    match &item.value {
                        Value::Table(table) => self.block(block, &path, table, &item.span),
                        _ => self.wrong_type(key, item),
                    }
                }
            }
            (Kind::Variants(variants), Value::Table(table)) => {
                self.variants(key, variants, path, table, &node.span);
            }
            _ => self.wrong_type(key, node),
        }
    }

    fn variants(
        &mut self,
        key: &Key,
        variants: &[(&'static str, &Block)],
        path: &str,
        table: &[Entry],
        span: &Range<usize>,
    ) {
        let names = variants.iter().map(|(name, _)| *name);
        let all = format!("it is one of {}", quoted(names.clone()));
        match table.iter().find(|e| e.key == "kind") {
            None => self.fault(span, format!("`{}` lacks the key `kind`", key.name), all),
            Some(Entry { node: Node { value: Value::Text(kind), span: at }, .. }) => {
                match variants.iter().find(|(name, _)| name == kind) {
                    Some((_, block)) => self.block(block, path, table, span),
                    None => self.fault(
                        at,
                        format!("unknown kind of {} `{}`", key.name, shortened(kind)),
                        suggestion(kind, names, &all),
                    ),
                }
            }
            Some(entry) => {
                let at = entry.node.span.clone();
                self.fault(&at, "`kind` must be a text".to_owned(), all);
            }
        }
    }

    fn length(&mut self, key: &Key, node: &Node, found: usize, wanted: usize) -> bool {
        if found != wanted {
            self.fault(
                &node.span,
                format!("`{}` has {found} numbers where it needs {wanted}", key.name),
                format!("write {}: {}", example(key), in_sentence(key.about)),
            );
        }
        found == wanted
    }

    fn rows(&mut self, key: &Key, node: &Node, rows: &[Node], least: f64, most: f64) {
        let help = "give at least two rows of at least two numbers each, all rows equally long, \
                    the first row at the +y edge";
        let mut width = None;
        for row in rows {
            let Value::List(samples) = &row.value else {
                self.fault(
                    &row.span,
                    format!("a row of `{}` is {}", key.name, row.value.describe()),
                    help.to_owned(),
                );
                return;
            };
            let expected = *width.get_or_insert(samples.len());
            if samples.len() < 2 || samples.len() != expected {
                self.fault(
                    &row.span,
                    format!("a row of `{}` has {} samples", key.name, samples.len()),
                    help.to_owned(),
                );
                return;
            }
            samples.iter().for_each(|s| self.number(key, s, least, most));
        }
        if rows.len() < 2 {
            self.fault(
                &node.span,
                format!("`{}` has too few rows: {}", key.name, rows.len()),
                help.to_owned(),
            );
        }
    }

    fn points(&mut self, key: &Key, node: &Node, list: &[Node], count: usize, bounds: [f64; 2]) {
        for point in list {
            match &point.value {
                Value::List(pair) if pair.len() == 2 => {
                    pair.iter().for_each(|item| self.number(key, item, bounds[0], bounds[1]));
                }
                _ => {
                    let message = format!("a point of `{}` is not two numbers", key.name);
                    self.fault(&point.span, message, format!("write {}", example(key)));
                    return;
                }
            }
        }
        if list.len() < count {
            let message = format!("`{}` has too few points: {}", key.name, list.len());
            self.fault(
                &node.span,
                message,
                format!("give at least {count}: {}", in_sentence(key.about)),
            );
        } else if list.len() > MOST_POINTS {
            let message = format!("`{}` has too many points: {}", key.name, list.len());
            let help = format!("give at most {MOST_POINTS}; smooth = true needs few");
            self.fault(&node.span, message, help);
        }
    }

    fn number(&mut self, key: &Key, node: &Node, least: f64, most: f64) {
        let value = match &node.value {
            Value::Integer(i) => *i as f64,
            Value::Number(n) => *n,
            Value::Text(text) => match with_unit(text, key.unit) {
                Some(value) => value,
                None => return self.wrong_number(key, node),
            },
            _ => return self.wrong_number(key, node),
        };
        let what = key.name;
        if !value.is_finite() {
            self.fault(
                &node.span,
                format!("`{what}` is not a finite number"),
                format!("write {}: {}", example(key), in_sentence(key.about)),
            );
        } else if value < least || value > most {
            let sign = if value == 0.0 && least > 0.0 {
                "is zero"
            } else if value < 0.0 && least >= 0.0 {
                "is negative"
            } else if value < least {
                "is too small"
            } else {
                "is too large"
            };
            let unit = key.unit.map_or(String::new(), |u| format!(" {u}"));
            self.fault(
                &node.span,
                format!("`{what}` {sign}: {value}"),
                format!("it lies between {least} and {most}{unit}"),
            );
        }
    }

    fn integer(&mut self, key: &Key, node: &Node, least: i64, most: i64) {
        match node.value {
            Value::Integer(i) if (least..=most).contains(&i) => {}
            Value::Integer(i) => self.fault(
                &node.span,
                format!("`{}` is too {}: {i}", key.name, if i < least { "small" } else { "large" }),
                format!("it lies between {least} and {most}"),
            ),
            _ => self.wrong_number(key, node),
        }
    }

    /// A value that is not of the key's kind.
    fn wrong_type(&mut self, key: &Key, node: &Node) {
        let what = format!("is {} where it needs {}", node.value.describe(), wanted(&key.kind));
        match instead(key, &node.value) {
            Some(help) => self.fault(&node.span, format!("`{}` {what}", key.name), help),
            None => self.wrong(key, node, what),
        }
    }

    /// An item of the key's list that is no number; of a key that is no list, the value itself.
    fn wrong_number(&mut self, key: &Key, node: &Node) {
        match key.kind {
            Kind::Numbers(..)
            | Kind::Integers(..)
            | Kind::Rows(..)
            | Kind::List(..)
            | Kind::Points(..) => {
                let found = node.value.describe();
                self.wrong(key, node, format!("holds {found}: it needs {}", wanted(&key.kind)));
            }
            _ => self.wrong_type(key, node),
        }
    }

    fn wrong(&mut self, key: &Key, node: &Node, what: String) {
        let message = format!("`{}` {what}", key.name);
        let help = match &node.value {
            Value::Text(text) if numeric(&key.kind) => number_in_text(key, text),
            _ => format!("write {}: {}", example(key), in_sentence(key.about)),
        };
        self.fault(&node.span, message, help);
    }
}

/// Points of a profile: beyond that a mesh is meant.
const MOST_POINTS: usize = 500;
