//! Matrices in files of cv2.FileStorage: YAML, XML or JSON, their numbers as text or in base64, the file packed with gzip or not.

use super::FileError;
use super::exr_channels::{MAX_PIXELS, check_size};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use std::borrow::Cow;
use std::io::Read as _;
use std::path::Path;

/// A matrix with its name.
#[derive(Clone, Debug, PartialEq)]
pub struct Matrix {
    /// What it is called in the file.
    pub name: String,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Numbers to an item.
    pub channels: usize,
    /// What OpenCV calls the type of its numbers: `f`, `d`, `s`, `w` and so on.
    pub kind: char,
    /// The numbers, row by row.
    pub numbers: Vec<f64>,
}

/// What a file holds at its top: matrices, and whole numbers with their names.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Storage {
    /// The matrices, in the file's order.
    pub matrices: Vec<Matrix>,
    /// The whole numbers.
    pub numbers: Vec<(String, usize)>,
}

impl Storage {
    /// The whole number of this name.
    pub fn number(&self, name: &str) -> Option<usize> {
        self.numbers.iter().find(|(known, _)| known == name).map(|&(_, number)| number)
    }
}

/// A matrix as it stands in the file.
struct Fields<'a> {
    name: &'a str,
    rows: Option<u64>,
    columns: Option<u64>,
    kind: &'a str,
    data: Cow<'a, str>,
}

const REMEDY: &str = "write it again with cv2.FileStorage";

/// Reads a file's matrices. `path` is its name, for messages.
///
/// # Errors
/// [`FileError`] where the bytes are none of cv2.FileStorage's forms, or hold a matrix larger than maps are.
pub fn parse(path: &Path, bytes: &[u8]) -> Result<Storage, FileError> {
    let unpacked;
    let bytes = if bytes.starts_with(&[0x1f, 0x8b]) {
        // A number of text takes up to 24 bytes, two of them a pixel's.
        unpacked = unpack(path, bytes, MAX_PIXELS * 48)?;
        &unpacked
    } else {
        bytes
    };
    let text = std::str::from_utf8(bytes)
        .map_err(|error| FileError::malformed(path, "text", error, REMEDY))?;
    let text = text.trim_start_matches('\u{feff}').trim_start();
    match text.as_bytes().first() {
        Some(b'<') => parse_xml(path, text),
        Some(b'{') => parse_json(path, text),
        _ => parse_yaml(path, text),
    }
}

fn unpack(path: &Path, bytes: &[u8], limit: u64) -> Result<Vec<u8>, FileError> {
    let mut unpacked = Vec::new();
    let mut reader = flate2::read::MultiGzDecoder::new(bytes).take(limit + 1);
    reader.read_to_end(&mut unpacked).map_err(|error| {
        FileError::malformed(path, "gzip", error, "it seems cut short: copy or pack it again")
    })?;
    if unpacked.len() as u64 > limit {
        let problem = format!("it unpacks to more than {limit} bytes");
        return Err(FileError::malformed(path, "gzip", problem, REMEDY));
    }
    Ok(unpacked)
}

/// OpenCV's YAML: names at the beginning of a line, what belongs to them indented below.
fn parse_yaml(path: &Path, text: &str) -> Result<Storage, FileError> {
    let mut storage = Storage::default();
    let mut starts: Vec<usize> = Vec::new();
    let mut at = 0;
    for line in text.split_inclusive('\n') {
        let top = line.starts_with(|c: char| c.is_alphanumeric() || matches!(c, '_' | '"'));
        if top && line.contains(':') {
            starts.push(at);
        }
        at += line.len();
    }
    let ends = starts.iter().skip(1).copied().chain([text.len()]);
    for (&start, end) in starts.iter().zip(ends) {
        let Some((name, value)) = text[start..end].split_once(':') else { continue };
        let name = name.trim().trim_matches('"');
        if !value.trim_start().starts_with("!!opencv-matrix") {
            storage.numbers.extend(value.trim().parse().ok().map(|n| (name.to_owned(), n)));
            continue;
        }
        let (head, data) = value.split_once("data:").unwrap_or((value, ""));
        let field = |key: &str| {
            let after = head.split_once(&format!("{key}:"))?.1.lines().next()?;
            Some(after.trim().trim_matches('"'))
        };
        let data = data.trim_start();
        let data = match (data.strip_prefix("!!binary"), data.strip_prefix('[')) {
            (Some(packed), _) => {
                Cow::Owned(format!("{PACKED}{}", packed.trim_start_matches([' ', '|'])))
            }
            (_, Some(numbers)) => {
                let ended = numbers.split_once(']').map(|(numbers, _)| Cow::Borrowed(numbers));
                ended.ok_or_else(|| {
                    FileError::malformed(path, name, "its data do not end", REMEDY)
                })?
            }
            _ => Cow::Borrowed(data),
        };
        let [rows, columns] = ["rows", "cols"].map(|key| field(key)?.parse().ok());
        let kind = field("dt").unwrap_or_default();
        storage.matrices.push(matrix(path, &Fields { name, rows, columns, kind, data })?);
    }
    Ok(storage)
}

fn parse_xml(path: &Path, text: &str) -> Result<Storage, FileError> {
    let document = roxmltree::Document::parse(text)
        .map_err(|error| FileError::malformed(path, "XML", error, REMEDY))?;
    let mut storage = Storage::default();
    for node in document.root_element().children().filter(roxmltree::Node::is_element) {
        let name = node.tag_name().name();
        if node.attribute("type_id") != Some("opencv-matrix") {
            let number = node.text().and_then(|text| text.trim().parse().ok());
            storage.numbers.extend(number.map(|n| (name.to_owned(), n)));
            continue;
        }
        let child = |key: &str| node.children().find(|child| child.has_tag_name(key));
        let field = |key: &str| child(key).and_then(|child| child.text()).map(str::trim);
        let [rows, columns] = ["rows", "cols"].map(|key| field(key)?.trim().parse().ok());
        let kind = field("dt").unwrap_or_default().trim_matches('"');
        let data = field("data").unwrap_or_default();
        let packed = child("data").is_some_and(|data| data.attribute("type_id") == Some("binary"));
        let data = if packed { format!("{PACKED}{data}").into() } else { data.into() };
        storage.matrices.push(matrix(path, &Fields { name, rows, columns, kind, data })?);
    }
    Ok(storage)
}

fn parse_json(path: &Path, text: &str) -> Result<Storage, FileError> {
    // OpenCV writes numbers that JSON does not have; what is left out of a list is not a number here.
    let text = text.replace("-.Inf", "null").replace(".Inf", "null").replace(".Nan", "null");
    let root: Value = serde_json::from_str(&text)
        .map_err(|error| FileError::malformed(path, "JSON", error, REMEDY))?;
    let mut storage = Storage::default();
    for (name, value) in root.as_object().into_iter().flatten() {
        if value["type_id"] != "opencv-matrix" {
            let number = value.as_u64().and_then(|n| usize::try_from(n).ok());
            storage.numbers.extend(number.map(|n| (name.clone(), n)));
            continue;
        }
        let data = match &value["data"] {
            Value::String(text) => Cow::Borrowed(text.as_str()),
            list => {
                let mut text = String::new();
                for item in list.as_array().into_iter().flatten() {
                    match item {
                        Value::Null => text.push_str(".Nan"),
                        other => text.push_str(&other.to_string()),
                    }
                    text.push(' ');
                }
                Cow::Owned(text)
            }
        };
        let [rows, columns] = ["rows", "cols"].map(|key| value[key].as_u64());
        let kind = value["dt"].as_str().unwrap_or_default();
        storage.matrices.push(matrix(path, &Fields { name, rows, columns, kind, data })?);
    }
    Ok(storage)
}

/// What stands before numbers in base64.
const PACKED: &str = "$base64$";
/// Bytes before packed numbers: their type as text, filled up with blanks.
const PACKED_HEADER: usize = 24;

fn matrix(path: &Path, fields: &Fields<'_>) -> Result<Matrix, FileError> {
    let name = fields.name;
    let bad = |problem: String| FileError::malformed(path, name, problem, REMEDY);
    let missing = |what: &str| bad(format!("{what} is missing"));
    let rows = fields.rows.ok_or_else(|| missing("rows"))?;
    let columns = fields.columns.ok_or_else(|| missing("cols"))?;
    check_size(path, columns, rows)?;
    let (channels, kind) = kind_of(fields.kind).ok_or_else(|| {
        bad(format!("its numbers are of the type `{}`, which is not read", fields.kind))
    })?;
    let numbers = match fields.data.trim_start().strip_prefix(PACKED) {
        Some(packed) => {
            unpacked(packed, kind).ok_or_else(|| bad("its base64 is damaged".into()))?
        }
        None => written(&fields.data).map_err(bad)?,
    };
    let (width, height) = (columns as usize, rows as usize);
    let found = numbers.len();
    if found != width * height * channels {
        let most = width * height * channels;
        return Err(bad(format!(
            "{rows} x {columns} items, {most} numbers, are announced, {found} are there"
        )));
    }
    Ok(Matrix { name: name.to_owned(), width, height, channels, kind, numbers })
}

/// Channels and type of `f`, `2f`, `2s`.
fn kind_of(text: &str) -> Option<(usize, char)> {
    let kind = text.chars().last().filter(|kind| "ucwsifdh".contains(*kind))?;
    let channels = text.trim_end_matches(kind);
    let channels = if channels.is_empty() { 1 } else { channels.parse().ok()? };
    (1..=4).contains(&channels).then_some((channels, kind))
}

fn written(text: &str) -> Result<Vec<f64>, String> {
    let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
    let number = |word: &str| match word {
        ".Nan" | ".NaN" | ".nan" => Ok(f64::NAN),
        ".Inf" | ".inf" => Ok(f64::INFINITY),
        "-.Inf" | "-.inf" => Ok(f64::NEG_INFINITY),
        _ => word
            .parse()
            .map_err(|_| format!("`{}` is no number", word.chars().take(20).collect::<String>())),
    };
    words.map(number).collect()
}

fn unpacked(text: &str, kind: char) -> Option<Vec<f64>> {
    let packed: Vec<u8> = text.bytes().filter(|byte| !byte.is_ascii_whitespace()).collect();
    let bytes = STANDARD.decode(packed).ok()?;
    let data = bytes.get(PACKED_HEADER..)?;
    fn all<const N: usize>(data: &[u8], number: impl Fn([u8; N]) -> f64) -> Option<Vec<f64>> {
        let (items, rest) = data.as_chunks::<N>();
        rest.is_empty().then(|| items.iter().map(|&item| number(item)).collect())
    }
    match kind {
        'u' => all(data, |[b]: [u8; 1]| f64::from(b)),
        'c' => all(data, |b| f64::from(i8::from_le_bytes(b))),
        'w' => all(data, |b| f64::from(u16::from_le_bytes(b))),
        's' => all(data, |b| f64::from(i16::from_le_bytes(b))),
        'i' => all(data, |b| f64::from(i32::from_le_bytes(b))),
        'h' => all(data, |b| half::f16::from_le_bytes(b).to_f64()),
        'f' => all(data, |b| f64::from(f32::from_le_bytes(b))),
        _ => all(data, f64::from_le_bytes),
    }
}
