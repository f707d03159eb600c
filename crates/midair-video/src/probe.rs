//! What a film is.

use super::Colour;
use super::tool::{VideoError, file_argument, not_started, summary};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A film's first video stream.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// The file.
    pub path: PathBuf,
    /// Width and height in pixels as it is seen, that is turned as the file says.
    pub size: [usize; 2],
    /// Whether samples have more than 8 bits.
    pub deep: bool,
    /// Frames that it has, where the file has counted them.
    pub counted: Option<u64>,
    /// How long it lasts in seconds, where the file tells it of this stream.
    pub seconds: Option<f64>,
    /// How long the whole file lasts in seconds, sound included.
    pub whole: Option<f64>,
    /// Frames a second on average, as a fraction; 0/1 where the file does not tell.
    pub rate: [u64; 2],
    /// Its colours.
    pub colour: Colour,
    /// Whether frames are woven of two fields.
    pub interlaced: bool,
}

impl Film {
    /// How many frames it has, counted or estimated from its length.
    pub fn frames(&self) -> Option<u64> {
        let by_time = || {
            let seconds = self.seconds.or(self.whole)?;
            let [frames, per] = self.rate.map(|n| n as f64);
            (frames > 0.0).then(|| (seconds * frames / per).round() as u64)
        };
        self.counted.or_else(by_time)
    }
}

/// Asks ffprobe about a film.
///
/// # Errors
/// [`VideoError`] where ffprobe is missing or cannot read the file, or there is no video in it.
pub fn probe(path: &Path) -> Result<Film, VideoError> {
    let output = Command::new("ffprobe")
        .args([
            "-v",
            "error",
            "-select_streams",
            "v:0",
            "-show_streams",
            "-show_format",
            "-of",
            "json",
        ])
        .arg(file_argument(path))
        .output()
        .map_err(|error| not_started("ffprobe", path, error))?;
    let refused =
        |said: String| VideoError::Refused { path: path.to_owned(), doing: "read it", said };
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        let lines: Vec<String> = said.lines().map(|line| line.replace("file:", "")).collect();
        return Err(refused(summary(&lines, "it says nothing")));
    }
    let told: Value =
        serde_json::from_slice(&output.stdout).map_err(|error| refused(error.to_string()))?;
    film(path, &told).ok_or_else(|| VideoError::NoVideo { path: path.to_owned() })
}

fn film(path: &Path, told: &Value) -> Option<Film> {
    let stream = told["streams"].get(0)?;
    let side = |name: &str| stream[name].as_u64().filter(|&n| n > 0).map(|n| n as usize);
    let (width, height) = (side("width")?, side("height")?);
    let turned = stream["side_data_list"].as_array().into_iter().flatten();
    let turned = turned.filter_map(|data| data["rotation"].as_f64()).next().unwrap_or(0.0);
    let size =
        if (turned / 90.0).round() as i64 % 2 == 0 { [width, height] } else { [height, width] };
    let text = |name: &str| {
        stream[name]
            .as_str()
            .filter(|text| !matches!(*text, "unknown" | "unspecified" | "reserved" | "N/A"))
    };
    let rate = fraction(text("avg_frame_rate").unwrap_or_default());
    let seconds = |value: &Value| value["duration"].as_str()?.parse::<f64>().ok();
    // Matroska tells each stream's length in a tag.
    let tagged = || clock(stream["tags"]["DURATION"].as_str()?);
    let usual = Colour::usual(height);
    Some(Film {
        path: path.to_owned(),
        size,
        deep: is_deep(text("pix_fmt").unwrap_or_default()),
        counted: text("nb_frames").and_then(|count| count.parse().ok()),
        seconds: seconds(stream).or_else(tagged),
        whole: seconds(&told["format"]),
        rate,
        colour: Colour {
            matrix: text("color_space").filter(|m| *m != "gbr").map_or(usual.matrix, str::to_owned),
            primaries: text("color_primaries").map(str::to_owned),
            transfer: text("color_transfer").map(str::to_owned),
        },
        interlaced: matches!(text("field_order"), Some("tt" | "bb" | "tb" | "bt")),
    })
}

/// Whether a pixel format's name tells of more than 8 bits: `yuv420p10le`, `rgb48be`, `p010le`, `gray16le`, `gbrpf32le`.
fn is_deep(name: &str) -> bool {
    let name = name.trim_end_matches("le").trim_end_matches("be");
    let digits = name.len() - name.trim_end_matches(|c: char| c.is_ascii_digit()).len();
    let last: u32 = name[name.len() - digits..].parse().unwrap_or(0);
    let planar = matches!(last, 9 | 10 | 12 | 14 | 16 | 32);
    let packed = matches!(last, 48 | 64 | 30) || name.starts_with("p01") || name.starts_with("x2");
    (planar && !matches!(name, "nv12" | "nv16" | "yuv9" | "rgb32" | "bgr32")) || packed
}

/// `00:01:02.500000000` in seconds.
fn clock(text: &str) -> Option<f64> {
    let parts = text.split(':').map(|part| part.trim().parse::<f64>().ok());
    parts
        .collect::<Option<Vec<f64>>>()
        .map(|parts| parts.iter().fold(0.0, |sum, part| 60.0 * sum + part))
}

/// `30000/1001`.
fn fraction(text: &str) -> [u64; 2] {
    let parts = text.split_once('/').and_then(|(a, b)| Some([a.parse().ok()?, b.parse().ok()?]));
    parts.filter(|parts: &[u64; 2]| parts[1] > 0).unwrap_or([0, 1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_is_read_from_the_formats_name() {
        for deep in [
            "yuv420p10le",
            "yuv444p12be",
            "p010le",
            "rgb48le",
            "gray16be",
            "gbrp16le",
            "x2rgb10le",
            "gbrpf32le",
        ] {
            assert!(is_deep(deep), "{deep}");
        }
        for plain in [
            "yuv420p", "yuvj444p", "rgb24", "nv12", "gray", "bgra", "rgb0", "pal8", "yuva420p",
            "nv21", "gbrp",
        ] {
            assert!(!is_deep(plain), "{plain}");
        }
    }

    #[test]
    fn a_turned_film_is_as_it_is_seen() {
        let told = serde_json::json!({ "streams": [{ "width": 640, "height": 480, "avg_frame_rate": "30000/1001",
            "side_data_list": [{ "rotation": -90 }], "duration": "10.01", "color_space": "gbr" }] });
        let film = film(Path::new("x"), &told).unwrap();
        assert_eq!((film.size, film.frames(), film.rate), ([480, 640], Some(300), [30000, 1001]));
        assert_eq!(film.colour, Colour::usual(480));
        assert_eq!(clock("00:01:02.500000000"), Some(62.5));
    }
}
