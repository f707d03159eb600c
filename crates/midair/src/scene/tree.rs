//! TOML and JSON as one tree of values that know their place in the text.

use super::error::{SceneError, SceneText};
use jsonc_parser::ast;
use jsonc_parser::common::Ranged;
use std::ops::Range;
use toml::de::{DeTable, DeValue};

/// The notation of a scene file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// TOML 1.
    Toml,
    /// JSON (RFC 8259) of the same shape.
    Json,
}

impl Format {
    /// By a file's name: JSON if it ends in `.json`, else TOML.
    pub fn of_name(name: &str) -> Self {
        let extension = std::path::Path::new(name).extension();
        if extension.is_some_and(|e| e.eq_ignore_ascii_case("json")) {
            Self::Json
        } else {
            Self::Toml
        }
    }
}

/// JSON as RFC 8259 has it, without the liberties that its readers take.
pub(super) const STRICT: jsonc_parser::ParseOptions = jsonc_parser::ParseOptions {
    allow_comments: false,
    allow_loose_object_property_names: false,
    allow_trailing_commas: false,
    allow_missing_commas: false,
    allow_single_quoted_strings: false,
    allow_hexadecimal_numbers: false,
    allow_unary_plus_numbers: false,
    allow_bare_decimal_point_numbers: false,
    allow_non_finite_numbers: false,
    allow_extended_string_escapes: false,
};

/// A value and the bytes it was read from.
#[derive(Debug)]
pub struct Node {
    /// Its bytes in the text.
    pub span: Range<usize>,
    /// The value.
    pub value: Value,
}

/// One `key = value`.
#[derive(Debug)]
pub struct Entry {
    /// The key.
    pub key: String,
    /// Its bytes in the text.
    pub key_span: Range<usize>,
    /// What it is given.
    pub node: Node,
}

/// A value as TOML and JSON have it.
#[derive(Debug)]
pub enum Value {
    /// True or false.
    Flag(bool),
    /// A whole number.
    Integer(i64),
    /// A number.
    Number(f64),
    /// A text.
    Text(String),
    /// A list.
    List(Vec<Node>),
    /// A block of keys.
    Table(Vec<Entry>),
    /// What neither notation shares: a date, null; named for the message.
    Other(&'static str),
}

impl Value {
    /// What people call this kind of value.
    pub fn describe(&self) -> &'static str {
        match self {
            Value::Flag(_) => "true or false",
            Value::Integer(_) => "a whole number",
            Value::Number(_) => "a number",
            Value::Text(_) => "a text",
            Value::List(_) => "a list",
            Value::Table(_) => "a block of keys",
            Value::Other(name) => name,
        }
    }
}

/// Parses `text`; the root is always a table.
pub(super) fn parse(source: &SceneText, text: &str, format: Format) -> Result<Node, SceneError> {
    match format {
        Format::Toml => match DeTable::parse(text) {
            Ok(table) => Ok(Node { span: 0..0, value: toml_table(table.get_ref()) }),
            Err(error) => Err(match missing_comma(text, error.span()) {
                Some((at, help)) => source.error(Some(at), "a comma is missing here", help),
                None => source.error(
                    Some(error.span().unwrap_or(0..0)),
                    error.message().lines().collect::<Vec<_>>().join("; "),
                    toml_help(text, error.span()),
                ),
            }),
        },
        Format::Json => json(source, text),
    }
}

/// Where, on the line of an error, two values of a list or two keys of an inline table stand side by side: the gap between them, and what to write.
/// The parser says of them what it expected instead, which people read as being about something else.
fn missing_comma(text: &str, span: Option<Range<usize>>) -> Option<(Range<usize>, String)> {
    let at = span?.start.min(text.len());
    let start = start_of_line(text, at);
    let line = text[start..].lines().next()?;
    let (mut depth, mut quoted) = (0usize, false);
    // The last character that is no space, and where it ends.
    let mut last: Option<(char, usize)> = None;
    for (place, c) in line.char_indices() {
        if quoted {
            quoted = c != '"';
        } else {
            if let Some((before, end)) = last
                && end < place
                && !c.is_whitespace()
                && depth > 0
                && (before.is_ascii_digit() || "\"]}".contains(before))
            {
                let rest = &line[place..];
                let word =
                    rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
                // A word is a key if an equals sign follows; else it may be a unit.
                let key =
                    word > 0 && rest[word..].trim_start().starts_with('=') && c.is_alphabetic();
                if key || c.is_ascii_digit() || "-+\"[{".contains(c) {
                    let from =
                        line[..end].rfind(|c: char| " [{,=".contains(c)).map_or(0, |k| k + 1);
                    let to = place + rest.find([' ', ',', ']', '}']).unwrap_or(rest.len());
                    let help = format!("write `{}, {}`", &line[from..end], &line[place..to]);
                    return Some((start + end..start + place, help));
                }
            }
            match c {
                '#' => return None,
                '"' => quoted = true,
                '[' | '{' => depth += 1,
                ']' | '}' => depth = depth.saturating_sub(1),
                _ => {}
            }
        }
        if !c.is_whitespace() || quoted {
            last = Some((c, place + c.len_utf8()));
        }
    }
    None
}

fn toml_help(text: &str, span: Option<Range<usize>>) -> String {
    let start = span.map_or(0, |s| s.start).min(text.len());
    // Most often the error is at a number with its unit.
    let line_start = start_of_line(text, start);
    let (key, from) = match text[line_start..start].rfind('=') {
        Some(equals) => {
            let key = text[line_start..line_start + equals].trim_end();
            (
                key.rsplit(|c: char| c.is_whitespace() || ",{".contains(c)).next(),
                line_start + equals + 1,
            )
        }
        None => (None, start),
    };
    let value = text[from..].split([',', '}', ']', '#', '\n', '\r']).next().unwrap_or("");
    if let Some(key) = key
        && let Some((number, unit)) = split_unit(value)
        && !unit.is_empty()
    {
        return match millimetres(unit) {
            Some(factor) => format!(
                "lengths are plain numbers in millimetres: write `{key} = {:?}`",
                number * factor
            ),
            None => format!("numbers stand without units: write `{key} = {number:?}`"),
        };
    }
    "the file is TOML: `key = value` lines under [block] headers; texts stand in \"quotes\""
        .to_owned()
}

fn start_of_line(text: &str, at: usize) -> usize {
    let bytes = text.as_bytes();
    let mut at = at;
    while at > 0 && bytes[at - 1] != b'\n' {
        at -= 1;
    }
    at
}

/// Splits `"5 cm"` into the number and what follows it, which may be empty.
pub(super) fn split_unit(text: &str) -> Option<(f64, &str)> {
    let text = text.trim();
    let end = text
        .char_indices()
        .find(|&(i, c)| !(c.is_ascii_digit() || c == '.' || (i == 0 && (c == '-' || c == '+'))))
        .map_or(text.len(), |(i, _)| i);
    let number: f64 = text[..end].parse().ok()?;
    let unit = text[end..].trim();
    unit.chars().all(|c| c.is_alphabetic() || c == '°').then_some((number, unit))
}

/// Units of length by name, with the millimetres in one.
pub(super) const UNITS: [(&str, f64); 6] =
    [("mm", 1.0), ("um", 1e-3), ("cm", 10.0), ("m", 1000.0), ("in", 25.4), ("ft", 304.8)];

/// Millimetres in one of a named unit.
pub(super) fn millimetres(unit: &str) -> Option<f64> {
    UNITS.iter().find(|(name, _)| *name == unit).map(|&(_, factor)| factor)
}

/// The value of a text such as `"5 cm"` or `"2.5 in"` where a length is wanted (mm), of `"30 deg"` where an angle is (degrees); `None` for all others, a
/// number without unit among them.
pub(super) fn with_unit(text: &str, wanted: Option<&str>) -> Option<f64> {
    let (number, unit) = split_unit(text)?;
    match (wanted, unit) {
        (Some("mm"), unit) => millimetres(unit).map(|factor| number * factor),
        (Some("degrees"), "deg" | "degree" | "degrees" | "°") => Some(number),
        _ => None,
    }
}

/// The number that a text of the file's stands for, whichever its unit: where it was held to conform, its unit is the one that was wanted.
pub(super) fn measured(text: &str) -> Option<f64> {
    with_unit(text, Some("mm")).or_else(|| with_unit(text, Some("degrees")))
}

fn toml_table(table: &DeTable<'_>) -> Value {
    Value::Table(
        table
            .iter()
            .map(|(key, value)| Entry {
                key: key.get_ref().to_string(),
                key_span: key.span(),
                node: Node { span: value.span(), value: toml_value(value.get_ref()) },
            })
            .collect(),
    )
}

fn toml_value(value: &DeValue<'_>) -> Value {
    match value {
        DeValue::String(text) => Value::Text(text.to_string()),
        DeValue::Integer(integer) => {
            // The parser strips underscores; what does not fit 64 bits is read as a number.
            match i64::from_str_radix(integer.as_str(), integer.radix()) {
                Ok(i) => Value::Integer(i),
                Err(_) => Value::Number(integer.as_str().parse().unwrap_or(f64::INFINITY)),
            }
        }
        DeValue::Float(float) => Value::Number(float.as_str().parse().unwrap_or(f64::NAN)),
        DeValue::Boolean(flag) => Value::Flag(*flag),
        DeValue::Datetime(_) => Value::Other("a date"),
        DeValue::Array(list) => Value::List(
            list.iter()
                .map(|item| Node { span: item.span(), value: toml_value(item.get_ref()) })
                .collect(),
        ),
        DeValue::Table(table) => toml_table(table),
    }
}

fn json(source: &SceneText, text: &str) -> Result<Node, SceneError> {
    let help = "scene files ending in .json are strict JSON: quoted keys, no comments, no \
                trailing commas, no NaN";
    let parsed = jsonc_parser::parse_to_ast(text, &Default::default(), &STRICT).map_err(|e| {
        let range = e.range();
        source.error(Some(range.start..range.end), e.kind().to_string(), help)
    })?;
    match parsed.value {
        Some(root @ ast::Value::Object(_)) => json_value(source, &root),
        Some(other) => {
            let range = other.range();
            Err(source.error(
                Some(range.start..range.end),
                "the outermost value must be an object",
                "put the scene's keys in { }",
            ))
        }
        None => Err(source.error(
            None,
            "the file is empty",
            "it needs at least viewpoint, image, plate and display",
        )),
    }
}

fn json_value(source: &SceneText, value: &ast::Value<'_>) -> Result<Node, SceneError> {
    let range = value.range();
    let span = range.start..range.end;
    let value = match value {
        ast::Value::StringLit(text) => Value::Text(text.value.to_string()),
        ast::Value::NumberLit(number) => match number.value.parse::<i64>() {
            Ok(i) => Value::Integer(i),
            Err(_) => Value::Number(number.value.parse().unwrap_or(f64::NAN)),
        },
        ast::Value::BooleanLit(flag) => Value::Flag(flag.value),
        ast::Value::NullKeyword(_) => Value::Other("null"),
        ast::Value::Array(list) => Value::List(
            list.elements.iter().map(|v| json_value(source, v)).collect::<Result<_, _>>()?,
        ),
        ast::Value::Object(object) => {
            let mut entries: Vec<Entry> = Vec::with_capacity(object.properties.len());
            let mut seen = std::collections::HashSet::new();
            for property in &object.properties {
                let key = property.name.as_str().to_owned();
                let name = property.name.range();
                if !seen.insert(key.clone()) {
                    return Err(source.error(
                        Some(name.start..name.end),
                        format!("the key `{key}` is given twice"),
                        "keep one of the two",
                    ));
                }
                entries.push(Entry {
                    key,
                    key_span: name.start..name.end,
                    node: json_value(source, &property.value)?,
                });
            }
            Value::Table(entries)
        }
    };
    Ok(Node { span, value })
}
