//! What a film is.

use super::tool::{VideoError, file_argument, not_started, summary};
use super::{Coded, Colour};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A film's first video stream.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// The file.
    pub path: PathBuf,
    /// Which of the file's streams it is, from 0.
    pub stream: usize,
    /// How many streams of moving pictures the file has. Covers and thumbnails do not count.
    pub films: usize,
    /// Width and height in pixels as it is seen, that is turned as the file says.
    pub size: [usize; 2],
    /// Whether samples have more than 8 bits.
    pub deep: bool,
    /// Whether its pictures have alpha.
    pub alpha: bool,
    /// The decoder to ask for, where the usual one would not see the alpha.
    pub(crate) decoder: Option<&'static str>,
    /// Frames that it has, where the file has counted them; a film that is shown in part only has more than are seen.
    pub counted: Option<u64>,
    /// When it begins, in seconds after the first of the file's streams does: broadcasts' clocks do not begin at 0, and ffmpeg sets them to it.
    pub start: f64,
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
    /// How many streams of sound the file has.
    pub sounds: usize,
    /// ffmpeg's names of the kinds of the file's subtitles.
    pub subtitles: Vec<String>,
}

impl Film {
    /// When its last picture's time is over, by the clock of `start`, where the file tells.
    pub fn end(&self) -> Option<f64> {
        self.seconds.map(|seconds| self.start + seconds)
    }

    /// How many frames are seen, counted or estimated from its length.
    pub fn frames(&self) -> Option<u64> {
        let by_time = || {
            let seconds = self.seconds.or(self.whole)?;
            let [frames, per] = self.rate.map(|n| n as f64);
            (frames > 0.0).then(|| (seconds * frames / per).round() as u64)
        };
        match (self.counted, self.seconds.and_then(|_| by_time())) {
            // Counted are the frames in the file; a list of edits may show some of them only.
            (Some(counted), Some(seen)) if seen + 3 + counted / 100 < counted => Some(seen),
            (Some(counted), _) => Some(counted),
            (None, _) => by_time(),
        }
    }
}

/// Asks ffprobe about a film.
///
/// # Errors
/// [`VideoError`] where ffprobe is missing or cannot read the file, or there is no video in it.
pub fn probe(path: &Path) -> Result<Film, VideoError> {
    film(path, &ask(path)?).ok_or_else(|| VideoError::NoVideo { path: path.to_owned() })
}

/// What ffprobe tells of a file.
fn ask(path: &Path) -> Result<Value, VideoError> {
    let output = Command::new("ffprobe")
        .args(["-v", "error", "-show_streams", "-show_format", "-of", "json"])
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
    serde_json::from_slice(&output.stdout).map_err(|error| refused(error.to_string()))
}

/// How a film's first stream of pictures is coded, as it says itself.
pub(crate) fn coded_in(path: &Path) -> Result<Coded, VideoError> {
    let told = ask(path)?;
    let mut streams = told["streams"].as_array().into_iter().flatten();
    let stream = streams.find(|stream| stream["pix_fmt"].is_string());
    let stream = stream.ok_or_else(|| VideoError::NoVideo { path: path.to_owned() })?;
    let text = |name: &str| stream[name].as_str().filter(|text| known(text)).map(str::to_owned);
    let full = text("color_range").as_deref() == Some("pc");
    Ok(Coded { pixels: text("pix_fmt").unwrap_or_default(), matrix: text("color_space"), full })
}

/// Whether ffprobe knows what it says.
fn known(text: &str) -> bool {
    !matches!(text, "unknown" | "unspecified" | "reserved" | "N/A")
}

fn film(path: &Path, told: &Value) -> Option<Film> {
    let streams = told["streams"].as_array()?;
    let of_kind = |kind: &'static str| {
        streams.iter().filter(move |stream| stream["codec_type"].as_str() == Some(kind))
    };
    let set = |stream: &Value, flag: &str| stream["disposition"][flag].as_u64() == Some(1);
    let still =
        |stream: &&Value| ["attached_pic", "timed_thumbnails"].iter().any(|flag| set(stream, flag));
    let films: Vec<&Value> = of_kind("video").filter(|stream| !still(stream)).collect();
    let stream = films.iter().find(|stream| set(stream, "default")).or(films.first())?;
    let side = |name: &str| stream[name].as_u64().filter(|&n| n > 0).map(|n| n as usize);
    let (width, height) = (side("width")?, side("height")?);
    let turned = stream["side_data_list"].as_array().into_iter().flatten();
    let turned = turned.filter_map(|data| data["rotation"].as_f64()).next().unwrap_or(0.0);
    let size =
        if (turned / 90.0).round() as i64 % 2 == 0 { [width, height] } else { [height, width] };
    let text = |name: &str| stream[name].as_str().filter(|text| known(text));
    let rate = fraction(text("avg_frame_rate").unwrap_or_default());
    let seconds = |value: &Value| value["duration"].as_str()?.parse::<f64>().ok();
    let begins = |value: &Value| value["start_time"].as_str()?.parse::<f64>().ok();
    let begin = begins(stream).unwrap_or(0.0);
    let start = begin - begins(&told["format"]).unwrap_or(0.0);
    // Matroska tells each stream's length in a tag.
    let tagged = || clock(stream["tags"]["DURATION"].as_str()?);
    let usual = Colour::usual(height);
    // WebM keeps alpha in a second picture, which ffmpeg's own decoders pass over.
    let second = stream["tags"]["alpha_mode"].as_str().or(stream["tags"]["ALPHA_MODE"].as_str());
    let decoder = match (second, text("codec_name")) {
        (Some("1"), Some("vp9")) => Some("libvpx-vp9"),
        (Some("1"), Some("vp8")) => Some("libvpx"),
        _ => None,
    };
    Some(Film {
        path: path.to_owned(),
        stream: stream["index"].as_u64()? as usize,
        films: films.len(),
        size,
        deep: is_deep(text("pix_fmt").unwrap_or_default()),
        alpha: is_alpha(text("pix_fmt").unwrap_or_default()) || decoder.is_some(),
        decoder,
        start,
        counted: text("nb_frames").and_then(|count| count.parse().ok()),
        // Matroska's tag counts from 0, not from the first picture.
        seconds: seconds(stream).or_else(|| tagged().map(|end| end - begin)),
        whole: seconds(&told["format"]),
        rate,
        colour: Colour {
            matrix: text("color_space").filter(|m| *m != "gbr").map_or(usual.matrix, str::to_owned),
            primaries: text("color_primaries").map(str::to_owned),
            transfer: text("color_transfer").map(str::to_owned),
        },
        interlaced: matches!(text("field_order"), Some("tt" | "bb" | "tb" | "bt")),
        sounds: of_kind("audio").count(),
        subtitles: of_kind("subtitle")
            .map(|stream| stream["codec_name"].as_str().unwrap_or("unknown").to_owned())
            .collect(),
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

/// Whether a pixel format's name tells of alpha: `yuva420p`, `bgra`, `gbrap12le`, `ya8`, and palettes, whose entries may have it.
fn is_alpha(name: &str) -> bool {
    let plain = name.trim_end_matches("le").trim_end_matches("be");
    plain.starts_with("yuva")
        || plain.starts_with("gbrap")
        || ["rgba", "bgra", "argb", "abgr", "ayuv", "vuya"]
            .iter()
            .any(|kind| plain.starts_with(kind))
        || matches!(plain, "ya8" | "ya16" | "pal8")
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
    fn a_cover_is_no_film_and_the_default_one_is_taken() {
        let stream = |index: u64, cover: u64, default: u64| {
            serde_json::json!({ "index": index, "codec_type": "video", "width": 8, "height": 8, "avg_frame_rate": "25/1",
                "disposition": { "attached_pic": cover, "default": default } })
        };
        let sound = serde_json::json!({ "index": 9, "codec_type": "audio" });
        let text = serde_json::json!({ "index": 8, "codec_type": "subtitle", "codec_name": "ass" });
        let told = serde_json::json!({ "streams": [stream(0, 1, 1), stream(1, 0, 0), stream(2, 0, 1), sound, text] });
        let taken = film(Path::new("x"), &told).unwrap();
        assert_eq!((taken.stream, taken.films, taken.sounds), (2, 2, 1));
        assert_eq!(taken.subtitles, ["ass"]);
        let told = serde_json::json!({ "streams": [stream(0, 1, 1), sound] });
        assert!(film(Path::new("x"), &told).is_none());
    }

    #[test]
    fn a_film_that_is_shown_in_part_has_the_frames_that_are_seen() {
        let told = serde_json::json!({ "streams": [{ "index": 0, "codec_type": "video", "width": 8, "height": 8,
            "avg_frame_rate": "25/1", "nb_frames": "100", "duration": "2.68", "start_time": "0.5" }] });
        let taken = film(Path::new("x"), &told).unwrap();
        assert_eq!((taken.frames(), taken.end()), (Some(67), Some(3.18)));
        // A broadcast's clock runs since long before.
        let mut told = told;
        told["format"] = serde_json::json!({ "start_time": "0.25" });
        assert_eq!(film(Path::new("x"), &told).unwrap().end(), Some(2.93));
    }

    #[test]
    fn alpha_is_read_from_the_formats_name() {
        for name in [
            "yuva420p",
            "yuva444p12le",
            "bgra",
            "argb",
            "rgba64be",
            "gbrap16le",
            "ya8",
            "ya16le",
            "pal8",
        ] {
            assert!(is_alpha(name), "{name}");
        }
        for name in ["yuv420p", "gbrp", "rgb24", "rgb0", "gray16le", "yuvj420p", "bgr0"] {
            assert!(!is_alpha(name), "{name}");
        }
    }

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
        let told = serde_json::json!({ "streams": [{ "index": 0, "codec_type": "video", "width": 640, "height": 480, "avg_frame_rate": "30000/1001",
            "side_data_list": [{ "rotation": -90 }], "duration": "10.01", "color_space": "gbr" }] });
        let film = film(Path::new("x"), &told).unwrap();
        assert_eq!((film.size, film.frames(), film.rate), ([480, 640], Some(300), [30000, 1001]));
        assert_eq!(film.colour, Colour::usual(480));
        assert_eq!(clock("00:01:02.500000000"), Some(62.5));
    }
}
