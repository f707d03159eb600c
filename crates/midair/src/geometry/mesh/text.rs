//! Text as programs write it: in several encodings, with several line ends and numbers that are none.

use std::borrow::Cow;

/// The bytes as UTF-8 (or as any encoding that has ASCII in it), without a byte-order mark.
pub(super) fn plain(bytes: &[u8]) -> Cow<'_, [u8]> {
    let wide = |unit: fn([u8; 2]) -> u16| {
        let units = bytes[2..].as_chunks::<2>().0.iter().map(|&pair| unit(pair));
        let text: String =
            char::decode_utf16(units).map(|c| c.unwrap_or(char::REPLACEMENT_CHARACTER)).collect();
        Cow::Owned(text.into_bytes())
    };
    match bytes {
        [0xef, 0xbb, 0xbf, rest @ ..] => Cow::Borrowed(rest),
        [0xff, 0xfe, ..] => wide(u16::from_le_bytes),
        [0xfe, 0xff, ..] => wide(u16::from_be_bytes),
        _ => Cow::Borrowed(bytes),
    }
}

/// Lines with their numbers from 1, whether they end as on Unix, Windows or old Macintoshes.
pub(super) fn lines(bytes: &[u8]) -> impl Iterator<Item = (u32, &[u8])> {
    let end = if bytes.contains(&b'\n') { b'\n' } else { b'\r' };
    (1u32..).zip(bytes.split(move |&b| b == end))
}

/// The words of a line; one that is not text is like a keyword that is not known.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &str> {
    // A file may end in the mark that DOS set there, or in zeros that fill its last block.
    line.split(|b| b.is_ascii_whitespace() || matches!(b, 0 | 0x1a))
        .filter(|word| !word.is_empty())
        .map(|word| std::str::from_utf8(word).unwrap_or("\u{fffd}"))
}

/// A number as C, Fortran, and programs in countries with a decimal comma print it; NaN for what C runtimes print in its place.
pub(super) fn number(word: &str) -> Option<f64> {
    if let Ok(number) = word.parse() {
        return Some(number);
    }
    let lower = word.to_ascii_lowercase();
    let unsigned = lower.trim_start_matches(['-', '+']);
    // Microsoft's runtime: 1.#QNAN, -1.#IND000, nan(ind); glibc's: nan(0x8000).
    if unsigned.starts_with("1.#") || unsigned.starts_with("nan") {
        return Some(f64::NAN);
    }
    let mut point = lower.replace('d', "e");
    if !lower.contains('.') && lower.matches(',').count() == 1 {
        point = point.replace(',', ".");
    }
    // Words that stand for infinity are not numbers with a d in them.
    point.starts_with(|c: char| !c.is_alphabetic()).then(|| point.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_many_writers_are_read() {
        for (word, value) in [
            ("1", 1.0),
            ("-1.5", -1.5),
            ("+.5", 0.5),
            ("2.", 2.0),
            ("1e-3", 1e-3),
            ("1.25D+02", 125.0),
            ("-1d0", -1.0),
            ("0,75", 0.75),
            ("1.0000000000000000000000001", 1.0),
        ] {
            assert_eq!(number(word), Some(value), "{word}");
        }
        for word in ["nan", "NaN", "-nan(ind)", "1.#QNAN", "-1.#IND00", "1.#INF"] {
            assert!(number(word).is_some_and(f64::is_nan), "{word}");
        }
        for word in ["", "x", "1,2,3", "1.5,2", "d", "1/2", "0x10", "add"] {
            assert_eq!(number(word), None, "{word}");
        }
    }

    #[test]
    fn lines_keep_their_numbers_whatever_ends_them() {
        for text in ["a b\nc\n", "a b\r\nc\r\n", "a b\rc\r"] {
            let found: Vec<(u32, Vec<&str>)> =
                lines(text.as_bytes()).map(|(n, line)| (n, words(line).collect())).collect();
            assert_eq!(found, [(1, vec!["a", "b"]), (2, vec!["c"]), (3, vec![])], "{text:?}");
        }
    }

    #[test]
    fn byte_order_marks_tell_the_encoding() {
        let le: Vec<u8> = "\u{feff}v 1".encode_utf16().flat_map(u16::to_le_bytes).collect();
        let be: Vec<u8> = "\u{feff}v 1".encode_utf16().flat_map(u16::to_be_bytes).collect();
        for bytes in [b"v 1".to_vec(), "\u{feff}v 1".into(), le, be] {
            assert_eq!(&*plain(&bytes), b"v 1");
        }
    }
}
