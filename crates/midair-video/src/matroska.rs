//! Raw frames with their times, in the simplest form that ffmpeg reads exactly: Matroska (RFC 9559) of unknown
//! length, uncompressed pictures, a cluster for each frame, times in nanoseconds.

use std::io::{self, Write};

/// An element of known length.
fn element(id: u32, content: &[u8]) -> Vec<u8> {
    let mut bytes: Vec<u8> = id.to_be_bytes().into_iter().skip_while(|&byte| byte == 0).collect();
    bytes.extend(length(content.len() as u64));
    bytes.extend(content);
    bytes
}

/// A length in eight bytes (RFC 8794, section 4).
fn length(value: u64) -> [u8; 8] {
    (value | 1 << 56).to_be_bytes()
}

fn number(id: u32, value: u64) -> Vec<u8> {
    element(id, &value.to_be_bytes())
}

/// What comes before the first frame.
pub(super) fn header(size: [usize; 2], deep: bool, rate: [u64; 2]) -> Vec<u8> {
    const UNKNOWN: [u8; 8] = [1, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff];
    let ebml = [element(0x4282, b"matroska"), number(0x4287, 4), number(0x4285, 2)].concat();
    // ffmpeg's four characters of packed RGB: "RGB" and the bits of a pixel.
    let space = [b'R', b'G', b'B', if deep { 48 } else { 24 }];
    let video =
        [number(0xb0, size[0] as u64), number(0xba, size[1] as u64), element(0x2eb524, &space)]
            .concat();
    let mut track =
        [number(0xd7, 1), number(0x73c5, 1), number(0x83, 1), element(0x86, b"V_UNCOMPRESSED")]
            .concat();
    if let Some(duration) = (1_000_000_000 * rate[1]).checked_div(rate[0]) {
        // DefaultDuration, which tells the encoder how many frames a second to expect.
        track.extend(number(0x23e383, duration));
    }
    track.extend(element(0xe0, &video));
    let mut bytes = element(0x1a45dfa3, &ebml);
    bytes.extend(0x1853_8067u32.to_be_bytes());
    bytes.extend(UNKNOWN);
    // Timestamps count nanoseconds.
    bytes.extend(element(
        0x1549_a966,
        &[number(0x2ad7b1, 1), element(0x4d80, b"midair"), element(0x5741, b"midair")].concat(),
    ));
    bytes.extend(element(0x1654_ae6b, &element(0xae, &track)));
    bytes
}

/// One frame.
pub(super) fn write_frame(
    writer: &mut impl Write,
    nanoseconds: u64,
    frame: &[u8],
) -> io::Result<()> {
    let time = number(0xe7, nanoseconds);
    // Track 1, at the cluster's own time, a key frame.
    let block_head = [0x81, 0, 0, 0x80];
    let block_length = block_head.len() + frame.len();
    let mut head = 0x1f43_b675u32.to_be_bytes().to_vec();
    head.extend(length((time.len() + 9 + block_length) as u64));
    head.extend(time);
    head.push(0xa3);
    head.extend(length(block_length as u64));
    head.extend(block_head);
    writer.write_all(&head)?;
    writer.write_all(frame)
}
