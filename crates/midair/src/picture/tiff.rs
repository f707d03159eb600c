//! The colour profile of a TIFF file.

/// The ICC profile of a file's first picture (TIFF 6.0, section 2; the tag is ICC.1:2010, annex B.4); `None` where there is none, or not all
/// of it. BigTIFF has none here.
pub(super) fn profile(bytes: &[u8]) -> Option<Vec<u8>> {
    const PROFILE: u32 = 34675;
    let big = match bytes.get(..2)? {
        b"II" => false,
        b"MM" => true,
        _ => return None,
    };
    let number = |at: usize, length: usize| -> Option<u32> {
        let digits = bytes.get(at..at.checked_add(length)?)?;
        let join = |sum: u32, digit: &u8| sum << 8 | u32::from(*digit);
        Some(match big {
            true => digits.iter().fold(0, join),
            false => digits.iter().rev().fold(0, join),
        })
    };
    if number(2, 2)? != 42 {
        return None;
    }
    let directory = number(4, 4)? as usize;
    let entries = number(directory, 2)? as usize;
    let entry = (0..entries)
        .map(|k| directory.saturating_add(2 + 12 * k))
        .find(|&at| number(at, 2) == Some(PROFILE))?;
    let (length, at) = (number(entry + 4, 4)? as usize, number(entry + 8, 4)? as usize);
    bytes.get(at..at.checked_add(length)?).map(<[u8]>::to_vec)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_profile_is_found_in_either_order_of_bytes_and_hostile_files_have_none() {
        // Header, a directory of one entry at 8, and five bytes at 26.
        let little = b"II\x2a\0\x08\0\0\0\x01\0\x73\x87\x07\0\x05\0\0\0\x1a\0\0\0\0\0\0\0hello";
        let big = b"MM\0\x2a\0\0\0\x08\0\x01\x87\x73\0\x07\0\0\0\x05\0\0\0\x1a\0\0\0\0hello";
        assert_eq!(profile(little).as_deref(), Some(&b"hello"[..]));
        assert_eq!(profile(big).as_deref(), Some(&b"hello"[..]));
        for cut in 0..little.len() {
            assert_eq!(profile(&little[..cut]), None);
        }
        assert_eq!(profile(&[b"II\x2a\0".as_slice(), &[255; 40]].concat()), None);
    }
}
