//! The values of a table that conforms to a block.

use crate::scene::grammar::{Block, Kind, Need};
use crate::scene::model::{Pose, Rectangle};
use crate::scene::tree::{Entry, Node, Value, measured};

/// A table with the block that it conforms to: values given, else the grammar's defaults.
///
/// Every getter is `None` where the key is neither given nor has a default of that type.
pub struct Fields<'a> {
    pub(super) block: &'a Block,
    pub(super) table: &'a [Entry],
}

impl<'a> Fields<'a> {
    /// A table that conforms to a block.
    pub fn new(block: &'a Block, table: &'a [Entry]) -> Self {
        Self { block, table }
    }

    /// What stands at a key.
    pub fn given(&self, key: &str) -> Option<&'a Node> {
        self.table.iter().find(|e| e.key == key).map(|e| &e.node)
    }

    /// What stands for a key that is left out.
    pub fn default(&self, key: &str) -> Option<&'a Need> {
        self.block.keys.iter().find(|k| k.name == key).map(|k| &k.need)
    }

    /// A number.
    pub fn number(&self, key: &str) -> Option<f64> {
        match self.given(key) {
            Some(node) => number(node),
            None => match self.default(key)? {
                Need::Number(n) => Some(*n),
                _ => None,
            },
        }
    }

    /// A whole number.
    pub fn integer(&self, key: &str) -> Option<i64> {
        match self.given(key) {
            Some(Node { value: Value::Integer(i), .. }) => Some(*i),
            Some(_) => None,
            None => match self.default(key)? {
                Need::Integer(i) => Some(*i),
                _ => None,
            },
        }
    }

    /// So many numbers.
    pub fn numbers<const N: usize>(&self, key: &str) -> Option<[f64; N]> {
        match self.given(key) {
            Some(Node { value: Value::List(list), .. }) => {
                list.iter().map(number).collect::<Option<Vec<_>>>()?.try_into().ok()
            }
            Some(_) => None,
            None => match self.default(key)? {
                Need::Numbers(n) => (*n).try_into().ok(),
                _ => None,
            },
        }
    }

    /// So many sizes.
    pub fn sizes<const N: usize>(&self, key: &str) -> Option<[usize; N]> {
        let integers: Vec<i64> = match self.given(key) {
            Some(Node { value: Value::List(list), .. }) => list
                .iter()
                .map(|n| match n.value {
                    Value::Integer(i) => Some(i),
                    _ => None,
                })
                .collect::<Option<_>>()?,
            Some(_) => return None,
            None => match self.default(key)? {
                Need::Integers(n) => n.to_vec(),
                _ => return None,
            },
        };
        let sizes: Option<Vec<usize>> = integers.iter().map(|&i| i.try_into().ok()).collect();
        sizes?.try_into().ok()
    }

    /// Red, green and blue; one number stands for all three.
    pub fn colour(&self, key: &str) -> Option<[f64; 3]> {
        match self.given(key) {
            Some(Node { value: Value::List(_), .. }) => self.numbers(key),
            _ => self.number(key).map(|n| [n; 3]),
        }
    }

    /// True or false.
    pub fn flag(&self, key: &str) -> Option<bool> {
        match self.given(key) {
            Some(Node { value: Value::Flag(flag), .. }) => Some(*flag),
            Some(_) => None,
            None => match self.default(key)? {
                Need::Flag(flag) => Some(*flag),
                _ => None,
            },
        }
    }

    /// A text.
    pub fn text(&self, key: &str) -> Option<&'a str> {
        match self.given(key) {
            Some(Node { value: Value::Text(text), .. }) => Some(text),
            Some(_) => None,
            None => match self.default(key)? {
                Need::Text(text) => Some(text),
                _ => None,
            },
        }
    }

    /// Rows of numbers.
    pub fn rows(&self, key: &str) -> Option<Vec<Vec<f64>>> {
        let Value::List(rows) = &self.given(key)?.value else { return None };
        rows.iter()
            .map(|row| match &row.value {
                Value::List(samples) => samples.iter().map(number).collect(),
                _ => None,
            })
            .collect()
    }

    /// Numbers, of any length.
    pub fn list(&self, key: &str) -> Option<Vec<f64>> {
        match self.given(key) {
            Some(Node { value: Value::List(list), .. }) => list.iter().map(number).collect(),
            Some(_) => None,
            None => match self.default(key)? {
                Need::Numbers(n) => Some(n.to_vec()),
                _ => None,
            },
        }
    }

    /// Points.
    pub fn points(&self, key: &str) -> Option<Vec<[f64; 2]>> {
        self.rows(key)?.into_iter().map(|row| row.try_into().ok()).collect()
    }

    /// A block within.
    pub fn block(&self, key: &str) -> Option<Fields<'a>> {
        let kind = &self.block.keys.iter().find(|k| k.name == key)?.kind;
        let Value::Table(table) = &self.given(key)?.value else { return None };
        let block = match kind {
            Kind::Block(block) => block,
            Kind::Variants(variants) => {
                let kind = table.iter().find(|e| e.key == "kind")?;
                let Value::Text(kind) = &kind.node.value else { return None };
                variants.iter().find(|(name, _)| name == kind)?.1
            }
            _ => return None,
        };
        Some(Fields { block, table })
    }

    /// The blocks of a list of them.
    pub fn blocks(&self, key: &str) -> Vec<Fields<'a>> {
        let kind = self.block.keys.iter().find(|k| k.name == key).map(|k| &k.kind);
        let (Some(Kind::Blocks(block)), Some(Node { value: Value::List(list), .. })) =
            (kind, self.given(key))
        else {
            return Vec::new();
        };
        let tables = list.iter().filter_map(|item| match &item.value {
            Value::Table(table) => Some(Fields { block, table }),
            _ => None,
        });
        tables.collect()
    }

    /// A place and a turn.
    pub fn pose(&self) -> Option<Pose> {
        Some(Pose { position: self.numbers("position")?, rotation: self.numbers("rotation")? })
    }

    /// A place, a turn and a size.
    pub fn rectangle(&self) -> Option<Rectangle> {
        Some(Rectangle { pose: self.pose()?, size: self.numbers("size")? })
    }
}

fn number(node: &Node) -> Option<f64> {
    match &node.value {
        Value::Integer(i) => Some(*i as f64),
        Value::Number(n) => Some(*n),
        Value::Text(text) => measured(text),
        _ => None,
    }
}
