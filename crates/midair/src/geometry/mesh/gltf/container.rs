//! What a glTF file is made of: JSON and binary chunks, and buffers beside it or in data URIs.

use crate::geometry::mesh::MeshError;
use crate::geometry::mesh::read::Beside;
use base64::Engine as _;
use base64::alphabet::STANDARD;
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use std::borrow::Cow;
use std::path::{Component, Path};

/// The JSON and the binary chunk; a file that does not start with the GLB magic is all JSON.
pub(super) fn chunks<'a>(
    bytes: &'a [u8],
    file: &str,
) -> Result<(&'a [u8], Option<&'a [u8]>), MeshError> {
    if !bytes.starts_with(b"glTF") {
        return Ok((bytes, None));
    }
    let word = |at: usize| {
        let bytes = bytes.get(at..)?.first_chunk();
        bytes.map(|&b| u32::from_le_bytes(b) as usize)
    };
    let short = || MeshError::syntax(file, "ends within its header or a chunk");
    if word(4).ok_or_else(short)? != 2 {
        return Err(MeshError::syntax(file, "is not version 2 of GLB"));
    }
    let mut at = 12;
    let (mut json, mut blob) = (None, None);
    // What follows the last whole chunk, or is of another kind, is to be ignored.
    while let Some(length) = word(at) {
        let kind = bytes.get(at + 4..at + 8).ok_or_else(short)?;
        let data = bytes.get(at + 8..(at + 8).saturating_add(length)).ok_or_else(short)?;
        match (kind, json) {
            (b"JSON", None) => json = Some(data),
            (_, None) => {
                return Err(MeshError::syntax(file, "has its chunks in the wrong order"));
            }
            (b"BIN\0", _) if blob.is_none() => blob = Some(data),
            _ => {}
        }
        at += 8 + length;
    }
    Ok((json.ok_or_else(short)?, blob))
}

/// A buffer's bytes from a data URI, or from a file in or below the model's folder.
pub(super) fn fetch(
    uri: &str,
    file: &str,
    beside: Option<&Beside<'_>>,
) -> Result<Vec<u8>, MeshError> {
    let shown: String = uri.chars().take(60).collect();
    if let Some(data) = uri.strip_prefix("data:") {
        return inline(data)
            .ok_or_else(|| MeshError::syntax(file, format!("has a bad data URI: {shown}")));
    }
    let name = decoded(uri);
    let name = std::str::from_utf8(&name).unwrap_or_default();
    let path = Path::new(name);
    // A model must not read whatever file it names.
    let below = path.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir));
    match beside {
        Some(beside) if below && !name.is_empty() && !uri.contains(':') => {
            beside(path).map_err(|e| {
                MeshError::new(
                    file,
                    format!("its buffer {shown} cannot be read: {e}"),
                    "put it beside the glTF file, or export as GLB",
                )
            })
        }
        _ => Err(MeshError::new(
            file,
            format!("has a buffer elsewhere: {shown}"),
            "put it beside the glTF file, or export as GLB",
        )),
    }
}

/// The bytes of a data URI after `data:` (RFC 2397): in base64, or as they are.
fn inline(data: &str) -> Option<Vec<u8>> {
    let (about, content) = data.split_once(',')?;
    let content = decoded(content);
    if !about.rsplit(';').next().is_some_and(|last| last.trim().eq_ignore_ascii_case("base64")) {
        return Some(content.into_owned());
    }
    let config =
        GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
    let text: Vec<u8> = content.iter().copied().filter(|b| !b.is_ascii_whitespace()).collect();
    GeneralPurpose::new(&STANDARD, config).decode(text).ok()
}

/// A URI's bytes with what stands as `%20` and the like put back (RFC 3986, 2.1); a lone percent sign stays one.
fn decoded(uri: &str) -> Cow<'_, [u8]> {
    if !uri.contains('%') {
        return Cow::Borrowed(uri.as_bytes());
    }
    let bytes = uri.as_bytes();
    let mut out = Vec::with_capacity(bytes.len());
    let mut at = 0;
    while at < bytes.len() {
        let digit = |k: usize| char::from(*bytes.get(k)?).to_digit(16);
        match (bytes[at], digit(at + 1), digit(at + 2)) {
            (b'%', Some(high), Some(low)) => {
                out.push((16 * high + low) as u8);
                at += 3;
            }
            (byte, ..) => {
                out.push(byte);
                at += 1;
            }
        }
    }
    Cow::Owned(out)
}
