//! Films, by way of ffmpeg: decoded to raw frames, and raw frames encoded, each with its own time.
//!
//! ffmpeg and ffprobe (5.1 or later) run as sub-processes, so that every codec that they know can be read and
//! written; what they complain of is passed on. Frames travel as packed RGB of 8 or 16 bits, between YUV and RGB by the film's own matrix.

mod decode;
mod encode;
mod join;
mod matroska;
mod options;
mod probe;
mod sound;
mod tool;

pub use decode::{Decoder, Timing};
pub use encode::{Encoder, Recipe};
pub use join::{Extras, Joining, Part, is_avi, join};
pub use options::{Coded, coded};
pub use probe::{Film, probe};
pub use sound::Sound;
pub use tool::VideoError;

use midair::picture::Curve;
use midair::picture::colour::Primaries;

/// How a film's codes stand for light.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Colour {
    /// ffmpeg's name of the matrix between YUV and RGB, as the film says or as is usual for its size.
    pub matrix: String,
    /// ffmpeg's name of the primaries, where the film says.
    pub primaries: Option<String>,
    /// ffmpeg's name of the transfer function, where the film says.
    pub transfer: Option<String>,
}

impl Colour {
    /// What a film of this height has if it says nothing: BT.601 below 720 rows, else BT.709.
    pub fn usual(height: usize) -> Self {
        let matrix = if height < 720 { "smpte170m" } else { "bt709" };
        Self { matrix: matrix.to_owned(), primaries: None, transfer: None }
    }

    /// The curve between codes and light. Films without a wide range are taken as sRGB, as the stills are: a display shows
    /// both alike.
    pub fn curve(&self) -> Curve {
        match self.transfer.as_deref() {
            Some("smpte2084") => Curve::Pq,
            Some("arib-std-b67") => Curve::Hlg,
            Some("linear") => Curve::Linear,
            _ => Curve::Srgb,
        }
    }

    /// The primaries, where they are wider than those of sRGB: colours of SD television are shown as they are, as players do.
    pub fn wide_primaries(&self) -> Option<Primaries> {
        match self.primaries.as_deref()? {
            "bt2020" => Some(Primaries::BT2020),
            "smpte431" => Some(Primaries::DCI_P3),
            "smpte432" => Some(Primaries::DISPLAY_P3),
            _ => None,
        }
    }

    /// The matrix as ffmpeg's scale filter calls it.
    fn scale_matrix(&self) -> &'static str {
        match self.matrix.as_str() {
            "bt709" => "bt709",
            "bt2020nc" | "bt2020c" => "bt2020",
            "fcc" => "fcc",
            "smpte240m" => "smpte240m",
            _ => "bt601",
        }
    }
}

/// Between YUV and RGB as exactly as ffmpeg can.
const SCALE_FLAGS: &str = "bicubic+accurate_rnd+full_chroma_int+full_chroma_inp";

#[cfg(test)]
mod tests;
