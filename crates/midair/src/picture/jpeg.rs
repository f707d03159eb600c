//! Whether a JPEG file is whole: decoders fill what is missing with grey, without a word.

mod scan;

use scan::Frame;

/// Whether the picture's end is there, and before it coded data for every block. Markers and segments are followed as ITU-T T.81, annex B, lays them
/// out; what comes behind the end (phones put films there) does not count, nor do the pictures inside a segment (previews). Of pictures that are coded
/// in a way that is not followed here (arithmetic, lossless), only the end is looked for.
pub(super) fn is_whole(bytes: &[u8]) -> bool {
    const START: u8 = 0xd8;
    const END: u8 = 0xd9;
    const SCAN: u8 = 0xda;
    const TABLES: u8 = 0xc4;
    const INTERVAL: u8 = 0xdd;
    if !bytes.starts_with(&[0xff, START]) {
        return false;
    }
    let mut frame = Frame::default();
    let mut at = 2;
    loop {
        // Bytes of no meaning before a marker are passed over, as decoders do; any number of 0xff may begin it.
        at += bytes[at..].iter().take_while(|&&byte| byte != 0xff).count();
        at += bytes[at..].iter().take_while(|&&byte| byte == 0xff).count();
        let Some(&marker) = bytes.get(at) else { return false };
        at += 1;
        match marker {
            END => return true,
            // Standing alone: restarts and TEM.
            0x01 | 0xd0..=0xd7 => continue,
            _ => {}
        }
        let Some(&[high, low]) = bytes.get(at..at + 2) else { return false };
        let length = usize::from(u16::from_be_bytes([high, low]));
        let Some(segment) = bytes.get(at + 2..at + length.max(2)) else { return false };
        at += length.max(2);
        match marker {
            TABLES => frame.read_tables(segment),
            INTERVAL => frame.read_interval(segment),
            // Frames of all kinds; 0xc8 and 0xcc are none.
            0xc0..=0xcf if marker != 0xc8 && marker != 0xcc => frame.begin(marker, segment),
            SCAN => {
                // Coded data up to the next marker: a 0xff in them is followed by 0, or is a restart.
                let coded = bytes[at..].windows(2).position(|pair| {
                    pair[0] == 0xff
                        && pair[1] != 0
                        && pair[1] != 0xff
                        && !(0xd0..=0xd7).contains(&pair[1])
                });
                let Some(length) = coded else { return false };
                if frame.is_short(segment, &bytes[at..at + length]) {
                    return false;
                }
                at += length;
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use image::codecs::jpeg::JpegEncoder;

    fn jpeg() -> Vec<u8> {
        let pixels: Vec<u8> =
            (0..64 * 48 * 3).map(|i: u32| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
        let mut bytes = Vec::new();
        JpegEncoder::new_with_quality(&mut bytes, 90)
            .encode(&pixels, 64, 48, image::ExtendedColorType::Rgb8)
            .unwrap();
        bytes
    }

    #[test]
    fn every_cut_is_seen_and_what_comes_behind_the_end_is_not_counted() {
        let whole = jpeg();
        assert!(is_whole(&whole));
        for length in 0..whole.len() {
            assert!(!is_whole(&whole[..length]), "{length}");
        }
        assert!(is_whole(&[&whole[..], b"a film"].concat()));
        // A copy that stopped: its length is there, filled up with zeros.
        let mut padded = whole[..whole.len() / 2].to_vec();
        padded.resize(whole.len(), 0);
        assert!(!is_whole(&padded));
    }

    #[test]
    fn an_end_that_was_put_behind_a_cut_is_none() {
        let whole = jpeg();
        let data = whole.windows(2).position(|pair| pair == [0xff, 0xda]).unwrap() + 14;
        // Up to a few bytes before the end, where only padding may be missing.
        for length in (data..whole.len() - 4).step_by(7) {
            let mut cut = whole[..length].to_vec();
            cut.extend([0xff, 0xd9]);
            assert!(!is_whole(&cut), "{length} of {}", whole.len());
        }
    }

    #[test]
    fn a_preview_inside_is_not_the_pictures_end() {
        let whole = jpeg();
        let preview = jpeg();
        let length = u16::try_from(preview.len() + 2).unwrap().to_be_bytes();
        let mut with = vec![0xff, 0xd8, 0xff, 0xe1];
        with.extend(length);
        with.extend(&preview);
        with.extend(&whole[2..]);
        assert!(is_whole(&with));
        assert!(!is_whole(&with[..preview.len() + 6]));
        assert!(!is_whole(&with[..with.len() - 100]));
    }
}
